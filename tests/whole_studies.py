"""Studies in one process: plan, each unit of work, and what they come to, as the add-in does it."""

from __future__ import annotations

from collections.abc import Sequence

from engine.case.checks.find_problems import find_problems
from engine.case.data import CaseData, StartConditionRow
from engine.case.study_inputs import ScatterRow, StudyInputs
from engine.errors import Problem
from engine.studies.sensitivities.differences import differences
from engine.studies.sensitivities.plan import derivative_units, plan_derivatives
from engine.studies.sensitivities.sensitivities import Derivatives, gather_derivatives
from engine.studies.sensitivities.tangent import tangent_of
from engine.studies.starts.condition_result import calculate_condition
from engine.studies.starts.matrix import StartMatrix, gather_matrix
from engine.studies.starts.plan import plan_matrix
from engine.studies.tolerances.sample import (
    ToleranceSettings,
    evaluate,
    plan_tolerances,
    units_of,
)
from engine.studies.tolerances.tolerances import PercentileRow, Tolerances, summarise_sample
from engine.studies.tuning.combinations import plan_tuning
from engine.studies.tuning.evaluate import calculate_combinations
from engine.studies.tuning.tuning import TuningResult, rank_combinations


def tune(case: CaseData, studies: StudyInputs, first: int | None = None) -> TuningResult:
    """A tuning study of all combinations, or of the first ones. [SI]"""
    plan = plan_tuning(case, studies)
    tried = calculate_combinations(case, plan.combinations[:first])
    return rank_combinations(case, plan, tried)


def with_conditions(case: CaseData, rows: Sequence[StartConditionRow]) -> CaseData:
    """A case with rows in `StartConditions`. [SI]"""
    return CaseData(**vars(case) | {"start_conditions": tuple(rows)})


def condition_problems(case: CaseData, rows: Sequence[StartConditionRow]) -> tuple[Problem, ...]:
    """What is wrong with rows of `StartConditions`. [problems]"""
    found = find_problems(with_conditions(case, rows))
    return tuple(p for p in found if p.table == "StartConditions")


def start_matrix(
    case: CaseData, rows: Sequence[StartConditionRow], first: int | None = None
) -> StartMatrix:
    """A start matrix of all starts, or of the first ones. [SI]"""
    case = with_conditions(case, rows)
    plan = plan_matrix(case)
    done = [calculate_condition(case, one) for one in plan.units[:first]]
    return gather_matrix(case, plan, done)


def derivatives(case: CaseData) -> Derivatives:
    """Sensitivities to every quantity. [1]"""
    plan = plan_derivatives(case)
    parts = [differences(unit) for unit in derivative_units(plan)]
    return gather_derivatives(plan, parts, tangent_of(plan))


def tolerances(
    case: CaseData,
    rows: Sequence[ScatterRow],
    settings: ToleranceSettings | None = None,
    first: int | None = None,
) -> Tolerances:
    """A tolerance study of all units of work, or of the first ones. [SI]"""
    plan = plan_tolerances(case, rows, settings)
    return summarise_sample(plan, [evaluate(unit) for unit in units_of(plan)[:first]])


def percentile(study: Tolerances, quantity: str, of: str) -> PercentileRow | None:
    """The row of one answer; None where there is none. [as the quantity]"""
    return next((r for r in study.percentiles if (r.quantity, r.of) == (quantity, of)), None)
