"""Any train under prescribed torques, untwisted at the beginning.

Torques are held between samples, linear between samples, or callables of time. For the first two
the steps fall on the samples and the solution is exact; a callable is read at four points of each
step and interpolated by a cubic, so that the error falls with the fourth power of the step.
Damping that couples modes is integrated with its full matrix, not by its diagonal.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from engine.arrays import Floats, Ints, Mask
from engine.case.data import CaseData, TorqueTimeRow
from engine.errors import ModelError
from engine.model.modes import Modes, modal_damping_matrix
from engine.model.train import Train
from engine.numerics.distinct import distinct
from engine.numerics.same_bits import along_first, half_and_whole, interp, product
from engine.start.torque_outputs import TorqueOutputs, force_reach, torque_outputs
from engine.stepping import linear_loop as kernels

#: Places s within a step, and monomial coefficients of s from the values there: of any torque, and of one that is
#: linear over the step.
_CUBIC = (
    (0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0),
    0.5 * np.array(
        [
            [2.0, 0.0, 0.0, 0.0],
            [-11.0, 18.0, -9.0, 2.0],
            [18.0, -45.0, 36.0, -9.0],
            [-9.0, 27.0, -27.0, 9.0],
        ]
    ),
)  # fmt: skip
_LINEAR = ((0.0, 1.0), np.array([[1.0, 0.0], [-1.0, 1.0]]))
#: Off-diagonal modal damping below this share of the diagonal is rounding.
_COUPLED = 1e-11
#: Steps whose torques are calculated at a time, so that they stay in the processor's cache.
CHUNK = 16384
#: Lengths of steps that are remembered: knots and samples that are multiples of one time have few.
KNOWN_STEPS = 32
#: Times this close to equally spaced, over the whole span, are equally spaced.
_SPACING = 1e-12


@dataclass(frozen=True, eq=False)
class PrescribedTorque:
    """Torque at one station as a function of time."""

    station: int  #: Station.
    #: Times between which the torque is one polynomial; empty for a callable. [s] Shape (n,).
    knots: Floats
    #: Torque at times, from the left and from the right of a knot: value(t, side). [N m]
    value: Callable[[Floats, str], Floats]
    linear: bool = False  #: Whether that polynomial is a straight line.

    @property
    def samples(self) -> Floats:
        """Torque just after each knot, shape (n,). [N m]"""
        return self.value(self.knots, "right")

    @property
    def jump(self) -> float:
        """Size of the jump with which it begins. [N m]"""
        return abs(float(self.samples[0]))

    @property
    def ramp(self) -> float:
        """Sum of all its changes of slope. [N m/s]"""
        slope = np.diff(self.samples) / np.diff(self.knots)
        return float(np.sum(np.abs(np.diff(slope, prepend=0.0, append=0.0))))


def linear(station: int, times: Floats, torques: Floats) -> PrescribedTorque:
    """Torque linear between samples, held after the last, zero before the first.

    Parameters
    ----------
    station : int
        Station. [index]
    times : ndarray, shape (n,)
        Rising. [s]
    torques : ndarray, shape (n,)
        Torque at that time. [N m]

    Returns
    -------
    PrescribedTorque
        The torque. [N m]
    """
    t, y = np.asarray(times, dtype=float), np.asarray(torques, dtype=float)

    def value(at: Floats, side: str) -> Floats:
        inside = interp(at, t, y)
        before = at <= t[0] if side == "left" else at < t[0]
        return np.where(before, 0.0, inside)

    return PrescribedTorque(station, t, value, linear=True)


def held(station: int, torque: float) -> PrescribedTorque:
    """Torque that does not change.

    Parameters
    ----------
    station : int
        Station. [index]
    torque : float
        Torque in its running direction. [N m]

    Returns
    -------
    PrescribedTorque
        The torque. [N m]
    """
    return linear(station, np.zeros(1), np.array([torque]))


def prescribed_torques(case: CaseData, train: Train) -> list[PrescribedTorque]:
    """Torques of table `TorqueTime` in a start, one a station."""
    return tabled_torques(case.torque_time_from_rest, train)


def tabled_torques(table: Sequence[TorqueTimeRow], train: Train) -> list[PrescribedTorque]:
    """Rows of `TorqueTime` as torques, one a station, linear between its rows.

    Parameters
    ----------
    table : sequence of TorqueTimeRow
        Rows, rising in time for each station. [s, N m]
    train : Train
        The train. [SI]

    Returns
    -------
    list of PrescribedTorque
        In the order in which the stations come. [N m]
    """
    names = list(dict.fromkeys(p.station for p in table))
    torques = []
    for name in names:
        rows = [p for p in table if p.station == name]
        torques.append(
            linear(
                train.stations.index(str(name)),
                np.array([p.time for p in rows], dtype=float),
                np.array([p.torque for p in rows], dtype=float),
            )
        )
    return torques


def torque_tables(torques: Sequence[PrescribedTorque], stations: Sequence[int]) -> tuple[Any, ...]:
    """Prescribed torques, linear between their knots, as the compiled loop takes them.

    Force, times [s], torques [N m] and counts of each table; `stations` names the station of each force.
    """
    longest = max((len(p.knots) for p in torques), default=1)
    times, values = np.zeros((len(torques), longest)), np.zeros((len(torques), longest))
    for i, p in enumerate(torques):
        times[i, : len(p.knots)] = p.knots
        values[i, : len(p.knots)] = p.samples
    return (
        np.array([list(stations).index(p.station) for p in torques], dtype=np.int64),
        times,
        values,
        np.array([len(p.knots) for p in torques], dtype=np.int64),
    )


def knots_of(timed: tuple[Any, ...]) -> list[Floats]:
    """Times at which torque tables have corners.

    Parameters
    ----------
    timed : tuple
        As `torque_tables` gives them. [s, N m]

    Returns
    -------
    list of ndarray, shape (n_knots,)
        One a table. [s]
    """
    return [times[:n] for times, n in zip(timed[1], timed[3], strict=True)]


@dataclass(frozen=True, eq=False)
class TimeResponse:
    """Response of a train at the requested times."""

    time: Floats  #: Times. [s] Shape (n_times,).
    #: Torque of each element (each segment of a subdivided shaft) and its rate. [N m, N m/s] Shape
    #: (n_outputs, n_times).
    torque: Floats
    torque_rate: Floats  #: Likewise. [N m, N m/s] Shape (n_outputs, n_times).
    output_element: Ints  #: Element of each output. Shape (n_outputs,).
    coupled: bool  #: True if damping coupled the modes and the full matrix was used.
    #: Modal positions and velocities. [rad √(kg m²), rad √(kg m²)/s] Shape (n_modes, n_times).
    modal: tuple[Floats, Floats]
    #: What a mode turns each station by. [1/√(kg m²)] Shape (n_stations, n_modes).
    to_stations: Floats

    @cached_property
    def station_angle(self) -> Floats:
        """In each station's running direction, at its own speed, shape (n_stations, n_times). [rad]"""
        return np.asarray(product(self.to_stations, self.modal[0]))

    @cached_property
    def station_speed(self) -> Floats:
        """Likewise. [rad/s]"""
        return np.asarray(product(self.to_stations, self.modal[1]))


def time_response(
    train: Train,
    modes: Modes,
    torques: Sequence[PrescribedTorque],
    times: Floats,
    *,
    damping_ratio: Floats | None = None,
    initial_speed: Floats | None = None,
    kept: Mask | None = None,
) -> TimeResponse:
    """Integrate a train under prescribed torques.

    Parameters
    ----------
    train : Train
        The train; its dampers act with their full matrix. [SI]
    modes : Modes
        All its modes. [SI]
    torques : sequence of PrescribedTorque
        Torques, positive in the running direction of their station. [N m]
    times : ndarray, shape (n_times,)
        Times wanted, rising; the first is the start. Callables are sampled within these steps,
        so their spacing sets the accuracy for callables. [s]
    damping_ratio : ndarray, shape (n_modes,), optional
        Stated modal damping, in addition to the train's dampers. [1]
    initial_speed : ndarray, shape (n_modes,), optional
        Modal velocities at the start; default rest. [rad √(kg m²)/s]
    kept : ndarray of bool, shape (n_modes,), optional
        Modes that are integrated; elastic modes left out follow statically. Default all. [mask]

    Returns
    -------
    TimeResponse
        Angles, speeds and element torques at `times`. [SI]

    Raises
    ------
    ModelError
        If times do not rise.
    """
    t = np.asarray(times, dtype=float)
    if len(t) < 1 or np.any(np.diff(t) <= 0.0):
        raise ModelError("The times of a time response must be in rising order.")
    stations = np.array(sorted({p.station for p in torques}), dtype=np.int64)
    grid = _step_grid(t, torques)
    v = np.zeros(modes.n_modes) if initial_speed is None else initial_speed
    system = modal_system(train, modes, stations, damping_ratio, kept)

    n, rows = len(system.omega), system.room_for(len(t))
    both = rows[:n] if len(grid) == len(t) else np.empty((n, 2, len(grid)))
    _integrate(
        system, grid, lambda part: _torque_polynomials(torques, stations, part), v[system.keep], both
    )  # fmt: skip
    if len(grid) != len(t):
        np.take(both, np.searchsorted(grid, t), axis=2, out=rows[:n])

    def applied() -> tuple[Floats, Floats]:
        force, rate = np.zeros((len(stations), len(t))), np.zeros((len(stations), len(t)))
        for p in torques:
            column = int(np.searchsorted(stations, p.station))
            force[column] += p.value(t, "right")
            rate[column] += _slope(p, t)
        return force, rate

    return system.response(t, rows, applied)


@dataclass(frozen=True, eq=False)
class ModalSystem:
    """The equations of a train under torques at some stations, in the modes that are integrated."""

    train: Train  #: The train. [SI]
    modes: Modes  #: All its modes. [SI]
    keep: Mask  #: Modes that are integrated; elastic ones left out follow statically. [mask]
    omega: Floats  #: Natural frequencies of those. [rad/s] Shape (n_kept,).
    damping: Floats  #: Their damping matrix. [1/s] Shape (n_kept, n_kept).
    coupled: bool  #: Whether damping couples them.
    reach: Floats  #: Torques to modes. [rad/√(kg m²)] Shape (n_kept, n_stations).
    outputs: TorqueOutputs  #: Element torques. [SI]

    def room_for(self, n_times: int) -> Floats:
        """Positions and velocities of the modes, then torques and rates of the outputs: (rows, 2, n_times).

        One piece of memory, not yet filled, because a large one comes in large pages.
        """
        return np.empty((len(self.omega) + len(self.outputs.element), 2, n_times))

    def response(
        self,
        time: Floats,
        rows: Floats,
        applied: Callable[[], tuple[Floats, Floats]],
    ) -> TimeResponse:
        """What the modes do to stations and elements.

        Parameters
        ----------
        time : ndarray, shape (n_times,)
            Times. [s]
        rows : ndarray, shape (n_kept + n_outputs, 2, n_times)
            From `room_for`, with the modes filled; the torques are filled here. [SI]
        applied : callable
            Torques and their rates, shape (n_stations, n_times); asked for where an element's torque depends on
            them. [N m, N m/s]

        Returns
        -------
        TimeResponse
            Angles, speeds and element torques. [SI]
        """
        train, outputs = self.train, self.outputs
        modes, torques = rows[: len(self.omega)], rows[len(self.omega) :]
        product(outputs.position, modes.reshape(len(modes), -1), torques.reshape(len(torques), -1))
        q, v, torque, torque_rate = modes[:, 0], modes[:, 1], torques[:, 0], torques[:, 1]
        if np.any(outputs.force) or np.any(outputs.velocity):
            force, rate = applied()
            acceleration = product(self.reach, force) - product(self.damping, v)
            acceleration = acceleration - self.omega[:, None] ** 2 * q
            torque += product(outputs.velocity, v) + product(outputs.force, force)
            torque_rate += product(outputs.velocity, acceleration) + product(outputs.force, rate)
        angle = self.modes.shape[np.ix_(train.node_dof[: train.n_stations], self.keep)]
        angle = angle * train.node_scale[: train.n_stations, None]
        return TimeResponse(time, torque, torque_rate, outputs.element, self.coupled, (q, v), angle)


def modal_system(
    train: Train,
    modes: Modes,
    stations: Ints,
    damping_ratio: Floats | None,
    kept: Mask | None,
) -> ModalSystem:
    """The modal equations of a train under torques at some stations.

    Parameters
    ----------
    train : Train
        The train; its dampers act with their full matrix. [SI]
    modes : Modes
        All its modes. [SI]
    stations : ndarray of int, shape (n_stations,)
        Where torques act. [indices]
    damping_ratio : ndarray, shape (n_modes,), or None
        Stated modal damping, in addition to the train's dampers. [1]
    kept : ndarray of bool, shape (n_modes,), or None
        Modes that are integrated; None = all. [mask]

    Returns
    -------
    ModalSystem
        Damping, reach and torques in the modes that are integrated. [SI]
    """
    keep = np.ones(modes.n_modes, dtype=np.bool_) if kept is None else kept
    physical = modal_damping_matrix(train, modes)
    matrix = physical
    if damping_ratio is not None:
        matrix = matrix + np.diag(2.0 * damping_ratio * modes.omega)
    matrix = matrix[np.ix_(keep, keep)]
    off = np.abs(matrix - np.diag(np.diag(matrix)))
    coupled = bool(np.max(off, initial=0.0) > _COUPLED * np.max(np.abs(matrix), initial=0.0))
    reach = force_reach(train, modes, stations)
    outputs = torque_outputs(train, modes, stations, damping=physical)
    return ModalSystem(
        train, modes, keep, modes.omega[keep], matrix, coupled, reach[keep],
        outputs.of_modes(keep, modes.omega, reach),
    )  # fmt: skip


def _step_grid(t: Floats, torques: Sequence[PrescribedTorque]) -> Floats:
    """Output times and the knots of the torques between them."""
    knots = [p.knots[(p.knots > t[0]) & (p.knots < t[-1])] for p in torques]
    if all(len(k) == 0 or np.array_equal(k, t[1:-1]) for k in knots):
        return t
    merged = distinct(t, *knots)
    close = np.diff(merged) < 1e-12 * max(abs(t[-1]), t[-1] - t[0], 1e-300)
    # of two times that rounding has split keep the one that was asked for
    drop = np.zeros(len(merged), dtype=np.bool_)
    for i in np.flatnonzero(close):
        drop[i if merged[i] not in t else i + 1] = True
    return np.asarray(merged[~drop])


def _torque_polynomials(
    torques: Sequence[PrescribedTorque], stations: Ints, grid: Floats
) -> Floats:
    """Coefficients of each torque over every step, shape (terms, n_stations, n_steps). [N m]"""
    start, h = grid[:-1], np.diff(grid)
    places, weights = _LINEAR if all(p.linear for p in torques) else _CUBIC
    values = np.zeros((len(places), len(stations), len(h)))
    for p in torques:
        column = int(np.searchsorted(stations, p.station))
        if len(p.knots):
            first, last = p.value(start, "right"), p.value(grid[1:], "left")
        else:
            ends = p.value(grid, "right")
            first, last = ends[:-1], ends[1:]
        inner = [p.value(start + share * h, "right") for share in places[1:-1]]
        for i, part in enumerate((first, *inner, last)):
            values[i, column] += part
    return np.asarray(along_first(weights, values))


def _integrate(
    system: ModalSystem, grid: Floats, torques: Callable[[Floats], Floats], v: Floats, both: Floats
) -> None:
    """Modal positions and velocities on the grid, into `both`, shape (n_modes, 2, n_grid).

    `torques` gives the polynomials between some grid points; it is asked for some thousand steps
    at a time.
    """
    omega, n = system.omega, len(system.omega)
    out = both[:, 0], both[:, 1]
    state = np.concatenate([np.zeros(n), v])
    q, v = state[:n], state[n:]
    out[0][:, 0], out[1][:, 0] = q, v
    steps = _steps(grid)
    changes = np.flatnonzero(np.diff(steps)) + 1 if system.coupled else np.zeros(0, dtype=np.int64)
    by_length = _CoupledSteps(system, _slack(grid))
    rate = np.diag(system.damping).copy()
    for i, j in zip([0, *changes], [*changes, len(steps)], strict=True):
        for a in range(i, j, CHUNK):
            b = min(a + CHUNK, j)
            over = torques(grid[a : b + 1])
            if system.coupled:
                if a == i:
                    free, push = by_length.step(float(steps[i]), j - i, len(over))
                states = np.empty((b - a, 2 * n))
                kernels.drive_coupled(free, push, over, state, states)
                out[0][:, a + 1 : b + 1], out[1][:, a + 1 : b + 1] = states.T[:n], states.T[n:]
            else:
                modes = kernels.prescribed_struct(omega**2, rate, system.reach, len(over))
                kernels.drive_modes(modes, steps[a:b], over, (q, v), both, a + 1)


def _steps(grid: Floats) -> Floats:
    """Lengths of the steps, those the same that differ by rounding alone. [s]"""
    steps, slack = np.diff(grid), _slack(grid)
    changes = np.flatnonzero(np.abs(np.diff(steps)) > 4.0 * slack) + 1
    first, last = np.append(0, changes), np.append(changes, len(steps))
    for i, end in zip(first[last - first > 1], last[last - first > 1], strict=True):
        while i < end:
            j = _equal_steps_until(grid[: end + 1], i, slack)
            steps[i:j] = float(grid[j] - grid[i]) / (j - i)
            i = j
    return steps


def _slack(grid: Floats) -> float:
    """How far points may be from where they belong: rounding. [s]"""
    return max(_SPACING * float(np.ptp(grid)), 8.0 * float(np.spacing(np.max(np.abs(grid)))))


def _equal_steps_until(grid: Floats, i: int, slack: float) -> int:
    """End of the longest stretch from i on whose steps are equal but for rounding, `slack`.

    Judged by where the points lie, not by their differences: neighbours of 15 s at 0.1 ms differ
    by rounding alone in every third step.
    """
    last = len(grid) - 1

    def equal(j: int) -> bool:
        line = np.linspace(grid[i], grid[j], j - i + 1)
        return bool(np.max(np.abs(grid[i : j + 1] - line)) <= slack)

    if equal(last):
        return last
    good, bad = i + 1, i + 2
    while bad <= last and equal(bad):
        good, bad = bad, min(2 * bad - i, last) if bad < last else last + 1
    while bad - good > 1 and bad <= last:
        middle = (good + bad) // 2
        good, bad = (middle, bad) if equal(middle) else (good, middle)
    return good


class _CoupledSteps:
    """Steps of the coupled system, calculated once for each length.

    Where knots of torques interrupt equal steps, a length comes again and differs by rounding. The one known
    is taken while all steps together end within `slack` of where they should.
    """

    def __init__(self, system: ModalSystem, slack: float) -> None:
        self._system, self._slack = system, slack
        self._known: dict[float, tuple[Floats, Floats]] = {}  # the latest one last
        self._ahead = 0.0

    def step(self, h: float, count: int, terms: int) -> tuple[Floats, Floats]:
        """What `coupled_step` gives for a whole step, for a number of them in a row."""
        near = min(self._known, key=lambda known: abs(known - h), default=np.inf)
        ahead = self._ahead + count * (near - h)
        if abs(ahead) <= self._slack:
            self._ahead = ahead
            found = self._known.pop(near)
        else:
            s = self._system
            near, (_, found) = h, coupled_step(s.omega, s.damping, s.reach, h, terms)
        self._known[near] = found
        if len(self._known) > KNOWN_STEPS:
            del self._known[next(iter(self._known))]
        return found


def coupled_step(
    omega: Floats, matrix: Floats, reach: Floats, h: float, terms: int
) -> tuple[tuple[Floats, Floats], tuple[Floats, Floats]]:
    """Exact steps of the coupled system under torques that are polynomials (Van Loan's block exponential).

    Parameters
    ----------
    omega : ndarray, shape (n,)
        Natural frequencies. [rad/s]
    matrix : ndarray, shape (n, n)
        Damping matrix of the modes. [1/s]
    reach : ndarray, shape (n, n_stations)
        Torques to modes. [rad/√(kg m²)]
    h : float
        Step. [s]
    terms : int
        Coefficients of each torque over the step, of s⁰, s¹, … with s = t/h. [count]

    Returns
    -------
    half, whole : tuple of (ndarray, ndarray)
        Maps to the middle of the step and to its end: of positions and velocities before, shape (2 n, 2 n), and of the
        coefficients of the torques over the whole step, shape (2 n, terms, n_stations). [SI]
    """
    n, m = reach.shape
    a = np.zeros((2 * n + terms * m,) * 2)
    size = np.maximum(omega * h, 1.0)  # state (size · q, h q̇), so that no entry exceeds ωh
    unit = float(np.ldexp(1.0, np.frexp(np.max(np.abs(reach).sum(axis=0), initial=0.0))[1]))
    a[:n, n : 2 * n] = np.diag(size)
    a[n : 2 * n, :n] = -np.diag((omega * h) ** 2 / size)
    a[n : 2 * n, n : 2 * n] = -matrix * h
    a[n : 2 * n, 2 * n : 2 * n + m] = reach / unit
    follows = np.arange(2 * n, len(a) - m)
    a[follows, follows + m] = 1.0
    factor = np.cumprod([1.0, *range(1, terms)])[:, None]
    state = np.concatenate([h / size, np.ones(n)])[:, None]  # (q, q̇) over what is stepped, times h
    half, whole = (
        (
            step[:, : 2 * n] * state / state.T,
            step[:, 2 * n :].reshape(2 * n, terms, m) * (factor * (h * unit) * state[:, :, None]),
        )
        for step in (e[: 2 * n] for e in half_and_whole(a))
    )
    return half, whole


def _slope(p: PrescribedTorque, t: Floats) -> Floats:
    """Rate of a prescribed torque just after each time (only rigid meshes need it)."""
    gap = np.diff(t, append=2.0 * t[-1] - t[-2] if len(t) > 1 else t[-1] + 1.0)
    knots = (
        p.knots[np.searchsorted(p.knots, t, side="right").clip(max=len(p.knots) - 1)]
        if len(p.knots)
        else np.full(len(t), np.inf)
    )
    ahead = np.where(knots > t, np.minimum(gap, knots - t), gap) * 1e-3
    return np.asarray((p.value(t + ahead, "left") - p.value(t, "right")) / ahead)
