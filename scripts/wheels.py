"""The wheels of all systems, from this one: `python scripts/wheels.py FOLDER`.

Each is unpacked, and its library must be one for its system and processor, made from these sources, that asks for
no newer C library than its tag says. Needs the package ziglang.
"""

from __future__ import annotations

import os
import re
import struct
import subprocess
import sys
import zipfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from hatch_build import KERNELS, TARGET, TARGETS, sources_digest  # noqa: E402

#: Machine numbers of ELF, Mach-O and PE.
ELF = {62: "x86_64", 183: "aarch64"}
MACH = {0x01000007: "x86_64", 0x0100000C: "arm64"}
PE = {0x8664: "amd64"}


def kind_of(library: bytes) -> tuple[str, str]:
    """Form and processor of a library, from its first bytes."""
    if library[:4] == b"\x7fELF":
        return "ELF", ELF.get(struct.unpack_from("<H", library, 18)[0], "another processor")
    if library[:4] == b"\xcf\xfa\xed\xfe":
        return "Mach-O", MACH.get(struct.unpack_from("<I", library, 4)[0], "another processor")
    if library[:2] == b"MZ":
        at = struct.unpack_from("<I", library, 60)[0]
        return "PE", PE.get(struct.unpack_from("<H", library, at + 4)[0], "another processor")
    return "unknown", ""


def newest_glibc(library: bytes) -> tuple[int, int]:
    """Newest version of the GNU C library that a library asks for; (0, 0) if none."""
    asked = re.findall(rb"GLIBC_(\d+)\.(\d+)", library)
    return max(((int(a), int(b)) for a, b in asked), default=(0, 0))


def wrong_with(wheel: Path, tag: str) -> list[str]:
    """What is wrong with a wheel; nothing if it is sound."""
    form = "PE" if tag.startswith("win") else "Mach-O" if tag.startswith("macosx") else "ELF"
    processor = tag.removeprefix("win_") if form == "PE" else "_".join(tag.split("_")[3:])
    with zipfile.ZipFile(wheel) as archive:
        names = [n for n in archive.namelist() if n.startswith(f"{KERNELS.as_posix()}/_loops")]
        if len(names) != 1:
            return [f"it holds the libraries {names}, not one"]
        library = archive.read(names[0])
    found = []
    if kind_of(library) != (form, processor):
        found.append(f"the library is {kind_of(library)}, not {(form, processor)}")
    if f"sources {sources_digest(ROOT / KERNELS)}".encode() not in library:
        found.append("the library is not from these sources")
    limit = (2, 17) if tag.startswith("manylinux") else (0, 0)
    if newest_glibc(library) > limit:
        found.append(f"the library asks for glibc {newest_glibc(library)}")
    return found


def built(tag: str, folder: Path) -> Path:
    """The wheel of one system."""
    quietly = ["--quiet", "--disable-pip-version-check", "--no-deps", "--no-build-isolation"]
    subprocess.run(
        [sys.executable, "-m", "pip", "wheel", *quietly, "--wheel-dir", str(folder), str(ROOT)],
        env=os.environ | {TARGET: tag},
        check=True,
    )
    (wheel,) = folder.glob(f"*-{tag}.whl")
    return wheel


def main(folder: Path) -> int:
    """Build and look into all; 1 where one is wrong."""
    folder.mkdir(parents=True, exist_ok=True)
    wrong = 0
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        wheels = list(pool.map(built, TARGETS, [folder] * len(TARGETS)))
    for tag, wheel in zip(TARGETS, wheels, strict=True):
        found = wrong_with(wheel, tag)
        wrong += bool(found)
        print(f"{wheel.name}: {wheel.stat().st_size / 1e6:.2f} MB; {'; '.join(found) or 'sound'}")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1])))
