"""Processes of this machine that do tasks; one that dies loses nothing.

Each process has a line of its own, so that it is known which task a dead one had: that task is given
to another once more, and if it dies again it is answered by `Crashed`. Processes end as soon as the
batch does, however it ends.
"""

from __future__ import annotations

import contextlib
import gc
import signal
from collections import deque
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait
from typing import Any

from addin.workers.processes import Process

#: How often it is looked whether the batch is to stop. [s]
LOOK = 0.2
#: How often a task is begun in all, when the processes that had it died. [count]
ATTEMPTS = 2
#: When garbage is looked for within a task: far less often than Python does of itself. [counts]
_GARBAGE = (200_000, 10, 10)


@dataclass(frozen=True)
class Task:
    """Something to do."""

    #: What is called with the payload, in another process: a function of a module.
    do: Callable[[Any], Any]
    payload: Any  #: What it works on; can be pickled, and so can the answer.
    tag: Any = None  #: For the caller; it stays here.


@dataclass(frozen=True)
class Crashed:
    """The answer to a task whose processes died."""

    sentence: str  #: What is known of it.


class Workers:
    """What does tasks: a pool of processes or a cluster.

    Tasks are added at any time, also while answers are taken.
    """

    def add(self, task: Task) -> None:
        """Put a task at the end of the queue."""
        raise NotImplementedError

    def answers(self, stopped: Callable[[], bool]) -> Iterator[tuple[Task, Any]]:
        """Each task with its answer, as they come, until nothing is left to do."""
        raise NotImplementedError

    #: Whether they are on this machine. [flag]
    here = True

    @property
    def threads(self) -> int:
        """Tasks that are done at a time. [count]"""
        return 1

    def close(self) -> None:
        """Give up what is not done."""
        raise NotImplementedError


class Pool(Workers):
    """Processes on this machine.

    Parameters
    ----------
    processes : int
        How many. [count]
    """

    def __init__(self, processes: int) -> None:
        self._most = processes
        self._waiting: deque[tuple[Task, int]] = deque()
        self._processes: list[_Process] = []

    def add(self, task: Task) -> None:
        """Put a task at the end of the queue; see `Workers`."""
        self._waiting.append((task, 1))

    def answers(self, stopped: Callable[[], bool]) -> Iterator[tuple[Task, Any]]:
        """Each task with its answer; see `Workers`."""
        while True:
            if not stopped():
                self._hand_out()
            busy = [one for one in self._processes if one.task is not None]
            if not busy:
                if stopped() or not self._waiting:
                    return
                continue
            for line in wait([one.line for one in busy], LOOK):
                process = next(one for one in busy if one.line is line)
                yield from self._answered(process)

    def _hand_out(self) -> None:
        """Give waiting tasks to idle processes, of which new ones are started as needed."""
        while self._waiting:
            idle = next((one for one in self._processes if one.task is None), None)
            if idle is None and len(self._processes) >= self._most:
                return
            if idle is None:
                idle = _Process()
                self._processes.append(idle)
            task, attempt = self._waiting.popleft()
            if not idle.give(task, attempt):  # it died meanwhile
                self._processes.remove(idle)
                self._waiting.appendleft((task, attempt))

    def _answered(self, process: _Process) -> Iterator[tuple[Task, Any]]:
        task, attempt = process.task, process.attempt
        assert task is not None
        try:
            answer = process.line.recv()
        except (EOFError, OSError):
            self._processes.remove(process)
            how = process.last_words()
            if attempt < ATTEMPTS:
                self._waiting.appendleft((task, attempt + 1))
                return
            answer = Crashed(how)
        process.task = None
        yield task, answer

    def close(self) -> None:
        """End every process, whatever it does."""
        self._waiting.clear()
        for process in self._processes:
            process.end()
        self._processes.clear()

    @property
    def threads(self) -> int:
        """Processes; see `Workers`. [count]"""
        return self._most

    @property
    def process_ids(self) -> list[int]:
        """Numbers of the processes. [count]"""
        return [one.pid for one in self._processes]


class _Process(Process):
    """One of the pool, and its task."""

    def __init__(self) -> None:
        super().__init__(_serve)
        self.task: Task | None = None
        self.attempt = 0

    def give(self, task: Task, attempt: int) -> bool:
        try:
            self.line.send((task.do, task.payload))
        except OSError:
            self.end()
            return False
        self.task, self.attempt = task, attempt
        return True

    def last_words(self) -> str:
        """What is known of its end."""
        status = self.ended()
        if status is not None and status < 0:
            name = signal.Signals(-status).name if -status in set(signal.Signals) else str(-status)
            return f"the process that calculated it was ended by {name}"
        return f"the process that calculated it ended by itself (exit status {status})"


# --- in the processes -----------------------------------------------------------------------------


def _serve(line: Connection) -> None:
    """Do one task after the other until the line ends."""
    settled = False
    while True:
        try:
            do, payload = line.recv()
        except (EOFError, OSError):
            return
        with contextlib.suppress(BrokenPipeError, OSError):
            line.send(do(payload))
        # Garbage is looked for between tasks, when little is there to look through.
        gc.collect()
        if not settled:
            gc.freeze()  # what is loaded now stays
            gc.set_threshold(*_GARBAGE)
            settled = True
