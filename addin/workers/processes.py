"""Processes of our own on this machine, each with a line to it; none outlives the program.

They are spawned, so the same code runs on every system. Ctrl-C is the program's to answer, never
theirs; they end as soon as the program does, however it ends, even within a calculation.
"""

from __future__ import annotations

import multiprocessing
import os
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from pathlib import Path
from types import ModuleType

if sys.platform != "win32":
    from multiprocessing import resource_tracker

#: How long a process that is asked to end may take. [s]
LAST_WORDS = 2.0
#: How often a process whose program seems gone looks whether it is. [s]
LOOK = 0.2


_starting = threading.Lock()


@contextmanager
def _without_the_script() -> Iterator[None]:
    """A spawned process runs the script of its program once more, unless there is none to be seen.

    What is done in our processes is in our modules; a user's script without ``if __name__ == "__main__"``
    would begin its studies anew in each.
    """
    with _starting:
        script, safe = sys.modules["__main__"], os.environ.get("PYTHONSAFEPATH")
        sys.modules["__main__"] = ModuleType("__main__")
        # Else a pickle.py in the folder of the trains would be taken for that of Python.
        os.environ["PYTHONSAFEPATH"] = "1"
        try:
            yield
        finally:
            sys.modules["__main__"] = script
            if safe is None:
                del os.environ["PYTHONSAFEPATH"]
            else:
                os.environ["PYTHONSAFEPATH"] = safe


@contextmanager
def _untold_of_ctrl_c() -> Iterator[None]:
    """Ctrl-C waits for a process that begins now until it is deaf to it; else it dies, loudly, within its imports."""
    if sys.platform == "win32":
        yield
        return
    resource_tracker.ensure_running()  # which would lift the block
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


class Process:
    """A spawned process and the line to it.

    Parameters
    ----------
    serve : callable
        A function of a module; called in the process with the other end of the line, it does what is
        asked for until the line ends.
    """

    def __init__(self, serve: Callable[[Connection], None]) -> None:
        context = multiprocessing.get_context("spawn")
        self.line, child_end = context.Pipe()
        self._process: BaseProcess = context.Process(
            target=_begin, args=(serve, child_end), daemon=True
        )
        with _without_the_script(), _untold_of_ctrl_c():
            self._process.start()
        child_end.close()  # so that a process that ends is seen as the end of the line

    @property
    def pid(self) -> int:
        """Its number. [count]"""
        return self._process.pid or 0

    @property
    def is_alive(self) -> bool:
        """Whether it runs."""
        return self._process.is_alive()

    def end(self) -> None:
        """End it, whatever it does."""
        self.line.close()
        self._process.terminate()
        self._process.join(LAST_WORDS)
        if self._process.is_alive():
            self._process.kill()
            self._process.join()

    def ended(self) -> int | None:
        """Clear away one whose line has ended.

        Returns
        -------
        int or None
            Its exit status, of one ended by a signal the negative number of that; None if it had to
            be ended. [count]
        """
        self._process.join(LAST_WORDS)
        status = self._process.exitcode
        self.end()
        return status


def most_resident() -> int:
    """Largest resident memory this process has had.

    On Linux what `getrusage` says of a spawned process begins with that of its parent, so the kernel
    is asked for that of the program itself.

    Returns
    -------
    int
        0 where the system does not say. [B]
    """
    status = Path("/proc/self/status")
    if status.exists():
        for line in status.read_text(encoding="ascii", errors="replace").splitlines():
            if line.startswith("VmHWM"):
                return 1024 * int(line.split()[1])
    try:
        import resource
    except ImportError:  # Windows
        return 0
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak if sys.platform == "darwin" else 1024 * peak


@contextmanager
def bounded_memory(more: int) -> Iterator[None]:
    """Refuse this process memory beyond so much more than it has, with `MemoryError`; on Linux alone.

    Parameters
    ----------
    more : int
        How much. [B]
    """
    if sys.platform != "linux":
        yield
        return
    import resource

    soft, hard = resource.getrlimit(resource.RLIMIT_DATA)
    held = 0
    for line in (
        Path("/proc/self/status").read_text(encoding="ascii", errors="replace").splitlines()
    ):
        if line.startswith("VmData"):
            held = 1024 * int(line.split()[1])
    known = [limit for limit in (soft, hard) if limit != resource.RLIM_INFINITY]
    resource.setrlimit(resource.RLIMIT_DATA, (min([held + more, *known]), hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_DATA, (soft, hard))


# --- in the processes -----------------------------------------------------------------------------


def _begin(serve: Callable[[Connection], None], line: Connection) -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    if sys.platform != "win32":
        signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})
    _end_with_parent()
    serve(line)


def _end_with_parent() -> None:
    """Let this process end at once when the program is gone."""
    parent = multiprocessing.parent_process()
    if parent is None:
        return

    def watch() -> None:
        wait([parent.sentinel])
        # The sentinel is a pipe, whose other end code of others in the program may close by mistake.
        while os.name == "posix" and os.getppid() == parent.pid:
            time.sleep(LOOK)
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()
