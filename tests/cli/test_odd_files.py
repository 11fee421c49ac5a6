"""Names that are no file to calculate, and a date that is none. Each is answered in a sentence."""

import json
import os
import shlex
import shutil
import stat
import subprocess
import sys

import pytest
from typer.testing import CliRunner

from addin.batch.own_files import sheets_of
from addin.cli.app import app, main
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


LONG = "n" * 250


@pytest.mark.skipif(os.name == "nt", reason="Windows has another limit")
@pytest.mark.parametrize(
    "words",
    [
        ("recalc", "{}.xlsx"),
        ("recalc", "{}.xlsx", "--json", "{}.results.json"),
        ("recalc", "train.xlsx", "--out", "{}.folder/a.xlsx"),
        ("tune", "train.xlsx", "--json", "{}.tune.json"),
        ("tolerances", "train.xlsx", "--samples", "{}.samples.csv"),
        ("export", "train.xlsx", "{}.case.json"),
        ("report", "train.xlsx", "--pdf", "{}.report.pdf"),
        ("diff", "train.xlsx", "train.xlsx", "--xlsx", "{}.diff.xlsx"),
        ("verify", "train.xlsx", "--json", "{}.verify.json"),
        ("new", "{}.new.xlsx"),
        ("batch", "train.xlsx", "--out", "{}.folder"),
        ("calc", "install", "--to", "{}.calc.oxt"),
    ],
)
def test_a_name_longer_than_any_file_has_is_a_sentence(folder, words, monkeypatch, capsys):
    if "{}.xlsx" in words:
        try:
            shutil.copy("train.xlsx", f"{LONG}.xlsx")
        except OSError:
            pytest.skip("no file can have that name here")
    before = sorted(os.listdir(folder))
    monkeypatch.setattr(sys, "argv", ["torsionbook", *(word.format(LONG) for word in words)])
    with pytest.raises(SystemExit) as ended:
        main()
    assert ended.value.code == 1
    assert "File name too long" in capsys.readouterr().err
    assert sorted(os.listdir(folder)) == before


@pytest.mark.skipif(sys.platform != "linux", reason="a name that is no UTF-8 is for Linux")
def test_a_name_that_is_no_utf8_is_written_everywhere(folder):
    """Its bytes are half characters in Python, which no XML can hold."""
    name = os.fsdecode(b"\xff train.xlsx")
    os.rename("train.xlsx", name)
    (folder / f"{LONG}.xlsx").write_bytes((folder / name).read_bytes())
    line = [sys.executable, "-m", "addin.cli"]
    words = ("batch", ".", "--out", "results", "--json", "json", "--jobs", "1")
    done = subprocess.run([*line, *words], capture_output=True, text=True, timeout=300)
    assert done.returncode == 1  # of the long name, which does not stop the other
    assert "Traceback" not in done.stderr
    assert (folder / "results" / name).is_file()
    rows = (folder / "results" / "summary.csv").read_text("utf-8-sig")
    assert "\ufffd train.xlsx,done," in rows
    assert sheets_of(folder / "results" / "summary.xlsx") == ("Files", "Errors")
    words = ("diff", name, name, "--xlsx", "d.xlsx", "--json", "d.json")
    assert subprocess.run([*line, *words], capture_output=True, timeout=300).returncode == 0
    assert json.loads((folder / "d.json").read_text("utf-8"))["a"]["file"] == name


@pytest.mark.skipif(os.name != "posix", reason="the shell closes them")
@pytest.mark.parametrize(
    "words", [("recalc", "train.xlsx"), ("report", "train.xlsx", "--pdf", "r.pdf")]
)
def test_a_command_without_streams_does_its_work(folder, words):
    line = [sys.executable, "-m", "addin.cli", *words]
    closed = "exec 0<&- 1>&- 2>&-; exec " + shlex.join(line)
    assert subprocess.run(["sh", "-c", closed], cwd=folder, timeout=300).returncode == 0
    assert sorted(os.listdir(folder)) != ["train.xlsx"]


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="Linux has it")
def test_a_full_output_claims_nothing_of_files(folder):
    line = [sys.executable, "-m", "addin.cli", "recalc", "train.xlsx"]
    with open("/dev/full", "w") as full:
        done = subprocess.run(line, stdout=full, stderr=subprocess.PIPE, text=True, timeout=300)
    assert done.returncode == 1
    assert (folder / "train.out.xlsx").is_file()
    assert "Files that were written are complete" in done.stderr
    assert "Nothing was written" not in done.stderr


@pytest.mark.skipif(
    sys.platform != "linux", reason="root may write everywhere; Linux can take that away"
)
def test_a_folder_without_rights_is_named_not_a_file_nobody_knows(folder):
    if not shutil.which("setpriv"):
        pytest.skip("setpriv is not installed")
    rights = "-dac_override,-dac_read_search"
    low = (
        ["setpriv", f"--inh-caps={rights}", f"--bounding-set={rights}"] if os.getuid() == 0 else []
    )
    os.mkdir("closed", 0o555)
    os.mkdir("hidden")
    shutil.copy("train.xlsx", "hidden/train.xlsx")
    os.chmod("hidden", 0o600)  # it can be listed, but nothing in it can be looked at

    def run(*words):
        line = [*low, sys.executable, "-m", "addin.cli", *words]
        return subprocess.run(line, capture_output=True, text=True, timeout=300)

    for words in (("new", "closed/n.xlsx"), ("report", "train.xlsx", "--pdf", "closed/r.pdf")):
        done = run(*words)
        assert done.returncode == 1
        assert "Nothing can be read or written in the folder closed." in done.stderr
    done = run("batch", "hidden", "train.xlsx", "--out", "results", "--jobs", "1")
    assert done.returncode == 1
    assert "train.xlsx: no access: " in done.stderr
    assert "error inside torsionbook" not in done.stderr
    os.chmod("hidden", 0o700)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no named pipes on Windows")
@pytest.mark.parametrize(
    "words",
    [
        ("batch", ".", "--out", "results", "--jobs", "1"),
        ("batch", "train.xlsx", "--out", ".", "--jobs", "1"),
        ("batch", "train.xlsx", "--out", "results", "--vary", "pipe.csv", "--csv"),
        ("diff", "pipe.json", "train.xlsx"),
        ("recalc", "train.xlsx", "--out", "pipe.xlsx"),
        ("recalc", "train.xlsx"),
        ("report", "train.xlsx", "--pdf", "r.pdf", "--logo", "pipe.png"),
    ],
)
def test_nothing_waits_for_a_pipe(folder, words):
    """Nobody writes into them, so that whoever opens one waits for ever."""
    for name in ("pipe.json", "pipe.xlsx", "pipe.csv", "pipe.png", "summary.csv"):
        os.mkfifo(name)
    if words == ("recalc", "train.xlsx"):
        os.mkfifo("~$train.out.xlsx")
    line = [sys.executable, "-m", "addin.cli", *words]
    done = subprocess.run(line, capture_output=True, text=True, timeout=120)
    assert done.returncode in (1, 2)
    assert "Traceback" not in done.stderr
    assert stat.S_ISFIFO(os.stat("pipe.xlsx").st_mode)
