"""What a motor damps of a mode, against Park's equations integrated in time with a two-mass train.

Equations: Park, Trans. AIEE 48 (1929), 716, motor sign, per unit, time in radians of the line. The train turns
with a constant mean slip; beside it moves its one elastic mode, driven by what the torque is more than at the steady
slip: the free vibration, without what the pulsation forces. Its decay and frequency are compared with ζe and Δω of
table ElectricalDamping.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import least_squares
from test_motor_circuit import SALIENT, SECOND_CAGE, matrices

from engine.case.case import Case
from engine.case.data import ElementRow, MotorDataRow, StationRow
from engine.model.build_train import build_train
from engine.model.modal_train import ModalTrain
from engine.model.modes import modes_of
from engine.motor.circuit import Circuit, starting_circuit
from engine.motor.damping import _damping_at_rest, electrical_damping, stator_response
from engine.motor.from_case import row_of_circuit
from engine.start.electrical_damping import ElectricalDamping, electrical_damping_of
from tests.trains import geared, motor

LINE = 120.0 * np.pi
POWER, POLES = 2.2e6, 4
DISCHARGE = 9.0
CIRCUITS = {
    "salient": SALIENT,
    "two cages": replace(SECOND_CAGE, field=SALIENT.field),
    "strong cage": replace(SALIENT, dampers_q=(SALIENT.dampers_q[0]._replace(resistance=0.012),)),
}
PRECISE = {"method": "DOP853", "rtol": 1e-11, "atol": 1e-13}


def two_masses(circuit: Circuit, hertz: float, inertias: tuple[float, float], **fields) -> Case:
    """Motor and machine on one shaft, with this natural frequency."""
    first, second = inertias
    stiffness = (2.0 * np.pi * hertz) ** 2 * first * second / (first + second)
    sheet = MotorDataRow(
        "Motor", None, POWER, power_factor=0.9, efficiency=0.96, discharge_resistance=DISCHARGE
    )
    given = {
        "line_frequency": 60.0,
        "poles": POLES,
        "rated_torque": 1e4,
        "stations": (StationRow("Motor", None, first), StationRow("Machine", None, second)),
        "elements": (ElementRow("Shaft", "shaft", "Motor", "Machine", stiffness),),
        "motor_data": (sheet,),
        "motor_circuit": (row_of_circuit("Motor", circuit),),
        "damping_ratio": 0.01,
    }
    return Case(**(given | fields))


def rows_of(case: Case) -> list[ElectricalDamping]:
    train = build_train(case)
    return list(electrical_damping_of(case, ModalTrain.of(case, train, modes_of(train))))


def coupling(inertias: tuple[float, float]) -> float:
    """Acceleration of the rotor's electrical angle by the mode, per unit of torque."""
    first, second = inertias
    torque_base = POWER / (2.0 * LINE / POLES)
    return second / (first * (first + second)) * torque_base * POLES / 2.0 / LINE**2


def rates(circuit: Circuit, nu: float, mu: float, slip: float, field_voltage: float):
    """Rates of flux linkages, angle and speed of the mode at the rotor; time in radians of the line."""
    inductance, resistance = matrices(circuit)
    inverse, n = np.linalg.inv(inductance), len(inductance)

    def rate(t, x, lag=0.0):
        current, (angle, swing) = inverse @ x[:n], x[n:]
        speed, behind = 1.0 - slip + swing, slip * t + lag - angle
        out = -resistance @ current
        out[0] += np.cos(behind) + speed * x[1]
        out[1] += np.sin(behind) - speed * x[0]
        out[2] += field_voltage
        torque = x[0] * current[1] - x[1] * current[0]
        return np.concatenate([out, [swing, mu * torque - nu**2 * angle]])

    return rate, inductance


@pytest.mark.parametrize("name", sorted(CIRCUITS))
@pytest.mark.parametrize("hertz", [23.0, 41.0])
def test_a_crossed_mode_decays_as_the_motor_damps_it(name: str, hertz: float) -> None:
    inertias = (500.0, 1500.0)
    case = two_masses(CIRCUITS[name], hertz, inertias)
    row = rows_of(case)[0]
    starting = starting_circuit(CIRCUITS[name], discharge=DISCHARGE)
    nu, mu, slip = hertz / 60.0, coupling(inertias), hertz / 120.0
    assert row.speed == pytest.approx(1.0 - slip, rel=1e-12)
    rate, inductance = rates(starting, nu, mu, slip, 0.0)
    n = len(inductance)

    def beside(t, x):
        """The same motor at the steady slip runs along; what its torque is more drives the mode."""
        steady = np.concatenate([x[n + 2 :], [0.0, 0.0]])
        moved, unmoved = rate(t, x[: n + 2]), rate(t, steady)
        moved[-1] -= unmoved[-1]
        return np.concatenate([moved, unmoved[:n]])

    period, twist = 2.0 * np.pi / nu, 1e-4
    t = np.arange(
        20.0 * period, 80.0 * period, period / 16.0
    )  # the flux of closing has died out by then
    start = np.zeros(2 * n + 2)
    start[n] = twist
    free = solve_ivp(beside, (0.0, t[-1]), start, t_eval=t, **PRECISE).y[n] / twist

    def off(p):
        return np.exp(-p[0] * t) * (p[2] * np.cos(p[1] * t) + p[3] * np.sin(p[1] * t)) - free

    found = least_squares(
        off, [0.0, nu, 1.0, 0.0], xtol=1e-14, ftol=1e-14, x_scale=[1e-4, 1e-4, 1, 1]
    )
    added = complex(found.x[0] / nu, found.x[1] / nu - 1.0)
    expected = complex(row.share, row.shift / hertz)
    assert abs(added - expected) < 0.01 * abs(expected)
    assert row.with_motors == pytest.approx(0.01 + row.share, rel=1e-12)


@pytest.mark.parametrize("name", sorted(CIRCUITS))
@pytest.mark.parametrize(("hertz", "sign"), [(23.0, 1), (41.0, 1), (23.0, -1)])
def test_a_mode_in_operation_has_that_eigenvalue(name: str, hertz: float, sign: int) -> None:
    circuit, inertias = CIRCUITS[name], (500.0, 1500.0)
    case = two_masses(circuit, hertz, inertias)
    case = replace(case, motor_data=(replace(case.motor_data[0], power_factor=0.9 * sign),))
    row = rows_of(case)[1]
    assert row.speed == 1.0
    # rated current, power factor 0.9 leading or lagging; axis q along the voltage behind Rs + j Xq
    current = 0.9 + 1j * sign * np.sqrt(1.0 - 0.81)
    xq = circuit.stator_leakage + circuit.magnetising_q
    delta = np.angle(1.0 - (circuit.stator_resistance + 1j * xq) * current)
    u, i = (z * np.exp(-1j * (delta - np.pi / 2.0)) for z in (1.0, current))
    xd = circuit.stator_leakage + circuit.magnetising_d
    in_field = (u.imag - circuit.stator_resistance * i.imag - xd * i.real) / circuit.magnetising_d
    nu, mu = hertz / 60.0, coupling(inertias)
    rate, inductance = rates(circuit, nu, mu, 0.0, circuit.field.resistance * in_field)
    currents = np.zeros(len(inductance))
    currents[:3] = i.real, i.imag, in_field
    flux = inductance @ currents
    torque = flux[0] * currents[1] - flux[1] * currents[0]
    state = np.concatenate([flux, [0.0, 0.0]])
    # the mode stands where the mean torque twists it: the voltage lags by as much more
    lag = np.angle(u)
    standing = rate(0.0, state, lag)
    standing[-1] -= mu * torque
    assert np.max(np.abs(standing)) < 1e-12
    h, n = 1e-6, len(state)
    jacobian = np.empty((n, n))
    for k in range(n):
        step = h * (np.arange(n) == k)
        jacobian[:, k] = (rate(0.0, state + step, lag) - rate(0.0, state - step, lag)) / (2.0 * h)
    values = np.linalg.eigvals(jacobian)
    value = values[np.argmin(np.abs(values - 1j * nu))]
    added = complex(-value.real / nu, value.imag / nu - 1.0)
    expected = complex(row.share, row.shift / hertz)
    assert abs(added - expected) < 0.01 * abs(expected)


def test_in_step_the_mean_over_the_load_angle_is_the_limit_of_small_slip() -> None:
    """Without field a rotor that hardly slips passes all load angles."""
    starting, one = starting_circuit(SALIENT, discharge=DISCHARGE), np.ones(1)
    frequency = np.array([0.4])
    total = 0.0
    for angle in np.arange(16) * np.pi / 8.0:
        voltage = np.cos(angle), np.sin(angle)
        currents, _ = stator_response(
            starting, 0.0 * one, one, tuple(v * one + 0j for v in voltage)
        )
        at_rest = tuple(float(i[0].real) for i in currents)
        total += _damping_at_rest(starting, voltage, at_rest, frequency)[0] / 16.0
    assert total == pytest.approx(
        electrical_damping(starting, np.array([1e-9]), frequency)[0], rel=1e-6
    )


def test_typed_curves_give_the_slope_alone() -> None:
    """Straight down from 1 to 0 at synchronous speed: it damps each mode by half the slope times φ²/ω."""
    case = geared(motor_torque=motor(curve=((0.0, 1.0, 0.2), (1.0, 0.0, 0.2))), damping_ratio=None)
    rows = rows_of(case)
    train = build_train(case)
    modes = modes_of(train)
    assert [r.mode for r in rows] == [1, 2]
    slope = -case.motor_torque[0].average / case.ratings.synchronous_speed
    assert rows[0].slope == pytest.approx(slope, rel=1e-12)
    share = -0.5 * slope * modes.shape[0, 1] ** 2 / modes.omega[1]
    assert rows[0].slope_share == pytest.approx(share, rel=1e-12)
    assert rows[0].share is rows[0].shift is rows[0].with_motors is None


def test_voltage_counts_in_the_start_alone() -> None:
    plain, low = (rows_of(two_masses(SALIENT, 23.0, (50.0, 150.0), voltage=v)) for v in (None, 0.8))
    assert low[0].share == pytest.approx(0.64 * plain[0].share, rel=1e-12)
    assert low[0].slope == pytest.approx(0.64 * plain[0].slope, rel=1e-9)
    assert low[1] == plain[1]
