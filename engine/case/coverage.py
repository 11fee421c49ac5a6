"""Which elements a check can judge: those that the train calls for, and those without a limit for it.

Shafts are judged by stress, couplings and meshes by the torques that their makers allow; any element
may have both. A spring to ground is no part that turns, and is judged where it has a limit only.
"""

from __future__ import annotations

from collections.abc import Sequence

from engine.case.choices import ElementKind
from engine.case.data import CaseData, ElementRow

#: Elements that are named one by one; of more the rest is counted. [count]
NAMED = 4


def shafts(case: CaseData) -> list[ElementRow]:
    """Elements that a stress is the measure of."""
    return [e for e in case.elements if e.kind == ElementKind.SHAFT]


def links(case: CaseData) -> list[ElementRow]:
    """Elements that makers state torques for: couplings and gear meshes."""
    return [e for e in case.elements if e.kind in (ElementKind.COUPLING, ElementKind.GEAR_MESH)]


def without_vibratory_limit(case: CaseData, elements: Sequence[ElementRow]) -> list[str]:
    """Those without UTS and stress diameter and without Vibratory limit: continuous operation."""
    strong = {m.material for m in case.materials if m.uts}
    return [
        str(e.element)
        for e in elements
        if not e.vibratory_limit and not (e.stress_diameter and e.material in strong)
    ]


def without_peak_limit(case: CaseData) -> list[str]:
    """Couplings and meshes without Peak torque limit."""
    return [str(e.element) for e in links(case) if not e.peak_torque_limit]


def without_yield(case: CaseData) -> list[str]:
    """Shafts without Yield and stress diameter and without Peak torque limit."""
    strong = {m.material for m in case.materials if m.yield_}
    return [
        str(e.element)
        for e in shafts(case)
        if not e.peak_torque_limit and not (e.stress_diameter and e.material in strong)
    ]


def without_sn_points(case: CaseData) -> list[str]:
    """Shafts without S-N points or stress diameter."""
    known = {p.material for p in case.sn_points}
    return [str(e.element) for e in shafts(case) if not (e.stress_diameter and e.material in known)]


def calls_for_start(case: CaseData) -> bool:
    """Whether a start is to be judged: torques are given, or the train has a synchronous motor."""
    is_synchronous = case.ratings.line_frequency and case.ratings.synchronous_speed
    return bool(case.motor_stations or case.torque_time_from_rest or is_synchronous)


def listed(names: Sequence[str]) -> str:
    """Names one by one, of many the first with the number of the others."""
    more = len(names) - NAMED
    return "; ".join(names[:NAMED]) + (f"; and {more} more" if more > 0 else "")
