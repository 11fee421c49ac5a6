"""What an independent spreadsheet program (LibreOffice) says about a workbook."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import openpyxl
import pytest
from openpyxl.utils import get_column_letter
from PIL import Image

from addin.xlsx import Workbook
from tests.opened import opened

#: Units of a rated torque, by their definitions: 0.3048 m and 0.45359237 kg at 9.80665 m/s². [N m]
TORQUES = {"N*m": 1.0, "kN*m": 1000.0, "lbf*ft": 0.3048 * 0.45359237 * 9.80665}
ERRORS = ("#N/A", "#NAME?", "#REF!", "#VALUE!", "#DIV/0!", "#NUM!", "#NULL!", "Err:")


def rated_torque(path: Path) -> float:
    """Rated torque that sheet Case shows, as another program reads it. [N m]"""
    book = opened(path)
    ((sheet, cell),) = book.defined_names["RatedTorque"].destinations
    value = book[sheet][cell]
    unit = value.offset(column=1).value
    return float(value.value) * TORQUES[unit]


def type_unit(workbook: Workbook, table: str, column: str, unit: str) -> None:
    """Another unit above a column."""
    place = workbook.table(table)
    letters = get_column_letter(place.ref.left + place.column_index(column))
    workbook.set_cell(place.sheet, f"{letters}{place.ref.top - 1}", unit)


def assert_caches_agree(path: Path, soffice) -> int:
    """Recalculate everything; every formula's value is the cached one to 1e-9, none an error."""
    formulas = openpyxl.load_workbook(path)
    cached = openpyxl.load_workbook(path, data_only=True)
    calculated = openpyxl.load_workbook(soffice.convert(path, "xlsx"), data_only=True)
    count = 0
    for sheet in formulas.worksheets:
        for row in sheet.iter_rows():
            for cell in row:
                now = calculated[sheet.title][cell.coordinate].value
                assert not str(now).startswith(ERRORS), (sheet.title, cell.coordinate, now)
                if cell.data_type != "f":
                    continue
                before = cached[sheet.title][cell.coordinate].value
                where = f"{sheet.title}!{cell.coordinate} {cell.value}"
                if isinstance(now, float | int):
                    assert before == pytest.approx(now, rel=1e-9, abs=1e-12), where
                else:
                    assert (before or "") == (now or ""), where
                count += 1
    assert count > 100
    return count


def assert_pages_have_ink(path: Path, soffice, at_least: int) -> None:
    """Every printed page shows more than its banner, strip and footer."""
    pages = soffice.pages(path, dpi=50)
    assert len(pages) >= at_least
    for number, page in enumerate(pages, 1):
        picture = np.asarray(Image.open(page).convert("L"))
        body = picture[int(0.16 * picture.shape[0]) : int(0.93 * picture.shape[0])]
        share = float(np.mean(body < 200))
        assert share > 0.001, f"page {number} of {path.name} is blank"
