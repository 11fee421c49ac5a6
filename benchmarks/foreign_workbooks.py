"""Workbooks that other programs wrote, opened and calculated in: `python -m benchmarks.foreign_workbooks FOLDER`.

FOLDER holds workbooks of other libraries' test suites; none is part of this repository. Each is opened and all that a
reading could need is parsed. With ``--calculate``, the sheets of an example are put behind its own and it is
recalculated: parts that hold no written cell, nor a formula on one, must be the same bytes, and every formula that
lost its stored value is named.
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
import traceback
import zipfile
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

from addin.contract.shipped import template_path
from addin.writing.recalculate import recalculate
from addin.xlsx import PackageError, Workbook, open_workbook
from addin.xlsx.added_sheets import save_with_sheets, what_is_in_the_way
from addin.xlsx.errors import WorkbookRefused

EXAMPLE = "example_proposed.xlsx"
#: Parts that change with any calculation: lists of parts, and how the program calculates.
LISTS = ("[Content_Types].xml", "xl/workbook.xml", "xl/_rels/workbook.xml.rels", "xl/calcChain.xml")


def opened(path: Path) -> Workbook:
    """A workbook of which everything is parsed that any reading parses."""
    book = open_workbook(path, read_only=True)
    for sheet in book.sheet_names:
        if book.structure.worksheet_part(sheet) is not None:
            book.sheet_part(sheet)
    assert isinstance(book.tables, dict)
    assert isinstance(book.charts, list)
    return book


def opening(path: Path) -> tuple[str, str]:
    """How the opening of a workbook ends: ``opened``, the reason of the refusal, or ``fault``; and the sentence."""
    try:
        opened(path)
    except WorkbookRefused as refused:
        return refused.reason, refused.message
    except PackageError as wrong:
        return type(wrong).__name__, str(wrong)
    except Exception:
        return "fault", traceback.format_exc()
    return "opened", ""


def calculating(path: Path, folder: Path) -> tuple[str, str]:
    """How a calculation in a workbook ends that got the sheets of the example."""
    merged, done = folder / f"merged{path.suffix}", folder / f"done{path.suffix}"
    book, example = opened(path), opened(template_path(EXAMPLE))
    if obstacles := list(what_is_in_the_way(book, example, example.sheet_names)):
        return "not merged", obstacles[0]
    try:
        save_with_sheets(
            open_workbook(path, ignore_lock=True), example, example.sheet_names, merged
        )
    except PackageError as refused:
        return "not merged", str(refused)
    outcome = recalculate(merged, destination=done)
    if outcome.calculation is None:
        return "not calculated", " ".join(one.message for one in outcome.problems)
    lost = [one for one in outcome.warnings if "no stored value" in one]
    other = list(_other_parts(path, done))
    if other:
        return ("formulas", lost[0]) if lost else ("other parts", ", ".join(other))
    return "calculated", " ".join(lost)


def _other_parts(before: Path, after: Path) -> Iterator[str]:
    """Parts of the file that are others after the calculation."""
    with zipfile.ZipFile(before) as old, zipfile.ZipFile(after) as new:
        names = set(new.namelist())
        for name in old.namelist():
            if name in LISTS or name == "xl/styles.xml" or name.endswith("/"):
                continue
            if name not in names or old.read(name) != new.read(name):
                yield name


def main() -> int:
    """Print one line for each way to end, and each file that did not end well."""
    words = argparse.ArgumentParser(description=__doc__)
    words.add_argument("folder", type=Path)
    words.add_argument("--every", type=int, default=1, help="take one of so many files")
    words.add_argument("--calculate", action="store_true", help="calculate in each, too")
    words.add_argument("--json", type=Path, help="how each file ended")
    given = words.parse_args()
    files = sorted(
        path
        for path in given.folder.rglob("*")
        if path.suffix.lower() in (".xlsx", ".xlsm") and path.is_file()
    )[:: given.every]
    ends: dict[str, tuple[str, str]] = {}
    for path in files:
        how = opening(path)
        if given.calculate and how[0] == "opened":
            with tempfile.TemporaryDirectory() as folder:
                try:
                    how = calculating(path, Path(folder))
                except Exception:
                    how = "fault", traceback.format_exc()
        ends[str(path.relative_to(given.folder))] = how
    for reason, count in Counter(how for how, _ in ends.values()).most_common():
        print(f"{count:6} {reason}")
    for name, (reason, sentence) in ends.items():
        if reason not in ("opened", "calculated"):
            print(f"{name}: {reason}: {sentence}")
    if given.json:
        given.json.write_text(json.dumps(ends, indent=1), encoding="utf-8")
    return int(any(reason == "fault" for reason, _ in ends.values()))


if __name__ == "__main__":
    sys.exit(main())
