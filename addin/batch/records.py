"""What became of one file: a record of plain values, as the journal keeps it."""

from __future__ import annotations

import errno
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from addin.calculation.key_figures import verdict_text
from addin.contract.problems import CellProblem
from addin.workers.stop import causes
from addin.xlsx.errors import SourceChanged, WorkbookLocked, WorkbookRefused

DONE = "done"
WRONG_INPUT = "wrong input"
UNREADABLE = "unreadable"
MISSING = "missing"
LOCKED = "locked"
CHANGED = "changed meanwhile"
NO_ACCESS = "no access"
DISK_FULL = "disk full"
CRASHED = "crashed"
FAULT = "fault"

#: Outcomes that follow from the file alone: the same file gives them again.
SETTLED = frozenset({DONE, WRONG_INPUT, UNREADABLE})

#: Outcomes after which results of an earlier calculation are not true any more, or may not be.
OUTDATED = frozenset({WRONG_INPUT, UNREADABLE, CRASHED, FAULT})

#: What became of a result that is not true any more: its name, its new one; its name, why.
AN_EARLIER = "{} is the result of an earlier calculation; it was renamed to {}."
NOT_RENAMED = (
    "{} is the result of an earlier calculation, not of this input; it could not be "
    "renamed ({}). Do not use it."
)

_FULL = (errno.ENOSPC, errno.EDQUOT) if hasattr(errno, "EDQUOT") else (errno.ENOSPC,)
_FORBIDDEN = (errno.EACCES, errno.EPERM, errno.EROFS)


@dataclass(frozen=True)
class Stamp:
    """Which state of a file: its size, when it was saved, what it held."""

    size: int  #: Bytes.
    modified: int  #: Time of its last change. [ns]
    sha256: str  #: Digest of its bytes; empty if it could not be read. [hexadecimal]


@dataclass(frozen=True)
class Output:
    """One result file."""

    #: Path inside the folder of results, with ``/``; of a JSON that is wanted elsewhere the full
    #: one.
    name: str
    size: int  #: Bytes.
    sha256: str  #: Digest of its bytes. [hexadecimal]
    staged: str = ""  #: Where it waits to be put in place, inside the folder of results.


@dataclass(frozen=True)
class Record:
    """What became of one file."""

    name: str  #: The file, relative to where its batch began.
    source: str  #: Its full path.
    outcome: str  #: `DONE`, `WRONG_INPUT`, `LOCKED`, ...
    sentence: str = ""  #: What happened and what to do; empty when done.
    stamp: Stamp = Stamp(0, 0, "")  #: The state that was calculated.
    case_sha256: str = ""  #: Digest of the case; empty if it could not be read. [hexadecimal]
    same_as: str = ""  #: File whose calculation these results are; empty for its own.
    #: Fields of `addin.calculation.key_figures.KeyFigures`; empty unless done. [SI]
    results: Mapping[str, Any] = field(default_factory=dict)
    warnings: tuple[str, ...] = ()  #: What the engineer should know.
    #: Problems in the form of the contract, and ``cell``.
    errors: tuple[Mapping[str, Any], ...] = ()
    outputs: tuple[Output, ...] = ()  #: Result files.
    seconds: float = 0.0  #: What it took. [s]
    version: str = ""  #: Version that calculated it.
    #: Fields of the case that the command line set. [SI]
    settings: Mapping[str, Any] = field(default_factory=dict)

    @property
    def done(self) -> bool:
        """Whether its results are there."""
        return self.outcome == DONE

    @property
    def verdict(self) -> str:
        """The overall verdict, and how many checks have none; empty unless done. [words]"""
        results = self.results
        if not results:
            return ""
        return verdict_text(str(results.get("verdict")), int(results.get("not_judged", 0)))

    @property
    def settled(self) -> bool:
        """Whether the same file would give the same outcome."""
        return self.outcome in SETTLED

    @classmethod
    def from_json(cls, content: Mapping[str, Any]) -> Record:
        """The record whose fields an object of JSON holds."""
        return replace(
            cls(**content),
            stamp=Stamp(**content["stamp"]),
            warnings=tuple(content["warnings"]),
            errors=tuple(content["errors"]),
            outputs=tuple(Output(**output) for output in content["outputs"]),
        )


def failed(name: str, source: str, outcome: str, sentence: str, **more: Any) -> Record:
    """The record of a file without results, its sentence among its errors."""
    problem = CellProblem("", "", None, "", outcome, "a file that can be used", sentence)
    return Record(name, source, outcome, sentence, errors=as_errors([problem]), **more)


def as_errors(problems: Iterable[CellProblem]) -> tuple[dict[str, Any], ...]:
    """Problems as a record keeps them."""
    return tuple(problem.as_json() | {"cell": problem.cell} for problem in problems)


def outcome_of(cause: BaseException) -> str:
    """The outcome that an exception stands for."""
    if isinstance(cause, WorkbookLocked):
        return LOCKED
    if isinstance(cause, SourceChanged):
        return CHANGED
    for error in causes(cause):
        if isinstance(error, FileNotFoundError):
            return MISSING
        if isinstance(error, OSError) and error.errno in _FULL:
            return DISK_FULL
        if isinstance(error, OSError) and error.errno in _FORBIDDEN:
            return NO_ACCESS
    if isinstance(cause, WorkbookRefused):
        return UNREADABLE
    # A disk or a network that fails is no fault of the input: the next run tries again.
    return NO_ACCESS if any(isinstance(e, OSError) for e in causes(cause)) else WRONG_INPUT
