"""Wrong events of motors are found at their cells, with what to do; right ones pass."""

from __future__ import annotations

from dataclasses import replace

import pytest

from engine.case.checks.find_problems import find_problems
from engine.case.data import (
    EventTorqueRow,
    MotorCircuitRow,
    MotorEventRow,
    MotorTorqueRow,
    SupplyRow,
)
from tests.engine.case.test_motor_checks import BY_CIRCUIT, CIRCUIT, INDUCTION, SHEET, case, places

FAULT = MotorEventRow("fault", "motor", "three-phase fault", clears_after=0.1)
RIGHT = (
    FAULT,
    MotorEventRow("short", "motor", "line-to-line fault", phase=0.5),
    MotorEventRow("off", "motor", "line-to-line fault", phase="worst", residual_voltage=1.1),
    MotorEventRow("off, all", "motor", "three-phase fault", residual_voltage=1.0),
    MotorEventRow("closing", "motor", "out-of-phase closing", angle=-2.0),
    MotorEventRow("excited", "motor", "out-of-phase closing", angle=2.0, residual_voltage=1.1),
    MotorEventRow("at once", "motor", "reclosing"),
    MotorEventRow("transfer", "motor", "reclosing", None, 1.0, 0.8, 0.2),
    MotorEventRow("dip", "motor", "voltage dip", residual_voltage=0.0, clears_after=0.2),
    MotorEventRow("phase", "motor", "voltage unbalance", 0.3, residual_voltage=0.9),
    MotorEventRow("worst", "motor", "line-to-line fault", "worst", clears_after="worst"),
    MotorEventRow("angle", "motor", "out-of-phase closing", angle="worst"),
    replace(FAULT, event="zeros", phase=0.3, clearing="zeros of current"),
    replace(FAULT, event="late", clears_after="worst", latest_clearing=0.3, earliest_clearing=0.05),
)


IN_START = replace(FAULT, begins=0.5, clears_after=0.1)


def problems(*events, motors=(SHEET,), **fields):
    data = replace(case(*motors, **fields), motor_events=events)
    return [p for p in find_problems(data) if p.table not in ("Elements", "Stations")]


def test_right_events_pass():
    assert problems(*RIGHT) == []
    assert problems(FAULT, motors=(BY_CIRCUIT,), circuits=(CIRCUIT,)) == []


@pytest.mark.parametrize(
    ("event", "column", "words"),
    [
        (replace(FAULT, event=None), "Event", "Name it"),
        (replace(FAULT, station=None), "Station", "a station of table MotorData"),
        (replace(FAULT, station="second"), "Station", "no motor data for 'second': type its row"),
        (replace(FAULT, station="moter"), "Station", "Did you mean 'motor'?"),
        (replace(FAULT, kind=None), "Kind", "Choose from the list"),
        (replace(FAULT, kind="short circuit"), "Kind", "Choose from the list"),
        (replace(FAULT, clears_after=-0.1), "Clears after", "nothing clears before it begins"),
        (replace(FAULT, clears_after=120.0), "Clears after", "Write 120 ms or 0.12 s"),
        (
            replace(FAULT, residual_voltage=0.5),
            "Clears after",
            "The motor is off the line then, and no line returns",
        ),
        (
            replace(FAULT, residual_voltage=0.0, clears_after=None),
            "Residual voltage",
            "clear the cell for a motor on its line",
        ),
        (replace(FAULT, phase="worst"), "Phase", "no effect on a three-phase fault"),
        (replace(FAULT, per_life=-1.0), "Per life", "the number of such events"),
        (replace(FAULT, clearing="zero"), "Clearing", "at once, zeros of current"),
        (
            replace(FAULT, clearing="zeros of current", clears_after=None),
            "Clears after",
            "when the breaker opens",
        ),
        (
            replace(FAULT, clearing="zeros of current", clears_after="worst"),
            "Clears after",
            "Torques jump",
        ),
        (replace(RIGHT[8], clearing="zeros of current"), "Clearing", "no fault is cleared"),
        (replace(FAULT, clears_after="best"), "Clears after", "it must be a number, or worst"),
        (replace(FAULT, latest_clearing=0.2), "Latest clearing", "unless Clears after is worst"),
        (
            replace(FAULT, clears_after="worst", latest_clearing=300.0),
            "Latest clearing",
            "Write 300 ms or 0.3 s",
        ),
        (
            replace(FAULT, earliest_clearing=0.05),
            "Earliest clearing",
            "unless Clears after is worst",
        ),
        (
            replace(FAULT, clears_after="worst", earliest_clearing=50.0),
            "Earliest clearing",
            "Write 50 ms or 0.05 s",
        ),
        (
            replace(FAULT, clears_after="worst", earliest_clearing=0.5),
            "Earliest clearing",
            "below Latest clearing, 0.5 s",
        ),
        (replace(FAULT, phase=0.5), "Phase", "no effect on a three-phase fault"),
        (replace(FAULT, angle=float("nan")), "Angle", "found nan"),
        (replace(RIGHT[4], angle=None), "Angle", "given for a out-of-phase closing"),
        (replace(RIGHT[4], angle=120.0), "Angle", "between -360 and 360 degrees"),
        (replace(RIGHT[4], clears_after=0.2), "Clears after", "no effect"),
        (replace(RIGHT[4], residual_voltage=0.0), "Residual voltage", "above 0 pu"),
        (replace(RIGHT[8], residual_voltage=None), "Residual voltage", "given for a voltage dip"),
        (replace(RIGHT[8], residual_voltage=60.0), "Residual voltage", "Write 60 % or 0.6 pu"),
    ],
)
def test_wrong_events_are_found(event, column, words):
    (problem,) = problems(event)
    assert (problem.table, problem.row, problem.column) == ("MotorEvents", 1, column)
    assert words in problem.message


@pytest.mark.parametrize("begins", [None, "running", 0.5])
def test_an_event_begins_in_operation_or_in_the_start(begins):
    events = [replace(e, begins=begins) for e in RIGHT[:2]]
    assert problems(*events) == []


@pytest.mark.parametrize("begins", [None, 1.5])
@pytest.mark.parametrize("kind", ["three-phase fault", "line-to-line fault"])
def test_a_motor_behind_a_line_may_have_any_fault(begins, kind):
    event = replace(IN_START, begins=begins, kind=kind, clearing="zeros of current")
    assert problems(event, supply=(SupplyRow("motor", 1e9),)) == []


@pytest.mark.parametrize(
    "change", [{}, {"clears_after": "worst"}, {"kind": "line-to-line fault", "phase": "worst"}], ids=str
)  # fmt: skip
def test_the_phase_of_the_start_may_be_worst_beside_one_of_the_event(change):
    assert problems(replace(IN_START, **change), pulsation_phase="worst") == []


def test_an_induction_motor_may_have_a_fault_while_it_starts():
    """It needs no field that keeps it in step."""
    assert problems(IN_START, motors=(INDUCTION,)) == []


@pytest.mark.parametrize(
    ("change", "fields", "column", "words"),
    [
        ({"begins": "now"}, {}, "Begins", "it must be a number, or running"),
        ({"begins": -0.5}, {}, "Begins", "from the closing of the breaker"),
        ({"begins": 500.0}, {"maximum_time": 10.0}, "Begins", "below MaximumTime, 10 s"),
        ({}, {"initial_state": "running"}, "Begins", "There is no start in which it could begin"),
        (
            {"kind": "line-to-line fault", "phase": "worst", "clears_after": "worst"},
            {"pulsation_phase": "worst"},
            "Phase",
            "those of all three are too many: type a number in one of the three",
        ),
        (
            {},
            {"motor_torque": (MotorTorqueRow("motor", 0.0, 1e4, 0.0), MotorTorqueRow("motor", 1.0, 1e4, 0.0))},
            "Begins",
            "a row of every motor in table MotorData, and none in MotorTorque",
        ),
        ({"kind": "out-of-phase closing", "angle": 1.0, "clears_after": None}, {}, "Begins", "closed already"),
        ({"residual_voltage": 0.9, "clears_after": None}, {}, "Residual voltage", "no effect on a three-phase fault"),
        ({"kind": "reclosing", "angle": 1.0}, {}, "Angle", "no effect on a reclosing"),
        ({"kind": "reclosing", "residual_voltage": 0.7}, {}, "Residual voltage", "no effect on a reclosing"),
    ],
)  # fmt: skip
def test_what_cannot_begin_in_a_start_is_refused(change, fields, column, words):
    found = [p for p in problems(replace(IN_START, **change), **fields) if p.table == "MotorEvents"]
    (problem,) = found
    assert (problem.row, problem.column) == (1, column)
    assert words in problem.message


def test_names_are_used_once():
    found = problems(FAULT, FAULT)
    assert [(p.row, p.column) for p in found] == [(2, "Event")]
    assert "row 1 has it already" in found[0].message
    same = EventTorqueRow("fault", "motor", 1.0)
    (found,) = problems(FAULT, event_torque=(same,), rated_torque=1e3)
    assert "another table has it already" in found.message


def test_a_motor_without_a_field_does_not_run_in_step():
    bare = replace(SHEET, xd_transient=None, td_0_transient=None, discharge_resistance=None)
    (found,) = problems(FAULT, motors=(bare,))
    assert "Type Xd transient in its row of table MotorData" in found.message
    no_field = replace(CIRCUIT, rf=None, xlf=None)
    sheet = replace(BY_CIRCUIT, discharge_resistance=None)
    (found,) = problems(FAULT, motors=(sheet,), circuits=(no_field,))
    assert found.column == "Station"
    assert places(case(sheet, circuits=(no_field,))) == []


def test_the_speed_must_be_known():
    found = problems(FAULT, poles=None, line_frequency=None)
    assert "LineFrequency" in {p.column for p in found}


def test_an_induction_motor_has_no_voltage_off_the_line():
    event = MotorEventRow("off", "motor", "three-phase fault", residual_voltage=0.9)
    (found,) = problems(event, motors=(INDUCTION,))
    assert found.column == "Residual voltage"
    assert "has no voltage that stays" in found.message


def test_an_induction_motor_is_not_closed_out_of_phase():
    events = [e for e in RIGHT if not e.is_off_the_line]
    assert problems(*events, motors=(INDUCTION,)) == []
    (found,) = problems(RIGHT[4], motors=(INDUCTION,))
    assert (found.table, found.row, found.column) == ("MotorEvents", 1, "Kind")
    assert "has no voltage to be out of phase. Choose reclosing" in found.message


def test_an_induction_motor_by_its_circuit_is_alike_in_both_axes():
    sheet = replace(BY_CIRCUIT, kind="induction", discharge_resistance=None)
    alike = MotorCircuitRow("motor", 0.01, 0.1, 4.0, 4.0, rkd=0.01, xlkd=0.1, rkq=0.01, xlkq=0.1)
    assert problems(FAULT, motors=(sheet,), circuits=(alike,)) == []
    (found,) = problems(FAULT, motors=(sheet,), circuits=(replace(alike, xmq=3.0),))
    assert found.column == "Station"
    assert "alike in both axes" in found.message


def test_half_a_field_is_reported_where_it_is_missing():
    half = replace(SHEET, xd_transient=None)
    assert [(p.table, p.column) for p in problems(FAULT, motors=(half,))] == [
        ("MotorData", "Xd transient")
    ]
