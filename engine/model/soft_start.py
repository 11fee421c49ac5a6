"""A soft starter: voltage that rises in time, and what it is against speed while the rigid train runs up.

Curves of torque are read at a speed, so that a voltage in time needs the run-up. Between two speeds the torque at full voltage
and the load change little; with their means the rigid train needs the time t in which

    ∫ (Σ T_k V_k(t)² − T_load) dt = J Δω

where the voltages rise in proportion to time up to the full one. Where the torque does not carry the load yet, at rest or on
the way, the train waits until the voltage has risen enough.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from engine.arrays import Floats
from engine.numerics.same_bits import total
from engine.numerics.torque_curve import TorqueCurve, torque_curve

#: Speeds of the run-up. [count]
SPEEDS = 401
#: Newton's method from beyond the end of an interval comes nearer from one side; change of time that ends it. [count, 1]
ROUNDS, CLOSE = 100, 1e-13


@dataclass(frozen=True)
class Ramp:
    """Voltage of a soft starter in time, over the full one."""

    initial: float  #: At closing. [1]
    time: float  #: When it is full. [s]

    def voltage(self, t: float) -> float:
        """At a time. [1]"""
        return min(self.initial + (1.0 - self.initial) * t / self.time, 1.0)

    def squares(self, t: float) -> float:
        """Integral of its square from closing on. [s]"""
        until, full = min(t, self.time), max(t - self.time, 0.0)
        a, b = self.initial, self.voltage(until)
        return until * (a * a + a * b + b * b) / 3.0 + full


@dataclass(frozen=True, eq=False)
class SoftStart:
    """A soft starter of a motor on its train."""

    ramp: Ramp  #: Voltage in time. [1]
    voltage: (
        TorqueCurve  #: Voltage against the fraction of synchronous speed, of the rigid run-up. [1]
    )
    breaks_away: float  #: When the rigid train begins to turn; infinite = not at all. [s]


@dataclass(frozen=True)
class _Interval:
    """Mean torques between two speeds."""

    torques: tuple[float, ...]  #: Of each motor at full voltage. [N m]
    ramps: tuple[Ramp | None, ...]  #: Their soft starters. [s]
    load: float  #: [N m]

    def net(self, t: float) -> float:
        """Accelerating torque at a time. [N m]"""
        voltages = (1.0 if ramp is None else ramp.voltage(t) for ramp in self.ramps)
        return total(a * (v * v) for a, v in zip(self.torques, voltages, strict=True)) - self.load

    def impulse(self, t: float) -> float:
        """Its integral from closing on. [N m s]"""
        squares = (t if ramp is None else ramp.squares(t) for ramp in self.ramps)
        return total(a * s for a, s in zip(self.torques, squares, strict=True)) - self.load * t

    def carried(self, now: float, full: float) -> float:
        """When the torque carries the load, from now on; infinite where full voltage does not."""
        if self.net(full) <= 0.0:
            return math.inf
        if self.net(now) > 0.0:
            return now
        low, high = now, full
        while low < (middle := 0.5 * (low + high)) < high:
            if self.net(middle) > 0.0:
                high = middle
            else:
                low = middle
        return high

    def left(self, now: float, full: float, momentum: float) -> float:
        """When the torque has given a momentum, from now on: Newton's method from beyond, as the impulse bends upwards. [s]"""
        wanted, ahead = self.impulse(now) + momentum, full
        while self.impulse(now + ahead) < wanted:
            ahead *= 2.0
        t = now + ahead
        for _ in range(ROUNDS):
            change = (self.impulse(t) - wanted) / self.net(t)
            t -= change
            if change <= CLOSE * t:
                break
        return max(t, now)


def runup_times(
    torques: Floats, ramps: Sequence[Ramp | None], load: Floats, inertia: float, speed: Floats
) -> Floats:
    """When the rigid train leaves each speed.

    Parameters
    ----------
    torques : ndarray, shape (n_motors, n)
        Average torque of each motor at full voltage. [N m]
    ramps : sequence of (Ramp or None)
        Their soft starters; None = always full voltage. [s]
    load : ndarray, shape (n,)
        Opposing torque. [N m]
    inertia : float
        Of the whole train. [kg m²]
    speed : ndarray, shape (n,)
        Rising speeds. [rad/s]

    Returns
    -------
    ndarray, shape (n,)
        Infinite from where full voltage does not carry the load. [s]
    """
    time, now = np.full(len(speed), math.inf), 0.0
    last = max(ramp.time for ramp in ramps if ramp is not None)
    means = (0.5 * (torques[:, 1:] + torques[:, :-1])).T.tolist()
    loads = (0.5 * (load[1:] + load[:-1])).tolist()
    for i, momentum in enumerate((inertia * np.diff(speed)).tolist()):
        interval = _Interval(tuple(means[i]), tuple(ramps), loads[i])
        full = max(now, last)
        now = interval.carried(now, full)
        time[i] = now
        if math.isinf(now):
            return time
        now = interval.left(now, full, momentum)
    time[-1] = now
    return time


def soft_start(ramp: Ramp, fraction: Floats, time: Floats) -> SoftStart:
    """A soft starter from the run-up.

    Parameters
    ----------
    ramp : Ramp
        Its voltage in time. [1]
    fraction : ndarray, shape (n,)
        Fractions of synchronous speed. [1]
    time : ndarray, shape (n,)
        When the train leaves them. [s]

    Returns
    -------
    SoftStart
        [1]
    """
    voltage = np.array([1.0 if math.isinf(t) else ramp.voltage(t) for t in time.tolist()])
    return SoftStart(ramp, torque_curve(fraction, voltage), float(time[0]))
