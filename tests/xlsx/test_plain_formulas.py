"""Formulas give the same with cells in the place of parts of tables, and what is not certain is not calculated."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import openpyxl
import pytest
from hypothesis import given
from hypothesis import strategies as st
from openpyxl.worksheet.table import Table as OpenpyxlTable
from rich_workbooks import with_parts

from addin.xlsx import Formula, open_workbook
from addin.xlsx.dependents import FormulaCell, FormulaMap
from addin.xlsx.plain_formulas import Home, PlainFormulas
from addin.xlsx.references import Rect, cell_name, parse_range, quoted_sheet
from addin.xlsx.tables import Table
from addin.xlsx.workbook_part import DefinedName

#: Headers and how formulas write them: with marks to escape, or such that look like something else.
HEADERS = {
    "Flow": "Flow", "Head [m]": "Head '[m']", "It's": "It''s", "No. #": "No. '#", "Äre a": "Äre a",
    "2019": "2019", "#All": "'#All", "a:b, c": "a:b, c", "A1": "A1", "@x": "'@x", "two\nlines": "two\nlines",
}  # fmt: skip
#: Tables of four data rows: sheet, cells, whether the last row holds totals.
TABLES = {
    "T": ("Data", Rect(3, 2, 8, 12), True),
    "U": ("It's - data", Rect(1, 1, 5, 11), False),
    "V": ("Out", Rect(1, 1, 5, 11), False),
}


def tables() -> list[Table]:
    names = tuple(HEADERS)
    return [
        Table(name, sheet, ref, names, True, totals, (None,) * len(names), f"{name}.xml")
        for name, (sheet, ref, totals) in TABLES.items()
    ]


def book_of(path: Path, formulas: dict[tuple[str, str], str]) -> Path:
    """A workbook with the tables, with numbers that tell rows, columns and tables apart, and with formulas."""
    book = openpyxl.Workbook()
    book.remove(book.active)
    for k, (name, (sheet, ref, totals)) in enumerate(TABLES.items()):
        page = book.create_sheet(sheet)
        for at, header in enumerate(HEADERS, ref.left):
            page.cell(ref.top, at).value = header
            for row in range(ref.top + 1, ref.bottom + 1):
                page.cell(row, at).value = 1000 * k + 20 * row + at + 0.5
        table = OpenpyxlTable(displayName=name, ref=str(ref), totalsRowCount=int(totals) or None)
        table._initialise_columns()
        for column, header in zip(table.tableColumns, HEADERS, strict=True):
            column.name = header.replace("\n", "_x000a_")
        page.add_table(table)
    for (sheet, cell), formula in formulas.items():
        book[sheet][cell].value = f"={formula}"
    book.save(path)
    return path


#: Formulas that stand in no table, for each table; where LibreOffice 7.4 does not read what Excel writes (`T[#All]`, blanks)
#: or takes a name alone with header and totals, also how it is told the same.
ANYWHERE: dict[str, str | None] = {
    **{f"SUM(T[{written}])": None for written in HEADERS.values()},
    **{f"SUM(T[[{written}]])": None for written in HEADERS.values()},
    "SUM(t[FLOW],T[flow])": None,
    "ROWS(T)+SUM(INDEX(T,2,0))": "ROWS(T[[#Data]])+SUM(INDEX(T[[#Data]],2,0))",
    "ROWS(T[])": "ROWS(T[[#Data]])",
    "COUNTA(T[#All])": "COUNTA(T[[#All]])",
    "SUM(T[#Data])": "SUM(T[[#Data]])",
    "COUNTA(T[#Headers])": "COUNTA(T[[#Headers]])",
    "SUM(T[[Flow]:[2019]])": None,
    "SUM(T[[2019]:[Flow]])": None,
    "SUM(T[ [#Data] , [ Flow ] : [ 2019 ] ])": "SUM(T[[Flow]:[2019]])",
    "COUNTA(T[[#All],[Flow]])": None,
    "COUNTA(T[[#All],[Flow]:[It''s]])": None,
    "SUM(T[[#Data],[Flow]])": None,
    "T[[#Headers],[Head '[m']]]&T[[#Headers],['#All]]&T[[#Headers],[It''s]]": None,
    "COUNTA(T[[#Headers],[#Data],[Flow]])": None,
    "COUNTA(T[[#Headers],[#Data]])": None,
    "SUM(OFFSET(T[Flow],1,1))": None,
    "SUM(INDEX(T[Flow],2):INDEX(T[2019],3))": None,
    "SUM(T[[#Headers],[Flow]]:INDEX(T[Flow],3))": None,
    'COUNTIF(T[Flow],">=2060")&"T[Flow]"': None,
    "SUMPRODUCT(T[Flow]*T[2019])": None,
    "INDEX(T[It''s],MATCH(MAX(T[Flow]),T[Flow],0))": None,
}
TOTALS = {
    "T[[#Totals],[Flow]]": None,
    "SUM(T[#Totals])": "SUM(T[[#Totals]])",
    "SUM(T[[#Data],[#Totals],[Flow]:[2019]])": None,
}
#: Formulas beside a table, in a row of its data.
BESIDE = {
    "T[[#This Row],[Flow]]": None,
    "T[@Flow]-T[@[Head '[m']]]": "T[[#This Row],[Flow]]-T[[#This Row],[Head '[m']]]",
    "SUM(T[[#This Row],[Flow]:[2019]])": None,
    "SUM(T[@[Flow]:[2019]])": "SUM(T[[#This Row],[Flow]:[2019]])",
    "SUM(T[#This Row])": "SUM(T[[#This Row],[Flow]:[two\nlines]])",
    "SUM(T[@])": "SUM(T[[#This Row],[Flow]:[two\nlines]])",
    "COUNTA(T[[#Headers],[Flow]]:T[[#This Row],[Flow]])": None,
    "SUM(T[Flow])*T[[#This Row],['#All]]": None,
}


@pytest.mark.needs_libreoffice
def test_each_form_gives_what_libreoffice_gives(soffice: Any, tmp_path: Path) -> None:
    everything = ANYWHERE | TOTALS | BESIDE
    places: dict[tuple[str, str], tuple[str, str]] = {}
    for column, (name, (sheet, ref, totals)) in enumerate(TABLES.items(), start=30):
        for row, text in enumerate(ANYWHERE | (TOTALS if totals else {}), start=10):
            places["Out", cell_name(row, column)] = name, text
        for at, text in enumerate(BESIDE, start=ref.right + 2):
            places[sheet, cell_name(ref.top + 1, at)] = places[
                sheet, cell_name(ref.top + 4, at)
            ] = name, text
    ours, theirs = (
        {
            place: re.sub(r"\bT\b", name, (everything[text] or text) if theirs else text)
            for place, (name, text) in places.items()
        }
        for theirs in (False, True)
    )
    book = open_workbook(book_of(tmp_path / "ours.xlsx", {}))
    for (sheet, cell), text in ours.items():
        book.set_cell(sheet, cell, Formula(text, None))
    done = book.save(tmp_path / "done.xlsx")
    assert (done.caches.method, done.caches.removed) == ("recalculated", 0)
    saved = soffice.convert(book_of(tmp_path / "theirs.xlsx", theirs), "xlsx")
    read = openpyxl.load_workbook(saved, data_only=True)
    values = [(text, book.shown_value(*at), read[at[0]][at[1]].value) for at, text in ours.items()]
    assert [one for one in values if one[1] != one[2]] == []
    # none is the same for all
    assert len({value for _, value, _ in values}) > len(values) / 2


def plain(text: str, sheet: str = "Out", cell: str = "AA3", *names: DefinedName) -> str | None:
    return PlainFormulas(names, tables()).text(text, Home(sheet, (parse_range(cell),)))


@pytest.mark.parametrize(
    "text",
    [
        "T[Nope]", "T[[Flow],[2019]]", "T[[Flow]:[2019]:[A1]]", "T[[#All],[#Data]]", "T[[#Nope],[Flow]]",
        "T[#Nope]", "T[Head [m]]", "T[[Flow]", "T[", "[Flow]", "[", "Nope[Flow]", "Data!T[Flow]",
        "[1]!T[Flow]", "Data!T", "T[[#This Row],[Flow]]", "T[@Flow]", "U[#Totals]",
        "U[[#Data],[#Totals],[Flow]]", "T[[#All],]", "T[[#All],Flow:2019]", "T[[#All],#Data]", "T[,[Flow]]", "T[@[#All]]", "T[It's]",
        'INDIRECT("T[Flow]")', 'INDIRECT("T")', "INDIRECT(A1)", 'INDIRECT("A"&1)', "FORMULATEXT(A1)",
        '_xlfn.FORMULATEXT(A1)', 'EVALUATE("A1")', 'INDIRECT("A1"&A1,1)',
        'INDIRECT("A"&ROW(A3)+1)', 'INDIRECT("XFE"&ROW(A3))', 'INDIRECT("A"&ROW(A3)-1,FALSE)',
    ],
)  # fmt: skip
def test_what_is_not_certain_has_no_text(text: str) -> None:
    assert plain(text) is None
    assert plain(f"IFERROR(A1+SUM({text}),7)") is None
    assert FormulaMap(
        (FormulaCell("Out", parse_range("AA3"), text),), ("Data", "Out"), (), tuple(tables())
    ).areas == [None]


@pytest.mark.parametrize(
    "text",
    [
        "A1", '"T[Flow]"', "'T[Flow]'!A1", "[1]Sheet!A1", "'[1]It''s'!$A$1", "[1]!Name", "Name+TRUE", "T1+TT",
        'INDIRECT("Data!A1")', 'INDIRECT( "A1" ,TRUE)', 'INDIRECT("R1C1",FALSE)', "_xlpm.T+1", "T(1)", "TABLE(A1:B2,C3)",
        'INDIRECT("A"&ROW(A3)-1)',
    ],
)  # fmt: skip
def test_what_names_no_table_stays_as_it_is(text: str) -> None:
    assert plain(text) == text


def test_a_name_is_taken_before_a_table() -> None:
    """Programs allow no name of the workbook that a table has; of one that is confined to a sheet it is not certain."""
    assert plain("SUM(T)") == "SUM(Data!$B$4:$L$7)"
    assert plain("SUM(T)", "Out", "AA3", DefinedName("t", "Out!$A$1", "Out")) is None


def test_headers_that_differ_in_capitals_alone_are_told_apart() -> None:
    table = Table(
        "T", "S", Rect(1, 1, 3, 4), ("a", "A", "Straße", "STRASSE"), True, False, (), "t.xml"
    )
    found = {
        name: PlainFormulas((), [table]).text(f"T[{name}]")
        for name in ("a", "A", "Straße", "strasse")
    }
    assert found == {
        "a": "S!$A$2:$A$3",
        "A": "S!$B$2:$B$3",
        "Straße": "S!$C$2:$C$3",
        "strasse": None,
    }


def test_a_shared_formula_is_written_for_its_first_cell() -> None:
    """Where it is filled to a row without data, it is not certain."""
    shared = "V[[#This Row],[Flow]]+B2"
    cells = tuple(
        FormulaCell("Out", Rect(row, 20, row, 20), shared, (row - 2, 0)) for row in range(2, 7)
    )
    found = FormulaMap(cells, ("Data", "It's - data", "Out"), (), tuple(tables()))
    assert [cell.text for cell in found.cells] == ["$A2+B2"] * 4 + [""]
    assert found.rewritten == {("Out", 2, 20): "$A2+B2"}
    assert found.areas == [
        *([("Out", Rect(row, 1, row, 1)), ("Out", Rect(row, 2, row, 2))] for row in range(2, 6)),
        None,
    ]


def test_shared_and_array_formulas_are_renewed(tmp_path: Path) -> None:
    """Shared ones as Excel stores a filled column, beside the table and one row beyond it; an array formula over columns."""
    cells = {("Out", f"N{row}"): f"S{row}" for row in range(2, 7)}
    path = book_of(tmp_path / "t.xlsx", {**cells, ("Out", "P9"): "A9"})
    others = "".join(f'<f>S{row}</f>|<f t="shared" si="3"/>\n' for row in range(3, 7))
    exchanged = dict(line.split("|") for line in others.splitlines())
    exchanged["<f>S2</f>"] = (
        '<f t="shared" ref="N2:N6" si="3">V[[#This Row],[Flow]]+C2-Data!$B$8</f>'
    )
    exchanged["<f>A9</f>"] = '<f t="array" ref="P9">SUM(T[Flow]*V[2019])</f>'

    def more(data: bytes) -> bytes:
        for old, new in exchanged.items():
            assert old.encode() in data
            data = data.replace(old.encode(), new.encode())
        return data

    with_parts(path, {}, {"xl/worksheets/sheet3.xml": more})
    book = open_workbook(path)
    book.set_cell("Data", "B8", 1.0)
    book.set_cell("Data", "B4", 5.0)
    for row in range(2, 6):
        book.set_cell("Out", f"A{row}", 10.0 * row)
    report = book.save(tmp_path / "out.xlsx").caches
    # column C of V holds 2000 + 20 row + 3.5, column F 6.5 instead, and Flow of T 20 row + 2.5
    shared = [10 * row + 2000 + 20 * row + 3.5 - 1 for row in range(2, 6)]
    assert [book.shown_value("Out", f"N{row}") for row in range(2, 7)] == [*shared, None]
    flow, sums = [5.0, 102.5, 122.5, 142.5], [2000 + 20 * row + 6.5 for row in range(2, 6)]
    assert book.shown_value("Out", "P9") == sum(a * b for a, b in zip(flow, sums, strict=True))
    assert (report.method, report.removed) == ("recalculated", 1)


def test_the_row_of_an_array_formula_is_that_of_its_only_row() -> None:
    rects = {"N3:P3": "$A3", "N3:N4": None}
    for rect, text in rects.items():
        assert plain("V[[#This Row],[Flow]]", "Out", rect) == text


def test_the_table_around_a_formula_needs_no_name() -> None:
    assert plain("SUM([Flow])-[@2019]+[[#Headers],[A1]]", "Out", "C4") == "SUM($A$2:$A$5)-$F4+$I$1"
    # as XlsxWriter stores [@Flow]
    assert plain("[[#This Row],Flow]*2", "Out", "C4") == "$A4*2"


#: Words of a structured reference, and the rows that they mean in a table by those of its header, data and totals.
WORDS: dict[tuple[str, ...], Any] = {
    (): lambda ref, last, row: (ref.top + 1, last),
    ("#Data",): lambda ref, last, row: (ref.top + 1, last),
    ("#All",): lambda ref, last, row: (ref.top, ref.bottom),
    ("#Headers",): lambda ref, last, row: (ref.top, ref.top),
    ("#Headers", "#Data"): lambda ref, last, row: (ref.top, last),
    ("#Data", "#Headers"): lambda ref, last, row: (ref.top, last),
    ("#Totals",): lambda ref, last, row: (ref.bottom, ref.bottom),
    ("#Data", "#Totals"): lambda ref, last, row: (
        ref.top + 1,
        ref.bottom,
    ),
    ("#This Row",): lambda ref, last, row: (row, row),
    ("@",): lambda ref, last, row: (row, row),
}


@st.composite
def references(draw: st.DrawFn) -> tuple[str, str, str, str]:
    """Sheet and cell of a formula, a structured reference in it as people and programs spell it, and its cells."""
    name, (sheet, ref, totals) = draw(st.sampled_from(list(TABLES.items())))
    words = draw(st.sampled_from([one for one in WORDS if totals or "#Totals" not in one]))
    last = ref.bottom - totals
    is_this_row = words in (("#This Row",), ("@",))
    home = sheet if is_this_row else draw(st.sampled_from([s for s, _, _ in TABLES.values()]))
    row = draw(st.integers(ref.top + 1, last))
    blank = st.sampled_from(["", " "])
    headers = list(HEADERS.items())
    columns = draw(st.lists(st.integers(0, len(headers) - 1), max_size=2))
    written = [draw(blank) + headers[k][1] + draw(blank) for k in columns]
    spelled = [
        f"[{draw(blank)}{draw(st.sampled_from([str.lower, str.upper, str]))(one)}]"
        for one in words
        if one != "@"
    ]
    spelled += (
        [f"{draw(blank)}:{draw(blank)}".join(f"[{one}]" for one in written)] if columns else []
    )
    inside = f"{draw(blank)},{draw(blank)}".join(spelled)
    if len(spelled) == 1 and len(columns) < 2 and draw(st.booleans()):
        inside = inside[1:-1]
    inside = f"@{inside}" if words == ("@",) else inside
    top, bottom = WORDS[words](ref, last, row)
    ends = sorted(ref.left + k for k in columns) or [ref.left, ref.right]
    first, end = (cell_name(1, at).rstrip("1") for at in (ends[0], ends[-1]))
    if is_this_row:
        cells = ":".join(dict.fromkeys([f"${first}{top}", f"${end}{top}"]))
    else:
        cells = ":".join(dict.fromkeys([f"${first}${top}", f"${end}${bottom}"]))
    cells = cells if home == sheet else f"{quoted_sheet(sheet)}!{cells}"
    return (
        home,
        cell_name(row, 40),
        f"{draw(st.sampled_from([name, name.lower()]))}[{inside}]",
        cells,
    )


@given(references(), references(), st.sampled_from(["", '"T[Flow]"&', "SUM(A1)+", "'T[A1]'!B2*"]))
def test_each_spelling_means_its_cells(
    one: tuple[str, str, str, str], other: tuple[str, str, str, str], before: str
) -> None:
    home, cell, spelled, cells = one
    assert plain(f"{before}SUM({spelled})+1", home, cell) == f"{before}SUM({cells})+1"
    if other[:2] == one[:2]:
        text = f"{before}IF({spelled}>1,{other[2]},7)"
        assert plain(text, home, cell) == f"{before}IF({cells}>1,{other[3]},7)"
