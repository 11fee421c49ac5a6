"""Commands killed, failing and losing power at every call of the file system: `python -m benchmarks.file_calls`.

Each command runs in a process of its own over a small train, in a folder with the files it needs. At its nth call
that names a file in that folder (open, rename, remove, make a folder, change a mode) or flushes one it is killed, or
the call fails (no space left, input/output error); in the third way it is killed, and every file then loses what was
not flushed (`_power_off`). In the fourth, no file may grow beyond a size. Demanded after each: no input is lost, no
file torn, and the same command, run again, succeeds and leaves no litter. Runs where processes fork (Linux).
"""

from __future__ import annotations

import argparse
import errno
import json
import os
import resource
import shutil
import signal
import sys
import tempfile
import time
import zipfile
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from addin.cli.app import main as torsionbook
from addin.reading.one_file import Unreadable, read_checked
from benchmarks.workbook_fuzz import seeds

#: How long one command may take. [s]
PATIENCE = 120
#: Sizes that no file may exceed in the fourth way. [byte]
SIZES = (0, 1, 4_096, 20_000, 60_000)
ERRORS = (errno.ENOSPC, errno.EIO)
#: Events of the interpreter that name files first.
EVENTS = (
    "open",
    "os.rename",
    "os.remove",
    "os.mkdir",
    "os.rmdir",
    "os.chmod",
    "os.truncate",
    "os.link",
)


@dataclass(frozen=True)
class Command:
    """A command, and the inputs that it must not lose."""

    name: str
    words: tuple[str, ...]
    inputs: tuple[str, ...] = ("train.xlsx",)
    ends: bool = True  #: Whether it ends by itself.


COMMANDS = (
    Command("recalc", ("recalc", "train.xlsx", "--json", "train.json")),
    Command("recalc --in-place", ("recalc", "train.xlsx", "--in-place")),
    Command("tolerances", ("tolerances", "studies.xlsx", "--in-place", "--jobs", "1"), ("studies.xlsx",)),
    Command("tune", ("tune", "studies.xlsx", "--in-place", "--jobs", "1"), ("studies.xlsx",)),
    Command("upgrade", ("upgrade", "example.xlsx"), ("example.xlsx",)),
    Command("new --force", ("new", "made.xlsx", "--force"), ()),
    Command("excel install", ("excel", "install", "train.xlsx", "--out", "installed.xlsm")),
    Command("excel upgrade", ("excel", "upgrade", "macros.xlsm"), ("macros.xlsm",)),
    Command("batch", ("batch", "train.xlsx", "--out", "results", "--jobs", "1")),
    Command("batch --watch", ("batch", "train.xlsx", "--out", "results", "--jobs", "1", "--watch"), ends=False),
)  # fmt: skip


class _Calls:
    """Counts the calls that concern a folder, and does something at one of them."""

    def __init__(self, folder: Path, flushed: Path, at: int, act: Callable[[], object]) -> None:
        self.folder, self.flushed, self.at, self.act = str(folder), flushed, at, act
        self.count = 0
        self.fsync = os.fsync
        self.process = os.getpid()

    def begin(self) -> None:
        """Watch this process from now on."""
        sys.addaudithook(self.audit)
        os.fsync = self.flush

    def audit(self, event: str, words: Sequence[Any]) -> None:
        """Called by the interpreter before whatever it announces."""
        if event in EVENTS and words and isinstance(words[0], str | os.PathLike):
            path = os.path.abspath(os.fspath(words[0]))
            if isinstance(path, str) and path.startswith(self.folder):
                self.step()

    def step(self) -> None:
        """One more call."""
        if os.getpid() == self.process:
            self.count += 1
            if self.count == self.at:
                self.act()

    def flush(self, handle: int) -> None:
        """`os.fsync`, with a record of what the disk then has."""
        self.step()
        self.fsync(handle)
        about = os.fstat(handle)
        place = f"/proc/self/fd/{handle}"
        if os.path.isfile(place):
            shutil.copyfile(os.readlink(place), self.flushed / str(about.st_ino))


def prepared(folder: Path) -> dict[str, Path]:
    """The files that the commands need, by their names."""
    small, macros, _ = seeds()
    (folder / "train.xlsx").write_bytes(small.data)
    for words in (
        ("new", str(folder / "example.xlsx"), "--from", str(folder / "train.xlsx")),
        ("new", str(folder / "studies.xlsx"), "--from", str(folder / "train.xlsx"), "--studies"),
        ("tolerances", str(folder / "studies.xlsx"), "--in-place", "--add", "--jobs", "1"),
        ("tune", str(folder / "studies.xlsx"), "--in-place", "--add", "--jobs", "1"),
        ("excel", "install", str(folder / "train.xlsx"), "--out", str(folder / "macros.xlsm")),
        ("new", str(folder / "made.xlsx")),
    ):
        _, status, said = _ended(Command("", words), folder, folder, 0, lambda: None)
        if status:
            print(f"… {' '.join(words[:2])}: status {status}: {said[-300:]}", file=sys.stderr)
    return {path.name: path for path in folder.iterdir() if path.suffix in (".xlsx", ".xlsm")}


def _ended(
    command: Command,
    folder: Path,
    flushed: Path,
    at: int,
    act: Callable[[], object],
    largest: int | None = None,
) -> tuple[int, int, str]:
    """Calls that a command made, its exit status (negative: the signal) and what it said."""
    out = flushed / "said"
    process = os.fork()
    if process == 0:
        _run(command, folder, _Calls(folder, flushed, at, act), out, largest)
    status = _waited(process, command)
    text = out.read_text(errors="replace") if out.exists() else ""
    count = int((flushed / "count").read_text() or 0) if (flushed / "count").exists() else 0
    return count, status, text


def _run(command: Command, folder: Path, calls: _Calls, out: Path, largest: int | None) -> None:
    """The command in this process, which then ends."""
    os.chdir(folder)
    handle = os.open(out, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
    os.dup2(handle, 1)
    os.dup2(handle, 2)
    sys.argv = ["torsionbook", *command.words]
    status = 0
    if largest is not None:
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (largest, resource.RLIM_INFINITY))
    calls.begin()
    try:
        torsionbook()
    except SystemExit as end:
        status = end.code if isinstance(end.code, int) else int(bool(end.code))
    except BaseException as wrong:  # noqa: BLE001 - reported as a fault by its exit status
        status = 99
        print(f"{type(wrong).__name__}: {wrong}", flush=True)
    resource.setrlimit(resource.RLIMIT_FSIZE, (resource.RLIM_INFINITY, resource.RLIM_INFINITY))
    (calls.flushed / "count").write_text(str(calls.count))
    os._exit(status)


def _waited(process: int, command: Command) -> int:
    """The end of a process; one that does not end by itself is interrupted after its work."""
    began, told = time.monotonic(), False
    while True:
        there, status = os.waitpid(process, os.WNOHANG)
        if there:
            return os.waitstatus_to_exitcode(status)
        took = time.monotonic() - began
        if not command.ends and took > 6 and not told:
            os.kill(process, signal.SIGINT)
            told = True
        if took > PATIENCE:
            os.kill(process, signal.SIGKILL)
            os.waitpid(process, 0)
            return 98
        time.sleep(0.01)


def _power_off(folder: Path, before: dict[int, bytes], flushed: Path) -> None:
    """Take from every file what was not on the disk: a new one is as it was flushed last, or empty."""
    for path in folder.rglob("*"):
        if path.is_file():
            inode = path.stat().st_ino
            kept = flushed / str(inode)
            path.write_bytes(kept.read_bytes() if kept.exists() else before.get(inode, b""))


def torn(path: Path) -> str:
    """Why a file is not whole; empty if it is."""
    try:
        if path.suffix in (".xlsx", ".xlsm"):
            with zipfile.ZipFile(path) as archive:
                if bad := archive.testzip():
                    return f"{path.name}: {bad} is torn"
            if isinstance(read := read_checked(path), Unreadable):
                return f"{path.name}: {read.problems[0].message}" if path.stem != "summary" else ""
        elif path.suffix == ".json" and not path.name.startswith("."):
            json.loads(path.read_text(encoding="utf-8"))
    except Exception as wrong:  # noqa: BLE001 - whatever it is, the file is not whole
        return f"{path.name}: {type(wrong).__name__}: {wrong}"
    return ""


def faults_after(
    command: Command, folder: Path, originals: dict[str, bytes], status: int, said: str
) -> list[str]:
    """What is lost or torn after a command that was hindered."""
    found = [f"exit status {status}: {said[-400:]}"] if status in (3, 98, 99) else []
    visible = [
        path for path in folder.rglob("*") if path.is_file() and not path.name.startswith(".")
    ]
    found += [fault for path in visible if (fault := torn(path))]
    contents = {path.read_bytes() for path in visible}
    found += [f"{name} is lost" for name in command.inputs if originals[name] not in contents]
    found += [f"{name} is gone" for name in originals if not (folder / name).exists()]
    return found


def study(
    command: Command, files: dict[str, Path], every: int, tell: Callable[[str], None]
) -> tuple[Counter[str], list[str]]:
    """One command hindered in the four ways; how often, and what was wrong."""
    originals = {name: path.read_bytes() for name, path in files.items()}
    counted, found = Counter[str](), []

    def once(
        way: str,
        at: int,
        act: Callable[[], object],
        *,
        off: bool = False,
        largest: int | None = None,
    ) -> int:
        with tempfile.TemporaryDirectory() as first, tempfile.TemporaryDirectory() as second:
            folder, flushed = Path(first), Path(second)
            for name, data in originals.items():
                (folder / name).write_bytes(data)
            before = {path.stat().st_ino: path.read_bytes() for path in folder.iterdir()}
            count, status, said = _ended(command, folder, flushed, at, act, largest)
            if off:
                _power_off(folder, before, flushed)
            faults = faults_after(command, folder, originals, status, said)
            if way != "undisturbed":
                again = command if command.ends else COMMANDS[-2]
                resumed = (
                    (*again.words, "--resume")
                    if again.words[0] == "batch" and (folder / "results").exists()
                    else again.words
                )
                if (
                    resumed[0] == "excel"
                    and "--out" in resumed
                    and (folder / "installed.xlsm").exists()
                ):
                    resumed = again.words
                else:
                    _, status, said = _ended(
                        Command(again.name, resumed, again.inputs), folder, flushed, 0, lambda: None
                    )
                    faults += [f"again: exit status {status}: {said[-300:]}"] if status else []
                    faults += [
                        f"again: {fault}"
                        for fault in faults_after(command, folder, originals, 0, "")
                    ]
                    faults += [f"litter: {path.name}" for path in folder.rglob(".torsionbook-*")]
            counted[way] += 1
            found.extend(f"{command.name}, {way}, call {at}: {fault}" for fault in faults)
            return count

    calls = once("undisturbed", 0, lambda: None)
    tell(f"{command.name}: {calls} calls")
    for at in range(1, calls + 1, every):
        once("killed", at, lambda: os.kill(os.getpid(), signal.SIGKILL))
        once("power lost", at, lambda: os.kill(os.getpid(), signal.SIGKILL), off=True)
        once("failing call", at, _failing(ERRORS[at % len(ERRORS)]))
    for size in SIZES[::every]:
        once("file that cannot grow", size, lambda: None, largest=size)
    return counted, found


def _failing(number: int) -> Callable[[], object]:
    def fail() -> None:
        raise OSError(number, os.strerror(number))

    return fail


def main() -> int:
    """Hinder every command; 1 where something was lost or torn."""
    words = argparse.ArgumentParser(prog="python -m benchmarks.file_calls", description=__doc__)
    words.add_argument("--every", type=int, default=1, help="take one of so many calls")
    words.add_argument("--only", help="one command, by its name")
    given = words.parse_args()
    total, faults = Counter[str](), []
    with tempfile.TemporaryDirectory() as place:
        files = prepared(Path(place))
        for command in COMMANDS:
            if given.only in (None, command.name):
                counted, found = study(
                    command,
                    files,
                    given.every,
                    lambda text: print(f"… {text}", file=sys.stderr, flush=True),
                )
                total.update(counted)
                faults += found
                for fault in found:
                    print(fault, flush=True)
                print(f"{command.name}: {dict(counted)}: {len(found)} faults", flush=True)
    print(f"in all: {dict(total)}: {len(faults)} faults")
    return int(bool(faults))


if __name__ == "__main__":
    sys.exit(main())
