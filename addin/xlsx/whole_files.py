"""Files written whole or not at all."""

from __future__ import annotations

import errno
import json
import os
import stat
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from addin.xlsx.places import refuse_strange_name, replace_file, take_rights
from addin.xlsx.temporary import temporary_file


def write_whole(path: Path, write: Callable[[Path], object]) -> None:
    """Make a file beside its place, flush it to the disk, and put it there in one step.

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
    handle, made = temporary_file(path.parent, path.suffix)
    os.close(handle)
    try:
        write(made)
        put_in_place(made, path, mode)
    except BaseException:
        made.unlink(missing_ok=True)
        raise


def put_in_place(made: Path, path: Path, mode: int | None = None) -> None:
    """Have a finished file on the disk and then, in one step, under its name; None leaves its mode.

    Raises
    ------
    OSError
        If the disk does not take it, or the name cannot be given; a file that had it is as before.
    """
    flush_file(made)
    if mode is not None:
        take_rights(made, path)
        os.chmod(made, mode)
    replace_file(made, path)
    flush_folder(path.parent)


def flush_file(path: Path) -> None:
    """Have the content of a file on the disk.

    Raises
    ------
    OSError
        If the disk does not take it.
    """
    with open(path, "r+b") as file:
        os.fsync(file.fileno())


def flush_folder(folder: Path) -> str:
    """Have new names in a folder on the disk; Windows has no such call and needs none.

    Returns
    -------
    str
        Why the disk did not confirm it; empty if it did. The files are there, unless the power fails now.
    """
    if os.name != "posix":
        return ""
    try:
        handle = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)
    except OSError as problem:
        return problem.strerror or "no reason given"
    return ""


def _mode_of(path: Path) -> int:
    """The mode of the file that is replaced, or the one that any other new file would get."""
    refuse_strange_name(path)
    if path.is_symlink() and (path.is_file() or not path.exists()):
        raise OSError(
            errno.EINVAL, "it is a link to another file, which is not replaced", str(path)
        )
    if not path.exists():
        mask = os.umask(0)
        os.umask(mask)
        return 0o666 & ~mask
    if not path.is_file():  # a device or a pipe: a file would take its place
        raise OSError(errno.EINVAL, "it is no ordinary file", str(path))
    if not os.access(path, os.W_OK):
        raise OSError(errno.EROFS, "it is write-protected", str(path))
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

    Half characters, of file names that are no UTF-8, are written as JSON writes them.

    Raises
    ------
    OSError
        If the file cannot be written; one that was there is as before.
    """
    if path.is_dir():
        raise IsADirectoryError(errno.EISDIR, "is a folder", str(path))
    path.parent.mkdir(parents=True, exist_ok=True)
    write_whole(path, lambda made: made.write_text(text, "utf-8", "backslashreplace", newline=""))
