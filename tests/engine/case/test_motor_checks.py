"""Wrong data sheets of motors are found at their cells; right ones pass."""

from __future__ import annotations

from dataclasses import replace

import pytest

from engine.case.checks.find_problems import find_problems
from engine.case.data import CaseData, MotorCircuitRow, MotorDataRow, StationRow

SHEET = MotorDataRow(
    "motor", None, 1e6, xd=1.6, xq=1.6, xd_transient=0.1375, xd_subtransient=0.1214, xq_subtransient=0.148, xl=0.1,
    td_0_transient=0.26, td_0_subtransient=0.007, tq_0_subtransient=0.12, ta=0.014, discharge_resistance=9.0,
)  # fmt: skip
SHORT = {
    "td_0_transient": None, "td_0_subtransient": None, "tq_0_subtransient": None, "td_transient": 0.02,
    "td_subtransient": 0.006, "tq_subtransient": 0.011,
}  # fmt: skip
CIRCUIT = MotorCircuitRow("motor", 0.012, 0.12, 1.1, 0.62, 0.0022, 0.18, 0.035, 0.09, 0.045, 0.12)
BY_CIRCUIT = MotorDataRow("motor", None, 1e6, discharge_resistance=9.0)

INDUCTION = MotorDataRow("motor", "induction", 1e6, r_1=0.01, x_1=0.1, xm=4.0, r_2=0.012, x_2=0.1)


def case(*motors, circuits=(), **fields):
    stations = (StationRow("motor", None, 100.0), StationRow("second", None, 50.0))
    given = {"line_frequency": 60.0, "poles": 4, "stations": stations} | fields
    return CaseData(motor_data=motors, motor_circuit=circuits, **given)


def places(data):
    return [
        (p.table, p.row, p.column)
        for p in find_problems(data)
        if p.table not in ("Elements", "Stations")
    ]


@pytest.mark.parametrize(
    ("data", "circuits"),
    [
        (SHEET, ()),
        (replace(SHEET, **SHORT), ()),
        (replace(SHEET, ta=None, ra=0.0), ()),
        (replace(SHEET, xd_transient=None, td_0_transient=None, discharge_resistance=None), ()),
        (replace(SHEET, field_circuit="open", discharge_resistance=None), ()),
        (replace(SHEET, discharge_resistance_reverse="open"), ()),
        (replace(BY_CIRCUIT, discharge_resistance_reverse=0.0), (CIRCUIT,)),
        (BY_CIRCUIT, (CIRCUIT,)),
        (INDUCTION, ()),
        (replace(INDUCTION, r_3=0.1, x_3=0.03), ()),
    ],
    ids=[
        "data sheet",
        "short circuit",
        "Ra",
        "no field",
        "open field",
        "one way open",
        "one way",
        "circuit",
        "induction",
        "double cage",
    ],
)
def test_good_motors_pass(data, circuits):
    assert places(case(data, circuits=circuits)) == []


def test_the_rated_power_may_give_the_base():
    data = replace(SHEET, apparent_power=None, power_factor=-0.8, efficiency=0.95)
    assert places(case(data, rated_power=7.6e5)) == []
    assert data.base_power(7.6e5) == pytest.approx(1e6, rel=1e-12)


@pytest.mark.parametrize(
    ("change", "column", "words"),
    [
        ({"xl": 0.13}, "Xl", "found 0.13 pu; it must be below Xd subtransient, 0.1214 pu"),
        ({"xd_subtransient": 0.1375}, "Xd subtransient", "below Xd transient, 0.1375 pu"),
        ({"xd_transient": 1.7}, "Xd transient", "below Xd, 1.6 pu"),
        ({"xq_subtransient": 1.7}, "Xq subtransient", "below Xq, 1.6 pu"),
        ({"xd_subtransient": 12.14}, "Xd subtransient", "Write 18 % or 0.18 pu"),
        ({"xl": 0.001}, "Xl", "Write 18 % or 0.18 pu"),
        ({"td_0_subtransient": 7.0}, "Td0 subtransient", "Write 35 ms or 0.035 s"),
        ({"td_0_subtransient": 0.3}, "Td0 subtransient", "below Td0 transient, 0.26 s"),
        (
            {"apparent_power": None},
            "Apparent power",
            "Type it in kVA from the name plate, or RatedPower",
        ),
        ({"td_transient": 0.02}, "Td transient", "there are two sets of time constants"),
        ({"ra": 0.01}, "Ta", "both are given. Clear one of the two"),
        ({"ta": None}, "Ta", "both are blank. Type one of the two"),
        ({"td_0_transient": None}, "Td0 transient", "A field winding has both"),
        ({"xd_transient": None}, "Xd transient", "A field winding has both"),
        ({"tq_0_subtransient": None}, "Tq0 subtransient", "Type it from the data sheet"),
        ({"xd": None}, "Xd", "or give the circuit of the motor in table MotorCircuit"),
        ({"field_circuit": "open"}, "Discharge resistance", "blank where Field circuit is open"),
        ({"field_circuit": "shut"}, "Field circuit", "one of closed, open"),
        ({"time_constants": "tested"}, "Time constants", "one of classical, measured"),
        (
            {"time_constants": "measured", "td_0_subtransient": 0.2},
            "Td0 subtransient",
            "type the short-circuit time constants Td transient and Td subtransient instead",
        ),
        ({"power_factor": 80.0}, "Power factor", "at most 1 (100 %)"),
        ({"power_factor": 0.0}, "Power factor", "below 0 only where it lags"),
        (
            {"discharge_resistance_reverse": -1.0},
            "Discharge resistance reverse",
            "multiple of the resistance",
        ),
        (
            {
                "discharge_resistance": None,
                "discharge_resistance_reverse": 9.0,
                "field_circuit": "open",
            },
            "Discharge resistance reverse",
            "blank where Field circuit is open",
        ),
        (
            {
                "discharge_resistance": None,
                "discharge_resistance_reverse": 9.0,
                "xd_transient": None,
                "td_0_transient": None,
            },
            "Discharge resistance reverse",
            "blank without a field winding",
        ),
        ({"start_factor": 0.0}, "Start factor", "usually by 0.7 to 1"),
        ({"station": "motr"}, "Station", "Did you mean 'motor'?"),
    ],
    ids=lambda value: value if isinstance(value, str) and " " not in value else None,
)
def test_wrong_data_are_found_at_their_cell(change, column, words):
    (problem,) = [
        p for p in find_problems(case(replace(SHEET, **change))) if p.table == "MotorData"
    ]
    assert (problem.row, problem.column) == (1, column)
    assert words in problem.message


@pytest.mark.parametrize(
    ("change", "column"),
    [
        ({"station": "second"}, "Station"),
        ({"xmd": None}, "Xmd"),
        ({"rs": 1.2}, "Rs"),
        ({"xmd": 110.0}, "Xmd"),
        ({"xmd": 0.1}, "Xmd"),
        ({"xmq": 0.11}, "Xmq"),
        ({"xlkd": None}, "Xlkd"),
        ({"rkq_2": 0.1}, "Xlkq2"),
    ],
)
def test_wrong_circuits_are_found_at_their_cell(change, column):
    data = (BY_CIRCUIT,) if "station" not in change else (SHEET,)
    assert places(case(*data, circuits=(replace(CIRCUIT, **change),))) == [
        ("MotorCircuit", 1, column)
    ]


def test_a_circuit_leaves_nothing_to_the_data_sheet():
    assert places(case(SHEET, circuits=(CIRCUIT,))) == [("MotorData", 1, "Xd")]


def test_two_motors_have_an_apparent_power_each():
    data = replace(SHEET, apparent_power=None, power_factor=0.8, efficiency=0.95)
    found = places(case(data, replace(SHEET, station="second"), rated_power=1e6))
    assert found == [("MotorData", 1, "Apparent power")]


def test_a_motor_needs_the_line():
    found = places(case(SHEET, line_frequency=None, poles=None))
    assert found == [("Case", None, "SynchronousSpeed")]
    assert places(case(SHEET, poles=5)) == [("Case", None, "Poles")]


@pytest.mark.parametrize(
    ("change", "column", "words"),
    [
        ({"r_2": None}, "R2", "equivalent circuit"),
        ({"xd": 1.6}, "Xd", "blank unless Kind is synchronous"),
        ({"field_circuit": "open"}, "Field circuit", "blank unless Kind is synchronous"),
        ({"r_3": 0.1}, "X3", "given where R3 is"),
        ({"x_1": 10.0}, "X1", "Per cent and per unit mixed up?"),
        ({"xm": 0.09}, "Xm", "Are Xm and X1 interchanged"),
        ({"r_1": 3.0}, "R1", "Per cent and per unit mixed up?"),
        ({"kind": "inductoin"}, "Kind", "synchronous"),
        ({"power_factor": -0.9}, "Power factor", "always lags: type it without sign"),
    ],
)
def test_wrong_induction_motors_are_found_at_their_cell(change, column, words):
    found = find_problems(case(replace(INDUCTION, **change)))
    problem = next(p for p in found if p.table == "MotorData")
    assert (problem.row, problem.column) == (1, column)
    assert words in problem.message


def test_an_equivalent_circuit_of_no_kind_is_told():
    assert ("MotorData", 1, "R1") in places(case(replace(INDUCTION, kind=None)))


def test_an_equivalent_circuit_of_the_wrong_kind_is_one_problem():
    (found,) = places(case(replace(INDUCTION, kind=None)))
    assert found[-1] == "R1"


def test_small_oscillations_are_unknown_with_a_one_way_path():
    one_way = replace(SHEET, discharge_resistance_reverse=0.0)
    assert places(case(one_way, torque_follows="machine")) == [
        ("MotorData", 1, "Discharge resistance reverse")
    ]
    same = replace(SHEET, discharge_resistance_reverse=SHEET.discharge_resistance)
    assert places(case(same, torque_follows="machine")) == []
