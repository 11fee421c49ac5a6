"""What is to be tried: every combination of the options, and the unchanged case.

Each row of `Tuning` is a variable with one option a value, and each element of `Catalogue` a variable
with one option a coupling on offer. A combination takes one option of each.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import product

from engine.case.data import CaseData
from engine.case.study_inputs import DisplayUnit, StudyInputs, study_digest
from engine.errors import CaseError
from engine.studies.tuning.checks import tuning_problems
from engine.studies.tuning.options import (
    Combination,
    Variable,
    in_units,
    variables_of,
    with_options,
)


@dataclass(frozen=True)
class TuningPlan:
    """Everything that will be calculated."""

    #: Rows of `Tuning`, then elements of `Catalogue`, each in the order of its table. [SI]
    variables: tuple[Variable, ...]
    #: The unchanged case first, the others in the order of the options. [SI]
    combinations: tuple[Combination, ...]
    study_digest: str  #: Of the rows. [hex]


def plan_tuning(case: CaseData, studies: StudyInputs) -> TuningPlan:
    """Every combination of what may be chosen.

    Parameters
    ----------
    case : CaseData
        A checked case. [SI]
    studies : StudyInputs
        Rows of `Tuning` and `Catalogue`. [SI]

    Returns
    -------
    TuningPlan
        With the unchanged case. [SI]

    Raises
    ------
    CaseError
        With every problem of the rows, see `tuning_problems`.
    """
    problems = tuning_problems(case, studies)
    if problems:
        raise CaseError(problems)
    variables = variables_of(case, studies)
    stands = CaseData(**vars(case))
    same = [[with_options(stands, (o,)) == stands for o in v.options] for v in variables]
    combinations = []
    for picked in product(*(range(len(v.options)) for v in variables)):
        options = tuple(v.options[i] for v, i in zip(variables, picked, strict=True))
        as_is = all(known[i] for known, i in zip(same, picked, strict=True))
        combinations.append(Combination(picked, options, as_is))
    if not any(c.as_is for c in combinations):
        combinations.append(Combination((), (), True))
    combinations.sort(key=lambda c: not c.as_is)  # what the others are compared with comes first
    digest = study_digest(*studies.tuning, *studies.catalogue)
    return TuningPlan(variables, tuple(combinations), digest)


def in_typed_units(plan: TuningPlan, units: Mapping[tuple[str, str], DisplayUnit]) -> TuningPlan:
    """The same plan, its options named in the units that the engineer typed.

    Parameters
    ----------
    plan : TuningPlan
        Named in SI. [SI]
    units : mapping of (str, str) to DisplayUnit
        As in `StudyInputs`. [units]

    Returns
    -------
    TuningPlan
        The same options in the same order. [SI]
    """
    variables = tuple(in_units(v, units) for v in plan.variables)
    combinations = []
    for c in plan.combinations:
        pairs = zip(variables, c.picked, strict=bool(c.picked))
        combinations.append(replace(c, options=tuple(v.options[i] for v, i in pairs)))
    return replace(plan, variables=variables, combinations=tuple(combinations))
