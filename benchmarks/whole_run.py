"""A workbook recalculated: inside a running process by stage, and as a program from nothing."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path
from statistics import median

from addin.contract.shipped import template_path
from addin.writing.recalculate import recalculate
from benchmarks.measure import Timing, timing_of
from benchmarks.peers import single_threaded
from benchmarks.peers.protocol import Laps

__all__ = ["ProgramRun", "StageTimes", "program_runs", "running_process", "warm_recalculation"]

EXAMPLE = "example_proposed.xlsx"
PROGRAM = ["-c", "from addin.cli import main; main()"]


@dataclass(frozen=True)
class StageTimes:
    """A warm recalculation.

    Parameters
    ----------
    whole : Timing
        From the file to the file. [s]
    stages : tuple of (str, float)
        Name and median time of each stage, in order. [s]
    """

    whole: Timing
    stages: tuple[tuple[str, float], ...]


@dataclass(frozen=True)
class ProgramRun:
    """One command run as a program of its own.

    Parameters
    ----------
    label : str
        What it does. [text]
    seconds : float
        Median wall time from start to exit. [s]
    runs : int
        How often. [count]
    """

    label: str
    seconds: float
    runs: int


def warm_recalculation(repeats: int) -> StageTimes:
    """`recalculate` on the shipped example, twice to warm up and then `repeats` times."""
    laps: Laps = []
    spent: dict[str, list[float]] = {}
    with tempfile.TemporaryDirectory() as folder:
        source = Path(shutil.copy(template_path(EXAMPLE), folder))
        target = Path(folder) / "results.xlsx"
        for repeat in range(-2, repeats):
            marks: list[tuple[str, float]] = []

            def mark(stage: str, marks: list[tuple[str, float]] = marks) -> None:
                marks.append((stage, time.perf_counter()))

            cpu, wall = time.process_time(), time.perf_counter()
            done = recalculate(source, destination=target, on_stage=mark)
            end = time.perf_counter()
            if done.calculation is None:
                raise RuntimeError("; ".join(p.message for p in done.problems))
            if repeat < 0:
                continue
            laps.append([end - wall, time.process_time() - cpu])
            ends = [at for _, at in marks[1:]] + [end]
            for (stage, began), ended in zip(marks, ends, strict=True):
                spent.setdefault(stage, []).append(ended - began)
    return StageTimes(timing_of(laps), tuple((s, median(t)) for s, t in spent.items()))


def running_process(repeats: int, *, one_thread: bool) -> StageTimes:
    """`warm_recalculation` in a process of its own, with one thread for linear algebra or as found."""
    env = _as_found() | (single_threaded() if one_thread else {})
    command = [sys.executable, "-m", "benchmarks.whole_run", str(repeats)]
    done = subprocess.run(command, check=True, capture_output=True, env=env, text=True)
    said = json.loads(done.stdout.splitlines()[-1])
    return StageTimes(Timing(**said["whole"]), tuple((s, t) for s, t in said["stages"]))


def _as_found() -> dict[str, str]:
    """The environment without the limits the benchmark sets for itself."""
    return {k: v for k, v in os.environ.items() if k not in single_threaded()}


def program_runs(repeats: int) -> Iterator[ProgramRun]:
    """The command line as a user starts it, with the threads a user has."""
    env = _as_found()
    with tempfile.TemporaryDirectory() as folder:
        source = shutil.copy(template_path(EXAMPLE), folder)
        recalc = [*PROGRAM, "recalc", str(source), "--out", str(Path(folder) / "out")]
        commands = {
            "Python itself": ["-c", "pass"],
            "torsionbook --help": [*PROGRAM, "--help"],
            "torsionbook check": [*PROGRAM, "check", str(source)],
            "torsionbook recalc": recalc,
        }
        times: dict[str, list[float]] = {label: [] for label in commands}
        for repeat in range(repeats + 1):
            for label, command in commands.items():
                seconds = _run(command, env)
                if repeat > 0:
                    times[label].append(seconds)
    for label, found in times.items():
        yield ProgramRun(label, median(found), len(found))


def _run(command: list[str], env: dict[str, str]) -> float:
    began = time.perf_counter()
    subprocess.run([sys.executable, *command], check=True, capture_output=True, env=env)
    return time.perf_counter() - began


if __name__ == "__main__":
    print(json.dumps(asdict(warm_recalculation(int(sys.argv[1])))))
