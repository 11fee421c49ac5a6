"""Motors in cells: circuit and curves from a range with the data sheet."""

from __future__ import annotations

import json
import math
from pathlib import Path

import pytest

from addin.worksheet.registry import FunctionError, call

CASES = Path(__file__).resolve().parents[1] / "validation" / "cases"
SM04 = json.loads((CASES / "SM04_start_average_pulsating.json").read_text(encoding="utf-8"))
SM06 = json.loads((CASES / "SM06_data_sheet_to_circuit.json").read_text(encoding="utf-8"))["sets"][
    0
]
#: Key of the case → header and unit.
SHEET = {
    "xd": ("Xd", "pu"), "xq": ("Xq", "pu"), "xd_transient": ("Xd transient", "pu"),
    "xd_subtransient": ("Xd subtransient", "pu"), "xq_subtransient": ("Xq subtransient", "pu"),
    "xl": ("Xl", "pu"), "Td0_transient": ("Td0 transient", "s"), "Td0_subtransient": ("Td0 subtransient", "s"),
    "Tq0_subtransient": ("Tq0 subtransient", "s"), "Ta": ("Ta", "s"),
}  # fmt: skip


def data(scale=1.0, unit="pu", **changed):
    """The data sheet of SM06 as a range; reactances in another unit."""
    values = {key: SM06["inputs"][key] for key in SHEET} | changed
    units = [unit if u == "pu" else u for _, u in SHEET.values()]
    numbers = [
        v if v is None or u == "s" else v * scale
        for v, (_, u) in zip(values.values(), SHEET.values(), strict=True)
    ]
    return [[None, *units], ["Station", *(name for name, _ in SHEET.values())], ["M", *numbers]]


def with_nameplate(block):
    """The same with apparent power and voltage: 1 MVA, 6.6 kV."""
    more = (["MVA", "kV"], ["Apparent power", "Voltage"], [1.0, 6.6])
    return [[*row, *cells] for row, cells in zip(block, more, strict=True)]


def circuit():
    m = SM04["motor"]
    names = ("rs", "Xls", "Xmd", "Xmq", "rf", "Xlf", "rkd", "Xlkd", "rkq", "Xlkq")
    headers = ["Rs", "Xl", "Xmd", "Xmq", "Rf", "Xlf", "Rkd", "Xlkd", "Rkq", "Xlkq"]
    return [[None] + ["%"] * 10, ["Station", *headers], ["M", *(100.0 * m[name] for name in names)]]


def test_the_circuit_of_the_published_data_sheet():
    headers, row = call("TV_MOTOR_CIRCUIT", [data(), 50.0])
    found = dict(zip(headers, row, strict=True))
    assert found["Station"] == "M"
    for name, key in (
        ("Rs", "rs"),
        ("Xmd", "xmd"),
        ("Rf", "rf"),
        ("Xlf", "xlf"),
        ("Rkd", "rkd"),
        ("Xlkq", "xlkq"),
    ):
        assert found[f"{name} [pu]"] == pytest.approx(SM06["circuit"][key], rel=1e-9)
    assert found["Rkd2 [pu]"] is None


def test_the_curves_of_the_reference_motor():
    starting = [[None, "1"], ["Station", "Discharge resistance"], ["M", 9.0]]
    slips = [[row["slip"]] for row in SM04["rows_rd_9rf"]]
    headers, *rows = call("TV_MOTOR_CURVES", [starting, slips, None, circuit()])
    for row, expected in zip(rows, SM04["rows_rd_9rf"], strict=True):
        found = dict(zip(headers, row, strict=True))
        assert found["Average [pu]"] == pytest.approx(expected["average"], abs=1e-6)
        assert found["Pulsating [pu]"] == pytest.approx(expected["pulsating"], abs=1e-6)
        assert found["Phase [deg]"] == pytest.approx(
            expected["phase_rad"] * 57.29577951308232, abs=1e-4
        )
        assert found["Current [pu]"] == pytest.approx(expected["current"], abs=1e-6)


def test_ohm_and_per_unit_are_the_same_motor():
    in_ohm = with_nameplate(data(6.6e3**2 / 1e6, "ohm"))
    of_both = [
        call("TV_MOTOR_CIRCUIT", [block, 50.0])[1][1:11] for block in (in_ohm, data(100.0, "%"))
    ]
    assert of_both[0] == pytest.approx(of_both[1], rel=1e-12)


def test_every_per_cent_of_slip_unless_asked():
    rows = call("TV_MOTOR_CURVES", [data(), None, 50.0])[1:]
    assert [row[1] for row in rows] == pytest.approx([1.0 - k / 100 for k in range(101)], abs=1e-12)
    assert rows == call("TV_MOTOR_CURVES", [data(), [[row[1]] for row in rows], 50.0])[1:]


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ([data(), None], "Line frequency: give it in Hz"),
        ([data(xl=0.13), None, 50.0], "MotorData, row 1, Xl: found 0.13 pu; it must be below Xd subtransient"),
        ([data(6.6e3**2 / 1e6, "ohm"), None, 50.0], "Type Voltage and Apparent power"),
        ([circuit(), None, 50.0], "contains table MotorCircuit"),
    ],
)  # fmt: skip
def test_what_is_wrong_is_said(arguments, words):
    with pytest.raises(FunctionError) as caught:
        call("TV_MOTOR_CURVES", arguments)
    assert words in caught.value.message


# --- faults -------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("kind", "times"),
    [
        ("three-phase fault", 1.0),
        ("line-to-line fault", 0.75 * math.sqrt(3.0)),
        ("out-of-phase closing", 1.5 * math.sqrt(3.0)),  # at 120 degrees
    ],
)
def test_largest_torques_of_equal_reactances(kind, times):
    assert call("TV_FAULT_TORQUE", [kind, 0.2, 0.2])[0][0] == pytest.approx(times / 0.2, rel=1e-9)


def test_closing_at_an_angle():
    for degrees in (30.0, 90.0, -120.0):
        half = 0.5 * math.radians(abs(degrees))
        expected = (math.sin(2.0 * half) + 2.0 * math.sin(half)) / 0.15
        given = ["out-of-phase closing", 0.15, 0.15, None, degrees]
        assert call("TV_FAULT_TORQUE", given)[0][0] == pytest.approx(expected, rel=1e-9)


def test_torque_at_a_time():
    """T = −[sin ω₀t / Xd'' − ½ (1/Xd'' − 1/Xq'') sin 2ω₀t]."""
    t = 2.0 * math.pi * 0.3
    expected = -(math.sin(t) / 0.2 - 0.5 * (1.0 / 0.2 - 1.0 / 0.3) * math.sin(2.0 * t))
    found = call("TV_FAULT_TORQUE", ["three-phase fault", 0.2, 0.3, 0.3])[0][0]
    assert found == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize(
    ("given", "words"),
    [
        (["short circuit", 0.2, 0.2], "is none of three-phase fault"),
        (["three-phase fault", 0.0, 0.2], "both reactances must be positive"),
        (["out-of-phase closing", 0.2, 0.2, 0.5], "at a time there is no worst one"),
    ],
)
def test_wrong_faults(given, words):
    with pytest.raises(FunctionError, match=words):
        call("TV_FAULT_TORQUE", given)
