"""What a sheet of a workbook is made of: banner, widths, tables and charts by their places."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

#: Width of the text column of sheet `Notes`. [characters]
NOTES_WIDTH = 122.0


@dataclass(frozen=True)
class ChartAt:
    """A chart on a sheet."""

    name: str  #: Key of `charts.CHARTS`.
    cell: str  #: Its upper left cell. [A1]
    width: int  #: Size. [pixel]
    height: int  #: Likewise. [pixel]


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
    """One sheet as data."""

    name: str  #: Sheet name.
    #: ``input``, ``live``, ``result`` or ``notes``: colour of the tab and of the banner's word.
    kind: str
    widths: Mapping[str, float]  #: Column widths by ranges such as ``B:D``.
    tables: Mapping[str, str]  #: Cell of each table's caption; header and data stand below. [A1]
    charts: tuple[ChartAt, ...] = ()  #: Its charts.
    freeze: str = "A4"  #: First cell that scrolls; empty = all of it. [A1]
    header_rows: int = 3  #: Rows repeated on every page; a chart must begin below them.
    one_page: bool = False  #: Whether all of it is fitted to one page.
    hidden: bool = False  #: Whether it holds nothing but numbers behind charts.
    printed: str = ""  #: Last column of banner and print; empty = all of them.
    #: Columns at which another page begins; the print is then as large as the widest page allows,
    #: not fitted to one page.
    breaks: tuple[str, ...] = ()
    repeated: str = ""  #: Columns repeated on every page, such as ``A:C``; empty = none.
    row_breaks: tuple[int, ...] = ()  #: Rows, counted from 1, at which another page begins.
    largest: int = 100  #: Scale of a print in pieces at the most. [%]
    side: float = 0.4  #: Margin left and right of a printed page. [in]
    intro: str = ""  #: One sentence below the strip.
    #: Of a study: sheet of the nominal run after which it is placed; empty = after all of those.
    behind: str = ""

    @property
    def last(self) -> str:
        """Last column of banner and print."""
        return self.printed or list(self.widths)[-1].split(":")[-1]


def text_height(text: str, width: float) -> float:
    """Height of a row in which a text wraps.

    Parameters
    ----------
    text : str
        The text, in Arial 9.
    width : float
        Width of its column. [characters of the standard font]

    Returns
    -------
    float
        Height. [point]
    """
    # A letter of Arial 9 takes 5.3 of the 7 pixels a standard character takes, on average.
    lines = sum(max(1, math.ceil(len(part) * 5.3 / (7.0 * width))) for part in text.split("\n"))
    return 15.0 + 12.0 * (lines - 1)


def plot_name(number: int) -> str:
    """Defined name of the cell in which the engineer may name the element of a history chart."""
    return f"PlotElement{number}"
