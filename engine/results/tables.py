"""Results as the result tables of the contract: rows of plain values under their JSON keys.

SI throughout, percentages as fractions (also `percent_speed`); CPM alone is in the unit of its name.
None stands for blank. Workbook and JSON are both written from these rows. A table whose columns are the
fields of a record is that record; any other has a function of its name in small letters.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import fields
from typing import Any

import numpy as np

from engine.backlash.motor_scan import WorstInstant
from engine.case.choices import StressBasis
from engine.case.data import CaseData
from engine.case.result_words import Judgement
from engine.fatigue.shaft_strength import shaft_strength
from engine.fatigue.stress import shear_stress, stress_of_unit_torque
from engine.model.links import link_of
from engine.model.sections import sections_of
from engine.motor.from_case import motor_curves, motor_time_constants
from engine.numerics.same_bits import product
from engine.operation.margins import percent_speed
from engine.operation.steady_state import SteadyState
from engine.results.case_matrix import case_matrix
from engine.results.maker_sheet import maker_sheet
from engine.results.results import AccuracyRow, AtSpeed, Results
from engine.results.verdicts import event_verdict, standard_rows, yield_torque
from engine.start.start_fatigue import is_counted

Row = dict[str, Any]

#: Fields of a `Reversal` that its table does not show.
REVERSAL_DETAILS = ("kind", "minimum_time", "largest_torque", "hysteresis")


def result_tables(results: Results) -> Mapping[str, list[Row]]:
    """The result tables of the contract: name → rows with JSON keys."""
    return {
        "Verdicts": _rows(results.verdicts),
        "CaseMatrix": _rows(case_matrix(results.case, results.case_verdicts)),
        "CaseVerdicts": [{"condition": r.condition, **vars(r)} for r in results.case_verdicts],
        "StandardRequirements": _rows(standard_rows(results.case, results.verdicts[1:])),
        **speed_tables(results),
        "SectionResults": section_results(results.case),
        "MotorCurves": motor_curves(results.case),
        "MotorTimeConstants": motor_time_constants(results.case),
        "ElectricalDamping": _electrical_damping(results),
        "StartupPeaks": _startup_peaks(results),
        "StartupCrossings": _startup_crossings(results),
        "TorqueReversals": _torque_reversals(results),
        "MakerSheet": _rows(maker_sheet(results)),
        "AllowableStarts": _allowable_starts(results),
        "FatigueLimits": _fatigue_limits(results),
        "EventPeaks": _event_peaks(results),
        "AirGapTorque": _air_gap_torques(results),
        "Effects": _rows(results.plans[-1].decisions),
        "AccuracyCost": accuracy_cost(results.accuracy),
    }


def speed_tables(results: AtSpeed) -> dict[str, list[Row]]:
    """The result tables that need no start: name → rows with JSON keys."""
    return {
        "NaturalFrequencies": _natural_frequencies(results),
        "ModeShapes": _mode_shapes(results),
        "SeparationMargins": _separation_margins(results),
        "SteadyState": _steady_state(results.steady),
    }


def _steady_state(steady: SteadyState) -> list[Row]:
    """One an element and excitation, with the least of its safety factors."""
    is_range = steady.stress_basis != StressBasis.ZERO_TO_PEAK
    rows = _rows(steady.rows)
    for row, r in zip(rows, steady.rows, strict=True):
        stress = r.peak_to_peak_stress if is_range else r.zero_to_peak_stress
        row["safety_factor"] = _safety((r.allowable, stress), (r.torque_limit, r.torque))
    return rows


def _safety(*pairs: tuple[float | None, float | None]) -> float | None:
    """Least of some limits over their values; None where no positive value stands beside a limit."""
    factors = [limit / value for limit, value in pairs if limit and value and value > 0.0]
    return min(factors, default=None)


def _rows(records: Iterable[Any]) -> list[Row]:
    """Records whose fields are the columns of their table."""
    # As `asdict` gives them, without the copies of their values, which are no records themselves.
    return [{f.name: getattr(record, f.name) for f in fields(record)} for record in records]


def accuracy_cost(rows: Iterable[AccuracyRow]) -> list[Row]:
    """Rows of `AccuracyCost`, of a study or as calculated: errors [1] and wall time [s]."""
    return _rows(rows)


def _torque_reversals(results: Results) -> list[Row]:
    """One a gear mesh or geared coupling, its sentence as ``note``."""
    rows = _rows(results.reversals)
    for row in rows:
        row["note"] = row.pop("sentence")
        for key in REVERSAL_DETAILS:
            del row[key]
        row["safety_factor"] = _safety((row["limit"], -row["minimum_torque"]))
    return rows


def section_results(case: CaseData) -> list[Row]:
    """Rows of `SectionResults`: sections of each element, and the element as a whole.

    Parameters
    ----------
    case : CaseData
        A case whose sections have passed their checks. [SI]

    Returns
    -------
    list of dict
        Rows by JSON key. [SI]
    """
    rows: list[Row] = []
    elements = {e.element: e for e in case.elements}
    for name, sections in sections_of(case).items():
        keys = ("element", "section", "effective_length", "stiffness", "inertia")
        rows += [{key: getattr(section, key) for key in keys} for section in sections]
        link = link_of(elements[name], None, sections)
        rows.append(
            {
                "element": name,
                "section": "whole",
                "stiffness": link.stiffness,
                "inertia": link.inertia,
            }
        )
    return rows


def _electrical_damping(results: Results) -> list[Row]:
    """What each motor makes of each mode that the start crosses."""
    return [
        {
            "station": row.station,
            "mode": row.mode,
            "percent_speed": row.speed,
            "slope_of_the_curve": row.slope,
            "share_of_the_slope": row.slope_share,
            "re_k": row.real,
            "im_k": row.imaginary,
            "share_of_damping_ratio": row.share,
            "shift_of_frequency": row.shift,
            "damping_ratio": row.damping_ratio,
            "with_motors": row.with_motors,
        }
        for row in results.electrical_damping
    ]


def _startup_crossings(results: Results) -> list[Row]:
    """One a mode that the falling 2 × slip frequency crosses."""
    rows = _rows(results.crossings)
    for row in rows:
        row["percent_speed"] = _fraction(row["percent_speed"])
    return rows


def _fraction(percent: float | None) -> float | None:
    return None if percent is None else percent / 100.0


def _natural_frequencies(results: AtSpeed) -> list[Row]:
    """One a mode, rigid ones first."""
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
                "accurate": f <= results.accurate_up_to if elastic else None,
            }
        )
    return rows


def _mode_shapes(results: AtSpeed) -> list[Row]:
    """One a station: its twist in its physical sense, the largest of a mode = 1."""
    train, modes = results.train, results.modes
    n = train.n_stations
    angle = product(train.node_matrix(), modes.shape)[:n] * train.sense[:n, None]
    angle = angle[:, modes.n_rigid :]
    rows = []
    largest = angle[np.argmax(np.abs(angle), axis=0), np.arange(angle.shape[1])]
    shape = angle / np.where(largest != 0.0, largest, 1.0)
    for i, name in enumerate(train.stations):
        rows.append({"station": name} | {f"mode_{k + 1}": float(v) for k, v in enumerate(shape[i])})
    return rows


def _separation_margins(results: AtSpeed) -> list[Row]:
    """One a margin, with what the forced response made of it."""
    rows = _rows(results.margins.rows)
    for row in rows:
        row["frequency"] = row.pop("mode_frequency")
    return rows


def _startup_peaks(results: Results) -> list[Row]:
    """One an element; none without a start."""
    start, synchronous = results.start, results.case.ratings.synchronous_speed
    if start is None:
        return []
    sections = {e.element: (e.stress_diameter, e.stress_bore or 0.0) for e in results.case.elements}
    limits = {e.element: e.peak_torque_limit for e in results.case.elements}
    yields = yield_torque(results.case)
    rows = []
    for p in start.peaks:
        diameter, bore = sections[p.element]
        stress = float(shear_stress(p.peak_to_peak, diameter, bore)) if diameter else None
        per_torque, strength = yields.get(p.element, (1.0, None))
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
                "left_out": start.left_out,
                "peak_low": p.low,
                "peak_high": p.high,
                "minimum_low": None if p.minimum_range is None else p.minimum_range[0],
                "minimum_high": None if p.minimum_range is None else p.minimum_range[1],
                "worst_phase": p.phase,
                "safety_factor": _safety(
                    (limits[p.element], p.size), (strength, per_torque * p.size)
                ),
            }
        )
    return rows


def _event_peaks(results: Results) -> list[Row]:
    """One an event and element; blank where the event was not calculated."""
    case = results.case
    rated, ratios = case.ratings.rated_torque, case.element_speed_ratios
    limits, yields = (
        {str(e.element): e.peak_torque_limit for e in case.elements},
        yield_torque(case),
    )
    unit_stress = {
        str(e.element): stress_of_unit_torque(e) for e in case.elements if e.stress_diameter
    }
    rows: list[Row] = []
    for event in results.events:
        if event.response is None:
            verdict = Judgement.NOT_JUDGED
            rows += [{"event": event.name, "element": e, "verdict": verdict} for e in limits]
            continue
        times = case.events_per_life.get(event.name)
        instants = event.worst.of_element if event.worst else {}
        damaging = event.worst.of_damage if event.worst else {}
        damage, errors = {s.element: s.damage for s in event.shafts}, dict(event.damage_errors)
        for p in event.response.peaks:
            per_torque, strength = yields.get(p.element, (1.0, math.inf))
            limit = min(limits[p.element] or math.inf, strength / per_torque)
            rows.append(
                {
                    "event": event.name,
                    "element": p.element,
                    "maximum": p.maximum,
                    "minimum": p.minimum,
                    "time": p.time,
                    "times_rated": p.size * ratios[p.element] / rated if rated else None,
                    "peak_stress": unit_stress[p.element] * p.size
                    if p.element in unit_stress
                    else None,
                    "damage": damage.get(p.element),
                    "damage_per_life": times * damage[p.element]
                    if times and p.element in damage
                    else None,
                    "damage_error": errors.get(p.element),
                    "limit": limit if math.isfinite(limit) else None,
                    "verdict": event_verdict(limit, p),
                    "safety_factor": _safety((limit, p.size)) if math.isfinite(limit) else None,
                    "error": p.relative_error,
                    "left_out": event.response.left_out,
                    **_worst_instant(case, event.name, instants.get(p.element)),
                    **_worst_instant(case, event.name, damaging.get(p.element), "_of_damage"),
                }
            )
    return rows


def _worst_instant(
    case: CaseData, event: str, instant: WorstInstant | None, of_what: str = ""
) -> Row:
    """Phase, angle and clearing time that were looked for, as they were found."""
    if instant is None:
        return {}
    (row,) = (r for r in case.motor_events if r.event == event)
    names = {"phase": "worst_phase", "angle": "worst_angle", "clears_after": "worst_clearing_time"}
    found = {names[name] + of_what: getattr(instant.row, name) for name in row.scanned}
    if instant.instant.pulsation is not None:
        found["worst_pulsation_phase" + of_what] = instant.instant.pulsation
    return found


#: Name of the start among the events of motors.
START = "start"


def _air_gap_torques(results: Results) -> list[Row]:
    """Of each motor of a start in time, then one an event; blank where the motor does not carry its running torque."""
    in_time = () if results.start is None else results.start.machines
    rows: list[Row] = [
        {
            "event": START
            if len(in_time) == 1
            else f"{START}, {results.train.stations[m.station]}",
            "largest": m.largest,
            "time": m.time,
            "closed_form": None,
            "ratio": None,
            "error": m.error,
        }
        for m in in_time
    ]
    names = {row.event for row in results.case.motor_events}
    for event in results.events:
        if event.name not in names:
            continue
        rows.append({"event": event.name})
        if torque := event.air_gap:
            rows[-1] |= {
                "largest": torque.largest,
                "time": torque.time,
                "closed_form": torque.closed_form,
                "ratio": abs(torque.largest) / torque.closed_form if torque.closed_form else None,
                "error": torque.error,
                **_worst_instant(
                    results.case, event.name, event.worst.of_motor if event.worst else None
                ),
                "slip": torque.slip,
            }
    return rows


def _allowable_starts(results: Results) -> list[Row]:
    """One a judged shaft."""
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
            "paper_count": s.paper_starts,
            "error": errors.get(s.element),
            "governing": s.element == starts.governing,
            "left_out": s.left_out,
            "starts_low": s.starts_low,
            "starts_high": s.starts_high,
            "worst_phase": s.phase,
        }
        for s in starts.shafts
    ]


def _fatigue_limits(results: Results) -> list[Row]:
    """One a judged shaft; of a start that was not completed without its amplitude, which is not that of a start."""
    starts, case = results.starts, results.case
    if starts is None:
        return []
    elements = {e.element: e for e in case.elements}
    rows = []
    for shaft in starts.shafts:
        strength = shaft_strength(case, elements[shaft.element])
        amplitude = shaft.largest_amplitude if is_counted(results.start) else None
        rows.append(
            {
                "element": shaft.element,
                "stress_amplitude": amplitude,
                "endurance_limit": shaft.endurance,
                "safety_factor": _safety((shaft.endurance, amplitude)),
                "kt": strength.notch.concentration.value,
                "notch_sensitivity": strength.notch.sensitivity.value,
                "kf": strength.notch.fatigue,
                "surface": strength.surface.value,
                "size": strength.size.value,
                "reliability": strength.reliability.value,
                "endurance_of_data": strength.data_endurance,
                "sources": strength.sources or None,
            }
        )
    return rows
