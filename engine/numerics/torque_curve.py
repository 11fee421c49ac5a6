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

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from engine.arrays import Floats
from engine.stepping.library import address, library

#: How often `fitted_curves` halves an interval: 33 points come to a millionth of synchronous speed. [count]
HALVINGS = 15


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

    def piece(self, fraction: Floats, within: Floats) -> tuple[Floats, Floats]:
        """Torque and slope of the cubics that hold at other fractions: at a knot, of the side that is meant.

        Parameters
        ----------
        fraction : ndarray, shape (n,)
            Fractions of synchronous speed. [1]
        within : ndarray, shape (n,)
            A fraction in each interval that is meant. [1]

        Returns
        -------
        torque, slope : ndarray, shape (n,)
            Torque and its derivative with the fraction. [N m]
        """
        i = np.searchsorted(self.knots, within, side="right") - 1
        held = self.cubic[0] * [1.0, 0.0, 0.0, 0.0]
        a, b, c, d = np.where((i < 0)[:, None], held, self.cubic[i]).T
        s = fraction - self.knots[i]
        return a + s * (b + s * (c + s * d)), b + s * (2.0 * c + s * 3.0 * d)

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


def joined(first: TorqueCurve, second: TorqueCurve, at: float, width: float) -> TorqueCurve:
    """A curve that goes over from one to another.

    Parameters
    ----------
    first, second : TorqueCurve
        Below and above. [N m]
    at : float
        Where the first ends. [1]
    width : float
        Where the second begins, above that; smooth between. [1]

    Returns
    -------
    TorqueCurve
        With the knots of both. [N m]
    """
    begins = at + width
    (a, of_a), (b, of_b) = (
        (float(torque[0]), float(slope[0]))
        for torque, slope in (
            curve.piece(np.array([x]), np.array([x]))
            for curve, x in ((first, at), (second, begins))
        )
    )
    chord = (b - a) / width
    between = [
        a,
        of_a,
        (3.0 * chord - 2.0 * of_a - of_b) / width,
        (of_a + of_b - 2.0 * chord) / (width * width),
    ]
    i = int(np.searchsorted(second.knots, begins, side="right")) - 1
    held = np.array([second.cubic[0, 0], 0.0, 0.0, 0.0])
    c = held if i < 0 else second.cubic[i]
    s = 0.0 if i < 0 else begins - float(second.knots[i])
    shifted = [b, of_b, c[2] + 3.0 * s * c[3], c[3]]
    below, above = first.knots < at, second.knots > begins
    return TorqueCurve(
        np.concatenate([first.knots[below], [at, begins], second.knots[above]]),
        np.concatenate([first.cubic[below], [between, shifted], second.cubic[above]]),
    )


def fitted_curves(
    exact: Callable[[Floats, Floats], tuple[Floats, Floats]], knots: Floats, allowed: float
) -> tuple[TorqueCurve, ...]:
    """Curves of torques that are known as formulas, smooth between knots.

    Intervals are halved until the cubics through values and slopes at their ends meet the formulas in
    their middle.

    Parameters
    ----------
    exact : callable
        Fractions of synchronous speed, and the middle of the interval that is meant, both of shape (n,) →
        torques and slopes, both of shape (n_curves, n). [1, N m]
    knots : ndarray, shape (n,)
        First ends of intervals, rising, two or more. [1]
    allowed : float
        Error allowed in the middle. [N m]

    Returns
    -------
    tuple of TorqueCurve
        On the same knots, held constant outside. [N m]
    """
    left, right = knots[:-1], knots[1:]
    starts, cubics = [], []
    for halving in range(HALVINGS + 1):
        middle, width = 0.5 * (left + right), right - left
        (a, of_a), (b, of_b) = exact(left, middle), exact(right, middle)
        chord = (b - a) / width
        cubic = np.stack(
            [
                a,
                of_a,
                (3.0 * chord - 2.0 * of_a - of_b) / width,
                (of_a + of_b - 2.0 * chord) / (width * width),
            ],
            axis=2,
        )
        error = 0.5 * (a + b) + 0.125 * width * (of_a - of_b) - exact(middle, middle)[0]
        wrong = (np.max(np.abs(error), axis=0) > allowed) & (halving < HALVINGS)
        starts.append(left[~wrong])
        cubics.append(cubic[:, ~wrong])
        left, right, middle = left[wrong], right[wrong], middle[wrong]
        left, right = np.concatenate([left, middle]), np.concatenate([middle, right])
        if not len(left):
            break
    x = np.concatenate(starts)
    order = np.argsort(x)
    ends, _ = exact(knots[-1:], knots[-1:])
    x = np.append(x[order], knots[-1])
    rows = np.concatenate(cubics, axis=1)[:, order]
    last = np.zeros((len(rows), 1, 4))
    last[:, 0, 0] = ends[:, 0]
    return tuple(TorqueCurve(x, c.copy()) for c in np.concatenate([rows, last], axis=1))
