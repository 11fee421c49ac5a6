"""The start matrix and its damage ledger as a study; see `engine.studies.starts.matrix`, `engine.studies.starts.damage_ledger`."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from addin.contract.studies.starts import STARTS as STARTS_SPEC
from addin.contract.study_spec import CUT_SHORT
from addin.studies.study import CutShort, Option, Study, StudyResult, StudyTask, TerminalTable
from addin.workers.parallel_map import Cancelled
from engine.case.case import Case
from engine.case.study_inputs import StudyInputs
from engine.errors import Problem
from engine.fatigue.damage import starts_in_words
from engine.start.settings import has_start
from engine.studies.starts.condition_result import ConditionResult, calculate_condition
from engine.studies.starts.conditions import StartCondition
from engine.studies.starts.damage_ledger import damage_ledger, ledger_rows, remaining_rows
from engine.studies.starts.matrix import gather_matrix, start_rows, voltage_rows
from engine.studies.starts.plan import plan_matrix


def _one(unit: tuple[Case, StartCondition]) -> ConditionResult:
    """One start of the matrix: the unit of work. Side by side they take longer than alone (docs/floors.md)."""
    return calculate_condition(*unit)


def _calculate(task: StudyTask) -> StudyResult:
    case = task.case
    plan = plan_matrix(case, with_standard=bool(task.settings.get("standard")))
    number = len(plan.units)
    rows = task.map_until_cancelled(
        _one,
        [(case, condition) for condition in plan.units],
        lambda done: f"start {min(done + 1, number)} of {number}",
    )
    if not rows:
        raise Cancelled(why=f"None of {number} starts was calculated.")
    matrix = gather_matrix(case, plan, rows)
    ledger = damage_ledger(matrix)
    has_duty = any(row.condition.has_duty for row in matrix.rows)
    sentences = [matrix.sentence]
    if has_duty or not matrix.judged_shafts:
        sentences.append(ledger.sentence)
    else:
        sentences.append(
            "No duty in table StartConditions: the damage ledger is empty. Type Per year and So far."
        )
    return StudyResult(
        result=(matrix, ledger),
        tables={
            "StartsByVoltage": voltage_rows(matrix),
            "StartMatrix": start_rows(matrix),
            "DamageLedger": ledger_rows(ledger),
            "RemainingStarts": remaining_rows(ledger),
        },
        sentence=" ".join(sentences),
        digest=matrix.study_sha256,
        warnings=matrix.notes,
        details={
            "standard": matrix.standard,
            "starts_factor": matrix.starts_factor,
            "assumption": ledger.assumption,
            "verdict": ledger.verdict,
        },
        cut_short=None if matrix.complete else _cut_short(len(rows), number, has_duty),
    )


def _cut_short(calculated: int, planned: int, has_duty: bool) -> CutShort:
    sentence = (
        f"{CUT_SHORT}: {calculated} of {planned} starts were calculated; the others are marked "
        "'not calculated'."
    )
    if has_duty:
        sentence += " The life used by a duty is shown only if all its starts were calculated."
    return CutShort(calculated, planned, sentence)


def _terminal(study: StudyResult, options: Mapping[str, Any]) -> Iterator[TerminalTable]:
    """The start matrix, one row per start."""
    headers = ("Time (s)", "Peak (× rated)", "Allowable starts", "Governing")
    rows = []
    for row in study.result[0].rows:
        starts = "not judged" if not row.judged else "unlimited"
        if row.allowable_starts is not None:
            starts = starts_in_words(row.allowable_starts)
        time = "–" if row.time is None else f"{row.time:.2f}"
        peak = "–" if row.peak_over_rated is None else f"{row.peak_over_rated:.2f}"
        rows.append((row.condition.name, row.words, time, peak, starts, row.governing or "–"))
    yield TerminalTable(
        (("Condition", "name"), ("Outcome", "name"), *((header, "number") for header in headers)),
        rows,
    )


def _problems(case: Case, inputs: StudyInputs) -> tuple[Problem, ...]:
    """A matrix needs a start; the rows themselves are checked with the case."""
    if has_start(case):
        return ()
    words = (
        "the case has no rows in table MotorTorque, so there is no start whose voltage, load or "
        "trip speed could be changed. Give the motor's torque curve on sheet Torque and motor."
    )
    return (Problem("StartConditions", None, "", None, "a case with a motor torque curve", words),)


_HELP = """\
Calculate the start matrix and the damage ledger: starts at every voltage, and the life left under a duty.

Start conditions and how often each occurs are in table StartConditions of sheet Case; without
rows of starts: 80 to 110 % voltage, loaded and unloaded, and aborted starts. Writes sheets Start matrix and
Damage ledger.

Example: `torsionbook starts train.xlsx` writes train.out.xlsx."""


STARTS = Study(
    spec=STARTS_SPEC,
    check=_problems,
    takes_worst_phase=True,
    calculate=_calculate,
    help=_HELP,
    options=(
        Option(
            "standard", bool, False,
            "Also calculate the standard matrix; without rows in StartConditions it is always "
            "calculated.",
        ),
    ),
    terminal=_terminal,
)  # fmt: skip
