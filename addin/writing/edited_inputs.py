"""Inputs of a file as they are typed, and the same file with some of them typed anew."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from addin.contract.field import Field
from addin.contract.tables import INPUT_TABLES, SCALAR_TABLE, SCALARS, TableSpec
from addin.reading.input_names import NamedInput, WrongName, named_input
from addin.reading.typed_case import CaseInput, Entry, Typed
from addin.reading.workbook import WorkbookInput
from addin.xlsx.errors import CellRefused
from addin.xlsx.whole_files import write_json

#: The scalar that is no input of the engineer's.
_VERSION = "TemplateVersion"


class WrongEdit(Exception):
    """An edit that cannot be made; the sentence says why."""


def typed_inputs(read: CaseInput) -> dict[str, Any]:
    """Everything typed in an input.

    Parameters
    ----------
    read : CaseInput
        A workbook or a case JSON.

    Returns
    -------
    dict
        ``scalars``, those that are blank among them, and ``tables`` with the columns and rows that have entries. [typed units]
    """
    units = _BlankUnits(read)
    scalars = [
        _described(spec)
        | _cell(read.typed.scalars.get(spec.name), spec, units.of(SCALAR_TABLE, spec))
        for spec in SCALARS
        if spec.name != _VERSION
    ]
    tables = [
        _table(spec, rows, units)
        for spec in INPUT_TABLES
        if (rows := read.typed.tables.get(spec.name))
    ]
    return {"scalars": scalars, "tables": tables}


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
        if not isinstance(read, WorkbookInput) or place not in read.locations.units:
            return ""
        return str(read.workbook.shown_value(*read.locations.units[place]) or "").strip()


def _cell(entry: Entry | None, spec: Field, of_blank: str) -> dict[str, Any]:
    if isinstance(entry, Typed):
        return {"value": entry.number, "unit": entry.unit if spec.has_unit else ""}
    return {"value": entry, "unit": of_blank}


def _table(
    table: TableSpec, rows: Sequence[Mapping[str, Entry]], units: _BlankUnits
) -> dict[str, Any]:
    """A table with a name for each row, as `named_input` takes it."""
    columns = [column for column in table.columns if any(column.name in row for row in rows)]
    first = table.columns[0].name
    words = [str(row.get(first, "")) for row in rows]
    by_name = len(set(words)) == len(words) and "" not in words
    return {
        "name": table.name,
        "columns": [_described(column) for column in columns],
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


def edit_inputs(read: CaseInput, source: Path, changes: Mapping[str, Any], target: Path) -> None:
    """Write the same file with other values in some of its inputs; results in it stay as they are.

    A number stands in the unit that its cell has; a formula in the cell is replaced.

    Parameters
    ----------
    read : CaseInput
        What was read from the file.
    source : Path
        The file. [path]
    changes : mapping
        Number, word or None = blank, by the name of the input: ``DampingRatio``,
        ``Elements[LS coupling].Stiffness``. [typed units]
    target : Path
        The file to write. [path]

    Raises
    ------
    WrongEdit
        If a name leads nowhere or a value cannot stand there.
    """
    edits = [(_named(name, read), value) for name, value in changes.items()]
    for named, value in edits:
        if value is None or (isinstance(value, str) and _takes_words(named.spec)):
            continue
        if (
            not named.spec.is_number
            or isinstance(value, bool)
            or not isinstance(value, int | float)
        ):
            wanted = "a number" if named.spec.is_number else "a text"
            raise WrongEdit(f"{named.name}: found '{str(value)[:60]}'; type {wanted}.")
    if isinstance(read, WorkbookInput):
        _edit_workbook(read, edits, target)
    else:
        _edit_json(read, json.loads(source.read_text(encoding="utf-8-sig")), edits, target)


def _takes_words(spec: Field) -> bool:
    return not spec.is_number or bool(spec.choices)


def _named(name: str, read: CaseInput) -> NamedInput:
    try:
        return named_input(name, read.typed)
    except WrongName as wrong:
        raise WrongEdit(f"'{name[:80]}': {wrong} Nothing was changed.") from None


def _edit_workbook(
    read: WorkbookInput, edits: Sequence[tuple[NamedInput, Any]], target: Path
) -> None:
    read.workbook.allow_saving(ignore_lock=True)
    for named, value in edits:
        sheet, cell = read.locations.cell(*named.place)
        if not cell:
            raise WrongEdit(f"{named.name} has no cell in this workbook.")
        try:
            read.workbook.set_cell(sheet, cell, value, replace_formula=True)
        except CellRefused as wrong:
            raise WrongEdit(f"{named.name}: {wrong}") from None
    read.workbook.save(target)


def _edit_json(
    read: CaseInput, content: dict[str, Any], edits: Sequence[tuple[NamedInput, Any]], target: Path
) -> None:
    keys = {table.name: table.key for table in INPUT_TABLES}
    for named, value in edits:
        table, row, _ = named.place
        holder = content if row is None else content[keys[table]][row - 1]
        entry = read.typed.entry(named.place)
        if value is None:
            holder.pop(named.spec.key, None)
        elif isinstance(entry, Typed) and named.spec.has_unit and not isinstance(value, str):
            holder[named.spec.key] = (
                f"{value!r} {entry.unit}" if entry.unit != named.spec.si else value
            )
        else:
            holder[named.spec.key] = value
    write_json(target, content)
