"""The banner of sheet Summary in a real spreadsheet program, and the same words in the JSON."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from made_up_run import SOURCE, STAMP, made_up_run
from openpyxl.utils import range_boundaries

from addin.contract.banner import headline
from addin.contract.sheets import SUMMARY_NOTES
from addin.writing.workbook import write_results
from tests.opened import opened

P, A, W = "pass", "accepted by forced response", "pass within its error"
F, I, N, U = "fail", "incomplete", "not judged", "unbounded"


@pytest.mark.parametrize(
    ("verdicts", "notes", "words"),
    [
        ((P, P, P), 0, "PASS: all 3 checks"),
        pytest.param((P, A), 1, "ACCEPTED (margin by forced response): all 2 checks, 1 note",
                     marks=pytest.mark.slow),
        pytest.param((P, A, W), SUMMARY_NOTES + 1,
                     f"PASS WITHIN ITS ERROR: 1 of 3 checks, {SUMMARY_NOTES + 1} notes",
                     marks=pytest.mark.slow),
        pytest.param((P, A, W, I, N), SUMMARY_NOTES,
                     "INCOMPLETE: 2 of 5 checks not judged, or only in part, "
                     f"{SUMMARY_NOTES} notes",
                     marks=pytest.mark.slow),
        pytest.param((P, F), 1, "CHECK THE INPUTS: start of 0.03 s, 1 note",
                     marks=pytest.mark.slow),
        pytest.param((P, F, U, N), 2, "FAIL: 2 of 4 checks, 2 notes", marks=pytest.mark.slow),
    ],
)  # fmt: skip
def test_banner_and_headline_say_the_same(
    verdicts: tuple[str, ...], notes: int, words: str, tmp_path: Path, soffice: Any
) -> None:
    run = made_up_run()
    checks = [{"check": f"Check {k}", "verdict": word} for k, word in enumerate(verdicts)]
    gross = words.removeprefix("CHECK THE INPUTS: ").removesuffix(", 1 note")
    word = "check the inputs" if words.startswith("CHECK") else "of no matter"
    overall = {"check": "Overall", "verdict": word, "where": gross}
    audit = [{"item": f"Warning {k + 1}", "value": f"Note {k + 1}."} for k in range(notes)]
    tables = {**run.tables, "Verdicts": [overall, *checks], "Audit": audit}
    write_results(SOURCE, tmp_path / "out.xlsx", replace(run, tables=tables), STAMP)
    sheet = opened(soffice.convert(tmp_path / "out.xlsx", outdir=tmp_path / "seen"))["Summary"]
    assert sheet["B9"].value == headline(overall, verdicts, notes) == words
    shown = [f"Note {k + 1}." for k in range(notes)] or ["None."]
    if notes > SUMMARY_NOTES:  # the last line says how many are left
        left = notes - (SUMMARY_NOTES - 1)
        shown = [*shown[: SUMMARY_NOTES - 1], f"And {left} more notes: see sheet Audit."]
    assert notes_of(sheet) == shown


def notes_of(sheet: Any) -> list[str]:
    """What stands below the caption Notes, down to the part with the verdicts."""
    (caption,) = (cell for row in sheet.iter_rows() for cell in row if cell.value == "Notes")
    end = range_boundaries(sheet.tables["Verdicts"].ref)[1]
    assert caption.row < end
    below = (sheet.cell(row, caption.column).value for row in range(caption.row + 1, end - 1))
    return [value for value in below if value]
