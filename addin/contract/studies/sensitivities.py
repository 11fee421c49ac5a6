"""Sensitivities to each quantity in workbook and JSON."""

from __future__ import annotations

from addin.contract import number_formats as shown
from addin.contract.field import TableSpec, Trace, number, sentence, table, text
from addin.contract.json_shapes import BLANK, NUMBER, TEXT, Shape, closed_object, described, list_of
from addin.contract.live_formulas import sensitivity_shift
from addin.contract.sheet import Sheet
from addin.contract.study_spec import StudySpec

_ENERGY = "Rayleigh, Theory of Sound I, § 88; docs/tolerances.md"
_TANGENT = "docs/tolerances.md"
_AS_TYPED = Trace("Name, as typed", "docs/tolerances.md")


def _derivative(plain: str) -> Trace:
    return Trace(
        "1 % × ∂ln/∂ln, from differences at ± 0.02 % and ± 0.01 % (Richardson)", _TANGENT, (plain,)
    )


def _run_at(change: str, plain: str) -> Trace:
    return Trace(f"Run at {change} over the plain run, less 1", _TANGENT, (plain,))


_RESULTS: tuple[TableSpec, ...] = (
    table(
        "Sensitivities", sheet="Sensitivities", caption="Sensitivities",
        help="What + 1 % of each quantity does to the governing shaft: derivative, and what really happens.",
        row_name=("Quantity", "Of"), changes_shown=("Starts change", "Peak change"),
        columns=(
            text("Quantity", "What is changed.", trace=_AS_TYPED),
            text("Of", "Whose: element, station or material; blank = all modes.", trace=_AS_TYPED),
            number(
                "Peak change", "fraction",
                "Change of its peak stress for + 1 %, by the derivative.",
                trace=_derivative("StartupPeaks.Maximum torque"), format=shown.CHANGE,
            ),
            number(
                "Peak error", "fraction", "Estimated error of that.",
                "Difference of the two differences", _TANGENT,
                of_row=("Sensitivities.Peak change",),
            ),
            number(
                "Peak below", "fraction", "Change of its peak stress in a run at - 1 %.",
                trace=_run_at("− 1 %", "StartupPeaks.Maximum torque"), format=shown.CHANGE,
            ),
            number(
                "Peak above", "fraction", "Change of its peak stress in a run at + 1 %.",
                trace=_run_at("+ 1 %", "StartupPeaks.Maximum torque"), format=shown.CHANGE,
            ),
            number(
                "Starts change", "fraction", "Change of its starts for + 1 %, by the derivative.",
                trace=_derivative("AllowableStarts.Allowable starts"), format=shown.CHANGE,
            ),
            number(
                "Starts error", "fraction", "Estimated error of that.",
                "Difference of the two differences", _TANGENT,
                of_row=("Sensitivities.Starts change",),
            ),
            number(
                "Starts below", "fraction", "Change of its starts in a run at - 1 %.",
                trace=_run_at("− 1 %", "AllowableStarts.Allowable starts"), format=shown.CHANGE,
            ),
            number(
                "Starts above", "fraction", "Change of its starts in a run at + 1 %.",
                trace=_run_at("+ 1 %", "AllowableStarts.Allowable starts"), format=shown.CHANGE,
            ),
            text("Method", "How the derivative was found.", trace=_AS_TYPED, width=16.0),
            sentence("Note", "What must be known of this row.", trace=_AS_TYPED, width=37.0),
        ),
    ),
    table(
        "FrequencySensitivities", sheet="Frequency sensitivities",
        caption="Frequency sensitivities",
        help="Relative change of each frequency over that of the quantity: ± ½ × share of the energy.",
        columns=(
            text(
                "Quantity", "stiffness or inertia; bearing stiffness, lateral mass.",
                trace=_AS_TYPED,
            ),
            text("Of", "Element or station.", trace=_AS_TYPED),
        ),
        repeated=number(
            "Mode", "ratio", "Half the share of the mode's energy; - of inertias.",
            "∂ln f/∂ln k = ½ strain-energy share; ∂ln f/∂ln J = −½ kinetic-energy share", _ENERGY,
            of_case=("NaturalFrequencies.Frequency", "ModeShapes.Mode"),
        ),
        extra_columns=tuple(
            number(
                f"Shift {mode}", "frequency",
                f"Live formula: Mode {mode} × the change above × its frequency on sheet Frequencies.",
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
        {"A": 1.5, "B": 15, "C": 22, "D:K": 8.5, "L": 16, "M": 37},
        "M",
        {"Sensitivities": "B7"},
        freeze="A10",
        side=0.25,
        intro="What a small change of each quantity does. Written by torsionbook sensitivities "
        "FILE.",
    ),
    Sheet(
        "Frequency sensitivities",
        "result",
        {"A": 1.5, "B": 16, "C": 23, "D:P": 8.8},
        "P",
        {"FrequencySensitivities": "B7"},
        freeze="A10",
        intro="How each frequency follows each stiffness and inertia; the green shifts "
        "follow the change typed on sheet Frequencies. Written by torsionbook sensitivities FILE.",
        behind="Frequencies",
    ),
)  # fmt: skip


def _details() -> Shape:
    """What its JSON has beside its tables."""
    row = {
        "quantity": TEXT,
        "of": TEXT,
        "element": TEXT,
        "peak_torque": described("Change of its peak torque for + 1 %.", NUMBER),
        "peak_error": NUMBER,
        "allowable_starts": described("Change of its starts for + 1 %.", NUMBER),
        "starts_error": NUMBER,
    }
    return {
        "sensitivities_of_elements": list_of(closed_object(row)),
        "largest_difference_of_two_ways": {
            "description": "Between differences and the tangent of the start; null without one.",
            **BLANK,
        },
    }


SENSITIVITIES = StudySpec(
    key="sensitivities",
    order=3,
    command="sensitivities",
    sheet="Sensitivities",
    last="M",
    inputs=(),
    results=_RESULTS,
    sheets=_SHEETS,
    details=_details(),
)
