"""What a study is in workbook and JSON: tables, sheets, and the lines that say what it found."""

from __future__ import annotations

from dataclasses import dataclass, field

from addin.contract.banner import CHANGED_WORDS, IS_CHANGED
from addin.contract.charts import ChartSpec
from addin.contract.field import IncompleteRecord, TableSpec, complete
from addin.contract.json_shapes import Shape
from addin.contract.sheet import Sheet

#: How the sentence of a study begins that was cut short.
CUT_SHORT = "Cut short by Ctrl-C"


@dataclass(frozen=True)
class StudyScale:
    """Columns of a map that are coloured by their numbers."""

    table: str  #: Result table.
    first: str  #: Its first and last coloured column.
    last: str  #: Likewise.
    limit: str = ""  #: Column with the limit below which a cell is red; empty = from least to most.
    #: Table of the same rows and columns whose cells below their limit are marked in this one.
    over: str = ""


@dataclass(frozen=True)
class StudySpec:
    """One study as data; its check and its calculation are in `addin.studies`."""

    key: str  #: Names it in JSON, and begins the names of its facts: ``tuning`` for ``tuning_SHA256``.
    order: int  #: Place of its sheets among those of the studies.
    command: str  #: What calculates it, and the middle of the names of its files. [command]
    sheet: str  #: Sheet of its results.
    inputs: tuple[TableSpec, ...]  #: Its input tables.
    results: tuple[TableSpec, ...]  #: Its result tables, those of the workbook alone among them.
    sheets: tuple[Sheet, ...]  #: Its sheets, of inputs and of results.
    details: Shape = field(default_factory=dict)  #: What its JSON has beside its tables.
    reads: tuple[str, ...] = ()  #: Input tables of other studies that it reads as well. [names]
    height: float = 42.0  #: Of the line that says what was found. [points]
    charts: tuple[ChartSpec, ...] = ()  #: Its charts.
    scales: tuple[StudyScale, ...] = ()  #: Maps that are coloured.

    @property
    def intro(self) -> str:
        """What it is, in one sentence: below the strip of the sheet of its results."""
        return next(sheet.intro for sheet in self.sheets if sheet.name == self.sheet)

    @property
    def input_names(self) -> tuple[str, ...]:
        """Every input table that it reads. [names]"""
        return (*self.reads, *(spec.name for spec in self.inputs))

    @property
    def json_tables(self) -> tuple[TableSpec, ...]:
        """Result tables of workbook and JSON."""
        return tuple(spec for spec in self.results if not spec.workbook_only)

    @property
    def result_names(self) -> tuple[str, ...]:
        """Its result tables, those of workbook and JSON first. [names]"""
        alone = (spec.name for spec in self.results if spec.workbook_only)
        return (*(spec.name for spec in self.json_tables), *alone)

    @property
    def not_yet(self) -> str:
        """What stands there before the study has been made. [sentence]"""
        return (
            "Not calculated yet. Save and close this workbook, then run: "
            f"torsionbook {self.command} FILE"
        )

    @property
    def lines(self) -> tuple[tuple[str, str, float], ...]:
        """Formula, style and height of the lines below the strip of a result sheet. [points]

        What was found; then the stamp, which says when the inputs have changed since, or the plain
        results are of others.
        """
        key = self.key
        return (
            (f'=IF({key}_Sentence="","{self.not_yet}",{key}_Sentence)', "sentence", self.height),
            (
                f'=IF({key}_SHA256="","",IF(run_SHA256={key}_SHA256,IF({IS_CHANGED},"{CHANGED_WORDS}. ",""),'
                f'IF(run_SHA256="","","INPUTS DIFFER from those of the other result sheets: run torsionbook '
                f'{self.command} again. "))&{key}_Stamp)',
                "note",
                15.0,
            ),
        )

    def complete(self, where: str) -> None:
        """Refuse a record that lacks something, and say what and where; see `field.complete`."""
        complete(self.inputs, where, results=False)
        complete(self.results, where, results=True)
        placed = {name: sheet for sheet in self.sheets for name in sheet.tables}
        for spec in (*self.inputs, *self.results):
            sheet = placed.get(spec.name)
            if sheet is None or sheet.worksheet != spec.sheet:
                raise IncompleteRecord(
                    f"table {spec.name} has no cell on sheet {spec.sheet} of study {self.key}: add its "
                    f"cell to the tables of that sheet in {where}"
                )
        if self.sheet not in {sheet.name for sheet in self.sheets}:
            raise IncompleteRecord(
                f"study {self.key} has no sheet {self.sheet}: add one to its sheets in {where}"
            )
        for sheet in self.sheets:
            if not (sheet.intro or sheet.hidden):
                raise IncompleteRecord(
                    f"sheet {sheet.name} of study {self.key} has no introduction: add one in {where}"
                )
