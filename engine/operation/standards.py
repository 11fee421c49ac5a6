"""What a standard asks of a train, and where the results show it.

Each profile has the separation margin that it requires and the analyses that it asks for, each with its source. The
paper is at hand and was read. The texts of API were not: what stands here of them is what others have published of
them, and every row of the results says so.

References
----------
Szenasi & von Nimitz, Transient analyses of synchronous motor trains, 7th Turbomachinery Symposium (1978).
Wang, Feese & Pettinato, Torsional natural frequencies: measurement vs. prediction, 41st Turbomachinery Symposium
(2012), which quotes the margin of API 617 and of API 684.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from engine.case.choices import MarginBasis, MotorEventKind, Standard
from engine.case.data import CaseData

__all__ = [
    "Requirement",
    "StandardProfile",
    "profile_of",
    "required_margin",
    "short_circuits_missing",
]

_PAPER = "Szenasi & von Nimitz (1978), {}"
_STEADY = _PAPER.format("Steady state torsional analysis")
_TRANSIENT = _PAPER.format("Transient torsional analyses")
_STRESS = _PAPER.format("Stress criterion")
_REVERSALS = _PAPER.format("Torque reversals")
_API_617 = "API 617 and 684 as quoted by Wang, Feese & Pettinato (2012)"
_API_MOTORS = "API 541 and 546"

#: Begins of names of checks; an analysis is shown by the checks whose names begin so.
MARGIN = "Separation margin"
RESPONSE = ("Steady-state", "Vibratory torque")
START = ("Start",)
STRENGTH = ("Peak torque", "Shear yield")
REVERSAL = ("Torque reversal",)
STARTS = ("Allowable starts",)
EVENTS = ("Events in operation", "Peak torque in events", "Shear yield in events")


@dataclass(frozen=True)
class Requirement:
    """One analysis that a standard asks for."""

    requirement: str  #: Its name.
    demand: str  #: What is asked, as a sentence.
    source: str  #: Who asks for it.
    read: bool  #: Whether the text itself was read.
    #: Checks that show it, by the beginnings of their names.
    checks: tuple[str, ...]


@dataclass(frozen=True)
class StandardProfile:
    """A standard as far as it is about torsional vibration."""

    name: str  #: The word in `Standard`; "Szenasi" where that is blank.
    #: Required margin by `MarginBasis`; empty where it has to be typed. [1]
    margins: Mapping[str, float]
    requirements: tuple[Requirement, ...]  #: What it asks for.

    @property
    def margin_source(self) -> str:
        """Who asks for the margin."""
        return next((r.source for r in self.requirements if r.checks == (MARGIN,)), "")


_PAPERS_MARGINS: Mapping[str, float] = {MarginBasis.CALCULATED: 0.20, MarginBasis.MEASURED: 0.10}
_TENTH: Mapping[str, float] = {basis.value: 0.10 for basis in MarginBasis}

_START_OF_API = Requirement(
    "Start of a synchronous motor",
    "A transient analysis of the start, with the torque of every shaft, coupling and mesh, and the number of starts.",
    "API 617 and 684",
    False,
    START + STRENGTH + STARTS,
)

PROFILES: Mapping[str, StandardProfile] = {
    p.name: p
    for p in (
        StandardProfile(
            Standard.SZENASI,
            _PAPERS_MARGINS,
            (
                Requirement(
                    "Separation margin",
                    "20 % where the natural frequency is calculated, 10 % where it is measured.",
                    _STEADY, True, (MARGIN,),
                ),
                Requirement(
                    "Forced response",
                    "Where a margin is too small: stress with SCF at most a 25th of the ultimate tensile strength.",
                    _STEADY, True, RESPONSE,
                ),
                Requirement(
                    "Start", "The start through every mode below twice line frequency.", _TRANSIENT, True, START,
                ),
                Requirement("Peak torques", "Peak torques within the strength of shafts and couplings.", _STRESS, True, STRENGTH),
                Requirement("Torque reversal", "Teeth that part and strike are found and judged.", _REVERSALS, True, REVERSAL),
                Requirement("Number of starts", "The number of starts by cumulative fatigue.", _STRESS, True, STARTS),
            ),
        ),
        StandardProfile(
            Standard.API_617,
            _TENTH,
            (
                Requirement(
                    "Separation margin", "10 % between a natural frequency and an excitation.", _API_617, False, (MARGIN,),
                ),
                Requirement(
                    "Stress analysis",
                    "Where a margin is too small: stresses that show no harm.",
                    _API_617, False, RESPONSE,
                ),
                _START_OF_API,
            ),
        ),
        StandardProfile(
            Standard.API_541,
            _TENTH,
            (
                Requirement(
                    "Separation margin",
                    "10 % between a natural frequency and an excitation, as API 617 has it.",
                    _API_MOTORS, False, (MARGIN,),
                ),
                _START_OF_API,
                Requirement(
                    "Short circuits",
                    "Torques of a three-phase and of a line-to-line short circuit.",
                    _API_MOTORS, False, EVENTS,
                ),
            ),
        ),
        StandardProfile(
            Standard.OWN,
            {},
            (Requirement("Separation margin", "The margin that is typed.", "MarginRequired", True, (MARGIN,)),),
        ),
    )
}  # fmt: skip


def profile_of(case: CaseData) -> StandardProfile:
    """The profile of a case; that of the paper where `Standard` is blank."""
    return PROFILES[case.standard or Standard.SZENASI]


def required_margin(case: CaseData) -> float:
    """Required margin: MarginRequired, else that of the standard by MarginBasis.

    Parameters
    ----------
    case : CaseData
        A checked case. [SI]

    Returns
    -------
    float
        Required margin. [1]
    """
    if case.margin_required is not None:
        return case.margin_required
    return profile_of(case).margins[case.margin_basis or MarginBasis.CALCULATED]


def short_circuits_missing(case: CaseData) -> Sequence[str]:
    """Short circuits that a standard asks for and the case has no event of.

    A fault in `EventTorque` is a maker's formula: which fault it is only its name says, so any counts for both.
    """
    if case.event_torque:
        return ()
    kinds = {row.kind for row in case.motor_events}
    wanted = (MotorEventKind.THREE_PHASE_FAULT, MotorEventKind.LINE_TO_LINE_FAULT)
    return tuple(kind.value for kind in wanted if kind not in kinds)
