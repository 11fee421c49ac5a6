"""One input file in, its results out: the same path for the command line and every other front.

A workbook or a case JSON is read, checked, calculated and written. What is wrong with it comes
back as a list of problems and nothing is written; numbers never pass through here.
"""

from __future__ import annotations

import errno
import json
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from addin.calculation.stages import COMPILING
from addin.contract.problems import CellProblem, printable
from addin.xlsx.whole_files import write_whole

if TYPE_CHECKING:
    from addin.calculation.calculation import Calculation
    from addin.reading.typed_case import CaseInput
    from addin.reading.workbook import WorkbookInput
    from addin.xlsx import Workbook
    from engine.errors import CaseError, ModelError
    from engine.results.results import Results

__all__ = [
    "Recalculated",
    "Unreadable",
    "WORKBOOK_ENDINGS",
    "beside",
    "calculate_read",
    "of_case",
    "of_file",
    "read_checked",
    "recalculate",
    "write_json",
]

WORKBOOK_ENDINGS = (".xlsx", ".xlsm")


@dataclass(frozen=True, eq=False)
class Recalculated:
    """What became of one input."""

    source: Path  #: The input.
    calculation: Calculation | None  #: The results; None if something was wrong. [SI]
    problems: tuple[CellProblem, ...]  #: Everything wrong with it; empty if it was calculated.
    warnings: tuple[str, ...]  #: What the engineer should know.
    written: tuple[Path, ...]  #: Files written: workbook, history, JSON.
    #: What was raised where a file could not be opened or written, for callers that tell one such
    #: case from another.
    cause: Exception | None = None


@dataclass(frozen=True)
class Unreadable:
    """An input that could not be opened at all, in the form of one that was read."""

    problems: tuple[CellProblem, ...]  #: Why.
    warnings: tuple[str, ...] = ()  #: Nothing.
    cause: Exception | None = None  #: What was raised.


def read_checked(source: Path) -> CaseInput | Unreadable:
    """Read and check a workbook or a case JSON; what is wrong is inside, not raised.

    Parameters
    ----------
    source : Path
        A .xlsx, .xlsm or .json file. [path]

    Returns
    -------
    CaseInput or Unreadable
        Data, problems and warnings. [SI]
    """
    from addin.xlsx.errors import PackageError

    try:
        if source.suffix.lower() == ".json":
            from addin.reading.case_json import read_case_json

            return read_case_json(source)
        from addin.reading.workbook import read_workbook

        return read_workbook(source)
    except (PackageError, OSError) as wrong:
        return Unreadable((of_file(source, wrong),), cause=wrong)


def of_file(source: Path, wrong: Exception) -> CellProblem:
    """A file that cannot be opened or written, as a problem."""
    sentence = str(wrong)
    if isinstance(wrong, FileNotFoundError) and _is_elsewhere(wrong, source):
        sentence = f"{wrong.filename} cannot be made there. Name another folder for the results."
    elif isinstance(wrong, FileNotFoundError):
        sentence = f"there is no file {wrong.filename or source}."
    elif isinstance(wrong, IsADirectoryError) and _is_elsewhere(wrong, source):
        sentence = f"{wrong.filename} is a folder. Name a file in it for the result."
    elif isinstance(wrong, IsADirectoryError):
        sentence = f"{source} is a folder; name the workbooks in it."
    elif isinstance(wrong, PermissionError):
        sentence = f"{wrong.filename or source} may not be read or written; is it open elsewhere?"
    elif isinstance(wrong, (NotADirectoryError, FileExistsError)):
        sentence = f"{wrong.filename or source} is a file where a folder is needed."
    elif isinstance(wrong, OSError) and wrong.strerror:
        sentence = f"{wrong.filename or source} cannot be used: {wrong.strerror}."
    sentence = "\n".join(map(printable, sentence.split("\n")))
    return CellProblem(
        "", "", None, "", printable(str(source)), "a file that can be used", sentence
    )


def _is_elsewhere(wrong: OSError, source: Path) -> bool:
    """Whether it is not the file itself that is missing or a folder, but a place to write to."""
    return isinstance(wrong.filename, str) and Path(wrong.filename).absolute() != source.absolute()


def recalculate(
    source: Path,
    *,
    destination: Path | None = None,
    in_place: bool = False,
    json_file: Path | None = None,
    overrides: Mapping[str, Any] | None = None,
    ignore_lock: bool = False,
    on_stage: Callable[[str], None] | None = None,
    on_written: Callable[[Workbook], None] | None = None,
    read: CaseInput | Unreadable | None = None,
    known: Results | None = None,
    history: str = "",
) -> Recalculated:
    """Calculate one input and write its results.

    Parameters
    ----------
    source : Path
        Workbook or case JSON. [path]
    destination : Path, optional
        The result workbook; default the source's name with ``.out`` before the ending. For a case
        JSON the result JSON, if `json_file` is not given. [path]
    in_place : bool
        Replace the source; it stays as ``.bak``. [flag]
    json_file : Path, optional
        Also write the results as JSON here; on errors the errors. [path]
    overrides : mapping, optional
        Fields of the case that the caller sets, such as ``method``. [SI]
    ignore_lock : bool
        Work on although a lock file says somebody has the workbook open. [flag]
    on_stage : callable, optional
        Called with the name of each stage as it begins.
    on_written : callable, optional
        Called with the workbook once its results are in the file.
    read : CaseInput or Unreadable, optional
        The input, where `read_checked` has read it already. [SI]
    known : Results, optional
        Results of the same case: they are shown in place of a calculation. [SI]
    history : str
        Name of the history before ``.history``; empty for that of the result. [name]

    Returns
    -------
    Recalculated
        Results or problems, and the files written.
    """
    from addin.contract.version import product_version
    from addin.reading.workbook import WorkbookInput
    from addin.writing.history_file import HistoryUnavailable
    from addin.writing.results_json import errors_to_json, results_to_json
    from addin.xlsx.errors import PackageError

    tell = on_stage or (lambda stage: None)
    if read is None:
        tell("reading")
        read = read_checked(source)
    problems = read.problems
    cause = read.cause if isinstance(read, Unreadable) else None
    calculation: Calculation | None = None
    notes: tuple[str, ...] = ()
    files: list[Path] = []
    if not isinstance(read, Unreadable) and not problems:
        calculation, problems = calculate_read(read, overrides or {}, tell, known)
    if calculation is not None:
        tell("writing")
        target = source if in_place else destination or beside(source)
        try:
            for place in (target, json_file):
                if place is not None:
                    place.parent.mkdir(parents=True, exist_ok=True)
            if isinstance(read, WorkbookInput) and source.suffix.lower() in WORKBOOK_ENDINGS:
                new = None if in_place else target
                notes = _write_workbook(read, new, calculation, ignore_lock)
                files.append(target)
                if on_written is not None:
                    on_written(read.workbook)
            files += _write_history(calculation, target, history)
        except (PackageError, HistoryUnavailable, OSError) as wrong:
            calculation, problems, cause = None, (of_file(source, wrong),), wrong
    if json_file is None and source.suffix.lower() not in WORKBOOK_ENDINGS:
        json_file = destination or beside(source)
    if json_file is not None:
        version = product_version()
        content = (
            errors_to_json(problems, version, read.warnings)
            if calculation is None
            else results_to_json(calculation, version, calculation.details)
        )
        try:
            write_json(json_file, content)
            files.append(json_file)
        except OSError as wrong:
            problems, cause = (*problems, of_file(json_file, wrong)), wrong
    warnings = read.warnings if calculation is None else (*calculation.warnings, *notes)
    warnings = tuple(map(printable, warnings))
    return Recalculated(source, calculation, problems, warnings, tuple(files), cause)


def beside(source: Path) -> Path:
    """Default name of the results: train.out.xlsx, case.results.json."""
    if source.suffix.lower() in WORKBOOK_ENDINGS:
        return source.with_name(f"{source.stem}.out{source.suffix}")
    return source.with_name(f"{source.stem}.results.json")


def calculate_read(
    read: CaseInput,
    overrides: Mapping[str, Any],
    tell: Callable[[str], None],
    known: Results | None = None,
) -> tuple[Calculation | None, tuple[CellProblem, ...]]:
    """The calculation of a checked input, or what makes it impossible as a problem.

    Parameters
    ----------
    read : CaseInput
        What was read, without problems. [SI]
    overrides : mapping
        Fields of the case that the caller sets. [SI]
    tell : callable
        Called with the name of each stage as it begins.
    known : Results, optional
        Of an equal case, instead of calculating. [SI]

    Returns
    -------
    Calculation or None
        The results.
    tuple of CellProblem
        What makes them impossible; empty with results.
    """
    from addin.calculation.calculation import calculate, shown
    from engine.case.data import case_digest
    from engine.errors import CaseError, ModelError
    from engine.start.warm_up import load_routines
    from engine.stepping.compiling import is_compiled
    from engine.stepping.linear_loop import advance_start

    try:
        case = replace(read.case(), **overrides)
        if known is not None:
            # the title block is no part of the case: it is this file's own
            results = replace(known, case=case)
            return shown(results, case, read.warnings, case_digest(read.data), overrides), ()
        if case.motor_torque and not is_compiled(advance_start):
            tell(COMPILING)
            load_routines()
        done = calculate(
            case,
            input_warnings=read.warnings,
            case_sha256=case_digest(read.data),
            overrides=overrides,
            on_stage=tell,
        )
    except (CaseError, ModelError) as wrong:
        return None, of_case(wrong)
    return done, ()


def of_case(wrong: CaseError | ModelError) -> tuple[CellProblem, ...]:
    """A case that cannot be calculated as a whole, as problems."""
    from engine.errors import CaseError

    if isinstance(wrong, CaseError):
        return tuple(_whole(p.message, p.table) for p in wrong.problems)
    return (_whole(str(wrong), "Case"),)


def _whole(message: str, table: str) -> CellProblem:
    """A problem of the case as a whole, which no single cell stands for."""
    return CellProblem("Train", table, None, "", None, "a train that can be calculated", message)


def _write_workbook(
    read: WorkbookInput, destination: Path | None, calculation: Calculation, ignore_lock: bool
) -> tuple[str, ...]:
    from addin.writing.workbook import RunStamp, write_results

    stamp = RunStamp(calculation.stamp.software, calculation.stamp.date, calculation.case_sha256)
    report = write_results(
        read.workbook,
        destination,
        calculation.view,
        stamp,
        in_place=destination is None,
        ignore_lock=ignore_lock,
    )
    if report.caches.method == "removed":
        left = (
            f"{report.caches.removed} formulas were left without a value, to be calculated when the "
            f"workbook is opened: {report.caches.reason}"
        )
        return (*report.notes, left, *_on_inputs(read))
    renewed = report.caches.changed or report.caches.removed
    return (*report.notes, *(_on_inputs(read) if renewed else ()))


def _on_inputs(read: WorkbookInput) -> Iterable[str]:
    """Sentences on inputs that are formulas and do not show any more what was calculated with."""
    without_value, changed = read.otherwise_now()
    if without_value:
        yield (
            f"Inputs that are formulas were left without a value: {_some(without_value)}. They may "
            "hang on results, and cannot be recalculated here for certain. Before the written "
            "workbook can be calculated again, open it in Excel or LibreOffice and save it, or type "
            "values there instead of the formulas."
        )
    if changed:
        yield (
            f"Inputs that are formulas hang on results, and have changed with them: {_some(changed)}. "
            "The results are those of the inputs before. Calculate again until they stay, or type "
            "values there instead of the formulas."
        )


def _some(cells: list[str], most: int = 10) -> str:
    more = f" and {len(cells) - most} more" if len(cells) > most else ""
    return ", ".join(cells[:most]) + more


def _write_history(calculation: Calculation, beside: Path, stem: str) -> Iterable[Path]:
    kind = calculation.case.keep_history or "no"
    if kind == "no":
        return ()
    from addin.writing.history_file import write_history

    done = write_history(calculation, beside, kind, stem)
    return () if done is None else (done[0],)


def write_json(path: Path, content: Mapping[str, Any]) -> None:
    """Write JSON whole or not at all.

    Raises
    ------
    OSError
        If the file cannot be written; one that was there is as before.
    """
    if path.is_dir():
        raise IsADirectoryError(errno.EISDIR, "is a folder", str(path))
    path.parent.mkdir(parents=True, exist_ok=True)
    text = json.dumps(content, indent=1, ensure_ascii=False, allow_nan=False) + "\n"
    write_whole(path, lambda made: made.write_text(text, encoding="utf-8", newline="\n"))
