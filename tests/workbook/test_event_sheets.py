"""Events in operation on the sheets: typed, recalculated, verified, cleared; workbooks of earlier versions."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from addin.cli.app import app
from addin.contract.input_tables import INPUT_TABLES
from addin.reading.case_json import case_to_json, read_case_json
from addin.reading.workbook import read_workbook
from addin.verify.file import verify_file
from addin.verify.structure import PlainTexts, missing_tables
from addin.writing.recalculate import recalculate
from addin.xlsx import Workbook, open_workbook
from addin.xlsx.references import cell_name
from engine.case.data import CaseData, EffectChoiceRow, EventTorqueRow, MotorEventRow
from tests.engine.results.test_motor_events import motor
from tests.opened import rows_of
from tests.reading.small_workbook import SmallWorkbook
from tests.trains import geared

FAULT = (
    EventTorqueRow("Fault", "Motor", -4.0, 1.0, math.radians(90.0), 0.1),
    EventTorqueRow("Fault", "Motor", -1.0, None, None, 0.1),
)


def shown(workbook: Workbook, name: str) -> list[list[Any]]:
    """Rows of a table as its cells show them."""
    table = workbook.tables[name]
    return [
        [
            workbook.shown_value(table.sheet, cell_name(row, column))
            for column in range(table.ref.left, table.ref.right + 1)
        ]
        for row in range(table.data.top, table.data.bottom + 1)
    ]


@pytest.fixture(scope="module")
def calculated(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A train with an event: case.json, book.xlsx with its results, results.json."""
    folder = tmp_path_factory.mktemp("event")
    case = folder / "case.json"
    case.write_text(json.dumps(case_to_json(geared(event_torque=FAULT))), encoding="utf-8")
    words = ["new", str(folder / "typed.xlsx"), "--units", "si", "--from", str(case)]
    result = CliRunner().invoke(app, words)
    assert result.exit_code == 0, result.output
    done = recalculate(
        folder / "typed.xlsx",
        destination=folder / "book.xlsx",
        json_file=folder / "results.json",
    )
    assert not done.problems
    return folder


def test_events_stand_as_typed(calculated: Path) -> None:
    first, second, *rest = shown(open_workbook(calculated / "book.xlsx"), "EventTorque")
    assert first == ["Fault", "Motor", None, -4.0, 1.0, pytest.approx(math.pi / 2.0), 0.1, None]
    assert second[:4] == ["Fault", "Motor", None, -1.0]
    assert all(value in (None, "") for row in rest for value in row)


def test_the_sheet_shows_what_the_json_has(calculated: Path) -> None:
    results = json.loads((calculated / "results.json").read_text(encoding="utf-8"))
    rows = results["event_peaks"]
    sheet = shown(open_workbook(calculated / "book.xlsx"), "EventPeaks")
    assert [r[:2] for r in sheet] == [[r["event"], r["element"]] for r in rows]
    assert [r[2] for r in sheet] == pytest.approx([r["maximum"] for r in rows], rel=1e-12)
    assert {r["event"] for r in rows} == {"Fault"}
    checks = {row["check"]: row["verdict"] for row in results["verdicts"]}
    assert checks["Peak torque in events"] == "not judged"


def test_events_of_a_motor_on_the_sheet(tmp_path: Path) -> None:
    events = (
        MotorEventRow("Short", "Motor", "line-to-line fault", math.radians(30.0), clears_after=0.1),
        MotorEventRow("Dip", "Motor", "voltage dip", residual_voltage=0.8),
    )
    data = motor(*events)
    (tmp_path / "case.json").write_text(json.dumps(case_to_json(data)), encoding="utf-8")
    words = [
        "new",
        str(tmp_path / "typed.xlsx"),
        "--units",
        "us",
        "--from",
        str(tmp_path / "case.json"),
    ]
    assert CliRunner().invoke(app, words).exit_code == 0
    book = tmp_path / "book.xlsx"
    done = recalculate(
        tmp_path / "typed.xlsx", destination=book, json_file=tmp_path / "results.json"
    )
    assert not done.problems
    results = json.loads((tmp_path / "results.json").read_text(encoding="utf-8"))
    first, second, *rest = shown(open_workbook(book), "MotorEvents")
    angle = pytest.approx(math.radians(30.0))
    assert first[:7] == ["Short", "Motor", "line-to-line fault", angle, None, None, 0.1]
    assert set(first[7:]) == {None}
    assert second[:3] == ["Dip", "Motor", "voltage dip"]
    assert second[5] == pytest.approx(0.8)
    sheet = shown(open_workbook(book), "AirGapTorque")
    pound_foot = 1.3558179483314004
    assert [row[0] for row in sheet] == ["start", "Short", "Dip"]
    assert [row[1] * pound_foot for row in sheet] == pytest.approx(
        [row["largest"] for row in results["air_gap_torque"]], rel=1e-12
    )
    assert verify_file(book).outcome == "follows"
    drawn = [row for row in shown(open_workbook(book), "ChartMotorEvent") if row[0] is not None]
    largest = max(abs(row[1]) for row in sheet[1:])
    assert max(abs(row[1]) for row in drawn) == pytest.approx(largest, rel=0.02)
    assert drawn[0] == [0.0, pytest.approx(drawn[0][2], rel=1e-9), drawn[0][2]]  # in balance


def test_a_worst_clearing_time_on_the_sheet(tmp_path: Path) -> None:
    """The word goes into the file and comes back; the sheet shows what was found, and a chart of it."""
    event = MotorEventRow(
        "Worst", "Motor", "line-to-line fault", "worst", clears_after="worst", latest_clearing=0.03
    )
    dip = MotorEventRow("Dip", "Motor", "voltage dip", residual_voltage=0.97, clears_after=0.1)
    data = motor(dip, event, effect_choices=(EffectChoiceRow("backlash", "off"),))
    case = tmp_path / "case.json"
    case.write_text(json.dumps(case_to_json(data)), encoding="utf-8")
    assert read_case_json(case).data == CaseData(**vars(data))
    words = ["new", str(tmp_path / "typed.xlsx"), "--units", "si", "--from", str(case)]
    assert CliRunner().invoke(app, words).exit_code == 0
    assert read_workbook(tmp_path / "typed.xlsx").data.motor_events == (dip, event)
    book = tmp_path / "book.xlsx"
    done = recalculate(
        tmp_path / "typed.xlsx", destination=book, json_file=tmp_path / "results.json"
    )
    assert not done.problems
    rows = json.loads((tmp_path / "results.json").read_text(encoding="utf-8"))["event_peaks"]
    worst = ("Worst phase", "Worst angle", "Worst clearing time")
    assert [[row[name] for name in worst] for row in rows_of(book, "EventPeaks")] == [
        [pytest.approx(math.degrees(r["worst_phase"])), None, r["worst_clearing_time"]]
        if r["event"] == "Worst"
        else [None] * 3
        for r in rows
    ]
    assert "CHANGED" not in str(open_workbook(book).shown_value("Summary", "B9"))
    drawn = shown(open_workbook(book), "ChartClearing")
    assert [row[0] for row in drawn] == pytest.approx([0.0015 * (k + 1) for k in range(20)])
    assert verify_file(book).outcome == "follows"
    number = open_workbook(tmp_path / "typed.xlsx")
    table = number.tables["MotorEvents"]
    number.set_cell(table.sheet, cell_name(table.data.top + 1, table.ref.left + 6), "wurst")
    number.save(tmp_path / "wrong.xlsx")
    (problem,) = read_workbook(tmp_path / "wrong.xlsx").problems
    assert problem.column == "Clears after"
    assert "Type a number or worst, or leave the cell blank" in problem.message


def test_an_event_in_the_start_on_the_sheet(tmp_path: Path) -> None:
    """Begins goes into the file and comes back, a number or a word; peaks and air-gap torque stand on sheet Torque and motor."""
    dip = MotorEventRow(
        "Dip", "Motor", "voltage dip", residual_voltage=0.8, clears_after=0.1, begins="running"
    )
    fault = MotorEventRow("Fault", "Motor", "three-phase fault", clears_after=0.1, begins=0.5)
    data = motor(dip, fault, effect_choices=(EffectChoiceRow("backlash", "off"),), maximum_time=1.0)
    case = tmp_path / "case.json"
    case.write_text(json.dumps(case_to_json(data)), encoding="utf-8")
    assert read_case_json(case).data == CaseData(**vars(data))
    words = ["new", str(tmp_path / "typed.xlsx"), "--units", "si", "--from", str(case)]
    assert CliRunner().invoke(app, words).exit_code == 0
    assert read_workbook(tmp_path / "typed.xlsx").data.motor_events == (dip, fault)
    book = tmp_path / "book.xlsx"
    done = recalculate(
        tmp_path / "typed.xlsx", destination=book, json_file=tmp_path / "results.json"
    )
    assert not done.problems
    results = json.loads((tmp_path / "results.json").read_text(encoding="utf-8"))
    rows = [r for r in results["event_peaks"] if r["event"] == "Fault"]
    sheet = [r for r in shown(open_workbook(book), "EventPeaks") if r[0] == "Fault"]
    assert [r[2] for r in sheet] == [r["maximum"] for r in rows]
    assert all(r.get("left_out") is None for r in rows)  # MaximumTime ends the start
    assert any("by which the start has not ended" in note for note in results["warnings"])
    assert verify_file(book).outcome == "follows"


def test_verify_follows_it_and_finds_an_edited_peak(calculated: Path, tmp_path: Path) -> None:
    book = calculated / "book.xlsx"
    assert verify_file(book).outcome == "follows"
    workbook = open_workbook(book)
    table = workbook.tables["EventPeaks"]
    cell = cell_name(table.data.top, table.ref.left + 2)
    workbook.set_cell(table.sheet, cell, 1.0)
    workbook.save(tmp_path / "edited.xlsx")
    found = verify_file(tmp_path / "edited.xlsx")
    assert found.outcome == "does not follow"
    assert any((f.sheet, f.cell) == (table.sheet, cell) for f in found.findings)


def test_events_that_are_cleared_leave_no_rows(calculated: Path, tmp_path: Path) -> None:
    workbook = open_workbook(calculated / "book.xlsx")
    table = workbook.tables["EventTorque"]
    for row in range(table.data.top, table.data.bottom + 1):
        for column in range(table.ref.left, table.ref.right + 1):
            workbook.set_cell(table.sheet, cell_name(row, column), None)
    workbook.save(tmp_path / "cleared.xlsx")
    done = recalculate(
        tmp_path / "cleared.xlsx",
        destination=tmp_path / "out.xlsx",
        json_file=tmp_path / "out.json",
    )
    assert not done.problems
    rows = shown(open_workbook(tmp_path / "out.xlsx"), "EventPeaks")
    assert all(value in (None, "") for row in rows for value in row)


def test_a_lost_result_table_is_missed(tmp_path: Path) -> None:
    """Only a workbook of an earlier version, which has none of the later input tables either, may lack it."""
    made = SmallWorkbook()
    of_today = open_workbook(made.save(tmp_path / "today.xlsx"))
    made.without.update(spec.name for spec in INPUT_TABLES if spec.later)
    earlier = open_workbook(made.save(tmp_path / "earlier.xlsx"))
    assert "EventPeaks" in {f.table for f in missing_tables(PlainTexts(of_today))}
    assert "EventPeaks" not in {f.table for f in missing_tables(PlainTexts(earlier))}
