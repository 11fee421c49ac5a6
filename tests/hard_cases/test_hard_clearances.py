"""Starts with clearances: hard gaps and chatter, against an integrator of their own."""

import functools
from dataclasses import replace

import numpy as np
import pytest

from engine.start.event_results import ContactRecord
from engine.start.start import Start
from tests.hard_cases.answers import clearance_run, clearance_truth
from tests.hard_cases.corpus import CLEARANCES, ClearanceCase
from tests.hard_cases.reference import Answer

TOLERANCE = 1e-3
#: How far the truth may be from itself at twice the step.
TRUTH = 1e-4


@functools.cache
def _truth(name: str) -> Answer:
    return clearance_truth(CLEARANCES[name]())


@functools.cache
def _ours(name: str) -> tuple[Start, dict[str, ContactRecord]]:
    return clearance_run(CLEARANCES[name]())


#: Their truth takes seconds, so that they run as a whole in the long run only.
LONG = ("a mesh that chatters a thousand times", "two meshes that chatter together")


#: Seconds of those that every run compares: a hundred impacts, and some in both meshes.
FIRST_SECONDS = {LONG[0]: 1.0, LONG[1]: 2.0}

#: Errors of recontact speeds say something as long as they are below this.
WIDEST_RECONTACT_ERROR = 0.1

WHOLE = [pytest.param(n, marks=[pytest.mark.slow] * (n in LONG)) for n in CLEARANCES]


@pytest.mark.long
@pytest.mark.parametrize("name", CLEARANCES)
def test_the_truth_agrees_with_itself_at_twice_the_step(name: str) -> None:
    hard = CLEARANCES[name]()
    fine, coarse = _truth(name), clearance_truth(hard, coarser=2.0)
    size = np.maximum(np.abs(fine.maximum), np.abs(fine.minimum))
    assert np.max(np.abs(fine.maximum - coarse.maximum) / size) <= TRUTH
    assert np.max(np.abs(fine.minimum - coarse.minimum) / size) <= TRUTH
    np.testing.assert_array_equal(fine.impacts, coarse.impacts)
    np.testing.assert_array_equal(fine.back_impacts, coarse.back_impacts)
    np.testing.assert_allclose(fine.free_time, coarse.free_time, rtol=1e-5)
    clear = [e.element in hard.clearances for e in hard.case.elements]
    assert np.all(fine.impacts[clear] >= hard.impacts)


def _peaks_agree(start: Start, truth: Answer) -> None:
    assert start.met_tolerance
    for peak, maximum, minimum in zip(start.peaks, truth.maximum, truth.minimum, strict=True):
        size = max(abs(maximum), abs(minimum))
        assert peak.maximum == pytest.approx(maximum, abs=TOLERANCE * size)
        assert peak.minimum == pytest.approx(minimum, abs=TOLERANCE * size)


def _contacts_agree(hard: ClearanceCase, contacts: dict[str, ContactRecord], truth: Answer) -> None:
    """A flank is met after free flight; time unloaded is time without force.

    Of hundreds of impacts a few only graze, with a force far below the tolerance of the start: one
    in a hundred may be there or not. Below a hundred the counts are equal. The tolerance is one of peaks
    and starts: a recontact speed is as good as the error that it states.
    """
    names = [e.element for e in hard.case.elements]
    for element in hard.clearances:
        found, i = contacts[element], names.index(element)
        assert abs(found.impacts - truth.impacts[i]) <= 0.01 * truth.impacts[i]
        assert abs(found.back_impacts - truth.back_impacts[i]) <= 0.01 * truth.back_impacts[i]
        assert found.time_unloaded == pytest.approx(truth.free_time[i], rel=TOLERANCE)
        assert found.recontact_error is not None
        assert found.recontact_error < WIDEST_RECONTACT_ERROR
        off = max(found.recontact_error, TOLERANCE)
        assert found.recontact_speed_angular == pytest.approx(truth.approach[i], rel=off)


@pytest.mark.parametrize("name", WHOLE)
def test_peaks_of_a_start_with_clearance(name: str) -> None:
    _peaks_agree(_ours(name)[0], _truth(name))


@pytest.mark.parametrize("name", WHOLE)
def test_contacts_of_a_start_with_clearance(name: str) -> None:
    _contacts_agree(CLEARANCES[name](), _ours(name)[1], _truth(name))


@pytest.mark.first_ones(1)
@pytest.mark.parametrize("name", LONG[::-1])
def test_the_first_seconds_of_chatter(name: str) -> None:
    hard = replace(CLEARANCES[name](), end=FIRST_SECONDS[name])
    start, contacts = clearance_run(hard)
    truth = clearance_truth(hard)
    assert all(truth.impacts[[e.element in hard.clearances for e in hard.case.elements]])
    _peaks_agree(start, truth)
    _contacts_agree(hard, contacts, truth)
