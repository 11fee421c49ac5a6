"""Where each result of a study comes from; see `addin.traces`."""

from __future__ import annotations

from collections.abc import Mapping

from addin.calibration_fields import CALIBRATION_TRACES
from addin.starts_fields import STARTS_TRACES
from addin.tolerance_fields import TOLERANCE_TRACES
from addin.traces import Trace
from addin.tuning_fields import TUNING_TRACES

__all__ = ["STUDY_TRACES"]

#: (result table, column) → its trace.
STUDY_TRACES: Mapping[tuple[str, str], Trace] = {
    **TUNING_TRACES,
    **TOLERANCE_TRACES,
    **STARTS_TRACES,
    **CALIBRATION_TRACES,
}
