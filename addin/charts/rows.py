"""Rows of chart tables: columns side by side, few digits, few points and no lost peak."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from itertools import zip_longest

import numpy as np
from numpy.typing import NDArray

from engine.numerics.distinct import distinct

Cell = float | int | str | None
Rows = list[list[Cell]]
Floats = NDArray[np.float64]

#: Most rows of a drawn history: the least and the largest value of each of half as many intervals.
HISTORY_POINTS = 1001


def side_by_side(columns: Iterable[Sequence[Cell]]) -> Rows:
    """Columns of unequal length as rows; at least one row."""
    lists = [list(column) for column in columns]
    rows: Rows = [list(row) for row in zip_longest(*lists)]
    return rows or [[None] * len(lists)]


def plain(values: Iterable[float]) -> list[Cell]:
    """Numbers of a chart: six digits are more than a chart shows, and keep the file small."""
    numbers = values.tolist() if isinstance(values, np.ndarray) else list(values)
    if not all(map(math.isfinite, numbers)):
        return [float(f"{value:.6g}") if math.isfinite(value) else None for value in numbers]
    # All in one go: a format string for each costs twice the time.
    return list(map(float, ("%.6g " * len(numbers) % tuple(numbers)).split()))


def decimate(time: Floats, value: Floats, limit: int = HISTORY_POINTS) -> NDArray[np.int64]:
    """Indices that keep the picture of a history: extremes of equal intervals of time.

    With intervals no wider than a pixel or two the drawn band is that of all points: bursts keep
    their envelope, no peak is lost, and every point drawn is calculated.

    Parameters
    ----------
    time : ndarray, shape (n_times,)
        Rising. [s]
    value : ndarray, shape (n_times,)
        The history. [any]
    limit : int
        Most indices returned. [count]

    Returns
    -------
    ndarray of int
        Rising indices, the first, the last and the global extremes among them.
    """
    n = time.size
    if n <= limit:
        return np.arange(n)
    if limit < 4:  # no room for both extremes between the ends
        return distinct([0, int(np.argmax(np.abs(value))), n - 1])
    intervals = max(1, limit // 2 - 1)
    edges = np.searchsorted(time, np.linspace(time[0], time[-1], intervals + 1))
    begins = distinct(edges[:-1])  # an interval without a point has none of its own
    least, largest = np.minimum.reduceat(value, begins), np.maximum.reduceat(value, begins)
    interval = np.repeat(np.arange(begins.size), np.diff(begins, append=n))
    ends = [np.array([0, n - 1])]
    for extreme in (least, largest):
        at = np.flatnonzero(value == extreme[interval])
        own = interval[at]
        ends.append(at[np.flatnonzero(np.diff(own, prepend=-1))])  # the first one of each interval
    return distinct(*ends)


def thinned(time: Floats, value: Floats, limit: int) -> NDArray[np.int64]:
    """Indices of a smooth curve at equal steps of time, its turning points among them.

    `decimate` would keep two points of every interval, which on a rising curve nearly coincide.

    Parameters
    ----------
    time : ndarray, shape (n_times,)
        Rising. [s]
    value : ndarray, shape (n_times,)
        The curve. [any]
    limit : int
        Most indices returned, 3 or more. [count]

    Returns
    -------
    ndarray of int
        Rising indices, the first and the last among them.
    """
    n = time.size
    if n <= limit:
        return np.arange(n)
    rises = np.sign(np.diff(value))
    turning = np.flatnonzero(rises[1:] * rises[:-1] < 0.0) + 1
    if turning.size > limit // 2:  # it swings: what counts is the band between its extremes
        return decimate(time, value, limit)
    steps = np.linspace(time[0], time[-1], limit)
    even = np.clip(np.searchsorted(time, steps), 0, n - 1)
    even[0], even[-1] = 0, n - 1
    for point in turning:  # in the place of the nearest, so that no two nearly coincide
        nearest = 1 + int(np.argmin(np.abs(steps[1:-1] - time[point])))
        even[nearest] = point
        steps[nearest] = np.inf
    return distinct(even)
