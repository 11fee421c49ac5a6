"""`torsionbook report`."""

from __future__ import annotations

import importlib.util
from pathlib import Path
from typing import Annotated

import typer

from addin.cli.options import ForceOption
from addin.cli.status import WRONG_INPUT, failed
from addin.cli.terminal import (
    list_problems,
    print_written,
    progress,
    refuse_existing,
    stages_of,
    writing,
)
from addin.report.company import CompanyFileError, read_logo, read_word_template
from addin.report.make import report as make
from addin.xlsx.places import real_path

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
            help="Earlier revision (workbook, case or result JSON); adds a section with the "
            "changes and their effect on results.",
            show_default=False,
        ),
    ] = None,
    logo: Annotated[
        Path | None,
        typer.Option(
            help="Logo of your company for the cover: PNG, JPEG or SVG.", show_default=False
        ),
    ] = None,
    word_template: Annotated[
        Path | None,
        typer.Option(
            help="Word document (.docx, .dotx) whose styles, page set-up, heads and feet the Word "
            "document takes.",
            show_default=False,
        ),
    ] = None,
    force: ForceOption = False,
) -> None:
    """Write the calc sheet as a document: PDF, Word, or both.

    Everything in it is calculated from the inputs when it is written.

    Example: `torsionbook report train.xlsx --pdf train.pdf --docx train.docx`

    Example: `torsionbook report rev1.xlsx --pdf rev1.pdf --against rev0.xlsx`

    Example: `torsionbook report train.xlsx --docx train.docx --logo logo.png --word-template letter.dotx`
    """
    wanted = {name: path for name, path in (("pdf", pdf), ("docx", docx)) if path is not None}
    if not wanted:
        raise typer.BadParameter("Name an output: --pdf OUT.pdf, --docx OUT.docx, or both.")
    for name, path in wanted.items():
        if path.suffix.lower() != f".{name}":
            raise typer.BadParameter(f"'{path}' must end in .{name}.")
    if against is not None and real_path(against) == real_path(file):
        raise typer.BadParameter(
            f"--against is {against}, the same file. Name an earlier revision of it."
        )
    for name, path in wanted.items():
        _refuse(name, path, force)

    if word_template is not None and docx is None:
        raise typer.BadParameter(
            "--word-template is for a Word document: name it with --docx OUT.docx."
        )
    try:
        picture = None if logo is None else read_logo(logo, for_word=docx is not None)
        template = None if word_template is None else read_word_template(word_template)
    except CompanyFileError as wrong:
        raise failed(str(wrong)) from None

    with writing(next(iter(wanted.values()))), progress() as tell:
        done = make(
            file, pdf=pdf, docx=docx, against=against, logo=picture, word_template=template,
            on_stage=stages_of(file, tell),
        )  # fmt: skip
    for sentence in done.notes:
        typer.echo(f"{file}: note: {sentence}", err=True)
    if done.problems:
        list_problems(done.wrong or file, done.problems)
        raise typer.Exit(WRONG_INPUT)
    print_written(done.written)


def _refuse(name: str, path: Path, force: bool) -> None:
    """What would keep the report from being written, said before anything is calculated."""
    if not all(map(importlib.util.find_spec, PACKAGES[name])):
        raise failed(
            "The packages for reports are not installed. Run pip install -r requirements/report.txt "
            "in the checkout, or install the wheel with its extra [report]."
        )
    if path.is_dir():
        raise failed(f"{path} is a folder; name a file.")
    refuse_existing(path, force)
