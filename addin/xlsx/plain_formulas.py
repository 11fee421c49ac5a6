"""Formulas with cells in the place of parts of tables.

``Table[Column]`` means the cells ``Sheet!$A$5:$A$20`` until the table changes its size. The calculator takes 256 columns of
tables in all, and not every spelling of their parts; written with cells, a formula needs no table. One of which it is not
certain what it means gets no text: it may read anything, and it is not calculated.
"""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Collection, Iterable, Sequence
from dataclasses import replace
from typing import NamedTuple

from addin.xlsx.formula_text import (
    Piece,
    bare_function,
    begins_with_own_column,
    is_readable,
    parse_formula,
    pieces,
)
from addin.xlsx.references import Rect, absolute_range, column_letters, quoted_sheet
from addin.xlsx.tables import Table
from addin.xlsx.workbook_part import DefinedName

# They take a text for a reference or a reference for its text, hence they could tell a table from its cells.
_READS_TEXT = frozenset(["INDIRECT", "EVALUATE", "FORMULATEXT"])


class Home(NamedTuple):
    """Where a formula stands."""

    sheet: str
    #: The cells of its result; of a shared formula the cell that states it, and the cell to which it is filled.
    rects: tuple[Rect, ...]


class PlainFormulas:
    """Writes formulas of a workbook without its tables.

    Parameters
    ----------
    names : sequence of DefinedName
        All defined names, local ones too.
    tables : iterable of Table
        All tables, with the size that they have now.

    Attributes
    ----------
    names : list of DefinedName
        The names written so; those whose meaning is not certain, or is that of such a name, have no text.
    """

    def __init__(self, names: Sequence[DefinedName], tables: Iterable[Table]) -> None:
        self._tables = {table.name.lower(): table for table in tables}
        self._names = {name.name.lower() for name in names}
        self._unclear: Collection[str] = frozenset()
        texts = [self.text(name.text) or "" for name in names]
        self._unclear = _with_users(names, texts)
        self.names = [
            replace(name, text="" if name.name.lower() in self._unclear else text)
            for name, text in zip(names, texts, strict=True)
        ]

    def text(self, text: str, home: Home | None = None) -> str | None:
        """A formula without tables; None where it is not certain what it means.

        Parameters
        ----------
        text : str
            The formula.
        home : Home, optional
            Where it stands; left out for what a name stands for.
        """
        if not is_readable(text) and (self._tables or "[" in text):
            return None
        if "[" not in text:
            parsed = parse_formula(text)
            names = {name.lower() for name in parsed.names}
            if (
                parsed.functions.isdisjoint(_READS_TEXT)
                and names.isdisjoint(self._tables)
                and names.isdisjoint(self._unclear)
            ):
                return text
        written = list(pieces(text))
        plain: list[str] = []
        for at, (piece, match, inside) in enumerate(written):
            kind = None if match is None else match.lastgroup
            one: str | None = piece
            if match is None:
                pass
            elif kind in ("name", "bracket", "lone"):
                one = self._named(piece, match, inside, home)
            elif kind == "function" and not self._sees_no_table(match["function"], written, at):
                one = None
            if one is None:
                return None
            plain.append(one)
        return "".join(plain)

    def _named(
        self, piece: str, match: re.Match[str], inside: str | None, home: Home | None
    ) -> str | None:
        """A name or a part of a table without tables."""
        name = (match["name"] or "").lower()
        if match.lastgroup == "name" and name not in self._tables:
            return None if name in self._unclear else piece
        # A defined name may be meant, or a table of another workbook, or the bracket is never closed.
        if name in self._names or match["nsheet"] or (inside is None and match.lastgroup != "name"):
            return None
        return self._cells(name, inside or "", home)

    def _sees_no_table(self, function: str, written: Sequence[Piece], at: int) -> bool:
        """Whether the function of a piece gives the same with tables and with their cells."""
        function = bare_function(function)
        if function not in _READS_TEXT or not self._tables:
            return True
        if function != "INDIRECT" or len(written) < at + 4:
            return False
        if begins_with_own_column("".join(piece for piece, _, _ in written[at:])):
            return True
        # Only words that stand in the formula itself tell what they lead to.
        (before, _, _), (words, match, _), (after, _, _) = written[at + 1 : at + 4]
        if match is None or match.lastgroup != "text" or before.strip():
            return False
        words = words[1:-1].replace('""', '"')
        return after.lstrip()[:1] in (")", ",") and self.text(words) == words

    def _cells(self, name: str, inside: str, home: Home | None) -> str | None:
        """Cells of a part of a table; without a name, of the table around the formula."""
        table = self._tables.get(name) if name else self._around(home)
        if table is None:
            return None
        sheet, rects = home or ("", ())
        is_beside = table.sheet == sheet
        rows = [rect.top if is_beside and rect.height == 1 else None for rect in rects] or [None]
        parts = [table.cells_of(inside, row) for row in rows]
        if None in parts or parts[0] is None:
            return None
        area, is_row_of_formula = parts[0]
        cells = absolute_range(area)
        if is_row_of_formula:
            # Filled down, it means the rows below.
            ends = dict.fromkeys([area.left, area.right])
            cells = ":".join(f"${column_letters(column)}{area.top}" for column in ends)
        return cells if is_beside else f"{quoted_sheet(table.sheet)}!{cells}"

    def _around(self, home: Home | None) -> Table | None:
        """The table that a formula stands in."""
        if home is None:
            return None
        tables = (table for table in self._tables.values() if table.sheet == home.sheet)
        return next((t for t in tables if all(t.ref.meets(rect) for rect in home.rects)), None)


def _with_users(names: Sequence[DefinedName], texts: Sequence[str]) -> set[str]:
    """Names without a text, and those that refer to them, directly or through others; in small letters."""
    users: dict[str, set[str]] = defaultdict(set)
    for name in names:
        for used in parse_formula(name.text).names:
            users[used.lower()].add(name.name.lower())
    found: set[str] = set()
    wave = {name.name.lower() for name, text in zip(names, texts, strict=True) if not text}
    while wave:
        found |= wave
        wave = {user for one in wave for user in users[one]} - found
    return found
