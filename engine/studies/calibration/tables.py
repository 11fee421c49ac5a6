"""Rows of the tables of a calibration."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

from engine.case.study_inputs import INERTIA, STIFFNESS
from engine.operation.margins import MarginRow
from engine.studies.calibration.records import Calibration


def parameter_rows(calibration: Calibration) -> list[dict[str, Any]]:
    """Rows of `CalibratedParameters`.

    Parameters
    ----------
    calibration : Calibration
        The calibration. [SI]

    Returns
    -------
    list of dict
        Under their JSON keys. [SI]
    """
    keys = {
        STIFFNESS: ("stiffness", "calibrated_stiffness"),
        INERTIA: ("inertia", "calibrated_inertia"),
    }
    return [
        asdict(p) | dict(zip(keys.get(p.quantity, ()), (p.before, p.after), strict=False))
        for p in calibration.parameters
    ]


def frequency_rows(calibration: Calibration) -> list[dict[str, Any]]:
    """Rows of `CalibratedFrequencies`.

    Parameters
    ----------
    calibration : Calibration
        The calibration. [SI]

    Returns
    -------
    list of dict
        Under their JSON keys. [Hz, 1]
    """
    return [asdict(f) | {"change": f.after / f.before - 1.0} for f in calibration.frequencies]


def measurement_rows(calibration: Calibration, kind: str) -> list[dict[str, Any]]:
    """Rows of `FrequencyFit` or `PeakFit`.

    Parameters
    ----------
    calibration : Calibration
        The calibration. [SI]
    kind : str
        ``frequency`` or ``peak torque``. [word]

    Returns
    -------
    list of dict
        Under their JSON keys. [Hz or N m, 1]
    """
    rows = [asdict(m) for m in calibration.measurements if m.kind == kind]
    name = "mode" if kind == "frequency" else "element"
    return [{name: row.pop("of")} | {k: v for k, v in row.items() if k != "kind"} for row in rows]


def margin_rows(calibration: Calibration) -> list[dict[str, Any]]:
    """Rows of `CalibratedMargins`: least margin of each mode before and after.

    Parameters
    ----------
    calibration : Calibration
        The calibration. [1]

    Returns
    -------
    list of dict
        Under their JSON keys. [Hz, 1]
    """
    number = {f.calibrated_mode: f.mode for f in calibration.frequencies}
    before: dict[int, MarginRow] = {}
    after: dict[int, MarginRow] = {}
    for row in calibration.margins_before:
        before[row.mode] = min(before.get(row.mode, row), row, key=lambda r: r.margin)
    for row in calibration.margins_after:
        mode = number.get(row.mode)
        if mode is not None:
            after[mode] = min(after.get(mode, row), row, key=lambda r: r.margin)
    return [
        {
            "mode": f.mode,
            "frequency_before": before[f.mode].mode_frequency,
            "excitation_before": before[f.mode].excitation,
            "margin_before": before[f.mode].margin,
            "required_before": before[f.mode].required,
            "verdict_before": str(before[f.mode].verdict),
            "frequency": after[f.mode].mode_frequency,
            "excitation": after[f.mode].excitation,
            "margin": after[f.mode].margin,
            "required": after[f.mode].required,
            "verdict": str(after[f.mode].verdict),
        }
        for f in calibration.frequencies
        if f.mode in before and f.mode in after
    ]
