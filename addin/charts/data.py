"""The numbers behind the charts: blocks of rows for the tables of sheet `ChartData`.

Every block is an Excel table. The writer resizes it, and chart ranges that cover a whole column
of it follow, so that a chart never shows old rows. A blank row in a block is a gap in its line.
Values leave here in the units shown on the sheets.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from addin.calculation.calculation import RunView
from addin.charts.effects import event_rows, pull_in_rows, reversal_blocks, waiting_labels
from addin.charts.limits import (
    Drawn,
    Limit,
    history_rows,
    limit_of_torque,
    peak_rows,
    peak_shares,
)
from addin.charts.rows import Cell, Floats, Rows, decimate, plain, side_by_side
from addin.contract.chart_tables import (
    CHART_TABLES,
    CROSSINGS,
    GROUPS,
    HISTORIES,
    LABELS,
    LINES,
    METHODS,
    SHAPES,
)
from addin.contract.shown_units import ShownUnits
from engine.case.data import CaseData, ElementRow
from engine.errors import TorsionError
from engine.fatigue.shaft_strength import notch_effect, shaft_strength
from engine.fatigue.sn_curve import SNCurve, sn_curve_for
from engine.fatigue.stress import stress_of_unit_torque
from engine.model.links import shaft_stiffness
from engine.model.sections import Section, sections_of, series_stiffness
from engine.numerics.distinct import distinct

#: Most points of a drawn curve that has no spikes.
_CURVE_POINTS = 401
_SN_POINTS = 200
#: Crossings nearer to each other than this share of synchronous speed have one name. [1]
_SAME_LABEL = 0.06
#: Title of a history chart without an element.
_UNUSED = "not used: the train has no further element"
#: A series whose name is a blank cell is called Series1 by Excel; a space is not.
_BLANK_LABEL = " "
#: Amplitudes below this share of the largest are not drawn. [1]
_SMALLEST_CYCLE = 0.03


#: Title of the chart of all peaks.
_PEAKS = "Peaks in % of their limits"
#: Axis of the chart of sheet Effects and accuracy.
_ACCURACY_AXIS = "Error [%]"


def chart_blocks(
    case: CaseData, units: ShownUnits, run: RunView | None = None, chosen: Sequence[str | None] = ()
) -> dict[str, Rows]:
    """Rows of every chart table.

    Parameters
    ----------
    case : CaseData
        The inputs; enough for the drawing, the torque curves and the S-N line. [SI]
    units : ShownUnits
        Units shown on the sheets. [units]
    run : RunView, optional
        The results; without them the other blocks are one blank row. [SI]
    chosen : sequence of (str or None)
        Elements whose histories are drawn; blank places are chosen by `_drawn_elements`. [names]

    Returns
    -------
    dict of str to list of rows
        By the names of `CHART_TABLES`.
    """
    labels: dict[str, Cell] = dict.fromkeys(LABELS, _BLANK_LABEL) if run else _waiting_labels()
    blocks = {
        "ChartTrain": _train_rows(case, labels),
        "ChartTorque": _torque_rows(case, run),
        "ChartMotor": _motor_rows(case, run, units, labels),
        "ChartProfile": _profile_rows(case, units, labels),
        "ChartMotorEvent": _motor_event_rows(run, units, labels),
        "ChartClearing": _clearing_rows(run, units, labels),
        "ChartSpeedTime": _speed_time_rows(run),
        "ChartCrossings": _crossing_rows(case, run, labels),
        "ChartSN": _sn_rows(case, run, units, labels),
    }
    blocks["ChartInterference"], blocks["ChartNames"] = _interference_rows(case, run, labels)
    blocks["ChartHistory"] = _history_rows(case, run, units, chosen, labels)
    shares = peak_shares(case, run)
    blocks["ChartPeaks"] = peak_rows(case, shares)
    if run is not None:
        labels["Peaks title"] = _PEAKS if shares else f"{_PEAKS}: no element has a limit"
    blocks["ChartGoverning"], blocks["ChartBulges"] = _governing_rows(
        case, run, units, shares, labels
    )
    blocks |= reversal_blocks(run, units, labels)
    blocks["ChartPullIn"] = pull_in_rows(run, labels)
    blocks["ChartEvents"] = event_rows(run, labels)
    blocks["ChartAccuracy"] = accuracy_block(_table(run, "AccuracyCost"))
    drawn = any(cell for row in blocks["ChartAccuracy"] for cell in row[1::3])
    labels |= {"Accuracy title": accuracy_title(drawn), "Accuracy axis": _ACCURACY_AXIS}
    _shape_labels(run, labels)
    blocks["ChartLabels"] = [[key, labels.get(key)] for key in LABELS]
    return {table.name: blocks[table.name] for table in CHART_TABLES}


def _waiting_labels() -> dict[str, Cell]:
    """Labels of a workbook that has not been calculated."""
    labels: dict[str, Cell] = dict.fromkeys(LABELS, _BLANK_LABEL)
    for k in range(1, HISTORIES + 1):
        labels[f"History title {k}"] = f"History {k} (not calculated yet)"
        labels[f"History axis {k}"] = "Torque"
        labels[f"History caption {k}"] = "not calculated yet"
    labels["Governing title"] = "Governing history (not calculated yet)"
    labels["Governing axis"] = "Torque"
    labels["Peaks title"] = f"{_PEAKS} (not calculated yet)"
    return labels | waiting_labels() | {f"Shape {k}": f"Mode {k}" for k in range(1, SHAPES + 1)}


# --- helpers --------------------------------------------------------------------------------------


def _segments(pieces: Iterable[Sequence[tuple[float, float]]]) -> tuple[list[Cell], list[Cell]]:
    """Polylines in one pair of columns, a blank between two of them."""
    xs: list[Cell] = []
    ys: list[Cell] = []
    for piece in pieces:
        if xs:
            xs.append(None)
            ys.append(None)
        xs += plain(x for x, _ in piece)
        ys += plain(y for _, y in piece)
    return xs, ys


#: Torques of a motor against speed, as tables `MotorTorque` and `MotorCurves` have them.
MOTOR_TORQUES = ("average", "pulsating", "pulsation_1")


# --- the train ------------------------------------------------------------------------------------


def _sequence(case: CaseData) -> list[tuple[str, Any]]:
    """Stations and elements in drawing order; ("", None) where a branch begins."""
    stations = {row.station: row for row in case.stations}
    if not case.elements:
        return [(name or "", row) for name, row in stations.items()]
    drawn: list[tuple[str, Any]] = []
    last: str | None = None
    for element in case.elements:
        if element.from_ != last:
            drawn += [("", None)] if drawn else []
            drawn.append((element.from_ or "", stations.get(element.from_)))
        drawn.append((element.element or "", element))
        drawn.append((element.to or "", stations.get(element.to)))
        last = element.to
    return drawn


def stiffnesses_of(case: CaseData) -> dict[str, float]:
    """Stiffness of each element, from its geometry or its sections where it is blank.

    Parameters
    ----------
    case : CaseData
        The case. [SI]

    Returns
    -------
    dict of str to float
        By element; 0 where neither is given. [N m/rad]
    """
    sections = sections_of(case)
    return {
        str(e.element): _stiffness_of(e, sections.get(str(e.element), ())) for e in case.elements
    }


def _stiffness_of(element: ElementRow, sections: Sequence[Section]) -> float:
    if element.stiffness is not None:
        return element.stiffness
    if element.od and element.length and element.shear_modulus:
        return shaft_stiffness(element.od, element.id or 0.0, element.length, element.shear_modulus)
    return series_stiffness(sections) if sections else 0.0


def _train_rows(case: CaseData, labels: dict[str, Cell]) -> Rows:
    """Discs with r ∝ J^(1/4), shafts with d ∝ k^(1/4): what equal thickness and length give."""
    ratios = case.speed_ratios
    group = {ratio: k % GROUPS for k, ratio in enumerate(dict.fromkeys(ratios.values()))}
    for ratio, k in reversed(group.items()):  # the first of those that share a colour stays
        labels[f"Speed group {k + 1}"] = _speed_words(case, ratio)
    disc = max([row.inertia or 0.0 for row in case.stations], default=0.0) or 1.0
    shafts = [e for e in case.elements if e.kind != "gear mesh"]
    stiffness = stiffnesses_of(case)
    shaft = max([stiffness[str(e.element)] for e in shafts], default=0.0) or 1.0
    rows: Rows = []
    for name, item in _sequence(case):
        row: list[Cell] = [name or None, *[None] * (4 * GROUPS + 2)]
        if isinstance(item, ElementRow):
            is_mesh = item.kind == "gear mesh"
            ends = [end for end in (item.from_, item.to) if end in ratios]
            place = (
                1 + 4 * GROUPS if is_mesh else 3 + 4 * group.get(ratios[ends[0]] if ends else 1, 0)
            )
            height = 0.3 if is_mesh else 0.62 * (stiffness[str(item.element)] / shaft) ** 0.25
        elif item is not None:
            place = 1 + 4 * group[ratios[name]]
            height = max(0.03, ((item.inertia or 0.0) / disc) ** 0.25)
        else:
            rows.append(row)
            continue
        row[place], row[place + 1] = plain([height, -height])
        rows.append(row)
    return rows or [[None] * (1 + 4 * GROUPS + 2)]


def _speed_words(case: CaseData, ratio: float) -> str:
    speed = case.ratings.synchronous_speed
    if speed is None:
        return f"{ratio:g} × motor speed"
    return f"{_rpm(speed) * ratio:,.0f} rpm"


def _rpm(speed: float) -> float:
    return speed * 30.0 / math.pi


# --- torque curves --------------------------------------------------------------------------------


def _torque_rows(case: CaseData, run: RunView | None) -> Rows:
    """All motors, all loads and their difference on one grid, referred to the motor, in pu."""
    rated = case.ratings.rated_torque
    ratios = case.speed_ratios
    motor = _calculated_curves(run) | _curves(case.motor_torque, MOTOR_TORQUES)
    load = _curves(case.load_torque, ("torque",))
    speeds = sorted({speed for points in (*motor.values(), *load.values()) for speed in points[0]})
    if not rated or not speeds:
        return [[None] * 6]
    grid = np.array(speeds)

    def total(curves: Mapping[str, tuple[list[float], ...]], column: int) -> Floats:
        referred = (
            np.interp(grid, points[0], points[column]) * ratios.get(station, 1.0) / rated
            for station, points in curves.items()
        )
        return sum(referred, np.zeros(grid.size))

    average, pulsating, at_slip = (total(motor, k) for k in (1, 2, 3))
    opposing = total(load, 1)
    columns = [
        plain(column)
        for column in (100.0 * grid, average, pulsating, at_slip, opposing, average - opposing)
    ]
    if not at_slip.any():
        columns[3] = []
    return side_by_side(columns)


def _motor_rows(
    case: CaseData, run: RunView | None, units: ShownUnits, labels: dict[str, Cell]
) -> Rows:
    """Torques of each motor with a data sheet, calculated and typed, in the unit of table `MotorCurves`."""
    labels["Motor title"] = "Motor torque calculated from its data, at rated voltage"
    labels["Motor axis"] = f"Torque [{units.name('MotorCurves', 'Average')}]"
    unit = units.factor("MotorCurves", "Average")
    calculated = _calculated_curves(run)
    typed = _curves(case.motor_torque, MOTOR_TORQUES)
    beside = {station: typed[station] for station in calculated if station in typed}
    scales = (0.01, unit, unit, unit)
    columns = [
        _segments([[(0.0, v / scale) for v in curve[k]] for curve in curves.values()])[1]
        if k < 3 or any(any(curve[k]) for curve in curves.values())
        else []
        for curves in (calculated, beside)
        for k, scale in enumerate(scales)
    ]
    return side_by_side(columns) or [[None] * len(columns)]


def _profile_rows(case: CaseData, units: ShownUnits, labels: dict[str, Cell]) -> Rows:
    """Sections of table `Sections` as rectangles, element after element, in its unit of Length."""
    stepped = [row for row in case.sections if row.element and row.length and row.od]
    names = dict.fromkeys(str(row.element) for row in stepped)
    listed = ", ".join(names) if names else "no element has rows in table Sections"
    labels["Profile title"] = f"Profile from From to To: {listed}"
    labels["Profile axis"] = f"Radius [{units.name('Sections', 'Length')}]"
    unit = units.factor("Sections", "Length")
    gap = 0.05 * sum(row.length or 0.0 for row in stepped)
    outlines: dict[str, list[list[tuple[float, float]]]] = {"outer": [], "hub": [], "bore": []}
    left = 0.0
    for name in names:
        for row in (r for r in stepped if r.element == name):
            right = left + (row.length or 0.0)
            first, last = 0.5 * (row.od or 0.0), 0.5 * (row.last_od or 0.0)
            corners = ((left, first), (right, last), (right, -last), (left, -first), (left, first))
            kind = "outer" if row.penetration is None else "hub"
            outlines[kind].append([(x / unit, y / unit) for x, y in corners])
            bore = 0.5 * (row.id or 0.0)
            if bore:
                lines = (((left, y), (right, y)) for y in (bore, -bore))
                outlines["bore"] += [[(x / unit, y / unit) for x, y in line] for line in lines]
            left = right
        left += gap
    columns = [column for pieces in outlines.values() for column in _segments(pieces)]
    return side_by_side(columns) or [[None] * len(columns)]


def _motor_event_rows(run: RunView | None, units: ShownUnits, labels: dict[str, Cell]) -> Rows:
    """Air-gap torque and the worst element's, in the unit of table `AirGapTorque`."""
    labels["Air-gap axis"] = f"Torque at own speed [{units.name('AirGapTorque', 'Largest')}]"
    if run is None or run.motor_event is None:
        labels["Air-gap title"] = "Air-gap torque: no event of table MotorEvents"
        labels["Air-gap element"] = "(no element)"
        return [[None] * 3]
    name, history = run.motor_event
    labels["Air-gap title"] = (
        f"Air-gap torque in event '{name}', and the element with the largest torque"
    )
    labels["Air-gap element"] = history.element
    unit = units.factor("AirGapTorque", "Largest")
    columns = (history.time, history.air_gap / unit, history.torque / unit)
    return side_by_side([plain(column) for column in columns])


def _clearing_rows(run: RunView | None, units: ShownUnits, labels: dict[str, Cell]) -> Rows:
    """Largest torques against clearing time, in the unit of table `AirGapTorque`."""
    labels["Clearing axis"] = f"Torque at own speed [{units.name('AirGapTorque', 'Largest')}]"
    if run is None or run.clearing is None:
        labels["Clearing title"] = (
            "Peak against clearing time: no event whose Clears after is worst"
        )
        labels["Clearing element"] = "(no element)"
        return [[None] * 3]
    name, worst = run.clearing
    of_each = f", worst {worst.turn} at each" if worst.turn else ""
    labels["Clearing title"] = f"Peak against clearing time of event '{name}'{of_each}"
    labels["Clearing element"] = worst.element
    unit = units.factor("AirGapTorque", "Largest")
    columns = (worst.clearing, worst.air_gap / unit, worst.torque / unit)
    return side_by_side([plain(column) for column in columns])


def _calculated_curves(run: RunView | None) -> dict[str, tuple[list[float], ...]]:
    """Speed, average and pulsating torques of each motor with a data sheet."""
    found: dict[str, tuple[list[float], ...]] = {}
    for row in _table(run, "MotorCurves"):
        curve = found.setdefault(row["station"], ([], [], [], []))
        values = (1.0 - row["slip"], *(row[name] for name in MOTOR_TORQUES))
        for column, value in zip(curve, values, strict=True):
            column.append(value)
    return found


def _curves(rows: Iterable[Any], names: Sequence[str]) -> dict[str, tuple[list[float], ...]]:
    """Speed and the named columns of each station, incomplete rows left out, speeds rising."""
    found: dict[str, list[tuple[float, ...]]] = {}
    for row in rows:
        values = [getattr(row, name) for name in names]
        if row.station and row.speed is not None and values[0] is not None:
            point = (row.speed, *(value or 0.0 for value in values))
            found.setdefault(row.station, []).append(point)
    return {
        station: tuple(list(column) for column in zip(*sorted(points), strict=True))
        for station, points in found.items()
    }


# --- start-up -------------------------------------------------------------------------------------


def _speed_time_rows(run: RunView | None) -> Rows:
    if run is None or run.speed_time is None:
        return [[None, None]]
    time, speed = run.speed_time
    keep = distinct(np.searchsorted(time, np.linspace(time[0], time[-1], _CURVE_POINTS)))
    return side_by_side([plain(time[keep]), plain(map(_rpm, speed[keep]))])


def _crossing_rows(case: CaseData, run: RunView | None, labels: dict[str, Cell]) -> Rows:
    """The first crossings of the start as points; always the same number of rows."""
    rows: Rows = [[None, None] for _ in range(CROSSINGS)]
    speed = case.ratings.synchronous_speed or 0.0
    crossings = [c for c in _table(run, "StartupCrossings") if c.get("time") is not None]
    named, last = -1, math.inf
    for k, crossing in enumerate(crossings[:CROSSINGS]):
        rows[k] = plain([crossing["time"], _rpm(speed * crossing["percent_speed"])])
        words = f"{crossing['frequency']:.1f} Hz"
        if crossing.get("multiple_of_slip") == 1:
            words += " (1 × slip)"
        if abs(last - crossing["percent_speed"]) < _SAME_LABEL:  # two names would cover each other
            labels[f"Crossing {named + 1}"] = f"{labels[f'Crossing {named + 1}']}; {words}"
        else:
            named, last = k, crossing["percent_speed"]
            labels[f"Crossing {k + 1}"] = words
    return rows


def _table(run: RunView | None, name: str) -> Sequence[Mapping[str, Any]]:
    return run.tables.get(name, ()) if run else ()


def _history_rows(
    case: CaseData,
    run: RunView | None,
    units: ShownUnits,
    chosen: Sequence[str | None],
    labels: dict[str, Cell],
) -> Rows:
    histories = (run.histories if run else None) or {}
    columns: list[Sequence[Cell]] = [[] for _ in range(2 * HISTORIES)]
    for k, name in enumerate(_drawn_elements(case, histories, chosen)):
        if name is None:
            if run is not None:
                labels[f"History title {k + 1}"] = _UNUSED
                labels[f"History axis {k + 1}"] = "Torque"
                labels[f"History caption {k + 1}"] = _UNUSED
            continue
        time, torque = histories[name]
        value, words, axis = _drawn_quantity(case, name, torque, units)
        keep = decimate(time, value)
        columns[2 * k], columns[2 * k + 1] = plain(time[keep]), plain(value[keep])
        labels[f"History title {k + 1}"] = f"{name}: {words}"
        labels[f"History axis {k + 1}"] = axis
        labels[f"History caption {k + 1}"] = f"{name}: {words} {axis[axis.find('[') :]}"
    return side_by_side(columns)


def _governing_rows(
    case: CaseData,
    run: RunView | None,
    units: ShownUnits,
    shares: Mapping[str, Mapping[str, float]],
    labels: dict[str, Cell],
) -> tuple[Rows, Rows]:
    """History of the element that governs: damaged most, else nearest to a limit in the start."""
    histories = (run.histories if run else None) or {}
    if run is None or not histories:
        if run is not None:
            labels["Governing title"] = "Governing history: no start was calculated"
            labels["Governing axis"] = "Torque"
        return [[None] * 6], [[None, None] for _ in range(CROSSINGS)]
    damage = {row["element"]: row.get("damage") or 0.0 for row in _table(run, "AllowableStarts")}
    damaged = max(damage, key=lambda name: damage[name], default=None)
    in_start = {
        name: max(share for column, share in of_element.items() if column in _IN_START)
        for name, of_element in shares.items()
        if name in histories and _IN_START & of_element.keys()
    }
    if damaged in histories and damage[damaged]:
        name = damaged
    elif in_start:
        name = max(in_start, key=lambda name: in_start[name])
    else:
        name = _drawn_elements(case, histories, ())[0]
    if name is None:
        return [[None] * 6], [[None, None] for _ in range(CROSSINGS)]
    time, torque = histories[name]
    value, words, axis = _drawn_quantity(case, name, torque, units)
    drawn = Drawn(name, time, value, words, axis)
    return history_rows(run, drawn, _shown_limit(case, run, units, name), labels)


#: Columns of `ChartPeaks` of the start.
_IN_START = frozenset({"Peak torque", "Reversing torque", "Shear stress"})


def history_limits(
    case: CaseData, units: ShownUnits, run: RunView, chosen: Sequence[str | None] = ()
) -> list[Limit | None]:
    """What each drawn history may reach, for lines in its picture.

    Parameters
    ----------
    case : CaseData
        The inputs. [SI]
    units : ShownUnits
        Units shown. [units]
    run : RunView
        The results. [SI]
    chosen : sequence of (str or None)
        As for `chart_blocks`. [names]

    Returns
    -------
    list of (Limit or None)
        In the order of the histories; None where there is no limit. [shown units]
    """
    names = _drawn_elements(case, run.histories or {}, chosen)
    return [None if name is None else _shown_limit(case, run, units, name) for name in names]


def history_names(case: CaseData, run: RunView) -> list[str]:
    """Elements with a history, those first that are drawn unless others are chosen.

    Parameters
    ----------
    case : CaseData
        The inputs. [SI]
    run : RunView
        The results. [SI]

    Returns
    -------
    list of str
        All of them. [names]
    """
    histories = run.histories or {}
    drawn = [name for name in _drawn_elements(case, histories, ()) if name is not None]
    return [*drawn, *(name for name in histories if name not in drawn)]


def history_between(
    case: CaseData, units: ShownUnits, run: RunView, name: str, window: tuple[float, float]
) -> tuple[Drawn, Limit | None]:
    """A history as it is drawn in a window of time: as few points, and no peak lost, as in the whole.

    Parameters
    ----------
    case : CaseData
        The inputs. [SI]
    units : ShownUnits
        Units shown. [units]
    run : RunView
        The results. [SI]
    name : str
        One of `history_names`. [name]
    window : tuple of float
        Begin and end; cut to the history. [s]

    Returns
    -------
    drawn : Drawn
        With one point before the window and one behind it. [shown unit]
    limit : Limit or None
        What it may reach. [shown unit]
    """
    time, torque = (run.histories or {})[name]
    first = max(0, int(np.searchsorted(time, window[0], side="right")) - 1)
    last = min(time.size, int(np.searchsorted(time, window[1])) + 1)
    inside = slice(min(first, last - 1), last)
    value, words, axis = _drawn_quantity(case, name, torque[inside], units)
    keep = decimate(time[inside], value)
    drawn = Drawn(name, time[inside][keep], value[keep], words, axis)
    return drawn, _shown_limit(case, run, units, name)


def _shown_limit(case: CaseData, run: RunView, units: ShownUnits, name: str) -> Limit | None:
    limit = limit_of_torque(case, run, name)
    if limit is None:
        return None
    [lower, upper], _, _ = _drawn_quantity(case, name, np.array([limit.lower, limit.upper]), units)
    return Limit(limit.words, float(lower), float(upper))


def accuracy_block(rows: Iterable[Mapping[str, Any]]) -> Rows:
    """Rows of chart table `ChartAccuracy`.

    Parameters
    ----------
    rows : iterable of mapping
        Rows of `AccuracyCost`. [SI]

    Returns
    -------
    list of rows
        Name, processor time and error of each method, the shortest time first. [ms, %]
    """
    study = sorted((row for row in rows if row.get("time")), key=lambda row: float(row["time"]))
    columns: list[Sequence[Cell]] = []
    for method in METHODS:
        of_method = [r for r in study if r["method"].split(" ")[0] == method]
        name = of_method[0]["method"] if of_method else method
        for error, words in (("error_peak", "peak torques"), ("error_starts", "allowable starts")):
            columns.append([f"{name}: {words}"])
            points = [r for r in of_method if (r.get(error) or 0.0) > 0.0]
            columns.append(plain(1e3 * r["time"] for r in points))
            columns.append(plain(100.0 * r[error] for r in points))
    return side_by_side(columns)


def accuracy_title(drawn: bool, studied: bool = False) -> str:
    """Title of the chart of sheet `Accuracy`, which says why where it is empty."""
    if drawn:
        return "Error against processor time, as measured in this study"
    if studied:
        return "Error against processor time: nothing to study, see the note above"
    return "Error against processor time: no study yet; run torsionbook accuracy FILE"


def _drawn_elements(
    case: CaseData,
    histories: Mapping[str, tuple[Floats, Floats]],
    chosen: Sequence[str | None],
) -> list[str | None]:
    """Elements to draw: those chosen, then meshes, shafts by their stress with SCF, couplings, others."""
    kind_rank = {"gear mesh": 0, "coupling": 2}
    elements = {e.element: e for e in case.elements}

    def rank(name: str) -> tuple[int, float]:
        e = elements.get(name)
        if e is None:
            return 4, 0.0
        if not e.stress_diameter:
            return kind_rank.get(e.kind or "", 3), 0.0
        largest = float(np.max(np.abs(histories[name][1]), initial=0.0))
        kt = notch_effect(case, e).concentration.value
        return 1, -largest * stress_of_unit_torque(e) * kt

    wanted: list[str | None] = [name if name in histories else None for name in chosen]
    wanted += [None] * (HISTORIES - len(wanted))
    others = iter(sorted((name for name in histories if name not in wanted), key=rank))
    return [next(others, None) if name is None else name for name in wanted[:HISTORIES]]


def _drawn_quantity(
    case: CaseData, name: str, torque: Floats, units: ShownUnits
) -> tuple[Floats, str, str]:
    """Values in the shown unit, what they are, and the axis title: tooth load, stress or torque."""

    element = next((e for e in case.elements if e.element == name), None)
    mesh = next((m for m in case.meshes if m.element == name), None)
    if mesh is not None and mesh.pitch_radius_drive and element and element.kind == "gear mesh":
        american = "lb" in units.name("StartupPeaks", "Maximum torque")
        unit, size = ("lbf", 4.4482216152605) if american else ("kN", 1e3)
        load = torque / mesh.pitch_radius_drive / size
        return load, "tangential tooth load", f"Tooth load [{unit}]"
    if element is not None and element.stress_diameter:
        stress = torque * stress_of_unit_torque(element)
        place = ("StartupPeaks", "Peak-to-peak stress")
        axis = f"Nominal shear stress [{units.name(*place)}]"
        return stress / units.factor(*place), "nominal shear stress", axis
    place = ("StartupPeaks", "Maximum torque")
    return torque / units.factor(*place), "torque", f"Torque [{units.name(*place)}]"


# --- modes ----------------------------------------------------------------------------------------


def _elastic_modes(run: RunView | None) -> list[Mapping[str, Any]]:
    return [row for row in _table(run, "NaturalFrequencies") if row.get("frequency")]


def _shape_labels(run: RunView | None, labels: dict[str, Cell]) -> None:
    for k, row in enumerate(_elastic_modes(run)[:SHAPES]):
        most = row.get("largest_strain_energy") or ""
        sideways = f" ({most})" if most.startswith("bearing of ") else ""
        labels[f"Shape {k + 1}"] = f"Mode {row['mode']}: {row['frequency']:.2f} Hz{sideways}"


def _interference_rows(
    case: CaseData, run: RunView | None, labels: dict[str, Cell]
) -> tuple[Rows, Rows]:
    """Modes, excitation lines, the falling lines of 2 × slip and 1 × slip, and the speeds of continuous operation.

    The second block holds one row a line, always the same number: where its name stands.
    """
    names: Rows = [[None, None] for _ in range(LINES)]
    diagram = run.interference if run else None
    line, sync = case.ratings.line_frequency, case.ratings.synchronous_speed
    if diagram is None or not line or not sync or diagram.highest_speed is None:
        return [[None] * (8 + 2 * LINES)], names
    top, right = 2.5 * line, _rpm(diagram.highest_speed)
    multiples = (2.0, 1.0) if case.pulsates_at_slip else (2.0,)
    modes = [float(f) for f in diagram.mode_frequency if 0.0 < f <= top]
    running = [_rpm(case.minimum_speed or sync), _rpm(case.maximum_speed or sync)]
    columns: list[Sequence[Cell]] = [
        *_segments([[(0.0, f), (right, f)] for f in modes]),
        plain([right] * len(modes)),
        plain(modes),
        *_segments([[(0.0, k * line), (_rpm(sync), 0.0)] for k in multiples]),
        *_segments([[(n, 0.0), (n, top)] for n in dict.fromkeys(running)]),
    ]
    lines = [
        (name, _clipped(right, frequency, top), _ORDER_LABEL) for name, frequency in diagram.orders
    ] + [(name, [(0.0, f), (right, f)], _FIXED_LABEL) for name, f in diagram.fixed if f <= top]
    for k, (name, ends, at) in enumerate(lines[:LINES]):
        (x0, y0), (x1, y1) = ends
        at = 1.0 if y1 == top else at
        names[k] = plain([x0 + at * (x1 - x0), y0 + at * (y1 - y0)])
        columns += [plain([x0, x1]), plain([y0, y1])]
        labels[f"Line {k + 1}"] = name
    columns += [[]] * (8 + 2 * LINES - len(columns))
    return side_by_side(columns), names


#: Where along its line the name of an excitation stands: orders near the upper end, lines of fixed
#: frequency near standstill, so that names of lines that cross do not. [1]
_ORDER_LABEL, _FIXED_LABEL = 0.5, 0.13


def _clipped(right: float, frequency: float, top: float) -> list[tuple[float, float]]:
    """An order line from standstill to the right or the upper edge of the diagram."""
    reached = min(1.0, top / frequency) if frequency > 0.0 else 1.0
    return [(0.0, 0.0), (right * reached, top if reached < 1.0 else frequency)]


# --- fatigue --------------------------------------------------------------------------------------


def _sn_rows(
    case: CaseData, run: RunView | None, units: ShownUnits, labels: dict[str, Cell]
) -> Rows:
    """S-N line in torsion of the governing shaft, and how often a start exceeds a stress."""
    unit = units.factor("SNPoints", "Stress")
    notch = "Kf" if case.fatigue_factors else "SCF"
    labels["S-N axis"] = f"Stress amplitude with {notch} [{units.name('SNPoints', 'Stress')}]"
    labels["S-N title"] = "S-N lines (torsion)"
    labels["One start"], labels["Starts required"] = "One start", "Starts required"
    shaft = governing_shaft(run)
    material = _material_of(case, shaft)
    element = next((e for e in case.elements if e.element == shaft), None)
    if run is None or element is None:
        lines = _sn_lines(case, material)
    else:
        lines = [_drawn_line(shaft_strength(case, element).curve)]
    labels["S-N line"] = f"S-N line, torsion: {material}" if material else "S-N lines, torsion"
    columns: list[Sequence[Cell]] = [
        *_segments([(n, s / unit) for n, s in line] for line in lines), [], [], [], []
    ]  # fmt: skip
    if run is not None and shaft is not None:
        labels["S-N title"] = f"S-N line and the cycles of a start: {shaft}"
        exceeded, stress, labels["One start"] = _drawn_cycles(run, shaft)
        columns[2], columns[3] = plain(exceeded), plain(stress / unit)
        if case.starts_required:
            columns[4], columns[5] = plain(exceeded * case.starts_required), columns[3]
            labels["Starts required"] = f"{case.starts_required:,.0f} starts"
    return side_by_side(columns)


def _material_of(case: CaseData, shaft: str | None) -> str | None:
    """Material of a shaft; without a shaft the only material there is."""
    if shaft is not None:
        return next((e.material for e in case.elements if e.element == shaft), None)
    names = [m.material for m in case.materials if m.material]
    return names[0] if len(names) == 1 else None


def _sn_lines(case: CaseData, only: str | None) -> list[list[tuple[float, float]]]:
    """Each material's line, or that of one, its endurance limit drawn on to 1e9 cycles."""

    lines = []
    for material in case.materials:
        points = [p for p in case.sn_points if p.material == material.material]
        if len(points) < 2 or only not in (None, material.material):
            continue
        try:
            curve = sn_curve_for(material, points)
        except TorsionError:
            continue  # reported with its cell by the check of the inputs
        lines.append(_drawn_line(curve))
    return lines


def _drawn_line(curve: SNCurve) -> list[tuple[float, float]]:
    """Points of a line, its endurance limit drawn on to 1e9 cycles."""
    knee = (curve.knee_cycles, curve.endurance)
    end = (max(1e9, 10.0 * curve.knee_cycles), curve.endurance)
    line = list(zip(curve.cycles.tolist(), curve.stress.tolist(), strict=True))
    return [*line, *([knee] if knee[0] > line[-1][0] else []), end]


def governing_shaft(run: RunView | None) -> str | None:
    """The judged shaft that allows the fewest starts; without damage the one nearest to damage.

    Parameters
    ----------
    run : RunView or None
        The results. [SI]

    Returns
    -------
    str or None
        Its element; None when no shaft is judged. [name]
    """
    if run is None:
        return None
    damage = {
        row.get("element"): row.get("damage") or 0.0 for row in _table(run, "AllowableStarts")
    }
    names = [name for name, _, _ in run.cycles]

    def rank(name: str) -> tuple[float, float]:
        largest, endurance = run.amplitudes.get(name, (0.0, 1.0))
        return damage.get(name, 0.0), largest / endurance

    return max(names, key=rank, default=None)


def _drawn_cycles(run: RunView, shaft: str) -> tuple[Floats, Floats, str]:
    """Cycles of a start that reach each stress, and their name; without damage the largest alone."""
    amplitude, count = next((a, c) for name, a, c in run.cycles if name == shaft)
    if amplitude.size:
        return (*_exceedance(amplitude, count), "One start")
    largest, endurance = run.amplitudes.get(shaft, (0.0, 0.0))
    if not largest:
        return np.empty(0), np.empty(0), "One start"
    words = f"One start: largest amplitude, {100.0 * largest / endurance:.0f} % of endurance"
    return np.array([0.1, 1.0]), np.array([largest, largest]), words


def _exceedance(amplitude: Floats, count: Floats) -> tuple[Floats, Floats]:
    """How many cycles reach at least each amplitude, the small ones left out, thinned."""
    order = np.argsort(amplitude)[::-1]
    total, stress = np.cumsum(count[order]), amplitude[order]
    large = stress >= _SMALLEST_CYCLE * stress[0]
    total, stress = total[large], stress[large]
    if total.size > _SN_POINTS:
        keep = distinct(np.geomspace(1, total.size, _SN_POINTS).astype(int)) - 1
        total, stress = total[keep], stress[keep]
    return total, stress
