"""The exponential step: exact for the structure, cubic in the force.

One mode obeys q̈ + d q̇ + λ q = u. Over a step the force is the cubic Hermite polynomial through
its values and rates at both ends; the step then is one linear map, so stiffness sets no limit on
the step and the only error is that of the force between samples, of fourth order.

The coefficients come from the particular polynomial solution plus the free motion where λh² is
large, and from a 6 × 6 matrix exponential where it is small (there the polynomial solution would
cancel; a rigid mode has λ = 0).

References
----------
Hochbruck & Ostermann, "Exponential integrators", Acta Numerica 19 (2010), sec. 2; Van Loan,
"Computing integrals involving the matrix exponential", IEEE Trans. AC-23 (1978) 395-404.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm

__all__ = ["HERMITE", "exponential_step", "free_motion", "polynomial_step"]

Floats = NDArray[np.float64]

#: Monomial coefficients of s = t/h from (u₀, h u̇₀, u₁, h u̇₁).
HERMITE = np.array(
    [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [-3.0, -2.0, 3.0, -1.0], [2.0, 1.0, -2.0, 1.0]]
)


def free_motion(stiffness: Floats, rate: Floats, h: float) -> Floats:
    """Free motion of each mode over one step.

    Parameters
    ----------
    stiffness : ndarray, shape (n,)
        λ = ω². [1/s²]
    rate : ndarray, shape (n,)
        Damping coefficient d. [1/s]
    h : float
        Step. [s]

    Returns
    -------
    ndarray, shape (n, 2, 2)
        Map of (q, h q̇) at the start to (q, h q̇) at the end. [1]
    """
    L, a = stiffness * h * h, 0.5 * rate * h
    under = L >= a * a
    beta = np.sqrt(np.where(under, L - a * a, 0.0))
    gamma = np.sqrt(np.where(under, 0.0, a * a - L))
    # over-damped: γ − a = −L/(γ + a) keeps the slow exponent's digits
    slow = np.exp(-L / np.where(gamma + a > 0.0, gamma + a, 1.0))
    fast = np.exp(-(gamma + a))
    cosine = np.where(under, np.exp(-a) * np.cos(beta), 0.5 * (slow + fast))
    sine = np.where(
        under,
        np.exp(-a) * np.sinc(beta / np.pi),
        0.5 * (slow - fast) / np.where(gamma > 0.0, gamma, 1.0),
    )
    out = np.empty((len(L), 2, 2))
    out[:, 0, 0] = cosine + a * sine
    out[:, 0, 1] = sine
    out[:, 1, 0] = -L * sine
    out[:, 1, 1] = cosine - a * sine
    return out


def _large(L: Floats, D: Floats, free: Floats) -> Floats:
    """Response to s⁰…s³ from rest where L = λh² is not small, shape (n, 2, 4)."""
    response = np.zeros((len(L), 2, 4))
    for j in range(4):
        a = np.zeros((5 + 1, len(L)))  # particular polynomial a₀ + a₁ s + a₂ s² + a₃ s³
        for i in range(3, -1, -1):
            right = (1.0 if i == j else 0.0) - D * (i + 1) * a[i + 1] - (i + 2) * (i + 1) * a[i + 2]
            a[i] = right / L
        end = a[0] + a[1] + a[2] + a[3]
        slope = a[1] + 2.0 * a[2] + 3.0 * a[3]
        response[:, 0, j] = end - free[:, 0, 0] * a[0] - free[:, 0, 1] * a[1]
        response[:, 1, j] = slope - free[:, 1, 0] * a[0] - free[:, 1, 1] * a[1]
    return response


def _small(L: Floats, D: Floats) -> Floats:
    """The same where L is small, by the augmented exponential, shape (n, 2, 4)."""
    A = np.zeros((len(L), 6, 6))
    A[:, 0, 1] = 1.0
    A[:, 1, 0] = -L
    A[:, 1, 1] = -D
    A[:, 1, 2] = 1.0  # state 2 is the force, 3 to 5 its scaled derivatives
    for i in range(3):
        A[:, 2 + i, 3 + i] = 1.0
    factorial = np.array([1.0, 1.0, 2.0, 6.0])
    return np.asarray(expm(A)[:, :2, 2:] * factorial)


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
    L, D = stiffness * h * h, rate * h
    free = free_motion(stiffness, rate, h)
    large = np.maximum(L, 1e-300) > 0.5
    response = np.empty((len(L), 2, 4))
    if np.any(large):
        response[large] = _large(L[large], D[large], free[large])
    if np.any(~large):
        response[~large] = _small(L[~large], D[~large])
    free[:, 0, 1] *= h
    free[:, 1, 0] /= h
    response[:, 0] *= h * h
    response[:, 1] *= h
    return free, response


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
    free, forced = polynomial_step(stiffness, rate, h)
    hermite = HERMITE * np.array([1.0, h, 1.0, h])
    return free, forced @ hermite
