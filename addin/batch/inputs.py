"""Folders, patterns and files → what is to be calculated, in natural order."""

from __future__ import annotations

import contextlib
import glob
import json
import os
import re
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import takewhile
from pathlib import Path

from addin.batch.own_files import is_case, is_result_json
from addin.writing.history_file import KINDS, history_stems
from addin.xlsx.places import real_path, refuse_no_end

#: Endings that are looked for in folders; .xls and .xlsb are refused with the reason, not passed over.
ENDINGS = (".xlsx", ".xlsm", ".xls", ".xlsb", ".json")
#: Ends of the names of files that torsionbook itself writes beside inputs.
OURS = (".out.xlsx", ".out.xlsm", ".accuracy.xlsx", ".accuracy.xlsm", ".results.json", ".accuracy.json")  # fmt: skip
#: Folder of a batch inside that of its results, and the usual name of its summary there.
OWN, SUMMARY = ".torsionbook-batch", "summary.xlsx"
#: A JSON file is looked into up to this size to see whether it is a case. [bytes]
_LOOKED_INTO = 4 * 2**20
_DIGITS = re.compile(r"(\d+)")


class InputsRefused(Exception):
    """Nothing can be calculated as asked; the sentence says why."""


@dataclass(frozen=True)
class Input:
    """One file to calculate."""

    path: Path  #: The file.
    name: str  #: Its path relative to where the batch begins, with ``/``; results get the same.
    #: Name of its histories before ``.history``, where that of its result is another's too.
    history: str = ""


def find_inputs(
    patterns: Sequence[str], out: Path, also_ours: Iterable[Path] = (), *, json: bool = False
) -> list[Input]:
    """Everything that folders, patterns and names stand for.

    A folder stands for the workbooks and case JSON files in it and below. Left out are the folder of
    results, hidden files, lock files (``~$…``), copies (``.bak``) and files that torsionbook wrote.

    Raises
    ------
    InputsRefused
        If a pattern finds nothing, or two files would have the same results.
    """
    ours = {real_path(path) for path in also_ours}
    results = real_path(out)
    roots: dict[Path, Path] = {}  # file → where its relative path begins
    for pattern in patterns:
        some = passed_over = False
        for path, root in _expanded(pattern):
            place = real_path(path)
            if place in ours or results in place.parents:
                passed_over = True
                continue
            some = True
            roots.setdefault(Path(os.path.abspath(path)), root)
        if not some:
            raise InputsRefused(_in_results(pattern, out) if passed_over else _nothing(pattern))
    return _named(roots, json)


def _in_results(pattern: str, out: Path) -> str:
    return (
        f"Everything under {pattern} is in {out}, the results folder, where no inputs are "
        "read. Name another folder with --out."
    )


def _nothing(pattern: str) -> str:
    if not glob.has_magic(pattern) and not Path(pattern).exists():
        return f"There is no file or folder {pattern}. Check the path."
    if Path(pattern).is_dir():
        return (
            f"The folder {pattern} contains no workbook (.xlsx, .xlsm) and no case JSON to "
            "calculate; result files do not count. Name another."
        )
    return f"No file matches {pattern}. Check the path; put a pattern in quotes."


def _expanded(pattern: str) -> Iterator[tuple[Path, Path]]:
    """Files of one word of the command line, each with the folder its name is relative to."""
    path = Path(pattern)
    if path.is_dir():
        for place, folders, files in os.walk(path):
            summary = SUMMARY if OWN in folders else None  # of an earlier batch that wrote there
            folders[:] = [name for name in folders if not name.startswith((".", "__pycache__"))]
            for name in files:
                file = Path(place, name)
                if name != summary and _is_input(file):
                    yield file, path
    elif path.exists() or (not glob.has_magic(pattern) and path.suffix.lower() in ENDINGS):
        yield path, path.parent
    elif not glob.has_magic(pattern):
        return  # no file, and no name of one: most often a folder mistyped
    else:
        root = _fixed_part(path)
        for hit in glob.glob(pattern, recursive=True):
            file = Path(hit)
            if file.is_file() and _is_input(file):
                yield file, root


def _fixed_part(pattern: Path) -> Path:
    """The folders of a pattern before its first wildcard."""
    return Path(*takewhile(lambda part: not glob.has_magic(part), pattern.parts[:-1]))


def _is_input(file: Path) -> bool:
    """Whether a file that was found, not named, is meant."""
    name = file.name.lower()
    if name.startswith(("~$", ".")) or name.endswith((*OURS, ".bak", ".tmp")):
        return False
    if file.suffix.lower() not in ENDINGS:
        return False
    return file.suffix.lower() != ".json" or _may_be_case(file)


def _may_be_case(file: Path) -> bool:
    """Whether a JSON file is a case: one that holds something else is passed over, a broken one not."""
    try:
        refuse_no_end(file)
        if file.stat().st_size > _LOOKED_INTO:
            return True
        content = json.loads(file.read_text(encoding="utf-8-sig"))
    except (OSError, ValueError, RecursionError):
        return True
    return is_case(content)


def _named(roots: dict[Path, Path], json: bool) -> list[Input]:
    """Names relative to each root; where two meet, relative to what all files have in common."""
    names = {path: _relative(path, root) for path, root in roots.items()}
    if _clash(names, json) is not None:
        with contextlib.suppress(ValueError):  # several drives
            common = Path(os.path.commonpath([str(path.parent) for path in roots]))
            names = {path: _relative(path, common) for path in roots}
    clash = _clash(names, json)
    if clash is not None:
        raise InputsRefused(
            f"{clash[0]} and {clash[1]} would both be written to {clash[2]}. "
            "Rename one, or calculate them in two batches."
        )
    stems = history_stems(map(result_name, names.values()))
    inputs = (Input(path, name, _own_stem(name, stems)) for path, name in names.items())
    return sorted(inputs, key=lambda file: natural_key(file.name))


def _own_stem(name: str, stems: Mapping[str, str]) -> str:
    """The name of its histories, where it is that of the whole result."""
    result = result_name(name)
    return Path(result).name if stems[result] == result and Path(result).suffix else ""


def _relative(path: Path, root: Path) -> str:
    return Path(os.path.relpath(path, os.path.abspath(root))).as_posix()


def _clash(names: dict[Path, str], json: bool) -> tuple[Path, Path, str] | None:
    """Two files with the same results, capitals aside: not every disk tells them apart."""
    seen: dict[str, Path] = {}
    for path, name in names.items():
        for result in (result_name(name), *((json_name(name),) if json else ())):
            other = seen.setdefault(result.casefold(), path)
            if other != path:
                return other, path, result
    return None


def results_of(file: Input) -> tuple[str, ...]:
    """Names that results of a file may have in the folder of results."""
    result = Path(result_name(file.name))
    stem = file.history or result.stem
    beside = (result.with_name(f"{stem}.history.{kind}") for kind in KINDS)
    return tuple(place.as_posix() for place in (result, *beside))


def check_places(
    inputs: Sequence[Input], out: Path, json: Path | None = None, summary: Path | None = None
) -> None:
    """Refuse results that would land on an input, on the summary or on somebody's own JSON, before any work.

    Raises
    ------
    InputsRefused
        If two files would have the same place, or a file there is none of ours; the sentence says what
        to do.
    """
    sources: dict[str, list[Path]] = defaultdict(list)
    for file in inputs:
        for place in {file.path, real_path(file.path)}:
            sources[_key(place)].append(file.path)
    ours = {_key(place) for place in (() if summary is None else summary_files(summary))}
    for file in inputs:
        places = [(out / name, "--out") for name in results_of(file)]
        if json is not None:
            places.append((json / json_name(file.name), "--json"))
        for place, option in places:
            key = _key(place)
            if any(_is_same(place, source) for source in sources.get(key, ())):
                raise InputsRefused(
                    f"Results of {file.path} would overwrite the input {place}. Name another folder with "
                    f"{option}."
                )
            if key in ours:
                raise InputsRefused(
                    f"Results of {file.path} and the summary of the batch would both be written to "
                    f"{place}. Name another place for the summary with --summary."
                )
            if place.suffix == ".json" and os.path.isfile(place) and not is_result_json(place):
                raise InputsRefused(
                    f"{place} exists and was not written by torsionbook: results of {file.path} would "
                    f"replace it. Rename it, or name another folder with {option}."
                )


def summary_files(summary: Path) -> tuple[Path, Path]:
    """The workbook of a summary and the CSV beside it."""
    return summary, summary.with_suffix(".csv")


def _key(place: Path) -> str:
    """A place by its name in its real folder, capitals aside: not every disk tells them apart."""
    return str(real_path(place.parent) / place.name).casefold()


def _is_same(place: Path, source: Path) -> bool:
    """Whether two places that differ in capitals at most are one on this disk."""
    if real_path(place.parent) / place.name in (
        real_path(source.parent) / source.name,
        real_path(source),
    ):
        return True
    try:
        return place.samefile(source)
    except OSError:
        return False


def result_name(name: str) -> str:
    """Name of the results of a file, as `torsionbook recalc --out` would give it."""
    if name.lower().endswith(".json"):
        return name[: -len(".json")] + ".results.json"
    return name


def json_name(name: str) -> str:
    """Name of the results of a file as JSON, as `torsionbook recalc --json FOLDER` would give it."""
    folder, slash, last = name.rpartition("/")
    return f"{folder}{slash}{Path(last).stem}.results.json"


def natural_key(name: str) -> tuple[tuple[int, int, str], ...]:
    """Sorts ``train 9`` before ``train 10``."""
    return tuple(
        (0, int(part), "") if part.isdigit() and part.isascii() else (1, 0, part.casefold())
        for part in _DIGITS.split(name)
        if part
    )
