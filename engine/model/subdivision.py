"""Shafts with inertia of their own: in how many pieces they are calculated, and how good that is.

A piece has half its inertia at each of its ends. That lowers frequencies, by an error that falls with the
square of the number of pieces. Pieces take equal times of a wave to pass. They are refined until every
mode that may be judged is right: up to `BAND` times the highest excitation over the operating range, and
up to `LINE_BAND` times the line frequency for the start.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from engine.arrays import Floats
from engine.case.data import CaseData
from engine.model.build_train import build_train
from engine.model.excitation import excitations_of, operating_range
from engine.model.links import Link, has_clearance, link_of
from engine.model.modes import Modes, modes_of
from engine.model.sections import sections_of
from engine.model.train import Train
from engine.numerics.same_bits import total

#: Wanted relative accuracy of frequencies where shaft inertia is distributed.
SUBDIVISION_TOLERANCE = 1e-3
#: Without any excitation so many modes are refined; so many pieces are used for all shafts together.
SUBDIVISION_MODES, SUBDIVISION_SEGMENTS = 10, 400
#: Modes up to this multiple of the highest excitation, and of the line frequency, are refined. [1]
BAND, LINE_BAND = 1.25, 2.5
#: Pieces of the longest shaft in the first, coarsest train.
COARSEST = 4
#: Halving the pieces leaves a third of the change as error (second order), here with a margin
#: for the fourth-order term, so that the estimate is not below the error.
RICHARDSON = 2.5


@dataclass(frozen=True, eq=False)
class SubdividedModes:
    """Modes of a case whose shafts may carry inertia of their own."""

    train: Train  #: The train, shafts with density subdivided. [SI]
    modes: Modes  #: Its modes. [SI]
    segments: tuple[tuple[str, int], ...]  #: Number of pieces of each subdivided shaft.
    frequency_error: float  #: Estimated largest relative error of the wanted frequencies. [1]
    #: Modes up to here are within the tolerance; infinite where no shaft is subdivided. [Hz]
    accurate_up_to: float = math.inf
    #: The same train in half as many pieces, and its modes; None where no shaft is subdivided. [SI]
    rough: tuple[Train, Modes] | None = None


def wanted_frequency(case: CaseData, train: Train) -> float:
    """Frequency up to which modes may be judged.

    Parameters
    ----------
    case : CaseData
        The case: excitations, operating range, line frequency, required margin. [SI]
    train : Train
        Its train, in whatever pieces. [SI]

    Returns
    -------
    float
        Infinite where nothing excites the train. [Hz]
    """
    line, speeds = case.ratings.line_frequency, operating_range(case)
    highest = [
        x.frequency if x.frequency is not None else x.frequency_at(speeds[1] if speeds else 0.0)
        for x in excitations_of(case, train)
    ]
    reach = max(BAND, 1.05 * (1.0 + (case.margin_required or 0.0)))
    wanted = max(reach * max(highest, default=0.0), LINE_BAND * (line or 0.0))
    return wanted if wanted > 0.0 else math.inf


def natural_modes(
    case: CaseData,
    highest_frequency: float | None = None,
    tolerance: float = SUBDIVISION_TOLERANCE,
    *,
    lateral: bool = True,
    least_pieces: int = 2 * COARSEST,
) -> SubdividedModes:
    """Modes of a case; shafts with density are subdivided until the wanted frequencies are right.

    Richardson's estimate from a train and its halved pieces is compared with the tolerance, and gives
    how much finer the next pair must be.

    Parameters
    ----------
    case : CaseData
        The case. [SI]
    highest_frequency : float, optional
        Frequencies up to here are refined, at least one; default `wanted_frequency`, or where that is
        infinite the first ten modes. [Hz]
    tolerance : float, optional
        Wanted relative error. [1]
    lateral : bool, optional
        Whether gears with bearing data move laterally. [flag]
    least_pieces : int, optional
        Pieces of the longest shaft at least, of all shafts together `SUBDIVISION_SEGMENTS` at most.
        [count]

    Returns
    -------
    SubdividedModes
        Train and modes. [SI]
    """
    parted = {m.element for m in case.meshes if has_clearance(m)}
    meshes, sections = {m.element: m for m in case.meshes}, sections_of(case)
    links = {
        str(e.element): link_of(e, meshes.get(e.element), sections.get(str(e.element), ()))
        for e in case.elements
        if e.element not in parted and (e.density or str(e.element) in sections)
    }
    waves = {name: link for name, link in links.items() if link.inertia and link.stiffness}
    time = {name: _travel_time(link) for name, link in waves.items()}
    least = {name: sum(link.profile.pieces) for name, link in waves.items()}
    train = build_train(case, lateral=lateral)
    if not time:
        return SubdividedModes(train, modes_of(train), (), 0.0)
    highest = wanted_frequency(case, train) if highest_frequency is None else highest_frequency
    longest = max(time.values())
    # pieces a second of travel, of the coarser of two trains
    density = min(0.5 * least_pieces / longest, 0.5 * SUBDIVISION_SEGMENTS / total(time.values()))
    while True:
        coarse = {
            name: n * max(1, math.ceil(density * time[name] / n)) for name, n in least.items()
        }
        fine = {name: 2 * n for name, n in coarse.items()}
        train = build_train(case, fine, lateral=lateral)
        modes = modes_of(train)
        coarser = build_train(case, coarse, lateral=lateral)
        rough = coarser, modes_of(coarser)
        errors = _refinement_errors(rough[1], modes)
        error = _largest_wanted(errors, modes, highest)
        growth = min(8.0, 1.1 * math.sqrt(error / tolerance))
        most = SUBDIVISION_SEGMENTS / total(fine.values())
        if error <= tolerance or most < 1.1:
            reach = _accurate_up_to(errors, modes, tolerance)
            accurate = modes.elastic_frequency <= reach
            told = max(error, float(np.max(errors[accurate], initial=0.0)))
            return SubdividedModes(train, modes, tuple(fine.items()), told, reach, rough)
        density *= min(growth, most)


def _travel_time(link: Link) -> float:
    """Time a torsional wave needs along an element in pieces as long as the longest, √(J/k) of a plain shaft. [s]"""
    parts = zip(link.profile.parts, link.profile.pieces, strict=True)
    longest = max(math.sqrt(twist * inertia) / n for (twist, inertia), n in parts)
    assert link.stiffness is not None
    return math.sqrt(link.inertia / link.stiffness) * longest * sum(link.profile.pieces)


def _refinement_errors(coarse: Modes, fine: Modes) -> Floats:
    """Estimated relative error of each elastic frequency; infinite where the coarser train has none."""
    rough, exact = coarse.elastic_frequency, fine.elastic_frequency
    errors = np.full(len(exact), np.inf)
    both = min(len(rough), len(exact))
    errors[:both] = np.abs(rough[:both] / exact[:both] - 1.0) / RICHARDSON
    return errors


def _largest_wanted(errors: Floats, fine: Modes, highest: float) -> float:
    frequency = fine.elastic_frequency
    count = int(np.sum(frequency <= highest)) if math.isfinite(highest) else SUBDIVISION_MODES
    return float(np.max(errors[: max(1, count)], initial=0.0))


def _accurate_up_to(errors: Floats, fine: Modes, tolerance: float) -> float:
    """Frequency of the last mode before the first that is not within the tolerance. [Hz]"""
    wrong = np.flatnonzero(errors > tolerance)
    last = int(wrong[0]) if len(wrong) else len(errors)
    return float(fine.elastic_frequency[last - 1]) if last else 0.0
