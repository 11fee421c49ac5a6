"""Where the results of a study go: refused before hours of work, not after."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

from addin.cli.app import app
from addin.reading.case_json import case_to_json
from addin.reading.one_file import file_problem
from tests.trains import geared

RUN = CliRunner()


@pytest.fixture
def case(tmp_path: Path) -> Path:
    place = tmp_path / "case.json"
    tables = {
        "tuning": [{"element": "Motor shaft", "quantity": "stiffness", "values": "0.9"}],
        "measured_frequencies": [{"frequency": 20.0}],
    }
    place.write_text(json.dumps(case_to_json(geared()) | tables), encoding="utf-8")
    return place


def refused(*words: object) -> str:
    done = RUN.invoke(app, [str(word) for word in words])
    assert done.exit_code == 2, done.output
    return " ".join(done.output.replace("│", " ").split())


def test_cases_that_would_lie_in_a_file_are_refused_before_tuning(case: Path) -> None:
    taken = case.with_name("taken")
    taken.write_text("mine", encoding="utf-8")
    assert "is a file; name a folder" in refused("tune", case, "--cases", taken)
    assert "is a file; name a folder" in refused("tune", case, "--out", taken)
    assert "is a file; name a folder" in refused("tune", case, "--json", taken / "deep" / "a.json")
    assert taken.read_text(encoding="utf-8") == "mine"
    assert sorted(p.name for p in case.parent.iterdir()) == ["case.json", "taken"]


def test_a_calibrated_case_that_is_a_folder_is_refused_before_calibrating(case: Path) -> None:
    assert "is a folder; name a file in it" in refused("calibrate", case, "--case", case.parent)
    assert [p.name for p in case.parent.iterdir()] == ["case.json"]


@pytest.mark.slow
def test_workbook_and_json_go_into_one_folder_that_is_made(tmp_path: Path) -> None:
    made, out = tmp_path / "train.xlsx", tmp_path / "out"
    for words in (
        ["new", made, "--studies", "--example", "proposed"],
        ["calibrate", made, "--out", out, "--json", out],
    ):
        done = RUN.invoke(app, [str(word) for word in words])
        assert done.exit_code == 0, done.output
    assert sorted(p.name for p in out.iterdir()) == ["train.calibrate.json", "train.xlsx"]


def test_a_result_that_is_a_folder_is_not_laid_to_the_input(tmp_path: Path) -> None:
    wrong = IsADirectoryError(21, "is a folder", str(tmp_path))
    said = file_problem(tmp_path / "train.xlsx", wrong).message
    assert f"{tmp_path} is a folder" in said
    assert "train.xlsx" not in said
