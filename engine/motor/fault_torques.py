"""Torques of constant flux linkages: no resistance, one speed, no load before, E = V = 1.

The rotor holds its flux; that of the stator follows the voltage of the line, and the rest of it stands still, so that it turns
backwards in the axes of the rotor. A check of an event, and no bound: a loaded machine has more flux, and resistance
may add to a torque (Concordia, Synchronous machines, 1951, chapter 5).
"""

from __future__ import annotations

import math

import numpy as np

from engine.arrays import Floats
from engine.case.choices import MotorEventKind
from engine.errors import ModelError
from engine.numerics.same_bits import cos, sin

#: Points along each axis of a grid that is drawn together around its largest value, and how often.
POINTS, ROUNDS = 241, 4
KINDS = (
    MotorEventKind.THREE_PHASE_FAULT,
    MotorEventKind.LINE_TO_LINE_FAULT,
    MotorEventKind.OUT_OF_PHASE_CLOSING,
)


def fault_torque(kind: str, xd: float, xq: float, turned: Floats, closing: Floats) -> Floats:
    """Air-gap torque; negative brakes.

    Parameters
    ----------
    kind : str
        One of `KINDS`. A line-to-line fault is that of a motor off the line, with the largest offset. [word]
    xd, xq : float
        Subtransient reactances. [pu]
    turned : ndarray, shape (n,)
        Angle by which the line has turned since. [rad]
    closing : ndarray, shape (n,)
        Angle by which E is ahead of the line, of a closing. [rad]

    Returns
    -------
    ndarray, shape (n,)
        [pu]
    """
    if kind == MotorEventKind.LINE_TO_LINE_FAULT:
        sine, cosine = (
            cos(turned),
            -sin(turned),
        )  # of the angle of the rotor, a quarter turn at the fault
        current = (1.0 - sine) / (xd * sine * sine + xq * cosine * cosine)
        return np.asarray(current * cosine + (xd - xq) * current * current * sine * cosine)
    c, s = cos(turned), sin(turned)
    d, q = c, -s  # flux of the stator that stands still, in the rotor's axes
    if kind == MotorEventKind.OUT_OF_PHASE_CLOSING:
        of_line, across = cos(closing), -sin(closing)
        d = of_line + (1.0 - of_line) * c - across * s
        q = across - (1.0 - of_line) * s - across * c
    return np.asarray(d * q / xq - q * (d - 1.0) / xd)


def largest_fault_torque(kind: str, xd: float, xq: float, closing: float | None = None) -> float:
    """Largest magnitude of the torque, of a closing at the worst angle unless one is given.

    Parameters
    ----------
    kind : str
        One of `KINDS`. [word]
    xd, xq : float
        Subtransient reactances. [pu]
    closing : float, optional
        Angle by which E is ahead of the line. [rad]

    Returns
    -------
    float
        [pu]

    Raises
    ------
    ModelError
        If the kind has no such formula, or a reactance is not positive.
    """
    if kind not in KINDS:
        raise ModelError(f"'{kind}' is none of {', '.join(KINDS)}")
    if not (xd > 0.0 and xq > 0.0 and math.isfinite(xd) and math.isfinite(xq)):
        raise ModelError("both reactances must be positive, in pu")
    turned, width = math.pi, math.pi
    angle, spread = (0.5 * math.pi, 0.5 * math.pi) if closing is None else (closing, 0.0)
    if kind != MotorEventKind.OUT_OF_PHASE_CLOSING:
        spread = 0.0
    largest = 0.0
    for _ in range(ROUNDS):
        along = turned + width * np.linspace(-1.0, 1.0, POINTS)
        beside = angle + spread * np.linspace(-1.0, 1.0, POINTS if spread else 1)
        grid, other = (a.ravel() for a in np.meshgrid(along, beside))
        values = np.abs(fault_torque(kind, xd, xq, grid, other))
        at = int(np.argmax(values))
        largest, turned, angle = float(values[at]), float(grid[at]), float(other[at])
        width, spread = 4.0 * width / POINTS, 4.0 * spread / POINTS
    return largest
