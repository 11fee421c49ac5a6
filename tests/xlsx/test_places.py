"""Names and replaced files as Windows has them; the errors of Windows are imitated, so that this runs anywhere."""

from __future__ import annotations

import os
from pathlib import Path, PureWindowsPath

import pytest
import typer

from addin.cli.terminal import refuse_existing, refuse_no_place
from addin.xlsx import open_workbook, places
from addin.xlsx.errors import SaveRefused
from addin.xlsx.places import real_path, refuse_strange_name, replace_file


@pytest.mark.parametrize(
    "name",
    [
        "nul",
        "NUL.xlsx",
        "con.json",
        "Com1.xlsx",
        "lpt³.json",
        "aux .x",
        "ab:c.json",
        "a?.json",
        "a.",
        "a ",
    ],
)
def test_names_that_no_file_can_have(monkeypatch, name):
    monkeypatch.setattr(places, "_IS_WINDOWS", False)
    refuse_strange_name(Path(name))
    monkeypatch.setattr(places, "_IS_WINDOWS", True)
    with pytest.raises(OSError, match="no name that a file can have on Windows"):
        refuse_strange_name(Path("folder") / name)


@pytest.mark.parametrize("name", ["null.xlsx", "com10.json", "x.con", "console.xlsx", "a.b c.json"])
def test_names_that_look_like_them(monkeypatch, name):
    monkeypatch.setattr(places, "_IS_WINDOWS", True)
    refuse_strange_name(Path(name))


@pytest.mark.parametrize(
    "folder", [r"C:\trains", "C:", r"\\server\share", r"\\?\C:\trains", r"\\?\UNC\server\share"]
)
def test_signs_of_drives_and_of_other_machines_are_no_names(monkeypatch, folder):
    monkeypatch.setattr(places, "_IS_WINDOWS", True)
    refuse_strange_name(PureWindowsPath(folder, "train.xlsx"))
    with pytest.raises(OSError, match="no name that a file can have on Windows"):
        refuse_strange_name(PureWindowsPath(folder, "nul.xlsx"))


def test_a_device_is_refused_before_anything_is_calculated(train, monkeypatch):
    """Windows says that it exists, that it is a file, and that it lies elsewhere."""
    monkeypatch.setattr(places, "_IS_WINDOWS", True)
    words = "no name that a file can have on Windows"
    with pytest.raises(typer.BadParameter, match=words):
        refuse_no_place(Path("nul.json"))
    with pytest.raises(typer.BadParameter, match=words):
        refuse_existing(Path("con.xlsx"), force=False)
    with pytest.raises(SaveRefused, match=rf"^nul.xlsx is {words}"):
        open_workbook(train).save(Path("nul.xlsx"))


def test_where_the_console_is_nobody_says(monkeypatch):
    """Of CON Windows tells no place."""

    def nowhere(path):
        raise OSError(22, "Invalid handle", str(path))

    monkeypatch.setattr(os.path, "realpath", nowhere)
    assert real_path(Path("console")) == Path.cwd() / "console"


def refusing(times: int, error: int | None):
    """`os.replace` that first refuses so many times, as where another program has the file open."""
    real, calls = os.replace, []

    def replace(made, place):
        calls.append(made)
        if len(calls) <= times:
            problem = PermissionError(13, "open elsewhere")
            problem.winerror = error
            raise problem
        real(made, place)

    return replace, calls


def test_a_file_that_is_open_for_a_moment_is_replaced_after_it(tmp_path, monkeypatch):
    made, place = tmp_path / "made", tmp_path / "place"
    made.write_text("new")
    place.write_text("old")
    replace, calls = refusing(3, 32)
    monkeypatch.setattr(os, "replace", replace)
    replace_file(made, place)
    assert place.read_text() == "new"
    assert len(calls) == 4


@pytest.mark.parametrize(("error", "most"), [(32, 100), (None, 1), (87, 1)])
def test_it_stays_where_the_other_program_keeps_it(tmp_path, monkeypatch, error, most):
    made, place = tmp_path / "made", tmp_path / "place"
    made.write_text("new")
    place.write_text("old")
    replace, calls = refusing(10**6, error)
    monkeypatch.setattr(os, "replace", replace)
    monkeypatch.setattr(places, "_PATIENCE", 0.2)
    with pytest.raises(PermissionError):
        replace_file(made, place)
    assert place.read_text() == "old"
    assert 1 <= len(calls) <= most
