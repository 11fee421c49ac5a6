"""Compiled loops are kept in the user's cache folder where the package cannot be written."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
SCRIPT = """
import numpy as np
from engine.stepping.compiling import is_compiled
from engine.stepping.linear_loop import turning_points
before = is_compiled(turning_points)
turning_points(np.array([0.0, 1.0]), np.array([0.0, 0.0]), np.array([1.0, -1.0]))
print(before, turning_points.stats.cache_path)
"""


def _run(folder: Path, home: Path) -> list[str]:
    kept = {k: v for k, v in os.environ.items() if not k.startswith(("NUMBA", "PYTHON", "XDG"))}
    done = subprocess.run(
        [sys.executable, "-c", SCRIPT],
        cwd=folder,
        env={**kept, "HOME": str(home), "LOCALAPPDATA": str(home), "PYTHONPATH": str(folder)},
        capture_output=True,
        text=True,
        timeout=300,
        check=True,
    )
    return done.stdout.split(maxsplit=1)


@pytest.mark.slow
def test_a_package_that_cannot_be_written_uses_the_cache_of_the_user(tmp_path):
    package = tmp_path / "site"
    shutil.copytree(
        ROOT / "engine", package / "engine", ignore=shutil.ignore_patterns("__pycache__")
    )
    # a file where the cache folder would be: as good as read-only, also for an administrator
    (package / "engine" / "stepping" / "__pycache__").write_text("not a folder")
    home = tmp_path / "home"
    home.mkdir()
    before, place = _run(package, home)
    assert before == "False"
    assert Path(place.strip()).is_relative_to(home)
    assert list(Path(place.strip()).glob("*turning_points*.nbi"))
    assert _run(package, home)[0] == "True"
