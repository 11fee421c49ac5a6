"""Natural modes of a case, with gears held or moving on their bearings."""

from __future__ import annotations

from dataclasses import dataclass

from engine.case.data import CaseData
from engine.case.effects import choice_of
from engine.case.effects.bearings import has_bearings
from engine.model.build_train import build_train
from engine.model.modal_train import ModalTrain
from engine.model.subdivision import SubdividedModes, natural_modes, wanted_frequency


@dataclass(frozen=True, eq=False)
class ModalAnalysis:
    """Natural modes of a case, with and without bearings."""

    subdivided: SubdividedModes  #: The modes that are reported. [SI]
    reported: ModalTrain  #: Their train and damping: with bearings where their data is given. [SI]
    torsional: ModalTrain  #: Gears held laterally; the same where there is no bearing data. [SI]
    #: Gears on their bearings, whether reported or not; None without bearing data. [SI]
    coupled: ModalTrain | None


def analyse(case: CaseData, at_least: float = 0.0) -> ModalAnalysis:
    """Natural modes of a case; where bearing data is given also those of gears held laterally.

    Parameters
    ----------
    case : CaseData
        The case. [SI]
    at_least : float, optional
        Modes up to here are made accurate, even where nothing excites them. [Hz]

    Returns
    -------
    ModalAnalysis
        Modes and damping. [SI]
    """
    highest = max(wanted_frequency(case, build_train(case)), at_least)
    modes = natural_modes(case, highest)
    coupled = ModalTrain.of(case, modes.train, modes.modes)
    if not has_bearings(case):
        return ModalAnalysis(modes, coupled, coupled, None)
    plain = natural_modes(case, highest, lateral=False)
    torsional = ModalTrain.of(case, plain.train, plain.modes)
    if choice_of(case, "bearings") == "off":
        return ModalAnalysis(plain, torsional, torsional, coupled)
    return ModalAnalysis(modes, coupled, torsional, coupled)
