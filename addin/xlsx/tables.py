"""Excel tables: where they stand and the part that describes them.

A table is header row, data rows and, if the user wants one, a totals row. Only the table part is handled here; the cells
belong to the sheet.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import Any

from addin.xlsx.errors import WorkbookMismatch, damaged
from addin.xlsx.references import Rect
from addin.xlsx.sheet_ranges import read_range
from addin.xlsx.values import unescape
from addin.xlsx.xml_part import Element, main

_INNER = re.compile(r"\[((?:[^\[\]']|'.)*)\]")
_QUOTED = re.compile(r"'(.)")


@dataclass(frozen=True)
class Table:
    """An Excel table."""

    name: str  #: The name that formulas use.
    sheet: str  #: Its sheet.
    ref: Rect  #: All of it, header and totals included.
    columns: tuple[str, ...]  #: Column names.
    has_header: bool  #: Whether these rows are there.
    has_totals: bool  #: Likewise.
    calculated: tuple[str | None, ...]  #: Formula of each calculated column.
    part: str  #: Name of its part in the package.

    @cached_property
    def data(self) -> Rect:
        """The data rows."""
        return Rect(
            self.ref.top + self.has_header,
            self.ref.left,
            self.ref.bottom - self.has_totals,
            self.ref.right,
        )

    @property
    def header_row(self) -> int | None:
        """Row of the header, None without one."""
        return self.ref.top if self.has_header else None

    @cached_property
    def columns_at(self) -> dict[str, int]:
        """Column of the sheet that each header stands in, by the header in small letters."""
        return {name.casefold(): self.ref.left + k for k, name in enumerate(self.columns)}

    def column_index(self, name: str) -> int:
        """Position of a column, from 0; spelling in capitals or small letters does not matter.

        Raises
        ------
        WorkbookMismatch
            When there is none of that name.
        """
        at = self.columns_at.get(name.casefold())
        if at is None:
            raise WorkbookMismatch(
                f"Table {self.name} on sheet {self.sheet} has no column {name!r}; it has "
                f"{', '.join(self.columns)}. Restore the column header, or start from a new template."
            )
        return at - self.ref.left

    def resized(self, rows: int) -> Table:
        """The same table with another number of data rows (at least one)."""
        bottom = self.data.top + max(rows, 1) - 1 + self.has_totals
        return replace(self, ref=self.ref.with_bottom(bottom))

    def read_by(self, inside: str, at: Rect) -> Rect:
        """Cells that a structured reference reads, rather too many than too few."""
        if inside not in self._read:
            this_row = not _special_words(inside).isdisjoint(("@", "#this row"))
            self._read[inside] = this_row, self._area(inside)
        this_row, area = self._read[inside]
        if this_row and self.ref.top <= at.top and at.bottom <= self.ref.bottom:
            return Rect(at.top, area.left, at.bottom, area.right)
        return area

    @cached_property
    def _read(self) -> dict[str, tuple[bool, Rect]]:
        """What the references met so far read: a workbook repeats the same few in thousands of formulas."""
        return {}

    def _area(self, inside: str) -> Rect:
        """Cells that a structured reference reads outside the table."""
        columns = _named_columns(inside, self.columns)
        left = self.ref.left + min(columns, default=0)
        right = self.ref.left + max(columns, default=len(self.columns) - 1)
        # Plain columns are data for certain: a totals row that adds them up does not read itself.
        special = _special_words(inside)
        rows = self.ref
        if special <= {"#data"} and self.data.top <= self.data.bottom:
            rows = self.data
        elif special == {"#totals"} and self.has_totals:
            rows = Rect(self.ref.bottom, self.ref.left, self.ref.bottom, self.ref.right)
        return Rect(rows.top, left, rows.bottom, right)


@lru_cache(maxsize=4096)
def _named_columns(inside: str, columns: tuple[str, ...]) -> tuple[int, ...]:
    """Positions of the columns named; empty when any word is not understood, which means all."""
    words = _INNER.findall(inside) or [inside.lstrip("@")]
    positions: list[int] = []
    known = {column.casefold(): index for index, column in enumerate(columns)}
    for word in words:
        name = unescape(_QUOTED.sub(r"\1", word)).strip().casefold()
        if name.startswith("#") and word.startswith("#"):
            continue
        if name not in known:
            return ()
        positions.append(known[name])
    return tuple(positions)


@lru_cache(maxsize=4096)
def _special_words(inside: str) -> frozenset[str]:
    """``#All``, ``#Data`` and the like, in small letters; ``@`` is one of them."""
    words = _INNER.findall(inside) or [inside]
    found = {word.strip().lower() for word in words if word.strip().startswith("#")}
    return frozenset(found | ({"@"} if inside.lstrip().startswith("@") else set()))


def parse_table(root: Element, sheet: str, part: str) -> Table:
    """Read a table part."""
    columns = root.findall(f"{main('tableColumns')}/{main('tableColumn')}")
    formulas = [column.findtext(main("calculatedColumnFormula")) for column in columns]
    name, written = root.get("displayName") or root.get("name"), root.get("ref", "")
    if not name:
        raise damaged(f"A table on sheet {sheet} has no name.")
    ref = read_range(written, f"Table {name[:80]} on sheet {sheet}")
    if len(columns) != ref.width:
        raise damaged(
            f"Table {name[:80]} on sheet {sheet} has {len(columns)} columns but covers {ref}."
        )
    table = Table(
        name=name,
        sheet=sheet,
        ref=ref,
        columns=tuple(unescape(column.get("name", "")) for column in columns),
        has_header=root.get("headerRowCount", "1") != "0",
        has_totals=root.get("totalsRowCount", "0") != "0",
        calculated=tuple(formulas),
        part=part,
    )
    if table.data.height < 1:
        raise damaged(f"Table {name[:80]} on sheet {sheet} covers {ref} and has no data row.")
    return table


def check_places(tables: Sequence[Table]) -> None:
    """Tables must not share a cell: writing one would destroy the other.

    Raises
    ------
    WorkbookRefused
        ``damaged``, for the first two that do.
    """
    above: list[Table] = []
    for table in sorted(tables, key=lambda one: (one.sheet, one.ref.top)):
        above = [
            one for one in above if one.sheet == table.sheet and one.ref.bottom >= table.ref.top
        ]
        for other in above:
            if other.ref.meets(table.ref):
                raise damaged(
                    f"Tables {other.name[:80]} ({other.ref}) and {table.name[:80]} ({table.ref}) on sheet "
                    f"{table.sheet} overlap."
                )
        above.append(table)


def apply_table(root: Element, table: Table, formulas: Mapping[str, str]) -> bool:
    """Put the size and the calculated columns of a table into its part.

    The filter range follows the size. Filter criteria and sort order are taken out: they described the old rows, and a
    stale filter would hide new ones.
    """
    root.set("ref", str(table.ref))
    root.attrib.pop("insertRow", None)
    root.attrib.pop("insertRowShift", None)
    had_criteria = _reset_filter(root, table)
    columns = root.findall(f"{main('tableColumns')}/{main('tableColumn')}")
    for name, text in formulas.items():
        _set_column_formula(columns[table.column_index(name)], text)
    return had_criteria


def _reset_filter(root: Element, table: Table) -> bool:
    had_criteria = False
    auto_filter = root.find(main("autoFilter"))
    if auto_filter is not None:
        auto_filter.set("ref", str(table.ref.with_bottom(table.data.bottom)))
        for column in auto_filter.findall(main("filterColumn")):
            # A filterColumn that only hides the button carries no criteria and stays.
            if len(column):
                auto_filter.remove(column)
                had_criteria = True
    for holder in (root, auto_filter):
        for sort_state in () if holder is None else holder.findall(main("sortState")):
            holder.remove(sort_state)
    return had_criteria


def _set_column_formula(column: Any, text: str) -> None:
    formula = column.find(main("calculatedColumnFormula"))
    if formula is None:
        formula = column.makeelement(main("calculatedColumnFormula"))
        # The schema wants it first.
        column.insert(0, formula)
    formula.attrib.pop("array", None)
    text = text.strip().removeprefix("=")
    if formula.text != text:
        formula.text = text
