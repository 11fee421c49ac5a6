"""Charts on the study sheets; they refer to the columns of the result tables there."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from addin.template.chart_parts import Places
from addin.template.starts_charts import STARTS_CHARTS
from addin.template.tolerance_charts import TOLERANCE_CHARTS
from addin.template.tuning_charts import TUNING_CHARTS

__all__ = ["STUDY_CHARTS"]

#: Name of a chart → what draws it.
STUDY_CHARTS: Mapping[str, Callable[[Any, Places, int], Any]] = {
    **TUNING_CHARTS,
    **TOLERANCE_CHARTS,
    **STARTS_CHARTS,
}
