"""What is said of the sign of a torque is no wider than what was calculated."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from engine.run import run
from engine.start.lowest_torque import doubts_of_minima, sign_in_words
from engine.start.peaks import ElementPeak
from tests.sample_case import sample_case, with_limits


@pytest.mark.parametrize(
    ("lowest", "doubt", "words"),
    [
        (500.0, 499.0, "stays positive"),
        (500.0, 505.0, "does not reverse"),
        (500.0, 520.0, "may reverse (its lowest value is within its error of zero)"),
        (500.0, None, "does not reverse as calculated (no bound on what is left out)"),
        (-5.0, 1.0, "does not reverse (below zero by less than 0.1% of its largest)"),
        (-5.0, 6.0, "may reverse (its lowest value is within its error of zero)"),
        (-11.0, 0.0, "reverses"),
        (-11.0, None, "reverses"),
    ],
)
def test_a_torque_with_a_hysteresis_of_ten(lowest: float, doubt: float | None, words: str) -> None:
    assert sign_in_words(lowest, doubt, 10.0) == words


def test_the_doubt_is_the_error_and_what_is_left_out() -> None:
    peaks = [
        ElementPeak("near", 100.0, 5.0, 1.0, 90.0, error=2.0, peak_to_peak=95.0, left_out=3.0),
        ElementPeak("far", 100.0, 5.0, 1.0, 90.0, error=2.0, peak_to_peak=95.0, left_out=None),
    ]
    start: Any = SimpleNamespace(peaks=peaks, repeatability=None)
    assert doubts_of_minima(start) == {"near": 5.0, "far": None}


def test_a_crossing_says_nothing_of_the_rest_of_the_start() -> None:
    """The modified design reverses at its first mode, 21 Hz, long after it has crossed the third, 69 Hz."""
    results = run(with_limits(sample_case("modified")))
    first, _, third = results.crossings
    assert "Mesh torque here reverses." in first.note
    assert "Mesh torque here stays positive." in third.note
    (mesh,) = results.reversals
    assert mesh.sentence.startswith("Mesh: torque reverses")


def test_without_a_bound_on_backlash_no_crossing_is_said_to_stay_positive() -> None:
    third = run(sample_case("modified")).crossings[-1]
    words = "Mesh torque here does not reverse as calculated (no bound on what is left out)."
    assert words in third.note
