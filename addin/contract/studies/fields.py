"""Tables of the study sheets: what is to be tried, and what became of it.

Part of the one table of inputs and outputs, see `addin.contract.tables`, which passes these on. A workbook has
them only if it was made with ``torsionbook new --studies``; a case JSON may have their keys. Nothing
here enters the digest of the case.
"""

from __future__ import annotations

from addin.contract.field import TableSpec, choice, integer, number, table, text, traced
from addin.contract.studies.calibration import CALIBRATION_RESULT_TABLES
from addin.contract.studies.start_matrix import STARTS_RESULT_TABLES
from addin.contract.studies.tolerances import TOLERANCE_RESULT_TABLES
from addin.contract.studies.traces import STUDY_TRACES
from addin.contract.studies.tuning import TUNING_RESULT_TABLES
from engine.case.study_inputs import SCATTERED, TUNED

__all__ = ["STUDY_INPUT_TABLES", "STUDY_RESULT_TABLES"]

_OF_CASE = "as in the case"


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
            "Inertia of the whole coupling: half of it at each end, instead of the fitted one's; given "
            "for all couplings of an element, or for none.",
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
    (
        *TUNING_RESULT_TABLES,
        *TOLERANCE_RESULT_TABLES,
        *STARTS_RESULT_TABLES,
        *CALIBRATION_RESULT_TABLES,
    ),
    STUDY_TRACES,
)
