"""Sampled histories of a start, their turning points, and how they are kept in bounded memory.

Between two samples a torque is the cubic through values and rates, so that a peak between them is
not missed. Turning points are what answers are read from. They are taken from every sample; once
there are more samples than `KEPT_VALUES` allows, only every second, fourth, … one is kept for
pictures and for interpolation, so that memory does not grow with the number of steps.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Self

import numpy as np

from engine.arrays import Floats, Ints
from engine.numerics.distinct import distinct
from engine.stepping import linear_loop as kernels

Turning = tuple[Floats, Floats]

#: Torque values (samples × outputs) that are kept of one simulation.
KEPT_VALUES = 1_000_000


@dataclass(frozen=True, eq=False)
class Trajectory:
    """One simulated start."""

    #: Sample times, the first is rest; two samples may share one time where something jumps. [s]
    #: Shape (n_times,).
    time: Floats
    mean_speed: Floats  #: Rigid-body speed of the reference shaft. [rad/s] Shape (n_times,).
    torque: Floats  #: Torque of every output and its rate. [N m, N m/s] Shape (n_outputs, n_times).
    torque_rate: Floats  #: Likewise. [N m, N m/s] Shape (n_outputs, n_times).
    output_element: Ints  #: Element of each output. Shape (n_outputs,).
    reached: bool  #: True if the target speed was reached.
    n_steps: int  #: Steps taken.
    #: Turning points of every output where the loop found them, or samples were thinned out; None = take
    #: them from the samples. [s, N m]
    turning: tuple[Turning, ...] | None = None
    thinned: bool = False  #: Whether samples were left out.

    def end_at(self, target_speed: float) -> float:
        """Time at which a mean speed was reached, or the last sample. [s]

        Parameters
        ----------
        target_speed : float
            Mean speed of the reference shaft at which the run was to stop. [rad/s]
        """
        t, w = self.time, self.mean_speed
        if not self.reached or len(t) < 2:
            return float(t[-1])
        share = (target_speed - w[-2]) / (w[-1] - w[-2])
        return float(t[-2] + min(max(share, 0.0), 1.0) * (t[-1] - t[-2]))


class Recorder:
    """Takes the samples of a run as they come.

    Parameters
    ----------
    output_element : ndarray of int, shape (n_outputs,)
        Element of each output. [index]
    kept_values : float, optional
        Torque values that are kept; infinite = all. [count]
    turning : bool, optional
        False: turning points are found elsewhere. [flag]
    """

    def __init__(
        self, output_element: Ints, kept_values: float = KEPT_VALUES, *, turning: bool = True
    ) -> None:
        self._element, self._finds_turning = output_element, turning
        self._most = max(kept_values / max(len(output_element), 1), 16.0)
        self._blocks: list[tuple[Floats, ...]] = []  # time, speed, torque, rate, further rows
        self._samples, self._stride, self._offset = 0, 1, 0
        self._turning: list[list[Turning]] | None = None
        self._last: tuple[Floats, ...] | None = None  # the last two samples, whatever is kept

    def add(
        self, time: Floats, speed: Floats, torque: Floats, rate: Floats, further: Floats
    ) -> None:
        """Take samples.

        Parameters
        ----------
        time, speed : ndarray, shape (n,)
            Times and mean speeds. [s, rad/s]
        torque, rate : ndarray, shape (n_outputs, n)
            Torques and their rates. [N m, N m/s]
        further : ndarray, shape (k, n)
            Further histories that are kept beside them. [SI]
        """
        block = (time, speed, torque, rate, further)
        if len(time) == 0:
            return
        if self._turning is not None:
            self._take_turning(block)
        last = tuple(a[..., -2:] for a in block)
        last = last if self._last is None else _joined([self._last, last])
        self._last = tuple(a[..., -2:].copy() for a in last)
        thinned = tuple(a[..., self._offset :: self._stride] for a in block)
        self._offset = (self._offset - len(time)) % self._stride
        self._blocks.append(tuple(a.copy() for a in thinned) if self._stride > 1 else thinned)
        self._samples += len(thinned[0])
        while self._samples > self._most:
            self._thin()

    def _take_turning(self, block: tuple[Floats, ...]) -> None:
        """Turning points from the last sample before this block to its end."""
        assert self._turning is not None
        before = [] if self._last is None else [tuple(a[..., -1:] for a in self._last)]
        time, _, torque, rate, _ = _joined([*before, block])
        for turning, y, slope in zip(self._turning, torque, rate, strict=True):
            turning.append(kernels.turning_points(time, y, slope))

    def _thin(self) -> None:
        """Keep every second sample of those that are kept."""
        whole = _joined(self._blocks)
        if self._turning is None and self._finds_turning:
            self._turning = [[] for _ in self._element]
            last, self._last = self._last, None
            self._take_turning(whole)
            self._last = last
        phase = (self._samples - 1) % 2  # the last one stays, and rest
        keep = distinct([0], np.arange(phase, self._samples, 2), _pairs(whole[0]))
        if len(keep) > 0.75 * self._samples:  # so many events that they must be thinned, too
            keep = distinct([0], np.arange(phase, self._samples, 2))
        self._blocks = [tuple(a[..., keep] for a in whole)]
        self._samples = len(self._blocks[0][0])
        self._offset += self._stride
        self._stride *= 2

    def seen(self) -> tuple[Floats, Floats, Floats]:
        """What is kept so far.

        Returns
        -------
        time, speed : ndarray, shape (n,)
            Times and mean speeds. [s, rad/s]
        further : ndarray, shape (k, n)
            Further histories. [SI]
        """
        parts = [(b[0], b[1], b[4]) for b in self._blocks]
        return (
            np.concatenate([p[0] for p in parts]),
            np.concatenate([p[1] for p in parts]),
            np.concatenate([p[2] for p in parts], axis=1),
        )

    def trajectory(self, reached: bool, n_steps: int) -> tuple[Trajectory, Floats]:
        """Everything that was kept; the last two samples always are.

        Parameters
        ----------
        reached : bool
            True if the target speed was reached. [flag]
        n_steps : int
            Steps taken. [count]

        Returns
        -------
        trajectory : Trajectory
            The samples. [SI]
        further : ndarray, shape (k, n_times)
            Further histories. [SI]
        """
        blocks = self._blocks
        if self._stride > 1 and self._last is not None:
            end = float(self._last[0][0])
            blocks = [*(tuple(a[..., b[0] < end] for a in b) for b in blocks), self._last]
        time, speed, torque, rate, further = _joined(blocks)
        turning = None
        if self._turning is not None:
            turning = tuple(
                (np.concatenate([f[0] for f in found]), np.concatenate([f[1] for f in found]))
                for found in self._turning
            )
        return (
            Trajectory(
                time,
                speed,
                torque,
                rate,
                self._element,
                reached,
                n_steps,
                turning,
                self._stride > 1,
            ),
            further,
        )


def _pairs(time: Floats) -> Ints:
    """Samples that share their time with a neighbour: the corners of the curve."""
    same = np.flatnonzero(np.diff(time) == 0.0)
    return np.concatenate([same, same + 1])


def _joined(blocks: list[tuple[Floats, ...]]) -> tuple[Floats, ...]:
    """Blocks one after the other; a single one is not copied."""
    if len(blocks) == 1:
        return blocks[0]
    return tuple(np.concatenate(part, axis=-1) for part in zip(*blocks, strict=True))


def turning_of(trajectory: Trajectory, end: float) -> list[Turning]:
    """Turning points of every output from rest to the end.

    Parameters
    ----------
    trajectory : Trajectory
        A simulated start. [SI]
    end : float
        Time at which it ends. [s]

    Returns
    -------
    list of (ndarray, ndarray)
        Times and torques. [s, N m]
    """
    t, torque, rate = trajectory.time, trajectory.torque, trajectory.torque_rate
    if trajectory.turning is None:
        return kernels.samples_to_end(t, torque, rate, end)
    return [
        _to_end(found, t, y, slope, end)
        for found, y, slope in zip(trajectory.turning, torque, rate, strict=True)
    ]


@dataclass(frozen=True, eq=False)
class SingleRun:
    """One simulation of a start at one step, and what is read out of it."""

    trajectory: Trajectory  #: The simulation. [SI]
    end: float  #: When it ended. [s]
    #: Times and torques of all turning points of every output, from rest to the end. [s, N m]
    turning: list[Turning]

    @classmethod
    def until(cls, trajectory: Trajectory, end: float) -> SingleRun:
        """A simulation up to its end; the trajectory releases its own copy of turning points.

        Parameters
        ----------
        trajectory : Trajectory
            A simulated start. [SI]
        end : float
            Time at which it ends. [s]
        """
        turning = turning_of(trajectory, end)
        return cls(replace(trajectory, turning=None), end, turning)

    @cached_property
    def extremes(self) -> Floats:
        """Highest and lowest torque of every output, shape (2, n_outputs). [N m]"""
        values = [value for _, value in self.turning]
        if not values:
            return np.zeros((2, 0))
        begins = np.concatenate([[0], np.cumsum([len(value) for value in values[:-1]], dtype=int)])
        joined = np.concatenate(values)
        return np.stack([of.reduceat(joined, begins) for of in (np.maximum, np.minimum)])

    def without_history(self) -> Self:
        """With the turning points alone: the history is most of the memory."""
        none = np.empty((0, 0))
        return replace(self, trajectory=replace(self.trajectory, torque=none, torque_rate=none))


def _to_end(turning: Turning, t: Floats, y: Floats, slope: Floats, end: float) -> Turning:
    """Turning points of one output up to `end`, with the values at rest and at the end."""
    size = float(np.max(np.abs(y), initial=0.0))
    at = int(np.clip(np.searchsorted(t, end) - 1, 0, max(len(t) - 2, 0)))
    around = [at, min(at + 1, len(t) - 1)]
    last = np.stack([t[around], y[around], slope[around]])
    return kernels.turning_to_end(turning, size, float(y[0]), end, last)


def hermite_at(t: Floats, y: Floats, slope: Floats, at: Floats) -> Floats:
    """Values of the dense output, the cubics through values and rates of the samples.

    Parameters
    ----------
    t, y, slope : ndarray, shape (n,)
        Rising times, of which two may be equal at a jump; values of any unit, and their rates. [s, any]
    at : ndarray, shape (m,)
        Times within them. [s]

    Returns
    -------
    ndarray, shape (m,)
        Values. [any]
    """
    i = np.clip(np.searchsorted(t, at) - 1, 0, max(len(t) - 2, 0))
    j = np.minimum(i + 1, len(t) - 1)
    h = t[j] - t[i]
    s = np.where(h > 0.0, (at - t[i]) / np.where(h > 0.0, h, 1.0), 1.0)
    rise, a, b = y[j] - y[i], h * slope[i], h * slope[j]
    return np.asarray(y[i] + s * (a + s * (3.0 * rise - 2.0 * a - b + s * (a + b - 2.0 * rise))))
