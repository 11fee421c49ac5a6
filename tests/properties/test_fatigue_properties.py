"""What must hold of every history, S-N line and start."""

from collections import Counter

import numpy as np
import pytest
import rainflow
from hypothesis import assume, given
from hypothesis import strategies as st

from engine.case.choices import BelowEndurance, RainflowResidue
from engine.case.data import ElementRow, MaterialRow, SNPointRow
from engine.fatigue.allowable_starts import allowable_starts, shaft_fatigue
from engine.fatigue.cycle_counting import (
    count_cycles,
    counted_history,
    paper_count,
    turning_points,
)
from engine.fatigue.damage import damage_interval, miner_damage, starts_from_damage
from engine.fatigue.mean_stress import reversed_amplitude
from engine.fatigue.sn_curve import SNCurve, sn_curve_for
from engine.fatigue.strength_factors import lowered_line

# Whole numbers make ties and repeated extremes frequent, and sums exact.
WHOLE = st.lists(st.integers(-9, 9).map(float), max_size=40)
REAL = st.lists(
    st.floats(-500.0, 500.0, allow_subnormal=False).map(lambda x: round(x, 6)), max_size=40
)
HISTORIES = WHOLE | REAL
ANY_RESIDUE = st.sampled_from(tuple(RainflowResidue))
ANY_RULE = st.sampled_from(tuple(BelowEndurance))


@st.composite
def curves(draw, rule=ANY_RULE):
    """S-N lines of two to five points around the amplitudes above, k from 1 to 20."""
    slopes = draw(st.lists(st.floats(1.0, 20.0), min_size=1, max_size=4))
    steps = draw(st.lists(st.floats(1.05, 2.0), min_size=len(slopes), max_size=len(slopes)))
    stress = [draw(st.floats(10.0, 600.0))]
    cycles = [draw(st.floats(1.0, 1e5))]
    for k, step in zip(slopes, steps, strict=True):
        stress.append(stress[-1] / step)
        cycles.append(cycles[-1] * step**k)
    endurance = stress[-1] * draw(st.just(1.0) | st.floats(0.3, 1.0))
    return SNCurve(np.array(cycles), np.array(stress), endurance, draw(rule))


def totals(cycles):
    found = Counter()
    for size, count in zip(cycles.range.tolist(), cycles.count.tolist(), strict=True):
        found[size] += count
    return found


def damage(history, curve, residue):
    cycles = count_cycles(history, residue)
    return miner_damage(cycles.amplitude, cycles.count, curve)


# --- counting against other algorithms ------------------------------------------------------------


def three_points(history):
    """ASTM E1049-85, 5.4.4, steps (1) to (6), on the list of points not yet discarded."""
    points, start, i, found = list(turning_points(history)), 0, 0, []
    left = []
    while i < len(points):
        left.append(points[i])
        i += 1
        while len(left) >= 3:
            X, Y = abs(left[-1] - left[-2]), abs(left[-2] - left[-3])
            if X < Y:
                break
            if len(left) - 3 == start:
                found.append((Y, 0.5 * (left[-2] + left[-3]), 0.5))
                del left[-3]
            else:
                found.append((Y, 0.5 * (left[-2] + left[-3]), 1.0))
                del left[-3:-1]
    return found + [
        (abs(b - a), 0.5 * (a + b), 0.5) for a, b in zip(left[:-1], left[1:], strict=True)
    ]


def four_points(points):
    """Closed cycles and residue of the four-point rule."""
    left, found = [], []
    for point in points:
        left.append(point)
        while len(left) >= 4:
            before, inner, after = np.abs(np.diff(left[-4:]))
            if inner > before or inner > after:
                break
            found.append(float(inner))
            del left[-3:-1]
    return found, left


@given(HISTORIES)
def test_the_count_is_that_of_the_published_library(history):
    points = turning_points(history)
    assume(points.size > 1)
    # its `reversals` would lose the second of two points
    theirs = list(rainflow.extract_cycles([points[0], *points.tolist()]))
    cycles = count_cycles(history)
    found = zip(cycles.range.tolist(), cycles.mean.tolist(), cycles.count.tolist(), strict=True)
    assert list(found) == [cycle[:3] for cycle in theirs]


@given(HISTORIES)
def test_the_count_follows_the_three_point_rule(history):
    cycles = count_cycles(history)
    ours = [
        tuple(row) for row in np.column_stack([cycles.range, cycles.mean, cycles.count]).tolist()
    ]
    assert ours == three_points(history)


@given(WHOLE)
def test_repeating_equals_the_doubled_residue_of_afnor(history):
    closed, residue = four_points(turning_points(history).tolist())
    if len(residue) > 1:
        again, _ = four_points(turning_points(residue + residue).tolist())
        closed += again
    assert totals(count_cycles(history, "repeated")) == Counter(closed)


@given(WHOLE)
def test_half_cycles_are_half_of_the_history_and_its_mirror_image_repeated(history):
    """What makes the error bound of the damage hold for the ASTM residue too."""
    mirrored = totals(count_cycles(history + history[::-1], "repeated"))
    assert totals(count_cycles(history)) == {size: 0.5 * n for size, n in mirrored.items()}


@given(HISTORIES)
def test_repeated_counts_whole_cycles_only(history):
    assert np.all(count_cycles(history, "repeated").count % 1.0 == 0.0)


@given(HISTORIES)
def test_residue_rules_agree_on_a_history_that_begins_and_ends_at_its_extreme(history):
    assume(history)
    extreme = max(history, key=abs)
    closed = [extreme, *history, extreme]
    assert totals(count_cycles(closed)) == totals(count_cycles(closed, "repeated"))


# --- what must not change a count -----------------------------------------------------------------


@given(HISTORIES, ANY_RESIDUE, st.data())
def test_points_on_the_way_change_nothing(history, residue, data):
    finer = history[:1]
    for a, b in zip(history[:-1], history[1:], strict=True):
        between = data.draw(st.lists(st.floats(min(a, b), max(a, b)), max_size=3))
        finer += [*sorted(between, reverse=b < a), b]
    coarse, fine = count_cycles(history, residue), count_cycles(finer, residue)
    for name in ("range", "mean", "count"):
        assert getattr(coarse, name).tolist() == getattr(fine, name).tolist()
    assert paper_count(history).range.tolist() == paper_count(finer).range.tolist()


@given(WHOLE, ANY_RESIDUE)
def test_mirroring_in_time_or_sign_changes_no_range(history, residue):
    count = totals(count_cycles(history, residue))
    assert totals(count_cycles(history[::-1], residue)) == count
    assert totals(count_cycles([-x for x in history], residue)) == count


@given(HISTORIES, ANY_RESIDUE)
def test_no_range_exceeds_maximum_minus_minimum_and_one_reaches_it(history, residue):
    ranges = count_cycles(history, residue).range
    if turning_points(history).size < 2:
        assert ranges.size == 0
    else:
        assert max(ranges) == max(history) - min(history)


@given(HISTORIES)
def test_both_counts_spend_the_whole_path(history):
    """Every stretch of the history is in one cycle: Σ 2 · count · range is the path walked."""
    path = np.sum(np.abs(np.diff(turning_points(history))))
    for cycles in (count_cycles(history), paper_count(history)):
        assert 2.0 * np.sum(cycles.count * cycles.range) == pytest.approx(path, rel=1e-12)


# --- S-N line -------------------------------------------------------------------------------------


AMPLITUDES = st.floats(0.0, 2000.0).map(lambda x: round(x, 3))


@given(curves(), AMPLITUDES, AMPLITUDES)
def test_more_stress_never_lives_longer(curve, a, b):
    low, high = sorted((a, b))
    short, long = curve.cycles_to_failure([high, low])
    assert short <= long * (1 + 1e-12)


@given(curves())
def test_the_line_is_continuous_at_its_points(curve):
    either_side = np.outer([1 - 1e-12, 1 + 1e-12], curve.stress[:-1])
    above, below = curve.cycles_to_failure(either_side)
    np.testing.assert_allclose(above, below, rtol=1e-9)


@given(curves(st.sampled_from(["same slope", "2k-1"])))
def test_the_line_is_continuous_at_the_knee(curve):
    S = curve.endurance * np.array([1 - 1e-12, 1.0, 1 + 1e-12])
    np.testing.assert_allclose(curve.cycles_to_failure(S), curve.knee_cycles, rtol=1e-9)


@given(curves(), AMPLITUDES)
def test_the_rules_are_ordered(curve, amplitude):
    none, haibach, same = (
        float(
            SNCurve(curve.cycles, curve.stress, curve.endurance, rule).cycles_to_failure(amplitude)
        )
        for rule in ("none", "2k-1", "same slope")
    )
    assert same <= haibach * (1 + 1e-12)
    assert haibach <= none * (1 + 1e-12)


@given(st.floats(1.0, 20.0), st.floats(0.05, 20.0), st.lists(st.floats(1.0, 500.0), min_size=1))
def test_on_one_slope_scaling_stress_scales_life_by_its_power(k, factor, amplitudes):
    S = np.array([300.0, 100.0])
    curve = SNCurve(1e6 * (S / 100.0) ** -k, S, 100.0, "same slope")
    a = np.array(amplitudes)
    expected = curve.cycles_to_failure(a) * factor**-k
    np.testing.assert_allclose(curve.cycles_to_failure(factor * a), expected, rtol=1e-11)


@given(curves(), st.lists(AMPLITUDES))
def test_bending_data_serve_half_the_stress(curve, amplitudes):
    rows = [
        SNPointRow(material="m", cycles=N, stress=S)
        for N, S in zip(curve.cycles.tolist(), curve.stress.tolist(), strict=True)
    ]
    torsion, bending = (
        sn_curve_for(MaterialRow(material="m", endurance=curve.endurance, basis=basis), rows)
        for basis in ("torsion", "bending")
    )
    a = np.array(amplitudes)
    np.testing.assert_allclose(
        bending.cycles_to_failure(a), torsion.cycles_to_failure(2.0 * a), rtol=1e-11
    )


# --- damage ---------------------------------------------------------------------------------------


CYCLES = st.lists(st.tuples(AMPLITUDES, st.sampled_from([0.5, 1.0, 17.0])), min_size=1, max_size=30)


@given(curves(), CYCLES, CYCLES)
def test_damage_grows_with_cycles(curve, some, more):
    q = miner_damage(*np.array(some).T, curve)
    assert miner_damage(*np.array(some + more).T, curve) >= q * (1 - 1e-12)


@given(curves(), CYCLES, st.randoms())
def test_the_order_of_cycles_is_irrelevant(curve, cycles, random):
    q = miner_damage(*np.array(cycles).T, curve)
    random.shuffle(cycles)
    assert miner_damage(*np.array(cycles).T, curve) == pytest.approx(q, rel=1e-12)


@given(curves(), HISTORIES, ANY_RESIDUE, st.floats(1.0, 3.0))
def test_a_larger_history_damages_more(curve, history, residue, factor):
    larger = damage(factor * np.array(history), curve, residue)
    assert larger >= damage(history, curve, residue) * (1 - 1e-9)


@given(curves(), HISTORIES, ANY_RESIDUE, st.floats(0.0, 50.0), st.floats(0.0, 0.2))
def test_the_interval_contains_the_damage(curve, history, residue, error, relative):
    cycles = count_cycles(history, residue)
    q = miner_damage(cycles.amplitude, cycles.count, curve)
    low, high = damage_interval(cycles, curve, error, relative)
    assert low <= q <= high
    assert damage_interval(cycles, curve, 0.0) == (q, q)


@given(curves(), REAL, ANY_RESIDUE, st.floats(0.0, 50.0), st.floats(0.0, 0.2), st.data())
def test_every_history_within_its_error_damages_within_the_interval(
    curve, history, residue, error, relative, data
):
    exact = turning_points(history)
    share = data.draw(st.lists(st.floats(-1.0, 1.0), min_size=exact.size, max_size=exact.size))
    off = exact + np.array(share) * (error + relative * np.abs(exact))
    low, high = damage_interval(count_cycles(exact, residue), curve, error, relative)
    # Steep lines make 1e-12 of the stress into 1e-10 of the damage.
    q = damage(off, curve, residue)
    assert low * (1 - 1e-6) <= q + 1e-300
    assert q <= high * (1 + 1e-6) or at_the_limit(curve, off, residue)


def at_the_limit(curve, history, residue):
    """A cycle that rounding alone puts on the other side of the endurance limit."""
    a = count_cycles(history, residue).amplitude
    return bool(np.any(np.abs(a / curve.endurance - 1.0) < 1e-9))


# --- one shaft and the train ----------------------------------------------------------------------


ELEMENTS = st.builds(
    ElementRow,
    element=st.sampled_from("abc"),
    stress_diameter=st.floats(0.5, 3.0),
    stress_bore=st.none() | st.floats(0.0, 0.4),
    scf=st.none() | st.floats(1.0, 3.0),
)
MATERIAL = MaterialRow(material="m", yield_=400.0)


@given(curves(), ELEMENTS, HISTORIES, ANY_RESIDUE, st.floats(0.0, 5.0), st.floats(0.0, 0.01))
def test_not_counting_changes_no_number(curve, element, torque, residue, error, relative):
    cheap, counted = (
        shaft_fatigue(
            element,
            torque,
            curve,
            MATERIAL,
            residue,
            error,
            relative_torque_error=relative,
            always_count=always,
        )
        for always in (False, True)
    )
    for name in (
        "damage",
        "damage_low",
        "damage_high",
        "allowable_starts",
        "unlimited",
        "starts_low",
        "starts_high",
        "paper_damage",
        "paper_starts",
        "largest_amplitude",
        "peak_nominal_stress",
        "above_shear_yield",
        "above_first_point",
    ):
        assert getattr(cheap, name) == getattr(counted, name), name


@given(curves(), ELEMENTS, HISTORIES, ANY_RESIDUE)
def test_a_shaft_is_the_count_of_its_stress_from_rest_to_rest(curve, element, torque, residue):
    shaft = shaft_fatigue(element, torque, curve, MATERIAL, residue)
    D, d = element.stress_diameter, element.stress_bore or 0.0
    factor = (element.scf or 1.0) * 16 * D / (np.pi * (D**4 - d**4))
    cycles = count_cycles(counted_history(torque), residue)
    expected = miner_damage(0.5 * cycles.range * factor, cycles.count, curve)
    near = np.abs(0.5 * cycles.range * factor / curve.endurance - 1.0) < 1e-9
    assume(not np.any(near))
    assert shaft.damage == pytest.approx(expected, rel=1e-9, abs=1e-300)
    assert shaft.unlimited == (starts_from_damage(shaft.damage) is None)


@given(curves(), st.lists(REAL, min_size=1, max_size=4), st.floats(0.0, 20.0), st.randoms())
def test_the_worst_shaft_governs_in_any_order(curve, torques, error, random):
    shafts = [
        shaft_fatigue(
            ElementRow(element=str(i), stress_diameter=1.7),
            torque,
            curve,
            MATERIAL,
            torque_error=error,
        )
        for i, torque in enumerate(torques)
    ]
    starts = allowable_starts(shafts)
    finite = [s.allowable_starts for s in shafts if s.allowable_starts is not None]
    assert starts.starts == min(finite, default=None)
    if starts.starts is not None:
        by_name = {s.element: s for s in shafts}
        assert by_name[starts.governing].allowable_starts == starts.starts
    random.shuffle(shafts)
    again = allowable_starts(shafts)
    assert (again.starts, again.starts_low, again.starts_high) == (
        starts.starts,
        starts.starts_low,
        starts.starts_high,
    )


# --- strength factors and mean stress -------------------------------------------------------------

FACTORS = st.floats(0.2, 1.0)


@given(curves(), HISTORIES, ANY_RESIDUE)
def test_factors_of_one_change_no_bit(curve, torque, residue):
    cycles = count_cycles(counted_history(torque), residue)
    assert lowered_line(curve, 1.0) is curve
    same = reversed_amplitude(cycles.amplitude, cycles.mean, None)
    assert same.tolist() == cycles.amplitude.tolist()
    assert damage_interval(cycles, curve, 1.0) == damage_interval(cycles, curve, 1.0, 0.0, None)


@given(curves(), FACTORS, FACTORS, st.lists(st.floats(1.0, 2000.0), min_size=1, max_size=20))
def test_a_lower_factor_never_lengthens_a_life(curve, a, b, stress):
    low, high = (lowered_line(curve, f).cycles_to_failure(stress) for f in sorted((a, b)))
    assert np.all(low <= high * (1.0 + 1e-6))
    assert np.all(high <= curve.cycles_to_failure(stress) * (1.0 + 1e-6))


@given(curves(), FACTORS)
def test_the_endurance_limit_takes_the_whole_factor(curve, factor):
    line = lowered_line(curve, factor)
    assert line.endurance == pytest.approx(factor * curve.endurance, rel=1e-9)
    assert line.knee_cycles == pytest.approx(curve.knee_cycles, rel=1e-6)


@given(
    st.floats(0.0, 500.0), st.floats(-600.0, 600.0), st.floats(0.0, 50.0), st.floats(50.0, 700.0)
)
def test_a_larger_mean_or_amplitude_never_damages_less(amplitude, mean, more, ultimate):
    plain = float(reversed_amplitude(amplitude, mean, ultimate))
    assert plain >= amplitude
    assert float(reversed_amplitude(amplitude + more, mean, ultimate)) >= plain
    further = float(reversed_amplitude(amplitude, abs(mean) + more, ultimate))
    assert further >= plain or further == pytest.approx(plain)
    assert float(reversed_amplitude(amplitude, -mean, ultimate)) == plain


@given(HISTORIES, ANY_RESIDUE, st.floats(300.0, 2000.0))
def test_no_cycle_has_a_larger_reversed_amplitude_than_the_extremes(torque, residue, ultimate):
    """What settles the matter without counting, for stresses below the ultimate strength."""
    history = counted_history(torque)
    assume(float(np.max(np.abs(history))) < ultimate)
    cycles = count_cycles(history, residue)
    top, bottom = float(np.max(history)), float(np.min(history))
    bound = float(reversed_amplitude(0.5 * (top - bottom), 0.5 * (top + bottom), ultimate))
    found = reversed_amplitude(cycles.amplitude, cycles.mean, ultimate)
    assert np.all(found <= bound * (1.0 + 1e-9))
