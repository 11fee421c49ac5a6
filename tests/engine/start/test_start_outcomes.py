"""How a start ends, what drives and holds it, and what must not change it."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.special import fresnel

from engine.case.case import Case
from engine.case.data import ElementRow, LoadTorqueRow, MotorTorqueRow, StationRow, TorqueTimeRow
from engine.errors import TorsionError
from engine.model.load import loads_of
from engine.model.modal_train import ModalTrain
from engine.model.motor import motors_of
from engine.start.crossings import crossings_of
from engine.start.prescribed import run_prescribed
from engine.start.simulation import simulate
from engine.start.start import run_start
from engine.start.start_model import start_model
from tests.trains import LOAD, MOTOR, RATED, geared, load, motor, peaks, prepared, started

SYNCHRONOUS = 60.0 * math.pi


# --- outcomes -------------------------------------------------------------------------------------


def test_reached() -> None:
    start = started(geared())
    assert start.outcome.outcome == "reached"
    assert start.outcome.sentence == (
        f"97.0% speed (1746.0 rpm) reached after {start.outcome.time:.3f} s."
    )
    assert start.outcome.end_speed == pytest.approx(0.97 * SYNCHRONOUS)


def test_asynchronous() -> None:
    """Torque and load balance at 96 % speed, short of 97 %."""
    heavy = ((0.0, 0.06), (0.1, 0.02), (0.5, 0.3), (1.0, 0.68))
    start = started(geared(load_torque=load(rated=RATED / 3.0, curve=heavy)))
    assert start.outcome.outcome == "asynchronous"
    assert start.runup is not None
    assert start.runup.equilibrium is not None
    assert 0.95 < start.runup.equilibrium / SYNCHRONOUS < 0.97
    assert start.outcome.end_speed == pytest.approx(start.runup.equilibrium, rel=5e-3)
    assert "Asynchronous: torque and load balance at" in start.outcome.sentence
    assert "below the end speed of 97.0%" in start.outcome.sentence


@pytest.mark.parametrize("stall", [0.01, 0.08, 0.5, 0.9])
def test_stalled(stall: float) -> None:
    """A load that crosses the motor's torque at 1, 8, 50, 90 % speed."""
    flat = ((0.0, 0.6, 0.05), (1.0, 0.6, 0.05))
    crossing = ((0.0, 0.0), (stall, 0.6), (1.0, 2.0))
    case = geared(
        motor_torque=motor(curve=flat), load_torque=load(rated=RATED / 3.0, curve=crossing)
    )
    start = started(case)
    assert start.outcome.outcome == "stalled"
    assert start.outcome.end_speed == pytest.approx(stall * SYNCHRONOUS, rel=0.01)
    rpm = start.outcome.end_speed * 30.0 / math.pi
    assert f"Stalled: torque and load balance at {rpm:.1f} rpm" in start.outcome.sentence
    assert start.outcome.time < 60.0


def test_no_breakaway() -> None:
    sticking = ((0.0, 0.7), (0.1, 0.02), (1.0, 0.25))
    start = started(geared(load_torque=load(rated=RATED / 3.0, curve=sticking)))
    assert start.outcome.outcome == "no breakaway"
    assert start.outcome.sentence == (
        "No breakaway: at standstill the loads take 7000 N m, the motor gives 6000 N m "
        "(referred to the motor)."
    )
    assert abs(start.outcome.end_speed) < 0.01 * SYNCHRONOUS
    assert start.outcome.time == pytest.approx(2.0, abs=0.01)


def test_time_out() -> None:
    start = started(geared(maximum_time=1.0))
    assert start.outcome.outcome == "time out"
    assert start.outcome.time == pytest.approx(1.0, abs=2e-3)
    assert start.outcome.sentence.startswith("Time out: ")
    assert "after 1.00" in start.outcome.sentence


def test_the_speed_at_a_time_out_is_that_at_its_end() -> None:
    """C7. A constant torque: what T/J gains in 1 s; the mean over the last tenth would be 5 % less."""
    case = geared(
        maximum_time=1.0,
        motor_torque=motor(curve=((0.0, 0.6, 0.0), (1.0, 0.6, 0.0))),
        load_torque=(),
    )
    inertia = 50.0 + 20.0 + 9.0 * (1.0 + 4.0)
    end = started(case).outcome
    assert end.outcome == "time out"
    assert end.end_speed == pytest.approx(0.6 * RATED / inertia, rel=1e-3)


def test_the_speed_at_a_time_out_swings_with_the_pulsation() -> None:
    """A rigid train by another integrator; a line through the last tenth of the run leaves out the swing."""
    case = geared(
        maximum_time=1.0,
        motor_torque=motor(curve=((0.0, 0.6, 0.5), (1.0, 0.6, 0.5))),
        load_torque=(),
    )
    inertia = 50.0 + 20.0 + 9.0 * (1.0 + 4.0)
    stiff = tuple(replace(e, stiffness=e.stiffness and 1e3 * e.stiffness) for e in case.elements)
    end = started(replace(case, elements=stiff)).outcome

    def rates(t: float, x: np.ndarray) -> list[float]:
        pulsation = np.sin(2.0 * (120.0 * math.pi * t - 2.0 * x[0]))
        return [x[1], RATED / inertia * (0.6 + 0.5 * pulsation)]

    found = solve_ivp(rates, (0.0, end.time), [0.0, 0.0], "DOP853", rtol=1e-10, atol=1e-10)
    assert end.outcome == "time out"
    assert end.end_speed == pytest.approx(found.y[1, -1], rel=1e-4)


def test_maximum_time_is_no_reason_to_watch_a_stalled_train_for_an_hour() -> None:
    flat = ((0.0, 0.6, 0.05), (1.0, 0.6, 0.05))
    crossing = ((0.0, 0.0), (0.5, 0.6), (1.0, 2.0))
    case = geared(
        motor_torque=motor(curve=flat),
        load_torque=load(rated=RATED / 3.0, curve=crossing),
        maximum_time=3600.0,
    )
    start = started(case)
    assert start.outcome.outcome == "stalled"
    assert start.outcome.time < 60.0


def test_torque_from_a_table_may_start_what_the_motor_cannot() -> None:
    """A barring gear pushes at 2.5 s, after the motor alone would have been given up."""
    sticking = ((0.0, 0.95), (0.1, 0.02), (1.0, 0.25))
    case = geared(
        load_torque=load(rated=RATED / 3.0, curve=sticking),
        torque_time=(
            TorqueTimeRow("Motor", 2.5, 0.0),
            TorqueTimeRow("Motor", 2.6, 5000.0),
            TorqueTimeRow("Motor", 3.1, 0.0),
        ),
    )
    assert started(replace(case, torque_time=())).outcome.outcome == "no breakaway"
    assert started(case).outcome.outcome == "reached"


def test_a_slow_start_without_maximum_time_is_not_cut() -> None:
    """The load leaves 3 % of rated torque to accelerate with: slow, but it arrives."""
    case = geared(
        motor_torque=motor(curve=((0.0, 0.6, 0.05), (1.0, 0.6, 0.05))),
        load_torque=load(rated=RATED / 3.0, curve=((0.0, 0.57), (1.0, 0.57))),
        end_speed=0.5 * SYNCHRONOUS,
    )
    start = started(case)
    assert start.outcome.outcome == "reached"
    assert start.outcome.time > 20.0
    assert start.runup is not None
    assert start.outcome.time == pytest.approx(start.runup.time[-1], rel=0.05)


def test_a_motor_that_shakes_loose_is_followed_to_the_end() -> None:
    """Average torque just below the breakaway torque, pulsation above it: the simulation decides.

    Whatever it says, it is not called stalled while the train still accelerates.
    """
    case = geared(
        motor_torque=motor(curve=((0.0, 0.095, 0.5), (0.05, 0.6, 0.5), (1.0, 0.9, 0.2))),
        load_torque=load(rated=RATED / 3.0, curve=((0.0, 0.1), (0.02, 0.02), (1.0, 0.1))),
    )
    start = started(case)
    assert start.outcome.outcome in ("reached", "no breakaway")
    if start.outcome.outcome == "no breakaway":
        assert start.outcome.end_speed < 0.01 * SYNCHRONOUS


# --- loads ----------------------------------------------------------------------------------------


def test_a_load_alone_moves_nothing() -> None:
    nothing = ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0))
    case = geared(motor_torque=motor(curve=nothing), maximum_time=1.0)
    start = started(case)
    assert start.outcome.outcome == "no breakaway"
    assert np.all(start.trajectory.mean_speed == 0.0)
    assert np.all(start.trajectory.torque == 0.0)


def test_loads_only_ever_take_energy() -> None:
    """Motor off after a kick: speeds die out through zero and the load never turns anything back."""
    nothing = ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0))
    kick = (
        TorqueTimeRow("Load", 0.0, 400.0),
        TorqueTimeRow("Load", 0.02, 400.0),
        TorqueTimeRow("Load", 0.021, 0.0),
    )
    case = geared(
        motor_torque=motor(curve=nothing),
        torque_time=kick,
        load_torque=load(rated=RATED / 3.0, curve=((0.0, 0.05), (1.0, 0.05))),
        damping_ratio=None,
        maximum_time=3.0,
    )
    train, modes, damping = prepared(case)
    motors, loads = motors_of(case, train), loads_of(case, train)
    model = start_model(case, ModalTrain(train, modes, damping), motors, loads, 1e-6, 3.0)
    run = simulate(model, 2.5e-4, "exponential", 1e9, 3.0)
    late = run.time > 2.5
    assert np.max(np.abs(run.mean_speed[late])) < 1e-3 * SYNCHRONOUS
    assert np.min(run.mean_speed) > -1e-3 * SYNCHRONOUS
    # the vibration of the load's own station is taken down with it
    early = (run.time > 0.021) & (run.time < 0.2)
    assert np.max(np.abs(run.torque[:, late])) < 0.3 * np.max(np.abs(run.torque[:, early]))


def test_loads_at_several_stations_add_up() -> None:
    one = started(geared())
    split = geared(
        load_torque=load(rated=0.4 * RATED / 3.0) + load("Pinion", rated=0.6 * RATED / 3.0)
    )
    two = started(split)
    assert two.outcome.time == pytest.approx(one.outcome.time, rel=1e-3)
    assert two.outcome.time != one.outcome.time


# --- motors ---------------------------------------------------------------------------------------


def test_voltage_scales_torque_by_its_square() -> None:
    low = started(geared(voltage=0.8))
    curve = tuple((x, 0.64 * a, 0.64 * b) for x, a, b in MOTOR)
    scaled = started(geared(motor_torque=motor(curve=curve)))
    for element, value in peaks(low).items():
        np.testing.assert_allclose(value, peaks(scaled)[element], rtol=1e-9)
    assert low.outcome.time == pytest.approx(scaled.outcome.time, rel=1e-9)
    assert low.outcome.time > 1.5 * started(geared()).outcome.time


@pytest.mark.parametrize("poles", [2, 40])
def test_pulsation_has_twice_slip_frequency_whatever_the_poles(poles: int) -> None:
    synchronous = 2.0 * math.pi * 60.0 * 2 / poles
    # the same train scaled so that it runs up in the same time: torque constant, J with 1/speed
    scale = poles / 4.0
    base = geared()
    case = geared(
        poles=poles,
        stations=tuple(replace(s, inertia=scale * s.inertia) for s in base.stations),
        elements=tuple(
            replace(e, stiffness=scale * e.stiffness if e.stiffness else None)
            for e in base.elements
        ),
    )
    start, usual = started(case), started(base)
    assert case.ratings.synchronous_speed == pytest.approx(synchronous)
    assert start.outcome.time == pytest.approx(usual.outcome.time, rel=0.02)
    train, modes, damping = prepared(case)
    rows = crossings_of(case, ModalTrain(train, modes, damping), start)
    for row in rows:
        assert row.percent_speed == pytest.approx(100.0 * (1.0 - row.frequency / 120.0))
        # the crossing is where the vibration is: largest torque soon after it
        assert row.time is not None
    slow = rows[0]
    shaft = {p.element: p for p in start.peaks}["High-speed shaft"]
    assert slow.time - 0.2 < shaft.time < slow.time + 0.6


def test_two_motors_on_different_shafts_share_the_work() -> None:
    # 600 rpm, and 1800 rpm on the shaft that turns three times as fast: six and two pole pairs
    rows = motor(rated=0.5 * RATED) + motor("Load", rated=0.5 * RATED / 3.0)
    both = geared(poles=12, motor_torque=rows)
    start, one = started(both), started(geared(poles=12))
    assert start.outcome.time == pytest.approx(one.outcome.time, rel=0.01)
    assert peaks(start)["Mesh"][0] < peaks(one)["Mesh"][0]


def test_prescribed_torque_beside_the_motor() -> None:
    """A constant prescribed torque is as good as that much more average torque."""
    extra = 1000.0
    forced = geared(
        torque_time=(TorqueTimeRow("Motor", 0.0, extra), TorqueTimeRow("Motor", 100.0, extra)),
    )
    curve = tuple((x, a + extra / RATED, b) for x, a, b in MOTOR)
    same = geared(motor_torque=motor(curve=curve))
    a, b = started(forced), started(same)
    assert a.outcome.time == pytest.approx(b.outcome.time, rel=1e-6)
    for element, value in peaks(a).items():
        np.testing.assert_allclose(value, peaks(b)[element], rtol=2e-4)


def test_a_table_of_torque_is_read_without_missing_its_knots() -> None:
    """A jump, ramps and an end between steps: fourth order all the same."""
    rows = (
        TorqueTimeRow("Load", 0.1003, 500.0),
        TorqueTimeRow("Load", 0.1507, -700.0),
        TorqueTimeRow("Load", 0.2011, 0.0),
    )
    case = geared(torque_time=rows)
    train, modes, damping = prepared(case)
    motors, loads = motors_of(case, train), loads_of(case, train)
    model = start_model(case, ModalTrain(train, modes, damping), motors, loads, 1e-9, 0.5)
    model = replace(model, windows=())

    def torque(h: float) -> np.ndarray:
        run = simulate(model, h, "exponential", 1e9, 0.4)
        return run.torque[:, np.isin(run.time, [run.time[np.argmin(np.abs(run.time - 0.2011))]])]

    true = torque(1e-3 / 16.0)
    errors = [np.max(np.abs(torque(h) - true)) for h in (2e-3, 1e-3, 5e-4)]
    assert errors[0] / errors[1] > 8.0
    assert errors[1] / errors[2] > 8.0


# --- parts joined by a damper -----------------------------------------------------------------------


def fluid_coupling(c: float, **fields: object) -> Case:
    stations = (
        StationRow("Motor", None, 50.0),
        StationRow("Wheel", None, 5.0),
        StationRow("Turbine", None, 5.0),
        StationRow("Load", None, 60.0),
    )
    elements = (
        ElementRow("Motor shaft", "shaft", "Motor", "Wheel", 4e6),
        ElementRow("Fluid coupling", "coupling", "Wheel", "Turbine", 0.0, damping=c),
        ElementRow("Load shaft", "shaft", "Turbine", "Load", 2e6),
    )
    return geared(stations=stations, elements=elements, load_torque=load(), **fields)


def test_a_damper_between_two_parts_carries_the_torque() -> None:
    """A fluid coupling: the driven shaft's torque is the coupling's less its inertia share."""
    c = 500.0
    case = fluid_coupling(c)
    train, modes, damping = prepared(case)
    assert modes.n_rigid == 2
    start = run_start(case, ModalTrain(train, modes, damping))
    run = start.trajectory
    assert start.outcome.outcome == "reached"
    # slow balance at one moment: T_coupling = c Δω, and J dω/dt of the driven part + load
    coupling, shaft = run.torque[1], run.torque[2]
    smooth = np.ones(201) / 201
    k = len(run.time) // 2
    mean = [float(np.convolve(y, smooth, "same")[k]) for y in (coupling, shaft)]
    assert mean[0] > 1000.0
    # the load shaft carries all but the turbine wheel's inertia torque, 5 of 65 kg m²
    assert 0.85 < mean[1] / mean[0] < 1.0
    # halving the step changes nothing: the error estimate is met although a force is explicit
    assert start.met_tolerance


def test_a_damper_becomes_a_rigid_joint_as_it_gets_stiff() -> None:
    stiff = started(fluid_coupling(3e5, end_speed=0.3 * SYNCHRONOUS))
    base = fluid_coupling(1.0)
    solid = started(
        replace(
            base,
            end_speed=0.3 * SYNCHRONOUS,
            elements=(
                base.elements[0],
                ElementRow("Fluid coupling", "coupling", "Wheel", "Turbine", 1e11),
                base.elements[2],
            ),
        )
    )
    assert stiff.outcome.time == pytest.approx(solid.outcome.time, rel=0.01)
    late = stiff.trajectory.time > 0.5 * stiff.outcome.time
    other = solid.trajectory.time > 0.5 * solid.outcome.time
    assert np.mean(stiff.trajectory.torque[2, late]) == pytest.approx(
        np.mean(solid.trajectory.torque[2, other]), rel=0.03
    )


# --- what must not matter ---------------------------------------------------------------------------


def test_order_of_stations_and_sense_of_rows_do_not_matter() -> None:
    base = geared()
    shuffled = geared(
        stations=(base.stations[3], base.stations[1], base.stations[0], base.stations[2]),
        elements=(
            replace(base.elements[2], from_="Load", to="Pinion"),
            base.elements[1],
            replace(base.elements[0], from_="Bull gear", to="Motor"),
        ),
    )
    a, b = started(base), started(shuffled)
    assert a.outcome.time == pytest.approx(b.outcome.time, rel=1e-12)
    for element, value in peaks(a).items():
        np.testing.assert_allclose(value, peaks(b)[element], rtol=1e-9)


def test_a_mesh_is_reported_on_its_from_side() -> None:
    base = geared()
    turned = geared(
        elements=(
            base.elements[0],
            replace(base.elements[1], from_="Pinion", to="Bull gear"),
            base.elements[2],
        )
    )
    np.testing.assert_allclose(
        peaks(started(turned))["Mesh"], peaks(started(base))["Mesh"] / 3.0, rtol=1e-9
    )


def test_zero_damping_is_calculated() -> None:
    start = started(geared(damping_ratio=None))
    assert start.outcome.outcome == "reached"
    assert start.met_tolerance
    assert peaks(start)["Mesh"][0] > peaks(started(geared()))["Mesh"][0]


@pytest.mark.parametrize(("base", "at"), [(geared(), "Load"), (fluid_coupling(100.0), "Motor")])
def test_a_motor_held_to_ground_is_refused(base: Case, at: str) -> None:
    spring = ElementRow("Torque arm", "spring to ground", at, "ground", 1e5)
    with pytest.raises(TorsionError, match="cannot start"):
        started(replace(base, elements=(*base.elements, spring)))


def test_prescribed_torque_on_a_link_of_1e16_ends() -> None:
    base = geared()
    case = replace(
        base,
        motor_torque=(),
        load_torque=(),
        damping_ratio=None,
        elements=(replace(base.elements[0], stiffness=1e16), *base.elements[1:]),
        torque_time=(TorqueTimeRow("Motor", 0.0, 100.0), TorqueTimeRow("Motor", 5.0, 0.0)),
    )
    start = run_prescribed(case, prepared(case))
    assert start.trajectory.n_steps < 200_000
    assert start.kept_modes == 2
    shaft = start.peaks[0]
    assert 0.0 < start.truncation_error <= start.estimated_error
    assert shaft.error < shaft.maximum


def test_the_time_of_a_peak_is_that_of_its_larger_magnitude() -> None:
    """A step of −T on a free pair: its shaft swings farthest half a damped period later."""
    zeta, f = 0.05, 25.0
    k = (2.0 * math.pi * f) ** 2 * 50.0 * 40.0 / 90.0
    case = geared(
        stations=(StationRow("Motor", None, 50.0), StationRow("Load", None, 40.0)),
        elements=(ElementRow("Shaft", "shaft", "Motor", "Load", k),),
        damping_ratio=zeta,
        motor_torque=(),
        load_torque=(),
        torque_time=(TorqueTimeRow("Motor", 0.0, -900.0), TorqueTimeRow("Motor", 0.3, -900.0)),
    )
    (peak,) = run_prescribed(case, prepared(case)).peaks
    assert -peak.minimum > 700.0 > peak.maximum
    assert peak.time == pytest.approx(0.5 / f / math.sqrt(1.0 - zeta**2), rel=1e-3)


# --- modes at twice line frequency --------------------------------------------------------------------


def tuned(frequency: float) -> Case:
    """Motor and load with one mode at `frequency`."""
    reduced = 50.0 * 40.0 / 90.0
    return geared(
        stations=(StationRow("Motor", None, 50.0), StationRow("Load", None, 40.0)),
        elements=(
            ElementRow("Shaft", "shaft", "Motor", "Load", reduced * (2 * math.pi * frequency) ** 2),
        ),
        load_torque=load(),
    )


@pytest.mark.parametrize(
    ("frequency", "flagged", "percent"),
    [(100.0, False, 16.667), (109.0, True, 9.1667), (120.0, True, 0.0), (131.0, True, None)],
)
def test_modes_near_twice_line_are_flagged(
    frequency: float, flagged: bool, percent: float | None
) -> None:
    case = tuned(frequency)
    train, modes, damping = prepared(case)
    start = started(case)
    (row,) = crossings_of(case, ModalTrain(train, modes, damping), start)
    assert ("breaker closing" in row.note) is flagged
    assert row.percent_speed == (None if percent is None else pytest.approx(percent, abs=1e-3))
    assert (row.time is None) is (percent is None)
    if frequency == 120.0:
        assert row.time == pytest.approx(0.0, abs=5e-3)
    assert row.peak_to_peak_torque is not None


def beside_each_other() -> Case:
    """Two shafts on one heavy motor: modes of 60 and 68 Hz, nearer than where a sweep builds up."""
    near = (("Shaft", "Load", 4.0, 60.0), ("Stub", "Exciter", 12.0, 67.0))
    return geared(
        stations=(
            StationRow("Motor", None, 300.0),
            *(StationRow(station, None, inertia) for _, station, inertia, _ in near),
        ),
        elements=tuple(
            ElementRow(name, "shaft", "Motor", station, inertia * (2.0 * math.pi * f) ** 2)
            for name, station, inertia, f in near
        ),
        load_torque=load(),
    )


@pytest.mark.parametrize("case", [geared(), beside_each_other()], ids=["far apart", "near"])
def test_each_crossing_tells_the_torques_while_the_pulsation_is_near_it(case: Case) -> None:
    """From 1.1 f, or half-way to the next mode above, to half-way to the next below; worst by power."""
    modal, start = prepared(case), started(case)
    rows = crossings_of(case, modal, start)
    f = [row.frequency for row in rows]
    assert len(f) == 2
    half_way = math.sqrt(f[0] * f[1])
    spans = ((0.0, min(1.1 * f[0], half_way)), (half_way, 1.1 * f[1]))
    ratio = {"High-speed shaft": 3.0}
    for row, (lowest, highest) in zip(rows, spans, strict=True):
        inside = {}
        for e, (when, torque) in start.turning_of_element().items():
            speed = np.interp(when, start.trajectory.time, start.trajectory.mean_speed)
            pulsation = 120.0 * (1.0 - speed / SYNCHRONOUS)
            inside[case.elements[e].element] = torque[
                (pulsation >= lowest) & (pulsation <= highest)
            ]
        power = {name: ratio.get(str(name), 1.0) * np.ptp(t) for name, t in inside.items()}
        assert row.governing_element == max(power, key=power.__getitem__)
        assert row.peak_to_peak_torque == pytest.approx(np.ptp(inside[row.governing_element]))
        if "Mesh" in inside:
            assert row.mesh_minimum_torque == pytest.approx(inside["Mesh"].min())


def test_a_crossing_names_what_a_sweep_can_build_up_at_most() -> None:
    """Undamped and swept at constant rate: π f/√ḟ times the largest distance on Cornu's spiral, over √2."""
    S, C = fresnel(np.linspace(0.5, 2.0, 150_001))
    lewis = math.pi * float(np.max(np.hypot(C + 0.5, S + 0.5))) / math.sqrt(2.0)
    case = geared()
    rows = crossings_of(case, prepared(case), started(case))
    assert len(rows) == 2
    for row in rows:
        assert row.sweep_rate is not None
        limit = lewis * row.frequency / math.sqrt(row.sweep_rate)
        assert row.note.startswith(f"{0.5 / 0.01:.3g} × dwelling, {limit:.3g} × swept undamped: ")
        assert row.amplification is not None
        assert row.amplification < min(limit, 0.5 / 0.01)
        assert f"acceleration takes off {1.0 - row.amplification / (0.5 / 0.01):.0%}." in row.note


def test_a_mode_well_above_twice_line_has_no_row() -> None:
    case = tuned(140.0)
    train, modes, damping = prepared(case)
    assert not crossings_of(case, ModalTrain(train, modes, damping), started(case))


def test_curves_used_here_are_the_tables() -> None:
    assert motor()[0] == MotorTorqueRow("Motor", 0.0, 6000.0, 2500.0)
    assert load()[-1] == LoadTorqueRow("Load", LOAD[-1][0], 2500.0)


def test_torque_that_rises_faster_than_a_mode_is_damped_is_warned_about():
    from sample_case import sample_case

    from engine.run import run

    said = "rises with speed so steeply that it can feed mode 1 "
    assert not any(said in w for w in run(sample_case("modified")).warnings)
    undamped = run(sample_case("modified", damping_ratio=0.0)).warnings
    assert any(said in w for w in undamped)
