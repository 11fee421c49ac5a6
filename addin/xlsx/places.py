"""Where a path leads, links followed; names that no file can have; a file put into its place."""

from __future__ import annotations

import errno
import os
import re
import sys
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

__all__ = [
    "has_no_end",
    "real_path",
    "refuse_no_end",
    "refuse_open_elsewhere",
    "refuse_strange_name",
    "replace_file",
    "take_rights",
]

#: Windows takes such a name for a device, whatever its ending, and what follows a colon for another stream of the file.
_DEVICE = re.compile(r"(?:con|prn|aux|nul|conin\$|conout\$|(?:com|lpt)[1-9¹²³]) *(?:\..*)?", re.I)
_FORBIDDEN = re.compile(r'[<>:"|?*\x00-\x1f]')
_IS_WINDOWS = os.name == "nt"
#: Errors of Windows where another program has a file open. A virus scanner does, for a moment, when a file is new.
_OPEN_ELSEWHERE = (5, 32, 33)
#: How long to wait for that. [s]
_PATIENCE = 2.0


def real_path(path: Path) -> Path:
    """The place behind a path; of links in a circle, where the circle begins, and of a device of Windows its name.

    `Path.resolve` raises on a circle before Python 3.13, so that one such link would stop a whole folder.
    """
    try:
        return Path(os.path.realpath(path))
    except OSError:  # the console, CON
        return Path(os.path.abspath(path))


def refuse_strange_name(path: Path) -> None:
    """Refuse, on Windows, a name that is taken for a device or part of another file; it would be lost there.

    Raises
    ------
    OSError
        With the sentence.
    """
    if not _IS_WINDOWS:
        return
    name = path.name
    if _DEVICE.fullmatch(name) or _FORBIDDEN.search(name) or name != name.rstrip(" ."):
        raise OSError(22, "is no name that a file can have on Windows", str(path))


def has_no_end(path: Path) -> bool:
    """Whether it is a device or a pipe, which may never end."""
    return path.exists() and not (path.is_file() or path.is_dir())


def refuse_no_end(path: Path) -> None:
    """Refuse a device or a pipe.

    Raises
    ------
    OSError
        With the sentence.
    """
    if has_no_end(path):
        raise OSError(errno.EINVAL, "it is a device or a pipe", str(path))


def take_rights(made: Path, earlier: Path) -> None:
    """Give a file that is to replace another the owner, group, access list and attributes of that, as far as this process may."""
    if sys.platform == "win32" or not earlier.exists():
        return
    was, is_now = earlier.stat(), made.stat()
    for owner, group in ((was.st_uid, -1), (-1, was.st_gid)):
        if owner not in (-1, is_now.st_uid) or group not in (-1, is_now.st_gid):
            with suppress(OSError):
                os.chown(made, owner, group)
    if sys.platform == "linux":
        with suppress(OSError):  # a disk without attributes
            wanted = {name: os.getxattr(earlier, name) for name in os.listxattr(earlier)}
            for name in {*os.listxattr(made), *wanted}:  # the folder may have given it some
                with suppress(OSError):
                    if name in wanted:
                        os.setxattr(made, name, wanted[name])
                    else:
                        os.removexattr(made, name)


def replace_file(made: Path, place: Path) -> None:
    """Put a file into its place in one step; on Windows, wait a moment where another program has one of them open.

    Raises
    ------
    OSError
        If it cannot be put there; one that was there is as before.
    """
    _patiently(lambda: os.replace(made, place))


def refuse_open_elsewhere(place: Path) -> None:
    """Refuse, on Windows, a file that another program keeps from being replaced: it cannot get its own name either.

    Raises
    ------
    PermissionError
        If another program has it open.
    """
    if _IS_WINDOWS:
        _patiently(lambda: os.rename(place, place))


def _patiently(rename: Callable[[], None]) -> None:
    until = time.monotonic() + _PATIENCE
    while True:
        try:
            rename()
            return
        except PermissionError as problem:
            is_open = getattr(problem, "winerror", None) in _OPEN_ELSEWHERE
            if not is_open or time.monotonic() >= until:
                raise
            time.sleep(0.05)
