"""`torsionbook upgrade`: a workbook of an earlier release as one of this version."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from addin.cli.options import IgnoreLockOption
from addin.cli.status import failed, failing_on
from addin.cli.terminal import print_written, read_or_stop
from addin.contract.problems import printable
from addin.reading.one_file import file_problem
from addin.reading.workbook import WorkbookInput
from addin.template.filled import MixedUnits
from addin.template.rebuilt import CannotBeRebuilt
from addin.template.upgraded import upgraded_workbook
from addin.xlsx import PackageError
from addin.xlsx.save import Destination, put_in_place
from addin.xlsx.temporary import temporary_folder


def upgrade(
    file: Annotated[Path, typer.Argument(help="The workbook.", show_default=False)],
    ignore_lock: IgnoreLockOption = False,
) -> None:
    """Move the inputs of a workbook, and your own sheets, into a workbook of this version.

    The workbook stays as FILE.bak. What could not be taken along is listed. Results are calculated
    by the next `torsionbook recalc FILE`; the inputs, and so the numbers, are the same.

    Example: `torsionbook upgrade train.xlsx`
    """
    read = read_or_stop(file)
    if file.suffix.lower() == ".xlsm":
        raise failed(
            f"{file} has macros. They are bound to the sheets it has, and a workbook of this version has others, so "
            f"Excel would not take them. Make a new one with its inputs: torsionbook new NEW.xlsm --from {file}. "
            "Then move your own modules there in the editor of Excel (Alt+F11: Export File, Import File)."
        )
    if not isinstance(read, WorkbookInput) or file.suffix.lower() != ".xlsx":
        raise failed(
            f"{file} is no .xlsx workbook. Make a new one with its inputs: torsionbook new NEW --from {file}"
        )
    with (
        failing_on(CannotBeRebuilt, MixedUnits, about=file),
        temporary_folder() as folder,
    ):
        try:
            read.workbook.allow_saving(ignore_lock=ignore_lock)
            done = upgraded_workbook(read, folder)
            place = Destination(file, True, ignore_lock=ignore_lock, keep_backups=True)
            delivered = put_in_place(read.workbook.container, done.path, place)
        except (PackageError, OSError) as wrong:
            raise failed(file_problem(file, wrong).message) from wrong
    for sentence in (*done.notes, *delivered.notes):
        typer.echo(f"{file}: note: {printable(sentence)}", err=True)
    print_written([file])
    typer.echo(f"The workbook as it was: {delivered.backup}. Calculate: torsionbook recalc {file}")
