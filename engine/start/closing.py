"""What the closing of the breaker adds to a start from curves, where the motor's data are known.

Curves give the torque of fluxes that turn with the line. When the breaker closes the fluxes are zero, and what is missing
to those dies out while the rotor has hardly begun to turn: at slip 1 the fluxes are linear with constant coefficients,
so that the torque of closing is exact there. Its main part has the frequency of the line.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from engine.arrays import Floats
from engine.case.data import CaseData
from engine.model.modal_train import ModalTrain
from engine.model.motor import Motor
from engine.motor.circuit import Circuit
from engine.motor.from_case import motors_without_curve
from engine.motor.two_axis import air_gap_torque, flux_system, torque_rate
from engine.numerics.same_bits import cos, matrix_exponential, product, sin, solve
from engine.start.torque_outputs import force_reach, torque_outputs
from engine.stepping.linear_loop import drive_modes, prescribed_struct

#: Phase of the line per step, and phase after which what is left is no peak any more: 1 s at 60 Hz. [rad]
STEP, LENGTH = 0.15, 380.0


def closing_torque(
    circuit: Circuit, line_omega: float, angle: float, n: int
) -> tuple[Floats, Floats]:
    """Torque of a motor at rest from the closing of its breaker on, less that of its curves at slip 1.

    Parameters
    ----------
    circuit : Circuit
        The motor as it starts. [pu]
    line_omega : float
        Angular frequency of the line. [rad/s]
    angle : float
        Of the line ahead of axis d at closing. [rad]
    n : int
        Steps, each of `STEP`. [count]

    Returns
    -------
    torque, rate : ndarray, shape (n + 1,)
        [pu, pu/s]
    """
    system = flux_system(circuit, line_omega, 0.0, 0.0, is_open=False)
    size = len(system.rate)
    # fluxes that turn with the line: (jω − A) ψ = V (1, −j) e^{jα}, written in real parts
    matrix = np.block(
        [[-system.rate, -line_omega * np.eye(size)], [line_omega * np.eye(size), -system.rate]]
    )
    pushed = np.concatenate([system.voltage[:, :1], -system.voltage[:, 1:]])
    real, imag = solve(matrix, pushed).reshape(2, size)
    phase = np.asarray(STEP * np.arange(n + 1) + angle)
    c, s = cos(phase), sin(phase)
    turning = np.outer(real, c) - np.outer(imag, s)
    turning_slope = -line_omega * (np.outer(real, s) + np.outer(imag, c))
    left, power = -turning[:, :1], matrix_exponential(STEP / line_omega * system.rate)
    while left.shape[1] <= n:  # twice as many of what dies out
        left = np.concatenate([left, product(power, left)], axis=1)
        power = product(power, power)
    left = left[:, : n + 1]
    whole, slope = turning + left, turning_slope + product(system.rate, left)
    torque = air_gap_torque(system, whole) - air_gap_torque(system, turning)
    rate = torque_rate(system, whole, slope) - torque_rate(system, turning, turning_slope)
    return torque, rate


def closing_torques(case: CaseData, modal: ModalTrain, motors: Sequence[Motor]) -> Floats:
    """Largest torque that closing adds to each output.

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
    cubic = np.empty((4, len(motors), n))  # of each torque over each step
    for k, motor in enumerate(motors):
        sheet = data[train.stations[motor.station]]
        angle = 0.5 * motor.phase + 0.5 * math.pi
        torque, rate = closing_torque(sheet.starting, line_omega, angle, n)
        base = float(motor.torque_factor(0.0)) * sheet.torque_base
        a, b = base * torque, base * h * rate
        rise = np.diff(a)
        cubic[:, k] = a[:-1], b[:-1], 3.0 * rise - 2.0 * b[:-1] - b[1:], b[:-1] + b[1:] - 2.0 * rise
    stiffness = np.ascontiguousarray(modes.omega[elastic] ** 2)
    rates = np.ascontiguousarray(damping.rate[elastic])
    out = np.zeros((len(reach), 2, n + 1))
    system = prescribed_struct(stiffness, rates, reach, len(cubic))
    rest = np.zeros(len(reach)), np.zeros(len(reach))
    drive_modes(system, np.full(n, h), cubic, rest, out, 1)
    position = torque_outputs(train, modes, stations).position[:, elastic]
    return np.asarray(np.max(np.abs(product(position, out[:, 0])), axis=1, initial=0.0))
