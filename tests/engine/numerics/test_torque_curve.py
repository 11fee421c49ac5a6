"""The torque curve is scipy's PCHIP interpolator, which is not imported for it."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.interpolate import PchipInterpolator

from engine.numerics.torque_curve import torque_curve

widths = st.lists(st.floats(1e-6, 1.0), min_size=1, max_size=12)
torques = st.one_of(st.floats(-1e6, 1e6), st.sampled_from([0.0, 1000.0, -1000.0]))


@given(st.data(), widths)
def test_curve_is_that_of_scipy(data: st.DataObject, steps: list[float]) -> None:
    x = np.concatenate([[0.0], np.cumsum(steps)])
    y = np.array(data.draw(st.lists(torques, min_size=x.size, max_size=x.size)))
    curve, reference = torque_curve(x, y), PchipInterpolator(x, y)
    np.testing.assert_allclose(curve.cubic[:-1], reference.c[::-1].T, rtol=1e-14, atol=0.0)
    assert curve.cubic[-1].tolist() == [y[-1], 0.0, 0.0, 0.0]


@pytest.mark.parametrize(
    "y",
    [
        [1.0, 2.0],
        [3.0, 3.0, 3.0],
        [0.0, 5.0, 4.0, 4.0, 9.0],
        [0.0, 0.1, 5.0],
        [0.0, 1.0, -9.0, -9.5],
        [2.0, 1.0, 1.0, 0.0],
    ],
)
def test_ends_plateaus_and_extremes(y: list[float]) -> None:
    x = np.linspace(0.0, 1.0, len(y)) ** 1.5
    at = np.linspace(-0.5, 1.5, 301)
    inside = np.clip(at, 0.0, 1.0)
    np.testing.assert_allclose(
        torque_curve(x, np.array(y))(at), PchipInterpolator(x, y)(inside), rtol=1e-13, atol=1e-13
    )


def test_one_point_is_a_constant() -> None:
    assert torque_curve(np.array([0.5]), np.array([7.0]))([0.0, 0.5, 1.0]).tolist() == [7.0] * 3


@given(st.data(), widths)
def test_steepest_slope_is_that_of_scipy(data: st.DataObject, steps: list[float]) -> None:
    x = np.concatenate([[0.0], np.cumsum(steps)])
    y = np.array(data.draw(st.lists(torques, min_size=x.size, max_size=x.size)))
    slope = PchipInterpolator(x, y).derivative()
    turns = slope.derivative().roots(discontinuity=False, extrapolate=False)
    at = np.concatenate([x, turns[np.isfinite(turns)]])
    steepest = float(np.max(np.abs(slope(at))))
    assert torque_curve(x, y).steepest == pytest.approx(steepest, rel=1e-9, abs=1e-300)
