"""Two seconds of a six-second start: no front may call its starts unlimited."""

import json
from pathlib import Path

import pytest
from docx import Document
from typer.testing import CliRunner

from addin.cli.app import app
from addin.contract.shipped import template_path
from addin.reading.case_json import case_to_json
from addin.reading.workbook import read_workbook
from tests.sample_case import sample_case, with_limits


@pytest.fixture(scope="module")
def cut_short(tmp_path_factory: pytest.TempPathFactory) -> Path:
    case = case_to_json(read_workbook(template_path("example_proposed.xlsx")).data)
    path = tmp_path_factory.mktemp("cut") / "short.json"
    path.write_text(json.dumps(case | {"maximum_time": 2.0}), encoding="utf-8")
    return path


def said(*words: str | Path) -> str:
    done = CliRunner().invoke(app, [str(word) for word in words], env={"COLUMNS": "220"})
    assert done.exit_code == 0, done.output
    return done.output


def test_command_line_and_json(cut_short: Path) -> None:
    results = cut_short.with_name("short.results.json")
    assert "not judged" in said("recalc", cut_short, "--json", results)
    rows = json.loads(results.read_text(encoding="utf-8"))["allowable_starts"]
    assert len(rows) == 6
    assert all(set(row) == {"element", "damage"} for row in rows)


def test_batch(cut_short: Path) -> None:
    said("batch", cut_short, "--out", cut_short.with_name("out"))
    summary = cut_short.with_name("out") / "summary.csv"
    assert ",not judged," in summary.read_text(encoding="utf-8-sig")


def test_diff(cut_short: Path) -> None:
    words = said("diff", template_path("example_proposed.xlsx"), cut_short, "--all")
    line = next(x for x in words.splitlines() if "Allowable starts" in x and "HP compressor" in x)
    assert "477.0" in line
    assert "not judged" in line
    assert "starts are unlimited" not in words


def test_a_whole_number_of_starts_is_never_rounded_up(cut_short: Path) -> None:
    """The paper's proposed system: 436.53 starts of its governing shaft are 436."""
    case = with_limits(sample_case("proposed", torque_follows="own speed"))
    whole = cut_short.with_name("whole.json")
    whole.write_text(json.dumps(case_to_json(case)), encoding="utf-8")
    words = said("diff", whole, cut_short)
    line = next(x for x in words.splitlines() if x.startswith("Allowable starts") and "2,000" in x)
    assert " 436 " in line


@pytest.mark.slow
def test_report(cut_short: Path) -> None:
    target = cut_short.with_name("short.docx")
    said("report", cut_short, "--docx", target)
    document = Document(str(target))
    cells = [c.text for table in document.tables for row in table.rows for c in row.cells]
    text = "\n".join([p.text for p in document.paragraphs] + cells)
    assert "not judged: the start was not completed" in text
    assert "starts unlimited" not in text
    assert "unlimited: no damaging cycle" not in text
