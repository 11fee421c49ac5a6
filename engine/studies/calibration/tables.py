"""Rows of the tables of a calibration."""

from __future__ import annotations

from collections.abc import Iterable
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
    blank = _blank(calibration, "change_low", "change_high", "posterior_deviation", "reduction")
    return [
        asdict(p) | dict(zip(keys.get(p.quantity, ()), (p.before, p.after), strict=False)) | blank
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
    blank = _blank(calibration, "posterior_deviation")
    return [
        asdict(f) | {"change": f.after / f.before - 1.0} | blank for f in calibration.frequencies
    ]


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


def solution_rows(calibration: Calibration) -> list[dict[str, Any]]:
    """Rows of `CalibrationSolutions`.

    Parameters
    ----------
    calibration : Calibration
        The calibration. [SI]

    Returns
    -------
    list of dict
        Under their JSON keys; empty where there is one solution only. [1]
    """
    blank = _blank(calibration, "probability", "change_low", "change_high")
    return [asdict(s) | blank for s in calibration.solutions]


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
    before = _least((row.mode, row) for row in calibration.margins_before)
    after = _least(
        (number[row.mode], row) for row in calibration.margins_after if row.mode in number
    )
    return [
        {"mode": f.mode} | _margin(before[f.mode], "_before") | _margin(after[f.mode], "")
        for f in calibration.frequencies
        if f.mode in before and f.mode in after
    ]


def _blank(calibration: Calibration, *keys: str) -> dict[str, None]:
    """What samples of the posterior say, left blank where the measurements are not explained."""
    return {} if calibration.intervals_hold else dict.fromkeys(keys)


def _least(rows: Iterable[tuple[int, MarginRow]]) -> dict[int, MarginRow]:
    """The row with the least margin of each mode."""
    least: dict[int, MarginRow] = {}
    for mode, row in rows:
        least[mode] = min(least.get(mode, row), row, key=lambda r: r.margin)
    return least


def _margin(row: MarginRow, when: str) -> dict[str, Any]:
    return {
        f"frequency{when}": row.mode_frequency,
        f"excitation{when}": row.excitation,
        f"margin{when}": row.margin,
        f"required{when}": row.required,
        f"verdict{when}": str(row.verdict),
    }
