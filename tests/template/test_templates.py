"""The shipped workbooks: complete, readable, reproducible, and the examples are the paper's case."""

from __future__ import annotations

import functools
import math
import re
import zipfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import openpyxl
import pytest
import xlsxwriter.xmlwriter
from openpyxl.utils import range_boundaries

from addin.batch.summary import write_summary
from addin.contract import tables as fields
from addin.contract.run_facts import RUN_FACTS
from addin.contract.sheets import SHEETS
from addin.contract.shipped import template_path
from addin.diff.compare import compare_files
from addin.diff.workbook import write_book
from addin.reading.workbook import read_workbook
from addin.template.build import TEMPLATES, build_all, build_template
from addin.template.examples import EXAMPLES
from addin.template.variants import VARIANTS
from addin.writing.recalculate import recalculate
from engine.case.data import CaseData
from engine.case.effects import EFFECTS
from engine.model.subdivision import natural_modes

#: Functions that recalculate on every change, and those Excel 2016 or LibreOffice 7.4 lack.
UNWANTED = re.compile(
    r"\b(OFFSET|INDIRECT|NOW|TODAY|RAND|RANDBETWEEN|CELL|INFO|XLOOKUP|FILTER|SORT|UNIQUE|LET|"
    r"LAMBDA|SEQUENCE|TEXTJOIN|IFS|MAXIFS|MINIFS|SWITCH|CONCAT)\("
)
#: Szenasi & von Nimitz (1978), Table 1: natural frequencies [Hz] and % speed where 2 × slip crosses them, as printed.
TABLE_1 = {
    "proposed": ((30, 75), (53, 56), (86, 28)),
    "modified": ((21, 83), (39, 68), (69, 43)),
}
#: Exact by definition of pound, inch and standard gravity.
POUND, LBF_IN, LBF_PER_INCH = 0.45359237, 4.4482216152605 * 0.0254, 4.4482216152605 / 0.0254
NAMES = sorted(TEMPLATES)
#: Sheets that hold results alone: nothing of them is printed until there are some.
NOT_YET = ("Results", "Start", "Effects and accuracy")


@pytest.fixture(scope="module")
def rebuilt(derived: Path) -> Path:
    return derived / "templates"


def parts(path: Path) -> dict[str, bytes]:
    with zipfile.ZipFile(path) as package:
        return {entry.filename: package.read(entry) for entry in package.infolist()}


@pytest.mark.parametrize("name", NAMES)
def test_rebuilding_gives_the_committed_workbook(rebuilt: Path, name: str) -> None:
    committed, made = parts(template_path(name)), parts(rebuilt / name)
    assert list(made) == list(committed)
    different = [part for part in made if made[part] != committed[part]]
    assert not different, f"{name} differs from `make templates` in {different}"


def test_parts_have_the_same_line_ends_on_every_system(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What XlsxWriter writes into files has those of the system; here they are Windows'."""
    open_as_on_windows = functools.partial(open, newline="\r\n")
    monkeypatch.setattr(xlsxwriter.xmlwriter, "open", open_as_on_windows, raising=False)
    build_template(tmp_path / "template.xlsx", "us", "proposed")
    write_summary(tmp_path / "summary.xlsx", [], "None.")
    example = template_path("example_proposed.xlsx")
    write_book(compare_files(example, example), tmp_path / "diff.xlsx")
    for path in tmp_path.glob("*.xlsx"):
        assert [name for name, part in parts(path).items() if b"\r\n" in part] == []


@pytest.mark.slow
def test_building_twice_gives_the_same_bytes(rebuilt: Path, tmp_path: Path) -> None:
    once = {path.name: path.read_bytes() for path in rebuilt.glob("*.xlsx")}
    again = {path.name: path.read_bytes() for path in build_all(tmp_path)}
    assert once.keys() == again.keys()
    assert [name for name in once if once[name] != again[name]] == []


@pytest.fixture(scope="module", params=NAMES)
def book(request: pytest.FixtureRequest) -> openpyxl.Workbook:
    loaded = openpyxl.load_workbook(template_path(request.param))
    loaded.shipped_as = request.param
    return loaded


def all_tables(book: openpyxl.Workbook) -> dict[str, tuple[str, str]]:
    return {
        name: (sheet.title, ref) for sheet in book.worksheets for name, ref in sheet.tables.items()
    }


@pytest.mark.first_ones(1)
def test_every_table_stands_on_its_sheet_with_its_columns_and_units(
    book: openpyxl.Workbook,
) -> None:
    tables = all_tables(book)
    system, example = TEMPLATES[book.shipped_as]
    changed = EXAMPLES[example].units if example else {}
    for spec in (*fields.INPUT_TABLES, *fields.RESULT_TABLES):
        sheet, ref = tables[spec.name]
        assert sheet == spec.sheet
        left, header, right, _ = range_boundaries(ref)
        cells = [book[sheet].cell(header, column) for column in range(left, right + 1)]
        columns = spec.workbook_columns
        assert [cell.value for cell in cells] == [field.name for field in columns]
        for cell, field in zip(cells, columns, strict=True):
            unit = changed.get((spec.name, field.name), getattr(field, f"unit_{system}"))
            above = book[sheet].cell(header - 1, cell.column).value
            if field.has_unit:
                assert above == unit, (spec.name, field.name)


def test_every_scalar_is_a_defined_name_with_its_unit_beside_it(book: openpyxl.Workbook) -> None:
    system, _ = TEMPLATES[book.shipped_as]
    for field in fields.SCALARS:
        ((sheet, cell),) = book.defined_names[field.name].destinations
        assert sheet == fields.SCALAR_SHEET
        at = book[sheet][cell.replace("$", "")]
        if field.has_unit:
            assert book[sheet].cell(at.row, at.column + 1).value == getattr(field, f"unit_{system}")
    for name, _ in RUN_FACTS:
        assert name in book.defined_names


@pytest.mark.first_ones(1)
def test_nothing_stands_below_a_result_table(book: openpyxl.Workbook) -> None:
    tables = all_tables(book)
    for spec in fields.RESULT_TABLES:
        sheet, ref = tables[spec.name]
        left, header, right, bottom = range_boundaries(ref)
        last = header + (spec.room or 2000)
        below = book[sheet].iter_rows(bottom + 1, min(last, book[sheet].max_row), left, right)
        filled = [cell.coordinate for row in below for cell in row if cell.value is not None]
        assert not filled, f"{spec.name}: {filled}"


def test_sheets_are_in_order_and_helpers_hidden(book: openpyxl.Workbook) -> None:
    shown = [sheet.title for sheet in book.worksheets if sheet.sheet_state == "visible"]
    assert shown == list(dict.fromkeys(sheet.worksheet for sheet in SHEETS))
    assert len(shown) <= 10
    assert [s.title for s in book.worksheets[-3:]] == ["Lists", "ChartData", "Inputs calculated"]


def test_pages_are_set_up_for_print(book: openpyxl.Workbook) -> None:
    for sheet in book.worksheets[:-3]:
        assert sheet.page_setup.orientation == "landscape"
        assert not sheet.sheet_properties.pageSetUpPr.fitToPage
        is_printed = sheet.print_area != f"'{sheet.title}'!$A$1"
        assert is_printed or sheet.title in NOT_YET or sheet.title in ("Audit", "Notes")
        assert not is_printed or 70 <= sheet.page_setup.scale <= 100
        assert "&P" in sheet.oddFooter.right.text
        assert "&N" in sheet.oddFooter.right.text
        assert sheet.print_title_rows


def test_inputs_have_prompts_and_drop_downs(book: openpyxl.Workbook) -> None:
    for spec in fields.INPUT_TABLES:
        sheet, ref = all_tables(book)[spec.name]
        left, header, _, _ = range_boundaries(ref)
        rules = book[sheet].data_validations.dataValidation
        for offset, field in enumerate(spec.columns):
            cell = book[sheet].cell(header + 1, left + offset).coordinate
            (rule,) = [r for r in rules if cell in r.cells]
            assert rule.prompt.startswith(field.help[:40])
            if field.kind in ("choice", "station", "element", "material"):
                assert rule.type == "list"


@pytest.mark.first_ones(1)
@pytest.mark.parametrize("name", NAMES)
def test_formulas_have_values_and_use_old_steady_functions(name: str) -> None:
    formulas = openpyxl.load_workbook(template_path(name))
    values = openpyxl.load_workbook(template_path(name), data_only=True)
    count = 0
    for sheet in formulas.worksheets:
        for row in sheet.iter_rows():
            for cell in row:
                if cell.data_type != "f":
                    continue
                count += 1
                assert not UNWANTED.search(str(cell.value)), (sheet.title, cell.coordinate)
                assert "[@" not in str(cell.value)
                value = values[sheet.title][cell.coordinate].value
                assert value is False or value != 0, cell.coordinate
    assert count > 100


@pytest.mark.parametrize("name", NAMES)
def test_every_formula_cell_carries_a_cached_value(name: str) -> None:
    for part, data in parts(template_path(name)).items():
        if part.startswith("xl/worksheets/sheet"):
            assert not re.search(rb"</f></c>", data), part


def example_case(design: str) -> CaseData:
    read = read_workbook(template_path(f"example_{design}.xlsx"))
    assert read.problems == ()
    return read.data


@pytest.mark.parametrize("design", sorted(TABLE_1))
def test_examples_give_table_1_as_printed(design: str) -> None:
    modes = natural_modes(example_case(design)).modes
    elastic = np.asarray(modes.frequency)[modes.n_rigid :][:3]
    for f, (printed, speed) in zip(elastic, TABLE_1[design], strict=True):
        assert f == pytest.approx(printed, abs=0.02)
        # halves are rounded up, as in the paper: 82.5 % is printed as 83
        assert math.floor(100.0 * (1.0 - f / 120.0) + 0.5) == speed


def test_only_the_couplings_differ_between_the_designs() -> None:
    """The paper: "only the couplings were modified"."""
    proposed, modified = (vars(example_case(design)) for design in ("proposed", "modified"))
    differ = {key for key in proposed if proposed[key] != modified[key]}
    assert differ == {"elements", "title", "document"}
    pairs = zip(proposed["elements"], modified["elements"], strict=True)
    changed = [(a, b) for a, b in pairs if a != b]
    assert {a.kind for a, _ in changed} == {"coupling"}
    for a, b in changed:
        assert replace(a, stiffness=b.stiffness) == b


@pytest.mark.parametrize("name", sorted(EXAMPLES))
def test_an_engineer_would_type_these_numbers(name: str) -> None:
    """At most four digits that count, as on a drawing or a data sheet."""
    numbers = [
        value
        for rows in ({"scalars": [EXAMPLES[name].scalars]} | EXAMPLES[name].tables).values()
        for row in rows
        for value in row.values()
        if isinstance(value, int | float)
    ]
    assert len(numbers) > 100
    assert [n for n in numbers if float(f"{n:.4g}") != n] == []


@pytest.mark.parametrize("name", sorted(EXAMPLES))
def test_every_element_of_an_example_can_be_judged(name: str) -> None:
    for row in EXAMPLES[name].tables["Elements"]:
        if row["Kind"] == "shaft":
            assert {"Stress diameter", "SCF", "Material"} <= row.keys()
        else:
            assert {"Rated torque", "Peak torque limit", "Vibratory limit"} <= row.keys()


def test_the_example_with_backlash_is_the_proposed_design_with_additions() -> None:
    plain, more = example_case("proposed"), example_case("backlash")
    assert (more.stations, more.elements, more.motor_torque) == (
        plain.stations, plain.elements, plain.motor_torque,
    )  # fmt: skip
    (gear,) = more.meshes
    assert gear.backlash == pytest.approx(0.016 * 0.0254)
    assert (gear.mass_drive, gear.mass_driven) == pytest.approx((3500 * POUND, 330 * POUND))
    stiffness = (gear.bearing_stiffness_drive, gear.bearing_stiffness_driven)
    assert stiffness == pytest.approx((2.3e6 * LBF_PER_INCH, 1.7e6 * LBF_PER_INCH))
    rated = 43770 * 12 * LBF_IN
    assert (more.field_slip, more.pull_out_torque) == pytest.approx((0.03, 2.0 * rated))
    book = openpyxl.load_workbook(template_path("example_backlash.xlsx"))
    notes = [c.value for c in book["Notes"]["B"]]
    assert "Added here" in notes


def test_effects_are_shipped_by_name_and_none_is_chosen(book: openpyxl.Workbook) -> None:
    sheet, ref = all_tables(book)["EffectChoices"]
    left, header, _, bottom = range_boundaries(ref)
    rows = [(book[sheet].cell(r, left).value, book[sheet].cell(r, left + 1).value)
            for r in range(header + 1, bottom + 1)]  # fmt: skip
    assert rows == [(name, None) for name in EFFECTS]
    assert read_workbook(template_path(book.shipped_as)).data.effect_choices == ()


@pytest.mark.slow
@pytest.mark.parametrize("design", sorted(TABLE_1))
def test_examples_say_where_their_numbers_come_from(design: str) -> None:
    book = openpyxl.load_workbook(template_path(f"example_{design}.xlsx"))
    text = " ".join(str(c.value) for row in book["Notes"].iter_rows() for c in row if c.value)
    for words in ("Published", "Assumed", "Reference", "not modelled", "prediction"):
        assert words in text
    assert "Provenance" not in str(
        [c.value for c in openpyxl.load_workbook(template_path("blank_us.xlsx"))["Notes"]["B"]]
    )


@pytest.mark.slow
@pytest.mark.parametrize("name", ["blank_si.xlsx", "example_proposed.xlsx"])
def test_a_spreadsheet_program_agrees_with_every_cached_value(soffice, name: str) -> None:
    from workbook_checks import assert_caches_agree

    assert_caches_agree(template_path(name), soffice)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["blank_us.xlsx", "blank_si.xlsx", "example_modified.xlsx"])
def test_every_page_has_ink(soffice, name: str) -> None:
    from workbook_checks import assert_pages_have_ink

    assert_pages_have_ink(template_path(name), soffice, at_least=5)


def test_no_table_has_a_name_that_is_defined(book: openpyxl.Workbook) -> None:
    """Excel knows both in one namespace, in which capitals do not count."""
    tables = [name.casefold() for name in all_tables(book)]
    assert len(set(tables)) == len(tables)
    assert not set(tables) & {name.casefold() for name in book.defined_names}


FORMULA = re.compile(rb"<c ([^>]*)><f[^>]*(?:/>|>[^<]*</f>)(<v/>|<v>[^<]*</v>)?</c>")


def formulas_without_value(path: Path) -> list[bytes]:
    """Attributes of cells whose formula has no stored value; an empty text is one, by its type."""
    return [
        found[1]
        for name, part in parts(path).items()
        if name.startswith("xl/worksheets/")
        for found in FORMULA.finditer(part)
        if found[2] in (None, b"<v/>", b"<v></v>") and b't="str"' not in found[1]
    ]


def test_excel_takes_the_values_of_a_workbook_as_they_are(tmp_path: Path) -> None:
    """Else it calculates all of it on opening and asks whether to save on closing; on sheet Live it has to."""
    example = tmp_path / "example.xlsx"
    build_template(example, "us", "proposed")
    recalculated = tmp_path / "recalculated.xlsx"
    recalculate(example, destination=recalculated)
    for path in (example, recalculated):
        assert formulas_without_value(path) == []
        assert re.findall(rb"<calcPr[^>]*>", parts(path)["xl/workbook.xml"]) == [
            b'<calcPr calcId="191029"/>'
        ]
    live = tmp_path / "live.xlsx"
    build_template(live, "us", "proposed", variant=VARIANTS["server"])
    assert b'fullCalcOnLoad="1"' in parts(live)["xl/workbook.xml"]
