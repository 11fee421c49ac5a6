"""Rows of the tables of a sensitivity study."""

from __future__ import annotations

from typing import Any

import numpy as np

from engine.studies.sensitivities.sensitivities import LISTED_MODES, Derivatives


def derivative_rows(found: Derivatives) -> list[dict[str, Any]]:
    """Table of sensitivities under its JSON keys; changes are those for + 1 %, as fractions.

    Parameters
    ----------
    found : Derivatives
        The study. [1]

    Returns
    -------
    list of dict
        quantity, of, peak_change and peak_error by the derivative, peak_below and peak_above as they really
        are at − 1 % and + 1 %, the same of the starts, method, note. [1]
    """
    return [
        {
            "quantity": r.quantity,
            "of": r.of,
            "peak_change": _hundredth(r.peak),
            "peak_error": _hundredth(r.peak_error),
            "peak_below": None if r.peak_ends is None else r.peak_ends[0],
            "peak_above": None if r.peak_ends is None else r.peak_ends[1],
            "starts_change": _hundredth(r.starts),
            "starts_error": _hundredth(r.starts_error),
            "starts_below": None if r.starts_ends is None else r.starts_ends[0],
            "starts_above": None if r.starts_ends is None else r.starts_ends[1],
            "method": r.method,
            "note": r.note,
        }
        for r in found.rows
        if r.peak is not None or r.note
    ]


def frequency_rows(found: Derivatives) -> list[dict[str, Any]]:
    """Derivatives of the frequencies under their JSON keys, the strongest in the start first.

    The energies tell of every mode, so the rows go on to the tenth, where there are as many.

    Parameters
    ----------
    found : Derivatives
        The study. [1]

    Returns
    -------
    list of dict
        quantity, of, mode_1, mode_2, …: ∂ln f/∂ln of the quantity. [1]
    """
    n = len(found.frequencies)
    rows = sorted(
        found.energies.rows, key=lambda r: -float(np.max(np.abs(r.value[:n]), initial=0.0))
    )
    return [
        {
            "quantity": r.quantity,
            "of": r.name,
            **{
                f"mode_{i}": v
                for i, v in enumerate(r.value[: max(n, LISTED_MODES)].tolist(), start=1)
            },
        }
        for r in rows
    ]


def _hundredth(value: float | None) -> float | None:
    return None if value is None else 0.01 * value


def element_rows(found: Derivatives) -> list[dict[str, Any]]:
    """Change of the peak torque of every element, and of the starts of every shaft, for + 1 %.

    Parameters
    ----------
    found : Derivatives
        The study. [1]

    Returns
    -------
    list of dict
        quantity, of, element, peak_torque, peak_error, allowable_starts, starts_error. [1]
    """
    rows = []
    for i, (quantity, name) in enumerate(found.parameters):
        for j, element in enumerate(found.elements):
            row: dict[str, Any] = {
                "quantity": quantity,
                "of": name,
                "element": element,
                "peak_torque": 0.01 * float(found.peaks[i, j]),
                "peak_error": 0.01 * float(found.peak_errors[i, j]),
            }
            if element in found.shafts:
                k = found.shafts.index(element)
                row["allowable_starts"] = 0.01 * float(found.all_starts[i, k])
                row["starts_error"] = 0.01 * float(found.starts_errors[i, k])
            rows.append(row)
    return rows
