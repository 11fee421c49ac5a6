"""A sample of the kills and failing calls of benchmarks/file_calls.py."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from benchmarks.file_calls import (
    CREATED,
    ENTRY,
    FLUSHED,
    FOLDER_FLUSHED,
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


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="LD_PRELOAD")
def test_commands_that_are_hindered_lose_nothing() -> None:
    if shutil.which(os.environ.get("CC", "cc")) is None:
        pytest.skip("no C compiler")
    done = subprocess.run(
        [sys.executable, "-m", "benchmarks.file_calls", "--every", "6", "--only", "recalc"],
        cwd=ROOT, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr
    assert "0 faults" in done.stdout.splitlines()[-1]
