"""Studies in a report: as they stand in the workbook, or named as out of date."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any

import docx
import openpyxl
import pytest
from report_files import docx_text, flat, pdf_text
from typer.testing import CliRunner

from addin.cli.app import app
from addin.report.make import report
from addin.xlsx import open_workbook
from addin.xlsx.references import cell_name

RUN = CliRunner()


def said(*words: object) -> str:
    done = RUN.invoke(app, [str(word) for word in words], env={"COLUMNS": "200"})
    assert done.exit_code == 0, done.output
    return done.output


@pytest.fixture(scope="module")
def book(studied: Path) -> Path:
    """A workbook in which four studies stand; tests change copies of it."""
    return studied


def cells(book: Path, table: str) -> list[dict[str, Any]]:
    for sheet in openpyxl.load_workbook(book):
        if table in sheet.tables:
            head, *rows = [[c.value for c in row] for row in sheet[sheet.tables[table].ref]]
            return [dict(zip(head, row, strict=True)) for row in rows]
    raise AssertionError(table)


def pictures(path: Path) -> int:
    return len(docx.Document(str(path)).inline_shapes)


@pytest.mark.slow
def test_each_study_has_its_chapter_with_numbers_of_its_sheet(
    book: Path, tmp_path: Path, undrawn: None
) -> None:
    assert report(book, docx=tmp_path / "a.docx").problems == ()
    text = docx_text(tmp_path / "a.docx")
    for heading in (
        "Tuning: all combinations", "Tolerances", "Start matrix and damage ledger",
        "Calibration against measurements",
    ):  # fmt: skip
        assert heading in text
    best, p50 = cells(book, "TuningResults")[0], cells(book, "ToleranceFrequencies")[0]["P50"]
    assert {f"{int(best['Allowable starts']):,}", f"{p50:.2f}"} <= set(text.split())
    assert f"combinations calculated: {best['Combination'].split(';')[0]}" in text
    assert "No other design is compared here" not in text


@pytest.mark.slow
def test_studies_of_these_inputs_are_printed_as_they_stand(book: Path, tmp_path: Path) -> None:
    done = report(book, pdf=tmp_path / "a.pdf", docx=tmp_path / "a.docx")
    assert done.problems == ()
    texts = flat(pdf_text(tmp_path / "a.pdf")), docx_text(tmp_path / "a.docx")
    best = cells(book, "TuningResults")[0]
    ledger = cells(book, "DamageLedger")[0]
    p50 = cells(book, "ToleranceFrequencies")[0]["P50"]
    after = cells(book, "CalibratedFrequencies")[0]["After"]
    for text in texts:
        for words in (
            "Tuning: all combinations", "Tolerances", "Start matrix and damage ledger",
            "Calibration against measurements", "Reasons for the ranking", "reached at 97.0 % speed",
            "printed as recorded.", "Numbers in the text are in the units typed",
        ):  # fmt: skip
            assert words in text
        for number in (f"{int(best['Allowable starts']):,}", f"{p50:.2f}", f"{after:.2f}",
                       f"{ledger['Used']:.4g}"):  # fmt: skip
            assert number in text.split(), number
        assert best["Reason"][:60] in text
    bare = tmp_path / "bare.xlsx"
    said("new", bare, "--from", book)
    report(bare, docx=tmp_path / "b.docx")
    # starts over a coupling, tornado, distribution, starts over voltage
    assert pictures(tmp_path / "a.docx") == pictures(tmp_path / "b.docx") + 4
    assert "Tuning: all combinations" not in docx_text(tmp_path / "b.docx")


@pytest.mark.slow
def test_studies_of_other_inputs_are_named_and_not_printed(book: Path, tmp_path: Path) -> None:
    other = Path(shutil.copy2(book, tmp_path / "other.xlsx"))
    opened = open_workbook(other, ignore_lock=True)
    opened.set_name("DampingRatio", 0.03)
    opened.save(in_place=True)
    assert report(other, docx=tmp_path / "o.docx").problems == ()
    text = docx_text(tmp_path / "o.docx")
    assert text.count("Out of date and omitted") == 4
    assert "Reasons for the ranking" not in text
    assert str(cells(book, "TuningResults")[0]["Reason"])[:60] not in text


@pytest.mark.slow
def test_a_study_of_other_rows_alone_is_out_of_date(book: Path, tmp_path: Path) -> None:
    other = Path(shutil.copy2(book, tmp_path / "other.xlsx"))
    opened = open_workbook(other, ignore_lock=True)
    there = opened.table("Tuning")
    at = there.ref.left + there.column_index("Values")
    opened.set_cell(there.sheet, cell_name(there.data.top, at), "40; 70")
    opened.save(in_place=True)
    report(other, docx=tmp_path / "o.docx")
    text = docx_text(tmp_path / "o.docx")
    assert text.count("Out of date and omitted") == 1
    assert "the rows of tables Tuning and Catalogue were changed" in text
    assert "Damage of the duty by start condition" in text  # the ledger still is of these rows


@pytest.mark.slow
def test_what_changed_in_studies_since_an_earlier_revision(book: Path, tmp_path: Path) -> None:
    """Rows asked, numbers found as they stand in both, and what is not compared."""
    now = Path(shutil.copy2(book, tmp_path / "now.xlsx"))
    opened = open_workbook(now, ignore_lock=True)
    there = opened.table("StartConditions")
    at = there.ref.left + there.column_index("Voltage")
    opened.set_cell(there.sheet, cell_name(there.data.top + 1, at), 0.95)
    there = opened.table("Tuning")
    at = there.ref.left + there.column_index("Values")
    opened.set_cell(there.sheet, cell_name(there.data.top, at), "40; 70")
    opened.save(in_place=True)
    said("starts", now, "--in-place", "--jobs", "1")
    assert report(now, docx=tmp_path / "o.docx", against=book).problems == ()
    text = docx_text(tmp_path / "o.docx")
    changes = text[text.index("Changes since") :]
    assert "Rows of study sheets that changed" in changes
    assert (
        "Sheet Tuning results is not compared: in B it was calculated from inputs with SHA-256"
        in changes
    )
    assert f"A is {book.name}, B this calculation." in changes
    before, after = (
        next(r["Allowable starts"] for r in cells(b, "StartMatrix") if r["Condition"] == "weak")
        for b in (book, now)
    )
    assert int(before) != int(after)
    for number in (before, after):
        assert f"{number:,.4g}" in changes or f"{int(number):,}" in changes
    assert report(book, docx=tmp_path / "s.docx", against=book).problems == ()
    assert "Rows of study sheets that changed" not in docx_text(tmp_path / "s.docx")


@pytest.mark.slow
def test_words_typed_over_numbers_break_no_report(book: Path, tmp_path: Path) -> None:
    other = Path(shutil.copy2(book, tmp_path / "other.xlsx"))
    opened = open_workbook(other, ignore_lock=True)
    for table, column in (("TuningResults", "Rank"), ("TuningLines", "Line 1"),
                          ("StartsByVoltage", "Voltage"), ("ToleranceTornado", "At P10"),
                          ("CalibratedParameters", "Pull"), ("ToleranceMargins", "Mode")):  # fmt: skip
        there = opened.table(table)
        at = there.ref.left + there.column_index(column)
        opened.set_cell(there.sheet, cell_name(there.data.top, at), "see \u2603 note <b>")
    opened.save(in_place=True)
    assert report(other, docx=tmp_path / "o.docx").problems == ()
