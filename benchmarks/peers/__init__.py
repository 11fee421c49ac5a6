"""Other programs: installed in environments of their own, called in processes of their own.

Only the package names and versions are ours; where pip finds them is the business of whoever set
up the machine. A peer that cannot be had is absent, with the reason.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import threading
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

__all__ = ["PEERS", "Absent", "Peer", "PeerFailed", "Worker", "single_threaded", "start_peer"]

HERE = Path(__file__).parent
#: Longest wait for one answer, unless a worker is told another. [s]
PATIENCE = 600.0
INSTALL_PATIENCE = 900.0
VERSION_QUESTION = "import sys; print('%d.%d' % sys.version_info[:2])"


@dataclass(frozen=True)
class Peer:
    """A program to compare with."""

    name: str
    requirement: str
    worker: str
    python: tuple[int, int]
    """Oldest Python it runs on."""
    chosen_python: str | None = None


PEERS = (
    Peer("openTorsion", "opentorsion==0.3.2", "worker_opentorsion.py", (3, 11)),
    Peer("ROSS", "ross-rotordynamics==3.1.0", "worker_ross.py", (3, 13)),
)


@dataclass(frozen=True)
class Absent:
    """A peer that could not be had."""

    name: str
    reason: str


class PeerFailed(RuntimeError):
    """What a peer's call raised, or that it did not answer."""


def single_threaded() -> dict[str, str]:
    """Environment in which linear algebra uses one core, here and in the peers."""
    names = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")
    return dict.fromkeys(names, "1")


@dataclass(eq=False)
class Worker:
    """A peer that is running: one request at a time, one line of JSON each way."""

    peer: Peer
    process: subprocess.Popen[str]
    hello: dict[str, Any] = field(default_factory=dict)
    patience: float = PATIENCE
    """Longest wait for one answer; a peer that takes longer is stopped. [s]"""

    @property
    def name(self) -> str:
        return self.peer.name

    def read(self) -> dict[str, Any]:
        watchdog = threading.Timer(self.patience, self.process.kill)
        watchdog.start()
        assert self.process.stdout is not None
        line = self.process.stdout.readline()
        watchdog.cancel()
        if not line:
            raise PeerFailed("stopped without an answer (out of time or memory)")
        try:
            answer = json.loads(line)
        except json.JSONDecodeError:
            raise PeerFailed(f"said {line.strip()[:80]!r} where an answer was due") from None
        if "failed" in answer:
            raise PeerFailed(answer["failed"])
        return dict(answer)

    def ask(self, do: str, **request: Any) -> dict[str, Any]:
        """One request to its worker script, and the answer."""
        assert self.process.stdin is not None
        try:
            self.process.stdin.write(json.dumps({"do": do, **request}) + "\n")
            self.process.stdin.flush()
        except BrokenPipeError:
            raise PeerFailed("is no longer running") from None
        return self.read()

    def stop(self) -> None:
        assert self.process.stdin is not None
        self.process.stdin.close()
        try:
            self.process.wait(10.0)
        except subprocess.TimeoutExpired:
            self.process.kill()


def start_peer(peer: Peer, home: Path, *, install: bool) -> Worker | Absent:
    """Install a peer into `home` if it is not there, and start its worker."""
    folder = home.resolve() / peer.requirement
    python = folder / ("Scripts/python.exe" if os.name == "nt" else "bin/python")
    if not (folder / ".ready").exists():
        if not install:
            return Absent(peer.name, "not installed yet; the full benchmark installs it")
        wrong = _install(peer, folder, python)
        if wrong:
            return Absent(peer.name, wrong)
    try:
        process = subprocess.Popen(
            [str(python), str(HERE / peer.worker)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
            encoding="utf-8",
            cwd=folder,
            env=os.environ | single_threaded(),
        )
    except OSError as wrong:
        return Absent(peer.name, f"its environment {folder.name} does not start: {wrong.strerror}")
    worker = Worker(peer, process)
    try:
        worker.hello = worker.read()
    except PeerFailed as wrong:
        return Absent(peer.name, f"its worker {wrong}")
    return worker


def _install(peer: Peer, folder: Path, python: Path) -> str | None:
    """Make the environment; a sentence if that is not possible."""
    base = find_python(peer.python, peer.chosen_python)
    if base is None:
        return "needs Python {}.{} or later, and none was found".format(*peer.python)
    shutil.rmtree(folder, ignore_errors=True)
    pip = [str(python), "-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
    for step, command in (
        ("making its environment", [*base, "-m", "venv", str(folder)]),
        ("installing it", [*pip, peer.requirement]),
    ):
        try:
            done = subprocess.run(command, capture_output=True, text=True, timeout=INSTALL_PATIENCE)
        except (OSError, subprocess.TimeoutExpired) as wrong:
            return f"{step} failed: {type(wrong).__name__}"
        if done.returncode != 0:
            said = (done.stderr or done.stdout).strip().splitlines()
            return f"{step} failed: {said[-1] if said else 'no message'}"
    (folder / ".ready").touch()
    return None


def find_python(oldest: tuple[int, int], chosen: str | None = None) -> list[str] | None:
    """A command that starts a Python at least this old: ours, a named one, or one of pyenv's."""
    if chosen:
        return [chosen] if _version_of([chosen]) >= oldest else None
    if sys.version_info[:2] >= oldest:
        return [sys.executable]
    wanted = [f"{oldest[0]}.{minor}" for minor in range(oldest[1], oldest[1] + 3)]
    commands = [[f"python{v}"] for v in wanted]
    if os.name == "nt":
        commands += [["py", f"-{v}"] for v in wanted]
    commands += [[p] for v in wanted for p in _of_pyenv(v)]
    return next((c for c in commands if _version_of(c) >= oldest), None)


def _of_pyenv(version: str) -> list[str]:
    """Pythons of this version that pyenv holds but does not show."""
    if shutil.which("pyenv") is None:
        return []
    names = _output(["pyenv", "versions", "--bare"]).split()
    prefixes = [_output(["pyenv", "prefix", n]) for n in names if n.startswith(f"{version}.")]
    return [str(Path(p.strip()) / "bin" / "python") for p in prefixes if p.strip()]


def _version_of(command: list[str]) -> tuple[int, int]:
    said = _output([*command, "-c", VERSION_QUESTION]).strip()
    try:
        major, minor = said.split(".")
        return int(major), int(minor)
    except ValueError:
        return (0, 0)


def _output(command: list[str]) -> str:
    """What a program prints; nothing if it is not there or fails."""
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=30.0)
    except (OSError, subprocess.TimeoutExpired):
        return ""
    return done.stdout if done.returncode == 0 else ""
