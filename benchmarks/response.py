"""Fifteen seconds under a prescribed torque: time against trajectory error, step by step.

Every program gets the same ten stations and dampers, and, where they are compared alike, the same samples of the
torque. openTorsion holds each sample over the step, so that its answer is half a step late; alike it is given the means of
neighbouring samples, by which any user removes that, and in a line of its own the samples as they are. Ours may also take the torque
as a function, which no peer can: that line is no comparison. Each is judged by the torque it returns, everywhere on a
grid of 0.1 ms: ours by its own dense output, the others at their samples or, where those are coarser, by a cubic
spline through them.
"""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.measure import (
    Point,
    Timing,
    Turn,
    interleave,
    local,
    on_grid,
    trajectory_error,
)
from benchmarks.ours import response
from benchmarks.peers import PeerFailed, Worker
from benchmarks.problems import MOTOR, RESPONSE, ten
from benchmarks.references import GAUSS_NODES, Curves, exact_response
from engine.model.build_train import build_train

__all__ = [
    "OPENTORSION_ALIKE", "OURS_ALIKE", "OURS_FUNCTION", "ROSS_ALIKE", "ResponseRow", "compare_responses", "points_of",
    "response_reference",
]  # fmt: skip

GRID = 1e-4
#: Steps of each method, and the share of a step at which the torque is sampled. [s, 1]
OURS_STEPS = (5e-3, 3e-3, 2e-3, 1e-3, 5e-4, 2.5e-4, 1e-4)
PEER_STEPS = (5e-3, 2e-3, 1e-3, 5e-4, 2e-4, 1e-4, 5e-5)
QUICK_STEPS, ALIKE_STEPS = (5e-3, 3e-3, 2e-3, 1e-3, 5e-4), (1e-3, 5e-4, 2.5e-4, 2e-4)


@dataclass(frozen=True)
class Method:
    """One way to get the response."""

    program: str
    variant: str
    label: str
    steps: tuple[float, ...]
    means: bool = False  # is given the means of neighbouring samples
    elastic: bool = False  # the program returns k Δθ, without the damper's part
    alike: bool = True  # gets the samples that every other gets, and is headed by it


OURS_ALIKE, OURS_FUNCTION = "torsionbook, the same samples", "torsionbook, torque as a function"
OPENTORSION_ALIKE = "openTorsion dsim, means of neighbouring samples"
ROSS_ALIKE = "ROSS run_time_response"
METHODS = (
    Method("torsionbook", "linear", OURS_ALIKE, OURS_STEPS, elastic=True),
    Method("openTorsion", "dsim", OPENTORSION_ALIKE, PEER_STEPS, means=True),
    Method("ROSS", "lsim", ROSS_ALIKE, PEER_STEPS, elastic=True),
    Method(
        "ROSS", "newmark, tol 1e-2", "ROSS newmark, tol = 1e-2", PEER_STEPS[3:], elastic=True, alike=False
    ),
    Method("ROSS", "newmark", "ROSS newmark", (5e-4, 1e-4), elastic=True, alike=False),
    Method("openTorsion", "dsim", "openTorsion dsim, samples as they are", PEER_STEPS, alike=False),
    Method("torsionbook", "callable", OURS_FUNCTION, OURS_STEPS[:-1], elastic=True, alike=False),
)  # fmt: skip


@dataclass(frozen=True)
class ResponseRow:
    """One step of one method.

    Parameters
    ----------
    program, label : str
        Program and method. [text]
    step : float
        Step. [s]
    timing : Timing or None
        Time of one call; None if it failed. [s]
    error, sample_error : float
        Trajectory error on the grid, and at the method's own samples. [1]
    peak_error : float
        Relative error of the largest torque. [1]
    failure : str or None
        Why there is no result. [text]
    """

    program: str
    label: str
    step: float
    timing: Timing | None
    error: float
    sample_error: float
    peak_error: float
    failure: str | None = None


def response_reference() -> tuple[Curves, float]:
    """The exact response on the grid, and its change with half the step and more nodes."""
    chain = ten()
    exact = exact_response(chain, MOTOR, RESPONSE, GRID, GAUSS_NODES)
    finer = exact_response(chain, MOTOR, RESPONSE, 0.5 * GRID, GAUSS_NODES + 4)
    return exact, trajectory_error(exact.torque, finer.torque[:, ::2])


def compare_responses(
    workers: Sequence[Worker], exact: Curves, rounds: int, quick: bool, *, alike: bool = False
) -> Iterator[ResponseRow]:
    """Rows of all methods, or of those compared alike, a step of each in turn so that they meet the same machine."""
    chain, present = ten(), {w.name: w for w in workers}
    train = build_train(chain.case())
    for worker in list(present.values()):
        try:
            worker.ask("load", budget=0.0, **chain.as_lists())
        except PeerFailed:
            del present[worker.name]
    methods = [m for m in METHODS if m.program == "torsionbook" or m.program in present]
    if quick:
        methods = [m for m in methods if not m.variant.startswith("newmark")]
    chosen = QUICK_STEPS if quick else (*OURS_STEPS, *PEER_STEPS)
    if alike:  # near an error of 1e-3
        methods, chosen = [m for m in methods if m.alike], ALIKE_STEPS
    with tempfile.TemporaryDirectory() as folder:
        for rank in range(max(len(m.steps) for m in METHODS)):
            turns: dict[str, Turn] = {}
            asked: dict[str, tuple[Method, float, Callable[[Any], Any]]] = {}
            for i, m in enumerate(methods):
                steps = [s for s in m.steps if s in chosen]
                if rank >= len(steps):
                    continue
                step, key = steps[rank], str(i)
                if m.program == "torsionbook":
                    turns[key] = local(
                        lambda s=step, k=m.variant: response(train, RESPONSE, MOTOR, s, k)
                    )
                    asked[key] = (m, step, _own)
                else:
                    out = Path(folder) / f"{i}.npy"
                    turns[key] = _asking(present[m.program], m, step, Path(folder), out)
                    asked[key] = (m, step, _of_peer)
            for key, done in interleave(turns, _rounds(rounds, turns)).items():
                m, step, read = asked[key]
                if done.failure is not None:
                    yield ResponseRow(
                        m.program, m.label, step, None, np.nan, np.nan, np.nan, done.failure
                    )
                    continue
                time, torque, rate = read(done.result)
                yield _judged(m, step, done.timing, time, torque, rate, exact)


def _rounds(rounds: int, turns: dict[str, Turn]) -> int:
    """As many as asked for; the fine steps, which only peers take, less often."""
    return rounds if len(turns) > 3 else max(1, rounds // 2)


def _asking(worker: Worker, m: Method, step: float, folder: Path, out: Path) -> Turn:
    times = step * np.arange(round(RESPONSE.duration / step) + 1)
    samples = folder / f"samples {step:g} {m.means}.npy"
    if not samples.exists():
        torque = RESPONSE(times)
        np.save(samples, 0.5 * (torque + np.append(torque[1:], torque[-1])) if m.means else torque)
    stride = max(1, round(GRID / step))

    def turn() -> tuple[Any, list[list[float]]]:
        answer = worker.ask(
            "response", variant=m.variant, step=step, station=MOTOR, torque=str(samples),
            stride=stride, out=str(out), budget=0.1,
        )  # fmt: skip
        return (times[::stride], out), answer["laps"]

    return turn


def _own(result: Any) -> tuple[Any, Any, Any]:
    return result.time, result.torque, result.torque_rate


def _of_peer(result: Any) -> tuple[Any, Any, None]:
    time, file = result
    return time, np.load(file), None


def _judged(
    m: Method, step: float, timing: Timing | None, time: Any, torque: Any, rate: Any, exact: Curves
) -> ResponseRow:
    right = exact.elastic if m.elastic else exact.torque
    everywhere = on_grid(exact.time, time, torque, rate)
    at = np.rint(time / GRID).astype(int)
    shared = np.abs(at * GRID - time) < 1e-9
    return ResponseRow(
        m.program,
        m.label,
        step,
        timing,
        trajectory_error(everywhere, right),
        trajectory_error(torque[:, shared], right[:, at[shared]]),
        float(np.max(np.abs(everywhere)) / np.max(np.abs(right)) - 1.0),
    )


def points_of(rows: Sequence[ResponseRow]) -> dict[str, list[Point]]:
    """Error and time by method, the steps that worked."""
    found: dict[str, list[Point]] = {}
    for r in rows:
        if r.timing is not None:
            found.setdefault(r.label, []).append(Point(r.step, r.error, r.timing.seconds))
    return found
