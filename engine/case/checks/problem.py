"""How a problem of a cell is worded, and the checks that every table shares."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass

from engine.case.data import CaseData, Ratings
from engine.errors import Problem, Quoted


def number_text(value: object, unit: str = "") -> str:
    """A value as it stands in a sentence."""
    text = f"{value:.6g}" if isinstance(value, (int, float)) else f"'{value}'"
    return f"{text} {unit}".rstrip()


def wrong_value(
    table: str,
    row: int | None,
    column: str,
    found: object,
    allowed: str,
    action: str,
    unit: str = "",
    quoted: tuple[Quoted, ...] = (),
) -> Problem:
    """A problem whose sentence is: found …; it must be …. What to do."""
    return Problem(
        table,
        row,
        column,
        found,
        allowed,
        f"found {number_text(found, unit)}; it must be {allowed}. {action}",
        quoted,
    )


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


def blank_cell(table: str, row: int | None, column: str, allowed: str, action: str) -> Problem:
    """A problem for a blank that may not be blank."""
    return Problem(
        table, row, column, None, allowed, f"the cell is blank; it must be {allowed}. {action}"
    )


@dataclass(frozen=True)
class Allowed:
    """Numbers that a cell may hold, and how a sentence names them."""

    holds: Callable[[float], bool]  #: Whether a finite number is one of them. [SI]
    words: str  #: Behind "it must be".


POSITIVE = Allowed(lambda v: v > 0.0, "positive")
NOT_NEGATIVE = Allowed(lambda v: v >= 0.0, "zero or positive")
ANY_NUMBER = Allowed(lambda v: True, "a finite number")
BELOW_ONE = Allowed(lambda v: 0 <= v < 1, "at least 0 and below 1 (100 %)")


def check_number(
    table: str,
    row: int | None,
    column: str,
    value: float | None,
    allowed: Allowed,
    unit: str = "",
    action: str = "Correct the cell.",
) -> Iterator[Problem]:
    """A problem if a number is given and is not finite or does not hold.

    Parameters
    ----------
    table, row, column
        The cell; row is None for a scalar. [names]
    value : float or None
        What was typed. [SI]
    allowed : Allowed
        What it may be.
    unit : str, optional
        Unit of `value`. [unit]
    action : str, optional
        What to do about it.
    """
    if value is not None and not math.isfinite(value):
        yield wrong_value(table, row, column, value, "a finite number", "Correct the cell.", unit)
    elif value is not None and not allowed.holds(value):
        yield wrong_value(table, row, column, value, allowed.words, action, unit)


def blank_or_positive(value: float | None) -> bool:
    """Blank, or a finite positive number.

    Parameters
    ----------
    value : float or None
        What was typed. [SI]
    """
    return value is None or (math.isfinite(value) and value > 0.0)


def possible_ratings(case: CaseData) -> Ratings:
    """The ratings, all blank while one of the numbers they come from is impossible."""
    typed = (case.line_frequency, case.synchronous_speed, case.rated_power, case.rated_torque)
    if all(blank_or_positive(value) for value in typed) and possible_poles(case):
        return case.ratings
    return Ratings(None, None, None, None, None)


def possible_poles(case: CaseData) -> bool:
    """Whether the number of poles is blank, or even and 2 or more."""
    return case.poles is None or (case.poles >= 2 and case.poles % 2 == 0)


def check_names(
    table: str, column: str, names: Sequence[str | None], what: str
) -> Iterator[Problem]:
    """Blank and repeated names."""
    counts = Counter(name for name in names if name)
    first: dict[str, int] = {}
    for row, name in enumerate(names, start=1):
        if not name:
            yield blank_cell(table, row, column, f"the name of {what}", "Name it.")
        elif counts[name] > 1 and name in first:
            yield wrong_value(
                table,
                row,
                column,
                name,
                f"a name used once (row {first[name]} has it already)",
                "Rename one of the two."
                if table in ("Stations", "Elements", "Materials", "Excitations")
                else "Clear one of the two rows.",
            )
        else:
            first[name] = row


def suggestion(name: str, names: set[str]) -> str:
    """The known name most like a mistyped one."""
    import difflib

    if len(names) > 200:  # comparing each of thousands of wrong names with thousands would not end
        return "Correct the name, or add its row."
    folded = {k.casefold(): k for k in sorted(names)}
    close = difflib.get_close_matches(name.casefold(), list(folded), n=1)
    return f"Did you mean '{folded[close[0]]}'?" if close else "Correct the name, or add its row."


def check_station(
    case: CaseData, table: str, row: int, station: str | None, column: str = "Station"
) -> Iterator[Problem]:
    """A station that is named and known."""
    stations = {s.station for s in case.stations if s.station}
    if station is None:
        yield blank_cell(table, row, column, "a station of table Stations", "Choose it.")
    elif station not in stations:
        yield wrong_value(
            table,
            row,
            column,
            station,
            "a station of table Stations",
            suggestion(station, stations),
        )


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
