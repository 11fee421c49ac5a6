"""`torsionbook report`."""

from __future__ import annotations

import importlib.util
from pathlib import Path
from typing import Annotated

import typer

from addin.cli.status import WRONG_INPUT, failed
from addin.cli.terminal import list_problems, progress
from addin.reading.one_file import file_problem
from addin.report.make import report as make

#: What each form of the report is made with; matplotlib draws the figures of both.
PACKAGES = {"pdf": ("typst", "matplotlib"), "docx": ("docx", "matplotlib")}


def report(
    file: Annotated[Path, typer.Argument(help="Workbook or case JSON.", show_default=False)],
    pdf: Annotated[Path | None, typer.Option(help="The PDF to write.", show_default=False)] = None,
    docx: Annotated[
        Path | None, typer.Option(help="The Word document to write.", show_default=False)
    ] = None,
    against: Annotated[
        Path | None,
        typer.Option(
            help="An earlier revision (workbook, case or result JSON): a section says what changed "
            "since, and what that did.",
            show_default=False,
        ),
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace files that are there.")] = False,
) -> None:
    """Write the calc sheet as a document: PDF, Word, or both.

    Everything in it is calculated from the inputs when it is written.

    Example: `torsionbook report train.xlsx --pdf train.pdf --docx train.docx`

    Example: `torsionbook report rev1.xlsx --pdf rev1.pdf --against rev0.xlsx`
    """
    wanted = {name: path for name, path in (("pdf", pdf), ("docx", docx)) if path is not None}
    if not wanted:
        raise typer.BadParameter("say where to: --pdf OUT.pdf, --docx OUT.docx, or both.")
    for name, path in wanted.items():
        if path.suffix.lower() != f".{name}":
            raise typer.BadParameter(f"'{path}' must end in .{name}.")
    if against is not None and against.resolve() == file.resolve():
        raise typer.BadParameter(
            f"--against is {against}, the file itself. Name an earlier revision of it."
        )
    for name, path in wanted.items():
        _refuse(name, path, force)

    try:
        with progress() as tell:
            done = make(
                file,
                pdf=pdf,
                docx=docx,
                against=against,
                on_stage=lambda stage: tell(f"{file.name}: {stage}"),
            )
    except OSError as wrong:
        raise failed(file_problem(next(iter(wanted.values())), wrong).message) from wrong
    for sentence in done.notes:
        typer.echo(f"{file}: note: {sentence}", err=True)
    if done.problems:
        list_problems(done.wrong or file, done.problems)
        raise typer.Exit(WRONG_INPUT)
    for path in done.written:
        typer.echo(f"written: {path}")


def _refuse(name: str, path: Path, force: bool) -> None:
    """What would keep the report from being written, said before anything is calculated."""
    missing = [one for one in PACKAGES[name] if importlib.util.find_spec(one) is None]
    if missing:
        raise failed(
            "The packages that make a report are not installed. Install them: "
            "pip install torsionbook[report]"
        )
    if path.is_dir():
        raise failed(f"{path} is a folder; name the file to write.")
    if not path.parent.is_dir():
        raise failed(f"The folder {path.parent} does not exist. Make it first.")
    if path.exists() and not force:
        raise failed(f"{path} is there already. Choose another name, or say --force to replace it.")
