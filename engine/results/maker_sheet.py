"""Sheet to the makers: torques, speeds, reversals and cycles of each element beside the ratings that are offered.

Nothing is calculated twice: torques are those of the forced response, the start, its reversals and the events; what is
added are the reversals of elements that may reverse, the cycles above the rating, tooth forces and ratios.

Torques are at the element's own speed, of a mesh at its From side. A *service factor* multiplies the continuous torque
to the rating that is required. That is how API 671 and ISO 10441 for couplings and API 613 and AGMA 6011 for gears are
quoted; none of their texts was at hand, so that no factor of theirs is taken for granted: it is typed, or 1.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from engine.case.choices import ElementKind
from engine.case.data import ElementRow, MeshRow
from engine.model.excitation import operating_range, transmitted_torque
from engine.model.gears import line_of_action
from engine.results.results import Results
from engine.start.peaks import ElementPeak
from engine.start.reversals import ROUNDING, passages_below, passages_beyond
from engine.start.start_fatigue import is_counted


@dataclass(frozen=True)
class MakerRow:
    """One element as its maker must know it; None = not calculated, or not typed."""

    element: str  #: Element.
    speed: float | None  #: Highest speed of continuous operation, of the From side. [rad/s]
    speed_driven: float | None  #: Of the To side of a mesh. [rad/s]
    continuous_torque: float | None  #: Transmitted in continuous operation, its magnitude. [N m]
    service_factor: float  #: Required rating over continuous torque. [1]
    required_rating: float | None  #: Their product. [N m]
    offered_rating: float | None  #: Rated torque. [N m]
    offered_factor: float | None  #: Offered rating over continuous torque. [1]
    vibratory_torque: float | None  #: Largest in continuous operation, zero-to-peak. [N m]
    vibratory_limit: float | None  #: As typed. [N m]
    peak_torque: float | None  #: Largest magnitude in the start and in events. [N m]
    peak_torque_limit: float | None  #: As typed. [N m]
    reversing_torque: float | None  #: How far it falls below zero there; 0 = it does not. [N m]
    reversal_limit: float | None  #: As typed. [N m]
    reversals: int | None  #: Reversals in the start. [count]
    longest_reversal: float | None  #: Duration of the longest. [s]
    #: Passages in the start beyond the offered rating, where that is blank beyond the required one. [count]
    cycles_above_rated: int | None
    tooth_force: float | None  #: Normal to the flank, at the peak torque. [N]
    heat: float | None  #: Not calculated. [W]
    note: str | None  #: What the numbers alone do not say.
    #: Least of the limits typed over their torque, and of offered over required rating; None where one of them is
    #: not calculated, and without limits. [1]
    safety_factor: float | None


def maker_sheet(results: Results) -> tuple[MakerRow, ...]:
    """What the makers of couplings, gears and shafts must know of a run.

    Parameters
    ----------
    results : Results
        A run. [SI]

    Returns
    -------
    tuple of MakerRow
        One an element, in the order of Elements. [SI]
    """
    case = results.case
    transmitted = transmitted_torque(case, results.train)
    is_loaded = bool(np.any(transmitted.load != 0.0))
    return tuple(
        _row(results, index, abs(float(transmitted.element[index])) if is_loaded else None)
        for index in range(len(case.elements))
    )


def _row(results: Results, index: int, continuous: float | None) -> MakerRow:
    """One element."""
    case = results.case
    element = case.elements[index]
    name, factor, offered = (
        str(element.element),
        element.service_factor or 1.0,
        element.rated_torque,
    )
    required = None if continuous is None else factor * continuous
    unbounded, vibratory = _vibratory(results, name)
    peaks = dict(_peaks(results, name))
    missing = ", ".join(f"'{e.name}'" for e in results.events if e.response is None)
    where, peak = max(peaks.items(), key=lambda one: one[1].size, default=("", None))
    reversals, longest, beyond = _counts(results, index, offered or required or None)
    speed, driven = _speeds(results, element)
    row = MakerRow(
        element=name,
        speed=speed,
        speed_driven=driven,
        continuous_torque=continuous,
        service_factor=factor,
        required_rating=required,
        offered_rating=offered,
        offered_factor=offered / continuous if offered and continuous else None,
        vibratory_torque=vibratory,
        vibratory_limit=element.vibratory_limit,
        peak_torque=None if peak is None else peak.size,
        peak_torque_limit=element.peak_torque_limit,
        reversing_torque=max(map(_reversing, peaks.values()), default=None),
        reversal_limit=element.reversal_limit,
        reversals=reversals,
        longest_reversal=longest,
        cycles_above_rated=beyond,
        tooth_force=None if peak is None else _tooth_force(results, element, peak.size),
        heat=None,
        note="; ".join(
            sentence
            for sentence, applies in (
                (f"vibratory torque unbounded at {unbounded}", bool(unbounded)),
                (f"peak in '{where}'", bool(where)),
                (f"without event {missing}", bool(missing)),
                ("start not completed", not is_counted(results.start)),
                (f"reversals and cycles with {_phase(results)}", bool(_phase(results))),
            )
            if applies
        )
        or None,
        safety_factor=None,
    )
    return replace(row, safety_factor=_least_factor(row, is_counted(results.start) and not missing))


def _least_factor(row: MakerRow, are_peaks_whole: bool) -> float | None:
    """Least of all factors of an element; None unless every limit typed has its number."""
    peak, reversing = (
        value if are_peaks_whole else None for value in (row.peak_torque, row.reversing_torque)
    )
    pairs = (
        (row.offered_rating, row.required_rating),
        (row.vibratory_limit, row.vibratory_torque),
        (row.peak_torque_limit, peak),
        (row.reversal_limit, reversing),
    )
    typed = [(limit, value) for limit, value in pairs if limit]
    if any(value is None for _, value in typed):
        return None
    return min((limit / value for limit, value in typed if value), default=None)


def _phase(results: Results) -> str:
    """The phase of the start whose history is counted, where the peaks are the worst of many."""
    phase = None if results.start is None else results.start.phase
    return "" if phase is None else f"PulsationPhase {math.degrees(phase):.0f}°"


def _vibratory(results: Results, name: str) -> tuple[str, float | None]:
    """Where the response of an element is unbounded, and its largest torque; none where it is, or is not known."""
    rows = [row for row in results.steady.rows if row.element == name]
    unbounded = next((f"{r.frequency:.4g} Hz" for r in rows if r.torque is None), "")
    torques = [row.torque for row in rows if row.torque is not None]
    return unbounded, None if unbounded else max(torques, default=None)


def _peaks(results: Results, name: str) -> Iterator[tuple[str, ElementPeak]]:
    """Peaks of an element in the start, whose name is blank, and in each event that was calculated."""
    responses = [("", results.start), *((e.name, e.response) for e in results.events)]
    for event, response in responses:
        yield from ((event, p) for p in (response.peaks if response else ()) if p.element == name)


def _reversing(peak: ElementPeak) -> float:
    """How far below zero; rounding is none."""
    return -peak.minimum if peak.minimum < -ROUNDING * peak.size else 0.0


def _counts(
    results: Results, index: int, rating: float | None
) -> tuple[int | None, float | None, int | None]:
    """Reversals in the start, duration of the longest, and passages beyond a rating."""
    start = results.start
    turning = None if start is None else start.turning_of_element().get(index)
    if start is None or turning is None:
        return None, None, None
    beyond = None if rating is None else passages_beyond(turning[1], rating)
    name = results.case.elements[index].element
    known = next((r for r in results.reversals if r.element == name), None)
    if known is not None:
        return known.reversals, known.longest_reversal, beyond
    began, ended = passages_below(start, index, turning)
    return len(began), float(np.max(ended - began, initial=0.0)), beyond


def _speeds(results: Results, element: ElementRow) -> tuple[float | None, float | None]:
    """Highest speeds of the From side and, of a mesh, of the To side."""
    speeds, ratios = operating_range(results.case), results.case.speed_ratios
    if speeds is None:
        return None, None
    own = results.case.element_speed_ratios[element.element]
    driven = ratios.get(element.to) if element.kind == ElementKind.GEAR_MESH else None
    return speeds[1] * own, None if driven is None else speeds[1] * driven


def _tooth_force(results: Results, element: ElementRow, torque: float) -> float | None:
    """Force normal to the flank, F = T / (r cos α_t cos β_b), of a torque on the From side; None without a pitch radius."""
    if element.kind != ElementKind.GEAR_MESH:
        return None
    mesh = next((m for m in results.case.meshes if m.element == element.element), MeshRow())
    if not mesh.pitch_radius_drive:
        return None
    cos_transverse, stiffness_factor = line_of_action(mesh)
    return torque / (mesh.pitch_radius_drive * cos_transverse * math.sqrt(stiffness_factor))
