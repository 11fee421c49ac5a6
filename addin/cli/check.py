"""`torsionbook check`: errors of inputs with their cells, and answers that cannot be given yet."""

from __future__ import annotations

import typer

from addin.cli.options import Files
from addin.cli.status import WRONG_INPUT
from addin.cli.terminal import list_problems
from addin.contract.problems import printable
from addin.reading.one_file import Unreadable, read_checked
from addin.studies.registry import of_studies
from engine.case.missing_inputs import missing_inputs
from engine.case.plausibility import implausible


def check(files: Files) -> None:
    """Read and check inputs without calculating: every error with its sheet and cell.

    Where there is none, it says which answers cannot be given yet, and which input is missing for each.

    Example: `torsionbook check train.xlsx`
    """
    wrong = 0
    for file in files:
        read = read_checked(file)
        plausible = () if isinstance(read, Unreadable) or read.problems else implausible(read.data)
        for sentence in (*read.warnings, *plausible):
            typer.echo(f"{file}: note: {printable(sentence)}")
        problems = (*read.problems, *of_studies(read))
        if problems:
            wrong += 1
            list_problems(file, problems)
        else:
            typer.echo(f"{file}: no errors.")
            if open_answers := missing_inputs(read.case()):  # type: ignore[union-attr]
                typer.echo(f"  Not yet available: {' '.join(open_answers)}")
    if wrong:
        raise typer.Exit(WRONG_INPUT)
