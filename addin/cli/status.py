"""How a command ends: the exit statuses, and the refusal of an input or a file."""

from __future__ import annotations

import typer

DONE, WRONG_INPUT, USAGE, INTERNAL = 0, 1, 2, 3
#: After Ctrl-C, as shells have it; what was done is kept.
INTERRUPTED = 130


def failed(sentence: str) -> typer.Exit:
    """Print why a command fails, for the error stream; the exit is to be raised."""
    typer.echo(sentence, err=True)
    return typer.Exit(WRONG_INPUT)
