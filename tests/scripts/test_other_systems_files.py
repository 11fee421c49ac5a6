"""What is read of Windows' libraries and of lock files for other systems; pip carries launchers for Windows to try it on."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import pip
import pytest
from script_modules import script_module

from benchmarks.fronts import check_windows

ROOT = Path(__file__).resolve().parents[2]
LAUNCHER = Path(pip.__file__).parent / "_vendor" / "distlib" / "t64.exe"


def test_libraries_that_a_program_asks_for():
    asked = script_module("pe_files").PeFile.read(LAUNCHER).imports()
    assert "kernel32.dll" in asked
    assert "CreateProcessW" in asked["kernel32.dll"]


@pytest.mark.parametrize("name", ["w32.exe", "t64-arm.exe"])
def test_other_processors_are_refused(name):
    with pytest.raises(ValueError, match="x86-64"):
        script_module("pe_files").PeFile.read(LAUNCHER.with_name(name))


def test_every_library_of_a_zip_is_inside_or_of_windows(tmp_path):
    zips = script_module("zips")
    shutil.copy(LAUNCHER, tmp_path / "torsionbook.exe")
    assert zips.strange_libraries(tmp_path) == []
    data = LAUNCHER.read_bytes()
    own = re.sub(rb"kernel32\.dll", b"xernel32.dll", data, flags=re.IGNORECASE)
    (tmp_path / "other.exe").write_bytes(own)
    (tmp_path / "bcryptprimitives.dll").write_bytes(data)
    assert zips.strange_libraries(tmp_path) == [
        "bcryptprimitives.dll is for Wine", "other.exe asks for xernel32.dll",
    ]  # fmt: skip
    (tmp_path / "xernel32.dll").write_bytes(data)  # which gives no function
    assert "other.exe asks xernel32.dll for AssignProcessToJobObject" in zips.strange_libraries(
        tmp_path
    )


def test_functions_that_answer_otherwise_under_wine_than_recorded_are_named():
    check_windows({"TV_CALIBRATE": 1e-14})
    with pytest.raises(
        SystemExit, match=r": TV_PEAKS by 1e-16, TV_CALIBRATE by 2e-12 \(relative\)"
    ):
        check_windows({"TV_TOLERANCES": 1e-15, "TV_PEAKS": 1e-16, "TV_CALIBRATE": 2e-12})


@pytest.mark.parametrize("lock", ["run", "server", "report"])
def test_locked_packages_of_another_system(lock):
    locked = script_module("locked")
    text = (ROOT / "requirements" / f"{lock}.txt").read_text(encoding="utf-8")
    names = {
        system: {e.split("==")[0] for e in locked.entries(locked.wanted(text, system))}
        for system in locked.SYSTEMS
    }
    windows, linux = names["win_amd64"], names["manylinux_2_28_x86_64"]
    assert windows - linux == ({"colorama"} if "colorama" in text else set())
    assert linux <= windows
    assert ";" not in locked.wanted(text, "win_amd64")
    assert locked.wanted(text, "win_amd64").count("--hash") == text.count("--hash")
