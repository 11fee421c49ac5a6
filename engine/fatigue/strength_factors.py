"""Surface, size and reliability factors, and the S-N line that they lower.

Formulas and tables are those of Shigley, 9th edition, section 6-9; see `engine.case.fatigue_tables`. Its load factor
for torsion is not among them: endurance in torsion is typed, or bending is halved.
"""

from __future__ import annotations

import numpy as np

from engine.arrays import Floats
from engine.case.choices import SurfaceFinish
from engine.case.fatigue_tables import LARGER_SIZE, SURFACE_FINISHES
from engine.fatigue.sn_curve import SNCurve
from engine.numerics.same_bits import log, power

#: Life up to which the factors change nothing, and from which on they act in full. [1]
NO_EFFECT, FULL_EFFECT = 1e3, 1e6
#: Lives this near to each other are one. [1]
SAME_LIFE = 1e-9


def surface_factor(finish: SurfaceFinish, uts: float) -> float:
    """Surface factor a UTS^b, at most 1 (Shigley, Eq. 6-19 and Table 6-2).

    Parameters
    ----------
    finish : SurfaceFinish
        Finish of the surface. [word]
    uts : float
        Ultimate tensile strength. [Pa]

    Returns
    -------
    float
        Factor on the endurance limit. [1]
    """
    law = SURFACE_FINISHES[finish]
    return min(1.0, law.a * float(power(uts / 1e6, law.b)))


def size_factor(diameter: float) -> float:
    """Size factor of a round shaft in torsion, at most 1 (Shigley, Eq. 6-20).

    Parameters
    ----------
    diameter : float
        Stress diameter, 2.79 to 254 mm. [m]

    Returns
    -------
    float
        Factor on the endurance limit. [1]
    """
    mm = 1e3 * diameter
    if diameter <= LARGER_SIZE:
        return min(1.0, float(power(mm / 7.62, -0.107)))
    return 1.51 * float(power(mm, -0.157))


def lowered_line(curve: SNCurve, factor: float) -> SNCurve:
    """The S-N line of a shaft: unchanged up to 10³ cycles, lowered by the factor at the endurance limit.

    Between 10³ cycles and the knee, or 10⁶ cycles where the knee lies beyond, the factor grows with the logarithm
    of the life, so that straight parts of the line stay straight: Shigley's line from f Sut at 10³ cycles, which no
    Marin factor changes, to Se. Where the knee lies below 10³ cycles the whole line is lowered.

    Parameters
    ----------
    curve : SNCurve
        The line of the data, in torsion. [Pa]
    factor : float
        Product of the factors, above 0, at most 1. [1]

    Returns
    -------
    SNCurve
        The lowered line; of factor 1 the same one. [Pa]
    """
    if factor == 1.0:
        return curve
    knee = curve.knee_cycles
    full = min(knee, FULL_EFFECT)
    lives = [*curve.cycles.tolist()]
    # of data that begin beyond 10³ cycles two points on their extension, which beyond 10³ is theirs
    for life in (*((1.0,) if curve.cycles[0] >= NO_EFFECT else ()), NO_EFFECT, full, knee):
        if life <= knee and all(abs(life / other - 1.0) > SAME_LIFE for other in lives):
            lives.append(life)
    cycles = np.array(sorted(lives))
    stress = _stress_at(curve, cycles) * power(factor, _share(cycles, full))
    return SNCurve(
        cycles,
        stress,
        float(min(factor * curve.endurance, stress[-1])),
        curve.below_endurance,
        curve.notes,
        extended=int(np.count_nonzero(cycles < curve.cycles[0])),
    )


def _share(cycles: Floats, full: float) -> Floats:
    """How much of the logarithm of the factor acts at each life."""
    if full <= NO_EFFECT:
        return np.ones_like(cycles)
    return np.asarray(np.clip(log(cycles / NO_EFFECT) / log(full / NO_EFFECT), 0.0, 1.0))


def _stress_at(curve: SNCurve, cycles: Floats) -> Floats:
    """Stress of the line at lives down to the knee; that of its points to the bit."""
    i = np.clip(np.searchsorted(curve.cycles, cycles, side="right") - 1, 0, curve.cycles.size - 1)
    slope = curve.slope[np.minimum(i, curve.slope.size - 1)]
    at_point = cycles == curve.cycles[i]
    found = curve.stress[i] * power(curve.cycles[i] / cycles, 1.0 / slope)
    return np.where(at_point, curve.stress[i], found)
