"""Every stepper: coefficients in 50 digits, limits, order of convergence, the paper's equations."""

from __future__ import annotations

import itertools

import mpmath
import numpy as np
import pytest
from scipy.linalg import expm

from engine.stepping.exponential import exponential_step, polynomial_step
from engine.stepping.linear_loop import turning_points
from engine.stepping.newmark import newmark_step

#: name, coefficients, order of convergence
STEPPERS = [("exponential", exponential_step, 4), ("newmark", newmark_step, 2)]
each_stepper = pytest.mark.parametrize(
    ("step", "order"), [s[1:] for s in STEPPERS], ids=[s[0] for s in STEPPERS]
)

MP = mpmath.mp.clone()
MP.dps = 50


# --- coefficients of the exponential step ---------------------------------------------------------


def exact_step(L: float, D: float) -> tuple[list[list[mpmath.mpf]], list[list[mpmath.mpf]]]:
    """Free and forced coefficients of x'' + D x' + L x = s^j over s from 0 to 1, in 50 digits.

    By divided differences of exp over the two exponents and j + 1 zeros; where the exponents
    coincide they are split by 1e-20, which changes the 40th digit.
    """
    L, D = MP.mpf(L), MP.mpf(D)
    root = MP.sqrt(MP.mpc(D * D / 4 - L))
    if abs(root) < MP.mpf(10) ** -20:
        root = MP.mpc(MP.mpf(10) ** -20)
    first, second = -D / 2 + root, -D / 2 - root

    def phi(k: int, z: mpmath.mpc) -> mpmath.mpc:
        with MP.workdps(100):
            if abs(z) < 1:
                return MP.fsum(z**n / MP.factorial(n + k) for n in range(70))
            value = MP.exp(z)
            for i in range(k):
                value = (value - 1 / MP.factorial(i)) / z
            return value

    x = [MP.re((phi(j + 1, first) - phi(j + 1, second)) / (first - second)) for j in range(-1, 4)]
    impulse_rate = MP.re((first * MP.exp(first) - second * MP.exp(second)) / (first - second))
    free = [[impulse_rate + D * x[0], x[0]], [-L * x[0], impulse_rate]]
    f = [1, 1, 2, 6]
    return free, [[x[j + 1] * f[j] for j in range(4)], [x[j] * f[j] for j in range(4)]]


STIFFNESS = [0.0, 1e-12, 1e-8, 1e-4, 0.1, 0.5, 1.0, 3.9, 4.1, 10.0, 100.0, 1e4, 1e6, 1e9, 1e12]
#: ζ, or "d = …" for rates that do not depend on the stiffness.
DAMPING = [
    0.0, 1e-6, 0.015, 0.3, 0.99, 1.0 - 1e-9, 1.0, 1.0 + 1e-9, 1.01, 1.5, 10.0, 1e4,
    "1e-9", "0.1", "1.9", "2.1", "30", "1e6",
]  # fmt: skip


@pytest.mark.first_ones(1)
@pytest.mark.parametrize("L", STIFFNESS)
def test_coefficients_of_the_exponential_step_in_50_digits(L: float) -> None:
    """Relative error ≤ 2e-14 (1 + ωh): beyond, the phase ωh itself carries no more digits."""
    bound = 2e-14 * (1.0 + np.sqrt(L))
    for damping in DAMPING:
        D = float(damping) if isinstance(damping, str) else 2.0 * damping * float(np.sqrt(L))
        free, forced = polynomial_step(np.array([L]), np.array([D]), 1.0)
        true_free, true_forced = exact_step(L, D)
        scale = np.array([[1.0, 1.0], [max(np.sqrt(L), 1.0), 1.0]])
        off = np.abs(free[0] - np.array(true_free, dtype=float)) / scale
        assert np.max(off) <= bound, (L, D, off)
        want = np.array(true_forced, dtype=float)
        # every coefficient against its own size, those that an overdamped or fast mode makes tiny too
        off = np.abs(forced[0] - want)
        floor = np.array([[0.0] * 4, [1.0 / max(np.sqrt(L), 1.0), 0.0, 0.0, 0.0]])
        assert np.all(off <= bound * np.maximum(np.abs(want), floor)), (L, D, off / np.abs(want))


@pytest.mark.parametrize("h", [1e-6, 1e-3, 0.1, 10.0])
def test_step_length_only_scales(h: float) -> None:
    λ, d = np.array([0.0, 5.0, 4e4]), np.array([0.3, 0.2, 9.0])
    free, forced = polynomial_step(λ, d, h)
    unit_free, unit_forced = polynomial_step(λ * h * h, d * h, 1.0)
    np.testing.assert_allclose(free[:, 0, 1], h * unit_free[:, 0, 1], rtol=1e-13)
    np.testing.assert_allclose(free[:, 1, 0], unit_free[:, 1, 0] / h, rtol=1e-13, atol=1e-300)
    np.testing.assert_allclose(forced[:, 0], h * h * unit_forced[:, 0], rtol=1e-13)
    np.testing.assert_allclose(forced[:, 1], h * unit_forced[:, 1], rtol=1e-13)


def test_limits() -> None:
    """A free mass: q₁ = q₀ + v h + u h²/2. A very stiff mode: the static deflection u/λ."""
    h = 0.25
    free, forced = polynomial_step(np.array([0.0]), np.array([0.0]), h)
    np.testing.assert_allclose(free[0], [[1.0, h], [0.0, 1.0]], rtol=1e-15)
    np.testing.assert_allclose(forced[0, 0], h * h / np.array([2.0, 6.0, 12.0, 20.0]), rtol=1e-14)
    np.testing.assert_allclose(forced[0, 1], h / np.array([1.0, 2.0, 3.0, 4.0]), rtol=1e-14)
    λ = 1e12
    free, forced = polynomial_step(np.array([λ]), np.array([2e6 * 0.01]), h)
    assert np.max(np.abs(free[0, 0])) < 1e-300  # the ringing has faded
    np.testing.assert_allclose(forced[0, 0] * λ, 1.0, rtol=1e-5)
    # a damper of 1e9 1/s on a free mass: speed u/d
    _, forced = polynomial_step(np.array([0.0]), np.array([1e9]), h)
    assert forced[0, 1, 0] == pytest.approx(1e-9, rel=1e-12)


# --- order of convergence ---------------------------------------------------------------------------


def travelled(step, λ: np.ndarray, d: np.ndarray, end: float, n: int) -> np.ndarray:
    """State after n equal steps under u = sin(3 t) + 0.5, from q = 0.1, q̇ = −0.2."""
    h = end / n
    free, forced = step(λ, d, h)
    x = np.tile([0.1, -0.2], (len(λ), 1))
    for k in range(n):
        t0, t1 = k * h, (k + 1) * h
        u = [np.sin(3 * t0) + 0.5, 3 * np.cos(3 * t0), np.sin(3 * t1) + 0.5, 3 * np.cos(3 * t1)]
        x = np.einsum("nij,nj->ni", free, x) + forced @ np.array(u)
    return x


def exact_travel(λ: float, d: float, end: float) -> np.ndarray:
    """The same by one matrix exponential: force and its oscillator are states."""
    A = np.zeros((5, 5))
    A[0, 1], A[1, 0], A[1, 1], A[1, 2], A[1, 4] = 1.0, -λ, -d, 1.0, 0.5
    A[2, 3], A[3, 2] = 3.0, -3.0  # sin 3t, cos 3t
    return (expm(A * end) @ np.array([0.1, -0.2, 0.0, 1.0, 1.0]))[:2]


@each_stepper
def test_order_of_convergence_against_the_matrix_exponential(step, order: int) -> None:
    λ = np.array([0.0, 1.0, 25.0, 9.0, 4.0])
    d = np.array([0.0, 0.1, 0.3, 0.0, 7.0])
    true = np.array([exact_travel(a, b, 3.0) for a, b in zip(λ, d, strict=True)])
    errors = [np.abs(travelled(step, λ, d, 3.0, n) - true).max(axis=1) for n in (40, 80, 160)]
    for coarse, fine in itertools.pairwise(errors):
        rate = np.log2(coarse / fine)
        assert np.all(rate > order - 0.2), rate
    assert np.all(errors[-1] < (1e-6 if order == 4 else 3e-2))


def test_exponential_step_has_no_error_in_the_structure() -> None:
    """Free motion of a fast mode, one step of 100 periods: only rounding."""
    λ, d = np.array([(2 * np.pi * 1000.0) ** 2]), np.array([20.0])
    free, _ = exponential_step(λ, d, 0.1003)
    true = expm(np.array([[0.0, 1.0], [-λ[0], -d[0]]]) * 0.1003)
    np.testing.assert_allclose(free[0], true, rtol=1e-9, atol=1e-9 * np.abs(true).max())


@each_stepper
def test_steps_are_stable_and_keep_the_energy_of_an_undamped_mode(step, order: int) -> None:
    for Lh in (1e-3, 1.0, 1e4, 1e9):
        λ = np.array([Lh])
        free, _ = step(λ, np.array([0.0]), 1.0)
        root = np.sqrt(Lh)
        turn = np.array(
            [[free[0, 0, 0], free[0, 0, 1] * root], [free[0, 1, 0] / root, free[0, 1, 1]]]
        )
        np.testing.assert_allclose(turn @ turn.T, np.eye(2), atol=1e-12)
        damped, _ = step(λ, np.array([0.02 * root]), 1.0)
        assert np.max(np.abs(np.linalg.eigvals(damped[0]))) < 1.0


# --- the paper's equations --------------------------------------------------------------------------


def test_newmark_is_the_papers_equations_1_to_4() -> None:
    """Equations (1) to (4), written with [J], [C], [K] for the angles of a four-mass train."""
    rng = np.random.default_rng(4)
    J = np.diag([3.0, 0.5, 2.0, 4.0])
    k = np.array([2e3, 5e4, 3e3])
    B = np.array([[1.0, -1, 0, 0], [0, 1, -0.4, 0], [0, 0, 1, -1]])  # one gear
    K = B.T @ np.diag(k) @ B
    h, n = 2e-3, 400
    torque = rng.normal(size=(n + 1, 4)) * 50.0

    # modes, and a C that is diagonal in them
    root = np.sqrt(np.diag(J))
    square, V = np.linalg.eigh(K / np.outer(root, root))
    shape = V / root[:, None]
    rate = np.array([0.1, 2.0, 3.0, 5.0])
    C = (J @ shape) @ np.diag(rate) @ (J @ shape).T

    theta, speed = np.zeros(4), np.array([1.0, 0.0, -0.5, 0.2])
    physical = []
    acceleration = np.linalg.solve(J, torque[0] - C @ speed - K @ theta)  # eq. (1)
    for i in range(n):
        known = theta + h * speed + h * h / 4.0 * acceleration  # eq. (2) without its last term
        drift = speed + h / 2.0 * acceleration  # eq. (3) without its last term
        after = np.linalg.solve(  # eq. (4), derived
            J + h / 2.0 * C + h * h / 4.0 * K, torque[i + 1] - C @ drift - K @ known
        )
        theta, speed, acceleration = known + h * h / 4.0 * after, drift + h / 2.0 * after, after
        physical.append(np.concatenate([theta, speed]))

    free, forced = newmark_step(np.maximum(square, 0.0), rate, h)
    x = np.stack([np.zeros(4), shape.T @ J @ np.array([1.0, 0.0, -0.5, 0.2])], axis=1)
    modal = []
    for i in range(n):
        u = np.zeros((4, 4))
        u[:, 0], u[:, 2] = shape.T @ torque[i], shape.T @ torque[i + 1]
        x = np.einsum("nij,nj->ni", free, x) + np.einsum("nij,nj->ni", forced, u)
        modal.append(np.concatenate([shape @ x[:, 0], shape @ x[:, 1]]))
    np.testing.assert_allclose(modal, physical, rtol=1e-8, atol=1e-9 * np.abs(physical).max())


@pytest.mark.parametrize("L", [0.0, 1e-12, 1.0, 1e6, 1e12])
@pytest.mark.parametrize("D", [0.0, 1e-6, 1.0, 1e6])
def test_coefficients_of_the_newmark_step_in_50_digits(L: float, D: float) -> None:
    free, forced = newmark_step(np.array([L]), np.array([D]), 1.0)
    λ, d = MP.mpf(L), MP.mpf(D)
    left = MP.matrix([[1, 0, -0.25], [0, 1, -0.5], [λ, d, 1]])
    for column in range(2):  # q₀ and q̇₀
        q0, v0 = (1, 0) if column == 0 else (0, 1)
        a0 = -d * v0 - λ * q0
        x = MP.lu_solve(left, MP.matrix([q0 + v0 + a0 / 4, v0 + a0 / 2, 0]))
        for row in range(2):
            assert abs(free[0, row, column] - x[row]) <= 1e-14 * max(abs(x[row]), 1)
    for column, (u0, u1) in enumerate([(1, 0), (0, 1)]):
        x = MP.lu_solve(left, MP.matrix([MP.mpf(u0) / 4, MP.mpf(u0) / 2, u1]))
        for row in range(2):
            assert abs(forced[0, row, 2 * column] - x[row]) <= 1e-13 * abs(x[row])


# --- turning points ---------------------------------------------------------------------------------


def test_turning_points_between_samples() -> None:
    """At 10 samples a cycle the dense output finds a peak that a sample may miss by 5 %."""
    t = np.arange(0.0, 2.0001, 0.1)
    phase = 0.3
    when, value = turning_points(
        t, np.sin(2 * np.pi * t + phase), 2 * np.pi * np.cos(2 * np.pi * t + phase)
    )
    exact = (0.25 - phase / (2 * np.pi)) + 0.5 * np.arange(4)
    np.testing.assert_allclose(when, exact, atol=1e-3)
    np.testing.assert_allclose(np.abs(value), 1.0, atol=1e-3)


@pytest.mark.parametrize(
    ("y", "slope", "expected"),
    [
        ([0.0, 1.0, 2.0], [1.0, 1.0, 1.0], []),  # straight
        ([1.0, 1.0, 1.0], [0.0, 0.0, 0.0], []),  # flat
        ([0.0, 1.0, 0.0], [2.0, 0.0, -2.0], [1.0]),  # parabola (no cubic term), top at a sample
        ([0.0, 0.0, 0.0], [1.0, -1.0, 1.0], [0.25, -0.25]),  # parabolas, tops between
        ([0.0, 1.0, 1.0], [0.0, 0.0, 0.0], [0.0, 1.0, 1.0]),  # rise to a plateau
    ],
)
def test_turning_points_of_degenerate_cubics(y, slope, expected) -> None:
    t = np.array([0.0, 1.0, 2.0])
    when, value = turning_points(t, np.array(y), np.array(slope))
    assert np.all(np.diff(when) >= 0.0)
    found = list(dict.fromkeys(zip(when.tolist(), value.tolist(), strict=True)))
    assert {round(v, 12) for _, v in found} == set(expected)


def test_a_turning_point_at_a_sample_is_never_lost() -> None:
    """Slopes of ±1e-17 beside a sample: rounding must not drop the peak between two intervals."""
    t = np.linspace(0.0, 4.0, 41)
    y = np.cos(2 * np.pi * t)
    slope = -2 * np.pi * np.sin(2 * np.pi * t)
    for nudge in (-1e-15, 0.0, 1e-15):
        _, value = turning_points(t, y, slope + nudge)
        assert np.sum(value > 0.999) >= 3
        assert np.sum(value < -0.999) >= 4
