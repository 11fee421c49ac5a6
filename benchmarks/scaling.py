"""How cost grows: time loop with modes and with start time, basis with stations, memory with time."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from addin.workers.processes import most_resident
from benchmarks.measure import Timing, interleave, local
from benchmarks.ours import build_and_solve, prepare_start, run_steps
from benchmarks.peers import single_threaded
from benchmarks.problems import random_chain, start_of_size
from engine.case.data import CaseData, LoadTorqueRow

__all__ = ["LoopRow", "MemoryRow", "basis_times", "exponent", "loop_times", "memory_of_long_starts"]

ROOT = Path(__file__).resolve().parents[1]
#: Stations of the time loop, and of the basis.
LOOP_SIZES, BASIS_SIZES = (10, 20, 40, 80, 160), (5, 10, 20, 50, 100, 200, 500, 1000)
#: Voltages at which the start takes longer and longer.
VOLTAGES = (1.0, 0.77, 0.65, 0.62)
STEP = 7.5e-4
#: Of the long start. [s]
LONG = 600.0
#: Largest memory wanted. [B]
MEMORY = 300e6


@dataclass(frozen=True)
class LoopRow:
    """Time of one simulation.

    Parameters
    ----------
    modes : int
        Modes kept. [count]
    simulated : float
        Start time. [s]
    steps : int
        Steps. [count]
    timing : Timing
        Median. [s]
    """

    modes: int
    simulated: float
    steps: int
    timing: Timing


@dataclass(frozen=True)
class MemoryRow:
    """Memory of one whole start, in a process of its own.

    Parameters
    ----------
    what : str
        Which start. [words]
    simulated : float
        Start time. [s]
    steps : int
        Steps of the finer simulation. [count]
    before, peak : float
        Resident memory before the start (programs and libraries), and at the most. [B]
    """

    what: str
    simulated: float
    steps: int
    before: float
    peak: float


def loop_times(rounds: int, quick: bool) -> tuple[list[LoopRow], list[LoopRow]]:
    """The time loop with more modes; and with a longer start."""
    sizes = LOOP_SIZES[:3] if quick else LOOP_SIZES
    return (
        list(_loops([(n, 0.77) for n in sizes], rounds)),
        list(_loops([(10, v) for v in VOLTAGES], rounds)),
    )


def _loops(cases: Sequence[tuple[int, float]], rounds: int) -> Iterator[LoopRow]:
    starts = [prepare_start(start_of_size(n, v), 1e-7) for n, v in cases]
    turns = {
        str(i): local(lambda s=s: run_steps(s, STEP, "exponential"), 0.05, 10)
        for i, s in enumerate(starts)
    }
    for key, done in interleave(turns, rounds).items():
        assert done.timing is not None
        modes = len(starts[int(key)].model.stiffness)
        yield LoopRow(modes, float(done.result.time[-1]), done.result.n_steps, done.timing)


def basis_times(rounds: int, quick: bool) -> dict[int, Timing]:
    """Train and all its modes, by stations of an unbranched train."""
    sizes = BASIS_SIZES[:6] if quick else BASIS_SIZES
    chains = [random_chain(n) for n in sizes]
    turns = {str(c.n): local(lambda c=c: build_and_solve(c), 0.05, 50) for c in chains}
    done = interleave(turns, rounds)
    return {int(key): d.timing for key, d in done.items() if d.timing is not None}


def exponent(sizes: Sequence[float], seconds: Sequence[float]) -> float:
    """Slope of a straight line through the logarithms."""
    return float(np.polyfit(np.log(sizes), np.log(seconds), 1)[0])


def memory_of_long_starts(long: float = LONG) -> list[MemoryRow]:
    """Peak memory of a long start, linear and with backlash, each in a process of its own."""
    rows = []
    for what in ("linear", "backlash"):
        said = subprocess.run(
            [sys.executable, "-m", "benchmarks.scaling", what, str(long)],
            capture_output=True,
            text=True,
            check=True,
            cwd=ROOT,
            env=os.environ | single_threaded(),
        )
        rows.append(MemoryRow(**json.loads(said.stdout.splitlines()[-1])))
    return rows


def _measure_memory(what: str, long: float) -> MemoryRow:
    """Run in a fresh process: its largest resident memory cannot be reset."""
    from benchmarks.backlash_speed import start_with_teeth
    from engine.case.effect import StartEffects
    from engine.model.modal_analysis import analyse
    from engine.run import calculate_start

    case, mesh = start_with_teeth(bearings=False)
    model = analyse(case).reported
    clearances = (mesh,) if what == "backlash" else ()

    def calculate(until: float) -> tuple[float, int]:
        held = replace(case, maximum_time=until, load_torque=_stalling(case))
        effects = StartEffects(full_length=True)
        start = calculate_start(held, model, effects, None)
        if clearances:
            effects = replace(effects, clearances=clearances)
            start = calculate_start(held, model, effects, start)
        return start.outcome.time, start.trajectory.n_steps

    calculate(0.5)  # compiles, loads what is needed
    before = most_resident()
    time, steps = calculate(long)
    return MemoryRow(what, time, steps, before, most_resident())


def _stalling(case: CaseData) -> tuple[LoadTorqueRow, ...]:
    """Loads so heavy that the train settles at part speed, where the torque goes on pulsating."""
    return tuple(replace(p, torque=3.0 * (p.torque or 0.0)) for p in case.load_torque)


if __name__ == "__main__":
    row = _measure_memory(sys.argv[1], float(sys.argv[2]))
    print(json.dumps(row.__dict__))
