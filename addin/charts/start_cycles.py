"""The cycles behind the allowable starts of the governing shaft, for table `StartCycles`.

An auditor follows n, N and n/N of the most damaging cycles to their sum; what is not listed stands
in one last row, so that the sum is the damage of one start.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from addin.calculation.calculation import RunView
from addin.charts.data import governing_shaft
from engine.fatigue.shaft_strength import shaft_strength
from engine.fatigue.sn_curve import SNCurve

#: Most rows of table `StartCycles`.
LISTED_CYCLES = 40


def start_cycle_rows(run: RunView) -> list[dict[str, Any]]:
    """Rows of table `StartCycles`.

    Parameters
    ----------
    run : RunView
        The results. [SI]

    Returns
    -------
    list of dict
        Largest damage first; the rest of the cycles, without an amplitude, last. [SI]
    """
    shaft = governing_shaft(run)
    if shaft is None:
        return []
    curve = _curve(run, shaft)
    amplitude, count = next((a, n) for name, a, n in run.cycles if name == shaft)
    if not amplitude.size:
        largest, _ = run.amplitudes.get(shaft, (0.0, 0.0))
        return [_row(largest, 1.0, float(curve.cycles_to_failure(largest)))] if largest else []
    life = curve.cycles_to_failure(amplitude)
    order = np.lexsort((-amplitude, -count / life))
    damaging = int(np.count_nonzero(np.isfinite(life)))
    listed = damaging if damaging <= LISTED_CYCLES else LISTED_CYCLES - 1
    chosen = order[: max(listed, 1)]
    rows = [_row(*map(float, (amplitude[k], count[k], life[k]))) for k in chosen]
    if damaging > listed:
        rest = order[listed:damaging]
        cycles, damage = float(count[rest].sum()), float((count[rest] / life[rest]).sum())
        rows.append(_row(None, cycles, cycles / damage))
    return rows


def start_cycle_facts(run: RunView) -> Mapping[str, Any]:
    """Shaft, S-N exponent and endurance limit that the rows belong to.

    Parameters
    ----------
    run : RunView
        The results. [SI]

    Returns
    -------
    mapping
        ``shaft``, ``exponent`` (of the last part of the line) and ``endurance`` [Pa]; None where
        no shaft is judged.
    """
    shaft = governing_shaft(run)
    curve = None if shaft is None else _curve(run, shaft)
    return {
        "shaft": shaft,
        "exponent": None if curve is None else float(curve.slope[-1]),
        "endurance": None if curve is None else curve.endurance,
    }


def _curve(run: RunView, shaft: str) -> SNCurve:
    """The S-N line of a judged shaft in torsion."""
    return shaft_strength(run.case, next(e for e in run.case.elements if e.element == shaft)).curve


def _row(amplitude: float | None, cycles: float, life: float) -> dict[str, Any]:
    return {
        "amplitude": amplitude,
        "cycles": cycles,
        "cycles_to_failure": life,
        "damage": cycles / life,
    }
