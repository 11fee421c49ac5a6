"""A start whose shaft has strength factors and a mean stress: the parts of the calculation agree."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from sample_case import sample_case

from engine.case.case import Case
from engine.case.data import FatigueFactorRow
from engine.fatigue.cycle_counting import count_cycles, counted_history
from engine.fatigue.damage import miner_damage
from engine.fatigue.mean_stress import reversed_amplitude
from engine.fatigue.shaft_strength import shaft_strength
from engine.results.results import Results
from engine.results.tables import result_tables
from engine.run import run
from engine.start.start_fatigue import largest_damage, stress_over_endurance

SHAFT = "HP compressor shaft"


def factored(**more) -> Case:
    row = FatigueFactorRow(SHAFT, surface="machined", size="by diameter", reliability=0.9)
    return replace(sample_case("modified"), fatigue_factors=(row,), **more)


@pytest.fixture(scope="module")
def plain() -> Results:
    return run(sample_case("modified"))


@pytest.fixture(scope="module")
def goodman() -> Results:
    return run(factored(mean_stress="Goodman"))


def shaft_of(results: Results):
    assert results.starts is not None
    return next(s for s in results.starts.shafts if s.element == SHAFT)


def test_each_addition_damages_more(plain: Results, goodman: Results) -> None:
    lowered = shaft_of(run(factored()))
    before, after = shaft_of(plain), shaft_of(goodman)
    assert before.endurance > lowered.endurance == after.endurance
    assert before.damage < lowered.damage < after.damage
    assert after.damage_low <= after.damage <= after.damage_high


def test_damage_is_that_of_the_history(goodman: Results) -> None:
    """By hand from the turning points: Kf · 16 T/π d³, by Goodman, on the lowered line."""
    case, start = goodman.case, goodman.start
    assert start is not None
    index, element = next((i, e) for i, e in enumerate(case.elements) if e.element == SHAFT)
    place = np.flatnonzero(start.output_of_element >= 0).tolist().index(index)
    torque = start.turning_points[place][1]
    unit = (element.scf or 1.0) * 16.0 / (np.pi * (element.stress_diameter or 0.0) ** 3)
    cycles = count_cycles(counted_history(torque)).scaled(unit)
    uts = next(m.uts for m in case.materials if m.material == element.material)
    amplitude = cycles.amplitude / (1.0 - np.abs(cycles.mean) / (0.67 * uts))
    shaft = shaft_of(goodman)
    assert shaft.amplitudes == pytest.approx(amplitude, rel=1e-9)
    assert reversed_amplitude(cycles.amplitude, cycles.mean, 0.67 * uts) == pytest.approx(amplitude)
    assert largest_damage(case, element, [torque]) == pytest.approx(shaft.damage, rel=1e-12)
    ratio, counted = stress_over_endurance(case, start) or (0.0, False)
    assert counted
    assert ratio >= shaft.largest_amplitude / shaft.endurance
    from_line = miner_damage(amplitude, cycles.count, _line(goodman))
    assert from_line == pytest.approx(shaft.damage, rel=1e-9)


def _line(results: Results):
    element = next(e for e in results.case.elements if e.element == SHAFT)
    return shaft_strength(results.case, element).curve


def test_limits_and_their_safety_are_shown(plain: Results, goodman: Results) -> None:
    for results in (plain, goodman):
        shaft = shaft_of(results)
        row = next(r for r in result_tables(results)["FatigueLimits"] if r["element"] == SHAFT)
        assert row["safety_factor"] == row["endurance_limit"] / row["stress_amplitude"]
        assert row["endurance_limit"] == shaft.endurance
        factors = row["surface"] * row["size"] * row["reliability"]
        assert row["endurance_limit"] == pytest.approx(factors * row["endurance_of_data"])


def test_safety_factors_are_limits_over_values(plain: Results) -> None:
    tables, elements = result_tables(plain), {e.element: e for e in plain.case.elements}
    for row in tables["StartupPeaks"]:
        limit = elements[row["element"]].peak_torque_limit
        peak = max(row["maximum_torque"], -row["minimum_torque"])
        if row["safety_factor"] is not None and limit:
            assert row["safety_factor"] <= limit / peak * (1.0 + 1e-12)
    judged = [r for r in tables["SteadyState"] if r["allowable"]]
    assert judged
    for row in judged:
        expected = row["allowable"] / row["peak_to_peak_stress"]
        assert row["safety_factor"] == pytest.approx(expected, rel=1e-12)
