"""The compiled loops. Few, cached on disk, compiled at first call and never at import.

Arrays are (n_modes,), (n_forces,) or (n_samples, …) and C-contiguous. A *force* is a torque at
one station; `reach` maps forces to modes and modal to station angles alike.
"""

# numba compiles these bodies; plain loops are what it compiles best
from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from engine.stepping.compiling import kernel

__all__ = [
    "PENDING",
    "REACHED",
    "advance_start",
    "drive_coupled",
    "drive_modes",
    "evaluate_curve",
    "start_forces",
    "turning_points",
]

Floats = NDArray[np.float64]

#: Of each motor: see `engine.model.motor.electrical_arrays`.
Electrical = tuple[Floats, Floats, float, Floats, Floats, Floats, Floats, Floats, Floats]

PENDING, REACHED = 0, 1


@kernel(inline="always")
def evaluate_curve(x: float, knots: Floats, cubic: Floats, count: int) -> tuple[float, float]:
    """Value and slope of a piecewise cubic, held constant outside its knots.

    Parameters
    ----------
    x : float
        Where, a fraction of synchronous speed. [1]
    knots : ndarray, shape (longest,)
        Knots. [1]
    cubic : ndarray, shape (longest, 4)
        Coefficients from each knot on. [N m]
    count : int
        Knots in use. [count]

    Returns
    -------
    value, slope : float
        Torque and its slope. [N m]
    """
    if x <= knots[0]:
        return cubic[0, 0], 0.0
    if x >= knots[count - 1]:
        return cubic[count - 1, 0], 0.0
    low, high = 0, count - 1
    while high - low > 1:
        middle = (low + high) // 2
        if knots[middle] <= x:
            low = middle
        else:
            high = middle
    s = x - knots[low]
    c = cubic[low]
    return c[0] + s * (c[1] + s * (c[2] + s * c[3])), c[1] + s * (2.0 * c[2] + 3.0 * s * c[3])


@kernel()
def _decaying_sine(t: float, rate: float, omega: float) -> tuple[float, float]:
    """e^(−rate t) sin ωt and its slope."""
    size = np.exp(-rate * t)
    s, c = np.sin(omega * t), np.cos(omega * t)
    return size * s, size * (omega * c - rate * s)


@kernel()
def _synchronising(since: float, rate: float, angle: float, turning: float) -> tuple[float, float]:
    """Synchronising over pull-out torque, (1 − e^(−rate t)) sin δ, and its slope."""
    grown, growth = 1.0, 0.0
    if not np.isinf(rate):
        left = np.exp(-rate * max(since, 0.0))
        grown, growth = 1.0 - left, rate * left
    s, c = np.sin(angle), np.cos(angle)
    return grown * s, growth * s + grown * c * turning


@kernel(inline="always")
def start_forces(
    t: float,
    inside: float,
    phase: Floats,
    speed: Floats,
    acceleration: Floats,
    curves: tuple[Floats, Floats, Any],
    motors: tuple[Any, Any, Any, Floats, Floats, float, Any],
    loads: tuple[Any, Any, Floats, Floats],
    timed: tuple[Any, Floats, Floats, Any],
    dampers: tuple[Any, Floats],
    electrical: Electrical | None,
    force: Floats,
    force_rate: Floats,
) -> None:
    """Every force and its rate, written into `force` and `force_rate`.

    A table against time is read on the segment that holds the time `inside`, a point within the
    step, so that a jump at the end of a step is not seen before it happens. The field is on where
    `inside` is past its time, for the same reason: a step must end when it is applied.

    The load angle is δ = phase/2 + polarity, the motor lagging positive. The tabulated pulsation,
    sin(phase) = sin 2δ, so becomes the saliency torque with unbroken phase and is never added
    twice. A phase must therefore be kept modulo 4π: modulo 2π would turn δ by π.

    Parameters
    ----------
    t, inside : float
        Time, and a time within the step. [s]
    phase : ndarray, shape (n_motors,)
        Phase of each pulsation at that time, modulo 4π. [rad]
    speed, acceleration : ndarray, shape (n_forces,)
        Of the station (or across the damper) of each force. [rad/s, rad/s²]
    curves : tuple
        Knots, cubics and counts of all torque curves. [1, N m]
    motors : tuple
        Force, two curves, synchronous speed and pole pairs of each; line frequency; curve of the
        average torque with the field on. [SI]
    loads : tuple
        Force, curve, synchronous and standstill speed of each. [SI]
    timed : tuple
        Force, times, torques and counts of each table against time. [s, N m]
    dampers : tuple
        Force and coefficient of each damper between parts. [N m s/rad]
    electrical : tuple
        Of each motor (`engine.model.motor.electrical_arrays`): amplitude and rate of decay of the
        transient at breaker closing, its angular frequency (one for all), time of field application
        (infinite = none), rate at which the field rises (infinite = at once), pull-out torque,
        torque over slip speed (nan = the average curve), what is added to the load angle, and 1,
        or 0 once the motor is disconnected. None = nothing of all this: compiled by itself, since
        these branches would cost every plain start a third of its time. [SI]
    force, force_rate : ndarray, shape (n_forces,)
        The results. [N m, N m/s]
    """
    knots, cubics, counts = curves
    (
        motor_force,
        average_curve,
        pulsating_curve,
        motor_speed,
        pole_pairs,
        line_omega,
        field_curve,
    ) = motors
    load_force, load_curve, load_speed, soft_speed = loads
    timed_force, times, torques, timed_count = timed
    damper_force, viscous = dampers
    force[:] = 0.0
    force_rate[:] = 0.0
    for m in range(len(motor_force)):
        if electrical is not None and electrical[8][m] == 0.0:
            continue
        f = motor_force[m]
        x = speed[f] / motor_speed[m]
        dx = acceleration[f] / motor_speed[m]
        a = average_curve[m]
        if electrical is not None and inside >= electrical[3][m]:
            a = field_curve[m]
        b = pulsating_curve[m]
        average, average_slope = evaluate_curve(x, knots[a], cubics[a], counts[a])
        pulsating, pulsating_slope = evaluate_curve(x, knots[b], cubics[b], counts[b])
        s, c = np.sin(phase[m]), np.cos(phase[m])
        phase_rate = 2.0 * (line_omega - pole_pairs[m] * speed[f])
        if electrical is not None:
            shock, shock_rate, shock_omega, field_time, field_rate = electrical[:5]
            pull_out, cage, polarity, _ = electrical[5:]
            if shock[m] != 0.0:
                sine, slope = _decaying_sine(t, shock_rate[m], shock_omega)
                force[f] += shock[m] * sine
                force_rate[f] += shock[m] * slope
            if inside >= field_time[m]:
                if not np.isnan(cage[m]):
                    average = cage[m] * (motor_speed[m] - speed[f])
                    average_slope = -cage[m] * motor_speed[m]
                sine, slope = _synchronising(
                    t - field_time[m], field_rate[m], 0.5 * phase[m] + polarity[m], 0.5 * phase_rate
                )
                force[f] += pull_out[m] * sine
                force_rate[f] += pull_out[m] * slope
        force[f] += average + pulsating * s
        force_rate[f] += (average_slope + pulsating_slope * s) * dx + pulsating * c * phase_rate
    for k in range(len(load_force)):
        f = load_force[k]
        x = speed[f] / load_speed[k]
        a = load_curve[k]
        torque, slope = evaluate_curve(abs(x), knots[a], cubics[a], counts[a])
        z = speed[f] / soft_speed[k]
        if z >= 1.0:
            force[f] -= torque
            force_rate[f] -= slope * acceleration[f] / load_speed[k]
        else:
            z = max(z, -1.0)
            soft = 1.0 if z > -1.0 else 0.0
            sign = z * (1.5 - 0.5 * z * z)
            turn = 1.5 * (1.0 - z * z) / soft_speed[k] * soft
            direction = 1.0 if x >= 0.0 else -1.0
            force[f] -= torque * sign
            force_rate[f] -= (
                slope * direction / load_speed[k] * sign + torque * turn
            ) * acceleration[f]
    for k in range(len(timed_force)):
        n = timed_count[k]
        f = timed_force[k]
        if inside >= times[k, n - 1]:
            force[f] += torques[k, n - 1]
        elif inside >= times[k, 0]:
            low, high = 0, n - 1
            while high - low > 1:
                middle = (low + high) // 2
                if times[k, middle] <= inside:
                    low = middle
                else:
                    high = middle
            slope = (torques[k, low + 1] - torques[k, low]) / (times[k, low + 1] - times[k, low])
            force[f] += torques[k, low] + slope * (t - times[k, low])
            force_rate[f] += slope
    for k in range(len(damper_force)):
        f = damper_force[k]
        force[f] -= viscous[k] * speed[f]
        force_rate[f] -= viscous[k] * acceleration[f]


@kernel(fastmath={"reassoc", "contract", "nsz"}, _nrt=False)
def _advance(
    n_steps: int,
    h: float,
    t: float,
    target_speed: float,
    free: Floats,
    forced: Floats,
    stiffness: Floats,
    rate: Floats,
    reach: Floats,
    mean_speed: Floats,
    curves: tuple[Floats, Floats, Any],
    motors: tuple[Any, Any, Any, Floats, Floats, float, Any],
    loads: tuple[Any, Any, Floats, Floats],
    timed: tuple[Any, Floats, Floats, Any],
    dampers: tuple[Any, Floats],
    electrical: Electrical | None,
    q: Floats,
    v: Floats,
    phase: Floats,
    force: Floats,
    force_rate: Floats,
    out_q: Floats,
    out_v: Floats,
    out_f: Floats,
    out_fr: Floats,
    space: tuple[Any, ...],
) -> tuple[int, int]:
    """`advance_start` with the room it works in; what allocates nothing need not count references."""
    nf, n = reach.shape
    base_q, base_v, u1, r1, q1, v1, a1, f1, fr1, speed, acceleration, phase1 = space
    motor_force, pole_pairs, line_omega = motors[0], motors[4], motors[5]
    for k in range(n_steps):
        for i in range(n):
            u1[i], r1[i] = 0.0, 0.0
        for f in range(nf):
            for i in range(n):
                u1[i] += reach[f, i] * force[f]
                r1[i] += reach[f, i] * force_rate[f]
        for i in range(n):  # what does not depend on the end of the step
            base_q[i] = (
                free[0, 0, i] * q[i]
                + free[0, 1, i] * v[i]
                + forced[0, 0, i] * u1[i]
                + forced[0, 1, i] * r1[i]
            )
            base_v[i] = (
                free[1, 0, i] * q[i]
                + free[1, 1, i] * v[i]
                + forced[1, 0, i] * u1[i]
                + forced[1, 1, i] * r1[i]
            )
            u1[i] += h * r1[i]
        for _ in range(2):  # predict and evaluate, correct and evaluate
            for i in range(n):
                q1[i] = base_q[i] + forced[0, 2, i] * u1[i] + forced[0, 3, i] * r1[i]
                v1[i] = base_v[i] + forced[1, 2, i] * u1[i] + forced[1, 3, i] * r1[i]
                a1[i] = u1[i] - rate[i] * v1[i] - stiffness[i] * q1[i]
            for f in range(nf):
                x, y = 0.0, 0.0
                for i in range(n):
                    x += reach[f, i] * v1[i]
                    y += reach[f, i] * a1[i]
                speed[f], acceleration[f] = x, y
            for m in range(len(phase)):
                turned = 0.0
                for i in range(n):
                    turned += reach[motor_force[m], i] * (q1[i] - q[i])
                phase1[m] = phase[m] + 2.0 * (line_omega * h - pole_pairs[m] * turned)
            start_forces(
                t + h, t + 0.5 * h, phase1, speed, acceleration, curves, motors, loads, timed,
                dampers, electrical, f1, fr1,
            )  # fmt: skip
            for i in range(n):
                u1[i], r1[i] = 0.0, 0.0
            for f in range(nf):
                for i in range(n):
                    u1[i] += reach[f, i] * f1[f]
                    r1[i] += reach[f, i] * fr1[f]
        t += h
        mean = 0.0
        for i in range(n):
            q[i], v[i] = q1[i], v1[i]
            out_q[k, i], out_v[k, i] = q1[i], v1[i]
            mean += mean_speed[i] * v1[i]
        for m in range(len(phase)):
            phase[m] = phase1[m] % (4.0 * np.pi)  # half of it is the load angle
        for f in range(nf):
            force[f], force_rate[f] = f1[f], fr1[f]
            out_f[k, f], out_fr[k, f] = f1[f], fr1[f]
        if mean >= target_speed:
            return k + 1, REACHED
    return n_steps, PENDING


@kernel()
def advance_start(
    n_steps: int,
    h: float,
    t: float,
    target_speed: float,
    free: Floats,
    forced: Floats,
    stiffness: Floats,
    rate: Floats,
    reach: Floats,
    mean_speed: Floats,
    curves: tuple[Floats, Floats, Any],
    motors: tuple[Any, Any, Any, Floats, Floats, float, Any],
    loads: tuple[Any, Any, Floats, Floats],
    timed: tuple[Any, Floats, Floats, Any],
    dampers: tuple[Any, Floats],
    electrical: Electrical | None,
    q: Floats,
    v: Floats,
    phase: Floats,
    force: Floats,
    force_rate: Floats,
    out_q: Floats,
    out_v: Floats,
    out_f: Floats,
    out_fr: Floats,
) -> tuple[int, int]:
    """Up to `n_steps` steps of one start; stops at the step in which the mean speed is reached.

    free, forced and reach are (2, 2, n_modes), (2, 4, n_modes) and (n_forces, n_modes): the modes
    run along the last axis so that the compiler can take several at once. q, v, phase, force and
    force_rate are the state and are updated in place; the out_ arrays receive the state after
    each step.

    Parameters
    ----------
    n_steps : int
        Most steps. [count]
    h, t : float
        Step, and time at its start. [s]
    target_speed : float
        Mean speed at which to stop. [rad/s]
    free, forced : ndarray
        Coefficients of the step. [SI]
    stiffness, rate : ndarray, shape (n_modes,)
        λ and d of each mode. [1/s², 1/s]
    reach : ndarray, shape (n_forces, n_modes)
        Forces to modes. [rad/√(kg m²)]
    mean_speed : ndarray, shape (n_modes,)
        Mean speed from modal velocities. [√(1/(kg m²))]
    curves : tuple
        Knots, cubics and counts of all torque curves. [1, N m]
    motors : tuple
        Force, two curves, synchronous speed and pole pairs of each; line frequency; curve of the
        average torque with the field on. [SI]
    loads : tuple
        Force, curve, synchronous and standstill speed of each. [SI]
    timed : tuple
        Force, times, torques and counts of each table against time. [s, N m]
    dampers : tuple
        Force and coefficient of each damper between parts. [N m s/rad]
    electrical : tuple
        Transient, field and connection of each motor, as in `start_forces`. [SI]
    q, v : ndarray, shape (n_modes,)
        Modal positions and velocities. [SI]
    phase : ndarray, shape (n_motors,)
        Phase of each pulsation. [rad]
    force, force_rate : ndarray, shape (n_forces,)
        Forces and their rates. [N m, N m/s]
    out_q, out_v : ndarray, shape (n_steps, n_modes)
        State after each step. [SI]
    out_f, out_fr : ndarray, shape (n_steps, n_forces)
        Forces and rates after each step. [N m, N m/s]

    Returns
    -------
    done, flag : int
        Steps taken; PENDING or REACHED. [count]
    """
    nf, n = reach.shape
    space = (
        np.empty(n), np.empty(n), np.empty(n), np.empty(n), np.empty(n), np.empty(n), np.empty(n),
        np.empty(nf), np.empty(nf), np.empty(nf), np.empty(nf), np.empty(len(phase)),
    )  # fmt: skip
    came_back: tuple[int, int] = _advance(
        n_steps, h, t, target_speed, free, forced, stiffness, rate, reach, mean_speed, curves,
        motors, loads, timed, dampers, electrical, q, v, phase, force, force_rate, out_q, out_v,
        out_f, out_fr, space,
    )  # fmt: skip
    return came_back


@kernel()
def drive_modes(
    free: Floats, forced: Floats, cubic: Floats, q: Floats, v: Floats, out_q: Floats, out_v: Floats
) -> None:
    """Uncoupled modes under prescribed modal forces.

    Parameters
    ----------
    free, forced : ndarray, shape (n_modes, 2, 2) and (n_modes, 2, 4)
        Coefficients of the step. [SI]
    cubic : ndarray, shape (n_steps, n_modes, 4)
        Coefficients of the modal force over each step. [SI]
    q, v : ndarray, shape (n_modes,)
        State, updated. [SI]
    out_q, out_v : ndarray, shape (n_steps, n_modes)
        State after each step. [SI]
    """
    for k in range(cubic.shape[0]):
        for i in range(len(q)):
            c = cubic[k, i]
            x = free[i, 0, 0] * q[i] + free[i, 0, 1] * v[i]
            y = free[i, 1, 0] * q[i] + free[i, 1, 1] * v[i]
            for j in range(4):
                x += forced[i, 0, j] * c[j]
                y += forced[i, 1, j] * c[j]
            q[i], v[i] = x, y
            out_q[k, i], out_v[k, i] = x, y


@kernel()
def drive_coupled(free: Floats, forced: Floats, cubic: Floats, state: Floats, out: Floats) -> None:
    """A coupled linear system under prescribed forces.

    Parameters
    ----------
    free, forced : ndarray, shape (n_state, n_state) and (n_state, n_modes, 4)
        Coefficients of the step. [SI]
    cubic : ndarray, shape (n_steps, n_modes, 4)
        Coefficients of the modal force over each step. [SI]
    state : ndarray, shape (n_state,)
        State, updated. [SI]
    out : ndarray, shape (n_steps, n_state)
        State after each step. [SI]
    """
    n_state, n_modes = forced.shape[0], forced.shape[1]
    new = np.empty(n_state)
    for k in range(cubic.shape[0]):
        for i in range(n_state):
            x = 0.0
            for j in range(n_state):
                x += free[i, j] * state[j]
            for j in range(n_modes):
                for p in range(4):
                    x += forced[i, j, p] * cubic[k, j, p]
            new[i] = x
        for i in range(n_state):
            state[i] = new[i]
            out[k, i] = new[i]


@kernel()
def turning_points(t: Floats, y: Floats, slope: Floats) -> tuple[Floats, Floats]:
    """Times and values of all turning points of a piecewise cubic Hermite curve.

    A turning point within rounding of a sample may come twice, but is never missed. Two samples at
    one time are a corner or a jump: both values count where the curve turns or jumps there.

    Parameters
    ----------
    t : ndarray, shape (n,)
        Rising times. [s]
    y, slope : ndarray, shape (n,)
        Values, of any unit, and their rates. [N m, N m/s]

    Returns
    -------
    when, value : ndarray
        Times and values. [s, N m]
    """
    n = len(t)
    when, value = np.empty(2 * n), np.empty(2 * n)
    found = 0
    size = 0.0
    for i in range(n):
        size = max(size, abs(y[i]))
    for i in range(n - 1):
        h = t[i + 1] - t[i]
        if h <= 0.0:
            # in free flight the slope is zero on one side: entry and exit are its turning points
            if abs(y[i + 1] - y[i]) > 1e-9 * size or slope[i] * slope[i + 1] <= 0.0:
                for j in range(i, i + 2):
                    when[found] = t[j]
                    value[found] = y[j]
                    found += 1
            continue
        d0, d1 = h * slope[i], h * slope[i + 1]
        rise = y[i + 1] - y[i]
        # derivative of the Hermite cubic: d0 + b s + c s²
        b = 6.0 * rise - 4.0 * d0 - 2.0 * d1
        c = 3.0 * (d0 + d1) - 6.0 * rise
        disc = b * b - 4.0 * c * d0
        if disc <= 0.0:
            continue
        root = np.sqrt(disc)
        w = -0.5 * (b + root) if b >= 0.0 else -0.5 * (b - root)
        s1 = d0 / w if w != 0.0 else -1.0
        s2 = w / c if c != 0.0 else -1.0
        if s1 > s2:
            s1, s2 = s2, s1
        for s in (s1, s2):
            if -1e-12 <= s <= 1.0 + 1e-12:
                s = min(max(s, 0.0), 1.0)
                when[found] = t[i] + s * h
                value[found] = y[i] + s * (d0 + s * (0.5 * b + s * c / 3.0))
                found += 1
    return when[:found].copy(), value[:found].copy()
