"""The complete, frozen results of one run.

Each analysis keeps its own result; an analysis the case does not call for is None, and a warning
says why. Accuracy, verdicts and warnings are read from the rest.
"""

from __future__ import annotations

from dataclasses import dataclass

from engine.arrays import Complexes
from engine.backlash.operating_events import OperatingEvent
from engine.case.data import CaseData
from engine.case.result_words import Judgement
from engine.fatigue.allowable_starts import AllowableStarts
from engine.model.excitation import Excitation
from engine.model.modes import ModalDamping, Modes, Node
from engine.model.train import Train
from engine.operation.margins import Interference, SeparationMargins
from engine.operation.steady_state import SteadyState
from engine.plan.plan import Plan
from engine.start.crossings import Crossing
from engine.start.electrical_damping import ElectricalDamping
from engine.start.reversals import Reversal
from engine.start.start import Start


@dataclass(frozen=True)
class Verdict:
    """One check."""

    check: str  #: What was checked.
    result: float | str | None  #: What was found and what is allowed. [SI, in the dimension named]
    limit: float | str | None  #: Likewise. [SI, in the dimension named]
    dimension: str  #: ``fraction``, ``pressure``, ``torque``, ``count`` or ``text``.
    #: ``pass``, ``pass within its error``, ``accepted by forced response``, ``fail``, ``incomplete``
    #: or ``not judged``.
    verdict: Judgement
    where: str  #: Mode, element or shaft that governs.
    coverage: str | None = None  #: How much of the train was judged, such as ``2 of 7 shafts``.
    #: What was not: elements with what is known of them, or an input.
    not_judged: str | None = None
    #: Limit over result, of allowable starts result over limit; None without both, and of a margin. [1]
    safety_factor: float | None = None


@dataclass(frozen=True)
class CaseVerdict(Verdict):
    """One check of the case under one condition of `StartConditions`."""

    condition: str = ""  #: Name of the condition.


@dataclass(frozen=True)
class AccuracyRow:
    """What one calculation was worth and what it cost."""

    method: str  #: Method of the time integration, or the analysis.
    setting: str  #: Wanted tolerance or step.
    #: Error of the peak torques, relative; None where the analysis has none. [1]
    error_peak: float | None
    #: Error of the allowable starts, relative; None where none is counted, or unlimited. [1]
    error_starts: float | None
    time: float  #: Wall time of an analysis; in a study processor time. [s]


@dataclass(frozen=True, eq=False)
class AtSpeed:
    """What holds without any start: modes, margins, forced response."""

    case: CaseData  #: What was asked. [SI]
    case_sha256: str  #: Digest of the inputs. [hex]
    train: Train  #: The train as arrays. [SI]
    modes: Modes  #: Natural modes. [SI]
    nodes: tuple[Node, ...]  #: Where the modes stand still.
    segments: tuple[tuple[str, int], ...]  #: Subdivision of shafts with inertia of their own.
    #: Estimated relative error of the frequencies from that subdivision. [1]
    frequency_error: float
    #: Modes up to here are within the wanted accuracy; infinite without subdivision. [Hz]
    accurate_up_to: float
    damping: ModalDamping  #: Damping of the modes. [SI]
    #: Damped eigenvalues where dampers couple the modes; None where damping is proportional. [1/s]
    eigenvalues: Complexes | None
    excitations: tuple[Excitation, ...]  #: What was judged. [SI]
    margins: SeparationMargins  #: Separation margins with verdicts. [1]
    interference: Interference  #: Lines of the interference diagram. [Hz]
    steady: SteadyState  #: Forced response. [SI]


@dataclass(frozen=True, eq=False)
class Results(AtSpeed):
    """Everything one run answers: what `AtSpeed` holds, the start, and events in operation."""

    start: Start | None  #: The start, or the response to prescribed torques. [SI]
    crossings: tuple[Crossing, ...]  #: Where 2 × slip crosses the modes. [SI]
    starts: AllowableStarts | None  #: Fatigue of the judged shafts. [1]
    #: Per judged shaft, estimated relative error of its allowable starts; None = unlimited. [1]
    starts_error: tuple[tuple[str, float | None], ...]
    spent: tuple[tuple[str, float], ...]  #: Wall time of each analysis in this run. [s]
    #: Every plan of this run; the last one is that of the results. [mixed]
    plans: tuple[Plan, ...]
    #: Torque reversals of meshes and geared couplings in the start that is reported. [SI]
    reversals: tuple[Reversal, ...]
    electrical_damping: tuple[ElectricalDamping, ...] = ()  #: What motors damp of the modes. [SI]
    events: tuple[OperatingEvent, ...] = ()  #: Events in operation. [SI]
    #: Estimated error and time of each analysis, as calculated. [1, s]
    accuracy: tuple[AccuracyRow, ...] = ()
    verdicts: tuple[Verdict, ...] = ()  #: The checks at a glance.
    #: The same of every typed condition, one condition after the other. [rows]
    case_verdicts: tuple[CaseVerdict, ...] = ()
    warnings: tuple[str, ...] = ()  #: What a reader must know beside the numbers.

    @property
    def outcome(self) -> str:
        """How the run as a whole ended: the start's outcome, or ``calculated``. [word]"""
        return self.start.outcome.outcome if self.start is not None else "calculated"
