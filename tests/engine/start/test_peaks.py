"""Ranges of the extremes of one element, by hand."""

from __future__ import annotations

from dataclasses import replace

import pytest

from engine.start.peaks import ElementPeak


@pytest.fixture
def peak() -> ElementPeak:
    """Between 100 and -40 N m, each known to 2 N m; effects left out change it by 1 N m at most."""
    return ElementPeak("mesh", 100.0, -40.0, 1.0, 90.0, 2.0, 140.0, left_out=1.0)


def test_what_is_known_to_an_error_lies_around_its_value(peak: ElementPeak) -> None:
    assert (peak.low, peak.high) == (97.0, 103.0)
    assert peak.minimum_range == (-43.0, -37.0)
    assert peak.peak_to_peak_high == 146.0
    assert peak.relative_error == 0.02


def test_an_uncertain_minimum_is_in_the_error_and_not_in_the_range_of_the_peak(
    peak: ElementPeak,
) -> None:
    """The maximum is the larger extreme and is known to 3 N m; the minimum of one more run may be -70 N m."""
    parted = peak.repeated_in((97.0, 101.0), (-70.0, -39.0))
    assert parted.error == 30.0
    assert (parted.low, parted.high) == (96.0, 103.0)
    assert parted.minimum_range == (-71.0, -37.0)
    assert parted.peak_to_peak_high == 140.0 + 2.0 + 30.0 + 2.0


def test_the_error_holds_for_the_peak_to_peak_torque_too(peak: ElementPeak) -> None:
    """Both extremes may be 10 N m further out, of 140 N m these are more than 10 of the larger extreme's 100."""
    parted = peak.repeated_in((100.0, 110.0), (-50.0, -40.0))
    assert parted.relative_error == pytest.approx(20.0 / 140.0)


def test_either_extreme_may_be_the_larger_of_one_more_run(peak: ElementPeak) -> None:
    parted = peak.repeated_in((60.0, 101.0), (-120.0, -30.0))
    assert (parted.low, parted.high) == (59.0, 121.0)


def test_further_errors_widen_every_range(peak: ElementPeak) -> None:
    for own in (peak, peak.repeated_in((90.0, 110.0), (-60.0, -30.0))):
        wider = own.with_error(5.0)
        assert wider.error == own.error + 5.0
        assert (wider.low, wider.high) == (own.low - 5.0, own.high + 5.0)
        assert wider.minimum_range == (own.minimum_range[0] - 5.0, own.minimum_range[1] + 5.0)
        assert wider.peak_to_peak_high == own.peak_to_peak_high + 10.0


def test_without_a_bound_there_is_no_range(peak: ElementPeak) -> None:
    unbounded = replace(peak, left_out=None)
    assert unbounded.low is unbounded.high is None
    assert unbounded.minimum_range is unbounded.peak_to_peak_high is None
