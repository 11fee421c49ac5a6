"""Rows of `MotorData` and `MotorCircuit` → circuits in per unit, and torque curves in SI."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np

from engine.arrays import Floats
from engine.case.choices import FieldCircuit, MotorKind, TimeConstantKind
from engine.case.data import CaseData, MotorCircuitRow, MotorDataRow, SupplyRow
from engine.errors import InternalError
from engine.motor.circuit import (
    Circuit,
    Step,
    Winding,
    line_omega,
    measured_windings,
    rotor_windings,
    starting_circuit,
    stator_resistance,
    time_constants,
)
from engine.motor.curves import slip_curves
from engine.motor.supply import Connection, connections_of
from engine.numerics.same_bits import cos, modulus, sin, times
from engine.numerics.torque_curve import TorqueCurve, fitted_curves

#: A curve is wrong by at most this share of the largest average torque. [1]
CURVE_ERROR = 1e-7
#: First points. [count]
FIRST_POINTS = 33
#: Half the distance over which slopes are taken: its square and its rounding are both below 1e-9. [1]
NEARBY = 1e-5
#: Slips of table `MotorCurves`: every per cent.
SHOWN_SLIPS = np.linspace(1.0, 0.0, 101)


#: Names of `engine.motor.circuit.TimeConstants` in table `MotorTimeConstants`.
SHOWN_TIMES = ("Td0 transient", "Td0 subtransient", "Td transient", "Td subtransient")


class SpeedCurves(NamedTuple):
    """Torques against the fraction of synchronous speed; δ is the angle by which the rotor's axis q lags the voltage: the load
    angle."""

    average: TorqueCurve  #: [N m]
    sine: TorqueCurve  #: Part of the pulsation with sin 2δ. [N m]
    cosine: TorqueCurve  #: With cos 2δ. [N m]
    #: Parts with sin δ and cos δ, of a one-way discharge path; none without one. [N m]
    at_slip: tuple[TorqueCurve, ...]


@dataclass(frozen=True, eq=False)
class Stage:
    """What a motor gives while it is fed by one connection."""

    connection: Connection  #: [pu]
    circuit: Circuit  #: As it starts, with the impedance of its supply in the stator. [pu]
    curves: SpeedCurves  #: Against the fraction of synchronous speed. [N m]


@dataclass(frozen=True, eq=False)
class MotorFromData:
    """A motor whose curves follow from its data sheet."""

    station: str  #: Where it acts.
    sheet: MotorDataRow  #: Its data sheet. [pu, s]
    synchronous_speed: float  #: Of its own station. [rad/s]
    torque_base: float  #: 1 per unit of torque. [N m]
    circuit: Circuit  #: From the data sheet. [pu]
    starting: Circuit  #: As it starts: with the discharge resistor and the start factor. [pu]
    stages: tuple[Stage, ...]  #: What it gives on each connection of its start. [SI]

    def stage_at(self, speed: float) -> Stage:
        """The stage at a fraction of synchronous speed. [1]"""
        return next(stage for stage in self.stages if speed <= stage.connection.until)


def torque_curves(circuit: Circuit, torque_base: float) -> SpeedCurves:
    """Average torque and the parts of the pulsating torques as curves against speed.

    Intervals are halved until the curve meets the formula in their middle: where the torque falls to
    zero, and about half speed where one of unequal axes with little stator resistance leaves a notch
    (Görges).

    Parameters
    ----------
    circuit : Circuit
        The motor as it starts. [pu]
    torque_base : float
        1 per unit of torque. [N m]

    Returns
    -------
    SpeedCurves
        [N m]
    """
    knots = np.linspace(0.0, 1.0, FIRST_POINTS)
    allowed = CURVE_ERROR * float(np.max(np.abs(_torques(circuit, knots)[0][0])))
    curves = fitted_curves(lambda x, _: _torques(circuit, x), knots, allowed)
    average, sine, cosine, *at_slip = (curve.scaled(torque_base) for curve in curves)
    return SpeedCurves(average, sine, cosine, tuple(at_slip))


def _torques(circuit: Circuit, speed: Floats) -> tuple[Floats, Floats]:
    """Average torque and the parts of the pulsations, and their slopes. [pu] Shape (3 or 5, n)."""
    n = len(speed)
    slip = 1.0 - speed
    # in step the pulsation of a one-way path has a corner
    beside = slip if circuit.reverse_resistance is None else np.maximum(slip, 2.0 * NEARBY)
    curves = slip_curves(circuit, np.concatenate([slip, beside - NEARBY, beside + NEARBY]))
    # Re(P e^{jχ}), the voltage by χ/2 ahead of axis d and so by χ/2 − 90° ahead of axis q
    parts = [
        curves.average,
        curves.pulsating * sin(curves.phase),
        -curves.pulsating * cos(curves.phase),
    ]
    if circuit.reverse_resistance is not None:
        size, phase = curves.pulsation_1, curves.phase_1
        parts += [-size * cos(phase), -size * sin(phase)]
    torques = np.stack(parts).reshape(len(parts), 3, n)
    return torques[:, 0], (torques[:, 1] - torques[:, 2]) / (2.0 * NEARBY)


def motors_from_data(case: CaseData) -> Iterator[MotorFromData]:
    """Every motor with a data sheet, also one whose torque curve is typed.

    Parameters
    ----------
    case : CaseData
        Checked. [SI]

    Yields
    ------
    MotorFromData
        In the order of `MotorData`. [SI]
    """
    ratings, ratios = case.ratings, case.speed_ratios
    circuits = {row.station: row for row in case.motor_circuit}
    supplies = {row.station: row for row in case.supply}
    for row in case.motor_data:
        assert ratings.synchronous_speed is not None
        assert ratings.line_frequency is not None
        yield _motor(
            row,
            circuits.get(row.station),
            supplies.get(row.station),
            row.base_power(ratings.rated_power),
            ratings.synchronous_speed * ratios[row.station],
            ratings.line_frequency,
        )


def motor_curves(case: CaseData) -> list[dict[str, Any]]:
    """Rows of table `MotorCurves`: every motor with a data sheet, rated voltage behind its supply.

    Parameters
    ----------
    case : CaseData
        Checked. [SI]

    Returns
    -------
    list of dict
        By JSON key, from rest to synchronous speed. [SI]
    """
    rows = []
    for motor in motors_from_data(case):
        above = -1.0
        for stage in motor.stages:
            until, speed = stage.connection.until, 1.0 - SHOWN_SLIPS
            columns = _curves_of(motor, stage, SHOWN_SLIPS[(speed > above) & (speed <= until)])
            above = until
            values = zip(*(column.tolist() for column in columns.values()), strict=True)
            rows += [
                {"station": motor.station} | dict(zip(columns, row, strict=True)) for row in values
            ]
    return rows


def _curves_of(motor: MotorFromData, stage: Stage, slip: Floats) -> dict[str, Floats]:
    """Columns of table `MotorCurves` at slips of one stage. [SI]"""
    curves, source = slip_curves(stage.circuit, slip), stage.connection.source
    torque = source.voltage * source.voltage * motor.torque_base
    current = curves.line_current
    drop = times(np.full(len(slip), complex(source.resistance, source.reactance)), current)
    terminal, taken = modulus(1.0 - drop), times(1.0 - drop, current.conj())
    return {
        "slip": slip,
        "speed": (1.0 - slip) * motor.synchronous_speed,
        "average": torque * curves.average,
        "pulsating": torque * curves.pulsating,
        "phase": curves.phase,
        "current": source.voltage * curves.current,
        "power_factor": taken.real / (terminal * modulus(current)),
        "terminal_voltage": source.voltage * terminal,
        "pulsation_1": torque * curves.pulsation_1,
        "phase_1": curves.phase_1,
    }


def motor_time_constants(case: CaseData) -> list[dict[str, Any]]:
    """Rows of table `MotorTimeConstants`: of each motor with a field and a data sheet.

    Parameters
    ----------
    case : CaseData
        Checked. [SI]

    Returns
    -------
    list of dict
        By JSON key. [s, 1]
    """
    by_circuit = {row.station for row in case.motor_circuit}
    rows = []
    for motor in motors_from_data(case):
        if motor.circuit.field is None or motor.station in by_circuit:
            continue
        omega = line_omega(case.ratings.line_frequency or 0.0)
        both = time_constants(motor.circuit, omega)
        for name, classical, measured in zip(SHOWN_TIMES, *both, strict=True):
            rows.append(
                {
                    "station": motor.station,
                    "time_constant": name,
                    "classical": classical,
                    "measured": measured,
                    "difference": measured / classical - 1.0,
                }
            )
    return rows


def motors_without_curve(case: CaseData) -> dict[str, MotorFromData]:
    """Motors of which the start uses the calculated curves: no curve of theirs is typed.

    Parameters
    ----------
    case : CaseData
        Checked. [SI]

    Returns
    -------
    dict of str to MotorFromData
        By station. [SI]
    """
    typed = {point.station for point in case.motor_torque}
    return {m.station: m for m in motors_from_data(case) if m.station not in typed}


@lru_cache(maxsize=16)  # a study calculates the curves of its motors once
def _motor(
    row: MotorDataRow,
    circuit_row: MotorCircuitRow | None,
    supply: SupplyRow | None,
    base_power: float | None,
    synchronous_speed: float,
    line_frequency: float,
) -> MotorFromData:
    if base_power is None:
        raise InternalError(f"motor '{row.station}' without apparent power was not refused")
    circuit = circuit_of(row, circuit_row, line_frequency)
    starting = as_it_starts(circuit, row)
    torque_base = base_power / synchronous_speed
    stages = []
    for connection in connections_of(supply, base_power, starting):
        on_source = connection.source.before(starting)
        voltage = connection.source.voltage
        curves = torque_curves(on_source, voltage * voltage * torque_base)
        stages.append(Stage(connection, on_source, curves))
    return MotorFromData(
        str(row.station), row, synchronous_speed, torque_base, circuit, starting, tuple(stages)
    )


def circuit_of(
    row: MotorDataRow, circuit_row: MotorCircuitRow | None, line_frequency: float
) -> Circuit:
    """The circuit of a motor as its data sheet or its maker's circuit states it.

    Parameters
    ----------
    row : MotorDataRow
        The data sheet, checked. [pu, s]
    circuit_row : MotorCircuitRow or None
        The maker's circuit, which stands in place of reactances and time constants. [pu]
    line_frequency : float
        Line frequency. [Hz]

    Returns
    -------
    Circuit
        Without discharge resistor and start factor. [pu]
    """
    if circuit_row is not None:
        return _typed_circuit(circuit_row)
    if row.kind == MotorKind.INDUCTION:
        resistance, leakage, magnetising = (_given(v) for v in (row.r_1, row.x_1, row.xm))
        cages = _windings((row.r_2, row.x_2), (row.r_3, row.x_3))
        return Circuit(resistance, leakage, magnetising, magnetising, None, cages, cages)
    omega = line_omega(line_frequency)
    short = row.td_subtransient is not None
    transient, subtransient, across = (
        (row.td_transient, row.td_subtransient, row.tq_subtransient)
        if short
        else (row.td_0_transient, row.td_0_subtransient, row.tq_0_subtransient)
    )
    sheet = (row.xd, row.xq, row.xl, row.xd_subtransient, row.xq_subtransient, subtransient, across)
    xd, xq, xl, xd2, xq2, td2, tq2 = (_given(value) for value in sheet)
    steps = [Step(xd2, td2, short)]
    has_field = row.xd_transient is not None
    if has_field:
        steps.insert(0, Step(_given(row.xd_transient), _given(transient), short))
    of_d = rotor_windings(xd, xl, steps, omega)
    if has_field and row.time_constants == TimeConstantKind.MEASURED:
        three, two = (xd, _given(row.xd_transient), xd2), (_given(transient), td2)
        of_d = _possible(measured_windings(three, xl, two, omega, short_circuit=short))
    of_q = rotor_windings(xq, xl, [Step(xq2, tq2, short)], omega)
    resistance = (
        row.ra if row.ra is not None else stator_resistance(xd2, xq2, _given(row.ta), omega)
    )
    return Circuit(
        resistance, xl, xd - xl, xq - xl, of_d[0] if has_field else None, of_d[has_field:], of_q
    )


def _windings(*pairs: tuple[float | None, float | None]) -> tuple[Winding, ...]:
    return tuple(Winding(r, _given(x)) for r, x in pairs if r is not None)


def _typed_circuit(row: MotorCircuitRow) -> Circuit:
    field = _windings((row.rf, row.xlf))
    return Circuit(
        _given(row.rs),
        _given(row.xl),
        _given(row.xmd),
        _given(row.xmq),
        field[0] if field else None,
        _windings((row.rkd, row.xlkd), (row.rkd_2, row.xlkd_2)),
        _windings((row.rkq, row.xlkq), (row.rkq_2, row.xlkq_2)),
        row.xc or 0.0,
    )


def row_of_circuit(station: str | None, circuit: Circuit) -> MotorCircuitRow:
    """A circuit as a row of table `MotorCircuit`.

    Parameters
    ----------
    station : str or None
        Where the motor acts. [name]
    circuit : Circuit
        With at most two dampers in each axis. [pu]

    Returns
    -------
    MotorCircuitRow
        What it consists of; blank where there is no such winding. [pu]
    """
    windings = {} if circuit.field is None else {"f": circuit.field}
    for axis, dampers in (("kd", circuit.dampers_d), ("kq", circuit.dampers_q)):
        windings |= zip((axis, f"{axis}_2"), dampers, strict=False)
    return MotorCircuitRow(
        station,
        circuit.stator_resistance,
        circuit.stator_leakage,
        circuit.magnetising_d,
        circuit.magnetising_q,
        xc=circuit.common_leakage_d or None,
        **{f"r{name}": winding.resistance for name, winding in windings.items()},
        **{f"xl{name}": winding.leakage for name, winding in windings.items()},
    )


def _possible(windings: tuple[Winding, Winding] | None) -> tuple[Winding, Winding]:
    if windings is None:
        raise InternalError("time constants of no circuit were not refused")
    return windings


def _given(value: float | None) -> float:
    if value is None:
        raise InternalError("a data sheet with a blank was not refused")
    return value


def as_it_starts(circuit: Circuit, row: MotorDataRow) -> Circuit:
    """The circuit in the start, as its row of `MotorData` says.

    Parameters
    ----------
    circuit : Circuit
        The motor. [pu]
    row : MotorDataRow
        Field circuit, discharge resistances and start factor. [1]

    Returns
    -------
    Circuit
        [pu]
    """
    return starting_circuit(
        circuit,
        discharge=row.discharge_resistance or 0.0,
        reverse=row.reverse_discharge,
        is_open=row.field_circuit == FieldCircuit.OPEN,
        factor=1.0 if row.start_factor is None else row.start_factor,
    )
