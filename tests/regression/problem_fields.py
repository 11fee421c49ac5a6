"""What bad inputs are told: the fields of every problem, as recorded in `problems.json`.

`bad_inputs.json` holds the inputs: changes of one good case, raw texts, and cells of shipped
workbooks. The record was made by the tree that is the reference, in which

    .venv/bin/python tests/regression/problem_fields.py problems.json

was run; it is made again only where a problem is meant to be another one.
"""

from __future__ import annotations

import io
import json
import sys
import tempfile
from collections.abc import Iterator
from copy import deepcopy
from functools import cache
from pathlib import Path
from typing import Any

import openpyxl
from openpyxl.workbook.defined_name import DefinedName

from addin.reading.one_file import read_checked
from addin.studies.registry import of_studies

HERE = Path(__file__).resolve().parent
TEMPLATES = HERE.parents[1] / "templates"
#: Fields of a problem that stay; its message is not among them.
FIELDS = ("sheet", "table", "row", "column", "found", "allowed")
#: Sheets of results: no input is read from them, and to open and save them takes most of the time.
RESULTS = {"Summary", "Results", "Start", "Effects and accuracy", "Audit", "Notes", "ChartData"}


@cache
def _content() -> dict[str, Any]:
    """All of `bad_inputs.json`."""
    return json.loads((HERE / "bad_inputs.json").read_text(encoding="utf-8"))


def bad_inputs(kind: str | None = None) -> Iterator[tuple[str, str, dict[str, Any]]]:
    """Kind (case, study, text or workbook), name and description of every bad input."""
    content = _content()
    for one in ("case", "study", "text", "workbook") if kind is None else (kind,):
        for number, description in enumerate(content[one], start=1):
            yield one, f"{one} {number}: {description['name']}", description


def base_case() -> dict[str, Any]:
    """The good case that the others are changes of."""
    return _content()["base"]


def written(kind: str, description: dict[str, Any], folder: Path) -> Path:
    """A bad input as a file."""
    if kind == "workbook":
        path = folder / "case.xlsx"
        _workbook(description).save(path)
        return path
    path = folder / "case.json"
    if kind == "text":
        text = description["text"]
        if isinstance(text, dict):
            text = text["repeat"] * text["times"]
    else:
        text = json.dumps(changed(base_case(), description["changes"]))
    path.write_text(text, encoding="utf-8")
    return path


def changed(case: dict[str, Any], changes: list[list[Any]]) -> dict[str, Any]:
    """A case with `table/row/key` or `key` set, or taken out where the value is null; `table/+` adds a row."""
    case = deepcopy(case)
    for place, value in changes:
        if isinstance(value, dict) and "repeat" in value:
            value = [value["repeat"]] * value["times"]
        table, _, rest = place.partition("/")
        if not rest:
            holder: Any = case
            key: Any = place
        elif rest == "+":
            case.setdefault(table, []).append(value)
            continue
        elif "/" not in rest:
            del case[table][int(rest) - 1]
            continue
        else:
            row, _, key = rest.partition("/")
            holder = case[table][int(row) - 1]
        if value is None:
            holder.pop(key, None)
        else:
            holder[key] = value
    return case


@cache
def _inputs_of(template: str) -> bytes:
    """A shipped workbook without its sheets of results."""
    book = openpyxl.load_workbook(TEMPLATES / template)
    for sheet in book.worksheets:
        if sheet.title in RESULTS:
            book.remove(sheet)
    target = io.BytesIO()
    book.save(target)
    return target.getvalue()


def _workbook(description: dict[str, Any]) -> openpyxl.Workbook:
    """The inputs of a shipped workbook with cells, units (@), headers, names, tables or sheets changed."""
    book = openpyxl.load_workbook(io.BytesIO(_inputs_of(description["template"])))
    for place, value in description["cells"].items():
        cell = _cell(book, place)
        if isinstance(value, dict):
            cell.value, cell.number_format = value["value"], value["format"]
        else:
            cell.value = value
    for place, header in description.get("headers", {}).items():
        table, column = place.split("/")
        sheet, _, at = _column(book, table, column)
        sheet.cell(*at).value = header
        next(c for c in sheet.tables[table].tableColumns if c.name == column).name = header
    for merge in description.get("merges", ()):
        table, rows, column = merge.split("/")
        sheet, _, (top, at) = _column(book, table, column)
        first, last = map(int, rows.split("-"))
        sheet.merge_cells(start_row=top + first, end_row=top + last, start_column=at, end_column=at)
    for old, new in description.get("tables", {}).items():
        sheet = next(ws for ws in book.worksheets if old in ws.tables)
        table = sheet.tables.pop(old)
        table.name = table.displayName = new
        sheet.tables[new] = table
    for old, new in description.get("names", {}).items():
        name = book.defined_names.pop(old)
        if new == "#REF!":
            book.defined_names[old] = DefinedName(old, attr_text="#REF!")
        elif new is not None:
            book.defined_names[new] = DefinedName(new, attr_text=name.attr_text)
    for old, new in description.get("sheets", {}).items():
        book[old].title = new
    return book


def _cell(book: openpyxl.Workbook, place: str) -> Any:
    """`Name`, `@Name` for its unit, `Table/row/Column`, `@Table/Column` for the unit of a column."""
    is_unit, place = place.startswith("@"), place.removeprefix("@")
    if "/" not in place:
        ((sheet, cell),) = book.defined_names[place].destinations
        found = book[sheet][cell.replace("$", "")]
        return book[sheet].cell(found.row, found.column + 1) if is_unit else found
    if is_unit:
        table, column = place.split("/")
        sheet, _, (row, at) = _column(book, table, column)
        return sheet.cell(row - 1, at)
    table, number, column = place.split("/")
    sheet, _, (row, at) = _column(book, table, column)
    return sheet.cell(row + int(number), at)


def _column(book: openpyxl.Workbook, table: str, column: str) -> tuple[Any, Any, tuple[int, int]]:
    """Sheet and table, and row and column of a header."""
    sheet = next(ws for ws in book.worksheets if table in ws.tables)
    header = next(iter(sheet[sheet.tables[table].ref]))
    at = next(cell for cell in header if cell.value == column)
    return sheet, sheet.tables[table], (at.row, at.column)


def fields_of(path: Path) -> list[list[Any]]:
    """The fields of every problem of an input and of its study tables."""
    read = read_checked(path)
    problems = [problem.as_json() for problem in (*read.problems, *of_studies(read))]
    told = []
    for problem in problems:
        assert problem["message"]
        told.append([problem[field] for field in FIELDS])
    return told


def record(target: Path) -> None:
    """Write the fields of all bad inputs."""
    told = {}
    with tempfile.TemporaryDirectory() as folder:
        for kind, name, description in bad_inputs():
            told[name] = fields_of(written(kind, description, Path(folder)))
            # the name of a file that cannot be read at all is told too: it is not the same twice
            told[name] = json.loads(json.dumps(told[name]).replace(folder, "."))
    lines = [
        f" {json.dumps(name, ensure_ascii=False)}: ["
        + ",".join(f"\n  {json.dumps(row, ensure_ascii=False)}" for row in rows)
        + "]"
        for name, rows in told.items()
    ]
    target.write_text("{\n" + ",\n".join(lines) + "\n}\n", encoding="utf-8")


if __name__ == "__main__":
    record(Path(sys.argv[1]))
