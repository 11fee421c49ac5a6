"""The paper's average-acceleration method (Newmark β = ¼), in modal coordinates.

Equations (1) to (4) of Szenasi & von Nimitz (1978) are linear in [J], [C], [K], so writing them
mode by mode gives the same numbers as writing them for the angles, without integrating angles
of a thousand radians. Equation (4) is derived from (1) to (3), not copied: as printed, its second
term repeats the velocity where the acceleration of eq. (3) belongs. Derived,

    (J + h/2 C + h²/4 K) θ̈₁ = T₁ − C (θ̇₀ + h/2 θ̈₀) − K (θ₀ + h θ̇₀ + h²/4 θ̈₀).

With θ̈₀ = T₀ − C θ̇₀ − K θ₀ from eq. (1) the step is a linear map of (q, q̇) and (u₀, u₁).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

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
    weight = 1.0 / (1.0 + 0.5 * h * rate + 0.25 * h * h * stiffness)
    free, forced = np.zeros((len(weight), 2, 2)), np.zeros((len(weight), 2, 4))
    # columns: q0, v0, u0, u1
    start = np.zeros((4, len(weight)))
    start[0], start[1], start[2] = -stiffness, -rate, 1.0  # a0 = u0 − d v0 − λ q0
    end = np.zeros((4, len(weight)))
    end[0] = -stiffness
    end[1] = -rate - h * stiffness
    end[3] = 1.0
    end += -(0.5 * h * rate + 0.25 * h * h * stiffness) * start
    end *= weight
    position = 0.25 * h * h * (start + end)
    position[0] += 1.0
    position[1] += h
    velocity = 0.5 * h * (start + end)
    velocity[1] += 1.0
    for row, value in enumerate((position, velocity)):
        free[:, row, 0], free[:, row, 1] = value[0], value[1]
        forced[:, row, 0], forced[:, row, 2] = value[2], value[3]
    return free, forced
