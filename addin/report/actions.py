"""Conclusions that name an action: what each verdict calls for, what calculations of changed trains found.

Only what was calculated is claimed: couplings that keep every margin by modes calculated for this document, the
best combination of a tuning study, runs of a sensitivity study. What a slope predicts beyond them is called so.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping
from typing import Any

from addin.recorded.studies import RecordedStudy
from addin.report.numbers import clean, fixed, number_in, significant
from addin.report.subject import Subject
from engine.case.missing_inputs import missing_inputs
from engine.case.result_words import Judgement
from engine.studies.coupling_stiffness import (
    FACTORS,
    ChangedCouplings,
    ChangedStiffness,
    changed_couplings,
)

Row = Mapping[str, Any]

#: Quantities of a sensitivity study that are named, and the farthest that its slope is followed. [count, 1]
_QUANTITIES, _FOLLOWED = 3, 1.35
#: A quantity that no one can choose by so many per cent.
_OF_MATERIAL = "S-N line"
#: What a check that fails calls for, by how its name begins; the first that fits.
_CALLS_FOR = (
    (
        ("Steady-state stress", "Vibratory torque"),
        "Move the mode away from that excitation, add damping, or lower the excitation to {share}: the "
        "response is proportional to it.",
    ),
    (
        "Peak torque",
        "Ask the maker for a peak rating of at least {result}, or lower what causes it.",
    ),
    ("Shear yield", "Take a material with a higher yield or a larger diameter, or lower the torque."),
    (
        "Torque reversal",
        "Ask the maker whether it bears such reversals, or lower the pulsating torque.",
    ),
    (
        "Allowable starts",
        "Without a change no more than {result} such starts in a life; else lower the stress of this shaft: "
        "diameter, notch, coupling.",
    ),
    ("Life of starts", "Allow fewer starts and events in a life, or lower their stress."),
    ("Start", "Raise the torque or the voltage of the motor, or unload the driven machine."),
)  # fmt: skip


def actions(subject: Subject) -> Iterator[str]:
    """What to change, to ask and to state, as sentences."""
    yield from _of_couplings(subject)
    for study in subject.recorded:
        if not study.outdated and study.key in _OF_STUDIES:
            yield from _OF_STUDIES[study.key](subject, study)
    for row in subject.rows("Verdicts"):
        yield from _of_check(subject, row)
    for sentence in missing_inputs(subject.calculation.case):
        yield re.sub(r"\bType\b", "State", clean(sentence))


def has_other_designs(subject: Subject) -> bool:
    """Whether a tuning study of these inputs stands in the workbook."""
    return any(study.key == "tuning" and not study.outdated for study in subject.recorded)


# --- couplings ------------------------------------------------------------------------------------


def _of_couplings(subject: Subject) -> Iterator[str]:
    calculation = subject.calculation
    if not calculation.results.margins.not_kept:
        return
    found = changed_couplings(calculation.case)
    for one in found:
        yield _keeping(subject, one) if one.keeps_all else _nearest(subject, one)
    if any(one.keeps_all for one in found):
        yield (
            "With these couplings frequencies and margins alone were calculated; response, start and fatigue "
            "remain to be calculated."
        )


def _keeping(subject: Subject, found: ChangedCouplings) -> str:
    verdicts = {row.verdict for row in subject.calculation.results.margins.not_kept}
    lead = (
        "Response accepted; to keep the margins too, " if verdicts == {Judgement.ACCEPTED} else ""
    )
    words = f"{lead}{_change(subject, found)}: every separation margin is kept, {_least(subject, found)}."
    return words[0].upper() + words[1:]


def _nearest(subject: Subject, found: ChangedCouplings) -> str:
    return (
        f"Of {fixed(min(FACTORS), 2)} to {fixed(max(FACTORS), 0)} times its stiffness no multiple tried of one "
        f"coupling, or of two, keeps every separation margin. The nearest: {_change(subject, found)}; "
        f"{_least(subject, found)}. Change inertias or shafts as well."
    )


def _change(subject: Subject, found: ChangedCouplings) -> str:
    """``soften A to 2 kN m/rad (0.5 × as typed) and B to ...``"""
    words, before = [], ""
    for change in found.changes:
        verb = "soften" if change.factor < 1.0 else "stiffen"
        words.append(f"{verb} {_one(subject, change)}" if verb != before else _one(subject, change))
        before = verb
    return " and ".join(words)


def _one(subject: Subject, change: ChangedStiffness) -> str:
    place = ("Elements", "Stiffness")
    shown = significant(subject.value(change.stiffness, *place), 4)
    return (
        f"{clean(change.element)} to {shown} {subject.unit(*place)} ({change.factor:g} × as typed)"
    )


def _least(subject: Subject, found: ChangedCouplings) -> str:
    worst, place = found.worst, ("NaturalFrequencies", "Frequency")
    frequency = fixed(subject.value(worst.mode_frequency, *place), 2)
    return (
        f"the least {fixed(100.0 * worst.margin, 1)} % of mode {worst.mode} ({frequency} "
        f"{subject.unit(*place)}) from {clean(worst.excitation)}"
    )


# --- studies --------------------------------------------------------------------------------------


def _of_tuning(subject: Subject, study: RecordedStudy) -> Iterator[str]:
    rows = study.tables.get("TuningResults", ())
    best = next((row for row in rows if row.get("Rank") == 1), None)
    if best is None:
        return
    if best.get("As is") is True:
        yield f"None of the other {len(rows) - 1} combinations calculated is better than the train as it is."
        return
    place = ("TuningResults", "Mode 1")
    modes = [value for k in (1, 2, 3) if (value := number_in(best, f"Mode {k}")) is not None]
    broken = number_in(best, "Limits broken")
    parts = [
        f"verdict {best.get('Verdict')}",
        f"{broken:.0f} limits broken" if broken else "no limit broken",
    ]
    if modes:
        shown = ", ".join(fixed(subject.value(mode, *place), 2) for mode in modes)
        parts.append(f"modes at {shown} {subject.unit(*place)}")
    if (margin := number_in(best, "Worst margin")) is not None:
        parts.append(f"least margin {fixed(100.0 * margin, 1)} %")
    if (starts := _starts(best)) and (
        now := next((r for r in rows if r.get("As is") is True), None)
    ):
        parts.append(f"allowable starts {starts} (unchanged: {_starts(now)})")
    yield (
        f"Best of {len(rows)} combinations calculated: {clean(str(best['Combination']))}: {', '.join(parts)}."
    )


def _starts(row: Row) -> str:
    number = number_in(row, "Allowable starts")
    if number is None:
        return clean(str(row.get("Allowable starts") or ""))
    return f"{int(number * (1.0 + 1e-9)):,}"


def _of_sensitivities(subject: Subject, study: RecordedStudy) -> Iterator[str]:
    """Quantities that raise the allowable starts most, from the runs at ± 1 %."""
    starts = subject.calculation.results.starts
    required = subject.calculation.case.starts_required
    now = None if starts is None else starts.judged_starts
    if not now or not required or now >= required:
        return
    runs = [run for row in study.tables.get("Sensitivities", ()) if (run := _better_run(row))]
    runs.sort(key=lambda run: -run[1])
    best = runs[:_QUANTITIES]
    if not best:
        return
    told = "; ".join(
        f"{_quantity(row)} {'+' if step > 0.0 else '−'} 1 %: {fixed(100.0 * gain, 1)} % more"
        for step, gain, row in best
    )
    yield f"Allowable starts, calculated with one quantity changed: {told}."
    step, gain, row = next((run for run in best if _OF_MATERIAL not in _quantity(run[2])), best[0])
    factor = (1.0 + step) ** (math.log(required / now) / math.log1p(gain))
    if 1.0 / _FOLLOWED < factor < _FOLLOWED:
        yield (
            f"By the slope of that run {required:,.0f} starts need the {_quantity(row)} at about "
            f"{fixed(100.0 * factor, 0)} %: a linear prediction in logarithms, not calculated."
        )


def _better_run(row: Row) -> tuple[float, float, Row] | None:
    """Of the runs at − 1 % and + 1 % the one with more starts: its step and what it gains; None where neither has. [1]"""
    runs = ((-0.01, number_in(row, "Starts below")), (0.01, number_in(row, "Starts above")))
    gains = [(step, gain, row) for step, gain in runs if gain is not None and gain > 0.0]
    return max(gains, key=lambda run: run[1], default=None)


def _quantity(row: Row) -> str:
    of = clean(str(row.get("Of") or ""))
    return f"{clean(str(row.get('Quantity') or ''))}{' of ' if of else ''}{of}"


_OF_STUDIES = {"tuning": _of_tuning, "sensitivities": _of_sensitivities}


# --- checks ---------------------------------------------------------------------------------------


def _of_check(subject: Subject, row: Row) -> Iterator[str]:
    """What a check that fails calls for."""
    name = clean(str(row["check"]))
    call = next((words for begin, words in _CALLS_FOR if name.startswith(begin)), "")
    if not call or row["verdict"] != Judgement.FAIL:
        return
    cells = subject.cells("Verdicts", row, ("Check", "Result", "Limit"))
    result, limit = cells.get("Result", ""), cells.get("Limit", "")
    where = clean(str(row.get("where") or "")).rstrip(".")
    if isinstance(row["result"], float | int):
        where = re.split("[:;]", where)[0]  # what else it says stands in the table
    factor = row.get("safety_factor")
    share = "" if not factor else f"{math.floor(100.0 * factor + 1e-9)} % of what it is"
    is_least = name.startswith(("Start", "Allowable starts"))
    found = f"{result}{f' ({where})' if where else ''}"
    bound = f", {limit} {'required' if is_least else 'allowed'}" if limit else ""
    yield f"{name}: {found}{bound}. {call.format(share=share or 'less', result=result)}"
