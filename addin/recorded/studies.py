"""Studies as recorded in a workbook, in SI, and whether they are those of its inputs."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from addin.contract.digests import short_digest
from addin.contract.shown_units import ShownUnits
from addin.contract.studies.registry import STUDIES
from addin.contract.study_spec import CUT_SHORT, StudySpec
from addin.contract.tables import STUDY_RESULT_TABLES
from addin.reading.workbook import WorkbookInput
from addin.recorded.results import recorded_fact, recorded_rows
from addin.recorded.study_digests import edited_tables
from engine.case.data import case_digest
from engine.case.study_inputs import StudyInputs, study_digest

#: What the stamp of a study says of its rows.
_ROWS = re.compile(r"study rows ([0-9a-f]{12})")


@dataclass(frozen=True, eq=False)
class RecordedStudy:
    """A study that stands on the sheets of a workbook."""

    on_sheet: StudySpec  #: Which study, its sheet and its command.
    sentence: str  #: What it found; who made it, when, from which inputs.
    stamp: str  #: Likewise.
    #: Rows of its result tables by table and header, of tables that the workbook has. [SI]
    tables: Mapping[str, Sequence[Mapping[str, Any]]]
    outdated: str  #: Why it is not a study of the inputs as they are now; empty where it is.
    edited: tuple[str, ...]  #: Its tables that do not hold what it wrote.
    is_recorded: bool  #: What it wrote is recorded, so that edits are seen.
    is_cut_short: bool = False  #: Ctrl-C ended it: a part of it stands there.

    @property
    def key(self) -> str:
        """Its key. [name]"""
        return self.on_sheet.key


def rows_digest(tables: Sequence[str], inputs: StudyInputs) -> str:
    """Digest of the rows that a study is made from, whatever its settings are.

    Parameters
    ----------
    tables : sequence of str
        Study tables that it reads. [names]
    inputs : StudyInputs
        What is typed in them. [SI]

    Returns
    -------
    str
        64 hexadecimal digits; the same in any unit. [hex]
    """
    return study_digest(*(row for name in tables for row in inputs.rows(name)))


def recorded_studies(read: WorkbookInput, units: ShownUnits) -> tuple[RecordedStudy, ...]:
    """The studies that stand in a workbook, in the order of their sheets.

    Parameters
    ----------
    read : WorkbookInput
        The workbook, its case without problems. [SI]
    units : ShownUnits
        The units above its columns.

    Returns
    -------
    tuple of RecordedStudy
        Of studies that have been made.
    """
    inputs = StudyInputs() if read.studies is None else read.studies.inputs
    digest = case_digest(read.data)
    specs = {spec.name: spec for spec in STUDY_RESULT_TABLES}
    recorded = []
    for study in STUDIES:
        sentence, made, stamp, written = (
            recorded_fact(read.workbook, f"{study.key}_{fact}")
            for fact in ("Sentence", "SHA256", "Stamp", "Tables")
        )
        if not (sentence or made):
            continue
        names = study.result_names
        tables = {name: recorded_rows(read.workbook, specs[name], units) for name in names}
        rows = rows_digest(study.input_names, inputs)
        outdated = _outdated(study.input_names, made, digest, stamp, rows) or _unread(
            study.input_names, read
        )
        edited = edited_tables(read.workbook, (specs[name] for name in names), units, written)
        is_part = sentence.startswith(CUT_SHORT)
        recorded.append(
            RecordedStudy(study, sentence, stamp, tables, outdated, edited, bool(written), is_part)
        )
    return tuple(recorded)


def _unread(tables: Sequence[str], read: WorkbookInput) -> str:
    """That a cell of its tables cannot be read: it counts as blank in the digest, but is not."""
    problems = () if read.studies is None else read.studies.problems
    for problem in problems:
        if problem.table in tables:
            place = (
                problem.column if problem.row is None else f"row {problem.row}, {problem.column}"
            )
            return f"table {problem.table} now has an unreadable cell ({place})"
    return ""


def _outdated(tables: Sequence[str], made: str, digest: str, stamp: str, rows: str) -> str:
    """Why a study is not one of the inputs as they are now."""
    if made != digest:
        of = f"inputs with SHA-256 {short_digest(made)}" if made else "inputs that are not recorded"
        return f"it was calculated from {of}, but those in the file have SHA-256 {short_digest(digest)}"
    stated = _ROWS.search(stamp)
    if tables and (stated is None or not rows.startswith(stated.group(1))):
        of = f"table {tables[0]}" if len(tables) == 1 else f"tables {' and '.join(tables)}"
        return f"the rows of {of} were changed since it was calculated"
    return ""
