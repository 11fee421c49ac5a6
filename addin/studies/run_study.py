"""One input through a study: read, check, calculate, write."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

from addin.calculation.audit import Stamp
from addin.contract.digests import short_digest
from addin.contract.field import IncompleteRecord
from addin.contract.json_formats import RESULTS_FORMAT
from addin.contract.problems import CellProblem, placed
from addin.contract.studies.registry import MissingSheets, missing_sheets
from addin.contract.study_spec import StudySpec
from addin.contract.tables import RESULT_TABLES, input_table, json_key, result_table
from addin.contract.version import product_version
from addin.reading.one_file import WORKBOOK_ENDINGS, Unreadable, file_problem, read_checked
from addin.reading.typed_case import CaseInput
from addin.reading.workbook import WorkbookInput
from addin.recorded.studies import rows_digest
from addin.studies.study import Study, StudyPart, StudyResult, StudyTask
from addin.workers.parallel_map import ParallelMap
from addin.writing.recalculate import beside as result_beside
from addin.writing.recalculate import case_problems
from addin.writing.result_file import continued
from addin.writing.results_json import table_rows
from addin.writing.workbook import write_study_results
from addin.xlsx.errors import PackageError
from addin.xlsx.save import Destination, put_in_place
from addin.xlsx.temporary import temporary_folder
from addin.xlsx.whole_files import write_json
from engine.case.checks.problem import SCALARS
from engine.case.data import CaseData, case_digest
from engine.case.study_inputs import StudyInputs
from engine.errors import CaseError, ModelError, Problem


@dataclass(frozen=True)
class StudyFiles:
    """Where a study is written."""

    #: The copy of the workbook; None = its result file, ``train.out.xlsx``. [path]
    destination: Path | None = None
    in_place: bool = False  #: Write into the workbook itself; it stays as ``.bak``.
    #: The JSON; None = none, but of a case JSON ``case.tune.json``. [path]
    json_file: Path | None = None
    ignore_lock: bool = False  #: Go on although a lock file says somebody has the workbook open.
    #: Adds the sheets of a study to a copy of a workbook in a folder; None = a workbook without them is refused.
    add: Callable[[WorkbookInput, StudySpec, Path], WorkbookInput] | None = None
    add_inputs: bool = False  #: Whether sheets of inputs are added, too.


@dataclass(frozen=True, eq=False)
class StudyOutcome:
    """What became of one input."""

    source: Path  #: The input.
    result: StudyResult | None  #: The study; None if something was wrong. [SI]
    problems: tuple[CellProblem, ...]  #: Everything wrong with the input.
    warnings: tuple[str, ...]  #: What the engineer should know.
    written: tuple[Path, ...] = ()  #: Files written: workbook, JSON.
    #: Sheets of inputs that it lacks and that can be added; nothing was calculated then. [names]
    lacking: tuple[str, ...] = ()


def study_one(
    study: Study,
    source: Path,
    parallel_map: ParallelMap,
    settings: Mapping[str, Any],
    files: StudyFiles = StudyFiles(),
    on_stage: Callable[[str], None] = lambda stage: None,
) -> StudyOutcome:
    """Study one input and write what it showed.

    Parameters
    ----------
    study : Study
        What is asked.
    source : Path
        Workbook or case JSON. [path]
    parallel_map : ParallelMap
        Where units of work are done.
    settings : mapping
        Of the command line. [names and values]
    files : StudyFiles, optional
        Where it is written.
    on_stage : callable, optional
        Called with a word on what is being done.

    Raises
    ------
    addin.workers.parallel_map.Cancelled
        After Ctrl-C, where what was calculated is not enough for a result; nothing is written.
    """
    on_stage("reading")
    read = read_checked(source)
    if isinstance(read, Unreadable):
        return StudyOutcome(source, None, read.problems, read.warnings)
    if source.suffix.lower() not in WORKBOOK_ENDINGS:
        return _study_json(study, source, read, (parallel_map, settings, files, on_stage))
    assert isinstance(read, WorkbookInput)
    if files.destination is None and source.stem.endswith(".out"):
        files = replace(files, in_place=True)  # a result file goes on
    target = source if files.in_place else files.destination or result_beside(source)
    standing, notes = (None, ()) if read.problems else continued(read, target)
    there = read if standing is None else standing
    with temporary_folder() as folder:
        try:
            book, refused = _with_sheets(study, there, files, folder)
        except (PackageError, OSError) as failed:
            book, refused = there, (file_problem(source, failed),)
        if refused and files.json_file is None:
            lacking = missing_sheets(there.workbook.tables, study.spec).inputs
            asked = () if files.add is None or files.add_inputs or there.problems else lacking
            problems = (*_unread(study, there), *refused)
            return StudyOutcome(source, None, problems, _warned(there), lacking=asked)
        result, problems, words = calculate_study(study, book, parallel_map, settings, on_stage)
        added = missing_sheets(there.workbook.tables, study.spec).inputs
        if result is None and (book is there or not added):
            return StudyOutcome(source, None, problems, words)
        on_stage("writing")
        warnings, written = [*words, *notes], []
        try:
            if result is None:  # the new sheets have no usual rows: they are there to be filled in
                target.parent.mkdir(parents=True, exist_ok=True)
                there.workbook.allow_saving(ignore_lock=files.ignore_lock)
                delivered = put_in_place(
                    there.workbook.container, book.path,
                    _place(target, files, standing is not None),
                )  # fmt: skip
                warnings += delivered.notes
                warnings.append(
                    f"{target.name} now has sheet {' and '.join(added)}. Fill in, then run the command again on it."
                )
                return StudyOutcome(source, None, problems, tuple(warnings), (target,))
            if refused:
                warnings.append(
                    f"{source.name} has no sheets for this study; results are only in the JSON."
                )
            else:
                target.parent.mkdir(parents=True, exist_ok=True)
                place = _place(target, files, standing is not None)
                warnings += _write_book(study, (there, book), place, result, folder)
                written.append(target)
            if files.json_file is not None:
                as_json = study.as_json or partial(to_json, study)
                write_json(files.json_file, as_json(result, book, tuple(warnings)))
                written.append(files.json_file)
        except (PackageError, OSError) as failed:
            problem = file_problem(source, failed)
            return StudyOutcome(source, None, (problem,), tuple(warnings), tuple(written))
    return StudyOutcome(source, result, (), tuple(warnings), tuple(written))


def _place(target: Path, files: StudyFiles, stands: bool) -> Destination:
    """Where the workbook goes; whatever stands there is kept."""
    return Destination(
        target, files.in_place or stands, keep_replaced=True, ignore_lock=files.ignore_lock
    )


def _study_json(
    study: Study,
    source: Path,
    read: CaseInput,
    how: tuple[ParallelMap, Mapping[str, Any], StudyFiles, Callable[[str], None]],
) -> StudyOutcome:
    """A study of a case JSON: its results are a JSON as well."""
    parallel_map, settings, files, on_stage = how
    result, problems, warnings = calculate_study(study, read, parallel_map, settings, on_stage)
    if result is None:
        return StudyOutcome(source, None, problems, warnings)
    on_stage("writing")
    json_file = files.json_file or files.destination or beside(source, study)
    try:
        as_json = study.as_json or partial(to_json, study)
        write_json(json_file, as_json(result, read, warnings))
    except OSError as failed:
        return StudyOutcome(source, None, (file_problem(source, failed),), warnings)
    return StudyOutcome(source, result, (), warnings, (json_file,))


def _with_sheets(
    study: Study, read: WorkbookInput, files: StudyFiles, folder: Path
) -> tuple[WorkbookInput, tuple[CellProblem, ...]]:
    """The workbook with the sheets of the study, or why it has none."""
    lacking = missing_sheets(read.workbook.tables, study.spec)
    if not lacking.tables:
        return read, ()
    if not lacking.sheets or files.add is None or (lacking.inputs and not files.add_inputs):
        return read, (_refused(read, study, lacking),)
    if read.problems:
        return read, ()
    return files.add(read, study.spec, folder), ()


def _write_book(
    study: Study,
    books: tuple[WorkbookInput, WorkbookInput],
    place: Destination,
    result: StudyResult,
    folder: Path,
) -> tuple[str, ...]:
    """Write a study into the workbook as it stands, or into the one to which sheets were added."""
    there, book = books
    write = study.write or partial(_write, study)
    if book is there:
        book.workbook.keep_replaced = True
        return write(book, None if place.in_place else place.path, result, place.ignore_lock)
    there.workbook.allow_saving(ignore_lock=place.ignore_lock)
    made = folder / f"made{book.path.suffix}"
    notes = write(book, made, result, True)
    delivered = put_in_place(there.workbook.container, made, place)
    return (*notes, *delivered.notes)


def part_of_study(
    study: Study,
    source: Path,
    parallel_map: ParallelMap,
    settings: Mapping[str, Any],
    options: Mapping[str, Any],
) -> tuple[StudyPart | None, tuple[CellProblem, ...]]:
    """One part of a study alone, where the options ask for one.

    Parameters
    ----------
    study : Study
        What is asked.
    source : Path
        Workbook or case JSON. [path]
    parallel_map : ParallelMap
        Where units of work are done.
    settings, options : mapping
        Of the command line: those that change what is calculated, and all. [names and values]

    Returns
    -------
    part : StudyPart or None
        None if none is asked for, or something is wrong. [SI]
    problems : tuple of CellProblem
        Everything wrong. [problems]
    """
    read = read_checked(source)
    if isinstance(read, Unreadable):
        return None, read.problems
    inputs = StudyInputs() if read.studies is None else read.studies.inputs
    if unread := _unread(study, read):
        return None, unread
    try:
        case = read.case()
        _refuse_many_phases(study, case)
        if problems := study.check(case, inputs):
            return None, _in_cells(read, study, problems)
        task = StudyTask(case, inputs, settings, parallel_map, lambda stage: None)
        return study.part(task, options), ()
    except (CaseError, ModelError) as refused:
        return None, case_problems(refused)


def calculate_study(
    study: Study,
    read: CaseInput,
    parallel_map: ParallelMap,
    settings: Mapping[str, Any],
    on_stage: Callable[[str], None],
) -> tuple[StudyResult | None, tuple[CellProblem, ...], tuple[str, ...]]:
    """Make a study of an input that has been read; nothing is written.

    Parameters
    ----------
    study : Study
        What is asked.
    read : CaseInput
        The input. [SI]
    parallel_map : ParallelMap
        Where units of work are done.
    settings : mapping
        Of the command line. [names and values]
    on_stage : callable
        Called with a word on what is being done.

    Returns
    -------
    result : StudyResult or None
        None if something is wrong. [SI]
    problems : tuple of CellProblem
        Everything wrong. [problems]
    warnings : tuple of str
        What the engineer should know. [sentences]
    """
    inputs = StudyInputs() if read.studies is None else read.studies.inputs
    warnings, unread = _warned(read), _unread(study, read)
    if read.problems:
        return None, unread, warnings
    try:
        case = read.case()
        _refuse_many_phases(study, case)
        problems = study.check(case, inputs)
        if unread or problems:
            return None, _in_cells(read, study, problems), warnings
        result = _with_cut(
            study.calculate(StudyTask(case, inputs, settings, parallel_map, on_stage))
        )
    except (CaseError, ModelError) as refused:
        return None, (*unread, *case_problems(refused)), warnings
    check_tables(study, result)
    return result, (), (*warnings, *result.warnings)


def _refuse_many_phases(study: Study, case: CaseData) -> None:
    """A study of starts near to one start has the phase of that one."""
    if case.looks_for_worst_phase and not study.takes_worst_phase:
        raise CaseError(
            (
                SCALARS.wrong(
                    "PulsationPhase",
                    case.pulsation_phase,
                    f"a number in the study {study.command}",
                    "Type the Worst phase of table StartupPeaks: each start of the study has one phase.",
                ),
            )
        )


def _unread(study: Study, read: CaseInput) -> tuple[CellProblem, ...]:
    """What cannot be read of the case, and of the tables of the study."""
    more = () if read.studies is None else read.studies.problems_of(study.inputs)
    return (*read.problems, *more)


def _warned(read: CaseInput) -> tuple[str, ...]:
    return (*read.warnings, *(() if read.studies is None else read.studies.warnings))


def check_tables(study: Study, result: StudyResult) -> None:
    """Refuse a result without the tables of the record of its study, or with others."""
    key, given = study.spec.key, {*result.tables, *result.charts}
    wanted = {spec.name for spec in study.spec.results}
    for name in sorted(wanted - given):
        raise IncompleteRecord(
            f"study {key} does not give the table {name}: add it in addin/studies/{key}.py"
        )
    for name in sorted(given - wanted - {spec.name for spec in RESULT_TABLES}):
        raise IncompleteRecord(
            f"study {key} gives the table {name}, which its record does not describe: add it in "
            f"addin/contract/studies/{key}.py, or correct the name in addin/studies/{key}.py"
        )


def _with_cut(result: StudyResult) -> StudyResult:
    """That a study was cut short stands before anything else it says."""
    if result.cut_short is None:
        return result
    return replace(result, sentence=f"{result.cut_short.sentence} {result.sentence}")


def beside(source: Path, study: Study) -> Path:
    """Default name of the JSON of a study: case.tune.json."""
    return source.with_name(f"{source.stem}.{study.command}{source.suffix}")


def to_json(
    study: Study, result: StudyResult, read: CaseInput, warnings: tuple[str, ...]
) -> dict[str, Any]:
    """A study as JSON: its result tables under their keys, as in results of the contract.

    Parameters
    ----------
    study : Study
        The study.
    result : StudyResult
        Its result. [SI]
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
    cut = result.cut_short
    part = {"cut_short": {"calculated": cut.calculated, "planned": cut.planned}} if cut else {}
    return {
        "format": RESULTS_FORMAT,
        "study": study.key,
        "case_sha256": case_digest(read.data),
        "study_sha256": result.digest,
        "version": product_version(),
        "sentence": result.sentence,
        "warnings": list(warnings),
        "errors": [],
        **part,
        **{json_key(name): table_rows(name, rows) for name, rows in result.tables.items()},
        **result.details,
    }


def _in_cells(
    read: CaseInput, study: Study, problems: Sequence[Problem]
) -> tuple[CellProblem, ...]:
    """Problems of the study's rows with their cells; of a case without such tables as they are."""
    if read.studies is not None:
        return read.studies.problems_of(study.inputs, problems)

    return tuple(placed(p, input_table(p.table).sheet, "", "cell") for p in problems)


def _refused(read: WorkbookInput, study: Study, lacking: MissingSheets) -> CellProblem:
    """A workbook without the sheets of the study, as a problem."""
    first = lacking.tables[0]
    spec = input_table(first) if first in study.inputs else result_table(first)
    name = read.path.name
    sheets = f"sheet{'s' if len(lacking.inputs) > 1 else ''} {' and '.join(lacking.inputs)}"
    sentence = (
        f"{name} has no {sheets} for torsionbook {study.command}. Repeat the command with --add, which adds the sheets, "
        "with usual rows where there are such."
        if lacking.inputs
        else f"{name} has no table {' and '.join(lacking.tables)} for torsionbook {study.command}. Run torsionbook "
        f"upgrade {name} for a workbook of this version."
    )
    return CellProblem(spec.sheet, first, None, "", None, f"table {first}", sentence, "")


def _write(
    study: Study, read: CaseInput, destination: Path | None, result: StudyResult, ignore_lock: bool
) -> tuple[str, ...]:
    """Write a study into the workbook it was read from; sentences the user should read."""
    assert isinstance(read, WorkbookInput)
    made, digest = Stamp.now(), case_digest(read.data)
    rows = rows_digest(study.inputs, StudyInputs() if read.studies is None else read.studies.inputs)
    facts = {
        f"{study.key}_Sentence": result.sentence,
        f"{study.key}_Stamp": (
            f"Made by {made.software} on {made.date:%Y-%m-%d %H:%M} UTC from the inputs with SHA-256 "
            f"{short_digest(digest)} and study rows {short_digest(rows)}"
        ),
        f"{study.key}_SHA256": digest,
    }
    report = write_study_results(
        read.workbook,
        destination,
        {**result.tables, **result.charts},
        facts,
        read.data.ratings.rated_torque,
        recorded=f"{study.key}_Tables",
        ignore_lock=ignore_lock,
    )
    return report.notes
