"""`torsionbook export`: the inputs of a workbook as a case JSON."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from addin.cli.status import WRONG_INPUT, Refused
from addin.cli.terminal import list_problems
from addin.reading.case_json import case_to_json
from addin.reading.one_file import Unreadable, file_problem, read_checked
from addin.xlsx.whole_files import write_json


def export(
    file: Annotated[Path, typer.Argument(help="Workbook or case JSON.", show_default=False)],
    case: Annotated[Path, typer.Argument(help="The case JSON to write.", show_default=False)],
) -> None:
    """Write the inputs of a workbook as a case JSON, in SI.

    Example: `torsionbook export train.xlsx case.json`
    """
    read = read_checked(file)
    if isinstance(read, Unreadable) or read.problems:
        list_problems(file, read.problems)
        raise typer.Exit(WRONG_INPUT)
    try:
        write_json(case, case_to_json(read.data))
    except OSError as wrong:
        raise Refused(file_problem(case, wrong).message) from wrong
    typer.echo(f"{case} is written.")
