"""How a command ends: the exit statuses, and the refusal of an input or a file."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import typer

DONE, WRONG_INPUT, USAGE, INTERNAL = 0, 1, 2, 3
#: After Ctrl-C, as shells have it; what was done is kept.
INTERRUPTED = 130


def failed(sentence: str, status: int = WRONG_INPUT) -> typer.Exit:
    """Print why a command fails, for the error stream; the exit is to be raised."""
    typer.echo(sentence, err=True)
    return typer.Exit(status)


@contextmanager
def failing_on(
    *kinds: type[Exception], about: object = "", status: int = WRONG_INPUT
) -> Iterator[None]:
    """End the command with the sentence of an exception of one of these kinds."""
    try:
        yield
    except kinds as wrong:
        raise failed(f"{about}: {wrong}" if about else str(wrong), status) from wrong
