"""An input checked without calculating: what is wrong, what looks like a slip, what cannot be answered yet."""

from __future__ import annotations

from dataclasses import dataclass

from addin.calculation.audit import library_words
from addin.calculation.full_speed_words import full_speed_words
from addin.contract.problems import CellProblem
from addin.reading.one_file import Unreadable
from addin.reading.typed_case import CaseInput
from addin.studies.registry import of_studies
from addin.writing.recalculate import case_problems
from engine.case.missing_inputs import missing_inputs
from engine.case.plausibility import implausible
from engine.errors import CaseError, ModelError
from engine.model.build_train import build_train
from engine.operation.full_speed import full_speed
from engine.operation.plausible_train import impossible_train, unusual_train


@dataclass(frozen=True)
class CheckedInput:
    """What is to be said of an input before it is calculated."""

    problems: tuple[CellProblem, ...]  #: Everything wrong, study sheets included.
    #: What the reader noted; of an input without problems also what looks like a slip of unit, column or row.
    notes: tuple[str, ...]
    full_speed: str = ""  #: The train at full speed in words, where nothing is wrong.
    steels: tuple[str, ...] = ()  #: Strengths that come from the library of steels, in words.
    open_answers: tuple[str, ...] = ()  #: Answers that cannot be given, and the input each lacks.


def check_input(read: CaseInput | Unreadable) -> CheckedInput:
    """Check an input that has been read."""
    problems = (*read.problems, *of_studies(read))
    if isinstance(read, Unreadable) or read.problems:
        return CheckedInput(problems, read.warnings)
    try:
        case = read.case()
        train = build_train(case)
        facts = full_speed(case, train)
        notes = (
            *read.warnings,
            *(one.sentence for one in impossible_train(case, train, facts)),
            *implausible(case),
            *unusual_train(case, train, facts),
        )
    except (CaseError, ModelError) as error:
        return CheckedInput(case_problems(error), read.warnings)
    steels = tuple(
        f"{row.material}: {library_words(row.library_steel)}"
        for row in case.materials
        if row.library_steel is not None
    )
    return CheckedInput(
        problems, notes, full_speed_words(facts), steels, tuple(missing_inputs(case))
    )
