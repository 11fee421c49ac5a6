"""Calibration against measurements in workbook and JSON."""

from __future__ import annotations

from dataclasses import replace

from addin.contract import number_formats as shown
from addin.contract.charts import Axis, ChartSpec, Series
from addin.contract.field import (
    Field,
    TableSpec,
    Trace,
    flag,
    integer,
    number,
    sentence,
    table,
    text,
    verdict,
)
from addin.contract.json_shapes import COUNT, FLAG, NUMBER, TEXT, Shape, described
from addin.contract.sheet import ChartAt, Sheet
from addin.contract.sources import STEADY
from addin.contract.study_spec import StudySpec

_METHOD = "docs/calibration.md"
_MAP = "Tarantola, Inverse Problem Theory (2005), chapter 3; docs/calibration.md"
_SAMPLES = (
    "Bardsley et al., SIAM J. Sci. Comput. 36 (2014) A1895 (randomize-then-optimize); "
    "docs/calibration.md"
)
_RAYLEIGH = (
    "Friswell & Mottershead, Finite Element Model Updating (1995), chapter 4; docs/calibration.md"
)
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
_LEAST = "least of Σ z² + Σ ((calculated − measured)/σ)², z = Φ⁻¹(F(p))"


def _fit(
    name: str,
    what: Field,
    dimension: str,
    *,
    typed: tuple[str, ...],
    of_case: tuple[str, ...],
    us: str = "",
    **more: object,
) -> TableSpec:
    """Measured beside calculated, of one kind of measurement."""
    first, value, uncertainty = typed
    residual = "(calculated − measured)/(uncertainty × measured)"
    columns = (
        replace(
            what,
            trace=Trace("As typed, else the most likely one-to-one assignment", _METHOD, (first, value))
        ),
        integer("Row", "Row of the input table.", "Row of the input table", _METHOD, of_row=(value,)),
        number("Measured", dimension, "As typed.", "As typed", _METHOD, us=us, of_row=(value,)),
        number(
            "Uncertainty", "fraction", "Standard deviation divided by the measured value.",
            "As typed; blank = 1 % of a frequency, 5 % of a peak torque", _METHOD, of_row=(uncertainty,),
        ),
        number(
            "Before", dimension, "Calculated before calibration.", "Calculated from the case",
            "docs/method.md", us=us, of_case=of_case,
        ),
        number(
            "After", dimension, "Calculated after calibration.", f"Calculated with the {_LEAST}",
            _MAP, us=us, of_row=(value,), of_case=(*of_case, *_ALL),
        ),
        number(
            "Residual before", "ratio",
            "Calculated before calibration minus measured, in standard deviations.", residual,
            _METHOD, of_row=(f"{name}.Before", f"{name}.Measured", f"{name}.Uncertainty"),
            format=shown.TWO_DECIMALS,
        ),
        number(
            "Residual", "ratio",
            "Calculated after calibration minus measured, in standard deviations.", residual, _METHOD,
            of_row=(f"{name}.After", f"{name}.Measured", f"{name}.Uncertainty"),
            format=shown.TWO_DECIMALS,
        ),
        number(
            "Left-out residual", "ratio",
            "Residual when this measurement is left out of the calibration.",
            "r/√(1 − h), h of J C Jᵀ", _MAP, of_row=(f"{name}.Residual",), of_case=_ALL,
            format=shown.TWO_DECIMALS,
        ),
        flag(
            "Used", "Whether the calibration used it.",
            "Within 4 standard deviations of a mode not yet assigned", _METHOD,
            of_row=(value,), of_case=_ALL,
        ),
        flag(
            "Explained",
            "Whether a change within the spread explains it; blank = cannot be judged (not more "
            "measurements than uncertain quantities).",
            "|left-out residual| ≤ 3", _METHOD, of_row=(f"{name}.Left-out residual",),
        ),
        sentence(
            "Note", "What to do about it.", "Recommended action", _METHOD, of_row=(value,),
            of_case=_ALL, width=22.0,
        ),
    )  # fmt: skip
    return table(name, sheet="Calibration", columns=columns, **more)  # type: ignore[arg-type]


_CHANGED = Trace(f"Case × p, p = F⁻¹(Φ(z)) of table Scatter, {_LEAST}", _MAP, (), _ALL)
_ENDS = "2.5 % and 97.5 % quantile of the posterior, over all solutions"
#: What is not given of measurements that no train explains.
_NONE = "; blank = measurements not explained"
_LEAST_MARGIN = "|f − f_exc|/f_exc, the least over all excitations and continuous speeds"
_REQUIRED = (
    "By Standard and MarginBasis (Szenasi: 20 % calculated, 10 % measured), or MarginRequired"
)
_VERDICT = "As in SeparationMargins"
_SPEEDS = ("MinimumSpeed", "MaximumSpeed", "Excitations.Order", "Excitations.Frequency")
_BASIS = ("Standard", "MarginBasis", "MarginRequired")

_INPUTS: tuple[TableSpec, ...] = (
    table(
        "MeasuredFrequencies", sheet="Measured", caption="Measured frequencies",
        help="Torsional natural frequencies found by measurement.",
        rows=10, row_name=("Mode",), short_caption=True,
        columns=(
            integer("Mode", "Elastic mode assigned to it; blank = best fit."),
            number("Frequency", "frequency", "As measured."),
            number("Uncertainty", "fraction", "Standard deviation.", blank="1 %"),
        ),
    ),
    table(
        "MeasuredPeaks", sheet="Measured", caption="Measured peaks (optional)",
        help="Largest torques found in a measured start (optional).",
        rows=6, row_name=("Element",),
        columns=(
            text("Element", "Element of table Elements.", kind="element"),
            number(
                "Maximum torque", "torque", "As measured, at the element's own speed.", us="lbf*ft",
            ),
            number("Uncertainty", "fraction", "Standard deviation.", blank="5 %"),
        ),
    ),
)  # fmt: skip

_RESULTS: tuple[TableSpec, ...] = (
    _fit(
        "FrequencyFit", text("Mode", "Elastic mode of the case assigned to it; blank = none."),
        "frequency", typed=_F, of_case=_TRAIN,
        caption="Measured frequencies", help="Measured frequencies beside calculated ones.",
        row_name=("Mode", "Row"), room=10,
    ),
    _fit(
        "PeakFit", text("Element", "Where it was measured.", kind="element"),
        "torque", typed=_T, of_case=(*_TRAIN, *_START), us="lbf*ft",
        caption="Measured peak torques", help="Measured peak torques beside calculated ones.",
        row_name=("Element", "Row"), room=5,
    ),
    table(
        "CalibratedFrequencies", sheet="Calibration", caption="Modes",
        help="Modes before and after calibration, with their remaining uncertainty.",
        row_name=("Mode",), changes_shown=("After",), room=12,
        columns=(
            integer(
                "Mode", "Elastic mode of the case, counted from 1.",
                "Counted from 1, by rising frequency", _METHOD, of_case=_TRAIN,
            ),
            integer(
                "Calibrated mode", "Its number after calibration.",
                "Paired by mode shape: MAC = (φᵀMψ)², one to one", _RAYLEIGH, of_case=_ALL,
            ),
            number(
                "Before", "frequency", "Calculated from the case.",
                "Singular value of √k·B/√J, divided by 2π", "docs/method.md", of_case=_TRAIN,
            ),
            number(
                "Prior deviation", "fraction", "Standard deviation from the uncertain quantities.",
                "√Σ (½ energy share × σ_p)²", _RAYLEIGH, of_case=(*_TRAIN, *_PRIOR),
            ),
            number(
                "After", "frequency", "Calculated from the calibrated case.",
                f"Calculated with the {_LEAST}", _MAP, of_case=_ALL,
            ),
            number(
                "Posterior deviation", "fraction", f"Standard deviation after calibration{_NONE}.",
                "Standard deviation of ln f over the posterior samples", _SAMPLES, of_case=_ALL,
            ),
            number(
                "Change", "fraction", "Frequency after / before − 1.", "After/before − 1", _METHOD,
                of_row=("CalibratedFrequencies.Before", "CalibratedFrequencies.After"),
                format=shown.TWO_DECIMALS,
            ),
            number(
                "Measured", "frequency", "Measured frequency of the mode; blank = not measured.",
                "As typed",
                _METHOD, of_row=("FrequencyFit.Measured",),
            ),
            number(
                "Uncertainty", "fraction",
                "Standard deviation of the measurement divided by its value.", "As typed", _METHOD,
                of_row=("FrequencyFit.Uncertainty",),
            ),
            number(
                "MAC", "ratio", "MAC of the mode shapes before and after: 1 = same, 0 = different.",
                "(φᵀMψ)² of before and after", _RAYLEIGH, of_case=_ALL,
            ),
            flag(
                "Known", "Whether the margin for measured frequencies applies to this mode.",
                "Measured, or variance reduced by 3/4; and posterior deviation ≤ 2 %; and probability "
                "of the misfit at least 1 %",
                _METHOD,
                of_row=(
                    "CalibratedFrequencies.Posterior deviation",
                    "CalibratedFrequencies.Prior deviation", "CalibratedFrequencies.Measured",
                ),
            ),
            sentence(
                "Why", "Reason.", "The reason in words", _METHOD,
                of_row=("CalibratedFrequencies.Known",), width=22.0,
            ),
        ),
    ),
    table(
        "CalibratedMargins", sheet="Calibration", caption="Least separation margins",
        help="Least separation margin of each mode before and after, with the margin basis that "
        "the measurements justify.",
        row_name=("Mode", "Excitation"), room=12,
        json_only=(text("excitation_before", "Nearest excitation before calibration."),),
        columns=(
            integer("Mode", "Elastic mode of the case.", "Counted from 1", _METHOD, of_case=_TRAIN),
            text(
                "Excitation", "The nearest excitation, after calibration.",
                "The one with the least margin", STEADY, of_case=_SPEEDS,
            ),
            number(
                "Frequency before", "frequency", "Natural frequency of the case.",
                "As in CalibratedFrequencies", _METHOD, of_case=_TRAIN,
            ),
            number(
                "Margin before", "fraction", "Least separation margin of the mode.", _LEAST_MARGIN,
                STEADY,
                of_row=("CalibratedMargins.Frequency before",), of_case=_SPEEDS, format=shown.TWO_DECIMALS,
            ),
            number(
                "Required before", "fraction", "Required margin of the case.", _REQUIRED, STEADY,
                of_case=_BASIS, format=shown.ONE_DECIMAL,
            ),
            verdict(
                "Verdict before", "pass, accepted by forced response, not judged or fail.", _VERDICT, STEADY,
                of_row=("CalibratedMargins.Margin before", "CalibratedMargins.Required before"),
            ),
            number(
                "Frequency", "frequency", "Natural frequency of the calibrated case.",
                "As in CalibratedFrequencies", _METHOD, of_case=_ALL,
            ),
            number(
                "Margin", "fraction", "Least separation margin of the mode.", _LEAST_MARGIN, STEADY,
                of_row=("CalibratedMargins.Frequency",), of_case=_SPEEDS, format=shown.TWO_DECIMALS,
            ),
            number(
                "Required", "fraction", "Required margin with the justified margin basis.",
                f"{_REQUIRED}; the one for measured frequencies applies where every mode with a "
                "margin below 20 % is known", STEADY,
                of_row=("CalibratedFrequencies.Known",), of_case=_BASIS, format=shown.ONE_DECIMAL,
            ),
            verdict(
                "Verdict", "pass, accepted by forced response, not judged or fail.", _VERDICT, STEADY,
                of_row=("CalibratedMargins.Margin", "CalibratedMargins.Required"),
            ),
        ),
    ),
    table(
        "CalibratedParameters", sheet="Calibration", caption="Uncertain quantities",
        help="Smallest change of the uncertain inputs that explains the measurements.",
        row_name=("Quantity", "Name"), changes_shown=("Change",),
        json_only=(
            number("before", "count", "Value in the case. [SI]"),
            number("after", "count", "Calibrated value. [SI]"),
        ),
        columns=(
            text(
                "Name", "Element or station.", "As typed; blank = all that have the quantity",
                _METHOD, of_row=("Scatter.Name",),
            ),
            text(
                "Quantity", "Quantity calibrated.", "As typed", _METHOD, of_row=("Scatter.Quantity",),
            ),
            number(
                "Stiffness", "torsional stiffness", "As in the case.", "As in the case", _METHOD,
                of_row=("Elements.Stiffness",),
            ),
            number(
                "Calibrated stiffness", "torsional stiffness", "Calibrated value.",
                trace=_CHANGED,
            ),
            number(
                "Inertia", "inertia", "As in the case.", "As in the case", _METHOD,
                of_row=("Stations.Inertia",),
            ),
            number(
                "Calibrated inertia", "inertia", "Calibrated value.", trace=_CHANGED,
            ),
            number(
                "Change", "fraction", "Calibrated / case − 1.", trace=_CHANGED,
                format=shown.TWO_DECIMALS,
            ),
            number(
                "Change low", "fraction", f"Change at the lower end of its 95 % interval{_NONE}.", _ENDS,
                _SAMPLES, of_case=_ALL,
                format=shown.TWO_DECIMALS,
            ),
            number(
                "Change high", "fraction", f"Change at the upper end of its 95 % interval{_NONE}.", _ENDS,
                _SAMPLES, of_case=_ALL,
                format=shown.TWO_DECIMALS,
            ),
            number(
                "Prior deviation", "fraction", "Standard deviation from table Scatter.",
                "Spread (normal), /√3 (uniform), /√6 (triangular); (to − from)/√12", _METHOD,
                of_row=_PRIOR,
            ),
            number(
                "Posterior deviation", "fraction", f"Standard deviation after calibration{_NONE}.",
                "Standard deviation of the posterior samples over p", _SAMPLES, of_case=_ALL,
            ),
            sentence(
                "Note", "Notes.", "Notes on the change, in words", _METHOD,
                of_row=("CalibratedParameters.Change",), width=22.0,
            ),
            text(
                "Determined", "determined (variance reduced by 3/4 or more), partly or not; never where the measurements "
                "are not explained.",
                "determined: variance reduced by 75 % or more, also if the spreads of the other "
                "quantities were ten times as large; partly: by 10 % or more; not determined if the "
                "probability of the misfit is below 1 %", _METHOD,
                of_row=("CalibratedParameters.Reduction",),
            ),
            number(
                "Reduction", "fraction", f"Share of the variance removed by the measurements{_NONE}.",
                "1 − (posterior/prior deviation)²", _METHOD,
                of_row=(
                    "CalibratedParameters.Prior deviation",
                    "CalibratedParameters.Posterior deviation",
                ),
                format=shown.ONE_DECIMAL,
            ),
            number(
                "Pull", "ratio", "Change, as a multiple of the prior standard deviation.",
                "z = Φ⁻¹(F(p)), F the distribution of table Scatter", _MAP,
                of_row=("CalibratedParameters.Change", "CalibratedParameters.Prior deviation"),
                format=shown.TWO_DECIMALS,
            ),
        ),
    ),
    table(
        "CalibrationSolutions", sheet="Calibration", caption="Solutions, where there are several",
        help="Every train that explains the measurements, such as mirror images, or comes as near where none "
        "does; blank = one only.",
        row_name=("Solution", "Quantity", "Name"),
        columns=(
            text(
                "Name", "Element or station.", "As in CalibratedParameters", _METHOD,
                of_row=("Scatter.Name",),
            ),
            text("Quantity", "Quantity calibrated.", "As typed", _METHOD, of_row=("Scatter.Quantity",)),
            integer(
                "Solution", "Counted from 1, the smallest misfit first.",
                "Search from the prior's middle and 48 draws of it", _METHOD, of_case=_ALL,
            ),
            number(
                "Misfit", "ratio", "Sum of squares of changes and residuals.", _LEAST, _MAP,
                of_case=_ALL, format=shown.TWO_DECIMALS,
            ),
            number(
                "Probability", "fraction", f"Probability of the trains around this solution{_NONE}.",
                "Weight of the posterior samples", _SAMPLES, of_case=_ALL, format=shown.ONE_DECIMAL,
            ),
            number(
                "Change", "fraction", "Calibrated / case − 1 in this solution.", trace=_CHANGED,
                format=shown.TWO_DECIMALS,
            ),
            number(
                "Change low", "fraction", f"Lower end of the 95 % interval around this solution{_NONE}.",
                "2.5 % quantile of the samples around it", _SAMPLES, of_case=_ALL,
                format=shown.TWO_DECIMALS,
            ),
            number(
                "Change high", "fraction", f"Upper end of the 95 % interval around this solution{_NONE}.",
                "97.5 % quantile of the samples around it", _SAMPLES, of_case=_ALL,
                format=shown.TWO_DECIMALS,
            ),
            sentence(
                "Note", "How it differs from the first.", "The difference in words", _METHOD,
                of_row=("CalibrationSolutions.Solution",), width=60.0,
            ),
        ),
    ),
)  # fmt: skip

_FREQUENCY_FIT, _PEAK_FIT, _MODES, _MARGINS, *_ = _RESULTS

_CHART_ROWS = 17
_PEAKS_AT = _FREQUENCY_FIT.below(7)
_FITS_AT = _PEAK_FIT.below(_PEAKS_AT)
_MODES_AT = _FITS_AT + _CHART_ROWS
_MARGINS_AT = _MODES.below(_MODES_AT)
_PARAMETERS_AT = _MARGINS.below(_MARGINS_AT)

_SHEETS: tuple[Sheet, ...] = (
    Sheet(
        "Measured",
        "input",
        {"A": 1.5, "B": 9, "C:D": 12, "E": 2, "F": 24, "G:H": 13, "I": 40},
        {"MeasuredFrequencies": "B5", "MeasuredPeaks": "F5"},
        freeze="A8",
        intro="What was measured on the train, for torsionbook calibrate FILE.",
    ),
    Sheet(
        "Calibration",
        "result",
        {"A": 1.5, "B": 18, "C": 13, "D:E": 12, "F:I": 9.8, "J:L": 10.4, "M": 22, "N": 12, "O": 9,
         "P": 6},
        {
            "FrequencyFit": "B7",
            "PeakFit": f"B{_PEAKS_AT}",
            "CalibratedFrequencies": f"B{_MODES_AT}",
            "CalibratedMargins": f"B{_MARGINS_AT}",
            "CalibratedParameters": f"B{_PARAMETERS_AT}",
        },
        (
            ChartAt("fit", f"B{_FITS_AT}", 460, 296),
            ChartAt("change", f"G{_FITS_AT}", 740, 296),
        ),
        row_breaks=(_FITS_AT - 1, _MARGINS_AT - 1),
        intro="Smallest change of the uncertain inputs (sheet Tolerances) that explains the "
        "measurements: torsionbook calibrate FILE.",
    ),
    Sheet(
        "Calibration solutions",
        "result",
        {"A": 1.5, "B": 22, "C:I": 11, "J": 60},
        {"CalibrationSolutions": "B7"},
        on="Calibration",
        intro="Every train that explains the measurements, or comes as near where none does, if there are "
        "several. Written by torsionbook "
        "calibrate FILE.",
    ),
)  # fmt: skip

_CHARTS: tuple[ChartSpec, ...] = (
    # how far calculated frequencies are from measured ones, before and after
    ChartSpec(
        "fit", "columns", "Calculated minus measured frequency, in standard deviations",
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
        "change", "lines", "Change of the uncertain inputs and their remaining uncertainty",
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


#: What its JSON has beside its tables.
_DETAILS: Shape = {
    "chi_square": described("Sum of squares at the minimum.", NUMBER),
    "degrees": described("Measurements used.", COUNT),
    "probability": described("Probability that chance alone gives a misfit this large.", NUMBER),
    "explained": described(
        "Everything measured is explained; null = nothing contradicts it, but there are not more "
        "measurements than uncertain quantities, so the misfit cannot be judged.",
        {"type": ["boolean", "null"]},
    ),
    "margin_basis": TEXT,
    "margin_basis_justified": FLAG,
    "margin_basis_reason": TEXT,
    "starts": described("Number of starts calculated for the peak torques.", COUNT),
}

CALIBRATION = StudySpec(
    key="calibration",
    order=5,
    command="calibrate",
    sheet="Calibration",
    inputs=_INPUTS,
    reads=("Scatter",),
    results=_RESULTS,
    sheets=_SHEETS,
    details=_DETAILS,
    charts=_CHARTS,
    height=84.0,
)
