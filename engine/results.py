"""The complete, frozen results of one run.

Each analysis keeps its own result; an analysis the case does not call for is None, and a warning
says why. Nothing is filled in later.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from engine.case import CaseData
from engine.crossings import Crossing
from engine.excitation import Excitation
from engine.fatigue import AllowableStarts
from engine.margins import Interference, SeparationMargins
from engine.modal import ModalDamping, Modes, Node
from engine.startup import Start
from engine.steady_state import SteadyState
from engine.train import Train
from engine.verdicts import Verdict

__all__ = ["Results"]


@dataclass(frozen=True, eq=False)
class Results:
    """Everything one run answers.

    Parameters
    ----------
    case : CaseData
        What was asked. [SI]
    case_sha256 : str
        Digest of the inputs. [hex]
    train : Train
        The train as arrays. [SI]
    modes : Modes
        Natural modes. [SI]
    nodes : tuple of Node
        Where the modes stand still. [count]
    segments : tuple of (str, int)
        Subdivision of shafts with inertia of their own. [count]
    frequency_error : float
        Estimated relative error of the frequencies from that subdivision. [1]
    damping : ModalDamping
        Damping of the modes. [SI]
    eigenvalues : ndarray of complex or None
        Damped eigenvalues where dampers couple the modes; None where damping is proportional.
        [1/s]
    excitations : tuple of Excitation
        What was judged. [SI]
    margins : SeparationMargins
        Separation margins with verdicts. [1]
    interference : Interference
        Lines of the interference diagram. [Hz]
    steady : SteadyState
        Forced response. [SI]
    start : Start or None
        The start, or the response to prescribed torques. [SI]
    crossings : tuple of Crossing
        Where 2 × slip crosses the modes. [SI]
    starts : AllowableStarts or None
        Fatigue of the judged shafts. [1]
    starts_error : tuple of (str, float or None)
        Per judged shaft, estimated relative error of its allowable starts; None = unlimited. [1]
    verdicts : tuple of Verdict
        The checks at a glance. [words]
    warnings : tuple of str
        What a reader must know beside the numbers. [sentences]
    spent : tuple of (str, float)
        Wall time of each analysis in this run. [s]
    """

    case: CaseData
    case_sha256: str
    train: Train
    modes: Modes
    nodes: tuple[Node, ...]
    segments: tuple[tuple[str, int], ...]
    frequency_error: float
    damping: ModalDamping
    eigenvalues: NDArray[np.complex128] | None
    excitations: tuple[Excitation, ...]
    margins: SeparationMargins
    interference: Interference
    steady: SteadyState
    start: Start | None
    crossings: tuple[Crossing, ...]
    starts: AllowableStarts | None
    starts_error: tuple[tuple[str, float | None], ...]
    verdicts: tuple[Verdict, ...]
    warnings: tuple[str, ...]
    spent: tuple[tuple[str, float], ...]

    @property
    def outcome(self) -> str:
        """How the run as a whole ended: the start's outcome, or ``calculated``. [word]"""
        return self.start.outcome.outcome if self.start is not None else "calculated"
