"""The workbook as its callers see it: read values, write cells, tables and blocks, save.

Nothing touches the file before `Workbook.save`; until then all changes live in the parsed parts.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import Any

from lxml import etree

from addin.xlsx.chart_titles import TitleLink
from addin.xlsx.charts import Area, ChartPart
from addin.xlsx.container import DEFAULT_LIMITS, Container, Limits, shown_name
from addin.xlsx.dependents import ChangedCells
from addin.xlsx.errors import (
    CellRefused,
    Obstacle,
    ObstaclesFound,
    WorkbookMismatch,
    WorkbookRefused,
)
from addin.xlsx.formulas import CacheReport, refresh_formula_caches
from addin.xlsx.locks import check_not_open
from addin.xlsx.references import (
    MAX_COLUMN,
    Rect,
    cell_name,
    parse_cell,
    parse_range,
    split_areas,
    split_sheet,
    whole_number,
)
from addin.xlsx.save import SaveReport, save_package
from addin.xlsx.sheet_part import SheetPart
from addin.xlsx.table_writing import TableData, TablePlan, carry_out, obstacles_of, plan_table
from addin.xlsx.tables import Table, apply_table, check_places, parse_table
from addin.xlsx.values import FORMULA_MARK, CellValue, Constant, Formula, rich_text
from addin.xlsx.workbook_part import DefinedName, WorkbookPart
from addin.xlsx.written import Written, cleaned, cleaned_row, misread
from addin.xlsx.xml_part import Element, main, serialise


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


class Workbook:
    """An open workbook. Made by `open_workbook`.

    Attributes
    ----------
    path : Path
        The file it was read from.
    notes : list of str
        What was done or left that the user should know, in sentences.
    """

    def __init__(
        self,
        container: Container,
        structure: WorkbookPart,
    ) -> None:
        self.path = container.path
        self.notes: list[str] = []
        self._container = container
        self._structure = structure
        self._read_only = True
        self._ignore_lock = False
        self._sheets: dict[str, SheetPart] = {}
        self._table_roots: dict[str, Element] = {}
        self._changed_tables: dict[str, bytes] = {}
        self._changed = ChangedCells()
        self._shown_rows = ChangedCells()
        self._written: dict[str, list[Written]] = {}
        self._given_formulas: dict[str, set[tuple[int, int]]] = {}
        self._cache_report: CacheReport | None = None
        self._charts_current = True

    # ---- structure ---------------------------------------------------------------------------------------------

    @property
    def sheet_names(self) -> list[str]:
        """Names of all sheets in order, chart sheets included."""
        return self._structure.sheet_names

    @property
    def sha256(self) -> str:
        """SHA-256 of the file as it was opened."""
        return self._container.sha256

    @property
    def has_macros(self) -> bool:
        """Whether it is of the macro-enabled kind (.xlsm)."""
        return self._structure.has_macros

    @property
    def parts(self) -> list[str]:
        """Names of all parts of the package."""
        return self._container.names

    @cached_property
    def defined_names(self) -> dict[str, DefinedName]:
        """Defined names that hold for the whole workbook."""
        return {one.name: one for one in self._structure.names if not one.local_sheet}

    @property
    def local_names(self) -> dict[tuple[str, str], DefinedName]:
        """Defined names confined to a sheet, by sheet and name."""
        return {
            (one.local_sheet, one.name): one for one in self._structure.names if one.local_sheet
        }

    @cached_property
    def tables(self) -> dict[str, Table]:
        """All tables by name, with the size that they have now."""
        found: dict[str, Table] = {}
        for sheet in self.sheet_names:
            part = self._structure.worksheet_part(sheet)
            for related in self._structure.relationships(part) if part else ():
                if related.kind == "table":
                    root = self._container.tree(related.part)
                    table = parse_table(root, sheet, related.part)
                    if table.name.casefold() in {name.casefold() for name in found}:
                        raise WorkbookRefused(
                            "damaged",
                            f"{self.path.name} has two tables named {shown_name(table.name)}. Rename one of them.",
                        )
                    self._table_roots[related.part] = root
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
        if name in self.tables:
            return self.tables[name]
        for known, table in self.tables.items():
            if known.casefold() == name.casefold():
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
        by_folded = {known.casefold(): one for known, one in self.defined_names.items()}
        found = by_folded.get(name.casefold())
        if found is None or found.rect is None:
            what = "has no defined name" if found is None else "has no cells behind the name"
            raise WorkbookMismatch(
                f"{self.path.name} {what} {name!r}. Start from a new template or define it again."
            )
        return found

    # ---- reading -----------------------------------------------------------------------------------------------

    def value(self, sheet: str, cell: str) -> CellValue:
        """What a cell holds now; a formula with its cached value."""
        return self._sheet(sheet).value(*parse_cell(cell))

    def shown_value(self, sheet: str, cell: str) -> Constant:
        """The value that a cell shows now; of a formula its cached value."""
        return self._sheet(sheet).constant(*parse_cell(cell))

    # ---- writing -----------------------------------------------------------------------------------------------

    def set_cell(
        self,
        sheet: str,
        cell: str,
        value: Any,
        *,
        style_from: str | None = None,
        style_id: int | None = None,
        replace_formula: bool = False,
    ) -> None:
        """Write one cell.

        Parameters
        ----------
        sheet, cell : str
            Where, e.g. ``"Case"``, ``"B4"``.
        value : None, bool, int, float, str, ErrorValue or Formula
            None = blank, the style stays. Text is written as text, never as a formula.
        style_from : str, optional
            A cell of the same sheet whose style is taken.
        style_id : int, optional
            Style index; left out, the cell keeps its style, and a new cell takes that of its row or column.
        replace_formula : bool
            Whether a formula in that cell may be replaced by a value.

        Raises
        ------
        CellRefused
            When the cell may not be written or cannot hold the value.
        """
        part = self._sheet(sheet)
        row, column = parse_cell(cell)
        style = str(style_id) if style_id is not None else None
        if style_from is not None:
            style = part.style(*parse_cell(style_from)) or "0"
        held = cleaned(part.name, row, column, value)
        texts = part.set_cell(row, column, held, style=style, replace_formula=replace_formula)
        self.note_written(part.name, Rect(row, column, row, column), [[held]], texts)

    def set_name(self, name: str, value: Any, *, replace_formula: bool = False) -> None:
        """Write the cell that a defined name stands for."""
        target = self.name(name)
        assert target.sheet is not None
        assert target.rect is not None
        self.set_cell(
            target.sheet,
            cell_name(target.rect.top, target.rect.left),
            value,
            replace_formula=replace_formula,
        )

    def write_block(self, sheet: str, ref: str, rows: Sequence[Sequence[Any]]) -> None:
        """Write a block of cells of fixed capacity, blanking what is not used.

        Parameters
        ----------
        sheet : str
            Its sheet.
        ref : str
            The block, e.g. ``"B5:M2005"``; a single cell is the top left of a block just as large as the rows.
        rows : sequence of sequence
            Values; fewer rows and columns than the block has are blank.

        Raises
        ------
        CellRefused
            When the rows do not fit, or a merged range or an array formula reaches into the block.
        """
        part = self._sheet(sheet)
        rect = parse_range(ref)
        height, width = len(rows), max(map(len, rows), default=0)
        if rect.is_single:
            rect = Rect(
                rect.top, rect.left, rect.top + max(height, 1) - 1, rect.left + max(width, 1) - 1
            )
        if height > rect.height or width > rect.width:
            raise CellRefused(
                part.name,
                ref,
                f"takes {rect.height} rows and {rect.width} columns, {height} and {width} were given.",
            )
        blocked = part.merge_across(rect) or part.array_across(rect)
        if blocked is not None:
            raise CellRefused(
                part.name,
                str(blocked),
                f"is merged or an array formula and reaches into block {rect}.",
            )
        grid = []
        for number, row in enumerate(rows, rect.top):
            columns = range(rect.left, rect.left + len(row))
            held = cleaned_row(part.name, number, columns, row)
            grid.append(held + [None] * (rect.width - len(row)))
        styles = [part.style(rect.top, column) for column in range(rect.left, rect.right + 1)]
        texts = part.write_rows(rect, grid, styles=styles)
        self.note_written(part.name, rect, grid, texts)

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
        self._sheet(sheet).set_row_height(row, height)

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

    def retarget_chart_range(self, sheet: str, old: str, new: str) -> int:
        """Let ranges of charts and sparklines that covered exactly the rows of one block cover those of another.

        Touches the chart parts concerned, and sheets with such sparklines, and nothing else in them than the range
        texts; called by `write_tables`.
        """
        self._charts_current = False
        before, after = parse_range(old), parse_range(new)
        count = sum(chart.retarget(sheet, before, after) for chart in self._charts)
        for name in self._sheets_with_sparklines:
            count += self._sheet(name).retarget_sparklines(sheet, before, after)
        return count

    def link_chart_titles(self, links: Sequence[TitleLink]) -> int:
        """Link titles of charts that became fixed words to their cells again, after the cells were written.

        Parameters
        ----------
        links : sequence of TitleLink
            Cells of the titles, by the cells a chart draws; all other charts stay as they are.
        """

        def text(sheet: str, cell: str) -> str:
            return str(self.shown_value(sheet, cell) or "")

        return sum(chart.link_titles(links, self._areas, text) for chart in self._charts)

    def refresh_chart_caches(self) -> int:
        """Renew the values that charts carry of changed cells.

        Touches only chart parts with a range that reaches a changed cell, and in them only the caches; all other charts
        stay byte-identical. Called by `save`.
        """
        self._charts_current = True
        if not self._changed:
            return 0
        known: dict[tuple[str, str, tuple[Area, ...]], bytes] = {}
        return sum(
            chart.refresh(self._areas, self._is_new, self._shown, known) for chart in self._charts
        )

    def refresh_formula_caches(self) -> CacheReport:
        """Renew or remove the cached value of every formula that hangs on changed cells. Called by `save`."""
        if self._cache_report is None:
            self._cache_report = refresh_formula_caches(self)
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
        if self._structure.is_signed():
            raise WorkbookRefused(
                "signed",
                f"{self.path.name} carries a digital signature, which any change would make invalid. "
                "Save an unsigned copy and run on that.",
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
        if not self._charts_current:
            self.refresh_chart_caches()
        replaced, dropped = self._parts_to_write()
        notes = (*self.notes, *self._other_copies_of_values())
        return save_package(
            self._container,
            replaced,
            dropped,
            destination=Path(destination) if destination is not None else None,
            in_place=in_place,
            read_only=self._read_only,
            ignore_lock=self._ignore_lock,
            check=self._misread_cells,
            caches=report,
            notes=notes,
        )

    def chart_areas(self, text: str) -> list[Area] | None:
        """Sheets and cells of a chart's reference; None when it cannot be followed."""
        return self._areas(text)

    # ---- used by the modules of this package -------------------------------------------------------------------

    @property
    def structure(self) -> WorkbookPart:
        """Structure of the package."""
        return self._structure

    @property
    def container(self) -> Container:
        """The package as opened."""
        return self._container

    @property
    def changed(self) -> ChangedCells:
        """Cells whose values changed."""
        return self._changed

    @property
    def shown_rows(self) -> ChangedCells:
        """Rows that were hidden, and are not any more."""
        return self._shown_rows

    @property
    def written(self) -> Mapping[str, Sequence[Written]]:
        """Rectangles written so far, by sheet, in the order they were written."""
        return self._written

    def sheet_part(self, sheet: str) -> SheetPart:
        """Cells of a sheet."""
        return self._sheet(sheet)

    def is_loaded(self, sheet: str) -> bool:
        """Whether the cells of a sheet are parsed already."""
        return sheet in self._sheets

    def sheet_bytes(self, sheet: str) -> bytes:
        """Part of a sheet as opened; empty for chart sheets."""
        part = self._structure.worksheet_part(sheet)
        return self._container.read(part) if part else b""

    def is_owned_formula(self, sheet: str, row: int, column: int) -> bool:
        """Whether a formula was written here together with its value."""
        return (row, column) in self._given_formulas.get(sheet, ())

    def note_changed(self, sheet: str, rect: Rect) -> None:
        """Note changed values, so that charts renew their caches."""
        self._changed.add(sheet, rect)
        self._charts_current = False
        self._cache_report = None

    def changed_parts(self) -> dict[str, bytes]:
        """Sheet and table parts that differ from the file."""
        parts = {sheet.part: sheet.to_bytes() for sheet in self._sheets.values() if sheet.changed}
        return parts | self._changed_tables

    def note_written(
        self, sheet: str, rect: Rect, grid: Sequence[Sequence[CellValue]], texts: Sequence[str]
    ) -> None:
        """Note a rectangle that was written, to be found again when the file is checked."""
        self._written.setdefault(sheet, []).append(Written(rect, grid, texts))
        self._forget_formulas(sheet, rect)
        given = self._given_formulas.setdefault(sheet, set())
        for offset, row in enumerate(grid):
            if FORMULA_MARK in texts[offset]:
                for column, value in enumerate(row, rect.left):
                    if isinstance(value, Formula) and value.cached is not None:
                        given.add((rect.top + offset, column))
        self.note_changed(sheet, rect)

    def forget_written(self, sheet: str, rect: Rect) -> None:
        """Expect no longer to find what was written into rows that are given up now."""
        self._forget_formulas(sheet, rect)
        written = self._written.get(sheet, [])
        blank = [one for one in written if one.rect.meets(rect)]
        for one in blank:
            written.remove(one)

    def update_table(self, table: Table, formulas: Mapping[str, str]) -> None:
        """Put the size and the calculated columns of a table into its part."""
        root = self._table_roots[table.part]
        before = etree.tostring(root)
        if apply_table(root, table, formulas):
            for row in self._sheet(table.sheet).show_rows(table.data.top, table.data.bottom):
                self._shown_rows.add(table.sheet, Rect(row, 1, row, MAX_COLUMN))
            self.notes.append(
                f"The filter of table {table.name} was cleared, as it was set for the old rows."
            )
        if etree.tostring(root) != before:
            self._changed_tables[table.part] = serialise(root, self._container.read(table.part))
            self.tables[table.name] = parse_table(root, table.sheet, table.part)

    # ---- internals ---------------------------------------------------------------------------------------------

    def _sheet(self, name: str) -> SheetPart:
        if name not in self._sheets:
            known = {sheet.casefold(): sheet for sheet in self.sheet_names}
            sheet = known.get(name.casefold())
            if sheet is None:
                raise WorkbookMismatch(
                    f"{self.path.name} has no sheet {name!r}; it has {', '.join(self.sheet_names)}."
                )
            part = self._structure.worksheet_part(sheet)
            if part is None:
                raise WorkbookMismatch(
                    f"Sheet {sheet!r} of {self.path.name} is a chart sheet and has no cells."
                )
            if sheet not in self._sheets:
                self._sheets[sheet] = SheetPart(
                    sheet, part, self._container.charged(part), self._shared_string
                )
            return self._sheets[sheet]
        return self._sheets[name]

    @cached_property
    def _strings(self) -> list[str]:
        part = self._structure.related("sharedStrings")
        if part is None:
            return []
        root = self._container.tree(part)
        return [rich_text(entry) for entry in root.iterchildren(main("si"))]

    def _shared_string(self, index: str) -> str:
        number = whole_number(index.strip(), len(self._strings) - 1)
        if number is None:
            raise WorkbookRefused(
                "damaged",
                f"A cell of {self.path.name} shows text number {shown_name(index)}, but the workbook has "
                f"{len(self._strings)} texts. Open it in the spreadsheet program, let it repair the file, and save it "
                "again.",
            )
        return self._strings[number]

    @cached_property
    def _charts(self) -> list[ChartPart]:
        return [
            ChartPart(part, self._container.charged(part)) for part in self._structure.chart_parts()
        ]

    @cached_property
    def _sheets_with_sparklines(self) -> list[str]:
        return [name for name in self.sheet_names if b"sparkline>" in self.sheet_bytes(name)]

    def _areas(self, text: str) -> list[Area] | None:
        """Areas of a chart's reference; names of the workbook are followed."""
        areas: list[Area] = []
        for one in split_areas(text):
            sheet, rest = split_sheet(one)
            try:
                area = (sheet, parse_range(rest))
            except ValueError:
                named = self.local_names.get((sheet, rest)) or self.defined_names.get(rest)
                if named is None or named.sheet is None or named.rect is None:
                    return None
                area = (named.sheet, named.rect)
            if self._structure.sheet_names.count(area[0]) != 1:
                return None
            areas.append(area)
        return areas or None

    def _is_new(self, sheet: str, rect: Rect) -> bool:
        """Whether a chart draws otherwise there: it leaves out hidden rows."""
        return self._changed.touch(sheet, rect) or self._shown_rows.touch(sheet, rect)

    def _shown(self, sheet: str, rect: Rect) -> list[Constant]:
        return self._sheet(sheet).constants(rect)

    def _forget_formulas(self, sheet: str, rect: Rect) -> None:
        given = self._given_formulas.get(sheet, set())
        if rect.is_single:
            given.discard((rect.top, rect.left))
        else:
            given -= {place for place in given if rect.has(*place)}

    def _parts_to_write(self) -> tuple[dict[str, bytes], set[str]]:
        replaced = self.changed_parts()
        dropped: set[str] = set()
        if "_charts" in self.__dict__:
            replaced |= {chart.part: chart.to_bytes() for chart in self._charts if chart.changed}
        if any(sheet.formula_set_changed() for sheet in self._sheets.values()):
            chain, dropped = self._structure.without_calc_chain()
            replaced |= chain
        if self._changed:
            replaced[self._structure.part] = self._structure.with_full_calculation()
        same = [name for name, data in replaced.items() if data == self._container.read(name)]
        return {name: data for name, data in replaced.items() if name not in same}, dropped

    def _other_copies_of_values(self) -> Iterator[str]:
        """Notes on copies of cell values that are not renewed here."""
        if not self._changed:
            return
        if any(part.startswith("xl/pivotCache/") for part in self.parts):
            yield "Pivot tables show the values of the last time they were refreshed; refresh them in Excel."
        for part in self.parts:
            if part.startswith("xl/drawings/drawing") and self._has_stale_text(part):
                yield "Text boxes linked to cells show the new values only after the workbook was opened in Excel."
                return

    def _has_stale_text(self, part: str) -> bool:
        if b"textlink=" not in self._container.read(part):
            return False
        links = (
            shape.get("textlink")
            for shape in self._container.tree(part).iter()
            if shape.get("textlink")
        )
        areas = (self._areas(link) for link in links)
        return any(self._changed.touch(*area) for found in areas for area in found or ())

    def _misread_cells(self, parts: Mapping[str, bytes]) -> list[str]:
        """Cells that read back otherwise than written, from the parts as they stand in the new file."""
        wrong: list[str] = []
        for name, written in self._written.items():
            part = self._sheets[name].part
            data = parts.get(part) or self._container.read(part)
            if not all(one.stands_in(data) for one in written):
                # Prefixed names, cells written twice, renewed values: read these sheets cell by cell.
                again = SheetPart(name, part, data, self._shared_string)
                wrong += [f"{name}!{cell}" for cell in misread(again, written)]
        return wrong
