"""Units of work over processes or a cluster: in order, with progress, ended by Ctrl-C."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any, TypeVar

from addin.batch.pool import Crashed, Task, Workers

__all__ = ["Cancelled", "Spread", "UnitLost", "alone", "over_workers", "spread_over"]

Payload = TypeVar("Payload")
Answer = TypeVar("Answer")
#: Does a function of a module with each payload; answers in the order of the payloads. The last
#: argument is called with how many are done.
Spread = Callable[
    [Callable[[Any], Any], Sequence[Any], Callable[[int], None]],
    list[Any],
]
#: Units given to the workers before answers come back, a worker. [count]
AHEAD = 3


class Cancelled(Exception):
    """Ctrl-C: what was asked for is not there, and nothing is written."""


class UnitLost(Exception):
    """A process died twice with the same unit of work; the sentence says how."""


def alone(stopped: Callable[[], bool] = lambda: False) -> Spread:
    """Everything in this process.

    Parameters
    ----------
    stopped : callable, optional
        Asked before each unit.

    Returns
    -------
    Spread
        Raises `Cancelled` once stopped.
    """

    def spread(
        do: Callable[[Any], Any], payloads: Sequence[Any], done: Callable[[int], None]
    ) -> list[Any]:
        answers = []
        for number, payload in enumerate(payloads):
            if stopped():
                raise Cancelled
            done(number)
            answers.append(do(payload))
        done(len(payloads))
        return answers

    return spread


def over_workers(workers: Workers, stopped: Callable[[], bool] = lambda: False) -> Spread:
    """Over processes of this machine or a cluster.

    Parameters
    ----------
    workers : Workers
        What does tasks.
    stopped : callable, optional
        Asked all the time.

    Returns
    -------
    Spread
        Raises `Cancelled` once stopped, `UnitLost` when a unit ends its process twice.
    """

    def spread(
        do: Callable[[Any], Any], payloads: Sequence[Any], done: Callable[[int], None]
    ) -> list[Any]:
        answers: dict[int, Any] = {}
        waiting = iter(enumerate(payloads))
        done(0)
        for _ in range(AHEAD * workers.threads):
            _add(workers, do, waiting)
        for task, answer in workers.answers(stopped):
            if isinstance(answer, Crashed):
                raise UnitLost(answer.sentence)
            answers[task.tag] = answer
            done(len(answers))
            _add(workers, do, waiting)
        if len(answers) < len(payloads):
            raise Cancelled
        return [answers[number] for number in range(len(payloads))]

    return spread


def _add(workers: Workers, do: Callable[[Any], Any], waiting: Iterator[tuple[int, Any]]) -> None:
    for number, payload in waiting:
        workers.add(Task(do, payload, number))
        return


@contextmanager
def spread_over(
    jobs: int | None, scheduler: str | None, stopped: Callable[[], bool]
) -> Iterator[Spread]:
    """The cluster of an address, or processes, or this process where one is asked for.

    Parameters
    ----------
    jobs : int or None
        Processes; None = one a core, 1 = this one. [count]
    scheduler : str or None
        Address of a Dask cluster. [address]
    stopped : callable
        Asked all the time.

    Yields
    ------
    Spread

    Raises
    ------
    addin.batch.cluster.ClusterRefused
        If the cluster cannot be used.
    """
    from addin.batch.conductor import cores

    if scheduler is None and (jobs or cores()) == 1:
        yield alone(stopped)
        return
    workers: Workers
    if scheduler is not None:
        from addin.batch.cluster import Cluster

        workers = Cluster(scheduler)
    else:
        from addin.batch.pool import Pool

        workers = Pool(jobs or cores())
    try:
        yield over_workers(workers, stopped)
    finally:
        workers.close()
