"""Units shown above the columns → what one shown unit is worth in SI."""

from __future__ import annotations

from collections.abc import Mapping

from addin.charts.data import ShownUnits
from addin.contract import tables as fields
from addin.contract.units import RATED_TORQUE, UnitError, parse_unit

__all__ = ["shown_units"]


def shown_units(
    names: Mapping[tuple[str, str], str], rated_torque: float | None
) -> tuple[ShownUnits, list[str]]:
    """The worth of every shown unit.

    Parameters
    ----------
    names : mapping of (table, column) to str
        Units as they stand above the headers. [units]
    rated_torque : float or None
        Base of torques in pu or %. [N m]

    Returns
    -------
    units : ShownUnits
        Names and factors.
    problems : list of str
        A sentence for each unit that cannot be used; its column is in SI, and its name says so.
    """
    factors: dict[tuple[str, str], float] = {}
    used = dict(names)
    problems: list[str] = []
    for table in fields.EVERY_TABLE:
        repeated = () if table.repeated is None else (table.repeated,)
        for field in (*table.columns, *repeated, *table.extra_columns):
            key = (table.name, field.name)
            if not field.has_unit or not names.get(key):
                continue
            try:
                factors[key] = _factor(names[key], field, rated_torque)
            except UnitError as problem:
                used[key] = field.si
                problems.append(f"Table {table.name}, column {field.name}: {problem.message}")
    return ShownUnits(used, factors), problems


def _factor(unit: str, field: fields.Field, rated_torque: float | None) -> float:
    scale = parse_unit(unit, field.dimension)
    if scale.base == RATED_TORQUE:
        if not rated_torque:
            raise UnitError(unit, "a unit of torque", f"'{unit}' needs a rated torque.")
        return scale.factor * rated_torque
    return scale.factor
