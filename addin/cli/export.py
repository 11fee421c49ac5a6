"""`torsionbook export`: the inputs of a workbook as a case JSON."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from addin.cli.status import WRONG_INPUT
from addin.cli.terminal import list_problems, read_or_stop, refuse_no_json, writing
from addin.contract.tables import STUDY_INPUT_TABLES
from addin.reading.case_json import case_to_json
from addin.xlsx.places import real_path
from addin.xlsx.whole_files import write_json


def export(
    file: Annotated[Path, typer.Argument(help="Workbook or case JSON.", show_default=False)],
    case: Annotated[Path, typer.Argument(help="The case JSON to write.", show_default=False)],
) -> None:
    """Write the inputs of a workbook as a case JSON, in SI, with those of the studies.

    Example: `torsionbook export train.xlsx case.json`
    """
    if real_path(case) == real_path(file):
        raise typer.BadParameter(f"{case} is the input. Choose another name.")
    refuse_no_json(case)
    read = read_or_stop(file)
    studies = read.studies
    wrong = () if studies is None else studies.problems_of(studies.tables)
    if wrong:
        list_problems(file, wrong)
        raise typer.Exit(WRONG_INPUT)
    content = case_to_json(read.data, studies)
    with writing(case):
        write_json(case, content)
    taken = [spec.name for spec in STUDY_INPUT_TABLES if spec.key in content]
    tables = f", with the study tables {', '.join(taken)}" if taken else ""
    typer.echo(f"{case} is written{tables}.")
