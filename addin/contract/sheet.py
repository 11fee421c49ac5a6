"""What a sheet of a workbook is made of: banner, widths, tables and charts by their places."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import reduce

#: Width of the texts of sheet `Notes`. [characters]
NOTES_WIDTH = 140.0
#: Usual height of a row: that of its text and a little more; and where its letters are narrow ones. [point]
ROW_HEIGHT, _TALL_ROW = 12.75, 13.5
#: Height of letters that are 8 pt high where a sheet is printed at 70 %. [pt]
READABLE = 11.5
#: Width of a letter of Arial Narrow over that of one of Arial. [1]
NARROW = 0.82
#: Which parts are printed whatever they hold, and which are not.
ALWAYS, NEVER = ("always",), ("never",)


@dataclass(frozen=True)
class ChartAt:
    """A chart on a sheet."""

    name: str  #: Key of `charts.CHARTS`.
    cell: str  #: Its upper left cell. [A1]
    width: int  #: Size. [pixel]
    height: int  #: Likewise. [pixel]
    right: int = 0  #: How far right of the corner of the cell it begins, and how far below. [pixel]
    down: int = 0  #: Likewise. [pixel]


@dataclass(frozen=True)
class KeyNumber:
    """A number beside its label, by a live formula."""

    label: str  #: What it is.
    formula: str  #: The formula.
    unit: str = ""  #: Its unit; or the column, ``Table[Column]``, in whose unit it is.
    number_format: str = "General"  #: Number format of its cell.
    where: str = ""  #: Formula for the place that it belongs to; empty = none.


@dataclass(frozen=True)
class Sheet:
    """One sheet as data, or one of several parts that stand side by side on a sheet.

    A part has columns of its own, so that its tables may grow downwards beside those of the others; its cells
    are given as if it began in column A.
    """

    name: str  #: Its name; of a part, the title in its banner.
    #: ``input``, ``live``, ``result`` or ``notes``: colour of the tab and of the banner's word.
    kind: str
    widths: Mapping[str, float]  #: Column widths by ranges such as ``B:D``.
    tables: Mapping[str, str]  #: Cell of each table's caption; header and data stand below. [A1]
    charts: tuple[ChartAt, ...] = ()  #: Its charts.
    freeze: str = "A4"  #: First cell that scrolls; empty = all of it. [A1]
    header_rows: int = 3  #: Rows repeated on every page; a chart must begin below them.
    hidden: bool = False  #: Whether it holds nothing but numbers behind charts.
    printed: str = ""  #: Last column of banner and print; empty = all of them.
    #: Columns at which another page begins; the print is then as large as the widest page allows,
    #: not fitted to one page.
    breaks: tuple[str, ...] = ()
    repeated: str = ""  #: Columns repeated on every page of a sheet without other parts, such as ``A:C``; empty = none.
    rows_printed: int = 0  #: Rows of each table that are printed at the most; 0 = all. [count]
    row_breaks: tuple[int, ...] = ()  #: Rows, counted from 1, at which another page begins.
    largest: int = 100  #: Scale of a print in pieces at the most. [%]
    intro: str = ""  #: One sentence below the strip.
    #: Tables of which one must hold something for the part to be printed, `ALWAYS` or `NEVER`; empty = its own
    #: tables and those that its charts draw.
    printed_for: tuple[str, ...] = ()
    letters: float = (
        9.0  #: Height of its letters; the small ones are as high where that is more. [pt]
    )
    narrow: bool = False  #: Whether its letters are narrow ones, see `NARROW`.
    joins: bool = False  #: Whether it is printed on the page of the part left of it.
    print_from: int = 1  #: First row that is printed; the repeated ones stand above it in any case.
    print_to: int = 0  #: Last row that is printed in any case.
    on: str = ""  #: Of a part: the sheet on which it stands.
    shift: int = 0  #: Columns of the parts left of it, see `side_by_side`. [count]
    row_height: float = ROW_HEIGHT  #: Of the rows of its sheet, see `side_by_side`. [point]

    @property
    def worksheet(self) -> str:
        """Name of the sheet in the workbook."""
        return self.on or self.name

    @property
    def last(self) -> str:
        """Last column of banner and print."""
        return self.printed or list(self.widths)[-1].split(":")[-1]

    @property
    def columns(self) -> tuple[int, int]:
        """Its first and its last column on the sheet, counted from 1. [count]"""
        return self.shift + 1, self.shift + column_number(self.last)

    @property
    def column_widths(self) -> dict[int, float]:
        """Width of each of its columns, counted from 1. [characters]"""
        widths: dict[int, float] = {}
        for columns, each in self.widths.items():
            begin, _, end = columns.partition(":")
            last = column_number(end or begin)
            widths |= dict.fromkeys(range(column_number(begin), last + 1), each)
        return widths

    def at(self, place: str) -> str:
        """A cell, a column or a range of columns of the part, on its sheet. [A1]"""
        return _LETTERS.sub(
            lambda found: column_letters(column_number(found[0]) + self.shift), place
        )


_LETTERS = re.compile(r"[A-Z]+")


def column_number(letters: str) -> int:
    """Number of a column, counted from 1. [count]"""
    return reduce(lambda number, letter: 26 * number + ord(letter) - 64, letters, 0)


def column_letters(number: int) -> str:
    """Letters of a column, counted from 1. [letters]"""
    letters = ""
    while number:
        number, letter = divmod(number - 1, 26)
        letters = chr(65 + letter) + letters
    return letters


def side_by_side(parts: Sequence[Sheet]) -> tuple[Sheet, ...]:
    """Parts of the same sheet beside each other, in their order."""
    placed, used = [], dict[str, int]()
    tall = {part.worksheet for part in parts if part.narrow}
    for part in parts:
        shift = used.get(part.worksheet, 0)
        height = _TALL_ROW if part.worksheet in tall else ROW_HEIGHT
        placed.append(replace(part, shift=shift, row_height=height))
        widest = list(part.widths)[-1].split(":")[-1]
        used[part.worksheet] = shift + column_number(widest)
    return tuple(placed)


def readable(part: Sheet) -> Sheet:
    """A part with letters that are 8 pt high on paper, narrow ones, so that its columns hold what they held."""
    return replace(part, letters=READABLE, narrow=True, largest=min(part.largest, 70))


def text_height(text: str, width: float, letters: float = 9.0, narrow: bool = False) -> float:
    """Height of a row in which a text wraps.

    Parameters
    ----------
    text : str
        The text, in Arial or Arial Narrow.
    width : float
        Width of its column. [characters of the standard font]
    letters : float
        Height of the letters. [pt]
    narrow : bool
        Whether they are narrow.

    Returns
    -------
    float
        Height. [point]
    """
    # A letter of Arial 9 takes 5.3 of the 7 pixels a standard character takes, on average.
    each = 5.3 * letters * (NARROW if narrow else 1.0) / (9.0 * 7.0 * width)
    lines = sum(max(1, math.ceil(len(part) * each)) for part in text.split("\n"))
    if narrow:
        return _TALL_ROW * lines
    return (3.0 if letters <= 9.0 else 2.0) + max(12.0, 1.2 * letters) * lines


def plot_name(number: int) -> str:
    """Defined name of the cell in which the engineer may name the element of a history chart."""
    return f"PlotElement{number}"
