"""Results of two files, matched by element, mode and excitation."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any

from addin.contract.audit_items import DIGEST_ITEM
from addin.contract.shown_cell import VERDICT_UNITS
from addin.contract.tables import Field, TableSpec, result_table
from addin.contract.units import USUAL
from addin.diff.changes import Change, Value, VerdictChange
from addin.diff.files import COMPARED, RoundedNumber
from addin.diff.inputs import Renamed
from addin.diff.rows import RowComparison
from addin.diff.units import Units
from addin.recorded.match_rows import match_rows, row_name
from addin.recorded.provenance import is_own_of_each_run
from addin.verify.compare import is_number
from engine.fatigue.damage import starts_in_words

#: Relative size of what rounding, other units and other processors change. [1]
_ROUNDING = 1e-9
#: Columns that say nothing of the train: wall times.
_LEFT_OUT = frozenset({("Effects", "Time")})
Tables = Mapping[str, Sequence[Mapping[str, Any]]]


def compare_results(
    first: Tables, second: Tables, units: Units, renamed: Renamed
) -> tuple[list[Change], int]:
    """What differs in the results.

    Parameters
    ----------
    first, second : mapping of str to rows
        Results by table and header. [SI]
    units : Units
        Units to show.
    renamed : Renamed
        Names of the first file in the second.

    Returns
    -------
    changes : list of Change
        By table, in the order of the workbook; `Verdicts` is compared by `compare_verdicts`.
    same : int
        Quantities that are the same. [count]
    """
    changes, same = [], 0
    for spec in COMPARED:
        if spec.judges:
            continue
        more, count = compare_rows(
            spec, first.get(spec.name, ()), second.get(spec.name, ()), units, renamed
        )
        changes += more
        same += count
    return changes, same


def compare_rows(
    spec: TableSpec,
    first: Sequence[Mapping[str, Any]],
    second: Sequence[Mapping[str, Any]],
    units: Units,
    renamed: Renamed,
) -> tuple[list[Change], int]:
    """What differs in one result table.

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
    fields = [f for f in spec.written_columns if (spec.name, f.name) not in _LEFT_OUT]
    old = [_translated(fields, row, renamed) for row in first if _counts(spec, row)]
    new = [row for row in second if _counts(spec, row)]
    scales = {field.name: _scale(field.name, (*old, *new)) for field in fields}

    def same(field: Field, before: Any, after: Any) -> bool:
        if is_number(before) and is_number(after):
            return bool(abs(after - before) <= _ROUNDING * scales[field.name])
        return bool((before or None) == (after or None))

    def words(field: Field, value: Any) -> str:
        if not is_number(value):
            return str(value)
        unit, factor = units.of_field(spec.name, field)
        return f"{value / factor:.6g} {unit}".rstrip()

    rows = RowComparison(spec, fields, units, same, partial(_row_words, spec), words)
    return rows.compare(old, old, new)


def _row_words(spec: TableSpec, row: Mapping[str, Any]) -> str:
    """What a row is called; a mode is called a mode."""
    shown = []
    for column in spec.row_name:
        value = row.get(column)
        if value is not None:
            word = "mode " if column == "Mode" else "at " if column == "Applied at" else ""
            shown.append(f"{word}{value:g}" if is_number(value) else f"{word}{value}")
    return ", ".join(shown)


def _counts(spec: TableSpec, row: Mapping[str, Any]) -> bool:
    """Whether a row says something of the train: of the audit trail what is not of one run alone."""
    item = str(row.get("Item", ""))
    if spec.name != "Audit":
        return True
    if item == DIGEST_ITEM or is_own_of_each_run(item) or item.startswith("Equation: "):
        return False
    return not item.startswith(("Plan ", "Warning ", "Outcome of the start"))


def _translated(
    fields: Sequence[Field], row: Mapping[str, Any], renamed: Renamed
) -> dict[str, Any]:
    kinds = {column.name: column.kind for column in fields} | {"Excitation": "excitation"}
    return {name: renamed.now(kinds.get(name, ""), value) for name, value in row.items()}


def _scale(column: str, rows: Sequence[Mapping[str, Any]]) -> float:
    numbers = [abs(row[column]) for row in rows if is_number(row.get(column))]
    return max(numbers, default=0.0)


# --- verdicts -------------------------------------------------------------------------------------


def compare_verdicts(
    first: Tables, second: Tables, units: Units, renamed: Renamed
) -> list[VerdictChange]:
    """All checks of table `Verdicts`, and the verdicts of other tables that changed.

    Parameters
    ----------
    first, second : mapping of str to rows
        Results by table and header. [SI]
    units : Units
        Units to show.
    renamed : Renamed
        Names of the first file in the second.

    Returns
    -------
    list of VerdictChange
        The checks of either file first.
    """
    changes = _compare_checks("Verdicts", first, second, units)
    changes += (c for c in _compare_checks("CaseVerdicts", first, second, units) if c.changed)
    for name in ("SeparationMargins", "SteadyState", "TorqueReversals"):
        spec = result_table(name)
        rows = [_translated(spec.columns, row, renamed) for row in first.get(name, ())]
        others = second.get(name, ())
        keys = ([row_name(name, row) for row in side] for side in (rows, others))
        for i, j in match_rows(*keys):
            if i is None or j is None:
                continue
            before, after = rows[i].get("Verdict"), others[j].get("Verdict")
            if before != after:
                row = _row_words(spec, others[j])
                changes.append(VerdictChange(name, row, str(before or ""), str(after or "")))
    return changes


def _compare_checks(name: str, first: Tables, second: Tables, units: Units) -> list[VerdictChange]:
    """Every check of a table of checks."""
    old, new = first.get(name, ()), second.get(name, ())
    changes = []
    for i, j in match_rows(*([row_name(name, row) for row in rows] for rows in (old, new))):
        was, now = old[i] if i is not None else {}, new[j] if j is not None else {}
        dimension = str(now.get("dimension") or was.get("dimension") or "") or _guessed(was, now)
        words = [
            _judged_in_words(value, dimension, units)
            for value in (was.get("Result"), now.get("Result"), now.get("Limit", was.get("Limit")))
        ]
        named = [now.get(column) or was.get(column) for column in result_table(name).row_name]
        verdicts = (str(row.get("Verdict") or "") for row in (was, now))
        changes.append(VerdictChange(name, ", ".join(map(str, named)), *verdicts, *words))
    return changes


def _guessed(*rows: Mapping[str, Any]) -> str:
    """Dimension of a judged number from the words of a workbook; empty when unknown."""
    for row in rows:
        for column in ("Result", "Limit"):
            value = row.get(column)
            unit = value.words.rpartition(" ")[2] if isinstance(value, RoundedNumber) else ""
            for dimension in VERDICT_UNITS:
                if unit in USUAL[dimension] and unit != "1":
                    return dimension
    return ""


def _judged_in_words(value: Value | RoundedNumber, dimension: str, units: Units) -> str:
    """A judged number in the unit shown, with as many digits as a workbook shows."""
    if not isinstance(value, RoundedNumber):
        return str(value or "")
    if dimension not in VERDICT_UNITS:
        return (
            starts_in_words(value.number)
            if dimension == "count"
            else value.words or f"{value.number:,.6g}"
        )
    table, column = VERDICT_UNITS[dimension]
    unit, factor = units.of_field(table, result_table(table).column(column))
    number = value.number / factor
    if dimension == "fraction":
        return f"{number:.2f} {unit}"
    return f"{number:,.0f} {unit}" if abs(number) >= 1000.0 else f"{number:.4g} {unit}"
