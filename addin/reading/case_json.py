"""Case JSON ↔ `CaseData`.

One object a case, ``"format": 1``: scalars are keys, tables are lists of row objects, blank means
absent. A number is in SI, a string carries its unit. All problems are collected in the form in
which those of a workbook are reported.
"""

from __future__ import annotations

import json
import math
import re
import stat
from collections import Counter
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from addin.contract.json_formats import CASE_FORMAT
from addin.contract.problems import CellProblem, nearest, placed, printable, shortened
from addin.contract.tables import (
    INPUT_TABLES,
    SCALAR_SHEET,
    SCALAR_TABLE,
    SCALARS,
    STUDY_INPUT_TABLES,
    Field,
    input_table,
)
from addin.contract.units import UnitError, UnitScale, parse_unit
from addin.reading.study_inputs import studies_read
from addin.reading.typed_case import (
    LONGEST_WORDS,
    CaseInput,
    Entry,
    Findings,
    Place,
    StudiesRead,
    Typed,
    TypedCase,
    all_problems,
    in_typed_units,
    to_case_data,
    too_many_rows,
    word_entry,
    word_in_place,
)
from engine.case.data import TABLES, CaseData
from engine.errors import Problem

_LARGEST_FILE = 20 * 2**20
#: Unknown and repeated keys that are listed one by one. [count]
_MOST_KEYS = 50


def read_case_json(source: str | Path | Mapping[str, Any]) -> CaseInput:
    """Read a case JSON, all problems collected.

    Parameters
    ----------
    source : str, Path or mapping
        A file, or the object itself. [path]

    Returns
    -------
    CaseInput
        Data and problems. [SI]

    Raises
    ------
    OSError
        When the file cannot be read.
    """
    reading = _Reading()
    content = reading.load(Path(source)) if isinstance(source, (str, Path)) else source
    if content is not None:
        reading.read(content)
    return reading.result()


def typed_value(
    value: Any, spec: Field, place: Place, findings: Findings, unit: str | None = None
) -> Entry | None:
    """A single value by the rule of the case JSON: a number is in SI, a text carries its unit.

    Parameters
    ----------
    value : object
        Number or text. [as typed]
    spec : Field
        Its field. [field]
    place : tuple
        Table, row, column. [names]
    findings : Findings
        Takes a value that cannot be read. [problems]
    unit : str, optional
        Of a cell of a table that is no JSON: the unit in which a number stands there, for sentences.
        [unit]

    Returns
    -------
    Entry or None
        None for a blank and for a value that cannot be read. [as typed]
    """
    reading = _Reading()
    reading.findings = findings
    reading.unit = unit
    return reading._entry(value, spec, place)


def typed_rows(name: str, rows: Any, findings: Findings) -> list[dict[str, Entry]]:
    """The rows of one table by the rules of the case JSON.

    Parameters
    ----------
    name : str
        Table. [name]
    rows : list of mapping
        Objects whose keys are columns. [as typed]
    findings : Findings
        Takes what cannot be read. [problems]

    Returns
    -------
    list of dict
        Each row by column header. [as typed]
    """
    reading = _Reading()
    reading.findings = findings
    reading._read_rows(name, rows)
    return reading.typed.tables.get(name, [])


def typed_input(
    typed: TypedCase,
    findings: Findings,
    studies: tuple[TypedCase, Findings] | None = None,
    warnings: tuple[str, ...] = (),
) -> CaseInput:
    """What was typed, as an input that is checked; places are keys of the case JSON.

    Parameters
    ----------
    typed : TypedCase
        Everything typed. [as typed]
    findings : Findings
        Of the reader. [problems]
    studies : tuple of (TypedCase, Findings), optional
        The same of the study tables. [as typed]
    warnings : tuple of str, optional
        Of the reader. [sentences]

    Returns
    -------
    CaseInput
        Data and problems. [SI]
    """
    of_reader = findings.without()
    data = to_case_data(typed, findings)
    read = None
    if studies is not None:
        apart, of_studies = studies
        read = studies_read(
            set(apart.tables), apart, typed, of_studies, lambda one: _located(one, apart), ()
        )
    return CaseInput(
        data=data,
        problems=tuple(_located(problem, typed) for problem in all_problems(data, findings)),
        warnings=warnings,
        typed=typed,
        studies=read,
        findings=of_reader,
    )


def case_to_json(data: CaseData, studies: StudiesRead | None = None) -> dict[str, Any]:
    """A case as JSON object of the contract, numbers in SI.

    Parameters
    ----------
    data : CaseData
        The case, checked or not. [SI]
    studies : StudiesRead, optional
        Its study tables, which are written behind those of the case. [SI]

    Returns
    -------
    dict
        Ready for `json.dumps`; blanks are absent.
    """
    content: dict[str, Any] = {"format": CASE_FORMAT}
    for spec in SCALARS:
        value = getattr(data, spec.attribute)
        if value is not None:
            content[spec.key] = value
    for table in INPUT_TABLES:
        rows = getattr(data, TABLES[table.name][0])
        if rows:
            content[table.key] = [_row_to_json(row, table.columns) for row in rows]
    return content if studies is None else content | _studies_to_json(studies)


def _studies_to_json(studies: StudiesRead) -> dict[str, Any]:
    """The study tables that have rows."""
    content: dict[str, Any] = {}
    for table in STUDY_INPUT_TABLES:
        rows = studies.inputs.rows(table.name)
        if rows and table.name == "Tuning":  # each row in the unit that it names
            columns = {column.name: column for column in table.columns}
            content[table.key] = [
                {columns[name].key: _plain(entry, columns[name]) for name, entry in row.items()}
                for row in studies.typed.tables[table.name]
            ]
        elif rows:
            content[table.key] = [_row_to_json(row, table.columns) for row in rows]
    return content


def _plain(entry: Entry, column: Field) -> str | float | int:
    """An entry without unit."""
    if isinstance(entry, str):
        return entry
    return int(entry.number) if column.kind == "integer" else entry.number


def _row_to_json(row: object, columns: tuple[Field, ...]) -> dict[str, Any]:
    values = {column.key: getattr(row, column.attribute) for column in columns}
    share = getattr(row, "torque_share", None)
    if share is not None:
        values["torque"] = f"{100.0 * share:.15g} %"
    return {key: value for key, value in values.items() if value is not None}


class _Reading:
    """One reading of one case: what has been found so far."""

    def __init__(self) -> None:
        self.typed = TypedCase()
        self.findings = Findings()
        self.readable = True
        self.studies: dict[str, Any] = {}
        self.repeated = 0
        self.unknown = 0
        self.unit: str | None = None

    def load(self, path: Path) -> Any:
        """The content of a file; None, with a problem noted, if it is no JSON."""
        try:
            about = path.stat()
        except ValueError:
            return self._no_case(f"{path} is not a valid file name. Name the case.")
        if not stat.S_ISREG(about.st_mode) and not stat.S_ISDIR(about.st_mode):
            return self._no_case(f"{path.name} is a device or a pipe, not a file. Name a file.")
        if about.st_size > _LARGEST_FILE:
            return self._no_case(
                f"{path.name} is larger than {_LARGEST_FILE // 2**20} MB, the limit for a case. "
                "Check the file."
            )
        try:
            return json.loads(path.read_text(encoding="utf-8-sig"), object_pairs_hook=self._object)
        except UnicodeDecodeError:
            return self._no_case(f"{path.name} is not UTF-8 text. Save it as UTF-8.")
        except json.JSONDecodeError as error:
            return self._no_case(
                f"{path.name} is not JSON: {error.msg} in line {error.lineno}, column "
                f"{error.colno}. Correct it there."
            )
        except ValueError:  # an integer of more digits than Python reads
            return self._no_case(
                f"{path.name} contains a number with thousands of digits. Correct it."
            )
        except RecursionError:
            return self._no_case(f"{path.name} has too many nested levels for a case. Correct it.")

    def _object(self, pairs: list[tuple[str, Any]]) -> dict[str, Any]:
        """An object of the file; a key given twice is noted."""
        content = dict(pairs)
        if len(content) < len(pairs):
            counts = Counter(key for key, _ in pairs)
            twice = sorted(key for key, count in counts.items() if count > 1)
            for key in twice[: max(_MOST_KEYS - self.repeated, 0)]:
                shown = printable(shortened(key))
                self.findings.add(
                    (SCALAR_TABLE, None, shown),
                    shown,
                    "each key once",
                    f"the key '{shown}' occurs twice in one object. Delete one of them.",
                )
            self.repeated += len(twice)
        return content

    def _no_case(self, message: str) -> None:
        self.readable = False
        self.findings.add((SCALAR_TABLE, None, ""), None, "a case JSON", message)

    def read(self, content: Any) -> None:
        """Scalars and tables of a case object."""
        if not isinstance(content, Mapping):
            self._no_case("the file is not a JSON object. Put the case in braces.")
            return
        if _RESULT_KEYS <= content.keys() and "stations" not in content:
            self._no_case(
                "this is a result JSON, which contains no inputs. Name the workbook or the case JSON "
                "of the calculation."
            )
            return
        self._read_format(content.get("format"))
        known = {"format", *_SCALARS, *_TABLES, *_STUDIES}
        self._note_unknown(content, known, (SCALAR_TABLE, None))
        self.typed.scalars = self._entries(content, _SCALARS, SCALAR_TABLE, None)
        for key, table in _TABLES.items():
            rows = content.get(key)
            if rows is not None:
                self._read_rows(table.name, rows)
        self.studies = {k: content[k] for k in _STUDIES if content.get(k) is not None}

    def _read_format(self, stated: Any) -> None:
        if stated != CASE_FORMAT or isinstance(stated, bool):
            stated = _short(stated)
            what = "has no key 'format'" if stated is None else f"has format {stated!r}"
            self.findings.add(
                (SCALAR_TABLE, None, "format"),
                stated,
                f'"format": {CASE_FORMAT}',
                f'the case {what}; this version reads "format": {CASE_FORMAT}. Write that line at the '
                "top.",
            )

    def _note_unknown(
        self, content: Mapping[str, Any], known: set[str], place: tuple[str, int | None]
    ) -> None:
        for key in content:
            if key not in known:
                self.unknown += 1
                if self.unknown > _MOST_KEYS:
                    return  # the others are told when these are gone
                key = printable(shortened(str(key)))
                meant = nearest(key, known)
                advice = f"Did you mean '{meant}'?" if meant else "Delete it."
                self.findings.add(
                    (*place, key), key, "a key of the case format", f"unknown key '{key}'. {advice}"
                )

    def _read_rows(self, name: str, rows: Any) -> None:
        """The rows of one table."""
        if not isinstance(rows, (list, tuple)):
            self.findings.add(
                (name, None, ""),
                type(rows).__name__,
                "a list of objects",
                "the table is not a list. Write a list in brackets with one object per row.",
            )
            return
        spec = input_table(name)
        if too_many_rows(name, len(rows), self.findings):
            return
        known = {column.key: column for column in spec.columns}
        self.typed.tables[name] = []
        for number, row in enumerate(rows, start=1):
            if isinstance(row, Mapping):
                self._note_unknown(row, set(known), (name, number))
            else:
                self._note_row(name, number, row, spec.columns)
                row = {}
            self.typed.tables[name].append(self._entries(row, known, name, number))

    def _note_row(self, name: str, number: int, row: Any, columns: tuple[Field, ...]) -> None:
        self.findings.add(
            (name, number, ""),
            _short(row),
            "an object",
            "the row is not an object. Write its columns as keys in braces.",
        )
        self.findings.silence(*((name, number, column.name) for column in columns))

    def _entries(
        self, content: Mapping[str, Any], fields: Mapping[str, Field], table: str, row: int | None
    ) -> dict[str, Entry]:
        """The values of a case or of a row that can be read, by name."""
        entries = {
            spec.name: self._entry(content.get(key), spec, (table, row, spec.name))
            for key, spec in fields.items()
        }
        return {name: entry for name, entry in entries.items() if entry is not None}

    def _entry(self, value: Any, spec: Field, place: Place) -> Entry | None:
        """One value as typed; None for a blank and for a value that cannot be read."""
        if value is None:
            return None
        if not spec.is_number:
            if isinstance(value, str):
                return word_entry(value, spec, place, self.findings)
            self._note(place, value, "text", "type a text in quotes.")
            return None
        if word := word_in_place(value, spec):
            return word
        if isinstance(value, str):
            return self._number_with_unit(value, spec, place)
        if isinstance(value, bool) or not isinstance(value, (int, float)):
            self._note(place, value, "a number", "type a number.")
            return None
        return self._finite(value, spec, place)

    def _finite(self, value: int | float, spec: Field, place: Place) -> Typed | None:
        """A plain number, which is in SI."""
        try:
            number = float(value)
        except OverflowError:
            number = math.inf
        if math.isfinite(number):
            return Typed(number, UnitScale(1.0), spec.si)
        self._note(place, str(value), "a finite number", "type a finite number.")
        return None

    def _number_with_unit(self, text: str, spec: Field, place: Place) -> Typed | None:
        """A string such as ``1800 rpm``."""
        wanted = _wanted(spec, self.unit)
        match = _QUANTITY.fullmatch(text.strip()) if len(text) < LONGEST_WORDS else None
        if match is None:
            hint = " Use a decimal point." if re.search(r"\d,\d", text[:60]) else ""
            self._note(place, text, wanted, f"{wanted} is needed.{hint}")
            return None
        number, unit = float(match.group(1)), match.group(2)
        if not spec.has_unit or not unit:
            why = "has no unit" if spec.has_unit else "must be a plain number"
            self._note(place, text, wanted, f"the value {why}. Write {wanted}.")
            return None
        try:
            scale = parse_unit(unit, spec.dimension)
        except UnitError as error:
            short = shortened(text)
            self.findings.add(place, short, error.allowed, f"found '{short}'; {error.message}")
            return None
        if math.isfinite(number):
            return Typed(number, scale, unit)
        self._note(place, text, "a finite number", "type a finite number.")
        return None

    def _note(self, place: Place, found: Any, allowed: str, advice: str) -> None:
        short = _short(found)
        shown = f"'{short}'" if isinstance(found, str) else short
        self.findings.add(place, short, allowed, f"found {shown}; {advice}")

    def result(self) -> CaseInput:
        """Everything read and checked."""
        if not self.readable:
            problems = tuple(_located(problem, self.typed) for problem in self.findings.problems)
            return CaseInput(CaseData(), problems, (), self.typed, findings=self.findings)
        return typed_input(self.typed, self.findings, self._studies())

    def _studies(self) -> tuple[TypedCase, Findings] | None:
        """The keys of the studies, where there are any: read apart, so that they spoil no case."""
        if not self.studies:
            return None
        apart = _Reading()
        for key, rows in self.studies.items():
            apart._read_rows(_STUDIES[key].name, rows)
            apart.typed.tables.setdefault(_STUDIES[key].name, [])
        return apart.typed, apart.findings


#: What every result JSON has, also one that holds errors only.
_RESULT_KEYS = frozenset({"version", "warnings", "errors"})
_SCALARS = {spec.key: spec for spec in SCALARS}
_TABLES = {table.key: table for table in INPUT_TABLES}
_STUDIES = {table.key: table for table in STUDY_INPUT_TABLES}
_QUANTITY = re.compile(
    r"([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)(?:\s+|(?![\d.,]))(.*)", re.DOTALL | re.ASCII
)


def _wanted(spec: Field, unit: str | None) -> str:
    """What a value of a field may look like in JSON, or in a table whose numbers have a unit."""
    quoted = " without quotes" if unit is None else ""
    if not spec.has_unit or spec.dimension == "ratio":
        return _or_words(f"a number{quoted}", spec)
    measure = "" if (unit or spec.si) == "1" else f" in {unit or spec.si}"
    return _or_words(
        f'a number{measure}{quoted}, or one with its unit such as "1 {spec.units[0]}"',
        spec,
    )


def _or_words(number: str, spec: Field) -> str:
    """The words that a field of numbers also takes."""
    return f"{number}, or {' or '.join(spec.choices)}," if spec.choices else number


def _short(value: Any) -> Any:
    """A found value that fits into a sentence."""
    if value is None or isinstance(value, (bool, float)):
        return value
    if isinstance(value, int) and abs(value) < 10**15:
        return value
    if isinstance(value, int):
        return f"a number of {int(abs(value).bit_length() * 0.30103) + 1} digits"
    if isinstance(value, str):
        return printable(shortened(value))
    return "a list" if isinstance(value, (list, tuple)) else "an object"


def _located(problem: Problem, typed: TypedCase) -> CellProblem:
    """A problem with the path of its value."""
    is_scalar = problem.table == SCALAR_TABLE
    sheet = SCALAR_SHEET if is_scalar else input_table(problem.table).sheet
    path = _path(problem.table, problem.row, problem.column)
    return placed(in_typed_units(problem, typed), sheet, path, "key")


def _path(table: str, row: int | None, column: str) -> str:
    """Where a value stands in the object, such as ``elements[2].stiffness``."""
    fields = SCALARS if table == SCALAR_TABLE else input_table(table).columns
    key = {spec.name: spec.key for spec in fields}.get(column, column)
    if table == SCALAR_TABLE:
        return key
    place = input_table(table).key if row is None else f"{input_table(table).key}[{row - 1}]"
    return f"{place}.{key}" if key else place
