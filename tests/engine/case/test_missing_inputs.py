"""What a case cannot answer is what its results do not hold."""

from __future__ import annotations

from dataclasses import replace

import pytest
from sample_case import sample_case

from engine.case.case import Case
from engine.case.data import ElementRow, ExcitationRow, LoadTorqueRow, StationRow
from engine.case.missing_inputs import missing_inputs
from engine.results.tables import result_tables
from engine.run import run

STATIONS = (StationRow("Motor", inertia=10.0), StationRow("Fan", inertia=40.0))
LOADED = (STATIONS[0], replace(STATIONS[1], running_load=1000.0))
SHAFT = (ElementRow("Shaft", kind="shaft", from_="Motor", to="Fan", stiffness=1e6),)
ROW = ExcitationRow(name="x", frequency=20.0, station="Fan")
LOAD = (LoadTorqueRow("Fan", 0.0, 5.0), LoadTorqueRow("Fan", 1.0, 50.0))


@pytest.mark.parametrize(
    "given",
    [
        {},
        {"stations": STATIONS[:1], "elements": ()},
        {"line_frequency": 60.0},
        {"line_frequency": 60.0, "poles": 4},
        {"line_frequency": 60.0, "poles": 4, "rated_power": 1e6},
        {"minimum_speed": 100.0, "maximum_speed": 200.0},
        {"rated_torque": 1000.0},
        {"stations": LOADED},
        {"stations": LOADED, "line_frequency": 60.0},
        {"excitations": (ROW,)},
        {"excitations": (replace(ROW, torque=50.0),)},
        {"excitations": (ExcitationRow(name="x", order=1.0),)},
        {
            "excitations": (ExcitationRow(name="y", order=1.0), replace(ROW, station=None)),
            "rated_torque": 10.0,
        },
        {"load_torque": LOAD, "line_frequency": 60.0, "poles": 4},
    ],
)
def test_margins_and_forced_response_are_missing_where_it_is_said(given):
    case = Case(**{"stations": STATIONS, "elements": SHAFT, "damping_ratio": 0.02} | given)
    tables = result_tables(run(case))
    said = " ".join(missing_inputs(case))
    assert ("No natural frequencies" in said) == (not case.elements)
    assert ("o separation margins" in said) == (not tables["SeparationMargins"])
    assert ("o forced response" in said) == (not tables["SteadyState"])
    assert "No start: tables MotorTorque and TorqueTime are empty" in said


def test_a_complete_case_answers_everything():
    case = sample_case("modified", starts_required=100)
    said = ("No verdict on a torque reversal: no element has a Reversal limit.",)
    assert missing_inputs(case) == said


def judged(case: Case) -> dict[str, str]:
    return {row.check: row.verdict for row in run(case).verdicts}


def test_what_a_start_needs_besides_the_motor():
    whole = sample_case("modified", starts_required=100)
    limited = tuple(replace(e, reversal_limit=1e6) for e in whole.elements)
    bare = tuple(replace(e, stress_diameter=None, material=None, scf=None) for e in limited)
    for change, said in (
        ({}, ()),
        ({"starts_required": None}, ("StartsRequired is blank",)),
        ({"sn_points": ()}, ("No allowable starts: no element with a Stress diameter has points",)),
        (
            {"elements": bare},
            ("No stress judged", "No allowable starts: no element has a Stress diameter"),
        ),  # fmt: skip
        ({"motor_torque": ()}, ("No start: tables MotorTorque and TorqueTime are empty",)),
    ):
        case = replace(whole, **({"elements": limited} | change))
        found = missing_inputs(case)
        assert len(found) == len(said), found
        assert all(words in one for words, one in zip(said, found, strict=True))
        verdicts = judged(case)
        assert (verdicts["Allowable starts"] == "not judged") == bool(said)
        assert ("Start" in verdicts) == bool(case.motor_torque)
        assert any("stress" in check for check in verdicts) != ("elements" in change)
