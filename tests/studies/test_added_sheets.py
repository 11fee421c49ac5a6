"""Studies on an ordinary workbook: their sheets are added when asked for, and all results stand in one file."""

from __future__ import annotations

import re
import shutil
import subprocess
import zipfile
from pathlib import Path

import openpyxl
import pytest
from openpyxl.worksheet.table import Table
from typer.testing import CliRunner

from addin.cli.app import app
from addin.contract.shipped import template_path
from addin.xlsx import open_workbook
from addin.xlsx.formula_text import pieces

RUN = CliRunner()
#: Parts that list sheets, parts, names and styles: these change when sheets are added.
LISTS = {"[Content_Types].xml", "xl/workbook.xml", "xl/_rels/workbook.xml.rels", "xl/styles.xml"}


def said(*words: object, code: int = 0) -> str:
    done = RUN.invoke(app, [str(word) for word in words])
    assert done.exit_code == code, done.output
    return done.output


@pytest.fixture
def train(tmp_path: Path) -> Path:
    return Path(shutil.copyfile(template_path("example_proposed.xlsx"), tmp_path / "train.xlsx"))


@pytest.fixture
def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    """Studies that calculate little."""
    monkeypatch.setattr("addin.template.study_sheets._STIFFNESSES", "100; 120")
    monkeypatch.setattr("addin.template.study_sheets._COUPLINGS", 1)


def sheets(path: Path) -> list[str]:
    return list(openpyxl.load_workbook(path, read_only=True).sheetnames)


def parts(path: Path) -> dict[str, bytes]:
    with zipfile.ZipFile(path) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


def test_without_being_asked_no_sheet_of_inputs_is_added(train: Path) -> None:
    told = said("tune", train, code=1)
    assert "train.xlsx has no sheet Tuning" in told
    assert "--add" in told
    assert [path.name for path in train.parent.iterdir()] == ["train.xlsx"]


def test_at_a_terminal_the_command_asks(train: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    asked = []
    monkeypatch.setattr("addin.cli.study._wants", lambda names, file: asked.append(names))
    said("tune", train, code=1)
    assert asked == [("Tuning",)]


def test_all_results_stand_in_one_file_whichever_order(train: Path, quick: None) -> None:
    out, original = train.with_name("train.out.xlsx"), train.read_bytes()
    said("tune", train, "--add", "--jobs", 1)
    said("recalc", train)
    said("starts", train, "--jobs", 1)
    assert train.read_bytes() == original
    assert {"Tuning", "Tuning results", "Start matrix"} <= set(sheets(out))
    book = openpyxl.load_workbook(out, data_only=True)
    assert book["Tuning results"]["B10"].value == 1
    assert any(str(cell.value).startswith("Fewest starts") for cell in book["Start matrix"][4])
    assert book["Summary"]["B9"].value != "NOT CALCULATED"
    told = said("verify", out)
    assert "belongs to the inputs and rows in the file" in told


def test_what_was_typed_in_the_result_file_stays_and_counts(train: Path, quick: None) -> None:
    out = train.with_name("train.out.xlsx")
    said("tune", train, "--add", "--jobs", 1)
    book = open_workbook(out)
    book.set_cell("Tuning", "E7", "90; 100; 110")
    book.set_cell("Summary", "P40", "our remark")
    book.save(in_place=True)
    told = said("tune", train, "--jobs", 1)
    assert "3 combinations were tried" in told
    assert open_workbook(out).shown_value("Summary", "P40") == "our remark"
    assert out.with_name("train.out.xlsx.bak").exists()


def test_a_changed_workbook_begins_anew_and_the_results_are_kept(train: Path, quick: None) -> None:
    out = train.with_name("train.out.xlsx")
    said("tune", train, "--add", "--jobs", 1)
    before = out.read_bytes()
    book = open_workbook(train)
    book.set_name("Title", "another one")
    book.save(in_place=True)
    told = said("recalc", train)
    assert "was made anew" in told
    assert out.with_name("train.out.xlsx.bak").read_bytes() == before
    assert "Tuning" not in sheets(out)


def test_all_other_parts_stay_byte_for_byte(train: Path, tmp_path: Path) -> None:
    """A workbook that was saved by another program, with parts that this one never makes."""
    content = parts(train)
    content["xl/customXml/item1.xml"] = b"<ours>1</ours>"
    with zipfile.ZipFile(train, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in content.items():
            archive.writestr(name, data)
    said(
        "calibrate", train, "--add", code=1
    )  # its sheets are to be filled in: no number is written
    added = parts(train.with_name("train.out.xlsx"))
    assert {name for name in content if added[name] != content[name]} == LISTS
    assert {"Measured", "Tolerances", "Calibration"} <= set(
        sheets(train.with_name("train.out.xlsx"))
    )


def test_every_reference_of_the_new_sheets_leads_somewhere(train: Path) -> None:
    said("calibrate", train, "--add", code=1)
    book = open_workbook(train.with_name("train.out.xlsx"), read_only=True)
    names = {name.casefold() for name in (*book.defined_names, *book.tables)}
    for sheet in book.sheet_names:
        part = book.sheet_part(sheet)
        for row, column in part.formulas:
            for _, match, _ in pieces(part.value(row, column).text):  # type: ignore[union-attr]
                if match is None:
                    continue
                if match.lastgroup == "ref" and match["sheet"]:
                    assert match["sheet"].strip("!'") in book.sheet_names
                if match.lastgroup == "name" and match["name"].upper() not in ("TRUE", "FALSE"):
                    assert match["name"].casefold() in names


def test_summary_may_have_another_name(train: Path) -> None:
    book = openpyxl.load_workbook(train)
    book["Summary"].title = "Our summary"
    text = {"Summary!": "'Our summary'!"}
    for sheet in book:
        for row in sheet.iter_rows():
            for cell in row:
                if isinstance(cell.value, str) and cell.value.startswith("="):
                    for old, new in text.items():
                        cell.value = cell.value.replace(old, new)
    for name in book.defined_names.values():
        name.attr_text = name.attr_text.replace("Summary!", "'Our summary'!")
    book.save(train)
    said("calibrate", train, "--add", code=1)
    out = openpyxl.load_workbook(train.with_name("train.out.xlsx"))
    assert out["Measured"]["B2"].value == "='Our summary'!$B$9"


# --- hostile --------------------------------------------------------------------------------------


def _refused(train: Path, *words: object) -> str:
    original = train.read_bytes()
    told = said("tune", train, "--add", *words, code=1)
    assert train.read_bytes() == original
    assert [path.name for path in train.parent.iterdir() if path.suffix == ".xlsx"] == [
        "train.xlsx"
    ]
    return told


def _own_table(train: Path, name: str) -> None:
    book = openpyxl.load_workbook(train)
    sheet = book.create_sheet("Ours")
    for k, word in enumerate(("Colour", "Number"), 1):
        sheet.cell(1, k, word)
        sheet.cell(2, k, "x")
    sheet.add_table(Table(displayName=name, ref="A1:B2"))
    book.save(train)


@pytest.mark.parametrize("name", ["TuningResults", "TuningCrossings"])
def test_a_table_of_the_owner_keeps_its_name(train: Path, name: str) -> None:
    _own_table(train, name)
    assert f"table {name} of sheet Ours has no column" in _refused(train)


def test_a_table_of_the_owner_with_the_name_of_an_input(train: Path) -> None:
    _own_table(train, "Tuning")
    assert "table Tuning of sheet Ours has no column Element" in _refused(train)


def test_a_sheet_of_the_owner_keeps_its_name(train: Path) -> None:
    book = openpyxl.load_workbook(train)
    book.create_sheet("tuning MAP")
    book.save(train)
    assert "there is a sheet Tuning map of your own" in _refused(train)


def test_a_name_of_the_owner_keeps_its_cells(train: Path) -> None:
    book = openpyxl.load_workbook(train)
    book.defined_names["Catalogue"] = openpyxl.workbook.defined_name.DefinedName(
        "Catalogue", attr_text="Case!$Z$1"
    )
    book.save(train)
    assert "there is a defined name Catalogue of your own" in _refused(train)


def test_a_protected_workbook_says_so(train: Path) -> None:
    content = parts(train)
    content["xl/workbook.xml"] = re.sub(
        rb"<bookViews", b'<workbookProtection lockStructure="1"/><bookViews',
        content["xl/workbook.xml"],
    )  # fmt: skip
    with zipfile.ZipFile(train, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in content.items():
            archive.writestr(name, data)
    assert "the structure of train.xlsx is protected" in _refused(train)


def test_a_workbook_open_elsewhere_is_left_alone(train: Path, quick: None) -> None:
    train.with_name(".~lock.train.xlsx#").write_text(",somebody,host,26.11.2026 10:00,;")
    assert "somebody" in _refused(train, "--jobs", 1, "--in-place")


def test_a_read_only_folder_is_a_sentence(train: Path, quick: None) -> None:
    said("tune", train, "--add", "--jobs", 1)
    out = train.with_name("train.out.xlsx")
    before = out.read_bytes()
    out.chmod(0o444)
    done = RUN.invoke(app, ["tune", str(train), "--jobs", "1"])
    if done.exit_code == 0:  # an administrator may write everything
        assert out.with_name("train.out.xlsx.bak").read_bytes() == before
        return
    assert "write-protected" in done.output
    assert out.read_bytes() == before


@pytest.mark.slow
def test_openpyxl_and_libreoffice_take_the_file(train: Path, tmp_path: Path, quick: None) -> None:
    if shutil.which("soffice") is None:
        pytest.skip("LibreOffice is not installed")
    said("tune", train, "--add", "--jobs", 1)
    out = train.with_name("train.out.xlsx")
    subprocess.run(
        ["soffice", f"-env:UserInstallation=file://{tmp_path}/profile", "--headless", "--convert-to",
         "xlsx:Calc MS Excel 2007 XML", "--outdir", tmp_path / "again", out],
        check=True, capture_output=True, timeout=180,
    )  # fmt: skip
    first = openpyxl.load_workbook(out, data_only=True)
    again = openpyxl.load_workbook(tmp_path / "again" / out.name, data_only=True)
    for sheet in ("Tuning", "Tuning results", "Tuning map"):
        for row in first[sheet].iter_rows(max_row=40):
            for cell in row:
                other = again[sheet][cell.coordinate].value
                if isinstance(cell.value, float):
                    assert other == pytest.approx(cell.value, rel=1e-12)
                elif isinstance(cell.value, str):
                    assert str(other).replace("\r", "") == cell.value
