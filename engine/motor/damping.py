"""Torque that a small oscillation of the rotor's speed brings: what the motor really damps, or drives.

The slope of the average torque against speed is right for oscillations that are slow beside the windings'
own rates. At the natural frequencies of shafts the windings cannot follow, and damping, stiffness and even
their sign are others (Concordia, Synchronous machines, 1951).

A rotor that turns steadily with the slip s carries phasors of slip frequency. Its oscillation with ν times
line frequency moves them, and the line's voltage in its axes, to the frequencies ν ± s; the stator's
equations there are those of the steady slip, but for their right side:

    ΔT = K Δω,   K = Σ± [Δψd iq* + ψd* Δiq − Δψq id* − ψq* Δid],

with those ± i and ψ for which the oscillation made Δi and Δψ.
"""

from __future__ import annotations

import math

import numpy as np

from engine.arrays import Complexes, Floats
from engine.motor.circuit import Circuit
from engine.motor.curves import operational_reactances
from engine.numerics.same_bits import hypot, inverse, times

#: Two axes, d and q: currents or flux linkages at some frequency.
Axes = tuple[Complexes, Complexes]


def stator_response(
    circuit: Circuit, frequency: Floats, speed: Floats, voltage: Axes
) -> tuple[Axes, Axes]:
    """Currents and flux linkages that voltages of one frequency drive in a rotor that turns steadily.

    Parameters
    ----------
    circuit : Circuit
        The motor. [pu]
    frequency : ndarray, shape (n,)
        Of the voltages in the rotor's axes, over that of the line. [1]
    speed : ndarray, shape (n,)
        Of the rotor, over synchronous speed. [1]
    voltage : tuple of ndarray, shape (n,)
        Of the two axes. [pu]

    Returns
    -------
    currents, fluxes : tuple of ndarray, shape (n,)
        Of the two axes. [pu]
    """
    xd, xq = operational_reactances(circuit, frequency)
    resistance = circuit.stator_resistance
    own_d, own_q = resistance + 1j * frequency * xd, resistance + 1j * frequency * xq
    across_d, across_q = speed * xd, speed * xq
    scale = inverse(times(own_d, own_q) + times(across_d, across_q))
    current_d = times(scale, times(own_q, voltage[0]) + times(across_q, voltage[1]))
    current_q = times(scale, times(own_d, voltage[1]) - times(across_d, voltage[0]))
    return (current_d, current_q), (times(xd, current_d), times(xq, current_q))


def electrical_damping(circuit: Circuit, slip: Floats, frequency: Floats) -> Complexes:
    """Torque over speed of a small oscillation about a steady slip, at rated voltage.

    Parameters
    ----------
    circuit : Circuit
        The motor as it starts; its stator has resistance, without which flux of the stator never dies
        out. [pu]
    slip : ndarray, shape (n,)
        Steady slip. [1]
    frequency : ndarray, shape (n,)
        Of the oscillation, over that of the line; positive. [1]

    Returns
    -------
    ndarray, shape (n,)
        K: negative real parts damp, positive imaginary parts raise the natural frequency. [pu of torque
        over pu of speed]
    """
    speed = 1.0 - slip
    half = np.full(len(slip), 0.5 + 0.0j)
    voltage = (half, -1j * half)
    steady = (*stator_response(circuit, slip, speed, voltage), voltage)
    mirrored = tuple(tuple(part.conj() for part in axes) for axes in steady)
    total = np.zeros(len(slip), dtype=np.complex128)
    for side, ((id_, iq), (pd, pq), (ud, uq)) in ((1.0, steady), (-1.0, mirrored)):
        # an oscillation of speed turns flux into the other axis, one of angle the voltage
        forced = (pq - 1j * uq / frequency, -(pd - 1j * ud / frequency))
        (did, diq), (dpd, dpq) = stator_response(circuit, frequency + side * slip, speed, forced)
        total += times(dpd, iq.conj()) + times(pd.conj(), diq)
        total -= times(dpq, id_.conj()) + times(pq.conj(), did)
    return total


def running_damping(circuit: Circuit, power_factor: float, frequency: Floats) -> Complexes:
    """Torque over speed of a small oscillation in step, at rated voltage and current.

    The state is that of a motor with its field on: its internal voltage behind Rs + j Xq lies along axis q, and
    currents and flux linkages of the stator stand still for the rotor. All torques of the oscillation have its
    frequency, so there is one side only.

    Parameters
    ----------
    circuit : Circuit
        The motor without its discharge resistor. [pu]
    power_factor : float
        Of the motor: positive leads, as that of an over-excited one; negative lags. [1]
    frequency : ndarray, shape (n,)
        Of the oscillation, over that of the line; positive. [1]

    Returns
    -------
    ndarray, shape (n,)
        K, as in `electrical_damping`. [pu of torque over pu of speed]
    """
    resistance = circuit.stator_resistance
    xq = circuit.stator_leakage + circuit.magnetising_q
    active = abs(power_factor)
    lead = math.copysign(math.sqrt(1.0 - active * active), power_factor)
    real = 1.0 - resistance * active + xq * lead  # of the voltage behind
    imaginary = -(resistance * lead + xq * active)
    size = hypot(real, imaginary)
    ud, uq = imaginary / size, real / size
    id_, iq = active * ud - lead * uq, active * uq + lead * ud
    return _damping_at_rest(circuit, (ud, uq), (id_, iq), frequency)


def _damping_at_rest(
    circuit: Circuit, voltage: tuple[float, float], current: tuple[float, float], frequency: Floats
) -> Complexes:
    """K of a motor in step whose axes have these voltages and currents. [pu]"""
    (ud, uq), (id_, iq) = voltage, current
    pd, pq = uq - circuit.stator_resistance * iq, circuit.stator_resistance * id_ - ud
    across = np.asarray(1j / frequency, dtype=np.complex128)
    forced = (pq - uq * across, ud * across - pd)
    (did, diq), (dpd, dpq) = stator_response(circuit, frequency, np.ones(len(frequency)), forced)
    return dpd * iq + pd * diq - dpq * id_ - pq * did
