"""Every study, found in this folder: the `Study` of each `StudySpec`, and what is wrong with their rows."""

from __future__ import annotations

import importlib
import pkgutil
from collections import Counter
from dataclasses import replace
from functools import cache

import addin.studies
from addin.contract.field import IncompleteRecord
from addin.contract.problems import CellProblem
from addin.contract.studies.registry import STUDIES
from addin.contract.study_spec import StudySpec
from addin.reading.one_file import Unreadable
from addin.reading.typed_case import CaseInput
from addin.studies.study import Study
from engine.case.case import Case
from engine.errors import Problem


@cache
def found_studies() -> tuple[Study, ...]:
    """Every `Study` of this folder, in the order of its sheets; their modules are imported only now."""
    names = (module.name for module in pkgutil.iter_modules(addin.studies.__path__))
    modules = [importlib.import_module(f"addin.studies.{name}") for name in names]
    studies = {
        study.key: study
        for module in modules
        for study in vars(module).values()
        if isinstance(study, Study)
    }
    return tuple(sorted(studies.values(), key=lambda study: study.spec.order))


def study_of(spec: StudySpec) -> Study:
    """The study of a record.

    Raises
    ------
    IncompleteRecord
        If it has none.
    """
    for study in found_studies():
        if study.spec is spec:
            return study
    raise IncompleteRecord(
        f"study {spec.key} has no calculation: add a Study in addin/studies/{spec.key}.py"
    )


def study_of_command(command: str) -> Study:
    """The study of a command.

    Raises
    ------
    IncompleteRecord
        If there is none.
    """
    for study in found_studies():
        if study.command == command:
            return study
    raise IncompleteRecord(
        f"command {command} has no calculation: add its Study in a file of addin/studies, or run make generated"
    )


def every_study() -> tuple[Study, ...]:
    """Every study with sheets and a schema of its own, in their order."""
    return tuple(study_of(spec) for spec in STUDIES)


def of_studies(read: CaseInput | Unreadable) -> tuple[CellProblem, ...]:
    """What is wrong on the study sheets of an input whose case is right.

    Returns
    -------
    tuple of CellProblem
        Of studies whose tables have rows, those that no other study reads if there are such: scatter alone
        asks for no calibration. Empty where the case itself is wrong, conditions apart.
    """
    if isinstance(read, Unreadable) or read.studies is None:
        return ()
    # no study table names a condition
    if any(problem.table != "StartConditions" for problem in read.problems):
        return ()
    inputs = read.studies.inputs
    readers = Counter(name for spec in STUDIES for name in spec.input_names)
    stated = []
    for spec in STUDIES:
        own = [name for name in spec.input_names if readers[name] == 1] or spec.input_names
        if any(inputs.rows(name) for name in own):
            stated.append(spec)
    case = Case(**vars(replace(read.data, start_conditions=())))
    problems: list[Problem] = []
    for spec in stated:
        problems += study_of(spec).check(case, inputs)
    tables = [name for spec in STUDIES for name in spec.input_names]
    return tuple(dict.fromkeys(read.studies.problems_of(tables, problems)))
