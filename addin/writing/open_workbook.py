"""What a recalculation has written, as rectangles for the same workbook open in a spreadsheet program.

A copy of the open workbook goes the way of every workbook (`addin.writing.recalculate`); what that wrote into the
copy is what the fronts write into the open one: result cells alone, and tables in their new size.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from addin.xlsx import ErrorValue, Formula, Table, Workbook
from addin.xlsx.references import Rect


@dataclass(frozen=True)
class WrittenResults:
    """What shall stand in the result cells."""

    #: Sheet, rectangle and its rows, in the order they were written.
    blocks: tuple[tuple[str, Rect, Sequence[Sequence[Any]]], ...]
    tables: tuple[Table, ...]  #: Result tables with the size they have then.

    @property
    def cells(self) -> int:
        """How many cells that are."""
        return sum(rect.width * rect.height for _, rect, _ in self.blocks)


def written_results(workbook: Workbook) -> WrittenResults:
    """What was written into a workbook."""
    blocks = tuple(
        (sheet, block.rect, tuple(block.grid))
        for sheet, written in workbook.written.items()
        for block in written
    )
    tables = tuple(
        table
        for table in workbook.tables.values()
        if any(sheet == table.sheet and rect.meets(table.ref) for sheet, rect, _ in blocks)
    )
    return WrittenResults(blocks, tables)


def rows_of(
    rows: Sequence[Sequence[Any]], rect: Rect, top: int, bottom: int
) -> list[list[str | bool | float | None]]:
    """Rows of a rectangle as Excel takes them; what was not given is blank.

    Parameters
    ----------
    rows : sequence of sequence
        Rows of the rectangle from its top. [shown units]
    rect : Rect
        The rectangle.
    top, bottom : int
        First and last row wanted. [row of the sheet]
    """
    cells = []
    for number in range(top - rect.top, bottom - rect.top + 1):
        row = list(rows[number]) if number < len(rows) else []
        cells.append([excel_value(v) for v in row + [None] * (rect.width - len(row))])
    return cells


@dataclass(frozen=True)
class Resizing:
    """What a table needs beside its new size."""

    cleared: tuple[Rect, ...]  #: Result cells of rows no longer used, to be emptied before.
    first: Rect | None  #: First row of data where rows are added, whose formats they get.
    added: Rect | None  #: The added rows.


def resizing(table: Table, before: Rect, results: WrittenResults) -> Resizing:
    """What a table of the open workbook needs beside its new size.

    Parameters
    ----------
    table : Table
        With its new size.
    before : Rect
        Its size in the open workbook.
    results : WrittenResults
        All that is written.

    Raises
    ------
    ValueError
        If the open workbook has it at another position.
    """
    if (before.top, before.left) != (table.ref.top, table.ref.left):
        raise ValueError(f"table {table.name} has another position in Excel than in the saved copy")
    old, new = before.bottom - table.has_totals, table.data.bottom
    if old > new:
        pieces = sorted(_written_columns(table, results))
        return Resizing(tuple(Rect(new + 1, a, old, b) for a, b in pieces), None, None)
    if old == new:
        return Resizing((), None, None)
    top, left, right = table.data.top, table.ref.left, table.ref.right
    return Resizing((), Rect(top, left, top, right), Rect(old + 1, left, new, right))


def _written_columns(table: Table, results: WrittenResults) -> set[tuple[int, int]]:
    """First and last column of each piece of a table that results stand in."""
    return {
        (max(rect.left, table.ref.left), min(rect.right, table.ref.right))
        for sheet, rect, _ in results.blocks
        if sheet == table.sheet and rect.meets(table.data)
    }


def excel_value(value: Any) -> str | bool | float | None:
    """A cell as it is handed to Excel.

    Excel reads a text that comes from a program as if it had been typed: ``3-4`` would become a
    date and ``=...`` a formula. A leading apostrophe, which is not part of the text, prevents it.

    Parameters
    ----------
    value : None, bool, int, float, str, ErrorValue or Formula
        As it was written into the copy. [shown units]

    Returns
    -------
    None, bool, float or str
        Formulas begin with ``=``. [shown units]
    """
    if isinstance(value, Formula):
        return "=" + value.text.replace("_xlfn._xlws.", "").replace("_xlfn.", "")
    if isinstance(value, ErrorValue):
        return value.code
    if value == "":
        return None
    if isinstance(value, str):
        plain = value[:1].isalpha() and not any(sign.isdigit() for sign in value)
        return value if plain and value.casefold() not in ("true", "false") else f"'{value}"
    return value if value is None or isinstance(value, bool) else float(value)


def rectangles(results: WrittenResults, before: Mapping[str, Rect]) -> dict[str, Any]:
    """All of it as plain values, sheet by sheet, for a front that only carries it.

    Parameters
    ----------
    results : WrittenResults
        What was written into the copy.
    before : mapping of str to Rect
        Size of each table in the copy before.

    Returns
    -------
    dict
        ``cells``, their number; ``sheets``, each with its name, ``tables`` (name, ``before``, ``after``, and
        ``first`` and ``added`` where rows are added), ``cleared``, and ``blocks`` of ``at`` and ``rows``. A
        blank is an empty text: in Office.js None leaves a cell as it is. [addresses, shown units]
    """
    sheets: dict[str, dict[str, Any]] = {}

    def of(sheet: str) -> dict[str, Any]:
        empty: dict[str, Any] = {"name": sheet, "tables": [], "cleared": [], "blocks": []}
        return sheets.setdefault(sheet, empty)

    for table in results.tables:
        needed = resizing(table, before[table.name], results)
        place = {"before": str(before[table.name]), "after": str(table.ref)}
        if needed.added is not None:
            place |= {"first": str(needed.first), "added": str(needed.added)}
        of(table.sheet)["tables"].append({"name": table.name, **place})
        of(table.sheet)["cleared"] += map(str, needed.cleared)
    for sheet, rect, rows in results.blocks:
        cells = rows_of(rows, rect, rect.top, rect.bottom)
        blanks = [["" if value is None else value for value in row] for row in cells]
        of(sheet)["blocks"].append({"at": str(rect), "rows": blanks})
    return {"cells": results.cells, "sheets": list(sheets.values())}
