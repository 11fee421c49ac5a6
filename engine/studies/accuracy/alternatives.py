"""What every other approximation of a start is worth and costs: effects, modes and pieces of shafts.

The step is studied by itself (`engine.studies.accuracy.accuracy`). Here the start of the plan is
calculated again with one thing different each time: an effect put in or left out, all modes, fewer modes,
twice the pieces of distributed shafts. The change of the answers is what that thing is worth in this case.
Where runs part, what the further runs of the ensemble cost and the spread that they tell have a row.
Times are those of modes, plan and start together.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial

from engine.backlash.event_start import run_again
from engine.case.case import Case
from engine.case.data import CaseData, EffectChoiceRow
from engine.case.defaults import DEFAULT_TOLERANCE_PEAK
from engine.case.effects import EFFECTS
from engine.errors import TorsionError
from engine.model.modal_analysis import ModalAnalysis, analyse
from engine.model.subdivision import COARSEST
from engine.results.results import AccuracyRow
from engine.run import PlannedStart, planned_start
from engine.start.start import Start
from engine.start.start_fatigue import starts_of
from engine.studies.accuracy.answers import Answers, answers_of, errors_between, timed_runs

#: Methods of the rows: the start as it is calculated, the runs that tell its spread, what else could be.
CHOSEN, ENSEMBLE, ALTERNATIVE = "chosen", "ensemble", "alternative"
#: Share of the elastic modes that fewer modes are without. [1]
FEWER = 1.0 / 3.0
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
        ensemble; then what the ensemble costs and the spread it tells. [1, s]
    """
    start = planned.start
    chosen = _answers(case, start)
    setting = _described(start)
    on_stage("the start as it is calculated")
    _, taken = timed_runs(
        partial(_calculated, _Alternative(setting, _as_is(case), analysis)), rounds
    )
    stated = start.estimated_error + (start.left_out or 0.0)
    stated_of_starts = _stated_of_starts(case, planned)
    if start.repeatability is not None:
        stated = max(stated, start.repeatability.spread)
    rows = [AccuracyRow(CHOSEN, setting, stated, stated_of_starts, taken)]
    if start.repeatability is not None:
        further, spread = start.repeatability.further, start.repeatability.spread
        on_stage("the further runs of the ensemble")
        again = partial(
            run_again, case, planned.model, planned.plan.effects, planned.linear, further
        )
        _, taken = timed_runs(again, rounds)
        words = f"{len(further)} further runs"
        rows.append(AccuracyRow(ENSEMBLE, words, spread, stated_of_starts, taken))
    for other in _others(case, analysis, planned):
        on_stage(other.words)
        try:
            changed, taken = timed_runs(partial(_calculated, other), rounds)
        except TorsionError:  # what cannot be simulated has no price
            continue
        peak, starts = errors_between(_answers(case, changed.start), chosen)
        rows.append(AccuracyRow(ALTERNATIVE, other.words, peak, starts, taken))
    return tuple(rows)


@dataclass(frozen=True, eq=False)
class _Alternative:
    """A start with one thing different."""

    words: str
    case: Case
    analysis: ModalAnalysis  # of the start as it is calculated
    finer: int = 1  # how many times as many pieces of shafts
    most_modes: int | None = None


def _calculated(a: _Alternative) -> PlannedStart:
    """Modes, plan and start, as they are timed; modes that are not finer are those already found."""
    most = max((pieces for _, pieces in a.analysis.subdivided.segments), default=2 * COARSEST)
    found = analyse(a.case, least_pieces=a.finer * most)
    used = found if a.finer > 1 else a.analysis
    return planned_start(a.case, used, most_modes=a.most_modes, estimated=False)


def price_sentence(case: CaseData, rows: tuple[AccuracyRow, ...]) -> str:
    """What the start costs, and what would change most: one alternative, and one of its modes.

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
    chosen, others = rows[0], [row for row in rows if row.method == ALTERNATIVE]
    others.sort(key=lambda row: -max(row.error_peak or 0.0, row.error_starts or 0.0))
    of_modes = [row for row in others if "modes" in row.setting]
    named = list(dict.fromkeys([*others[:1], *of_modes[:1]]))
    small = 0.01 * (case.tolerance_peak or DEFAULT_TOLERANCE_PEAK)
    said = [f"The start as calculated ({chosen.setting}) takes {duration(chosen.time)}"]
    said[0] += "".join(
        f", {duration(row.time)} of it for the {row.setting}"
        for row in rows
        if row.method == ENSEMBLE
    )
    for row in named:
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
) -> Iterator[_Alternative]:
    """Each alternative."""
    plan, modes, kept = planned.plan, planned.model.modes, planned.start.kept_modes
    for name in PRICED:
        decision = plan.decision(name)
        given = EFFECTS[name].inputs is None or EFFECTS[name].inputs.given(case)  # type: ignore[union-attr]
        if name == "fast modes" and kept >= modes.n_modes:
            continue
        if not given or (not decision.on and decision.bound == 0.0):
            continue
        choice = "off" if decision.on else "on"
        words = "all modes" if name == "fast modes" else f"{name} {choice}"
        yield _Alternative(words, _choosing(case, name, choice), analysis)
    elastic = kept - modes.n_rigid
    if elastic > 1:  # one at least stays
        fewer = kept - max(1, round(FEWER * elastic))
        words = f"{fewer} modes instead of {kept}"
        yield _Alternative(words, _as_is(case), analysis, most_modes=fewer)
    if analysis.rough_torsional is not None:
        yield _Alternative("shafts in twice the pieces", _as_is(case), analysis, finer=2)


def _choosing(case: CaseData, name: str, choice: str) -> Case:
    others = tuple(row for row in case.effect_choices if row.effect != name)
    return replace(_as_is(case), effect_choices=(*others, EffectChoiceRow(name, choice)))


def _as_is(case: CaseData) -> Case:
    return Case(**vars(case))


def _answers(case: CaseData, start: Start) -> Answers:
    return answers_of(case, start.turning_of_element())
