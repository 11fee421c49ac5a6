"""What a calibration is asked: uncertain quantities and measurements, checked and planned."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from engine.case.checks.problem import POSITIVE, Allowed, Cells, Limit, each_row, first_of_each_cell
from engine.case.data import CaseData, value_of
from engine.case.study_inputs import (
    DAMPING,
    DAMPING_RATIO,
    INERTIA,
    STIFFNESS,
    MeasuredFrequencyRow,
    MeasuredPeakRow,
    ScatterRow,
    StudyInputs,
)
from engine.errors import Problem
from engine.model.subdivision import natural_modes
from engine.start.settings import has_start
from engine.studies.calibration.least_squares import PeakReading, Reading
from engine.studies.scatter import FROM_TO, NORMAL, Factor, factors_of, scatter_problems
from engine.studies.variation import names_with

FREQUENCIES, PEAKS = "MeasuredFrequencies", "MeasuredPeaks"
#: Spread of every stiffness where `Scatter` has none of stiffness or inertia: normal. [1]
DEFAULT_SPREAD = 0.10
#: Uncertainty of a measured frequency and of a peak torque where it is blank. [1]
DEFAULT_FREQUENCY_UNCERTAINTY, DEFAULT_PEAK_UNCERTAINTY = 0.01, 0.05
_UNCERTAINTY = Limit(
    "Uncertainty",
    Allowed(lambda share: 1e-6 <= share < 1.0, "from 0.0001 % to below 100 %, or blank"),
    action="It is the standard deviation divided by the value: write 1 % or 0.01.",
)
#: Quantities that move a frequency, and those that only move a peak torque.
OF_FREQUENCIES, OF_PEAKS = (STIFFNESS, INERTIA), (DAMPING, DAMPING_RATIO)


@dataclass(frozen=True)
class CalibrationPlan:
    """What is uncertain, what was measured, and what it costs."""

    factors: tuple[Factor, ...]  #: Uncertain quantities. [1]
    frequencies: tuple[Reading, ...]  #: Measured frequencies. [Hz]
    peaks: tuple[PeakReading, ...]  #: Measured peak torques. [N m]
    notes: tuple[str, ...]  #: What was assumed or left out.


# --- what was typed -------------------------------------------------------------------------------


def calibration_problems(case: CaseData, studies: StudyInputs) -> tuple[Problem, ...]:
    """Everything wrong with the measurements and the uncertain quantities.

    Parameters
    ----------
    case : CaseData
        A checked case. [SI]
    studies : StudyInputs
        Its rows. [SI]

    Returns
    -------
    tuple of Problem
        Empty if the case may be calibrated; at most one problem a cell. [count]
    """
    return tuple(first_of_each_cell(_problems(case, studies), ()))


def _problems(case: CaseData, studies: StudyInputs) -> Iterator[Problem]:
    if studies.scatter:
        yield from scatter_problems(case, studies.scatter)
    if not studies.measured_frequencies and not studies.measured_peaks:
        words = (
            "nothing was measured: tables MeasuredFrequencies and MeasuredPeaks are empty. Type the "
            "measured natural frequencies, or peak torques of a measured start."
        )
        yield Cells(FREQUENCIES).problem("", None, "at least one measurement", words)
    yield from _frequency_problems(case, studies.measured_frequencies)
    yield from _peak_problems(case, studies.measured_peaks)


def _frequency_problems(case: CaseData, rows: Sequence[MeasuredFrequencyRow]) -> Iterator[Problem]:
    n_elastic = len(natural_modes(case).modes.elastic_frequency) if rows else 0
    first: dict[int, int | None] = {}
    for cells, row in each_row(FREQUENCIES, rows):
        yield from _measured(cells, row, "Frequency", "Hz", "a frequency")
        if row.mode is None:
            continue
        if not 1 <= row.mode <= n_elastic:
            words = (
                f"found {row.mode}; it must be from 1 to {n_elastic}, as the train has {n_elastic} "
                "elastic modes, or blank. See sheet Results."
            )
            yield cells.problem("Mode", row.mode, f"from 1 to {n_elastic}, or blank", words)
        elif row.mode in first:
            words = (
                f"found {row.mode}, also in row {first[row.mode]}. Keep the better measurement, or "
                "type their mean with its uncertainty."
            )
            yield cells.problem("Mode", row.mode, "a mode that no other row names", words)
        first.setdefault(row.mode, cells.row)


def _peak_problems(case: CaseData, rows: Sequence[MeasuredPeakRow]) -> Iterator[Problem]:
    if rows and not has_start(case):
        words = (
            "the case has no rows in table MotorTorque, so there is no start whose peak torques could "
            "be compared. Give the motor's torque curve, or clear table MeasuredPeaks."
        )
        yield Cells(PEAKS).problem("", None, "a case with a motor torque curve", words)
    names = {e.element for e in case.elements}
    known, action = "an element of table Elements", "Name the one where the torque was measured."
    first: dict[str, int | None] = {}
    for cells, row in each_row(PEAKS, rows):
        yield from _measured(cells, row, "Maximum torque", "N m", "a peak torque")
        if not row.element:
            yield cells.blank("Element", known, action)
        elif row.element not in names:
            yield cells.wrong("Element", row.element, known, action)
        elif row.element in first:
            words = f"found '{row.element}', also in row {first[row.element]}. Keep one of them."
            yield cells.problem("Element", row.element, "an element that no other row names", words)
        first.setdefault(str(row.element), cells.row)


def _measured(cells: Cells, row: object, column: str, unit: str, what: str) -> Iterator[Problem]:
    """The number that was measured, and its uncertainty."""
    action = f"Type {what} as it was measured, or clear the row."
    if value_of(row, column) is None:
        yield cells.blank(column, POSITIVE.words, action)
    yield from cells.numbers(row, (Limit(column, POSITIVE, unit, action), _UNCERTAINTY))


# --- the plan -------------------------------------------------------------------------------------


def plan_calibration(case: CaseData, studies: StudyInputs) -> CalibrationPlan:
    """What is uncertain and what was measured.

    Parameters
    ----------
    case : CaseData
        A checked case. [SI]
    studies : StudyInputs
        Its checked rows. [SI]

    Returns
    -------
    CalibrationPlan
        Factors and measurements. [SI]
    """
    factors, notes = _factors(case, studies)
    frequencies = tuple(
        Reading(
            float(row.frequency or 0.0),
            row.uncertainty or DEFAULT_FREQUENCY_UNCERTAINTY,
            None if row.mode is None else row.mode - 1,
            number,
        )
        for number, row in enumerate(studies.measured_frequencies, start=1)
    )
    peaks = tuple(
        PeakReading(
            str(row.element),
            float(row.maximum_torque or 0.0),
            row.uncertainty or DEFAULT_PEAK_UNCERTAINTY,
            number,
        )
        for number, row in enumerate(studies.measured_peaks, start=1)
    )
    return CalibrationPlan(
        factors=factors,
        frequencies=tuple(sorted(frequencies, key=lambda r: (r.frequency, r.uncertainty))),
        peaks=tuple(sorted(peaks, key=lambda r: r.element)),
        notes=notes,
    )


def _factors(case: CaseData, studies: StudyInputs) -> tuple[tuple[Factor, ...], tuple[str, ...]]:
    """Uncertain quantities, and what was assumed of them."""
    wanted = (*OF_FREQUENCIES, *OF_PEAKS) if studies.measured_peaks else OF_FREQUENCIES
    typed = [f for f in factors_of(case, studies.scatter) if f.scatters]
    factors = tuple(f for f in typed if f.quantity in wanted)
    left_out = sorted({f.quantity for f in typed} - set(wanted))
    notes = []
    if not any(f.quantity in OF_FREQUENCIES for f in factors):
        row = ScatterRow(None, STIFFNESS, NORMAL, DEFAULT_SPREAD)
        default = factors_of(case, (row,)) if names_with(case, STIFFNESS) else ()
        factors = (*default, *factors)
        why = "has no stiffness or inertia" if studies.scatter else "is blank"
        notes.append(
            f"Table Scatter {why}: every stiffness is taken as uncertain by ±{DEFAULT_SPREAD:.0%} "
            "(one standard deviation), independently."
        )
    if left_out:
        notes.append(
            f"Scatter of {', '.join(left_out)} is not calibrated: "
            + (
                "only stiffness, inertia and damping are."
                if studies.measured_peaks
                else "frequencies do not depend on it. Measured peak torques would determine damping."
            )
        )
    for f in factors:
        if f.distribution == FROM_TO and abs(0.5 * (f.from_ + f.to) - 1.0) > 1e-9:
            notes.append(
                f"{f.label}: the range {f.from_:g} to {f.to:g} is not centred on 1; the change is "
                f"measured from its middle, {0.5 * (f.from_ + f.to):g} times the value in the case."
            )
    return factors, tuple(notes)
