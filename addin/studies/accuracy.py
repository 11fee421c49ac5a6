"""What accuracy costs in time: the study of one input, and its place in every workbook.

The study calculates a case again and again, by both methods and at several settings. Into a
workbook it writes table `AccuracyCost`, its chart and the sentences above it, and nothing else. Its
JSON is that of results, as its table is one of them. It measures times, so it runs in one process alone.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from addin.calculation.audit import Stamp
from addin.contract.json_formats import RESULTS_FORMAT
from addin.contract.study_spec import StudySpec
from addin.contract.version import product_version
from addin.reading.typed_case import CaseInput
from addin.reading.workbook import WorkbookInput
from addin.studies.study import Option, Study, StudyResult, StudyTask, TerminalTable
from addin.writing.results_json import table_rows
from addin.writing.workbook import RunStamp, write_study
from engine.case.data import case_digest
from engine.case.study_inputs import study_digest
from engine.results.tables import accuracy_cost
from engine.studies.accuracy.accuracy import accuracy_study

#: How often each setting is timed, and how often with --quick; the median is shown.
ROUNDS, QUICK_ROUNDS = 5, 1


def _calculate(task: StudyTask) -> StudyResult:
    study = accuracy_study(
        task.case,
        rounds=QUICK_ROUNDS if task.settings.get("quick") else ROUNDS,
        on_progress=task.tell,
    )
    tables = {"AccuracyCost": list(accuracy_cost(study.rows))}
    return StudyResult(
        study,
        tables,
        study.sentence,
        study_digest(),
        remarks=(f"Reference: {study.reference}",),
    )


def _to_json(study: StudyResult, read: CaseInput, warnings: tuple[str, ...]) -> dict[str, Any]:
    """A study as results JSON of the contract, with the key `accuracy`."""
    return {
        "format": RESULTS_FORMAT,
        "case_sha256": case_digest(read.data),
        "version": product_version(),
        "warnings": list(warnings),
        "errors": [],
        "accuracy_cost": table_rows("AccuracyCost", study.tables["AccuracyCost"]),
        "accuracy": {"sentence": study.sentence, "reference": study.result.reference},
    }


def _write(
    read: CaseInput, destination: Path | None, study: StudyResult, ignore_lock: bool
) -> tuple[str, ...]:
    """Write a study into the workbook it was read from; sentences the user should read."""
    assert isinstance(read, WorkbookInput)
    made = Stamp.now()
    report = write_study(
        read.workbook,
        destination,
        study.tables["AccuracyCost"],
        {"sentence": study.sentence, "reference": study.result.reference},
        RunStamp(made.software, made.date, case_digest(read.data)),
        read.data.ratings.rated_torque,
        ignore_lock=ignore_lock,
    )
    return report.notes


def _terminal(study: StudyResult, options: Mapping[str, Any]) -> Iterator[TerminalTable]:
    """Errors and time of each setting."""
    headers = ("Error peak (%)", "Error starts (%)", "Time (ms)")
    rows = []
    for row in study.result.rows:
        errors = [
            "–" if e is None else _decimal(100.0 * e) for e in (row.error_peak, row.error_starts)
        ]
        took = "–" if row.time is None else f"{1e3 * row.time:.3g}"
        rows.append((row.method, str(row.setting), *errors, took))
    yield TerminalTable(
        (("Method", "name"), ("Setting", "name"), *((header, "number") for header in headers)), rows
    )


def _decimal(value: float) -> str:
    """Two digits without powers of ten; what is smaller than a chart can show is a bound."""
    if 0.0 < value < 1e-7:
        return "< 0.0000001"
    digits = 1 if value == 0.0 else max(0, 1 - math.floor(math.log10(value)))
    return f"{value:.{digits}f}"


_HELP = """\
Measure error against computing time for this case.

Calculates the start by the exponential method and by Newmark at several steps or tolerances,
compares with a much more accurate reference, and writes sheet Effects and accuracy; other results are unchanged.

Example: `torsionbook accuracy train.xlsx` writes train.out.xlsx."""


#: The study of ``torsionbook accuracy``; its sheet is one of every workbook, made with studies or not.
ACCURACY = Study(
    spec=StudySpec("accuracy", 6, "accuracy", "Accuracy", (), (), ()),
    calculate=_calculate,
    write=_write,
    as_json=_to_json,
    help=_HELP,
    options=(
        Option("quick", bool, False, "Measure the time of each setting once instead of five times."),
    ),
    terminal=_terminal,
    measures_time=True,
)  # fmt: skip
