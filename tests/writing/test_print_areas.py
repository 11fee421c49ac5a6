"""Print areas: those of torsionbook follow the results, those of the engineer stay."""

from __future__ import annotations

from pathlib import Path

import openpyxl
import pytest

from addin.contract.shipped import template_path
from addin.reading.workbook import read_workbook
from addin.writing.print_areas import renew_print_areas
from addin.xlsx import open_workbook

SOURCE = template_path("example_proposed.xlsx")


def renewed(source: Path, target: Path, printed: dict[str, int] | None = None) -> dict[str, str]:
    """The print area of each sheet after its tables were written."""
    workbook = open_workbook(source)
    modes = workbook.table("NaturalFrequencies")
    workbook.write_table(
        "NaturalFrequencies",
        [[k, 10.0 * k, 600.0 * k, None, 1.5, "Mesh", 50.0, "yes"] for k in range(30)],
        columns=modes.columns[:8],
    )
    renew_print_areas(workbook, printed or {})
    workbook.save(target)
    return {sheet.title: sheet.print_area for sheet in openpyxl.load_workbook(target).worksheets}


def test_a_part_is_printed_once_it_has_results(tmp_path: Path) -> None:
    areas = renewed(SOURCE, tmp_path / "out.xlsx")
    modes = open_workbook(tmp_path / "out.xlsx", read_only=True).table("NaturalFrequencies")
    assert modes.ref.height == 31
    # its columns, down to its last row; the other parts of the sheet hold nothing yet
    assert areas["Results"] == f"'Results'!$A$1:$J${modes.ref.bottom}"
    assert areas["Start"] == "'Start'!$A$1"
    assert areas["Audit"] == "'Audit'!$A$1"


def test_rows_that_decide_nothing_are_left_out(tmp_path: Path) -> None:
    areas = renewed(SOURCE, tmp_path / "out.xlsx", {"NaturalFrequencies": 21})
    modes = open_workbook(tmp_path / "out.xlsx", read_only=True).table("NaturalFrequencies")
    assert areas["Results"] == f"'Results'!$A$1:$J${modes.ref.top + 21}"


@pytest.mark.parametrize("area", ["A1:D20", "B2:V40", "A1:V40,B50:C60"])
def test_an_area_that_the_engineer_chose_stays(tmp_path: Path, area: str) -> None:
    book = openpyxl.load_workbook(SOURCE)
    book["Results"].print_area = area
    book.save(tmp_path / "own.xlsx")
    chosen = openpyxl.load_workbook(tmp_path / "own.xlsx")["Results"].print_area
    assert renewed(tmp_path / "own.xlsx", tmp_path / "out.xlsx")["Results"] == chosen


def test_sheets_under_other_names_are_found_by_their_tables(tmp_path: Path) -> None:
    book = openpyxl.load_workbook(SOURCE)
    book["Results"].title = "Ergebnisse"
    book.save(tmp_path / "own.xlsx")
    assert read_workbook(tmp_path / "own.xlsx").problems == ()
    areas = renewed(tmp_path / "own.xlsx", tmp_path / "out.xlsx")
    assert areas["Ergebnisse"].startswith("'Ergebnisse'!$A$1:$J$")


def test_a_table_moved_to_another_part_leaves_the_area_as_it_was(tmp_path: Path) -> None:
    book = openpyxl.load_workbook(SOURCE)
    sheet = book["Results"]
    before = sheet.print_area
    table = sheet.tables.pop("SteadyState")
    other = book["Audit"]
    table.ref = "F7:S8"
    for k, column in enumerate(table.tableColumns, 6):
        other.cell(7, k).value = column.name
    other.add_table(table)
    book.save(tmp_path / "own.xlsx")
    assert renewed(tmp_path / "own.xlsx", tmp_path / "out.xlsx")["Results"] == before
