"""The sample of a tolerance study: what is drawn, how each train of it is calculated, the work in pieces.

`plan_tolerances` → `units_of` → `evaluate` (one unit; picklable, in any process). The samples are
drawn once, in the plan, so the answers do not depend on how the work is divided.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from engine.arrays import Floats, Mask
from engine.case.checks.problem import Cells
from engine.case.data import CaseData
from engine.case.study_inputs import ScatterRow, study_digest
from engine.errors import CaseError, ModelError, Problem
from engine.numerics.sample_statistics import FEWEST_SAMPLES
from engine.results.results import Results
from engine.run import planned_start, run
from engine.start.pieces import analysis_for_start
from engine.start.start_fatigue import judged_shafts
from engine.studies.nearby_start import (
    LINEAR,
    NO_START,
    PLANNED,
    NearbyStartPlan,
    NearStart,
    NearTrain,
    calculated,
    near_start,
    near_starts,
    near_trains,
    read_start,
    recipe_of,
)
from engine.studies.scatter import (
    METHODS,
    Factor,
    changes_of,
    factors_of,
    sampled,
    scatter_problems,
)
from engine.studies.variation import varied_case

#: Most samples.
MOST_SAMPLES = 1_000_000
#: One in so many linear starts is calculated at half the step, too: the error that the nominal run states
#: for its step is that of its own train, and a train far from it may err more.
CHECKED_EVERY = 50
#: Torques below this share of the train's largest do not count for what the step changes.
_NEGLIGIBLE = 1e-3
#: Arrays of `Evaluated`, one row per sample: yes or no, and numbers.
MASKS = ("known", "counted", "reversed", "sensitive", "checked")
NUMBERS = ("frequency", "margin", "torque", "starts", "by_step")
#: Samples that are calculated together: enough to fill the lanes of the loop and to share the cost of a call; more
#: only keep more objects alive (docs/floors.md). [count]
TOGETHER = 16
#: Values of their mode shapes at most: 8 MB, and some ten times that with what follows from them. [count]
MOST_MODE_VALUES = 1_000_000
#: Samples of one unit of work, of starts without events; one with events takes a second and more.
UNIT_SIZE = 50


@dataclass(frozen=True)
class ToleranceSettings:
    """How the sample is drawn."""

    samples: int = 1000  #: Wanted number; a Sobol sequence takes the next power of two.
    seed: int = 1  #: The same seed gives the same sample.
    method: str = METHODS[0]  #: ``lhs`` or ``sobol``.
    #: Whether a sample whose torque reverses where the plan has no gap gets a plan of its own.
    replan: bool = False


@dataclass(frozen=True, eq=False)
class TolerancePlan:
    """Everything that is decided before the first sample."""

    case: CaseData  #: The case as stated. [SI]
    nominal: Results  #: Its nominal run. [SI]
    settings: ToleranceSettings  #: How the sample is drawn. [mixed]
    factors: tuple[Factor, ...]  #: What scatters. [1]
    #: Factors of every sample, then of the runs with one factor at its P10 or P90. [1] Shape
    #: (n_samples + 2 n_factors, n_factors).
    values: Floats
    recipe: NearbyStartPlan  #: How each is calculated. [mixed]
    digest: str  #: Of the scatter and the settings. [hash]

    @property
    def n_samples(self) -> int:
        """Samples, without the runs of one factor at a time. [count]"""
        return len(self.values) - 2 * len(self.factors)

    @property
    def n_runs(self) -> int:
        """Everything that is calculated. [count]"""
        return len(self.values)


@dataclass(frozen=True, eq=False)
class Unit:
    """One piece of work: some rows of the sample."""

    case: CaseData  #: The case as stated. [SI]
    recipe: NearbyStartPlan  #: How each sample is calculated. [mixed]
    factors: tuple[Factor, ...]  #: What scatters. [1]
    first: int  #: Row of the first.
    values: Floats  #: Factors. [1] Shape (n, n_factors).
    replan: bool  #: See `ToleranceSettings`.


@dataclass(frozen=True, eq=False)
class Evaluated:
    """Answers of one unit. Rows that are not `known` hold zeros."""

    first: int  #: Row of the first sample.
    known: Mask  #: Whether the sample could be calculated. [mask] Shape (n,).
    counted: Mask  #: Whether its start came to its end. [mask] Shape (n,).
    reversed: Mask  #: Whether a torque reverses where no gap is simulated. [mask] Shape (n,).
    #: Whether a tiny change of its input would change its peaks. [mask] Shape (n,).
    sensitive: Mask
    frequency: Floats  #: Elastic frequencies. [Hz] Shape (n, n_modes).
    margin: Floats  #: Margins. [1] Shape (n, n_margins).
    torque: Floats  #: Largest torque of each element. [N m] Shape (n, n_elements).
    #: Allowable starts of each judged shaft; infinite = unlimited. [1] Shape (n, n_judged).
    starts: Floats
    checked: Mask  #: Whether its start was calculated at half the step, too. [mask] Shape (n,).
    #: What that changed, relatively: the most of any torque, and the starts of the train. [1]
    #: Shape (n, 2).
    by_step: Floats
    outcomes: tuple[tuple[str, int], ...] = ()  #: How many starts ended in each way.
    troubles: tuple[str, ...] = ()  #: Why samples could not be calculated.


def tolerance_problems(
    case: CaseData, rows: Sequence[ScatterRow], settings: ToleranceSettings
) -> list[Problem]:
    """Everything wrong with the scatter and the settings.

    Parameters
    ----------
    case : CaseData
        A checked case. [SI]
    rows : sequence of ScatterRow
        Table `Scatter`. [1]
    settings : ToleranceSettings
        How the sample is drawn. [mixed]

    Returns
    -------
    list of Problem
        Empty if it can be planned.
    """
    samples, methods = f"{FEWEST_SAMPLES} to {MOST_SAMPLES:,}", " or ".join(METHODS)
    cells, problems = Cells("Scatter"), scatter_problems(case, rows)
    if not FEWEST_SAMPLES <= settings.samples <= MOST_SAMPLES:
        words = (
            f"{settings.samples} samples are requested; allowed are {samples}: fewer than "
            f"{FEWEST_SAMPLES} give no bound for P10."
        )
        problems.append(cells.problem("Samples", settings.samples, samples, words))
    if settings.method not in METHODS:
        words = f"Method is '{settings.method}'; choose {methods}."
        problems.append(cells.problem("Method", settings.method, methods, words))
    if settings.seed < 0:
        words = f"Seed is {settings.seed}; it must be 0 or a positive whole number."
        problems.append(cells.problem("Seed", settings.seed, "0 or more", words))
    return problems


def plan_tolerances(
    case: CaseData,
    rows: Sequence[ScatterRow],
    settings: ToleranceSettings | None = None,
    *,
    nominal: Results | None = None,
) -> TolerancePlan:
    """Draw the sample and decide how it is calculated.

    Parameters
    ----------
    case : CaseData
        A checked case. [SI]
    rows : sequence of ScatterRow
        Table `Scatter`. [1]
    settings : ToleranceSettings, optional
        How the sample is drawn; default 1000 samples of a Latin hypercube. [mixed]
    nominal : Results, optional
        The nominal run of the case; calculated if not at hand. [SI]

    Returns
    -------
    TolerancePlan
        What will be calculated. [mixed]

    Raises
    ------
    CaseError
        With every problem of the table.
    ModelError
        If the train as stated cannot be calculated.
    """
    settings = settings or ToleranceSettings()
    problems = tolerance_problems(case, rows, settings)
    if problems:
        raise CaseError(tuple(problems))
    nominal = nominal or run(case)
    factors = factors_of(case, rows)
    sample = sampled(factors, settings.samples, settings.seed, settings.method)
    return TolerancePlan(
        case,
        nominal,
        settings,
        factors,
        np.concatenate([sample, _one_at_a_time(factors)]),
        recipe_of(case, nominal),
        study_digest(*rows, settings),
    )


def _one_at_a_time(factors: Sequence[Factor]) -> Floats:
    """Each factor at its P10, then at its P90, all others as stated."""
    d = len(factors)
    low, high = np.ones((d, d)), np.ones((d, d))
    for i, factor in enumerate(factors):
        low[i, i], high[i, i] = float(factor.at(0.1)), float(factor.at(0.9))
    return np.concatenate([low, high])


def units_of(plan: TolerancePlan, size: int | None = None) -> tuple[Unit, ...]:
    """The work in pieces that can be done anywhere, in any order.

    Parameters
    ----------
    plan : TolerancePlan
        The plan. [mixed]
    size : int, optional
        Samples of a piece; default some that take about a second together. [count]

    Returns
    -------
    tuple of Unit
        Pieces. [mixed]
    """
    if size is None:
        size = 1 if plan.recipe.start == PLANNED else UNIT_SIZE
    # no piece has samples and runs of one factor at a time
    kinds = ((0, plan.n_samples), (plan.n_samples, plan.n_runs))
    return tuple(
        Unit(
            plan.case,
            plan.recipe,
            plan.factors,
            first,
            plan.values[first : min(first + size, end)],
            plan.settings.replan,
        )
        for begin, end in kinds
        for first in range(begin, end, size)
    )


# --- the samples ----------------------------------------------------------------------------------


def evaluate(unit: Unit) -> Evaluated:
    """Calculate the samples of one unit.

    Parameters
    ----------
    unit : Unit
        Some rows of the sample. [1]

    Returns
    -------
    Evaluated
        Their answers. [SI]
    """
    n, recipe = len(unit.values), unit.recipe
    judged = len(judged_shafts(unit.case))
    masks: dict[str, Any] = {name: np.zeros(n, dtype=np.bool_) for name in MASKS}
    evaluated = Evaluated(
        unit.first,
        **masks,
        frequency=np.zeros((n, recipe.n_modes)),
        margin=np.zeros((n, len(recipe.margins))),
        torque=np.zeros((n, len(unit.case.elements))),
        starts=np.full((n, judged), math.inf),
        by_step=np.zeros((n, 2)),
    )
    outcomes, troubles = Counter[str](), []
    for first in range(0, n, at_once := _samples_at_once(unit)):
        values = unit.values[first : first + at_once]
        cases = [varied_case(unit.case, changes_of(unit.factors, row)) for row in values]
        trains = near_trains(cases, recipe)
        starts: Sequence[NearStart | ModelError | None] = [None] * len(cases)
        if recipe.start != NO_START:
            starts = near_starts(recipe, [(c, t, 1.0) for c, t in zip(cases, trains, strict=True)])
        for i, sample in enumerate(zip(cases, trains, starts, strict=True), first):
            try:
                outcomes.update(_write_sample(unit, i, evaluated, *sample))
            except ModelError as error:
                troubles.append(str(error))
    return replace(evaluated, outcomes=tuple(outcomes.items()), troubles=tuple(troubles))


def _samples_at_once(unit: Unit) -> int:
    """How many samples are calculated together: fewer where the modes of each take much memory."""
    size = len(unit.case.stations) + sum(count for _, count in unit.recipe.segments)
    return min(TOGETHER, max(1, MOST_MODE_VALUES // (size * size)))


def _write_sample(
    unit: Unit,
    i: int,
    evaluated: Evaluated,
    case: CaseData,
    train: NearTrain | ModelError,
    start: NearStart | ModelError | None,
) -> list[str]:
    """Answers of one sample, written into its row; how its start ended, if it has one."""
    recipe, near = unit.recipe, calculated(train)
    evaluated.frequency[i], evaluated.margin[i] = near.frequency, near.margin
    words: list[str] = []
    if start is not None:
        start = calculated(start)
        if recipe.start == LINEAR and (unit.first + i) % CHECKED_EVERY == 0:
            evaluated.by_step[i] = _change(near_start(case, recipe, near, 0.5), start)
            evaluated.checked[i] = start.counted
        if start.reversed and unit.replan:
            own = planned_start(case, analysis_for_start(case), estimated=False)
            start = read_start(case, recipe, own.model, own.start.outcome, own.start)
        evaluated.counted[i] = start.counted
        evaluated.reversed[i] = bool(start.reversed)
        evaluated.sensitive[i] = start.sensitive
        evaluated.torque[i] = start.largest
        evaluated.starts[i] = start.starts
        words = [start.outcome.outcome]
    evaluated.known[i] = True
    return words


def _change(fine: NearStart, coarse: NearStart) -> tuple[float, float]:
    """Relative change of the worst torque and of the starts of the train from one step to half of it."""
    size = fine.largest
    counts = size > _NEGLIGIBLE * np.max(size, initial=0.0)
    off = np.abs(size - coarse.largest)[counts] / size[counts]
    torque = float(np.max(off, initial=0.0))
    a, b = (float(np.min(start.starts, initial=math.inf)) for start in (fine, coarse))
    if math.isinf(a) and math.isinf(b):
        return torque, 0.0
    return torque, abs(a - b) / min(a, b)
