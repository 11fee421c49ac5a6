"""Writing tables: what a table needs, what is in the way, and carrying it out.

A plan is made for each table first, so that nothing is written when any of them has no room.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from addin.xlsx.errors import CellRefused, Obstacle, WorkbookMismatch
from addin.xlsx.references import MAX_ROW, Rect, cell_name
from addin.xlsx.sheet_ranges import read_range
from addin.xlsx.state import WorkbookState
from addin.xlsx.tables import Table
from addin.xlsx.values import CellValue, Formula
from addin.xlsx.written import cleaned_row
from addin.xlsx.xml_part import main


@dataclass(frozen=True)
class TableData:
    """Rows for a table."""

    name: str  #: The table.
    rows: Sequence[Sequence[Any]]  #: Values, aligned with ``columns``.
    #: Columns that are written; the others stay the user's. Left out = all columns of the table in
    #: order.
    columns: Sequence[str] | None = None
    #: Formula text of calculated columns, which are not among ``columns``; their values are
    #: recalculated.
    formulas: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class TablePlan:
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


def plan_table(workbook: WorkbookState, data: TableData) -> TablePlan:
    """What writing a table comes to.

    Raises
    ------
    WorkbookMismatch
        When the rows do not fit the columns, or the table or a column is not there.
    """
    table = workbook.table(data.name)
    names = list(data.columns) if data.columns is not None else list(table.columns)
    for number, row in enumerate(data.rows, 1):
        if len(row) != len(names):
            raise WorkbookMismatch(
                f"Row {number} for table {table.name} has {len(row)} values for {len(names)} columns."
            )
    written = [*names, *data.formulas]
    sources = {table.column_index(name): source for source, name in enumerate(written)}
    if len(sources) != len(written):
        raise WorkbookMismatch(
            f"Columns for table {table.name} are named twice: {', '.join(names)}."
        )
    new = table.resized(len(data.rows))
    if new.ref.bottom > MAX_ROW:
        raise WorkbookMismatch(
            f"Table {table.name} cannot have {len(data.rows)} rows: they exceed the sheet. Move "
            "the table up."
        )
    columns = [table.data.left + table.column_index(name) for name in names]
    formulas = [Formula(text) for text in data.formulas.values()]
    rows = [
        [*cleaned_row(table.sheet, number, columns, row), *formulas]
        for number, row in enumerate(data.rows, new.data.top)
    ]
    positions = sorted(sources)
    order = [sources[position] for position in positions]
    if order != sorted(order):
        rows = [[row[source] for source in order] for row in rows]
    return TablePlan(table, new, positions, rows, dict(data.formulas))


def obstacles_of(workbook: WorkbookState, plan: TablePlan) -> Iterator[Obstacle]:
    """What is in the way of a table."""
    table, sheet = plan.old, workbook.sheet_part(plan.old.sheet)
    array = sheet.array_across(table.data)
    if array is not None:
        yield Obstacle(
            table.sheet, str(array), "an array formula that reaches into the table", table.name
        )
    for merge in sheet.merges:
        if merge.meets(plan.new.ref):
            yield Obstacle(table.sheet, str(merge), "a merged range", table.name)
    yield from _typed_where_totals_go(workbook, plan)
    growth = plan.growth
    if growth is None:
        return
    others = [
        other
        for other in workbook.tables.values()
        if other.sheet == table.sheet and other.name != table.name and other.ref.meets(growth)
    ]
    for other in others:
        yield Obstacle(table.sheet, str(other.ref), f"table {other.name}", table.name)
    for rect in _pivot_ranges(workbook, table.sheet):
        if rect.meets(growth):
            yield Obstacle(table.sheet, str(rect), "a pivot table", table.name)
    for row, column in sheet.filled_cells(growth):
        if not any(other.ref.has(row, column) for other in others):
            found = _in_words(sheet.value(row, column))
            yield Obstacle(table.sheet, cell_name(row, column), found, table.name)


def _typed_where_totals_go(workbook: WorkbookState, plan: TablePlan) -> Iterator[Obstacle]:
    """What the user typed in columns of his own, in the row to which the totals row of a shrinking table moves."""
    old, new = plan.old, plan.new
    if not old.has_totals or new.ref.bottom >= old.ref.bottom:
        return
    sheet = workbook.sheet_part(old.sheet)
    for row, column in sheet.filled_cells(
        old.ref._replace(top=new.ref.bottom, bottom=new.ref.bottom)
    ):
        if column - old.ref.left not in plan.positions and (row, column) not in sheet.formulas:
            found = _in_words(sheet.value(row, column))
            yield Obstacle(old.sheet, cell_name(row, column), found, old.name)


def _pivot_ranges(workbook: WorkbookState, sheet: str) -> Iterator[Rect]:
    part = workbook.structure.worksheet_part(sheet)
    for related in workbook.structure.relationships(part) if part else ():
        if related.kind == "pivotTable":
            location = workbook.container.tree(related.part).find(main("location"))
            if location is not None:
                yield read_range(location.get("ref", ""), f"A pivot table on sheet {sheet}")


def carry_out(workbook: WorkbookState, plan: TablePlan) -> None:
    """Write the cells of a table and let everything that belongs to it follow."""
    old, new = plan.old, plan.new
    sheet = workbook.sheet_part(old.sheet)
    styles = sheet.row_styles(old.data)
    if new.ref != old.ref and old.has_totals:
        sheet.move_row_cells(old.ref._replace(top=old.ref.bottom), new.ref.bottom)
    _give_up_rows(workbook, plan)
    for first, position, count in plan.runs():
        left = new.data.left + position
        rect = Rect(new.data.top, left, new.data.bottom, left + count - 1)
        grid = plan.grid
        if count < len(plan.positions):
            grid = [row[first : first + count] for row in plan.grid]
        texts = sheet.write_rows(rect, grid, styles=styles[position : position + count])
        workbook.note_written(old.sheet, rect, grid, texts)
    _fill_user_formulas(workbook, plan, styles)
    workbook.update_table(new, plan.formulas)
    if new.ref != old.ref:
        sheet.resize_ranges(old.data, new.data)
        workbook.retarget_chart_range(old.sheet, old.data, new.data)
    workbook.note_changed(old.sheet, old.ref.join(new.ref)._replace(top=new.data.top))


def _give_up_rows(workbook: WorkbookState, plan: TablePlan) -> None:
    """Remove the cells of rows that the table no longer has, but not what the user typed in other columns."""
    old, new = plan.old, plan.new
    if new.ref.bottom >= old.ref.bottom:
        return
    sheet = workbook.sheet_part(old.sheet)
    rows = old.ref._replace(top=new.ref.bottom + 1)
    workbook.forget_written(old.sheet, rows)
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
        for row, _ in list(sheet.cells_in(strip)):
            if (row, column) not in kept:
                sheet.remove_cells(Rect(row, column, row, column))
        names = ", ".join(cell_name(*one) for one in kept)
        workbook.notes.append(
            f"Table {old.name} has fewer rows now; the content typed below it at {old.sheet}!{names}, "
            f"in column {old.columns[position]}, was not moved."
        )


def _fill_user_formulas(
    workbook: WorkbookState, plan: TablePlan, styles: Sequence[str | None]
) -> None:
    """Continue calculated columns that are not ours into the rows that the table gained."""
    growth_top, bottom = plan.old.data.bottom + 1, plan.new.data.bottom
    if growth_top > bottom:
        return
    sheet = workbook.sheet_part(plan.new.sheet)
    for position, text in enumerate(plan.new.calculated):
        if position in plan.positions:
            continue
        column = plan.new.data.left + position
        rect = Rect(growth_top, column, bottom, column)
        try:
            value = Formula(text) if text else None
        except ValueError as problem:
            raise CellRefused(
                plan.new.sheet,
                str(rect),
                "cannot be filled with the formula of its column. Correct it.",
            ) from problem
        sheet.write_rows(rect, [[value]] * rect.height, styles=[styles[position]])


def _in_words(value: CellValue) -> str:
    if isinstance(value, Formula):
        return f"the formula ={value.text[:60]}"
    return f"the text {value[:60]!r}" if isinstance(value, str) else f"the value {value}"
