"""What a report is about: one calculation, the inputs as typed, its units and its pictures."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from addin.calculation.calculation import Calculation
from addin.contract.problems import shortened
from addin.diff.changes import Differences
from addin.reading.typed_case import CaseInput
from addin.recorded.results import RecordedAccuracy
from addin.recorded.studies import RecordedStudy
from addin.report.document import Table
from addin.report.figures import Pictures
from addin.report.numbers import clean
from addin.report.tables import result_table
from addin.report.units import DocumentUnits

#: Longest text of the title block. [characters]
_TITLE = 600


@dataclass(frozen=True, eq=False)
class Subject:
    """One calculation and what is needed to show it."""

    name: str  #: Name of the file, without its folder.
    calculation: Calculation  #: The results. [SI]
    read: CaseInput  #: The inputs as typed.
    shown: DocumentUnits  #: Units of the document.
    pictures: Pictures  #: Its charts.
    alerts: tuple[str, ...]  #: What must be known before anything is read.
    show_times: bool  #: Whether measured times are shown; they differ from run to run.
    study: RecordedAccuracy | None = None  #: The study of accuracy in the workbook. [SI]
    recorded: Sequence[RecordedStudy] = ()  #: Other studies in the workbook. [SI]
    against: Differences | None = None  #: An earlier calculation and this one. [SI]

    def rows(self, table: str) -> Sequence[Mapping[str, Any]]:
        """Rows of a result table. [SI]"""
        return self.calculation.tables.get(table, ())

    def table(
        self,
        name: str,
        caption: str = "",
        columns: Sequence[str] = (),
        note: str = "",
        *,
        rows: Sequence[Mapping[str, Any]] | None = None,
    ) -> Table:
        """A result table, of all its rows or of some, in the units of the document."""
        rows = self.rows(name) if rows is None else rows
        return result_table(name, rows, self.shown, caption, columns, note)

    def unit(self, table: str, column: str) -> str:
        """The unit of a result column as printed. [unit]"""
        return self.shown.unit(table, column)

    def value(self, number: float, table: str, column: str) -> float:
        """An SI number in the unit of a result column. [shown unit]"""
        return self.shown.value(number, table, column)

    def cells(self, name: str, row: Mapping[str, Any], columns: Sequence[str]) -> dict[str, str]:
        """A row of a result table as it is shown, by header. [text]"""
        shown = self.table(name, columns=columns, rows=[row])
        headers = (column.header for column in shown.columns)
        return dict(zip(headers, shown.rows[0], strict=True))

    def words(self, scalar: str) -> str:
        """A scalar of the title block as typed; empty where it is blank. [text]"""
        return shortened(clean(str(getattr(self.calculation.case, scalar, None) or "")), _TITLE)

    @property
    def audit(self) -> dict[str, str]:
        """Item → value of table `Audit`. [text]"""
        return {str(row["item"]): str(row["value"]) for row in self.rows("Audit")}
