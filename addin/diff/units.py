"""The unit in which a quantity of two files is shown: that of the second, else of the first."""

from __future__ import annotations

from collections.abc import Iterable

from addin.contract.shown_units import ShownUnits
from addin.contract.tables import DIMENSIONS, SCALAR_TABLE, Field
from addin.contract.units import UnitError, parse_unit
from addin.reading.typed_case import Typed, TypedCase


class Units:
    """Units and their worth, by table and column.

    Parameters
    ----------
    sides : iterable of (TypedCase or None, ShownUnits or None)
        Entries as typed and units above the columns; of the side that counts most first.
    """

    def __init__(self, sides: Iterable[tuple[TypedCase | None, ShownUnits | None]]) -> None:
        self._sides = list(sides)

    def of_field(self, table: str, field: Field) -> tuple[str, float]:
        """The unit of a quantity.

        Parameters
        ----------
        table : str
            Table, ``Case`` for a scalar. [name]
        field : Field
            The scalar or column.

        Returns
        -------
        unit : str
            Name; empty where there is none. [unit]
        factor : float
            Its SI value. [SI]
        """
        if not field.has_unit:
            return "", 1.0
        usual = DIMENSIONS[field.dimension]
        stated = (self._stated(table, field, *side) for side in self._sides)
        for name in (*stated, field.unit_si, usual.unit_si, usual.si):
            factor = _factor(name, field)
            if factor is not None:
                return name, factor
        return usual.si, 1.0

    def _stated(
        self, table: str, field: Field, typed: TypedCase | None, shown: ShownUnits | None
    ) -> str:
        """The unit that one side states; empty where it states none."""
        if table == SCALAR_TABLE and typed is not None:
            entry = typed.scalars.get(field.name)
            return entry.unit if isinstance(entry, Typed) else ""
        return "" if shown is None else shown.name(table, field.name)


def _factor(unit: str, field: Field) -> float | None:
    """SI value of a unit; None for a unit that is a share of something, or none at all."""
    if not unit:
        return None
    try:
        scale = parse_unit(unit, field.dimension)
    except UnitError:
        return None
    return None if scale.base else scale.factor
