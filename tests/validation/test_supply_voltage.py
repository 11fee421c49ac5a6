"""Voltage that rises with speed, as the line recovers from the starting current: closed forms."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.interpolate import PchipInterpolator

from engine.case.case import Case
from engine.case.data import MotorTorqueRow, SupplyVoltageRow
from engine.model.build_train import build_train
from engine.model.modal_train import ModalTrain
from engine.model.motor import motors_of
from engine.run import run
from engine.start.electrical_damping import electrical_damping_of
from tests.sample_case import sample_case
from tests.trains import geared
from tests.validation.test_start_from_motor_data import SHEET

#: The paper's Figure 2 has such a curve: a quarter of the voltage is lost at rest.
AT_REST = 0.75


def on_supply(case: Case, *points: tuple[float, float]) -> Case:
    """The case with a voltage against speed at its motor."""
    station = case.motor_stations[0]
    return replace(case, supply_voltage=tuple(SupplyVoltageRow(station, x, v) for x, v in points))


def test_run_up_time_of_a_constant_torque_on_a_rising_voltage() -> None:
    """J dω/dt = T (a + b ω/ω_s)²: t = (J ω_s / T b) (1/a − 1/(a + b x))."""
    case = sample_case("modified", load_torque=())
    rows = tuple(MotorTorqueRow("Motor", x, 58400.0, 0.0) for x in (0.0, 1.0))
    case = on_supply(replace(case, motor_torque=rows), (0.0, AT_REST), (1.0, 1.0))
    results = run(case)
    train = results.train
    inertia = sum(
        float(j) * r**2
        for j, r in zip(
            [s.inertia or 0.0 for s in case.stations], train.speed_ratio.tolist(), strict=True
        )
    )
    synchronous = case.ratings.synchronous_speed
    assert synchronous is not None
    assert results.start is not None
    rise, end = 1.0 - AT_REST, 0.97
    time = inertia * synchronous / (58400.0 * rise) * (1.0 / AT_REST - 1.0 / (AT_REST + rise * end))
    assert results.start.outcome.time == pytest.approx(time, rel=1e-4)


def test_torques_go_with_the_square_of_the_voltage_at_each_speed() -> None:
    """Curves fitted to the product meet it everywhere, also between and outside the points."""
    case = sample_case("proposed")
    train = build_train(case, {}, lateral=False)
    (full,) = motors_of(case, train)
    (one,) = motors_of(on_supply(case, (0.05, AT_REST), (0.4, 0.8), (0.93, 0.98)), train)
    x = np.linspace(0.0, 1.2, 1001)
    knots = np.array([0.05, 0.4, 0.93])
    voltage = PchipInterpolator(knots, [AT_REST, 0.8, 0.98])(np.clip(x, 0.05, 0.93))
    largest = float(np.max(full.average(x)))
    for ours, whole in zip(one.curves, full.curves, strict=True):
        assert np.max(np.abs(ours(x) - whole(x) * voltage**2)) < 3e-7 * largest


@pytest.mark.parametrize("of_data", [False, True], ids=["typed curves", "data sheet"])
def test_a_constant_voltage_is_that_of_the_scalar(of_data: bool) -> None:
    """Transient at breaker closing, pull-out torque, and what a motor with data damps of the modes, too."""
    effects: dict[str, Any] = {
        "shock_amplitude": 1e3, "shock_time_constant": 0.05, "field_slip": 0.05,
        "pull_out_torque": 3e4,
    }  # fmt: skip
    if of_data:
        effects |= {"motor_torque": (), "motor_data": (SHEET,), "torque_follows": "machine"}
    case = geared(**effects)
    scaled = run(replace(case, voltage=0.9))
    supplied = run(on_supply(case, (0.0, 0.9), (1.0, 0.9)))
    assert scaled.start is not None
    assert supplied.start is not None
    assert math.isclose(scaled.start.outcome.time, supplied.start.outcome.time, rel_tol=1e-9)
    for a, b in zip(scaled.start.peaks, supplied.start.peaks, strict=True):
        assert a.maximum == pytest.approx(b.maximum, rel=1e-8)
    real, other = (
        [
            row.real
            for row in electrical_damping_of(r.case, ModalTrain(r.train, r.modes, r.damping))
            if row.real is not None
        ]
        for r in (scaled, supplied)
    )
    assert bool(real) == of_data
    assert real == pytest.approx(other, rel=1e-12)
