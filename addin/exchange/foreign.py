"""A train as another file has it: its rows, where each stands there, what was left out and why."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from addin.contract.problems import CellProblem, printable, shortened
from addin.contract.tables import input_table

#: A row of a case JSON: a number is in SI, a text carries its unit.
Row = dict[str, Any]


class ForeignError(Exception):
    """A file that holds no train that can be read; the sentence says why and what to do."""


@dataclass
class ForeignTrain:
    """Rows for the input tables, taken from a file of another program."""

    kind: str  #: What the file is, in words.
    tables: dict[str, list[Row]] = field(default_factory=dict)  #: By table name. [as typed]
    #: Where a row stands in the file, by table and number of the row. [words]
    places: dict[tuple[str, int], str] = field(default_factory=dict)
    #: What was read, in what units; what was assumed; what was left out and why. [sentences]
    notes: list[str] = field(default_factory=list)
    problems: list[CellProblem] = field(default_factory=list)  #: What cannot be read.

    def add(self, table: str, row: Row, place: str) -> None:
        """Add a row, with its place in the file; what is None is left out.

        Parameters
        ----------
        table : str
            Input table. [name]
        row : dict
            By JSON key. [as typed]
        place : str
            Where it stands. [words]
        """
        rows = self.tables.setdefault(table, [])
        rows.append({key: value for key, value in row.items() if value is not None})
        self.places[table, len(rows)] = place

    def refuse(self, place: str, found: object, allowed: str, message: str) -> None:
        """Note what cannot be read.

        Parameters
        ----------
        place : str
            Where it stands. [words]
        found : object
            What stands there. [as typed]
        allowed : str
            What would be accepted. [words]
        message : str
            What is wrong and what to do. [sentence]
        """
        sentence = printable(f"{place[:1].upper()}{place[1:]}: {message}")
        self.problems.append(CellProblem("", "", None, place, found, allowed, sentence))

    def content(self) -> dict[str, Any]:
        """The train as a case JSON."""
        return {input_table(name).key: rows for name, rows in self.tables.items()}


def number_of(
    train: ForeignTrain,
    thing: Mapping[str, Any],
    key: str,
    place: str,
    default: float | None = None,
) -> float:
    """A finite number of an object of a JSON or TOML file; one that is missing is noted.

    Parameters
    ----------
    train : ForeignTrain
        Takes the problem.
    thing : mapping
        The object. [as typed]
    key : str
        The key. [name]
    place : str
        Where the object stands. [words]
    default : float, optional
        What a missing key means. [unit of the file]

    Returns
    -------
    float
        0 where it cannot be read. [unit of the file]
    """
    value = thing.get(key, default)
    if isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value):
        return float(value)
    shown = "is missing" if value is None else f"is {shortened(repr(value))}"
    train.refuse(place, shown, "a number", f"{key} {shown}; it must be a number. Correct the file.")
    return 0.0


def counted(count: int, one: str, many: str = "") -> str:
    """A count with its noun: ``1 disk``, ``3 disks``."""
    return f"{count:,} {one if count == 1 else many or one + 's'}"
