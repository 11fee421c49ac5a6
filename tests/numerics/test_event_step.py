"""The event-driven step: coefficients, order, event instants, strong dampers.

`mode_step` is compared in 50 digits; runs against closed forms and the matrix exponential.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from engine.backlash.event_start import clearances_of
from engine.case.data import CaseData, ElementRow, MeshRow, StationRow
from engine.model.build_train import build_train
from engine.model.modes import modes_of
from engine.start.time_response import PrescribedTorque, linear
from engine.stepping.contact_loop import FREE, first_fall
from engine.stepping.exponential import HERMITE, exponential_step
from tests.clearance_reference import ClearanceReference
from tests.clearance_response import clearance_response
from tests.numerics.test_steppers import exact_step
from tests.strategies import example_count

# --- coefficients of one step ---------------------------------------------------------------------


def stepped(stiffness: float, rate: float, h: float) -> tuple[np.ndarray, np.ndarray]:
    free, forced = exponential_step(np.array([stiffness]), np.array([rate]), h)
    return free[0], forced[0]


L_VALUES = [0.0, *10.0 ** np.arange(-14.0, 13.0, 2.0), 0.5, 3.99, 4.01, 30.0]
DAMPING = [0.0, 1e-8, 0.01, 0.5, 1.0 - 1e-9, 1.0, 1.0 + 1e-9, 1.02, 3.0, 1e3, "1e-10", "0.3", "1.99", "2.01", "50", "1e8"]  # fmt: skip


@pytest.mark.first_ones(1)
@pytest.mark.parametrize("L", L_VALUES)
def test_mode_step_in_50_digits(L: float) -> None:
    """λh² over 26 decades, dh from 0 to 1e8: 2e-14 (1 + ωh), what the phase carries.

    The forces of a step are taken at its ends, with their rates; the coefficients of those are
    sums of the polynomial ones and may cancel, so they are compared with the largest of a row.
    """
    h, bound = 0.25, 3e-14 * (1.0 + math.sqrt(L))
    for damping in DAMPING:
        D = float(damping) if isinstance(damping, str) else 2.0 * damping * math.sqrt(L)
        free, forced = stepped(L / h**2, D / h, h)
        true_free, true_forced = exact_step(L, D)
        unit = free * np.array([[1.0, 1.0 / h], [h, 1.0]])
        scale = np.array([[1.0, 1.0], [max(math.sqrt(L), 1.0), 1.0]])
        assert np.max(np.abs(unit - np.array(true_free, dtype=float)) / scale) <= bound, (L, D)
        want = np.array(true_forced, dtype=float) @ HERMITE
        unit = forced / np.array([[h**2, h**3, h**2, h**3], [h, h**2, h, h**2]])
        size = np.max(np.abs(np.array(true_forced, dtype=float)), axis=1, keepdims=True)
        floor = np.array([[0.0], [1.0 / max(math.sqrt(L), 1.0)]])
        assert np.all(np.abs(unit - want) <= 8.0 * bound * np.maximum(size, floor)), (L, D)


@pytest.mark.parametrize("h", [1e-7, 1e-3, 2.0])
def test_mode_step_is_the_exponential_step(h: float) -> None:
    rng = np.random.default_rng(7)
    stiffness = np.concatenate([[0.0], 10.0 ** rng.uniform(-10.0, 10.0, 300)]) / h**2
    rate = 2.0 * np.sqrt(stiffness) * 10.0 ** rng.uniform(-4.0, 3.0, 301)
    rate[::7] = 0.0
    free, forced = exponential_step(stiffness, rate, h)
    for i in range(len(stiffness)):
        one_free, one_forced = stepped(stiffness[i], rate[i], h)
        root = max(math.sqrt(stiffness[i]), 1.0 / h)
        bound = 1e-13 * (1.0 + math.sqrt(stiffness[i]) * h)
        weight = np.array([[1.0, root], [1.0 / root, 1.0]])
        assert np.max(np.abs(one_free - free[i]) * weight) < bound
        size = np.max(np.abs(forced[i]) * np.array([1.0, 1.0 / h, 1.0, 1.0 / h]), axis=1)
        off = np.abs(one_forced - forced[i]) * np.array([1.0, 1.0 / h, 1.0, 1.0 / h])
        floor = np.array([0.0, h / max(math.sqrt(stiffness[i]) * h, 1.0)])
        assert np.all(off <= 10.0 * bound * np.maximum(size, floor)[:, None])


# --- where a cubic first falls through zero -------------------------------------------------------

coefficient = st.floats(-10.0, 10.0, allow_nan=False).map(lambda x: round(x, 6))


@example_count(400)
@given(st.tuples(coefficient, coefficient, coefficient, coefficient))
def test_first_fall_against_a_fine_scan(ends: tuple[float, float, float, float]) -> None:
    g0, d0, g1, d1 = ends
    found = first_fall(g0, d0, g1, d1)
    s = np.linspace(0.0, 1.0, 20_001)
    b, c = 3.0 * (g1 - g0) - 2.0 * d0 - d1, d0 + d1 - 2.0 * (g1 - g0)
    value = g0 + s * (d0 + s * (b + s * c))
    falls = np.flatnonzero((value[:-1] > 1e-9) & (value[1:] < -1e-9))
    if g0 <= 0.0 and (d0 < 0.0 or (d0 == 0.0 and g1 < 0.0)):
        assert found == 0.0
    elif len(falls):
        assert found <= s[falls[0] + 1]
        assert (
            found >= s[falls[0]] - 1e-12 or abs(g0 + found * (d0 + found * (b + found * c))) < 1e-6
        )
    if 0.0 < found <= 1.0:
        at = g0 + found * (d0 + found * (b + found * c))
        assert abs(at) < 1e-9
        assert d0 + found * (2.0 * b + 3.0 * found * c) <= 1e-6
        before = value[(s < found) & (s > 0.0)]
        first_positive = int(np.argmax(before > 1e-9)) if np.any(before > 1e-9) else len(before)
        assert np.all(before[first_positive:] > -1e-9)  # no earlier fall
    if not len(falls) and g0 > 0.0 and value.min() > 1e-9:
        assert found == 2.0


@pytest.mark.parametrize(
    ("ends", "where"),
    [
        ((1.0, -1.0, -1.0, -3.0), math.sqrt(1.25) - 0.5),  # 1 − s − s²
        ((1.0, 0.0, 0.0, -2.0), 1.0),  # reaches zero at the very end
        ((0.0, 1.0, 1.0, 1.0), 2.0),  # rises from zero
        ((0.0, 1.0, -1.0, -3.0), 0.5),  # s − 2 s²: leaves zero and comes back
        ((-1e-18, 1.0, -1.0, -3.0), 0.5),
        ((0.0, -1.0, 1.0, 2.0), 0.0),
        ((-1.0, 1.0, -0.5, 1.0), 2.0),  # below zero and rising is no fall
        ((1.0, 0.0, 1.0, 0.0), 2.0),
    ],
)
def test_first_fall_of_known_curves(ends: tuple[float, ...], where: float) -> None:
    assert first_fall(*ends) == pytest.approx(where, abs=1e-12)


# --- runs -----------------------------------------------------------------------------------------

STIFFNESS = 1e5
#: One turns at 1 rad/s against the other.
SPEED = np.array([0.8, -0.2])


def two_masses(damping: float | None, gap: float = 2e-3) -> CaseData:
    return CaseData(
        stations=(StationRow("a", None, 2.0), StationRow("b", None, 8.0)),
        elements=(ElementRow("gap", "coupling", "a", "b", STIFFNESS, damping=damping),),
        meshes=(MeshRow("gap", angular_backlash=gap),),
    )


def final_state(case: CaseData, step: float, law: str = "limited", end: float = 0.06, **given):
    train = build_train(case)
    times = np.array([0.0, end])
    return clearance_response(
        train, modes_of(train), clearances_of(train), times, step=step, contact_law=law, **given
    )


@pytest.mark.parametrize("law", ["limited", "no adhesion"])
def test_fourth_order_with_contact_damping(law: str) -> None:
    case, speed = two_masses(120.0), np.array([1.0, -0.25])
    truth = ClearanceReference(case, law).run(np.array([0.0, 0.06]), speed=speed).state[:, -1]
    rows = len(truth) - 2
    errors = []
    for step in (4e-4, 2e-4, 1e-4, 5e-5):
        found = final_state(case, step, law, initial_speed=speed)
        errors.append(float(np.max(np.abs(found.station_speed[:, -1] - truth[rows:]))))
    assert errors[0] < 1e-6
    assert errors[-1] < 1e-10
    for coarse, fine in zip(errors[:-1], errors[1:], strict=True):
        assert coarse / fine > 12.0


def test_instants_of_free_motion_do_not_depend_on_the_step() -> None:
    """Without contact damping every piece is exact, however coarse the cubic that finds events."""
    half = math.pi / math.sqrt(STIFFNESS / 1.6)
    for step in (1e-5, 1e-3, 7e-3):
        found = final_state(two_masses(None), step, initial_speed=SPEED)
        flight = 2e-3
        truth = np.cumsum([half, *[flight, half] * 4])
        np.testing.assert_allclose(found.log[:5, 0], truth[:5], rtol=0.0, atol=1e-13)


def test_what_follows_a_rising_torque_is_no_ringing() -> None:
    """1.6 x'' + k x = M with M' constant: x = M / k without ringing if it begins so, speed M' / k.

    At rest in x = M / k it rings, by M' / (k ω) or 4 N m.
    """
    rise, steps = 1000.0, []
    torques = tuple(
        linear(i, np.array([0.0, 1.0]), sign * np.array([100.0, 100.0 + rise]))
        for i, sign in ((0, 1.0), (1, -1.0))
    )
    for speed in (rise / STIFFNESS, 0.0):
        found = final_state(
            two_masses(None), 0.02, end=1.0, torques=torques, sampled=25.0, visible=1e-6,
            initial_angle=SPEED * 100.0 / STIFFNESS, initial_speed=SPEED * speed,
        )  # fmt: skip
        steps.append(found.run.trajectory.n_steps)
    assert 50 <= steps[0] <= 52
    assert steps[1] > 2 * steps[0]


@pytest.mark.parametrize("share", [0.02, 0.3, 1.0, 4.0, 100.0])
def test_parting_of_a_damped_flank(share: float) -> None:
    """x'' + d x' + ω² x = 0 from x = 0, x' = 1 with d = 2 ζ ω: the force is zero where x'' is.

    ζ < 1: tan ω_d t = c ω_d / (c d / 2 − k). ζ > 1: t = 2 ln(s₂/s₁) / (s₂ − s₁), s the rates of
    decay. ζ = 1: t = 2 / ω.
    """
    omega, mass = math.sqrt(STIFFNESS / 1.6), 1.6
    damping = 2.0 * share * omega * mass
    step = 2e-4 / max(share, 1.0)
    found = final_state(
        two_masses(damping, 10.0), step, "no adhesion", 0.05 / max(share, 1.0), initial_speed=SPEED
    )
    if share < 1.0:
        wd = omega * math.sqrt(1.0 - share**2)
        t = math.atan2(damping * wd, 0.5 * damping * damping / mass - STIFFNESS) / wd
    elif share > 1.0:
        fast = omega * (share + math.sqrt(share**2 - 1.0))
        slow = omega * omega / fast
        t = 2.0 * math.log(fast / slow) / (fast - slow)
    else:
        t = 2.0 / omega
    parted = found.log[found.log[:, 3] == FREE]
    assert parted[0, 0] == pytest.approx(t, rel=1e-5)
    assert len(parted) == 1


@pytest.mark.parametrize("share", [1e3, 1e5])
def test_flank_with_a_damper_far_above_critical_recovers(share: float) -> None:
    """Limited: it presses with 2 k x until it turns; then its damper holds it back.

    x'' = −2 ω² x until x' = 0: the deepest compression is v / (√2 ω), whatever the damper.
    """
    omega = math.sqrt(STIFFNESS / 1.6)
    damping = 2.0 * share * omega * 1.6
    found = final_state(two_masses(damping, 10.0), 2e-4, end=0.02, initial_speed=SPEED)
    parted = found.log[found.log[:, 3] == FREE]
    torque = found.run.trajectory.torque[0]
    quarter = math.pi / (2.0 * math.sqrt(2.0) * omega)
    assert parted[0, 0] == pytest.approx(quarter, rel=40.0 / share)
    assert torque.max() == pytest.approx(2.0 * STIFFNESS / (math.sqrt(2.0) * omega), rel=2e-3)
    assert np.all(torque >= -1e-12 * torque.max())
    total = 2.0 * found.station_speed[0, -1] + 8.0 * found.station_speed[1, -1]
    assert abs(total) < 1e-12


@pytest.mark.parametrize("step", [1e-4, 1e-3, 2e-2])
def test_a_flank_that_leaves_and_comes_back_within_a_step_touches_again(step: float) -> None:
    """Parted while compressed, it flies freely: its damper does not act before it touches.

    x = x₀ + v t + a t² / 2 from k x₀ + c v = 0, until x = 0 again.
    """
    damping, push = 120.0, 100.0
    steady = linear(0, np.array([0.0, 1.0]), np.array([push, push]))
    found = final_state(
        two_masses(damping, 1.0), step, end=0.06, initial_speed=SPEED, torques=(steady,)
    )
    parted = int(np.argmax(found.log[:, 3] == FREE))
    speed, acceleration = float(found.log[parted, 4]), push / 2.0
    left = -damping * speed / STIFFNESS
    flight = (-speed + math.sqrt(speed**2 - 2.0 * acceleration * left)) / acceleration
    assert found.log[parted + 1, 2] == FREE  # not still compressed
    assert found.log[parted + 1, 0] - found.log[parted, 0] == pytest.approx(flight, rel=1e-9)


def test_strong_dampers_converge_with_forces_that_change() -> None:
    """Far above critical, from a fast to a slow motion: stable at every step, and convergent."""
    case = two_masses(1e7, 1e-2)
    ramp = linear(0, np.array([0.0, 0.02, 0.04, 0.06]), np.array([0.0, 4000.0, -4000.0, 4000.0]))
    truth = final_state(case, 5e-7, torques=(ramp,)).station_speed[:, -1]
    errors = []
    for step in (1e-3, 6e-5, 4e-6):
        found = final_state(case, step, torques=(ramp,)).station_speed[:, -1]
        errors.append(float(np.max(np.abs(found - truth))))
    size = float(np.max(np.abs(truth)))
    assert errors[0] < 1e-2 * size
    assert errors[1] < 1e-3 * size
    assert errors[2] < 1e-6 * size


@pytest.mark.parametrize("offset", [0.0, 1e-9, 3.3e-4])
def test_a_jump_of_force_may_lie_anywhere_in_a_step(offset: float) -> None:
    """A table that falls within a picosecond; its corner is a step's end wherever it lies."""
    jump = 0.02 + offset
    torque = PrescribedTorque(
        0,
        np.array([0.0, jump, jump + 1e-12, 1.0]),
        lambda at, side: np.where(np.asarray(at) <= jump, 3000.0, -3000.0),
    )
    found = final_state(two_masses(None, 10.0), 1e-3, end=0.05, torques=(torque,))
    speed = 3000.0 * jump - 3000.0 * (0.05 - jump)
    total = 2.0 * found.station_speed[0, -1] + 8.0 * found.station_speed[1, -1]
    assert total == pytest.approx(speed, abs=1e-7)


def test_times_need_not_begin_at_zero() -> None:
    case = two_masses(120.0)
    train = build_train(case)
    modes, flanks = modes_of(train), clearances_of(train)
    found = [
        clearance_response(
            train, modes, flanks, np.linspace(t0, t0 + 0.05, 6), step=2e-4,
            torques=(linear(0, t0 + np.array([0.0, 0.03, 0.06]), np.array([0.0, 500.0, -500.0])),),
        )
        for t0 in (0.0, 4.0)
    ]  # fmt: skip
    np.testing.assert_allclose(
        found[0].station_speed, found[1].station_speed, rtol=1e-9, atol=1e-12
    )


def test_flank_at_infinity_is_never_met() -> None:
    case = two_masses(None)
    train = build_train(case)
    flank = replace(clearances_of(train)[0], gap=math.inf)
    found = clearance_response(
        train, modes_of(train), (flank,), np.array([0.0, 50.0]),
        initial_speed=np.array([-0.8, 0.2]),
    )  # fmt: skip
    assert len(found.log) == 0
    assert found.station_angle[0, -1] == pytest.approx(-40.0, rel=1e-11)
