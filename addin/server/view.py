"""What the page draws of a model: the charts of the workbook as columns, tables as cells.

The page gets the same numbers as the sheets, in the units shown there, and knows no physics.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

from addin.calculation.calculation import Calculation, RunView
from addin.charts.data import chart_blocks, history_between, history_names
from addin.charts.rows import plain
from addin.contract.chart_tables import CHART_TABLES
from addin.contract.charts import CHARTS, ChartSpec, Label, Words
from addin.contract.field import Pane
from addin.contract.palette import PALETTE
from addin.contract.tables import result_table
from addin.worksheet.answers import table_cells, units_of
from addin.worksheet.models import Model
from addin.worksheet.registry import FunctionError
from addin.writing.drawn_schematic import schematic_picture
from engine.errors import ModelError
from engine.results.tables import speed_tables
from engine.run import at_speed

#: Charts of the page, and tables under them.
PAGE_CHARTS = (
    "train",
    "torque",
    "speed-time",
    "interference",
    "air-gap",
    "clearing",
)
#: Width of the schematic; the page shows it larger or smaller. [pixel]
_SCHEMATIC_WIDTH = 920.0
_DATA = tuple(dict.fromkeys(series.table for name in PAGE_CHARTS for series in CHARTS[name].series))
SPEED_TABLES = ("NaturalFrequencies", "SeparationMargins", "SteadyState", "ModeShapes")
START_TABLES = (
    "Verdicts", "StartupPeaks", "AllowableStarts", "TorqueReversals", "EventPeaks", "AirGapTorque", "Effects",
)  # fmt: skip


@dataclass(frozen=True)
class HistoriesWanted:
    """Which histories a client asks for, and of which time."""

    elements: tuple[str, ...]  #: Names, in the order wanted.
    window: tuple[float, float]  #: Begin and end. [s]


def speed_view(model: Model) -> dict[str, Any]:
    """What can be shown at once: train, curves, frequencies, interference diagram.

    Parameters
    ----------
    model : Model
        The model.

    Returns
    -------
    dict
        Plain values. [shown units]

    Raises
    ------
    FunctionError
        If the train cannot be calculated.
    """
    try:
        results = at_speed(model.case)
    except ModelError as wrong:
        raise FunctionError(str(wrong), "#NUM!") from None
    view = RunView(case=model.case, tables=speed_tables(results), interference=results.interference)
    return _shown(model, view, SPEED_TABLES) | {"complete": False, "warnings": []}


def start_view(model: Model, calculation: Calculation) -> dict[str, Any]:
    """Everything, with the start.

    Parameters
    ----------
    model : Model
        The model.
    calculation : Calculation
        What was calculated of it. [SI]

    Returns
    -------
    dict
        Plain values. [shown units]
    """
    startup = calculation.startup or {}
    # the numbers may come from a case of equal numbers and another title
    view = replace(calculation.view, case=model.case)
    return _shown(model, view, (*SPEED_TABLES, *START_TABLES)) | {
        "complete": True,
        "outcome": calculation.outcome,
        "sentence": str(startup.get("sentence") or ""),
        "warnings": list(calculation.warnings),
        "histories": history_names(model.case, view),
    }


def histories_view(model: Model, calculation: Calculation, wanted: HistoriesWanted) -> list[Any]:
    """Histories in a window of time, with their limits.

    Parameters
    ----------
    model : Model
        The model.
    calculation : Calculation
        What was calculated of it. [SI]
    wanted : HistoriesWanted
        Elements and window.

    Returns
    -------
    list of dict
        Plain values; elements without a history are left out. [shown units]
    """
    view, units = calculation.view, units_of(model.system)
    there = [name for name in wanted.elements if name in (view.histories or {})]
    shown = []
    for name in there:
        drawn, limit = history_between(model.case, units, view, name, wanted.window)
        shown.append(
            {
                "element": name,
                "title": f"{name}: {drawn.words}",
                "axis": drawn.axis,
                "time": plain(drawn.time),
                "value": plain(drawn.value),
                "limit": None if limit is None else asdict(limit),
            }
        )
    return shown


def _shown(model: Model, view: RunView, tables: tuple[str, ...]) -> dict[str, Any]:
    units = units_of(model.system)
    blocks = chart_blocks(model.case, units, view)
    columns = {table.name: table.columns for table in CHART_TABLES}
    labels = {str(key): text for key, text in blocks["ChartLabels"]}
    picture = schematic_picture(model.case, _SCHEMATIC_WIDTH)
    return {
        "handle": model.handle,
        "units": model.system,
        "about": _about(model),
        "schematic": None if picture is None else asdict(picture),
        "labels": labels,
        "charts": {name: _columns(columns[name], blocks[name]) for name in _DATA},
        "drawn": [_spec(CHARTS[name], labels) for name in PAGE_CHARTS if name != "train"],
        "tables": {
            name: _table(name, view.tables.get(name) or (), model.system) for name in tables
        },
        # columns that the page leaves out: in the narrow pane of Office, and everywhere
        "left_out": {name: _left_out(name) for name in (*SPEED_TABLES, *START_TABLES)},
    }


def _spec(spec: ChartSpec, labels: Mapping[str, Any]) -> dict[str, Any]:
    """A chart as the page draws it: its words and colours, and the columns of its series."""

    def words(words: Words) -> str:
        return str(labels[words.key] or "").strip() if isinstance(words, Label) else str(words)

    return {
        "name": spec.name,
        "title": words(spec.title),
        "x": words(spec.x.title),
        "y": words(spec.y.title),
        "legend": spec.legend,
        "series": [
            {
                "table": series.table,
                "x": series.x,
                "y": series.y,
                "name": words(series.name),
                "colour": PALETTE.get(series.colour, series.colour),
                "ink": series.colour,
                "width": series.width,
                "dashed": series.dash == "dash",
                "row": series.row,
                "marked": bool(series.marker),
                "beside": series.name_beside,
                "values": bool(series.values_beside),
                "listed": series.in_legend,
            }
            for series in spec.series
        ],
    }


def _left_out(name: str) -> dict[str, list[str]]:
    """Columns of a table that the page leaves out, by where it does."""
    columns = result_table(name).columns
    return {
        str(pane): [column.name for column in columns if column.pane == pane]
        for pane in (Pane.MINOR, Pane.WORKBOOK)
    }


def _table(name: str, rows: Sequence[Mapping[str, Any]], system: str) -> list[list[Any]]:
    """Cells of a result table; of the mode shapes a column a mode."""
    if name != "ModeShapes":
        return table_cells(name, rows, system, True)
    keys = [key for key in rows[0] if key != "station"] if rows else []
    head = ["Station", *(key.replace("_", " ").capitalize() for key in keys)]
    return [head, *([row["station"], *(row[key] for key in keys)] for row in rows)]


def _columns(names: tuple[str, ...], rows: list[list[Any]]) -> dict[str, list[Any]]:
    """Columns by name, without the blanks at their ends."""
    columns: dict[str, list[Any]] = {}
    for name, values in zip(names, map(list, zip(*rows, strict=True)), strict=True):
        while values and values[-1] is None:
            values.pop()
        columns[name] = values
    return columns


def _about(model: Model) -> Mapping[str, str]:
    """The title block."""
    names = ("title", "tag", "client", "document", "revision", "prepared_by", "checked_by")
    return {name: str(value) for name in names if (value := getattr(model.case, name, None))}
