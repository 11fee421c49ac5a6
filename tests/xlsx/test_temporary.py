"""Files of processes that were killed are removed by the next one in the same folder."""

import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

from addin.xlsx import temporary


@pytest.fixture
def left(tmp_path: Path) -> Path:
    """The file of another process, and where it is."""
    handle, path = temporary.temporary_file(tmp_path, ".tmp")
    os.close(handle)
    temporary._cleared.clear()
    return path


def ended() -> int:
    """Number of a process that is no more."""
    process = subprocess.Popen([sys.executable, "-c", ""])
    process.wait()
    return process.pid


def with_number(path: Path, process: int) -> Path:
    new = path.with_name(path.name.replace(f"-{os.getpid()}-", f"-{process}-"))
    return path.rename(new)


def test_of_an_ended_process_it_is_removed_at_once(left: Path) -> None:
    old = with_number(left, ended())
    temporary.temporary_file(left.parent, ".tmp")
    assert not old.exists()


def test_of_a_running_process_it_stays(left: Path) -> None:
    with subprocess.Popen([sys.executable, "-c", "input()"], stdin=subprocess.PIPE) as running:
        new = with_number(left, running.pid)
        temporary.temporary_file(left.parent, ".tmp")
        assert new.exists()
        running.communicate(b"\n")


def test_a_number_that_another_process_had_before(left: Path) -> None:
    temporary.temporary_file(left.parent, ".tmp")
    assert left.exists()
    temporary._cleared.clear()
    before = time.time() - 3600
    os.utime(left, (before, before))
    temporary.temporary_file(left.parent, ".tmp")
    assert not left.exists()


def test_of_another_machine_it_stays_for_a_day(left: Path) -> None:
    theirs = left.rename(left.with_name(left.name.replace(temporary._place(), "01234567")))
    temporary.temporary_file(left.parent, ".tmp")
    assert theirs.exists()
    temporary._cleared.clear()
    before = time.time() - 25 * 3600
    os.utime(theirs, (before, before))
    temporary.temporary_file(left.parent, ".tmp")
    assert not theirs.exists()
