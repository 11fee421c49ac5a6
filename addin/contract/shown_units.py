"""Units shown above the columns → what one shown unit is worth in SI."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

from addin.contract import tables as fields
from addin.contract.units import RATED_TORQUE, UnitError, parse_unit


@dataclass(frozen=True)
class ShownUnits:
    """The unit shown above each column, and its size in SI."""

    names: Mapping[tuple[str, str], str]  #: Units as typed. [units]
    factors: Mapping[tuple[str, str], float]  #: SI value of one shown unit. [SI]

    def name(self, table: str, column: str) -> str:
        """The unit of a column; empty where there is none."""
        return self.names.get((table, column), "")

    def factor(self, table: str, column: str) -> float:
        """The SI value of one shown unit; 1 where there is no unit."""
        return self.factors.get((table, column), 1.0)


def template_units(system: str, tables: Iterable[fields.TableSpec]) -> dict[tuple[str, str], str]:
    """The units above the columns of a blank template, by table and column.

    Parameters
    ----------
    system : str
        ``US`` or ``SI``. [word]
    tables : iterable of TableSpec
        The tables that are asked for.
    """
    return {
        (table.name, field.name): field.unit_us if system == "US" else field.unit_si
        for table, field in _columns(tables)
        if field.has_unit
    }


def _columns(
    tables: Iterable[fields.TableSpec],
) -> Iterator[tuple[fields.TableSpec, fields.Field]]:
    """Every column of the tables, the repeated one once."""
    for table in tables:
        repeated = () if table.repeated is None else (table.repeated,)
        for field in (*table.columns, *repeated, *table.extra_columns):
            yield table, field


def shown_units(
    names: Mapping[tuple[str, str], str], rated_torque: float | None
) -> tuple[ShownUnits, list[str]]:
    """The worth of every shown unit.

    Parameters
    ----------
    names : mapping of (table, column) to str
        Units above the headers. [units]
    rated_torque : float or None
        Base of torques in pu or %. [N m]

    Returns
    -------
    units : ShownUnits
        Names and factors.
    problems : list of str
        A sentence for each unit of a result that cannot be used; its column is in SI, and its name says so.
    """
    factors: dict[tuple[str, str], float] = {}
    used = dict(names)
    problems: list[str] = []
    for table, field in _columns(fields.EVERY_TABLE):
        key = (table.name, field.name)
        if not field.has_unit or not names.get(key):
            continue
        try:
            factors[key] = _factor(names[key], field, rated_torque)
        except UnitError as problem:
            used[key] = field.si
            if table in fields.INPUT_TABLES:
                continue  # said where the table is read, if anything stands in it
            problems.append(f"Table {table.name}, column {field.name}: {problem.message}")
    return ShownUnits(used, factors), problems


def _factor(unit: str, field: fields.Field, rated_torque: float | None) -> float:
    scale = parse_unit(unit, field.dimension)
    if scale.base == RATED_TORQUE:
        if not rated_torque:
            raise UnitError(unit, "a unit of torque", f"'{unit}' needs a rated torque.")
        return scale.factor * rated_torque
    return scale.factor
