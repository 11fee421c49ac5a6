"""What the doctor finds on made-up machines, and what it says to do."""

from dataclasses import replace
from pathlib import Path

import pytest

from addin.contract.shipped import template_path
from addin.contract.version import product_version
from addin.excel import doctor
from addin.excel.doctor import GOOD, NOTE, UNKNOWN, WRONG, Machine, checks, examine
from addin.excel.vba import UDF_MODULE, XLWINGS_VERSION
from addin.excel.workbook import Installed, install

LOCAL = r"C:\U\me\AppData\Local"
VENV = LOCAL + r"\torsionbook\venv"
FILE = Path("C:/Jobs/train.xlsm")
FILES = {
    VENV + r"\Scripts\pythonw.exe",
    VENV + rf"\xlwings64-{XLWINGS_VERSION}.dll",
    VENV + rf"\xlwings32-{XLWINGS_VERSION}.dll",
}
HERE = {"xlwings": XLWINGS_VERSION, "torsionbook": product_version()}


def machine(**changes):
    """A Windows machine on which all is well."""
    files = changes.pop("files", FILES)
    usual = Machine(
        windows=True,
        variables={"LocalAppData": LOCAL, "OneDrive": r"C:\U\me\OneDrive"},
        excel=r"C:\Program Files\Microsoft Office\root\Office16\EXCEL.EXE",
        is_file=lambda path: path in files,
        versions=lambda python: HERE if python == VENV + r"\Scripts\python.exe" else None,
        zone=lambda file: "",
    )
    return replace(usual, **changes)


def workbook(**changes):
    """A workbook of this version; None takes a setting out."""
    settings = {
        "Interpreter_Win": r"%LOCALAPPDATA%\torsionbook\venv\Scripts\pythonw.exe",
        "UDF Modules": UDF_MODULE,
        "ADD_WORKBOOK_TO_PYTHONPATH": "False",
    }
    given = changes.pop("settings", {})
    settings = None if given is None else {**settings, **given}
    return replace(Installed(XLWINGS_VERSION, product_version(), settings), **changes)


def found(book=None, at=None, file=FILE):
    return {c.what: c for c in checks(file, book or workbook(), at or machine())}


def test_where_all_is_well_everything_is_ok():
    states = {c.state for c in found().values()}
    assert states == {GOOD}
    assert len(found()) == 8
    assert not any(c.advice for c in found().values())


def test_office_of_the_store_is_found():
    excel = r"C:\Program Files\WindowsApps\Microsoft.Office.Desktop_1\EXCEL.EXE"
    check = found(at=machine(excel=excel))["Excel"]
    assert check.state == WRONG
    assert "Microsoft Store" in check.found
    assert "office.com" in check.advice


def test_no_excel_is_found():
    assert found(at=machine(excel=None))["Excel"].state == WRONG


def test_a_python_that_is_not_there_is_named_with_its_full_path():
    check = found(at=machine(files=set()))["Python (Interpreter_Win)"]
    assert check.state == WRONG
    assert VENV + r"\Scripts\pythonw.exe" in check.found
    assert "torsionbook excel upgrade train.xlsm --interpreter" in check.advice


@pytest.mark.parametrize("path", ["", "python", "pythonw.exe", r"Scripts\pythonw.exe"])
def test_a_python_without_its_full_path_is_wrong(path):
    check = found(workbook(settings={"Interpreter_Win": path}))["Python (Interpreter_Win)"]
    assert check.state == WRONG
    assert f"'{path}'" in check.found


def test_another_xlwings_in_that_python_is_the_commonest_trouble():
    there = {**HERE, "xlwings": "0.38.0"}
    check = found(at=machine(versions=lambda python: there))["Packages in that Python"]
    assert check.state == WRONG
    assert "0.38.0" in check.found
    assert XLWINGS_VERSION in check.found
    assert f"pip install xlwings=={XLWINGS_VERSION}" in check.advice
    assert "torsionbook excel upgrade train.xlsm" in check.advice


def test_another_torsionbook_in_that_python_is_found():
    there = {**HERE, "torsionbook": "9.9"}
    check = found(at=machine(versions=lambda python: there))["Packages in that Python"]
    assert check.state == WRONG
    assert "torsionbook 9.9" in check.found


def test_a_python_without_the_packages_is_found():
    check = found(at=machine(versions=lambda python: None))["Packages in that Python"]
    assert check.state == WRONG
    assert "docs/excel-windows.md" in check.advice


@pytest.mark.parametrize("bits", [64, 32])
def test_a_missing_library_is_named(bits):
    name = f"xlwings{bits}-{XLWINGS_VERSION}.dll"
    check = found(at=machine(files={f for f in FILES if name not in f}))["Library that VBA loads"]
    assert check.state == WRONG
    assert check.found == f"Not found: {name}, neither in {VENV}\\Scripts nor in {VENV}."
    assert "--force-reinstall" in check.advice


def test_the_library_may_lie_beside_python():
    moved = {f.replace(r"\xlwings", r"\Scripts\xlwings") for f in FILES}
    assert found(at=machine(files=moved))["Library that VBA loads"].state == GOOD


def test_a_workbook_of_another_version_is_upgraded():
    check = found(workbook(xlwings="0.36.0"))["Functions in the workbook"]
    assert check.state == WRONG
    assert check.advice == "torsionbook excel upgrade train.xlsm"
    assert found(workbook(product="0.0.1"))["Functions in the workbook"].state == WRONG


def test_a_workbook_without_functions_gets_them_and_no_more_is_checked():
    all_found = found(Installed("", "", None))
    assert list(all_found) == ["Functions in the workbook"]
    assert all_found["Functions in the workbook"].advice == "torsionbook excel install train.xlsm"


@pytest.mark.parametrize(
    "settings",
    [
        None,
        {"UDF Modules": "train"},
        {"ADD_WORKBOOK_TO_PYTHONPATH": "True"},
        {"ADD_WORKBOOK_TO_PYTHONPATH": True},
    ],
)
def test_settings_that_were_changed_are_found(settings):
    check = found(workbook(settings=settings))["Sheet xlwings.conf (very hidden)"]
    assert check.state == WRONG
    assert check.advice == "torsionbook excel upgrade train.xlsm"


def test_names_of_settings_count_in_any_capitals():
    book = workbook(settings={})
    folded = replace(book, settings={k.upper(): v for k, v in book.settings.items()})
    assert {c.state for c in found(folded).values()} == {GOOD}


@pytest.mark.parametrize(
    "file",
    [
        "C:/U/me/OneDrive/train.xlsm",
        "C:/U/me/OneDrive - Firma/train.xlsm",
        "C:/U/me/firma.sharepoint.com/train.xlsm",
    ],
)
def test_synchronised_folders_are_noted_but_not_wrong(file):
    check = found(file=Path(file))["Folder of the workbook"]
    assert check.state == NOTE
    assert "local" in check.advice


def test_a_synchronised_folder_is_known_by_the_variable_of_windows():
    at = machine(variables={"LOCALAPPDATA": LOCAL, "OneDriveCommercial": r"D:\Cloud"})
    where = r"D:\Cloud\Jobs\train.xlsm"
    assert found(at=at, file=Path(where))["Folder of the workbook"].state == NOTE
    assert found(at=at)["Folder of the workbook"].state == GOOD


@pytest.mark.parametrize(("zone", "state"), [("3", WRONG), ("4", WRONG), ("0", GOOD), ("", GOOD)])
def test_a_file_from_the_internet_is_blocked(zone, state):
    check = found(at=machine(zone=lambda file: zone))["Mark of the web"]
    assert check.state == state
    assert ("Unblock" in check.advice) == (state == WRONG)


def test_variables_that_are_not_known_stay():
    at = machine(variables={"LOCALAPPDATA": LOCAL})
    assert at.expanded(r"%localappdata%\a\%NONE%\b") == LOCAL + r"\a\%NONE%\b"


# --- a machine without Windows --------------------------------------------------------------------


def test_what_cannot_be_known_without_windows_is_said_to_be_so():
    here = found(at=machine(windows=False, excel=None), file=Path("train.xlsm"))
    unknown = {what for what, check in here.items() if check.state == UNKNOWN}
    assert unknown == {
        "Excel", "Python (Interpreter_Win)", "Packages in that Python", "Library that VBA loads",
        "Mark of the web",
    }  # fmt: skip
    assert not [c for c in here.values() if c.state == WRONG]


def test_a_real_workbook_on_this_machine(tmp_path):
    install(template_path("blank_si.xlsx"), tmp_path / "train.xlsm")
    states = {c.what: c.state for c in examine(tmp_path / "train.xlsm")}
    assert states["Functions in the workbook"] == GOOD
    assert states["Sheet xlwings.conf (very hidden)"] == GOOD


@pytest.mark.parametrize(("name", "content"), [("none.xlsm", None), ("text.xlsm", b"no workbook")])
def test_what_is_no_workbook_is_said_in_a_sentence(tmp_path, name, content):
    if content is not None:
        (tmp_path / name).write_bytes(content)
    (check,) = examine(tmp_path / name)
    assert check.state == WRONG
    assert name in check.found


def test_the_mark_of_the_web_is_read_from_the_stream_of_the_file(tmp_path):
    """On other systems the stream is an ordinary file of that name."""
    file = tmp_path / "train.xlsm"
    assert doctor._zone(file) == ""
    Path(f"{file}:Zone.Identifier").write_text("[ZoneTransfer]\nZoneId=3\n")
    assert doctor._zone(file) == "3"


def test_a_python_is_asked_for_its_packages(tmp_path):
    import sys

    asked = doctor._versions_there(sys.executable)
    assert asked == HERE
    assert doctor._versions_there(str(tmp_path / "python.exe")) is None
