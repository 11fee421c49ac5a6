"""An open workbook in memory: its parts, and what was changed and written of its cells so far.

Formulas, table writing and the calculator's copy work on this; `workbook.Workbook` stands on top.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import TypeVar

from addin.xlsx.charts import Area, ChartPart
from addin.xlsx.container import Container, shown_name
from addin.xlsx.dependents import ChangedCells
from addin.xlsx.errors import WorkbookMismatch, WorkbookRefused
from addin.xlsx.references import (
    MAX_COLUMN,
    Rect,
    parse_range,
    split_areas,
    split_sheet,
)
from addin.xlsx.shared_texts import SharedTexts
from addin.xlsx.sheet_part import SheetPart
from addin.xlsx.tables import Table, check_places, stored_table, with_table
from addin.xlsx.values import CellValue
from addin.xlsx.workbook_part import DefinedName, WorkbookPart
from addin.xlsx.written import Written

_T = TypeVar("_T")


def in_any_capitals(named: Mapping[str, _T], name: str) -> _T | None:
    """What bears a name in any capitals, which are the same to spreadsheet programs."""
    if name in named:
        return named[name]
    return next((one for known, one in named.items() if known.casefold() == name.casefold()), None)


class WorkbookState:
    """What is known of an open workbook.

    Attributes
    ----------
    path : Path
        The file it was read from.
    notes : list of str
        What was done or left that the user should know, in sentences.
    container : Container
        The package as opened.
    structure : WorkbookPart
        Structure of the package.
    shared_texts : SharedTexts
        Texts to which cells refer by number.
    changed : ChangedCells
        Cells whose values changed.
    shown_rows : ChangedCells
        Rows that were hidden, and are not any more.
    perhaps_changed : ChangedCells
        Cells that another program may have changed without renewing the copies in charts.
    written : dict of str to list of Written
        Rectangles written so far, by sheet, in the order they were written.
    formulas_current, charts_current : bool
        Whether the cached values of formulas and of charts were renewed after the last change noted.
    """

    def __init__(self, container: Container, structure: WorkbookPart) -> None:
        self.path = container.path
        self.notes: list[str] = []
        if container.was_strict:
            self.notes.append(
                f"{self.path.name} was saved as 'Strict Open XML Spreadsheet'; what is written is an ordinary Excel "
                "workbook (.xlsx)."
            )
        self.container = container
        self.structure = structure
        self.shared_texts = SharedTexts(container, structure)
        self.changed = ChangedCells()
        self.shown_rows = ChangedCells()
        self.perhaps_changed = ChangedCells()
        self.written: dict[str, list[Written]] = {}
        self._sheets: dict[str, SheetPart] = {}
        self._changed_tables: dict[str, bytes] = {}
        self.formulas_current = False
        self.charts_current = True

    # ---- structure ---------------------------------------------------------------------------------------------

    @property
    def sheet_names(self) -> list[str]:
        """Names of all sheets in order, chart sheets included."""
        return self.structure.sheet_names

    @cached_property
    def defined_names(self) -> dict[str, DefinedName]:
        """Defined names that hold for the whole workbook."""
        return {one.name: one for one in self.structure.names if not one.local_sheet}

    @property
    def local_names(self) -> dict[tuple[str, str], DefinedName]:
        """Defined names confined to a sheet, by sheet and name."""
        return {(one.local_sheet, one.name): one for one in self.structure.names if one.local_sheet}

    @cached_property
    def tables(self) -> dict[str, Table]:
        """All tables by name, with the size that they have now."""
        found: dict[str, Table] = {}
        for sheet in self.sheet_names:
            part = self.structure.worksheet_part(sheet)
            for related in self.structure.relationships(part) if part else ():
                if related.kind == "table":
                    data = self.container.charged(related.part)
                    table = stored_table(data, sheet, related.part)
                    if table.name.casefold() in {name.casefold() for name in found}:
                        raise WorkbookRefused(
                            "damaged",
                            f"{self.path.name} has two tables named {shown_name(table.name)}. Rename one of them.",
                        )
                    found[table.name] = table
        check_places(list(found.values()))
        return found

    def table(self, name: str) -> Table:
        """A table by name; capitals or small letters do not matter.

        Raises
        ------
        WorkbookMismatch
            When there is none of that name.
        """
        table = in_any_capitals(self.tables, name)
        if table is not None:
            return table
        raise WorkbookMismatch(
            f"{self.path.name} has no table {name!r}; it has {', '.join(sorted(self.tables)) or 'none'}. "
            "Start from a new template or give the table its name back."
        )

    def name(self, name: str) -> DefinedName:
        """A defined name of the whole workbook; capitals or small letters do not matter.

        Raises
        ------
        WorkbookMismatch
            When there is none, or when it stands for no cells.
        """
        defined = in_any_capitals(self.defined_names, name)
        if defined is None or defined.rect is None:
            what = "has no defined name" if defined is None else "has a defined name without cells"
            raise WorkbookMismatch(
                f"{self.path.name} {what} {name!r}. Start from a new template or define it again."
            )
        return defined

    # ---- parts -------------------------------------------------------------------------------------------------

    def sheet_part(self, name: str) -> SheetPart:
        """Cells of a sheet; capitals or small letters of its name do not matter."""
        if name in self._sheets:
            return self._sheets[name]
        sheet = in_any_capitals({sheet: sheet for sheet in self.sheet_names}, name)
        if sheet is None:
            raise WorkbookMismatch(
                f"{self.path.name} has no sheet {name!r}; it has {', '.join(self.sheet_names)}."
            )
        part = self.structure.worksheet_part(sheet)
        if part is None:
            raise WorkbookMismatch(
                f"Sheet {sheet!r} of {self.path.name} is a chart or a macro module and has no cells. Name a "
                "worksheet."
            )
        if sheet not in self._sheets:
            data = self.container.charged_beside_cells(part)
            self._sheets[sheet] = SheetPart(sheet, part, data, self.shared_texts.text)
        return self._sheets[sheet]

    def is_loaded(self, sheet: str) -> bool:
        """Whether the cells of a sheet are parsed already."""
        return sheet in self._sheets

    def sheet_bytes(self, sheet: str) -> bytes:
        """Part of a sheet as opened; empty for chart sheets."""
        part = self.structure.worksheet_part(sheet)
        return self.container.read(part) if part else b""

    @cached_property
    def charts(self) -> list[ChartPart]:
        """The chart parts, parsed when first asked for."""
        return [
            ChartPart(part, self.container.charged(part)) for part in self.structure.chart_parts()
        ]

    @cached_property
    def _sheets_with_sparklines(self) -> list[str]:
        return [name for name in self.sheet_names if b"sparkline>" in self.sheet_bytes(name)]

    def chart_areas(self, text: str) -> list[Area] | None:
        """Sheets and cells of a chart's reference, names followed; None when it cannot be followed."""
        areas: list[Area] = []
        for written in split_areas(text):
            sheet, rest = split_sheet(written)
            try:
                area = (sheet, parse_range(rest))
            except ValueError:
                named = self.local_names.get((sheet, rest)) or self.defined_names.get(rest)
                if named is None or named.sheet is None or named.rect is None:
                    return None
                area = (named.sheet, named.rect)
            if self.structure.sheet_names.count(area[0]) != 1:
                return None
            areas.append(area)
        return areas or None

    def changed_parts(self) -> dict[str, bytes]:
        """Sheet and table parts that differ from the file."""
        parts = {sheet.part: sheet.to_bytes() for sheet in self._sheets.values() if sheet.changed}
        return parts | self._changed_tables

    # ---- changes -----------------------------------------------------------------------------------------------

    def note_changed(self, sheet: str, rect: Rect) -> None:
        """Note changed values, so that charts renew their caches."""
        self.changed.add(sheet, rect)
        self.charts_current = False
        self.formulas_current = False

    def note_written(
        self, sheet: str, rect: Rect, grid: Sequence[Sequence[CellValue]], texts: Sequence[str]
    ) -> None:
        """Note a rectangle that was written, to be found again when the file is checked."""
        self.written.setdefault(sheet, []).append(Written(rect, grid, texts))
        self.note_changed(sheet, rect)

    def forget_written(self, sheet: str, rect: Rect) -> None:
        """Expect no longer to find what was written into rows that are removed now."""
        written = self.written.get(sheet, [])
        written[:] = [block for block in written if not block.rect.meets(rect)]

    def update_table(self, table: Table, formulas: Mapping[str, str]) -> None:
        """Put the size and the calculated columns of a table into its part."""
        before = self._changed_tables.get(table.part) or self.container.read(table.part)
        now, criteria_gone = with_table(before, table, formulas)
        if criteria_gone:
            for row in self.sheet_part(table.sheet).show_rows(table.data.top, table.data.bottom):
                self.shown_rows.add(table.sheet, Rect(row, 1, row, MAX_COLUMN))
            self.notes.append(
                f"The filter of table {table.name} was cleared because its rows changed."
            )
        if now is not before:
            self._changed_tables[table.part] = now
            self.tables[table.name] = stored_table(now, table.sheet, table.part)

    def retarget_chart_range(self, sheet: str, old: Rect, new: Rect) -> None:
        """Let ranges of charts and sparklines that covered exactly the rows of one block cover those of another.

        Touches the chart parts concerned, and sheets with such sparklines, and nothing else in them than the range
        texts; called by `write_tables`.
        """
        self.charts_current = False
        for chart in self.charts:
            chart.retarget(sheet, old, new)
        for name in self._sheets_with_sparklines:
            self.sheet_part(name).retarget_sparklines(sheet, old, new)
