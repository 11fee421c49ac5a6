"""Sheet Train: rows are read, their stiffness and inertia are written, and the train uses them."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import openpyxl
import pytest
from made_up_run import STAMP

from addin.calculation.calculation import calculate
from addin.reading.case_json import case_to_json, read_case_json
from addin.reading.workbook import read_workbook
from addin.template import build as template
from addin.template.examples import EXAMPLES
from addin.verify.file import verify_file
from addin.writing.recalculate import recalculate
from addin.writing.workbook import write_results
from addin.xlsx import open_workbook
from engine.case.data import case_digest
from engine.model.sections import sections_of, series_stiffness
from tests.opened import rows_of

ROTOR = "HP compressor shaft"
INCH, POUND_INCH, POUND_INCH2 = 0.0254, 0.1129848290276167, 0.45359237 * 0.0254**2
COLUMNS = (
    "Section",
    "Length",
    "OD",
    "ID",
    "Material",
    "Fillet",
    "Penetration",
    "Keyway width",
    "Keyway depth",
)
#: In inches.
ROWS = (
    ("coupling end", 3.0, 2.75, None, None, None, 33.33, 0.625, 0.3),
    (2, 4.0, 2.75, None, None, 0.1, None, None, None),
    ("journal", 5.0, 3.0, 0.5, None, 0.25, None, None, None),
    (None, 6.0, 4.5, None, "13Cr", None, None, None, None),
)


def sections(rows=ROWS) -> list[dict]:
    named = (zip(COLUMNS, row, strict=True) for row in rows)
    return [{"Element": ROTOR, **{k: v for k, v in row if v is not None}} for row in named]


def built(path: Path, rows=ROWS, stiffness: float | None = None) -> Path:
    """The proposed example with a shaft from sections."""
    example = EXAMPLES["proposed"]
    elements = [
        {k: v for k, v in row.items() if k != "Stiffness"}
        | ({"Stiffness": stiffness} if stiffness else {})
        if row["Element"] == ROTOR
        else row
        for row in example.tables["Elements"]
    ]
    steel = [{"Material": "13Cr", "Shear modulus": 11.2e6, "Density": 0.28, "Source": "maker"}]
    more = {"Elements": elements, "Sections": sections(rows), "SectionMaterials": steel}
    return template.build_template(path, "us", replace(example, tables={**example.tables, **more}))


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("sections")


@pytest.fixture(scope="module")
def written(folder: Path) -> Path:
    source = built(folder / "data.xlsx")
    recalculate(source, destination=folder / "out.xlsx")
    return folder / "out.xlsx"


def test_the_table_holds_stiffness_and_inertia(written: Path) -> None:
    own = sections_of(read_workbook(written).case())[ROTOR]
    *rows, whole = rows_of(written, "SectionResults")
    assert [row["Section"] for row in rows] == ["coupling end", "2", "journal", "4"]
    for row, section in zip(rows, own, strict=True):
        assert row["Element"] == ROTOR
        assert row["Effective length"] == pytest.approx(section.effective_length / INCH, rel=1e-9)
        assert row["Stiffness"] == pytest.approx(section.stiffness / POUND_INCH, rel=1e-9)
    assert (whole["Element"], whole["Section"], whole["Effective length"]) == (ROTOR, "whole", None)
    assert whole["Stiffness"] == pytest.approx(series_stiffness(own) / POUND_INCH, rel=1e-9)
    assert whole["Inertia"] == pytest.approx(sum(row["Inertia"] for row in rows), rel=1e-9)
    # by hand: a plain part of 4 in, 2.75 in diameter, of steel
    assert rows[1]["Effective length"] == pytest.approx(4.0, rel=1e-12)
    area = 3.141592653589793 * (2.75 * INCH) ** 4 / 32.0
    assert own[1].stiffness == pytest.approx(79.3e9 * area / (4.0 * INCH), rel=1e-12)
    assert own[1].inertia == pytest.approx(7850.0 * area * 4.0 * INCH, rel=1e-12)


def test_the_profile_is_drawn(written: Path) -> None:
    points = rows_of(written, "ChartProfile")
    outline = [(row["Position"], row["Outline"]) for row in points if row["Position"] is not None]
    hub = [(row["Hub position"], row["Hub"]) for row in points if row["Hub position"] is not None]
    assert [x for x, _ in hub] == pytest.approx([0, 3, 3, 0, 0], rel=1e-9)
    assert [y for _, y in hub] == pytest.approx([1.375, 1.375, -1.375, -1.375, 1.375], rel=1e-9)
    assert max(x for x, _ in outline) == pytest.approx(18.0, rel=1e-9)
    assert max(y for _, y in outline) == pytest.approx(2.25, rel=1e-9)
    bores = [row["Bore"] for row in points if row["Bore"] is not None]
    assert bores == pytest.approx([0.25, 0.25, -0.25, -0.25], rel=1e-9)
    labels = {row["Key"]: row["Text"] for row in rows_of(written, "ChartLabels")}
    assert labels["Profile title"].endswith(ROTOR)


def test_the_results_follow_from_the_inputs(written: Path) -> None:
    assert not [finding for finding in verify_file(written).findings if finding.fails]


def test_the_inputs_are_those_of_their_json(written: Path, folder: Path) -> None:
    case = read_workbook(written).case()
    path = folder / "case.json"
    path.write_text(json.dumps(case_to_json(case)), encoding="utf-8")
    assert case_digest(read_case_json(path).case()) == case_digest(case)


def test_a_typed_stiffness_is_told(folder: Path) -> None:
    run = calculate(read_workbook(built(folder / "typed.xlsx", stiffness=6e7)).case())
    notes = [
        note for note in run.results.warnings if ROTOR in note and "typed in table Elements" in note
    ]
    assert len(notes) == 1


def test_problems_name_the_cell(folder: Path) -> None:
    wrong = (ROWS[0], (2, 4.0, 2.75, None, None, 0.5, None, None, None), *ROWS[2:])
    (problem,) = read_workbook(built(folder / "wrong.xlsx", wrong)).problems
    assert (problem.sheet, problem.table, problem.row, problem.column) == (
        "Train",
        "Sections",
        2,
        "Fillet",
    )
    assert "found 0.5 in" in problem.message
    assert "height of the step" in problem.message


def test_a_workbook_of_an_earlier_version_lacks_the_sheet(folder: Path) -> None:
    """It is read, calculated and written as before."""
    book = openpyxl.load_workbook(template.build_template(folder / "new.xlsx", "us", "proposed"))
    for sheet in book:
        for name in [name for name in sheet.tables if "Section" in name or name == "ChartProfile"]:
            del sheet.tables[name]
    book.save(folder / "old.xlsx")
    read = read_workbook(folder / "old.xlsx")
    assert read.problems == ()
    assert read.data.sections == ()
    report = write_results(
        folder / "old.xlsx", folder / "done.xlsx", calculate(read.case()).view, STAMP
    )
    assert not report.notes
    assert not [name for name in open_workbook(folder / "done.xlsx").tables if "Section" in name]


def test_calc_opens_and_saves_it(soffice, written: Path, folder: Path) -> None:
    """LibreOffice writes the same inputs; its own calculation finds them unchanged since the results."""
    saved = soffice.convert(written, "xlsx", folder / "calc")
    read = read_workbook(saved)
    assert read.problems == ()
    assert case_digest(read.case()) == case_digest(read_workbook(written).case())
    assert rows_of(saved, "SectionResults")[-1]["Stiffness"] == pytest.approx(
        rows_of(written, "SectionResults")[-1]["Stiffness"], rel=1e-12
    )
    banner = openpyxl.load_workbook(saved, data_only=True)["Train"]["B2"].value
    assert banner == openpyxl.load_workbook(written, data_only=True)["Train"]["B2"].value
