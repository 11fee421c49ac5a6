"""From a start to allowable starts: fatigue of the judged shafts, and how sure it is.

A shaft is judged if it has a stress diameter, a material and S-N points for it. The error of its
starts is the change of its damage between the two step sizes the start was calculated at.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from engine.arrays import Floats
from engine.case.choices import RainflowResidue
from engine.case.data import CaseData, ElementRow
from engine.case.defaults import LEAST_PEAK_ERROR
from engine.case.result_words import Outcome
from engine.fatigue.allowable_starts import (
    AllowableStarts,
    ShaftFatigue,
    allowable_starts,
    shaft_fatigue,
)
from engine.fatigue.cycle_counting import count_cycles, counted_history
from engine.fatigue.damage import miner_damage, needs_counting, starts_from_damage
from engine.fatigue.mean_stress import reversed_amplitude
from engine.fatigue.shaft_strength import shaft_strength
from engine.numerics.same_bits import exp, log
from engine.start.event_results import prediction_interval
from engine.start.peaks import JudgedRun
from engine.start.start import Start

#: Outcomes after which the cycles are those of a whole start.
WHOLE_STARTS = frozenset(
    {Outcome.REACHED, Outcome.SYNCHRONISED, Outcome.ASYNCHRONOUS, Outcome.COMPLETED}
)
#: Outcomes whose damage says how many such starts are allowed; a trip was asked for. After any
#: other the shaft has not seen what is still to come, and "unlimited" would be a lie.
COUNTED_STARTS = WHOLE_STARTS | {Outcome.TRIPPED}
#: Largest cycles compared between two steps to estimate the error of turning points.
COMPARED_CYCLES = 50
#: Error of torques from pieces counts so often for damage: it was found from one change of the damage by the
#: steepest slope of the S-N lines, and that of the history is less.
PIECES_ON_DAMAGE = 2.0
#: Cycles below this share of the largest add next to nothing to the damage on lines as steep as those of shafts.
DAMAGING_SHARE = 0.5
#: Shares of the changes from h to h/2 that are taken for the error at h/2: of the damage, and of the ranges that
#: damage, their mean, lest the damage of two runs agree by chance. (At fourth order the error is 1/15 of the
#: change, at second 1/3; docs/accuracy-study.md says how often they hold.)
DAMAGE_SHARE, RANGES_SHARE = 1.0 / 2.0, 1.0 / 3.0


def is_counted(start: Start | None) -> bool:
    """Whether the damage of a start says how many are allowed; see `COUNTED_STARTS`.

    False where it was not completed; True without a start.
    """
    return start is None or start.outcome.outcome in COUNTED_STARTS


def judged_shafts(case: CaseData) -> list[tuple[int, ElementRow]]:
    """Index and row of each element whose fatigue can be judged: diameter, material and S-N points."""
    with_points = {p.material for p in case.sn_points}
    return [
        (i, e)
        for i, e in enumerate(case.elements)
        if e.stress_diameter and e.material in with_points
    ]


def sn_slope(case: CaseData) -> float:
    """Steepest slope of the S-N lines in use: relative change of life over that of stress.

    Parameters
    ----------
    case : CaseData
        The case. [SI]

    Returns
    -------
    float
        Slope; 0 where no shaft is judged. [1]
    """
    steepest = 0.0
    for _, element in judged_shafts(case):
        steepest = max(steepest, float(np.max(shaft_strength(case, element).curve.slope)))
    return steepest


def starts_of(
    case: CaseData,
    start: Start,
    full: JudgedRun | None = None,
    otherwise: JudgedRun | None = None,
    *,
    always_count: bool = False,
) -> tuple[AllowableStarts | None, tuple[tuple[str, float | None], ...]]:
    """Allowable starts of every judged shaft, with the error of each.

    Parameters
    ----------
    case : CaseData
        The case. [SI]
    start : Start
        The start. [SI]
    full : JudgedRun, optional
        The same with every effect that it leaves out, where that was measured. [SI]
    otherwise : JudgedRun, optional
        The same with what its `estimate` is of, where that was measured. [SI]
    always_count : bool, optional
        Count even where the largest amplitude is at or below the endurance limit. [flag]

    Returns
    -------
    starts : AllowableStarts or None
        None where no shaft is judged. [1]
    errors : tuple of (str, float or None)
        Per judged shaft, relative error of its starts; None = unlimited. [1]
    """
    judged = judged_shafts(case)
    if not judged:
        return None, ()
    shafts, errors = [], []
    for index, element in judged:
        shaft, error = _shaft(case, element, (start, full, otherwise), index, always_count)
        shafts.append(shaft)
        errors.append((shaft.element, error))
    return allowable_starts(shafts, case.starts_factor), tuple(errors)


def _shaft(
    case: CaseData,
    element: ElementRow,
    starts: tuple[Start, JudgedRun | None, JudgedRun | None],
    index: int,
    always_count: bool,
) -> tuple[ShaftFatigue, float | None]:
    """Fatigue of the worst section of a shaft with its interval, and the relative error of its starts.

    The error is the change of the damage between the two steps, and by what pieces and modes left out may
    do to every torque; it reaches to the ends of the interval, of an ensemble where runs part.
    """
    start, full, otherwise = starts
    material = next(m for m in case.materials if m.material == element.material)
    strength = shaft_strength(case, element)
    residue = case.rainflow_residue or RainflowResidue.HALF_CYCLES
    peak = next(p for p in start.peaks if p.element == element.element)

    def of(
        history: Floats, error: float = 0.0, always: bool = True, relative: float = 0.0
    ) -> ShaftFatigue:
        return shaft_fatigue(
            element, history, strength, material, residue, error,
            relative_torque_error=relative, always_count=always,
        )  # fmt: skip

    pieces = PIECES_ON_DAMAGE * dict(start.pieces_error).get(str(element.element), 0.0)
    found = []
    for fine, coarse in _histories(start, index):
        error = max(peak.error, _cycle_difference(fine, coarse)) + (peak.left_out or 0.0)
        found.append((of(fine, error, always_count), fine, coarse))
    shaft, fine, coarse = max(found, key=lambda one: (one[0].damage, one[0].largest_amplitude))
    damage = shaft.damage
    if damage == 0.0:
        if peak.peak_to_peak_high is not None:  # an ensemble may go beyond its reported run
            reach = 0.5 * (peak.peak_to_peak_high - peak.peak_to_peak)
            shaft = of(fine, reach, always_count)
        return replace(shaft, left_out=None if start.left_out is None else 0.0), None
    # that of the peak would be told of every small cycle, too, near endurance the most
    relative = RANGES_SHARE * _relative_difference(fine, coarse) + start.truncation_error
    shaft = of(fine, pieces * peak.size, always_count, relative)

    def change(relative: float) -> float:
        """Of the damage, where every torque is larger by a share."""
        return abs(of((1.0 + relative) * fine).damage / damage - 1.0) if relative else 0.0

    # no torque is known better than to `LEAST_PEAK_ERROR`, and damage goes with its power
    stepped = DAMAGE_SHARE * abs(of(coarse).damage / damage - 1.0)
    stepped = max(stepped, sn_slope(case) * LEAST_PEAK_ERROR)
    off = stepped + change(pieces + start.truncation_error)
    low, high = shaft.damage_low, shaft.damage_high
    if start.repeatability is not None:
        ends = _over_ensemble(case, element, start, index)
        low, high = min(low, ends[0]), max(high, ends[1])
    measured = [
        largest_damage(case, element, [fine for fine, _ in _histories(other, index)])
        for other in (full, otherwise)
        if other is not None
    ]
    left_out = start.left_out
    if left_out is not None:
        left_out = change(left_out if otherwise is None else left_out - start.estimate)
        left_out = max(left_out, *(abs(other / damage - 1.0) for other in measured), 0.0)
    shaft = _with_interval(shaft, (low, high), off, left_out, measured)
    # near endurance the interval reaches further than the change of the damage
    return shaft, max(off, 1.0 - damage / high, damage / low - 1.0 if low else 1.0)


def _with_interval(
    shaft: ShaftFatigue,
    damage: tuple[float, float],
    error: float,
    left_out: float | None,
    measured: Sequence[float],
) -> ShaftFatigue:
    """The shaft with all of its errors in its interval, and the damages measured with what is left out.

    Without an interval where what is left out has no bound.
    """
    if left_out is None:
        return replace(shaft, starts_low=None, starts_high=None, left_out=None)
    share = 1.0 + left_out
    low = min(max(0.0, min(damage[0], shaft.damage / (1.0 + error))) / share, *measured, math.inf)
    high = max(max(damage[1], shaft.damage * (1.0 + error)) * share, *measured, 0.0)
    return replace(
        shaft,
        damage_low=low,
        damage_high=high,
        starts_low=starts_from_damage(high),
        starts_high=starts_from_damage(low),
        left_out=left_out,
    )


def _over_ensemble(
    case: CaseData, element: ElementRow, start: Start, index: int
) -> tuple[float, float]:
    """Interval of the damage of one more run, from those of an ensemble: of its logarithm."""
    assert start.repeatability is not None
    own = np.flatnonzero(start.trajectory.output_element == index)
    damages = np.array(
        [
            largest_damage(case, element, [run[i][1] for i in own.tolist()])
            for run in start.repeatability.histories
        ]
    )
    if not np.all(damages > 0.0):
        return 0.0, 2.0 * float(np.max(damages))
    low, high = prediction_interval(log(damages))
    return exp(low), exp(high)


def _histories(start: JudgedRun, index: int) -> list[tuple[Floats, Floats]]:
    """Torques at the turning points of each section of an element, at both steps. [N m]"""
    if index in start.sections:
        return [(fine[1], coarse[1]) for fine, coarse in start.sections[index]]
    place = np.flatnonzero(start.output_of_element >= 0).tolist().index(index)
    return [(start.turning_points[place][1], start.coarse_turning_points[place][1])]


def largest_damage(case: CaseData, element: ElementRow, histories: Sequence[Floats]) -> float:
    """Damage of the worst section of a judged shaft.

    Parameters
    ----------
    case : CaseData
        The case. [SI]
    element : ElementRow
        The shaft. [SI]
    histories : sequence of ndarray
        Torques at the turning points of each section. [N m]

    Returns
    -------
    float
        Miner sum of one start. [1]
    """
    strength = shaft_strength(case, element)
    residue = case.rainflow_residue or RainflowResidue.HALF_CYCLES
    counted = (count_cycles(counted_history(h), residue).scaled(strength.local) for h in histories)
    return max(
        miner_damage(
            reversed_amplitude(c.amplitude, c.mean, strength.ultimate), c.count, strength.curve
        )
        for c in counted
    )


def _largest_ranges(fine: Floats, coarse: Floats) -> tuple[Floats, Floats]:
    """The largest ranges of turning points at both steps, in falling order, equally many. [N m]"""
    a, b = (np.sort(np.abs(np.diff(h)))[::-1][:COMPARED_CYCLES] for h in (fine, coarse))
    n = min(len(a), len(b))
    return a[:n], b[:n]


def _cycle_difference(fine: Floats, coarse: Floats) -> float:
    """Largest change of a turning point between two steps, over the largest ranges. [N m]"""
    a, b = _largest_ranges(fine, coarse)
    return float(np.max(np.abs(a - b), initial=0.0))


def _relative_difference(fine: Floats, coarse: Floats) -> float:
    """Mean relative change of the ranges that damage between two steps. [1]"""
    a, b = _largest_ranges(fine, coarse)
    damaging = (a >= DAMAGING_SHARE * np.max(a, initial=0.0)) & (a > 0.0)
    return float(np.mean(np.abs(a - b)[damaging] / a[damaging])) if damaging.any() else 0.0


def stress_over_endurance(case: CaseData, start: Start) -> tuple[float, bool] | None:
    """Largest possible stress amplitude over the endurance limit, and whether cycles must be counted.

    No counted range exceeds maximum minus minimum, rest included; the amplitude is half of it, with
    Kf, the error of the history and, by Goodman, its mean.

    Parameters
    ----------
    case : CaseData
        The case. [SI]
    start : Start
        The start. [SI]

    Returns
    -------
    tuple of (float, bool), or None
        Of the shaft nearest to its limit; None where no shaft is judged. [1, flag]
    """
    worst, wanted = -1.0, False
    for index, element in judged_shafts(case):
        assert element.stress_diameter is not None
        strength = shaft_strength(case, element)
        curve, unit = strength.curve, strength.local
        peak = next(p for p in start.peaks if p.element == element.element)
        histories = _histories(start, index)
        error = max(peak.error, *(_cycle_difference(a, b) for a, b in histories))
        ends = [(max(h.max(), 0.0), min(h.min(), 0.0)) for h, _ in histories]
        largest = max(high - low for high, low in ends)
        half = 0.5 * unit * float(largest)
        most = half + unit * error
        if strength.ultimate is not None:
            most, breaks = _with_mean(ends, unit, error, strength.ultimate)
            wanted = wanted or breaks
        wanted = wanted or needs_counting(most, curve)
        if curve.endurance > 0.0:
            worst = max(worst, most / curve.endurance)
    return (worst, wanted) if judged_shafts(case) else None


def _with_mean(
    ends: Sequence[tuple[float, float]], unit: float, error: float, ultimate: float
) -> tuple[float, bool]:
    """Largest reversed amplitude of histories between some extremes, and whether one reaches the ultimate strength."""
    found = [
        reversed_amplitude(
            unit * (0.5 * (high - low) + error),
            unit * (0.5 * abs(high + low) + error),
            ultimate,
        )
        for high, low in ends
    ]
    reach = max(max(high, -low) for high, low in ends) + error
    return float(max(map(float, found))), unit * reach >= ultimate
