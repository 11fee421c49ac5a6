"""Every study, and what is wrong with the rows of all of them."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from addin.contract.problems import CellProblem
    from addin.reading.typed_case import CaseInput
    from addin.studies.study import Study
    from addin.writing.recalculate import Unreadable
    from engine.errors import Problem

__all__ = ["every_study", "of_studies"]


def every_study() -> tuple[Study, ...]:
    """Every study, in the order of its sheets."""
    from addin.studies.calibration import CALIBRATION
    from addin.studies.sensitivities import SENSITIVITIES
    from addin.studies.starts import STARTS
    from addin.studies.tolerances import TOLERANCES
    from addin.studies.tuning import TUNING

    return (TUNING, TOLERANCES, SENSITIVITIES, STARTS, CALIBRATION)


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
    from engine.case.study_inputs import STUDY_TABLES

    assert isinstance(read, CaseInput)
    case = read.case()
    tables = {name for name, (key, _) in STUDY_TABLES.items() if getattr(studies.inputs, key)}
    found: list[Problem] = []
    for study in every_study():
        if tables & set(study.inputs):
            found += study.check(case, studies.inputs, {})
    return tuple(dict.fromkeys(studies.told(STUDY_TABLES, found)))
