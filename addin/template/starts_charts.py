"""Charts of start matrix and calibration; they refer to the columns of the result tables there."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from addin.template.chart_parts import Places, axis, dot, font, legend, line, title, xy

__all__ = ["STARTS_CHARTS"]


def _by_voltage(
    column: str, name: str, what: str, **more: Any
) -> Callable[[Any, Places, int], Any]:
    """Loaded and unloaded starts against voltage."""

    def make(workbook: Any, places: Places, _: int) -> Any:
        chart = workbook.add_chart({"type": "scatter", "subtype": "straight_with_markers"})
        for word, colour in (("Loaded", "navy"), ("Unloaded", "teal")):
            series = xy(places, "StartsByVoltage", "Voltage", f"{word} {column}", word)
            chart.add_series(series | {"line": line(colour, 2.0), "marker": dot(colour, size=7)})
        title(chart, name)
        chart.set_x_axis(axis("Voltage [% of that of the curves]", num_format="0", crossing="min"))
        chart.set_y_axis(axis(what, **more))
        legend(chart)
        return chart

    return make


def _fit(workbook: Any, places: Places, _: int) -> Any:
    """How far calculated frequencies are from measured ones, before and after."""
    chart = workbook.add_chart({"type": "column"})
    for column, name, colour in (
        ("Residual before", "before", "silver"),
        ("Residual", "after calibration", "navy"),
    ):
        chart.add_series(
            {
                "name": name,
                "categories": places.column("FrequencyFit", "Mode"),
                "values": places.column("FrequencyFit", column),
                "fill": {"color": line(colour)["color"]},
                "gap": 80,
            }
        )
    title(chart, "Calculated less measured frequency, in standard deviations")
    chart.set_x_axis(axis("", label_position="low", major_gridlines={"visible": False}))
    chart.set_y_axis(axis("Standard deviations of the measurement", num_format="0.0"))
    legend(chart)
    return chart


def _change(workbook: Any, places: Places, _: int) -> Any:
    """Change of each uncertain quantity with its 95 % interval."""
    chart = workbook.add_chart({"type": "line"})
    for column, name, marker in (
        ("Change high", "95 % interval, upper end", dot("steel", "square", 4)),
        ("Change", "least change", dot("rust", "diamond", 8)),
        ("Change low", "95 % interval, lower end", dot("steel", "square", 4)),
    ):
        chart.add_series(
            {
                "name": name,
                "categories": places.column("CalibratedParameters", "Name"),
                "values": places.column("CalibratedParameters", column),
                "line": {"none": True},
                "marker": marker,
            }
        )
    chart.set_high_low_lines({"line": {"color": line("steel")["color"], "width": 1.25}})
    title(chart, "Change of what is uncertain, and what is still unknown of it")
    names = {"rotation": -45, **font(8)}
    chart.set_x_axis(
        axis("", label_position="low", major_gridlines={"visible": False}, num_font=names)
    )
    chart.set_y_axis(axis("Change [%]", num_format="0"))
    legend(chart)
    return chart


#: Name of a chart → what draws it.
STARTS_CHARTS: Mapping[str, Callable[[Any, Places, int], Any]] = {
    "starts-voltage": _by_voltage(
        "starts", "Allowable starts of each kind alone", "Allowable starts",
        log_base=10, num_format="#,##0", crossing="min",
    ),
    "stress-voltage": _by_voltage(
        "stress", "Peak-to-peak stress of the governing shaft (nominal)",
        "Stress, in the unit of table By voltage", min=0, num_format="#,##0",
    ),
    "fit": _fit,
    "change": _change,
}  # fmt: skip
