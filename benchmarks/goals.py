"""What was aimed at, and what this run reached; nothing is asserted."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from benchmarks.measure import Point, time_at
from benchmarks.start import EXPONENTIAL, WholeStart
from benchmarks.whole_run import ProgramRun, StageTimes

__all__ = ["Goal", "goals_of"]

OURS = "torsionbook, torque as a function"
PLAIN, SHIFTED = "openTorsion dsim", "openTorsion dsim, samples at mid-step"
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


def goals_of(
    responses: Mapping[str, Sequence[Point]],
    starts: Mapping[str, Sequence[Point]],
    whole: WholeStart,
    warm: StageTimes,
    programs: Sequence[ProgramRun],
) -> list[Goal]:
    """Every goal of the issue."""
    goals = [
        _against_opentorsion(responses, PLAIN, "as its examples sample the torque"),
        _against_opentorsion(responses, SHIFTED, "with samples moved to mid-step"),
    ]
    seconds, how = time_at(1e-3, starts[EXPONENTIAL])
    goals.append(
        Goal(
            "15 s start to 1e-3 in ≤ 10 ms, warm",
            f"simulation {1e3 * seconds:.1f} ms at a trajectory error of 1e-3; whole run_start "
            f"with its error estimate {1e3 * whole.timing.seconds:.1f} ms "
            f"(peaks right to {whole.peak_error:.0e})",
            _met(seconds <= 0.010, whole.timing.seconds <= 0.010),
        )
    )
    goals.append(
        Goal(
            "recalc of one workbook in a running process ≤ 150 ms",
            f"{1e3 * warm.whole.seconds:.0f} ms",
            _met(warm.whole.seconds <= 0.150),
        )
    )
    cold = next((r.seconds for r in programs if r.label.endswith("recalc")), math.nan)
    goals.append(
        Goal("cold recalc with cached kernels ≤ 1.5 s", f"{cold:.2f} s", _met(cold <= 1.5))
    )
    return goals


def _against_opentorsion(points: Mapping[str, Sequence[Point]], label: str, how: str) -> Goal:
    wanted = f"≥ 50 × openTorsion at equal trajectory error, {how}"
    if label not in points:
        return Goal(wanted, "openTorsion is absent", "–")
    ratios: list[float] = []
    said = []
    for target in TARGETS:
        theirs, reached = time_at(target, points[label])
        ours, _ = time_at(target, points[OURS])
        if reached == "–":
            best = min(points[label], key=lambda p: p.error)
            ours = time_at(best.error, points[OURS])[0]
            ratios.append(best.seconds / ours)
            said.append(f"{best.seconds / ours:.0f} × at {best.error:.1e}, the best it reached")
            break
        ratios.append(theirs / ours)
        said.append(f"{theirs / ours:.0f} × at {target:.0e}".replace("e-0", "e-"))
    return Goal(wanted, ", ".join(said), _met(*(r >= 50.0 for r in ratios)))


def _met(*parts: bool) -> str:
    if all(parts):
        return "yes"
    return "partly" if any(parts) else "no"
