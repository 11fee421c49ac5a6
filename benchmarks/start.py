"""A start of fifteen seconds: the exponential step against the paper's Newmark, and how time grows."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from benchmarks.measure import Point, Timing, interleave, local, on_grid, trajectory_error
from benchmarks.ours import PreparedStart, prepare_start, run_steps
from benchmarks.problems import long_start, start_of_size
from benchmarks.references import Curves, exact_start
from engine.model.modal_train import ModalTrain
from engine.start.start import Start, run_start

__all__ = [
    "GrowthRow", "StartRow", "WholeStart", "compare_starts", "growth", "start_points",
    "start_reference", "whole_start",
]  # fmt: skip

Floats = NDArray[np.float64]
GRID = 2.5e-4
EXPONENTIAL, NEWMARK = "torsionbook exponential", "torsionbook Newmark (the paper's)"
STEPS = {
    EXPONENTIAL: (3e-3, 2e-3, 1.5e-3, 1e-3, 7.5e-4, 5e-4, 2.5e-4, 1.25e-4),
    NEWMARK: (1e-3, 5e-4, 2e-4, 1e-4, 5e-5, 2e-5, 1e-5),
}
WORD = {EXPONENTIAL: "exponential", NEWMARK: "newmark"}
#: All modes are kept for the comparison of steppers, so that only the step is judged.
KEEP_ALL = 1e-7
REFERENCE_STEP = 1e-3 / 64.0


@dataclass(frozen=True)
class StartRow:
    """One step of one method."""

    label: str
    step: float
    steps: int
    timing: Timing
    error: float
    peak_error: float


@dataclass(frozen=True)
class WholeStart:
    """`run_start` at its default tolerance: two simulations, turning points, error estimate."""

    timing: Timing
    simulation: Timing
    seconds_simulated: float
    estimated_error: float
    trajectory_error: float
    peak_error: float
    step: float
    steps: int
    halvings: int
    kept_modes: int


@dataclass(frozen=True)
class GrowthRow:
    """Time of one simulation of one size."""

    stations: int
    kept_modes: int
    seconds_simulated: float
    steps: int
    timing: Timing


def start_reference(start: PreparedStart, *, quick: bool) -> tuple[Curves, float | None]:
    """Dormand-Prince on the grid, and how far the exponential step at 1/64 ms is from it.

    Quick: that fine step itself, and None.
    """
    fine = run_steps(start, REFERENCE_STEP, "exponential")
    grid = np.arange(0.0, fine.time[-1] - 2e-3, GRID)
    if quick:
        torque = on_grid(grid, fine.time, fine.torque, fine.torque_rate)
        torque = torque[np.argsort(fine.output_element)]
        return Curves(grid, torque, torque), None
    damping = start.damping_matrix()
    exact = exact_start(start.case, start.train, damping, start.model, start.stations, grid)
    return exact, _error(fine, exact)[0]


def compare_starts(
    start: PreparedStart, exact: Curves, rounds: int, quick: bool
) -> Iterator[StartRow]:
    """Both methods at falling steps, taking turns."""
    for rank in range(max(map(len, STEPS.values()))):
        turns, at = {}, {}
        for label, steps in STEPS.items():
            if rank < len(steps) and not (quick and steps[rank] < 5e-5):
                at[label] = steps[rank]
                turns[label] = local(
                    lambda h=steps[rank], w=WORD[label]: run_steps(start, h, w), 0.05, 10
                )
        for label, done in interleave(turns, rounds).items():
            assert done.timing is not None
            error, peak = _error(done.result, exact)
            yield StartRow(label, at[label], done.result.n_steps, done.timing, error, peak)


def _error(trajectory: object, exact: Curves) -> tuple[float, float]:
    """Trajectory error, and the relative error of the largest torque of the worst shaft."""
    t = trajectory
    inside = exact.time <= t.time[-1]  # type: ignore[attr-defined]
    grid, right = exact.time[inside], exact.torque[:, inside]
    torque = on_grid(grid, t.time, t.torque, t.torque_rate)  # type: ignore[attr-defined]
    torque = torque[np.argsort(t.output_element)]  # type: ignore[attr-defined]
    peak = np.max(np.abs(torque), axis=1) / np.max(np.abs(right), axis=1) - 1.0
    return trajectory_error(torque, right), float(np.max(np.abs(peak)))


def start_points(rows: Sequence[StartRow]) -> dict[str, list[Point]]:
    """Error and time by method."""
    found: dict[str, list[Point]] = {}
    for r in rows:
        found.setdefault(r.label, []).append(Point(r.step, r.error, r.timing.seconds))
    return found


def whole_start(exact: Curves, rounds: int) -> WholeStart:
    """The start as a case calls for it, beside one bare simulation at the step it chose."""
    start = prepare_start(long_start())

    def whole() -> Start:
        return run_start(start.case, ModalTrain(start.train, start.modes, start.damping))

    step = whole().step
    done = interleave(
        {
            "whole": local(whole, 0.1, 10),
            "alone": local(lambda: run_steps(start, step, "exponential"), 0.1, 10),
        },
        rounds,
    )
    result, timing, alone = done["whole"].result, done["whole"].timing, done["alone"].timing
    assert timing is not None
    assert alone is not None
    error, peak = _error(result.trajectory, exact)
    return WholeStart(
        timing,
        alone,
        result.outcome.time,
        result.estimated_error,
        error,
        peak,
        result.step,
        result.trajectory.n_steps,
        result.halvings,
        result.kept_modes,
    )


def growth(rounds: int, quick: bool) -> Iterator[GrowthRow]:
    """One simulation at a step of 0.75 ms: more stations, then a longer start."""
    cases = [(n, 0.77) for n in ((10, 20, 40) if quick else (10, 20, 40, 80))]
    cases += [(10, v) for v in (1.0, 0.65, 0.62)]
    starts = [prepare_start(start_of_size(n, v)) for n, v in cases]
    turns = {
        str(i): local(lambda s=s: run_steps(s, 7.5e-4, "exponential"), 0.05, 10)
        for i, s in enumerate(starts)
    }
    for key, done in interleave(turns, rounds).items():
        s = starts[int(key)]
        assert done.timing is not None
        yield GrowthRow(
            s.train.n_stations,
            len(s.model.stiffness),
            float(done.result.time[-1]),
            done.result.n_steps,
            done.timing,
        )
