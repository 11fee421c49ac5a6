"""Workbooks made to do harm, built from an honest one, and a process that says what they cost.

`Attended` takes files one by one through a whole recalculation, each in a process of its own where a process can fork, and
counts: bytes that came out of the archive, the largest memory (not on Windows), processor time, files left behind.
"""

from __future__ import annotations

import json
import queue
import re
import struct
import subprocess
import sys
import threading
import zlib
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from benchmarks.workbook_fuzz import seeds

Parts = dict[str, bytes]
MAIN = 'xmlns="http://schemas.openxmlformats.org/spreadsheetml/2006/main"'
ROOT = Path(__file__).resolve().parents[2]


def honest() -> Parts:
    """Parts of a workbook that calculates: sheets Case, Train, Results and Owner's notes."""
    return dict(seeds()[0].parts)


# --- archives, byte by byte ---------------------------------------------------------------------


@dataclass
class Packed:
    """One entry: its name, its content and what its headers say of it."""

    name: bytes
    data: bytes
    level: int = 1
    said_size: int | None = None
    said_method: int | None = None
    at: int | None = None  # where the directory says that it stands

    def stored(self) -> bytes:
        packer = zlib.compressobj(self.level, zlib.DEFLATED, -15)
        return packer.compress(self.data) + packer.flush()


def archive(entries: Iterable[Packed]) -> bytes:
    """A zip file in which every header says what it is told to."""
    body, directory, count = bytearray(), bytearray(), 0
    for one in entries:
        payload = one.stored()
        size = len(one.data) if one.said_size is None else one.said_size
        method = 8 if one.said_method is None else one.said_method
        common = struct.pack(
            "<5H3L2H", 20, 0x800, method, 0, 33, zlib.crc32(one.data), len(payload), size,
            len(one.name), 0,
        )  # fmt: skip
        at = len(body) if one.at is None else one.at
        body += b"PK\x03\x04" + common + one.name + payload
        directory += b"PK\x01\x02" + struct.pack("<H", 20) + common
        directory += struct.pack("<3H2L", 0, 0, 0, 0, at) + one.name
        count += 1
    end = struct.pack("<4H2LH", 0, 0, count % 65536, count % 65536, len(directory), len(body), 0)
    return bytes(body + directory + b"PK\x05\x06" + end)


def packed(parts: Mapping[str, bytes]) -> bytes:
    """An ordinary archive."""
    return archive(Packed(name.encode(), data) for name, data in parts.items())


def changed(part: str, change: Callable[[bytes], bytes]) -> Parts:
    """The honest workbook with one part changed."""
    parts = honest()
    before = parts[part]
    parts[part] = change(before)
    assert parts[part] != before, f"nothing changed in {part}"
    return parts


def sheet(number: int) -> str:
    """Part of a sheet: 1 Case, 2 Train, 3 Results, 4 Owner's notes."""
    return f"xl/worksheets/sheet{number}.xml"


def in_cells(rows: bytes, number: int = 4) -> Parts:
    """The honest workbook with rows put behind those of a sheet."""
    return changed(
        sheet(number), lambda data: data.replace(b"</sheetData>", rows + b"</sheetData>")
    )


def retyped(number: int, cell: str, inside: bytes, kind: str = "") -> Parts:
    """The honest workbook with another content of one cell."""

    def change(data: bytes) -> bytes:
        pattern = rb'<c r="' + cell.encode() + rb'"[^>]*?(?:/>|>.*?</c>)'
        new = f'<c r="{cell}"{kind and f" t={chr(34)}{kind}{chr(34)}"}>'.encode() + inside + b"</c>"
        found = re.search(pattern, data)
        if found:
            return data[: found.start()] + new + data[found.end() :]
        row = re.search(rb'<row r="%s"[^>]*>' % re.sub(r"\D", "", cell).encode(), data)
        assert row, cell
        return data[: row.end()] + new + data[row.end() :]

    return changed(sheet(number), change)


def place_of(name: str) -> str:
    """Cell of a scalar on sheet Case."""
    found = re.search(rf'name="{name}">Case!\$(\w+)\$(\d+)<', honest()["xl/workbook.xml"].decode())
    assert found
    return found[1] + found[2]


# --- what they cost -----------------------------------------------------------------------------

_WORKER = r"""
import json, os, sys, time, zipfile
from pathlib import Path
from addin.writing.recalculate import recalculate
import addin.writing.workbook, addin.calculation.calculation, addin.reading.workbook, formualizer  # before the fork
from addin.contract.units import _registry
_registry()
import addin.xlsx.container as container
counted = 0
def counting(real):
    def read(*given):
        global counted
        data = real(*given)
        counted += len(data)
        return data
    return read
zipfile.ZipExtFile.read = counting(zipfile.ZipExtFile.read)
container.inflated = counting(container.inflated)
def costs():  # largest memory [MB], which Windows does not tell, and processor time [s]
    try:
        import resource
    except ImportError:
        return 0.0, time.process_time()
    used = resource.getrusage(resource.RUSAGE_SELF)
    return used.ru_maxrss / 1024, used.ru_utime + used.ru_stime
def one(path, inflated=0, seconds=0.0):
    source = Path(path)
    try:
        done = recalculate(source, destination=source.with_name("done" + source.suffix),
                           json_file=source.with_name("done.json"))
        told = [p.message[:3000] for p in done.problems]
        said = {"told": told[:10] + told[-10:], "warnings": list(done.warnings),
                "written": done.calculation is not None}
    except BaseException as wrong:
        import traceback
        said = {"crash": traceback.format_exc()}
    said["inflated"] = counted - inflated
    said["peak_mb"], spent = costs()
    said["cpu_s"] = spent - seconds
    return said
for line in sys.stdin:
    if not hasattr(os, "fork"):  # Windows: one after the other in this process
        print(json.dumps(one(line.rstrip("\n"), counted, costs()[1])), flush=True)
        continue
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        os.write(writing, json.dumps(one(line.rstrip("\n"))).encode())
        os._exit(0)
    os.close(writing)
    with os.fdopen(reading, "rb") as pipe:
        said = pipe.read()
    status = os.waitpid(child, 0)[1]
    print(said.decode() if status == 0 else json.dumps({"crash": f"ended with {status}"}), flush=True)
"""


class Attended:
    """The process; `ask` gives what became of a file. One that takes minutes is ended."""

    PATIENCE = 240.0

    def __init__(self) -> None:
        self._process = subprocess.Popen(
            [sys.executable, "-c", _WORKER], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
            cwd=ROOT, encoding="utf-8",
        )  # fmt: skip
        self._answers: queue.Queue[str] = queue.Queue()
        threading.Thread(target=self._hear, daemon=True).start()

    def _hear(self) -> None:
        """Pass on its answers, and an empty one when it ends."""
        assert self._process.stdout
        for line in self._process.stdout:
            self._answers.put(line)
        self._answers.put("")

    def ask(self, path: Path) -> dict[str, Any]:
        assert self._process.stdin
        self._process.stdin.write(f"{path}\n")
        self._process.stdin.flush()
        try:
            answer = self._answers.get(timeout=self.PATIENCE)
        except queue.Empty:
            self.end()
            raise AssertionError(
                f"{path.name} was still being worked on after {self.PATIENCE:g} s"
            ) from None
        assert answer, f"the process ended at {path.name}"
        return json.loads(answer)

    def end(self) -> None:
        self._process.kill()
        self._process.wait()
        for stream in (self._process.stdin, self._process.stdout):
            if stream is not None:
                stream.close()
