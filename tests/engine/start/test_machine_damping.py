"""Starts in which the motor answers to small oscillations of each mode: effect electrical damping."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import eigh

from engine.backlash.event_start import run_event_start
from engine.case.case import Case
from engine.case.data import CaseData, EffectChoiceRow, MotorDataRow
from engine.case.effect import StartEffects
from engine.errors import CaseError
from engine.model.build_train import build_train
from engine.model.modal_analysis import analyse
from engine.model.modal_train import ModalTrain
from engine.model.modes import modes_of
from engine.motor.curves import slip_curves
from engine.motor.damping import electrical_damping
from engine.motor.from_case import motors_from_data
from engine.run import planned_start
from engine.start.electrical_damping import LEVELS, electrical_damping_of
from engine.start.simulation import Simulation, runs_of
from engine.start.start import prepared_start, run_start
from engine.start.start_model import shifted
from engine.stepping.linear_loop import LANES
from tests.trains import geared, peaks, started

SHEET = MotorDataRow(
    "Motor", None, 2.2e6, xd=1.3, xq=0.9, xd_transient=0.35, xd_subtransient=0.22, xq_subtransient=0.26, xl=0.12,
    td_0_transient=3.0, td_0_subtransient=0.035, tq_0_subtransient=0.12, ta=0.05, discharge_resistance=9.0,
)  # fmt: skip
LINE = 120.0 * np.pi
ANSWERING = StartEffects(electrical_damping=True)


def case_from_data(**fields) -> Case:
    given = {"torque_follows": "machine", "load_torque": (), "end_speed": 170.0}
    return geared(motor_torque=(), motor_data=(SHEET,), **(given | fields))


def modal_of(case: CaseData) -> ModalTrain:
    train = build_train(case)
    return ModalTrain.of(case, train, modes_of(train))


def peaks_of_the_equations(case: Case, end: float, added: np.ndarray | None = None) -> np.ndarray:
    """Extremes of the low-speed shaft by scipy, in modes of its own making; `added` to the unit mass of each mode."""
    mass = np.ones(3) if added is None else 1.0 + added
    inertia = np.array([50.0, 20.0 + 9.0 * 1.0, 9.0 * 4.0])  # referred to the motor
    stiffness = np.array([3.0e6, 9.0 * 1.0e5])
    spring = np.diff(np.eye(3), axis=0)
    square, shape = eigh((spring.T * stiffness) @ spring, np.diag(inertia))
    omega = np.sqrt(np.maximum(square, 0.0))
    omega[0] = 0.0
    (motor,) = motors_from_data(case)
    voltage = (case.voltage or 1.0) ** 2
    x = np.linspace(0.0, 1.0, 20_001)
    curves = slip_curves(motor.starting, 1.0 - x)
    pulsation = curves.pulsating * np.exp(1j * (curves.phase - curves.phase[0]))
    answers = [
        electrical_damping(motor.starting, 1.0 - x, 0.0 * x + w / LINE).real for w in omega[1:]
    ]
    scale = voltage * motor.torque_base
    table = scale * np.stack(
        [curves.average, pulsation, *(np.array(answers) / motor.synchronous_speed)]
    )

    def rate(t, y):
        q, v = y[:3], y[3:]
        at = max(shape[0, 0] * v[0] / motor.synchronous_speed, 0.0) * (len(x) - 1)
        k = int(at)
        average, turned, *gains = table[:, k] + (at - k) * (table[:, k + 1] - table[:, k])
        phase = 2.0 * (LINE * t - 2.0 * (shape[0] @ q))
        torque = average.real + (turned * np.exp(1j * phase)).imag
        torque += sum(g.real * shape[0, i] * v[i] for i, g in enumerate(gains, start=1))
        damped = 2.0 * (case.damping_ratio or 0.0) * omega * v
        pulled = shape[0] * torque - damped - square * (omega > 0.0) * q
        return np.concatenate([v, pulled / mass])

    t = np.linspace(0.0, end, 40_001)
    y = solve_ivp(rate, (0.0, end), np.zeros(6), t_eval=t, method="DOP853", rtol=1e-9, atol=1e-11).y
    twist = stiffness[0] * ((shape[0] - shape[1]) @ y[:3])
    extremes = []
    for k in (int(np.argmax(twist)), int(np.argmin(twist))):
        before, middle, after = twist[k - 1 : k + 2]
        extremes.append(middle + (after - before) ** 2 / (8.0 * (2.0 * middle - before - after)))
    return np.array(extremes)


def test_a_start_is_that_of_the_equations() -> None:
    case = case_from_data(tolerance_peak=1e-5, voltage=0.9, damping_ratio=0.002)
    found = run_start(case, modal_of(case), ANSWERING)
    expected = peaks_of_the_equations(case, found.outcome.time)
    got = peaks(found)["Low-speed shaft"][:2]
    np.testing.assert_allclose(got, expected, rtol=5e-5)
    # and it matters: with the mean speed alone the shaft has another torque
    plain = peaks(started(replace(case, torque_follows="mean speed")))["Low-speed shaft"][:2]
    assert np.max(np.abs(plain / expected - 1.0)) > 0.003


def test_what_the_shift_of_frequencies_changes_is_left_out_by_an_estimate() -> None:
    """The motor's torque in phase with the acceleration of a mode is an inertia that moves with it: Δm = −2 Δω/ω."""
    case = case_from_data(tolerance_peak=1e-5, damping_ratio=0.002)
    modal = modal_of(case)
    share = np.zeros(3)
    for row in electrical_damping_of(case, modal):
        if row.speed < 1.0:
            share[row.mode] = row.shift / modal.modes.frequency[row.mode]
    prepared = prepared_start(case, modal, ANSWERING)
    at = modal.train.elements.index("Low-speed shaft")

    def extremes(share: np.ndarray) -> list[float]:
        model = shifted(prepared.model, share * modal.modes.omega)
        run = replace(prepared, model=model).at(2e-4)
        value = run.turning[run.trajectory.output_element.tolist().index(at)][1]
        return [float(value.max()), float(value.min())]

    many = 20.0 * share  # so much that it shows beside the tolerance of the comparison
    end = run_start(case, modal, ANSWERING).outcome.time
    expected = peaks_of_the_equations(case, end, (1.0 + many) ** -2 - 1.0)
    np.testing.assert_allclose(extremes(many), expected, rtol=5e-5)
    assert np.max(np.abs(np.divide(extremes(0.0 * many), expected) - 1.0)) > 1e-3
    off = replace(case, effect_choices=(EffectChoiceRow("motor transient", "off"),))
    planned = planned_start(off, analyse(off))
    change = np.abs(np.divide(extremes(share), extremes(0.0 * share)) - 1.0)
    assert planned.plans[-1].estimate >= 0.999 * np.max(change)
    # it is no error of the calculation
    assert planned.plans[-1].estimate > 2.0 * planned.start.estimated_error


def test_modes_of_a_run_with_events_are_damped_alike() -> None:
    """A trip at the end of the plain start: up to it both loops have the same torques."""
    case = case_from_data(trip_speed=165.0, tolerance_peak=1e-4)
    modal = modal_of(case)
    linear = run_start(replace(case, trip_speed=None, end_speed=165.0), modal, ANSWERING)
    tripped = run_event_start(case, modal, replace(ANSWERING, aborted_start=True))
    for a, b in zip(linear.peaks, tripped.peaks, strict=True):
        assert b.maximum == pytest.approx(a.maximum, abs=a.error + b.error)


def test_starts_side_by_side_have_the_bits_that_each_has_alone() -> None:
    simulations = []
    for i in range(LANES):
        case = case_from_data(voltage=1.0 - 0.01 * i)
        start = prepared_start(case, modal_of(case), ANSWERING)
        simulations.append(Simulation(start.model, 1e-3, "exponential", 120.0, 3.0))
    together = runs_of(simulations)
    for one, run in zip(simulations, together, strict=True):
        (alone,) = runs_of([one])
        assert run.end == alone.end
        for (when, value), (other_when, other_value) in zip(
            run.turning, alone.turning, strict=True
        ):
            assert np.array_equal(when, other_when)
            assert np.array_equal(value, other_value)


def test_the_table_between_its_levels() -> None:
    """Straight between two levels K is off by less than 1 % of its largest magnitude, of every mode crossed."""
    (motor,) = motors_from_data(case_from_data())
    middle = 1.0 - 0.5 * (LEVELS[1:] + LEVELS[:-1])
    for frequency in (0.1, 0.4, 1.0, 1.9):
        ends = electrical_damping(motor.starting, 1.0 - LEVELS, 0.0 * LEVELS + frequency).real
        exact = electrical_damping(motor.starting, middle, 0.0 * middle + frequency).real
        off = np.abs(0.5 * (ends[1:] + ends[:-1]) - exact)
        assert np.max(off) < 0.01 * np.max(np.abs(ends))


def test_without_a_data_sheet_the_motor_is_named() -> None:
    with pytest.raises(CaseError, match="Give 'Motor' a row in table MotorData"):
        geared(torque_follows="machine")
    assert electrical_damping_of(geared(), modal_of(geared()))
