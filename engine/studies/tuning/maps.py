"""The map of a tuning study: starts and margins over the first two variables, or the only one.

Of more than two variables a cell shows the best combination over the others.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from engine.studies.tuning.combinations import TuningPlan
from engine.studies.tuning.evaluate import EvaluatedCombination
from engine.studies.tuning.options import Variable


@dataclass(frozen=True)
class TuningMap:
    """Combinations over one or two variables."""

    across: Variable  #: The variable along the map. [SI]
    up: Variable | None  #: The one across it; None = a single row. [SI]
    #: One row an option of `up`, one entry an option of `across`; None = not calculated. [SI]
    cells: tuple[tuple[EvaluatedCombination | None, ...], ...]
    best_over: tuple[str, ...]  #: Variables that are at their best in each cell.


def tuning_map(
    plan: TuningPlan, ranked: Sequence[EvaluatedCombination], *, across: int = 0, up: int | None = 1
) -> TuningMap:
    """The best combination of each pair of options.

    Parameters
    ----------
    plan : TuningPlan
        What was to be tried. [SI]
    ranked : sequence of EvaluatedCombination
        Combinations, the best first. [SI]
    across, up : int, optional
        The variables of the map; without a second one it has a single row. [indices]

    Returns
    -------
    TuningMap
        Cells with the best of what was calculated. [SI]
    """
    if up is not None and up >= len(plan.variables):
        up = None
    best: dict[tuple[int, int], EvaluatedCombination] = {}
    for tried in ranked:
        picked = tried.combination.picked
        if picked:
            best.setdefault((0 if up is None else picked[up], picked[across]), tried)
    drawn = {across} if up is None else {across, up}
    rows = 1 if up is None else len(plan.variables[up].options)
    return TuningMap(
        plan.variables[across],
        None if up is None else plan.variables[up],
        tuple(_row(best, j, len(plan.variables[across].options)) for j in range(rows)),
        tuple(v.title for i, v in enumerate(plan.variables) if i not in drawn),
    )


def _row(
    best: Mapping[tuple[int, int], EvaluatedCombination], row: int, length: int
) -> tuple[EvaluatedCombination | None, ...]:
    return tuple(best.get((row, i)) for i in range(length))
