"""The numbers behind the charts of the effects: reversal, blow, forces, field and trip.

Which words stand above a chart depends on what the run showed: a chart without lines says why.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from addin.calculation.calculation import RunView
from addin.charts.rows import Cell, Floats, Rows, decimate, plain, side_by_side
from addin.contract.chart_tables import EVENTS, FORCES
from addin.contract.shown_units import ShownUnits

#: Periods of the 2 × slip frequency drawn on each side of the deepest moment: all of the reversal,
#: and a blow closely; the shortest and the longest time. [1, s]
_REVERSAL_PERIODS, _BLOW_PERIODS, _TIMES = 8.0, 1.2, (0.05, 0.6)
#: Share of the shortest and the longest time for the close view.
_CLOSE = 0.15
#: Points of each force, and of the load angle.
_FORCE_POINTS, _ANGLE_POINTS = 601, 1001
#: Slip cycles drawn before the field is applied.
_CYCLES_BEFORE = 0.25
_ANGLE_AXIS, _FORCE_AXIS = "Load angle [degrees]", "Force"
_NO_TEETH, _NO_START = "no gear mesh and no geared coupling", "no start was calculated"


def waiting_labels() -> dict[str, Cell]:
    """Words of a workbook that has not been calculated."""
    waiting = "(not calculated yet)"
    return {
        "Reversal title": f"Torque around the deepest reversal {waiting}",
        "Reversal axis": "Torque",
        "Blow title": f"Torque around its minimum, enlarged {waiting}",
        "Blow axis": "Torque",
        "Force title": f"Tooth and bearing forces {waiting}",
        "Force axis": _FORCE_AXIS,
        "Pull-in title": f"Load angle and slip {waiting}",
        "Pull-in axis": _ANGLE_AXIS,
    }


# --- teeth ----------------------------------------------------------------------------------------


def reversal_blocks(
    run: RunView | None, units: ShownUnits, labels: dict[str, Cell]
) -> dict[str, Rows]:
    """Torque of the mesh or geared coupling with the least margin around its least torque.

    Parameters
    ----------
    run : RunView or None
        The results. [SI]
    units : ShownUnits
        Units shown on the sheets. [units]
    labels : dict
        Words shown by charts; titles and axes are entered.

    Returns
    -------
    dict of str to list of rows
        `ChartReversal`, the whole of it, `ChartBlow`, its deepest moment closely, and
        `ChartForces`, the forces at that moment.
    """
    empty: dict[str, Rows] = {
        "ChartReversal": [[None, None]],
        "ChartBlow": [[None, None]],
        "ChartForces": [[None] * (2 * FORCES)],
    }
    if run is None:
        return empty
    histories = run.histories or {}
    judged = [r for r in run.tables.get("TorqueReversals", ()) if r["element"] in histories]
    axis = f"Torque [{units.name('TorqueReversals', 'Minimum torque')}]"
    labels["Reversal axis"] = labels["Blow axis"] = axis
    labels["Force axis"] = f"Force [{units.name('TorqueReversals', 'Tooth force')}]"
    if not judged:
        why = _NO_TEETH if histories else _NO_START
        labels["Reversal title"] = f"Torque around the deepest reversal: {why}"
        labels["Blow title"] = f"Torque around its minimum, enlarged: {why}"
        labels["Force title"] = f"Tooth and bearing forces: {why}"
        return empty
    worst = min(judged, key=_depth)
    name, (time, torque) = worst["element"], histories[worst["element"]]
    labels["Reversal title"] = f"{name}: torque around its minimum in the start"
    labels["Blow title"] = _blow_words(worst)
    deepest, slip = float(time[np.argmin(torque)]), worst.get("slip_frequency") or 0.0
    size = units.factor("TorqueReversals", "Minimum torque")
    blocks = dict(empty)
    near, wide = (_window(deepest, slip, p, s) for p, s in _VIEWS)
    for table, window in (("ChartReversal", wide), ("ChartBlow", near)):
        t, value = _cut(time, torque / size, window)
        blocks[table] = side_by_side([plain(t), plain(value)])
    blocks["ChartForces"] = force_rows(run, units, name, near, labels)
    return blocks


_VIEWS = ((_BLOW_PERIODS, _CLOSE), (_REVERSAL_PERIODS, 1.0))


def _blow_words(worst: Mapping[str, Any]) -> str:
    """Title of the close view: what is to be seen there."""
    name = worst["element"]
    if worst.get("model") != "clearance":
        return f"{name}: torque at its minimum, teeth assumed in contact"
    if not worst.get("impacts"):
        return f"{name}: torque at its minimum, teeth stay in contact"
    if worst["minimum_torque"] < 0.0:
        return f"{name}: teeth separate (torque zero), cross the gap and strike the back flank (below zero)"
    return f"{name}: teeth separate (torque zero) and re-engage on the drive flank"


def _depth(reversal: Mapping[str, Any]) -> tuple[float, float]:
    """Margin to reversal; of elements without one the least torque."""
    margin = reversal.get("margin")
    return (math.inf if margin is None else margin), reversal["minimum_torque"]


def _window(at: float, frequency: float, periods: float, share: float) -> tuple[float, float]:
    """Times from so many periods before a moment to as many after it. [s]"""
    shortest, longest = (share * one for one in _TIMES)
    half = min(max(periods / frequency if frequency > 0.0 else longest, shortest), longest)
    return at - half, at + half


def _cut(
    time: Floats, value: Floats, window: tuple[float, float], *limit: int
) -> tuple[Floats, Floats]:
    """The part of a history inside a window, thinned."""
    near = (time >= window[0]) & (time <= window[1])
    t, v = time[near], value[near]
    keep = decimate(t, v, *limit)
    return t[keep], v[keep]


def force_rows(
    run: RunView,
    units: ShownUnits,
    element: str,
    window: tuple[float, float],
    labels: dict[str, Cell],
) -> Rows:
    """Normal tooth force of a mesh and radial forces of its gears in a window of time.

    Parameters
    ----------
    run : RunView
        The results. [SI]
    units : ShownUnits
        Units shown on the sheets. [units]
    element : str
        The mesh. [name]
    window : tuple of float
        First and last time. [s]
    labels : dict
        Words shown by charts; title and names are entered.

    Returns
    -------
    list of rows
        Time and force, pair by pair.
    """
    columns: list[Sequence[Cell]] = [[] for _ in range(2 * FORCES)]
    forces, shown = run.forces, units.factor("TorqueReversals", "Tooth force")
    drawn: list[tuple[str, Floats, Floats]] = []
    if forces is not None and run.speed_time is not None:
        time, torque = (run.histories or {})[element]
        force = _tooth_force(run, element, torque)
        if force is not None:
            drawn.append((f"{element}: normal tooth force", time, force))
        sampled = run.speed_time[0]
        for gear in _gears_of(run, element, forces.bearings):
            row = forces.bearing_force[forces.bearings.index(gear)]
            drawn.append((f"{gear}: radial bearing force", sampled, row))
    for k in range(len(drawn), FORCES):
        labels[f"Force {k + 1}"] = "(no further force)"
    for k, (name, time, force) in enumerate(drawn[:FORCES]):
        t, value = _cut(time, force / shown, window, _FORCE_POINTS)
        columns[2 * k], columns[2 * k + 1] = plain(t), plain(value)
        labels[f"Force {k + 1}"] = name
    labels["Force title"] = f"{element}: {_force_words(bool(drawn))}"
    return side_by_side(columns)


def _force_words(drawn: bool) -> str:
    if drawn:
        return "forces at minimum torque (tooth force below zero: back flank)"
    return "no forces shown: no mesh with clearance and no gear on bearings"


def _tooth_force(run: RunView, element: str, torque: Floats) -> Floats | None:
    """Normal force of a mesh: its torque times the ratio of the sampled ones, turning points too."""
    assert run.forces is not None
    row = next((r for r in run.tables["TorqueReversals"] if r["element"] == element), {})
    if element not in run.forces.teeth or not torque.size:
        return None
    largest = float(np.max(np.abs(torque)))
    sampled = run.forces.tooth_force[run.forces.teeth.index(element)]
    force = row.get("tooth_force") or float(np.max(np.abs(sampled), initial=0.0))
    return torque * (force / largest) if largest > 0.0 else None


def _gears_of(run: RunView, element: str, bearings: Sequence[str]) -> list[str]:
    """Gears on bearings at the ends of a mesh."""
    ends = [end for e in run.case.elements if e.element == element for end in (e.from_, e.to)]
    return [gear for gear in ends if gear is not None and gear in bearings]


# --- the field and the trip -----------------------------------------------------------------------


def pull_in_rows(run: RunView | None, labels: dict[str, Cell]) -> Rows:
    """Load angle in degrees and slip in % from shortly before the field is applied.

    Parameters
    ----------
    run : RunView or None
        The results. [SI]
    labels : dict
        Words shown by charts; title and axis are entered.

    Returns
    -------
    list of rows
        Time, load angle, time and slip. [s, degrees, s, %]
    """
    if run is None:
        return [[None] * 4]
    labels["Pull-in axis"] = _ANGLE_AXIS
    field = (run.startup or {}).get("pull_in")
    line = run.case.ratings.line_frequency
    if field is None or run.load_angle is None or not line:
        why = "no field is applied in this start" if run.speed_time is not None else _NO_START
        labels["Pull-in title"] = f"Load angle and slip: {why}"
        return [[None] * 4]
    time, angle, slip = run.load_angle
    cycle = 1.0 / (line * field["field_slip"]) if field["field_slip"] > 0.0 else 0.0
    window = (field["field_time"] - _CYCLES_BEFORE * cycle, float(time[-1]))
    turns = angle[-1] if field["synchronised"] else np.interp(field["field_time"], time, angle)
    shown = np.degrees(angle) - 360.0 * round(float(turns) / (2.0 * math.pi))
    words = (
        "the motor pulls into step"
        if field["synchronised"]
        else "not synchronised, one pole slip per 360 degrees of load angle"
    )
    labels["Pull-in title"] = f"Load angle and slip, field applied: {words}"
    columns: list[Sequence[Cell]] = []
    for value in (shown, 100.0 * slip):
        t, v = _cut(time, value, window, _ANGLE_POINTS)
        columns += [plain(t), plain(v)]
    return side_by_side(columns)


def event_rows(run: RunView | None, labels: dict[str, Cell]) -> Rows:
    """Field application and trip as points of the chart of speed against time.

    Parameters
    ----------
    run : RunView or None
        The results. [SI]
    labels : dict
        Words shown by charts; the names of the points are entered.

    Returns
    -------
    list of rows
        Time and motor speed, always `EVENTS` rows. [s, rpm]
    """
    rows: Rows = [[None, None] for _ in range(EVENTS)]
    if run is None or run.speed_time is None:
        return rows
    time, speed = run.speed_time
    start = run.startup or {}
    happened: list[tuple[str, float]] = []
    if start.get("pull_in"):
        field = start["pull_in"]
        happened.append((f"Field on at {field['field_slip']:.1%} slip", field["field_time"]))
    if start.get("outcome") == "tripped":
        happened.append(("Trip", float(time[np.argmax(speed)])))
    for k, (words, at) in enumerate(happened[:EVENTS]):
        rpm = float(np.interp(at, time, speed)) * 30.0 / math.pi
        rows[k] = plain([at, rpm])
        labels[f"Event {k + 1}"] = words
    return rows
