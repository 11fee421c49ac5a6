"""Ctrl-C and the system's request to end, what led to an exception, and how many cores there are."""

from __future__ import annotations

import contextlib
import os
import signal
import threading
from collections.abc import Callable, Iterator
from types import FrameType


class Abandoned(Exception):
    """The second Ctrl-C: running files are cancelled."""


class Stopped(Exception):
    """The batch cannot go on; the sentence says why."""


class Stop:
    """Ctrl-C and the system's request to end, counted.

    Once: what runs is finished. Twice: it is cancelled, without half a result.
    """

    def __init__(self) -> None:
        self.asked = 0
        self.reason = ""

    def __call__(self) -> bool:
        """Whether nothing new is to be begun.

        Raises
        ------
        Abandoned
            If it was asked twice.
        """
        if self.asked > 1:
            raise Abandoned
        return self.asked > 0 or bool(self.reason)

    @contextlib.contextmanager
    def listening(self, tell: Callable[[str], None]) -> Iterator[None]:
        """Answer Ctrl-C and SIGTERM from now on."""

        def asked(number: int, frame: FrameType | None) -> None:
            self.asked += 1
            tell(
                "Stopping after the current calculations. Press Ctrl-C again to cancel them."
                if self.asked == 1
                else "Cancelling the current calculations."
            )

        if threading.current_thread() is not threading.main_thread():
            yield
            return
        before = {
            number: signal.signal(number, asked) for number in (signal.SIGINT, signal.SIGTERM)
        }
        try:
            yield
        finally:
            for number, handler in before.items():
                signal.signal(number, handler)


def causes(error: BaseException) -> Iterator[BaseException]:
    """An exception and those that led to it."""
    cause: BaseException | None = error
    while cause is not None:
        yield cause
        cause = cause.__cause__ or cause.__context__


def cores() -> int:
    """Cores this process may use."""
    try:
        return len(os.sched_getaffinity(0))
    except AttributeError:  # not on every system
        return os.cpu_count() or 1
