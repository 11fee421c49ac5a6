"""A small workbook with every input table and scalar, laid out at odd places on purpose.

Only the rules of the contract hold here: defined names with the unit to their right, Excel tables
with the units right above their headers.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import xlsxwriter

from addin.contract.tables import INPUT_TABLES, SCALARS


@dataclass(frozen=True)
class Calculated:
    """A formula with the value Excel last saw."""

    formula: str
    value: Any


@dataclass(frozen=True)
class Formatted:
    """A number with a number format."""

    number: float
    code: str


SCALAR_VALUES: dict[str, Any] = {
    "TemplateVersion": "1",
    "Title": "Small train",
    "LineFrequency": 60,
    "SynchronousSpeed": 1800,
    "RatedTorque": 1000,
    "DampingRatio": 1.5,
}

TABLE_ROWS: dict[str, list[dict[str, Any]]] = {
    "Stations": [
        {"Station": "Motor", "Inertia": 1000},
        {"Station": "Load", "Inertia": 500},
    ],
    "Elements": [
        {
            "Element": "Coupling",
            "Kind": "coupling",
            "From": "Motor",
            "To": "Load",
            "Stiffness": 1e6,
        },
    ],
    "MotorTorque": [
        {"Station": "Motor", "Speed": 0, "Average": 55, "Pulsating": 16},
        {"Station": "Motor", "Speed": 50, "Average": 66, "Pulsating": 15},
        {"Station": "Motor", "Speed": 100, "Average": 0, "Pulsating": 12},
    ],
    "LoadTorque": [
        {"Station": "Load", "Speed": 0, "Torque": 60},
        {"Station": "Load", "Speed": 100, "Torque": 250},
    ],
    "Materials": [{"Material": "steel", "UTS": 110000, "Yield": 80000, "Endurance": 19000}],
    "SNPoints": [
        {"Material": "steel", "Cycles": 1e3, "Stress": 49500},
        {"Material": "steel", "Cycles": 1e6, "Stress": 19000},
    ],
}


@dataclass
class SmallWorkbook:
    """What stands in the workbook; change it, then `save`.

    Attributes
    ----------
    scalars : dict
        Values by defined name.
    rows : dict
        Rows by table, each by column; None leaves a blank row.
    units : dict
        Units by scalar name or (table, column), instead of those of the US template.
    headers : dict
        (table, column) → another header; None leaves the column out.
    without : set
        Names of scalars and tables left out.
    merged : list
        (table, first row, last row, column): cells to merge.
    hidden : list
        (table, row): rows to hide.
    below : dict
        Table → text right below it.
    """

    scalars: dict[str, Any] = field(default_factory=lambda: dict(SCALAR_VALUES))
    rows: dict[str, list[dict[str, Any] | None]] = field(
        default_factory=lambda: {name: [dict(r) for r in rows] for name, rows in TABLE_ROWS.items()}
    )
    units: dict[Any, Any] = field(default_factory=dict)
    headers: dict[tuple[str, str], str | None] = field(default_factory=dict)
    without: set[str] = field(default_factory=set)
    merged: list[tuple[str, int, int, str]] = field(default_factory=list)
    hidden: list[tuple[str, int]] = field(default_factory=list)
    below: dict[str, str] = field(default_factory=dict)
    places: dict[tuple[str, int, str], str] = field(default_factory=dict)

    def save(self, path: Path) -> Path:
        """Write the workbook."""
        self.book = xlsxwriter.Workbook(str(path))
        self.sheets = {
            name: self.book.add_worksheet(name)
            for name in dict.fromkeys(["Case", *(table.sheet for table in INPUT_TABLES)])
        }
        self._write_scalars()
        next_row = dict.fromkeys(self.sheets, 60)
        for table in INPUT_TABLES:
            if table.name not in self.without:
                next_row[table.sheet] += self._write_table(table, next_row[table.sheet])
        self.book.close()
        return path

    def _write_scalars(self) -> None:
        sheet = self.sheets["Case"]
        for i, spec in enumerate(SCALARS):
            row = 3 + i
            sheet.write_string(row, 2, spec.name)
            if spec.name in self.without:
                continue
            self._write(sheet, row, 4, self.scalars.get(spec.name))
            self._write(sheet, row, 5, self.units.get(spec.name, spec.unit_us))
            self.book.define_name(spec.name, f"=Case!$E${row + 1}")

    def _write_table(self, table: Any, top: int) -> int:
        sheet = self.sheets[table.sheet]
        columns = [
            c for c in table.columns if self.headers.get((table.name, c.name), "") is not None
        ]
        rows = self.rows.get(table.name, [])
        height = max(len(rows), 1) + 2
        for j, column in enumerate(columns, start=1):
            self._write(sheet, top, j, self.units.get((table.name, column.name), column.unit_us))
            for i, row in enumerate(rows, start=1):
                self.places[table.name, i, column.name] = xlsxwriter.utility.xl_rowcol_to_cell(
                    top + 1 + i, j
                )
                self._write(sheet, top + 1 + i, j, (row or {}).get(column.name))
        headers = [{"header": self.headers.get((table.name, c.name)) or c.name} for c in columns]
        sheet.add_table(
            top + 1, 1, top + 1 + height, len(columns), {"name": table.name, "columns": headers}
        )
        self._decorate(table, sheet, top, height, columns)
        return height + 10

    def _decorate(self, table: Any, sheet: Any, top: int, height: int, columns: Sequence) -> None:
        names = [column.name for column in columns]
        sheet.table_cells.clear()  # XlsxWriter refuses what Excel users manage to do
        for name, first, last, column in self.merged:
            if name == table.name:
                j = names.index(column) + 1
                value = self.rows[name][first - 1][column]  # type: ignore[index]
                sheet.merge_range(top + 1 + first, j, top + 1 + last, j, value)
        for name, row in self.hidden:
            if name == table.name:
                sheet.set_row(top + 1 + row, None, None, {"hidden": True})
        if table.name in self.below:
            sheet.write_string(top + 2 + height, 1, self.below[table.name])

    def _write(self, sheet: Any, row: int, column: int, value: Any) -> None:
        if isinstance(value, Calculated):
            sheet.write_formula(row, column, value.formula, None, value.value)
        elif isinstance(value, Formatted):
            style = self.book.add_format({"num_format": value.code})
            sheet.write_number(row, column, value.number, style)
        elif isinstance(value, str):
            sheet.write_string(row, column, value)
        elif isinstance(value, bool):
            sheet.write_boolean(row, column, value)
        elif value is not None:
            sheet.write_number(row, column, value)


Change = Callable[[SmallWorkbook], Mapping[str, Any] | None]
