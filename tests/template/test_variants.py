"""The variants of the workbooks: one sheet `Live`, spelled as each program wants it.

LibreOffice calculates the one for Calc (tests/libreoffice/test_live_sheet.py). Here: the others hold the
same formulas under the names their programs know, and a calculation leaves the sheet alone.
"""

from __future__ import annotations

import re
import zipfile
from pathlib import Path

import openpyxl
import pytest
from lxml import etree
from typer.testing import CliRunner

from addin.cli.app import app
from addin.contract.shipped import template_path
from addin.libreoffice.names import programmatic_name
from addin.reading.workbook import read_workbook
from addin.server.office import NAMESPACE, functions_json
from addin.template.build import TEMPLATES, build_template
from addin.template.variants import VARIANTS
from addin.worksheet.registry import FUNCTIONS
from addin.writing.recalculate import recalculate
from addin.xlsx import open_workbook
from engine.case.data import case_digest

MAIN = "{http://schemas.openxmlformats.org/spreadsheetml/2006/main}"
WITH_FUNCTIONS = [one for one in VARIANTS.values() if one.spelled is not None]
#: In any spelling: no program needs another name of a function than these three.
CALLED = re.compile(r"(?<![\w.])(?:ORG\.TORSIONBOOK\.CALC\.FUNCTIONS\.|_xldudf_)?(TV_\w+)\(")
UNWANTED = re.compile(
    r"\b(OFFSET|INDIRECT|NOW|TODAY|RAND|RANDBETWEEN|CELL|INFO|XLOOKUP|FILTER|SORT|UNIQUE|LET|"
    r"LAMBDA|SEQUENCE|TEXTJOIN|IFS|MAXIFS|MINIFS|SWITCH|CONCAT)\("
)


@pytest.fixture(scope="module")
def books(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    folder = tmp_path_factory.mktemp("variants")
    return {
        one.name: build_template(folder / f"{one.name}.xlsx", "us", "proposed", one)
        for one in VARIANTS.values()
    }


def formulas(path: Path) -> dict[str, tuple[str, dict[str, str], dict[str, str]]]:
    """Formulas of sheet `Live` as they stand in the file: text, attributes, those of the cell."""
    book = open_workbook(path)
    part = book.structure.worksheet_part("Live")
    with zipfile.ZipFile(path) as package:
        root = etree.fromstring(package.read(part))
    return {
        cell.get("r"): (cell.find(f"{MAIN}f").text, dict(cell.find(f"{MAIN}f").attrib), dict(cell.attrib))
        for cell in root.iter(f"{MAIN}c")
        if cell.find(f"{MAIN}f") is not None
    }  # fmt: skip


def in_the_contracts_names(text: str) -> str:
    return CALLED.sub(lambda found: f"{found[1]}(", text)


@pytest.mark.slow
@pytest.mark.parametrize("name", [one.name for one in WITH_FUNCTIONS])
def test_every_variant_holds_the_same_formulas(books: dict[str, Path], name: str) -> None:
    mine, others = formulas(books[name]), formulas(books["calc"])
    assert {at: in_the_contracts_names(text) for at, (text, _, _) in mine.items()} == {
        at: in_the_contracts_names(text) for at, (text, _, _) in others.items()
    }
    called = {n for text, _, _ in mine.values() for n in CALLED.findall(text)}
    assert called == {"TV_MODEL", "TV_FREQUENCIES", "TV_MARGINS", "TV_STIFFNESS", "TV_CONVERT"}
    assert called <= set(FUNCTIONS)
    assert not any(FUNCTIONS[one].long for one in called), "no start is calculated on this sheet"
    assert not [text for text, _, _ in mine.values() if UNWANTED.search(text)]


@pytest.mark.slow
def test_each_program_finds_its_own_names(books: dict[str, Path]) -> None:
    def spelled(name: str) -> set[str]:
        texts = " ".join(text for text, _, _ in formulas(books[name]).values())
        return set(re.findall(r"[\w.]*TV_\w+(?=\()", texts))

    assert spelled("excel") <= set(FUNCTIONS)
    # Office writes =TV.FREQUENCIES( of namespace and name into a file as _xldudf_TV_FREQUENCIES(
    office = {f"_xldudf_{NAMESPACE}_{one['name']}" for one in functions_json()["functions"]}
    assert spelled("server") <= office
    assert spelled("calc") <= {programmatic_name(one) for one in FUNCTIONS}


@pytest.mark.slow
def test_arrays_are_dynamic_where_the_program_has_them(books: dict[str, Path]) -> None:
    with zipfile.ZipFile(books["server"]) as package:
        assert b"XLDAPR" in package.read("xl/metadata.xml")
    for at, (text, formula, cell) in formulas(books["server"]).items():
        if CALLED.search(text):
            assert (cell.get("cm"), formula.get("t")) == ("1", "array"), at
    for name in ("excel", "calc"):
        with zipfile.ZipFile(books[name]) as package:
            assert "xl/metadata.xml" not in package.namelist()
        found = formulas(books[name]).values()
        assert not [cell for _, _, cell in found if "cm" in cell]
        assert len([1 for _, formula, _ in found if formula.get("t") == "array"]) > 10


def test_functions_stand_outside_merged_cells(books: dict[str, Path]) -> None:
    """Excel refuses arrays in merged cells."""
    merged = openpyxl.load_workbook(books["server"])["Live"].merged_cells
    for at, (text, _, _) in formulas(books["server"]).items():
        assert not CALLED.search(text) or at not in merged, at


@pytest.mark.parametrize("name", list(VARIANTS))
def test_the_inputs_are_those_of_the_shipped_workbook(books: dict[str, Path], name: str) -> None:
    mine = read_workbook(books[name])
    assert not mine.problems
    assert case_digest(mine.case()) == case_digest(
        read_workbook(template_path("example_proposed.xlsx")).case()
    )
    assert ("Live" in open_workbook(books[name]).sheet_names) == (name != "files")


@pytest.mark.slow
@pytest.mark.parametrize("name", ["excel", "server"])
def test_a_calculation_leaves_the_sheet_alone(
    books: dict[str, Path], name: str, tmp_path: Path
) -> None:
    """But for the cells that hang on the results; what only the functions know is left to them."""
    recalculate(books[name], destination=tmp_path / "done.xlsx")
    part = open_workbook(books[name]).structure.worksheet_part("Live")
    cells = []
    for path in (books[name], tmp_path / "done.xlsx"):
        with zipfile.ZipFile(path) as package:
            root = etree.fromstring(package.read(part))
        cells.append({c.get("r"): etree.tostring(c) for c in root.iter(f"{MAIN}c")})
    before, after = cells
    assert set(before) == set(after)
    assert {at for at in before if before[at] != after[at]} == {"D9", overall_verdict(after)}
    assert b"<v>Results belong to the present inputs." in after["D9"]


def overall_verdict(cells: dict[str, bytes]) -> str:
    """The cell of the strip that shows it."""
    (found,) = [at for at, cell in cells.items() if b"Summary!$B$9" in cell]
    return found


@pytest.mark.first_ones(1)
@pytest.mark.parametrize("system", ["us", "si"])
@pytest.mark.parametrize("one", WITH_FUNCTIONS, ids=lambda one: one.name)
def test_new_makes_every_variant(tmp_path: Path, one, system: str) -> None:
    path = tmp_path / f"train{one.suffix}"
    done = CliRunner().invoke(app, ["new", str(path), "--for", one.name, "--units", system])
    assert done.exit_code == 0, done.output
    assert "Live" in open_workbook(path).sheet_names
    assert [entry.name for entry in tmp_path.iterdir()] == [path.name], "nothing else is left"
    found = read_workbook(path)
    plain = read_workbook(template_path(f"blank_{system}.xlsx"))
    assert [p.message for p in found.problems] == [p.message for p in plain.problems]


@pytest.mark.slow
def test_an_xlsm_is_for_excel_and_has_the_functions(tmp_path: Path) -> None:
    from addin.excel.workbook import installed_in

    path = tmp_path / "train.xlsm"
    done = CliRunner().invoke(app, ["new", str(path), "--example", "proposed"])
    assert done.exit_code == 0, done.output
    book = open_workbook(path)
    assert "Live" in book.sheet_names
    assert installed_in(book).xlwings
    cached = openpyxl.load_workbook(path, data_only=True)["Live"]
    assert str(cached["C6"].value).startswith("tv:")


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["train.xlsx", "--for", "excel"], "must end in .xlsm"),
        (["train.xlsm", "--for", "calc"], "must end in .xlsx"),
        (["train.xlsx", "--for", "numbers"], "--for"),
        (["train.ods"], "must end in .xlsx"),
    ],
)
def test_wrong_variants_are_said(tmp_path: Path, words: list[str], said: str) -> None:
    done = CliRunner().invoke(app, ["new", str(tmp_path / words[0]), *words[1:]])
    assert done.exit_code == 2
    assert said in " ".join(done.output.replace("│", " ").split())
    assert not list(tmp_path.iterdir())


def test_a_file_that_is_there_stays(tmp_path: Path) -> None:
    path = tmp_path / "train.xlsm"
    path.write_text("mine")
    assert CliRunner().invoke(app, ["new", str(path)]).exit_code == 1
    assert path.read_text() == "mine"


def test_the_shipped_workbooks_are_plain() -> None:
    for name in TEMPLATES:
        assert "Live" not in open_workbook(template_path(name)).sheet_names
