"""How much of a row of `benchmarks.goals_beside` is spent in the compiled loops: what no work on Python can take off.

`python -m benchmarks.loop_share` reads the code of a row from standard input, which leaves `call`.
"""

from __future__ import annotations

import json
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from engine.stepping import library as compiled

ROOT = Path(__file__).resolve().parents[1]
#: Processor time of calls that are added up. [s]
BUDGET = 1.0


class Watched:
    """The library, each of whose functions adds its processor time."""

    def __init__(self, library: Any) -> None:
        self.library, self.spent = library, dict[str, float]()
        self.steps: list[list[int]] = []  #: Of each lane, a call of starts side by side.

    def __getattr__(self, name: str) -> Any:
        found = getattr(self.library, name)
        if not callable(found):
            return found

        def timed(*arguments: Any) -> Any:
            rows = _rows(*arguments[:2]) if name == "advance_starts" else []
            began = time.thread_time()
            try:
                return found(*arguments)
            finally:
                self.spent[name] = self.spent.get(name, 0.0) + time.thread_time() - began
                if len(rows) > 1:
                    after = _rows(*arguments[:2])
                    self.steps.append([b - a for a, b in zip(rows, after, strict=True)])

        setattr(self, name, timed)
        return timed


def _rows(lanes: int, plan: Any) -> list[int]:
    """Rows that each lane has written."""
    return list(compiled.ffi.unpack(plan.done, lanes))


def measured(call: Callable[[], object], watched: Watched) -> dict[str, Any]:
    """Share of the processor time of a call in the loops, and the loop with the most; of starts side by side the share of
    the lanes that was filled, and steps a lane. [1]"""
    call()  # what is made on first use
    watched.spent.clear()
    watched.steps.clear()
    began = time.process_time()
    while (took := time.process_time() - began) < BUDGET:
        call()
    name = max(watched.spent, key=watched.spent.__getitem__)
    share, largest = sum(watched.spent.values()) / took, watched.spent[name] / took
    longest = [max(steps) for steps in watched.steps]
    room = sum(len(steps) * most for steps, most in zip(watched.steps, longest, strict=True))
    filled = sum(map(sum, watched.steps)) / room if room else None
    return {
        "share": share, "largest": name, "of it": largest,
        "filled": filled, "steps": sum(longest) / len(longest) if longest else 0,
    }  # fmt: skip


def in_loops(code: str) -> str:
    """A sentence about a row, measured in a process of its own."""
    words = [sys.executable, "-m", "benchmarks.loop_share"]
    done = subprocess.run(words, input=code, capture_output=True, text=True, check=True, cwd=ROOT)
    found = json.loads(done.stdout.splitlines()[-1])
    words = f"{found['share']:.0%} of it in the compiled loops ({found['of it']:.0%} in {found['largest']})"
    if found["filled"]:
        words += f"; {found['filled']:.0%} of the lanes filled, {found['steps']:,.0f} steps a lane"
    return words


def main() -> None:
    """Measure the row of standard input."""
    compiled.library = watched = Watched(
        compiled.library
    )  # before any module of the engine takes it
    scope: dict[str, Any] = {}
    exec(sys.stdin.read(), scope)
    print(json.dumps(measured(scope["call"], watched)))


if __name__ == "__main__":
    main()
