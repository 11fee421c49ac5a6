"""Several cases: each typed condition has the verdicts of the changed case run alone, and the worst governs."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import pytest

from engine.case.case import Case
from engine.case.choices import ElementKind
from engine.case.data import CaseData, EventTorqueRow, StartConditionRow
from engine.results.results import CaseVerdict, Results, Verdict
from engine.results.tables import result_tables
from engine.run import run
from engine.studies.starts.case_verdicts import run_with_conditions
from tests.sample_case import sample_case
from tests.whole_studies import condition_problems, with_conditions

TRIP = 0.75 * 60.0 * math.pi


def calculated(case: CaseData, *rows: StartConditionRow) -> Results:
    return run_with_conditions(Case(**vars(with_conditions(case, rows))))


def of_condition(results: Results, name: str) -> list[Verdict]:
    return [
        Verdict(**{k: v for k, v in vars(row).items() if k != "condition"})
        for row in results.case_verdicts
        if row.condition == name
    ]


def softer(case: CaseData, factor: float) -> CaseData:
    elements = tuple(
        replace(e, stiffness=factor * (e.stiffness or 0.0)) if e.kind == ElementKind.COUPLING else e
        for e in case.elements
    )
    return replace(case, elements=elements)


def less_load(case: CaseData, share: float) -> CaseData:
    rows = tuple(replace(r, torque=share * (r.torque or 0.0)) for r in case.load_torque)
    return replace(case, load_torque=rows)


def test_each_condition_has_the_verdicts_of_a_single_run() -> None:
    case = CaseData(**vars(sample_case("modified")))
    single = {
        StartConditionRow("100 %"): case,
        StartConditionRow("weak", voltage=0.8): replace(case, voltage=0.8),
        StartConditionRow("hot", damping_ratio=0.015, stiffness_factor=0.8): replace(
            softer(case, 0.8), damping_ratio=0.015
        ),
        StartConditionRow("unloaded", load=0.0): less_load(case, 0.0),
        StartConditionRow("aborted", trip_speed=TRIP): replace(case, trip_speed=TRIP),
    }
    found = calculated(case, *single)
    for row, changed in single.items():
        assert of_condition(found, str(row.condition)) == list(run(Case(**vars(changed))).verdicts)


def test_continuous_operation_has_its_checks_alone() -> None:
    case = CaseData(**vars(sample_case("modified")))
    found = calculated(case, StartConditionRow("hot", "steady", stiffness_factor=0.7))
    single = run(Case(**vars(softer(case, 0.7)))).verdicts
    names = ("Separation margin", "Steady-state", "Vibratory")
    wanted = [v for v in single if v.check.startswith(names)]
    assert of_condition(found, "hot")[1:] == wanted
    (row,) = result_tables(found)["CaseMatrix"]
    assert row["start"] is None
    assert row["changed"] == "steady operation; couplings × 0.7"


def test_the_worst_governs_and_is_named() -> None:
    """A case without a failure: what fails it is the one condition, and the overall verdict says which."""
    case = CaseData(**vars(sample_case("modified", starts_required=1.0)))
    found = calculated(
        case, StartConditionRow("plain"), StartConditionRow("no breakaway", voltage=0.1)
    )
    plain = run(Case(**vars(case))).verdicts
    (check,) = [v for v in found.verdicts if v.check == "Other conditions"]
    assert found.verdicts[0].verdict == "fail" == check.verdict
    assert plain[0].verdict == "incomplete"
    assert check.where == "no breakaway"
    assert f"Other conditions ({check.where})" in found.verdicts[0].where
    assert (check.coverage, check.not_judged) == ("1 of 2 conditions", "plain")
    assert [v for v in found.verdicts[1:] if v is not check] == list(plain[1:])


def test_a_blank_table_changes_nothing() -> None:
    case = sample_case("modified")
    assert run_with_conditions(case).verdicts == run(case).verdicts
    assert run_with_conditions(case).case_verdicts == ()


def test_a_condition_that_cannot_be_calculated_leaves_the_whole_open(monkeypatch: Any) -> None:
    from engine.errors import ModelError
    from engine.studies.starts import case_verdicts

    def refuse(case: Case) -> Results:
        raise ModelError("It cannot be.")

    monkeypatch.setattr(case_verdicts, "at_speed", refuse)
    found = calculated(sample_case("modified"), StartConditionRow("hot", "steady"))
    (row,) = found.case_verdicts
    assert isinstance(row, CaseVerdict)
    assert (row.check, row.verdict) == ("Overall", "incomplete")
    assert "It cannot be." in row.where
    assert found.verdicts[0].verdict in ("fail", "incomplete")


@pytest.mark.parametrize(
    ("row", "column", "says"),
    [
        ({"kind": "steady", "voltage": 0.8}, "Voltage", "no effect on continuous operation"),
        ({"kind": "steady", "per_year": 3.0}, "Per year", "no effect on continuous operation"),
        ({"kind": "sudden"}, "Kind", "Choose from the list."),
        ({"stiffness_factor": 0.0}, "Stiffness factor", "must be positive"),
    ],
)
def test_wrong_rows(row: dict[str, Any], column: str, says: str) -> None:
    (found,) = condition_problems(sample_case("modified"), [StartConditionRow("a", **row)])
    assert (found.row, found.column) == (1, column)
    assert says in found.message


def test_a_factor_of_couplings_needs_one() -> None:
    case = CaseData(**vars(sample_case("modified")))
    shafts = tuple(
        replace(e, kind=ElementKind.SHAFT) if e.kind == ElementKind.COUPLING else e
        for e in case.elements
    )
    row = StartConditionRow("hot", stiffness_factor=0.8)
    (found,) = condition_problems(replace(case, elements=shafts), [row])
    assert "no element of table Elements is a coupling" in found.message


def test_a_condition_does_not_repeat_a_note_of_the_case() -> None:
    """The note of an event is not repeated by the condition that is this event."""
    fault = EventTorqueRow("fault", "Motor", -7.0, 1.0, -0.5 * math.pi, 0.08)
    case = replace(CaseData(**vars(sample_case("modified"))), event_torque=(fault,))
    results = calculated(case, StartConditionRow("short circuit", event="fault"))
    assert of_condition(results, "short circuit")
    told = [note for note in results.warnings if "Event 'fault' reverses" in note]
    assert len(told) == 1
    assert not told[0].startswith("Condition")
