"""One simulation of a start at one step, and what is read out of it."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from engine.case.choices import Method
from engine.errors import InternalError
from engine.model.motor import has_electrical
from engine.start.start_model import StartModel
from engine.start.trajectory import KEPT_VALUES, Recorder, Trajectory
from engine.stepping import linear_loop as kernels
from engine.stepping.exponential import exponential_step
from engine.stepping.newmark import newmark_step

Floats = NDArray[np.float64]

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
            out = [
                np.empty((count, n)),
                np.empty((count, n)),
                np.empty((count, nf)),
                np.empty((count, nf)),
            ]
            done, flag = kernels.advance_start(
                count, h, t, target_speed, free, forced, model.stiffness, model.rate, reach,
                model.mean_speed, model.curves, model.motors, model.loads, model.timed,
                model.dampers, electrical, q, v, phase, force, rate, *out,
            )  # fmt: skip
            out_q, out_v, out_f, out_r = (a[:done] for a in out)
            torques = _torques(model, out_q, out_v, out_f, out_r)
            if not np.all(np.isfinite(torques[0][:, -1])):
                raise InternalError(
                    f"the start became non-finite before {t + h * done:.4g} s at a step of "
                    f"{step:.3g} s"
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
    times, counts = model.timed[1], model.timed[3]
    knots = np.unique(
        np.concatenate([np.zeros(0), *(t[:n] for t, n in zip(times, counts, strict=True))])
    )
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


@dataclass(frozen=True, eq=False)
class SingleRun:
    """One simulation of a start at one step, and what is read out of it."""

    trajectory: Trajectory  #: The simulation. [SI]
    end: float  #: When it ended. [s]
    #: Times and torques of all turning points of every output, from rest to the end. [s, N m]
    turning: list[tuple[Floats, Floats]]

    @property
    def parts(self) -> tuple[Trajectory, float, list[tuple[Floats, Floats]]]:
        """Trajectory, end and turning points. [SI]"""
        return self.trajectory, self.end, self.turning

    def without_history(self) -> SingleRun:
        """With the turning points alone: the history is most of the memory.

        Returns
        -------
        SingleRun
            Without torques. [SI]
        """
        none = np.empty((0, 0))
        return replace(self, trajectory=replace(self.trajectory, torque=none, torque_rate=none))
