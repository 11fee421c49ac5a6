"""Margins and analyses that a standard asks for."""

from __future__ import annotations

from dataclasses import replace

import pytest

from engine.case.case import Case
from engine.case.choices import MarginBasis, MotorEventKind, Standard
from engine.case.data import CaseData, EventTorqueRow, MotorEventRow
from engine.case.result_words import Judgement
from engine.errors import CaseError
from engine.operation.standards import PROFILES, required_margin, short_circuits_missing
from engine.results.results import Verdict
from engine.results.verdicts import standard_rows
from engine.run import run
from tests.sample_case import sample_case


@pytest.mark.parametrize(
    ("words", "margin"),
    [
        ({}, 0.20),  # Szenasi & von Nimitz (1978), Steady state torsional analysis
        ({"margin_basis": "measured"}, 0.10),  # ibid.
        ({"standard": "Szenasi"}, 0.20),
        ({"standard": "Szenasi", "margin_basis": "measured"}, 0.10),
        ({"standard": "API 617"}, 0.10),  # Wang, Feese & Pettinato (2012)
        ({"standard": "API 617", "margin_basis": "measured"}, 0.10),
        ({"standard": "API 541/546"}, 0.10),
        ({"standard": "API 617", "margin_required": 0.15}, 0.15),
        ({"standard": "own", "margin_required": 0.12}, 0.12),
    ],
)
def test_required_margin(words: dict, margin: float) -> None:
    assert required_margin(sample_case("modified", **words)) == margin


def test_every_standard_has_a_profile_and_every_demand_a_source() -> None:
    assert set(PROFILES) == set(Standard)
    for profile in PROFILES.values():
        assert all(r.source and r.demand.endswith(".") for r in profile.requirements)
        assert set(profile.margins) in (set(), set(MarginBasis))
        for r in profile.requirements:
            assert r.read == ("API" not in r.source)


def test_own_needs_a_margin() -> None:
    with pytest.raises(CaseError) as found:
        Case(**(vars(sample_case("modified")) | {"standard": "own", "margin_required": None}))
    (problem,) = found.value.problems
    assert "Standard is own" in problem.message


def test_an_unknown_standard_names_those_allowed() -> None:
    with pytest.raises(CaseError, match="API 612") as found:
        Case(**(vars(sample_case("modified")) | {"standard": "API 612"}))
    assert "Szenasi, API 617, API 541/546, own" in str(found.value)


def test_short_circuits_that_are_not_there_are_named() -> None:
    case = CaseData(**vars(sample_case("modified", standard="API 541/546")))
    assert short_circuits_missing(case) == ("three-phase fault", "line-to-line fault")
    one = replace(
        case, motor_events=(MotorEventRow("a", "M", MotorEventKind.THREE_PHASE_FAULT.value),)
    )
    assert short_circuits_missing(one) == ("line-to-line fault",)
    maker = replace(case, event_torque=(EventTorqueRow(event="fault"),))
    assert short_circuits_missing(maker) == ()


def passed(*names: str) -> list[Verdict]:
    return [Verdict(n, None, None, "text", Judgement.PASS, "") for n in names]


def test_no_standard_has_no_rows() -> None:
    assert standard_rows(sample_case("modified"), passed("Separation margin")) == ()


def test_a_demand_has_the_worst_verdict_of_its_checks() -> None:
    case = sample_case("modified", standard="API 617")
    fails = Verdict("Allowable starts", 1.0, 2.0, "count", Judgement.FAIL, "")
    checks = [*passed("Separation margin", "Start", "Peak torque"), fails]
    margin, start = standard_rows(case, checks)
    assert (margin.verdict, margin.shown_by) == (Judgement.PASS, "Separation margin")
    assert (start.verdict, start.shown_by) == (
        Judgement.FAIL,
        "Start, Peak torque, Allowable starts",
    )
    assert not margin.text_read
    assert start.missing is None


def test_a_margin_that_is_typed_is_said() -> None:
    case = sample_case("modified", standard="API 617", margin_required=0.15)
    assert "15 % is required" in standard_rows(case, passed("Separation margin"))[0].demand


def test_what_is_missing_keeps_the_whole_incomplete() -> None:
    results = run(Case(**(vars(sample_case("modified")) | {"standard": "API 541/546"})))
    checks = {v.check: v for v in results.verdicts}
    asked = checks["Analyses that API 541/546 asks for"]
    assert asked.verdict == Judgement.NOT_JUDGED
    assert "three-phase fault" in (asked.not_judged or "")
    assert asked.coverage == "2 of 3 requirements"
    assert checks["Overall"].verdict in (Judgement.INCOMPLETE, Judgement.FAIL)
    assert checks["Separation margin"].limit == 0.10


def test_the_paper_asks_for_what_its_example_has() -> None:
    results = run(Case(**(vars(sample_case("modified")) | {"standard": "Szenasi"})))
    checks = {v.check: v for v in results.verdicts}
    asked = checks["Analyses that Szenasi asks for"]
    assert (asked.verdict, asked.not_judged) == (Judgement.PASS, None)
