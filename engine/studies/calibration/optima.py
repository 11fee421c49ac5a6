"""All optima of a calibration, and samples of the posterior around them.

Measured frequencies may be explained by several trains: the mirror image of a symmetric one, or one
whose modes take the measurements in another order. So the search begins at several places, drawn
from the prior, and every optimum that is probable enough is kept.

Near an optimum the posterior is a normal distribution only if the spreads are small. Its samples are
therefore drawn by randomising the measurements and optimising again (randomize-then-optimize):
with H(z) = [z; residuals], J its derivative, and Q an orthonormal basis of the columns of J at
the optimum, Qᵀ H(z) = ε is solved for standard normal ε. These z have the density

    |det Qᵀ J(z)| exp(−½ |Qᵀ H(z)|²) / (2π)^(n/2),

known up to nothing, so the weights that make the samples of all optima those of the posterior, the optima
in proportion to their probability, are exact, and their quantiles are its intervals.

References
----------
Bardsley, Solonen, Haario and Laine, "Randomize-then-optimize: a method for sampling from posterior
distributions in nonlinear inverse problems", SIAM J. Sci. Comput. 36 (2014) A1895; Owen & Zhou, "Safe
and effective importance sampling", J. Am. Stat. Assoc. 95 (2000) 135 (mixtures); Tarantola, Inverse
Problem Theory (2005), chapter 2.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from engine.arrays import Floats, Ints
from engine.case.study_inputs import INERTIA, STIFFNESS
from engine.studies.calibration.least_squares import (
    FrequencyModel,
    Reading,
    Solution,
    match_modes_by_mac,
    one_to_one,
)

#: Where the search begins, beside the first solution. [count]
BEGINNINGS = 48
#: Most steps of one search, of one that has come near, and of one sample. [count]
SEARCH_STEPS, LONG_SEARCH, SAMPLE_STEPS = 40, 200, 20
#: A sample is solved if its sum of squares is below. [1]
SOLVED = 1e-12
#: An optimum whose misfit is larger by more is too improbable to be told: e^(−½ · 12) = 0.2 %. [1]
IMPROBABLE_MISFIT = 12.0
#: Most optima. [count]
MOST_OPTIMA = 8
#: Samples of the posterior, of all optima together. [count]
SAMPLES = 512
#: Until they are worth so many of equal weight, twice as many are drawn, so often at the most. [count]
EFFECTIVE, MOST_DOUBLINGS = 150, 3
#: Trains of more degrees of freedom have fewer of both, at least this share: modes take n³. [count, 1]
LARGE_TRAIN, LEAST_SHARE = 60, 0.25
#: Numbers in one array of matrices. [count]
MOST_NUMBERS = 2_000_000
#: Two points are the same optimum if they are so close in posterior standard deviations. [1]
SAME = 0.1
#: A mirror image is so much nearer to another optimum than the first is. [1]
MIRROR = 0.3
#: The draws are the same each time. [seed]
SEED = 20260101


class FastFrequencies:
    """Natural frequencies of many changed trains at once, by number.

    Parameters
    ----------
    model : FrequencyModel
        The train and its unknowns. [SI]
    """

    def __init__(self, model: FrequencyModel) -> None:
        train, self.unknowns = model.base.train, model.unknowns
        #: Elastic modes of all, the rest are rigid.
        self._elastic = train.n_dof - model.base.modes.n_rigid
        self._incidence = train.incidence
        self._k, self._m = train.stiffness, train.inertia
        n = self.unknowns.number
        self._dk, self._dm = np.zeros((n, train.n_rows)), np.zeros((n, train.n_dof))
        own = {str(s.station): s.inertia or 0.0 for s in model.case.stations}
        for j, factor in enumerate(self.unknowns.factors):
            for name in factor.names:
                if factor.quantity == STIFFNESS:
                    rows = train.row_element == train.elements.index(name)
                    self._dk[j, rows] = train.stiffness[rows]
                elif factor.quantity == INERTIA:
                    i = train.stations.index(name)
                    self._dm[j, train.node_dof[i]] += own[name] * train.node_scale[i] ** 2

    @property
    def effort(self) -> float:
        """Share of the usual number of points that a train of this size is given. [1]"""
        return float(np.clip((LARGE_TRAIN / len(self._m)) ** 2, LEAST_SHARE, 1.0))

    def frequency(self, z: Floats) -> Floats:
        """Frequencies of all elastic modes alone.

        Parameters
        ----------
        z : ndarray, shape (n_points, n_unknowns)
            Standard normal. [1]

        Returns
        -------
        ndarray, shape (n_points, n_elastic)
            Rising. [Hz]
        """
        found = []
        for part in self._parts(z):
            scaled, *_ = self._scaled(part)
            sigma = np.linalg.svd(scaled, compute_uv=False)
            found.append(sigma[:, : self._elastic][:, ::-1])
        return np.concatenate(found) / (2.0 * math.pi)

    def _parts(self, z: Floats) -> list[Floats]:
        """Points in parts that fit into memory."""
        size = max(MOST_NUMBERS // self._incidence.size, 1)
        return [z[i : i + size] for i in range(0, len(z), size)] or [z]

    def _scaled(self, z: Floats) -> tuple[Floats, ...]:
        """√k B/√m, k, m, p and d ln p/dz of each point."""
        p, slope = self.unknowns.factor_and_slope(z)
        k, m = self._k + (p - 1.0) @ self._dk, self._m + (p - 1.0) @ self._dm
        scaled = np.sqrt(k)[:, :, None] * self._incidence / np.sqrt(m)[:, None, :]
        return scaled, k, m, p, slope

    def at(self, z: Floats, number: int) -> tuple[Floats, Floats]:
        """Frequencies of the lowest elastic modes and their derivatives.

        Parameters
        ----------
        z : ndarray, shape (n_points, n_unknowns)
            Standard normal. [1]
        number : int
            Modes wanted. [count]

        Returns
        -------
        frequency : ndarray, shape (n_points, n_modes)
            Rising. [Hz]
        gradient : ndarray, shape (n_points, n_modes, n_unknowns)
            ∂ ln f/∂z, from the energies of the modes. [1]
        """
        values, gradients = [], []
        for part in self._parts(z):
            scaled, k, m, p, slope = self._scaled(part)
            u, sigma, v = np.linalg.svd(scaled, full_matrices=False)
            keep = slice(max(self._elastic - number, 0), self._elastic)
            sigma, u, v = (
                sigma[:, keep][:, ::-1], u[:, :, keep][:, :, ::-1], v[:, keep][:, ::-1]
            )  # fmt: skip
            strain = np.swapaxes(u**2, 1, 2) / np.where(k > 0.0, k, 1.0)[:, None, :]
            energy = strain @ self._dk.T - (v**2 / m[:, None, :]) @ self._dm.T
            values.append(sigma / (2.0 * math.pi))
            gradients.append(0.5 * energy * (p * slope)[:, None, :])
        return np.concatenate(values), np.concatenate(gradients)


@dataclass(frozen=True, eq=False)
class _Target:
    """Changes and residuals H(z) of one assignment of readings to modes by number."""

    model: FrequencyModel
    fast: FastFrequencies
    number: int  #: Modes that are looked at, the lowest. [count]
    mode: Ints  #: By number, of each used reading. Shape (n_points or 1, n_used).
    measured: Floats  #: [Hz] Shape (n_used,).
    scale: Floats  #: Its standard deviation. [Hz] Shape (n_used,).
    #: Peak torques are linear about the first solution: residuals there, derivatives, and where.
    peak_residual: Floats  #: [1] Shape (n_peaks,).
    peak_slope: Floats  #: [1] Shape (n_peaks, n_unknowns).
    centre: Floats  #: [1] Shape (n_unknowns,).

    def at(self, z: Floats, mode: Ints | None = None) -> tuple[Floats, Floats]:
        """H, shape (n_points, n_unknowns + n_data), and its derivative."""
        mode = np.broadcast_to(self.mode if mode is None else mode, (len(z), len(self.measured)))
        frequency, gradient = self.fast.at(z, self.number)
        f = np.take_along_axis(frequency, mode, axis=1)
        g = np.take_along_axis(gradient, mode[:, :, None], axis=1)
        peaks = self.peak_residual + (z - self.centre) @ self.peak_slope.T
        value = np.concatenate([z, (f - self.measured) / self.scale, peaks], axis=1)
        one = np.broadcast_to(np.eye(z.shape[1]), (len(z), z.shape[1], z.shape[1]))
        steep = np.broadcast_to(self.peak_slope, (len(z), *self.peak_slope.shape))
        return value, np.concatenate([one, (f / self.scale)[:, :, None] * g, steep], axis=1)


@dataclass(frozen=True, eq=False)
class Optimum:
    """One train that explains the measurements."""

    z: Floats  #: Standard normal. [1] Shape (n_unknowns,).
    #: Mode each used reading is taken for, by number after calibration. [indices] Shape (n_used,).
    mode: tuple[int, ...]
    misfit: float  #: S(z). [1]


@dataclass(frozen=True, eq=False)
class Posterior:
    """Samples of the posterior, and the optima they surround."""

    optima: tuple[Optimum, ...]  #: The least misfit first.
    z: Floats  #: Samples. [1] Shape (n_samples, n_unknowns).
    weight: Floats  #: Their weights, of sum one. [1] Shape (n_samples,).
    owner: Ints  #: Optimum each was drawn around. [index] Shape (n_samples,).
    frequency: Floats  #: Of the modes by number. [Hz] Shape (n_samples, n_modes).
    effective: float  #: Equally weighted samples that are worth as much. [count]

    def around(self, optimum: int) -> Floats:
        """Weights of the samples around one optimum; their sum is its probability. [1]"""
        return np.where(self.owner == optimum, self.weight, 0.0)


def quantiles(values: Floats, weight: Floats, at: Sequence[float]) -> list[float]:
    """Quantiles of weighted samples.

    Parameters
    ----------
    values, weight : ndarray, shape (n_samples,)
        Samples and their weights, of any sum. [any, 1]
    at : sequence of float
        Probabilities. [1]

    Returns
    -------
    list of float
        Interpolated between the middles of the weights. [as values]
    """
    order = np.argsort(values)
    weight = weight[order] / weight.sum()
    middle = np.cumsum(weight) - 0.5 * weight
    return [float(q) for q in np.interp(at, middle, values[order])]


def exchanged(model: FrequencyModel, first: Floats, other: Floats) -> list[tuple[int, int]]:
    """Unknowns that one optimum has exchanged against another, as a mirror image has.

    Parameters
    ----------
    model : FrequencyModel
        The train and its unknowns. [SI]
    first, other : ndarray, shape (n_unknowns,)
        Two optima. [1]

    Returns
    -------
    list of (int, int)
        Pairs whose values are exchanged; empty where the frequencies of the first with these
        exchanged are not its own. [indices]
    """
    kinds = [f.quantity for f in model.unknowns.factors]
    alike = np.array([[a == b for b in kinds] for a in kinds])
    cost = np.where(alike, np.abs(other[:, None] - first[None, :]), 1e6)
    _, place = one_to_one(cost)
    pairs = [(j, int(k)) for j, k in enumerate(place) if j < k and place[k] == j]
    pairs = [(j, k) for j, k in pairs if abs(first[j] - first[k]) > SAME]
    if not pairs:
        return []
    mirrored = first.copy()
    for j, k in pairs:
        mirrored[[j, k]] = first[[k, j]]
    near = np.linalg.norm(mirrored - other) < MIRROR * np.linalg.norm(first - other)
    return pairs if near else []


def posterior_of(
    model: FrequencyModel, readings: Sequence[Reading], solution: Solution
) -> Posterior:
    """All optima beside a first one, and samples of the posterior.

    Parameters
    ----------
    model : FrequencyModel
        The train and its unknowns. [SI]
    readings : sequence of Reading
        Measured frequencies. [Hz]
    solution : Solution
        The first optimum; readings it does not use stay unused. [1]

    Returns
    -------
    Posterior
        At least one optimum. [1]
    """
    used = sorted(solution.modes)
    rows = [readings[i] for i in used]
    first = np.array([solution.order[solution.modes[i]] for i in used], dtype=np.int64)
    number = min(len(solution.order), max([*first.tolist(), len(used)], default=0) + 4)
    measured = np.array([r.frequency for r in rows])
    n = model.unknowns.number
    target = _Target(
        model,
        FastFrequencies(model),
        number,
        first[None],
        measured,
        measured * np.array([r.uncertainty for r in rows]),
        solution.residual[len(used) :],
        solution.jacobian[len(used) :],
        solution.z,
    )
    if not n:
        one = Optimum(solution.z, tuple(first.tolist()), solution.least)
        z = np.zeros((1, 0))
        return Posterior(
            (one,), z, np.ones(1), np.zeros(1, dtype=np.int64), target.fast.frequency(z), 1
        )
    optima = _optima(target, rows, solution)
    samples = round(target.fast.effort * SAMPLES)
    for doubling in range(MOST_DOUBLINGS + 1):
        posterior = _sampled(target, optima, samples << doubling)
        if posterior.effective >= EFFECTIVE:
            break
    return posterior


# --- the search -----------------------------------------------------------------------------------


def _optima(target: _Target, rows: Sequence[Reading], solution: Solution) -> tuple[Optimum, ...]:
    """The first one, by stated modes as numbers and shapes, and what other beginnings lead to."""
    first, n = target.mode[0], len(solution.z)
    begin = np.concatenate(
        [solution.z[None], _normal(round(target.fast.effort * BEGINNINGS), n, SEED)]
    )
    by_number = np.array([first[a] if r.mode is None else r.mode for a, r in enumerate(rows)])
    frequency = target.fast.frequency(begin)[:, : target.number]
    taken = [
        _assigned(target, rows, f, by_number if i % 2 else first) if i else first
        for i, f in enumerate(frequency)
    ]
    modes = np.array(taken, dtype=np.int64).reshape(len(begin), -1)
    z, value, modes = _least(target, begin, modes)
    # readings of no stated mode go to the nearest where the search ended, and it goes on
    frequency = target.fast.frequency(z)[:, : target.number]
    again = [_assigned(target, rows, f, m) for f, m in zip(frequency, modes, strict=True)]
    other = np.array(again, dtype=np.int64).reshape(modes.shape)
    changed = np.flatnonzero(np.any(other != modes, axis=1))
    if len(changed):
        more, more_value, _ = _least(target, z[changed], other[changed])
        z, value = np.concatenate([z, more]), np.concatenate([value, more_value])
        modes = np.concatenate([modes, other[changed]])
    misfit = np.sum(value**2, axis=1)
    close = misfit < np.min(misfit) + 2.0 * IMPROBABLE_MISFIT
    close[0] = True  # the first one stays: its modes were followed step by step
    near = np.flatnonzero(close)
    z, value, modes = _least(target, z[near], modes[near], LONG_SEARCH)
    misfit, jacobian = np.sum(value**2, axis=1), target.at(z, modes)[1]
    found: list[Optimum] = []
    for i in np.argsort(misfit, kind="stable"):
        if found and misfit[i] > found[0].misfit + IMPROBABLE_MISFIT or len(found) == MOST_OPTIMA:
            break
        mode, J = tuple(int(m) for m in modes[i]), jacobian[i]
        step = np.linalg.lstsq(J, value[i], rcond=None)[0]
        if found and np.linalg.norm(J @ step) > SAME:
            continue  # no optimum, but the kink where two modes meet
        same = (o for o in found if o.mode == mode)
        known = any(np.linalg.norm(J @ (o.z - z[i])) < SAME for o in same)
        if not known and (near[i] == 0 or _as_stated(target, rows, mode, z[i])):
            found.append(Optimum(z[i], mode, float(misfit[i])))
    return tuple(found)


def _as_stated(target: _Target, rows: Sequence[Reading], mode: Sequence[int], z: Floats) -> bool:
    """Whether stated modes are the measured ones, by number or by shape."""
    stated = [(a, r.mode) for a, r in enumerate(rows) if r.mode is not None]
    if all(mode[a] == m for a, m in stated):
        return True
    state = target.model.at(z)
    order = match_modes_by_mac(target.model.base.vectors, state.vectors)
    return all(mode[a] == order[m] for a, m in stated)


def _assigned(target: _Target, rows: Sequence[Reading], frequency: Floats, fixed: Ints) -> Ints:
    """Stated modes as they are fixed, every other reading to the nearest of those left."""
    mode = np.array(fixed)
    open_ = [a for a, r in enumerate(rows) if r.mode is None]
    if open_:
        taken = {int(mode[a]) for a, r in enumerate(rows) if r.mode is not None}
        left = np.array([m for m in range(len(frequency)) if m not in taken])
        off = np.log(target.measured[open_, None] / frequency[left])
        for a, b in zip(*one_to_one(off**2), strict=True):
            mode[open_[a]] = left[b]
    return mode


def _least(
    target: _Target, z: Floats, mode: Ints, steps: int = SEARCH_STEPS
) -> tuple[Floats, Floats, Ints]:
    """Levenberg and Marquardt's search from several beginnings at once."""
    z = z.copy()
    value, jacobian = target.at(z, mode)
    damping = np.full(len(z), 1e-3)
    going = np.arange(len(z))
    for _ in range(steps):
        J, H = jacobian[going], value[going]
        normal = np.swapaxes(J, 1, 2) @ J
        slope = np.einsum("pij,pi->pj", J, H)
        diagonal = np.einsum("pii->pi", normal)
        normal = normal + np.eye(z.shape[1]) * (damping[going, None] * diagonal)[:, None, :]
        step = -np.linalg.solve(normal, slope[:, :, None])[:, :, 0]
        new_value, new_jacobian = target.at(z[going] + step, mode[going])
        old, new = np.sum(H**2, axis=1), np.sum(new_value**2, axis=1)
        better = new <= old
        ok = going[better]
        z[ok] += step[better]
        value[ok], jacobian[ok] = new_value[better], new_jacobian[better]
        damping[going] = np.where(better, 0.2 * damping[going], 5.0 * damping[going])
        small = np.einsum("pij,pj->pi", J, step)
        done = (np.sum(small**2, axis=1) < 1e-14) | (damping[going] > 1e8)
        going = going[~done]
        if not len(going):
            break
    return z, value, mode


# --- samples --------------------------------------------------------------------------------------


def _normal(number: int, dimension: int, seed: int) -> Floats:
    """Standard normal points of a Latin hypercube."""
    from scipy.special import ndtri
    from scipy.stats import qmc  # most of a second that only a calibration pays

    return np.asarray(ndtri(qmc.LatinHypercube(dimension, seed=seed).random(number)))


def _whitened(points: Floats) -> Floats:
    """The points with mean zero and covariance one, so that a linear problem is solved exactly."""
    number, dimension = points.shape
    if number <= 2 * dimension:
        return points
    points = points - points.mean(axis=0)
    root = np.linalg.cholesky(points.T @ points / number)
    return np.asarray(np.linalg.solve(root, points.T).T)


def _sampled(target: _Target, optima: tuple[Optimum, ...], samples: int) -> Posterior:
    each = max(samples // len(optima), 1)
    bases = [
        np.linalg.qr(target.at(o.z[None], np.array([o.mode], dtype=np.int64))[1][0]) for o in optima
    ]
    points, owners = [], []
    for i, (optimum, (basis, triangle)) in enumerate(zip(optima, bases, strict=True)):
        noise = _whitened(_normal(each, len(optimum.z), SEED + 1 + i))
        z = _solved(target, optimum, basis, triangle, noise)
        points.append(z)
        owners.append(np.full(len(z), i))
    z, owner = np.concatenate(points), np.concatenate(owners)
    log_weight = np.full(len(z), -math.inf)
    for mode in dict.fromkeys(o.mode for o in optima):
        mine = [i for i, o in enumerate(optima) if o.mode == mode]
        those = np.flatnonzero(np.isin(owner, mine))
        value, jacobian = target.at(z[those], np.array([mode], dtype=np.int64))
        proposals = []
        for i in mine:
            basis = bases[i][0]
            _, determinant = np.linalg.slogdet(basis.T @ jacobian)
            proposals.append(determinant - 0.5 * np.sum((value @ basis) ** 2, axis=1))
        log_weight[those] = -0.5 * np.sum(value**2, axis=1) - np.logaddexp.reduce(proposals, axis=0)
    weight = np.exp(log_weight - np.max(log_weight))
    weight /= weight.sum()
    return Posterior(
        optima, z, weight, owner, target.fast.frequency(z), float(1.0 / np.sum(weight**2))
    )


def _solved(
    target: _Target, optimum: Optimum, basis: Floats, triangle: Floats, noise: Floats
) -> Floats:
    """z of Qᵀ H(z) = ε, by Newton's method; points where it fails are left out."""
    mode = np.array([optimum.mode], dtype=np.int64)
    z = optimum.z + np.linalg.solve(triangle, noise.T).T
    value, jacobian = target.at(z, mode)
    miss = value @ basis - noise
    off = np.sum(miss**2, axis=1)
    length = np.ones(len(z))
    going = np.flatnonzero(off > SOLVED)
    for _ in range(SAMPLE_STEPS):
        if not len(going):
            break
        full = np.linalg.solve(basis.T @ jacobian[going], miss[going, :, None])[:, :, 0]
        trial = z[going] - length[going, None] * full
        new_value, new_jacobian = target.at(trial, mode)
        new_miss = new_value @ basis - noise[going]
        new_off = np.sum(new_miss**2, axis=1)
        better = new_off < off[going]
        ok = going[better]
        z[ok], jacobian[ok] = trial[better], new_jacobian[better]
        miss[ok], off[ok] = new_miss[better], new_off[better]
        length[going] = np.where(better, np.minimum(2.0 * length[going], 1.0), 0.25 * length[going])
        going = going[(off[going] > SOLVED) & (length[going] > 1e-4)]
    solved = z[off <= SOLVED]
    return np.asarray(solved if len(solved) else optimum.z[None])
