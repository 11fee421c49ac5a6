"""A TolerancePeak below what can be met is refused wherever it is typed, and its cell is named."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from typed_cells import typed
from typer.testing import CliRunner

from addin.cli.app import app
from addin.contract.shipped import template_path
from addin.reading.case_json import case_to_json
from addin.reading.workbook import read_workbook

SOURCE = template_path("example_proposed.xlsx")
#: What every refusal says.
ALLOWED = "it must be between 2e-07 and 0.5 (50 %)"


def checked(path: Path) -> tuple[int, str]:
    done = CliRunner().invoke(app, ["check", str(path)])
    return done.exit_code, " ".join(done.output.split())


def with_tolerance(target: Path, percent: float) -> Path:
    """The example with this in its cell TolerancePeak, whose unit is %."""
    return typed(SOURCE, target, {"TolerancePeak": percent})


def test_a_workbook_is_refused_with_the_cell(tmp_path: Path) -> None:
    code, said = checked(with_tolerance(tmp_path / "train.xlsx", 1e-6))
    assert code == 1
    assert "Sheet Case, TolerancePeak (cell " in said
    assert "found 1e-06 %" in said
    assert ALLOWED in said
    assert "leave it blank for 0.1 %" in said
    assert checked(with_tolerance(tmp_path / "least.xlsx", 2e-5))[0] == 0


def test_a_case_json_is_refused(tmp_path: Path) -> None:
    case = case_to_json(read_workbook(SOURCE).data)
    for tolerance, expected in ((1e-8, 1), (2e-7, 0)):
        (tmp_path / "case.json").write_text(json.dumps({**case, "tolerance_peak": tolerance}))
        code, said = checked(tmp_path / "case.json")
        assert code == expected
        assert ("tolerance_peak" in said and ALLOWED in said) == bool(expected)


@pytest.mark.parametrize("command", ["recalc", "batch"])
@pytest.mark.parametrize("value", ["1e-8", "0.000001%"])
def test_the_command_line_refuses_it(tmp_path: Path, command: str, value: str) -> None:
    words = [command, str(SOURCE), "--out", str(tmp_path / "out"), "--tolerance", value]
    done = CliRunner().invoke(app, words)
    assert done.exit_code == 2
    said = " ".join(done.output.replace("│", " ").split())
    assert "--tolerance is 1e-08; it must be between 2e-07 and 0.5 (50 %)." in said
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("command", ["tune", "tolerances", "starts", "sensitivities"])
def test_studies_refuse_the_case(tmp_path: Path, command: str) -> None:
    target = with_tolerance(tmp_path / "train.xlsx", 1e-6)
    done = CliRunner().invoke(app, [command, str(target), "--out", str(tmp_path / "out")])
    assert done.exit_code == 1
    assert "TolerancePeak" in done.output


@pytest.mark.slow
def test_a_row_of_a_programme_is_refused(tmp_path: Path) -> None:
    base, table = tmp_path / "base.json", tmp_path / "table.csv"
    base.write_text(json.dumps(case_to_json(read_workbook(SOURCE).data)))
    table.write_text("TolerancePeak,Name\n0.01,fine\n1e-8,small\n")
    words = ["batch", base, "--vary", table, "--out", tmp_path / "out", "--csv", "--jobs", "1"]
    done = CliRunner().invoke(app, list(map(str, words)))
    assert done.exit_code == 1
    rows = (tmp_path / "out" / "results.csv").read_text(encoding="utf-8-sig").splitlines()
    fine, small = (
        next(row for row in rows if f",{name}," in f",{row}") for name in ("fine", "small")
    )
    assert ",done," in fine
    assert f"small,1e-08,wrong input,TolerancePeak: found 1e-08; {ALLOWED}" in small
