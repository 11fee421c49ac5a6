"""Measured time constants of a motor: those with the stator short-circuited from those with it open."""

from __future__ import annotations

import math


def short_circuit_times(
    reactances: tuple[float, float, float], times: tuple[float, float]
) -> tuple[float, float] | None:
    """Time constants with the stator short-circuited.

    1/Xd(p) = 1/Xd + (1/Xd' − 1/Xd) p T'/(1 + p T') + (1/Xd'' − 1/Xd') p T''/(1 + p T'') has its zeros at the time constants
    with the stator open: their product is T' T'' Xd/Xd'', their sum that of T' and T'', each times Xd and the admittance
    that the other term leaves.

    Parameters
    ----------
    reactances : tuple of float
        Xd, Xd', Xd'', falling. [pu]
    times : tuple of float
        Time constants of field and damper with the stator open, falling. [s]

    Returns
    -------
    tuple of float, or None
        Of both, falling; None where no circuit has these time constants. [s]
    """
    xd, transient, subtransient = reactances
    slow, fast = times
    product, total = slow * fast * subtransient / xd, (slow + fast) / xd
    u = 1.0 / transient
    w = 1.0 / xd + 1.0 / subtransient - u
    under = total * total - 4.0 * u * w * product
    if under < 0.0:
        return None
    first = (total + math.sqrt(under)) / (2.0 * u)
    second = product / first
    return (first, second) if second < first else None
