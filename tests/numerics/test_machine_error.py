"""Errors of events of motors against an independent integrator: 99 % of random machines and trains hold."""

from __future__ import annotations

from dataclasses import replace

import pytest

from engine.backlash.operating_events import operating_events
from engine.case.choices import MotorEventKind as Kind
from engine.case.data import SupplyRow
from engine.model.modal_analysis import analyse
from tests.machine_reference import (
    errors_hold,
    misses,
    network_reference,
    random_case,
    reference,
    varied_case,
    with_clearance,
)


@pytest.mark.parametrize(
    "seeds",
    [
        range(15),
        pytest.param(range(500), marks=pytest.mark.long),
    ],
    ids=len,
)
def test_stated_errors_hold(seeds):
    errors_hold(seeds, random_case)


@pytest.mark.parametrize(
    "seeds",
    [
        range(8),
        pytest.param(range(500), marks=pytest.mark.long),
    ],
    ids=len,
)
def test_stated_errors_hold_with_teeth_apart(seeds):
    assert errors_hold(seeds, with_clearance) >= len(seeds) // 3


@pytest.mark.parametrize(
    "seeds",
    [
        range(1, 32, 4),
        pytest.param(range(1, 2000, 4), marks=pytest.mark.long),
    ],
    ids=len,
)
def test_stated_errors_hold_with_solid_poles(seeds):
    errors_hold(seeds, varied_case)


@pytest.mark.parametrize("kind", [Kind.THREE_PHASE_FAULT, Kind.LINE_TO_LINE_FAULT])
@pytest.mark.parametrize(
    ("make", "seed"), [*((random_case, s) for s in (0, 1, 2, 6)), *((with_clearance, s) for s in (1, 2, 6))]
)  # fmt: skip
def test_stated_errors_hold_where_phases_clear_at_zeros_of_current(kind, make, seed):
    """Beside scipy's location of the zeros of phase currents, also with teeth apart."""
    case = make(seed)
    row = case.motor_events[0]
    event = replace(
        row, kind=kind, phase=0.4 + 0.5 * seed, angle=None, residual_voltage=None, clears_after=0.06,
        clearing="zeros of current",
    )  # fmt: skip
    case = replace(case, motor_events=(event,))
    (found,) = operating_events(case, analyse(case))
    assert misses(case, found) == []


@pytest.mark.parametrize("kind", [Kind.THREE_PHASE_FAULT, Kind.LINE_TO_LINE_FAULT])
@pytest.mark.parametrize(
    ("make", "seed"), [*((random_case, s) for s in (0, 1, 2, 6)), *((with_clearance, s) for s in (1, 2, 6, 8))]
)  # fmt: skip
def test_stated_errors_hold_of_faults_off_the_line(kind, make, seed):
    """Beside DOP853; of a line-to-line fault in fluxes of the loop that the fault closes, and of the rotor."""
    case = make(seed)
    shorted = kind == Kind.LINE_TO_LINE_FAULT
    event = replace(
        case.motor_events[0], kind=kind, phase=0.4 + 0.5 * seed if shorted else None, angle=None,
        residual_voltage=0.8 + 0.05 * seed, clears_after=None,
    )  # fmt: skip
    case = replace(case, motor_events=(event,))
    (found,) = operating_events(case, analyse(case))
    assert misses(case, found, network_reference if shorted else reference) == []


BEHIND = (Kind.THREE_PHASE_FAULT, Kind.VOLTAGE_DIP, Kind.VOLTAGE_UNBALANCE, Kind.LINE_TO_LINE_FAULT)


@pytest.mark.parametrize(
    ("make", "kind"),
    [*((random_case, kind) for kind in BEHIND), *((with_clearance, kind) for kind in BEHIND)],
)
@pytest.mark.parametrize("seed", [0, 1, 2])
def test_stated_errors_hold_behind_a_line(make, kind, seed):
    """Beside DOP853 in fluxes of the loops that stator and line make."""
    case = make(seed)
    turned = kind in (Kind.LINE_TO_LINE_FAULT, Kind.VOLTAGE_UNBALANCE)
    reduced = kind in (Kind.VOLTAGE_DIP, Kind.VOLTAGE_UNBALANCE)
    event = replace(
        case.motor_events[0], kind=kind, phase=0.4 + 0.5 * seed if turned else None, angle=None,
        residual_voltage=0.2 if reduced else None, clears_after=0.06,
    )  # fmt: skip
    line = SupplyRow("M0", 6.0 * case.motor_data[0].apparent_power, 5.0)
    case = replace(case, motor_events=(event,), supply=(line,))
    (found,) = operating_events(case, analyse(case))
    assert misses(case, found, network_reference) == []
    stiff = replace(case, supply=())
    (other,) = operating_events(stiff, analyse(stiff))
    assert misses(case, other, network_reference) != []


@pytest.mark.parametrize("kind", [Kind.THREE_PHASE_FAULT, Kind.LINE_TO_LINE_FAULT])
@pytest.mark.parametrize(
    ("make", "seed"), [*((random_case, s) for s in (0, 1, 2, 6)), *((with_clearance, s) for s in (1, 2, 6))]
)  # fmt: skip
def test_stated_errors_hold_where_phases_behind_a_line_clear_at_zeros_of_current(kind, make, seed):
    case = make(seed)
    event = replace(
        case.motor_events[0], kind=kind, phase=0.4 + 0.5 * seed, angle=None, residual_voltage=None, clears_after=0.06,
        clearing="zeros of current",
    )  # fmt: skip
    line = SupplyRow("M0", 6.0 * case.motor_data[0].apparent_power, 5.0)
    case = replace(case, motor_events=(event,), supply=(line,))
    (found,) = operating_events(case, analyse(case))
    assert misses(case, found, network_reference) == []


def test_phases_that_clear_at_zeros_are_not_those_that_clear_at_once():
    case = random_case(0)
    event = replace(
        case.motor_events[0], kind=Kind.THREE_PHASE_FAULT, residual_voltage=None, clears_after=0.06
    )
    sizes = []
    for clearing in (None, "zeros of current"):
        changed = replace(case, motor_events=(replace(event, clearing=clearing),))
        (found,) = operating_events(changed, analyse(changed))
        sizes.append(found.history.air_gap[-1])
    assert abs(sizes[1] / sizes[0] - 1.0) > 1e-3
