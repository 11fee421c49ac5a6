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
from engine.motor.circuit import Circuit
from engine.motor.two_axis import air_gap_torque, flux_system
from engine.numerics.same_bits import cos, sin

#: Points along each axis of a grid that is drawn together around its largest value, and how often.
POINTS, ROUNDS = 241, 4
#: Points of a cycle: a torque that turns with twice the line's frequency has its largest value there to 1e-6. [count]
OF_A_CYCLE = 4096
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
        return line_to_line_torque(xd, xq, turned, 0.5 * math.pi)
    c, s = cos(turned), sin(turned)
    d, q = c, -s  # flux of the stator that stands still, in the rotor's axes
    if kind == MotorEventKind.OUT_OF_PHASE_CLOSING:
        of_line, across = cos(closing), -sin(closing)
        d = of_line + (1.0 - of_line) * c - across * s
        q = across - (1.0 - of_line) * s - across * c
    return np.asarray(d * q / xq - q * (d - 1.0) / xd)


def line_to_line_torque(xd: float, xq: float, turned: Floats, at: float) -> Floats:
    """Air-gap torque of a line-to-line fault of a motor off the line; negative brakes.

    Parameters
    ----------
    xd, xq : float
        Subtransient reactances. [pu]
    turned : ndarray, shape (n,)
        Angle by which the rotor has turned since. [rad]
    at : float
        Angle of the rotor at the fault: that of the healthy phase's voltage, and a quarter turn. [rad]

    Returns
    -------
    ndarray, shape (n,)
        Of a voltage of 1 before. [pu]
    """
    sine, cosine = sin(at + turned), cos(at + turned)
    current = (float(sin(np.array(at))) - sine) / (xd * sine * sine + xq * cosine * cosine)
    return np.asarray(current * cosine + (xd - xq) * current * current * sine * cosine)


def largest_line_to_line(xd: float, xq: float, at: float) -> float:
    """Largest magnitude of `line_to_line_torque`.

    Parameters
    ----------
    xd, xq : float
        Subtransient reactances. [pu]
    at : float
        Angle of the rotor at the fault. [rad]

    Returns
    -------
    float
        Of a voltage of 1 before. [pu]
    """
    turned = 2.0 * math.pi * np.linspace(0.0, 1.0, OF_A_CYCLE + 1)
    return float(np.max(np.abs(line_to_line_torque(xd, xq, turned, at))))


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


def largest_of_constant_fluxes(
    circuit: Circuit, flux: Floats, forward: tuple[float, float], backward: tuple[float, float]
) -> float:
    """Largest magnitude of the torque in the first cycle of the line, the rotor in step.

    The voltage turns with the line, and against it. Its integral is the flux of the stator; what the stator has beyond
    that stands still.

    Parameters
    ----------
    circuit : Circuit
        The motor; its resistances do not count. [pu]
    flux : ndarray, shape (n_flux,)
        Fluxes at first, in the order of `FluxSystem`. [pu]
    forward, backward : tuple of float
        Magnitude of each voltage, and its angle ahead of axis d at first. [pu, rad]

    Returns
    -------
    float
        [pu]
    """
    system = flux_system(circuit, 1.0, 1.0, 0.0, is_open=False)
    q, turned = system.q, 2.0 * math.pi * np.linspace(0.0, 1.0, OF_A_CYCLE + 1)
    (f, a), (b, angle) = forward, backward
    f_d, f_q = f * cos(a), f * sin(a)
    b_d, b_q = b * cos(angle - 2.0 * turned), b * sin(angle - 2.0 * turned)
    still_d = float(flux[0]) - f_q + b_q[0]
    still_q = float(flux[q]) + f_d - b_d[0]
    c, s = cos(turned), sin(turned)
    fluxes = np.repeat(flux[:, None], len(turned), axis=1)
    fluxes[0] = still_d * c + still_q * s + f_q - b_q
    fluxes[q] = still_q * c - still_d * s - f_d + b_d
    return float(np.max(np.abs(air_gap_torque(system, fluxes))))
