"""Rows of one table of either file side by side, matched by their names."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from addin.contract.tables import Field, TableSpec
from addin.diff.changes import Change
from addin.diff.units import Units
from addin.recorded.match_rows import match_rows, row_name
from engine.case.data import ADMINISTRATIVE

Row = Mapping[str, Any]

#: Tables whose rows carry a name that others refer to, referred ones first.
NAMED = {"Stations": "station", "Materials": "material", "Elements": "element",
         "Excitations": "excitation"}  # fmt: skip


@dataclass(frozen=True)
class RowComparison:
    """The rows of a table; inputs and results say what is equal, and how it is called."""

    spec: TableSpec  #: The table.
    fields: Sequence[Field]  #: Columns that are compared.
    units: Units  #: Units to show.
    same: Callable[[Field, Any, Any], bool]  #: Whether two values of a column are equal.
    name: Callable[[Row], str]  #: What a row is called.
    words: Callable[[Field, Any], str]  #: A value with its unit.

    def compare(
        self, first: Sequence[Row], translated: Sequence[Row], second: Sequence[Row]
    ) -> tuple[list[Change], int]:
        """What differs in the table.

        Parameters
        ----------
        first, second : sequence of mapping
            Rows of either file by header. [SI]
        translated : sequence of mapping
            Those of the first under the names of the second. [SI]

        Returns
        -------
        changes : list of Change
            Row by row.
        same : int
            Quantities that are the same. [count]
        """
        table = self.spec.name
        changes, same = [], 0
        keys = ([row_name(table, row) for row in rows] for rows in (translated, second))
        for i, j in match_rows(*keys):
            if i is None or j is None:
                row = second[j] if j is not None else first[i]  # type: ignore[index]
                kind = "row added" if i is None else "row removed"
                before, after = (
                    (None, self._stated(row)) if i is None else (self._stated(row), None)
                )
                changes.append(Change(kind, table, self.name(row), "", before, after))
                continue
            was, name = self.name(first[i]), self.name(second[j])
            if was != name and table in NAMED:
                changes.append(Change("row renamed", table, name, "", was, name))
            for field in self.fields:
                before, after = translated[i].get(field.name), second[j].get(field.name)
                if self.same(field, before, after):
                    same += before is not None
                    continue
                changes.append(changed(table, name, field, before, after, self.units))
        return changes, same

    def _stated(self, row: Row) -> str:
        """What a row states beside its name."""
        stated = (
            (field, row.get(field.name))
            for field in self.fields
            if field.name not in self.spec.row_name
        )
        return "; ".join(
            f"{field.name} {self.words(field, value)}"
            for field, value in stated
            if value is not None and value != ""
        )


def changed(table: str, row: str, field: Field, before: Any, after: Any, units: Units) -> Change:
    """A quantity that changed, in the unit shown."""
    unit, factor = units.of_field(table, field)
    administrative = field.attribute in ADMINISTRATIVE
    return Change("changed", table, row, field.name, before, after, unit, factor, administrative)
