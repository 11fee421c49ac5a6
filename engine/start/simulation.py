"""One simulation of a start at one step."""

from __future__ import annotations

import math

import numpy as np

from engine.arrays import Floats, Ints
from engine.case.choices import Method
from engine.errors import InternalError
from engine.numerics.same_bits import doublings, product
from engine.start.start_model import StartModel
from engine.start.time_response import knots_of
from engine.start.trajectory import KEPT_VALUES, Recorder, Trajectory
from engine.stepping import linear_loop as kernels
from engine.stepping.library import struct

#: Steps between two copies of the state out of the compiled loop.
CHUNK = 4096


def simulate(
    model: StartModel,
    step: float,
    method: str,
    target_speed: float,
    maximum_time: float,
    *,
    keep_all: bool = False,
) -> Trajectory:
    """One start at a given step.

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
    n, nf = model.reach.shape
    q, v, force, rate = np.zeros(n), np.zeros(n), np.zeros(nf), np.zeros(nf)
    drive = kernels.drive_struct(
        model.curves, model.motors, model.loads, model.timed, model.electrical
    )
    system = kernels.system_struct(
        model.stiffness,
        model.rate,
        np.ascontiguousarray(model.reach.T),
        model.mean_speed,
        model.dampers,
    )
    state = struct("state_t", q=q, v=v, phase=model.phase.copy(), force=force, force_rate=rate)
    room = kernels.room_for(system, drive)
    kernels.forces_at(0.0, 0.0, system, drive, state, room)
    recorder = Recorder(model.outputs.element, math.inf if keep_all else KEPT_VALUES)
    first = _torques(model, q[None], v[None], force[None], rate[None])
    recorder.add(np.zeros(1), np.zeros(1), *first, np.empty((0, 1)))
    counts, lengths = _step_plan(model, step, maximum_time)
    plan = struct(
        "stretches_t", n=len(counts), counts=counts, steps=lengths, target_speed=target_speed,
        newmark=method == Method.NEWMARK,
    )  # fmt: skip
    rows = {  # filled again and again
        "time": np.empty(CHUNK), "q": np.empty((CHUNK, n)), "v": np.empty((CHUNK, n)),
        "force": np.empty((CHUNK, nf)), "force_rate": np.empty((CHUNK, nf)),
    }  # fmt: skip
    out = struct("output_t", rows=CHUNK, **rows)
    steps, reason = 0, kernels.MORE
    while reason == kernels.MORE:
        done, reason = kernels.advance_start(plan, system, drive, state, out, room)
        time, out_q, out_v, out_f, out_r = (a[:done] for a in rows.values())
        torques = _torques(model, out_q, out_v, out_f, out_r)
        if not np.all(np.isfinite(torques[0][:, -1:])):
            raise InternalError(
                f"the start diverged before {time[-1]:.4g} s at a step of {step:.3g} s: torques "
                "are no longer finite. Check stiffness, damping and torque curves"
            )
        recorder.add(time.copy(), product(out_v, model.mean_speed), *torques, np.empty((0, done)))
        steps += done
    return recorder.trajectory(reason == kernels.SPEED, steps)[0]


def _step_plan(model: StartModel, step: float, maximum_time: float) -> tuple[Ints, Floats]:
    """Number of steps and step of each stretch.

    Steps are the base step divided by powers of two, shortened so that one ends at every knot of
    a torque against time.
    """
    knots = np.unique(np.concatenate([np.zeros(0), *knots_of(model.timed)]))
    plan: list[tuple[int, float]] = []
    at = 0.0
    # a ringing mode is sampled as finely as the pulsation is
    stretches = [
        (until, step / 2 ** doublings(omega / model.pulsation_omega))
        for until, omega in model.windows
    ]
    for until, h in [*stretches, (maximum_time, step)]:
        stop = min(until, maximum_time)
        while at < stop * (1.0 - 1e-12):
            count = math.ceil((stop - at) / h * (1.0 - 1e-12))
            k = int(np.searchsorted(knots, at + 1e-9 * h, side="right"))
            if k < len(knots) and knots[k] <= at + count * h:
                ahead = float(knots[k])
                count = math.ceil((ahead - at) / h * (1.0 - 1e-12))
                plan.append((count, (ahead - at) / count))
                at = ahead
            else:
                plan.append((count, h))
                at += count * h
    counts, lengths = zip(*plan, strict=True) if plan else ((), ())
    return np.array(counts, dtype=np.int64), np.array(lengths, dtype=np.float64)


def _torques(
    model: StartModel, q: Floats, v: Floats, force: Floats, rate: Floats
) -> tuple[Floats, Floats]:
    """Output torques and rates, shape (n_outputs, n), from states, shape (n, …)."""
    y = model.outputs
    torque = product(y.position, q.T) + product(y.force, force.T)
    slope = product(y.position, v.T) + product(y.force, rate.T)
    if np.any(y.velocity):
        acceleration = product(force, model.reach.T) - v * model.rate - q * model.stiffness
        torque += product(y.velocity, v.T)
        slope += product(y.velocity, acceleration.T)
    return torque, slope
