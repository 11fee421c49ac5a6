"""What accuracy costs in time, for one case: error of the answers against processor time.

The start is calculated at fixed settings without refinement, by the exponential step and by the
paper's average acceleration (Newmark), and compared with the exponential step at a quarter of its
finest step: at fourth order 256 times finer. A second reference at twice that step shows how far
the first can be trusted. A start with clearances or other events is calculated to a range of wanted
tolerances instead, against one a hundred times finer; Newmark has no events and is then studied on
the linear train. Prescribed torques without clearances are exact at their samples: there is nothing
to study.

Error of the peaks: largest change of a maximum or minimum over the larger of the two, over all
elements. Error of the starts: largest relative change of the allowable starts of a judged shaft;
1 where one of the two is unlimited. Times are medians of repeated runs in this process, from the
model in arrays to peaks and starts.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from engine.case.choices import Method
from engine.case.data import CaseData
from engine.case.defaults import DEFAULT_TOLERANCE_PEAK, DEFAULT_TOLERANCE_STARTS
from engine.model.load import loads_of
from engine.model.motor import motors_of
from engine.results.results import AccuracyRow
from engine.run import PlannedStart, calculate_start, planned_start
from engine.start.pieces import analysis_for_start
from engine.start.settings import has_start
from engine.start.simulation import simulate
from engine.start.start import Start
from engine.start.start_model import MAX_VALUES, StartModel, start_model
from engine.start.trajectory import turning_of
from engine.studies.accuracy.alternatives import alternatives, duration, price_sentence
from engine.studies.accuracy.answers import (
    Answers,
    Histories,
    answers_of,
    errors_between,
    timed_runs,
)

#: Settings of each method, each at half the step of the one before.
SETTINGS = 6
#: Finest phase of the pulsation per step of each method. [rad]
FINEST_EXPONENTIAL, FINEST_NEWMARK = 0.125, 0.025
#: The references' steps over the finest of the exponential method: the reference, its check.
REFERENCE, CHECK = 0.25, 0.5
#: Wanted tolerances of a start with events; those of reference and check over the finest of them.
EVENT_TOLERANCES = (3e-2, 1e-2, 3e-3, 1e-3, 3e-4)
EVENT_REFERENCE, EVENT_CHECK = 0.01, 0.1
#: Modes are kept for this share of the wanted tolerance, for the reference a tenth of it.
MODES_TOLERANCE = 0.1
#: How often an alternative is timed, at the most: each is a whole start with its plan.
PRICED_ROUNDS = 3
#: Names of the methods in the table.
EXPONENTIAL = "exponential"
EVENTS, NEWMARK_LINEAR = "exponential with events", "newmark (linear train)"


@dataclass(frozen=True)
class AccuracyStudy:
    """Error against processor time of one case."""

    #: From coarse to fine, method by method; empty where there is nothing to study. [1, s]
    rows: tuple[AccuracyRow, ...]
    sentence: str  #: What the wanted accuracy costs.
    reference: str  #: What was compared with, and how times were taken.
    reference_error_peak: float | None = None  #: Difference of the two references. [1]
    reference_error_starts: float | None = None  #: Likewise. [1]


def accuracy_study(
    case: CaseData, *, rounds: int = 5, on_progress: Callable[[str], None] | None = None
) -> AccuracyStudy:
    """Error of peak torques and allowable starts against processor time, for this very case.

    Parameters
    ----------
    case : CaseData
        A checked case. [SI]
    rounds : int, optional
        How often each setting is timed. [count]
    on_progress : callable, optional
        Called with a word on what is being done. [words]

    Returns
    -------
    AccuracyStudy
        Rows and sentences; without rows where no step decides the accuracy. [1, s]
    """
    on_stage = on_progress or (lambda words: None)

    @contextmanager
    def stage(words: str) -> Iterator[None]:
        on_stage(words)
        yield

    if not has_start(case) and not case.torque_time_from_rest:
        return _nothing(case)
    on_stage("start with the effects of the plan")
    analysis = analysis_for_start(case)
    planned = planned_start(case, analysis, stage, estimated=False)
    if planned.plan.events:
        study = _event_study(case, planned, rounds, on_stage)
    elif has_start(case):
        study = _linear_study(case, planned, rounds, on_stage)
    else:
        return _nothing(case)
    priced = alternatives(case, analysis, planned, min(rounds, PRICED_ROUNDS), on_stage)
    return replace(
        study,
        rows=(*study.rows, *priced),
        sentence=f"{study.sentence} {price_sentence(case, priced)}",
    )


def _nothing(case: CaseData) -> AccuracyStudy:
    """No start, or prescribed torques alone."""
    if case.torque_time_from_rest:
        sentence = (
            "Nothing to study: the response to prescribed torques (TorqueTime) is exact at any "
            "time step. Only separating teeth make it depend on the step: give a clearance, or "
            "force backlash on."
        )
    else:
        sentence = "Nothing to study: the case has no motor torque curve, so there is no start."
    return AccuracyStudy((), sentence, "None.")


# --- linear starts --------------------------------------------------------------------------------


def _linear_study(
    case: CaseData, planned: PlannedStart, rounds: int, on_stage: Callable[[str], None]
) -> AccuracyStudy:
    """Both methods on the linear train."""
    ladder = _Ladder(case, planned)
    reference, off = ladder.references(on_stage)
    rows = [
        *ladder.rows(EXPONENTIAL, EXPONENTIAL, reference, rounds, on_stage),
        *ladder.rows(Method.NEWMARK, Method.NEWMARK, reference, rounds, on_stage),
    ]
    text = (
        "Compared with the exponential method at a step of "
        f"{REFERENCE * ladder.finest(EXPONENTIAL):.3g} s, whose error, of fourth order, is "
        f"{1.0 / REFERENCE**4:.0f} times smaller than that of the finest setting. "
        + _checked(off)
        + _timed(rounds)
    )
    sentence = _sentence(case, rows, EXPONENTIAL, Method.NEWMARK, "")
    return AccuracyStudy(tuple(rows), sentence, text, off[0], off[1])


class _Ladder:
    """Starts of one linear train at fixed steps, over the same time."""

    def __init__(self, case: CaseData, planned: PlannedStart) -> None:
        self.case, self.train = case, planned.model.train
        self.end = planned.linear.outcome.time
        self.outputs = planned.linear.output_of_element
        tolerance = MODES_TOLERANCE * (case.tolerance_peak or DEFAULT_TOLERANCE_PEAK)
        self.model = self._model(planned, tolerance)
        self.strict = self._model(planned, 0.1 * tolerance)

    def _model(self, planned: PlannedStart, tolerance: float) -> StartModel:
        m, effects = planned.model, replace(planned.plan.effects, clearances=())
        motors, loads = motors_of(self.case, m.train), loads_of(self.case, m.train)
        return start_model(self.case, m, motors, loads, tolerance, self.end, effects)

    def finest(self, method: str) -> float:
        """Finest step of a method that memory allows. [s]"""
        phase, share = (
            (FINEST_EXPONENTIAL, REFERENCE) if method == EXPONENTIAL else (FINEST_NEWMARK, 1.0)
        )
        affordable = float(self.end) * len(self.model.truncation) / MAX_VALUES / share
        step = min(phase / self.model.pulsation_omega, self.model.largest_step / 2**SETTINGS)
        return float(max(step, affordable))

    def histories(self, model: StartModel, step: float, method: str) -> Histories:
        """Turning points of every element, by the segment the planned start reports."""
        trajectory = simulate(model, step, method, math.inf, self.end)
        turning = turning_of(trajectory, min(self.end, float(trajectory.time[-1])))
        return {int(e): turning[self.outputs[e]] for e in np.flatnonzero(self.outputs >= 0)}

    def references(
        self, on_stage: Callable[[str], None]
    ) -> tuple[Answers, tuple[float, float | None]]:
        """The reference, and how far its check is from it."""
        starts = []
        for share in (REFERENCE, CHECK):
            step = share * self.finest(EXPONENTIAL)
            on_stage(f"reference at a step of {step:.2g} s")
            starts.append(answers_of(self.case, self.histories(self.strict, step, EXPONENTIAL)))
        return starts[0], errors_between(starts[1], starts[0])

    def rows(
        self, method: str, label: str, reference: Answers, rounds: int,
        on_stage: Callable[[str], None],
    ) -> Iterator[AccuracyRow]:  # fmt: skip
        """One a step, from coarse to fine."""
        for halving in range(SETTINGS - 1, -1, -1):
            step = 2.0**halving * self.finest(method)
            on_stage(f"{label} at a step of {step:.2g} s")

            def once(step: float = step) -> Answers:
                return answers_of(self.case, self.histories(self.model, step, method))

            answers, wall = timed_runs(once, rounds)
            peak, starts = errors_between(answers, reference)
            yield AccuracyRow(label, f"step {step:.3g} s", peak, starts, wall)


# --- starts with events ---------------------------------------------------------------------------


def _event_study(
    case: CaseData, planned: PlannedStart, rounds: int, on_stage: Callable[[str], None]
) -> AccuracyStudy:
    """The event-driven start at wanted tolerances, and Newmark on the linear train."""

    def at(tolerance: float) -> Start:
        tighter = replace(case, tolerance_peak=tolerance)
        return calculate_start(tighter, planned.model, planned.plan.effects, planned.linear)

    def answers_at(tolerance: float) -> Answers:
        return answers_of(case, at(tolerance).turning_of_element())

    finest = EVENT_TOLERANCES[-1]
    on_stage("references with events")
    best, check = at(EVENT_REFERENCE * finest), at(EVENT_CHECK * finest)
    reference = answers_of(case, best.turning_of_element())
    off = errors_between(answers_of(case, check.turning_of_element()), reference)
    rows = []
    for tolerance in EVENT_TOLERANCES:
        on_stage(f"start with events to {tolerance:.2g}")
        answers, wall = timed_runs(partial(answers_at, tolerance), rounds)
        peak, starts = errors_between(answers, reference)
        rows.append(AccuracyRow(EVENTS, f"tolerance {tolerance:.2g}", peak, starts, wall))
    if has_start(case):
        ladder = _Ladder(case, planned)
        linear, _ = ladder.references(on_stage)
        rows += ladder.rows(Method.NEWMARK, NEWMARK_LINEAR, linear, rounds, on_stage)
        papers = (
            "Newmark cannot simulate events: it is compared on the linear train, with the linear "
            "reference. "
        )
    else:
        papers = (
            "Newmark cannot simulate events, and this start has no motor curve: Newmark is not "
            "studied. "
        )
    text = (
        "Starts with events are compared with a start calculated to a tolerance of "
        f"{EVENT_REFERENCE * finest:.2g}, {1.0 / EVENT_REFERENCE:.0f} times finer than the "
        "finest setting"
    )
    if best.step < check.step:
        text += ". " + _checked(off)
    else:
        text += f", as far as a step of {best.step:.2g} s allows. "
    text += papers + _timed(rounds)
    sentence = _sentence(case, rows, EVENTS, NEWMARK_LINEAR, " (without clearances and events)")
    felt = planned.start.repeatability
    if felt is not None and felt.sensitive:
        sentence = (
            "This start is sensitive: at any setting a change of the input by 1e-9 may change a peak "
            f"torque by {100.0 * felt.spread:.2g} %. {sentence}"
        )
    return AccuracyStudy(tuple(rows), sentence, text, off[0], off[1])


# --- words ----------------------------------------------------------------------------------------


def _checked(off: tuple[float, float | None]) -> str:
    starts = "" if off[1] is None else f" and {off[1]:.1g} on starts"
    return f"A second, coarser reference differs by {off[0]:.1g} on peaks{starts}. "


def _timed(rounds: int) -> str:
    runs = f"medians of {rounds} runs" if rounds > 1 else "of a single run"
    return (
        f"Times are processor times, {runs} in this process, on this machine, from model to peaks and "
        "starts. Those of rows chosen and alternative include modal analysis and plan."
    )


def _sentence(
    case: CaseData, rows: list[AccuracyRow], ours: str, papers: str, papers_note: str
) -> str:
    """What was asked for, ten times better, and the paper's method: each with its cost."""
    on_starts = any(r.error_starts is not None for r in rows if r.method == ours)
    wanted = (
        case.tolerance_starts or DEFAULT_TOLERANCE_STARTS
        if on_starts
        else case.tolerance_peak or DEFAULT_TOLERANCE_PEAK
    )
    answer = "starts" if on_starts else "peak torques"
    at = f"{100.0 * wanted:.3g} %"
    return (
        f"Wanted accuracy of {at} on {answer}: {_cost(rows, ours, wanted, on_starts)}; "
        f"{10.0 * wanted:.3g} % would take {_cost(rows, ours, 0.1 * wanted, on_starts)}"
        + (
            f"; Newmark at {at} takes {_cost(rows, papers, wanted, on_starts)}{papers_note}."
            if any(r.method == papers for r in rows)
            else "."
        )
    )


def _cost(rows: list[AccuracyRow], method: str, wanted: float, on_starts: bool) -> str:
    """Time of the cheapest measured setting that is good enough."""
    tried = [
        (r.error_starts if on_starts else r.error_peak, r.time) for r in rows if r.method == method
    ]
    enough = [wall for error, wall in tried if error is not None and error <= wanted]
    if enough:
        return duration(min(enough))
    slowest = max((wall for _, wall in tried), default=0.0)
    return f"more than {duration(slowest)} (the finest setting tried is not enough)"
