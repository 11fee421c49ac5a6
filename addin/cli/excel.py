"""``torsionbook excel``: the worksheet functions into a workbook, and help where they do not work."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from addin.cli.options import ForceOption, IgnoreLockOption
from addin.cli.status import WRONG_INPUT, failed, failing_on
from addin.cli.terminal import refuse_no_name, writing
from addin.excel.doctor import WRONG, examine
from addin.excel.errors import ExcelError
from addin.excel.workbook import install as put
from addin.xlsx import SaveReport
from addin.xlsx.places import real_path

excel = typer.Typer(
    name="excel",
    no_args_is_help=True,
    rich_markup_mode="markdown",
    help=(
        "Worksheet functions in desktop Excel on Windows, through xlwings.\n\n"
        "`torsionbook excel install train.xlsx` makes train.xlsm with the functions; "
        "`torsionbook excel doctor train.xlsm` finds what is wrong with the installation; "
        "`torsionbook excel upgrade train.xlsm` updates an older one to this version."
    ),
)

File = Annotated[Path, typer.Argument(help="The workbook.", show_default=False)]
Interpreter = Annotated[
    str,
    typer.Option(
        help="Full path of pythonw.exe for the workbook; default: the path in the workbook, else "
        "this Python (on other systems than Windows, the path given in the documentation).",
        show_default=False,
    ),
]


@excel.command()
def install(
    file: File,
    out: Annotated[
        Path | None, typer.Option(help="The .xlsm to write; default beside the workbook.")
    ] = None,
    interpreter: Interpreter = "",
    force: ForceOption = False,
    ignore_lock: IgnoreLockOption = False,
) -> None:
    """Give a workbook the functions: FILE.xlsx becomes FILE.xlsm; FILE itself stays.

    Works on any system. An .xlsm with macros of its own keeps them; say --out for another name.

    Example: `torsionbook excel install train.xlsx`
    """
    target = out or file.with_suffix(".xlsm")
    if target.exists() and real_path(target) == real_path(file):
        raise typer.BadParameter(
            f"{target} is the input workbook. Name another with --out, or use: "
            f"torsionbook excel upgrade {file}"
        )
    refuse_no_name(target)
    if target.exists() and not force:
        raise failed(f"{target} exists. Name another with --out, or use --force.")
    report = _written(file, target, interpreter, ignore_lock)
    typer.echo(f"written: {report.path}")
    typer.echo("On the computer with Excel: torsionbook excel doctor " + str(report.path))


@excel.command()
def upgrade(
    file: File, interpreter: Interpreter = "", ignore_lock: IgnoreLockOption = False
) -> None:
    """Bring the functions of an .xlsm to this version; it stays as FILE.bak, then .bak2 and so on.

    Its own macros, its sheets and the Python it names stay as they are.

    Example: `torsionbook excel upgrade train.xlsm`
    """
    if file.suffix.lower() != ".xlsm":
        raise typer.BadParameter(
            f"{file} is not an .xlsm file. Run first: torsionbook excel install {file}"
        )
    report = _written(file, None, interpreter, ignore_lock)
    typer.echo(f"written: {report.path}")
    typer.echo(f"backup: {report.backup}")


@excel.command()
def doctor(file: File) -> None:
    """Check Office, Python, versions, library, folder and blocking, and say what to do.

    Example: `torsionbook excel doctor train.xlsm`
    """
    checks = examine(file)
    for check in checks:
        typer.echo(f"[{check.state}] {check.what}: {check.found}")
        if check.advice:
            typer.echo(f"    {check.advice}")
    if any(check.state == WRONG for check in checks):
        raise typer.Exit(WRONG_INPUT)


def _written(file: Path, target: Path | None, interpreter: str, ignore_lock: bool) -> SaveReport:
    """Write the workbook, or say why not."""
    with failing_on(ExcelError, about=file), writing(file):
        return put(file, target, interpreter=interpreter, ignore_lock=ignore_lock)
