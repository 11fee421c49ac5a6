"""The inputs of a case as they are typed, to be filled into a new workbook."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from addin.contract.tables import INPUT_TABLES, SCALARS, STUDY_INPUT_TABLES, Field, TableSpec
from addin.contract.units import TRANSMITTED_TORQUE, parse_unit
from addin.reading.typed_case import CaseInput, Entry, Typed
from addin.template.examples import Example, Value
from engine.case.data import TABLES


class MixedUnits(Exception):
    """A column that no single unit can hold; the sentence says which."""


def example_of(read: CaseInput, system: str) -> Example:
    """What is typed in an input, in the units in which it is typed.

    A column whose cells are in several units, as in a case JSON, is converted to the unit of the
    template.

    Raises
    ------
    MixedUnits
        If a column holds numbers that cannot be said in one unit.
    """
    scalars: dict[str, Value] = {}
    scalar_units: dict[str, str] = {}
    for spec in SCALARS:
        entry = read.typed.scalars.get(spec.name)
        if entry is None or spec.name == "TemplateVersion":
            continue
        if isinstance(entry, Typed) and spec.has_unit:
            scalar_units[spec.name] = entry.unit or spec.si
            scalars[spec.name] = entry.number
        else:
            scalars[spec.name] = _plain(entry, spec)
    units: dict[tuple[str, str], str] = {}
    tables: dict[str, Sequence[Mapping[str, Value]]] = {}
    for table in INPUT_TABLES:
        rows = read.typed.tables.get(table.name, [])
        data = getattr(read.data, TABLES[table.name][0])
        tables[table.name] = _filled(table, rows, data, system, units)
    if read.studies is not None:
        for table in STUDY_INPUT_TABLES:
            rows = read.studies.typed.tables.get(table.name, [])
            data = getattr(read.studies.inputs, table.key)
            tables[table.name] = _filled(table, rows, data, system, units)
    return Example(
        scalars, units, {name: rows for name, rows in tables.items() if rows}, scalar_units
    )


def _filled(
    table: TableSpec,
    typed: Sequence[Mapping[str, Entry]],
    data: Sequence[Any],
    system: str,
    units: dict[tuple[str, str], str],
) -> list[dict[str, Value]]:
    """Rows of a table; the units of its columns go into `units`."""
    rows: list[dict[str, Value]] = [{} for _ in typed]
    for column in table.columns:
        cells = {i: row[column.name] for i, row in enumerate(typed) if column.name in row}
        numbers = [one for one in cells.values() if isinstance(one, Typed)]
        if not numbers or not column.has_unit:
            for i, entry in cells.items():
                rows[i][column.name] = _plain(entry, column)
            continue
        for i, entry in list(cells.items()):
            if isinstance(entry, str):  # a word in the place of a number
                rows[i][column.name] = entry
                del cells[i]
        used = {one.unit or column.si for one in numbers}
        if len(used) == 1:
            (units[table.name, column.name],) = used
            for i, entry in cells.items():
                assert isinstance(entry, Typed)
                rows[i][column.name] = entry.number
            continue
        if any(one.scale.base == TRANSMITTED_TORQUE for one in numbers):
            raise MixedUnits(
                f"table {table.name}, column {column.name}: torques and shares of the transmitted "
                "torque are mixed, but a workbook column has one unit. Write all of them in one unit."
            )
        unit = _absolute(column, system)
        units[table.name, column.name] = unit
        factor = parse_unit(unit, column.dimension).factor
        for i in cells:
            rows[i][column.name] = getattr(data[i], column.attribute) / factor
    return rows


def _absolute(column: Field, system: str) -> str:
    """A unit of the template that refers to nothing else; else the SI unit."""
    unit = str(getattr(column, f"unit_{system}"))
    return column.si if parse_unit(unit, column.dimension).base else unit


def _plain(entry: Entry, spec: Field) -> Value:
    if isinstance(entry, str):
        return entry
    return int(entry.number) if spec.kind == "integer" else entry.number
