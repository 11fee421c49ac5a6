"""What the limit on contact damping does where teeth come near parting, and do not part.

Contact damping never exceeds the spring force (`ContactLaw.LIMITED`). A linear start has no such limit. It acts
where the torque of an element with a clearance rises from near zero faster than its spring takes it up: at
the very beginning, or after a dip. There the linear start has too much torque. The same start with what is too
much taken off, as a pair of torques against time at the ends of the element, tells what the limit changes:
ringing, and the instant at which the train comes to each speed.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from engine.arrays import Floats
from engine.case.choices import ContactLaw
from engine.case.data import CaseData, TorqueTimeRow
from engine.model.train import Flank, Train
from engine.numerics.distinct import distinct
from engine.numerics.same_bits import exp, fading_sum, interp
from engine.start.settings import NEGLIGIBLE
from engine.start.start import Start
from engine.start.trajectory import hermite_at

#: The limit changes what it acts on; so often its change of the first order is taken for a bound.
LIMIT_GAIN = 2.0
#: Samples of the torque of one contact, at the most; else four in the time c/k.
MOST_SAMPLES, SAMPLES = 1_000_000, 4.0
#: Rows of one torque against time, at the most, besides those where it begins and ends.
MOST_ROWS = 2_000
#: A torque that jumps at a time rises to it within this time. [s]
JUMP = 1e-9


def without_excess_damping(case: CaseData, train: Train, start: Start) -> CaseData | None:
    """The case with torques that take off what contact damping has above the spring force.

    Parameters
    ----------
    case : CaseData
        The case. [SI]
    train : Train
        Its train. [SI]
    start : Start
        Its linear start. [SI]

    Returns
    -------
    CaseData or None
        None where there is nothing to take off. [SI]
    """
    if (case.contact_law or ContactLaw.LIMITED) != ContactLaw.LIMITED:
        return None
    tables: dict[str | None, list[tuple[Floats, Floats]]] = {}
    for flank in train.flanks:
        if not flank.gap or flank.viscous <= 0.0:
            continue
        time, excess = _excess(start, flank)
        if np.any(excess):
            element = case.elements[flank.element]
            i, j = (train.stations.index(str(s)) for s in (element.from_, element.to))
            share = float(train.speed_ratio[i] / train.speed_ratio[j])
            for station, torque in ((element.from_, excess), (element.to, -share * excess)):
                tables.setdefault(station, []).append((time, torque))
    if not tables:
        return None
    kept = [row for row in case.torque_time_from_rest if row.station not in tables]
    changed = [row for s, pairs in tables.items() for row in _rows(case, s, pairs)]
    return replace(CaseData(**vars(case)), torque_time=(*kept, *changed), initial_state=None)


def _rows(
    case: CaseData, station: str | None, pairs: list[tuple[Floats, Floats]]
) -> Iterator[TorqueTimeRow]:
    """Torques against time of one station and those that it has already, summed."""
    own = [row for row in case.torque_time_from_rest if row.station == station]
    if own:
        pairs = [*pairs, (np.array([r.time for r in own]), np.array([r.torque for r in own]))]
    begins = [float(t[0]) - JUMP for t, y in pairs if y[0] and t[0] > JUMP]
    times = distinct(begins, *(t for t, _ in pairs))
    torque = np.zeros(len(times))
    for t, y in pairs:
        torque += np.where(times < t[0], 0.0, interp(times, t, y))
    for at, value in zip(times.tolist(), torque.tolist(), strict=True):
        yield TorqueTimeRow(station, at, value)


def _excess(start: Start, flank: Flank) -> tuple[Floats, Floats]:
    """Times, and what contact damping has above the spring force then, zero at both ends. [s, N m]

    The torque is T = S + D, D = (c/k) dS/dt: S is T after a lag of c/k, and D − S = T − 2 S.
    """
    trajectory = start.trajectory
    own = np.flatnonzero(trajectory.output_element == flank.element)
    keep = np.concatenate([[True], np.diff(trajectory.time) > 0.0])
    time = trajectory.time[keep]
    if not len(own) or len(time) < 2:
        return np.empty(0), np.empty(0)
    torque = trajectory.torque[int(own[0])][keep]
    rate = trajectory.torque_rate[int(own[0])][keep]
    lag, span = flank.viscous / flank.stiffness, float(time[-1] - time[0])
    n = int(min(MOST_SAMPLES, max(SAMPLES * span / lag, 2.0 * len(time)))) + 1
    at = np.linspace(time[0], time[-1], n)
    whole = hermite_at(time, torque, rate, at)
    # S of the next sample from T linear between two
    ratio = span / (n - 1) / lag
    fade = exp(-ratio)
    share = (1.0 - fade) / ratio
    new = (1.0 - share) * whole
    new[1:] += (share - fade) * whole[:-1]
    new[0] = 0.0  # untwisted at the beginning
    # each sample less what has faded of the one before
    spring = fading_sum(new, fade)
    excess = np.maximum(whole - 2.0 * spring, 0.0)
    excess[excess <= NEGLIGIBLE * float(np.max(np.abs(whole)))] = 0.0
    excess[-1] = 0.0
    some = excess > 0.0
    some[1:] |= some[:-1].copy()  # and the zeros beside them
    some[:-1] |= some[1:].copy()
    at, excess = at[some], excess[some]
    every = -(-len(at) // MOST_ROWS) or 1
    thin = (np.arange(len(at)) % every == 0) | (excess == 0.0)
    return at[thin], excess[thin]
