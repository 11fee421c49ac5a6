"""Starts with clearances, lateral motion of gears, field application and trip: the event runs.

The paper's Figure 4: when the torque of a mesh goes through zero its teeth separate, fly through the
clearance under the torques of their own sides, and meet again on one flank or the other. Between
two such events the train is linear and the step is exact (`engine.stepping.contact_loop`). A speed at
which the field is applied or the motor trips is an event of the same kind.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence, Set
from dataclasses import dataclass, fields, replace
from functools import partial

import numpy as np

from engine.arrays import Floats, Ints, Mask
from engine.backlash.contact_systems import (
    ContactSystems,
    ForceLocations,
    SharedBasis,
    common_reach,
    shared_basis,
)
from engine.backlash.contacts import bearing_forces, contact_records, force_histories
from engine.backlash.event_simulation import (
    MOST_ALONE,
    EventModel,
    EventRun,
    EventSchedule,
    Settled,
    simulate_events,
)
from engine.backlash.machines import MachineInTime, machines_of_start
from engine.case.choices import ContactLaw, Method
from engine.case.data import CaseData
from engine.case.defaults import DEFAULT_TOLERANCE_PEAK, LEAST_PEAK_ERROR, LONGEST_START
from engine.case.effect import StartEffects
from engine.case.result_words import Outcome
from engine.errors import ModelError
from engine.model.load import loads_of
from engine.model.modal_train import ModalTrain
from engine.model.modes import stated_damping
from engine.model.motor import Motor, motors_of
from engine.model.rigid_runup import RigidRunup, rigid_runup
from engine.model.train import Flank, Train
from engine.numerics.distinct import distinct
from engine.numerics.same_bits import interp, product, square
from engine.start.decaying_harmonics import DecayingHarmonic, as_the_loop_takes_them
from engine.start.event_results import MachineTorque, PullIn, Repeatability, prediction_interval
from engine.start.machine_motion import Supply
from engine.start.outcome import StartOutcome, outcome_of, run_length
from engine.start.peaks import JudgedRun, judge_run
from engine.start.prescribed import run_prescribed
from engine.start.pull_in import has_failed, has_settled, judge_pull_in, swing_frequency_linear
from engine.start.settings import NEGLIGIBLE, StartSettings, has_start, keeps_history, settings_of
from engine.start.start import Start, run_start
from engine.start.start_fatigue import judged_shafts
from engine.start.start_model import (
    MAX_VALUES,
    Machines,
    StartModel,
    allowed_modes,
    machine_arrays,
    read_speed,
    start_model,
)
from engine.start.time_response import PrescribedTorque, held, prescribed_torques
from engine.start.trajectory import SingleRun
from engine.stepping.contact_loop import DRIVE, FREE


def clearances_of(train: Train) -> tuple[Flank, ...]:
    """Flanks that can part, those with a clearance, in the order of the elements."""
    return tuple(f for f in train.flanks if f.gap is not None and f.gap > 0.0)


# --- a start ------------------------------------------------------------------------------------

#: Largest phase of the pulsation per step of the first run at the default tolerance. Between 0.8 and 1.13 rad the steps
#: of all runs of a start together change by at most 3 % in the mean of 36 random trains; a phase of 1.6 takes more, since
#: the runs at h and h/2 part more often. Larger tolerances take no longer steps: hundreds of contacts in a row are then
#: of no order yet, and two runs may agree by chance. [rad]
COARSEST_EVENT_ANGLE = 1.0
#: Ringing below this share of the tolerance is passed over in the first, coarsest run.
VISIBLE = 0.2
#: Two runs that agree on the largest torque may agree by chance; so the next smaller extremes are
#: compared, too. Where both runs are together up to the largest one (what comes later has no part in it),
#: this share of their change from h to h/2 is taken for the error at h/2: that of second order,
#: 1/(2² − 1). Events and pulsation are of fourth order (1/15; tests/numerics/test_event_step.py), but at the first
#: steps of a start, where torques of unlike sign of error add up, a change of 1/5 has been seen. Where the runs diverge
#: before it, no order holds, and all of the change is taken.
SAME_CONTACTS_SHARE = 1.0 / 3.0
#: Two runs are together as long as each clearance has the same changes of contact in the same order, each within
#: this share of the coarser step. (Teeth that chatter have the same order in runs that have long
#: diverged; in runs that are together, changes are within some hundredths of the step.)
TOGETHER = 0.1
#: Where all that comes after two runs went different ways is below this share of the peaks, it has no part in them.
FAR_SMALLER = 0.75
#: The coarser of two runs may follow ringing with steps as short as the finer one's, for most of the start: their change then
#: shows little of the error. Where they have less than so many times the steps and no contacts, the change counts as at first
#: order. [1]
HALVED = 1.9
#: Halvings of the step before the answers are taken as they are.
MAX_HALVINGS = 5
#: Work of all simulations of one start together, in modes stepped once (10 s). What would exceed it is not
#: made: the answers stand as they are, their errors said. (Steps that follow ringing grow faster than 1/h.)
MOST_WORK = 50_000_000
#: Share of it that the first, coarsest run may take: one twice as fine must still be possible.
FIRST_SHARE = 1.0 / 3.0
#: The same of a start with clearances that had to be stopped even without any: it is stopped sooner, and
#: no finer run gets further. (1 s; one of bearings damped with 1e18 N s/m takes five times as long a contact.)
HOPELESS_WORK = MOST_WORK // 10
#: Runs of an ensemble, those that led to it included.
ENSEMBLE = 12
#: Change of all torques from one run of an ensemble to the next, and of the step. [1]
TINY, STEP_CHANGE = 1e-9, 0.02
#: A billionth that changes a peak by this share of the tolerance is felt: no finer step can help.
FELT = 1.0 / 3.0
#: End of a coast-down, over synchronous speed, and the longest one followed. [1, s]
COAST_END, COAST_TIME = 0.02, 60.0
#: A field that waits for a load angle waits for one slip cycle at the most, of this length. [s]
LONGEST_SLIP_CYCLE = 20.0
#: How often a motor with its field on is asked whether it has settled. [s]
LOOK_EVERY = 0.5


@dataclass(frozen=True)
class EventTorques:
    """Torques that a train without motors and loads is followed under."""

    torques: Sequence[PrescribedTorque]  #: Linear between the rows of tables. [N m]
    terms: Sequence[DecayingHarmonic] = ()  #: Decaying harmonics. [N m]
    #: Stations and torques that hold the train in equilibrium before and during it. [index, N m]
    before: Sequence[tuple[int, float]] = ()
    #: A motor in time, and the phase of its pulsation in the loop at t = 0. [pu, rad]
    machine: tuple[Motor, MachineInTime] | None = None
    held: float = 0.0  #: Torque that the motor gives before the event. [N m]
    speed: float = 1.0  #: Of the train before the event, over synchronous speed. [1]


@dataclass(frozen=True)
class StartEvent:
    """A change of the supply of one motor while it starts. The answers are those from it on, and times count from it."""

    station: int  #: Where the motor acts. [index]
    #: What it is connected to from then on, times from breaker closing; voltages over that of the source. [s, pu, rad]
    supplies: tuple[Supply, ...]
    followed: float  #: How long it is followed after the last of them where the start has ended sooner. [s]
    #: Axes of the currents that must pass zero before a phase clears; empty: all clear at once. [rad]
    poles: tuple[float, ...] = ()

    @property
    def begins(self) -> float:
        """When, from breaker closing. [s]"""
        return self.supplies[0].begins

    def upon(self, machine: MachineInTime) -> MachineInTime:
        """The motor with what happens to it.

        Parameters
        ----------
        machine : MachineInTime
            As it starts. [pu]
        """
        return replace(machine, supplies=(*machine.supplies, *self.supplies), poles=self.poles)


@dataclass(frozen=True, eq=False)
class EventSimulation(SingleRun):
    """One simulation, with its events."""

    events: EventRun  #: What happened at clearances, field and trip. [SI]

    @property
    def n_steps(self) -> int:
        """Steps of the simulation. [count]"""
        return self.trajectory.n_steps

    @property
    def work(self) -> int:
        """Modes stepped once, all steps together. [count]"""
        return self.events.work


def run_event_start(
    case: CaseData,
    modal: ModalTrain,
    effects: StartEffects,
    linear: Start | None = None,
    event: EventTorques | StartEvent | None = None,
) -> Start:
    """Calculate a start with clearances, lateral motion, field application or trip, or an event in operation or in it.

    `modal` has all teeth in contact. The linear start of the same case gives the scale of each torque; it
    is calculated if it is not given, that of an event always is. Raises `ModelError` if the train cannot turn or has no motor, or an
    effect lacks its data.
    """
    train = modal.train
    if linear is None and has_start(case):
        linear = run_start(case, modal, replace(effects, clearances=()))
    elif linear is None:
        linear = run_prescribed(case, modal)
    tolerance = case.tolerance_peak or DEFAULT_TOLERANCE_PEAK
    setup = _set_up(case, modal, effects, linear, tolerance, event)
    model, step = setup.model, setup.step
    most_work = HOPELESS_WORK if linear.gave_up else MOST_WORK

    def at(h: float, most: float, times: int = 0) -> EventSimulation:
        changed = _changed(model, times) if times else model
        return _simulated(replace(setup, model=changed), h, tolerance, most)

    coarse = _light(at(step, FIRST_SHARE * most_work))
    # where the coarser one was stopped, this one is, too: as far as it comes with as much work
    stopped = coarse.events.gave_up
    fine = at(0.5 * step, coarse.work if stopped else most_work - coarse.work)
    gave_up = stopped or fine.events.gave_up
    halvings, repeatability, taken, last = 0, None, coarse.work + fine.work, False
    runs: list[EventSimulation] = []
    further: list[tuple[int, float]] = []
    first, first_step, had_parted = coarse, step, False
    steady = False  # whether a billionth more torque was seen to change nothing
    while True:
        same_until = _together_until(coarse.events, fine.events, TOGETHER * step)
        judging = partial(
            judge_run,
            train,
            setup.truncation,
            fine,
            coarse,
            with_impacts=bool(model.pieces.basis.flanks),
            guard_share=SAME_CONTACTS_SHARE,
            same_until=same_until,
        )
        judged, finer_by = judging(), fine.n_steps / coarse.n_steps
        if finer_by < HALVED and not model.pieces.basis.flanks:
            judged = judging(least_change=judged.change / max(finer_by - 1.0, 0.1))
        error = judged.estimated_error
        met = error <= tolerance and not gave_up
        values = fine.n_steps * len(setup.truncation)
        next_work = fine.work * max(2.0, fine.work / coarse.work)
        enough = 0.5 * (most_work - taken)  # the other half is for an ensemble
        last |= halvings >= MAX_HALVINGS or 2 * values > MAX_VALUES or next_work > enough
        if gave_up:
            break  # a finer run would only give up sooner
        # h and h/2 may agree by chance where they part: only runs that are together have an order
        parted = same_until < math.inf
        had_parted |= parted
        repeat = False
        if parted and (met or last or halvings):
            runs, further, felt, hopeless = [fine, coarse], [], False, False
            if not (last or steady):
                further = [(1, 0.5 * step)]
                other = _light(at(0.5 * step, most_work - taken, 1))
                taken += other.work
                runs.append(other)
                felt = _spread(fine, other, judged.output_of_element) > FELT * tolerance
                hopeless = _together_until(fine.events, other.events, TOGETHER * step) < math.inf
                steady = not (felt or hopeless)
            # no step is fine enough to keep runs together
            repeat = (met and hopeless) or last or felt
        elif had_parted and met and not (further or steady):
            # runs that are together may still be far from one of other torques: the longest step tells
            runs, other = [fine, coarse], _light(at(first_step, most_work - taken, 1))
            taken += other.work
            repeat = _spread(first, other, judged.output_of_element) > FELT * tolerance
        if repeat:
            for k, h in _variations(step):
                if coarse.work > most_work - taken:
                    break
                further.append((k, h))
                runs.append(_light(at(h, most_work - taken, k)))
                taken += runs[-1].work
            runs = [run for run in runs if not run.events.gave_up]
            counted = {index for index, _ in judged_shafts(case)}
            repeatability = _repeatability(runs, TOGETHER * step, judged, tolerance, counted)
            repeatability = replace(repeatability, further=tuple(further))
            break
        if last or (met and (not parted or _over_before(coarse, fine, judged, same_until))):
            break
        finer = at(0.25 * step, enough)
        taken += finer.work
        if finer.events.gave_up:  # it took more than was expected: the two before it stand
            last = True
            continue
        halvings += 1
        step *= 0.5
        coarse, fine = _light(fine), finer
    run = replace(fine.events, gave_up=gave_up)
    pull_in = _pull_in(run, case)
    if repeatability is not None:
        judged = judged.repeated_in(repeatability.extremes)
        met = met and not repeatability.sensitive
    return Start(
        **vars(judged),
        outcome=_outcome(run, case, linear, pull_in, fine.end),
        runup=linear.runup,
        step=0.5 * step,
        halvings=halvings,
        kept_modes=len(model.pieces.basis.closed_omega),
        method=Method.EXPONENTIAL,
        met_tolerance=met,
        uncoupled_dampers=setup.uncoupled_dampers,
        contacts=contact_records(
            model, run, fine.turning, fine.end, [r.events for r in runs[1:] or [coarse]]
        ),
        bearing_forces=bearing_forces(train, run),
        pull_in=pull_in,
        repeatability=repeatability,
        left_out=None if setup.drops_modes else 0.0,
        forces=force_histories(train, run),
        load_angle=None if pull_in is None else 0.5 * run.phase[0],
        machines=_machine_torques(
            model,
            fine.events,
            coarse.events,
            min((p.relative_error for p in judged.peaks), default=LEAST_PEAK_ERROR),
        ),
        gave_up=gave_up,
    )


def one_run(
    case: CaseData,
    modal: ModalTrain,
    effects: StartEffects,
    linear: Start,
    step: float | None,
    event: EventTorques | StartEvent | None = None,
) -> EventSimulation:
    """One simulation of a start with events, or of an event in operation, without any estimate of its error.

    Parameters
    ----------
    case : CaseData
        The case. [SI]
    modal : ModalTrain
        Its train, all teeth in contact. [SI]
    effects : StartEffects
        What is simulated. [flags]
    linear : Start
        The linear start. [SI]
    step : float or None
        Longest step; None = that of the first, coarsest run. [s]
    event : EventTorques or StartEvent, optional
        The event in operation, or in the start. [N m]

    Returns
    -------
    EventSimulation
        The run. [SI]
    """
    tolerance = case.tolerance_peak or DEFAULT_TOLERANCE_PEAK
    setup = _set_up(case, modal, effects, linear, tolerance, event)
    return _simulated(setup, step or setup.step, tolerance, MOST_ALONE)


def run_again(
    case: CaseData,
    modal: ModalTrain,
    effects: StartEffects,
    linear: Start,
    variations: Sequence[tuple[int, float]],
) -> int:
    """Simulate further runs of an ensemble once more, to see what they cost.

    Parameters
    ----------
    case : CaseData
        The case. [SI]
    modal : ModalTrain
        Its train, all teeth in contact. [SI]
    effects : StartEffects
        What is simulated. [flags]
    linear : Start
        The linear start. [SI]
    variations : sequence of (int, float)
        Change of the torques and step of each, as `Repeatability.further` has them. [1e-9, s]

    Returns
    -------
    int
        Steps of all of them together. [count]
    """
    tolerance = case.tolerance_peak or DEFAULT_TOLERANCE_PEAK
    setup = _set_up(case, modal, effects, linear, tolerance)
    steps = 0
    for times, step in variations:
        changed = replace(setup, model=_changed(setup.model, times))
        steps += _simulated(changed, step, tolerance, MOST_WORK).n_steps
    return steps


def _simulated(setup: _Setup, step: float, tolerance: float, most: float) -> EventSimulation:
    # what is not followed shrinks with the step, so that the change from h to h/2 shows it
    seen = replace(setup.model, visible=VISIBLE * tolerance * square(step / setup.step))
    run = simulate_events(
        seen, step, setup.script, setup.initial, settled=setup.settled, most_work=most
    )
    single = SingleRun.until(run.trajectory, float(run.trajectory.time[-1]))
    return EventSimulation(**vars(single), events=replace(run, trajectory=single.trajectory))


@dataclass(frozen=True, eq=False)
class _Setup:
    """What a run is made from."""

    model: EventModel
    script: EventSchedule
    step: float
    truncation: Floats
    drops_modes: bool
    settled: Settled | None
    uncoupled_dampers: tuple[str, ...]
    initial: tuple[Floats, Floats] | None = None


def _set_up(
    case: CaseData,
    modal: ModalTrain,
    effects: StartEffects,
    linear: Start,
    tolerance: float,
    event: EventTorques | StartEvent | None = None,
) -> _Setup:
    if event is None and linear.runup is None:
        event = EventTorques(prescribed_torques(case, modal.train))
    if isinstance(event, EventTorques):
        return _prescribed(case, modal, effects, linear, event)
    return _start(case, modal, effects, linear, tolerance, event)


def _start(
    case: CaseData,
    modal: ModalTrain,
    effects: StartEffects,
    linear: Start,
    tolerance: float,
    event: StartEvent | None = None,
) -> _Setup:
    """A start with its motors."""
    train, settings = modal.train, settings_of(case)
    motors, loads = motors_of(case, train), loads_of(case, train)
    synchronous = case.ratings.synchronous_speed
    assert synchronous is not None
    assert linear.runup is not None
    script = _script(case, effects, settings, synchronous, linear)
    waited = linear.runup
    switched = [v for v in (script.field_speed, script.trip_speed) if v is not None]
    if switched:
        waited = rigid_runup(train, motors, loads, min(min(switched), synchronous))
        script = replace(script, waiting_time=run_length(waited) + LONGEST_SLIP_CYCLE)
    plain = start_model(
        case,
        modal,
        motors,
        loads,
        tolerance,
        script.maximum_time,
        effects,
        events=True,
    )
    model = _event_model(case, modal, plain, effects, linear)
    if effects.motor_transient:
        machines = machines_of_start(case, train, motors, effects, len(plain.curves[2]))
        model = replace(model, machines=machines)
    share = min(tolerance / DEFAULT_TOLERANCE_PEAK, 1.0)
    step = COARSEST_EVENT_ANGLE * math.sqrt(math.sqrt(share)) / plain.pulsation_omega
    if linear.method == Method.EXPONENTIAL:  # Newmark's steps are shorter than these runs need
        first = linear.step * 2.0 ** (linear.halvings + 1)
        # fluxes in time alone make a start cost; runs part at contacts, and instants of an event
        # and of a field are compared by runs at this step alone
        fluxes = effects.motor_transient and not effects.clearances and event is None
        step = first if fluxes else min(first, step)
    judge: Settled | None = _settled_judge(case, waited, motors[0], synchronous)
    if effects.full_length and case.maximum_time:
        judge = None  # asked to go on to MaximumTime although the train has settled
    if event is not None:
        least = event.supplies[-1].begins + event.followed  # it may delay the start so long, too
        script = replace(
            script,
            since=event.begins,
            least_time=least,
            maximum_time=min(script.maximum_time + least, settings.maximum_time or LONGEST_START),
            waiting_time=script.waiting_time + least,
        )
        model = replace(
            model,
            machines=tuple(
                event.upon(machine) if motor.station == event.station else machine
                for motor, machine in zip(motors, model.machines, strict=True)
            ),
        )
    drops = not bool(np.all(plain.keep))
    return _Setup(model, script, step, plain.truncation, drops, judge, plain.uncoupled_dampers)


def _prescribed(
    case: CaseData, modal: ModalTrain, effects: StartEffects, linear: Start, event: EventTorques
) -> _Setup:
    """Prescribed torques alone: every mode that may be is kept, and followed where it rings."""
    train = modal.train
    torques = [*event.torques, *(held(station, torque) for station, torque in event.before)]
    motors = () if event.machine is None else (event.machine[0],)
    acting = [*torques, *event.terms, *motors]
    stations = sorted({a.station for a in acting})
    keep = allowed_modes(modal.modes, effects)
    basis = _basis(case, modal, effects, keep)
    rows = np.flatnonzero(train.viscous > 0.0)
    nodes = np.flatnonzero(train.node_damping > 0.0)
    places = ForceLocations(
        np.concatenate([stations, nodes]).astype(np.int64),
        rows,
        len(stations),
        np.concatenate([train.node_damping[nodes], train.viscous[rows]]),
    )
    mean = basis.vectors[train.node_dof[0]] * train.node_scale[0] / train.speed_ratio[0]
    none = np.zeros((len(motors), len(mean)))  # no curve is read
    pieces = ContactSystems(basis, places, mean, none, _scale(train, linear))
    step = linear.step * 2.0 ** (linear.halvings + 1)
    arrays = machine_arrays(case, motors, (), torques, stations)
    if event.machine is not None:
        # the train stands still where it runs as before the event: the phase changes by its slip and its vibration
        line = event.machine[1].machine.line_omega
        slipping = np.full(len(motors), (1.0 - event.speed) * line)
        arrays["motors"] = (*arrays["motors"][:5], slipping, arrays["motors"][6])
        arrays["machines"] = (event.machine[1],)
        arrays["frame"] = event.speed * line
    model = EventModel(
        pieces=pieces,
        **arrays,
        sampled=COARSEST_EVENT_ANGLE / step,
        limited=effects.contact_law == ContactLaw.LIMITED,
        tones=as_the_loop_takes_them(event.terms, stations),
    )
    script = EventSchedule(maximum_time=linear.outcome.time, keep_all=keeps_history(case))
    drops = not bool(np.all(keep))
    force = np.zeros(places.n_forces)
    for station, torque in [*event.before, *((m.station, event.held) for m in motors)]:
        force[stations.index(station)] += torque
    return _Setup(
        model, script, step, np.zeros(len(pieces.output_element)), drops, None, (),
        _twisted_by(pieces, force) if np.any(force) else None,
    )  # fmt: skip


def _twisted_by(pieces: ContactSystems, force: Floats) -> tuple[Floats, Floats]:
    """The train in equilibrium under constant torques, its drive flanks loaded, in the common basis."""
    n_flanks = len(pieces.basis.flanks)
    closed = pieces.pieces[pieces.index_of([DRIVE] * n_flanks + [FREE] * n_flanks)]
    elastic = closed.stiffness > 0.0
    pushed = product(closed.reach[:, : len(force)], force)
    twist = np.where(elastic, pushed / np.where(elastic, closed.stiffness, 1.0), 0.0)
    return np.asarray(product(closed.turn, twist)), np.zeros(len(twist))


def _script(
    case: CaseData,
    effects: StartEffects,
    settings: StartSettings,
    synchronous: float,
    linear: Start,
) -> EventSchedule:
    """What the run waits for."""
    longest = settings.maximum_time or LONGEST_START
    ramps = tuple(row.ramp_time or 0.0 for row in case.soft_starts.values())
    end_speed: float | None = settings.end_speed
    field_speed = trip_speed = None
    if effects.pull_in:
        if case.field_slip is None or case.pull_out_torque is None:
            raise ModelError("Pull-in needs FieldSlip and PullOutTorque. Type both on sheet Case.")
        field_speed, end_speed = (1.0 - case.field_slip) * synchronous, None
    if effects.aborted_start:
        if case.trip_speed is None:
            raise ModelError("An aborted start needs TripSpeed. Type it on sheet Case.")
        trip_speed = case.trip_speed
        if field_speed is None:
            end_speed = None
    if effects.full_length or effects.pull_in or effects.aborted_start:
        maximum = longest
    elif effects.motor_transient:  # its mean torque is not that of the curves
        waited = max(ramps, default=0.0)  # until a soft starter has the train break away
        maximum = min(2.0 * linear.outcome.time + waited + 1.0, longest)
    elif linear.outcome.outcome in (Outcome.REACHED, Outcome.TIME_OUT):
        maximum = min(1.2 * linear.outcome.time + 1.0, longest)
    else:  # where the plain start settled below its end speed, so does this one
        maximum = linear.outcome.time
    return EventSchedule(
        maximum_time=maximum,
        end_speed=end_speed,
        field_speed=field_speed,
        field_angle=case.field_angle,
        trip_speed=trip_speed,
        coast_end=COAST_END * synchronous,
        coast_time=COAST_TIME,
        switch_speeds=case.switch_over_speeds if effects.switch_over else (),
        open_times=tuple(
            {case.motor_stations.index(name): time for name, time in opened.items()}
            for opened in case.open_times
        ),
        look_every=LOOK_EVERY,
        stops=ramps if effects.motor_transient else (),
        keep_all=keeps_history(case),
    )


def _basis(case: CaseData, modal: ModalTrain, effects: StartEffects, keep: Mask) -> SharedBasis:
    """The basis of the pieces that the clearances of a plan make."""
    train, modes = modal.train, modal.modes
    flanks = [f for f in clearances_of(train) if train.elements[f.element] in effects.clearances]
    stated = stated_damping(case, modes)
    return shared_basis(train, modes, flanks, keep, stated, case.damping_ratio or 0.0)


def _event_model(
    case: CaseData, modal: ModalTrain, plain: StartModel, effects: StartEffects, linear: Start
) -> EventModel:
    """The arrays of a plain start with clearances in them."""
    basis = _basis(case, modal, effects, plain.keep)
    first = int(plain.dampers[0][0]) if len(plain.dampers[0]) else len(plain.force_nodes)
    places = ForceLocations(plain.force_nodes, plain.damper_rows, first, plain.dampers[1])
    mean = np.zeros(basis.vectors.shape[1])
    mean[: len(plain.mean_speed)] = plain.mean_speed
    read = np.zeros((len(plain.phase), len(mean)))
    rows = read_speed(case, effects, common_reach(basis, places), plain.motors[0], basis.n_rigid)
    read[:, : rows.shape[1]] = rows
    pieces = ContactSystems(basis, places, mean, read, _scale(modal.train, linear), plain.swings)
    return EventModel(
        **{field.name: getattr(plain, field.name) for field in fields(Machines)},
        pieces=pieces,
        sampled=plain.pulsation_omega,
        limited=effects.contact_law == ContactLaw.LIMITED,
    )


def _machine_torques(
    model: EventModel, fine: EventRun, coarse: EventRun, least: float
) -> tuple[MachineTorque, ...]:
    """Torques of motors in time; the error is the change of both extremes: one alone may agree by chance.

    Both may, too: no error is below that of the element known best, `least`. [1]
    """
    torques = []
    for k, (force, phase) in enumerate(zip(model.motors[0], fine.phase, strict=False)):
        if k == len(model.machines):
            break
        ends = fine.air_gap_extremes[k]
        largest, when = ends[int(np.argmax(np.abs(ends[:, 0])))]
        change = float(np.max(np.abs(ends[:, 0] - coarse.air_gap_extremes[k, :, 0])))
        station = int(model.pieces.places.nodes[force])
        error = max(change / (abs(largest) or 1.0), least)
        torques.append(
            MachineTorque(
                station, float(largest), float(when), error, fine.air_gap[k, 0], 0.5 * phase
            )
        )
    return tuple(torques)


def _scale(train: Train, linear: Start) -> Floats:
    """Torque scale of each output: the largest torque of its element in the linear start."""
    scale_of = {p.element: p.size for p in linear.peaks}
    scale = np.array([scale_of.get(train.elements[e], 0.0) for e in train.output_element])
    floor = NEGLIGIBLE * float(np.max(scale, initial=0.0))
    return np.asarray(np.maximum(scale, floor if floor > 0.0 else 1.0))


def _together_until(coarse: EventRun, fine: EventRun, apart: float) -> float:
    """Until when two runs were together: the same changes of contact at each clearance, no more than so
    much apart. [s]"""
    until = math.inf
    for clearance in distinct(coarse.log[:, 1], fine.log[:, 1]):
        logs = [log[log[:, 1] == clearance] for log in (coarse.log, fine.log)]
        n = min(map(len, logs))
        a, b = (log[:n] for log in logs)
        differing = np.any(a[:, 2:4] != b[:, 2:4], axis=1) | (np.abs(a[:, 0] - b[:, 0]) > apart)
        first = int(np.argmax(differing)) if differing.any() else n
        until = min([until, *(float(log[first, 0]) for log in logs if first < len(log))])
    return until


def _over_before(
    coarse: EventSimulation, fine: EventSimulation, judged: JudgedRun, until: float
) -> bool:
    """Whether the peaks come before two runs went different ways: what comes after is far smaller in both."""
    element_of = fine.trajectory.output_element
    elements = np.flatnonzero(judged.output_of_element >= 0)
    return not any(
        _largest(run, np.flatnonzero(element_of == element), sign, until, math.inf)
        > FAR_SMALLER * extreme
        for element, peak in zip(elements, judged.peaks, strict=True)
        for sign, extreme in ((1.0, peak.maximum), (-1.0, -peak.minimum))
        for run in (coarse, fine)
    )


def _light(run: EventSimulation) -> EventSimulation:
    """A run whose turning points are all that is still wanted."""
    none, thin = np.empty((0, 0)), run.without_history()
    events = replace(run.events, trajectory=thin.trajectory, phase=none, bearing=none, air_gap=none)
    return replace(thin, events=events)


def _changed(model: EventModel, times: int) -> EventModel:
    """The same with every torque greater by some billionths."""
    factor = 1.0 + times * TINY
    knots, cubics, counts = model.curves
    force, time, torque, rows = model.timed
    tones = dict(model.tones)
    if tones:
        tones["tone_size"] = tones["tone_size"] * factor
    machines = tuple(m.scaled(factor) for m in model.machines)
    return replace(
        model,
        machines=machines,
        curves=(knots, cubics * factor, counts),
        timed=(force, time, torque * factor, rows),
        tones=tones,
    )


def _spread(fine: EventSimulation, other: EventSimulation, output: Ints) -> float:
    """Largest relative change of the peaks between two runs."""
    spread = 0.0
    judged = [int(i) for i in output if i >= 0]
    size = max((float(np.max(np.abs(other.turning[i][1]))) for i in judged), default=0.0)
    for i in judged:
        a, b = fine.turning[i][1], other.turning[i][1]
        largest = max(float(np.max(np.abs(a))), NEGLIGIBLE * size, 1e-300)
        change = max(abs(float(a.max() - b.max())), abs(float(a.min() - b.min())))
        spread = max(spread, change / largest)
    return spread


def _variations(step: float) -> Iterator[tuple[int, float]]:
    """Change of the torques and step of each further run of an ensemble. [1, s]"""
    for k in range(2, ENSEMBLE - 1):
        yield k, step * (1.0 - STEP_CHANGE * (k - 2))


def _repeatability(
    runs: Sequence[EventSimulation],
    apart: float,
    judged: JudgedRun,
    tolerance: float,
    counted: Set[int],
) -> Repeatability:
    """Intervals of the peaks from an ensemble, the reported run first; histories of elements that are counted.

    Those of the extremes themselves, and of the extremes after the runs have parted (the first change of
    contact that is `apart` [s] in two of them): where these come near the largest torque before, one more
    run may exceed it though none has.
    """
    reported = runs[0]
    parted = min(_together_until(reported.events, r.events, apart) for r in runs[1:])
    element_of = reported.trajectory.output_element
    extremes, spread = [], 0.0
    largest = max((p.size for p in judged.peaks), default=0.0)
    for element, peak in zip(
        np.flatnonzero(judged.output_of_element >= 0), judged.peaks, strict=True
    ):
        own = np.flatnonzero(element_of == element)
        ends = []
        scale = max(peak.size, NEGLIGIBLE * largest, 1e-300)
        for sign in (1.0, -1.0):
            late = np.array([_largest(r, own, sign, parted, math.inf) for r in runs])
            before = np.array([_largest(r, own, sign, -math.inf, parted) for r in runs])
            whole = np.maximum(before, late)
            low, high = prediction_interval(whole)
            low = max(low, 0.0)
            high = max(high, prediction_interval(late)[1])
            extreme = float(whole[0])
            spread = max(spread, (high - extreme) / scale, (extreme - low) / scale)
            ends.append((low, high))
        upper, (shallowest, deepest) = ends
        extremes.append((upper, (-deepest, -shallowest)))
    return Repeatability(
        spread,
        spread > tolerance,
        len(runs),
        tuple(extremes),
        tuple(
            {i: run.turning[i] for i, e in enumerate(element_of.tolist()) if e in counted}
            for run in runs
        ),
    )


def _largest(run: EventSimulation, outputs: Ints, sign: float, since: float, until: float) -> float:
    """Largest value of some outputs within a time, of their negative for a sign of −1; 0 at least. [N m]"""
    found = 0.0
    for i in outputs:
        when, value = run.turning[i]
        inside = (when >= since) & (when < until)
        found = max(found, float(np.max(sign * value[inside], initial=0.0)))
    return found


def _outcome(
    run: EventRun, case: CaseData, linear: Start, pull_in: PullIn | None, end: float
) -> StartOutcome:
    """Name the way the run ended."""
    speed, synchronous = float(run.trajectory.mean_speed[-1]), case.ratings.synchronous_speed
    if linear.runup is None or synchronous is None:
        outcome = replace(linear.outcome, end_speed=speed)
        if run.gave_up:
            text = f"Stopped after {run.trajectory.n_steps} steps at {end:.4g} s."
            outcome = replace(outcome, outcome=Outcome.TIME_OUT, time=end, sentence=text)
        return outcome
    share, rpm = speed / synchronous, speed * 30.0 / math.pi
    if run.gave_up:
        parted = len(run.log) > 0 and not linear.gave_up
        of = "elements with a clearance" if parted else "meshes, bearings and dampers"
        text = (
            f"Time out: stopped after {run.trajectory.n_steps} steps at {end:.4g} s ({share:.1%} "
            f"speed), with {len(run.log)} contact changes. Check stiffness and damping of the {of}."
        )
        return StartOutcome(Outcome.TIME_OUT, end, speed, text)
    if run.trip_time is not None:
        at = float(interp(run.trip_time, run.trajectory.time, run.trajectory.mean_speed))
        return StartOutcome.with_numbers(
            Outcome.TRIPPED,
            end,
            speed,
            trip_share=at / synchronous,
            trip_time=run.trip_time,
            share=share,
            rpm=rpm,
        )
    if pull_in is not None and not (pull_in.synchronised or run.settled):
        text = (
            f"Time out: field applied after {pull_in.field_time:.3f} s at a slip of "
            f"{pull_in.field_slip:.2%}; after {end:.3f} s, at {share:.2%} speed, the motor has "
            "neither pulled in nor clearly failed to. Raise MaximumTime."
        )
        return StartOutcome(Outcome.TIME_OUT, end, speed, text)
    if pull_in is not None:
        return pull_in_outcome(pull_in, end, speed, synchronous)
    if run.waits_for_angle:
        angle = math.degrees(case.field_angle or 0.0)
        text = (
            "Not synchronised: the field was not applied. FieldSlip was reached, but the load "
            f"angle did not come to FieldAngle ({angle:.4g} degrees) by {end:.3f} s, at "
            f"{share:.2%} speed. Change FieldAngle or raise MaximumTime."
        )
        return StartOutcome(Outcome.NOT_SYNCHRONISED, end, speed, text)
    return outcome_of(linear.runup, settings_of(case), run.trajectory, end, synchronous)


def pull_in_outcome(pull_in: PullIn, end: float, speed: float, synchronous: float) -> StartOutcome:
    """Outcome of a run in which the field was applied.

    Parameters
    ----------
    pull_in : PullIn
        What came of it. [SI]
    end, speed : float
        End of the run and mean speed then. [s, rad/s]
    synchronous : float
        Synchronous speed of the reference shaft. [rad/s]

    Returns
    -------
    StartOutcome
        ``synchronised`` or ``not synchronised``. [mixed]
    """
    applied = (
        f"field applied after {pull_in.field_time:.3f} s at a slip of {pull_in.field_slip:.2%}"
    )
    if not pull_in.synchronised:
        return StartOutcome.with_numbers(
            Outcome.NOT_SYNCHRONISED,
            end,
            speed,
            applied=applied,
            pole_slips=pull_in.pole_slips,
            share=speed / synchronous,
        )
    assert pull_in.load_angle is not None
    limit = f"slip below {pull_in.in_step_slip:.1%}"
    in_step = f"{limit} not reached at the end"
    if pull_in.in_step_time is not None:
        in_step = f"in step ({limit}) from {pull_in.in_step_time:.3f} s on"
    swing = "" if pull_in.swing_frequency is None else f", swing {pull_in.swing_frequency:.3g} Hz"
    return StartOutcome.with_numbers(
        Outcome.SYNCHRONISED,
        end,
        speed,
        applied=applied,
        in_step=in_step,
        slips=f"{pull_in.pole_slips} pole slip{'' if pull_in.pole_slips == 1 else 's'}",
        load_angle=math.degrees(pull_in.load_angle),
        swing=swing,
    )


def _settled_judge(case: CaseData, runup: RigidRunup, motor: Motor, synchronous: float) -> Settled:
    """Whether a motor with its field on has settled, in step or surely out of it."""
    period = swing_frequency_linear(
        float(motor.torque_factor(1.0)) * (case.pull_out_torque or 0.0),
        max(float(runup.load[-1]), 0.0),
        runup.inertia,
        motor.pole_pairs,
        float(runup.pulsating[-1]),
    )
    rise = 3.0 * (case.field_time_constant or 0.0)
    target = (1.0 - (case.field_slip or 0.0)) * synchronous

    def settled(time: Floats, phase: Floats, speed: Floats) -> bool:
        slip, angle = 1.0 - speed / synchronous, 0.5 * phase
        since = float(time[int(np.argmax(speed >= target * (1.0 - 1e-9)))])
        if time[-1] - since < rise:
            return False
        if has_settled(time, angle, since + rise, 1.0 / period if period else 1.0):
            return True
        return has_failed(time, angle, slip, since + rise)

    return settled


def _pull_in(run: EventRun, case: CaseData) -> PullIn | None:
    """What came of the field, if it was applied."""
    synchronous = case.ratings.synchronous_speed
    if run.field_time is None or synchronous is None:
        return None
    connected = run.trajectory.time <= (math.inf if run.trip_time is None else run.trip_time)
    t, speed = run.trajectory.time[connected], run.trajectory.mean_speed[connected]
    slip = 1.0 - speed / synchronous
    at = float(interp(run.field_time, t, slip))
    return judge_pull_in(t, 0.5 * run.phase[0][connected], slip, run.field_time, at)
