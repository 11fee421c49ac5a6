"""Answers of a start, and how two of them differ: peaks of each element, starts of each judged shaft."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TypeVar

from engine.arrays import Floats
from engine.case.data import CaseData
from engine.start.start_fatigue import judged_shafts, largest_damage

Result = TypeVar("Result")

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
    damage = {
        index: largest_damage(case, element, [histories[index][1]])
        for index, element in judged_shafts(case)
    }
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


def timed_runs(once: Callable[[], Result], rounds: int) -> tuple[Result, float]:
    """The result of the last of some runs, and their median processor time; compiled code is warm by then.

    Parameters
    ----------
    once : callable
        One run. [any]
    rounds : int
        How often it is run. [count]

    Returns
    -------
    result : Result
        As `once` gives it. [any]
    seconds : float
        Median. [s]
    """
    taken = []
    for _ in range(max(rounds, 1)):
        began = time.process_time()
        result = once()
        taken.append(time.process_time() - began)
    return result, statistics.median(taken)
