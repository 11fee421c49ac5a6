"""Sine, cosine and exponential of the compiled loops in 50 digits: within one unit in the last place."""

from __future__ import annotations

import mpmath
import numpy as np
import pytest

from engine.numerics.same_bits import cos, exp, sin

#: Places over all that a start asks for: phases, line frequency × time, angles of passed-over modes.
RANGES = [(-13.0, 13.0), (0.0, 2e4), (-1e6, 1e6), (1e6, 1e9)]


def units_off(found: np.ndarray, function: object, places: np.ndarray) -> float:
    """Largest error, in units in the last place of the true value."""
    with mpmath.workdps(50):
        return max(
            abs(float((mpmath.mpf(float(y)) - exact) / float(np.spacing(abs(float(exact))))))
            for y, exact in zip(found, map(function, map(mpmath.mpf, places.tolist())), strict=True)
        )


@pytest.mark.parametrize(("low", "high"), RANGES)
def test_sine_and_cosine(low: float, high: float) -> None:
    rng = np.random.default_rng(16)
    near = np.round(rng.uniform(low, high, 300) * 2.0 / np.pi) * (
        np.pi / 2.0
    )  # where one is all but zero
    places = np.concatenate([rng.uniform(low, high, 700), near])
    sine, cosine = sin(places), cos(places)
    assert units_off(sine, mpmath.sin, places) < 1.0
    assert units_off(cosine, mpmath.cos, places) < 1.0


def test_exponential() -> None:
    rng = np.random.default_rng(17)
    places = np.concatenate(
        [
            rng.uniform(-708.0, 709.0, 500),
            rng.uniform(-1.0, 1.0, 500),
            -(10.0 ** rng.uniform(-15.0, 0.0, 200)),
        ]
    )
    assert units_off(exp(places), mpmath.exp, places) < 1.0


def test_beyond_the_range_of_doubles() -> None:
    places = np.array([-np.inf, -800.0, -744.0, 0.0, 710.0, np.inf, np.nan])
    found = exp(places)
    np.testing.assert_allclose(found, [0.0, 0.0, 9.88131e-324, 1.0, np.inf, np.inf, np.nan])
