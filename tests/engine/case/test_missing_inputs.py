"""What a case cannot answer is what its results do not hold."""

from __future__ import annotations

from dataclasses import replace

import pytest
from sample_case import sample_case, with_limits

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
    case = with_limits(sample_case("modified"))
    assert missing_inputs(case) == ()
    results = run(case)
    assert results.verdicts[0].verdict == "accepted by forced response"
    assert {v.not_judged for v in results.verdicts} == {None}


def without(case: Case, element: str, **columns) -> Case:
    elements = (replace(e, **columns) if e.element == element else e for e in case.elements)
    return replace(case, elements=tuple(elements))


@pytest.mark.parametrize(
    ("element", "columns", "checks", "said"),
    [
        ("HS coupling", {"peak_torque_limit": None}, ("Peak torque",), ("Peak torque not judged",)),
        (
            "HS coupling",
            {"vibratory_limit": None},
            ("Separation margin", "Vibratory torque"),
            ("Not judged in continuous operation",),
        ),
        ("Mesh", {"reversal_limit": None}, ("Torque reversal",), ("A torque reversal, if",)),
        (
            "Gear shaft",
            {"stress_diameter": None, "material": None, "scf": None},
            ("Steady-state stress (peak-to-peak)", "Shear yield in the start", "Allowable starts"),
            (
                "Not judged in continuous operation",
                "Shear yield in the start not judged",
                "Allowable starts not judged",
            ),
        ),
    ],
)
def test_what_is_missing_is_what_the_verdicts_do_not_judge(element, columns, checks, said):
    case = without(with_limits(sample_case("modified")), element, **columns)
    found = missing_inputs(case)
    assert [sentence.startswith(words) for sentence, words in zip(found, said, strict=True)]
    assert all(f" {element}." in sentence for sentence in found)
    results = run(case)
    assert results.verdicts[0].verdict == "incomplete"
    open_ = {v.check: v for v in results.verdicts[1:] if v.not_judged}
    assert set(open_) == {*checks, *(open_.keys() & {"Separation margin"})}
    assert all(element in v.not_judged for v in open_.values())
    assert {v.verdict for v in open_.values()} <= {"incomplete", "not judged"}
    assert all(v.where or v.verdict == "not judged" for v in open_.values())


def judged(case: Case) -> dict[str, str]:
    return {row.check: row.verdict for row in run(case).verdicts}


def test_what_a_start_needs_besides_limits():
    whole = with_limits(sample_case("modified"))
    for change, said in (
        ({"starts_required": None}, "StartsRequired is blank"),
        ({"sn_points": ()}, "Allowable starts not judged: Motor shaft; Gear shaft; "),
        ({"motor_torque": ()}, "No start: tables MotorTorque and TorqueTime are empty"),
    ):
        case = replace(whole, **change)
        (found,) = missing_inputs(case)
        assert said in found
        verdicts = judged(case)
        assert verdicts["Overall"] == "incomplete"
        assert verdicts["Allowable starts"] == "not judged"
        assert (verdicts["Start"] == "pass") == bool(case.motor_torque)
