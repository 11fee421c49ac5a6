"""Trains with distributed shafts, and the same with many explicit pieces: for tests and for their study."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from engine.case.case import Case
from engine.case.data import (
    ElementRow,
    LoadTorqueRow,
    MaterialRow,
    MotorTorqueRow,
    SNPointRow,
    StationRow,
)
from engine.results.results import AtSpeed, Results

G, RHO = 8e10, 7850.0


def polar(d: float) -> float:
    return math.pi * d**4 / 32.0


def train(seed: int, most: int = 3) -> Case:
    """A motor, one distributed shaft or up to `most`, couplings between them, and a load; S-N data on the shafts."""
    rng = np.random.default_rng(seed)
    count = int(rng.integers(1, most + 1))
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


def steady_torques(found: AtSpeed | Results) -> dict[tuple[str, str, int | None], float]:
    """Largest torque of each shaft, or of its pieces, under each excitation."""
    torques: dict[tuple[str, str, int | None], float] = {}
    for row in found.steady.rows:
        key = row.element.split("/")[0], row.excitation, row.mode
        torques[key] = max(torques.get(key, 0.0), row.torque or 0.0)
    return torques
