"""What accuracy costs in time: the study of one input, and its place in the workbook.

The study calculates a case again and again, by both methods and at several settings. Into a
workbook it writes table `AccuracyCost`, its chart and the sentences above it, and nothing else.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from addin.problems import CellProblem
from addin.recalc import (
    COMPILING,
    WORKBOOK_ENDINGS,
    Unreadable,
    of_case,
    of_file,
    read_checked,
    write_json,
)

if TYPE_CHECKING:
    from addin.typed_case import CaseInput
    from engine.accuracy import AccuracyStudy

__all__ = ["QUICK_ROUNDS", "ROUNDS", "Studied", "study"]

#: How often each setting is timed; the median is shown.
ROUNDS, QUICK_ROUNDS = 5, 1


@dataclass(frozen=True, eq=False)
class Studied:
    """What became of the study of one input.

    Parameters
    ----------
    source : Path
        The input. [path]
    found : AccuracyStudy or None
        The study; None if something was wrong. [SI]
    problems : tuple of CellProblem
        Everything wrong with the input. [problems]
    warnings : tuple of str
        What the engineer should know. [sentences]
    written : tuple of Path
        Files written: workbook, JSON. [paths]
    """

    source: Path
    found: AccuracyStudy | None
    problems: tuple[CellProblem, ...]
    warnings: tuple[str, ...]
    written: tuple[Path, ...]


def study(
    source: Path,
    *,
    destination: Path | None = None,
    in_place: bool = False,
    json_file: Path | None = None,
    rounds: int = ROUNDS,
    ignore_lock: bool = False,
    on_stage: Callable[[str], None] | None = None,
) -> Studied:
    """Study one input and write what it showed.

    Parameters
    ----------
    source : Path
        Workbook or case JSON. [path]
    destination : Path, optional
        Where the copy of the workbook goes; default beside it, ``train.accuracy.xlsx``. [path]
    in_place : bool
        Write into the workbook itself; it stays as ``.bak``. [flag]
    json_file : Path, optional
        Where the JSON goes; of a case JSON by default ``case.accuracy.json``. [path]
    rounds : int
        How often each setting is timed. [count]
    ignore_lock : bool
        Go on although a lock file says somebody has the workbook open. [flag]
    on_stage : callable, optional
        Called with a word on what is being done.

    Returns
    -------
    Studied
        The study or problems, and the files written.
    """
    from addin.package.errors import PackageError

    tell = on_stage or (lambda stage: None)
    tell("reading")
    read = read_checked(source)
    if isinstance(read, Unreadable) or read.problems:
        return Studied(source, None, read.problems, read.warnings, ())
    found, problems = _study(read, rounds, tell)
    if found is None:
        return Studied(source, None, problems, read.warnings, ())
    tell("writing")
    is_workbook = source.suffix.lower() in WORKBOOK_ENDINGS
    files: list[Path] = []
    notes: tuple[str, ...] = ()
    try:
        if is_workbook:
            target = source if in_place else destination or _beside(source)
            target.parent.mkdir(parents=True, exist_ok=True)
            notes = _write(read, None if in_place else target, found, ignore_lock)
            files.append(target)
        elif json_file is None:
            json_file = destination or _beside(source)
        if json_file is not None:
            write_json(json_file, study_to_json(found, read))
            files.append(json_file)
    except (PackageError, OSError) as wrong:
        return Studied(source, None, (of_file(source, wrong),), read.warnings, tuple(files))
    return Studied(source, found, (), (*read.warnings, *notes), tuple(files))


def study_to_json(found: AccuracyStudy, read: CaseInput) -> dict[str, Any]:
    """A study as results JSON of the contract.

    Parameters
    ----------
    found : AccuracyStudy
        The study. [SI]
    read : CaseInput
        Its case.

    Returns
    -------
    dict
        Keys format, case_sha256, version, warnings, errors, accuracy_cost and accuracy.
    """
    from addin.results_json import FORMAT, table_rows
    from addin.version import product_version
    from engine.case import case_digest
    from engine.report import accuracy_rows

    return {
        "format": FORMAT,
        "case_sha256": case_digest(read.data),
        "version": product_version(),
        "warnings": list(read.warnings),
        "errors": [],
        "accuracy_cost": table_rows("AccuracyCost", accuracy_rows(found.rows)),
        "accuracy": {"sentence": found.sentence, "reference": found.reference},
    }


def _beside(source: Path) -> Path:
    """Default name of what the study writes: train.accuracy.xlsx, case.accuracy.json."""
    return source.with_name(f"{source.stem}.accuracy{source.suffix}")


def _study(
    read: CaseInput, rounds: int, tell: Callable[[str], None]
) -> tuple[AccuracyStudy | None, tuple[CellProblem, ...]]:
    """The study, or what makes it impossible as problems."""
    from engine.accuracy import accuracy_study
    from engine.errors import CaseError, ModelError
    from engine.stepping.compiling import is_compiled
    from engine.stepping.kernels import advance_start

    try:
        case = read.case()
        if not is_compiled(advance_start):
            tell(COMPILING)
        return accuracy_study(case, rounds=rounds, on_progress=tell), ()
    except (CaseError, ModelError) as wrong:
        return None, of_case(wrong)


def _write(
    read: CaseInput, destination: Path | None, found: AccuracyStudy, ignore_lock: bool
) -> tuple[str, ...]:
    """Write a study into the workbook it was read from; sentences the user should read."""
    from addin.audit import Stamp
    from addin.read_workbook import WorkbookInput
    from addin.write_workbook import RunStamp, write_study
    from engine.case import case_digest
    from engine.report import accuracy_rows

    assert isinstance(read, WorkbookInput)
    made = Stamp.now()
    stamp = RunStamp(made.software, made.date, case_digest(read.data))
    rows: list[Mapping[str, Any]] = list(accuracy_rows(found.rows))
    report = write_study(
        read.workbook,
        destination,
        rows,
        {"sentence": found.sentence, "reference": found.reference},
        stamp,
        read.data.ratings.rated_torque,
        ignore_lock=ignore_lock,
    )
    return report.notes
