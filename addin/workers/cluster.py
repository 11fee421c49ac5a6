"""The work of a batch on an existing Dask cluster.

The same tasks as on this machine, given to the cluster a few at a time. Files reach the workers by a
folder that they share with this machine, or as bytes; results come back the same way, and only this
machine records them and puts them in place. A worker that dies loses nothing: the cluster gives its
tasks to others.
"""

from __future__ import annotations

import contextlib
import queue
import threading
import uuid
from collections import deque
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

from addin.batch.folder import digest_of, stamp_of
from addin.batch.scheduler import Stopped
from addin.batch.work import Calculated, Examine, Work, is_locked, refused
from addin.workers.pool import LOOK, Crashed, Task, Workers

__all__ = ["Cluster", "ClusterRefused", "shared"]

#: How long the scheduler and a first worker are waited for. [s]
PATIENCE = 20.0
#: Tasks that are with the cluster, a thread of its workers. [count]
AHEAD = 3


class ClusterRefused(Exception):
    """The cluster cannot be used; the sentence says why."""


class Cluster(Workers):
    """Workers of a Dask cluster.

    Parameters
    ----------
    address : str
        Of the scheduler, such as ``tcp://10.0.0.5:8786``. [address]
    patience : float
        How long it is waited for. [s]
    when_lost : str
        What a user is told where the scheduler is gone in the middle. [sentences]

    Raises
    ------
    ClusterRefused
        If it cannot be reached, has no workers, or they have another version of torsionbook.
    """

    here = False

    def __init__(
        self,
        address: str,
        patience: float = PATIENCE,
        when_lost: str = "What was done is kept; run again with --resume.",
    ) -> None:
        try:
            from distributed import Client
        except ImportError:
            raise ClusterRefused(
                "The packages for a cluster are not installed: pip install 'torsionbook[cluster]'"
            ) from None
        try:
            self._client = Client(address, timeout=patience, set_as_default=False)
            self._client.wait_for_workers(1, timeout=patience)
        except (OSError, ValueError, TimeoutError) as wrong:
            with contextlib.suppress(AttributeError):
                self._client.close(timeout=1)
            raise ClusterRefused(
                f"The Dask scheduler at {address} cannot be used, or has no worker ({wrong}). Start "
                "them, or check the address."
            ) from wrong
        self.address = address
        self._when_lost = when_lost
        #: Whether files go to the workers as bytes.
        self.sends_bytes = False
        self._waiting: deque[Task] = deque()
        self._done: queue.SimpleQueue[Any] = queue.SimpleQueue()
        self._running: dict[str, tuple[Task, Any]] = {}
        self._check_versions()

    def _check_versions(self) -> None:
        from addin.contract.version import product_version

        try:
            found = self._client.run(_version)
        except Exception as wrong:  # raised there, of any kind
            self.close()
            raise ClusterRefused(
                f"The workers of {self.address} cannot use torsionbook ({wrong}). Install it in their "
                "Python."
            ) from wrong
        other = {worker: one for worker, one in found.items() if one != product_version()}
        if other:
            self.close()
            named = ", ".join(f"{worker} has {one}" for worker, one in other.items())
            raise ClusterRefused(
                f"The workers of the cluster have another version of torsionbook: {named}; here it is "
                f"{product_version()}. Install the same."
            )

    def shares(self, folder: Path, source: Path) -> bool:
        """Whether every worker sees a folder and a file of this machine under the same paths."""
        token = uuid.uuid4().hex
        probe = folder / "probe"
        probe.write_text(token, encoding="ascii")
        try:
            return all(self._client.run(shared, str(folder), token, str(source)).values())
        finally:
            for left in folder.glob("probe*"):
                left.unlink(missing_ok=True)

    @property
    def threads(self) -> int:
        """Tasks that the cluster does at a time. [count]"""
        return max(1, sum(self._client.nthreads().values()))

    def add(self, task: Task) -> None:
        """Put a task at the end of the queue; see `Workers`."""
        self._waiting.append(task)

    def answers(self, stopped: Callable[[], bool]) -> Iterator[tuple[Task, Any]]:
        """Each task with its answer; see `Workers`."""
        while True:
            if not stopped():
                yield from self._hand_out()
            if not self._running:
                if stopped() or not self._waiting:
                    return
                continue
            with contextlib.suppress(queue.Empty):
                key = self._done.get(timeout=LOOK)
                task, future = self._running.pop(key)
                yield task, self._answer(future)

    def _hand_out(self) -> Iterator[tuple[Task, Any]]:
        """Give tasks to the cluster, as many as keep it busy; what needs no cluster is answered."""
        while self._waiting and len(self._running) < AHEAD * self.threads:
            task = self._waiting.popleft()
            try:
                payload = _loaded(task.payload) if self.sends_bytes else task.payload
            except OSError as wrong:  # the file is not there, or somebody has it open
                yield task, _not_sent(task, wrong)
                continue
            key = f"torsionbook-{uuid.uuid4().hex}"
            future = self._client.submit(_alone, task.do, payload, key=key, pure=False)
            self._running[key] = (task, future)
            future.add_done_callback(lambda one: self._done.put(one.key))

    def _answer(self, future: Any) -> Any:
        from distributed import KilledWorker

        if future.status == "finished":
            try:
                return future.result(timeout=PATIENCE * 30)
            except (OSError, TimeoutError) as wrong:
                raise self._lost() from wrong
        if future.status != "error":  # cancelled or lost: the scheduler is gone
            raise self._lost()
        problem = future.exception()
        if isinstance(problem, KilledWorker):
            return Crashed("workers that calculated it died")
        return Crashed(f"the cluster answered with {problem!r}")

    def _lost(self) -> Stopped:
        return Stopped(f"The Dask scheduler at {self.address} is lost. {self._when_lost}")

    def close(self) -> None:
        """Give up what the cluster still has of this batch; the cluster goes on."""
        self._waiting.clear()
        futures = [future for _, future in self._running.values()]
        self._running.clear()
        with contextlib.suppress(Exception):  # the scheduler may be gone
            self._client.cancel(futures)
        with contextlib.suppress(Exception):
            self._client.close(timeout=5)


def _loaded(payload: Any) -> Any:
    """A task with its file as bytes."""
    if not isinstance(payload, (Work, Examine)):
        return payload
    if isinstance(payload, Work):
        locked = is_locked(payload)
        if locked is not None:
            raise _Locked(locked)
    path = Path(payload.source)
    stamp = replace(stamp_of(path), sha256=digest_of(path))
    return replace(payload, content=path.read_bytes(), stamp=stamp)


class _Locked(OSError):
    """Somebody has the file or its result open."""

    def __init__(self, cause: Exception) -> None:
        super().__init__(str(cause))
        self.cause = cause


def _not_sent(task: Task, wrong: OSError) -> Any:
    """The answer to a task whose file cannot be sent."""
    cause = wrong.cause if isinstance(wrong, _Locked) else wrong
    if isinstance(task.payload, Work):
        return Calculated(refused(task.payload, cause))
    return task.do(task.payload)


# --- in the workers -------------------------------------------------------------------------------

_ONE = threading.Lock()


def _alone(do: Callable[[Any], Any], payload: Any) -> Any:
    """A task; one at a time in a process, however many threads a worker has."""
    with _ONE:
        return do(payload)


def _version() -> str:
    from addin.contract.version import product_version

    return product_version()


def shared(folder: str, token: str, source: str) -> bool:
    """Whether this worker sees the folder and the file, and may write there."""
    place = Path(folder)
    try:
        if (place / "probe").read_text(encoding="ascii") != token:
            return False
        (place / f"probe-{uuid.uuid4().hex}").write_text(token, encoding="ascii")
        with open(source, "rb") as file:
            file.read(1)
    except OSError:
        return False
    return True
