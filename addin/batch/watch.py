"""Recalculation when a file is saved.

Folders are looked at again and again, which works on every disk, those of a network included. A file
is taken when it has been the same at two looks and can be opened: programs save in several steps.
That somebody has it open does not matter, as long as the result is not open as well.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
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


@dataclass
class Watch:
    """Files that are watched."""

    batch: Batch  #: Calculates them.
    #: Returns the inputs that are there now; none if there are none.
    find: Callable[[], Sequence[Input]]
    #: Called with the inputs that have been calculated, after each round.
    after: Callable[[Sequence[Input]], None]
    look: float = LOOK  #: Time between two looks. [s]
    #: State of each file at the last look, and when it was calculated.
    seen: dict[str, Stamp | None] = field(default_factory=dict)
    done: dict[str, Stamp] = field(default_factory=dict)
    #: When a file is tried again that could not be calculated for a passing reason. [s]
    retry: dict[str, float] = field(default_factory=dict)

    def run(self, first: Sequence[Input]) -> None:
        """Watch until the batch is asked to stop.

        Raises
        ------
        Abandoned, Stopped
            As of `Batch.process`.
        """
        for file in first:
            self._keep(file)
        while not self.batch.stop():
            ready = self.ready(self.find())
            if ready:
                for file in ready:
                    self.batch.records.pop(file.name, None)
                before = {file.name: _stamp(file.path) for file in ready}
                self.batch.process(ready)
                for file in ready:
                    self._keep(file, before[file.name])
                self.after(ready)
            until = time.monotonic() + self.look
            while not self.batch.stop() and time.monotonic() < until:
                time.sleep(_ASK)

    def ready(self, inputs: Sequence[Input]) -> list[Input]:
        """Files that were saved since they were calculated and rest now."""
        ready = []
        now = time.monotonic()
        for file in inputs:
            stamp = _stamp(file.path)
            before, self.seen[file.name] = self.seen.get(file.name), stamp
            if stamp is None or stamp != before:
                continue
            again = now >= self.retry.get(file.name, float("inf"))
            if (stamp != self.done.get(file.name) or again) and _opens(file.path):
                ready.append(file)
        return ready

    def _keep(self, file: Input, stamp: Stamp | None = None) -> None:
        """Remember in which state a file was calculated, and whether to try it again."""
        record = self.batch.records.get(file.name)
        self.retry.pop(file.name, None)
        if record is None:
            return
        self.done[file.name] = stamp or Stamp(record.stamp.size, record.stamp.modified, "")
        if not record.settled:
            self.retry[file.name] = time.monotonic() + TRY_AGAIN


def _stamp(path: Path) -> Stamp | None:
    try:
        return stamp_of(path)
    except OSError:  # just being replaced, or gone
        return None


def _opens(path: Path) -> bool:
    """Whether a file can be read now; on Windows a program that saves it may not let us.

    A pipe is not opened, which could take forever: the batch says what it is.
    """
    try:
        if not path.is_file():
            return True
        with open(path, "rb") as file:
            file.read(1)
    except OSError:
        return False
    return True
