"""The checks at a glance: of several elements the one nearest to its own limit is shown."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from engine.case.case import Case
from engine.case.result_words import Judgement
from engine.operation.steady_state import SteadyStateRow
from engine.results.results import Results, Verdict
from engine.results.tables import result_tables
from engine.results.times import accuracy_of
from engine.results.verdicts import verdicts_of
from engine.run import run
from tests.sample_case import sample_case

MPA = 1e6
#: Nearer to its limit than the first, though the smaller of the two.
FIRST, SECOND = "HP compressor shaft", "Pinion shaft"


@pytest.fixture(scope="module")
def results() -> Results:
    return run(sample_case("proposed"))


def check(results: Results, name: str) -> Verdict:
    (found,) = (v for v in verdicts_of(results) if v.check == name)
    return found


def changed(case: Case, **columns: dict[str, float]) -> Case:
    """The case with numbers of some elements, by column and element."""
    elements = tuple(
        replace(e, **{c: of[e.element] for c, of in columns.items() if e.element in of})
        for e in case.elements
    )
    return Case(**(vars(case) | {"elements": elements}))


def test_the_peak_nearest_to_its_limit_is_judged(results: Results) -> None:
    """900 of 1000 N m and −80 of 50 N m."""
    assert results.start is not None
    case = changed(results.case, peak_torque_limit={FIRST: 1000.0, SECOND: 50.0})
    size = {FIRST: (900.0, -100.0), SECOND: (70.0, -80.0)}
    peaks = tuple(
        replace(p, maximum=size[p.element][0], minimum=size[p.element][1])
        for p in results.start.peaks
        if p.element in size
    )
    found = check(
        replace(results, case=case, start=replace(results.start, peaks=peaks)), "Peak torque"
    )
    assert (found.result, found.limit, found.where) == (80.0, 50.0, SECOND)
    assert found.verdict == Judgement.FAIL


@pytest.mark.parametrize(("second", "verdict"), [(99.0, Judgement.PASS), (101.0, Judgement.FAIL)])
def test_shear_yields_at_half_the_tensile_yield(
    results: Results, second: float, verdict: Judgement
) -> None:
    """Maximum shear theory: 150 of 400/2 MPa, and a smaller stress of 200/2 MPa."""
    assert results.starts is not None
    (shaft,) = results.starts.shafts
    case = results.case
    soft = replace(case.materials[0], material="soft steel", yield_=200.0 * MPA)
    elements = tuple(
        replace(e, material="soft steel", stress_diameter=0.1) if e.element == SECOND else e
        for e in case.elements
    )
    strong = replace(case.materials[0], yield_=400.0 * MPA)
    both = replace(case, elements=elements, materials=(strong, soft))
    shafts = (
        replace(shaft, peak_nominal_stress=150.0 * MPA),
        replace(shaft, element=SECOND, peak_nominal_stress=second * MPA),
    )
    found = check(
        replace(results, case=both, starts=replace(results.starts, shafts=shafts)),
        "Shear yield in the start",
    )
    assert (found.result, found.limit) == (second * MPA, pytest.approx(100.0 * MPA))
    assert (found.where, found.verdict) == (SECOND, verdict)


def steady(results: Results, basis: str) -> Results:
    """Two rows: 40 of 100 MPa and 900 of 1000 N m, then 20 of 30 MPa and 8 of 5 N m; zero-to-peak."""
    numbers = ((FIRST, 40.0, 100.0, 900.0, 1000.0), (SECOND, 20.0, 30.0, 8.0, 5.0))
    rows = tuple(
        SteadyStateRow(
            element, "1x", None, 30.0, "Motor", 1.0, torque, stress * MPA, 2.0 * stress * MPA,
            allowable * MPA, limit, Judgement.FAIL,
        )
        for element, stress, allowable, torque, limit in numbers
    )  # fmt: skip
    return replace(results, steady=replace(results.steady, rows=rows, stress_basis=basis))


@pytest.mark.parametrize(("basis", "stress"), [("peak-to-peak", 40.0), ("zero-to-peak", 20.0)])
def test_the_vibratory_stress_nearest_to_its_limit_is_shown_on_its_basis(
    results: Results, basis: str, stress: float
) -> None:
    found = check(steady(results, basis), f"Steady-state stress ({basis})")
    assert (found.result, found.limit) == (stress * MPA, 30.0 * MPA)
    assert found.where.startswith(f"{SECOND}, 1x at 30 Hz")


def test_the_vibratory_torque_nearest_to_its_limit_is_judged(results: Results) -> None:
    found = check(steady(results, "peak-to-peak"), "Vibratory torque")
    assert (found.result, found.limit, found.verdict) == (8.0, 5.0, Judgement.FAIL)
    assert found.where.startswith(SECOND)


def test_the_limit_of_a_reversal_is_shown_below_zero(results: Results) -> None:
    reversal = replace(
        results.reversals[0], minimum_torque=-700.0, limit=500.0, verdict=Judgement.FAIL
    )
    found = check(replace(results, reversals=(reversal,)), "Torque reversal")
    assert (found.result, found.limit, found.verdict) == (-700.0, -500.0, Judgement.FAIL)


def test_the_error_of_the_starts_is_the_largest_of_the_shafts(results: Results) -> None:
    errors = ((FIRST, 0.01), (SECOND, 0.03), ("Gear shaft", None))
    rows = accuracy_of(replace(results, starts_error=errors))
    assert [r.error_starts for r in rows if r.method == "fatigue"] == [0.03]


def test_the_row_of_a_peak_by_hand(results: Results) -> None:
    """16 (maximum − minimum)/(π d³), and the speed as a share of 60π rad/s."""
    assert results.start is not None
    peaks = tuple(
        replace(p, maximum=3000.0, minimum=-1000.0, speed=45.0 * math.pi)
        for p in results.start.peaks
    )
    tables = result_tables(replace(results, start=replace(results.start, peaks=peaks)))
    row = next(r for r in tables["StartupPeaks"] if r["element"] == FIRST)
    assert row["peak_to_peak_torque"] == 4000.0
    assert row["peak_to_peak_stress"] == pytest.approx(
        16.0 * 4000.0 / (math.pi * 0.07**3), rel=1e-12
    )
    assert row["percent_speed"] == pytest.approx(0.75, rel=1e-12)
