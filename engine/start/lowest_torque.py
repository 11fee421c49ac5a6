"""The lowest torque of each element, by how much it may be lower, and what may be said of its sign."""

from __future__ import annotations

from engine.case.defaults import NOTABLE_REVERSAL
from engine.start.start import Start

#: A torque that comes below zero by less than the hysteresis, in words.
NEAR_ZERO = f"does not reverse (below zero by less than {NOTABLE_REVERSAL:.1%} of its largest)"


def lowest_torques(start: Start) -> dict[str, float]:
    """Torque of each element at the unfavourable end of the range of its minimum.

    Parameters
    ----------
    start : Start
        A start. [SI]

    Returns
    -------
    dict of str to float
        Minimum less error, ensemble and what is left out, as far as that has a bound. [N m]
    """
    return {p.element: p.extremes[1][0] - (p.left_out or 0.0) for p in start.peaks}


def doubts_of_minima(start: Start) -> dict[str, float | None]:
    """By how much each minimum may be lower.

    Parameters
    ----------
    start : Start
        A start. [SI]

    Returns
    -------
    dict of str to (float or None)
        Error, ensemble and what is left out; None where that has no bound. [N m]
    """
    return {
        p.element: None if p.minimum_range is None else p.minimum - p.minimum_range[0]
        for p in start.peaks
    }


def sign_in_words(lowest: float, doubt: float | None, hysteresis: float) -> str:
    """Whether a torque reverses, in no wider words than it was calculated.

    Parameters
    ----------
    lowest : float
        The lowest torque. [N m]
    doubt : float or None
        By how much it may be lower; None = no bound is known. [N m]
    hysteresis : float
        Depth below zero from which it is a reversal. [N m]

    Returns
    -------
    str
        What the torque does, such as ``stays positive``. [words]
    """
    if lowest < -hysteresis:
        return "reverses"
    if doubt is None:
        return "does not reverse as calculated (no bound on what is left out)"
    if lowest - doubt < -hysteresis:
        return "may reverse (its lowest value is within its error of zero)"
    if lowest < 0.0:
        return NEAR_ZERO
    return "stays positive" if lowest >= doubt else "does not reverse"
