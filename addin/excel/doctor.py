"""What is wrong on this machine and in this workbook, and what to do about it.

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

_INSTALL = "Install it as described in docs/excel-windows.md."
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
    try:
        installed = installed_in(open_workbook(file, read_only=True))
    except (PackageError, ExcelError) as wrong:
        return (Check("Workbook", WRONG, str(wrong)),)
    return tuple(checks(file.absolute(), installed, machine or this_machine()))


def checks(file: Path, installed: Installed, machine: Machine) -> Iterator[Check]:
    """All checks, given the facts."""
    yield Check("Functions in the workbook", *_modules(file, installed))
    if not installed.xlwings:
        return
    yield Check(f"Sheet {SETTINGS_SHEET} (very hidden)", *_settings(file, installed))
    yield Check("Excel", *_office(machine))
    python = PureWindowsPath(machine.expanded(installed.interpreter))
    yield Check(f"Python ({INTERPRETER})", *_interpreter(file, installed, python, machine))
    if _is_full(python):
        yield Check("Packages in that Python", *_versions(file, installed, python, machine))
        yield Check("Library that VBA loads", *_library(installed, python, machine))
    yield Check("Folder of the workbook", *_place(file, machine))
    yield Check("Mark of the web", *_mark(file, machine))


#: State of a check, what there is, and what to do if anything.
Finding = tuple[str, ...]


def _upgrade(file: Path) -> str:
    return f"torsionbook excel upgrade {file.name}"


def _modules(file: Path, installed: Installed) -> Finding:
    if not installed.xlwings:
        sentence = f"{file.name} contains no torsionbook functions in its VBA."
        return WRONG, sentence, f"torsionbook excel install {file.name}"
    if (installed.xlwings, installed.product) != (XLWINGS_VERSION, product_version()):
        sentence = (
            f"They are from torsionbook {installed.product or '(unknown)'} and xlwings "
            f"{installed.xlwings}; this computer has {product_version()} and {XLWINGS_VERSION}."
        )
        return WRONG, sentence, _upgrade(file)
    return GOOD, f"torsionbook {installed.product}, xlwings {installed.xlwings}."


def _settings(file: Path, installed: Installed) -> Finding:
    if installed.settings is None:
        return WRONG, "The sheet is missing.", _upgrade(file)
    folded = {name.casefold(): value for name, value in installed.settings.items()}
    modules = str(folded.get("udf modules", "")).split(";")
    beside = str(folded.get("add_workbook_to_pythonpath", "true")).casefold()
    if UDF_MODULE not in modules or beside == "true":
        sentence = (
            f"UDF Modules is '{';'.join(modules)}' and ADD_WORKBOOK_TO_PYTHONPATH is '{beside}'; "
            f"set them to {UDF_MODULE} and False."
        )
        return WRONG, sentence, _upgrade(file)
    return GOOD, f"Functions come from {UDF_MODULE}."


def _office(machine: Machine) -> Finding:
    if not machine.windows:
        return (
            UNKNOWN,
            "This is not Windows.",
            "Use desktop Excel, not the Microsoft Store version, which cannot start Python (File, "
            "Account, About Excel shows 'Microsoft Store').",
        )
    if machine.excel is None:
        return WRONG, "No desktop Excel found.", "Install desktop Excel."
    if "windowsapps" in machine.excel.casefold():
        return (
            WRONG,
            f"Excel comes from the Microsoft Store ({machine.excel}) and cannot start Python.",
            "Uninstall it (Settings, Apps) and install Office from office.com with the same account.",
        )
    return GOOD, machine.excel


def _interpreter(
    file: Path, installed: Installed, python: PureWindowsPath, machine: Machine
) -> Finding:
    named = installed.interpreter
    command = rf'{_upgrade(file)} --interpreter "C:\...\Scripts\pythonw.exe"'
    if not _is_full(python):
        return WRONG, f"The workbook names '{named}', which is not a full path.", command
    if not machine.windows:
        return UNKNOWN, f"The workbook names {named}."
    if not machine.is_file(str(python)):
        sentence = f"The workbook names {named}, but {python} does not exist."
        return WRONG, sentence, f"{_INSTALL} If Python is in another folder: {command}"
    return GOOD, str(python)


def _is_full(python: PureWindowsPath) -> bool:
    """Whether a path says where Python is; one with a variable does, elsewhere than on Windows."""
    return python.is_absolute() or str(python).startswith("%")


def _versions(
    file: Path, installed: Installed, python: PureWindowsPath, machine: Machine
) -> Finding:
    console = str(python.with_name("python.exe"))
    if not machine.windows or not machine.is_file(str(python)):
        needed = f"It needs xlwings {installed.xlwings} and torsionbook {installed.product}."
        return UNKNOWN, "This Python does not exist here.", needed
    versions = machine.versions(console)
    if versions is None:
        sentence = "This Python lacks xlwings or torsionbook, or does not start."
        return WRONG, sentence, _INSTALL
    xlwings, product = versions["xlwings"], versions["torsionbook"]
    if xlwings != installed.xlwings:
        return (
            WRONG,
            f"It has xlwings {xlwings}, but the VBA of the workbook needs {installed.xlwings}. Both "
            "versions must be equal.",
            f'"{console}" -m pip install xlwings=={XLWINGS_VERSION}, then {_upgrade(file)}',
        )
    if product != installed.product:
        return (
            WRONG,
            f"It has torsionbook {product}, but the workbook was made with {installed.product}.",
            f"Run {_upgrade(file)} with the torsionbook of that Python.",
        )
    return GOOD, f"xlwings {xlwings}, torsionbook {product}."


def _library(installed: Installed, python: PureWindowsPath, machine: Machine) -> Finding:
    names = [f"xlwings{bits}-{installed.xlwings}.dll" for bits in (64, 32)]
    if not machine.windows:
        return (
            UNKNOWN,
            f"{names[0]} must be in folder {python.parent.name} or in the folder above it.",
        )
    # VBA looks beside Python, then one folder up, where pip puts it.
    folders = (python.parent, python.parent.parent)
    missing = [n for n in names if not any(machine.is_file(str(f / n)) for f in folders)]
    if missing:
        return (
            WRONG,
            f"Not found: {' and '.join(missing)}, neither in {folders[0]} nor in {folders[1]}.",
            f'"{python.with_name("python.exe")}" -m pip install --force-reinstall --no-deps '
            f"xlwings=={installed.xlwings}. If a virus scanner removed the file, add an exception.",
        )
    return GOOD, f"{names[0]} and the one for 32-bit Excel are there."


def _place(file: Path, machine: Machine) -> Finding:
    full = str(file)
    roots = [
        value
        for name, value in machine.variables.items()
        if name.upper() in ("ONEDRIVE", "ONEDRIVECOMMERCIAL", "ONEDRIVECONSUMER") and value
    ]
    below = any(PureWindowsPath(full).is_relative_to(PureWindowsPath(root)) for root in roots)
    if below or re.search(r"onedrive|sharepoint|://", full, re.I):
        return (
            NOTE,
            f"{full} is synchronised with OneDrive or SharePoint.",
            "Use a local folder: in a synchronised folder the functions work too, but histories "
            "are saved only on local disks, and saving may fail while another computer has the "
            "workbook open.",
        )
    return GOOD, full


def _mark(file: Path, machine: Machine) -> Finding:
    advice = (
        "Close the workbook; in Explorer right-click it, choose Properties, Unblock. Or move it to a "
        "trusted location (File, Options, Trust Center). Then open it and enable macros once."
    )
    if not machine.windows:
        return UNKNOWN, "Windows marks files that came by mail or download.", advice
    if machine.zone(file) in ("3", "4"):
        sentence = "The workbook came from the internet, so Excel blocks its macros."
        return WRONG, sentence, advice
    return GOOD, "The workbook has none; enable macros once when you open it."


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
            zone = re.search(r"ZoneId\s*=\s*(\d)", stream.read())
    except OSError:
        return ""
    return zone[1] if zone else ""
