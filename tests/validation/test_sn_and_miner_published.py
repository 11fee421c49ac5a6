"""S-N interpolation and Miner sums against published and closed-form values.

W07  Code_Aster SZLZ100 and SZLZ101: Basquin and log-log table
W08  Haibach, Betriebsfestigkeit, 3rd ed. 2006, p. 271: elementary Miner
W09  the same, p. 292: modified Miner, slope 2k−1 below the knee
A10  free decay under a power law: geometric series
"""

import numpy as np
import pytest
from cases import load_case

from engine.case.data import MaterialRow, SNPointRow
from engine.fatigue.cycle_counting import CycleCount, count_cycles, paper_count
from engine.fatigue.damage import miner_damage, starts_from_damage
from engine.fatigue.sn_curve import SNCurve, sn_curve_for

MPA = 1e6


def curve_of(points, endurance, below):
    """An S-N line by the way the tables take; points as (cycles, Pa)."""
    material = MaterialRow(material="steel", endurance=endurance, below_endurance=below)
    rows = [SNPointRow(material="steel", cycles=N, stress=S) for N, S in points]
    return sn_curve_for(material, rows)


def power_law(cycles, stress, k, highest):
    """Two points of N = cycles (S/stress)^−k: at `highest` and at `stress`."""
    return [(cycles * (highest / stress) ** -k, highest), (cycles, stress)]


def test_w07_table():
    case = load_case("W07")
    curve = curve_of([(500, 690 * MPA), (1000, 540 * MPA)], None, None)
    cycle = count_cycles([600 * MPA, -500 * MPA, 600 * MPA])
    q = miner_damage(cycle.amplitude, cycle.count, curve)
    assert q == pytest.approx(case["published"]["table_damage"], rel=case["tolerance"]["rel"])


def test_w07_basquin():
    case = load_case("W07")
    A, beta = 1.001730939e-14, 4.065  # 1/N = A Sᵝ, S in MPa
    points = [(1.0 / (A * S**beta), S * MPA) for S in (900.0, 100.0)]
    q = miner_damage([500 * MPA], [1.0], curve_of(points, None, "none"))
    assert q == pytest.approx(case["published"]["basquin_damage"], rel=case["tolerance"]["rel"])


def test_w08_elementary_miner():
    case = load_case("W08")
    amplitude = np.array(case["input"]["amplitude_MPa"]) * MPA
    cycles = np.array(case["input"]["cycles"])
    curve = curve_of(power_law(2e6, 125 * MPA, 7, 350 * MPA), 125 * MPA, "same slope")
    life = cycles.sum() / miner_damage(amplitude, cycles, curve)
    assert life == pytest.approx(case["published"]["life_cycles"], rel=case["tolerance"]["rel"])
    recomputed = case["verification"]["recomputed"]
    starts = starts_from_damage(miner_damage(amplitude, cycles, curve))
    assert starts == pytest.approx(recomputed["repeats_of_collective"], rel=1e-12)


@pytest.mark.parametrize("peak", ["100", "150", "200", "300", "400", "600", "800"])
def test_w09_modified_miner(peak):
    case = load_case("W09")
    amplitude = np.array(case["input"]["relative_amplitude"]) * float(peak) * MPA
    cycles = np.array(case["input"]["cycles"])
    curve = curve_of(power_law(1e6, 100 * MPA, 4, 800 * MPA), 100 * MPA, "2k-1")
    life = cycles.sum() / miner_damage(amplitude, cycles, curve)
    published = case["published"]["life_cycles_by_peak"][peak]
    assert life == pytest.approx(published, rel=case["tolerance"]["rel"])
    recomputed = case["verification"]["recomputed"]["life_cycles_by_peak"][peak]
    assert life == pytest.approx(recomputed, rel=1e-12)


@pytest.fixture
def free_decay():
    """Reversals and S-N line of case A10, its closed forms beside it."""
    case = load_case("A10")
    a0, d = case["input"]["a0"], case["input"]["log_decrement"]
    m, K = case["input"]["m"], case["input"]["K"]
    j = np.arange(2400)
    reversals = (-1.0) ** j * a0 * np.exp(-0.5 * d * j)
    points = [(K * S**-m, S) for S in (400.0, 1.0)]
    curve = SNCurve(*np.array(points).T, endurance=1.0, below_endurance="same slope")
    return case["values"], reversals, curve


@pytest.mark.parametrize("count", [count_cycles, paper_count])
def test_a10_free_decay(free_decay, count):
    """ASTM half cycles; about zero the paper's count is the same."""
    values, reversals, curve = free_decay
    cycles = count(reversals)
    assert np.all(cycles.count == 0.5)
    q = miner_damage(cycles.amplitude, cycles.count, curve)
    assert q == pytest.approx(values["D"], rel=1e-12)
    assert starts_from_damage(q) == pytest.approx(values["allowable_events"], rel=1e-12)


def test_a10_the_reading_that_is_not_taken(free_decay):
    """A whole cycle of its own amplitude for each positive peak gives 13 % more."""
    values, reversals, curve = free_decay
    peaks = reversals[::2]
    whole = CycleCount(2.0 * peaks, 0.0 * peaks, np.ones_like(peaks))
    q = miner_damage(whole.amplitude, whole.count, curve)
    assert q == pytest.approx(values["D_full_cycle_convention"], rel=1e-12)
    assert q / values["D"] == pytest.approx(1.13, abs=0.005)
