"""The copy of the inputs on its hidden sheet: whether it is of the inputs that the results belong to."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

from addin.contract.input_copy import CHECKS, missing_copies
from addin.reading.workbook import WorkbookInput
from addin.verify.compare import RecordedValue, agreement, plain_value, value_in_words
from addin.verify.findings import Agreement, Finding
from addin.verify.formulas import COMPARISON, OwnFormula, replaced
from addin.writing.input_copy import input_copy
from addin.xlsx import Formula, TableData, Workbook
from addin.xlsx.references import cell_name

#: Kind of a finding of which several are reported as one.
_REWORDED = "reworded"


def compare_input_copy(
    read: WorkbookInput, digest: str, *, same_version: bool = True
) -> Iterator[Finding]:
    """What stands in the copy against what a calculation of the inputs in the file would write.

    Parameters
    ----------
    read : WorkbookInput
        Inputs with the digest that the results have. [SI]
    digest : str
        It. [hexadecimal]
    same_version : bool
        Whether this version wrote the copy; another one may have worded its formulas otherwise. [flag]

    Yields
    ------
    Finding
        Cells that were edited fail; formulas worded otherwise are one finding, a note of another version.
    """
    workbook = read.workbook
    reworded = []
    for data in input_copy(read, digest, _units(workbook)):
        for finding in _compared(workbook, data):
            if finding.kind == _REWORDED:
                reworded.append(finding)
            else:
                yield finding
    if reworded:
        first, more = reworded[0], len(reworded) - 1
        also = f"; so are {more} more on this sheet" if more else ""
        sentence = f"{first.sentence}{also}: it may show something else after an edit"
        yield Finding("edited", first.sheet, first.cell, sentence, first.table, fails=same_version)


def without_copy(workbook: Workbook) -> Iterator[Finding]:
    """A note where the banners have nothing to compare the inputs with, as in templates of 0.1.0."""
    missing = missing_copies(workbook.tables)
    if missing:
        sentence = (
            f"the workbook has no copy of its inputs (table {missing[0]} is missing), so its banners do not show "
            "that inputs were changed. Make a workbook that has one: torsionbook new NEW.xlsx --from FILE"
        )
        yield Finding("not compared", "", "", sentence, fails=False)


def _of_formula(finding: Finding) -> Finding:
    """A formula that still reads cells and is worded otherwise is reported together with others of its kind."""
    return finding if finding.fails else replace(finding, kind=_REWORDED)


def _units(workbook: Workbook) -> dict[str, str]:
    """Units of the calculation: they may have been exchanged since, together with their values."""
    table = workbook.tables.get(CHECKS)
    if table is None:
        return {}
    part = workbook.sheet_part(table.sheet)
    inputs, units = (table.ref.left + table.column_index(name) for name in ("Input", "Unit"))
    rows = range(table.data.top, table.data.bottom + 1)
    shown = {str(part.constant(row, inputs)): part.constant(row, units) for row in rows}
    return {
        name: f"{unit:.15g}" if isinstance(unit, float) else str(unit or "")
        for name, unit in shown.items()
    }


def _compared(workbook: Workbook, data: TableData) -> Iterator[Finding]:
    table = workbook.tables[data.name]
    if table.data.height != len(data.rows):
        sentence = (
            f"the copy of the inputs has {table.data.height} rows instead of {len(data.rows)}: "
            "it was edited"
        )
        yield Finding("edited", table.sheet, str(table.data), sentence, data.name)
        return
    for column, values in zip(data.columns or (), zip(*data.rows, strict=True), strict=True):
        at = table.columns_at.get(column.casefold())
        for row, expected in enumerate(values, table.data.top):
            if at is None:
                break
            yield from _cell(workbook, data.name, column, (row, at), expected)


def _cell(
    workbook: Workbook, table: str, column: str, at: tuple[int, int], expected: Any
) -> Iterator[Finding]:
    sheet = workbook.tables[table].sheet
    if isinstance(expected, Formula):
        own = OwnFormula(sheet, *at, expected.text, COMPARISON, table, column)
        if not own.stands(workbook):
            yield _of_formula(replaced(workbook, own, same_version=False))
        return
    stands = workbook.sheet_part(sheet).constant(*at)
    if agreement(RecordedValue(stands, cell_name(*at)), expected) > Agreement.DIGITS:
        sentence = (
            f"the copy of the inputs has {value_in_words(stands)}, but the results were calculated "
            f"with {value_in_words(expected)}: it was edited"
        )
        yield Finding(
            "edited", sheet, cell_name(*at), sentence, table, "", column, plain_value(stands),
            plain_value(expected),
        )  # fmt: skip
