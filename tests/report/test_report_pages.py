"""Pages as they are printed: tables stay whole, none but the last of a chapter is half empty, all can be read."""

from __future__ import annotations

import re
import shutil
import zipfile
from pathlib import Path

import docx
import openpyxl
import pytest
from docx.shared import Mm
from hypothesis import given
from hypothesis import strategies as st
from openpyxl.utils import range_boundaries
from page_measures import Margins, half_empty, pages_of, smallest_letters, torn
from report_files import ROOT, Made, torsionbook

from addin.report.document import Column, Table
from addin.report.layout import rows_together
from addin.report.pages import Piece, page_ends

PAGE = 232.0


def filled(placed: list[Piece], ends: frozenset[int]) -> list[float]:
    """How far pages are filled where these ends are made, and others where nothing more fits. [mm]"""
    pages, at = [0.0], 0.0
    for piece in placed:
        if piece.first in ends or at + piece.height > PAGE:
            pages.append(0.0)
            at = 0.0
        pages[-1] = at + piece.height
        at += piece.height + piece.below
    return pages


@given(st.lists(st.floats(5.0, 0.44 * PAGE), min_size=2, max_size=40))
def test_pages_of_small_pieces_are_more_than_half_full(heights: list[float]) -> None:
    placed = [Piece(k, height, 5.0, False, k == 0) for k, height in enumerate(heights)]
    pages = filled(placed, page_ends(placed, PAGE, every=True))
    assert all(0.5 * PAGE <= page <= PAGE for page in pages[:-1])


def test_an_earlier_page_ends_sooner_for_a_later_one() -> None:
    """60, 35, 30 and 80 % of a page: filled one after the other the second page would hold 30 %."""
    placed = [Piece(k, share * PAGE, 0.0, False, k == 0) for k, share in enumerate((0.6, 0.35, 0.3, 0.8))]  # fmt: skip
    assert page_ends(placed, PAGE) == {1}
    assert page_ends(placed, PAGE, every=True) == {1, 3}


def test_groups_of_a_long_table_are_not_broken() -> None:
    names = ["A", "A", "B", "C", "C", "C", "", "D", "E"]
    table = Table("T", (Column("Element"), Column("n")), tuple((n, "1") for n in names))
    assert rows_together(table) == [3, 6]  # three rows at least at either end, and no group broken
    assert sum(rows_together(Table("T", table.columns, table.rows * 9))) == 81


@pytest.mark.parametrize("count", [1, 3, 5, 6, 7, 40])
def test_only_the_ends_of_a_table_of_single_rows_stay_together(count: int) -> None:
    """What stays together must fit a page: three rows at the beginning, three at the end."""
    table = Table("T", (Column("Element"),), tuple((f"E{k}",) for k in range(count)))
    together = rows_together(table)
    assert sum(together) == count
    assert together == ([count] if count < 6 else [3, *[1] * (count - 6), 3])


def chapters(path: Path) -> list[str]:
    """Headings of the chapters, as text of a page has them."""
    return [
        " ".join(paragraph.text.split())
        for paragraph in docx.Document(str(path)).paragraphs
        if paragraph.style is not None and paragraph.style.name == "Heading 1"
    ]


def check(pdf: Path, headings: list[str], margins: Margins) -> None:
    # a contents list says where chapters begin, the cover ends before it
    pages = pages_of(pdf, margins)[2:]
    assert len(pages) > 15
    assert half_empty(pages, headings) == []
    assert torn(pages) == []
    assert max(page.outside for page in pages) < 0.6


def smallest_run(path: Path) -> float:
    """The smallest size that a .docx states anywhere. [pt]"""
    with zipfile.ZipFile(path) as package:
        parts = [
            package.read(name).decode("utf-8")
            for name in package.namelist()
            if name.startswith("word/") and name.endswith(".xml")
        ]
    sizes = [int(half) / 2.0 for part in parts for half in re.findall(r'<w:sz w:val="(\d+)"', part)]
    assert len(sizes) > 100
    return min(sizes)


OWN = Margins(25.0, 22.0, 20.0)


def test_pages_of_the_pdf(proposed: Made) -> None:
    check(proposed.pdf, chapters(proposed.docx), OWN)
    assert smallest_letters(proposed.pdf) >= 8.0
    assert smallest_run(proposed.docx) >= 8.0


@pytest.mark.slow
@pytest.mark.parametrize(
    "name", ["motor", *(pytest.param(n, marks=pytest.mark.long) for n in ("proposed", "modified", "backlash"))]
)  # fmt: skip
def test_pages_of_every_example(name: str, tmp_path: Path, soffice) -> None:
    both(ROOT / "templates" / f"example_{name}.xlsx", tmp_path, soffice)


def both(source: Path, folder: Path, soffice) -> None:
    """The PDF, and the Word document as LibreOffice sets it."""
    done = torsionbook("report", source, "--pdf", "r.pdf", "--docx", "r.docx", cwd=folder)
    assert done.returncode == 0, done.stderr
    headings = chapters(folder / "r.docx")
    check(folder / "r.pdf", headings, OWN)
    check(soffice.convert(folder / "r.docx", "pdf"), headings, OWN)


@pytest.mark.slow
def test_pages_with_studies(studied: Path, tmp_path: Path, soffice) -> None:
    both(Path(shutil.copy2(studied, tmp_path / "train.xlsx")), tmp_path, soffice)


@pytest.mark.slow
def test_pages_with_a_standard_and_conditions(tmp_path: Path, soffice) -> None:
    book = openpyxl.load_workbook(ROOT / "templates" / "example_modified.xlsx")
    target = book.defined_names["Standard"].attr_text
    sheet, _, cell = target.rpartition("!")
    book[sheet.strip("'")][cell.replace("$", "")] = "API 617"
    sheet = book["Case"]
    left, top, right, _ = range_boundaries(sheet.tables["StartConditions"].ref)
    heads = [sheet.cell(top, column).value for column in range(left, right + 1)]
    for k, (head, value) in enumerate((("Voltage", 90), ("Stiffness factor", 0.9)), start=1):
        sheet.cell(top + k, left + heads.index("Condition")).value = f"other {head.lower()}"
        sheet.cell(top + k, left + heads.index(head)).value = value
    book.save(tmp_path / "train.xlsx")
    both(tmp_path / "train.xlsx", tmp_path, soffice)


@pytest.mark.slow
def test_pages_of_a_company_template(tmp_path: Path, soffice) -> None:
    file = docx.Document()
    page = file.sections[0]
    page.page_width, page.page_height = Mm(210), Mm(297)
    page.left_margin = page.right_margin = Mm(25)
    page.top_margin = page.bottom_margin = Mm(28)
    page.header.paragraphs[0].text = "ACME Turbo"
    file.save(str(tmp_path / "letter.docx"))
    source = ROOT / "templates" / "example_proposed.xlsx"
    done = torsionbook(
        "report", source, "--docx", "r.docx", "--word-template", "letter.docx", cwd=tmp_path
    )
    assert done.returncode == 0, done.stderr
    made = soffice.convert(tmp_path / "r.docx", "pdf")
    check(made, chapters(tmp_path / "r.docx"), Margins(28.0, 28.0, 25.0))
