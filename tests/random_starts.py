"""Random starts: trains with motors and loads whose first modes the pulsation crosses."""

from __future__ import annotations

import math

import numpy as np

from engine.case.case import Case
from engine.case.data import ElementRow, LoadTorqueRow, MotorTorqueRow, StationRow
from engine.model.build_train import build_train
from engine.model.modes import modes_of

SPEEDS = (0.0, 0.2, 0.4, 0.6, 0.8, 0.9, 0.96, 1.0)


def random_start(seed: int) -> Case:
    """A start of one to three seconds of 2 to 9 stations, in any order, geared or not, damped or not.

    Stiffness is drawn over three decades and then scaled so that the lowest mode lies between 8
    and 130 Hz; a link in ten is made a thousand times stiffer still.
    """
    rng = np.random.default_rng(seed)
    n = int(rng.integers(2, 10))
    ratio, inertia = np.ones(n), 10.0 ** rng.uniform(-1.0, 2.0, n)
    elements = []
    for i in range(1, n):
        parent = i - 1 if rng.random() < 0.75 else int(rng.integers(0, i))
        mesh = rng.random() < 0.3
        ratio[i] = ratio[parent] * (rng.uniform(0.3, 4.0) if mesh else 1.0)
        stiff = 1e3 if rng.random() < 0.1 else 1.0
        elements.append(
            ElementRow(
                f"E{i}",
                "gear mesh" if mesh else "shaft",
                f"S{parent}",
                f"S{i}",
                None if mesh and rng.random() < 0.5 else float(stiff * 10 ** rng.uniform(4.5, 7.5)),
            )
        )
    inertia /= ratio**2
    at = int(rng.integers(n))
    ratio /= ratio[at]  # speeds are stated against the motor's
    # a rotor is heavy: with a light one the rising torque curve would drive its own vibration
    others = float(np.sum(inertia * ratio**2)) - inertia[at]
    inertia[at] = others * float(rng.uniform(0.4, 2.5))
    names = [f"S{i}" for i in range(n)]
    case = Case(
        stations=tuple(
            StationRow(name, None, float(j), float(r))
            for name, j, r in zip(names, inertia, ratio, strict=True)
        ),
        elements=tuple(elements),
        line_frequency=float(rng.choice([50.0, 60.0])),
        poles=int(rng.choice([2, 4, 6, 12])),
        damping_ratio=None if rng.random() < 0.1 else float(10.0 ** rng.uniform(-2.6, -1.5)),
        pulsation_phase=float(rng.uniform(-math.pi, math.pi)),
        rated_torque=1000.0,
        end_speed=None,
    )
    synchronous = case.ratings.synchronous_speed
    assert synchronous is not None
    total = float(np.sum(inertia * ratio**2))
    rated = total * synchronous / float(rng.uniform(1.0, 3.0))
    case = _tuned(case, float(rng.uniform(8.0, 130.0)))
    average = rated * np.concatenate([rng.uniform(0.6, 1.5, len(SPEEDS) - 2), [0.7, 0.0]])
    pulsating = rated * rng.uniform(0.05, 0.8, len(SPEEDS))
    loads = rng.permutation(n)[: int(rng.integers(1, 3))]
    load = rated * np.sort(rng.uniform(0.0, 0.3, len(SPEEDS))) / len(loads)
    changed = {f: getattr(case, f) for f in case.__dataclass_fields__} | {
        "rated_torque": rated,
        "motor_torque": tuple(
            MotorTorqueRow(names[at], x, float(a), float(b))
            for x, a, b in zip(SPEEDS, average, pulsating, strict=True)
        ),
        "load_torque": tuple(
            LoadTorqueRow(names[k], x, float(y / ratio[k]))
            for k in loads
            for x, y in zip(SPEEDS, load, strict=True)
        ),
    }
    return Case(**changed)


def _tuned(case: Case, frequency: float) -> Case:
    """All stiffnesses scaled so that the lowest elastic mode is at `frequency` [Hz]."""
    elastic = modes_of(build_train(case)).elastic_frequency
    if not len(elastic):
        return case
    scale = (frequency / float(elastic[0])) ** 2
    elements = tuple(
        ElementRow(e.element, e.kind, e.from_, e.to, scale * e.stiffness if e.stiffness else None)
        for e in case.elements
    )
    return Case(**{f: getattr(case, f) for f in case.__dataclass_fields__} | {"elements": elements})
