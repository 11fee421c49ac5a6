"""Each number once: what `numpy.unique` gives, without the masked arrays that it loads."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike


def distinct(*values: ArrayLike) -> Any:
    """The numbers of some arrays, each once, rising.

    Parameters
    ----------
    *values : array_like, shape (n,)
        Numbers, none of them NaN. [any]

    Returns
    -------
    ndarray, shape (n_distinct,)
        The same numbers. [any]
    """
    rising = np.sort(np.concatenate(values))
    return rising[np.append(True, rising[1:] != rising[:-1])] if len(rising) else rising
