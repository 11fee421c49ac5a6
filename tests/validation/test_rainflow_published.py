"""Rainflow counts against published ones, cycle by cycle.

W01      ASTM E1049-85 (2017), 5.4.4, Figure 6 and its table
W02, W03 test data of github.com/iamlikeme/rainflow
W04      Code_Aster SZLZ102 (POSTDAM validation manual)
W05      Code_Aster SZLZ103 (POSTDAM), oscillation filter 0.9

W01 to W03 count the residue as half cycles, W04 and W05 repeat the history.
"""

import math
from collections import Counter

import numpy as np
import pytest
from cases import load_case

from engine.fatigue.cycle_counting import count_cycles, turning_points


def totals(cycles):
    """Range → count, ranges that are equal added up."""
    found = Counter()
    for size, count in zip(cycles.range.tolist(), cycles.count.tolist(), strict=True):
        found[size] += count
    return found


def as_pairs(cycles):
    """(maximum, minimum) of each whole cycle, as Code_Aster lists them."""
    assert np.all(cycles.count % 1.0 == 0.0)
    pairs = Counter()
    for size, mean, count in zip(cycles.range, cycles.mean, cycles.count, strict=True):
        pairs[float(mean + size / 2), float(mean - size / 2)] += int(count)
    return pairs


def without_small_oscillations(history, smallest):
    """Take out the smallest pair of reversals, again and again, while its range is below a limit."""
    points = turning_points(history).tolist()
    while len(points) > 3:
        inner = [abs(b - a) for a, b in zip(points[1:-2], points[2:-1], strict=True)]
        if min(inner) >= smallest:
            break
        at = inner.index(min(inner)) + 1
        del points[at : at + 2]
    return points


@pytest.mark.parametrize("case_id", ["W01", "W02"])
def test_range_counts_are_exact(case_id):
    case = load_case(case_id)
    assert totals(count_cycles(case["input"])) == dict(case["published"]["range_counts"])


def test_w01_cycle_by_cycle_with_means():
    case = load_case("W01")
    cycles = count_cycles(case["input"])
    published = [row[:3] for row in case["published"]["cycles_range_mean_count_i_j"]]
    assert np.column_stack([cycles.range, cycles.mean, cycles.count]).tolist() == published


def test_w03_two_sines():
    case = load_case("W03")
    history = [
        0.8 * math.sin(0.01 * math.pi * i) + 0.2 * math.sin(0.032 * math.pi * i)
        for i in range(1001)
    ]
    cycles = count_cycles(history)
    order = np.argsort(cycles.range)
    published = np.array(case["published"]["range_counts"])
    np.testing.assert_allclose(
        cycles.range[order], published[:, 0], rtol=0, atol=case["tolerance"]["abs"]
    )
    assert cycles.count[order].tolist() == published[:, 1].tolist()


def test_w04_repeated_history():
    case = load_case("W04")
    published = Counter((hi, lo) for hi, lo in case["published"]["cycles_max_min"])
    assert as_pairs(count_cycles(case["input"], "repeated")) == published


def test_w04_the_two_residue_rules_differ():
    case = load_case("W04")
    astm = dict(case["verification"]["recomputed"]["astm_counts"])
    assert totals(count_cycles(case["input"])) == astm


def test_w05_filtered_and_repeated():
    case = load_case("W05")
    points = without_small_oscillations(case["input"], case["filter_range"])
    assert points == case["verification"]["recomputed"]["filtered_reversals"]
    published = Counter((hi, lo) for hi, lo in case["published"]["cycles_max_min"])
    assert sum(published.values()) == 12
    assert as_pairs(count_cycles(points, "repeated")) == published
