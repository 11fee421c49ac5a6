"""Units of work over processes or a cluster, opened for one study and closed behind it."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from itertools import takewhile
from typing import Any

from addin.workers.cluster import Cluster
from addin.workers.parallel_map import Cancelled, ParallelMap, UnitLost, serial_map
from addin.workers.pool import Crashed, Pool, Task, Workers
from addin.workers.stop import cores


def pool_map(workers: Workers, stopped: Callable[[], bool] = lambda: False) -> ParallelMap:
    """Over processes of this machine or a cluster."""

    def parallel_map(
        do: Callable[[Any], Any], payloads: Sequence[Any], done: Callable[[int], None]
    ) -> list[Any]:
        answers: dict[int, Any] = {}
        done(0)
        for number, payload in enumerate(payloads):
            workers.add(Task(do, payload, number))
        for task, answer in workers.answers(stopped):
            if isinstance(answer, Crashed):
                raise UnitLost(answer.sentence)
            answers[task.tag] = answer
            done(len(answers))
        if len(answers) < len(payloads):
            # up to the first that is missing, so that which are there depends on none of them
            first = takewhile(answers.__contains__, range(len(payloads)))
            raise Cancelled([answers[number] for number in first])
        return [answers[number] for number in range(len(payloads))]

    return parallel_map


@contextmanager
def open_parallel_map(
    jobs: int | None, scheduler: str | None, version: Callable[[], str], stopped: Callable[[], bool]
) -> Iterator[ParallelMap]:
    """The cluster of an address, or processes, or this process where one is asked for.

    Parameters
    ----------
    jobs : int or None
        Processes; None = one a core, 1 = this one. [count]
    scheduler : str or None
        Address of a Dask cluster. [address]
    version : callable
        The version of the program, which the workers of a cluster must have too.
    stopped : callable
        Asked all the time.

    Raises
    ------
    addin.workers.cluster.ClusterRefused
        If the cluster cannot be used.
    """
    if scheduler is None and (jobs or cores()) == 1:
        yield serial_map(stopped)
        return
    workers: Workers
    if scheduler is not None:
        workers = Cluster(scheduler, version)
    else:
        workers = Pool(jobs or cores())
    try:
        yield pool_map(workers, stopped)
    finally:
        workers.close()
