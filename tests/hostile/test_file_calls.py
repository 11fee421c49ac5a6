"""A sample of the kills and failing calls of benchmarks/file_calls.py."""

import os
import shutil
import subprocess
import sys
import zlib
from pathlib import Path

import pytest

from addin.cli.app import COMMANDS as NAMES
from benchmarks.file_calls import (
    COMMANDS,
    CREATED,
    ENTRY,
    FLUSHED,
    FOLDER_FLUSHED,
    QUICK,
    RENAMED,
    WRITTEN,
    disks_after,
)

ROOT = Path(__file__).resolve().parents[2]


def test_what_was_not_flushed_is_not_on_the_disk(tmp_path: Path) -> None:
    """A file that is renamed before it is flushed may be empty after a power failure; one that is flushed is whole."""
    place, made = str(tmp_path / "a"), str(tmp_path / "new")

    def states(*what: int) -> list[dict[str, bytes]]:
        log = b""
        for one in what:
            first = {CREATED: made, RENAMED: made, FOLDER_FLUSHED: str(tmp_path)}.get(one, "")
            second, data = (place if one == RENAMED else ""), (b"new" if one == WRITTEN else b"")
            log += ENTRY.pack(one, 7, 0, len(first), len(second), len(data))
            log += first.encode() + second.encode() + data
        (tmp_path / "log").write_bytes(log)
        return [
            files for _, files in disks_after(tmp_path / "log", {"a": b"old"}, {3: "a"}, tmp_path)
        ]

    careless = states(CREATED, WRITTEN, RENAMED, FOLDER_FLUSHED)
    assert {files["a"] for files in careless} >= {b"old", b""}
    careful = states(CREATED, WRITTEN, FLUSHED, RENAMED, FOLDER_FLUSHED)
    assert {files["a"] for files in careful} == {b"old", b"new"}
    assert {files["a"] for files in careful[-4:]} == {b"new"}


def test_every_command_that_writes_is_hindered() -> None:
    writes_nothing = {
        "check",
        "serve",
        "mcp",
        "version",
    }  # the folder of mcp gets what recalc writes
    assert {one.words[0] for one in COMMANDS} == set(NAMES) - writes_nothing
    assert set(QUICK) < {one.name for one in COMMANDS}


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="LD_PRELOAD")
def test_a_command_that_is_hindered_loses_nothing() -> None:
    """One of the quick ones; which one changes with the changelog."""
    if shutil.which(os.environ.get("CC", "cc")) is None:
        pytest.skip("no C compiler")
    which = zlib.crc32((ROOT / "CHANGELOG.md").read_bytes())
    done = subprocess.run(
        [sys.executable, "-m", "benchmarks.file_calls", "--every", "8", "--one-of-quick", str(which)],
        cwd=ROOT, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr
    assert ": 0 faults" in done.stdout.splitlines()[-1]
