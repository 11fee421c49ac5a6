"""Rows of a worksheet part that stay text.

Most rows hold nothing but values, written as every program writes them. As elements their cells would cost more than all
the rest of the workbook; as text they are cut where a table begins and ends, and what is between is exchanged.
"""

from __future__ import annotations

import re
from bisect import bisect_left
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import lru_cache
from string import ascii_uppercase

from addin.xlsx.references import MAX_COLUMN, Rect, column_number
from addin.xlsx.xml_part import is_utf8

# What a parser and a writer leave as it is, to the last byte: neither control characters nor brackets nor what could be
# written shorter. Taken in runs, as sheets are long.
_TEXT = rb"(?:[\t\n -%'-;=?-\xff]++|&(?:amp|lt|gt);)++"
_INSIDE = rb'<v>%s</v>|<is><t(?: xml:space="preserve")?>%s</t></is>|<is><t/></is>' % (_TEXT, _TEXT)
_CELL = (
    rb'<c r="[A-Z]{1,3}+[1-9][0-9]{0,6}+"(?: s="[0-9]{1,9}+")?+(?: t="[A-Za-z]{1,9}+")?+(?:/>|>(?:%s)</c>)'
    % _INSIDE
)
_ROW = re.compile(rb"(<row [^<>]*+>)((?:%s)++)(?=</row>)" % _CELL)
# In comments and the like, what looks like a row is none; but a part begins with a declaration.
_COMMENT = re.compile(rb"<[!?]")
_NO_CHARACTERS = (b"\xef\xbf\xbe", b"\xef\xbf\xbf")
_CELL_START = '<c r="'
# Place and style of a cell in the shape of a row.
_SHAPE = re.compile(r'([A-Z]+)#"(?: s="([0-9]+)")?(?: t="[A-Za-z]+")?/?')


def with_places(data: bytes, place: Callable[[bytes], bytes]) -> bytes:
    """A sheet with places for the cells of its plain rows.

    Parameters
    ----------
    data : bytes
        The part.
    place : callable
        Takes the cells of a row, and gives what stands for them.
    """
    start, end = data.find(b"<sheetData>"), data.rfind(b"</sheetData>")
    if (
        not 0 <= start < end
        or data.startswith(b"<!")
        or _COMMENT.search(data, 2) is not None
        or not is_utf8(data)
        or not _is_text(data)
    ):
        return data
    cells = _ROW.sub(lambda row: row[1] + place(row[2]), data[start:end])
    return data[:start] + cells + data[end:]


def _is_text(data: bytes) -> bool:
    try:
        return data.isascii() or (
            bool(data.decode()) and not any(one in data for one in _NO_CHARACTERS)
        )
    except UnicodeDecodeError:
        return False


@dataclass
class TextRow:
    """The cells of a row as pieces of text: single cells, or runs of neighbours that were written together."""

    #: First and last column of each piece, in order.
    firsts: list[int] = field(default_factory=list)
    lasts: list[int] = field(default_factory=list)
    texts: list[str] = field(default_factory=list)
    #: Style of each piece that is a single cell.
    styles: list[str | None] = field(default_factory=list)
    #: Whether its element may state a span of columns.
    states_span: bool = False

    def xml(self) -> str:
        """All its cells."""
        return "".join(self.texts)

    def styles_in(self, rect: Rect, new: tuple[str | None, ...]) -> tuple[str | None, ...]:
        """Styles of the cells in the columns of a rectangle; those given for cells that are not there."""
        if not self.lasts or self.lasts[-1] < rect.left:
            return new
        inside = self._pieces_in(rect)
        if len(inside) == len(new):
            return tuple(self.styles[inside.start : inside.stop])
        styles = list(new)
        for at in inside:
            styles[self.firsts[at] - rect.left] = self.styles[at]
        return tuple(styles)

    def columns_in(self, rect: Rect, *, filled: bool = False) -> Iterator[int]:
        """Columns of a rectangle in which there are cells, or cells that hold something."""
        for at in self._pieces_in(rect):
            if not filled or not self.texts[at].endswith('"/>'):
                yield self.firsts[at]

    def cell(self, column: int) -> str | None:
        """The cell of a column; None where there is none."""
        return next((self.texts[at] for at in self._pieces_in(Rect(1, column, 1, column))), None)

    def exchange(self, rect: Rect, text: str) -> None:
        """Put new cells, or none, in the place of those in the columns of a rectangle."""
        style = _cells_of(text).styles[0] if text and rect.left == rect.right else None
        if text and (not self.lasts or self.lasts[-1] < rect.left):
            self.firsts.append(rect.left)
            self.lasts.append(rect.right)
            self.texts.append(text)
            self.styles.append(style)
            return
        inside = self._pieces_in(rect)
        here = slice(inside.start, inside.stop)
        self.firsts[here] = [rect.left] if text else []
        self.lasts[here] = [rect.right] if text else []
        self.texts[here] = [text] if text else []
        self.styles[here] = [style] if text else []

    def _pieces_in(self, rect: Rect) -> range:
        """Pieces in the columns of a rectangle, each of them a single cell."""
        while True:
            start = bisect_left(self.lasts, rect.left)
            stop = bisect_left(self.firsts, rect.right + 1)
            if self.firsts[start:stop] == self.lasts[start:stop]:
                return range(start, stop)
            self._part(next(k for k in range(start, stop) if self.firsts[k] < self.lasts[k]))

    def _part(self, run: int) -> None:
        """Take a run apart into its cells."""
        cells = _cells_of(self.texts[run])
        here = slice(run, run + 1)
        self.firsts[here] = cells.firsts
        self.lasts[here] = cells.lasts
        self.texts[here] = cells.texts
        self.styles[here] = cells.styles


def text_row(number: int, cells: str) -> TextRow | None:
    """A plain row as text; None where its cells are out of order or bear names of other rows."""
    pieces = cells.split(_CELL_START)[1:]
    name_end = f'{number}"'
    shape = "|".join([piece.partition(">")[0].replace(name_end, '#"', 1) for piece in pieces])
    columns, styles = _columns_and_styles(shape)
    if not columns:
        return None
    texts = [_CELL_START + piece for piece in pieces]
    return TextRow([*columns], [*columns], texts, [*styles], states_span=True)


def _cells_of(text: str) -> TextRow:
    """Cells that were written together."""
    name = text[len(_CELL_START) : text.index('"', len(_CELL_START))]
    cells = text_row(int(name.lstrip(ascii_uppercase)), text)
    assert cells is not None
    return cells


@lru_cache(maxsize=1024)
def _columns_and_styles(shape: str) -> tuple[tuple[int, ...], tuple[str | None, ...]]:
    """Columns and styles of the cells of a row, in which rows of a table are alike; none where they are out of order."""
    cells = [_SHAPE.fullmatch(cell) for cell in shape.split("|")]
    columns = tuple(column_number(cell[1]) for cell in cells if cell is not None)
    in_order = [*columns] == sorted(set(columns)) and len(columns) == len(cells)
    if not in_order or columns[-1] > MAX_COLUMN:
        return (), ()
    return columns, tuple(cell[2] for cell in cells if cell is not None)
