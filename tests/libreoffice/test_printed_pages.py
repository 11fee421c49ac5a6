"""What a workbook prints: few pages, each with something on it, at a scale that can be read."""

from __future__ import annotations

import math
import re
import shutil
import subprocess
import zipfile
from pathlib import Path

import numpy as np
import openpyxl
import pytest
from PIL import Image

from addin.contract.shipped import template_path
from addin.writing.recalculate import recalculate
from addin.xlsx import TableData, open_workbook

pytestmark = pytest.mark.slow

#: Most pages of a calculated example, and of a template that nobody has filled. [count]
CALCULATED, BLANK = 12, 8
#: Of the example with sections, a motor's data sheet in two pages, faults and their peaks. [count]
WITH_OPTIONAL_PARTS = CALCULATED + 5
#: Least scale of a sheet, and least height of its letters at full size. [%, point]
SCALE, LETTERS = 70, 8.0


#: Words of the foot of a page are no more apart in height. [point]
LEVEL = 0.1


def sheets_of_pages(pdf: Path) -> list[str]:
    """The sheet named at the foot of each page."""
    if shutil.which("pdftotext") is None:
        pytest.skip("poppler's pdftotext is not installed")
    done = subprocess.run(
        ["pdftotext", "-bbox", str(pdf), "-"], capture_output=True, check=True, text=True
    )
    sheets = []
    for page in done.stdout.split("<page ")[1:]:
        found = re.findall(
            r'xMin="([\d.]+)" yMin="([\d.]+)" xMax="[\d.]+" yMax="([\d.]+)">([^<]*)<', page
        )
        words = [(float(x), float(top), float(end), word) for x, top, end, word in found]
        level = max(
            ((top, end) for _, top, end, word in words if word == "Page"), default=(0.0, 0.0)
        )
        # LibreOffice also writes what a chart of the next page has at this height, and clips it
        foot = sorted((x, word) for x, *at, word in words if math.dist(at, level) < LEVEL)
        line = " ".join(word for _, word in foot)
        sheets += re.findall(r"^\S+\.xlsx? (.+?) Page \d+ of \d+$", line)
    return sheets


def printed_at_a_readable_size(path: Path) -> None:
    book = openpyxl.load_workbook(path)
    for sheet in book.worksheets:
        if sheet.sheet_state == "visible" and sheet.title not in ("Audit", "Notes"):
            assert SCALE <= sheet.page_setup.scale <= 100, sheet.title
            sizes = {cell.font.size for row in sheet.iter_rows() for cell in row if cell.value}
            assert min(sizes) >= LETTERS, sheet.title
            if sheet.print_area:
                printed = [
                    row
                    for area in sheet.print_area.split(",")
                    if ":" in area  # one cell is a sheet of which nothing is printed
                    for row in sheet[area.split("!")[-1]]
                ]
                cells = [cell for row in printed for cell in row if cell.value]
                low = min((cell.font.size for cell in cells), default=math.inf)
                assert low * sheet.page_setup.scale / 100 >= LETTERS, sheet.title


@pytest.mark.parametrize(
    ("design", "most"),
    [("proposed", CALCULATED), ("backlash", CALCULATED), ("motor", WITH_OPTIONAL_PARTS)],
)
def test_a_calculated_example(soffice, tmp_path: Path, design: str, most: int) -> None:
    source = shutil.copyfile(template_path(f"example_{design}.xlsx"), tmp_path / "train.xlsx")
    (written, *_) = recalculate(source, destination=tmp_path / "out.xlsx").written
    printed_at_a_readable_size(written)
    pdf = soffice.convert(written, "pdf")
    pages = sheets_of_pages(pdf)
    assert 0 < len(pages) <= most
    book = openpyxl.load_workbook(written)
    assert set(pages) == {
        sheet.title for sheet in book.worksheets if sheet.sheet_state == "visible"
    } - {"Audit", "Notes"}
    for number, page in enumerate(soffice.pages(pdf, dpi=50), 1):
        picture = np.asarray(Image.open(page).convert("L"))
        body = picture[int(0.2 * picture.shape[0]) : int(0.93 * picture.shape[0])]
        assert float(np.mean(body < 200)) > 0.01, f"page {number} is nearly blank"


def letters_below(pdf: Path, pages: int) -> list[str]:
    """Words of the first pages whose letters are lower than 8 pt, measured against the title of 16 pt at 70 %."""
    done = subprocess.run(
        ["pdftotext", "-bbox", "-l", str(pages), str(pdf), "-"],
        capture_output=True, check=True, text=True,
    )  # fmt: skip
    number = r'"([\d.]+)"'
    words = re.findall(
        rf"<word xMin={number} yMin={number} xMax={number} yMax={number}>([^<]*)<", done.stdout
    )
    sizes = []
    for left, top, right, bottom, word in words:
        height, width = float(bottom) - float(top), float(right) - float(left)
        # a short word that stands upright is as wide as its letters are high
        sizes.append((max(height, width) if len(word) <= 3 else height, word))
    title = next(size for size, word in sizes if word == "Torsional") / (0.7 * 16.0)
    return [word for size, word in sizes if size < 0.99 * LETTERS * title]


def on_paper(path: Path, made: Path, paper: int) -> Path:
    """A copy of a workbook that is printed on another paper: 1 = Letter, 9 = A4."""
    with zipfile.ZipFile(path) as old, zipfile.ZipFile(made, "w", zipfile.ZIP_DEFLATED) as new:
        for name in old.namelist():
            data = old.read(name)
            if name.startswith("xl/worksheets/sheet"):
                data = re.sub(rb' paperSize="\d+"', b"", data)
                data = data.replace(b"<pageSetup", b'<pageSetup paperSize="%d"' % paper)
            new.writestr(name, data)
    return made


@pytest.mark.parametrize("paper", [1, 9])
@pytest.mark.parametrize("design", ["proposed", "backlash"])
def test_a_case_with_conditions_on_both_papers(
    soffice, tmp_path: Path, design: str, paper: int
) -> None:
    book = open_workbook(template_path(f"example_{design}.xlsx"))
    columns = list(book.table("StartConditions").columns)
    rows = [
        {"Condition": "80 % voltage", "Kind": "start", "Voltage": 80},
        {"Condition": "hot", "Kind": "steady", "Stiffness factor": 0.9},
        {"Condition": "aborted", "Kind": "start", "Trip speed": 60},
    ]
    cells = [[row.get(name) for name in columns] for row in rows]
    book.write_tables([TableData("StartConditions", cells, columns)])
    typed = book.save(tmp_path / "train.xlsx").path
    (written, *_) = recalculate(typed, destination=tmp_path / "out.xlsx").written
    pdf = soffice.convert(on_paper(written, tmp_path / "printed.xlsx", paper), "pdf")
    pages = sheets_of_pages(pdf)
    assert 0 < len(pages) <= CALCULATED
    assert pages.count("Summary") == 2
    assert letters_below(pdf, 2) == []


@pytest.mark.parametrize("system", ["us", "si"])
def test_a_blank_template(soffice, tmp_path: Path, system: str) -> None:
    path = template_path(f"blank_{system}.xlsx")
    printed_at_a_readable_size(path)
    pages = sheets_of_pages(soffice.convert(path, "pdf"))
    assert 0 < len(pages) <= BLANK
    assert not {"Results", "Start", "Effects and accuracy", "Audit", "Notes"} & set(pages)
