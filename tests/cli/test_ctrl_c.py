"""Ctrl-C at any moment: one sentence, exit status 130, no traceback, no half-written file."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

from addin.contract.shipped import template_path

ROOT = Path(__file__).resolve().parents[2]
#: Sends Ctrl-C to itself when a function is called, as a user does who grows impatient then.
SCRIPT = """
import importlib, os, signal, sys
signal.signal(signal.SIGINT, signal.default_int_handler)  # tests run in the background ignore it
module, name = sys.argv[1].rsplit(".", 1)
owner = importlib.import_module(module)
real = getattr(owner, name)
def cut(*words, **more):
    signal.raise_signal(signal.SIGINT)  # os.kill would end the process on Windows
    return real(*words, **more)
setattr(owner, name, cut)
sys.argv = ["torsionbook", *sys.argv[2:]]
from addin.cli import main
main()
"""


@pytest.fixture
def folder(tmp_path) -> Path:
    shutil.copy(template_path("example_proposed.xlsx"), tmp_path / "a.xlsx")
    return tmp_path


@pytest.mark.first_ones(1)
@pytest.mark.parametrize(
    ("when", "words"),
    [
        ("addin.reading.one_file.read_checked", "recalc a.xlsx"),
        pytest.param(
            "addin.calculation.calculation.run_with_conditions",
            "recalc a.xlsx --json a.json",
            marks=pytest.mark.slow,
        ),
        ("os.replace", "recalc a.xlsx --json a.json"),
        pytest.param(
            "addin.studies.run_study.study_one", "accuracy a.xlsx --quick", marks=pytest.mark.slow
        ),
        ("engine.studies.accuracy.accuracy.accuracy_study", "accuracy a.xlsx --quick"),
        ("addin.verify.file.verify_file", "verify a.xlsx --json a.json"),
        pytest.param(
            "addin.diff.compare.compare_files",
            "diff a.xlsx a.xlsx --xlsx d.xlsx",
            marks=pytest.mark.slow,
        ),
        pytest.param(
            "addin.report.make.report", "report a.xlsx --docx a.docx", marks=pytest.mark.slow
        ),
    ],
)
def test_ctrl_c(folder, when, words):
    done = subprocess.run(
        [sys.executable, "-c", SCRIPT, when, *words.split()],
        cwd=folder,
        capture_output=True,
        text=True,
        encoding="utf-8",
        env={**os.environ, "PYTHONPATH": str(ROOT), "PYTHONIOENCODING": "utf-8"},
        timeout=300,
    )
    assert done.returncode == 128 + signal.SIGINT, done.stderr
    assert "Traceback" not in done.stderr
    assert done.stderr.strip().splitlines()[-1].startswith("Interrupted. ")
    left = {path.name for path in folder.iterdir()}
    assert left <= {"a.xlsx", "a.out.xlsx", "a.json"}
    for name in left - {"a.json"}:  # what is there is whole
        assert zipfile.ZipFile(folder / name).testzip() is None
