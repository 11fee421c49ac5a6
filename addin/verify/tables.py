"""The rows of a result table as recorded against the rows that would be written."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from addin.contract.problems import shortened
from addin.contract.tables import find_column, find_table
from addin.recorded.match_rows import match_rows, row_columns, row_name
from addin.recorded.provenance import is_own_of_each_run
from addin.verify.allowances import Allowances
from addin.verify.compare import (
    RecordedValue,
    agreement,
    is_number,
    is_rounding,
    plain_value,
    value_in_words,
)
from addin.verify.findings import Agreement, Counts, Finding, Verification
from addin.xlsx import ErrorValue

#: Share of the numbers of a family that must be reproduced for the others to be called edited. [1]
_REPRODUCED = 0.9


@dataclass(frozen=True)
class TablePair:
    """A recorded table beside the same table as it would be written."""

    name: str  #: Result table.
    sheet: str  #: Its sheet; empty in a JSON file.
    columns: tuple[str, ...]  #: Its headers.
    #: Values by header; a blank is None or absent. [shown units]
    expected: Sequence[Mapping[str, Any]]
    recorded: Sequence[Mapping[str, RecordedValue]]  #: What stands in each row. [shown units]


@dataclass(frozen=True)
class Compared:
    """One result that is not equal to the bit."""

    table: str  #: Where.
    sheet: str  #: Likewise.
    row: str  #: Likewise.
    column: str  #: Likewise.
    found: RecordedValue  #: What stands there. [shown unit]
    expected: Any  #: What would be written. [shown unit]
    agreement: Agreement  #: How well they agree.
    scale: float = 0.0  #: Largest number of the column. [shown unit]

    @property
    def is_rounding(self) -> bool:
        """Whether they differ by rounding at most."""
        return is_rounding(self.found.value, self.expected, self.scale)

    @property
    def is_number(self) -> bool:
        """Whether both are numbers."""
        return is_number(self.found.value) and is_number(self.expected)


def compare_tables(
    tables: Iterable[TablePair],
    allowances: Allowances,
    about: Verification,
    *,
    known_version: bool = True,
    unit_of: Callable[[str, str], str] = lambda table, column: "",
) -> tuple[list[Counts], list[Finding]]:
    """Compare all tables, and tell what was edited from what merely differs.

    Parameters
    ----------
    tables : iterable of TablePair
        Tables.
    allowances : Allowances
        Reported errors.
    about : Verification
        What made the file, from which inputs, and what is accepted.
    known_version : bool
        Whether a version made the file that there ever was; else its words are held to those of
        this one, to the letter. [flag]
    unit_of : callable
        Unit shown above a column, by table and header. [unit]

    Returns
    -------
    counts : list of Counts
        One a table.
    findings : list of Finding
        Everything that is not as it would be written and matters.
    """
    counts: list[Counts] = []
    findings: list[Finding] = []
    compared: list[Compared] = []
    numbers = {True: 0, False: 0}
    same_words = about.same_version or not known_version
    sizes: dict[tuple[str, str], int] = {}
    for table in tables:
        count = Counts(table.name, table.sheet)
        counts.append(count)
        scales = {}
        for column in table.columns:
            values = (row.get(column) for row in table.expected)
            sizes_of_column = [abs(v) for v in values if isinstance(v, int | float)]
            sizes[table.name, column] = sum(map(bool, sizes_of_column))
            scales[column] = max(sizes_of_column, default=0.0)
        for i, j in _paired(table):
            if i is None or j is None:
                findings += _one_sided(table, i, j, same_words)
                continue
            cells = _compare_row(table, i, j, allowances, count, known_version)
            compared += (replace(cell, scale=scales[cell.column]) for cell in cells)
        numbers[_of_the_start(table.name)] += sum(count.of)
    others = Counter(_of_the_start(c.table) for c in compared if not c.is_rounding)
    reproduced = {
        family: bool(count) and 1.0 - others[family] / count >= _REPRODUCED
        for family, count in numbers.items()
    }
    columns = _in_other_units(compared, sizes, unit_of)
    findings += columns.values()
    for cell in compared:
        if (cell.table, cell.column) in columns:
            continue
        sure = reproduced[_of_the_start(cell.table)] and about.same_version and about.same_inputs
        finding = _finding(cell, about.within, sure, same_words)
        if finding is not None:
            findings.append(finding)
    return counts, findings


def _of_the_start(table: str) -> bool:
    """Whether a table's numbers come from the run in time; the others from linear algebra alone.

    A number of either family differs by chance only if its whole family does.
    """
    spec = find_table(table)
    return spec is not None and spec.of_the_start


def _worded(table: str, column: str = "") -> bool:
    """Whether another version may word a table or one of its columns otherwise."""
    spec, field = find_table(table), find_column(table, column)
    return (spec is not None and spec.worded) or (field is not None and field.kind == "sentence")


def _paired(table: TablePair) -> list[tuple[int | None, int | None]]:
    """Rows matched by name; those whose very name was changed are matched by their order."""
    if not row_columns(table.name):
        return match_rows(range(len(table.expected)), range(len(table.recorded)))
    pairs = match_rows(
        [row_name(table.name, row) for row in table.expected],
        [row_name(table.name, _values(row)) for row in table.recorded],
    )
    missing = [i for i, j in pairs if i is not None and j is None]
    added = [j for i, j in pairs if i is None and j is not None]
    if missing and len(missing) == len(added):
        renamed = dict(zip(missing, added, strict=True))
        return [(i, renamed.get(i, j) if i is not None else j) for i, j in pairs if i is not None]
    return pairs


def _values(row: Mapping[str, RecordedValue]) -> dict[str, Any]:
    return {header: recorded.value for header, recorded in row.items()}


def _name(table: TablePair, row: Mapping[str, Any]) -> str:
    shown = (row.get(column) for column in row_columns(table.name))
    return ", ".join(f"{v:.6g}" if isinstance(v, float) else str(v) for v in shown if v is not None)


def _one_sided(
    table: TablePair, i: int | None, j: int | None, same_words: bool
) -> Iterable[Finding]:
    kind, place = "row missing", ""
    if i is not None:
        name = _name(table, table.expected[i])
        sentence = f"the row {name} is missing"
    else:
        assert j is not None
        row = table.recorded[j]
        kind, place = "row added", next((s.place for s in row.values() if s.place), "")
        name = _name(table, _values(row))
        sentence = f"the row {name or 'without a name'} does not result from the inputs"
    if table.name != "Audit" or not is_own_of_each_run(name):
        fails = same_words or not _worded(table.name)
        yield Finding(kind, table.sheet, place, sentence, table.name, name, fails=fails)


def _compare_row(
    table: TablePair,
    i: int,
    j: int,
    allowances: Allowances,
    counts: Counts,
    known_version: bool,
) -> Iterable[Compared]:
    """Cells of one row that are not equal to the bit; all are counted."""
    row, recorded = table.expected[i], table.recorded[j]
    name = _name(table, row)
    for column in table.columns:
        found = recorded.get(column)
        if found is None:
            continue
        field, in_audit = find_column(table.name, column), table.name == "Audit"
        own_value = in_audit and column == "Value" and is_own_of_each_run(name)
        if own_value or (field is not None and field.wall_time):
            counts.not_compared += 1
            continue
        wanted = row.get(column)
        allowed = allowances.of_value(table.name, column, row)
        if isinstance(wanted, str) and not known_version:
            allowed = None
        how = agreement(found, wanted, allowed)
        if found.formula:
            how = Agreement.DIFFERENT
        if wanted is not None or how is not Agreement.BITS:
            counts.of[how] += 1
        if how is not Agreement.BITS:
            yield Compared(table.name, table.sheet, name, column, found, wanted, how)


def _finding(cell: Compared, within: Agreement, sure: bool, same_words: bool) -> Finding | None:
    """What is said of a result that is not as it would be written; None if nothing."""
    found, wanted = cell.found.value, cell.expected
    shown, follows = value_in_words(found), value_in_words(wanted)
    kind, fails = "edited", True
    if cell.found.formula:
        sentence = f"the formula ={shortened(cell.found.formula)} replaces a result"
    elif isinstance(wanted, int | float) and isinstance(found, str | ErrorValue):
        sentence = f"the text '{shown}' replaces the number {follows}"
    elif sure and not cell.is_rounding:
        sentence = f"{shown} is in the file, torsionbook wrote {follows}"
    elif cell.agreement <= within:
        return None
    else:
        kind, sentence = "different", f"{shown} is recorded, recalculation gives {follows}"
        if not same_words and not cell.is_number and _worded(cell.table, cell.column):
            fails, sentence = False, f"{sentence}, in the wording of this version"
    return Finding(
        kind, cell.sheet, cell.found.place, sentence, cell.table, cell.row, cell.column,
        plain_value(found), plain_value(wanted), fails,
    )  # fmt: skip


def _in_other_units(
    compared: Sequence[Compared],
    sizes: Mapping[tuple[str, str], int],
    unit_of: Callable[[str, str], str],
) -> dict[tuple[str, str], Finding]:
    """Columns whose numbers all differ by one factor: a unit was retyped after the calculation."""
    by_column: dict[tuple[str, str], list[Compared]] = {}
    for cell in compared:
        if cell.is_number and cell.agreement is Agreement.DIFFERENT and cell.expected:
            by_column.setdefault((cell.table, cell.column), []).append(cell)
    findings = {}
    for (table, column), cells in by_column.items():
        unit = unit_of(table, column)
        ratios = [c.found.value / c.expected for c in cells]  # type: ignore[operator]
        is_one_factor = all(math.isclose(ratio, ratios[0], rel_tol=1e-9) for ratio in ratios)
        different_numbers = len({c.expected for c in cells}) > 1
        whole = len(cells) == sizes[table, column]
        if not (unit and whole and different_numbers and is_one_factor):
            continue
        first = cells[0]
        findings[table, column] = Finding(
            "different", first.sheet, first.found.place,
            f"all {len(cells)} numbers of the column are {ratios[0]:.6g} times the recalculated "
            f"values in the unit shown, {unit}: the unit was changed after the calculation. "
            "Recalculate.",
            table, "", column, plain_value(first.found.value),
            plain_value(first.expected),
        )  # fmt: skip
    return findings
