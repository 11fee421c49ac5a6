"""Errors of the package writer.

::

    PackageError                 anything this package reports to a person
    ├── WorkbookRefused          the file is not opened: .reason names the rule, the message says what to do
    │   └── WorkbookLocked       somebody has it open: .owner, .lock_file
    ├── WorkbookMismatch         a sheet, name, table or column that was asked for is not there
    ├── CellRefused              one cell that must not or cannot be written: .sheet, .cell
    ├── ObstaclesFound           tables have no room to grow: .obstacles lists every cell in the way
    └── SaveRefused              nothing was written
        └── SourceChanged        the file was changed by somebody else since it was opened

Each message is a sentence that says what was found and what to do; nothing here needs a traceback to be understood.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass


class PackageError(Exception):
    """Base of every error that a person working with the workbook can act on."""


class WorkbookRefused(PackageError):
    """The file was not opened.

    Parameters
    ----------
    reason : str
        Short fixed word for programs and tests, e.g. ``"encrypted"``, ``"dtd"``, ``"signed"``.
    message : str
        The sentence for people.
    """

    def __init__(self, reason: str, message: str) -> None:
        super().__init__(message)
        self.reason = reason
        self.message = message


def damaged(what: str) -> WorkbookRefused:
    """A file that a spreadsheet program may repair."""
    return WorkbookRefused(
        "damaged",
        f"{what} Open the workbook in the spreadsheet program, let it repair the file, and save it again.",
    )


class WorkbookLocked(WorkbookRefused):
    """The workbook is open in a spreadsheet program.

    Parameters
    ----------
    message : str
        The sentence for people.
    owner : str
        The user named in the lock file; empty when it names none.
    lock_file : str
        Name of the lock file.
    """

    def __init__(self, message: str, *, owner: str, lock_file: str) -> None:
        super().__init__("locked", message)
        self.owner = owner
        self.lock_file = lock_file


class WorkbookMismatch(PackageError):
    """The workbook lacks a sheet, name, table or column that the caller needs."""


class CellRefused(PackageError):
    """One cell cannot be written.

    Parameters
    ----------
    sheet, cell : str
        Where, e.g. ``"Train"`` and ``"B4"``.
    message : str
        The sentence; the place is put in front of it.
    """

    def __init__(self, sheet: str, cell: str, message: str) -> None:
        super().__init__(f"{sheet}!{cell}: {message}")
        self.sheet = sheet
        self.cell = cell


@dataclass(frozen=True)
class Obstacle:
    """Something in the way of a growing table."""

    sheet: str  #: Where it stands.
    cell: str  #: Likewise.
    found: str  #: What stands there, in words.
    table: str  #: The table that needs the room.

    def __str__(self) -> str:
        return f"{self.sheet}!{self.cell}: {self.found} is in the way of table {self.table}."


class ObstaclesFound(PackageError):
    """Tables have no room to grow; nothing was written.

    Parameters
    ----------
    obstacles : sequence of Obstacle
        Every cell, table, merged range or pivot table in the way.
    """

    SHOWN = 20

    def __init__(self, obstacles: Sequence[Obstacle]) -> None:
        self.obstacles = tuple(obstacles)
        lines = [str(one) for one in self.obstacles[: self.SHOWN]]
        if len(self.obstacles) > self.SHOWN:
            lines.append(f"... and {len(self.obstacles) - self.SHOWN} more.")
        lines.append("Move this content elsewhere, save, and run again.")
        super().__init__("\n".join(lines))


class SaveRefused(PackageError):
    """Nothing was written; the original file is as it was."""


class SourceChanged(SaveRefused):
    """The file was changed by somebody else between opening and saving."""
