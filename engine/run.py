"""The conductor: a case in, complete results out."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from engine.backlash.event_start import one_run, run_event_start
from engine.backlash.operating_events import OperatingEvent, operating_events
from engine.case.choices import TorqueFollows
from engine.case.data import CaseData, case_digest
from engine.case.defaults import DEFAULT_TOLERANCE_PEAK, DEFAULT_TOLERANCE_STARTS
from engine.case.effect import StartEffects
from engine.case.result_words import Outcome
from engine.fatigue.allowable_starts import AllowableStarts, allowable_starts
from engine.model.excitation import excitations_of
from engine.model.modal_analysis import ModalAnalysis
from engine.model.modal_train import ModalTrain
from engine.model.modes import (
    damped_eigenvalues,
    nodes_of,
)
from engine.operation.acceptance import judge, mode_parts
from engine.operation.forced_response import forced_response, only_within_error
from engine.operation.margins import interference, separation_margins
from engine.plan.contact_damping import LIMIT_GAIN, without_excess_damping
from engine.plan.evidence import Evidence, collect_evidence, start_evidence
from engine.plan.plan import (
    Plan,
    effects_with,
    first_plan,
    revised_plan,
    with_estimate,
    with_measured,
    with_times,
)
from engine.results.results import AtSpeed, Results
from engine.results.times import EVENTS, accuracy_of, measured_times
from engine.results.verdicts import verdicts_of
from engine.results.warnings import warnings_of
from engine.start.by_turns import by_turns
from engine.start.crossings import Crossing, crossings_of
from engine.start.electrical_damping import ElectricalDamping, electrical_damping_of
from engine.start.peaks import JudgedRun, change_of_peaks, judge_run
from engine.start.pieces import analysis_for_start, with_pieces_error
from engine.start.prescribed import run_prescribed
from engine.start.reversals import Reversal, torque_reversals
from engine.start.settings import has_start
from engine.start.start import Start, prepared_start, run_start, with_left_out, with_peaks
from engine.start.start_fatigue import starts_of
from engine.start.start_model import shifted
from engine.start.trajectory import SingleRun
from engine.start.worst_phase import (
    PhaseAnswers,
    WorstOfPhases,
    answers_at,
    at_phase,
    worst_of_phases,
)

#: How often the start is repeated at half the step where the starts are not accurate enough.
MAX_STARTS_REFINEMENTS = 3

#: Least share of the tolerance that is left to steps where effects left out take the rest. [1]
LEAST_SHARE = 0.2

#: Names an analysis and measures its time.
Stage = Callable[[str], AbstractContextManager[None]]


@dataclass(frozen=True, eq=False)
class PlannedStart:
    """A start and the plans that led to it."""

    start: Start  #: The start that is reported, and the linear one, perhaps the same. [SI]
    linear: Start  #: Likewise. [SI]
    plans: tuple[Plan, ...]  #: In the order in which they were made. [mixed]
    model: ModalTrain  #: The train it was calculated with. [SI]
    evidence: Evidence  #: What the plans were made from. [SI]
    #: The start with every effect on that the plan leaves out, where bounds must be measured. [SI]
    full: Start | None = None
    #: The start with motor curves read at the other speed, where that estimates what lacks data. [SI]
    otherwise: JudgedRun | None = None

    @property
    def plan(self) -> Plan:
        """The plan of the start that is reported. [mixed]"""
        return self.plans[-1]


def run(case: CaseData, on_stage: Callable[[str], None] | None = None) -> Results:
    """Calculate everything a checked case calls for.

    `on_stage` is called with the name of each analysis as it begins. Raises `ModelError` if the train as a
    whole cannot be calculated; the sentence says why.
    """
    spent: list[tuple[str, float]] = []

    @contextmanager
    def stage(name: str) -> Iterator[None]:
        if on_stage is not None:
            on_stage(name)
        began = time.perf_counter()
        yield
        spent.append((name, time.perf_counter() - began))

    analysis, at_speed_results = _at_speed(case, stage)
    start: Start | None = None
    starts: AllowableStarts | None = None
    crossings: tuple[Crossing, ...] = ()
    errors: tuple[tuple[str, float | None], ...] = ()
    reversals: tuple[Reversal, ...] = ()
    damping: tuple[ElectricalDamping, ...] = ()
    if has_start(case) or case.torque_time_from_rest:
        asked, worst = case, None
        if case.looks_for_worst_phase:
            with stage("phases of the pulsation"):
                worst = _worst_of_phases(case, analysis)
            asked = at_phase(case, worst.phase)
        planned = planned_start(asked, analysis, stage)
        with stage("fatigue"):
            start, starts, errors = judged_starts(asked, planned)
        if worst is not None:
            wanted = case.tolerance_peak or DEFAULT_TOLERANCE_PEAK
            start = with_peaks(start, worst.peaks, worst.left_out, worst.phase, wanted)
            if starts is not None:
                starts = allowable_starts(worst.shafts, case.starts_factor)
                errors = worst.errors
        # sections and runs are most of the memory, and nothing more is read from them
        start = replace(start, sections={})
        if start.repeatability is not None:
            start = replace(start, repeatability=replace(start.repeatability, histories=()))
        reversals = torque_reversals(case, planned.model.train, start, start.contacts)
        if planned.plan.sweep:
            with stage("crossings"):
                crossings = crossings_of(case, analysis.reported, start, planned.model)
        measured = with_times(planned.plan, measured_times(planned.plan, spent))
        plans = (*planned.plans[:-1], measured)
        if planned.evidence.electrical is not None:
            damping = planned.evidence.electrical.rows
    else:
        plans = (first_plan(case, collect_evidence(case, analysis.torsional, analysis.coupled)),)
    events: tuple[OperatingEvent, ...] = ()
    if case.event_names:
        with stage(EVENTS):
            events = tuple(e.without_histories() for e in operating_events(case, analysis))
    results = Results(
        **vars(at_speed_results),
        start=start,
        crossings=crossings,
        starts=starts,
        starts_error=errors,
        spent=tuple(spent),
        plans=plans,
        reversals=reversals,
        electrical_damping=damping,
        events=events,
    )
    return replace(
        results,
        accuracy=accuracy_of(results),
        verdicts=verdicts_of(results),
        warnings=tuple(dict.fromkeys(warnings_of(results))),
    )


def _worst_of_phases(case: CaseData, analysis: ModalAnalysis) -> WorstOfPhases:
    """The start at every phase, each with a plan of its own."""

    def answers(phase: float) -> PhaseAnswers:
        asked = at_phase(case, phase)
        start, starts, errors = judged_starts(asked, planned_start(asked, analysis))
        return answers_at(case, phase, start, () if starts is None else starts.shafts, errors)

    return worst_of_phases(
        lambda phases: by_turns([partial(answers, phase) for phase in phases]), case.turns_of_phase
    )


def at_speed(case: CaseData) -> AtSpeed:
    """Modes, margins and forced response of a checked case, without a start: the numbers of `run`.

    Raises `ModelError` if the train as a whole cannot be calculated; the sentence says why.
    """
    return _at_speed(case, lambda _: nullcontext())[1]


def _at_speed(case: CaseData, stage: Stage) -> tuple[ModalAnalysis, AtSpeed]:
    with stage("natural frequencies"):
        analysis = analysis_for_start(case)
        train, modes = analysis.reported.train, analysis.reported.modes
        damping = analysis.reported.damping
    with stage("separation margins"):
        excitations = excitations_of(case, train)
        reach = analysis.subdivided.accurate_up_to
        margins = separation_margins(case, train, modes, excitations, reach)
        diagram = interference(case, modes, excitations)
    with stage("steady state"):
        steady = forced_response(case, analysis, excitations, margins)
        parts = mode_parts(case, train, modes)
        error = analysis.subdivided.frequency_error
        unsure = only_within_error(steady, case)
        margins = judge(margins, steady.rows, parts, error, unsure)
    return analysis, AtSpeed(
        case=case,
        case_sha256=case_digest(case),
        train=train,
        modes=modes,
        nodes=nodes_of(train, modes),
        segments=analysis.subdivided.segments,
        frequency_error=error,
        accurate_up_to=analysis.subdivided.accurate_up_to,
        damping=damping,
        eigenvalues=damped_eigenvalues(train, modes, damping.structural)
        if damping.neglected > 0.0
        else None,
        excitations=excitations,
        margins=margins,
        interference=diagram,
        steady=steady,
    )


# --- modes, plan, start ---------------------------------------------------------------------------


def planned_start(
    case: CaseData,
    analysis: ModalAnalysis,
    stage: Stage = lambda _: nullcontext(),
    most_modes: int | None = None,
    estimated: bool = True,
) -> PlannedStart:
    """The start that the evidence calls for: linear first, then with events where it says so.

    With `most_modes` no more modes are integrated than so many, whatever the others change. Not `estimated`: what
    motors without data damp is no part of what is left out, which then is bounds alone.
    """
    with stage("plan"):
        evidence = collect_evidence(case, analysis.torsional, analysis.coupled, analysis.reported)
        evidence = replace(evidence, most_modes=most_modes)
        plan = first_plan(case, evidence)
    model = analysis.reported if plan.lateral else analysis.torsional
    pieces = dict(analysis.pieces_error)
    tolerance = case.tolerance_peak or DEFAULT_TOLERANCE_PEAK
    # steps and modes left out take what the pieces of shafts leave of the tolerance
    left = max(tolerance - max(pieces.values(), default=0.0), 0.5 * tolerance)
    stepped = replace(CaseData(**vars(case)), tolerance_peak=left) if pieces else case
    plain = replace(plan.effects, clearances=())
    with stage("start"):
        linear, wall = _timed(lambda: calculate_start(stepped, model, plain, None))
        changed, limit = without_excess_damping(stepped, model.train, linear), 0.0
        if changed is not None:
            other = calculate_start(changed, model, plain, None)
            limit = LIMIT_GAIN * change_of_peaks(linear.peaks, other.peaks)
        linear = with_pieces_error(linear, pieces, tolerance)
    with stage("plan"):
        evidence = replace(evidence, linear=start_evidence(case, model, linear, wall, limit))
        plans = [first_plan(case, evidence)]
    bound = plans[-1].left_out_bound
    if bound and not plans[-1].events and linear.met_tolerance:
        # error and what is left out keep the tolerance together
        tighter = max(left - bound, LEAST_SHARE * tolerance)
        if linear.estimated_error > tighter:
            stepped = replace(CaseData(**vars(case)), tolerance_peak=tighter)
            with stage("start"):
                linear = calculate_start(stepped, model, plain, None)
                linear = with_pieces_error(linear, pieces, tolerance)
    start, full = linear, None
    while plans[-1].events:
        effects = plans[-1].effects
        with stage("start with events"):
            start, wall = _timed(partial(calculate_start, stepped, model, effects, linear))
            start = with_pieces_error(start, pieces, tolerance)
        with stage("plan"):
            evidence = replace(evidence, event=start_evidence(case, model, start, wall))
            new = revised_plan(case, plans[-1], evidence)
        runs_as_before = new.effects == plans[-1].effects
        plans = [*plans, new] if new.number > plans[-1].number else [*plans[:-1], new]
        if runs_as_before:
            break
    if plans[-1].events and plans[-1].left_out:
        with stage("effects left out"):
            full, change = _with_all_effects(stepped, analysis, plans[-1], evidence, start)
        adopted = change is not None and change > tolerance
        plan = with_measured(plans[-1], change, adopted)
        plans = [*plans, plan] if adopted else [*plans[:-1], plan]
        if adopted and full is not None:
            start, full = with_pieces_error(full, pieces, tolerance), None
            model = (analysis.coupled if plan.lateral else None) or model
    otherwise: JudgedRun | None = None
    unknown = evidence.electrical is not None and not evidence.electrical.known
    if estimated and unknown and not plans[-1].effects.motor_transient:
        with stage("motor curves at the other speed"):
            otherwise, change = _read_otherwise(stepped, model, plans[-1], start, linear)
        plans[-1] = with_estimate(case, plans[-1], change)
    elif (
        (effects := plans[-1].effects).electrical_damping
        and not effects.motor_transient
        and estimated
    ):
        with stage("shift of frequencies by motors"):
            otherwise, change = _shifted(stepped, model, plans[-1], linear)
        plans[-1] = with_estimate(case, plans[-1], change)
    start = with_left_out(start, plans[-1].left_out_bound, tolerance, plans[-1].estimate)
    return PlannedStart(start, linear, tuple(plans), model, evidence, full, otherwise)


def _read_otherwise(
    case: CaseData, model: ModalTrain, plan: Plan, start: Start, linear: Start
) -> tuple[JudgedRun | None, float]:
    """The start with motor curves read at the other speed, own or mean, and how that changes the peaks.

    Where runs part whatever is changed, or none came to its end, the linear starts tell; there is none then. The step
    is that of the coarser of the two simulations that gave the answer: half the work, and the estimate changes by at
    most 5 % in 42 of 47 random starts (by 42 % in one with events).
    """
    reading = TorqueFollows.MEAN_SPEED if case.reads_own_speed else TorqueFollows.OWN_SPEED
    other = replace(CaseData(**vars(case)), torque_follows=reading)
    unfinished = start.outcome.outcome == Outcome.TIME_OUT
    if plan.events and start.repeatability is None and not unfinished:
        run = one_run(other, model, plan.effects, linear, 2.0 * start.step)
        if not run.events.gave_up:
            judged = _judged_alone(model, run)
            return judged, change_of_peaks(judged.peaks, start.peaks)
    plain = _without_events(plan.effects)
    prepared = prepared_start(other, model, plain)
    if prepared.model.uncoupled_dampers:  # too strong for explicit forces, as in `calculate_start`
        judged = calculate_start(other, model, plain, None)
    else:
        judged = _judged_alone(model, prepared.to_its_end(2.0 * linear.step)[1])
    change = change_of_peaks(judged.peaks, linear.peaks)
    return None if plan.events else judged, change


def _shifted(
    case: CaseData, model: ModalTrain, plan: Plan, linear: Start
) -> tuple[JudgedRun | None, float]:
    """The linear start with the frequencies that the motors give the modes, and how that changes the peaks."""
    prepared = prepared_start(case, model, _without_events(plan.effects))
    prepared, plain = prepared.to_its_end(linear.step)
    shift = np.zeros(model.modes.n_modes)
    for row in electrical_damping_of(case, model):
        if row.speed < 1.0:
            shift[model.modes.n_rigid + row.mode - 1] += 2.0 * math.pi * (row.shift or 0.0)
    run = replace(prepared, model=shifted(prepared.model, shift)).at(linear.step)
    other = _judged_alone(model, run)
    change = change_of_peaks(other.peaks, _judged_alone(model, plain).peaks)
    return None if plan.events else other, change


def _judged_alone(model: ModalTrain, run: SingleRun) -> JudgedRun:
    """Extremes of one simulation, without an estimate of its error."""
    return judge_run(model.train, np.zeros(len(run.turning)), run, run)


def _without_events(effects: StartEffects) -> StartEffects:
    return replace(
        effects,
        clearances=(),
        pull_in=False,
        aborted_start=False,
        switch_over=False,
        motor_transient=False,
    )


def _with_all_effects(
    case: CaseData, analysis: ModalAnalysis, plan: Plan, evidence: Evidence, start: Start
) -> tuple[Start | None, float | None]:
    """A start with events and every effect that its plan leaves out, and how that changes the peaks.

    Bounds of effects hold for linear starts; what teeth make of a small change is measured. None where
    they cannot be simulated, or runs part whatever is changed, or the start was not followed to its end.
    """
    names = [name for name in plan.left_out if plan.decision(name).bound is not None]
    unfinished = start.outcome.outcome == Outcome.TIME_OUT
    if not names or start.repeatability is not None or unfinished:
        return None, None
    lateral = plan.lateral or "bearings" in names
    model = (analysis.coupled if lateral else None) or analysis.torsional
    full = run_event_start(case, model, effects_with(plan, evidence, names))
    return full, change_of_peaks(start.peaks, full.peaks)


def _timed(calculate: Callable[[], Start]) -> tuple[Start, float]:
    """A start and the wall time it took."""
    began = time.perf_counter()
    start = calculate()
    return start, time.perf_counter() - began


def calculate_start(
    case: CaseData, model: ModalTrain, effects: StartEffects, linear: Start | None
) -> Start:
    """One start with the given effects.

    One with events begins from the linear start; None = calculate that one.
    """
    if linear is not None:
        return run_event_start(case, model, effects, linear)
    if has_start(case):
        start = run_start(case, model, effects)
        if start.uncoupled_dampers:  # too strong for explicit forces: the loop with events solves
            return run_event_start(case, model, _without_events(effects), start)
        return start
    return run_prescribed(case, model)


def judged_starts(
    case: CaseData, planned: PlannedStart
) -> tuple[Start, AllowableStarts | None, tuple[tuple[str, float | None], ...]]:
    """Starts of every judged shaft; the start is refined until they are accurate enough.

    Parameters
    ----------
    case : CaseData
        The case. [SI]
    planned : PlannedStart
        Its start. [SI]

    Returns
    -------
    start : Start
        The start, perhaps a finer one. [SI]
    starts : AllowableStarts or None
        None where no shaft is judged, or counting is forced off. [1]
    errors : tuple of (str, float or None)
        Per judged shaft, relative error of its starts; None = unlimited. [1]
    """
    start, counting = planned.start, planned.plan.decision("cycle counting")
    if counting.choice == "off" and not planned.plan.cycle_counting:
        return start, None, ()
    always = counting.choice == "on"
    tolerance = case.tolerance_starts or DEFAULT_TOLERANCE_STARTS
    others = planned.full, planned.otherwise
    starts, errors = starts_of(case, start, *others, always_count=always)
    for _ in range(MAX_STARTS_REFINEMENTS):
        worst = max((e for _, e in errors if e is not None), default=0.0)
        unfinished = start.outcome.outcome == Outcome.TIME_OUT
        if (
            worst <= tolerance
            or start.runup is None
            or start.repeatability is not None
            or unfinished
        ):
            break
        # Cycles may need a finer step than any peak: this is no tolerance that a user may type.
        finest = max(start.estimated_error / 16.0, 1e-9)
        tighter = replace(CaseData(**vars(case)), tolerance_peak=finest)
        linear = planned.linear if planned.plan.events else None
        finer = calculate_start(tighter, planned.model, planned.plan.effects, linear)
        if finer.step >= start.step:
            break
        wanted = case.tolerance_peak or DEFAULT_TOLERANCE_PEAK
        finer = with_pieces_error(finer, dict(start.pieces_error), wanted)
        plan = planned.plan
        start = with_left_out(_as_asked(finer, wanted), plan.left_out_bound, wanted, plan.estimate)
        starts, errors = starts_of(case, start, *others, always_count=always)
    return start, starts, errors


def _as_asked(start: Start, tolerance: float) -> Start:
    """A start that was refined for the sake of its cycles, judged by the tolerance of its peaks."""
    repeated = start.repeatability
    if repeated is not None:
        repeated = replace(repeated, sensitive=repeated.spread > tolerance)
    return replace(start, met_tolerance=start.estimated_error <= tolerance, repeatability=repeated)
