"""Units that stand beside key numbers."""

from __future__ import annotations

import re
from collections.abc import Iterator

from addin.contract.problems import shortened
from addin.contract.sheets import CYCLE_FACTS, KEY_NUMBERS
from addin.verify.findings import Finding
from addin.verify.formulas import own_formulas
from addin.xlsx import Formula, Workbook
from addin.xlsx.references import Rect, cell_name

#: By the label of the number: a unit, or the column whose unit it has.
_UNITS = {number.label: number.unit for number in (*KEY_NUMBERS, *CYCLE_FACTS)}


def compare_units(workbook: Workbook, same_version: bool) -> Iterator[Finding]:
    """Units beside key numbers that are not those the numbers are in.

    Parameters
    ----------
    workbook : Workbook
        The workbook as it was saved.
    same_version : bool
        Whether this version wrote the file; another one may have written them otherwise. [flag]

    Yields
    ------
    Finding
        One a cell. A live formula of ours that shows an old unit is reported with the formulas.
    """
    for own in own_formulas(workbook):
        unit = _UNITS.get(own.what, "")
        source, expected = _of_column(workbook, unit) if "[" in unit else ("", unit)
        if not expected:
            continue
        part = workbook.sheet_part(own.sheet)
        beside = next(
            part.filled_cells(Rect(own.row, own.column + 1, own.row, own.column + 3)), None
        )
        beside = beside or (own.row, own.column + 1)
        shown, held = part.constant(*beside), part.value(*beside)
        if isinstance(held, Formula) and (shown is None or _reads(held.text, source)):
            continue
        if isinstance(shown, str) and shown.strip() == expected:
            continue
        unit = str(shown or "")
        yield Finding(
            "edited", own.sheet, cell_name(*beside),
            f"{own.what}: the unit shown is '{shortened(unit, 30)}', but the number is in "
            f"{expected}",
            found=unit, expected=expected, fails=same_version,
        )  # fmt: skip


def _reads(formula: str, cell: str) -> bool:
    """Whether a formula takes the unit from its cell."""
    return bool(cell) and re.search(rf"(?<!\w){cell}(?!\w)", formula.replace("$", "")) is not None


def _of_column(workbook: Workbook, name: str) -> tuple[str, str]:
    """The cell above a column and the unit in it; blank where there is none."""
    table_name, column = name.rstrip("]").split("[")
    table = workbook.tables.get(table_name)
    at = None if table is None else table.columns_at.get(column.casefold())
    if table is None or at is None or not table.header_row or table.header_row < 2:
        return "", ""
    cell = cell_name(table.header_row - 1, at)
    shown = workbook.shown_value(table.sheet, cell)
    return cell, shown.strip() if isinstance(shown, str) else ""
