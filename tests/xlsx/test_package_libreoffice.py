"""An independent spreadsheet program gets the same values from the files we write."""

from pathlib import Path
from typing import Any

import openpyxl
import pytest
from whatif_workbooks import (
    HANGING,
    RENEWED,
    UNTOUCHED,
    VARIED,
    circular_workbook,
    whatif_workbook,
)

from addin.xlsx import open_workbook

pytestmark = [
    pytest.mark.needs_libreoffice,
    pytest.mark.filterwarnings("ignore::UserWarning:openpyxl"),
]


@pytest.mark.first_ones(1)
@pytest.mark.parametrize("count", [1, 3, 20])
def test_libreoffice_calculates_the_cached_values(
    train: Path, soffice: Any, tmp_path: Path, count: int
) -> None:
    book = open_workbook(train)
    book.set_name("RatedPower", 5000.0)
    book.set_name("Title", "=not a formula")
    rows = [[i, 11.5 * i, 690.0 * i] for i in range(1, count + 1)]
    ratio = {"Ratio": "=Modes[[#This Row],[Frequency]]/60"}
    book.write_table("Modes", rows, columns=["Mode", "Frequency", "CPM"], formulas=ratio)
    for i in range(10):
        book.set_cell("Start-up", f"A{i + 5}", 0.1 * i if i < 7 else None)
        book.set_cell("Start-up", f"B{i + 5}", 3.0 * i if i < 7 else None)
    report = book.save(tmp_path / "out.xlsx")
    assert report.caches.removed == 0
    theirs = openpyxl.load_workbook(
        soffice.convert(report.path, "xlsx", tmp_path / "lo"), data_only=True
    )
    ours = openpyxl.load_workbook(report.path, data_only=True)
    formulas = openpyxl.load_workbook(report.path)
    compared = 0
    for sheet in formulas:
        for row in sheet.iter_rows():
            for cell in row:
                mine, other = (
                    values[sheet.title][cell.coordinate].value for values in (ours, theirs)
                )
                if cell.value == "=TODAY()":
                    continue
                if isinstance(mine, float | int) and not isinstance(mine, bool):
                    assert other == pytest.approx(mine, rel=1e-9), (
                        f"{sheet.title}!{cell.coordinate}"
                    )
                else:
                    assert other == mine, f"{sheet.title}!{cell.coordinate}"
                compared += cell.data_type == "f"
    assert compared >= 11 + count


@pytest.mark.slow
def test_libreoffice_fills_what_is_left_blank_of_data_tables(soffice: Any, tmp_path: Path) -> None:
    """And finds every other value as it stands: blank cells are those that it calculates otherwise than before."""
    book = open_workbook(whatif_workbook(tmp_path / "t.xlsx"))
    book.set_cell("In", "A1", 5.0)
    out = book.save(tmp_path / "out.xlsx").path
    ours, theirs = _both(out, soffice, tmp_path)
    for cell, value in (VARIED | HANGING | RENEWED | UNTOUCHED).items():
        assert theirs[cell].value == pytest.approx(value, rel=1e-12), cell
        assert ours[cell].value == (None if cell in VARIED | HANGING else value), cell


@pytest.mark.slow
def test_libreoffice_fills_what_is_left_blank_of_circles(soffice: Any, tmp_path: Path) -> None:
    book = open_workbook(circular_workbook(tmp_path / "t.xlsx"))
    book.set_cell("In", "A1", 30.0)
    out = book.save(tmp_path / "out.xlsx").path
    ours, theirs = _both(out, soffice, tmp_path)
    # A1 = In!A1 + A1/4, where the circle comes to rest
    for cell, value in (("A1", 40.0), ("B1", 20.0), ("C1", 400.0)):
        assert ours[cell].value is None
        assert theirs[cell].value == pytest.approx(value, rel=1e-6), cell
    for cell, value in (("D1", 60), ("D2", 61), ("E1", 2), ("E2", 2), ("E3", 6), ("D3", 36)):
        assert ours[cell].value == value
        assert theirs[cell].value == pytest.approx(value, rel=1e-6), cell


def _both(path: Path, soffice: Any, folder: Path) -> tuple[Any, Any]:
    """Sheet Out as it was written, and as LibreOffice saves it."""
    saved = soffice.convert(path, "xlsx", folder / "lo")
    return tuple(openpyxl.load_workbook(p, data_only=True)["Out"] for p in (path, saved))


def test_libreoffice_draws_every_page(macro_train: Path, soffice: Any, tmp_path: Path) -> None:
    book = open_workbook(macro_train)
    book.write_table("Modes", [[i, 1.0 * i, 2.0, 3.0] for i in range(30)])
    out = book.save(tmp_path / "out.xlsm").path
    pdf = soffice.convert(out, "pdf", tmp_path / "lo")
    assert pdf.stat().st_size > 5000
