"""Filled study sheets for the sample case of the paper: what an engineer would ask of it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from addin.template.examples import Value

__all__ = ["STUDY_ROWS", "study_rows"]

Rows = Mapping[str, Sequence[Mapping[str, Value]]]


def _duty(behind_mode_1: float) -> Sequence[Mapping[str, Value]]:
    """A year of starts, and those so far; speed just past the crossing of mode 1. [%]"""
    return (
        {"Condition": "normal start", "Per year": 24, "So far": 60},
        {"Condition": "weak supply", "Voltage": 80, "Per year": 6, "So far": 12},
        {"Condition": "strong supply", "Voltage": 105, "Per year": 6, "So far": 12},
        {"Condition": "by-passed", "Load": 0, "Per year": 12, "So far": 20},
        {"Condition": "hot restart", "Damping ratio": 1.2, "Per year": 4, "So far": 8},
        {
            "Condition": "trip behind mode 1",
            "Trip speed": behind_mode_1,
            "Per year": 0.5,
            "So far": 1,
        },
        {"Condition": "supply sags to 50 %", "Voltage": 50},
    )


#: Rows of the study tables, in the units of the US template.
STUDY_ROWS: Rows = {
    "Tuning": (
        {
            "Element": "HS coupling",
            "Quantity": "stiffness",
            "Unit": "%",
            "Values": "20; 25; 33; 40; 50; 60; 80; 100",
        },
        {
            "Element": "Intermediate coupling",
            "Quantity": "stiffness",
            "Unit": "%",
            "Values": "35; 49; 70; 100",
        },
    ),
    "Catalogue": (
        {
            "Element": "LS coupling",
            "Name": "as proposed",
            "Fitted": "yes",
            "Stiffness": 2.56194e8,
            "Inertia": 85.0,
        },
        {"Element": "LS coupling", "Name": "as modified", "Stiffness": 2.19165e8, "Inertia": 85.0},
        {
            "Element": "LS coupling",
            "Name": "softer, 4 % loss factor",
            "Stiffness": 1.5e8,
            "Inertia": 130.0,
            "Loss factor": 0.04,
            "Rated torque": 6.5e5,
        },
    ),
    "Scatter": (
        {"Quantity": "stiffness", "Distribution": "normal", "Spread": 5.0},
        {"Quantity": "inertia", "Distribution": "normal", "Spread": 2.0},
        {"Quantity": "damping ratio", "Distribution": "uniform", "Spread": 30.0},
        {"Quantity": "average torque", "Distribution": "normal", "Spread": 5.0},
        {"Quantity": "pulsating torque", "Distribution": "triangular", "Spread": 10.0},
        {
            "Quantity": "load torque",
            "Distribution": "normal",
            "Spread": 5.0,
            "Together": "together",
        },
        {"Quantity": "S-N line", "Distribution": "from-to", "From": 90.0, "To": 110.0},
    ),
    "StartConditions": _duty(78),
    "MeasuredFrequencies": (
        {"Frequency": 29.4, "Uncertainty": 1},
        {"Frequency": 54.1, "Uncertainty": 1},
        {"Frequency": 120, "Uncertainty": 0.5},
    ),
    "MeasuredPeaks": ({"Element": "HS coupling", "Maximum torque": 14900, "Uncertainty": 5},),
}

#: Where an example has others.
_OF_EXAMPLE: Mapping[str, Rows] = {
    "modified": {
        "StartConditions": _duty(85.5),
        "MeasuredFrequencies": (
            {"Frequency": 20.7, "Uncertainty": 1},
            {"Frequency": 39.6, "Uncertainty": 1},
            {"Frequency": 68.1, "Uncertainty": 1},
        ),
        "MeasuredPeaks": ({"Element": "HS coupling", "Maximum torque": 11500, "Uncertainty": 5},),
    }
}


def study_rows(example: str) -> Rows:
    """Rows of the study tables of an example."""
    return {**STUDY_ROWS, **_OF_EXAMPLE.get(example, {})}
