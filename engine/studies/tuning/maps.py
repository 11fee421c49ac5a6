"""The map of a tuning study: starts and margins over the first two variables, or the only one.

Of more than two variables a cell shows the best combination over the others.
"""

from __future__ import annotations

from collections.abc import Sequence
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


def tuning_map(plan: TuningPlan, ranked: Sequence[EvaluatedCombination]) -> TuningMap:
    """The best combination of each pair of options.

    Parameters
    ----------
    plan : TuningPlan
        What was to be tried. [SI]
    ranked : sequence of EvaluatedCombination
        Combinations, the best first. [SI]

    Returns
    -------
    TuningMap
        Cells with the best of what was calculated. [SI]
    """
    across, *others = plan.variables
    up = others[0] if others else None
    best: dict[tuple[int, ...], EvaluatedCombination] = {}
    for tried in ranked:
        best.setdefault(tried.combination.picked[:2], tried)
    places = [()] if up is None else [(j,) for j in range(len(up.options))]
    return TuningMap(
        across,
        up,
        tuple(tuple(best.get((i, *place)) for i in range(len(across.options))) for place in places),
        tuple(v.title for v in others[1:]),
    )
