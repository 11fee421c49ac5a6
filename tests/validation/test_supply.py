"""A motor on a weak line, through an autotransformer or a reactor: networks solved apart, and a start in time."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from engine.case.data import EffectChoiceRow, MotorDataRow, MotorTorqueRow, SupplyRow
from engine.model.build_train import build_train
from engine.model.motor import motors_of
from engine.motor.curves import operational_reactances, slip_curves
from engine.motor.from_case import motor_curves, motors_from_data
from engine.run import run
from tests.trains import geared
from tests.validation.test_start_from_motor_data import SHEET, between, case_from_data

SLIP = np.array([1.0, 0.8, 0.5, 0.49, 0.3, 0.05, 0.01])
#: Short-circuit power of ten times the motor's, half a per cent of it resistance.
LINE = SupplyRow("Motor", 22.0e6, 8.0)


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
        torque_follows="mean speed", effect_choices=(EffectChoiceRow("electrical damping", "off"),),
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
            rates(of_stage), (t, 60.0), y, method="DOP853", rtol=1e-9, atol=1e-11,
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
