"""Charts as data: what is drawn, from which columns, with which axes and words.

Spreadsheet (`template/charts.py`), report (`report/figures.py`) and page (`server/static/charts.js`) draw the
same records.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from addin.contract.chart_tables import (
    CROSSINGS,
    EVENTS,
    FORCES,
    GROUPS,
    HISTORIES,
    LINES,
    METHODS,
    SHAPES,
)


@dataclass(frozen=True)
class Label:
    """Words that only a calculation knows: a row of table `ChartLabels`."""

    key: str  #: Its key there.
    #: Of a title: pattern of the words that a calculation of this or an earlier version gives it;
    #: other words in their place are the engineer's own.
    words: str = ""


@dataclass(frozen=True)
class FirstCell:
    """Words in the first data row of a column."""

    table: str  #: Name of the table.
    column: str  #: Its header.


Words = str | Label | FirstCell


@dataclass(frozen=True)
class Series:
    """One curve, one row of columns, or one named point."""

    table: str  #: Table of the data.
    x: str  #: Header of the column across: numbers, or names of a chart of columns.
    y: str  #: Header of the column up.
    name: Words = ""
    colour: str = "navy"  #: Word of `PALETTE`, or ``#RRGGBB``.
    width: float = 0.0  #: Of the line; 0 = no line. [pt]
    dash: str = "solid"  #: ``solid`` or ``dash``.
    marker: str = ""  #: ``circle``, ``diamond``, ``square`` or ``triangle``; empty = none.
    size: int = 5  #: Of the marker. [pt]
    row: int | None = None  #: The only data row that is drawn, counted from 0; None = all.
    name_beside: str = ""  #: Side of the point on which its name stands: right, below, above.
    name_size: float = 8.0  #: Height of that name. [pt]
    values_beside: str = ""  #: Number format of the values written beside the points.
    second_axis: bool = False
    in_legend: bool = True
    edge: str = ""  #: Colour of the edge of a column; empty = as the program does.


@dataclass(frozen=True)
class Axis:
    """One axis; its end is chosen from the data where it is None."""

    title: Words = ""
    least: float | None = None  #: [shown unit]
    largest: float | None = None  #: [shown unit]
    step: float | None = None  #: Between two numbers. [shown unit]
    log: bool = False
    number: str = ""  #: Number format of a spreadsheet; empty = as the program does.
    crossing: float | str | None = None  #: Where the other axis crosses: a number, min or max.
    low: bool = False  #: Its numbers stand below the chart also where values are negative.
    grid: bool = True
    ticks: bool = True
    reverse: bool = False
    names: tuple[float, int] | None = None  #: Height and rotation of names. [pt, degrees]


@dataclass(frozen=True)
class ChartSpec:
    """One chart, for every program that draws it."""

    name: str
    #: ``curves``, ``marked curves``, ``points``, ``columns``, ``lines`` (over names), ``bars`` or ``train``.
    kind: str
    title: Words
    x: Axis
    y: Axis
    series: tuple[Series, ...]
    legend: bool = False
    second: Axis | None = None  #: Axis on the right of the series that name it.
    gap: int | None = None  #: Between columns. [% of their width]
    overlap: int | None = None  #: Of columns at one place. [% of their width]
    high_low: bool = False  #: A line from the highest to the lowest series at each name.
    caption: Words = ""  #: Below the picture of a report; empty = the title.
    height: float = 66.0  #: Of that picture. [mm]


def _curve(table: str, x: str, y: str, name: Words, colour: str, width: float) -> Series:
    return Series(table, x, y, name, colour, width)


def _named_point(kind: str, k: int, colour: str, side: str) -> Series:
    """A point of `ChartCrossings` or `ChartEvents` with its name beside it."""
    return Series(
        f"Chart{kind}s", "Time", "Speed", Label(f"{kind} {k + 1}"), colour,
        marker="diamond", size=8, row=k, name_beside=side,
    )  # fmt: skip


def _train() -> ChartSpec:
    """Discs and shafts as columns up and down from the centre line, a colour a speed."""
    columns = [
        (f"{word} {direction} {k}", f"{word.lower()} {k}")
        for k in range(1, GROUPS + 1)
        for word in ("Disc", "Shaft")
        for direction in ("up", "down")
    ] + [("Mesh up", "gold"), ("Mesh down", "gold")]
    return ChartSpec(
        "train", "train", "", Axis(low=True, names=(8, -90)), Axis(least=-1.05, largest=1.05),
        tuple(Series("ChartTrain", "Item", column, column, colour, edge="white")
              for column, colour in columns),
        gap=0, overlap=100,
        caption="disc heights as the fourth root of inertia, shaft heights as that of stiffness; "
        "one colour per shaft speed, gear meshes in gold",
    )  # fmt: skip


def _typed(
    name: str, table: str, title: str, axis: str, *series: tuple[str, str, str]
) -> ChartSpec:
    """Points of an input table as they are typed; the chart follows the cells."""
    return ChartSpec(
        name, "points", title,
        Axis("Speed, as typed", least=0, number="General"), Axis(axis, least=0, number="General"),
        tuple(Series(table, "Speed", y, words, colour, marker="circle", size=6)
              for y, words, colour in series),
        legend=len(series) > 1,
    )  # fmt: skip


def _interference() -> ChartSpec:
    """Interference (Campbell) diagram with the falling 2 × slip line of the start."""
    table = "ChartInterference"
    lines = [
        Series(table, f"Line speed {k}", f"Line {k}", "", "grey", 0.75, in_legend=False)
        for k in range(1, LINES + 1)
    ]
    names = [
        Series(
            "ChartNames", "Speed", "Frequency", Label(f"Line {k}"), "grey", row=k - 1,
            name_beside="above", name_size=7.5, in_legend=False,
        )
        for k in range(1, LINES + 1)
    ]  # fmt: skip
    return ChartSpec(
        "interference", "curves", "Interference diagram",
        Axis("Motor speed [rpm]", least=0, number="#,##0"),
        Axis("Frequency [Hz]", least=0, number="0"),
        (
            _curve(table, "Modes speed", "Modes", "Natural frequencies", "navy", 1.75),
            _curve(table, "Slip speed", "2 x slip", "Pulsation of the start", "rust", 2.0),
            Series(table, "Range speed", "Range", "Continuous operation", "gold", 1.5, "dash"),
            *(formula for pair in zip(lines, names, strict=True) for formula in pair),
            Series(table, "Label speed", "Label", "Labels", values_beside='0.0" Hz"', in_legend=False),
        ),
        legend=True,
        caption="Interference diagram: natural frequencies, continuous excitations, and the "
        "pulsation of the start falling from 2 × line frequency to zero",
        height=118.0,
    )  # fmt: skip


def _history(k: int) -> ChartSpec:
    """The paper's Figures 1, 7 and 8: torque, tooth load or stress against time."""
    title = Label(
        f"History title {k}",
        r".*: (tangential tooth load|nominal shear stress|torque)|History \d .*|unused.*",
    )
    axis = Label(f"History axis {k}", r"(Tooth load|Nominal shear stress|Torque)( \[.*\])?")
    return ChartSpec(
        f"history {k}", "curves", title,
        Axis("Time [s]", least=0, number="General", low=True),
        Axis(axis, number="#,##0"),
        (_curve("ChartHistory", f"Time {k}", f"Value {k}", title, "navy", 0.75),),
        height=45.0,
    )  # fmt: skip


def _closely(name: str, table: str, key: str, number: str, words: str) -> ChartSpec:
    """Torque of the worst mesh around its deepest moment: teeth separate where it stays at zero."""
    title, axis = Label(f"{key} title", words), Label(f"{key} axis", r"Torque( \[.*\])?")
    return ChartSpec(
        name, "curves", title,
        Axis("Time [s]", number=number, low=True), Axis(axis, number="#,##0"),
        (_curve(table, "Time", "Torque", title, "navy", 1.25),),
        height=52.0,
    )  # fmt: skip


def _accuracy() -> ChartSpec:
    """Error against processor time on logarithmic axes, the start as calculated marked, and alternatives."""
    table = "ChartAccuracy"
    return ChartSpec(
        "accuracy", "marked curves", Label("Accuracy title", r"Error against (wall|processor) time.*"),
        Axis("Processor time [ms]", log=True, number="General", crossing="min"),
        Axis(Label("Accuracy axis", r"Error \[%\]"), log=True, number="General", crossing="min", low=True),
        tuple(
            Series(
                table, f"{method} {error} time", f"{method} {error}",
                FirstCell(table, f"{method} {error} name"), colour, width, dash, marker, size,
            )
            for (method, colour, width, size) in zip(
                METHODS, ("navy", "rust", "teal", "gold"), (1.5, 1.5, 0.0, 0.0), (6, 6, 12, 7),
                strict=True,
            )
            for error, dash, marker in (("peak", "solid", "circle"), ("starts", "dash", "diamond"))
        ),
        legend=True,
        caption="Error against processor time, as measured by the accuracy study",
        height=92.0,
    )  # fmt: skip


def _peaks() -> ChartSpec:
    """A mark for each peak that has a limit, over the elements; the limits are one line."""
    marks = (
        ("Peak torque", "Peak torque in start and events", "navy", "circle", 9),
        ("Reversing torque", "Reversing torque", "plum", "square", 8),
        ("Shear stress", "Nominal shear stress / yield", "rust", "diamond", 10),
        ("Vibratory torque", "Vibratory torque", "teal", "triangle", 9),
        ("Steady stress", "Steady-state stress", "gold", "diamond", 9),
    )
    table = "ChartPeaks"
    return ChartSpec(
        "peaks", "lines", Label("Peaks title", r"Peaks in % of their limits.*"),
        Axis(low=True), Axis("% of limit", least=0, number="0"),
        (
            *(
                Series(table, "Element", column, words, colour, marker=marker, size=size)
                for column, words, colour, marker, size in marks
            ),
            Series(table, "Element", "Limit", "Limit", "rust", 1.5, "dash"),
        ),
        legend=True,
        caption="Peaks of each element in per cent of their limits",
    )  # fmt: skip


def _governing() -> ChartSpec:
    """The paper's Figures 7 and 8: the governing history, its limit, the modes at their bulges, per cent speed."""
    table = "ChartGoverning"
    title = Label(
        "Governing title",
        r".*: (tangential tooth load|nominal shear stress|torque).*|Governing history.*",
    )
    return ChartSpec(
        "governing", "curves", title,
        Axis("Time [s]", least=0, number="General", low=True, grid=False),
        Axis(
            Label("Governing axis", r"(Tooth load|Nominal shear stress|Torque)( \[.*\])?"), number="#,##0",
        ),
        (
            _curve(table, "Time", "Value", title, "navy", 0.75),
            Series(table, "Limit time", "Limit", "Limit", "rust", 1.5, "dash"),
            Series(table, "Speed time", "Percent speed", "Speed", "teal", 1.5, second_axis=True),
            *(
                Series(
                    "ChartBulges", "Time", "Value", Label(f"Crossing {k + 1}"), "rust", row=k,
                    name_beside="above",
                )
                for k in range(CROSSINGS)
            ),
        ),
        second=Axis("Speed [%]", least=0, largest=120, step=20, number="0", grid=False),
        height=60.0,
    )  # fmt: skip


_SHAPE_COLOURS = ("navy", "rust", "teal", "gold", "plum")

_SPECS = (
    _train(),
    _governing(),
    _peaks(),
    # the paper's Figure 6, with the speeds at which 2 × slip crosses the modes
    ChartSpec(
        "speed-time", "curves", "Start: motor speed against time, and where 2 × slip crosses a mode",
        Axis("Time [s]", least=0, number="General"),
        Axis("Motor speed [rpm]", least=0, number="#,##0"),
        (
            _curve("ChartSpeedTime", "Time", "Speed", "Motor speed", "navy", 2.0),
            *(_named_point("Crossing", k, "rust", "right") for k in range(CROSSINGS)),
            *(_named_point("Event", k, "teal", "above") for k in range(EVENTS)),
        ),
        height=74.0,
    ),
    # the paper's Figure 2 with the load: what accelerates the train at each speed
    ChartSpec(
        "torque", "curves", "Torques referred to the motor",
        Axis("Speed [% of synchronous]", least=0, largest=100, number="0", low=True),
        Axis("Torque [pu of rated torque]", number="0.0"),
        (
            _curve("ChartTorque", "Speed", "Average", "Motor, average", "navy", 2.0),
            _curve("ChartTorque", "Speed", "Pulsating", "Motor, pulsating (zero-to-peak)", "rust", 1.75),
            _curve("ChartTorque", "Speed", "Pulsation1", "Motor, at 1 × slip (zero-to-peak)", "gold", 1.75),
            _curve("ChartTorque", "Speed", "Load", "Load, all machines", "teal", 1.75),
            Series("ChartTorque", "Speed", "Accelerating", "Accelerating (average − load)", "grey", 1.25, "dash"),
        ),
        legend=True,
        caption="Torques against speed, referred to the motor",
    ),
    _typed(
        "motor-typed", "MotorTorque", "Motor torque as typed (live)", "In the units above the columns",
        ("Average", "Average", "navy"), ("Pulsating", "Pulsating (zero-to-peak)", "rust"),
        ("Pulsation1", "At 1 × slip (zero-to-peak)", "gold"),
    ),
    _typed(
        "load-typed", "LoadTorque", "Load torque as typed (live), each at its own speed",
        "In the unit above the column", ("Torque", "Load", "teal"),
    ),
    # what follows from the data sheets of the motors, beside what is typed of the same motors
    ChartSpec(
        "motor-curves", "curves", Label("Motor title", r"Motor torque calculated.*"),
        Axis("Speed [% of synchronous]", least=0, largest=100, number="0", low=True),
        Axis(Label("Motor axis", r"Torque.*"), number="General"),
        (
            _curve("ChartMotor", "Speed", "Average", "Average", "navy", 2.0),
            _curve("ChartMotor", "Speed", "Pulsating", "Pulsating (zero-to-peak)", "rust", 1.75),
            _curve("ChartMotor", "Speed", "Pulsation1", "At 1 × slip (zero-to-peak)", "gold", 1.75),
            Series("ChartMotor", "Typed speed", "Typed average", "Average, typed", "navy", 1.25, "dash"),
            Series("ChartMotor", "Typed speed", "Typed pulsating", "Pulsating, typed", "rust", 1.25, "dash"),
            Series("ChartMotor", "Typed speed", "Typed pulsation1", "At 1 × slip, typed", "gold", 1.25, "dash"),
        ),
        legend=True,
        caption="Motor torque calculated from its data, beside typed curves",
    ),
    # the sections of stepped shafts, one element after another
    ChartSpec(
        "profile", "curves", Label("Profile title", r"Profile.*"),
        Axis("Length, in the same unit", least=0, number="General", low=True),
        Axis(Label("Profile axis", r"Radius.*"), number="General"),
        (
            _curve("ChartProfile", "Position", "Outline", "Section", "navy", 1.5),
            _curve("ChartProfile", "Hub position", "Hub", "Section inside a hub", "rust", 1.5),
            Series("ChartProfile", "Bore position", "Bore", "Bore", "grey", 1.0, "dash"),
        ),
        legend=True,
    ),
    # the fault that is hardest on the motor, and what becomes of it in the train
    ChartSpec(
        "air-gap", "curves", Label("Air-gap title", r"Air-gap torque.*"),
        Axis("Time from the event [s]", least=0, number="General", low=True),
        Axis(Label("Air-gap axis", r"Torque.*"), number="General"),
        (
            _curve("ChartMotorEvent", "Time", "Air gap", "Air-gap torque", "rust", 1.25),
            _curve("ChartMotorEvent", "Time", "Element", Label("Air-gap element"), "navy", 1.75),
        ),
        legend=True,
    ),
    ChartSpec(
        "clearing", "curves", Label("Clearing title", r"Peak against clearing time.*"),
        Axis("Clearing time [s]", least=0, number="General", low=True),
        Axis(Label("Clearing axis", r"Torque.*"), number="General"),
        (
            _curve("ChartClearing", "Time", "Air gap", "Largest air-gap torque", "rust", 1.25),
            _curve("ChartClearing", "Time", "Element", Label("Clearing element"), "navy", 1.75),
        ),
        legend=True,
    ),
    # stress against life, and how often a start (and all starts) reaches a stress
    ChartSpec(
        "sn", "curves", Label("S-N title", r"S-N line.*"),
        Axis("Cycles", 0.1, 1e9, log=True, number="0E+0", crossing=0.1),
        Axis(
            Label("S-N axis", r"Stress amplitude with (SCF|Kf).*"), log=True, number="#,##0", crossing="min",
        ),
        (
            _curve("ChartSN", "Line cycles", "Line", Label("S-N line"), "navy", 2.25),
            _curve("ChartSN", "Start cycles", "One start", Label("One start"), "teal", 1.75),
            _curve("ChartSN", "Starts cycles", "Starts required", Label("Starts required"), "rust", 1.75),
        ),
        legend=True,
        height=84.0,
    ),
    # twist of each station in the first elastic modes, largest = 1
    ChartSpec(
        "shapes", "lines", "Mode shapes: physical twist of each station, largest = 1",
        Axis(low=True), Axis("Relative twist", -1, 1, 0.5, number="0.0"),
        tuple(
            Series("ModeShapes", "Station", f"Mode {k}", Label(f"Shape {k}"), colour, 1.75, marker="circle", size=6)
            for k, colour in zip(range(1, SHAPES + 1), _SHAPE_COLOURS, strict=True)
        ),
        legend=True,
        height=92.0,
    ),
    _interference(),
    *(_history(k) for k in range(1, HISTORIES + 1)),
    _closely(
        "reversal", "ChartReversal", "Reversal", "0.00",
        r".*: torque around its (minimum|least value).*|Torque around the deepest reversal.*",
    ),
    _closely(
        "blow", "ChartBlow", "Blow", "0.000",
        r"Torque (around its minimum, enlarged|at its deepest moment).*"
        r"|.*: (torque at its (minimum|least value)|teeth (part|separate)).*",
    ),
    # the impact in forces: of the teeth, and of the bearings that give way under it
    ChartSpec(
        "forces", "curves",
        Label(
            "Force title",
            r"Tooth and bearing forces.*"
            r"|.*: (forces at (minimum torque|its deepest moment)|no forces (shown|drawn)).*",
        ),
        Axis("Time [s]", number="0.000", low=True),
        Axis(Label("Force axis", r"Force( \[.*\])?"), number="#,##0"),
        tuple(
            _curve("ChartForces", f"Time {k}", f"Force {k}", Label(f"Force {k}"), colour, 1.25)
            for k, colour in zip(range(1, FORCES + 1), ("navy", "rust", "teal"), strict=True)
        ),
        legend=True,
        height=52.0,
    ),
    # load angle and slip while the motor pulls into step and swings, or slips poles
    ChartSpec(
        "pull-in", "curves", Label("Pull-in title", r"Load angle and slip.*"),
        Axis("Time [s]", number="0.0", low=True), Axis(Label("Pull-in axis", r"Load angle.*"), number="0"),
        (
            _curve("ChartPullIn", "Angle time", "Load angle", "Load angle", "navy", 1.5),
            Series("ChartPullIn", "Slip time", "Slip", "Slip", "rust", 1.5, second_axis=True),
        ),
        legend=True,
        second=Axis("Slip [%]", number="0.0", grid=False),
    ),
    _accuracy(),
)  # fmt: skip

#: Every chart of the ordinary workbook by name.
CHARTS: Mapping[str, ChartSpec] = {spec.name: spec for spec in _SPECS}
