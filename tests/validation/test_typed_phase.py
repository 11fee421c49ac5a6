"""A start with a typed phase of the pulsating torque, against its equation of motion."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.interpolate import PchipInterpolator

from engine.case.data import MotorTorqueRow
from engine.model.build_train import build_train
from engine.model.motor import motors_of
from engine.motor.from_case import motors_from_data
from tests.trains import geared, peaks, started
from tests.validation.test_start_from_motor_data import between, case_from_data

SPEED = np.array([0.0, 0.3, 0.5, 0.8, 0.95, 1.0])
AVERAGE = np.array([9000.0, 9500.0, 10500.0, 13000.0, 11000.0, 0.0])
PULSATING = np.array([7000.0, 7500.0, 4000.0, 5000.0, 3000.0, 0.0])
#: A notch at half speed turns the phase there. [rad]
PHASE = np.array([-1.5, -1.4, 0.6, 1.5, 2.5, 3.0])


def with_phase(case, phase=PHASE):
    columns = zip(SPEED, AVERAGE, PULSATING, phase, strict=True)
    return replace(
        case, motor_torque=tuple(MotorTorqueRow("Motor", *map(float, row)) for row in columns)
    )


def test_the_start_uses_the_phase_at_each_speed():
    case = with_phase(
        geared(
            damping_ratio=None, load_torque=(), end_speed=170.0, tolerance_peak=1e-5,
            pulsation_phase=0.4, torque_follows="own speed",
        )
    )  # fmt: skip
    found = started(case)
    inertia = np.array([50.0, 20.0 + 9.0 * 1.0, 9.0 * 4.0])
    stiffness = np.array([3.0e6, 9.0 * 1.0e5])
    average, pulsating, phase = (PchipInterpolator(SPEED, y) for y in (AVERAGE, PULSATING, PHASE))
    pairs, line = 2, 2.0 * math.pi * 60.0

    def rate(t, x):
        angle, speed = x[:3], x[3:]
        own = min(max(speed[0] * pairs / line, 0.0), 1.0)
        turned = 2.0 * (line * t - pairs * angle[0]) + 0.4 + phase(own)
        torque = average(own) + pulsating(own) * math.sin(turned)
        twist = stiffness * (angle[:-1] - angle[1:])
        force = np.array([torque - twist[0], twist[0] - twist[1], twist[1]])
        return np.concatenate([speed, force / inertia])

    t = np.linspace(0.0, found.outcome.time, 60_001)
    path = solve_ivp(
        rate, (0.0, t[-1]), np.zeros(6), t_eval=t, method="DOP853", rtol=1e-8, atol=1e-10
    ).y
    twist = stiffness[0] * (path[0] - path[1])
    expected = peaks(found)["Low-speed shaft"]
    assert between(twist, int(np.argmax(twist))) == pytest.approx(float(expected[0]), rel=2e-5)
    assert between(twist, int(np.argmin(twist))) == pytest.approx(float(expected[1]), rel=2e-5)


def test_one_phase_at_every_speed_is_that_of_the_scalar():
    case = geared()
    typed, scalar = (
        peaks(started(c))["Low-speed shaft"]
        for c in (
            with_phase(case, np.full(6, 0.7)),
            replace(with_phase(case, [0.0] * 6), pulsation_phase=0.7),
        )
    )
    assert typed == pytest.approx(scalar, rel=1e-9)


def test_curves_of_a_data_sheet_typed_with_their_phase():
    """The phase of the two-axis equations, typed point by point, gives the parts of the curves."""
    case = case_from_data(pulsation_phase=0.3)
    own = motors_of(case, build_train(case))[0]
    sheet = next(motors_from_data(case))
    x = np.linspace(0.0, 1.0, 401)
    average, sine, cosine = (curve(x) for curve in sheet.stages[0].curves[:3])
    # phase at rest is that of the scalar, for a data sheet
    phase = np.unwrap(np.arctan2(cosine, sine)) - np.arctan2(cosine[0], sine[0])
    columns = zip(x, average, np.hypot(sine, cosine), phase, strict=True)
    rows = tuple(MotorTorqueRow("Motor", *map(float, row)) for row in columns)
    typed = motors_of(replace(case, motor_data=(), motor_torque=rows), build_train(case))[0]
    fine = np.linspace(0.0, 1.0, 3001)

    def pulsation(motor):
        return sum(curve(fine) * np.exp(1j * phase) for curve, phase in motor.pulsations)

    largest = float(np.max(np.abs(pulsation(own))))
    assert np.max(np.abs(pulsation(typed) - pulsation(own))) < 2e-3 * largest
