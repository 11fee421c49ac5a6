"""`torsionbook export`: the inputs of a workbook as a case JSON."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from addin.cli.terminal import read_or_stop, refuse_no_json, writing
from addin.reading.case_json import case_to_json
from addin.xlsx.whole_files import write_json


def export(
    file: Annotated[Path, typer.Argument(help="Workbook or case JSON.", show_default=False)],
    case: Annotated[Path, typer.Argument(help="The case JSON to write.", show_default=False)],
) -> None:
    """Write the inputs of a workbook as a case JSON, in SI.

    Example: `torsionbook export train.xlsx case.json`
    """
    if case.resolve() == file.resolve():
        raise typer.BadParameter(f"{case} is the input. Choose another name.")
    refuse_no_json(case)
    read = read_or_stop(file)
    with writing(case):
        write_json(case, case_to_json(read.data))
    typer.echo(f"{case} is written.")
