"""Torque at the slip frequency itself, column Pulsation1, against equations of motion integrated by scipy."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.interpolate import PchipInterpolator

from engine.backlash.event_start import run_event_start
from engine.case.case import Case
from engine.case.data import MotorTorqueRow, StationRow, SupplyVoltageRow
from engine.case.effect import StartEffects
from engine.model.build_train import build_train
from engine.model.modal_train import ModalTrain
from engine.model.modes import modes_of
from engine.run import run
from engine.start.start import Start, prepared_start, starts_to_their_ends
from tests.trains import geared, peaks, prepared, started
from tests.validation.test_start_from_motor_data import between

SPEED = np.array([0.0, 0.3, 0.5, 0.8, 0.95, 1.0])
AVERAGE = np.array([9000.0, 9500.0, 10500.0, 13000.0, 11000.0, 0.0])
PULSATING = np.array([3000.0, 3500.0, 2000.0, 2500.0, 1500.0, 0.0])
AT_SLIP = np.array([6000.0, 5500.0, 6500.0, 8000.0, 6000.0, 0.0])
PAIRS, LINE, PHASE = 2, 2.0 * math.pi * 60.0, 0.8
SYNCHRONOUS = LINE / PAIRS
FREE: dict[str, Any] = {
    "damping_ratio": None, "load_torque": (), "end_speed": 170.0, "tolerance_peak": 1e-5,
    "pulsation_phase": PHASE, "torque_follows": "own speed",
}  # fmt: skip
INERTIA = np.array([50.0, 20.0 + 9.0 * 1.0, 9.0 * 4.0])
STIFFNESS = np.array([3.0e6, 9.0 * 1.0e5])


def with_curves(case: Case, at_slip: Any = AT_SLIP, pulsating: Any = PULSATING) -> Case:
    rows = zip(SPEED, AVERAGE, pulsating, at_slip, strict=True)
    return replace(
        case,
        motor_torque=tuple(
            MotorTorqueRow("Motor", *map(float, row[:3]), pulsation_1=float(row[3])) for row in rows
        ),
    )


def twist_in_time(end: float, voltage: Any = lambda x: 1.0) -> tuple[np.ndarray, np.ndarray]:
    """Times and torque of the low-speed shaft, of the motor's own angle and speed."""
    average, pulsating, at_slip = (
        PchipInterpolator(SPEED, y) for y in (AVERAGE, PULSATING, AT_SLIP)
    )

    def rate(t: float, x: np.ndarray) -> np.ndarray:
        angle, speed = x[:3], x[3:]
        own = min(max(speed[0] / SYNCHRONOUS, 0.0), 1.0)
        lag = LINE * t - PAIRS * angle[0]
        torque = average(own) + pulsating(own) * math.sin(2.0 * lag + PHASE)
        torque += at_slip(own) * math.sin(lag + 0.5 * PHASE)
        torque *= voltage(own) ** 2
        twist = STIFFNESS * (angle[:-1] - angle[1:])
        force = np.array([torque - twist[0], twist[0] - twist[1], twist[1]])
        return np.concatenate([speed, force / INERTIA])

    t = np.linspace(0.0, end, 60_001)
    path = solve_ivp(
        rate, (0.0, end), np.zeros(6), t_eval=t, method="DOP853", rtol=1e-8, atol=1e-10
    ).y
    return t, STIFFNESS[0] * (path[0] - path[1])


def judge(found: Start, twist: np.ndarray, within: float = 2e-5) -> None:
    expected = peaks(found)["Low-speed shaft"]
    assert between(twist, int(np.argmax(twist))) == pytest.approx(float(expected[0]), rel=within)
    assert between(twist, int(np.argmin(twist))) == pytest.approx(float(expected[1]), rel=within)


def test_the_start_has_torque_at_slip_frequency():
    case = with_curves(geared(**FREE))
    found = started(case)
    _, twist = twist_in_time(found.outcome.time)
    judge(found, twist)
    without = peaks(started(with_curves(geared(**FREE), np.zeros(6))))["Low-speed shaft"]
    assert np.max(np.abs(without - peaks(found)["Low-speed shaft"])) > 0.1 * np.max(twist)


def test_so_has_the_loop_with_events():
    case = with_curves(geared(**FREE))
    found = run_event_start(case, prepared(case), StartEffects())
    _, twist = twist_in_time(found.outcome.time)
    judge(found, twist)


def test_it_goes_with_the_square_of_the_voltage_against_speed():
    supplied = (SupplyVoltageRow("Motor", 0.0, 0.8), SupplyVoltageRow("Motor", 1.0, 1.0))
    case = replace(with_curves(geared(**FREE)), supply_voltage=supplied)
    found = started(case)
    voltage = PchipInterpolator([0.0, 1.0], [0.8, 1.0])
    _, twist = twist_in_time(found.outcome.time, voltage)
    judge(found, twist)


def test_several_starts_side_by_side_are_those_alone():
    cases = [with_curves(geared(**FREE), f * AT_SLIP) for f in (0.5, 0.8, 1.0, 1.2, 1.5)]
    starts = []
    for case in cases:
        modal = ModalTrain.of(case, train := build_train(case), modes_of(train))
        starts.append((prepared_start(case, modal), 2e-3))
    together = starts_to_their_ends(starts)
    for alone, (_, found) in zip(starts, together, strict=True):
        ((_, single),) = starts_to_their_ends([alone])
        assert np.array_equal(single.extremes, found.extremes)


def test_it_ends_when_the_field_is_applied():
    """One inertia: the discharge path is open from then on; speed and load angle are scipy's."""
    case = replace(
        with_curves(geared(pulsation_phase=PHASE)),
        stations=(StationRow("Motor", None, 108.0),), elements=(), load_torque=(),
        field_slip=0.06, field_time_constant=0.2, pull_out_torque=22_000.0, pull_in_damping=900.0,
    )  # fmt: skip
    found = run_event_start(case, prepared(case), StartEffects(pull_in=True))
    assert found.pull_in is not None
    average, pulsating, at_slip = (
        PchipInterpolator(SPEED, y) for y in (AVERAGE, PULSATING, AT_SLIP)
    )

    def rates(t: float, y: np.ndarray, field: float) -> list[float]:
        w, lag = y
        x = min(max(w / SYNCHRONOUS, 0.0), 1.0)
        torque = float(pulsating(x)) * math.sin(2.0 * lag)
        if t < field:
            torque += float(average(x)) + float(at_slip(x)) * math.sin(lag)
        else:
            risen = 1.0 - math.exp(-(t - field) / 0.2)
            torque += 900.0 * (SYNCHRONOUS - w) + 22_000.0 * risen * math.sin(lag)
        return [torque / 108.0, LINE - PAIRS * w]

    def reached(_: float, y: np.ndarray, field: float) -> float:
        return y[0] - 0.94 * SYNCHRONOUS

    reached.terminal = True  # type: ignore[attr-defined]
    given: dict[str, Any] = {"method": "DOP853", "rtol": 1e-10, "atol": 1e-10, "dense_output": True}
    up = solve_ivp(
        rates, (0.0, 20.0), [0.0, 0.5 * PHASE], events=reached, args=(math.inf,), **given
    )
    field = float(up.t[-1])
    assert found.pull_in.field_time == pytest.approx(field, rel=2e-6)
    end = min(found.outcome.time, field + 2.0)
    on = solve_ivp(rates, (field, end), up.y[:, -1], args=(field,), **given)
    grid = np.linspace(field, end, 300)[1:-1]
    speed = np.interp(grid, found.trajectory.time, found.trajectory.mean_speed)
    assert np.max(np.abs(speed - on.sol(grid)[0])) < 3e-5 * SYNCHRONOUS


def test_modes_below_line_frequency_are_crossed_twice():
    small = np.full(6, 200.0)
    results = run(with_curves(geared(), pulsating=small))
    line = 60.0
    found = {(c.mode, c.multiple_of_slip): c for c in results.crossings}
    first = found[1, 2].frequency
    assert set(found) == {(1, 2), (2, 2), (1, 1)}  # modes near 24 and 90 Hz
    once = found[1, 1]
    assert once.percent_speed == pytest.approx(100.0 * (1.0 - first / line), rel=1e-12)
    assert found[1, 2].percent_speed == pytest.approx(
        100.0 * (1.0 - first / (2.0 * line)), rel=1e-12
    )
    speed = 0.01 * once.percent_speed
    assert once.pulsating_torque == pytest.approx(
        float(PchipInterpolator(SPEED, AT_SLIP)(speed)), rel=1e-4
    )
    assert once.sweep_rate == pytest.approx(line * once.acceleration / SYNCHRONOUS, rel=1e-9)
    speeds = [c.percent_speed for c in results.crossings]
    assert speeds == sorted(speeds, reverse=True)
    assert "Crossed by 1 × slip frequency." in once.note
    # the mode is built up there: without the torque it stays far below
    quiet = run(with_curves(geared(), np.full(6, 60.0), small)).crossings
    low = next(c for c in quiet if (c.mode, c.multiple_of_slip) == (1, 1))
    assert once.peak_to_peak_torque > 3.0 * low.peak_to_peak_torque
    assert "still rings from before" in found[1, 2].note


def test_the_worst_phase_is_looked_for_over_two_turns():
    """At half the phase: 360 degrees turn the torque at slip frequency round."""
    case = with_curves(geared(tolerance_peak=1e-3))
    worst = run(replace(case, pulsation_phase="worst")).start
    assert worst is not None
    phases = np.arange(0.0, 4.0 * math.pi, math.pi / 9.0)
    single = [started(replace(case, pulsation_phase=float(p))) for p in phases]
    for i, peak in enumerate(worst.peaks):
        maxima = [s.peaks[i].maximum for s in single]
        assert max(maxima) <= peak.maximum + peak.error
        assert peak.maximum <= max(maxima) * 1.02
    half = len(phases) // 2
    assert max(abs(single[0].peaks[0].maximum / single[half].peaks[0].maximum - 1.0), 0.0) > 1e-3
