"""How a problem of a cell is worded, and the checks that every table shares."""

from __future__ import annotations

import difflib
import math
from collections import Counter
from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import NamedTuple, TypeVar

from engine.case.data import CaseData, Ratings, value_of
from engine.errors import Problem, Quoted

Row = TypeVar("Row")


def number_text(value: object, unit: str = "") -> str:
    """A value as shown in a sentence."""
    text = f"{value:.6g}" if isinstance(value, (int, float)) else f"'{value}'"
    return f"{text} {unit}".rstrip()


def quote_quantity(
    value: float, unit: str, place: tuple[str, int | None, str] | None = None
) -> tuple[Quoted, ...]:
    """A quantity named in a sentence as `number_text` writes it.

    Parameters
    ----------
    value : float
        The quantity. [SI]
    unit : str
        Its unit as the sentence writes it. [unit]
    place : (table, row, column), optional
        The cell it was typed in. [names]
    """
    return (Quoted(number_text(value, unit), value, place),)


@dataclass(frozen=True)
class Allowed:
    """Numbers that a cell may hold, and how a sentence names them."""

    holds: Callable[[float], bool]  #: Whether a finite number is one of them. [SI]
    words: str  #: Behind "it must be".


POSITIVE = Allowed(lambda v: v > 0.0, "positive")
NOT_NEGATIVE = Allowed(lambda v: v >= 0.0, "zero or positive")
ANY_NUMBER = Allowed(lambda v: True, "a finite number")
AT_LEAST_ONE = Allowed(lambda v: v >= 1.0, "1 or more")
BELOW_ONE = Allowed(lambda v: 0 <= v < 1, "at least 0 and below 1 (100 %)")


class Limit(NamedTuple):
    """What one number of a row may be."""

    column: str  #: Column header, or the name of the scalar.
    allowed: Allowed  #: What it may be.
    unit: str = ""  #: Unit of the number. [unit]
    action: str = "Correct the cell."  #: What to do about another one.


#: Voltage over that of the torque curves; more is a percent sign forgotten.
LARGEST_VOLTAGE = 2.0
VOLTAGE = Limit(
    "Voltage",
    Allowed(
        lambda v: 0 < v <= LARGEST_VOLTAGE,
        "positive and at most 2 (200 % of the voltage of the curves)",
    ),
    "",
    "Write 80 % or 0.8.",
)


#: How often something happens.
COUNTS = Allowed(NOT_NEGATIVE.holds, "zero or more, and finite")


class Cells(NamedTuple):
    """The cells of one row, or the scalars of the case, and how a sentence names what is wrong."""

    table: str  #: Input table, or ``Case``.
    row: int | None = None  #: Counted from 1; None for scalars and for a whole table.

    def problem(
        self,
        column: str,
        found: object,
        allowed: str,
        message: str,
        quoted: tuple[Quoted, ...] = (),
    ) -> Problem:
        """A problem with a sentence of its own."""
        return Problem(self.table, self.row, column, found, allowed, message, quoted)

    def wrong(
        self,
        column: str,
        found: object,
        allowed: str,
        action: str,
        unit: str = "",
        quoted: tuple[Quoted, ...] = (),
    ) -> Problem:
        """A problem whose sentence is: found …; it must be …. What to do."""
        sentence = f"found {number_text(found, unit)}; it must be {allowed}. {action}"
        return self.problem(column, found, allowed, sentence, quoted)

    def blank(self, column: str, allowed: str, action: str) -> Problem:
        """A problem for a blank that may not be blank."""
        sentence = f"the cell is blank; it must be {allowed}. {action}"
        return self.problem(column, None, allowed, sentence)

    def number(self, value: float | str | None, limit: Limit) -> Iterator[Problem]:
        """A problem if a number is given and is not finite or not allowed; the value in SI.

        A word in its place has been chosen from a list.
        """
        column, allowed, unit, action = limit
        if isinstance(value, str):
            return
        if value is not None and not math.isfinite(value):
            yield self.wrong(column, value, ANY_NUMBER.words, "Correct the cell.", unit)
        elif value is not None and not allowed.holds(value):
            yield self.wrong(column, value, allowed.words, action, unit)

    def numbers(self, row: object, limits: Iterable[Limit]) -> Iterator[Problem]:
        """The numbers of a row, each by itself."""
        for limit in limits:
            yield from self.number(value_of(row, limit.column), limit)

    def choice(
        self, column: str, value: str | None, words: type[StrEnum], allowed: str = ""
    ) -> Iterator[Problem]:
        """A problem if a word is given and is not in the list."""
        if value is not None and value not in tuple(words):
            allowed = allowed or "one of " + ", ".join(words)
            yield self.wrong(column, value, allowed, "Choose from the list.")

    def name(
        self, column: str, name: str | None, names: Collection[str], lacking: str
    ) -> Iterator[Problem]:
        """A problem if a name of another table is blank or unknown there."""
        if name is None:
            yield self.blank(column, name_of(lacking), "Choose it.")
        elif name not in names:
            yield self.unknown(column, name, lacking, suggestion(name, names))

    def unknown(
        self, column: str, name: str, lacking: str, action: str, allowed: str = ""
    ) -> Problem:
        """A problem for a name that another table lacks."""
        problem = self.wrong(column, name, allowed or name_of(lacking), action)
        return replace(problem, missing=(lacking, name))


#: The scalars of the case.
SCALARS = Cells("Case")
#: Tables that others refer to by name, and what is named there.
_NAMED = {
    "Stations": "a station",
    "Elements": "an element",
    "Materials": "a material",
    "SectionMaterials": "a material",
    "MotorData": "a station",
}


def name_of(table: str) -> str:
    """What a reference to a table may hold, in words."""
    return f"{_NAMED[table]} of table {table}"


def each_row(table: str, rows: Iterable[Row]) -> Iterator[tuple[Cells, Row]]:
    """The rows of a table, each with its cells."""
    return ((Cells(table, number), row) for number, row in enumerate(rows, start=1))


def blank_or_positive(value: float | None) -> bool:
    """Blank, or a finite positive number.

    Parameters
    ----------
    value : float or None
        What was typed. [SI]
    """
    return value is None or (math.isfinite(value) and value > 0.0)


def has_possible_ratings(case: CaseData) -> bool:
    """Whether none of the numbers that the ratings come from is impossible; else that is reported."""
    typed = (case.line_frequency, case.synchronous_speed, case.rated_power, case.rated_torque)
    return all(blank_or_positive(value) for value in typed) and possible_poles(case)


def possible_ratings(case: CaseData) -> Ratings:
    """The ratings, all blank while one of the numbers they come from is impossible."""
    if has_possible_ratings(case):
        return case.ratings
    return Ratings(None, None, None, None, None)


def possible_poles(case: CaseData) -> bool:
    """Whether the number of poles is blank, or even and 2 or more."""
    return case.poles is None or (case.poles >= 2 and case.poles % 2 == 0)


def check_names(
    table: str, column: str, names: Iterable[str | None], what: str
) -> Iterator[Problem]:
    """Blank and repeated names."""
    first: dict[str, int | None] = {}
    for cells, name in each_row(table, names):
        if not name:
            yield cells.blank(column, f"the name of {what}", "Name it.")
        elif name in first:
            allowed = f"a name used once (row {first[name]} has it already)"
            named = table in ("Stations", "Elements", "Materials", "Excitations")
            action = "Rename one of the two." if named else "Clear one of the two rows."
            yield cells.wrong(column, name, allowed, action)
        else:
            first[name] = cells.row


def suggestion(name: str, names: Collection[str]) -> str:
    """The known name most like a mistyped one."""
    close = _nearest(name, names)
    return f"Did you mean '{close}'?" if close else "Correct the name, or add its row."


def _nearest(name: str, names: Collection[str]) -> str | None:
    if len(names) > 200:  # comparing each of thousands of wrong names with thousands would not end
        return None
    folded = {k.casefold(): k for k in sorted(names)}
    close = difflib.get_close_matches(name.casefold(), list(folded), n=1)
    return folded[close[0]] if close else None


def probably_meant(typed: Iterable[str | None], names: Collection[str]) -> set[str]:
    """Known names that unknown ones are most like: what follows from the wrong name is not reported as well."""
    unknown = {name for name in typed if name and name not in names}
    return {close for name in unknown if (close := _nearest(name, names))}


def first_of_each_cell(
    problems: Iterable[Problem], bad_cells: Collection[tuple[str, int | None, str]]
) -> list[Problem]:
    """At most one problem a cell, and none of cells the reader has already reported."""
    first: dict[tuple[str, int | None, str], Problem] = {}
    for problem in problems:
        place = (problem.table, problem.row, problem.column)
        if place not in bad_cells:
            first.setdefault(place, problem)
    return list(first.values())


#: Most tables whose references to a missing name are counted in its sentence.
_TABLES_NAMED = 4


def first_of_each_cause(problems: Sequence[Problem]) -> list[Problem]:
    """One problem a missing name, at its first reference; its sentence counts the others."""
    references: dict[tuple[str, str], list[Problem]] = {}
    for problem in problems:
        if problem.missing is not None:
            references.setdefault(problem.missing, []).append(problem)
    kept: list[Problem] = []
    for problem in problems:
        if problem.missing is None:
            kept.append(problem)
            continue
        first, *others = references[problem.missing]
        if problem is first:
            kept.append(_with_others(first, problem.missing[0], others))
    return kept


def _with_others(first: Problem, lacking: str, others: Sequence[Problem]) -> Problem:
    if not others:
        return first
    counts = Counter(problem.table for problem in others)
    named = [f"{table} ({count})" for table, count in counts.most_common(_TABLES_NAMED)]
    if len(counts) > _TABLES_NAMED:
        named.append("others")
    cells = "cell has" if len(others) == 1 else "cells have"
    sentence = (
        f"{first.message} {len(others)} more {cells} this name: {', '.join(named)}. If it is right there, correct "
        f"table {lacking} alone."
    )
    return replace(first, message=sentence)
