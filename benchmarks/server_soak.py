"""`python -m benchmarks.server_soak`: a million short calls of one server, and its memory after every tenth of them.

Requests hold 1 to 100 calls, as worksheets send them; they come over a few connections that stay open, one in a hundred over
a new one. Calls are values of a model, conversions, and some that must fail (no such model, a wrong unit); every seventh
request is no JSON. Every answer is looked at. Linux.
"""

from __future__ import annotations

import argparse
import asyncio
import json
import platform
import re
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from itertools import cycle, repeat
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import httpx2

__all__ = ["RECORD", "Memory", "soak"]

ROOT = Path(__file__).resolve().parents[1]
RECORD = "server_soak.json"
CALLS, CONNECTIONS = 1_000_000, 4
#: Calls of one request after the other, and one request in so many comes over a new connection.
SIZES, NEW_CONNECTION = (1, 1, 1, 5, 10, 100), 100
_STREAM = tuple[asyncio.StreamReader, asyncio.StreamWriter]


@dataclass(frozen=True)
class Memory:
    """What the server and its processes hold after some calls."""

    calls: int
    server: float  #: Resident. [MB]
    processes: float  #: Resident, all together. [MB]


@contextmanager
def server() -> Iterator[tuple[str, int]]:
    """A server in a process of its own; its address and number."""
    command = [sys.executable, "-m", "addin.cli", "serve", "--port", "0", "--workers", "1"]
    with subprocess.Popen(command, cwd=ROOT, stderr=subprocess.PIPE, text=True) as process:
        try:
            assert process.stderr is not None
            for line in process.stderr:
                if found := re.search(r"running on (http://[\w.]+:\d+)", line):
                    yield found[1], process.pid
                    return
            raise RuntimeError("the server did not start")
        finally:
            process.terminate()


def memory(calls: int, pid: int) -> Memory:
    """What is resident now."""
    children = Path(f"/proc/{pid}/task/{pid}/children").read_text().split()
    return Memory(calls, _resident(pid), sum(map(_resident, children)))


def _resident(pid: int | str) -> float:
    found = re.search(r"VmRSS:\s+(\d+) kB", Path(f"/proc/{pid}/status").read_text())
    return int(found[1]) / 1024 if found else 0.0


def asked(number: int, handle: str) -> tuple[str, list[Any]]:
    """A call: function and arguments."""
    return (
        ("TV_FREQUENCIES", [handle]),
        ("TV_CONVERT", [float(number), "m", "mm"]),
        ("TV_FREQUENCIES", ["tv:none"]),
        ("TV_CONVERT", [float(number), "m", "kg"]),
    )[number % 4]


def is_right(number: int, answer: dict[str, Any], frequencies: list[Any]) -> bool:
    """Whether the answer is the one that the call must get."""
    if number % 4 == 0:
        return bool(answer["value"] == frequencies)
    if number % 4 == 1:
        return bool(answer["value"] == [[1000.0 * number]])
    return bool(answer.get("value") is None and answer["error"])


async def _call(stream: _STREAM, host: str, body: bytes) -> tuple[int, bytes]:
    """One request; a client library would take longer than the server does."""
    reader, writer = stream
    head = f"POST /api/v1/batch HTTP/1.1\r\nHost: {host}\r\nContent-Type: application/json\r\nContent-Length: {len(body)}\r\n\r\n"
    writer.write(head.encode() + body)
    said = await reader.readuntil(b"\r\n\r\n")
    length = re.search(rb"(?i)content-length: (\d+)", said)
    return int(said[9:12]), await reader.readexactly(int(length[1]) if length else 0)


def _requests(calls: int) -> Iterator[tuple[int, range]]:
    """Numbers of the requests, and of the calls of each."""
    first = 0
    for count, size in enumerate(cycle(SIZES)):
        if first >= calls:
            return
        yield count, range(first, min(first + size, calls))
        first += size


async def soak(address: str, pid: int, calls: int) -> tuple[list[Memory], list[str]]:
    """Make the calls.

    Returns
    -------
    list of Memory, list of str
        Memory after every tenth of the calls, and the first wrong answers.
    """
    from addin.reading.case_json import case_to_json
    from addin.reading.workbook import read_workbook

    host, port = urlsplit(address).hostname, urlsplit(address).port
    case = case_to_json(read_workbook(ROOT / "templates" / "example_proposed.xlsx").data)
    with httpx2.Client(base_url=address, timeout=60.0) as client:
        handle = client.post("/api/v1/model", json=case).json()["model"]
        sent = {"calls": [{"name": "TV_FREQUENCIES", "arguments": [handle]}]}
        frequencies = client.post("/api/v1/batch", json=sent).json()["results"][0]["value"]
    requests, held, wrong = _requests(calls), [memory(0, pid)], list[str]()
    done = 0

    async def connection() -> None:
        nonlocal done
        stream = await asyncio.open_connection(host, port)
        for count, numbers in requests:
            if count % NEW_CONNECTION == 0:
                stream[1].close()
                stream = await asyncio.open_connection(host, port)
            if count % 7 == 0:
                status, said = await _call(stream, f"{host}:{port}", b"{")
                if status not in (400, 422):
                    wrong.append(f"no JSON: {status}: {said[:200]!r}")
            given = [asked(number, handle) for number in numbers]
            sent = {"calls": [{"name": name, "arguments": values} for name, values in given]}
            status, said = await _call(stream, f"{host}:{port}", json.dumps(sent).encode())
            answers = json.loads(said).get("results", [])
            if len(answers) != len(numbers) or not all(
                map(is_right, numbers, answers, repeat(frequencies))
            ):
                wrong.append(f"calls from {numbers[0]}: {status}: {said[:200]!r}")
            before, done = done, done + len(numbers)
            if 10 * before // calls < 10 * done // calls:
                held.append(memory(done, pid))
                print(held[-1], time.strftime("%H:%M:%S"), flush=True)
        stream[1].close()

    await asyncio.gather(*(connection() for _ in range(CONNECTIONS)))
    return held, wrong[:20]


def main() -> int:
    """Make them, and look at the memory; 1 where an answer was wrong."""
    words = argparse.ArgumentParser(prog="python -m benchmarks.server_soak")
    words.add_argument("--calls", type=int, default=CALLS, help="how many")
    words.add_argument(
        "--record", action="store_true", help=f"keep it in {RECORD} and docs/safety.md"
    )
    given = words.parse_args()
    began = time.monotonic()
    with server() as (address, pid):
        held, wrong = asyncio.run(soak(address, pid, given.calls))
    minutes = (time.monotonic() - began) / 60
    for sentence in wrong:
        print(sentence)
    print(f"{given.calls:,} calls, {len(wrong)} wrong, {minutes:.1f} min; memory [MB]:")
    for one in held:
        print(f"{one.calls:>9,} {one.server:7.1f} {one.processes:7.1f}")
    if given.record:
        from addin.contract.version import product_version
        from benchmarks.safety_page import RECORDS, write_page

        record = {
            "about": f"torsionbook {product_version()}, Python {platform.python_version()}, {platform.system()}",
            "calls": given.calls,
            "requests": sum(1 for _ in _requests(given.calls)),
            "wrong": wrong,
            "memory": [{name: round(value, 1) for name, value in asdict(one).items()} for one in held],
        }  # fmt: skip
        text = json.dumps(record, indent=1) + "\n"
        (RECORDS / RECORD).write_text(text, encoding="utf-8")
        write_page()
    return int(bool(wrong))


if __name__ == "__main__":
    sys.exit(main())
