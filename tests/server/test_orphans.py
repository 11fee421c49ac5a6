"""Processes of the server end with it, also where it is killed in the middle of a calculation."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
SCRIPT = """
import multiprocessing, time
from addin.server.processes import Work
if __name__ == "__main__":
    work = Work(processes=1, waiting=2, time_limit=300.0)
    job = work.submit("wait", 200.0)
    while job.stage == "waiting for a free process":
        time.sleep(0.05)
    print(multiprocessing.active_children()[0].pid, flush=True)
    job.future.result()
"""


def runs(pid: int) -> bool:
    try:  # one that has ended and that nobody has asked for its status is a Z
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except FileNotFoundError:
        return False


@pytest.mark.slow
@pytest.mark.skipif(not Path("/proc").is_dir(), reason="looks for processes in /proc")
def test_processes_end_when_the_server_is_killed(tmp_path):
    (tmp_path / "script.py").write_text(SCRIPT)
    server = subprocess.Popen(
        [sys.executable, str(tmp_path / "script.py")],
        stdout=subprocess.PIPE,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
    )
    pid = int(server.stdout.readline())
    assert runs(pid)
    server.kill()
    server.wait()
    until = time.monotonic() + 30
    while runs(pid) and time.monotonic() < until:
        time.sleep(0.05)
    assert not runs(pid)
