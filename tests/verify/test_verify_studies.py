"""`torsionbook verify` on workbooks with studies: made from these inputs and rows, or from others."""

from __future__ import annotations

import datetime as dt
import shutil
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from addin.cli.app import app
from addin.contract.shipped import template_path
from addin.reading.workbook import read_workbook
from addin.verify.file import verify_file
from addin.writing.workbook import RunStamp, write_study
from addin.xlsx import open_workbook
from addin.xlsx.references import cell_name
from engine.case.data import case_digest

RUN = CliRunner()


def said(*words: object, code: int = 0) -> str:
    done = RUN.invoke(app, [str(word) for word in words], env={"COLUMNS": "240"})
    assert done.exit_code == code, done.output
    return done.output


@pytest.fixture
def book(studied: Path, tmp_path: Path) -> Path:
    return Path(shutil.copy2(studied, tmp_path / "train.xlsx"))


def typed(book: Path, table: str, column: str, value: Any) -> None:
    """Something else in the first row of a table, or under the name of a scalar."""
    opened = open_workbook(book, ignore_lock=True)
    if table:
        there = opened.table(table)
        at = there.ref.left + there.column_index(column)
        opened.set_cell(there.sheet, cell_name(there.data.top, at), value)
    else:
        opened.set_name(column, value)
    opened.save(in_place=True)


def notes(book: Path, code: int) -> list[str]:
    return [line for line in said("verify", book, code=code).splitlines() if "StudyFacts" in line]


@pytest.mark.slow
def test_studies_of_these_inputs_are_noted_as_not_calculated_again(book: Path) -> None:
    told = notes(book, 0)
    assert len(told) == 4
    assert all("belongs to the inputs and rows in the file" in line for line in told)


@pytest.mark.slow
def test_a_study_of_other_rows_is_out_of_date_and_named(book: Path) -> None:
    typed(book, "StartConditions", "Per year", 12.0)
    told = notes(book, 1)
    # conditions are inputs of the case, of which the other studies are as well
    (wrong,) = [line for line in told if "out of date" in line and "sheet Start matrix" in line]
    assert "it was calculated from inputs with SHA-256" in wrong
    assert "torsionbook starts again" in wrong


@pytest.mark.slow
def test_a_cell_that_cannot_be_read_is_not_the_blank_it_was(book: Path) -> None:
    """A blank counts as blank in the digest; who typed words there meant something."""
    typed(book, "Tuning", "From", "lots")
    told = notes(book, 1)
    (wrong,) = [line for line in told if "out of date" in line]
    assert "table Tuning now has an unreadable cell (row 1, From)" in wrong


@pytest.mark.slow
def test_studies_of_another_case_are_out_of_date(book: Path) -> None:
    typed(book, "", "DampingRatio", 0.02)
    said("recalc", book, "--in-place")
    told = notes(book, 1)
    assert len(told) == 4
    assert all("out of date: it was calculated from inputs with SHA-256" in line for line in told)
    said("tune", book, "--in-place", "--jobs", "1")
    assert sum("out of date" in line for line in notes(book, 1)) == 3


@pytest.mark.slow
def test_rows_in_another_unit_are_the_same_rows(book: Path) -> None:
    opened = open_workbook(book, ignore_lock=True)
    there = opened.table("Tuning")
    for column, value in {"Unit": "1", "Values": "0.4; 0.6; 0.8"}.items():
        at = there.ref.left + there.column_index(column)
        opened.set_cell(there.sheet, cell_name(there.data.top, at), value)
    opened.save(in_place=True)
    assert not [line for line in notes(book, 0) if "out of date" in line]


def test_a_workbook_with_a_study_alone_is_told_of_it(book: Path) -> None:
    """Before recalculation there are no results to compare, but a study may be out of date."""
    fresh = book.with_name("fresh.xlsx")
    said("new", fresh, "--studies", "--from", book)
    said("tune", fresh, "--in-place", "--jobs", "1")
    typed(fresh, "Tuning", "Values", "70; 90")
    told = RUN.invoke(app, ["verify", str(fresh)], env={"COLUMNS": "240"}).output
    assert "never calculated" in told
    assert "the rows of tables Tuning and Catalogue were changed" in told


def edits(book: Path, code: int = 1) -> list[str]:
    return [
        line
        for line in said("verify", book, code=code).splitlines()
        if "differs from what torsionbook" in line
    ]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("table", "column", "value"),
    [
        ("StartMatrix", "Allowable starts", 1.0e6),
        ("TuningResults", "Verdict", "pass!"),
        ("StartMatrix", "Time", None),
    ],
)
def test_a_cell_of_a_study_edited_by_hand_is_told(
    book: Path, table: str, column: str, value: Any
) -> None:
    typed(book, table, column, value)
    (line,) = edits(book)
    assert f"table {table} differs from what torsionbook" in line


def test_a_number_of_a_study_changed_in_its_tenth_digit_is_told(book: Path) -> None:
    opened = open_workbook(book, ignore_lock=True)
    there = opened.table("StartMatrix")
    cell = cell_name(there.data.top, there.ref.left + there.column_index("Time"))
    number = opened.value(there.sheet, cell)
    assert number == float(f"{number:.11e}")
    typed(book, "StartMatrix", "Time", number * (1 + 1e-9))
    assert len(edits(book)) == 1


@pytest.mark.slow
def test_a_unit_above_a_column_of_a_study_retyped_is_told(book: Path) -> None:
    opened = open_workbook(book, ignore_lock=True)
    there = opened.table("StartMatrix")
    at = there.ref.left + there.column_index("Time")
    unit = cell_name(there.ref.top - 1, at)
    assert opened.value(there.sheet, unit) == "s"
    opened.set_cell(there.sheet, unit, "min")
    opened.save(in_place=True)
    assert len(edits(book)) == 1


@pytest.mark.slow
def test_sorted_rows_of_a_study_are_those_it_wrote(book: Path) -> None:
    opened = open_workbook(book, ignore_lock=True)
    there = opened.table("TuningResults")
    span = range(there.ref.left, there.ref.right + 1)
    first, second = (
        [opened.value(there.sheet, cell_name(there.data.top + k, at)) for at in span]
        for k in (0, 1)
    )
    assert first != second
    for k, row in enumerate((second, first)):
        for at, value in zip(span, row, strict=True):
            opened.set_cell(there.sheet, cell_name(there.data.top + k, at), value)
    opened.save(in_place=True)
    assert edits(book, code=0) == []


@pytest.mark.slow
def test_a_study_without_a_record_of_its_rows_is_noted(book: Path) -> None:
    """As earlier versions wrote them."""
    typed(book, "", "starts_Tables", "")
    typed(book, "StartMatrix", "Time", 1.0)
    told = notes(book, 0)
    assert sum("manual edits are not detected" in line for line in told) == 1


@pytest.mark.slow
def test_a_study_saved_by_libreoffice_is_not_edited(book: Path, soffice: Any) -> None:
    saved = soffice.convert(book, "xlsx")
    told = RUN.invoke(app, ["verify", str(saved)], env={"COLUMNS": "240"}).output
    assert "differs from what torsionbook" not in told
    assert "manual edits are not detected" not in told
    typed(saved, "StartMatrix", "Allowable starts", 1.0e6)
    told = RUN.invoke(app, ["verify", str(saved)], env={"COLUMNS": "240"}).output
    assert "table StartMatrix differs from" in told


def test_an_accuracy_study_of_a_workbook_never_calculated_says_what_stands_in_it(
    tmp_path: Path,
) -> None:
    """The study has no record of the nominal run: no result of that run is missed."""
    example = read_workbook(template_path("example_proposed.xlsx"))
    rows = [
        {
            "method": "exponential",
            "setting": "1 ms",
            "error_peak": 1e-5,
            "error_starts": 1e-4,
            "time": 0.01,
        }
    ]
    words = {"sentence": "2 % on starts: 14 ms.", "reference": "A finer step."}
    opened = open_workbook(template_path("example_proposed.xlsx"))
    for digest, kinds in ((case_digest(example.data), []), ("0" * 64, ["digest"])):
        target = tmp_path / f"{digest[:6]}.accuracy.xlsx"
        stamp = RunStamp("torsionbook", dt.datetime(2026, 1, 1), digest)
        write_study(opened, target, rows, words, stamp, None)
        found = verify_file(target)
        assert found.outcome == "never calculated"
        assert found.sentence.startswith("Only sheet Effects and accuracy is filled")
        assert "Run torsionbook recalc" in found.sentence
        assert [f.kind for f in found.findings] == kinds
