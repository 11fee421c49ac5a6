"""Problems with the place where an engineer finds them, and the nearest of known words."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from addin.contract.tables import SCALAR_TABLE
from engine.errors import Problem

_NOT_TEXT = re.compile(
    "[\x00-\x1f\x7f-\x9f\u200e\u200f\u202a-\u202e\u2066-\u2069\ud800-\udfff\ufffe\uffff]"
)


#: Characters without ink or width, which come along when words are copied from elsewhere.
_UNSEEN = dict.fromkeys(map(ord, "\u00ad\u200b\u200c\u200d\u200e\u200f\u2060\ufeff"))


@dataclass(frozen=True)
class CellProblem:
    """One thing wrong in a workbook or a case JSON, with the place to correct it."""

    sheet: str  #: Sheet; of a JSON case the sheet the table is shipped on.
    table: str  #: Input table, or ``Case`` for a scalar.
    row: int | None  #: Row of the table counted from 1, blank rows included.
    column: str  #: Column header or name of the scalar; empty for a whole table.
    found: Any  #: What was found, as typed. [number or text]
    allowed: str  #: What would be accepted.
    message: str  #: The whole sentence, beginning with the place.
    #: Cell such as ``F12``, or path such as ``elements[2].stiffness``; empty when there is none.
    cell: str = ""

    def as_json(self) -> dict[str, Any]:
        """The problem in the form of the contract."""
        plain = self.found is None or isinstance(self.found, (bool, int, str))
        return {
            "sheet": self.sheet,
            "table": self.table,
            "row": self.row,
            "column": self.column,
            "found": self.found if plain else _shown(self.found),
            "allowed": self.allowed,
            "message": self.message,
        }


def _shown(found: object) -> object:
    """A found value JSON can hold: finite numbers stay numbers."""
    if isinstance(found, float) and abs(found) < float("inf"):
        return found
    return str(found)


def placed(problem: Problem, sheet: str, cell: str, kind: str = "cell") -> CellProblem:
    """A problem with its place put in front of its sentence.

    Parameters
    ----------
    problem : Problem
        With the row the engineer sees. [problem]
    sheet, cell : str
        Where it is; the cell may be empty. [name]
    kind : str
        What the cell is called: ``cell`` of a workbook, ``key`` of a JSON case. [word]
    """
    where = [f"Sheet {sheet}"]
    if problem.table != SCALAR_TABLE:
        where.append(f"table {problem.table}")
    if problem.row is not None:
        where.append(f"row {problem.row}")
    if problem.column:
        where.append(problem.column)
    place = ", ".join(where)
    if cell:
        place += f" ({kind} {cell})"
    return CellProblem(
        sheet,
        problem.table,
        problem.row,
        problem.column,
        problem.found,
        problem.allowed,
        printable(f"{place}: {problem.message}"),
        cell,
    )


def nearest(word: str, words: Iterable[str], cutoff: float = 0.6) -> str | None:
    """The known word most like a mistyped one, capitals aside.

    Parameters
    ----------
    word : str
        What was typed. [word]
    words : iterable of str
        What it may have been meant to be. [words]
    cutoff : float
        Least likeness. [1]

    Returns
    -------
    str or None
        None when nothing is alike.
    """
    from difflib import get_close_matches

    folded = {candidate.casefold(): candidate for candidate in words}
    close = get_close_matches(word.casefold(), folded, n=1, cutoff=cutoff)
    return folded[close[0]] if close else None


def first_of(sentences: Sequence[str], most: int) -> list[str]:
    """The first sentences, so many at the most, and how many more there are."""
    more = [f"And {len(sentences) - most} more."] if len(sentences) > most else []
    return [*sentences[:most], *more]


def as_seen(text: str) -> str:
    """A text without what nobody sees: characters of no width, blanks at its ends, blanks of any kind but one."""
    return " ".join(text.translate(_UNSEEN).split())


def shortened(text: str, longest: int = 60) -> str:
    """A text that fits into a sentence."""
    return text if len(text) <= longest else text[: longest - 3] + "..."


def printable(text: str) -> str:
    """A text fit for a screen: controls become a blank; what turns the direction of writing, and half characters, U+FFFD."""
    return _NOT_TEXT.sub(lambda found: " " if found[0] < "\xa0" else "\ufffd", text)
