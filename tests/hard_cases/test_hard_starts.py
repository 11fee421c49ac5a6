"""Starts of the hard cases, with default settings, against an integrator of their own."""

from dataclasses import replace

import numpy as np
import pytest

from tests.hard_cases.answers import compared, default_start, start_truth
from tests.hard_cases.corpus import STARTS

#: Wanted where TolerancePeak is blank.
TOLERANCE = 1e-3
#: No part of the truth may be further from itself at twice the step.
TRUTH = 2e-5

THOUSAND = "1,000 stations"
#: Seconds, for the first half a minute and more, of reference steps; then those with a sibling.
SLOW = (
    "120 s without any damping",
    "modes at 2 × line and at 0.2 Hz",
    "barely accelerating, net torque 0.1 %",
    "vertical step in the curve, 1e-9 of speed",
    "overdamped coupling between shafts",
    "rigid link of 1e18 N·m/rad at the motor",
    "4 poles, 16.7 Hz",
    "4 poles, 50 Hz",
    "4 poles, 60 Hz",
)
#: Their truth takes seconds, so that it is compared with itself in the long run only.
LONG = (
    THOUSAND,
    "120 s without any damping",
    "modes at 2 × line and at 0.2 Hz",
    "barely accelerating, net torque 0.1 %",
    "vertical step in the curve, 1e-9 of speed",
    "vertical step in the curve, no number between",
)


def _marks(name: str) -> list[pytest.MarkDecorator]:
    """A whole start of a thousand stations takes minutes; CI has its first tenth of a second."""
    if name == THOUSAND:
        return [pytest.mark.long]
    return [pytest.mark.slow] if name in SLOW else []


def _marks_of_truth(name: str) -> list[pytest.MarkDecorator]:
    """The truth of a thousand stations, and of long starts, takes minutes."""
    return [pytest.mark.long] if name in LONG else []


@pytest.mark.first_ones(4)
@pytest.mark.parametrize("name", [pytest.param(name, marks=_marks(name)) for name in STARTS])
def test_peaks_are_within_the_tolerance_and_the_reported_error(name: str) -> None:
    hard = STARTS[name]
    start = default_start(hard).start
    assert start.outcome.outcome == hard.outcome
    truth = start_truth(hard, start.outcome.time)
    found = compared(start, truth.maximum, truth.minimum)
    assert np.all(found.error <= found.reported + TRUTH)
    assert np.max(found.error) <= TOLERANCE
    assert start.met_tolerance
    in_one_piece = all(e.stiffness for e in hard.case.elements)
    if in_one_piece:
        synchronous = hard.case.ratings.synchronous_speed
        assert synchronous is not None
        assert truth.mean_speed == pytest.approx(start.outcome.end_speed, abs=5e-4 * synchronous)


@pytest.mark.first_ones(1)
@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=_marks_of_truth(name)) for name in STARTS]
)
def test_the_truth_agrees_with_itself_at_twice_the_step(name: str) -> None:
    hard = STARTS[name]
    end = 0.1 if name == THOUSAND else default_start(hard).start.outcome.time
    fine, coarse = (
        start_truth(hard, end, coarser=c) for c in ((0.5, 1) if name == THOUSAND else (1, 2))
    )
    size = np.maximum(np.abs(fine.maximum), np.abs(fine.minimum))
    assert np.max(np.abs(fine.maximum - coarse.maximum) / size) <= TRUTH
    assert np.max(np.abs(fine.minimum - coarse.minimum) / size) <= TRUTH


@pytest.mark.long
def test_the_first_tenth_of_a_second_of_a_thousand_stations() -> None:
    whole = STARTS[THOUSAND]
    hard = replace(whole, case=replace(whole.case, maximum_time=0.1))
    start = default_start(hard).start
    assert start.outcome.outcome == "time out"
    truth = start_truth(whole, start.outcome.time)
    found = compared(start, truth.maximum, truth.minimum)
    # far from the motor there is hardly a torque yet: errors are over the largest
    size = np.maximum(np.abs(truth.maximum), np.abs(truth.minimum))
    assert np.max(found.error * size) <= TOLERANCE * np.max(size)
    assert np.all(found.error <= found.reported + TRUTH)


def test_the_undamped_start_is_long_and_has_no_damping() -> None:
    planned = default_start(STARTS["120 s without any damping"])
    assert planned.start.outcome.time > 120.0
    assert np.all(planned.model.damping.ratio == 0.0)


def test_overdamped_elements_are_overdamped() -> None:
    planned = default_start(STARTS["overdamped coupling, 50 × critical"])
    assert planned.model.damping.ratio[-1] == pytest.approx(50.0)
