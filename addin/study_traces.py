"""Where each result of a study comes from; see `addin.traces`."""

from __future__ import annotations

from collections.abc import Mapping

from addin.calibration_fields import CALIBRATION_TRACES
from addin.starts_fields import STARTS_TRACES
from addin.traces import Trace

__all__ = ["STUDY_TRACES"]

#: (result table, column) → its trace.
STUDY_TRACES: Mapping[tuple[str, str], Trace] = {**STARTS_TRACES, **CALIBRATION_TRACES}
