"""Average and pulsating torque, current and power factor of a motor that turns steadily with a slip.

Voltages and currents are phasors of slip frequency in the rotor's axes (Concordia, Synchronous machines,
1951). They are split into the part that turns forwards, which stands still against the field of the line,
and the part that unequal axes reflect backwards; in the stator the first has line frequency and the second
(2 s − 1) times that. In these parts the stator's equations are

    R I₊ + j (X I₊ + D I₋) = V,   R I₋ + j (2 s − 1) (D I₊ + X I₋) = 0,   X, D = ½ (Xd ± Xq)(j s)

so that both are found in closed form, at half speed without stator resistance too, where the usual two
equations of the axes become one. With the flux linkages Ψ the torque in time is

    T = average + Re(P e^{2 j s ω₀ t}),   average = Im(Ψ₋ I₋* − Ψ₊ I₊*),   P = j (Ψ₊ I₋ − Ψ₋ I₊)

where the voltage lies along the axis of the poles at t = 0. A one-way discharge path adds torque at the slip frequency, P₁;
its fluxes are periodic, not sinusoidal (`one_way`).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from engine.arrays import Complexes, Floats
from engine.errors import ModelError
from engine.motor.circuit import Circuit, Winding
from engine.motor.one_way import slip_harmonics
from engine.numerics.same_bits import atan2, hypot, inverse, modulus, times

#: Slips on which the largest torque is looked for; their cube roots are equally apart, so that it is found to 5e-5 where
#: it is at a slip of 0.5 % or more. [count]
SLIPS = 1001


@dataclass(frozen=True, eq=False)
class SlipCurves:
    """What a motor does at rated voltage, at each slip. All arrays have shape (n,)."""

    slip: Floats  #: 1 at rest, 0 in step. [1]
    average: Floats  #: Mean torque. [pu]
    pulsating: Floats  #: Torque at twice the slip frequency, zero-to-peak. [pu]
    #: Phase of the pulsation, of cos(2 s ω₀ t) with the voltage along the axis of the poles at t = 0. [rad]
    phase: Floats
    current: Floats  #: True rms of both frequencies. [pu of rated current]
    power_factor: Floats  #: Of the part at line frequency. [1]
    line_current: Complexes  #: That part as a phasor, the voltage being real. [pu]
    #: Torque at the slip frequency itself, zero-to-peak, 0 without a one-way discharge path. [pu]
    pulsation_1: Floats
    phase_1: Floats  #: Its phase, of cos(s ω₀ t) with the voltage likewise. [rad]


def winding_admittance(windings: Sequence[Winding], slip: Floats) -> Complexes:
    """1/(R/(j s) + X) of windings side by side.

    Parameters
    ----------
    windings : sequence of Winding
        Windings. [pu]
    slip : ndarray, shape (n,)
        Frequency in the rotor over that of the line. [1]

    Returns
    -------
    ndarray, shape (n,)
        Their sum; multiplied by j s it is that of the impedances. [pu]
    """
    total = np.zeros(len(slip), dtype=np.complex128)
    for resistance, leakage in windings:
        reactance = slip * leakage
        size = resistance * resistance + reactance * reactance
        total.real += slip * reactance / size
        total.imag += slip * resistance / size
    return total


def operational_reactances(circuit: Circuit, slip: Floats) -> tuple[Complexes, Complexes]:
    """Flux linkage over current of each axis, at slip frequency.

    Parameters
    ----------
    circuit : Circuit
        The motor as it starts; its rotor windings have resistance. [pu]
    slip : ndarray, shape (n,)
        Frequency in the rotor over that of the line. [1]

    Returns
    -------
    d, q : ndarray, shape (n,)
        Xd(j s) and Xq(j s). [pu]
    """
    field = () if circuit.field is None else (circuit.field,)
    rotor_d = winding_admittance((*field, *circuit.dampers_d), slip)
    rotor_d = times(rotor_d, inverse(1.0 + circuit.common_leakage_d * rotor_d))
    rotor_q = winding_admittance(circuit.dampers_q, slip)
    leakage = circuit.stator_leakage
    return (
        leakage + inverse(1.0 / circuit.magnetising_d + rotor_d),
        leakage + inverse(1.0 / circuit.magnetising_q + rotor_q),
    )


def running_slip(circuit: Circuit, torque: float) -> float:
    """Slip at which a motor without field gives a torque in operation.

    Parameters
    ----------
    circuit : Circuit
        The motor, with equal axes. [pu]
    torque : float
        Air-gap torque; one that brakes is given above synchronous speed. [pu]

    Returns
    -------
    float
        Nearer to 0 than that of the largest torque, so that the motor returns to its speed. [1]

    Raises
    ------
    ModelError
        If the motor does not give so much.
    """
    wanted, sign = abs(torque), math.copysign(1.0, torque)
    slips, torques = _rising_branch(circuit, sign)
    if torques[-1] < wanted:
        raise ModelError(
            f"does not carry its torque in operation, {torque:.4g} pu: it gives at most {sign * torques[-1]:.4g} pu, at a "
            f"slip of {100.0 * sign * slips[-1]:.3g} %"
        )
    after = int(np.searchsorted(torques, wanted))
    below, above = float(slips[max(after - 1, 0)]), float(slips[after])
    while below < (middle := 0.5 * (below + above)) < above:
        if sign * float(slip_curves(circuit, np.array([sign * middle])).average[0]) < wanted:
            below = middle
        else:
            above = middle
    return sign * above


def stalls_at(circuit: Circuit, slip: float, torque: float) -> bool:
    """Whether a motor without field slows down further at a slip, as it gives less there than its load takes.

    Parameters
    ----------
    circuit : Circuit
        The motor, with equal axes. [pu]
    slip : float
        Where it has come to. [1]
    torque : float
        What its load takes, at rated voltage. [pu]

    Returns
    -------
    bool
        [flag]
    """
    sign = math.copysign(1.0, torque)
    slips, _ = _rising_branch(circuit, sign)
    given = slip_curves(circuit, np.array([slip])).average[0]
    return bool(sign * slip > slips[-1] and sign * given < abs(torque))


def _rising_branch(circuit: Circuit, sign: float) -> tuple[Floats, Floats]:
    """Magnitudes of slip and torque from 0 to the first largest torque, that drives (sign 1) or brakes (−1). [1, pu]"""
    root = np.linspace(0.0, 1.0, SLIPS)
    slips = root * root * root
    torques = sign * slip_curves(circuit, sign * slips).average
    falls = np.flatnonzero(np.diff(torques) <= 0.0)
    until = int(falls[0]) + 1 if len(falls) else len(slips)
    return slips[:until], torques[:until]


def slip_curves(circuit: Circuit, slip: Floats) -> SlipCurves:
    """Torques and current at rated voltage on a line that does not give way.

    Parameters
    ----------
    circuit : Circuit
        The motor as it starts. [pu]
    slip : ndarray, shape (n,)
        1 at rest, 0 in step, negative above synchronous speed. [1]

    Returns
    -------
    SlipCurves
        At each slip. [pu]
    """
    if circuit.reverse_resistance is not None:
        return _one_way_curves(circuit, slip)
    xd, xq = operational_reactances(circuit, slip)
    mean, half = 0.5 * (xd + xq), 0.5 * (xd - xq)
    resistance = circuit.stator_resistance
    backward = 2.0 * slip - 1.0
    if resistance == 0.0:  # it cancels, and would leave 0/0 at half speed
        backward = np.ones_like(slip)
    share = -1j * backward * times(half, inverse(resistance + 1j * backward * mean))
    plus = inverse(resistance + 1j * (mean + times(half, share)))
    minus = times(share, plus)
    flux_plus = times(mean, plus) + times(half, minus)
    flux_minus = times(half, plus) + times(mean, minus)
    pulsation = 1j * (times(flux_plus, minus) - times(flux_minus, plus))
    size = modulus(plus)
    return SlipCurves(
        slip,
        times(flux_minus, minus.conj()).imag - times(flux_plus, plus.conj()).imag,
        modulus(pulsation),
        atan2(pulsation.imag, pulsation.real),
        hypot(size, modulus(minus)),
        plus.real / size,
        plus,
        np.zeros(len(slip)),
        np.zeros(len(slip)),
    )


def _one_way_curves(circuit: Circuit, slip: Floats) -> SlipCurves:
    """With a one-way discharge path. In step the field has no current, whatever its resistance."""
    found = slip_curves(circuit.polarities[0], slip)
    slips = slip != 0.0
    if not slips.any():
        return found
    periodic = slip_harmonics(circuit, slip[slips])
    line, twice, once = periodic.line_current, periodic.at_twice, periodic.at_slip
    for column, values in (
        (found.average, periodic.average),
        (found.pulsating, modulus(twice)),
        (found.phase, atan2(twice.imag, twice.real)),
        (found.current, periodic.current),
        (found.power_factor, line.real / modulus(line)),
        (found.line_current, line),
        (found.pulsation_1, modulus(once)),
        (found.phase_1, atan2(once.imag, once.real)),
    ):
        column[slips] = values
    return found
