"""A train with its modes and their damping, with gears held or moving on their bearings."""

from __future__ import annotations

from dataclasses import dataclass

from engine.case.data import CaseData
from engine.case.effects import choice_of
from engine.case.effects.bearings import has_bearings
from engine.model.modes import ModalDamping, Modes, SubdividedModes, modal_damping, natural_modes
from engine.model.train import Train


@dataclass(frozen=True, eq=False)
class ModalModel:
    """A train, its modes and their damping."""

    train: Train  #: The train as arrays. [SI]
    modes: Modes  #: Its modes. [SI]
    damping: ModalDamping  #: Their damping. [SI]


@dataclass(frozen=True, eq=False)
class ModalAnalysis:
    """Natural modes of a case, with and without bearings."""

    subdivided: SubdividedModes  #: The modes that are reported. [SI]
    reported: ModalModel  #: Their train and damping: with bearings where their data is given. [SI]
    torsional: ModalModel  #: Gears held sideways; the same where there is no bearing data. [SI]
    #: Gears on their bearings, whether reported or not; None without bearing data. [SI]
    coupled: ModalModel | None

    def model_for(self, lateral: bool) -> ModalModel:
        """The model of a start.

        Parameters
        ----------
        lateral : bool
            Whether gears move sideways on their bearings in it. [flag]

        Returns
        -------
        ModalModel
            With or without bearings. [SI]
        """
        return self.reported if lateral else self.torsional


def analyse(case: CaseData) -> ModalAnalysis:
    """Natural modes of a case; where bearing data is given also those of gears held sideways.

    Parameters
    ----------
    case : CaseData
        The case. [SI]

    Returns
    -------
    ModalAnalysis
        Modes and damping. [SI]
    """
    modes = natural_modes(case)
    coupled = _model(case, modes)
    if not has_bearings(case):
        return ModalAnalysis(modes, coupled, coupled, None)
    plain = natural_modes(case, lateral=False)
    torsional = _model(case, plain)
    if choice_of(case, "bearings") == "off":
        return ModalAnalysis(plain, torsional, torsional, coupled)
    return ModalAnalysis(modes, coupled, torsional, coupled)


def _model(case: CaseData, modes: SubdividedModes) -> ModalModel:
    return ModalModel(modes.train, modes.modes, modal_damping(case, modes.train, modes.modes))
