"""The conductor: a case in, complete results out."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from engine.case.choices import ElementKind
from engine.case.data import CaseData, case_digest
from engine.case.defaults import DEFAULT_TOLERANCE_PEAK, DEFAULT_TOLERANCE_STARTS
from engine.case.effect import StartEffects
from engine.case.effects import EFFECTS, choice_of
from engine.case.effects.bearings import has_bearings
from engine.case.plausibility import implausible
from engine.fatigue.allowable_starts import AllowableStarts
from engine.fatigue.stress import shear_stress
from engine.model.excitation import excitations_of
from engine.model.modes import (
    ModalDamping,
    Modes,
    SubdividedModes,
    damped_eigenvalues,
    modal_damping,
    natural_modes,
    nodes_of,
)
from engine.model.motor import motors_of
from engine.model.train import Train
from engine.operation.margins import interference, judge, separation_margins
from engine.operation.steady_state import steady_state
from engine.plan.evidence import (
    Evidence,
    gather,
    with_event_start,
    with_linear_start,
)
from engine.plan.plan import Plan, first_plan, revised_plan, with_times
from engine.results.results import AccuracyRow, AtSpeed, Results
from engine.results.verdicts import verdicts_of
from engine.start.crossings import Crossing, start_crossings
from engine.start.event_results import Repeatability
from engine.start.outcome import Outcome
from engine.start.prescribed import run_prescribed
from engine.start.reversals import Reversal, torque_reversals
from engine.start.settings import has_start
from engine.start.start import Start, run_start
from engine.start.start_fatigue import judged_shafts, starts_of
from engine.start.warm_up import load_routines

__all__ = [
    "NEWMARK",
    "Analysed",
    "Model",
    "Planned",
    "analyse",
    "at_speed",
    "calculate_start",
    "judged_starts",
    "planned_start",
    "run",
]

#: A first mode below this frequency, and a start longer than this, look like a wrong unit. [Hz, s]
LOW_FREQUENCY, LONG_START = 1.0, 60.0
#: How often the start is repeated at half the step where the starts are not accurate enough.
MAX_STARTS_REFINEMENTS = 3
#: Stage in which the loop of runs with events is compiled: its time is no analysis's.
COMPILING_EVENTS = "compiling the routines for clearances and pull-in, once on this machine"
#: The paper's method, as `Method` names it.
NEWMARK = "newmark"
#: Plans of one run: each new one adds a clearance, and more than these are never seen.
MAX_PLANS = 5

#: Names an analysis and measures its time.
Stage = Callable[[str], AbstractContextManager[None]]


@dataclass(frozen=True, eq=False)
class Model:
    """A train ready for a start."""

    train: Train  #: The train as arrays. [SI]
    modes: Modes  #: Its modes. [SI]
    damping: ModalDamping  #: Their damping. [SI]


@dataclass(frozen=True, eq=False)
class Analysed:
    """Natural modes of a case, with and without bearings."""

    found: SubdividedModes  #: The modes that are reported. [SI]
    reported: Model  #: Their train and damping: with bearings where their data is given. [SI]
    torsional: Model  #: Gears held sideways; the same where there is no bearing data. [SI]
    #: Gears on their bearings, whether reported or not; None without bearing data. [SI]
    coupled: Model | None

    def of(self, plan: Plan) -> Model:
        """The model that a plan calls for.

        Parameters
        ----------
        plan : Plan
            A plan. [mixed]

        Returns
        -------
        Model
            With or without bearings. [SI]
        """
        return self.reported if plan.lateral else self.torsional


@dataclass(frozen=True, eq=False)
class Planned:
    """A start and the plans that led to it."""

    start: Start  #: The start that is reported, and the linear one, perhaps the same. [SI]
    linear: Start  #: Likewise. [SI]
    plans: tuple[Plan, ...]  #: In the order in which they were made. [mixed]
    model: Model  #: The train it was calculated with. [SI]
    evidence: Evidence  #: What the plans were made from. [SI]
    settled: bool  #: False if the last plan, too, was found wrong by its run.

    @property
    def plan(self) -> Plan:
        """The plan of the start that is reported. [mixed]"""
        return self.plans[-1]


def run(case: CaseData, on_stage: Callable[[str], None] | None = None) -> Results:
    """Calculate everything a case calls for.

    Parameters
    ----------
    case : CaseData
        A checked case. [SI]
    on_stage : callable, optional
        Called with the name of each analysis as it begins. [name]

    Returns
    -------
    Results
        Complete and frozen. [SI]

    Raises
    ------
    ModelError
        If the train as a whole cannot be calculated; the sentence says why.
    """
    spent: list[tuple[str, float]] = []

    @contextmanager
    def stage(name: str) -> Iterator[None]:
        if on_stage is not None:
            on_stage(name)
        began = time.perf_counter()
        yield
        spent.append((name, time.perf_counter() - began))

    analysed, known = _at_speed(case, stage)
    start: Start | None = None
    starts: AllowableStarts | None = None
    crossings: tuple[Crossing, ...] = ()
    errors: tuple[tuple[str, float | None], ...] = ()
    plans: tuple[Plan, ...] = ()
    settled = True
    if has_start(case) or case.torque_time:
        planned = planned_start(case, analysed, stage)
        plans, settled = planned.plans, planned.settled
        with stage("fatigue"):
            start, starts, errors = judged_starts(case, planned)
        if planned.plan.sweep:
            with stage("crossings"):
                crossings = _crossings(case, analysed.reported, start)
        plans = (*plans[:-1], with_times(plans[-1], _measured(planned.plan, spent)))
    else:
        plans = (first_plan(case, _evidence(case, analysed)),)
    reversals: tuple[Reversal, ...] = ()
    if start is not None:
        reversals = torque_reversals(case, planned.model.train, start, start.contacts)
    return Results(
        **known.__dict__,
        start=start,
        crossings=crossings,
        starts=starts,
        starts_error=errors,
        verdicts=verdicts_of(case, known.margins, known.steady, start, starts, reversals),
        warnings=tuple(
            dict.fromkeys(
                [
                    *implausible(case),
                    *known.margins.warnings,
                    *known.steady.warnings,
                    *_warnings(case, analysed.reported, start, starts, plans[-1], settled),
                    *_accuracy_of_starts(case, start, errors),
                    *_pulling_teeth(case, plans[-1], reversals),
                ]
            )
        ),
        spent=tuple(spent),
        plans=plans,
        reversals=reversals,
        bearing_forces=() if start is None else start.bearing_forces,
        pull_in=None if start is None else start.pull_in,
        sensitivity=None if start is None else start.sensitivity,
        accuracy=_accuracy(case, start, errors, spent),
    )


def at_speed(case: CaseData) -> AtSpeed:
    """Modes, margins and forced response of a case, without a start.

    Parameters
    ----------
    case : CaseData
        A checked case. [SI]

    Returns
    -------
    AtSpeed
        The same numbers as those of `run`. [SI]

    Raises
    ------
    ModelError
        If the train as a whole cannot be calculated; the sentence says why.
    """
    return _at_speed(case, lambda _: nullcontext())[1]


def _at_speed(case: CaseData, stage: Stage) -> tuple[Analysed, AtSpeed]:
    with stage("natural frequencies"):
        analysed = analyse(case)
        train, modes = analysed.reported.train, analysed.reported.modes
        damping = analysed.reported.damping
    with stage("separation margins"):
        excitations = excitations_of(case, train)
        margins = separation_margins(case, train, modes, excitations)
        diagram = interference(case, train, modes, excitations)
    with stage("steady state"):
        steady = steady_state(case, train, modes, damping, excitations, margins)
    return analysed, AtSpeed(
        case=case,
        case_sha256=case_digest(case),
        train=train,
        modes=modes,
        nodes=nodes_of(train, modes),
        segments=analysed.found.segments,
        frequency_error=analysed.found.frequency_error,
        damping=damping,
        eigenvalues=damped_eigenvalues(train, modes) if damping.neglected > 0.0 else None,
        excitations=excitations,
        margins=judge(margins, steady.rows),
        interference=diagram,
        steady=steady,
    )


# --- modes, plan, start ---------------------------------------------------------------------------


def analyse(case: CaseData) -> Analysed:
    """Natural modes of a case; where bearing data is given also those of gears held sideways.

    Parameters
    ----------
    case : CaseData
        The case. [SI]

    Returns
    -------
    Analysed
        Modes and damping. [SI]
    """
    found = natural_modes(case)
    coupled = _model(case, found)
    if not has_bearings(case):
        return Analysed(found, coupled, coupled, None)
    plain = natural_modes(case, lateral=False)
    torsional = _model(case, plain)
    if choice_of(case, "bearings") == "off":
        return Analysed(plain, torsional, torsional, coupled)
    return Analysed(found, coupled, torsional, coupled)


def _model(case: CaseData, found: SubdividedModes) -> Model:
    return Model(found.train, found.modes, modal_damping(case, found.train, found.modes))


def _evidence(case: CaseData, analysed: Analysed) -> Evidence:
    """Evidence before the start."""
    t, c = analysed.torsional, analysed.coupled
    coupled = None if c is None else (c.train, c.modes, c.damping)
    return gather(case, t.train, t.modes, t.damping, coupled)


def planned_start(
    case: CaseData, analysed: Analysed, stage: Stage = lambda _: nullcontext()
) -> Planned:
    """The start that the evidence calls for: linear first, then with events where it says so.

    Parameters
    ----------
    case : CaseData
        The case. [SI]
    analysed : Analysed
        Its modes. [SI]
    stage : callable, optional
        Names an analysis and measures its time. [name]

    Returns
    -------
    Planned
        The start with every plan made. [SI]
    """
    with stage("plan"):
        evidence = _evidence(case, analysed)
        plan = first_plan(case, evidence)
    model = analysed.of(plan)
    load_routines()
    plain = replace(plan.effects, clearances=())
    with stage("start"):
        linear, wall = _timed(lambda: calculate_start(case, model, plain, None))
    with stage("plan"):
        evidence = with_linear_start(evidence, case, model.train, linear, wall)
        plans = [first_plan(case, evidence)]
    start, settled = linear, True
    while plans[-1].events:
        effects = plans[-1].effects
        if not _events_compiled():
            with stage(COMPILING_EVENTS):
                calculate_start(case, model, effects, linear)
        with stage("start with events"):
            start, wall = _timed(partial(calculate_start, case, model, effects, linear))
        with stage("plan"):
            evidence = with_event_start(evidence, case, model.train, start, wall)
            new = revised_plan(case, plans[-1], evidence)
        runs_as_before = new.effects == plans[-1].effects
        settled = runs_as_before or len(plans) < MAX_PLANS
        if new is not plans[-1] and settled:
            plans.append(new)
        if runs_as_before or not settled:
            break
    return Planned(start, linear, tuple(plans), model, evidence, settled)


def _events_compiled() -> bool:
    """Whether the loop of runs with events is at hand."""
    from engine.stepping.compiling import is_compiled  # not loaded where no case has events
    from engine.stepping.contact_loop import advance_pieces

    return is_compiled(advance_pieces)


def _timed(calculate: Callable[[], Start]) -> tuple[Start, float]:
    """A start and the wall time it took."""
    began = time.perf_counter()
    start = calculate()
    return start, time.perf_counter() - began


def calculate_start(
    case: CaseData, model: Model, effects: StartEffects, linear: Start | None
) -> Start:
    """One start with the given effects.

    Parameters
    ----------
    case : CaseData
        The case. [SI]
    model : Model
        The train it is calculated with. [SI]
    effects : StartEffects
        What is simulated. [flags]
    linear : Start or None
        The linear start, which one with events begins from; None = calculate that one. [SI]

    Returns
    -------
    Start
        Complete, with its error estimates. [SI]
    """
    if linear is not None:
        from engine.backlash.event_start import (
            run_event_start,  # only cases with events pay for its kernels
        )

        return run_event_start(case, model.train, model.modes, model.damping, effects, linear)
    if has_start(case):
        start = run_start(case, model.train, model.modes, model.damping, effects)
        if start.uncoupled_dampers:  # too strong for explicit forces: the loop with events solves
            from engine.backlash.event_start import run_event_start

            plain = replace(effects, clearances=(), pull_in=False, aborted_start=False)
            return run_event_start(case, model.train, model.modes, model.damping, plain, start)
        return start
    return run_prescribed(case, model.train, model.modes, model.damping)


def judged_starts(
    case: CaseData, planned: Planned
) -> tuple[Start, AllowableStarts | None, tuple[tuple[str, float | None], ...]]:
    """Starts of every judged shaft; the start is refined until they are accurate enough.

    Parameters
    ----------
    case : CaseData
        The case. [SI]
    planned : Planned
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
    starts, errors = starts_of(case, start, always_count=always)
    for _ in range(MAX_STARTS_REFINEMENTS):
        worst = max((e for _, e in errors if e is not None), default=0.0)
        if worst <= tolerance or start.runup is None or start.is_sensitive:
            break
        # Cycles may need a finer step than any peak: this is no tolerance that a user may type.
        finest = max(start.estimated_error / 16.0, 1e-9)
        tighter = replace(CaseData(**vars(case)), tolerance_peak=finest)
        linear = planned.linear if planned.plan.events else None
        finer = calculate_start(tighter, planned.model, planned.plan.effects, linear)
        if finer.step >= start.step:
            break
        start = _as_asked(finer, case.tolerance_peak or DEFAULT_TOLERANCE_PEAK)
        starts, errors = starts_of(case, start, always_count=always)
    return start, starts, errors


def _as_asked(start: Start, tolerance: float) -> Start:
    """A start that was refined for the sake of its cycles, judged by the tolerance of its peaks."""
    spread = None if start.sensitivity is None else start.sensitivity.spread
    return replace(
        start,
        met_tolerance=start.estimated_error <= tolerance,
        sensitivity=None if spread is None else Repeatability.of(spread, tolerance),
    )


def _totals(spent: list[tuple[str, float]]) -> dict[str, float]:
    """Wall time of each analysis, its repetitions added up."""
    total: dict[str, float] = {}
    for name, wall in spent:
        total[name] = total.get(name, 0.0) + wall
    return total


def _measured(plan: Plan, spent: list[tuple[str, float]]) -> dict[str, float]:
    """Wall time of the effects that have an analysis of their own."""
    total = _totals(spent)
    return {
        name: total[effect.analysis]
        for name, effect in EFFECTS.items()
        if effect.analysis in total and plan.decision(name).on
    }


def _accuracy(
    case: CaseData,
    start: Start | None,
    errors: tuple[tuple[str, float | None], ...],
    spent: list[tuple[str, float]],
) -> tuple[AccuracyRow, ...]:
    """Estimated error and time of each analysis of this run."""
    total = _totals(spent)
    last = "start with events" if "start with events" in total else "start"
    rows = []
    for name, wall in total.items():
        if name == COMPILING_EVENTS:
            continue
        setting, peak, starts = "", None, None
        if start is not None and name == last:
            wanted = case.tolerance_peak or DEFAULT_TOLERANCE_PEAK
            setting = f"{start.method}, tolerance {wanted:.2g}, step {start.step:.3g} s"
            peak = start.estimated_error
        if name == "fatigue":
            setting = f"tolerance {case.tolerance_starts or DEFAULT_TOLERANCE_STARTS:.2g}"
            starts = max((e for _, e in errors if e is not None), default=None)
        rows.append(AccuracyRow(name, setting, peak, starts, wall))
    return tuple(rows)


def _crossings(case: CaseData, model: Model, start: Start) -> tuple[Crossing, ...]:
    ratings = case.ratings
    if start.runup is None or not ratings.line_frequency or not ratings.synchronous_speed:
        return ()
    stress = [
        float(shear_stress(1.0, e.stress_diameter, e.stress_bore or 0.0))
        if e.stress_diameter
        else None
        for e in case.elements
    ]
    meshes = [i for i, e in enumerate(case.elements) if e.kind == ElementKind.GEAR_MESH]
    return start_crossings(
        model.train,
        model.modes,
        model.damping,
        start,
        ratings.line_frequency,
        ratings.synchronous_speed,
        stress,
        meshes,
    )


def _unstable_feedback(
    case: CaseData, train: Train, modes: Modes, damping: ModalDamping
) -> Iterator[str]:
    """A torque that rises with speed feeds a mode faster than its damping takes energy away."""
    for motor in motors_of(case, train):
        rise = float(np.max(motor.average.cubic[:, 1])) / motor.synchronous_speed
        dof, scale = train.node_dof[motor.station], train.node_scale[motor.station]
        fed = rise * (modes.shape[dof] * scale) ** 2
        grown = np.flatnonzero((fed > damping.rate) & (modes.omega > 0.0))
        if len(grown):
            mode = int(grown[0])
            yield (
                f"The average torque of '{train.stations[motor.station]}' rises with speed faster "
                f"than the damping of mode {mode - modes.n_rigid + 1} "
                f"({modes.frequency[mode]:.4g} Hz) takes out: with torque following every "
                "oscillation of the rotor that mode may grow by itself. Check its damping ratio."
            )


def _warnings(
    case: CaseData,
    model: Model,
    start: Start | None,
    starts: AllowableStarts | None,
    plan: Plan,
    settled: bool,
) -> Iterator[str]:
    """What a reader must know beside the numbers."""
    train, modes, damping = model.train, model.modes, model.damping
    first = modes.elastic_frequency[:1]
    if len(first) and first[0] < LOW_FREQUENCY:
        yield (
            f"The first torsional mode at {first[0]:.3g} Hz is unusually low. Check the units of "
            "stiffnesses and inertias."
        )
    n_elastic = modes.n_modes - modes.n_rigid
    for row in case.mode_damping:
        if row.mode is not None and row.mode > n_elastic:
            yield f"ModeDamping names mode {row.mode}, but the train has {n_elastic} elastic modes."
    yield from plan.warnings
    if start is None:
        yield "No motor torque curve and no prescribed torque: no start was calculated."
        return
    tripped = start.outcome.outcome == Outcome.TRIPPED  # its time is that of the coast-down
    if start.outcome.time > LONG_START and start.runup is not None and not tripped:
        yield (
            f"The start takes {start.outcome.time:.0f} s; most take less than {LONG_START:.0f} s. "
            "Check inertias and torques."
        )
    yield from _unstable_feedback(case, train, modes, damping)
    yield from _of_the_run(start, settled)
    counted = {e.element for _, e in judged_shafts(case)}
    for e in case.elements:
        if e.stress_diameter and e.material and e.element not in counted:
            yield (
                f"'{e.element}' has a stress diameter, but its material '{e.material}' has no S-N "
                "points: its starts were not counted."
            )
    if not start.met_tolerance:
        yield (
            f"The wanted accuracy of peak torques was not met: estimated error "
            f"{start.estimated_error:.2g} at a step of {start.step:.3g} s." + _why_not_met(start)
        )
    if case.method == NEWMARK and start.method != NEWMARK:
        yield (
            "Method newmark has no clearances, field or trip: the start that is reported was "
            "calculated by the exponential method."
        )
    if starts is None and judged_shafts(case):
        return
    if starts is None:
        yield "No shaft has stress diameter, material and S-N points: no starts were counted."
        return
    for shaft in starts.shafts:
        yield from shaft.notes
    if math.isfinite(case.starts_factor or 1.0) and (case.starts_factor or 1.0) != 1.0:
        yield f"Allowable starts are divided by StartsFactor {case.starts_factor:g} when judged."


def _why_not_met(start: Start) -> str:
    """What kept a start from a finer step."""
    if start.is_sensitive or start.sensitivity is None:  # said elsewhere, or a plain start
        return ""
    return (
        " A finer step would take more steps than one calculation is given; raise TolerancePeak, or "
        "look for modes that ring at every impact."
    )


def _accuracy_of_starts(
    case: CaseData, start: Start | None, errors: tuple[tuple[str, float | None], ...]
) -> Iterator[str]:
    """Allowable starts that are less accurate than wanted; of a sensitive start that is said."""
    if start is None or start.is_sensitive:
        return
    wanted = case.tolerance_starts or DEFAULT_TOLERANCE_STARTS
    for shaft, error in errors:
        if error is not None and error > wanted:
            yield (
                f"The wanted accuracy of allowable starts of '{shaft}' was not met: estimated error "
                f"{100.0 * error:.2g} %, wanted {100.0 * wanted:.2g} %."
            )


def _pulling_teeth(case: CaseData, plan: Plan, reversals: tuple[Reversal, ...]) -> Iterator[str]:
    """Teeth without a gap on bearings: a negative torque pulls them along the drive flank."""
    meshes = {e.element for e in case.elements if e.kind == ElementKind.GEAR_MESH}
    gaps = {m.element for m in case.meshes if m.backlash}
    for r in reversals:
        if plan.lateral and r.reversals and r.element in meshes - gaps:
            yield (
                f"'{r.element}': the torque falls to {float(f'{r.minimum_torque:.4g}'):,g} N m, but "
                "with Backlash blank or 0 its teeth cannot part in the calculation: they pull along "
                "the drive flank instead of pushing on the back flank, and the bearing forces of its "
                "gears are those of a pull. Give its Backlash in table Meshes to have the teeth part."
            )


def _of_the_run(start: Start, settled: bool) -> Iterator[str]:
    """What the start itself left open."""
    if start.uncoupled_dampers:
        names = ", ".join(f"'{name}'" for name in start.uncoupled_dampers)
        yield (
            f"The dampers {names} are so strong for their inertias that they act on each mode for "
            "itself in the start. Check their damping."
        )
    if start.sensitivity is not None and start.sensitivity.sensitive:
        yield (
            "Sensitive: a change of the input by 1e-9 may change a peak torque by "
            f"{start.sensitivity.spread:.2g}; the peaks are one of many equally right answers."
        )
    if not settled:
        yield (
            f"After {MAX_PLANS} plans the run still reverses torque where no gap is modelled; see "
            "the reasons of the plans. Force backlash on to model all clearances."
        )
