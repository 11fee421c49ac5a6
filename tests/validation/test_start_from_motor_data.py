"""A start from the data sheet of a motor, against its equation of motion with the phasor torques themselves."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from engine.case.data import MotorDataRow
from engine.model.build_train import build_train
from engine.model.motor import drives_of, motors_of
from engine.motor.curves import slip_curves
from engine.motor.from_case import motors_from_data
from tests.trains import geared, peaks, started

SHEET = MotorDataRow(
    "Motor", None, 2.2e6, xd=1.3, xq=0.9, xd_transient=0.35, xd_subtransient=0.22, xq_subtransient=0.26, xl=0.12,
    td_0_transient=3.0, td_0_subtransient=0.035, tq_0_subtransient=0.12, ta=0.05, discharge_resistance=9.0,
)  # fmt: skip


def case_from_data(**fields):
    return geared(motor_torque=(), motor_data=(SHEET,), **fields)


def torque_of(case):
    """Torque of the motor at a time, an angle and a mean speed, as the specification writes it. [N m]"""
    motor = next(motors_from_data(case))
    pairs, line = 2, 2.0 * np.pi * 60.0
    x = np.linspace(0.0, 1.0, 100_001)
    curves = slip_curves(motor.starting, 1.0 - x)
    pulsation = curves.pulsating * np.exp(1j * (curves.phase - curves.phase[0]))
    torques = (case.voltage or 1.0) ** 2 * motor.torque_base * np.stack([curves.average, pulsation])

    def torque(t, angle, mean):
        at = mean * pairs / line * (len(x) - 1)
        k = int(at)
        average, turned = torques[:, k] + (at - k) * (torques[:, k + 1] - torques[:, k])
        phase = 2.0 * (line * t - pairs * angle) + (case.pulsation_phase or 0.0)
        return average.real + (turned * np.exp(1j * phase)).imag

    return torque


def between(values, k):
    """Extreme of the parabola through a sample and its neighbours."""
    before, at, after = values[k - 1 : k + 2]
    return float(at + (after - before) ** 2 / (8.0 * (2.0 * at - before - after)))


def test_the_start_uses_torques_and_their_phase():
    case = case_from_data(
        damping_ratio=None, load_torque=(), end_speed=170.0, tolerance_peak=1e-5, voltage=0.9,
        pulsation_phase=1.0,
    )  # fmt: skip
    found = started(case)
    # motor and bull gear; the pinion side referred to the motor; no damping
    inertia = np.array([50.0, 20.0 + 9.0 * 1.0, 9.0 * 4.0])
    stiffness = np.array([3.0e6, 9.0 * 1.0e5])
    torque = torque_of(case)

    def rate(t, x):
        angle, speed = x[:3], x[3:]
        twist = stiffness * (angle[:-1] - angle[1:])
        mean = (inertia @ speed) / inertia.sum()
        force = np.array([torque(t, angle[0], mean) - twist[0], twist[0] - twist[1], twist[1]])
        return np.concatenate([speed, force / inertia])

    t = np.linspace(0.0, found.outcome.time, 60_001)
    path = solve_ivp(
        rate, (0.0, t[-1]), np.zeros(6), t_eval=t, method="DOP853", rtol=1e-9, atol=1e-11
    ).y
    twist = stiffness[0] * (path[0] - path[1])
    expected = peaks(found)["Low-speed shaft"]
    assert between(twist, int(np.argmax(twist))) == pytest.approx(float(expected[0]), rel=2e-5)
    assert between(twist, int(np.argmin(twist))) == pytest.approx(float(expected[1]), rel=2e-5)
    mean = (inertia @ path[3:]) / inertia.sum()
    assert mean[-1] == pytest.approx(170.0, rel=1e-5)


def test_typed_curves_win():
    typed = geared()
    both = replace(typed, motor_data=(SHEET,))
    assert (
        peaks(started(both))["Low-speed shaft"].tolist()
        == peaks(started(typed))["Low-speed shaft"].tolist()
    )


def test_the_curves_follow_the_formula():
    """The cubics between the points, at speeds that are none of them."""
    case = case_from_data()
    motor = motors_of(case, build_train(case))[0]
    first, second = drives_of([motor])
    x = np.linspace(0.0, 1.0, 9_973)
    from_data = next(motors_from_data(case))
    exact = slip_curves(from_data.starting, 1.0 - x)
    base = from_data.torque_base
    allowed = 1e-7 * base * np.max(np.abs(exact.average))
    assert np.max(np.abs(first.average(x) - base * exact.average)) < allowed
    size = np.hypot(first.pulsating(x), second.pulsating(x))
    assert np.max(np.abs(size - base * exact.pulsating)) < allowed
    assert not np.any(second.average(x))
