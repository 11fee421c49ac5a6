"""The sheets of a study, added to a workbook that has none, with rows to begin with.

They are taken from a workbook of this version with the same inputs; everything else in the workbook stays as it is.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from addin.contract.banner import COPY_SHEET
from addin.contract.field import TableSpec
from addin.contract.studies.registry import missing_sheets
from addin.contract.study_spec import StudySpec
from addin.contract.tables import EVERY_TABLE
from addin.reading.workbook import WorkbookInput, read_workbook
from addin.template.build import build_template
from addin.template.examples import Example, Value
from addin.template.filled import MixedUnits, example_of
from addin.worksheet.models import system_of
from addin.xlsx import PackageError, Workbook, open_workbook
from addin.xlsx.added_sheets import save_with_sheets, what_is_in_the_way
from addin.xlsx.references import Rect, quoted_sheet
from engine.case.choices import ElementKind
from engine.case.data import CaseData, case_digest
from engine.case.study_inputs import DAMPING, DAMPING_RATIO, STIFFNESS
from engine.studies.variation import names_with

#: Couplings that `Tuning` begins with: the combinations grow with their product. [count]
_COUPLINGS = 2
#: Stiffnesses that are tried of each, of its own. [%]
_STIFFNESSES = "50; 70; 100; 140; 200"
#: How sure stiffness and damping are where nothing better is known. [%]
_STIFFNESS_SPREAD, _DAMPING_SPREAD = 5.0, 30.0

Rows = Sequence[Mapping[str, Value]]


class CannotAddSheets(PackageError):
    """The workbook has no room for the sheets of a study; the sentence says why and what to do."""


def with_study_sheets(read: WorkbookInput, study: StudySpec, folder: Path) -> WorkbookInput:
    """A copy of a workbook with the sheets of a study, input tables with rows to begin with.

    Parameters
    ----------
    read : WorkbookInput
        The workbook, its case without problems. [SI]
    study : StudySpec
        The study.
    folder : Path
        Where the copy goes, under its own name. [path]

    Returns
    -------
    WorkbookInput
        The copy, as it was read again. [SI]

    Raises
    ------
    CannotAddSheets
        If the workbook has no room for them.
    PackageError
        If the copy cannot be written.
    """
    workbook = read.workbook
    lacking = missing_sheets(workbook.tables, study)
    if taken := sorted(_not_ours(workbook, study, lacking.tables)):
        raise CannotAddSheets(
            f"The sheets of torsionbook {study.command} find no place: {taken[0]}."
        )
    system = system_of(read).lower()
    try:
        filled = example_of(read, system)
    except MixedUnits as mixed:
        raise CannotAddSheets(str(mixed)) from mixed
    rows = {**filled.tables, **default_rows(lacking.tables, read.data)}
    filled = Example(filled.scalars, {**filled.units, **_UNITS}, rows, filled.scalar_units)
    donor_at = build_template(folder / "study-sheets.xlsx", system, filled, studies=True)
    donor = open_workbook(donor_at, read_only=True)
    in_the_way = list(what_is_in_the_way(workbook, donor, lacking.sheets))
    if in_the_way:
        raise CannotAddSheets(
            f"The sheets of torsionbook {study.command} find no place: {'; '.join(in_the_way)}. Then run again."
        )
    path = folder / workbook.path.name
    references = _references(workbook, donor, lacking.sheets)
    save_with_sheets(workbook, donor, lacking.sheets, path, references)
    again = read_workbook(open_workbook(path, ignore_lock=True))
    if again.problems or case_digest(again.data) != case_digest(read.data):
        raise CannotAddSheets(
            f"The inputs of {workbook.path.name} read otherwise with the sheets of torsionbook {study.command}; nothing "
            "was written. Please report it."
        )
    for sheet in lacking.sheets:  # their formulas show what a blank workbook shows
        part = again.workbook.sheet_part(sheet)
        for row, column in part.formulas:
            again.workbook.note_changed(sheet, Rect(row, column, row, column))
    return again


def default_rows(tables: Sequence[str], case: CaseData) -> dict[str, Rows]:
    """Rows that input tables of studies begin with.

    Parameters
    ----------
    tables : sequence of str
        Those that are wanted. [names]
    case : CaseData
        The case. [SI]

    Returns
    -------
    dict of str to rows
        In the units of `_UNITS`; measurements have none.
    """
    rows = {
        "Tuning": _couplings(case),
        "Scatter": _scatter(case),
    }
    return {name: rows[name] for name in tables if rows.get(name)}


#: Units of those rows.
_UNITS = {
    ("Scatter", "Spread"): "%",
}


def _couplings(case: CaseData) -> Rows:
    """Couplings first; a train without any has another element to soften."""
    stiff = [one for one in case.elements if one.element in names_with(case, STIFFNESS)]
    chosen = [one for one in stiff if one.kind == ElementKind.COUPLING]
    return [
        {"Element": one.element, "Quantity": STIFFNESS, "Unit": "%", "Values": _STIFFNESSES}
        for one in (chosen or [one for one in stiff if one.kind == ElementKind.SHAFT])[:_COUPLINGS]
        if one.element is not None
    ]


def _scatter(case: CaseData) -> Rows:
    rows: list[dict[str, Value]] = []
    if names_with(case, STIFFNESS):
        rows.append({"Quantity": STIFFNESS, "Distribution": "normal", "Spread": _STIFFNESS_SPREAD})
    for quantity in (DAMPING_RATIO, DAMPING):
        if names_with(case, quantity):
            rows.append(
                {"Quantity": quantity, "Distribution": "uniform", "Spread": _DAMPING_SPREAD}
            )
    return rows


def _not_ours(workbook: Workbook, study: StudySpec, absent: Sequence[str]) -> Iterator[str]:
    """Tables that have the name of one of the study, but not its columns."""
    specs: dict[str, TableSpec] = {spec.name: spec for spec in EVERY_TABLE}
    stored = {table.name.casefold(): table for table in workbook.tables.values()}
    for name in (*study.input_names, *study.result_names):
        if name in absent:
            continue
        table = stored[name.casefold()]
        headers = {str(header).strip().casefold() for header in table.columns}
        first = specs[name].columns[0].name
        if first.casefold() not in headers:
            yield (
                f"table {table.name} of sheet {table.sheet} has no column {first} and so is your own. Give it another "
                "name (Table Design, Table Name)"
            )


def _references(
    workbook: Workbook, donor: Workbook, sheets: Sequence[str]
) -> dict[tuple[str, str], str]:
    """Where cells stand here to which the new sheets refer: they have names, or are on a sheet of that name."""
    here = {one.name.casefold(): one for one in workbook.structure.names if not one.local_sheet}
    led = {}
    for one in donor.structure.names:
        if one.local_sheet or one.sheet is None or one.rect is None or one.sheet in sheets:
            continue
        there = here.get(one.name.casefold())
        if there is not None and there.sheet is not None and there.rect is not None:
            led[one.sheet, _absolute(one.rect)] = (
                f"{quoted_sheet(there.sheet)}!{_absolute(there.rect)}"
            )
    overall = here.get("overallverdict")
    if overall is not None and overall.sheet is not None:
        led["Summary", "$B$2"] = f"{quoted_sheet(overall.sheet)}!$B$2"
    if COPY_SHEET not in workbook.sheet_names:  # a workbook made before there was the copy
        led[COPY_SHEET, "$C$2"] = "FALSE"
    return led


def _absolute(rect: Rect) -> str:
    first = str(Rect(rect.top, rect.left, rect.top, rect.left))
    letters = first.rstrip("0123456789")
    return f"${letters}${first[len(letters) :]}"
