"""Results as they stand in a workbook, in SI: what an earlier calculation or study has written."""

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
    """The study of accuracy that stands on sheet Accuracy."""

    rows: Sequence[Mapping[str, Any]]  #: Rows of `AccuracyCost` by JSON key. [SI]
    sentence: str  #: What it found, and against what its errors are measured.
    reference: str  #: Likewise.
    inputs: str  #: Which inputs it belongs to, with date and version.

    def belongs_to(self, digest: str) -> bool:
        """Whether it is a study of these inputs."""
        return digest[:DIGITS] in self.inputs


def recorded_rows(workbook: Workbook, spec: TableSpec, units: ShownUnits) -> list[dict[str, Any]]:
    """Rows of a result table as they stand.

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
    table = workbook.tables.get(spec.name)
    if table is None:
        return []
    fields = [f for f in spec.workbook_columns if f not in spec.extra_columns]
    rows = []
    for number in range(table.data.top, table.data.bottom + 1):
        row: dict[str, Any] = {}
        for one in fields:
            at = table.columns_at.get(one.name.casefold())
            shown = at and workbook.shown_value(table.sheet, cell_name(number, at))
            if shown is not None and shown != "" and at:
                row[one.name] = _si(spec, one, shown, units)
        if row:
            rows.append(row)
    return rows


def _si(spec: TableSpec, one: Field, shown: Any, units: ShownUnits) -> Any:
    """A shown result in SI, as it was before it was written."""
    if isinstance(shown, ErrorValue):
        return shown.code
    if one.kind in ("flag", "switch"):
        return {"yes": True, "on": True, "off": False}.get(str(shown), shown)
    if isinstance(shown, float) and one.is_number:
        column = one.name
        if spec.repeated is not None and one not in spec.columns:
            column = spec.repeated.name
        factor = units.factors.get((spec.name, one.name), units.factor(spec.name, column))
        return shown * factor
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
