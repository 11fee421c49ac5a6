"""What the charts of a workbook draw against what would be drawn."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from addin.contract.chart_tables import CHART_TABLES, HISTORIES
from addin.verify.compare import is_rounding
from addin.verify.findings import Counts, Finding
from addin.xlsx import Table, TableData, Workbook
from addin.xlsx.references import cell_name

#: Wall times are drawn there.
_OWN_OF_EACH_RUN = frozenset({"ChartAccuracy"})
_OWN_LABELS = frozenset({"Accuracy title", "Accuracy axis"})


def drawn_elements(workbook: Workbook, names: Sequence[str]) -> list[str | None]:
    """The elements whose histories stand in the chart data."""
    labels = workbook.tables.get("ChartLabels")
    drawn: list[str | None] = [None] * HISTORIES
    if labels is None:
        return drawn
    for row in range(labels.data.top, labels.data.bottom + 1):
        key = str(workbook.shown_value(labels.sheet, cell_name(row, labels.ref.left)))
        text = str(workbook.shown_value(labels.sheet, cell_name(row, labels.ref.left + 1)))
        head, _, number = key.rpartition(" ")
        if head == "History title" and number.isdigit():
            drawn[int(number) - 1] = next(
                (n for n in sorted(names, key=len, reverse=True) if text.startswith(f"{n}: ")), None
            )
    return drawn


def compare_charts(
    workbook: Workbook, expected: Sequence[TableData], same_version: bool
) -> Iterator[tuple[Counts, Finding | None]]:
    """Compare the chart data, table by table."""
    wanted = {data.name: data for data in expected}
    for chart in CHART_TABLES:
        data, table = wanted.get(chart.name), workbook.tables.get(chart.name)
        if data is None or table is None:
            continue
        counts = Counts(chart.name, table.sheet)
        if chart.name in _OWN_OF_EACH_RUN:
            counts.not_compared = sum(v is not None for row in data.rows for v in row)
            yield counts, None
            continue
        wrong = _wrong_cells(workbook, table, data, counts)
        finding = None
        if wrong:
            values = f"{len(wrong)} of {sum(counts.of)} plotted values"
            sentence = f"{values} do not agree with the inputs"
            finding = Finding(
                "chart", table.sheet, wrong[0], sentence, chart.name, fails=same_version
            )
        yield counts, finding


def _wrong_cells(workbook: Workbook, table: Table, data: TableData, counts: Counts) -> list[str]:
    """Cells of a chart table that differ; rounding is none."""
    at = [table.ref.left + table.column_index(name) for name in data.columns or table.columns]
    wrong = []
    rows = max(len(data.rows), table.data.height)
    for k in range(rows):
        row: Sequence[Any] = data.rows[k] if k < len(data.rows) else ()
        if data.name == "ChartLabels" and row and row[0] in _OWN_LABELS:
            counts.not_compared += 1
            continue
        for position, column in enumerate(at):
            follows = row[position] if position < len(row) else None
            cell = cell_name(table.data.top + k, column)
            stands = workbook.shown_value(table.sheet, cell)
            if stands is None and (follows is None or follows == ""):
                continue
            if follows is not None and not isinstance(follows, bool | str):
                follows = float(follows)  # as a cell holds it
            if stands == follows:
                counts.of[0] += 1
            elif is_rounding(stands, follows):
                counts.of[1] += 1
            else:
                counts.of[3] += 1
                wrong.append(cell)
    return wrong
