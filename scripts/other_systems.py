"""The loops of other systems, run here: `python scripts/other_systems.py`.

The calls that starts make of the library of this machine are recorded (`record_calls.py`) and made again of the libraries
that the wheels of other systems carry: on Linux for x86-64 as it is, for aarch64 under qemu, on Windows under Wine. Each has
to leave the same bits, call by call. Exit status 1 unless all do; a system that cannot be run here is named, and
fails only with TORSIONBOOK_REQUIRE_ALL=1.
"""

from __future__ import annotations

import hashlib
import os
import platform
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from itertools import zip_longest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.append(str(ROOT))

import hatch_build  # noqa: E402

REQUIRE_ALL = os.environ.get("TORSIONBOOK_REQUIRE_ALL") == "1"
#: GNU C library for aarch64, of Debian's libc6-arm64-cross.
ARM_ROOT = Path("/usr/aarch64-linux-gnu")
#: A console program needs none of Wine's .NET, browser and entries in menus.
NOT_INSTALLED = "mscoree,mshtml,winemenubuilder.exe="


@dataclass(frozen=True)
class System:
    """A system whose programs this machine may be able to run."""

    tag: str  #: Of its wheel.
    #: Programs that run those of the system, the first that is here; none: they run as they are.
    emulators: tuple[str, ...] = ()
    options: tuple[str, ...] = ()  #: Of the emulator.
    files: tuple[Path, ...] = ()  #: What else it needs.

    def missing(self) -> str:
        """What this machine lacks to run it; empty where it lacks nothing."""
        if not self.emulators:
            is_own = (sys.platform, platform.machine()) == ("linux", "x86_64")
            return "" if is_own else "such a machine"
        lacks = [] if self.emulator() else [self.emulators[0]]
        return " and no ".join([*lacks, *(str(f) for f in self.files if not f.exists())])

    def emulator(self) -> list[str]:
        """Words before those of a program; none where no emulator is here, or none is needed."""
        found = next(filter(None, map(shutil.which, self.emulators)), None)
        return [found, *self.options] if found else []


SYSTEMS = (
    System("manylinux_2_17_x86_64"),
    System(
        "manylinux_2_17_aarch64", ("qemu-aarch64", "qemu-aarch64-static"), ("-L", str(ARM_ROOT)),
        (ARM_ROOT / "lib" / "ld-linux-aarch64.so.1",),
    ),
    System("win_amd64", ("wine",)),
)  # fmt: skip


def driver(compiler: Sequence[str], folder: Path, tag: str) -> Path:
    """The program that makes the calls recorded in a folder, for a system."""
    made = folder / f"replay_{tag}.exe"
    words = [*compiler, "-O2", "-I", folder, "-I", ROOT / hatch_build.KERNELS, "-o", made]
    libraries = [] if tag.startswith("win") else ["-ldl"]
    subprocess.run([*words, ROOT / "scripts" / "replay_calls.c", *libraries], check=True)
    return made


def replayed(words: Sequence[str | Path], prefix: Path) -> list[str]:
    """What a driver prints, a line a call; Wine keeps its Windows in `prefix`."""
    wine = {"WINEPREFIX": str(prefix), "WINEDEBUG": "-all", "WINEDLLOVERRIDES": NOT_INSTALLED}
    environment = os.environ | wine
    done = subprocess.run(words, env=environment, capture_output=True, text=True, check=False)
    if prefix.exists():  # its server would go on writing there
        for end in ("-k", "-w"):
            subprocess.run(["wineserver", end], env=environment, check=False)
    if done.returncode:
        print(f"{words[-2]} ended with {done.returncode}: {done.stderr.strip()}")
    return done.stdout.splitlines()


def command(system: System, folder: Path) -> list[str | Path]:
    """Words that make the recorded calls of the library of a system; library and driver are built."""
    compiler = [*hatch_build.ZIG, "-target", hatch_build.TARGETS[system.tag][0], "-s"]
    library = hatch_build.build_for(ROOT, system.tag)[0]
    program = driver(compiler, folder, system.tag)
    return [*system.emulator(), program, library, folder / "recording"]


def digest(lines: Sequence[str]) -> str:
    """Of all calls."""
    return hashlib.sha256("\n".join(lines).encode()).hexdigest()[:16]


def first_difference(expected: Sequence[str], found: Sequence[str]) -> str:
    """The first call that left something else; empty where none did."""
    for number, (a, b) in enumerate(zip_longest(expected, found), 1):
        if a != b:
            return f"call {number} of {len(expected)} differs: {a}, and there {b}"
    return ""


def same_everywhere(every: int = 1) -> bool:
    """Whether each system leaves what this machine leaves; a line each. Of the starts, every so many."""
    here = [system for system in SYSTEMS if not system.missing()]
    for system in SYSTEMS:
        if system not in here:
            print(f"{system.tag}: not run: no {system.missing()} here")
    with tempfile.TemporaryDirectory() as name, ThreadPoolExecutor(os.cpu_count()) as pool:
        folder = Path(name)
        environment = os.environ | {"OMP_NUM_THREADS": "1"}
        record = [sys.executable, ROOT / "scripts" / "record_calls.py", folder, str(every)]
        subprocess.run(record, env=environment, check=True)
        expected = (folder / "expected").read_text(encoding="utf-8").splitlines()
        print(
            f"{digest(expected)} {len(expected)} calls of the loops, by the library of this machine"
        )
        commands = [command(system, folder) for system in here]
        found = list(pool.map(replayed, commands, [folder / f"wine_{s.tag}" for s in here]))
    for system, lines in zip(here, found, strict=True):
        under = f" under {Path(system.emulator()[0]).name}" if system.emulators else ""
        print(f"{digest(lines)} {system.tag}{under}")
        if difference := first_difference(expected, lines):
            print(f"  {difference}")
    complete = len(here) == len(SYSTEMS) or not REQUIRE_ALL
    return complete and all(lines == expected for lines in found)


if __name__ == "__main__":
    sys.exit(0 if same_everywhere() else 1)
