"""A real Dask cluster for tests: a scheduler and workers in processes of their own, on loopback."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]


def wait_until(happens: Callable[[], object], seconds: float = 60.0) -> None:
    """Until something happens; a minute is a failure."""
    until = time.monotonic() + seconds
    while not happens():
        assert time.monotonic() < until
        time.sleep(0.05)


class Dask:
    """A scheduler and workers; `paths` is where their tasks are imported from, besides the checkout."""

    def __init__(self, place: Path, *paths: Path, workers: int = 3) -> None:
        self.place = place
        self.path = os.pathsep.join(map(str, (ROOT, *paths)))
        place.mkdir()
        self.processes: list[subprocess.Popen[bytes]] = []
        self.log = open(place / "log", "wb")
        found = place / "scheduler.json"
        self._start("dask_scheduler", "--port", "0", "--scheduler-file", str(found))
        wait_until(found.exists)
        time.sleep(0.2)
        self.address = json.loads(found.read_text())["address"]
        self.workers = [self.worker() for _ in range(workers)]

    def _start(self, program: str, *words: str) -> subprocess.Popen[bytes]:
        process = subprocess.Popen(
            [sys.executable, "-m", f"distributed.cli.{program}", "--host", "127.0.0.1",
             "--no-dashboard", *words],
            cwd=self.place,
            env={**os.environ, "PYTHONPATH": self.path, "OPENBLAS_NUM_THREADS": "1"},
            stdout=self.log,
            stderr=self.log,
        )  # fmt: skip
        self.processes.append(process)
        return process

    def worker(self) -> subprocess.Popen[bytes]:
        return self._start("dask_worker", self.address, "--nthreads", "1", "--no-nanny")

    def stop(self) -> None:
        for process in reversed(self.processes):
            process.kill()
            process.wait()
        self.log.close()
