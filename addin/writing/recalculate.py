"""One input file in, its results out: the same path for the command line and every other front.

A workbook or a case JSON is read, checked, calculated and written. What is wrong with it comes
back as a list of problems and nothing is written; numbers never pass through here.
"""

from __future__ import annotations

import gc
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from addin.calculation.calculation import Calculation, calculate, present_results
from addin.contract.problems import CellProblem, printable
from addin.contract.version import product_version
from addin.reading.one_file import WORKBOOK_ENDINGS, Unreadable, file_problem, read_checked
from addin.reading.typed_case import CaseInput
from addin.reading.workbook import WorkbookInput
from addin.writing.history_file import HistoryUnavailable, write_history
from addin.writing.result_file import continued, has_more
from addin.writing.results_json import errors_to_json, results_to_json
from addin.writing.workbook import RunStamp, write_results
from addin.xlsx.errors import PackageError
from addin.xlsx.whole_files import write_json
from engine.case.data import case_digest
from engine.errors import CaseError, ModelError
from engine.results.results import Results


@dataclass(frozen=True, eq=False)
class RecalculationOutcome:
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
class PreparedInput:
    """What the caller has prepared of an input."""

    read: CaseInput | Unreadable | None = None  #: What `read_checked` read, where it has. [SI]
    #: Results of an equal case: they are shown in place of a calculation. [SI]
    results: Results | None = None
    #: Name of the history before ``.history``; empty for that of the result.
    history: str = ""
    #: Whether a result file that stands there keeps its studies, and stays as ``.bak``.
    keeps_standing: bool = False


@contextmanager
def _no_search_for_garbage() -> Iterator[None]:
    """Python looks for garbage afterwards: what is made on the way is used to the end."""
    was_on = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_on:
            gc.enable()


@_no_search_for_garbage()
def recalculate(
    source: Path,
    *,
    destination: Path | None = None,
    in_place: bool = False,
    json_file: Path | None = None,
    overrides: Mapping[str, Any] | None = None,
    ignore_lock: bool = False,
    on_stage: Callable[[str], None] | None = None,
    prepared: PreparedInput | None = None,
) -> RecalculationOutcome:
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
    prepared : PreparedInput, optional
        What the caller has read, calculated or named already.

    Returns
    -------
    RecalculationOutcome
        Results or problems, and the files written.
    """
    on_stage = on_stage or (lambda stage: None)
    prepared = prepared or PreparedInput()
    read = prepared.read
    if read is None:
        on_stage("reading")
        read = read_checked(source)
    problems = read.problems
    cause = read.cause if isinstance(read, Unreadable) else None
    calculation: Calculation | None = None
    notes: tuple[str, ...] = ()
    files: list[Path] = []
    target = source if in_place else destination or beside(source)
    begun: tuple[str, ...] = ()
    if prepared.keeps_standing and isinstance(read, WorkbookInput) and not problems:
        read, begun = _standing(read, target)
        in_place = in_place or read.path != source
    if not isinstance(read, Unreadable) and not problems:
        calculation, problems = recalculate_case(read, overrides or {}, on_stage, prepared.results)
    if calculation is not None:
        on_stage("writing")
        try:
            for place in (target, json_file):
                if place is not None:
                    place.parent.mkdir(parents=True, exist_ok=True)
            if isinstance(read, WorkbookInput) and source.suffix.lower() in WORKBOOK_ENDINGS:
                new = None if in_place else target
                notes = (*_write_workbook(read, new, calculation, ignore_lock), *begun)
                files.append(target)
            files += _write_history(calculation, target, prepared.history)
        except (PackageError, HistoryUnavailable, OSError) as error:
            calculation, problems, cause = None, (file_problem(source, error),), error
    is_json = source.suffix.lower() not in WORKBOOK_ENDINGS and not isinstance(read, Unreadable)
    if json_file is None and is_json:
        json_file = destination or beside(source)
    if json_file is not None:
        version = product_version()
        content = (
            errors_to_json(problems, version, read.warnings)
            if calculation is None
            else results_to_json(calculation, version)
        )
        try:
            write_json(json_file, content)
            files.append(json_file)
        except OSError as error:
            problems, cause = (*problems, file_problem(json_file, error)), error
    warnings = read.warnings if calculation is None else (*calculation.warnings, *notes)
    warnings = tuple(map(printable, warnings))
    return RecalculationOutcome(source, calculation, problems, warnings, tuple(files), cause)


def beside(source: Path) -> Path:
    """Default name of the results: train.out.xlsx, case.results.json."""
    ending = (
        f".out{source.suffix}" if source.suffix.lower() in WORKBOOK_ENDINGS else ".results.json"
    )
    return source.parent / f"{source.stem}{ending}"


def recalculate_case(
    read: CaseInput,
    settings: Mapping[str, Any],
    on_stage: Callable[[str], None] | None = None,
    known: Results | None = None,
) -> tuple[Calculation | None, tuple[CellProblem, ...]]:
    """The calculation of a checked input, or what makes it impossible as problems.

    Parameters
    ----------
    read : CaseInput
        What was read, without problems. [SI]
    settings : mapping
        Fields of the case that the caller sets. [SI]
    on_stage : callable, optional
        Called with the name of each analysis as it begins.
    known : Results, optional
        Of an equal case, instead of calculating. [SI]

    Returns
    -------
    Calculation or None
        The same that ``torsionbook recalc`` writes. [SI]
    tuple of CellProblem
        What makes it impossible; empty with results.
    """
    digest = case_digest(read.data)
    try:
        case = read.case()
        if settings:  # a changed case is checked once more
            case = replace(case, **settings)
        if known is not None:
            # the title block is no part of the case: it is this file's own
            results = replace(known, case=case)
            return present_results(results, case, read.warnings, digest, settings), ()
        calculation = calculate(
            case,
            input_warnings=read.warnings,
            case_sha256=digest,
            overrides=settings,
            on_stage=on_stage,
        )
    except (CaseError, ModelError) as error:
        return None, case_problems(error)
    return calculation, ()


def case_problems(error: CaseError | ModelError) -> tuple[CellProblem, ...]:
    """A case that cannot be calculated as a whole, as problems."""
    if isinstance(error, CaseError):
        return tuple(_whole(p.message, p.table) for p in error.problems)
    return (_whole(str(error), "Case"),)


def _whole(message: str, table: str) -> CellProblem:
    """A problem of the case as a whole, which no single cell stands for."""
    return CellProblem("Train", table, None, "", None, "a train that can be calculated", message)


def _standing(read: WorkbookInput, target: Path) -> tuple[WorkbookInput, tuple[str, ...]]:
    """The result file with its studies where it is of the same workbook, else the workbook; and why so."""
    standing, notes = continued(read, target)
    if standing is not None and has_more(read, standing):
        return standing, notes
    read.workbook.keep_replaced = True
    return read, notes


def _write_workbook(
    read: WorkbookInput, destination: Path | None, calculation: Calculation, ignore_lock: bool
) -> tuple[str, ...]:
    stamp = RunStamp(calculation.stamp.software, calculation.stamp.date, calculation.case_sha256)
    report = write_results(
        read.workbook,
        destination,
        calculation.view,
        stamp,
        in_place=destination is None,
        ignore_lock=ignore_lock,
        read=read,
    )
    renewed = report.caches.changed or report.caches.removed
    return (*report.notes, *(_on_inputs(read) if renewed else ()))


def _on_inputs(read: WorkbookInput) -> Iterable[str]:
    """Sentences on inputs that are formulas and do not show any more what was calculated with."""
    without_value, changed = read.otherwise_now()
    if without_value:
        yield (
            "Some inputs are formulas that may depend on results; torsionbook left them without "
            f"value: {_some(without_value)}. Open the written workbook in Excel or LibreOffice "
            "and save it before the next calculation, or type values instead of the formulas."
        )
    if changed:
        yield (
            f"Some inputs are formulas that depend on results and have changed: {_some(changed)}. "
            "The results belong to the earlier input values. Recalculate until the values no "
            "longer change, or type values instead of the formulas."
        )


def _some(cells: list[str], most: int = 10) -> str:
    more = f" and {len(cells) - most} more" if len(cells) > most else ""
    return ", ".join(cells[:most]) + more


def _write_history(calculation: Calculation, beside: Path, stem: str) -> Iterable[Path]:
    kind = calculation.case.keep_history or "no"
    if kind == "no":
        return ()
    done = write_history(calculation, beside, kind, stem)
    return () if done is None else (done[0],)
