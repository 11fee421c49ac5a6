"""The copy of the inputs that a calculation leaves on a hidden sheet, with the formulas that compare.

Everything is written anew by each calculation, so that the copy grows with the tables, and formulas that
lost a column or a cell are whole again.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Any

from addin.contract.field import Field, TableSpec
from addin.contract.input_copy import (
    CHECK_COLUMNS,
    CHECKS,
    COMPARED_SCALARS,
    FULL_SPEED,
    OF_THE_RESULTS,
    UNIT_COLUMNS,
    UNIT_ROWS,
    UNITS,
    changed_numbers,
    changed_words,
    compared_columns,
    compared_tables,
    copy_columns,
    copy_name,
    factor_now,
    is_renamed,
    is_speed,
    may_be_speed,
    missing_copies,
    quantity_of,
    unit_rows,
    word_in_copy,
)
from addin.contract.run_facts import RUN_FACTS
from addin.contract.tables import SCALAR_TABLE
from addin.contract.units import (
    BASE_IMPEDANCE,
    RATED_TORQUE,
    STATION_SPEED,
    SYNCHRONOUS_SPEED,
    UnitError,
    UnitScale,
    parse_unit,
)
from addin.reading.typed_case import Entry, PerUnitBases, Typed
from addin.reading.workbook import WorkbookInput
from addin.xlsx import Formula, Table, TableData
from addin.xlsx.references import Rect, absolute_range, cell_name, parse_cell, quoted_sheet


def input_copy(
    read: WorkbookInput, digest: str, units: Mapping[str, str] | None = None
) -> list[TableData]:
    """The copy of what was read, as tables.

    Parameters
    ----------
    read : WorkbookInput
        The inputs of the workbook as they stand in it. [SI]
    digest : str
        Digest of the inputs that the results carry. [hexadecimal]
    units : mapping of str to str, optional
        Units of the calculation by input, as table `InputChecks` has them; by default those of the
        workbook.

    Returns
    -------
    list of TableData
        None for a workbook of an earlier version, which has no place for them.
    """
    if missing_copies(read.workbook.tables):
        return []
    return list(_Copy(read, digest, units or {}).tables())


@dataclass(frozen=True)
class _Input:
    """A scalar, or a column of an input table, where it is compared."""

    field: Field  #: Its field.
    table: str  #: Its table, or that of the scalars.
    name: str  #: Its name on the sheet.
    live: str  #: It, in a formula. [reference]
    row: int  #: Its row in table `InputChecks`, counted from 1 on the sheet.
    renamed: str = ""  #: Whether its column has another header. [expression]


@dataclass(frozen=True)
class _Copy:
    read: WorkbookInput
    digest: str
    units: Mapping[str, str]

    @cached_property
    def bases(self) -> PerUnitBases:
        """What relative units refer to."""
        data = self.read.data
        return PerUnitBases(
            data.ratings.rated_torque, data.ratings.synchronous_speed, data.speed_ratios
        )

    def tables(self) -> Iterator[TableData]:
        """Checks, units and copies."""
        yield TableData(CHECKS, list(self._checks()), CHECK_COLUMNS)
        rows = [
            [quantity, unit or None, self._worth(scale), number]
            for number, (quantity, unit, scale) in enumerate(UNIT_ROWS, 1)
        ]
        yield TableData(UNITS, rows, UNIT_COLUMNS)
        for spec in compared_tables(self.read.workbook.tables):
            yield TableData(copy_name(spec.name), self._rows(spec), copy_columns(spec))

    # ---- numbers in SI -------------------------------------------------------------------------

    def _worth(self, scale: UnitScale) -> float | None:
        """What a unit is worth in SI; None where what it is a share of is not known."""
        if scale.base == RATED_TORQUE:
            return self.bases.rated_torque and scale.factor * self.bases.rated_torque
        if scale.base == SYNCHRONOUS_SPEED:
            return self.bases.synchronous_speed and scale.factor * self.bases.synchronous_speed
        return scale.factor

    def _rows(self, spec: TableSpec) -> list[list[Any]]:
        """A table as it was calculated with: numbers in SI, words as typed, blanks as blanks."""
        table = self.read.locations.tables[spec.name]
        entries: dict[int, Mapping[str, Entry]] = dict(
            zip(self.read.locations.rows[spec.name], self.read.typed.tables[spec.name], strict=True)
        )
        fields, with_speed = compared_columns(spec), FULL_SPEED in copy_columns(spec)
        rows = []
        for k in range(1, table.data.height + 1):
            typed = entries.get(k, {})
            station = typed.get("Station")
            of = station if isinstance(station, str) else None
            row = [
                self._number(typed.get(field.name), of, field.choices)
                if field.is_number
                else self._words(spec.name, field, table.data.top + k - 1)
                for field in fields
            ]
            rows.append([*row, self._full_speed(of)] if with_speed else row)
        return rows

    def _number(
        self, entry: Entry | None, station: str | None, words: Sequence[str] = ()
    ) -> float | None:
        if isinstance(entry, str) and entry in words:
            return word_in_copy(words, entry)
        if not isinstance(entry, Typed):
            return None
        if entry.scale.base == BASE_IMPEDANCE:
            return entry.scale.to_si(entry.number)
        return self.bases.si(entry, station)

    def _words(self, table: str, field: Field, row: int) -> Any:
        at = self.read.locations.columns.get((table, field.name))
        if at is None:
            return None
        sheet = self.read.locations.tables[table].sheet
        return self.read.workbook.sheet_part(sheet).constant(row, at) or None

    def _full_speed(self, station: str | None) -> float:
        """Speed of a station at synchronism; 1 in rows of no station. [rad/s]"""
        ratio = self.bases.ratios.get(station or "") or 0.0
        return (self.bases.synchronous_speed or 0.0) * ratio or 1.0

    # ---- checks --------------------------------------------------------------------------------

    def _checks(self) -> Iterator[list[Any]]:
        """Rows of table `InputChecks`; an input that the workbook lacks is not compared."""
        row = self.read.workbook.tables[CHECKS].data.top
        same = _formula(changed_words(self._digest_cell(), self._cell("Value", row)))
        yield [OF_THE_RESULTS, self.digest, None, None, None, same]
        row += 1
        for field in COMPARED_SCALARS:
            if field.name in self.read.locations.scalars:
                # By its cell: a study has a table of the name of a scalar, ToleranceStarts.
                live = _reference(*self.read.locations.scalars[field.name])
                yield self._check(_Input(field, SCALAR_TABLE, field.name, live, row))
                row += 1
        for spec in compared_tables(self.read.workbook.tables):
            table = self.read.locations.tables[spec.name]
            for field in compared_columns(spec):
                at = self.read.locations.columns.get((spec.name, field.name))
                if at is not None:
                    live = f"{table.name}[{table.columns[at - table.ref.left]}]"
                    renamed = self._renamed(table, at)
                    yield self._check(_Input(field, spec.name, live, live, row, renamed))
                    row += 1

    def _digest_cell(self) -> str:
        """Where the calculation writes the digest of the results; the name of a workbook that has lost the place."""
        facts = self.read.workbook.tables.get("RunFacts")
        if facts is None:
            return OF_THE_RESULTS
        row = facts.data.top + [name for name, _ in RUN_FACTS].index(OF_THE_RESULTS)
        cell = cell_name(row, facts.ref.left + facts.column_index("Value"))
        return _reference(facts.sheet, cell)

    def _renamed(self, table: Table, column: int) -> str:
        """Whether the header in a column is another; empty where no cell shows it as the table has it."""
        name, head = table.columns[column - table.ref.left], table.header_row
        if (
            head is None
            or self.read.workbook.sheet_part(table.sheet).constant(head, column) != name
        ):
            return ""
        return is_renamed(_reference(table.sheet, cell_name(head, column)), name)

    def _check(self, one: _Input) -> list[Any]:
        """Name, value of a scalar, unit, what it is worth, what the present one is worth, and the check."""
        value: Any = None
        if one.table != SCALAR_TABLE:
            copy = self._cells(copy_name(one.table), one.field.name, one.table)
        else:
            copy = self._cell("Value", one.row)
            if one.field.is_number:
                value = self._number(
                    self.read.typed.scalars.get(one.field.name), None, one.field.choices
                )
            else:
                value = self.read.workbook.shown_value(*self.read.locations.scalars[one.field.name])
        unit_at = self.read.locations.units.get((one.table, one.field.name))
        if one.field.is_number and one.field.has_unit and unit_at is not None:
            return [one.name, value, *self._with_unit(one, copy, unit_at)]
        if one.field.is_number:
            changed = changed_numbers(one.live, copy, renamed=one.renamed)
        else:
            changed = changed_words(one.live, copy, one.renamed)
        return [one.name, value, None, None, None, _formula(changed)]

    def _with_unit(self, one: _Input, copy: str, unit_at: tuple[str, str]) -> Sequence[Any]:
        sheet, cell = unit_at
        at = _reference(sheet, cell)
        unit = self.read.workbook.shown_value(sheet, cell)
        text = f"{unit:.15g}" if isinstance(unit, float) else str(unit or "")
        text = self.units.get(one.name, text)
        try:
            scale = parse_unit(text, one.field.dimension)
        except UnitError:  # above a column without numbers
            scale = UnitScale(1.0)
        quantities = [quantity_of(one.field.dimension, scale.base)]
        stored, factor, now = (
            self._cell(column, one.row) for column in ("Unit", "Factor", "Factor now")
        )
        speed = full = ""
        if may_be_speed(one.field):
            quantities = [one.field.dimension, quantity_of("", STATION_SPEED)]
            speeds = self._units("Unit", *unit_rows(*quantities[1:]))
            speed = is_speed(at, stored, scale.base == STATION_SPEED, speeds)
            full = self._cells(copy_name(one.table), FULL_SPEED, one.table)
        rows = unit_rows(*quantities)
        of_quantity = self._units("Unit", *rows), self._units("Number", *rows)
        known = self._units("Unit"), self._units("Factor")
        return [
            text or None,
            self._worth(scale),
            _formula(factor_now(at, stored, factor, of_quantity, known)),
            _formula(
                changed_numbers(
                    one.live, copy, now, speed, full, one.renamed, words=one.field.choices
                )
            ),
        ]

    # ---- cells of the sheet --------------------------------------------------------------------

    def _cell(self, column: str, row: int) -> str:
        """A cell of table `InputChecks`."""
        at = self._column(CHECKS, column)
        return _range(row, at, row, at)

    def _units(self, column: str, first: int = 0, last: int = len(UNIT_ROWS) - 1) -> str:
        """Cells of table `InputUnits`, of all rows or of some."""
        top, at = self.read.workbook.tables[UNITS].data.top, self._column(UNITS, column)
        return _range(top + first, at, top + last, at)

    def _cells(self, copy: str, column: str, table: str) -> str:
        """A column of a copy, with as many rows as the table has."""
        top, at = self.read.workbook.tables[copy].data.top, self._column(copy, column)
        rows = self.read.locations.tables[table].data.height
        return _range(top, at, top + rows - 1, at)

    def _column(self, table: str, name: str) -> int:
        held = self.read.workbook.tables[table]
        return held.ref.left + held.column_index(name)


# Workbooks of one template have the same cells and formulas.
_kept = lru_cache(maxsize=4096)
_formula = _kept(Formula)


@_kept
def _range(top: int, left: int, bottom: int, right: int) -> str:
    return absolute_range(Rect(top, left, bottom, right))


@_kept
def _reference(sheet: str, cell: str) -> str:
    """A cell as a formula of another sheet names it."""
    return f"{quoted_sheet(sheet)}!{absolute_range(Rect(*parse_cell(cell), *parse_cell(cell)))}"
