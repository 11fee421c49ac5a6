"""Charts of the tolerances; part of `addin.template.study_charts`."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from addin.template.chart_parts import Places, axis, font, legend, line, title, xy
from addin.template.styles import PALETTE

__all__ = ["TOLERANCE_CHARTS"]


def _tornado(workbook: Any, places: Places, _: int) -> Any:
    """The strongest factors, each at its P10 and P90: what they make of the answer."""
    chart = workbook.add_chart({"type": "bar"})
    for column, colour in (("At P10", "rust"), ("At P90", "navy")):
        chart.add_series(
            {
                "name": f"factor {column.lower().replace('p', 'P')}",
                "categories": places.column("ToleranceTornado", "Factor"),
                "values": places.column("ToleranceTornado", column),
                "fill": {"color": PALETTE[colour]},
                "border": {"none": True},
                "gap": 45,
                "overlap": 100,
            }
        )
    chart.set_y_axis(
        axis(
            "",
            reverse=True,
            crossing="max",
            label_position="low",
            major_gridlines={"visible": False},
            major_tick_mark="none",
        )
    )
    chart.set_x_axis(axis("Change of the answer, %", num_format="+0;-0;0"))
    title(chart, "What drives it: one factor at a time, at its P10 and P90")
    legend(chart)
    return chart


def _starts_histogram(workbook: Any, places: Places, _: int) -> Any:
    """How many samples allow how many starts."""
    chart = workbook.add_chart({"type": "column"})
    chart.add_series(
        {
            "name": "share of the samples",
            "categories": places.column("ToleranceHistogram", "Starts"),
            "values": places.column("ToleranceHistogram", "Share"),
            "fill": {"color": PALETTE["steel"]},
            "border": {"color": "white", "width": 0.5},
            "gap": 8,
        }
    )
    chart.set_x_axis(axis("", num_font=font(7, rotation=-45), major_gridlines={"visible": False}))
    chart.set_y_axis(axis("Share of samples, %", num_format="0", min=0))
    title(chart, "Allowable starts of the samples")
    chart.set_legend({"none": True})
    return chart


def _starts_distribution(workbook: Any, places: Places, _: int) -> Any:
    """Probability that no more starts are allowed."""
    chart = workbook.add_chart({"type": "scatter", "subtype": "straight"})
    series = xy(places, "ToleranceDistribution", "Starts", "Probability", "samples")
    chart.add_series(series | {"line": line("navy")})
    chart.set_x_axis(axis("Allowable starts", log_base=10, num_format="#,##0"))
    chart.set_y_axis(axis("Probability of fewer, %", min=0, max=100, num_format="0"))
    title(chart, "Probability that the train allows fewer starts")
    chart.set_legend({"none": True})
    return chart


#: Name of a chart → what draws it.
TOLERANCE_CHARTS: Mapping[str, Callable[[Any, Places, int], Any]] = {
    "tornado": _tornado,
    "starts_histogram": _starts_histogram,
    "starts_distribution": _starts_distribution,
}
