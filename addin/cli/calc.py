"""``torsionbook calc``: the worksheet functions in LibreOffice Calc."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from addin.cli.options import ForceOption
from addin.cli.status import failed
from addin.cli.terminal import refuse_no_name
from addin.libreoffice.oxt import extension, worker_command
from addin.xlsx.whole_files import write_whole

calc = typer.Typer(
    name="calc",
    no_args_is_help=True,
    rich_markup_mode="markdown",
    help=(
        "Worksheet functions in LibreOffice Calc.\n\n"
        "`torsionbook calc install` writes torsionbook.oxt, an extension to be added to "
        "LibreOffice."
    ),
)


@calc.callback()
def _group() -> None:
    """See the help of `calc`."""


@calc.command()
def install(
    to: Annotated[Path, typer.Option("--to", help="The .oxt file to write.")] = Path(
        "torsionbook.oxt"
    ),
    force: ForceOption = False,
) -> None:
    """Write the extension for LibreOffice and say how to add it.

    The path of this Python goes into it: it is for this computer, and for this installation.

    Example: `torsionbook calc install --to torsionbook.oxt`
    """
    if to.suffix.lower() != ".oxt":
        raise typer.BadParameter(f"'{to}' must end in .oxt.")
    refuse_no_name(to)
    if to.exists() and not force:
        raise failed(f"{to} exists. Name another with --to, or use --force.")

    try:
        content = extension(worker_command())
        write_whole(to, lambda made: made.write_bytes(content))
    except OSError as wrong:
        raise failed(f"{to}: {wrong.strerror or wrong}. Nothing was written.") from wrong
    typer.echo(f"written: {to}")
    typer.echo(
        "In LibreOffice choose Tools, Extensions (Extension Manager), Add; select this file; "
        "restart LibreOffice."
    )
    typer.echo(f"Alternatively, with LibreOffice closed: unopkg add --force {to}")
