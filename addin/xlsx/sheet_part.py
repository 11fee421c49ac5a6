"""The cells of one worksheet part.

The part is parsed once; cells are changed in the tree and the tree is written back. Rows that hold nothing but values and plain formulas stay
text (`text_row`) until somebody asks for a cell of them: in the tree, one place stands for their cells. Blocks of cells are
built as text and put in place row by row, which keeps the cost in proportion to the number of cells.
"""

from __future__ import annotations

import re
from bisect import bisect_left
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import cached_property
from operator import itemgetter
from typing import NamedTuple, cast

from lxml import etree

from addin.xlsx.errors import CellRefused, WorkbookRefused, damaged
from addin.xlsx.formula_text import shifted_formula
from addin.xlsx.references import (
    MAX_COLUMN,
    Rect,
    cell_name,
    column_letters,
    parse_cell,
    parse_range,
    whole_number,
)
from addin.xlsx.sheet_ranges import read_range, resize_ranges, retarget_sparklines
from addin.xlsx.sheet_row import Row, index_row
from addin.xlsx.text_row import PLACE_NAME, PlainRows, TextFormula, TextRow, plain_rows
from addin.xlsx.values import (
    FORMULA_CUT,
    CellValue,
    Constant,
    Formula,
    constant_text,
    formula_or_constant,
    read_cell,
    read_constant,
    read_text,
    rows_xml,
    stored_constant,
)
from addin.xlsx.xml_part import MAIN, Element, main, parse_part, serialise

_C, _F, _V, _ROW = (main(tag) for tag in ("c", "f", "v", "row"))
_PLACE = re.compile(rb'><c r="written-([0-9]{1,9})"/>(</row>)?')
_XML_SPACE = "{http://www.w3.org/XML/1998/namespace}space"

#: Of rows and columns for which a file says nothing. [point], [characters]
_ROW_HEIGHT, _COLUMN_WIDTH = 15.0, 8.43

SharedStrings = Callable[[str], str]


class _Block(NamedTuple):
    """A written rectangle with the values given for its first rows; those below are blank."""

    rect: Rect
    rows: Sequence[Sequence[CellValue]]
    #: Texts of the numbers of the first of these rows (`values.rows_xml`).
    numbers: Sequence[Sequence[str | None]]


class SheetPart:
    """Cells, styles and row order of one worksheet.

    Parameters
    ----------
    name : str
        Sheet name, for messages.
    part : str
        Name of the part.
    data : bytes
        The part as stored.
    shared_strings : callable
        Gives the shared string of an index, given as text.
    """

    def __init__(self, name: str, part: str, data: bytes, shared_strings: SharedStrings) -> None:
        self.name = name
        self.part = part
        self._changed = False
        self._bytes: bytes | None = None
        self._original = data
        self.shared_strings = shared_strings
        # Cells of rows that are text, by the number of their place: as in the file, or as they are now. A sheet that
        # writes its tags with a prefix cannot take text as it is built here, and one in which something bears the name
        # of a place would be mistaken.
        self._texts: list[bytes | TextRow] = []
        self._plain = PlainRows(b"")
        self._may_wait = PLACE_NAME.encode() not in data
        self._root = self._parsed(data) if self._may_wait else parse_part(data, part)
        self._may_wait = self._may_wait and self._root.prefix is None
        self._data = self._root.find(main("sheetData"))
        if self._data is None:
            raise damaged(f"Sheet {name} has no cell data.")
        self._rows: dict[int, Element] = {}
        self._row_numbers: list[int] = []
        self._indexed: dict[int, Row | TextRow] = {}
        self._index_rows()
        self._formula_before: dict[tuple[int, int], bool] = {}
        self._extent: Rect | None = None
        # Styles of columns, by the first and the last of them.
        self._known_styles: dict[tuple[int, int], tuple[str | None, ...]] = {}
        # Long blocks that still stand as they were written; they do not overlap.
        self._blocks: list[_Block] = []

    def _parsed(self, data: bytes) -> Element:
        """The part as a tree, with places for the cells of plain rows."""
        plain = plain_rows(data)
        try:
            root = parse_part(plain.data, self.part)
            if root.prefix is None:
                self._plain = plain
                self._texts += plain.cells
                return root
        except WorkbookRefused:
            pass  # it is said of the part as it is stored, with the places in it
        return parse_part(data, self.part)

    @property
    def changed(self) -> bool:
        """Whether anything was written."""
        return self._changed

    def _touch(self) -> None:
        self._changed = True
        self._bytes = None

    # ---- reading -----------------------------------------------------------------------------------------------

    def value(self, row: int, column: int) -> CellValue:
        """What a cell holds."""
        held = self._row_as_it_is(row) if row in self._rows else None
        if isinstance(held, TextRow):
            constant = self._constant_of_text(held, column)
            formula = held.formulas.get(column)
            return constant if formula is None else formula_or_constant(formula.text, constant)
        cell = self._cell(row, column)
        return None if cell is None else read_cell(cell, self.shared_strings)

    def constant(self, row: int, column: int) -> Constant:
        """The value that a cell shows; of a formula its cached value."""
        held = self._row_as_it_is(row) if row in self._rows else None
        if isinstance(held, TextRow):
            return self._constant_of_text(held, column)
        cell = self._cell(row, column)
        return None if cell is None else read_constant(cell, self.shared_strings)

    def _constant_of_text(self, row: TextRow, column: int) -> Constant:
        formula = row.formulas.get(column)
        if formula is None:
            text = row.cell(column)
            return None if text is None else read_text(text, self.shared_strings)
        shown = formula.shown()
        return None if shown is None else stored_constant(formula.kind, shown, self.shared_strings)

    def constants(self, rect: Rect) -> list[Constant]:
        """The values that the cells of a rectangle show, row by row."""
        size = rect.height * rect.width
        block = next((one for one in self._blocks if one.rect.covers(rect)), None)
        if block is not None:
            # The values are in hand: taking them from the cells again would parse each number.
            start, left = rect.top - block.rect.top, rect.left - block.rect.left
            rows, right = block.rows[start : start + rect.height], left + rect.width
            known = (
                [row[left] for row in rows]
                if rect.width == 1
                else [value for row in rows for value in row[left:right]]
            )
            if Formula not in set(map(type, known)):
                return cast("list[Constant]", known) + [None] * (size - len(known))
        # Only rows that are there: a range may reach to the end of the sheet.
        held: list[Constant] = [None] * size
        for number in self._rows_between(rect.top, rect.bottom):
            at = (number - rect.top) * rect.width - rect.left
            for column in range(rect.left, rect.right + 1):
                held[at + column] = self.constant(number, column)
        return held

    def number_texts(self, rect: Rect) -> list[str | None] | None:
        """Texts of a column of numbers that stands as it was written, whole ones with ``.0``; else None."""
        block = next((one for one in self._blocks if one.rect.covers(rect)), None)
        if block is None or rect.width > 1:
            return None
        start, left = rect.top - block.rect.top, rect.left - block.rect.left
        stop = min(start + rect.height, len(block.rows))
        if stop > len(block.numbers):
            return None
        texts = [row[left] for row in block.numbers[start:stop]]
        return texts + [None] * (rect.height - len(texts))

    def as_written(self, rect: Rect) -> Iterator[Sequence[CellValue]] | None:
        """Values of a rectangle in a long block that stands as it was written, without blank rows below; else None."""
        block = next((one for one in self._blocks if one.rect.covers(rect)), None)
        if block is None:
            return None
        start, left = rect.top - block.rect.top, rect.left - block.rect.left
        return (row[left : left + rect.width] for row in block.rows[start : start + rect.height])

    def style(self, row: int, column: int) -> str | None:
        """Style index that a cell has, or would have if it were written now."""
        return self.row_styles(Rect(row, column, row, column))[0]

    def row_styles(self, rect: Rect) -> tuple[str | None, ...]:
        """Style indices of the first row of a rectangle, as `style`."""
        row = self._row_as_it_is(rect.top) if rect.top in self._rows else None
        return self._styles(rect, [row])[0]

    def filled_cells(self, rect: Rect) -> Iterator[tuple[int, int]]:
        """Cells of a rectangle that hold a value or a formula."""
        for number in self._rows_between(rect.top, rect.bottom):
            row = self._row_as_it_is(number)
            if isinstance(row, TextRow):
                yield from ((number, column) for column in row.columns_in(rect, filled=True))
                continue
            for column in row.columns_in(rect):
                if len(row.cells[column]):
                    yield number, column

    def cells_in(self, rect: Rect) -> Iterator[tuple[int, int]]:
        """Cells of a rectangle that are in the file, filled or not."""
        for number in self._rows_between(rect.top, rect.bottom):
            row = self._row_as_it_is(number)
            yield from ((number, column) for column in row.columns_in(rect))

    @cached_property
    def formulas(self) -> dict[tuple[int, int], Element | TextFormula]:
        """Cells with a formula, by row and column, as elements or, in rows that are text, their formulas."""
        places: list[tuple[tuple[int, int], Element | TextFormula]] = []
        for number in self._plain.rows_with_formulas:
            row = self._as_text(number)
            if row is not None:
                places += (((number, column), one) for column, one in row.formulas.items())
        cells = [formula.getparent() for formula in self._data.iter(_F)]
        in_text = len(places)
        places += ((self._place(cell), cell) for cell in cells)
        if in_text and cells:
            places.sort(key=itemgetter(0))
        return dict(places)

    def formulas_without_value(self) -> Iterator[tuple[int, int]]:
        """Cells, by row and column, of formulas that have no stored value; an empty text is one."""
        return (place for place in self.formulas if self.constant(*place) is None)

    @property
    def rich_values(self) -> list[tuple[int, int]]:
        """Cells that show a rich value: a picture, a linked data type, an error without a code of its own."""
        return [self._place(cell) for cell in self._data.iter(_C) if cell.get("vm")]

    @cached_property
    def merges(self) -> list[Rect]:
        """Merged ranges."""
        entries = self._root.iterfind(f"{main('mergeCells')}/{main('mergeCell')}")
        what = f"A merged range of sheet {self.name}"
        return [read_range(entry.get("ref", ""), what) for entry in entries]

    @cached_property
    def arrays(self) -> dict[tuple[int, int], Rect]:
        """Ranges of array formulas, spilled results and data tables, by their master cell."""
        formulas = {
            place: cell.find(_F)
            for place, cell in self.formulas.items()
            if not isinstance(cell, TextFormula)
        }
        what = f"An array formula of sheet {self.name}"
        return {
            place: read_range(formula.get("ref"), what)
            for place, formula in formulas.items()
            if formula.get("t") in ("array", "dataTable") and formula.get("ref")
        }

    def formula_set_changed(self) -> bool:
        """Whether other cells hold formulas now than in the file."""
        return any(
            (place in self.formulas) != before for place, before in self._formula_before.items()
        )

    # ---- writing -----------------------------------------------------------------------------------------------

    def set_cell(
        self,
        row: int,
        column: int,
        value: CellValue,
        *,
        replace_formula: bool = False,
    ) -> list[str]:
        """Write one cell, keeping its style.

        Raises
        ------
        CellRefused
            For a merged cell other than the first, a part of an array formula, or a formula that may not be replaced.
        """
        name = cell_name(row, column)
        cell = Rect(row, column, row, column)
        merge = self.merge_across(cell)
        if merge is not None and (merge.top, merge.left) != (row, column):
            raise CellRefused(self.name, name, f"lies inside the merged range {merge}. Unmerge it.")
        array = self.array_across(cell)
        if array is not None:
            raise CellRefused(
                self.name, name, f"belongs to the array formula in {array}. Move that formula away."
            )
        if (row, column) in self.formulas and not (replace_formula or isinstance(value, Formula)):
            raise CellRefused(
                self.name, name, "holds a formula, which is not overwritten. Clear the cell first."
            )
        return self.write_rows(cell, [[value]])

    def write_rows(
        self,
        rect: Rect,
        rows: Sequence[Sequence[CellValue]],
        *,
        styles: Sequence[str | None] | None = None,
    ) -> list[str]:
        """Write a rectangle of cells; those that exist keep their style.

        Parameters
        ----------
        rect : Rect
            Where; rows beyond those given are blanked.
        rows : sequence of sequence of CellValue
            Values that have passed `values.clean`, as wide as the rectangle.
        styles : sequence of (str or None), optional
            Style for each column, for cells that do not exist yet; left out, they take the style of their row or column.

        Returns
        -------
        list of str
            XML of the cells of each row, as it is in the part when its namespace has no prefix, with cuts
            (`values.FORMULA_CUT`) where type and value of formulas come.
        """
        self._forget_formulas(rect)
        starts = tuple(
            f'<c r="{column_letters(column)}' for column in range(rect.left, rect.right + 1)
        )
        blank: list[list[CellValue]] = [[None] * rect.width] * (rect.height - len(rows))
        there = [
            self._row_as_it_is(number) if number in self._rows else None
            for number in range(rect.top, rect.bottom + 1)
        ]
        texts, numbers = rows_xml(
            rect.top, starts, self._styles(rect, there, styles), [*rows, *blank]
        )
        self._graft(rect, texts)
        for offset, text in enumerate(texts):
            for shift, value in enumerate(rows[offset]) if FORMULA_CUT in text else ():
                if isinstance(value, Formula):
                    self._note_formula(rect.top + offset, rect.left + shift, value.text)
        self._forget_blocks(rect)
        if len(rows) > 1:
            self._blocks.append(_Block(rect, rows, numbers))
        self._note_extent(rect)
        self._touch()
        return texts

    def remove_cells(self, rect: Rect) -> None:
        """Take cells out of the sheet, values and styles."""
        self._forget_formulas(rect)
        self._forget_blocks(rect)
        for number in self._rows_between(rect.top, rect.bottom):
            row = self._row_as_it_is(number)
            if isinstance(row, TextRow):
                row.exchange(rect, "")
            else:
                row.take_out(rect)
        self._touch()

    def move_row_cells(self, source: Rect, row: int) -> None:
        """Move the cells of a one-row rectangle to another row, as they are.

        Used for totals rows: their formulas name columns and need no adjustment.
        """
        self._unshare_all(source)
        number = source.top
        if number not in self._rows:
            return
        cells = self._row(number).take_out(source)
        if row not in self._rows:
            self._insert_row(row, self._data.makeelement(_ROW, r=str(row)))
        target = self._row(row)
        target.take_out(Rect(row, source.left, row, source.right))
        for cell in cells:
            _, column = parse_cell(cell.get("r"))
            cell.set("r", cell_name(row, column))
        target.put_in(cells)
        self._forget_blocks(source)
        self._forget_blocks(Rect(row, source.left, row, source.right))
        for column in range(source.left, source.right + 1):
            if (number, column) in self.formulas:
                self._drop_formula(number, column)
                self._note_formula(row, column, "")
        self._note_extent(Rect(row, source.left, row, source.right))
        self._touch()

    def set_cached(self, row: int, column: int, value: Constant) -> None:
        """Replace the cached value of a cell; the formula stays. None leaves it without a value."""
        kind, text = constant_text(value)
        formula = self.formulas.get((row, column))
        if isinstance(formula, TextFormula):
            formula.show(kind, text)
            self._touch()
            return
        cell = self._cell(row, column)
        if cell is None:
            return
        if formula is None:
            self._forget_blocks(Rect(row, column, row, column))
        for old in cell.findall(_V):
            cell.remove(old)
        cell.attrib.pop("t", None)
        # What a rich value shows is not in the cell: it would outlive the value that it belongs to.
        cell.attrib.pop("vm", None)
        if kind:
            cell.set("t", kind)
        if text is not None:
            new = etree.SubElement(cell, _V)
            new.text = text
            if text != text.strip():
                new.set(_XML_SPACE, "preserve")
        self._touch()

    def exchange_formulas(self, texts: Mapping[tuple[int, int], str]) -> None:
        """Exchange the texts of formulas by row and column; one without text goes, and its value stays."""
        for place, text in texts.items():
            cell = self._cell(*place)
            formula = None if cell is None else cell.find(_F)
            if cell is None or formula is None:
                continue
            if text:
                formula.text = text
                continue
            cell.remove(formula)
            if "formulas" in self.__dict__:
                self._drop_formula(*place)
            # A cell that is no formula any more is no dynamic array either.
            cell.attrib.pop("cm", None)
        self._touch()

    def name_cells(self) -> None:
        """Give every cell its name, which programs may leave out."""
        for number in self._row_numbers:
            self._row_as_it_is(number)
        self._touch()

    def show_rows(self, top: int, bottom: int) -> list[int]:
        """Make hidden rows visible, and say which they were."""
        hidden = self.hidden_rows(top, bottom)
        for number in self._rows_between(top, bottom):
            if self._rows[number].attrib.pop("hidden", None) is not None:
                self._touch()
        return hidden

    def hidden_rows(self, top: int, bottom: int) -> list[int]:
        """Rows that are not shown, in order."""
        return [
            number
            for number in self._rows_between(top, bottom)
            if self._rows[number].get("hidden", "0") not in ("0", "false")
        ]

    def cell_element(self, row: int, column: int) -> Element | None:
        """The element of a cell; None where the file has none."""
        return self._cell(row, column)

    @property
    def hides_zeros(self) -> bool:
        """Whether the first view of the sheet leaves cells with a zero blank."""
        views = (one for one in self.around_cells() if one.tag == main("sheetViews"))
        return any(view.get("showZeros", "1") in ("0", "false") for held in views for view in held)

    def row_height(self, row: int) -> float:
        """Height of a row [point]; 0 for a hidden one."""
        element = self._rows.get(row)
        usual = next((one for one in self.around_cells() if one.tag == main("sheetFormatPr")), None)
        if element is not None and element.get("hidden", "0") not in ("0", "false"):
            return 0.0
        if element is not None and element.get("ht"):
            return _length(element.get("ht"), _ROW_HEIGHT)
        if usual is not None and usual.get("zeroHeight", "0") not in ("0", "false"):
            return 0.0
        return _ROW_HEIGHT if usual is None else _length(usual.get("defaultRowHeight"), _ROW_HEIGHT)

    def column_width(self, column: int) -> float:
        """Width of a column [characters]; 0 for a hidden one."""
        usual = _COLUMN_WIDTH
        for one in self.around_cells():
            if one.tag == main("sheetFormatPr"):
                usual = _length(one.get("defaultColWidth"), usual)
            for entry in one if one.tag == main("cols") else ():
                first, last = whole_number(entry.get("min", "")), whole_number(entry.get("max", ""))
                if first is None or last is None or not first <= column <= last:
                    continue
                hidden = entry.get("hidden", "0") not in ("0", "false")
                return 0.0 if hidden else _length(entry.get("width"), usual)
        return usual

    def set_row_height(self, row: int, height: float, *, create: bool = False) -> None:
        """Give a row of the sheet a height [point]; a row without cells keeps the usual one, unless it is created."""
        if create and row not in self._rows:
            self._insert_row(row, self._data.makeelement(_ROW, r=str(row)))
        element = self._rows.get(row)
        if element is not None:
            element.set("ht", f"{height:g}")
            element.set("customHeight", "1")
            self._touch()

    def resize_ranges(self, old: Rect, new: Rect) -> None:
        """Let conditional formats and data validations follow a resized block."""
        if resize_ranges(self.around_cells(), old, new):
            self._touch()

    def retarget_sparklines(self, sheet: str, old: Rect, new: Rect) -> None:
        """Let sparklines over a column of a resized block follow it."""
        if retarget_sparklines(self.around_cells(), sheet, old, new):
            self._touch()

    def around_cells(self) -> Iterator[Element]:
        """What stands in the sheet beside its cells, which are too many to look through."""
        return (element for element in self._root if element is not self._data)

    def merge_across(self, rect: Rect) -> Rect | None:
        """A merged range that shares a cell with the rectangle."""
        return next((merge for merge in self.merges if merge.meets(rect)), None)

    def array_across(self, rect: Rect) -> Rect | None:
        """An array formula's range that reaches into the rectangle and out of it."""
        for array in self.arrays.values():
            if array.meets(rect) and not rect.covers(array):
                return array
        return None

    def to_bytes(self) -> bytes:
        """The part as it shall be stored."""
        if self._bytes is None:
            self._update_dimension()
            data = serialise(self._root, self._original)
            self._bytes = _PLACE.sub(self._cells_at, data) if self._texts else data
        return self._bytes

    def _cells_at(self, place: re.Match[bytes]) -> bytes:
        """Cells that are text; a row that has none is closed as every writer closes it."""
        cells, end = self._texts[int(place[1])], place[2] or b""
        text = cells if isinstance(cells, bytes) else cells.xml().encode()
        return b">" + text + end if text or not end else b"/>"

    # ---- rows and cells ----------------------------------------------------------------------------------------

    def _index_rows(self) -> None:
        last = 0
        for element in self._data.iterchildren(_ROW):
            number = whole_number(element.get("r") or str(last + 1))
            if number is None or number <= last:
                raise damaged(
                    f"The rows of sheet {self.name} after row {last} are out of order or beyond the end of a sheet."
                )
            if element.get("r") != str(number):
                element.set("r", str(number))
            self._rows[number] = element
            self._row_numbers.append(number)
            last = number

    def _rows_between(self, top: int, bottom: int) -> list[int]:
        start = bisect_left(self._row_numbers, top)
        return self._row_numbers[start : bisect_left(self._row_numbers, bottom + 1)]

    def _row(self, number: int) -> Row:
        """Row with its cells as elements; it must exist."""
        row = self._row_as_it_is(number)
        if isinstance(row, TextRow):
            formulas = row.formulas
            row = self._indexed[number] = self._with_elements(number, row.xml())
            for column in formulas:
                self.formulas[number, column] = row.cells[column]
        return row

    def _with_elements(self, number: int, cells: str) -> Row:
        """The row with elements for its cells."""
        self._put_elements(number, cells)
        return index_row(self.name, number, self._rows[number])

    def _put_elements(self, number: int, cells: str) -> None:
        self._rows[number][:] = etree.fromstring(f'<row xmlns="{MAIN}">{cells}</row>')[:]

    def _row_as_it_is(self, number: int) -> Row | TextRow:
        """Row whose cells may be text; it must exist."""
        if number not in self._indexed:
            self._indexed[number] = self._at_first(number)
        return self._indexed[number]

    def _at_first(self, number: int) -> Row | TextRow:
        return self._as_text(number) or index_row(self.name, number, self._rows[number])

    def _as_text(self, number: int) -> TextRow | None:
        """A row whose cells are text; one that is out of order gets elements, of which it is said when they are met."""
        element = self._rows[number]
        name = element[0].get("r") if self._texts and len(element) else None
        if name is None or not name.startswith(PLACE_NAME):
            return None
        place = int(name.removeprefix(PLACE_NAME))
        stored = self._texts[place]
        if isinstance(stored, TextRow):
            return stored
        row = self._plain.row(place, number)
        if row is None:
            self._put_elements(number, stored.decode())
        else:
            self._texts[place] = self._indexed[number] = row
        return row

    def _cell(self, row: int, column: int) -> Element | None:
        formula = self.formulas.get((row, column))
        if formula is not None and not isinstance(formula, TextFormula):
            # Formulas are asked for most often, and their index spares that of the row.
            return formula
        return self._row(row).cells.get(column) if row in self._rows else None

    def _place(self, cell: Element) -> tuple[int, int]:
        if not cell.get("r"):
            # Indexing the row names its cells.
            self._row(int(cell.getparent().get("r")))
        try:
            place = parse_cell(cell.get("r"))
        except ValueError:
            place = (0, 0)
        if str(place[0]) != cell.getparent().get("r"):
            # Indexing the row says what is wrong.
            self._row(int(cell.getparent().get("r")))
        return place

    def _insert_text_rows(self, numbers: Iterable[int]) -> None:
        """Put in rows without cells, which are text."""
        rows = [TextRow(number) for number in numbers]
        places = "".join(
            f'<row r="{row.number}"><c r="{PLACE_NAME}{k}"/></row>'
            for k, row in enumerate(rows, len(self._texts))
        )
        elements = list(etree.fromstring(f'<d xmlns="{MAIN}">{places}</d>'))
        for row, element in zip(rows, elements, strict=True):
            self._insert_row(row.number, element)
            self._indexed[row.number] = row
        self._texts += rows

    def _insert_row(self, number: int, element: Element) -> None:
        position = bisect_left(self._row_numbers, number)
        if position:
            # Behind its neighbour: inserting by index would walk over all rows each time.
            self._rows[self._row_numbers[position - 1]].addnext(element)
        else:
            self._data.insert(0, element)
        self._rows[number] = element
        self._row_numbers.insert(position, number)

    @cached_property
    def _styled_columns(self) -> list[tuple[int, int, str | None]]:
        """First and last column, and style, of the columns that the sheet describes."""
        found = []
        for entry in self._root.iterfind(f"{main('cols')}/{main('col')}"):
            first = whole_number(entry.get("min"), MAX_COLUMN)
            last = whole_number(entry.get("max"), MAX_COLUMN)
            if first is None or last is None:
                raise damaged(
                    f"Sheet {self.name} sets the width of columns beyond the end of a sheet."
                )
            found.append((first, last, entry.get("style")))
        return found

    def _column_styles(self, rect: Rect) -> tuple[str | None, ...]:
        """Style of each column of a rectangle, as far as the sheet gives columns a style."""
        place = rect.left, rect.right
        if place not in self._known_styles:
            styles: list[str | None] = [None] * rect.width
            for first, last, style in self._styled_columns:
                for column in range(max(first, rect.left), min(last, rect.right) + 1):
                    styles[column - rect.left] = style
            self._known_styles[place] = tuple(styles)
        return self._known_styles[place]

    def _default_styles(
        self, number: int, column_styles: tuple[str | None, ...]
    ) -> tuple[str | None, ...]:
        """Styles of cells that do not exist yet: a formatted row goes before the columns."""
        element = self._rows.get(number)
        if element is not None and element.get("customFormat") in ("1", "true"):
            return (element.get("s"),) * len(column_styles)
        return column_styles

    def _styles(
        self,
        rect: Rect,
        there: Sequence[Row | TextRow | None],
        new: Sequence[str | None] | None = None,
    ) -> list[tuple[str | None, ...]]:
        """Styles of the cells of a rectangle, row by row: of those that exist their own, of others those that are new."""
        column_styles = self._column_styles(rect) if new is None else tuple(new)
        found = []
        for number, row in enumerate(there, rect.top):
            default = self._default_styles(number, column_styles) if new is None else column_styles
            found.append(default if row is None else row.styles_in(rect, default))
        return found

    def _graft(self, rect: Rect, texts: Sequence[str]) -> None:
        """Put rows of new cells, given as XML, in the place of the old cells of the rectangle."""
        if self._may_wait:
            self._insert_text_rows(
                number
                for number, text in enumerate(texts, rect.top)
                if text and number not in self._rows
            )
        left = [
            (number, text)
            for number, text in enumerate(texts, rect.top)
            if not self._may_wait or not self._put_text(number, rect, text)
        ]
        if not left:
            return
        body = "</row><row>".join(text for _, text in left).replace(FORMULA_CUT, "")
        built = etree.fromstring(f'<d xmlns="{MAIN}"><row>{body}</row></d>')
        for (number, _), new_row in zip(left, list(built), strict=True):
            if number in self._rows:
                row = self._row(number)
                row.take_out(rect)
                row.put_in(new_row[:])
            elif len(new_row):
                new_row.set("r", str(number))
                self._insert_row(number, new_row)

    def _put_text(self, number: int, rect: Rect, text: str) -> bool:
        """Put new cells in the place of the old ones as text; False where the row has elements."""
        if number not in self._rows:
            return True  # of cells that are not there, nothing is taken out
        row = self._row_as_it_is(number)
        if isinstance(row, Row):
            if len(row.element):
                return False
            if not text:
                return True
            place = row.element.makeelement(_C, r=f"{PLACE_NAME}{len(self._texts)}")
            row.element.append(place)
            row = self._indexed[number] = TextRow(number, states_span=True)
            self._texts.append(row)
        row.exchange(rect, text)
        if text and row.states_span:  # as in `Row.put_in`
            self._rows[number].attrib.pop("spans", None)
            row.states_span = False
        return True

    def _forget_blocks(self, rect: Rect) -> None:
        """Values of blocks that are changed in part are asked of the cells from now on."""
        self._blocks = [block for block in self._blocks if not block.rect.meets(rect)]

    # ---- formulas ----------------------------------------------------------------------------------------------

    def _note_formula(self, row: int, column: int, text: str) -> None:
        self._formula_before.setdefault((row, column), (row, column) in self.formulas)
        held = self._row_as_it_is(row)
        if isinstance(held, TextRow):
            self.formulas[row, column] = held.formulas[column] = TextFormula(text)
        else:
            self.formulas[row, column] = held.cells[column]

    def _drop_formula(self, row: int, column: int) -> None:
        self._formula_before.setdefault((row, column), True)
        if isinstance(self.formulas.pop((row, column)), TextFormula):
            held = self._row_as_it_is(row)
            assert isinstance(held, TextRow)
            del held.formulas[column]
        self.arrays.pop((row, column), None)

    def _forget_formulas(self, rect: Rect) -> None:
        """Prepare for overwriting a rectangle: shared formulas are written out, its formulas leave the index."""
        for row, column in self._unshare_all(rect):
            self._drop_formula(row, column)

    def _formulas_in(self, rect: Rect) -> list[tuple[int, int]]:
        if rect.is_single:
            # Scalars are written one by one; looking through all formulas each time would cost their product.
            place = (rect.top, rect.left)
            return [place] if place in self.formulas else []
        top, left, bottom, right = rect
        return [
            (row, column)
            for row, column in self.formulas
            if top <= row <= bottom and left <= column <= right
        ]

    def _unshare_all(self, rect: Rect) -> list[tuple[int, int]]:
        """Write out the shared formulas whose master lies in the rectangle, so that the other cells keep theirs.

        The places of all formulas in the rectangle are given back.
        """
        places = self._formulas_in(rect)
        for row, column in places:
            cell = self.formulas[row, column]
            formula = None if isinstance(cell, TextFormula) else cell.find(_F)
            if formula is not None and formula.get("t") == "shared" and formula.text:
                self._unshare(row, column, formula.get("si"), formula.text)
        return places

    def _unshare(self, row: int, column: int, group: str, text: str) -> None:
        for (to_row, to_column), cell in self.formulas.items():
            if isinstance(cell, TextFormula):
                continue
            formula = cell.find(_F)
            if formula.get("t") == "shared" and formula.get("si") == group:
                formula.text = shifted_formula(text, to_row - row, to_column - column)
                for attribute in ("t", "si", "ref"):
                    formula.attrib.pop(attribute, None)

    # ---- dimension ---------------------------------------------------------------------------------------------

    def _note_extent(self, rect: Rect) -> None:
        self._extent = rect if self._extent is None else self._extent.join(rect)

    def _update_dimension(self) -> None:
        dimension = self._root.find(main("dimension"))
        if dimension is None or self._extent is None:
            return
        try:
            old = parse_range(dimension.get("ref", ""))
        except ValueError:
            return
        if not old.covers(self._extent):
            dimension.set("ref", str(old.join(self._extent)))


def _length(text: str | None, usual: float) -> float:
    """A height or width as stored; the usual one where it is none."""
    try:
        return float(text) if text else usual
    except ValueError:
        return usual
