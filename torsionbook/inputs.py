"""An input: read from a workbook, a case JSON or frames; looked at, changed by name, checked, written."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from os import PathLike
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Protocol, TypeAlias, TypeGuard

from addin.contract.shipped import template_folder, template_path
from addin.contract.tables import EVERY_INPUT, SCALARS, STUDY_INPUT_TABLES, TableSpec
from addin.reading.case_json import case_to_json, read_case_json, typed_input, typed_rows
from addin.reading.input_names import NamedInput, WrongName, entry_of, named_input
from addin.reading.one_file import Unreadable, read_checked
from addin.reading.typed_case import CaseInput, Findings, Place, TypedCase
from addin.studies.check_input import check_input
from addin.template.filled import MixedUnits, example_of
from addin.xlsx.temporary import temporary_folder
from addin.xlsx.whole_files import write_json, write_whole
from torsionbook.frames import Tables, plain, rows_of, table_called
from torsionbook.problems import InputError, Problem, records, refuse

if TYPE_CHECKING:
    pass

#: A value of an input: a number in SI, a text with its unit such as ``"20 MN*m/rad"``, a word, None = blank.
Value: TypeAlias = "float | int | str | None"


class OpenpyxlWorkbook(Protocol):
    """What is needed of a workbook of openpyxl, which brings no types of its own."""

    def save(self, filename: Any) -> None:
        """Write it to a file."""


#: What `read` takes.
Source: TypeAlias = "str | PathLike[str] | Mapping[str, Any] | Input | OpenpyxlWorkbook"

_STUDY_TABLES = frozenset(spec.name for spec in STUDY_INPUT_TABLES)


def template(name: str = "blank_us") -> Path:
    """The path of a shipped workbook, to be copied or read.

    Parameters
    ----------
    name : str, optional
        ``blank_us``, ``blank_si``, or an example: ``example_proposed`` and ``example_modified`` (the two
        designs of the paper), ``example_backlash``, ``example_motor``, ``example_studies``. [name]

    Returns
    -------
    Path
        The file. It belongs to the installation: copy it, do not write into it.

    Raises
    ------
    LookupError
        If there is none of that name; the sentence lists those there are.

    Examples
    --------
    >>> import torsionbook as tb
    >>> tb.template("blank_si").name
    'blank_si.xlsx'
    """
    names = sorted(path.stem for path in template_folder().glob("*.xlsx"))
    if name not in names:
        raise LookupError(f"There is no shipped workbook '{name}'. There are {', '.join(names)}.")
    return template_path(f"{name}.xlsx")


@dataclass(frozen=True)
class Check:
    """What is to be said of an input before it is calculated: the answer of `Input.check`."""

    problems: tuple[
        Problem, ...
    ]  #: Everything wrong, study tables included; empty = it can be calculated.
    notes: tuple[str, ...]  #: What looks like a slip of unit, column or row. [sentences]
    full_speed: str  #: The train at full speed in words; empty where something is wrong.
    not_available: tuple[
        str, ...
    ]  #: Answers that cannot be given, and the input each lacks. [sentences]


@dataclass(frozen=True, repr=False, eq=False)
class Input(Tables):
    """Everything that is stated of a train. It does not change: `change` gives a new one.

    Made by `read`.
    """

    _specs = EVERY_INPUT
    _kind = "input table"

    _read: CaseInput = field(repr=False)

    def __repr__(self) -> str:
        rows = {name: len(self.rows(name)) for name in ("Stations", "Elements")}
        what = f"{len(self.problems)} problems" if self.problems else "no problems"
        title = self.scalars.get("Title", "")
        return (
            f"<Input '{title}': {rows['Stations']} stations, {rows['Elements']} elements, {what}>"
        )

    def _records(self, spec: TableSpec) -> Sequence[Mapping[str, Any]]:
        return self.to_json().get(spec.key, ())  # type: ignore[no-any-return]

    # ---- looking -------------------------------------------------------------------------------

    @property
    def problems(self) -> tuple[Problem, ...]:
        """Everything wrong with the case, study tables apart; empty = it can be calculated."""
        return records(self._read.problems)

    @property
    def warnings(self) -> tuple[str, ...]:
        """What the reader noted. [sentences]"""
        return self._read.warnings

    @property
    def scalars(self) -> Mapping[str, float | int | str]:
        """Scalars that are stated, by name. [SI]"""
        data = self._read.data
        values = {spec.name: getattr(data, spec.attribute) for spec in SCALARS}
        return MappingProxyType({name: v for name, v in values.items() if v is not None})

    def value(self, name: str) -> Value:
        """One input by its name.

        Parameters
        ----------
        name : str
            As in `change`. [name]

        Returns
        -------
        float, int, str or None
            None for a blank. [SI]
        """
        try:
            named = named_input(name, self._typed(), EVERY_INPUT)
        except WrongName as wrong:
            raise LookupError(f"'{name}': {wrong}") from None
        table, row, _ = named.place
        if row is None:
            return self.scalars.get(named.spec.name)
        return self.rows(table)[row - 1].get(named.spec.key)

    def check(self) -> Check:
        """What ``torsionbook check`` says: problems, slips, answers that cannot be given. Nothing is calculated in time."""
        found = check_input(self._read)
        return Check(records(found.problems), found.notes, found.full_speed, found.open_answers)

    def to_json(self) -> dict[str, Any]:
        """The case as object of the case JSON. [SI]"""
        return case_to_json(self._read.data, self._read.studies)

    # ---- changing ------------------------------------------------------------------------------

    def change(self, changes: Mapping[str, Any]) -> Input:
        """The same input with some of it changed.

        Parameters
        ----------
        changes : mapping
            By name: a scalar (``DampingRatio``), a cell of a table by row and column
            (``Elements[LS coupling].Stiffness``, ``MotorTorque[3].Pulsating``), with a unit behind it where
            numbers are not in SI (``Elements[LS coupling].Stiffness [lbf*in/rad]``), or a whole table
            (``Elements``). A value is a number, a text with its unit (``"12 %"``), a word, or None for a
            blank; of a table a frame with units, or rows as in the case JSON. [those units]

        Returns
        -------
        Input
            Checked anew; what is wrong is in its `problems`.

        Raises
        ------
        InputError
            If names lead nowhere; it carries all of them.

        Examples
        --------
        >>> import torsionbook as tb
        >>> train = tb.read(tb.template("example_modified"))
        >>> softer = train.change({"Elements[LS coupling].Stiffness": "20 MN*m/rad", "DampingRatio": 0.02})
        >>> softer.value("Elements[LS coupling].Stiffness"), softer.value("DampingRatio")
        (20000000.0, 0.02)
        """
        typed, case_notes, study_notes = self._typed(), Findings(), Findings()
        whole: dict[str, Any] = {}
        single: dict[str, Any] = {}
        for name, value in changes.items():
            table = _table_of(name)
            (single if table is None else whole)[table or name] = value
        for table, value in whole.items():
            findings = study_notes if table in _STUDY_TABLES else case_notes
            spec = table_called(table, EVERY_INPUT, "input table")
            typed.tables[table] = typed_rows(
                table, rows_of([] if value is None else value, spec, findings), findings
            )
        wrong: list[Problem] = []
        renewed: set[Place] = set()
        for name, value in single.items():
            try:
                named = named_input(name, typed, EVERY_INPUT)
            except WrongName as problem:
                wrong.append(_wrong_name(name, str(problem)))
                continue
            findings = study_notes if named.place[0] in _STUDY_TABLES else case_notes
            _put(typed, named, plain(value), findings)
            renewed.add(named.place)
        if wrong:
            raise InputError(tuple(wrong))
        return self._changed(typed, renewed, frozenset(whole), (case_notes, study_notes))

    def _typed(self) -> TypedCase:
        """A copy of everything typed, study tables included."""
        read = self._read
        tables = dict(read.typed.tables) | (
            {} if read.studies is None else read.studies.typed.tables
        )
        return TypedCase(
            dict(read.typed.scalars),
            {name: [dict(row) for row in rows] for name, rows in tables.items()},
        )

    def _changed(
        self,
        typed: TypedCase,
        renewed: set[Place],
        whole: frozenset[str],
        notes: tuple[Findings, Findings],
    ) -> Input:
        """A new input; cells that could not be read stay wrong, unless they are typed anew."""

        def is_renewed(place: Place) -> bool:
            return place in renewed or place[0] in whole

        read = self._read
        of_reader = (read.findings, Findings() if read.studies is None else read.studies.findings)
        findings = []
        for old, new in zip(of_reader, notes, strict=True):
            both = old.without(is_renewed)
            both.problems += new.problems
            both.bad |= new.bad
            findings.append(both)
        apart = {name: rows for name, rows in typed.tables.items() if name in _STUDY_TABLES}
        case = {name: rows for name, rows in typed.tables.items() if name not in _STUDY_TABLES}
        studies = (TypedCase({}, apart), findings[1]) if apart else None
        return Input(
            typed_input(TypedCase(typed.scalars, case), findings[0], studies, read.warnings)
        )

    # ---- writing -------------------------------------------------------------------------------

    def write(self, path: str | PathLike[str], *, units: str = "us") -> Path:
        """Write it as a new workbook, or as case JSON.

        Parameters
        ----------
        path : path
            A file ending in .xlsx or .json; one that is there is replaced. [path]
        units : str, optional
            ``us`` or ``si``: units of what is not typed in units of its own. [word]

        Returns
        -------
        Path
            The file.

        Raises
        ------
        ValueError
            If a workbook cannot hold it: a column has numbers in units that no single one replaces.
        """
        target = Path(path)
        if target.suffix.lower() == ".json":
            write_json(target, self.to_json())
        elif target.suffix.lower() == ".xlsx":
            write_whole(target, lambda file: self._build(file, units))
        else:
            raise ValueError(f"{target} must end in .xlsx or .json.")
        return target

    def _build(self, path: Path, units: str) -> None:
        if units not in ("us", "si"):
            raise ValueError(f"units is '{units}'; it must be us or si.")
        from addin.template.build import build_template

        try:
            filled = example_of(self._read, units)
        except MixedUnits as mixed:
            raise ValueError(str(mixed)) from None
        build_template(path, units, filled, studies=self._read.studies is not None)


def read(source: Source) -> Input:
    """Read an input; what is wrong with its content is in `Input.problems`, not raised.

    Parameters
    ----------
    source : path, mapping, openpyxl Workbook or Input
        A file ending in .xlsx, .xlsm or .json; the object of a case JSON; or frames, rows and scalars by
        name, as in `Input.change`. [path or stated units]

    Returns
    -------
    Input
        Frozen.

    Raises
    ------
    InputError
        If a file cannot be opened at all, or names lead nowhere.

    Examples
    --------
    Two discs and a shaft:

    >>> import torsionbook as tb
    >>> train = tb.read({
    ...     "LineFrequency": 60, "Poles": 4,
    ...     "Stations": [{"Station": "Motor", "Inertia": 80.0}, {"Station": "Fan", "Inertia": 200.0}],
    ...     "Elements": [{"Element": "Shaft", "Kind": "shaft", "From": "Motor", "To": "Fan",
    ...                   "Stiffness": "1.2 MN*m/rad"}],
    ... })
    >>> train.problems
    ()
    >>> round(tb.run(train).rows("NaturalFrequencies")[1]["frequency"], 4)
    23.0637
    """
    if isinstance(source, Input):
        return source
    if isinstance(source, Mapping):
        if "format" in source:
            return Input(read_case_json(source))
        return Input(typed_input(TypedCase(), Findings())).change(source)
    if is_openpyxl(source):
        with temporary_folder() as folder:
            saved = folder / "openpyxl workbook.xlsx"
            source.save(saved)
            return _of_file(saved)
    if isinstance(source, (str, PathLike)):
        return _of_file(Path(source))
    raise TypeError(
        f"an input cannot be read from {type(source).__name__}. Give a path, a case, or an openpyxl Workbook."
    )


def is_openpyxl(source: object) -> TypeGuard[OpenpyxlWorkbook]:
    """Whether something is a workbook of openpyxl, which is not imported for that."""
    return type(source).__module__.startswith("openpyxl.workbook")


def _of_file(path: Path) -> Input:
    found = read_checked(path)
    if isinstance(found, Unreadable):
        refuse(found.problems)
    assert isinstance(found, CaseInput)
    return Input(found)


def _table_of(name: str) -> str | None:
    """The input table of a name or JSON key; None for the name of anything else."""
    folded = name.strip().casefold()
    return next((s.name for s in EVERY_INPUT if folded in (s.name.casefold(), s.key)), None)


def _put(typed: TypedCase, named: NamedInput, value: Any, findings: Findings) -> None:
    """Put a value in the place of what was typed; None clears it."""
    entry = entry_of(named, value, findings)
    table, row, name = named.place
    entries = typed.scalars if row is None else typed.tables[table][row - 1]
    if entry is None:
        entries.pop(name, None)
    else:
        entries[name] = entry


def _wrong_name(name: str, sentence: str) -> Problem:
    """A name that leads nowhere."""
    return Problem("", "", None, name, name, "the name of an input", f"'{name}': {sentence}")
