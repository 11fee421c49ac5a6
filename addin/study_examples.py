"""Filled study sheets for the sample case of the paper: what an engineer would ask of it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from addin.examples import Value

__all__ = ["STUDY_ROWS"]

#: Rows of the study tables, in the units of the US template.
STUDY_ROWS: Mapping[str, Sequence[Mapping[str, Value]]] = {
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
            "Quantity": "load torque", "Distribution": "normal", "Spread": 5.0,
            "Together": "together",
        },
        {"Quantity": "S-N line", "Distribution": "from-to", "From": 90.0, "To": 110.0},
    ),
}  # fmt: skip
