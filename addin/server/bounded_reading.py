"""Reading an upload with bounds on size and memory."""

from __future__ import annotations

from pathlib import Path

from addin.reading.one_file import Unreadable, file_problem, read_checked
from addin.reading.typed_case import CaseInput
from addin.workers.processes import bounded_memory
from addin.xlsx.container import Limits
from addin.xlsx.errors import WorkbookRefused

#: What is taken for a workbook here: less than on a machine of one's own.
LIMITS = Limits(file_size=25 * 2**20, total_size=100 * 2**20, part_size=60 * 2**20, entries=2_000)
#: Memory that reading an upload may take, and reading, calculating and writing it together. [B]
READING, WRITING = 600 * 2**20, 2 * 2**30


def bounded_read(source: Path) -> CaseInput | Unreadable:
    """What is in an upload, which may take so much memory and no more."""
    try:
        with bounded_memory(READING):
            return read_checked(source, LIMITS)
    except MemoryError:
        return too_large(source)


def too_large(source: Path) -> Unreadable:
    """An upload that takes more memory."""
    sentence = f"{source.name} takes more memory than this server allows. Calculate it on your own computer."
    return Unreadable((file_problem(source, WorkbookRefused("too large", sentence)),))
