"""What a calculated workbook prints: the parts of its sheets that have something to show."""

from __future__ import annotations

from collections.abc import Mapping

from addin.contract.chart_tables import CHART_TABLES
from addin.contract.charts import ChartSpec
from addin.contract.print_areas import (
    Standing,
    areas_of_parts,
    columns_of_areas,
    holds_data,
    print_area_text,
)
from addin.contract.sheets import SHEETS
from addin.contract.studies.registry import EVERY_CHART, STUDY_SHEETS
from addin.contract.tables import EVERY_INPUT
from addin.xlsx import Formula, Workbook
from addin.xlsx.references import Rect, parse_range, split_areas, split_sheet

_CHART_TABLES = frozenset(table.name for table in CHART_TABLES)
_INPUTS = frozenset(spec.name for spec in EVERY_INPUT)
_NAME = "_xlnm.Print_Area"
#: The area of a sheet of which nothing is printed.
_NOTHING = Rect(1, 1, 1, 1)


def renew_print_areas(workbook: Workbook, printed: Mapping[str, int], only: str = "") -> None:
    """Let the sheets print what they show now, where nobody has chosen other print areas.

    Parameters
    ----------
    workbook : Workbook
        With its results written. A sheet whose print area is not one that torsionbook has made, or whose tables
        the engineer has moved apart, prints as before.
    printed : mapping of str to int
        Tables of which only so many of the first rows are printed. [count]
    only : str
        The sheet, as it is shipped, that is looked at; empty = each of a case. [name]
    """
    for name in (only,) if only else dict.fromkeys(part.worksheet for part in SHEETS):
        parts = [part for part in (*SHEETS, *STUDY_SHEETS) if part.worksheet == name]
        here = {
            workbook.tables[table].sheet
            for part in parts
            for table in part.tables
            if table in workbook.tables
        }
        if len(here) != 1:
            continue
        [sheet] = here
        ours = columns_of_areas(parts)
        if not _is_ours(workbook, sheet, ours):
            continue
        areas = areas_of_parts(parts, lambda part: _standing(workbook, part.columns, printed))
        if areas is not None:
            workbook.set_print_area(sheet, print_area_text(sheet, areas))


def _is_ours(workbook: Workbook, sheet: str, ours: set[tuple[int, int]]) -> bool:
    """Whether torsionbook has chosen what a sheet prints."""
    named = workbook.local_names.get((sheet, _NAME))
    if named is None:
        return False
    for area in split_areas(named.text):
        try:
            rect = parse_range(split_sheet(area)[1])
        except ValueError:
            return False
        if rect != _NOTHING and (rect.left, rect.right) not in ours:
            return False
    return True


def _standing(workbook: Workbook, columns: tuple[int, int], printed: Mapping[str, int]) -> Standing:
    """What stands in a workbook, as far as it is about a part in some columns."""

    def rows(name: str) -> tuple[int, int] | None:
        table = workbook.tables.get(name)
        if table is None or not columns[0] <= table.ref.left <= columns[1]:
            return None
        count = printed.get(name) or table.data.height
        return table.ref.top, min(table.ref.bottom, table.ref.top + count)

    def has_content(name: str) -> bool:
        table = workbook.tables.get(name)
        if table is None:
            return False
        part = workbook.sheet_part(table.sheet)
        written = part.as_written(table.data)
        if name in _CHART_TABLES:
            return holds_data(written or ()) or holds_data([part.constants(table.data)])
        if written is not None:
            return any(
                not (value is None or isinstance(value, Formula))
                for row in written
                for value in row
            )
        return any(at not in part.formulas for at in part.filled_cells(table.data))

    def filled_to(name: str) -> int:
        table = workbook.tables.get(name)
        if table is None:
            return 0
        return max(
            (row for row, _ in workbook.sheet_part(table.sheet).filled_cells(table.data)), default=0
        )

    return Standing(
        rows, filled_to, has_content, lambda name: has_curve(workbook, EVERY_CHART[name])
    )


def has_curve(workbook: Workbook, chart: ChartSpec) -> bool:
    """Whether a chart has a number to draw."""
    return any(_has_number(workbook, series.table, series.y) for series in chart.series)


def _has_number(workbook: Workbook, name: str, column: str) -> bool:
    table = workbook.tables.get(name)
    if table is None or column not in table.columns:
        return False
    at, data = table.column_index(column), table.data
    part = workbook.sheet_part(table.sheet)
    written = part.as_written(data)
    if written is not None:
        return any(isinstance(row[at], int | float) for row in written)
    left = data.left + at
    return holds_data([part.constants(Rect(data.top, left, data.bottom, left))])


def hide_empty_charts(
    workbook: Workbook, charts: Mapping[str, ChartSpec], *, is_form: bool = False
) -> None:
    """Hide the charts that have nothing to draw, and show the others.

    Parameters
    ----------
    workbook : Workbook
        With its results written. Charts are known by their description; those of the engineer stay as they are.
    charts : mapping of str to ChartSpec
        The charts in question, by name.
    is_form : bool
        Whether inputs are still to be typed: charts of them alone are drawn as they are typed. [flag]
    """
    workbook.hide_objects(
        {
            name: not ((is_form and _is_of_inputs(spec)) or has_curve(workbook, spec))
            for name, spec in charts.items()
        }
    )


def _is_of_inputs(chart: ChartSpec) -> bool:
    return {series.table for series in chart.series} <= _INPUTS
