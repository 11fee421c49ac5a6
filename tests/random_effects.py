"""Random starts with what effects need: bearings, dampers, a shock, clearances, a judged shaft."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from engine.case.case import Case
from engine.case.data import (
    ElementRow,
    MaterialRow,
    MeshRow,
    MotorDataRow,
    SNPointRow,
    StationRow,
)
from engine.model.build_train import build_train
from engine.model.modes import modes_of
from tests.random_starts import random_start

#: An S-N line with an exponent near 9.
POINTS = ((1e3, 3.0e8), (1e4, 2.3e8), (1e5, 1.8e8), (1e6, 1.4e8))
ENDURANCE = 1.4e8


def with_dampers(case: Case, seed: int, strength: float) -> Case:
    """Dampers across half of the elastic elements and some stations.

    `strength` is about the loss of a damper over its spring at 2 × line frequency.
    """
    rng = np.random.default_rng(seed + 1_000_000)
    omega = 4.0 * np.pi * float(case.line_frequency or 60.0)

    def damped(e: ElementRow) -> ElementRow:
        if not e.stiffness or rng.random() < 0.5:
            return e
        return replace(e, damping=float(e.stiffness * strength * rng.uniform(0.2, 1.0) / omega))

    def held(s: StationRow) -> StationRow:
        if rng.random() < 0.7:
            return s
        assert s.inertia is not None
        return replace(s, damping=float(0.1 * strength * s.inertia * rng.uniform(0.1, 1.0)))

    return replace(
        case,
        elements=tuple(damped(e) for e in case.elements),
        stations=tuple(held(s) for s in case.stations),
    )


def with_bearings(case: Case, seed: int, softness: float) -> Case | None:
    """Every gear on bearings; None if the case has no mesh.

    `softness` is about the compliance of a bearing over that of its mesh.
    """
    rng = np.random.default_rng(seed + 2_000_000)
    ratio = {s.station: s.speed_ratio or 1.0 for s in case.stations}
    inertia = {s.station: s.inertia or 0.0 for s in case.stations}
    body: dict[str | None, tuple[float, float, float]] = {}
    elements, rows = [], []
    for e in case.elements:
        if e.kind != "gear mesh":
            elements.append(e)
            continue
        stiffness = e.stiffness or 1e7
        radius = float(rng.uniform(0.1, 0.4))
        other = radius * ratio[e.from_] / ratio[e.to]
        along = stiffness / radius**2
        for name, r in ((e.from_, radius), (e.to, other)):
            if name not in body:
                k = float(along / softness * rng.uniform(0.5, 2.0))
                mass = float(2.0 * inertia[name] / r**2)
                body[name] = (mass, k, float(0.05 * np.sqrt(k * mass)))
        (m1, k1, c1), (m2, k2, c2) = body[e.from_], body[e.to]
        elements.append(replace(e, stiffness=stiffness))
        rows.append(
            MeshRow(
                e.element, None, radius, other, math.radians(20.0), 0.0, float(rng.uniform(-3.0, 3.0)),
                mass_drive=m1, mass_driven=m2,
                bearing_stiffness_drive=k1, bearing_stiffness_driven=k2,
                bearing_damping_drive=c1, bearing_damping_driven=c2,
            )
        )  # fmt: skip
    if not rows:
        return None
    return replace(case, elements=tuple(elements), meshes=tuple(rows))


def with_clearances(case: Case, seed: int) -> Case | None:
    """Half of the elastic meshes and shafts get a clearance; None if none does."""
    rng = np.random.default_rng(seed + 3_000_000)
    given = {m.element: m for m in case.meshes}
    elements, rows = [], []
    for e in case.elements:
        if not e.stiffness or rng.random() < 0.5:
            elements.append(e)
            continue
        gap = float(10.0 ** rng.uniform(-5.0, -2.5))
        if e.kind == "gear mesh":
            elements.append(e)
            ratio = {s.station: s.speed_ratio or 1.0 for s in case.stations}
            plain = MeshRow(
                e.element, None, 0.2, 0.2 * ratio[e.from_] / ratio[e.to], math.radians(20.0)
            )
            rows.append(replace(given.pop(e.element, plain), backlash=0.2 * gap))
        else:
            elements.append(replace(e, kind="coupling"))
            rows.append(MeshRow(e.element, angular_backlash=gap))
    if not rows:
        return None
    return replace(case, elements=tuple(elements), meshes=(*given.values(), *rows))


def with_shock(case: Case, seed: int, share: float) -> Case:
    """A transient at breaker closing of `share` × the largest average torque."""
    rng = np.random.default_rng(seed + 4_000_000)
    largest = max(float(p.average or 0.0) for p in case.motor_torque)
    return replace(
        case,
        shock_amplitude=share * largest,
        shock_time_constant=float(10.0 ** rng.uniform(-2.0, -0.5)),
    )


def with_judged_shafts(case: Case, seed: int, level: float) -> Case:
    """Every shaft gets a diameter such that rated torque stresses it to about `level` × endurance."""
    rng = np.random.default_rng(seed + 5_000_000)
    ratio = {s.station: s.speed_ratio or 1.0 for s in case.stations}
    rated = float(case.rated_torque or 1000.0)

    def judged(e: ElementRow) -> ElementRow:
        if e.kind == "gear mesh":
            return e
        torque = rated / ratio[e.from_]
        wanted = level * ENDURANCE * float(rng.uniform(0.5, 1.5))
        diameter = (16.0 * torque / (np.pi * wanted)) ** (1.0 / 3.0)
        return replace(e, stress_diameter=float(diameter), material="steel", scf=1.2)

    return replace(
        case,
        elements=tuple(judged(e) for e in case.elements),
        materials=(MaterialRow("steel", 7e8, 5e8, ENDURANCE, "torsion"),),
        sn_points=tuple(SNPointRow("steel", n, s) for n, s in POINTS),
    )


def elastic_meshes(seed: int) -> Case:
    """A random start whose meshes are all elastic, and whose first mode is where it was."""
    case = random_start(seed)
    elements = tuple(
        replace(e, stiffness=e.stiffness or 1e8) if e.kind == "gear mesh" else e
        for e in case.elements
    )
    assert len(modes_of(build_train(replace(case, elements=elements))).omega) > 1
    return replace(case, elements=elements)


def with_motor_data(case: Case, seed: int) -> Case:
    """The same train with the data sheet of a salient motor in place of the torque curve of its first motor."""
    rng = np.random.default_rng(seed + 7_000_000)
    station = case.motor_torque[0].station
    rows = [r for r in case.motor_torque if r.station == station]
    largest = max(r.average or 0.0 for r in rows)
    xd = float(rng.uniform(1.0, 2.0))
    subtransient = float(rng.uniform(0.15, 0.25))
    synchronous = case.ratings.synchronous_speed
    assert synchronous is not None
    ratio = case.speed_ratios[station]
    sheet = MotorDataRow(
        station,
        None,
        largest * synchronous * ratio * float(rng.uniform(0.8, 1.2)),
        xd=xd,
        xq=xd * float(rng.uniform(0.55, 0.95)),
        xd_transient=subtransient + float(rng.uniform(0.05, 0.2)),
        xd_subtransient=subtransient,
        xq_subtransient=subtransient * float(rng.uniform(1.0, 1.4)),
        xl=float(rng.uniform(0.07, 0.12)),
        td_0_transient=float(rng.uniform(1.5, 5.0)),
        td_0_subtransient=float(rng.uniform(0.02, 0.06)),
        tq_0_subtransient=float(rng.uniform(0.05, 0.2)),
        ta=float(rng.uniform(0.02, 0.1)),
        discharge_resistance=float(rng.uniform(4.0, 15.0)),
    )
    others = tuple(r for r in case.motor_torque if r.station != station)
    return replace(case, motor_torque=others, motor_data=(sheet,))
