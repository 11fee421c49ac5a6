"""What a table of inputs or results is made of: columns with kind, dimension, source and what every room needs of them.

The grammar of the records in `addin.contract.scalars`, `input_tables`, `result_tables` and `studies`;
nothing here names a quantity of a train.
"""

from __future__ import annotations

import keyword
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from functools import partial
from types import MappingProxyType
from typing import Any

from addin.contract import number_formats as shown
from engine.case.data import json_key

#: Mode-shape columns of the workbook; further modes are in the JSON only.
SHAPE_COLUMNS = 10


@dataclass(frozen=True)
class Dimension:
    """One physical dimension: the SI unit inside and the units people usually type."""

    #: Unit of the engine and of a plain JSON number; empty where there is none. [unit]
    si: str = ""
    unit_us: str = ""  #: Units shown by the US-customary and the SI template. [unit]
    unit_si: str = ""  #: Likewise. [unit]
    units: tuple[str, ...] = ()  #: The drop-down list. [units]
    format: str = shown.LARGE  #: Number format of a result; typed numbers stay as typed.


_RELATIVE = ("pu", "%")
_TORQUES = ("lbf*in", "lbf*ft", "kip*in", "N*m", "kN*m")

#: Every dimension a field may have. A ratio may lack its unit (it is 1 then), a fraction may not.
DIMENSIONS: Mapping[str, Dimension] = MappingProxyType(
    {
        "none": Dimension(),
        "count": Dimension(format="0"),
        "ratio": Dimension("1", "1", "1", ("1", "%"), format="0.0000"),
        "fraction": Dimension("1", "%", "%", ("%", "1"), format=shown.SMALL),
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
        "time": Dimension("s", "s", "s", ("s", "ms", "min"), format="0.000"),
        "calculation time": Dimension(
            "s", "ms", "ms", ("ms", "s", "min"), format="[>=100]#,##0;[>=1]0.0;0.00"
        ),
        "frequency": Dimension("Hz", "Hz", "Hz", ("Hz", "cpm"), format="0.000"),
        "cycles per minute": Dimension("cpm", "cpm", "cpm", ("cpm",), format="#,##0.0"),
        "speed": Dimension("rad/s", "rpm", "rpm", ("rpm", "rad/s", "Hz"), format="0.0"),
        "running speed": Dimension("rad/s", "rpm", "rpm", ("rpm", "%", "rad/s", "Hz")),
        "angular acceleration": Dimension(
            "rad/s^2", "rpm/s", "rpm/s", ("rpm/s", "rad/s^2"), format="0.00"
        ),
        "sweep rate": Dimension("Hz/s", "Hz/s", "Hz/s", ("Hz/s",), format="0.000"),
        "power": Dimension("W", "hp", "kW", ("hp", "kW", "MW", "W")),
        "per unit": Dimension("1", "pu", "pu", ("pu", "%", "ohm")),
        "voltage": Dimension("V", "V", "V", ("V", "kV")),
        "apparent power": Dimension("VA", "kVA", "kVA", ("kVA", "MVA", "VA")),
        "mass": Dimension("kg", "lb", "kg", ("lb", "kg", "t")),
        "linear stiffness": Dimension(
            "N/m", "lbf/in", "N/m", ("lbf/in", "kip/in", "N/m", "N/um", "N/mm")
        ),
        "linear damping": Dimension("N*s/m", "lbf*s/in", "N*s/m", ("lbf*s/in", "N*s/m", "N*s/mm")),
        "force": Dimension("N", "lbf", "kN", ("lbf", "kip", "N", "kN")),
        "approach speed": Dimension("m/s", "in/s", "m/s", ("in/s", "ft/s", "mm/s", "m/s")),
        "angular approach speed": Dimension("rad/s", "rad/s", "rad/s", ("rad/s", "deg/s")),
        "deciding number": Dimension(format="[<0.01]0.00000;#,##0.000"),
    }
)


class IncompleteRecord(Exception):
    """A record that lacks something; the sentence says what, and where to add it."""


@dataclass(frozen=True)
class Trace:
    """How one result column is obtained."""

    equation: str  #: Formula or rule, in the symbols of the nomenclature.
    #: Paper, standard or textbook with section, equation or page; our own rules name the part of
    #: docs/method.md that states them. [citation]
    source: str
    #: Inputs and results of the very row: of its element, station, mode, excitation or material.
    of_row: tuple[str, ...] = ()
    of_case: tuple[str, ...] = ()  #: Inputs and results of the whole case.

    @property
    def inputs(self) -> tuple[str, ...]:
        """All of them, those of the row first. [names]"""
        return tuple(dict.fromkeys((*self.of_row, *self.of_case)))


class ReportedError(StrEnum):
    """Which error that a calculation reports covers the numbers of a column."""

    PEAKS = "of the peak torques"
    STARTS = "of the allowable starts of the row's element"
    ALL_STARTS = "the largest of the allowable starts"
    FREQUENCIES = "of the frequencies"
    EVENTS = "of the peaks of the row's event"
    EVENT_DAMAGE = "of the damage of the row's event and element"
    WORDS = "of a number inside a sentence"
    ESTIMATE = "itself an estimate of an error: may differ by its own size"


class Pane(StrEnum):
    """Where the page of the server shows a column."""

    ALWAYS = "always"
    MINOR = "minor"  #: In the narrow pane of Office only when it is asked for.
    WORKBOOK = "workbook"  #: Nowhere: it is in the workbook.


@dataclass(frozen=True)
class Field:
    """One input or output: a scalar of sheet `Case` or a column of a table."""

    name: str  #: Defined name of a scalar or header of a column, as in the contract.
    key: str  #: JSON key.
    #: ``number``, ``integer``, ``text``, ``choice``, ``station``, ``element``, ``material``
    #: (references by name); of results also ``flag`` (yes or nothing), ``switch`` (on or off),
    #: ``verdict``, ``sentence`` (takes the width that is left; another version may word it
    #: otherwise) and ``mixed`` (a number in one row, words in another).
    kind: str
    help: str  #: One sentence for the input prompt.
    dimension: str = "none"  #: Key of `DIMENSIONS`.
    unit_us: str = ""  #: Units shown by the two templates; empty where there is no unit. [unit]
    unit_si: str = ""  #: Likewise. [unit]
    #: Drop-down list of the unit cell; empty where there is no unit. [units]
    units: tuple[str, ...] = ()
    #: Allowed words of a choice, the first one the default; of a number, words in its place.
    choices: tuple[str, ...] = ()
    signed: bool = False  #: It may be negative, where other numbers of its dimension may not.
    default_text: str = (
        ""  #: What a blank cell means; empty where a blank has no meaning of its own.
    )
    group: str = ""  #: Block of sheet `Case` the scalar stands in; empty for columns.
    trace: Trace | None = None  #: Of a result: equation, source and the inputs it comes from.
    formula: str = ""  #: Live formula of its cells; empty where the calculation fills them.
    own_format: str = ""  #: Number format, where that of the dimension does not suit.
    width: float = 0.0  #: Of a column whose words wrap, as shipped; 0 = one line. [characters]
    unlimited: bool = False  #: No number means that there is no limit.
    wall_time: bool = False  #: No calculation gives it twice.
    error: ReportedError | None = None  #: Which reported error covers it; None = exact to rounding.
    share_of: str = ""  #: Column whose size the error is a share of; empty = its own.
    pane: Pane = Pane.ALWAYS  #: Where the page shows it.
    printed: str = ""  #: Header in a report, where the name needs its context.

    @property
    def attribute(self) -> str:
        """Name of the quantity in `engine.case.data` (`from` and `yield` get an underscore)."""
        return f"{self.key}_" if keyword.iskeyword(self.key) else self.key

    @property
    def name_in_words(self) -> str:
        """Name of a scalar as it is read: ``Rated power`` of ``RatedPower``."""
        return self.key.replace("_", " ").capitalize()

    @property
    def is_number(self) -> bool:
        """Whether a cell of this field holds a number."""
        return self.kind in ("number", "integer")

    @property
    def has_unit(self) -> bool:
        """Whether a unit stands above (column) or right of (scalar) it."""
        return bool(self.units)

    @property
    def is_sentence(self) -> bool:
        """Whether it takes the width that other columns leave."""
        return self.kind == "sentence" or (self.kind == "mixed" and bool(self.width))

    @property
    def format(self) -> str:
        """Number format of a result."""
        return self.own_format or DIMENSIONS[self.dimension].format

    @property
    def header(self) -> str:
        """Header in a report."""
        return self.printed or self.name

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
    json_only: tuple[Field, ...] = ()  #: Keys a JSON row may have beside the columns.
    #: Column without which a row of a workbook states nothing and is passed over, such as rows
    #: shipped with names alone; empty = every filled row counts.
    states: str = ""
    caption: str = ""  #: Above the table, and its name in reports and comparisons.
    #: Another table stands close to its right: the caption stands alone.
    short_caption: bool = False
    #: Columns that name a row; empty = rows are matched by their order.
    row_name: tuple[str, ...] = ()
    #: Columns whose changes `diff` shows unless all are asked for.
    changes_shown: tuple[str, ...] = ()
    room: int = 0  #: Rows kept free above what stands below it; 0 = nothing does. [count]
    #: Its numbers come from the run in time; the others from linear algebra alone.
    of_the_start: bool = False
    worded: bool = False  #: Another version may word or order its rows otherwise.
    #: Place among the results in which engineers ask for them: verdicts, frequencies, margins, steady
    #: state, start-up, reversals, starts, then what explains them; None = at the end.
    rank: int | None = None
    filtered: bool = False  #: Shipped with the buttons of a filter.
    #: Templates of earlier versions lack it: a workbook without it is read as one where it is blank.
    later: bool = False
    workbook_only: bool = False  #: The JSON has none of it: maps, and numbers behind charts.

    @property
    def every_column(self) -> tuple[Field, ...]:
        """Columns in the order of the workbook, a repeated one once."""
        repeated = () if self.repeated is None else (self.repeated,)
        return (*self.columns, *repeated, *self.extra_columns)

    @property
    def written_columns(self) -> tuple[Field, ...]:
        """Columns in the workbook that the product writes; the others are formulas."""
        repeated = () if self.repeated is None else range(1, SHAPE_COLUMNS + 1)
        return (*self.columns, *(self.repeated_column(k) for k in repeated))

    @property
    def workbook_columns(self) -> tuple[Field, ...]:
        """All columns of the table as it is in the workbook."""
        return (*self.written_columns, *self.extra_columns)

    def below(self, row: int) -> int:
        """First row below the room of the table, whose caption stands in a row, counted from 1."""
        return row + 3 + self.room + 1

    @property
    def judges(self) -> bool:
        """Whether its rows are checks, the numbers of each in a dimension of their own."""
        return any(field.key == "check" for field in self.columns)

    @property
    def says_unlimited(self) -> bool:
        """Whether its JSON rows tell unlimited starts from those not judged."""
        return any(field.key == "unlimited" for field in self.json_only)

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


def _field(
    name: str,
    help: str,
    equation: str,
    source: str,
    *,
    of_row: tuple[str, ...] = (),
    of_case: tuple[str, ...] = (),
    format: str = "",
    **more: Any,
) -> Field:
    """A field whose key follows from its name, with the trace of a result."""
    if equation:
        more["trace"] = Trace(equation, source, of_row, of_case)
    return Field(
        **{"name": name, "key": json_key(name), "help": help, "own_format": format, **more}
    )


def number(
    name: str,
    dimension: str,
    help: str,
    equation: str = "",
    source: str = "",
    *,
    blank: str = "",
    us: str = "",
    si: str = "",
    **more: Any,
) -> Field:
    """A number.

    Parameters
    ----------
    name : str
        Header or defined name. [name]
    dimension : str
        Key of `DIMENSIONS`. [word]
    help : str
        One sentence. [sentence]
    equation, source : str, optional
        Of a result, see `Trace`; with `of_row` and `of_case` it is the trace. [text]
    blank : str, optional
        What a blank means. [sentence]
    us, si : str, optional
        Units of the templates, where those of the dimension do not suit. [units]
    **more
        What else it states, see `Field`.

    Returns
    -------
    Field
    """
    usual = DIMENSIONS.get(dimension)
    if usual is None:
        raise IncompleteRecord(
            f"column {name} has the unknown dimension {dimension!r}: add it to DIMENSIONS in "
            "addin/contract/field.py"
        )
    units = {"unit_us": us or usual.unit_us, "unit_si": si or usual.unit_si, "units": usual.units}
    plain = {"kind": "number", "dimension": dimension, "default_text": blank, **units}
    return _field(name, help, equation, source, **plain | more)


def integer(name: str, help: str, equation: str = "", source: str = "", **more: Any) -> Field:
    """A whole number without unit."""
    return number(name, "count", help, equation, source, kind="integer", **more)


def text(
    name: str,
    help: str,
    equation: str = "",
    source: str = "",
    *,
    kind: str = "text",
    blank: str = "",
    **more: Any,
) -> Field:
    """Words: free text, a choice, or the name of a station, element or material; see `number`."""
    return _field(name, help, equation, source, kind=kind, default_text=blank, **more)


def choice(name: str, choices: tuple[str, ...], help: str, *, blank: str = "") -> Field:
    """A word from a short list, the default first."""
    return text(name, help, kind="choice", choices=choices, blank=blank)


#: A result that is yes or nothing.
flag = partial(text, kind="flag")
#: A result that is on or off.
switch = partial(text, kind="switch")
#: A verdict, coloured where it stands.
verdict = partial(text, kind="verdict")
#: A result in words, as long as it needs to be.
sentence = partial(text, kind="sentence")
#: A result that is a number in one row and words in another.
mixed = partial(text, kind="mixed")


#: Beside numbers of starts in a JSON row: that there is no limit, and whether there is an answer.
UNLIMITED = flag("unlimited", "No damage: unlimited starts.")
JUDGED = flag("judged", "Whether the starts were judged.")


def table(
    name: str, *, sheet: str, help: str, columns: Sequence[Field], rows: int = 1, **more: object
) -> TableSpec:
    """A table whose key follows from its name; see `TableSpec`."""
    return TableSpec(name, json_key(name), sheet, tuple(columns), rows, help, **more)  # type: ignore[arg-type]


def complete(tables: Sequence[TableSpec], where: str, *, results: bool) -> None:
    """Refuse tables that lack what is derived from them.

    Parameters
    ----------
    tables : sequence of TableSpec
        Records.
    where : str
        File in which they stand. [path]
    results : bool
        Whether they hold results, whose columns have a trace. [flag]

    Raises
    ------
    IncompleteRecord
        For the first thing that is missing: what, and where to add it.
    """
    for spec in tables:
        if not spec.caption:
            raise IncompleteRecord(f"table {spec.name} has no caption: add one in {where}")
        names = [field.name for field in spec.every_column]
        for name in dict.fromkeys(names):
            if names.count(name) > 1:
                raise IncompleteRecord(
                    f"table {spec.name} has two columns {name}: rename one in {where}"
                )
        for field in spec.every_column:
            if results and field.trace is None:
                raise IncompleteRecord(
                    f"column {field.name} of table {spec.name} has no equation and source: add them in "
                    f"{where} (after its help text)"
                )
            if not field.help:
                raise IncompleteRecord(
                    f"column {field.name} of table {spec.name} has no help text: add one in {where}"
                )
            _known(field.share_of, names, f"share_of of column {field.name}", spec, where)
        for field in spec.extra_columns:
            if not field.formula:
                raise IncompleteRecord(
                    f"extra column {field.name} of table {spec.name} has no formula: add one in {where}"
                )
        for attribute in ("row_name", "changes_shown"):
            for name in getattr(spec, attribute):
                _known(name, names, attribute, spec, where)
        _known(spec.states, names, "states", spec, where)


def _known(name: str, names: Sequence[str], attribute: str, spec: TableSpec, where: str) -> None:
    if name and name not in names:
        raise IncompleteRecord(
            f"table {spec.name} has no column {name}, which its {attribute} names: correct it in {where}"
        )
