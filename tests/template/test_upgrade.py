"""`torsionbook upgrade`: the inputs of a workbook of 0.1.0 and the sheets of its owner, in a workbook of this version."""

from __future__ import annotations

import json
import shutil
import subprocess
from pathlib import Path
from typing import Any

import openpyxl
import pytest
from openpyxl.chart import BarChart, Reference
from typer.testing import CliRunner

from addin.cli.app import app
from addin.contract.sheets import SHEETS
from addin.reading.one_file import Unreadable, read_checked
from engine.case.data import case_digest

OLD = Path(__file__).parents[1] / "verify" / "release_0_1_0" / "train.xlsx"


def said(*words: object, code: int = 0) -> str:
    done = CliRunner().invoke(app, [str(word) for word in words])
    assert done.exit_code == code, done.output
    return done.output


def digest(path: Path) -> str:
    read = read_checked(path)
    assert not isinstance(read, Unreadable)
    return case_digest(read.data)


def results(book: Path, to: Path) -> dict[str, Any]:
    said("recalc", book, "--json", to)
    content = dict(json.loads(to.read_text(encoding="utf-8")))
    # times of this machine, and the file's own audit trail
    return {key: rows for key, rows in content.items() if key not in ("accuracy_cost", "audit")}


@pytest.fixture
def train(tmp_path: Path) -> Path:
    return Path(shutil.copyfile(OLD, tmp_path / "train.xlsx"))


def test_numbers_before_and_after_are_the_same(train: Path, tmp_path: Path) -> None:
    before, original = results(train, tmp_path / "before.json"), train.read_bytes()
    told = said("upgrade", train)
    assert (
        "note:" not in told
    )  # nothing was left behind, and nothing of the old template is taken for the owner's
    assert train.with_name("train.xlsx.bak").read_bytes() == original
    assert results(train, tmp_path / "after.json") == before
    names = openpyxl.load_workbook(train).sheetnames
    assert {part.worksheet for part in SHEETS} <= set(names)
    assert not {"Trace", "Histories", "Steady state"} & set(names)


def test_own_sheets_come_along_and_their_formulas_follow_the_inputs(train: Path) -> None:
    read = read_checked(train)
    assert not isinstance(read, Unreadable)
    book = openpyxl.load_workbook(train)
    sheet, cell = book.defined_names["LineFrequency"].attr_text.split("!")
    old = book.create_sheet("Our notes")
    old["A1"] = "Checked by hand"
    old["A2"] = f"={sheet}!{cell}*2"
    old["A3"] = "=Frequencies!D9"
    old["A4"] = "=SUM(Stations[Inertia])"
    chart = BarChart()
    chart.add_data(Reference(old, min_col=1, min_row=2, max_row=4))
    old.add_chart(chart, "D2")
    book["Train"]["Z3"] = 4711  # beside the inputs
    book.save(train)
    told = said("upgrade", train)
    new = openpyxl.load_workbook(train)
    notes = new["Our notes"]
    assert notes["A1"].value == "Checked by hand"
    there, at = new.defined_names["LineFrequency"].attr_text.split("!")
    assert notes["A2"].value == f"={there}!{at}*2".replace("'", "")
    assert notes["A3"].value != "=Frequencies!D9"
    assert "keep their value only: Our notes!A3" in told
    assert notes["A4"].value == "=SUM(Stations[Inertia])"
    assert len(notes._charts) == 1
    assert digest(train) == digest(OLD)


def test_what_stood_beside_the_inputs_is_listed(train: Path) -> None:
    book = openpyxl.load_workbook(train)
    book["Train"]["Z40"] = 4711
    book["Case"]["B70"] = "our remark"
    book.save(train)
    told = said("upgrade", train)
    assert "Train!Z40" in told
    assert "Case!B70" in told


def test_a_second_upgrade_keeps_the_first_copy(train: Path) -> None:
    said("upgrade", train)
    first = train.with_name("train.xlsx.bak").read_bytes()
    said("upgrade", train)
    assert train.with_name("train.xlsx.bak").read_bytes() == first
    assert train.with_name("train.xlsx.bak2").exists()
    assert digest(train) == digest(OLD)


def test_a_workbook_open_elsewhere_is_left_alone(train: Path) -> None:
    train.with_name(".~lock.train.xlsx#").write_text(",somebody,host,26.11.2026 10:00,;")
    original = train.read_bytes()
    assert "somebody" in said("upgrade", train, code=1)
    assert train.read_bytes() == original
    assert not train.with_name("train.xlsx.bak").exists()


def test_another_kind_of_file_is_refused(tmp_path: Path) -> None:
    case = shutil.copyfile(OLD.with_name("case.json"), tmp_path / "case.json")
    assert "torsionbook new NEW --from" in said("upgrade", case, code=1)


@pytest.mark.slow
def test_libreoffice_shows_no_broken_formula(train: Path, tmp_path: Path) -> None:
    if shutil.which("soffice") is None:
        pytest.skip("LibreOffice is not installed")
    said("upgrade", train)
    said("recalc", train, "--in-place")
    home = f"-env:UserInstallation=file://{tmp_path}/profile"
    subprocess.run(
        ["soffice", home, "--headless", "--convert-to", "ods", "--outdir", tmp_path, train],
        check=True, capture_output=True, timeout=180,
    )  # fmt: skip
    subprocess.run(
        ["soffice", home, "--headless", "--convert-to", "xlsx:Calc MS Excel 2007 XML", "--outdir",
         tmp_path / "again", tmp_path / "train.ods"],
        check=True, capture_output=True, timeout=180,
    )  # fmt: skip
    shown = openpyxl.load_workbook(tmp_path / "again" / "train.xlsx", data_only=True)
    broken = [
        f"{sheet.title}!{cell.coordinate}"
        for sheet in shown
        for row in sheet.iter_rows()
        for cell in row
        if isinstance(cell.value, str) and cell.value in ("#REF!", "#NAME?")
    ]
    assert broken == []
