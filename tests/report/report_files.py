"""Reports made as a user makes them, and what stands in them by independent readers."""

from __future__ import annotations

import contextlib
import json
import os
import shutil
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import docx
import pytest
from click.testing import Result
from typer.testing import CliRunner

from addin.cli.app import app

ROOT = Path(__file__).resolve().parents[2]
#: 2026-01-02 03:04:05 UTC.
EPOCH = "1767323045"


def torsionbook(*words: object, cwd: Path) -> Result:
    """A command in this process, which is quicker, with the date fixed."""
    settings = {"COLUMNS": "140", "SOURCE_DATE_EPOCH": EPOCH}
    with contextlib.chdir(cwd):
        return CliRunner().invoke(app, [*map(str, words)], env=settings)


def in_its_own_process(*words: object, cwd: Path) -> subprocess.CompletedProcess[str]:
    """The command line as a user runs it, with the date fixed."""
    settings = {"PYTHONPATH": str(ROOT), "PYTHONIOENCODING": "utf-8", "COLUMNS": "140"}
    return subprocess.run(
        [sys.executable, "-m", "addin.cli", *map(str, words)],
        cwd=cwd,
        capture_output=True,
        text=True,
        encoding="utf-8",
        env={**os.environ, **settings, "SOURCE_DATE_EPOCH": EPOCH},
        timeout=300,
    )


def pdf_text(path: Path, *options: str) -> str:
    """The text of a PDF, read by poppler; without it the test is skipped."""
    if shutil.which("pdftotext") is None:
        pytest.skip("poppler's pdftotext is not installed")
    return subprocess.run(
        ["pdftotext", *options, str(path), "-"],
        capture_output=True,
        text=True,
        encoding="utf-8",
        check=True,
        timeout=60,
    ).stdout


def flat(text: str) -> str:
    """Text without line breaks and places to break."""
    return " ".join(text.replace("\u200b", "").split())


def docx_text(path: Path) -> str:
    """Every run of a .docx in reading order, tables and heads too."""
    file = docx.Document(str(path))
    parts = [file.element.body, file.sections[0].header._element, file.sections[0].footer._element]
    tag = "{http://schemas.openxmlformats.org/wordprocessingml/2006/main}"
    words = []
    for part in parts:
        for paragraph in part.iter(f"{tag}p"):
            words.append("".join(t.text or "" for t in paragraph.iter(f"{tag}t")))
    return flat("\n".join(words))


@dataclass(frozen=True)
class Made:
    """One report in both forms, and the results that `recalc` calculates of the same file."""

    pdf: Path
    docx: Path
    results: dict
    printed: str


def make(folder: Path, source: Path, results: Path) -> Made:
    """A report of a file whose results are already in a JSON."""
    done = torsionbook("report", source, "--pdf", "r.pdf", "--docx", "r.docx", cwd=folder)
    assert done.exit_code == 0, done.stderr
    found = json.loads(results.read_text(encoding="utf-8"))
    return Made(folder / "r.pdf", folder / "r.docx", found, done.stdout)
