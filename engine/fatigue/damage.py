"""Damage of counted cycles: Palmgren-Miner sum, its interval, and the starts it allows."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from engine.case.choices import BelowEndurance
from engine.case.defaults import WHOLE_STARTS
from engine.errors import InternalError
from engine.fatigue.cycle_counting import CycleCount
from engine.fatigue.mean_stress import reversed_amplitude
from engine.fatigue.sn_curve import SNCurve

#: From here on a number of starts is shown by its power of ten. [1]
MANY_STARTS = 1e9


def miner_damage(amplitude: ArrayLike, count: ArrayLike, curve: SNCurve) -> float:
    """Palmgren-Miner sum q = Σ nᵢ/Nᵢ.

    Parameters
    ----------
    amplitude : array_like, shape (n,)
        Stress amplitudes, zero-to-peak, with SCF. [Pa]
    count : array_like, shape (n,)
        Cycles at each. [1]
    curve : SNCurve
        The S-N line. [Pa]

    Returns
    -------
    float
        Damage; 1 is failure. [1]
    """
    with np.errstate(divide="ignore", over="ignore"):
        return float(np.sum(np.asarray(count, float) / curve.cycles_to_failure(amplitude)))


def damage_interval(
    cycles: CycleCount,
    curve: SNCurve,
    stress_error: float,
    relative_error: float = 0.0,
    ultimate: float | None = None,
) -> tuple[float, float]:
    """Least and largest damage when each turning point may be off by an error.

    Turning points within ± e move every counted amplitude, and every mean, by at most e: rainflow ranges are
    persistences of the history, of the history and its mirror image for ASTM half cycles, and those
    are stable in that sense (Cohen-Steiner, Edelsbrunner and Harer, Stability of persistence
    diagrams, 2007). Cycles of less than e that the error hides altogether cannot be known; they
    matter only where so small an amplitude damages.

    Parameters
    ----------
    cycles : CycleCount
        Counted stress cycles, with SCF. [Pa]
    curve : SNCurve
        The S-N line. [Pa]
    stress_error : float
        Bound of the absolute error of each turning point. [Pa]
    relative_error : float
        Bound of an error in proportion to each turning point, added to the other. [1]
    ultimate : float, optional
        Ultimate strength in torsion for Goodman; without it the mean is ignored. [Pa]

    Returns
    -------
    float
        Damage with every amplitude less its error. [1]
    float
        Damage with every amplitude plus its error. [1]

    Raises
    ------
    InternalError
        When an error bound is negative or not finite.
    """
    for bound in (stress_error, relative_error):
        if not (math.isfinite(bound) and bound >= 0.0):
            raise InternalError(
                f"the error bound {bound} of a damage must be finite and not negative"
            )
    a = cycles.amplitude
    # Half the sum of |peak| and |valley| is the larger of |mean| and amplitude.
    e = stress_error + relative_error * np.maximum(np.abs(cycles.mean), a)
    mean = np.abs(cycles.mean)
    least = reversed_amplitude(np.maximum(a - e, 0.0), np.maximum(mean - e, 0.0), ultimate)
    most = reversed_amplitude(a + e, mean + e, ultimate)
    return miner_damage(least, cycles.count, curve), miner_damage(most, cycles.count, curve)


def starts_from_damage(damage: float) -> float | None:
    """Allowable starts 1/q.

    Parameters
    ----------
    damage : float
        Damage of one start. [1]

    Returns
    -------
    float or None
        Starts to failure; None when there is no damage: unlimited. [1]
    """
    if damage == 0.0 or math.isinf(1.0 / damage):
        return None
    return 1.0 / damage


def starts_in_words(starts: float) -> str:
    """Whole starts, never rounded up; of a thousand millions and more, which nobody makes, the power.

    Parameters
    ----------
    starts : float
        Starts; a count off by rounding alone is the whole one. [1]

    Returns
    -------
    str
        Such as ``15,119`` or ``2.15e+16``. [text]
    """
    whole = math.floor(starts * (1.0 + WHOLE_STARTS))
    return f"{whole:,}" if whole < MANY_STARTS else f"{starts:.2e}"


def needs_counting(largest_amplitude: float, curve: SNCurve, stress_error: float = 0.0) -> bool:
    """Whether any cycle of a history can damage: the cheap evidence before counting.

    No counted range exceeds maximum minus minimum, so half of that at or below the endurance limit
    settles the matter where nothing below the limit damages.

    Parameters
    ----------
    largest_amplitude : float
        Half of maximum minus minimum, rest included, with SCF. [Pa]
    curve : SNCurve
        The S-N line. [Pa]
    stress_error : float
        Bound of the error of that amplitude. [Pa]

    Returns
    -------
    bool
        False when the starts are unlimited without counting.
    """
    return (
        curve.below_endurance != BelowEndurance.NONE
        or largest_amplitude + stress_error > curve.endurance
    )
