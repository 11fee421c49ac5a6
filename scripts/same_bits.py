"""The same bits from every compiler of this machine: `python scripts/same_bits.py`.

The loops are built by cc, clang, gcc (those that are here) and by ziglang, without and with the widest vector
instructions of this machine; each library calculates the same starts. Exit status 1 unless all histories are equal to
the last bit.
"""

from __future__ import annotations

import os
import shlex
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

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


def digest_with(command: str) -> str:
    """Digest of the histories as the loops of one compiler calculate them, and what it calls itself."""
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder)
        shutil.copytree(ROOT / "engine", place / "engine", ignore=shutil.ignore_patterns("_loops*"))
        for name in ("benchmarks", "tests", "hatch_build.py"):
            (place / name).symlink_to(ROOT / name)
        build = f"import hatch_build, pathlib; hatch_build.build(pathlib.Path({folder!r}))"
        python = [sys.executable, "-c"]
        subprocess.run([*python, build], env=os.environ | {"CC": command}, cwd=place, check=True)
        environment = os.environ | {"PYTHONPATH": folder, "OMP_NUM_THREADS": "1"}
        words = [*python, CODE.format(trains=TRAINS)]
        done = subprocess.run(
            words, env=environment, cwd=place, capture_output=True, text=True, check=True
        )
    return done.stdout.strip()


def main() -> int:
    """Digests of all; 1 where they differ."""
    digests = set()
    for command in compilers():
        found = digest_with(command)
        digests.add(found.partition(";")[0])
        print(f"{found} ({command.replace(sys.executable, 'python')})")
    print("The same bits from all of them." if len(digests) == 1 else "FAILED: the bits differ.")
    return 0 if len(digests) == 1 else 1


if __name__ == "__main__":
    sys.exit(main())
