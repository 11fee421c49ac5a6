"""Simulations of a start: one at a given step, or several side by side."""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from engine.arrays import Floats, Ints
from engine.case.choices import Method
from engine.errors import InternalError
from engine.numerics.same_bits import doublings
from engine.start.start_model import Machines, StartModel
from engine.start.time_response import knots_of
from engine.start.trajectory import KEPT_VALUES, Recorder, SingleRun, Trajectory
from engine.stepping import linear_loop as kernels
from engine.stepping.library import struct

#: At least so many steps of histories are taken in one call of the compiled loop.
CHUNK = 4096
#: Turning points of a torque that there is room for at first.
TURNING_ROOM = 2048


@dataclass(frozen=True, eq=False)
class Simulation:
    """What is simulated: a start at one step, until a speed is reached or time is up."""

    model: StartModel  #: The start in arrays. [SI]
    step: float  #: Largest step; shorter ones are used while fast modes ring. [s]
    method: str  #: ``exponential`` or ``newmark``.
    target_speed: float  #: Mean speed of the reference shaft at which to stop. [rad/s]
    maximum_time: float  #: Time at which to stop at the latest. [s]
    #: Torque values whose history is kept; 0 = turning points are all that is wanted, infinite = every sample. [count]
    kept_values: float = 0.0


class _Loop:
    """Starts in the lanes of the compiled loop: one, or `kernels.LANES` of them.

    Lanes without a start repeat the first one and end at once.
    """

    def __init__(self, simulations: Sequence[Simulation]) -> None:
        lanes = 1 if len(simulations) == 1 else kernels.LANES
        self.lanes, self.simulations = lanes, simulations
        filled = [*simulations, *[simulations[0]] * (lanes - len(simulations))]
        models = [s.model for s in filled]
        n, nf = models[0].reach.shape
        n_outputs = len(models[0].outputs.element)
        self.system = kernels.system_struct(
            _beside([m.stiffness for m in models]),
            _beside([m.rate for m in models]),
            _beside([m.reach.T for m in models]),
            _beside([m.mean_speed for m in models]),
            _beside([m.read_speed for m in models]),
            (models[0].dampers[0], _beside([m.dampers[1] for m in models])),
            (models[0].swings.motor, _beside([m.swing for m in models])),
        )
        self.drive = kernels.drive_struct(*_machines_beside(models))
        velocity = [m.outputs.velocity for m in models]
        self.torques = kernels.torques_struct(
            _beside([m.outputs.position for m in models]),
            _beside(velocity) if any(np.any(v) for v in velocity) else None,
            _beside([m.outputs.force for m in models]),
        )
        self.state = struct(
            "state_t", q=np.zeros((n, lanes)), v=np.zeros((n, lanes)),
            phase=_beside([m.phase for m in models]), force=np.zeros((nf, lanes)),
            force_rate=np.zeros((nf, lanes)),
        )  # fmt: skip
        plans = [_step_plan(s.model, s.step, s.maximum_time) for s in simulations]
        plans += [(np.zeros(0, dtype=np.int64), np.zeros(0))] * (lanes - len(simulations))
        most = max(len(counts) for counts, _ in plans)
        counts, steps = np.zeros((lanes, most), dtype=np.int64), np.zeros((lanes, most))
        for lane, (count, length) in enumerate(plans):
            counts[lane, : len(count)], steps[lane, : len(count)] = count, length
        self.reason = np.full(lanes, kernels.MORE, dtype=np.int64)
        self.done = np.ones(lanes, dtype=np.int64)  # the first row is that of rest
        self.plan = struct(
            "stretches_t", newmark=simulations[0].method == Method.NEWMARK, most=most,
            n=np.array([len(c) for c, _ in plans], dtype=np.int64), counts=counts, steps=steps,
            target_speed=np.array([s.target_speed for s in filled]),
            at=np.zeros(lanes, dtype=np.int64), taken=np.zeros(lanes, dtype=np.int64),
            time=np.zeros(lanes), reason=self.reason, done=self.done,
        )  # fmt: skip
        wide = (n_outputs, lanes)
        self.histories = simulations[0].kept_values > 0.0
        self.n_rows = int(counts.sum(axis=1).max()) + 2  # rest, its end
        if self.histories:
            self.n_rows = min(self.n_rows, max(CHUNK, KEPT_VALUES // max(n_outputs, 1)))
        self.count = np.zeros(wide, dtype=np.int64)
        self.ends = {
            name: np.zeros(wide)
            for name in ("last", "last_rate", "before", "before_rate", "largest")
        } | {"last_time": np.zeros(lanes)}
        self.turning = {name: np.empty((*wide, TURNING_ROOM)) for name in ("when", "value")}
        self.rows = self._new_rows()
        self.out = self._samples()
        self.room = kernels.room_for(lanes, self.system, self.drive, self.torques)
        kernels.begin_starts(
            lanes, self.system, self.drive, self.torques, self.state, self.out, self.room
        )

    def _new_rows(self) -> dict[str, Floats]:
        shape = (len(self.count), self.n_rows, self.lanes)
        names = ("torque", "torque_rate") if self.histories else ()
        return {name: np.empty(shape[1:]) for name in ("time", "speed")} | {
            name: np.empty(shape) for name in names
        }

    def _samples(self, done: int = 0) -> Any:
        room = self.turning["when"].shape[-1]
        return struct(
            "samples_t", rows=self.n_rows, next=done, room=room, count=self.count,
            **self.rows, **self.turning, **self.ends,
        )  # fmt: skip

    def advance(self) -> bool:
        """Rows as far as there is room; False once every start has ended."""
        kernels.advance_starts(
            self.lanes, self.plan, self.system, self.drive, self.torques, self.state, self.out,
            self.room,
        )  # fmt: skip
        return bool(np.any(self.reason == kernels.MORE))

    def samples_of(self, lane: int) -> tuple[Floats, ...]:
        """Rows of one lane since there was room, as `Recorder.add` takes them."""
        done, none = int(self.done[lane]), np.empty((0, int(self.done[lane])))
        rows = [of[..., :done, lane] for of in self.rows.values()]
        if self.lanes > 1:  # lest one start keeps the rows of all
            rows = [of.copy() for of in rows]
        return (*rows, none) if self.histories else (*rows, none, none, none)

    def turning_is_full(self) -> bool:
        """Whether it came back for want of room for turning points, not of rows."""
        return bool(self.out.next < self.n_rows)

    def make_room(self) -> None:
        """Room for as many turning points again, or new rows."""
        if not self.turning_is_full():
            self.rows, self.done[:] = self._new_rows(), 0
            self.out = self._samples()
            return
        self.turning = {
            name: np.concatenate([found, np.empty(found.shape)], axis=-1)
            for name, found in self.turning.items()
        }
        self.out = self._samples(self.out.next)


def _beside(arrays: Sequence[Floats]) -> Floats:
    """Arrays of several starts, which become the last axis."""
    beside = np.empty((*arrays[0].shape, len(arrays)))
    for lane, array in enumerate(arrays):
        beside[..., lane] = array
    return beside


def _machines_beside(models: Sequence[Machines]) -> tuple[Any, ...]:
    """Motors, loads and tables of several starts, as `kernels.drive_struct` takes them."""
    first = models[0]

    def beside(name: str, i: int) -> Floats:
        return _beside([getattr(m, name)[i] for m in models])

    def tables(name: str, i: int) -> Any:
        return np.ascontiguousarray(np.stack([getattr(m, name)[i] for m in models]))

    return (
        tuple(tables("curves", i) for i in range(3)),
        (*first.motors[:3], beside("motors", 3), beside("motors", 4),
         beside("motors", 5), first.motors[6]),
        (*first.loads[:2], beside("loads", 2), beside("loads", 3)),
        (first.timed[0], *(tables("timed", i) for i in (1, 2, 3))),
        tuple(
            np.array([m.electrical[2] for m in models], dtype=np.float64) if i == 2
            else beside("electrical", i)
            for i in range(len(first.electrical))
        ),
    )  # fmt: skip


def simulate(
    model: StartModel,
    step: float,
    method: str,
    target_speed: float,
    maximum_time: float,
    *,
    keep_all: bool = False,
) -> Trajectory:
    """One start at a given step, with its histories.

    Parameters
    ----------
    model : StartModel
        The start in arrays. [SI]
    step : float
        Largest step; shorter ones are used while fast modes ring. [s]
    method : str
        ``exponential`` or ``newmark``. [word]
    target_speed : float
        Mean speed of the reference shaft at which to stop. [rad/s]
    maximum_time : float
        Time at which to stop at the latest. [s]
    keep_all : bool, optional
        True: no sample is left out, however much memory that takes. [flag]

    Returns
    -------
    Trajectory
        Times, mean speed and torques. [SI]
    """
    kept = math.inf if keep_all else KEPT_VALUES
    one = Simulation(model, step, method, target_speed, maximum_time, kept)
    loop = _Loop([one])
    (trajectory,) = _to_the_end(loop)
    _refuse_diverged(loop, 0, trajectory)
    turning = tuple(
        (when[0, :n].copy(), value[0, :n].copy())
        for when, value, n in zip(*loop.turning.values(), loop.count[:, 0].tolist(), strict=True)
    )
    return replace(trajectory, turning=turning)


def _to_the_end(loop: _Loop) -> list[Trajectory]:
    """Every start of a loop to its end: samples of each."""
    recorders = [
        Recorder(s.model.outputs.element, s.kept_values or math.inf, turning=False)
        for s in loop.simulations
    ]
    steps, goes_on = np.full(loop.lanes, -1), True  # the first row is that of rest
    while goes_on:
        goes_on = loop.advance()
        if goes_on and loop.turning_is_full():
            loop.make_room()
            continue
        for lane, recorder in enumerate(recorders):
            recorder.add(*loop.samples_of(lane))
        steps += loop.done
        if goes_on:
            loop.make_room()
    return [
        recorder.trajectory(bool(loop.reason[lane] == kernels.SPEED), int(steps[lane]))[0]
        for lane, recorder in enumerate(recorders)
    ]


def _diverged(step: float, time: float) -> str:
    return (
        f"the start diverged before {time:.4g} s at a step of {step:.3g} s: torques "
        "are no longer finite. Check stiffness, damping and torque curves"
    )


def _refuse_diverged(loop: _Loop, lane: int, trajectory: Trajectory) -> None:
    if np.all(np.isfinite(loop.ends["last"][:, lane])):
        return
    finite = np.append(np.all(np.isfinite(trajectory.torque), axis=0), False)
    last = min(int(np.argmin(finite)), len(trajectory.time) - 1) if loop.histories else -1
    raise InternalError(_diverged(loop.simulations[lane].step, trajectory.time[last]))


def form_of(simulation: Simulation) -> tuple[Any, ...]:
    """What starts must have in common to run side by side: the sizes of their arrays, and what acts where."""
    model = simulation.model
    indices = (
        model.motors[0], model.motors[1], model.motors[2], model.motors[6], *model.loads[:2],
        model.timed[0], model.dampers[0],
    )  # fmt: skip
    return (
        simulation.kept_values > 0.0,
        simulation.method, model.reach.shape, model.read_speed.shape, model.swing.shape, model.outputs.position.shape,
        model.curves[0].shape, model.timed[1].shape, *(tuple(np.asarray(i).tolist()) for i in indices),
    )  # fmt: skip


def runs_of(simulations: Sequence[Simulation]) -> list[SingleRun | InternalError]:
    """Starts from rest to their ends, those of one form side by side; each has the same bits alone.

    As many as the loop has lanes go at a time, those of about as many steps together: a lane that has ended waits for
    the others.

    Parameters
    ----------
    simulations : sequence of Simulation
        Starts. [SI]

    Returns
    -------
    list of SingleRun or InternalError
        Of each; or where it diverged. [SI]
    """
    forms: dict[object, list[int]] = {}
    for i, simulation in enumerate(simulations):
        forms.setdefault(form_of(simulation), []).append(i)
    found: dict[int, SingleRun | InternalError] = {}
    for alike in forms.values():
        alike.sort(key=lambda i: simulations[i].maximum_time / simulations[i].step)
        for first in range(0, len(alike), kernels.LANES):
            some = alike[first : first + kernels.LANES]
            found |= zip(some, _side_by_side([simulations[i] for i in some]), strict=True)
    return [found[i] for i in range(len(simulations))]


def _side_by_side(simulations: Sequence[Simulation]) -> list[SingleRun | InternalError]:
    """Starts in the lanes of one loop; where it does not take them, each alone, lest one hinders the others."""
    try:
        loop = _Loop(simulations)
    except InternalError as error:
        return [error] if len(simulations) == 1 else [_side_by_side([s])[0] for s in simulations]
    at_rest = loop.ends["last"].copy()
    return [
        _single_run(loop, lane, trajectory, at_rest)
        for lane, trajectory in enumerate(_to_the_end(loop))
    ]


def _single_run(
    loop: _Loop, lane: int, trajectory: Trajectory, first: Floats
) -> SingleRun | InternalError:
    """A start with what its lane recorded up to its end; `first`: torques of all lanes at rest."""
    try:
        _refuse_diverged(loop, lane, trajectory)
    except InternalError as error:
        return error
    end = trajectory.end_at(loop.simulations[lane].target_speed)
    last = trajectory.time[-2:].copy()
    to_end = kernels.lane_to_end(lane, loop.out, loop.count, first, last, end)
    return SingleRun(trajectory, end, to_end)


def _step_plan(model: StartModel, step: float, maximum_time: float) -> tuple[Ints, Floats]:
    """Number of steps and step of each stretch.

    Steps are the base step divided by powers of two, shortened so that one ends at every knot of
    a torque against time.
    """
    knots = sorted({float(t) for times in knots_of(model.timed) for t in times})
    plan: list[tuple[int, float]] = []
    at = 0.0
    # a ringing mode is sampled as finely as the pulsation is
    stretches = [
        (float(until), step / 2 ** doublings(omega / model.pulsation_omega))
        for until, omega in model.windows
    ]
    for until, h in [*stretches, (maximum_time, step)]:
        stop = min(until, maximum_time)
        while at < stop * (1.0 - 1e-12):
            count = math.ceil((stop - at) / h * (1.0 - 1e-12))
            k = bisect_right(knots, at + 1e-9 * h)
            if k < len(knots) and knots[k] <= at + count * h:
                ahead = knots[k]
                count = math.ceil((ahead - at) / h * (1.0 - 1e-12))
                plan.append((count, (ahead - at) / count))
                at = ahead
            else:
                plan.append((count, h))
                at += count * h
    counts, lengths = zip(*plan, strict=True) if plan else ((), ())
    return np.array(counts, dtype=np.int64), np.array(lengths, dtype=np.float64)
