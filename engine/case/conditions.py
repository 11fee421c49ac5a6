"""The scalars of a case that a row of `StartConditions` changes: voltage, trip speed, damping."""

from __future__ import annotations

from dataclasses import replace

from engine.case.data import CaseData


def with_start(case: CaseData, voltage: float | None, trip_speed: float | None) -> CaseData:
    """The case at another voltage, aborted elsewhere.

    A trip speed is asked for: an effect choice that forces aborted starts off is not kept beside it.

    Parameters
    ----------
    case : CaseData
        The case. [SI]
    voltage : float or None
        Over the voltage of the torque curves; None = as these are. [1]
    trip_speed : float or None
        Of the reference shaft; None = not aborted. [rad/s]

    Returns
    -------
    CaseData
        The changed case, not yet checked. [SI]
    """
    new = replace(case, voltage=voltage, trip_speed=trip_speed)
    if trip_speed is None:
        return new
    choices = tuple(
        c for c in new.effect_choices if (c.effect, c.choice) != ("aborted start", "off")
    )
    return replace(new, effect_choices=choices)


def with_damping(case: CaseData, damping_ratio: float | None) -> CaseData:
    """The case with another damping ratio of all elastic modes, hot or cold.

    It stands in the place of DampingRatio, and `ModeDamping` is scaled in the same proportion: hot or cold oil
    changes all modes alike. Where the case states no DampingRatio there is no proportion, and `ModeDamping` stays.
    Dampers and loss factors stay, too.

    Parameters
    ----------
    case : CaseData
        The case. [SI]
    damping_ratio : float or None
        The ratio; None = as in the case. [1]

    Returns
    -------
    CaseData
        The changed case, not yet checked. [SI]
    """
    if damping_ratio is None:
        return case
    rows = case.mode_damping
    if case.damping_ratio:
        factor = damping_ratio / case.damping_ratio
        rows = tuple(
            row
            if row.damping_ratio is None
            else replace(row, damping_ratio=factor * row.damping_ratio)
            for row in rows
        )
    return replace(case, damping_ratio=damping_ratio, mode_damping=rows)
