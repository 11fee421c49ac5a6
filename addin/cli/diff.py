"""``torsionbook diff``: what changed between two revisions, and what it did."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from addin.batch.own_files import sheets_of
from addin.cli.diff_view import show
from addin.cli.status import WRONG_INPUT
from addin.cli.terminal import print_written, refuse_no_json, writing
from addin.diff.compare import compare_files
from addin.diff.files import CannotBeCompared
from addin.diff.wording import as_json
from addin.diff.workbook import DIFF_SHEETS, write_book
from addin.xlsx.places import real_path
from addin.xlsx.whole_files import write_json


def diff(
    a: Annotated[
        Path, typer.Argument(help="Workbook, case JSON or result JSON.", show_default=False)
    ],
    b: Annotated[
        Path, typer.Argument(help="Newer workbook, case JSON or result JSON.", show_default=False)
    ],
    xlsx: Annotated[Path | None, typer.Option(help="Also write it as a workbook.")] = None,
    json: Annotated[Path | None, typer.Option(help="Also write it as JSON, in SI.")] = None,
    recalculate: Annotated[
        bool,
        typer.Option(
            "--recalculate", help="Recalculate both files and ignore their stored results."
        ),
    ] = False,
    everything: Annotated[bool, typer.Option("--all", help="Show every changed result.")] = False,
    strict: Annotated[
        bool, typer.Option("--strict", help="Exit with 1 if an input or a result differs.")
    ] = False,
) -> None:
    """Compare inputs and results of two files: changed inputs and their effect on results.

    Rows are matched by station, element, mode and excitation; the same quantity in another unit is
    no change. Results are those in the files where they belong to the inputs, else calculated.

    Example: `torsionbook diff proposed.out.xlsx modified.out.xlsx --xlsx diff.xlsx`
    """
    if xlsx is not None and xlsx.suffix.lower() != ".xlsx":
        raise typer.BadParameter(f"--xlsx is '{xlsx}'; it must end in .xlsx.")
    sources = {real_path(a), real_path(b)}
    for target in (xlsx, json):
        if target is not None and real_path(target) in sources:
            raise typer.BadParameter(f"{target} is one of the inputs. Choose another name.")
    if json is not None:
        refuse_no_json(json)
    if xlsx is not None and xlsx.exists() and sheets_of(xlsx)[:3] != DIFF_SHEETS:
        raise typer.BadParameter(f"{xlsx} exists and is not a comparison. Choose another name.")
    try:
        differences = compare_files(a, b, recalculate=recalculate)
    except CannotBeCompared as wrong:
        typer.echo(f"{wrong.source}: cannot be compared:", err=True)
        for problem in wrong.problems:
            typer.echo(f"  {problem.message}", err=True)
        raise typer.Exit(WRONG_INPUT) from wrong
    if xlsx is not None:
        with writing(xlsx):
            write_book(differences, xlsx)
    if json is not None:
        with writing(json):
            write_json(json, as_json(differences))
    show(differences, everything)
    print_written(target for target in (xlsx, json) if target is not None)
    if strict and differences.anything:
        raise typer.Exit(WRONG_INPUT)
