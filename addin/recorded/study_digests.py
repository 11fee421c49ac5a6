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
from addin.contract.tables import TableSpec
from addin.recorded.results import factor_of, shown_rows
from addin.xlsx import Workbook

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
    worth = {
        field.name: twelve_digits(factor_of(spec, field, units)) if field.is_number else None
        for field in spec.written_columns
        if field.name.casefold() in table.columns_at
    }
    rows = [_canonical(row) for row in shown_rows(workbook, spec)]
    text = "\n".join([_canonical(worth), *sorted(rows)])
    return hashlib.sha256(text.encode("utf-8")).hexdigest()[:DIGITS]


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
