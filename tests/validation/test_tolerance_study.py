"""Stated tolerances are honoured: a short tolerance study, and how its records are judged."""

from __future__ import annotations

import math
from typing import Any

import pytest

from benchmarks.study_answers import classes_of, sensitive_answers, summary_of
from benchmarks.study_trains import LEAVES_EFFECT, LEAVES_MODES, gaps_of, study_train
from benchmarks.tolerance_study import FULL, QUICK, study, trains_of_study


def record(**changes: object) -> dict[str, object]:
    """A made-up record: peak wrong by 1 in 1000, starts by 1 in 100, both as stated."""
    asked = {
        "events": True,
        "outcome": "reached",
        "steps": 1000,
        "stopped": False,
        "step": 1e-3,
        "sensitivity": None,
        "modes_left_out": 0,
        "recontacts": {"A": [2.0, 1e-3]},
        "peaks": {"A": [1001.0, -10.0, 1.5, 0.5, 999.0, 1003.0]},
        "starts": {"A": [99.0, 0.0, 97.0, 101.0], "B": [None, 0.0, None, None]},
    }
    truth = {
        "stopped": False,
        "step": 1e-4,
        "recontacts": {"A": [2.001, 1e-5]},
        "peaks": {"A": [1000.0, -10.0, 0.0]},
        "starts": {"A": [100.0, 0.0], "B": [None, None]},
    }
    made: dict[str, object] = {
        "number": 1,
        "extras": ["clearances"],
        "tolerance": [1e-3, 2e-2],
        "asked": asked,
        "truth": truth,
    }
    return made | changes


def test_a_study_cut_short_has_trains_of_every_kind_in_proportion() -> None:
    whole = trains_of_study()
    assert len(whole) == len(set(whole)) == 1520
    tenth = whole[:152]
    for first, end in (
        (0, FULL),
        (LEAVES_MODES, LEAVES_EFFECT),
        (LEAVES_EFFECT, LEAVES_EFFECT + FULL),
    ):
        many, few = (sum(first <= n < end for n in numbers) for numbers in (whole, tenth))
        assert abs(10 * few - many) <= 20
    assert sum(n % 2 for n in tenth) == 76  # both of each pair


def test_errors_are_relative_to_the_truth() -> None:
    peak, starts = summary_of([record()]).answers  # unlimited starts have no error
    assert (peak.true, peak.stated, peak.ratio) == pytest.approx((1e-3, 2e-3, 2.0))
    assert (starts.true, starts.stated, starts.ratio) == pytest.approx((1 / 99, 2 / 99, 2.0))
    for answer in (peak, starts):
        assert answer.within
        assert answer.holds


def test_sensitive_answers_are_those_told_less_closely_than_wanted() -> None:
    """One of two peaks, two of three starts; an answer of a start that is not sensitive is none."""
    made = record()
    asked: Any = made["asked"]
    asked["peaks"]["B"] = [100.0, 0.0, 0.0, 0.0, 99.95, 100.05]
    asked["starts"]["C"] = [99.0, 0.0, 98.0, None]
    assert sensitive_answers([made], "peaks") == (0, 0, 2)
    asked["sensitivity"] = {"spread": 1.0, "sensitive": True}
    assert sensitive_answers([made], "peaks") == (1, 0, 2)
    assert sensitive_answers([made], "starts") == (2, 0, 3)
    other = {
        "peaks": {"A": [1000.9, -10.0], "B": [100.2, 0.0]},
        "starts": {"A": [99.0], "B": [None], "C": [None]},
    }
    assert sensitive_answers([made | {"nudged": [other]}], "peaks") == (1, 1, 2)
    assert sensitive_answers([made | {"nudged": [other]}], "starts") == (2, 1, 3)


def test_recontact_speeds_are_judged_by_their_own_error() -> None:
    (speed,) = summary_of([record()]).recontacts
    assert (speed.true, speed.stated) == pytest.approx((5e-4, 1e-3))
    assert speed.holds


def test_finite_starts_that_should_be_unlimited_are_wrong() -> None:
    truth = {
        "stopped": False,
        "step": 1e-4,
        "recontacts": {},
        "peaks": {"A": [1000.0, -10.0, 0.0]},
        "starts": {"A": [None, None], "B": [None, None]},
    }
    _, starts = summary_of([record(truth=truth)]).answers
    assert math.isinf(starts.true)
    assert not starts.within
    assert not starts.holds


def test_an_answer_without_a_bound_is_counted_apart() -> None:
    made = record()
    made["asked"]["peaks"]["A"][3] = None  # type: ignore[index]
    found = summary_of([made])
    assert found.answers[0].stated is None
    everything = classes_of(found)[0]
    assert (everything.answers, everything.unbounded) == (1, 1)


def test_a_run_that_was_stopped_has_no_answers() -> None:
    made = record()
    made["asked"] |= {"outcome": "time out", "stopped": True}  # type: ignore[operator]
    found = summary_of([made])
    assert found.stopped == [1]
    assert not found.answers


def test_a_bound_that_does_not_hold_is_a_miss() -> None:
    bounds = {"bearings": {"A": [1e-3, 2e-3]}, "backlash": {"A": [1e-3, 0.0]}}
    found = summary_of([record(bounds=bounds)])
    assert [a.holds for a in found.bounds] == [False, True]


def test_a_truth_that_was_stopped_is_none() -> None:
    made = record()
    made["truth"] |= {"stopped": True}  # type: ignore[operator]
    found = summary_of([made])
    assert found.untold == [1]
    assert not found.answers


@pytest.mark.parametrize("says", [True, False])
@pytest.mark.parametrize("peak", [1001.1, 1010.0])
def test_sensitive_trains_are_counted_apart(says: bool, peak: float) -> None:
    starts = {"A": [100.5], "B": [None]}
    made = record(nudged=[{"peaks": {"A": [peak, -10.0, 0.0]}, "starts": starts}])
    made["asked"]["sensitivity"] = {"spread": 1.0, "sensitive": says}  # type: ignore[index]
    found, felt = summary_of([made]), peak > 1005.0
    assert found.sensitive == ([1] if says else [])
    assert found.felt == ([1] if says and felt else [])
    assert found.unfelt == ([1] if felt and not says else [])
    assert len(found.answers) == (0 if says else 2)
    # the range of the peak, the error of both extremes, two of starts
    within = [peak < 1003.0, peak < 1003.0, True, True]
    assert [r.inside for r in found.repeated] == (within if says else [])


@pytest.mark.parametrize("number", [1, 21, 41])
def test_what_is_integrated_independently_has_its_teeth_on_the_side_of_the_motor(
    number: int,
) -> None:
    train = study_train(number)
    assert train.independent
    assert gaps_of(train.case)
    reached = {train.case.motor_torque[0].station}
    left = list(train.case.elements)
    while left:
        inner = [e for e in left if e.from_ in reached]
        assert inner
        reached |= {e.to for e in inner}
        left = [e for e in left if e not in inner]


@pytest.mark.slow
@pytest.mark.parametrize("trains", [QUICK // 3, pytest.param(QUICK, marks=pytest.mark.long)])
def test_stated_tolerances_are_honoured(trains: int) -> None:
    found = summary_of(study(range(trains), 2, nudges=4))
    assert not found.failed
    everything = classes_of(found)[0]
    assert everything.answers > 4 * trains
    assert found.events > trains // 3
    assert everything.share >= 0.99
    assert everything.ratio <= 30.0
    assert not found.unfelt
    assert sum(r.inside for r in found.repeated) >= 0.99 * len(found.repeated)
    own = [a for a in found.independent if not a.within]
    assert len(own) <= 0.01 * len(found.independent)
