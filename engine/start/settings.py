"""How a start is to be calculated: what the case asks for, blanks filled."""

from __future__ import annotations

from dataclasses import dataclass

from engine.case.choices import HistoryFile, Method
from engine.case.data import CaseData
from engine.case.defaults import DEFAULT_END_SPEED, DEFAULT_TOLERANCE_PEAK
from engine.case.effect import StartEffects
from engine.errors import ModelError

#: No effect beyond the plain start is simulated.
PLAIN_START = StartEffects()

#: An output below this share of the largest counts as that share: torque that is only rounding.
NEGLIGIBLE = 1e-9


@dataclass(frozen=True)
class StartSettings:
    """How a start is to be calculated."""

    method: str  #: ``exponential`` or ``newmark``.
    tolerance_peak: float  #: Wanted relative error of peak torques. [1]
    end_speed: float  #: Speed of the reference shaft at which the start ends. [rad/s]
    maximum_time: float | None  #: Longest simulated time; None = from the rigid-body run-up. [s]


def keeps_history(case: CaseData) -> bool:
    """Whether the case wants every sample of the start in a file: KeepHistory names a kind of file."""
    return case.keep_history not in (None, HistoryFile.NO)


def has_start(case: CaseData) -> bool:
    """Whether the case describes a start: there is a motor."""
    return bool(case.motor_stations)


def settings_of(case: CaseData) -> StartSettings:
    """Settings of the start, blanks filled; `ModelError` without synchronous speed."""
    synchronous = case.ratings.synchronous_speed
    if synchronous is None:
        raise ModelError(
            "A start needs the synchronous speed. Type SynchronousSpeed, or LineFrequency and "
            "Poles."
        )
    return StartSettings(
        case.method or Method.EXPONENTIAL,
        case.tolerance_peak or DEFAULT_TOLERANCE_PEAK,
        case.end_speed or DEFAULT_END_SPEED * synchronous,
        case.maximum_time,
    )
