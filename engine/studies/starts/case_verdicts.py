"""The case with every condition of `StartConditions`: the checks of each, and the worst over all.

A condition of kind start goes through the whole run of the changed case, as if that were typed as the main case;
what a standard asks for beyond the checks is asked of the main case alone. One of kind steady has the checks of
continuous operation, one with an event those of the event.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

from engine.backlash.operating_events import operating_events
from engine.case.case import Case
from engine.case.data import CaseData
from engine.case.result_words import Judgement
from engine.errors import TorsionError
from engine.results.implausible_results import implausible_results
from engine.results.results import CaseVerdict, Results, Verdict
from engine.results.verdicts import (
    checks_of,
    event_checks,
    speed_checks,
    verdicts_of,
    with_overall,
)
from engine.run import at_speed, run
from engine.start.pieces import analysis_for_start
from engine.start.start import Start
from engine.studies.starts.condition_result import (
    NOT_CALCULATED,
    ConditionResult,
    event_row,
    start_row,
)
from engine.studies.starts.conditions import StartCondition, condition_case, typed_conditions


def run_with_conditions(case: CaseData, on_stage: Callable[[str], None] | None = None) -> Results:
    """What `engine.run.run` answers, with the verdicts of every typed condition, the worst of which governs.

    Parameters
    ----------
    case : CaseData
        A checked case. [SI]
    on_stage : callable, optional
        Called with the name of each analysis, and of each condition, as it begins.

    Returns
    -------
    Results
        Complete; without typed conditions those of `run`. [SI]
    """
    results = run(case, on_stage)
    conditions = typed_conditions(case)
    if not conditions:
        return results
    rows: list[CaseVerdict] = []
    notes: dict[str, list[str]] = {}
    for number, condition in enumerate(conditions, start=1):
        if on_stage is not None:
            on_stage(f"condition {number} of {len(conditions)}")
        checks, note = _checked(case, condition, results)
        rows += (CaseVerdict(**vars(check), condition=condition.name) for check in checks)
        if note:
            notes.setdefault(note, []).append(f"'{condition.name}'")
    results = replace(results, case_verdicts=tuple(rows))
    said = (
        f"Condition{'s' if len(names) > 1 else ''} {', '.join(names)}: {note}"
        for note, names in notes.items()
    )
    return replace(results, verdicts=verdicts_of(results), warnings=(*results.warnings, *said))


def _checked(
    case: CaseData, condition: StartCondition, main: Results
) -> tuple[Sequence[Verdict], str]:
    """The checks of one condition, the overall one first, and what a reader must know of its run."""
    try:
        changed = Case(**vars(condition_case(case, condition)))
        if condition.steady:
            return with_overall(speed_checks(at_speed(changed))), ""
        if condition.event:
            events = operating_events(changed, analysis_for_start(changed))
            row = event_row(case, condition, events[0])
            checks = list(event_checks(changed, events))
            note = _note(row, events[0].response, main.warnings)
            return with_overall(checks), "" if row.outcome == NOT_CALCULATED else note
        results = main if _is_main(case, changed) else run(changed)
    except TorsionError as error:
        return (
            Verdict(
                "Overall", None, None, "text", Judgement.INCOMPLETE, f"not calculated: {error}"
            ),
        ), ""
    implausible = "; ".join(one.finding for one in implausible_results(results))
    judged = with_overall(checks_of(results), implausible)
    if results.start is None:
        return judged, ""
    return judged, _note(start_row(case, condition, results), results.start, main.warnings)


def _note(row: ConditionResult, start: Start | None, known: Sequence[str]) -> str:
    """What a reader must know of a run, beside the notes of the case.

    That nothing bounds what is left out stands beside each check.
    """
    unbounded = start is None or (start.left_out is None and not start.is_sensitive)
    remarks = (remark for remark in row.remarks if remark not in known)
    return " ".join((*remarks, "" if unbounded else row.accuracy)).strip()


def _is_main(case: CaseData, changed: Case) -> bool:
    """Whether a condition changes nothing, so that the run of the case itself is its own."""
    plain = replace(CaseData(**vars(case)), start_conditions=(), voltage=case.voltage or 1.0)
    return not case.event_names and CaseData(**vars(changed)) == plain
