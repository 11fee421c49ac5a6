"""Tolerances, what the scatter of inputs does to the answers, in workbook and JSON."""

from __future__ import annotations

from addin.contract import number_formats as shown
from addin.contract.charts import Axis, ChartSpec, Series
from addin.contract.field import (
    Field,
    TableSpec,
    Trace,
    choice,
    integer,
    mixed,
    number,
    table,
    text,
)
from addin.contract.json_shapes import (
    BLANK,
    COUNT,
    FLAG,
    NUMBER,
    OR_WORD,
    TEXT,
    Shape,
    closed_object,
    cut_short,
    described,
    list_of,
)
from addin.contract.sheet import NEVER, ChartAt, Sheet
from addin.contract.study_spec import StudySpec
from engine.case.study_inputs import SCATTERED

_SAMPLE = "McKay, Beckman & Conover, Technometrics 21 (1979) 239; docs/tolerances.md"
_ORDER = "Conover, Practical Nonparametric Statistics, order statistics; docs/tolerances.md"
_RANKS = "Iman & Conover, Technometrics 21 (1979) 499; docs/tolerances.md"
_SHARE = "Clopper & Pearson, Biometrika 26 (1934) 404; docs/tolerances.md"
_SCATTER = (
    "Scatter.Quantity",
    "Scatter.Distribution",
    "Scatter.Spread",
    "Scatter.From",
    "Scatter.To",
)


_STARTS = "AllowableStarts.Allowable starts"
_FREQUENCY = "NaturalFrequencies.Frequency"
_MARGIN = "SeparationMargins.Margin"
_TORQUE, _STRESS = "StartupPeaks.Maximum torque", "StartupPeaks.Peak-to-peak stress"
_AS_TYPED = Trace("Name, as typed", "docs/tolerances.md")


def _percentiles(plain: str, dimension: str, head: str = "", us: str = "") -> tuple[Field, ...]:
    """P10, P50, P90 of one answer of the nominal run, each with the ends of its interval; words where starts may be unlimited."""
    columns = []
    for p in (10, 50, 90):
        value = Trace(f"Value that {p} % of the samples do not exceed", _SAMPLE, (plain,), _SCATTER)
        ends = Trace("Order statistic at the binomial quantile, 95 %", _ORDER, (plain,), _SCATTER)
        for end, words, trace in (
            ("", f"{p} % of the samples are at or below it.", value),
            (" low", f"Lower end of the 95 % interval of P{p}.", ends),
            (" high", f"Upper end of the 95 % interval of P{p}.", ends),
        ):
            name = f"{head}P{p}{end}"
            columns.append(
                number(name, dimension, words, us=us, trace=trace)
                if dimension
                else mixed(name, words, trace=trace)
            )
    return tuple(columns)


def _met(table: str, plain: str) -> tuple[Field, ...]:
    """Share of the samples that meet a demand, with the ends of its interval."""
    interval = Trace("Exact binomial interval, 95 %", _SHARE, (f"{table}.Probability",))
    return (
        number(
            "Probability", "fraction", "Share of the samples that meet the requirement.",
            "Samples that meet the requirement / all samples", _SAMPLE, of_row=(plain,),
            of_case=_SCATTER,
        ),
        number(
            "Probability low", "fraction", "Lower end of its 95 % interval (Clopper-Pearson).",
            trace=interval,
        ),
        number("Probability high", "fraction", "Upper end of its 95 % interval.", trace=interval),
    )  # fmt: skip


_INPUTS: tuple[TableSpec, ...] = (
    table(
        "Scatter", sheet="Tolerances", caption="Scatter",
        help="Uncertainty of the inputs, relative to their values in the case.",
        rows=16, row_name=("Name", "Quantity"),
        columns=(
            text("Name", "Element, station or material.", blank="all that have the quantity"),
            choice(
                "Quantity", SCATTERED,
                "Quantity that scatters; the damping ratio applies to all modes.",
            ),
            choice(
                "Distribution", ("normal", "uniform", "triangular", "from-to"),
                "normal: Spread is the standard deviation; uniform and triangular: the half width; "
                "from-to: uniform between From and To.",
                blank="normal",
            ),
            number(
                "Spread", "fraction",
                "Standard deviation or half width, relative to the value in the case.",
            ),
            number("From", "fraction", "Least value, relative to the value in the case."),
            number("To", "fraction", "Largest value, relative to the value in the case."),
            choice(
                "Together", ("each", "together"),
                "For a blank name: each varies independently, or all by one common factor.",
                blank="each",
            ),
        ),
    ),
)  # fmt: skip

_RESULTS: tuple[TableSpec, ...] = (
    table(
        "StartsOfSample", sheet="Tolerance results", caption="Allowable starts",
        help="Allowable starts: percentiles with 95 % intervals, and the probability of reaching "
        "StartsRequired.",
        row_name=("Element",), changes_shown=("P10", "P50", "P90", "Probability"), room=8,
        columns=(
            text(
                "Element", "Judged shaft; train = the worst of all.", kind="element",
                trace=_AS_TYPED,
            ),
            mixed(
                "Nominal", "Allowable starts of the nominal run.", "Of the nominal run", _SAMPLE,
                of_row=(_STARTS,),
            ),
            *_percentiles(_STARTS, ""),
            number(
                "Unlimited", "fraction", "Share of the samples without any damage.",
                "Samples without damage / all samples", _SAMPLE, of_row=(_STARTS,), of_case=_SCATTER,
            ),
            number(
                "Required", "count", "StartsRequired.", "As typed", _SAMPLE,
                of_case=("StartsRequired",), format=shown.ONE_DECIMAL,
            ),
            *_met("StartsOfSample", _STARTS),
            integer(
                "Samples", "Samples whose start was completed.", "Counted", _SAMPLE,
                of_case=_SCATTER,
            ),
        ),
    ),
    table(
        "ToleranceDrivers", sheet="Tolerance results", caption="Main drivers",
        help="Main drivers of the result named above: runs with one factor changed at a time, and "
        "rank regression.",
        row_name=("Factor",), changes_shown=("Share",),
        json_only=(text("dimension", "Dimension of the results, which are in the SI unit of that dimension."),),
        columns=(
            text("Factor", "Uncertain quantity.", trace=_AS_TYPED),
            number(
                "Deviation", "fraction",
                "Standard deviation of the factor, relative to the value in the case.",
                "Of the distribution", _SAMPLE, of_row=("Scatter.Spread",),
            ),
            mixed(
                "At P10", "Result of a run with this factor at its P10, all others nominal.",
                "Run with this factor at its P10", _SAMPLE, of_row=(_STARTS,), of_case=_SCATTER,
            ),
            mixed(
                "At P90", "Result of a run with this factor at its P90, all others nominal.",
                "Run with this factor at its P90", _SAMPLE, of_row=(_STARTS,), of_case=_SCATTER,
            ),
            number(
                "Change at P10", "fraction", "Change of that result from the nominal run.",
                "Value / nominal run − 1", _SAMPLE, of_row=("ToleranceDrivers.At P10",),
                format=shown.CHANGE,
            ),
            number(
                "Change at P90", "fraction", "Change of that result from the nominal run.",
                "Value / nominal run − 1", _SAMPLE, of_row=("ToleranceDrivers.At P90",),
                format=shown.CHANGE,
            ),
            number(
                "Rank coefficient", "ratio", "Standardized coefficient of the rank regression.",
                "Standardized coefficient of the regression of ranks", _RANKS, of_row=(_STARTS,),
                of_case=_SCATTER,
            ),
            number(
                "Partial correlation", "ratio", "Partial rank correlation.",
                "Rank correlation with the influence of all other factors removed", _RANKS,
                of_row=(_STARTS,), of_case=_SCATTER,
            ),
            number(
                "Share", "fraction", "Share of the rank variance; all shares add up to R².",
                "Standardized rank coefficient × rank correlation (Pratt)", _RANKS, of_row=(_STARTS,),
                of_case=_SCATTER, format=shown.ONE_DECIMAL,
            ),
        ),
    ),
    table(
        "ToleranceFrequencies", sheet="Tolerance results", caption="Natural frequencies",
        help="Natural frequencies.",
        row_name=("Mode",), room=12,
        columns=(
            integer("Mode", "Elastic mode.", trace=_AS_TYPED),
            number(
                "Nominal", "frequency", "Of the nominal run.", "Of the nominal run", _SAMPLE,
                of_row=(_FREQUENCY,),
            ),
            *_percentiles(_FREQUENCY, "frequency"),
            integer("Samples", "Samples.", "Counted", _SAMPLE, of_case=_SCATTER),
        ),
    ),
    table(
        "ToleranceMargins", sheet="Tolerance results", caption="Margins",
        help="Separation margins, and the probability that each is kept.",
        row_name=("Mode", "Excitation"), changes_shown=("Probability",),
        columns=(
            integer("Mode", "Elastic mode.", trace=_AS_TYPED),
            text("Excitation", "Name of the excitation.", trace=_AS_TYPED),
            number(
                "Nominal", "fraction", "Margin of the nominal run.", "Of the nominal run", _SAMPLE,
                of_row=(_MARGIN,),
            ),
            *_percentiles(_MARGIN, "fraction"),
            number(
                "Required", "fraction", "Required margin.", "As in the nominal run", _SAMPLE,
                of_row=("SeparationMargins.Required",), format=shown.ONE_DECIMAL,
            ),
            *_met("ToleranceMargins", _MARGIN),
        ),
    ),
    table(
        "TolerancePeaks", sheet="Tolerance results", caption="Peaks",
        help="Largest torques and nominal stresses of the start, zero-to-peak.",
        row_name=("Element",),
        columns=(
            text("Element", "Element.", kind="element", trace=_AS_TYPED),
            number(
                "Nominal torque", "torque", "Of the nominal run.",
                "Larger magnitude of maximum and minimum", _SAMPLE, us="lbf*ft", of_row=(_TORQUE,),
            ),
            *_percentiles(_TORQUE, "torque", "Torque ", us="lbf*ft"),
            number(
                "Nominal stress", "pressure", "Of the nominal run, without SCF.",
                "16 T D / (π (D⁴ − d⁴)) of Nominal torque", _SAMPLE, of_row=(_TORQUE,),
            ),
            *_percentiles(_STRESS, "pressure", "Stress "),
        ),
    ),
    table(
        "ToleranceDistribution", sheet="Tolerance results", caption="Distribution",
        help="Starts and first frequency by probability.",
        short_caption=True,
        columns=(
            number(
                "Probability", "fraction", "Share of the samples at or below the values of this row.", "1 %, 2 %, …",
                _SAMPLE, of_case=_SCATTER,
            ),
            number(
                "Starts", "count", "Allowable starts of the train; blank = unlimited.",
                "Percentile", _SAMPLE, of_row=(_STARTS,), of_case=_SCATTER,
            ),
            number(
                "First frequency", "frequency", "First elastic frequency.", "Percentile", _SAMPLE,
                of_row=(_FREQUENCY,), of_case=_SCATTER,
            ),
        ),
    ),
    table(
        "ToleranceHistogram", sheet="Tolerance results", caption="Histogram",
        help="Allowable starts of the samples.",
        short_caption=True,
        columns=(
            text(
                "Starts", "Range of allowable starts of the bar.",
                "Bars of equal width in the logarithm", _SAMPLE, of_row=(_STARTS,),
            ),
            number(
                "Share", "fraction", "Share of the samples.", "Samples in the bar / all samples",
                _SAMPLE, of_row=(_STARTS,), of_case=_SCATTER, format=shown.ONE_DECIMAL,
            ),
        ),
    ),
    table(
        "ToleranceTornado", sheet="Tolerance results", caption="Tornado",
        help="The strongest factors.",
        short_caption=True,
        columns=(
            text("Factor", "Uncertain quantity.", trace=_AS_TYPED),
            number(
                "At P10", "fraction", "Change of the result with this factor at its P10.",
                "As in ToleranceDrivers", _SAMPLE, of_row=("ToleranceDrivers.Change at P10",),
                format=shown.CHANGE,
            ),
            number(
                "At P90", "fraction", "Change of the result with this factor at its P90.",
                "As in ToleranceDrivers", _SAMPLE, of_row=("ToleranceDrivers.Change at P90",),
                format=shown.CHANGE,
            ),
        ),
    ),
)  # fmt: skip

_OF_STARTS, _OF_FREQUENCIES = _RESULTS[0], _RESULTS[2]
#: Row of the first thing below table `StartsOfSample`.
_BELOW_STARTS = 9 + _OF_STARTS.room + 2
#: Row of the captions below table `ToleranceFrequencies`.
_BELOW_FREQUENCIES = 10 + _OF_FREQUENCIES.room + 2

_SHEETS: tuple[Sheet, ...] = (
    Sheet(
        "Tolerances",
        "input",
        {"A": 1.5, "B": 24, "C": 17, "D": 13, "E:G": 10, "H": 11, "I": 30},
        {"Scatter": "B5"},
        freeze="A8",
        intro="Uncertainty of the inputs, for torsionbook tolerances FILE and torsionbook "
        "calibrate FILE. Spreads are relative to the values in the case.",
    ),
    Sheet(
        "Tolerance results",
        "result",
        {"A": 1.5, "B": 27, "C": 8, "D:G": 8.4, "H:I": 10, "J:L": 8.4, "M:N": 10, "O:Q": 10, "R": 8.5},
        {"StartsOfSample": "B7", "ToleranceDrivers": f"B{_BELOW_STARTS + 22}"},
        (
            ChartAt("tornado", f"B{_BELOW_STARTS}", 650, 390),
            ChartAt("starts_histogram", f"J{_BELOW_STARTS}", 570, 176),
            ChartAt("starts_distribution", f"J{_BELOW_STARTS + 10}", 570, 206),
        ),
        row_breaks=(_BELOW_STARTS + 22,),
        intro="Scatter of the allowable starts that follows from the input scatter on sheet "
        "Tolerances, and its main drivers. Written by torsionbook tolerances FILE.",
    ),
    Sheet(
        "Tolerance tables",
        "result",
        {"A": 1.5, "B": 7, "C": 22, "D:Q": 10},
        {"ToleranceFrequencies": "B7", "ToleranceMargins": f"B{_BELOW_FREQUENCIES}"},
        on="Tolerance results",
        intro="Frequencies and margins: P10, P50 and P90 of the samples and the probability that "
        "each margin is kept, with 95 % intervals.",
    ),
    Sheet(
        "Tolerance peaks",
        "result",
        {"A": 1.5, "B": 18, "C:V": 7.8},
        {"TolerancePeaks": "B7"},
        on="Tolerance results",
        intro="Largest torques and nominal stresses of the start, zero-to-peak, with their "
        "percentiles.",
    ),
    Sheet(
        "Tolerance data",
        "result",
        {"A": 1.5, "B:D": 13, "E": 2, "F": 20, "G": 9, "H": 2, "I": 36, "J:K": 11},
        {"ToleranceDistribution": "B7", "ToleranceHistogram": "F7", "ToleranceTornado": "I7"},
        on="Tolerance results",
        intro="Data of the charts; not printed.",
        printed_for=NEVER,
    ),
)  # fmt: skip

_CHARTS: tuple[ChartSpec, ...] = (
    # the strongest factors, each at its P10 and P90: what they make of the answer
    ChartSpec(
        "tornado", "bars", "Main drivers: one factor at a time, at its P10 and P90",
        Axis("Change of the result, %", number="+0;-0;0"),
        Axis(reverse=True, crossing="max", low=True, grid=False, ticks=False),
        tuple(
            Series("ToleranceTornado", "Factor", column, f"factor {point}", colour, edge="none")
            for column, point, colour in (("At P10", "at P10", "rust"), ("At P90", "at P90", "navy"))
        ),
        legend=True, gap=45, overlap=100,
    ),
    ChartSpec(
        "starts_histogram", "columns", "Allowable starts of the samples",
        Axis(grid=False, names=(7, -45)), Axis("Share of samples, %", least=0, number="0"),
        (Series("ToleranceHistogram", "Starts", "Share", "share of the samples", "steel", edge="white"),),
        gap=8,
    ),
    ChartSpec(
        "starts_distribution", "curves", "Probability that the train allows fewer starts",
        Axis("Allowable starts", log=True, number="#,##0"),
        Axis("Probability of fewer starts, %", least=0, largest=100, number="0"),
        (Series("ToleranceDistribution", "Starts", "Probability", "samples", "navy", 1.75),),
    ),
)  # fmt: skip


def _details() -> Shape:
    """What its JSON has beside its tables."""
    end = described("Null where more samples would be needed.", OR_WORD)
    nominal = described("Of the nominal run; null where not judged.", OR_WORD)
    percentile = {
        "probability": NUMBER,
        "value": {"description": "A number, or unlimited.", "type": ["number", "string"]},
        "low": end,
        "high": end,
    }
    answer = {
        "quantity": TEXT,
        "of": TEXT,
        "nominal": nominal,
        "unlimited": described("Share of the samples without any damage.", NUMBER),
        "samples": COUNT,
        "percentiles": list_of(closed_object(percentile)),
    }
    share = {
        "check": TEXT,
        "of": TEXT,
        "required": OR_WORD,
        "nominal": nominal,
        "probability": described("Share of the samples that meet the requirement.", NUMBER),
        "low": NUMBER,
        "high": NUMBER,
        "samples": COUNT,
    }
    content = {
        "samples": described("Number of samples requested.", COUNT),
        "seed": COUNT,
        "method": {"enum": ["lhs", "sobol"]},
        "replan": FLAG,
        "samples_planned": COUNT,
        "samples_calculated": COUNT,
        "converged": FLAG,
        "driven": described("Result whose drivers are shown.", TEXT),
        "explained": described("R² of the rank regression; null = not determined.", BLANK),
        "sentences": list_of(TEXT),
        "percentiles": list_of(closed_object(answer)),
        "probabilities": list_of(closed_object(share)),
    }
    return cut_short("Samples.") | {"tolerances": closed_object(content)}


TOLERANCES = StudySpec(
    key="tolerances",
    order=2,
    command="tolerances",
    sheet="Tolerance results",
    inputs=_INPUTS,
    results=_RESULTS,
    sheets=_SHEETS,
    details=_details(),
    charts=_CHARTS,
    height=56.0,
)
