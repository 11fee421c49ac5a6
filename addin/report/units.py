"""Units of one document, and its inputs as they were typed.

A workbook is shown in its own units. A case JSON is shown in those it is typed in; its plain
numbers, which are in SI, in the usual units of its system.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass
from itertools import chain

from addin.contract.problems import shortened
from addin.contract.shown_units import ShownUnits, shown_units, template_units
from addin.contract.tables import EVERY_TABLE, Field
from addin.contract.units import parse_unit
from addin.reading.typed_case import CaseInput, Entry, Typed
from addin.reading.workbook import WorkbookInput
from addin.report.numbers import clean, pretty_unit, typed
from addin.writing.workbook import read_shown_units

#: Digits of an input that was converted to another unit: as good as the factor of its unit.
_CONVERTED_DIGITS = 7
#: Longest text of a cell. [characters]
_LONGEST = 1000


@dataclass(frozen=True)
class DocumentUnits:
    """What a document is shown in."""

    units: ShownUnits  #: Units of the columns. [units]
    system: str  #: ``US`` or ``SI``; it chooses the paper.
    is_workbook: bool  #: Whether numbers stand in the units they are typed in.
    notes: tuple[str, ...]  #: Units that cannot be used.

    def value(self, number: float, table: str, column: str) -> float:
        """An SI number in the unit of a column. [shown unit]"""
        return number / self.units.factor(table, column)

    @property
    def paper(self) -> str:
        """Letter for US customary units, else A4. [word]"""
        return "us-letter" if self.system == "US" else "a4"

    def unit(self, table: str, column: str) -> str:
        """The unit of a result column as printed.

        Parameters
        ----------
        table, column : str
            Result table and header. [names]

        Returns
        -------
        str
            The unit; empty where there is none. [unit]
        """
        return pretty_unit(self.units.name(table, column))


def document_units(read: CaseInput) -> DocumentUnits:
    """Units of a document about an input."""
    rated = read.data.ratings.rated_torque
    if isinstance(read, WorkbookInput):
        stated, problems = read_shown_units(read.workbook, rated)
        system = _system(stated.names.values())
        usual = template_units(system, EVERY_TABLE)
        # a cell above a column without a unit holds other words
        names = usual | {k: v for k, v in stated.names.items() if v and k in usual}
        units, _ = shown_units(names, rated)
        return DocumentUnits(units, system, True, tuple(problems))
    rows = (row for table in read.typed.tables.values() for row in table)
    entries = chain.from_iterable(row.values() for row in (read.typed.scalars, *rows))
    system = _system(entry.unit for entry in entries if isinstance(entry, Typed))
    units, _ = shown_units(template_units(system, EVERY_TABLE), rated)
    return DocumentUnits(units, system, False, ())


def entry_text(entry: Entry | None, field: Field, shown: DocumentUnits) -> tuple[str, str]:
    """An input as typed, and its unit.

    Parameters
    ----------
    entry : Entry or None
        What was typed; None for a blank. [entry]
    field : Field
        Its column or scalar.
    shown : DocumentUnits
        The units of the document.

    Returns
    -------
    tuple of str
        Number or words, and the unit as printed; both empty for a blank. [text, unit]
    """
    if entry is None:
        return "", ""
    if isinstance(entry, str):
        return shortened(clean(entry), _LONGEST), ""
    number, unit, digits = entry.number, entry.unit, 10
    usual = field.unit_us if shown.system == "US" else field.unit_si
    is_plain_si = entry.scale.factor == 1.0 and not entry.scale.base
    if not shown.is_workbook and is_plain_si and usual and usual != unit:
        scale = parse_unit(usual, field.dimension)
        if not scale.base:
            number, unit, digits = scale.from_si(number), usual, _CONVERTED_DIGITS
    return typed(number, digits), pretty_unit(unit)


def _system(units: Iterable[str]) -> str:
    """US where most units that tell the systems apart are US customary."""
    us: Counter[bool] = Counter()
    for unit in units:
        parts = {part.split("^")[0] for part in unit.replace("/", "*").split("*")}
        if parts & {"lb", "psi", "ksi", "Mpsi", "in", "ft", "hp", "lbf", "kip"}:
            us[True] += 1
        elif parts & {"kg", "N", "kN", "Pa", "MPa", "GPa", "mm", "m", "kW", "MW", "W"}:
            us[False] += 1
    return "US" if us[True] > us[False] else "SI"
