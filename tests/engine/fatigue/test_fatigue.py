"""Stress, S-N line, counting, damage and starts: values by hand, and every refusal."""

import dataclasses
import math

import numpy as np
import pytest

from engine.case.data import ElementRow, MaterialRow, SNPointRow
from engine.errors import InternalError, ModelError
from engine.fatigue.allowable_starts import allowable_starts, notes_on_starts, shaft_fatigue
from engine.fatigue.cycle_counting import (
    CycleCount,
    count_cycles,
    counted_history,
    paper_count,
    turning_points,
)
from engine.fatigue.damage import (
    damage_interval,
    miner_damage,
    needs_counting,
    starts_from_damage,
    starts_in_words,
)
from engine.fatigue.sn_curve import SNCurve, sn_curve_for
from engine.fatigue.stress import shear_stress

MPA = 1e6
STEEL = MaterialRow(material="steel", yield_=600 * MPA)
# One N m makes one Pa, so that torques below read as stresses.
UNIT_DIAMETER = (16.0 / math.pi) ** (1.0 / 3.0)
SHAFT = ElementRow(element="HP shaft", kind="shaft", stress_diameter=UNIT_DIAMETER)


def curve(endurance=100 * MPA, below="none", points=((1e3, 400 * MPA), (1e6, 100 * MPA))):
    return SNCurve(*np.array(points).T, endurance=endurance, below_endurance=below)


def rows(*points, material="steel"):
    return [SNPointRow(material=material, cycles=N, stress=S) for N, S in points]


TWO_POINTS = rows((1e3, 400 * MPA), (1e6, 100 * MPA))


# --- stress ---------------------------------------------------------------------------------------


def test_stress_of_a_solid_and_of_a_hollow_shaft():
    assert shear_stress(1000.0, 0.1) == pytest.approx(16 * 1000.0 / (math.pi * 0.1**3), rel=1e-14)
    hollow = 16 * 1000.0 * 0.1 / (math.pi * (0.1**4 - 0.06**4))
    assert shear_stress(1000.0, 0.1, 0.06) == pytest.approx(hollow, rel=1e-14)


def test_stress_keeps_sign_and_shape():
    stress = shear_stress([[1.0, -2.0]], 0.1)
    assert stress.shape == (1, 2)
    assert stress[0, 1] == -2.0 * stress[0, 0]


@pytest.mark.parametrize(("diameter", "bore"), [(0.0, 0.0), (-0.1, 0.0), (0.1, 0.1), (0.1, -0.01)])
def test_impossible_sections(diameter, bore):
    with pytest.raises(ModelError, match="Stress diameter is"):
        shear_stress(1.0, diameter, bore)


# --- S-N line -------------------------------------------------------------------------------------


@pytest.mark.parametrize("below", ["none", "same slope", "2k-1"])
def test_the_line_goes_through_its_points(below):
    three = curve(50 * MPA, below, [(1e3, 400 * MPA), (2e4, 200 * MPA), (1e6, 100 * MPA)])
    assert three.cycles_to_failure(three.stress).tolist() == three.cycles.tolist()


def test_between_points_it_is_straight_in_log_log():
    assert curve().cycles_to_failure(200 * MPA) == pytest.approx(math.sqrt(1e9), rel=1e-13)


def test_beyond_the_last_point_its_slope_goes_on_down_to_the_endurance_limit():
    k = 3.0 / math.log10(4.0)
    low = curve(80 * MPA)
    assert low.knee_cycles == pytest.approx(1e6 * 1.25**k, rel=1e-13)
    assert low.cycles_to_failure(90 * MPA) == pytest.approx(1e6 * (100 / 90) ** k, rel=1e-13)
    assert low.cycles_to_failure(80.0001 * MPA) == pytest.approx(low.knee_cycles, rel=1e-4)


@pytest.mark.parametrize("endurance", [100 * MPA, 80 * MPA])
def test_the_three_rules_below_the_endurance_limit(endurance):
    k = 3.0 / math.log10(4.0)
    knee = curve(endurance).knee_cycles
    S = 0.5 * endurance
    assert curve(endurance, "none").cycles_to_failure(endurance) == math.inf
    assert curve(endurance, "none").cycles_to_failure(S) == math.inf
    same = curve(endurance, "same slope").cycles_to_failure(S)
    assert same == pytest.approx(knee * 2**k, rel=1e-13)
    haibach = curve(endurance, "2k-1").cycles_to_failure(S)
    assert haibach == pytest.approx(knee * 2 ** (2 * k - 1), rel=1e-13)
    for below in ("same slope", "2k-1"):
        assert curve(endurance, below).cycles_to_failure(endurance) == pytest.approx(knee)
        assert curve(endurance, below).cycles_to_failure(0.0) == math.inf


def test_above_the_first_point_the_first_slope_goes_on_and_is_flagged():
    three = curve(100 * MPA, "none", [(1e3, 400 * MPA), (1e4, 200 * MPA), (1e6, 100 * MPA)])
    assert three.cycles_to_failure(800 * MPA) == pytest.approx(100.0, rel=1e-13)
    assert three.above_first_point([400 * MPA, 401 * MPA]).tolist() == [False, True]


@pytest.mark.parametrize("amplitude", [-1.0, math.nan])
def test_an_amplitude_that_is_none(amplitude):
    with pytest.raises(InternalError):
        curve().cycles_to_failure([1.0, amplitude])


@pytest.mark.parametrize(
    ("points", "endurance", "below", "sentence"),
    [
        ([(1e3, 4.0)], 1.0, "none", "1 point"),
        ([(1e3, 4.0), (1e6, 4.0)], 1.0, "none", "must fall"),
        ([(1e6, 4.0), (1e3, 1.0)], 1.0, "none", "must fall"),
        ([(1e3, 4.0), (1e6, -1.0)], 1.0, "none", "positive"),
        ([(1e3, 4.0), (1e6, 1.0)], 0.0, "none", "positive"),
        ([(1e3, 4.0), (math.inf, 1.0)], 1.0, "none", "positive"),
        ([(1e3, 4.0), (1e6, 1.0)], 2.0, "none", "Endurance is"),
        ([(1e3, 4.0), (1e6, 1.0)], 1.0, "never", "Below endurance is 'never'"),
        ([(1e3, 40.0), (1.5e3, 1.0)], 1.0, "2k-1", "more than 0.5"),
    ],
)
def test_lines_that_are_refused(points, endurance, below, sentence):
    with pytest.raises(ModelError, match=sentence):
        curve(endurance, below, points)


def test_the_table_rows_of_another_material_are_passed_over():
    other = rows((1.0, 9e9), (2.0, 8e9), material="other")
    line = sn_curve_for(MaterialRow(material="steel", endurance=90 * MPA), [*other, *TWO_POINTS])
    assert line.cycles.tolist() == [1e3, 1e6]
    assert (line.endurance, line.below_endurance, line.notes) == (90 * MPA, "none", ())


def test_bending_halves_every_stress_and_says_so():
    line = sn_curve_for(
        MaterialRow(material="steel", endurance=90 * MPA, basis="bending"), TWO_POINTS
    )
    assert line.stress.tolist() == [200 * MPA, 50 * MPA]
    assert line.endurance == 45 * MPA
    assert any("halved" in note for note in line.notes)


def test_a_blank_endurance_is_the_last_stress_and_says_so():
    line = sn_curve_for(MaterialRow(material="steel"), TWO_POINTS)
    assert line.endurance == 100 * MPA
    assert any("blank" in note for note in line.notes)


def test_an_endurance_typed_in_another_unit_is_still_the_last_stress():
    line = sn_curve_for(
        MaterialRow(material="steel", endurance=100 * MPA * (1 + 1e-12)), TWO_POINTS
    )
    assert line.knee_cycles == pytest.approx(1e6, rel=1e-10)


@pytest.mark.parametrize(
    ("material", "points", "sentence"),
    [
        (MaterialRow(material="steel"), [], "Material 'steel': It has 0 complete"),
        (MaterialRow(material="steel"), TWO_POINTS[:1], "1 complete S-N point"),
        (MaterialRow(material="steel"), [*TWO_POINTS, SNPointRow(material="steel")], "2 complete"),
        (MaterialRow(material="steel", basis="tension"), TWO_POINTS, "Basis is 'tension'"),
        (
            MaterialRow(material="steel"),
            TWO_POINTS[::-1],
            "Material 'steel': The stress of an S-N line must fall",
        ),
    ],
)
def test_materials_that_are_refused(material, points, sentence):
    with pytest.raises(ModelError, match=sentence):
        sn_curve_for(material, points)


# --- counting -------------------------------------------------------------------------------------


def test_turning_points():
    assert turning_points([0, 0, 1, 2, 2, 1, 1, 3, 3]).tolist() == [0, 2, 1, 3]
    assert turning_points([5, 5, 5]).tolist() == [5]
    assert turning_points([]).tolist() == []
    with pytest.raises(InternalError):
        turning_points([0.0, math.nan])


def test_a_start_is_counted_from_rest_to_rest():
    assert counted_history([3, 1, 2]).tolist() == [0, 3, 1, 2, 0]
    assert counted_history([0, 3, 1]).tolist() == [0, 3, 0]
    assert counted_history([]).tolist() == [0]


@pytest.mark.parametrize("residue", ["half cycles", "repeated"])
@pytest.mark.parametrize("history", [[], [1.0], [2.0, 2.0]])
def test_nothing_to_count(history, residue):
    cycles = count_cycles(history, residue)
    assert cycles.range.size == cycles.mean.size == cycles.count.size == 0
    assert paper_count(history).range.size == 0


def test_two_points_are_half_a_cycle():
    cycles = count_cycles([0.0, 5.0])
    assert (cycles.range.tolist(), cycles.mean.tolist(), cycles.count.tolist()) == (
        [5],
        [2.5],
        [0.5],
    )
    assert count_cycles([0.0, 5.0], "repeated").count.tolist() == [1.0]


def test_the_paper_sees_the_vibration_and_not_the_rise_under_it():
    history = [0, 10, 8, 10, 8, 10, 0]
    assert paper_count(history).range.tolist() == [10, 2, 2, 2, 2, 10]
    assert paper_count(history).mean.tolist() == [5, 9, 9, 9, 9, 5]
    rising = [0, 4, 2, 8, 6, 10, 0]
    assert max(paper_count(rising[:-1]).range) == 6
    assert max(count_cycles(rising).range) == 10


def test_a_count_cannot_be_written_to_nor_changes_with_its_source():
    source = np.array([1.0])
    cycles = CycleCount(source, source, source)
    source[0] = 7.0
    assert cycles.range.tolist() == [1.0]
    with pytest.raises(ValueError):
        cycles.range[0] = 2.0
    with pytest.raises(dataclasses.FrozenInstanceError):
        cycles.range = source


# --- damage ---------------------------------------------------------------------------------------


def test_damage_by_hand():
    q = miner_damage([400 * MPA, 100.0001 * MPA, 99 * MPA], [2.0, 0.5, 1e9], curve())
    assert q == pytest.approx(2e-3 + 0.5e-6, rel=1e-5)
    assert miner_damage([], [], curve()) == 0.0


def test_starts_from_damage():
    assert starts_from_damage(0.25) == 4.0
    assert starts_from_damage(0.0) is None
    assert starts_from_damage(5e-324) is None
    assert starts_from_damage(math.inf) == 0.0


def test_interval_with_absolute_and_relative_error():
    cycles = CycleCount([400 * MPA], [300 * MPA], [1.0])  # from 100 to 500 MPa
    low, high = damage_interval(cycles, curve(), 10 * MPA, 0.1)
    assert low == miner_damage([160 * MPA], [1.0], curve())
    assert high == miner_damage([240 * MPA], [1.0], curve())


@pytest.mark.parametrize("error", [-1.0, math.nan, math.inf])
def test_errors_that_bound_nothing(error):
    with pytest.raises(InternalError):
        damage_interval(CycleCount([], [], []), curve(), error)
    with pytest.raises(InternalError):
        shaft_fatigue(SHAFT, [1.0], curve(), STEEL, torque_error=error)


def test_when_counting_is_called_for():
    assert not needs_counting(100 * MPA, curve())
    assert needs_counting(100.1 * MPA, curve())
    assert needs_counting(99 * MPA, curve(), 2 * MPA)
    assert needs_counting(1.0, curve(below="2k-1"))


# --- one shaft ------------------------------------------------------------------------------------


def test_a_shaft_by_hand():
    """0 → 300 → −300 → 0: halves of amplitude 150, 300 and 150 MPa, with SCF 1."""
    line = curve()
    shaft = shaft_fatigue(SHAFT, np.array([300.0, -300.0]) * MPA, line, STEEL)
    q = sum(0.5 / float(line.cycles_to_failure(S * MPA)) for S in (150, 300, 150))
    assert shaft.element == "HP shaft"
    assert shaft.damage == pytest.approx(q, rel=1e-12)
    assert shaft.damage_low == shaft.damage_high == shaft.damage
    assert shaft.allowable_starts == pytest.approx(1 / q, rel=1e-12)
    assert shaft.starts_low == shaft.starts_high == shaft.allowable_starts
    assert shaft.starts_error == 0.0
    assert shaft.paper_damage == pytest.approx(q, rel=1e-12)
    assert shaft.peak_nominal_stress == pytest.approx(300 * MPA)
    assert shaft.largest_amplitude == pytest.approx(300 * MPA)
    assert (shaft.counted, shaft.unlimited) == (True, False)
    assert shaft.cycles.amplitude == pytest.approx([150 * MPA, 300 * MPA, 150 * MPA])


def test_repeated_residue_closes_the_largest_cycle():
    line = curve()
    torque = np.array([300.0, -300.0]) * MPA
    shaft = shaft_fatigue(SHAFT, torque, line, STEEL, "repeated")
    assert shaft.damage == pytest.approx(1 / float(line.cycles_to_failure(300 * MPA)), rel=1e-12)


def test_scf_and_section_make_the_stress():
    element = ElementRow(element="s", stress_diameter=0.07, stress_bore=0.02, scf=3.0)
    shaft = shaft_fatigue(element, [9000.0, -3000.0], curve(), STEEL)
    nominal = float(shear_stress(9000.0, 0.07, 0.02))
    assert shaft.peak_nominal_stress == pytest.approx(nominal, rel=1e-14)
    assert shaft.largest_amplitude == pytest.approx(3.0 * nominal * (12 / 18), rel=1e-14)
    assert max(shaft.cycles.amplitude) == pytest.approx(shaft.largest_amplitude, rel=1e-14)


def test_below_the_endurance_limit_nothing_is_counted():
    shaft = shaft_fatigue(SHAFT, np.array([150.0, -50.0]) * MPA * 0.999, curve(), STEEL)
    assert (shaft.damage, shaft.allowable_starts, shaft.unlimited) == (0.0, None, True)
    assert (shaft.starts_low, shaft.starts_high, shaft.paper_starts) == (None, None, None)
    assert (shaft.counted, shaft.cycles.range.size) == (False, 0)
    assert shaft.notes == ()  # good news is no note
    assert shaft.starts_error is None


def test_counting_can_be_forced():
    torque = np.array([150.0, -50.0]) * MPA * 0.999
    shaft = shaft_fatigue(SHAFT, torque, curve(), STEEL, always_count=True)
    assert (shaft.counted, shaft.unlimited, shaft.cycles.range.size) == (True, True, 3)
    assert shaft.notes == ()


@pytest.mark.parametrize(("endurance", "counted"), [(285.0, True), (305.0, True), (309.0, False)])
def test_the_error_that_decides_counting_is_multiplied_by_scf(endurance, counted):
    """±100 MPa nominal, SCF 3: 300 MPa, and 2 % of it on top make 306; without SCF it would be 302."""
    notched = dataclasses.replace(SHAFT, scf=3.0)
    line = curve(endurance * MPA, points=((1e3, 900 * MPA), (1e6, endurance * MPA)))
    torque = np.array([100.0, -100.0]) * MPA
    for error in ({"relative_torque_error": 0.02}, {"torque_error": 2 * MPA}):
        assert shaft_fatigue(notched, torque, line, STEEL, **error).counted == counted


def test_no_torque_at_all():
    for torque in ([], [0.0]):
        shaft = shaft_fatigue(SHAFT, torque, curve(below="same slope"), STEEL)
        assert (shaft.unlimited, shaft.peak_nominal_stress) == (True, 0.0)


def test_the_interval_ends_at_unlimited_near_the_endurance_limit():
    torque = np.array([101.0, -101.0]) * MPA
    shaft = shaft_fatigue(SHAFT, torque, curve(), STEEL, torque_error=2 * MPA)
    assert shaft.starts_low < shaft.allowable_starts
    assert shaft.starts_high is None
    assert shaft.starts_error is None
    assert any(
        "upper bound of the allowable starts is unlimited" in note
        for note in notes_on_starts([shaft])
    )


def test_just_below_the_limit_the_interval_begins_at_a_number():
    torque = np.array([99.0, -99.0]) * MPA
    shaft = shaft_fatigue(SHAFT, torque, curve(), STEEL, relative_torque_error=0.02)
    assert (shaft.unlimited, shaft.starts_high) == (True, None)
    assert shaft.starts_low > 1e5
    assert any(
        "upper bound of the allowable starts is unlimited" in note
        for note in notes_on_starts([shaft])
    )


def test_cycles_above_the_first_point_are_counted_and_told():
    shaft = shaft_fatigue(SHAFT, np.array([410.0, -410.0, 300.0]) * MPA, curve(), STEEL)
    assert shaft.above_first_point == 0.5
    assert any(
        "0.5 cycles per start lie above the first S-N point" in n for n in notes_on_starts([shaft])
    )


@pytest.mark.parametrize(
    ("torque", "scf", "above", "sentence"),
    [
        (
            301.0,
            1.0,
            True,
            "above the shear yield Yield/2 = 300 MPa (43.51 ksi) (maximum shear theory)",
        ),
        (200.0, 2.0, False, "local yielding at the notch"),
        (100.0, 2.0, False, None),
    ],
)
def test_shear_yield_is_judged_on_the_nominal_peak(torque, scf, above, sentence):
    element = dataclasses.replace(SHAFT, scf=scf)
    shaft = shaft_fatigue(element, [-torque * MPA], curve(), STEEL)
    assert shaft.above_shear_yield is above
    said = [note for note in notes_on_starts([shaft]) if "yield" in note]
    assert len(said) == (0 if sentence is None else 1)
    assert sentence is None or sentence in said[0]


def test_a_blank_yield_is_not_judged():
    shaft = shaft_fatigue(SHAFT, [500 * MPA], curve(), MaterialRow(material="steel"))
    assert shaft.above_shear_yield is None


def test_notes_of_the_line_come_first():
    line = sn_curve_for(MaterialRow(material="steel", basis="bending"), TWO_POINTS)
    shaft = shaft_fatigue(SHAFT, np.array([2000.0]) * MPA, line, STEEL)
    said = tuple(notes_on_starts([shaft]))
    assert said[:2] == line.notes
    assert len(said) > 2


def test_several_shafts_with_one_cause_are_one_note():
    """Nominal peaks of 350 and 500 MPa above a shear yield of 300 MPa; 100 MPa is below."""
    named = [
        shaft_fatigue(dataclasses.replace(SHAFT, element=name), [peak * MPA], curve(), STEEL)
        for name, peak in (("near", 350.0), ("far", 500.0), ("last", 100.0))
    ]
    (note,) = (n for n in notes_on_starts(named) if "shear yield" in n)
    assert note.startswith("far (worst of 2 shafts): the nominal peak 500 MPa")


# --- the train ------------------------------------------------------------------------------------


def shaft(name, peak, error=0.0):
    element = dataclasses.replace(SHAFT, element=name)
    torque = np.array([peak, -peak]) * MPA
    return shaft_fatigue(element, torque, curve(), STEEL, torque_error=error * MPA)


def test_the_shaft_with_the_fewest_starts_governs():
    shafts = [shaft("a", 150), shaft("b", 250), shaft("c", 50)]
    starts = allowable_starts(shafts, 4.0)
    assert starts.governing == "b"
    assert starts.starts == shafts[1].allowable_starts
    assert starts.judged_starts == starts.starts / 4.0
    assert (starts.unlimited, starts.starts_factor) == (False, 4.0)
    assert starts.shafts == tuple(shafts)


def test_all_unlimited_has_no_governing_shaft():
    starts = allowable_starts([shaft("a", 50), shaft("b", 60)])
    assert (starts.governing, starts.starts, starts.judged_starts) == (None, None, None)
    assert (starts.unlimited, starts.starts_factor) == (True, 1.0)


def test_among_the_unlimited_one_within_its_error_governs():
    starts = allowable_starts([shaft("a", 50), shaft("b", 99, 2.0)])
    assert (starts.governing, starts.unlimited) == ("b", True)
    assert starts.starts_low is not None
    assert starts.starts_high is None


def test_the_interval_is_of_the_least_starts():
    exact, rough = shaft("exact", 200), shaft("rough", 195, 20.0)
    starts = allowable_starts([exact, rough])
    assert starts.governing == "exact"
    assert starts.starts_low == rough.starts_low
    assert starts.starts_high == exact.starts_high
    assert starts.starts_error == pytest.approx(1 - rough.starts_low / exact.allowable_starts)


def test_the_upper_end_is_the_least_of_all_shafts_too():
    """The governing shaft may last longer than it says; the one beside it ends sooner for sure."""
    rough, exact = shaft("rough", 200, 20.0), shaft("exact", 199)
    starts = allowable_starts([rough, exact])
    assert starts.governing == "rough"
    assert starts.starts_low == rough.starts_low
    assert rough.starts_high > exact.starts_high
    assert starts.starts_high == exact.starts_high


def test_no_judged_shaft_is_not_unlimited():
    starts = allowable_starts([])
    assert (starts.governing, starts.starts, starts.unlimited) == (None, None, False)


@pytest.mark.parametrize(
    ("starts", "words"),
    [
        (15119.26, "15,119"),
        (15119.0 - 1e-6, "15,119"),
        (123_456_789.3, "123,456,789"),
        (21_517_068_562_385_580.0, "2.15e+16"),
    ],
)
def test_starts_are_whole_ones_and_absurd_ones_a_power(starts, words):
    assert starts_in_words(starts) == words
