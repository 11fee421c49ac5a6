"""Workbooks that tests of several rooms start from: calculated once a test run, whatever its processes."""

from __future__ import annotations

import json
import os
import shutil
import time
import traceback
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from script_modules import script_module

#: Longest time that one process waits for what another makes, s.
PATIENCE = 600.0

#: Rows of the study sheets of `studied`.
STUDY_ROWS: dict[str, Any] = {
    "tuning": [
        {"element": "HS coupling", "quantity": "stiffness", "unit": "%", "values": "40; 60; 80"},
        {"element": "LS coupling", "quantity": "stiffness", "unit": "%", "values": "80; 100"},
    ],
    "scatter": [{"quantity": "stiffness", "spread": 0.05}, {"quantity": "S-N line", "spread": 0.005}],
    "start_conditions": [
        {"condition": "normal", "per_year": 10},
        {"condition": "weak", "voltage": 0.9, "per_year": 2, "so_far": 40},
    ],
    "measured_frequencies": [{"mode": 1, "frequency": 29.5}],
}  # fmt: skip


def made_once(factory: pytest.TempPathFactory, name: str, make: Callable[[Path], None]) -> Path:
    """A folder that `make` has filled, in this process of the test run or in another.

    Tests copy what they change: the folder belongs to all of them.
    """
    base = factory.getbasetemp()
    # Each process of a run has a folder of its own in that of the run. The variable alone would not do:
    # a test that starts pytest itself hands it down.
    if base.name == f"popen-{os.environ.get('PYTEST_XDIST_WORKER')}":
        base = base.parent
    folder = base / "shared" / name
    finished = folder.with_name(f"{name}.finished")
    folder.parent.mkdir(exist_ok=True)
    try:
        folder.mkdir()
    except FileExistsError:
        waited = time.monotonic() + PATIENCE
        while not finished.exists():
            if time.monotonic() > waited:
                raise TimeoutError(f"{folder} was not finished in {PATIENCE:g} s") from None
            time.sleep(0.05)
        error = finished.read_text(encoding="utf-8")
        if error:
            raise RuntimeError(f"another process could not make {name}:\n{error}") from None
        return folder
    error = ""
    try:
        make(folder)
    except BaseException:
        error = traceback.format_exc()
        raise
    finally:
        # Complete when it appears under its name.
        half = finished.with_suffix(".half")
        half.write_text(error, encoding="utf-8")
        half.rename(finished)
    return folder


def calculate_examples(folder: Path) -> None:
    """The paper's two systems, each as NAME.in.xlsx, NAME.xlsx (calculated) and NAME.results.json."""
    from addin.contract.shipped import template_path
    from addin.writing.recalculate import recalculate

    for name in ("proposed", "modified"):
        source = folder / f"{name}.in.xlsx"
        shutil.copyfile(template_path(f"example_{name}.xlsx"), source)
        done = recalculate(
            source,
            destination=folder / f"{name}.xlsx",
            json_file=folder / f"{name}.results.json",
        )
        assert not done.problems


def calculate_studies(folder: Path) -> None:
    """The proposed system with its results and four studies: train.xlsx, and STUDY.json of each."""
    from typer.testing import CliRunner

    from addin.cli.app import app
    from addin.reading.case_json import case_to_json
    from tests.sample_case import sample_case

    case, book = folder / "case.json", folder / "train.xlsx"
    train = sample_case(
        "proposed", starts_required=300.0, starts_factor=2.0, torque_follows="own speed"
    )
    content = case_to_json(train) | STUDY_ROWS
    case.write_text(json.dumps(content), encoding="utf-8")
    here = ("--in-place", "--jobs", "1")
    for words in (
        ("new", str(book), "--studies", "--units", "si", "--from", str(case)),
        ("recalc", str(book), "--in-place"),
        ("tune", str(book), *here, "--json", str(folder / "tune.json")),
        (
            "tolerances",
            str(book),
            *here,
            "--json",
            str(folder / "tolerances.json"),
            "--samples",
            "40",
        ),
        ("starts", str(book), *here, "--json", str(folder / "starts.json")),
        ("calibrate", str(book), *here, "--json", str(folder / "calibrate.json")),
    ):
        done = CliRunner().invoke(app, list(words))
        assert done.exit_code == 0, done.output


def write_derived(folder: Path) -> None:
    """Every file that `make generated` writes: pages, schemas, the list of sentences, templates."""
    script_module("generated").write_generated(folder)
