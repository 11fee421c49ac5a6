"""Continuous operation: separation margins, forbidden bands, steady state."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from addin.worksheet.answers import at_speed_tables, run_of, shows_table
from addin.worksheet.registry import FunctionError

#: Place of these functions among all, in lists and in the documentation.
ORDER = 40

_NO_SPEED = (
    "the case has no speed and no line frequency. Type two of LineFrequency, Poles and "
    "SynchronousSpeed."
)


@shows_table("TV_MARGINS", "SeparationMargins", at_speed_tables, f"Nothing is judged: {_NO_SPEED}")
def tv_margins(tables: Mapping[str, Any]) -> Any:
    """Separation margin of every mode from every excitation, with its verdict."""
    return tables["SeparationMargins"]


@shows_table(
    "TV_BANDS",
    "ForbiddenBands",
    at_speed_tables,
    f"No forbidden bands: {_NO_SPEED}",
    columns=("Excitation", "From", "To", "Lowest", "Highest", "Modes inside"),
)
def tv_bands(tables: Mapping[str, Any]) -> Any:
    """Forbidden bands: frequencies round every excitation where no mode may lie, and the modes inside.

    From and To are the required margin solved for the frequency: f_min (1 - m) and f_max (1 + m).
    """
    return tables["ForbiddenBands"]


@shows_table(
    "TV_STEADY",
    "SteadyState",
    at_speed_tables,
    "No forced response: no excitation has a known torque and frequency.",
)
def tv_steady(tables: Mapping[str, Any]) -> Any:
    """Forced response at operating speeds, and at resonance where a margin is not kept."""
    return tables["SteadyState"]


@shows_table("TV_EVENTS", "EventPeaks", run_of)
def tv_events(run: Any) -> Any:
    """Largest and least torque, stress and damage of every element in every event in operation."""
    rows = run.tables.get("EventPeaks")
    if not rows:
        raise FunctionError(
            "The case has no event in operation: fill table EventTorque or MotorEvents.", "#N/A"
        )
    return rows


@shows_table("TV_CASE_VERDICTS", "CaseVerdicts", run_of)
def tv_case_verdicts(run: Any) -> Any:
    """Verdicts of the case under every row of StartConditions: result, limit, place and coverage of each check."""
    rows = run.tables.get("CaseVerdicts")
    if not rows:
        raise FunctionError("The case has one condition only: fill table StartConditions.", "#N/A")
    return rows
