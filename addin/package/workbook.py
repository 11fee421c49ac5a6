"""The workbook as its callers see it: read values, write cells, tables and blocks, save.

Nothing touches the file before `Workbook.save`; until then all changes live in the parsed parts.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from math import isfinite
from pathlib import Path
from typing import Any

from lxml import etree

from .charts import Area, ChartPart
from .container import DEFAULT_LIMITS, Container, Limits
from .dependents import ChangedCells
from .errors import CellRefused, Obstacle, ObstaclesFound, WorkbookMismatch, WorkbookRefused
from .formulas import CacheReport, refresh_formula_caches
from .locks import check_not_open
from .references import MAX_ROW, Rect, cell_name, parse_cell, parse_range, split_areas, split_sheet
from .save import SaveReport, save_package
from .sheet_part import SheetPart
from .tables import Table, apply_table, parse_table
from .values import CellValue, Constant, Formula, clean, rich_text
from .workbook_part import DefinedName, WorkbookPart
from .xml_part import Element, main, parse_part, serialise


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

    Returns
    -------
    Workbook

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
    structure = WorkbookPart(container)
    if structure.is_signed() and not read_only:
        raise WorkbookRefused(
            "signed",
            f"{file.name} carries a digital signature, which any change would make invalid. "
            "Save an unsigned copy and run on that.",
        )
    return Workbook(container, structure, read_only=read_only, ignore_lock=ignore_lock)


@dataclass(frozen=True)
class TableData:
    """Rows for a table.

    Parameters
    ----------
    name : str
        The table.
    rows : sequence of sequence
        Values, aligned with ``columns``.
    columns : sequence of str, optional
        Columns that are written; the others stay the user's. Left out = all columns of the table in order.
    formulas : mapping of str to str
        Formula text of calculated columns. The row's value of such a column is the formula's cached value; for a column
        that is not among ``columns`` the value is recalculated.
    """

    name: str
    rows: Sequence[Sequence[Any]]
    columns: Sequence[str] | None = None
    formulas: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class _TablePlan:
    """A table with the cells to write: ``grid`` has a column for each of ``positions``."""

    old: Table
    new: Table
    positions: list[int]
    grid: list[list[CellValue]]
    formulas: dict[str, str]

    @property
    def growth(self) -> Rect | None:
        """Rows below the old table that the new one needs."""
        if self.new.ref.bottom <= self.old.ref.bottom:
            return None
        return self.new.ref._replace(top=self.old.ref.bottom + 1)

    def runs(self) -> Iterator[tuple[int, int, int]]:
        """Neighbouring positions: first grid column, first table column, count."""
        start = 0
        for index in range(1, len(self.positions) + 1):
            if (
                index == len(self.positions)
                or self.positions[index] != self.positions[index - 1] + 1
            ):
                yield start, self.positions[start], index - start
                start = index


@dataclass(frozen=True)
class _Written:
    """A written rectangle: its values and the XML of its rows."""

    rect: Rect
    grid: Sequence[Sequence[CellValue]]
    texts: Sequence[str]

    def stands_in(self, part: bytes) -> bool:
        """Whether the rows stand in the part as they were built, in their order."""
        position = 0
        for text in self.texts:
            position = part.find(text.encode(), position)
            if position < 0:
                return False
        return True

    def values(self) -> Iterator[tuple[tuple[int, int], CellValue]]:
        """Places and values of all cells, the blank ones below the rows given included."""
        blank = [None] * self.rect.width
        for offset in range(self.rect.height):
            row = self.grid[offset] if offset < len(self.grid) else blank
            for shift, value in enumerate(row):
                yield (self.rect.top + offset, self.rect.left + shift), value


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
        *,
        read_only: bool = False,
        ignore_lock: bool = False,
    ) -> None:
        self.path = container.path
        self.notes: list[str] = []
        self._container = container
        self._structure = structure
        self._read_only = read_only
        self._ignore_lock = ignore_lock
        self._sheets: dict[str, SheetPart] = {}
        self._table_roots: dict[str, Element] = {}
        self._changed_tables: dict[str, bytes] = {}
        self._changed = ChangedCells()
        self._written: dict[str, list[_Written]] = {}
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
        found = {}
        for sheet in self.sheet_names:
            part = self._structure.worksheet_part(sheet)
            for related in self._structure.relationships(part) if part else ():
                if related.kind == "table":
                    root = parse_part(self._container.read(related.part), related.part)
                    table = parse_table(root, sheet, related.part)
                    self._table_roots[related.part] = root
                    found[table.name] = table
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
        cleaned = self._cleaned(part.name, row, column, value)
        texts = part.set_cell(row, column, cleaned, style=style, replace_formula=replace_formula)
        self._note_written(part.name, Rect(row, column, row, column), [[cleaned]], texts)

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
            cleaned = self._cleaned_row(part.name, number, columns, row)
            grid.append(cleaned + [None] * (rect.width - len(row)))
        styles = [part.style(rect.top, column) for column in range(rect.left, rect.right + 1)]
        texts = part.write_rows(rect, grid, styles=styles)
        self._note_written(part.name, rect, grid, texts)

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
        plans = [self._plan(data) for data in tables]
        obstacles = [obstacle for plan in plans for obstacle in self._obstacles(plan)]
        if obstacles:
            raise ObstaclesFound(obstacles)
        for plan in plans:
            self._carry_out(plan)

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
        """What would be in the way if tables had these numbers of rows.

        Parameters
        ----------
        rows : mapping of str to int
            Number of rows by table name.
        """
        plans = []
        for name, count in rows.items():
            table = self.table(name)
            plans.append(_TablePlan(table, table.resized(count), [], [], {}))
        return [obstacle for plan in plans for obstacle in self._obstacles(plan)]

    # ---- caches and saving -------------------------------------------------------------------------------------

    def retarget_chart_range(self, sheet: str, old: str, new: str) -> int:
        """Let ranges of charts and sparklines that covered exactly the rows of one block cover those of another.

        Touches the chart parts concerned, and sheets with such sparklines, and nothing else in them than the range
        texts; called by `write_tables`.

        Parameters
        ----------
        sheet : str
            Sheet of the block.
        old, new : str
            The block before and after: same columns and first row.

        Returns
        -------
        int
            Number of ranges changed.
        """
        self._charts_current = False
        before, after = parse_range(old), parse_range(new)
        count = sum(chart.retarget(sheet, before, after) for chart in self._charts)
        for name in self.sheet_names:
            if b"sparkline>" in self.sheet_bytes(name):
                count += self._sheet(name).retarget_sparklines(sheet, before, after)
        return count

    def refresh_chart_caches(self) -> int:
        """Renew the values that charts carry of changed cells.

        Touches only chart parts with a range that reaches a changed cell, and in them only the caches; all other charts
        stay byte-identical. Called by `save`.

        Returns
        -------
        int
            Number of ranges renewed.
        """
        self._charts_current = True
        if not self._changed:
            return 0
        return sum(
            chart.refresh(self._areas, self._changed.touch, self._shown) for chart in self._charts
        )

    def refresh_formula_caches(self) -> CacheReport:
        """Renew or remove the cached value of every formula that hangs on changed cells. Called by `save`."""
        if self._cache_report is None:
            self._cache_report = refresh_formula_caches(self)
        return self._cache_report

    def save(self, destination: str | Path | None = None, *, in_place: bool = False) -> SaveReport:
        """Write the workbook, whole or not at all.

        Caches of formulas and charts are renewed first. The new file is written beside its place, read back, compared,
        and only then put there in one step; the original is read again before that, and if anything is wrong nothing
        has changed.

        Parameters
        ----------
        destination : str or Path, optional
            The new file; may be left out with ``in_place``.
        in_place : bool
            Replace the file that was opened; its old content stays as ``name.bak``.

        Returns
        -------
        SaveReport

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

    def changed_parts(self) -> dict[str, bytes]:
        """Sheet and table parts that differ from the file."""
        parts = {sheet.part: sheet.to_bytes() for sheet in self._sheets.values() if sheet.changed}
        return parts | self._changed_tables

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
                    sheet, part, self._container.read(part), self._shared_string
                )
            return self._sheets[sheet]
        return self._sheets[name]

    @cached_property
    def _strings(self) -> list[str]:
        part = self._structure.related("sharedStrings")
        if part is None:
            return []
        root = parse_part(self._container.read(part), part)
        return [rich_text(entry) for entry in root.iterchildren(main("si"))]

    def _shared_string(self, index: str) -> str:
        try:
            return self._strings[int(index)]
        except (ValueError, IndexError):
            return ""

    @cached_property
    def _charts(self) -> list[ChartPart]:
        return [
            ChartPart(part, self._container.read(part)) for part in self._structure.chart_parts()
        ]

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

    def _shown(self, sheet: str, row: int, column: int) -> Constant:
        return self._sheet(sheet).constant(row, column)

    def _cleaned(self, sheet: str, row: int, column: int, value: Any) -> CellValue:
        try:
            return clean(value)
        except (ValueError, TypeError) as problem:
            raise CellRefused(sheet, cell_name(row, column), f"{problem}.") from problem

    def _cleaned_row(
        self, sheet: str, number: int, columns: Sequence[int], row: Sequence[Any]
    ) -> list[CellValue]:
        try:
            # Most cells are numbers; asking for that here spares a call for each.
            return [
                value if type(value) is float and isfinite(value) else clean(value) for value in row
            ]
        except (ValueError, TypeError):
            # Once more with the place, for the message.
            return [
                self._cleaned(sheet, number, column, value)
                for column, value in zip(columns, row, strict=True)
            ]

    def _note_written(
        self, sheet: str, rect: Rect, grid: Sequence[Sequence[CellValue]], texts: Sequence[str]
    ) -> None:
        self._written.setdefault(sheet, []).append(_Written(rect, grid, texts))
        self._forget_formulas(sheet, rect)
        given = self._given_formulas.setdefault(sheet, set())
        for number, row in enumerate(grid, rect.top):
            for column, value in enumerate(row, rect.left):
                if type(value) is Formula and value.cached is not None:
                    given.add((number, column))
        self.note_changed(sheet, rect)
        self._cache_report = None

    def _plan(self, data: TableData) -> _TablePlan:
        table = self.table(data.name)
        names = list(data.columns) if data.columns is not None else list(table.columns)
        added = [
            name
            for name in data.formulas
            if name.casefold() not in {one.casefold() for one in names}
        ]
        for number, row in enumerate(data.rows, 1):
            if len(row) != len(names):
                raise WorkbookMismatch(
                    f"Row {number} for table {table.name} has {len(row)} values for {len(names)} columns."
                )
        sources = {table.column_index(name): source for source, name in enumerate(names + added)}
        if len(sources) != len(names) + len(added):
            raise WorkbookMismatch(
                f"Columns for table {table.name} are named twice: {', '.join(names)}."
            )
        new = table.resized(len(data.rows))
        if new.ref.bottom > MAX_ROW:
            raise WorkbookMismatch(
                f"Table {table.name} cannot have {len(data.rows)} rows: the sheet ends before."
            )
        columns = [table.data.left + table.column_index(name) for name in names]
        blanks: list[CellValue] = [None] * len(added)
        rows = [
            self._cleaned_row(table.sheet, number, columns, row) + blanks
            for number, row in enumerate(data.rows, new.data.top)
        ]
        positions = sorted(sources)
        order = [sources[position] for position in positions]
        texts = {table.column_index(name): text for name, text in data.formulas.items()}
        formulas = [(index, texts[one]) for index, one in enumerate(positions) if one in texts]
        grid = [_in_table_order(row, order, formulas) for row in rows]
        return _TablePlan(table, new, positions, grid, dict(data.formulas))

    def _obstacles(self, plan: _TablePlan) -> Iterator[Obstacle]:
        table, sheet = plan.old, self._sheet(plan.old.sheet)
        array = sheet.array_across(table.data)
        if array is not None:
            yield Obstacle(
                table.sheet, str(array), "an array formula that reaches into the table", table.name
            )
        for merge in sheet.merges:
            if merge.meets(plan.new.ref):
                yield Obstacle(table.sheet, str(merge), "a merged range", table.name)
        growth = plan.growth
        if growth is None:
            return
        others = [
            other
            for other in self.tables.values()
            if other.sheet == table.sheet and other.name != table.name and other.ref.meets(growth)
        ]
        for other in others:
            yield Obstacle(table.sheet, str(other.ref), f"table {other.name}", table.name)
        for rect in self._pivot_ranges(table.sheet):
            if rect.meets(growth):
                yield Obstacle(table.sheet, str(rect), "a pivot table", table.name)
        for row, column in sheet.filled_cells(growth):
            if not any(other.ref.has(row, column) for other in others):
                found = _in_words(sheet.value(row, column))
                yield Obstacle(table.sheet, cell_name(row, column), found, table.name)

    def _pivot_ranges(self, sheet: str) -> Iterator[Rect]:
        part = self._structure.worksheet_part(sheet)
        for related in self._structure.relationships(part) if part else ():
            if related.kind == "pivotTable":
                location = parse_part(self._container.read(related.part), related.part).find(
                    main("location")
                )
                if location is not None:
                    yield parse_range(location.get("ref"))

    def _carry_out(self, plan: _TablePlan) -> None:
        old, new = plan.old, plan.new
        sheet = self._sheet(old.sheet)
        styles = [
            sheet.style(old.data.top, column) for column in range(old.data.left, old.data.right + 1)
        ]
        if new.ref != old.ref and old.has_totals:
            sheet.move_row_cells(old.ref._replace(top=old.ref.bottom), new.ref.bottom)
        self._give_up_rows(plan)
        for first, position, count in plan.runs():
            left = new.data.left + position
            rect = Rect(new.data.top, left, new.data.bottom, left + count - 1)
            grid = [row[first : first + count] for row in plan.grid]
            texts = sheet.write_rows(rect, grid, styles=styles[position : position + count])
            self._note_written(old.sheet, rect, grid, texts)
        self._fill_user_formulas(plan, styles)
        self._update_table_part(plan)
        if new.ref != old.ref:
            sheet.resize_ranges(old.data, new.data)
            self.retarget_chart_range(old.sheet, str(old.data), str(new.data))
        self.note_changed(old.sheet, old.ref.join(new.ref)._replace(top=new.data.top))
        self._cache_report = None

    def _give_up_rows(self, plan: _TablePlan) -> None:
        """Remove the cells of rows that the table no longer has, but not what the user typed in other columns."""
        old, new = plan.old, plan.new
        if new.ref.bottom >= old.ref.bottom:
            return
        sheet = self._sheet(old.sheet)
        rows = old.ref._replace(top=new.ref.bottom + 1)
        self._forget_written(old.sheet, rows)
        written = set(plan.positions)
        for position in range(len(old.columns)):
            column = rows.left + position
            strip = rows._replace(left=column, right=column)
            kept = (
                []
                if position in written
                else [one for one in sheet.filled_cells(strip) if one not in sheet.formulas]
            )
            if not kept:
                sheet.remove_cells(strip)
                continue
            for row in range(strip.top, strip.bottom + 1):
                if (row, column) not in kept:
                    sheet.remove_cells(Rect(row, column, row, column))
            names = ", ".join(cell_name(*one) for one in kept)
            self.notes.append(
                f"Table {old.name} has fewer rows now; {old.sheet}!{names} below it, typed in column "
                f"{old.columns[position]}, was left where it is."
            )

    def _forget_formulas(self, sheet: str, rect: Rect) -> None:
        given = self._given_formulas.get(sheet, set())
        if rect.is_single:
            given.discard((rect.top, rect.left))
        else:
            given -= {place for place in given if rect.has(*place)}

    def _forget_written(self, sheet: str, rect: Rect) -> None:
        """Expect no longer to find what was written into rows that are given up now."""
        self._forget_formulas(sheet, rect)
        written = self._written.get(sheet, [])
        blank = [one for one in written if one.rect.meets(rect)]
        for one in blank:
            written.remove(one)

    def _fill_user_formulas(self, plan: _TablePlan, styles: Sequence[str | None]) -> None:
        """Continue calculated columns that are not ours into the rows that the table gained."""
        growth_top, bottom = plan.old.data.bottom + 1, plan.new.data.bottom
        if growth_top > bottom:
            return
        sheet = self._sheet(plan.new.sheet)
        for position, text in enumerate(plan.new.calculated):
            if position in plan.positions:
                continue
            column = plan.new.data.left + position
            rect = Rect(growth_top, column, bottom, column)
            value = Formula(text) if text else None
            sheet.write_rows(rect, [[value]] * rect.height, styles=[styles[position]])

    def _update_table_part(self, plan: _TablePlan) -> None:
        table = plan.new
        root = self._table_roots[table.part]
        before = etree.tostring(root)
        if apply_table(root, table, plan.formulas):
            self._sheet(table.sheet).show_rows(table.data.top, table.data.bottom)
            self.notes.append(
                f"The filter of table {table.name} was cleared, as it was set for the old rows."
            )
        if etree.tostring(root) != before:
            self._changed_tables[table.part] = serialise(root, self._container.read(table.part))
            self.tables[plan.old.name] = parse_table(root, table.sheet, table.part)

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
        data = self._container.read(part)
        if b"textlink=" not in data:
            return False
        links = (
            shape.get("textlink")
            for shape in parse_part(data, part).iter()
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
                wrong += [f"{name}!{cell}" for cell in _misread(again, written)]
        return wrong


def _in_table_order(
    row: Sequence[CellValue], order: Sequence[int], formulas: Sequence[tuple[int, str]]
) -> list[CellValue]:
    """Cells of a row as the table has its columns, values of calculated columns with their formula."""
    cells = [row[source] for source in order]
    for index, text in formulas:
        value = cells[index]
        if not isinstance(value, Formula):
            cells[index] = Formula(text, value)
    return cells


def _misread(sheet: SheetPart, written: Sequence[_Written]) -> Iterator[str]:
    last: dict[tuple[int, int], CellValue] = {}
    for one in written:
        last.update(one.values())
    for place, value in last.items():
        if not _same(sheet.value(*place), value):
            yield cell_name(*place)


def _same(read: CellValue, written: CellValue) -> bool:
    if isinstance(written, Formula) and isinstance(read, Formula) and written.cached is None:
        return read.text == written.text
    return read == written or (written == "" and read is None)


def _in_words(value: CellValue) -> str:
    if isinstance(value, Formula):
        return f"the formula ={value.text[:60]}"
    return f"the text {value[:60]!r}" if isinstance(value, str) else f"the value {value}"
