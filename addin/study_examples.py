"""Filled study sheets for the sample case of the paper: what an engineer would ask of it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from addin.examples import Value

__all__ = ["STUDY_ROWS"]

#: Rows of the study tables, in the units of the US template.
STUDY_ROWS: Mapping[str, Sequence[Mapping[str, Value]]] = {}
