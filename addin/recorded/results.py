"""Results as recorded in a workbook, in SI: what an earlier calculation or study has written."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from addin.contract.digests import DIGITS
from addin.contract.shown_units import ShownUnits
from addin.contract.tables import Field, TableSpec, result_table
from addin.contract.texts import NO_STUDY
from addin.xlsx import ErrorValue, PackageError, Workbook
from addin.xlsx.references import cell_name


@dataclass(frozen=True, eq=False)
class RecordedAccuracy:
    """The study of accuracy that stands on sheet Effects and accuracy."""

    rows: Sequence[Mapping[str, Any]]  #: Rows of `AccuracyCost` by JSON key. [SI]
    sentence: str  #: What it found, and against what its errors are measured.
    reference: str  #: Likewise.
    inputs: str  #: Which inputs it belongs to, with date and version.

    def belongs_to(self, digest: str) -> bool:
        """Whether it is a study of these inputs."""
        return digest[:DIGITS] in self.inputs


def recorded_rows(workbook: Workbook, spec: TableSpec, units: ShownUnits) -> list[dict[str, Any]]:
    """Rows of a result table as recorded.

    Parameters
    ----------
    workbook : Workbook
        The open workbook.
    spec : TableSpec
        The table.
    units : ShownUnits
        The units above its columns.

    Returns
    -------
    list of dict
        By header, without blanks; words of judged numbers as they are. [SI]
    """
    fields = {field.name: field for field in spec.workbook_columns}
    return [
        {name: _si(spec, fields[name], shown, units) for name, shown in row.items()}
        for row in shown_rows(workbook, spec)
    ]


def shown_rows(workbook: Workbook, spec: TableSpec) -> list[dict[str, Any]]:
    """Rows of a result table as they are shown: by header, without blanks and blank rows; codes of errors."""
    table = workbook.tables.get(spec.name)
    if table is None:
        return []
    names = [field.name for field in spec.written_columns]
    places = {n: table.columns_at[n.casefold()] for n in names if n.casefold() in table.columns_at}
    sheet = workbook.sheet_part(table.sheet)
    rows = []
    for number in range(table.data.top, table.data.bottom + 1):
        cells = {name: sheet.constant(number, column) for name, column in places.items()}
        rows.append(
            {
                name: shown.code if isinstance(shown, ErrorValue) else shown
                for name, shown in cells.items()
                if shown is not None and shown != ""
            }
        )
    return [row for row in rows if row]


def factor_of(spec: TableSpec, field: Field, units: ShownUnits) -> float:
    """What the unit above a column of numbers is worth. [SI]"""
    repeated = spec.repeated if field not in spec.columns else None
    column = field.name if repeated is None else repeated.name
    return float(units.factors.get((spec.name, field.name), units.factor(spec.name, column)))


def _si(spec: TableSpec, field: Field, shown: Any, units: ShownUnits) -> Any:
    """A shown result in SI, as it was before it was written."""
    if field.kind in ("flag", "switch"):
        return {"yes": True, "on": True, "off": False}.get(str(shown), shown)
    if isinstance(shown, float) and field.is_number:
        return shown * factor_of(spec, field, units)
    return shown


def recorded_fact(workbook: Workbook, name: str) -> str:
    """Words that a calculation has left under a defined name."""
    try:
        at = workbook.name(name)
    except PackageError:
        return ""
    if at.sheet is None or at.rect is None:
        return ""
    value = workbook.shown_value(at.sheet, cell_name(at.rect.top, at.rect.left))
    return value.strip() if isinstance(value, str) else ""


def recorded_accuracy(workbook: Workbook, units: ShownUnits) -> RecordedAccuracy | None:
    """The study of accuracy in a workbook.

    Returns
    -------
    RecordedAccuracy or None
        None where `torsionbook accuracy` has not written there, or recalculation has since.
    """
    sentence = recorded_fact(workbook, "run_AccuracySentence")
    if not sentence or sentence == NO_STUDY:
        return None
    spec = result_table("AccuracyCost")
    keys = {field.name: field.key for field in spec.columns}
    rows = [
        {keys[name]: value for name, value in row.items()}
        for row in recorded_rows(workbook, spec, units)
    ]
    return RecordedAccuracy(
        [row for row in rows if _is_whole(row)],
        sentence,
        recorded_fact(workbook, "run_AccuracyReference"),
        recorded_fact(workbook, "run_AccuracyInputs"),
    )


def _is_whole(row: Mapping[str, Any]) -> bool:
    """Whether a row is one of a study, its numbers not typed over with words."""
    numbers = (row.get(key) for key in ("error_peak", "error_starts", "time"))
    return isinstance(row.get("method"), str) and all(
        one is None or (isinstance(one, float) and one >= 0.0) for one in numbers
    )
