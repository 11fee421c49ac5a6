"""How cost grows: time loop with modes and with start time, basis with stations, memory with time."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from addin.workers.processes import most_resident
from benchmarks.measure import Timing, interleave, local
from benchmarks.ours import build_and_solve, prepare_start, run_steps
from benchmarks.peers import single_threaded
from benchmarks.problems import random_chain, start_of_size
from engine.case.data import CaseData, LoadTorqueRow

__all__ = [
    "ClearanceRow", "LoopRow", "MemoryRow", "SizeRow", "basis_times", "clearance_rows", "exponent",
    "loop_times", "memory_of_long_starts", "size_rows",
]  # fmt: skip

ROOT = Path(__file__).resolve().parents[1]
#: Stations of the time loop, and of the basis.
LOOP_SIZES, BASIS_SIZES = (10, 20, 40, 80, 160), (5, 10, 20, 50, 100, 200, 500, 1000)
#: Stations of trains whose modes take gigabytes, and elements with clearance.
LARGE_SIZES, CLEARANCES = (1000, 2000, 5000), (0, 1, 2, 3, 4, 5, 6, 7, 8)
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


@dataclass(frozen=True)
class SizeRow:
    """All modes of one train, in a process of its own.

    Parameters
    ----------
    stations : int
        Its size. [count]
    seconds, peak : float
        Processor time, and largest resident memory. [s, B]
    """

    stations: int
    seconds: float
    peak: float


@dataclass(frozen=True)
class ClearanceRow:
    """A start with several clearances in series.

    Parameters
    ----------
    clearances, steps, impacts : int
        How many, steps of the finest simulation, impacts of all. [count]
    seconds, estimated_error : float
        Processor time of one run, and what it says of itself. [s, 1]
    told : str
        ``met``, ``not met`` or ``sensitive``. [words]
    """

    clearances: int
    steps: int
    impacts: int
    seconds: float
    estimated_error: float
    told: str


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


def size_rows(quick: bool) -> list[SizeRow]:
    """Time and memory of all modes of long trains."""
    sizes = LARGE_SIZES[:1] if quick else LARGE_SIZES
    return [SizeRow(**_in_a_process("modes", str(n))) for n in sizes]


def _measure_modes(stations: int) -> SizeRow:
    chain = random_chain(stations)
    began = time.process_time()
    build_and_solve(chain)
    return SizeRow(stations, time.process_time() - began, most_resident())


def clearance_rows(quick: bool) -> list[ClearanceRow]:
    """The linear start of the example, and starts with more and more clearances; each once."""
    from benchmarks.backlash_speed import with_clearances
    from engine.case.effect import StartEffects
    from engine.model.modal_analysis import analyse
    from engine.run import calculate_start

    rows = []
    for count in CLEARANCES[:3] if quick else CLEARANCES:
        case, names = with_clearances(count)
        model = analyse(case).reported
        began = time.process_time()
        start = calculate_start(case, model, StartEffects(), None)
        if names:
            began = time.process_time()
            start = calculate_start(case, model, StartEffects(clearances=names), start)
        spent = time.process_time() - began
        told = "sensitive" if start.is_sensitive else "met" if start.met_tolerance else "not met"
        steps, impacts = start.trajectory.n_steps, sum(c.impacts for c in start.contacts)
        rows.append(ClearanceRow(count, steps, impacts, spent, start.estimated_error, told))
    return rows


def exponent(sizes: Sequence[float], seconds: Sequence[float]) -> float:
    """Slope of a straight line through the logarithms."""
    return float(np.polyfit(np.log(sizes), np.log(seconds), 1)[0])


def memory_of_long_starts(long: float = LONG) -> list[MemoryRow]:
    """Peak memory of a long start, linear and with backlash, each in a process of its own."""
    return [MemoryRow(**_in_a_process(what, str(long))) for what in ("linear", "backlash")]


def _in_a_process(*words: str) -> dict[str, Any]:
    """One row of this module, measured in a fresh process."""
    said = subprocess.run(
        [sys.executable, "-m", "benchmarks.scaling", *words],
        capture_output=True,
        text=True,
        check=True,
        cwd=ROOT,
        env=os.environ | single_threaded(),
    )
    return dict(json.loads(said.stdout.splitlines()[-1]))


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

    calculate(0.5)  # loads what is needed
    before = most_resident()
    simulated, steps = calculate(long)
    return MemoryRow(what, simulated, steps, before, most_resident())


def _stalling(case: CaseData) -> tuple[LoadTorqueRow, ...]:
    """Loads so heavy that the train settles at part speed, where the torque goes on pulsating."""
    return tuple(replace(p, torque=3.0 * (p.torque or 0.0)) for p in case.load_torque)


if __name__ == "__main__":
    what, size = sys.argv[1:]
    row = _measure_modes(int(size)) if what == "modes" else _measure_memory(what, float(size))
    print(json.dumps(asdict(row)))
