"""Starts at every voltage, hot and cold, loaded and unloaded, whole and aborted.

Each start condition is the case with five things changed: voltage, damping ratio (`ModeDamping` in
proportion), stiffness of couplings, load torque, trip speed. Each goes through the whole `engine.run.run`, effects planned
anew, so that a row of the matrix says what the same case would say alone.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

from engine.case.data import CaseData
from engine.case.result_words import NoNumber
from engine.case.study_inputs import study_digest
from engine.start.start_fatigue import WHOLE_STARTS, judged_shafts
from engine.studies.starts.condition_result import NOT_CALCULATED, ConditionResult, ConditionShaft
from engine.studies.starts.conditions import StartCondition
from engine.studies.starts.plan import MatrixPlan


@dataclass(frozen=True)
class StartMatrix:
    """The whole matrix."""

    rows: tuple[ConditionResult, ...]  #: In the order of the plan. [rows]
    judged_shafts: tuple[str, ...]  #: Shafts whose fatigue can be judged.
    starts_factor: float  #: Allowable starts are divided by it before they are judged. [1]
    standard: bool  #: Whether the standard matrix is in it.
    complete: bool  #: False where it was stopped before the last condition.
    sentence: str  #: What it shows.
    notes: tuple[str, ...]  #: What was left out, and why.
    study_sha256: str  #: Digest of the rows. [hex]


# --- all of them ----------------------------------------------------------------------------------


def gather_matrix(
    case: CaseData,
    plan: MatrixPlan,
    rows: Sequence[ConditionResult],
) -> StartMatrix:
    """One result from the units of work.

    Parameters
    ----------
    case : CaseData
        The case. [SI]
    plan : MatrixPlan
        What was to be calculated. [SI]
    rows : sequence of ConditionResult
        What was, in any order. [SI]

    Returns
    -------
    StartMatrix
        In the order of the plan; conditions that are missing say so. [SI]
    """
    of_name: dict[str, list[ConditionResult]] = {}
    for row in rows:
        of_name.setdefault(row.condition.name, []).append(row)
    ordered = tuple(_joined(c, of_name.get(c.name, [])) for c in plan.conditions)
    shafts = tuple(str(e.element) for _, e in judged_shafts(case))
    return StartMatrix(
        rows=ordered,
        judged_shafts=shafts,
        starts_factor=case.starts_factor or 1.0,
        standard=plan.standard,
        complete=len(rows) == len(plan.units),
        sentence=_sentence(ordered, shafts),
        notes=plan.notes,
        study_sha256=study_digest(*case.start_conditions),
    )


def _joined(condition: StartCondition, rows: Sequence[ConditionResult]) -> ConditionResult:
    """One row of a condition; of a trip that was tried at several instants the worst.

    Damage is that of the most damaging instant; extremes may be those of another.
    """
    if len(rows) < len(condition.instants):
        remarks = ("Stopped before this start.",)
        return ConditionResult(condition, NOT_CALCULATED, NOT_CALCULATED, remarks=remarks)
    if len(rows) == 1:
        return rows[0]
    lost = next((r for r in rows if r.outcome == NOT_CALCULATED), None)
    if lost is not None:
        return replace(lost, condition=condition)
    ranked = sorted(rows, key=lambda r: (_harm(r), -(r.condition.trip_speed or 0.0)))
    worst, least = ranked[-1], ranked[0]
    shafts = tuple(_worst_shaft([r.shafts[k] for r in rows]) for k in range(len(worst.shafts)))
    instants = f"Worst of {len(rows)} trip instants within one period of the torsional vibration."
    if worst.allowable_starts is not None:
        best = f"{math.floor(least.allowable_starts or 0.0):,}"
        best = NoNumber.UNLIMITED if least.unlimited else best
        instants = f"{instants[:-1]}; the most favourable instant allows {best} starts."
    governing = next((s for s in shafts if s.element == worst.governing), None)
    largest = max(rows, key=lambda r: r.peak_torque or 0.0)
    lowest = min(rows, key=lambda r: math.inf if r.mesh is None else r.mesh_minimum_torque or 0.0)
    return replace(
        worst,
        condition=condition,
        peak_torque=largest.peak_torque,
        peak_over_rated=largest.peak_over_rated,
        peak_element=largest.peak_element,
        peak_to_peak_stress=None if governing is None else governing.peak_to_peak_stress,
        mesh_minimum_torque=lowest.mesh_minimum_torque,
        mesh=lowest.mesh,
        impacts=max((r.impacts for r in rows if r.impacts is not None), default=None),
        shafts=shafts,
        remarks=(instants, *worst.remarks),
    )


def _worst_shaft(instants: Sequence[ConditionShaft]) -> ConditionShaft:
    """One shaft after a trip: the most damaging instant, with the extremes of all."""
    worst = max(instants, key=lambda s: (not s.judged, s.damage, s.peak_to_peak_stress))
    return replace(
        worst,
        peak_to_peak_stress=max(s.peak_to_peak_stress for s in instants),
        extended=any(s.extended for s in instants),
        yields=any(s.yields for s in instants),
    )


def _harm(row: ConditionResult) -> tuple[bool, float, float, float]:
    """How bad a start is: not judged, then by damage, stress and torque."""
    damage = max((s.damage for s in row.shafts), default=0.0)
    open_ = bool(row.shafts) and not row.judged
    return open_, damage, row.peak_to_peak_stress or 0.0, row.peak_torque or 0.0


def _sentence(rows: Sequence[ConditionResult], shafts: Sequence[str]) -> str:
    """What the matrix shows, in words."""
    if not shafts:
        return (
            "No shaft has stress diameter, material and S-N points: torques and stresses are "
            "shown, allowable starts are not calculated."
        )
    judged = [r for r in rows if r.judged]
    unfinished = [r for r in rows if r.outcome != NOT_CALCULATED and not r.judged]
    sentences = []
    limited = [r for r in judged if r.allowable_starts is not None]
    if limited:
        worst = min(limited, key=lambda r: r.allowable_starts or math.inf)
        best = max(limited, key=lambda r: r.allowable_starts or 0.0)
        sentences.append(
            f"Fewest starts: {math.floor(worst.allowable_starts or 0.0):,} of '{worst.condition.name}' "
            f"({worst.governing})"
            + (
                "; most starts, apart from unlimited ones: "
                f"{math.floor(best.allowable_starts or 0.0):,} of '{best.condition.name}'."
                if best is not worst
                else "."
            )
        )
    free = [r.condition.name for r in judged if r.unlimited]
    if free:
        sentences.append(f"Unlimited: {'; '.join(free)}.")
    if unfinished:
        names = "; ".join(f"{r.condition.name} ({r.words})" for r in unfinished)
        sentences.append(f"Not judged: {names}.")
    return " ".join(sentences)


# --- tables ---------------------------------------------------------------------------------------


def start_rows(matrix: StartMatrix) -> list[dict[str, object]]:
    """Rows of `StartMatrix`, one per start condition.

    Parameters
    ----------
    matrix : StartMatrix
        The matrix. [SI]

    Returns
    -------
    list of dict
        Under their JSON keys; percentages as fractions. [SI]
    """
    of_start_alone = ("voltage", "load", "trip_speed")
    of_start = (
        "time", "percent_speed", "peak_over_rated", "peak_element", "governing",
        "peak_to_peak_stress", "mesh_minimum_torque", "impacts",
    )  # fmt: skip
    return [
        {"condition": r.condition.name}
        | {key: None if r.condition.event else getattr(r.condition, key) for key in of_start_alone}
        | {"damping_ratio": r.condition.damping_ratio}
        | {"outcome": r.words}
        | {key: getattr(r, key) for key in of_start}
        | {
            "damage": next((s.damage for s in r.shafts if s.element == r.governing), None),
            "allowable_starts": r.allowable_starts,
            "judged": r.judged,
            "note": r.note,
        }
        | ({"unlimited": r.unlimited} if r.judged else {})
        for r in matrix.rows
    ]


def voltage_rows(matrix: StartMatrix) -> list[dict[str, object]]:
    """Rows of `StartsByVoltage`: whole starts that differ in voltage and load alone.

    Parameters
    ----------
    matrix : StartMatrix
        The matrix. [SI]

    Returns
    -------
    list of dict
        One a voltage, rising; blank where there is no such start, or no number of them. [SI]
    """
    by_voltage: dict[float, dict[str, object]] = {}
    for r in matrix.rows:
        c = r.condition
        word = {1.0: "loaded", 0.0: "unloaded"}.get(c.load)
        alike = c.trip_speed is None and c.damping_ratio is None and c.stiffness_factor == 1.0
        if word is None or not alike or r.outcome not in WHOLE_STARTS:
            continue
        row = by_voltage.setdefault(c.voltage, {"voltage": c.voltage})
        row.setdefault(f"{word}_stress", r.peak_to_peak_stress)
        row.setdefault(f"{word}_starts", r.allowable_starts)
    return [by_voltage[voltage] for voltage in sorted(by_voltage)]
