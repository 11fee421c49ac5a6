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
from engine.results.verdicts import overall_verdict, verdicts_of
from engine.run import run
from tests.sample_case import sample_case, with_limits

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


@pytest.mark.parametrize(
    ("second", "verdict"), [(99.0, Judgement.INCOMPLETE), (101.0, Judgement.FAIL)]
)
def test_shear_yields_at_half_the_tensile_yield(
    results: Results, second: float, verdict: Judgement
) -> None:
    """Maximum shear theory: 150 of 400/2 MPa, and a smaller stress of 200/2 MPa; 2 of 6 shafts."""
    assert results.start is not None
    case = results.case
    soft = replace(case.materials[0], material="soft steel", yield_=200.0 * MPA)
    elements = tuple(
        replace(e, material="soft steel", stress_diameter=0.07) if e.element == SECOND else e
        for e in case.elements
    )
    strong = replace(case.materials[0], yield_=400.0 * MPA)
    both = replace(case, elements=elements, materials=(strong, soft))
    torque_of_stress = math.pi * 0.07**3 / 16.0
    stress = {FIRST: 150.0 * MPA, SECOND: second * MPA}
    peaks = tuple(
        replace(p, maximum=stress[p.element] * torque_of_stress, minimum=0.0, error=0.0)
        for p in results.start.peaks
        if p.element in stress
    )
    found = check(
        replace(results, case=both, start=replace(results.start, peaks=peaks)),
        "Shear yield in the start",
    )
    assert found.result == pytest.approx(second * MPA)
    assert found.limit == pytest.approx(100.0 * MPA)
    assert (found.where, found.verdict, found.coverage) == (SECOND, verdict, "2 of 6 shafts")


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
        replace(p, maximum=3000.0, minimum=-1000.0, peak_to_peak=4000.0, speed=45.0 * math.pi)
        for p in results.start.peaks
    )
    tables = result_tables(replace(results, start=replace(results.start, peaks=peaks)))
    row = next(r for r in tables["StartupPeaks"] if r["element"] == FIRST)
    assert row["peak_to_peak_torque"] == 4000.0
    assert row["peak_to_peak_stress"] == pytest.approx(
        16.0 * 4000.0 / (math.pi * 0.07**3), rel=1e-12
    )
    assert row["percent_speed"] == pytest.approx(0.75, rel=1e-12)


# --- what a verdict covers ------------------------------------------------------------------------


@pytest.fixture(scope="module")
def complete() -> Results:
    """The modified design, which every check judges."""
    return run(with_limits(sample_case("modified")))


def test_every_kind_of_check_has_one_row_also_without_any_limit(
    results: Results, complete: Results
) -> None:
    bare = sample_case("proposed")
    shaft = {"stress_diameter": None, "scf": None, "material": None}
    bare = replace(bare, elements=tuple(replace(e, **shaft) for e in bare.elements))
    names = [v.check for v in complete.verdicts]
    assert names == [v.check for v in run(bare).verdicts] == [v.check for v in results.verdicts]
    assert names == [
        "Overall", "Separation margin", "Steady-state stress (peak-to-peak)", "Vibratory torque",
        "Start", "Peak torque", "Shear yield in the start", "Torque reversal", "Allowable starts",
    ]  # fmt: skip
    assert run(bare).verdicts[0].verdict == Judgement.FAIL  # its margin
    assert all((v.coverage or "").startswith("0 of ") for v in run(bare).verdicts[5:])


def test_a_train_that_is_wholly_judged_covers_all_of_it(complete: Results) -> None:
    coverage = [v.coverage for v in complete.verdicts]
    assert coverage == [
        None, "10 modes, 6 excitations", "6 of 6 shafts", "4 of 4 couplings and meshes",
        "3 of 3 crossings", "4 of 4 couplings and meshes", "6 of 6 shafts",
        "1 of 1 meshes and geared couplings", "6 of 6 shafts",
    ]  # fmt: skip
    assert complete.verdicts[0].verdict == Judgement.ACCEPTED


def test_couplings_without_limits_are_named_with_their_peaks(results: Results) -> None:
    """V2: the peak over the rated torque at motor speed, the largest first."""
    assert results.start is not None
    found = check(results, "Peak torque")
    assert found.verdict == Judgement.NOT_JUDGED
    peak = next(p for p in results.start.peaks if p.element == "HS coupling")
    over = 5.6 * peak.size / 58400.0
    assert (found.not_judged or "").startswith(f"HS coupling, peak {over:.2f} × rated; Mesh, peak ")


def test_unlimited_starts_of_one_shaft_are_not_those_of_the_train(complete: Results) -> None:
    """V2: five of six shafts have no diameter."""
    case = complete.case
    alone = {"stress_diameter": None, "scf": None, "material": None}
    elements = tuple(
        e if e.element in ("Gear shaft", "Mesh") or e.kind == "coupling" else replace(e, **alone)
        for e in case.elements
    )
    results = run(Case(**(vars(case) | {"elements": elements})))
    found = check(results, "Allowable starts")
    assert (found.result, found.verdict) == ("unlimited", Judgement.INCOMPLETE)
    assert found.coverage == "1 of 6 shafts"
    assert found.where.startswith("no damage: Gear shaft (amplitude at most ")
    assert "LP shaft, drive end, peak 1." in (found.not_judged or "")
    assert results.verdicts[0].verdict == Judgement.INCOMPLETE


def test_a_start_that_ends_below_a_crossing_does_not_pass(complete: Results) -> None:
    """V3: EndSpeed 40 %: the crossings at 42.5, 67.5 and 82.5 % speed are not reached."""
    slow = Case(**(vars(complete.case) | {"end_speed": 0.4 * 60.0 * math.pi}))
    results = run(slow)
    starts = check(results, "Allowable starts")
    assert starts.verdict == Judgement.INCOMPLETE
    assert starts.not_judged == "modes that the start did not cross"
    found = check(results, "Start")
    assert (found.result, found.verdict) == ("reached", Judgement.INCOMPLETE)
    assert found.coverage == "0 of 3 crossings"
    for words in ("mode 1 (21 Hz) at 82.5 % speed", "mode 2 (39 Hz) at 67.5 %", "mode 3 (69 Hz)"):
        assert words in (found.not_judged or "")


@pytest.mark.parametrize(
    ("error", "verdict"), [(9.0, Judgement.PASS), (11.0, Judgement.WITHIN_ERROR)]
)
def test_a_peak_nearer_to_its_limit_than_its_error_says_so(
    complete: Results, error: float, verdict: Judgement
) -> None:
    assert complete.start is not None
    mesh = next(e.peak_torque_limit for e in complete.case.elements if e.element == "Mesh")
    assert mesh is not None
    peaks = tuple(
        replace(p, maximum=mesh - 10.0, minimum=0.0, error=error, left_out=0.0)
        if p.element == "Mesh"
        else p
        for p in complete.start.peaks
    )
    changed_results = replace(complete, start=replace(complete.start, peaks=peaks))
    assert check(changed_results, "Peak torque").verdict == verdict
    overall = Judgement.ACCEPTED if verdict == Judgement.PASS else Judgement.WITHIN_ERROR
    assert verdicts_of(changed_results)[0].verdict == overall


def test_a_peak_that_fails_is_not_hidden_by_a_wider_range_that_does_not(complete: Results) -> None:
    """90 of 100 N m with a range up to 300 is within its error; 105 of 100 fails."""
    assert complete.start is not None
    case = changed(complete.case, peak_torque_limit={FIRST: 100.0, SECOND: 100.0})
    size = {FIRST: (90.0, (80.0, 300.0)), SECOND: (105.0, (105.0, 105.0))}
    peaks = tuple(
        replace(p, maximum=size[p.element][0], minimum=0.0, error=0.0).repeated_in(
            size[p.element][1], (0.0, 0.0)
        )
        if p.element in size
        else p
        for p in complete.start.peaks
    )
    start = replace(complete.start, peaks=peaks)
    found = check(replace(complete, case=case, start=start), "Peak torque")
    assert (found.result, found.where, found.verdict) == (105.0, SECOND, Judgement.FAIL)


@pytest.mark.parametrize(
    ("error", "verdict"), [(0.049, Judgement.PASS), (0.051, Judgement.WITHIN_ERROR)]
)
def test_starts_nearer_to_those_required_than_their_error_say_so(
    complete: Results, error: float, verdict: Judgement
) -> None:
    """Required 95.2 % of the allowable ones: 5 % less are still enough."""
    assert complete.starts is not None
    assert complete.starts.judged_starts is not None
    required = complete.starts.judged_starts / 1.05
    near = replace(complete.case, starts_required=required)
    low = replace(complete.starts, starts_low=(complete.starts.starts or 0.0) / (1.0 + error))
    found = check(replace(complete, case=near, starts=low), "Allowable starts")
    assert found.verdict == verdict


@pytest.mark.parametrize(
    ("error", "left_out", "verdict"),
    [
        (5.0, 4.0, Judgement.PASS),
        (5.0, 6.0, Judgement.WITHIN_ERROR),
        (5.0, None, Judgement.INCOMPLETE),
    ],
)
def test_a_reversal_nearer_to_its_limit_than_error_and_what_is_left_out_says_so(
    complete: Results, error: float, left_out: float | None, verdict: Judgement
) -> None:
    assert complete.start is not None
    (mesh,) = complete.reversals
    limit = 10.0 - mesh.minimum_torque  # 10 N m beyond the minimum
    peaks = tuple(
        replace(p, minimum=mesh.minimum_torque, error=error, left_out=left_out)
        if p.element == mesh.element
        else p
        for p in complete.start.peaks
    )
    share = None if left_out is None else complete.start.left_out
    near = replace(
        complete,
        start=replace(complete.start, peaks=peaks, left_out=share),
        reversals=(replace(mesh, limit=limit, verdict=Judgement.PASS),),
    )
    found = check(near, "Torque reversal")
    assert found.verdict == verdict
    assert ("no bound on what is left out" in (found.not_judged or "")) == (left_out is None)


@pytest.mark.parametrize(
    ("lower", "verdict"), [(9.0, Judgement.PASS), (11.0, Judgement.WITHIN_ERROR)]
)
def test_a_reversal_is_judged_by_the_range_of_the_minimum_not_by_that_of_the_peak(
    complete: Results, lower: float, verdict: Judgement
) -> None:
    """Runs part: the peak is known to 50 N m, the minimum to `lower`; the limit is 10 N m beyond it."""
    assert complete.start is not None
    (mesh,) = complete.reversals
    lowest = mesh.minimum_torque
    peaks = tuple(
        replace(p, minimum=lowest, error=1.0, left_out=0.0).repeated_in(
            (p.maximum - 50.0, p.maximum + 50.0), (lowest - lower, lowest)
        )
        if p.element == mesh.element
        else p
        for p in complete.start.peaks
    )
    near = replace(
        complete,
        start=replace(complete.start, peaks=peaks),
        reversals=(replace(mesh, limit=10.0 - lowest, verdict=Judgement.PASS),),
    )
    assert check(near, "Torque reversal").verdict == verdict


def test_without_a_start_its_checks_are_there_and_not_judged() -> None:
    found = run(replace(with_limits(sample_case("modified")), motor_torque=())).verdicts
    open_ = {v.check: v.not_judged for v in found if v.verdict == Judgement.NOT_JUDGED}
    assert set(open_) == {
        "Start", "Peak torque", "Shear yield in the start", "Torque reversal", "Allowable starts",
    }  # fmt: skip
    assert "type MotorTorque" in (open_["Start"] or "")
    assert found[0].verdict == Judgement.INCOMPLETE


@pytest.mark.parametrize(
    ("words", "overall"),
    [
        (["pass", "fail", "not judged"], Judgement.FAIL),
        (["pass", "unbounded"], Judgement.FAIL),
        (["pass", "not judged", "accepted by forced response"], Judgement.INCOMPLETE),
        (["pass", "incomplete", "pass within its error"], Judgement.INCOMPLETE),
        (["pass", "accepted by forced response", "pass within its error"], Judgement.WITHIN_ERROR),
        (["pass", "accepted by forced response"], Judgement.ACCEPTED),
        (["pass"], Judgement.PASS),
        ([], Judgement.INCOMPLETE),
    ],
)
def test_the_overall_verdict_is_the_worst(words: list[str], overall: Judgement) -> None:
    assert overall_verdict(Judgement(word) for word in words) == overall
