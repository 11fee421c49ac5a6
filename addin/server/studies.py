"""A study of a case that a client sends as JSON: what may be asked, and the study itself.

A message ``{"id", "study": "tune", "case": {...}, "settings": {...}}`` holds what a case JSON with study
tables holds; the value is the JSON that ``torsionbook tune case.json`` writes.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

from addin.contract.version import product_version
from addin.reading.case_json import read_case_json
from addin.server.answers import Refused, input_errors
from addin.studies.registry import every_study
from addin.studies.run_study import calculate_study, to_json
from addin.studies.study import Option, wrong_setting
from addin.workers.parallel_map import serial_map
from addin.writing.results_json import errors_to_json

#: Studies that may be asked for, by the names of their commands.
STUDIES = {study.command: study for study in every_study()}
#: Most samples of one request. [count]
MOST_SAMPLES = 100_000


@dataclass(frozen=True)
class StudyRequest:
    """A study that a client asks for."""

    command: str  #: One of `STUDIES`.
    case: Mapping[str, Any]  #: Case JSON with study tables. [SI]
    settings: Mapping[str, Any]  #: As on the command line.


def read_study(message: Mapping[str, Any]) -> StudyRequest:
    """What a message asks for.

    Raises
    ------
    Refused
        With the sentence that says what is wrong.
    """
    command, case = message.get("study"), message.get("case")
    if not isinstance(command, str) or command not in STUDIES:
        raise Refused(400, f"Unknown study. Available: {', '.join(STUDIES)}.")
    if not isinstance(case, dict):
        raise Refused(
            400, "case is not an object. Give the case JSON with the tables of the study."
        )
    settings = message.get("settings", {})
    if not isinstance(settings, dict):
        raise Refused(400, 'settings is not an object. Give one such as {"samples": 1000}.')
    options = [limited(option) for option in STUDIES[command].options]
    if wrong := wrong_setting(command, options, settings):
        raise Refused(400, wrong)
    return StudyRequest(command, case, settings)


def limited(option: Option) -> Option:
    """An option as a client may set it: no more samples than one request may calculate."""
    return replace(option, most=MOST_SAMPLES) if option.name == "samples" else option


# --- in the processes -----------------------------------------------------------------------------


def study_of(asked: StudyRequest, tell: Callable[[str], None]) -> dict[str, Any]:
    """Make the study; in a process of the pool, which is ended when nobody wants it any more.

    Returns
    -------
    dict
        ``value``: JSON of the study; or ``errors`` as the contract has them, and ``error`` with the
        sentence over them.
    """
    study = STUDIES[asked.command]
    tell("reading")
    read = read_case_json(asked.case)
    result, problems, warnings = calculate_study(study, read, serial_map(), asked.settings, tell)
    if result is None:
        errors = errors_to_json(problems, product_version(), warnings)["errors"]
        message = input_errors(problems)
        return {"error": {"message": message, "code": "#VALUE!"}, "errors": errors}
    content = to_json(study, result, read, warnings)
    return {"value": json.loads(json.dumps(content, allow_nan=False))}  # plain values alone
