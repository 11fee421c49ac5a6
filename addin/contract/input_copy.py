"""The copy of the inputs that a calculation leaves, and the formulas that compare the present inputs with it.

Hidden sheet `Inputs calculated` has a row of table `InputChecks` for each scalar and each column of an input
table that can change a result, a copy of each table with its numbers in SI, and the worth of each known unit.
The formulas are plain ones of Excel 2010: none is volatile, none an array formula, and an error is a change.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from functools import lru_cache

from addin.contract.field import Field, TableSpec
from addin.contract.input_tables import INPUT_TABLES
from addin.contract.scalars import SCALARS
from addin.contract.units import (
    BASE_IMPEDANCE,
    STATION_SPEED,
    TRANSMITTED_TORQUE,
    UnitScale,
    known_units,
)
from engine.case.data import ADMINISTRATIVE

#: First row of its tables on the sheet, that of the headers.
COPY_ROW = 5
#: Table with a row for each scalar and each column that is compared.
CHECKS = "InputChecks"
CHECK_COLUMNS = ("Input", "Value", "Unit", "Factor", "Factor now", "Changed")
#: Table of the known units and what they are worth.
UNITS = "InputUnits"
UNIT_COLUMNS = ("Quantity", "Unit", "Factor", "Number")
#: Whether any input has changed; without a copy nobody knows, and nothing is claimed.
CHANGED_FORMULA = f"=IFERROR(IF(COUNT({CHECKS}[Changed])=0,1,SUM({CHECKS}[Changed])),1)>0"
#: Name of the first check: the copy belongs to the results.
OF_THE_RESULTS = "run_SHA256"
#: Column of a copy: what a speed typed in % is a share of. [rad/s]
FULL_SPEED = "Full speed"
#: Numbers that differ by no more are equal. [1]
_SAME = "0.000000001"

#: Scalars that can change a result; the title block cannot.
COMPARED_SCALARS: tuple[Field, ...] = tuple(f for f in SCALARS if f.attribute not in ADMINISTRATIVE)


def compared_columns(spec: TableSpec) -> tuple[Field, ...]:
    """Columns of an input table that can change a result; descriptions cannot."""
    return tuple(field for field in spec.columns if field.attribute not in ADMINISTRATIVE)


def copy_name(table: str) -> str:
    """The table with the copy of an input table."""
    return f"Calculated{table}"


def copy_columns(spec: TableSpec) -> tuple[str, ...]:
    """Headers of the copy of an input table."""
    fields = compared_columns(spec)
    names = tuple(field.name for field in fields)
    return (*names, FULL_SPEED) if any(map(may_be_speed, fields)) else names


def may_be_speed(field: Field) -> bool:
    """Whether it is typed as a share of a station's full speed, or as a speed."""
    return field.dimension == "speed fraction"


#: Every table of the sheet with its headers, from left to right.
COPY_TABLES: tuple[tuple[str, tuple[str, ...]], ...] = (
    (CHECKS, CHECK_COLUMNS),
    (UNITS, UNIT_COLUMNS),
    *((copy_name(spec.name), copy_columns(spec)) for spec in INPUT_TABLES),
)


def compared_tables(present: Collection[str]) -> tuple[TableSpec, ...]:
    """Input tables of a workbook of which a copy is kept: an earlier template lacks the later ones."""
    return tuple(spec for spec in INPUT_TABLES if spec.name in present or not spec.later)


def missing_copies(present: Collection[str]) -> list[str]:
    """Tables of the copy that a workbook with these tables ought to have, and has not."""
    names = (CHECKS, UNITS, *(copy_name(spec.name) for spec in compared_tables(present)))
    return [name for name in names if name not in present]


# --- units ----------------------------------------------------------------------------------------


def quantity_of(dimension: str, base: str) -> str:
    """Numbers in units of one quantity can be told to be equal.

    A share of the torque transmitted at a station is no torque in N m before the case is calculated, and
    what is 1 pu in ohm differs from motor to motor.
    """
    bases = {
        TRANSMITTED_TORQUE: "share of the torque transmitted",
        STATION_SPEED: "station speed",
        BASE_IMPEDANCE: "impedance",
    }
    return bases.get(base, dimension)


def _unit_rows() -> Iterator[tuple[str, str, UnitScale]]:
    fields = (*COMPARED_SCALARS, *(f for spec in INPUT_TABLES for f in compared_columns(spec)))
    for dimension in dict.fromkeys(field.dimension for field in fields if field.has_unit):
        known = [
            (quantity_of(dimension, scale.base), unit, scale)
            for unit, scale in known_units(dimension).items()
        ]
        yield from sorted(known, key=lambda row: row[0] != dimension)


#: Rows of table `InputUnits`: quantity, unit and scale; those of a quantity stand together.
UNIT_ROWS: tuple[tuple[str, str, UnitScale], ...] = tuple(_unit_rows())


@lru_cache(maxsize=256)
def unit_rows(*quantities: str) -> tuple[int, int]:
    """First and last row of table `InputUnits` with units of some quantities, counted from 0."""
    rows = [k for k, row in enumerate(UNIT_ROWS) if row[0] in quantities]
    return rows[0], rows[-1]


# --- formulas -------------------------------------------------------------------------------------


# Workbooks of one template have the same formulas.
_kept = lru_cache(maxsize=2048)


@_kept
def factor_now(
    unit: str, stored: str, factor: str, of_quantity: tuple[str, str], known: tuple[str, str]
) -> str:
    """What the present unit is worth: as it was if it is the same, else as a known unit, else 0.

    Parameters
    ----------
    unit, stored : str
        Cells of the present unit and of the one calculated with. [A1]
    factor : str
        Cell of what that was worth. [A1]
    of_quantity : tuple of str
        Columns Unit and Number of table `InputUnits`, in the rows of the same quantity. [A1]
    known : tuple of str
        Columns Unit and Factor of all its rows. [A1]
    """
    # MATCH would take the * of lb*ft^2 for any letters, and = alone mW for MW.
    row = f"SUMPRODUCT(({of_quantity[0]}={unit})*{of_quantity[1]})"
    worth = f"INDEX({known[1]},{row})*EXACT(INDEX({known[0]},{row}),{unit})"
    return f"=IF(EXACT({unit},{stored}),{factor},IF({row}=0,0,{worth}))"


def is_speed(unit: str, stored: str, was_speed: bool, speeds: str) -> str:
    """1 where the present unit is one of speed and not of a share of full speed, else 0."""
    return f"IF(EXACT({unit},{stored}),{int(was_speed)},SUMPRODUCT(1*({speeds}={unit})))"


@_kept
def changed_words(live: str, copy: str, renamed: str = "") -> str:
    """How many cells of a column, or whether a scalar, hold other words; `renamed` as of `changed_numbers`."""
    # EXACT tells capitals apart; where it takes no ranges, what differs otherwise is found still. In ranges it
    # finds no number equal to itself (LibreOffice), and a name may be one.
    count = f'SUMPRODUCT(1*(({live}<>{copy})+1-EXACT({live}&"",{copy}&"")>0))'
    return _unless_resized(live, copy, count, renamed)


def is_renamed(header: str, name: str) -> str:
    """Whether a column has another header: formulas follow the column, the reader of the inputs its header."""
    quoted = name.replace('"', '""')
    return f'NOT(EXACT({header},"{quoted}"))'


def word_in_copy(words: Sequence[str], word: str) -> float:
    """What stands in a copy for a word in the place of a number: no quantity is as large."""
    return (
        words.index(word) + 1
    ) * 123456789012345.0  # all digits: programs write exponents in their own way


@_kept
def changed_numbers(
    live: str,
    copy: str,
    factor: str = "",
    speed: str = "",
    full: str = "",
    renamed: str = "",
    *,
    words: Sequence[str] = (),
) -> str:
    """How many cells of a column, or whether a scalar, hold another quantity.

    Parameters
    ----------
    live, copy : str
        The input, and the same in SI as it was calculated with. [references]
    factor : str
        Cell of what the present unit is worth; empty where there is none. [A1]
    speed, full : str
        `is_speed` of the present unit, and full speeds; empty for other quantities. [expression, A1]
    renamed : str
        `is_renamed` of a column; empty for a scalar. [expression]
    words : sequence of str
        Words that may stand in the place of a number. [words]
    """
    then = f"{copy}*(1+{speed}*({full}-1))" if speed else copy
    then = f"{then}/{factor}" if factor else then
    # Live cells are compared and never multiplied, as a formula there may show "". Of two bounds on
    # one side of a number both are below it or neither; which is the lower one depends on the sign.
    other = f"({live}<>{then})*(({live}>{then}*(1+{_SAME}))=({live}>{then}*(1-{_SAME})))"
    for word in words:
        other += f'*(1-({live}="{word}")*({copy}={word_in_copy(words, word):.0f}))'
    filled = f'({live}<>"")<>({copy}<>"")'
    return _unless_resized(live, copy, f'SUMPRODUCT(({filled})+({copy}<>"")*{other})', renamed)


def _unless_resized(live: str, copy: str, count: str, renamed: str) -> str:
    """A count of changed cells; another number of rows, another header, or an error, is a change."""
    other = f"ROWS({live})<>ROWS({copy})"
    if renamed:
        other = f"OR({other},{renamed})"
    resized = f"IF({other},1,{count})" if "[" in live else count
    return f"=IFERROR({resized},1)"
