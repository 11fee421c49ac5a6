"""Events in operation in the start matrix and its ledger."""

from __future__ import annotations

from dataclasses import replace

import pytest

from engine.case.data import (
    EffectChoiceRow,
    MaterialRow,
    MotorEventRow,
    SNPointRow,
    StartConditionRow,
)
from engine.results.tables import result_tables
from engine.run import run
from engine.studies.starts.damage_ledger import damage_ledger, ledger_rows, remaining_rows
from engine.studies.starts.matrix import start_rows
from engine.studies.starts.plan import plan_matrix
from tests.engine.results.test_motor_events import FAULT as SHORT
from tests.engine.results.test_motor_events import motor
from tests.engine.results.test_operating_events import DIP, FAULT, rows, train
from tests.whole_studies import condition_problems, start_matrix, with_conditions

SHAFT = "Low-speed shaft"
PLAIN = StartConditionRow("plain", per_year=10.0, so_far=40.0)


def asked(*conditions: StartConditionRow) -> tuple[StartConditionRow, ...]:
    return conditions


#: Starts damage it, too.
SOFT = {
    "materials": (MaterialRow("steel", 800e6, 500e6, 60e6),),
    "sn_points": (SNPointRow("steel", 1e3, 340e6), SNPointRow("steel", 1e6, 60e6)),
}


def per_life(times: float):
    return train(replace(FAULT[0], per_life=times), FAULT[1], *DIP, **SOFT)


@pytest.mark.parametrize(
    ("begins", "outcome"), [(None, "event in operation"), (1.0, "event in the start")]
)
def test_the_worst_instant_of_an_event_is_a_row_like_any_other(begins, outcome) -> None:
    short = replace(SHORT, clears_after="worst", latest_clearing=0.05, begins=begins)
    case = motor(
        short, effect_choices=(EffectChoiceRow("backlash", "off"),), load_torque=(), **SOFT
    )
    worst = rows(run(case))["event", SHAFT]
    assert worst["worst_clearing_time_of_damage"] > 0.0
    (found,) = start_matrix(case, asked(StartConditionRow("a fault", event="event"))).rows
    assert found.outcome == outcome
    assert found.shaft(SHAFT).damage == worst["damage"]


def test_an_event_is_a_row_like_any_other() -> None:
    case = train(*FAULT, *DIP, **SOFT)
    results = run(case)
    fault = rows(results)["Fault", SHAFT]
    event = StartConditionRow("a fault", so_far=3.0, event="Fault")
    matrix = start_matrix(case, asked(PLAIN, event))
    start, found = matrix.rows
    assert found.shaft(SHAFT).damage == fault["damage"]
    assert found.allowable_starts == pytest.approx(1.0 / fault["damage"], rel=1e-12)
    sizes = [r["times_rated"] for (name, _), r in rows(results).items() if name == "Fault"]
    assert found.peak_over_rated == pytest.approx(max(sizes), rel=1e-12)
    (of_start,) = result_tables(results)["AllowableStarts"]
    assert start.shaft(SHAFT).damage == of_start["damage"]
    (row,) = ledger_rows(damage_ledger(matrix))
    used = 40.0 * of_start["damage"] + 3.0 * fault["damage"]
    assert row["used"] == pytest.approx(used, rel=1e-12)
    shown = start_rows(matrix)[1]
    assert (shown["outcome"], shown["voltage"], shown["trip_speed"]) == (
        "event in operation", None, None,
    )  # fmt: skip


def test_damping_counts_for_an_event_too() -> None:
    case = train(*FAULT)
    event = StartConditionRow("hot", damping_ratio=0.005, event="Fault")
    (found,) = start_matrix(case, asked(event)).rows
    expected = rows(run(replace(case, damping_ratio=0.005)))["Fault", SHAFT]["damage"]
    assert found.shaft(SHAFT).damage == pytest.approx(expected, rel=1e-12)


def test_what_happens_in_a_life_is_taken_from_what_is_left() -> None:
    """Also without a row, and with the standard matrix."""
    case = per_life(5.0)
    damage = rows(run(case))["Fault", SHAFT]["damage"]
    matrix = start_matrix(case, asked(PLAIN))
    assert [r.condition.name for r in matrix.rows] == ["plain", "Fault"]
    ledger = damage_ledger(matrix)
    (row,) = ledger_rows(ledger)
    assert row["events"] == pytest.approx(5.0 * damage, rel=1e-12)
    assert row["left"] == pytest.approx(1.0 - row["used"] - 5.0 * damage, rel=1e-12)
    assert row["remaining_years"] == pytest.approx(row["left"] / row["yearly"], rel=1e-12)
    start, event = remaining_rows(ledger)
    assert start["remaining_starts"] == pytest.approx(row["left"] / start["damage"], rel=1e-12)
    assert event["per_life"] == 5.0
    assert "is kept for events" in ledger.sentence
    assert "Fault" in [c.name for c in plan_matrix(case).conditions]
    none = damage_ledger(start_matrix(per_life(1.01 / damage), asked(PLAIN)))
    assert ledger_rows(none)[0]["verdict"] == "fail"


def test_an_event_of_a_row_is_not_added_again() -> None:
    case = per_life(5.0)
    plan = plan_matrix(
        with_conditions(case, asked(PLAIN, StartConditionRow("named", event="Fault")))
    )
    assert [(c.name, c.per_life) for c in plan.conditions] == [("plain", 0.0), ("named", 5.0)]


def test_an_event_that_is_not_calculated_leaves_a_gap() -> None:
    case = motor(replace(SHORT, per_life=2.0), rated_torque=None, rated_power=None)
    weak = replace(case, motor_circuit=(replace(case.motor_circuit[0], rs=0.9),))
    assert isinstance(weak.motor_events[0], MotorEventRow)
    ledger = damage_ledger(start_matrix(weak, asked(PLAIN)))
    (row,) = ledger_rows(ledger)
    assert row["verdict"] == "not judged"
    assert "does not carry its torque" in row["reason"]


@pytest.mark.parametrize(
    ("row", "column", "words"),
    [
        ({"event": "Falt"}, "Event", "Did you mean 'Fault'?"),
        ({"event": "Fault", "voltage": 0.9}, "Voltage", "no effect on event 'Fault'"),
        ({"event": "Fault", "load": 0.0}, "Load", "no effect on event 'Fault'"),
        ({"event": "Fault", "trip_speed": 100.0}, "Trip speed", "no effect on event 'Fault'"),
        ({"event": "Fault", "so_far": 1.0}, "So far", "counted twice"),
        ({"event": "Fault", "per_year": 1.0}, "Per year", "counted twice"),
    ],
)
def test_wrong_rows_of_events(row: dict, column: str, words: str) -> None:
    (found,) = condition_problems(per_life(2.0), asked(StartConditionRow("fault", **row)))
    assert (found.row, found.column) == (1, column)
    assert words in found.message
