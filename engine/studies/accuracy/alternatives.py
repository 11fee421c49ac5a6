"""What every other approximation of a start is worth and costs: effects, modes and pieces of shafts.

The step is studied by itself (`engine.studies.accuracy.accuracy`). Here the start of the plan is
calculated again with one thing different each time: an effect put in or left out, all modes, twice the
pieces of distributed shafts. The change of the answers is what that thing is worth in this case.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial

from engine.case.case import Case
from engine.case.data import CaseData, EffectChoiceRow
from engine.case.defaults import DEFAULT_TOLERANCE_PEAK
from engine.case.effects import EFFECTS
from engine.errors import TorsionError
from engine.model.modal_analysis import ModalAnalysis, analyse
from engine.results.results import AccuracyRow
from engine.run import PlannedStart, planned_start
from engine.start.start import Start
from engine.start.start_fatigue import starts_of
from engine.studies.accuracy.answers import Answers, answers_of, errors_between, timed_runs

#: Methods of the rows: the start as it is calculated, and what else could be.
CHOSEN, ALTERNATIVE = "chosen", "alternative"
#: Effects that are a matter of accuracy, not of what happens to the train.
PRICED = ("bearings", "coupled damping", "fast modes", "breaker closing", "backlash")


def alternatives(
    case: CaseData,
    analysis: ModalAnalysis,
    planned: PlannedStart,
    rounds: int,
    on_stage: Callable[[str], None],
) -> tuple[AccuracyRow, ...]:
    """The chosen start, and every alternative with its change of the answers and its time.

    Parameters
    ----------
    case : CaseData
        A checked case. [SI]
    analysis : ModalAnalysis
        Its modes. [SI]
    planned : PlannedStart
        Its start. [SI]
    rounds : int
        How often each is timed. [count]
    on_stage : callable
        Called with a word on what is being done. [words]

    Returns
    -------
    tuple of AccuracyRow
        The first is the start as it is calculated, its error as estimated, with what it leaves out and its
        ensemble. [1, s]
    """
    start = planned.start
    chosen = _answers(case, start)
    on_stage("the start as it is calculated")
    _, taken = timed_runs(lambda: planned_start(case, analysis), rounds)
    stated = start.estimated_error + (start.left_out or 0.0)
    setting = _described(start)
    if start.repeatability is not None:
        stated = max(stated, start.repeatability.spread)
    rows = [AccuracyRow(CHOSEN, setting, stated, _stated_of_starts(case, planned), taken)]
    for words, other, found in _others(case, analysis, planned):
        on_stage(words)
        try:
            changed, taken = timed_runs(partial(planned_start, other, found), rounds)
        except TorsionError:  # what cannot be simulated has no price
            continue
        peak, starts = errors_between(_answers(case, changed.start), chosen)
        rows.append(AccuracyRow(ALTERNATIVE, words, peak, starts, taken))
    return tuple(rows)


def price_sentence(case: CaseData, rows: tuple[AccuracyRow, ...]) -> str:
    """What each alternative would cost and change.

    Parameters
    ----------
    case : CaseData
        The case. [SI]
    rows : tuple of AccuracyRow
        As `alternatives` gives them. [1, s]

    Returns
    -------
    str
        One sentence. [sentence]
    """
    chosen, *others = rows
    small = 0.01 * (case.tolerance_peak or DEFAULT_TOLERANCE_PEAK)
    said = [f"The start as calculated ({chosen.setting}) takes {duration(chosen.time)}"]
    for row in others:
        worth = []
        for change, what in ((row.error_peak, "a peak"), (row.error_starts, "the starts")):
            if change is not None and change > small:
                worth.append(f"{what} by {100.0 * change:.2g} %")
        moved = f"change {' and '.join(worth)}" if worth else "change nothing"
        said.append(f"{row.setting} would take {duration(row.time)} and {moved}")
    return "; ".join(said) + "."


def duration(seconds: float) -> str:
    """In ms below a second, with two digits.

    Parameters
    ----------
    seconds : float
        A time. [s]

    Returns
    -------
    str
        With its unit. [words]
    """
    if seconds < 1.0:
        return f"{float(f'{1e3 * seconds:.2g}'):g} ms"
    return f"{float(f'{seconds:.2g}'):g} s"


def _described(start: Start) -> str:
    modes = f"{start.kept_modes} modes"
    if start.repeatability is not None:
        return f"{modes}, ensemble of {start.repeatability.runs} runs"
    return modes


def _stated_of_starts(case: CaseData, planned: PlannedStart) -> float | None:
    """Error of the starts as stated, with what is left out; None where none are limited."""
    starts, errors = starts_of(case, planned.start, planned.full)
    shafts = starts.shafts if starts is not None else ()
    stated = [
        error + (shaft.left_out or 0.0)
        for shaft, (_, error) in zip(shafts, errors, strict=True)
        if error is not None
    ]
    return max(stated, default=None)


def _others(
    case: CaseData, analysis: ModalAnalysis, planned: PlannedStart
) -> Iterator[tuple[str, Case, ModalAnalysis]]:
    """Words, case and modes of each alternative."""
    plan = planned.plan
    for name in PRICED:
        decision = plan.decision(name)
        given = EFFECTS[name].inputs is None or EFFECTS[name].inputs.given(case)  # type: ignore[union-attr]
        if name == "fast modes" and planned.start.kept_modes >= planned.model.modes.n_modes:
            continue
        if not given or (not decision.on and decision.bound == 0.0):
            continue
        choice = "off" if decision.on else "on"
        words = "all modes" if name == "fast modes" else f"{name} {choice}"
        yield words, _choosing(case, name, choice), analysis
    if analysis.rough_torsional is not None:
        most = max(pieces for _, pieces in analysis.subdivided.segments)
        yield "shafts in twice the pieces", _as_is(case), analyse(case, least_pieces=2 * most)


def _choosing(case: CaseData, name: str, choice: str) -> Case:
    others = tuple(row for row in case.effect_choices if row.effect != name)
    return replace(_as_is(case), effect_choices=(*others, EffectChoiceRow(name, choice)))


def _as_is(case: CaseData) -> Case:
    return Case(**vars(case))


def _answers(case: CaseData, start: Start) -> Answers:
    return answers_of(case, start.turning_of_element())
