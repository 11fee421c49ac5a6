"""Peaks over their limits, and the limit of a history: one rule for sheet Summary and the report."""

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
from engine.fatigue.shaft_strength import shaft_strength
from engine.results.verdicts import yield_torque
from engine.start.start_fatigue import judged_shafts

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


@dataclass(frozen=True)
class Limit:
    """What a history may reach, in the unit of the history."""

    words: str  #: What the limit is.
    lower: float  #: Zero or negative. [N m or shown unit]
    upper: float  #: [N m or shown unit]


def limit_of_torque(case: CaseData, run: RunView, name: str) -> Limit | None:
    """The limit drawn in the history of an element: the first that it has of those that decide.

    Parameters
    ----------
    case : CaseData
        The inputs. [SI]
    run : RunView
        The results. [SI]
    name : str
        The element. [name]

    Returns
    -------
    Limit or None
        Of a shaft that the start damages its endurance limit, over SCF or Kf, which is for the alternating part; else
        the Peak torque limit with the Reversal limit, the endurance limit all the same, the shear yield. [N m]
    """
    element = next(e for e in case.elements if e.element == name)
    amplitude, endurance = run.amplitudes.get(name, (0.0, 0.0))
    fatigue = None
    if any(e is element for _, e in judged_shafts(case)):
        strength = shaft_strength(case, element)
        notch = "SCF" if strength.notch.fatigue == (element.scf or 1.0) else "Kf"
        torque = strength.curve.endurance / strength.local
        fatigue = Limit(f"endurance limit / {notch} (alternating)", -torque, torque)
    if endurance and amplitude > endurance and fatigue is not None:
        return fatigue
    peak, reversal = element.peak_torque_limit, element.reversal_limit
    if peak:
        if reversal is None:
            return Limit("peak torque limit", -peak, peak)
        return Limit("peak torque and reversal limits", -reversal, peak)
    judged = yield_torque(case).get(name)
    if fatigue is None and judged is not None:
        return Limit("shear yield", -judged[1] / judged[0], judged[1] / judged[0])
    return fatigue


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
    run: RunView, drawn: Drawn, limit: Limit | None, labels: dict[str, Cell]
) -> tuple[Rows, Rows]:
    """Rows of `ChartGoverning` and of `ChartBulges`: history, speed and limit; and where the modes are named.

    Parameters
    ----------
    run : RunView
        The results. [SI]
    drawn : Drawn
        The governing history.
    limit : Limit or None
        What it may reach. [shown unit]
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
        ends = [float(drawn.time[0]), float(drawn.time[-1])]
        columns[4] = [*plain(ends), None, *plain(ends)]
        columns[5] = [*plain([limit.upper] * 2), None, *plain([limit.lower] * 2)]
        words = f"; dashed: {limit.words}"
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
