"""Sensitivities to each quantity in workbook and JSON."""

from __future__ import annotations

from addin.contract import number_formats as shown
from addin.contract.field import Field, TableSpec, Trace, number, sentence, table, text
from addin.contract.json_shapes import BLANK, NUMBER, TEXT, Shape, closed_object, described, list_of
from addin.contract.live_formulas import sensitivity_shift
from addin.contract.sheet import Sheet
from addin.contract.study_spec import StudySpec

_ENERGY = "Rayleigh, Theory of Sound I, § 88; docs/tolerances.md"
_TANGENT = "docs/tolerances.md"
_AS_TYPED = Trace("Name, as typed", "docs/tolerances.md")


def _changes(head: str, answer: str, plain: str) -> tuple[Field, ...]:
    """What + 1 % does to one answer of the nominal run: by the derivative, and in runs at either end."""
    derivative = Trace(
        "1 % × ∂ln/∂ln, from differences at ± 0.02 % and ± 0.01 % (Richardson)", _TANGENT, (plain,)
    )
    return (
        number(
            f"{head} change", "fraction", f"Change of the {answer} for + 1 %, by the derivative.",
            trace=derivative, format=shown.CHANGE,
        ),
        number(
            f"{head} error", "fraction", "Estimated error of this derivative.",
            "Difference between the two finite-difference estimates, plus three times the change at twice "
            "the step and the distance from the tangent", _TANGENT,
            of_row=(f"Sensitivities.{head} change",),
        ),
        *(
            number(
                f"{head} {end}", "fraction", f"Change of the {answer} in a run at {sign} 1 %.",
                trace=Trace(
                    f"Run at {exact} 1 % / nominal run − 1", _TANGENT, (plain,)
                ),
                format=shown.CHANGE,
            )
            for end, sign, exact in (("below", "-", "−"), ("above", "+", "+"))
        ),
    )  # fmt: skip


_RESULTS: tuple[TableSpec, ...] = (
    table(
        "Sensitivities", sheet="Sensitivities", caption="Sensitivities",
        help="Effect of + 1 % of each quantity on the governing shaft: by the derivative, and in "
        "runs at ± 1 %.",
        row_name=("Quantity", "Of"), changes_shown=("Starts change", "Peak change"),
        columns=(
            text("Quantity", "Quantity changed.", trace=_AS_TYPED),
            text("Of", "Element, station or material; blank = all modes.", trace=_AS_TYPED),
            *_changes("Peak", "peak stress", "StartupPeaks.Maximum torque"),
            *_changes("Starts", "allowable starts", "AllowableStarts.Allowable starts"),
            text("Method", "Method of the derivative.", trace=_AS_TYPED, width=16.0),
            sentence("Note", "Notes on this row.", trace=_AS_TYPED, width=37.0),
        ),
    ),
    table(
        "FrequencySensitivities", sheet="Sensitivities",
        caption="Frequency sensitivities",
        help="Relative change of each frequency per relative change of the quantity: ± ½ × share "
        "of the energy.",
        columns=(
            text(
                "Quantity", "stiffness or inertia; bearing stiffness, lateral mass.",
                trace=_AS_TYPED,
            ),
            text("Of", "Element or station.", trace=_AS_TYPED),
        ),
        repeated=number(
            "Mode", "ratio", "Half the share of the mode's energy; negative for inertias.",
            "∂ln f/∂ln k = ½ strain-energy share; ∂ln f/∂ln J = −½ kinetic-energy share", _ENERGY,
            of_case=("NaturalFrequencies.Frequency", "ModeShapes.Mode"),
        ),
        extra_columns=tuple(
            number(
                f"Shift {mode}", "frequency",
                f"Live formula: Mode {mode} × the change above × its frequency on sheet Results.",
                "∂ln f/∂ln × change × frequency", _ENERGY, of_row=("FrequencySensitivities.Mode",),
                of_case=("NaturalFrequencies.Frequency",), formula=sensitivity_shift(mode),
                format=shown.SHIFT,
            )
            for mode in (1, 2, 3)
        ),
    ),
)  # fmt: skip

_SHEETS: tuple[Sheet, ...] = (
    Sheet(
        "Sensitivities",
        "result",
        {"A": 1.5, "B": 15, "C": 22, "D:K": 8.5, "L": 27, "M": 49},
        {"Sensitivities": "B7"},
        intro="Sensitivity of the results to each quantity. Written by torsionbook sensitivities "
        "FILE.",
    ),
    Sheet(
        "Frequency sensitivities",
        "result",
        {"A": 1.5, "B": 16, "C": 23, "D:P": 8.8},
        {"FrequencySensitivities": "B7"},
        on="Sensitivities",
        intro="Sensitivity of each frequency to each stiffness and inertia; the green cells show "
        "the shifts for the change typed on sheet Results. Written by torsionbook "
        "sensitivities FILE.",
    ),
)  # fmt: skip


_ROW = {
    "quantity": TEXT,
    "of": TEXT,
    "element": TEXT,
    "peak_torque": described("Change of its peak torque for + 1 %.", NUMBER),
    "peak_error": NUMBER,
    "allowable_starts": described("Change of the allowable starts for + 1 %.", NUMBER),
    "starts_error": NUMBER,
}
#: What its JSON has beside its tables.
_DETAILS: Shape = {
    "sensitivities_of_elements": list_of(closed_object(_ROW)),
    "largest_difference_of_two_ways": {
        "description": (
            "Largest difference between finite differences and the tangent equations of the "
            "start; null where there are none."
        ),
        **BLANK,
    },
}

SENSITIVITIES = StudySpec(
    key="sensitivities",
    order=3,
    command="sensitivities",
    sheet="Sensitivities",
    inputs=(),
    results=_RESULTS,
    sheets=_SHEETS,
    details=_DETAILS,
)
