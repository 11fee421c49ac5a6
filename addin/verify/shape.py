"""Whether our tables still stand in a workbook as tables, under the headers they were written with."""

from __future__ import annotations

from collections.abc import Iterator

from addin.fields import RESULT_TABLES, WORKBOOK_TABLES, TableSpec
from addin.layout import workbook_columns
from addin.package import Workbook
from addin.package.references import Rect, cell_name
from addin.verify.findings import Finding

__all__ = ["missing_tables"]

#: Headers side by side by which the cells of a table are known again that is a table no more.
_TELLING = 3
_EVERYTHING = Rect(1, 1, 3000, 200)


def missing_tables(workbook: Workbook) -> Iterator[Finding]:
    """Result tables that the workbook has no more, so that nobody can say what stands there.

    Parameters
    ----------
    workbook : Workbook
        As it stands.

    Yields
    ------
    Finding
        One a table. Templates of earlier versions lack tables of `WORKBOOK_TABLES`: these are
        missed only where their headers still stand in cells.
    """
    for spec in (*RESULT_TABLES, *WORKBOOK_TABLES):
        if spec.name in workbook.tables:
            continue
        at = _as_cells(workbook, spec)
        if at is None and spec in WORKBOOK_TABLES:
            continue
        if at is None:
            said = f"the workbook has no table {spec.name}: its results were taken out"
        else:
            said = (
                f"{spec.name} is a range of cells here, no table: nothing in it was compared. Make it "
                f"a table of that name again, or recalculate in a new template"
            )
        yield Finding("table missing", *(at or ("", "")), said, spec.name)


def _as_cells(workbook: Workbook, spec: TableSpec) -> tuple[str, str] | None:
    """Sheet and cell where the headers of a table that is none any more begin."""
    wanted = [plain(field.name) for field in workbook_columns(spec)[:_TELLING]]
    for sheet in workbook.sheet_names:
        if not workbook.sheet_bytes(sheet):
            continue
        part = workbook.sheet_part(sheet)
        inside = [table.ref for table in workbook.tables.values() if table.sheet == sheet]
        for row, column in part.filled_cells(_EVERYTHING):
            if plain(part.constant(row, column)) != wanted[0]:
                continue
            beside = [plain(part.constant(row, column + k)) for k in range(len(wanted))]
            if beside == wanted and not any(ref.has(row, column) for ref in inside):
                return sheet, cell_name(row, column)
    return None


def plain(text: object) -> str:
    """A header without blanks and capitals that nobody sees.

    Parameters
    ----------
    text : object
        What stands in the cell.

    Returns
    -------
    str
        Words in small letters.
    """
    return " ".join(text.split()).casefold() if isinstance(text, str) else ""
