"""Filled study sheets for the sample case of the paper: what an engineer would ask of it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from addin.examples import Value

__all__ = ["STUDY_ROWS"]

#: Rows of the study tables, in the units of the US template.
STUDY_ROWS: Mapping[str, Sequence[Mapping[str, Value]]] = {
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
