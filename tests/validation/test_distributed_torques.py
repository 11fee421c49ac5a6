"""Torques of shafts with inertia of their own: against the continuum, and against many explicit pieces.

The reference types a shaft as stations and massless pieces. The outermost piece shows the torque of its
middle, so that the worst of all falls short of the end by a first-order term, which is extrapolated.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

from engine.case.case import Case
from engine.case.data import (
    ElementRow,
    StationRow,
)
from engine.model.build_train import build_train
from engine.model.modes import modes_of
from engine.operation.steady_state import harmonic_response
from engine.run import at_speed, run
from tests.distributed_trains import RHO, G, explicit, of_shafts, polar, steady_torques, train

# --- forced response against the continuum --------------------------------------------------------


def largest_torque(omega: float, J: tuple[float, float], d: float, length: float) -> float:
    """Largest |T(x)| of a free shaft with two discs for 1 N m at the first, by the wave equation."""
    beta, stiff = omega * math.sqrt(RHO / G), G * polar(d)
    direct, cross = stiff * beta / math.tan(beta * length), -stiff * beta / math.sin(beta * length)
    matrix = np.array([[direct - omega**2 * J[0], cross], [cross, direct - omega**2 * J[1]]])
    first, second = np.linalg.solve(matrix, [1.0, 0.0])
    x = np.linspace(0.0, length, 20_001)
    other = (second - first * math.cos(beta * length)) / math.sin(beta * length)
    slope = beta * (-first * np.sin(beta * x) + other * np.cos(beta * x))
    return float(np.max(np.abs(stiff * slope)))


@pytest.mark.parametrize("omega", [40.0, 260.0, 700.0])
def test_the_worst_section_of_a_shaft_converges_with_second_order(omega: float) -> None:
    """Its middle pieces alone fall short of an end that is the worst section by first order."""
    J, d, length = (5.0, 30.0), 0.2, 8.0
    case = Case(
        stations=(StationRow("A", None, J[0]), StationRow("B", None, J[1])),
        elements=(ElementRow("S", "shaft", "A", "B", None, d, None, length, G, RHO),),
    )
    exact = largest_torque(omega, J, d, length)
    errors = []
    for pieces in (16, 32, 64):
        train = build_train(case, {"S": pieces})
        found = harmonic_response(train, modes_of(train), np.array([omega]), np.array([1.0, 0.0]))
        errors.append(abs(float(np.abs(found.element_torque[0, 0])) / exact - 1.0))
    # an end shows it at each halving; a section between, where the pieces happen to lie, over both
    order = 0.5 * math.log2(errors[0] / errors[-1])
    assert 1.8 < order < 2.6
    assert errors[-1] < 2e-3


# --- starts against explicit pieces ---------------------------------------------------------------


def check(seed: int, pieces: int) -> tuple[list[float], list[bool]]:
    """True over stated error of each peak; whether each interval of starts holds the truth."""
    case = train(seed)
    results = run(case)
    assert results.start is not None
    assert results.starts is not None
    assert results.start.met_tolerance
    half, whole = (of_shafts(run(explicit(case, n))) for n in (pieces // 2, pieces))
    ratios, inside = [], []
    for p in results.start.peaks:
        truth = 2.0 * whole[0][p.element] - half[0][p.element]
        ratios.append(abs(p.size - truth) / p.error)
    for s in results.starts.shafts:
        truth = 2.0 * whole[1][s.element] - half[1][s.element]
        if s.starts_low is not None and math.isfinite(truth):
            inside.append(s.starts_low <= truth <= (s.starts_high or math.inf))
    return ratios, inside


@pytest.mark.first_ones(1)
@pytest.mark.parametrize("seed", range(3))
def test_peaks_and_starts_hold_against_explicit_pieces(seed: int) -> None:
    """Stated errors and intervals, and the tolerance that is said to be met."""
    ratios, inside = check(seed, 64)
    assert max(ratios) <= 1.0
    assert all(inside)


@pytest.mark.slow
@pytest.mark.parametrize(
    "seeds", [range(100, 108), pytest.param(range(108, 140), marks=pytest.mark.long)], ids=len
)
def test_stated_errors_hold_in_many_trains(seeds: range) -> None:
    found = [check(seed, 128) for seed in seeds]
    ratios = np.array([r for ratio, _ in found for r in ratio])
    inside = [i for _, flags in found for i in flags]
    assert len(ratios) > 2.5 * len(seeds)
    assert np.mean(ratios <= 1.0) >= 0.99
    assert np.mean(inside) >= 0.99


# --- forced response against explicit pieces ------------------------------------------------------


def check_responses(seed: int) -> list[float]:
    """True over stated error of each forced response; fewer pieces are no truth for errors below 0.1 %."""
    case = train(seed)
    half, whole = (steady_torques(at_speed(explicit(case, n))) for n in (96, 192))
    ratios = []
    for row in at_speed(case).steady.rows:
        key = row.element, row.excitation, row.mode
        if row.torque and row.error is not None and key in whole:
            truth = 2.0 * whole[key] - half[key]
            ratios.append(abs(row.torque / truth - 1.0) / row.error)
    return ratios


@pytest.mark.parametrize("seed", [201, 214])
def test_the_stated_error_of_a_forced_response_holds(seed: int) -> None:
    """The worst section of the second train lies between two pieces."""
    ratios = check_responses(seed)
    assert len(ratios) >= 10
    assert max(ratios) <= 1.0


@pytest.mark.slow
@pytest.mark.parametrize(
    "seeds", [range(210, 215), pytest.param(range(215, 230), marks=pytest.mark.long)], ids=len
)
def test_stated_errors_of_forced_responses_hold_in_many_trains(seeds: range) -> None:
    ratios = np.array([ratio for seed in seeds for ratio in check_responses(seed)])
    assert len(ratios) > 8 * len(seeds)
    assert max(ratios) <= 1.0
