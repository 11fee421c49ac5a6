"""Results as the result tables of the contract: rows of plain values under their JSON keys.

SI throughout, percentages as fractions (also `percent_speed`); CPM alone is in the unit of its name.
None stands for blank. Workbook and JSON are both written from these rows. Each table has one function,
of its name in small letters; a new column is a key in that function's rows.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import asdict
from typing import Any

import numpy as np

from engine.fatigue.stress import shear_stress
from engine.operation.margins import percent_speed
from engine.results.results import AccuracyRow, AtSpeed, Results
from engine.start.start_fatigue import is_counted

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
        "Verdicts": verdicts(results),
        **speed_tables(results),
        "StartupPeaks": startup_peaks(results),
        "StartupCrossings": startup_crossings(results),
        "TorqueReversals": torque_reversals(results),
        "AllowableStarts": allowable_starts(results),
        "Effects": effects(results),
        "AccuracyCost": accuracy_cost(results.accuracy),
    }


def speed_tables(results: AtSpeed) -> dict[str, list[Row]]:
    """The result tables that need no start.

    Parameters
    ----------
    results : AtSpeed
        Modes, margins and forced response. [SI]

    Returns
    -------
    dict of str to list of dict
        Table name → rows with JSON keys. [SI]
    """
    return {
        "NaturalFrequencies": natural_frequencies(results),
        "ModeShapes": mode_shapes(results),
        "SeparationMargins": separation_margins(results),
        "SteadyState": steady_state(results),
    }


def torque_reversals(results: Results) -> list[Row]:
    """Rows of `TorqueReversals`.

    Parameters
    ----------
    results : Results
        A complete run. [SI]

    Returns
    -------
    list of dict
        One a gear mesh or geared coupling, its sentence as ``note``. [SI]
    """
    keys = (
        "element",
        "minimum_torque",
        "reversals",
        "time_unloaded",
        "impacts",
        "recontact_speed",
        "tooth_force",
        "longest_reversal",
        "first_time",
        "slip_frequency",
        "transmitted_torque",
        "margin",
        "limit",
        "verdict",
        "recontact_speed_angular",
        "model",
    )
    return [
        {key: getattr(reversal, key) for key in keys} | {"note": reversal.sentence}
        for reversal in results.reversals
    ]


def effects(results: Results) -> list[Row]:
    """Rows of `Effects`: the decisions of the plan whose run is reported.

    Parameters
    ----------
    results : Results
        A complete run. [SI]

    Returns
    -------
    list of dict
        One an effect. [SI]
    """
    decisions = results.plans[-1].decisions if results.plans else ()
    return [asdict(decision) for decision in decisions]


def verdicts(results: Results) -> list[Row]:
    """Rows of `Verdicts`.

    Parameters
    ----------
    results : Results
        A complete run. [SI]

    Returns
    -------
    list of dict
        One a check, the overall one first. [SI]
    """
    return [asdict(verdict) for verdict in results.verdicts]


def startup_crossings(results: Results) -> list[Row]:
    """Rows of `StartupCrossings`.

    Parameters
    ----------
    results : Results
        A complete run. [SI]

    Returns
    -------
    list of dict
        One a mode that the falling 2 × slip frequency crosses. [SI]
    """
    return [
        asdict(crossing) | {"percent_speed": _fraction(crossing.percent_speed)}
        for crossing in results.crossings
    ]


def accuracy_cost(rows: Iterable[AccuracyRow]) -> list[Row]:
    """Rows of `AccuracyCost`.

    Parameters
    ----------
    rows : iterable of AccuracyRow
        Of a study, or as calculated. [SI]

    Returns
    -------
    list of dict
        Keys method, setting, error_peak [1], error_starts [1] and time [s].
    """
    return [
        {
            "method": row.method,
            "setting": row.setting,
            "error_peak": row.error_peak,
            "error_starts": row.error_starts,
            "time": row.time,
        }
        for row in rows
    ]


def _fraction(percent: float | None) -> float | None:
    return None if percent is None else percent / 100.0


def natural_frequencies(results: AtSpeed) -> list[Row]:
    """Rows of `NaturalFrequencies`.

    Parameters
    ----------
    results : AtSpeed
        A complete run, or one without a start. [SI]

    Returns
    -------
    list of dict
        One a mode, rigid ones first. [SI]
    """
    modes, line = results.modes, results.case.ratings.line_frequency
    train = results.train
    names = [*train.elements, *(f"bearing of {train.stations[b.station]}" for b in train.bodies)]
    shares = np.concatenate([modes.strain_share, modes.bearing_share])
    rows = []
    for r in range(modes.n_modes):
        f = float(modes.frequency[r])
        elastic = r >= modes.n_rigid
        share = shares[:, r]
        top = int(np.argmax(share)) if elastic and len(share) else -1
        rows.append(
            {
                "mode": r - modes.n_rigid + 1 if elastic else 0,
                "frequency": f,
                "cpm": 60.0 * f,
                "percent_speed": _fraction(percent_speed(f, line)) if line and elastic else None,
                "damping_ratio": float(results.damping.ratio[r]) if elastic else None,
                "largest_strain_energy": names[top] if elastic else None,
                "share": float(share[top]) if elastic else None,
            }
        )
    return rows


def mode_shapes(results: AtSpeed) -> list[Row]:
    """Rows of `ModeShapes`: twist of each station in its physical sense, the largest of a mode = 1.

    Parameters
    ----------
    results : AtSpeed
        A complete run, or one without a start. [SI]

    Returns
    -------
    list of dict
        One a station. [SI]
    """
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


def separation_margins(results: AtSpeed) -> list[Row]:
    """Rows of `SeparationMargins`: margins and what the forced response made of them.

    Parameters
    ----------
    results : AtSpeed
        A complete run, or one without a start. [SI]

    Returns
    -------
    list of dict
        One a row, under the keys of the JSON. [SI]
    """
    rows = []
    for margin in results.margins.rows:
        row = asdict(margin)
        row["frequency"] = row.pop("mode_frequency")
        rows.append(row)
    return rows


def steady_state(results: AtSpeed) -> list[Row]:
    """Rows of `SteadyState`: the forced response of each element to each excitation.

    Parameters
    ----------
    results : AtSpeed
        A complete run, or one without a start. [SI]

    Returns
    -------
    list of dict
        One a row, under the keys of the JSON. [SI]
    """
    return [asdict(row) for row in results.steady.rows]


def startup_peaks(results: Results) -> list[Row]:
    """Rows of `StartupPeaks`.

    Parameters
    ----------
    results : Results
        A complete run. [SI]

    Returns
    -------
    list of dict
        One an element; none without a start. [SI]
    """
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


def allowable_starts(results: Results) -> list[Row]:
    """Rows of `AllowableStarts`.

    Parameters
    ----------
    results : Results
        A complete run. [SI]

    Returns
    -------
    list of dict
        One a judged shaft. [SI]
    """
    starts = results.starts
    if starts is None:
        return []
    errors = dict(results.starts_error)
    if not is_counted(results.start):
        # What happened until then has its damage; how many such starts are allowed is not judged.
        return [{"element": s.element, "damage": s.damage} for s in starts.shafts]
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
