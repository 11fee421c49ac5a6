"""A soft starter: voltage that rises in time, beside equations of motion integrated by scipy's DOP853."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.interpolate import PchipInterpolator

from engine.backlash.event_start import run_event_start
from engine.case.case import Case
from engine.case.data import LoadTorqueRow, SupplyRow
from engine.case.effect import StartEffects
from engine.model.build_train import build_train
from engine.model.modal_analysis import analyse
from engine.model.motor import motors_of
from engine.run import run
from engine.stepping.linear_loop import turning_points
from tests.trains import geared, peaks, started
from tests.validation.test_start_from_motor_data import between, case_from_data
from tests.validation.test_start_in_time import INERTIA, LINE, PAIRS, STIFFNESS, Reference

SYNCHRONOUS = LINE / PAIRS
FREE = {"damping_ratio": None, "end_speed": 170.0, "tolerance_peak": 1e-5}
INITIAL, TIME = 0.4, 3.0


def soft(case: Case, **fields) -> Case:
    row = {"starting": "soft start", "initial_voltage": INITIAL, "ramp_time": TIME} | fields
    return replace(case, supply=(SupplyRow("Motor", **row),))


def voltage_at(t: float) -> float:
    return min(INITIAL + (1.0 - INITIAL) * t / TIME, 1.0)


def typed(case: Case):
    """Average and pulsating torque of the case against the fraction of synchronous speed. [N m]"""
    x = [row.speed for row in case.motor_torque]
    return tuple(
        PchipInterpolator(x, [getattr(row, name) for row in case.motor_torque])
        for name in ("average", "pulsating")
    )


@pytest.mark.parametrize("sticks", [False, True])
def test_voltage_against_speed_is_that_of_the_run_up(sticks):
    """The rigid train from the instant at which its torque exceeds the load."""
    stuck = (
        (LoadTorqueRow("Load", 0.0, 1000.0), LoadTorqueRow("Load", 1.0, 1000.0)) if sticks else ()
    )
    case = soft(geared(load_torque=stuck, **FREE))
    (motor,) = motors_of(case, build_train(case))
    average, _ = typed(case)
    load = 3.0 * 1000.0 if sticks else 0.0
    away = 0.0
    if sticks:
        needed = math.sqrt(load / float(average(0.0)))
        away = TIME * (needed - INITIAL) / (1.0 - INITIAL)
        assert away > 0.5
        assert motor.soft.breaks_away == pytest.approx(away, rel=0.01)

    def rate(t, speed):
        return (average(speed / SYNCHRONOUS) * voltage_at(t) ** 2 - load) / INERTIA.sum()

    t = np.linspace(away + 1e-3, 6.0, 4001)
    speed = solve_ivp(rate, (t[0], 6.0), [1e-4], t_eval=t, rtol=1e-9, atol=1e-9, max_step=0.01).y[0]
    x = np.linspace(0.03, 0.93, 50)
    expected = [voltage_at(float(np.interp(v * SYNCHRONOUS, speed, t))) for v in x]
    assert motor.soft.voltage(x) == pytest.approx(expected, abs=2e-3 if sticks else 2e-4)
    assert expected[0] < 0.9
    assert float(motor.soft.voltage(1.0)) == pytest.approx(1.0) or not sticks


def test_a_start_from_typed_curves_has_that_voltage():
    case = soft(geared(load_torque=(), pulsation_phase=0.7, **FREE))
    found = started(case)
    average, pulsating = typed(case)
    (motor,) = motors_of(case, build_train(case))

    def with_voltage(voltage):
        def rate(t, y):
            angle, speed = y[:3], y[3:]
            mean = min(max(INERTIA @ speed / INERTIA.sum() / SYNCHRONOUS, 0.0), 1.0)
            torque = average(mean) + pulsating(mean) * math.sin(
                2.0 * (LINE * t - PAIRS * angle[0]) + 0.7
            )
            torque *= voltage(t, mean) ** 2
            twist = STIFFNESS * (angle[:-1] - angle[1:])
            force = np.array([torque - twist[0], twist[0] - twist[1], twist[1]])
            return np.concatenate([speed, force / INERTIA])

        t = np.linspace(0.0, found.outcome.time, 60_001)
        path = solve_ivp(rate, (0.0, t[-1]), np.zeros(6), "DOP853", t, rtol=1e-8, atol=1e-10).y
        twist = STIFFNESS[0] * (path[0] - path[1])
        return np.array(
            [between(twist, int(np.argmax(twist))), between(twist, int(np.argmin(twist)))]
        )

    expected = peaks(found)["Low-speed shaft"]
    at_speed = with_voltage(lambda t, mean: float(motor.soft.voltage(mean)))
    assert expected == pytest.approx(at_speed, rel=5e-5)
    # in time: what the docs say of the difference
    assert expected == pytest.approx(with_voltage(lambda t, mean: voltage_at(t)), rel=0.025)


@pytest.mark.parametrize("weak", [False, True])
def test_a_start_in_time_has_the_voltage_in_time(weak):
    fields = {"short_circuit_power": 2.2e7, "x_r": 10.0} if weak else {}
    case = soft(case_from_data(load_torque=(), pulsation_phase=0.7, **FREE), **fields)
    found = run_event_start(case, analyse(case).reported, StartEffects(motor_transient=True))
    reference = Reference(case)
    (stage,) = reference.data.stages
    reference.use(stage.circuit, lambda t: 0.0)
    end, state = found.outcome.time, np.zeros(11)
    tops = []
    for first, last in ((0.0, TIME), (TIME, end)):

        def rate(t, y):
            reference.voltage = lambda x: voltage_at(t)
            return reference.rate(t, y)

        t = np.linspace(first, last, int((last - first) * LINE / 0.05))
        scale = np.concatenate([np.full(3, 1e-2), np.full(8, 1.0)])
        path = solve_ivp(rate, (first, last), state, "DOP853", t, rtol=1e-10, atol=1e-10 * scale).y
        slope = np.array([rate(a, s) for a, s in zip(t, path.T, strict=True)]).T
        state = path[:, -1]
        torque, change = (STIFFNESS[0] * (a[0] - a[1]) for a in (path, slope))
        tops += [*turning_points(t, torque, change)[1], torque[0], torque[-1]]
    assert end > TIME + 0.3
    assert peaks(found)["Low-speed shaft"] == pytest.approx([max(tops), min(tops)], rel=3e-5)
    assert INERTIA @ state[3:6] / INERTIA.sum() == pytest.approx(170.0, rel=1e-5)


def test_a_note_says_where_the_voltage_is():
    load = (LoadTorqueRow("Load", 0.0, 1000.0), LoadTorqueRow("Load", 1.0, 1500.0))
    results = run(soft(geared(load_torque=load)))
    (note,) = [w for w in results.warnings if w.startswith("Soft starter")]
    assert "breaks away" in note
    assert "not in Error" in note
    in_time = run(soft(case_from_data(load_torque=())))
    (note,) = [w for w in in_time.warnings if w.startswith("Soft starter")]
    assert note.endswith("The start has the voltage in time.")
