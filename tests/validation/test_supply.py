"""A motor on a weak line, through an autotransformer or a reactor: networks solved apart, and a start in time."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from engine.case.choices import TorqueFollows
from engine.case.data import (
    EffectChoiceRow,
    MotorDataRow,
    MotorEventRow,
    MotorTorqueRow,
    SupplyRow,
)
from engine.model.build_train import build_train
from engine.model.motor import motors_of
from engine.motor.curves import operational_reactances, slip_curves
from engine.motor.from_case import motor_curves, motors_from_data
from engine.plan.evidence import CLOSING_GAIN
from engine.run import run
from engine.start.peaks import change_of_peaks
from tests.machine_reference import start_case
from tests.trains import geared
from tests.validation.test_start_from_motor_data import SHEET, between, case_from_data
from tests.validation.test_start_in_time import INERTIA, STIFFNESS, Reference, reactances

SLIP = np.array([1.0, 0.8, 0.5, 0.49, 0.3, 0.05, 0.01])
#: Short-circuit power of ten times the motor's, half a per cent of it resistance.
LINE = SupplyRow("Motor", 22.0e6, 8.0)
LINE_OMEGA = 2.0 * np.pi * 60.0
IN_TIME = (EffectChoiceRow("motor transient", "on"),)


def supplied(row, **fields):
    return replace(case_from_data(**fields), supply=(row,))


def in_axes(circuit, slip, resistance, reactance):
    """Machine and line in axes d and q: two equations of each, the line's with its own terms of rotation.

    Returns current phasors, flux linkages of the machine alone, and its voltages.
    """
    xd, xq = (complex(x[0]) for x in operational_reactances(circuit, np.array([slip])))
    s, rs = slip, circuit.stator_resistance
    machine = np.array([[rs + 1j * s * xd, -(1 - s) * xq], [(1 - s) * xd, rs + 1j * s * xq]])
    line = np.array(
        [[resistance + 1j * s * reactance, -(1 - s) * reactance],
         [(1 - s) * reactance, resistance + 1j * s * reactance]]
    )  # fmt: skip
    i = np.linalg.solve(machine + line, np.array([1.0, -1.0j]))
    return i, np.array([xd * i[0], xq * i[1]]), machine @ i


@pytest.mark.parametrize("slip", SLIP.tolist())
def test_torques_and_voltage_behind_a_line(slip):
    """Torque from the machine's own fluxes, which do not hold the line's."""
    (motor,) = motors_from_data(supplied(LINE))
    impedance = 0.1
    r = impedance / math.sqrt(65.0)
    i, flux, voltage = in_axes(motor.starting, slip, r, 8.0 * r)
    average = 0.5 * (flux[0] * np.conj(i[1]) - flux[1] * np.conj(i[0])).real
    pulsating = 0.5 * (flux[0] * i[1] - flux[1] * i[0])
    ours = slip_curves(motor.stages[0].circuit, np.array([slip]))
    assert ours.average[0] == pytest.approx(average, rel=1e-9)
    p = ours.pulsating[0] * np.exp(1j * ours.phase[0])
    assert p == pytest.approx(pulsating, rel=1e-9)
    forward = 0.5 * (voltage[0] + 1j * voltage[1])  # of two axes the part that turns with the line
    terminal = motor.stages[0].connection.source.terminal_voltage(motor.starting, np.array([slip]))
    assert terminal[0] == pytest.approx(abs(forward), rel=1e-9)


def test_an_induction_motor_behind_a_line():
    """Thevenin equivalent of stator, line and magnetising branch, as textbooks have it."""
    sheet = MotorDataRow(
        "Motor", "induction", 2.2e6, r_1=0.01, x_1=0.1, xm=3.5, r_2=0.012, x_2=0.11
    )
    case = geared(motor_torque=(), motor_data=(sheet,), supply=(replace(LINE, x_r=None),))
    rows = motor_curves(case)
    base = 2.2e6 / (60.0 * math.pi)
    for row in rows:
        if row["slip"] == 0.0:
            continue
        stator = 0.01 + 1j * (0.1 + 0.1)
        of_rotor = 0.012 / row["slip"] + 0.11j
        parallel = 3.5j * of_rotor / (3.5j + of_rotor)
        current = 1.0 / (stator + parallel)
        rotor = current * 3.5j / (3.5j + of_rotor)
        torque = abs(rotor) ** 2 * 0.012 / row["slip"]
        assert row["average"] == pytest.approx(torque * base, rel=1e-9)
        assert row["current"] == pytest.approx(abs(current), rel=1e-9)
        at_motor = 1.0 - 0.1j * current
        assert row["terminal_voltage"] == pytest.approx(abs(at_motor), rel=1e-9)
        factor = (at_motor * np.conj(current)).real / abs(at_motor * current)
        assert row["power_factor"] == pytest.approx(factor, rel=1e-9)


def test_taps():
    """An autotransformer gives its share of the voltage and its square of the torque; a reactor that share at rest."""
    full = motor_curves(case_from_data())[0]
    ours = {
        kind: motor_curves(supplied(SupplyRow("Motor", None, None, kind, 0.65, 0.9)))[0]
        for kind in ("autotransformer", "reactor")
    }
    for row in ours.values():
        assert row["terminal_voltage"] == pytest.approx(0.65, rel=1e-9)
    row = ours["autotransformer"]
    assert row["average"] == pytest.approx(0.65**2 * full["average"], rel=1e-9)
    assert row["current"] == pytest.approx(0.65 * full["current"], rel=1e-9)


def test_torques_stated_at_full_voltage_take_that_at_the_terminals():
    """The transient that at rest, pull-out torque that in step: what `Motor.torque_factor` gives."""
    case = supplied(SupplyRow("Motor", 22.0e6, 8.0, "autotransformer", 0.65, 0.9), voltage=0.9)
    (motor,) = motors_of(case, build_train(case))
    first, *_, last = motor_curves(case)
    assert float(motor.torque_factor(0.0)) == pytest.approx(
        (0.9 * first["terminal_voltage"]) ** 2, rel=1e-6
    )
    assert float(motor.torque_factor(1.0)) == pytest.approx(
        (0.9 * last["terminal_voltage"]) ** 2, rel=1e-6
    )
    assert last["terminal_voltage"] > 1.4 * first["terminal_voltage"]


def test_typed_curves_on_a_line_that_gives_way():
    """With a data sheet beside them: their torque times the square of the voltage that its current leaves."""
    x = np.array([0.0, 0.5, 0.9, 1.0])
    rows = tuple(
        MotorTorqueRow("Motor", *map(float, row))
        for row in zip(x, [8e3, 9e3, 1e4, 0.0], [5e3, 5e3, 4e3, 0.0], strict=True)
    )
    alone = geared(motor_torque=rows, motor_data=(SHEET,))
    (whole,) = motors_of(alone, build_train(alone))
    (ours,) = motors_of(replace(alone, supply=(LINE,)), build_train(alone))
    fine = np.linspace(0.0, 0.999, 777)
    sheet = next(motors_from_data(replace(alone, supply=(LINE,))))
    voltage = sheet.stages[0].connection.source.terminal_voltage(sheet.starting, 1.0 - fine)
    assert voltage[0] < 0.9
    for a, b in zip(ours.curves, whole.curves, strict=True):
        assert np.max(np.abs(a(fine) - b(fine) * voltage**2)) < 5e-3


@pytest.mark.parametrize("kind", ["autotransformer", "reactor"])
def test_the_step_at_the_switch_over_is_in_the_start(kind):
    """Beside scipy's DOP853, which stops at the speed and goes on with the curves of the line."""
    case = supplied(
        SupplyRow("Motor", 22.0e6, 8.0, kind, 0.8, 0.6),
        damping_ratio=None, load_torque=(), end_speed=170.0, tolerance_peak=1e-5,
        torque_follows="mean speed",
        effect_choices=tuple(
            EffectChoiceRow(name, "off") for name in ("electrical damping", "motor transient")
        ),
    )  # fmt: skip
    results = run(case)
    assert results.plans[-1].events
    (motor,) = motors_from_data(case)
    inertia = np.array([50.0, 29.0, 36.0])
    stiffness = np.array([3.0e6, 9.0e5])
    pairs, line = 2, 2.0 * np.pi * 60.0
    x = np.linspace(0.0, 1.0, 100_001)
    torques = []
    first = None
    for stage in motor.stages:
        curves = slip_curves(stage.circuit, 1.0 - x)
        first = curves.phase[0] if first is None else first
        scale = stage.connection.source.voltage**2 * motor.torque_base
        pulsation = curves.pulsating * np.exp(1j * (curves.phase - first))
        torques.append(scale * np.stack([curves.average, pulsation]))

    def rates(of_stage):
        def rate(t, y):
            angle, speed = y[:3], y[3:]
            at = min(max(inertia @ speed / inertia.sum() * pairs / line, 0.0), 0.99999) * (
                len(x) - 1
            )
            k = int(at)
            average, turned = of_stage[:, k] + (at - k) * (of_stage[:, k + 1] - of_stage[:, k])
            phase = 2.0 * (line * t - pairs * angle[0])
            driving = average.real + (turned * np.exp(1j * phase)).imag
            twist = stiffness * (angle[:-1] - angle[1:])
            force = np.array([driving - twist[0], twist[0] - twist[1], twist[1]])
            return np.concatenate([speed, force / inertia])

        return rate

    def at_speed(value):
        def event(t, y):
            return inertia @ y[3:] / inertia.sum() - value

        event.terminal = True
        return event

    twists, y, t = [], np.zeros(6), 0.0
    for of_stage, until in zip(torques, (0.6 * line / pairs, 170.0), strict=True):
        done = solve_ivp(
            rates(of_stage), (t, 60.0), y, method="DOP853", rtol=1e-11, atol=1e-13,
            events=at_speed(until), dense_output=True,
        )  # fmt: skip
        path = done.sol(np.linspace(t, done.t[-1], 60_001))
        twists.append(stiffness[0] * (path[0] - path[1]))
        y, t = done.y[:, -1], done.t[-1]
    assert results.start is not None
    assert results.start.outcome.time == pytest.approx(t, rel=1e-5)
    peak = results.start.peaks[0]
    twist = np.concatenate(twists)
    for value, ours in ((twist, peak.maximum), (-twist, -peak.minimum)):
        assert ours == pytest.approx(
            between(value, int(np.argmax(value))), abs=peak.error + 2e-5 * peak.size
        )
    # the largest torque comes after the step, so that the test is of it
    assert int(np.argmax(np.abs(twist))) > len(twists[0])


#: Windings of the rotor among those of both axes.
ROTOR = np.array([1, 2, 4])


class TwoNetworks(Reference):
    """Machine and line with the currents of all windings as state, on three discs: nothing of them jumps."""

    def connect(self, circuit, voltage, resistance, reactance):
        self.x, self.r = reactances(circuit)
        self.line = np.zeros(5)
        self.line[[0, 3]] = reactance
        self.r = self.r + np.array([resistance, 0.0, 0.0, resistance, 0.0])
        self.inverse = np.linalg.inv(self.x + np.diag(self.line))
        self.size, self.is_open = voltage, False

    def open(self, state):
        """The state just after the stator is open: the fluxes of the rotor stay."""
        self.is_open = True
        after, psi = state.copy(), self.x @ state[6:]
        after[[6, 9]] = 0.0
        after[6 + ROTOR] = np.linalg.solve(self.x[np.ix_(ROTOR, ROTOR)], psi[ROTOR])
        return after

    def rate(self, t, state):
        angle, speed, i = state[:3], state[3:6], state[6:]
        psi = self.x @ i
        twist = STIFFNESS * (angle[:-1] - angle[1:])
        force = np.array([self.torque(i) - twist[0], twist[0] - twist[1], twist[1]])
        ahead, w = LINE_OMEGA * t - self.axis - 2.0 * angle[0], 2.0 * speed[0] / LINE_OMEGA
        drop = -self.r * i
        drop[0] += self.size * math.cos(ahead) + w * (psi[3] + self.line[3] * i[3])
        drop[3] += self.size * math.sin(ahead) - w * (psi[0] + self.line[0] * i[0])
        change = self.inverse @ drop
        if self.is_open:
            change = np.zeros(5)
            change[ROTOR] = np.linalg.solve(self.x[np.ix_(ROTOR, ROTOR)], drop[ROTOR])
        return np.concatenate([speed, force / INERTIA, LINE_OMEGA * change])

    def torque(self, i):
        psi = self.x @ i
        return self.base * (psi[0] * i[3] - psi[3] * i[0])


@pytest.mark.parametrize(
    ("kind", "open_time"),
    [("direct", None), ("autotransformer", None), ("reactor", None), ("autotransformer", 0.06), ("reactor", 0.2)],
)  # fmt: skip
def test_a_start_in_time_on_a_line_that_gives_way(kind, open_time):
    """Beside DOP853: torques before and after the switch-over, its shock in them, at the time that ours has."""
    row = SupplyRow("Motor", 22.0e6, 8.0, kind, 0.8, 0.3, open_time)
    if kind == "direct":
        row = replace(row, tap=None, switch_over_speed=None)
    case = supplied(
        row, damping_ratio=None, load_torque=(), end_speed=80.0, tolerance_peak=1e-5,
        effect_choices=(EffectChoiceRow("motor transient", "on"),),
    )  # fmt: skip
    found = run(case).start
    reference = TwoNetworks(case)
    (motor,) = motors_from_data(case)
    extremes, torques, state, begin = [], [], np.zeros(11), 0.0

    def follow(end):
        nonlocal begin, state
        part, torque, state = reference.run(begin, end, state)
        extremes.append(part[0])
        torques.append(np.max(np.abs(torque)))
        begin = end

    for stage in motor.stages:
        source = stage.connection.source
        reference.connect(motor.starting, source.voltage, source.resistance, source.reactance)
        if stage is motor.stages[-1]:
            follow(found.outcome.time)
            continue
        reaches = found.trajectory.mean_speed >= 0.3 * LINE_OMEGA / 2.0 * (1.0 - 1e-12)
        follow(float(found.trajectory.time[np.argmax(reaches)]))
        if open_time:
            state = reference.open(state)
            follow(begin + open_time)
            assert torques[-1] == 0.0
    assert INERTIA @ state[3:6] / INERTIA.sum() == pytest.approx(80.0, rel=1e-5)
    peak = found.peaks[0]
    most, least = (f(part[k] for part in extremes) for k, f in enumerate((max, min)))
    assert (peak.maximum, peak.minimum) == pytest.approx((most, least), rel=3e-5)
    (machine,) = found.machines
    assert abs(machine.largest) == pytest.approx(max(torques), rel=1e-3)


@pytest.mark.parametrize(
    ("kind", "what", "begins"),
    [("direct", "three-phase fault", 0.5), ("reactor", "three-phase fault", 0.3), ("autotransformer", "voltage dip", 0.3),
     ("autotransformer", "reclosing", 6.0)],
)  # fmt: skip
def test_an_event_of_a_start_behind_a_line(kind, what, begins):
    """Beside DOP853: a fault shorts the terminals, a dip is one of the source, the switch-over comes before or after."""
    row = SupplyRow("Motor", 22.0e6, 8.0, kind, 0.8, 0.3)
    if kind == "direct":
        row = replace(row, tap=None, switch_over_speed=None)
    left = 0.6 if what == "voltage dip" else None
    event = MotorEventRow(
        "event", "Motor", what, residual_voltage=left, clears_after=0.1, begins=begins
    )
    case = supplied(
        row, damping_ratio=None, load_torque=(), end_speed=80.0, tolerance_peak=1e-5, meshes=(),
        motor_events=(event,),
    )  # fmt: skip
    (event_found,) = run(case).events
    found = event_found.response
    reference = TwoNetworks(case)
    (motor,) = motors_from_data(case)
    changes = {begins: "begins", begins + 0.1: "clears", begins + found.outcome.time: "ends"}
    if kind != "direct":
        plain = run(replace(case, motor_events=(), effect_choices=IN_TIME)).start.trajectory
        path, since = (plain, 0.0) if begins > 1.0 else (found.trajectory, begins)
        reaches = path.mean_speed >= 0.3 * LINE_OMEGA / 2.0 * (1.0 - 1e-12)
        changes[since + float(path.time[np.argmax(reaches)])] = "switches over"
    extremes, torques, state, begin, present = [], [], np.zeros(11), 0.0, "clears"
    stages = [stage.connection.source for stage in motor.stages]
    for end, change in sorted(changes.items()):
        source = stages[0]
        if present == "clears":
            reference.connect(motor.starting, source.voltage, source.resistance, source.reactance)
        elif what == "three-phase fault":
            reference.connect(motor.starting, 0.0, 0.0, 0.0)
        elif what == "reclosing":
            state = reference.open(state)
        else:
            reference.connect(
                motor.starting, 0.6 * source.voltage, source.resistance, source.reactance
            )
        part, torque, state = reference.run(begin, end, state)
        if begin >= begins:
            extremes.append(part[0])
            torques.append(np.max(np.abs(torque)))
        begin = end
        if change == "switches over":
            stages.pop(0)
        else:
            present = change
    assert len(extremes) == 2 + (begins == 0.3)
    peak = found.peaks[0]
    most, least = (f(part[k] for part in extremes) for k, f in enumerate((max, min)))
    assert (peak.maximum, peak.minimum) == pytest.approx((most, least), rel=5e-5)
    assert abs(event_found.air_gap.largest) == pytest.approx(max(torques), rel=1e-3)


def test_curves_have_no_torque_while_the_motor_is_off_the_line():
    """Without load the mean speed stays what it was at the switch-over, and rises again after it."""
    case = supplied(
        SupplyRow("Motor", 22.0e6, 8.0, "reactor", 0.8, 0.6, 0.2),
        damping_ratio=None, load_torque=(), end_speed=170.0,
        effect_choices=(EffectChoiceRow("motor transient", "off"),),
    )  # fmt: skip
    path, at = run(case).start.trajectory, 0.6 * LINE_OMEGA / 2.0
    begin = float(path.time[np.argmax(path.mean_speed >= at * (1.0 - 1e-12))])
    off = (path.time > begin) & (path.time < begin + 0.2)
    assert np.max(np.abs(path.mean_speed[off] - at)) < 1e-9 * at
    after = path.time > begin + 0.25
    assert np.min(path.mean_speed[after]) > 1.001 * at


@pytest.mark.parametrize(("seed", "open_time"), [(15, None), (18, None), (21, None), (4, 0.08)])
def test_what_a_switch_over_brings_is_within_its_bound(seed, open_time):
    """Forced off, the start lacks the shock, and its peaks change by no more than the bound on sheet Effects and accuracy."""
    case = replace(start_case(seed), torque_follows=TorqueFollows.MEAN_SPEED)
    power = case.motor_data[0].apparent_power
    kind = ("autotransformer", "reactor")[seed % 2]
    case = replace(case, supply=(SupplyRow("M0", 20.0 * power, 8.0, kind, 0.6, 0.4, open_time),))
    off, on = (
        run(replace(case, effect_choices=(EffectChoiceRow("motor transient", choice),)))
        for choice in ("off", "on")
    )
    number = on.plans[-1].decision("motor transient").deciding_number
    assert change_of_peaks(off.start.peaks, on.start.peaks) <= CLOSING_GAIN * number
