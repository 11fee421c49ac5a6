"""Input and result tables as they fit a page.

A wide table comes in parts with the same first column, or turned on its side; columns without
any entry are left out. What was left out stands in the note below.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from addin.contract.shown_cell import shown_cell
from addin.contract.tables import Field, TableSpec, table
from addin.reading.typed_case import Entry
from addin.report.document import Column, Table
from addin.report.layout import folded
from addin.report.numbers import clean, of_dimension, pretty_unit
from addin.report.units import DocumentUnits, entry_text

Rows = Sequence[Mapping[str, Any]]

#: Most rows of a long table (pairs of mode and excitation, couplings) shown in full.
FULL = 40
#: A margin below this is the rounding of a frequency on the line. [1]
_NOTHING = 1e-7


def input_table(
    name: str,
    rows: Sequence[Mapping[str, Entry]],
    shown: DocumentUnits,
    caption: str,
    columns: Sequence[str] = (),
) -> Table | None:
    """An input table as typed.

    Parameters
    ----------
    name : str
        Input table. [name]
    rows : sequence of mapping
        Its rows as typed. [entries]
    shown : DocumentUnits
        The units of the document.
    caption : str
        Caption. [text]
    columns : sequence of str
        Columns shown beside the first one, without rows that state none of them; by default all,
        and every row. [headers]

    Returns
    -------
    Table or None
        None for a table that states nothing.
    """
    first, *others = table(name).columns
    chosen = [first, *(field for field in others if not columns or field.name in columns)]
    heads, texts = [], []
    for field in chosen:
        cells = [entry_text(row.get(field.name), field, shown) for row in rows]
        # one unit a column where all its numbers share it, else a unit in each cell
        units = {unit for text, unit in cells if text}
        common = units.pop() if len(units) == 1 else ""
        heads.append(_column(field, common))
        texts.append([text if common else f"{text} {unit}".strip() for text, unit in cells])
    lines = tuple(zip(*texts, strict=True))
    stated = tuple(line for line in lines if any(line[1:]))
    if not stated:
        return None
    return without_blanks(Table(caption, tuple(heads), stated if columns else lines))


def _column(field: Field, unit: str) -> Column:
    kind = "number" if field.is_number else "text"
    if field.name == "Percent speed":
        unit = f"{unit} of sync."
    if field.name == "Verdict":
        kind = "verdict"
    elif field.is_sentence:
        kind = "sentence"
    return Column(field.header, unit, kind)


def result_table(
    name: str,
    rows: Rows,
    shown: DocumentUnits,
    caption: str = "",
    columns: Sequence[str] = (),
    note: str = "",
) -> Table:
    """A result table in the units shown.

    Parameters
    ----------
    name : str
        Result table. [name]
    rows : sequence of mapping
        Its rows by JSON key. [SI]
    shown : DocumentUnits
        The units of the document.
    caption : str
        Caption; by default that of the contract. [text]
    columns : sequence of str
        Columns shown, in their order; by default all of the contract. [headers]
    note : str
        Small print. [text]

    Returns
    -------
    Table
        Without columns that hold nothing.
    """
    spec = table(name)
    fields = {field.name: field for field in _fields(spec, rows)}
    chosen = [fields[column] for column in columns or fields]
    heads = tuple(_column(f, shown.unit(name, _base(spec, f))) for f in chosen)
    body = tuple(tuple(_cell(spec, f, row, shown) for f in chosen) for row in rows)
    return without_blanks(Table(caption or spec.caption, heads, body, note))


def standing_table(
    name: str,
    rows: Rows,
    shown: DocumentUnits,
    caption: str,
    columns: Sequence[str],
    note: str = "",
) -> Table:
    """Rows of a result table as recorded in a workbook, words in place of numbers as they are.

    Parameters
    ----------
    name : str
        Result table. [name]
    rows : sequence of mapping
        Its rows by header. [SI]
    shown : DocumentUnits
        The units of the document.
    caption : str
        Caption. [text]
    columns : sequence of str
        Columns shown, in their order. [headers]
    note : str
        Small print. [text]

    Returns
    -------
    Table
        Without columns that hold nothing.
    """
    spec = table(name)
    chosen = [spec.column(column) for column in columns]
    heads = tuple(_column(f, shown.unit(name, f.name)) for f in chosen)
    body = tuple(
        tuple(_standing_cell(spec, f, row.get(f.name), shown) for f in chosen) for row in rows
    )
    return without_blanks(Table(caption, heads, body, note))


def _standing_cell(spec: TableSpec, field: Field, value: Any, shown: DocumentUnits) -> str:
    if value is None or value is False:
        return ""
    if value is True:
        return "yes"
    if isinstance(value, str):
        return _with_unit(clean(value))
    unit = shown.units.name(spec.name, field.name)
    factor = shown.units.factor(spec.name, field.name) if field.is_number else 1.0
    number = int(value) if field.kind == "integer" else value / factor
    if field.dimension == "fraction" and abs(value) < _NOTHING:
        return "0"
    if field.dimension == "count" and number == round(number):
        return f"{number:,.0f}"
    return of_dimension(number, field.name, field.dimension, unit)


def _fields(spec: TableSpec, rows: Rows) -> list[Field]:
    """Columns of the contract, and as many repeated ones as the rows have."""
    if spec.repeated is None:
        return list(spec.columns)
    head = spec.repeated.key
    count = max((sum(1 for key in row if key.startswith(f"{head}_")) for row in rows), default=0)
    return [*spec.columns, *(spec.repeated_column(k) for k in range(1, count + 1))]


def _base(spec: TableSpec, field: Field) -> str:
    """Header whose unit a column has: of Mode 3 that of Mode."""
    if spec.repeated is not None and field not in spec.columns:
        return spec.repeated.name
    return field.name


def _cell(spec: TableSpec, field: Field, row: Mapping[str, Any], shown: DocumentUnits) -> str:
    value = shown_cell(spec, field, row, shown.units)
    if value is None:
        return ""
    if isinstance(value, str):
        return _with_unit(clean(value))
    unit = shown.units.name(spec.name, _base(spec, field))
    return of_dimension(value, field.name, field.dimension, unit)


def _with_unit(text: str) -> str:
    """Words; the unit at the end of a judged number (``1.30 kN*m``) as printed."""
    number, _, unit = text.partition(" ")
    if unit and " " not in unit and number.lstrip("-").replace(",", "").replace(".", "").isdigit():
        sign = "−" if number.startswith("-") else ""
        return f"{sign}{number.lstrip('-')} {pretty_unit(unit)}".rstrip()
    return text


def without_blanks(table: Table) -> Table:
    """A table without the columns that hold nothing; the first column stays."""
    keep = [k for k in range(len(table.columns)) if k == 0 or any(row[k] for row in table.rows)]
    return replace(
        table,
        columns=tuple(table.columns[k] for k in keep),
        rows=tuple(tuple(row[k] for k in keep) for row in table.rows),
    )


def left_out(shown: int, total: int, what: str, why: str) -> str:
    """What a table does not show."""
    if shown == total:
        return ""
    rest = "the complete list is kept with the calculation"
    return f"{shown} of {total} {what} are shown, {why}; {rest}."


def with_column(
    table: Table, beside: str, column: Column, cells: Sequence[str], *, before: bool = False
) -> Table:
    """A table with one column more behind or before another; without that as it is."""
    headers = [column.header for column in table.columns]
    if beside not in headers:
        return table
    at = headers.index(beside) + (not before)
    return replace(
        table,
        columns=(*table.columns[:at], column, *table.columns[at:]),
        rows=tuple(
            (*row[:at], cell, *row[at:]) for row, cell in zip(table.rows, cells, strict=True)
        ),
    )


def turned(table: Table, together: int = 4, without: Sequence[str] = ()) -> list[Table]:
    """A table with many columns and few rows, turned: a line a quantity, a column an item; in halves where it is narrow."""
    tables = []
    for start in range(0, len(table.rows), together):
        items = table.rows[start : start + together]
        # numbers of one kind stand in a column of their own here: right-aligned all the same
        heads = (
            Column("Quantity"),
            Column("Unit"),
            *(Column(row[0], "", "number") for row in items),
        )
        lines = tuple(
            (column.header, column.unit, *(row[k] for row in items))
            for k, column in enumerate(table.columns)
            if k and column.header not in without
        )
        tables += folded(replace(table, columns=heads, rows=lines))
    return tables
