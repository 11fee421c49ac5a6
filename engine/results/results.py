"""The complete, frozen results of one run.

Each analysis keeps its own result; an analysis the case does not call for is None, and a warning
says why. Nothing is filled in later.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from engine.case.data import CaseData
from engine.case.effects import BearingForce, PullIn, Sensitivity
from engine.fatigue.allowable_starts import AllowableStarts
from engine.model.excitation import Excitation
from engine.model.modes import ModalDamping, Modes, Node
from engine.model.train import Train
from engine.operation.margins import Interference, SeparationMargins
from engine.operation.steady_state import SteadyState
from engine.plan.plan import Plan
from engine.results.verdicts import Verdict
from engine.start.crossings import Crossing
from engine.start.reversals import Reversal
from engine.start.start import Start

__all__ = ["AccuracyRow", "AtSpeed", "Results"]


@dataclass(frozen=True)
class AccuracyRow:
    """What one calculation was worth and what it cost.

    Parameters
    ----------
    method : str
        Method of the time integration, or the analysis. [name]
    setting : str
        Wanted tolerance or step. [words]
    error_peak : float or None
        Error of the peak torques, relative; None where the analysis has none. [1]
    error_starts : float or None
        Error of the allowable starts, relative; None where none is counted, or unlimited. [1]
    time : float
        Wall time. [s]
    """

    method: str
    setting: str
    error_peak: float | None
    error_starts: float | None
    time: float


@dataclass(frozen=True, eq=False)
class AtSpeed:
    """What holds without any start: modes, margins, forced response.

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


@dataclass(frozen=True, eq=False)
class Results(AtSpeed):
    """Everything one run answers: what `AtSpeed` holds, and the start.

    Parameters
    ----------
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
    plans : tuple of Plan
        Every plan of this run; the last one is that of the results. [mixed]
    reversals : tuple of Reversal
        Torque reversals of meshes and geared couplings in the start that is reported. [SI]
    bearing_forces : tuple of BearingForce
        Largest bearing force of each gear that moves sideways. [N]
    pull_in : PullIn or None
        Field application, where it was simulated. [SI]
    sensitivity : Sensitivity or None
        Change of the answers under a tiny change of the input, where clearances are modelled. [1]
    accuracy : tuple of AccuracyRow
        Estimated error and time of each analysis, as calculated. [1, s]
    """

    start: Start | None
    crossings: tuple[Crossing, ...]
    starts: AllowableStarts | None
    starts_error: tuple[tuple[str, float | None], ...]
    verdicts: tuple[Verdict, ...]
    warnings: tuple[str, ...]
    spent: tuple[tuple[str, float], ...]
    plans: tuple[Plan, ...] = ()
    reversals: tuple[Reversal, ...] = ()
    bearing_forces: tuple[BearingForce, ...] = ()
    pull_in: PullIn | None = None
    sensitivity: Sensitivity | None = None
    accuracy: tuple[AccuracyRow, ...] = ()

    @property
    def outcome(self) -> str:
        """How the run as a whole ended: the start's outcome, or ``calculated``. [word]"""
        return self.start.outcome.outcome if self.start is not None else "calculated"
