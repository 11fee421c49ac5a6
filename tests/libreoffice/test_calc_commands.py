"""``torsionbook calc install``."""

import json
import sys
import zipfile

import pytest
from typer.testing import CliRunner

from addin.cli.app import app


def run(*words):
    return CliRunner().invoke(app, ["calc", "install", *map(str, words)])


def test_it_writes_the_extension_and_says_how_to_add_it(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    done = run()
    assert done.exit_code == 0, done.output
    with zipfile.ZipFile(tmp_path / "torsionbook.oxt") as archive:
        assert json.loads(archive.read("settings.json"))["command"][0] == sys.executable
    for words in ("torsionbook.oxt", "Extension", "unopkg add"):
        assert words in done.output


def test_a_file_that_is_there_stays_unless_told(tmp_path):
    target = tmp_path / "mine.oxt"
    target.write_text("mine")
    done = run("--to", target)
    assert done.exit_code == 1
    assert "--force" in done.output
    assert target.read_text() == "mine"
    assert run("--to", target, "--force").exit_code == 0
    assert zipfile.is_zipfile(target)


@pytest.mark.parametrize(
    ("name", "status", "words"),
    [("it.zip", 2, "must end in .oxt"), ("no/folder/it.oxt", 1, "Nothing was written")],
)
def test_what_cannot_be_written_is_told(tmp_path, name, status, words):
    done = run("--to", tmp_path / name)
    assert done.exit_code == status
    # a message of wrong usage stands in a box, wrapped
    assert words in " ".join(done.output.replace("│", " ").split())
