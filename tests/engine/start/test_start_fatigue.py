"""From a start to allowable starts: whether cycles are counted, and how sure the damage is."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from engine.case.case import Case
from engine.case.data import SNPointRow
from engine.fatigue.allowable_starts import shaft_fatigue
from engine.fatigue.shaft_strength import shaft_strength
from engine.start.start import Start
from engine.start.start_fatigue import starts_of, stress_over_endurance
from tests.sample_case import sample_case
from tests.trains import started

SAMPLE = sample_case("proposed")
SHAFT = next(e for e in SAMPLE.elements if e.stress_diameter)
INDEX = SAMPLE.elements.index(SHAFT)


@pytest.fixture(scope="module")
def start() -> Start:
    return started(SAMPLE)


def with_line(highest: float, endurance: float, below: str = "none") -> Case:
    """The sample with one straight S-N line of slope 5."""
    factor = 10.0 ** (5.0 * math.log10(highest / endurance))
    points = (
        SNPointRow(SHAFT.material, 1e3, highest),
        SNPointRow(SHAFT.material, 1e3 * factor, endurance),
    )
    material = replace(SAMPLE.materials[0], endurance=endurance, below_endurance=below)
    return replace(SAMPLE, materials=(material,), sn_points=points)


def with_coarse(start: Start, factor: float) -> Start:
    """The start whose torques at twice the step are so many times those of the finer one."""
    coarse = tuple((when, factor * value) for when, value in start.turning_points)
    return replace(start, coarse_turning_points=coarse)


def test_counting_is_decided_with_the_error_of_the_history(start: Start) -> None:
    """Half of 16 SCF T/(π d³), rest to peak, a little below an endurance limit that its error passes."""
    peak = next(p for p in start.peaks if p.element == SHAFT.element)
    unit = 16.0 * (SHAFT.scf or 1.0) / (math.pi * (SHAFT.stress_diameter or 0.0) ** 3)
    amplitude = 0.5 * unit * peak.peak_to_peak
    for share, count in ((0.5, True), (50.0, False)):
        endurance = amplitude + share * unit * peak.error
        found = stress_over_endurance(with_line(10.0 * endurance, endurance), start)
        assert found is not None
        ratio, must_count = found
        assert must_count is count
        assert (ratio > 1.0) is count
        assert ratio >= (amplitude + unit * peak.error) / endurance * (1.0 - 1e-12)


def test_the_error_of_the_starts_is_the_change_of_the_damage_between_two_steps(
    start: Start,
) -> None:
    """On a line of slope 5, torques 1 % larger damage 1.01⁵ times as much; half of that is the error."""
    case = with_line(1e9, 1e8, "same slope")
    starts, errors = starts_of(case, with_coarse(start, 1.01))
    assert starts is not None
    assert [name for name, _ in errors] == [SHAFT.element]
    modes = (1.0 + start.truncation_error) ** 5 - 1.0  # modes left out may do that to every torque
    assert [error for _, error in errors] == pytest.approx(
        [0.5 * (1.01**5 - 1.0) + modes], rel=1e-9
    )


@pytest.mark.parametrize("of_peak", [0.2, 5.0])
def test_a_third_of_the_change_of_the_damaging_ranges_is_the_error_of_every_turning_point(
    start: Start, of_peak: float
) -> None:
    """Here a third of a tenth of a per cent, whatever the error of the peak."""
    case = with_line(1e9, 1e8, "same slope")
    order = [int(i) for i in np.flatnonzero(start.output_of_element >= 0)]
    torque = start.turning_points[order.index(INDEX)][1]
    change = 1e-3 * float(np.max(np.abs(np.diff(torque))))
    peaks = tuple(replace(p, error=of_peak * change) for p in start.peaks)
    starts, errors = starts_of(case, replace(with_coarse(start, 1.001), peaks=peaks))
    assert starts is not None
    by_hand = shaft_fatigue(
        SHAFT,
        torque,
        shaft_strength(case, SHAFT).curve,
        case.materials[0],
        relative_torque_error=1e-3 / 3.0 + start.truncation_error,
    )
    (shaft,), ((_, error),) = starts.shafts, errors
    assert error is not None
    low = min(by_hand.damage_low, shaft.damage / (1.0 + error))
    high = max(by_hand.damage_high, shaft.damage * (1.0 + error))
    assert shaft.damage_low == pytest.approx(low, rel=1e-9)
    assert shaft.damage_high == pytest.approx(high, rel=1e-9)


def test_effects_left_out_widen_the_interval_and_one_without_a_bound_leaves_none(
    start: Start,
) -> None:
    """On a line of slope 5 a bound of 1 % on every torque is 1.01⁵ − 1 on the damage, and 1e-7 of a torque 5e-7."""
    case = with_line(1e9, 1e8, "same slope")
    exact = with_coarse(replace(start, truncation_error=0.0), 1.0)
    known, _ = starts_of(case, replace(exact, left_out=0.01))
    unknown, _ = starts_of(case, replace(exact, left_out=None))
    assert known is not None
    assert unknown is not None
    (shaft,), (other,) = known.shafts, unknown.shafts
    least = 1.0 + 5e-7
    assert shaft.left_out == pytest.approx(1.01**5 - 1.0, rel=1e-9)
    assert shaft.starts_low == pytest.approx(shaft.allowable_starts / 1.01**5 / least, rel=1e-9)
    assert shaft.starts_high == pytest.approx(shaft.allowable_starts * 1.01**5 * least, rel=1e-9)
    assert known.bounded
    assert not unknown.bounded
    assert (other.starts_low, other.starts_high, other.left_out) == (None, None, None)
    assert other.allowable_starts == shaft.allowable_starts
