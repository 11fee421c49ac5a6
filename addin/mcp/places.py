"""Which files may be read, and where one may be written: folders named when the server starts."""

from __future__ import annotations

import os
import stat
from collections.abc import Sequence
from pathlib import Path

from addin.server.bounded_reading import LIMITS
from addin.xlsx.places import real_path

#: Files that are read.
ENDINGS = (".xlsx", ".xlsm", ".json")


class PlaceRefused(Exception):
    """A file that is not read or written; the sentence says why."""


class Places:
    """Folders, links followed.

    Parameters
    ----------
    read : sequence of Path
        Folders of which files may be read. [paths]
    write : Path or None
        The one folder where files may be written; they may be read as well. [path]

    Raises
    ------
    PlaceRefused
        If one of them is no folder.
    """

    def __init__(self, read: Sequence[Path], write: Path | None = None) -> None:
        self.write = None if write is None else real_path(write)
        self.read = tuple(map(real_path, [*read, *([write] if write else [])]))
        for folder in self.read:
            if not folder.is_dir():
                raise PlaceRefused(f"{folder} is no folder. Name one that is there.")

    def source(self, name: str) -> Path:
        """The file of a name, links followed.

        Parameters
        ----------
        name : str
            A path, relative to the first folder or absolute. [path]

        Raises
        ------
        PlaceRefused
            If it lies elsewhere, is no workbook and no case JSON, or too large.
        """
        try:
            path = real_path(self.read[0] / name)
            if not any(path.is_relative_to(folder) for folder in self.read):
                where = ", ".join(map(str, self.read))
                raise PlaceRefused(f"{name[:200]} is not in {where}. Other files are not read.")
            if path.suffix.lower() not in ENDINGS:
                raise PlaceRefused(f"{name[:200]} is no workbook (.xlsx, .xlsm) and no case JSON.")
            found = path.stat()
        except FileNotFoundError:
            raise PlaceRefused(f"{name[:200]} is not there. Check the path.") from None
        except (OSError, ValueError) as wrong:
            raise PlaceRefused(f"{name[:200]!r} cannot be read: {wrong}.") from None
        if not stat.S_ISREG(found.st_mode):
            raise PlaceRefused(f"{name[:200]} is no file.")
        if found.st_size > LIMITS.file_size:
            raise PlaceRefused(
                f"{name[:200]} has {found.st_size / 1e6:.3g} MB; at most {LIMITS.file_size / 1e6:.3g} MB are read. "
                "Calculate it with torsionbook recalc."
            )
        return path

    def target(self, name: str, source: Path) -> Path:
        """Where a result is written: a new file of the folder.

        Parameters
        ----------
        name : str
            Name without a folder. [name]
        source : Path
            What is calculated: the result has its ending. [path]

        Raises
        ------
        PlaceRefused
            If nothing may be written, the name has a folder in it, or something is there already.
        """
        if self.write is None:
            raise PlaceRefused(
                "Nothing is written: the server was started without --folder. Use the tool run."
            )
        if (
            not name
            or name != os.path.basename(name)
            or "\\" in name
            or "\0" in name
            or len(name) > 150
        ):
            raise PlaceRefused(
                f"{name[:200]!r} is no name of a file. Give one without a folder, such as train.out.xlsx."
            )
        path = self.write / name
        if path.suffix.lower() != source.suffix.lower():
            raise PlaceRefused(f"{name} must end with {source.suffix}, as {source.name} does.")
        if os.path.lexists(path):
            raise PlaceRefused(f"{name} is there already. Give another name.")
        return path
