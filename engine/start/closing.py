"""What the closing of the breaker and a switch-over add to a start from curves, where the motor's data are known.

Curves give the torque of fluxes that turn with the line. When the breaker closes the fluxes are zero, and what is missing
to those dies out while the rotor has hardly begun to turn: at slip 1 the fluxes are linear with constant coefficients,
so that the torque of closing is exact there. Its main part has the frequency of the line. A switch-over from one source to
another is the same at its speed: currents go on, and what the fluxes then are beyond those of the new source dies out.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from engine.arrays import Floats
from engine.case.data import CaseData
from engine.model.modal_train import ModalTrain
from engine.model.motor import Motor
from engine.motor.circuit import Circuit
from engine.motor.from_case import Stage, motors_without_curve
from engine.motor.two_axis import (
    FluxSystem,
    air_gap_torque,
    flux_system,
    opened,
    torque_rate,
    with_same_currents,
)
from engine.numerics.same_bits import cos, matrix_exponential, product, sin, solve, square
from engine.start.torque_outputs import force_reach, torque_outputs
from engine.stepping.linear_loop import drive_modes, prescribed_struct

#: Phase of the line per step, and phase after which what is left is no peak any more: 1 s at 60 Hz. [rad]
STEP, LENGTH = 0.15, 380.0
#: Angles of the rotor tried at a switch-over, over half a turn: the torque has double its frequency; over a turn where a
#: residual voltage is left. [count]
ANGLES = 8


def closing_torque(
    circuit: Circuit,
    line_omega: float,
    angle: float,
    n: int,
    flux: Floats | None = None,
    slip: float = 1.0,
) -> tuple[Floats, Floats]:
    """Torque of a motor at one speed from the closing of its breaker on, less that of its curves at that slip.

    Parameters
    ----------
    circuit : Circuit
        The motor as it starts, rated voltage from now on. [pu]
    line_omega : float
        Angular frequency of the line. [rad/s]
    angle : float
        Of the line ahead of axis d at closing. [rad]
    n : int
        Steps, each of `STEP`. [count]
    flux : ndarray, shape (n_flux,), optional
        Fluxes at closing; default none. [pu]
    slip : float
        Slip all the time. [1]

    Returns
    -------
    torque, rate : ndarray, shape (n + 1,)
        [pu, pu/s]
    """
    system = flux_system(circuit, line_omega, 1.0 - slip, 0.0, is_open=False)
    turns = slip * line_omega
    real, imag = _turning(system, turns)
    phase = np.asarray(slip * STEP * np.arange(n + 1) + angle)
    c, s = cos(phase), sin(phase)
    turning = np.outer(real, c) - np.outer(imag, s)
    turning_slope = -turns * (np.outer(real, s) + np.outer(imag, c))
    left, power = -turning[:, :1], matrix_exponential(STEP / line_omega * system.rate)
    if flux is not None:
        left = left + flux[:, None]
    while left.shape[1] <= n:  # twice as many of what dies out
        left = np.concatenate([left, product(power, left)], axis=1)
        power = product(power, power)
    left = left[:, : n + 1]
    whole, slope = turning + left, turning_slope + product(system.rate, left)
    torque = air_gap_torque(system, whole) - air_gap_torque(system, turning)
    rate = torque_rate(system, whole, slope) - torque_rate(system, turning, turning_slope)
    return torque, rate


def _turning(system: FluxSystem, turns: float) -> tuple[Floats, Floats]:
    """Fluxes that turn with the line: (jω − A) ψ = V (1, −j), its real and its imaginary part. [pu]"""
    size = len(system.rate)
    matrix = np.block([[-system.rate, -turns * np.eye(size)], [turns * np.eye(size), -system.rate]])
    pushed = np.concatenate([system.voltage[:, :1], -system.voltage[:, 1:]])
    real, imag = solve(matrix, pushed).reshape(2, size)
    return real, imag


def _left_by(old: Stage, new: Stage, line_omega: float, angle: float) -> Floats:
    """Fluxes at a switch-over from those that turned with the source before; `angle` is the line's ahead of axis d then.

    Where the stator has been open between, the fluxes of the rotor have decayed meanwhile. The speed then is not known well
    enough to tell where the line is at the end: as at the beginning, and a turn of angles shows the worst.
    """
    slip, source = 1.0 - old.connection.until, old.connection.source
    system = flux_system(old.circuit, line_omega, 1.0 - slip, 0.0, is_open=False)
    real, imag = _turning(system, slip * line_omega)
    wait = new.connection.open_time
    begin = 0.0 if wait else angle
    flux = np.asarray(source.voltage * (cos(begin) * real - sin(begin) * imag))
    if wait:
        still = flux_system(old.circuit, line_omega, 1.0 - slip, 0.0, is_open=True)
        flux = product(matrix_exponential(wait * still.rate), opened(old.circuit, flux))
    return with_same_currents(old.circuit, new.circuit, flux)


def closing_torques(case: CaseData, modal: ModalTrain, motors: Sequence[Motor]) -> Floats:
    """Largest torque that closing or a switch-over adds to each output.

    Parameters
    ----------
    case : CaseData
        The case; every motor has its data sheet and no typed curve. [SI]
    modal : ModalTrain
        The train. [SI]
    motors : sequence of Motor
        Its motors. [SI]

    Returns
    -------
    ndarray, shape (n_outputs,)
        In magnitude. [N m]
    """
    train, modes, damping = modal
    data = motors_without_curve(case)
    line_omega = motors[0].pole_pairs * motors[0].synchronous_speed
    n, h = math.ceil(LENGTH / STEP), STEP / line_omega
    stations = np.array([m.station for m in motors], dtype=np.int64)
    elastic = modes.omega > 0.0
    reach = np.ascontiguousarray(force_reach(train, modes, stations)[elastic])
    sheets = [data[train.stations[motor.station]] for motor in motors]
    closing = np.empty((4, len(motors), n))  # of each torque over each step
    switching: list[Floats] = []
    for k, (motor, sheet) in enumerate(zip(motors, sheets, strict=True)):
        base = motor.scale * sheet.torque_base
        if motor.line_voltage is not None:
            base *= square(float(motor.line_voltage(0.0)))
        if motor.soft is not None:
            base *= square(motor.soft.ramp.initial)
        angle, first = 0.5 * motor.phase + 0.5 * math.pi, sheet.stages[0]
        torque, rate = closing_torque(first.circuit, line_omega, angle, n)
        closing[:, k] = _cubics(square(first.connection.source.voltage) * base, torque, h * rate)
        for old, new in pairwise(sheet.stages):
            over, slip = new.connection.source.voltage, 1.0 - old.connection.until
            for turn in range(ANGLES):
                angle = (2.0 if new.connection.open_time else 1.0) * math.pi / ANGLES * turn
                flux = _left_by(old, new, line_omega, angle) / over
                torque, rate = closing_torque(new.circuit, line_omega, angle, n, flux, slip)
                alone = np.zeros_like(closing)
                alone[:, k] = _cubics(square(over) * base, torque, h * rate)
                switching.append(alone)
    stiffness = np.ascontiguousarray(modes.omega[elastic] ** 2)
    rates = np.ascontiguousarray(damping.rate[elastic])
    system = prescribed_struct(stiffness, rates, reach, len(closing))
    position = torque_outputs(train, modes, stations).position[:, elastic]
    largest = np.zeros(len(position))
    for cubic in (closing, *switching):
        out = np.zeros((len(reach), 2, n + 1))
        rest = np.zeros(len(reach)), np.zeros(len(reach))
        drive_modes(system, np.full(n, h), cubic, rest, out, 1)
        added = np.max(np.abs(product(position, out[:, 0])), axis=1, initial=0.0)
        largest = np.maximum(largest, added)
    return largest


def _cubics(base: float, torque: Floats, rise_of_step: Floats) -> Floats:
    """A torque over each step as a cubic, shape (4, n). [N m]"""
    a, b = base * torque, base * rise_of_step
    rise = np.diff(a)
    return np.stack(
        [a[:-1], b[:-1], 3.0 * rise - 2.0 * b[:-1] - b[1:], b[:-1] + b[1:] - 2.0 * rise]
    )
