"""Reduced voltage, aborted start and field application, whole runs against scipy's DOP853.

The equations of the motor are those of `tests.engine.start.test_electrical`, written out from their
formulas; here the field comes, and the motor trips, when a speed is reached.
"""

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
from engine.case.data import ElementRow, MeshRow, MotorTorqueRow, StationRow, TorqueTimeRow
from engine.case.effect import StartEffects
from engine.start.prescribed import run_prescribed
from engine.start.pull_in import swing_frequency_linear
from engine.start.start import Start, run_start
from tests.clearance_reference import ClearanceReference
from tests.trains import LOAD, MOTOR, RATED, geared, load, motor, peaks, prepared

SYNCHRONOUS = 60.0 * math.pi
LINE = 120.0 * math.pi


def event_start(case: Case, effects: StartEffects) -> Start:
    return run_event_start(case, prepared(case), effects)


# --- reduced voltage ------------------------------------------------------------------------------


def test_torques_go_with_the_square_of_the_voltage() -> None:
    """The same start with curves scaled by hand: every peak to rounding."""
    scaled = tuple(
        MotorTorqueRow(r.station, r.speed, 0.81 * r.average, 0.81 * r.pulsating) for r in motor()
    )
    reduced = run_start(*_with(geared(voltage=0.9)))
    by_hand = run_start(*_with(geared(motor_torque=scaled)))
    full = run_start(*_with(geared()))
    for name, found in peaks(reduced).items():
        np.testing.assert_allclose(found, peaks(by_hand)[name], rtol=1e-9)
    assert reduced.outcome.time == pytest.approx(by_hand.outcome.time, rel=1e-12)
    assert reduced.outcome.time > 1.2 * full.outcome.time


def _with(case: Case) -> tuple[Any, ...]:
    return case, prepared(case)


# --- aborted start --------------------------------------------------------------------------------


def three_inertias(**fields: Any) -> Case:
    """Motor, coupling and machine; damped by dampers alone."""
    given: dict[str, Any] = {
        "line_frequency": 60.0,
        "poles": 4,
        "rated_torque": RATED,
        "stations": (
            StationRow("Motor", None, 60.0),
            StationRow("Hub", None, 8.0),
            StationRow("Load", None, 40.0, damping=4.0),
        ),
        "elements": (
            ElementRow("Shaft", "shaft", "Motor", "Hub", 2.0e6, damping=300.0),
            ElementRow("Coupling", "shaft", "Hub", "Load", 6.0e5, damping=200.0),
        ),
        "motor_torque": motor(),
        "load_torque": load(),
        "tolerance_peak": 1e-4,
    }
    return Case(**(given | fields))


class Driven:
    """Three inertias as scipy sees them; the state is two twists, three speeds and the lag."""

    def __init__(self, case: Case) -> None:
        self.case = case
        self.train = ClearanceReference(replace(case, motor_torque=(), load_torque=()))
        self.train.motors, self.train.loads = [], []
        whole = ClearanceReference(case)
        self.loads, self.B = whole.loads, whole.B
        x = [r.speed for r in case.motor_torque]
        self.average = PchipInterpolator(x, [r.average for r in case.motor_torque])
        self.pulsating = PchipInterpolator(x, [r.pulsating for r in case.motor_torque])
        self.k, self.c, self.J = whole.k, whole.c, whole.J
        self.field_time = math.inf

    def motor_torque(self, t: float, lag: float, mean: float, connected: bool) -> float:
        if not connected:
            return 0.0
        c, x = self.case, mean / SYNCHRONOUS
        torque = float(self.pulsating(min(max(x, 0.0), 1.0))) * math.sin(2.0 * lag)
        if t <= self.field_time:
            return torque + float(self.average(min(max(x, 0.0), 1.0)))
        assert c.pull_in_damping is not None
        risen = 1.0 - math.exp(-(t - self.field_time) / (c.field_time_constant or 1e-12))
        return (
            torque
            + c.pull_in_damping * (SYNCHRONOUS - mean)
            + (c.pull_out_torque or 0.0) * risen * math.sin(lag)
        )

    def rates(self, t: float, y: np.ndarray, connected: bool) -> np.ndarray:
        rows, n = self.B.shape
        x, w, lag = y[:rows], y[rows : rows + n], y[-1]
        force = -self.B.T @ (self.k * x + self.c * (self.B @ w))
        force[0] += self.motor_torque(t, lag, self.mean(y), connected)
        for i, curve, full, soft, ends in self.loads:
            z = min(max(w[i] / soft, -1.0), 1.0)
            at = min(max(abs(w[i]) / full, ends[0]), ends[1])
            force[i] -= float(curve(at)) * z * (1.5 - 0.5 * z * z)
        return np.concatenate([self.B @ w, force / self.J, [LINE - 2.0 * w[0]]])

    def mean(self, y: np.ndarray) -> float:
        rows, n = self.B.shape
        return float(self.J @ y[rows : rows + n] / self.J.sum())

    def until(
        self, t: float, y: np.ndarray, end: float, *, speed: float | None = None,
        lag: float | None = None, connected: bool = True, rising: bool = True,
    ) -> Any:  # fmt: skip
        """To a time, or until the mean speed or the lag is reached."""

        def met(_: float, state: np.ndarray) -> float:
            if lag is not None:
                return math.sin(0.5 * (state[-1] - lag))
            return self.mean(state) - (speed if speed is not None else 1e9)

        met.terminal = True  # type: ignore[attr-defined]
        met.direction = 0.0 if lag is not None else (1.0 if rising else -1.0)  # type: ignore[attr-defined]
        return solve_ivp(
            lambda t, y: self.rates(t, y, connected), (t, end), y, "DOP853", events=met,
            rtol=1e-9, atol=1e-11, dense_output=True,
        )  # fmt: skip


@pytest.mark.slow
def test_trip_at_the_exact_speed_and_coast_down() -> None:
    trip = 0.4 * SYNCHRONOUS
    case = three_inertias(trip_speed=trip)
    found = event_start(case, StartEffects(aborted_start=True, coupled_damping=True))
    driven = Driven(case)
    rows, n = driven.B.shape
    up = driven.until(0.0, np.zeros(rows + n + 1), 10.0, speed=trip)
    down = driven.until(
        up.t[-1], up.y[:, -1], up.t[-1] + 100.0, speed=0.02 * SYNCHRONOUS, connected=False,
        rising=False,
    )  # fmt: skip
    assert found.outcome.outcome == "tripped"
    speed, time = found.trajectory.mean_speed, found.trajectory.time
    top = int(np.argmax(speed))
    assert speed[top] == pytest.approx(trip, rel=1e-9)
    assert time[top] == pytest.approx(up.t[-1], rel=1e-6)
    assert f"after {up.t[-1]:.3f} s" in found.outcome.sentence
    assert found.outcome.time == pytest.approx(min(down.t[-1], up.t[-1] + 60.0), rel=1e-5)
    grid = np.linspace(up.t[-1], min(down.t[-1], found.outcome.time), 50)[1:-1]
    truth = [driven.mean(down.sol(t)) for t in grid]
    np.testing.assert_allclose(np.interp(grid, time, speed), truth, rtol=2e-5)
    # the shafts spring back: the least torque comes after the trip
    fine = np.linspace(up.t[-1], up.t[-1] + 0.2, 4001)
    for e, name in enumerate(("Shaft", "Coupling")):
        i = [t for _, t in driven_rows(driven)].index(name)
        torque = driven.k[i] * down.sol(fine)[i]
        assert found.peaks[e].minimum == pytest.approx(
            min(float(torque.min()), driven.k[i] * float(np.min(up.y[i]))), rel=2e-3
        )


def driven_rows(driven: Driven) -> list[tuple[int, str]]:
    """Rows of the reference with their names."""
    return [(r, name) for r, (name, _) in enumerate(ClearanceReference(driven.case).names)]


# --- field application ----------------------------------------------------------------------------

FIELD: dict[str, Any] = {
    "field_slip": 0.05,
    "field_time_constant": 0.2,
    "pull_out_torque": 2.2 * RATED,
    "pull_in_damping": 900.0,
}


@pytest.mark.first_ones(1)
@pytest.mark.first_ones(2)
@pytest.mark.parametrize(
    ("inertias", "angle"),
    [(1, None), (3, 0.5), (1, 0.5), (3, None)],
)
def test_field_application_and_pull_in(inertias: int, angle: float | None) -> None:
    case = three_inertias(**FIELD, field_angle=angle)
    if inertias == 1:
        case = replace(
            case,
            stations=(StationRow("Motor", None, 108.0),),
            elements=(),
            load_torque=load("Motor"),
        )
    found = event_start(case, StartEffects(pull_in=True, coupled_damping=True))
    pull_in = found.pull_in
    assert pull_in is not None
    if inertias == 1:
        return _judge_machine(case, found, angle)
    driven = Driven(case)
    rows, n = driven.B.shape
    up = driven.until(0.0, np.zeros(rows + n + 1), 10.0, speed=0.95 * SYNCHRONOUS)
    if angle is not None:
        turned = up.y[-1, -1] - angle
        target = angle + 2.0 * math.pi * math.ceil(turned / (2.0 * math.pi))
        up = driven.until(up.t[-1], up.y[:, -1], up.t[-1] + 5.0, lag=target)
    driven.field_time = float(up.t[-1])
    on = driven.until(up.t[-1] + 1e-12, up.y[:, -1], found.outcome.time)
    _compare(case, found, driven.field_time, on.sol, driven.mean)


def _judge_machine(case: Case, found: Start, angle: float | None) -> None:
    """One inertia: the same equations with no twist."""
    average = PchipInterpolator([r[0] for r in MOTOR], [RATED * r[1] for r in MOTOR])
    pulsating = PchipInterpolator([r[0] for r in MOTOR], [RATED * r[2] for r in MOTOR])
    curve = PchipInterpolator([r[0] for r in LOAD], [RATED * r[1] for r in LOAD])
    sticking = max(curve(np.linspace(0.0, 0.05, 11)))
    soft = max(1e-3 * SYNCHRONOUS, 2e-3 * sticking / 108.0)
    state = {"field": math.inf}

    def rates(t: float, y: np.ndarray) -> list[float]:
        w, lag = y
        x = min(max(w / SYNCHRONOUS, 0.0), 1.0)
        torque = float(pulsating(x)) * math.sin(2.0 * lag)
        if t <= state["field"]:
            torque += float(average(x))
        else:
            risen = 1.0 - math.exp(-(t - state["field"]) / 0.2)
            torque += 900.0 * (SYNCHRONOUS - w) + 2.2 * RATED * risen * math.sin(lag)
        z = min(max(w / soft, -1.0), 1.0)
        torque -= float(curve(min(abs(w) / SYNCHRONOUS, 1.0))) * z * (1.5 - 0.5 * z * z)
        return [torque / 108.0, LINE - 2.0 * w]

    def reached(_: float, y: np.ndarray) -> float:
        return y[0] - 0.95 * SYNCHRONOUS

    reached.terminal, reached.direction = True, 1.0  # type: ignore[attr-defined]
    given: dict[str, Any] = {"method": "DOP853", "rtol": 1e-10, "atol": 1e-10, "dense_output": True}
    up = solve_ivp(rates, (0.0, 10.0), [0.0, 0.0], events=reached, **given)
    if angle is not None:
        turned = up.y[1, -1] - angle
        target = angle + 2.0 * math.pi * math.ceil(turned / (2.0 * math.pi))

        def there(_: float, y: np.ndarray) -> float:
            return y[1] - target

        there.terminal = True  # type: ignore[attr-defined]
        up = solve_ivp(rates, (up.t[-1], up.t[-1] + 5.0), up.y[:, -1], events=there, **given)
    state["field"] = float(up.t[-1])
    on = solve_ivp(rates, (up.t[-1] + 1e-12, found.outcome.time), up.y[:, -1], **given)
    _compare(case, found, state["field"], on.sol, lambda y: float(y[0]))


def _compare(case: Case, found: Start, field_time: float, truth: Any, mean: Any) -> None:
    """Speed and pull-in of a run against scipy's from field application on."""
    pull_in = found.pull_in
    assert pull_in is not None
    assert found.outcome.outcome == "synchronised"
    assert pull_in.field_time == pytest.approx(field_time, rel=2e-6)
    end = min(found.outcome.time, field_time + 3.0)
    grid = np.linspace(field_time, end, 400)[1:-1]
    states = [truth(t) for t in grid]
    speed = np.array([mean(y) for y in states])
    got = np.interp(grid, found.trajectory.time, found.trajectory.mean_speed)
    assert np.max(np.abs(got - speed)) < 3e-5 * SYNCHRONOUS
    assert found.load_angle is not None
    lags = np.interp(grid, found.trajectory.time, found.load_angle)
    assert np.max(np.abs(lags - [y[-1] for y in states])) < 0.02
    fine = np.linspace(field_time, found.outcome.time - 1e-6, 40_001)
    lag = truth(fine)[-1]
    well = np.floor((lag + math.pi) / (2.0 * math.pi))
    passed = np.flatnonzero(np.diff(well))
    last = float(fine[passed[-1]]) if len(passed) else field_time
    assert pull_in.pull_in_time == pytest.approx(last, abs=2e-3)
    at = float(np.interp(last, fine, lag))
    assert pull_in.pole_slips == int(abs(at - lag[0]) / (2.0 * math.pi) + 1e-9)
    settled = lag[-1] - 2.0 * math.pi * round(lag[-1] / (2.0 * math.pi))
    assert pull_in.load_angle == pytest.approx(settled, abs=0.02)
    linear = swing_frequency_linear(2.2 * RATED, 0.25 * RATED, 108.0, 2.0, 0.2 * RATED)
    assert linear is not None
    assert pull_in.swing_frequency is not None
    assert 0.5 * linear < pull_in.swing_frequency < 1.05 * linear


def test_a_weak_field_does_not_pull_in() -> None:
    case = three_inertias(**FIELD | {"pull_out_torque": 0.1 * RATED}, maximum_time=30.0)
    found = event_start(case, StartEffects(pull_in=True, coupled_damping=True))
    assert found.outcome.outcome == "not synchronised"
    assert found.pull_in is not None
    assert found.pull_in.pole_slips >= 5
    assert found.pull_in.pull_in_time is None


@pytest.mark.parametrize("trip", [0.9, 0.97])
def test_trip_before_or_after_the_field(trip: float) -> None:
    """Whichever speed is reached first comes first; a trip ends the run either way."""
    case = three_inertias(**FIELD, trip_speed=trip * SYNCHRONOUS)
    found = event_start(case, StartEffects(pull_in=True, aborted_start=True, coupled_damping=True))
    assert found.outcome.outcome == "tripped"
    assert (found.pull_in is not None) is (trip > 0.95)


# --- torque against time, with a clearance --------------------------------------------------------


def test_prescribed_torque_closes_a_clearance() -> None:
    """No motor: table TorqueTime, a torque that turns round twice."""
    knots = ((0.0, 0.0), (0.02, 2000.0), (0.05, -2000.0), (0.09, 2500.0), (0.12, 2500.0))
    case = Case(
        stations=(StationRow("a", None, 2.0), StationRow("b", None, 8.0)),
        elements=(ElementRow("gap", "coupling", "a", "b", 1e5, damping=40.0),),
        meshes=(MeshRow("gap", angular_backlash=2e-3),),
        torque_time=tuple(TorqueTimeRow("a", t, y) for t, y in knots),
        tolerance_peak=1e-4,
    )
    effects = StartEffects(clearances=("gap",), coupled_damping=True)
    linear = run_prescribed(*_with(case))
    found = run_event_start(*_with(case), effects, linear)
    times, values = (np.array(x) for x in zip(*knots, strict=True))
    reference = ClearanceReference(case)
    end = float(found.trajectory.time[-1])
    truth = reference.run(
        np.array([0.0, *times[1:-1], end]),
        torque=lambda t: np.array([np.interp(t, times, values), 0.0]),
        max_step=1e-3,
    )
    high, low = reference.peaks("gap")
    size = max(high, -low)
    assert found.peaks[0].maximum == pytest.approx(high, abs=1e-3 * size)
    assert found.peaks[0].minimum == pytest.approx(low, abs=1e-3 * size)
    met = [e for e in truth.events if e[2] == 0 and e[0] > 1e-6]
    assert found.contacts[0].impacts == len(met)
