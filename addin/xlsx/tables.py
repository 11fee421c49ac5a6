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

from lxml import etree

from addin.xlsx.errors import WorkbookMismatch, damaged
from addin.xlsx.references import Rect
from addin.xlsx.sheet_ranges import read_range
from addin.xlsx.values import unescape
from addin.xlsx.xml_part import Element, main, parse_part, serialise

# What is kept of tables of earlier workbooks, which those of one template share: so many, none longer.
_MOST_KEPT = 1024
_LONG_PART = 2**14
_QUOTED = re.compile(r"'(.)", re.DOTALL)
_ALL, _DATA, _HEADERS, _TOTALS, _THIS_ROW = (
    frozenset([word]) for word in ("#all", "#data", "#headers", "#totals", "#this row")
)
# A column begins with no number sign: that of a header is escaped by an apostrophe, as brackets in it are.
_WORD = r"\[(\s*\#(?:all|data|headers|totals|this\ row)\s*)\]"
_COLUMN = r"\[((?!\s*\#)(?:[^\[\]']|'.)+)\]"
# Behind a word some programs leave out the brackets of a column.
_PART = re.compile(
    rf"""(?:{_WORD}(?:\s*,\s*{_WORD})?(?:\s*,\s*(?=\S)|$))?
    (?:{_COLUMN}(?:\s*:\s*{_COLUMN})?|((?!\#)(?:[^\[\]':]|'.)+))?""",
    re.VERBOSE | re.IGNORECASE | re.DOTALL,
)


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

    @cached_property
    def _columns_in_small_letters(self) -> tuple[str, ...]:
        return tuple(name.casefold() for name in self.columns)

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

    def cells_of(self, inside: str, row: int | None) -> tuple[Rect, bool] | None:
        """Cells that a structured reference means, and whether they are those of the row of its formula.

        Parameters
        ----------
        inside : str
            What stands between the brackets of the table; empty for its name alone.
        row : int or None
            Row of the formula; None for one that stands in no row of the sheet of the table.

        Returns
        -------
        tuple of (Rect, bool), or None
            None where words, columns or rows are not there for certain.
        """
        if inside not in self._parts:
            self._parts[inside] = self._part(inside)
        part = self._parts[inside]
        if part is None:
            return None
        words, left, right = part
        is_this_row = words == _THIS_ROW
        if not is_this_row:
            rows = self._rows.get(words)
        else:
            rows = None if row is None or not self.data.has(row, left) else (row, row)
        return None if rows is None else (Rect(rows[0], left, rows[1], right), is_this_row)

    @cached_property
    def _parts(self) -> dict[str, tuple[frozenset[str], int, int] | None]:
        """What the references met so far mean: a workbook repeats the same few in many formulas."""
        return {}

    def _part(self, inside: str) -> tuple[frozenset[str], int, int] | None:
        """The words of a structured reference, its first and its last column."""
        found = _PART.fullmatch(_as_list(inside))
        if found is None:
            return None
        words = frozenset(word.strip().lower() for word in found.group(1, 2) if word)
        ends = [self._column_named(name) for name in found.group(3, 4, 5) if name]
        columns = [at for at in ends if at is not None]
        if len(columns) < len(ends):
            return None
        left, right = min(columns, default=self.ref.left), max(columns, default=self.ref.right)
        return words, left, right

    def _column_named(self, written: str) -> int | None:
        """Column of the sheet of which a formula writes the header; None where that is not certain."""
        name = unescape(_QUOTED.sub(r"\1", written))
        for wanted in (name, name.strip()):
            for headers, one in (
                (self.columns, wanted),
                (self._columns_in_small_letters, wanted.casefold()),
            ):
                if headers.count(one) == 1:
                    return self.ref.left + headers.index(one)
        return None

    @cached_property
    def _rows(self) -> dict[frozenset[str], tuple[int, int]]:
        """First and last row that the words of a structured reference mean, other than this row."""
        ref, data = self.ref, self.data
        rows = {_ALL: (ref.top, ref.bottom), _DATA: (data.top, data.bottom)}
        rows[frozenset()] = rows[_DATA]
        if self.has_header:
            rows |= {_HEADERS: (ref.top, ref.top), _HEADERS | _DATA: (ref.top, data.bottom)}
        if self.has_totals:
            rows |= {_TOTALS: (ref.bottom, ref.bottom), _DATA | _TOTALS: (data.top, ref.bottom)}
        return rows


def _as_list(inside: str) -> str:
    """A structured reference with each of its words and columns in brackets, ``@`` as the word that it stands for."""
    text = inside.strip()
    columns = text.removeprefix("@").lstrip()
    if columns and not columns.startswith("["):
        columns = f"[{columns}]"
    if not text.startswith("@"):
        return columns
    return f"[#This Row],{columns}" if columns else "[#This Row]"


def stored_table(data: bytes, sheet: str, part: str) -> Table:
    """The table of a part as stored."""
    if len(data) > _LONG_PART:
        return _parsed_table(parse_part(data, part), sheet, part)
    return replace(
        _known_table(data, sheet, part)
    )  # what it finds of itself ends with its workbook


@lru_cache(maxsize=_MOST_KEPT)
def _known_table(data: bytes, sheet: str, part: str) -> Table:
    return _parsed_table(parse_part(data, part), sheet, part)


def _parsed_table(root: Element, sheet: str, part: str) -> Table:
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


def with_table(data: bytes, table: Table, formulas: Mapping[str, str]) -> tuple[bytes, bool]:
    """A part with the size and the calculated columns of its table, and whether filter criteria were taken out.

    The filter range follows the size. Filter criteria and sort order are taken out: they described the old rows, and a
    stale filter would hide new ones. A part that says all this already is left as it is, to the byte.
    """
    change = _with_table if len(data) > _LONG_PART else _known_change
    return change(data, table, tuple(formulas.items()))


def _with_table(
    data: bytes, table: Table, formulas: tuple[tuple[str, str], ...]
) -> tuple[bytes, bool]:
    root = parse_part(data, table.part)
    before = etree.tostring(root)
    had_criteria = _apply_table(root, table, dict(formulas))
    return (data if etree.tostring(root) == before else serialise(root, data)), had_criteria


_known_change = lru_cache(maxsize=_MOST_KEPT)(_with_table)


def _apply_table(root: Element, table: Table, formulas: Mapping[str, str]) -> bool:
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
