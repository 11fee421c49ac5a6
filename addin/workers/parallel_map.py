"""Units of work in order, with progress, ended by Ctrl-C: what a study asks for, wherever it is done."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

#: Does a function of a module with each payload; answers in the order of the payloads. The last
#: argument is called with how many are done.
ParallelMap = Callable[[Callable[[Any], Any], Sequence[Any], Callable[[int], None]], list[Any]]


class Cancelled(Exception):
    """Ctrl-C: what was asked for is not there.

    Parameters
    ----------
    answers : sequence of object, optional
        Of the payloads before the first that has none.
    why : str, optional
        Why these are not enough to be written. [sentence]
    """

    def __init__(self, answers: Sequence[Any] = (), why: str = "") -> None:
        super().__init__(why)
        self.answers, self.why = list(answers), why


class UnitLost(Exception):
    """A process died twice with the same unit of work; the sentence says how."""


def serial_map(stopped: Callable[[], bool] = lambda: False) -> ParallelMap:
    """Everything in this process."""

    def parallel_map(
        do: Callable[[Any], Any], payloads: Sequence[Any], done: Callable[[int], None]
    ) -> list[Any]:
        answers: list[Any] = []
        for number, payload in enumerate(payloads):
            if stopped():
                raise Cancelled(answers)
            done(number)
            answers.append(do(payload))
        done(len(payloads))
        return answers

    return parallel_map


def map_until_cancelled(
    parallel_map: ParallelMap,
    do: Callable[[Any], Any],
    payloads: Sequence[Any],
    done: Callable[[int], None],
) -> list[Any]:
    """As `parallel_map`, but after Ctrl-C the answers of the first payloads, as many as there are."""
    try:
        return parallel_map(do, payloads, done)
    except Cancelled as cut:
        return cut.answers
