"""What commands tell in the terminal: progress, problems, refusals."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

import typer

if TYPE_CHECKING:
    from collections.abc import Callable

    from addin.problems import CellProblem

__all__ = ["Refused", "list_problems", "progress", "refuse_clashes"]


class Refused(Exception):
    """An input or a file that cannot be used; the sentence is all there is to say."""


def refuse_clashes(
    files: Sequence[Path], targets: Sequence[tuple[Path | None, Path | None]], in_place: bool
) -> None:
    """Refuse two results with one name, and a result on top of its input, before any work.

    Parameters
    ----------
    files : sequence of Path
        Inputs. [paths]
    targets : sequence of (Path or None, Path or None)
        Workbook and JSON of each. [paths]
    in_place : bool
        Whether the input itself is written. [flag]

    Raises
    ------
    typer.BadParameter
        With the sentence.
    """
    seen: dict[Path, Path] = {}
    sources = {file.resolve() for file in files}
    for file, some in zip(files, targets, strict=True):
        for target in some:
            if target is None:
                continue
            place = target.resolve()
            if place in sources and not in_place:
                raise typer.BadParameter(
                    f"{target} is an input itself. Choose another folder, or say --in-place."
                )
            if seen.setdefault(place, file) != file:
                raise typer.BadParameter(
                    f"{seen[place]} and {file} would both be written to {target}."
                )


@contextmanager
def progress() -> Iterator[Callable[[str], None]]:
    """A line that says what is being done, where somebody watches; a rare long wait is always told.

    Yields
    ------
    callable
        Takes what is being done. [text]
    """
    from addin.recalc import is_compiling

    told: set[str] = set()

    def rare(text: str) -> None:
        stage = text.rpartition(": ")[2]
        if is_compiling(stage) and stage not in told:
            told.add(stage)
            typer.echo(f"{text} …", err=True)

    if not sys.stderr.isatty():
        yield rare
        return
    from rich.console import Console

    with Console(stderr=True).status("starting") as status:

        def tell(text: str) -> None:
            rare(text)
            status.update(text)

        yield tell


def list_problems(
    file: Path, problems: Sequence[CellProblem], something_written: bool = False
) -> None:
    """Everything wrong with an input, for the error stream.

    Parameters
    ----------
    file : Path
        The input. [path]
    problems : sequence of CellProblem
        What is wrong.
    something_written : bool, optional
        Whether some of its results are written all the same. [flag]
    """
    if not problems:
        return
    plural = "s" if len(problems) > 1 else ""
    what = "" if something_written else ", nothing was calculated or written"
    typer.echo(f"{file}: {len(problems)} error{plural}{what}:", err=True)
    for problem in problems:
        typer.echo(f"  {problem.message}", err=True)
