"""The study of each `StudySpec`: `addin.studies.KEY`, loaded when it is asked for."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

from addin.contract.field import IncompleteRecord
from addin.contract.studies.registry import STUDIES
from addin.contract.study_spec import StudySpec
from addin.studies.study import Study

if TYPE_CHECKING:
    from addin.contract.problems import CellProblem
    from addin.reading.one_file import Unreadable
    from addin.reading.typed_case import CaseInput
    from engine.errors import Problem


def study_of(spec: StudySpec) -> Study:
    """The study of a record.

    Raises
    ------
    IncompleteRecord
        If it has none.
    """
    name = f"{__package__}.{spec.key}"
    try:
        module = import_module(name)
    except ModuleNotFoundError as missing:
        if missing.name != name:
            raise
        raise IncompleteRecord(
            f"study {spec.key} has no calculation: add a Study in addin/studies/{spec.key}.py"
        ) from missing
    for value in vars(module).values():
        if isinstance(value, Study) and value.spec is spec:
            return value
    raise IncompleteRecord(f"addin/studies/{spec.key}.py has no Study of the record {spec.key}")


def study_of_command(command: str) -> Study:
    """The study of a command."""
    return study_of(next(spec for spec in STUDIES if spec.command == command))


def every_study() -> tuple[Study, ...]:
    """Every study, in the order of its sheets."""
    return tuple(study_of(spec) for spec in STUDIES)


def of_studies(read: CaseInput | Unreadable) -> tuple[CellProblem, ...]:
    """What is wrong on the study sheets of an input whose case is right.

    Returns
    -------
    tuple of CellProblem
        Of studies whose tables have rows; empty where the case itself is wrong.
    """
    studies = getattr(read, "studies", None)
    if studies is None or read.problems:
        return ()
    from addin.reading.typed_case import CaseInput

    assert isinstance(read, CaseInput)
    case = read.case()
    found: list[Problem] = []
    tables = [name for spec in STUDIES for name in spec.input_names]
    for spec in STUDIES:
        if any(studies.inputs.rows(name) for name in spec.input_names):
            found += study_of(spec).check(case, studies.inputs, {})
    return tuple(dict.fromkeys(studies.problems_of(tables, found)))
