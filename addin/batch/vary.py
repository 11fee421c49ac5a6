"""One case, many values: a programme of cases from a table, streamed to Parquet.

Each column of the table names an input of the base case, each row is a case: ``DampingRatio``,
``Elements[LS coupling].Stiffness``, ``MotorTorque[3].Pulsating``. A number is in the unit that stands
in brackets behind the name, ``Elements[LS coupling].Stiffness [lbf*in/rad]``; without one it is in SI,
as in a case JSON; a text such as ``12 %`` carries its own. A blank leaves what the base case says.

Rows are read, calculated and written in chunks, so that a programme of any length needs the same
memory. Each chunk is a file of its own until the end; a chunk that is there is whole.
"""

from __future__ import annotations

import codecs
import contextlib
import csv
import json
import os
import pickle
import re
import shutil
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from addin.batch.folder import OWN, OutFolder, digest_of
from addin.batch.own_files import (
    RESULT,
    RESULT_COLUMNS,
    RESULT_CSV,
    is_result,
    is_result_csv,
    stated_columns,
)
from addin.batch.records import (
    AN_EARLIER,
    CRASHED,
    DONE,
    FAULT,
    NOT_RENAMED,
    OUTDATED,
    WRONG_INPUT,
    outcome_of,
)
from addin.batch.scheduler import Listener, Stop, Stopped
from addin.batch.work import compiles
from addin.calculation.stages import COMPILING
from addin.contract.problems import nearest, shortened
from addin.contract.tables import INPUT_TABLES, SCALAR_TABLE, SCALARS, Field, TableSpec
from addin.contract.units import UnitError, UnitScale, parse_unit
from addin.reading.typed_case import Findings, Place, Typed, TypedCase, to_case_data
from addin.workers.pool import Crashed, Task, Workers

if TYPE_CHECKING:
    import pyarrow as pa

    from engine.case.data import CaseData
    from engine.errors import Problem

__all__ = ["Chunk", "Programme", "TableRefused", "Varied", "calculate_rows", "run_programme"]

#: Rows of a chunk. [count]
ROWS = 50
#: Chunks given to the workers before answers come back, a worker. [count]
AHEAD = 3
#: Reasons that are kept for the terminal. [count]
REASONS = 20
#: Chunks that become one row group of the result. [count]
_GROUPED = 50


class TableRefused(Exception):
    """The table cannot be used; each sentence names the column or the row."""

    def __init__(self, sentences: Sequence[str]) -> None:
        super().__init__("\n".join(sentences))
        self.sentences = tuple(sentences)


@dataclass(frozen=True)
class Varied:
    """One column of the table."""

    header: str  #: As it stands there.
    place: Place  #: Table (``Case`` for a scalar), row counted from 1, column.
    spec: Field  #: The input it names.
    unit: str = ""  #: The unit in its header; empty for SI. [unit]
    scale: UnitScale | None = None  #: What that unit is worth. [scale]


@dataclass(frozen=True)
class Chunk:
    """The task of calculating some rows."""

    base: bytes  #: Pickled `TypedCase`. [bytes]
    columns: tuple[Varied, ...]  #: The table's columns, without the one of names.
    #: Row number, name and values of each row. [as read]
    rows: tuple[tuple[int, str | None, tuple[Any, ...]], ...]
    #: Fields of the case that the command line sets. [SI]
    overrides: Mapping[str, Any] = field(default_factory=dict)
    comma: bool = False  #: The comma is the decimal sign of the table.


@dataclass
class Programme:
    """What became of a programme."""

    result: Path  #: The Parquet file.
    rows: int = 0  #: Rows of the table.
    csv: Path | None = None  #: The same as CSV, where it is asked for.
    form: CsvForm = field(default_factory=lambda: CsvForm())  #: How that is written.
    comma: bool = False  #: Its decimal sign is the comma.
    #: Rows by outcome; those not reached are missing.
    outcomes: dict[str, int] = field(default_factory=dict)
    kept: int = 0  #: Rows that an earlier run calculated.
    #: The first rows that could not be calculated, and why.
    reasons: list[str] = field(default_factory=list)


# --- the table ------------------------------------------------------------------------------------

_COLUMN = re.compile(
    r"(?P<table>\w+)(?:\[(?P<row>.*?)\]\s*\.\s*(?P<column>[^\[\]]+?))?(?:\s*\[(?P<unit>[^\[\]]*)\])?"
)
_NAMES = ("name", "case")


def read_columns(headers: Sequence[str], base: TypedCase) -> tuple[list[Varied | None], int | None]:
    """What the columns of a table name.

    Parameters
    ----------
    headers : sequence of str
        Its first row. [text]
    base : TypedCase
        The base case. [as typed]

    Returns
    -------
    columns : list of (Varied or None)
        None for the column of names.
    names : int or None
        Its index, counted from 0.

    Raises
    ------
    TableRefused
        With a sentence for each wrong column.
    """
    wrong: list[str] = []
    columns: list[Varied | None] = []
    names: int | None = None
    seen: dict[Place, str] = {}
    for index, header in enumerate(headers):
        text = header.strip()
        if text.casefold() in _NAMES and names is None:
            names = index
            columns.append(None)
            continue
        try:
            column = _column(text, base)
        except _WrongColumn as problem:
            wrong.append(f"column {index + 1}, '{shortened(text)}': {problem}")
            continue
        if column.place in seen:
            wrong.append(
                f"column {index + 1}, '{text}': column '{seen[column.place]}' names the same input."
            )
        seen[column.place] = text
        columns.append(column)
    if not wrong and not any(columns):
        wrong.append("the table names no input. Give it a column such as DampingRatio.")
    if wrong:
        raise TableRefused(wrong)
    return columns, names


class _WrongColumn(Exception):
    """A column that names no input; the sentence says why."""


def _column(header: str, base: TypedCase) -> Varied:
    match = _COLUMN.fullmatch(header)
    if match is None:
        raise _WrongColumn(
            "it must name a scalar, such as DampingRatio, or a cell of a table, such as "
            "Elements[LS coupling].Stiffness, and may end in a unit, such as [N*m/rad]."
        )
    found, row, column, unit = match.group("table", "row", "column", "unit")
    if column is None:
        place: Place = (SCALAR_TABLE, None, "")
        spec = _named(found, SCALARS, "scalar")
        place = (SCALAR_TABLE, None, spec.name)
    else:
        table = _named(found, INPUT_TABLES, "input table")
        spec = _named(column, table.columns, f"column of {table.name}")
        place = (table.name, _row(table, row, base), spec.name)
    if not unit:
        return Varied(header, place, spec)
    if not spec.has_unit:
        raise _WrongColumn(f"{spec.name} has no unit. Leave out [{unit}].")
    try:
        return Varied(header, place, spec, unit, parse_unit(unit, spec.dimension))
    except UnitError as error:
        raise _WrongColumn(error.message) from error


_T = TypeVar("_T", Field, TableSpec)


def _named(word: str, known: Sequence[_T], what: str) -> _T:
    """The input of a name or JSON key, capitals aside."""
    for one in known:
        if word.casefold() in (one.name.casefold(), one.key):
            return one
    meant = nearest(word, [one.name for one in known])
    advice = f" Did you mean '{meant}'?" if meant else ""
    raise _WrongColumn(f"there is no {what} '{shortened(word)}'.{advice}")


def _row(table: TableSpec, word: str, base: TypedCase) -> int:
    """The row of the base case that a name or number means."""
    rows = base.tables.get(table.name, [])
    first = table.columns[0].name
    by_name = [str(row.get(first, "")) for row in rows]
    unique = len(set(by_name)) == len(by_name)
    if unique and word in by_name:
        return by_name.index(word) + 1
    if word.isascii() and word.isdigit() and 1 <= int(word) <= len(rows):
        return int(word)
    if not rows:
        raise _WrongColumn(f"the base case has no row in table {table.name}.")
    names = by_name if unique else []
    meant = nearest(word, names)
    advice = f" Did you mean '{meant}'?" if meant else ""
    by = f"the name in its column {first}, or by " if names else ""
    raise _WrongColumn(
        f"table {table.name} of the base case has no row '{shortened(word)}'.{advice} Name a row by "
        f"{by}its number, 1 to {len(rows)}."
    )


#: Marks at the begin of a file in UTF-16, Excel's "Unicode text".
_UTF_16 = (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)
#: A number with a decimal comma; the second cannot be a comma between thousands either.
_COMMA = re.compile(r"\s*[+-]?[\d.]*,\d+(?:[eE][+-]?\d+)?(?:\s.*)?", re.ASCII | re.DOTALL)
_SURE_COMMA = re.compile(
    r"\s*[+-]?[\d.]*,(?!\d{3}(?:\s|$))\d+(?:[eE][+-]?\d+)?(?:\s.*)?|\s*[+-]?0,\d+(?:\s.*)?",
    re.ASCII | re.DOTALL,
)


@dataclass(frozen=True)
class CsvForm:
    """How a CSV is written."""

    encoding: str = "utf-8-sig"  #: UTF-8, or UTF-16 where the file begins with its mark.
    separator: str = ","  #: Comma, semicolon or tab. [character]
    states: bool = False  #: Its first line is Excel's ``sep=;``.


@dataclass(frozen=True)
class Table:
    """A table that is read as a stream."""

    path: Path  #: CSV or Parquet.

    def headers(self) -> list[str]:
        """Its column names. [text]

        Raises
        ------
        TableRefused
            If it cannot be read.
        """
        with self._reading():
            if self._is_parquet:
                return [str(name) for name in self._parquet().schema_arrow.names]
            return next(iter(self._csv()), [])

    def count(self) -> int:
        """Its rows. [count]"""
        with self._reading():
            if self._is_parquet:
                return int(self._parquet().metadata.num_rows)
            return max(sum(1 for row in self._csv() if row) - 1, 0)

    def rows(self) -> Iterator[list[Any]]:
        """Its rows, one at a time."""
        with self._reading():
            if not self._is_parquet:
                rows = self._csv()
                next(rows, None)
                yield from (row for row in rows if row)
                return
            for batch in self._parquet().iter_batches(batch_size=ROWS):
                columns = [column.to_pylist() for column in batch.columns]
                yield from (list(row) for row in zip(*columns, strict=True))

    @property
    def _is_parquet(self) -> bool:
        return self.path.suffix.lower() in (".parquet", ".pq")

    def _reading(self) -> _Reading:
        return _Reading(self.path)

    def _parquet(self) -> Any:
        from pyarrow.parquet import ParquetFile

        return ParquetFile(self.path)

    def form(self) -> CsvForm:
        """Encoding and separator of a CSV, by its begin.

        Raises
        ------
        TableRefused
            If it cannot be read.
        """
        if self._is_parquet:
            return CsvForm()
        with self._reading():
            with open(self.path, "rb") as file:
                encoding = "utf-16" if file.read(2) in _UTF_16 else "utf-8-sig"
            with open(self.path, encoding=encoding, newline="") as text:
                first = text.readline().rstrip("\r\n")
        stated = re.fullmatch(r'"?sep=(.)"?', first, re.IGNORECASE)
        if stated:
            return CsvForm(encoding, stated.group(1), states=True)
        return CsvForm(encoding, max((",", ";", "\t"), key=first.count))

    def has_decimal_commas(self, columns: Sequence[Varied | None]) -> bool:
        """Whether the comma is the decimal sign: a table has one, never both."""
        separator = self.form().separator
        if self._is_parquet or separator == ",":
            return False
        # Excel writes semicolons where the comma is the decimal sign, tabs anywhere.
        comma = _COMMA if separator == ";" else _SURE_COMMA
        numbers = [i for i, one in enumerate(columns) if one is not None and one.spec.is_number]
        return any(comma.fullmatch(row[i]) for row in self.rows() for i in numbers if i < len(row))

    def _csv(self) -> Iterator[list[str]]:
        form = self.form()
        with open(self.path, encoding=form.encoding, newline="") as file:
            if form.states:
                file.readline()
            yield from csv.reader(file, delimiter=form.separator)


class _Reading:
    """What goes wrong while a table is read, as one sentence."""

    def __init__(self, path: Path) -> None:
        self._path = path

    def __enter__(self) -> None:
        return None

    def __exit__(self, kind: Any, wrong: BaseException | None, trace: Any) -> None:
        if isinstance(wrong, UnicodeDecodeError):
            raise TableRefused(
                ["it is not UTF-8 text. Give a CSV saved as CSV UTF-8, or a .parquet file."]
            ) from wrong
        if isinstance(wrong, (OSError, csv.Error)):
            why = getattr(wrong, "strerror", None) or wrong
            raise TableRefused([f"it cannot be read: {why}."]) from wrong
        if wrong is not None and type(wrong).__module__.startswith("pyarrow"):
            raise TableRefused(["it is no Parquet file that can be read."]) from wrong


# --- in the processes -----------------------------------------------------------------------------


def calculate_rows(task: Chunk) -> list[dict[str, Any]]:
    """Calculate the rows of a chunk; one that cannot be calculated is a row with the reason.

    Parameters
    ----------
    task : Chunk

    Returns
    -------
    list of dict
        Of the columns of the result. [SI]
    """
    base: TypedCase = pickle.loads(task.base)
    known: dict[str, dict[str, Any]] = {}
    found = []
    for number, name, values in task.rows:
        began = time.perf_counter()
        row = {"row": number, "name": name} | _calculated(task, values, base, known)
        found.append(row | {"seconds": time.perf_counter() - began})
    return found


def _calculated(
    task: Chunk,
    values: Sequence[Any],
    base: TypedCase,
    known: dict[str, dict[str, Any]],
) -> dict[str, Any]:
    """One row; `known` holds the cases of this chunk."""
    from addin.reading.typed_case import all_problems
    from engine.case.case import Case
    from engine.case.data import case_digest
    from engine.errors import CaseError, ModelError

    columns = task.columns
    findings = Findings()
    typed = TypedCase(dict(base.scalars), {name: list(rows) for name, rows in base.tables.items()})
    inputs, relative = _put(task, values, typed, findings)
    if len(values) != len(columns):
        reason = f"the row has {len(values)} values, the table {len(columns)} columns."
        return inputs | {"outcome": WRONG_INPUT, "reason": reason}
    try:
        data = to_case_data(typed, findings)
        problems = all_problems(data, findings)
        if problems:
            reasons = [_reason(one, columns, typed) for one in problems]
            return inputs | {"outcome": WRONG_INPUT, "reason": "\n".join(reasons)}
        inputs |= {one.header: _in_case(one, data) for one in relative}
        case = Case(**(vars(data) | dict(task.overrides)))
        digest = case_digest(data)
        if digest not in known:
            known[digest] = _answers(case)
        return inputs | known[digest] | {"case_sha256": digest}
    except CaseError as wrong:
        reason = "\n".join(one.message for one in wrong.problems)
        return inputs | {"outcome": WRONG_INPUT, "reason": reason}
    except ModelError as wrong:
        return inputs | {"outcome": WRONG_INPUT, "reason": str(wrong)}
    except Exception as wrong:  # one row's fault never ends a programme; the row says what happened
        reason = f"this is an error inside torsionbook; please report it: {wrong!r}"
        return inputs | {"outcome": FAULT, "reason": reason}


def _put(
    task: Chunk, values: Sequence[Any], typed: TypedCase, findings: Findings
) -> tuple[dict[str, Any], list[Varied]]:
    """Put the values of a row into a case.

    Returns what was put, for the result, and the columns of which only the case knows how much that
    is: texts such as ``12 %`` of the rated torque.
    """
    inputs: dict[str, Any] = {}
    relative = []
    for column, value in zip(task.columns, values, strict=False):
        if task.comma and isinstance(value, str) and column.spec.is_number:
            value = _with_point(column, value, findings)
        entry = _entry(column, value, findings)
        inputs[column.header] = _shown(column, entry)
        if entry is None:
            continue
        if inputs[column.header] is None:
            relative.append(column)
        table, row, name = column.place
        if row is None:
            typed.scalars[name] = entry
        else:
            rows = typed.tables[table]
            rows[row - 1] = {**rows[row - 1], name: entry}
    return inputs, relative


def _in_case(column: Varied, data: CaseData) -> float | None:
    """The input of a case in the unit of its column; None where that unit hangs on the case, too."""
    from engine.case.data import TABLES

    table, row, _ = column.place
    there: Any = data if row is None else getattr(data, TABLES[table][0])[row - 1]
    value = getattr(there, column.spec.attribute)
    scale = column.scale or UnitScale(1.0)
    return None if value is None or scale.base else scale.from_si(value)


_SIGNED = re.compile(r"\s*[+-]?[\d.,]+", re.ASCII)


def _with_point(column: Varied, value: str, findings: Findings) -> str:
    """A number whose decimal sign is the comma; blank where it has points as well, which is noted."""
    number = _SIGNED.match(value)
    if number is None:
        return value
    if "." in number.group():
        findings.add(
            column.place,
            shortened(value),
            "a number with a decimal comma and no points",
            f"found '{shortened(value)}'; the decimal sign of this table is the comma. Write the "
            "number without points between thousands.",
        )
        return ""
    return number.group().replace(",", ".") + value[number.end() :]


def _entry(column: Varied, value: Any, findings: Findings) -> Typed | str | None:
    """A value of the table as an input; None for a blank and for one that cannot be read."""
    from addin.reading.case_json import typed_value

    if value is None or (isinstance(value, str) and not value.strip()):
        return None
    if isinstance(value, str) and column.spec.is_number:
        try:
            value = float(value)
        except ValueError:
            value = value.strip()
    elif not column.spec.is_number and not isinstance(value, str):
        value = f"{value:.15g}" if isinstance(value, float) else str(value)
    entry = typed_value(value, column.spec, column.place, findings, column.unit)
    if isinstance(entry, Typed) and column.scale is not None and not isinstance(value, str):
        return Typed(entry.number, column.scale, column.unit)
    return entry


def _shown(column: Varied, entry: Typed | str | None) -> Any:
    """An input for the result, in the unit of its column; None where that cannot be."""
    if not isinstance(entry, Typed):
        return entry
    own, there = entry.scale, column.scale or UnitScale(1.0)
    if own == there:
        return entry.number
    return None if own.base or there.base else there.from_si(own.to_si(entry.number))


def _reason(problem: Problem, columns: Sequence[Varied], typed: TypedCase) -> str:
    """What is wrong in a row, by its column where it is one of the table's."""
    from addin.reading.typed_case import in_typed_units

    told = in_typed_units(problem, typed)
    place = (problem.table, problem.row, problem.column)
    for column in columns:
        if column.place == place:
            return f"{column.header}: {told.message}"
    row = "" if problem.row is None else f"[{problem.row}]"
    where = problem.column if problem.table == SCALAR_TABLE else f"{problem.table}{row}.{problem.column}"  # fmt: skip
    return f"{where.rstrip('.')} (of the base case): {told.message}"


def _answers(case: Any) -> dict[str, Any]:
    """The numbers of one case."""
    from addin.calculation.key_figures import key_figures
    from engine.results.tables import result_tables
    from engine.run import run

    results = run(case)
    found = key_figures(results, result_tables(results)["StartupPeaks"])
    modes = {f"mode_{n}_Hz": f for n, f in enumerate(found.frequencies, start=1)}
    return {
        "outcome": DONE,
        "verdict": found.verdict,
        "checks_not_judged": found.not_judged,
        "start": found.outcome,
        **modes,
        "worst_margin": found.margin,
        "worst_margin_at": found.margin_where,
        "peak_torque_N_m": found.peak_torque,
        "peak_torque_over_rated": found.peak_over_rated,
        "peak_torque_at": found.peak_where,
        "peak_to_peak_stress_Pa": found.stress,
        "peak_to_peak_stress_at": found.stress_where,
        "torque_reversals": found.reversals,
        "torque_reverses_at": found.reversals_where,
        "allowable_starts": found.starts,
        "starts_unlimited": found.starts_unlimited,
        "starts_governed_by": found.starts_where,
        "warnings": "\n".join(results.warnings) or None,
    }


# --- the programme --------------------------------------------------------------------------------


def run_programme(
    base: Path,
    table: Path,
    folder: OutFolder,
    workers: Workers,
    *,
    resume: bool,
    stop: Stop,
    listener: Listener,
    overrides: Mapping[str, Any] | None = None,
    as_csv: bool = False,
) -> Programme:
    """Calculate every row of a table.

    Parameters
    ----------
    base : Path
        Workbook or case JSON. [path]
    table : Path
        CSV or Parquet. [path]
    folder : OutFolder
        Takes ``results.parquet``.
    workers : Workers
        Who does the work.
    resume : bool
        Go on with an ended programme of the same table and base. [flag]
    stop : Stop
        Asked all the time.
    listener : Listener
        Told all the time.
    overrides : mapping, optional
        Fields of the case that the command line sets, whatever base and table say. [SI]
    as_csv : bool
        Write ``results.csv`` too, with the separator and the decimal sign of the table. [flag]

    Returns
    -------
    Programme
        What became of it.

    Raises
    ------
    TableRefused
        If the table or the base case cannot be used.
    Abandoned, Stopped
        As of `Batch.process`.
    """
    typed = _base(base, folder)
    read = Table(table)
    columns, names = read_columns(read.headers(), typed)
    varied = tuple(one for one in columns if one is not None)
    total = read.count()
    comma = read.has_decimal_commas(columns)
    parts = _Parts(folder, _schema(varied))
    settings = dict(overrides or {})
    parts.begin(_fingerprint(base, table) | {"settings": settings}, resume)
    programme = Programme(folder.place(RESULT), total)
    if as_csv:
        programme.csv = folder.place(RESULT_CSV)
        programme.form = read.form()
        programme.comma = comma
    listener.begin("calculating", total)
    if total and workers.here and compiles(to_case_data(typed, Findings())):
        listener.note(f"{COMPILING} …")
    chunk = Chunk(pickle.dumps(typed), varied, (), settings, comma)
    work = _Work(chunk, names, parts, programme, listener)
    chunks = enumerate(_chunked(read.rows()))
    tasks = (one for number, rows in chunks for one in work.tasks(number, rows))
    try:
        for one in islice(tasks, AHEAD * workers.threads):
            workers.add(one)
        for task, answer in workers.answers(stop):
            for one in (*work.taken(task, answer), *islice(tasks, 1)):
                workers.add(one)
    except OSError as wrong:
        raise Stopped(
            f"Results cannot be written ({wrong.strerror or wrong}). What was written so far is kept; "
            "free some space, then run again with --resume."
        ) from wrong
    finally:
        with contextlib.suppress(OSError):  # the chunks are there, and --resume joins them
            programme.outcomes = parts.join(programme)
    return programme


def _base(path: Path, folder: OutFolder) -> TypedCase:
    from addin.reading.one_file import Unreadable, read_checked

    read = read_checked(path)
    if isinstance(read, Unreadable) or read.problems:
        cause = read.cause if isinstance(read, Unreadable) else None
        outdated = cause is None or outcome_of(cause) in OUTDATED
        sentences = [f"base case {path}: {one.message}" for one in read.problems]
        raise TableRefused([*sentences, *(_set_aside(folder) if outdated else ())])
    return read.typed


def _set_aside(folder: OutFolder) -> Iterator[str]:
    """Rename results of an earlier base case, which must not be taken for those of this one."""
    for name, is_ours in ((RESULT, is_result), (RESULT_CSV, is_result_csv)):
        if not is_ours(folder.place(name)):
            continue
        try:
            yield AN_EARLIER.format(name, folder.set_aside(name).name)
        except OSError as wrong:
            yield NOT_RENAMED.format(name, wrong.strerror or wrong)


def _fingerprint(base: Path, table: Path) -> dict[str, Any]:
    from addin.contract.version import product_version

    return {
        "base": digest_of(base),
        "table": digest_of(table),
        "rows": ROWS,
        "version": product_version(),
    }


def _chunked(rows: Iterable[list[Any]]) -> Iterator[list[list[Any]]]:
    rows = iter(rows)
    while chunk := list(islice(rows, ROWS)):
        yield chunk


class _Work:
    """Tasks of a programme and what comes back."""

    def __init__(
        self,
        like: Chunk,
        names: int | None,
        parts: _Parts,
        programme: Programme,
        listener: Listener,
    ) -> None:
        self._like, self._names = like, names
        self._parts, self._programme, self._listener = parts, programme, listener
        self._open: dict[int, tuple[int, list[dict[str, Any]]]] = {}

    def tasks(self, number: int, rows: Sequence[Sequence[Any]]) -> Iterator[Task]:
        """The task of a chunk; none if an earlier run has done it."""
        if self._parts.has(number):
            self._programme.kept += len(rows)
            for _ in rows:
                self._listener.advance(None)
            return
        first = number * ROWS + 1
        named = tuple(self._split(first + i, row) for i, row in enumerate(rows))
        self._open[number] = (len(rows), [])
        yield Task(calculate_rows, replace(self._like, rows=named), number)

    def _split(self, number: int, row: Sequence[Any]) -> tuple[int, str | None, tuple[Any, ...]]:
        if self._names is None:
            return number, None, tuple(row)
        values = [value for i, value in enumerate(row) if i != self._names]
        name = row[self._names] if self._names < len(row) else None
        return number, None if name is None else str(name), tuple(values)

    def taken(self, task: Task, answer: Any) -> Iterator[Task]:
        """Keep an answer; a chunk whose process died is tried row by row."""
        chunk: Chunk = task.payload
        if isinstance(answer, Crashed):
            if len(chunk.rows) > 1:
                for row in chunk.rows:
                    yield Task(calculate_rows, replace(chunk, rows=(row,)), task.tag)
                return
            number, name, _ = chunk.rows[0]
            answer = [{"row": number, "name": name, "outcome": CRASHED, "reason": answer.sentence}]
        size, rows = self._open[task.tag]
        rows += answer
        for row in answer:
            self._listener.advance(None)
            if row["outcome"] != DONE and len(self._programme.reasons) < REASONS:
                self._programme.reasons.append(f"row {row['row']}: {row['reason']}")
        if len(rows) == size:
            self._parts.write(task.tag, sorted(rows, key=lambda row: row["row"]))
            del self._open[task.tag]


def _schema(columns: Sequence[Varied]) -> pa.Schema:
    import pyarrow as pa

    kinds = {"string": pa.string(), "double": pa.float64(), "int64": pa.int64(), "bool": pa.bool_()}
    fields = [
        pa.field("row", pa.int64()),
        pa.field("name", pa.string()),
        *(pa.field(c.header, kinds["double" if c.spec.is_number else "string"]) for c in columns),
        *(pa.field(name, kinds[kind]) for name, kind in RESULT_COLUMNS),
    ]
    return pa.schema(fields, metadata=stated_columns([one.name for one in fields]))


class _Parts:
    """Chunks on the disk, and the one file they become."""

    def __init__(self, folder: OutFolder, schema: pa.Schema) -> None:
        self._place = folder.path / OWN / "vary"
        self._schema = schema

    def begin(self, fingerprint: Mapping[str, Any], resume: bool) -> None:
        """Begin anew, or go on where the same programme ended."""
        manifest = self._place / "programme.json"
        if resume and manifest.is_file():
            if json.loads(manifest.read_text(encoding="utf-8")) == fingerprint:
                return
            raise TableRefused(
                [
                    "the table, the base case, --method or --tolerance, or torsionbook has changed "
                    "since. Run without --resume."
                ]
            )
        shutil.rmtree(self._place, ignore_errors=True)
        self._place.mkdir(parents=True)
        manifest.write_text(json.dumps(dict(fingerprint)), encoding="utf-8")

    def _part(self, number: int) -> Path:
        return self._place / f"{number:07}.parquet"

    def has(self, number: int) -> bool:
        """Whether a chunk is done."""
        return self._part(number).is_file()

    def write(self, number: int, rows: Sequence[Mapping[str, Any]]) -> None:
        """Write a chunk whole or not at all."""
        import pyarrow as pa
        import pyarrow.parquet as pq

        table = pa.Table.from_pylist(list(rows), schema=self._schema)
        new = self._place / "new"
        pq.write_table(table, new, compression="zstd")
        with open(new, "rb+") as file:
            os.fsync(file.fileno())
        os.replace(new, self._part(number))

    def join(self, programme: Programme) -> dict[str, int]:
        """Make one file of the chunks that are there, a few at a time; rows by outcome."""
        import pyarrow as pa
        import pyarrow.parquet as pq

        counts: dict[str, int] = {}
        new = self._place / "joined"
        parts = iter(sorted(self._place.glob("*.parquet")))
        with (
            pq.ParquetWriter(new, self._schema, compression="zstd") as writer,
            _csv_writer(self._place / "csv", programme, self._schema.names) as write,
        ):
            while some := list(islice(parts, _GROUPED)):
                table = pa.concat_tables([pq.read_table(part) for part in some])
                writer.write_table(table)
                write(table)
                for one in table["outcome"].value_counts():
                    outcome = one["values"].as_py()
                    counts[outcome] = counts.get(outcome, 0) + one["counts"].as_py()
        os.replace(new, programme.result)
        if programme.csv is not None:
            os.replace(self._place / "csv", programme.csv)
        return counts


@contextlib.contextmanager
def _csv_writer(
    place: Path, programme: Programme, headers: Sequence[str]
) -> Iterator[Callable[[pa.Table], None]]:
    """What writes the rows of a result as CSV; nothing where none is asked for."""
    from addin.batch.summary import guarded

    if programme.csv is None:
        yield lambda table: None
        return

    def shown(value: Any) -> Any:
        if isinstance(value, str):
            return guarded(value)
        return repr(value).replace(".", ",") if programme.comma and type(value) is float else value

    # With a byte order mark, without which Excel would not read it as UTF-8.
    with open(place, "w", encoding="utf-8-sig", newline="") as file:
        writer = csv.writer(file, delimiter=programme.form.separator)
        writer.writerow(map(shown, headers))
        yield lambda table: writer.writerows(map(shown, row.values()) for row in table.to_pylist())
