"""Tasks on an existing Dask cluster.

The same tasks as on this machine, given to the cluster a few at a time. A worker that dies loses
nothing: the cluster gives its tasks to others.
"""

from __future__ import annotations

import contextlib
import threading
import uuid
from collections.abc import Callable, Iterator
from typing import Any

from addin.workers.pool import Answered, Crashed, Task, Workers
from addin.workers.stop import Stopped

#: How long the scheduler and a first worker are waited for. [s]
PATIENCE = 20.0


class ClusterRefused(Exception):
    """The cluster cannot be used; the sentence says why."""


class Cluster(Workers):
    """Workers of a Dask cluster.

    Parameters
    ----------
    address : str
        Of the scheduler, such as ``tcp://10.0.0.5:8786``. [address]
    version : callable
        The version of the program, as text; asked here and by each worker.
    patience : float
        How long it is waited for. [s]
    when_lost : str
        The message where the scheduler is lost during the work. [sentences]

    Raises
    ------
    ClusterRefused
        If it cannot be reached, has no workers, or they have another version of torsionbook.
    """

    here = False
    ahead = 3

    def __init__(
        self,
        address: str,
        version: Callable[[], str],
        patience: float = PATIENCE,
        when_lost: str = "Nothing was written.",
    ) -> None:
        super().__init__()
        try:
            from distributed import Client
        except ImportError:
            raise ClusterRefused(
                "The packages for a cluster are not installed. Run pip install -r "
                "requirements/cluster.txt in the checkout, or install the wheel with its extra [cluster]."
            ) from None
        try:
            self._client = Client(address, timeout=patience, set_as_default=False)
            self._client.wait_for_workers(1, timeout=patience)
        except (OSError, ValueError, TimeoutError) as wrong:
            with contextlib.suppress(AttributeError):
                self._client.close(timeout=1)
            raise ClusterRefused(
                f"The Dask scheduler at {address} is unreachable or has no workers ({wrong}). Start "
                "them, or check the address."
            ) from wrong
        self.address = address
        self._when_lost = when_lost
        self._check_versions(version)

    def _check_versions(self, version: Callable[[], str]) -> None:
        try:
            versions = self._client.run(version)
        except Exception as wrong:  # raised there, of any kind
            self.close()
            raise ClusterRefused(
                f"The workers of {self.address} cannot use torsionbook ({wrong}). Install it in their "
                "Python."
            ) from wrong
        other = {worker: its for worker, its in versions.items() if its != version()}
        if other:
            self.close()
            named = ", ".join(f"{worker} has {its}" for worker, its in other.items())
            raise ClusterRefused(
                f"The workers of the cluster have another version of torsionbook: {named}; this "
                f"computer has {version()}. Install the same version on both."
            )

    @property
    def threads(self) -> int:
        """Tasks that the cluster does at a time. [count]"""
        with self._unless_lost():
            return max(1, sum(self._client.nthreads().values()))

    def _begun(self, task: Task) -> Any:
        payload = self.prepare(task)
        if isinstance(payload, Answered):
            return payload
        key = f"torsionbook-{uuid.uuid4().hex}"
        with self._unless_lost():
            return self._client.submit(_alone, task.do, payload, key=key, pure=False)

    def prepare(self, task: Task) -> Any:
        """What is sent for a task; `Answered` where no worker is needed."""
        return task.payload

    def _answer(self, future: Any) -> Any:
        from distributed import KilledWorker

        if future.status == "error":
            problem = future.exception()
            if isinstance(problem, KilledWorker):
                return Crashed("workers stopped during the calculation")
            return Crashed(f"the cluster returned the error {problem!r}")
        with self._unless_lost():
            return future.result(timeout=PATIENCE * 30)

    @contextlib.contextmanager
    def _unless_lost(self) -> Iterator[None]:
        """Raise `Stopped` where the scheduler does not answer any more."""
        from distributed import CancelledError
        from distributed.client import ClosedClientError

        try:
            yield
        except (CancelledError, ClosedClientError, OSError, TimeoutError) as wrong:
            raise Stopped(
                f"Lost the connection to the Dask scheduler at {self.address}. {self._when_lost}"
            ) from wrong

    def close(self) -> None:
        """Give up what the cluster still has of this batch; the cluster goes on."""
        self._waiting.clear()
        futures = [future for _, future in self._running.values()]
        self._running.clear()
        with contextlib.suppress(Exception):  # the scheduler may be gone
            self._client.cancel(futures)
        with contextlib.suppress(Exception):
            self._client.close(timeout=5)


# --- in the workers -------------------------------------------------------------------------------

_ONE = threading.Lock()


def _alone(do: Callable[[Any], Any], payload: Any) -> Any:
    """A task; one at a time in a process, however many threads a worker has."""
    with _ONE:
        return do(payload)
