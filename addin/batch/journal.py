"""Records on the disk: each line whole or not there, whatever ends the program.

A line is one JSON object with the check sum of its text. It is flushed to the disk before the results
it records are put in place. A last line that was cut off is passed over and overwritten; so is one
that the disk returned otherwise than it was written.
"""

from __future__ import annotations

import contextlib
import json
import os
import zlib
from dataclasses import asdict
from pathlib import Path

from addin.batch.records import Record


def read_journal(path: Path) -> dict[str, Record]:
    """The last record of each file."""
    return _read(path)[0]


def _read(path: Path) -> tuple[dict[str, Record], int]:
    """The last record of each file, and where the whole lines end. [bytes]"""
    records: dict[str, Record] = {}
    end = 0
    with contextlib.suppress(FileNotFoundError), open(path, "rb") as file:
        for line in file:
            record = _parsed(line)
            if record is None:
                break
            records[record.name] = record
            end += len(line)
    return records, end


def _parsed(line: bytes) -> Record | None:
    check, _, text = line.partition(b" ")
    if not line.endswith(b"\n") or check != _check(text[:-1]):
        return None
    try:
        return Record.from_json(json.loads(text))
    except (ValueError, TypeError, KeyError):  # of another version
        return None


def _check(text: bytes) -> bytes:
    return b"%08x" % zlib.crc32(text)


class Journal:
    """A journal that is being written.

    Parameters
    ----------
    path : Path
        The file. [path]
    keep : bool
        Go on after the whole lines that are there, instead of beginning anew. [flag]
    """

    def __init__(self, path: Path, *, keep: bool) -> None:
        end = _read(path)[1] if keep else 0
        self._file = os.open(path, os.O_RDWR | os.O_CREAT | getattr(os, "O_BINARY", 0), 0o666)
        os.ftruncate(self._file, end)
        os.lseek(self._file, end, os.SEEK_SET)
        os.fsync(self._file)

    def close(self) -> None:
        """Nothing more is written."""
        os.close(self._file)

    def write(self, record: Record) -> None:
        """Add a record; it is on the disk when this returns.

        Raises
        ------
        OSError
            If it could not be written; the journal is as before.
        """
        text = json.dumps(asdict(record), ensure_ascii=True, default=str).encode("ascii")
        line = _check(text) + b" " + text + b"\n"
        began = os.lseek(self._file, 0, os.SEEK_CUR)
        try:
            left = memoryview(line)
            while left:
                left = left[os.write(self._file, left) :]
            os.fsync(self._file)
        except OSError:
            os.ftruncate(self._file, began)
            os.lseek(self._file, began, os.SEEK_SET)
            raise
