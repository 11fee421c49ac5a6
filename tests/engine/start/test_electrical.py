"""Electrical torques of the motor, and dampers that couple the modes, against scipy.

The references are equations of motion written out here for DOP853: torque laws from their formulas,
curves by scipy's PCHIP, damping by full matrices. They share no code with the engine.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.interpolate import PchipInterpolator
from scipy.optimize import brentq

from engine.case.case import Case
from engine.case.data import ElementRow, MotorTorqueRow, StationRow
from engine.case.effect import StartEffects
from engine.model.load import loads_of
from engine.model.modal_train import ModalTrain
from engine.model.motor import electrical_arrays, motors_of, through_synchronism
from engine.model.rigid_runup import rigid_runup
from engine.numerics.torque_curve import torque_curve
from engine.start.start import run_start
from engine.start.start_model import StartModel, start_model
from engine.stepping import linear_loop as kernels
from engine.stepping.library import struct
from tests.numerics.test_start_reference import Reference
from tests.trains import LOAD, MOTOR, RATED, geared, load, motor, prepared, started

SYNCHRONOUS = 60.0 * np.pi
LINE = 120.0 * np.pi
SHOCK = StartEffects(breaker_closing=True)
FIELD = StartEffects(breaker_closing=True, pull_in=True)
COUPLED = StartEffects(coupled_damping=True)

# --- one machine with everything electrical -------------------------------------------------------

INERTIA = 400.0
FIELD_TIME = 0.16
MACHINE: dict[str, Any] = {
    "line_frequency": 60.0,
    "poles": 4,
    "rated_torque": RATED,
    "stations": (StationRow("Motor", None, INERTIA),),
    "elements": (),
    "motor_torque": motor(),
    "load_torque": load("Motor", curve=((0.0, 0.5), (1.0, 0.5))),
    "shock_amplitude": 0.8 * RATED,
    "shock_time_constant": 0.05,
    "field_slip": 0.04,
    "field_time_constant": 0.1,
    "pull_out_torque": 2.2 * RATED,
    "pull_in_damping": 1500.0,
    "pulsation_phase": 0.4,
}


@dataclass
class Machine:
    """The swing equation of one machine, from its formulas."""

    case: Case
    polarity: float = 0.0
    trip_time: float = math.inf

    def __post_init__(self) -> None:
        rows = self.case.motor_torque
        x = [r.speed for r in rows]
        self.average = PchipInterpolator(x, [r.average for r in rows])
        self.pulsating = PchipInterpolator(x, [r.pulsating for r in rows])
        self.square = (self.case.voltage or 1.0) ** 2

    def torque(self, t: float, angle: float, speed: float, field: bool) -> float:
        """Motor torque; `angle` is the rotor's electrical lag ω_line t − pθ."""
        c, x = self.case, speed / SYNCHRONOUS
        phase = 2.0 * angle + (c.pulsation_phase or 0.0)
        if x <= 1.0 or not field:
            torque = float(self.average(min(x, 1.0)))
        else:
            torque = -float(self.average(2.0 - x))
        if field:
            if c.pull_in_damping is not None:
                torque = c.pull_in_damping * (SYNCHRONOUS - speed)
            risen = 1.0
            if c.field_time_constant:
                risen = 1.0 - math.exp(-(t - FIELD_TIME) / c.field_time_constant)
            torque += (c.pull_out_torque or 0.0) * risen * math.sin(0.5 * phase + self.polarity)
        torque += float(self.pulsating(min(x, 1.0))) * math.sin(phase)
        if c.shock_amplitude and c.shock_time_constant:
            torque += c.shock_amplitude * math.exp(-t / c.shock_time_constant) * math.sin(LINE * t)
        return self.square * torque

    def run(self, speed: float, times: np.ndarray) -> np.ndarray:
        """Speed at the times; the field comes at FIELD_TIME exactly."""
        state, found = np.array([0.0, speed]), np.zeros(0)
        for low, high, field in ((0.0, FIELD_TIME, False), (FIELD_TIME, times[-1], True)):

            def rates(t: float, y: np.ndarray, field: bool = field) -> list[float]:
                on = 1.0 if t < self.trip_time else 0.0
                net = on * self.torque(t, y[0], y[1], field) - 0.5 * RATED
                return [LINE - 2.0 * y[1], net / INERTIA]

            at = times[(times > low - 1e-9) & (times < high + 1e-9)]
            solved = solve_ivp(
                rates, (low, high), state, "DOP853", np.clip(at, low, high), rtol=1e-11,
                atol=1e-10, max_step=0.01,
            )  # fmt: skip
            state = solved.y[:, -1]
            found = np.concatenate([found[:-1], solved.y[1]])
        return found


def structs_of(model: StartModel) -> tuple[Any, Any]:
    """Motors and loads, and modes, as the loops take them."""
    return (
        kernels.drive_struct(
            model.curves, model.motors, model.loads, model.timed, model.electrical
        ),
        kernels.system_struct(
            model.stiffness,
            model.rate,
            np.ascontiguousarray(model.reach.T),
            model.mean_speed,
            model.read_speed,
            model.dampers,
        ),
    )


def simulated(
    case: Case, speed: float, h: float, end: float, polarity: float = 0.0
) -> tuple[np.ndarray, np.ndarray]:
    """Speed and rotor angle after each exponential step; one ends at FIELD_TIME."""
    train, modes, damping = prepared(case)
    motors, loads = motors_of(case, train), loads_of(case, train)
    model = start_model(case, ModalTrain(train, modes, damping), motors, loads, 1e-9, end, FIELD)
    electrical = model.electrical
    electrical[7][:] = polarity
    structs = structs_of(model)
    q, v = np.zeros(1), np.array([speed * math.sqrt(INERTIA)])
    angle = kernels.torques_struct(
        np.full((1, 1), 1.0 / math.sqrt(INERTIA)), None, np.zeros((1, 1))
    )
    phase, done = model.phase.copy(), 0
    speeds, angles = [np.array([speed])], [np.zeros(1)]
    for stop in (round(FIELD_TIME / h), round(end / h)):
        count = stop - done
        rows = {name: np.empty(count) for name in ("time", "speed")}
        rows |= {name: np.empty((1, count)) for name in ("torque", "torque_rate")}
        state = struct("state_t", q=q, v=v, phase=phase, force=np.zeros(1), force_rate=np.zeros(1))
        plan = struct(
            "stretches_t", most=1, n=np.array([1]), counts=np.array([count]), steps=np.array([h]),
            target_speed=np.array([1e9]), at=np.array([0]), taken=np.array([0]),
            time=np.array([h * done]), reason=np.array([kernels.MORE]), done=np.array([0]),
        )  # fmt: skip
        out, (drive, system) = struct("samples_t", rows=count, **rows), structs
        room = kernels.room_for(1, system, drive, angle)
        kernels.advance_starts(1, plan, system, drive, angle, state, out, room)
        speeds.append(rows["speed"])
        angles.append(rows["torque"][0])
        electrical[3][:] = FIELD_TIME
        done = stop
    return np.concatenate(speeds), np.concatenate(angles)


@pytest.mark.first_ones(1)
@pytest.mark.parametrize("polarity", [math.pi, 0.0])
@pytest.mark.parametrize("rise", [0.1, None])
def test_full_torque_law_converges_at_fourth_order(polarity: float, rise: float | None) -> None:
    case = Case(**MACHINE | {"field_time_constant": rise})
    speed, end = 0.955 * SYNCHRONOUS, 0.8
    errors = []
    for h in (4e-3, 2e-3, 1e-3):
        times = h * np.arange(round(end / h) + 1)
        truth = Machine(case, polarity).run(speed, times)
        got, _ = simulated(case, speed, h, end, polarity)
        errors.append(np.max(np.abs(got - truth)) / np.ptp(truth))
    assert errors[0] < 2e-2
    assert errors[2] < 1e-5
    for coarse, fine in zip(errors[:-1], errors[1:], strict=True):
        assert coarse / fine > 12.0


def test_without_pull_in_damping_the_average_curve_goes_on_through_synchronism() -> None:
    """Also at 90 % voltage: shock, field and curves all go with its square."""
    case = Case(**MACHINE | {"pull_in_damping": None, "voltage": 0.9})
    end, h = 1.6, 5e-4
    times = h * np.arange(round(end / h) + 1)
    truth = Machine(case).run(0.99 * SYNCHRONOUS, times)
    assert truth.max() > 1.002 * SYNCHRONOUS  # it swings through synchronism
    got, _ = simulated(case, 0.99 * SYNCHRONOUS, h, end)
    assert np.max(np.abs(got - truth)) < 2e-6 * np.ptp(truth)


def test_a_tripped_motor_gives_nothing() -> None:
    case = Case(**MACHINE)
    train, modes, damping = prepared(case)
    motors, loads = motors_of(case, train), loads_of(case, train)
    model = start_model(case, ModalTrain(train, modes, damping), motors, loads, 1e-6, 1.0, FIELD)
    model.electrical[3][:] = 0.0
    state = (np.ones(1), np.array([0.95 * SYNCHRONOUS]), np.ones(1))
    state = (*state, state[1:])
    assert kernels.start_forces(0.3, 0.3, *state, *structs_of(model))[0][0] > 0.0
    model.electrical[8][:] = 0.0
    force, rate = kernels.start_forces(0.3, 0.3, *state, *structs_of(model))
    assert force[0] == pytest.approx(-0.5 * RATED)
    assert rate[0] == 0.0


# --- the average curve with the field on ----------------------------------------------------------


def test_curve_through_synchronism_is_odd_about_it() -> None:
    x, y = np.array([r[:2] for r in MOTOR]).T
    curve = torque_curve(x, y)
    with_field = through_synchronism(curve)
    below = np.linspace(0.0, 1.0, 301)
    np.testing.assert_array_equal(with_field(below[:-1]), curve(below[:-1]))
    np.testing.assert_allclose(with_field(2.0 - below), -curve(below), rtol=0, atol=1e-14)
    assert with_field(1.0) == 0.0
    assert with_field(3.0) == pytest.approx(-0.6)  # beyond its ends constant, as any curve


@pytest.mark.parametrize("last", [(), ((1.0, 0.3),), ((1.05, 0.2),)])
def test_curve_that_is_not_zero_at_synchronism_falls_to_it_on_a_line(last: Any) -> None:
    points = np.array([(0.0, 1.0), (0.5, 1.2), (0.9, 0.8), *last])
    with_field = through_synchronism(torque_curve(points[:, 0], points[:, 1]))
    at = np.array([0.9, 0.925, 0.95, 0.975, 1.0, 1.025, 1.1])
    expected = [0.8, 0.6, 0.4, 0.2, 0.0, -0.2, -0.8]
    np.testing.assert_allclose(with_field(at), expected, atol=1e-12)


def test_a_curve_of_one_point() -> None:
    with_field = through_synchronism(torque_curve(np.array([0.0]), np.array([2.0])))
    np.testing.assert_allclose(with_field(np.array([0.0, 0.5, 1.0, 1.5, 2.0])), [2, 1, 0, -1, -2])


def test_rigid_run_up_with_field() -> None:
    """Up to field application as without; beyond, the straight line to 100 % takes its place."""
    curve = ((0.0, 0.6, 0.25), (0.95, 0.8, 0.2))
    case = geared(motor_torque=motor(curve=curve))
    train, _, _ = prepared(case)
    motors, loads = motors_of(case, train), loads_of(case, train)
    plain = rigid_runup(train, motors, loads, SYNCHRONOUS)
    field = rigid_runup(train, motors, loads, SYNCHRONOUS, field_slip=0.03)
    early = plain.speed < 0.97 * SYNCHRONOUS
    np.testing.assert_array_equal(field.time[early], plain.time[early])
    assert plain.equilibrium is None
    # 0.8 (1 − x) / 0.05 carries the load (referred: 3 × a third of rated)
    needed = PchipInterpolator(*np.array(LOAD).T)
    x = brentq(lambda x: 0.8 * (1.0 - x) / 0.05 - needed(x), 0.95, 1.0)
    assert field.equilibrium == pytest.approx(x * SYNCHRONOUS, rel=1e-6)


# --- breaker closing ------------------------------------------------------------------------------


class WithShock(Reference):
    """The reference start with the transient added at the motor."""

    amplitude, constant = 6000.0, 0.06

    def rates(self, t: float, state: np.ndarray) -> np.ndarray:
        rates = super().rates(t, state)
        i = self.motors[0][0]
        shock = self.amplitude * np.exp(-t / self.constant) * np.sin(LINE * t)
        rates[len(self.B) + i] += shock / self.J[i]
        return rates


def two_masses(**fields: Any) -> Case:
    return geared(
        stations=(StationRow("Motor", None, 50.0), StationRow("Load", None, 60.0)),
        elements=(ElementRow("Shaft", "shaft", "Motor", "Load", 2.5e6),),
        load_torque=load(),
        end_speed=0.2 * SYNCHRONOUS,
        shock_amplitude=WithShock.amplitude,
        shock_time_constant=WithShock.constant,
        **fields,
    )


@pytest.mark.first_ones(1)
@pytest.mark.parametrize("constant", [0.06, 4e-4])
def test_shock_of_a_two_mass_train(constant: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """Long and very short transients: peaks within their estimated error of scipy's."""
    monkeypatch.setattr(WithShock, "constant", constant)
    case = replace(two_masses(), shock_time_constant=constant)
    start = run_start(case, prepared(case), SHOCK)
    plain = started(case)
    times = np.linspace(0.0, start.outcome.time, 20_001)
    truth = WithShock(case).run(times[-1], times)[0]
    peak = start.peaks[0]
    allowed = peak.error + 1e-5 * np.max(np.abs(truth))
    assert start.met_tolerance
    assert abs(peak.maximum - truth.max()) <= allowed
    assert abs(peak.minimum - truth.min()) <= allowed
    # without it the answer is another one: the test can fail
    assert abs(plain.peaks[0].maximum - truth.max()) > 3.0 * allowed


def test_shock_goes_with_the_square_of_the_voltage_and_to_every_motor() -> None:
    case = two_masses(voltage=0.8)
    train, _, _ = prepared(case)
    second = (MotorTorqueRow("Load", 0.0, 1.0, 0.0), MotorTorqueRow("Load", 1.0, 0.0, 0.0))
    both = replace(case, motor_torque=case.motor_torque + second)
    arrays = electrical_arrays(motors_of(both, train), both, SHOCK)
    np.testing.assert_allclose(arrays[0], 0.64 * WithShock.amplitude * np.ones(2))
    assert not np.any(electrical_arrays(motors_of(both, train), both)[0])


# --- dampers that couple the modes ------------------------------------------------------------------


class FullyDamped(Reference):
    """The reference start with all dampers in one full matrix."""

    def __post_init__(self) -> None:
        super().__post_init__()
        c = np.array([e.damping or 0.0 for e in self.case.elements])
        ground = np.array([s.damping or 0.0 for s in self.case.stations])
        physical = (self.B.T * c) @ self.B + np.diag(ground)
        self.C = self.C + physical / self.J[:, None]


def strongly_damped(seed: int) -> Case:
    """A chain of five with dampers of very different strength, and one to ground."""
    rng = np.random.default_rng(seed)
    names = ("Motor", "A", "B", "C", "Load")
    inertia = [50.0, *rng.uniform(5.0, 30.0, 3), 60.0]
    stiffness = 10.0 ** rng.uniform(5.8, 6.6, 4)
    damping = stiffness * rng.uniform(0.0, 1.0, 4) ** 4 / 150.0
    damping[rng.integers(4)] = 0.0
    ground = [0.0, 0.0, float(rng.uniform(100.0, 400.0)), 0.0, 0.0]
    return geared(
        stations=tuple(
            StationRow(n, None, float(j), damping=c or None)
            for n, j, c in zip(names, inertia, ground, strict=True)
        ),
        elements=tuple(
            ElementRow(f"{a}-{b}", "shaft", a, b, float(k), damping=float(c))
            for a, b, k, c in zip(names[:-1], names[1:], stiffness, damping, strict=True)
        ),
        load_torque=load(),
        damping_ratio=0.002,
    )


def errors_of(start: Any, truth: np.ndarray) -> np.ndarray:
    """Error of each maximum and minimum over the largest torque of that element."""
    got = np.array([[p.maximum, p.minimum] for p in start.peaks])
    true = np.array([truth.max(axis=1), truth.min(axis=1)]).T
    return np.max(np.abs(got - true), axis=1) / np.max(np.abs(truth), axis=1)


@pytest.mark.first_ones(1)
@pytest.mark.parametrize(("seed", "end"), [(1, 0.1), (2, 0.25), (3, 0.1), (4, 0.25)])
def test_coupled_damping_against_the_full_state_space(seed: int, end: float) -> None:
    """`end` is the mean speed to which the start goes, over synchronous speed."""
    case = replace(strongly_damped(seed), end_speed=end * SYNCHRONOUS)
    start = run_start(case, prepared(case), COUPLED)
    modal = started(case)
    assert start.uncoupled_dampers == ()
    times = np.linspace(0.0, start.outcome.time, 40_001)
    truth = FullyDamped(case).run(times[-1], times)
    assert start.met_tolerance
    assert np.max(errors_of(start, truth)) <= 1e-3
    assert np.max(errors_of(modal, truth)) > 5e-3  # damping each mode for itself is not enough


@pytest.mark.slow
def test_coupled_damping_where_gears_are_rigid() -> None:
    """Dampers to ground on both gears of a rigid mesh, and the torque of the mesh itself.

    The reference has the same train referred to one speed, both gears as one body; the mesh torque
    is the balance of the pinion.
    """
    n = 3.0
    case = geared(
        stations=(
            StationRow("Motor", None, 50.0),
            StationRow("Bull gear", None, 20.0, damping=60.0),
            StationRow("Pinion", None, 1.0, n, damping=20.0),
            StationRow("Load", None, 4.0, n),
        ),
        elements=(
            ElementRow("Low-speed shaft", "shaft", "Motor", "Bull gear", 3.0e6),
            ElementRow("Mesh", "gear mesh", "Bull gear", "Pinion"),
            ElementRow("High-speed shaft", "shaft", "Pinion", "Load", 1.0e5, damping=250.0),
        ),
        end_speed=0.25 * SYNCHRONOUS,
        damping_ratio=None,
    )
    one_speed = geared(
        stations=(
            StationRow("Motor", None, 50.0),
            StationRow("Gears", None, 20.0 + n * n, damping=60.0 + n * n * 20.0),
            StationRow("Load", None, 4.0 * n * n),
        ),
        elements=(
            ElementRow("Low-speed shaft", "shaft", "Motor", "Gears", 3.0e6),
            ElementRow("High-speed shaft", "shaft", "Gears", "Load", 1e5 * n * n, damping=2250.0),
        ),
        load_torque=load(rated=RATED),
        damping_ratio=None,
    )
    start = run_start(case, prepared(case), COUPLED)
    reference = FullyDamped(one_speed)
    times = np.linspace(0.0, start.outcome.time, 40_001)
    states = states_of(reference, times)
    twist, speed = states[:2], states[2:5]
    low, high = reference.k[:, None] * twist
    viscous = 2250.0 * (speed[1] - speed[2])
    gears = (low - high - viscous - (60.0 + 180.0) * speed[1]) / reference.J[1]
    mesh = n * n * gears + high + viscous + 180.0 * speed[1]
    errors = errors_of(start, np.array([low, mesh, high / n]))
    assert np.max(errors) <= 1e-3
    assert np.max(errors_of(started(case), np.array([low, mesh, high / n]))) > 5e-3


def states_of(reference: Reference, times: np.ndarray) -> np.ndarray:
    """Twists, speeds and phase of a reference start."""
    rows, stations = reference.B.shape
    start = np.zeros(rows + stations + 1)
    return solve_ivp(
        reference.rates, (0.0, times[-1]), start, "DOP853", times, rtol=1e-10,
        atol=np.concatenate([np.full(rows, 1e-13), np.full(stations, 1e-9), [1e-10]]),
    ).y  # fmt: skip


def test_a_damper_far_too_strong_for_its_inertia_stays_modal_and_is_named() -> None:
    """2e4 N m s/rad on 0.02 kg m²: a rate of 1e6 1/s is not followed by steps of a microsecond."""
    case = geared(
        stations=(
            StationRow("Motor", None, 50.0),
            StationRow("Hub", None, 0.02, damping=20.0),
            StationRow("Load", None, 60.0),
        ),
        elements=(
            ElementRow("Motor shaft", "shaft", "Motor", "Hub", 3e6, damping=2e4),
            ElementRow("Coupling", "coupling", "Hub", "Load", 2e6, damping=500.0),
        ),
        load_torque=load(),
        end_speed=0.1 * SYNCHRONOUS,
        tolerance_peak=1e-5,
    )
    train, modes, damping = prepared(case)
    motors, loads = motors_of(case, train), loads_of(case, train)
    every = replace(COUPLED, fast_modes=True)
    model = start_model(case, ModalTrain(train, modes, damping), motors, loads, 1e-5, 5.0, every)
    assert "Motor shaft" in model.uncoupled_dampers
    assert set(model.uncoupled_dampers) < {"Motor shaft", "Coupling", "Hub (to ground)"}
    assert len(model.dampers[1]) == 3 - len(model.uncoupled_dampers)
    # what is not a force still damps the modes
    own = model.reach[:, -len(model.dampers[1]) :]
    np.testing.assert_allclose(
        model.rate + own**2 @ model.dampers[1], damping.rate, rtol=1e-9, atol=1e-9
    )
    assert run_start(case, ModalTrain(train, modes, damping), every).outcome.outcome == "reached"


def test_no_mode_is_dropped_and_no_run_cut_where_that_is_chosen() -> None:
    light = geared(
        stations=(
            StationRow("Motor", None, 50.0),
            StationRow("Hub", None, 0.05),
            StationRow("Load", None, 60.0),
        ),
        elements=(
            ElementRow("Motor shaft", "shaft", "Motor", "Hub", 3e6),
            ElementRow("Coupling", "coupling", "Hub", "Load", 2e6),
        ),
        load_torque=load(),
        end_speed=0.3 * SYNCHRONOUS,
        tolerance_peak=0.1,
    )
    found = prepared(light)
    few = run_start(light, found)
    every = run_start(light, found, StartEffects(fast_modes=True))
    assert few.kept_modes < every.kept_modes == found[1].n_modes
    assert few.truncation_error > every.truncation_error == 0.0
    for a, b in zip(few.peaks, every.peaks, strict=True):
        assert abs(a.maximum - b.maximum) <= a.error + b.error
    stalled = geared(load_torque=load(rated=RATED / 3.0, curve=((0.0, 0.1), (1.0, 1.5))))
    stalled = replace(stalled, maximum_time=30.0)
    short = started(stalled)
    long = run_start(stalled, prepared(stalled), StartEffects(full_length=True))
    assert short.outcome.time < 0.9 * 30.0
    assert long.outcome.time == pytest.approx(30.0, rel=1e-3)
    assert long.outcome.outcome == short.outcome.outcome == "stalled"
