"""Cycles of a history: rainflow (ASTM E1049-85), and the paper's count of Figure 3.

"The paper" is Szenasi and von Nimitz, Transient analyses of synchronous motor trains (1978).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from engine.arrays import Floats, Ints
from engine.case.choices import RainflowResidue
from engine.errors import InternalError
from engine.stepping.library import address, library


@dataclass(frozen=True, eq=False)
class CycleCount:
    """Counted cycles of one history, one entry a cycle or half cycle."""

    range: Floats  #: Peak to valley. [as the history] Shape (n_cycles,).
    mean: Floats  #: Half way between. [as the history] Shape (n_cycles,).
    count: Floats  #: 1 for a cycle, 0.5 for a half cycle. [1] Shape (n_cycles,).

    def __post_init__(self) -> None:
        for name in ("range", "mean", "count"):
            object.__setattr__(self, name, read_only(getattr(self, name)))

    @property
    def amplitude(self) -> Floats:
        """Half of each range. [as the history]"""
        return 0.5 * self.range

    def scaled(self, factor: float) -> CycleCount:
        """The count of the history times a factor.

        Parameters
        ----------
        factor : float
            Positive, such as stress over torque. [1, or the new unit over the old]

        Returns
        -------
        CycleCount
            The same cycles in the new unit. [as the factor makes it]
        """
        return CycleCount(self.range * factor, self.mean * factor, self.count)


def turning_points(history: ArrayLike) -> Floats:
    """The first and the last point of a history and the reversals between them.

    Parameters
    ----------
    history : array_like, shape (n,)
        Values in order of time; repeats and points on the way are dropped. [any unit]

    Returns
    -------
    ndarray, shape (m,)
        Alternating peaks and valleys. [as the history]

    Raises
    ------
    InternalError
        When a value is not finite.
    """
    x = np.ascontiguousarray(history, float).ravel()
    points = np.empty(len(x))
    found = library.reversals(len(x), address(x), address(points))
    if found < 0:
        raise InternalError("a history to be counted holds a value that is not finite")
    return points[:found]


def counted_history(history: ArrayLike) -> Floats:
    """The whole start as it is counted: from rest, and closed by a return to zero.

    Parameters
    ----------
    history : array_like, shape (n,)
        Turning points of the start. [any unit]

    Returns
    -------
    ndarray, shape (m,)
        Turning points from 0 to 0. [as the history]
    """
    return turning_points(np.concatenate([[0.0], np.asarray(history, float).ravel(), [0.0]]))


def count_cycles(history: ArrayLike, residue: str = RainflowResidue.HALF_CYCLES) -> CycleCount:
    """Rainflow count (ASTM E1049-85, 5.4.4, three points).

    What does not close is counted as half cycles (ASTM) or, with ``repeated``, the history is
    taken to repeat: it is rearranged to begin and end at its absolute maximum (E1049 5.4.5), which
    closes every cycle and equals AFNOR's count of the doubled residue. Nothing is prepended or
    appended here; `counted_history` does that for a start.

    Parameters
    ----------
    history : array_like, shape (n,)
        Turning points or any finer history. [any unit]
    residue : str
        ``half cycles`` or ``repeated``. [word]

    Returns
    -------
    CycleCount
        In the order in which cycles close; pairs of halves are joined when repeated. [as given]
    """
    points = turning_points(history)
    if points.size < 2:
        return CycleCount(*np.empty((3, 0)))
    if residue == RainflowResidue.REPEATED:
        top = int(np.argmax(np.abs(points)))
        points = turning_points(np.concatenate([points[top:], points[: top + 1]]))
    first, second, count = half_cycle_points(points)
    cycles = np.abs(points[first] - points[second])
    mean = 0.5 * (points[first] + points[second])
    if residue == RainflowResidue.REPEATED:
        half = count == 0.5
        joined, pairs = np.unique(
            np.array([cycles[half], mean[half]]).T, axis=0, return_counts=True
        )
        cycles = np.concatenate([cycles[~half], joined[:, 0]])
        mean = np.concatenate([mean[~half], joined[:, 1]])
        count = np.concatenate([count[~half], 0.5 * pairs])
    return CycleCount(cycles, mean, count)


def half_cycle_points(points: ArrayLike) -> tuple[Ints, Ints, Floats]:
    """Which turning points each rainflow cycle lies between: what a count is differentiated by.

    Parameters
    ----------
    points : array_like, shape (n,)
        Turning points, as `turning_points` gives them; residue as half cycles. [any unit]

    Returns
    -------
    first, second : ndarray of int, shape (n_cycles,)
        Indices of the two ends. [indices]
    count : ndarray, shape (n_cycles,)
        1 for a cycle, 0.5 for a half cycle. [1]
    """
    x = np.ascontiguousarray(points, float)
    first, second, room = np.empty((3, len(x)), dtype=np.int64)
    count = np.empty(len(x))
    ends = (address(a, "int64_t") for a in (first, second))
    found = library.rainflow(len(x), address(x), *ends, address(count), address(room, "int64_t"))
    return first[:found], second[:found], count[:found]


def paper_count(history: ArrayLike) -> CycleCount:
    """The paper's count, cycle by cycle (Figure 3): each turning point to the next is half a cycle.

    The paper prints no rule beyond "for each cycle"; here each successive range counts one half
    cycle of amplitude range/2. It sees the vibration but not the slow rise and fall under it,
    which rainflow counts as the largest cycle. On a free decay about zero it equals the ASTM count.
    The other reading, one whole cycle of its own amplitude for each positive peak, is not taken:
    it gives 13 % more damage in the free decay of validation case A10, which has both.

    Parameters
    ----------
    history : array_like, shape (n,)
        Turning points or any finer history. [any unit]

    Returns
    -------
    CycleCount
        One half cycle between each two turning points, in order of time. [as given]
    """
    points = turning_points(history)
    ranges = np.abs(np.diff(points))
    return CycleCount(ranges, 0.5 * (points[1:] + points[:-1]), np.full(ranges.shape, 0.5))


def read_only(values: ArrayLike) -> Floats:
    """A copy that cannot be written to.

    Parameters
    ----------
    values : array_like
        Numbers. [any unit]

    Returns
    -------
    ndarray
        The same. [as given]
    """
    copy = np.array(values, float)
    copy.setflags(write=False)
    return copy
