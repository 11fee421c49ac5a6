"""One of the two files: its inputs and its results, as recorded or calculated again."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from addin.calculation.calculation import Calculation
from addin.contract.problems import CellProblem
from addin.contract.shown_units import ShownUnits
from addin.contract.tables import RESULT_TABLES, WORKBOOK_TABLES, TableSpec, table
from addin.contract.units import UnitError, parse_unit
from addin.reading.one_file import Unreadable, file_problem, read_checked
from addin.reading.typed_case import CaseInput, TypedCase
from addin.reading.workbook import WorkbookInput
from addin.recorded.provenance import Provenance, json_provenance, workbook_provenance
from addin.recorded.results import recorded_rows
from addin.recorded.studies import RecordedStudy, recorded_studies
from addin.verify.json_file import header_rows, read_results_json
from addin.writing.recalculate import recalculate_case
from addin.writing.workbook import read_shown_units
from engine.case.data import CaseData, case_digest
from engine.case.study_inputs import StudyInputs

#: Result tables that are compared; wall times and the study of accuracy are no results of the train.
COMPARED: tuple[TableSpec, ...] = (
    *(spec for spec in RESULT_TABLES if spec.name != "AccuracyCost"),
    *(spec for spec in WORKBOOK_TABLES if spec.name == "BearingForces"),
)

Rows = Sequence[Mapping[str, Any]]


class CannotBeCompared(Exception):
    """A file that cannot be one of two sides.

    Parameters
    ----------
    source : Path
        The file. [path]
    problems : tuple of CellProblem
        Why. [problems]
    """

    def __init__(self, source: Path, problems: tuple[CellProblem, ...]) -> None:
        super().__init__(problems[0].message)
        self.source = source
        self.problems = problems


@dataclass(frozen=True)
class RoundedNumber:
    """A number of a check, which a workbook shows in words with few digits."""

    number: float  #: It. [SI]
    words: str  #: As shown.


@dataclass(frozen=True)
class ComparedFile:
    """One of the two files."""

    source: Path  #: The file.
    data: CaseData | None  #: Its inputs; None of a result JSON. [SI]
    typed: TypedCase | None  #: The same as typed. [as typed]
    units: ShownUnits | None  #: Units above the columns of a workbook.
    tables: Mapping[str, Rows]  #: Results by table and header. [SI]
    results_from: str  #: Where they come from, in words.
    software: str  #: What calculated them.
    digest: str  #: Digest of the inputs. [hex]
    #: Settings of the command line they were calculated with. [SI]
    settings: Mapping[str, Any] = field(default_factory=dict)
    #: Rows of its study sheets; None of a result JSON. [SI]
    study_inputs: StudyInputs | None = None
    studies: tuple[RecordedStudy, ...] = ()  #: Studies that stand in a workbook. [SI]

    @property
    def revision(self) -> str:
        """Tag, document and revision as the title block states them. [words]"""
        if self.data is None:
            return ""
        parts = (
            self.data.tag,
            self.data.document,
            self.data.revision and f"Rev. {self.data.revision}",
        )
        return ", ".join(part for part in parts if part)


def read_compared_file(
    source: Path,
    *,
    recalculate: bool = False,
    on_stage: Callable[[str], None] | None = None,
) -> ComparedFile:
    """Read one of the two files.

    Raises
    ------
    CannotBeCompared
        When it cannot be read, or its inputs cannot be calculated.
    """
    if source.suffix.lower() == ".json":
        try:
            return _of_results(source, read_results_json(source))
        except OSError as error:
            raise CannotBeCompared(source, (file_problem(source, error),)) from error
        except ValueError:
            pass  # a case, or no JSON at all: the reader of cases says which
    read = read_checked(source)
    if isinstance(read, Unreadable) or read.problems:
        raise CannotBeCompared(source, read.problems)
    units, settings, why = None, {}, "calculated now, because a case JSON contains no results"
    if isinstance(read, WorkbookInput):
        units, _ = read_shown_units(read.workbook, read.data.ratings.rated_torque)
        recorded = workbook_provenance(read.workbook)
        is_current = recorded.digest == case_digest(read.data)
        if is_current and not recalculate:
            return with_studies(_as_recorded(source, read, units, recorded), read)
        settings, why = (
            recorded.settings,
            "calculated now, because the workbook contains no results",
        )
        if is_current:
            why = "calculated now, as requested"
        elif recorded.digest:
            why = "calculated now, because the results in the workbook belong to other inputs"
    run, problems = recalculate_case(read, settings, on_stage)
    if run is None:
        raise CannotBeCompared(source, problems)
    return with_studies(compared_file(source, read, run, units, why, settings), read)


def with_studies(side: ComparedFile, read: CaseInput) -> ComparedFile:
    """A side with its study sheets.

    Parameters
    ----------
    side : ComparedFile
        Inputs and results.
    read : CaseInput
        The input they are of. [SI]

    Returns
    -------
    ComparedFile
        With the rows of its study tables, and of a workbook the studies that stand in it.
    """
    rows = StudyInputs() if read.studies is None else read.studies.inputs
    if isinstance(read, WorkbookInput) and side.units is not None:
        return replace(side, study_inputs=rows, studies=recorded_studies(read, side.units))
    return replace(side, study_inputs=rows)


def _of_results(source: Path, content: Mapping[str, Any]) -> ComparedFile:
    tables = {
        spec.name: header_rows(spec, [r for r in content.get(spec.key, ()) if isinstance(r, dict)])
        for spec in COMPARED
        if isinstance(content.get(spec.key), list)
    }
    startup = content.get("startup")
    if isinstance(startup, dict) and isinstance(startup.get("bearing_forces"), list):
        tables["BearingForces"] = header_rows(table("BearingForces"), startup["bearing_forces"])
    software = f"torsionbook {content.get('version', '')}".strip()
    return ComparedFile(
        source, None, None, None, _plain_tables(tables),
        "as recorded in the file, which contains no inputs",
        software, str(content.get("case_sha256") or ""), json_provenance(content).settings,
    )  # fmt: skip


def _as_recorded(
    source: Path, read: WorkbookInput, units: ShownUnits, recorded: Provenance
) -> ComparedFile:
    tables = {spec.name: recorded_rows(read.workbook, spec, units) for spec in COMPARED}
    for spec in COMPARED:
        if spec.judges:
            tables[spec.name] = [_with_judged(row) for row in tables[spec.name]]
    return ComparedFile(
        source, read.data, read.typed, units, tables,
        "as recorded in the file, whose digest matches its inputs",
        recorded.software, recorded.digest, recorded.settings,
    )  # fmt: skip


def compared_file(
    source: Path,
    read: CaseInput,
    run: Calculation,
    units: ShownUnits | None,
    results_from: str,
    settings: Mapping[str, Any] | None = None,
) -> ComparedFile:
    """A side whose results have been calculated.

    Parameters
    ----------
    source : Path
        The file. [path]
    read : CaseInput
        Its inputs. [SI]
    run : Calculation
        Their results. [SI]
    units : ShownUnits or None
        Units in which it is shown; None for a case JSON.
    results_from : str
        Where the results come from, in words. [sentence]
    settings : mapping, optional
        Settings of the command line. [SI]

    Returns
    -------
    ComparedFile
        Inputs and results.
    """
    tables = {
        spec.name: header_rows(spec, run.tables[spec.name])
        for spec in COMPARED
        if spec.name in run.tables
    }
    forces = (run.startup or {}).get("bearing_forces") or ()
    tables["BearingForces"] = header_rows(table("BearingForces"), list(forces))
    return ComparedFile(
        source, read.data, read.typed, units, _plain_tables(tables), results_from,
        run.stamp.software, run.case_sha256, dict(settings or {}),
    )  # fmt: skip


def _plain_tables(tables: Mapping[str, list[dict[str, Any]]]) -> dict[str, Rows]:
    """Rows with Python's own numbers, and verdicts' numbers as `RoundedNumber`."""
    return {name: [_plain_row(name, row) for row in rows] for name, rows in tables.items()}


def _plain_row(name: str, row: Mapping[str, Any]) -> dict[str, Any]:
    plain = {k: v.item() if hasattr(v, "item") else v for k, v in row.items()}
    if table(name).judges:
        for column in ("Result", "Limit"):
            value = plain.get(column)
            if isinstance(value, int | float) and not isinstance(value, bool):
                plain[column] = RoundedNumber(float(value), "")
    for column in ("Allowable starts", "Paper count"):
        if name == "AllowableStarts" and plain.get(column) is None:
            # a row that does not say whether its starts are limited is of no whole start
            plain[column] = "unlimited" if "unlimited" in plain else "not judged"
    return plain


# --- numbers that a workbook shows as words --------------------------------------------------------


def _with_judged(row: Mapping[str, Any]) -> dict[str, Any]:
    """A row of a check with its numbers read out of the words."""
    return dict(row) | {k: _judged(row[k]) for k in ("Result", "Limit") if k in row}


_NUMBER_AND_UNIT = re.compile(r"(-?\d[\d,]*(?:\.\d+)?(?:[eE][+-]?\d+)?)\s*(\S.*)?")
_DIMENSIONS = ("fraction", "frequency", "pressure", "torque", "time", "speed")


def _judged(shown: Any) -> Any:
    """A judged number out of words such as ``12.34 %``; words without one stay words."""
    if isinstance(shown, float):
        return RoundedNumber(shown, f"{shown:,.10g}")
    match = _NUMBER_AND_UNIT.fullmatch(str(shown).strip())
    if match is None:
        return shown
    number, unit = float(match[1].replace(",", "")), match[2] or ""
    for dimension in _DIMENSIONS if unit else ():
        try:
            scale = parse_unit(unit, dimension)
        except UnitError:
            continue
        if not scale.base:
            return RoundedNumber(number * scale.factor, str(shown))
    return shown if unit else RoundedNumber(number, str(shown))
