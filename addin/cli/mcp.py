"""`torsionbook mcp`."""

from __future__ import annotations

import importlib.util
from pathlib import Path
from typing import Annotated

import typer

from addin.cli.status import USAGE, failed, failing_on

#: Whether the optional package is there.
INSTALLED = importlib.util.find_spec("mcp") is not None
if INSTALLED:
    from addin.mcp.front import run
    from addin.mcp.places import PlaceRefused, Places


def mcp(
    read: Annotated[
        list[Path] | None,
        typer.Option(
            help="Folder of which workbooks and case JSON may be read; may be repeated.",
            show_default="the working folder",
        ),
    ] = None,
    folder: Annotated[
        Path | None,
        typer.Option(help="The folder where recalculated workbooks may be written, as new files."),
    ] = None,
) -> None:
    """Read, calculate and explain workbooks for an assistant that speaks MCP.

    Speaks the Model Context Protocol on standard input and output. Nothing is written unless --folder is given.

    Example: `torsionbook mcp --read trains --folder results`, as the command of a server in the assistant's settings.
    """
    if not INSTALLED:
        raise failed(
            "The package mcp is not installed. Run pip install -r requirements/mcp.txt in the checkout, or install the "
            "wheel with its extra [mcp].",
            USAGE,
        )
    with failing_on(PlaceRefused, status=USAGE):
        places = Places(read or [Path()], folder)
    run(places)
