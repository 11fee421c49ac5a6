"""Mean stress of a cycle: the reversed cycle that damages as much."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from engine.arrays import Floats

#: Ultimate strength in torsion over that in tension (Joerres; Shigley, 9th edition, Eq. 6-54). [1]
SHEAR_ULTIMATE_RATIO = 0.67
#: What a mean near the ultimate strength leaves at least for the amplitude: a life far below one cycle. [1]
LEAST_LEFT = 1e-3


def reversed_amplitude(amplitude: ArrayLike, mean: ArrayLike, ultimate: float | None) -> Floats:
    """Amplitude of the reversed cycle that damages as a cycle about a mean, by Goodman.

    S = Sa / (1 − |Sm| / Ssu) (Shigley, 9th edition, page 347). The sign of a mean shear stress makes no difference. Where
    the mean reaches the ultimate strength, where Goodman allows nothing, it is at least that strength.

    Parameters
    ----------
    amplitude, mean : array_like
        Of each cycle, with Kf. [Pa]
    ultimate : float or None
        Ultimate strength in torsion; None: the mean is ignored. [Pa]

    Returns
    -------
    ndarray
        Equivalent amplitudes; those given, to the bit, where the mean is ignored. [Pa]
    """
    a = np.asarray(amplitude, float)
    if ultimate is None:
        return a
    share = np.abs(np.asarray(mean, float)) / ultimate
    found = a / np.maximum(1.0 - share, LEAST_LEFT)
    return np.asarray(np.where(share >= 1.0, np.maximum(found, ultimate), found))
