"""Charts of a tuning study: starts, margins and modes over the first variable."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from addin.contract.studies.tuning import LINES, MAP_MODES
from addin.template.chart_parts import Places, axis, dot, legend, line, title, xy

__all__ = ["TUNING_CHARTS"]

_COLOURS = ("navy", "teal", "gold", "rust", "plum", "grey")


def _cell(places: Places, table: str, column: str) -> str:
    """The first data row of a column as a formula."""
    sheet, row, at, *_ = places.cell(table, column, 0)
    from xlsxwriter.utility import xl_rowcol_to_cell

    return f"='{sheet}'!{xl_rowcol_to_cell(row, at, True, True)}"


def _series(places: Places, table: str, k: int) -> dict[str, Any]:
    colour = _COLOURS[(k - 1) % len(_COLOURS)]
    name = _cell(places, "TuningAxes", f"Line {k}")
    more = {"line": line(colour), "marker": dot(colour, size=5)}
    return xy(places, table, "Of as is", f"Line {k}", name) | more


def _starts(workbook: Any, places: Places, _: int) -> Any:
    """Allowable starts, one line an option of the second variable."""
    chart = workbook.add_chart({"type": "scatter", "subtype": "straight"})
    for k in range(1, LINES + 1):
        chart.add_series(_series(places, "TuningLines", k))
    title(chart, "Allowable starts, a line each option of the second variable (unlimited left out)")
    chart.set_x_axis(axis(_cell(places, "TuningAxes", "First variable"), num_format="General"))
    chart.set_y_axis(axis("Allowable starts", log_base=10, num_format="#,##0", crossing="min"))
    chart.show_blanks_as("gap")
    legend(chart)
    return chart


def _margins(workbook: Any, places: Places, _: int) -> Any:
    """Worst separation margin, with the required one."""
    chart = workbook.add_chart({"type": "scatter", "subtype": "straight"})
    for k in range(1, LINES + 1):
        chart.add_series(_series(places, "TuningMargins", k))
    required = xy(places, "TuningMargins", "Of as is", "Required", "Required")
    chart.add_series(required | {"line": line("rust", 1.5, "dash")})
    title(chart, "Worst separation margin, a line each option of the second variable")
    chart.set_x_axis(axis(_cell(places, "TuningAxes", "First variable"), num_format="General"))
    chart.set_y_axis(axis("Margin, as in the table", min=0, num_format="General"))
    legend(chart)
    return chart


def _modes(workbook: Any, places: Places, _: int) -> Any:
    """Modes, and the bands that no mode may lie in."""
    chart = workbook.add_chart({"type": "scatter", "subtype": "straight"})
    hatch = xy(places, "TuningHatch", "Of as is", "Frequency", "Forbidden")
    chart.add_series(hatch | {"line": line("#EFB9AE", 0.5)})
    for k in range(1, MAP_MODES + 1):
        colour = _COLOURS[(k - 1) % len(_COLOURS)]
        mode = xy(places, "TuningModes", "Of as is", f"Mode {k}", f"Mode {k}")
        chart.add_series(mode | {"line": line(colour, 2.0), "marker": dot(colour, size=5)})
    title(chart, "Modes of the best combination with each option, and the forbidden bands")
    chart.set_x_axis(axis(_cell(places, "TuningAxes", "First variable"), num_format="General"))
    chart.set_y_axis(axis("Frequency, as in the table", min=0, num_format="General"))
    chart.show_blanks_as("gap")
    legend(chart)
    return chart


TUNING_CHARTS: Mapping[str, Callable[[Any, Places, int], Any]] = {
    "tuning-starts": _starts,
    "tuning-margins": _margins,
    "tuning-modes": _modes,
}
