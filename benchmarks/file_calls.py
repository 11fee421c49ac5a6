"""Commands killed, failing and losing power at every call of the file system: `python -m benchmarks.file_calls`.

A library between the program and the C library (file_calls.c, loaded with LD_PRELOAD) counts the calls that concern the
folder of a command, in all its processes, and hinders one of them. Each command is

- killed before each call that changes something, and in the middle of each write;
- given an error (no space, input/output, no permission, quota) at each call, reads too;
- run on a disk that is full from each call on which needs room;
- robbed of the power after each change: from the record of one run, the disk is put together as it may be then, without
  what was not flushed, without the names whose folder was not flushed, and with any half of both.

Demanded after each: no input lost, no file torn, a sentence and no traceback, after success every file there; and the
same command, run again, succeeds and leaves no litter. Linux, with a C compiler.
"""

from __future__ import annotations

import argparse
import contextlib
import ctypes
import errno
import hashlib
import importlib
import json
import os
import platform
import random
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import time
import zipfile
from collections import Counter
from collections.abc import Callable, Iterator, Sequence, Set
from dataclasses import dataclass, field, replace
from pathlib import Path

__all__ = ["COMMANDS", "RECORD", "Command", "Hindrance", "Watched", "disks_after", "study"]

ROOT = Path(__file__).resolve().parents[1]
RECORD = Path(__file__).parent / "records" / "file_calls.json"
#: How long one command may take. [s]
PATIENCE = 180
COUNT, KILL, KILL_HALFWAY, FAIL, FULL = range(5)
CREATED, TRUNCATED, WRITTEN, FLUSHED, RENAMED, REMOVED, FOLDER_MADE, FOLDER_FLUSHED, LINKED = range(
    1, 10
)
CONTROL, ENTRY = struct.Struct("7q1024s1024s"), struct.Struct("6q")
ERRORS = (errno.ENOSPC, errno.EIO, errno.EACCES, errno.EDQUOT)
#: The folder of a batch for its own files.
OWN = ".torsionbook-batch"
WAYS = ("killed", "error", "full disk", "power lost")
BOOKS, WHOLE = (".xlsx", ".xlsm"), (".docx", ".oxt")


@dataclass(frozen=True)
class Command:
    """A command, and what it is run on."""

    name: str
    words: tuple[str, ...]
    inputs: tuple[str, ...] = ("train.xlsx",)
    again: tuple[str, ...] = ()  #: Words of the second run where they differ, once `made` is there.
    made: str = ""
    watches: bool = False  #: Whether it runs until Ctrl-C.
    every: int = 1  #: One of so many of its calls is hindered, for slow ones.


_BATCH = ("batch", "train.xlsx", "--out", "results", "--jobs", "1")
_VARY = ("batch", "train.xlsx", "--vary", "table.csv", "--csv", "--out", "results", "--jobs", "1")
COMMANDS = (
    Command("recalc", ("recalc", "train.xlsx", "--json", "train.json")),
    Command("recalc --in-place", ("recalc", "train.xlsx", "--in-place")),
    Command("recalc with a history", ("recalc", "history.xlsx", "--in-place"), ("history.xlsx",), every=2),
    Command("recalc of a JSON", ("recalc", "case.json", "--json", "results.json"), ("case.json",)),
    Command("batch", _BATCH, again=(*_BATCH, "--resume"), made="results", every=8),
    Command("batch --summary", (*_BATCH, "--summary", "sum.xlsx", "--json", "results"),
            again=(*_BATCH, "--summary", "sum.xlsx", "--json", "results", "--resume"), made="results", every=12),
    Command("batch --watch", (*_BATCH, "--watch"), again=(*_BATCH, "--resume"), made="results", watches=True, every=24),
    Command("batch --vary", _VARY, ("train.xlsx", "table.csv"), again=(*_VARY, "--resume"), made="results", every=8),
    Command("tolerances", ("tolerances", "train.xlsx", "--add", "--samples", "30", "--samples", "samples.csv", "--jobs", "1",
            "--out", "studied.xlsx", "--json", "study.json"), every=2),
    Command("tune", ("tune", "train.xlsx", "--add", "--in-place", "--jobs", "1", "--json", "study.json", "--cases", "best"), every=3),
    Command("sensitivities", ("sensitivities", "train.xlsx", "--in-place", "--jobs", "1"), every=2),
    Command("calibrate", ("calibrate", "measured.xlsx", "--in-place", "--jobs", "1", "--case", "calibrated.json"),
            ("measured.xlsx",)),
    Command("starts", ("starts", "studies.xlsx", "--in-place", "--jobs", "1"), ("studies.xlsx",), every=2),
    Command("accuracy", ("accuracy", "studies.xlsx", "--in-place", "--quick"), ("studies.xlsx",), every=24),
    Command("report", ("report", "train.xlsx", "--pdf", "report.pdf", "--docx", "report.docx", "--force"), every=4),
    Command("new --force", ("new", "made.xlsx", "--from", "train.xlsx", "--force")),
    Command("upgrade", ("upgrade", "example.xlsx"), ("example.xlsx",), every=2),
    Command("excel install", ("excel", "install", "train.xlsx", "--out", "installed.xlsm", "--force")),
    Command("excel upgrade", ("excel", "upgrade", "macros.xlsm"), ("macros.xlsm",)),
    Command("calc install", ("calc", "install", "--to", "made.oxt", "--force"), ()),
    Command("import", ("import", "train.csv", "--out", "imported.xlsx", "--force"), ("train.csv",)),
    Command("export", ("export", "train.xlsx", "case.json")),
    Command("diff", ("diff", "train.xlsx", "example.xlsx", "--xlsx", "diff.xlsx", "--json", "diff.json"),
            ("train.xlsx", "example.xlsx")),
    Command("verify", ("verify", "train.xlsx", "--json", "verified.json")),
)  # fmt: skip
#: Of which a run of the tests takes one.
QUICK = (
    "recalc",
    "recalc --in-place",
    "recalc of a JSON",
    "excel install",
    "excel upgrade",
    "calc install",
    "export",
    "verify",
)


@dataclass(frozen=True)
class Hindrance:
    """What is done to a command, and when."""

    way: int = COUNT
    at: int = 0  #: Number of the call.
    error: int = 0
    log: str = ""  #: Where changes are recorded.

    def control(self, folder: Path) -> bytes:
        """The file that the library reads."""
        names = (str(folder).encode(), self.log.encode())
        return CONTROL.pack(0, 0, 0, 0, self.at, self.way, self.error, *names)


@dataclass(frozen=True)
class Calls:
    """Calls of a run that concern its folder."""

    all: int = 0
    changes: int = 0  #: That change something.
    grows: int = 0  #: That need room on the disk.
    writes: int = 0


@dataclass(frozen=True)
class Ended:
    """How a run ended."""

    status: int  #: Negative: the signal.
    said: str
    calls: Calls


@dataclass
class Study:
    """What was tried with one command."""

    calls: Calls = Calls()
    tried: Counter[str] = field(default_factory=Counter)
    faults: list[str] = field(default_factory=list)


# --- one run ------------------------------------------------------------------------------------


def ended(command: Command, folder: Path, hindrance: Hindrance) -> Ended:
    """Run a command in a folder, in a process of its own."""
    with tempfile.TemporaryDirectory() as beside:
        out, control = Path(beside, "said"), Path(beside, "control")
        control.write_bytes(hindrance.control(folder))
        process = os.fork()
        if process == 0:
            try:
                _run(command, folder, out, control)
            except KeyboardInterrupt:  # of a command that watched, when it had ended
                os._exit(130)
            finally:  # nothing of this program goes on there
                os._exit(97)
        status = _waited(process, command, folder, out)
        said = out.read_text(errors="replace") if out.exists() else ""
        calls = Calls(*CONTROL.unpack(control.read_bytes())[:4])
        if hindrance.log:
            _load(Path(beside, "modules").read_text().split())
    return Ended(status, said, calls)


def _run(command: Command, folder: Path, out: Path, control: Path) -> None:
    """The command in this process, which then ends."""
    os.setsid()
    os.chdir(folder)
    handle = os.open(out, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
    os.dup2(handle, 1)
    os.dup2(handle, 2)
    os.environ["TORSIONBOOK_FILE_CALLS"] = str(control)  # for the processes that it starts
    sys.argv = ["torsionbook", *command.words]
    from addin.cli.app import main as torsionbook

    status = 0
    ctypes.CDLL(None).file_calls_begin(str(control).encode())
    try:
        torsionbook()
    except SystemExit as end:
        status = end.code if isinstance(end.code, int) else int(bool(end.code))
    except BaseException as wrong:  # noqa: BLE001 - a fault, by its exit status
        status = 99
        print(f"Traceback: {type(wrong).__name__}: {wrong}", flush=True)
    sys.stdout.flush()
    control.with_name("modules").write_text("\n".join(sorted(sys.modules)))
    os._exit(status)


def _load(names: Sequence[str]) -> None:
    """Import what a command has imported, so that the next processes need not."""
    for name in names:
        if name not in sys.modules and name != "__main__":
            with contextlib.suppress(Exception):
                importlib.import_module(name)


@dataclass
class Watched:
    """A command that watches: a file is saved for it once it looks, and it is ended once that is calculated."""

    folder: Path
    saved: float = 0.0
    lines: int = 0

    def is_done(self, said: str) -> bool:
        """Whether to end it, by what it has said so far."""
        now = time.monotonic()
        if not self.saved and "atching" in said:
            time.sleep(0.2)
            shutil.copyfile(self.folder / "example.xlsx", self.folder / "new.xlsx")
            os.replace(self.folder / "new.xlsx", self.folder / "train.xlsx")
            self.saved, self.lines = now, said.count("\n")
        return bool(self.saved) and (said.count("\n") > self.lines or now - self.saved > 15)


def _waited(process: int, command: Command, folder: Path, out: Path) -> int:
    """The end of a process; one that watches gets a file to calculate, and then Ctrl-C."""
    began, watched, told = time.monotonic(), Watched(folder), not command.watches
    while True:
        there, status = os.waitpid(process, os.WNOHANG)
        if there:
            _all_gone(process)
            return os.waitstatus_to_exitcode(status)
        if not told and watched.is_done(out.read_text(errors="replace") if out.exists() else ""):
            os.kill(process, signal.SIGINT)
            told = True
        if time.monotonic() - began > PATIENCE:
            os.killpg(process, signal.SIGKILL)
            os.waitpid(process, 0)
            return 98
        time.sleep(0.005)


def _all_gone(group: int) -> None:
    """Wait until no process of the group is left."""
    until = time.monotonic() + 10
    while time.monotonic() < until:
        try:
            os.killpg(group, 0)
        except ProcessLookupError:
            return
        time.sleep(0.005)
    os.killpg(group, signal.SIGKILL)


# --- the disk after a power failure ---------------------------------------------------------------


@dataclass
class _File:
    """What a file holds, and what of it is on the disk."""

    flushed: bytes | None  # None: never flushed
    data: bytearray
    loose: list[tuple[int, bytes | None]] = field(default_factory=list)  # written, or cut, since

    def change(self, offset: int, data: bytes | None) -> None:
        """Write, or cut."""
        _apply(self.data, offset, data)
        self.loose.append((offset, data))


def _apply(content: bytearray, offset: int, data: bytes | None) -> None:
    if data is None:
        content[offset:] = bytes(max(0, offset - len(content)))
        return
    if offset > len(content):
        content.extend(bytes(offset - len(content)))
    content[offset : offset + len(data)] = data


#: A folder among the files.
_FOLDER = None
_Names = dict[str, _File | None]


def disks_after(
    log: Path, before: dict[str, bytes], held: dict[int, str], folder: Path, seed: int = 0
) -> Iterator[tuple[int, dict[str, bytes]]]:
    """What the disk may hold when the power fails after each change.

    Parameters
    ----------
    log : Path
        Record of the changes. [path]
    before : dict
        Files that were there, by their name in the folder.
    held : dict
        Their names by the number of the file (inode).
    folder : Path
        Where the command ran. [path]
    seed : int
        Decides which half of what was not flushed is on the disk. [number]

    Yields
    ------
    int, dict
        Number of changes before the failure, and the files.
    """
    rng = random.Random(seed)
    root = str(folder)
    names: _Names = {root: _FOLDER}
    names |= {f"{root}/{name}": _File(data, bytearray(data)) for name, data in before.items()}
    sure: _Names = dict(names)
    inodes = {inode: names[f"{root}/{name}"] for inode, name in held.items()}
    loose: list[tuple[set[str], list[tuple[str, _File | None | str]]]] = []
    for number, (what, inode, offset, first, second, data) in enumerate(_entries(log), start=1):
        steps: list[tuple[str, _File | None | str]] = []
        if what == CREATED:
            inodes[inode] = one = _File(None, bytearray())
            steps = [(first, one)]
        elif what == TRUNCATED:
            inodes[inode].change(offset, None)
        elif what == WRITTEN:
            inodes[inode].change(offset, data)
        elif what == FLUSHED:
            one = inodes[inode]
            one.flushed, one.loose = bytes(one.data), []
        elif what in (RENAMED, LINKED):
            steps = [(second, first)]
        elif what == REMOVED:
            steps = [(first, "")]
        elif what == FOLDER_MADE:
            steps = [(first, _FOLDER)]
        elif what == FOLDER_FLUSHED:
            kept = []
            for folders, change in loose:
                if first in folders:
                    _rename(sure, change)
                else:
                    kept.append((folders, change))
            loose = kept
        if steps:
            resolved = _resolved(names, steps, keeps=what == LINKED)
            _rename(names, resolved)
            loose.append(({os.path.dirname(second or first)}, resolved))
        yield number, _content(names, root, lambda one: one.flushed or b"")
        yield number, _content(sure, root, lambda one: bytes(one.data))
        yield number, _content(sure, root, lambda one: one.flushed or b"")
        some = dict(sure)
        for _, change in loose[: rng.randint(0, len(loose))]:
            _rename(some, change)
        yield number, _content(some, root, lambda one: _half(one, rng))


def _entries(log: Path) -> Iterator[tuple[int, int, int, str, str, bytes]]:
    data, at = log.read_bytes(), 0
    while at < len(data):
        what, inode, offset, first, second, size = ENTRY.unpack_from(data, at)
        at += ENTRY.size
        texts = data[at : at + first].decode(), data[at + first : at + first + second].decode()
        at += first + second
        yield what, inode, offset, *texts, data[at : at + size] if what == WRITTEN else b""
        at += size if what == WRITTEN else 0


def _resolved(
    names: _Names, steps: Sequence[tuple[str, _File | None | str]], *, keeps: bool
) -> list[tuple[str, _File | None | str]]:
    """Steps with the files themselves: a name given to a file, or taken away (an empty text)."""
    made: list[tuple[str, _File | None | str]] = []
    for name, what in steps:
        if isinstance(what, str) and what:
            for old in [one for one in names if one == what or one.startswith(f"{what}/")]:
                made.append((name + old[len(what) :], names[old]))
                made += [] if keeps else [(old, "")]
        else:
            made.append((name, what))
    return made


def _rename(names: _Names, change: Sequence[tuple[str, _File | None | str]]) -> None:
    for name, what in change:
        if isinstance(what, str):
            names.pop(name, None)
        else:
            names[name] = what


def _half(one: _File, rng: random.Random) -> bytes:
    content = bytearray(one.flushed or b"")
    for offset, data in one.loose:
        if rng.random() < 0.5:
            _apply(content, offset, data)
    return bytes(content)


def _content(names: _Names, root: str, data) -> dict[str, bytes]:  # type: ignore[no-untyped-def]
    """Files by their name in the folder; those whose folder is not there are not, either."""
    return {
        name[len(root) + 1 :]: data(one)
        for name, one in names.items()
        if one is not _FOLDER and all(up in names for up in _above(name, root))
    }


def _above(name: str, root: str) -> Iterator[str]:
    while name != root:
        name = os.path.dirname(name)
        yield name


# --- the judge ----------------------------------------------------------------------------------

_judged: dict[tuple[str, bytes], str] = {}


def torn(path: Path) -> str:
    """Why a file is not whole; empty if it is."""
    key = path.name, hashlib.sha256(path.read_bytes()).digest()
    if key not in _judged:
        try:
            _judged[key] = _torn(path)
        except Exception as wrong:  # noqa: BLE001 - whatever it is, the file is not whole
            _judged[key] = f"{path.name} is torn: {type(wrong).__name__}: {wrong}"
    return _judged[key]


def _torn(path: Path) -> str:
    from addin.xlsx import open_workbook

    if path.suffix in BOOKS + WHOLE or path.name.endswith(".xlsx.bak"):
        with zipfile.ZipFile(path) as archive:
            if bad := archive.testzip():
                return f"{path.name}: {bad} is torn"
        if path.suffix in BOOKS:
            book = open_workbook(path, read_only=True, ignore_lock=True)
            for sheet in book.sheet_names:
                book.sheet_part(sheet)
    elif path.suffix == ".json":
        json.loads(path.read_text(encoding="utf-8"))
    elif path.suffix == ".csv":
        rows = path.read_text(encoding="utf-8-sig").splitlines()
        separators = {line.count(";") or line.count(",") for line in rows if '"' not in line}
        if (
            not rows
            or not path.read_bytes().endswith(b"\n")
            or path.stem == "samples"
            and len(rows) != 31
        ):
            return f"{path.name} is torn: {len(rows)} rows, {separators}"
    elif path.suffix == ".pdf":
        if not path.read_bytes().rstrip().endswith(b"%%EOF"):
            return f"{path.name} is torn"
    elif path.suffix == ".parquet":
        import pyarrow.parquet as pq

        pq.read_table(path)
    return ""


def visible(folder: Path) -> list[Path]:
    """Files that a user sees."""
    return [
        path
        for path in folder.rglob("*")
        if path.is_file() and not any(one.startswith(".") for one in path.relative_to(folder).parts)
    ]


def faults_in(folder: Path, command: Command, originals: dict[str, bytes]) -> list[str]:
    """What is lost or torn."""
    files = visible(folder)
    found = [fault for path in files if (fault := torn(path))]
    contents = {path.read_bytes() for path in files}
    for name, data in originals.items():
        is_input = name in command.inputs and not (command.watches and name == "train.xlsx")
        if not (folder / name).is_file():
            found.append(f"{name} is gone")
        elif is_input and data not in contents:
            found.append(f"{name}: what it held is nowhere")
    return found


def faults_of(run: Ended, allowed: Sequence[int]) -> list[str]:
    """What is wrong with how a command ended."""
    wrong = "Traceback" in run.said or "[Errno" in run.said or not run.said.strip()
    return (
        [f"exit status {run.status}: {run.said.replace(chr(9472), '')[-600:]}"] if wrong or run.status not in allowed else []
    )  # fmt: skip


def _digest(folder: Path) -> bytes:
    """Of all files; the name of a temporary one is chance."""
    parts = []
    for path in folder.rglob("*"):
        name = path.relative_to(folder)
        shown = (
            str(name.parent / ("temporary" + name.suffix))
            if "torsionbook-" in name.name and name.name != OWN
            else str(name)
        )
        parts.append(
            f"{shown} {hashlib.sha256(path.read_bytes()).hexdigest() if path.is_file() else ''}"
        )
    return hashlib.sha256("\n".join(sorted(parts)).encode()).digest()


def names_in(folder: Path) -> set[str]:
    """Every file, hidden ones too, without the copies that are kept."""
    names = {str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file()}
    return {name for name in names if ".bak" not in name and ".old" not in name}


# --- one command --------------------------------------------------------------------------------


@dataclass
class Trial:
    """A command on fresh files, hindered, judged, and run again."""

    command: Command
    originals: dict[str, bytes]
    study: Study
    names: set[str] = field(default_factory=set)
    status: int = 0
    seen: set[bytes] = field(default_factory=set)
    run: Callable[[Command, Path, Hindrance], Ended] = ended

    def undisturbed(self, log: Path, place: Path) -> dict[int, str]:
        """The run that all others are compared with; the names of the files that were there, by their numbers."""
        self._fill(place, self.originals)
        held = {(place / name).stat().st_ino: name for name in self.originals}
        run = self.run(self.command, place, Hindrance(log=str(log)))
        self.names, self.status = names_in(place), run.status
        self.study.calls = run.calls
        allowed = (0, 1) if self.command.name == "verify" else (0,)
        allowed = (0, 130) if self.command.watches else allowed
        self._note(
            "undisturbed",
            [*faults_of(run, allowed), *faults_in(place, self.command, self.originals)],
        )
        return held

    def hindered(self, way: str, hindrance: Hindrance) -> bool:
        """One run that is hindered, and one more; judged."""
        with tempfile.TemporaryDirectory(prefix="calls-") as first:
            folder = Path(first)
            self._fill(folder, self.originals)
            run = self.run(self.command, folder, hindrance)
            killed = run.status == -signal.SIGKILL
            words = f"{way} at {hindrance.at}" + (
                f" ({errno.errorcode[hindrance.error]})" if hindrance.error else ""
            )
            faults = [] if killed else faults_of(run, (0, 1, 2, 130, self.status))
            if not killed and way == "full disk":
                litter = {name for name in names_in(folder) - self.names if OWN not in name}
                faults += [f"litter at once: {name}" for name in sorted(litter)]
            if run.status == 0 and not self.command.watches and self.names - names_in(folder):
                faults.append(
                    f"success without {sorted(self.names - names_in(folder))}: {run.said[-400:]}"
                )
            self._note(words, [*faults, *faults_in(folder, self.command, self.originals)])
            self.again(words, folder)
        self.study.tried[way] += 1
        return killed

    def power_lost(self, at: int, files: dict[str, bytes]) -> None:
        """A disk as it may be after a power failure."""
        with tempfile.TemporaryDirectory(prefix="calls-") as first:
            folder = Path(first)
            self._fill(folder, files)
            words = f"power lost after {at}"
            self._note(words, faults_in(folder, self.command, self.originals))
            self.again(words, folder)
        self.study.tried["power lost"] += 1

    def again(self, words: str, folder: Path) -> None:
        """The command once more, which must succeed and clear up; from equal folders once."""
        state = _digest(folder)
        if state in self.seen:
            return
        self.seen.add(state)
        self.study.tried["again"] += 1
        second = replace(self.command, watches=False)
        if self.command.made:
            there = (folder / self.command.made).exists()
            second = replace(
                second, words=self.command.again if there else _without_watch(self.command.words)
            )
        there = {
            name: (folder / name).read_bytes()
            for name in self.originals
            if (folder / name).is_file()
        }
        run = self.run(second, folder, Hindrance())
        status = 0 if self.command.watches else self.status
        faults = faults_of(run, (status,)) + faults_in(folder, self.command, there)
        left = names_in(folder)
        faults += [f"litter: {name}" for name in sorted(left - self.names)]
        faults += [f"missing: {name}" for name in sorted(self.names - left)]
        self._note(f"{words}, again", faults)

    def _note(self, words: str, faults: Sequence[str]) -> None:
        for fault in faults:
            self.study.faults.append(f"{self.command.name}, {words}: {fault}")
            print(self.study.faults[-1], flush=True)

    @staticmethod
    def _fill(folder: Path, files: dict[str, bytes]) -> None:
        for name, data in files.items():
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            (folder / name).write_bytes(data)


def _without_watch(words: Sequence[str]) -> tuple[str, ...]:
    return tuple(word for word in words if word != "--watch")


def study(
    command: Command, originals: dict[str, bytes], every: int = 1, ways: Sequence[str] = WAYS
) -> Study:
    """A command hindered in all ways, at one of so many calls."""
    found = Study()
    trial = Trial(command, originals, found)
    with (
        tempfile.TemporaryDirectory(prefix="calls-") as first,
        tempfile.TemporaryDirectory() as second,
    ):
        log, place = Path(second, "log"), Path(first)
        held = trial.undisturbed(log, place)
        disks = _distinct(disks_after(log, originals, held, place))
    if found.faults:
        return found
    calls, every = found.calls, every * command.every
    if "killed" in ways:
        for at in range(1, calls.changes + 1, every):
            trial.hindered("killed", Hindrance(KILL, at))
        for at in range(1, calls.writes + 1, every):
            trial.hindered("killed", Hindrance(KILL_HALFWAY, at))
    if "error" in ways:
        for number, at in enumerate(range(1, calls.all + 1, every)):
            trial.hindered("error", Hindrance(FAIL, at, ERRORS[number % len(ERRORS)]))
    if "full disk" in ways:
        for at in range(1, calls.grows + 1, every):
            trial.hindered("full disk", Hindrance(FULL, at))
    if "power lost" in ways:
        for at, files in disks[::every]:
            trial.power_lost(at, files)
    return found


def _distinct(disks: Iterator[tuple[int, dict[str, bytes]]]) -> list[tuple[int, dict[str, bytes]]]:
    """Each disk once."""
    seen, distinct = set[bytes](), []
    for at, files in disks:
        digest = hashlib.sha256()
        for name, data in sorted(files.items()):
            digest.update(name.encode() + b"\0" + hashlib.sha256(data).digest())
        if digest.digest() not in seen:
            seen.add(digest.digest())
            distinct.append((at, files))
    return distinct


# --- all of them --------------------------------------------------------------------------------


def prepared(
    folder: Path, names: Set[str], run: Callable[[Command, Path, Hindrance], Ended] = ended
) -> dict[str, bytes]:
    """The files that commands find: inputs, and results of an earlier run that they replace; those of the names, and what they are made from."""
    from addin.xlsx import open_workbook
    from benchmarks.workbook_fuzz import seeds

    (folder / "train.xlsx").write_bytes(seeds()[0].data)
    shutil.copyfile(ROOT / "templates" / "example_studies.xlsx", folder / "studies.xlsx")
    (folder / "table.csv").write_text(
        "case,RatedTorque\nfirst,1000\nsecond,1100\n", encoding="utf-8"
    )
    for made, words in (
        ("example.xlsx", ("new", "example.xlsx", "--from", "train.xlsx")),
        ("made.xlsx", ("new", "made.xlsx")),
        ("macros.xlsm", ("excel", "install", "train.xlsx", "--out", "macros.xlsm")),
        ("train.csv", ("export", "train.xlsx", "train.csv")),
        ("case.json", ("export", "train.xlsx", "case.json")),
        # without anything measured the sheets are made and nothing is calculated
        ("measured.xlsx", ("calibrate", "train.xlsx", "--add", "--out", "measured.xlsx")),
    ):
        made_by = run(Command("", words), folder, Hindrance()) if made in names else None
        if made_by and made_by.status and made != "measured.xlsx":
            raise SystemExit(f"{' '.join(words)}: exit status {made_by.status}: {made_by.said}")
    if "history.xlsx" in names:
        book = open_workbook(ROOT / "templates" / "example_proposed.xlsx")
        book.set_name("KeepHistory", "npz")
        book.save(folder / "history.xlsx")
    if "measured.xlsx" in names:
        _measured(folder / "measured.xlsx")
    return {path.name: path.read_bytes() for path in sorted(folder.iterdir())}


def _measured(path: Path) -> None:
    """A measured frequency into the sheets of a calibration."""
    from addin.xlsx import open_workbook

    book = open_workbook(path)
    book.write_table("MeasuredFrequencies", [[1, 14.5, 1]])
    book.save(path.with_name("filled.xlsx"))
    os.replace(path.with_name("filled.xlsx"), path)


def names_of(command: Command) -> set[str]:
    """Files that a command reads or replaces."""
    return {*command.words, *command.inputs} | ({"example.xlsx"} if command.watches else set())


def originals_of(command: Command, files: dict[str, bytes]) -> dict[str, bytes]:
    """The files of a command, of those of all."""
    return {name: data for name, data in files.items() if name in names_of(command)}


def _loaded() -> bool:
    return hasattr(ctypes.CDLL(None), "file_calls_begin")


def _begin_again() -> None:
    """This program once more, with the library in front of the C library."""
    library = Path(tempfile.mkdtemp(prefix="calls-"), "file_calls.so")
    source = Path(__file__).with_suffix(".c")
    compiler = os.environ.get("CC", "cc")
    subprocess.run([compiler, "-O1", "-shared", "-fPIC", "-o", library, source, "-ldl"], check=True)
    threads = {
        "OMP_NUM_THREADS": "1",
        "OPENBLAS_NUM_THREADS": "1",
        "COLUMNS": "1000",
        "SOURCE_DATE_EPOCH": "1800000000",
    }
    environment = {**os.environ, **threads, "LD_PRELOAD": str(library)}
    words = [sys.executable, "-m", "benchmarks.file_calls", *sys.argv[1:]]
    status = subprocess.run(words, env=environment, cwd=ROOT, check=False).returncode
    shutil.rmtree(library.parent)
    raise SystemExit(status)


def _import_commands(commands: Sequence[Command]) -> None:
    """What the processes of the commands need is loaded once, before they fork."""
    from addin.cli.app import module_of

    importlib.import_module("addin.template.study_sheets")
    for command in commands:
        importlib.import_module(module_of(command.words[0]))


def main() -> int:
    """Hinder every command; 1 where something was lost or torn."""
    words = argparse.ArgumentParser(prog="python -m benchmarks.file_calls")
    words.add_argument("--every", type=int, default=1, help="take one of so many calls")
    words.add_argument("--only", action="append", help="one command, by its name; may be repeated")
    words.add_argument("--one-of-quick", type=int, help="one of the quick commands, by a number")
    words.add_argument(
        "--ways", nargs="+", choices=WAYS, default=WAYS, help="how they are hindered"
    )
    words.add_argument(
        "--record", action="store_true", help=f"keep it in {RECORD.name} and docs/safety.md"
    )
    given = words.parse_args()
    if not _loaded():
        _begin_again()
    only = (
        [QUICK[given.one_of_quick % len(QUICK)]] if given.one_of_quick is not None else given.only
    )
    commands = [one for one in COMMANDS if only is None or one.name in only]
    _import_commands(commands)
    began, total, faults = time.monotonic(), Counter[str](), 0
    with tempfile.TemporaryDirectory(prefix="calls-") as place:
        files = prepared(Path(place), set().union(*map(names_of, commands)))
        for command in commands:
            done = study(command, originals_of(command, files), given.every, given.ways)
            total.update(done.tried)
            faults += len(done.faults)
            if given.record:
                _keep(command, done, every=given.every * command.every)
            print(
                f"{command.name}: {done.calls}: {dict(done.tried)}: {len(done.faults)} faults",
                flush=True,
            )
    print(f"in all: {dict(total)}: {faults} faults, {(time.monotonic() - began) / 60:.1f} min")
    return int(bool(faults))


def _keep(command: Command, done: Study, *, every: int) -> None:
    from addin.contract.version import product_version
    from benchmarks.safety_page import write_page

    record = json.loads(RECORD.read_text("utf-8")) if RECORD.exists() else {"commands": {}}
    about = (
        f"torsionbook {product_version()}, Python {platform.python_version()}, {platform.system()}"
    )
    row = record["commands"].setdefault(command.name, dict.fromkeys(WAYS, 0) | {"faults": []})
    row.update(
        {way: count for way, count in done.tried.items() if way in WAYS}
    )  # of ways that are not tried now an earlier run stands
    row.update(calls=done.calls.all, changes=done.calls.changes, faults=done.faults, about=about)
    row.setdefault("every", {}).update(dict.fromkeys(done.tried, every))
    RECORD.write_text(json.dumps(record, indent=1, sort_keys=True) + "\n", encoding="utf-8")
    write_page()


if __name__ == "__main__":
    sys.exit(main())
