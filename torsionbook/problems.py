"""What is wrong with an input, as records and as one exception."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from addin.contract.problems import CellProblem


@dataclass(frozen=True)
class Problem:
    """One thing wrong with an input, with the place where it is corrected."""

    sheet: str  #: Sheet of the workbook; of a JSON or of frames the sheet on which the table is shipped.
    table: str  #: Input table, or ``Case`` for a scalar; empty for a file.
    row: int | None  #: Row of the table counted from 1.
    column: str  #: Column, or name of the scalar; empty for a whole table.
    found: object  #: What was found, as typed. [number or text]
    allowed: str  #: What would be accepted.
    message: str  #: All of it in a sentence, and what to do.
    cell: str = (
        ""  #: Cell such as ``F12``, or key of the case JSON such as ``elements[2].stiffness``.
    )


class InputError(ValueError):
    """An input that cannot be read or calculated; carries everything that is wrong with it.

    Parameters
    ----------
    problems : tuple of Problem
        Everything wrong, in the order of the tables.
    """

    def __init__(self, problems: tuple[Problem, ...]) -> None:
        super().__init__("\n".join(problem.message for problem in problems))
        self.problems = problems

    def __reduce__(self) -> tuple[type[InputError], tuple[tuple[Problem, ...]]]:
        return type(self), (self.problems,)


def records(problems: Iterable[CellProblem]) -> tuple[Problem, ...]:
    """Problems of the add-in as those of this interface."""
    return tuple(
        Problem(p.sheet, p.table, p.row, p.column, p.found, p.allowed, p.message, p.cell)
        for p in problems
    )


def refuse(problems: Iterable[CellProblem]) -> None:
    """Raise what is wrong, if anything is.

    Raises
    ------
    InputError
        With all problems.
    """
    if found := records(problems):
        raise InputError(found)
