"""`torsionbook diff` of workbooks with studies: rows asked, results found, studies out of date."""

from __future__ import annotations

import json
import re
import shutil
from pathlib import Path

import jsonschema
import openpyxl
import pytest
from typer.testing import CliRunner

from addin.cli.app import app
from addin.contract.tables import STUDY_INPUT_TABLES, STUDY_RESULT_TABLES
from addin.diff.changes import Differences
from addin.diff.compare import compare_files
from addin.diff.studies import _plain
from addin.diff.wording import as_json
from addin.reading.case_json import case_to_json
from addin.reference.json_schemas import diff_schema
from addin.studies.run_study import StudyFiles, study_one
from addin.studies.tuning import TUNING
from addin.workers.parallel_map import serial_map
from addin.xlsx import open_workbook
from addin.xlsx.references import cell_name
from tests.sample_case import sample_case

RUN = CliRunner()


def said(*words: object) -> str:
    done = RUN.invoke(app, [str(word) for word in words], env={"COLUMNS": "200"})
    assert done.exit_code == 0, done.output
    return done.output


@pytest.fixture(scope="module")
def first(studied: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return Path(shutil.copy2(studied, tmp_path_factory.mktemp("first") / "first.xlsx"))


@pytest.fixture(scope="module")
def second(first: Path) -> Path:
    """Other damping, another duty, a kind of start under another name; starts made again alone."""
    book = Path(shutil.copy2(first, first.with_name("second.xlsx")))
    opened = open_workbook(book, ignore_lock=True)
    opened.set_name("DampingRatio", 0.02)
    there = opened.table("StartConditions")
    for row, column, value in ((0, "Per year", 12.0), (1, "Condition", "new")):
        at = there.ref.left + there.column_index(column)
        opened.set_cell(there.sheet, cell_name(there.data.top + row, at), value)
    opened.save(in_place=True)
    said("recalc", book, "--in-place")
    said("starts", book, "--in-place", "--jobs", "1")
    return book


@pytest.fixture(scope="module")
def found(first: Path, second: Path) -> Differences:
    return compare_files(first, second)


@pytest.mark.slow
def test_rows_of_study_sheets_are_matched_by_their_names(found: Differences) -> None:
    told = [(c.kind, c.table, c.row, c.column, c.before, c.after) for c in found.inputs]
    assert ("changed", "StartConditions", "normal", "Per year", 10.0, 12.0) in told
    assert sorted((k, r) for k, _, r, *_ in told if k != "changed") == [
        ("row added", "new"), ("row removed", "weak"),
    ]  # fmt: skip


@pytest.mark.slow
def test_results_are_compared_where_both_files_have_them_of_their_inputs(
    found: Differences, first: Path, second: Path
) -> None:
    """What stands in the cells of sheet Start matrix is what is told."""

    def starts(book: Path) -> float:
        sheet = openpyxl.load_workbook(book)["Start matrix"]
        head, row, *_ = sheet[sheet.tables["StartMatrix"].ref]
        return float(row[[c.value for c in head].index("Allowable starts")].value)

    (one,) = [
        c
        for c in found.studies.results
        if (c.table, c.row, c.column) == ("StartMatrix", "normal", "Allowable starts")
    ]
    assert (one.before, one.after) == pytest.approx((starts(first), starts(second)), rel=1e-12)
    assert one.before < one.after  # more damping, more starts
    kinds = {(c.kind, c.row) for c in found.studies.results if c.table == "StartMatrix"}
    assert {("row removed", "weak"), ("row added", "new")} <= kinds


@pytest.mark.slow
def test_a_study_that_is_out_of_date_is_named_and_not_compared(found: Differences) -> None:
    words = "is not compared: in B it was calculated from inputs with"
    assert len(found.studies.notes) == 3
    assert all(words in note for note in found.studies.notes)
    assert any(note.startswith(f"Sheet Tuning results {words}") for note in found.studies.notes)
    assert not [c for c in found.studies.results if c.table == "TuningResults"]


@pytest.mark.slow
def test_a_study_in_one_file_only_is_named(first: Path, tmp_path: Path) -> None:
    bare = tmp_path / "bare.xlsx"
    said("new", bare, "--studies", "--from", first)
    notes = compare_files(first, bare).studies.notes
    assert [n.rpartition(": ")[2] for n in notes] == ["B does not contain the study."] * 4


@pytest.mark.slow
def test_a_study_that_was_cut_short_is_named_beside_a_whole_one(tmp_path: Path) -> None:
    part = tmp_path / "part.xlsx"
    row = [{"element": "HS coupling", "quantity": "stiffness", "unit": "%", "from": 50, "to": 150,
            "steps": 21}]  # fmt: skip
    case = tmp_path / "case.json"
    case.write_text(json.dumps(case_to_json(sample_case("proposed")) | {"tuning": row}))
    said("new", part, "--studies", "--from", case)
    whole = Path(shutil.copy2(part, tmp_path / "whole.xlsx"))
    assert (
        study_one(
            TUNING,
            part,
            serial_map(iter([False, True, True]).__next__),
            {},
            StudyFiles(in_place=True),
        ).problems
        == ()
    )
    assert study_one(TUNING, whole, serial_map(), {}, StudyFiles(in_place=True)).problems == ()
    (note,) = compare_files(part, whole).studies.notes
    assert note.startswith(
        "Sheet Tuning results in A contains an incomplete study, stopped by Ctrl-C"
    )
    assert compare_files(whole, whole).studies.notes == ()


@pytest.mark.slow
def test_the_same_studies_in_other_units_do_not_differ(first: Path, tmp_path: Path) -> None:
    other = tmp_path / "us.xlsx"
    said("new", other, "--studies", "--units", "us", "--from", first)
    said("recalc", other, "--in-place")
    for words in (("tune",), ("tolerances", "--samples", "40"), ("starts",), ("calibrate",)):
        said(words[0], other, "--in-place", "--jobs", "1", *words[1:])
    found = compare_files(first, other).studies
    assert found.notes == ()
    assert found.inputs == ()
    assert [c for c in found.results if c.kind != "changed"] == []
    assert all(abs(c.relative or 0.0) < 1e-6 for c in found.results)
    assert found.same_results > 20


def test_makers_names_keep_their_brackets() -> None:
    """Numbers of the case go, what tells two couplings apart stays."""
    told = [
        "HS coupling: CF 100 (steel); LS coupling stiffness 0.8 × (725,170 N m/rad)",
        "HS coupling: CF 100 (bronze); LS coupling stiffness 1 × (906,463 N m/rad) (as is)",
    ]
    assert [row["Combination"] for row in _plain([{"Combination": one} for one in told])] == [
        "HS coupling: CF 100 (steel); LS coupling stiffness 0.8 ×",
        "HS coupling: CF 100 (bronze); LS coupling stiffness 1 ×",
    ]


def test_terminal_workbook_and_json_tell_it(first: Path, second: Path, tmp_path: Path) -> None:
    book, content = tmp_path / "d.xlsx", tmp_path / "d.json"
    told = said("diff", first, second, "--xlsx", book, "--json", content)
    assert re.search(r"StartConditions +│ normal +│ Per year", told)
    assert "Start matrix: " in told
    found = json.loads(content.read_text(encoding="utf-8"))
    jsonschema.validate(found, diff_schema())
    assert len(found["studies"]["notes"]) == 3
    rows = [[c.value for c in row] for row in openpyxl.load_workbook(book)["Studies"]]
    assert any("Start matrix" in str(row[0]) for row in rows)


def test_files_without_studies_have_no_part_on_them(tmp_path: Path) -> None:
    case = tmp_path / "case.json"
    case.write_text(json.dumps(case_to_json(sample_case("proposed"))), encoding="utf-8")
    found = compare_files(case, case)
    assert not found.studies.anything
    assert as_json(found)["studies"]["results"] == []
    assert "Studies:" not in said("diff", case, case)


def test_every_row_name_is_a_column_of_its_table() -> None:
    for spec in (*STUDY_INPUT_TABLES, *STUDY_RESULT_TABLES):
        names = {one.name for one in spec.columns}
        assert set(spec.row_name) <= names, spec.name
