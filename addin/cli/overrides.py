"""Settings of a calculation that are given on the command line."""

from __future__ import annotations

from typing import Any

import typer

from addin.cli.options import check_choice
from engine.case.defaults import LEAST_PEAK_ERROR, LEAST_TOLERANCE_PEAK


def case_overrides(method: str | None, tolerance: str | None) -> dict[str, Any]:
    """Settings of the command line, under the names of the case."""
    settings: dict[str, Any] = {}
    if method is not None:
        check_choice("--method", method, ("exponential", "newmark"))
        settings["method"] = method
    if tolerance is not None:
        text = tolerance.strip()
        try:
            value = float(text.rstrip("%")) * (0.01 if text.endswith("%") else 1.0)
        except ValueError:
            raise typer.BadParameter(
                f"--tolerance is '{tolerance}'; write a number such as 0.001 or 0.1%."
            ) from None
        if not LEAST_TOLERANCE_PEAK <= value <= 0.5:
            raise typer.BadParameter(
                f"--tolerance is {value:g}; it must be between {LEAST_TOLERANCE_PEAK:g} and 0.5 "
                f"(50 %). Peak torques are calculated to {LEAST_PEAK_ERROR:g} at best."
            )
        settings["tolerance_peak"] = value
    return settings
