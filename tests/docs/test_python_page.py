"""The scripts of docs/python.md and of the README run as they stand there."""

import dataclasses
import re
from pathlib import Path

import pytest

import torsionbook as tb

ROOT = Path(__file__).resolve().parents[2]


def blocks(page):
    return re.findall(r"^```python\n(.*?)^```", page.read_text(encoding="utf-8"), re.M | re.S)


@pytest.mark.parametrize("page", ["docs/python.md", "README.md"])
def test_the_scripts_of_a_page_run(page, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    found = blocks(ROOT / page)
    assert len(found) == {"docs/python.md": 4, "README.md": 1}[page]
    names = {}
    for number, block in enumerate(found):
        exec(compile(block, f"{page}, script {number + 1}", "exec"), names)
    done = names["result"].results
    assert (tmp_path / "train.out.xlsx").is_file()
    assert done.input.value("DampingRatio") == pytest.approx(0.02)
    assert done.overall in capsys.readouterr().out


def test_the_readme_needs_ten_lines():
    (block,) = blocks(ROOT / "README.md")
    assert len([line for line in block.splitlines() if line.strip()]) <= 10


def test_the_page_lists_every_name():
    text = (ROOT / "docs" / "python.md").read_text(encoding="utf-8")
    table = text[text.index("## All names") :]
    for name in tb.__all__:
        assert f"tb.{name}" in table or f"`{name}`" in table
    for start, described in (
        (r"`Input` \| ", tb.Input),
        (r"→ `tb.StudyResults` \| ", tb.StudyResults),
        (r"→ `tb.Recalculated` \| ", tb.Recalculated),
    ):
        listed = re.search(start + r"(.*) \|", table)[1]
        fields = [f.name for f in dataclasses.fields(described)]
        members = {n for n in (*dir(described), *fields) if not n.startswith("_")}
        assert set(re.findall(r"`(\w+)(?:\(\))?`", listed)) == members
    results = text[text.index("## Results") : text.index("## Workbooks without Excel")]
    for name in vars(tb.Results):
        assert name.startswith("_") or name == "input" or f"done.{name}" in results, name
