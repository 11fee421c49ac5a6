"""The event-driven loop: exact steps of a piecewise linear system, and where its pieces meet.

The system is linear as long as no clearance changes its contact. Each combination of contacts is a
*piece* with modes of its own, in which the exponential step is exact; all pieces share one basis, so
that going from one to the next is a rotation of the modal coordinates. A step is tried, the cubic
through values and rates at its ends tells whether a contact changes within it, and the instant is
then found by exact steps of shorter length, so that it does not depend on that cubic.

A clearance has two flanks, each with a contact of its own: `FREE`; `DRIVE` or `DRIVE_LIMITED`;
`BACK` or `BACK_LIMITED`. All drive flanks come first, then all back flanks, everywhere. (Both
flanks of a mesh can be loaded at once where gears on bearings are pressed into each other.) With
δ the compression of the flank, F = k δ + c δ̇ in contact; it ends where F would pull. With the law
that also keeps the damping below the spring force, F = 2 k δ (*limited*) while c δ̇ > k δ. The part
of F beyond k δ is a force of its own, at each flank one: it changes its law at the same state, so
that the acceleration is continuous there, and the piece stays the same.

The step follows what rings: a mode whose ringing shows in an answer is sampled as finely as the
pulsation is, any other mode may be passed over, since its motion is exact whatever the step.
"""

# numba compiles these bodies; plain loops are what it compiles best
from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from engine.stepping.compiling import kernel
from engine.stepping.linear_loop import start_forces

__all__ = [
    "ANGLE",
    "AT_TIME",
    "BACK",
    "BACK_LIMITED",
    "DRIVE",
    "DRIVE_LIMITED",
    "FREE",
    "MORE",
    "NEW_PIECE",
    "RECOVERS",
    "SPEED",
    "STUCK",
    "advance_pieces",
    "mode_step",
]

Floats = NDArray[np.float64]

#: Contact of a flank; the last one is a free flank that is still compressed, in the log only, where
#: it takes load again without having left.
FREE, DRIVE, DRIVE_LIMITED, BACK, BACK_LIMITED, RECOVERS = 0, 1, 2, 3, 4, 5
#: Why the loop came back: more room wanted, end time, mean speed, load angle, a piece that has to
#: be made first, no progress.
MORE, AT_TIME, SPEED, ANGLE, NEW_PIECE, STUCK = 0, 1, 2, 3, 4, 5
#: Ringing, over an answer's scale, that is sampled as finely as the pulsation; smaller ringing by
#: wider angles, up to this many radians.
FULL_RINGING, WIDEST_ANGLE = 0.1, 2.4
#: Shares of a clearance's torque scale: force at which a flank that has not yet recovered takes load
#: again, and pull that counts as none.
RETAKE, PULL = 1e-7, 1e-13
#: After so many events at one instant a step is taken without looking for more; after so many such
#: steps in a row the loop gives up.
MOST_AT_ONCE, MOST_DWELLS = 8, 10_000


@kernel(_nrt=False)
def mode_step(stiffness: float, rate: float, h: float, free: Floats, forced: Floats) -> None:
    """Coefficients of one exponential step of one mode, as `exponential.exponential_step` gives them.

    Parameters
    ----------
    stiffness : float
        λ = ω². [1/s²]
    rate : float
        Damping coefficient d. [1/s]
    h : float
        Step. [s]
    free : ndarray, shape (2, 2)
        Receives the map of (q, q̇). [1, s, 1/s]
    forced : ndarray, shape (2, 4)
        Receives the map of (u₀, u̇₀, u₁, u̇₁) to (q, q̇). [s², s³ and 1/s of each]
    """
    L, D = stiffness * h * h, rate * h
    a = 0.5 * D
    apart = a * a - L >= 1.0
    response = forced  # first the answers to u = s^j, each from rest
    if apart:
        fast = a + math.sqrt(a * a - L)
        slow = L / fast
        late, early, gap = math.exp(-slow), math.exp(-fast), fast - slow
        f00, f01 = (fast * late - slow * early) / gap, (late - early) / gap
        f11 = (fast * early - slow * late) / gap
        first, second = _phi(slow), _phi(fast)
        response[0, 0] = (first[1] - second[1]) / gap
        response[0, 1] = (first[2] - second[2]) / gap
        response[0, 2] = 2.0 * (first[3] - second[3]) / gap
        response[0, 3] = 6.0 * (first[4] - second[4]) / gap
        response[1, 0] = (first[0] - second[0]) / gap
        response[1, 1] = (first[1] - second[1]) / gap
        response[1, 2] = 2.0 * (first[2] - second[2]) / gap
        response[1, 3] = 6.0 * (first[3] - second[3]) / gap
    else:
        beta = math.sqrt(max(L - a * a, 0.0))
        gamma = math.sqrt(max(a * a - L, 0.0))
        decay = math.exp(-a)
        wave = math.sin(beta) / beta if beta > 1e-8 else 1.0
        bend = math.sinh(gamma) / gamma if gamma > 1e-8 else 1.0
        rise = math.cosh(gamma) if gamma > 0.0 else 1.0
        cosine, sine = decay * math.cos(beta) * rise, decay * wave * bend
        f00, f01, f11 = cosine + a * sine, sine, cosine - a * sine
        if L > 4.0:
            before, last, factorial = f11, f01, 1.0
            for j in range(4):
                if j > 1:
                    factorial *= j
                response[1, j] = factorial * last
                before, last = last, (1.0 / factorial - D * last - before) / L
                response[0, j] = factorial * last
        else:
            _series(L, D, response)
    free[0, 0], free[0, 1] = f00, h * f01
    free[1, 0], free[1, 1] = -L * f01 / h, f11
    for i in range(2):
        c0, c1, c2, c3 = response[i, 0], response[i, 1], response[i, 2], response[i, 3]
        size = h * h if i == 0 else h
        forced[i, 0] = size * (c0 - 3.0 * c2 + 2.0 * c3)
        forced[i, 1] = size * h * (c1 - 2.0 * c2 + c3)
        forced[i, 2] = size * (3.0 * c2 - 2.0 * c3)
        forced[i, 3] = size * h * (c3 - c2)


@kernel(_nrt=False)
def _series(L: float, D: float, response: Floats) -> None:
    """Answers of ẍ + D ẋ + L x = s^j at s = 1, from rest, for j = 0 … 3, by their Taylor series.

    The four run side by side: each waits for its own divisions, not for those of the others.
    """
    x0, x1, x2, x3 = 0.0, 0.0, 0.0, 0.0
    y0, y1, y2, y3 = 0.0, 0.0, 0.0, 0.0
    before0, before1, before2, before3 = 0.0, 0.0, 0.0, 0.0
    last0, last1, last2, last3 = 0.0, 0.0, 0.0, 0.0
    for k in range(60):
        damped, size, more = -D * (k + 1), float((k + 2) * (k + 1)), float(k + 2)
        new0 = damped * last0 - L * before0
        new1 = damped * last1 - L * before1
        new2 = damped * last2 - L * before2
        new3 = damped * last3 - L * before3
        if k == 0:
            new0 += 1.0
        elif k == 1:
            new1 += 1.0
        elif k == 2:
            new2 += 1.0
        elif k == 3:
            new3 += 1.0
        new0, new1, new2, new3 = new0 / size, new1 / size, new2 / size, new3 / size
        x0, x1, x2, x3 = x0 + new0, x1 + new1, x2 + new2, x3 + new3
        y0, y1, y2, y3 = y0 + more * new0, y1 + more * new1, y2 + more * new2, y3 + more * new3
        before0, before1, before2, before3 = last0, last1, last2, last3
        last0, last1, last2, last3 = new0, new1, new2, new3
        if k > 4:
            largest = max(abs(new0) + abs(before0), abs(new1) + abs(before1))
            largest = max(largest, abs(new2) + abs(before2), abs(new3) + abs(before3))
            if largest < 1e-19:
                break
    response[0, 0], response[0, 1], response[0, 2], response[0, 3] = x0, x1, x2, x3
    response[1, 0], response[1, 1], response[1, 2], response[1, 3] = y0, y1, y2, y3


@kernel(_nrt=False)
def _phi(x: float) -> tuple[float, float, float, float, float]:
    """φ₀ … φ₄ at −x for x ≥ 0 (see `exponential`)."""
    none = math.exp(-x)
    if x >= 1.0:
        one = (1.0 - none) / x
        two = (1.0 - one) / x
        three = (0.5 - two) / x
        return none, one, two, three, (1.0 / 6.0 - three) / x
    return (
        none,
        _phi_series(x, 1, 1.0),
        _phi_series(x, 2, 2.0),
        _phi_series(x, 3, 6.0),
        _phi_series(x, 4, 24.0),
    )


@kernel(_nrt=False)
def _phi_series(x: float, k: int, factorial: float) -> float:
    """φₖ at −x for x below 1, by its Taylor series."""
    term = 1.0 / factorial
    total = term
    for n in range(1, 20):
        term *= -x / (k + n)
        total += term
    return total


@kernel(_nrt=False)
def _first_fall(g0: float, d0: float, g1: float, d1: float) -> float:
    """Where in [0, 1] the Hermite cubic first falls through zero; 2 if it does not.

    d0 and d1 are rates per step. A curve that starts at or below zero and rises is not falling.
    """
    if g0 <= 0.0 and (d0 < 0.0 or (d0 == 0.0 and g1 < 0.0)):
        return 0.0
    # Where the control points of the curve lie well above zero, so does all of it: most steps.
    least = 1e-12 * (abs(g0) + abs(d0) + abs(g1) + abs(d1))
    if g0 > least and g1 > least and g0 + d0 / 3.0 > least and g1 - d1 / 3.0 > least:
        return 2.0
    rise = g1 - g0
    b = 3.0 * rise - 2.0 * d0 - d1
    c = d0 + d1 - 2.0 * rise
    low, value = 0.0, g0
    disc = b * b - 3.0 * c * d0
    end0, end1 = 0.0, 0.0  # where it turns within the step; 0 where it does not
    if disc > 0.0:
        root = math.sqrt(disc)
        w = -(b + root) if b >= 0.0 else -(b - root)
        s1 = d0 / w if w != 0.0 else -1.0
        s2 = w / (3.0 * c) if c != 0.0 else -1.0
        if s1 > s2:
            s1, s2 = s2, s1
        if 0.0 < s1 < 1.0:
            end0 = s1
        if 0.0 < s2 < 1.0 and s2 > s1:
            end1 = s2
    for i in range(3):
        high = end0 if i == 0 else end1 if i == 1 else 1.0
        if high == 0.0:
            continue
        new = g1 if high == 1.0 else g0 + high * (d0 + high * (b + high * c))
        if value > 0.0 and new <= 0.0:
            for _ in range(60):
                middle = 0.5 * (low + high)
                if g0 + middle * (d0 + middle * (b + middle * c)) > 0.0:
                    low = middle
                else:
                    high = middle
            return float(high)
        low, value = high, new
    return 2.0


@kernel(_nrt=False)
def _condition(
    kind: int, twist: float, speed: float, acceleration: float, k: float, c: float, scale: float
) -> tuple[float, float]:
    """What must stay positive for a contact to last, and its rate.

    Kinds: 0 a free flank touches, 1 a free flank that is still compressed takes load again, 2 a
    loaded flank parts, 3 its damping passes the spring force, 4 the limited damping falls below it.
    Load is taken again at `RETAKE` of the scale: the damping of the pieces differs by that of
    their modes, and with one threshold for both a flank could part and load without end.
    """
    if kind == 0:
        return -twist, -speed
    if kind == 1:
        return RETAKE * scale - (k * twist + c * speed), -(k * speed + c * acceleration)
    if kind == 2:
        return PULL * scale + k * twist + c * speed, k * speed + c * acceleration
    if kind == 3:
        return k * twist - c * speed, k * speed - c * acceleration
    return c * speed - k * twist, c * acceleration - k * speed


@kernel(inline="always")
def _limited_forces(
    flanks: tuple[Any, ...], reach: Floats, q: Floats, speed: Floats, force: Floats, rate: Floats
) -> None:
    """Damping force of flanks where it is kept at the spring force."""
    contact, gaps, stiffnesses, first = flanks
    for c in range(len(gaps)):
        if contact[c] == DRIVE_LIMITED or contact[c] == BACK_LIMITED:
            f, x = first + c, -gaps[c]
            for i in range(len(q)):
                x += reach[f, i] * q[i]
            force[f] = -stiffnesses[c] * x
            rate[f] = -stiffnesses[c] * speed[f]


@kernel(inline="always", _nrt=False)
def _flank_dampers(contact: Any, dampings: Floats, viscous: Floats) -> int:
    """Coefficients of the flanks, the last of all dampers: zero unless in plain contact.

    Returns a number that tells which contacts are limited.
    """
    n = len(contact)
    first = len(viscous) - n
    key = 0
    for c in range(n):
        key = 2 * key + (1 if contact[c] == DRIVE_LIMITED or contact[c] == BACK_LIMITED else 0)
        plain = contact[c] == DRIVE or contact[c] == BACK
        viscous[first + c] = dampings[c] if plain else 0.0
    return key


@kernel(fastmath={"reassoc", "contract", "nsz"}, _nrt=False)
def _take_step(
    h: float,
    t: float,
    free: Floats,
    forced: Floats,
    solver: Floats,
    stiffness: Floats,
    rate: Floats,
    reach: Floats,
    constant: Floats,
    viscous: Floats,
    curves: tuple[Any, ...],
    motors: tuple[Any, ...],
    loads: tuple[Any, ...],
    timed: tuple[Any, ...],
    damper_force: Any,
    electrical: tuple[Any, ...],
    flanks: tuple[Any, ...],
    q: Floats,
    v: Floats,
    phase: Floats,
    force: Floats,
    force_rate: Floats,
    q1: Floats,
    v1: Floats,
    a1: Floats,
    phase1: Floats,
    f1: Floats,
    fr1: Floats,
    work: Floats,
) -> None:
    """One step of one piece: predict, evaluate, correct, evaluate (as `kernels.advance_start`).

    The forces of dampers at the end of the step are not iterated but solved for, together with
    their rates: cubic in the step and equal to the damper's law at both ends, they are stable
    however strong the damper is.
    """
    nf, n = reach.shape
    nd = len(damper_force)
    none = (damper_force[:0], viscous[:0])
    motor_force, pole_pairs, line_omega = motors[0], motors[4], motors[5]
    base_q, base_v, u1, r1 = work[0], work[1], work[2], work[3]
    speed, acceleration = work[4, :nf], work[5, :nf]
    end_v, end_a = work[6], work[7]
    for i in range(n):
        u1[i], r1[i] = constant[i], 0.0
    for f in range(nf):
        for i in range(n):
            u1[i] += reach[f, i] * force[f]
            r1[i] += reach[f, i] * force_rate[f]
    for i in range(n):
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
    for _ in range(2):
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
            none, electrical, f1, fr1,
        )  # fmt: skip
        _limited_forces(flanks, reach, q1, speed, f1, fr1)
        for i in range(n):
            u1[i], r1[i] = constant[i], 0.0
        for f in range(nf):
            for i in range(n):
                u1[i] += reach[f, i] * f1[f]
                r1[i] += reach[f, i] * fr1[f]
        if nd == 0:
            continue
        for i in range(n):
            end = base_v[i] + forced[1, 2, i] * u1[i] + forced[1, 3, i] * r1[i]
            place = base_q[i] + forced[0, 2, i] * u1[i] + forced[0, 3, i] * r1[i]
            end_v[i] = end
            end_a[i] = u1[i] - rate[i] * end - stiffness[i] * place
        for d in range(nd):  # motion across each damper without its own end force
            f = damper_force[d]
            x, y = 0.0, 0.0
            for i in range(n):
                x += reach[f, i] * end_v[i]
                y += reach[f, i] * end_a[i]
            speed[d], acceleration[d] = -viscous[d] * x, -viscous[d] * y
        for d in range(nd):
            f = damper_force[d]
            x, y = 0.0, 0.0
            for e in range(nd):
                x += solver[d, e] * speed[e] + solver[d, nd + e] * acceleration[e]
                y += solver[nd + d, e] * speed[e] + solver[nd + d, nd + e] * acceleration[e]
            f1[f] += x
            fr1[f] += y
            for i in range(n):
                u1[i] += reach[f, i] * x
                r1[i] += reach[f, i] * y
    for i in range(n):
        a1[i] = u1[i] - rate[i] * v1[i] - stiffness[i] * q1[i]


@kernel(_nrt=False)
def _invert(matrix: Floats, inverse: Floats) -> None:
    """Gauss–Jordan with row exchange; a handful of rows, and LAPACK would cost seconds to compile."""
    n = len(matrix)
    for i in range(n):
        for j in range(n):
            inverse[i, j] = 1.0 if i == j else 0.0
    for i in range(n):
        pivot = i
        for k in range(i + 1, n):
            if abs(matrix[k, i]) > abs(matrix[pivot, i]):
                pivot = k
        for j in range(n):
            matrix[i, j], matrix[pivot, j] = matrix[pivot, j], matrix[i, j]
            inverse[i, j], inverse[pivot, j] = inverse[pivot, j], inverse[i, j]
        scale = 1.0 / matrix[i, i]
        for j in range(n):
            matrix[i, j] *= scale
            inverse[i, j] *= scale
        for k in range(n):
            factor = matrix[k, i]
            if k != i and factor != 0.0:
                for j in range(n):
                    matrix[k, j] -= factor * matrix[i, j]
                    inverse[k, j] -= factor * inverse[i, j]


@kernel(_nrt=False)
def _damper_solver(
    forced: Floats,
    stiffness: Floats,
    rate: Floats,
    reach: Floats,
    damper_force: Any,
    viscous: Floats,
    solver: Floats,
    matrix: Floats,
) -> None:
    """Inverse of what damper forces and rates at the end of a step do to themselves.

    `matrix` is room to work in, as large as `solver`.
    """
    nd, n = len(damper_force), reach.shape[1]
    for d in range(2 * nd):
        for e in range(2 * nd):
            matrix[d, e] = 1.0 if d == e else 0.0
    for d in range(nd):
        if viscous[d] == 0.0:
            continue
        for e in range(nd):
            ww, wr, aw, ar = 0.0, 0.0, 0.0, 0.0
            for i in range(n):
                both = reach[damper_force[d], i] * reach[damper_force[e], i]
                ww += both * forced[1, 2, i]
                wr += both * forced[1, 3, i]
                aw += both * (1.0 - rate[i] * forced[1, 2, i] - stiffness[i] * forced[0, 2, i])
                ar -= both * (rate[i] * forced[1, 3, i] + stiffness[i] * forced[0, 3, i])
            matrix[d, e] += viscous[d] * ww
            matrix[d, nd + e] += viscous[d] * wr
            matrix[nd + d, e] += viscous[d] * aw
            matrix[nd + d, nd + e] += viscous[d] * ar
    _invert(matrix, solver)


@kernel(_nrt=False)
def _fresh_forces(
    t: float,
    inside: float,
    stiffness: Floats,
    rate: Floats,
    reach: Floats,
    constant: Floats,
    viscous: Floats,
    curves: tuple[Any, ...],
    motors: tuple[Any, ...],
    loads: tuple[Any, ...],
    timed: tuple[Any, ...],
    damper_force: Any,
    electrical: tuple[Any, ...],
    flanks: tuple[Any, ...],
    q: Floats,
    v: Floats,
    a: Floats,
    phase: Floats,
    force: Floats,
    force_rate: Floats,
    work: Floats,
) -> None:
    """Forces, rates and accelerations of a state, after something has jumped."""
    nf, n = reach.shape
    speed, acceleration = work[4, :nf], work[5, :nf]
    for f in range(nf):
        x = 0.0
        for i in range(n):
            x += reach[f, i] * v[i]
        speed[f], acceleration[f] = x, 0.0
    for _ in range(3):  # rates depend on the acceleration that the forces cause
        start_forces(
            t, inside, phase, speed, acceleration, curves, motors, loads, timed,
            (damper_force, viscous), electrical, force, force_rate,
        )  # fmt: skip
        _limited_forces(flanks, reach, q, speed, force, force_rate)
        for i in range(n):
            a[i] = constant[i] - rate[i] * v[i] - stiffness[i] * q[i]
        for f in range(nf):
            for i in range(n):
                a[i] += reach[f, i] * force[f]
        for f in range(nf):
            y = 0.0
            for i in range(n):
                y += reach[f, i] * a[i]
            acceleration[f] = y


@kernel(_nrt=False)
def _flank(rows: Floats, gap: float, q: Floats, v: Floats, a: Floats) -> tuple[float, float, float]:
    """Compression of one flank, its rate and the rate of that."""
    x, y, z = -gap, 0.0, 0.0
    for i in range(len(q)):
        x += rows[i] * q[i]
        y += rows[i] * v[i]
        z += rows[i] * a[i]
    return x, y, z


@kernel(_nrt=False)
def _write(
    row: int,
    t: float,
    piece: int,
    q: Floats,
    v: Floats,
    force: Floats,
    force_rate: Floats,
    phase: Floats,
    out: tuple[Any, ...],
) -> int:
    """Write one row of output; returns the number of the next."""
    out_t, out_q, out_v, out_f, out_fr, out_phase, out_piece = out
    out_t[row] = t
    out_piece[row] = piece
    for i in range(len(q)):
        out_q[row, i], out_v[row, i] = q[i], v[i]
    for f in range(len(force)):
        out_f[row, f], out_fr[row, f] = force[f], force_rate[f]
    for m in range(len(phase)):
        out_phase[row, m] = phase[m]
    return row + 1


@kernel(_nrt=False)
def _accept(
    q1: Floats,
    v1: Floats,
    phase1: Floats,
    f1: Floats,
    fr1: Floats,
    q: Floats,
    v: Floats,
    phase: Floats,
    force: Floats,
    force_rate: Floats,
) -> None:
    """Take the end of a step as the new state."""
    for i in range(len(q)):
        q[i], v[i] = q1[i], v1[i]
    for m in range(len(phase)):
        phase[m] = phase1[m] % (4.0 * math.pi)
    for f in range(len(force)):
        force[f], force_rate[f] = f1[f], fr1[f]


@kernel(_nrt=False)
def _copy(source: Floats, target: Floats) -> None:
    """Numbers of one array into another."""
    for i in range(len(source)):
        target[i] = source[i]


@kernel(_nrt=False)
def _rotate(turn: Floats, back: bool, x: Floats, work: Floats) -> None:
    """Modal coordinates of a piece into the common basis, or back."""
    n = len(x)
    for i in range(n):
        work[i] = 0.0
    for i in range(n):
        for j in range(n):
            if back:
                work[j] += turn[i, j] * x[i]
            else:
                work[i] += turn[i, j] * x[j]
    for i in range(n):
        x[i] = work[i]


@kernel(_nrt=False)
def _coefficients(
    h: float, stiffness: Floats, rate: Floats, free: Floats, forced: Floats, one: tuple[Any, ...]
) -> None:
    """Coefficients of one step for every mode of a piece."""
    for i in range(len(stiffness)):
        mode_step(stiffness[i], rate[i], h, one[0], one[1])
        for a in range(2):
            for b in range(2):
                free[a, b, i] = one[0][a, b]
            for b in range(4):
                forced[a, b, i] = one[1][a, b]


@kernel(_nrt=False)
def _advance(
    clock: Floats,
    end_time: float,
    base_step: float,
    visible: float,
    targets: Floats,
    limited: bool,
    tables: tuple[Any, ...],
    contacts: tuple[Any, ...],
    curves: tuple[Any, ...],
    motors: tuple[Any, ...],
    loads: tuple[Any, ...],
    timed: tuple[Any, ...],
    damper_force: Any,
    electrical: tuple[Any, ...],
    piece: Any,
    contact_of: Any,
    q: Floats,
    v: Floats,
    phase: Floats,
    force: Floats,
    force_rate: Floats,
    out_t: Floats,
    out_q: Floats,
    out_v: Floats,
    out_f: Floats,
    out_fr: Floats,
    out_phase: Floats,
    out_piece: Any,
    log: Floats,
    space: tuple[Any, ...],
) -> tuple[int, int, int]:
    """`advance_pieces` with the room it works in."""
    (keys, lam, rates, reaches, constants, means, flank_rows, dampers, shows, turns, frees,
     forceds, solvers, made) = tables  # fmt: skip
    gaps, stiffnesses, dampings, scales = contacts
    flanks = (contact_of, gaps, stiffnesses, reaches.shape[1] - len(gaps))
    (viscous, q1, v1, a1, a0, phase1, f1, fr1, work, free_t, forced_t, solver_t, matrix, one,
     rotated) = space  # fmt: skip
    for d in range(len(viscous)):
        viscous[d] = dampers[piece[0], d]
    limit_key = _flank_dampers(contact_of, dampings, viscous)
    room = len(out_t)
    nf, n = reaches.shape[1], reaches.shape[2]
    nc = len(gaps)
    levels = frees.shape[1]
    out = (out_t, out_q, out_v, out_f, out_fr, out_phase, out_piece)
    rows, events, at_once, dwells = 0, 0, 0, 0
    t = clock[0]
    fresh = clock[1] > 0.0
    sampled = targets[3]
    while True:
        s = piece[0]
        if rows >= room - 2 or events >= len(log) - 1:
            clock[0], clock[1] = t, 1.0
            return rows, events, MORE
        if fresh:
            _fresh_forces(
                t, t + 1e-6 * base_step, lam[s], rates[s], reaches[s], constants[s], viscous,
                curves, motors, loads, timed, damper_force, electrical, flanks, q, v, a0, phase, force,
                force_rate, work,
            )  # fmt: skip
            fresh = False
            if clock[1] > 1.0:
                clock[1] = 0.0
                rows = _write(rows, t, s, q, v, force, force_rate, phase, out)
        else:
            _copy(a1, a0)
        # the step: as long as what rings visibly is resolved
        level = 0
        finest = 1.0  # the base step over the step wanted
        angle = base_step * sampled
        slowest = n  # the first mode that the base step does not sample
        while slowest > 0 and lam[s, slowest - 1] > sampled * sampled:
            slowest -= 1
        push = work[0]
        for i in range(slowest, n):
            push[i] = constants[s, i]
        for f in range(nf):
            for i in range(slowest, n):
                push[i] += reaches[s, f, i] * force[f]
        for i in range(slowest, n):
            x = q[i] - push[i] / lam[s, i]
            ringing = shows[s, i] * math.sqrt(x * x + v[i] * v[i] / lam[s, i])
            if ringing > visible:
                # the cubic through two samples errs by ringing × angle⁴ / 384
                allowed = min(angle * math.sqrt(math.sqrt(FULL_RINGING / ringing)), WIDEST_ANGLE)
                finest = max(finest, math.sqrt(lam[s, i]) * base_step / allowed)
        if finest > 1.0:
            level = int(math.ceil(math.log2(finest)))
        # contacts that would change to and fro at one instant (the damping of the pieces differs)
        # are left alone for the shortest of all steps
        dwell = at_once > MOST_AT_ONCE
        level = levels - 1 if dwell else min(max(level, 0), levels - 1)
        h = base_step / 2.0**level
        remaining = end_time - t
        if remaining <= 1e-12 * base_step:
            clock[0], clock[1] = end_time, 1.0
            return rows, events, AT_TIME
        whole = h < remaining * (1.0 - 1e-9)
        if whole:
            if made[s, level] == 0:
                _coefficients(h, lam[s], rates[s], frees[s, level], forceds[s, level], one)
            if made[s, level] != 1 + limit_key:  # which flanks are limited enters the solver
                _damper_solver(
                    forceds[s, level], lam[s], rates[s], reaches[s], damper_force, viscous,
                    solvers[s, level], matrix,
                )  # fmt: skip
                made[s, level] = 1 + limit_key
            _take_step(
                h, t, frees[s, level], forceds[s, level], solvers[s, level], lam[s], rates[s], reaches[s],
                constants[s], viscous, curves, motors, loads, timed, damper_force, electrical, flanks,
                q, v, phase, force, force_rate, q1, v1, a1, phase1, f1, fr1, work,
            )  # fmt: skip
        else:
            h = remaining
            _coefficients(h, lam[s], rates[s], free_t, forced_t, one)
            _damper_solver(
                forced_t, lam[s], rates[s], reaches[s], damper_force, viscous, solver_t, matrix
            )
            _take_step(
                h, t, free_t, forced_t, solver_t, lam[s], rates[s], reaches[s], constants[s], viscous,
                curves, motors, loads, timed, damper_force, electrical, flanks, q, v, phase, force,
                force_rate, q1, v1, a1, phase1, f1, fr1, work,
            )  # fmt: skip
        # the first event within the step, by the cubic
        first, which, kind_of = 2.0, -1, -1
        for c in range(nc):
            if dwell:
                break
            state = contact_of[c]
            k, damping, gap = stiffnesses[c], dampings[c], gaps[c]
            if math.isinf(gap):
                continue
            row = flank_rows[s, c]
            x0, y0, z0 = _flank(row, gap, q, v, a0)
            x1, y1, z1 = _flank(row, gap, q1, v1, a1)
            if state == FREE:
                kinds = (0, 1) if damping > 0.0 else (0, 0)
            elif state == DRIVE or state == BACK:
                kinds = (2, 3) if limited and damping > 0.0 else (2, 2)
            else:
                kinds = (4, 4)
            for j in range(2):
                kind = kinds[j]
                if j == 1 and kinds[0] == kinds[1]:
                    break
                if kind == 1 and x0 <= 0.0:
                    continue
                if kind == 0 and x0 > 0.0 and y0 > 0.0 and damping > 0.0:
                    continue  # compressed still: kind 1 watches
                g0, d0 = _condition(kind, x0, y0, z0, k, damping, scales[c])
                g1, d1 = _condition(kind, x1, y1, z1, k, damping, scales[c])
                where = _first_fall(g0, d0 * h, g1, d1 * h)
                if where < first:
                    first, which, kind_of = where, c, kind
        for j in range(3):
            g0, d0, g1, d1 = 1.0, 0.0, 1.0, 0.0
            if j < 2:
                if math.isinf(targets[j]):
                    continue
                sign = 1.0 if j == 0 else -1.0
                w0, x0, w1, x1 = 0.0, 0.0, 0.0, 0.0
                for i in range(n):
                    w0 += means[s, i] * v[i]
                    x0 += means[s, i] * a0[i]
                    w1 += means[s, i] * v1[i]
                    x1 += means[s, i] * a1[i]
                g0, d0 = sign * (targets[j] - w0), -sign * x0
                g1, d1 = sign * (targets[j] - w1), -sign * x1
                if g0 <= 0.0:
                    g0, d0 = 0.0, -1.0
            else:
                if math.isnan(targets[2]):
                    continue
                # the load angle rises through the wanted one: −sin(δ − δ*) falls with cos > 0
                before, after = 0.5 * phase[0] - targets[2], 0.5 * phase1[0] - targets[2]
                if math.cos(before) <= 0.0 and math.cos(after) <= 0.0:
                    continue
                rate0 = 0.5 * (phase1[0] - phase[0])
                g0, d0 = -math.sin(before), -math.cos(before) * rate0
                g1, d1 = -math.sin(after), -math.cos(after) * rate0
                if g0 <= 0.0 and d0 < 0.0 and before != 0.0:
                    continue  # passed already; the next turn will do
            where = _first_fall(g0, d0 * h, g1, d1 * h) if j < 2 else _first_fall(g0, d0, g1, d1)
            if where < first:
                first, which, kind_of = where, -2 - j, -1
        if first > 1.0:  # nothing happened
            t = t + h if whole else end_time
            at_once = 0
            dwells = dwells + 1 if dwell else 0
            _accept(q1, v1, phase1, f1, fr1, q, v, phase, force, force_rate)
            rows = _write(rows, t, s, q, v, force, force_rate, phase, out)
            continue
        # the instant, by exact steps: a bracket [low, high] with the condition lost at its end
        low, high, tau = 0.0, h, first * h
        flank_speed = 0.0
        lost = True
        for _ in range(60):
            if tau <= 0.0:
                _copy(q, q1)
                _copy(v, v1)
                _copy(a0, a1)
                _copy(phase, phase1)
                _copy(force, f1)
                _copy(force_rate, fr1)
            else:
                _coefficients(tau, lam[s], rates[s], free_t, forced_t, one)
                _damper_solver(
                    forced_t, lam[s], rates[s], reaches[s], damper_force, viscous, solver_t, matrix
                )
                _take_step(
                    tau, t, free_t, forced_t, solver_t, lam[s], rates[s], reaches[s], constants[s],
                    viscous, curves, motors, loads, timed, damper_force, electrical, flanks, q, v,
                    phase, force, force_rate, q1, v1, a1, phase1, f1, fr1, work,
                )  # fmt: skip
            if which >= 0:
                x1, y1, z1 = _flank(flank_rows[s, which], gaps[which], q1, v1, a1)
                flank_speed = y1
                g, d = _condition(
                    kind_of, x1, y1, z1, stiffnesses[which], dampings[which], scales[which]
                )
            elif which > -4:
                sign = 1.0 if which == -2 else -1.0
                w1, x1 = 0.0, 0.0
                for i in range(n):
                    w1 += means[s, i] * v1[i]
                    x1 += means[s, i] * a1[i]
                g, d = sign * (targets[-2 - which] - w1), -sign * x1
            else:
                after = 0.5 * phase1[0] - targets[2]
                g, d = (
                    -math.sin(after),
                    -math.cos(after) * 0.5 * (phase1[0] - phase[0]) / max(tau, 1e-300),
                )
            if tau <= 0.0:
                break
            if g <= 0.0:
                high = tau
            else:
                low = tau
            new = tau - g / d if d < 0.0 else 0.5 * (low + high)
            if not low < new < high:
                new = 0.5 * (low + high)
            if abs(new - tau) <= 1e-13 * h + 4e-16 * t or high - low <= 1e-13 * h + 4e-16 * t:
                lost = g <= 0.0 or d < 0.0
                break
            tau = new
        t = t + tau
        at_once = at_once + 1 if tau <= 1e-9 * h else 0
        _copy(a1, a0)
        _accept(q1, v1, phase1, f1, fr1, q, v, phase, force, force_rate)
        rows = _write(rows, t, s, q, v, force, force_rate, phase, out)
        if dwells > MOST_DWELLS:
            clock[0], clock[1] = t, 1.0
            return rows, events, STUCK
        if which < 0:
            clock[0], clock[1] = t, 1.0
            return rows, events, SPEED if which > -4 else ANGLE
        if not lost:
            continue  # the cubic saw a touch that the exact step does not have
        if kind_of == 1 and x1 <= 0.0:
            continue  # it has left meanwhile, and is damped already before it touches: kind 0 watches
        before_contact = contact_of[which]
        if kind_of == 0 or kind_of == 1:
            start_limited = kind_of == 0 and limited and dampings[which] > 0.0
            loaded = DRIVE if 2 * which < nc else BACK
            after_contact = loaded + (1 if start_limited else 0)
            if kind_of == 1:
                before_contact = RECOVERS
        elif kind_of == 2:
            after_contact = FREE
        elif kind_of == 3:
            after_contact = before_contact + 1
        else:
            after_contact = before_contact - 1
        contact_of[which] = after_contact
        log[events, 0], log[events, 1] = t, which % (nc // 2)
        log[events, 2], log[events, 3], log[events, 4] = before_contact, after_contact, flank_speed
        events += 1
        limit_key = _flank_dampers(contact_of, dampings, viscous)
        key = 0
        for c in range(nc - 1, -1, -1):
            key = 2 * key + (1 if contact_of[c] != FREE else 0)  # limited or not: the same piece
        other = -1
        for p in range(len(keys)):
            if keys[p] == key:
                other = p
        # into the common basis; from there into the new piece once it is known
        _rotate(turns[s], False, q, rotated)
        _rotate(turns[s], False, v, rotated)
        if other < 0:
            piece[0] = -1
            clock[0], clock[1] = t, 2.0
            return rows, events, NEW_PIECE
        _rotate(turns[other], True, q, rotated)
        _rotate(turns[other], True, v, rotated)
        piece[0] = other
        s = other
        _fresh_forces(
            t, t + 1e-6 * base_step, lam[s], rates[s], reaches[s], constants[s], viscous,
            curves, motors, loads, timed, damper_force, electrical, flanks, q, v, a1, phase, force,
            force_rate, work,
        )  # fmt: skip
        rows = _write(rows, t, s, q, v, force, force_rate, phase, out)


@kernel()
def advance_pieces(
    clock: Floats,
    end_time: float,
    base_step: float,
    visible: float,
    targets: Floats,
    limited: bool,
    tables: tuple[Any, ...],
    contacts: tuple[Any, ...],
    curves: tuple[Any, ...],
    motors: tuple[Any, ...],
    loads: tuple[Any, ...],
    timed: tuple[Any, ...],
    damper_force: Any,
    electrical: tuple[Any, ...],
    piece: Any,
    contact_of: Any,
    q: Floats,
    v: Floats,
    phase: Floats,
    force: Floats,
    force_rate: Floats,
    out_t: Floats,
    out_q: Floats,
    out_v: Floats,
    out_f: Floats,
    out_fr: Floats,
    out_phase: Floats,
    out_piece: Any,
    log: Floats,
) -> tuple[int, int, int]:
    """Steps from one event to the next until something has to be decided outside.

    At an event two rows are written for one instant, one a piece.

    Parameters
    ----------
    clock : ndarray, shape (2,)
        Time, updated; 1 if the forces have to be evaluated anew before the first step, 2 if that
        is to be written as a row of its own. [s, flag]
    end_time : float
        Time at which to stop exactly. [s]
    base_step : float
        Longest step; others are this over powers of two. [s]
    visible : float
        Ringing above this share of the answers' scale is resolved. [1]
    targets : ndarray, shape (4,)
        Mean speed to stop at when it rises to it, when it falls to it; load angle of the first
        motor to stop at (nan = none); angular frequency sampled by the base step. [rad/s, rad]
    limited : bool
        True: contact damping never exceeds the spring force. [flag]
    tables : tuple
        Per piece: key, λ, d, reach, constant force, mean speed, rows of the flanks, damper
        coefficients, visibility of modes, rotation from the common basis, coefficients of the
        steps by level (free, forced, whether made). [SI]
    contacts : tuple
        Per flank: gap, stiffness, damping, torque scale. [rad, N m/rad, N m s/rad, N m]
    curves, motors, loads, timed, damper_force, electrical : tuple
        As for `kernels.start_forces`. [SI]
    piece : ndarray of int, shape (1,)
        Present piece, updated. [index]
    contact_of : ndarray of int, shape (n_flanks,)
        Contact of each flank, updated; those of the piece wanted when it has to be made. [1]
    q, v : ndarray, shape (n_modes,)
        Modal state of the present piece, updated. [SI]
    phase : ndarray, shape (n_motors,)
        Phase of each pulsation, updated. [rad]
    force, force_rate : ndarray, shape (n_forces,)
        Forces and rates, updated. [N m, N m/s]
    out_t, out_q, out_v, out_f, out_fr, out_phase, out_piece : ndarray
        Receive a row a step. [SI]
    log : ndarray, shape (n, 5)
        Receives time, clearance, contact of the flank before and after, and its speed of each
        event. [SI]

    Returns
    -------
    rows, events, reason : int
        Rows written, events logged, why the loop came back. [count]
    """
    n, nf, nd = len(q), len(force), len(damper_force)
    space = (
        np.empty(nd), np.empty(n), np.empty(n), np.empty(n), np.empty(n), np.empty(len(phase)),
        np.empty(nf), np.empty(nf), np.empty((8, max(n, nf, nd))), np.empty((2, 2, n)),
        np.empty((2, 4, n)), np.empty((2 * nd, 2 * nd)), np.empty((2 * nd, 2 * nd)),
        (np.empty((2, 2)), np.empty((2, 4))), np.empty(n),
    )  # fmt: skip
    came_back: tuple[int, int, int] = _advance(
        clock, end_time, base_step, visible, targets, limited, tables, contacts, curves, motors,
        loads, timed, damper_force, electrical, piece, contact_of, q, v, phase, force, force_rate,
        out_t, out_q, out_v, out_f, out_fr, out_phase, out_piece, log, space,
    )  # fmt: skip
    return came_back
