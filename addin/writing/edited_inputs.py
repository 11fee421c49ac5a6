"""Inputs of a file as they are typed, and the same file with some of them typed anew."""

from __future__ import annotations

import json
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from addin.contract.field import Field
from addin.contract.tables import EVERY_INPUT, INPUT_TABLES, SCALAR_TABLE, SCALARS, TableSpec
from addin.reading.input_names import NamedInput, WrongName, called, named_input, named_row
from addin.reading.typed_case import CaseInput, Entry, Typed, TypedCase
from addin.reading.workbook import Locations, WorkbookInput
from addin.xlsx import Workbook
from addin.xlsx.errors import CellRefused, ObstaclesFound
from addin.xlsx.references import cell_name
from addin.xlsx.tables import Table
from addin.xlsx.values import Formula
from addin.xlsx.whole_files import write_json

#: The scalar that is no input of the engineer's.
_VERSION = "TemplateVersion"
_CASE_TABLES = tuple(spec.name for spec in INPUT_TABLES)


class WrongEdit(Exception):
    """An edit that cannot be made; the sentence says why."""


def typed_inputs(read: CaseInput, tables: Collection[str] = _CASE_TABLES) -> dict[str, Any]:
    """Everything typed in an input.

    Parameters
    ----------
    read : CaseInput
        A workbook or a case JSON.
    tables : collection of str, optional
        Input tables that are wanted; default those of the case. [names]

    Returns
    -------
    dict
        ``scalars``, those that are blank among them, and ``tables`` that the file has, with all its columns and the rows
        that have entries. [typed units]
    """
    units, typed = _BlankUnits(read), _everything_typed(read)
    scalars = [
        _described(spec)
        | _cell(read.typed.scalars.get(spec.name), spec, units.of(SCALAR_TABLE, spec))
        for spec in SCALARS
        if spec.name != _VERSION
    ]
    return {
        "scalars": scalars,
        "tables": [
            _table(spec, typed.tables.get(spec.name, ()), columns, units)
            for spec in EVERY_INPUT
            if spec.name in tables and (columns := _columns(read, spec))
        ],
    }


def _everything_typed(read: CaseInput) -> TypedCase:
    """The tables of the case and of its studies."""
    of_studies = {} if read.studies is None else read.studies.typed.tables
    return TypedCase(read.typed.scalars, {**read.typed.tables, **of_studies})


def _locations(read: WorkbookInput, table: str) -> Locations:
    return read.locations if table in (SCALAR_TABLE, *_CASE_TABLES) else read.study_locations


def _columns(read: CaseInput, spec: TableSpec) -> list[Field]:
    """The columns that can be typed in: those that a workbook has."""
    if not isinstance(read, WorkbookInput):
        return list(spec.columns)
    there = _locations(read, spec.name)
    return [column for column in spec.columns if (spec.name, column.name) in there.columns]


def _described(spec: Field) -> dict[str, Any]:
    return {
        "name": spec.name,
        "help": spec.help,
        "number": spec.is_number,
        "choices": list(spec.choices),
    }


class _BlankUnits:
    """Units of cells without a number: what the workbook states beside them, else SI."""

    def __init__(self, read: CaseInput) -> None:
        self._read = read
        self._known: dict[tuple[str, str], str] = {}

    def of(self, table: str, spec: Field) -> str:
        """The unit in which a number typed there will be read."""
        if not spec.has_unit:
            return ""
        place = (table, spec.name)
        if place not in self._known:
            self._known[place] = self._stated(place) or spec.si
        return self._known[place]

    def _stated(self, place: tuple[str, str]) -> str:
        read = self._read
        if not isinstance(read, WorkbookInput):
            return ""
        stated = _locations(read, place[0]).units.get(place)
        return "" if stated is None else str(read.workbook.shown_value(*stated) or "").strip()


def _cell(entry: Entry | None, spec: Field, of_blank: str) -> dict[str, Any]:
    if isinstance(entry, Typed):
        return {"value": entry.number, "unit": entry.unit if spec.has_unit else ""}
    return {"value": entry, "unit": of_blank}


def _table(
    table: TableSpec,
    rows: Sequence[Mapping[str, Entry]],
    columns: Sequence[Field],
    units: _BlankUnits,
) -> dict[str, Any]:
    """A table with a name for each row, as `named_input` takes it."""
    first = table.columns[0].name
    words = [str(row.get(first, "")) for row in rows]
    by_name = len(set(words)) == len(words) and "" not in words
    return {
        "name": table.name,
        "help": table.help,
        "columns": [
            _described(column)
            | {
                "unit": units.of(table.name, column),
                "used": any(column.name in row for row in rows),
            }
            for column in columns
        ],
        "rows": [
            {
                "name": word if by_name else str(number),
                "cells": [
                    _cell(row.get(column.name), column, units.of(table.name, column))
                    for column in columns
                ],
            }
            for number, (word, row) in enumerate(zip(words, rows, strict=True), start=1)
        ],
    }


# --- edits ----------------------------------------------------------------------------------------


@dataclass(frozen=True)
class _Edits:
    """What is to be typed anew; rows are counted as they are before."""

    cells: list[tuple[NamedInput, Any]]  #: Cells with their values. [typed units]
    removed: list[tuple[TableSpec, int]]  #: Tables and rows counted from 1.
    added: list[tuple[TableSpec, list[tuple[Field, Any]]]]  #: Tables and cells of the new row.


def edit_inputs(read: CaseInput, source: Path, changes: Mapping[str, Any], target: Path) -> None:
    """Write the same file with other values in some of its inputs; results in it stay as they are.

    A number stands in the unit that its cell has; a formula in the cell is replaced. A row that is removed from a
    workbook stays there as a blank row, which is passed over; a new one goes into the first blank row behind the
    others, and where there is none the table grows by one.

    Parameters
    ----------
    read : CaseInput
        What was read from the file.
    source : Path
        The file. [path]
    changes : mapping
        Number, word or None = blank, by the name of the input: ``DampingRatio``,
        ``Elements[LS coupling].Stiffness``. ``Elements[LS coupling]`` with None removes the row, ``Elements[+]`` with a
        mapping of columns, or a list of such, adds rows. [typed units]
    target : Path
        The file to write. [path]

    Raises
    ------
    WrongEdit
        If a name leads nowhere or a value cannot stand there.
    """
    edits = _read_edits(changes, _everything_typed(read))
    if isinstance(read, WorkbookInput):
        _edit_workbook(read, edits, target)
    else:
        _edit_json(read, json.loads(source.read_text(encoding="utf-8-sig")), edits, target)


def _read_edits(changes: Mapping[str, Any], typed: TypedCase) -> _Edits:
    edits = _Edits([], [], [])
    for name, value in changes.items():
        try:
            row = named_row(name, typed, EVERY_INPUT)
            if row is None:
                named = named_input(name, typed, EVERY_INPUT)
                _check(named.name, named.spec, value)
                edits.cells.append((named, value))
            elif row[1] is None:
                new = value if isinstance(value, list) else [value]
                edits.added.extend((row[0], _new_row(name, row[0], one)) for one in new)
            elif value is None:
                edits.removed.append((row[0], row[1]))
            else:
                raise WrongEdit(f"{name}: a row is removed with null. Name a column to change it.")
        except WrongName as wrong:
            raise WrongEdit(f"'{name[:80]}': {wrong} Nothing was changed.") from None
    return edits


def _new_row(name: str, table: TableSpec, value: Any) -> list[tuple[Field, Any]]:
    cells = value if isinstance(value, Mapping) else {}
    row = [
        (called(str(column), table.columns, f"column of {table.name}"), one)
        for column, one in cells.items()
        if one is not None
    ]
    for spec, one in row:
        _check(f"{name}.{spec.name}", spec, one)
    if not row:
        raise WrongEdit(
            f'{name}: a new row needs a value, such as {{"{table.columns[0].name}": ...}}.'
        )
    return row


def _check(name: str, spec: Field, value: Any) -> None:
    """Refuse a value of another kind than the input takes."""
    if value is None or (isinstance(value, str) and _takes_words(spec)):
        return
    if not spec.is_number or isinstance(value, bool) or not isinstance(value, int | float):
        wanted = "a number" if spec.is_number else "a text"
        raise WrongEdit(f"{name}: found '{str(value)[:60]}'; type {wanted}.")


def _takes_words(spec: Field) -> bool:
    return not spec.is_number or bool(spec.choices)


def _edit_workbook(read: WorkbookInput, edits: _Edits, target: Path) -> None:
    workbook = read.workbook
    workbook.allow_saving(ignore_lock=True)
    for named, value in edits.cells:
        sheet, cell = _locations(read, named.place[0]).cell(*named.place)
        if not cell:
            raise WrongEdit(f"{named.name} has no cell in this workbook.")
        _set(workbook, named.name, sheet, cell, value)
    for spec, row in edits.removed:
        there = _locations(read, spec.name)
        # of a row that is shipped with its name, the name stays
        for column in [spec.states] if spec.states else [c.name for c in _columns(read, spec)]:
            sheet, cell = there.cell(spec.name, row, column)
            _set(workbook, f"{spec.name}[{row}]", sheet, cell, None)
    for spec, cells in edits.added:
        _add_row(read, spec, cells)
    workbook.save(target)


def _set(workbook: Workbook, name: str, sheet: str, cell: str, value: Any) -> None:
    try:
        workbook.set_cell(sheet, cell, value, replace_formula=True)
    except CellRefused as wrong:
        raise WrongEdit(f"{name}: {wrong}") from None


def _add_row(read: WorkbookInput, spec: TableSpec, cells: Sequence[tuple[Field, Any]]) -> None:
    """Type a row into a table of a workbook."""
    workbook, columns = read.workbook, _locations(read, spec.name).columns
    if spec.name not in _locations(read, spec.name).tables:
        raise WrongEdit(f"This workbook has no table {spec.name}. Make one of this version of it.")
    table = workbook.table(spec.name)
    for column, _ in cells:
        if (spec.name, column.name) not in columns:
            raise WrongEdit(f"Table {table.name} of this workbook has no column {column.name}.")
    at = [columns[spec.name, column.name] for column, _ in cells]
    row = _free_row(workbook, table, spec, dict(zip(at, cells, strict=True)))
    if row is None:
        row = table.data.bottom + 1
        _grow(workbook, table, at[0])
    for there, (column, value) in zip(at, cells, strict=True):
        _set(workbook, f"{spec.name}.{column.name}", table.sheet, cell_name(row, there), value)


def _free_row(
    workbook: Workbook, table: Table, spec: TableSpec, cells: Mapping[int, tuple[Field, Any]]
) -> int | None:
    """The row of a sheet that takes a new row of a table; None where it has none that is blank."""
    part, data = workbook.sheet_part(table.sheet), table.data
    filled: dict[int, set[int]] = {}
    for row, column in part.filled_cells(data):
        if part.constant(row, column) not in (None, ""):
            filled.setdefault(row, set()).add(column)
    if spec.states:  # a row that is shipped with its name
        states = data.left + table.column_index(spec.states)
        for row, columns in filled.items():
            named = {at: value for at, (_, value) in cells.items() if at in columns}
            if states not in columns and named and all(
                part.constant(row, at) == value for at, value in named.items()
            ):  # fmt: skip
                return row
    last = max(filled, default=data.top - 1)
    return last + 1 if last < data.bottom else None


def _grow(workbook: Workbook, table: Table, column: int) -> None:
    """Give a table one row more."""
    part, data = workbook.sheet_part(table.sheet), table.data
    held = [part.value(row, column) for row in range(data.top, data.bottom + 1)]
    if any(isinstance(value, Formula) for value in held):
        raise WrongEdit(
            f"Table {table.name} is full, and its column {table.columns[column - data.left]} has formulas. Insert a row "
            "in Excel."
        )
    try:
        rows = [[value] for value in (*held, None)]
        workbook.write_table(table.name, rows, columns=[table.columns[column - data.left]])
    except ObstaclesFound as found:
        raise WrongEdit(
            f"Table {table.name} is full. {found.obstacles[0]} Insert a row in Excel."
        ) from None


def _edit_json(read: CaseInput, content: dict[str, Any], edits: _Edits, target: Path) -> None:
    keys = {table.name: table.key for table in EVERY_INPUT}
    typed = _everything_typed(read)
    for named, value in edits.cells:
        table, row, _ = named.place
        holder = content if row is None else content[keys[table]][row - 1]
        entry = typed.entry(named.place)
        if value is None:
            holder.pop(named.spec.key, None)
        elif isinstance(entry, Typed) and named.spec.has_unit and not isinstance(value, str):
            holder[named.spec.key] = (
                f"{value!r} {entry.unit}" if entry.unit != named.spec.si else value
            )
        else:
            holder[named.spec.key] = value
    for spec, row in sorted(edits.removed, key=lambda one: -one[1]):
        del content[spec.key][row - 1]
    for spec, cells in edits.added:
        content.setdefault(spec.key, []).append({field.key: value for field, value in cells})
    write_json(target, content)
