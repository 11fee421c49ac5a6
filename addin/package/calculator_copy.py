"""The copy of a workbook that goes to the calculator: what it refuses or needs not is left out.

formualizer refuses a workbook in which a cell of a calculated column holds a value (people type over such cells), one
that states too small an extent of a sheet (some programs do), and one whose tables have more than 256 columns together.
And it reads all cells, where histories take longer than everything else. Hence column formulas and extents are taken out,
and on sheets without formulas the tables and the last rows that no formula reads.
"""

from __future__ import annotations

import re
from collections.abc import Collection
from typing import TYPE_CHECKING

from .references import Rect
from .tables import Table

if TYPE_CHECKING:
    from .workbook import Workbook

# Attributes hold no bracket: a search that passed over one could be led on to the end of the part each time.
_ROW = re.compile(rb'<((?:\w+:)?)row\b[^<>]*?\br="([0-9]{1,7})"')
_DIMENSION = re.compile(rb"<(?:\w+:)?dimension\b[^<>]*/>")
_TABLE_PARTS = re.compile(
    rb"<((?:\w+:)?)tableParts\b[^<>]*>(.*?)</(?:\w+:)?tableParts\s*>", re.DOTALL
)
_TABLE_PART = re.compile(rb"""<(?:\w+:)?tablePart\b[^<>]*?\bid=["']([^"']*)["'][^<>]*/>""")
_TABLE_FORMULA = re.compile(
    rb"<((?:\w+:)?(?:calculatedColumnFormula|totalsRowFormula))\b[^<>]*(?:/>|>[^<]*</\1>)"
)
_TOTALS_FUNCTION = re.compile(rb"""\stotalsRowFunction=(?:"[^"]*"|'[^']*')""")


def calculator_copy(
    workbook: Workbook, with_formulas: Collection[str], read: Collection[tuple[str, Rect]] | None
) -> tuple[dict[str, bytes], set[str]]:
    """Parts of the copy that differ from the file as it was opened.

    Parameters
    ----------
    workbook : Workbook
        The workbook, with the cells that were written.
    with_formulas : collection of str
        Sheets that hold formulas.
    read : collection of (str, Rect) or None
        What formulas read; None when some formula may read anything.

    Returns
    -------
    replaced : dict of str to bytes
        Parts with another content.
    dropped : set of str
        Parts left out.
    """
    parts = workbook.changed_parts()
    unread = [] if read is None else _unread_tables(workbook, with_formulas, read)
    dropped = {table.part for table in unread}
    kept = [table for table in workbook.tables.values() if table.part not in dropped]
    for table in kept:
        data = parts.get(table.part) or workbook.container.read(table.part)
        parts[table.part] = _TOTALS_FUNCTION.sub(b"", _TABLE_FORMULA.sub(b"", data))
    needed = [*(read or ()), *((table.sheet, table.ref) for table in kept)]
    for sheet in workbook.sheet_names:
        part = workbook.structure.worksheet_part(sheet)
        if part is None:
            continue
        data = parts.get(part) or workbook.container.read(part)
        if read is not None and sheet not in with_formulas:
            last = max((rect.bottom for one, rect in needed if one == sheet), default=0)
            data = _without_rows_below(data, last)
        if any(table.sheet == sheet for table in unread):
            ids, relationships = workbook.structure.without_relationships(part, dropped)
            data = _without_table_parts(data, ids)
            parts |= relationships
        stated = _DIMENSION.search(data, 0, data.find(b"sheetData"))
        parts[part] = data[: stated.start()] + data[stated.end() :] if stated else data
    parts |= workbook.structure.as_plain_workbook(without=dropped)
    return {name: data for name, data in parts.items() if name not in dropped}, dropped


def _unread_tables(
    workbook: Workbook, with_formulas: Collection[str], read: Collection[tuple[str, Rect]]
) -> list[Table]:
    """Tables on sheets without formulas that no formula reads and no defined name mentions."""
    names = [name.text.casefold() for name in workbook.structure.names]
    return [
        table
        for table in workbook.tables.values()
        if table.sheet not in with_formulas
        and not any(sheet == table.sheet and rect.meets(table.ref) for sheet, rect in read)
        and not any(table.name.casefold() in text for text in names)
        # A table of a query leads to further parts.
        and not workbook.structure.relationships(table.part)
    ]


def _without_rows_below(data: bytes, last: int) -> bytes:
    for row in _ROW.finditer(data):
        if int(row[2]) > last:
            end = data.rfind(b"</%ssheetData" % row[1])
            return data[: row.start()] + data[end:] if end >= 0 else data
    return data


def _without_table_parts(data: bytes, ids: Collection[str]) -> bytes:
    """A sheet without its links to some tables."""
    found = _TABLE_PARTS.search(data)
    if found is None:
        return data
    prefix = found[1]
    kept = [one[0] for one in _TABLE_PART.finditer(found[2]) if one[1].decode() not in ids]
    text = b'<%stableParts count="%d">%s</%stableParts>' % (
        prefix,
        len(kept),
        b"".join(kept),
        prefix,
    )
    return data[: found.start()] + (text if kept else b"") + data[found.end() :]
