"""The wheel of either checkout installed into a fresh environment: its size, the first result, and later ones."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from pathlib import Path
from statistics import median
from typing import Any

__all__ = ["installed_lines"]

#: Goals: the size in MB, the first result over a later one, cold runs new over old.
SIZE, SIZE_THEN, FIRST = 330.0, 605.0, 1.2
COLD = {"proposed": 0.55 / 1.05, "backlash": 0.70 / 1.35}


def installed_lines(sides: Sequence[tuple[Path, Path]], rounds: int) -> Iterator[dict[str, Any]]:
    """Lines of the goals: size, first results, cold runs of the old and the new checkout, each with its examples."""
    with tempfile.TemporaryDirectory(prefix="torsionbook-installed-") as folder:
        homes = [
            _install(root, examples, Path(folder) / str(number))
            for number, (root, examples) in enumerate(sides)
        ]
        sizes = [_megabytes(home) for home in homes]
        yield {
            "what": "environment of requirements/run.txt",
            "old": f"{sizes[0]:.0f} MB", "new": f"{sizes[1]:.0f} MB",
            "ratio": sizes[1] / sizes[0], "goal": f"≤ {SIZE / SIZE_THEN:.2f}",
            "met": sizes[1] / sizes[0] <= SIZE / SIZE_THEN,
            "note": "with pip and bytecode, the wheel included",
        }  # fmt: skip
        for example, goal in COLD.items():
            first = [_cold(home, example) for home in homes]
            later: list[list[tuple[float, float]]] = [[], []]
            for _ in range(rounds):
                for found, home in zip(later, homes, strict=True):
                    found.append(_cold(home, example))
            cpu = [median(c for c, _ in found) for found in later]
            wall = [median(w for _, w in found) for found in later]
            over = [f[0] / c for f, c in zip(first, cpu, strict=True)]
            yield {
                "what": f"first result after installation, {example}: over a later one",
                "old": f"{over[0]:.2f} × ({first[0][0]:.3g} s, wall {first[0][1]:.3g} s)",
                "new": f"{over[1]:.2f} × ({first[1][0]:.3g} s, wall {first[1][1]:.3g} s)",
                "ratio": first[1][0] / first[0][0], "goal": f"≤ {FIRST} ×", "met": over[1] <= FIRST,
                "note": "a new HOME, nothing compiled before; one run",
            }  # fmt: skip
            ratio = median(n[0] / o[0] for o, n in zip(*later, strict=True))
            yield {
                "what": f"cold recalc, {example}",
                "old": f"{cpu[0]:.3g} s ({wall[0]:.3g} s)", "new": f"{cpu[1]:.3g} s ({wall[1]:.3g} s)",
                "ratio": ratio, "goal": f"≤ {goal:.2f}", "met": ratio <= goal,
                "note": "the installed program, everything it compiles compiled before",
            }  # fmt: skip


def _install(root: Path, examples: Path, home: Path) -> Path:
    """The locked packages and the checkout's wheel, as a user installs them."""
    home.mkdir()
    own = root / ".venv" / "bin" / "python"
    pip = ["-m", "pip", "--quiet", "--disable-pip-version-check"]
    wheel = ["wheel", "--no-deps", "--no-build-isolation", "--wheel-dir", str(home), str(root)]
    _run([str(own), *pip, *wheel])
    _run([sys.executable, "-m", "venv", str(home / "env")])
    python = str(home / "env" / "bin" / "python")
    locked = str(root / "requirements" / "run.txt")
    _run([python, *pip, "install", "--require-hashes", "-r", locked])
    _run([python, *pip, "install", "--no-deps", "--no-index", *map(str, home.glob("*.whl"))])
    (home / "HOME").mkdir()
    for file in examples.glob("example_*.xlsx"):
        shutil.copy(file, home)
    return home


def _run(command: list[str]) -> None:
    subprocess.run(command, check=True, stdout=sys.stderr)


def _cold(home: Path, example: str) -> tuple[float, float]:
    """Processor and wall time of one recalculation as a program. [s]"""
    env = {k: v for k, v in os.environ.items() if not k.startswith("PYTHON")}
    began = time.perf_counter()
    process = subprocess.Popen(
        [home / "env/bin/torsionbook", "recalc", f"example_{example}.xlsx", "--out", "out"],
        cwd=home, env=env | {"HOME": str(home / "HOME")},
        stdout=subprocess.DEVNULL,
    )  # fmt: skip
    _, status, used = os.wait4(process.pid, 0)
    wall = time.perf_counter() - began
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode:
        raise RuntimeError(f"recalc of {example} ended with status {process.returncode}")
    return used.ru_utime + used.ru_stime, wall


def _megabytes(home: Path) -> float:
    """What lies in the environment, links not followed. [MB]"""
    return sum(p.lstat().st_size for p in (home / "env").rglob("*") if not p.is_symlink()) / 1e6
