"""What a cell shows of one result: numbers in the shown unit, words, or a blank."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from addin.contract.shown_units import ShownUnits
from addin.contract.tables import Field, TableSpec
from engine.case.defaults import WHOLE_STARTS
from engine.case.result_words import NoNumber

#: Column whose unit shows a judged number of a dimension in `Verdicts`.
VERDICT_UNITS: Mapping[str, tuple[str, str]] = {
    "frequency": ("NaturalFrequencies", "Frequency"),
    "fraction": ("SeparationMargins", "Margin"),
    "pressure": ("SteadyState", "Allowable"),
    "torque": ("StartupPeaks", "Maximum torque"),
    "time": ("StartupPeaks", "Time"),
    "speed": ("SeparationMargins", "Speed"),
}


def shown_cell(spec: TableSpec, field: Field, row: Mapping[str, Any], units: ShownUnits) -> Any:
    """What a cell shows of one result.

    Parameters
    ----------
    spec : TableSpec
        Its table. [table]
    field : Field
        Its column. [field]
    row : mapping
        The row by JSON key. [SI]
    units : ShownUnits
        Units shown. [units]

    Returns
    -------
    object
        A number in the shown unit, words, or None for a blank.
    """
    value = row.get(field.key)
    if value is None:
        if not field.unlimited:
            return None
        # A row that does not say whether its starts are limited is of no whole start.
        judged = not spec.says_unlimited or "unlimited" in row
        return (NoNumber.UNLIMITED if judged else NoNumber.NOT_JUDGED).value
    if isinstance(value, bool):
        if field.kind == "switch":
            return "on" if value else "off"
        return "yes" if value else None
    if field.kind == "mixed":
        return _mixed(value, row.get("dimension"), units)
    if not field.is_number:
        return str(value)
    if not math.isfinite(value):
        return (NoNumber.UNLIMITED if field.unlimited else NoNumber.UNBOUNDED).value
    name = spec.repeated.name if spec.repeated and field.name not in _names(spec) else field.name
    factor = units.factors.get((spec.name, field.name), units.factor(spec.name, name))
    return int(value) if field.kind == "integer" else float(value) / factor


def _names(spec: TableSpec) -> frozenset[str]:
    return frozenset(field.name for field in spec.columns)


def _mixed(value: Any, dimension: str | None, units: ShownUnits) -> Any:
    """A judged number with its unit, or words as they are."""
    if isinstance(value, str):
        return value
    if dimension == "count":  # whole starts, never rounded up
        return float(math.floor(value * (1.0 + WHOLE_STARTS)))
    if dimension is None or dimension not in VERDICT_UNITS:
        return float(f"{value:.4g}") if abs(value) < 1000.0 else float(round(value))
    place = VERDICT_UNITS[dimension]
    number = value / units.factor(*place)
    if dimension == "fraction":
        digits = f"{number:.2f}"
    else:
        digits = f"{number:,.0f}" if abs(number) >= 1000.0 else f"{number:.4g}"
    return f"{digits} {units.name(*place)}".rstrip()
