"""Where each result of a study comes from; see `addin.traces`."""

from __future__ import annotations

from collections.abc import Mapping

from addin.traces import Trace
from addin.tuning_fields import TUNING_TRACES

__all__ = ["STUDY_TRACES"]

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
STUDY_TRACES: Mapping[tuple[str, str], Trace] = {
    **TUNING_TRACES,
    **_tolerance_traces(),
    **_sensitivity_traces(),
}
