"""What a calibration says of parameters, frequencies and measurements."""

from __future__ import annotations

from dataclasses import dataclass

from engine.case.data import CaseData
from engine.operation.margins import MarginRow


@dataclass(frozen=True)
class CalibratedParameter:
    """One uncertain quantity, before and after."""

    quantity: str  #: Stiffness, inertia, damping or damping ratio.
    name: str  #: Whose; several that change together are joined by commas.
    #: What the case says, and what explains the measurements best; None for several. [SI]
    before: float | None
    after: float | None  #: Likewise. [SI]
    change: float  #: After over before, less 1. [1]
    change_low: float  #: The same at the ends of its 95 % interval. [1]
    change_high: float  #: Likewise. [1]
    prior_deviation: float  #: Standard deviation before and after measuring, over the value. [1]
    posterior_deviation: float  #: Likewise. [1]
    reduction: float  #: Share of the variance that the measurements took away. [1]
    pull: float  #: Change in prior standard deviations. [1]
    determined: str  #: ``determined``, ``partly`` or ``not determined``.
    note: str  #: What a reader must know.


@dataclass(frozen=True)
class CalibratedFrequency:
    """One elastic mode, before and after."""

    mode: int  #: Of the case, counted from 1.
    calibrated_mode: int  #: Its number after calibration.
    before: float  #: Calculated frequency. [Hz]
    after: float  #: Likewise. [Hz]
    #: Standard deviation of it from the uncertain quantities, over the frequency. [1]
    prior_deviation: float
    posterior_deviation: float  #: Likewise. [1]
    measured: float | None  #: What it was measured as; None = it was not. [Hz, 1]
    uncertainty: float | None  #: Likewise. [Hz, 1]
    mac: float  #: How far its shape is that of before: 1 the same, 0 another. [1]
    known: bool  #: Whether a margin may take it as measured.
    why: str  #: Why it may or may not.


@dataclass(frozen=True)
class Measurement:
    """One measurement and what became of it."""

    kind: str  #: ``frequency`` or ``peak torque``.
    row: int  #: Row of its table.
    of: str  #: Mode or element it was taken for; empty where there is none.
    measured: float  #: As typed. [Hz or N m]
    uncertainty: float  #: Standard deviation over it. [1]
    before: float | None = None  #: Calculated; None where it was taken for nothing. [Hz or N m]
    after: float | None = None  #: Likewise. [Hz or N m]
    #: Calculated minus measured over the standard deviation, before and after. [1]
    residual_before: float | None = None
    residual: float | None = None  #: Likewise. [1]
    #: The residual if all others, and not it, had been used, in its standard deviations. [1]
    left_out_residual: float | None = None
    used: bool = False  #: Whether it entered the calibration.
    #: Whether a change within the spread explains it; None where that cannot be judged.
    explained: bool | None = False
    note: str = ""  #: What to do about it.


@dataclass(frozen=True)
class CalibrationSolution:
    """One of several trains that explain the measurements, or come as near where none does."""

    solution: int  #: Counted from 1, the least misfit first.
    misfit: float  #: Sum of squares of changes and residuals. [1]
    probability: float  #: Of the trains around it, of all that explain the measurements. [1]
    quantity: str  #: One uncertain quantity, and whose.
    name: str  #: Likewise.
    change: float  #: Its change there, and the ends of its 95 % interval around it. [1]
    change_low: float  #: Likewise. [1]
    change_high: float  #: Likewise. [1]
    note: str  #: How the solution differs from the first.


@dataclass(frozen=True, eq=False)
class Calibration:
    """What the measurements say of the case."""

    parameters: tuple[CalibratedParameter, ...]  #: Every uncertain quantity. [rows]
    frequencies: tuple[CalibratedFrequency, ...]  #: Modes of interest. [rows]
    measurements: tuple[Measurement, ...]  #: Every measurement, frequencies first. [rows]
    chi_square: float  #: Least sum of squares of changes and residuals. [1]
    degrees: int  #: Measurements used, with which it is compared.
    probability: float  #: That chance alone makes it as large. [1]
    #: Whether everything measured is explained within the spread; None where nothing contradicts it but
    #: there are not more measurements than uncertain quantities, so that no misfit could show.
    explained: bool | None
    #: Whether the intervals and posterior deviations say anything of the machine; not where chance
    #: hardly makes the misfit as large: then the tables leave them blank.
    intervals_hold: bool
    #: Every quantity in every solution; empty where there is one solution only. [rows]
    solutions: tuple[CalibrationSolution, ...]
    #: Judged margins of the case, and of the calibrated one on its basis. [rows]
    margins_before: tuple[MarginRow, ...]
    margins_after: tuple[MarginRow, ...]  #: Likewise. [rows]
    basis: str  #: Of its required margins: ``calculated`` or ``measured``.
    basis_justified: bool  #: Whether the measurements justify ``measured``.
    basis_reason: str  #: Why.
    calibrated: CaseData  #: The calibrated case. [SI]
    starts: int  #: Starts calculated for the peak torques.
    sentence: str  #: What it comes to.
    notes: tuple[str, ...]  #: What was assumed or left out.
    study_sha256: str  #: Digest of the rows. [hex]
