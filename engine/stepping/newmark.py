"""The paper's average-acceleration method (Newmark β = ¼), in modal coordinates (`kernels/step.h`).

Equations (1) to (4) of Szenasi & von Nimitz (1978) are linear in [J], [C], [K], so writing them
mode by mode gives the same numbers as writing them for the angles, without integrating angles
of a thousand radians. Equation (4) is derived from (1) to (3), not copied: as printed, its second
term repeats the velocity where the acceleration of eq. (3) belongs. Derived,

    (J + h/2 C + h²/4 K) θ̈₁ = T₁ − C (θ̇₀ + h/2 θ̈₀) − K (θ₀ + h θ̇₀ + h²/4 θ̈₀).

With θ̈₀ = T₀ − C θ̇₀ − K θ₀ from eq. (1) the step is a linear map of (q, q̇) and (u₀, u₁). For one
mode, with g = 1 + hd/2 + h²λ/4, inserting (4) into (2) and (3) leaves

    q₁ = [(1 + hd/2 − h²λ/4) q₀ + h q̇₀ + h²/4 (u₀ + u₁)] / g
    q̇₁ = [−hλ q₀ + (1 − hd/2 − h²λ/4) q̇₀ + h/2 (u₀ + u₁)] / g.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from engine.stepping.library import library, maps_of

__all__ = ["newmark_step"]

Floats = NDArray[np.float64]


def newmark_step(stiffness: Floats, rate: Floats, h: float) -> tuple[Floats, Floats]:
    """One average-acceleration step in the form of `exponential_step`.

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
        Map of (u₀, u̇₀, u₁, u̇₁) to (q, q̇); the rates have no weight. [s², s]
    """
    return maps_of(library.newmark_step, stiffness, rate, h)
