"""Measured time constants: circuits whose own poles, found by numpy, are those typed."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from engine.case.data import MotorDataRow
from engine.motor.circuit import Circuit, line_omega, time_constants
from engine.motor.from_case import circuit_of, motor_time_constants
from engine.run import run
from tests.trains import geared
from tests.validation.test_start_from_motor_data import SHEET, case_from_data

MEASURED = replace(SHEET, time_constants="measured")
SHORT = replace(
    MEASURED, td_0_transient=None, td_0_subtransient=None, tq_0_subtransient=None,
    td_transient=0.8, td_subtransient=0.02, tq_subtransient=0.04,
)  # fmt: skip
OMEGA = line_omega(60.0)


def poles(circuit: Circuit, *, shorted: bool) -> list[float]:
    """Time constants of the rotor's windings: eigenvalues of resistance over inductance. [s]"""
    field, damper = circuit.field, circuit.dampers_d[0]
    assert field is not None
    m, xl = circuit.magnetising_d, circuit.stator_leakage
    seen = m * xl / (m + xl) if shorted else m
    x = np.array([[seen + field.leakage, seen], [seen, seen + damper.leakage]])
    rates = np.linalg.eigvals(np.diag([field.resistance, damper.resistance]) @ np.linalg.inv(x))
    return sorted((1.0 / (OMEGA * rates)).tolist(), reverse=True)


@pytest.mark.parametrize("row", [MEASURED, SHORT], ids=["open", "short-circuited"])
def test_the_typed_ones_are_poles_of_the_circuit(row: MotorDataRow) -> None:
    circuit = circuit_of(row, None, 60.0)
    typed = (row.td_0_transient, row.td_0_subtransient)
    if row is SHORT:
        typed = (row.td_transient, row.td_subtransient)
    assert poles(circuit, shorted=row is SHORT) == pytest.approx(typed, rel=1e-9)


@pytest.mark.parametrize("row", [MEASURED, SHORT], ids=["open", "short-circuited"])
def test_reactances_are_those_of_the_short_circuit_test(row: MotorDataRow) -> None:
    """Xd' and Xd'' are the amplitudes of the decaying currents: partial fractions of 1/Xd(p) by least squares."""
    circuit = circuit_of(row, None, 60.0)
    p = np.geomspace(1e-2, 1e3, 200)
    rotor = sum(
        p / (OMEGA * w.resistance + p * w.leakage) for w in (circuit.field, *circuit.dampers_d)
    )
    admittance = 1.0 / (circuit.stator_leakage + 1.0 / (1.0 / circuit.magnetising_d + rotor))
    columns = [np.ones_like(p)] + [p * t / (1.0 + p * t) for t in poles(circuit, shorted=True)]
    (y, slow, fast), rest, *_ = np.linalg.lstsq(np.stack(columns, axis=1), admittance, rcond=None)
    assert rest < 1e-18
    assert 1.0 / y == pytest.approx(row.xd, rel=1e-8)
    assert 1.0 / (y + slow) == pytest.approx(row.xd_transient, rel=1e-8)
    assert 1.0 / (y + slow + fast) == pytest.approx(row.xd_subtransient, rel=1e-8)


def test_the_table_has_both() -> None:
    """Of a classical circuit: its roots by numpy, and the typed ones."""
    rows = {row["time_constant"]: row for row in motor_time_constants(case_from_data())}
    circuit = circuit_of(SHEET, None, 60.0)
    assert rows["Td0 transient"]["classical"] == pytest.approx(SHEET.td_0_transient, rel=1e-12)
    assert rows["Td0 subtransient"]["classical"] == pytest.approx(
        SHEET.td_0_subtransient, rel=1e-12
    )
    found = [
        rows[f"Td{k} {kind}"]["measured"]
        for k in ("0", "")
        for kind in ("transient", "subtransient")
    ]
    assert found == pytest.approx(
        poles(circuit, shorted=False) + poles(circuit, shorted=True), rel=1e-9
    )
    assert rows["Td subtransient"]["classical"] == pytest.approx(
        SHEET.td_0_subtransient * SHEET.xd_subtransient / SHEET.xd_transient, rel=1e-12
    )


def test_random_sheets_with_short_circuit_time_constants_are_circuits() -> None:
    """Whatever falls from Xd to Xl, and from Td' to Td''."""
    rng = np.random.default_rng(3)
    for _ in range(300):
        xl, xd2, xd1, xd = np.cumsum(rng.uniform(0.02, 0.5, 4)).tolist()
        fast = float(10.0 ** rng.uniform(-3.0, 0.0))
        slow = fast * float(1.0 + 10.0 ** rng.uniform(-2.0, 2.0))
        row = replace(
            SHORT,
            xd=xd,
            xd_transient=xd1,
            xd_subtransient=xd2,
            xl=xl,
            td_transient=slow,
            td_subtransient=fast,
        )
        circuit = circuit_of(row, None, 60.0)
        windings = (circuit.field, *circuit.dampers_d)
        assert all(w is not None and w.resistance > 0.0 and w.leakage > 0.0 for w in windings)
        assert poles(circuit, shorted=True) == pytest.approx([slow, fast], rel=1e-6)


def test_a_note_where_it_matters() -> None:
    """Field and damper near to each other: the relations are off by more than 5 %."""
    near = replace(SHEET, td_0_subtransient=0.4)
    case = case_from_data()
    notes = [
        w for w in run(replace(case, motor_data=(near,))).warnings if "classical relations" in w
    ]
    assert len(notes) == 1
    assert "taken as classical" in notes[0]
    both = time_constants(circuit_of(near, None, 60.0), OMEGA)
    assert max(abs(b / a - 1.0) for a, b in zip(*both, strict=True)) > 0.05
    assert not [w for w in run(geared()).warnings if "classical relations" in w]
