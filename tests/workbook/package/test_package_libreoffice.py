"""An independent spreadsheet program gets the same values from the files we write."""

from pathlib import Path
from typing import Any

import openpyxl
import pytest

from addin.package import open_workbook

pytestmark = [
    pytest.mark.needs_libreoffice,
    pytest.mark.filterwarnings("ignore::UserWarning:openpyxl"),
]


@pytest.mark.parametrize("count", [1, 3, 20])
def test_libreoffice_calculates_the_cached_values(
    train: Path, soffice: Any, tmp_path: Path, count: int
) -> None:
    book = open_workbook(train)
    book.set_name("RatedPower", 5000.0)
    book.set_name("Title", "=not a formula")
    rows = [[i, 11.5 * i, 690.0 * i, 11.5 * i / 60] for i in range(1, count + 1)]
    book.write_table("Modes", rows, formulas={"Ratio": "=Modes[[#This Row],[Frequency]]/60"})
    book.write_block("Start-up", "A5:B14", [[0.1 * i, 3.0 * i] for i in range(7)])
    report = book.save(tmp_path / "out.xlsx")
    assert (report.caches.removed, report.caches.disagreements) == (0, ())
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


def test_libreoffice_draws_every_page(macro_train: Path, soffice: Any, tmp_path: Path) -> None:
    book = open_workbook(macro_train)
    book.write_table("Modes", [[i, 1.0 * i, 2.0, 3.0] for i in range(30)])
    out = book.save(tmp_path / "out.xlsm").path
    pdf = soffice.convert(out, "pdf", tmp_path / "lo")
    assert pdf.stat().st_size > 5000
