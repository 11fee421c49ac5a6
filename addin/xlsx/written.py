"""What was written into a sheet, kept to be found again in the file before it is put in place."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
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
_ROW_START = re.compile(rb'<row [^<>]*?\br="([0-9]{1,7})"')


@dataclass(frozen=True)
class Written:
    """A written rectangle: its values and the XML of its rows."""

    rect: Rect
    grid: Sequence[Sequence[CellValue]]
    texts: Sequence[str]

    def stands_in(self, part: bytes, rows: Mapping[int, tuple[int, int]]) -> bool:
        """Whether the cells stand in the rows of the part as they were built; a formula may have got its value.

        Parameters
        ----------
        part : bytes
            The part.
        rows : mapping of int to tuple of int
            Its rows, see `places_of_rows`.
        """
        # All rows are encoded at once; no text of a cell holds the mark between them.
        encoded = _BETWEEN.join(self.texts).encode().split(_BETWEEN.encode())
        for number, text in enumerate(encoded, self.rect.top):
            position, end = rows.get(number, (0, 0))
            for k, piece in enumerate(text.split(FORMULA_CUT.encode()) if text else ()):
                found = part.find(piece, position, end)
                # Between the pieces of a row only type and value of a formula may have come.
                if found < 0 or (k and _CELL_START in part[position:found]):
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


def places_of_rows(part: bytes) -> dict[int, tuple[int, int]]:
    """Where each row begins and the next one does, by its number, in a part without prefixes."""
    found = [(int(row[1]), row.start()) for row in _ROW_START.finditer(part)]
    ends = [*(start for _, start in found[1:]), len(part)]
    return {number: (start, end) for (number, start), end in zip(found, ends, strict=False)}


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
