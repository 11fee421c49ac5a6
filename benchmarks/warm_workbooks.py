"""A workbook recalculated in a running process: as it is shipped, and when it has results already.

    python -m benchmarks.warm_workbooks [ROUNDS] [OTHER_CHECKOUT]

Processor time, one thread, medians of rounds in which all rows take their turn. With another checkout both source trees
take turns too, each in a process of its own.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from statistics import median

from addin.contract.shipped import template_path
from addin.writing.recalculate import recalculate
from benchmarks.peers import single_threaded

__all__ = ["WarmWorkbook", "warm_workbooks"]

EXAMPLES = ("example_proposed.xlsx", "example_backlash.xlsx")
HERE = Path(__file__).resolve()


@dataclass(frozen=True)
class WarmWorkbook:
    """One workbook recalculated in a running process.

    Parameters
    ----------
    label : str
        Which. [text]
    seconds : dict of str to float
        Median processor time by source tree. [s]
    rounds : int
        How often. [count]
    """

    label: str
    seconds: dict[str, float]
    rounds: int


def warm_workbooks(rounds: int, trees: Mapping[str, Path] | None = None) -> list[WarmWorkbook]:
    """Measure the shipped examples, without results and with.

    Parameters
    ----------
    rounds : int
        How often each is recalculated after two times that only warm up. [count]
    trees : mapping of str to Path, optional
        Source trees by the words that name them; by default this one.
    """
    trees = trees or {"this": HERE.parents[1]}
    workers = {name: _worker(tree) for name, tree in trees.items()}
    spent: dict[str, dict[str, list[float]]] = {}
    try:
        for round_ in range(-2, rounds):
            for name, worker in workers.items():
                assert worker.stdin is not None
                assert worker.stdout is not None
                print(file=worker.stdin, flush=True)
                for label, seconds in json.loads(worker.stdout.readline()).items():
                    if round_ >= 0:
                        spent.setdefault(label, {}).setdefault(name, []).append(seconds)
    finally:
        for worker in workers.values():
            worker.communicate()
    return [
        WarmWorkbook(label, {name: median(times) for name, times in found.items()}, rounds)
        for label, found in spent.items()
    ]


def _worker(tree: Path) -> subprocess.Popen[str]:
    """A process that measures all rows once for each line it is given."""
    return subprocess.Popen(
        [sys.executable, str(HERE), "--measure"],
        env=os.environ | single_threaded() | {"PYTHONPATH": str(tree)},
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )


def _measure() -> None:
    with tempfile.TemporaryDirectory() as folder:
        target = Path(folder) / "results.xlsx"
        sources = {}
        for example in EXAMPLES:
            shipped = Path(shutil.copy(template_path(example), folder))
            calculated = shipped.with_name(f"calculated_{example}")
            recalculate(shipped, destination=calculated)
            sources |= {f"{example}, as shipped": shipped, f"{example}, calculated": calculated}
        for _ in sys.stdin:
            found = {}
            for label, source in sources.items():
                began = time.process_time()
                done = recalculate(source, destination=target)
                found[label] = time.process_time() - began
                if done.calculation is None:
                    raise RuntimeError("; ".join(p.message for p in done.problems))
            print(json.dumps(found), flush=True)


def _show(arguments: list[str]) -> None:
    rounds = int(arguments[0]) if arguments else 9
    trees = {"this": HERE.parents[1]}
    if len(arguments) > 1:
        trees["other"] = Path(arguments[1])
    for row in warm_workbooks(rounds, trees):
        times = "   ".join(
            f"{name} {1e3 * seconds:6.1f} ms" for name, seconds in row.seconds.items()
        )
        print(f"{row.label:<40}{times}")


if __name__ == "__main__":
    _measure() if sys.argv[1:] == ["--measure"] else _show(sys.argv[1:])
