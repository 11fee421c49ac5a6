"""Percentiles, shares and drivers against printed tables and closed forms."""

from __future__ import annotations

import math

import numpy as np
import pytest

from engine.numerics.sample_statistics import (
    convergence,
    percentile_interval,
    rank_regression,
    share_interval,
)


def test_the_interval_of_a_median_is_that_of_the_tables() -> None:
    """n = 100: the 40th and the 61st value (Conover, Practical Nonparametric Statistics; NIST)."""
    median = percentile_interval(np.arange(1.0, 101.0), 0.5)
    assert (median.low, median.value, median.high) == (40.0, 50.0, 61.0)


def test_the_interval_covers_the_percentile_as_often_as_it_says() -> None:
    """Of an exponential distribution, whose P10 is −ln 0.9."""
    rng = np.random.default_rng(2)
    true = -math.log(0.9)
    hits = 0
    for _ in range(2000):
        p = percentile_interval(np.sort(rng.exponential(size=200)), 0.1)
        assert p.low is not None
        assert p.high is not None
        hits += p.low <= true <= p.high
    assert 0.94 <= hits / 2000 <= 0.985  # discrete: a little above 95 %


def test_few_samples_leave_the_interval_open() -> None:
    p = percentile_interval(np.arange(20.0), 0.1)
    assert p.low is None
    assert p.high is not None


def test_unlimited_values_keep_their_place() -> None:
    values = np.concatenate([np.arange(1.0, 61.0), np.full(40, math.inf)])
    assert percentile_interval(values, 0.5).value == 50.0
    p90 = percentile_interval(values, 0.9)
    assert math.isinf(p90.value)
    assert p90.low is not None
    assert math.isinf(p90.low)


def test_shares_have_the_interval_of_clopper_and_pearson() -> None:
    """No success in 20: 1 − 0.025^(1/20) (Clopper and Pearson 1934, exact)."""
    assert share_interval(0, 20) == (0.0, pytest.approx(1.0 - 0.025 ** (1.0 / 20.0), rel=1e-9))
    low, high = share_interval(5, 10)
    assert (low, high) == (pytest.approx(0.1871, abs=5e-5), pytest.approx(0.8129, abs=5e-5))


def test_the_drivers_of_a_monotone_sum_are_found() -> None:
    """exp of a sum of independent parts: ranks are blind to the exp, shares near the variances."""
    rng = np.random.default_rng(4)
    x = rng.normal(size=(4000, 4))
    found = rank_regression(x, np.exp(3.0 * x[:, 0] - 2.0 * x[:, 1] + 1.0 * x[:, 2]))
    assert found is not None
    assert found.share == pytest.approx([9 / 14, 4 / 14, 1 / 14, 0.0], abs=0.03)
    assert float(found.share.sum()) == pytest.approx(found.explained, rel=1e-12)
    assert found.explained > 0.93  # ranks of normal numbers are not quite linear
    assert found.partial[0] > 0.9
    assert found.partial[1] < -0.9
    assert abs(found.partial[3]) < 0.05


def test_partial_correlation_is_that_of_the_residuals() -> None:
    """Its definition: correlate what is left of both after regression on all others."""
    from scipy.stats import rankdata

    rng = np.random.default_rng(5)
    x = rng.normal(size=(300, 3))
    y = x[:, 0] ** 3 + x[:, 1] + rng.normal(size=300)
    found = rank_regression(x, y)
    assert found is not None
    ranks = np.column_stack([rankdata(x, axis=0), rankdata(y)])
    others = np.column_stack([np.ones(300), ranks[:, 1:3]])
    rest = [
        v - others @ np.linalg.lstsq(others, v, rcond=None)[0] for v in (ranks[:, 0], ranks[:, 3])
    ]
    assert found.partial[0] == pytest.approx(float(np.corrcoef(*rest)[0, 1]), abs=1e-9)


def test_nothing_is_regressed_where_nothing_varies() -> None:
    x = np.random.default_rng(1).normal(size=(50, 2))
    assert rank_regression(x, np.full(50, math.inf)) is None
    assert rank_regression(np.ones((50, 2)), x[:, 0]) is None
    assert rank_regression(x[:8], x[:8, 0]) is None
    half = rank_regression(np.column_stack([x[:, 0], np.ones(50)]), x[:, 0])
    assert half is not None
    assert half.share == pytest.approx([1.0, 0.0])


def test_convergence_is_said_with_its_numbers() -> None:
    rng = np.random.default_rng(3)
    wide = np.exp(rng.normal(size=200))
    told = convergence(wide, "allowable starts")
    assert not told.reached
    assert "four times" in told.sentence
    assert convergence(1.0 + 0.01 * wide, "answer").reached
    drifting = np.concatenate([np.linspace(1.0, 1.01, 500), np.linspace(1.05, 1.06, 500)])
    assert "do not overlap" in convergence(drifting, "answer").sentence
    assert not convergence(drifting, "answer").reached
    assert convergence(np.full(40, math.inf), "allowable starts").reached


def test_unlimited_starts_settle_only_where_the_interval_is_bounded() -> None:
    """0.9³⁵ > 2.5 % > 0.9³⁶: of 35 unlimited samples every tenth might still be limited."""
    assert not convergence(np.full(35, math.inf), "allowable starts").reached
    assert convergence(np.full(36, math.inf), "allowable starts").reached
    mostly = np.full(1000, math.inf)
    mostly[::50] = 400.0  # 2 %: P10 unlimited from end to end
    assert convergence(mostly, "allowable starts").reached
    mostly[::11] = 400.0  # 10.7 %: it may be either
    assert not convergence(mostly, "allowable starts").reached


def test_the_percentile_that_is_asked_for_decides() -> None:
    rng = np.random.default_rng(3)
    tail = 1.0 + np.where(rng.uniform(size=400) > 0.8, 50.0 * rng.uniform(size=400), 0.0)
    assert convergence(tail, "peak stress").reached
    told = convergence(tail, "peak stress", 0.9)
    assert not told.reached
    assert "P90 of the peak stress" in told.sentence
