"""One row of a worksheet part with its cells as elements, by column."""

from __future__ import annotations

from bisect import bisect_left
from dataclasses import dataclass, field

from lxml import etree

from addin.xlsx.errors import damaged
from addin.xlsx.references import MAX_COLUMN, Rect, cell_name, column_number
from addin.xlsx.xml_part import Element, main

_C = main("c")


@dataclass
class Row:
    """A ``<row>`` with its cells by column and the columns in order."""

    element: Element
    cells: dict[int, Element] = field(default_factory=dict)
    columns: list[int] = field(default_factory=list)

    def columns_in(self, rect: Rect) -> list[int]:
        """Columns of a rectangle in which there are cells."""
        start = bisect_left(self.columns, rect.left)
        return self.columns[start : bisect_left(self.columns, rect.right + 1)]

    def styles_in(self, rect: Rect, new: tuple[str | None, ...]) -> tuple[str | None, ...]:
        """Styles of the cells in the columns of a rectangle; those given for cells that are not there."""
        styles = list(new)
        for column in self.columns_in(rect):
            styles[column - rect.left] = self.cells[column].get("s")
        return tuple(styles)

    def take_out(self, rect: Rect) -> list[Element]:
        """Remove the cells that lie in the columns of the rectangle."""
        start = bisect_left(self.columns, rect.left)
        stop = bisect_left(self.columns, rect.right + 1)
        taken: list[Element] = self.element[start:stop]
        del self.element[start:stop]
        for column in self.columns[start:stop]:
            del self.cells[column]
        del self.columns[start:stop]
        return taken

    def put_in(self, cells: list[Element]) -> None:
        """Insert neighbouring cells where the old ones are gone."""
        if not cells:
            return
        ending = self.element.get("r")
        columns = [column_number(cell.get("r").removesuffix(ending)) for cell in cells]
        position = bisect_left(self.columns, columns[0])
        self.element[position:position] = cells
        self.columns[position:position] = columns
        self.cells.update(zip(columns, cells, strict=True))
        # The span is a hint for readers and wrong as soon as a cell lies outside it; without it nothing is lost.
        self.element.attrib.pop("spans", None)


def index_row(sheet: str, number: int, element: Element) -> Row:
    """Row with its cells indexed; cells without a name get one.

    Raises
    ------
    WorkbookRefused
        When its cells are out of order, or beyond the last column.
    """
    row = Row(element)
    ending, last = str(number), 0
    try:
        for cell in row.element.iterchildren(_C):
            name = cell.get("r")
            if name:
                before, last = last, column_number(name.removesuffix(ending))
                if not before < last <= MAX_COLUMN:
                    raise ValueError("cells are out of order or beyond the last column")
            else:
                # Cells without a name follow the one before them; that would go wrong once one is inserted.
                last += 1
                cell.set("r", cell_name(number, last))
            row.cells[last] = cell
            row.columns.append(last)
    except ValueError as problem:
        raise damaged(
            f"Sheet {sheet} has a wrongly placed cell {str(name)[:40]!r} in row {number}."
        ) from problem
    if len(row.columns) != len(row.element):
        # Positions of cells are used below: comments between them would shift these.
        etree.strip_tags(row.element, etree.Comment, etree.ProcessingInstruction)
    return row
