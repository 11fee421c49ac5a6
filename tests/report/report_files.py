"""Reports made as a user makes them, and what stands in them by independent readers."""

from __future__ import annotations

import json
import shutil
import subprocess
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import command_line
import docx
import pytest

ROOT = Path(__file__).resolve().parents[2]
#: 2026-01-02 03:04:05 UTC.
EPOCH = "1767323045"
#: The command line, in this process or in one of its own, with the date fixed.
torsionbook = partial(command_line.torsionbook, SOURCE_DATE_EPOCH=EPOCH)
in_its_own_process = partial(command_line.torsionbook_process, SOURCE_DATE_EPOCH=EPOCH)


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
    assert done.returncode == 0, done.stderr
    found = json.loads(results.read_text(encoding="utf-8"))
    return Made(folder / "r.pdf", folder / "r.docx", found, done.stdout)
