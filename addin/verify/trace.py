"""What a result is, by which equation, and the cells and values it comes from."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from addin.contract.tables import (
    RESULT_TABLES,
    SCALAR_TABLE,
    WORKBOOK_TABLES,
    Field,
    TableSpec,
    find_column,
    scalar,
)
from addin.reading.one_file import Unreadable, read_checked
from addin.reading.workbook import WorkbookInput
from addin.recorded.match_rows import row_columns
from addin.xlsx import ErrorValue, Table, Workbook
from addin.xlsx.references import cell_name, parse_cell, split_sheet

_RESULTS = {spec.name: spec for spec in (*RESULT_TABLES, *WORKBOOK_TABLES)}
_TABLE_AND_COLUMN = re.compile(r"(\w+)(?:[.\[]\s*(.+?)\s*\]?)?")
#: Values listed of a column; of more the range and their number. [count]
_LISTED = 3


def traced(source: Path, wanted: str) -> Iterator[str]:
    """A result traced to its inputs, in lines.

    Raises
    ------
    ValueError
        When there is no such result; the sentence says what there is.
    """
    read = read_checked(source)
    if isinstance(read, Unreadable):
        raise ValueError(read.problems[0].message)
    if not isinstance(read, WorkbookInput):
        raise ValueError(f"{source.name} has no cells; trace a workbook, or see docs/results.md.")
    if "!" in wanted:
        yield from _cell(_Traced(read), wanted)
        return
    match = _TABLE_AND_COLUMN.fullmatch(wanted.strip())
    specs = {name.casefold(): spec for name, spec in _RESULTS.items()}
    spec = specs.get(match[1].casefold()) if match else None
    if not match or spec is None:
        raise ValueError(f"'{wanted}' is not a result table. Choose one of {', '.join(_RESULTS)}.")
    columns = [f for f in spec.every_column if not match[2] or _is(f, match[2], spec)]
    if not columns:
        names = ", ".join(f.name for f in spec.every_column)
        raise ValueError(f"table {spec.name} has no column '{match[2]}'; it has {names}.")
    for field in columns:
        yield f"{spec.name}[{field.name}]"
        yield from _definition(field)
        yield from _Traced(read).inputs(field, {})


def _is(field: Field, name: str, spec: TableSpec) -> bool:
    if field is spec.repeated:
        return re.fullmatch(rf"{re.escape(field.name)}( \d+)?", name, re.IGNORECASE) is not None
    return field.name.casefold() == name.casefold()


def _cell(traced_workbook: _Traced, wanted: str) -> Iterator[str]:
    """One cell of a result table."""
    try:
        sheet, cell = split_sheet(wanted.strip())
        row, column = parse_cell(cell.replace("$", "").upper())
    except ValueError:
        raise ValueError(
            f"'{wanted}' is not a cell address; write it as 'Steady state!H9'."
        ) from None
    workbook = traced_workbook.workbook
    for spec in _RESULTS.values():
        table = workbook.tables.get(spec.name)
        if table is None or table.sheet.casefold() != sheet.casefold():
            continue
        if not table.data.has(row, column):
            continue
        header = table.columns[column - table.ref.left]
        fields = {field.name.casefold(): field for field in spec.workbook_columns}
        field = fields.get(header.casefold())
        if field is None:
            raise ValueError(
                f"{wanted} is in column {header} of table {spec.name}, which you added and "
                "torsionbook does not calculate."
            )
        context = traced_workbook.row_of(table, spec, row)
        name = ", ".join(str(context[c]) for c in spec.row_name if c in context)
        shown = traced_workbook.shown(table, column, row)
        yield f"{table.sheet}!{cell_name(row, column)} = {shown}: {spec.name}[{field.name}], row {name}"
        yield from _definition(field)
        yield from traced_workbook.inputs(field, context)
        return
    raise ValueError(f"{wanted} is outside the result tables: {_places(workbook)}.")


def _places(workbook: Workbook) -> str:
    found = (workbook.tables.get(name) for name in _RESULTS)
    return ", ".join(f"{t.name} ({t.sheet}!{t.data})" for t in found if t is not None)


def _definition(field: Field) -> Iterator[str]:
    assert field.trace is not None
    yield f"  what      {field.help}"
    yield f"  equation  {field.trace.equation}"
    yield f"  source    {field.trace.source}"


@dataclass(frozen=True)
class _Traced:
    """A workbook in which inputs are looked up."""

    read: WorkbookInput  #: Its inputs and where they stand.

    @property
    def workbook(self) -> Workbook:
        """The open workbook."""
        return self.read.workbook

    def row_of(self, table: Table, spec: TableSpec, row: int) -> dict[str, Any]:
        """What a result row is about, by header; of its element the material too."""
        context = {}
        for field in spec.columns:
            at = table.columns_at.get(field.name.casefold())
            value = self._value(table, at, row) if at else None
            if value is not None and not isinstance(value, ErrorValue):
                context[field.name] = f"{value:g}" if isinstance(value, float) else value
        for element in self.read.data.elements:
            if element.element == context.get("Element") and element.material:
                context["Material"] = element.material
        if "Applied at" in context:
            context["Station"] = context["Applied at"]
        return context

    def inputs(self, field: Field, context: Mapping[str, Any]) -> Iterator[str]:
        """Inputs of a result with their places and values; those of the row picked out."""
        assert field.trace is not None
        for words, names, known in (
            ("of the row", field.trace.of_row, context),
            ("of the case", field.trace.of_case, {}),
        ):
            lines = [line for name in names for line in self._lines(name, known)]
            if lines:
                yield f"  {words}:"
                yield from (f"    {line}" for line in lines)

    def _lines(self, name: str, context: Mapping[str, Any]) -> Iterator[str]:
        table_name, _, column = name.rpartition(".")
        if not table_name:
            yield self._scalar(scalar(name))
            return
        table = self.workbook.tables.get(table_name)
        if table is None or column not in table.columns:
            yield f"{name}: not in this workbook"
            return
        at = table.ref.left + table.column_index(column)
        rows = self._rows(table_name, table, context)
        held = [row for row in rows if self._value(table, at, row) is not None]
        if not held:
            field = find_column(table_name, column)
            blank = field.default_text if field is not None else ""
            yield f"{name}: blank{f', which means: {blank}' if blank else ''}"
        elif len(held) <= _LISTED:
            for row in held:
                yield f"{name} = {self.shown(table, at, row)}  ({table.sheet}!{cell_name(row, at)})"
        else:
            first, last = cell_name(held[0], at), cell_name(held[-1], at)
            yield f"{name}: {len(held)} values  ({table.sheet}!{first}:{last})"

    def _scalar(self, field: Field) -> str:
        sheet, cell = self.read.locations.scalars.get(field.name, ("", ""))
        value = self.workbook.shown_value(sheet, cell) if cell else None
        if value is None or value == "":
            blank = f", which means: {field.default_text}" if field.default_text else ""
            return f"{field.name}: blank{blank}  ({sheet}!{cell})"
        unit_at = self.read.locations.units.get((SCALAR_TABLE, field.name))
        unit = self.workbook.shown_value(*unit_at) if unit_at and field.has_unit else ""
        shown = f"{value:,.10g}" if isinstance(value, float) else value
        return f"{field.name} = {shown} {unit or ''}".rstrip() + f"  ({sheet}!{cell})"

    def _rows(self, name: str, table: Table, context: Mapping[str, Any]) -> list[int]:
        """Rows of a table that the context names; all of them where it names none."""
        rows = range(table.data.top, table.data.bottom + 1)
        keys = [c for c in row_columns(name) if c in context and c in table.columns]
        if name == "Excitations":
            keys = ["Name"] if "Excitation" in context else []
        if name in _RESULTS and not keys:
            ours = ("Element", "Mode", "Effect", "Plan")
            keys = [c for c in ours if c in context and c in table.columns]
        if not keys:
            return list(rows) if not context or name not in _RESULTS else []
        wanted = {k: context["Excitation"] if k == "Name" else context[k] for k in keys}
        places = {k: table.ref.left + table.column_index(k) for k in keys}
        return [
            row
            for row in rows
            if all(_words(self._value(table, places[k], row)) == _words(wanted[k]) for k in keys)
        ]

    def _value(self, table: Table, column: int, row: int) -> Any:
        value = self.workbook.shown_value(table.sheet, cell_name(row, column))
        return None if value == "" else value

    def shown(self, table: Table, column: int, row: int) -> str:
        """A cell's value with the unit above its column."""
        value = self._value(table, column, row)
        if value is None:
            return "blank"
        if isinstance(value, ErrorValue):
            return value.code
        unit: Any = None
        field = find_column(table.name, table.columns[column - table.ref.left])
        if field is not None and field.has_unit:
            unit = self.workbook.shown_value(table.sheet, cell_name(table.ref.top - 1, column))
        number = f"{value:,.10g}" if isinstance(value, float) else str(value)
        return f"{number} {'' if unit == '1' else unit or ''}".rstrip()


def _words(value: Any) -> str:
    return f"{value:g}" if isinstance(value, float) else str(value)
