"""What commands print: tables, written files, progress, problems, refusals."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from addin.batch.own_files import is_case
from addin.cli.status import WRONG_INPUT, failed
from addin.contract.problems import CellProblem
from addin.reading.one_file import WORKBOOK_ENDINGS, Unreadable, file_problem, read_checked
from addin.reading.typed_case import CaseInput
from addin.xlsx.errors import PackageError
from addin.xlsx.places import has_no_end, real_path, refuse_strange_name

if TYPE_CHECKING:
    from rich.console import Console
    from rich.table import Table

#: A table on the terminal is at least so wide. [characters]
TABLE_WIDTH = 110
#: More than a table needs. [characters]
_ANY_WIDTH = 10**7


def refuse_clashes(
    files: Sequence[Path], targets: Sequence[tuple[Path | None, Path | None]], in_place: bool
) -> None:
    """Refuse two results with one name, and a result on top of its input, before any work.

    Raises
    ------
    typer.BadParameter
        With the sentence.
    """
    seen: dict[Path, Path] = {}
    sources = {real_path(file) for file in files}
    for file, some in zip(files, targets, strict=True):
        for target in filter(None, some):
            place = real_path(target)
            if place in sources and not in_place:
                raise typer.BadParameter(
                    f"{target} is one of the inputs. Choose another folder, or use --in-place."
                )
            if seen.setdefault(place, file) != file:
                raise typer.BadParameter(
                    f"{seen[place]} and {file} would both be written to {target}."
                )


def refuse_no_place(target: Path) -> None:
    """Refuse a result that no file could be, before the work that would be lost.

    Parameters
    ----------
    target : Path
        File to be written. [path]

    Raises
    ------
    typer.BadParameter
        With the sentence.
    """
    refuse_no_name(target)
    if target.is_dir():
        raise typer.BadParameter(f"{target} is a folder; name a file in it.")
    refuse_no_folder(target.parent)


def refuse_no_name(target: Path) -> None:
    """Refuse a device or a pipe and, on Windows, a name that no file can have.

    Raises
    ------
    typer.BadParameter
        With the sentence.
    """
    try:
        refuse_strange_name(target)
    except OSError as wrong:
        raise typer.BadParameter(f"{target} {wrong.strerror}. Choose another name.") from None
    if has_no_end(target):
        raise typer.BadParameter(f"{target} is a device or a pipe; name a file.")


def refuse_no_json(target: Path, ending: str = ".json", *, for_case: bool = False) -> None:
    """As `refuse_no_place`, of a JSON (or other data) that would replace a workbook, a document or, unless it is one, a case."""
    if target.suffix.lower() in WORKBOOK_ENDINGS:
        raise typer.BadParameter(f"{target} is the name of a workbook; end it in {ending}.")
    refuse_no_place(target)
    if target.is_file() and _is_office_file(target):
        raise typer.BadParameter(f"{target} is a workbook or a document. Choose another name.")
    if ending == ".json" and target.is_file():
        _refuse_unknown_json(target, for_case=for_case)


def _refuse_unknown_json(target: Path, *, for_case: bool) -> None:
    """Refuse to replace what is no JSON, such as a case with a slip in it, or a case by something else; an empty file is neither."""
    try:
        text = target.read_text(encoding="utf-8-sig").strip()
        holds_case = is_case(json.loads(text)) if text else False
    except OSError:
        return  # said when it is written
    except (ValueError, RecursionError):
        raise typer.BadParameter(
            f"{target} is there and is no JSON: it is not replaced. Choose another name."
        ) from None
    if holds_case and not for_case:
        raise typer.BadParameter(f"{target} holds a case: it is not replaced. Choose another name.")


def _is_office_file(path: Path) -> bool:
    """Whether it begins as the files of Office do, old (compound files) and new (zip)."""
    try:
        with open(path, "rb") as file:
            return file.read(4) in (b"PK\3\4", b"\xd0\xcf\x11\xe0")
    except OSError:
        return False  # said when it is written


def refuse_no_folder(folder: Path) -> None:
    """Refuse a folder for results that is a file, or lies in one, before any work.

    Parameters
    ----------
    folder : Path
        There or still to be made. [path]

    Raises
    ------
    typer.BadParameter
        With the sentence.
    """
    for place in (folder, *folder.parents):
        if place.exists() and not place.is_dir():
            raise typer.BadParameter(f"{place} is a file; name a folder.")


def result_place(out: Path, name: str, several: bool = False) -> Path:
    """Where a result goes: into a folder, or the file that ``--out`` names.

    Parameters
    ----------
    out : Path
        What was typed: a folder, or a file by its ending. [path]
    name : str
        Name of the result in a folder.
    several : bool
        Whether results of several inputs go there.

    Raises
    ------
    typer.BadParameter
        For a file where several results need a folder, or one of another type.
    """
    if out.is_dir() or out.suffix.lower() not in (*WORKBOOK_ENDINGS, ".json"):
        return out / name
    if several:
        raise typer.BadParameter(
            f"{out} is the name of one file; for several inputs, name a folder."
        )
    ending = Path(name).suffix
    if out.suffix.lower() != ending.lower():
        raise typer.BadParameter(f"{out} must end in {ending}, as the result is such a file.")
    return out


def study_targets(
    file: Path, command: str, out: Path | None, json: Path | None, in_place: bool
) -> tuple[Path | None, Path | None]:
    """Where a study of one input is written.

    Returns
    -------
    destination, json : Path or None
        Files; None = the default beside the input, and no JSON. [paths]

    Raises
    ------
    typer.BadParameter
        If options exclude each other or a result would lie on the input.
    """
    if out is not None and in_place:
        raise typer.BadParameter("Use either --out or --in-place, not both.")
    destination = None if out is None else result_place(out, file.name)
    if json is not None and (json.is_dir() or json == out):
        json = json / f"{file.stem}.{command}.json"
    refuse_clashes([file], [(destination, json)], in_place)
    if destination is not None:
        refuse_no_place(destination)
    if json is not None:
        refuse_no_json(json)
    return destination, json


def read_or_stop(file: Path) -> CaseInput:
    """The inputs of a file; the command ends if they have errors.

    Raises
    ------
    typer.Exit
        Every error has been printed.
    """
    read = read_checked(file)
    if isinstance(read, Unreadable) or read.problems:
        list_problems(file, read.problems)
        raise typer.Exit(WRONG_INPUT)
    return read


def refuse_existing(target: Path, force: bool) -> None:
    """End the command if a file is there already and may not be replaced, or has no folder."""
    refuse_no_name(target)
    if target.exists() and not force:
        raise failed(f"{target} exists. Choose another name, or use --force to replace it.")
    if not target.parent.is_dir():
        raise failed(f"The folder {target.parent} does not exist. Create it first.")


@contextmanager
def writing(place: Path) -> Iterator[None]:
    """End the command with a sentence if a file cannot be written."""
    try:
        yield
    except OSError as wrong:
        raise failed(file_problem(place, wrong).message) from wrong
    except PackageError as wrong:  # it may name a file on the way to the place
        raise failed(f"{place}: {wrong}") from wrong


def print_written(paths: Iterable[Path | str]) -> None:
    """The files that a command has written."""
    for path in paths:
        typer.echo(f"written: {path}")


def stages_of(file: Path, tell: Callable[[str], None]) -> Callable[[str], None]:
    """What takes the stages of the calculation of a file, and shows them with its name."""
    return lambda stage: tell(f"{file.name}: {stage}")


@contextmanager
def progress() -> Iterator[Callable[[str], None]]:
    """A line that says what is being done, where somebody watches."""
    if not sys.stderr.isatty():
        yield lambda _: None
        return
    from rich.text import Text

    with plain_console(stderr=True).status("starting") as status:
        yield lambda stage: status.update(Text(stage))


def list_problems(
    file: Path, problems: Sequence[CellProblem], something_written: bool = False
) -> None:
    """Everything wrong with an input, for the error stream."""
    if not problems:
        return
    plural = "s" if len(problems) > 1 else ""
    what = "" if something_written else ", nothing was calculated or written"
    typer.echo(f"{file}: {len(problems)} error{plural}{what}:", err=True)
    for problem in problems:
        typer.echo(f"  {problem.message}", err=True)


def print_table(columns: Sequence[tuple[str, str]], rows: Iterable[Sequence[str]]) -> None:
    """A table of text; a column of names is not broken, one of numbers stands to the right."""
    from rich.table import Table

    table = Table(show_edge=False, pad_edge=False)
    for header, kind in columns:
        table.add_column(
            header, no_wrap=kind == "name", justify="right" if kind == "number" else "left"
        )
    for row in rows:
        table.add_row(*row)
    show_table(table, TABLE_WIDTH)


def plain_console(*, stderr: bool = False, width: int | None = None) -> Console:
    """A console that prints what stands in brackets or between colons as it is: names have both."""
    from rich.console import Console

    return Console(stderr=stderr, width=width, markup=False, emoji=False)


def show_table(table: Table, width: int) -> None:
    """Print a table as wide as the terminal, at least so wide, and so wide that no word is cut. [characters]"""
    needed = plain_console(width=_ANY_WIDTH).measure(table).minimum
    plain_console(width=max(plain_console().width, width, needed)).print(table)
