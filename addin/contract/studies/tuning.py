"""Tuning, the search for a better coupling, shaft or inertia, in workbook and JSON."""

from __future__ import annotations

from dataclasses import replace

from addin.contract import number_formats as shown
from addin.contract.charts import Axis, ChartSpec, FirstCell, Series
from addin.contract.field import (
    UNLIMITED,
    Field,
    TableSpec,
    Trace,
    choice,
    flag,
    integer,
    mixed,
    number,
    sentence,
    table,
    text,
    verdict,
)
from addin.contract.json_shapes import (
    BLANK,
    COUNT,
    FLAG,
    NUMBER,
    TEXT,
    Shape,
    closed_object,
    cut_short,
    described,
    list_of,
)
from addin.contract.result_tables import RESULT_TABLES
from addin.contract.sheet import ChartAt, Sheet
from addin.contract.sources import PHILOSOPHY, STEADY
from addin.contract.study_spec import StudyScale, StudySpec
from engine.case.study_inputs import TUNED

#: Options of the second variable that the maps have columns for. [count]
LINES = 6
#: Options of the first variable that they have rows for; of more, so many spread over the range.
MAP_ROWS = 13
#: What stands for the second variable where only one is varied.
NO_VARIABLE = "none"
#: Modes drawn against the first variable. [count]
MAP_MODES = 5
_PAGE = "docs/tuning.md"
_RULES = f"{_PAGE}, How combinations are ranked"
_RUN = f"{_PAGE}; calculated like any run of the case, see the result sheets"
_ROWS = ("Tuning.Element", "Tuning.Quantity", "Tuning.Values", "Catalogue.Name")


def _as(result: str, equation: str = "") -> Trace:
    """A number from the run of the combination."""
    return Trace(equation or f"{result} of the run of this combination", _RUN, of_case=(result, *_ROWS))  # fmt: skip


_RANK = Trace(
    "Ranked by, in this order: calculable, start completed, fewest limits violated, "
    "margins kept without forced response, most allowable starts, largest margin",
    _RULES, of_case=_ROWS,
)  # fmt: skip
_COMBINATION = Trace(
    "One option of each row of Tuning and of each element of Catalogue", _PAGE, of_case=_ROWS
)
_ALLOWED_STARTS = _as("AllowableStarts.Allowable starts", "Least of all shafts")
_WORST_MARGIN = _as("SeparationMargins.Margin", "min |f − f_exc| / f_exc")
_CROSSING = f"At the crossing with the largest stress range ({PHILOSOPHY})"
_BAND = "f_min (1 − m) to f_max (1 + m), from |f − f_exc| / f_exc ≥ m"
_CELL = "docs/tuning.md, Maps"
_CROSSINGS = next(spec for spec in RESULT_TABLES if spec.name == "StartupCrossings")
_OPTION = text("Option", "First variable.", "Value or designation, as typed", _PAGE, of_case=_ROWS)
_SHARE = number(
    "Of as is", "fraction", "Value divided by that in the case.", "Value / value in the case", _PAGE,
    of_case=_ROWS,
)  # fmt: skip


def _of_pair(result: str) -> Trace:
    return Trace(
        "Result of the best combination with this pair of options", _CELL, of_case=(result, *_ROWS)
    )


def _lines(dimension: str, help: str, result: str) -> tuple[Field, ...]:
    return tuple(
        number(f"Line {k}", dimension, help, trace=_of_pair(result)) for k in range(1, LINES + 1)
    )


_OF_CASE = "as in the case"

_INPUTS: tuple[TableSpec, ...] = (
    table(
        "Tuning", sheet="Tuning", caption="Tuning",
        help="Quantities to vary, each with values or a range; every combination is calculated.",
        rows=12, row_name=("Element", "Quantity"), short_caption=True,
        columns=(
            text("Element", "Element, or the station of an inertia."),
            choice("Quantity", TUNED, "Quantity to vary."),
            text(
                "Unit",
                "Unit of the numbers to its right, such as lbf*in/rad; % or 1 = relative to the "
                "value in the case.",
                blank="1: multiples of the value in the case",
            ),
            text("Values", "Numbers to try, with semicolons between them: 0.5; 0.8; 1.2."),
            number("From", "count", "Lowest value of a range, instead of Values."),
            number("To", "count", "Highest value of a range."),
            integer("Steps", "Number of values in the range, both ends included; blank = 11."),
        ),
    ),
    table(
        "Catalogue", sheet="Tuning", caption="Catalogue",
        help="Couplings on offer, with the maker's data; each replaces the coupling of the case.",
        rows=16, row_name=("Element", "Name"),
        columns=(
            text("Element", "The coupling of table Elements that it may replace.", kind="element"),
            text("Name", "The maker's designation."),
            choice(
                "Fitted", ("no", "yes"),
                "yes for the coupling whose inertia is included in the stations on sheet Train.",
                blank="no",
            ),
            number("Stiffness", "torsional stiffness", "Torsional stiffness."),
            number(
                "Inertia", "inertia",
                "Inertia of the whole coupling. At each end, half of it replaces half of the inertia "
                "of the fitted coupling. Type it for all couplings of an element, or for none.",
            ),
            number("Damping", "torsional damping", "Viscous damping across it.", blank=_OF_CASE),
            number("Loss factor", "ratio", "Hysteretic loss factor.", blank=_OF_CASE),
            number("Rated torque", "torque", "The maker's rated torque.", blank="not judged"),
            number("Peak torque limit", "torque", "The maker's peak torque.", blank="not judged"),
            number("Vibratory limit", "torque", "Allowed vibratory torque.", blank="not judged"),
        ),
    ),
)  # fmt: skip

_RESULTS: tuple[TableSpec, ...] = (
    table(
        "TuningResults", sheet="Tuning results", caption="Combinations",
        help="Every combination calculated as a full start, best first.",
        row_name=("Combination",), changes_shown=("Rank", "Allowable starts", "Worst margin"),
        json_only=(UNLIMITED,),
        columns=(
            integer(
                "Rank", "1 = the best, by the order on the page docs/tuning.md.", trace=_RANK,
            ),
            text(
                "Combination", "Values of this combination.",
                trace=_COMBINATION, width=36.0,
            ),
            flag(
                "As is", "yes for the unchanged case.", "Whether nothing is changed", _PAGE,
                of_case=_ROWS,
            ),
            flag(
                "Better", "yes where it ranks above the unchanged case.",
                "Whether it ranks above the unchanged case", _RULES,
                of_row=("TuningResults.Rank",),
            ),
            verdict(
                "Verdict",
                "fail where a limit is violated; impossible where the combination cannot be "
                "calculated.",
                trace=_as(
                    "Verdicts.Verdict", "The worst verdict of the run, rated torques included",
                ),
            ),
            integer(
                "Limits broken", "Checks that fail.",
                trace=_as("Verdicts.Verdict", "Number of checks that fail, rated torques included"),
            ),
            number(
                "Allowable starts", "count",
                "Allowable starts of the governing shaft, not divided by StartsFactor.",
                trace=_ALLOWED_STARTS,
                format=shown.STARTS, unlimited=True,
            ),
            number(
                "Worst margin", "fraction", "Least separation margin.",
                trace=_WORST_MARGIN,
            ),
            sentence(
                "Reason", "Reason for the rank.",
                "Limits, governing crossing, starts and stress in words, against the unchanged case",
                _RULES, of_row=("TuningResults.Rank",), width=54.0,
            ),
            text(
                "Broken", "Checks that fail.",
                trace=_as("Verdicts.Check", "Names of the checks that fail"), width=30.0,
            ),
            number(
                "Error", "fraction", "Estimated relative error of the starts.",
                trace=_as("AllowableStarts.Error"), format=shown.ERROR, printed="Estimated error",
            ),
            text(
                "Governing shaft", "Shaft with the fewest starts.", kind="element",
                trace=_as("AllowableStarts.Element", "Shaft with the fewest allowable starts"),
            ),
            text(
                "Margin where", "Mode and excitation of the worst margin.",
                trace=_as(
                    "SeparationMargins.Excitation", "Mode and excitation of the worst margin",
                ),
            ),
            *(
                number(
                    f"Mode {mode}", "frequency", f"{place} elastic mode.",
                    trace=_as("NaturalFrequencies.Frequency"),
                )
                for mode, place in enumerate(("First", "Second", "Third"), start=1)
            ),
            integer(
                "Mode crossed", "Mode whose crossing causes the largest stress in the start.",
                trace=_as(
                    "StartupCrossings.Mode", "Mode with the largest stress range at its crossing",
                ),
            ),
            *(
                replace(_CROSSINGS.column(name), trace=_as(f"StartupCrossings.{name}", _CROSSING))
                for name in ("Percent speed", "Sweep rate", "Average torque", "Pulsating torque")
            ),
            number(
                "Peak-to-peak stress", "pressure", "Largest nominal range in the start.",
                trace=_as(
                    "StartupPeaks.Peak-to-peak stress", "Of the shaft with the largest range × SCF",
                ),
                printed="Stress, pk‑pk",
            ),
            number(
                "Stress with SCF", "pressure", "That range times SCF.",
                trace=_as(
                    "StartupPeaks.Peak-to-peak stress", "Nominal range × SCF, the largest",
                ),
            ),
            text(
                "Stress where", "Its shaft.", kind="element",
                trace=_as("StartupPeaks.Element", "Shaft with the largest range × SCF"),
            ),
            number(
                "Peak torque over rated", "ratio", "Largest torque, referred to the motor, divided by RatedTorque.",
                trace=_as("StartupPeaks.Maximum torque", "max |T| · speed ratio / RatedTorque"),
            ),
            text(
                "Torque where", "Its element.", kind="element",
                trace=_as("StartupPeaks.Element", "Element of the largest torque"),
            ),
            number(
                "Mesh minimum torque", "torque", "Least torque of a mesh.", us="lbf*ft",
                trace=_as(
                    "TorqueReversals.Minimum torque", "Least of all meshes when referred to the motor; value on the From side",
                ),
                format=shown.SIGNED,
            ),
            integer(
                "Impacts", "Number of re-engagements of the teeth; blank without a clearance model.",
                trace=_as("TorqueReversals.Impacts", "Sum over all elements with a modelled clearance"),
            ),
            text(
                "Outcome", "How the start ended.", "How the start of this combination ended", _RUN,
                of_case=_ROWS,
            ),
            sentence(
                "Note", "Warnings that the unchanged case does not have.",
                "Warnings of the run of this combination that the unchanged case does not have",
                _RUN, of_case=_ROWS, width=60.0,
            ),
        ),
    ),
    table(
        "TuningCrossings", sheet="Tuning results", caption="Crossings",
        help="Crossings of 2 × slip frequency with the modes, and of 1 × slip where a motor has Pulsation1, for the best "
        "combinations and the unchanged case.",
        columns=(
            integer("Rank", "Rank of the combination.", trace=_RANK),
            text("Combination", "Values of this combination.", trace=_COMBINATION, width=36.0),
            *(
                replace(column, trace=_as(f"StartupCrossings.{column.name}"), error=None)
                for column in _CROSSINGS.columns
            ),
        ),
    ),
    table(
        "TuningAxes", sheet="Tuning map", caption="The maps",
        help="Rows of the maps are options of the first variable, columns those of the second.",
        workbook_only=True,
        columns=(
            text(
                "First variable", "First variable: rows of the maps and abscissa of the charts.",
                "First row of Tuning, or of Catalogue", _CELL, of_case=_ROWS, width=22.0,
            ),
            text(
                "Second variable", "Second variable: columns of the maps, one chart line per option.",
                "Second row of Tuning, or element of Catalogue", _CELL, of_case=_ROWS, width=11.0,
            ),
            *(
                text(
                    f"Line {k}", "Option of the second variable.", "Option of the second variable", _CELL,
                    of_case=_ROWS, width=11.0,
                )
                for k in range(1, LINES + 1)
            ),
        ),
    ),
    table(
        "TuningStarts", sheet="Tuning map", caption="Allowable starts",
        help="Allowable starts of the best combination of each cell; green many, red few; grey "
        "digits where a margin is not kept.",
        room=MAP_ROWS, workbook_only=True,
        columns=(
            _OPTION, _SHARE,
            *(
                mixed(
                    f"Line {k}", "Allowable starts, or a text.",
                    trace=_of_pair("AllowableStarts.Allowable starts"),
                )
                for k in range(1, LINES + 1)
            ),
        ),
    ),
    table(
        "TuningMargins", sheet="Tuning map", caption="Worst separation margin",
        help="Worst separation margin of the same combinations; red below the required one.",
        room=MAP_ROWS, workbook_only=True,
        columns=(
            _OPTION, _SHARE, *_lines("fraction", "Worst separation margin.", "SeparationMargins.Margin"),
            number(
                "Required", "fraction", "Required margin.",
                trace=_as("SeparationMargins.Required", "MarginRequired, else by Standard and MarginBasis"),
                format=shown.ONE_DECIMAL,
            ),
        ),
    ),
    table(
        "TuningModes", sheet="Tuning map", caption="Modes",
        help="Natural frequencies of the best combination with each option of the first variable.",
        room=MAP_ROWS, workbook_only=True,
        json_only=(UNLIMITED,),
        columns=(
            _OPTION, _SHARE,
            *(
                number(f"Mode {k}", "frequency", "Elastic mode.", trace=_as("NaturalFrequencies.Frequency"))
                for k in range(1, MAP_MODES + 1)
            ),
            number(
                "Allowable starts", "count", "Not divided by StartsFactor.", trace=_ALLOWED_STARTS,
                format=shown.STARTS, unlimited=True,
            ),
            number("Worst margin", "fraction", "Least separation margin.", trace=_WORST_MARGIN),
        ),
    ),
    table(
        "ForbiddenBands", sheet="Tuning map", caption="Forbidden bands",
        help="No mode may lie between From and To of any excitation.",
        row_name=("Excitation",),
        columns=(
            text(
                "Excitation", "Name of the excitation.",
                "Name, as typed, or of the default excitation", STEADY,
                of_case=("Excitations.Name",),
            ),
            number(
                "From", "frequency", "Lowest frequency × (1 − required margin).", _BAND, STEADY,
                of_case=("MinimumSpeed", "Standard", "MarginBasis", "MarginRequired"),
            ),
            number(
                "To", "frequency", "Highest frequency × (1 + required margin).", _BAND, STEADY,
                of_case=("MaximumSpeed", "Standard", "MarginBasis", "MarginRequired"),
            ),
            number(
                "Lowest", "frequency", "Excitation frequency at the lowest speed.",
                "Order × speed of its station at MinimumSpeed, or its frequency", STEADY,
                of_case=("MinimumSpeed", "Excitations.Order", "Excitations.Frequency"),
            ),
            number(
                "Highest", "frequency", "Excitation frequency at the highest speed.",
                "Order × speed of its station at MaximumSpeed, or its frequency", STEADY,
                of_case=("MaximumSpeed", "Excitations.Order", "Excitations.Frequency"),
            ),
            text(
                "Modes inside", "Modes of the unchanged case inside the band.",
                "Modes whose margin from the excitation is less than required", STEADY,
                of_case=("SeparationMargins.Margin",),
            ),
            integer(
                "Combinations clear", "Number of combinations without a mode in the band.",
                "Combinations in which every mode keeps the margin from the excitation", _PAGE, of_case=_ROWS,
            ),
            integer(
                "Combinations", "Combinations that were calculated.",
                "Combinations that could be calculated", _PAGE, of_case=_ROWS,
            ),
        ),
    ),
    table(
        "TuningLines", sheet="StudyData", caption="Chart data of allowable starts",
        help="Data of the allowable-starts chart, numbers only.",
        workbook_only=True,
        columns=(_SHARE, *_lines("count", "Allowable starts.", "AllowableStarts.Allowable starts")),
    ),
    table(
        "TuningHatch", sheet="StudyData", caption="Hatching",
        help="Hatching of the forbidden bands.",
        workbook_only=True,
        columns=(
            _SHARE,
            number(
                "Frequency", "frequency", "Hatching lines between the limits of each band.",
                "Lines between From and To of each band", _CELL,
                of_row=("ForbiddenBands.From", "ForbiddenBands.To"),
            ),
        ),
    ),
)  # fmt: skip

#: Rows from one caption to that of the next map: caption, units, header, rows, two blank.
_STEP = MAP_ROWS + 5
_FIRST_MAP = 12
_STARTS, _MARGINS, _MODES, _BANDS = (_FIRST_MAP + k * _STEP for k in range(4))

_SHEETS: tuple[Sheet, ...] = (
    Sheet(
        "Tuning",
        "input",
        {"A": 1.5, "B": 22, "C": 12, "D": 13, "E": 26, "F:H": 10, "I": 2, "J": 20, "K": 24,
         "L": 8, "M:S": 11},
        {"Tuning": "B5", "Catalogue": "J5"},
        freeze="A8",
        breaks=("I",),
        intro="Quantities and couplings to vary, for torsionbook tune FILE: it calculates every "
        "combination of the rows of Tuning and one Catalogue row per element. With both "
        "tables blank nothing is calculated.",
    ),
    Sheet(
        "Tuning results",
        "result",
        {"A": 1.5, "B": 6, "C": 38, "D:E": 7, "F": 18, "G": 8, "H": 12, "I": 9, "J": 77, "K": 30,
         "L": 9, "M": 22, "N": 28, "O:Q": 9, "R": 8, "S:V": 10.5, "W:X": 10.5, "Y": 22, "Z": 9,
         "AA": 22, "AB": 11, "AC": 9, "AD": 13, "AE": 60},
        {"TuningResults": "B7"},
        printed="J",
        rows_printed=12,
        intro="torsionbook tune FILE: every combination of sheet Tuning as a full start, ranked. "
        "The order and its reasons: docs/tuning.md. The first 12 rows are printed; all combinations are in the JSON.",
    ),
    Sheet(
        "Tuning crossings",
        "result",
        {"A": 1.5, "B": 5, "C": 28, "D": 5, "E:G": 8.5, "H:L": 8.6, "M": 16, "N:P": 9.5, "Q": 28},
        {"TuningCrossings": "B7"},
        rows_printed=18,
        on="Tuning results",
        intro="Where 2 × slip frequency crosses the modes, for the best combinations and for "
        "the unchanged case. The first 18 rows are printed.",
    ),
    Sheet(
        "Tuning map",
        "result",
        {"A": 1.5, "B": 24, "C": 13.5, "D:I": 10.6, "J": 10.6, "K": 1.5, "L:R": 9.4},
        {
            "TuningAxes": "B7",
            "TuningStarts": f"B{_STARTS}",
            "TuningMargins": f"B{_MARGINS}",
            "TuningModes": f"B{_MODES}",
            "ForbiddenBands": f"B{_BANDS}",
        },
        (
            ChartAt("tuning-starts", f"L{_STARTS}", 490, 300),
            ChartAt("tuning-margins", f"L{_MARGINS}", 490, 300),
            ChartAt("tuning-modes", f"L{_MODES}", 490, 300),
        ),
        row_breaks=(_MARGINS - 1, _MODES - 1),
        intro="Allowable starts and margins over the first two variables of sheet Tuning; each "
        "cell shows the best combination of all other variables. No mode may lie in a "
        "hatched band.",
    ),
    Sheet(
        "StudyData",
        "result",
        {"A": 1.5, "B:L": 11},
        {"TuningLines": "B5", "TuningHatch": "K5"},
        hidden=True,
    ),
)  # fmt: skip

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

_CHARTS: tuple[ChartSpec, ...] = (
    ChartSpec(
        "tuning-starts", "curves",
        "Allowable starts, one line per option of the second variable (unlimited left out)",
        _FIRST_VARIABLE, Axis("Allowable starts", log=True, number="#,##0", crossing="min"),
        _options("TuningLines"), legend=True,
    ),
    ChartSpec(
        "tuning-margins", "curves",
        "Worst separation margin, one line per option of the second variable",
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


def _details() -> Shape:
    """What its JSON has beside its tables."""
    option = closed_object({"label": TEXT, "value": NUMBER})
    variable = {
        "name": described("Element, or the station of an inertia.", TEXT),
        "quantity": TEXT,
        "unit": described("Unit of the values below; backlash is m or rad.", TEXT),
        "present": described("Value in the case.", NUMBER),
        "options": list_of(option),
    }
    choice = {"rank": COUNT, "values": list_of(BLANK)}
    window = {"from": NUMBER, "to": described("Absent above the highest band.", NUMBER)}
    cell = {
        "across": described("Option of the first variable.", TEXT),
        "across_value": NUMBER,
        "up": described("Option of the second variable.", TEXT),
        "up_value": NUMBER,
        "rank": described("Rank of the best combination with both options.", COUNT),
        "limits_broken": COUNT,
        "allowable_starts": described("Absent where unlimited or not judged.", NUMBER),
        "unlimited": described("Absent where starts were not judged.", FLAG),
        "worst_margin": NUMBER,
    }
    cells = closed_object(cell) | {"patternProperties": {"^mode_[1-9][0-9]*$": NUMBER}}
    return {
        **cut_short("Combinations."),
        "variables": list_of(closed_object(variable)),
        "choices": list_of(
            closed_object(choice), "Values of the variables of each combination, by rank."
        ),
        "free_windows": list_of(
            closed_object(window), "Frequencies outside all forbidden bands. [Hz]"
        ),
        "tuning_map": list_of(cells),
    }


TUNING = StudySpec(
    key="tuning",
    order=1,
    command="tune",
    sheet="Tuning results",
    inputs=_INPUTS,
    results=_RESULTS,
    sheets=_SHEETS,
    details=_details(),
    charts=_CHARTS,
    height=84.0,
    scales=(
        StudyScale("TuningStarts", "Line 1", f"Line {LINES}", "Required", "TuningMargins"),
        StudyScale("TuningMargins", "Line 1", f"Line {LINES}", "Required"),
    ),
)
