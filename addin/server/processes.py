"""Long calculations in processes of their own: queue, progress, time limit, cancel.

Each process is looked after by a thread that hands it one task at a time, passes its stages on and
ends it when the task is cancelled or takes too long; a new process then takes its place. Processes
end when the server is gone, however it went.
"""

from __future__ import annotations

import contextlib
import logging
import pickle
import queue
import threading
import time
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import Future
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

from addin.calculation.calculation import calculate
from addin.reading.one_file import WORKBOOK_ENDINGS, Unreadable, file_problem, read_checked
from addin.reading.typed_case import CaseInput
from addin.reading.workbook import read_workbook
from addin.server.settings import OURS
from addin.server.studies import study_of
from addin.server.view import speed_view
from addin.workers.processes import LAST_WORDS, Process, most_resident
from addin.worksheet.answers import speed_results
from addin.worksheet.models import Model, system_of
from addin.worksheet.registry import FunctionError
from addin.writing.recalculate import recalculate
from addin.xlsx import open_workbook
from addin.xlsx.container import Container, Limits
from addin.xlsx.errors import PackageError
from engine.errors import InternalError, ModelError

LOG = logging.getLogger("torsionbook.server")
#: How often a thread looks whether its task is still wanted. [s]
LOOK = 0.05
#: How long a new process may take until it is ready; no task's time. [s]
START_TIME = 120.0
#: A process that has used more memory than this is replaced after its task. [B]
MOST_MEMORY = 1_200_000_000
#: What is told when the server ends.
STOPPING = "The server is being stopped. Try again in a minute."


class Busy(Exception):
    """No more calculations can wait; the sentence says so."""


class TooLong(Exception):
    """A calculation took longer than allowed; the sentence says so."""


class Cancelled(Exception):
    """Nobody wants the result any more."""


class LazyTables(Mapping[str, Any]):
    """Tables of a large train: millions of numbers that are unpacked only where they are asked for.

    Parameters
    ----------
    tables : dict of str to bytes
        Pickled by a process of our own.
    """

    def __init__(self, tables: dict[str, bytes]) -> None:
        self._tables = tables

    def __getitem__(self, name: str) -> Any:
        return pickle.loads(self._tables[name])

    def __iter__(self) -> Iterator[str]:
        return iter(self._tables)

    def __len__(self) -> int:
        return len(self._tables)


class _Died(Exception):
    """A process ended by itself.

    Parameters
    ----------
    has_spoken : bool
        Whether it had told a stage of its task. [flag]
    """

    def __init__(self, has_spoken: bool) -> None:
        super().__init__()
        self.has_spoken = has_spoken


class Job:
    """One task, waiting, running or done.

    Parameters
    ----------
    task : str
        One of `TASKS`. [name]
    payload : object
        What it works on.
    """

    def __init__(self, task: str, payload: Any) -> None:
        self.task = task
        self.payload = payload
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

    def told(self, stage: str) -> None:
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
        """Whether it was given up."""
        return self._cancelled.is_set()


class Work:
    """A pool of processes with a bounded queue.

    Parameters
    ----------
    processes : int
        How many calculate at a time. [count]
    waiting : int
        How many tasks may wait. [count]
    time_limit : float
        Longest time of one task, waiting not counted. [s]
    """

    def __init__(self, processes: int, waiting: int, time_limit: float) -> None:
        self._queue: queue.Queue[Job | None] = queue.Queue()
        self._most = waiting
        self._time_limit = time_limit
        self._closed = False
        self._threads = [
            threading.Thread(target=self._look_after, name=f"torsionbook-{i}", daemon=True)
            for i in range(processes)
        ]
        for thread in self._threads:
            thread.start()

    def submit(self, task: str, payload: Any) -> Job:
        """Put a task at the end of the queue.

        Raises
        ------
        Busy
            If too many wait already.
        """
        if self._closed:
            raise Busy(STOPPING)
        wanted = [job for job in list(self._queue.queue) if job is not None and not job.cancelled]
        if len(wanted) >= self._most:
            raise Busy(
                f"The server has {self._most} calculations waiting already. Try again in a minute."
            )
        job = Job(task, payload)
        self._queue.put(job)
        return job

    def stop(self) -> None:
        """Give up what runs and what waits; whoever waits is told why."""
        self._closed = True
        while True:
            try:
                job = self._queue.get_nowait()
            except queue.Empty:
                break
            if job is not None and job.future.set_running_or_notify_cancel():
                job.future.set_exception(Busy(STOPPING))

    def close(self) -> None:
        """End every process; what waits is given up."""
        self.stop()
        for _ in self._threads:
            self._queue.put(None)
        for thread in self._threads:
            thread.join(LAST_WORDS + 1.0)

    # ---- in the threads --------------------------------------------------------------------------

    def _look_after(self) -> None:
        """The life of one process and its successors."""
        process: _Process | None = None
        with contextlib.suppress(OSError):  # tried again with the first task, which is told why
            process = _Process()
        while (job := self._queue.get()) is not None:
            if not job.future.set_running_or_notify_cancel():
                continue
            try:
                for is_last in (False, True):
                    if process is None or process.leaving or not process.is_alive:
                        process = _successor(process)
                    try:
                        job.future.set_result(self._done(process, job))
                        break
                    except _Died as wrong:
                        # one that died before its first word was perhaps dead already
                        if wrong.has_spoken or is_last:
                            raise RuntimeError(
                                "The process that calculated this ended by itself, perhaps for want "
                                "of memory. Try again; if it happens again, please report it."
                            ) from None
            except BaseException as wrong:
                job.future.set_exception(wrong)
        if process is not None:
            process.end()

    def _done(self, process: _Process, job: Job) -> Any:
        """The result of a task; the process is ended where it goes on without us."""
        began = time.monotonic()
        has_spoken = False
        try:
            process.line.send((job.task, job.payload))
            while True:
                if job.cancelled or self._closed:
                    process.end()
                    raise Cancelled if job.cancelled else Busy(STOPPING)
                if time.monotonic() - began > (self._time_limit if process.ready else START_TIME):
                    process.end()
                    raise TooLong(
                        f"The calculation took longer than the {self._time_limit:g} s this server "
                        "allows, and was stopped. Ask for less accuracy, or calculate it on your own "
                        "machine."
                    )
                if not process.line.poll(LOOK):
                    continue
                kind, value = process.line.recv()
                if kind == "stage":
                    has_spoken = True
                    job.told(value)
                elif kind == "ready":
                    process.ready, began = True, time.monotonic()
                elif kind == "leaving":
                    process.leaving = True
                elif kind == "done":
                    return value
                elif kind == "refused":
                    raise FunctionError(*value)
                else:
                    LOG.error("task %s failed:\n%s", job.task, value)
                    raise RuntimeError(OURS)
        except (EOFError, OSError) as wrong:
            process.end()
            LOG.error("the process of task %s ended by itself (%r)", job.task, wrong)
            raise _Died(has_spoken) from None


class _Process(Process):
    """One of the pool; ready once it has loaded what every task needs, leaving with its last answer."""

    def __init__(self) -> None:
        super().__init__(_serve)
        self.ready = False
        self.leaving = False


def _successor(process: _Process | None) -> _Process:
    """A new process in the place of one that has ended, or could not be started."""
    if process is not None:
        process.end()
    try:
        return _Process()
    except OSError as wrong:
        LOG.error("no process could be started: %s", wrong)
        raise RuntimeError(
            "The server could not start a process to calculate this. Try again in a minute; its log "
            "says why."
        ) from None


# --- in the processes -----------------------------------------------------------------------------


def _serve(line: Connection) -> None:
    """Do one task after the other until the line ends."""
    with contextlib.suppress(BrokenPipeError, OSError):
        line.send(("ready", None))
    while True:
        try:
            task, payload = line.recv()
        except (EOFError, OSError):
            return
        answer = _answer(task, payload, line)
        is_last = most_resident() > MOST_MEMORY  # it goes back to the system only with the process
        with contextlib.suppress(BrokenPipeError, OSError):
            if is_last:
                line.send(("leaving", None))
            line.send(answer)
        if is_last:
            return


def _answer(task: str, payload: Any, line: Connection) -> tuple[str, Any]:
    try:
        return "done", TASKS[task](payload, lambda stage: line.send(("stage", stage)))
    except FunctionError as wrong:
        return "refused", (wrong.message, wrong.code)
    except (ModelError, InternalError) as wrong:
        return "refused", (str(wrong), "#NUM!")
    except Exception:
        import traceback

        return "failed", traceback.format_exc()


def _start(case: Any, tell: Callable[[str], None]) -> Any:
    """Everything a case calls for."""
    return calculate(case, on_stage=tell)


def _workbook(paths: tuple[str, str], tell: Callable[[str], None]) -> Any:
    """Recalculate a workbook; problems, warnings and the verdict."""
    source, target = map(Path, paths)
    tell("reading")
    try:
        Container(source, _limits())
    except PackageError as wrong:
        return (file_problem(source, wrong),), ()
    done = recalculate(source, destination=target, on_stage=tell)
    return done.problems, done.warnings


def _read(path: str, tell: Callable[[str], None]) -> Any:
    """Read a workbook or a case JSON; problems, warnings, the case and its units."""
    source = Path(path)
    tell("reading")
    try:
        read: CaseInput | Unreadable
        if source.suffix.lower() in WORKBOOK_ENDINGS:
            read = read_workbook(open_workbook(source, read_only=True, limits=_limits()))
        else:
            read = read_checked(source)
    except (PackageError, OSError) as wrong:
        return (file_problem(source, wrong),), (), None, ""
    if isinstance(read, Unreadable) or read.problems:
        return read.problems, read.warnings, None, ""
    return (), read.warnings, read.case(), system_of(read)


def _limits() -> Any:
    """What is taken for a workbook here: less than on a machine of one's own."""
    return Limits(file_size=25 * 2**20, total_size=100 * 2**20, part_size=60 * 2**20, entries=2_000)


def _speed(case: Any, tell: Callable[[str], None]) -> Any:
    """Tables of a case that need no start, each packed by itself."""
    tell("frequencies")
    return LazyTables({name: pickle.dumps(table) for name, table in speed_results(case).items()})


def _view(model: tuple[str, Any, str], tell: Callable[[str], None]) -> Any:
    """What the page draws of a model without its start."""
    tell("frequencies")
    return speed_view(Model(*model))


def _study(asked: Any, tell: Callable[[str], None]) -> Any:
    """A study of a case; see `addin.server.studies`."""
    return study_of(asked, tell)


def _wait(seconds: float, tell: Callable[[str], None]) -> float:
    """Be busy for a while: for measurements and tests of the pool."""
    tell("waiting")
    until = time.monotonic() + seconds
    while time.monotonic() < until:
        sum(range(1000))
    return seconds


#: What the processes can do, by name.
TASKS: dict[str, Callable[[Any, Callable[[str], None]], Any]] = {
    "start": _start,
    "workbook": _workbook,
    "read": _read,
    "speed": _speed,
    "view": _view,
    "study": _study,
    "wait": _wait,
}
