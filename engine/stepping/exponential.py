"""The exponential step: exact for the structure, cubic in the force (`kernels/step.h`).

One mode obeys q̈ + d q̇ + λ q = u. Over a step the force is the cubic Hermite polynomial through
its values and rates at both ends; the step then is one linear map, so stiffness sets no limit on
the step and the only error is that of the force between samples, of fourth order.

The coefficients come from the free motion by recurrence where λh² is large, from φ functions where
the mode is over-damped, and from the power series of the solution where λh² is small (there the
recurrence would cancel; a rigid mode has λ = 0).

References
----------
Hochbruck & Ostermann, "Exponential integrators", Acta Numerica 19 (2010), sec. 2.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from engine.stepping.library import library, maps_of

__all__ = ["HERMITE", "exponential_step", "polynomial_step"]

Floats = NDArray[np.float64]

#: Monomial coefficients of s = t/h from (u₀, h u̇₀, u₁, h u̇₁).
HERMITE = np.array(
    [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [-3.0, -2.0, 3.0, -1.0], [2.0, 1.0, -2.0, 1.0]]
)


def polynomial_step(stiffness: Floats, rate: Floats, h: float) -> tuple[Floats, Floats]:
    """One step under a force given as a cubic in s = t/h.

    Parameters
    ----------
    stiffness : ndarray, shape (n,)
        λ. [1/s²]
    rate : ndarray, shape (n,)
        Damping coefficient d. [1/s]
    h : float
        Step. [s]

    Returns
    -------
    free : ndarray, shape (n, 2, 2)
        Map of (q, q̇). [mixed: 1, s, 1/s]
    forced : ndarray, shape (n, 2, 4)
        Map of the coefficients of s⁰…s³ to (q, q̇). [s², s]
    """
    return maps_of(library.polynomial_step, stiffness, rate, h)


def exponential_step(stiffness: Floats, rate: Floats, h: float) -> tuple[Floats, Floats]:
    """One step under a force given by its values and rates at both ends.

    Parameters
    ----------
    stiffness : ndarray, shape (n,)
        λ. [1/s²]
    rate : ndarray, shape (n,)
        Damping coefficient d. [1/s]
    h : float
        Step. [s]

    Returns
    -------
    free : ndarray, shape (n, 2, 2)
        Map of (q, q̇). [mixed: 1, s, 1/s]
    forced : ndarray, shape (n, 2, 4)
        Map of (u₀, u̇₀, u₁, u̇₁) to (q, q̇). [s², s³, s², s³ and 1/s of each]
    """
    return maps_of(library.exponential_step, stiffness, rate, h)
