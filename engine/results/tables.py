"""Results as the result tables of the contract: rows of plain values under their JSON keys.

SI throughout, percentages as fractions (also `percent_speed`); CPM alone is in the unit of its name.
None stands for blank. Workbook and JSON are both written from these rows.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import asdict
from typing import Any

import numpy as np

from engine.fatigue.stress import shear_stress
from engine.model.frequency_derivatives import frequency_derivatives
from engine.operation.margins import percent_speed
from engine.plan.decision import EffectDecision
from engine.results.results import AccuracyRow, AtSpeed, Results
from engine.start.reversals import Reversal
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
        "Verdicts": [asdict(v) for v in results.verdicts],
        **speed_tables(results),
        "StartupPeaks": _peaks(results),
        "StartupCrossings": [
            asdict(c) | {"percent_speed": _fraction(c.percent_speed)} for c in results.crossings
        ],
        "TorqueReversals": reversal_rows(results.reversals),
        "AllowableStarts": _starts(results),
        "Effects": effect_rows(results.plans[-1].decisions if results.plans else ()),
        "AccuracyCost": accuracy_rows(results.accuracy),
    }


def speed_tables(found: AtSpeed) -> dict[str, list[Row]]:
    """The result tables that need no start.

    Parameters
    ----------
    found : AtSpeed
        Modes, margins and forced response. [SI]

    Returns
    -------
    dict of str to list of dict
        Table name → rows with JSON keys. [SI]
    """
    return {
        "NaturalFrequencies": _frequencies(found),
        "ModeShapes": _mode_shapes(found),
        "SeparationMargins": [_margin_row(r) for r in found.margins.rows],
        "SteadyState": [asdict(r) for r in found.steady.rows],
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
        Keys outcome, time [s], end_speed [rad/s] and sentence, pull_in and bearing_forces where
        they were simulated; None if nothing was started.
    """
    if results.start is None:
        return None
    summary = asdict(results.start.outcome)
    if results.pull_in is not None:
        summary["pull_in"] = asdict(results.pull_in)
    if results.bearing_forces:
        summary["bearing_forces"] = [asdict(one) for one in results.bearing_forces]
    return summary


def plan_details(results: Results) -> Row:
    """Plans and sensitivity of the run.

    Parameters
    ----------
    results : Results
        A complete run. [SI]

    Returns
    -------
    dict
        Key ``plans``: number [count] and reason of each plan, the reported one last. Key
        ``sensitivity``, where it was tried: spread [1] and sensitive.
    """
    details: Row = {
        "plans": [{"number": plan.number, "reason": plan.reason} for plan in results.plans]
    }
    if results.sensitivity is not None:
        details["sensitivity"] = asdict(results.sensitivity)
    return details


def energy_rows(results: AtSpeed, most_modes: int) -> list[Row]:
    """Energy shares of every stiffness and inertia, from which frequencies follow a small change.

    ∂ln f/∂ln k = ½ × share of the strain energy, ∂ln f/∂ln J = −½ × share of the kinetic energy
    (`engine.model.frequency_derivatives`, where modes as good as equal are treated as well).

    Parameters
    ----------
    results : AtSpeed
        A complete run, or one without a start. [SI]
    most_modes : int
        Elastic modes that are told. [count]

    Returns
    -------
    list of dict
        quantity, of, share_1, share_2, …: stiffnesses first, in the order of the case. [1]
    """
    found = frequency_derivatives(results.case, results.train, results.modes)
    return [
        {
            "quantity": row.quantity,
            "of": row.name,
            **{
                f"share_{k}": 2.0 * abs(value)
                for k, value in enumerate(row.value[:most_modes].tolist(), 1)
            },
        }
        for row in found.rows
    ]


def modal_details(results: AtSpeed) -> Row:
    """What the sheets have no table for: energy shares, nodes, damped eigenvalues.

    Parameters
    ----------
    results : AtSpeed
        A complete run, or one without a start. [SI]

    Returns
    -------
    dict
        Key ``modes``: per elastic mode its frequency [Hz], the share of strain energy of each
        element and of kinetic energy of each station [1], and its nodes as element and position
        from the From end [1]; of gears on bearings also ``bearing_strain_energy`` and
        ``sideways_kinetic_energy`` by station [1]. Key ``damped_eigenvalues``, where dampers couple the modes: real
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
            | _sideways(results, r)
        )
    details: Row = {"modes": rows}
    if results.eigenvalues is not None:
        details["damped_eigenvalues"] = [
            {"real": float(v.real), "imaginary": float(v.imag)} for v in results.eigenvalues
        ]
    return details


def reversal_rows(reversals: Iterable[Reversal]) -> list[Row]:
    """Rows of `TorqueReversals`.

    Parameters
    ----------
    reversals : iterable of Reversal
        One a gear mesh or geared coupling. [SI]

    Returns
    -------
    list of dict
        Its fields under their names, the sentence as ``note``. [SI]
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
    return [{key: getattr(one, key) for key in keys} | {"note": one.sentence} for one in reversals]


def effect_rows(decisions: Iterable[EffectDecision]) -> list[Row]:
    """Rows of `Effects`.

    Parameters
    ----------
    decisions : iterable of EffectDecision
        Those of the plan whose run is reported. [SI]

    Returns
    -------
    list of dict
        One an effect. [SI]
    """
    return [asdict(one) for one in decisions]


def accuracy_rows(rows: Iterable[AccuracyRow]) -> list[Row]:
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


def _sideways(results: AtSpeed, mode: int) -> Row:
    """Energy shares of the gears on bearings; nothing where there are none."""
    bodies = [results.train.stations[b.station] for b in results.train.bodies]
    if not bodies:
        return {}
    modes = results.modes
    return {
        "bearing_strain_energy": dict(
            zip(bodies, modes.bearing_share[:, mode].tolist(), strict=True)
        ),
        "sideways_kinetic_energy": dict(
            zip(bodies, modes.sideways_share[:, mode].tolist(), strict=True)
        ),
    }


def _fraction(percent: float | None) -> float | None:
    return None if percent is None else percent / 100.0


def _frequencies(results: AtSpeed) -> list[Row]:
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


def _mode_shapes(results: AtSpeed) -> list[Row]:
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
