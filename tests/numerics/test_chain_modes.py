"""Modes of long unbranched trains: every value and vector right, at the cost of n².

References: the closed form of equal discs on equal shafts, ω_j = 2 √(k/J) sin(jπ/2n) with shapes
cos((i + ½) jπ/n) (Blevins, "Formulas for Natural Frequency and Mode Shape", 1979, table 8-1), and
counts in 120 digits for trains whose numbers lie decades apart.
"""

import mpmath
import numpy as np
import pytest
from high_precision import ReferredTree

import engine.numerics.singular_values as singular_values
from engine.case.data import CaseData, ElementRow, StationRow
from engine.model.build_train import build_train
from engine.model.modes import modes_of


def chain(inertia, stiffness, order=None):
    """Stations from one end to the other, in the table in another order if wanted."""
    n = len(inertia)
    stations = [StationRow(f"S{i}", None, float(inertia[i])) for i in range(n)]
    elements = [
        ElementRow(f"E{i}", "shaft", f"S{i}", f"S{i + 1}", float(k))
        for i, k in enumerate(stiffness)
    ]
    if order is not None:
        stations = [stations[i] for i in order]
        elements = [elements[i] for i in order if i < n - 1]
    return CaseData(stations=tuple(stations), elements=tuple(elements))


def scaled(train):
    return np.sqrt(train.stiffness)[:, None] * train.incidence / np.sqrt(train.inertia)


@pytest.mark.slow
@pytest.mark.parametrize("n", [450, 1000])
def test_equal_discs_have_the_frequencies_and_shapes_of_the_closed_form(n):
    train = build_train(chain(np.full(n, 3.0), np.full(n - 1, 7e6)))
    modes = modes_of(train)
    j = np.arange(1, n)
    exact = 2.0 * np.sqrt(7e6 / 3.0) * np.sin(j * np.pi / (2 * n))
    assert modes.algorithm == "chain"
    assert modes.omega[0] == 0.0
    assert modes.omega[1:] == pytest.approx(exact, rel=1e-12)
    place = (np.arange(n) + 0.5)[:, None]
    shape = np.cos(place * j * np.pi / n) * np.sqrt(2.0 / n / 3.0)
    found = modes.shape[:, 1:] * np.sign(modes.shape[0, 1:])
    assert found == pytest.approx(shape, abs=1e-9 * np.max(shape))


def test_long_trains_over_many_decades_are_proven_by_counting():
    """Stiffness over 16 and inertia over 12 decades; the counts are of another matrix, another
    arithmetic."""
    rng = np.random.default_rng(7)
    n = 420
    case = chain(10.0 ** rng.uniform(-6, 6, n), 10.0 ** rng.uniform(2, 18, n - 1))
    modes = modes_of(build_train(case))
    assert modes.algorithm == "chain"
    with mpmath.workdps(120):
        tree = ReferredTree(case)
        for j in (1, 2, 3, 50, 200, 300, 417, 418, 419):
            omega = mpmath.mpf(float(modes.omega[j]))
            below, above = (tree.count_below(omega * (1 + s)) for s in (-1e-12, 1e-12))
            assert below <= j < above


@pytest.mark.slow
def test_vectors_of_a_random_long_train_are_orthogonal_and_solve_the_equation():
    rng = np.random.default_rng(1)
    n = 500
    order = rng.permutation(n)
    case = chain(np.exp(rng.uniform(0.7, 5.5, n)), np.exp(rng.uniform(16, 20, n - 1)), order)
    train = build_train(case)
    (u,), (sigma,), (v,), algorithm = singular_values.singular_triplets(
        np.sqrt(train.stiffness)[None], train.incidence, np.sqrt(train.inertia)[None], n - 1
    )
    assert algorithm == ("chain",)
    assert sigma[0] == 0.0
    D, u, sigma, v = scaled(train), u[:, 1:], sigma[1:], v[:, 1:]
    assert v.T @ v == pytest.approx(np.eye(n - 1), abs=1e-11)
    assert u.T @ u == pytest.approx(np.eye(n - 1), abs=1e-11)
    assert np.max(np.abs(D @ v - u * sigma) / sigma) < 1e-12
    assert np.max(np.abs(D.T @ u - v * sigma) / sigma) < 1e-12
    plain = np.linalg.svd(D, compute_uv=False)[::-1]
    assert sigma == pytest.approx(plain, rel=1e-11)


@pytest.mark.first_ones(1)
@pytest.mark.parametrize("apart", [1e-6, 1e-9, 1e-13])
def test_near_twins_in_a_long_train_stay_orthogonal(apart):
    """Two equal halves joined by next to nothing: values in pairs, found by the Jacobi SVD then."""
    n = 400
    k = np.full(n + 4, 1e6)
    k[(n + 4) // 2] = 1e6 * apart
    train = build_train(chain(np.full(n + 5, 1.0), k))
    modes = modes_of(train)
    assert modes.algorithm in ("chain", "jacobi", "svd")
    assert modes.shape.T @ modes.shape == pytest.approx(np.eye(n + 5), abs=1e-10)


def test_what_is_no_chain_is_not_taken_for_one():
    """A fork, a circuit, a spring to ground, two pieces."""
    fork = [[1, -1, 0, 0], [0, 1, -1, 0], [0, 1, 0, -1]]
    circuit = [[1, -1, 0, 0], [0, 1, -1, 0], [1, 0, -1, 0]]
    ground = [[1, 0, 0, 0], [0, 1, -1, 0], [0, 0, 1, -1]]
    pieces = [[1, -1, 0, 0, 0], [0, 0, 1, -1, 0], [0, 0, 0, 1, -1], [0, 0, 1, 0, -1]]
    for D in (fork, circuit, ground, pieces):
        assert singular_values._chain_order(np.array(D, dtype=float)) is None
    line = np.array([[0, 1, -1, 0], [1, 0, 0, -1], [0, 0, 1, -1]], dtype=float)
    rows, columns = singular_values._chain_order(line)
    assert rows.tolist() in ([0, 2, 1], [1, 2, 0])
    assert columns.tolist() in ([1, 2, 3, 0], [0, 3, 2, 1])
