"""Where each result of a study comes from; see `addin.contract.result_tables`."""

from __future__ import annotations

from collections.abc import Mapping

from addin.contract.result_tables import Trace
from addin.contract.studies.calibration import CALIBRATION_TRACES
from addin.contract.studies.start_matrix import STARTS_TRACES
from addin.contract.studies.tolerances import TOLERANCE_TRACES
from addin.contract.studies.tuning import TUNING_TRACES

__all__ = ["STUDY_TRACES"]

#: (result table, column) → its trace.
STUDY_TRACES: Mapping[tuple[str, str], Trace] = {
    **TUNING_TRACES,
    **TOLERANCE_TRACES,
    **STARTS_TRACES,
    **CALIBRATION_TRACES,
}
