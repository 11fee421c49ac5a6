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

    def __getattr__(self, name: str) -> Any:
        found = getattr(self.library, name)
        if not callable(found):
            return found

        def timed(*arguments: Any) -> Any:
            began = time.thread_time()
            try:
                return found(*arguments)
            finally:
                self.spent[name] = self.spent.get(name, 0.0) + time.thread_time() - began

        setattr(self, name, timed)
        return timed


def measured(call: Callable[[], object], watched: Watched) -> dict[str, Any]:
    """Share of the processor time of a call in the loops, and the loop with the most. [1]"""
    call()  # what is made on first use
    watched.spent.clear()
    began = time.process_time()
    while (took := time.process_time() - began) < BUDGET:
        call()
    name = max(watched.spent, key=watched.spent.__getitem__)
    share, largest = sum(watched.spent.values()) / took, watched.spent[name] / took
    return {"share": share, "largest": name, "of it": largest}


def in_loops(code: str) -> str:
    """A sentence about a row, measured in a process of its own."""
    words = [sys.executable, "-m", "benchmarks.loop_share"]
    done = subprocess.run(words, input=code, capture_output=True, text=True, check=True, cwd=ROOT)
    found = json.loads(done.stdout.splitlines()[-1])
    return f"{found['share']:.0%} of it in the compiled loops ({found['of it']:.0%} in {found['largest']})"


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
