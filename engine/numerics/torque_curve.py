"""A torque against speed, as a smooth curve through the points typed.

Monotone piecewise cubic (PCHIP, Fritsch & Carlson 1980): it never overshoots the points, has a
continuous slope, and is held constant outside them. Slopes inside are zero at an extreme, else the
harmonic mean of the neighbouring chords, weighted by their lengths (Fritsch & Butland, SIAM J. Sci.
Stat. Comput. 5 (1984), 300); at the ends those of the three-point formula, limited (Moler, Numerical
computing with MATLAB, 2004, section 3.6). They are those of scipy's `PchipInterpolator`, and tests
compare the two; importing it would cost a fifth of a second of each run. The numbers are made in
`kernels/curves.c`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from engine.arrays import Floats
from engine.stepping.library import address, library


@dataclass(frozen=True, eq=False)
class TorqueCurve:
    """Torque against the fraction of synchronous speed."""

    knots: Floats  #: Fraction of synchronous speed. [1] Shape (n,).
    #: Coefficients of powers of (x − knot) from each knot on; the last row is the end value. [N m]
    #: Shape (n, 4).
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
        x = np.asarray(fraction, dtype=np.float64, order="C")
        torque = np.empty(x.shape)
        knots, cubic = address(self.knots), address(self.cubic)
        library.curve_values(len(self.knots), knots, cubic, x.size, address(x), address(torque))
        return torque

    def scaled(self, factor: float) -> TorqueCurve:
        """The curve with every torque multiplied by a factor. [N m]

        Parameters
        ----------
        factor : float
            Factor. [1]
        """
        return TorqueCurve(self.knots, factor * self.cubic)

    def slope(self, fraction: float) -> float:
        """Slope at a fraction of synchronous speed; zero outside the points. [N m]

        Parameters
        ----------
        fraction : float
            Fraction of synchronous speed. [1]
        """
        if not self.knots[0] <= fraction < self.knots[-1]:
            return 0.0
        i = int(np.searchsorted(self.knots, fraction, side="right")) - 1
        s = fraction - float(self.knots[i])
        _, b, c, d = self.cubic[i].tolist()
        return float(b + s * (2.0 * c + 3.0 * s * d))

    @property
    def steepest(self) -> float:
        """Largest change of torque over that of the fraction of synchronous speed. [N m]"""
        return float(
            library.curve_steepest(len(self.knots), address(self.knots), address(self.cubic))
        )

    @property
    def range(self) -> float:
        """Largest less smallest torque of its points. [N m]"""
        return float(np.ptp(self.cubic[:, 0]))


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
    x, y = (np.array(values, dtype=np.float64) for values in (fraction, torque))
    cubic = np.empty((len(x), 4))
    library.curve_through(len(x), address(x), address(y), address(cubic))
    return TorqueCurve(x, cubic)


def curve_with_slopes(fraction: Floats, torque: Floats, slope: Floats) -> TorqueCurve:
    """Curve through points with given slopes there, for a torque that is known as a formula.

    Parameters
    ----------
    fraction : ndarray, shape (n,)
        Fractions of synchronous speed, rising. [1]
    torque : ndarray, shape (n,)
        Torque at each. [N m]
    slope : ndarray, shape (n,)
        Its derivative with the fraction. [N m]

    Returns
    -------
    TorqueCurve
        The cubic of each interval (Hermite), held constant outside. [N m]
    """
    cubic = np.zeros((len(fraction), 4))
    cubic[:, 0] = torque
    width = np.diff(fraction)
    chord = np.diff(torque) / width
    cubic[:-1, 1] = slope[:-1]
    cubic[:-1, 2] = (3.0 * chord - 2.0 * slope[:-1] - slope[1:]) / width
    cubic[:-1, 3] = (slope[:-1] + slope[1:] - 2.0 * chord) / (width * width)
    return TorqueCurve(np.array(fraction, dtype=np.float64), cubic)
