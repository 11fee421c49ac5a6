"""One event-driven simulation: from the arrays of a start to sampled histories and a log of events.

Clearances change their contact, the field is applied when the slip has fallen far enough, a motor
trips at a speed: each is located on the exact solution and ends a step there. What is sampled are
the steps themselves, two samples at an event, one before and one after it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from engine.arrays import Floats, Ints, Mask
from engine.backlash.contact_systems import ContactSystems
from engine.backlash.machines import MachineInTime, Machines
from engine.errors import ModelError
from engine.numerics.distinct import distinct
from engine.numerics.same_bits import product
from engine.start.start_model import Machines as Drives
from engine.start.time_response import knots_of
from engine.start.trajectory import KEPT_VALUES, Recorder, Trajectory
from engine.stepping import contact_loop as events
from engine.stepping.library import struct
from engine.stepping.linear_loop import drive_struct, turning_points

#: Whether a run may end: (times, phases, mean speeds) → flag.
Settled = Callable[[Floats, Floats, Floats], bool]
#: Rows of output the compiled loop writes at a time, and events it logs.
ROWS, LOGGED = 2048, 512
#: Work is counted in modes stepped once (0.2 µs each); a change of contact costs as much as so many (52 µs).
#: Measured on twelve trains of 3 to 23 modes.
CONTACT_WORK = 260
#: What the loop takes off a phase now and then. [rad]
TURN = 4.0 * math.pi
#: Work of one simulation at the most, if nothing else is asked.
MOST_ALONE = 100_000_000


@dataclass(frozen=True, eq=False, kw_only=True)
class EventModel(Drives):
    """A start in arrays, with its pieces."""

    pieces: ContactSystems  #: The pieces met so far; more are made as a run comes to them. [SI]
    sampled: float  #: Angular frequency that the base step samples. [rad/s]
    limited: bool  #: True: contact damping never exceeds the spring force.
    visible: float = 0.0  #: Ringing above this share of an answer is followed. [1]
    #: Decaying harmonic torques, as fields of the loop's ``drive_t``. [SI]
    tones: Mapping[str, Any] = field(default_factory=dict)
    #: The first motors as machines in time. [pu, SI]
    machines: tuple[MachineInTime, ...] = ()
    #: Electrical speed at which the train stands still: that of the line in operation. [rad/s]
    frame: float = 0.0

    @property
    def damper_force(self) -> Ints:
        """Force of each damper, those of the flanks last, shape (n_dampers,). [index]"""
        places = self.pieces.places
        return np.arange(places.first_damper, places.n_forces + 2 * len(self.pieces.basis.flanks))


@dataclass(frozen=True)
class EventSchedule:
    """What a run waits for, and what it does then."""

    maximum_time: float  #: When it ends at the latest. [s]
    #: When it ends if neither the field was applied nor the motors have tripped. [s]
    waiting_time: float = math.inf
    end_speed: float | None = None  #: Mean speed at which it ends; None with field or trip. [rad/s]
    #: Mean speed from which the field is applied, and load angle waited for then. [rad/s, rad]
    field_speed: float | None = None
    field_angle: float | None = None  #: Likewise. [rad/s, rad]
    #: Mean speed at which the motors are disconnected, and at which the coast-down ends. [rad/s]
    trip_speed: float | None = None
    coast_end: float | None = None  #: Likewise. [rad/s]
    coast_time: float = math.inf  #: Longest coast-down that is followed. [s]
    switch_speeds: tuple[
        float, ...
    ] = ()  #: Mean speeds at which motors are switched over, rising. [rad/s]
    #: At each of them the motors that are off the line first, and how long. [index, s]
    open_times: tuple[Mapping[int, float], ...] = ()
    look_every: float = math.inf  #: How often `settled` is asked. [s]
    stops: tuple[float, ...] = ()  #: Times at which a step is made to end. [s]
    keep_state: bool = False  #: True: positions and velocities in the common basis are kept, too.
    keep_all: bool = False  #: True: no sample is left out, however much memory that takes.
    #: Samples are kept from then on, and all times count from it. [s]
    since: float = 0.0
    least_time: float = 0.0  #: When it ends at the earliest, the end speed reached or settled. [s]


@dataclass(frozen=True, eq=False)
class EventRun:
    """Sampled histories of one run; two samples share one time at an event. Times count from `since` of its schedule."""

    trajectory: Trajectory  #: Torques and mean speed. [SI]
    phase: Floats  #: Phase of each pulsation, unbroken. [rad] Shape (n_motors, n_times).
    #: Torque of each machine in time and its rate. [N m, N m/s] Shape (n_machines, 2, n_times).
    air_gap: Floats
    #: Its maximum and its minimum, and when. [N m, s] Shape (n_machines, 2, 2).
    air_gap_extremes: Floats
    bearing: Floats  #: Radial force of each gear's bearings. [N] Shape (n_bodies, n_times).
    largest_bearing: Floats  #: Its largest value, and when. [N, s] Shape (n_bodies, 2).
    #: Time, clearance, contact of a flank before and after, its speed. [SI] Shape (n_events, 5).
    log: Floats
    field_time: float | None  #: When the field was applied, when the motors tripped. [s]
    trip_time: float | None  #: Likewise. [s]
    settled: bool  #: True if the run ended because it had settled.
    #: True if it took too much work, or contacts changed without end at one instant: what follows
    #: is missing.
    gave_up: bool
    work: int  #: What it took, in modes stepped once.
    waits_for_angle: bool  #: True if the field was still waiting for its load angle.
    #: In the common basis; without columns unless the script asks for them. [SI] Shape (m,
    #: n_times).
    position: Floats
    velocity: Floats  #: Likewise. [SI] Shape (m, n_times).


class _Recorder:
    """Turns rows of modal states into rows of answers as they come."""

    def __init__(self, model: EventModel, script: EventSchedule) -> None:
        self.model, self.keep_state, self.since = model, script.keep_state, script.since
        self.is_empty = True
        m = model.pieces.basis.vectors.shape[1]
        self.position: list[Floats] = [np.empty((m, 0))]
        self.velocity: list[Floats] = [np.empty((m, 0))]
        self.log: list[Floats] = []
        bodies = len(model.pieces.basis.train.bodies)
        self.largest = np.zeros((bodies, 2))  # bearing force and when
        #: Largest and smallest torque of each machine in time, and when.
        self.air_gap = np.zeros((len(model.machines), 2, 2))
        self._last_air_gap = np.empty((1 + 2 * len(model.machines), 0))
        self._phase = model.phase[:, None]  # last one as the loop has it, and its turns
        self._turns = np.zeros((len(model.phase), 1))
        self._samples = Recorder(
            model.pieces.output_element,
            math.inf if script.keep_state or script.keep_all else KEPT_VALUES,
        )

    def seen(self) -> tuple[Floats, Floats, Floats]:
        """Times, phases of the first motor and mean speeds so far."""
        time, speed, further = self._samples.seen()
        return time, further[0], speed

    def result(self, reached: bool, n_steps: int) -> tuple[Trajectory, Floats, Floats, Floats]:
        """Trajectory, phases, torques of machines in time and bearing forces."""
        trajectory, further = self._samples.trajectory(reached, n_steps)
        n, n_machines = len(self.model.phase), len(self.model.machines)
        phase, air_gap, bearing = np.split(further, [n, n + 2 * n_machines])
        return trajectory, phase, air_gap.reshape(n_machines, 2, further.shape[1]), bearing

    def add(self, rows: dict[str, Any], n: int) -> None:
        """Take n rows."""
        phase = self._unbroken(rows["phase"][:n])
        first = 0
        if self.since:
            first = int(np.searchsorted(rows["t"][:n], self.since * (1.0 - 1e-14)))
            if first == n:
                return
        self.is_empty = False
        kept_rows = slice(first, n)
        torque, rate, bearing = (
            rows[k][:, kept_rows].copy() for k in ("torque", "rate", "bearing")
        )
        if self.keep_state:
            pieces, of_piece = self.model.pieces, rows["piece"][:n]
            for name, kept in (("q", self.position), ("v", self.velocity)):
                whole = np.empty((pieces.basis.vectors.shape[1], n))
                for p in distinct(of_piece):
                    here = of_piece == p
                    whole[:, here] = product(pieces.pieces[int(p)].turn, rows[name][:n][here].T)
                kept.append(whole)
        time = np.maximum(rows["t"][kept_rows] - self.since, 0.0)
        for i, force in enumerate(bearing):
            top = int(np.argmax(force))
            if force[top] > self.largest[i, 0]:
                self.largest[i] = force[top], time[top]
        air_gap = rows["air_gap"][kept_rows].reshape(len(time), 2 * len(self.model.machines)).T
        self._take_extremes(time, air_gap)
        further = np.concatenate([phase[:, first:], air_gap, bearing])
        self._samples.add(time, rows["speed"][kept_rows].copy(), torque, rate, further)

    def _take_extremes(self, time: Floats, air_gap: Floats) -> None:
        """Extremes of the torques of machines, also between rows."""
        t, *torques = np.concatenate([self._last_air_gap, np.vstack([time, air_gap])], axis=1)
        self._last_air_gap = np.vstack([time, air_gap])[:, -1:]
        for k, (torque, rate) in enumerate(zip(torques[::2], torques[1::2], strict=True)):
            when, value = turning_points(t, torque, rate)
            when, value = np.append(when, t[[0, -1]]), np.append(value, torque[[0, -1]])
            for side, sign in enumerate((1.0, -1.0)):
                top = int(np.argmax(sign * value))
                if sign * (value[top] - self.air_gap[k, side, 0]) > 0.0:
                    self.air_gap[k, side] = value[top], when[top]

    def _unbroken(self, phase: Floats) -> Floats:
        """Phases without the jumps of their modulus, shape (n_motors, n)."""
        jumps = np.rint(np.diff(phase.T, axis=1, prepend=self._phase) / TURN)
        turns = self._turns + np.cumsum(jumps, axis=1)
        self._phase, self._turns = phase[-1:].T.copy(), turns[:, -1:]
        return np.asarray(phase.T - TURN * turns)


def simulate_events(
    model: EventModel,
    step: float,
    script: EventSchedule,
    initial: tuple[Floats, Floats] | None = None,
    contact: tuple[int, ...] | None = None,
    settled: Settled | None = None,
    most_work: float = MOST_ALONE,
) -> EventRun:
    """One run at a given longest step.

    Parameters
    ----------
    model : EventModel
        The start in arrays. [SI]
    step : float
        Longest step. [s]
    script : EventSchedule
        What the run waits for. [SI]
    initial : tuple of (ndarray, ndarray), optional
        Position and velocity in the common basis; default rest. [SI]
    contact : tuple of int, optional
        Contact of each flank at the beginning, all drive flanks, then all back flanks; default
        all drive flanks touch. [1]
    settled : callable, optional
        Asked now and then once the field is applied, with time, phase of the first motor and mean
        speed so far: whether the run may end. [flag]
    most_work : float, optional
        Work after which the run is given up, in modes stepped once. [1]

    Returns
    -------
    EventRun
        Sampled histories and log. [SI]

    Raises
    ------
    ModelError
        If damping and stiffness are too far apart for double precision.
    """
    return _Simulation(model, step, script, initial, contact, most_work).run(settled)


class _Simulation:
    """State of a run between calls of the compiled loop."""

    def __init__(
        self,
        model: EventModel,
        step: float,
        script: EventSchedule,
        initial: tuple[Floats, Floats] | None,
        contact: tuple[int, ...] | None,
        most_work: float,
    ) -> None:
        self.model, self.step, self.script, self.most_work = model, step, script, most_work
        pieces = model.pieces
        m = pieces.basis.vectors.shape[1]
        self.contact = np.array(
            contact or [c for c in (events.DRIVE, events.FREE) for _ in pieces.basis.flanks],
            dtype=np.int64,
        )
        q, v = initial or (np.zeros(m), np.zeros(m))
        self.q, self.v = q.copy(), v.copy()
        piece = self._enter()
        n_forces = pieces.common_reach.shape[1]
        self.force, self.rate = np.zeros(n_forces), np.zeros(n_forces)
        self.phase = model.phase.copy()
        stops = self._knots()
        self.clock = struct(
            "clock_t_", fresh=2, base_step=step, visible=model.visible, sampled=model.sampled,
            n_stops=len(stops), stops=stops,
        )  # fmt: skip
        self.electrical: Any = tuple(
            a.copy() if isinstance(a, np.ndarray) else a for a in model.electrical
        )
        self.curves_of = tuple(np.array(a, dtype=np.int64) for a in model.motors[1:3])
        self.switched = 0
        if script.switch_speeds:
            self._connect()
        n_outputs, n_bodies = len(pieces.output_element), len(pieces.basis.train.bodies)
        self._rows: dict[str, Any] = {  # filled again and again
            "t": np.empty(ROWS),
            "speed": np.empty(ROWS),
            "torque": np.empty((n_outputs, ROWS)),
            "rate": np.empty((n_outputs, ROWS)),
            "bearing": np.empty((n_bodies, ROWS)),
            "phase": np.empty((ROWS, len(model.phase))),
            "air_gap": np.empty((ROWS, len(model.machines), 2)),
        }
        self._closes: list[tuple[float, Mask]] = []  #: When drives are on the line again.
        self.machines = Machines(model.machines, model.frame)
        self.machines.switch(0.0, self.phase)
        if script.keep_state:
            self._rows["q"], self._rows["v"] = np.empty((ROWS, m)), np.empty((ROWS, m))
            self._rows["piece"] = np.empty(ROWS, dtype=np.int64)
        self.log = np.empty((LOGGED, 5))
        self.structs = self._structs()
        self.structs[0].piece = piece
        self._known, self._pieces = 0, None  #: So many pieces are in the tables of the loop.
        self.recorder = _Recorder(model, script)
        self.field_time: float | None = None
        self.trip_time: float | None = None
        self._waits_for_angle = False
        self.past_end = False  # the end speed is passed before it may end
        self.steps = self.work = 0
        self.stuck = False

    def _structs(self) -> tuple[Any, ...]:
        """What the loop takes beside clock and pieces."""
        model, rows = self.model, self._rows
        gap, stiffness, damping, scale = model.pieces.contacts
        return (
            struct(
                "flanks_t", gap=gap, stiffness=stiffness, damping=damping, scale=scale,
                limited=model.limited, contact=self.contact,
            ),
            drive_struct(
                model.curves, (model.motors[0], *self.curves_of, *model.motors[3:]), model.loads,
                model.timed, self.electrical, model.tones, self.machines.struct,
            ),
            struct(
                "state_t", q=self.q, v=self.v, phase=self.phase, force=self.force, force_rate=self.rate
            ),
            struct(
                "output_t", rows=ROWS, time=rows["t"], speed=rows["speed"], torque=rows["torque"],
                torque_rate=rows["rate"], bearing=rows["bearing"], phase=rows["phase"],
                air_gap=rows["air_gap"],
                **{name: rows[name] for name in ("q", "v", "piece") if name in rows},
            ),
            struct("log_t", log=self.log, room=LOGGED),
        )  # fmt: skip

    def _enter(self) -> int:
        """Into the piece of the present contacts, from the common basis; its place in the tables."""
        index = self.model.pieces.index_of(self.contact.tolist())
        turn = self.model.pieces.pieces[index].turn
        self.q[:], self.v[:] = product(turn.T, self.q), product(turn.T, self.v)
        return index

    def run(self, settled: Settled | None) -> EventRun:
        """Until what the script waits for, or its end."""
        script = self.script
        end, look = min(script.maximum_time, script.waiting_time), math.inf
        is_settled, reached = False, False
        while self.work <= self.most_work:
            self._await()
            change = min([self.machines.next_change, *(time for time, _ in self._closes)])
            reason = self._advance(min(end, look, change))
            t = self.clock.time
            if reason == events.NEW_PIECE:
                self.structs[0].piece = self._enter()
            elif reason == events.SPEED:
                if not self._at_speed(t):
                    reached = self.trip_time is None
                    if not reached or t >= script.least_time:
                        break
                    self.past_end = True
            elif reason == events.ANGLE:
                self._apply_field(t)
            elif reason == events.TURNED:
                self.machines.turn_field(self.clock.turned, self.phase)
            elif reason == events.STUCK:
                self.stuck = True
                break
            elif reason == events.AT_TIME:
                self.clock.fresh = 2  # a row at the same time begins what follows
                if t >= change * (1.0 - 1e-14):
                    self.machines.switch(change, self.phase)
                    for time, drives in self._closes:
                        self.electrical[8][drives & (time <= change)] = 1.0
                    self._closes = [c for c in self._closes if c[0] > change]
                if t >= end * (1.0 - 1e-14):
                    break
                if t >= look * (1.0 - 1e-14):
                    look = t + script.look_every
                    if settled is not None and t >= script.least_time:
                        is_settled = settled(*self.recorder.seen())
                    if is_settled:
                        break
            if self.trip_time is not None:
                end, look = min(script.maximum_time, self.trip_time + script.coast_time), math.inf
            elif self.field_time is not None:
                end, look = script.maximum_time, min(look, t + script.look_every)
            elif self.past_end:
                end = min(script.maximum_time, script.least_time)
        return self._result(is_settled, reached)

    def _knots(self) -> Floats:
        """Times at which a prescribed torque has a corner."""
        stops = np.array(self.script.stops, dtype=np.float64)
        return np.asarray(distinct(stops, *knots_of(self.model.timed)))

    def _awaited(self) -> dict[str, float]:
        """Mean speeds at which something follows on the way up; of two equal ones the first counts."""
        s = self.script
        speeds = {"trip": s.trip_speed, "end": None if self.past_end else s.end_speed}
        if self.field_time is None and not self._waits_for_angle:
            speeds["field"] = s.field_speed
        if self.switched < len(s.switch_speeds):
            speeds["switch"] = s.switch_speeds[self.switched]
        return {what: speed for what, speed in speeds.items() if speed is not None}

    def _await(self) -> None:
        """Speeds and load angle that the loop stops at now."""
        s = self.script
        up, down, angle = math.inf, -math.inf, math.nan
        if self.trip_time is not None:
            down = s.coast_end if s.coast_end is not None else -math.inf
        else:
            up = min(self._awaited().values(), default=math.inf)
            if self._waits_for_angle and self.field_time is None and s.field_angle is not None:
                angle = s.field_angle - float(self.electrical[7][0])
        self.clock.rising, self.clock.falling, self.clock.angle = up, down, angle

    def _at_speed(self, t: float) -> bool:
        """What follows when a speed is reached; False: the run ends."""
        if self.trip_time is not None:
            return False
        speeds = self._awaited()
        reached = min(speeds, key=speeds.__getitem__)
        if t < self.script.since and reached in ("trip", "end"):
            what = "the motor trips" if reached == "trip" else "the start ends"
            raise ModelError(f"{what} after {t:.4g} s, before it begins. Type a shorter Begins")
        if reached == "trip":
            self.trip_time = t
            self.electrical[8][:] = 0.0
            self._closes = []
            self.machines.trip(self.phase)
            self.clock.fresh = 2
        elif reached == "switch":
            opened = self.script.open_times[self.switched]
            self.switched += 1
            self._connect()
            self.machines.switch_over(t, opened, self.phase)
            force = self.model.motors[0]  # the parts of a pulsation act where their motor does
            for motor, length in opened.items():
                drives = force == force[motor]
                self.electrical[8][drives] = 0.0
                self._closes.append((t + length, drives))
            self.clock.fresh = 2
        elif reached == "field" and self.script.field_angle is not None:
            self._waits_for_angle = True
        elif reached == "field":
            self._apply_field(t)
        return reached != "end"

    def _connect(self) -> None:
        """From here on the motors have the curves of their present connection."""
        for now, then in zip(self.curves_of, self.model.switched[self.switched], strict=True):
            now[:] = then

    def _apply_field(self, t: float) -> None:
        self.field_time = t
        self.electrical[3][:] = t
        self.electrical[8][self.model.of_discharge] = 0.0
        self.machines.apply_field(self.phase)
        self.clock.fresh = 2

    def _advance(self, stop: float) -> int:
        """Call the compiled loop until it has something to say."""
        model, rows = self.model, self._rows
        self.clock.end_time = stop
        if self._known != len(model.pieces.pieces):
            self._known = len(model.pieces.pieces)
            tables = model.pieces.tables(self.step, model.sampled)
            bearings = model.pieces.bearings
            self._pieces = events.pieces_struct(
                tables, model.damper_force, len(self.contact), bearings, model.swings.motor
            )
            events.check_together(self._pieces, *self.structs[:4])
        while True:
            done, logged, reason = events.advance_pieces(self.clock, self._pieces, *self.structs)
            if reason == events.UNSETTLED:
                raise ModelError(
                    f"The torque of a motor and its motion do not settle in a step at {self.clock.time:.4g} s: its "
                    "station is too light for the motor's torque. Check Inertia of the motor's station."
                )
            if reason == events.DIVIDED or not np.all(np.isfinite(self.q)):
                raise ModelError(
                    f"The start with clearances cannot be calculated beyond {self.clock.time:.4g} s: damping "
                    "and stiffness of meshes or bearings are too far apart for double precision. Check "
                    "Mesh damping and Bearing damping in table Meshes."
                )
            if done:
                self.recorder.add(rows, done)
            if logged:
                self.recorder.log.append(self.log[:logged].copy())
            self.steps += done
            self.work += done * len(self.q) + CONTACT_WORK * logged
            if reason != events.MORE or self.work > self.most_work:
                return reason

    def _result(self, settled: bool, reached: bool) -> EventRun:
        r, since = self.recorder, self.script.since
        if r.is_empty:
            raise ModelError(
                f"a start is followed to {self.clock.time:.4g} s at most: it takes too many steps"
            )
        trajectory, phase, air_gap, bearing = r.result(reached, self.steps)
        log = np.concatenate(r.log) if r.log else np.empty((0, 5))
        log[:, 0] -= since
        return EventRun(
            trajectory,
            phase,
            air_gap,
            r.air_gap,
            bearing,
            r.largest,
            log,
            None if self.field_time is None else self.field_time - since,
            None if self.trip_time is None else self.trip_time - since,
            settled,
            self.stuck or self.work > self.most_work,
            self.work,
            self._waits_for_angle and self.field_time is None,
            np.concatenate(r.position, axis=1),
            np.concatenate(r.velocity, axis=1),
        )
