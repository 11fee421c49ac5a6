"""Which series goes on which chart, and how it is drawn.

A chart refers to whole columns of Excel tables and, for words that only a calculation knows, to
cells of `ChartLabels`; the writer renews those, so that the charts need no macro and no formula.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from addin.contract.chart_tables import CROSSINGS, EVENTS, FORCES, GROUPS, LINES, METHODS, SHAPES
from addin.template.chart_parts import Place, Places
from addin.template.chart_parts import axis as _axis
from addin.template.chart_parts import dot as _dot
from addin.template.chart_parts import font as _font
from addin.template.chart_parts import legend as _legend
from addin.template.chart_parts import line as _line
from addin.template.chart_parts import title as _title
from addin.template.chart_parts import xy as _xy
from addin.template.styles import PALETTE, SPEED_GROUPS

__all__ = ["CHARTS", "Place", "Places", "make_chart"]

_SHAPE_COLOURS = tuple(PALETTE[c] for c in ("navy", "rust", "teal", "gold", "plum"))
_GRID = {"visible": True, "line": {"color": "#E3E3E3", "width": 0.5}}
_AXIS_LINE = {"color": "#8C8C8C", "width": 0.75}


def make_chart(
    workbook: Any,
    places: Places,
    name: str,
    size: tuple[int, int],
    kinds: Mapping[str, Callable[[Any, Places, int], Any]] | None = None,
) -> Any:
    """A chart of the table `CHARTS`.

    Parameters
    ----------
    workbook : xlsxwriter.Workbook
        The workbook under construction.
    places : Places
        Where its data stand.
    name : str
        Key of `CHARTS`; histories are ``history 1``, ``history 2``, ... [name]
    size : tuple of int
        Width and height. [pixel]
    kinds : mapping of str to callable, optional
        What draws each kind; default `CHARTS`.

    Returns
    -------
    xlsxwriter.chart.Chart
        The chart, not yet inserted.
    """
    kind, _, number = name.partition(" ")
    chart = (kinds or CHARTS)[kind](workbook, places, int(number or 0))
    chart.set_size({"width": size[0], "height": size[1]})
    chart.set_chartarea({"border": {"color": "#D0D0D0", "width": 0.75}, "fill": {"color": "white"}})
    if kind != "train":
        frame = {"color": "#B0B0B0", "width": 0.5}
        chart.set_plotarea({"fill": {"color": "white"}, "border": frame})
    return chart


# --- the charts -----------------------------------------------------------------------------------


def _train(workbook: Any, places: Places, _: int) -> Any:
    """Discs and shafts as columns up and down from the centre line, a colour a speed."""
    chart = workbook.add_chart({"type": "column", "subtype": "stacked"})
    fills = [
        (f"{word} {direction} {k + 1}", SPEED_GROUPS[k][shade])
        for k in range(GROUPS)
        for shade, word in enumerate(("Disc", "Shaft"))
        for direction in ("up", "down")
    ] + [("Mesh up", PALETTE["gold"]), ("Mesh down", PALETTE["gold"])]
    for column, colour in fills:
        chart.add_series(
            {
                "name": column,
                "categories": places.column("ChartTrain", "Item"),
                "values": places.column("ChartTrain", column),
                "fill": {"color": colour},
                "border": {"color": "white", "width": 0.5},
                "gap": 0,
                "overlap": 100,
            }
        )
    centre = {"color": "#404040", "width": 0.75, "dash_type": "long_dash_dot"}
    chart.set_x_axis(
        {
            "label_position": "low",
            "num_font": _font(8, rotation=-90),
            "line": centre,
            "major_tick_mark": "none",
            "minor_tick_mark": "none",
            "interval_unit": 1,
        }
    )
    chart.set_y_axis(
        {"visible": False, "major_gridlines": {"visible": False}, "min": -1.05, "max": 1.05}
    )
    chart.set_legend({"none": True})
    chart.set_title({"none": True})
    return chart


def _speed_time(workbook: Any, places: Places, _: int) -> Any:
    """The paper's Figure 6, with the speeds at which 2 x slip crosses the modes."""
    chart = workbook.add_chart({"type": "scatter", "subtype": "straight"})
    chart.add_series(
        _xy(places, "ChartSpeedTime", "Time", "Speed", "Motor speed", line=_line("navy", 2.0))
    )
    for k in range(CROSSINGS):
        chart.add_series(_named_point(places, "Crossing", k, "rust", "right"))
    for k in range(EVENTS):
        chart.add_series(_named_point(places, "Event", k, "teal", "below"))
    _title(chart, "Start: motor speed against time, and where 2 × slip crosses a mode")
    chart.set_x_axis(_axis("Time [s]", min=0, num_format="General"))
    chart.set_y_axis(_axis("Motor speed [rpm]", min=0, num_format="#,##0"))
    chart.set_legend({"none": True})
    return chart


def _named_point(places: Places, kind: str, k: int, colour: str, side: str) -> dict[str, Any]:
    """A point of `ChartCrossings` or `ChartEvents` with its name beside it."""
    return {
        "name": places.label(f"{kind} {k + 1}"),
        "categories": places.cell(f"Chart{kind}s", "Time", k),
        "values": places.cell(f"Chart{kind}s", "Speed", k),
        "line": {"none": True},
        "marker": _dot(colour, "diamond", 8),
        "data_labels": {
            "series_name": True,
            "value": False,
            "position": side,
            "font": _font(8, color=PALETTE[colour]),
        },
    }


def _torque(workbook: Any, places: Places, _: int) -> Any:
    """The paper's Figure 2 with the load: what accelerates the train at each speed."""
    chart = workbook.add_chart({"type": "scatter", "subtype": "straight"})
    for column, name, line in (
        ("Average", "Motor, average", _line("navy", 2.0)),
        ("Pulsating", "Motor, pulsating (zero-to-peak)", _line("rust", 1.75)),
        ("Load", "Load, all machines", _line("teal", 1.75)),
        ("Accelerating", "Accelerating (average − load)", _line("grey", 1.25, "dash")),
    ):
        chart.add_series(_xy(places, "ChartTorque", "Speed", column, name, line=line))
    _title(chart, "Torques referred to the motor")
    chart.set_x_axis(
        _axis("Speed [% of synchronous]", min=0, max=100, num_format="0", label_position="low")
    )
    chart.set_y_axis(_axis("Torque [pu of rated torque]", num_format="0.0"))
    _legend(chart)
    return chart


def _typed(
    table: str, title: str, axis: str, series: tuple[tuple[str, str, str], ...]
) -> Callable[[Any, Places, int], Any]:
    """Points of an input table as they are typed; the chart follows the cells."""

    def make(workbook: Any, places: Places, _: int) -> Any:
        chart = workbook.add_chart({"type": "scatter"})
        for column, name, colour in series:
            points = _xy(places, table, "Speed", column, name, line={"none": True})
            chart.add_series(points | {"marker": _dot(colour, size=6)})
        _title(chart, title)
        chart.set_x_axis(_axis("Speed, as typed", min=0, num_format="General"))
        chart.set_y_axis(_axis(axis, min=0, num_format="General"))
        if len(series) > 1:
            _legend(chart)
        else:
            chart.set_legend({"none": True})
        return chart

    return make


def _sn(workbook: Any, places: Places, _: int) -> Any:
    """Stress against life, and how often a start (and all starts) reaches a stress."""
    chart = workbook.add_chart({"type": "scatter", "subtype": "straight"})
    for x, y, label, line in (
        ("Line cycles", "Line", "S-N line", _line("navy", 2.25)),
        ("Start cycles", "One start", "One start", _line("teal")),
        ("Starts cycles", "Starts required", "Starts required", _line("rust")),
    ):
        chart.add_series(_xy(places, "ChartSN", x, y, places.label(label), line=line))
    _title(chart, places.label("S-N title"))
    life = {"log_base": 10, "min": 0.1, "max": 1e9, "num_format": "0E+0"}
    chart.set_x_axis(_axis("Cycles", crossing=0.1, **life))
    chart.set_y_axis(
        _axis(places.label("S-N axis"), log_base=10, num_format="#,##0", crossing="min")
    )
    _legend(chart)
    return chart


def _shapes(workbook: Any, places: Places, _: int) -> Any:
    """Twist of each station in the first elastic modes, largest = 1."""
    chart = workbook.add_chart({"type": "line"})
    for k in range(SHAPES):
        chart.add_series(
            {
                "name": places.label(f"Shape {k + 1}"),
                "categories": places.column("ModeShapes", "Station"),
                "values": places.column("ModeShapes", f"Mode {k + 1}"),
                "line": _line(_SHAPE_COLOURS[k], 1.75),
                "marker": _dot(_SHAPE_COLOURS[k], size=6),
            }
        )
    _title(chart, "Mode shapes: physical twist of each station, largest = 1")
    chart.set_x_axis(_axis("", label_position="low", major_gridlines=_GRID))
    chart.set_y_axis(_axis("Relative twist", min=-1, max=1, major_unit=0.5, num_format="0.0"))
    _legend(chart)
    return chart


def _interference(workbook: Any, places: Places, _: int) -> Any:
    """Interference (Campbell) diagram with the falling 2 x slip line of the start."""
    chart = workbook.add_chart({"type": "scatter", "subtype": "straight"})
    table = "ChartInterference"
    for x, y, name, line in (
        ("Modes speed", "Modes", "Natural frequencies", _line("navy", 1.75)),
        ("Slip speed", "2 x slip", "2 × slip frequency of the start", _line("rust", 2.0)),
        ("Range speed", "Range", "Continuous operation", _line("gold", 1.5, "dash")),
    ):
        chart.add_series(_xy(places, table, x, y, name, line=line))
    for k in range(1, LINES + 1):
        chart.add_series(
            _xy(places, table, f"Line speed {k}", f"Line {k}", "", line=_line("grey", 0.75))
        )
        named = {
            "name": places.label(f"Line {k}"),
            "categories": places.cell("ChartNames", "Speed", k - 1),
            "values": places.cell("ChartNames", "Frequency", k - 1),
            "line": {"none": True},
            "marker": {"type": "none"},
            "data_labels": {
                "series_name": True,
                "value": False,
                "position": "above",
                "font": _font(7.5, color=PALETTE["grey"]),
            },
        }
        chart.add_series(named)
    labels = _xy(places, table, "Label speed", "Label", "Labels", line={"none": True})
    labels["data_labels"] = {
        "value": True,
        "position": "right",
        "num_format": '0.0" Hz"',
        "font": _font(8, color=PALETTE["navy"]),
    }
    chart.add_series(labels)
    _title(chart, "Interference diagram")
    chart.set_x_axis(_axis("Motor speed [rpm]", min=0, num_format="#,##0"))
    chart.set_y_axis(_axis("Frequency [Hz]", min=0, num_format="0"))
    _legend(chart, without=tuple(range(3, 3 + 2 * LINES + 1)))
    return chart


def _history(workbook: Any, places: Places, number: int) -> Any:
    """The paper's Figures 1, 7 and 8: torque, tooth load or stress against time."""
    chart = workbook.add_chart({"type": "scatter", "subtype": "straight"})
    table = "ChartHistory"
    chart.add_series(
        _xy(
            places,
            table,
            f"Time {number}",
            f"Value {number}",
            places.label(f"History title {number}"),
            line=_line("navy", 0.75),
        )
    )
    _title(chart, places.label(f"History title {number}"))
    chart.set_x_axis(_axis("Time [s]", min=0, num_format="General", label_position="low"))
    chart.set_y_axis(_axis(places.label(f"History axis {number}"), num_format="#,##0"))
    chart.set_legend({"none": True})
    return chart


def _closely(table: str, key: str, number: str) -> Callable[[Any, Places, int], Any]:
    """Torque of the worst mesh around its deepest moment: teeth part where it stays at zero."""

    def make(workbook: Any, places: Places, _: int) -> Any:
        chart = workbook.add_chart({"type": "scatter", "subtype": "straight"})
        title = places.label(f"{key} title")
        chart.add_series(_xy(places, table, "Time", "Torque", title, line=_line("navy", 1.25)))
        _title(chart, title)
        chart.set_x_axis(_axis("Time [s]", num_format=number, label_position="low"))
        chart.set_y_axis(_axis(places.label(f"{key} axis"), num_format="#,##0"))
        chart.set_legend({"none": True})
        return chart

    return make


def _forces(workbook: Any, places: Places, _: int) -> Any:
    """The blow in forces: of the teeth, and of the bearings that give way under it."""
    chart = workbook.add_chart({"type": "scatter", "subtype": "straight"})
    for k, colour in zip(range(1, FORCES + 1), ("navy", "rust", "teal"), strict=True):
        name, line = places.label(f"Force {k}"), _line(colour, 1.25)
        chart.add_series(_xy(places, "ChartForces", f"Time {k}", f"Force {k}", name, line=line))
    _title(chart, places.label("Force title"))
    chart.set_x_axis(_axis("Time [s]", num_format="0.000", label_position="low"))
    chart.set_y_axis(_axis(places.label("Force axis"), num_format="#,##0"))
    _legend(chart)
    return chart


def _pull_in(workbook: Any, places: Places, _: int) -> Any:
    """Load angle and slip while the motor pulls into step and swings, or slips poles."""
    chart = workbook.add_chart({"type": "scatter", "subtype": "straight"})
    for x, y, colour, more in (
        ("Angle time", "Load angle", "navy", {}),
        ("Slip time", "Slip", "rust", {"y2_axis": True}),
    ):
        line = _line(colour, 1.5)
        chart.add_series(_xy(places, "ChartPullIn", x, y, y, line=line, **more))
    _title(chart, places.label("Pull-in title"))
    chart.set_x_axis(_axis("Time [s]", num_format="0.0", label_position="low"))
    chart.set_y_axis(_axis(places.label("Pull-in axis"), num_format="0"))
    chart.set_y2_axis(_axis("Slip [%]", num_format="0.0", major_gridlines={"visible": False}))
    _legend(chart)
    return chart


def _accuracy(workbook: Any, places: Places, _: int) -> Any:
    """Error against wall time on logarithmic axes: what ten times better costs."""
    chart = workbook.add_chart({"type": "scatter", "subtype": "straight_with_markers"})
    for method, colour in zip(METHODS, ("navy", "rust"), strict=True):
        for error, dash, marker in (("peak", "solid", "circle"), ("starts", "dash", "diamond")):
            x, y = f"{method} {error} time", f"{method} {error}"
            name = places.cell("ChartAccuracy", f"{method} {error} name", 0)[:3]
            series = _xy(places, "ChartAccuracy", x, y, "", line=_line(colour, 1.5, dash))
            chart.add_series(series | {"name": name, "marker": _dot(colour, marker, 6)})
    _title(chart, places.label("Accuracy title"))
    chart.set_x_axis(_axis("Wall time [ms]", log_base=10, num_format="General", crossing="min"))
    chart.set_y_axis(
        _axis(
            places.label("Accuracy axis"),
            log_base=10,
            num_format="General",
            crossing="min",
            label_position="low",
        )
    )
    _legend(chart)
    return chart


#: Charts by name; a name may be followed by a number.
CHARTS: Mapping[str, Callable[[Any, Places, int], Any]] = {
    "train": _train,
    "speed-time": _speed_time,
    "torque": _torque,
    "motor-typed": _typed(
        "MotorTorque",
        "Motor torque as typed (live)",
        "In the units above the columns",
        (("Average", "Average", "navy"), ("Pulsating", "Pulsating (zero-to-peak)", "rust")),
    ),
    "load-typed": _typed(
        "LoadTorque",
        "Load torque as typed (live), each at its own speed",
        "In the unit above the column",
        (("Torque", "Load", "teal"),),
    ),
    "sn": _sn,
    "shapes": _shapes,
    "interference": _interference,
    "history": _history,
    "reversal": _closely("ChartReversal", "Reversal", "0.00"),
    "blow": _closely("ChartBlow", "Blow", "0.000"),
    "forces": _forces,
    "pull-in": _pull_in,
    "accuracy": _accuracy,
}
