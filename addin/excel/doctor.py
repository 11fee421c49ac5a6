"""What is amiss on this machine and in this workbook, and what to do about it.

Each check is a function of plain facts (`Machine`, `Installed`), so that every finding is tested on a
machine without Windows. What cannot be known here is said to be so, never guessed.
"""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path, PureWindowsPath

from addin.contract.version import product_version
from addin.excel.errors import ExcelError
from addin.excel.vba import UDF_MODULE, XLWINGS_VERSION
from addin.excel.workbook import INTERPRETER, SETTINGS_SHEET, Installed, installed_in
from addin.xlsx import PackageError, open_workbook

#: States of a check.
GOOD, WRONG, NOTE, UNKNOWN = "ok", "wrong", "note", "cannot be checked here"

_INSTALL = "Install it as docs/excel-windows.md says."
_ASK = (
    "import json, importlib.metadata as m\n"
    "print(json.dumps({n: m.version(n) for n in ('xlwings', 'torsionbook')}))"
)
_ASK_SECONDS = 60.0


@dataclass(frozen=True)
class Check:
    """One finding."""

    what: str  #: What was looked at.
    state: str  #: One of `GOOD`, `WRONG`, `NOTE`, `UNKNOWN`.
    found: str  #: What there is.
    advice: str = ""  #: What to do; empty if nothing.


@dataclass(frozen=True)
class Machine:
    """Facts of a machine that the checks need."""

    windows: bool  #: Whether it runs Windows.
    variables: Mapping[str, str]  #: Its environment.
    excel: str | None  #: Path of Excel's program; None if none is registered.
    is_file: Callable[[str], bool]  #: Whether a path is a file.
    #: Path of python.exe → versions of xlwings and torsionbook there; None if it does not answer.
    versions: Callable[[str], Mapping[str, str] | None]
    #: Path of a workbook → its mark of the web, such as ``3``; empty without one.
    zone: Callable[[Path], str]

    def expanded(self, path: str) -> str:
        """A path with the variables of Windows filled in, as VBA does it."""
        known = {name.upper(): value for name, value in self.variables.items()}
        return re.sub(r"%([^%]+)%", lambda m: known.get(m[1].upper(), m[0]), path)


# --- the checks -----------------------------------------------------------------------------------


def examine(file: Path, machine: Machine | None = None) -> tuple[Check, ...]:
    """Check a workbook on a machine."""
    here = machine or this_machine()
    try:
        found = installed_in(open_workbook(file, read_only=True))
    except (PackageError, ExcelError) as wrong:
        return (Check("Workbook", WRONG, str(wrong)),)
    return tuple(checks(file.absolute(), found, here))


def checks(file: Path, found: Installed, machine: Machine) -> Iterator[Check]:
    """All checks, given the facts."""
    yield _modules(file, found)
    if not found.xlwings:
        return
    yield from _settings(file, found)
    yield _office(machine)
    python = PureWindowsPath(machine.expanded(found.interpreter))
    yield _interpreter(file, found, python, machine)
    if _is_full(python):
        yield from _versions(file, found, python, machine)
        yield _library(found, python, machine)
    yield _place(file, machine)
    yield _mark(file, machine)


def _modules(file: Path, found: Installed) -> Check:
    what = "Functions in the workbook"
    if not found.xlwings:
        return Check(
            what,
            WRONG,
            f"{file.name} has no functions in its VBA.",
            f"torsionbook excel install {file.name}",
        )
    upgrade = f"torsionbook excel upgrade {file.name}"
    if (found.xlwings, found.product) != (XLWINGS_VERSION, product_version()):
        return Check(
            what,
            WRONG,
            f"They are of torsionbook {found.product or '(unknown)'} and xlwings {found.xlwings}; "
            f"here are {product_version()} and {XLWINGS_VERSION}.",
            upgrade,
        )
    return Check(what, GOOD, f"torsionbook {found.product}, xlwings {found.xlwings}.")


def _settings(file: Path, found: Installed) -> Iterator[Check]:
    what = f"Sheet {SETTINGS_SHEET} (very hidden)"
    if found.settings is None:
        yield Check(
            what, WRONG, "It is missing.", f"torsionbook excel upgrade {file.name}"
        )  # fmt: skip
        return
    folded = {name.casefold(): value for name, value in found.settings.items()}
    modules = str(folded.get("udf modules", "")).split(";")
    beside = str(folded.get("add_workbook_to_pythonpath", "true")).casefold()
    if UDF_MODULE not in modules or beside == "true":
        yield Check(
            what,
            WRONG,
            f"UDF Modules is '{';'.join(modules)}' and ADD_WORKBOOK_TO_PYTHONPATH is '{beside}'; "
            f"they must be {UDF_MODULE} and False.",
            f"torsionbook excel upgrade {file.name}",
        )
    else:
        yield Check(what, GOOD, f"Functions come from {UDF_MODULE}.")


def _office(machine: Machine) -> Check:
    what = "Excel"
    if not machine.windows:
        return Check(
            what,
            UNKNOWN,
            "This is not Windows.",
            "Excel must be the desktop program, not the one of the Microsoft Store: there Python "
            "cannot be started (File, Account, About Excel shows 'Microsoft Store').",
        )
    if machine.excel is None:
        return Check(what, WRONG, "No desktop Excel is registered.", "Install desktop Excel.")
    if "windowsapps" in machine.excel.casefold():
        return Check(
            what,
            WRONG,
            f"It comes from the Microsoft Store ({machine.excel}), from where Python cannot be "
            "started.",
            "Uninstall it (Settings, Apps) and install Office from office.com with the same account.",
        )
    return Check(what, GOOD, machine.excel)


def _interpreter(file: Path, found: Installed, python: PureWindowsPath, machine: Machine) -> Check:
    what = f"Python ({INTERPRETER})"
    name = rf'torsionbook excel upgrade {file.name} --interpreter "C:\...\Scripts\pythonw.exe"'
    if not _is_full(python):
        return Check(
            what,
            WRONG,
            f"The workbook names '{found.interpreter}', which is no full path.",
            name,
        )
    if not machine.windows:
        return Check(what, UNKNOWN, f"The workbook names {found.interpreter}.")
    if not machine.is_file(str(python)):
        return Check(
            what,
            WRONG,
            f"The workbook names {found.interpreter}; there is no {python}.",
            f"{_INSTALL} If Python is elsewhere: {name}",
        )
    return Check(what, GOOD, str(python))


def _is_full(python: PureWindowsPath) -> bool:
    """Whether a path says where Python is; one with a variable does, elsewhere than on Windows."""
    return python.is_absolute() or str(python).startswith("%")


def _versions(
    file: Path, found: Installed, python: PureWindowsPath, machine: Machine
) -> Iterator[Check]:
    what = "Packages in that Python"
    console = str(python.with_name("python.exe"))
    if not machine.windows or not machine.is_file(str(python)):
        yield Check(
            what,
            UNKNOWN,
            "There is no such Python here.",
            f"It must hold xlwings {found.xlwings} and torsionbook {found.product}.",
        )
        return
    there = machine.versions(console)
    if there is None:
        yield Check(
            what, WRONG, "It has not both xlwings and torsionbook, or does not start.", _INSTALL
        )
        return
    if there["xlwings"] != found.xlwings:
        yield Check(
            what,
            WRONG,
            f"It has xlwings {there['xlwings']}; the workbook's VBA loads the library of "
            f"{found.xlwings}, and the two must be equal.",
            f'"{console}" -m pip install xlwings=={XLWINGS_VERSION}, then '
            f"torsionbook excel upgrade {file.name}",
        )
    elif there["torsionbook"] != found.product:
        yield Check(
            what,
            WRONG,
            f"It has torsionbook {there['torsionbook']}, the workbook is of {found.product}.",
            f"torsionbook excel upgrade {file.name} with the torsionbook of that Python",
        )
    else:
        yield Check(what, GOOD, f"xlwings {there['xlwings']}, torsionbook {there['torsionbook']}.")


def _library(found: Installed, python: PureWindowsPath, machine: Machine) -> Check:
    what = "Library that VBA loads"
    names = [f"xlwings{bits}-{found.xlwings}.dll" for bits in (64, 32)]
    if not machine.windows:
        return Check(
            what, UNKNOWN, f"{names[0]} must lie in the folder above {python.parent.name}."
        )
    # VBA looks beside Python, then one folder up, where pip puts it.
    folders = (python.parent, python.parent.parent)
    missing = [n for n in names if not any(machine.is_file(str(f / n)) for f in folders)]
    if missing:
        return Check(
            what,
            WRONG,
            f"{' and '.join(missing)} is neither in {folders[0]} nor in {folders[1]}.",
            f'"{python.with_name("python.exe")}" -m pip install --force-reinstall --no-deps '
            f"xlwings=={found.xlwings}. If a virus scanner took it away, ask for an exception.",
        )
    return Check(what, GOOD, f"{names[0]} and the one for 32-bit Excel are there.")


def _place(file: Path, machine: Machine) -> Check:
    what = "Folder of the workbook"
    full = str(file)
    roots = [
        value
        for name, value in machine.variables.items()
        if name.upper() in ("ONEDRIVE", "ONEDRIVECOMMERCIAL", "ONEDRIVECONSUMER") and value
    ]
    below = any(PureWindowsPath(full).is_relative_to(PureWindowsPath(root)) for root in roots)
    words = re.search(r"onedrive|sharepoint", full, re.I)
    if below or words or "://" in full:
        return Check(
            what,
            NOTE,
            f"{full} is synchronised with OneDrive or SharePoint.",
            "The functions work there. Histories are kept only on local disks, and a workbook that "
            "another computer has open may refuse to be saved: a local folder is safer.",
        )
    return Check(what, GOOD, full)


def _mark(file: Path, machine: Machine) -> Check:
    what = "Mark of the web"
    advice = (
        "Close it, right-click it in the Explorer, Properties, Unblock; or keep it in a trusted "
        "location (File, Options, Trust Center). Then enable macros once when it is opened."
    )
    if not machine.windows:
        return Check(what, UNKNOWN, "Windows marks files that came by mail or download.", advice)
    if machine.zone(file) in ("3", "4"):
        return Check(what, WRONG, "It came from the internet, so Excel blocks its macros.", advice)
    return Check(what, GOOD, "It has none; enable macros once when it is opened.")


# --- this machine ---------------------------------------------------------------------------------


def this_machine() -> Machine:
    """The facts of this machine."""
    windows = sys.platform == "win32"
    return Machine(
        windows=windows,
        variables=dict(os.environ),
        excel=_registered_excel() if windows else None,
        is_file=lambda path: Path(path).is_file(),
        versions=_versions_there,
        zone=_zone,
    )


def _registered_excel() -> str | None:
    if sys.platform != "win32":
        return None
    import winreg

    key = r"SOFTWARE\Microsoft\Windows\CurrentVersion\App Paths\excel.exe"
    for root in (winreg.HKEY_CURRENT_USER, winreg.HKEY_LOCAL_MACHINE):
        try:
            return str(winreg.QueryValue(root, key))
        except OSError:
            continue
    return None


def _versions_there(python: str) -> Mapping[str, str] | None:
    """Versions of the packages in a Python; None if it does not have both."""
    if Path(python).parent == Path(sys.executable).parent:
        try:
            return {name: metadata.version(name) for name in ("xlwings", "torsionbook")}
        except metadata.PackageNotFoundError:
            return None
    try:
        done = subprocess.run(
            [python, "-c", _ASK], capture_output=True, text=True, timeout=_ASK_SECONDS, check=True
        )
        return dict(json.loads(done.stdout))
    except (OSError, subprocess.SubprocessError, ValueError):
        return None


def _zone(file: Path) -> str:
    """The zone that Windows keeps in a stream beside the file's content; empty without one."""
    try:
        with open(f"{file}:Zone.Identifier", encoding="utf-8", errors="replace") as stream:
            found = re.search(r"ZoneId\s*=\s*(\d)", stream.read())
    except OSError:
        return ""
    return found[1] if found else ""
