"""The numbers behind two charts of sheet Summary: every peak over its limit, and the governing history with its limit."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from addin.calculation.calculation import RunView
from addin.charts.rows import Cell, Floats, Rows, decimate, plain, side_by_side, thinned
from addin.contract.chart_tables import CROSSINGS
from engine.case.choices import StressBasis
from engine.case.data import CaseData
from engine.results.verdicts import yield_torque

#: Points of the curve of speed.
_SPEED_POINTS = 61
#: Where the name of a mode stands: at the largest value from so much before its crossing to so much behind it, as
#: shares of the start. [1]
_BEFORE, _BEHIND = 0.01, 0.06
#: Room that the name of a mode takes, as shares of the start and of the values. [1]
_NAME_WIDTH, _NAME_HEIGHT = 0.13, 0.08
#: Most elements on the chart of the peaks; those nearest to a limit are drawn.
_ELEMENTS = 14


@dataclass(frozen=True)
class Drawn:
    """A history as it is drawn."""

    element: str  #: Its element.
    time: Floats  #: [s]
    value: Floats  #: [shown unit]
    words: str  #: What it is.
    axis: str  #: Title of its axis, with the unit.
    per_torque: float  #: Shown value of a torque of one. [shown unit / N m]


def peak_shares(case: CaseData, run: RunView | None) -> dict[str, dict[str, float]]:
    """Every peak that has a limit, over this limit.

    Parameters
    ----------
    case : CaseData
        The inputs. [SI]
    run : RunView or None
        The results. [SI]

    Returns
    -------
    dict of str to dict of str to float
        Element → column of `ChartPeaks` → peak over limit; elements without any limit are left out. [1]
    """
    shares: dict[str, dict[str, float]] = {}
    tables: Mapping[str, Sequence[Mapping[str, Any]]] = run.tables if run else {}

    def note(element: Any, column: str, peak: Any, limit: Any) -> None:
        if peak is not None and limit:
            of_element = shares.setdefault(str(element), {})
            of_element[column] = max(of_element.get(column, 0.0), abs(peak) / abs(limit))

    judged = yield_torque(case)
    for row in tables.get("MakerSheet", ()):
        element = row["element"]
        note(element, "Peak torque", row.get("peak_torque"), row.get("peak_torque_limit"))
        note(element, "Reversing torque", row.get("reversing_torque"), row.get("reversal_limit"))
        note(element, "Vibratory torque", row.get("vibratory_torque"), row.get("vibratory_limit"))
        if element in judged and row.get("peak_torque") is not None:
            per_torque, limit = judged[element]
            note(element, "Shear stress", per_torque * row["peak_torque"], limit)
    is_range = case.stress_basis != StressBasis.ZERO_TO_PEAK
    stress = "peak_to_peak_stress" if is_range else "zero_to_peak_stress"
    for row in tables.get("SteadyState", ()):
        note(row["element"], "Steady stress", row.get(stress), row.get("allowable"))
    return shares


#: Columns of `ChartPeaks` behind the element.
PEAK_COLUMNS = (
    "Peak torque", "Reversing torque", "Shear stress", "Vibratory torque", "Steady stress",
)  # fmt: skip


def peak_rows(case: CaseData, shares: Mapping[str, Mapping[str, float]]) -> Rows:
    """Rows of `ChartPeaks`, in the order of the train: peaks in per cent of their limits, and the limit."""
    if not shares:
        return [[None] * (2 + len(PEAK_COLUMNS))]
    nearest = sorted(shares, key=lambda name: -max(shares[name].values()))[:_ELEMENTS]
    order = [str(e.element) for e in case.elements if e.element in nearest]
    rows: Rows = []
    for name in order:
        cells: list[Cell] = [name]
        for column in PEAK_COLUMNS:
            share = shares[name].get(column)
            cells.append(None if share is None else plain([100.0 * share])[0])
        rows.append([*cells, 100.0])
    return rows


def history_rows(
    run: RunView, drawn: Drawn, limit: tuple[str, float, float] | None, labels: dict[str, Cell]
) -> tuple[Rows, Rows]:
    """Rows of `ChartGoverning` and of `ChartBulges`: history, speed and limit; and where the modes are named.

    Parameters
    ----------
    run : RunView
        The results. [SI]
    drawn : Drawn
        The governing history.
    limit : tuple of str and float, or None
        What the limit is, its lower and its upper value. [shown unit]
    labels : dict
        Words of the charts; added to.

    Returns
    -------
    tuple of list of rows
    """
    keep = decimate(drawn.time, drawn.value)
    columns: list[Sequence[Cell]] = [
        plain(drawn.time[keep]),
        plain(drawn.value[keep]),
        [],
        [],
        [],
        [],
    ]
    synchronous = run.case.ratings.synchronous_speed
    if run.speed_time is not None and synchronous:
        time, speed = run.speed_time
        few = thinned(time, speed, _SPEED_POINTS)
        columns[2], columns[3] = plain(time[few]), plain(100.0 * speed[few] / synchronous)
    words = ""
    if limit is not None:
        name, lower, upper = limit
        ends = [float(drawn.time[0]), float(drawn.time[-1])]
        columns[4] = [*plain(ends), None, *plain(ends)]
        columns[5] = [*plain([upper, upper]), None, *plain([lower, lower])]
        words = f"; dashed: {name}"
    labels["Governing title"] = f"{drawn.element}: {drawn.words}{words}"
    labels["Governing axis"] = drawn.axis
    bulges: Rows = [[None, None] for _ in range(CROSSINGS)]
    length = float(drawn.time[-1] - drawn.time[0])
    crossings = [c for c in run.tables.get("StartupCrossings", ()) if c.get("time") is not None]
    height = float(np.ptp(drawn.value))
    named: list[tuple[float, float]] = []
    for k, crossing in enumerate(crossings[:CROSSINGS]):
        begin, end = crossing["time"] - _BEFORE * length, crossing["time"] + _BEHIND * length
        near = np.flatnonzero((drawn.time >= begin) & (drawn.time <= end))
        if near.size:
            at = int(near[np.argmax(drawn.value[near])])
            place, value = float(drawn.time[at]), float(drawn.value[at])
            for other, above in named:  # two names would cover each other
                if abs(place - other) < _NAME_WIDTH * length:
                    value = max(value, above + _NAME_HEIGHT * height)
            named.append((place, value))
            bulges[k] = plain([place, value])
    return side_by_side(columns), bulges
