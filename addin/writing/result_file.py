"""The result file of a workbook, when it is there already: whether a further study or calculation continues in it."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

from addin.contract.banner import COPY_SHEET
from addin.contract.studies.registry import STUDIES, STUDY_FACTS_SHEET
from addin.contract.tables import EVERY_INPUT
from addin.reading.workbook import WorkbookInput, read_workbook
from addin.recorded.results import recorded_fact
from addin.xlsx import Formula, PackageError, Workbook, open_workbook
from addin.xlsx.references import MAX_COLUMN, MAX_ROW, Rect, cell_name
from engine.case.data import case_digest

_WHOLE_SHEET = Rect(1, 1, MAX_ROW, MAX_COLUMN)
#: Hidden sheets that the calculation writes alone.
_WRITTEN = (COPY_SHEET, STUDY_FACTS_SHEET, "Lists", "ChartData", "StudyData")


def continued(source: WorkbookInput, target: Path) -> tuple[WorkbookInput | None, tuple[str, ...]]:
    """The result file that stands where results go, if more can be written into it.

    It can if every cell that is typed in the source stands there likewise: what was added or typed in the result file
    then stays, with the results of other studies.

    Parameters
    ----------
    source : WorkbookInput
        The input, without problems. [SI]
    target : Path
        Where results go. [path]

    Returns
    -------
    standing : WorkbookInput or None
        The result file; None if there is none, or results begin anew. [SI]
    notes : tuple of str
        Why they begin anew although it has results of studies. [sentences]
    """
    # Nothing goes through a link: it is refused when results are written.
    if (
        not os.path.exists(target)
        or target.is_symlink()
        or target.resolve() == source.path.resolve()
    ):
        return None, ()
    try:
        workbook = open_workbook(target, read_only=True)
        standing = read_workbook(workbook)
    except PackageError:
        return None, ()
    commands = [
        study.command for study in STUDIES if recorded_fact(workbook, f"{study.key}_Sentence")
    ]
    other = next(_other_cells(source.workbook, workbook), "")
    if not other and (standing.problems or case_digest(standing.data) != case_digest(source.data)):
        other = "its inputs"
    if not other:
        return standing, ()
    if not commands:
        return None, ()
    return None, (
        f"{target.name} was made anew from {source.path.name}, as the two differ ({other}). What stood there, with "
        f"{' and '.join(commands)}, is kept as {target.name}.bak.",
    )


def has_more(source: WorkbookInput, standing: WorkbookInput) -> bool:
    """Whether a result file has tables that its source has not: those of studies."""
    return bool(set(standing.workbook.tables) - set(source.workbook.tables))


def _other_cells(source: Workbook, standing: Workbook) -> Iterator[str]:
    """Cells typed in the source that are others in the result file."""
    sheets = set(standing.sheet_names)
    inputs = {spec.name.casefold() for spec in EVERY_INPUT}
    kept = set(standing.tables)
    for sheet in source.sheet_names:
        if sheet in _WRITTEN or source.structure.worksheet_part(sheet) is None:
            continue
        if sheet not in sheets or standing.structure.worksheet_part(sheet) is None:
            yield f"sheet {sheet}"
            continue
        results = [
            table.ref
            for table in source.tables.values()
            if table.sheet == sheet and table.name.casefold() not in inputs
        ]
        here, there = source.sheet_part(sheet), standing.sheet_part(sheet)
        for row, column in here.filled_cells(_WHOLE_SHEET):
            if any(table.has(row, column) for table in results):
                continue
            value, other = here.value(row, column), there.value(row, column)
            if isinstance(value, Formula) and isinstance(other, Formula):
                value, other = _meaning(value.text), _meaning(other.text)
            if value != other:
                yield f"{sheet}!{cell_name(row, column)}"
    for name in set(source.tables) - kept:
        yield f"table {name}"


def _meaning(formula: str) -> str:
    """A formula to be compared; the banner of an earlier release is renewed by the calculation."""
    return "banner" if "Verdicts[Verdict]" in formula else formula
