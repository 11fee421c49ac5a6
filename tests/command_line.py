"""The command line in a test: in this process where only its words and files matter, or as a user runs it.

A Python process with the engine takes 0.8 s to start, hence the first wherever it will do.
"""

from __future__ import annotations

import contextlib
import os
import subprocess
import sys
from pathlib import Path

from typer.testing import CliRunner

ROOT = Path(__file__).resolve().parents[1]
#: Width of its tables, in characters.
WIDTH = {"COLUMNS": "140"}


def torsionbook(*words: object, cwd: Path, **variables: str) -> subprocess.CompletedProcess[str]:
    """Run the command line in this process, in a folder, with further environment variables."""
    from addin.cli.app import app

    typed = list(map(str, words))
    with contextlib.chdir(cwd):
        done = CliRunner(env=WIDTH | variables).invoke(app, typed)
    if done.exception is not None and not isinstance(done.exception, SystemExit):
        raise done.exception
    return subprocess.CompletedProcess(typed, done.exit_code, done.stdout, done.stderr)


def command(*words: object) -> list[str]:
    """What is typed into a terminal."""
    return [sys.executable, "-m", "addin.cli", *map(str, words)]


def environment() -> dict[str, str]:
    """Variables of a process that is to find this checkout."""
    return {**os.environ, **WIDTH, "PYTHONPATH": str(ROOT), "PYTHONIOENCODING": "utf-8"}


def torsionbook_process(
    *words: object, cwd: Path, **variables: str
) -> subprocess.CompletedProcess[str]:
    """Run the command line as a user does, in a process of its own."""
    return subprocess.run(
        command(*words),
        cwd=cwd,
        capture_output=True,
        text=True,
        encoding="utf-8",
        env=environment() | variables,
        timeout=600,
    )
