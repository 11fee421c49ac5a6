"""Names of single inputs: ``DampingRatio``, ``Elements[LS coupling].Stiffness``, ``MotorTorque[3].Pulsating [pu]``.

Where a script or a programme of cases changes an input, it says so in these words.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

from addin.contract.problems import nearest, shortened
from addin.contract.tables import INPUT_TABLES, SCALAR_TABLE, SCALARS, Field, TableSpec
from addin.contract.units import UnitError, UnitScale, parse_unit
from addin.reading.case_json import typed_value
from addin.reading.typed_case import Entry, Findings, Place, Typed, TypedCase


class WrongName(Exception):
    """Words that name no input; the sentence says why."""


@dataclass(frozen=True)
class NamedInput:
    """One input of a case, by its name."""

    name: str  #: As it was written.
    place: Place  #: Table (``Case`` for a scalar), row counted from 1, column.
    spec: Field  #: The input it names.
    unit: str = ""  #: The unit behind the name; empty for SI. [unit]
    scale: UnitScale | None = None  #: What that unit is worth. [scale]


_NAME = re.compile(
    r"(?P<table>\w+)(?:\[(?P<row>.*?)\]\s*\.\s*(?P<column>[^\[\]]+?))?(?:\s*\[(?P<unit>[^\[\]]*)\])?"
)


def named_input(
    name: str, base: TypedCase, tables: Sequence[TableSpec] = INPUT_TABLES
) -> NamedInput:
    """The input that a name stands for.

    Parameters
    ----------
    name : str
        A scalar, or a cell of a table by row and column; a unit in brackets may follow. [words]
    base : TypedCase
        The case. [as typed]
    tables : sequence of TableSpec, optional
        Tables whose cells may be named; default those of the case.

    Raises
    ------
    WrongName
        With a sentence that says what is wrong.
    """
    match = _NAME.fullmatch(name)
    if match is None:
        raise WrongName(
            "it must name a scalar, such as DampingRatio, or a cell of a table, such as "
            "Elements[LS coupling].Stiffness, and may end in a unit, such as [N*m/rad]."
        )
    head, row, column, unit = match.group("table", "row", "column", "unit")
    if column is None:
        spec = called(head, SCALARS, "scalar")
        place: Place = (SCALAR_TABLE, None, spec.name)
    else:
        table = called(head, tables, "input table")
        spec = called(column, table.columns, f"column of {table.name}")
        place = (table.name, _row(table, row, base), spec.name)
    if not unit:
        return NamedInput(name, place, spec)
    if not spec.has_unit:
        raise WrongName(f"{spec.name} has no unit. Leave out [{unit}].")
    try:
        return NamedInput(name, place, spec, unit, parse_unit(unit, spec.dimension))
    except UnitError as error:
        raise WrongName(error.message) from error


def named_row(
    name: str, base: TypedCase, tables: Sequence[TableSpec] = INPUT_TABLES
) -> tuple[TableSpec, int | None] | None:
    """The table and row that a name such as ``Elements[LS coupling]`` stands for.

    Parameters
    ----------
    name : str
        Table and row; ``+`` in place of the row is a new one. [words]
    base : TypedCase
        The case. [as typed]
    tables : sequence of TableSpec, optional
        Tables whose rows may be named; default those of the case.

    Returns
    -------
    tuple or None
        Table and row, counted from 1; None in place of the row for a new one. None for what is no row of a table.

    Raises
    ------
    WrongName
        If the table has no such row.
    """
    whole, match = _NAME.fullmatch(name), _ROW_NAME.fullmatch(name)
    if match is None or (whole is not None and whole["column"] is not None):
        return None
    word, row = match.group("table", "row")
    table = next((t for t in tables if word.casefold() in (t.name.casefold(), t.key)), None)
    if table is None:
        return None
    return table, None if row.strip() == "+" else _row(table, row, base)


_ROW_NAME = re.compile(r"(?P<table>\w+)\s*\[(?P<row>.*)\]")
_T = TypeVar("_T", Field, TableSpec)


def called(word: str, known: Sequence[_T], what: str) -> _T:
    """The record of a name or JSON key, capitals aside.

    Raises
    ------
    WrongName
        If there is none; the sentence names the nearest.
    """
    for record in known:
        if word.casefold() in (record.name.casefold(), record.key):
            return record
    meant = nearest(word, [record.name for record in known])
    advice = f" Did you mean '{meant}'?" if meant else ""
    raise WrongName(f"{what} '{shortened(word)}' does not exist.{advice}")


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
        raise WrongName(f"the base case has no row in table {table.name}.")
    names = by_name if unique else []
    meant = nearest(word, names)
    advice = f" Did you mean '{meant}'?" if meant else ""
    by = f"the name in its column {first}, or by " if names else ""
    raise WrongName(
        f"table {table.name} of the base case has no row '{shortened(word)}'.{advice} Name a row by "
        f"{by}its number, 1 to {len(rows)}."
    )


def entry_of(named: NamedInput, value: Any, findings: Findings) -> Entry | None:
    """A value as an entry of the input; None for a blank and for one that cannot be read."""
    if value is None or (isinstance(value, str) and not value.strip()):
        return None
    if isinstance(value, str) and named.spec.is_number:
        try:
            value = float(value)
        except ValueError:
            value = value.strip()
    elif not named.spec.is_number and not isinstance(value, str):
        value = f"{value:.15g}" if isinstance(value, float) else str(value)
    entry = typed_value(value, named.spec, named.place, findings, named.unit)
    if isinstance(entry, Typed) and named.scale is not None and not isinstance(value, str):
        return Typed(entry.number, named.scale, named.unit)
    return entry
