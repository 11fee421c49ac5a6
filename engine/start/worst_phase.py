"""The worst of starts that differ in the phase of the pulsation alone, `PulsationPhase` = worst.

Nobody chooses at which instant a breaker closes, so that the phase is chance. Starts at phases spread evenly over a turn (two
where a motor has its field applied or pulsates at 1 × slip frequency, which follow half the phase) are calculated, then those half-way to the neighbours of each phase that is the worst of some peak or shaft: what these change is
part of the stated error.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from functools import partial

from engine.case.data import CaseData
from engine.fatigue.allowable_starts import ShaftFatigue
from engine.fatigue.damage import starts_from_damage
from engine.start.peaks import ElementPeak
from engine.start.start import Start
from engine.start.start_fatigue import is_counted

#: Phases spread over a turn; one each 10 degrees, between which a cosine changes by 0.4 % of its size. [count]
PHASES = 36


@dataclass(frozen=True, eq=False)
class PhaseAnswers:
    """What a start at one phase answers."""

    phase: float  #: Phase of the pulsation at t = 0. [rad]
    #: Whether it was completed, then its largest peak, at motor speed. [flag, N m]
    size: tuple[bool, float]
    peaks: tuple[ElementPeak, ...]  #: One an element. [N m]
    shafts: tuple[ShaftFatigue, ...]  #: Every judged shaft. [Pa, 1]
    #: Per judged shaft, relative error of its starts; None = unlimited. [1]
    errors: tuple[tuple[str, float | None], ...]
    left_out: float | None  #: Bound on the change by effects that are off; None = no bound. [1]


@dataclass(frozen=True, eq=False)
class WorstOfPhases:
    """The worst of each peak and of each shaft's damage, with their phases."""

    phase: float  #: Of the start with the largest peak, or of one that was not completed. [rad]
    peaks: tuple[ElementPeak, ...]  #: One an element. [N m]
    shafts: tuple[ShaftFatigue, ...]  #: Every judged shaft. [Pa, 1]
    #: Per judged shaft, relative error of its starts; None = unlimited. [1]
    errors: tuple[tuple[str, float | None], ...]
    left_out: float | None  #: The largest bound; None = there is none at some phase. [1]
    phases: int  #: Starts that were calculated. [count]


def at_phase(case: CaseData, phase: float) -> CaseData:
    """The case with one phase of the pulsation.

    Parameters
    ----------
    case : CaseData
        The case. [SI]
    phase : float
        Phase at t = 0. [rad]
    """
    return replace(CaseData(**vars(case)), pulsation_phase=phase)


def answers_at(
    case: CaseData,
    phase: float,
    start: Start,
    shafts: Sequence[ShaftFatigue],
    errors: tuple[tuple[str, float | None], ...],
) -> PhaseAnswers:
    """What is kept of a start at one phase.

    Parameters
    ----------
    case : CaseData
        The case, for speeds. [SI]
    phase : float
        Its phase. [rad]
    start : Start
        The start. [SI]
    shafts : sequence of ShaftFatigue
        Its judged shafts. [Pa, 1]
    errors : tuple of (str, float or None)
        Relative errors of their starts. [1]

    Returns
    -------
    PhaseAnswers
        Without histories. [SI]
    """
    largest = start.largest_peak(case.element_speed_ratios)[1]
    size = (not is_counted(start), largest)
    return PhaseAnswers(phase, size, start.peaks, tuple(shafts), errors, start.left_out)


def worst_of_phases(
    answers_of: Callable[[Iterable[float]], Sequence[PhaseAnswers]], turns: int = 1
) -> WorstOfPhases:
    """The worst over all phases.

    Parameters
    ----------
    answers_of : callable
        Phases → what the start at each answers. [rad, SI]
    turns : int, optional
        After how many turns of the phase the start is the same. [count]

    Returns
    -------
    WorstOfPhases
        Errors hold the change against half the spacing. [SI]
    """
    spacing = 2.0 * math.pi / PHASES
    n = turns * PHASES
    coarse = list(answers_of(spacing * k for k in range(n)))
    worst = _worst(coarse)
    named = [p.phase for p in worst.peaks] + [s.phase for s in worst.shafts]
    for i in range(len(worst.peaks)):
        named += [_highest(coarse, i).phase, _lowest(coarse, i).phase]
    nodes = {round(phase / spacing) for phase in named if phase is not None}
    between = {(2 * k + side) % (2 * n) for k in nodes for side in (-1, 1)}
    every = [*coarse, *answers_of(0.5 * spacing * k for k in sorted(between))]
    finer = _worst(every)
    peaks = tuple(
        peak.with_error(
            max(
                _beyond(coarse, every, turns, partial(_rise, i)),
                _beyond(coarse, every, turns, partial(_fall, i)),
            )
        )
        for i, peak in enumerate(finer.peaks)
    )
    shafts, errors = [], []
    for j, ((name, error), a) in enumerate(zip(finer.errors, finer.shafts, strict=True)):
        more = _beyond(coarse, every, turns, partial(_damage, j))
        change = more / a.damage if a.damage > 0.0 else 0.0
        shafts.append(_with_more_damage(a, change))
        errors.append((name, None if error is None else error + change))
    return replace(finer, peaks=peaks, shafts=tuple(shafts), errors=tuple(errors))


def _beyond(
    coarse: Sequence[PhaseAnswers],
    every: Sequence[PhaseAnswers],
    turns: int,
    size: Callable[[PhaseAnswers], float],
) -> float:
    """How far a size may go beyond the largest one: the change by half the spacing, or the top of the parabola's reach.

    The largest value has neighbours at half the spacing, and the top is within a quarter of it: on a parabola an eighth of what
    both neighbours are lower, or less.
    """
    sizes = {round(2 * PHASES * a.phase / (2.0 * math.pi)): size(a) for a in every}
    top = max(sizes, key=sizes.__getitem__)
    # where all are equal, as without damage, the first has no neighbours
    beside = [sizes.get((top + side) % (2 * turns * PHASES), sizes[top]) for side in (-1, 1)]
    return max(sizes[top] - max(map(size, coarse)), (2.0 * sizes[top] - sum(beside)) / 8.0)


def _worst(all_answers: Sequence[PhaseAnswers]) -> WorstOfPhases:
    peaks = []
    for i in range(len(all_answers[0].peaks)):
        high, low = _highest(all_answers, i), _lowest(all_answers, i)
        of_element = [a.peaks[i] for a in all_answers]
        upper, lower = high.peaks[i], low.peaks[i]
        larger, own = (high, upper) if upper.maximum >= -lower.minimum else (low, lower)
        widest = max(of_element, key=lambda p: p.peak_to_peak)
        bounds = [p.left_out for p in of_element]
        known = [bound for bound in bounds if bound is not None]
        repeated = None
        if upper.repeated is not None or lower.repeated is not None:
            repeated = upper.extremes[0], lower.extremes[1]
        peaks.append(
            replace(
                own,
                maximum=upper.maximum,
                minimum=lower.minimum,
                error=max(upper.error, lower.error, widest.error),
                peak_to_peak=widest.peak_to_peak,
                left_out=max(known) if len(known) == len(bounds) else None,
                repeated=repeated,
                phase=larger.phase,
            )
        )
    shafts, errors = [], []
    for j, (name, _) in enumerate(all_answers[0].errors):
        most = max(all_answers, key=partial(_wear, j))
        shafts.append(replace(most.shafts[j], phase=most.phase))
        errors.append((name, most.errors[j][1]))
    left_out = [a.left_out for a in all_answers]
    bounded = [bound for bound in left_out if bound is not None]
    return WorstOfPhases(
        max(all_answers, key=lambda a: a.size).phase,
        tuple(peaks),
        tuple(shafts),
        tuple(errors),
        max(bounded) if len(bounded) == len(left_out) else None,
        len(all_answers),
    )


def _rise(i: int, answers: PhaseAnswers) -> float:
    """The highest torque of an element."""
    return answers.peaks[i].maximum


def _fall(i: int, answers: PhaseAnswers) -> float:
    """The lowest torque of an element, its sign changed."""
    return -answers.peaks[i].minimum


def _damage(j: int, answers: PhaseAnswers) -> float:
    """Damage of a judged shaft."""
    return answers.shafts[j].damage


def _wear(j: int, answers: PhaseAnswers) -> tuple[float, float]:
    """Damage of a judged shaft, and its largest stress amplitude where there is none."""
    return answers.shafts[j].damage, answers.shafts[j].largest_amplitude


def _highest(all_answers: Sequence[PhaseAnswers], i: int) -> PhaseAnswers:
    """The start with the highest torque of an element."""
    return max(all_answers, key=lambda a: a.peaks[i].maximum)


def _lowest(all_answers: Sequence[PhaseAnswers], i: int) -> PhaseAnswers:
    """The start with the lowest torque of an element."""
    return min(all_answers, key=lambda a: a.peaks[i].minimum)


def _with_more_damage(shaft: ShaftFatigue, change: float) -> ShaftFatigue:
    """A shaft whose damage may be larger or smaller by a share."""
    low, high = shaft.damage_low / (1.0 + change), shaft.damage_high * (1.0 + change)
    shaft = replace(shaft, damage_low=low, damage_high=high)
    if shaft.left_out is None:
        return shaft
    return replace(shaft, starts_low=starts_from_damage(high), starts_high=starts_from_damage(low))
