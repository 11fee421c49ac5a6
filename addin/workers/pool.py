"""Processes of this machine that do tasks: progress, time limit, cancel; one that dies is replaced.

Each task is watched by a thread, which passes its stages on and ends its process when the task is
given up or takes too long. A process that dies before its first word was perhaps dead already: its
task is given to another once more. Processes end as soon as the program does, however it ends.
"""

from __future__ import annotations

import contextlib
import gc
import queue
import signal
import threading
import time
from collections import OrderedDict, deque
from collections.abc import Callable, Iterator
from concurrent.futures import Future
from dataclasses import dataclass
from functools import partial
from itertools import count
from multiprocessing.connection import Connection
from typing import Any

from addin.workers.processes import LAST_WORDS, Process, most_resident

#: How often it is looked whether to stop. [s]
LOOK = 0.2
#: How often a thread looks whether its task is still wanted. [s]
WANTED = 0.05
#: How often a task is begun in all, when the processes that had it died. [count]
ATTEMPTS = 2
#: How long a new process may take until it is ready; no task's time. [s]
START_TIME = 120.0
#: When garbage is looked for within a task: far less often than Python does of itself. [counts]
_GARBAGE = (200_000, 10, 10)


class Died(Exception):
    """A process ended by itself; the words say how.

    Parameters
    ----------
    how : str
        What is known of its end. [words]
    has_spoken : bool
        Whether it had told a stage of its task. [flag]
    """

    def __init__(self, how: str, has_spoken: bool) -> None:
        super().__init__(how)
        self.has_spoken = has_spoken


class TimeIsUp(Exception):
    """A task took longer than it may, and was stopped."""


class GivenUp(Exception):
    """Nobody wants the answer any more."""


class Closed(Exception):
    """The pool is being closed, and nothing more is done."""


@dataclass(frozen=True)
class Task:
    """Something to do."""

    #: What is called with the payload, in another process: a function of a module.
    do: Callable[..., Any]
    payload: Any  #: What it works on; can be pickled, and so can the answer.
    tag: Any = None  #: For the caller; it stays here.
    has_stages: bool = False  #: Whether `do` takes, second, a function that it tells its stages.
    #: Longest time, waiting not counted; None where it may take as long as it needs. [s]
    time_limit: float | None = None
    owner: str = ""  #: Who asks. Those who ask take turns. [name]


@dataclass(frozen=True)
class Crashed:
    """The answer to a task whose processes died."""

    sentence: str  #: What is known of it.


@dataclass(frozen=True)
class Answered:
    """In place of a task that was begun: its answer, known without any worker."""

    answer: Any


class Workers:
    """What does tasks: a pool of processes or a cluster.

    Tasks are added at any time, also while answers are taken.
    """

    #: Whether they are on this machine. [flag]
    here = True
    #: Tasks that are handed out, for each that is done at a time. [count]
    ahead = 1

    def __init__(self) -> None:
        self._waiting: deque[Task] = deque()
        self._running: dict[int, tuple[Task, Any]] = {}
        self._done: queue.SimpleQueue[int] = queue.SimpleQueue()
        self._numbers = count()

    @property
    def threads(self) -> int:
        """Tasks that are done at a time. [count]"""
        return 1

    def add(self, task: Task) -> None:
        """Put a task at the end of the queue."""
        self._waiting.append(task)

    def answers(self, stopped: Callable[[], bool]) -> Iterator[tuple[Task, Any]]:
        """Each task with its answer, as they come, until nothing is left to do."""
        while True:
            if not stopped():
                yield from self._hand_out()
            if not self._running:
                if stopped() or not self._waiting:
                    return
                continue
            with contextlib.suppress(queue.Empty):
                number = self._done.get(timeout=LOOK)
                task, future = self._running[number]
                if not future.done():  # a cluster does again what a dead worker took with it
                    future.add_done_callback(partial(self._note, number))
                    continue
                del self._running[number]
                yield task, self._answer(future)

    def _hand_out(self) -> Iterator[tuple[Task, Any]]:
        """Begin as many tasks as keep the workers busy; what needs no worker is answered."""
        while self._waiting and len(self._running) < self.ahead * self.threads:
            task = self._waiting.popleft()
            future = self._begun(task)
            if isinstance(future, Answered):
                yield task, future.answer
                continue
            number = next(self._numbers)
            self._running[number] = task, future
            future.add_done_callback(partial(self._note, number))

    def _note(self, number: int, future: Any) -> None:
        self._done.put(number)

    def _begun(self, task: Task) -> Any:
        """The future of a task given to the workers, or `Answered`."""
        raise NotImplementedError

    def _answer(self, future: Any) -> Any:
        """The answer of a future that is done; `Crashed` where processes died with the task."""
        raise NotImplementedError

    def close(self) -> None:
        """Give up what is not done."""
        raise NotImplementedError


class Job:
    """A task of a pool: waiting, running or done.

    Parameters
    ----------
    task : Task
        What is to be done.
    """

    def __init__(self, task: Task) -> None:
        self.task = task
        self.future: Future[Any] = Future()
        self.stage = "waiting for a free process"
        self._listeners: list[Callable[[str], None]] = []
        self._cancelled = threading.Event()
        self._lock = threading.Lock()

    def listen(self, tell: Callable[[str], None]) -> Callable[[], None]:
        """Be told every stage from now on, the present one at once."""
        with self._lock:
            self._listeners.append(tell)
            tell(self.stage)

        def leave() -> None:
            with self._lock, contextlib.suppress(ValueError):
                self._listeners.remove(tell)

        return leave

    def tell(self, stage: str) -> None:
        """Pass a stage on to the listeners."""
        with self._lock:
            self.stage = stage
            for tell in self._listeners:
                tell(stage)

    def cancel(self) -> None:
        """Give the task up, whether it waits or runs."""
        self._cancelled.set()
        self.future.cancel()

    @property
    def cancelled(self) -> bool:
        """Whether it was cancelled."""
        return self._cancelled.is_set()

    @property
    def waits(self) -> bool:
        """Whether it is still to be begun."""
        return not (self.future.running() or self.future.done())


class JobQueue:
    """Jobs that wait: those who ask take turns, and the jobs of each keep their order."""

    def __init__(self) -> None:
        self._jobs: OrderedDict[str, deque[Job]] = OrderedDict()
        self._ends = 0
        self._changed = threading.Condition()

    def put(self, job: Job | None) -> None:
        """Add a job; None ends one of those who get them, when no job is left."""
        with self._changed:
            if job is None:
                self._ends += 1
            else:
                self._jobs.setdefault(job.task.owner, deque()).append(job)
            self._changed.notify()

    def get(self) -> Job | None:
        """The next job, once there is one, or None at the end."""
        with self._changed:
            while not (self._jobs or self._ends):
                self._changed.wait()
            if not self._jobs:
                self._ends -= 1
                return None
            owner, jobs = self._jobs.popitem(last=False)
            job = jobs.popleft()
            if jobs:
                self._jobs[owner] = jobs  # behind all others
            return job


class Pool(Workers):
    """Processes on this machine, started as they are needed.

    Parameters
    ----------
    processes : int
        How many. [count]
    warm_up : callable, optional
        A function of a module, called in each process before its first task.
    most_memory : int, optional
        A process that has used more is replaced after its task. [B]
    """

    def __init__(
        self,
        processes: int,
        warm_up: Callable[[], None] | None = None,
        most_memory: int | None = None,
    ) -> None:
        super().__init__()
        self._serve = partial(_serve, warm_up=warm_up, most_memory=most_memory)
        self._jobs = JobQueue()
        self._idle: deque[_Process] = deque()
        self._is_closed = False
        self._threads = [
            threading.Thread(target=self._work, name=f"torsionbook-{i}", daemon=True)
            for i in range(processes)
        ]
        for thread in self._threads:
            thread.start()

    @property
    def threads(self) -> int:
        """Processes; see `Workers`. [count]"""
        return len(self._threads)

    def begin(self, task: Task) -> Job:
        """Put a task at the end of the queue of those that are begun as soon as a process is free."""
        job = Job(task)
        self._jobs.put(job)
        return job

    def _begun(self, task: Task) -> Future[Any]:
        return self.begin(task).future

    def _answer(self, future: Future[Any]) -> Any:
        try:
            return future.result()
        except Died as wrong:
            return Crashed(str(wrong))

    def start_processes(self) -> None:
        """Start every process before there is a task; one that cannot be started is tried again then."""
        with contextlib.suppress(OSError):
            for _ in self._threads:
                self._idle.append(_Process(self._serve))

    def stop(self) -> None:
        """Let what runs and what waits end with `Closed`."""
        self._is_closed = True

    def close(self) -> None:
        """End every process, whatever it does; see `stop`."""
        self.stop()
        for _ in self._threads:
            self._jobs.put(None)
        for thread in self._threads:
            thread.join(LAST_WORDS + 1.0)
        while self._idle:
            self._idle.pop().end()

    # ---- in the threads --------------------------------------------------------------------------

    def _work(self) -> None:
        """Take one job after the other."""
        while (job := self._jobs.get()) is not None:
            if job.future.set_running_or_notify_cancel():
                try:
                    job.future.set_result(self._result(job))
                except BaseException as wrong:
                    job.future.set_exception(wrong)

    def _result(self, job: Job) -> Any:
        """The result of a job.

        Raises
        ------
        Closed, Died, GivenUp, TimeIsUp
            If there is none.
        OSError
            If no process can be started.
        """
        for attempt in range(1, ATTEMPTS + 1):
            process = self._process()
            try:
                result = self._watched(process, job)
            except Died as wrong:
                if wrong.has_spoken or attempt == ATTEMPTS:
                    raise
            except BaseException:
                process.end()
                raise
            else:
                break
        if process.is_leaving:
            process.end()
        else:
            self._idle.append(process)
        return result

    def _process(self) -> _Process:
        """A process that has nothing to do, a new one if need be."""
        if self._is_closed:
            raise Closed
        with contextlib.suppress(IndexError):
            while not (process := self._idle.pop()).is_alive:
                process.end()
            return process
        return _Process(self._serve)

    def _watched(self, process: _Process, job: Job) -> Any:
        """The answer of a process to a task."""
        task, began, has_spoken = job.task, time.monotonic(), False
        try:
            process.line.send((task.do, task.payload, task.has_stages))
            while True:
                if job.cancelled:
                    raise GivenUp
                if self._is_closed:
                    raise Closed
                limit = task.time_limit if process.is_ready else START_TIME
                if task.time_limit and limit and time.monotonic() - began > limit:
                    raise TimeIsUp
                if not process.line.poll(WANTED):
                    continue
                kind, value = process.line.recv()
                if kind == "done":
                    return value
                if kind == "stage":
                    has_spoken = True
                    job.tell(value)
                elif kind == "ready":
                    process.is_ready, began = True, time.monotonic()
                elif kind == "leaving":
                    process.is_leaving = True
        except (EOFError, OSError):
            raise Died(_last_words(process.ended()), has_spoken) from None


class _Process(Process):
    """One of the pool; ready once it is warmed up, leaving with its last answer."""

    is_ready = False
    is_leaving = False


def _last_words(status: int | None) -> str:
    """What is known of the end of a process, by its exit status."""
    if status is not None and status < 0:
        name = signal.Signals(-status).name if -status in set(signal.Signals) else str(-status)
        return f"{name} ended the calculation process"
    return f"the calculation process ended unexpectedly (exit status {status})"


# --- in the processes -----------------------------------------------------------------------------


def _serve(
    line: Connection, warm_up: Callable[[], None] | None = None, most_memory: int | None = None
) -> None:
    """Do one task after the other until the line ends."""
    if warm_up is not None:
        warm_up()
    with contextlib.suppress(BrokenPipeError, OSError):
        line.send(("ready", None))
    is_settled = False
    while True:
        try:
            do, payload, has_stages = line.recv()
        except (EOFError, OSError):
            return
        tell = (lambda stage: line.send(("stage", stage)),) if has_stages else ()
        answer = do(payload, *tell)
        # memory goes back to the system only with the process
        is_last = most_memory is not None and most_resident() > most_memory
        with contextlib.suppress(BrokenPipeError, OSError):
            if is_last:
                line.send(("leaving", None))
            line.send(("done", answer))
        if is_last:
            return
        # Garbage is looked for between tasks, when little is there to look through.
        gc.collect()
        if not is_settled:
            gc.freeze()  # what is loaded now stays
            gc.set_threshold(*_GARBAGE)
            is_settled = True
