"""`torsionbook calibrate`: the least change that explains what was measured."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from addin.cli.options import (
    FileArgument,
    IgnoreLockOption,
    InPlaceOption,
    JobsOption,
    JsonOption,
    OutOption,
    SchedulerOption,
)
from addin.cli.status import Refused
from addin.cli.study import run_study
from addin.cli.terminal import refuse_no_place
from addin.reading.case_json import case_to_json
from addin.reading.one_file import file_problem
from addin.studies.calibration import CALIBRATION
from addin.studies.study import Found
from addin.xlsx.whole_files import write_json
from engine.case.study_inputs import MEASURED_FREQUENCY, MEASURED_TORQUE, DisplayUnit

#: The table on the terminal is at least so wide. [characters]
_WIDTH = 110


def calibrate(
    file: FileArgument,
    out: OutOption = None,
    in_place: InPlaceOption = False,
    json: JsonOption = None,
    case: Annotated[
        Path | None,
        typer.Option(
            "--case",
            help="Write the calibrated case as JSON; `torsionbook new calibrated.xlsx --from` it "
            "makes a workbook.",
            show_default=False,
        ),
    ] = None,
    jobs: JobsOption = None,
    scheduler: SchedulerOption = None,
    ignore_lock: IgnoreLockOption = False,
) -> None:
    """Calibrate: the least change of uncertain stiffnesses that explains measured frequencies.

    Measurements stand in tables MeasuredFrequencies and MeasuredPeaks of sheet Measured, what is
    uncertain in table Scatter of sheet Tolerances (blank: every stiffness by 10 %). Writes sheet
    Calibration, which also says whether margins may be judged as of measured frequencies.

    Example: `torsionbook calibrate train.xlsx --case calibrated.json`
    """
    if case is not None and case.resolve() == file.resolve():
        raise typer.BadParameter("--case would write over the input.")
    refuse_no_place(case)

    def save(found: Found) -> None:
        if case is not None:
            _write_case(case, found)

    run_study(
        CALIBRATION,
        file,
        {},
        out=out,
        in_place=in_place,
        json=json,
        jobs=jobs,
        scheduler=scheduler,
        ignore_lock=ignore_lock,
        show=_show,
        then=save,
    )


def _write_case(path: Path, found: Found) -> None:
    try:
        write_json(path, case_to_json(found.result.calibrated))
    except OSError as wrong:
        raise Refused(file_problem(path, wrong).message) from wrong
    typer.echo(f"written: {path}")


def _in_unit(value: float | None, unit: DisplayUnit) -> str:
    """A measured or calculated number in the unit that was typed."""
    return "–" if value is None else unit.format(value, 4)


def _show(found: Found) -> None:
    from rich.console import Console
    from rich.table import Table

    units = {
        "frequency": found.units.get(("", MEASURED_FREQUENCY), DisplayUnit("Hz", 1.0)),
        "peak torque": found.units.get(("", MEASURED_TORQUE), DisplayUnit("N m", 1.0)),
    }
    table = Table(show_edge=False, pad_edge=False)
    for header in ("Measured", "Row"):
        table.add_column(header, no_wrap=True)
    for header in ("As typed", "Before", "After", "Off by (σ)", "Note"):
        table.add_column(header, justify="left" if header == "Note" else "right")
    for m in found.result.measurements:
        table.add_row(
            m.of or "–",
            str(m.row),
            *(_in_unit(v, units[m.kind]) for v in (m.measured, m.before, m.after)),
            "–" if m.residual is None else f"{m.residual:+.2f}",
            m.note,
        )
    changes = Table(show_edge=False, pad_edge=False)
    for header in ("Uncertain", "Of"):
        changes.add_column(header, no_wrap=True)
    for header in ("Change", "95 % interval", "Determined"):
        changes.add_column(header, justify="right")
    for p in found.result.parameters:
        changes.add_row(
            p.quantity,
            p.name,
            f"{100.0 * p.change:+.1f} %",
            f"{100.0 * p.change_low:+.1f} to {100.0 * p.change_high:+.1f} %",
            p.determined,
        )
    console = Console(width=max(Console().width, _WIDTH))
    console.print(table)
    console.print(changes)
