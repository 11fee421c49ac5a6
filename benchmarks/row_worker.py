"""A row of `benchmarks.goals_beside` inside either checkout: its code once, then laps on request.

Standard library only, apart from what the row itself imports. The first line says the code, which leaves `call` and
perhaps `told`; every other line for how many seconds to repeat the call.
"""

from __future__ import annotations

import json
import os
import resource
import sys
import time
from typing import Any


def main() -> None:
    """Answer until standard input closes."""
    answers = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)  # what a program prints is no answer
    scope: dict[str, Any] = {}
    for number, line in enumerate(sys.stdin):
        asked = json.loads(line)
        if number == 0:
            exec(asked, scope)
            answer: dict[str, Any] = {}
        else:
            answer = _laps(scope, asked)
        answers.write(json.dumps(answer) + "\n")
        answers.flush()


def _laps(scope: dict[str, Any], budget: float) -> dict[str, Any]:
    laps: list[tuple[float, float]] = []
    while not laps or sum(wall for wall, _ in laps) < budget:
        wall, cpu = time.perf_counter(), time.process_time()
        own = scope["call"]()
        took = time.perf_counter() - wall, time.process_time() - cpu
        laps.append(own if isinstance(own, tuple) else took)  # a call with processes says it itself
    most = 1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return {"laps": laps, "memory": most, "told": scope.get("told", str)()}


if __name__ == "__main__":
    main()
