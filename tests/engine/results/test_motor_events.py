"""Events of motors in a run: air-gap torque, peaks and verdicts; what is not calculated is said."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from engine.case.case import Case
from engine.case.data import (
    EffectChoiceRow,
    MotorCircuitRow,
    MotorDataRow,
    MotorEventRow,
    StationRow,
)
from engine.results.results import Results
from engine.results.tables import Row, result_tables
from engine.run import run
from tests.engine.results.test_operating_events import check, rows, train, with_backlash
from tests.trains import RATED, geared

#: 1 per unit of torque is 1.25 times the rated torque.
SHEET = MotorDataRow("Motor", None, 1.25 * RATED * 2.0 * math.pi * 30.0, power_factor=0.9)
CIRCUIT = MotorCircuitRow(
    "Motor", 0.0076, 0.12, 0.73, 0.36, 0.00041, 0.2049, 0.0141, 0.16, 0.0136, 0.1029
)
BASE = 1.25 * RATED


def motor(*events: MotorEventRow, **fields: object) -> Case:
    given: dict[str, object] = {
        "motor_torque": (), "motor_data": (SHEET,), "motor_circuit": (CIRCUIT,), "motor_events": events,
    }  # fmt: skip
    return train(**(given | fields))


def event(kind: str, name: str = "event", **fields: object) -> MotorEventRow:
    return MotorEventRow(name, "Motor", kind, **fields)


def air_gap(results: Results) -> dict[str, Row]:
    return {row["event"]: row for row in result_tables(results)["AirGapTorque"]}


FAULT = event("three-phase fault")
#: Keeps all teeth in contact.
DIP = event("voltage dip", "dip", residual_voltage=0.97, clears_after=0.1)


@pytest.fixture(scope="module")
def several() -> Results:
    return run(
        motor(
            event("three-phase fault", "fault"),
            event("out-of-phase closing", "closing", angle=math.radians(120.0)),
            event("reclosing", "at once", angle=math.radians(120.0), residual_voltage=1.0),
            event("reclosing", "later", clears_after=0.15),
            DIP,
        )
    )


def test_largest_torques_are_near_their_closed_forms(several):
    """The resistances take some per cent of the flux in the first cycle."""
    found = air_gap(several)
    assert list(found) == ["start", "fault", "closing", "at once", "later", "dip"]
    assert found["fault"]["largest"] < -4.0 * BASE
    for name in ("fault", "closing", "at once"):
        assert 0.9 < found[name]["ratio"] < 1.05
        assert abs(found[name]["largest"]) == found[name]["ratio"] * found[name]["closed_form"]
    assert "closed_form" not in found["later"] or found["later"]["closed_form"] is None


def test_closing_at_120_degrees_is_the_worst_of_all(several):
    """2.598 / X'' of equal subtransient reactances, E = V."""
    subtransient = 0.12 + 1.0 / (1.0 / 0.73 + 1.0 / 0.2049 + 1.0 / 0.16)
    expected = 1.5 * math.sqrt(3.0) / subtransient * BASE
    assert air_gap(several)["closing"]["closed_form"] == pytest.approx(expected, rel=2e-4)


def test_peaks_begin_with_the_torques_in_operation(several):
    peaks = rows(several)
    dip = peaks["dip", "Low-speed shaft"]
    assert dip["minimum"] < 0.9 * RATED < dip["maximum"]
    assert peaks["fault", "Low-speed shaft"]["maximum"] > dip["maximum"]
    assert check(several, "Shear yield in events").verdict == "fail"


def test_a_heavy_train_gives_the_torque_of_constant_speed():
    """Without motion the largest torque does not depend on the train."""
    heavy = [
        air_gap(run(motor(FAULT, stations=(
            *(replace(s, inertia=scale * s.inertia) for s in train().stations[:-1]),
            StationRow("Load", None, scale * 4.0, 3.0, running_load=0.9 * RATED / 3.0),
        ), maximum_time=0.05)))["event"]["largest"]
        for scale in (1e6, 1e7)
    ]  # fmt: skip
    assert heavy[0] == pytest.approx(heavy[1], rel=1e-5)


@pytest.mark.parametrize("kind", ["three-phase fault", "out-of-phase closing", "reclosing"])
def test_teeth_that_separate_meet_again(kind):
    no_table = {"event_torque": (), "motor_torque": ()}
    more = {"out-of-phase closing": {"angle": 2.0}, "reclosing": {"clears_after": 0.1}}
    shock = event(kind, **more.get(kind, {"clears_after": 0.1}))
    loose = with_backlash(
        **no_table, motor_data=(SHEET,), motor_circuit=(CIRCUIT,), motor_events=(shock,)
    )
    results = run(loose)
    (found,) = results.events
    assert "not calculated" not in found.note
    assert found.response.contacts[0].back_impacts > 0
    assert rows(results)["event", "Mesh"]["minimum"] < 0.0
    together = run(replace(loose, effect_choices=(EffectChoiceRow("backlash", "off"),)))
    assert rows(together)["event", "Mesh"]["minimum"] < 0.0
    assert together.events[0].response.left_out is None
    apart, closed = (air_gap(r)["event"] for r in (results, together))
    assert apart["closed_form"] == closed["closed_form"]
    # until teeth separate both motors give the same torque
    a, b = (r.events[0].history for r in (results, together))
    until = 0.002
    first = a.time < until
    assert np.interp(a.time[first], b.time, b.air_gap) == pytest.approx(
        a.air_gap[first], abs=2e-3 * BASE
    )


def test_what_is_not_known_with_teeth_apart_is_said():
    no_table = {"event_torque": (), "motor_torque": ()}
    shock = event("three-phase fault", clears_after="worst", latest_clearing=0.02)
    loose = with_backlash(
        **no_table, motor_data=(SHEET,), motor_circuit=(CIRCUIT,), motor_events=(shock,)
    )
    (found,) = run(loose).events
    assert "another one may be larger" in found.note
    assert found.response.left_out is None


def test_teeth_that_stay_together_are_not_simulated_apart():
    no_table = {"event_torque": (), "motor_torque": ()}
    shaken = run(
        with_backlash(
            **no_table, motor_data=(SHEET,), motor_circuit=(CIRCUIT,), motor_events=(DIP,)
        )
    )
    assert rows(shaken)["dip", "Mesh"]["minimum"] > 0.0
    assert shaken.events[0].response.contacts == ()


def test_a_start_in_time_has_its_air_gap_torque():
    case = replace(geared(), motor_torque=(), motor_data=(SHEET,), motor_circuit=(CIRCUIT,))
    on, off = (
        run(replace(case, effect_choices=(EffectChoiceRow("motor transient", choice),)))
        for choice in ("on", "off")
    )
    found = air_gap(on)["start"]
    at_rest = result_tables(on)["MotorCurves"][0]
    assert found["largest"] > 1.1 * (at_rest["average"] + at_rest["pulsating"])
    assert 0.0 < found["time"] < 0.2
    assert air_gap(off) == {}
    assert on.plans[-1].decision("motor transient").on
    assert not off.plans[-1].decision("motor transient").on
    assert off.start.left_out is None  # forced off although required: no bound


def test_a_motor_that_loses_its_step_says_so():
    long = event("three-phase fault", clears_after=0.6)
    (found,) = run(motor(long)).events
    assert "out of step" in found.note
    (short,) = run(motor(replace(long, clears_after=0.02))).events
    assert "out of step" not in short.note


def test_a_motor_that_cannot_carry_its_load_is_not_calculated():
    results = run(motor(DIP, motor_circuit=(replace(CIRCUIT, rs=0.9),)))
    assert results.events[0].response is None
    assert (
        "is not calculated: the motor at 'Motor' does not carry its torque in operation"
        in results.events[0].note
    )


def test_the_field_of_the_motor_follows_from_its_power_factor():
    """A leading current takes more excitation than one in phase, a lagging one less."""
    lagging, weak, strong = (
        abs(
            air_gap(run(motor(FAULT, motor_data=(replace(SHEET, power_factor=pf),))))["event"][
                "largest"
            ]
        )
        for pf in (-0.8, 1.0, 0.8)
    )
    assert strong > 1.05 * weak > 1.05 * lagging


def test_one_phase_as_before_is_no_event():
    """A whole voltage shakes nothing, whatever its phase."""
    results = run(motor(event("voltage unbalance", residual_voltage=1.0, phase=1.0)))
    assert air_gap(results)["event"]["largest"] == pytest.approx(0.9 * RATED, rel=1e-6)
    peak = rows(results)["event", "Low-speed shaft"]
    assert peak["maximum"] == pytest.approx(0.9 * RATED, rel=1e-6)
    assert peak["minimum"] == pytest.approx(0.9 * RATED, rel=1e-6)


@pytest.mark.parametrize("share", [1e-2, 1e-3])
def test_a_light_rotor_needs_shorter_steps_only(share):
    """The motor alone swings with hundreds of hertz against its shaft."""
    stations = motor(DIP).stations
    light = replace(stations[0], inertia=share * stations[0].inertia)
    (found,) = run(motor(DIP, stations=(light, *stations[1:]))).events
    assert found.response.met_tolerance
    assert found.response.step < 1e-4
    assert found.air_gap.error < 1e-4


def test_a_stiff_link_does_not_matter():
    """A shaft of 1e14 N m/rad as one of 1e10: the same torques."""
    elements = train().elements
    peaks = [
        rows(run(motor(DIP, elements=(*elements[:2], replace(elements[2], stiffness=stiffness)))))[
            "dip", "Low-speed shaft"
        ]["maximum"]
        for stiffness in (1e10, 1e14)
    ]
    assert peaks[0] == pytest.approx(peaks[1], rel=1e-4)


def test_what_comes_after_an_early_end_has_no_bound():
    results = run(motor(replace(FAULT, clears_after=0.1), maximum_time=0.05))
    assert results.events[0].response.left_out is None
    assert "is followed to MaximumTime, 0.05 s" in results.events[0].note


def test_a_second_motor_keeps_its_torque():
    """It carries its share of the load before and during the event of the first."""
    two = {
        "motor_data": (SHEET, replace(SHEET, station="Bull gear")),
        "motor_circuit": (CIRCUIT, replace(CIRCUIT, station="Bull gear")),
    }
    steady = event("voltage unbalance", residual_voltage=1.0)
    (found,) = run(motor(steady, **two)).events
    assert 0.3 * RATED < found.air_gap.largest < 0.6 * RATED
    (alone,) = run(motor(steady)).events
    assert alone.air_gap.largest == pytest.approx(0.9 * RATED, rel=1e-6)
