"""Tables of the study sheets: what is to be tried, and what became of it.

Part of the one table of inputs and outputs, see `addin.fields`, which passes these on. A workbook has
them only if it was made with ``torsionbook new --studies``; a case JSON may have their keys. Nothing
here enters the digest of the case.
"""

from __future__ import annotations

from addin.field_kinds import Field, TableSpec, choice, integer, mixed, number, table, text, traced
from addin.study_traces import STUDY_TRACES
from addin.tuning_fields import TUNING_RESULT_TABLES
from engine.studies import SCATTERED, TUNED

__all__ = ["STUDY_INPUT_TABLES", "STUDY_RESULT_TABLES"]

_OF_CASE = "as in the case"


def _percentiles(dimension: str) -> tuple[Field, ...]:
    """P10, P50, P90, each with the ends of its interval; words where starts may be unlimited."""
    fields = []
    for p in (10, 50, 90):
        for end, words in (
            ("", f"{p} % of the samples are at or below it."),
            (" low", f"Lower end of the 95 % interval of P{p}."),
            (" high", f"Upper end of the 95 % interval of P{p}."),
        ):
            name = f"P{p}{end}"
            fields.append(mixed(name, words) if not dimension else number(name, dimension, words))
    return tuple(fields)


_MET = (
    number("Probability", "fraction", "Share of the samples that meet the demand."),
    number("Probability low", "fraction", "Lower end of its 95 % interval (Clopper-Pearson)."),
    number("Probability high", "fraction", "Upper end of its 95 % interval."),
)

_TOLERANCE_RESULTS: tuple[TableSpec, ...] = (
    table(
        "ToleranceStarts",
        "Tolerance results",
        1,
        "Allowable starts: percentiles with 95 % intervals, and the probability of those required.",
        text("Element", "Judged shaft; train = the worst of all.", kind="element"),
        mixed("Nominal", "Allowable starts of the plain run."),
        *_percentiles(""),
        number("Unlimited", "fraction", "Share of the samples without any damage."),
        number("Required", "count", "StartsRequired."),
        *_MET,
        integer("Samples", "Samples whose start came to its end."),
    ),
    table(
        "ToleranceDrivers",
        "Tolerance results",
        1,
        "What drives the answer named above: runs with one factor at a time, and rank regression.",
        text("Factor", "What scatters."),
        number("Deviation", "fraction", "Its standard deviation, of what the case says."),
        mixed("At P10", "The answer of a run with this factor at its P10, all else as stated."),
        mixed("At P90", "The answer of a run with this factor at its P90, all else as stated."),
        number("Change at P10", "fraction", "Change of that answer from the plain run's."),
        number("Change at P90", "fraction", "Change of that answer from the plain run's."),
        number("Rank coefficient", "ratio", "Standardized coefficient of the rank regression."),
        number("Partial correlation", "ratio", "Partial rank correlation."),
        number("Share", "fraction", "Part of the scatter of the ranks; all add up to R²."),
        json_only=("dimension",),
    ),
    table(
        "ToleranceFrequencies",
        "Tolerance tables",
        1,
        "Natural frequencies.",
        integer("Mode", "Elastic mode."),
        number("Nominal", "frequency", "Of the plain run."),
        *_percentiles("frequency"),
        integer("Samples", "Samples."),
    ),
    table(
        "ToleranceMargins",
        "Tolerance tables",
        1,
        "Separation margins, and the probability that each is kept.",
        integer("Mode", "Elastic mode."),
        text("Excitation", "Name of the excitation."),
        number("Nominal", "fraction", "Margin of the plain run."),
        number("P10", "fraction", "10 % of the samples are at or below it."),
        number("P50", "fraction", "Half of the samples are at or below it."),
        number("P90", "fraction", "90 % of the samples are at or below it."),
        number("Required", "fraction", "Required margin."),
        *_MET,
    ),
    table(
        "TolerancePeaks",
        "Tolerance tables",
        1,
        "Largest torques and nominal stresses of the start, zero-to-peak.",
        text("Element", "Element.", kind="element"),
        number("Nominal torque", "torque", "Of the plain run.", us="lbf*ft"),
        number("Torque P10", "torque", "10 % of the samples are at or below it.", us="lbf*ft"),
        number("Torque P50", "torque", "Half of the samples are at or below it.", us="lbf*ft"),
        number("Torque P90", "torque", "90 % of the samples are at or below it.", us="lbf*ft"),
        number("Nominal stress", "pressure", "Of the plain run, without SCF."),
        number("Stress P10", "pressure", "10 % of the samples are at or below it."),
        number("Stress P50", "pressure", "Half of the samples are at or below it."),
        number("Stress P90", "pressure", "90 % of the samples are at or below it."),
    ),
    table(
        "ToleranceDistribution",
        "Tolerance data",
        1,
        "Starts and first frequency by probability.",
        number("Probability", "fraction", "Share of the samples at or below."),
        number("Starts", "count", "Allowable starts of the train; blank = unlimited."),
        number("First frequency", "frequency", "First elastic frequency."),
    ),
    table(
        "ToleranceHistogram",
        "Tolerance data",
        1,
        "Allowable starts of the samples.",
        text("Starts", "Between which numbers of starts."),
        number("Share", "fraction", "Share of the samples."),
    ),
    table(
        "ToleranceTornado",
        "Tolerance data",
        1,
        "The strongest factors.",
        text("Factor", "What scatters."),
        number("At P10", "fraction", "Change of the answer with this factor at its P10."),
        number("At P90", "fraction", "Change of the answer with this factor at its P90."),
    ),
)

_SENSITIVITY_RESULTS: tuple[TableSpec, ...] = (
    table(
        "Sensitivities",
        "Sensitivities",
        1,
        "What + 1 % of each quantity does to the governing shaft: derivative, and what really happens.",
        text("Quantity", "What is changed."),
        text("Of", "Whose: element, station or material; blank = all modes."),
        number(
            "Peak change", "fraction", "Change of its peak stress for + 1 %, by the derivative."
        ),
        number("Peak error", "fraction", "Estimated error of that."),
        number("Peak below", "fraction", "Change of its peak stress in a run at - 1 %."),
        number("Peak above", "fraction", "Change of its peak stress in a run at + 1 %."),
        number("Starts change", "fraction", "Change of its starts for + 1 %, by the derivative."),
        number("Starts error", "fraction", "Estimated error of that."),
        number("Starts below", "fraction", "Change of its starts in a run at - 1 %."),
        number("Starts above", "fraction", "Change of its starts in a run at + 1 %."),
        text("Method", "How the derivative was found."),
        text("Note", "What must be known of this row."),
    ),
    table(
        "FrequencySensitivities",
        "Frequency sensitivities",
        1,
        "Relative change of each frequency over that of the quantity: ± ½ × share of the energy.",
        text("Quantity", "stiffness or inertia; bearing stiffness, sideways mass."),
        text("Of", "Element or station."),
        repeated=number("Mode", "ratio", "Half the share of the mode's energy; - of inertias."),
        extra_columns=tuple(
            number(
                f"Shift {mode}",
                "frequency",
                f"Live formula: Mode {mode} × the change above × its frequency on sheet Frequencies.",
            )
            for mode in (1, 2, 3)
        ),
    ),
)

#: Input tables of the studies, in the order in which problems are reported.
STUDY_INPUT_TABLES: tuple[TableSpec, ...] = (
    table(
        "Tuning",
        "Tuning",
        12,
        "Quantities that may be chosen, each with values or a range; every combination is tried.",
        text("Element", "Element, or the station of an inertia."),
        choice("Quantity", TUNED, "What of it is tried."),
        text(
            "Unit",
            "Unit of the numbers right of it, such as lbf*in/rad; % or 1 = of what the case says.",
            blank="1: multiples of what the case says",
        ),
        text("Values", "Numbers to try, with semicolons between them: 0.5; 0.8; 1.2."),
        number("From", "count", "Lowest value of a range, instead of Values."),
        number("To", "count", "Highest value of a range."),
        integer("Steps", "How many values the range is given, its ends included; blank = 11."),
    ),
    table(
        "Catalogue",
        "Tuning",
        16,
        "Couplings on offer, in the maker's numbers; each takes the place of the one in the case.",
        text("Element", "The coupling of table Elements that it may replace.", kind="element"),
        text("Name", "The maker's designation."),
        choice(
            "Fitted",
            ("no", "yes"),
            "yes for the one whose inertia the stations on sheet Train contain.",
            blank="no",
        ),
        number("Stiffness", "torsional stiffness", "Torsional stiffness."),
        number(
            "Inertia",
            "inertia",
            "Inertia of the whole coupling: half of it at each end, instead of the fitted one's.",
            blank="0",
        ),
        number("Damping", "torsional damping", "Viscous damping across it.", blank=_OF_CASE),
        number("Loss factor", "ratio", "Hysteretic loss factor.", blank=_OF_CASE),
        number("Rated torque", "torque", "The maker's rated torque.", blank="not judged"),
        number("Peak torque limit", "torque", "The maker's peak torque.", blank="not judged"),
        number("Vibratory limit", "torque", "Allowed vibratory torque.", blank="not judged"),
    ),
    table(
        "Scatter",
        "Tolerances",
        16,
        "How sure the inputs are, relative to what the case says.",
        text(
            "Name",
            "Element, station or material.",
            blank="all that have the quantity",
        ),
        choice("Quantity", SCATTERED, "What of it scatters; a damping ratio is that of all modes."),
        choice(
            "Distribution",
            ("normal", "uniform", "triangular", "from-to"),
            "normal: Spread is the standard deviation; uniform and triangular: the half width; "
            "from-to: uniform between From and To.",
            blank="normal",
        ),
        number("Spread", "fraction", "Standard deviation or half width, of what the case says."),
        number("From", "fraction", "Least value, of what the case says."),
        number("To", "fraction", "Largest value, of what the case says."),
        choice(
            "Together",
            ("each", "together"),
            "With a blank name: each scatters for itself, or all by one factor.",
            blank="each",
        ),
    ),
    table(
        "StartConditions",
        "Duty",
        20,
        "Kinds of starts and how often they happen; blank = the usual matrix of voltages and loads.",
        text("Condition", "Name of the kind of start."),
        number("Voltage", "fraction", "Of the voltage of the torque curves.", blank=_OF_CASE),
        number("Damping ratio", "fraction", "Of all elastic modes, hot or cold.", blank=_OF_CASE),
        number("Load", "fraction", "Share of LoadTorque that acts; 0 = unloaded.", blank="100 %"),
        number(
            "Trip speed",
            "running speed",
            "Speed at which it is aborted; % means of synchronous speed.",
            blank=_OF_CASE,
            us="%",
            si="%",
        ),
        number("Per year", "count", "Such starts a year.", blank="0"),
        number("So far", "count", "Such starts the train has seen.", blank="0"),
    ),
    table(
        "MeasuredFrequencies",
        "Measured",
        10,
        "Torsional natural frequencies found by measurement.",
        integer("Mode", "Elastic mode it is taken for; blank = the one that fits best."),
        number("Frequency", "frequency", "As measured."),
        number("Uncertainty", "fraction", "Standard deviation.", blank="1 %"),
    ),
    table(
        "MeasuredPeaks",
        "Measured",
        6,
        "Largest torques found in a measured start (optional).",
        text("Element", "Element of table Elements.", kind="element"),
        number("Maximum torque", "torque", "As measured, at the element's own speed.", us="lbf*ft"),
        number("Uncertainty", "fraction", "Standard deviation.", blank="5 %"),
    ),
)

#: Result tables of the studies: rows come from the engine, keys and units are those of the JSON.
STUDY_RESULT_TABLES: tuple[TableSpec, ...] = traced(
    (*TUNING_RESULT_TABLES, *_TOLERANCE_RESULTS, *_SENSITIVITY_RESULTS), STUDY_TRACES
)
