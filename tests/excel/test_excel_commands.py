"""`torsionbook excel install | upgrade | doctor`, as typed."""

import shutil

import pytest
from typer.testing import CliRunner

from addin.cli import excel as commands
from addin.cli.app import app
from addin.contract.shipped import template_path


@pytest.fixture
def run():
    return lambda *words: CliRunner().invoke(app, ["excel", *map(str, words)])


@pytest.fixture
def book(tmp_path):
    return shutil.copyfile(template_path("blank_us.xlsx"), tmp_path / "train.xlsx")


def test_install_doctor_upgrade(run, book):
    done = run("install", book)
    made = book.with_suffix(".xlsm")
    assert done.exit_code == 0
    assert f"written: {made}" in done.output
    looked = run("doctor", made)
    assert looked.exit_code == 0
    assert "[ok] Functions in the workbook" in looked.output
    again = run("upgrade", made, "--interpreter", r"D:\py\pythonw.exe")
    assert again.exit_code == 0
    assert f"backup: {made}.bak" in again.output
    assert r"D:\py\pythonw.exe" in run("doctor", made).output


def test_the_workbook_as_it_was_outlives_a_second_upgrade(run, book):
    run("install", book)
    made = book.with_suffix(".xlsm")
    first = made.read_bytes()
    for name in ("bak", "bak2", "bak3"):
        done = run("upgrade", made, "--interpreter", rf"D:\{name}\pythonw.exe")
        assert f"backup: {made}.{name}" in done.output
    assert made.with_name(f"{made.name}.bak").read_bytes() == first
    assert made.with_name(f"{made.name}.bak2").read_bytes() not in (first, made.read_bytes())


def test_a_file_that_is_there_is_not_replaced_unasked(run, book):
    book.with_suffix(".xlsm").write_bytes(b"mine")
    done = run("install", book)
    assert done.exit_code == 1
    assert "exists. Name another" in done.output
    assert book.with_suffix(".xlsm").read_bytes() == b"mine"
    assert run("install", book, "--force").exit_code == 0
    assert book.with_suffix(".xlsm").read_bytes() != b"mine"


def test_another_name(run, book, tmp_path):
    assert run("install", book, "--out", tmp_path / "new.xlsm").exit_code == 0
    assert (tmp_path / "new.xlsm").is_file()
    assert not book.with_suffix(".xlsm").exists()


@pytest.mark.parametrize("command", ["install", "upgrade"])
def test_wrong_usage_is_status_2(run, book, command):
    path = book
    if command == "install":
        assert run("install", book).exit_code == 0
        path = book.with_suffix(".xlsm")  # on top of itself
    assert run(command, path).exit_code == 2


@pytest.mark.parametrize("command", ["install", "doctor"])
def test_a_missing_file_is_a_sentence_and_status_1(run, tmp_path, command):
    done = run(command, tmp_path / "none.xlsx")
    assert done.exit_code == 1
    assert "none.xlsx does not exist" in done.output
    assert "Traceback" not in done.output


def test_the_doctor_ends_with_1_where_something_is_wrong(run, book):
    done = run("doctor", book)
    assert done.exit_code == 1
    assert "[wrong] Functions in the workbook" in done.output
    assert "torsionbook excel install train.xlsx" in done.output


def test_a_missing_xlwings_is_told(run, book, monkeypatch):
    from addin.excel import vba

    def missing(name):
        raise vba.metadata.PackageNotFoundError(name)

    vba._wheel_project.cache_clear()
    monkeypatch.setattr(vba.metadata, "version", missing)
    done = run("install", book)
    assert done.exit_code == 1
    assert "pip install xlwings==0.37.8" in done.output
    assert not book.with_suffix(".xlsm").exists()


def test_each_command_has_help_with_an_example():
    for name in ("install", "upgrade", "doctor"):
        assert f"torsionbook excel {name}" in (getattr(commands, name).__doc__ or "")
