"""Events of a motor that begin while it starts; beside DOP853: tests/validation/test_start_in_time.py."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from engine.case.case import Case
from engine.case.data import EffectChoiceRow, MeshRow, MotorEventRow
from engine.results.results import Results
from engine.results.tables import Row, result_tables
from engine.run import run
from tests.validation.test_start_from_motor_data import case_from_data

FAULT = MotorEventRow("fault", "Motor", "three-phase fault", clears_after=0.1, begins=1.5)
LOOSE = (MeshRow("Mesh", "external", 0.75, 0.25, backlash=4e-4),)
TOGETHER = (EffectChoiceRow("backlash", "off"),)


def start(*events: MotorEventRow, **fields: object) -> Case:
    """Of about 4 s, its mesh elastic and with a clearance."""
    plain = case_from_data().elements
    mesh = replace(plain[1], stiffness=2.0e8)
    given = {
        "load_torque": (), "end_speed": 170.0, "elements": (plain[0], mesh, plain[2]), "meshes": LOOSE,
        "motor_events": events,
    }  # fmt: skip
    return case_from_data(**(given | fields))


def air_gap(results: Results) -> dict[str, Row]:
    return {row["event"]: row for row in result_tables(results)["AirGapTorque"]}


@pytest.fixture(scope="module")
def apart() -> Results:
    return run(start(FAULT))


def test_peaks_are_those_from_the_event_on(apart):
    """Until it begins the start is that without it, whose largest torques come later or sooner."""
    (found,) = apart.events
    assert found.note == ""
    assert found.response.left_out == 0.0
    assert found.response.trajectory.time[0] == 0.0
    own = apart.start.trajectory
    assert found.response.trajectory.mean_speed[0] == pytest.approx(
        float(np.interp(1.5, own.time, own.mean_speed)), rel=1e-4
    )
    at, end = found.air_gap.time, found.response.trajectory.time[-1]
    assert 0.0 <= at <= end
    assert {row["event"] for row in result_tables(apart)["EventPeaks"]} == {"fault"}
    assert air_gap(apart)["fault"]["largest"] == found.air_gap.largest
    assert air_gap(apart)["fault"]["closed_form"] is None
    assert len(found.history.time) == len(found.history.air_gap)
    # a fault makes the start longer by about as long as it lasts
    longer = 1.5 + end - own.time[-1]
    assert 0.05 < longer < 0.4


def test_teeth_that_separate_meet_again(apart):
    (found,) = apart.events
    assert found.response.contacts[0].impacts > 0
    together = run(start(FAULT, effect_choices=TOGETHER)).events[0]
    assert together.response.contacts == ()
    assert "stay together, since backlash is forced off" in together.note
    assert together.response.left_out is None


def test_impacts_before_the_event_are_none_of_it():
    early, late = (
        run(start(replace(FAULT, begins=at), maximum_time=3.5)).events[0].response.contacts[0]
        for at in (0.2, 3.2)
    )
    assert late.impacts < early.impacts
    assert 0.0 <= late.time_unloaded < early.time_unloaded


def test_a_dip_to_the_whole_voltage_is_no_event():
    nothing = replace(FAULT, kind="voltage dip", residual_voltage=1.0)
    on = (EffectChoiceRow("motor transient", "on"),)
    results = run(start(nothing, meshes=(), effect_choices=on))
    (found,) = results.events
    at_end = {p.element: p for p in results.start.peaks}
    for p in found.response.peaks:
        if at_end[p.element].time > 1.5:
            assert p.maximum == pytest.approx(at_end[p.element].maximum, rel=2e-3)
            assert p.time + 1.5 == pytest.approx(at_end[p.element].time, abs=1e-3)
    assert any(p.time > 1.5 for p in at_end.values())


def test_a_reclosing_in_the_start_gives_no_torque_while_the_breaker_is_open():
    (found,) = run(start(replace(FAULT, kind="reclosing"))).events
    inside = (found.history.time > 1e-6) & (found.history.time < 0.1 - 1e-6)
    assert np.any(inside)
    assert np.max(np.abs(found.history.air_gap[inside])) == 0.0
    after = found.history.time > 0.1 + 1e-6
    assert np.max(np.abs(found.history.air_gap[after])) > 0.0


def test_a_start_that_has_ended_or_tripped_has_no_event():
    late = replace(FAULT, begins=30.0)
    results = run(start(late, meshes=()))
    (found,) = results.events
    assert found.response is None
    assert "before it begins. Type a shorter Begins" in found.note
    after = float(found.note.split("the start ends after ")[1].split(" s")[0])
    assert after == pytest.approx(results.start.outcome.time, rel=0.05)
    (found,) = run(start(late, meshes=(), trip_speed=60.0, maximum_time=60.0)).events
    assert found.response is None
    assert "the motor trips after" in found.note


def test_an_event_delays_the_field():
    synchronised = {
        "field_slip": 0.05, "pull_out_torque": 2.5e4, "field_time_constant": 0.2, "end_speed": None,
        "maximum_time": 12.0, "meshes": (), "damping_ratio": 0.01,
    }  # fmt: skip
    dip = replace(FAULT, kind="voltage dip", residual_voltage=0.6, clears_after=0.5)
    results = run(start(dip, **synchronised))
    (found,) = results.events
    assert results.start.pull_in.synchronised
    assert found.response.pull_in.synchronised
    assert found.response.pull_in.field_time + 1.5 > results.start.pull_in.field_time + 0.05


def test_running_is_as_blank():
    blank, running = (
        run(start(replace(FAULT, begins=word), maximum_time=0.3)).events[0]
        for word in (None, "running")
    )
    assert blank.air_gap == running.air_gap
