"""What of a sheet is printed: the parts of it that have something to show, each on pages of its own."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

from addin.contract.sheet import ALWAYS, NEVER, Sheet, column_letters, column_number
from addin.contract.studies.registry import EVERY_CHART
from addin.contract.tables import EVERY_INPUT, table

#: First and last row, first and last column of an area, counted from 1.
Area = tuple[int, int, int, int]


@dataclass(frozen=True)
class Standing:
    """What stands on the sheets of a workbook."""

    #: Name of a table → its header row and its last row; None where it is not in the columns of its part.
    rows: Callable[[str], tuple[int, int] | None]
    filled_to: Callable[[str], int]  #: The last row of a table that holds something; 0 = none.
    has_content: Callable[[str], bool]  #: Whether a table holds something.
    has_curve: Callable[[str], bool]  #: Whether a chart, by its name, has something to draw.


def printed_areas(part: Sheet, standing: Standing) -> list[Area] | None:
    """The areas of a part that are printed, from left to right.

    Parameters
    ----------
    part : Sheet
        The part of a sheet, or a sheet of one part.
    standing : Standing
        What stands there.

    Returns
    -------
    list of tuple of int, or None
        No area where there is nothing to show; None where a table of the part was moved away, so that nobody but
        the engineer knows what belongs together.
    """
    last = column_number(part.last)
    rows = {
        name: standing.rows(name)
        for name, cell in part.tables.items()
        if column_number(cell.rstrip("0123456789")) <= last  # others stand beside the pages
    }
    if None in rows.values():
        return None
    charts = [at for at in part.charts if standing.has_curve(at.name)]
    filled = [name for name in rows if standing.has_content(name)]
    if part.printed_for == NEVER:
        return []
    if part.printed_for != ALWAYS:
        wanted = part.printed_for or (
            *part.tables,
            *(t for at in part.charts for t in tables_of_chart(at.name)),
        )
        if not any(map(standing.has_content, wanted)):
            return []
    inserted = max((_inserted(part, name, at[0]) for name, at in rows.items() if at), default=0)
    ends = [part.print_to + inserted]
    inputs = {name for name in rows if table(name) in EVERY_INPUT}
    is_form = inputs.isdisjoint(
        filled
    )  # nobody has typed anything: all rows, to be filled in by hand
    for name, at in rows.items():
        if at is None:
            continue
        if name in inputs:
            ends.append(at[1] if is_form else standing.filled_to(name))
        elif name in filled:
            ends.append(min(at[1], at[0] + (part.rows_printed or at[1])))
    ends += [
        _row(at.cell) + math.ceil(at.height / (part.row_height * 4.0 / 3.0)) + inserted
        for at in charts
    ]
    if not max(ends):
        return []
    breaks = [row for row in part.row_breaks if row <= max(ends)]
    tops = [part.print_from, *breaks]
    bottoms = [*(top - 1 for top in breaks), max(ends)]
    return [
        (top, first, bottom, last)
        for first, last in page_columns(part)
        for top, bottom in zip(tops, bottoms, strict=True)
    ]


def areas_of_parts(
    parts: Sequence[Sheet], standing: Callable[[Sheet], Standing]
) -> list[Area] | None:
    """The areas of the parts of a sheet, from left to right; a part that joins the one left of it widens its area."""
    every: list[Area] = []
    for part in parts:
        areas = printed_areas(part, standing(part))
        if areas is None:
            return None
        for area in areas:
            if part.joins and every and every[-1][3] == area[1] - 1:
                top, left, bottom, _ = every.pop()
                every.append((min(top, area[0]), left, max(bottom, area[2]), area[3]))
            else:
                every.append(area)
    return every


def columns_of_areas(parts: Sequence[Sheet]) -> set[tuple[int, int]]:
    """First and last column of every area that the parts of a sheet may have. [count]"""
    columns: set[tuple[int, int]] = set()
    before: tuple[int, int] | None = None
    for part in parts:
        own = page_columns(part)
        columns.update(own)
        if part.joins and before is not None:
            own = [(before[0], own[0][1])]
            columns.update(own)
        before = own[-1]
    return columns


def page_columns(part: Sheet) -> list[tuple[int, int]]:
    """First and last column of each page of a part, counted from 1. [count]"""
    edges = [1, *(column_number(letters) for letters in part.breaks)]
    lasts = [*(edge - 1 for edge in edges[1:]), column_number(part.last)]
    return [
        (part.shift + first, part.shift + last) for first, last in zip(edges, lasts, strict=True)
    ]


def print_area_text(sheet: str, areas: Sequence[Area]) -> str:
    """The print area of a sheet, as its defined name holds it; an empty cell where nothing is printed."""
    quoted = "'" + sheet.replace("'", "''") + "'"
    corners = [
        f"{quoted}!${column_letters(left)}${top}:${column_letters(right)}${bottom}"
        for top, left, bottom, right in areas
    ]
    return ",".join(corners) or f"{quoted}!$A$1"


def holds_data(rows: Iterable[Sequence[object]]) -> bool:
    """Whether the data of a chart hold a number."""
    return any(isinstance(value, int | float) for row in rows for value in row)


def tables_of_chart(chart: str) -> set[str]:
    """Tables that a chart draws."""
    return {series.table for series in EVERY_CHART[chart].series}


def _row(cell: str) -> int:
    return int(cell.lstrip("ABCDEFGHIJKLMNOPQRSTUVWXYZ"))


def _inserted(part: Sheet, name: str, header: int) -> int:
    """Rows that the engineer has inserted above a table. [count]"""
    units = any(field.has_unit for field in table(name).workbook_columns)
    return header - _row(part.tables[name]) - (2 if units else 1)
