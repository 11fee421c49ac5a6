"""Commands killed under Wine, at calls of the file system: `python -m benchmarks.wine_kills --record`.

The commands of `file_calls`, in the Windows Python of `scripts/windows.py`. There is no library to put in front of Windows' own: an
audit hook of Python counts, in all processes of a command, what concerns its folder (opening for writing, renaming, removing, folders,
flushing, and each write of Python's own files), and TerminateJobObject ends them all before one of them, or halfway through a write.
The same is demanded as on Linux, of the files and of the same command run again there.
"""

from __future__ import annotations

import argparse
import json
import os
import signal
import struct
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from benchmarks.file_calls import (
    COMMANDS,
    KILL,
    ROOT,
    Calls,
    Command,
    Ended,
    Hindrance,
    Study,
    Trial,
    Watched,
    names_of,
    originals_of,
    prepared,
)

sys.path.insert(0, str(ROOT / "scripts"))
import windows  # noqa: E402

__all__ = ["RECORD", "study"]

RECORD = windows.KILLS
#: In each process, as its `sitecustomize.py`.
HOOK = r"""
import builtins, ctypes, io, mmap, os, signal, stat, struct, sys, threading, time
folder, at, counts = os.environ["TORSIONBOOK_CALLS"].split("|")
at, inside = int(at), os.path.normcase(os.path.abspath(folder))
handle = os.open(counts, os.O_RDWR | os.O_BINARY)
calls = mmap.mmap(handle, 16)
os.close(handle)
kernel = ctypes.WinDLL("kernel32")
for name in ("GetCurrentProcess", "CreateJobObjectW", "CreateMutexW"):
    getattr(kernel, name).restype = ctypes.c_void_p
name = "torsionbook" + os.path.basename(os.path.dirname(counts))
job, lock = (ctypes.c_void_p(make(None, *more)) for make, more in ((kernel.CreateJobObjectW, [name]), (kernel.CreateMutexW, [0, name + "-lock"])))
me, in_job = ctypes.c_void_p(kernel.GetCurrentProcess()), ctypes.c_int()
kernel.IsProcessInJob(me, job, ctypes.byref(in_job))
if not in_job and not kernel.AssignProcessToJobObject(job, me):
    raise OSError("no job object")

def count(halfway=lambda: None):
    kernel.WaitForSingleObject(lock, 0xFFFFFFFF)
    number = struct.unpack("qq", calls)[0] + 1
    calls[:] = struct.pack("qq", number, number == at)
    if number == at:
        halfway()
        kernel.TerminateJobObject(job, 1)
        kernel.WaitForSingleObject(me, 0xFFFFFFFF)
    kernel.ReleaseMutex(lock)

def concerns(path):
    try:
        if isinstance(path, int):
            return stat.S_ISREG(os.fstat(path).st_mode)
        return os.path.normcase(os.path.abspath(os.fspath(path))).startswith(inside)
    except (OSError, TypeError, ValueError):
        return False

NAMES = {"os.rename", "os.remove", "os.mkdir", "os.rmdir", "os.link", "os.truncate", "os.chmod"}
WRITES = os.O_WRONLY | os.O_RDWR | os.O_CREAT | os.O_TRUNC

def hook(event, arguments):
    if event == "open":
        if arguments[2] and arguments[2] & WRITES and not isinstance(arguments[0], int) and concerns(arguments[0]):
            count()
    elif event in NAMES and concerns(arguments[0]):
        count()

class Counted:
    def __init__(self, file):
        self.file = file
    def __getattr__(self, name):
        return getattr(self.file, name)
    def __enter__(self):
        self.file.__enter__()
        return self
    def __exit__(self, *problem):
        return self.file.__exit__(*problem)
    def __iter__(self):
        return iter(self.file)
    def write(self, data):
        def half():
            self.file.write(data[: len(data) // 2])
            self.file.flush()
        count(half)
        return self.file.write(data)

plain, flush = io.open, os.fsync

def opened(path, mode="r", *more, **named):
    file = plain(path, mode, *more, **named)
    return Counted(file) if set(mode) & set("wax+") and concerns(path) else file

def flushed(handle):
    count()
    flush(handle)

def end_with_ctrl_c(wish):
    while not os.path.exists(wish):
        time.sleep(0.05)
    signal.raise_signal(signal.SIGINT)

if "--multiprocessing-fork" not in sys.orig_argv:
    threading.Thread(target=end_with_ctrl_c, args=[counts + "-end"], daemon=True).start()
builtins.open = io.open = opened
os.fsync = flushed
sys.addaudithook(hook)
"""


def ended(command: Command, folder: Path, hindrance: Hindrance) -> Ended:
    """Run a command in a folder under Wine."""
    with tempfile.TemporaryDirectory(prefix="hook-") as beside:
        counts, hook = Path(beside, "counts"), windows.SITE_CUSTOMIZE + HOOK
        counts.write_bytes(bytes(16))
        Path(beside, "sitecustomize.py").write_text(hook, encoding="utf-8")
        at = hindrance.at if hindrance.way == KILL else 0
        calls = [windows.wine_path(folder), str(at), windows.wine_path(counts)]
        environment = {k: v for k, v in os.environ.items() if not k.startswith("PYTHON")}
        environment |= windows.WINE | {
            "PYTHONHOME": windows.wine_path(windows.PYTHON),
            "PYTHONPATH": windows.wine_path(Path(beside)),
            "TORSIONBOOK_CALLS": "|".join(calls),
            "COLUMNS": "1000",
            "SOURCE_DATE_EPOCH": "1800000000",
        }
        said, watched = bytearray(), Watched(folder)

        def hear(line: bytes) -> None:
            said.extend(line)
            if command.watches and watched.is_done(said.decode(errors="replace")):
                Path(beside, "counts-end").touch()

        words = [windows.PYTHON / "python.exe", "-m", "addin.cli", *command.words]
        status = windows.through_pipes(words, folder, environment, hear)
        made, killed = struct.unpack("qq", counts.read_bytes())
    status = -signal.SIGKILL if killed else status
    return Ended(status, said.decode(errors="replace"), Calls(made, made))


def study(command: Command, originals: dict[str, bytes], most: int, until: float) -> Study:
    """A command killed at some of its calls, evenly spread, while there is time."""
    found = Study()
    trial = Trial(command, originals, found, run=ended)
    with tempfile.TemporaryDirectory(prefix="calls-") as place:
        trial.undisturbed(Path(place, "log"), Path(place))
    if not found.faults:
        for at in range(1, found.calls.changes + 1, -(-found.calls.changes // most)):
            if time.monotonic() < until and not trial.hindered("killed", Hindrance(KILL, at)):
                found.faults.append(f"{command.name}: was not killed at {at}")
    return found


def record(command: Command, done: Study) -> None:
    """Keep what was tried, for docs/windows.md."""
    kept = json.loads(RECORD.read_text("utf-8")) if RECORD.exists() else {}
    kept[command.name] = {
        "calls": done.calls.changes,
        "killed": done.tried["killed"],
        "again": done.tried["again"],
        "faults": done.faults,
    }
    RECORD.write_text(json.dumps(kept, indent=1, sort_keys=True) + "\n", encoding="utf-8")
    windows.write_page()


def main(given: Sequence[str] | None = None) -> int:
    """Kill the commands; 1 where something was lost or torn."""
    words = argparse.ArgumentParser(prog="python -m benchmarks.wine_kills")
    words.add_argument("--most", type=int, default=10**6, help="kills of a command")
    words.add_argument("--only", action="append", help="one command, by its name; may be repeated")
    words.add_argument("--minutes", type=float, default=1e6, help="begin nothing after that")
    words.add_argument(
        "--record", action="store_true", help=f"keep it in {RECORD.name} and docs/windows.md"
    )
    asked = words.parse_args(given)
    commands = [one for one in COMMANDS if asked.only is None or one.name in asked.only]
    windows.prepare()
    windows.lay_checkout()
    windows.begin()
    until, total, faults = time.monotonic() + 60 * asked.minutes, Counter[str](), 0
    try:
        with tempfile.TemporaryDirectory(prefix="calls-") as place:
            files = prepared(Path(place), set().union(*map(names_of, commands)), ended)
            for command in commands:
                done = study(command, originals_of(command, files), asked.most, until)
                total.update(done.tried)
                faults += len(done.faults)
                if asked.record and done.tried["killed"]:
                    record(command, done)
                print(f"{command.name}: {done.calls.changes} calls, {dict(done.tried)}, {len(done.faults)} faults", flush=True)  # fmt: skip
    finally:
        windows.end()
    print(f"in all: {dict(total)}: {faults} faults")
    return int(bool(faults))


if __name__ == "__main__":
    sys.exit(main())
