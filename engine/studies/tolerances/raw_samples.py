"""The samples of a tolerance study one by one: what was drawn, what came of it, and one of them again."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from engine.case.data import CaseData
from engine.case.study_inputs import ScatterRow
from engine.start.start_fatigue import judged_shafts
from engine.studies.scatter import changes_of
from engine.studies.tolerances.sample import (
    Evaluated,
    TolerancePlan,
    ToleranceSettings,
    Unit,
    evaluate,
    plan_tolerances,
)
from engine.studies.variation import varied_case


@dataclass(frozen=True)
class RawSamples:
    """A row a sample, in the order in which they were drawn."""

    #: Sample, seed, method and samples drawn; factors; answers, with their units. [names]
    columns: tuple[str, ...]
    #: Numbers, words and flags; None where there is no answer. [as the columns]
    rows: tuple[tuple[Any, ...], ...]


def raw_samples(plan: TolerancePlan, answers: Evaluated) -> RawSamples:
    """What was drawn and what came of it.

    Parameters
    ----------
    plan : TolerancePlan
        The plan. [mixed]
    answers : Evaluated
        Answers of some of its samples. [SI]

    Returns
    -------
    RawSamples
        Every number as it was calculated, nothing rounded. [SI]
    """
    recipe, settings = plan.recipe, plan.settings
    names = [str(e.element) for e in plan.case.elements]
    factors = tuple(f"{factor.label} [factor]" for factor in plan.factors)
    columns = (
        "sample", "seed", "method", "samples", *factors, "calculated", "start completed",
        *(f"frequency of mode {i + 1} [Hz]" for i in range(recipe.n_modes)),
        *(f"margin of mode {mode} to {excitation} [1]" for mode, excitation in recipe.margins),
        *(f"largest torque of {name} [N m]" for name in names),
        *(f"allowable starts of {e.element} [1]" for _, e in judged_shafts(plan.case)),
    )  # fmt: skip
    rows = []
    for i in range(len(answers.known)):
        number, known = answers.first + i, bool(answers.known[i])
        drawn = (number + 1, settings.seed, settings.method, plan.n_samples)
        counted = known and bool(answers.counted[i])
        of_train = [*answers.frequency[i].tolist(), *answers.margin[i].tolist()]
        of_start = [*answers.torque[i].tolist(), *answers.starts[i].tolist()]
        found = [
            *(of_train if known else [None] * len(of_train)),
            *(of_start if counted else [None] * len(of_start)),
        ]
        rows.append((*drawn, *plan.values[number].tolist(), known, counted, *found))
    return RawSamples(columns, tuple(rows))


def sample_again(
    case: CaseData, scatter: Sequence[ScatterRow], settings: ToleranceSettings, number: int
) -> tuple[RawSamples, CaseData]:
    """One sample of a study, calculated again to the same bits.

    Parameters
    ----------
    case : CaseData
        The case of the study. [SI]
    scatter : sequence of ScatterRow
        Its table `Scatter`. [1]
    settings : ToleranceSettings
        Its settings. [mixed]
    number : int
        Of the sample, counted from 1. [count]

    Returns
    -------
    row : RawSamples
        Its row. [SI]
    varied : CaseData
        Its case, for a calculation with a plan and a step of its own. [SI]

    Raises
    ------
    CaseError
        With every problem of the table.
    ModelError
        If the train as stated cannot be calculated.
    """
    plan = plan_tolerances(case, scatter, settings)
    at = number - 1
    values = plan.values[at : at + 1]
    unit = Unit(plan.case, plan.recipe, plan.factors, at, values, settings.replan)
    row = raw_samples(plan, evaluate(unit))
    return row, varied_case(case, changes_of(plan.factors, values[0]))
