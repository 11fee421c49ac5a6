"""Checks of table Supply: each mistake is named with its cell and what to do."""

from __future__ import annotations

from dataclasses import replace

import pytest

from engine.case.checks.find_problems import find_problems
from engine.case.data import CaseData, MotorTorqueRow, SupplyRow, SupplyVoltageRow
from tests.engine.case.test_motor_checks import SHEET, case

GOOD = SupplyRow("motor", 150e6, 15.0, "autotransformer", 0.65, 0.9)

SOFT = {
    "starting": "soft start", "tap": None, "switch_over_speed": None, "initial_voltage": 0.4, "ramp_time": 5.0,
}  # fmt: skip


def supplied(**changes: object) -> CaseData:
    return case(SHEET, supply=(replace(GOOD, **changes),))  # type: ignore[arg-type]


def found(data: CaseData) -> list[tuple[str, str]]:
    return [(p.column, p.message) for p in find_problems(data) if p.table == "Supply"]


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"starting": "reactor"},
        {"open_time": 0.08},
        {"starting": "direct", "tap": None, "switch_over_speed": None},
        {"short_circuit_power": None, "x_r": None},
        SOFT,
        SOFT | {"short_circuit_power": None, "x_r": None},
    ],
)
def test_right_input(changes: dict[str, object]) -> None:
    assert found(supplied(**changes)) == []


@pytest.mark.parametrize(
    ("changes", "column", "words"),
    [
        ({"station": "second"}, "Station", "type its row there, or the voltage"),
        ({"station": None}, "Station", "blank"),
        ({"short_circuit_power": 150e3}, "Short-circuit power", "kVA typed as MVA"),
        ({"short_circuit_power": -1.0}, "Short-circuit power", "must be positive"),
        ({"x_r": 1500.0}, "X/R", "at most 200"),
        ({"starting": "star delta"}, "Starting", "one of direct, autotransformer, reactor"),
        ({"tap": 65.0}, "Tap", "write 65 % or 0.65"),
        ({"tap": None}, "Tap", "given for Starting autotransformer"),
        ({"switch_over_speed": 90.0}, "Switch-over speed", "Write 90 %"),
        ({"switch_over_speed": None}, "Switch-over speed", "given for Starting autotransformer"),
        ({"open_time": 80.0}, "Open time", "Write 80 ms or 0.08 s"),
        ({"starting": "direct", "tap": None, "switch_over_speed": None, "open_time": 0.08}, "Open time", "clear the cell"),
        ({"starting": "direct", "switch_over_speed": None}, "Tap", "Choose autotransformer or reactor"),
        (SOFT | {"initial_voltage": 40.0}, "Initial voltage", "write 40 % or 0.4"),
        (SOFT | {"ramp_time": 5000.0}, "Ramp time", "Milliseconds typed as seconds?"),
        (SOFT | {"ramp_time": None}, "Ramp time", "given for Starting soft start"),
        (SOFT | {"tap": 0.5}, "Tap", "blank where Starting is soft start"),
        ({"ramp_time": 5.0}, "Ramp time", "Choose soft start in Starting"),
        (SOFT | {"station": "second"}, "Station", "a station of table MotorData"),
        (SOFT | {"station": "second", "short_circuit_power": None, "x_r": None}, "Station", "Give its torque curve in MotorTorque"),
    ],
)  # fmt: skip
def test_one_mistake(changes: dict[str, object], column: str, words: str) -> None:
    ((where, message),) = found(supplied(**changes))
    assert where == column
    assert words in message


def test_voltage_typed_and_calculated() -> None:
    typed = tuple(SupplyVoltageRow("motor", x, 0.9) for x in (0.0, 1.0))
    ((where, message),) = found(replace(supplied(), supply_voltage=typed))
    assert where == "Station"
    assert "without rows in table SupplyVoltage" in message


def test_two_rows_of_one_motor() -> None:
    ((where, _),) = found(replace(supplied(), supply=(GOOD, GOOD)))
    assert where == "Station"


def test_a_soft_starter_alone_needs_no_data_sheet() -> None:
    row = replace(GOOD, **SOFT, short_circuit_power=None, x_r=None)  # type: ignore[arg-type]
    curve = tuple(MotorTorqueRow("motor", x, 9e3, 2e3) for x in (0.0, 1.0))
    assert found(case(supply=(row,), motor_torque=curve)) == []
    ((where, _),) = found(
        case(supply=(replace(row, short_circuit_power=150e6),), motor_torque=curve)
    )
    assert where == "Station"
