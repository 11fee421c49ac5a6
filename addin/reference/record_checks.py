"""What records say of each other: names that they refer to are there. Run first by ``make generated``."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping

from addin.contract.chart_tables import CHART_TABLES
from addin.contract.charts import ChartSpec
from addin.contract.field import IncompleteRecord, TableSpec
from addin.contract.palette import PALETTE, SPEED_GROUPS
from addin.contract.scalars import SCALARS
from addin.contract.sheet import Sheet
from addin.contract.sheets import SHEETS
from addin.contract.studies.registry import EVERY_CHART, STUDIES, with_studies
from addin.contract.tables import EVERY_INPUT, EVERY_TABLE
from addin.studies.registry import every_study

_CELL = re.compile(r"[A-Z]{1,3}[1-9][0-9]*")
#: A colour of its own, none, or that of the discs or shafts of a speed group.
_COLOUR = re.compile(rf"#[0-9A-Fa-f]{{6}}|none|(disc|shaft) [1-{len(SPEED_GROUPS)}]")


def check_records() -> None:
    """Refuse records of which one names what another lacks.

    Raises
    ------
    IncompleteRecord
        For the first: what is missing, and where to add it.
    """
    every_study()
    inputs = {spec.name for spec in EVERY_INPUT}
    for study in STUDIES:
        for name in study.reads:
            if name not in inputs:
                raise IncompleteRecord(
                    f"study {study.key} reads the table {name}, which is no input table: correct its "
                    f"`reads` in addin/contract/studies/{study.key}.py"
                )
    check_traces(EVERY_TABLE)
    check_sheets(with_studies(SHEETS))
    columns = {
        spec.name: {field.name for field in (*spec.workbook_columns, *spec.extra_columns)}
        for spec in EVERY_TABLE
    }
    columns |= {spec.name: set(spec.columns) for spec in CHART_TABLES}
    for chart in EVERY_CHART.values():
        check_chart(chart, columns)


def check_traces(tables: Iterable[TableSpec]) -> None:
    """Refuse a trace to an input or result that no record describes."""
    known = {field.name for field in SCALARS}
    known |= {f"{spec.name}.{field.name}" for spec in tables for field in spec.every_column}
    for spec in tables:
        for field in spec.every_column:
            for name in () if field.trace is None else field.trace.inputs:
                if name not in known:
                    raise IncompleteRecord(
                        f"column {field.name} of table {spec.name} is traced to {name}, which is no "
                        "input and no result: correct its of_row or of_case"
                    )


def check_sheets(sheets: Iterable[Sheet]) -> None:
    """Refuse a chart that nobody has described, and a place that is no cell."""
    for sheet in sheets:
        for chart in sheet.charts:
            if chart.name not in EVERY_CHART:
                raise IncompleteRecord(
                    f"sheet {sheet.name} shows the chart {chart.name}, which is not described: add a "
                    "ChartSpec of that name, or correct the name"
                )
        places = [*sheet.tables.items(), *((chart.name, chart.cell) for chart in sheet.charts)]
        for name, cell in places:
            if not _CELL.fullmatch(cell):
                raise IncompleteRecord(
                    f"{name} is placed at '{cell}' of sheet {sheet.name}: give a cell such as B12"
                )


def check_chart(chart: ChartSpec, columns: Mapping[str, set[str]]) -> None:
    """Refuse a chart of data or colours that are not there; `columns` are those of each table."""
    for series in chart.series:
        for column in (series.x, series.y):
            if column not in columns.get(series.table, ()):
                raise IncompleteRecord(
                    f"chart {chart.name} draws column {column} of table {series.table}, which is not "
                    "there: correct its series"
                )
        for colour in filter(None, (series.colour, series.edge)):
            if colour not in PALETTE and not _COLOUR.fullmatch(colour):
                raise IncompleteRecord(
                    f"chart {chart.name} has the unknown colour '{colour}': choose one of "
                    f"{', '.join(PALETTE)}, or #RRGGBB"
                )
