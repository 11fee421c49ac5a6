"""Names that are no file to calculate, and a date that is none. Each is answered in a sentence."""

import os
import shutil

import pytest
from typer.testing import CliRunner

from addin.cli.app import app
from addin.contract.shipped import template_path

COMMANDS = {
    "check": ["check", "{}"],
    "recalc": ["recalc", "{}"],
    "verify": ["verify", "{}"],
    "diff": ["diff", "{}", "{}"],
    "tune": ["tune", "{}"],
    "report": ["report", "{}", "--docx", "sheet.docx"],
    "export": ["export", "{}", "case.json"],
}


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A folder to work in, with one whole workbook."""
    monkeypatch.chdir(tmp_path)
    shutil.copy(template_path("example_proposed.xlsx"), "train.xlsx")
    return tmp_path


def _circle() -> None:
    os.symlink("b.xlsx", "a.xlsx")
    os.symlink("a.xlsx", "b.xlsx")


@pytest.mark.parametrize("command", COMMANDS)
def test_the_folder_one_stands_in_is_named_as_a_folder(folder, command):
    done = CliRunner().invoke(app, [word.format(".") for word in COMMANDS[command]])
    assert done.exit_code == 1
    assert ". is a folder, not a workbook." in done.output
    assert sorted(os.listdir(folder)) == ["train.xlsx"]


@pytest.mark.skipif(os.name == "nt", reason="links need rights on Windows")
@pytest.mark.parametrize("command", COMMANDS)
def test_links_in_a_circle_are_named(folder, command):
    _circle()
    done = CliRunner().invoke(app, [word.format("a.xlsx") for word in COMMANDS[command]])
    assert done.exit_code == 1
    assert "a.xlsx cannot be used: Too many levels of symbolic links." in done.output
    assert sorted(os.listdir(folder)) == ["a.xlsx", "b.xlsx", "train.xlsx"]


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no named pipes on Windows")
def test_a_batch_goes_on_past_links_in_a_circle_and_pipes(folder):
    _circle()
    os.mkfifo("pipe.xlsx")
    done = CliRunner().invoke(app, ["batch", ".", "--out", "results", "--jobs", "1"])
    assert done.exit_code == 1
    assert "      1 done\n             1 × fail" in done.output
    assert "pipe.xlsx cannot be used: it is a device or a pipe." in done.output
    assert "a.xlsx cannot be used: Too many levels of symbolic links." in done.output
    assert (folder / "results" / "train.xlsx").is_file()


@pytest.mark.parametrize("date", ["abc", "1e9", "-5", "9" * 14])
def test_a_fixed_date_that_is_none_is_refused(folder, monkeypatch, date):
    monkeypatch.setenv("SOURCE_DATE_EPOCH", date)
    done = CliRunner().invoke(app, ["recalc", "train.xlsx"], env={"COLUMNS": "400"})
    assert done.exit_code == 2
    assert f"SOURCE_DATE_EPOCH is '{date}'; it must be a whole number of seconds" in done.output
    assert os.listdir(folder) == ["train.xlsx"]
