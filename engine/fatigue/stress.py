"""Nominal stress of a shaft section, and the maximum shear theory. Torque in N m, stress in Pa."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from engine.arrays import Floats
from engine.case.data import ElementRow
from engine.errors import ModelError
from engine.numerics.same_bits import fourth

#: Torsional over bending strength: the maximum shear theory, as the paper takes it. [1]
BENDING_TO_TORSION = 0.5
#: Shear yield over tensile yield: the maximum shear theory. [1]
SHEAR_YIELD_RATIO = 0.5


def shear_stress(torque: ArrayLike, diameter: float, bore: float = 0.0) -> Floats:
    """Nominal shear stress at the surface of a round shaft, 16 T D / (π (D⁴ − d⁴)).

    Parameters
    ----------
    torque : array_like
        Torque at the shaft's own speed; the stress takes its sign. [N m]
    diameter, bore : float
        Outer and inner diameter of the judged section. [m]

    Returns
    -------
    ndarray
        Stress, without any concentration factor. [Pa]

    Raises
    ------
    ModelError
        When the bore is negative or not smaller than the diameter.
    """
    if not 0.0 <= bore < diameter:
        raise ModelError(
            f"Stress diameter is {diameter:.6g} m with a bore of {bore:.6g} m; the diameter must "
            "be positive and the bore smaller than it. Correct one of them."
        )
    D, d = diameter, bore
    return np.asarray(torque, float) * (16.0 * D / (math.pi * (fourth(D) - fourth(d))))


def stress_of_unit_torque(element: ElementRow) -> float:
    """Nominal shear stress of an element over its torque, without any concentration factor.

    Parameters
    ----------
    element : ElementRow
        A shaft with its stress diameter; a blank bore is none. [m]

    Returns
    -------
    float
        Stress of 1 N m. [Pa/(N m)]

    Raises
    ------
    ModelError
        When it has no stress diameter, or a bore that is not smaller.
    """
    return float(shear_stress(1.0, element.stress_diameter or 0.0, element.stress_bore or 0.0))


def in_megapascals(stress: float) -> str:
    """A stress as a sentence names it.

    Parameters
    ----------
    stress : float
        The stress. [Pa]
    """
    return f"{stress / 1e6:.4g} MPa ({stress / 6894757.293168361:.4g} ksi)"
