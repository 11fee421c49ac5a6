"""Calibration against measurements as a study; see `engine.studies.calibration.calibration`."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from addin.contract.studies.calibration import CALIBRATION as CALIBRATION_SPEC
from addin.studies.study import Found, Study

if TYPE_CHECKING:
    from addin.workers.parallel_map import Spread
    from engine.case.case import Case
    from engine.case.data import CaseData
    from engine.case.study_inputs import StudyInputs
    from engine.errors import Problem

__all__ = ["CALIBRATION"]


def _check(case: Case, inputs: StudyInputs, settings: Mapping[str, Any]) -> Sequence[Problem]:
    from engine.studies.calibration.inputs import calibration_problems

    return calibration_problems(case, inputs)


def _calculate(
    case: Case,
    inputs: StudyInputs,
    settings: Mapping[str, Any],
    spread: Spread,
    tell: Callable[[str], None],
) -> Found:
    from engine.studies.calibration.calibration import calibrate
    from engine.studies.calibration.tables import (
        frequency_rows,
        margin_rows,
        measurement_rows,
        parameter_rows,
    )

    def each(do: Callable[[CaseData], Any], cases: Iterable[CaseData]) -> list[Any]:
        bundle = list(cases)
        return spread(
            do, bundle, lambda done: tell(f"start {min(done + 1, len(bundle))} of {len(bundle)}")
        )

    tell("measured frequencies")
    found = calibrate(case, inputs, each_start=each)
    return Found(
        result=found,
        tables={
            "FrequencyFit": measurement_rows(found, "frequency"),
            "PeakFit": measurement_rows(found, "peak torque"),
            "CalibratedFrequencies": frequency_rows(found),
            "CalibratedMargins": margin_rows(found),
            "CalibratedParameters": parameter_rows(found),
        },
        sentence=" ".join((found.sentence, found.basis_reason, *found.notes)),
        digest=found.study_sha256,
        details={
            "chi_square": found.chi_square,
            "degrees": found.degrees,
            "probability": found.probability,
            "explained": found.explained,
            "margin_basis": found.basis,
            "margin_basis_justified": found.basis_justified,
            "margin_basis_reason": found.basis_reason,
            "starts": found.starts,
        },
        units=inputs.units,
    )


CALIBRATION = Study(
    spec=CALIBRATION_SPEC,
    check=_check,
    calculate=_calculate,
)
