"""Results as the result tables of the contract: rows of plain values under their JSON keys.

SI throughout, percentages as fractions (also `percent_speed`); CPM alone is in the unit of its name.
None stands for blank. Workbook and JSON are both written from these rows.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

import numpy as np

from engine.fatigue import shear_stress
from engine.margins import percent_speed
from engine.results import Results

__all__ = ["modal_details", "result_tables", "start_summary"]

Row = dict[str, Any]


def result_tables(results: Results) -> Mapping[str, list[Row]]:
    """The result tables of the contract.

    Parameters
    ----------
    results : Results
        A complete run. [SI]

    Returns
    -------
    mapping of str to list of dict
        Table name → rows with JSON keys. [SI]
    """
    return {
        "Verdicts": [asdict(v) for v in results.verdicts],
        "NaturalFrequencies": _frequencies(results),
        "ModeShapes": _mode_shapes(results),
        "SeparationMargins": [_margin_row(r) for r in results.margins.rows],
        "SteadyState": [asdict(r) for r in results.steady.rows],
        "StartupPeaks": _peaks(results),
        "StartupCrossings": [
            asdict(c) | {"percent_speed": _fraction(c.percent_speed)} for c in results.crossings
        ],
        "AllowableStarts": _starts(results),
    }


def start_summary(results: Results) -> Row | None:
    """Outcome of the start.

    Parameters
    ----------
    results : Results
        A complete run. [SI]

    Returns
    -------
    dict or None
        Keys outcome, time [s], end_speed [rad/s] and sentence; None if nothing was started.
    """
    return asdict(results.start.outcome) if results.start is not None else None


def modal_details(results: Results) -> Row:
    """What the sheets have no table for: energy shares, nodes, damped eigenvalues.

    Parameters
    ----------
    results : Results
        A complete run. [SI]

    Returns
    -------
    dict
        Key ``modes``: per elastic mode its frequency [Hz], the share of strain energy of each
        element and of kinetic energy of each station [1], and its nodes as element and position
        from the From end [1]. Key ``damped_eigenvalues``, where dampers couple the modes: real
        and imaginary parts [1/s].
    """
    train, modes = results.train, results.modes
    rows = []
    for r in range(modes.n_rigid, modes.n_modes):
        number = r - modes.n_rigid + 1
        rows.append(
            {
                "mode": number,
                "frequency": float(modes.frequency[r]),
                "strain_energy": dict(
                    zip(train.elements, modes.strain_share[:, r].tolist(), strict=True)
                ),
                "kinetic_energy": dict(
                    zip(train.stations, modes.kinetic_share[:, r].tolist(), strict=True)
                ),
                "nodes": [
                    {"element": n.element, "position": n.position}
                    for n in results.nodes
                    if n.mode == number
                ],
            }
        )
    details: Row = {"modes": rows}
    if results.eigenvalues is not None:
        details["damped_eigenvalues"] = [
            {"real": float(v.real), "imaginary": float(v.imag)} for v in results.eigenvalues
        ]
    return details


def _fraction(percent: float | None) -> float | None:
    return None if percent is None else percent / 100.0


def _frequencies(results: Results) -> list[Row]:
    modes, line = results.modes, results.case.ratings.line_frequency
    rows = []
    for r in range(modes.n_modes):
        f = float(modes.frequency[r])
        elastic = r >= modes.n_rigid
        share = modes.strain_share[:, r]
        top = int(np.argmax(share)) if elastic and len(share) else -1
        rows.append(
            {
                "mode": r - modes.n_rigid + 1 if elastic else 0,
                "frequency": f,
                "cpm": 60.0 * f,
                "percent_speed": _fraction(percent_speed(f, line)) if line and elastic else None,
                "damping_ratio": float(results.damping.ratio[r]) if elastic else None,
                "largest_strain_energy": results.train.elements[top] if elastic else None,
                "share": float(share[top]) if elastic else None,
            }
        )
    return rows


def _mode_shapes(results: Results) -> list[Row]:
    """Twist of each station in its physical sense, the largest of a mode = 1."""
    train, modes = results.train, results.modes
    n = train.n_stations
    angle = (train.node_matrix() @ modes.shape)[:n] * train.sense[:n, None]
    angle = angle[:, modes.n_rigid :]
    rows = []
    largest = angle[np.argmax(np.abs(angle), axis=0), np.arange(angle.shape[1])]
    shape = angle / np.where(largest != 0.0, largest, 1.0)
    for i, name in enumerate(train.stations):
        rows.append({"station": name} | {f"mode_{k + 1}": float(v) for k, v in enumerate(shape[i])})
    return rows


def _margin_row(row: Any) -> Row:
    out = asdict(row)
    out["frequency"] = out.pop("mode_frequency")
    return out


def _peaks(results: Results) -> list[Row]:
    start, synchronous = results.start, results.case.ratings.synchronous_speed
    if start is None:
        return []
    sections = {e.element: (e.stress_diameter, e.stress_bore or 0.0) for e in results.case.elements}
    rows = []
    for p in start.peaks:
        diameter, bore = sections[p.element]
        stress = float(shear_stress(p.peak_to_peak, diameter, bore)) if diameter else None
        rows.append(
            {
                "element": p.element,
                "maximum_torque": p.maximum,
                "minimum_torque": p.minimum,
                "peak_to_peak_torque": p.peak_to_peak,
                "peak_to_peak_stress": stress,
                "time": p.time,
                "percent_speed": p.speed / synchronous if synchronous else None,
                "error": p.relative_error,
            }
        )
    return rows


def _starts(results: Results) -> list[Row]:
    starts = results.starts
    if starts is None:
        return []
    errors = dict(results.starts_error)
    return [
        {
            "element": s.element,
            "damage": s.damage,
            "allowable_starts": s.allowable_starts,
            "unlimited": s.unlimited,
            "starts_low": s.starts_low,
            "starts_high": s.starts_high,
            "paper_count": s.paper_starts,
            "error": errors.get(s.element),
            "governing": s.element == starts.governing,
        }
        for s in starts.shafts
    ]
