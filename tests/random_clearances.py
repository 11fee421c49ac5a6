"""Random trains with clearances: given a push, and started by their motors."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from engine.case.case import Case
from engine.case.data import CaseData, ElementRow, MeshRow, StationRow
from engine.case.effect import StartEffects
from tests.random_effects import elastic_meshes, with_bearings

#: Frequencies of the links lie about here. [rad/s]
FREQUENCY = 200.0


@dataclass(frozen=True, eq=False)
class Pushed:
    """A train and the speeds its stations are given."""

    case: CaseData
    speed: np.ndarray


def pushed_train(
    seed: int,
    clearances: int,
    *,
    damped: bool = True,
    bearings: bool = False,
    gap: float | None = None,
    grounded: bool = False,
) -> Pushed:
    """A chain or tree of 3 to 6 stations, some links meshes, some with a gap, all links elastic.

    Gaps are about as wide as the links are twisted by the push, unless `gap` is given [rad].
    """
    rng = np.random.default_rng(seed)
    n = int(rng.integers(clearances + 1, 6)) + 1
    ratio, inertia = np.ones(n), 10.0 ** rng.uniform(-0.7, 0.7, n)
    elements: list[ElementRow] = []
    meshes: list[MeshRow] = []
    parting = set(rng.permutation(np.arange(1, n))[:clearances].tolist())
    on_bearings: dict[str, tuple[float, float, float]] = {}
    for i in range(1, n):
        parent = i - 1 if rng.random() < 0.7 else int(rng.integers(0, i))
        mesh = bool(rng.random() < 0.5) or (bearings and i == 1)
        ratio[i] = ratio[parent] * (float(rng.uniform(0.4, 2.5)) if mesh else 1.0)
        inertia[i] /= ratio[i] ** 2
        ends = (parent, i) if rng.random() < 0.7 else (i, parent)
        names = tuple(f"S{x}" for x in ends)
        k = FREQUENCY**2 * float(rng.uniform(0.3, 3.0)) / ratio[ends[0]] ** 2
        c = float(rng.uniform(0.02, 0.3)) * k / FREQUENCY if damped else None
        size = gap if gap is not None else float(10.0 ** rng.uniform(-3.0, -1.5))
        size *= ratio[ends[0]]
        kind = "gear mesh" if mesh else "coupling"
        elements.append(ElementRow(f"E{i}", kind, *names, k, damping=c))
        if not mesh:
            if i in parting:
                meshes.append(MeshRow(f"E{i}", angular_backlash=size))
            continue
        r1 = float(rng.uniform(0.1, 0.3))
        row = MeshRow(
            f"E{i}", None, r1, r1 * ratio[ends[0]] / ratio[ends[1]],
            float(rng.uniform(0.2, 0.5)), float(rng.uniform(-0.5, 0.5)),
            float(rng.uniform(-3.0, 3.0)), backlash=size * r1 if i in parting else None,
        )  # fmt: skip
        if bearings:
            for name, place in zip(names, ends, strict=True):
                if name not in on_bearings:
                    along = k * ratio[ends[0]] ** 2 / (r1 * ratio[ends[0]]) ** 2
                    mass = float(rng.uniform(0.3, 3.0)) * inertia[place] / r1**2
                    held = along * float(rng.uniform(0.3, 3.0))
                    loss = float(rng.uniform(0.0, 0.1)) * math.sqrt(held * mass)
                    on_bearings[name] = (mass, held, loss if damped else 0.0)
            (m1, k1, c1), (m2, k2, c2) = on_bearings[names[0]], on_bearings[names[1]]
            row = replace(
                row, mass_drive=m1, mass_driven=m2, bearing_stiffness_drive=k1,
                bearing_stiffness_driven=k2, bearing_damping_drive=c1, bearing_damping_driven=c2,
            )  # fmt: skip
        meshes.append(row)
    if grounded:
        k = FREQUENCY**2 / ratio[n - 1] ** 2
        elements.append(ElementRow("Stop", "spring to ground", f"S{n - 1}", "ground", k))
        meshes.append(MeshRow("Stop", angular_backlash=0.02 * ratio[n - 1]))
    case = CaseData(
        stations=tuple(
            StationRow(f"S{i}", None, float(j), float(r))
            for i, (j, r) in enumerate(zip(inertia, ratio, strict=True))
        ),
        elements=tuple(elements),
        meshes=tuple(meshes),
    )
    return Pushed(case, rng.normal(0.0, 1.0, n) * ratio)


def start_with_clearances(
    seed: int, *, bearings: bool = False, end: float = 0.6, share: float = 0.5
) -> tuple[Case, StartEffects]:
    """A random start whose teeth part, all its damping that of dampers between its parts.

    Nothing of it needs a convention of modal damping: another integrator can follow it exactly.
    About `share` of its elements have a clearance.
    """
    rng = np.random.default_rng(seed + 7_000_000)
    case = elastic_meshes(seed)
    if bearings:
        case = with_bearings(case, seed, 0.5) or case
    case = replace(case, damping_ratio=None, mode_damping=(), maximum_time=end, tolerance_peak=1e-3)
    ratio = {s.station: s.speed_ratio or 1.0 for s in case.stations}
    given = {m.element: m for m in case.meshes}
    inertia = {s.station: float(s.inertia or 0.0) for s in case.stations}
    elements, meshes, parting = [], [], []
    for e in case.elements:
        assert e.stiffness is not None
        ends = 1.0 / inertia[e.from_] + (ratio[e.from_] / ratio[e.to]) ** 2 / inertia[e.to]
        share_of_critical = float(10.0 ** rng.uniform(-2.0, -1.0))
        damper = 2.0 * share_of_critical * math.sqrt(e.stiffness / ends)
        kind, row = e.kind, given.get(e.element)
        parts = rng.random() < share or not parting
        if kind == "gear mesh" and (row is not None or parts):
            row = row or MeshRow(
                e.element, None, 0.2, 0.2 * ratio[e.from_] / ratio[e.to],
                float(rng.uniform(0.2, 0.5)), float(rng.uniform(-0.5, 0.5)),
                float(rng.uniform(-3.0, 3.0)),
            )  # fmt: skip
        gap = 10.0 ** rng.uniform(-4.0, -2.5)
        if parts:
            parting.append(str(e.element))
            if kind == "gear mesh":
                assert row is not None
                row = replace(row, backlash=float(gap * row.pitch_radius_drive))
            else:
                kind, row = "coupling", MeshRow(e.element, angular_backlash=float(gap))
        if row is not None:
            meshes.append(row)
        elements.append(replace(e, kind=kind, damping=damper))
    case = replace(case, elements=tuple(elements), meshes=tuple(meshes))
    return case, StartEffects(clearances=tuple(parting), coupled_damping=True)
