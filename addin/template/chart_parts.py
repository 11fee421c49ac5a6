"""What every chart is made of: places of tables, axes, titles, lines."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from addin.contract.chart_tables import LABELS
from addin.template.styles import FONT, PALETTE

__all__ = ["Place", "Places", "axis", "dot", "font", "legend", "line", "title", "xy"]

_GRID = {"visible": True, "line": {"color": "#E3E3E3", "width": 0.5}}
_AXIS_LINE = {"color": "#8C8C8C", "width": 0.75}


@dataclass(frozen=True)
class Place:
    """Where the data rows of a table stand; rows and columns count from 0."""

    sheet: str  #: Sheet.
    first: int  #: First and last data row.
    last: int  #: Likewise.
    columns: Mapping[str, int]  #: Column of each header.


class Places:
    """References into tables, in the form XlsxWriter takes.

    Parameters
    ----------
    tables : mapping of str to Place
        Tables by name.
    """

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

    def label(self, key: str) -> str:
        """The cell of a word that only a calculation knows, as a formula."""
        place = self._tables["ChartLabels"]
        row = place.first + LABELS.index(key) + 1
        return f"={place.sheet}!$B${row}"


def font(size: float, **more: Any) -> dict[str, Any]:
    """The font of words on a chart.

    Parameters
    ----------
    size : float
        Height. [pt]
    **more : object
        Further options of XlsxWriter.

    Returns
    -------
    dict
    """
    return {"name": FONT, "size": size, "bold": False, "color": "#404040", **more}


def title(chart: Any, name: str) -> None:
    """Give a chart its title."""
    chart.set_title(
        {"name": name, "name_font": font(10, bold=True, color=PALETTE["navy"]), "overlay": False}
    )


def axis(name: str, **more: Any) -> dict[str, Any]:
    """An axis with its name, thin grid and small numbers."""
    return {
        "name": name,
        "name_font": font(9),
        "num_font": font(8),
        "line": _AXIS_LINE,
        "major_gridlines": _GRID,
        "major_tick_mark": "outside",
        "minor_tick_mark": "none",
        **more,
    }


def legend(chart: Any, without: tuple[int, ...] = ()) -> None:
    """A legend below the chart."""
    chart.set_legend({"position": "bottom", "font": font(8), "delete_series": list(without)})


def line(colour: str, width: float = 1.75, dash: str = "solid") -> dict[str, Any]:
    """How a line is drawn.

    Parameters
    ----------
    colour : str
        Of `PALETTE`, or ``#RRGGBB``. [name]
    width : float
        [pt]
    dash : str
        Kind of dashes. [word]

    Returns
    -------
    dict
    """
    return {"color": PALETTE.get(colour, colour), "width": width, "dash_type": dash}


def dot(colour: str, kind: str = "circle", size: int = 5) -> dict[str, Any]:
    """How a marker is drawn.

    Parameters
    ----------
    colour : str
        Of `PALETTE`, or ``#RRGGBB``. [name]
    kind : str
        Its form. [word]
    size : int
        [pt]

    Returns
    -------
    dict
    """
    ink = PALETTE.get(colour, colour)
    return {"type": kind, "size": size, "fill": {"color": ink}, "border": {"color": "white"}}


def xy(places: Places, table: str, x: str, y: str, name: str, **more: Any) -> dict[str, Any]:
    """A series of two columns of a table."""
    return {
        "name": name,
        "categories": places.column(table, x),
        "values": places.column(table, y),
        "marker": {"type": "none"},
        **more,
    }
