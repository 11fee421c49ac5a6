"""What was written into a sheet, kept to be found again in the file before it is put in place."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import isfinite
from typing import Any

from addin.xlsx.errors import CellRefused
from addin.xlsx.references import Rect, cell_name
from addin.xlsx.sheet_part import SheetPart
from addin.xlsx.values import FORMULA_CUT, CellValue, Formula, are_plain_numbers, clean

_CELL_START = b"<c "
# A character that no XML can hold, other than that of a cut.
_BETWEEN = "\1"
# Where a piece is looked for first: behind the cells and rows that usually lie between.
_NEAR = 1500


@dataclass(frozen=True)
class Written:
    """A written rectangle: its values and the XML of its rows."""

    rect: Rect
    grid: Sequence[Sequence[CellValue]]
    texts: Sequence[str]

    def stands_in(self, part: bytes) -> bool:
        """Whether the rows stand in the part as they were built, in their order; a formula may have got its value."""
        position = 0
        # All rows are encoded at once; no text of a cell holds the mark between them.
        for text in _BETWEEN.join(self.texts).encode().split(_BETWEEN.encode()):
            for number, piece in enumerate(text.split(FORMULA_CUT.encode())):
                found = part.find(piece, position, position + len(piece) + _NEAR)
                if found < 0:
                    found = part.find(piece, position)
                # Between the pieces of a row only type and value of a formula may have come.
                if found < 0 or (number and _CELL_START in part[position:found]):
                    return False
                position = found + len(piece)
        return True

    def values(self) -> Iterator[tuple[tuple[int, int], CellValue]]:
        """Places and values of all cells, the blank ones below the rows given included."""
        blank = [None] * self.rect.width
        for offset in range(self.rect.height):
            row = self.grid[offset] if offset < len(self.grid) else blank
            for shift, value in enumerate(row):
                yield (self.rect.top + offset, self.rect.left + shift), value


def cleaned(sheet: str, row: int, column: int, value: Any) -> CellValue:
    """The value that a cell will hold; what it cannot hold is refused with its place."""
    try:
        return clean(value)
    except (ValueError, TypeError) as problem:
        raise CellRefused(sheet, cell_name(row, column), f"{problem}.") from problem


def cleaned_row(
    sheet: str, number: int, columns: Sequence[int], row: Sequence[Any]
) -> list[CellValue]:
    """The values that the cells of a row will hold."""
    if are_plain_numbers(row):
        return list(row)
    try:
        # Most cells are numbers; asking for that here spares a call for each.
        return [
            value if type(value) is float and isfinite(value) else clean(value) for value in row
        ]
    except (ValueError, TypeError):
        # Once more with the place, for the message.
        return [
            cleaned(sheet, number, column, value)
            for column, value in zip(columns, row, strict=True)
        ]


def misread(sheet: SheetPart, written: Sequence[Written]) -> Iterator[str]:
    """Cells of a sheet that hold something else than was written last."""
    last: dict[tuple[int, int], CellValue] = {}
    for cells in written:
        last.update(cells.values())
    for place, value in last.items():
        if not _same(sheet.value(*place), value):
            yield cell_name(*place)


def _same(read: CellValue, written: CellValue) -> bool:
    if isinstance(written, Formula) and isinstance(read, Formula):
        return read.text == written.text
    return read == written or (written == "" and read is None)
