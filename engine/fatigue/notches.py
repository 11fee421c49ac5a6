"""Stress concentration of fillets and keyways in torsion, and how much of it fatigue feels.

"Pilkey" is W. D. Pilkey, Formulas for Stress, Strain, and Structural Matrices, 2nd edition (2005), Table 6-1, whose fits are of
the charts in Peterson's Stress Concentration Factors. Ranges stand in `engine.case.fatigue_tables`.
"""

from __future__ import annotations

import math

from engine.case.fatigue_tables import KPSI
from engine.numerics.same_bits import power

#: At the end of a keyway, on the surface of the shaft: Pilkey, Table 6-1, IV 1. [1]
KEYWAY_END = 3.4
#: Peterson's constant in torsion over that in bending. [1]
TORSION_OVER_BENDING = 0.6
INCH = 0.0254


def fillet_concentration(shoulder: float, diameter: float, radius: float) -> float:
    """Stress concentration of a shoulder fillet in torsion, over the nominal stress of the thinner shaft.

    Kt = C1 + C2 x + C3 x² + C4 x³, x = 2h/D, h = (D − d)/2, each C = a + b √(h/r) + c h/r, for solid shafts
    with h/r from 0.25 to 4 (Pilkey, Table 6-1, III; also Roark's Table of stress concentration).

    Parameters
    ----------
    shoulder, diameter, radius : float
        Larger and smaller diameter, and fillet radius. [m]

    Returns
    -------
    float
        Kt, at least 1. [1]
    """
    h = 0.5 * (shoulder - diameter)
    x, step = 2.0 * h / shoulder, h / radius
    root = math.sqrt(step)
    c1 = 0.905 + 0.783 * root - 0.075 * step
    c2 = -0.437 - 1.969 * root + 0.553 * step
    c3 = 1.557 + 1.073 * root - 0.578 * step
    c4 = -1.061 + 0.171 * root + 0.086 * step
    return max(1.0, c1 + x * (c2 + x * (c3 + x * c4)))


def keyway_concentration(diameter: float, radius: float) -> float:
    """Stress concentration of an end-milled keyway in torsion: at its end, or at its bottom, whichever is larger.

    3.4 at the end on the surface, and 1.953 + 0.1434 u − 0.0021 u², u = 0.1 d/r, in the bottom radius: largest
    principal over nominal shear stress of the round shaft, for a width of d/4, a depth of d/8, no key,
    and r/d from 0.005 to 0.07 (Pilkey, Table 6-1, IV 1, after Leven, 1949, and Peterson's chart 5.2).

    Parameters
    ----------
    diameter, radius : float
        Diameter of the shaft, and radius at the bottom of the keyway. [m]

    Returns
    -------
    float
        Kt. [1]
    """
    u = 0.1 * diameter / radius
    return max(KEYWAY_END, 1.953 + u * (0.1434 - 0.0021 * u))


def neuber_sensitivity(radius: float, uts: float) -> float:
    """Notch sensitivity of steel in torsion, q = 1/(1 + √a/√r), by Neuber with the fit of Shigley, Eq. (6-35b).

    √a = 0.190 − 2.51e−3 S + 1.35e−5 S² − 2.67e−8 S³, S = UTS in kpsi, √a in √inch.

    Parameters
    ----------
    radius, uts : float
        Radius of the notch, and ultimate tensile strength. [m, Pa]

    Returns
    -------
    float
        q. [1]
    """
    s = uts / KPSI
    root_a = 0.190 + s * (-2.51e-3 + s * (1.35e-5 - 2.67e-8 * s))
    return 1.0 / (1.0 + root_a / math.sqrt(radius / INCH))


def peterson_sensitivity(radius: float, uts: float) -> float:
    """Notch sensitivity of steel in torsion, q = 1/(1 + a/r), by Peterson.

    a = 0.6 × 0.0254 mm (2070 MPa / UTS)^1.8 (Dowling, Mechanical Behavior of Materials, with 0.6 for torsion).

    Parameters
    ----------
    radius, uts : float
        Radius of the notch, and ultimate tensile strength. [m, Pa]

    Returns
    -------
    float
        q. [1]
    """
    a = TORSION_OVER_BENDING * 2.54e-5 * float(power(2070e6 / uts, 1.8))
    return 1.0 / (1.0 + a / radius)


def fatigue_concentration(kt: float, sensitivity: float) -> float:
    """Kf = 1 + q (Kt − 1): what a notch with stress concentration Kt does to the alternating stress.

    Parameters
    ----------
    kt, sensitivity : float
        Stress concentration, and notch sensitivity q. [1]

    Returns
    -------
    float
        Kf; of q = 1 it is Kt to the bit. [1]
    """
    return kt if sensitivity == 1.0 else 1.0 + sensitivity * (kt - 1.0)
