"""A goal beside what was measured; nothing is asserted. The goals of both programs: `benchmarks.goals_beside`."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["TARGETS", "Goal"]

#: Trajectory errors at which programs are compared.
TARGETS = (1e-2, 1e-3, 1e-4)


@dataclass(frozen=True)
class Goal:
    """One goal with what was measured.

    Parameters
    ----------
    wanted, measured : str
        In words and numbers. [text]
    verdict : str
        ``yes``, ``no``, ``partly`` or ``–`` where it could not be measured. [word]
    """

    wanted: str
    measured: str
    verdict: str
