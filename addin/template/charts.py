"""Draws the charts of `addin.contract.charts` with XlsxWriter.

A chart refers to whole columns of Excel tables and, for words that only a calculation knows, to
cells of `ChartLabels`; the writer renews those, so that the charts need no macro and no formula.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from addin.contract.chart_tables import LABELS
from addin.contract.charts import Axis, ChartSpec, FirstCell, Label, Series, Words
from addin.contract.palette import PALETTE, SPEED_GROUPS
from addin.template.styles import FONT

_GRID = {"visible": True, "line": {"color": "#E3E3E3", "width": 0.5}}
_AXIS_LINE = {"color": "#8C8C8C", "width": 0.75}
#: Kind of a chart → type and subtype of XlsxWriter.
_KINDS: Mapping[str, dict[str, str]] = {
    "curves": {"type": "scatter", "subtype": "straight"},
    "marked curves": {"type": "scatter", "subtype": "straight_with_markers"},
    "points": {"type": "scatter"},
    "lines": {"type": "line"},
    "columns": {"type": "column"},
    "bars": {"type": "bar"},
    "train": {"type": "column", "subtype": "stacked"},
}
#: Height of the letters of a chart: 8 pt where its sheet is printed at 70 %; that of titles. [pt]
_LETTERS, _TITLE = 11.5, 12.0
#: A chart wider than this and lower than that has its legend at its side. [pixel]
_WIDE, _LOW = 500, 200
_COLUMNS = ("columns", "bars", "train")


@dataclass(frozen=True)
class Place:
    """Where the data rows of a table stand; rows and columns count from 0."""

    sheet: str  #: Sheet.
    first: int  #: First data row.
    last: int  #: Last data row.
    columns: Mapping[str, int]  #: Column of each header.


class Places:
    """References into tables, in the form XlsxWriter takes."""

    def __init__(self, tables: Mapping[str, Place]) -> None:
        self._tables = tables

    def column(self, table: str, column: str) -> list[Any]:
        """All data rows of a column."""
        place = self._tables[table]
        at = place.columns[column]
        return [place.sheet, place.first, at, place.last, at]

    def cell(self, table: str, column: str, row: int) -> list[Any]:
        """One data row of a column, counted from 0."""
        place = self._tables[table]
        at = place.columns[column]
        return [place.sheet, place.first + row, at, place.first + row, at]

    def words(self, words: Words) -> str | list[Any]:
        """Fixed words, or the cell that holds them."""
        if isinstance(words, Label):
            place = self._tables["ChartLabels"]
            return f"={place.sheet}!$B${place.first + LABELS.index(words.key) + 1}"
        if isinstance(words, FirstCell):
            return self.cell(words.table, words.column, 0)[:3]
        return words


def make_chart(workbook: Any, places: Places, spec: ChartSpec, size: tuple[int, int]) -> Any:
    """A chart, not yet inserted.

    Parameters
    ----------
    workbook : xlsxwriter.Workbook
        The workbook under construction.
    places : Places
        Where its data stand.
    spec : ChartSpec
        What is drawn.
    size : tuple of int
        Width and height. [pixel]

    Returns
    -------
    xlsxwriter.chart.Chart
        The chart.
    """
    chart = workbook.add_chart(_KINDS[spec.kind])
    for series in spec.series:
        chart.add_series(_series(places, spec, series))
    if spec.high_low:
        chart.set_high_low_lines({"line": {"color": PALETTE["steel"], "width": 1.25}})
    if spec.kind == "train":
        _centre_line(chart, spec)
    else:
        title = {"name": places.words(spec.title), "overlay": False}
        chart.set_title(title | {"name_font": _font(_TITLE, bold=True, color=PALETTE["navy"])})
        chart.set_x_axis(_axis(places, spec.x))
        chart.set_y_axis(_axis(places, spec.y))
        frame = {"color": "#B0B0B0", "width": 0.5}
        chart.set_plotarea({"fill": {"color": "white"}, "border": frame})
    if spec.second is not None:
        chart.set_y2_axis(_axis(places, spec.second))
    if spec.legend:
        without = [k for k, series in enumerate(spec.series) if not series.in_legend]
        beside = (
            size[0] > _WIDE and size[1] < _LOW
        )  # below it, the legend would leave no height for the curves
        place = "right" if beside else "bottom"
        chart.set_legend({"position": place, "font": _font(_LETTERS), "delete_series": without})
    else:
        chart.set_legend({"none": True})
    chart.set_size({"width": size[0], "height": size[1]})
    chart.set_chartarea({"border": {"color": "#D0D0D0", "width": 0.75}, "fill": {"color": "white"}})
    return chart


def _centre_line(chart: Any, spec: ChartSpec) -> None:
    """The train has no title and no numbers, and a centre line for its axis."""
    _, rotation = spec.x.names or (8.0, 0)
    chart.set_x_axis(
        {
            "label_position": "low",
            "num_font": _font(_LETTERS, rotation=rotation),
            "line": {"color": "#404040", "width": 0.75, "dash_type": "long_dash_dot"},
            "major_tick_mark": "none",
            "minor_tick_mark": "none",
            "interval_unit": 1,
        }
    )
    ends = {"min": spec.y.least, "max": spec.y.largest}
    chart.set_y_axis({"visible": False, "major_gridlines": {"visible": False}, **ends})
    chart.set_title({"none": True})


def _colour(word: str) -> str:
    """A word of the palette, ``disc 2`` or ``shaft 2`` of the speed groups, or ``#RRGGBB``."""
    kind, _, group = word.partition(" ")
    if kind in ("disc", "shaft"):
        return SPEED_GROUPS[int(group) - 1][kind == "shaft"]
    return PALETTE.get(word, word)


def _font(size: float, **more: Any) -> dict[str, Any]:
    """The font of words on a chart; its height in points."""
    return {"name": FONT, "size": size, "bold": False, "color": "#404040", **more}


def _axis(places: Places, axis: Axis) -> dict[str, Any]:
    """An axis with its name, thin grid and small numbers."""
    made: dict[str, Any] = {
        "name": places.words(axis.title),
        "name_font": _font(_LETTERS),
        "num_font": _font(_LETTERS),
        "line": _AXIS_LINE,
        "major_gridlines": _GRID if axis.grid else {"visible": False},
        "major_tick_mark": "outside" if axis.ticks else "none",
        "minor_tick_mark": "none",
    }
    for option, value in (
        ("min", axis.least),
        ("max", axis.largest),
        ("major_unit", axis.step),
        ("log_base", 10 if axis.log else None),
        ("num_format", axis.number or None),
        ("crossing", axis.crossing),
        ("label_position", "low" if axis.low else None),
        ("reverse", axis.reverse or None),
    ):
        if value is not None:
            made[option] = value
    if axis.names is not None:
        made["num_font"] = _font(_LETTERS, rotation=axis.names[1])
    return made


def _series(places: Places, spec: ChartSpec, series: Series) -> dict[str, Any]:
    colour = _colour(series.colour)
    at = places.column if series.row is None else places.cell
    row = () if series.row is None else (series.row,)
    made: dict[str, Any] = {
        "name": places.words(series.name),
        "categories": at(series.table, series.x, *row),
        "values": at(series.table, series.y, *row),
    }
    if spec.kind in _COLUMNS:
        return made | _column_style(spec, series, colour)
    made["line"] = {"none": True}
    if series.width:
        made["line"] = {"color": colour, "width": series.width, "dash_type": series.dash}
    made["marker"] = {"type": "none"}
    if series.marker:
        inks = {"fill": {"color": colour}, "border": {"color": "white"}}
        made["marker"] = {"type": series.marker, "size": series.size, **inks}
    if series.second_axis:
        made["y2_axis"] = True
    ink = {"font": _font(_LETTERS, color=colour)}
    if series.name_beside:
        named = {"series_name": True, "value": False, "position": series.name_beside}
        made["data_labels"] = named | ink
    elif series.values_beside:
        valued = {"value": True, "position": "right", "num_format": series.values_beside}
        made["data_labels"] = valued | ink
    return made


def _column_style(spec: ChartSpec, series: Series, colour: str) -> dict[str, Any]:
    made: dict[str, Any] = {"fill": {"color": colour}}
    if series.edge == "none":
        made["border"] = {"none": True}
    elif series.edge:
        made["border"] = {"color": series.edge, "width": 0.5}
    if spec.gap is not None:
        made["gap"] = spec.gap
    if spec.overlap is not None:
        made["overlap"] = spec.overlap
    return made
