"""Motors from their data sheets: the circuit, and torques and current against slip, in per unit."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from addin.contract.sheets import range_of
from addin.contract.tables import input_table
from addin.worksheet.answers import Rows
from addin.worksheet.blocks import case_of_motors, problems_in_words
from addin.worksheet.registry import Argument, Block, FunctionError, registered
from engine.case.choices import MotorEventKind
from engine.errors import ModelError
from engine.motor.circuit import Circuit
from engine.motor.curves import slip_curves
from engine.motor.fault_torques import KINDS, fault_torque, largest_fault_torque
from engine.motor.from_case import SHOWN_SLIPS, as_it_starts, circuit_of, row_of_circuit

#: Place of these functions among all, in lists and in the documentation.
ORDER = 32
#: Slips of one answer.
MOST_SLIPS = 10_000

DATA = Argument("Data", "block", "Table MotorData with headers and units.")
FREQUENCY = Argument(
    "Line frequency", "number", "Line frequency [Hz]; needed where Data has time constants.", True
)
CIRCUIT = Argument(
    "Circuit",
    "block",
    "Table MotorCircuit with headers and units, for motors given by their circuit.",
    True,
)
CIRCUIT_COLUMNS = input_table("MotorCircuit").columns
CURVES = {
    "Station": "", "Slip": "", "Speed": "%", "Average": "pu", "Pulsating": "pu", "Phase": "deg", "Current": "pu",
    "Power factor": "", "Pulsation1": "pu", "Phase1": "deg",
}  # fmt: skip


def _motors(
    data: Block, frequency: float | None, circuit: Block | None
) -> list[tuple[str, Circuit, Circuit]]:
    """Station of each motor, its circuit, and the one with which it starts."""
    case, problems = case_of_motors(data, circuit, frequency)
    if problems:
        raise FunctionError(problems_in_words(problems))
    circuits = {row.station: row for row in case.motor_circuit}
    found = []
    for row in case.motor_data:
        typed = circuits.get(row.station)
        if typed is None and (frequency is None or not frequency > 0.0):
            raise FunctionError(
                "Line frequency: give it in Hz; resistances follow from time constants with it."
            )
        of_motor = circuit_of(row, typed, frequency or math.nan)
        found.append((str(row.station), of_motor, as_it_starts(of_motor, row)))
    return found


@registered(
    "TV_MOTOR_CIRCUIT",
    DATA,
    FREQUENCY,
    CIRCUIT,
    columns=len(CIRCUIT_COLUMNS),
    example=f"=TV_MOTOR_CIRCUIT({range_of('MotorData')}, 60)",
)
def tv_motor_circuit(data: Block, frequency: float | None, circuit: Block | None) -> Rows:
    """Circuit of each motor from its data sheet, per unit, as table MotorCircuit has it.

    Without discharge resistor and Start factor, which belong to the start.
    """
    rows: Rows = [[f"{c.name} [pu]" if c.has_unit else c.name for c in CIRCUIT_COLUMNS]]
    for station, of_motor, _ in _motors(data, frequency, circuit):
        row = row_of_circuit(station, of_motor)
        rows.append([getattr(row, column.attribute) for column in CIRCUIT_COLUMNS])
    return rows


@registered(
    "TV_MOTOR_CURVES",
    DATA,
    Argument("Slips", "numbers", "Slips, 1 at rest and 0 in step; blank = every 0.01.", True),
    FREQUENCY,
    CIRCUIT,
    columns=len(CURVES),
    example=f"=TV_MOTOR_CURVES({range_of('MotorData')}, , 60)",
)
def tv_motor_curves(
    data: Block, slips: Rows | None, frequency: float | None, circuit: Block | None
) -> Rows:
    """Average and pulsating torques, their phases, current and power factor of each motor against slip.

    Per unit of Apparent power / synchronous speed, at rated voltage, with discharge resistor and Start
    factor. The phase is that of cos(2 s ω t), the voltage lying along the axis of the poles at t = 0. Pulsation1 is the torque at
    the slip frequency itself, of a one-way discharge path, with the phase of cos(s ω t).
    """
    given = [value for row in slips or () for value in row if value is not None]
    if len(given) > MOST_SLIPS:
        raise FunctionError(f"Slips: found {len(given)}; give at most {MOST_SLIPS}.", "#NUM!")
    slip = np.array(given, dtype=float) if given else SHOWN_SLIPS
    rows: Rows = [[f"{name} [{unit}]" if unit else name for name, unit in CURVES.items()]]
    for station, _, starting in _motors(data, frequency, circuit):
        curves = slip_curves(starting, slip)
        columns: tuple[Any, ...] = (
            slip, 100.0 * (1.0 - slip), curves.average, curves.pulsating, curves.phase * (180.0 / math.pi),
            curves.current, curves.power_factor, curves.pulsation_1, curves.phase_1 * (180.0 / math.pi),
        )  # fmt: skip
        values = zip(*(column.tolist() for column in columns), strict=True)
        rows += [[station, *row] for row in values]
    return rows


@registered(
    "TV_FAULT_TORQUE",
    Argument("Kind", "text", f"{', '.join(KINDS[:-1])} or {KINDS[-1]}."),
    Argument("Xd subtransient", "number", "Subtransient reactance Xd'' [pu]."),
    Argument("Xq subtransient", "number", "Subtransient reactance Xq'' [pu]."),
    Argument("Cycles", "number", "Cycles of the line since the event; blank: the largest torque.", True),
    Argument(
        "Angle", "number",
        "Angle of the motor's voltage ahead of the line's at closing [deg]; blank: the worst.", True,
    ),
    by_cell=True,
    example='=TV_FAULT_TORQUE("three-phase fault", 0.2, 0.25)',
)  # fmt: skip
def tv_fault_torque(
    kind: str, xd: float, xq: float, cycles: float | None, angle: float | None
) -> float:
    """Air-gap torque of a fault by the formula of constant flux linkages, over S / ω_s: no load, no resistance.

    The largest is a magnitude; at a time, negative brakes. A line-to-line fault is that of a motor off the line, with the
    largest offset; table MotorEvents calculates one on the line. It is a check and no bound.
    """
    closing = None if angle is None else math.radians(angle)
    try:
        largest = largest_fault_torque(kind, xd, xq, closing)
    except ModelError as error:
        raise FunctionError(f"No torque: {error}.") from error
    if cycles is None:
        return largest
    if kind == MotorEventKind.OUT_OF_PHASE_CLOSING and closing is None:
        raise FunctionError("Angle: give it in degrees; at a time there is no worst one.")
    turned, ahead = np.array([2.0 * math.pi * cycles]), np.array([closing or 0.0])
    return float(fault_torque(kind, xd, xq, turned, ahead)[0])
