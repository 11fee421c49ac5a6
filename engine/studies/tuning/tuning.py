"""Where to put the modes: every combination of couplings calculated, ranked, and the reasons told.

The paper ("Philosophy of resonant response location") answers where a mode should lie by the train's
own torque curves, acceleration and damping. Here each combination of what may be chosen is started in
full, so the answer is read off the starts themselves.

`plan_tuning` says what will be calculated, `calculate_combinations` makes some of it, `rank_combinations` makes
one result of the units, whoever calculated them.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, replace
from types import MappingProxyType
from typing import Any

from engine.case.data import CaseData
from engine.case.study_inputs import DisplayUnit
from engine.model.build_train import build_train
from engine.model.excitation import excitations_of
from engine.operation.margins import (
    Band,
    Window,
    forbidden_bands,
    free_windows,
    rows_of_bands,
)
from engine.operation.standards import required_margin
from engine.studies.tuning.combinations import TuningPlan
from engine.studies.tuning.evaluate import EvaluatedCombination, KeyAnswers
from engine.studies.tuning.maps import TuningMap, tuning_map
from engine.studies.tuning.options import Variable, with_options
from engine.studies.tuning.ranking import chosen, merit, ranked, reason

Row = dict[str, Any]

#: Verdict and outcome of what a study that was stopped did not come to.
NOT_CALCULATED = "not calculated"


@dataclass(frozen=True)
class Ranked:
    """One combination in its place."""

    rank: int  #: 1 = the best.
    combination: str  #: What it is made of.
    tried: EvaluatedCombination  #: What became of it. [SI]
    better: bool  #: Whether it is better than the unchanged case.
    reason: str  #: Why it stands there.


@dataclass(frozen=True)
class TuningResult:
    """Everything a tuning study found."""

    study_digest: str  #: Digest of the rows of `Tuning` and `Catalogue`. [hex]
    variables: tuple[Variable, ...]  #: What was chosen from. [SI]
    rows: tuple[Ranked, ...]  #: Every combination that was calculated, the best first. [SI]
    as_is: Ranked | None  #: the unchanged case; None where the study was stopped before it. [SI]
    required_margin: float  #: Required separation margin. [1]
    bands: tuple[Band, ...]  #: Forbidden bands of every excitation. [Hz]
    windows: tuple[Window, ...]  #: What they leave free. [Hz]
    map: TuningMap  #: Over the first two variables, or the only one. [SI]
    planned: int  #: Combinations there are, the unchanged case included.
    sentence: str  #: What was found, in short.


def rank_combinations(
    case: CaseData,
    plan: TuningPlan,
    tried: Iterable[EvaluatedCombination],
    units: Mapping[tuple[str, str], DisplayUnit] = MappingProxyType({}),
) -> TuningResult:
    """One result of all that was calculated.

    Parameters
    ----------
    case : CaseData
        The unchanged case. [SI]
    plan : TuningPlan
        What was to be tried. [SI]
    tried : iterable of EvaluatedCombination
        What was, in any order. [SI]
    units : mapping of (str, str) to DisplayUnit, optional
        Of stress and torque in its words, as in `StudyInputs`; default MPa and N m. [units]

    Returns
    -------
    TuningResult
        The same whatever the order, with options as the plan names them. [SI]
    """
    named = {c.picked: c for c in plan.combinations}
    tried = [replace(t, combination=named[t.combination.picked]) for t in tried]
    order = ranked(tried, plan.variables)
    stands = next((t for t in order if t.combination.as_is), None)
    rated = case.ratings.rated_torque
    rows = tuple(
        Ranked(
            rank,
            chosen(t, plan.variables),
            t,
            stands is not None and merit(t) < merit(stands),
            reason(t, stands, rated, units),
        )
        for rank, t in enumerate(order, start=1)
    )
    bands = forbidden_bands(case, excitations_of(case, build_train(case)))
    as_is = next((r for r in rows if r.tried.combination.as_is), None)
    return TuningResult(
        plan.study_digest,
        plan.variables,
        rows,
        as_is,
        required_margin(case),
        bands,
        free_windows(bands),
        tuning_map(plan, order),
        len(plan.combinations),
        _sentence(rows, as_is, len(plan.combinations)),
    )


def best_cases(
    case: CaseData, result: TuningResult, top: int
) -> tuple[tuple[Ranked, CaseData], ...]:
    """The best combinations as cases that can be saved and calculated.

    Parameters
    ----------
    case : CaseData
        The unchanged case. [SI]
    result : TuningResult
        The study. [SI]
    top : int
        How many, those that cannot be calculated and the case itself left out. [count]

    Returns
    -------
    tuple of (Ranked, CaseData)
        The best first. [SI]
    """
    ready = [
        row
        for row in result.rows
        if row.tried.answers is not None and not row.tried.combination.as_is
    ]
    return tuple((row, with_options(case, row.tried.combination.options)) for row in ready[:top])


def _sentence(rows: tuple[Ranked, ...], as_is: Ranked | None, planned: int) -> str:
    """How many were tried, how many are better, and the best."""
    if not rows:
        return f"Stopped before the first of {planned:,} combinations."
    sentence = f"{planned:,} combinations were tried"
    if len(rows) < planned:
        sentence = f"Stopped: {len(rows):,} of {planned:,} combinations were tried"
    impossible = sum(r.tried.answers is None for r in rows)
    if impossible:
        sentence += f", {impossible:,} of them cannot be calculated"
    better = sum(r.better for r in rows)
    n_kept = sum(r.tried.answers is not None and not r.tried.answers.broken for r in rows)
    sentence += f"; {n_kept:,} {'meets' if n_kept == 1 else 'meet'} all judged limits"
    if as_is is None:
        return f"{sentence}. The study was stopped before the unchanged case."
    sentence += f", {better:,} {'is' if better == 1 else 'are'} better than the unchanged case (rank {as_is.rank:,})."
    if better and len(rows) < planned:  # short: what was not calculated may be better
        return f"{sentence} The best of them is {rows[0].combination}."
    if better:
        further = (
            "" if n_kept else " Type other values or elements in table Tuning to look further."
        )
        return f"{sentence} The best is {rows[0].combination}. {rows[0].reason}{further}"
    return f"{sentence} No combination is better than the unchanged case."


# --- tables ---------------------------------------------------------------------------------------


def ranked_rows(result: TuningResult) -> list[Row]:
    """Rows of `TuningResults`: every combination, the best first.

    Parameters
    ----------
    result : TuningResult
        The study. [SI]

    Returns
    -------
    list of dict
        Frequencies [Hz], margin and percent speed [1], torques [N m], stresses [Pa], sweep rate
        [Hz/s]; the crossing is the one that stresses the train most. ``unlimited`` is absent where
        starts were not judged.
    """
    stands = None if result.as_is is None else result.as_is.tried.answers
    usual = frozenset(() if stands is None else stands.warnings)
    return [_ranked_row(row, usual) for row in result.rows]


def uncalculated_rows(plan: TuningPlan, result: TuningResult) -> list[Row]:
    """Rows of `TuningResults` for what a study that was stopped did not come to.

    Parameters
    ----------
    plan : TuningPlan
        What was to be tried. [SI]
    result : TuningResult
        What was. [SI]

    Returns
    -------
    list of dict
        Without rank, in the order of the plan. [words]
    """
    done = {row.tried.combination.picked for row in result.rows}

    return [
        {
            "combination": chosen(EvaluatedCombination(c, None), plan.variables),
            "as_is": c.as_is,
            "better": False,
            "verdict": NOT_CALCULATED,
            "outcome": NOT_CALCULATED,
            "reason": "Not calculated: the study was stopped.",
        }
        for c in plan.combinations
        if c.picked not in done
    ]


def _ranked_row(row: Ranked, usual: frozenset[str]) -> Row:
    """One row; warnings that hold of the unchanged case as well are left out."""
    a = row.tried.answers
    values: Row = {
        "rank": row.rank,
        "combination": row.combination,
        "as_is": row.tried.combination.as_is,
        "better": row.better,
        "reason": row.reason,
    }
    if a is None:
        return values | {"verdict": "impossible", "outcome": "impossible"}
    c = a.governing
    values |= {
        "verdict": a.verdict,
        "limits_broken": len(a.broken),
        "broken": ", ".join(dict.fromkeys(a.broken)),
        "allowable_starts": a.starts,
        "error": a.starts_error,
        "governing_shaft": a.starts_where or None,
        "worst_margin": a.worst_margin,
        "margin_where": a.margin_where,
        "mode_1": _at(a.modes, 0),
        "mode_2": _at(a.modes, 1),
        "mode_3": _at(a.modes, 2),
        "peak_to_peak_stress": a.peak_stress,
        "stress_with_scf": a.peak_stress_scf,
        "stress_where": a.peak_stress_where or None,
        "peak_torque_over_rated": a.peak_over_rated,
        "torque_where": a.peak_torque_where or None,
        "mesh_minimum_torque": a.mesh_minimum_torque,
        "impacts": a.impacts,
        "outcome": a.outcome,
        "note": " ".join(w for w in a.warnings if w not in usual) or None,
    }
    if c is not None:
        values |= {
            "mode_crossed": c.mode,
            "percent_speed": None if c.percent_speed is None else c.percent_speed / 100.0,
            "sweep_rate": c.sweep_rate,
            "average_torque": c.average_torque,
            "pulsating_torque": c.pulsating_torque,
        }
    return values | _judged(a)


def _judged(a: KeyAnswers) -> Row:
    """Whether starts are limited; not said where they were not judged."""
    return {"unlimited": a.unlimited} if a.unlimited or a.starts is not None else {}


def _at(values: tuple[float, ...], index: int) -> float | None:
    return values[index] if index < len(values) else None


def crossing_rows(result: TuningResult, top: int | None = None) -> list[Row]:
    """Rows of `TuningCrossings`: where 2 × slip crosses the modes of each combination.

    Parameters
    ----------
    result : TuningResult
        The study. [SI]
    top : int or None, optional
        How many of the best, the unchanged case besides; None = all. [count]

    Returns
    -------
    list of dict
        Fields of `engine.start.crossings.Crossing`, percent speed as a fraction, with rank and
        combination. [SI]
    """
    rows = []
    for row in result.rows:
        if row.tried.answers is None:
            continue
        if top is not None and row.rank > top and not row.tried.combination.as_is:
            continue
        for c in row.tried.answers.crossings:
            percent = None if c.percent_speed is None else c.percent_speed / 100.0
            of_row = {"rank": row.rank, "combination": row.combination}
            rows.append(of_row | asdict(c) | {"percent_speed": percent})
    return rows


def band_rows(result: TuningResult) -> list[Row]:
    """Rows of `ForbiddenBands`: the band of each excitation, and who is inside.

    Parameters
    ----------
    result : TuningResult
        The study. [SI]

    Returns
    -------
    list of dict
        Excitation, ends of the band [Hz], frequency of the excitation [Hz], modes of the case as it
        stands inside, and how many combinations have no mode inside.
    """
    calculated = [row.tried.answers for row in result.rows if row.tried.answers is not None]
    stands = None if result.as_is is None else result.as_is.tried.answers
    rows = rows_of_bands(result.bands, () if stands is None else stands.too_near)
    for row in rows:
        clear = [a for a in calculated if all(x != row["excitation"] for _, x in a.too_near)]
        row |= {"combinations_clear": len(clear), "combinations": len(calculated)}
    return rows


def map_rows(result: TuningResult) -> list[Row]:
    """Rows of `TuningMap`: the best combination of each pair of options, as a list.

    Parameters
    ----------
    result : TuningResult
        The study. [SI]

    Returns
    -------
    list of dict
        Options and values of both variables [SI], starts [1], worst margin [1], limits broken, modes
        [Hz]; blank where nothing was calculated.
    """
    m, rows = result.map, []
    rank = {id(row.tried): row.rank for row in result.rows}
    for j, line in enumerate(m.cells):
        up = None if m.up is None else m.up.options[j]
        for option, tried in zip(m.across.options, line, strict=True):
            a = None if tried is None else tried.answers
            row: Row = {
                "across": option.label,
                "across_value": option.value,
                "up": None if up is None else up.label,
                "up_value": None if up is None else up.value,
                "rank": None if tried is None else rank[id(tried)],
            }
            if a is not None:
                row |= {
                    "limits_broken": len(a.broken),
                    "allowable_starts": a.starts,
                    **_judged(a),
                    "worst_margin": a.worst_margin,
                    **{f"mode_{n}": f for n, f in enumerate(a.modes, start=1)},
                }
            rows.append(row)
    return rows
