"""What accuracy costs in time: the study of one input, and its place in every workbook.

The study calculates a case again and again, by both methods and at several settings. Into a
workbook it writes table `AccuracyCost`, its chart and the sentences above it, and nothing else. Its
JSON is that of results, as its table is one of them. It measures times, so it runs in one process alone.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from addin.calculation.stages import COMPILING
from addin.contract.json_formats import RESULTS_FORMAT
from addin.contract.study_spec import StudySpec
from addin.studies.study import Found, Study

if TYPE_CHECKING:
    from addin.reading.typed_case import CaseInput
    from addin.workers.parallel_map import Spread
    from engine.case.case import Case
    from engine.case.study_inputs import StudyInputs
    from engine.errors import Problem

__all__ = ["ACCURACY", "QUICK_ROUNDS", "ROUNDS"]

#: How often each setting is timed; the median is shown.
ROUNDS, QUICK_ROUNDS = 5, 1


def _check(case: Case, inputs: StudyInputs, settings: Mapping[str, Any]) -> Sequence[Problem]:
    return ()


def _calculate(
    case: Case,
    inputs: StudyInputs,
    settings: Mapping[str, Any],
    spread: Spread,
    tell: Callable[[str], None],
) -> Found:
    from engine.case.study_inputs import study_digest
    from engine.results.tables import accuracy_cost
    from engine.stepping.compiling import is_compiled
    from engine.stepping.linear_loop import advance_start
    from engine.studies.accuracy.accuracy import accuracy_study

    if not is_compiled(advance_start):
        tell(COMPILING)
    found = accuracy_study(case, rounds=settings.get("rounds", ROUNDS), on_progress=tell)
    tables = {"AccuracyCost": list(accuracy_cost(found.rows))}
    return Found(found, tables, found.sentence, study_digest())


def _to_json(found: Found, read: CaseInput, warnings: tuple[str, ...]) -> dict[str, Any]:
    """A study as results JSON of the contract, with the key `accuracy`."""
    from addin.contract.version import product_version
    from addin.writing.results_json import table_rows
    from engine.case.data import case_digest

    return {
        "format": RESULTS_FORMAT,
        "case_sha256": case_digest(read.data),
        "version": product_version(),
        "warnings": list(warnings),
        "errors": [],
        "accuracy_cost": table_rows("AccuracyCost", found.tables["AccuracyCost"]),
        "accuracy": {"sentence": found.sentence, "reference": found.result.reference},
    }


def _write(
    read: CaseInput, destination: Path | None, found: Found, ignore_lock: bool
) -> tuple[str, ...]:
    """Write a study into the workbook it was read from; sentences the user should read."""
    from addin.calculation.audit import Stamp
    from addin.reading.workbook import WorkbookInput
    from addin.writing.workbook import RunStamp, write_study
    from engine.case.data import case_digest

    assert isinstance(read, WorkbookInput)
    made = Stamp.now()
    report = write_study(
        read.workbook,
        destination,
        found.tables["AccuracyCost"],
        {"sentence": found.sentence, "reference": found.result.reference},
        RunStamp(made.software, made.date, case_digest(read.data)),
        read.data.ratings.rated_torque,
        ignore_lock=ignore_lock,
    )
    return report.notes


#: The study of ``torsionbook accuracy``; its sheet is one of every workbook, made with studies or not.
ACCURACY = Study(
    spec=StudySpec("accuracy", 0, "accuracy", "Accuracy", "P", (), (), ()),
    check=_check,
    calculate=_calculate,
    write=_write,
    as_json=_to_json,
)
