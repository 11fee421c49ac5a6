"""The public names of `torsionbook`: listed once, documented, typed, light to import."""

import doctest
import importlib
import inspect
import pkgutil
import re
import subprocess
import sys
from pathlib import Path

import pytest

import torsionbook as tb

ROOT = Path(__file__).resolve().parents[2]
#: A name that is here stays.
NAMES = [
    "Check", "Input", "InputError", "Problem", "Recalculated", "Results", "StudyResults", "read",
    "recalculate", "run", "study", "template",
]  # fmt: skip
MODULES = [f"torsionbook.{module.name}" for module in pkgutil.iter_modules(tb.__path__)]


def test_the_public_names_are_these():
    assert tb.__all__ == NAMES
    modules = {name.rpartition(".")[2] for name in MODULES}
    assert {n for n in vars(tb) if not n.startswith("_")} - modules == set(NAMES) - modules


@pytest.mark.parametrize("name", ["torsionbook", *MODULES])
def test_examples_in_docstrings_hold(name):
    found = doctest.testmod(importlib.import_module(name))
    assert found.failed == 0
    if name in ("torsionbook", "torsionbook.inputs", "torsionbook.results", "torsionbook.studies"):
        assert found.attempted >= 2


@pytest.mark.parametrize("name", NAMES)
def test_every_public_method_is_annotated_and_described(name):
    thing = getattr(tb, name)
    members = [thing]
    if inspect.isclass(thing):
        members += [
            m.fget if isinstance(m, property) else m
            for key, m in inspect.getmembers_static(thing)
            if not key.startswith("_") and (inspect.isfunction(m) or isinstance(m, property))
        ]
    for member in members:
        assert inspect.getdoc(member), member
        if inspect.isfunction(member):
            parameters = [
                p for p in inspect.signature(member).parameters.values() if p.name != "self"
            ]
            assert all(p.annotation is not p.empty for p in parameters), member
            assert inspect.signature(member).return_annotation is not inspect.Signature.empty


def test_packages_by_choice_are_not_loaded():
    script = (
        "import sys, torsionbook as tb\n"
        "tb.run(tb.template('example_modified')).rows('StartupPeaks')\n"
        "print(*(name for name in ('pandas', 'openpyxl', 'matplotlib', 'typer', 'xlsxwriter') if name in sys.modules))\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", script], cwd=ROOT, capture_output=True, text=True, check=True
    )
    assert done.stdout.split() == []


def test_a_missing_package_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(ImportError, match=re.escape("pip install 'torsionbook[python]'")):
        tb.read(tb.template("example_modified")).table("Elements")


SNIPPET = """\
import torsionbook as tb

train: tb.Input = tb.read("train.xlsx").change({"DampingRatio": 0.02})
problems: tuple[tb.Problem, ...] = train.check().problems
try:
    done: tb.Results = tb.run(train, progress=print)
except tb.InputError as wrong:
    print(wrong.problems[0].message)
word: str = done.overall
for row in done.verdicts:
    print(row["check"], row["verdict"])
study: tb.StudyResults = tb.study(train, "tolerances", samples=100)
frame = done.table("StartupPeaks", units="us")
print(frame.attrs["units"], done.nonsense)
"""


@pytest.mark.slow
def test_a_users_script_is_typed(tmp_path):
    """mypy --strict sees the types of the package, and finds the one thing that is wrong."""
    (tmp_path / "script.py").write_text(SNIPPET)
    done = subprocess.run(
        [
            sys.executable, "-m", "mypy", "--strict", "--no-incremental", "--follow-imports", "silent",
            "--config-file", "", "script.py",
        ],
        cwd=tmp_path,
        env={"MYPYPATH": "", "PATH": ""},
        capture_output=True,
        text=True,
    )  # fmt: skip
    complaints = [line for line in done.stdout.splitlines() if "error" in line]
    assert complaints[:-1] == [
        'script.py:14: error: "Results" has no attribute "nonsense"  [attr-defined]'
    ], done.stdout
