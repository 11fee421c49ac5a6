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
from openpyxl.comments import Comment
from openpyxl.packaging.custom import StringProperty
from openpyxl.utils import range_boundaries
from openpyxl.workbook.defined_name import DefinedName
from openpyxl.worksheet.table import Table, TableColumn
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


def test_all_that_is_left_behind_is_listed(train: Path) -> None:
    """A column in the table of stations, a table, a chart and comments beside it were lost without a word."""
    book = openpyxl.load_workbook(train)
    sheet = book["Train"]
    table = sheet.tables["Stations"]
    left, top, right, bottom = range_boundaries(table.ref)
    for row in range(top, bottom + 1):
        sheet.cell(row, right + 1).value = "Vendor" if row == top else f"V {row}"
    table.tableColumns.append(TableColumn(id=99, name="Vendor"))
    table.ref = f"{sheet.cell(top, left).coordinate}:{sheet.cell(bottom, right + 1).coordinate}"
    if table.autoFilter:
        table.autoFilter.ref = table.ref
    sheet.cell(top + 1, left).comment = Comment("as drawn", "us")
    sheet["AF31"] = "k"
    sheet.add_table(Table(displayName="Own", ref="AF31:AF33"))
    chart = BarChart()
    chart.add_data(Reference(sheet, min_col=4, min_row=top, max_row=bottom))
    sheet.add_chart(chart, "AH3")
    book["Excitation"]["Z4"] = "=1+1"
    book.custom_doc_props.append(StringProperty(name="Drawing", value="4711"))
    book.save(train)
    told = said("upgrade", train)
    beside = next(line for line in told.splitlines() if "Cells beside the inputs" in line)
    assert f"Train!{sheet.cell(top, right + 1).coordinate}" in beside
    count = beside.count("!") + int(beside.split(" and ")[1].split()[0])
    assert count == (bottom - top + 1) + 1 + 1
    assert (
        "Charts and pictures that were added to sheets of the product were not taken over: Train."
        in told
    )
    assert (
        f"Comments on sheets of the product were not taken over: Train!{sheet.cell(top + 1, left).coordinate}."
        in told
    )
    assert "Document properties of your own" in told


def test_names_of_the_owner_come_along_or_are_listed(train: Path) -> None:
    """A formula with a name that is gone showed #NAME?, and nothing was said."""
    book = openpyxl.load_workbook(train)
    sheet = book.create_sheet("Our notes")
    for name, text in {
        "Constant": "3.25",
        "Ours": "SUM('Our notes'!$A$1:$A$2)",
        "Theirs": "SUM(Train!$D$8:$D$12)",
    }.items():
        book.defined_names[name] = DefinedName(name, attr_text=text)
    formulas = (
        "=Constant*2", "=Ours", "=Theirs", "=SUM(Stations[Gone])", "=SUM(Stations[[#Data],[Inertia]:[Speed ratio]])",
        "=COUNTA(Stations[#All])",
    )  # fmt: skip
    for row, formula in enumerate(formulas, start=5):
        sheet.cell(row, 1).value = formula
    book.save(train)
    told = said("upgrade", train)
    assert "torsionbook were not taken along: Theirs." in told
    assert "keep their value only: Our notes!A7, Our notes!A8." in told
    new = openpyxl.load_workbook(train)
    kept = [new["Our notes"].cell(row, 1).value for row in range(5, 11)]
    assert kept == [one if at not in (2, 3) else None for at, one in enumerate(formulas)]
    assert new.defined_names["Constant"].attr_text == "3.25"
    assert new.defined_names["Ours"].attr_text == "SUM('Our notes'!$A$1:$A$2)"
    assert "Theirs" not in new.defined_names


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
