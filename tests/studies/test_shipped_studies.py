"""The shipped workbook with study sheets: read, and each study that its rows ask for is made."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from typer.testing import CliRunner

from addin.cli.app import app
from addin.contract.shipped import template_path
from addin.reading.workbook import read_workbook
from addin.template.build import STUDY_TEMPLATES, build_template
from engine.case.data import case_digest
from tests.opened import rows_of

NAME = "example_studies.xlsx"


def test_it_is_what_the_builder_makes(tmp_path: Path) -> None:
    system, example = STUDY_TEMPLATES[NAME]
    made = build_template(tmp_path / NAME, system, example, studies=True)
    assert made.read_bytes() == template_path(NAME).read_bytes(), "run `make templates`"


def test_its_case_is_the_proposed_train_and_its_rows_are_read() -> None:
    read = read_workbook(template_path(NAME))
    assert not read.problems
    plain = read_workbook(template_path("example_proposed.xlsx"))
    assert case_digest(replace(read.data, start_conditions=())) == case_digest(plain.data)
    asked = read.studies.inputs
    assert not read.studies.problems
    assert [len(one) for one in (asked.tuning, asked.catalogue, asked.scatter)] == [2, 3, 7]
    assert len(read.data.start_conditions) == 7
    assert len(asked.measured_frequencies) == 3


@pytest.mark.slow
@pytest.mark.parametrize(
    ("command", "table", "column"),
    [
        ("starts", "DamageLedger", "Used"),
        ("tune", "TuningResults", "Rank"),
        ("calibrate", "CalibratedFrequencies", "After"),
    ],
)
def test_its_studies_are_made(command: str, table: str, column: str, tmp_path: Path) -> None:
    source = template_path(NAME)
    told = CliRunner().invoke(app, [command, str(source), "--out", str(tmp_path), "--jobs", "1"])
    assert told.exit_code == 0, told.output
    (written,) = tmp_path.glob("*.xlsx")
    assert all(isinstance(row[column], float | int) for row in rows_of(written, table))
