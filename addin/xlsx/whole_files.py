"""Files written whole or not at all."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable
from pathlib import Path


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
    handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.", suffix=path.suffix)
    os.close(handle)
    try:
        write(Path(name))
        # mkstemp makes the file private; give it the mode any other new file would get
        mask = os.umask(0)
        os.umask(mask)
        os.chmod(name, 0o666 & ~mask)
        os.replace(name, path)
    except BaseException:
        Path(name).unlink(missing_ok=True)
        raise
