"""What was simulated and why, and the verdicts."""

from __future__ import annotations

from typing import Any

from addin.worksheet.answers import run_of, shows_table

#: Place of these functions among all, in lists and in the documentation.
ORDER = 80


@shows_table("TV_EFFECTS", "Effects", run_of)
def tv_effects(run: Any) -> Any:
    """Effects that the calculation simulates or leaves out, each with its deciding number."""
    return run.tables.get("Effects")


@shows_table("TV_VERDICTS", "Verdicts", run_of, "Nothing is judged.")
def tv_verdicts(run: Any) -> Any:
    """The checks of sheet Summary: how the start ended, margins, peaks, starts against required."""
    return run.tables.get("Verdicts")
