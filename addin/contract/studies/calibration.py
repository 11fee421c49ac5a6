"""Result tables of the calibration, and where each column comes from; part of `addin.contract.studies.fields`."""

from __future__ import annotations

from collections.abc import Mapping

from addin.contract.charts import Axis, ChartSpec, Series
from addin.contract.field import Field, TableSpec, integer, number, table, text
from addin.contract.result_tables import Trace

__all__ = ["CALIBRATION_RESULT_TABLES", "CALIBRATION_TRACES"]

_SHEET = "Calibration"


def _fit(name: str, what: Field, dimension: str, help: str, **shown: str) -> TableSpec:
    """Measured beside calculated, of one kind of measurement."""
    return table(
        name,
        _SHEET,
        1,
        help,
        what,
        integer("Row", "Row of the input table."),
        number("Measured", dimension, "As typed.", **shown),
        number("Uncertainty", "fraction", "Standard deviation over it."),
        number("Before", dimension, "Calculated before calibration.", **shown),
        number("After", dimension, "Calculated after calibration.", **shown),
        number("Residual before", "ratio", "Before less measured, in standard deviations."),
        number("Residual", "ratio", "After less measured, in standard deviations."),
        number("Left-out residual", "ratio", "The residual if all others, and not it, were used."),
        text("Used", "Whether it entered the calibration.", kind="flag"),
        text("Explained", "Whether a change within the spread explains it.", kind="flag"),
        text("Note", "What to do about it."),
    )


CALIBRATION_RESULT_TABLES: tuple[TableSpec, ...] = (
    _fit(
        "FrequencyFit",
        text("Mode", "Elastic mode of the case that it was taken for; blank = none."),
        "frequency",
        "Measured frequencies beside calculated ones.",
    ),
    _fit(
        "PeakFit",
        text("Element", "Where it was measured.", kind="element"),
        "torque",
        "Measured peak torques beside calculated ones.",
        us="lbf*ft",
    ),
    table(
        "CalibratedFrequencies",
        _SHEET,
        1,
        "Modes before and after, with what is still unknown of them.",
        integer("Mode", "Elastic mode of the case, counted from 1."),
        integer("Calibrated mode", "Its number after calibration."),
        number("Before", "frequency", "Calculated from the case."),
        number("Prior deviation", "fraction", "Standard deviation from the uncertain quantities."),
        number("After", "frequency", "Calculated from the calibrated case."),
        number("Posterior deviation", "fraction", "Standard deviation that is left."),
        number("Change", "fraction", "After over before, less 1."),
        number("Measured", "frequency", "What it was measured as; blank = it was not."),
        number("Uncertainty", "fraction", "Of that measurement."),
        number("MAC", "ratio", "How far its shape is that of before: 1 the same, 0 another."),
        text("Known", "Whether a margin may take it as measured.", kind="flag"),
        text("Why", "Why it may or may not."),
    ),
    table(
        "CalibratedMargins",
        _SHEET,
        1,
        "Least separation margin of each mode before and after, on the basis that is justified.",
        integer("Mode", "Elastic mode of the case."),
        text("Excitation", "The nearest excitation, after calibration."),
        number("Frequency before", "frequency", "Natural frequency of the case."),
        number("Margin before", "fraction", "Its least margin."),
        number("Required before", "fraction", "Required margin of the case."),
        text("Verdict before", "pass, accepted by forced response or fail."),
        number("Frequency", "frequency", "Natural frequency of the calibrated case."),
        number("Margin", "fraction", "Its least margin."),
        number("Required", "fraction", "Required margin on the basis that is justified."),
        text("Verdict", "pass, accepted by forced response or fail."),
        json_only=("excitation_before",),
    ),
    table(
        "CalibratedParameters",
        _SHEET,
        1,
        "The least change of what is uncertain that explains the measurements.",
        text("Name", "Element or station."),
        text("Quantity", "What of it."),
        number("Stiffness", "torsional stiffness", "As in the case."),
        number("Calibrated stiffness", "torsional stiffness", "As it explains the measurements."),
        number("Inertia", "inertia", "As in the case."),
        number("Calibrated inertia", "inertia", "As it explains the measurements."),
        number("Change", "fraction", "Calibrated over case, less 1."),
        number("Change low", "fraction", "At the lower end of its 95 % interval."),
        number("Change high", "fraction", "At the upper end of its 95 % interval."),
        number("Prior deviation", "fraction", "Standard deviation by table Scatter."),
        number("Posterior deviation", "fraction", "Standard deviation that is left."),
        text("Note", "What a reader must know."),
        text("Determined", "determined (3/4 of the variance or more taken away), partly or not."),
        number("Reduction", "fraction", "Share of the variance that the measurements took away."),
        number("Pull", "ratio", "Change in prior standard deviations."),
        json_only=("before", "after"),
    ),
)

_METHOD = "docs/calibration.md"
_MAP = "Tarantola, Inverse Problem Theory (2005), chapter 3; docs/calibration.md"
_RAYLEIGH = (
    "Friswell & Mottershead, Finite Element Model Updating (1995), chapter 4; docs/calibration.md"
)
_PAPER = "Szenasi & von Nimitz 1978, Steady state torsional analysis"
_TRAIN = ("Stations.Inertia", "Stations.Speed ratio", "Elements.Stiffness")
_PRIOR = (
    "Scatter.Quantity",
    "Scatter.Distribution",
    "Scatter.Spread",
    "Scatter.From",
    "Scatter.To",
)
_F = (
    "MeasuredFrequencies.Mode",
    "MeasuredFrequencies.Frequency",
    "MeasuredFrequencies.Uncertainty",
)
_T = ("MeasuredPeaks.Element", "MeasuredPeaks.Maximum torque", "MeasuredPeaks.Uncertainty")
_START = ("MotorTorque.Average", "MotorTorque.Pulsating", "LoadTorque.Torque", "DampingRatio")
_ALL = (*_TRAIN, *_PRIOR, *_F, *_T)
_LEAST = "least of Σ z² + Σ ((calculated − measured)/σ)², z = (ln p − μ)/σ_p"


def _fit_traces(
    table: str, first: str, typed: tuple[str, ...], of_case: tuple[str, ...]
) -> dict[tuple[str, str], Trace]:
    name, value, uncertainty = typed
    after = Trace(f"Calculated with the {_LEAST}", _MAP, (value,), (*of_case, *_ALL))
    residual = "(calculated − measured)/(uncertainty × measured)"
    return {
        (table, first): Trace("As typed, or the likeliest one to one", _METHOD, (name, value)),
        (table, "Row"): Trace("Row of the input table", _METHOD, (value,)),
        (table, "Measured"): Trace("As typed", _METHOD, (value,)),
        (table, "Uncertainty"): Trace("As typed; blank = 1 % and 5 %", _METHOD, (uncertainty,)),
        (table, "Before"): Trace("Calculated from the case", "docs/method.md", (), of_case),
        (table, "After"): after,
        (table, "Residual before"): Trace(
            residual, _METHOD, (f"{table}.Before", f"{table}.Measured", f"{table}.Uncertainty")
        ),
        (table, "Residual"): Trace(
            residual, _METHOD, (f"{table}.After", f"{table}.Measured", f"{table}.Uncertainty")
        ),
        (table, "Left-out residual"): Trace(
            "r/√(1 − h), h of J C Jᵀ", _MAP, (f"{table}.Residual",), _ALL
        ),
        (table, "Used"): Trace(
            "Within 4 standard deviations of a mode that is left, one to one",
            _METHOD,
            (value,),
            _ALL,
        ),
        (table, "Explained"): Trace(
            "|left-out residual| ≤ 3", _METHOD, (f"{table}.Left-out residual",)
        ),
        (table, "Note"): Trace("The same in words", _METHOD, (value,), _ALL),
    }


def _of_modes() -> dict[tuple[str, str], Trace]:
    name = "CalibratedFrequencies"
    return {
        (name, "Mode"): Trace("Counted from 1, by rising frequency", _METHOD, (), _TRAIN),
        (name, "Calibrated mode"): Trace(
            "Followed by shape: MAC = (φᵀMψ)², one to one", _RAYLEIGH, (), _ALL
        ),
        (name, "Before"): Trace("Singular value of √k·B·1/√m over 2π", "docs/method.md", (), _TRAIN),
        (name, "Prior deviation"): Trace(
            "√Σ (½ energy share × σ_p)²", _RAYLEIGH, (), (*_TRAIN, *_PRIOR)
        ),
        (name, "After"): Trace(f"Calculated with the {_LEAST}", _MAP, (), _ALL),
        (name, "Posterior deviation"): Trace("√(g C gᵀ), C = (I + JᵀJ)⁻¹", _MAP, (), _ALL),
        (name, "Change"): Trace("After/before − 1", _METHOD, (f"{name}.Before", f"{name}.After")),
        (name, "Measured"): Trace("As typed", _METHOD, ("FrequencyFit.Measured",)),
        (name, "Uncertainty"): Trace("As typed", _METHOD, ("FrequencyFit.Uncertainty",)),
        (name, "MAC"): Trace("(φᵀMψ)² of before and after", _RAYLEIGH, (), _ALL),
        (name, "Known"): Trace(
            "Measured, or 3/4 of its variance taken away; and posterior deviation ≤ 2 %", _METHOD,
            (f"{name}.Posterior deviation", f"{name}.Prior deviation", f"{name}.Measured"),
        ),
        (name, "Why"): Trace("The same in words", _METHOD, (f"{name}.Known",)),
    }  # fmt: skip


def _of_margins() -> dict[tuple[str, str], Trace]:
    name = "CalibratedMargins"
    margin = "|f − f_exc|/f_exc, the least over all excitations and continuous speeds"
    required = "20 % calculated, 10 % measured, or MarginRequired"
    verdict = "pass if margin ≥ required; accepted if every judged stress is within UTS/25"
    speeds = ("MinimumSpeed", "MaximumSpeed", "Excitations.Order", "Excitations.Frequency")
    basis = ("MarginBasis", "MarginRequired")
    return {
        (name, "Mode"): Trace("Counted from 1", _METHOD, (), _TRAIN),
        (name, "Excitation"): Trace("The one with the least margin", _PAPER, (), speeds),
        (name, "Frequency before"): Trace("As in CalibratedFrequencies", _METHOD, (), _TRAIN),
        (name, "Margin before"): Trace(margin, _PAPER, (f"{name}.Frequency before",), speeds),
        (name, "Required before"): Trace(required, _PAPER, (), basis),
        (name, "Verdict before"): Trace(
            verdict, _PAPER, (f"{name}.Margin before", f"{name}.Required before")
        ),
        (name, "Frequency"): Trace("As in CalibratedFrequencies", _METHOD, (), _ALL),
        (name, "Margin"): Trace(margin, _PAPER, (f"{name}.Frequency",), speeds),
        (name, "Required"): Trace(
            f"{required}; measured where every mode below 20 % is known", _PAPER,
            ("CalibratedFrequencies.Known",), basis,
        ),
        (name, "Verdict"): Trace(verdict, _PAPER, (f"{name}.Margin", f"{name}.Required")),
    }  # fmt: skip


def _of_parameters() -> dict[tuple[str, str], Trace]:
    name = "CalibratedParameters"
    changed = Trace(f"Case × e^(μ + σ z), {_LEAST}", _MAP, (), _ALL)
    ends = "Change at ± 1.96 posterior deviations of ln p"
    return {
        (name, "Name"): Trace("As typed; a blank name is every one that has it", _METHOD, ("Scatter.Name",)),
        (name, "Quantity"): Trace("As typed", _METHOD, ("Scatter.Quantity",)),
        (name, "Stiffness"): Trace("As in the case", _METHOD, ("Elements.Stiffness",)),
        (name, "Calibrated stiffness"): changed,
        (name, "Inertia"): Trace("As in the case", _METHOD, ("Stations.Inertia",)),
        (name, "Calibrated inertia"): changed,
        (name, "Change"): changed,
        (name, "Change low"): Trace(ends, _MAP, (f"{name}.Change", f"{name}.Posterior deviation")),
        (name, "Change high"): Trace(ends, _MAP, (f"{name}.Change", f"{name}.Posterior deviation")),
        (name, "Prior deviation"): Trace(
            "Spread (normal), /√3 (uniform), /√6 (triangular); (to − from)/√12", _METHOD, _PRIOR
        ),
        (name, "Posterior deviation"): Trace("σ √C_jj, C = (I + JᵀJ)⁻¹", _MAP, (), _ALL),
        (name, "Note"): Trace("The same in words", _METHOD, (f"{name}.Change",)),
        (name, "Determined"): Trace(
            "determined from 75 % reduction, partly from 10 %", _METHOD, (f"{name}.Reduction",)
        ),
        (name, "Reduction"): Trace(
            "1 − (posterior/prior deviation)²", _METHOD,
            (f"{name}.Prior deviation", f"{name}.Posterior deviation"),
        ),
        (name, "Pull"): Trace("z = (ln p − μ)/σ", _MAP, (f"{name}.Change", f"{name}.Prior deviation")),
    }  # fmt: skip


CALIBRATION_TRACES: Mapping[tuple[str, str], Trace] = {
    **_fit_traces("FrequencyFit", "Mode", _F, _TRAIN),
    **_fit_traces("PeakFit", "Element", _T, (*_TRAIN, *_START)),
    **_of_modes(),
    **_of_margins(),
    **_of_parameters(),
}


CHARTS = (
    # how far calculated frequencies are from measured ones, before and after
    ChartSpec(
        "fit", "columns", "Calculated less measured frequency, in standard deviations",
        Axis(low=True, grid=False), Axis("Standard deviations of the measurement", number="0.0"),
        tuple(
            Series("FrequencyFit", "Mode", column, name, colour)
            for column, name, colour in (
                ("Residual before", "before", "silver"),
                ("Residual", "after calibration", "navy"),
            )
        ),
        legend=True, gap=80,
    ),
    # change of each uncertain quantity with its 95 % interval
    ChartSpec(
        "change", "lines", "Change of what is uncertain, and what is still unknown of it",
        Axis(low=True, grid=False, names=(8, -45)), Axis("Change [%]", number="0"),
        tuple(
            Series("CalibratedParameters", "Name", column, name, colour, marker=marker, size=size)
            for column, name, colour, marker, size in (
                ("Change high", "95 % interval, upper end", "steel", "square", 4),
                ("Change", "least change", "rust", "diamond", 8),
                ("Change low", "95 % interval, lower end", "steel", "square", 4),
            )
        ),
        legend=True, high_low=True,
    ),
)  # fmt: skip
