"""A study of a case that a client sends as JSON: what may be asked, and the study itself.

A message ``{"id", "study": "tune", "case": {...}, "settings": {...}}`` holds what a case JSON with study
tables holds; the value is the JSON that ``torsionbook tune case.json`` writes.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from addin.contract.studies.registry import STUDIES
from addin.server.requests import Refused

__all__ = ["Asked", "COMMANDS", "read_study", "study_of"]

#: Studies that may be asked for, by the names of their commands.
COMMANDS = tuple(study.command for study in STUDIES)


@dataclass(frozen=True)
class Asked:
    """A study that a client asks for."""

    command: str  #: One of `COMMANDS`.
    case: Mapping[str, Any]  #: Case JSON with study tables. [SI]
    settings: Mapping[str, Any]  #: As on the command line.


def read_study(message: Mapping[str, Any]) -> Asked:
    """What a message asks for.

    Raises
    ------
    Refused
        With the sentence that says what is wrong.
    """
    command, case = message.get("study"), message.get("case")
    if command not in COMMANDS:
        raise Refused(400, f"There is no study of this name. There are {', '.join(COMMANDS)}.")
    if not isinstance(case, dict):
        raise Refused(400, "case is no object. Give the case JSON with the tables of the study.")
    settings = message.get("settings", {})
    if not isinstance(settings, dict):
        raise Refused(400, 'settings is no object. Give one such as {"samples": 1000}.')
    study = next(one for one in STUDIES if one.command == command)
    allowed = {setting.name: setting for setting in study.settings}
    for name, value in settings.items():
        if name not in allowed:
            known = f"are {', '.join(allowed)}" if allowed else "is none"
            raise Refused(400, f"{command} has no setting '{name[:40]}'. There {known}.")
        if not allowed[name].fits(value):
            raise Refused(400, f"{name} must be {allowed[name].allowed}.")
    return Asked(command, case, settings)


# --- in the processes -----------------------------------------------------------------------------


def study_of(asked: Asked, tell: Callable[[str], None]) -> dict[str, Any]:
    """Make the study; in a process of the pool, which is ended when nobody wants it any more.

    Returns
    -------
    dict
        ``value``: JSON of the study; or ``errors`` as the contract has them, and ``error`` with the
        sentence over them.
    """
    from addin.contract.version import product_version
    from addin.reading.case_json import read_case_json
    from addin.studies.registry import study_of_command
    from addin.studies.study import made_of, to_json
    from addin.workers.parallel_map import alone
    from addin.writing.results_json import errors_to_json

    study = study_of_command(asked.command)
    tell("reading")
    read = read_case_json(asked.case)
    found, problems, warnings = made_of(study, read, alone(), asked.settings, tell)
    if found is None:
        told = errors_to_json(problems, product_version(), warnings)["errors"]
        count = "one error" if len(told) == 1 else f"{len(told)} errors"
        sentence = f"The input has {count}; nothing was calculated. {problems[0].message}"
        return {"error": {"message": sentence, "code": "#VALUE!"}, "errors": told}
    content = to_json(study, found, read, warnings)
    return {"value": json.loads(json.dumps(content, allow_nan=False))}  # plain values alone
