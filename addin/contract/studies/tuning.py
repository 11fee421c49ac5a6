"""Result tables of a tuning study, and where each column comes from; part of `addin.contract.studies.fields`."""

from __future__ import annotations

from collections.abc import Mapping

from addin.contract.charts import Axis, ChartSpec, FirstCell, Series
from addin.contract.field import Field, TableSpec, integer, number, table, text
from addin.contract.result_tables import Trace

__all__ = ["LINES", "MAP_MODES", "MAP_ROWS", "TUNING_RESULT_TABLES", "TUNING_TRACES"]

#: Options of the second variable that the maps have columns for. [count]
LINES = 6
#: Options of the first variable that they have rows for; of more, so many spread over the range.
MAP_ROWS = 13
#: Modes drawn against the first variable. [count]
MAP_MODES = 5
_MAP = "Tuning map"


def _lines(name: str, dimension: str, help: str) -> tuple[Field, ...]:
    return tuple(number(f"{name} {k}", dimension, help) for k in range(1, LINES + 1))


_OPTION = text("Option", "What the first variable is.")
_SHARE = number("Of as is", "fraction", "Its value over what the case says.")

TUNING_RESULT_TABLES: tuple[TableSpec, ...] = (
    table(
        "TuningResults",
        "Tuning results",
        1,
        "Every combination as a full start, the best first.",
        integer("Rank", "1 = the best, by the order on the page docs/tuning.md."),
        text("Combination", "What was chosen."),
        text("As is", "yes for the case as it stands.", kind="flag"),
        text("Better", "yes where it ranks above the case as it stands.", kind="flag"),
        text("Verdict", "fail where a limit is broken, impossible where there is no such case."),
        integer("Limits broken", "Checks that fail."),
        number("Allowable starts", "count", "Of the governing shaft, not divided by StartsFactor."),
        number("Worst margin", "fraction", "Least separation margin."),
        text("Reason", "Why it stands there."),
        text("Broken", "Which limits are broken."),
        number("Error", "fraction", "Estimated relative error of the starts."),
        text("Governing shaft", "Shaft with the fewest starts.", kind="element"),
        text("Margin where", "Its mode and excitation."),
        number("Mode 1", "frequency", "First elastic mode."),
        number("Mode 2", "frequency", "Second elastic mode."),
        number("Mode 3", "frequency", "Third elastic mode."),
        integer("Mode crossed", "Mode whose crossing stresses the train most in the start."),
        number("Percent speed", "fraction", "Speed at which it is crossed, of synchronous."),
        number("Sweep rate", "sweep rate", "How fast 2 × slip frequency falls there."),
        number("Average torque", "torque", "Average motor torque there.", us="lbf*ft"),
        number("Pulsating torque", "torque", "Zero-to-peak, there.", us="lbf*ft"),
        number("Peak-to-peak stress", "pressure", "Largest nominal range in the start."),
        number("Stress with SCF", "pressure", "The same times SCF."),
        text("Stress where", "Its shaft.", kind="element"),
        number("Peak torque over rated", "ratio", "Largest torque at motor speed."),
        text("Torque where", "Its element.", kind="element"),
        number("Mesh minimum torque", "torque", "Least torque of a mesh.", us="lbf*ft"),
        integer("Impacts", "How often teeth meet again; blank without a clearance model."),
        text("Outcome", "How the start ended."),
        text("Note", "What a reader must know besides, and not of the case as it stands."),
        json_only=("unlimited",),
    ),
    table(
        "TuningCrossings",
        "Tuning crossings",
        1,
        "Where 2 × slip frequency crosses the modes, of the best combinations and as is.",
        integer("Rank", "Of the combination."),
        text("Combination", "What was chosen."),
        integer("Mode", "Elastic mode."),
        number("Frequency", "frequency", "Natural frequency."),
        number("Percent speed", "fraction", "Speed of the crossing, of synchronous."),
        number("Time", "time", "Time of the crossing."),
        number("Average torque", "torque", "Average motor torque there.", us="lbf*ft"),
        number("Pulsating torque", "torque", "Zero-to-peak, there.", us="lbf*ft"),
        number("Load torque", "torque", "Referred to motor speed, there.", us="lbf*ft"),
        number("Acceleration", "angular acceleration", "Acceleration of the motor there."),
        number("Sweep rate", "sweep rate", "How fast 2 × slip frequency falls."),
        text("Governing element", "Element with the largest stress or torque.", kind="element"),
        number("Peak-to-peak torque", "torque", "Its torque range.", us="lbf*ft"),
        number("Peak-to-peak stress", "pressure", "Its nominal stress range."),
        number("Mesh minimum torque", "torque", "Least mesh torque there.", us="lbf*ft"),
        text("Note", "What the numbers say, in words."),
    ),
    table(
        "TuningAxes",
        _MAP,
        1,
        "Rows of the maps are options of the first variable, columns those of the second.",
        text("First variable", "Down the maps, and along the charts."),
        text("Second variable", "Across the maps: one line of the charts each."),
        *(text(f"Line {k}", "Option of the second variable.") for k in range(1, LINES + 1)),
    ),
    table(
        "TuningStarts",
        _MAP,
        1,
        "Of the best combination in each cell; green many, red few; grey figures where a margin is not kept.",
        _OPTION,
        _SHARE,
        *(
            text(f"Line {k}", "Allowable starts, or words.", kind="mixed")
            for k in range(1, LINES + 1)
        ),
    ),
    table(
        "TuningMargins",
        _MAP,
        1,
        "Worst separation margin of the same combinations; red below the required one.",
        _OPTION,
        _SHARE,
        *_lines("Line", "fraction", "Worst separation margin."),
        number("Required", "fraction", "Required margin."),
    ),
    table(
        "TuningModes",
        _MAP,
        1,
        "Of the best combination with each option of the first variable.",
        _OPTION,
        _SHARE,
        *(number(f"Mode {k}", "frequency", "Elastic mode.") for k in range(1, MAP_MODES + 1)),
        number("Allowable starts", "count", "Not divided by StartsFactor."),
        number("Worst margin", "fraction", "Least separation margin."),
        json_only=("unlimited",),
    ),
    table(
        "ForbiddenBands",
        _MAP,
        1,
        "No mode may lie between From and To of any excitation.",
        text("Excitation", "Name of the excitation."),
        number("From", "frequency", "Lowest frequency × (1 − required margin)."),
        number("To", "frequency", "Highest frequency × (1 + required margin)."),
        number("Lowest", "frequency", "Of the excitation, at the lowest speed."),
        number("Highest", "frequency", "Of the excitation, at the highest speed."),
        text("Modes inside", "Of the case as it stands."),
        integer("Combinations clear", "Combinations without a mode inside."),
        integer("Combinations", "Combinations that were calculated."),
    ),
    table(
        "TuningLines",
        "StudyData",
        1,
        "Numbers behind the chart of starts: no words.",
        _SHARE,
        *_lines("Line", "count", "Allowable starts."),
    ),
    table(
        "TuningHatch",
        "StudyData",
        1,
        "Hatching of the forbidden bands.",
        _SHARE,
        number("Frequency", "frequency", "Up and down between the ends of a band."),
    ),
)

_PAGE = "docs/tuning.md"
_RULES = f"{_PAGE}, How combinations are ranked"
_RUN = f"{_PAGE}; as the plain run of that case, see its result sheets"
_ROWS = ("Tuning.Element", "Tuning.Quantity", "Tuning.Values", "Catalogue.Name")
_PHILOSOPHY = "Szenasi & von Nimitz 1978, Philosophy of resonant response location"
_STEADY = "Szenasi & von Nimitz 1978, Steady state torsional analysis"


def _as(result: str, equation: str = "") -> Trace:
    """A number that the plain run of the combination gives."""
    return Trace(equation or f"{result} of the run of this combination", _RUN, of_case=(result, *_ROWS))  # fmt: skip


def _worst(result: str, words: str) -> Trace:
    return Trace(words, _RUN, of_case=(result, *_ROWS))


_CROSSING = f"At the crossing with the largest stress range ({_PHILOSOPHY})"
_RESULTS: Mapping[str, Trace] = {
    "Rank": Trace("Order of what can be calculated, comes to its end, breaks fewest limits, keeps margins "
                  "by itself, allows most starts, has the widest margin", _RULES, of_case=_ROWS),
    "Combination": Trace("One option of each row of Tuning and of each element of Catalogue", _PAGE,
                         of_case=_ROWS),
    "As is": Trace("Whether nothing is changed", _PAGE, of_case=_ROWS),
    "Better": Trace("Whether it ranks above the case as it stands", _RULES,
                    of_row=("TuningResults.Rank",)),
    "Verdict": _as("Verdicts.Verdict", "The worst verdict of the run, rated torques included"),
    "Limits broken": _as("Verdicts.Verdict", "Number of checks that fail, rated torques included"),
    "Broken": _as("Verdicts.Check", "Names of the checks that fail"),
    "Allowable starts": _worst("AllowableStarts.Allowable starts", "Least of all shafts"),
    "Error": _as("AllowableStarts.Error"),
    "Governing shaft": _as("AllowableStarts.Element", "Shaft with the fewest allowable starts"),
    "Worst margin": _worst("SeparationMargins.Margin", "min |f − f_exc| / f_exc"),
    "Margin where": _as("SeparationMargins.Excitation", "Mode and excitation of the worst margin"),
    "Mode 1": _as("NaturalFrequencies.Frequency"),
    "Mode 2": _as("NaturalFrequencies.Frequency"),
    "Mode 3": _as("NaturalFrequencies.Frequency"),
    "Mode crossed": _as("StartupCrossings.Mode", "Mode with the largest stress range at its crossing"),
    "Percent speed": _as("StartupCrossings.Percent speed", _CROSSING),
    "Sweep rate": _as("StartupCrossings.Sweep rate", _CROSSING),
    "Average torque": _as("StartupCrossings.Average torque", _CROSSING),
    "Pulsating torque": _as("StartupCrossings.Pulsating torque", _CROSSING),
    "Peak-to-peak stress": _worst("StartupPeaks.Peak-to-peak stress", "Of the shaft with the largest range × SCF"),
    "Stress with SCF": _worst("StartupPeaks.Peak-to-peak stress", "Nominal range × SCF, the largest"),
    "Stress where": _as("StartupPeaks.Element", "Shaft with the largest range × SCF"),
    "Peak torque over rated": _worst("StartupPeaks.Maximum torque", "max |T| · speed ratio / RatedTorque"),
    "Torque where": _as("StartupPeaks.Element", "Element of the largest torque"),
    "Mesh minimum torque": _worst("TorqueReversals.Minimum torque", "Least of all meshes, at motor speed"),
    "Impacts": _worst("TorqueReversals.Impacts", "Sum over all teeth"),
    "Outcome": Trace("How the start of this combination ended", _RUN, of_case=_ROWS),
    "Note": Trace("Warnings of the run of this combination that the case as it stands does not have", _RUN,
                  of_case=_ROWS),
    "Reason": Trace("Limits, governing crossing, starts and stress in words, against the case as it stands",
                    _RULES, of_row=("TuningResults.Rank",)),
}  # fmt: skip

_IN_CROSSINGS = (
    "Mode", "Frequency", "Percent speed", "Time", "Average torque", "Pulsating torque", "Load torque",
    "Acceleration", "Sweep rate", "Governing element", "Peak-to-peak torque", "Peak-to-peak stress",
    "Mesh minimum torque", "Note",
)  # fmt: skip
_BAND = "f_min (1 − m) to f_max (1 + m), from |f − f_exc| / f_exc ≥ m"
_BANDS: Mapping[str, Trace] = {
    "Excitation": Trace("Name, as typed or as the usual ones are called", _STEADY,
                        of_case=("Excitations.Name",)),
    "From": Trace(_BAND, _STEADY, of_case=("MinimumSpeed", "MarginBasis", "MarginRequired")),
    "To": Trace(_BAND, _STEADY, of_case=("MaximumSpeed", "MarginBasis", "MarginRequired")),
    "Lowest": Trace("Order × speed of its station at MinimumSpeed, or its frequency", _STEADY,
                    of_case=("MinimumSpeed", "Excitations.Order", "Excitations.Frequency")),
    "Highest": Trace("Order × speed of its station at MaximumSpeed, or its frequency", _STEADY,
                     of_case=("MaximumSpeed", "Excitations.Order", "Excitations.Frequency")),
    "Modes inside": Trace("Modes whose margin from it is less than required", _STEADY,
                          of_case=("SeparationMargins.Margin",)),
    "Combinations clear": Trace("Combinations all of whose modes keep the margin from it", _PAGE,
                                of_case=_ROWS),
    "Combinations": Trace("Combinations that could be calculated", _PAGE, of_case=_ROWS),
}  # fmt: skip

_OPTIONS = {
    "Option": Trace("Value or designation, as typed", _PAGE, of_case=_ROWS),
    "Of as is": Trace("Value over what the case says", _PAGE, of_case=_ROWS),
}
_CELL = "docs/tuning.md, Maps"
_numbered = range(1, LINES + 1)

TUNING_TRACES: Mapping[tuple[str, str], Trace] = {
    **{("TuningResults", name): trace for name, trace in _RESULTS.items()},
    ("TuningCrossings", "Rank"): _RESULTS["Rank"],
    ("TuningCrossings", "Combination"): _RESULTS["Combination"],
    **{("TuningCrossings", name): _as(f"StartupCrossings.{name}") for name in _IN_CROSSINGS},
    ("TuningAxes", "First variable"): Trace("First row of Tuning, or of Catalogue", _CELL, of_case=_ROWS),
    ("TuningAxes", "Second variable"): Trace("Second row of Tuning, or element of Catalogue", _CELL, of_case=_ROWS),
    **{("TuningAxes", f"Line {k}"): Trace("Option of the second variable", _CELL, of_case=_ROWS) for k in _numbered},
    **{
        (name, column): trace
        for name in ("TuningStarts", "TuningMargins", "TuningModes", "TuningLines", "TuningHatch")
        for column, trace in _OPTIONS.items()
    },
    **{
        (name, f"Line {k}"): Trace(
            "Of the best combination with this pair of options", _CELL, of_case=(source, *_ROWS)
        )
        for name, source in (
            ("TuningStarts", "AllowableStarts.Allowable starts"),
            ("TuningMargins", "SeparationMargins.Margin"),
            ("TuningLines", "AllowableStarts.Allowable starts"),
        )
        for k in _numbered
    },
    ("TuningMargins", "Required"): _as("SeparationMargins.Required", "MarginRequired, else by MarginBasis"),
    **{
        ("TuningModes", f"Mode {k}"): _as("NaturalFrequencies.Frequency")
        for k in range(1, MAP_MODES + 1)
    },
    ("TuningModes", "Allowable starts"): _RESULTS["Allowable starts"],
    ("TuningModes", "Worst margin"): _RESULTS["Worst margin"],
    **{("ForbiddenBands", name): trace for name, trace in _BANDS.items()},
    ("TuningHatch", "Frequency"): Trace("Lines between From and To of each band", _CELL, of_row=("ForbiddenBands.From", "ForbiddenBands.To")),
}  # fmt: skip


_COLOURS = ("navy", "teal", "gold", "rust", "plum", "grey")


def _options(table: str) -> tuple[Series, ...]:
    """A line each option of the second variable, over those of the first."""
    return tuple(
        Series(
            table, "Of as is", f"Line {k}", FirstCell("TuningAxes", f"Line {k}"),
            _COLOURS[(k - 1) % len(_COLOURS)], 1.75, marker="circle",
        )
        for k in range(1, LINES + 1)
    )  # fmt: skip


def _modes() -> tuple[Series, ...]:
    """Modes, and the bands that no mode may lie in."""
    hatch = Series("TuningHatch", "Of as is", "Frequency", "Forbidden", "#EFB9AE", 0.5)
    return (
        hatch,
        *(
            Series(
                "TuningModes", "Of as is", f"Mode {k}", f"Mode {k}",
                _COLOURS[(k - 1) % len(_COLOURS)], 2.0, marker="circle",
            )
            for k in range(1, MAP_MODES + 1)
        ),
    )  # fmt: skip


_FIRST_VARIABLE = Axis(FirstCell("TuningAxes", "First variable"), number="General")
_REQUIRED = Series("TuningMargins", "Of as is", "Required", "Required", "rust", 1.5, "dash")

CHARTS = (
    ChartSpec(
        "tuning-starts", "curves",
        "Allowable starts, a line each option of the second variable (unlimited left out)",
        _FIRST_VARIABLE, Axis("Allowable starts", log=True, number="#,##0", crossing="min"),
        _options("TuningLines"), legend=True,
    ),
    ChartSpec(
        "tuning-margins", "curves",
        "Worst separation margin, a line each option of the second variable",
        _FIRST_VARIABLE, Axis("Margin, as in the table", least=0, number="General"),
        (*_options("TuningMargins"), _REQUIRED), legend=True,
    ),
    ChartSpec(
        "tuning-modes", "curves",
        "Modes of the best combination with each option, and the forbidden bands",
        _FIRST_VARIABLE, Axis("Frequency, as in the table", least=0, number="General"),
        _modes(), legend=True,
    ),
)  # fmt: skip
