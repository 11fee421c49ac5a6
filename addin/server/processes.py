"""Long calculations in a pool of processes: a bounded queue, and the server's words for its ends."""

from __future__ import annotations

import logging
import time
from collections.abc import Callable
from concurrent.futures import CancelledError, Future
from functools import partial
from typing import Any

from addin.server import tasks
from addin.server.metrics import TASK_TIME, TASKS, Metrics
from addin.server.settings import OURS
from addin.workers.pool import Closed, Died, GivenUp, Job, Pool, Task, TimeIsUp
from addin.worksheet.models import OWNER
from addin.worksheet.registry import FunctionError

LOG = logging.getLogger("torsionbook.server")
#: A process that has used more memory than this is replaced after its task. [B]
MOST_MEMORY = 1_200_000_000
#: How many times as many calculations as one client has may wait for all together. [1]
CLIENTS = 4
#: The message when the server ends.
STOPPING = "The server is being stopped. Try again in a minute."


def _end(future: Future[Any]) -> str:
    """What became of a task, in the words of `TASKS`."""
    wrong = CancelledError() if future.cancelled() else future.exception()
    if wrong is None:
        return "done"
    for kinds, word in _ENDS:
        if isinstance(wrong, kinds):
            return word
    return "failed"


class Busy(Exception):
    """No more calculations can wait; the sentence says so."""


class TooLong(Exception):
    """A calculation took longer than allowed; the sentence says so."""


_ENDS: tuple[tuple[tuple[type[BaseException], ...], str], ...] = (
    ((CancelledError, GivenUp, Busy), "cancelled"),
    ((FunctionError,), "refused"),
    ((TooLong,), "stopped"),
)


class Work(Pool):
    """A pool of processes with a bounded queue.

    Parameters
    ----------
    processes : int
        How many calculate at a time. [count]
    waiting : int
        How many tasks of one client may wait; `CLIENTS` times as many of all. [count]
    time_limit : float
        Longest time of one task, waiting not counted. [s]
    metrics : Metrics, optional
        Counts them.
    answer_of : callable
        What becomes of a task, asked in a process.
    """

    def __init__(
        self,
        processes: int,
        waiting: int,
        time_limit: float,
        metrics: Metrics | None = None,
        answer_of: Callable[[tuple[str, Any], tasks.Tell], tuple[str, Any]] = tasks.answer_of,
    ) -> None:
        super().__init__(processes, tasks.load, MOST_MEMORY)
        self._answer_of = answer_of
        self._metrics = metrics
        self._most = waiting
        self._time_limit = time_limit
        self._queue: list[Job] = []
        self.start_processes()

    def submit(self, name: str, payload: Any) -> Job:
        """Put a task, one of `addin.server.tasks.TASKS`, at the end of the queue.

        Raises
        ------
        Busy
            If too many wait already, of this client or of all.
        """
        if self._is_closed:
            raise Busy(STOPPING)
        owner = OWNER.get()
        self._queue = [job for job in self._queue if job.waits]
        for waiting, most in (
            (sum(job.task.owner == owner for job in self._queue), self._most),
            (len(self._queue), CLIENTS * self._most),
        ):
            if waiting >= most:
                raise Busy(
                    f"The server queue is full ({most} calculations). Try again in a minute."
                )
        job = self.begin(
            Task(
                self._answer_of,
                (name, payload),
                has_stages=True,
                time_limit=self._time_limit,
                owner=owner,
            )
        )
        self._queue.append(job)
        if self._metrics is not None:
            job.future.add_done_callback(partial(self._count, name, time.monotonic()))
        return job

    def waiting(self) -> int:
        """Tasks that wait for a process. [count]"""
        return sum(job.waits for job in self._queue)

    def _count(self, name: str, began: float, future: Future[Any]) -> None:
        assert self._metrics is not None
        self._metrics.count(TASKS, name, _end(future))
        self._metrics.took(TASK_TIME, time.monotonic() - began, name)

    def _result(self, job: Job) -> Any:
        """The result of a job, or why there is none in the server's words; see `Pool`."""
        name = job.task.payload[0]
        try:
            kind, value = super()._result(job)
        except Closed:
            raise Busy(STOPPING) from None
        except TimeIsUp:
            raise TooLong(
                f"The calculation exceeded the {self._time_limit:g} s allowed by this server and was "
                "stopped. Choose larger tolerances, or calculate it on your own computer."
            ) from None
        except Died as wrong:
            LOG.error("task %s: %s", name, wrong)
            raise RuntimeError(
                "The calculation process ended unexpectedly, perhaps because memory ran out. Try "
                "again; if it happens again, please report it."
            ) from None
        except OSError as wrong:
            LOG.error("no process could be started: %s", wrong)
            raise RuntimeError(
                "The server could not start a calculation process. Try again in a minute; the server "
                "log shows the reason."
            ) from None
        if kind == "refused":
            raise FunctionError(*value)
        if kind == "failed":
            LOG.error("task %s failed:\n%s", name, value)
            raise RuntimeError(OURS)
        return value
