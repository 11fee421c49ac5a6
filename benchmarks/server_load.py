"""`python -m benchmarks.server_load`: many short calls while a long start runs; one request for many.

Starts a server of its own on this machine, measures, and stops it. The numbers are of the machine
with client and server on it together.
"""

from __future__ import annotations

import argparse
import asyncio
import json
import os
import platform
import re
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from statistics import median
from typing import Any
from urllib.parse import urlsplit

import httpx2
from websockets.sync.client import connect

from tests.server import slow_server

ROOT = Path(__file__).resolve().parents[1]
#: Calls of both measurements, and connections a browser opens to one server. [count]
CALLS, CONNECTIONS = 1000, 6
#: Time between two calls that come one by one. [s]
PACE = 0.005


@contextmanager
def server() -> Iterator[str]:
    """A server in a process of its own, with one process for starts, some of which last minutes; its address."""
    command = [sys.executable, slow_server.__file__, "serve", "--port", "0", "--workers", "1"]
    environment = {**os.environ, "OPENBLAS_NUM_THREADS": "1"}
    with subprocess.Popen(
        command,
        cwd=ROOT,
        stderr=subprocess.PIPE,
        stdout=subprocess.DEVNULL,
        text=True,
        env=environment,
    ) as process:
        try:
            assert process.stderr is not None
            for line in process.stderr:
                if found := re.search(r"running on (http://[\w.]+:\d+)", line):
                    yield found[1]
                    return
            raise RuntimeError("the server did not start")
        finally:
            process.terminate()


def post(client: httpx2.Client, calls: list[tuple[Any, ...]]) -> list[dict[str, Any]]:
    """Answers of one request."""
    sent = {"calls": [{"name": name, "arguments": given} for name, *given in calls]}
    said = client.post("/api/v1/batch", json=sent)
    said.raise_for_status()
    found: list[dict[str, Any]] = said.json()["results"]
    return found


# --- a long start and a thousand cells ------------------------------------------------------------


def beside_a_start(address: str) -> dict[str, Any]:
    """A thousand calls at once while a start is calculated, and without one."""
    from addin.reading.case_json import case_to_json
    from addin.reading.workbook import read_workbook

    case = case_to_json(read_workbook(ROOT / "templates" / "example_backlash.xlsx").data)
    slow = {**case, "tolerance_peak": slow_server.FINEST, "voltage": 0.65}
    with httpx2.Client(base_url=address, timeout=60.0) as client:
        handle = client.post("/api/v1/model", json=slow).json()["model"]
        post(client, [("TV_FREQUENCIES", handle)])
    asyncio.run(at_once(address, handle))  # the first burst only warms threads and connections up
    alone = asyncio.run(at_once(address, handle))
    with connect(address.replace("http", "ws") + "/api/v1/stream", max_size=None) as socket:
        socket.send(json.dumps({"id": 1, "name": "TV_PEAKS", "arguments": [handle]}))
        while json.loads(socket.recv(60)).get("stage") != "start":
            pass
        beside = asyncio.run(at_once(address, handle))
        paced = asyncio.run(at_once(address, handle, PACE))
        socket.send(json.dumps({"id": 1, "cancel": True}))
        while "stage" in (last := json.loads(socket.recv(60))):
            pass
    return {
        "alone": alone,
        "beside": beside,
        "paced": paced,
        "start was running throughout": "cancelled" in last,
    }


async def at_once(address: str, handle: str, pace: float = 0.0) -> dict[str, float]:
    """A thousand requests, each on a connection of its own; what came back, and when.

    All at once, or one after `pace` seconds each whether or not the others are answered.
    """
    taken: list[float] = []
    right = 0

    async def one(i: int) -> None:
        nonlocal right
        await asyncio.sleep(i * pace)
        name, given = (
            ("TV_FREQUENCIES", [handle]) if i % 2 else ("TV_CONVERT", [float(i), "m", "mm"])
        )
        began = time.perf_counter()
        (found,) = await asked(address, {"calls": [{"name": name, "arguments": given}]})
        taken.append(time.perf_counter() - began)
        right += len(found["value"]) > 5 if i % 2 else found["value"] == [[1000.0 * i]]

    began = time.perf_counter()
    await asyncio.gather(*(one(i) for i in range(CALLS)))
    whole = time.perf_counter() - began
    taken.sort()
    return {
        "right": right,
        "whole": whole,
        "median": median(taken),
        "p99": taken[int(0.99 * CALLS) - 1],
        "largest": taken[-1],
    }


async def asked(address: str, content: dict[str, Any]) -> list[dict[str, Any]]:
    """One request over a new connection. A client library would take longer than the server does."""
    place = urlsplit(address)
    reader, writer = await asyncio.open_connection(place.hostname, place.port)
    body = json.dumps(content).encode()
    writer.write(
        f"POST /api/v1/batch HTTP/1.1\r\nHost: {place.netloc}\r\nConnection: close\r\n"
        f"Content-Type: application/json\r\nContent-Length: {len(body)}\r\n\r\n".encode()
        + body
    )
    said = await reader.read()
    writer.close()
    head, _, answer = said.partition(b"\r\n\r\n")
    assert head.split()[1] == b"200", said[:300]
    found: list[dict[str, Any]] = json.loads(answer)["results"]
    return found


# --- one request for many cells -------------------------------------------------------------------


def together(address: str, rounds: int) -> dict[str, float]:
    """A thousand cells in one request, against a request each. [s]"""
    cells = [("TV_CONVERT", float(i), "lbf*in", "N*m") for i in range(CALLS)]
    one_request, each, parallel = [], [], []
    with httpx2.Client(base_url=address, timeout=60.0) as client:
        post(client, cells)
        for _ in range(rounds):
            began = time.perf_counter()
            whole = post(client, cells)
            one_request.append(time.perf_counter() - began)
            began = time.perf_counter()
            single = [post(client, [cell])[0] for cell in cells]
            each.append(time.perf_counter() - began)
            assert whole == single
            parallel.append(asyncio.run(as_a_browser(address, cells)))
    return {"together": median(one_request), "each": median(each), "browser": median(parallel)}


async def as_a_browser(address: str, cells: list[tuple[Any, ...]]) -> float:
    """Seconds for a request each over the few connections a browser opens."""
    limits = httpx2.Limits(max_connections=CONNECTIONS)
    async with httpx2.AsyncClient(base_url=address, timeout=60.0, limits=limits) as client:
        began = time.perf_counter()
        await asyncio.gather(
            *(
                client.post("/api/v1/batch", json={"calls": [{"name": n, "arguments": a}]})
                for n, *a in cells
            )
        )
        return time.perf_counter() - began


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.server_load", description=__doc__)
    parser.add_argument("--rounds", type=int, default=5, help="turns of the second measurement")
    args = parser.parse_args()
    with server() as address:
        beside = beside_a_start(address)
        cost = together(address, args.rounds)
    print(f"{platform.machine()}, {os.cpu_count()} cores, Python {platform.python_version()}")
    for name, words in (
        ("alone", "at once, alone"),
        ("beside", "at once, beside a start"),
        ("paced", f"{1.0 / PACE:.0f} a second, beside a start"),
    ):
        found = beside[name]
        print(
            f"{CALLS} calls {words}: {found['right']} right, all after {found['whole']:.2f} s; "
            f"each: median {1e3 * found['median']:.1f} ms, p99 {1e3 * found['p99']:.0f} ms, "
            f"largest {1e3 * found['largest']:.0f} ms"
        )
    print(f"the start was running throughout: {beside['start was running throughout']}")
    print(
        f"{CALLS} cells: one request {1e3 * cost['together']:.1f} ms; a request each "
        f"{1e3 * cost['each']:.0f} ms one after the other, {1e3 * cost['browser']:.0f} ms over "
        f"{CONNECTIONS} connections: 1/{min(cost['each'], cost['browser']) / cost['together']:.0f}"
    )


if __name__ == "__main__":
    main()
