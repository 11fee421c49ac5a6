"""Rows of a worksheet part that stay text.

Most rows hold nothing but values and plain formulas, written as every program writes them. As elements their cells would
cost more than all the rest of the workbook; as text they are cut where a table begins and ends, and what is between is
exchanged. Values of formulas change last of all and one by one: they wait beside the text, which is cut where they go.
"""

from __future__ import annotations

import re
from bisect import bisect_left
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import lru_cache
from html import escape

from addin.xlsx.references import MAX_COLUMN, Rect, column_number
from addin.xlsx.values import FORMULA_CUT, unescaped
from addin.xlsx.xml_part import has_misleading_tags, is_utf8

# What a parser and a writer leave as it is, to the last byte: neither control characters nor brackets nor what could be
# written shorter. Taken in runs, as sheets are long.
_TEXT = rb"(?:[\t\n -%'-;=?-\xff]++|&(?:amp|lt|gt);)++"
_INSIDE = (
    rb'<v>%s</v>|<f>%s</f>(?:<v>%s</v>)?+|<is><t(?: xml:space="preserve")?>%s</t></is>|<is><t/></is>'
    % ((_TEXT,) * 4)
)
# Named after its row.
_CELL = (
    rb'<c r="[A-Z]{1,3}+\2"(?: s="[0-9]{1,9}+")?+(?: t="[A-Za-z]{1,9}+")?+(?:/>|>(?:%s)</c>)'
    % _INSIDE
)
_ROW = re.compile(
    rb"""(<row (?:[^<>']*? )?r="([1-9][0-9]{0,6})"[^<>']*+>)((?:%s)++)(?=</row>)""" % _CELL
)
_NO_CHARACTERS = ("\ufffe", "\uffff")
_CELL_START = '<c r="'
# Column and style of a cell.
_COLUMN_AND_STYLE = re.compile(rf'{_CELL_START}([A-Z]+)[0-9]+"(?: s="([0-9]+)")?')


def with_places(data: bytes, place: Callable[[bytes, int | None], bytes]) -> bytes:
    """A sheet with places for the cells of its plain rows.

    Parameters
    ----------
    data : bytes
        The part.
    place : callable
        Takes the cells of a row, and the number of the row if it holds formulas, and gives what stands for them.
    """

    def with_place(row: re.Match[bytes]) -> bytes:
        tag, number, cells = row.groups()
        return tag + place(cells, int(number) if b"<f>" in cells else None)

    start, end = data.find(b"<sheetData>"), data.rfind(b"</sheetData>")
    if not 0 <= start < end or has_misleading_tags(data) or not is_utf8(data) or not _is_text(data):
        return data
    return data[:start] + _ROW.sub(with_place, data[start:end]) + data[end:]


def _is_text(data: bytes) -> bool:
    try:
        text = data.decode()
    except UnicodeDecodeError:
        return False
    return not any(one in text for one in _NO_CHARACTERS)


@dataclass(slots=True)
class TextFormula:
    """A formula in a row that is text, and the value that its cell shows, as they are stored."""

    text: str  #: The formula.
    kind: str = ""  #: Type of the value.
    value: str = ""  #: Element of the value; empty without one.

    def show(self, kind: str, text: str | None) -> None:
        """Exchange the value; None for none."""
        self.kind, self.value = kind, ""
        if text is not None:
            space = ' xml:space="preserve"' if text != text.strip() else ""
            # a parser would take the character as it is for the end of a line
            self.value = f"<v{space}>{escape(text, quote=False)}</v>".replace("\r", "&#13;")

    def shown(self) -> str | None:
        """Text of the value; None without one."""
        return (
            unescaped(self.value[self.value.index(">") + 1 : self.value.rindex("<")])
            if self.value
            else None
        )


@dataclass(slots=True)
class TextRow:
    """The cells of a row as text: those it had, and those written since, which wait beside them.

    Tables stand side by side in a row. Each is added in one step; the old cells are cut only where some of them stay.
    """

    number: int
    #: The cells it had, with cuts where type and value of each formula go; their columns, and their styles.
    stored: str = ""
    columns: tuple[int, ...] = ()
    styles: tuple[str | None, ...] = ()
    #: First and last column of what was written since, and the cells, blank where some were taken out. None shares a
    #: column with another.
    written: list[tuple[int, int, str]] = field(default_factory=list)
    last_written: int = 0
    #: Formulas of all its cells by column.
    formulas: dict[int, TextFormula] = field(default_factory=dict)
    #: Whether its element may state a span of columns.
    states_span: bool = False
    _cut: list[str] = field(default_factory=list)

    def xml(self) -> str:
        """All its cells."""
        text = self._with_cuts()
        if not self.formulas:
            return text
        pieces = text.split(FORMULA_CUT)
        for k, column in enumerate(sorted(self.formulas)):
            formula = self.formulas[column]
            if formula.kind:
                pieces[2 * k] += f' t="{formula.kind}"'
            pieces[2 * k + 1] += formula.value
        return "".join(pieces)

    def styles_in(self, rect: Rect, new: tuple[str | None, ...]) -> tuple[str | None, ...]:
        """Styles of the cells in the columns of a rectangle; those given for cells that are not there."""
        inside = self._inside(rect)
        if len(inside) == len(new):
            return self.styles[inside.start : inside.stop]
        styles = list(new)
        for at in inside:
            styles[self.columns[at] - rect.left] = self.styles[at]
        return tuple(styles)

    def columns_in(self, rect: Rect, *, filled: bool = False) -> Iterator[int]:
        """Columns of a rectangle in which there are cells, or cells that hold something."""
        for at in self._inside(rect):
            if not filled or not self._cells()[at].endswith('"/>'):
                yield self.columns[at]

    def cell(self, column: int) -> str | None:
        """The cell of a column, that of a formula without its value; None where there is none."""
        inside = self._inside(Rect(1, column, 1, column))
        return self._cells()[inside.start] if inside else None

    def exchange(self, rect: Rect, text: str) -> None:
        """Put new cells, or none, in the place of those in the columns of a rectangle."""
        inside = self._inside(rect)
        if text or inside:
            self.written.append((rect.left, rect.right, text))
            self.last_written = max(self.last_written, rect.right)

    def _with_cuts(self) -> str:
        if not self.written:
            return self.stored
        pieces = sorted(self.written)
        gone = [bisect_left(self.columns, end) for one in pieces for end in (one[0], one[1] + 1)]
        starts, ends = [0, *gone[1::2]], [*gone[::2], len(self.columns)]
        if starts == ends:
            return "".join([cells for _, _, cells in pieces])
        cells = self._cells()
        kept = ["".join(cells[start:end]) for start, end in zip(starts, ends, strict=True)]
        return kept[0] + "".join(
            [cells + after for (_, _, cells), after in zip(pieces, kept[1:], strict=True)]
        )

    def _inside(self, rect: Rect) -> range:
        """Which of its cells are in the columns of a rectangle."""
        if rect.left <= self.last_written and any(
            first <= rect.right and rect.left <= last for first, last, _ in self.written
        ):
            self._take_in()
        columns = self.columns
        return range(bisect_left(columns, rect.left), bisect_left(columns, rect.right + 1))

    def _take_in(self) -> None:
        """Make what was written its cells."""
        self.stored = self._with_cuts()
        self.written, self.last_written, self._cut = [], 0, _cells_of(self.stored)
        self.columns, self.styles = _columns_and_styles(self.stored)

    def _cells(self) -> list[str]:
        """The cells it had, one by one."""
        if not self._cut:
            self._cut = _cells_of(self.stored)
        return self._cut


def text_row(number: int, cells: str) -> TextRow | None:
    """A plain row as text; None where its cells are out of order."""
    columns, styles = _columns_and_styles(cells)
    if not columns:
        return None
    row = TextRow(number, cells, columns, styles, states_span=True)
    if "<f>" in cells:
        pieces = _cells_of(cells)
        for k, piece in enumerate(pieces):
            if "<f>" in piece:
                pieces[k], row.formulas[columns[k]] = _without_value(piece)
        row.stored = "".join(pieces)
    return row


def _cells_of(text: str) -> list[str]:
    return [_CELL_START + cell for cell in text.split(_CELL_START)[1:]]


def _without_value(cell: str) -> tuple[str, TextFormula]:
    """A cell with a formula, cut where type and value go, and the formula with its value."""
    tag, _, rest = cell.partition("><f>")
    tag, _, kind = tag.partition(' t="')
    text, _, value = rest.removesuffix("</c>").partition("</f>")
    formula = TextFormula(unescaped(text), kind.removesuffix('"'), value)
    return f"{tag}{FORMULA_CUT}><f>{text}</f>{FORMULA_CUT}</c>", formula


def _columns_and_styles(cells: str) -> tuple[tuple[int, ...], tuple[str | None, ...]]:
    """Columns and styles of the cells of a row; none where they are out of order."""
    return _in_order(tuple(_COLUMN_AND_STYLE.findall(cells)))


@lru_cache(maxsize=1024)
def _in_order(
    cells: tuple[tuple[str, str], ...],
) -> tuple[tuple[int, ...], tuple[str | None, ...]]:
    """The same, of letters and styles, in which rows of a table are alike."""
    columns = tuple(column_number(letters) for letters, _ in cells)
    if [*columns] != sorted(set(columns)) or max(columns, default=0) > MAX_COLUMN:
        return (), ()
    return columns, tuple(style or None for _, style in cells)
