"""What a study wrote into its result tables, as digests, so that a cell edited since is seen.

Numbers count to 12 significant digits, and are written with no more: programs that save 15 digits change nothing.
Rows may be sorted.
"""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from addin.contract.digests import DIGITS
from addin.contract.shown_units import ShownUnits
from addin.contract.tables import Field, TableSpec
from addin.xlsx import ErrorValue, Workbook
from addin.xlsx.references import cell_name

_DIGITS = 12
_STATED = re.compile(r"(\w+) ([0-9a-f]{12})\b")


def twelve_digits(value: Any) -> Any:
    """A number as study sheets hold it.

    Parameters
    ----------
    value : object
        What goes into a cell. [shown unit]

    Returns
    -------
    object
        A float rounded to 12 significant digits, anything else as it is.
    """
    return float(f"{value:.{_DIGITS - 1}e}") if isinstance(value, float) else value


def table_digest(workbook: Workbook, spec: TableSpec, units: ShownUnits) -> str:
    """Digest of the rows of a result table and of what its units are worth.

    Returns
    -------
    str
        12 hexadecimal digits, whatever the order of rows and columns is; empty without the table. [hex]
    """
    table = workbook.tables.get(spec.name)
    if table is None:
        return ""
    columns = table.columns_at
    ours = [f for f in spec.workbook_columns if f not in spec.extra_columns]
    places = {f.name: columns[f.name.casefold()] for f in ours if f.name.casefold() in columns}
    worth = {f.name: twelve_digits(_factor(spec, f, units)) for f in ours if f.name in places}
    rows = [
        _canonical({name: _shown(workbook, table.sheet, row, at) for name, at in places.items()})
        for row in range(table.data.top, table.data.bottom + 1)
    ]
    text = "\n".join([_canonical(worth), *sorted(row for row in rows if row != "{}")])
    return hashlib.sha256(text.encode("utf-8")).hexdigest()[:DIGITS]


def _factor(spec: TableSpec, field: Field, units: ShownUnits) -> float | None:
    """What the unit of a column is worth in SI; None for words."""
    if not field.is_number:
        return None
    repeated = spec.repeated is not None and field not in spec.columns
    column = spec.repeated.name if repeated and spec.repeated else field.name
    return float(units.factors.get((spec.name, field.name), units.factor(spec.name, column)))


def _shown(workbook: Workbook, sheet: str, row: int, column: int) -> Any:
    value = workbook.shown_value(sheet, cell_name(row, column))
    if isinstance(value, ErrorValue):
        return value.code
    return value if isinstance(value, bool) or not isinstance(value, int) else float(value)


def _canonical(cells: Mapping[str, Any]) -> str:
    there = {k: twelve_digits(v) for k, v in cells.items() if v is not None and v != ""}
    return json.dumps(there, sort_keys=True, separators=(",", ":"))


def stated_digests(
    workbook: Workbook, specs: Iterable[TableSpec], units: ShownUnits
) -> Iterator[str]:
    """What is recorded of the tables that a study has written."""
    for spec in specs:
        digest = table_digest(workbook, spec, units)
        if digest:
            yield f"{spec.name} {digest}"


def edited_tables(
    workbook: Workbook, specs: Iterable[TableSpec], units: ShownUnits, stated: str
) -> tuple[str, ...]:
    """Tables that do not hold what was recorded of them."""
    recorded = dict(_STATED.findall(stated))
    return tuple(
        spec.name
        for spec in specs
        if spec.name in recorded and table_digest(workbook, spec, units) != recorded[spec.name]
    )
