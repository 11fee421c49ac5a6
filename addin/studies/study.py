"""What a study is: its check, its calculation, the options of its command, and what it shows.

A study reads its own input tables beside the case, calculates units of work wherever `ParallelMap` takes
them, and writes its own result tables and nothing else.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from addin.contract.study_spec import StudySpec
from addin.reading.typed_case import CaseInput
from addin.workers.parallel_map import ParallelMap, map_until_cancelled
from engine.case.case import Case
from engine.case.study_inputs import DisplayUnit, StudyInputs
from engine.errors import Problem

#: Largest seed that is taken. [count]
LARGEST_NUMBER = 2**63 - 1


@dataclass(frozen=True)
class CutShort:
    """How far a study came before Ctrl-C, where a part of it may be reported."""

    calculated: int  #: Of what the sentence names.
    planned: int  #: Likewise.
    sentence: str  #: The same in words, and what it means for the results.


@dataclass(frozen=True, eq=False)
class StudyResult:
    """What a study shows, ready to be shown."""

    result: Any  #: The engine's frozen result. [SI]
    #: Rows of the result tables, by table name, under JSON keys. [SI]
    tables: Mapping[str, Sequence[Mapping[str, Any]]]
    sentence: str  #: What was found, in words, for the sheet and the terminal.
    digest: str  #: Of the rows and settings that it was made from. [hexadecimal]
    warnings: tuple[str, ...] = ()  #: What the engineer should know.
    #: More for the JSON alone, or in place of a table that the sheet shows in part. [SI]
    details: Mapping[str, Any] = field(default_factory=dict)
    #: Rows of tables that the workbook alone has: maps, and numbers behind charts. [SI]
    charts: Mapping[str, Sequence[Mapping[str, Any]]] = field(default_factory=dict)
    cut_short: CutShort | None = None  #: How far it came, if it was not completed.
    remarks: tuple[str, ...] = ()  #: Lines for the terminal below the sentence.
    #: What the engineer typed in, for the terminal; see `StudyInputs`. [units]
    units: Mapping[tuple[str, str], DisplayUnit] = field(default_factory=dict)


@dataclass(frozen=True)
class StudyPart:
    """One part of a study, calculated alone."""

    sentence: str  #: What it is.
    rows: tuple[tuple[str, str], ...]  #: Names and values for the terminal.
    #: Writes its files and says which.
    save: Callable[[], Iterable[Path]] = lambda: ()


@dataclass(frozen=True)
class StudyTask:
    """What one study is asked, and where its units of work are done."""

    case: Case  #: The checked case. [SI]
    inputs: StudyInputs  #: Its checked rows. [SI]
    settings: Mapping[str, Any]  #: Of its command. [names and values]
    parallel_map: ParallelMap  #: Where units of work are done.
    tell: Callable[[str], None]  #: Called with a word on what is being done.

    def map(
        self, do: Callable[[Any], Any], units: Sequence[Any], stage: Callable[[int], str]
    ) -> list[Any]:
        """What a function makes of each unit; how many are done is reported in the words of `stage`."""
        return self.parallel_map(do, units, lambda done: self.tell(stage(done)))

    def map_until_cancelled(
        self, do: Callable[[Any], Any], units: Sequence[Any], stage: Callable[[int], str]
    ) -> list[Any]:
        """As `map`, but after Ctrl-C the answers of the first units, as many as there are."""
        return map_until_cancelled(
            self.parallel_map, do, units, lambda done: self.tell(stage(done))
        )


@dataclass(frozen=True)
class TerminalTable:
    """A table for the terminal."""

    columns: tuple[tuple[str, str], ...]  #: Headers, and whether each is of names, numbers or text.
    rows: Sequence[Sequence[str]]  #: Cells.


@dataclass(frozen=True)
class Option:
    """One option of the command of a study."""

    name: str  #: As on the command line, without the dashes.
    kind: type  #: int, str, bool or Path.
    default: Any  #: Unless given.
    help: str  #: What it says of itself.
    least: int | None = None  #: Smallest whole number.
    most: int | None = None  #: Largest whole number.
    words: tuple[str, ...] = ()  #: What a text may be.
    metavar: str | None = None  #: What its value is called.
    #: Endings of a file that may be named instead of, or beside, its number; it is kept under the name of the
    #: option and ``_file``.
    file_endings: tuple[str, ...] = ()
    file_help: str = ""  #: What the command says of that file, behind the other help.
    #: Whether it changes what is calculated; other options are for the terminal and further files.
    is_setting: bool = True

    @property
    def allowed(self) -> str:
        """What it may be, so that it reads well after "must be"."""
        if self.words:
            return " or ".join(self.words)
        if self.kind is bool:
            return "true or false"
        if self.most is None:
            return f"a whole number, {self.least} or more"
        return f"a whole number from {self.least} to {self.most:,}"

    def takes(self, value: Any) -> bool:
        """Whether it may have a value."""
        if type(value) is not self.kind:  # a flag is no number here
            return False
        if isinstance(value, int) and self.kind is int:
            return (self.least or 0) <= value <= (self.most or LARGEST_NUMBER)
        return not self.words or value in self.words


def wrong_setting(command: str, options: Sequence[Option], settings: Mapping[str, Any]) -> str:
    """What is wrong with the settings of a study, in a sentence; empty where nothing is."""
    known = {option.name: option for option in options if option.is_setting}
    for name, value in settings.items():
        if name not in known:
            all_of_them = f"Available: {', '.join(known)}" if known else "It has none"
            return f"{command} has no setting '{name[:40]}'. {all_of_them}."
        if not known[name].takes(value):
            return f"{name} must be {known[name].allowed}."
    return ""


@dataclass(frozen=True)
class Study:
    """One kind of study; found by its module in `addin.studies`, the only `Study` of that."""

    spec: StudySpec  #: Its tables, sheets and command.
    calculate: Callable[[StudyTask], StudyResult]  #: What it does.
    #: Case and inputs → every problem of its rows.
    check: Callable[[Case, StudyInputs], Sequence[Problem]] = lambda case, inputs: ()
    #: Help of its command: a line, a blank line, and more; by default what its sheet says. [markdown]
    help: str = ""
    options: tuple[Option, ...] = ()  #: What its command takes beside what all take.
    #: Result and options → what the terminal shows above the sentence.
    terminal: Callable[[StudyResult, Mapping[str, Any]], Iterable[TerminalTable | str]] = (
        lambda result, options: ()
    )
    #: Result, options and input → further files, written one by one.
    save: Callable[[StudyResult, Mapping[str, Any], Path], Iterable[Path]] = (
        lambda result, options, source: ()
    )
    #: Why further files cannot be written as the options name them; empty where they can.
    refusal: Callable[[Mapping[str, Any]], str] = lambda options: ""
    #: Task, options → sentences and further files of one part calculated alone, instead of the
    #: study, where the options ask for one; else None.
    part: Callable[[StudyTask, Mapping[str, Any]], StudyPart | None] = lambda task, options: None
    part_options: tuple[str, ...] = ()  #: Options that ask for one.
    #: Whether it calculates whole cases, so that `PulsationPhase` may be worst; else its starts need one phase.
    takes_worst_phase: bool = False
    #: Whether it measures times: it then has this process, and no other runs beside it.
    measures_time: bool = False
    #: Input, destination, `StudyResult` and whether locks are ignored → sentences, where it has no
    #: sheets of its own as studies have.
    write: Callable[[CaseInput, Path | None, StudyResult, bool], tuple[str, ...]] | None = None
    #: `StudyResult`, input and warnings → its JSON, where that has another form.
    as_json: Callable[[StudyResult, CaseInput, tuple[str, ...]], dict[str, Any]] | None = None

    @property
    def key(self) -> str:
        """Names it in JSON and in the facts of its sheet."""
        return self.spec.key

    @property
    def command(self) -> str:
        """Its command, and the middle of the names of its files."""
        return self.spec.command

    @property
    def command_help(self) -> str:
        """Help of its command. [markdown]"""
        return self.help or self.spec.intro

    @property
    def inputs(self) -> tuple[str, ...]:
        """Input tables that it reads. [names]"""
        return self.spec.input_names
