"""A1 references: cells, rectangles, and what stands before the exclamation mark.

Rows and columns count from 1 as on the sheet; all bounds are inclusive.
"""

from __future__ import annotations

import re
from functools import cache, lru_cache
from typing import NamedTuple

MAX_ROW = 1_048_576
MAX_COLUMN = 16_384

_CELL = re.compile(r"\$?([A-Za-z]{1,3})\$?([1-9][0-9]{0,6})")
_PLAIN_SHEET = re.compile(r"[^\W\d][\w.]*")


class Rect(NamedTuple):
    """A rectangle of cells, bounds inclusive."""

    top: int
    left: int
    bottom: int
    right: int

    @property
    def height(self) -> int:
        """Number of rows."""
        return self.bottom - self.top + 1

    @property
    def width(self) -> int:
        """Number of columns."""
        return self.right - self.left + 1

    @property
    def is_single(self) -> bool:
        """Whether it is one cell."""
        return self.top == self.bottom and self.left == self.right

    def meets(self, other: Rect) -> bool:
        """Whether the two share a cell."""
        return (
            self.top <= other.bottom
            and other.top <= self.bottom
            and self.left <= other.right
            and other.left <= self.right
        )

    def covers(self, other: Rect) -> bool:
        """Whether ``other`` lies wholly inside."""
        return (
            self.top <= other.top
            and other.bottom <= self.bottom
            and self.left <= other.left
            and other.right <= self.right
        )

    def has(self, row: int, column: int) -> bool:
        """Whether the cell lies inside."""
        return self.top <= row <= self.bottom and self.left <= column <= self.right

    def join(self, other: Rect) -> Rect:
        """The smallest rectangle around both."""
        return Rect(
            min(self.top, other.top),
            min(self.left, other.left),
            max(self.bottom, other.bottom),
            max(self.right, other.right),
        )

    def with_bottom(self, bottom: int) -> Rect:
        """The same columns and first row, another last row."""
        return Rect(self.top, self.left, bottom, self.right)

    def __str__(self) -> str:
        first = cell_name(self.top, self.left)
        return first if self.is_single else f"{first}:{cell_name(self.bottom, self.right)}"


@cache
def column_number(letters: str) -> int:
    """Number of a column from its letters.

    >>> column_number("AA")
    27
    """
    if not (letters.isascii() and letters.isalpha() and len(letters) <= 3):
        raise ValueError(f"{letters!r} are not column letters")
    number = 0
    for letter in letters.upper():
        number = number * 26 + ord(letter) - 64
    return number


@cache
def column_letters(number: int) -> str:
    """Letters of a column from its number.

    >>> column_letters(27)
    'AA'
    """
    letters = ""
    while number:
        number, rest = divmod(number - 1, 26)
        letters = chr(65 + rest) + letters
    return letters


def cell_name(row: int, column: int) -> str:
    """Name of a cell, e.g. ``"B4"`` for row 4, column 2."""
    return f"{column_letters(column)}{row}"


# Names of charts, formulas and tables are asked for again and again, in one workbook as in the next.
@lru_cache(maxsize=16_384)
def parse_cell(name: str) -> tuple[int, int]:
    """Row and column of a cell name; dollar signs are ignored.

    Raises
    ------
    ValueError
        When it is not the name of a cell of a sheet.
    """
    match = _CELL.fullmatch(name)
    if match is None:
        raise ValueError(f"{name!r} is not the name of a cell")
    column, row = column_number(match.group(1)), int(match.group(2))
    if row > MAX_ROW or column > MAX_COLUMN:
        raise ValueError(f"{name!r} is outside the sheet")
    return row, column


@lru_cache(maxsize=16_384)
def whole_number(text: str | None, largest: int = MAX_ROW) -> int | None:
    """A number of the file as it is in an attribute; None for anything but ASCII digits up to a limit."""
    if text is None or not (text.isascii() and text.isdigit()) or len(text) > 9:
        return None
    number = int(text)
    return number if number <= largest else None


@lru_cache(maxsize=16_384)
def parse_range(name: str) -> Rect:
    """Rectangle of ``"B4"``, ``"$B$4:$D$9"``, ``"B:D"`` or ``"4:9"``.

    Raises
    ------
    ValueError
        When it is none of these.
    """
    first, _, last = name.partition(":")
    last = last or first
    if ":" in name:
        bare_first, bare_last = first.replace("$", ""), last.replace("$", "")
        if bare_first.isdigit() and bare_last.isdigit():
            top, bottom = whole_number(bare_first), whole_number(bare_last)
            if top is None or bottom is None:
                raise ValueError(f"{name!r} is outside the sheet")
            return _ordered(top, 1, bottom, MAX_COLUMN)
        if bare_first.isalpha() and bare_last.isalpha():
            return _ordered(1, column_number(bare_first), MAX_ROW, column_number(bare_last))
    return _ordered(*parse_cell(first), *parse_cell(last))


def _ordered(top: int, left: int, bottom: int, right: int) -> Rect:
    rect = Rect(min(top, bottom), min(left, right), max(top, bottom), max(left, right))
    if rect.top < 1 or rect.left < 1 or rect.bottom > MAX_ROW or rect.right > MAX_COLUMN:
        raise ValueError(f"rows {top} to {bottom}, columns {left} to {right} are outside the sheet")
    return rect


def absolute_range(rect: Rect) -> str:
    """``"$B$4:$D$9"``, as charts and defined names write it."""
    first = f"${column_letters(rect.left)}${rect.top}"
    if rect.is_single:
        return first
    return f"{first}:${column_letters(rect.right)}${rect.bottom}"


def split_sheet(reference: str) -> tuple[str, str]:
    """Sheet name and the rest of a reference, quotes removed.

    >>> split_sheet("'Start-up'!$A$1")
    ('Start-up', '$A$1')
    """
    sheet, mark, rest = reference.rpartition("!")
    if not mark:
        return "", reference
    if sheet.startswith("'") and sheet.endswith("'") and len(sheet) > 1:
        sheet = sheet[1:-1].replace("''", "'")
    return sheet, rest


def quoted_sheet(sheet: str) -> str:
    """Sheet name as it is written before an exclamation mark."""
    if _PLAIN_SHEET.fullmatch(sheet) and _CELL.fullmatch(sheet) is None:
        return sheet
    return "'" + sheet.replace("'", "''") + "'"


def split_areas(reference: str) -> list[str]:
    """Areas of a reference, separated by commas outside quotes and brackets.

    >>> split_areas("(S!$A$1:$A$2,'a,b'!$C$1)")
    ['S!$A$1:$A$2', "'a,b'!$C$1"]
    """
    text = reference.strip()
    if text.startswith("(") and text.endswith(")"):
        text = text[1:-1]
    return [area.strip() for area in re.findall(r"(?:'(?:[^']|'')*'|[^,'])+", text)]


def retargeted(area: str, sheet: str, old: Rect, new: Rect) -> str:
    """A written range, moved if it reached exactly over the rows of a resized block; of no sheet, it is not named."""
    area_sheet, text = split_sheet(area)
    if area_sheet != sheet:
        return area
    try:
        rect = parse_range(text)
    except ValueError:
        return area
    if (rect.top, rect.bottom) != (old.top, old.bottom) or not old.covers(rect):
        return area
    grown = rect.with_bottom(new.bottom)
    prefix = f"{quoted_sheet(sheet)}!" if sheet else ""
    return f"{prefix}{absolute_range(grown) if '$' in text else grown}"
