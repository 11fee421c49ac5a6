"""Events in operation: a fault, or any torque that comes upon a train that runs at synchronous speed.

Before the event the running loads twist the train and the motor balances them. Its equations are linear, so
the torques of the running train stay and the response to the torques of the event is added; the motor's torque
in operation goes on unchanged beside them. Events are those of table `EventTorque`, sums of decaying
harmonics, those of table `MotorEvents`, where the torque follows from the motor's fluxes and its motion, and table
`TorqueTime` where `InitialState` is ``running``. An event is no start and none is counted. One of `MotorEvents` may
begin while the motor starts: it is then a start with the fluxes in time whose supply changes.

Where the torque of an element with a clearance may fall to zero, teeth separate: the response is then simulated contact
by contact, as a start is, from the twisted train.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np

from engine.arrays import Floats
from engine.backlash.event_start import (
    EventSimulation,
    EventTorques,
    clearances_of,
    one_run,
    run_event_start,
)
from engine.backlash.motor_events import (
    MOTOR_FOLLOWED,
    AirGapTorque,
    MotorDrive,
    MotorEvent,
    air_gap_torque_of,
    machine_in_time,
    motor_drive,
    motor_event,
    number,
    start_event,
    with_teeth_apart,
)
from engine.backlash.motor_scan import (
    FOLLOWED,
    Instant,
    WorstInstants,
    answers_of,
    any_instant,
    begins_at_worst_phase,
    worst_instants,
    worst_instants_of,
)
from engine.case.choices import ContactLaw, EffectChoice, ElementKind, TorqueBase
from engine.case.data import CaseData, EventTorqueRow, MotorEventRow
from engine.case.defaults import (
    DEFAULT_LATEST_CLEARING,
    DEFAULT_TOLERANCE_PEAK,
    LONGEST_START,
    NOTABLE_REVERSAL,
)
from engine.case.effect import StartEffects
from engine.case.effects import choice_of
from engine.case.result_words import Outcome
from engine.errors import ModelError
from engine.fatigue.allowable_starts import ShaftFatigue
from engine.model.excitation import transmitted_torque
from engine.model.modal_analysis import ModalAnalysis
from engine.model.modal_train import ModalTrain
from engine.model.motor import motors_of
from engine.model.train import Train
from engine.numerics.distinct import distinct
from engine.numerics.same_bits import hypot, log, modulus
from engine.start.decaying_harmonics import DecayingHarmonic, Tones, decaying_response
from engine.start.pieces import COMPARED_AT, pieces_errors, refined, with_pieces_error
from engine.start.prescribed import (
    Drive,
    follow,
    tabled_drive,
    visible_modes,
)
from engine.start.start import Start, run_start, with_left_out
from engine.start.start_fatigue import starts_of
from engine.start.start_model import FADED
from engine.start.time_response import PrescribedTorque, TimeResponse, tabled_torques
from engine.start.worst_phase import at_phase

#: Largest amplification of a mode when its share of a torque is estimated; no damping is less. [1]
LARGEST_GAIN = 1e3
#: An event is followed so long at the least: a constant torque on a rigid train has no time of its own. [s]
SHORTEST = 0.1
#: A chart shows so much after the last change, with at most so many points (twice as many). [s, count]
DRAWN_AFTER, MOST_DRAWN = 0.3, 1000
#: Peaks are over where the range of every torque in the last part of an event is below this share of all of it; of
#: one that grows, or beats slowly, it is not. [1]
LATE, PEAKS_ARE_OVER = 0.75, 0.9


@dataclass(frozen=True, eq=False)
class EventHistory:
    """Air-gap torque of an event of a motor, and the element with the largest torque, at its beginning."""

    time: Floats  #: From the event on. [s] Shape (n_times,).
    air_gap: Floats  #: Torque of the motor. [N m] Shape (n_times,).
    element: str  #: Which element.
    torque: Floats  #: Its torque. [N m] Shape (n_times,).


@dataclass(frozen=True, eq=False)
class OperatingEvent:
    """An event in operation, and what it does."""

    name: str  #: Its name in `EventTorque`.
    #: Torques from the event on, those of operation included, and speeds over synchronous. None: not
    #: calculated. [SI]
    response: Start | None
    shafts: tuple[ShaftFatigue, ...] = ()  #: Damage of each judged shaft by one such event. [1]
    #: Of each judged shaft, relative error of its damage; None where it has none. [1]
    damage_errors: tuple[tuple[str, float | None], ...] = ()
    air_gap: AirGapTorque | None = None  #: Torque of the motor, in an event of `MotorEvents`. [SI]
    history: EventHistory | None = None  #: Likewise, for a chart. [SI]
    #: Where the worst phase, angle or clearing time was looked for: what was found. Each element has the peaks and
    #: the damage of its own worst instant. [SI]
    worst: WorstInstants | None = None
    #: What a reader must know of it, one sentence of a kind: why it was not calculated, or what was not followed to its
    #: end.
    notes: Mapping[str, str] = field(default_factory=dict)

    @classmethod
    def not_calculated(
        cls, name: str, why: str, air_gap: AirGapTorque | None = None
    ) -> OperatingEvent:
        """An event of which only is known why."""
        note = f"Event '{name}' is not calculated: {why}."
        return cls(name, None, air_gap=air_gap, notes={"not calculated": note})

    @property
    def note(self) -> str:
        """All of them."""
        return " ".join(self.notes.values())

    def without_histories(self) -> OperatingEvent:
        """With peaks and turning points alone: histories are most of the memory, and no table is read from them."""
        if self.response is None:
            return self
        none, response = np.empty((0, 0)), self.response
        trajectory = replace(response.trajectory, torque=none, torque_rate=none)
        repeated = response.repeatability and replace(response.repeatability, histories=())
        return replace(
            self,
            response=replace(
                response, trajectory=trajectory, sections={}, repeatability=repeated, machines=()
            ),
        )


def operating_events(case: CaseData, analysis: ModalAnalysis) -> tuple[OperatingEvent, ...]:
    """Every event in operation of a case, in the order of its tables.

    Parameters
    ----------
    case : CaseData
        The case. [SI]
    analysis : ModalAnalysis
        Its train: gears on bearings move laterally where their data is given. [SI]

    Returns
    -------
    tuple of OperatingEvent
        Empty where there is none. [SI]
    """
    return tuple(_event(case, analysis, name) for name in case.event_names)


def _event(case: CaseData, analysis: ModalAnalysis, name: str) -> OperatingEvent:
    tolerance = case.tolerance_peak or DEFAULT_TOLERANCE_PEAK
    row = _motor_row(case, name)
    if row is not None and (row.scanned or begins_at_worst_phase(case, row)):
        return _worst_event(case, analysis, row)
    if row is not None and row.in_start is not None:
        return _event_in_start(case, analysis, row)
    if row is None:
        dies_out, why = _length(case, analysis.reported, name, tolerance)
        longest = case.maximum_time or LONGEST_START
    elif words := _unable(case, analysis.reported.train, row):
        return OperatingEvent.not_calculated(name, words)
    else:
        dies_out, why = math.inf, "larger torques may follow"
        longest = case.maximum_time or _followed(row)
    if dies_out > longest and case.maximum_time is None and row is None:
        return OperatingEvent.not_calculated(
            name,
            f"{why}. Type DampingRatio or a Time constant, or MaximumTime to say how long it is to be followed",
        )
    end = min(dies_out, longest)
    pieces: dict[str, float] = {}
    if analysis.rough_reported is not None:
        analysis = refined(case, analysis, partial(_pieces_errors, case, name, end))
        pieces = dict(analysis.pieces_error)
    modal = analysis.reported
    running = transmitted_torque(case, modal.train).element
    left = max((1.0 - FADED) * tolerance - max(pieces.values(), default=0.0), 0.5 * tolerance)
    drive = _drive(case, modal, name)
    response = follow(modal, drive, end, left, running)
    response = _with_errors(response, pieces, tolerance)
    air_gap = air_gap_torque_of(drive) if isinstance(drive, MotorDrive) else None
    notes: dict[str, str] = {}
    if names := list(_separating(modal.train, response)):
        quoted = ", ".join(f"'{element}'" for element in names)
        to_zero = f"it brings the torque of {quoted} to zero, where teeth separate, and"
        if choice_of(case, "backlash") == EffectChoice.OFF:
            notes |= _kept_together(name, names)
        elif idle := [e for e in names if running[modal.train.elements.index(e)] <= 0.0]:
            return OperatingEvent.not_calculated(
                name,
                f"{to_zero} '{idle[0]}' carries no driving torque in operation, so that the flank it begins on is "
                "unknown. Type Running load in table Stations, or force effect backlash off",
            )
        else:
            event = drive.event if isinstance(drive, MotorDrive) else None
            response = _with_clearances(case, modal, name, response, event)
            response = _with_errors(response, pieces, tolerance)
            if air_gap and event:
                air_gap = with_teeth_apart(air_gap, event, response)
            notes |= _stopped(name, response)
    notes |= _without_clearance(case, name, response)
    unbounded = bool(notes)
    if air_gap and air_gap.slipped:
        notes["slips"] = (
            f"Event '{name}' throws the motor out of step (pole pairs slipped within {end:g} s: {air_gap.slipped}). "
            "Its loads keep their torque meanwhile, and no protection trips it."
        )
    if air_gap and air_gap.stalled is not None:
        notes["stalls"] = (
            f"Event '{name}' stalls the motor: after {end:g} s its slip is {100.0 * air_gap.stalled:.3g} %, where it gives less "
            "torque than its loads take. They keep their torque meanwhile, and no protection trips it."
        )
    if dies_out > end:
        over = row is not None and end >= _followed(row) and _falls(response, end)
        if not over:
            until = "MaximumTime, " if case.maximum_time else ""
            notes["followed"] = f"Event '{name}' is followed to {until}{end:g} s: {why}."
        unbounded |= not over
    if unbounded:
        response = with_left_out(response, None, tolerance)
    starts, errors = starts_of(case, response)
    return OperatingEvent(
        name,
        response,
        () if starts is None else starts.shafts,
        errors,
        air_gap,
        _history_of(response, drive, modal.train.elements),
        notes=notes,
    )


def _event_in_start(case: CaseData, analysis: ModalAnalysis, row: MotorEventRow) -> OperatingEvent:
    """An event while the motor starts: the start with its fluxes in time, from the event on."""
    name, modal = str(row.event), analysis.reported
    tolerance = case.tolerance_peak or DEFAULT_TOLERANCE_PEAK
    effects, loose = _effects_of_start(case, modal.train), _loose(modal.train)
    event = start_event(case, modal.train, row)
    try:
        response = run_event_start(case, modal, effects, event=event)
    except ModelError as error:
        words = str(error).rstrip(".")
        return OperatingEvent.not_calculated(name, words)
    response = _with_errors(response, dict(analysis.pieces_error), tolerance)
    notes = _stopped(name, response)
    if effects.clearances != loose and (names := list(_separating(modal.train, response))):
        notes |= _kept_together(name, names)
    notes |= _without_clearance(case, name, response)
    ended = response.outcome
    if ended.outcome in (Outcome.TIME_OUT, Outcome.STALLED) and not response.gave_up:
        notes["followed"] = (
            f"Event '{name}' is followed to {ended.time:.4g} s, by which the start has not ended: larger torques may follow."
        )
    if notes:
        response = with_left_out(response, None, tolerance)
    starts, errors = starts_of(case, response)
    torque = next(m for m in response.machines if m.station == event.station)
    return OperatingEvent(
        name,
        response,
        () if starts is None else starts.shafts,
        errors,
        AirGapTorque(torque.largest, torque.time, torque.error, None, 0, math.inf, None, None),
        _history(
            response,
            torque.torque,
            event.supplies[-1].begins - event.begins,
            modal.train.elements,
        ),
        notes=notes,
    )


def _loose(train: Train) -> tuple[str, ...]:
    """Elements with a clearance."""
    return tuple(train.elements[f.element] for f in clearances_of(train))


def _effects_of_start(case: CaseData, train: Train) -> StartEffects:
    """What a start with an event is simulated with: fluxes in time, and all that the case says of it."""
    pulls_in = case.field_slip is not None and case.pull_out_torque is not None
    return StartEffects(
        clearances=() if choice_of(case, "backlash") == EffectChoice.OFF else _loose(train),
        pull_in=pulls_in and choice_of(case, "pull-in") != EffectChoice.OFF,
        aborted_start=bool(case.trip_speed)
        and choice_of(case, "aborted start") != EffectChoice.OFF,
        coupled_damping=True,
        motor_transient=True,
        switch_over=bool(case.switch_over_speeds),
        contact_law=case.contact_law or ContactLaw.LIMITED,
    )


def _worst_event(case: CaseData, analysis: ModalAnalysis, row: MotorEventRow) -> OperatingEvent:
    """An event of which each element shows its own worst instant, of its torque and of its damage."""
    name, modal = str(row.event), analysis.reported

    def alone(one: Instant) -> OperatingEvent:
        return _event(replace(_case_at(case, one), motor_events=(one.row,)), analysis, name)

    apart = False
    if row.in_start is not None:
        some = alone(any_instant(case, row))
        if some.response is None:
            return some
        apart = bool(some.response.contacts)
        try:
            worst = _worst_in_start(case, modal, row, apart=apart)
        except ModelError as wrong:
            return OperatingEvent.not_calculated(name, str(wrong).rstrip("."))
    elif words := _unable(case, modal.train, any_instant(case, row).row):
        return OperatingEvent.not_calculated(name, words)
    else:
        worst = worst_instants(case, modal, row)
    events: dict[Instant, OperatingEvent] = {}
    for one in worst.instants:
        events[one] = event = alone(one)
        if not apart and event.response is not None and event.response.contacts:
            worst, apart = _worst_apart(case, modal, row, event.response), True
            events = {one: alone(one) for one in worst.instants}
            break
    if lost := next((e for e in events.values() if e.response is None), None):
        return lost
    responses = {instant: e.response for instant, e in events.items() if e.response is not None}
    peaks, shafts, errors = [], [], []
    for element, instant in worst.of_element.items():
        for peak in responses[instant.instant].peaks:
            if peak.element == element:
                missed = 0.0  # of teeth that separate no run at a longer step tells
                if instant.error is not None:
                    missed = instant.error * peak.size + abs(peak.size - instant.largest)
                peaks.append(peak.with_error(missed))
        damaged = worst.of_damage.get(element, instant)
        shafts += [s for s in events[damaged.instant].shafts if s.element == element]
        errors += [
            (e, None if error is None else error + (damaged.error or 0.0))
            for e, error in events[damaged.instant].damage_errors
            if e == element
        ]
    drawn = worst.of_element[worst.element].instant if worst.element else worst.of_motor.instant
    # torques of slipping poles change too fast with the instant to be scanned
    slipping = {
        element
        for element, instant in worst.of_element.items()
        if (gap := events[instant.instant].air_gap)
        and any(p.element == element and p.time > gap.slips_from for p in peaks)
    }
    peaks = [replace(p, left_out=None) if apart or p.element in slipping else p for p in peaks]
    bounds = [None if slipping or apart else r.left_out for r in responses.values()]
    error = max((p.relative_error for p in peaks), default=0.0)
    response = replace(
        responses[drawn],
        peaks=tuple(peaks),
        estimated_error=error,
        left_out=None if None in bounds else max(b for b in bounds if b is not None),
        met_tolerance=all(r.met_tolerance for r in responses.values())
        and error <= (case.tolerance_peak or DEFAULT_TOLERANCE_PEAK)
        and not (slipping or apart),
    )
    air_gap = events[worst.of_motor.instant].air_gap
    if air_gap is not None and worst.of_motor.error is not None:
        missed = worst.of_motor.error + abs(abs(air_gap.largest) - worst.of_motor.largest) / (
            abs(air_gap.largest) or 1.0
        )
        air_gap = replace(air_gap, error=air_gap.error + missed)
    notes: dict[str, str] = {}
    for event in (events[drawn], *events.values()):
        for kind, note in event.notes.items():
            notes.setdefault(kind, note)
    if slipping:
        quoted = ", ".join(f"'{element}'" for element in sorted(slipping))
        notes["scan slips"] = (
            f"Event '{name}' slips poles before the largest torque of {quoted}: at another instant it may be larger."
        )
    if apart:
        notes["scan apart"] = (
            f"Event '{name}' separates teeth: it was simulated so at some instants, of which the worst is shown; torques at "
            "another one may be larger."
        )
    return OperatingEvent(
        name, response, tuple(shafts), tuple(errors), air_gap, events[drawn].history, worst,
        notes,
    )  # fmt: skip


def _with_errors(response: Start, pieces: Mapping[str, float], tolerance: float) -> Start:
    """The response with errors that cover the pieces of shafts and what comes after its end.

    That has faded to a share `FADED` of the tolerance.
    """
    response, faded = with_pieces_error(response, pieces, tolerance), FADED * tolerance
    peaks = tuple(p.with_error(faded * p.size) for p in response.peaks)
    return replace(response, peaks=peaks, estimated_error=response.estimated_error + faded)


def _history_of(response: Start, drive: Drive, elements: Sequence[str]) -> EventHistory | None:
    if not isinstance(drive, MotorDrive):
        return None
    machines = response.machines
    air_gap = machines[0].torque if machines else drive.motions[-1].torque
    return _history(response, air_gap, drive.event.last_change, elements)


def _history(
    response: Start, air_gap: Floats, last_change: float, elements: Sequence[str]
) -> EventHistory | None:
    """What a chart shows of an event of a motor: until a little after the last change of its supply."""
    if not response.peaks:
        return None
    name = max(response.peaks, key=lambda p: p.size).element
    output = response.output_of_element[elements.index(name)]
    time, torque = response.trajectory.time, response.trajectory.torque[output]
    last = int(np.searchsorted(time, last_change + DRAWN_AFTER, "right"))
    drawn = slice(0, last, max(last // MOST_DRAWN, 1))
    return EventHistory(time[drawn], air_gap[drawn], name, torque[drawn])


def _pieces_errors(
    case: CaseData, name: str, end: float, analysis: ModalAnalysis
) -> dict[str, float]:
    """Relative error of the torque of each element from the pieces of distributed shafts."""
    assert analysis.rough_reported is not None
    fine, rough = (
        follow(
            modal,
            _drive(case, modal, name),
            end,
            COMPARED_AT,
            transmitted_torque(case, modal.train).element,
        )
        for modal in (analysis.reported, analysis.rough_reported)
    )
    return pieces_errors(case, fine, rough)


def _reversing(case: CaseData, response: Start) -> Iterator[str]:
    """Meshes and geared couplings of which no clearance is given and whose torque may reverse."""
    toothed = {m.element for m in case.meshes}
    toothed |= {e.element for e in case.elements if e.kind == ElementKind.GEAR_MESH}
    given = {
        m.element for m in case.meshes if m.backlash is not None or m.angular_backlash is not None
    }
    for p in response.peaks:
        if p.element in toothed - given and p.extremes[1][0] < -NOTABLE_REVERSAL * p.size:
            yield f"'{p.element}'"


def _kept_together(name: str, elements: Sequence[str]) -> dict[str, str]:
    quoted = ", ".join(f"'{element}'" for element in elements)
    note = f"Event '{name}' brings the torque of {quoted} to zero, but teeth stay together, since backlash is forced off."
    return {"together": note}


def _stopped(name: str, response: Start) -> dict[str, str]:
    if not response.gave_up:
        return {}
    until = f"{response.outcome.time:.3g} s: it takes too many steps"
    return {"stopped": f"Event '{name}' with separating teeth was stopped after {until}."}


def _without_clearance(case: CaseData, name: str, response: Start) -> dict[str, str]:
    reversing = ", ".join(_reversing(case, response))
    if not reversing:
        return {}
    note = (
        f"Event '{name}' reverses the torque of {reversing}, but teeth stay together, since no clearance is given. "
        "Type Backlash or Angular backlash in table Meshes, 0 where there is none."
    )
    return {"no clearance": note}


def _separating(train: Train, response: Start) -> Iterator[str]:
    """Elements with a clearance whose torque may fall to zero."""
    lowest = {p.element: p.extremes[1][0] for p in response.peaks}
    for flank in train.flanks:
        name = train.elements[flank.element]
        if flank.gap and lowest[name] <= 0.0:
            yield name


def _with_clearances(
    case: CaseData, modal: ModalTrain, name: str, linear: Start, motor: MotorEvent | None
) -> Start:
    """The response with teeth that separate, from the drive flanks on which the running train has them."""
    effects, event = _apart(case, modal, name, motor)
    return run_event_start(case, modal, effects, linear, event)


def _apart(
    case: CaseData, modal: ModalTrain, name: str, motor: MotorEvent | None
) -> tuple[StartEffects, EventTorques]:
    """What an event with teeth that separate is simulated with."""
    train = modal.train
    effects = StartEffects(
        clearances=tuple(train.elements[f.element] for f in clearances_of(train)),
        contact_law=case.contact_law or ContactLaw.LIMITED,
    )
    transmitted = transmitted_torque(case, train)
    net = transmitted.motor - transmitted.load
    if motor is not None:
        net[motor.station] -= motor.held  # its fluxes give it
    before = [(i, float(net[i])) for i in np.flatnonzero(net).tolist()]
    if motor is not None:
        held = 0.0 if motor.released else motor.held
        return effects, EventTorques((), (), before, machine_in_time(motor), held, 1.0 - motor.slip)
    return effects, EventTorques(*_torques(case, train, name), before)


def _worst_apart(
    case: CaseData, modal: ModalTrain, row: MotorEventRow, response: Start
) -> WorstInstants:
    """The worst instants with teeth that separate; `response` is the event at one of them."""
    train, latest = modal.train, row.latest_clearing or DEFAULT_LATEST_CLEARING
    last = latest if "clears_after" in row.scanned else number(row.clears_after) or 0.0
    end = min(last + FOLLOWED, response.outcome.time)
    scale = replace(response, outcome=replace(response.outcome, time=end))

    def answers(instant: Instant) -> Floats:
        effects, event = _apart(case, modal, str(row.event), motor_event(case, train, instant.row))
        return _answers(case, train, one_run(case, modal, effects, scale, None, event), 0)

    return worst_instants_of(case, train, row, answers, apart=True)


def _worst_in_start(
    case: CaseData, modal: ModalTrain, row: MotorEventRow, *, apart: bool
) -> WorstInstants:
    """The worst instants of an event in the start, each a start of its own."""
    train, effects = modal.train, _effects_of_start(case, modal.train)
    first = _case_at(case, any_instant(case, row))
    linear = run_start(first, modal, replace(effects, clearances=()))  # the scale of each torque

    def answers(instant: Instant) -> Floats:
        event = start_event(case, train, instant.row)
        run = one_run(_case_at(case, instant), modal, effects, linear, None, event)
        motor = [m.station for m in motors_of(case, train)].index(event.station)
        return _answers(case, train, run, motor)

    return worst_instants_of(case, train, row, answers, apart=apart)


def _case_at(case: CaseData, instant: Instant) -> CaseData:
    """The case with the phase of the pulsation of one combination."""
    if instant.pulsation is None:
        return CaseData(**vars(case))
    return at_phase(case, instant.pulsation)


def _answers(case: CaseData, train: Train, run: EventSimulation, motor: int) -> Floats:
    """What a combination answers that was simulated by itself."""
    values = (torque for _, torque in run.turning)
    histories = zip(run.trajectory.output_element.tolist(), values, strict=True)
    air_gap = float(np.max(np.abs(run.events.air_gap_extremes[motor, :, 0])))
    return answers_of(case, train, histories, air_gap)


# --- torques ----------------------------------------------------------------------------------------


def _rows(case: CaseData, name: str) -> list[EventTorqueRow]:
    """Terms of an event; none of the one that is table `TorqueTime`."""
    return [row for row in case.event_torque if row.event == name]


def _torques(
    case: CaseData, train: Train, name: str
) -> tuple[list[PrescribedTorque], list[DecayingHarmonic]]:
    """Torques of an event: those of a table, or decaying harmonics."""
    terms = [_term(case, train, row) for row in _rows(case, name)]
    return [] if terms else tabled_torques(case.torque_time, train), terms


def _motor_row(case: CaseData, name: str) -> MotorEventRow | None:
    """The row of table `MotorEvents` that an event is; None: it is one of the other tables."""
    return next((row for row in case.motor_events if row.event == name), None)


def _unable(case: CaseData, train: Train, row: MotorEventRow) -> str:
    """Why a motor does not run as its event supposes; empty where it does."""
    try:
        motor_event(case, train, row)
    except ModelError as error:
        return f"the motor at '{row.station}' {error}"
    return ""


def _drive(case: CaseData, modal: ModalTrain, name: str) -> Drive:
    if row := _motor_row(case, name):
        return motor_drive(modal, motor_event(case, modal.train, row))
    tabled, terms = _torques(case, modal.train, name)
    return harmonic_drive(modal, Tones.of(terms)) if terms else tabled_drive(modal, tabled)


def _term(case: CaseData, train: Train, row: EventTorqueRow) -> DecayingHarmonic:
    """One row of `EventTorque`: rated torque, or apparent power, at the speed of its station is what its amplitude is a
    share of."""
    station = train.stations.index(str(row.station))
    base = case.ratings.rated_torque or 0.0
    if row.base == TorqueBase.APPARENT_POWER:
        (motor,) = (m for m in case.motor_data if m.station == row.station)
        base = (motor.base_power(case.ratings.rated_power) or 0.0) / (
            case.ratings.synchronous_speed or 1.0
        )
    base /= float(train.speed_ratio[station])
    line_omega = 2.0 * math.pi * (case.ratings.line_frequency or 0.0)
    return DecayingHarmonic(
        station,
        (row.amplitude or 0.0) * base,
        row.phase or 0.0,
        (row.multiple or 0.0) * line_omega,
        1.0 / row.time_constant if row.time_constant else 0.0,
    )


def harmonic_drive(modal: ModalTrain, tones: Tones) -> Drive:
    """Decaying harmonic torques; each mode counts with its amplification.

    Parameters
    ----------
    modal : ModalTrain
        The train. [SI]
    tones : Tones
        The torques. [N m]

    Returns
    -------
    Drive
        For `follow`. [SI]
    """
    train, modes, damping = modal
    driven, s = modulus(tones.on_modes(train, modes)), tones.exponent
    omega = np.where(modes.omega > 0.0, modes.omega, 1.0)[:, None]
    rate, real, imag = damping.rate[:, None], s.real, s.imag
    # |1 + (d s + s²) / ω²|, which is one over the amplification
    apart = hypot(
        1.0 + (rate * real + real * real - imag * imag) / (omega * omega),
        (rate * imag + 2.0 * real * imag) / (omega * omega),
    )
    gain = 1.0 / np.maximum(apart, 1.0 / LARGEST_GAIN)

    def respond(end: float, count: int, kept: np.ndarray) -> TimeResponse:
        return decaying_response(
            train, modes, tones, end, count, damping_ratio=damping.structural, kept=kept
        )

    return Drive(
        tones.stations,
        (driven * gain).sum(axis=1),
        (driven * (1.0 + modulus(s) / omega)).sum(axis=1),
        float(np.max(s.imag, initial=0.0)) / (2.0 * math.pi),
        respond,
    )


# --- how long ---------------------------------------------------------------------------------------


def _followed(row: MotorEventRow) -> float:
    """How long a motor is followed where nothing ends it sooner. [s]"""
    return (number(row.clears_after) or 0.0) + MOTOR_FOLLOWED


def _falls(response: Start, end: float) -> bool:
    """Whether what still moves at the end is so far below the peaks that none can follow."""
    for when, value in response.turning_of_element().values():
        late = value[when >= LATE * end]
        if len(late) and np.ptp(late) > PEAKS_ARE_OVER * np.ptp(value):
            return False
    return True


def _length(case: CaseData, modal: ModalTrain, name: str, tolerance: float) -> tuple[float, str]:
    """Time after which nothing new comes, and what takes longest, in words. [s]

    All that decays, torques and modes, has faded to a share `FADED` of the tolerance by then. Torques that do not
    decay go on: the longest beat between them is added.
    """
    rows = _rows(case, name)
    begins = 0.0 if rows else max(float(row.time or 0.0) for row in case.torque_time)
    rates = [
        (1.0 / r.time_constant, "a torque that decays slowly") for r in rows if r.time_constant
    ]
    train, modes, damping = modal
    drive = _drive(case, modal, name)
    visible = visible_modes(train, modes, drive, tolerance) & (modes.omega > 0.0)
    for i in np.flatnonzero(visible).tolist():
        words = f"mode {i - modes.n_rigid + 1} ({modes.frequency[i]:.4g} Hz)"
        rates.append((0.5 * float(damping.rate[i]), words))
    slowest, what = min(rates, default=(math.inf, ""))
    if slowest == 0.0:
        return math.inf, f"{what} has no damping and never dies out"
    fades = begins - float(log(FADED * tolerance)) / slowest
    lasting = [r.multiple or 0.0 for r in rows if not r.time_constant]
    gaps = np.diff(distinct([0.0], lasting)) * (case.ratings.line_frequency or 0.0)
    beat = 1.0 / float(gaps.min()) if len(gaps) else 0.0
    return max(fades + beat, SHORTEST), f"{what} dies out after {fades:.3g} s only"
