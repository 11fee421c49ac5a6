"""The same bits from every compiler and as every processor: `python scripts/same_bits.py [--every N]`.

The library is built by cc, clang, gcc (those that are here) and by ziglang, without and with the widest vector
instructions of this machine; each calculates the same starts, and every fourth result of `results_digest.py`. Then all
results of linear trains are calculated with the routines of OpenBLAS for each processor, without numpy's vector
instructions, and with a C library whose functions are one unit in the last place off (`rounds_otherwise.c`). Last, the
libraries of other systems make the calls of the starts (`other_systems.py`). Exit status 1 unless everything is equal
to the last bit. With --every only each N-th start and result is calculated: the sample of CI.
"""

from __future__ import annotations

import argparse
import os
import shlex
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import other_machines
import other_systems

ROOT = Path(__file__).resolve().parents[1]
#: Random starts: linear ones, and with clearances, bearings, dampers, breaker closing, tables against time.
TRAINS = (*range(0, 20, 2), 7, 9, 13, 19, 21, 25, 29, 31, 33)
CODE = """
import hashlib
from benchmarks.study_trains import study_train
from engine.run import run
from engine.stepping.library import about
digest = hashlib.sha256()
for number in {trains}:
    trajectory = run(study_train(number).case).start.trajectory
    for values in (trajectory.time, trajectory.torque, trajectory.torque_rate, trajectory.mean_speed):
        digest.update(values.tobytes())
print(digest.hexdigest()[:16], about(), sep="; ")
"""


def compilers() -> list[str]:
    """Commands of the compilers that are here."""
    zig = f"{shlex.quote(sys.executable)} -m ziglang cc"
    here = [name for name in ("gcc", "clang") if shutil.which(name)]
    has_zig = not subprocess.run([*shlex.split(zig), "--version"], capture_output=True).returncode
    plain = [*here, zig] if has_zig else here
    return [*plain, *(f"{command} -march=native" for command in plain)]


def digest_with(command: str, every: int) -> str:
    """Digest of the histories as the loops of one compiler calculate them, and what it calls itself."""
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder)
        shutil.copytree(ROOT / "engine", place / "engine", ignore=shutil.ignore_patterns("_loops*"))
        for name in ("addin", "benchmarks", "tests", "hatch_build.py"):
            (place / name).symlink_to(ROOT / name)
        build = f"import hatch_build, pathlib; hatch_build.build(pathlib.Path({folder!r}))"
        python = [sys.executable, "-c"]
        subprocess.run([*python, build], env=os.environ | {"CC": command}, cwd=place, check=True)
        environment = os.environ | {"PYTHONPATH": folder, "OMP_NUM_THREADS": "1"}
        words = [*python, CODE.format(trains=TRAINS[::every])]
        done = subprocess.run(
            words, env=environment, cwd=place, capture_output=True, text=True, check=True
        )
        return f"{results(environment, 4 * every)} {done.stdout.strip()}"


def results(environment: Mapping[str, str], every: int) -> str:
    """Total digest of the results of linear trains, or of every so many."""
    words = [sys.executable, ROOT / "scripts" / "results_digest.py", "--of", "linear"]
    done = subprocess.run(
        [*words, "--every", str(every)], env=environment, capture_output=True, text=True, check=True
    )
    return done.stdout.splitlines()[-1].split()[0]


def machines(folder: Path) -> list[tuple[str, dict[str, str]]]:
    """Ways to calculate that this machine can go, and the variables that choose them."""
    found = [("this machine", {})]
    found += [(m.name, m.environment) for m in other_machines.machines(other_machines.loaded())]
    if sys.platform == "linux" and (compiler := shutil.which("gcc") or shutil.which("clang")):
        library, source = folder / "rounds_otherwise.so", ROOT / "scripts" / "rounds_otherwise.c"
        flags = ["-O1", "-fno-builtin", "-shared", "-fPIC"]
        subprocess.run([compiler, *flags, "-o", library, source, "-ldl", "-lm"], check=True)
        without = dict(found).get("numpy without vector instructions", {})
        found.append(("a C library one unit off", {"LD_PRELOAD": str(library), **without}))
    return found


def on_each_machine(every: int) -> bool:
    """Whether linear trains have the same results whatever calculates beside the library."""
    with tempfile.TemporaryDirectory() as folder, ThreadPoolExecutor(os.cpu_count()) as pool:
        names, chosen = zip(*machines(Path(folder)), strict=True)
        environments = [os.environ | {"OMP_NUM_THREADS": "1"} | c for c in chosen]
        totals = list(pool.map(results, environments, [every] * len(chosen)))
    for name, total in zip(names, totals, strict=True):
        print(f"{total} {name}")
    return len(set(totals)) == 1


def main() -> int:
    """Digests of all; 1 where they differ."""
    parser = argparse.ArgumentParser(prog="same_bits.py")
    parser.add_argument(
        "--every", type=int, default=1, metavar="N", help="each N-th start and result"
    )
    every = parser.parse_args().every
    commands = compilers()
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        found = list(pool.map(digest_with, commands, [every] * len(commands)))
    for told, command in zip(found, commands, strict=True):
        print(f"{told} ({command.replace(sys.executable, 'python')})")
    digests = {told.partition(";")[0] for told in found}
    parts = [len(digests) == 1, on_each_machine(every), other_systems.same_everywhere(every)]
    if not all(parts):
        print("FAILED: bits differ, or a system was not run.")
        return 1
    print("The same bits from all of them.")
    return 0


if __name__ == "__main__":
    sys.exit(main())
