"""What a result is, by which equation, and the cells and values it comes from."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from addin.contract.sources import DAMPING, MODAL, START
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
from addin.recorded.results import recorded_fact
from addin.xlsx import ErrorValue, Table, Workbook
from addin.xlsx.references import cell_name, parse_cell, split_sheet

_RESULTS = {spec.name: spec for spec in (*RESULT_TABLES, *WORKBOOK_TABLES)}
_TABLE_AND_COLUMN = re.compile(r"(\w+)(?:[.\[]\s*(.+?)\s*\]?)?")
#: Values listed of a column; of more the range and their number. [count]
_LISTED = 3
#: Tables of which a row belongs to one element, station, material or mode.
_OF_ONE = frozenset(
    {
        "Stations",
        "Elements",
        "Meshes",
        "ModeDamping",
        "MotorData",
        "MotorCircuit",
        "Materials",
        "SNPoints",
        "EffectChoices",
    }
)
#: What every torque and frequency of the train depends on, row by row.
_OF_THE_TRAIN = frozenset((*START, *MODAL, *DAMPING))
#: Tables from which a check takes its result, by the words with which it begins.
_TABLES_OF_CHECKS = {
    "Separation margin": ("SeparationMargins",),
    "Steady-state stress": ("SteadyState",),
    "Vibratory torque": ("SteadyState", "Elements"),
    "Start": ("StartupPeaks",),
    "Peak torque": ("StartupPeaks", "Elements"),
    "Shear yield": ("StartupPeaks", "Elements", "Materials"),
    "Torque reversal": ("TorqueReversals", "Elements"),
    "Allowable starts": ("AllowableStarts",),
}


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
        raise ValueError(f"'{wanted}' is not a cell address; write it as 'Results!AW9'.") from None
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
        yield from traced_workbook.inputs_of_cell(field, spec, context)
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
        if spec.name == "StartCycles":
            context["Element"] = recorded_fact(self.workbook, "run_GoverningShaft") or ""
        names = [one.element for one in self.read.data.elements if one.element]
        for header in ("Governing element", "Of"):
            if context.get(header) in names:
                context.setdefault("Element", context[header])
            elif header in context:
                context.setdefault("Station", context[header])
        if spec.judges:
            context |= self._of_verdict(str(context.get("Where", "")), names)
        for element in self.read.data.elements:
            if element.element == context.get("Element") and element.material:
                context["Material"] = element.material
        if "Applied at" in context:
            context["Station"] = context["Applied at"]
        return context

    def _of_verdict(self, where: str, elements: list[str]) -> dict[str, Any]:
        """Element, mode and excitation that a verdict names as its place."""
        found: dict[str, Any] = {}
        named = [one for one in elements if one and where.startswith(one)]
        if named:
            found["Element"] = max(named, key=len)
        mode = re.match(r"mode (\d+)", where)
        if mode is not None:
            found["Mode"] = mode[1]
        margins = self.workbook.tables.get("SeparationMargins")
        at = None if margins is None else margins.columns_at.get("excitation")
        if margins is not None and at is not None:
            rows = range(margins.data.top, margins.data.bottom + 1)
            names = {str(self._value(margins, at, row) or "") for row in rows} - {""}
            inside = [name for name in names if name in where]
            found |= {"Excitation": max(inside, key=len)} if inside else {}
        return found

    def inputs_of_cell(
        self, field: Field, spec: TableSpec, context: Mapping[str, Any]
    ) -> Iterator[str]:
        """Inputs of one cell: its row's own, the case's, and the tables of which every row counts."""
        assert field.trace is not None
        of_row, of_case = list(field.trace.of_row), list(field.trace.of_case)
        if spec.judges:
            check = str(context.get("Check", ""))
            wanted = next(
                (t for words, t in _TABLES_OF_CHECKS.items() if check.startswith(words)), None
            )
            if wanted is not None:
                of_case = [n for n in of_case if "." not in n or n.partition(".")[0] in wanted]
        own, whole = [], []
        for name in (name for name in of_case if "." in name):
            table = name.rpartition(".")[0]
            picked = self._picked(table, context)
            if picked is not None and (table in _OF_ONE or table in _RESULTS):
                own.append(name)
            if (
                picked is None
                or name in _OF_THE_TRAIN
                and table in ("Stations", "Elements", "Meshes")
            ):
                whole.append(name)
        lines = [line for name in of_row for line in self._lines(name, context)]
        for name in (name for name in own if name not in of_row):
            lines += self._held(name, context) if name in whole else self._lines(name, context)
        if lines:
            yield "  of the row:"
            yield from (f"    {line}" for line in lines)
        scalars = [line for name in of_case if "." not in name for line in self._lines(name, {})]
        if scalars:
            yield "  of the case:"
            yield from (f"    {line}" for line in scalars)
        if whole:
            yield "  of whole tables, of which every row counts for this number:"
            yield from (f"    {line}" for line in self._whole(whole))

    def _picked(self, name: str, context: Mapping[str, Any]) -> list[int] | None:
        """Rows of a table that belong to a row of results; None where every row does."""
        table = self.workbook.tables.get(name)
        if table is None:
            return None
        if name == "Stations" and "Element" in context and "Station" not in context:
            ends = next(
                ((e.from_, e.to) for e in self.read.data.elements if e.element == context["Element"]),
                (),
            )  # fmt: skip
            return [row for end in ends if end for row in self._rows(name, table, {"Station": end})]
        keys = [c for c in row_columns(name) if c in context and c in table.columns]
        if name in _RESULTS and not keys:
            keys = [c for c in ("Element", "Mode") if c in context and c in table.columns]
        return self._rows(name, table, {key: context[key] for key in keys}) if keys else None

    def _held(self, name: str, context: Mapping[str, Any]) -> Iterator[str]:
        """What the row's own rows of an input or result table hold; blanks are left out."""
        table_name, _, column = name.rpartition(".")
        table = self.workbook.tables.get(table_name)
        if table is None or column not in table.columns:
            return
        at = table.ref.left + table.column_index(column)
        for row in self._picked(table_name, context) or ():
            if self._value(table, at, row) is not None:
                yield f"{name} = {self.shown(table, at, row)}  ({table.sheet}!{cell_name(row, at)})"

    def _whole(self, names: list[str]) -> Iterator[str]:
        """Tables of which every row counts, with the columns that are filled."""
        tables: dict[str, list[str]] = {}
        for name in names:
            table_name, _, column = name.rpartition(".")
            tables.setdefault(table_name, []).append(column)
        for table_name, columns in tables.items():
            table = self.workbook.tables.get(table_name)
            if table is None:
                continue
            places, filled = [], []
            for column in (column for column in columns if column in table.columns):
                at = table.ref.left + table.column_index(column)
                rows = [
                    r
                    for r in self._rows(table_name, table, {})
                    if self._value(table, at, r) is not None
                ]
                if rows:
                    filled.append(column)
                    places += [(rows[0], at), (rows[-1], at)]
            if not places:
                yield f"{table_name}: blank"
                continue
            (top, bottom), (left, right) = ((min(x), max(x)) for x in zip(*places, strict=True))
            count = "1 row" if top == bottom else f"{bottom - top + 1} rows"
            area = f"{cell_name(top, left)}:{cell_name(bottom, right)}"
            yield f"{table_name}, {count}: {', '.join(filled)}  ({table.sheet}!{area})"

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
