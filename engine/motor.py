"""Torque of a synchronous motor while it starts: average and pulsating part against speed.

The pulsating torque has twice the slip frequency; its phase follows the rotor's own angle,
T(ω) · sin(2 (ω_line t − p θ) + phase), so that a twisting shaft is fed back into the torque
(the paper, "Transient torsional analyses"; Godwin, IEEE Trans. PAS-95 (1976)).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from engine.case import CaseData
from engine.errors import ModelError
from engine.torque_curve import TorqueCurve, torque_curve
from engine.train import Train

__all__ = ["Motor", "motors_of"]


@dataclass(frozen=True, eq=False)
class Motor:
    """One motor.

    Parameters
    ----------
    station : int
        Station it acts on. [index]
    average, pulsating : TorqueCurve
        Torque against speed, at the voltage of this start; pulsating zero-to-peak. [N m]
    synchronous_speed : float
        Of its own station. [rad/s]
    pole_pairs : float
        Line angular frequency over its synchronous speed. [1]
    phase : float
        Phase of the pulsation at t = 0. [rad]
    """

    station: int
    average: TorqueCurve
    pulsating: TorqueCurve
    synchronous_speed: float
    pole_pairs: float
    phase: float


def motors_of(case: CaseData, train: Train) -> tuple[Motor, ...]:
    """Motors of a case; motor torques scale with the square of the voltage.

    Parameters
    ----------
    case : CaseData
        The case. [SI]
    train : Train
        Its train. [SI]

    Returns
    -------
    tuple of Motor
        In the order of the table. [count]

    Raises
    ------
    ModelError
        If the line frequency or the synchronous speed is unknown.
    """
    ratings = case.ratings
    names = list(dict.fromkeys(p.station for p in case.motor_torque))
    if not names:
        return ()
    if ratings.synchronous_speed is None or ratings.line_frequency is None:
        raise ModelError("A motor needs line frequency and synchronous speed.")
    scale = (1.0 if case.voltage is None else case.voltage) ** 2
    motors = []
    for name in names:
        points = [p for p in case.motor_torque if p.station == name]
        station = train.station_index(str(name))
        speed = ratings.synchronous_speed * float(train.speed_ratio[station])
        x = np.array([p.speed for p in points], dtype=float)
        motors.append(
            Motor(
                station,
                torque_curve(x, scale * np.array([p.average for p in points], dtype=float)),
                torque_curve(x, scale * np.array([p.pulsating for p in points], dtype=float)),
                speed,
                2.0 * math.pi * ratings.line_frequency / speed,
                case.pulsation_phase or 0.0,
            )
        )
    return tuple(motors)
