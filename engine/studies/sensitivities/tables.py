"""Rows of the tables of a sensitivity study."""

from __future__ import annotations

from typing import Any

import numpy as np

from engine.studies.sensitivities.sensitivities import LISTED_MODES, Derivatives


def derivative_rows(derivatives: Derivatives) -> list[dict[str, Any]]:
    """Table of sensitivities under its JSON keys; changes are those for + 1 %, as fractions.

    Parameters
    ----------
    derivatives : Derivatives
        The study. [1]

    Returns
    -------
    list of dict
        quantity, of, peak_change and peak_error by the derivative, peak_below and peak_above as they really
        are at − 1 % and + 1 %, the same of the starts, method, note. [1]
    """
    rows = []
    for r in derivatives.rows:
        if r.peak is None and not r.note:
            continue
        row: dict[str, Any] = {"quantity": r.quantity, "of": r.of}
        for answer in ("peak", "starts"):
            change, error = getattr(r, answer), getattr(r, f"{answer}_error")
            row[f"{answer}_change"] = None if change is None else 0.01 * change
            row[f"{answer}_error"] = None if error is None else 0.01 * error
            ends = getattr(r, f"{answer}_ends") or (None, None)
            row[f"{answer}_below"], row[f"{answer}_above"] = ends
        rows.append(row | {"method": r.method, "note": r.note})
    return rows


def frequency_rows(derivatives: Derivatives) -> list[dict[str, Any]]:
    """Derivatives of the frequencies under their JSON keys, the strongest in the start first.

    The energies are known for every mode, so the rows go on to the tenth, where there are as many.

    Parameters
    ----------
    derivatives : Derivatives
        The study. [1]

    Returns
    -------
    list of dict
        quantity, of, mode_1, mode_2, …: ∂ln f/∂ln of the quantity. [1]
    """
    n = len(derivatives.frequencies)
    rows = sorted(
        derivatives.energies.rows, key=lambda r: -float(np.max(np.abs(r.value[:n]), initial=0.0))
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


def element_rows(derivatives: Derivatives) -> list[dict[str, Any]]:
    """Change of the peak torque of every element, and of the starts of every shaft, for + 1 %.

    Parameters
    ----------
    derivatives : Derivatives
        The study. [1]

    Returns
    -------
    list of dict
        quantity, of, element, peak_torque, peak_error, allowable_starts, starts_error. [1]
    """
    peak_errors, starts_errors = derivatives.stated_peak_errors, derivatives.stated_starts_errors
    rows = []
    for i, (quantity, name) in enumerate(derivatives.parameters):
        for j, element in enumerate(derivatives.elements):
            row: dict[str, Any] = {
                "quantity": quantity,
                "of": name,
                "element": element,
                "peak_torque": 0.01 * float(derivatives.peaks[i, j]),
                "peak_error": 0.01 * float(peak_errors[i, j]),
            }
            if element in derivatives.shafts:
                k = derivatives.shafts.index(element)
                row["allowable_starts"] = 0.01 * float(derivatives.all_starts[i, k])
                row["starts_error"] = 0.01 * float(starts_errors[i, k])
            rows.append(row)
    return rows
