"""Recalculation when a file is saved.

Folders are looked at again and again, which works on every disk, those of a network included. A file
is taken when it has been the same at two looks and can be opened: programs save in several steps.
That somebody has it open does not matter, as long as the result is not open as well.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from pathlib import Path

from addin.batch.folder import stamp_of
from addin.batch.inputs import Input
from addin.batch.records import Stamp
from addin.batch.scheduler import Batch

#: Time between two looks. [s]
LOOK = 1.0
#: After this time a file that could not be calculated for a passing reason is tried again. [s]
TRY_AGAIN = 10.0
#: How often it is asked whether to stop. [s]
_ASK = 0.1


class Watch:
    """Files that are watched.

    Parameters
    ----------
    batch : Batch
        Calculates them.
    find : callable
        Returns the inputs that are there now; none if there are none.
    after : callable
        Called with the inputs that have been calculated, after each round.
    look : float
        Time between two looks. [s]
    """

    def __init__(
        self,
        batch: Batch,
        find: Callable[[], Sequence[Input]],
        after: Callable[[Sequence[Input]], None],
        look: float = LOOK,
    ) -> None:
        self._batch = batch
        self._find = find
        self._after = after
        self._look = look
        self._seen: dict[str, Stamp] = {}
        self._done: dict[str, Stamp] = {}
        self._retry: dict[str, float] = {}

    def run(self, first: Sequence[Input]) -> None:
        """Watch until the batch is asked to stop.

        Raises
        ------
        Abandoned, Stopped
            As of `Batch.process`.
        """
        for file in first:
            self._keep(file)
        while not self._batch.stop():
            ready = self.ready(self._find())
            if ready:
                for file in ready:
                    self._batch.records.pop(file.name, None)
                before = {file.name: _stamp(file.path) for file in ready}
                self._batch.process(ready)
                for file in ready:
                    self._keep(file, before[file.name])
                self._after(ready)
            until = time.monotonic() + self._look
            while not self._batch.stop() and time.monotonic() < until:
                time.sleep(_ASK)

    def ready(self, inputs: Sequence[Input]) -> list[Input]:
        """Files that were saved since they were calculated and rest now."""
        ready = []
        now = time.monotonic()
        for file in inputs:
            stamp = _stamp(file.path)
            before, self._seen[file.name] = self._seen.get(file.name), stamp  # type: ignore[assignment]
            if stamp is None or stamp != before:
                continue
            again = now >= self._retry.get(file.name, float("inf"))
            if (stamp != self._done.get(file.name) or again) and _opens(file.path):
                ready.append(file)
        return ready

    def _keep(self, file: Input, stamp: Stamp | None = None) -> None:
        """Remember in which state a file was calculated, and whether to try it again."""
        record = self._batch.records.get(file.name)
        self._retry.pop(file.name, None)
        if record is None:
            return
        self._done[file.name] = stamp or Stamp(record.stamp.size, record.stamp.modified, "")
        if not record.settled:
            self._retry[file.name] = time.monotonic() + TRY_AGAIN


def _stamp(path: Path) -> Stamp | None:
    try:
        return stamp_of(path)
    except OSError:  # just being replaced, or gone
        return None


def _opens(path: Path) -> bool:
    """Whether a file can be read now; on Windows a program that saves it may not let us."""
    try:
        with open(path, "rb") as file:
            file.read(1)
    except OSError:
        return False
    return True
