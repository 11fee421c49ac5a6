"""Trains as an engineer types them, into which a test types one mistake at a time.

`plain` and `geared` are the modified design and the one with backlash of the examples, US customary;
`shafts` is a 6 MW, 50 Hz compressor train in SI whose shafts are typed by their geometry.
"""

from __future__ import annotations

import csv
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from addin.contract.tables import input_table
from addin.template.examples import EXAMPLES, Example, example_case
from engine.case.data import CaseData

Row = dict[str, float | int | str]
#: Listed before any rule was written, and after all of them.
MISTAKES = Path(__file__).with_name("mistakes.tsv")
AFTERWARDS = Path(__file__).with_name("mistakes_afterwards.tsv")


def _rows(headers: str, *rows: tuple[float | str | None, ...]) -> list[Row]:
    names = headers.split("; ")
    return [
        {name: value for name, value in zip(names, row, strict=False) if value is not None}
        for row in rows
    ]


_SPEED = (0, 10, 20, 30, 40, 50, 60, 70, 80, 85, 90, 95, 98, 100)
_AVERAGE = (60, 61, 62, 65, 68, 72, 78, 86, 95, 99, 100, 85, 55, 0)
_PULSATING = (40, 40, 39, 38, 36, 34, 31, 28, 25, 23, 22, 21, 20, 20)
_LOAD = (400, 150, 170, 260, 430, 660, 940, 1270, 1640, 1850, 2060, 2290, 2430, 2530)

SHAFTS = Example(
    scalars={
        "LineFrequency": 50,
        "Poles": 4,
        "RatedPower": 6000,
        "DampingRatio": 1.5,
        "StartsRequired": 1000,
    },
    units={},
    tables={
        "Stations": _rows(
            "Station; Inertia; Speed ratio; Running load",
            ("Motor", 320),
            ("Motor hub", 9),
            ("Gear hub", 9),
            ("Bull gear", 120),
            ("Pinion", 0.9, 4),
            ("Pinion hub", 0.25, 4),
            ("Compressor hub", 0.25, 4),
            ("Compressor", 16, 4, 9200),
        ),
        "Elements": _rows(
            "Element; Kind; From; To; Stiffness; OD; Length; Shear modulus; Density; Loss factor; "
            "Stress diameter; SCF; Material; Rated torque; Peak torque limit; Vibratory limit; "
            "Reversal limit",
            ("Motor shaft", "shaft", "Motor", "Motor hub", None, 230, 900, 80, None, None, 220, 2,
             "34CrNiMo6"),
            ("LS coupling", "coupling", "Motor hub", "Gear hub", 15e6, None, None, None, None, None,
             None, None, None, 60e3, 180e3, 15e3),
            ("Gear shaft", "shaft", "Gear hub", "Bull gear", None, 220, 700, 80, None, None, 210, 2,
             "34CrNiMo6"),
            ("Mesh", "gear mesh", "Bull gear", "Pinion", None, None, None, None, None, None, None,
             None, None, 55e3, 150e3, 12e3, 30e3),
            ("Pinion shaft", "shaft", "Pinion", "Pinion hub", None, 125, 600, 80, None, None, 120, 2,
             "34CrNiMo6"),
            ("HS coupling", "coupling", "Pinion hub", "Compressor hub", 1.5e6, None, None, None, None,
             0.02, None, None, None, 16e3, 48e3, 4e3),
            ("Compressor shaft", "shaft", "Compressor hub", "Compressor", None, 130, 1100, 80, 7850,
             None, 120, 2, "34CrNiMo6"),
        ),
        "Meshes": _rows(
            "Element; Pitch radius drive; Pitch radius driven; Pressure angle; Helix angle",
            ("Mesh", 480, 120, 20, 12),
        ),
        "ModeDamping": _rows("Mode; Damping ratio", (1, 2)),
        "MotorTorque": _rows(
            "Station; Speed; Average; Pulsating",
            *(("Motor", *x) for x in zip(_SPEED, _AVERAGE, _PULSATING, strict=True)),
        ),
        "LoadTorque": _rows(
            "Station; Speed; Torque",
            *(("Compressor", *x) for x in zip(_SPEED, _LOAD, strict=True)),
        ),
        "Materials": _rows(
            "Material; UTS; Yield; Endurance; Basis", ("34CrNiMo6", 1000, 800, 480, "bending")
        ),
        "SNPoints": _rows(
            "Material; Cycles; Stress", ("34CrNiMo6", 1000, 880), ("34CrNiMo6", 1000000, 480)
        ),
        "Excitations": _rows(
            "Name; Order; Of station; Frequency; Station; Torque",
            ("Motor 1x", 1, "Motor", None, None, 1),
            ("Motor 2x", 2, "Motor", None, None, 1),
            ("Compressor 1x", 1, "Compressor", None, None, 1),
            ("Line", None, None, 50, "Motor", 1),
            ("Twice line", None, None, 100, "Motor", 1),
        ),
    },
)  # fmt: skip

#: Train: what is typed, and the unit system of its workbook.
SENSIBLE: Mapping[str, tuple[Example, str]] = {
    "plain": (EXAMPLES["modified"], "us"),
    "geared": (EXAMPLES["backlash"], "us"),
    "shafts": (SHAFTS, "si"),
}


@dataclass(frozen=True)
class Mistake:
    """One line of the list."""

    case: str  #: Of `SENSIBLE`.
    table: str  #: Input table, or ``Case`` for a scalar.
    row: str  #: Values of the first column, or ``*``.
    column: str  #: Columns, or the scalar.
    edit: str  #: ``= value``, ``* factor``, ``/ factor``, ``swap``, ``reverse``, ``copy``, ``delete``.
    says: tuple[str, ...]  #: A sentence that names the cause or the cell contains one of these.
    mistake: str  #: What the engineer did.

    def typed(self) -> CaseData:
        """The train with the mistake in it."""
        example, system = SENSIBLE[self.case]
        if self.table == "Case":
            scalars = dict(example.scalars)
            scalars[self.column] = _edited(self.edit, scalars.get(self.column))
            return example_case(replace(example, scalars=scalars), system)
        rows = [dict(row) for row in example.tables[self.table]]
        changed = {**example.tables, self.table: self._rows(rows)}
        return example_case(replace(example, tables=changed), system)

    def _rows(self, rows: list[Row]) -> list[Row]:
        name, columns = input_table(self.table).columns[0].name, self.column.split("; ")
        chosen = [row for row in rows if self.row == "*" or str(row[name]) in self.row.split("; ")]
        assert chosen, self
        if self.edit == "delete":
            return [row for row in rows if row not in chosen]
        if self.edit == "copy":
            return [*rows, *chosen]
        if self.edit == "reverse":
            for column in columns:
                values = [row[column] for row in chosen]
                for row, value in zip(chosen, reversed(values), strict=True):
                    row[column] = value
        elif self.edit == "swap":
            a, b = columns
            for row in chosen:
                row[a], row[b] = row[b], row[a]
        else:
            for row in chosen:
                for column in columns:
                    if self.row != "*" or column in row:
                        row[column] = _edited(self.edit, row.get(column))
        return rows


def _edited(edit: str, value: float | int | str | None) -> float | str:
    operation, _, typed = edit.partition(" ")
    if operation == "=":
        try:
            return float(typed)
        except ValueError:
            return typed
    assert isinstance(value, float | int), edit
    return value * float(typed) if operation == "*" else value / float(typed)


def mistakes(path: Path = MISTAKES) -> Iterator[Mistake]:
    """A list, in its order."""
    with path.open(encoding="utf-8", newline="") as file:
        for row in csv.DictReader(file, delimiter="\t"):
            says = tuple(row["says"].split("; "))
            yield Mistake(**{**row, "says": says})
