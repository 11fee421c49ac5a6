"""Rows of a worksheet part that stay text.

Most rows hold nothing but values and plain formulas, written as every program writes them. As elements their cells would
cost more than all the rest of the workbook; as text they are cut where a table begins and ends, and what is between is
exchanged. Values of formulas change last of all and one by one: they wait beside the text, which is cut where they go.
"""

from __future__ import annotations

import re
from bisect import bisect_left
from collections.abc import Iterator
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
#: Where the cells of a row go that are text: a cell with a name that no cell has.
PLACE_NAME = "written-"
# What is kept of earlier sheets: so many, none longer.
_MOST_KEPT_SHEETS, _LONG_SHEET = 32, 2**20

_CutRow = tuple[
    str, tuple[int, ...], tuple[str | None, ...], tuple[tuple[int, tuple[str, str, str]], ...]
]


class PlainRows:
    """A sheet with places for the cells of its plain rows: in the tree, one cell stands for those of a row.

    Workbooks of one template, and a workbook calculated again, share it.

    Parameters
    ----------
    data : bytes
        The part.
    """

    def __init__(self, data: bytes) -> None:
        #: Cells of each plain row.
        self.cells: list[bytes] = []
        #: Numbers of those rows that hold formulas.
        self.rows_with_formulas: list[int] = []
        self._rows: dict[int, _CutRow] = {}
        #: The part with places: cells named `PLACE_NAME` and a number.
        self.data = data
        start, end = data.find(b"<sheetData>"), data.rfind(b"</sheetData>")
        hidden = has_misleading_tags(data) or not is_utf8(data) or not _is_text(data)
        if 0 <= start < end and not hidden:
            self.data = data[:start] + _ROW.sub(self._place, data[start:end]) + data[end:]

    def _place(self, row: re.Match[bytes]) -> bytes:
        tag, number, cells = row.groups()
        self.cells.append(cells)
        if b"<f>" in cells:
            self.rows_with_formulas.append(int(number))
        return b'%s<c r="%s%d"/>' % (tag, PLACE_NAME.encode(), len(self.cells) - 1)

    def row(self, place: int, number: int) -> TextRow | None:
        """The row of a place as text; None where its cells are out of order."""
        if place not in self._rows:
            self._rows[place] = _cut(self.cells[place].decode())
        stored, columns, styles, formulas = self._rows[place]
        if not columns:
            return None
        own = {column: TextFormula(*formula) for column, formula in formulas}
        return TextRow(number, stored, columns, styles, formulas=own, states_span=True)


_kept_rows = lru_cache(maxsize=_MOST_KEPT_SHEETS)(PlainRows)


def plain_rows(data: bytes) -> PlainRows:
    """The plain rows of a sheet; those of the last sheets are kept."""
    return (_kept_rows if len(data) <= _LONG_SHEET else PlainRows)(data)


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


def _cut(cells: str) -> _CutRow:
    """A row cut where values of formulas go, its columns, styles and formulas."""
    columns, styles = _columns_and_styles(cells)
    formulas = []
    if columns and "<f>" in cells:
        pieces = _cells_of(cells)
        for k, piece in enumerate(pieces):
            if "<f>" in piece:
                pieces[k], formula = _without_value(piece)
                formulas.append((columns[k], formula))
        cells = "".join(pieces)
    return cells, columns, styles, tuple(formulas)


def _cells_of(text: str) -> list[str]:
    return [_CELL_START + cell for cell in text.split(_CELL_START)[1:]]


def _without_value(cell: str) -> tuple[str, tuple[str, str, str]]:
    """A cell with a formula, cut where type and value go, and what `TextFormula` holds of it."""
    tag, _, rest = cell.partition("><f>")
    tag, _, kind = tag.partition(' t="')
    text, _, value = rest.removesuffix("</c>").partition("</f>")
    formula = unescaped(text), kind.removesuffix('"'), value
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
