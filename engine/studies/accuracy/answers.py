"""Answers of a start, and how two of them differ: peaks of each element, starts of each judged shaft."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from engine.arrays import Floats
from engine.case.choices import RainflowResidue
from engine.case.data import CaseData
from engine.fatigue.allowable_starts import shaft_fatigue
from engine.start.start_fatigue import judged_shafts, sn_curve_of

#: Turning points by element: times and torques. [s, N m]
Histories = Mapping[int, tuple[Floats, Floats]]
#: An error is shown no smaller than rounding leaves it.
LEAST_ERROR = 1e-12


@dataclass(frozen=True)
class Answers:
    """What is reported of a start: extremes of each element, damage of each judged shaft."""

    extremes: Mapping[int, tuple[float, float]]  #: Highest and lowest torque by element. [N m]
    damage: Mapping[int, float]  #: Miner sum of one start by element. [1]


def answers_of(case: CaseData, histories: Histories) -> Answers:
    """Extremes and damage from turning points.

    Parameters
    ----------
    case : CaseData
        The case. [SI]
    histories : mapping of int to (ndarray, ndarray)
        Turning points of each element. [s, N m]

    Returns
    -------
    Answers
        What is reported of the start. [N m, 1]
    """
    extremes = {e: (float(value.max()), float(value.min())) for e, (_, value) in histories.items()}
    residue = case.rainflow_residue or RainflowResidue.HALF_CYCLES
    damage = {}
    for index, element in judged_shafts(case):
        material = next(m for m in case.materials if m.material == element.material)
        curve = sn_curve_of(case, element.material)
        damage[index] = shaft_fatigue(element, histories[index][1], curve, material, residue).damage
    return Answers(extremes, damage)


def errors_between(answers: Answers, reference: Answers) -> tuple[float, float | None]:
    """How far answers are from a reference.

    Parameters
    ----------
    answers, reference : Answers
        Of the same elements. [N m, 1]

    Returns
    -------
    peak : float
        Largest relative error of an extreme. [1]
    starts : float or None
        Largest relative error of the starts; None where all are unlimited. [1]
    """
    largest = max((max(map(abs, x)) for x in reference.extremes.values()), default=0.0)
    peak = LEAST_ERROR
    for e, (high, low) in reference.extremes.items():
        size = max(abs(high), abs(low), 1e-9 * largest)
        extremes = answers.extremes[e]
        if size > 0.0:
            peak = max(peak, abs(extremes[0] - high) / size, abs(extremes[1] - low) / size)
    starts: float | None = None
    for e, damage in reference.damage.items():
        other = answers.damage[e]
        if damage > 0.0 or other > 0.0:
            both = damage > 0.0 and other > 0.0
            starts = max(starts or LEAST_ERROR, abs(damage / other - 1.0) if both else 1.0)
    return peak, starts
