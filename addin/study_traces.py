"""Where each result of a study comes from; see `addin.traces`."""

from __future__ import annotations

from collections.abc import Mapping

from addin.traces import Trace

__all__ = ["STUDY_TRACES"]

#: (result table, column) → its trace.
STUDY_TRACES: Mapping[tuple[str, str], Trace] = {}
