"""Files that cannot be read or written end with a sentence and exit status 1, never 3."""

from __future__ import annotations

from pathlib import Path

import pytest
from command_line import torsionbook

CASE = '{"format": 1, "stations": [{"station": "a", "inertia": 1}]}'


@pytest.mark.first_ones(1)
@pytest.mark.parametrize(
    "words",
    [
        ("recalc", "case.json", "--out", "a_file"),
        ("recalc", "case.json", "--json", "a_file/out.json"),
        ("export", "case.json", "a_file/out.json"),
        ("export", "case.json", "a_folder"),
    ],
    ids=" ".join,
)
def test_target_that_cannot_be_written(tmp_path: Path, words: tuple[str, ...]) -> None:
    (tmp_path / "case.json").write_text(CASE, encoding="utf-8")
    (tmp_path / "a_file").write_text("x", encoding="utf-8")
    (tmp_path / "a_folder").mkdir()
    done = torsionbook(*words, cwd=tmp_path)
    assert "Traceback" not in done.stderr
    assert done.returncode in (1, 2), done.stderr
    assert "a_file" in done.stderr or "a_folder" in done.stderr
