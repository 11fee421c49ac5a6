"""Own functions and factorisations: within one unit in the last place, and as accurate as LAPACK or better."""

from __future__ import annotations

import math

import mpmath
import numpy as np
import pytest

from engine.numerics import same_bits as own


def units_off(found: np.ndarray, exact: list) -> float:
    """Largest error, in units in the last place of the true value."""
    return max(
        abs(float((mpmath.mpf(float(y)) - e) / float(np.spacing(abs(float(e))))))
        for y, e in zip(found, exact, strict=True)
    )


@pytest.fixture(autouse=True)
def digits():
    with mpmath.workdps(50):
        yield


@pytest.fixture
def rng() -> np.random.Generator:
    return np.random.default_rng(1603)


def exactly(function, *places: np.ndarray) -> list:
    return [
        function(*map(mpmath.mpf, at)) for at in zip(*(p.tolist() for p in places), strict=True)
    ]


def test_logarithm(rng):
    x = np.concatenate(
        [
            10.0 ** rng.uniform(-300.0, 300.0, 400),
            1.0 + rng.normal(size=400) * 10.0 ** rng.uniform(-15.0, -1.0, 400),
        ]
    )
    assert units_off(own.log(x), exactly(mpmath.log, x)) < 0.51


def test_power(rng):
    x, y = 10.0 ** rng.uniform(-9.0, 9.0, 800), rng.uniform(-30.0, 30.0, 800)
    near = 1.0 + rng.normal(size=400) * 1e-4, rng.uniform(-1e6, 1e6, 400)
    x, y = np.concatenate([x, near[0]]), np.concatenate([y, near[1]])
    assert units_off(own.power(x, y), exactly(mpmath.power, x, y)) < 1.0


def test_arctangent_and_hypotenuse(rng):
    x, y = rng.normal(size=(2, 800)) * 10.0 ** rng.uniform(-8.0, 8.0, (2, 800))
    assert units_off(own.atan2(y, x), exactly(mpmath.atan2, y, x)) < 0.51
    assert units_off(own.hypot(x, y), exactly(mpmath.hypot, x, y)) < 0.51


@pytest.mark.parametrize("y", [0.0, -0.0, 1.0, -3.0, 1e-310, 1e300, math.inf, -math.inf])
@pytest.mark.parametrize("x", [0.0, -0.0, 1.0, -3.0, 1e-310, 1e300, math.inf, -math.inf])
def test_special_values_of_two(x: float, y: float):
    angle = own.atan2(y, x)
    assert angle == pytest.approx(math.atan2(y, x), rel=3e-16)
    assert math.copysign(1.0, angle) == math.copysign(1.0, math.atan2(y, x))
    assert own.hypot(x, y) == math.hypot(x, y)


@pytest.mark.parametrize(
    ("x", "y", "found"),
    [
        (0.0, 2.0, 0.0), (0.0, -1.0, math.inf), (0.0, 0.0, 1.0), (1.0, math.inf, 1.0), (2.0, 1e4, math.inf),
        (2.0, -1e4, 0.0), (math.inf, -2.0, 0.0), (math.inf, 0.5, math.inf), (2.0, 10.0, 1024.0), (10.0, 3.0, 1000.0),
    ],
)  # fmt: skip
def test_special_values_of_a_power(x: float, y: float, found: float):
    assert own.power(x, y) == found


def test_special_values_of_one():
    x = np.array([0.0, 1.0, math.inf, -1.0, math.nan])
    np.testing.assert_equal(own.log(x), [-math.inf, 0.0, math.inf, math.nan, math.nan])
    np.testing.assert_equal(own.exp(-x), [1.0, math.exp(-1.0), 0.0, math.e, math.nan])
    assert math.isnan(own.sin(math.inf))
    assert own.exp(0.0) == 1.0


def test_numbers_and_arrays(rng):
    x = rng.uniform(0.1, 2.0, (3, 4))
    assert own.power(x, 2.5).shape == (3, 4)
    assert own.power(x, x[0]).tolist() == [
        [own.power(a, b) for a, b in zip(row, x[0].tolist(), strict=True)] for row in x.tolist()
    ]
    assert isinstance(own.sin(0.5), float)
    assert isinstance(own.sin(np.float64(0.5)), float)
    assert own.cos(np.empty(0)).shape == (0,)


def test_straight_lines_between_points(rng):
    points, values = np.sort(rng.uniform(1.0, 9.0, 20)), rng.normal(size=20)
    x = np.concatenate([rng.uniform(0.0, 10.0, 300), points, [np.nan]])
    np.testing.assert_allclose(own.interp(x, points, values), np.interp(x, points, values), 1e-15)
    assert own.interp(points[3], points, values) == values[3]
    assert own.interp(99.0, points, values) == values[-1]


@pytest.mark.parametrize("shape", [(1, 1, 1), (5, 3, 70), (70, 90, 65), (4, 200, 0)])
def test_products_are_summed_in_the_order_of_the_index(rng, shape):
    m, n, k = shape
    a, b = rng.normal(size=(m, k)), rng.normal(size=(k, n))
    expected = np.zeros((m, n))
    for i in range(k):  # elementwise sums and products are the same everywhere
        expected += a[:, i, None] * b[i]
    assert np.array_equal(own.product(a, b), expected)
    assert np.array_equal(own.product(np.asfortranarray(a), b[:, ::-1]), expected[:, ::-1])
    assert np.array_equal(own.product(b.T, a.T), expected.T)
    given = np.full((m, n), np.nan)
    assert own.product(a, b, given) is given
    assert np.array_equal(given, expected)
    if k:
        assert np.array_equal(own.product(a[0], b), expected[0])
        assert np.array_equal(own.product(a, b[:, 0]), expected[:, 0])
        assert own.product(a[0], b[:, 0]) == expected[0, 0]


def test_a_product_needs_an_array_of_its_shape(rng):
    a, b = rng.normal(size=(3, 4)), rng.normal(size=(4, 5))
    with pytest.raises(own.InternalError, match=r"shape \(3, 5\) into an array of shape \(5, 3\)"):
        own.product(a, b, np.empty((5, 3)))


def test_products_of_complex_numbers(rng):
    a, b = rng.normal(size=(2, 6, 7, 2)).view(complex)[..., 0]
    np.testing.assert_allclose(own.product(a, b.T), a @ b.T, rtol=1e-13)
    np.testing.assert_allclose(own.product(a.real, b.T), a.real @ b.T, rtol=1e-13)
    np.testing.assert_allclose(own.times(a, b), a * b, rtol=1e-14)
    np.testing.assert_allclose(own.inverse(a), 1.0 / a, rtol=1e-14)
    np.testing.assert_allclose(own.modulus(a), np.abs(a), rtol=1e-15)
    cube = b.reshape(7, 3, 2)
    np.testing.assert_allclose(own.along_first(a, cube), np.tensordot(a, cube, 1), rtol=1e-12)


@pytest.mark.parametrize("n", [1, 2, 7, 40])
def test_linear_equations(rng, n):
    a, b = rng.normal(size=(n, n)), rng.normal(size=(n, 3))
    np.testing.assert_allclose(own.solve(a, b), np.linalg.solve(a, b), rtol=1e-9, atol=1e-12)
    a = a + 1j * rng.normal(size=(2, n, n))
    systems = own.ComplexSystems(a)
    for right in (np.stack([b, 2.0 * b]), np.stack([1j * b, b])[:, :, :1]):
        solution = np.linalg.solve(a, right)
        np.testing.assert_allclose(systems.solve(right), solution, rtol=1e-9, atol=1e-12)


def test_equations_without_a_solution_are_an_error():
    with pytest.raises(own.InternalError, match="a pivot is zero"):
        own.solve(np.ones((2, 2)), np.ones((2, 1)))
    with pytest.raises(own.InternalError, match="a pivot is zero"):
        own.ComplexSystems(np.ones((1, 2, 2), dtype=complex))


def exact_values(a: np.ndarray) -> np.ndarray:
    """Singular values in 80 digits, falling."""
    with mpmath.workdps(80):
        values = mpmath.svd_r(mpmath.matrix(a.tolist()), compute_uv=False)
        return np.array(sorted((float(v) for v in values), reverse=True))


@pytest.mark.parametrize("decades", [0, 4, 10])
@pytest.mark.parametrize("seed", range(4))
def test_singular_values_of_scaled_matrices(seed: int, decades: int):
    """Rows and columns scaled by many powers of ten: each value to its own rounding, LAPACK to the largest's."""
    rng = np.random.default_rng([seed, decades])
    a = np.zeros((9, 10))
    i = np.arange(9)
    a[i, i], a[i, i + 1] = 1.0, -1.0
    a *= 10.0 ** rng.uniform(-decades / 2, decades / 2, (9, 1))
    a *= 10.0 ** rng.uniform(-decades / 2, decades / 2, 10)
    exact = exact_values(a)
    u, sigma, v = own.svd(a)
    error = np.max(np.abs(sigma / exact - 1.0))
    lapack = np.max(np.abs(np.linalg.svd(a, compute_uv=False) / exact - 1.0))
    assert error < 3e-15 or error < lapack
    assert error < 1e-11
    np.testing.assert_allclose(u.T @ u, np.eye(9), atol=1e-14)
    np.testing.assert_allclose(v.T @ v, np.eye(9), atol=1e-14)
    np.testing.assert_allclose((u * sigma) @ v.T, a, atol=1e-14 * sigma[0])


def test_singular_values_of_equal_size_and_zero(rng):
    q = np.linalg.qr(rng.normal(size=(12, 12)))[0]
    wanted = np.array([3.0] * 4 + [2.0] * 4 + [0.0] * 4)
    u, sigma, _ = own.svd((q * wanted) @ q.T)
    np.testing.assert_allclose(sigma, wanted, atol=1e-14)
    np.testing.assert_allclose(u.T @ u, np.eye(12), atol=1e-13)
    assert own.svd(np.zeros((3, 2)))[1].tolist() == [0.0, 0.0]
    assert own.svd(np.zeros((3, 0)))[1].shape == (0,)


def test_a_basis_that_holds_what_a_matrix_does_not_move(rng):
    a = rng.normal(size=(5, 3)) @ rng.normal(size=(3, 8))
    sigma, right = own.right_basis(a, 3)
    np.testing.assert_allclose(right.T @ right, np.eye(8), atol=1e-14)
    np.testing.assert_allclose(a @ right[:, 3:], 0.0, atol=1e-13)
    assert np.all(sigma[3:] == 0.0)


@pytest.mark.parametrize("n", [1, 2, 3, 10, 60])
def test_eigenvalues(rng, n):
    """Of a matrix whose eigenvalues are known: pairs and real ones, in a random basis."""
    wanted = [complex(-(i + 1.0), 10.0 * (i + 1)) for i in range(n // 2)]
    wanted += [w.conjugate() for w in wanted] + [-0.5] * (n % 2)
    a = np.zeros((n, n))
    for i in range(n // 2):
        a[2 * i : 2 * i + 2, 2 * i : 2 * i + 2] = [[-(i + 1.0), 10.0 * (i + 1)], [-10.0 * (i + 1), -(i + 1.0)]]  # fmt: skip
    if n % 2:
        a[-1, -1] = -0.5
    q = np.linalg.qr(rng.normal(size=(n, n)))[0]
    found = own.eigenvalues(q @ a @ q.T)
    apart = np.abs(found[:, None] - np.array(wanted))
    assert max(apart.min(axis=0).max(), apart.min(axis=1).max()) < 1e-12 * max(n, 1) * 10


def test_small_eigenvalues_beside_large_ones(rng):
    """A damper of 4e7/s beside a mode of 4 rad/s: each eigenvalue to its own rounding, whatever the order."""
    omega, rate = np.array([4.0, 300.0, 2e3]), np.diag([0.2, 3.0, 4e7])
    rate[0, 2] = rate[2, 0] = 5.0
    a = np.block([[np.zeros((3, 3)), np.diag(omega)], [-np.diag(omega), -rate]])
    exact = mpmath.eig(mpmath.matrix(a.tolist()), left=False, right=False)
    for order in (np.arange(6), rng.permutation(6)):
        found = own.eigenvalues(a[np.ix_(order, order)])
        for value in map(complex, exact):
            assert np.min(np.abs(found - value)) < 1e-13 * abs(value)


@pytest.mark.parametrize("n", [1, 3, 20])
def test_matrix_exponential(rng, n):
    a = rng.normal(size=(n, n)) * 3.0
    exact = np.array(mpmath.expm(mpmath.matrix(a.tolist())).tolist(), dtype=float)
    found = own.matrix_exponential(a)
    assert np.max(np.abs(found - exact)) < 1e-13 * np.max(np.abs(exact))


def test_matrix_exponentials_side_by_side(rng):
    """Small and large ones, which are halved differently often."""
    stack = rng.normal(size=(4, 3, 3)) * np.array([1e-3, 1.0, 10.0, 200.0])[:, None, None]
    stack -= 200.0 * np.eye(3) * np.array([0.0, 0.0, 0.0, 1.0])[:, None, None]
    for a, found in zip(stack, own.matrix_exponentials(stack), strict=True):
        exact = np.array(mpmath.expm(mpmath.matrix(a.tolist())).tolist(), dtype=float)
        assert np.max(np.abs(found - exact)) < 1e-12 * np.max(np.abs(exact))


def test_how_often_doubled():
    assert [own.doublings(x) for x in (0.1, 1.0, 1.1, 2.0, 4.0, 4.1)] == [0, 0, 1, 1, 2, 3]


def test_what_fades():
    assert own.fading_sum(np.array([1.0, 0.0, 2.0]), 0.5).tolist() == [1.0, 0.5, 2.25]
