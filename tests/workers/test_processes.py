"""A process of our own ends with the program, and not before."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from addin.workers.pool import _serve
from addin.workers.processes import Process

ROOT = Path(__file__).resolve().parents[2]
#: Asks a process of its own how much it has used, after having used more.
LARGE_PARENT = f"""
import mmap
from addin.workers.pool import _serve
from addin.workers.processes import Process, most_resident
if __name__ == "__main__":
    block = mmap.mmap(-1, {400 * 2**20})
    for at in range(0, len(block), mmap.PAGESIZE):
        block[at] = 1
    process = Process(_serve)
    assert process.line.recv() == ("ready", None)
    process.line.send((eval, "__import__('addin.workers.processes').workers.processes.most_resident()", False))
    print(most_resident(), process.line.recv()[1])
    process.end()
"""


@pytest.mark.skipif(os.name != "posix", reason="the sentinel is a pipe on POSIX only")
def test_a_closed_pipe_is_not_taken_for_the_end_of_the_program() -> None:
    process = Process(_serve)
    try:
        process._process._popen.finalizer()  # closes this end of the pipe, as a stray close would
        process.line.send((abs, -3, False))
        assert process.line.poll(60.0)
        assert [process.line.recv() for _ in range(2)] == [("ready", None), ("done", 3)]
    finally:
        process.end()


@pytest.mark.skipif(os.name != "posix", reason="no signals to a process on Windows")
def test_ctrl_c_does_not_end_a_process_that_begins(capfd: pytest.CaptureFixture[str]) -> None:
    process = Process(_serve)
    try:
        for _ in range(20):  # while it imports
            os.kill(process.pid, signal.SIGINT)
            time.sleep(0.01)
        process.line.send((abs, -3, False))
        assert process.line.poll(60.0)
        assert [process.line.recv() for _ in range(2)] == [("ready", None), ("done", 3)]
    finally:
        process.end()
    assert capfd.readouterr().err == ""


def test_a_process_takes_no_module_from_the_folder_where_it_begins(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "pickle.py").write_text("raise SystemExit('a stranger')", encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    process = Process(_serve)
    try:
        assert process.line.poll(60.0)
        assert process.line.recv() == ("ready", None)
    finally:
        process.end()
    assert "PYTHONSAFEPATH" not in os.environ


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="Linux alone takes it over")
def test_the_memory_of_the_program_is_not_that_of_its_processes(tmp_path: Path) -> None:
    script = tmp_path / "script.py"
    script.write_text(LARGE_PARENT)
    said = subprocess.run(
        [sys.executable, str(script)], env={**os.environ, "PYTHONPATH": str(ROOT)},
        capture_output=True, text=True, check=True,
    ).stdout  # fmt: skip
    parent, child = map(int, said.split())
    assert parent > 400 * 2**20 > 2 * child > 0
