"""Every natural frequency right to 1e-12, however far apart the numbers of a train lie.

The rows are the hard trains on which eigenvalue solvers of K and M lose up to all digits: stiffness
over 16 and inertia over 12 decades and the like. The reference is no eigenvalue solver: each
frequency is proven by counting in 120 digits (`high_precision`), which also serves 200 stations.
"""

from dataclasses import replace

import mpmath
import numpy as np
import pytest
from high_precision import ReferredTree

import engine.numerics.singular_values
from engine.case.data import CaseData, ElementRow, MotorTorqueRow, StationRow
from engine.model.build_train import build_train
from engine.model.modes import modes_of

TOLERANCE = 1e-12


def decades(rng, n, span, centre=0.0):
    return 10.0 ** (centre + rng.uniform(-span / 2, span / 2, n))


def train(inertia, stiffness, parents=None, ratios=None, rigid=None, ground=()):
    """Station i hangs on `parents[i]` (default a chain); `rigid[i]` merges it by a mesh."""
    n = len(inertia)
    parents = range(-1, n - 1) if parents is None else parents
    ratios = np.ones(n) if ratios is None else ratios
    elements = []
    for i, (parent, k) in enumerate(zip(list(parents)[1:], stiffness, strict=True), start=1):
        mesh = ratios[i] != ratios[parent]
        k = None if rigid is not None and rigid[i] else float(k)
        elements.append(
            ElementRow(f"E{i}", "gear mesh" if mesh else "shaft", f"S{parent}", f"S{i}", k)
        )
    for i, k in ground:
        elements.append(ElementRow(f"G{i}", "spring to ground", f"S{i}", "ground", float(k)))
    stations = tuple(
        StationRow(f"S{i}", None, float(J), float(ratio))
        for i, (J, ratio) in enumerate(zip(inertia, ratios, strict=True))
    )
    return CaseData(stations=stations, elements=tuple(elements))


def benign(rng, n):
    return train(decades(rng, n, 1), decades(rng, n - 1, 1.5, 5.5))


def soft_coupling(rng, n):
    k = decades(rng, n - 1, 1.5, 5.5)
    k[rng.integers(n - 1)] *= 1e-10
    return train(decades(rng, n, 1), k)


def stiff_link(rng, n):
    k = decades(rng, n - 1, 1.5, 5.5)
    k[rng.integers(n - 1)] *= 1e9
    return train(decades(rng, n, 1), k)


def inertias_over_14_decades(rng, n):
    return train(decades(rng, n, 14), decades(rng, n - 1, 1.5, 5.5))


def everything(rng, n):
    return train(decades(rng, n, 12), decades(rng, n - 1, 16, 5.0))


def tree_of(rng, n):
    return [-1, *(int(rng.integers(max(0, i - 4), i)) for i in range(1, n))]


def branched(rng, n):
    return train(decades(rng, n, 12), decades(rng, n - 1, 16, 5.0), tree_of(rng, n))


def geared(rng, n):
    ratios = decades(rng, n, 2)
    rigid = rng.random(n) < 0.4
    return train(decades(rng, n, 12), decades(rng, n - 1, 16, 5.0), tree_of(rng, n), ratios, rigid)


def geared_and_grounded(rng, n):
    case = geared(rng, n)
    ground = tuple(
        ElementRow(f"G{j}", "spring to ground", f"S{i}", "ground", float(decades(rng, 1, 16, 5)[0]))
        for j, i in enumerate(rng.integers(n, size=3))
    )
    return replace(case, elements=case.elements + ground)


def parallel_elements(rng, n):
    """Some shafts doubled by a spring far softer or stiffer beside them."""
    case = everything(rng, n)
    beside = tuple(
        replace(e, element=f"{e.element} beside", stiffness=float(e.stiffness * f))
        for e, f in zip(case.elements, decades(rng, n - 1, 12), strict=True)
        if rng.random() < 0.3
    )
    return replace(case, elements=case.elements + beside)


ROWS = [
    benign,
    soft_coupling,
    stiff_link,
    inertias_over_14_decades,
    everything,
    branched,
    geared,
    geared_and_grounded,
    parallel_elements,
]


def check(case):
    modes = modes_of(build_train(case))
    reference = ReferredTree(case)
    assert len(modes.omega) == len(reference.mass)
    assert np.all(modes.omega[: modes.n_rigid] == 0.0)
    assert reference.wrong(modes.omega, TOLERANCE) == []
    return modes


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("n", [10, 30])
@pytest.mark.parametrize("row", ROWS)
def test_every_frequency(row, n, seed):
    check(row(np.random.default_rng([seed, n]), n))


@pytest.mark.first_ones(1)
@pytest.mark.parametrize("row", ROWS)
def test_every_frequency_of_200_stations(row):
    check(row(np.random.default_rng(200), 200))


@pytest.mark.slow
@pytest.mark.parametrize(
    "seed",
    [*range(100, 106), *(pytest.param(k, marks=pytest.mark.long) for k in range(106, 160))],
)
@pytest.mark.parametrize("row", ROWS)
def test_every_frequency_of_many_trains(row, seed):
    rng = np.random.default_rng(seed)
    check(row(rng, int(rng.integers(2, 60))))


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("row", ROWS)
def test_every_frequency_of_more_large_trains(row, seed):
    check(row(np.random.default_rng([seed, 201]), 200))


def test_the_reference_agrees_with_an_eigenvalue_solver():
    """The counting itself, against mpmath's symmetric eigenvalues in 60 digits."""
    case = everything(np.random.default_rng(7), 8)
    with mpmath.workdps(60):
        J = [mpmath.mpf(s.inertia) for s in case.stations]
        A = mpmath.zeros(8)
        for i, e in enumerate(case.elements):
            k = mpmath.mpf(e.stiffness)
            A[i, i] += k / J[i]
            A[i + 1, i + 1] += k / J[i + 1]
            A[i, i + 1] = A[i + 1, i] = -k / mpmath.sqrt(J[i] * J[i + 1])
        exact = sorted(mpmath.eigsy(A, eigvals_only=True))[1:]
        omega = [0.0, *(float(mpmath.sqrt(value)) for value in exact)]
    reference = ReferredTree(case)
    assert reference.wrong(omega, 3e-16) == []
    assert reference.wrong([w * (1 + 1e-12) for w in omega], 1e-13) == list(range(1, 8))


def test_the_plain_svd_alone_would_not_do():
    """What the Jacobi SVD and the counts are for: the same trains through one plain SVD."""
    worst = 0.0
    for seed in range(4):
        case = everything(np.random.default_rng([seed, 30]), 30)
        t = build_train(case)
        D = np.sqrt(t.stiffness)[:, None] * t.incidence / np.sqrt(t.inertia)
        plain = np.linalg.svd(D, compute_uv=False)[::-1]
        worst = max(worst, float(np.max(np.abs(plain / modes_of(t).omega[1:] - 1))))
    assert worst > 1e-12


def test_counts_find_and_correct_a_wrong_value(monkeypatch):
    """A Jacobi SVD that errs on purpose is put right."""
    case = everything(np.random.default_rng(3), 30)
    honest = engine.numerics.singular_values.svd

    def erring(D):
        u, sigma, v = honest(D)
        sigma = sigma.copy()
        sigma[:, 5] *= 1 + 1e-9
        sigma[:, 20] *= 1 - 1e-11
        sigma[:, 28] *= 1 + 3e-5
        return u, sigma, v

    monkeypatch.setattr(engine.numerics.singular_values, "svd", erring)
    check(case)


def test_mode_shapes_are_orthogonal_to_working_precision():
    """Unit modal mass and ΦᵀMΦ = I, also where frequencies span 10 decades."""
    for seed in range(4):
        t = build_train(everything(np.random.default_rng([seed, 30]), 30))
        modes = modes_of(t)
        scaled = np.sqrt(t.inertia)[:, None] * modes.shape
        assert scaled.T @ scaled == pytest.approx(np.eye(30), abs=1e-12)


def test_a_motor_changes_no_frequency():
    case = benign(np.random.default_rng(5), 10)
    motored = replace(case, motor_torque=(MotorTorqueRow("S4", 0.0, 1.0, 0.0),))
    assert np.all(modes_of(build_train(motored)).omega == modes_of(build_train(case)).omega)
