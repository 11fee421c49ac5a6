"""Terminal, JSON, batch and report give one verdict; --strict is 0 for two of them.

Workbook: tests/workbook/test_banner.py. Server: tests/server/test_http.py.
"""

from __future__ import annotations

import json
import math
import re
import zipfile
from pathlib import Path
from typing import Any

import pandas as pd
import pytest
from typer.testing import CliRunner

from addin.cli.app import app
from addin.contract.shipped import template_path
from addin.reading.case_json import case_to_json
from addin.reading.workbook import read_workbook


def changed(folder: Path, change: str) -> Path:
    """The modified design as a case JSON: as it is, without a limit, with a wrong unit, or failing."""
    content: dict[str, Any] = case_to_json(
        read_workbook(template_path("example_modified.xlsx")).data
    )
    elements = {row["element"]: row for row in content["elements"]}
    content["meshes"][0]["backlash"] = 0.0  # its torque reverses
    if change == "incomplete":
        del elements["HS coupling"]["peak_torque_limit"]
    elif change == "check the inputs":
        for row in elements.values():
            row["stiffness"] *= 1e-6
    elif change == "fail":
        elements["HS coupling"]["peak_torque_limit"] = 1.0
    elif change == "pass":
        content["margin_required"] = 0.1
    path = folder / "train.json"
    path.write_text(json.dumps(content), encoding="utf-8")
    return path


def twist_of_first(source: Path) -> str:
    """Rated torque over the stiffness of the first element, in degrees to four digits."""
    content = json.loads(source.read_text(encoding="utf-8"))
    twist = math.degrees(content["rated_torque"] / content["elements"][0]["stiffness"])
    return f"{float(f'{twist:.4g}'):,.0f}"


def first_page(report: Path) -> str:
    """Text of a Word report up to its table of revisions, in small letters."""
    with zipfile.ZipFile(report) as parts:
        text = parts.read("word/document.xml").decode()
    return re.sub(r"<[^>]+>", " ", text).casefold().split("revisions", 1)[0]


def said(*words: object) -> tuple[int, str]:
    done = CliRunner().invoke(app, [str(word) for word in words], env={"COLUMNS": "250"})
    return done.exit_code, done.output


@pytest.mark.parametrize(
    ("change", "headline", "strict"),
    [
        pytest.param("pass", "PASS: all 8 checks", 0, marks=pytest.mark.slow),
        pytest.param(
            "accepted by forced response",
            "ACCEPTED (margin by forced response): all 8 checks",
            0,
            marks=pytest.mark.slow,
        ),
        ("incomplete", "INCOMPLETE: 1 of 8 checks not judged, or only in part", 1),
        pytest.param(
            "check the inputs",
            # a thousandth of the 21 Hz in Table 1 of the paper
            "CHECK THE INPUTS: first torsional mode at 0.021 Hz; twist of 'Motor shaft' (and 8 more) {twist} "
            "degrees under the torque that it transmits",
            1,
            marks=pytest.mark.slow,
        ),
        pytest.param("fail", "FAIL: 1 of 8 checks", 1, marks=pytest.mark.slow),
    ],
)
def test_every_front_of_the_command_line_gives_the_same_verdict(
    tmp_path: Path, change: str, headline: str, strict: int
) -> None:
    source = changed(tmp_path, change)
    status, terminal = said("recalc", source, "--json", tmp_path / "r.json", "--strict")
    assert status == strict
    content = json.loads((tmp_path / "r.json").read_text(encoding="utf-8"))
    notes = len(content["warnings"])
    assert content["overall"] == content["verdicts"][0]["verdict"] == change
    counted = f", {notes} note{'s' if notes > 1 else ''}" if notes else ""
    assert content["headline"] == headline.format(twist=twist_of_first(source)) + counted
    assert change in terminal
    status, _ = said("report", source, "--docx", tmp_path / "r.docx")
    assert status == 0
    assert f"overall verdict: {change} " in first_page(tmp_path / "r.docx")
    status, _ = said("batch", source, "--out", tmp_path / "out", "--jobs", 1, "--strict")
    assert status == strict
    cell = pd.read_csv(tmp_path / "out" / "summary.csv", encoding="utf-8-sig")["Verdict"][0]
    open_ = sum(row["verdict"] in ("not judged", "incomplete") for row in content["verdicts"][1:])
    assert cell == (f"{change}, {open_} not judged" if open_ else change)


def test_check_names_what_will_not_be_judged(tmp_path: Path) -> None:
    status, terminal = said("check", changed(tmp_path, "incomplete"))
    assert status == 0
    assert "Peak torque not judged: HS coupling. Type a Peak torque limit." in terminal
    (tmp_path / "whole").mkdir()
    status, terminal = said("check", changed(tmp_path / "whole", "pass"))
    assert "not judged" not in terminal


def test_scatter_alone_asks_for_no_measurement(tmp_path: Path) -> None:
    source = changed(tmp_path, "pass")
    content = json.loads(source.read_text(encoding="utf-8"))
    content["scatter"] = [{"quantity": "stiffness", "spread": 0.05}]
    source.write_text(json.dumps(content), encoding="utf-8")
    status, terminal = said("check", source)
    assert (status, "nothing was measured" in terminal) == (0, False)
    content["measured_frequencies"] = [{"frequency": -1.0}]
    source.write_text(json.dumps(content), encoding="utf-8")
    assert said("check", source)[0] == 1
