"""Chapter Cases: the conditions typed, their verdicts, and which governs."""

from __future__ import annotations

from pathlib import Path

import docx
import openpyxl
import pytest
from openpyxl.utils import range_boundaries
from report_files import ROOT, docx_text

from addin.report.cases import _decides, _share
from addin.report.make import report


def typed(path: Path, *rows: dict[str, object]) -> Path:
    book = openpyxl.load_workbook(ROOT / "templates" / "example_modified.xlsx")
    sheet = book["Case"]
    left, top, right, _ = range_boundaries(sheet.tables["StartConditions"].ref)
    heads = [sheet.cell(top, column).value for column in range(left, right + 1)]
    for number, row in enumerate(rows, start=1):
        for head, value in row.items():
            sheet.cell(top + number, left + heads.index(head)).value = value
    book.save(path)
    return path


def rows_below(path: Path, header: str) -> list[list[str]]:
    """Rows of the table whose head has a column."""
    for table in docx.Document(str(path)).tables:
        cells = [[cell.text for cell in row.cells] for row in table.rows]
        if any(head.split("\n")[0] == header for head in cells[0]):
            return cells[1:]
    raise AssertionError(header)


def test_conditions_have_a_chapter_and_the_worst_governs(tmp_path: Path, undrawn: None) -> None:
    source = typed(
        tmp_path / "train.xlsx",
        {"Condition": "weak line", "Voltage": 10},
        {"Condition": "hot", "Kind": "steady", "Stiffness factor": 0.8},
    )
    assert report(source, docx=tmp_path / "r.docx").problems == ()
    text = docx_text(tmp_path / "r.docx")
    # the motor does not start the load with a hundredth of its torque: no number, but no start either
    said = "Condition weak line governs: Start no breakaway"
    assert text.count(said) == 2  # in the chapter and in the conclusions
    assert [row[:2] for row in rows_below(tmp_path / "r.docx", "Changed")] == [
        ["weak line", "10 % voltage"],
        ["hot", "steady operation; couplings × 0.8"],
    ]
    asked = rows_below(tmp_path / "r.docx", "Stiffness factor")
    assert [[cell for cell in row if cell] for row in asked] == [
        ["weak line", "10"],
        ["hot", "steady", "0.8"],
    ]


def test_without_conditions_there_is_no_chapter(proposed) -> None:
    headings = [
        paragraph.text.split("  ")[-1]
        for paragraph in docx.Document(str(proposed.docx)).paragraphs
        if paragraph.style.name == "Heading 1"
    ]
    assert "Torque reversals" in headings
    assert "Cases" not in headings
    assert "governs:" not in docx_text(proposed.docx)


def row(check: str, result: object, limit: object, verdict: str) -> dict[str, object]:
    return {"check": check, "result": result, "limit": limit, "verdict": verdict}


@pytest.mark.parametrize(
    ("check", "result", "limit", "share"),
    [
        ("Peak torque", 300.0, 200.0, 1.5),
        ("Separation margin", 0.05, 0.20, 4.0),
        ("Allowable starts", 500.0, 2000.0, 4.0),
        ("Torque reversal", -30.0, -20.0, 1.5),
        ("Torque reversal", 5.0, -20.0, 0.0),
    ],
)
def test_how_far_a_result_is_from_its_limit(
    check: str, result: float, limit: float, share: float
) -> None:
    assert _share(row(check, result, limit, "fail")) == pytest.approx(share)


def test_a_failed_check_decides_before_one_that_is_kept() -> None:
    kept = row("Vibratory torque", 99.0, 100.0, "pass")
    failed = row("Peak torque", 101.0, 100.0, "fail")
    worse = row("Allowable starts", 10.0, 30.0, "fail")
    unknown = row("Shear yield", None, None, "not judged")
    assert _decides([kept, failed, worse, unknown]) is worse
    assert _decides([kept, unknown]) is kept
    assert _decides([unknown]) is None
