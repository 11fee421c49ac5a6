"""Notch, strength factors and mean stress of a judged shaft: by hand, and where each acts."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from engine.case.choices import MeanStress
from engine.case.data import (
    CaseData,
    ElementRow,
    FatigueFactorRow,
    MaterialRow,
    SectionRow,
    SNPointRow,
)
from engine.fatigue.allowable_starts import allowable_starts, notes_on_starts, shaft_fatigue
from engine.fatigue.mean_stress import reversed_amplitude
from engine.fatigue.shaft_strength import notch_effect, shaft_strength
from engine.fatigue.sn_curve import SNCurve
from engine.fatigue.strength_factors import lowered_line
from engine.operation.steady_state import vibratory_limit

MPA = 1e6
SHAFT = ElementRow("shaft", "shaft", "a", "b", stress_diameter=0.1, material="steel")
STEEL = MaterialRow("steel", uts=700 * MPA, yield_=450 * MPA, endurance=150 * MPA)
POINTS = (
    SNPointRow("steel", 1e3, 400 * MPA),
    SNPointRow("steel", 1e6, 150 * MPA),
)


def case(row: FatigueFactorRow | None = None, shaft=SHAFT, **more) -> CaseData:
    return CaseData(
        elements=(shaft,),
        materials=(STEEL,),
        sn_points=POINTS,
        fatigue_factors=() if row is None else (row,),
        **more,
    )


def test_without_a_row_all_is_that_of_scf_and_data():
    notched = replace(SHAFT, scf=1.7)
    strength = shaft_strength(case(shaft=notched), notched)
    plain = shaft_strength(case(FatigueFactorRow("shaft"), shaft=notched), notched)
    for found in (strength, plain):
        assert (found.factor, found.notch.fatigue, found.ultimate) == (1.0, 1.7, None)
        assert found.curve.stress.tolist() == [400 * MPA, 150 * MPA]
        assert found.sources == "Kt: SCF"
    assert shaft_strength(case(), SHAFT).sources == ""


def test_every_factor_by_hand():
    """Machined: 4.51 × 700^−0.265 = 0.7947; 100 mm: 1.51 × 100^−0.157 = 0.7327; 99 %: 0.814; product 0.4740."""
    row = FatigueFactorRow("shaft", surface="machined", size="by diameter", reliability=0.99)
    strength = shaft_strength(case(row), SHAFT)
    assert strength.surface.value == pytest.approx(0.7947, abs=1e-4)
    assert strength.size.value == pytest.approx(0.7327, abs=1e-4)
    assert strength.reliability.value == 0.814
    assert strength.curve.endurance == pytest.approx(0.4740 * 150 * MPA, rel=2e-4)
    assert strength.data_endurance == 150 * MPA
    assert strength.sources == "surface: machined; size: 100 mm; 99 % endure"
    typed = FatigueFactorRow("shaft", surface=0.8, size=0.7)
    assert shaft_strength(case(typed), SHAFT).factor == pytest.approx(0.56)


def test_factors_act_after_the_halving_of_bending_data():
    """No load factor for torsion: half of 150 MPa, times 0.8."""
    row = FatigueFactorRow("shaft", surface=0.8)
    bending = replace(case(row), materials=(replace(STEEL, basis="bending"),))
    assert shaft_strength(bending, SHAFT).curve.endurance == pytest.approx(60 * MPA)


def test_the_line_is_lowered_towards_endurance_alone():
    """Half of the way from 10³ to 10⁶ cycles, half of the logarithm of the factor."""
    data = SNCurve(np.array([1e2, 1e6]), np.array([800 * MPA, 200 * MPA]), 200 * MPA)
    line = lowered_line(data, 0.5)

    def at(curve: SNCurve, life: float) -> float:
        return float(np.interp(np.log(life), np.log(curve.cycles), np.log(curve.stress)))

    for life, factor in ((1e2, 1.0), (1e3, 1.0), (10**4.5, 0.5**0.5), (1e6, 0.5)):
        assert at(line, life) - at(data, life) == pytest.approx(np.log(factor), abs=1e-12)
    assert line.endurance == 100 * MPA
    assert line.extended == 0


def test_above_tested_data_a_lowered_line_promises_no_more():
    """Data from 10⁴ cycles on: the line to 10³ is an extension, and beyond it that of the data."""
    data = SNCurve(np.array([1e4, 1e6]), np.array([400 * MPA, 200 * MPA]), 200 * MPA)
    line = lowered_line(data, 0.5)
    assert line.first_stress == pytest.approx(400 * MPA * 0.5 ** (1 / 3))
    assert bool(line.above_first_point(line.first_stress * 1.001))
    assert not bool(line.above_first_point(line.first_stress))
    stress = np.geomspace(101 * MPA, 3000 * MPA, 60)
    assert np.all(line.cycles_to_failure(stress) <= data.cycles_to_failure(stress) * (1 + 1e-9))


def test_a_knee_far_beyond_a_million_cycles_takes_the_whole_factor():
    data = SNCurve(np.array([1e3, 1e5]), np.array([400 * MPA, 300 * MPA]), 100 * MPA)
    line = lowered_line(data, 0.5)
    assert line.knee_cycles == pytest.approx(data.knee_cycles, rel=1e-9)
    stress = 300 * MPA * (1e5 / 1e6) ** (1.0 / data.slope[-1])  # of the data at 10⁶ cycles
    assert float(line.cycles_to_failure(0.5 * stress)) == pytest.approx(1e6, rel=1e-9)


def test_a_knee_below_a_thousand_cycles_lowers_the_whole_line():
    data = SNCurve(np.array([1.0, 100.0]), np.array([400 * MPA, 300 * MPA]), 300 * MPA)
    line = lowered_line(data, 0.5)
    assert line.stress.tolist() == pytest.approx([200 * MPA, 150 * MPA])


def test_kt_of_a_fillet_comes_from_the_sections():
    sections = (
        SectionRow("shaft", "thin", 0.2, 0.1, fillet=0.005),
        SectionRow("shaft", "thick", 0.2, 0.12),
        SectionRow("shaft", "end", 0.2, 0.11),
    )
    row = FatigueFactorRow("shaft", notch="fillet")
    found = notch_effect(case(row, sections=sections), SHAFT).concentration
    # h/r = 2 and x = 1/6
    c = [a + b * 2**0.5 + c * 2 for a, b, c in ((0.905, 0.783, -0.075), (-0.437, -1.969, 0.553), (1.557, 1.073, -0.578), (-1.061, 0.171, 0.086))]  # fmt: skip
    assert found.value == pytest.approx(c[0] + c[1] / 6 + c[2] / 36 + c[3] / 216, rel=1e-12)
    assert found.source == "fillet 100/120, r 5 mm"
    typed = replace(row, notch_radius=0.005, shoulder_diameter=0.12)
    assert notch_effect(case(typed), SHAFT).concentration.value == found.value


def test_notch_sensitivity_acts_in_fatigue_and_not_on_uts_over_25():
    notched = replace(SHAFT, scf=3.0)
    row = FatigueFactorRow("shaft", notch_sensitivity=0.5)
    with_row = case(row, shaft=notched)
    assert shaft_strength(with_row, notched).notch.fatigue == 2.0
    limit = vibratory_limit(with_row, notched)
    assert limit == vibratory_limit(case(shaft=notched), notched)


def test_goodman_by_hand():
    """100 MPa about 234.5 MPa with UTS 700 MPa: Ssu = 469 MPa, so 100 / (1 − ½) = 200 MPa; either sign."""
    for mean in (234.5, -234.5):
        assert reversed_amplitude(100.0, mean, 469.0) == pytest.approx(200.0)
    assert reversed_amplitude(100.0, 300.0, None) == 100.0
    assert reversed_amplitude(1.0, 469.0, 469.0) >= 469.0  # no amplitude is left


def judged(torque, mean_stress=None, row=None, **more):
    data = case(row, mean_stress=mean_stress)
    strength = shaft_strength(data, SHAFT)
    per_torque = 16.0 / (np.pi * 0.1**3)
    return shaft_fatigue(SHAFT, np.array(torque) * MPA / per_torque, strength, STEEL, **more)


def test_goodman_is_judged_against_the_line():
    """From 0 to 234.5 MPa: amplitude and mean 117.25 MPa, below endurance; reversed 117.25 / (1 − ¼) = 156.3 MPa, above."""
    torque = [234.5, 0.0]
    assert judged(torque).unlimited
    shaft = judged(torque, MeanStress.GOODMAN)
    assert shaft.counted
    assert not shaft.unlimited
    assert shaft.largest_amplitude == pytest.approx(117.25 * MPA / 0.75)
    assert shaft.amplitudes == pytest.approx(shaft.largest_amplitude)
    line = shaft_strength(case(), SHAFT).curve
    expected = float(shaft.cycles.count.sum()) / float(line.cycles_to_failure(117.25 * MPA / 0.75))
    assert shaft.damage == pytest.approx(expected)


def test_no_start_is_unlimited_within_the_error_of_its_mean():
    """Just below endurance; with the error of the history amplitude and mean may be larger."""
    torque = [0.99 * 150 * 2 / (1 + 150 / 469), 0.0]
    sure = judged(torque, MeanStress.GOODMAN)
    assert (sure.counted, sure.unlimited) == (False, True)
    unsure = judged(torque, MeanStress.GOODMAN, relative_torque_error=0.02)
    assert unsure.counted
    assert unsure.damage == 0.0 < unsure.damage_high
    assert unsure.starts_low is not None


def test_a_mean_above_the_ultimate_strength_is_said_and_never_unlimited():
    shaft = judged([520.0, 480.0, 520.0], MeanStress.GOODMAN)
    assert shaft.above_ultimate
    assert shaft.damage > 0.0
    assert any("Goodman's line ends" in words for words in notes_on_starts([shaft]))
    assert allowable_starts([shaft]).starts is not None
