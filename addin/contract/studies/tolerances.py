"""Result tables of tolerances and sensitivities, and their traces; part of `addin.contract.studies.fields`."""

from __future__ import annotations

from collections.abc import Mapping

from addin.contract.charts import Axis, ChartSpec, Series
from addin.contract.field import Field, TableSpec, integer, mixed, number, table, text
from addin.contract.result_tables import Trace

__all__ = ["TOLERANCE_RESULT_TABLES", "TOLERANCE_TRACES"]


def _percentiles(dimension: str, head: str = "", us: str = "") -> tuple[Field, ...]:
    """P10, P50, P90, each with the ends of its interval; words where starts may be unlimited."""
    fields = []
    for p in (10, 50, 90):
        for end, words in (
            ("", f"{p} % of the samples are at or below it."),
            (" low", f"Lower end of the 95 % interval of P{p}."),
            (" high", f"Upper end of the 95 % interval of P{p}."),
        ):
            name = f"{head}P{p}{end}"
            fields.append(
                mixed(name, words) if not dimension else number(name, dimension, words, us=us)
            )
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
        *_percentiles("fraction"),
        number("Required", "fraction", "Required margin."),
        *_MET,
    ),
    table(
        "TolerancePeaks",
        "Tolerance peaks",
        1,
        "Largest torques and nominal stresses of the start, zero-to-peak.",
        text("Element", "Element.", kind="element"),
        number("Nominal torque", "torque", "Of the plain run.", us="lbf*ft"),
        *_percentiles("torque", "Torque ", us="lbf*ft"),
        number("Nominal stress", "pressure", "Of the plain run, without SCF."),
        *_percentiles("pressure", "Stress "),
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

TOLERANCE_RESULT_TABLES: tuple[TableSpec, ...] = (*_TOLERANCE_RESULTS, *_SENSITIVITY_RESULTS)

_SAMPLE = "McKay, Beckman & Conover, Technometrics 21 (1979) 239; docs/tolerances.md"
_ORDER = "Conover, Practical Nonparametric Statistics, order statistics; docs/tolerances.md"
_RANKS = "Iman & Conover, Technometrics 21 (1979) 499; docs/tolerances.md"
_SHARE = "Clopper & Pearson, Biometrika 26 (1934) 404; docs/tolerances.md"
_ENERGY = "Rayleigh, Theory of Sound I, § 88; docs/tolerances.md"
_TANGENT = "docs/tolerances.md"
_SCATTER = (
    "Scatter.Quantity",
    "Scatter.Distribution",
    "Scatter.Spread",
    "Scatter.From",
    "Scatter.To",
)


def _percentile_traces(
    table: str, plain: str, heads: tuple[str, ...] = ("",)
) -> dict[tuple[str, str], Trace]:
    """Percentiles and their intervals, of one answer of the plain run."""
    found = {}
    for head in heads:
        for p in (10, 50, 90):
            name = f"{head}P{p}"
            found[table, name] = Trace(
                f"Value that {p} % of the samples do not exceed", _SAMPLE, (plain,), _SCATTER
            )
            for end in ("low", "high"):
                found[table, f"{name} {end}"] = Trace(
                    "Order statistic at the binomial quantile, 95 %", _ORDER, (plain,), _SCATTER
                )
    return found


def _met_traces(table: str, plain: str) -> dict[tuple[str, str], Trace]:
    return {
        (table, "Probability"): Trace(
            "Samples that meet it over all samples", _SAMPLE, (plain,), _SCATTER
        ),
        **{
            (table, f"Probability {end}"): Trace(
                "Exact binomial interval, 95 %", _SHARE, (f"{table}.Probability",)
            )
            for end in ("low", "high")
        },
    }


def _tolerance_traces() -> dict[tuple[str, str], Trace]:
    starts, drivers = "AllowableStarts.Allowable starts", "ToleranceDrivers"
    frequency, margin = "NaturalFrequencies.Frequency", "SeparationMargins.Margin"
    torque, stress = "StartupPeaks.Maximum torque", "StartupPeaks.Peak-to-peak stress"
    name = Trace("Name, as typed", "docs/tolerances.md")
    found = {
        ("ToleranceStarts", "Element"): name,
        ("ToleranceStarts", "Nominal"): Trace("Of the plain run", _SAMPLE, (starts,)),
        ("ToleranceStarts", "Unlimited"): Trace(
            "Samples without damage over all", _SAMPLE, (starts,), _SCATTER
        ),
        ("ToleranceStarts", "Required"): Trace("As typed", _SAMPLE, (), ("StartsRequired",)),
        ("ToleranceStarts", "Samples"): Trace("Counted", _SAMPLE, (), _SCATTER),
        (drivers, "Factor"): name,
        (drivers, "Deviation"): Trace("Of the distribution", _SAMPLE, ("Scatter.Spread",)),
        (drivers, "Rank coefficient"): Trace(
            "Standardized coefficient of the regression of ranks", _RANKS, (starts,), _SCATTER
        ),
        (drivers, "Partial correlation"): Trace(
            "Correlation of ranks, the part of all other factors taken out",
            _RANKS,
            (starts,),
            _SCATTER,
        ),
        (drivers, "Share"): Trace(
            "Rank coefficient × correlation of ranks (Pratt)", _RANKS, (starts,), _SCATTER
        ),
        ("ToleranceFrequencies", "Mode"): name,
        ("ToleranceFrequencies", "Nominal"): Trace("Of the plain run", _SAMPLE, (frequency,)),
        ("ToleranceFrequencies", "Samples"): Trace("Counted", _SAMPLE, (), _SCATTER),
        ("ToleranceMargins", "Mode"): name,
        ("ToleranceMargins", "Excitation"): name,
        ("ToleranceMargins", "Nominal"): Trace("Of the plain run", _SAMPLE, (margin,)),
        ("ToleranceMargins", "Required"): Trace(
            "As of the plain run", _SAMPLE, ("SeparationMargins.Required",)
        ),
        ("TolerancePeaks", "Element"): name,
        ("TolerancePeaks", "Nominal torque"): Trace(
            "Larger magnitude of maximum and minimum", _SAMPLE, (torque,)
        ),
        ("TolerancePeaks", "Nominal stress"): Trace(
            "16 T D / (π (D⁴ − d⁴)) of that torque", _SAMPLE, (torque,)
        ),
        ("ToleranceDistribution", "Probability"): Trace("1 %, 2 %, …", _SAMPLE, (), _SCATTER),
        ("ToleranceDistribution", "Starts"): Trace("Percentile", _SAMPLE, (starts,), _SCATTER),
        ("ToleranceDistribution", "First frequency"): Trace(
            "Percentile", _SAMPLE, (frequency,), _SCATTER
        ),
        ("ToleranceHistogram", "Starts"): Trace(
            "Bars of equal width in the logarithm", _SAMPLE, (starts,)
        ),
        ("ToleranceHistogram", "Share"): Trace(
            "Samples in the bar over all", _SAMPLE, (starts,), _SCATTER
        ),
        ("ToleranceTornado", "Factor"): name,
    }
    for p in ("P10", "P90"):
        found[drivers, f"At {p}"] = Trace(
            f"Run with this factor at its {p}", _SAMPLE, (starts,), _SCATTER
        )
        found[drivers, f"Change at {p}"] = Trace(
            "Over the plain run, less 1", _SAMPLE, (f"{drivers}.At {p}",)
        )
        found["ToleranceTornado", f"At {p}"] = Trace(
            "As in ToleranceDrivers", _SAMPLE, (f"{drivers}.Change at {p}",)
        )
    found |= _percentile_traces("ToleranceStarts", starts)
    found |= _percentile_traces("ToleranceFrequencies", frequency)
    found |= _percentile_traces("ToleranceMargins", margin)
    found |= _percentile_traces("TolerancePeaks", torque, ("Torque ",))
    found |= _percentile_traces("TolerancePeaks", stress, ("Stress ",))
    found |= _met_traces("ToleranceStarts", starts) | _met_traces("ToleranceMargins", margin)
    return found


def _sensitivity_traces() -> dict[tuple[str, str], Trace]:
    table, name = "Sensitivities", Trace("Name, as typed", "docs/tolerances.md")
    found = {(table, column): name for column in ("Quantity", "Of", "Method", "Note")}
    found |= {("FrequencySensitivities", column): name for column in ("Quantity", "Of")}
    for answer, plain in (
        ("Peak", "StartupPeaks.Maximum torque"),
        ("Starts", "AllowableStarts.Allowable starts"),
    ):
        found[table, f"{answer} change"] = Trace(
            "1 % × ∂ln/∂ln, from differences at ± 0.02 % and ± 0.01 % (Richardson)",
            _TANGENT,
            (plain,),
        )
        found[table, f"{answer} error"] = Trace(
            "Difference of the two differences", _TANGENT, (f"{table}.{answer} change",)
        )
        for end, change in (("below", "− 1 %"), ("above", "+ 1 %")):
            found[table, f"{answer} {end}"] = Trace(
                f"Run at {change} over the plain run, less 1", _TANGENT, (plain,)
            )
    found["FrequencySensitivities", "Mode"] = Trace(
        "∂ln f/∂ln k = ½ strain-energy share; ∂ln f/∂ln J = −½ kinetic-energy share",
        _ENERGY,
        (),
        ("NaturalFrequencies.Frequency", "ModeShapes.Mode"),
    )
    for mode in (1, 2, 3):
        found["FrequencySensitivities", f"Shift {mode}"] = Trace(
            "∂ln f/∂ln × change × frequency",
            _ENERGY,
            ("FrequencySensitivities.Mode",),
            ("NaturalFrequencies.Frequency",),
        )
    return found


#: (result table, column) → its trace.
TOLERANCE_TRACES: Mapping[tuple[str, str], Trace] = {
    **_tolerance_traces(),
    **_sensitivity_traces(),
}


CHARTS = (
    # the strongest factors, each at its P10 and P90: what they make of the answer
    ChartSpec(
        "tornado", "bars", "What drives it: one factor at a time, at its P10 and P90",
        Axis("Change of the answer, %", number="+0;-0;0"),
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
        Axis("Probability of fewer, %", least=0, largest=100, number="0"),
        (Series("ToleranceDistribution", "Starts", "Probability", "samples", "navy", 1.75),),
    ),
)  # fmt: skip
