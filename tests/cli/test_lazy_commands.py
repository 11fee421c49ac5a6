"""Commands are found in a table, and their modules are imported when they are called."""

import importlib
import re
import subprocess
import sys
from pathlib import Path

import pytest
import typer
from typer.testing import CliRunner

from addin.cli.app import COMMANDS, GROUPS, app, module_of
from addin.cli.study_commands import STUDY_COMMANDS
from addin.contract.shipped import template_path
from addin.studies.registry import found_studies


@pytest.mark.parametrize("name", COMMANDS)
def test_the_table_says_what_the_command_says_of_itself(name):
    command = typer.main.get_command(app).get_command(None, name)
    assert command.name == name
    own_help = " ".join((command.help or "").split("\n\n")[0].split())
    assert COMMANDS[name] == own_help


def test_every_module_of_a_command_is_in_the_table():
    """A command that nobody can call is no command."""
    modules = {module_of(name) for name in COMMANDS}
    for module in modules:
        importlib.import_module(module)
    assert set(COMMANDS) >= {"new", "check", "recalc", "export", "version", "excel", "calc"}


@pytest.mark.parametrize("words", [["--help"], ["--version"], []])
def test_help_imports_no_command(words):
    script = (
        "import sys\nfrom addin.cli.app import COMMANDS, app, module_of\n"
        "try:\n    app(sys.argv[1:])\nexcept SystemExit:\n    pass\n"
        "modules = {module_of(name) for name in COMMANDS}\n"
        "print('imported:', sorted(modules & set(sys.modules)))\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", script, *words], capture_output=True, text=True, check=True
    )
    assert done.stdout.endswith("imported: []\n"), done.stdout


def test_a_mistyped_command_is_answered_with_the_nearest():
    done = CliRunner().invoke(app, ["recalk", "train.xlsx"])
    assert done.exit_code == 2
    assert "No such command 'recalk'. Did you mean 'recalc'" in done.output


@pytest.mark.parametrize("study", found_studies(), ids=lambda study: study.command)
def test_a_study_has_the_options_of_its_record(study):
    command = typer.main.get_command(app).get_command(None, study.command)
    options = {parameter.name for parameter in command.params}
    assert options >= {"file", "out", "in_place", "json", "ignore_lock"}
    assert options >= {option.name for option in study.options}
    assert ("jobs" in options) is not study.measures_time


#: What a recalculation has no use for; `urllib.request` brings an HTTP client and ssl.
NOT_NEEDED = {"scipy", "pandas", "openpyxl", "urllib.request", "numpy.ma", "rich"}


def test_a_recalculation_imports_nothing_that_it_does_not_need(tmp_path):
    script = (
        "import sys\nfrom addin.cli.app import app\n"
        "try:\n    app(sys.argv[1:])\nexcept SystemExit:\n    pass\n"
        f"print('imported:', sorted({NOT_NEEDED} & set(sys.modules)))\n"
    )
    templates = Path(__file__).parents[2] / "templates"
    books = [templates / f"example_{name}.xlsx" for name in ("proposed", "backlash")]
    words = [sys.executable, "-c", script, "recalc", *map(str, books), "--out", str(tmp_path)]
    done = subprocess.run(words, capture_output=True, text=True, check=True)
    assert "written" in done.stdout
    assert done.stdout.endswith("imported: []\n"), done.stdout


def test_help_has_the_commands_in_groups_with_those_of_every_day_first():
    shown = CliRunner().invoke(app, ["-h"], terminal_width=100).output
    places = [shown.index(group) for group in GROUPS]
    assert places == sorted(places)
    assert (
        shown.index(" new ")
        < shown.index(" recalc ")
        < shown.index(" verify ")
        < shown.index(" serve ")
    )


@pytest.mark.parametrize(
    "words", [["-h"], ["recalc", "-h"], ["excel", "-h"], ["excel", "install", "-h"]]
)
def test_short_help_is_the_long_one(words):
    short = CliRunner().invoke(app, words)
    assert short.exit_code == 0
    assert short.output == CliRunner().invoke(app, [*words[:-1], "--help"]).output


def test_short_version_is_the_long_one():
    assert CliRunner().invoke(app, ["-V"]).output == CliRunner().invoke(app, ["--version"]).output


@pytest.mark.parametrize(
    ("typed", "offered"), [("re", ["recalc", "report"]), ("recalc --stri", ["--strict"])]
)
def test_the_shell_completes_commands_and_options(typed, offered):
    words = f"torsionbook {typed}"
    settings = {
        "_TORSIONBOOK_COMPLETE": "complete_bash",
        "COMP_WORDS": words,
        "COMP_CWORD": str(len(words.split()) - 1),
    }
    done = CliRunner().invoke(app, [], env=settings, prog_name="torsionbook")
    assert done.output.split() == offered


def test_the_example_of_the_studies_is_the_shipped_one(tmp_path):
    made = tmp_path / "studies.xlsx"
    assert CliRunner().invoke(app, ["new", str(made), "--example", "studies"]).exit_code == 0
    assert made.read_bytes() == template_path("example_studies.xlsx").read_bytes()


def test_notes_of_a_file_follow_its_own_lines(tmp_path, monkeypatch):
    monkeypatch.setenv("COLUMNS", "80")
    books = [str(template_path(f"example_{name}.xlsx")) for name in ("proposed", "backlash")]
    shown = CliRunner().invoke(app, ["recalc", *books, "--out", str(tmp_path)]).output
    places = [
        shown.index(start)
        for start in (
            "example_proposed.xlsx\n  First modes",
            f"{books[0]}: note:",
            "example_backlash.xlsx\n  First modes",
            f"{books[1]}: note:",
            "written:",
        )
    ]
    assert places == sorted(places)


def test_examples_of_the_studies_name_options_that_they_have():
    """`starts` has no sheet to add, and its help once said --add."""
    for name in STUDY_COMMANDS:
        shown = CliRunner().invoke(app, [name, "--help"]).output
        _, _, after = shown.partition("Example")
        example = re.split(r"\n\s*\n", after)[0]
        for option in re.findall(r"--[a-z-]+", example):
            assert shown.count(option) > example.count(option), (name, option)


@pytest.mark.parametrize(
    ("words", "example"),
    [
        (["import", "masses.csv"], "torsionbook import masses.csv --out train.xlsx"),
        (["batch", "trains"], "torsionbook batch trains --out results"),
    ],
)
def test_what_is_missing_comes_with_an_example(words, example):
    result = CliRunner().invoke(app, words, env={"COLUMNS": "300"})
    assert result.exit_code == 2
    assert "Missing option '--out'." in result.stderr
    assert f"Example: {example}" in result.stderr
