"""The error tree of the engine.

::

    TorsionError
    ├── CaseError        what the engineer typed cannot be right (carries every Problem found)
    ├── ModelError       each number is possible, the train as a whole is not
    └── InternalError    an assumption of ours broke; please report it
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Quoted:
    """A quantity in the sentence of a problem, beside the one found.

    The engine says it in SI; whoever knows what was typed can say it in that unit.
    """

    text: str  #: As it stands in the sentence, such as ``182.841 rad/s``. [SI]
    value: float  #: The quantity. [SI]
    #: Table, row and column where it was typed; None = a limit of the kind of what was found.
    place: tuple[str, int | None, str] | None = None


@dataclass(frozen=True)
class Problem:
    """One thing wrong in the input, told so that an engineer can act on it.

    The engine knows table, row and column; the add-in adds sheet and cell.
    """

    table: str  #: Input table of the contract, or ``"Case"`` for a scalar.
    row: int | None  #: Row inside the table counted from 1; None for a scalar or a whole table.
    column: str  #: Column header, or the name of the scalar; empty for a whole table.
    found: object  #: The value found, as the engineer would recognise it. [as typed]
    allowed: str  #: What would be accepted.
    message: str  #: The whole sentence: what is wrong and what to do.
    #: Quantities that `allowed` and `message` name beside `found`. [SI]
    quoted: tuple[Quoted, ...] = ()
    #: Table that lacks a name, and the name: problems that share it have one cause.
    missing: tuple[str, str] | None = None


class TorsionError(Exception):
    """Base of every error the engine raises on purpose."""


class CaseError(TorsionError):
    """Wrong input; carries all problems of the case at once.

    Parameters
    ----------
    problems : tuple of Problem
        Everything found wrong, in the order of the tables. [count]
    """

    def __init__(self, problems: tuple[Problem, ...]) -> None:
        super().__init__("\n".join(p.message for p in problems))
        self.problems = problems


class ModelError(TorsionError):
    """The numbers are possible one by one, the train they describe is not."""


class InternalError(TorsionError):
    """A broken assumption inside the engine, with the numbers that show it."""
