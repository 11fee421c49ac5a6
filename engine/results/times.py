"""What each analysis of a run cost, and how accurate it was."""

from __future__ import annotations

from collections.abc import Iterable

from engine.case.defaults import DEFAULT_TOLERANCE_PEAK, DEFAULT_TOLERANCE_STARTS
from engine.case.effects import EFFECTS
from engine.plan.plan import Plan
from engine.results.results import AccuracyRow, Results

#: Name of the analysis of events in operation.
EVENTS = "events in operation"


def _totals(spent: Iterable[tuple[str, float]]) -> dict[str, float]:
    """Wall time of each analysis, its repetitions added up."""
    total: dict[str, float] = {}
    for name, wall in spent:
        total[name] = total.get(name, 0.0) + wall
    return total


def measured_times(plan: Plan, spent: list[tuple[str, float]]) -> dict[str, float]:
    """Wall time of the effects that have an analysis of their own.

    Parameters
    ----------
    plan : Plan
        The plan of the start. [mixed]
    spent : list of (str, float)
        Wall time of each analysis, in the order in which they ended. [s]

    Returns
    -------
    dict of str to float
        Effect → wall time. [s]
    """
    total = _totals(spent)
    return {
        name: total[effect.analysis]
        for name, effect in EFFECTS.items()
        if effect.analysis in total and plan.decision(name).on
    }


def accuracy_of(results: Results) -> tuple[AccuracyRow, ...]:
    """Estimated error and time of each analysis of a run, its repetitions added up."""
    case, start, total = results.case, results.start, _totals(results.spent)
    last = "start with events" if "start with events" in total else "start"
    rows = []
    for name, wall in total.items():
        setting, peak, starts = "", None, None
        if start is not None and name == last:
            wanted = case.tolerance_peak or DEFAULT_TOLERANCE_PEAK
            setting = f"{start.method}, tolerance {wanted:.2g}, step {start.step:.3g} s"
            peak = start.estimated_error
        if name == EVENTS:
            responses = [e.response for e in results.events if e.response is not None]
            setting = f"tolerance {case.tolerance_peak or DEFAULT_TOLERANCE_PEAK:.2g}"
            peak = max((r.estimated_error for r in responses), default=None)
        if name == "fatigue":
            setting = f"tolerance {case.tolerance_starts or DEFAULT_TOLERANCE_STARTS:.2g}"
            starts = max((e for _, e in results.starts_error if e is not None), default=None)
        rows.append(AccuracyRow(name, setting, peak, starts, wall))
    return tuple(rows)
