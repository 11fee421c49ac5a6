"""Single cells: what may stand in them and how it reads back."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import openpyxl
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rich_workbooks import parts_of, with_parts
from strategies import example_count

from addin.xlsx import Formula, open_workbook
from addin.xlsx.errors import CellRefused, WorkbookMismatch
from addin.xlsx.values import MAX_TEXT

pytestmark = pytest.mark.filterwarnings("ignore::UserWarning:openpyxl")


def written(train: Path, value: Any, *, data_only: bool = True) -> Any:
    book = open_workbook(train)
    book.set_cell("Start-up", "D3", value)
    out = book.save(train.with_name("out.xlsx")).path
    return openpyxl.load_workbook(out, data_only=data_only)["Start-up"]["D3"].value


@pytest.mark.parametrize(
    "value",
    [
        0.1,
        -0.0,
        1e308,
        5e-324,
        123456789012345678.0,
        5,
        True,
        False,
        "text",
        " blank ends ",
        "a\nb\tc",
        "ÄÖ Ω 🎈",
        "",
    ],
)
def test_values_read_back(train: Path, value: Any) -> None:
    read = written(train, value)
    assert read == value or (value == "" and read is None)
    assert isinstance(read, bool) == isinstance(value, bool)


@pytest.mark.parametrize(
    "text",
    ["=1+1", "=cmd|' /C calc'!A0", "+1", "-1", "@SUM(A1)", "\t=1", "#N/A", "#REF!", "TRUE", "1e5"],
)
def test_text_never_becomes_a_formula_or_an_error(train: Path, text: str) -> None:
    book = open_workbook(train)
    book.set_cell("Start-up", "D3", text)
    out = book.save(train.with_name("out.xlsx")).path
    part = parts_of(out)["xl/worksheets/sheet4.xml"]
    assert b"<f" not in part
    assert open_workbook(out).value("Start-up", "D3") == text


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf, np.float64("nan"), 10**400])
def test_numbers_that_no_sheet_knows_are_refused(train: Path, value: Any) -> None:
    book = open_workbook(train)
    with pytest.raises(CellRefused, match="Start-up!D3"):
        book.set_cell("Start-up", "D3", value)
    with pytest.raises(CellRefused, match="Frequencies!C6"):
        book.write_table("Modes", [[1, value, 2, 3]])
    assert book.save(train.with_name("out.xlsx")).parts == ()


@pytest.mark.parametrize("value", [object(), [1], 1j, b"x"])
def test_other_things_are_refused(train: Path, value: Any) -> None:
    with pytest.raises(CellRefused, match="cannot hold"):
        open_workbook(train).set_cell("Start-up", "D3", value)


def test_numpy_values_are_numbers(train: Path) -> None:
    assert written(train, np.float64(1.5)) == 1.5
    assert written(train, np.int32(7)) == 7
    assert written(train, np.bool_(True)) is True


def test_control_characters_and_long_text(train: Path) -> None:
    assert written(train, "a\x00b\x1fc") == "a\ufffdb\ufffdc"
    assert written(train, "a\ud800b") == "a\ufffdb"
    assert written(train, "x" * 40_000) == "x" * MAX_TEXT
    assert len(written(train, "🎈" * 20_000)) <= MAX_TEXT // 2 + 1


def test_text_that_looks_like_an_escape_is_escaped(train: Path) -> None:
    book = open_workbook(train)
    book.set_cell("Start-up", "D3", "_x0041_")
    out = book.save(train.with_name("out.xlsx")).path
    assert b"_x005F_x0041_" in parts_of(out)["xl/worksheets/sheet4.xml"]
    assert open_workbook(out).value("Start-up", "D3") == "_x0041_"


def test_blank_keeps_the_style(train: Path) -> None:
    book = open_workbook(train)
    book.set_cell("Case", "A1", None)
    out = book.save(train.with_name("out.xlsx")).path
    before = openpyxl.load_workbook(train)["Case"]["A1"]
    after = openpyxl.load_workbook(out)["Case"]["A1"]
    assert after.value is None
    assert after.style_id == before.style_id != 0


def test_new_cells_take_the_style_of_their_row_or_column(train: Path) -> None:
    with_parts(
        train,
        {},
        {
            "xl/worksheets/sheet4.xml": lambda data: data.replace(
                b"<sheetData>",
                b'<cols><col min="6" max="7" width="9" style="1"/></cols><sheetData>',
            ).replace(b'<row r="6"', b'<row r="6" s="2" customFormat="1"')
        },
    )
    book = open_workbook(train)
    for cell in ("F9", "F6", "G100", "H9"):
        book.set_cell("Start-up", cell, 1.0)
    part = book.sheet_part("Start-up")
    assert [part.style(*place) for place in ((9, 6), (6, 6), (100, 7), (9, 8))] == [
        "1",
        "2",
        "1",
        None,
    ]


def test_formulas_are_not_overwritten_by_values(train: Path) -> None:
    book = open_workbook(train)
    with pytest.raises(CellRefused, match="holds a formula"):
        book.set_cell("Summary", "B1", 5.0)
    book.set_cell("Summary", "B1", 5.0, replace_formula=True)
    book.set_cell("Summary", "B2", Formula("2+1", 3.0))
    out = book.save(train.with_name("out.xlsx")).path
    values = openpyxl.load_workbook(out, data_only=True)["Summary"]
    assert [values[f"B{row}"].value for row in range(1, 5)] == [5, 3, 10, "low"]


def test_array_formulas_and_merged_cells_are_refused(train: Path) -> None:
    book = open_workbook(train)
    with pytest.raises(CellRefused, match="array formula in D1:D3"):
        book.set_cell("Summary", "D2", 1.0)
    with pytest.raises(CellRefused, match="array formula in D1:D3"):
        book.set_cell("Summary", "D1", 1.0, replace_formula=True)
    with pytest.raises(CellRefused, match="merged range A8:C8"):
        book.set_cell("Case", "B8", 1.0)
    book.set_cell("Case", "A8", "anchor")


def test_missing_sheets_names_and_tables_are_named(train: Path) -> None:
    book = open_workbook(train)
    with pytest.raises(WorkbookMismatch, match="no sheet 'Nowhere'; it has Case"):
        book.set_cell("Nowhere", "A1", 1)
    with pytest.raises(WorkbookMismatch, match="no defined name 'Power'"):
        book.set_name("Power", 1)
    with pytest.raises(WorkbookMismatch, match="a defined name without cells 'Twice'"):
        book.set_name("Twice", 1)
    with pytest.raises(WorkbookMismatch, match="no table 'Mode'; it has Modes"):
        book.write_table("Mode", [])
    with pytest.raises(WorkbookMismatch, match="no column 'Hertz'; it has Mode, Frequency"):
        book.write_table("Modes", [[1]], columns=["Hertz"])
    with pytest.raises(WorkbookMismatch, match="Row 2 for table Modes has 1 values for 4"):
        book.write_table("Modes", [[1, 2, 3, 4], [1]])


def test_names_ignore_capitals(train: Path) -> None:
    book = open_workbook(train)
    book.set_name("ratedpower", 3.0)
    book.set_cell("case", "b3", "t")
    book.write_table("MODES", [[9]], columns=["mode"])
    assert book.value("Case", "B2") == 3.0
    assert book.value("Case", "B3") == "t"
    assert book.value("Frequencies", "B6") == 9.0


def test_structure(train: Path) -> None:
    book = open_workbook(train)
    assert book.sheet_names == ["Case", "Frequencies", "Summary", "Start-up", "Owner's notes"]
    name = book.defined_names["RatedPower"]
    assert (name.sheet, name.ref) == ("Case", "B2")
    assert book.local_names["Case", "Local"].ref == "C2"
    table = book.tables["Modes"]
    assert (table.sheet, str(table.ref), str(table.data)) == ("Frequencies", "B5:E8", "B6:E8")
    assert table.columns == ("Mode", "Frequency", "CPM", "Ratio")
    assert table.header_row == 5


def test_dimension_follows(train: Path) -> None:
    book = open_workbook(train)
    book.set_cell("Start-up", "Z999", 1.0)
    out = book.save(train.with_name("out.xlsx")).path
    assert b'<dimension ref="A4:Z999"/>' in parts_of(out)["xl/worksheets/sheet4.xml"]


def test_shared_formulas_survive_the_loss_of_their_master(train: Path) -> None:
    """Excel states a filled formula once; who overwrites that cell must give the others their own text."""
    rows = "".join(
        f'<row r="{row}"><c r="A{row}"><v>{row}</v></c><c r="C{row}"><f t="shared" si="0"'
        + (f' ref="C20:C23">A{row}*$A$20+B20:B20' if row == 20 else ">")
        + f"</f><v>{row * 20}</v></c></row>"
        for row in range(20, 24)
    )
    with_parts(
        train,
        {},
        {
            "xl/worksheets/sheet4.xml": lambda data: data.replace(
                b"</sheetData>", rows.encode() + b"</sheetData>"
            )
        },
    )
    book = open_workbook(train)
    book.set_cell("Start-up", "C20", 1.0, replace_formula=True)
    book.set_cell("Start-up", "A21", 100.0)
    out = book.save(train.with_name("out.xlsx")).path
    formulas = openpyxl.load_workbook(out)["Start-up"]
    values = openpyxl.load_workbook(out, data_only=True)["Start-up"]
    assert formulas["C20"].value == 1
    assert formulas["C22"].value == "=A22*$A$20+B22:B22"
    assert values["C21"].value == 2000
    assert values["C22"].value == 440


cells = st.tuples(st.integers(1, 60), st.integers(1, 12))
constants = st.one_of(
    st.none(),
    st.booleans(),
    st.floats(allow_nan=False, allow_infinity=False),
    st.integers(-(2**53), 2**53),
    st.text(
        st.characters(exclude_categories=["Cs", "Cc"], exclude_characters="\ufffe\uffff"),
        max_size=30,
    ),
)


@pytest.mark.slow
@example_count(60)
@given(st.lists(st.tuples(cells, constants), max_size=40))
def test_random_edits_read_back(
    tmp_path_factory: pytest.TempPathFactory, built: dict[str, Path], edits: list[Any]
) -> None:
    from openpyxl.utils import get_column_letter

    book = open_workbook(built["xlsx"])
    expected: dict[str, Any] = {}
    for (row, column), value in edits:
        name = f"{get_column_letter(column)}{row}"
        book.set_cell("Start-up", name, value)
        expected[name] = value
    out = tmp_path_factory.mktemp("random") / "out.xlsx"
    book.save(out)
    again = open_workbook(out)
    theirs = openpyxl.load_workbook(out)["Start-up"]
    for name, value in expected.items():
        read = again.value("Start-up", name)
        assert read == value or (value == "" and read is None)
        if not (isinstance(value, str) and "_x" in value):
            assert theirs[name].value == value or (value == "" and theirs[name].value is None)
    rows = [row.get("r") for row in again.sheet_part("Start-up")._data]
    assert rows == sorted(rows, key=int)
