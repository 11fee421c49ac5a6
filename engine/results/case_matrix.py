"""The verdicts of every typed condition as a matrix: one row a condition, one column a kind of check."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from engine.case.choices import ConditionKind
from engine.case.data import CaseData, StartConditionRow
from engine.case.result_words import Judgement
from engine.operation.standards import EVENTS, MARGIN, RESPONSE, REVERSAL, START, STARTS, STRENGTH
from engine.results.results import CaseVerdict
from engine.results.verdicts import overall_verdict


@dataclass(frozen=True)
class CaseMatrixRow:
    """One condition: the worst verdict of each kind of check; None where there is none of the kind."""

    condition: str  #: Name of the condition.
    margin: Judgement | None  #: Separation margin.
    response: Judgement | None  #: Forced response in continuous operation.
    verdict: Judgement  #: The overall one.
    where: str  #: The checks that decide it.
    start: (
        Judgement | None
    )  #: Outcome, torques, reversal and allowable starts of the start or the event.
    changed: str  #: What differs from the case.


def case_matrix(case: CaseData, rows: Sequence[CaseVerdict]) -> tuple[CaseMatrixRow, ...]:
    """The matrix.

    Parameters
    ----------
    case : CaseData
        The case with its conditions. [SI]
    rows : sequence of CaseVerdict
        All checks of all conditions, the overall one of each first. [rows]

    Returns
    -------
    tuple of CaseMatrixRow
        In the order of the conditions. [rows]
    """
    checks: dict[str, list[CaseVerdict]] = {}
    for row in rows:
        checks.setdefault(row.condition, []).append(row)
    synchronous = case.ratings.synchronous_speed
    changed = {
        str(row.condition): "; ".join(_changed(row, synchronous)) or "nothing"
        for row in case.start_conditions
    }
    return tuple(_matrix_row(changed[name], *of_name) for name, of_name in checks.items())


def _matrix_row(changed: str, overall: CaseVerdict, *checks: CaseVerdict) -> CaseMatrixRow:
    def worst(begins: Sequence[str]) -> Judgement | None:
        verdicts = [c.verdict for c in checks if c.check.startswith(tuple(begins))]
        return overall_verdict(verdicts) if verdicts else None

    return CaseMatrixRow(
        condition=overall.condition,
        margin=worst([MARGIN]),
        response=worst(RESPONSE),
        verdict=overall.verdict,
        where=overall.where,
        start=worst((*START, *STRENGTH, *REVERSAL, *STARTS, *EVENTS)),
        changed=changed,
    )


def _changed(row: StartConditionRow, synchronous: float | None) -> Iterator[str]:
    """What a row changes of the case, in words."""
    if row.kind == ConditionKind.STEADY:
        yield "steady operation"
    if row.event:
        yield f"event {row.event}"
    if row.voltage is not None:
        yield f"{100.0 * row.voltage:.6g} % voltage"
    if row.load is not None:
        yield f"{100.0 * row.load:.6g} % load"
    if row.damping_ratio is not None:
        yield f"damping {100.0 * row.damping_ratio:.4g} %"
    if row.stiffness_factor is not None:
        yield f"couplings × {row.stiffness_factor:.4g}"
    if row.trip_speed is not None and synchronous:
        yield f"trip at {100.0 * row.trip_speed / synchronous:.4g} % speed"
