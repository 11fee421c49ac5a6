"""Workbooks that other programs wrote, opened and calculated in: `python -m benchmarks.foreign_workbooks FOLDER…`.

Each FOLDER holds the workbooks of another library's test suite, in a folder named OWNER+NAME; none is part of this repository. Each is
opened and all that a reading could need is parsed. With ``--calculate``, sheets with inputs, results, charts and formulas are put behind its own
and it is recalculated: parts that hold no formula on a written cell must be the same bytes, in the others nothing
but stored values of formulas may differ, and every value that is removed is named. The sheets are those of a small workbook; of one in
``--example`` files also those of an example. ``--record`` keeps it for docs/safety.md; a run that was stopped goes on where it was (``--state``).
"""

from __future__ import annotations

import argparse
import io
import json
import sys
import tempfile
import traceback
import zipfile
from collections.abc import Iterator
from dataclasses import asdict, dataclass, field
from pathlib import Path

from lxml import etree

from addin.contract.shipped import template_path
from addin.contract.version import product_version
from addin.writing.recalculate import recalculate
from addin.xlsx import PackageError, Workbook, open_workbook
from addin.xlsx.added_sheets import save_with_sheets, what_is_in_the_way
from addin.xlsx.errors import WorkbookRefused
from addin.xlsx.references import parse_cell
from addin.xlsx.xml_part import main as tag

ROOT = Path(__file__).resolve().parents[1]
RECORD = Path(__file__).parent / "records" / "foreign_workbooks.json"
EXAMPLE = "example_proposed.xlsx"
#: Parts that change with any calculation: lists of parts, styles, and how the program calculates. [ends of names in small letters]
LISTS = ("[content_types].xml", "workbook.xml", "workbook.xml.rels", "calcchain.xml", "styles.xml")
#: Cells of a file that are named; all are counted.
NAMED = 12


@dataclass
class End:
    """How one file ended."""

    how: str  #: ``opened``, ``calculated``, ``not merged``, ``not calculated``, ``other parts``, ``fault``, or the reason of the refusal.
    said: str = ""
    removed: int = 0  #: Stored values of its formulas that are not there any more.
    cells: list[str] = field(default_factory=list)  #: The first of them.
    renewed: int = 0  #: Stored values that are others.
    parts: int = 0  #: That are the same bytes.


def opened(path: Path) -> Workbook:
    """A workbook of which everything is parsed that any reading parses."""
    book = open_workbook(path, read_only=True, ignore_lock=True)
    for sheet in book.sheet_names:
        if book.structure.worksheet_part(sheet) is not None:
            book.sheet_part(sheet)
    assert isinstance(book.tables, dict)
    assert isinstance(book.charts, list)
    return book


def ended(path: Path, sheets: Path | None) -> End:
    """How the opening of a workbook ends, and, with sheets of another, the calculation in it."""
    try:
        opened(path)
        if sheets is None:
            return End("opened")
        with tempfile.TemporaryDirectory() as folder:
            return calculated(path, sheets, Path(folder))
    except WorkbookRefused as refused:
        return End(refused.reason, refused.message)
    except PackageError as wrong:
        return End(type(wrong).__name__, str(wrong))
    except Exception:  # noqa: BLE001 - a fault is what the study looks for
        return End("fault", traceback.format_exc())


def calculated(path: Path, sheets: Path, folder: Path) -> End:
    """How a calculation in a workbook ends that got the sheets of another."""
    merged, done = folder / f"merged{path.suffix}", folder / f"done{path.suffix}"
    book, source = opened(path), opened(sheets)
    if obstacles := list(what_is_in_the_way(book, source, source.sheet_names)):
        return End("not merged", obstacles[0])
    try:
        save_with_sheets(open_workbook(path, ignore_lock=True), source, source.sheet_names, merged)
    except PackageError as refused:
        return End("not merged", str(refused))
    outcome = recalculate(merged, destination=done)
    if outcome.calculation is None:
        return End("not calculated", " ".join(one.message for one in outcome.problems))
    return compared(path, done)


def compared(before: Path, after: Path) -> End:
    """What of a file is another after the calculation."""
    end, others = End("calculated"), []
    # a strict one in the dialect in which it is written
    read = io.BytesIO(opened(before).container.data)
    with zipfile.ZipFile(read) as old, zipfile.ZipFile(after) as new:
        names = {name.replace("\\", "/"): name for name in new.namelist()}
        for name in old.namelist():
            at = names.get(name.replace("\\", "/"))
            if name.replace("\\", "/").rpartition("/")[2].lower() in LISTS or name.endswith("/"):
                continue
            if at is None:
                others.append(f"{name} is gone")
            elif (one := old.read(name)) == (other := new.read(at)):
                end.parts += 1
            else:
                others += _values(name, one, other, end)
    if others:
        end.how, end.said = "other parts", "; ".join(others[:NAMED])
    return end


def _values(name: str, before: bytes, after: bytes, end: End) -> Iterator[str]:
    """Differences of a sheet that are no stored values of formulas; those are counted."""
    old, new = (etree.fromstring(data) for data in (before, after))
    if old.tag != tag("worksheet"):
        yield f"{name} is another"
        return
    arrays = [f.get("ref") for f in old.iter(tag("f")) if f.get("t") == "array"]
    pairs = list(zip(old.iter(tag("c")), new.iter(tag("c")), strict=False))
    for one, other in pairs:
        if one.get("r") != other.get("r"):
            break
        if etree.tostring(one) == etree.tostring(other):
            continue
        if one.find(tag("f")) is None and not _in_array(one.get("r"), arrays):
            yield f"{name}: {one.get('r')} is another"
            continue
        had, has = (cell.findtext(tag("v")) is not None for cell in (one, other))
        end.renewed += had and has
        if had and not has:
            end.removed += 1
            if len(end.cells) < NAMED:
                end.cells.append(f"{name.rpartition('/')[2]} {one.get('r')}")
        for cell in (one, other):
            cell.attrib.pop("t", None)
            for value in cell.findall(tag("v")):
                cell.remove(value)
    if etree.tostring(old, method="c14n") != etree.tostring(new, method="c14n"):
        yield f"{name} differs beside the values of its formulas"


def _in_array(cell: str, arrays: list[str]) -> bool:
    """Whether a cell holds a value of an array formula, which stands in the first cell of its range."""
    row, column = parse_cell(cell)
    return any(
        parse_cell(first)[0] <= row <= parse_cell(last or first)[0]
        and parse_cell(first)[1] <= column <= parse_cell(last or first)[1]
        for first, _, last in (one.partition(":") for one in arrays)
    )


def small_workbook(folder: Path) -> Path:
    """Every input table, some results, a chart, names and formulas."""
    from benchmarks.workbook_fuzz import seeds

    path = folder / "small.xlsx"
    path.write_bytes(seeds()[0].data)
    return path


def _files(folder: Path) -> list[Path]:
    return sorted(
        path
        for path in folder.rglob("*")
        if path.suffix.lower() in (".xlsx", ".xlsm") and path.is_file()
    )


def _record(ends: dict[str, End]) -> dict[str, object]:
    """What the page needs."""
    libraries: dict[str, dict[str, int]] = {}
    by_name: dict[str, list[dict[str, object]]] = {"refused": [], "removed": []}
    counts = dict.fromkeys(("parts", "renewed", "removed"), 0)
    for key, end in ends.items():
        library, _, rest = key.partition("/")
        name, _, sheets = rest.rpartition("|")
        row = libraries.setdefault(library.replace("+", "/"), {})
        row[f"{sheets}: {end.how}"] = row.get(f"{sheets}: {end.how}", 0) + 1
        about = {"library": library.replace("+", "/"), "file": name, "sheets": sheets}
        if end.how not in ("opened", "calculated"):
            by_name["refused"].append({**about, "how": end.how, "said": end.said})
        if end.removed:
            by_name["removed"].append({**about, "count": end.removed, "cells": end.cells})
        for what in counts:
            counts[what] += getattr(end, what)
    return {
        "libraries": libraries,
        **counts,
        "by_name": by_name,
        "about": f"torsionbook {product_version()}",
    }


def main() -> int:
    """Print one line for each way to end, and each file that did not end well."""
    words = argparse.ArgumentParser(description=__doc__)
    words.add_argument("folders", type=Path, nargs="+")
    words.add_argument("--every", type=int, default=1, help="take one of so many files")
    words.add_argument("--calculate", action="store_true", help="calculate in each, too")
    words.add_argument(
        "--example",
        type=int,
        default=0,
        help="of one in so many files with the sheets of an example, too",
    )
    words.add_argument("--state", type=Path, help="lines of a run that was stopped, to go on")
    words.add_argument(
        "--record", action="store_true", help=f"keep it in {RECORD.name} and docs/safety.md"
    )
    given = words.parse_args()
    ends: dict[str, End] = {}
    if given.state and given.state.exists():
        for line in given.state.read_text("utf-8").splitlines():
            key, end = json.loads(line)
            ends[key] = End(**end)
    with tempfile.TemporaryDirectory() as place:
        small, example = small_workbook(Path(place)), template_path(EXAMPLE)
        files = [
            (folder, path) for folder in given.folders for path in _files(folder)[:: given.every]
        ]
        todo = [(*one, "small", small if given.calculate else None) for one in files]
        if given.example:
            todo += [(*one, "example", example) for one in files[:: given.example]]
        for folder, path, name, sheets in todo:
            key = f"{folder.name}/{path.relative_to(folder).as_posix()}|{name}"
            if key not in ends:
                ends[key] = ended(path, sheets)
                if given.state:
                    with given.state.open("a", encoding="utf-8") as state:
                        state.write(json.dumps([key, asdict(ends[key])]) + "\n")
    record = _record(ends)
    print(json.dumps(record, indent=1))
    if given.record:
        from benchmarks.safety_page import write_page

        RECORD.write_text(json.dumps(record, indent=1) + "\n", encoding="utf-8")
        write_page()
    return int(any(end.how in ("fault", "other parts") for end in ends.values()))


if __name__ == "__main__":
    sys.exit(main())
