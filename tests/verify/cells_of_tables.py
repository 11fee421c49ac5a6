"""Where the cells of a table stand, for the tests of this room."""

from __future__ import annotations

from addin.xlsx import Workbook
from addin.xlsx.references import cell_name


def cell_of(workbook: Workbook, table: str, row: int, column: str) -> tuple[str, str]:
    """Sheet and cell of a table's data row, counted from 1."""
    found = workbook.table(table)
    at = found.ref.left + found.column_index(column)
    return found.sheet, cell_name(found.data.top + row - 1, at)


def unit_cell_of(workbook: Workbook, table: str, column: str) -> tuple[str, str]:
    """Sheet and cell of a column's unit."""
    found = workbook.table(table)
    at = found.ref.left + found.column_index(column)
    return found.sheet, cell_name(found.ref.top - 1, at)
