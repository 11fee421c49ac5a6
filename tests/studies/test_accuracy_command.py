"""What `torsionbook accuracy` shows and writes of a study, whatever was measured."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from addin.studies import accuracy
from engine.results.results import AccuracyRow
from engine.studies.accuracy.accuracy import AccuracyStudy
from tests.command_line import ROOT, torsionbook
from tests.opened import rows_of


def test_a_study_is_in_the_terminal_the_workbook_and_the_json(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    rows = (
        AccuracyRow("exponential", "tolerance 0.01", 4.7e-5, 3e-10, 0.0123),
        AccuracyRow("newmark", "step 0.002 s", None, None, 0.0456),
    )
    study = AccuracyStudy(rows, "You asked for 0.1 %.", "Against a finer one.")
    monkeypatch.setattr(accuracy, "accuracy_study", lambda case, **_: study)
    source = ROOT / "templates" / "example_modified.xlsx"
    done = torsionbook(
        "accuracy", source, "--out", ".", "--json", "a.json", "--quick", cwd=tmp_path
    )
    assert done.returncode == 0, done.stderr
    assert "You asked for 0.1 %." in done.stdout
    # 4.7e-5 in percent with two digits; smaller than a chart shows; seconds in ms
    for number in ("0.0047", "< 0.0000001", "12.3"):
        assert number in done.stdout
    found = json.loads((tmp_path / "a.json").read_text(encoding="utf-8"))
    assert [row.get("error_peak") for row in found["accuracy_cost"]] == [4.7e-5, None]
    assert found["accuracy"]["reference"] == "Against a finer one."
    shown = rows_of(tmp_path / "example_modified.xlsx", "AccuracyCost")
    assert [row["Method"] for row in shown] == [row.method for row in rows]
