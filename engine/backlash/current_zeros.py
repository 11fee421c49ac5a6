"""A fault that clears phase by phase, each where the motor's current in it passes zero, all teeth in contact.

A phase that has cleared has the whole voltage of the line, less the drop of its own current where the line has an
impedance; the others have none. The zeros are those of the currents that the machine in time has then.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from engine.arrays import Floats
from engine.motor.two_axis import MachineState
from engine.numerics.same_bits import atan2, cos, hypot, product, sin
from engine.start.machine_motion import (
    Balance,
    Machine,
    MachineMotion,
    State,
    Stretch,
    Supply,
    stretch_of,
)
from engine.start.time_response import ModalSystem

#: Longest phase of the line in a step: four times shorter than that of an event. [rad]
LINE_PHASE = 0.0375
#: A current with a large offset may not pass zero for long; then the breaker interrupts it. [periods of the line]
LONGEST_ARC = 10
#: Of a zero. [periods of the line]
ACCURACY, MOST_ROUNDS = 1e-9, 60


def clearing_by_phase(
    system: ModalSystem,
    machine: Machine,
    faulted: Supply,
    clears: float,
    poles: Sequence[float],
    state: MachineState,
    before: tuple[Floats, Floats],
    balance: Balance,
) -> tuple[Supply, ...]:
    """The supplies of a fault whose phases clear one by one.

    Parameters
    ----------
    system : ModalSystem
        The train under the torque of the motor. [SI]
    machine : Machine
        The motor. [pu, SI]
    faulted : Supply
        The faulted line. [pu, rad]
    clears : float
        From when on phases clear. [s]
    poles : sequence of float
        Axes, in the stator, of the currents that must pass zero: of three phases, or of the one between two. [rad]
    state : MachineState
        As for `machine_motion`. [pu, rad]
    before : tuple of ndarray, shape (n_kept,)
        Modal positions and velocities at t = 0. [SI]
    balance : Balance
        As for `machine_motion`. [N m, 1]

    Returns
    -------
    tuple of Supply
        The fault, then one a phase that has cleared. [pu, rad]
    """
    step, period = LINE_PHASE / machine.line_omega, 2.0 * math.pi / machine.line_omega
    stretch, now = stretch_of(system, machine, faulted, state, (*before, state.flux), balance)
    now = _end(stretch.motion(now, clears, step))
    supplies, waiting, time = [faulted], list(poles), clears
    while waiting and time < clears + LONGEST_ARC * period:
        present = replace(supplies[-1], begins=time)
        stretch, _ = stretch_of(system, machine, present, state, now, balance)
        motion = stretch.motion(now, time + period, step)
        first = _first_zero(stretch, motion, waiting)
        if first is None:
            time, now = float(motion.time[-1]), _end(motion)
            continue
        i, pole = first
        time, now = _zero(stretch, motion, i, pole)
        waiting.remove(pole)
        cleared = [p for p in poles if p not in waiting]
        supplies.append(
            cleared_supply(time, cleared, poles, has_impedance=machine.source.has_impedance)
        )
    if waiting:
        supplies.append(Supply(time))
    return tuple(supplies)


def cleared_supply(
    time: float, cleared: Sequence[float], poles: Sequence[float], *, has_impedance: bool
) -> Supply:
    """Whole voltage in some phases, none in the others; of all of them, or of one between two phases, all of it.

    Currents add to zero: along the axis of one cleared phase the stator has 2/3 of its voltage, across it nothing; of two
    cleared phases 1/3 along the axis of the third one, and all across it.

    Parameters
    ----------
    time : float
        From when on, from the event. [s]
    cleared : sequence of float
        Axes of the phases that have cleared. [rad]
    poles : sequence of float
        Axes of all of them. [rad]
    has_impedance : bool
        Of the line. [flag]

    Returns
    -------
    Supply
        [pu, rad]
    """
    if len(cleared) == len(poles):
        return Supply(time)
    if has_impedance and len(cleared) == 1:
        return Supply(time, axis=cleared[0], shares=(2.0 / 3.0, 0.0))
    if has_impedance:
        (left,) = (pole for pole in poles if pole not in cleared)
        return Supply(time, axis=left, shares=(1.0 / 3.0, 1.0))
    real = sum(cos(2.0 * axis) for axis in cleared) / 3.0
    imag = sum(sin(2.0 * axis) for axis in cleared) / 3.0
    return Supply(time, (len(cleared) / 3.0, 0.0), (hypot(real, imag), atan2(imag, real)))


def _end(motion: MachineMotion) -> State:
    return motion.q[:, -1], motion.v[:, -1], motion.flux[:, -1]


def _current(stretch: Stretch, motion: MachineMotion, axis: float) -> Floats:
    """Current along an axis of the stator at each time. [pu]"""
    machine = stretch.machine
    i_d, i_q = product(stretch.fluxes.stator_current, motion.flux)
    turned = machine.pole_pairs * motion.rotor + stretch.speed * machine.line_omega * motion.time
    angle = stretch.angle + turned - axis
    return np.asarray(i_d * cos(angle) - i_q * sin(angle))


def _first_zero(
    stretch: Stretch, motion: MachineMotion, poles: Sequence[float]
) -> tuple[int, float] | None:
    """Sample before the first zero, and whose it is."""
    found = []
    for pole in poles:
        current = _current(stretch, motion, pole)
        passes = np.flatnonzero(current[1:-1] * current[2:] <= 0.0)  # not that which cleared before
        if len(passes):
            i = int(passes[0]) + 1
            share = current[i] / (current[i] - current[i + 1] or 1.0)
            found.append((i + float(share), i, pole))
    return min(found)[1:] if found else None


def _zero(stretch: Stretch, motion: MachineMotion, i: int, pole: float) -> tuple[float, State]:
    """Instant of the zero after a sample, and the state there (regula falsi, Illinois)."""
    now = motion.q[:, i], motion.v[:, i], motion.flux[:, i]
    begins = float(motion.time[i])
    from_there = replace(stretch, supply=replace(stretch.supply, begins=begins))
    ends = [0.0, float(motion.time[i + 1]) - begins]
    values = [float(v) for v in _current(stretch, motion, pole)[[i, i + 1]]]
    period = 2.0 * math.pi / stretch.machine.line_omega
    share, side = ends[1], 0
    reached = motion.q[:, i + 1], motion.v[:, i + 1], motion.flux[:, i + 1]
    for _ in range(MOST_ROUNDS):
        if values[0] == values[1] or ends[1] - ends[0] <= ACCURACY * period:
            break
        share = (values[1] * ends[0] - values[0] * ends[1]) / (values[1] - values[0])
        if not ends[0] < share < ends[1]:
            break
        part = from_there.motion(now, begins + share, share)
        reached, value = _end(part), float(_current(stretch, part, pole)[-1])
        at = 0 if value * values[1] <= 0.0 else 1
        ends[at], values[at] = share, value
        if value == 0.0:
            break
        if side == at + 1:
            values[1 - at] *= 0.5
        side = at + 1
        if abs(value) < ACCURACY:
            break
    return begins + share, reached
