"""The exponential step: exact for the structure, cubic in the force.

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

import math

import numpy as np
from numpy.typing import NDArray

__all__ = ["HERMITE", "exponential_step", "free_motion", "polynomial_step"]

Floats = NDArray[np.float64]

#: Monomial coefficients of s = t/h from (u₀, h u̇₀, u₁, h u̇₁).
HERMITE = np.array(
    [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [-3.0, -2.0, 3.0, -1.0], [2.0, 1.0, -2.0, 1.0]]
)

_FACTORIAL = np.array([1.0, 1.0, 2.0, 6.0])
#: Up to this λh² the power series is used, with so many terms.
SMALL, TERMS = 4.0, 40


def _roots(L: Floats, a: Floats) -> tuple[Floats, Floats]:
    """Magnitudes of the slow and the fast real exponent where a² > L (a = dh/2), else a and a."""
    gamma = np.sqrt(np.maximum(a * a - L, 0.0))
    fast = a + gamma  # the slow one without cancellation: L / fast
    return np.where(fast > 0.0, L / np.where(fast > 0.0, fast, 1.0), 0.0), fast


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
    beta = np.sqrt(np.maximum(L - a * a, 0.0))
    gamma = np.sqrt(np.maximum(a * a - L, 0.0))
    decay, gentle = np.exp(-a), np.minimum(gamma, 1.0)
    # one branch of each pair is trivial: β = 0 over-damped, γ = 0 under-damped
    cosine = decay * np.cos(beta) * np.cosh(gentle)
    bend = np.where(gentle > 0.0, np.sinh(gentle) / np.where(gentle > 0.0, gentle, 1.0), 1.0)
    sine = decay * np.sinc(beta / np.pi) * bend
    out = np.empty((len(L), 2, 2))
    out[:, 0, 0] = cosine + a * sine
    out[:, 0, 1] = sine
    out[:, 1, 0] = -L * sine
    out[:, 1, 1] = cosine - a * sine
    apart = gamma >= 1.0  # two real exponentials that do not cancel
    if np.any(apart):
        slow, fast = _roots(L[apart], a[apart])
        late, early = np.exp(-slow), np.exp(-fast)
        gap = fast - slow
        out[apart, 0, 0] = (fast * late - slow * early) / gap
        out[apart, 0, 1] = (late - early) / gap
        out[apart, 1, 0] = -L[apart] * (late - early) / gap
        out[apart, 1, 1] = (fast * early - slow * late) / gap
    return out


def _large(L: Floats, D: Floats, free: Floats) -> Floats:
    """Response to s⁰…s³ from rest where L = λh² is not small, shape (n, 2, 4).

    The equation itself links the responses x_j to s^j / j!: x_{j−2} + D x_{j−1} + L x_j = 1 / j!,
    with x_{−1}, x_{−2} the response to an impulse and its rate.
    """
    before, last = free[:, 1, 1], free[:, 0, 1]
    response = np.zeros((len(L), 2, 4))
    for j in range(4):
        response[:, 1, j] = _FACTORIAL[j] * last
        before, last = last, (1.0 / _FACTORIAL[j] - D * last - before) / L
        response[:, 0, j] = _FACTORIAL[j] * last
    return response


def _overdamped(L: Floats, D: Floats) -> Floats:
    """The same for two real exponents well apart, from φ functions, shape (n, 2, 4).

    The response to s^j / j! is the divided difference of exp over (0, …, 0, μ₁, μ₂), that is
    (φ_{j+1}(μ₁) − φ_{j+1}(μ₂)) / (μ₁ − μ₂); φ falls with |μ|, so nothing cancels.
    """
    slow, fast = _roots(L, 0.5 * D)
    difference = (_phi(slow) - _phi(fast)) / (fast - slow)
    response = np.empty((len(L), 2, 4))
    response[:, 0] = (difference[1:] * _FACTORIAL[:, None]).T
    response[:, 1] = (difference[:-1] * _FACTORIAL[:, None]).T
    return response


def _phi(x: Floats) -> Floats:
    """φ₀ … φ₄ at −x for x ≥ 0, shape (5, n): φ₀ = exp, φ_{k+1}(z) = (φ_k(z) − 1/k!) / z."""
    out = np.empty((5, len(x)))
    out[0] = np.exp(-x)
    safe = np.maximum(x, 1.0)
    for k in range(4):
        out[k + 1] = (1.0 / _FACTORIAL[k] - out[k]) / safe
    near = x < 1.0
    z = -x[near]
    for k in range(1, 5):
        term = np.full(len(z), 1.0 / math.factorial(k))
        total = term.copy()
        for n in range(1, 20):
            term = term * z / (k + n)
            total += term
        out[k, near] = total
    return out


def _small(L: Floats, D: Floats) -> Floats:
    """The same where L is small, by the power series of the solution, shape (n, 2, 4).

    With L ≤ 4 and D² / 4 − L < 1 the series converges within TERMS terms, and its largest term
    exceeds the sum by less than two digits. (A batched matrix exponential gives the same and
    costs a thousand small calls into threaded linear algebra.)
    """
    response = np.zeros((2, 4, len(L)))
    before, last = np.zeros((4, len(L))), np.zeros((4, len(L)))  # of s^k and s^(k+1), a row a force
    for k in range(TERMS):
        new = -D * (k + 1) * last - L * before
        if k < 4:
            new[k] += 1.0
        new /= (k + 2) * (k + 1)
        response[0] += new
        response[1] += (k + 2) * new
        before, last = last, new
    return response.transpose(2, 0, 1)


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
    apart = 0.25 * D * D - L >= 1.0
    large = (L > SMALL) & ~apart
    small = ~large & ~apart
    response = np.empty((len(L), 2, 4))
    if np.any(large):
        response[large] = _large(L[large], D[large], free[large])
    if np.any(apart):
        response[apart] = _overdamped(L[apart], D[apart])
    if np.any(small):
        response[small] = _small(L[small], D[small])
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
