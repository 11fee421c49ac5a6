"""`torsionbook new`: a workbook to fill in, of the variant that its program needs."""

from __future__ import annotations

import shutil
from functools import partial
from pathlib import Path
from typing import Annotated

import typer

from addin.cli.options import ForceOption, check_choice
from addin.cli.status import failing_on
from addin.cli.terminal import read_or_stop, refuse_existing, writing
from addin.contract.shipped import template_path
from addin.excel.errors import ExcelError
from addin.excel.workbook import install
from addin.template.build import build_template
from addin.template.examples import EXAMPLES, Example
from addin.template.filled import MixedUnits, example_of
from addin.template.variants import VARIANTS, Variant
from addin.xlsx.temporary import temporary_folder
from addin.xlsx.whole_files import write_whole

#: The example that has the sheets of the studies, and the example whose train it is.
_STUDIES, _STUDIED = "studies", "proposed"


def new(
    file: Annotated[Path, typer.Argument(help="The workbook to make.", show_default=False)],
    units: Annotated[str, typer.Option(help="Units of the blank template: us or si.")] = "us",
    example: Annotated[
        str | None,
        typer.Option(
            help="A filled example instead of a blank template: proposed or modified (the two "
            "designs of the paper, Szenasi & von Nimitz 1978), backlash (proposed, with gear "
            "clearance, bearings and pull-in), motor (modified, with the motor's data sheet "
            "instead of torque curves, a short circuit, a shaft typed by its sections and a ratio by the teeth), or studies (proposed, with the "
            "inputs of every study)."
        ),
    ] = None,
    variant: Annotated[
        str | None,
        typer.Option(
            "--for",
            help="Program that will use the workbook: files (default, without functions), excel "
            "(.xlsm for desktop Excel on Windows, functions through xlwings), server (Excel "
            "anywhere, functions from torsionbook serve) or calc (LibreOffice). All except files "
            "have a sheet Live with modes and margins of the typed inputs. A file name with .xlsm "
            "implies excel.",
            show_default=False,
        ),
    ] = None,
    studies: Annotated[
        bool,
        typer.Option(
            "--studies",
            help="Include the sheets of the studies: tuning, tolerances, start matrix, "
            "calibration.",
        ),
    ] = False,
    source: Annotated[
        Path | None,
        typer.Option(
            "--from", metavar="FILE", help="Copy the inputs of this workbook or case JSON as typed."
        ),
    ] = None,
    force: ForceOption = False,
) -> None:
    """Make a workbook: blank, a filled example, or with the inputs of an existing file.

    Examples: `torsionbook new train.xlsx --units si`; `torsionbook new train.xlsm --example proposed`;
    `torsionbook new more.xlsx --from train.xlsx --studies`
    """
    if example is not None:
        check_choice("--example", example, (*EXAMPLES, _STUDIES))
    if example == _STUDIES:
        example, studies = _STUDIED, True
    check_choice("--units", units, ("us", "si"))
    if variant is None:
        variant = "excel" if file.suffix.lower() == ".xlsm" else "files"
    check_choice("--for", variant, tuple(VARIANTS))
    chosen = VARIANTS[variant]
    if file.suffix.lower() != chosen.suffix:
        more = " (or use --for excel)" if chosen.suffix == ".xlsx" else ""
        raise typer.BadParameter(f"'{file}' must end in {chosen.suffix}{more}.")
    refuse_existing(file, force)
    filled = example if source is None else _filled(source, units, example)

    with failing_on(ExcelError, about=file), writing(file):
        make_workbook(file, "us" if example else units, filled, chosen, studies=studies)
    typer.echo(f"{file} is ready. Fill in the yellow cells, then: torsionbook recalc {file}")


def _filled(source: Path, units: str, example: str | None) -> Example:
    """The inputs of another file, as they are typed there."""
    if example is not None:
        raise typer.BadParameter("Use either --from or --example, not both.")
    read = read_or_stop(source)
    with failing_on(MixedUnits, about=source):
        return example_of(read, units)


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
    with temporary_folder(within=path.parent) as folder:
        made = folder / "made.xlsx"
        shipped = not studies and (example is None or isinstance(example, str))
        if variant.spelled is None and shipped:
            name = f"example_{example}.xlsx" if example else f"blank_{system}.xlsx"
            shutil.copyfile(template_path(name), made)
        else:
            build_template(made, system, example, variant, studies=studies)
        if variant.suffix == ".xlsm":
            install(made, made.with_suffix(".xlsm"))
            made = made.with_suffix(".xlsm")
        write_whole(path, partial(shutil.copyfile, made))
