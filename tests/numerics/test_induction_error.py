"""Errors of events of induction motors against an independent integrator in axes that stand still."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import pytest

from engine.backlash.operating_events import operating_events
from engine.case.choices import MotorEventKind as Kind
from engine.model.modal_analysis import analyse
from tests.induction_reference import induction_case, induction_reference
from tests.machine_reference import errors_hold, misses


@pytest.mark.parametrize(
    "seeds",
    [
        range(12),
        pytest.param(range(300), marks=pytest.mark.long),
    ],
    ids=len,
)
def test_stated_errors_hold(seeds):
    errors_hold(seeds, induction_case, induction_reference)


@pytest.mark.parametrize(
    "seeds", [range(6), pytest.param(range(6, 100), marks=pytest.mark.long)], ids=len
)
def test_stated_errors_hold_with_teeth_apart(seeds):
    apart = errors_hold(seeds, partial(induction_case, clearance=True), induction_reference)
    assert apart >= len(seeds) // 3


@pytest.mark.parametrize("kind", [Kind.THREE_PHASE_FAULT, Kind.LINE_TO_LINE_FAULT])
@pytest.mark.parametrize("seed", [0, 1, 3])
def test_stated_errors_hold_where_phases_clear_at_zeros_of_current(kind, seed):
    case = induction_case(seed)
    event = replace(
        case.motor_events[0], kind=kind, phase=0.4 + 0.5 * seed, residual_voltage=None, clears_after=0.06,
        clearing="zeros of current",
    )  # fmt: skip
    case = replace(case, motor_events=(event,))
    (found,) = operating_events(case, analyse(case))
    assert misses(case, found, induction_reference) == []
