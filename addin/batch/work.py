"""One file → its record and its result files. Runs in any process, on any machine.

Tasks and answers are plain values that can be pickled; nothing is kept between two tasks but what
Python itself keeps. Files come by their path or as bytes; results go to a staging folder or back as
bytes.
"""

from __future__ import annotations

import pickle
import time
import traceback
import uuid
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any

from addin.batch.folder import digest_of, digested
from addin.batch.inputs import result_name
from addin.batch.records import (
    DONE,
    FAULT,
    WRONG_INPUT,
    Output,
    Record,
    Stamp,
    as_errors,
    failed,
    outcome_of,
)
from addin.calculation.key_figures import key_figures
from addin.contract.problems import CellProblem, printable
from addin.contract.version import product_version
from addin.reading.one_file import Unreadable, file_problem, read_checked
from addin.reading.typed_case import CaseInput
from addin.writing.recalculate import PreparedInput, recalculate
from addin.xlsx.errors import WorkbookLocked
from addin.xlsx.locks import check_not_open
from addin.xlsx.temporary import temporary_folder
from engine.case.data import case_digest
from engine.results.results import Results


@dataclass(frozen=True)
class Examine:
    """The task of reading a file without calculating it."""

    name: str  #: As in `Record`.
    source: str  #: Likewise.
    content: bytes | None = None  #: The file, where it is not to be read from its path. [bytes]
    stamp: Stamp = Stamp(0, 0, "")  #: Its state, where it comes as bytes.


@dataclass(frozen=True)
class Examined:
    """What reading a file showed."""

    record: Record | None  #: Why it cannot be calculated; None if it can.
    case_sha256: str = ""  #: Digest of its case; empty if it cannot be calculated. [hexadecimal]


@dataclass(frozen=True)
class Work(Examine):
    """The task of calculating a file."""

    target: str = ""  #: Where its result belongs in the end.
    root: str = ""  #: Folder of results, to which the names of outputs are relative.
    #: Folder of its own, to be made, for its results; empty if they are to come back as bytes.
    staging: str = ""
    known: bytes | None = None  #: Pickled `Results` of the same case. [bytes]
    known_file: str = ""  #: The same in a file.
    same_as: str = ""  #: File whose calculation that was.
    case_sha256: str = ""  #: The case that was examined. [hexadecimal]
    keep: bool = False  #: Send `Results` back too.
    #: Calculate although lock files say somebody has the workbook or its result open.
    ignore_lock: bool = False
    #: That somebody has the workbook itself open does not matter: the file as saved counts.
    may_be_open: bool = False
    #: Fields of the case that the command line sets. [SI]
    overrides: Mapping[str, Any] = field(default_factory=dict)
    json: str = ""  #: Name of the results as JSON, as in `Output`; empty if they are not wanted.
    history: str = ""  #: As in `Input`.


@dataclass(frozen=True)
class Calculated:
    """What became of a file."""

    record: Record  #: Its outputs wait in the staging folder, or in `files`.
    results: bytes | None = None  #: Pickled `Results` where they were asked for. [bytes]
    #: Result files by name, where there is no staging folder. [bytes]
    files: dict[str, bytes] = field(default_factory=dict)


def examine(task: Examine) -> Examined:
    """Read a file and find what it holds."""
    began = time.perf_counter()
    try:
        with _file_of(task) as (source, stamp):
            read = read_checked(source)
    except OSError as wrong:
        return Examined(refused(task, wrong))
    if read.problems:
        return Examined(_wrong(task, read, stamp, time.perf_counter() - began))
    data = read.data  # type: ignore[union-attr]
    return Examined(None, case_digest(data))


@contextmanager
def _file_of(task: Examine) -> Iterator[tuple[Path, Stamp]]:
    """The file of a task and its state; one that comes as bytes in a temporary folder."""
    if task.content is None:
        source = Path(task.source)
        yield source, digested(source)
        return
    with temporary_folder() as folder:
        source = Path(folder, "in", Path(task.name).name)
        source.parent.mkdir()
        source.write_bytes(task.content)
        yield source, task.stamp


def calculate(task: Work) -> Calculated:
    """Calculate a file and write its results into the staging folder."""
    try:
        with _file_of(task) as (source, stamp):
            if task.content is None:
                # A folder for each attempt: one that was begun by a worker that died is left aside.
                return _calculated(task, source, stamp, Path(task.staging, uuid.uuid4().hex[:8]))
            staging = source.parents[1] / "out"
            done = _calculated(task, source, stamp, staging)
            outputs = {
                output.name: staging / Path(output.name).name for output in done.record.outputs
            }
            return replace(done, files={name: path.read_bytes() for name, path in outputs.items()})
    except OSError as wrong:
        return Calculated(refused(task, wrong))
    except Exception:  # one file's fault never ends a batch; its record says what happened
        sentence = (
            f"{task.name}: this is an error inside torsionbook; nothing was written for this file. "
            f"Please report it: {traceback.format_exc()}"
        )
        return Calculated(failed(task.name, task.source, FAULT, sentence))


def _calculated(task: Work, source: Path, stamp: Stamp, staging: Path) -> Calculated:
    began = time.perf_counter()
    locked = is_locked(task)
    if locked is not None:
        return Calculated(refused(task, locked))
    read = read_checked(source)
    if read.problems:
        return Calculated(_wrong(task, read, stamp, time.perf_counter() - began))
    digest = case_digest(read.data)  # type: ignore[union-attr]
    known = _known(task) if digest == task.case_sha256 else None
    done = recalculate(
        source,
        destination=staging / Path(result_name(task.name)).name,
        json_file=staging / Path(task.json).name if task.json else None,
        overrides=task.overrides,
        ignore_lock=task.ignore_lock or task.may_be_open,
        prepared=PreparedInput(read, known, task.history),
    )
    seconds = time.perf_counter() - began
    facts: dict[str, Any] = {
        "stamp": stamp,
        "case_sha256": digest,
        "warnings": tuple(done.warnings),
        "seconds": seconds,
    }
    calculation = done.calculation
    if calculation is None or done.problems:
        return Calculated(replace(_not_done(task, done.problems, done.cause), **facts))
    figures = key_figures(calculation.results, calculation.tables.get("StartupPeaks", ()))
    record = Record(
        task.name,
        task.source,
        DONE,
        same_as="" if known is None else task.same_as,
        results=asdict(figures),
        outputs=_outputs(task, staging),
        version=product_version(),
        **facts,
    )
    results = pickle.dumps(calculation.results, pickle.HIGHEST_PROTOCOL) if task.keep else None
    return Calculated(record, results)


def is_locked(task: Work) -> Exception | None:
    """Why a file is not calculated, where somebody has it or its result open."""
    if task.ignore_lock or task.content is not None:
        return None
    try:
        if not task.may_be_open:
            check_not_open(Path(task.source))
        if task.target:
            check_not_open(Path(task.target))
    except WorkbookLocked as wrong:
        return wrong
    return None


def _known(task: Work) -> Results | None:
    """Results of the same case, calculated for another file of this batch."""
    content = task.known
    if task.known_file:
        try:
            content = Path(task.known_file).read_bytes()
        except OSError:  # then this file is calculated by itself
            return None
    return None if content is None else pickle.loads(content)


def _outputs(task: Work, staging: Path) -> tuple[Output, ...]:
    """The result files in the staging folder."""
    parent = task.name.rpartition("/")[0]
    prefix = f"{parent}/" if parent else ""
    inside = bool(task.staging)
    json = Path(task.json).name if task.json else ""
    return tuple(
        Output(
            task.json if file.name == json else prefix + file.name,
            file.stat().st_size,
            digest_of(file),
            file.relative_to(task.root).as_posix() if inside else "",
        )
        for file in sorted(staging.iterdir())
    )


def _wrong(task: Examine, read: CaseInput | Unreadable, stamp: Stamp, seconds: float) -> Record:
    """The record of an input with errors."""
    cause = getattr(read, "cause", None)
    problems = read.problems
    if cause is not None:  # by its name in the batch, not by its place on this machine
        problems = tuple(
            replace(p, found=task.name) if str(p.found) == printable(str(task.source)) else p
            for p in problems
        )
    record = _not_done(task, problems, cause)
    return replace(record, stamp=stamp, warnings=tuple(read.warnings), seconds=seconds)


def _not_done(
    task: Examine, problems: Sequence[CellProblem], cause: BaseException | None
) -> Record:
    """The record of a file that was not read, calculated or written."""
    more = f" (and {len(problems) - 1} more)" if len(problems) > 1 else ""
    return Record(
        task.name,
        task.source,
        WRONG_INPUT if cause is None else outcome_of(cause),
        f"{problems[0].message}{more}",
        errors=as_errors(problems),
    )


def refused(task: Examine, wrong: Exception) -> Record:
    """The record of a file that cannot be used at all."""
    sentence = file_problem(Path(task.source), wrong).message
    return failed(task.name, task.source, outcome_of(wrong), sentence)
