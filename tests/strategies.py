"""Random trains for Hypothesis, shared by every test that wants one.

`cases()` draws checked `Case`s: trees of up to 60 stations with shafts, couplings, elastic and
rigid gear meshes, stiffness over 12 decades, and whatever damping is asked for. The numbers come
from one drawn seed, so that a failure shrinks to few stations quickly.
"""

from __future__ import annotations

import numpy as np
from hypothesis import settings
from hypothesis import strategies as st

from engine.case.case import Case
from engine.case.data import GROUND, ElementRow, StationRow


def example_count(number: int) -> settings:
    """As many examples, or the share of them that a run without the slow tests tries."""
    share = settings().max_examples / 100
    return settings(max_examples=max(1, round(share * number)))


#: Stiffness of random elements reaches this many decades below 1e14 N m/rad.
DECADES = 12


@st.composite
def cases(
    draw,
    *,
    stations: tuple[int, int] = (2, 60),
    decades: float = DECADES,
    gears: bool = True,
    rigid: bool = True,
    grounded: bool | None = False,
    damping_ratio: float | None = None,
    dampers: bool = False,
    loss_factors: bool = False,
) -> Case:
    """A random train.

    `decades` is the span of the stiffnesses, at the upper end of 1e14 N m/rad; `grounded` None
    means either; `dampers` puts some across elements and to ground, `loss_factors` some in
    elements.
    """
    n = draw(st.integers(*stations), label="stations")
    seed = draw(st.integers(0, 2**32 - 1), label="seed")
    if grounded is None:
        grounded = draw(st.booleans(), label="grounded")
    rng = np.random.default_rng(seed)
    ratio = np.ones(n)
    inertia = 10.0 ** rng.uniform(-2.0, 3.0, n)
    elements = []
    for i in range(1, n):
        parent = i - 1 if rng.random() < 0.8 else int(rng.integers(max(0, i - 4), i))
        mesh = gears and rng.random() < 0.25
        ratio[i] = ratio[parent] * (10.0 ** rng.uniform(-0.7, 0.7) if mesh else 1.0)
        k = 10.0 ** rng.uniform(14.0 - decades, 14.0)
        is_rigid = mesh and rigid and rng.random() < 0.5
        ends = (f"S{parent}", f"S{i}") if rng.random() < 0.8 else (f"S{i}", f"S{parent}")
        elements.append(
            ElementRow(
                f"E{i}",
                "gear mesh" if mesh else str(rng.choice(["shaft", "coupling"])),
                *ends,
                None if is_rigid else float(k),
                damping=_some(rng, dampers and not is_rigid, k * 10.0 ** rng.uniform(-6, -3)),
                loss_factor=_some(rng, loss_factors and not is_rigid, rng.uniform(0.005, 0.1)),
            )
        )
    if grounded:
        at = f"S{int(rng.integers(n))}"
        k = 10.0 ** rng.uniform(14.0 - decades, 14.0)
        elements.append(ElementRow("Foundation", "spring to ground", at, GROUND, float(k)))
    rows = [
        StationRow(
            f"S{i}",
            None,
            float(inertia[i]),
            float(ratio[i]),
            damping=_some(rng, dampers, 10.0 ** rng.uniform(-2, 2)),
        )
        for i in range(n)
    ]
    return Case(
        stations=tuple(rows),
        elements=tuple(elements),
        damping_ratio=damping_ratio,
        line_frequency=60.0,
        poles=4,
    )


def _some(rng: np.random.Generator, wanted: bool, value: float) -> float | None:
    """The value in three of ten cases where it is wanted, else blank."""
    return float(value) if wanted and rng.random() < 0.3 else None
