"""Rows that hold nothing but values and plain formulas stay text until somebody asks for a cell or the sheet is stored.

Expected: the same bytes and the same values as with rows that become elements at once.
"""

from __future__ import annotations

import random
import re

import pytest

from addin.charts.rows import plain
from addin.xlsx.errors import WorkbookRefused
from addin.xlsx.references import Rect
from addin.xlsx.sheet_part import SheetPart
from addin.xlsx.values import CellValue, Formula
from addin.xlsx.written import cleaned_row
from addin.xlsx.xml_part import MAIN, parse_part, serialise

SHEET = (
    f"""<worksheet xmlns="{MAIN}"><cols><col min="3" max="4" style="5"/></cols><sheetData>
<row r="2" spans="1:9" ht="20"><c r="A2" s="3"><v>1</v></c><c r="H2" t="str"><v>x</v></c></row>
<row r="5" s="7" customFormat="1"><c r="B5" s="4"/><c r="C5"><f>1+1</f><v>2</v></c><c r="E5" s="2" t="str"><f>"a"&amp;"b "</f>
<v>ab </v></c></row><row r="6"><c r="A6" t="b"><f>1&lt;2</f><v>1</v></c><c r="D6"><f>A6</f></c><c r="G6"><v>4</v></c></row>
<row r="7" spans="2:6"><c r="B7" s="8"><v>1.5</v></c><c r="C7" s="9"/><c r="E7" t="inlineStr"><is><t>a &amp; b</t></is></c>
<c r="F7"><v>3</v></c></row><row r="8"><c r="A8"><v>2</v></c><c r="D8" s="6"/><c r="H8"><v>-1e-9</v></c></row>
<row r="9"/><row r="12"><c r="C12" s="2"><v>7</v></c></row></sheetData></worksheet>""".replace(
        ">\n<v", "><v"
    )
    .replace("</c>\n", "</c>")
    .encode()
)
LAST = 30


def _sheet(waits: bool, data: bytes = SHEET) -> SheetPart:
    # In a sheet with a comment nothing waits.
    data = data if waits else data.replace(b"<cols>", b"<!-- --><cols>")
    return SheetPart("S", "s.xml", data, lambda index: index)


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
        place = chance.choice([(top, left), *sorted(sheet.formulas)])
        return sheet.set_cached(
            *place, chance.choice([1.5, " a <b> & c", "\a\r_x000A_", True, None])
        )
    if what == 8:
        held = [sheet.value(top, column) for column in range(left, rect.right + 1)]
        filled, cells = list(sheet.filled_cells(rect)), list(sheet.cells_in(rect))
        return held, sheet.constants(rect), filled, cells
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
    parsed = at_once.to_bytes().replace(b"<!-- -->", b"")
    assert stored.replace(b"\n", b"") == parsed.replace(b"\n", b"")


def test_a_row_with_formulas_stays_text() -> None:
    sheet = _sheet(waits=True)
    assert sheet.value(5, 5) == Formula('"a"&"b "', "ab ")
    sheet.write_rows(Rect(6, 3, 6, 5), [[1.0, Formula("C6*2"), "x"]])
    sheet.set_cached(6, 4, 2.0)
    sheet.set_cached(6, 1, "<")
    assert (sheet.constant(6, 4), sheet.constant(6, 1)) == (2.0, "<")
    assert not any(len(sheet._rows[row]) > 1 for row in (5, 6))
    assert (
        b'<row r="6"><c r="A6" t="str"><f>1&lt;2</f><v>&lt;</v></c><c r="C6" s="5"><v>1</v></c><c r="D6">'
        b'<f>C6*2</f><v>2</v></c><c r="E6" t="inlineStr"><is><t>x</t></is></c><c r="G6"><v>4</v></c></row>'
    ) in sheet.to_bytes()


def test_rows_stay_text_side_by_side() -> None:
    sheet = _sheet(waits=True)
    for left in (1, 4, 7):
        sheet.write_rows(Rect(10, left, 19, left + 2), [[1.5, 2.0, None]] * 10, styles=[None] * 3)
    assert not any(len(sheet._rows[row]) > 1 for row in range(10, 20))
    assert b'<row r="10"><c r="A10"><v>1.5</v></c><c r="B10"><v>2</v></c>' in sheet.to_bytes()
    assert sheet.value(19, 7) == 1.5  # asked for, it becomes cells, and nothing else changes


#: What may stand in a sheet, and whether its rows may stay text.
OTHERWISE = {
    "as it is": ("", "", True),
    "an attribute of a newer Excel": ('<row r="7"', '<row r="7" x:dyDescent="0.2"', True),
    "other letters": ("a &amp; b", "ä € &lt;", True),
    "a prefix": ("", "", False),
    "a comment": ("<row", "<!-- <row><c/></row> --><row", False),
    "an instruction": ("<row", "<?x y?><row", False),
    "character data": ("<v>7</v>", "<v><![CDATA[7]]></v>", False),
    "the name of a place": ("<v>3</v>", "<v>written-1</v>", False),
    "single quotes": ('r="C12"', "r='C12'", True),
    "blanks in a row": ('<c r="E7"', '\n  <c r="E7"', True),
    "an extension": ("<v>7</v></c>", "<v>7</v><extLst><ext/></extLst></c>", True),
    "a row in an extension": (
        "<v>7</v></c>",
        '<v>7</v><extLst><row r="9"><c r="A1"><v>5</v></c></row></extLst></c>',
        True,
    ),
    "a cell without a name": ('<c r="D8" s="6"/>', '<c s="6"/>', True),
    "a text with a font": ("<is><t>a &amp; b</t></is>", "<is><r><t>a</t></r></is>", True),
    "a rich value": ('<c r="D8"', '<c r="D8" vm="1"', True),
}


def _as_stored(how: str, encoding: str = "UTF-8") -> bytes:
    there, instead, _ = OTHERWISE[how]
    text = SHEET.decode().replace(there, instead) if there else SHEET.decode()
    text = text.replace("<worksheet ", '<worksheet xmlns:x="http://x" ')
    if how == "a prefix":
        text = text.replace("xmlns=", "xmlns:m=").replace("</", "</m:")
        text = re.sub(r"<(?=[a-z])", "<m:", text)
    return f'<?xml version="1.0" encoding="{encoding}"?>{text}'.encode(encoding)


@pytest.mark.parametrize("encoding", ["UTF-8", "UTF-16", "ISO-8859-15"])
@pytest.mark.parametrize("how", OTHERWISE)
def test_a_sheet_is_stored_as_if_it_had_been_parsed(how: str, encoding: str) -> None:
    data = _as_stored(how, encoding)
    root = parse_part(data, "s.xml")
    sheet = SheetPart("S", "s.xml", data, lambda index: index)
    assert sheet.to_bytes() == serialise(root, data)
    assert bool(sheet._texts) is (OTHERWISE[how][2] and encoding == "UTF-8")
    commented = data.decode(encoding).replace("sheetData>", "sheetData><!-- -->", 1)
    parsed = SheetPart("S", "s.xml", commented.encode(encoding), lambda index: index)
    for one in (sheet, parsed):
        one.set_cached(12, 3, 8.5)
        one.write_rows(Rect(8, 4, 8, 4), [[2.5]])
        one.remove_cells(Rect(7, 2, 7, 9))
    assert sheet.to_bytes() == parsed.to_bytes().replace(b"<!-- -->", b"")


@pytest.mark.parametrize(
    ("there", "broken"),
    [
        ("</sheetData>", "</sheetDat>"),
        ("<v>7</v>", "<v>7</w>"),
        ("<v>7</v>", "<v>\x01</v>"),
        ("<v>7</v>", "<v>&no;</v>"),
        ("<v>7</v>", "<v>\ufffe</v>"),
        ('<row r="12">', '<row r="12" r="12">'),
        ('<row r="12">', '<row r="12" y:z="1">'),
        ('<row r="12">', '<row r="12"/>'),
        ('<row r="12">', '<row r="8">'),
        ("<sheetData>", "<sheetDatas>"),
    ],
)
def test_what_is_wrong_is_said_of_the_part_as_it_is_stored(there: str, broken: str) -> None:
    messages = []
    for data in (SHEET, SHEET.replace(b"<sheetData>", b"<sheetData><!---->")):
        wrong = data.decode().replace(there, broken).encode()
        with pytest.raises(WorkbookRefused) as refused:
            SheetPart("S", "s.xml", wrong, lambda index: index)
        messages.append(re.sub("column [0-9]+", "", str(refused.value)))
    assert messages[0] == messages[1]


@pytest.mark.parametrize("cells", ["C8 B8", "B8 B8", "B9", "B18", "XFE8", "B8 C9"])
def test_wrongly_placed_cells_are_refused_when_they_are_met(cells: str) -> None:
    row = "".join(f'<c r="{cell}"><v>1</v></c>' for cell in cells.split())
    data = f'<worksheet xmlns="{MAIN}"><sheetData><row r="8">{row}</row></sheetData></worksheet>'
    sheet = SheetPart("S", "s.xml", data.encode(), lambda index: index)
    with pytest.raises(WorkbookRefused, match="wrongly placed cell"):
        sheet.write_rows(Rect(8, 4, 8, 4), [[2.5]])
    with pytest.raises(WorkbookRefused, match="wrongly placed cell"):
        sheet.value(8, 2)


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
