"""One simulation of a start at one step."""

from __future__ import annotations

import math

import numpy as np

from engine.arrays import Floats
from engine.case.choices import Method
from engine.errors import InternalError
from engine.model.motor import has_electrical
from engine.start.start_model import StartModel
from engine.start.time_response import knots_of
from engine.start.trajectory import KEPT_VALUES, Recorder, Trajectory
from engine.stepping import linear_loop as kernels
from engine.stepping.exponential import exponential_step
from engine.stepping.newmark import newmark_step

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
    q, v = np.zeros(n), np.zeros(n)
    phase = model.phase.copy()
    force, rate = _forces_at(model, 0.0, 0.0, q, v, phase)
    recorder = Recorder(model.outputs.element, math.inf if keep_all else KEPT_VALUES)
    nothing = np.empty((0, 1))
    first = _torques(model, q[None], v[None], force[None], rate[None])
    recorder.add(np.zeros(1), np.zeros(1), *first, nothing)
    steps = 0
    t, flag = 0.0, kernels.PENDING
    electrical = model.electrical if has_electrical(model.electrical) else None
    coefficients = exponential_step if method == Method.EXPONENTIAL else newmark_step
    for remaining, h in _step_plan(model, step, maximum_time):
        free, forced = (
            np.ascontiguousarray(a.transpose(1, 2, 0))
            for a in coefficients(model.stiffness, model.rate, h)
        )
        reach = np.ascontiguousarray(model.reach.T)
        force, rate = _forces_at(model, t, t + 0.5 * h, q, v, phase)
        while remaining > 0 and flag == kernels.PENDING:
            count = min(CHUNK, remaining)
            out = [np.empty((count, width)) for width in (n, n, nf, nf)]
            done, flag = kernels.advance_start(
                count, h, t, target_speed, free, forced, model.stiffness, model.rate, reach,
                model.mean_speed, model.curves, model.motors, model.loads, model.timed,
                model.dampers, electrical, q, v, phase, force, rate, *out,
            )  # fmt: skip
            out_q, out_v, out_f, out_r = (a[:done] for a in out)
            torques = _torques(model, out_q, out_v, out_f, out_r)
            if not np.all(np.isfinite(torques[0][:, -1])):
                raise InternalError(
                    f"the start diverged before {t + h * done:.4g} s at a step of {step:.3g} s: torques "
                    "are no longer finite. Check stiffness, damping and torque curves"
                )
            times = np.asarray(t + h * np.arange(1, done + 1), dtype=np.float64)
            recorder.add(times, out_v @ model.mean_speed, *torques, np.empty((0, done)))
            steps += done
            t += h * done
            remaining -= done
        if flag != kernels.PENDING:
            break
    return recorder.trajectory(flag == kernels.REACHED, steps)[0]


def _forces_at(
    model: StartModel, t: float, inside: float, q: Floats, v: Floats, phase: Floats
) -> tuple[Floats, Floats]:
    """Forces and their rates at one time; the rates depend on the acceleration the forces cause."""
    nf = model.reach.shape[1]
    force, rate = np.zeros(nf), np.zeros(nf)
    speed, acceleration = model.reach.T @ v, np.zeros(nf)
    own = model.rate * v + model.stiffness * q
    for _ in range(2):
        kernels.start_forces(
            t, inside, phase, speed, acceleration, model.curves, model.motors, model.loads,
            model.timed, model.dampers, model.electrical, force, rate,
        )  # fmt: skip
        acceleration = model.reach.T @ (model.reach @ force - own)
    return force, rate


def _step_plan(model: StartModel, step: float, maximum_time: float) -> list[tuple[int, float]]:
    """(number of steps, step) of each stretch.

    Steps are the base step divided by powers of two, shortened so that one ends at every knot of
    a torque against time.
    """
    knots = np.unique(np.concatenate([np.zeros(0), *knots_of(model.timed)]))
    plan: list[tuple[int, float]] = []
    at = 0.0
    # a ringing mode is sampled as finely as the pulsation is
    stretches = [
        (until, step / 2 ** max(math.ceil(math.log2(omega / model.pulsation_omega)), 0))
        for until, omega in model.windows
    ]
    for until, h in [*stretches, (maximum_time, step)]:
        stop = min(until, maximum_time)
        while at < stop * (1.0 - 1e-12):
            count = math.ceil((stop - at) / h * (1.0 - 1e-12))
            ahead = knots[(knots > at + 1e-9 * h) & (knots <= at + count * h)]
            if len(ahead):
                count = math.ceil((ahead[0] - at) / h * (1.0 - 1e-12))
                plan.append((count, float(ahead[0] - at) / count))
                at = float(ahead[0])
            else:
                plan.append((count, h))
                at += count * h
    return plan


def _torques(
    model: StartModel, q: Floats, v: Floats, force: Floats, rate: Floats
) -> tuple[Floats, Floats]:
    """Output torques and rates, shape (n_outputs, n), from states, shape (n, …)."""
    y = model.outputs
    torque = y.position @ q.T + y.force @ force.T
    slope = y.position @ v.T + y.force @ rate.T
    if np.any(y.velocity):
        acceleration = force @ model.reach.T - v * model.rate - q * model.stiffness
        torque += y.velocity @ v.T
        slope += y.velocity @ acceleration.T
    return torque, slope
