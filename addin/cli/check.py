"""`torsionbook check`: errors of inputs with their cells, and answers that cannot be given yet."""

from __future__ import annotations

import typer

from addin.cli.options import Files
from addin.cli.status import WRONG_INPUT
from addin.cli.terminal import list_problems
from addin.contract.problems import printable
from addin.reading.one_file import read_checked
from addin.studies.check_input import check_input


def check(files: Files) -> None:
    """Read and check inputs without calculating: every error with its sheet and cell.

    Where there is none, it says what looks like a slip of unit, column or row, repeats speeds, ratio, load and
    inertia constant, and says which answers cannot be given yet, and which input is missing for each.

    Example: `torsionbook check train.xlsx`
    """
    wrong = 0
    for file in files:
        checked = check_input(read_checked(file))
        for sentence in checked.notes:
            typer.echo(f"{file}: note: {printable(sentence)}")
        if checked.problems:
            wrong += 1
            list_problems(file, checked.problems)
        else:
            typer.echo(f"{file}: no errors.")
            typer.echo(f"  At full speed: {printable(checked.full_speed)}.")
            for steel in checked.steels:
                typer.echo(f"  Strength of {printable(steel)}.")
            if checked.open_answers:
                typer.echo(f"  Not yet available: {' '.join(checked.open_answers)}")
    if wrong:
        raise typer.Exit(WRONG_INPUT)
