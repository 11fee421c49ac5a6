"""Stiffnesses that explain measured frequencies."""

from __future__ import annotations

from addin.worksheet.answers import HEADERS, MODEL, UNITS, Rows, system_for, table_cells
from addin.worksheet.models import MODELS
from addin.worksheet.registry import Argument, FunctionError, registered
from engine.case.study_inputs import STIFFNESS, MeasuredFrequencyRow, ScatterRow, StudyInputs
from engine.studies.calibration.calibration import calibrate
from engine.studies.calibration.inputs import calibration_problems
from engine.studies.calibration.tables import parameter_rows

#: Place of these functions among all, in lists and in the documentation.
ORDER = 70


#: Columns of `CalibratedParameters` that a formula shows.
CALIBRATED = (
    "Name", "Stiffness", "Calibrated stiffness", "Change", "Change low", "Change high", "Determined",
)  # fmt: skip


@registered(
    "TV_CALIBRATE",
    MODEL,
    Argument("Frequencies", "numbers", "The measured natural frequencies [Hz], in any order."),
    Argument(
        "Uncertainty",
        "number",
        "Standard deviation of the measured frequencies, 0.01 or 1 %; blank = 1 %.",
        True,
    ),
    Argument("Spread", "number", "Standard deviation of every stiffness; blank = 10 %.", True),
    UNITS,
    HEADERS,
    columns=len(CALIBRATED),
    example="=TV_CALIBRATE(A1, 30.1, 0.01, 0.1)",
)
def tv_calibrate(
    handle: str,
    frequencies: Rows,
    uncertainty: float | None,
    spread: float | None,
    units: str | None,
    headers: bool | None,
) -> Rows:
    """The smallest change of all stiffnesses that explains measured natural frequencies.

    Each frequency is assigned to the mode that it fits best, one to one. A frequency that no mode can
    have is refused. `torsionbook calibrate` also takes inertias, stated modes and peak torques, and
    its sheet Calibration shows more.
    """
    model = MODELS.of(handle)
    typed = [float(v) for line in frequencies for v in line if v is not None]
    if not typed:
        raise FunctionError("Frequencies is blank. Give measured natural frequencies [Hz].")
    asked = StudyInputs(
        scatter=() if spread is None else (ScatterRow(None, STIFFNESS, None, spread),),
        measured_frequencies=tuple(MeasuredFrequencyRow(None, f, uncertainty) for f in typed),
    )
    wrong = calibration_problems(model.case, asked)
    if wrong:
        first = wrong[0]
        raise FunctionError(f"{first.column or first.table}: {first.message}", "#NUM!")
    result = calibrate(model.case, asked)
    unused = next((m for m in result.measurements if not m.used), None)
    if unused is not None:
        raise FunctionError(f"Frequencies: {unused.measured:.10g} Hz. {unused.note}", "#N/A")
    rows, system = parameter_rows(result), system_for(units, model)
    return table_cells("CalibratedParameters", rows, system, headers, CALIBRATED)
