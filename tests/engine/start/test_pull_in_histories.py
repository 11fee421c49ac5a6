"""Reading pull-in from histories made by formula, whose answers are known exactly."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.optimize import brentq

from engine.start.pull_in import (
    has_failed,
    has_settled,
    judge_pull_in,
    passages,
    swing_frequency_linear,
)

LINE = 120.0 * math.pi
FIELD_TIME, FIELD_SLIP = 1.0, 0.03
SWING, DECAY = 2.0 * math.pi * 1.7, 0.9


def pulled_in(turns: int, time: np.ndarray, swing: float = 1.2) -> tuple[np.ndarray, np.ndarray]:
    """Slipping steadily from δ = 0 at FIELD_TIME, then a swing dying out about turns·2π + 0.4.

    The angles meet where the swing begins, at its lower turning point; only the last passage, on
    the steady part, and the zero crossings of slip, every half period of the swing, matter.
    """
    start = FIELD_TIME + (2.0 * math.pi * turns + 0.4 - swing) / (FIELD_SLIP * LINE)
    since = np.maximum(time - start, 0.0)
    ringing = np.exp(-DECAY * since) * np.cos(SWING * since)
    angle = np.where(
        time < start,
        FIELD_SLIP * LINE * (time - FIELD_TIME),
        2.0 * math.pi * turns + 0.4 - swing * ringing,
    )
    rate = (
        swing
        * np.exp(-DECAY * since)
        * (DECAY * np.cos(SWING * since) + SWING * np.sin(SWING * since))
    )
    return angle, np.where(time < start, FIELD_SLIP, rate / LINE)


@pytest.mark.parametrize("turns", [1, 4])
def test_passages_swing_and_load_angle(turns: int) -> None:
    time = np.arange(0.0, 12.0, 1e-3)
    angle, slip = pulled_in(turns, time)
    found = judge_pull_in(time, angle, slip, FIELD_TIME, FIELD_SLIP)
    assert found.synchronised
    last = FIELD_TIME + (2.0 * turns - 1.0) * math.pi / (FIELD_SLIP * LINE)
    assert found.pull_in_time == pytest.approx(last, abs=1e-9)
    # from 0 to (2 n − 1) π there are n − 1 whole turns
    assert found.pole_slips == turns - 1
    # zero crossings of d/dt e^(−at) cos ωt lie half a period apart, whatever the damping
    assert found.swing_frequency == pytest.approx(1.7, rel=1e-6)
    assert found.load_angle == pytest.approx(0.4, abs=1e-3)
    assert (found.field_time, found.field_slip) == (FIELD_TIME, FIELD_SLIP)


@pytest.mark.parametrize("turns", [1, 4])
def test_it_is_in_step_from_where_slip_stays_below_a_tenth_of_a_per_cent(turns: int) -> None:
    """C14: the last time |dδ/dt| / ω is 0.001, by the formula of the swing; not the field's instant."""
    time = np.arange(0.0, 12.0, 1e-3)
    found = judge_pull_in(time, *pulled_in(turns, time), FIELD_TIME, FIELD_SLIP)
    fine = np.arange(FIELD_TIME + 0.5, 12.0, 1e-5)
    _, slip = pulled_in(turns, fine)
    last = fine[np.flatnonzero(np.abs(slip) >= 1e-3)[-1]]
    assert found.in_step_slip == 1e-3
    assert found.in_step_time == pytest.approx(last, abs=1e-4)
    assert found.in_step_time > FIELD_TIME + 1.0


def test_a_motor_that_still_swings_at_the_end_is_not_in_step_from_any_instant() -> None:
    time = np.arange(0.0, 3.0, 1e-3)
    found = judge_pull_in(time, *pulled_in(1, time), FIELD_TIME, FIELD_SLIP)
    assert found.synchronised
    assert found.in_step_time is None


def test_motor_that_never_passes_180_degrees_is_in_step_at_once() -> None:
    time = np.arange(0.0, 6.0, 1e-3)
    angle = -0.5 + 1.4 * np.exp(-time) * np.cos(SWING * time) + 2.0 * math.pi * 7
    slip = np.gradient(angle, time) / LINE
    found = judge_pull_in(time, angle, slip, FIELD_TIME, FIELD_SLIP)
    assert found.synchronised
    assert found.pull_in_time == FIELD_TIME
    assert found.pole_slips == 0
    assert found.load_angle == pytest.approx(-0.5, abs=0.02)
    assert found.swing_frequency == pytest.approx(1.7, rel=1e-4)


def test_rounding_noise_after_the_swing_is_no_swing() -> None:
    time = np.arange(0.0, 60.0, 1e-3)
    angle, slip = pulled_in(2, time)
    noise = 1e-9 * np.random.default_rng(0).standard_normal(len(time))
    found = judge_pull_in(time, angle, slip + noise, FIELD_TIME, FIELD_SLIP)
    assert found.swing_frequency == pytest.approx(1.7, rel=1e-4)
    assert found.load_angle == pytest.approx(0.4, abs=1e-3)


def test_steady_slipping_is_not_in_step() -> None:
    """13.2 turns: passages at 0.5, 1.5, … 12.5; the last one is 12 whole turns after the start."""
    rate = FIELD_SLIP * LINE
    time = np.linspace(0.0, FIELD_TIME + 13.2 * 2.0 * math.pi / rate, 20_001)
    angle = rate * (time - FIELD_TIME)
    slip = np.full(len(time), FIELD_SLIP)
    found = judge_pull_in(time, angle, slip, FIELD_TIME, FIELD_SLIP)
    assert not found.synchronised
    assert found.pole_slips == 12
    assert found.pull_in_time is None
    assert found.load_angle is None
    assert found.swing_frequency is None
    np.testing.assert_allclose(
        passages(time, angle)[-13:], FIELD_TIME + (np.arange(13) + 0.5) * 2.0 * math.pi / rate
    )


def test_a_motor_that_creeps_into_step_without_swinging() -> None:
    time = np.arange(0.0, 30.0, 1e-3)
    angle = 2.0 * math.pi + 0.6 - 6.0 * np.exp(-np.maximum(time - FIELD_TIME, 0.0))
    slip = np.where(time > FIELD_TIME, 6.0 * np.exp(-(time - FIELD_TIME)) / LINE, 6.0 / LINE)
    found = judge_pull_in(time, angle, slip, FIELD_TIME, 6.0 / LINE)
    assert found.synchronised
    # 2π + 0.6 − 6 e^(−s) = π
    last = FIELD_TIME + math.log(6.0 / (math.pi + 0.6))
    assert found.pull_in_time == pytest.approx(last, abs=1e-6)
    assert found.load_angle == pytest.approx(0.6, abs=1e-6)
    assert found.swing_frequency is None
    early = time < last + 1.0
    assert not judge_pull_in(
        time[early], angle[early], slip[early], FIELD_TIME, 6.0 / LINE
    ).synchronised


def test_passages_both_ways_and_several_between_two_samples() -> None:
    time = np.array([0.0, 1.0, 2.0, 3.0])
    angle = np.array([0.0, 4.0, 0.0, 4.0 * math.pi])
    np.testing.assert_allclose(
        passages(time, angle), [math.pi / 4.0, 2.0 - math.pi / 4.0, 2.25, 2.75]
    )


def test_settled_two_swings_after_the_amplitude_allows_it() -> None:
    """Amplitude 1.2 e^(−at) about a mean: within 0.01 over two periods from a known time on."""
    period = 2.0 * math.pi / SWING
    time = np.arange(0.0, 12.0, 1e-3)
    angle = 0.4 + 1.2 * np.exp(-DECAY * time) * np.cos(SWING * time)
    # peak to peak of the window that begins at a maximum: 1.2 e^(−at) (1 + e^(−aT/2))
    ratio = 1.2 * (1.0 + math.exp(-0.5 * DECAY * period)) / 0.02
    expected = math.log(ratio) / DECAY + 2.0 * period
    ends = np.arange(1.0, 12.0, 0.01)
    settled = [has_settled(time[time < e], angle[time < e], 0.0, period) for e in ends]
    first = ends[settled.index(True)]
    assert first == pytest.approx(expected, abs=0.5 * period)
    assert all(settled[settled.index(True) :])
    assert not has_settled(time[:100], 0.0 * time[:100], 0.0, period)  # too early to say
    assert not has_settled(time, FIELD_SLIP * LINE * time, 0.0, period)


def test_failed_only_when_cycles_are_alike_and_far_from_synchronism() -> None:
    time = np.arange(0.0, 6.0, 1e-3)
    rate = FIELD_SLIP * LINE
    steady = rate * time + 0.4 * np.sin(rate * time)
    assert has_failed(time, steady, np.gradient(steady, time) / LINE, 0.0)
    # still speeding up: each cycle lasts longer than the one before
    slowing = rate * (time - 0.05 * time**2)
    assert not has_failed(time, slowing, np.gradient(slowing, time) / LINE, 0.0)
    # comes near zero slip in each cycle: may fall into step in the next
    close = rate * time + 0.98 * np.sin(rate * time)
    assert not has_failed(time, close, np.gradient(close, time) / LINE, 0.0)
    # too few cycles since the field came
    few = 6.0 - 3.0 * 2.0 * math.pi / rate
    assert not has_failed(time, steady, np.gradient(steady, time) / LINE, few)
    angle, slip = pulled_in(9, time)
    assert not has_failed(time, angle, slip, FIELD_TIME, cycles=20)


def test_linear_swing_frequency() -> None:
    pull_out, load, inertia, pairs = 22e3, 9e3, 400.0, 2.0
    delta = math.asin(load / pull_out)
    expected = math.sqrt(pairs * pull_out * math.cos(delta) / inertia) / (2.0 * math.pi)
    assert swing_frequency_linear(pull_out, load, inertia, pairs) == pytest.approx(expected)
    salient = 4e3
    delta = brentq(lambda d: pull_out * math.sin(d) + salient * math.sin(2 * d) - load, 0.0, 1.0)
    slope = pull_out * math.cos(delta) + 2.0 * salient * math.cos(2.0 * delta)
    expected = math.sqrt(pairs * slope / inertia) / (2.0 * math.pi)
    found = swing_frequency_linear(pull_out, load, inertia, pairs, salient)
    assert found == pytest.approx(expected)
    assert swing_frequency_linear(pull_out, 1.01 * pull_out, inertia, pairs) is None


def test_a_motor_that_stands_still_against_the_field_is_in_step_whatever_the_train_sways() -> None:
    """A little mean speed of gears on soft bearings is not slip; a motor that creeps is slipping."""
    time = np.arange(0.0, 6.0, 1e-3)
    pulled = FIELD_TIME + 0.05
    angle = np.where(time < pulled, FIELD_SLIP * LINE * (time - FIELD_TIME), 0.4)
    angle = np.where(time < FIELD_TIME, 0.0, np.minimum(angle, 0.4))
    swaying = np.where(time < pulled, FIELD_SLIP, 0.05 * FIELD_SLIP)
    found = judge_pull_in(time, angle, swaying, FIELD_TIME, FIELD_SLIP)
    assert found.synchronised
    assert found.load_angle == pytest.approx(0.4, abs=1e-9)
    creeping = angle + np.where(time > pulled, 0.05 * FIELD_SLIP * LINE * (time - pulled), 0.0)
    assert not judge_pull_in(time, creeping, swaying, FIELD_TIME, FIELD_SLIP).synchronised
