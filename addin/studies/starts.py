"""The start matrix and its damage ledger as a study; see `engine.studies.starts.matrix`, `engine.studies.starts.damage_ledger`."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from addin.contract.studies.starts import STARTS as STARTS_SPEC
from addin.contract.study_spec import CUT_SHORT
from addin.studies.study import CutShort, Found, Study

if TYPE_CHECKING:
    from addin.workers.parallel_map import Spread
    from engine.case.case import Case
    from engine.case.study_inputs import StudyInputs
    from engine.errors import Problem
    from engine.studies.starts.condition_result import ConditionResult
    from engine.studies.starts.conditions import StartCondition

__all__ = ["STARTS"]


def _check(case: Case, inputs: StudyInputs, settings: Mapping[str, Any]) -> Sequence[Problem]:
    from engine.studies.starts.conditions import condition_problems

    return condition_problems(case, inputs)


def _one(unit: tuple[Case, StartCondition]) -> ConditionResult:
    """One start of the matrix: the unit of work."""
    from engine.studies.starts.condition_result import calculate_condition

    return calculate_condition(*unit)


def _calculate(
    case: Case,
    inputs: StudyInputs,
    settings: Mapping[str, Any],
    spread: Spread,
    tell: Callable[[str], None],
) -> Found:
    from addin.workers.parallel_map import Cancelled, as_far
    from engine.studies.starts.damage_ledger import damage_ledger, ledger_rows, remaining_rows
    from engine.studies.starts.matrix import gather_matrix, start_rows, voltage_rows
    from engine.studies.starts.plan import plan_matrix

    plan = plan_matrix(case, inputs, with_standard=bool(settings.get("standard")))
    number = len(plan.units)
    rows = as_far(
        spread,
        _one,
        [(case, condition) for condition in plan.units],
        lambda done: tell(f"start {min(done + 1, number)} of {number}"),
    )
    if not rows:
        raise Cancelled(why=f"None of {number} starts was calculated.")
    matrix = gather_matrix(case, inputs, plan, rows)
    ledger = damage_ledger(matrix)
    has_duty = any(row.condition.has_duty for row in matrix.rows)
    said = [matrix.sentence]
    if has_duty or not matrix.judged_shafts:
        said.append(ledger.sentence)
    else:
        said.append("No duty is stated on sheet Duty: the ledger is empty.")
    return Found(
        result=(matrix, ledger),
        tables={
            "StartsByVoltage": voltage_rows(matrix),
            "StartMatrix": start_rows(matrix),
            "DamageLedger": ledger_rows(ledger),
            "RemainingStarts": remaining_rows(ledger),
        },
        sentence=" ".join(said),
        digest=matrix.study_sha256,
        warnings=matrix.notes,
        details={
            "standard": matrix.standard,
            "starts_factor": matrix.starts_factor,
            "assumption": ledger.assumption,
            "verdict": ledger.verdict,
        },
        cut_short=None if matrix.complete else _cut_short(len(rows), number, has_duty),
    )


def _cut_short(calculated: int, planned: int, has_duty: bool) -> CutShort:
    sentence = (
        f"{CUT_SHORT}: {calculated} of {planned} starts were calculated; the others are named "
        "'not calculated'."
    )
    if has_duty:
        sentence += " What a duty uses up is told only if all of its starts were calculated."
    return CutShort(calculated, planned, sentence)


STARTS = Study(
    spec=STARTS_SPEC,
    check=_check,
    calculate=_calculate,
)
