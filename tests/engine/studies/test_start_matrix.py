"""The start matrix: each row is the nominal run of the changed case, and says what it changed."""

from __future__ import annotations

import math
import pickle
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.special import fresnel

from engine.case.case import Case
from engine.case.data import CaseData, EffectChoiceRow, ModeDampingRow, StartConditionRow
from engine.run import run
from engine.studies.starts.condition_result import (
    NOT_CALCULATED,
    ConditionResult,
    ConditionShaft,
    calculate_condition,
    start_row,
)
from engine.studies.starts.conditions import (
    TRIP_INSTANTS,
    StartCondition,
    condition_case,
)
from engine.studies.starts.matrix import gather_matrix, start_rows, voltage_rows
from engine.studies.starts.plan import (
    LATEST_RESPONSE,
    STANDARD_VOLTAGES,
    MatrixPlan,
    plan_matrix,
)
from tests.sample_case import sample_case
from tests.whole_studies import condition_problems, start_matrix, with_conditions

SYNCHRONOUS = 60.0 * math.pi


def asked(*rows: StartConditionRow) -> tuple[StartConditionRow, ...]:
    return rows


@pytest.fixture(scope="module")
def case() -> Case:
    return sample_case("proposed")


# --- what is calculated ---------------------------------------------------------------------------


def test_blank_table_is_the_standard_matrix(case: Case) -> None:
    plan = plan_matrix(case)
    whole = [c for c in plan.conditions if c.trip_speed is None]
    assert [c.voltage for c in whole] == list(STANDARD_VOLTAGES) * 2
    assert [c.load for c in whole] == [1.0] * 7 + [0.0] * 7
    assert all(c.damping_ratio is None for c in plan.conditions)
    trips = [c for c in plan.conditions if c.trip_speed is not None]
    assert all(c.voltage == 1.0 and c.load == 1.0 for c in trips)
    shares = [(c.trip_speed or 0.0) / SYNCHRONOUS for c in trips]
    assert shares == sorted(shares)
    assert {0.5, 0.75, 0.95} <= {round(s, 9) for s in shares}
    assert len({c.name for c in plan.conditions}) == len(plan.conditions)


def test_aborted_just_past_each_crossing(case: Case) -> None:
    """Speeds from the crossings of the nominal run, and the peak of Cornu's spiral from scipy."""
    u = np.linspace(0.5, 2.0, 150_001)
    S, C = fresnel(u)
    late = float(u[np.argmax(np.hypot(C + 0.5, S + 0.5))]) / math.sqrt(2.0)
    assert pytest.approx(late, abs=2e-4) == LATEST_RESPONSE
    trips = {c.why: c.trip_speed for c in plan_matrix(case).conditions if c.trip_speed}
    crossings = [c for c in run(case).crossings if c.percent_speed is not None]
    assert len(crossings) == 3
    for crossing in crossings:
        assert crossing.sweep_rate is not None
        f = crossing.frequency - late * math.sqrt(crossing.sweep_rate)
        (found,) = (v for k, v in trips.items() if k.startswith(f"just past mode {crossing.mode} "))
        assert found == pytest.approx(SYNCHRONOUS * (1.0 - f / 120.0), rel=1e-4)


def test_a_train_without_load_is_not_calculated_twice(case: Case) -> None:
    plan = plan_matrix(replace(CaseData(**vars(case)), load_torque=()))
    assert len([c for c in plan.conditions if c.trip_speed is None]) == 7
    assert any("no LoadTorque" in note for note in plan.notes)


def test_no_trip_beyond_the_speed_where_full_voltage_ends(case: Case) -> None:
    plan = plan_matrix(sample_case("proposed", end_speed=0.6 * SYNCHRONOUS))
    assert all((c.trip_speed or 0.0) <= 0.6 * SYNCHRONOUS for c in plan.conditions)
    assert any("just past mode 1" in note for note in plan.notes)
    # nor does any of its instants lie beyond: what is left of the period is cut off
    end = 0.5005 * SYNCHRONOUS
    trips = [
        c
        for c in plan_matrix(sample_case("proposed", end_speed=end)).conditions
        if c.why == "fixed speed"
    ]
    assert [c.trip_speed for c in trips] == pytest.approx([0.5 * SYNCHRONOUS])
    assert trips[0].trip_span == pytest.approx(0.0005 * SYNCHRONOUS)


def test_no_instant_of_a_trip_past_a_crossing_is_beyond_the_end(case: Case) -> None:
    """The end of the start is put inside the period in which that trip is tried."""
    past = next(c for c in plan_matrix(case).conditions if c.why.startswith("just past"))
    assert past.trip_speed is not None
    end = past.trip_speed + 0.4 * past.trip_span
    plan = plan_matrix(sample_case("proposed", end_speed=end))
    (cut,) = (c for c in plan.conditions if c.why == past.why)
    assert cut.trip_speed == pytest.approx(past.trip_speed)
    assert cut.trip_speed + cut.trip_span == pytest.approx(end)
    assert max(c.trip_speed for c in cut.instants) < end


def test_rows_stand_alone_unless_the_standard_is_asked_for(case: Case) -> None:
    row = StartConditionRow("100 % voltage, loaded", per_year=10.0)
    assert len(plan_matrix(with_conditions(case, asked(row))).conditions) == 1
    both = plan_matrix(with_conditions(case, asked(row)), with_standard=True).conditions
    assert len(both) == 1 + len(plan_matrix(case).conditions)
    assert len({c.name for c in both}) == len(both)


# --- one start ------------------------------------------------------------------------------------


def test_a_row_of_blanks_is_the_plain_run(case: Case) -> None:
    plain = run(case)
    (row,) = start_matrix(case, asked(StartConditionRow("plain"))).rows
    assert plain.start is not None
    assert plain.starts is not None
    assert row.outcome == plain.outcome
    assert row.time == plain.start.outcome.time
    assert [s.damage for s in row.shafts] == [s.damage for s in plain.starts.shafts]
    assert row.allowable_starts == plain.starts.starts
    assert row.governing == plain.starts.governing
    hp = next(p for p in plain.start.peaks if p.element == "HP compressor shaft")
    d = next(e for e in case.elements if e.element == hp.element).stress_diameter
    assert d is not None
    assert row.peak_to_peak_stress == pytest.approx(16.0 * hp.peak_to_peak / math.pi / d**3)
    mesh = next(p for p in plain.start.peaks if p.element == "Mesh")
    assert (row.mesh, row.mesh_minimum_torque) == ("Mesh", mesh.minimum)


def test_the_interval_of_the_damage_holds_both_errors(case: Case) -> None:
    """That of the history, as the nominal run states it, and the change between two steps."""
    plain = run(case)
    assert plain.starts is not None
    (stated,) = plain.starts.shafts
    step = dict(plain.starts_error)[stated.element]
    assert step
    for change in (step, 0.5):  # as it is, and where the two steps are far apart
        wide = replace(plain, starts_error=((stated.element, change),))
        shaft = start_row(case, StartCondition("plain"), wide).shafts[0]
        assert shaft.damage_high >= stated.damage * (1.0 + change) * (1.0 - 1e-12)
        assert shaft.damage_high >= stated.damage_high > stated.damage
        assert shaft.damage_low <= stated.damage * (1.0 - change) * (1.0 + 1e-12)
        assert shaft.damage_low <= stated.damage_low < stated.damage


def test_the_shaft_with_the_most_damage_governs_not_the_one_with_the_most_stress() -> None:
    """The thinner shaft has the larger nominal stress, the notched one beside it the fewer starts."""
    case = sample_case("proposed")
    elements = {e.element: e for e in case.elements}
    hp = elements["HP compressor shaft"]
    assert hp.stress_diameter is not None
    plain = run(case)
    assert plain.start is not None
    span = {p.element: p.peak_to_peak for p in plain.start.peaks}
    other = "Pinion shaft"
    # 60 % of the nominal stress of the HP shaft, under three times its SCF
    d = hp.stress_diameter * (span[other] / span[hp.element] / 0.6) ** (1.0 / 3.0)
    notched = replace(
        elements[other], stress_diameter=d, scf=3.0 * (hp.scf or 1.0), material=hp.material
    )
    two = Case(
        **(
            vars(case)
            | {"elements": tuple(notched if e.element == other else e for e in case.elements)}
        )
    )
    (row,) = start_matrix(two, asked(StartConditionRow("plain"))).rows
    of = {s.element: s for s in row.shafts}
    assert of[other].peak_to_peak_stress == pytest.approx(0.6 * of[hp.element].peak_to_peak_stress)
    assert of[other].damage > of[hp.element].damage
    assert row.governing == other
    assert row.allowable_starts == of[other].allowable_starts
    assert row.peak_to_peak_stress == of[other].peak_to_peak_stress


def test_a_standard_trip_is_tried_over_one_period_of_the_mode(case: Case) -> None:
    """The speed gained in 1/f: torque over inertia by hand, from the points of the curves."""
    plan = plan_matrix(case)
    inertia = sum((s.inertia or 0.0) * (s.speed_ratio or 1.0) ** 2 for s in case.stations)
    ratio = {s.station: s.speed_ratio or 1.0 for s in case.stations}
    f = run(case).modes.elastic_frequency

    def acceleration(speed: float) -> float:
        share = speed / SYNCHRONOUS
        net = np.interp(
            share, *zip(*((p.speed, p.average) for p in case.motor_torque), strict=True)
        )
        for name in {p.station for p in case.load_torque}:
            points = [(p.speed, p.torque) for p in case.load_torque if p.station == name]
            net -= ratio[name] * np.interp(share, *zip(*points, strict=True))
        return float(net) / inertia

    trips = [c for c in plan.conditions if c.trip_speed is not None]
    assert len(trips) >= 4
    end = 0.97 * SYNCHRONOUS
    for c in trips:
        assert c.trip_speed is not None
        mode = int(c.why.split()[3]) if c.why.startswith("just past mode") else 1
        gained = min(acceleration(c.trip_speed) / float(f[mode - 1]), end - c.trip_speed)
        assert c.trip_span == pytest.approx(gained, rel=0.05), c.why


def test_voltage_and_load_are_those_of_a_case_that_says_so(case: Case) -> None:
    curve = tuple(replace(p, torque=0.5 * (p.torque or 0.0)) for p in case.load_torque)
    said = run(sample_case("proposed", voltage=0.85, load_torque=curve))
    (row,) = start_matrix(case, asked(StartConditionRow("weak", voltage=0.85, load=0.5))).rows
    assert said.start is not None
    assert row.time == pytest.approx(said.start.outcome.time, rel=1e-12)
    assert row.allowable_starts == pytest.approx(said.starts.starts, rel=1e-9)  # type: ignore[union-attr]


def test_peak_torque_is_referred_to_the_motor(case: Case) -> None:
    plain = run(case)
    assert plain.start is not None
    ratio = {s.station: s.speed_ratio or 1.0 for s in case.stations}
    by_hand = max(
        max(abs(p.maximum), abs(p.minimum)) * ratio[e.from_]
        for p in plain.start.peaks
        for e in case.elements
        if e.element == p.element
    )
    (row,) = start_matrix(case, asked(StartConditionRow("plain"))).rows
    assert row.peak_torque == pytest.approx(by_hand, rel=1e-12)
    assert row.peak_over_rated == pytest.approx(by_hand / (case.rated_torque or 0.0), rel=1e-12)


def test_hot_damping_scales_mode_damping_in_proportion(case: Case) -> None:
    base = sample_case("proposed", mode_damping=(ModeDampingRow(1, 0.01), ModeDampingRow(2, 0.03)))
    assert base.damping_ratio is not None
    new = condition_case(base, StartCondition("hot", damping_ratio=2.0 * base.damping_ratio))
    assert new.damping_ratio == 2.0 * base.damping_ratio
    assert [m.damping_ratio for m in new.mode_damping] == pytest.approx([0.02, 0.06])
    none = condition_case(
        replace(CaseData(**vars(base)), damping_ratio=None),
        StartCondition("hot", damping_ratio=0.05),
    )
    assert none.damping_ratio == 0.05
    assert none.mode_damping == base.mode_damping


def test_more_damping_never_hurts_here(case: Case) -> None:
    cold, hot = start_matrix(
        case,
        asked(StartConditionRow("cold", damping_ratio=0.01), StartConditionRow("hot", damping_ratio=0.04)),
    ).rows  # fmt: skip
    assert (cold.allowable_starts or 0.0) < (hot.allowable_starts or 0.0)


def test_an_aborted_start_is_counted_with_its_coast_down(case: Case) -> None:
    trip = 0.8 * SYNCHRONOUS
    said = run(sample_case("proposed", trip_speed=trip))
    (row,) = start_matrix(case, asked(StartConditionRow("abort", trip_speed=trip))).rows
    assert row.words == "tripped at 80.0 % speed"
    assert row.judged
    assert row.allowable_starts == pytest.approx(said.starts.starts, rel=1e-9)  # type: ignore[union-attr]
    assert "coast-down is counted" in row.note


def test_a_trip_asked_for_overrules_the_effect_forced_off() -> None:
    case = sample_case("proposed", effect_choices=(EffectChoiceRow("aborted start", "off"),))
    (row,) = start_matrix(
        case, asked(StartConditionRow("abort", trip_speed=0.5 * SYNCHRONOUS))
    ).rows
    assert row.outcome == "tripped"


def test_a_stalled_start_is_not_judged_and_never_unlimited(case: Case) -> None:
    # read at its own speed the motor drives the vibration, so that cycles count
    case = replace(case, torque_follows="own speed")
    stalled, weaker = start_matrix(
        case,
        asked(StartConditionRow("weak", voltage=0.5), StartConditionRow("weaker", voltage=0.2)),
    ).rows
    assert stalled.words.startswith("stalled at 92.7 %")
    for row in (stalled, weaker):
        assert not row.judged
        assert not row.unlimited
        assert row.allowable_starts is None
        assert row.note.startswith("Incomplete start: ")
        assert all(s.allowable_starts is None and not s.unlimited for s in row.shafts)
    assert stalled.shafts[0].damage > 0.0
    assert "counted up to" in stalled.note
    (told,) = start_rows(gather_matrix(case, plan_matrix(with_conditions(case, asked(
        StartConditionRow("weak", voltage=0.5)))), [stalled]))  # fmt: skip
    assert told["allowable_starts"] is None
    assert "unlimited" not in told
    assert told["judged"] is False


def test_counting_forced_off_is_told() -> None:
    case = sample_case("proposed", effect_choices=(EffectChoiceRow("cycle counting", "off"),))
    (row,) = start_matrix(case, asked(StartConditionRow("plain"))).rows
    assert not row.judged
    assert "forced off" in row.note


def test_a_train_without_judged_shaft_has_no_starts_and_says_so(case: Case) -> None:
    matrix = start_matrix(sample_case("proposed", sn_points=()), asked(StartConditionRow("plain")))
    assert matrix.rows[0].shafts == ()
    assert not matrix.rows[0].unlimited
    assert matrix.sentence.startswith("No shaft has stress diameter")
    assert matrix.rows[0].peak_over_rated is not None


# --- gathering ------------------------------------------------------------------------------------


def test_units_of_work_travel_and_may_come_in_any_order(case: Case) -> None:
    studies = asked(StartConditionRow("a", voltage=0.9), StartConditionRow("b", voltage=1.1))
    plan = plan_matrix(with_conditions(case, studies))
    sent = pickle.loads(pickle.dumps([(case, c) for c in plan.conditions]))
    rows = [pickle.loads(pickle.dumps(calculate_condition(*unit))) for unit in reversed(sent)]
    assert gather_matrix(with_conditions(case, studies), plan, rows) == start_matrix(case, studies)


def test_the_order_of_rows_changes_no_row(case: Case) -> None:
    rows = (StartConditionRow("a", voltage=0.9), StartConditionRow("b", damping_ratio=0.03))
    one, other = (start_matrix(case, asked(*some)).rows for some in (rows, rows[::-1]))

    def of(result: ConditionResult) -> tuple[Any, ...]:
        return result.allowable_starts, result.peak_torque, result.time, result.note

    assert [of(r) for r in one] == [of(r) for r in other[::-1]]


def test_of_several_instants_the_worst_stands_in_the_row(case: Case) -> None:
    """Damage by hand: the third instant is the worst of one shaft, the fifth of the other."""
    condition = StartCondition("trip", trip_speed=100.0, trip_span=8.0, why="fixed speed")
    instants = condition.instants
    assert [c.trip_speed for c in instants] == pytest.approx([100.0 + k for k in range(8)])
    assert {c.trip_span for c in instants} == {0.0}

    def row(one: StartCondition, a: float, b: float) -> ConditionResult:
        shafts = tuple(
            ConditionShaft(n, 1e8, q, q, q, 1.0 / q, False, True, False)
            for n, q in (("A", a), ("B", b))
        )
        return ConditionResult(
            one, "tripped", "tripped", shafts=shafts, governing="A" if a >= b else "B",
            allowable_starts=1.0 / max(a, b), judged=True, remarks=("Tripped.",),
        )  # fmt: skip

    damage = (
        [(1e-4, 1e-5)] * 2 + [(9e-4, 1e-5)] + [(1e-4, 1e-5)] + [(1e-4, 5e-4)] + [(1e-4, 1e-5)] * 3
    )
    rows = [row(one, *q) for one, q in zip(instants, damage, strict=True)]
    plan = MatrixPlan((condition,), standard=True)
    assert plan.units == instants
    for some in (rows, rows[::-1]):
        (found,) = gather_matrix(case, plan, some).rows
        assert found.condition == condition
        assert found.governing == "A"
        assert found.allowable_starts == pytest.approx(1.0 / 9e-4)
        assert [s.damage for s in found.shafts] == [9e-4, 5e-4]
        assert found.note == (
            "Worst of 8 trip instants within one period of the torsional vibration; the most favourable instant allows 10,000 starts. "
            "Tripped."
        )
    # extremes of an instant that does less damage
    limit = tuple(
        replace(s, peak_to_peak_stress=2e8, extended=True, yields=s.element == "B")
        for s in rows[1].shafts
    )
    rows[1] = replace(
        rows[1], shafts=limit, peak_torque=9e3, peak_over_rated=3.0, peak_element="B",
        mesh_minimum_torque=-5.0, mesh="Mesh", impacts=4,
    )  # fmt: skip
    others = [replace(r, peak_torque=8e3, mesh_minimum_torque=2.0, mesh="Mesh") for r in rows]
    (found,) = gather_matrix(case, plan, [*others[:1], rows[1], *others[2:]]).rows
    assert (found.governing, found.allowable_starts) == ("A", pytest.approx(1.0 / 9e-4))
    assert (found.peak_torque, found.peak_over_rated, found.peak_element) == (9e3, 3.0, "B")
    assert (found.peak_to_peak_stress, found.mesh_minimum_torque, found.impacts) == (2e8, -5.0, 4)
    assert [(s.extended, s.yields) for s in found.shafts] == [(True, False), (True, True)]
    assert "Cycles above the first S-N point (A, B)" in found.note
    assert "Nominal peak above shear yield (B)" in found.note
    stalled = replace(rows[0], outcome="stalled", judged=False, allowable_starts=None)
    (found,) = gather_matrix(case, plan, [stalled, *rows[1:]]).rows
    assert not found.judged


def test_the_worst_instant_is_that_of_most_damage_not_of_most_stress() -> None:
    """Instant 2 damages nine times as much as instant 5, which has twice its stress and torque."""
    condition = StartCondition("trip", trip_speed=100.0, trip_span=8.0, why="fixed speed")
    plan = MatrixPlan((condition,), standard=True)

    def row(one: StartCondition, damage: float, size: float) -> ConditionResult:
        shaft = ConditionShaft(
            "A", 1e8 * size, damage, damage, damage, 1.0 / damage, False, True, False
        )
        return ConditionResult(
            one, "tripped", "tripped", peak_torque=1e3 * size, peak_to_peak_stress=1e8 * size,
            shafts=(shaft,), governing="A", allowable_starts=1.0 / damage, judged=True,
        )  # fmt: skip

    answers = {2: (9e-4, 1.0), 5: (1e-4, 2.0)}
    rows = [row(one, *answers.get(k, (1e-5, 0.5))) for k, one in enumerate(condition.instants)]
    (found,) = gather_matrix(sample_case("proposed"), plan, rows).rows
    assert found.allowable_starts == pytest.approx(1.0 / 9e-4)
    assert [s.damage for s in found.shafts] == [9e-4]
    assert [s.allowable_starts for s in found.shafts] == pytest.approx([1.0 / 9e-4])
    assert (found.peak_to_peak_stress, found.peak_torque) == (2e8, 2e3)


@pytest.mark.slow
def test_a_standard_trip_is_the_worst_of_its_instants(case: Case) -> None:
    """What a trip does hangs on the phase of the ringing: eight within one period of the mode."""
    plan = plan_matrix(case)
    condition = next(c for c in plan.conditions if c.why.startswith("just past mode 1"))
    assert len(condition.instants) == TRIP_INSTANTS
    f = float(run(case).modes.elastic_frequency[0])
    rows = [calculate_condition(case, one) for one in condition.instants]
    starts = [r.allowable_starts or math.inf for r in rows]
    assert max(starts) > 2.0 * min(starts)
    alone = replace(plan, conditions=(condition,))
    (worst,) = gather_matrix(case, alone, rows).rows
    assert worst.allowable_starts == min(starts)
    assert worst.condition == condition
    assert worst.note.startswith("Worst of 8 trip instants within one period")
    times = [float(r.note.split(" after ")[1].split(" s")[0]) for r in rows]
    assert times[-1] - times[0] == pytest.approx(7.0 / 8.0 / f, rel=0.1)
    (gone,) = gather_matrix(case, alone, rows[:-1]).rows
    assert gone.outcome == NOT_CALCULATED


def test_stopping_leaves_rows_that_say_so(case: Case) -> None:
    matrix = start_matrix(case, (), first=2)
    assert not matrix.complete
    assert [r.outcome != NOT_CALCULATED for r in matrix.rows[:3]] == [True, True, False]
    assert matrix.rows[2].note == "Stopped before this start."


def test_rows_of_the_tables_are_plain_and_finite(case: Case) -> None:
    matrix = start_matrix(case, asked(StartConditionRow("a"), StartConditionRow("b", voltage=0.5)))
    for row in [*start_rows(matrix), *voltage_rows(matrix)]:
        for key, value in row.items():
            assert value is None or isinstance(value, (str, bool, int, float)), key
            assert not isinstance(value, float) or math.isfinite(value), key


# --- wrong rows -----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("row", "column", "says"),
    [
        (StartConditionRow("a", voltage=80.0), "Voltage", "Write 80 % or 0.8"),
        (StartConditionRow("a", voltage=0.0), "Voltage", "must be positive"),
        (StartConditionRow("a", damping_ratio=1.5), "Damping ratio", "below 1 (100 %)"),
        (StartConditionRow("a", damping_ratio=0.5), "Damping ratio", "ModeDamping is scaled"),
        (StartConditionRow("a", load=-0.1), "Load", "from 0 to 2"),
        (StartConditionRow("a", load=80.0), "Load", "Write 80 % or 0.8"),
        (StartConditionRow("a", trip_speed=1800.0), "Trip speed", "synchronous speed"),
        (
            StartConditionRow("a", trip_speed=0.99 * SYNCHRONOUS),
            "Trip speed",
            "never reaches TripSpeed",
        ),
        (StartConditionRow("a", trip_speed=-1.0), "Trip speed", "positive"),
        (StartConditionRow("a", per_year=-1.0), "Per year", "zero or more"),
        (StartConditionRow("a", so_far=math.inf), "So far", "finite"),
        (StartConditionRow(None), "Condition", "blank"),
        (StartConditionRow("first"), "Condition", "also in row 1"),
    ],
)
def test_wrong_rows_are_told(row: StartConditionRow, column: str, says: str) -> None:
    case = sample_case("proposed", mode_damping=(ModeDampingRow(1, 0.5),))
    found = condition_problems(case, asked(StartConditionRow("first"), row))
    assert [(p.table, p.row, p.column) for p in found] == [("StartConditions", 2, column)]
    assert says in found[0].message


def test_everything_wrong_is_told_at_once(case: Case) -> None:
    row = StartConditionRow(None, None, 80.0, 2.0, -0.8, -1.0, 1e4, -1.0, math.nan)
    found = condition_problems(case, asked(row))
    assert {p.column for p in found} == {
        "Condition", "Voltage", "Damping ratio", "Stiffness factor", "Load", "Trip speed", "Per year", "So far",
    }  # fmt: skip


def test_load_of_a_train_without_load_and_a_train_without_motor(case: Case) -> None:
    bare = replace(CaseData(**vars(case)), load_torque=())
    (found,) = condition_problems(bare, asked(StartConditionRow("a", load=0.0)))
    assert "table LoadTorque is empty" in found.message
    still = replace(CaseData(**vars(case)), motor_torque=(), load_torque=())
    (found,) = condition_problems(still, asked(StartConditionRow("a")))
    assert "table MotorTorque is empty" in found.message
    assert condition_problems(still, asked(StartConditionRow("a", "steady"))) == ()
    assert condition_problems(case, ()) == ()


def test_rows_by_voltage(case: Case) -> None:
    """Only whole starts with the damping of the case."""
    matrix = start_matrix(
        case,
        asked(
            StartConditionRow("a", voltage=1.1),
            StartConditionRow("b", voltage=0.5),
            StartConditionRow("c", voltage=1.1, load=0.0),
            StartConditionRow("d", voltage=1.1, damping_ratio=0.05),
            StartConditionRow("e", voltage=0.9, load=0.5),
        ),
    )
    (high,) = voltage_rows(matrix)
    assert high["loaded_starts"] == matrix.rows[0].allowable_starts
    assert high["unloaded_stress"] == matrix.rows[2].peak_to_peak_stress
