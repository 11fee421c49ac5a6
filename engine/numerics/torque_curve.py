"""A torque against speed, as a smooth curve through the points typed.

Monotone piecewise cubic (PCHIP, Fritsch & Carlson 1980): it never overshoots the points, has a
continuous slope, and is held constant outside them. The slopes are those of scipy's
`PchipInterpolator`, and tests compare the two; importing it would cost a fifth of a second of each
run, for a dozen lines.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from engine.arrays import Floats


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
        x = np.minimum(np.maximum(fraction, self.knots[0]), self.knots[-1])
        i = self.knots.searchsorted(x, side="right") - 1
        s, c = x - self.knots[i], self.cubic[i]
        return np.asarray(
            c[..., 0] + s * (c[..., 1] + s * (c[..., 2] + s * c[..., 3])), dtype=np.float64
        )

    @property
    def steepest(self) -> float:
        """Largest change of torque over that of the fraction of synchronous speed. [N m]"""
        if len(self.knots) < 2:
            return 0.0
        _, b, c, d = self.cubic[:-1].T
        width = np.diff(self.knots)
        bends = d != 0.0
        turn = -c / np.where(bends, 3.0 * d, 1.0)  # slope is a parabola
        turn = np.where(bends & (turn > 0.0), np.minimum(turn, width), 0.0)
        inside, ends = (b + s * (2.0 * c + 3.0 * d * s) for s in (turn, width))
        return float(np.abs([b, inside, ends]).max())

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
    cubic = np.zeros((len(fraction), 4))
    if len(fraction) > 1:
        x, y = np.asarray(fraction, dtype=float), np.asarray(torque, dtype=float)
        width, slope = np.diff(x), pchip_slopes(x, y)
        chord = np.diff(y) / width
        bend = (slope[:-1] + slope[1:] - 2.0 * chord) / width
        cubic[:-1, 0] = y[:-1]
        cubic[:-1, 1] = slope[:-1]
        cubic[:-1, 2] = (chord - slope[:-1]) / width - bend
        cubic[:-1, 3] = bend / width
    cubic[-1, 0] = torque[-1]
    return TorqueCurve(np.asarray(fraction, dtype=float), cubic)


def pchip_slopes(x: Floats, y: Floats) -> Floats:
    """Slopes at points, such that the cubics between them rise and fall only where the points do.

    Inside: zero at an extreme, else the harmonic mean of the neighbouring chords, weighted by
    their lengths (Fritsch & Butland, SIAM J. Sci. Stat. Comput. 5 (1984), 300). At the ends: the
    three-point formula, limited (Moler, Numerical computing with MATLAB, 2004, section 3.6).

    Parameters
    ----------
    x : ndarray, shape (n,)
        Rising; at least two. [1]
    y : ndarray, shape (n,)
        Value at each. [N m]

    Returns
    -------
    ndarray, shape (n,)
        dy/dx at each. [N m]
    """
    width = np.diff(x)
    chord = np.diff(y) / width
    if len(x) == 2:
        return np.repeat(chord, 2)
    slope = np.zeros(len(x))
    inner = np.flatnonzero(np.sign(chord[:-1]) * np.sign(chord[1:]) > 0.0)
    w_before, w_after = 2.0 * width[inner + 1] + width[inner], width[inner + 1] + 2.0 * width[inner]
    mean = (w_before / chord[inner] + w_after / chord[inner + 1]) / (w_before + w_after)
    slope[inner + 1] = 1.0 / mean
    slope[0] = _end_slope(*width[:2], *chord[:2])
    slope[-1] = _end_slope(*width[:-3:-1], *chord[:-3:-1])
    return slope


def _end_slope(width: float, next_width: float, chord: float, next_chord: float) -> float:
    slope = ((2.0 * width + next_width) * chord - width * next_chord) / (width + next_width)
    if np.sign(slope) != np.sign(chord):
        return 0.0
    if np.sign(chord) != np.sign(next_chord) and abs(slope) > 3.0 * abs(chord):
        return 3.0 * chord
    return slope
