"""Tables and blocks: resizing, what follows, what is in the way."""

import re
from pathlib import Path
from typing import Any

import openpyxl
import pytest
import xlsxwriter
from hypothesis import given
from hypothesis import strategies as st
from rich_workbooks import parts_of, rich_workbook, with_parts
from strategies import example_count

from addin.xlsx import Formula, ObstaclesFound, TableData, open_workbook
from addin.xlsx.errors import WorkbookMismatch

pytestmark = pytest.mark.filterwarnings("ignore::UserWarning:openpyxl")

RATIO = "=Modes[[#This Row],[Frequency]]/60"


COLUMNS = ["Mode", "Frequency", "CPM"]


def mode_rows(count: int) -> list[list[Any]]:
    return [[i, 10.0 * i, 600.0 * i, i / 6] for i in range(1, count + 1)]


def table_sheet(path: Path, *, data_only: bool = False) -> list[list[Any]]:
    sheet = openpyxl.load_workbook(path, data_only=data_only)["Frequencies"]
    return [[cell.value for cell in row] for row in sheet["B5:E36"]]


@pytest.mark.parametrize("count", [0, 1, 2, 3, 4, 25])
def test_table_fits_its_rows(train: Path, count: int) -> None:
    book = open_workbook(train)
    rows = [row[:3] for row in mode_rows(count)]
    book.write_table("Modes", rows, columns=COLUMNS, formulas={"Ratio": RATIO})
    out = book.save(train.with_name("out.xlsx")).path
    bottom = 5 + max(count, 1)
    table = openpyxl.load_workbook(out)["Frequencies"].tables["Modes"]
    assert table.ref == table.autoFilter.ref == f"B5:E{bottom}"
    values = table_sheet(out, data_only=True)
    assert values[1 : count + 1] == mode_rows(count)
    assert all(cell is None for row in values[count + 1 :] for cell in row)
    formulas = [row[3] for row in table_sheet(out)[1 : count + 1]]
    assert formulas == [RATIO] * count


def test_growing_and_shrinking_again_leaves_no_trace(train: Path) -> None:
    first = open_workbook(train)
    first.write_table("Modes", mode_rows(20))
    big = first.save(train.with_name("big.xlsx")).path
    second = open_workbook(big)
    second.write_table("Modes", mode_rows(2))
    small = second.save(train.with_name("small.xlsx")).path
    third = open_workbook(train)
    third.write_table("Modes", mode_rows(2))
    direct = third.save(train.with_name("direct.xlsx")).path
    part = "xl/worksheets/sheet2.xml"
    without = [
        re.sub(rb'<row r="\d+"[^>]*/>| spans="\d+:\d+"', b"", parts_of(path)[part])
        for path in (small, direct)
    ]
    assert without[0] == without[1]


def test_new_rows_take_the_styles_of_the_first(train: Path) -> None:
    book = open_workbook(train)
    book.write_table("Modes", mode_rows(10))
    out = book.save(train.with_name("out.xlsx")).path
    sheet = openpyxl.load_workbook(out)["Frequencies"]
    assert {sheet[f"C{row}"].number_format for row in range(6, 16)} == {"0.000"}
    assert sheet["C16"].number_format == "General"


def test_rules_over_exactly_the_data_follow(train: Path) -> None:
    book = open_workbook(train)
    book.write_table("Modes", mode_rows(9))
    part = parts_of(book.save(train.with_name("out.xlsx")).path)[
        "xl/worksheets/sheet2.xml"
    ].decode()
    assert re.findall(r'conditionalFormatting sqref="([^"]*)"', part) == [
        "C6:C14",
        "C6:C7",
        "D6:D14",
    ]
    assert re.findall(r"<xm:sqref>([^<]*)<", part) == ["C6:C7", "D6:D14", "G7"]
    assert re.findall(r'<dataValidation [^>]*sqref="([^"]*)"', part) == ["B6:B14"]
    assert "<xm:f>Frequencies!C6:C14</xm:f>" in part


def test_rules_shrink_too(train: Path) -> None:
    book = open_workbook(train)
    book.write_table("Modes", mode_rows(0))
    part = parts_of(book.save(train.with_name("out.xlsx")).path)[
        "xl/worksheets/sheet2.xml"
    ].decode()
    assert re.findall(r'conditionalFormatting sqref="([^"]*)"', part) == ["C6", "C6:C7", "D6"]


def test_calculated_column_is_stated_in_the_table(train: Path) -> None:
    book = open_workbook(train)
    rows = [[mode, frequency, ratio] for mode, frequency, _, ratio in mode_rows(4)]
    formulas = {"CPM": "=Modes[[#This Row],[Frequency]]*60"}
    book.write_table("Modes", rows, columns=["Mode", "Frequency", "Ratio"], formulas=formulas)
    part = parts_of(book.save(train.with_name("out.xlsx")).path)["xl/tables/table1.xml"].decode()
    assert (
        'name="CPM"><calculatedColumnFormula>Modes[[#This Row],[Frequency]]*60</calculatedColumnFormula>'
        in part
    )


def test_single_cells_of_a_row_may_be_formulas(train: Path) -> None:
    book = open_workbook(train)
    book.write_table("Modes", [[1, 2.0, Formula("=60*2", 120.0), None]])
    out = book.save(train.with_name("out.xlsx")).path
    assert table_sheet(out)[1] == [1, 2, "=60*2", None]
    assert table_sheet(out, data_only=True)[1] == [1, 2, 120, None]


def test_everything_in_the_way_is_listed_and_nothing_written(train: Path) -> None:
    with_parts(
        train,
        {},
        {
            "xl/worksheets/sheet2.xml": lambda data: data.replace(
                b"</sheetData>",
                b'<row r="45"><c r="D45"><f>1+1</f><v>2</v></c></row></sheetData>'
                b'<mergeCells count="1"><mergeCell ref="C42:D43"/></mergeCells>',
            )
        },
    )
    book = open_workbook(train)
    with pytest.raises(ObstaclesFound) as caught:
        book.write_tables([TableData("Modes", mode_rows(60))])
    found = {(one.cell, one.found) for one in caught.value.obstacles}
    assert found == {
        ("B40", "the text 'a note far below'"),
        ("C42:D43", "a merged range"),
        ("D45", "the formula =1+1"),
    }
    message = str(caught.value)
    assert "Frequencies!B40: the text 'a note far below' is in the way of table Modes." in message
    assert "Move this content" in message
    assert book.save(train.with_name("out.xlsx")).parts == ()
    assert [one.cell for one in book.obstacles({"Modes": 36})] == ["B40"]
    assert book.obstacles({"Modes": 34}) == []


def two_tables(path: Path, *, totals: bool = False) -> Path:
    """Table Upper in B2:C4 above table Lower in B9:C11; a user's columns in Upper: Remark and Twice."""
    book = xlsxwriter.Workbook(str(path))
    sheet = book.add_worksheet("S")
    columns: list[dict[str, Any]] = [
        {"header": "A", "total_function": "sum"} if totals else {"header": "A"},
        {"header": "B"},
        {"header": "Remark"},
        {"header": "Twice", "formula": "=Upper[[#This Row],[A]]*2"},
    ]
    bottom = 5 if totals else 4
    sheet.add_table(
        f"B2:E{bottom}",
        {
            "name": "Upper",
            "columns": columns,
            "data": [[1, 2, "r1"], [3, 4, "r2"]],
            "total_row": totals,
        },
    )
    sheet.write_formula("E3", "=Upper[[#This Row],[A]]*2", None, 2)
    sheet.write_formula("E4", "=Upper[[#This Row],[A]]*2", None, 6)
    if totals:
        sheet.write_formula("B5", "=SUBTOTAL(109,Upper[A])", None, 4)
    sheet.add_table(
        "B9:C11", {"name": "Lower", "columns": [{"header": "A"}, {"header": "B"}], "data": [[5, 6]]}
    )
    book.close()
    return path


def test_another_table_is_in_the_way(tmp_path: Path) -> None:
    book = open_workbook(two_tables(tmp_path / "t.xlsx"))
    with pytest.raises(ObstaclesFound, match="S!B9:C11: table Lower is in the way of table Upper"):
        book.write_table("Upper", [[1, 2]] * 7, columns=["A", "B"])
    book.write_table("Upper", [[1, 2]] * 6, columns=["A", "B"])


def test_obstacles_of_all_tables_come_at_once(tmp_path: Path) -> None:
    path = two_tables(tmp_path / "t.xlsx")
    with_parts(
        path,
        {},
        {
            "xl/worksheets/sheet1.xml": lambda data: data.replace(
                b"</sheetData>", b'<row r="15"><c r="C15"><v>9</v></c></row></sheetData>'
            )
        },
    )
    book = open_workbook(path)
    with pytest.raises(ObstaclesFound) as caught:
        book.write_tables(
            [
                TableData("Upper", [[1, 2]] * 20, ["A", "B"]),
                TableData("Lower", [[1, 2]] * 20),
            ]
        )
    assert {(one.table, one.cell) for one in caught.value.obstacles} == {
        ("Upper", "B9:C11"),
        ("Upper", "C15"),
        ("Lower", "C15"),
    }


def test_columns_of_the_user_stay_his(tmp_path: Path) -> None:
    path = two_tables(tmp_path / "t.xlsx")
    book = open_workbook(path)
    book.write_table("Upper", [[10, 20], [30, 40], [50, 60]], columns=["B", "A"])
    report = book.save(tmp_path / "out.xlsx")
    sheet = openpyxl.load_workbook(report.path, data_only=True)["S"]
    values = [[cell.value for cell in row] for row in sheet["B3:E5"]]
    assert values == [[20, 10, "r1", 40], [40, 30, "r2", 80], [60, 50, None, 120]]
    assert report.caches.method == "recalculated"


def test_what_the_user_typed_is_not_deleted_by_shrinking(tmp_path: Path) -> None:
    path = two_tables(tmp_path / "t.xlsx")
    book = open_workbook(path)
    book.write_table("Upper", [[10, 20]], columns=["A", "B"])
    report = book.save(tmp_path / "out.xlsx")
    sheet = openpyxl.load_workbook(report.path)["S"]
    assert [[cell.value for cell in row] for row in sheet["B3:E4"]] == [
        [10, 20, "r1", "=Upper[[#This Row],[A]]*2"],
        [None, None, "r2", None],
    ]
    assert any("below it at S!D4" in note for note in report.notes)


@pytest.mark.parametrize("count", [0, 1, 2, 4])
def test_totals_row_moves_along(tmp_path: Path, count: int) -> None:
    path = two_tables(tmp_path / "t.xlsx", totals=True)
    book = open_workbook(path)
    if count < 2:
        book.set_cell("S", "D4", None)
    book.write_table("Upper", [[10.0, 20.0]] * count, columns=["A", "B"])
    report = book.save(tmp_path / "out.xlsx")
    bottom = 3 + max(count, 1)
    shown = openpyxl.load_workbook(report.path, data_only=True)["S"]
    table = openpyxl.load_workbook(report.path)["S"].tables["Upper"]
    assert (table.ref, table.autoFilter.ref) == (f"B2:E{bottom}", f"B2:E{bottom - 1}")
    assert shown[f"B{bottom}"].value == 10 * count
    assert shown["B9"].value == "A"


def test_typed_where_the_totals_row_must_go(tmp_path: Path) -> None:
    book = open_workbook(two_tables(tmp_path / "t.xlsx", totals=True))
    with pytest.raises(ObstaclesFound, match="S!D4: the text 'r2' is in the way of table Upper"):
        book.write_table("Upper", [[10.0, 20.0]], columns=["A", "B"])
    assert book.save(tmp_path / "out.xlsx").parts == ()


def test_a_table_is_given_once(train: Path) -> None:
    with pytest.raises(WorkbookMismatch, match="twice"):
        open_workbook(train).write_tables([TableData("Modes", []), TableData("modes", [])])


def test_stale_filter_is_cleared(train: Path) -> None:
    with_parts(
        train,
        {},
        {
            "xl/tables/table1.xml": lambda data: data.replace(
                b'<autoFilter ref="B5:E8"/>',
                b'<autoFilter ref="B5:E8"><filterColumn colId="0"><filters><filter val="1"/></filters>'
                b'</filterColumn></autoFilter><sortState ref="B6:E8"><sortCondition ref="B6:B8"/></sortState>',
            ),
            "xl/worksheets/sheet2.xml": lambda data: data.replace(
                b'<row r="7"', b'<row r="7" hidden="1"'
            ),
        },
    )
    book = open_workbook(train)
    book.write_table("Modes", mode_rows(3))
    report = book.save(train.with_name("out.xlsx"))
    parts = parts_of(report.path)
    assert b"filterColumn" not in parts["xl/tables/table1.xml"]
    assert b"sortState" not in parts["xl/tables/table1.xml"]
    assert b"hidden" not in parts["xl/worksheets/sheet2.xml"]
    assert any("filter of table Modes was cleared" in note for note in report.notes)


def test_several_writes_to_one_table(train: Path) -> None:
    book = open_workbook(train)
    for count in (7, 0, 12, 2):
        book.write_table("Modes", mode_rows(count))
    out = book.save(train.with_name("out.xlsx")).path
    assert str(open_workbook(out).tables["Modes"].ref) == "B5:E7"
    assert table_sheet(out, data_only=True)[1:4] == [*mode_rows(2), [None] * 4]


@pytest.mark.slow
@example_count(25)
@given(st.lists(st.integers(0, 30), min_size=1, max_size=4))
def test_random_resizes(
    tmp_path_factory: pytest.TempPathFactory, built: dict[str, Path], counts: list[int]
) -> None:
    folder = tmp_path_factory.mktemp("resize")
    path = built["xlsx"]
    for step, count in enumerate(counts):
        book = open_workbook(path)
        rows = [row[:3] for row in mode_rows(count)]
        book.write_table("Modes", rows, columns=COLUMNS, formulas={"Ratio": RATIO})
        path = book.save(folder / f"{step}.xlsx").path
    values = table_sheet(path, data_only=True)
    assert values[1 : counts[-1] + 1] == mode_rows(counts[-1])
    assert all(cell is None for row in values[counts[-1] + 1 :] for cell in row)
    again = open_workbook(path)
    assert again.tables["Modes"].data.height == max(counts[-1], 1)
    assert again.shown_value("Summary", "B2") == counts[-1]
    assert again.value("Frequencies", "B40") == "a note far below"


def test_rich_workbook_is_built_the_same_twice(tmp_path: Path) -> None:
    first, second = (parts_of(rich_workbook(tmp_path / name)) for name in ("a.xlsx", "b.xlsx"))
    assert first == second
