"""The workbook as its callers see it: read values, write cells, tables and blocks, save.

Nothing touches the file before `Workbook.save`; until then all changes live in the parsed parts.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import Any

from addin.xlsx.cell_looks import CellLooks
from addin.xlsx.chart_titles import TitleLink
from addin.xlsx.charts import Area, Shown
from addin.xlsx.container import DEFAULT_LIMITS, Container, Limits
from addin.xlsx.drawn_shapes import EMU, DrawnGroup, Shape, ShapeGroup, with_hidden
from addin.xlsx.errors import Obstacle, ObstaclesFound, WorkbookMismatch, WorkbookRefused
from addin.xlsx.formulas import CacheReport, lacks_values, refresh_formula_caches
from addin.xlsx.locks import check_not_open
from addin.xlsx.references import Rect, cell_name, parse_cell
from addin.xlsx.save import Destination, PackageChange, SaveReport, save_package
from addin.xlsx.sheet_part import SheetPart
from addin.xlsx.state import WorkbookState
from addin.xlsx.table_writing import TableData, TablePlan, carry_out, obstacles_of, plan_table
from addin.xlsx.values import CellValue, Constant
from addin.xlsx.workbook_part import WorkbookPart
from addin.xlsx.written import cleaned, misread, places_of_rows


def open_workbook(
    path: str | Path,
    *,
    ignore_lock: bool = False,
    read_only: bool = False,
    limits: Limits = DEFAULT_LIMITS,
) -> Workbook:
    """Open an .xlsx or .xlsm workbook after checking that it is safe to open and to change.

    Parameters
    ----------
    path : str or Path
        The file. It is read whole; later changes of the file are noticed when saving.
    ignore_lock : bool
        Open although a lock file says that somebody has it open.
    read_only : bool
        Open without the checks that matter for writing only (locks, signature); it cannot be saved then.
    limits : Limits
        Largest sizes accepted.

    Raises
    ------
    WorkbookRefused
        With a reason and a sentence: missing, encrypted, xls, xlsb, strict, template, signed, bomb, dtd, damaged, ...
    WorkbookLocked
        When Excel or LibreOffice has it open.
    """
    file = Path(path)
    if not (ignore_lock or read_only):
        check_not_open(file)
    container = Container(file, limits)
    workbook = Workbook(container, WorkbookPart(container))
    if not read_only:
        workbook.allow_saving(ignore_lock=ignore_lock)
    return workbook


class Workbook(WorkbookState):
    """An open workbook to read, write and save. Made by `open_workbook`; its attributes are those of `WorkbookState`."""

    def __init__(self, container: Container, structure: WorkbookPart) -> None:
        super().__init__(container, structure)
        self._read_only = True
        self._ignore_lock = False
        #: Whether another file that a save replaces stays as ``.bak``, as the original does in place.
        self.keep_replaced = False
        self._print_areas: dict[str, str] = {}
        self._drawings: dict[str, bytes] = {}
        self._cache_report: CacheReport | None = None

    # ---- reading -----------------------------------------------------------------------------------------------

    def value(self, sheet: str, cell: str) -> CellValue:
        """What a cell holds now; a formula with its cached value."""
        return self.sheet_part(sheet).value(*parse_cell(cell))

    def shown_value(self, sheet: str, cell: str) -> Constant:
        """The value that a cell shows now; of a formula its cached value."""
        return self.sheet_part(sheet).constant(*parse_cell(cell))

    @cached_property
    def looks(self) -> CellLooks:
        """How its cells look."""
        return CellLooks(self)

    # ---- writing -----------------------------------------------------------------------------------------------

    def set_cell(
        self,
        sheet: str,
        cell: str,
        value: Any,
        *,
        replace_formula: bool = False,
    ) -> None:
        """Write one cell; it keeps its style, and a new cell takes that of its row or column.

        Parameters
        ----------
        sheet, cell : str
            Where, e.g. ``"Case"``, ``"B4"``.
        value : None, bool, int, float, str, ErrorValue or Formula
            None = blank. Text is written as text, never as a formula.
        replace_formula : bool
            Whether a formula in that cell may be replaced by a value.

        Raises
        ------
        CellRefused
            When the cell may not be written or cannot hold the value.
        """
        part = self.sheet_part(sheet)
        row, column = parse_cell(cell)
        held = cleaned(part.name, row, column, value)
        texts = part.set_cell(row, column, held, replace_formula=replace_formula)
        self.note_written(part.name, Rect(row, column, row, column), [[held]], texts)

    def set_name(self, name: str, value: Any, *, replace_formula: bool = False) -> None:
        """Write the cell that a defined name stands for."""
        target = self.name(name)
        assert target.sheet is not None
        assert target.rect is not None
        cell = cell_name(target.rect.top, target.rect.left)
        self.set_cell(target.sheet, cell, value, replace_formula=replace_formula)

    def write_table(
        self,
        name: str,
        rows: Sequence[Sequence[Any]],
        *,
        columns: Sequence[str] | None = None,
        formulas: Mapping[str, str] | None = None,
    ) -> None:
        """Write the rows of one table and resize it to fit; see `write_tables`."""
        self.write_tables([TableData(name, rows, columns, formulas or {})])

    def write_tables(self, tables: Iterable[TableData]) -> None:
        """Write the rows of several tables and resize each to fit.

        The table keeps at least one data row, blank when there are no rows. New rows take the styles of its first data
        row; rows that are no longer needed are removed. A totals row moves along. Columns that are not written stay
        the user's: their calculated formulas are filled into new rows, and what the user typed in rows that the table
        gives up is left where it is (and noted). Conditional formats, data validations and chart ranges that covered
        exactly the data rows follow.

        Raises
        ------
        ObstaclesFound
            With everything that is in the way of any of the tables; then nothing has been changed.
        WorkbookMismatch
            For a table or column that the workbook lacks.
        """
        plans = [plan_table(self, data) for data in tables]
        names = [plan.old.name for plan in plans]
        if len(set(names)) < len(names):
            raise WorkbookMismatch(f"A table was given twice: {', '.join(names)}.")
        obstacles = [obstacle for plan in plans for obstacle in obstacles_of(self, plan)]
        if obstacles:
            raise ObstaclesFound(obstacles)
        for plan in plans:
            carry_out(self, plan)

    def set_print_area(self, sheet: str, text: str) -> None:
        """Let other cells be printed of a sheet that has a print area; of another one nothing changes.

        Parameters
        ----------
        sheet : str
            The sheet.
        text : str
            Its areas, each with the name of the sheet, as a defined name holds them. [reference]
        """
        self._print_areas[sheet] = text

    def set_row_height(self, sheet: str, row: int, height: float) -> None:
        """Set the height of a row whose text wraps.

        Parameters
        ----------
        sheet : str
            Its sheet.
        row : int
            The row.
        height : float
            Height. [point]
        """
        self.sheet_part(sheet).set_row_height(row, height)

    def hide_objects(self, hidden: Mapping[str, bool]) -> None:
        """Hide or show charts and shapes, wherever they stand; nothing else of a drawing changes.

        Parameters
        ----------
        hidden : mapping of str to bool
            Description of the object (its alternative text) → whether it is hidden.
        """
        for part in self._drawing_parts():
            self._drawings[part] = with_hidden(self._drawing(part), hidden)

    def draw(self, description: str, shapes: Callable[[float, float], Sequence[Shape]]) -> None:
        """Draw an object anew as a group of shapes; a workbook without such an object stays as it is.

        Parameters
        ----------
        description : str
            Description of the object that the group takes the place of (its alternative text).
        shapes : callable
            Width and height of its room → the shapes. [pixel]
        """
        mark = f'"{description}"'.encode()
        for part in self._drawing_parts():
            if mark not in self._drawing(part):
                continue
            group = ShapeGroup(part, self._drawing(part), description)
            if (frame := group.frame) is not None:
                made = shapes(frame.width / EMU, frame.height / EMU)
                self._drawings[part] = group.drawn(made)

    def drawn_group(self, description: str) -> DrawnGroup | None:
        """The shapes that an object of this description (its alternative text) holds; None where there is none."""
        mark = f'"{description}"'.encode()
        for part, sheet in self._drawing_parts().items():
            if mark in self._drawing(part):
                group = ShapeGroup(part, self._drawing(part), description).read(sheet)
                if group is not None:
                    return group
        return None

    def _drawing_parts(self) -> dict[str, str]:
        """Parts of the drawings of all sheets, with the sheet of each."""
        worksheets = {name: self.structure.worksheet_part(name) for name in self.sheet_names}
        return {
            one.part: name
            for name, part in worksheets.items()
            if part
            for one in self.structure.relationships(part)
            if one.kind == "drawing" and one.part in self.container.names
        }

    def _drawing(self, part: str) -> bytes:
        return self._drawings.get(part) or self.container.read(part)

    def obstacles(self, rows: Mapping[str, int]) -> list[Obstacle]:
        """What would be in the way if tables had these numbers of rows."""
        plans = []
        for name, count in rows.items():
            table = self.table(name)
            plans.append(
                TablePlan(table, table.resized(count), list(range(len(table.columns))), [], {})
            )
        return [obstacle for plan in plans for obstacle in obstacles_of(self, plan)]

    # ---- caches and saving -------------------------------------------------------------------------------------

    def link_chart_titles(self, links: Sequence[TitleLink]) -> None:
        """Link titles of charts that became fixed words to their cells again, after the cells were written.

        Parameters
        ----------
        links : sequence of TitleLink
            Cells of the titles, by the cells a chart draws; all other charts stay as they are.
        """

        def text(sheet: str, cell: str) -> str:
            return str(self.shown_value(sheet, cell) or "")

        for chart in self.charts:
            chart.link_titles(links, self.chart_areas, text)

    def renew_charts_of(self, sheet: str, rect: Rect) -> None:
        """Let charts take the values of cells again that another program may have changed without them.

        Parameters
        ----------
        sheet : str
            Their sheet.
        rect : Rect
            The cells.
        """
        self.perhaps_changed.add(sheet, rect)
        self.charts_current = False

    def refresh_chart_caches(self) -> None:
        """Renew the values that charts carry of changed cells.

        Touches only chart parts with a range that reaches a changed cell, and in them only the caches; all other charts
        stay byte-identical. Called by `save`.
        """
        self.charts_current = True
        known: dict[tuple[str, str, tuple[Area, ...]], bytes] = {}
        shown = Shown(self._shown, lambda sheet, rect: self.sheet_part(sheet).number_texts(rect))
        for chart in self.charts if self.changed or self.perhaps_changed else ():
            chart.refresh(
                self.chart_areas, (self._is_new, self.perhaps_changed.touch), shown, known
            )

    def refresh_formula_caches(self) -> CacheReport:
        """Renew or remove the cached value of every formula that depends on changed cells. Called by `save`."""
        if self._cache_report is None or not self.formulas_current:
            self._cache_report = refresh_formula_caches(self)
            self.formulas_current = True
        return self._cache_report

    def allow_saving(self, *, ignore_lock: bool = False) -> None:
        """Make the checks that opening for reading only leaves out; from then on it can be saved.

        Raises
        ------
        WorkbookRefused
            When it is signed.
        WorkbookLocked
            When Excel or LibreOffice has it open.
        """
        if not ignore_lock:
            check_not_open(self.path)
        if self.structure.is_signed():
            raise WorkbookRefused(
                "signed",
                f"{self.path.name} has a digital signature, which any change would invalidate. Save "
                "an unsigned copy and use that.",
            )
        self._read_only = False
        self._ignore_lock = ignore_lock

    def save(self, destination: str | Path | None = None, *, in_place: bool = False) -> SaveReport:
        """Write the workbook, whole or not at all.

        Caches of formulas and charts are renewed first. The new file is written beside its place, read back, compared,
        and only then put there in one step; the original is read again before that, and if anything is wrong nothing
        has changed.

        Raises
        ------
        SaveRefused
            With the reason; nothing was written.
        """
        report = self.refresh_formula_caches()
        if not self.charts_current:
            self.refresh_chart_caches()
        replaced, dropped = self._parts_to_write()
        notes = (*self.notes, *_without_value(report), *self._other_copies_of_values())
        return save_package(
            self.container,
            PackageChange(replaced, dropped),
            Destination(
                Path(destination) if destination is not None else None,
                in_place,
                read_only=self._read_only,
                ignore_lock=self._ignore_lock,
                keep_replaced=self.keep_replaced,
            ),
            check=self._misread_cells,
            caches=report,
            notes=notes,
        )

    # ---- internals ---------------------------------------------------------------------------------------------

    def _is_new(self, sheet: str, rect: Rect) -> bool:
        """Whether a chart draws otherwise there: it leaves out hidden rows."""
        return self.changed.touch(sheet, rect) or self.shown_rows.touch(sheet, rect)

    def _shown(self, sheet: str, rect: Rect) -> list[Constant]:
        return self.sheet_part(sheet).constants(rect)

    def _parts_to_write(self) -> tuple[dict[str, bytes], set[str]]:
        replaced = self.changed_parts()
        dropped: set[str] = set()
        if "charts" in self.__dict__:
            replaced |= {chart.part: chart.to_bytes() for chart in self.charts if chart.changed}
        if any(sheet.formula_set_changed() for sheet in self._sheets.values()):
            chain, dropped = self.structure.without_calc_chain()
            replaced |= chain
        replaced |= self._drawings
        structure = self.structure.with_print_areas(self._print_areas)
        if self.changed and lacks_values(self):
            structure = self.structure.with_full_calculation(structure)
        replaced[self.structure.part] = structure
        same = [name for name, data in replaced.items() if data == self.container.read(name)]
        return {name: data for name, data in replaced.items() if name not in same}, dropped

    def _other_copies_of_values(self) -> Iterator[str]:
        """Notes on copies of cell values that are not renewed here."""
        if not self.changed:
            return
        if any(part.startswith("xl/pivotCache/") for part in self.container.names):
            yield "Pivot tables show old values until you refresh them in Excel."
        for part in self.container.names:
            if part.startswith("xl/drawings/drawing") and self._has_stale_text(part):
                yield (
                    "Text boxes linked to cells show new values only after you open the workbook in "
                    "Excel."
                )
                return

    def _has_stale_text(self, part: str) -> bool:
        if b"textlink=" not in self.container.read(part):
            return False
        links = (
            shape.get("textlink")
            for shape in self.container.tree(part).iter()
            if shape.get("textlink")
        )
        areas = (self.chart_areas(link) for link in links)
        return any(self.changed.touch(*area) for found in areas for area in found or ())

    def _misread_cells(self, parts: Mapping[str, bytes]) -> list[str]:
        """Cells that read back otherwise than written, from the parts of the new file."""
        wrong: list[str] = []
        for name, written in self.written.items():
            part = self._sheets[name].part
            data = parts.get(part) or self.container.read(part)
            rows = places_of_rows(data)
            if not all(one.stands_in(data, rows) for one in written):
                # Prefixed names, cells written twice, renewed values: read these sheets cell by cell.
                again = SheetPart(name, part, data, self.shared_texts.text)
                wrong += [f"{name}!{cell}" for cell in misread(again, written)]
        return wrong


def _without_value(report: CacheReport) -> Iterator[str]:
    """A note that names the formulas whose values were removed."""
    if not report.removed:
        return
    named = ", ".join(report.removed_cells)
    more = report.removed - len(report.removed_cells)
    beyond = f" and {more} more" if more else ""
    yield (
        (
            f"{report.removed} formulas have no stored value; they are calculated when you open the workbook: "
            f"{named}{beyond}. {report.reason}"
        )
        if report.removed > 1
        else (
            f"The formula in {named} has no stored value; it is calculated when you open the workbook. {report.reason}"
        )
    )
