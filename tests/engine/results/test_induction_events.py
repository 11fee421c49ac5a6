"""Events of induction motors in a run: what is calculated before and after them, and what is said."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from engine.case.data import MotorDataRow
from engine.run import run
from tests.engine.results.test_motor_events import air_gap, event, motor
from tests.engine.results.test_operating_events import rows
from tests.trains import RATED

SHEET = MotorDataRow(
    "Motor", "induction", 1.25 * RATED * 2.0 * math.pi * 30.0,
    r_1=0.01, x_1=0.09, xm=3.5, r_2=0.012, x_2=0.1,
)  # fmt: skip
BASE = 1.25 * RATED


def induction(*events, sheet=SHEET, **fields):
    return motor(*events, motor_data=(sheet,), motor_circuit=(), **fields)


def test_without_a_change_the_motor_keeps_its_torque():
    results = run(induction(event("voltage unbalance", residual_voltage=1.0)))
    history = results.events[0].history
    assert history.air_gap == pytest.approx(np.full(len(history.time), 0.9 * RATED), rel=1e-9)
    peaks = rows(results)["event", "Low-speed shaft"]
    assert peaks["maximum"] == pytest.approx(peaks["minimum"], rel=1e-9)


def test_the_slip_before_is_that_of_the_equivalent_circuit():
    """At it the power across the air gap, over synchronous speed, balances the running loads."""
    results = run(induction(event("voltage dip", residual_voltage=0.9)))
    s = air_gap(results)["event"]["slip"]
    assert 0.0 < s < 0.1
    rotor = SHEET.r_2 / s + 1j * SHEET.x_2
    together = 1.0 / (1.0 / rotor + 1.0 / (1j * SHEET.xm))
    voltage = together / (SHEET.r_1 + 1j * SHEET.x_1 + together)
    torque = abs(voltage / rotor) ** 2 * SHEET.r_2 / s
    assert torque * BASE == pytest.approx(0.9 * RATED, rel=1e-9)
    in_step = run(motor(event("voltage dip", residual_voltage=0.9)))
    assert air_gap(in_step)["event"]["slip"] == 0.0


def test_faults_are_near_their_closed_form():
    """The resistances take a part of the flux in the first cycle."""
    found = air_gap(run(induction(event("three-phase fault", clears_after=0.1))))["event"]
    assert found["largest"] < -3.0 * BASE
    assert 0.7 < found["ratio"] < 1.0


def test_a_rotor_that_is_open_for_long_has_no_flux_left():
    """Reclosing it then is closing a rotor without flux, whose largest torque depends on no angle."""
    later = [
        run(induction(event("reclosing", clears_after=t), sheet=replace(SHEET, r_2=0.05)))
        for t in (0.1, 1.5)
    ]
    first, second = (air_gap(r)["event"]["largest"] for r in later)
    assert abs(second) < abs(first)
    assert "out of step" not in later[1].events[0].note


def test_a_motor_that_does_not_carry_its_load_is_not_calculated():
    results = run(induction(event("three-phase fault"), sheet=replace(SHEET, x_1=0.5, x_2=0.5)))
    (found,) = results.events
    assert found.response is None
    assert "does not carry its torque in operation, 0.72 pu: it gives at most 0.4" in found.note


def test_a_motor_that_stalls_is_named():
    light = replace(SHEET, r_2=0.004, x_1=0.2, x_2=0.2)
    deep = event("voltage dip", residual_voltage=0.3, clears_after=2.0)
    results = run(induction(deep, sheet=light))
    assert "stalls the motor: after 4 s its slip is " in results.events[0].note
    assert "stalls" not in run(induction(replace(deep, clears_after=0.05))).events[0].note


def test_worst_phase_and_clearing_time_are_found():
    scanned = event("line-to-line fault", phase="worst", clears_after="worst", latest_clearing=0.1)
    largest = abs(air_gap(run(induction(scanned)))["event"]["largest"])
    for phase, clears in ((0.0, 0.05), (1.0, 0.08), (2.2, 0.013)):
        single = event("line-to-line fault", phase=phase, clears_after=clears)
        assert abs(air_gap(run(induction(single)))["event"]["largest"]) <= largest * (1.0 + 1e-6)
