"""Files written whole or not at all."""

from __future__ import annotations

import errno
import json
import os
import stat
import tempfile
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any


def write_whole(path: Path, write: Callable[[Path], object]) -> None:
    """Make a file beside its place, and put it there in one step.

    Parameters
    ----------
    path : Path
        The file; one that is there is replaced. [path]
    write : callable
        Is given the path of an empty file and fills it.

    Raises
    ------
    OSError
        If it cannot be written; one that was there is as before.
    """
    mode = _mode_of(path)
    handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.", suffix=path.suffix)
    os.close(handle)
    try:
        write(Path(name))
        os.chmod(name, mode)
        os.replace(name, path)
    except BaseException:
        Path(name).unlink(missing_ok=True)
        raise


def _mode_of(path: Path) -> int:
    """The mode of the file that is replaced, or the one that any other new file would get."""
    if not path.exists():
        mask = os.umask(0)
        os.umask(mask)
        return 0o666 & ~mask
    if not path.is_file():  # a device or a pipe: a file would take its place
        raise OSError(errno.EINVAL, "is no ordinary file", str(path))
    if not os.access(path, os.W_OK):
        raise PermissionError(errno.EACCES, "is write-protected", str(path))
    return stat.S_IMODE(path.stat().st_mode)


def write_json(path: Path, content: Mapping[str, Any]) -> None:
    """Write JSON whole or not at all.

    Raises
    ------
    OSError
        If the file cannot be written; one that was there is as before.
    """
    write_text(path, json.dumps(content, indent=1, ensure_ascii=False, allow_nan=False) + "\n")


def write_text(path: Path, text: str) -> None:
    """Write text whole or not at all, in UTF-8 with the line ends it has.

    Raises
    ------
    OSError
        If the file cannot be written; one that was there is as before.
    """
    if path.is_dir():
        raise IsADirectoryError(errno.EISDIR, "is a folder", str(path))
    path.parent.mkdir(parents=True, exist_ok=True)
    write_whole(path, lambda made: made.write_text(text, encoding="utf-8", newline=""))
