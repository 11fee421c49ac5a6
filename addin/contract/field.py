"""What a field and a table of fields are made of: kinds, dimensions, JSON keys.

The grammar of the table in `addin.contract.tables`; nothing here names a quantity of a train.
"""

from __future__ import annotations

import keyword
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType

from addin.contract.result_tables import Trace

__all__ = [
    "DIMENSIONS",
    "Dimension",
    "Field",
    "TableSpec",
    "choice",
    "integer",
    "json_key",
    "mixed",
    "number",
    "table",
    "text",
    "traced",
]

_WORDS = re.compile(r"[A-Z]+(?=[A-Z][a-z])|[A-Z]?[a-z]+|[A-Z]+|\d+")


def json_key(name: str) -> str:
    """The JSON key of a contract name: words and capital runs, joined by `_`, lower case."""
    return "_".join(_WORDS.findall(name)).lower()


@dataclass(frozen=True)
class Dimension:
    """One physical dimension: the SI unit inside and the units people usually type."""

    #: Unit of the engine and of a plain JSON number; empty where there is none. [unit]
    si: str = ""
    unit_us: str = ""  #: Units shown by the US-customary and the SI template. [unit]
    unit_si: str = ""  #: Likewise. [unit]
    units: tuple[str, ...] = ()  #: The drop-down list. [units]


_RELATIVE = ("pu", "%")
_TORQUES = ("lbf*in", "lbf*ft", "kip*in", "N*m", "kN*m")

#: Every dimension a field may have. A ratio may lack its unit (it is 1 then), a fraction may not.
DIMENSIONS: Mapping[str, Dimension] = MappingProxyType(
    {
        "none": Dimension(),
        "count": Dimension(),
        "ratio": Dimension("1", "1", "1", ("1", "%")),
        "fraction": Dimension("1", "%", "%", ("%", "1")),
        "speed fraction": Dimension("1", "%", "%", ("%", "1", "rpm", "rad/s")),
        "inertia": Dimension(
            "kg*m^2", "lb*ft^2", "kg*m^2", ("lb*ft^2", "lb*in^2", "lbf*in*s^2", "kg*m^2")
        ),
        "torsional stiffness": Dimension(
            "N*m/rad",
            "lbf*in/rad",
            "N*m/rad",
            ("lbf*in/rad", "lbf*ft/rad", "N*m/rad", "kN*m/rad", "MN*m/rad"),
        ),
        "torsional damping": Dimension(
            "N*m*s/rad",
            "lbf*in*s/rad",
            "N*m*s/rad",
            ("lbf*in*s/rad", "lbf*ft*s/rad", "N*m*s/rad", "kN*m*s/rad"),
        ),
        "torque": Dimension("N*m", "lbf*in", "N*m", _TORQUES + _RELATIVE),
        "excitation torque": Dimension("N*m", "%", "%", ("%", "pu", *_TORQUES)),
        "length": Dimension("m", "in", "mm", ("in", "ft", "mm", "m", "um")),
        "pressure": Dimension("Pa", "psi", "MPa", ("psi", "ksi", "Mpsi", "MPa", "GPa", "N/mm^2")),
        "density": Dimension(
            "kg/m^3", "lb/in^3", "kg/m^3", ("lb/in^3", "lb/ft^3", "kg/m^3", "g/cm^3")
        ),
        "angle": Dimension("rad", "deg", "deg", ("deg", "rad")),
        "time": Dimension("s", "s", "s", ("s", "ms", "min")),
        "calculation time": Dimension("s", "ms", "ms", ("ms", "s", "min")),
        "frequency": Dimension("Hz", "Hz", "Hz", ("Hz", "cpm")),
        "cycles per minute": Dimension("cpm", "cpm", "cpm", ("cpm",)),
        "speed": Dimension("rad/s", "rpm", "rpm", ("rpm", "rad/s", "Hz")),
        "running speed": Dimension("rad/s", "rpm", "rpm", ("rpm", "%", "rad/s", "Hz")),
        "angular acceleration": Dimension("rad/s^2", "rpm/s", "rpm/s", ("rpm/s", "rad/s^2")),
        "sweep rate": Dimension("Hz/s", "Hz/s", "Hz/s", ("Hz/s",)),
        "power": Dimension("W", "hp", "kW", ("hp", "kW", "MW", "W")),
        "mass": Dimension("kg", "lb", "kg", ("lb", "kg", "t")),
        "linear stiffness": Dimension(
            "N/m", "lbf/in", "N/m", ("lbf/in", "kip/in", "N/m", "N/um", "N/mm")
        ),
        "linear damping": Dimension("N*s/m", "lbf*s/in", "N*s/m", ("lbf*s/in", "N*s/m", "N*s/mm")),
        "force": Dimension("N", "lbf", "kN", ("lbf", "kip", "N", "kN")),
        "approach speed": Dimension("m/s", "in/s", "m/s", ("in/s", "ft/s", "mm/s", "m/s")),
        "angular approach speed": Dimension("rad/s", "rad/s", "rad/s", ("rad/s", "deg/s")),
        "deciding number": Dimension(),
    }
)


@dataclass(frozen=True)
class Field:
    """One input or output: a scalar of sheet `Case` or a column of a table."""

    name: str  #: Defined name of a scalar or header of a column, as in the contract.
    key: str  #: JSON key.
    #: ``number``, ``integer``, ``text``, ``choice``, ``station``, ``element``, ``material``
    #: (references by name); of results also ``flag`` (yes or no) and ``mixed`` (a number in one
    #: row, words in another).
    kind: str
    dimension: str  #: Key of `DIMENSIONS`.
    unit_us: str  #: Units shown by the two templates; empty where there is no unit. [unit]
    unit_si: str  #: Likewise. [unit]
    #: Drop-down list of the unit cell; empty where there is no unit. [units]
    units: tuple[str, ...]
    choices: tuple[str, ...]  #: Allowed words of a choice; the first one is the default.
    default_text: str  #: What a blank cell means; empty where a blank has no meaning of its own.
    help: str  #: One sentence for the input prompt.
    group: str = ""  #: Block of sheet `Case` the scalar stands in; empty for columns.
    #: Of a result: equation, source and the inputs it comes from, see
    #: `addin.contract.result_tables`.
    trace: Trace | None = None

    @property
    def attribute(self) -> str:
        """Name of the quantity in `engine.case.data` (`from` and `yield` get an underscore)."""
        return f"{self.key}_" if keyword.iskeyword(self.key) else self.key

    @property
    def is_number(self) -> bool:
        """Whether a cell of this field holds a number."""
        return self.kind in ("number", "integer")

    @property
    def has_unit(self) -> bool:
        """Whether a unit stands above (column) or right of (scalar) it."""
        return bool(self.units)

    @property
    def si(self) -> str:
        """Unit of the engine and of a plain JSON number; empty where there is none."""
        return DIMENSIONS[self.dimension].si


@dataclass(frozen=True)
class TableSpec:
    """One Excel table."""

    name: str  #: Name of the Excel table.
    key: str  #: JSON key.
    sheet: str  #: Sheet it is shipped on.
    columns: tuple[Field, ...]  #: Columns of the contract, in its order.
    rows: int  #: Blank rows shipped.
    help: str  #: One sentence above the table.
    #: Columns after those of the contract, such as live checks; never read.
    extra_columns: tuple[Field, ...] = ()
    #: Column repeated after `columns`, its name ending in 1, 2, ... (mode shapes).
    repeated: Field | None = None
    json_only: tuple[str, ...] = ()  #: Keys a JSON row may have beside the columns.
    #: Column without which a row of a workbook states nothing and is passed over, such as rows
    #: shipped with names alone; empty = every filled row counts.
    states: str = ""

    def column(self, name: str) -> Field:
        """The contract column of a header."""
        for field in self.columns:
            if field.name == name:
                return field
        raise KeyError(f"table {self.name} has no column {name!r}")

    def repeated_column(self, number: int) -> Field:
        """One of the repeated columns, such as ``Mode 3``."""
        if self.repeated is None:
            raise KeyError(f"table {self.name} has no repeated column")
        name = f"{self.repeated.name} {number}"
        return replace(self.repeated, name=name, key=json_key(name))


def number(
    name: str,
    dimension: str,
    help: str,
    *,
    blank: str = "",
    us: str = "",
    si: str = "",
    kind: str = "number",
    group: str = "",
) -> Field:
    """A number; `us` and `si` replace the units the templates show.

    Parameters
    ----------
    name : str
        Header or defined name. [name]
    dimension : str
        Key of `DIMENSIONS`. [word]
    help : str
        One sentence. [sentence]
    blank : str, optional
        What a blank means. [sentence]
    us, si : str, optional
        Units of the templates. [units]
    kind : str, optional
        ``number`` or ``integer``. [word]
    group : str, optional
        Block of sheet `Case`. [name]

    Returns
    -------
    Field
    """
    usual = DIMENSIONS[dimension]
    return Field(
        name=name,
        key=json_key(name),
        kind=kind,
        dimension=dimension,
        unit_us=us or usual.unit_us,
        unit_si=si or usual.unit_si,
        units=usual.units,
        choices=(),
        default_text=blank,
        help=help,
        group=group,
    )


def integer(name: str, help: str, *, group: str = "") -> Field:
    """A whole number without unit."""
    return number(name, "count", help, kind="integer", group=group)


def text(
    name: str,
    help: str,
    *,
    kind: str = "text",
    choices: tuple[str, ...] = (),
    blank: str = "",
    group: str = "",
) -> Field:
    """Words: free text, a choice, or the name of a station, element or material.

    Parameters
    ----------
    name : str
        Header or defined name. [name]
    help : str
        One sentence. [sentence]
    kind : str, optional
        See `Field`. [word]
    choices : tuple of str, optional
        Allowed words. [words]
    blank : str, optional
        What a blank means. [sentence]
    group : str, optional
        Block of sheet `Case`. [name]
    """
    return Field(
        name=name,
        key=json_key(name),
        kind=kind,
        dimension="none",
        unit_us="",
        unit_si="",
        units=(),
        choices=choices,
        default_text=blank,
        help=help,
        group=group,
    )


def choice(
    name: str,
    choices: tuple[str, ...],
    help: str,
    *,
    blank: str = "",
    group: str = "",
) -> Field:
    """A word from a short list.

    Parameters
    ----------
    name : str
        Header or defined name. [name]
    choices : tuple of str
        Allowed words, the default first. [words]
    help : str
        One sentence. [sentence]
    blank : str, optional
        What a blank means. [sentence]
    group : str, optional
        Block of sheet `Case`. [name]
    """
    return text(name, help, kind="choice", choices=choices, blank=blank, group=group)


def table(
    name: str, sheet: str, rows: int, help: str, *columns: Field, **more: object
) -> TableSpec:
    """A table whose key follows from its name."""
    return TableSpec(name, json_key(name), sheet, columns, rows, help, **more)  # type: ignore[arg-type]


def mixed(name: str, help: str) -> Field:
    """A result that is a number in one row and words in another."""
    return text(name, help, kind="mixed")


def traced(
    tables: Sequence[TableSpec], traces: Mapping[tuple[str, str], Trace]
) -> tuple[TableSpec, ...]:
    """Result tables with the trace of every column."""

    def with_trace(table: str, field: Field) -> Field:
        return replace(field, trace=traces[table, field.name])

    return tuple(
        replace(
            one,
            columns=tuple(with_trace(one.name, field) for field in one.columns),
            extra_columns=tuple(with_trace(one.name, field) for field in one.extra_columns),
            repeated=None if one.repeated is None else with_trace(one.name, one.repeated),
        )
        for one in tables
    )
