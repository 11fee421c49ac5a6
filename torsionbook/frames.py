"""Rows of a table to and from pandas frames, whose units stand in ``frame.attrs["units"]``."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, ClassVar

from addin.contract.tables import Field, TableSpec
from addin.contract.units import RATED_TORQUE, parse_unit
from addin.reading.input_names import WrongName, called
from addin.reading.typed_case import Findings
from torsionbook.extras import extra

if TYPE_CHECKING:
    import pandas as pd

    from addin.reading.typed_case import CaseInput

#: What a frame may be asked in: SI and radians, or the units of the two blank workbooks.
UNITS = ("base", "us", "si")


class Tables:
    """What has tables, which can be had as records and as frames."""

    _specs: ClassVar[Sequence[TableSpec]]  #: Its tables, in their order.
    _kind: ClassVar[str]  #: What they are called in a message. [words]
    _read: CaseInput  #: The case they are of. [SI]

    def _records(self, spec: TableSpec) -> Iterable[Mapping[str, Any]]:
        """Rows of a table as they are in the JSON. [SI]"""
        raise NotImplementedError

    @property
    def tables(self) -> tuple[str, ...]:
        """Tables that have rows. [names]"""
        return tuple(spec.name for spec in self._specs if self._records(spec))

    def rows(self, table: str) -> tuple[Mapping[str, Any], ...]:
        """The rows of a table as records that cannot be written to.

        Parameters
        ----------
        table : str
            Its name, such as ``Elements`` or ``StartupPeaks``; ``docs/results.md`` lists those of results. [name]

        Returns
        -------
        tuple of mapping
            By JSON key; a blank has no key. [SI]
        """
        return frozen(self._records(table_called(table, self._specs, self._kind)))

    def table(self, table: str, units: str = "base") -> pd.DataFrame:
        """The rows of a table as a frame.

        Parameters
        ----------
        table : str
            Its name. [name]
        units : str, optional
            ``base`` (SI and radians), ``us`` or ``si`` (those of the blank workbooks). [word]

        Returns
        -------
        pandas.DataFrame
            A column a JSON key; ``attrs["units"]`` says the unit of each. [those units]
        """
        spec = table_called(table, self._specs, self._kind)
        return frame_of(self.rows(table), spec, units, self._read.data.ratings.rated_torque)


def table_called(word: str, tables: Sequence[TableSpec], what: str) -> TableSpec:
    """The table of a name or JSON key, in any capitals.

    Raises
    ------
    LookupError
        If there is none; the sentence names the nearest.
    """
    try:
        return called(word, tables, what)
    except WrongName as wrong:
        raise LookupError(str(wrong)) from None


def frame_of(
    rows: Sequence[Mapping[str, Any]], spec: TableSpec, units: str, rated_torque: float | None
) -> pd.DataFrame:
    """Rows of a table as a frame.

    Parameters
    ----------
    rows : sequence of mapping
        By JSON key; a blank has none. [SI]
    spec : TableSpec
        The table.
    units : str
        One of `UNITS`. [word]
    rated_torque : float or None
        Of the case, for torques shown in pu of it. [N m]

    Returns
    -------
    pandas.DataFrame
        A column a JSON key; ``attrs["units"]`` has the unit of each that has one. [those units]
    """
    if units not in UNITS:
        raise ValueError(f"units is '{units}'; it must be {', '.join(UNITS[:-1])} or {UNITS[-1]}.")
    pd = extra("pandas", "frames")
    fields = {field.key: field for field in _fields(rows, spec)}
    shown = {key: _scale(field, units, rated_torque) for key, field in fields.items()}
    columns = {}
    for key, field in fields.items():
        factor = shown[key][1]
        values = [_in_unit(row.get(key), factor) for row in rows]
        is_number = field.is_number and not any(isinstance(value, str) for value in values)
        whole = is_number and field.kind == "integer" and None not in values
        columns[key] = pd.Series(
            values, dtype="int64" if whole else "float64" if is_number else "object"
        )
    frame = pd.DataFrame(columns)
    frame.attrs["table"] = spec.name
    frame.attrs["units"] = {key: unit for key, (unit, _) in shown.items() if unit}
    return frame


def frozen(rows: Iterable[Mapping[str, Any]]) -> tuple[Mapping[str, Any], ...]:
    """Rows as records that cannot be written to; words of the engine as plain texts."""
    return tuple(
        MappingProxyType({k: str(v) if isinstance(v, str) else v for k, v in row.items()})
        for row in rows
    )


def _fields(rows: Sequence[Mapping[str, Any]], spec: TableSpec) -> list[Field]:
    """Columns of the contract, repeated ones as many as there are, and what a JSON row may have beside them."""
    fields = list(spec.columns)
    if spec.repeated is not None:
        number = 1
        while rows and (field := spec.repeated_column(number)).key in rows[0]:
            fields.append(field)
            number += 1
    return [*fields, *spec.json_only]


def _scale(field: Field, units: str, rated_torque: float | None) -> tuple[str, float]:
    """The unit of a column and what one of it is worth in SI."""
    if not field.has_unit:
        return field.si, 1.0
    unit = field.si if units == "base" else str(getattr(field, f"unit_{units}"))
    scale = parse_unit(unit, field.dimension)
    if scale.base == RATED_TORQUE and rated_torque:
        return unit, scale.factor * rated_torque
    # a share of something that differs from row to row is shown in SI
    return (field.si, 1.0) if scale.base else (unit, scale.factor)


def _in_unit(value: Any, factor: float) -> Any:
    is_number = isinstance(value, (int, float)) and not isinstance(value, bool)
    return value / factor if is_number and factor != 1.0 else value


def rows_of(table: Any, spec: TableSpec, findings: Findings) -> list[Any]:
    """A frame, or rows of names and values, as rows of the case JSON.

    Parameters
    ----------
    table : pandas.DataFrame or sequence of mapping
        Columns by header or JSON key. [stated units]
    spec : TableSpec
        The table.
    findings : Findings
        Takes columns of a frame whose unit is not stated. [problems]

    Returns
    -------
    list
        Rows by JSON key; numbers are in SI, others texts with their unit.
    """
    keys = {field.name: field.key for field in spec.columns}
    if not hasattr(table, "to_dict"):
        rows = (
            list(table)
            if isinstance(table, Iterable) and not isinstance(table, (str, bytes))
            else table
        )
        if not isinstance(rows, list):
            return rows  # type: ignore[no-any-return]  # told of where it is read
        return [
            {keys.get(key, key): plain(value) for key, value in row.items()}
            if isinstance(row, Mapping)
            else row
            for row in rows
        ]
    frame = table.rename(columns=keys)
    stated = {keys.get(key, key): str(unit) for key, unit in table.attrs.get("units", {}).items()}
    fields = {field.key: field for field in spec.columns}
    for key in frame.columns:
        field = fields.get(key)
        if field is None or not field.has_unit or key in stated:
            continue
        if any(isinstance(plain(value), (int, float)) for value in frame[key]):
            findings.add(
                (spec.name, None, field.name),
                None,
                f"a unit such as {field.si}",
                f"the column of the frame has no unit. Write frame.attrs['units']['{key}'] = "
                f"'{field.si}', or the unit in which its numbers are.",
            )
    return [
        {
            key: _with_unit(value, fields.get(key), stated.get(key, ""))
            for key, value in zip(frame.columns, map(plain, values), strict=True)
            if value is not None
        }
        for values in frame.itertuples(index=False, name=None)
    ]


def _with_unit(value: Any, field: Field | None, unit: str) -> Any:
    """A number with the unit of its column; plain where that is SI, as in a case JSON."""
    is_number = isinstance(value, (int, float)) and not isinstance(value, bool)
    if not is_number or field is None or not field.has_unit or unit in ("", field.si):
        return value
    return f"{value!r} {unit}"


def plain(value: Any) -> Any:
    """A value of numpy or pandas as one of Python; None for what means a blank."""
    value = value.item() if hasattr(value, "item") else value
    if value is None or (isinstance(value, float) and math.isnan(value)):
        return None
    return None if type(value).__name__ in ("NAType", "NaTType") else value
