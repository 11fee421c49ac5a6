"""The two-axis machine in time, on a rotor whose speed stays and on rigid trains.

SM01        motor without a field started direct on line (Modelica Standard Library 4.0, SMR_DOL, published series)
SM03        closing out of phase
IM_krause   induction motors started direct on line (equal axes, one cage)
Closed forms at zero resistance: constant flux linkages (Concordia, Synchronous machines, 1951, chapter 5).
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from cases import load_case
from scipy.interpolate import CubicHermiteSpline

from engine.case.case import Case
from engine.case.data import StationRow
from engine.motor.circuit import Circuit, Winding
from engine.motor.curves import slip_curves
from engine.motor.fault_torques import (
    fault_torque,
    largest_line_to_line,
    largest_of_constant_fluxes,
)
from engine.motor.two_axis import MachineState, flux_system, open_circuit_state, running_state
from engine.start.machine_motion import Balance, Machine, MachineMotion, Supply, machine_motion
from engine.start.time_response import ModalSystem, modal_system
from engine.stepping.linear_loop import turning_points
from tests.trains import prepared

LINE = 2.0 * math.pi * 60.0
FAULT = Supply(0.0, (0.0, 0.0))
#: Machine of SM03: reactances Xd'' and Xq'' differ by 1.4e-4.
CIRCUIT = Circuit(
    0.0019, 0.12, 0.73, 0.36, Winding(0.00041, 0.2049), (Winding(0.0141, 0.16),),
    (Winding(0.0136, 0.1029),),
)  # fmt: skip
#: With a weaker damper between the poles: Xq'' is half as large again as Xd''.
UNEQUAL = replace(CIRCUIT, dampers_q=(Winding(0.0136, 0.25),))


def lossless(circuit: Circuit) -> Circuit:
    def bare(windings: tuple[Winding, ...]) -> tuple[Winding, ...]:
        return tuple(Winding(0.0, w.leakage) for w in windings)

    return replace(
        circuit, stator_resistance=0.0, field=Winding(0.0, circuit.field.leakage),
        dampers_d=bare(circuit.dampers_d), dampers_q=bare(circuit.dampers_q),
    )  # fmt: skip


def rigid(inertia: float, *, turns: bool = True) -> ModalSystem:
    """One disc; `turns`: False keeps its speed whatever the torque."""
    case = Case(line_frequency=60.0, poles=2, stations=(StationRow("Motor", None, inertia),))
    train, modes, _ = prepared(case)
    return modal_system(train, modes, np.array([0]), None, np.full(1, turns))


STEADY = rigid(1.0, turns=False)
PER_UNIT = Machine(CIRCUIT, 1.0, LINE, LINE)


def at_constant_speed(
    circuit: Circuit, supplies: list[Supply], state: MachineState, end: float, step: float = 0.1
) -> MachineMotion:
    machine = replace(PER_UNIT, circuit=circuit)
    return machine_motion(STEADY, machine, supplies, state, end, step / LINE, balance=Balance(0.0))


def largest(motion: MachineMotion) -> tuple[float, float]:
    """Largest torque in magnitude, also between samples, and when."""
    when, value = turning_points(motion.time, motion.torque, motion.torque_rate)
    i = int(np.argmax(np.abs(value)))
    return float(value[i]), float(when[i])


def sampled(motion: MachineMotion) -> CubicHermiteSpline:
    """The torque between samples: references are sampled at times of their own."""
    return CubicHermiteSpline(motion.time, motion.torque, motion.torque_rate)


def subtransient(circuit: Circuit) -> tuple[float, float]:
    d = [circuit.magnetising_d, circuit.field.leakage, *(w.leakage for w in circuit.dampers_d)]
    q = [circuit.magnetising_q, *(w.leakage for w in circuit.dampers_q)]
    return tuple(circuit.stator_leakage + 1.0 / sum(1.0 / x for x in axis) for axis in (d, q))


# --- running, and closing out of phase --------------------------------------------------------------


@pytest.mark.parametrize("torque", [0.0, 0.7, 1.1, -0.4])
@pytest.mark.parametrize("power_factor", [1.0, 0.8, -0.9])
def test_a_running_machine_stays_as_it_is(torque, power_factor):
    state = running_state(CIRCUIT, torque, power_factor)
    system = flux_system(CIRCUIT, LINE, 1.0, state.field_voltage, is_open=False)
    voltage = np.array([math.cos(state.angle), -math.sin(state.angle)])
    slope = system.rate @ state.flux + system.voltage @ voltage + system.field
    assert np.max(np.abs(slope)) < 1e-12 * LINE
    current = system.stator_current @ state.flux
    assert state.flux[0] * current[1] - state.flux[system.q] * current[0] == pytest.approx(
        torque, abs=1e-13
    )
    motion = at_constant_speed(CIRCUIT, [Supply(0.0)], state, 0.2)
    assert np.max(np.abs(motion.torque - torque)) < 1e-11


@pytest.mark.parametrize(
    "row", load_case("SM03")["rows"], ids=lambda row: f"{row['angle_deg']} degrees"
)
def test_closing_out_of_phase(row):
    state = open_circuit_state(CIRCUIT, 1.0, math.radians(row["angle_deg"]))
    torque, when = largest(at_constant_speed(CIRCUIT, [Supply(0.0)], state, 0.05))
    assert -torque == pytest.approx(row["with_resistance"], rel=1e-6)  # the rotor ahead: it brakes
    assert when == pytest.approx(row["time"], abs=1e-5)  # sampled so


# --- closed forms ------------------------------------------------------------------------------------


@pytest.mark.parametrize("circuit", [CIRCUIT, UNEQUAL], ids=["equal axes", "unequal axes"])
@pytest.mark.parametrize("load", [0.0, 0.9])
def test_three_phase_fault_without_resistance(circuit, load):
    bare = lossless(circuit)
    state = running_state(bare, load, 0.9)
    motion = at_constant_speed(bare, [FAULT], state, 0.1)
    xd, xq = subtransient(bare)
    system = flux_system(bare, LINE, 1.0, 0.0, is_open=False)
    i_d, i_q = system.stator_current @ state.flux
    behind = state.flux[0] - xd * i_d, state.flux[system.q] - xq * i_q
    flux = complex(state.flux[0], state.flux[system.q]) * np.exp(-1j * LINE * motion.time)
    exact = flux.real * (flux.imag - behind[1]) / xq - flux.imag * (flux.real - behind[0]) / xd
    assert np.max(np.abs(motion.torque - exact)) < 1e-8
    if load == 0.0:
        t = LINE * motion.time
        published = -(np.sin(t) / xd - 0.5 * (1.0 / xd - 1.0 / xq) * np.sin(2.0 * t))
        assert np.max(np.abs(motion.torque - published)) < 1e-8


@pytest.mark.parametrize("circuit", [CIRCUIT, UNEQUAL], ids=["equal axes", "unequal axes"])
@pytest.mark.parametrize("phase", [0.0, 0.6, 0.5 * math.pi])
def test_line_to_line_fault_without_resistance(circuit, phase):
    """Of the stator's flux one part stays, the other follows the voltage of the healthy phase."""
    bare = lossless(circuit)
    state = running_state(bare, 0.8, 0.9)
    fault = Supply(0.0, (0.5, 0.0), (0.5, -2.0 * phase))
    motion = at_constant_speed(bare, [fault], state, 0.1, 0.02)
    xd, xq = subtransient(bare)
    system = flux_system(bare, LINE, 1.0, 0.0, is_open=False)
    i_d, i_q = system.stator_current @ state.flux
    behind = state.flux[0] - xd * i_d, state.flux[system.q] - xq * i_q
    t = LINE * motion.time
    axis = np.exp(-1j * phase)  # of the healthy phase, where the voltage is e^(jω₀t)
    stator = complex(state.flux[0], state.flux[system.q]) * np.exp(1j * state.angle)
    stator = stator + axis * (np.sin(t + phase) - np.sin(phase))
    flux = stator * np.exp(-1j * (state.angle + t))
    exact = flux.real * (flux.imag - behind[1]) / xq - flux.imag * (flux.real - behind[0]) / xd
    assert np.max(np.abs(motion.torque - exact)) < 1e-8


@pytest.mark.parametrize("circuit", [CIRCUIT, UNEQUAL], ids=["equal axes", "unequal axes"])
@pytest.mark.parametrize("phase", [0.0, 0.6, 0.5 * math.pi])
def test_line_to_line_fault_of_a_motor_off_the_line(circuit, phase):
    """i = E (sin θ₀ − sin θ) / (Xd'' sin² θ + Xq'' cos² θ), T = i E cos θ + (Xd'' − Xq'') i² sin θ cos θ."""
    bare, voltage = lossless(circuit), 0.9
    state = open_circuit_state(bare, voltage, 0.0)
    motion = at_constant_speed(bare, [Supply(0.0, (0.0, 0.0), axis=-phase)], state, 0.1, 0.01)
    xd, xq = subtransient(bare)
    first = phase + 0.5 * math.pi
    sine, cosine = np.sin(first + LINE * motion.time), np.cos(first + LINE * motion.time)
    i = voltage * (math.sin(first) - sine) / (xd * sine**2 + xq * cosine**2)
    exact = i * voltage * cosine + (xd - xq) * i * i * sine * cosine
    assert np.max(np.abs(motion.torque - exact)) < 1e-8
    assert np.max(np.abs(motion.torque)) == pytest.approx(
        voltage**2 * largest_line_to_line(xd, xq, first), rel=1e-4
    )


@pytest.mark.parametrize(
    "supply", [FAULT, Supply(0.0, (0.5, 0.0), (0.5, -1.2)), Supply(0.0, (0.9, 0.2), (0.1, 2.0))]
)
def test_largest_torque_of_constant_fluxes(supply):
    """The formula beside the equations in time, for any voltages."""
    bare = lossless(UNEQUAL)
    state = running_state(bare, 0.8, 0.9)
    motion = at_constant_speed(bare, [supply], state, 2.0 * math.pi / LINE, 0.01)
    (size, ahead), (against, back) = supply.forward, supply.backward
    closed = largest_of_constant_fluxes(
        bare, state.flux, (size, ahead - state.angle), (against, back - state.angle)
    )
    assert closed == pytest.approx(abs(largest(motion)[0]), rel=1e-6)


@pytest.mark.parametrize("degrees", [100.0, -40.0])
def test_closing_without_resistance(degrees):
    bare, angle = lossless(UNEQUAL), math.radians(degrees)
    motion = at_constant_speed(bare, [Supply(0.0)], open_circuit_state(bare, 1.0, angle), 0.05)
    turned = LINE * motion.time
    exact = fault_torque(
        "out-of-phase closing", *subtransient(bare), turned, np.full(len(turned), angle)
    )
    assert np.max(np.abs(motion.torque - exact)) < 1e-8


def test_reclosing_at_once_keeps_the_fluxes_of_the_rotor():
    """With an open stator between, its flux follows from the rotor's: the closed form of closing."""
    bare = lossless(CIRCUIT)
    state = open_circuit_state(bare, 1.0, math.radians(120.0))
    xd, _ = subtransient(bare)
    motion = at_constant_speed(bare, [Supply(0.0, is_open=True), Supply(0.0)], state, 0.02)
    assert -largest(motion)[0] == pytest.approx(1.5 * math.sqrt(3.0) / xd, rel=2e-4)


# --- constant speed against the phasors ---------------------------------------------------------------


@pytest.mark.parametrize("slip", [1.0, 0.5, 0.05])
@pytest.mark.parametrize("circuit", [CIRCUIT, UNEQUAL], ids=["equal axes", "unequal axes"])
def test_steady_slip(circuit, slip):
    """What is left when all has died out: mean torque, and that at twice the slip frequency."""
    slowly = replace(  # quickly, for the test: the field alone would take many seconds
        circuit, stator_resistance=0.05, field=Winding(0.05, 0.2049)
    )
    state = MachineState(np.zeros(5), 0.0, 0.3)
    period = 2.0 * math.pi / (slip * LINE)
    settled = math.ceil(6.0 / period) * period
    motion = machine_motion(
        STEADY, replace(PER_UNIT, circuit=slowly), [Supply(0.0)], state, settled + period,
        period / max(math.ceil(period * LINE / 0.04), 1), balance=Balance(0.0, 1.0 - slip),
    )  # fmt: skip
    last = motion.time > settled * (1.0 + 1e-12)
    t, torque = motion.time[last], motion.torque[last]
    curves = slip_curves(slowly, np.array([slip]))
    assert np.mean(torque) == pytest.approx(curves.average[0], abs=1e-6)
    wave = 2.0 * np.mean(torque * np.exp(-2j * slip * LINE * t))
    # the voltage is ahead of axis d by −angle at t = 0
    expected = curves.pulsating[0] * np.exp(1j * (curves.phase[0] - 2.0 * state.angle))
    assert abs(wave - expected) < 1e-6


# --- rigid trains -------------------------------------------------------------------------------------


def number(text) -> float:
    return float(str(text).split()[0])


def reluctance_start(case):
    """Torque and speed of SM01 at the times of its series before the load comes, and its published torque."""
    motion, inertia = reluctance_motion(case)
    rows = [row for row in case["series"] if row["time"] < LOADED]
    times = np.array([row["time"] for row in rows]) - CLOSED
    published = np.array([row["torque_from_ref"] for row in rows])
    return sampled(motion)(times), times, published


#: Instants of SM01 at which the breaker closes and the load comes. [s]
CLOSED, LOADED = 0.1, 1.5


def reluctance_motion(case):
    """The start of SM01 to the step of load, and its inertia."""
    m = case["machine"]
    names = ("Rs", "Xs_leak", "Xmd", "Xmq", "Rrd", "Xrd_leak", "Rrq", "Xrq_leak")
    rs, xl, xmd, xmq, rd, xd, rq, xq = (number(m[name]) for name in names)
    omega = 2.0 * math.pi * number(m["frequency"])
    base = 1.5 * (2.0 / 3.0 * 100.0**2) / (omega / 2.0)
    circuit = Circuit(rs, xl, xmd, xmq, None, (Winding(rd, xd),), (Winding(rq, xq),))
    machine = Machine(circuit, base, omega / 2.0, omega)
    inertia = number(m["inertia_total"])
    state = MachineState(np.zeros(4), 0.0, 0.5 * math.pi)
    motion = machine_motion(
        rigid(inertia),
        machine,
        [Supply(0.0)],
        state,
        LOADED - CLOSED,
        0.05 / omega,
        balance=Balance(0.0, 0.0),
    )
    return motion, inertia


def test_reluctance_motor_direct_on_line():
    case = load_case("SM01")
    expected = case["expected"]
    motion, inertia = reluctance_motion(case)
    torque = sampled(motion)
    peak = expected["peak_torque_own"]
    assert torque(expected["peak_time_own"] - CLOSED) == pytest.approx(peak, rel=1e-5)
    least = torque(expected["least_time_own"] - CLOSED)
    assert least == pytest.approx(expected["least_torque_own"], rel=1e-5)
    rows = [row for row in case["series"] if row["time"] < LOADED]
    times = np.array([row["time"] for row in rows]) - CLOSED
    speed = np.interp(times, motion.time, motion.v[0] / math.sqrt(inertia))
    own = np.array([row["speed_own"] for row in rows])
    published = np.array([row["speed_ref"] for row in rows])
    assert np.max(np.abs(speed - own)) < 1e-5 * np.max(own)
    assert np.max(np.abs(speed - published)) < 3e-3 * np.max(published)
    assert np.max(np.abs(torque(times) - [row["torque_own"] for row in rows])) < 1e-5 * peak
    assert np.max(np.abs(torque(times) - [row["torque_from_ref"] for row in rows])) < 3e-3 * peak


@pytest.mark.parametrize("name", ["IM_krause_3hp", "IM_krause_2250hp"])
def test_induction_motor_direct_on_line(name):
    case = load_case(name)
    m, expected = case["machine"], case["expected"]
    omega = 2.0 * math.pi * 60.0
    cage = (Winding(m["rr"], m["Xlr"]),)
    circuit = Circuit(m["rs"], m["Xls"], m["XM"], m["XM"], None, cage, cage)
    base = number(m["line_voltage"]) ** 2 / (omega / 2.0)
    machine = Machine(circuit, base, omega / 2.0, omega)
    state = MachineState(np.zeros(4), 0.0, 0.0)
    end = 1.05 * expected["time_to_95_percent"]
    motion = machine_motion(
        rigid(m["inertia"]),
        machine,
        [Supply(0.0)],
        state,
        end,
        0.1 / omega,
        balance=Balance(0.0, 0.0),
    )
    torque = sampled(motion)
    assert torque(expected["peak_time"]) == pytest.approx(expected["peak_torque"], rel=1e-5)
    assert torque(expected["least_time"]) == pytest.approx(expected["least_torque"], rel=1e-4)
    assert largest(motion)[0] == pytest.approx(expected["peak_torque"], rel=1e-4)
    speed = motion.v[0] / math.sqrt(m["inertia"]) / (omega / 2.0)
    assert np.interp(0.95, speed, motion.time) == pytest.approx(
        expected["time_to_95_percent"],
        abs=5e-5,  # sampled so
    )


def test_a_heavy_train_keeps_its_speed():
    state = running_state(CIRCUIT, 0.8, 0.9)
    still = at_constant_speed(CIRCUIT, [FAULT], state, 0.3)
    heavy = machine_motion(
        rigid(1e9), PER_UNIT, [FAULT], state, 0.3, 0.1 / LINE, balance=Balance(0.8)
    )
    assert np.max(np.abs(heavy.torque - still.torque)) < 1e-8


def test_power_balance():
    """Supply = losses + shaft + change of the field energy, over a line-to-line fault on a light rotor."""
    inertia = 2.0 * 1.5 / LINE / LINE  # H = 1.5 s, per unit of S / ω_s
    machine = replace(PER_UNIT, torque_base=1.0 / LINE)
    state = running_state(CIRCUIT, 0.8, 0.9)
    fault = Supply(0.0, (0.5, 0.0), (0.5, -1.2))
    motion = machine_motion(
        rigid(inertia),
        machine,
        [fault],
        state,
        0.25,
        0.02 / LINE,
        balance=Balance(0.8 / LINE),
    )
    system = flux_system(CIRCUIT, LINE, 1.0, state.field_voltage, is_open=False)
    current, t = system.current @ motion.flux, motion.time
    angle = state.angle + motion.q[0] / math.sqrt(inertia)
    speed = LINE + motion.v[0] / math.sqrt(inertia)
    u = 0.5 * np.exp(-1j * angle) + 0.5 * np.exp(-1j * (2.0 * LINE * t + angle + 1.2))
    field = np.zeros(5)
    field[1] = state.field_voltage
    resistance = np.array([0.0019, 0.00041, 0.0141, 0.0019, 0.0136])
    power = u.real * current[0] + u.imag * current[system.q] + field @ current
    power -= resistance @ current**2 + motion.torque * speed
    stored = 0.5 / LINE * np.sum(motion.flux * current, axis=0)
    h = t[2] - t[0]  # Simpson over pairs of steps
    supplied = np.cumsum(h / 6.0 * (power[:-2:2] + 4.0 * power[1:-1:2] + power[2::2]))
    change = stored[2::2] - stored[0]
    assert np.max(np.abs(supplied - change[: len(supplied)])) < 1e-6 * np.max(stored)


# --- order --------------------------------------------------------------------------------------------


def test_steps_are_of_fourth_order():
    inertia = 2.0 * 1.5 / LINE / LINE
    machine = replace(PER_UNIT, torque_base=1.0 / LINE)
    state = running_state(CIRCUIT, 0.8, 0.9)
    fault = Supply(0.0, (0.5, 0.0), (0.5, -1.2))
    ends = [
        machine_motion(
            rigid(inertia),
            machine,
            [fault],
            state,
            0.1,
            0.1 / count,
            balance=Balance(0.8 / LINE),
        ).flux[:, -1]
        for count in (150, 300, 600, 1200)
    ]
    steps = [np.max(np.abs(b - a)) for a, b in zip(ends[:-1], ends[1:], strict=True)]
    orders = [math.log2(a / b) for a, b in zip(steps[:-1], steps[1:], strict=True)]
    assert orders[-1] == pytest.approx(4.0, abs=0.15)
