"""Our answers to the hard cases, with default settings, and the truth beside them."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from engine.model.modal_analysis import analyse
from engine.run import PlannedStart, planned_start
from engine.start.event_results import ContactRecord
from engine.start.start import Start
from tests.hard_cases.corpus import ClearanceCase, FrequencyCase, StartCase
from tests.hard_cases.reference import Answer, integrate

__all__ = [
    "Comparison", "clearance_run", "clearance_truth", "compared", "default_start", "frequencies",
    "start_truth",
]  # fmt: skip

Floats = NDArray[np.float64]


def frequencies(hard: FrequencyCase) -> Floats:
    """All natural frequencies, the rigid one first. [rad/s]"""
    return analyse(hard.case()).reported.modes.omega


def default_start(hard: StartCase) -> PlannedStart:
    """The start as the plan wants it."""
    return planned_start(hard.case, analyse(hard.case))


def start_truth(
    hard: StartCase, end: float, *, coarser: float = 1.0, sample: float = 0.0
) -> Answer:
    """The reference to the end of our start, its outputs in the order of the elements."""
    truth = hard.truth
    found = integrate(
        truth.case,
        end,
        coarser * truth.step,
        links=truth.links,
        breaks=truth.breaks,
        sample=sample,
    )
    chosen = list(truth.outputs or range(len(hard.case.elements)))
    elements = len(truth.case.elements)
    return replace(
        found,
        maximum=found.maximum[chosen],
        minimum=found.minimum[chosen],
        # a rigid link has no twist, so that its damper has no torque
        tooth_maximum=np.append(found.tooth_maximum, found.maximum[elements:])[chosen],
        tooth_minimum=np.append(found.tooth_minimum, found.minimum[elements:])[chosen],
        torque=found.torque[chosen] if sample else found.torque,
    )


@dataclass(frozen=True, eq=False)
class Comparison:
    """Errors of the extremes, by element, over the larger magnitude of the true ones. [1]"""

    error: Floats
    reported: Floats


def compared(start: Start, maximum: Floats, minimum: Floats) -> Comparison:
    """Our peaks against true ones."""
    ours = np.array([[p.maximum, p.minimum, p.error] for p in start.peaks])
    size = np.maximum(np.abs(maximum), np.abs(minimum))
    off = np.maximum(np.abs(ours[:, 0] - maximum), np.abs(ours[:, 1] - minimum))
    return Comparison(off / size, ours[:, 2] / size)


def clearance_run(hard: ClearanceCase) -> tuple[Start, dict[str, ContactRecord]]:
    """Our start with its clearances, over the stretch that is compared, and the contacts."""
    start = planned_start(replace(hard.case, maximum_time=hard.end), analyse(hard.case)).start
    return start, {c.element: c for c in start.contacts}


def clearance_truth(hard: ClearanceCase, *, coarser: float = 1.0) -> Answer:
    """The reference over the same stretch; extremes of contacts are of the whole tooth force."""
    found = integrate(hard.case, hard.end, coarser * hard.step, clearances=hard.clearances)
    contact = np.array([e.element in hard.clearances for e in hard.case.elements])
    return replace(
        found,
        maximum=np.where(contact, found.tooth_maximum, found.maximum),
        minimum=np.where(contact, found.tooth_minimum, found.minimum),
    )
