"""Files and folders that are gone when their process ends, or else when the next one comes by.

A process that is killed cannot clear up. Hence each name holds the place where its process runs and its number: the
next process that makes one in the same folder removes those of processes that are no more.
"""

from __future__ import annotations

import hashlib
import os
import platform
import re
import shutil
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from functools import cache
from pathlib import Path

if sys.platform == "win32":
    import _winapi

    # PROCESS_QUERY_LIMITED_INFORMATION, and what Windows says of a number that no process has.
    _ASK, _NO_SUCH_PROCESS = 0x1000, 87

_BEGAN = time.time()
_NAME = re.compile(r"\.?torsionbook-([0-9a-f]{8})-(\d{1,10})-\w{1,40}(?:\.\w{1,10})?")
# Where nobody can tell whether a process still runs: on another machine.
_OLD_FILE, _OLD_FOLDER = 24 * 3600.0, 7 * 24 * 3600.0  # [s]


@contextmanager
def temporary_folder(*, within: Path | None = None) -> Iterator[Path]:
    """A folder that disappears again.

    Parameters
    ----------
    within : Path, optional
        Where it is made, hidden; default the folder of the system for such. [path]
    """
    parent = Path(tempfile.gettempdir()) if within is None else within
    _clear(parent)
    hidden = "" if within is None else "."
    with _naming(parent):
        made = tempfile.TemporaryDirectory(
            prefix=f"{hidden}{_prefix()}", dir=parent, ignore_cleanup_errors=True
        )
    with made as folder:
        yield Path(folder)


def temporary_file(folder: Path, suffix: str) -> tuple[int, Path]:
    """An open, empty, hidden file, for its maker to rename or to remove; its name is short whatever it is made for.

    Parameters
    ----------
    folder : Path
        Where. [path]
    suffix : str
        End of its name.

    Returns
    -------
    int, Path
        Handle and place.
    """
    _clear(folder)
    with _naming(folder):
        handle, name = tempfile.mkstemp(dir=folder, prefix=f".{_prefix()}", suffix=suffix)
    return handle, Path(name)


@contextmanager
def _naming(folder: Path) -> Iterator[None]:
    """An error names the folder: nobody knows the file."""
    try:
        yield
    except OSError as wrong:
        raise OSError(wrong.errno, wrong.strerror, str(folder)) from wrong


def _prefix() -> str:
    return f"torsionbook-{_place()}-{os.getpid()}-"


@cache
def _place() -> str:
    """Where the numbers of processes are those that this one sees: machine, its start, and container."""
    words = [platform.node()]
    with suppress(OSError):
        words.append(Path("/proc/sys/kernel/random/boot_id").read_text(encoding="ascii"))
        words.append(str(os.stat("/proc/self/ns/pid").st_ino))
    return hashlib.sha256("|".join(words).encode()).hexdigest()[:8]


_cleared: set[tuple[int, Path]] = set()


def _clear(folder: Path) -> None:
    """Remove what processes left that are no more; once for each folder, as one may hold thousands of files."""
    if (os.getpid(), folder) in _cleared:
        return
    _cleared.add((os.getpid(), folder))
    with suppress(OSError):
        for entry in os.scandir(folder):
            found = _NAME.fullmatch(entry.name)
            if found is None:
                continue
            with suppress(OSError):
                is_folder = entry.is_dir(follow_symlinks=False)
                age = time.time() - entry.stat(follow_symlinks=False).st_mtime
                if found[1] == _place():
                    is_left = _is_left(int(found[2]), age)
                else:
                    is_left = age > _oldest(is_folder)
                if not is_left:
                    continue
                if is_folder:
                    shutil.rmtree(entry.path, ignore_errors=True)
                else:
                    os.unlink(entry.path)


def _oldest(is_folder: bool) -> float:
    return _OLD_FOLDER if is_folder else _OLD_FILE


def _is_left(process: int, age: float) -> bool:
    """Whether the process of a name on this machine is no more; the number of this one may have been another's before."""
    if process == os.getpid():
        return age > time.time() - _BEGAN
    return _has_ended(process)


def _has_ended(process: int) -> bool:
    if sys.platform == "win32":
        try:
            handle = _winapi.OpenProcess(_ASK, False, process)
        except (OSError, OverflowError) as problem:
            return getattr(problem, "winerror", None) == _NO_SUCH_PROCESS
        try:
            return _winapi.GetExitCodeProcess(handle) != _winapi.STILL_ACTIVE
        finally:
            _winapi.CloseHandle(handle)
    try:
        os.kill(process, 0)  # does nothing, there
    except ProcessLookupError:
        return True
    except (OSError, OverflowError):
        return False
    return False
