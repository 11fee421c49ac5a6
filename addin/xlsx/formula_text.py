"""Which cells a formula reads, and how its references move.

Only what bears on dependence is recognised. Whatever this module does not understand for certain is reported as reading
*everything*, so that a value can be recalculated needlessly but is never left stale.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache

from addin.xlsx.references import MAX_COLUMN, MAX_ROW, column_letters, column_number
from addin.xlsx.values import MAX_FORMULA

_SHEET = r"(?:'(?:[^']|'')+'|[^\W\d][\w.]*(?::[^\W\d][\w.]*)?|\[\d+\][\w. ]*)!"
_CELL = r"\$?[A-Za-z]{1,3}\$?[1-9][0-9]{0,6}"
_COLUMN = r"\$?[A-Za-z]{1,3}"
_ROW = r"\$?[1-9][0-9]{0,6}"
_TOKEN = re.compile(
    rf"""(?P<text>"(?:[^"]|"")*")
    |(?P<error>\#(?:NULL!|DIV/0!|VALUE!|REF!|NAME\?|NUM!|N/A|SPILL!|CALC!|GETTING_DATA))
    |(?P<sheet>{_SHEET})?(?P<ref>{_CELL}:{_CELL}|{_COLUMN}:{_COLUMN}|{_ROW}:{_ROW}|{_CELL})(?![\w(.!\[])
    |(?P<number>(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)
    |(?P<function>[^\W\d][\w.]*)\(
    |(?P<nsheet>{_SHEET})?(?P<name>[^\W\d][\w.\\?]*)(?P<bracket>\[)?
    |(?P<lone>\[)
    """,
    re.VERBOSE,
)
_QUOTED_TEXT = re.compile(r'"[^"]*"')
_CELL_PARTS = re.compile(r"(\$?)([A-Za-z]{1,3})(\$?)([0-9]+)")
_FAR_COLUMN = re.compile(r"[A-Za-z]{3}")
_COLON = ("rest", ":", "")
# What opens or closes in a structured reference; an apostrophe escapes the next character.
_BRACKETS = re.compile(r"'.|[\[\]]", re.DOTALL)

# Functions whose value depends on cells that no reference of the formula names.
READS_ANYTHING = frozenset(
    ["INDIRECT", "OFFSET", "GETPIVOTDATA", "CELL", "INFO", "RTD", "CALL", "EVALUATE", "FORMULATEXT"]
)
# INDIRECT of a cell in a column of the sheet itself: two letters and a whole number make no other address, and no name.
_OWN_COLUMN = re.compile(
    r"""(?<![\w.])(?i:INDIRECT)\(\s*"\$?([A-Za-z]{1,2})\$?"\s*&\s*((?i:ROW)\([^()"]*\)\s*(?:-\s*\d+)?)\s*\)"""
)
# Functions whose value depends on the moment; their cached value is as good as any until somebody recalculates.
CHANGES_BY_ITSELF = frozenset(["NOW", "TODAY", "RAND", "RANDBETWEEN", "RANDARRAY"])
# Functions that may pass over hidden rows.
LOOKS_AT_HIDDEN_ROWS = frozenset(["SUBTOTAL", "AGGREGATE"])


@dataclass(frozen=True, slots=True)
class Reference:
    """A cell range written in a formula."""

    sheet: str  #: Text before the exclamation mark, with it; empty = the formula's own sheet.
    text: str  #: The range as written.


@dataclass(frozen=True, slots=True)
class TableReference:
    """A structured reference; ``table`` is empty when it stands for the table around the formula."""

    table: str
    inside: str


@dataclass(frozen=True, slots=True)
class NameReference:
    """A defined name or a table named without brackets."""

    sheet: str
    name: str


@dataclass(frozen=True, slots=True)
class Span:
    """``A1:INDEX(range, ...)``: cells from one reference to a place within another."""

    start: Reference
    #: What INDEX chooses from; all cells read lie in the rectangle around both.
    within: Reference | TableReference | NameReference


@dataclass(frozen=True, slots=True)
class Parsed:
    """What a formula text refers to."""

    #: In its order; the two ends of a span are not repeated.
    references: tuple[Reference | TableReference | NameReference | Span, ...]
    functions: frozenset[str]  #: Upper case, without ``_xlfn.`` and ``_xlws.``.
    #: Something was not understood, or a function reads cells that are not named: it may read
    #: everything.
    unclear: bool

    @property
    def names(self) -> list[str]:
        """The names that it refers to."""
        ends = [one.within if isinstance(one, Span) else one for one in self.references]
        return [one.name for one in ends if isinstance(one, NameReference)]


_KINDS: dict[str, type[Reference] | type[TableReference] | type[NameReference]] = {
    "cells": Reference,
    "table": TableReference,
    "name": NameReference,
}


#: A piece of a formula as written; of a token its match, whose last group is its kind; of a bracket what it holds, None
#: where it is never closed.
Piece = tuple[str, re.Match[str] | None, str | None]


@lru_cache(maxsize=65_536)
def parse_formula(text: str) -> Parsed:
    """Find the references and functions of a formula."""
    if not is_readable(text):
        return Parsed((), frozenset(), unclear=True)
    text = _OWN_COLUMN.sub(r"SUM($\1:$\1,\2)", text)
    references: list[Reference | TableReference | NameReference | Span] = []
    functions: set[str] = set()
    rest: list[str] = []
    tokens = list(_tokens(text))
    at = 0
    while at < len(tokens):
        kind, first, second = tokens[at]
        at += 1
        if kind == "cells" and tokens[at] == _COLON:
            span = _span(tokens[at - 1 : at + 4])
            if span is not None:
                references.append(span)
                functions.add("INDEX")
                at += 3
                continue
        if kind in _KINDS:
            references.append(_KINDS[kind](first, second))
        elif kind == "function":
            functions.add(first)
        else:
            rest.append(first)
    leftover = "".join(rest)
    # A colon or bracket that is not part of a plain range builds a reference at run time, e.g. A1:CHOOSE(...).
    unclear = any(mark in leftover for mark in ":![]") or not READS_ANYTHING.isdisjoint(functions)
    return Parsed(tuple(references), frozenset(functions), unclear)


def begins_with_own_column(text: str) -> bool:
    """Whether a text begins with INDIRECT of a cell in a column of the sheet itself, such as ``INDIRECT("A"&ROW(B5)-1)``."""
    return _OWN_COLUMN.match(text) is not None


def is_readable(text: str) -> bool:
    """Whether a formula may be cut into tokens: programs take it, and none of its quotes is followed to the end in vain."""
    if len(text) <= 1_000:
        return True
    outside = _QUOTED_TEXT.sub("", text)
    stray = '"' in outside or outside.count("'") % 2 or outside.count("''") > 50
    return len(text) <= MAX_FORMULA and not stray


def _span(tokens: Sequence[tuple[str, str, str]]) -> Span | None:
    """A range that ends in INDEX, if cells and a colon begin one: cells ``:`` INDEX( reference ``,``."""
    if len(tokens) < 5:
        return None
    start, _, function, within, after = tokens
    if function != ("function", "INDEX", ""):
        return None
    # Anything but a comma behind it makes the argument an expression.
    if after[0] != "rest" or not after[1].lstrip().startswith(","):
        return None
    kind = _KINDS.get(within[0])
    return None if kind is None else Span(Reference(*start[1:]), kind(*within[1:]))


def _tokens(text: str) -> Iterator[tuple[str, str, str]]:
    """Tokens as (kind, first, second); what is between them comes as kind ``rest``."""
    position = 0
    while True:
        match = _TOKEN.search(text, position)
        if match is None:
            yield "rest", text[position:], ""
            return
        if match.start() > position:
            yield "rest", text[position : match.start()], ""
        position = match.end()
        kind = match.lastgroup
        if kind == "ref":
            yield from _cell_token(match)
        elif kind == "function":
            yield "function", bare_function(match["function"]), ""
        elif kind in ("bracket", "lone"):
            inside, position = _bracketed(text, position)
            if inside is None:
                # Never closed: the rest is not to be understood, nor to be gone through again from each bracket.
                yield "rest", text[match.start() :], ""
                return
            if match["nsheet"]:
                yield "rest", "!", ""
            else:
                yield "table", match["name"] or "", inside
        elif kind == "name":
            yield "name", match["nsheet"] or "", match["name"]


def _cell_token(match: re.Match[str]) -> Iterator[tuple[str, str, str]]:
    sheet, text = match["sheet"] or "", match["ref"]
    # Every cell has a column of at most two letters, or is looked at.
    parts = _CELL_PARTS.finditer(text) if _FAR_COLUMN.search(text) else ()
    for part in parts:
        if column_number(part[2]) > MAX_COLUMN:
            # XFE1 and beyond are not cells: names may look like that.
            yield "name", sheet, text
            return
    yield "cells", sheet, text


@lru_cache(maxsize=4_096)
def bare_function(name: str) -> str:
    """Name of a function in capitals, without what files of newer functions put before it."""
    bare = name.upper()
    for prefix in ("_XLFN.", "_XLWS.", "_XLUDF."):
        bare = bare.removeprefix(prefix)
    return bare


def _bracketed(text: str, position: int) -> tuple[str | None, int]:
    """Text up to the bracket that closes the one before ``position``; an apostrophe escapes the next character."""
    depth = 1
    for mark in _BRACKETS.finditer(text, position):
        depth += {"[": 1, "]": -1}.get(mark[0], 0)
        if depth == 0:
            return text[position : mark.start()], mark.end()
    return None, position


def shifted_formula(text: str, rows: int, columns: int) -> str:
    """The formula as it reads when filled ``rows`` down and ``columns`` to the right.

    Used to write out shared formulas, which the file states once for the first cell only.
    """
    return "".join(
        (match["sheet"] or "") + shifted_range(match["ref"], rows, columns)
        if match is not None and match.lastgroup == "ref"
        else piece
        for piece, match, _ in pieces(text)
    )


def pieces(text: str) -> Iterator[Piece]:
    """A formula cut into its tokens, and what is before, between and behind them."""
    position = 0
    while (match := _TOKEN.search(text, position)) is not None:
        yield text[position : match.start()], None, None
        position, inside = match.end(), None
        if match.lastgroup in ("bracket", "lone"):
            inside, position = _bracketed(text, position)
            position = len(text) if inside is None else position
        yield text[match.start() : position], match, inside
    yield text[position:], None, None


def shifted_range(text: str, rows: int, columns: int) -> str:
    """A written range moved along its relative parts; ``#REF!`` when it leaves the sheet."""
    ends = [_shifted_end(end, rows, columns) for end in text.split(":")]
    return "#REF!" if None in ends else ":".join(end for end in ends if end)


def _shifted_end(end: str, rows: int, columns: int) -> str | None:
    match = re.fullmatch(r"(\$?)([A-Za-z]*)(\$?)([0-9]*)", end)
    if match is None:
        return None
    mark_column, letters, mark_row, digits = match.groups()
    if not letters:
        # A whole row such as $4: its only dollar sign stands in the first group.
        mark_row, mark_column = mark_column or mark_row, ""
    if letters and not mark_column:
        column = column_number(letters) + columns
        if not 1 <= column <= MAX_COLUMN:
            return None
        letters = column_letters(column)
    if digits and not mark_row:
        row = int(digits) + rows
        if not 1 <= row <= MAX_ROW:
            return None
        digits = str(row)
    return f"{mark_column}{letters}{mark_row}{digits}"
