"""``torsionbook excel``: the worksheet functions into a workbook, and help where they do not work."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from addin.cli.status import WRONG_INPUT, failed
from addin.excel.doctor import WRONG, examine
from addin.excel.errors import ExcelError
from addin.excel.workbook import install as put
from addin.xlsx import PackageError, SaveReport

excel = typer.Typer(
    name="excel",
    no_args_is_help=True,
    rich_markup_mode="markdown",
    help=(
        "Worksheet functions in desktop Excel on Windows, through xlwings.\n\n"
        "`torsionbook excel install train.xlsx` makes train.xlsm with the functions; "
        "`torsionbook excel doctor train.xlsm` says what is amiss; "
        "`torsionbook excel upgrade train.xlsm` brings an older one to this version."
    ),
)

File = Annotated[Path, typer.Argument(help="The workbook.", show_default=False)]
Interpreter = Annotated[
    str,
    typer.Option(
        help="Full path of pythonw.exe for the workbook; default the one it names, else this one "
        "(elsewhere than on Windows the place the documentation installs it to).",
        show_default=False,
    ),
]
IgnoreLock = Annotated[
    bool, typer.Option("--ignore-lock", help="Go on although a lock file is there.")
]


@excel.command()
def install(
    file: File,
    out: Annotated[
        Path | None, typer.Option(help="The .xlsm to write; default beside the workbook.")
    ] = None,
    interpreter: Interpreter = "",
    force: Annotated[bool, typer.Option("--force", help="Replace a file that is there.")] = False,
    ignore_lock: IgnoreLock = False,
) -> None:
    """Give a workbook the functions: FILE.xlsx becomes FILE.xlsm; FILE itself stays.

    Works on any system. An .xlsm with macros of its own keeps them; say --out for another name.

    Example: `torsionbook excel install train.xlsx`
    """
    target = out or file.with_suffix(".xlsm")
    if target.exists() and target.resolve() == file.resolve():
        raise typer.BadParameter(
            f"{target} is the workbook itself. Name another with --out, or use: "
            f"torsionbook excel upgrade {file}"
        )
    if target.exists() and not force:
        raise failed(f"{target} is there already. Name another with --out, or say --force.")
    report = _written(file, target, interpreter, ignore_lock)
    typer.echo(f"written: {report.path}")
    typer.echo("On the computer with Excel: torsionbook excel doctor " + str(report.path))


@excel.command()
def upgrade(file: File, interpreter: Interpreter = "", ignore_lock: IgnoreLock = False) -> None:
    """Bring the functions of an .xlsm to this version; it stays as FILE.bak, then .bak2 and so on.

    Its own macros, its sheets and the Python it names stay as they are.

    Example: `torsionbook excel upgrade train.xlsm`
    """
    if file.suffix.lower() != ".xlsm":
        raise typer.BadParameter(f"{file} is no .xlsm. First: torsionbook excel install {file}")
    report = _written(file, None, interpreter, ignore_lock)
    typer.echo(f"written: {report.path}")
    typer.echo(f"as it was: {report.backup}")


@excel.command()
def doctor(file: File) -> None:
    """Check Office, Python, versions, library, folder and blocking, and say what to do.

    Example: `torsionbook excel doctor train.xlsm`
    """
    found = examine(file)
    for check in found:
        typer.echo(f"[{check.state}] {check.what}: {check.found}")
        if check.advice:
            typer.echo(f"    {check.advice}")
    if any(check.state == WRONG for check in found):
        raise typer.Exit(WRONG_INPUT)


def _written(file: Path, target: Path | None, interpreter: str, ignore_lock: bool) -> SaveReport:
    """Write the workbook, or say why not."""
    try:
        return put(file, target, interpreter=interpreter, ignore_lock=ignore_lock)
    except (ExcelError, PackageError, OSError) as wrong:
        raise failed(f"{file}: {wrong}") from wrong
