"""Published numbers of fatigue factors, with their sources and the ranges they hold in.

"Shigley" is Budynas and Nisbett, Shigley's Mechanical Engineering Design, 9th edition (2011); its pages 287 to 292, 317 and
345 to 347 were read in an electronic copy. Pilkey's and Peterson's books were not at hand: what is taken from them was
compared with copies of the same formulas by others (docs/theory-fatigue.md).
"""

from __future__ import annotations

from typing import NamedTuple

from engine.case.choices import SurfaceFinish

#: Strength in which surface and Neuber's formula are fitted. [Pa]
KPSI = 6894757.293168361
#: Smallest and largest UTS of the formulas. That of the surface is ours, the book states none; of Neuber's in torsion it is
#: 50 to 220 kpsi, beyond which its polynomial turns negative. [Pa]
SURFACE_UTS = (50.0 * KPSI, 220.0 * KPSI)
NEUBER_UTS = (50.0 * KPSI, 220.0 * KPSI)
#: Of Peterson's; Dowling, Mechanical Behavior of Materials, gives it for these steels. [Pa]
PETERSON_UTS = (550e6, 2070e6)
#: Diameters of the size factor. [m]
SIZE_DIAMETERS = (2.79e-3, 0.254)
#: From this diameter on another power holds. [m]
LARGER_SIZE = 0.051
#: Height of a step over its fillet radius. [1]
FILLET_STEPS = (0.25, 4.0)
#: Radius at the bottom of a keyway over the diameter. [1]
KEYWAY_RADII = (0.005, 0.07)
#: Largest diameter of a shaft with a keyway, 6.5 in. [m]
KEYWAY_DIAMETER = 0.1651
#: Depth of the keyway over the diameter: an eighth, and what rounding of standard keys may add. [1]
KEYWAY_DEPTH = 0.125 * 1.02


class PowerLaw(NamedTuple):
    """Surface factor a UTS^b."""

    a: float  #: With UTS in MPa. [MPa^-b]
    b: float  #: Exponent. [1]


#: Shigley, Table 6-2 (data of Noll and Lipson, 1946).
SURFACE_FINISHES = {
    SurfaceFinish.GROUND: PowerLaw(1.58, -0.085),
    SurfaceFinish.MACHINED: PowerLaw(4.51, -0.265),
    SurfaceFinish.HOT_ROLLED: PowerLaw(57.7, -0.718),
    SurfaceFinish.AS_FORGED: PowerLaw(272.0, -0.995),
}
#: Shigley, Table 6-5: reliability and its factor, 1 - 0.08 z, for a standard deviation of 8 % of the endurance limit. [1]
RELIABILITIES = {
    0.5: 1.0,
    0.9: 0.897,
    0.95: 0.868,
    0.99: 0.814,
    0.999: 0.753,
    0.9999: 0.702,
    0.99999: 0.659,
    0.999999: 0.620,
}


def tabled_reliability(reliability: float) -> float | None:
    """The entry of the table that a typed share is, rounding aside; None where it is none.

    Parameters
    ----------
    reliability : float
        Share of parts that endure. [1]

    Returns
    -------
    float or None
        A key of `RELIABILITIES`. [1]
    """
    return next((r for r in RELIABILITIES if abs(r - reliability) <= 1e-9), None)
