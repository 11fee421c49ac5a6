"""Sensitivities by differences: the answers of trains changed up and down by a little."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from engine.arrays import Floats
from engine.errors import ModelError
from engine.start.start_fatigue import judged_shafts
from engine.studies.nearby_start import LINEAR, calculated, near_starts, near_trains
from engine.studies.sensitivities.plan import NARROW, WHOLE, WIDE, DerivativeUnit
from engine.studies.variation import Change, varied_case


@dataclass(frozen=True, eq=False)
class Differences:
    """Derivatives with respect to one parameter by differences of whole starts."""

    index: int  #: Place in the plan.
    #: ∂ln(largest torque)/∂ln p of each element, and its error. [1] Shape (n_elements,).
    peak: Floats
    peak_error: Floats  #: Likewise. [1] Shape (n_elements,).
    #: ∂ln(allowable starts)/∂ln p of each judged shaft; 0 where they are unlimited. [1] Shape
    #: (n_judged,).
    starts: Floats
    starts_error: Floats  #: Likewise. [1] Shape (n_judged,).
    #: ln of the largest torque at − 1 % and + 1 %, over the stated one. [1] Shape (2, n_elements).
    peak_ends: Floats
    starts_ends: Floats  #: ln of the starts there, over the stated one. [1] Shape (2, n_judged).
    #: How much twice the step changes either derivative, several times the error of the step; 0 of starts
    #: that choose their steps themselves. [1] Shape (n_elements,).
    peak_step: Floats
    starts_step: Floats  #: Likewise. [1] Shape (n_judged,).
    trouble: str = ""  #: Why there is none; else empty.


# --- differences ----------------------------------------------------------------------------------


def differences(unit: DerivativeUnit) -> Differences:
    """Derivatives with respect to one parameter by central differences of whole starts.

    Parameters
    ----------
    unit : DerivativeUnit
        Which parameter. [names]

    Returns
    -------
    Differences
        Derivatives with their errors. [1]
    """
    n, judged = len(unit.case.elements), len(judged_shafts(unit.case))
    quantity, name = unit.parameter
    shares, steps = [-WHOLE, -WIDE, -NARROW, 0.0, NARROW, WIDE, WHOLE], [1.0] * 7
    if unit.recipe.start == LINEAR:
        shares, steps = [*shares, -NARROW, NARROW], [*steps, 2.0, 2.0]
    cases = [varied_case(unit.case, [Change(quantity, name, 1.0 + share)]) for share in shares]
    try:
        trains = near_trains(cases, unit.recipe)
        found = near_starts(unit.recipe, [*zip(cases, trains, steps, strict=True)])
        answers = [calculated(start) for start in found]
    except ModelError as error:
        e, j = np.zeros((2, n)), np.zeros((2, judged))
        return Differences(unit.index, e[0], e[1], j[0], j[1], e, j, e[0], j[0], str(error))
    trouble = ""
    if not all(s.counted for s in answers):
        trouble = "A start with this quantity changed by 1 % is not completed."
    elif any(s.sensitive for s in answers):
        trouble = "A start with this quantity changed by 1 % is sensitive to tiny input changes."
    peak = np.array([_log(s.largest) for s in answers])
    starts = np.array([_log(s.damage, -1.0) for s in answers])
    return Differences(
        unit.index,
        *_extrapolated(peak),
        *_extrapolated(starts),
        peak[[0, 6]] - peak[3],
        starts[[0, 6]] - starts[3],
        _by_the_step(peak),
        _by_the_step(starts),
        trouble,
    )


def _log(values: Floats, power: float = 1.0) -> Floats:
    """Logarithm of a power; 0 where there is nothing."""
    return power * np.log(np.where(values > 0.0, values, 1.0))


def _extrapolated(logs: Floats) -> tuple[Floats, Floats]:
    """Richardson's derivative from two central differences, and their difference."""
    wide, narrow = _slope(logs[1], logs[5], WIDE), _slope(logs[2], logs[4], NARROW)
    return narrow + (narrow - wide) / 3.0, np.abs(narrow - wide)


def _by_the_step(logs: Floats) -> Floats:
    """How much twice the step changes the narrow difference; 0 without such runs."""
    if len(logs) == 7:
        return np.zeros_like(logs[0])
    return np.abs(_slope(logs[7], logs[8], NARROW) - _slope(logs[2], logs[4], NARROW))


def _slope(low: Floats, high: Floats, share: float) -> Floats:
    """Central difference over the same share down and up."""
    return np.asarray((high - low) / (math.log1p(share) - math.log1p(-share)))
