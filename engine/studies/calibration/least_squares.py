"""The least change of uncertain quantities that explains what was measured.

Each uncertain quantity is a factor on what the case says, distributed as table `Scatter` states. It
is written p = F⁻¹(Φ(z)), F its distribution function and Φ that of the standard normal, which is then
the prior of every z, whatever the distribution. Wanted is the most probable z,

    S(z) = Σ zⱼ² + Σ ((fᵢ(z) − fᵢ measured)/σᵢ)² + Σ ((Tᵢ(z) − Tᵢ measured)/σᵢ)²  →  least,

by `scipy.optimize.least_squares` (Gauss-Newton in a trust region). Frequencies have exact
derivatives from their energies (Rayleigh): ∂ ln f/∂ ln k = ½ strain share of the element, ∂ ln f/∂ ln J
= −½ kinetic share of the station. Those of peak torques are central differences of whole starts. At
the least, (I + JᵀJ)⁻¹ is the covariance of z (Laplace's approximation, exact for small scatter).

Modes are followed by their shapes: modal assurance criterion MAC = (vᵢ · wⱼ)² of mass-weighted unit
vectors, one to one, from each accepted step to the next, so that two modes that change order keep
their measurements.

References
----------
Tarantola, Inverse Problem Theory (2005), chapter 3 (least squares with a prior); Friswell and
Mottershead, Finite Element Model Updating (1995), chapters 4 and 8; Kuhn, Nav. Res. Logist. Q. 2
(1955) 83 (assignment).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from engine.arrays import Floats, Ints
from engine.case.data import CaseData
from engine.case.defaults import DEFAULT_TOLERANCE_PEAK
from engine.case.study_inputs import INERTIA, STIFFNESS
from engine.errors import ModelError
from engine.model.build_train import build_train
from engine.model.modal_analysis import analyse
from engine.model.modes import Modes, modes_of
from engine.model.subdivision import BAND
from engine.model.train import Train
from engine.run import planned_start
from engine.start.pieces import analysis_for_start
from engine.studies.scatter import CUT, NORMAL, TRIANGULAR, Factor, changes_of
from engine.studies.variation import varied_case

#: A measurement this many standard deviations off what the prior allows is taken for no mode. [1]
GATE = 4.0
#: Peak torques are calculated at least this accurately, as their differences are taken. [1]
PEAK_ACCURACY = 2e-4
#: Half the step of these differences: in prior standard deviations, and at least in ln. [1]
PEAK_STEP, LEAST_PEAK_STEP = 0.1, 2e-3
#: `scipy.optimize.least_squares` ends below these; with peaks, whose noise is larger, below those. [1]
EXACT, NOISY = 1e-12, 1e-5
#: What a quantity is determined by must be the measurements, not the spreads typed for the others: these
#: are taken so many times as wide for it. [1]
WIDER = 10.0
#: Most steps of it where each one costs starts.
NOISY_STEPS = 15


@dataclass(frozen=True, eq=False)
class Unknowns:
    """Uncertain quantities with their prior."""

    factors: tuple[Factor, ...]  #: One an unknown. [1]
    #: Prior standard deviation of each factor over its mean. [1] Shape (n_unknowns,).
    deviation: Floats

    @property
    def number(self) -> int:
        """How many. [count]"""
        return len(self.factors)

    def factor(self, z: Floats) -> Floats:
        """What each quantity is multiplied by.

        Parameters
        ----------
        z : ndarray, shape (..., n_unknowns)
            Standard normal. [1]

        Returns
        -------
        ndarray, shape (..., n_unknowns)
            Distributed as table `Scatter` states; positive. [1]
        """
        return self.factor_and_slope(z)[0]

    def factor_and_slope(self, z: Floats) -> tuple[Floats, Floats]:
        """What each quantity is multiplied by, and how fast its logarithm changes.

        Closed forms of `Factor.at` of the standard normal distribution function.

        Parameters
        ----------
        z : ndarray, shape (..., n_unknowns)
            Standard normal. [1]

        Returns
        -------
        factor, slope : ndarray, shape (..., n_unknowns)
            p and d ln p/dz. [1]
        """
        from scipy import special

        z = np.asarray(z, dtype=float)
        p, change = np.ones(z.shape), np.zeros(z.shape)
        density = np.exp(-0.5 * z**2) / math.sqrt(2.0 * math.pi)
        for j, factor in enumerate(self.factors):
            x, d = z[..., j], density[..., j]
            from_, to = factor.ends
            middle, half = 0.5 * (from_ + to), 0.5 * (to - from_)
            if factor.distribution == NORMAL:
                outside = float(special.ndtr(-CUT))
                inside = 1.0 - 2.0 * outside
                t = special.ndtri(outside + inside * special.ndtr(x))
                p[..., j] = 1.0 + factor.spread * t
                change[..., j] = factor.spread * inside * np.exp(0.5 * (t**2 - x**2))
            elif factor.distribution == TRIANGULAR:
                root = np.sqrt(2.0 * special.ndtr(-np.abs(x)))
                p[..., j] = middle + half * np.sign(x) * (1.0 - root)
                change[..., j] = half * d / np.maximum(root, 1e-150)
            else:
                p[..., j] = middle + half * special.erf(x / math.sqrt(2.0))
                change[..., j] = 2.0 * half * d
        return p, change / p

    def varied_case(self, case: CaseData, z: Floats) -> CaseData:
        """The case with its uncertain quantities changed.

        Parameters
        ----------
        case : CaseData
            The case. [SI]
        z : ndarray, shape (n_unknowns,)
            In prior standard deviations. [1]

        Returns
        -------
        CaseData
            The changed case, not yet checked. [SI]
        """
        return varied_case(case, changes_of(self.factors, self.factor(z)))


def unknowns_of(factors: Sequence[Factor]) -> Unknowns:
    """The uncertain quantities of a calibration.

    Standard deviation: `spread` of a normal distribution, half width/√3 of a uniform and /√6 of a
    triangular one; from-to is uniform about the middle of its ends, which need not be 1.

    Parameters
    ----------
    factors : sequence of Factor
        In any order. [1]

    Returns
    -------
    Unknowns
        Those that scatter, in an order of their own, so that rows may come in any. [1]
    """
    scattering = sorted((f for f in factors if f.scatters), key=lambda f: (f.quantity, f.names))
    middle = np.array([0.5 * (f.from_ + f.to) for f in scattering])
    width = np.array([f.spread if f.distribution == NORMAL else f.deviation for f in scattering])
    return Unknowns(tuple(scattering), width / middle)


# --- frequencies ----------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class State:
    """Modes of the changed train."""

    case: CaseData  #: The changed case. [SI]
    train: Train  #: Its train. [SI]
    modes: Modes  #: Its modes. [SI]
    #: Elastic mode shapes weighted by the root of the inertia: orthonormal. [1] Shape (n_dof,
    #: n_elastic).
    vectors: Floats

    @property
    def frequency(self) -> Floats:
        """Elastic natural frequencies, shape (n_elastic,). [Hz]"""
        return self.modes.elastic_frequency


class FrequencyModel:
    """Natural frequencies against the unknowns; shafts keep the segments of the case itself.

    Parameters
    ----------
    case : CaseData
        A checked case. [SI]
    unknowns : Unknowns
        What may change. [1]
    highest : float, optional
        Highest frequency that was measured: modes up to there, and some more, are accurate. [Hz]
    """

    def __init__(self, case: CaseData, unknowns: Unknowns, highest: float = 0.0) -> None:
        analysed = analyse(case, BAND * highest)
        self.case, self.unknowns = case, unknowns
        self._segments = dict(analysed.subdivided.segments)
        self._lateral = bool(analysed.reported.train.bodies)
        self.base = self._state(case)

    def _state(self, case: CaseData) -> State:
        train = build_train(case, self._segments, lateral=self._lateral)
        modes = modes_of(train)
        shape = modes.shape[:, modes.n_rigid :]
        return State(case, train, modes, np.sqrt(train.inertia)[:, None] * shape)

    def at(self, z: Floats) -> State:
        """Modes of the changed train.

        Parameters
        ----------
        z : ndarray, shape (n_unknowns,)
            In prior standard deviations. [1]

        Returns
        -------
        State
            Its modes. [SI]
        """
        return self._state(self.unknowns.varied_case(self.case, z))

    def gradient(self, state: State) -> Floats:
        """Change of ln f with the logarithm of each factor, from the energies of the modes.

        Parameters
        ----------
        state : State
            Where. [SI]

        Returns
        -------
        ndarray, shape (n_elastic, n_unknowns)
            ∂ ln f/∂ ln p; 0 for damping. [1]
        """
        modes, train = state.modes, state.train
        elastic = slice(modes.n_rigid, None)
        derivative = np.zeros((len(state.frequency), self.unknowns.number))
        row = {e: i for i, e in enumerate(train.elements)}
        own = {str(s.station): s.inertia or 0.0 for s in state.case.stations}
        for j, factor in enumerate(self.unknowns.factors):
            for name in factor.names:
                if factor.quantity == STIFFNESS:
                    derivative[:, j] += 0.5 * modes.strain_share[row[name], elastic]
                elif factor.quantity == INERTIA:
                    i = train.stations.index(name)
                    turn = train.node_scale[i] * modes.shape[train.node_dof[i], elastic]
                    derivative[:, j] -= (
                        0.5 * own[name] * turn**2
                    )  # its own, not that of a shaft's end
        return derivative

    def prior_spread(self, state: State) -> Floats:
        """Standard deviation of ln f from the uncertain quantities alone.

        Parameters
        ----------
        state : State
            Where. [SI]

        Returns
        -------
        ndarray, shape (n_elastic,)
            √Σ (∂ ln f/∂ ln p × σ)². [1]
        """
        return np.asarray(np.linalg.norm(self.gradient(state) * self.unknowns.deviation, axis=1))


def one_to_one(cost: Floats) -> tuple[Ints, Ints]:
    """The cheapest assignment of rows to columns.

    Parameters
    ----------
    cost : ndarray, shape (n_rows, n_columns)
        Of each pair. [any]

    Returns
    -------
    rows, columns : ndarray of int
        The pairs. [indices]
    """
    # a third of a second that only a calibration pays
    from scipy.optimize import linear_sum_assignment

    rows, columns = linear_sum_assignment(cost)
    return rows, columns


def match_modes_by_mac(reference: Floats, vectors: Floats) -> Ints:
    """Which mode of one train is which of another, by shape.

    Parameters
    ----------
    reference, vectors : ndarray, shape (n_dof, n_elastic)
        Mass-weighted shapes. [1]

    Returns
    -------
    ndarray of int, shape (n_elastic,)
        Number of the mode that each one of the reference has become. [index]
    """
    _, order = one_to_one(-((reference.T @ vectors) ** 2))
    return np.asarray(order)


# --- what was measured ----------------------------------------------------------------------------


@dataclass(frozen=True)
class Reading:
    """A measured frequency."""

    frequency: float  #: As measured. [Hz]
    uncertainty: float  #: Standard deviation over it. [1]
    #: Elastic mode of the case it is taken for, counted from 0; None = the one that fits.
    mode: int | None
    row: int  #: Row of the table.


@dataclass(frozen=True)
class PeakReading:
    """A measured peak torque."""

    element: str  #: Where.
    torque: float  #: Largest torque of the start, at the element's own speed. [N m]
    uncertainty: float  #: Standard deviation over it. [1]
    row: int  #: Row of the table.


def assign(
    readings: Sequence[Reading],
    frequency: Floats,
    spread: Floats,
    free: Iterable[int],
    forbidden: frozenset[tuple[int, int]] = frozenset(),
) -> dict[int, int]:
    """Which mode each reading is taken for: the likeliest assignment, one to one.

    The distance of a reading from a mode is their difference over the standard deviation of that
    difference, its own uncertainty and the prior spread of the mode together. A reading farther than
    `GATE` from every mode that is left stays without.

    Parameters
    ----------
    readings : sequence of Reading
        Those with a stated mode keep it. [Hz]
    frequency : ndarray, shape (n_elastic,)
        Calculated frequencies. [Hz]
    spread : ndarray, shape (n_elastic,)
        Prior standard deviation of their logarithms. [1]
    free : iterable of int
        Modes that may be chosen. [indices]
    forbidden : frozenset of (int, int)
        Pairs of reading and mode that are not to be. [indices]

    Returns
    -------
    dict of int to int
        Index of a reading → index of its mode. [indices]
    """
    near = distances(readings, frequency, spread)
    mode_of = {
        i: r.mode for i, r in enumerate(readings) if r.mode is not None and near[i, r.mode] <= GATE
    }
    taken = {r.mode for r in readings if r.mode is not None}
    open_ = [i for i, r in enumerate(readings) if r.mode is None]
    modes = [m for m in free if m not in taken]
    cost = np.full((len(open_), len(modes) + len(open_)), GATE**2)
    for a, i in enumerate(open_):
        for b, m in enumerate(modes):
            barred = (i, m) in forbidden or near[i, m] > GATE
            cost[a, b] = 1e6 if barred else near[i, m] ** 2
    for a, b in zip(*one_to_one(cost), strict=True):
        if b < len(modes):
            mode_of[open_[a]] = modes[b]
    return mode_of


def distances(readings: Sequence[Reading], frequency: Floats, spread: Floats) -> Floats:
    """How far each reading is from each mode.

    Parameters
    ----------
    readings : sequence of Reading
        Measured. [Hz]
    frequency, spread : ndarray, shape (n_elastic,)
        Calculated, and the prior standard deviation of its logarithm. [Hz, 1]

    Returns
    -------
    ndarray, shape (n_readings, n_elastic)
        In standard deviations of the difference. [1]
    """
    f = np.array([r.frequency for r in readings])[:, None]
    u = np.array([r.uncertainty for r in readings])[:, None]
    return np.asarray(np.abs(np.log(f / frequency)) / np.sqrt(u**2 + spread**2))


def maximum_torques(case: CaseData) -> dict[str, float]:
    """Largest torque of every element in the start of a case: one unit of work.

    Parameters
    ----------
    case : CaseData
        The changed case. [SI]

    Returns
    -------
    dict of str to float
        Element → torque at its own speed. [N m]
    """
    finer = replace(
        CaseData(**vars(case)),
        tolerance_peak=min(case.tolerance_peak or DEFAULT_TOLERANCE_PEAK, PEAK_ACCURACY),
    )
    start = planned_start(finer, analysis_for_start(finer), estimated=False).start
    return {p.element: p.maximum for p in start.peaks}


#: `map`, or that of a pool of processes.
EachStart = Callable[[Callable[[CaseData], dict[str, float]], Iterable[CaseData]], Iterable[Any]]


def _torque(torques: Mapping[str, float], element: str) -> float:
    if element not in torques:
        raise ModelError(
            f"MeasuredPeaks names '{element}', for which the start gives no torque. Name another "
            "element."
        )
    return torques[element]


class PeakModel:
    """Peak torques against the unknowns, from whole starts.

    Parameters
    ----------
    case : CaseData
        A checked case with a start. [SI]
    unknowns : Unknowns
        What may change. [1]
    readings : sequence of PeakReading
        What was measured. [N m]
    each_start : callable
        Does what `map` does, perhaps in several processes.
    """

    def __init__(
        self,
        case: CaseData,
        unknowns: Unknowns,
        readings: Sequence[PeakReading],
        each_start: EachStart = map,
    ) -> None:
        self.case, self.unknowns, self.readings = case, unknowns, tuple(readings)
        self._each = each_start
        self._known: dict[bytes, Floats] = {}

    @property
    def starts(self) -> int:
        """Starts calculated so far. [count]"""
        return len(self._known)

    def of_case(self) -> Floats:
        """Peak torques of the case as it was typed, shape (n_readings,). [N m]"""
        (torques,) = self._each(maximum_torques, [self.case])
        return np.array([_torque(torques, r.element) for r in self.readings])

    def at(self, points: Sequence[Floats]) -> list[Floats]:
        """Peak torques at several points, those not yet known calculated together.

        Parameters
        ----------
        points : sequence of ndarray, shape (n_unknowns,)
            In prior standard deviations. [1]

        Returns
        -------
        list of ndarray, shape (n_readings,)
            Torques. [N m]
        """
        wanted = {z.tobytes(): z for z in points if z.tobytes() not in self._known}
        cases = [self.unknowns.varied_case(self.case, z) for z in wanted.values()]
        for key, torques in zip(wanted, self._each(maximum_torques, cases), strict=True):
            self._known[key] = np.array([_torque(torques, r.element) for r in self.readings])
        return [self._known[z.tobytes()] for z in points]

    def gradient(self, z: Floats) -> Floats:
        """Change of the torques with each unknown.

        Parameters
        ----------
        z : ndarray, shape (n_unknowns,)
            In prior standard deviations. [1]

        Returns
        -------
        ndarray, shape (n_readings, n_unknowns)
            ∂T/∂z. [N m]
        """
        step = np.maximum(PEAK_STEP, LEAST_PEAK_STEP / self.unknowns.deviation)
        points = [
            z + sign * h * e for h, e in zip(step, np.eye(len(z)), strict=True) for sign in (1, -1)
        ]
        values = self.at(points)
        return np.stack(
            [(values[2 * j] - values[2 * j + 1]) / (2.0 * h) for j, h in enumerate(step)], axis=1
        )


# --- the least change -----------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Solution:
    """The most probable unknowns, and how sure they are."""

    z: Floats  #: In prior standard deviations. [1] Shape (n_unknowns,).
    #: Calculated minus measured over its standard deviation. [1] Shape (n_readings + n_peaks,).
    residual: Floats
    jacobian: Floats  #: Its derivatives. [1] Shape (n_readings + n_peaks, n_unknowns).
    state: State  #: Modes there. [SI]
    order: Ints  #: Where each mode of the case has come to. Shape (n_elastic,).
    torque: Floats  #: Peak torques there. [N m] Shape (n_peaks,).
    modes: dict[int, int]  #: Which mode of the case each reading is taken for. [indices]

    @property
    def least(self) -> float:
        """S(z): sum of squares of the changes and of the residuals. [1]"""
        return float(self.z @ self.z + self.residual @ self.residual)

    @property
    def covariance(self) -> Floats:
        """Posterior covariance of z, shape (n_unknowns, n_unknowns). [1]"""
        return np.asarray(np.linalg.inv(np.eye(len(self.z)) + self.jacobian.T @ self.jacobian))

    @property
    def own_reduction(self) -> Floats:
        """Share of each prior variance that the measurements take away by themselves. [1]

        That is, were all other quantities `WIDER` times as uncertain as table `Scatter` says.
        """
        reduction = np.zeros(len(self.z))
        for j in range(len(self.z)):
            wide = WIDER * self.jacobian
            wide[:, j] = self.jacobian[:, j]
            gram = np.eye(len(self.z)) + wide.T @ wide
            reduction[j] = 1.0 - np.linalg.inv(gram)[j, j]
        return reduction

    @property
    def left_out_residual(self) -> Floats:
        """Each residual as it would be if all others, and not it, had been used. [1]

        r/√(1 − h) with h its diagonal of J C Jᵀ: standard normal if the model holds.
        """
        leverage = np.einsum("ij,jk,ik->i", self.jacobian, self.covariance, self.jacobian)
        return np.asarray(self.residual / np.sqrt(np.maximum(1.0 - leverage, 1e-12)))


def solve(
    model: FrequencyModel,
    readings: Sequence[Reading],
    modes: dict[int, int],
    peaks: PeakModel | None = None,
    begin: Floats | None = None,
) -> Solution:
    """The least change that explains readings taken for given modes.

    Parameters
    ----------
    model : FrequencyModel
        Frequencies. [Hz]
    readings : sequence of Reading
        Measured frequencies. [Hz]
    modes : dict of int to int
        Which mode of the case each used reading is taken for. [indices]
    peaks : PeakModel, optional
        Measured peak torques. [N m]
    begin : ndarray, shape (n_unknowns,), optional
        Where to begin; default the prior's middle. [1]

    Returns
    -------
    Solution
        The least. [1]
    """
    problem = _Problem(model, readings, modes, peaks)
    z = np.zeros(model.unknowns.number) if begin is None else begin
    if (modes or peaks) and len(z):
        from scipy.optimize import least_squares

        limit = EXACT if peaks is None else NOISY
        steps = None if peaks is None else NOISY_STEPS
        z = least_squares(
            problem.all_residuals, z, problem.whole_jacobian,
            xtol=limit, ftol=limit, gtol=limit, max_nfev=steps,
        ).x  # fmt: skip
    problem.accept(z)
    return problem.solution(z, modes)


def solution_at(
    model: FrequencyModel,
    readings: Sequence[Reading],
    z: Floats,
    taken: Mapping[int, int],
) -> Solution:
    """A point at which a search has ended, with what is calculated there.

    Parameters
    ----------
    model : FrequencyModel
        Frequencies. [Hz]
    readings : sequence of Reading
        Measured frequencies. [Hz]
    z : ndarray, shape (n_unknowns,)
        Where. [1]
    taken : mapping of int to int
        Which mode there each used reading is taken for, by number. [indices]

    Returns
    -------
    Solution
        Modes of the case are paired by shape, but those stated with the modes taken for them. [1]
    """
    state = model.at(z)
    likeness = (model.base.vectors.T @ state.vectors) ** 2
    for i, at in taken.items():
        stated = readings[i].mode
        if stated is not None:
            likeness[stated, at] += 2.0
    _, order = one_to_one(-likeness)
    mode_at = {int(at): mode for mode, at in enumerate(order)}
    modes = {i: mode_at[at] for i, at in taken.items()}
    problem = _Problem(model, readings, modes, None)
    problem.stay(z, np.asarray(order))
    return problem.solution(z, modes)


class _Problem:
    """Residuals and their derivatives; remembers the shapes of the last accepted point."""

    def __init__(
        self,
        model: FrequencyModel,
        readings: Sequence[Reading],
        modes: dict[int, int],
        peaks: PeakModel | None,
    ) -> None:
        used = sorted(modes)
        self.model, self.peaks = model, peaks
        self.mode = np.array([modes[i] for i in used], dtype=np.int64)
        self.measured = np.array([readings[i].frequency for i in used])
        self.scale = self.measured * np.array([readings[i].uncertainty for i in used])
        self.torque = np.array([r.torque for r in (peaks.readings if peaks else ())])
        self.torque_scale = self.torque * [r.uncertainty for r in (peaks.readings if peaks else ())]
        self._last: tuple[bytes, State] = (b"", model.base)
        self._shapes = model.base.vectors
        #: Where each mode of the case was at the last accepted point.
        self.order = np.arange(model.base.vectors.shape[1])

    def state(self, z: Floats) -> State:
        if self._last[0] != z.tobytes():
            self._last = (z.tobytes(), self.model.at(z))
        return self._last[1]

    def accept(self, z: Floats) -> None:
        """Follow the modes from the last accepted point to this one."""
        self.order = self._order(self.state(z))
        self._shapes = self.state(z).vectors

    def stay(self, z: Floats, order: Ints) -> None:
        """Take a point, and where each mode of the case is there."""
        self._shapes, self.order = self.state(z).vectors, order

    def solution(self, z: Floats, modes: Mapping[int, int]) -> Solution:
        """What is calculated at the last accepted point."""
        torque = np.empty(0) if self.peaks is None else self.peaks.at([z])[0]
        return Solution(
            z, self.residual(z), self.jacobian(z), self.state(z), self.order, torque, dict(modes)
        )

    def _order(self, state: State) -> Ints:
        return np.asarray(match_modes_by_mac(self._shapes, state.vectors)[self.order])

    def residual(self, z: Floats) -> Floats:
        state = self.state(z)
        f = state.frequency[self._order(state)[self.mode]]
        deviation = (f - self.measured) / self.scale
        if self.peaks is None:
            return np.asarray(deviation)
        torque = (self.peaks.at([z])[0] - self.torque) / self.torque_scale
        return np.concatenate([deviation, torque])

    def jacobian(self, z: Floats) -> Floats:
        state = self.state(z)
        at = self._order(state)[self.mode]
        slope = self.model.gradient(state)[at] * self.model.unknowns.factor_and_slope(z)[1]
        jacobian = (state.frequency[at] / self.scale)[:, None] * slope
        if self.peaks is None:
            return np.asarray(jacobian)
        return np.vstack([jacobian, self.peaks.gradient(z) / self.torque_scale[:, None]])

    def all_residuals(self, z: Floats) -> Floats:
        return np.concatenate([z, self.residual(z)])

    def whole_jacobian(self, z: Floats) -> Floats:
        self.accept(z)  # least_squares asks for derivatives at accepted points only
        return np.vstack([np.eye(len(z)), self.jacobian(z)])


# --- which reading is which mode ------------------------------------------------------------------


#: Per reading the next best mode for it (None = none at all), and by how much S would be
#: larger. [index, 1]
Rivals = dict[int, tuple[int | None, float]]


def best_assignment(model: FrequencyModel, readings: Sequence[Reading]) -> tuple[Solution, Rivals]:
    """The assignment with the least S after calibration, not before.

    Begins with the likeliest before; then each reading in turn is barred from its mode, all are
    assigned and calibrated again, and a better whole is taken, until none is.

    Parameters
    ----------
    model : FrequencyModel
        Frequencies. [Hz]
    readings : sequence of Reading
        Measured. [Hz]

    Returns
    -------
    solution : Solution
        The least change of the best one. [1]
    rivals : dict of int to (int or None, float)
        What else its readings could be. [index, 1]
    """
    at = model.at(np.zeros(model.unknowns.number))
    spread = model.prior_spread(at)
    order = match_modes_by_mac(model.base.vectors, at.vectors)
    frequency, spread = at.frequency[order], spread[order]
    twists = model.base.modes.twists[model.base.modes.n_rigid :]
    free = [int(m) for m in np.flatnonzero(twists)]

    def solved(forbidden: frozenset[tuple[int, int]]) -> Solution:
        return solve(model, readings, assign(readings, frequency, spread, free, forbidden))

    def misfit(solution: Solution) -> float:
        return solution.least + GATE**2 * (len(readings) - len(solution.modes))

    best = solved(frozenset())
    rivals: Rivals = {}
    for _ in range(len(readings) + 1):
        barred = {i: m for i, m in best.modes.items() if readings[i].mode is None}
        others = {i: solved(frozenset({(i, m)})) for i, m in barred.items()}
        rivals = {
            i: (other.modes.get(i), misfit(other) - misfit(best)) for i, other in others.items()
        }
        better = min(others.values(), key=misfit, default=best)
        if misfit(better) >= misfit(best) - 1e-9:
            break
        best = better
    return best, rivals
