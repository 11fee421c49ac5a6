"""Calibration against measurements as a study; see `engine.studies.calibration.calibration`."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

from addin.contract.studies.calibration import CALIBRATION as CALIBRATION_SPEC
from addin.reading.case_json import case_to_json
from addin.studies.study import Option, Study, StudyResult, StudyTask, TerminalTable
from addin.xlsx.whole_files import write_json
from engine.case.data import CaseData
from engine.case.study_inputs import MEASURED_FREQUENCY, MEASURED_TORQUE, DisplayUnit
from engine.studies.calibration.calibration import calibrate
from engine.studies.calibration.inputs import calibration_problems
from engine.studies.calibration.tables import (
    frequency_rows,
    margin_rows,
    measurement_rows,
    parameter_rows,
    solution_rows,
)


def _calculate(task: StudyTask) -> StudyResult:
    def each(do: Callable[[CaseData], Any], cases: Iterable[CaseData]) -> list[Any]:
        bundle = list(cases)
        return task.map(
            do, bundle, lambda done: f"start {min(done + 1, len(bundle))} of {len(bundle)}"
        )

    task.tell("measured frequencies")
    calibration = calibrate(task.case, task.inputs, each_start=each)
    return StudyResult(
        result=calibration,
        tables={
            "FrequencyFit": measurement_rows(calibration, "frequency"),
            "PeakFit": measurement_rows(calibration, "peak torque"),
            "CalibratedFrequencies": frequency_rows(calibration),
            "CalibratedMargins": margin_rows(calibration),
            "CalibratedParameters": parameter_rows(calibration),
            "CalibrationSolutions": solution_rows(calibration),
        },
        sentence=" ".join((calibration.sentence, calibration.basis_reason, *calibration.notes)),
        digest=calibration.study_sha256,
        details={
            "chi_square": calibration.chi_square,
            "degrees": calibration.degrees,
            "probability": calibration.probability,
            "explained": calibration.explained,
            "margin_basis": calibration.basis,
            "margin_basis_justified": calibration.basis_justified,
            "margin_basis_reason": calibration.basis_reason,
            "starts": calibration.starts,
        },
        units=task.inputs.units,
    )


def _terminal(study: StudyResult, options: Mapping[str, Any]) -> Iterator[TerminalTable]:
    """What was measured against what is calculated, and what was changed for it."""
    units = {
        "frequency": study.units.get(("", MEASURED_FREQUENCY), DisplayUnit("Hz", 1.0)),
        "peak torque": study.units.get(("", MEASURED_TORQUE), DisplayUnit("N m", 1.0)),
    }
    yield TerminalTable(
        (
            ("Measured", "name"),
            ("Row", "name"),
            *((header, "number") for header in ("As typed", "Before", "After", "Off by (σ)")),
            ("Note", "text"),
        ),
        [
            (
                m.of or "–",
                str(m.row),
                *(_in_unit(v, units[m.kind]) for v in (m.measured, m.before, m.after)),
                "–" if m.residual is None else f"{m.residual:+z.2f}",
                m.note,
            )
            for m in study.result.measurements
        ],
    )
    numbers = ("Change", "95 % interval", "Determined")
    yield TerminalTable(
        (("Uncertain", "name"), ("Of", "name"), *((header, "number") for header in numbers)),
        [
            (
                p.quantity,
                p.name,
                f"{100.0 * p.change:+z.1f} %",
                f"{100.0 * p.change_low:+z.1f} to {100.0 * p.change_high:+z.1f} %"
                if study.result.intervals_hold
                else "–",
                p.determined,
            )
            for p in study.result.parameters
        ],
    )


def _in_unit(value: float | None, unit: DisplayUnit) -> str:
    """A measured or calculated number in the unit that was typed."""
    return "–" if value is None else unit.format(value, 4)


def _save(study: StudyResult, options: Mapping[str, Any], source: Path) -> Iterator[Path]:
    """The calibrated case as JSON."""
    path = options["case"]
    if path is not None:
        write_json(path, case_to_json(study.result.calibrated))
        yield path


_HELP = """\
Calibrate: find the smallest change of uncertain inputs that explains what was measured.

Measurements are in tables MeasuredFrequencies and MeasuredPeaks of sheet Measured, uncertainties
in table Scatter of sheet Tolerances (blank: every stiffness by 10 %). Writes sheet Calibration,
which also states whether the margin for measured frequencies applies.

Example: `torsionbook calibrate train.xlsx --case calibrated.json`"""


CALIBRATION = Study(
    spec=CALIBRATION_SPEC,
    check=calibration_problems,
    calculate=_calculate,
    help=_HELP,
    options=(
        Option(
            "case", Path, None,
            "Write the calibrated case as JSON; `torsionbook new calibrated.xlsx --from` makes a "
            "workbook of it.",
            is_setting=False,
        ),
    ),
    terminal=_terminal,
    save=_save,
)  # fmt: skip
