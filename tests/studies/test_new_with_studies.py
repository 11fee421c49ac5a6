"""A workbook with the sheets of the studies, and one filled with the inputs of another."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest
from typer.testing import CliRunner

from addin.cli.app import app
from addin.contract.shipped import template_path
from addin.contract.tables import STUDY_INPUT_TABLES
from addin.reading.case_json import case_to_json, read_case_json
from addin.reading.one_file import Unreadable, read_checked
from addin.reading.typed_case import CaseInput
from addin.template.examples import example_case
from addin.template.filled import example_of
from engine.case.data import case_digest
from engine.case.study_inputs import TuningRow

RUN = CliRunner()


def _read(path: Path) -> CaseInput:
    read = read_checked(path)
    assert not isinstance(read, Unreadable)
    assert not read.problems
    return read


@pytest.mark.slow
@pytest.mark.parametrize("name", ["proposed", "backlash"])
def test_inputs_of_a_workbook_are_filled_into_a_new_one_as_they_are_typed(
    name: str, tmp_path: Path
) -> None:
    source, new = template_path(f"example_{name}.xlsx"), tmp_path / "new.xlsx"
    told = RUN.invoke(app, ["new", str(new), "--from", str(source), "--studies"])
    assert told.exit_code == 0, told.output
    before, after = _read(source), _read(new)
    assert after.data == before.data
    assert after.typed == before.typed
    assert after.studies is not None
    assert after.studies.tables == {table.name for table in STUDY_INPUT_TABLES}


def test_a_case_json_in_several_units_becomes_a_workbook_of_the_same_case(tmp_path: Path) -> None:
    content = case_to_json(_read(template_path("example_proposed.xlsx")).data)
    content["elements"][0]["stiffness"] = "2e9 lbf*in/rad"
    content["rated_torque"] = "58.4 kN*m"
    content["tuning"] = [
        {
            "element": "LS coupling",
            "quantity": "stiffness",
            "unit": "kN*m/rad",
            "values": "20e3; 3e4",
        }
    ]
    source, new = tmp_path / "case.json", tmp_path / "new.xlsx"
    source.write_text(json.dumps(content), encoding="utf-8")
    told = RUN.invoke(app, ["new", str(new), "--from", str(source), "--studies", "--units", "si"])
    assert told.exit_code == 0, told.output
    after = _read(new)
    assert case_digest(after.data) == case_digest(_read(source).data)
    assert after.studies is not None
    assert after.studies.inputs.tuning == (
        TuningRow("LS coupling", "stiffness", relative=False, values=(20e6, 30e6)),
    )


def test_study_rows_do_not_change_the_case_and_spoil_no_plain_run(tmp_path: Path) -> None:
    content = case_to_json(_read(template_path("example_proposed.xlsx")).data)
    plain = tmp_path / "plain.json"
    plain.write_text(json.dumps(content), encoding="utf-8")
    content["scatter"] = [{"quantity": "stiffness", "spread": "ten"}]
    spoilt = tmp_path / "spoilt.json"
    spoilt.write_text(json.dumps(content), encoding="utf-8")
    assert case_digest(_read(spoilt).data) == case_digest(_read(plain).data)
    told = RUN.invoke(app, ["check", str(spoilt)])
    assert told.exit_code == 1
    assert "table Scatter, row 1, Spread (key scatter[0].spread): found 'ten'" in told.output


def test_torques_over_speeds_in_rpm_are_drawn_as_they_are_read() -> None:
    content = case_to_json(_read(template_path("example_proposed.xlsx")).data)
    for name in ("motor_torque", "load_torque"):
        for row in content[name]:
            row["speed"] = f"{1234.5 * row['speed']} rpm"
    read = read_case_json(content)
    drawn = example_case(example_of(read, "us"), "us")
    assert drawn == replace(read.data, template_version=None)
    assert read.data.motor_torque[1].speed > 0.0


@pytest.mark.parametrize(
    ("row", "says"),
    [
        ({"values": "0.5; 1,2"}, "'1,2' is not a number"),
        ({"values": "0.5", "unit": "kg"}, "of torsional stiffness"),
        ({"quantity": "stifness", "values": "1"}, "Did you mean 'stiffness'?"),
        ({"values": " ".join(["1"] * 201)}, "found 201 values"),
    ],
)
def test_a_wrong_row_of_tuning_gets_its_sentence(
    row: dict[str, str], says: str, tmp_path: Path
) -> None:
    content = case_to_json(_read(template_path("example_proposed.xlsx")).data)
    content["tuning"] = [{"element": "LS coupling", "quantity": "stiffness"} | row]
    source = tmp_path / "case.json"
    source.write_text(json.dumps(content), encoding="utf-8")
    read = _read(source)
    assert read.studies is not None
    assert any(says in one.message for one in read.studies.problems_of(["Tuning"]))


def test_numbers_in_units_that_no_column_can_hold_are_refused(tmp_path: Path) -> None:
    content = case_to_json(_read(template_path("example_proposed.xlsx")).data)
    content["excitations"] = [
        {"name": "a", "order": 1, "torque": "1 %"},
        {"name": "b", "order": 2, "torque": "10 N*m"},
    ]
    source, new = tmp_path / "case.json", tmp_path / "new.xlsx"
    source.write_text(json.dumps(content), encoding="utf-8")
    told = RUN.invoke(app, ["new", str(new), "--from", str(source)])
    assert told.exit_code == 1
    assert "a workbook column has one unit" in " ".join(told.output.split())
    assert not new.exists()
