"""Locked packages for another system: `pip install` of a file in `requirements/`, as on Windows or another Linux."""

from __future__ import annotations

import re
import subprocess
import sys
from collections.abc import Collection, Iterator
from pathlib import Path

from packaging.markers import Marker, default_environment

#: What markers of the lock files ask about.
PYTHON = "3.13"
SYSTEMS = {
    "win_amd64": {"sys_platform": "win32", "platform_system": "Windows", "os_name": "nt"},
    "manylinux_2_28_x86_64": {
        "sys_platform": "linux", "platform_system": "Linux", "os_name": "posix",
    },
}  # fmt: skip


def entries(text: str) -> Iterator[str]:
    """Requirements of a lock file, each with its hashes on lines that end with a backslash."""
    lines = [line for line in text.splitlines() if not line.lstrip().startswith("#")]
    yield from re.findall(r"^\S.*(?:\n\s+\S.*)*", "\n".join(lines), re.MULTILINE)


def wanted(text: str, system: str, without: Collection[str] = ()) -> str:
    """The requirements of a lock file that hold for a system, without their markers."""
    about = default_environment() | SYSTEMS[system]
    about |= {"python_version": PYTHON, "python_full_version": f"{PYTHON}.5"}
    kept = []
    for entry in entries(text):
        first, _, hashes = entry.partition("\\\n")
        name, _, marker = first.partition(";")
        applies = not marker.strip() or Marker(marker.strip()).evaluate(about)
        if applies and name.split("==")[0].strip() not in without:
            kept.append(f"{name.strip()} \\\n{hashes}")
    return "\n".join(kept) + "\n"


def install(lock: Path, system: str, target: Path, without: Collection[str] = ()) -> None:
    """Put the wheels of a lock file into a folder; every hash is checked."""
    target.mkdir(parents=True, exist_ok=True)
    chosen = target.parent / f"{lock.stem}-{system}.txt"
    chosen.write_text(wanted(lock.read_text("utf-8"), system, without), encoding="utf-8")
    platforms = [system]
    if system.startswith("manylinux"):
        platforms += ["manylinux_2_17_x86_64", "manylinux2014_x86_64", "manylinux_2_27_x86_64"]
        platforms += ["manylinux_2_5_x86_64", "manylinux1_x86_64", "linux_x86_64"]
    words = ["--no-deps", "--require-hashes", "--only-binary", ":all:", "--upgrade", "--no-compile"]
    words += ["--python-version", PYTHON, "--implementation", "cp", "--target", target]
    for platform in platforms:
        words += ["--platform", platform]
    quietly = ["--quiet", "--disable-pip-version-check", "--no-input"]
    subprocess.run(
        [sys.executable, "-m", "pip", "install", *quietly, *words, "-r", chosen], check=True
    )
