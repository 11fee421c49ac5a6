"""Inputs of two cases, matched by name."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

from addin.contract.tables import INPUT_TABLES, SCALAR_TABLE, SCALARS, Field, TableSpec, input_table
from addin.diff.changes import Change, Value
from addin.diff.rows import NAMED, Row, RowComparison, changed
from addin.diff.units import Units
from addin.verify.compare import is_number
from engine.case.data import ADMINISTRATIVE, TABLES, CaseData

#: Share of the stated cells that must be the same for a row under another name to be the same row. [1]
_ALIKE = 0.7
#: Where an element stands: another element in its place has taken it over.
_PLACE = ("Kind", "From", "To")


@dataclass
class Renamed:
    """Names of the first file → names of the second, by kind of name."""

    #: Key ``station``, ``element``, ``material`` or ``excitation``.
    names: dict[str, dict[str, str]] = field(default_factory=dict)

    def now(self, kind: str, name: Any) -> Any:
        """A name of the first file as the second has it."""
        return self.names.get(kind, {}).get(name, name) if isinstance(name, str) else name


def compare_inputs(
    first: CaseData, second: CaseData, units: Units
) -> tuple[list[Change], Renamed, int]:
    """What differs in the inputs.

    Parameters
    ----------
    first, second : CaseData
        The two cases. [SI]
    units : Units
        Units to show.

    Returns
    -------
    changes : list of Change
        In the order of the sheets.
    renamed : Renamed
        Rows that only have another name.
    same : int
        Quantities that are the same. [count]
    """
    renamed = Renamed()
    for name, kind in NAMED.items():
        spec = input_table(name)
        renamed.names[kind] = _renamed(spec, _rows(first, spec), _rows(second, spec), renamed)
    changes, same = [], 0
    for scalar in SCALARS:
        before, after = getattr(first, scalar.attribute), getattr(second, scalar.attribute)
        if _same(before, after):
            same += before is not None
        else:
            changes.append(changed(SCALAR_TABLE, "", scalar, before, after, units))
    for spec in INPUT_TABLES:
        more, count = compare_table(spec, _rows(first, spec), _rows(second, spec), units, renamed)
        changes += more
        same += count
    return changes, renamed, same


def _rows(data: CaseData, spec: TableSpec) -> list[dict[str, Any]]:
    """Rows of a table by header; a share of the torque transmitted is given as text."""
    rows = []
    for row in getattr(data, TABLES[spec.name][0]):
        values = {column.name: getattr(row, column.attribute) for column in spec.columns}
        share = getattr(row, "torque_share", None)
        if share is not None:
            values["Torque"] = f"{100.0 * share:.12g} % of the torque transmitted"
        rows.append(values)
    return rows


def compare_table(
    spec: TableSpec, first: Sequence[Row], second: Sequence[Row], units: Units, renamed: Renamed
) -> tuple[list[Change], int]:
    """What differs in one input table.

    Parameters
    ----------
    spec : TableSpec
        The table.
    first, second : sequence of mapping
        Its rows by header. [SI]
    units : Units
        Units to show.
    renamed : Renamed
        Names of the first file in the second.

    Returns
    -------
    changes : list of Change
        Row by row.
    same : int
        Quantities that are the same. [count]
    """
    translated = [_translated(spec, row, renamed) for row in first]

    def words(field: Field, value: Any) -> str:
        if not is_number(value):
            return str(value)
        unit, factor = units.of_field(spec.name, field)
        return f"{value / factor:.6g} {'' if unit == '1' else unit}".rstrip()

    def name(row: Row) -> str:
        columns = (spec.column(column) for column in spec.row_name)
        stated = ((column, row[column.name]) for column in columns)
        return ", ".join(words(column, value) for column, value in stated if value is not None)

    def same(field: Field, before: Value, after: Value) -> bool:
        return _same(before, after)

    rows = RowComparison(spec, spec.columns, units, same, name, words)
    return rows.compare(first, translated, second)


def _translated(spec: TableSpec, row: Row, renamed: Renamed) -> dict[str, Any]:
    """A row of the first file under the names of the second."""
    kinds = {column.name: column.kind for column in spec.columns}
    if spec.name in NAMED:
        kinds[spec.row_name[0]] = NAMED[spec.name]
    if spec.name == "Meshes":
        kinds["Element"] = "element"
    return {name: renamed.now(kinds[name], value) for name, value in row.items()}


def _renamed(
    spec: TableSpec, first: Sequence[Row], second: Sequence[Row], renamed: Renamed
) -> dict[str, str]:
    """Rows that are in both under different names: alike in most cells, or in the same place."""
    key = spec.row_name[0]
    here, there = {row[key] for row in first}, {row[key] for row in second}
    gone = [_translated(spec, row, renamed) for row in first if row[key] and row[key] not in there]
    new = [row for row in second if row[key] and row[key] not in here]
    scored = [
        (_alike(spec, key, old, added), -abs(i - j), i, j)
        for i, old in enumerate(gone)
        for j, added in enumerate(new)
    ]
    matched: dict[str, str] = {}
    taken: set[int] = set()
    for score, _, i, j in sorted(scored, reverse=True):
        if score >= _ALIKE and gone[i][key] not in matched and j not in taken:
            matched[gone[i][key]] = new[j][key]
            taken.add(j)
    return matched


def _alike(spec: TableSpec, key: str, old: Row, new: Row) -> float:
    """Share of the cells that either row states and both have alike, the name aside."""
    if spec.name == "Elements" and all(old[c] == new[c] for c in _PLACE):
        return 1.0
    stated = [
        column.name
        for column in spec.columns
        if column.name != key
        and column.attribute not in ADMINISTRATIVE
        and (old[column.name] is not None or new[column.name] is not None)
    ]
    if not stated:
        return 0.0
    return sum(_same(old[name], new[name]) for name in stated) / len(stated)


def _same(before: Value, after: Value) -> bool:
    """Equal to the twelve digits that enter the digest."""
    if isinstance(before, int | float) and isinstance(after, int | float):
        return f"{before:.11e}" == f"{after:.11e}"
    return before == after
