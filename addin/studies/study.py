"""What a study is, and one input through it: read, check, calculate, write.

A study reads its own input tables beside the case, calculates units of work wherever `Spread` takes
them, and writes its own result tables and nothing else.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from addin.contract.digests import short_digest
from addin.contract.json_formats import RESULTS_FORMAT
from addin.contract.problems import CellProblem
from addin.contract.study_spec import StudySpec
from addin.reading.one_file import WORKBOOK_ENDINGS, Unreadable, file_problem, read_checked
from addin.writing.recalculate import case_problems
from addin.xlsx.whole_files import write_json

if TYPE_CHECKING:
    from addin.reading.typed_case import CaseInput
    from addin.workers.parallel_map import Spread
    from engine.case.case import Case
    from engine.case.study_inputs import DisplayUnit, StudyInputs
    from engine.errors import Problem

__all__ = ["CutShort", "Found", "Study", "Studied", "made_of", "study_one", "to_json"]


@dataclass(frozen=True)
class CutShort:
    """How far a study came before Ctrl-C, where a part of it may be told."""

    calculated: int  #: Of what the sentence names.
    planned: int  #: Likewise.
    sentence: str  #: The same in words, and what it means for the results.


@dataclass(frozen=True, eq=False)
class Found:
    """What a study found, ready to be shown."""

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
    cut_short: CutShort | None = None  #: How far it came, if it did not come to its end.
    #: What the engineer typed in, for the terminal; see `StudyInputs`. [units]
    units: Mapping[tuple[str, str], DisplayUnit] = field(default_factory=dict)


@dataclass(frozen=True)
class Study:
    """One kind of study."""

    spec: StudySpec  #: Its tables, sheets and command.
    #: Case, inputs and settings → every problem of its rows.
    check: Callable[[Case, StudyInputs, Mapping[str, Any]], Sequence[Problem]]
    #: Case, inputs, settings, `Spread` and what is told the stage → `Found`.
    calculate: Callable[
        [Case, StudyInputs, Mapping[str, Any], Spread, Callable[[str], None]], Found
    ]
    #: Input, destination, `Found` and whether locks are ignored → sentences, where it has no
    #: sheets of its own as studies have.
    write: Callable[[CaseInput, Path | None, Found, bool], tuple[str, ...]] | None = None
    #: `Found`, input and warnings → its JSON, where that has another form.
    as_json: Callable[[Found, CaseInput, tuple[str, ...]], dict[str, Any]] | None = None

    @property
    def key(self) -> str:
        """Names it in JSON and in the facts of its sheet."""
        return self.spec.key

    @property
    def command(self) -> str:
        """Its command, and the middle of the names of its files."""
        return self.spec.command

    @property
    def inputs(self) -> tuple[str, ...]:
        """Input tables that it reads. [names]"""
        return self.spec.input_names


@dataclass(frozen=True, eq=False)
class Studied:
    """What became of one input."""

    source: Path  #: The input.
    found: Found | None  #: The study; None if something was wrong. [SI]
    problems: tuple[CellProblem, ...]  #: Everything wrong with the input.
    warnings: tuple[str, ...]  #: What the engineer should know.
    written: tuple[Path, ...] = ()  #: Files written: workbook, JSON.


def study_one(
    study: Study,
    source: Path,
    spread: Spread,
    settings: Mapping[str, Any],
    *,
    destination: Path | None = None,
    in_place: bool = False,
    json_file: Path | None = None,
    ignore_lock: bool = False,
    on_stage: Callable[[str], None] = lambda stage: None,
) -> Studied:
    """Study one input and write what it showed.

    Parameters
    ----------
    study : Study
        What is asked.
    source : Path
        Workbook or case JSON. [path]
    spread : Spread
        Where units of work are done.
    settings : mapping
        Of the command line. [names and values]
    destination : Path, optional
        Where the copy of the workbook goes; default beside it, ``train.tune.xlsx``. [path]
    in_place : bool
        Write into the workbook itself; it stays as ``.bak``. [flag]
    json_file : Path, optional
        Where the JSON goes; of a case JSON by default ``case.tune.json``. [path]
    ignore_lock : bool
        Go on although a lock file says somebody has the workbook open. [flag]
    on_stage : callable, optional
        Called with a word on what is being done.

    Raises
    ------
    addin.workers.parallel_map.Cancelled
        After Ctrl-C, where what was calculated is not enough to be told; nothing is written.
    """
    from addin.xlsx.errors import PackageError

    on_stage("reading")
    read = read_checked(source)
    if isinstance(read, Unreadable):
        return Studied(source, None, read.problems, read.warnings)
    is_workbook = source.suffix.lower() in WORKBOOK_ENDINGS
    missing = _missing_sheets(read, study) if is_workbook else []
    if missing and json_file is None:
        return Studied(source, None, (*_unread(study, read), *missing), _warned(read))
    found, problems, told = made_of(study, read, spread, settings, on_stage)
    if found is None:
        return Studied(source, None, problems, told)
    warnings = list(told)
    on_stage("writing")
    files: list[Path] = []
    try:
        if is_workbook and not missing:
            target = source if in_place else destination or beside(source, study)
            target.parent.mkdir(parents=True, exist_ok=True)
            write = study.write or partial(_write, study)
            warnings += write(read, None if in_place else target, found, ignore_lock)
            files.append(target)
        elif is_workbook:
            warnings.append(
                f"{source.name} has no sheets for this study: its results are in the JSON only."
            )
        elif json_file is None:
            json_file = destination or beside(source, study)
        if json_file is not None:
            as_json = study.as_json or partial(to_json, study)
            write_json(json_file, as_json(found, read, tuple(warnings)))
            files.append(json_file)
    except (PackageError, OSError) as failed:
        problem = file_problem(source, failed)
        return Studied(source, None, (problem,), tuple(warnings), tuple(files))
    return Studied(source, found, (), tuple(warnings), tuple(files))


def made_of(
    study: Study,
    read: CaseInput,
    spread: Spread,
    settings: Mapping[str, Any],
    on_stage: Callable[[str], None],
) -> tuple[Found | None, tuple[CellProblem, ...], tuple[str, ...]]:
    """Make a study of an input that has been read; nothing is written.

    Parameters
    ----------
    study : Study
        What is asked.
    read : CaseInput
        The input. [SI]
    spread : Spread
        Where units of work are done.
    settings : mapping
        Of the command line. [names and values]
    on_stage : callable
        Called with a word on what is being done.

    Returns
    -------
    found : Found or None
        None if something is wrong. [SI]
    problems : tuple of CellProblem
        Everything wrong. [problems]
    warnings : tuple of str
        What the engineer should know. [sentences]
    """
    from engine.case.study_inputs import StudyInputs
    from engine.errors import CaseError, ModelError

    inputs = StudyInputs() if read.studies is None else read.studies.inputs
    warnings, unread = _warned(read), _unread(study, read)
    if read.problems:
        return None, unread, warnings
    try:
        case = read.case()
        wrong = study.check(case, inputs, settings)
        if unread or wrong:
            return None, _told(read, study, wrong), warnings
        found = _said(study.calculate(case, inputs, settings, spread, on_stage))
    except (CaseError, ModelError) as refused:
        return None, (*unread, *case_problems(refused)), warnings
    return found, (), (*warnings, *found.warnings)


def _unread(study: Study, read: CaseInput) -> tuple[CellProblem, ...]:
    """What cannot be read of the case, and of the tables of the study."""
    more = () if read.studies is None else read.studies.problems_of(study.inputs)
    return (*read.problems, *more)


def _warned(read: CaseInput) -> tuple[str, ...]:
    return (*read.warnings, *(() if read.studies is None else read.studies.warnings))


def _said(found: Found) -> Found:
    """That a study was cut short stands before anything else it says."""
    if found.cut_short is None:
        return found
    return replace(found, sentence=f"{found.cut_short.sentence} {found.sentence}")


def beside(source: Path, study: Study) -> Path:
    """Default name of what a study writes: train.tune.xlsx, case.tune.json."""
    return source.with_name(f"{source.stem}.{study.command}{source.suffix}")


def to_json(
    study: Study, found: Found, read: CaseInput, warnings: tuple[str, ...]
) -> dict[str, Any]:
    """A study as JSON: its result tables under their keys, as in results of the contract.

    Parameters
    ----------
    study : Study
        The study.
    found : Found
        What it found. [SI]
    read : CaseInput
        Its case.
    warnings : tuple of str
        What the engineer should know. [sentences]

    Returns
    -------
    dict
        Keys format, study, case_sha256, study_sha256, version, sentence, warnings, errors, one a
        result table, the details of the study, and cut_short where it was.
    """
    from addin.contract.version import product_version
    from addin.writing.results_json import table_rows
    from engine.case.data import case_digest

    cut = found.cut_short
    part = {} if cut is None else {"calculated": cut.calculated, "planned": cut.planned}
    return {
        "format": RESULTS_FORMAT,
        "study": study.key,
        "case_sha256": case_digest(read.data),
        "study_sha256": found.digest,
        "version": product_version(),
        "sentence": found.sentence,
        "warnings": list(warnings),
        "errors": [],
        **({"cut_short": part} if part else {}),
        **{_key(name): table_rows(name, rows) for name, rows in found.tables.items()},
        **found.details,
    }


def _key(table: str) -> str:
    from addin.contract.tables import json_key

    return json_key(table)


def _told(read: CaseInput, study: Study, wrong: Sequence[Problem]) -> tuple[CellProblem, ...]:
    """Problems of the study's rows with their cells; of a case without such tables as they are."""
    if read.studies is not None:
        return read.studies.problems_of(study.inputs, wrong)
    from addin.contract.problems import placed
    from addin.contract.tables import input_table

    return tuple(placed(one, input_table(one.table).sheet, "", "cell") for one in wrong)


def _missing_sheets(read: CaseInput, study: Study) -> list[CellProblem]:
    """A workbook without the sheets of the study, as one problem."""
    from addin.contract.tables import input_table, result_table
    from addin.reading.workbook import WorkbookInput

    assert isinstance(read, WorkbookInput)
    known = {name.casefold() for name in read.workbook.tables}
    needed = (*study.inputs, *study.spec.result_names)
    absent = [name for name in needed if name.casefold() not in known]
    if not absent:
        return []
    first = absent[0]
    spec = input_table(first) if first in study.inputs else result_table(first)
    name = read.path.name
    sentence = (
        f"the workbook has no table {', '.join(absent)}, which torsionbook {study.command} needs. "
        f"torsionbook new studies-{name} --studies --from {name} makes a workbook with the same inputs "
        "and the sheets of the studies; or say --json for results without a sheet."
    )
    return [CellProblem(spec.sheet, first, None, "", None, f"table {first}", sentence, "")]


def _write(
    study: Study, read: CaseInput, destination: Path | None, found: Found, ignore_lock: bool
) -> tuple[str, ...]:
    """Write a study into the workbook it was read from; sentences the user should read."""
    from addin.calculation.audit import Stamp
    from addin.reading.workbook import WorkbookInput
    from addin.recorded.studies import rows_digest
    from addin.writing.workbook import write_study_results
    from engine.case.data import case_digest
    from engine.case.study_inputs import StudyInputs

    assert isinstance(read, WorkbookInput)
    made, digest = Stamp.now(), case_digest(read.data)
    rows = rows_digest(study.inputs, StudyInputs() if read.studies is None else read.studies.inputs)
    facts = {
        f"{study.key}_Sentence": found.sentence,
        f"{study.key}_Stamp": (
            f"Made by {made.software} on {made.date:%Y-%m-%d %H:%M} UTC from the inputs with SHA-256 "
            f"{short_digest(digest)} and study rows {short_digest(rows)}"
        ),
        f"{study.key}_SHA256": digest,
    }
    report = write_study_results(
        read.workbook,
        destination,
        {**found.tables, **found.charts},
        facts,
        read.data.ratings.rated_torque,
        recorded=f"{study.key}_Tables",
        ignore_lock=ignore_lock,
    )
    return report.notes
