"""The calculation made again, with the settings that the file records."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

from addin.calculation.calculation import Calculation, calculate
from addin.contract.problems import CellProblem
from addin.reading.typed_case import CaseInput
from addin.writing.recalculate import of_case
from engine.case.data import case_digest
from engine.errors import CaseError, ModelError

__all__ = ["calculated_again"]


def calculated_again(
    read: CaseInput,
    settings: Mapping[str, Any],
    on_stage: Callable[[str], None] | None = None,
) -> tuple[Calculation | None, tuple[CellProblem, ...]]:
    """The results that follow from inputs.

    Parameters
    ----------
    read : CaseInput
        Inputs without problems. [SI]
    settings : mapping
        Fields that the command line set. [SI]
    on_stage : callable, optional
        Called with the name of each analysis as it begins.

    Returns
    -------
    Calculation or None
        The same that ``torsionbook recalc`` writes. [SI]
    problems : tuple of CellProblem
        Why there is none.
    """
    try:
        case = replace(read.case(), **settings)
        done = calculate(
            case,
            input_warnings=read.warnings,
            case_sha256=case_digest(read.data),
            overrides=settings,
            on_stage=on_stage,
        )
    except (CaseError, ModelError) as wrong:
        return None, of_case(wrong)
    return done, ()
