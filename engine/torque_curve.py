"""A torque against speed, as a smooth curve through the points typed.

Monotone piecewise cubic (PCHIP, Fritsch & Carlson 1980, as in scipy): it never overshoots the
points, has a continuous slope, and is held constant outside them.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import PchipInterpolator

__all__ = ["TorqueCurve", "torque_curve"]

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class TorqueCurve:
    """Torque against the fraction of synchronous speed.

    Parameters
    ----------
    knots : ndarray, shape (n,)
        Fraction of synchronous speed. [1]
    cubic : ndarray, shape (n, 4)
        Coefficients of powers of (x − knot) from each knot on; the last row is the end value. [N m]
    """

    knots: Floats
    cubic: Floats

    def __call__(self, fraction: Floats | float) -> Floats:
        """Torque at a fraction of synchronous speed.

        Parameters
        ----------
        fraction : float or ndarray
            Fraction of synchronous speed. [1]

        Returns
        -------
        ndarray
            Torque. [N m]
        """
        x = np.clip(np.asarray(fraction, dtype=float), self.knots[0], self.knots[-1])
        i = np.clip(np.searchsorted(self.knots, x, side="right") - 1, 0, len(self.knots) - 1)
        s, c = x - self.knots[i], self.cubic[i]
        return np.asarray(
            c[..., 0] + s * (c[..., 1] + s * (c[..., 2] + s * c[..., 3])), dtype=np.float64
        )


def torque_curve(fraction: Floats, torque: Floats) -> TorqueCurve:
    """Curve through points.

    Parameters
    ----------
    fraction : ndarray, shape (n,)
        Fractions of synchronous speed, rising. [1]
    torque : ndarray, shape (n,)
        Torque at each. [N m]

    Returns
    -------
    TorqueCurve
        The curve; one point makes a constant. [N m]
    """
    cubic = np.zeros((len(fraction), 4))
    if len(fraction) > 1:
        cubic[:-1] = PchipInterpolator(fraction, torque).c[::-1].T
    cubic[-1, 0] = torque[-1]
    return TorqueCurve(np.asarray(fraction, dtype=float), cubic)
