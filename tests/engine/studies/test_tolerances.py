"""The tolerance study on the paper's sample, and on starts that stall, part or never damage."""

from __future__ import annotations

import json
import math
import pickle
from dataclasses import replace

import numpy as np
import pytest

from benchmarks.study_trains import study_train
from engine.case.case import Case
from engine.case.data import CaseData, ElementRow, MeshRow, StationRow, TorqueTimeRow
from engine.case.study_inputs import ScatterRow
from engine.errors import CaseError
from engine.numerics.sample_statistics import percentile_interval
from engine.results.results import Results
from engine.run import run
from engine.start.start_fatigue import COUNTED_STARTS
from engine.studies.nearby_start import LINEAR, PLANNED, near_start, near_train, recipe_of
from engine.studies.scatter import changes_of, factors_of, sampled
from engine.studies.tolerances.sample import (
    MASKS,
    NUMBERS,
    Evaluated,
    TolerancePlan,
    ToleranceSettings,
    evaluate,
    plan_tolerances,
    units_of,
)
from engine.studies.tolerances.tables import tolerance_details, tolerance_tables
from engine.studies.tolerances.tolerances import Tolerances, summarise_sample
from engine.studies.variation import varied_case
from tests.sample_case import sample_case
from tests.whole_studies import percentile, tolerances

ROWS = (
    ScatterRow(quantity="stiffness", spread=0.05),
    ScatterRow(quantity="damping ratio", distribution="uniform", spread=0.2),
    ScatterRow(quantity="S-N line", from_=0.9, to=1.1),
)


@pytest.fixture(scope="module")
def case() -> Case:
    return sample_case("proposed", starts_required=400.0)


@pytest.fixture(scope="module")
def nominal(case: Case) -> Results:
    """The plain run of the case."""
    return run(case)


@pytest.fixture(scope="module")
def found(case: Case) -> Tolerances:
    return tolerances(case, ROWS, ToleranceSettings(60, 5))


# --- nothing scatters -----------------------------------------------------------------------------


@pytest.mark.parametrize("design", ["proposed", "modified"])
def test_without_scatter_every_sample_is_the_plain_run(design: str) -> None:
    """Frequencies and margins bit for bit; torques and starts within the step error that is said."""
    case = sample_case(design)
    plain = run(case)
    plan = plan_tolerances(
        case,
        [ScatterRow(quantity=q, spread=0.0) for q in ("stiffness", "inertia", "S-N line")],
        ToleranceSettings(30),
        nominal=plain,
    )
    (unit, *_) = units_of(plan, 3)
    got = evaluate(unit)
    n = plan.recipe.n_modes
    assert np.array_equal(got.frequency, np.tile(plain.modes.elastic_frequency[:n], (3, 1)))
    kept = [r.margin for r in plain.margins.rows if r.mode <= n]
    assert np.array_equal(got.margin, np.tile(kept, (3, 1)))
    assert plain.start is not None
    assert plain.starts is not None
    assert plan.recipe.starts_error is not None
    peaks = [max(abs(p.maximum), abs(p.minimum)) for p in plain.start.peaks]
    assert got.torque[0] == pytest.approx(peaks, rel=2.0 * plan.recipe.step_error)
    assert got.starts[0, 0] == pytest.approx(
        plain.starts.starts, rel=1.01 * plan.recipe.starts_error
    )


def test_without_scatter_the_study_says_one_number_and_no_driver(case: Case) -> None:
    same = tolerances(case, [ScatterRow(quantity="stiffness", spread=0.0)], ToleranceSettings(36))
    row = percentile(same, "allowable starts", "HP compressor shaft")
    assert row is not None
    assert len({(p.value, p.low if p.low else p.value, p.high) for p in row.percentiles}) == 1
    assert same.converged
    assert same.explained is None
    assert all(d.share is None for d in same.drivers)


def test_peaks_are_those_of_the_plain_run_whatever_their_sign(case: Case, nominal: Results) -> None:
    """The larger of maximum and minimum by magnitude; exchanged, they make the same rows."""
    plain = nominal
    assert plain.start is not None
    rows = [ScatterRow(quantity="stiffness", spread=0.0)]
    plan = plan_tolerances(case, rows, ToleranceSettings(30), nominal=plain)
    parts = [evaluate(unit) for unit in units_of(plan)]
    mirrored = tuple(replace(p, maximum=-p.minimum, minimum=-p.maximum) for p in plain.start.peaks)
    other = replace(plan, nominal=replace(plain, start=replace(plain.start, peaks=mirrored)))
    for same in (summarise_sample(plan, parts), summarise_sample(other, parts)):
        for p in plain.start.peaks:
            assert p.maximum > -p.minimum > 0.0
            row = percentile(same, "peak torque", p.element)
            assert row is not None
            assert row.nominal == p.maximum
            assert [q.value for q in row.percentiles] == pytest.approx([p.maximum] * 3, rel=2e-3)
        peak = next(p for p in plain.start.peaks if p.element == "HP compressor shaft").maximum
        by_hand = 16.0 * peak / (math.pi * 0.07**3)
        stress = percentile(same, "peak stress", "HP compressor shaft")
        assert stress is not None
        assert stress.nominal == pytest.approx(by_hand, rel=1e-12)
        assert [q.value for q in stress.percentiles] == pytest.approx([by_hand] * 3, rel=2e-3)


def test_a_peak_below_zero_is_a_peak_in_every_sample() -> None:
    """A step of −T on the middle of three disks: both shafts swing to 2 T J/(2 J + J0), one below zero."""
    J, middle, T = 4.0, 2.0, 600.0
    diameter = (0.10, 0.08)
    names = ("left", "middle", "right")
    still = Case(
        stations=tuple(StationRow(n, None, middle if n == "middle" else J) for n in names),
        elements=tuple(
            ElementRow(f"{a} shaft", "shaft", a, b, 1e5, stress_diameter=d)
            for a, b, d in zip(names, names[1:], diameter, strict=False)
        ),
        torque_time=(TorqueTimeRow("middle", 0.0, -T), TorqueTimeRow("middle", 0.2, -T)),
    )
    got = tolerances(still, [ScatterRow(quantity="stiffness", spread=0.0)], ToleranceSettings(30))
    largest = 2.0 * T * J / (2.0 * J + middle)
    stress = [16.0 * largest / (math.pi * d**3) for d in diameter]
    for i, e in enumerate(still.elements):
        for quantity, by_hand in (("peak torque", largest), ("peak stress", stress[i])):
            row = percentile(got, quantity, str(e.element))
            assert row is not None
            numbers = [row.nominal, *(p.value for p in row.percentiles)]
            assert numbers == pytest.approx([by_hand] * 4, rel=2e-3)
    # the drivers are those of the thinner shaft
    assert got.driven == "peak stress"
    ends = [end for d in got.drivers for end in (d.at_low, d.at_high)]
    assert ends == pytest.approx([stress[1]] * 4, rel=2e-3)


# --- the sample -----------------------------------------------------------------------------------


@pytest.mark.slow
def test_the_division_of_the_work_changes_nothing(case: Case) -> None:
    plan = plan_tolerances(case, ROWS, ToleranceSettings(40, 2))
    whole = summarise_sample(plan, [evaluate(u) for u in units_of(plan, 1000)])
    parts = [evaluate(pickle.loads(pickle.dumps(u))) for u in units_of(plan, 7)]
    in_pieces = summarise_sample(plan, parts[::-1])
    assert whole.percentiles == in_pieces.percentiles
    assert whole.probabilities == in_pieces.probabilities
    assert whole.drivers == in_pieces.drivers
    assert np.array_equal(whole.starts, in_pieces.starts)


@pytest.mark.parametrize("number", [0, 6, 8, 10, 14, 22])
def test_samples_together_have_the_bits_that_each_has_alone(number: int) -> None:
    """Trains with gears, rigid meshes, dampers and without, and among the samples one that is no train."""
    stated = study_train(number).case
    rows = (
        ScatterRow(quantity="stiffness", spread=0.05),
        ScatterRow(quantity="inertia", spread=0.05),
        ScatterRow(quantity="average torque", spread=0.05),
    )
    plan = plan_tolerances(stated, rows, ToleranceSettings(30, 4))
    assert plan.recipe.start == LINEAR
    inertia = next(i for i, f in enumerate(plan.factors) if f.quantity == "inertia")
    values = plan.values[:9].copy()
    values[4, inertia] = -1.0  # no train
    plan = replace(plan, values=values)
    (unit,) = (replace(u, values=values) for u in units_of(plan, 30)[:1])
    together = evaluate(unit)
    alone = [
        evaluate(replace(unit, first=unit.first + i, values=values[i : i + 1])) for i in range(9)
    ]
    assert together.known.tolist() == [i != 4 for i in range(9)]
    assert together.troubles == alone[4].troubles
    for name in (*MASKS, *NUMBERS):
        rows_alone = np.concatenate([getattr(one, name) for one in alone])
        assert np.array_equal(getattr(together, name), rows_alone), name


def test_the_seed_and_the_scatter_are_in_the_digest(case: Case, nominal: Results) -> None:
    def digest(rows: tuple[ScatterRow, ...], seed: int) -> str:
        return plan_tolerances(case, rows, ToleranceSettings(40, seed), nominal=nominal).digest

    assert digest(ROWS, 1) == digest(ROWS, 1)
    assert len({digest(ROWS, 1), digest(ROWS, 2), digest(ROWS[:2], 1)}) == 3


def test_a_sample_is_the_run_of_the_changed_case(case: Case) -> None:
    """One sample against the conductor itself, which decides and refines everything anew."""
    from engine.studies.scatter import changes_of
    from engine.studies.variation import varied_case

    plan = plan_tolerances(case, ROWS, ToleranceSettings(40, 9))
    got = evaluate(units_of(plan, 1)[0])
    full = run(Case(**vars(varied_case(case, changes_of(plan.factors, plan.values[0])))))
    n = plan.recipe.n_modes
    assert np.array_equal(got.frequency[0], full.modes.elastic_frequency[:n])
    assert full.start is not None
    assert full.starts is not None
    peaks = [max(abs(p.maximum), abs(p.minimum)) for p in full.start.peaks]
    assert got.torque[0] == pytest.approx(peaks, rel=5e-4)
    assert got.starts[0, 0] == pytest.approx(full.starts.starts, rel=0.01)


def test_percentiles_rise_and_lie_in_their_intervals(found: Tolerances) -> None:
    for row in found.percentiles:
        values = [p.value for p in row.percentiles]
        assert values == sorted(values)
        for p in row.percentiles:
            assert p.low is None or p.low <= p.value
            assert p.high is None or p.high >= p.value


def test_stronger_material_and_damping_allow_more_starts(found: Tolerances) -> None:
    """The sign of physics: their runs at P90 allow more starts than at P10, and they drive most."""
    first_two = {d.factor for d in found.drivers[:2]}
    assert first_two == {"damping ratio", "S-N line of alloy steel"}
    for d in found.drivers[:2]:
        assert d.at_low is not None
        assert d.at_high is not None
        assert d.at_high > d.at_low
        assert d.rank_coefficient is not None
        assert d.rank_coefficient > 0.0
    assert found.explained is not None
    assert sum(d.share or 0.0 for d in found.drivers) == pytest.approx(found.explained, rel=1e-9)
    assert found.explained <= 1.0


def test_probabilities_are_shares_of_the_sample(found: Tolerances, case: Case) -> None:
    starts = next(p for p in found.probabilities if p.check == "starts")
    assert starts.probability == pytest.approx(float(np.mean(found.starts >= 400.0)))
    assert starts.low < starts.probability < starts.high
    every = next(p for p in found.probabilities if p.check == "all margins")
    each = [p.probability for p in found.probabilities if p.check == "margin"]
    assert every.probability <= min(each)


@pytest.fixture(scope="module")
def parts(case: Case, nominal: Results) -> tuple[TolerancePlan, list[Evaluated]]:
    """Thirty samples and the runs with one factor at a time, ten a unit."""
    plan = plan_tolerances(case, ROWS, ToleranceSettings(30, 5), nominal=nominal)
    return plan, [evaluate(unit) for unit in units_of(plan, 10)]


@pytest.mark.parametrize("factor", [1.0, 2.5])
def test_the_starts_factor_divides_what_probabilities_count(
    parts: tuple[TolerancePlan, list[Evaluated]], factor: float
) -> None:
    """Counted by hand: a start is enough where starts / factor ≥ required. Percentiles stay."""
    plan, units = parts
    starts = np.concatenate([u.starts[:, 0] for u in units])[:30]
    required = float(np.median(starts)) / factor * (1.0 + 1e-9)  # half of the samples keep it
    stated = Case(**(vars(plan.case) | {"starts_factor": factor, "starts_required": required}))
    got = summarise_sample(replace(plan, case=stated), units)
    row = next(p for p in got.probabilities if p.check == "starts")
    assert row.probability == sum(s / factor >= required for s in starts) / 30 == 0.5
    assert row.low < 0.5 < row.high
    plain = plan.nominal.starts
    assert plain is not None
    assert plain.starts is not None
    assert row.nominal == pytest.approx(plain.starts / factor, rel=1e-12)
    p50 = percentile(got, "allowable starts", "HP compressor shaft")
    assert p50 is not None
    assert min(starts) <= p50.percentiles[1].value <= max(starts)
    assert p50.nominal == pytest.approx(plain.starts, rel=1e-12)  # as calculated, not divided


def test_units_in_any_order_and_a_part_of_them(
    parts: tuple[TolerancePlan, list[Evaluated]],
) -> None:
    """The order of the work changes no number; what is missing is told and in no number."""
    plan, units = parts
    whole, other = (
        summarise_sample(plan, units),
        summarise_sample(plan, pickle.loads(pickle.dumps(units))[::-1]),
    )
    assert whole.percentiles == other.percentiles
    assert whole.probabilities == other.probabilities
    assert whole.drivers == other.drivers
    assert np.array_equal(whole.starts, other.starts)
    part = summarise_sample(plan, units[:2])
    assert part.samples == 20
    assert any("Stopped after 20 of 30 samples" in s for s in part.sentences)
    assert np.array_equal(part.starts, whole.starts[:20])
    assert all(d.at_low is None and d.at_high is None for d in part.drivers)


def test_samples_without_damage_are_told_as_unlimited(
    parts: tuple[TolerancePlan, list[Evaluated]],
) -> None:
    """Two thirds of the samples made unlimited: so is the median, and a tenth at least is not."""
    plan, units = parts

    def without_damage(unit: Evaluated) -> Evaluated:
        rows = np.arange(unit.first, unit.first + len(unit.starts))
        return replace(unit, starts=np.where(rows[:, None] % 3 == 0, unit.starts, np.inf))

    got = summarise_sample(plan, [without_damage(unit) for unit in units])
    row = percentile(got, "allowable starts", "HP compressor shaft")
    assert row is not None
    assert row.unlimited == pytest.approx(20 / 30)
    assert [math.isinf(p.value) for p in row.percentiles] == [False, True, True]
    (told,) = tolerance_tables(got)["StartsOfSample"]
    assert (told["p_50"], told["p_90"]) == ("unlimited", "unlimited")
    assert told["p_10"] == pytest.approx(row.percentiles[0].value)
    assert told["unlimited"] == pytest.approx(20 / 30)
    json.dumps(tolerance_details(got), allow_nan=False)
    assert got.driven == "peak stress"  # where most are unlimited, stress says more


@pytest.mark.slow
def test_the_starts_factor_divides_before_starts_are_judged(case: Case) -> None:
    halved = Case(**{**vars(case), "starts_factor": 2.0})
    wanted = Case(**{**vars(case), "starts_required": 800.0})
    settings = ToleranceSettings(30, 5)

    def probability(of: Case) -> float:
        rows = tolerances(of, ROWS, settings).probabilities
        return next(p.probability for p in rows if p.check == "starts")

    assert 0.0 < probability(halved) < 1.0
    assert probability(halved) == probability(wanted)


@pytest.mark.slow
def test_a_part_of_the_sample(case: Case) -> None:
    stopped = tolerances(case, ROWS, ToleranceSettings(200, 5), first=2)
    assert stopped.samples == 100
    assert any("Stopped after 100 of 200 samples" in s for s in stopped.sentences)
    assert all(d.at_low is None for d in stopped.drivers)  # those runs come last


# --- starts of other kinds ------------------------------------------------------------------------


@pytest.fixture(scope="module")
def stalling(case: Case, nominal: Results) -> tuple[TolerancePlan, list[Evaluated]]:
    """Forty samples of which some stall, and the runs with one factor at its ends."""
    rows = [ScatterRow(quantity="average torque", from_=0.1, to=1.2)]
    plan = plan_tolerances(case, rows, ToleranceSettings(40, 1), nominal=nominal)
    return plan, [evaluate(u) for u in units_of(plan, 20)]


def test_starts_that_stall_are_in_no_percentile_and_meet_no_demand(
    stalling: tuple[TolerancePlan, list[Evaluated]],
) -> None:
    got = summarise_sample(*stalling)
    completed = next(p for p in got.probabilities if p.check == "start completed")
    assert 0.0 < completed.probability < 1.0
    row = percentile(got, "allowable starts", "HP compressor shaft")
    assert row is not None
    assert row.samples == round(40 * completed.probability) == len(got.starts)
    assert got.unfinished == 40 - row.samples
    enough = next(p for p in got.probabilities if p.check == "starts")
    assert enough.samples == 40
    assert enough.probability == pytest.approx(float(np.sum(got.starts >= 400.0)) / 40)
    (words,) = (s for s in got.sentences if "were not completed" in s)
    assert words.startswith(f"{40 - row.samples} of 40 starts were not completed")
    assert "stalled" in words


def test_every_run_of_a_sample_is_in_the_counts_of_its_outcomes(
    stalling: tuple[TolerancePlan, list[Evaluated]],
) -> None:
    """Of the sample and of the runs with one factor at its ends: as many as were made."""
    plan, parts = stalling
    counts: dict[str, int] = {}
    for part in parts:
        assert sum(times for _, times in part.outcomes) == len(part.known)
        for word, times in part.outcomes:
            counts[word] = counts.get(word, 0) + times
    assert sum(counts.values()) == plan.n_runs == 40 + 2 * len(plan.factors)
    ended = sum(times for word, times in counts.items() if word in COUNTED_STARTS)
    assert ended == sum(int(np.sum(part.counted)) for part in parts)
    assert max(counts.values()) > 1
    told = ", ".join(f"{counts[word]} {word}" for word in sorted(counts))
    got = summarise_sample(plan, parts)
    assert any(f"(outcomes of all runs: {told})" in s for s in got.sentences)
    assert got.unfinished == 40 - round(40 * _completed(got))


def _completed(got: Tolerances) -> float:
    return next(p.probability for p in got.probabilities if p.check == "start completed")


def test_a_plain_run_that_stalls_has_no_number_beside_those_that_do_not(case: Case) -> None:
    weak = Case(**(vars(case) | {"voltage": 0.5}))
    plain = run(weak)
    assert plain.start is not None
    assert plain.start.outcome.outcome not in COUNTED_STARTS
    rows = [ScatterRow(quantity="average torque", from_=0.5, to=4.0, together="together")]
    got = tolerances(weak, rows, ToleranceSettings(30, 1))
    assert 0 < got.unfinished < 30
    for quantity in ("allowable starts", "peak torque", "peak stress"):
        found = [r for r in got.percentiles if r.quantity == quantity]
        assert found
        assert all(r.nominal is None for r in found)
    assert tolerance_tables(got)["StartsOfSample"][0]["nominal"] == "not judged"
    assert next(p for p in got.probabilities if p.check == "starts").nominal is None


@pytest.mark.slow
def test_the_sample_is_judged_by_its_starts_where_most_are_unlimited(case: Case) -> None:
    """The P10 of the starts is what is read: a settled stress says nothing of it."""
    strong = replace(
        CaseData(**vars(case)),
        sn_points=tuple(replace(p, stress=2.5 * (p.stress or 0.0)) for p in case.sn_points),
        materials=tuple(replace(m, endurance=2.5 * (m.endurance or 0.0)) for m in case.materials),
    )
    got = tolerances(Case(**vars(strong)), ROWS, ToleranceSettings(60, 1))
    row = percentile(got, "allowable starts", "HP compressor shaft")
    assert row is not None
    assert 0.5 <= row.unlimited < 0.9
    assert got.driven == "peak stress"
    assert "P10 of the allowable starts" in got.sentences[0]
    low = row.percentiles[0].low
    assert low is not None
    assert row.percentiles[0].value - low > 0.1 * row.percentiles[0].value
    assert not got.converged


@pytest.mark.slow
def test_unlimited_starts_are_told_as_unlimited(case: Case) -> None:
    """An S-N line four times as high: nothing damages; 2.3 times: some samples do."""

    def raised(by: float) -> Tolerances:
        strong = replace(
            CaseData(**vars(case)),
            sn_points=tuple(replace(p, stress=by * (p.stress or 0.0)) for p in case.sn_points),
            materials=tuple(
                replace(m, endurance=by * (m.endurance or 0.0)) for m in case.materials
            ),
        )
        return tolerances(Case(**vars(strong)), ROWS, ToleranceSettings(60, 1))

    never = raised(4.0)
    row = percentile(never, "allowable starts", "HP compressor shaft")
    assert row is not None
    assert row.unlimited == 1.0
    assert row.nominal == math.inf
    assert never.driven == "peak stress"
    (told,) = tolerance_tables(never)["StartsOfSample"]
    assert told["p_10"] == told["nominal"] == "unlimited"
    assert tolerance_tables(never)["ToleranceHistogram"] == [{"starts": "unlimited", "share": 1.0}]
    some = percentile(raised(2.3), "allowable starts", "HP compressor shaft")
    assert some is not None
    assert 0.0 < some.unlimited < 1.0
    assert math.isfinite(some.percentiles[0].value)


def test_a_train_without_a_motor_has_frequencies_and_margins(case: Case) -> None:
    still = Case(**{**vars(case), "motor_torque": (), "load_torque": ()})
    got = tolerances(still, ROWS, ToleranceSettings(50, 1))
    assert {r.quantity for r in got.percentiles} == {"frequency", "margin"}
    assert got.driven == "least margin"
    assert any("no start was calculated" in s for s in got.sentences)


def _with_gap(case: Case, gap: float = 5e-4) -> Case:
    mesh = next(e for e in case.elements if e.kind == "gear mesh")
    ratio = {s.station: s.speed_ratio or 1.0 for s in case.stations}
    driven = 0.3 * ratio[mesh.from_] / ratio[mesh.to]
    row = MeshRow(mesh.element, None, 0.3, driven, backlash=gap)
    return Case(**{**vars(case), "meshes": (row,)})


@pytest.mark.slow
def test_a_plan_with_clearances_is_kept_for_every_sample(case: Case) -> None:
    gap = _with_gap(case)
    plain = run(gap)
    recipe = recipe_of(gap, plain)
    assert recipe.start == PLANNED
    got = near_start(gap, recipe, near_train(gap, recipe))
    assert plain.start is not None
    assert got.largest == pytest.approx(
        [max(abs(p.maximum), abs(p.minimum)) for p in plain.start.peaks], rel=1e-12
    )


def test_a_sample_that_reverses_where_the_plan_has_no_gap_is_told(case: Case) -> None:
    """The modified train hardly reverses; with more pulsation some samples do."""
    gap = _with_gap(sample_case("modified"))
    gap = Case(**{**vars(gap), "motor_torque": tuple(
        replace(p, pulsating=0.5 * (p.pulsating or 0.0)) for p in gap.motor_torque
    )})  # fmt: skip
    assert recipe_of(gap, run(gap)).start == LINEAR
    rows = [ScatterRow(quantity="pulsating torque", from_=1.0, to=1.8)]
    settings = ToleranceSettings(30, 1)
    plan = plan_tolerances(gap, rows, settings)
    got = evaluate(units_of(plan, 30)[0])
    assert 0 < np.sum(got.reversed) < 30
    told = summarise_sample(plan, [got])
    assert any(
        "reverses where the plan of the nominal run models no clearance" in s
        for s in told.sentences
    )
    again = plan_tolerances(gap, rows, replace(settings, replan=True))
    first = int(np.flatnonzero(got.reversed)[0])
    (redone,) = [evaluate(u) for u in units_of(again, 1)[first : first + 1]]
    assert not redone.reversed[0] or redone.torque[0] != pytest.approx(got.torque[first], rel=1e-6)


# --- rows and refusals ----------------------------------------------------------------------------


def test_the_rows_are_plain_json(found: Tolerances) -> None:
    tables = tolerance_tables(found)
    for told in (dict(tables), dict(tolerance_details(found))):
        assert json.loads(json.dumps(told, allow_nan=False)) == told
    assert all(tables.values())
    assert sum(r["share"] for r in tables["ToleranceHistogram"]) == pytest.approx(1.0)
    middle = tables["ToleranceDistribution"][49]
    row = percentile(found, "allowable starts", "HP compressor shaft")
    assert row is not None
    assert (middle["probability"], middle["starts"]) == (0.5, row.percentiles[1].value)


def test_every_problem_at_once(case: Case) -> None:
    rows = [ScatterRow(quantity="stiffness", spread=0.5), ScatterRow(quantity="colour")]
    with pytest.raises(CaseError) as refused:
        plan_tolerances(case, rows, ToleranceSettings(5, -1, "dice"))
    columns = [p.column for p in refused.value.problems]
    assert columns == ["Spread", "Quantity", "Spread", "Samples", "Method", "Seed"]


# --- a part of a sample ---------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("method", ["lhs", "sobol"])
def test_intervals_of_a_part_of_a_sample_hold_as_often_as_they_say(method: str) -> None:
    """The first rows of many samples; the percentile itself from the distribution of the product."""
    rows = [ScatterRow(name, "stiffness", spread=0.1) for name in ("HS coupling", "LS coupling")]
    factors = factors_of(sample_case("proposed"), rows)
    assert len(factors) == 2
    true = float(np.quantile(
        np.prod(1.0 + 0.1 * np.clip(np.random.default_rng(7).normal(size=(2_000_000, 2)), -4, 4), axis=1),
        0.1,
    ))  # fmt: skip
    held = 0
    for seed in range(400):
        part = sampled(factors, 512, seed, method)[:120]
        p10 = percentile_interval(np.sort(np.prod(part, axis=1)), 0.1)
        assert p10.low is not None
        assert p10.high is not None
        held += p10.low <= true <= p10.high
    assert held >= 0.93 * 400  # 95 % of 400, less two standard deviations


# --- the step of trains far from the plain one ----------------------------------------------------


def test_what_half_the_step_changes_covers_the_error_of_wide_scatter(case: Case) -> None:
    """Stiffness from a twentieth to twenty times as stated: the nominal run's error says nothing of that."""
    rows = [ScatterRow(quantity="stiffness", from_=0.05, to=20.0)]
    plan = plan_tolerances(case, rows, ToleranceSettings(30, 3))
    unit = units_of(plan, 1)[0]
    got = evaluate(unit)
    assert got.checked[0]
    true = run(
        replace(varied_case(case, changes_of(plan.factors, unit.values[0])), tolerance_peak=1e-6)
    )
    assert true.start is not None
    peaks = {p.element: max(abs(p.maximum), abs(p.minimum)) for p in true.start.peaks}
    largest = max(peaks.values())
    off = max(
        abs(got.torque[0, i] - peaks[e.element]) / peaks[e.element]
        for i, e in enumerate(case.elements)
        if peaks.get(e.element, 0.0) > 1e-3 * largest
    )
    assert off <= 4.0 / 3.0 * got.by_step[0, 0] + 1e-6  # as of second order, the least there is
    assert got.by_step[0, 0] > 0.0


def test_one_in_fifty_starts_is_calculated_at_half_the_step_however_the_work_is_divided(
    case: Case, nominal: Results
) -> None:
    plan = plan_tolerances(case, ROWS, ToleranceSettings(52, 5), nominal=nominal)
    whole = evaluate(units_of(plan, 52)[0])
    assert np.flatnonzero(whole.checked).tolist() == [0, 50]
    parts = [evaluate(unit) for unit in units_of(plan, 7)]
    rows = [p.first + i for p in parts for i in np.flatnonzero(p.checked) if p.first < 52]
    assert rows == [0, 50]
    (said,) = (s for s in summarise_sample(plan, parts).sentences if "half that step" in s)
    worst = float(np.max(whole.by_step[:, 0]))
    assert "checked in 2 samples" in said
    assert 0.0 < worst < 0.01
