"""A case as typed → `CaseData`: units resolved, per unit and percent of what they refer to.

The workbook and the JSON reader both end here, so that a number means the same in both. Rows are
counted as in `CaseData` (blank rows left out); the readers know which row that is for the engineer.
"""

from __future__ import annotations

import re
from collections import Counter, defaultdict
from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, TypeGuard

from addin.contract.problems import CellProblem, as_seen, nearest, printable, shortened
from addin.contract.tables import (
    INPUT_TABLES,
    SCALAR_TABLE,
    SCALARS,
    STUDY_INPUT_TABLES,
    Field,
    TableSpec,
    input_table,
)
from addin.contract.units import (
    BASE_IMPEDANCE,
    RATED_TORQUE,
    STATION_SPEED,
    SYNCHRONOUS_SPEED,
    TRANSMITTED_TORQUE,
    UnitScale,
)
from engine.case.case import Case
from engine.case.checks.find_problems import find_problems
from engine.case.checks.problem import blank_or_positive
from engine.case.data import GROUND, TABLES, CaseData, MotorDataRow, Ratings
from engine.case.study_inputs import StudyInputs
from engine.errors import Problem, Quoted

#: Longest name, title or remark. [characters]
LONGEST_WORDS = 1_000
#: Most rows of a table, far more than any train has; stations and elements are checked against each other, torques
#: against time are recorded.
MOST_ROWS, MOST_PARTS, MOST_TIMES = 20_000, 2_000, 100_000
_HALF_CHARACTERS = re.compile("[\ud800-\udfff]")

#: Table (``Case`` for a scalar), row of `CaseData` counted from 1 or None, column or scalar.
Place = tuple[str, int | None, str]


@dataclass(frozen=True)
class Typed:
    """A number with its unit."""

    number: float  #: As typed. [its unit]
    scale: UnitScale  #: What one such unit is worth. [scale]
    unit: str  #: The unit as typed. [unit]

    def __str__(self) -> str:
        return f"{self.number:.10g} {'' if self.unit == '1' else self.unit}".rstrip()


Entry = Typed | str


@dataclass
class TypedCase:
    """Everything typed; a blank has no entry."""

    scalars: dict[str, Entry] = field(default_factory=dict)  #: By defined name.
    #: By table name; each row by column header.
    tables: dict[str, list[dict[str, Entry]]] = field(default_factory=dict)

    def entry(self, place: Place) -> Entry | None:
        """What was typed in one place.

        Parameters
        ----------
        place : tuple
            Table, row (None for a scalar), column. [names]

        Returns
        -------
        Entry or None
            None for a blank.
        """
        table, row, column = place
        if row is None:
            return self.scalars.get(column) if table == SCALAR_TABLE else None
        rows = self.tables.get(table, [])
        return rows[row - 1].get(column) if row <= len(rows) else None


class Findings:
    """Problems found so far, and the places nothing more shall be said of."""

    def __init__(self) -> None:
        self.problems: list[Problem] = []
        #: Every place that is noted or silenced.
        self.bad: set[Place] = set()

    def add(self, place: Place, found: object, allowed: str, message: str) -> None:
        """Note a problem.

        Parameters
        ----------
        place : tuple
            Table, row, column. [names]
        found : object
            What was found. [as typed]
        allowed : str
            What would be accepted. [words]
        message : str
            What is wrong and what to do. [sentence]
        """
        self.problems.append(Problem(*place, found, allowed, message))
        self.bad.add(place)

    def silence(self, *places: Place) -> None:
        """Say nothing more of places whose cause is already noted."""
        self.bad.update(places)

    def without(self, renewed: Callable[[Place], bool] = lambda place: False) -> Findings:
        """A copy, without what is noted of places that are typed anew."""
        copy = Findings()
        for problem in self.problems:
            if not renewed((problem.table, problem.row, problem.column)):
                copy.problems.append(problem)
        if copy.problems:  # places are silent because of these alone
            copy.bad = {place for place in self.bad if not renewed(place)}
        return copy


@dataclass(frozen=True)
class StudiesRead:
    """What is typed on the study sheets."""

    inputs: StudyInputs  #: What could be read. [SI]
    tables: frozenset[str]  #: Study tables that the input has.
    problems: tuple[Problem, ...]  #: Cells that cannot be read; checks of a study come on top.
    warnings: tuple[str, ...]  #: What the engineer should know.
    bad: frozenset[Place]  #: Places of which nothing more is to be said. [places]
    locate: Callable[[Problem], CellProblem]  #: A problem with its cell and the number as typed.
    typed: TypedCase  #: Every entry of the study tables. [as typed]
    findings: Findings  #: Cells that the reader could not read.

    def problems_of(
        self, tables: Collection[str], checked: Collection[Problem] = ()
    ) -> tuple[CellProblem, ...]:
        """Everything wrong in some of the tables, in the order of the tables."""
        unread = [problem for problem in self.problems if problem.table in tables]
        more = [p for p in checked if (p.table, p.row, p.column) not in self.bad]
        order = {spec.name: i for i, spec in enumerate(STUDY_INPUT_TABLES)}
        both = sorted((*unread, *more), key=lambda p: (order.get(p.table, -1), p.row or 0))
        return tuple(self.locate(problem) for problem in both)


@dataclass(frozen=True)
class CaseInput:
    """A case as read, from a workbook or from JSON."""

    data: CaseData  #: What could be read. [SI]
    #: Everything wrong; the case may be calculated when it is empty.
    problems: tuple[CellProblem, ...]
    warnings: tuple[str, ...]  #: What the engineer should know.
    typed: TypedCase  #: Every entry with its unit as typed. [as typed]
    #: What is typed on the study sheets; None where there are none. [SI]
    studies: StudiesRead | None = field(default=None, kw_only=True)
    #: Cells that the reader could not read: what stays wrong where other inputs are changed.
    findings: Findings = field(default_factory=Findings, kw_only=True, repr=False, compare=False)

    def case(self) -> Case:
        """The checked case.

        Returns
        -------
        Case
            Ready to be calculated. [SI]

        Raises
        ------
        CaseError
            When the engine finds problems; those of single cells are in `problems` only.
        """
        return Case(**vars(self.data))


def all_problems(data: CaseData, findings: Findings) -> list[Problem]:
    """What the reader found and what the engine finds, in the order of the tables.

    Parameters
    ----------
    data : CaseData
        The case as far as it could be read. [SI]
    findings : Findings
        Of the reader. [problems]

    Returns
    -------
    list of Problem
        Rows counted as in `data`.
    """
    problems = [*findings.problems, *find_problems(data, frozenset(findings.bad))]
    order = {spec.name: i for i, spec in enumerate(INPUT_TABLES)}
    return sorted(problems, key=lambda p: (order.get(p.table, -1), p.row or 0))


def in_typed_units(problem: Problem, typed: TypedCase) -> Problem:
    """A problem of the engine with the number in the unit in which it was typed.

    Parameters
    ----------
    problem : Problem
        With the number in SI. [SI]
    typed : TypedCase
        Everything typed. [as typed]

    Returns
    -------
    Problem
        ``found -12 lbf*in/rad = -1.36 N m/rad; it must be positive. ...``
    """
    entry = typed.entry((problem.table, problem.row, problem.column))
    for quoted in problem.quoted:
        problem = _quoted_as_typed(problem, quoted, entry, typed)
    if not isinstance(entry, Typed) or not isinstance(problem.found, (int, float)):
        return problem
    if entry.scale == UnitScale(1.0):
        return replace(problem, found=str(entry) if entry.unit else entry.number)
    head, message = f"found {entry}", problem.message
    if not message.startswith((f"{head};", f"{head},")):
        message = message.replace("found ", f"{head} = ", 1)
    return replace(problem, found=str(entry), message=message)


def _quoted_as_typed(
    problem: Problem, quoted: Quoted, own: Entry | None, typed: TypedCase
) -> Problem:
    """Another quantity of the sentence as it was typed, or else in the unit of what was found."""
    there = None if quoted.place is None else typed.entry(quoted.place)
    if isinstance(there, Typed):
        shown = "" if there.scale == UnitScale(1.0) else str(there)
    elif isinstance(own, Typed) and own.scale != UnitScale(1.0) and _is_number(problem.found):
        # of the kind of what was found, so that their ratio is the same in every unit
        shown = f"{quoted.value * own.number / problem.found:.6g} {own.unit}".rstrip()
    else:
        shown = ""
    if not shown:
        return problem
    alone = re.compile(rf"(?<![\d.]){re.escape(quoted.text)}(?![\w/])")
    return replace(
        problem,
        allowed=alone.sub(lambda _: shown, problem.allowed),
        message=alone.sub(lambda _: shown, problem.message),
    )


def _is_number(value: object) -> TypeGuard[float]:
    return isinstance(value, (int, float)) and not isinstance(value, bool) and value != 0


# --- words --------------------------------------------------------------------------------------


def word_entry(text: str, spec: Field, place: Place, findings: Findings) -> str | None:
    """A word or name as the engine wants it.

    Returns
    -------
    str or None
        Trimmed; a choice in the spelling of the list; None for a blank or a wrong choice.
    """
    text = text.replace("\u00a0", " ").strip()
    if not text:
        return None
    if len(text) > LONGEST_WORDS:
        findings.add(
            place,
            shortened(text),
            f"at most {LONGEST_WORDS} characters",
            f"found a text of {len(text)} characters, '{shortened(printable(text[:60]), 40)}'; "
            f"the limit is {LONGEST_WORDS}. Shorten it.",
        )
        return None
    text = _HALF_CHARACTERS.sub("\ufffd", text)  # JSON may hold them, no file nor screen can
    if spec.kind == "station" and spec.name in ("From", "To") and _name_key(text) == GROUND:
        return GROUND
    if spec.kind != "choice":
        return text
    folded = {_folded(choice): choice for choice in spec.choices}
    if _folded(text) in folded:
        return folded[_folded(text)]
    allowed = "one of " + ", ".join(spec.choices)
    text = shortened(text)
    meant = nearest(text, spec.choices)
    advice = f"Did you mean '{meant}'?" if meant else "Choose from the list."
    findings.add(place, text, allowed, f"found '{text}'; it must be {allowed}. {advice}")
    return None


def word_in_place(value: object, spec: Field) -> str | None:
    """The word that may stand in the place of a number.

    Returns
    -------
    str or None
        In the spelling of the list; None for anything else.
    """
    if not spec.choices or not isinstance(value, str):
        return None
    return {_folded(word): str(word) for word in spec.choices}.get(_folded(value))


def too_many_rows(table: str, count: int, findings: Findings) -> bool:
    """Whether a table has more rows than are read; noted if so."""
    most = {"Stations": MOST_PARTS, "Elements": MOST_PARTS, "TorqueTime": MOST_TIMES}.get(
        table, MOST_ROWS
    )
    if count <= most:
        return False
    findings.add(
        (table, None, ""),
        count,
        f"at most {most} rows",
        f"the table has {count} rows; the limit is {most}. Delete rows that are not needed.",
    )
    return True


def _folded(word: str) -> str:
    """A choice without capitals, what nobody sees, and hyphens of any kind."""
    for dash in "-‐‑–—−":
        word = word.replace(dash, " ")
    return _name_key(word)


# --- numbers ------------------------------------------------------------------------------------


@dataclass(frozen=True)
class PerUnitBases:
    """What relative units refer to; None where it is not known."""

    rated_torque: float | None  #: Of `Ratings`. [N m]
    synchronous_speed: float | None  #: Of the reference shaft. [rad/s]
    ratios: Mapping[str | None, float]  #: Speed ratio of each station. [1]
    #: Impedance that is 1 per unit of the motor at each station. [ohm]
    impedances: Mapping[str | None, float | None] = field(default_factory=dict)

    def si(self, typed: Typed, station: str | None) -> float | None:
        """A typed number in SI, None if its base is not known.

        Parameters
        ----------
        typed : Typed
            The number. [as typed]
        station : str or None
            Whose speed a speed is compared with. [name]

        Returns
        -------
        float or None
            [SI]
        """
        number = typed.scale.to_si(typed.number)
        if typed.scale.base in ("", TRANSMITTED_TORQUE):
            return number
        if typed.scale.base == RATED_TORQUE:
            return None if self.rated_torque is None else number * self.rated_torque
        if typed.scale.base == BASE_IMPEDANCE:
            base = self.impedances.get(station)
            return number / base if base else None
        if self.synchronous_speed is None:
            return None
        if typed.scale.base == SYNCHRONOUS_SPEED:
            return number * self.synchronous_speed
        full = self.synchronous_speed * self.ratios.get(station, 0.0)
        return number / full if full > 0.0 else None


_NO_BASES = PerUnitBases(None, None, {})

#: Sizes in SI beyond which a number is a slip, and products of two would overflow.
_SMALLEST, _LARGEST = 1e-30, 1e30

#: Where a base comes from, and what to do when it is not known.
_SOURCES = {
    RATED_TORQUE: (
        ("RatedTorque", "RatedPower", "SynchronousSpeed", "LineFrequency", "Poles"),
        "per unit of RatedTorque, but RatedTorque is unknown. Type RatedTorque, or "
        "RatedPower and the speed, or give the torque in lbf*ft or N*m",
    ),
    SYNCHRONOUS_SPEED: (
        ("SynchronousSpeed", "LineFrequency", "Poles"),
        "relative to synchronous speed, which is unknown. Type SynchronousSpeed, or "
        "LineFrequency and Poles",
    ),
    BASE_IMPEDANCE: (
        (),
        "in ohm, but the rated voltage or apparent power of the motor is unknown. Type Voltage and "
        "Apparent power in its row of table MotorData, or give it in pu or %",
    ),
    STATION_SPEED: (
        ("SynchronousSpeed", "LineFrequency", "Poles"),
        "a speed, but synchronous speed is unknown. Type SynchronousSpeed, or LineFrequency "
        "and Poles, or give the speed in %",
    ),
}


def to_case_data(typed: TypedCase, findings: Findings) -> CaseData:
    """The case in SI.

    Parameters
    ----------
    typed : TypedCase
        Everything typed. [as typed]
    findings : Findings
        Takes every number that cannot be resolved. [problems]

    Returns
    -------
    CaseData
        Unchecked; unresolved numbers are left blank and noted in `findings`. [SI]
    """
    typed = with_names_as_defined(typed)
    absolute = {
        name: entry
        for name, entry in typed.scalars.items()
        if isinstance(entry, str) or not entry.scale.base
    }
    scalars = _scalars(absolute, _NO_BASES, findings)
    ratings = CaseData(**scalars).ratings  # type: ignore[arg-type]
    _refuse_circular(typed, findings)
    bases = PerUnitBases(
        ratings.rated_torque,
        ratings.synchronous_speed,
        ratios_of(typed),
        _base_impedances(typed, ratings.rated_power),
    )
    relative = {n: e for n, e in typed.scalars.items() if n not in absolute and n != "RatedTorque"}
    scalars |= _scalars(relative, bases, findings)
    _silence_followers(ratings, findings)
    tables = {
        spec.key: rows_in_si(spec, TABLES[spec.name][1], typed, bases, findings)
        for spec in INPUT_TABLES
    }
    _silence_meshes(typed, findings)
    _silence_references(typed, findings)
    return CaseData(**scalars, **tables)  # type: ignore[arg-type]


def with_names_as_defined(typed: TypedCase) -> TypedCase:
    """References to stations, elements and materials in the spelling of the row that defines them.

    A name that no row or more than one differs from by capitals or what nobody sees alone stays as it is typed.

    Parameters
    ----------
    typed : TypedCase
        Everything typed. [as typed]

    Returns
    -------
    TypedCase
        The same, with these words replaced. [as typed]
    """
    names = {kind: _by_folded_name(typed, *where) for kind, where in _REFERRED.items()}
    tables = dict(typed.tables)
    for spec in INPUT_TABLES:
        columns = [column for column in spec.columns if column.kind in names]
        if spec.name not in tables or not columns:
            continue
        tables[spec.name] = [
            row
            | {
                column.name: names[column.kind].get(_name_key(word), word)
                for column in columns
                if isinstance(word := row.get(column.name), str)
            }
            for row in typed.tables[spec.name]
        ]
    return replace(typed, tables=tables)


def _by_folded_name(typed: TypedCase, table: str, column: str) -> dict[str, str]:
    defined = [
        name for row in typed.tables.get(table, []) if isinstance(name := row.get(column), str)
    ]
    folded = Counter(map(_name_key, dict.fromkeys(defined)))
    return {_name_key(name): name for name in defined if folded[_name_key(name)] == 1}


def _name_key(name: str) -> str:
    """What two spellings of one name have in common."""
    return as_seen(name).casefold()


def _refuse_circular(typed: TypedCase, findings: Findings) -> None:
    """RatedTorque in per unit of itself."""
    entry = typed.scalars.get("RatedTorque")
    if isinstance(entry, Typed) and entry.scale.base:
        findings.add(
            (SCALAR_TABLE, None, "RatedTorque"),
            str(entry),
            "a torque in lbf*ft, N*m or the like",
            f"found {entry}; RatedTorque is the base of pu and % and needs a torque unit. Type it "
            "in lbf*ft or N*m.",
        )


def ratios_of(typed: TypedCase) -> dict[str | None, float]:
    """Speed ratio of each station, typed or filled through gears.

    Parameters
    ----------
    typed : TypedCase
        Everything typed. [as typed]

    Returns
    -------
    dict of str to float
        By station. [1]
    """
    typed = with_names_as_defined(
        replace(typed, tables={name: typed.tables.get(name, []) for name in _OF_RATIOS})
    )
    scratch = Findings()  # what cannot be read is noted when the tables are read with their bases
    tables = {
        spec.key: rows_in_si(spec, TABLES[spec.name][1], typed, _NO_BASES, scratch)
        for spec in map(input_table, _OF_RATIOS)
    }
    return CaseData(**tables).speed_ratios  # type: ignore[arg-type]


#: Tables that the speed ratios of stations follow from.
_OF_RATIOS = ("Stations", "Elements", "Meshes", "MotorTorque", "MotorData")


def _base_impedances(typed: TypedCase, rated_power: float | None) -> dict[str | None, float | None]:
    """What one per unit is in ohm, of the motor at each station."""
    spec = input_table("MotorData")
    motors = rows_in_si(
        spec, MotorDataRow, typed, _NO_BASES, Findings()
    )  # what is in ohm stays blank
    return {
        motor.station: motor.base_impedance(rated_power)
        for motor in motors
        if all(map(blank_or_positive, (motor.apparent_power, motor.voltage)))
    }


def _scalars(
    entries: Mapping[str, Entry], bases: PerUnitBases, findings: Findings
) -> dict[str, float | str | None]:
    values: dict[str, float | str | None] = {}
    for spec in SCALARS:
        if spec.name in entries:
            place = (SCALAR_TABLE, None, spec.name)
            entry = entries[spec.name]
            value = _value(entry, spec, place, bases, None, findings)
            if value is None and isinstance(entry, Typed) and place not in findings.bad:
                _note_unresolved([place], entry, findings)
            values[spec.attribute] = value
    return values


def rows_in_si(
    spec: TableSpec, row_class: type, typed: TypedCase, bases: PerUnitBases, findings: Findings
) -> tuple[Any, ...]:
    """The rows of one table in SI.

    Parameters
    ----------
    spec : TableSpec
        The table. [table]
    row_class : type
        Its rows.
    typed : TypedCase
        Everything typed. [as typed]
    bases : PerUnitBases
        What relative units refer to. [SI]
    findings : Findings
        Takes every number that cannot be resolved. [problems]

    Returns
    -------
    tuple
        Of `row_class`. [SI]
    """
    unresolved: dict[str, list[Place]] = defaultdict(list)
    rows = []
    for number, entries in enumerate(typed.tables.get(spec.name, []), start=1):
        values: dict[str, float | str | None] = {}
        station = entries.get("Station")
        for column in spec.columns:
            if column.name not in entries:
                continue
            entry, place = entries[column.name], (spec.name, number, column.name)
            where = station if isinstance(station, str) else None
            value = _value(entry, column, place, bases, where, findings)
            if value is None and place not in findings.bad:
                unresolved[column.name].append(place)
            values[_attribute(column, entry)] = value
        rows.append(row_class(**values))
    for places in unresolved.values():
        first = typed.entry(places[0])
        assert isinstance(first, Typed)
        _note_unresolved(places, first, findings, bases)
    return tuple(rows)


def _attribute(column: Field, entry: Entry) -> str:
    """A torque given as a share of the transmitted torque has a field of its own."""
    if isinstance(entry, Typed) and entry.scale.base == TRANSMITTED_TORQUE:
        return "torque_share"
    return column.attribute


def _value(
    entry: Entry,
    spec: Field,
    place: Place,
    bases: PerUnitBases,
    station: str | None,
    findings: Findings,
) -> float | str | None:
    """One entry in SI; None when it cannot be resolved."""
    if isinstance(entry, str):
        return entry
    value = bases.si(entry, station)
    if value is None:
        return None
    if value and not _SMALLEST <= abs(value) <= _LARGEST:
        findings.add(
            place,
            str(entry),
            "a quantity of this world",
            f"found {entry}, which is out of range for a train. Correct the number or its unit.",
        )
        return None
    if spec.kind != "integer":
        return value
    if value == round(value):
        return int(value)
    findings.add(
        place,
        entry.number,
        "a whole number",
        f"found {entry}; it must be a whole number. Correct it.",
    )
    return None


def _note_unresolved(
    places: list[Place], entry: Typed, findings: Findings, bases: PerUnitBases = _NO_BASES
) -> None:
    """One problem for all cells of a column that refer to something unknown."""
    names, sentence = _SOURCES[entry.scale.base]
    reported = any((SCALAR_TABLE, None, name) in findings.bad for name in names)
    station_unknown = entry.scale.base == STATION_SPEED and bases.synchronous_speed is not None
    if reported or station_unknown:  # the cause has, or will have, a sentence of its own
        findings.silence(*places)
        return
    others = f" (and {len(places) - 1} more rows of this column)" if len(places) > 1 else ""
    findings.add(
        places[0],
        str(entry),
        f"a number whose reference ({entry.scale.base}) is known",
        f"found {entry}{others}; it is {sentence}.",
    )
    findings.silence(*places[1:])


# --- what follows from a cell that could not be read ----------------------------------------------

_RATINGS = ("LineFrequency", "SynchronousSpeed", "Poles")
#: A cell that could not be read → cells that would be called blank or contradictory because of it.
_FOLLOWERS = {
    ("Elements", "OD"): ("Stiffness", "Density"),
    ("Elements", "Length"): ("Stiffness", "Density"),
    ("Elements", "Shear modulus"): ("Stiffness",),
    ("Elements", "Kind"): ("Stiffness", "To"),
    ("Excitations", "Frequency"): ("Order",),
    ("Meshes", "Mesh stiffness"): ("Backlash",),
    ("MotorEvents", "Clears after"): ("Earliest clearing", "Latest clearing"),
}
#: Kind of a reference → the column it refers to.
_REFERRED = {
    "station": ("Stations", "Station"),
    "element": ("Elements", "Element"),
    "material": ("Materials", "Material"),
}


def _silence_followers(ratings: Ratings, findings: Findings) -> None:
    """Nothing is said of what is only missing because another cell could not be read."""
    bad = list(findings.bad)
    for table, row, column in bad:
        followers = _FOLLOWERS.get((table, column), ())
        findings.silence(*((table, row, follower) for follower in followers))
    if ratings.synchronous_speed is None and any(b[2] in _RATINGS for b in bad):
        findings.silence(*((SCALAR_TABLE, None, name) for name in _RATINGS))


#: Columns of `Meshes` that need the Stiffness of their element in table `Elements`.
_NEED_STIFFNESS = ("Mesh stiffness", "Mesh damping", "Backlash", "Angular backlash")


def _silence_meshes(typed: TypedCase, findings: Findings) -> None:
    """A stiffness that could not be read is not called blank by the mesh data of its element."""
    elements = typed.tables.get("Elements", [])
    names = {
        elements[row - 1].get("Element")
        for table, row, column in findings.bad
        if (table, column) == ("Elements", "Stiffness") and row is not None
    }
    for row, entries in enumerate(typed.tables.get("Meshes", []), start=1):
        if entries.get("Element") in names:
            findings.silence(*(("Meshes", row, column) for column in _NEED_STIFFNESS))


def _silence_references(typed: TypedCase, findings: Findings) -> None:
    """When names could not be read, nothing is said of references to names."""
    for kind, (table, column) in _REFERRED.items():
        if any(bad[0] == table and bad[2] in (column, "") for bad in findings.bad):
            findings.silence(*_references(typed, kind))


def _references(typed: TypedCase, kind: str) -> Iterator[Place]:
    for spec in INPUT_TABLES:
        for row in range(1, len(typed.tables.get(spec.name, [])) + 1):
            for column in spec.columns:
                if column.kind == kind:
                    yield spec.name, row, column.name
