"""Tables of sheet `ChartData` and the words of charts that only a calculation knows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

#: How many speeds the train drawing distinguishes, mode shapes and excitation lines are drawn.
GROUPS, SHAPES, LINES, CROSSINGS, HISTORIES = 4, 5, 12, 6, 6
#: Methods whose error against time is drawn.
METHODS = ("exponential", "newmark", "chosen", "alternative")
#: Field application and trip on the chart of speed against time.
EVENTS = 2
#: Forces drawn together: of the teeth, and of the bearings of two gears.
FORCES = 3


@dataclass(frozen=True)
class ChartTable:
    """One block of chart data."""

    name: str  #: Name of the Excel table.
    columns: tuple[str, ...]  #: Headers.
    help: str  #: What it holds.


def _numbered(words: Sequence[str], count: int) -> tuple[str, ...]:
    return tuple(f"{word} {k}" for k in range(1, count + 1) for word in words)


def _of_methods(words: Sequence[str]) -> tuple[str, ...]:
    return tuple(f"{method} {word}" for method in METHODS for word in words)


#: Rows of `ChartLabels`, in this order: words that charts show and only a calculation knows.
LABELS: tuple[str, ...] = (
    *_numbered(("Speed group",), GROUPS),
    *_numbered(("Shape",), SHAPES),
    *_numbered(("Line",), LINES),
    *_numbered(("Crossing",), CROSSINGS),
    *_numbered(("History title", "History axis"), HISTORIES),
    "S-N title",
    "S-N axis",
    "Starts required",
    *_numbered(("History caption",), HISTORIES),
    "One start",
    "S-N line",
    "Reversal title",
    "Reversal axis",
    "Blow title",
    "Blow axis",
    "Force title",
    "Force axis",
    *_numbered(("Force",), FORCES),
    "Pull-in title",
    "Pull-in axis",
    *_numbered(("Event",), EVENTS),
    "Accuracy title",
    "Accuracy axis",
    "Motor title",
    "Motor axis",
    "Air-gap title",
    "Air-gap axis",
    "Air-gap element",
    "Clearing title",
    "Clearing axis",
    "Clearing element",
    "Profile title",
    "Profile axis",
    "Governing title",
    "Governing axis",
    "Peaks title",
)

CHART_TABLES: tuple[ChartTable, ...] = (
    ChartTable("ChartLabels", ("Key", "Text"), "Titles and labels of the charts."),
    ChartTable(
        "ChartTrain",
        (
            "Item",
            *_numbered(("Disc up", "Disc down", "Shaft up", "Shaft down"), GROUPS),
            "Mesh up",
            "Mesh down",
        ),
        "Drawing of the train: half heights of discs and shafts.",
    ),
    ChartTable(
        "ChartTorque",
        ("Speed", "Average", "Pulsating", "Pulsation1", "Load", "Accelerating"),
        "Torques [pu of RatedTorque] against speed [% of synchronous], referred to the motor.",
    ),
    ChartTable("ChartSpeedTime", ("Time", "Speed"), "Motor speed against time."),
    ChartTable("ChartCrossings", ("Time", "Speed"), "Where 2 x slip crosses a mode."),
    ChartTable(
        "ChartInterference",
        (
            "Modes speed",
            "Modes",
            "Label speed",
            "Label",
            "Slip speed",
            "2 x slip",
            "Range speed",
            "Range",
            *_numbered(("Line speed", "Line"), LINES),
        ),
        "Interference diagram: motor speed in rpm, frequencies in Hz.",
    ),
    ChartTable("ChartNames", ("Speed", "Frequency"), "Positions of the line labels."),
    ChartTable(
        "ChartSN",
        ("Line cycles", "Line", "Start cycles", "One start", "Starts cycles", "Starts required"),
        "S-N line; cycles of one start and of the required starts that exceed a stress amplitude.",
    ),
    ChartTable(
        "ChartHistory",
        _numbered(("Time", "Value"), HISTORIES),
        "Torque histories of the start: minimum and maximum of equal time intervals.",
    ),
    ChartTable("ChartReversal", ("Time", "Torque"), "Torque around the deepest reversal."),
    ChartTable("ChartBlow", ("Time", "Torque"), "Torque around its minimum, enlarged."),
    ChartTable(
        "ChartForces",
        _numbered(("Time", "Force"), FORCES),
        "Tooth and bearing forces around the minimum torque.",
    ),
    ChartTable(
        "ChartPullIn",
        ("Angle time", "Load angle", "Slip time", "Slip"),
        "Load angle [degrees] and slip [%] after field application.",
    ),
    ChartTable("ChartEvents", ("Time", "Speed"), "Field application and trip: motor speed in rpm."),
    ChartTable(
        "ChartAccuracy",
        _of_methods(("peak name", "peak time", "peak", "starts name", "starts time", "starts")),
        "Name, processor time in ms and error in % of each method.",
    ),
    ChartTable(
        "ChartMotor",
        (
            "Speed",
            "Average",
            "Pulsating",
            "Pulsation1",
            "Typed speed",
            "Typed average",
            "Typed pulsating",
            "Typed pulsation1",
        ),
        "Torques of motors with a data sheet against speed [% of synchronous], calculated and typed.",
    ),
    ChartTable(
        "ChartMotorEvent",
        ("Time", "Air gap", "Element"),
        "Air-gap torque and the largest torque of an element against time [s], in the event with the largest air-gap torque.",
    ),
    ChartTable(
        "ChartClearing",
        ("Time", "Air gap", "Element"),
        "Largest air-gap torque and largest torque of an element against clearing time [s], where the worst one is looked for.",
    ),
    ChartTable(
        "ChartProfile",
        ("Position", "Outline", "Hub position", "Hub", "Bore position", "Bore"),
        "Outlines of the sections of table Sections, those inside a hub, and bores: radii against length.",
    ),
    ChartTable(
        "ChartPeaks",
        (
            "Element",
            "Peak torque",
            "Reversing torque",
            "Shear stress",
            "Vibratory torque",
            "Steady stress",
            "Limit",
        ),
        "Peaks of each element in per cent of their limits.",
    ),
    ChartTable(
        "ChartGoverning",
        ("Time", "Value", "Speed time", "Percent speed", "Limit time", "Limit"),
        "The governing history of the start, speed in per cent of synchronous, and the limit.",
    ),
    ChartTable(
        "ChartBulges", ("Time", "Value"), "Where the modes are named on the governing history."
    ),
)
