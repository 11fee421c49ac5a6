"""Study sheets on paper: text of some 7 points, no chart across a page, intervals that can be read."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import openpyxl
import pytest
from openpyxl.utils import column_index_from_string, range_boundaries
from openpyxl.worksheet.worksheet import Worksheet
from typer.testing import CliRunner

from addin.cli.app import app
from addin.contract.sheets import SHEETS
from addin.contract.shipped import template_path
from addin.contract.studies.registry import with_studies

#: Smallest text on paper, the widths of columns being a little different in each program. [pt]
LEAST = 6.8
#: Sheets with numbers behind charts alone, which nobody prints, are hidden. Those of a case: tests/libreoffice/test_printed_pages.py.
OWN = [
    sheet.name
    for sheet in with_studies(SHEETS)
    if sheet not in SHEETS and sheet.kind == "result" and not sheet.hidden
]


@pytest.fixture(scope="module")
def book() -> openpyxl.Workbook:
    return openpyxl.load_workbook(template_path("example_studies.xlsx"))


def pixels(sheet: Worksheet) -> dict[int, int]:
    """Width of each column. [px]"""
    found = {}
    for dimension in sheet.column_dimensions.values():
        for column in range(dimension.min, dimension.max + 1):
            found[column] = math.trunc(7.0 * dimension.width)  # stored with the padding
    return found


def last_column(sheet: Worksheet) -> int:
    if sheet.print_area:
        return range_boundaries(str(sheet.print_area).split("!")[-1])[2]
    return max(c for c, w in pixels(sheet).items() if w)


@pytest.mark.parametrize("name", OWN)
def test_text_on_paper_can_be_read(book: openpyxl.Workbook, name: str) -> None:
    sheet = book[name]
    if sheet.sheet_properties.pageSetUpPr and sheet.sheet_properties.pageSetUpPr.fitToPage:
        assert sheet.page_setup.fitToHeight == 0, "all of it on one page shrinks without end"
        width = sum(w for c, w in pixels(sheet).items() if c <= last_column(sheet))
        room = 96.0 * (11.0 - sheet.page_margins.left - sheet.page_margins.right)
        scale = min(1.0, room / width)
    else:
        scale = sheet.page_setup.scale / 100.0
    sizes = [cell.font.sz for row in sheet.iter_rows() for cell in row if cell.value is not None]
    assert scale >= 0.7, f"{name}: {scale:.0%}"
    assert scale * min(sizes) >= LEAST, f"{name}: {min(sizes)} pt at {scale:.0%}"


@pytest.mark.parametrize("name", OWN)
def test_no_page_ends_within_a_chart(book: openpyxl.Workbook, name: str) -> None:
    sheet = book[name]
    rows = [one.id for one in sheet.row_breaks.brk]
    columns = [one.id for one in sheet.col_breaks.brk]
    for chart in sheet._charts:
        first, last = chart.anchor._from, chart.anchor.to
        assert not [r for r in rows if first.row < r <= last.row], (name, rows)
        assert not [c for c in columns if first.col < c <= last.col], (name, columns)
        assert last.col < last_column(sheet), name
        for repeated in (sheet.print_title_cols,):
            if repeated:
                ends = repeated.replace("$", "").split(":")
                assert first.col >= column_index_from_string(ends[1]), "repeated on each page"


def table(path: Path, name: str) -> list[dict[str, Any]]:
    for sheet in openpyxl.load_workbook(path, data_only=True).worksheets:
        if name in sheet.tables:
            left, top, right, bottom = range_boundaries(sheet.tables[name].ref)
            head, *lines = sheet.iter_rows(top, bottom, left, right, values_only=True)
            return [dict(zip(head, line, strict=True)) for line in lines]
    raise AssertionError(name)


@pytest.mark.slow
def test_intervals_of_margins_and_peaks_stand_on_the_sheets(tmp_path: Path) -> None:
    told = CliRunner().invoke(
        app,
        ["tolerances", str(template_path("example_studies.xlsx")), "--samples", "60", "--jobs", "1",
         "--out", str(tmp_path)],
    )  # fmt: skip
    assert told.exit_code == 0, told.output
    (written,) = tmp_path.glob("*.xlsx")
    wide = 0
    for name, heads in (("ToleranceMargins", ("",)), ("TolerancePeaks", ("Torque ", "Stress "))):
        for row in table(written, name):
            for head in heads:
                for p in ("P10", "P50", "P90"):
                    low, value, high = (row[f"{head}{p}{end}"] for end in (" low", "", " high"))
                    if value is None:  # all margins together; an element without a stress
                        assert low is high is None
                        continue
                    assert low <= value <= high, (name, p)
                    wide += low < high
    assert wide > 50
