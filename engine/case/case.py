"""The checked case: what every calculation begins from."""

from __future__ import annotations

from dataclasses import dataclass

from engine.case.checks.find_problems import find_problems
from engine.case.data import CaseData
from engine.errors import CaseError


@dataclass(frozen=True)
class Case(CaseData):
    """A case that has passed every check; see `CaseData` for the fields and their units.

    Raises
    ------
    CaseError
        With every problem found, not only the first.
    """

    def __post_init__(self) -> None:

        problems = find_problems(self)
        if problems:
            raise CaseError(problems)
