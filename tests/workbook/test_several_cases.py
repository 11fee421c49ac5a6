"""Start conditions typed into a workbook: recalculated, read back, and wrong rows named with their cells."""

from __future__ import annotations

import json
from pathlib import Path

import openpyxl
from openpyxl.utils import range_boundaries

from addin.contract.shipped import template_path
from addin.writing.recalculate import recalculate


def typed(path: Path, *rows: dict[str, object]) -> Path:
    book = openpyxl.load_workbook(template_path("example_modified.xlsx"))
    sheet = book["Case"]
    left, top, right, _ = range_boundaries(sheet.tables["StartConditions"].ref)
    headers = [sheet.cell(top, column).value for column in range(left, right + 1)]
    for number, row in enumerate(rows, 1):
        for header, value in row.items():
            sheet.cell(top + number, left + headers.index(header)).value = value
    book.save(path)
    return path


def rows_of(path: Path, name: str) -> list[dict[str, object]]:
    for sheet in openpyxl.load_workbook(path).worksheets:
        if name in sheet.tables:
            left, top, right, bottom = range_boundaries(sheet.tables[name].ref)
            headers, *rows = sheet.iter_rows(top, bottom, left, right, values_only=True)
            return [dict(zip(headers, row, strict=True)) for row in rows if row[0]]
    raise AssertionError(f"no table {name}")


def test_conditions_of_a_workbook(tmp_path: Path) -> None:
    source = typed(
        tmp_path / "train.xlsx",
        {"Condition": "weak", "Voltage": 10},
        {"Condition": "hot", "Kind": "steady", "Stiffness factor": 0.8},
    )
    written = tmp_path / "out.xlsx"
    done = recalculate(source, destination=written, json_file=tmp_path / "out.json")
    assert not done.problems
    checks = rows_of(written, "CaseVerdicts")
    results = json.loads((tmp_path / "out.json").read_text(encoding="utf-8"))
    names = [(row["condition"], row["check"], row["verdict"]) for row in results["case_verdicts"]]
    assert [(row["Condition"], row["Check"], row["Verdict"]) for row in checks] == names
    matrix = rows_of(written, "CaseMatrix")
    assert [row["Condition"] for row in matrix] == ["weak", "hot"]
    assert [row["Changed"] for row in matrix] == [
        "10 % voltage",
        "steady operation; couplings × 0.8",
    ]
    assert matrix[0]["Verdict"] == "fail"
    overall = rows_of(written, "Verdicts")[0]
    assert overall["Verdict"] == "fail"
    assert "weak" in str(overall["Where"])
    areas = [
        area
        for sheet in openpyxl.load_workbook(written).worksheets
        if sheet.title == "Case"
        for area in str(sheet.print_area).split(",")
    ]
    assert len(areas) == 1  # Summary prints what the conditions change, and their verdicts


def test_a_wrong_row_is_named_with_its_cell(tmp_path: Path) -> None:
    source = typed(tmp_path / "train.xlsx", {"Condition": "hot", "Kind": "steady", "Voltage": 80})
    (problem,) = recalculate(source, destination=tmp_path / "out.xlsx").problems
    assert (problem.sheet, problem.table, problem.column) == ("Case", "StartConditions", "Voltage")
    assert problem.cell
    assert "no effect on continuous operation" in problem.message
    assert not (tmp_path / "out.xlsx").exists()
