"""One case, many values: a programme of cases from a table, streamed to Parquet, CSV or both.

Each column of the table names an input of the base case, each row is a case: ``DampingRatio``,
``Elements[LS coupling].Stiffness``, ``MotorTorque[3].Pulsating``. A number is in the unit that stands
in brackets behind the name, ``Elements[LS coupling].Stiffness [lbf*in/rad]``; without one it is in SI,
as in a case JSON; a text such as ``12 %`` carries its own. A blank leaves what the base case says.

Rows are read, calculated and written in chunks, so that a programme of any length needs the same
memory. Each chunk is a JSON file of its own until the end; a chunk that is there is whole.
"""

from __future__ import annotations

import contextlib
import csv
import json
import os
import pickle
import shutil
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import islice
from pathlib import Path
from typing import Any

from addin.batch.folder import OWN, OutFolder, digest_of
from addin.batch.own_files import IS_OURS, RESULT, RESULT_COLUMNS, RESULT_CSV, stated_columns
from addin.batch.records import AN_EARLIER, CRASHED, DONE, NOT_RENAMED, OUTDATED, outcome_of
from addin.batch.scheduler import Listener
from addin.batch.summary import guarded
from addin.batch.vary_columns import TableRefused, read_columns
from addin.batch.vary_rows import Chunk, calculate_rows
from addin.batch.vary_table import ROWS, CsvForm, VariedTable
from addin.contract.version import product_version
from addin.reading.input_names import NamedInput
from addin.reading.one_file import Unreadable, read_checked
from addin.reading.typed_case import TypedCase
from addin.workers.pool import Crashed, Task, Workers
from addin.workers.stop import Stop, Stopped
from addin.xlsx.places import replace_file
from addin.xlsx.whole_files import put_in_place, write_json

#: Chunks given to the workers before answers come back, a worker. [count]
AHEAD = 3
#: Reasons that are kept for the terminal. [count]
REASONS = 20
#: Chunks that become one row group of the result. [count]
_GROUPED = 50
#: Values of each kind of column.
_KINDS: dict[str, Callable[[Any], Any]] = {
    "string": str,
    "double": float,
    "int64": int,
    "bool": bool,
}
#: Rows of the result, each with the values of its columns.
_Rows = Sequence[Sequence[Any]]


@dataclass(frozen=True)
class ProgrammeSettings:
    """How a programme is calculated, as the command line says."""

    resume: bool = False  #: Go on with an ended programme of the same table and base.
    #: Fields of the case, whatever base and table say. [SI]
    overrides: Mapping[str, Any] = field(default_factory=dict)
    as_csv: bool = False  #: Write ``results.csv``, with the table's separator and decimal sign.
    as_parquet: bool = True  #: Write ``results.parquet``, with pyarrow.

    @property
    def results(self) -> tuple[str, ...]:
        """Names of the files that are written."""
        return (RESULT,) * self.as_parquet + (RESULT_CSV,) * self.as_csv


@dataclass
class Programme:
    """What became of a programme."""

    result: Path | None  #: The Parquet file, where it is asked for.
    rows: int = 0  #: Rows of the table.
    csv: Path | None = None  #: The CSV, where it is asked for.
    form: CsvForm = CsvForm()  #: How that is written.
    comma: bool = False  #: Its decimal sign is the comma.
    #: Rows by outcome; those not reached are missing.
    outcomes: dict[str, int] = field(default_factory=dict)
    kept: int = 0  #: Rows that an earlier run calculated.
    #: The first rows that could not be calculated, and why.
    reasons: list[str] = field(default_factory=list)


def run_programme(
    base: Path,
    table: Path,
    folder: OutFolder,
    workers: Workers,
    settings: ProgrammeSettings,
    *,
    stop: Stop,
    listener: Listener,
) -> Programme:
    """Calculate every row of a table.

    Parameters
    ----------
    base : Path
        Workbook or case JSON. [path]
    table : Path
        CSV or Parquet. [path]
    folder : OutFolder
        Takes the results.
    workers : Workers
        Who does the work.
    settings : ProgrammeSettings
        Given on the command line.
    stop : Stop
        Asked all the time.
    listener : Listener
        Told all the time.

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
    read = VariedTable(table)
    columns, names = read_columns(read.headers(), typed)
    varied = tuple(column for column in columns if column is not None)
    total = read.count()
    comma = read.has_decimal_commas(columns)
    parts = _Parts(folder, _kinds(varied))
    overrides = dict(settings.overrides)
    fingerprint = {
        "base": digest_of(base),
        "table": digest_of(table),
        "rows": ROWS,
        "version": product_version(),
        "settings": overrides,
    }
    parts.begin(fingerprint, settings.resume)
    programme = Programme(folder.place(RESULT) if settings.as_parquet else None, total)
    if settings.as_csv:
        programme.csv = folder.place(RESULT_CSV)
        programme.form = read.form()
        programme.comma = comma
    listener.begin("calculating", total)
    chunk = Chunk(pickle.dumps(typed), varied, (), overrides, comma)
    work = _Work(chunk, names, parts, programme, listener)
    chunks = enumerate(_chunked(read.rows()))
    tasks = (new_task for number, rows in chunks for new_task in work.tasks(number, rows))
    try:
        for new_task in islice(tasks, AHEAD * workers.threads):
            workers.add(new_task)
        for task, answer in workers.answers(stop):
            for new_task in (*work.taken(task, answer), *islice(tasks, 1)):
                workers.add(new_task)
    except OSError as wrong:
        raise Stopped(
            f"Results cannot be written ({wrong.strerror or wrong}). Results written so far are "
            "kept; free disk space, then run again with --resume."
        ) from wrong
    finally:
        with contextlib.suppress(OSError):  # the chunks are there, and --resume joins them
            programme.outcomes = parts.join(programme)
    return programme


def _base(path: Path, folder: OutFolder) -> TypedCase:
    read = read_checked(path)
    if isinstance(read, Unreadable) or read.problems:
        cause = read.cause if isinstance(read, Unreadable) else None
        outdated = cause is None or outcome_of(cause) in OUTDATED
        sentences = [f"base case {path}: {problem.message}" for problem in read.problems]
        raise TableRefused(*sentences, *(_set_aside(folder) if outdated else ()))
    return read.typed


def _set_aside(folder: OutFolder) -> Iterator[str]:
    """Rename results of an earlier base case, which must not be taken for those of this one."""
    for name, is_ours in IS_OURS.items():
        if not is_ours(folder.place(name)):
            continue
        try:
            yield AN_EARLIER.format(name, folder.set_aside(name).name)
        except OSError as wrong:
            yield NOT_RENAMED.format(name, wrong.strerror or wrong)


def _chunked(rows: Iterable[list[Any]]) -> Iterator[list[list[Any]]]:
    rows = iter(rows)
    while chunk := list(islice(rows, ROWS)):
        yield chunk


@dataclass
class _Work:
    """Tasks of a programme and what comes back."""

    like: Chunk  #: A chunk without rows.
    names: int | None  #: Index of the column of names.
    parts: _Parts  #: Takes the results.
    programme: Programme  #: Takes counts and reasons.
    listener: Listener  #: Told of each row.
    #: Chunks under way: how many rows each has, and the results that are there.
    open: dict[int, tuple[int, list[dict[str, Any]]]] = field(default_factory=dict)

    def tasks(self, number: int, rows: Sequence[Sequence[Any]]) -> Iterator[Task]:
        """The task of a chunk; none if an earlier run has done it."""
        if self.parts.has(number):
            self.programme.kept += len(rows)
            for _ in rows:
                self.listener.advance(None)
            return
        first = number * ROWS + 1
        named = tuple(self._split(first + i, row) for i, row in enumerate(rows))
        self.open[number] = (len(rows), [])
        yield Task(calculate_rows, replace(self.like, rows=named), number)

    def _split(self, number: int, row: Sequence[Any]) -> tuple[int, str | None, tuple[Any, ...]]:
        if self.names is None:
            return number, None, tuple(row)
        values = [value for i, value in enumerate(row) if i != self.names]
        name = row[self.names] if self.names < len(row) else None
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
        size, rows = self.open[task.tag]
        rows += answer
        for row in answer:
            self.listener.advance(None)
            if row["outcome"] != DONE and len(self.programme.reasons) < REASONS:
                self.programme.reasons.append(f"row {row['row']}: {row['reason']}")
        if len(rows) == size:
            self.parts.write(task.tag, sorted(rows, key=lambda row: row["row"]))
            del self.open[task.tag]


def _kinds(columns: Sequence[NamedInput]) -> dict[str, str]:
    """Columns of the result, and the kind of each."""
    return {
        "row": "int64",
        "name": "string",
        **{c.name: "double" if c.spec.is_number else "string" for c in columns},
        **{name: kind for name, kind, _ in RESULT_COLUMNS},
    }


class _Parts:
    """Chunks on the disk, and the files they become."""

    def __init__(self, folder: OutFolder, kinds: Mapping[str, str]) -> None:
        self._place = folder.path / OWN / "vary"
        self._kinds = kinds

    def begin(self, fingerprint: Mapping[str, Any], resume: bool) -> None:
        """Begin anew, or go on where the same programme ended."""
        manifest = self._place / "programme.json"
        earlier = _earlier(manifest) if resume else None
        if earlier is not None:
            if earlier == fingerprint:
                return
            raise TableRefused(
                "the table, the base case, --method, --tolerance or torsionbook has changed. Run "
                "without --resume."
            )
        shutil.rmtree(self._place, ignore_errors=True)
        write_json(manifest, fingerprint)

    def _part(self, number: int) -> Path:
        return self._place / f"{number:07}.json"

    def has(self, number: int) -> bool:
        """Whether a chunk is done."""
        return self._part(number).is_file()

    def write(self, number: int, rows: Sequence[Mapping[str, Any]]) -> None:
        """Write a chunk whole or not at all."""
        values = [
            [
                None if row.get(n) is None else _KINDS[kind](row[n])
                for n, kind in self._kinds.items()
            ]
            for row in rows
        ]
        new = self._place / "new"
        with open(new, "w", encoding="utf-8") as file:
            json.dump(values, file)
            file.flush()
            os.fsync(file.fileno())
        replace_file(new, self._part(number))

    def join(self, programme: Programme) -> dict[str, int]:
        """Make one file of the chunks that are there, a few at a time; rows by outcome."""
        counts: Counter[str] = Counter()
        outcome = list(self._kinds).index("outcome")
        parts = iter(sorted(self._place.glob("[0-9]*.json")))
        parquet, text = self._place / "parquet", self._place / "csv"
        with contextlib.ExitStack() as stack:
            writers = []
            if programme.result is not None:
                writers.append(stack.enter_context(_parquet_writer(parquet, self._kinds)))
            if programme.csv is not None:
                writers.append(stack.enter_context(_csv_writer(text, programme, self._kinds)))
            while some := list(islice(parts, _GROUPED)):
                rows = [row for part in some for row in json.loads(part.read_bytes())]
                for write in writers:
                    write(rows)
                counts.update(row[outcome] for row in rows)
        for new, place in ((parquet, programme.result), (text, programme.csv)):
            if place is not None:
                put_in_place(new, place)
        return dict(counts)


def _earlier(manifest: Path) -> Any:
    """What an earlier run was given; None where it did not get so far, or its file is torn."""
    try:
        return json.loads(manifest.read_bytes())
    except (FileNotFoundError, ValueError):
        return None


@contextlib.contextmanager
def _parquet_writer(place: Path, kinds: Mapping[str, str]) -> Iterator[Callable[[_Rows], None]]:
    """What writes rows of the result as Parquet, each time as one row group."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    types = {"string": pa.string(), "double": pa.float64(), "int64": pa.int64(), "bool": pa.bool_()}
    fields = [pa.field(name, types[kind]) for name, kind in kinds.items()]
    schema = pa.schema(fields, metadata=stated_columns(list(kinds)))
    with pq.ParquetWriter(place, schema, compression="zstd") as writer:

        def write(rows: _Rows) -> None:
            columns = zip(zip(*rows, strict=True), schema.types, strict=True)
            arrays = [pa.array(values, of) for values, of in columns]
            writer.write_table(pa.Table.from_arrays(arrays, schema=schema))

        yield write


@contextlib.contextmanager
def _csv_writer(
    place: Path, programme: Programme, headers: Iterable[str]
) -> Iterator[Callable[[_Rows], None]]:
    """What writes rows of the result as CSV."""

    def shown(value: Any) -> Any:
        if isinstance(value, str):
            return guarded(value)
        return repr(value).replace(".", ",") if programme.comma and type(value) is float else value

    # With a byte order mark, without which Excel would not read it as UTF-8.
    with open(place, "w", encoding="utf-8-sig", newline="") as file:
        writer = csv.writer(file, delimiter=programme.form.separator)
        writer.writerow(map(shown, headers))
        yield lambda rows: writer.writerows(map(shown, row) for row in rows)
