"""An integrator of its own for the hard starts: Dormand-Prince 8 in twists, speeds and slip angles.

It shares no code with the engine: no modes, no step control, no curves of the engine's. The state
is the twist of every element, the speed of every station and the slip angle of every motor, so
nothing grows with the turns of the train. The step is fixed and far below every period (that is
the hundredfold cost); where the law of a contact or the branch of a torque curve changes, the
moment is bisected and a step ends there. Everything is compiled: a million steps take a second.

`tests/hard_cases/test_reference.py` compares it with scipy's DOP853 and with itself at twice the
step.

Equations, for element e between stations a and b with speed ratios n (loss of contact apart):

    twist' = w_a − w_b n_a / n_b,   J w' = −Bᵀ (k twist + c twist') + motor + load
    slip angle' = 2 (ω_line − p w)

A clearance with total gap g begins with its drive flank touching (twist = 0). Drive flank:
δ = twist; back flank: δ = −twist − g; a flank presses with k δ + min(k δ, c δ') and never pulls
(law ``limited``), or with max(0, k δ + c δ') (law ``no adhesion``).
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray
from scipy.integrate._ivp import dop853_coefficients as dop
from scipy.interpolate import PchipInterpolator

from engine.case.choices import TorqueFollows
from engine.case.data import CaseData
from engine.model.load import NEAR_STANDSTILL, STANDSTILL_TIME, STANDSTILL_ZONE, WIDEST_ZONE
from tests.mean_speed import read_weights

__all__ = ["Answer", "Clearance", "RigidLink", "integrate", "rates_of", "state_size"]

Floats = NDArray[np.float64]

STAGES = dop.N_STAGES
A = np.ascontiguousarray(dop.A[:STAGES, :STAGES])
B8 = np.ascontiguousarray(dop.B)
C8 = np.ascontiguousarray(dop.C[:STAGES])
#: A moment of change is bisected to this share of a step.
BISECTIONS = 40
#: Two steps in which a sample comes this near to an extreme [1] are made again in so many parts each.
NEAR, CLOSER = 0.05, 16
#: Contact of a clearance, and the law there: spring and damper, parting without force, damping as
#: large as the spring force.
FREE, DRIVE, BACK = 0, 1, 2
PARTING, LIMITED = 1, 2
#: Speed of a motor whose curve jumps down: its torque on either side drives it back to the jump,
#: so that it is held there by what torque it takes (Filippov).
BELOW, ABOVE, HELD = 0, 1, 2


@dataclass(frozen=True)
class Clearance:
    """Clearance of an element: total gap [rad on its From side], and the law of contact."""

    gap: float
    law: str = "limited"


@dataclass(frozen=True)
class RigidLink:
    """A link so stiff that its two stations are one body of the reference.

    Its torque is what the body beyond it takes: the torque of the element behind it, and `share`
    of the torque that accelerates the body (the inertia beyond the link over the body's). With no
    element behind it (`behind` = −1) a station hangs on it that weighs nothing to the others.
    """

    behind: int
    body: int
    share: float


@dataclass(frozen=True, eq=False)
class Answer:
    """What the reference found: elements of its case first, then its rigid links.

    Extremes are elastic torques, from rest to the end; `tooth` are those of the whole force of a
    contact, damper included. Impacts (a flank is met after free flight), those of the back flank,
    time without force and fastest approach are by element.
    """

    maximum: Floats
    minimum: Floats
    tooth_maximum: Floats
    tooth_minimum: Floats
    speed: Floats
    mean_speed: float
    impacts: NDArray[np.int64]
    back_impacts: NDArray[np.int64]
    free_time: Floats
    approach: Floats
    time: Floats = field(repr=False)
    torque: Floats = field(repr=False)
    force: Floats = field(repr=False)
    """Torque of motors and loads on every station, at `time` (only where asked for)."""


# --- a case in arrays -----------------------------------------------------------------------------


def _curve(x: list[float], y: list[float]) -> tuple[Floats, Floats]:
    """Knots, and coefficients of rising powers from each knot."""
    found = PchipInterpolator(x, y)
    return np.array(x, dtype=float), np.ascontiguousarray(found.c[::-1].T)


def _stacked(curves: list[tuple[Floats, Floats]]) -> tuple[Floats, Floats, NDArray[np.int64]]:
    longest = max((len(x) for x, _ in curves), default=1)
    knots, cubics = np.zeros((len(curves), longest)), np.zeros((len(curves), longest, 4))
    for i, (x, c) in enumerate(curves):
        knots[i, : len(x)], cubics[i, : len(c)] = x, c
    return knots, cubics, np.array([len(x) for x, _ in curves], dtype=np.int64)


def arrays_of(
    case: CaseData,
    clearances: dict[str, Clearance],
    breaks: tuple[tuple[float, float], ...] = (),
) -> tuple[Any, ...]:
    """A case without rigid meshes and modal damping, as the compiled loop takes it."""
    assert case.damping_ratio is None
    assert not case.mode_damping
    names = [s.station for s in case.stations]
    inertia = np.array([s.inertia for s in case.stations], dtype=float)
    ratio = np.array([s.speed_ratio or 1.0 for s in case.stations])
    first = np.array([names.index(e.from_) for e in case.elements], dtype=np.int64)
    second = np.array([names.index(e.to) for e in case.elements], dtype=np.int64)
    gap = np.full(len(case.elements), -1.0)
    sticky = np.zeros(len(case.elements))
    for i, e in enumerate(case.elements):
        if e.element in clearances:
            gap[i] = clearances[e.element].gap
            sticky[i] = float(clearances[e.element].law == "no adhesion")
    train = (
        inertia, first, second, ratio[first] / ratio[second],
        np.array([e.stiffness for e in case.elements], dtype=float),
        np.array([e.damping or 0.0 for e in case.elements]), gap, sticky,
        np.array([s.damping or 0.0 for s in case.stations]),
        inertia * ratio / np.sum(inertia * ratio**2),
    )  # fmt: skip
    line, synchronous = case.ratings.line_frequency, case.ratings.synchronous_speed
    assert line is not None
    assert synchronous is not None
    curves, motor_rows, load_rows = [], [], []
    read: list[Floats] = []
    rows_of = np.zeros((len(first), len(names)))
    rows_of[np.arange(len(first)), first] = 1.0
    rows_of[np.arange(len(first)), second] = -ratio[first] / ratio[second]
    assert not breaks or case.torque_follows == TorqueFollows.OWN_SPEED
    voltage = (1.0 if case.voltage is None else case.voltage) ** 2
    for name in dict.fromkeys(r.station for r in case.motor_torque):
        rows = [r for r in case.motor_torque if r.station == name]
        at = names.index(name)
        x = [float(r.speed or 0.0) for r in rows]
        curves.append(_curve(x, [voltage * r.average for r in rows]))
        curves.append(_curve(x, [voltage * r.pulsating for r in rows]))
        full = synchronous * ratio[at]
        motor_rows.append((at, full, 2.0 * np.pi * line / full))
        read.append(read_weights(case, rows_of, train[4], inertia, ratio, at))
    for name in dict.fromkeys(r.station for r in case.load_torque):
        rows = [r for r in case.load_torque if r.station == name]
        at = names.index(name)
        x, y = [float(r.speed or 0.0) for r in rows], [r.torque for r in rows]
        curves.append(_curve(x, y))
        near = PchipInterpolator(x, y)(np.clip(np.linspace(0.0, NEAR_STANDSTILL, 11), x[0], x[-1]))
        full = synchronous * ratio[at]
        soft = max(STANDSTILL_ZONE * full, STANDSTILL_TIME * float(near.max()) / inertia[at])
        load_rows.append((at, full, min(soft, WIDEST_ZONE * full)))
    drives = (
        *_stacked(curves),
        np.array(motor_rows, dtype=float).reshape(-1, 3),
        np.array(load_rows, dtype=float).reshape(-1, 3),
        2.0 * np.pi * line,
        np.array(breaks, dtype=float).reshape(-1, 2),
        np.array(read).reshape(-1, len(names)),
    )
    return train, drives


# --- the equations --------------------------------------------------------------------------------


@njit(cache=True)
def _value(drives, curve, x):
    knots, cubics, counts = drives[0], drives[1], drives[2]
    last = counts[curve] - 1
    x = min(max(x, knots[curve, 0]), knots[curve, last])
    i = 0
    while i < last - 1 and knots[curve, i + 1] <= x:
        i += 1
    s = x - knots[curve, i]
    value = cubics[curve, i, 2] + s * cubics[curve, i, 3]
    return cubics[curve, i, 0] + s * (cubics[curve, i, 1] + s * value)


@njit(cache=True)
def _element(k, c, gap, law, twist, rate):
    """Elastic torque and whole torque of an element while its law holds."""
    if gap < 0.0:
        return k * twist, k * twist + c * rate
    side = law % 3
    if side == FREE:
        return 0.0, 0.0
    depth, speed, sign = (twist, rate, 1.0) if side == DRIVE else (-twist - gap, -rate, -1.0)
    spring = k * depth
    if law // 3 == PARTING:
        return sign * spring, 0.0
    if law // 3 == LIMITED:
        return sign * spring, sign * 2.0 * spring
    return sign * spring, sign * (spring + c * speed)


@njit(cache=True)
def _drive(y, train, drives, level, force):
    """Torques of motors and loads on the stations."""
    rows, stations = len(train[4]), len(train[0])
    motors, loads, breaks = drives[3], drives[4], drives[6]
    force[:] = 0.0
    for m in range(len(motors)):
        at, full = int(motors[m, 0]), motors[m, 1]
        x = drives[7][m] @ y[rows : rows + stations] / full
        for i in range(len(breaks)):
            x = max(x, breaks[i, 1]) if level[i] == ABOVE else min(x, breaks[i, 0])
        average, pulsating = _value(drives, 2 * m, x), _value(drives, 2 * m + 1, x)
        force[at] += average + pulsating * np.sin(y[rows + stations + m])
    for d in range(len(loads)):
        at, full, soft = int(loads[d, 0]), loads[d, 1], loads[d, 2]
        w, i = y[rows + at], 2 * len(motors) + d
        z = min(max(w / soft, -1.0), 1.0)
        torque = _value(drives, i, abs(w) / full)
        force[at] -= torque * z * (1.5 - 0.5 * z * z)


@njit(cache=True)
def _rates(y, train, drives, law, force, out):
    """Rate of change of the state; `force` is left as the whole torque on each station."""
    inertia, first, second, ratio, k, c, gap, _, drag, _ = train
    rows, stations = len(k), len(inertia)
    _drive(y, train, drives, law[rows:], force)
    for s in range(stations):
        force[s] -= drag[s] * y[rows + s]
    for e in range(rows):
        a, b = first[e], second[e]
        rate = y[rows + a] - ratio[e] * y[rows + b]
        torque = _element(k[e], c[e], gap[e], law[e], y[e], rate)[1]
        out[e] = rate
        force[a] -= torque
        force[b] += ratio[e] * torque
    for i in range(rows, len(law)):
        if law[i] == HELD:
            force[int(drives[3][0, 0])] = 0.0
    for s in range(stations):
        out[rows + s] = force[s] / inertia[s]
    motors, line = drives[3], drives[5]
    for m in range(len(motors)):
        out[rows + stations + m] = 2.0 * (line - motors[m, 2] * y[rows + int(motors[m, 0])])


@njit(cache=True)
def _side_of_jump(y, train, drives, law, i, force, work):
    """Where the first motor is: below the jump of its curve, above it, or held at it."""
    rows, breaks, motor = len(train[4]), drives[6], drives[3][0]
    at, speed = rows + int(motor[0]), breaks[i, 0] * motor[1]
    old = law[rows + i]
    if (old == BELOW and y[at] <= speed) or (old == ABOVE and y[at] >= speed):
        return old
    law[rows + i] = BELOW
    _rates(y, train, drives, law, force, work)
    below = work[at]
    law[rows + i] = ABOVE
    _rates(y, train, drives, law, force, work)
    above = work[at]
    law[rows + i] = old
    if below < 0.0:
        return BELOW
    return HELD if above < 0.0 else ABOVE


@njit(cache=True)
def _laws(y, train, drives, law, force, work, out):
    """Which law holds after `law`: a number an element (0 = no clearance), one a jump."""
    _, first, second, ratio, k, c, gap, sticky, _, _ = train
    rows, breaks = len(k), drives[6]
    for e in range(rows):
        out[e] = 0
        if gap[e] < 0.0:
            continue
        rate = y[rows + first[e]] - ratio[e] * y[rows + second[e]]
        side, depth = FREE, 0.0
        if y[e] >= 0.0:  # a start begins with the drive flank touching
            side, depth = DRIVE, y[e]
        elif -y[e] - gap[e] > 0.0:
            side, depth, rate = BACK, -y[e] - gap[e], -rate
        kind = 0
        if side != FREE:
            if k[e] * depth + c[e] * rate < 0.0:
                kind = PARTING
            elif sticky[e] == 0.0 and c[e] * rate > k[e] * depth:
                kind = LIMITED
        out[e] = 3 * kind + side
    for i in range(len(breaks)):
        out[rows + i] = _side_of_jump(y, train, drives, law, i, force, work)


@njit(cache=True)
def _step(y, h, train, drives, law, force, stage, work, out):
    """One step of Dormand-Prince 8, no law changing."""
    n = len(y)
    for i in range(STAGES):
        work[:] = y
        for m in range(i):
            share = h * A[i, m]
            if share != 0.0:
                for j in range(n):
                    work[j] += share * stage[m, j]
        _rates(work, train, drives, law, force, stage[i])
    out[:] = y
    for i in range(STAGES):
        share = h * B8[i]
        if share != 0.0:
            for j in range(n):
                out[j] += share * stage[i, j]


@njit(cache=True)
def _observe(y, train, drives, links, law, force, work, seen):
    """Elastic torques of elements, torques of rigid links, then whole torques of elements."""
    _, first, second, ratio, k, c, gap, _, _, _ = train
    rows, whole = len(k), len(k) + len(links)
    for e in range(rows):
        rate = y[rows + first[e]] - ratio[e] * y[rows + second[e]]
        seen[e], seen[whole + e] = _element(k[e], c[e], gap[e], law[e], y[e], rate)
    if len(links):
        _rates(y, train, drives, law, force, work)
        for i in range(len(links)):
            behind = int(links[i, 0])
            beyond = seen[whole + behind] if behind >= 0 else 0.0
            seen[rows + i] = beyond + links[i, 2] * force[int(links[i, 1])]
    for e in range(rows):
        if k[e] == 0.0:
            seen[e] = seen[whole + e]  # an element without stiffness reports its viscous torque


@njit(cache=True)
def _vertex(a, b, c):
    """Value at the vertex of the parabola through three samples whose middle one is an extreme."""
    bend = a - 2.0 * b + c
    return b if bend == 0.0 else b - (c - a) ** 2 / (8.0 * bend)


@njit(cache=True)
def _widen(high, low, values):
    for i in range(len(high)):
        high[i], low[i] = max(high[i], values[i]), min(low[i], values[i])


@njit(cache=True)
def _widen_between(high, low, before, middle, after, slack):
    """Widen by the vertices of the middle samples; whether one comes near an extreme, or passes it."""
    near = False
    for o in range(len(high)):
        a, b, c = before[o], middle[o], after[o]
        if (b > a and b > c) or (b < a and b < c):
            vertex = _vertex(a, b, c)
            margin = slack * abs(vertex)
            near = near or vertex > high[o] - margin or vertex < low[o] + margin
            if slack == 0.0:
                high[o], low[o] = max(high[o], vertex), min(low[o], vertex)
    return near


@njit(cache=True)
def _advance(y, h, train, drives, links, law, high, low, counts, times, rooms):
    """One step, which ends and goes on wherever a law changes; whether one did.

    `counts` gets impacts, and those of the back flank, `times` time without force and fastest approach.
    """
    force, work, stage, new, trial, law_new, seen = rooms
    rows, left, changed = len(train[4]), h, False
    switching = len(drives[6]) > 0 or np.any(train[6] >= 0.0)
    while left > 0.0:
        _step(y, left, train, drives, law, force, stage, work, new)
        used = left
        if switching:
            _laws(new, train, drives, law, force, work, law_new)
            if np.any(law_new != law):
                changed = True
                same, other = 0.0, 1.0
                for _ in range(BISECTIONS):
                    s = 0.5 * (same + other)
                    _step(y, s * left, train, drives, law, force, stage, work, trial)
                    _laws(trial, train, drives, law, force, work, law_new)
                    if np.any(law_new != law):
                        other = s
                    else:
                        same = s
                used = other * left
                _step(y, used, train, drives, law, force, stage, work, new)
                _laws(new, train, drives, law, force, work, law_new)
                # whole forces have corners here, or jump: both sides count
                _observe(new, train, drives, links, law, force, work, seen)
                _widen(high, low, seen)
                _observe(new, train, drives, links, law_new, force, work, seen)
                _widen(high, low, seen)
            for e in range(rows):
                if train[6][e] < 0.0:
                    continue
                loaded = law[e] % 3 != FREE and law[e] // 3 != PARTING
                if not loaded:
                    times[0, e] += used
                if law[e] % 3 == FREE and law_new[e] % 3 != FREE:
                    counts[0, e] += 1
                    counts[1, e] += law_new[e] % 3 == BACK
                    rate = new[rows + train[1][e]] - train[3][e] * new[rows + train[2][e]]
                    times[1, e] = max(times[1, e], abs(rate))
            law[:] = law_new
        y[:] = new
        left = left - used if used < left else 0.0
    return changed


@njit(cache=True)
def _look_closely(y, law, h, train, drives, links, high, low, rooms):
    """The same two steps again in finer ones, for the extremes that lie in them alone."""
    seen, force, work = rooms[6], rooms[0], rooms[1]
    counts, times = np.zeros((2, len(train[4])), np.int64), np.zeros((2, len(train[4])))
    before, middle, steady = np.zeros(len(seen)), np.zeros(len(seen)), 0
    for i in range(2 * CLOSER + 1):
        _observe(y, train, drives, links, law, force, work, seen)
        _widen(high, low, seen)
        if steady >= 2:  # no vertex across a corner
            _widen_between(high, low, before, middle, seen, 0.0)
        before[:], middle[:] = middle, seen
        if i < 2 * CLOSER:
            changed = _advance(
                y, h / CLOSER, train, drives, links, law, high, low, counts, times, rooms
            )
            steady = 0 if changed else steady + 1


@njit(cache=True)
def _run(y, steps, h, train, drives, links, every, time, kept, driven):
    rows, stations = len(train[4]), len(train[0])
    n, n_out, n_laws = len(y), rows + len(links), rows + len(drives[6])
    n_seen = n_out + rows
    force, work, seen = np.zeros(stations), np.zeros(n), np.zeros(n_seen)
    law = np.zeros(n_laws, np.int64)
    rooms = (
        force, work, np.zeros((STAGES, n)), np.zeros(n), np.zeros(n), np.zeros(n_laws, np.int64), seen,
    )  # fmt: skip
    before, middle = np.zeros(n_seen), np.zeros(n_seen)
    high, low = np.zeros(n_seen), np.zeros(n_seen)
    counts, times = np.zeros((2, rows), np.int64), np.zeros((2, rows))
    states, laws = np.zeros((2, n)), np.zeros((2, n_laws), np.int64)  # one and two steps ago
    _laws(y, train, drives, law.copy(), force, work, law)
    row = 0
    for i in range(steps + 1):
        _observe(y, train, drives, links, law, force, work, seen)
        _widen(high, low, seen)
        if i > 1 and _widen_between(high, low, before, middle, seen, NEAR):
            old, old_law = states[1].copy(), laws[1].copy()
            _look_closely(old, old_law, h, train, drives, links, high, low, rooms)
            _observe(y, train, drives, links, law, force, work, seen)
        before[:], middle[:] = middle, seen
        states[1], laws[1] = states[0], laws[0]
        states[0], laws[0] = y, law
        if every > 0 and i % every == 0:
            _drive(y, train, drives, law[rows:], force)
            time[row], kept[row], driven[row] = i * h, seen[:n_out], force
            for j in range(rows, n_laws):
                if law[j] == HELD:  # the jump gives what holds the speed
                    law[j] = BELOW
                    _rates(y, train, drives, law, force, work)
                    driven[row, int(drives[3][0, 0])] -= force[int(drives[3][0, 0])]
                    law[j] = HELD
            row += 1
        if i < steps:
            _advance(y, h, train, drives, links, law, high, low, counts, times, rooms)
    return (
        high[:n_out], low[:n_out], high[n_out:], low[n_out:], counts[0], counts[1], times[0], times[1],
    )  # fmt: skip


def state_size(case: CaseData) -> int:
    """Twists, speeds and slip angles."""
    motors = {r.station for r in case.motor_torque}
    return len(case.elements) + len(case.stations) + len(motors)


def rates_of(case: CaseData, clearances: dict[str, Clearance] | None = None) -> Any:
    """The equations as scipy takes them."""
    train, drives = arrays_of(case, clearances or {})
    force, law = np.zeros(len(case.stations)), np.zeros(len(case.elements), np.int64)

    def rates(_: float, y: Floats) -> Floats:
        out = np.empty(len(y))
        _laws(y, train, drives, law, force, out, law)
        _rates(y, train, drives, law, force, out)
        return out

    return rates


def integrate(
    case: CaseData,
    end: float,
    step: float,
    *,
    links: tuple[RigidLink, ...] = (),
    clearances: dict[str, Clearance] | None = None,
    breaks: tuple[tuple[float, float], ...] = (),
    sample: float = 0.0,
) -> Answer:
    """From rest to `end` in equal steps of at most `step`.

    `breaks` are pairs of speeds (over synchronous) between which the motor's curve as good as jumps;
    `sample` [s] asks for the history at about that interval.
    """
    train, drives = arrays_of(case, clearances or {}, breaks)
    steps = max(int(np.ceil(end / step)), 1)
    every = max(round(sample / (end / steps)), 1) if sample else 0
    count = steps // every + 1 if every else 0
    rows, stations = len(case.elements), len(case.stations)
    y = np.zeros(state_size(case))
    y[rows + stations :] = case.pulsation_phase or 0.0
    time, kept = np.zeros(count), np.zeros((count, rows + len(links)))
    driven = np.zeros((count, stations))
    found = _run(
        y, steps, end / steps, train, drives,
        np.array([(r.behind, r.body, r.share) for r in links], dtype=float).reshape(-1, 3),
        every, time, kept, driven,
    )  # fmt: skip
    speed = y[rows : rows + stations]
    return Answer(*found[:4], speed, float(train[9] @ speed), *found[4:], time, kept.T, driven.T)
