"""Pull-in of a synchronous motor, read from a simulated run: did it come into step, and how.

The load angle δ is an electrical angle, the motor lagging positive. While the motor slips, δ grows
without end; each time it passes 180° (modulo 360°) a pole slips by. A motor in step stays between
two passages, its slip swinging about zero. All functions take sampled histories, which may begin
before the field is applied.

References
----------
Kundur, Power System Stability and Control (1994), section 3.9 (swing equation) and 13.1 (angle
stability of one machine).
"""

from __future__ import annotations

import math

import numpy as np

from engine.arrays import Floats
from engine.numerics.same_bits import cos, interp, sin
from engine.start.event_results import PullIn

#: A swing of this amplitude has settled: 1 % of the pull-out torque, at the most. [rad]
SETTLED_SWING = 0.01
#: Swings over which it has to stay so small.
SETTLED_SWINGS = 2.0
#: Slip cycles without approaching synchronism after which pull-in has failed.
FAILED_CYCLES = 5
#: Slip cycles are steady if their durations differ by less than this share,
STEADY_CYCLES = 0.01
#: and slip has not approached zero while its least value is above this share of its mean.
NEAR_ZERO_SLIP = 0.05
#: A load angle that moves by less over this share of the time since it last slipped, and for at
#: least so long, stands still. [rad, 1, s]
STILL_ANGLE, STILL_SHARE, STILL_TIME = 0.02, 0.2, 0.2
#: Slip below this share of that at field application is at rest: a motor that creeps into step.
AT_REST = 0.01
#: A motor whose slip stays below this is in step. [1]
IN_STEP_SLIP = 1e-3
#: Zero crossings of slip count while it swings by more than this share of its first swing.
VISIBLE_SWING = 1e-4


def _crossings(time: Floats, value: Floats) -> Floats:
    """Times of the sign changes of a sampled curve, on straight lines between samples."""
    sign = np.where(value >= 0.0, 1, -1)
    at = np.flatnonzero(sign[1:] != sign[:-1])
    share = value[at] / (value[at] - value[at + 1])
    return np.asarray(time[at] + share * (time[at + 1] - time[at]), dtype=np.float64)


def passages(time: Floats, load_angle: Floats) -> Floats:
    """Times at which the load angle passes 180°, either way.

    Parameters
    ----------
    time : ndarray, shape (n,)
        Rising times. [s]
    load_angle : ndarray, shape (n,)
        Unwrapped load angle, sampled at least twice a turn. [rad]

    Returns
    -------
    ndarray, shape (n_passages,)
        Rising times, between samples on straight lines. [s]
    """
    well = np.floor((load_angle + math.pi) / (2.0 * math.pi))
    times: list[float] = []
    for i in np.flatnonzero(well[1:] != well[:-1]):
        low, high = sorted((well[i], well[i + 1]))
        edges = (2.0 * np.arange(low + 1.0, high + 1.0) - 1.0) * math.pi
        share = (edges - load_angle[i]) / (load_angle[i + 1] - load_angle[i])
        times += sorted(time[i] + share * (time[i + 1] - time[i]))
    return np.array(times)


def judge_pull_in(
    time: Floats, load_angle: Floats, slip: Floats, field_time: float, field_slip: float
) -> PullIn:
    """What came of field application.

    The motor is in step if, after the last passage of 180°, its slip has gone through zero and
    back, or has died out on the stable side of the well: without a push it cannot leave again. A
    motor that slips poles steadily does neither between two passages.

    Parameters
    ----------
    time : ndarray, shape (n,)
        Rising times. [s]
    load_angle : ndarray, shape (n,)
        Unwrapped load angle, the motor lagging positive. [rad]
    slip : ndarray, shape (n,)
        Slip of the train's mean speed, without torsional vibration. [1]
    field_time, field_slip : float
        When the field was applied, and the slip then. [s, 1]

    Returns
    -------
    PullIn
        Outcome, pole slips, time, load angle and swing. [SI]
    """
    t, angle, s = _from(field_time, time, load_angle, slip)
    passed = passages(t, angle)
    last = float(passed[-1]) if len(passed) else field_time
    turned = abs(float(interp(last, t, angle)) - float(angle[0])) / (2.0 * math.pi)
    inside = t >= last
    swings = _swings(t[inside], s[inside])
    in_step = len(swings) >= 2 or _rests(t[inside], angle[inside], s[inside], field_slip)
    return PullIn(
        field_time=field_time,
        field_slip=field_slip,
        synchronised=in_step,
        pole_slips=int(turned + 1e-9),
        pull_in_time=last if in_step else None,
        in_step_time=_stays_below(t, s, IN_STEP_SLIP) if in_step else None,
        in_step_slip=IN_STEP_SLIP,
        load_angle=_mean_angle(t[inside], angle[inside], swings) if in_step else None,
        swing_frequency=_frequency(swings) if in_step else None,
    )


def _stays_below(time: Floats, slip: Floats, limit: float) -> float | None:
    """Instant from which slip stays below a limit, between samples on a straight line; None if never."""
    above = np.flatnonzero(np.abs(slip) >= limit)
    if not len(above):
        return float(time[0])
    i = int(above[-1])
    if i + 1 == len(time):
        return None
    a, b = abs(float(slip[i])), abs(float(slip[i + 1]))
    return float(time[i] + (a - limit) / (a - b) * (time[i + 1] - time[i]))


def _from(
    field_time: float, time: Floats, load_angle: Floats, slip: Floats
) -> tuple[Floats, Floats, Floats]:
    """The histories from field application on, its own moment included."""
    later = time > field_time
    t = np.concatenate([[field_time], time[later]])
    return t, interp(t, time, load_angle), interp(t, time, slip)


def _swings(time: Floats, slip: Floats) -> Floats:
    """Zero crossings of slip while it swings visibly."""
    crossings = _crossings(time, slip)
    if len(crossings) < 2:
        return crossings
    between = np.searchsorted(time, crossings)
    sizes = np.array([np.max(np.abs(part)) for part in np.split(slip, between)[1:] if len(part)])
    if len(sizes) < len(crossings):  # two crossings between two samples: too fine to be a swing
        return crossings[: len(sizes)]
    # a crossing counts if there was a visible swing before it or is one after it
    visible = sizes > VISIBLE_SWING * sizes.max()
    seen = visible.copy()
    seen[1:] |= visible[:-1]
    return crossings[: int(np.flatnonzero(seen)[-1]) + 1]


def _rests(time: Floats, angle: Floats, slip: Floats, field_slip: float) -> bool:
    """Whether slip has died out where more lag means more torque.

    The angle itself says so too: gears that sway on very soft bearings leave a little mean speed
    in the train although its motor stands still against the field.
    """
    middle = 2.0 * math.pi * round(float(angle[-1]) / (2.0 * math.pi))
    stable = abs(float(angle[-1]) - middle) < 0.5 * math.pi
    window = STILL_SHARE * (time[-1] - time[0])
    still = window > STILL_TIME and float(np.ptp(angle[time >= time[-1] - window])) < STILL_ANGLE
    return stable and (still or abs(float(slip[-1])) < AT_REST * abs(field_slip))


def _frequency(swings: Floats) -> float | None:
    """Mean frequency of whole swings; of half a swing if there is no more."""
    if len(swings) < 2:
        return None
    last = (len(swings) - 1) // 2 * 2 or 1
    return float(0.5 * last / (swings[last] - swings[0]))


def _mean_angle(time: Floats, angle: Floats, swings: Floats) -> float:
    """Load angle over the last whole swing, or at the end; between −π and π."""
    mean = float(angle[-1])
    if len(swings) >= 3:
        fine = np.linspace(swings[-3], swings[-1], 201)
        mean = float(np.trapezoid(interp(fine, time, angle), fine) / (fine[-1] - fine[0]))
    return mean - 2.0 * math.pi * math.floor((mean + math.pi) / (2.0 * math.pi))


def has_settled(
    time: Floats,
    load_angle: Floats,
    field_time: float,
    swing_period: float,
    limit: float = SETTLED_SWING,
) -> bool:
    """Whether the swing after pull-in has died out.

    The amplitude over the last two swings is compared with the limit; as torque it is at most that
    share of the pull-out torque.

    Parameters
    ----------
    time : ndarray, shape (n,)
        Rising times. [s]
    load_angle : ndarray, shape (n,)
        Unwrapped load angle. [rad]
    field_time : float
        When the field was applied. [s]
    swing_period : float
        Period of small swings. [s]
    limit : float, optional
        Amplitude that counts as settled. [rad]

    Returns
    -------
    bool
        False also while fewer than two swings have passed.
    """
    window = SETTLED_SWINGS * swing_period
    if time[-1] - field_time < window:
        return False
    return float(np.ptp(load_angle[time >= time[-1] - window])) <= 2.0 * limit


def has_failed(
    time: Floats,
    load_angle: Floats,
    slip: Floats,
    field_time: float,
    cycles: int = FAILED_CYCLES,
) -> bool:
    """Whether the motor surely goes on slipping poles: asynchronous running with the field on.

    So it is if over the last slip cycles slip never came near zero and each lasted as long as the
    others: what it gains in one half of a cycle it loses in the other.

    Parameters
    ----------
    time : ndarray, shape (n,)
        Rising times. [s]
    load_angle : ndarray, shape (n,)
        Unwrapped load angle. [rad]
    slip : ndarray, shape (n,)
        Slip of the train's mean speed. [1]
    field_time : float
        When the field was applied, and had risen: cycles before do not count. [s]
    cycles : int, optional
        Slip cycles that have to be alike. [count]

    Returns
    -------
    bool
        False while there are fewer cycles.
    """
    t, angle, s = _from(field_time, time, load_angle, slip)
    passed = passages(t, angle)[-cycles - 1 :]
    if len(passed) < cycles + 1:
        return False
    lasted = np.diff(passed)
    inside = s[(t >= passed[0]) & (t <= passed[-1])]
    steady = float(np.ptp(lasted)) < STEADY_CYCLES * float(np.mean(lasted))
    size = np.sign(inside[0]) * inside
    return steady and float(size.min()) > NEAR_ZERO_SLIP * float(size.mean())


def swing_frequency_linear(
    pull_out: float,
    load_torque: float,
    inertia: float,
    pole_pairs: float,
    saliency: float = 0.0,
) -> float | None:
    """Frequency of small swings about the load angle that carries the load.

    √(p · dT/dδ / J) / 2π with T = pull-out · sin δ + saliency · sin 2δ.

    Parameters
    ----------
    pull_out : float
        Amplitude of the synchronising torque. [N m]
    load_torque : float
        Torque at synchronism, at the motor's speed. [N m]
    inertia : float
        Of the whole train, referred to the motor. [kg m²]
    pole_pairs : float
        Pole pairs. [1]
    saliency : float, optional
        Amplitude of the saliency torque: of the pulsation at synchronism. [N m]

    Returns
    -------
    float or None
        Frequency; None if the motor cannot carry the load. [Hz]
    """
    delta = np.linspace(-math.pi, math.pi, 2049)
    top = int(np.argmax(pull_out * sin(delta) + saliency * sin(2.0 * delta)))
    low, high = 0.0, float(delta[top])
    torque = _torque_at(high, pull_out, saliency)
    if not 0.0 <= load_torque < torque:
        return None
    for _ in range(60):  # rising from zero to its top
        middle = 0.5 * (low + high)
        if _torque_at(middle, pull_out, saliency) < load_torque:
            low = middle
        else:
            high = middle
    slope = pull_out * cos(low) + 2.0 * saliency * cos(2.0 * low)
    return math.sqrt(pole_pairs * max(slope, 0.0) / inertia) / (2.0 * math.pi)


def _torque_at(angle: float, pull_out: float, saliency: float) -> float:
    return pull_out * sin(angle) + saliency * sin(2.0 * angle)
