"""`torsionbook check`: errors of inputs with their cells, and answers that cannot be given yet."""

from __future__ import annotations

import typer

from addin.calculation.full_speed_words import full_speed_words
from addin.cli.options import Files
from addin.cli.status import WRONG_INPUT
from addin.cli.terminal import list_problems
from addin.contract.problems import printable
from addin.reading.one_file import Unreadable, read_checked
from addin.reading.typed_case import CaseInput
from addin.studies.registry import of_studies
from addin.writing.recalculate import case_problems
from engine.case.missing_inputs import missing_inputs
from engine.case.plausibility import implausible
from engine.errors import CaseError, ModelError
from engine.model.build_train import build_train
from engine.operation.full_speed import full_speed
from engine.operation.plausible_train import impossible_train, unusual_train


def check(files: Files) -> None:
    """Read and check inputs without calculating: every error with its sheet and cell.

    Where there is none, it says what looks like a slip of unit, column or row, repeats speeds, ratio, load and
    inertia constant, and says which answers cannot be given yet, and which input is missing for each.

    Example: `torsionbook check train.xlsx`
    """
    wrong = 0
    for file in files:
        read = read_checked(file)
        notes, facts, problems = read.warnings, "", (*read.problems, *of_studies(read))
        if not isinstance(read, Unreadable) and not read.problems:
            try:
                notes, facts = _plausible(read)
            except (CaseError, ModelError) as error:
                problems = case_problems(error)
        for sentence in notes:
            typer.echo(f"{file}: note: {printable(sentence)}")
        if problems:
            wrong += 1
            list_problems(file, problems)
        else:
            typer.echo(f"{file}: no errors.")
            typer.echo(f"  At full speed: {printable(facts)}.")
            if open_answers := missing_inputs(read.case()):  # type: ignore[union-attr]
                typer.echo(f"  Not yet available: {' '.join(open_answers)}")
    if wrong:
        raise typer.Exit(WRONG_INPUT)


def _plausible(read: CaseInput) -> tuple[tuple[str, ...], str]:
    """Notes on a case without errors, and its train at full speed."""
    case = read.case()
    train = build_train(case)
    facts = full_speed(case, train)
    notes = (
        *read.warnings,
        *(one.sentence for one in impossible_train(case, train, facts)),
        *implausible(case),
        *unusual_train(case, train, facts),
    )
    return notes, full_speed_words(facts)
