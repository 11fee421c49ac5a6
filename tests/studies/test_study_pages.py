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
from addin.contract.print_areas import page_columns
from addin.contract.sheet import Sheet
from addin.contract.shipped import template_path
from addin.contract.studies.registry import STUDIES, printed_parts

#: Smallest text on paper, the widths of columns being a little different in each program. [pt]
LEAST = 6.8
#: Parts of their sheets that are printed. Those of a case: tests/libreoffice/test_printed_pages.py.
PARTS = [part for study in STUDIES for part in printed_parts(study)]


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


@pytest.mark.parametrize("part", PARTS, ids=lambda part: part.name)
def test_text_on_paper_can_be_read(book: openpyxl.Workbook, part: Sheet) -> None:
    sheet = book[part.worksheet]
    scale = sheet.page_setup.scale / 100.0
    assert not sheet.sheet_properties.pageSetUpPr.fitToPage
    assert scale >= 0.7, f"{scale:.0%}"
    room = 96.0 * (11.0 - sheet.page_margins.left - sheet.page_margins.right)
    widths = pixels(sheet)
    pages = page_columns(part)
    for first, last in pages:
        assert scale * sum(widths[k] for k in range(first, last + 1)) <= room
    columns = range(pages[0][0], pages[-1][1] + 1)
    sizes = [
        cell.font.sz
        for row in sheet.iter_rows(min_col=columns[0], max_col=columns[-1])
        for cell in row
        if cell.value is not None
    ]
    assert scale * min(sizes) >= LEAST, f"{min(sizes)} pt at {scale:.0%}"


@pytest.mark.parametrize(
    "part", [part for part in PARTS if part.charts], ids=lambda part: part.name
)
def test_no_page_ends_within_a_chart(book: openpyxl.Workbook, part: Sheet) -> None:
    placed = {chart.anchor._from.col: chart.anchor for chart in book[part.worksheet]._charts}
    names = {
        column_index_from_string(part.at(at.cell).rstrip("0123456789")) - 1 for at in part.charts
    }
    assert names <= placed.keys()
    for anchor in (chart.anchor for chart in book[part.worksheet]._charts):
        first, last = anchor._from, anchor.to
        if not part.columns[0] <= first.col + 1 <= part.columns[1]:
            continue  # of another part
        assert not [r for r in part.row_breaks if first.row + 1 < r <= last.row + 1]
        assert [
            1 for begin, end in page_columns(part) if begin <= first.col + 1 and last.col + 1 <= end
        ]
        if part.repeated:
            assert first.col >= column_index_from_string(part.repeated.split(":")[1])


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
