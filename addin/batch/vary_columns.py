"""Columns of a programme's table: which input of the base case each header names, and its unit."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeVar

from addin.contract.problems import nearest, shortened
from addin.contract.tables import INPUT_TABLES, SCALAR_TABLE, SCALARS, Field, TableSpec
from addin.contract.units import UnitError, UnitScale, parse_unit
from addin.reading.typed_case import Place, TypedCase


class TableRefused(Exception):
    """The table cannot be used; each sentence names the column or the row."""

    def __init__(self, *sentences: str) -> None:
        super().__init__("\n".join(sentences))
        self.sentences = sentences


@dataclass(frozen=True)
class Varied:
    """One column of the table."""

    header: str  #: As it stands there.
    place: Place  #: Table (``Case`` for a scalar), row counted from 1, column.
    spec: Field  #: The input it names.
    unit: str = ""  #: The unit in its header; empty for SI. [unit]
    scale: UnitScale | None = None  #: What that unit is worth. [scale]


_COLUMN = re.compile(
    r"(?P<table>\w+)(?:\[(?P<row>.*?)\]\s*\.\s*(?P<column>[^\[\]]+?))?(?:\s*\[(?P<unit>[^\[\]]*)\])?"
)


_NAMES = ("name", "case")


def read_columns(headers: Sequence[str], base: TypedCase) -> tuple[list[Varied | None], int | None]:
    """What the columns of a table name.

    Parameters
    ----------
    headers : sequence of str
        Its first row. [text]
    base : TypedCase
        The base case. [as typed]

    Returns
    -------
    columns : list of (Varied or None)
        None for the column of names.
    names : int or None
        Its index, counted from 0.

    Raises
    ------
    TableRefused
        With a sentence for each wrong column.
    """
    wrong: list[str] = []
    columns: list[Varied | None] = []
    names: int | None = None
    seen: dict[Place, str] = {}
    for index, header in enumerate(headers):
        text = header.strip()
        if text.casefold() in _NAMES and names is None:
            names = index
            columns.append(None)
            continue
        try:
            column = _column(text, base)
        except _WrongColumn as problem:
            wrong.append(f"column {index + 1}, '{shortened(text)}': {problem}")
            continue
        if column.place in seen:
            wrong.append(
                f"column {index + 1}, '{text}': column '{seen[column.place]}' names the same input."
            )
        seen[column.place] = text
        columns.append(column)
    if not wrong and not any(columns):
        wrong.append("no column of the table names an input. Add a column such as DampingRatio.")
    if wrong:
        raise TableRefused(*wrong)
    return columns, names


class _WrongColumn(Exception):
    """A column that names no input; the sentence says why."""


def _column(header: str, base: TypedCase) -> Varied:
    match = _COLUMN.fullmatch(header)
    if match is None:
        raise _WrongColumn(
            "it must name a scalar, such as DampingRatio, or a cell of a table, such as "
            "Elements[LS coupling].Stiffness, and may end in a unit, such as [N*m/rad]."
        )
    name, row, column, unit = match.group("table", "row", "column", "unit")
    if column is None:
        spec = _named(name, SCALARS, "scalar")
        place: Place = (SCALAR_TABLE, None, spec.name)
    else:
        table = _named(name, INPUT_TABLES, "input table")
        spec = _named(column, table.columns, f"column of {table.name}")
        place = (table.name, _row(table, row, base), spec.name)
    if not unit:
        return Varied(header, place, spec)
    if not spec.has_unit:
        raise _WrongColumn(f"{spec.name} has no unit. Leave out [{unit}].")
    try:
        return Varied(header, place, spec, unit, parse_unit(unit, spec.dimension))
    except UnitError as error:
        raise _WrongColumn(error.message) from error


_T = TypeVar("_T", Field, TableSpec)


def _named(word: str, known: Sequence[_T], what: str) -> _T:
    """The input of a name or JSON key, capitals aside."""
    for record in known:
        if word.casefold() in (record.name.casefold(), record.key):
            return record
    meant = nearest(word, [record.name for record in known])
    advice = f" Did you mean '{meant}'?" if meant else ""
    raise _WrongColumn(f"{what} '{shortened(word)}' does not exist.{advice}")


def _row(table: TableSpec, word: str, base: TypedCase) -> int:
    """The row of the base case that a name or number means."""
    rows = base.tables.get(table.name, [])
    first = table.columns[0].name
    by_name = [str(row.get(first, "")) for row in rows]
    unique = len(set(by_name)) == len(by_name)
    if unique and word in by_name:
        return by_name.index(word) + 1
    if word.isascii() and word.isdigit() and 1 <= int(word) <= len(rows):
        return int(word)
    if not rows:
        raise _WrongColumn(f"the base case has no row in table {table.name}.")
    names = by_name if unique else []
    meant = nearest(word, names)
    advice = f" Did you mean '{meant}'?" if meant else ""
    by = f"the name in its column {first}, or by " if names else ""
    raise _WrongColumn(
        f"table {table.name} of the base case has no row '{shortened(word)}'.{advice} Name a row by "
        f"{by}its number, 1 to {len(rows)}."
    )
