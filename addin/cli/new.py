"""`torsionbook new`: a workbook to fill in, of the variant that its program needs."""

from __future__ import annotations

import os
import shutil
import tempfile
from pathlib import Path
from typing import Annotated

import typer

from addin.cli.options import check_choice
from addin.cli.status import WRONG_INPUT, Refused
from addin.cli.terminal import list_problems
from addin.contract.shipped import template_path
from addin.excel.errors import ExcelError
from addin.excel.workbook import install
from addin.reading.one_file import Unreadable, file_problem, read_checked
from addin.template.build import build_template
from addin.template.examples import Example
from addin.template.filled import MixedUnits, example_of
from addin.template.variants import VARIANTS, Variant


def new(
    file: Annotated[Path, typer.Argument(help="The workbook to make.", show_default=False)],
    units: Annotated[str, typer.Option(help="Units of the blank template: us or si.")] = "us",
    example: Annotated[
        str | None,
        typer.Option(
            help="Instead of a blank template a filled one: the paper's case proposed or modified, "
            "or backlash, the proposed one with gear clearance, bearings and pull-in."
        ),
    ] = None,
    variant: Annotated[
        str | None,
        typer.Option(
            "--for",
            help="Which program it is for: files (the usual, without functions), excel (an .xlsm: "
            "desktop Excel on Windows, functions through xlwings), server (Excel anywhere, functions "
            "from torsionbook serve) or calc (LibreOffice). All but the first have a sheet Live that "
            "shows modes and margins of what is typed. An .xlsm is for excel.",
            show_default=False,
        ),
    ] = None,
    studies: Annotated[
        bool,
        typer.Option(
            "--studies",
            help="With the sheets of the studies: tuning, tolerances, start matrix, calibration.",
        ),
    ] = False,
    source: Annotated[
        Path | None,
        typer.Option(
            "--from",
            metavar="FILE",
            help="Fill in the inputs of this workbook or case JSON, as they are typed there.",
        ),
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace a file that is there.")] = False,
) -> None:
    """Make a workbook to fill in, one of the filled examples, or one with the inputs of another.

    Examples: `torsionbook new train.xlsx --units si`; `torsionbook new train.xlsm --example proposed`;
    `torsionbook new more.xlsx --from train.xlsx --studies`
    """
    if example is not None:
        check_choice("--example", example, ("proposed", "modified", "backlash"))
    check_choice("--units", units, ("us", "si"))
    if variant is None:
        variant = "excel" if file.suffix.lower() == ".xlsm" else "files"
    check_choice("--for", variant, tuple(VARIANTS))
    chosen = VARIANTS[variant]
    if file.suffix.lower() != chosen.suffix:
        more = " (or say --for excel)" if chosen.suffix == ".xlsx" else ""
        raise typer.BadParameter(f"'{file}' must end in {chosen.suffix}{more}.")
    if file.exists() and not force:
        raise Refused(
            f"{file} is there already. Choose another name, or say --force to replace it."
        )
    if not file.parent.is_dir():
        raise Refused(f"The folder {file.parent} does not exist. Make it first.")
    filled = example if source is None else _filled(source, units, example)

    try:
        make_workbook(file, "us" if example else units, filled, chosen, studies=studies)
    except OSError as wrong:
        raise Refused(file_problem(file, wrong).message) from wrong
    except ExcelError as wrong:
        raise Refused(f"{file}: {wrong}") from wrong
    typer.echo(f"{file} is ready. Fill in the yellow cells, then: torsionbook recalc {file}")


def _filled(source: Path, units: str, example: str | None) -> Example:
    """The inputs of another file, as they are typed there."""
    if example is not None:
        raise typer.BadParameter("--from and --example exclude each other.")
    read = read_checked(source)
    if isinstance(read, Unreadable) or read.problems:
        list_problems(source, read.problems)
        raise typer.Exit(WRONG_INPUT)
    try:
        return example_of(read, units)
    except MixedUnits as wrong:
        raise Refused(f"{source}: {wrong}") from wrong


def make_workbook(
    path: Path,
    system: str,
    example: str | Example | None,
    variant: Variant,
    *,
    studies: bool = False,
) -> None:
    """Make a workbook; a file of that name is replaced, and only by a whole one.

    Parameters
    ----------
    path : Path
        The workbook. [path]
    system : str
        ``us`` or ``si``. [word]
    example : str, Example or None
        Key of `addin.template.examples.EXAMPLES`, or what is filled in; None = to be filled in. [name]
    variant : Variant
        What it is for.
    studies : bool, optional
        With the sheets of the studies. [flag]

    Raises
    ------
    OSError
        If it cannot be written.
    ExcelError
        If it needs xlwings and that is not installed.
    """
    with tempfile.TemporaryDirectory(dir=path.parent, prefix=".torsionbook-") as folder:
        made = Path(folder) / "made.xlsx"
        shipped = not studies and (example is None or isinstance(example, str))
        if variant.spelled is None and shipped:
            name = f"example_{example}.xlsx" if example else f"blank_{system}.xlsx"
            shutil.copyfile(template_path(name), made)
        else:
            build_template(made, system, example, variant, studies=studies)
        if variant.suffix == ".xlsm":
            install(made, made.with_suffix(".xlsm"))
            made = made.with_suffix(".xlsm")
        os.replace(made, path)
