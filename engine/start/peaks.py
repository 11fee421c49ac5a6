"""Extremes of the torque of each element, and how sure they are."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from engine.arrays import Floats, Ints
from engine.case.defaults import LEAST_PEAK_ERROR
from engine.model.train import Train
from engine.numerics.same_bits import interp
from engine.start.settings import NEGLIGIBLE
from engine.start.trajectory import SingleRun, Trajectory, Turning
from engine.stepping.linear_loop import difference_of_extremes

#: No element is taken to be more accurate than this share of the worst, nor than `LEAST_PEAK_ERROR`.
SHARED_ERROR = 0.05

#: Lower and upper end. [as its quantity]
Range = tuple[float, float]


@dataclass(frozen=True)
class ElementPeak:
    """Extremes of the torque of one element over the whole start, of a subdivided shaft over its length."""

    element: str  #: Element.
    maximum: float  #: Largest and smallest torque, at the element's own speed. [N m]
    minimum: float  #: Likewise. [N m]
    time: float  #: When the larger of the two magnitudes occurs. [s]
    speed: float  #: Mean speed of the reference shaft then. [rad/s]
    #: Error of the extremes, the larger of the two; over `size` also that of the peak-to-peak torque. [N m]
    error: float
    peak_to_peak: float  #: Maximum minus minimum of the section where that is largest. [N m]
    #: Bound on what effects left out may change; None = no bound is known. [N m]
    left_out: float | None = 0.0
    #: Ranges of maximum and minimum where equally right runs differ; None: both are known to `error`. [N m]
    repeated: tuple[Range, Range] | None = None
    #: Phase of the pulsation where the larger of the two magnitudes is worst; None: one phase was asked for. [rad]
    phase: float | None = None

    @property
    def extremes(self) -> tuple[Range, Range]:
        """Ranges of maximum and minimum within error, without what is left out. [N m]"""
        if self.repeated is not None:
            return self.repeated
        return _around(self.maximum, self.error), _around(self.minimum, self.error)

    @property
    def low(self) -> float | None:
        """Least size within error and what is left out; None = no bound. [N m]"""
        if self.left_out is None:
            return None
        (least, _), (_, shallowest) = self.extremes
        return max(max(least, -shallowest) - self.left_out, 0.0)

    @property
    def high(self) -> float | None:
        """Largest size, likewise. [N m]"""
        if self.left_out is None:
            return None
        (_, most), (deepest, _) = self.extremes
        return max(most, -deepest) + self.left_out

    @property
    def minimum_range(self) -> Range | None:
        """The minimum within error and what is left out; None = no bound. [N m]"""
        if self.left_out is None:
            return None
        _, (low, high) = self.extremes
        return low - self.left_out, high + self.left_out

    @property
    def peak_to_peak_high(self) -> float | None:
        """Largest maximum minus minimum, likewise: both extremes may err at once. [N m]"""
        if self.left_out is None:
            return None
        (_, most), (deepest, _) = self.extremes
        grows = most - self.maximum + self.minimum - deepest
        return self.peak_to_peak + grows + 2.0 * self.left_out

    def with_error(self, more: float) -> Self:
        """The same with errors and ranges that are wider.

        Parameters
        ----------
        more : float
            At each end. [N m]
        """
        wider = self.repeated and (_wider(self.repeated[0], more), _wider(self.repeated[1], more))
        return replace(self, error=self.error + more, repeated=wider)

    def repeated_in(self, maximum: Range, minimum: Range) -> Self:
        """The same with the ranges of its extremes over an ensemble of runs, its own error included.

        Parameters
        ----------
        maximum, minimum : (float, float)
            Ranges over the ensemble. [N m]
        """
        above, within = maximum[1] - self.maximum, self.maximum - maximum[0]
        below, short = self.minimum - minimum[0], minimum[1] - self.minimum
        share = self.size / self.peak_to_peak if self.peak_to_peak > 0.0 else 0.0
        of_both = share * max(above + below, within + short)
        upper, lower = self.extremes
        return replace(
            self,
            error=max(self.error, above, within, below, short, of_both),
            repeated=(_both(upper, maximum), _both(lower, minimum)),
        )

    @property
    def size(self) -> float:
        """The larger magnitude of the extremes. [N m]"""
        return max(abs(self.maximum), abs(self.minimum))

    @property
    def relative_error(self) -> float:
        """Error over the larger magnitude of the extremes. [1]"""
        return self.error / self.size if self.size > 0.0 else 0.0


def _around(value: float, error: float) -> Range:
    return value - error, value + error


def _wider(ends: Range, more: float) -> Range:
    return ends[0] - more, ends[1] + more


def _both(a: Range, b: Range) -> Range:
    """The range that holds both."""
    return min(a[0], b[0]), max(a[1], b[1])


def sections_of(run: SingleRun) -> dict[int, tuple[int, int, int]]:
    """Outputs with the highest torque, the lowest, and the largest range, of each element.

    Parameters
    ----------
    run : SingleRun
        A simulated start. [SI]

    Returns
    -------
    dict of int to tuple of int
        Element → three outputs, of an undivided element the same; in the order of elements. [index]
    """
    found: dict[int, tuple[int, int, int]] = {}
    highest, lowest = run.extremes.tolist()
    for i, element in enumerate(run.trajectory.output_element.tolist()):
        if element < 0:  # a bearing is no element
            continue
        high, low, wide = found.get(element, (i, i, i))
        found[element] = (
            i if highest[i] > highest[high] else high,
            i if lowest[i] < lowest[low] else low,
            i if highest[i] - lowest[i] > highest[wide] - lowest[wide] else wide,
        )
    return dict(sorted(found.items()))


def change_of_peaks(peaks: Sequence[ElementPeak], others: Sequence[ElementPeak]) -> float:
    """Largest relative change of an extreme of any element.

    Parameters
    ----------
    peaks, others : sequence of ElementPeak
        Of two starts; sizes are those of the others, and not below a negligible one. [N m]

    Returns
    -------
    float
        The change. [1]
    """
    before = {p.element: p for p in peaks}
    floor = max(NEGLIGIBLE * max((p.size for p in others), default=0.0), 1e-300)
    changes = [
        max(abs(p.maximum - before[p.element].maximum), abs(p.minimum - before[p.element].minimum))
        / max(p.size, floor)
        for p in others
        if p.element in before
    ]
    return max(changes, default=0.0)


@dataclass(frozen=True, eq=False)
class JudgedRun:
    """What a start answers: the finer of two simulations, judged by the coarser."""

    peaks: tuple[ElementPeak, ...]  #: One an element. [N m]
    trajectory: Trajectory  #: The finer simulation. [SI]
    #: Per element, times and torques of all turning points from rest to the end. [s, N m]
    turning_points: tuple[Turning, ...]
    #: The same at twice the step: what the error of cycle counts is estimated from. [s, N m]
    coarse_turning_points: tuple[Turning, ...]
    #: Row of `trajectory.torque` that stands for each element; −1 where there is none. Shape
    #: (n_elements,).
    output_of_element: Ints
    estimated_error: float  #: Largest relative error of the peaks. [1]
    truncation_error: float  #: Part of it that the modes left out may cause. [1]
    change: Floats  #: Of each peak from h to h/2, over its size. [1] Shape (n_peaks,).
    #: By index of each element with several sections: turning points of each, at both steps. Where
    #: most cycles are used up need not be where the range is largest. [s, N m]
    sections: Mapping[int, tuple[tuple[Turning, Turning], ...]]

    def repeated_in(self, ranges: Sequence[tuple[Range, Range]]) -> Self:
        """The same with the ranges of the extremes over an ensemble of runs.

        Parameters
        ----------
        ranges : sequence of two (float, float)
            Of maximum and minimum, one pair a peak. [N m]
        """
        peaks = tuple(
            p.repeated_in(*extremes) for p, extremes in zip(self.peaks, ranges, strict=True)
        )
        return replace(self, peaks=peaks, estimated_error=largest_relative_error(peaks))


def judge_run(
    train: Train,
    truncation: Floats,
    fine: SingleRun,
    coarse: SingleRun,
    *,
    with_impacts: bool = False,
    guard_share: float = 1.0,
    same_until: float = math.inf,
    least_change: Floats | None = None,
) -> JudgedRun:
    """Extremes of every element; the error is the change from h to h/2 plus the truncation.

    That change is about fifteen times the error of the finer run at fourth order, three times at
    second. It is taken over several extremes, not below a share of the worst element's, and not below what the order
    of the method makes of the change from 2h to h, so that an accidental agreement is not taken for accuracy
    (tests/numerics/test_error_estimate.py). Extremes late in a start hang together: where resonance carries the speed
    of a load to and fro across the knots of its curve, each crossing adds a little to the time that the start takes,
    and they all move with that one number.

    Parameters
    ----------
    train : Train
        The train. [SI]
    truncation : ndarray, shape (n_outputs,)
        Bound on what modes left out may add to each output. [N m]
    fine, coarse : SingleRun
        Simulations at h/2 and at h. [SI]
    with_impacts : bool, optional
        True: extremes up to the largest are compared by themselves, too. [flag]
    guard_share : float, optional
        How much of the change of the next smaller extremes is taken for the error of the finer run;
        default all of it, as always of the change of the extremes themselves. [1]
    same_until : float, optional
        Time from which the two runs went different ways; what comes later, and after the largest extreme, does not
        count for the error. Where the largest extreme comes later, all of that change is taken. [s]
    least_change : ndarray, optional
        What the order of the method makes of the change from 2h to h; a smaller one is chance. [1]

    Returns
    -------
    JudgedRun
        Peaks and their errors. [N m]
    """
    trajectory, turning = fine.trajectory, fine.turning
    sections = sections_of(fine)
    judged = [(element, widest) for element, (_, _, widest) in sections.items()]
    output = np.full(len(train.elements), -1, dtype=np.int64)  # of each element the widest
    for element, i in judged:
        output[element] = i

    def largest(values: Mapping[int, float]) -> Floats:
        """Of the sections of each element that matter."""
        return np.array([max(values[i] for i in sections[element]) for element, _ in judged])

    used = sorted({i for three in sections.values() for i in three})
    size = largest({i: float(np.max(np.abs(turning[i][1]))) for i in used})
    bound = largest({i: float(truncation[i]) for i in used})
    change = largest(
        {
            i: difference_of_extremes(
                turning[i],
                coarse.turning[i],
                with_impacts=with_impacts,
                guard_share=guard_share,
                same_until=same_until,
            )
            for i in used
        }
    )
    floor = np.maximum(size, NEGLIGIBLE * np.max(size, initial=0.0))
    change = change / np.where(floor > 0.0, floor, 1.0)
    relative = change if least_change is None else np.maximum(change, least_change)
    least = max(SHARED_ERROR * float(np.max(relative, initial=0.0)), LEAST_PEAK_ERROR)
    peaks = []
    for (element, i), own, scale, left_out in zip(judged, relative, floor, bound, strict=True):
        high, low, _ = sections[element]
        highest, lowest = float(fine.extremes[0, high]), float(fine.extremes[1, low])
        when, value = turning[high if highest >= -lowest else low]
        time = float(when[int(np.argmax(np.abs(value)))])
        peaks.append(
            ElementPeak(
                train.elements[element],
                highest,
                lowest,
                time,
                float(interp(time, trajectory.time, trajectory.mean_speed)),
                float(max(own, least) * scale + left_out),
                float(np.ptp(turning[i][1])),
            )
        )
    scale = np.where(floor > 0.0, floor, np.inf)
    return JudgedRun(
        tuple(peaks),
        trajectory,
        tuple(turning[i] for _, i in judged),
        tuple(coarse.turning[i] for _, i in judged),
        output,
        largest_relative_error(peaks),
        float(np.max(bound / scale, initial=0.0)),
        change,
        _by_section(fine, coarse),
    )


def largest_relative_error(peaks: Sequence[ElementPeak]) -> float:
    """Largest error over the size of its peak, or over a negligible share of the largest one.

    Parameters
    ----------
    peaks : sequence of ElementPeak
        Of one start. [N m]

    Returns
    -------
    float
        Relative error. [1]
    """
    floor = NEGLIGIBLE * max((p.size for p in peaks), default=0.0)
    sizes = [max(p.size, floor) for p in peaks]
    return max((p.error / size for p, size in zip(peaks, sizes, strict=True) if size), default=0.0)


def _by_section(
    fine: SingleRun, coarse: SingleRun
) -> dict[int, tuple[tuple[Turning, Turning], ...]]:
    element_of = fine.trajectory.output_element
    counts = np.bincount(element_of[element_of >= 0])
    return {
        element: tuple(
            (fine.turning[i], coarse.turning[i]) for i in np.flatnonzero(element_of == element)
        )
        for element in np.flatnonzero(counts > 1).tolist()
    }
