"""What both sides of a peer share: the stopwatch, and one line of JSON a message.

Standard library only: workers import this file in an environment that holds a peer and nothing
of ours.
"""

from __future__ import annotations

import json
import os
import sys
import time
from collections.abc import Callable
from typing import Any, TextIO

Laps = list[list[float]]
"""Wall and processor seconds of each call."""


def timed(call: Callable[[], Any], budget: float, at_most: int) -> tuple[Any, Laps]:
    """Repeat a call until `budget` seconds are spent, at least once; last result and all times."""
    laps: Laps = []
    spent = 0.0
    while True:
        cpu, wall = time.process_time(), time.perf_counter()
        result = call()
        wall, cpu = time.perf_counter() - wall, time.process_time() - cpu
        laps.append([wall, cpu])
        spent += wall
        if spent >= budget or len(laps) >= at_most:
            return result, laps


def claim_output() -> TextIO:
    """Standard output for answers alone; what a peer prints goes to standard error from now on.

    To be called before the peer is imported: it may print while it is.
    """
    answers = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)
    return answers


def serve(
    answers: TextIO, hello: dict[str, Any], handlers: dict[str, Callable[..., dict[str, Any]]]
) -> None:
    """Answer requests from standard input until it closes."""

    def answer(content: dict[str, Any]) -> None:
        answers.write(json.dumps(content) + "\n")
        answers.flush()

    answer(hello)
    for line in sys.stdin:
        request = json.loads(line)
        try:
            answer(handlers[request.pop("do")](**request))
        except Exception as wrong:  # whatever a peer raises is a finding, not our failure
            answer({"failed": f"{type(wrong).__name__}: {' '.join(str(wrong).split())}"})
