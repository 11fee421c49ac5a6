"""Names and units above the columns of a table of text, as makers and engineers write them."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from addin.contract.tables import Field, TableSpec
from addin.contract.units import UnitError, parse_unit

#: Columns that a table of text may have and no input table has.
NUMBER, SPEED = "No.", "Speed"
#: Other names of columns, folded as `folded` does: what makers write above them.
ALIASES: Mapping[str, tuple[str, ...]] = {
    "Station": ("name", "item", "mass", "disk", "machine", "component", "part"),
    NUMBER: ("no", "nr", "number", "node", "stationno", "massno", "stationnumber", "#"),
    "Description": ("remark", "remarks", "comment"),
    "Inertia": (
        "j", "ip", "jp", "wr2", "wk2", "mr2", "gd2", "massinertia", "polarinertia", "momentofinertia",
        "massmomentofinertia", "polarmomentofinertia", "polarmassmomentofinertia",
    ),
    "Speed ratio": ("ratio",),
    SPEED: ("rpm", "n"),
    "Element": ("shaft", "shaftname", "elementname", "spring"),
    "Kind": ("type",),
    "From": ("fromstation", "start", "node1", "station1"),
    "To": ("tostation", "end", "node2", "station2"),
    "Stiffness": ("k", "kt", "torsionalstiffness", "torsionalrigidity", "springrate", "springconstant"),
    "OD": ("outerdiameter", "outsidediameter", "diameter", "dia", "da"),
    "ID": ("innerdiameter", "insidediameter", "bore", "di"),
    "Length": ("l",),
    "Shear modulus": ("g",),
    "Density": ("rho",),
}  # fmt: skip
#: Headers that measure an inertia by a weight: their name belongs to the unit (J = GD²/4).
_MEASURES = {"wr2": "WR2", "wk2": "WK2", "mr2": "MR2", "gd2": "GD2"}
_IN_BRACKETS = re.compile(r"(.*?)[\s,]*[\[(](.*)[\])]\s*", re.DOTALL)
_SUPERSCRIPTS = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹", "0123456789")
#: A mass in the place of a force, as makers write stiffness: kg-m/rad.
_MASS = re.compile(r"(?<![A-Za-z])kg(?![A-Za-z])")


@dataclass(frozen=True)
class Header:
    """What stands above one column."""

    index: int  #: Column of the text, counted from 0.
    text: str  #: As it stands there.
    name: str  #: Column of the input table, `NUMBER` or `SPEED`.
    unit: str = ""  #: As it stands there; blank where there is none. [unit]


def folded(name: str) -> str:
    """A name without capitals, blanks, dots and dashes; powers as digits."""
    return re.sub(r"[^a-z0-9#]", "", name.translate(_SUPERSCRIPTS).casefold())


def known_names(specs: Sequence[TableSpec]) -> dict[str, str]:
    """Folded name → column, of the columns of some input tables and what else a table may have.

    Parameters
    ----------
    specs : sequence of TableSpec
        The tables; of two columns of one name the first counts. [tables]

    Returns
    -------
    dict of str to str
        By folded name.
    """
    columns = [column.name for spec in specs for column in spec.columns]
    names = {folded(name): name for name in (*reversed(columns), NUMBER, SPEED)}
    for name, aliases in ALIASES.items():
        if name in columns or name in (NUMBER, SPEED):
            names |= {alias: name for alias in aliases if alias not in names}
    return names


def header_of(index: int, text: str, names: Mapping[str, str]) -> Header | None:
    """What a cell above a column says: its name, and its unit in brackets or behind a comma.

    Parameters
    ----------
    index : int
        Column, counted from 0. [count]
    text : str
        The cell. [text]
    names : mapping of str to str
        Of `known_names`.

    Returns
    -------
    Header or None
        None for a name that is not known.
    """
    bracket = _IN_BRACKETS.fullmatch(text)
    name, unit = bracket.groups() if bracket else (text, "")
    if not bracket and "," in text:
        name, unit = text.split(",", 1)
    column = names.get(folded(name))
    if column is None:
        return None
    measure = _MEASURES.get(folded(name), "")
    unit = unit.strip()
    return Header(index, text.strip(), column, f"{measure} {unit}" if measure and unit else unit)


def unit_of(header: Header, field: Field) -> str:
    """The unit of a column as the readers of a case take it.

    Parameters
    ----------
    header : Header
        Of the column.
    field : Field
        Of the input table.

    Returns
    -------
    str
        The same unit; kg in the place of a force is kgf. [unit]

    Raises
    ------
    UnitError
        If it is no unit of the quantity.
    """
    try:
        parse_unit(header.unit, field.dimension)
    except UnitError:
        if field.dimension == "inertia":
            raise
        force = _MASS.sub("kgf", header.unit)
        parse_unit(force, field.dimension)
        return force
    return header.unit
