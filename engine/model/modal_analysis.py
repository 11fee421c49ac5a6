"""Natural modes of a case, with gears held or moving on their bearings."""

from __future__ import annotations

import math
from dataclasses import dataclass

from engine.case.data import CaseData
from engine.case.effects import choice_of
from engine.case.effects.bearings import has_bearings
from engine.model.build_train import build_train
from engine.model.modal_train import ModalTrain
from engine.model.subdivision import (
    COARSEST,
    SUBDIVISION_SEGMENTS,
    SubdividedModes,
    natural_modes,
    wanted_frequency,
)


@dataclass(frozen=True, eq=False)
class ModalAnalysis:
    """Natural modes of a case, with and without bearings."""

    subdivided: SubdividedModes  #: The modes that are reported. [SI]
    reported: ModalTrain  #: Their train and damping: with bearings where their data is given. [SI]
    torsional: ModalTrain  #: Gears held laterally; the same where there is no bearing data. [SI]
    #: Gears on their bearings, whether reported or not; None without bearing data. [SI]
    coupled: ModalTrain | None
    #: `reported` and `torsional` in half as many pieces; None where no shaft is subdivided. [SI]
    rough_reported: ModalTrain | None = None
    rough_torsional: ModalTrain | None = None  #: Likewise. [SI]
    #: By element, relative error of torques in the start from the pieces of shafts. [1]
    pieces_error: tuple[tuple[str, float], ...] = ()


def analyse(
    case: CaseData, at_least: float = 0.0, least_pieces: int = 2 * COARSEST
) -> ModalAnalysis:
    """Natural modes of a case; where bearing data is given also those of gears held laterally.

    Parameters
    ----------
    case : CaseData
        The case. [SI]
    at_least : float, optional
        Modes up to here are made accurate, even where nothing excites them. [Hz]
    least_pieces : int, optional
        Pieces of the longest shaft with inertia of its own. [count]

    Returns
    -------
    ModalAnalysis
        Modes and damping. [SI]
    """
    highest = max(wanted_frequency(case, build_train(case)), at_least) if at_least else None
    modes = natural_modes(case, highest, least_pieces=least_pieces)
    coupled, rough = _trains(case, modes)
    if not has_bearings(case):
        return ModalAnalysis(modes, coupled, coupled, None, rough, rough)
    plain = natural_modes(case, highest, lateral=False, least_pieces=least_pieces)
    torsional, plain_rough = _trains(case, plain)
    if choice_of(case, "bearings") == "off":
        return ModalAnalysis(plain, torsional, torsional, coupled, plain_rough, plain_rough)
    return ModalAnalysis(modes, coupled, torsional, coupled, rough, plain_rough)


def in_more_pieces(
    case: CaseData, analysis: ModalAnalysis, error: float, wanted: float
) -> ModalAnalysis | None:
    """The train in so many pieces that an error of second order in their number comes within what is wanted.

    Parameters
    ----------
    case : CaseData
        The case. [SI]
    analysis : ModalAnalysis
        Its train in the pieces that have this error. [SI]
    error, wanted : float
        Error found, and the most it may be. [1]

    Returns
    -------
    ModalAnalysis or None
        None where it is small enough, or there may be no more pieces. [SI]
    """
    pieces = dict(analysis.subdivided.segments).values()
    if error <= wanted or sum(pieces) >= 0.9 * SUBDIVISION_SEGMENTS:
        return None
    finer = min(8.0, 1.1 * math.sqrt(error / wanted))
    return analyse(case, least_pieces=math.ceil(finer * max(pieces)))


def _trains(case: CaseData, found: SubdividedModes) -> tuple[ModalTrain, ModalTrain | None]:
    """The train with its damping, and the same in half as many pieces."""
    rough = None if found.rough is None else ModalTrain.of(case, *found.rough)
    return ModalTrain.of(case, found.train, found.modes), rough
