"""What is printed at any width of the console, and without one: names stand whole, brackets and colons in them stay."""

from __future__ import annotations

import re
import shutil

import pytest
from typer.testing import CliRunner

from addin.cli.app import app
from addin.cli.terminal import print_table
from addin.contract.shipped import template_path

LONG = "coupling_between_motor_and_pinion_" * 5
NAMES = ("[/x] bearing", "[mm] 12", "pump :x: 2", LONG)


WIDTHS = pytest.mark.parametrize("width", ["20", "80", None])


def printed(*words: str, width: str | None) -> str:
    """What a command that succeeds prints."""
    done = CliRunner(env={"COLUMNS": width}).invoke(app, words)
    assert done.exit_code == 0, done.output
    assert "…" not in done.output
    return done.output


@WIDTHS
def test_a_table_shows_every_name_whole(width, capsys, monkeypatch):
    monkeypatch.delenv("COLUMNS", raising=False)
    if width is not None:
        monkeypatch.setenv("COLUMNS", width)
    columns = (("Row [mm]", "name"), ("Words [rpm]", "text"), ("Value", "number"))
    print_table(columns, [[name, name, "1234.5"] for name in NAMES])
    shown = capsys.readouterr().out
    for name in NAMES:
        assert len(re.findall(rf"{re.escape(name)} *│ {re.escape(name)} *│ *1234\.5", shown)) == 1
    assert re.match(r"Row \[mm\] *[┃│] Words \[rpm\] *[┃│] *Value", shown)


@WIDTHS
def test_a_comparison_names_its_files_whole(width, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    first, second = f"first [red] {LONG}.xlsx", "second [red].xlsx"
    shutil.copy(template_path("example_proposed.xlsx"), first)
    shutil.copy(template_path("example_modified.xlsx"), second)
    shown = printed("diff", first, second, width=width)
    assert f"A  {first}" in shown
    assert f"B  {second}" in shown


@WIDTHS
def test_a_recalculation_names_its_file_whole(width, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    name = "train [red] of the station.xlsx"
    shutil.copy(template_path("example_proposed.xlsx"), name)
    assert name in printed("recalc", name, "--in-place", width=width)
