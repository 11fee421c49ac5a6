"""Filled study sheets for the sample case of the paper: what an engineer would ask of it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from addin.examples import Value

__all__ = ["STUDY_ROWS"]

#: Rows of the study tables, in the units of the US template.
STUDY_ROWS: Mapping[str, Sequence[Mapping[str, Value]]] = {
    "StartConditions": (
        {"Condition": "normal start", "Per year": 24, "So far": 60},
        {"Condition": "weak supply", "Voltage": 80, "Per year": 6, "So far": 12},
        {"Condition": "strong supply", "Voltage": 105, "Per year": 6, "So far": 12},
        {"Condition": "by-passed", "Load": 0, "Per year": 12, "So far": 20},
        {"Condition": "hot restart", "Damping ratio": 1.2, "Per year": 4, "So far": 8},
        {"Condition": "trip behind mode 1", "Trip speed": 78, "Per year": 0.5, "So far": 1},
        {"Condition": "supply lost (50 %)", "Voltage": 50},
    ),
    "MeasuredFrequencies": (
        {"Frequency": 29.4, "Uncertainty": 1},
        {"Frequency": 54.1, "Uncertainty": 1},
        {"Frequency": 120, "Uncertainty": 0.5},
    ),
    "MeasuredPeaks": ({"Element": "HS coupling", "Maximum torque": 14900, "Uncertainty": 5},),
}
