"""A train with its modes and their damping: what every response is calculated with."""

from __future__ import annotations

from typing import NamedTuple

from engine.case.data import CaseData
from engine.model.modes import ModalDamping, Modes, modal_damping
from engine.model.train import Train


class ModalTrain(NamedTuple):
    """A train in modal coordinates."""

    train: Train  #: The train as arrays. [SI]
    modes: Modes  #: Its modes. [SI]
    damping: ModalDamping  #: Their damping. [SI]

    @classmethod
    def of(cls, case: CaseData, train: Train, modes: Modes) -> ModalTrain:
        """A train and its modes with the damping that the case gives them."""
        return cls(train, modes, modal_damping(case, train, modes))
