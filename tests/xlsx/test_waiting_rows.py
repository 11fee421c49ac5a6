"""Rows of long blocks stay text until somebody asks for a cell or the sheet is stored.

Expected: the same bytes and the same values as with rows that become elements at once.
"""

from __future__ import annotations

import random
from itertools import pairwise

import pytest

from addin.charts.rows import plain
from addin.xlsx.references import Rect
from addin.xlsx.sheet_part import SheetPart
from addin.xlsx.values import CellValue, Formula
from addin.xlsx.written import cleaned_row
from addin.xlsx.xml_part import MAIN

SHEET = f"""<worksheet xmlns="{MAIN}"><cols><col min="3" max="4" style="5"/></cols><sheetData>
<row r="2" spans="1:9" ht="20"><c r="A2" s="3"><v>1</v></c><c r="H2" t="str"><v>x</v></c></row>
<row r="5" s="7" customFormat="1"><c r="B5" s="4"/><c r="C5"><f>1+1</f><v>2</v></c></row>
<row r="9"/></sheetData></worksheet>""".encode()
LAST = 30


def _sheet(waits: bool, data: bytes = SHEET) -> SheetPart:
    sheet = SheetPart("S", "s.xml", data, lambda index: index)
    sheet._may_wait = sheet._may_wait and waits
    return sheet


def _value(chance: random.Random) -> CellValue:
    number = chance.choice([chance.uniform(-1e9, 1e9), float(chance.randint(-9, 9)), 1e22, 0.0])
    return chance.choice([number, number, number, None, "a <b> & c", "", True, 7])


def _do(sheet: SheetPart, chance: random.Random) -> object:
    """One thing that people who write into a sheet do."""
    top, left = chance.randint(1, 20), chance.randint(1, 9)
    rect = Rect(top, left, top + chance.choice([0, 3, 9]), left + chance.randint(0, 3))
    what = chance.randint(0, 9)
    if what < 6:
        rows = [[_value(chance) for _ in range(rect.width)] for _ in range(rect.height)]
        if what == 5:
            rows[0][0] = Formula("A1*2", 3.0)
        styles = chance.choice([None, [None] * rect.width, ["4"] * rect.width])
        return sheet.write_rows(rect, rows, styles=styles)
    if what == 6:
        return sheet.remove_cells(rect)
    if what == 7:
        return sheet.set_cached(top, left, 1.5)
    if what == 8:
        return sheet.constants(rect), list(sheet.filled_cells(rect)), list(sheet.cells_in(rect))
    return sheet.move_row_cells(rect._replace(bottom=top), LAST + chance.randint(0, 2))


@pytest.mark.parametrize("seed", range(60))
def test_a_sheet_is_the_same_whether_its_rows_wait_or_not(seed: int) -> None:
    waiting, at_once = _sheet(waits=True), _sheet(waits=False)
    mine, other = random.Random(seed), random.Random(seed)
    for _ in range(25):
        assert _do(waiting, mine) == _do(at_once, other)
    stored = waiting.to_bytes()
    again = SheetPart("S", "s.xml", stored, lambda index: index)
    places = [(row, column) for row in range(1, LAST + 3) for column in range(1, 14)]
    for row, column in places:
        assert again.value(row, column) == at_once.value(row, column)
        assert again.style(row, column) == at_once.style(row, column)
    # Blanks between rows mean nothing; a row that is exchanged whole loses the one behind it.
    assert stored.replace(b"\n", b"") == at_once.to_bytes().replace(b"\n", b"")


def test_rows_do_wait_side_by_side_as_one_run() -> None:
    sheet = _sheet(waits=True)
    for left in (1, 4, 7):
        sheet.write_rows(Rect(10, left, 19, left + 2), [[1.5, 2.0, None]] * 10, styles=[None] * 3)
    assert len(sheet._texts) == 10
    assert b'<row r="10"><c r="A10"><v>1.5</v></c><c r="B10"><v>2</v></c>' in sheet.to_bytes()
    assert sheet.value(19, 7) == 1.5  # asked for, it becomes cells, and nothing else changes
    assert b"written-" not in sheet.to_bytes()
    rows = [part.partition(b'"')[0] for part in sheet.to_bytes().split(b'<row r="')[1:]]
    assert all(int(a) < int(b) for a, b in pairwise(rows))


@pytest.mark.parametrize(
    "data",
    [
        SHEET.replace(b'<row r="9"/>', b'<row r="9"><c r="written-0"/></row>'),
        SHEET.replace(b"<", b"<x:").replace(b"<x:/", b"</x:").replace(b"xmlns=", b"xmlns:x="),
    ],
    ids=["a cell with such a name", "tags with a prefix"],
)
def test_rows_do_not_wait_where_their_text_would_be_mistaken(data: bytes) -> None:
    sheet = _sheet(waits=True, data=data)
    sheet.write_rows(Rect(10, 1, 29, 2), [[1.5, 2.5]] * 20, styles=[None] * 2)
    assert not sheet._texts
    assert sheet.value(29, 2) == 2.5
    assert (b'written-0"' in sheet.to_bytes()) == (b"written-0" in data)


def test_rows_of_numbers_are_cleaned_as_any_row_is() -> None:
    huge = [1e308, 1e308, -1.0]  # their sum is not finite, each of them is
    assert cleaned_row("S", 1, [1, 2, 3], huge) == huge
    assert cleaned_row("S", 1, [1, 2, 3], [1.0, None, 2]) == [1.0, None, 2.0]
    for bad in (float("nan"), float("inf")):
        with pytest.raises(Exception, match="not a valid cell number"):
            cleaned_row("S", 1, [1, 2], [1.0, bad])
    with pytest.raises(Exception, match="not a valid cell number"):
        cleaned_row("S", 1, [1, 2], [float("inf"), float("-inf")])


def test_six_digits_of_many_numbers_are_those_of_each() -> None:
    chance = random.Random(2)
    values = [chance.uniform(-1, 1) * 10.0 ** chance.randint(-300, 300) for _ in range(2000)]
    values += [0.0, -0.0, 1e22, 999999.5, 123456.5, 5e-324]
    assert plain(values) == [float(f"{value:.6g}") for value in values]
    assert plain([1.0, float("nan"), float("inf")]) == [1.0, None, None]
    assert plain([]) == []
