"""The damage ledger against sums done by hand, and what it may never claim."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from engine.case.case import Case
from engine.case.data import StartConditionRow
from engine.studies.starts.condition_result import NOT_CALCULATED, ConditionResult, ConditionShaft
from engine.studies.starts.conditions import StartCondition
from engine.studies.starts.damage_ledger import damage_ledger, ledger_rows, remaining_rows
from engine.studies.starts.matrix import StartMatrix
from tests.sample_case import sample_case
from tests.whole_studies import start_matrix


def kind(
    name: str,
    damage: float,
    per_year: float = 0.0,
    so_far: float = 0.0,
    *,
    error: float = 0.01,
    judged: bool = True,
    extended: bool = False,
    yields: bool = False,
    shaft: str = "Shaft",
) -> ConditionResult:
    """A kind of start that does a given damage to one shaft."""
    starts = 1.0 / damage if judged and damage else None
    one = ConditionShaft(
        shaft, 1e8, damage, damage * (1 - error), damage * (1 + error), starts,
        judged and damage == 0.0, judged, extended, yields,
    )  # fmt: skip
    words = "reached at 97.0 % speed" if judged else "stalled at 91.0 % speed"
    return ConditionResult(
        StartCondition(name, per_year=per_year, so_far=so_far), words.split()[0], words,
        shafts=(one,), governing=shaft, allowable_starts=starts, judged=judged,
    )  # fmt: skip


def matrix(
    *rows: ConditionResult, factor: float = 1.0, shafts: tuple[str, ...] = ("Shaft",)
) -> StartMatrix:
    return StartMatrix(tuple(rows), shafts, factor, False, True, "", (), "")


def test_three_kinds_by_hand() -> None:
    """0.02 + 0.03 used of 0.5; a year 0.004 + 0.005 + 0.001: 45 years."""
    ledger = damage_ledger(
        matrix(
            kind("normal", 2e-4, per_year=20, so_far=100),
            kind("weak", 5e-4, per_year=10, so_far=60),
            kind("abort", 1e-3, per_year=1),
            factor=2.0,
        )
    )
    (row,) = ledger.rows
    assert row.used == pytest.approx(0.05)
    assert row.yearly == pytest.approx(0.01)
    assert (row.used_low, row.used_high) == pytest.approx((0.0495, 0.0505))
    assert (row.yearly_low, row.yearly_high) == pytest.approx((0.0099, 0.0101))
    assert row.left == pytest.approx(0.45)
    assert row.remaining_years == pytest.approx(45.0)
    assert row.years_low == pytest.approx((0.5 - 0.0505) / 0.0101)
    assert row.years_high == pytest.approx((0.5 - 0.0495) / 0.0099)
    assert row.verdict == "pass"
    assert row.governing == "weak"
    assert [r.remaining_starts for r in ledger.remaining] == pytest.approx([2250.0, 900.0, 450.0])
    assert [r.share for r in ledger.remaining] == pytest.approx([0.4, 0.5, 0.1])
    assert "Palmgren-Miner" in ledger.assumption
    assert "0.5" in ledger.assumption


def test_factor_is_the_one_that_divides_allowable_starts() -> None:
    """One kind of start: (1/q)/F − n are left."""
    ledger = damage_ledger(matrix(kind("only", 1e-3, per_year=5, so_far=30), factor=4.0))
    assert ledger.remaining[0].remaining_starts == pytest.approx(1000.0 / 4.0 - 30.0)
    assert ledger.rows[0].remaining_years == pytest.approx((250.0 - 30.0) / 5.0)


def test_used_up_is_zero_left_and_a_fail() -> None:
    ledger = damage_ledger(matrix(kind("a", 1e-3, per_year=5, so_far=1200), kind("b", 0.0)))
    row = ledger.rows[0]
    assert (row.verdict, row.remaining_years, row.years_low) == ("fail", 0.0, 0.0)
    assert row.left == pytest.approx(-0.2)
    assert [r.remaining_starts for r in ledger.remaining] == [0.0, 0.0]
    assert not any(r.unlimited for r in ledger.remaining)
    assert not row.unlimited
    assert ledger.verdict == "fail"


def test_a_duty_that_is_not_judged_leaves_no_number() -> None:
    ledger = damage_ledger(
        matrix(kind("stalls", 1e-5, so_far=2, judged=False), kind("fine", 1e-3, per_year=1))
    )
    row = ledger.rows[0]
    assert row.verdict == ledger.verdict == "not judged"
    assert (row.used, row.yearly, row.remaining_years, row.unlimited) == (None, None, None, False)
    assert "'stalls' has a duty" in row.reason
    assert "stalled at 91.0 % speed" in row.reason
    assert [(r.judged, r.remaining_starts, r.unlimited) for r in ledger.remaining] == [
        (False, None, False)
    ] * 2


def test_one_without_duty_does_not_matter() -> None:
    ledger = damage_ledger(matrix(kind("stalls", 0.0, judged=False), kind("fine", 1e-3, 10, 0)))
    assert ledger.rows[0].remaining_years == pytest.approx(100.0)
    assert [r.judged for r in ledger.remaining] == [False, True]


def test_one_that_was_not_calculated() -> None:
    gone = ConditionResult(
        StartCondition("gone", per_year=1.0), NOT_CALCULATED, NOT_CALCULATED, remarks=("Stopped.",)
    )
    row = damage_ledger(matrix(gone, kind("fine", 1e-3, 10))).rows[0]
    assert row.verdict == "not judged"
    assert "'gone' was not calculated" in row.reason


def test_no_damage_is_unlimited_and_no_duty_is_nothing() -> None:
    free = damage_ledger(matrix(kind("free", 0.0, per_year=10, so_far=5)))
    assert free.rows[0].unlimited
    assert free.rows[0].remaining_years is None
    assert free.rows[0].verdict == "pass"
    assert free.remaining[0].unlimited
    idle = damage_ledger(matrix(kind("a", 1e-3)))
    assert idle.rows[0].verdict == "not judged"
    assert "No duty" in idle.rows[0].reason
    assert idle.remaining[0].remaining_starts == pytest.approx(1000.0)
    past = damage_ledger(matrix(kind("a", 1e-3, so_far=100)))
    assert (past.rows[0].remaining_years, past.rows[0].unlimited) == (None, False)
    assert "Per year is blank or 0" in past.rows[0].reason


def test_extended_line_is_not_a_pass() -> None:
    row = damage_ledger(matrix(kind("a", 1e-3, per_year=1, extended=True))).rows[0]
    assert row.verdict == "not judged"
    assert row.remaining_years is not None
    assert "above the first S-N point" in row.reason


def test_a_shaft_that_yields_is_not_a_pass() -> None:
    """Beside a kind of start that does not; without a duty of it nothing changes."""
    hard, soft = kind("hard", 1e-3, per_year=1, yields=True), kind("soft", 1e-4, per_year=1)
    row = damage_ledger(matrix(soft, hard)).rows[0]
    assert row.verdict == "not judged"
    assert "above shear yield in 'hard'" in row.reason
    assert damage_ledger(matrix(soft, kind("hard", 1e-3, yields=True))).rows[0].verdict == "pass"


def test_a_start_above_shear_yield_is_told_to_the_ledger() -> None:
    case = sample_case("proposed")
    weak = tuple(replace(m, yield_=0.02 * (m.uts or 0.0)) for m in case.materials)
    duty = (StartConditionRow("a", per_year=1.0),)
    found = damage_ledger(start_matrix(Case(**(vars(case) | {"materials": weak})), duty))
    assert found.verdict == "not judged"
    assert "above shear yield" in found.sentence


def test_a_verdict_that_hangs_on_the_error_says_so() -> None:
    row = damage_ledger(matrix(kind("a", 1e-3, so_far=995, error=0.02))).rows[0]
    assert row.verdict == "pass"
    assert "the verdict is uncertain" in row.reason


def test_train_without_judged_shaft() -> None:
    ledger = damage_ledger(
        matrix(ConditionResult(StartCondition("a", per_year=1.0), "reached", "reached"), shafts=())
    )
    assert (ledger.rows, ledger.verdict) == ((), "not judged")
    assert "no shaft has stress diameter" in ledger.sentence


def test_rows_are_plain() -> None:
    ledger = damage_ledger(matrix(kind("a", 1e-3, per_year=1), kind("b", 0.0, 1)))
    for row in [*ledger_rows(ledger), *remaining_rows(ledger)]:
        for value in row.values():
            assert value is None or isinstance(value, (str, bool, int, float))
            assert not isinstance(value, float) or math.isfinite(value)


damages = st.one_of(st.just(0.0), st.floats(1e-9, 1e-1))
kinds = st.lists(
    st.tuples(damages, st.floats(0.0, 1e3), st.floats(0.0, 1e3), st.floats(0.0, 0.5)),
    min_size=1,
    max_size=6,
)


def of(rows: list[tuple[float, float, float, float]]) -> list[ConditionResult]:
    return [kind(f"k{i}", q, y, n, error=e) for i, (q, y, n, e) in enumerate(rows)]


@given(kinds, st.floats(1.0, 10.0), st.randoms())
def test_order_of_rows_changes_nothing(
    rows: list[tuple[float, float, float, float]], factor: float, random
) -> None:  # type: ignore[no-untyped-def]
    results = of(rows)
    other = list(results)
    random.shuffle(other)
    a, b = (damage_ledger(matrix(*some, factor=factor)).rows[0] for some in (results, other))
    assert replace(a, governing=None, reason="") == replace(b, governing=None, reason="")


@given(kinds, st.floats(1.0, 10.0), st.integers(0, 5), st.floats(0.0, 100.0))
def test_more_duty_never_leaves_more(
    rows: list[tuple[float, float, float, float]], factor: float, which: int, more: float
) -> None:
    i = which % len(rows)
    q, y, n, e = rows[i]
    added = [*rows[:i], (q, y + more, n + more, e), *rows[i + 1 :]]
    a, b = (damage_ledger(matrix(*of(some), factor=factor)).rows[0] for some in (rows, added))
    if a.used is None or b.used is None:
        return
    assert b.left <= a.left  # type: ignore[operator]
    # No years are told where nothing is used in a year, or next to nothing: then it lasts for ever.
    lasts = [math.inf if row.remaining_years is None else row.remaining_years for row in (a, b)]
    assert lasts[1] <= lasts[0]


@given(kinds, st.floats(1.0, 10.0))
def test_the_interval_holds_the_value_and_nothing_is_left_at_its_end(
    rows: list[tuple[float, float, float, float]], factor: float
) -> None:
    row = damage_ledger(matrix(*of(rows), factor=factor)).rows[0]
    if row.used is None:
        return
    years = math.inf if row.remaining_years is None else row.remaining_years
    low = math.inf if row.years_low is None else row.years_low
    high = math.inf if row.years_high is None else row.years_high
    assert low <= years <= high
    if row.remaining_years and math.isfinite(years):
        assert row.used + years * row.yearly == pytest.approx(row.allowed, rel=1e-9)  # type: ignore[operator]


def test_a_duty_on_the_papers_train() -> None:
    """Sums of the damage that the rows of the matrix themselves state."""
    case = sample_case("proposed", starts_factor=2.0)
    rows = (
        StartConditionRow("normal", per_year=20.0, so_far=100.0),
        StartConditionRow("weak, unloaded", voltage=0.8, load=0.0, per_year=40.0),
    )
    found = start_matrix(case, rows)
    normal, weak = (r.allowable_starts for r in found.rows)
    assert normal is not None
    assert weak is not None
    (row,) = damage_ledger(found).rows
    assert row.remaining_years == pytest.approx((0.5 - 100 / normal) / (20 / normal + 40 / weak))
    assert row.verdict == "pass"
