"""What was simulated and why, and the verdicts."""

from __future__ import annotations

from addin.worksheet.answers import (
    HEADERS,
    MODEL,
    UNITS,
    Rows,
    run_table,
    width_of,
)
from addin.worksheet.registry import registered

#: Place of these functions among all, in lists and in the documentation.
ORDER = 80


@registered(
    "TV_EFFECTS",
    MODEL,
    UNITS,
    HEADERS,
    long=True,
    columns=width_of("Effects"),
    example="=TV_EFFECTS(A1)",
)
def tv_effects(model: str, units: str | None, headers: bool | None) -> Rows:
    """Which effects the calculation simulates, with the number that decided each."""
    return run_table("Effects", model, units, headers)


@registered(
    "TV_VERDICTS",
    MODEL,
    UNITS,
    HEADERS,
    long=True,
    columns=width_of("Verdicts"),
    example="=TV_VERDICTS(A1)",
)
def tv_verdicts(model: str, units: str | None, headers: bool | None) -> Rows:
    """The checks of sheet Summary: how the start ended, margins, peaks, starts against required."""
    return run_table("Verdicts", model, units, headers, "Nothing is judged.")
