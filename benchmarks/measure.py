"""Interleaved medians, errors on a common grid, times at equal error, and the machine.

Methods under comparison take turns, A B C A B C …, so that whatever else the machine does falls
on all of them alike. Each lap also records processor time: wall over processor time tells how
busy the machine was with other work.
"""

from __future__ import annotations

import math
import os
import platform
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from importlib.metadata import version
from statistics import median
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicHermiteSpline, CubicSpline

from benchmarks.peers import PeerFailed
from benchmarks.peers.protocol import Laps, timed
from engine.stepping.library import about

__all__ = [
    "Measured", "Point", "Timing", "interleave", "local", "machine", "on_grid", "time_at",
    "trajectory_error",
]  # fmt: skip

Floats = NDArray[np.float64]
#: One turn of a method: its result and the laps it took.
Turn = Callable[[], tuple[Any, Laps]]


@dataclass(frozen=True)
class Timing:
    """Median of all laps of one method.

    Parameters
    ----------
    seconds : float
        Median processor time of one call, which other work on the machine hardly changes. [s]
    laps : int
        Calls measured. [count]
    busy : float
        Median of wall over processor time; 1 on a calm machine. [1]
    """

    seconds: float
    laps: int
    busy: float


@dataclass(frozen=True, eq=False)
class Measured:
    """Last result of a method with its time, or why there is none."""

    result: Any
    timing: Timing | None
    failure: str | None = None


def local(call: Callable[[], Any], budget: float = 0.05, at_most: int = 200) -> Turn:
    """One of our calls as a turn."""
    return lambda: timed(call, budget, at_most)


def interleave(turns: Mapping[str, Turn], rounds: int) -> dict[str, Measured]:
    """Every method in turn, `rounds` times after one turn that only warms up."""
    laps: dict[str, Laps] = {name: [] for name in turns}
    results: dict[str, Any] = {}
    failures: dict[str, str] = {}
    for lap in range(rounds + 1):
        for name, turn in turns.items():
            if name in failures:
                continue
            try:
                results[name], times = turn()
            except PeerFailed as wrong:
                failures[name] = str(wrong)
                continue
            if lap > 0 or rounds == 0:
                laps[name] += times
    return {
        name: Measured(None, None, failures[name])
        if name in failures
        else Measured(results[name], timing_of(laps[name]))
        for name in turns
    }


def timing_of(laps: Laps) -> Timing:
    """Median of laps."""
    return Timing(
        median(cpu for _, cpu in laps),
        len(laps),
        median(wall / max(cpu, 1e-9) for wall, cpu in laps),
    )


def on_grid(grid: Floats, time: Floats, torque: Floats, rate: Floats | None) -> Floats:
    """A solution everywhere on a grid: by its own rates if it has them, else by a cubic spline."""
    if len(time) == len(grid) and np.allclose(time, grid, rtol=0.0, atol=1e-9):
        return torque
    if rate is not None:
        return np.asarray(CubicHermiteSpline(time, torque, rate, axis=1)(grid))
    return np.asarray(CubicSpline(time, torque, axis=1)(grid))


def trajectory_error(torque: Floats, reference: Floats) -> float:
    """Largest |T − T_ref| over largest |T_ref|, all shafts, all times."""
    if not np.all(np.isfinite(torque)):
        return math.inf
    return float(np.max(np.abs(torque - reference)) / np.max(np.abs(reference)))


@dataclass(frozen=True)
class Point:
    """One step of one method.

    Parameters
    ----------
    step : float
        Step. [s]
    error : float
        Trajectory error. [1]
    seconds : float
        Median time. [s]
    """

    step: float
    error: float
    seconds: float


def time_at(error: float, points: Sequence[Point]) -> tuple[float, str]:
    """Time at a given error: interpolated between steps (log-log), ``≤`` or not reached.

    Returns
    -------
    float
        Time; nan if no step was as accurate. [s]
    str
        ``=`` interpolated, ``≤`` the coarsest step is better already, ``–`` not reached. [word]
    """
    good = [p for p in points if math.isfinite(p.error)]
    good.sort(key=lambda p: p.seconds)
    reached = [i for i, p in enumerate(good) if p.error <= error]
    if not reached:
        return math.nan, "–"
    i = reached[0]
    if i == 0:
        return good[0].seconds, "≤"
    a, b = good[i - 1], good[i]
    share = math.log(a.error / error) / math.log(a.error / b.error)
    return float(a.seconds * (b.seconds / a.seconds) ** share), "="


def machine() -> dict[str, str]:
    """What the figures depend on; no names of hosts."""
    try:
        cores = len(os.sched_getaffinity(0))
    except AttributeError:
        cores = os.cpu_count() or 1
    load = f"{os.getloadavg()[0]:.1f}" if hasattr(os, "getloadavg") else "unknown"
    return {
        "cores": str(cores),
        "system": f"{platform.system()} {platform.machine()}",
        "python": ".".join(map(str, sys.version_info[:3])),
        **{name: version(name) for name in ("numpy", "scipy")},
        "loops": about(),
        "load": load,
    }
