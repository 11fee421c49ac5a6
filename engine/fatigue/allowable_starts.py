"""Fatigue of the judged shafts in one start: damage, permitted starts, and what a reader must know.

SI: torque in N m, stress in Pa, diameters in m. A stress amplitude is half a range; the mean
stress is ignored unless the strength of the shaft has an ultimate strength for Goodman. Torques
are actual, at the shaft's own speed.

"The paper" is Szenasi and von Nimitz, Transient analyses of synchronous motor trains (1978):
section "Stress criterion" and Figure 3, q = Σ nᵢ/Nᵢ and 1/q starts.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import ArrayLike

from engine.arrays import Floats
from engine.case.choices import RainflowResidue
from engine.case.data import ElementRow, MaterialRow
from engine.fatigue.cycle_counting import (
    CycleCount,
    count_cycles,
    counted_history,
    paper_count,
)
from engine.fatigue.damage import damage_interval, miner_damage, needs_counting, starts_from_damage
from engine.fatigue.mean_stress import reversed_amplitude
from engine.fatigue.shaft_strength import ShaftStrength
from engine.fatigue.sn_curve import SNCurve
from engine.fatigue.stress import SHEAR_YIELD_RATIO, in_megapascals, stress_of_unit_torque


@dataclass(frozen=True)
class ShaftNote:
    """What a reader must know of one shaft; of several shafts with one cause the worst is named."""

    cause: str  #: What they have in common. [word]
    size: float  #: The worst shaft has the largest. [1]
    words: str  #: The sentence after the name of the shaft.


@dataclass(frozen=True, eq=False)
class ShaftFatigue:
    """What one start does to one shaft. None for a number of starts means unlimited."""

    element: str  #: Row of `Elements`.
    damage: float  #: Miner sum of one start, rainflow count. [1]
    damage_low: float  #: The same at the ends of the error of the history. [1]
    damage_high: float  #: Likewise. [1]
    allowable_starts: float | None  #: 1/damage. [1]
    unlimited: bool  #: No damage.
    starts_low: float | None  #: Interval of the allowable starts from the error of the history. [1]
    starts_high: float | None  #: Likewise. [1]
    paper_damage: float  #: Miner sum of one start, the paper's count. [1]
    paper_starts: float | None  #: 1/paper_damage. [1]
    cycles: CycleCount  #: Rainflow cycles of local stress, with Kf; empty when not counted. [Pa]
    counted: bool  #: False when `largest_amplitude` alone settled it.
    #: Half of maximum minus minimum local stress, rest included, with Kf; with a mean stress, reversed. [Pa]
    largest_amplitude: float
    endurance: float  #: Endurance limit in torsion it is compared with. [Pa]
    peak_nominal_stress: float  #: Largest absolute nominal stress, without SCF. [Pa]
    #: Cycles a start above the first S-N point, where the line is extended. [1]
    above_first_point: float
    above_shear_yield: bool | None  #: Nominal peak above Yield/2; None when Yield is blank.
    curve_notes: tuple[str, ...]  #: What was assumed of its S-N line.
    notes: tuple[ShaftNote, ...]  #: What a reader must know.
    #: Bound on the relative change of the starts by effects left out, part of the interval; None = no bound
    #: is known, and then the interval has no ends. [1]
    left_out: float | None = 0.0
    #: Phase of the pulsation with the largest damage; None: one phase was asked for. [rad]
    phase: float | None = None
    #: Amplitude of each cycle that is compared with the S-N line: with a mean stress, reversed. [Pa] Shape (n_cycles,).
    amplitudes: Floats = field(default_factory=lambda: np.zeros(0))
    #: A cycle's mean reaches the ultimate strength, where Goodman's line ends.
    above_ultimate: bool = False

    @property
    def starts_error(self) -> float | None:
        """Larger side of the interval over the allowable starts; None when it is unlimited. [1]"""
        return _starts_error(self.allowable_starts, self.starts_low, self.starts_high)


def shaft_fatigue(
    element: ElementRow,
    torque_turning_points: ArrayLike,
    judged_with: SNCurve | ShaftStrength,
    material: MaterialRow,
    residue: str = RainflowResidue.HALF_CYCLES,
    torque_error: float = 0.0,
    *,
    relative_torque_error: float = 0.0,
    always_count: bool = False,
) -> ShaftFatigue:
    """Damage and allowable starts of one shaft from its torque during one start.

    The history is counted from rest and closed by a return to zero. Local stress is Kf times
    nominal; amplitude is half a range; the mean is ignored, or enters by Goodman.

    Parameters
    ----------
    element : ElementRow
        The shaft, with stress diameter; bore and SCF as given (blank: 0 and 1). [m, 1]
    torque_turning_points : array_like, shape (n,)
        Turning points of its torque, at its own speed, in order of time. [N m]
    judged_with : SNCurve or ShaftStrength
        S-N line in torsion, with SCF alone and the mean ignored; or line, notch and ultimate strength. [Pa, 1]
    material : MaterialRow
        Its material, for the yield strength. [Pa]
    residue : str
        ``half cycles`` or ``repeated``. [word]
    torque_error : float
        Bound of the absolute error of each turning point. [N m]
    relative_torque_error : float
        Bound of an error in proportion to each turning point, added to the other. [1]
    always_count : bool
        Count even where the largest amplitude is at or below the endurance limit.

    Returns
    -------
    ShaftFatigue
        Complete result. [Pa, 1]
    """
    if isinstance(judged_with, ShaftStrength):
        sn_curve, ultimate = judged_with.curve, judged_with.ultimate
        scf, notch = judged_with.notch.concentration.value, judged_with.notch.fatigue
    else:
        sn_curve, ultimate = judged_with, None
        scf = notch = element.scf or 1.0
    history = counted_history(torque_turning_points)
    unit_stress = stress_of_unit_torque(element)
    local = notch * unit_stress
    peak = unit_stress * float(np.max(np.abs(history)))
    stress_error = local * torque_error
    bound = stress_error + relative_torque_error * notch * peak
    half = 0.5 * local * float(np.ptp(history))
    # No cycle of the history has a larger reversed amplitude: with less amplitude its mean may be larger by as much
    # at most, and counts for less as long as the stress is below the ultimate strength.
    middle = 0.5 * local * float(np.max(history) + np.min(history))
    largest = float(reversed_amplitude(half, middle, ultimate))
    most = float(reversed_amplitude(half + bound, abs(middle) + bound, ultimate))
    breaks = ultimate is not None and notch * peak + bound >= ultimate

    counted = always_count or breaks or needs_counting(most, sn_curve)
    cycles = count_cycles(history if counted else (), residue).scaled(local)
    by_paper = paper_count(history if counted else ()).scaled(local)
    amplitudes = reversed_amplitude(cycles.amplitude, cycles.mean, ultimate)
    damage = miner_damage(amplitudes, cycles.count, sn_curve)
    low, high = damage_interval(cycles, sn_curve, stress_error, relative_torque_error, ultimate)
    paper_damage = miner_damage(
        reversed_amplitude(by_paper.amplitude, by_paper.mean, ultimate), by_paper.count, sn_curve
    )
    above = float(np.sum(cycles.count[sn_curve.above_first_point(amplitudes)]))
    starts = starts_from_damage(damage)
    shear_yield = None if material.yield_ is None else SHEAR_YIELD_RATIO * material.yield_
    shaft = ShaftFatigue(
        element=str(element.element),
        damage=damage,
        damage_low=low,
        damage_high=high,
        allowable_starts=starts,
        unlimited=starts is None,
        starts_low=starts_from_damage(high),
        starts_high=starts_from_damage(low),
        paper_damage=paper_damage,
        paper_starts=starts_from_damage(paper_damage),
        cycles=cycles,
        counted=counted,
        largest_amplitude=largest,
        endurance=sn_curve.endurance,
        peak_nominal_stress=peak,
        above_first_point=above,
        above_shear_yield=None if shear_yield is None else peak > shear_yield,
        curve_notes=sn_curve.notes,
        notes=(),
        amplitudes=amplitudes,
        above_ultimate=ultimate is not None and bool(np.any(np.abs(cycles.mean) >= ultimate)),
    )
    notes = (*_notes(shaft, sn_curve, scf, shear_yield), *_mean_notes(shaft, ultimate))
    return replace(shaft, notes=notes)


def notes_on_starts(shafts: Iterable[ShaftFatigue]) -> Iterator[str]:
    """The sentences a reader must see beside the allowable starts, one a cause.

    Parameters
    ----------
    shafts : iterable of ShaftFatigue
        Every judged shaft. [Pa, 1]

    Yields
    ------
    str
        Of several shafts with one cause it names the worst and counts the others.
    """
    judged = list(shafts)
    yield from dict.fromkeys(note for shaft in judged for note in shaft.curve_notes)
    by_cause: dict[str, list[tuple[ShaftNote, str]]] = {}
    for shaft in judged:
        for note in shaft.notes:
            by_cause.setdefault(note.cause, []).append((note, shaft.element))
    for named in by_cause.values():
        worst, element = max(named, key=lambda one: one[0].size)
        others = f" (worst of {len(named)} shafts)" if len(named) > 1 else ""
        yield f"{element}{others}: {worst.words}"


def _notes(
    shaft: ShaftFatigue, curve: SNCurve, scf: float, shear_yield: float | None
) -> Iterator[ShaftNote]:
    peak = shaft.peak_nominal_stress
    if shaft.above_first_point:
        yield ShaftNote(
            "above the first S-N point",
            shaft.above_first_point,
            f"{shaft.above_first_point:g} cycles per start lie above the first S-N point "
            f"({in_megapascals(curve.first_stress)}); their life is extrapolated, "
            "not test data. Add S-N points at higher stress.",
        )
    if shear_yield is not None and peak > shear_yield:
        yield ShaftNote(
            "shaft yields",
            peak / shear_yield,
            f"the nominal peak {in_megapascals(peak)} is above the shear yield Yield/2 = "
            f"{in_megapascals(shear_yield)} (maximum shear theory): the shaft yields, so the allowable "
            "starts, counted from elastic stress, are invalid.",
        )
    elif shear_yield is not None and scf * peak > shear_yield:
        yield ShaftNote(
            "notch yields",
            scf * peak / shear_yield,
            f"SCF times the nominal peak, {in_megapascals(scf * peak)}, is above the shear yield "
            f"Yield/2 = {in_megapascals(shear_yield)}: local yielding at the notch (not judged).",
        )
    if (shaft.damage_low == 0.0) != (shaft.damage_high == 0.0):
        yield ShaftNote(
            "near the endurance limit",
            shaft.largest_amplitude / curve.endurance if curve.endurance else 0.0,
            "within the error of the history every cycle may lie at or below the "
            f"endurance limit {in_megapascals(curve.endurance)}, so the upper bound of the allowable "
            "starts is unlimited.",
        )


def _mean_notes(shaft: ShaftFatigue, ultimate: float | None) -> Iterator[ShaftNote]:
    if ultimate is None or not shaft.above_ultimate:
        return
    mean = float(np.max(np.abs(shaft.cycles.mean)))
    yield ShaftNote(
        "mean above the ultimate strength",
        mean / ultimate,
        f"the mean stress of a cycle with Kf, {in_megapascals(mean)}, reaches the ultimate strength in torsion, "
        f"0.67 UTS = {in_megapascals(ultimate)}, where Goodman's line ends: the allowable starts are invalid.",
    )


@dataclass(frozen=True, eq=False)
class AllowableStarts:
    """Fatigue of all judged shafts and the one that governs. None means unlimited."""

    shafts: tuple[ShaftFatigue, ...]  #: One entry a judged shaft. [rows]
    #: Shaft with the fewest starts; None when none is damaged or none is judged.
    governing: str | None
    starts: float | None  #: Allowable starts of the governing shaft, 1/q. [1]
    unlimited: bool  #: Shafts are judged and none is damaged.
    starts_low: float | None  #: Interval of the least starts over all shafts. [1]
    starts_high: float | None  #: Likewise. [1]
    bounded: bool  #: False where what is left out has no bound: the interval is not known.
    starts_factor: float  #: What the starts are divided by before they are judged. [1]
    judged_starts: float | None  #: `starts` over `starts_factor`. [1]

    @property
    def starts_error(self) -> float | None:
        """Larger side of the interval over the starts; None when it is unlimited. [1]"""
        return _starts_error(self.starts, self.starts_low, self.starts_high)


def allowable_starts(
    shafts: Sequence[ShaftFatigue], starts_factor: float | None = None
) -> AllowableStarts:
    """The train's allowable starts: those of its worst shaft.

    Parameters
    ----------
    shafts : sequence of ShaftFatigue
        Every judged shaft. [Pa, 1]
    starts_factor : float or None
        Allowable starts are divided by it before they are judged; None = 1. [1]

    Returns
    -------
    AllowableStarts
        With the governing shaft: fewest starts, then the lowest end of the interval. [1]
    """
    factor = starts_factor or 1.0

    def order(shaft: ShaftFatigue) -> tuple[float, float]:
        return _or_inf(shaft.allowable_starts), _or_inf(shaft.starts_low)

    worst = min(shafts, key=order, default=None)
    starts = None if worst is None else worst.allowable_starts
    limited = worst is not None and order(worst) != (math.inf, math.inf)
    return AllowableStarts(
        shafts=tuple(shafts),
        governing=worst.element if worst is not None and limited else None,
        starts=starts,
        unlimited=worst is not None and starts is None,
        starts_low=_least(shaft.starts_low for shaft in shafts),
        starts_high=_least(shaft.starts_high for shaft in shafts),
        bounded=all(shaft.left_out is not None for shaft in shafts),
        starts_factor=factor,
        judged_starts=None if starts is None else starts / factor,
    )


def _or_inf(starts: float | None) -> float:
    return math.inf if starts is None else starts


def _least(starts: Iterable[float | None]) -> float | None:
    least = min(map(_or_inf, starts), default=math.inf)
    return None if math.isinf(least) else least


def _starts_error(starts: float | None, low: float | None, high: float | None) -> float | None:
    if starts is None or low is None or high is None or starts == 0.0:
        return None
    return max(high / starts - 1.0, 1.0 - low / starts)
