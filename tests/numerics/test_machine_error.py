"""Errors of events of motors against an independent integrator: 99 % of random machines and trains hold."""

from __future__ import annotations

import pytest

from engine.backlash.operating_events import operating_events
from engine.model.modal_analysis import analyse
from tests.machine_reference import misses, random_case


@pytest.mark.parametrize(
    "seeds",
    [
        range(15),
        pytest.param(range(15, 50), marks=pytest.mark.slow),
        pytest.param(range(500), marks=pytest.mark.long),
    ],
    ids=len,
)
def test_stated_errors_hold(seeds):
    missed = {}
    for seed in seeds:
        case = random_case(seed)
        (event,) = operating_events(case, analyse(case))
        assert event.response is not None, event.note
        if found := misses(case, event):
            missed[seed] = found
    assert len(missed) <= 0.01 * len(seeds), missed
