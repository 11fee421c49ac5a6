"""Torques of shafts with inertia of their own: against the continuum, and against many explicit pieces.

The reference types a shaft as stations and massless pieces. The outermost piece shows the torque of its
middle, so that the worst of all falls short of the end by a first-order term, which is extrapolated.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from engine.case.case import Case
from engine.case.data import (
    ElementRow,
    LoadTorqueRow,
    MaterialRow,
    MotorTorqueRow,
    SNPointRow,
    StationRow,
)
from engine.model.build_train import build_train
from engine.model.modes import modes_of
from engine.operation.steady_state import harmonic_response
from engine.results.results import Results
from engine.run import at_speed, run

G, RHO = 8e10, 7850.0


def polar(d: float) -> float:
    return math.pi * d**4 / 32.0


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


def train(seed: int) -> Case:
    """A motor, one to three distributed shafts, couplings between them, and a load; S-N data on the shafts."""
    rng = np.random.default_rng(seed)
    count = int(rng.integers(1, 4))
    rated = float(rng.uniform(15e3, 40e3))
    diameters = rng.uniform(0.18, 0.26, count)
    lengths = rng.uniform(2.0, 7.0, count)
    names = ["Motor", *(f"H{i}" for i in range(2 * count - 1)), "Load"]
    inertias = [
        float(rng.uniform(60.0, 200.0)),
        *(float(x) for x in rng.uniform(0.5, 4.0, 2 * count - 1)),
    ]
    inertias.append(float(rng.uniform(100.0, 400.0)))
    elements = []
    for i in range(count):
        shaft = ElementRow(
            f"S{i}", "shaft", names[2 * i], names[2 * i + 1], None, float(diameters[i]), None,
            float(lengths[i]), G, RHO, stress_diameter=float(diameters[i]), scf=1.5, material="m",
        )  # fmt: skip
        k = float(rng.uniform(2e6, 8e6))
        elements += [shaft, ElementRow(f"C{i}", "coupling", names[2 * i + 1], names[2 * i + 2], k)]
    speeds = (0.0, 0.3, 0.6, 0.9, 0.95, 1.0)
    average, pulsating = (0.6, 0.65, 0.8, 0.95, 0.8, 0.0), (0.25, 0.25, 0.22, 0.2, 0.2, 0.2)
    return Case(
        line_frequency=60.0,
        poles=4,
        rated_torque=rated,
        damping_ratio=0.01,
        stations=tuple(StationRow(n, None, j) for n, j in zip(names, inertias, strict=True)),
        elements=tuple(elements),
        motor_torque=tuple(
            MotorTorqueRow("Motor", x, a * rated, p * rated)
            for x, a, p in zip(speeds, average, pulsating, strict=True)
        ),
        load_torque=(LoadTorqueRow("Load", 0.0, 0.06 * rated), LoadTorqueRow("Load", 1.0, 0.25 * rated)),
        materials=(MaterialRow("m", 8e8, None, 1e7),),
        sn_points=(SNPointRow("m", 1e3, 8e7), SNPointRow("m", 1e6, 2e7)),
        tolerance_peak=1e-3,
    )  # fmt: skip


def explicit(case: Case, pieces: int) -> Case:
    """Each shaft as so many massless pieces between stations; the train is lumped."""
    stations, elements = list(case.stations), []
    inertia = {s.station: s.inertia or 0.0 for s in stations}
    for e in case.elements:
        if e.density is None:
            elements.append(e)
            continue
        assert e.od is not None
        assert e.length is not None
        piece = RHO * polar(e.od) * e.length / pieces
        between = [f"{e.element} {i}" for i in range(1, pieces)]
        ends = [str(e.from_), *between, str(e.to)]
        for i in range(pieces):
            for end in ends[i : i + 2]:
                inertia[end] = inertia.get(end, 0.0) + 0.5 * piece
            row = replace(
                e, element=f"{e.element}/{i}", from_=ends[i], to=ends[i + 1], density=None, length=None,
                od=None, shear_modulus=None, stiffness=G * polar(e.od) / e.length * pieces,
            )  # fmt: skip
            elements.append(row)
    rows = tuple(StationRow(name, None, j) for name, j in inertia.items())
    changed = {"stations": rows, "elements": tuple(elements), "tolerance_peak": 1e-4}
    return Case(**(vars(case) | changed))


def of_shafts(results: Results) -> tuple[dict[str, float], dict[str, float]]:
    """Largest magnitude of torque, and fewest starts, of each shaft or its pieces."""
    assert results.start is not None
    assert results.starts is not None
    peaks: dict[str, float] = {}
    starts: dict[str, float] = {}
    for p in results.start.peaks:
        name = p.element.split("/")[0]
        peaks[name] = max(peaks.get(name, 0.0), p.size)
    for s in results.starts.shafts:
        name = s.element.split("/")[0]
        starts[name] = min(starts.get(name, math.inf), s.allowable_starts or math.inf)
    return peaks, starts


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


@pytest.mark.parametrize("seed", range(3))
def test_peaks_and_starts_hold_against_explicit_pieces(seed: int) -> None:
    """Stated errors and intervals, and the tolerance that is said to be met."""
    ratios, inside = check(seed, 64)
    assert max(ratios) <= 1.0
    assert all(inside)


@pytest.mark.slow
def test_stated_errors_hold_in_many_trains() -> None:
    found = [check(seed, 128) for seed in range(100, 140)]
    ratios = np.array([r for ratio, _ in found for r in ratio])
    inside = [i for _, flags in found for i in flags]
    assert len(ratios) > 100
    assert np.mean(ratios <= 1.0) >= 0.99
    assert np.mean(inside) >= 0.99


# --- forced response against explicit pieces ------------------------------------------------------


def responses(case: Case) -> dict[tuple[str, str, int | None], float]:
    """Largest torque of each shaft, or of its pieces, under each excitation."""
    found: dict[tuple[str, str, int | None], float] = {}
    for row in at_speed(case).steady.rows:
        key = row.element.split("/")[0], row.excitation, row.mode
        found[key] = max(found.get(key, 0.0), row.torque or 0.0)
    return found


def check_responses(seed: int) -> list[float]:
    """True over stated error of each forced response."""
    case = train(seed)
    half, whole = (responses(explicit(case, n)) for n in (48, 96))
    ratios = []
    for row in at_speed(case).steady.rows:
        key = row.element, row.excitation, row.mode
        if row.torque and row.error is not None and key in whole:
            truth = 2.0 * whole[key] - half[key]
            ratios.append(abs(row.torque / truth - 1.0) / row.error)
    return ratios


def test_the_stated_error_of_a_forced_response_holds() -> None:
    ratios = check_responses(201)
    assert len(ratios) >= 10
    assert max(ratios) <= 1.0


@pytest.mark.slow
def test_stated_errors_of_forced_responses_hold_in_many_trains() -> None:
    ratios = np.array([ratio for seed in range(210, 230) for ratio in check_responses(seed)])
    assert len(ratios) > 300
    assert np.mean(ratios <= 1.0) >= 0.99
