"""A server inside the test process, and one in a process of its own with a real port."""

import os
import re
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from slow_server import FINEST
from starlette.testclient import TestClient

from addin.server.app import create_app
from addin.server.settings import Settings

ROOT = Path(__file__).resolve().parents[2]


@contextmanager
def inside(settings: Settings) -> Iterator[TestClient]:
    """A client of a server in this process."""
    with TestClient(
        create_app(settings), base_url="http://127.0.0.1:8765", raise_server_exceptions=False
    ) as client:
        yield client


class Address(str):
    """Where a server listens, and the number of its process."""

    pid: int


#: Words of Python that start `torsionbook`, and one whose starts last minutes where `SLOW` is typed.
PROGRAM = ("-m", "addin.cli")
SLOW_PROGRAM = (str(Path(__file__).with_name("slow_server.py")),)
#: One whose server refuses most of what is asked at once.
SMALL_QUEUE = (str(Path(__file__).with_name("small_queue.py")),)


@contextmanager
def outside(*words: str, program: tuple[str, ...] = PROGRAM) -> Iterator[Address]:
    """`torsionbook serve` as a process of its own; its address."""
    command = [sys.executable, *program, "serve", "--port", "0", "--workers", "1", *words]
    process = subprocess.Popen(
        command, cwd=ROOT, stderr=subprocess.PIPE, text=True, env={**os.environ, "NO_COLOR": "1"}
    )
    try:
        assert process.stderr is not None
        said = []
        for line in process.stderr:
            said.append(line)
            if found := re.search(r"running on (https?://[\w.]+:\d+)", line):
                address = Address(found[1])
                address.pid = process.pid
                yield address
                return
        raise AssertionError("the server did not start:\n" + "".join(said))
    finally:
        process.terminate()
        try:
            process.communicate(timeout=15)
        except subprocess.TimeoutExpired:
            process.kill()
            process.communicate()


#: Rows of the Case table that make a start slow, and what they are in a case of JSON.
SLOW = (["TolerancePeak", FINEST, "1"], ["Voltage", 0.65, "1"])
SLOW_CASE = {"tolerance_peak": FINEST, "voltage": 0.65}


def slow_case() -> list[list[list[object]]]:
    """Arguments of TV_MODEL for a start that `SLOW_PROGRAM` calculates for minutes.

    The finest tolerance that may be typed, and a voltage at which the start lasts long.
    """
    from sheet_ranges import model_arguments

    stations, elements, case, *rest = model_arguments("example_backlash")
    return [stations, elements, [*case, *SLOW], *rest]
