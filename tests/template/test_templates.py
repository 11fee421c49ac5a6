"""The shipped workbooks: complete, readable, reproducible, and the examples are the paper's case."""

from __future__ import annotations

import re
import zipfile
from pathlib import Path

import numpy as np
import openpyxl
import pytest
from openpyxl.utils import range_boundaries

from addin.contract import tables as fields
from addin.contract.run_facts import RUN_FACTS
from addin.contract.sheets import SHEETS
from addin.contract.shipped import template_path
from addin.reading.workbook import read_workbook
from addin.template.build import TEMPLATES, build_all
from addin.template.examples import EXAMPLES
from engine.case.data import CaseData
from engine.case.effects import EFFECTS
from engine.model.subdivision import natural_modes

#: Functions that recalculate on every change, and those Excel 2016 or LibreOffice 7.4 lack.
UNWANTED = re.compile(
    r"\b(OFFSET|INDIRECT|NOW|TODAY|RAND|RANDBETWEEN|CELL|INFO|XLOOKUP|FILTER|SORT|UNIQUE|LET|"
    r"LAMBDA|SEQUENCE|TEXTJOIN|IFS|MAXIFS|MINIFS|SWITCH|CONCAT)\("
)
#: The case of ../cases/SAMPLE_szenasi_von_nimitz.json in SI: a few numbers of each kind.
SI = {
    "inertia": {"Motor": 460.76, "Bull gear": 167.83, "Pinion": 0.6835, "HP comp": 8.3399},
    "proposed": {"LS coupling": 28946010.0, "HS coupling": 906463.4, "HP compressor shaft": 7e6},
    "modified": {"LS coupling": 24762330.0, "HS coupling": 299360.4, "HP compressor shaft": 7e6},
}
FREQUENCIES = {
    "proposed": (30.0, 53.0, 86.0, 1067.38681, 1212.89755, 1264.60205, 1279.68229, 1452.8642,
                 1465.88467, 2919.90488),
    "modified": (21.0, 39.0, 69.0, 1064.79798, 1200.76212, 1248.59362, 1255.69018, 1413.63839,
                 1417.39947, 2919.55326),
}  # fmt: skip
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


@pytest.mark.parametrize("design", sorted(FREQUENCIES))
def test_examples_are_the_sample_case(design: str) -> None:
    case = example_case(design)
    inertia = {row.station: row.inertia for row in case.stations}
    stiffness = {row.element: row.stiffness for row in case.elements}
    for name, value in SI["inertia"].items():
        assert inertia[name] == pytest.approx(value, rel=1e-9)
    for name, value in SI[design].items():
        assert stiffness[name] == pytest.approx(value, rel=1e-9)
    assert stiffness["Mesh"] == pytest.approx(6e9, rel=1e-9)
    assert case.rated_torque == pytest.approx(58400.0, rel=1e-9)
    assert case.damping_ratio == pytest.approx(0.015)
    motor = [(r.speed, r.average, r.pulsating) for r in case.motor_torque]
    assert motor[1] == pytest.approx((0.1, 0.56 * 58400.0, 0.16 * 58400.0))
    load = [r for r in case.load_torque if r.station == "HP comp"]
    assert load[-1].torque == pytest.approx(0.25 * 0.4 * 58400.0 / 5.6, rel=1e-9)
    assert case.elements[-1].stress_diameter == pytest.approx(0.07, rel=1e-9)


@pytest.mark.parametrize("design", sorted(FREQUENCIES))
def test_examples_reproduce_table_1_to_six_digits(design: str) -> None:
    modes = natural_modes(example_case(design)).modes
    elastic = np.asarray(modes.frequency)[modes.n_rigid :]
    assert elastic == pytest.approx(FREQUENCIES[design], rel=1e-6)


def test_the_example_with_backlash_is_the_proposed_design_with_additions() -> None:
    plain, more = example_case("proposed"), example_case("backlash")
    assert (more.stations, more.elements, more.motor_torque) == (
        plain.stations, plain.elements, plain.motor_torque,
    )  # fmt: skip
    (gear,) = more.meshes
    assert gear.backlash == pytest.approx(4e-4)
    assert (gear.mass_drive, gear.mass_driven) == pytest.approx((1600.0, 150.0))
    stiffness = (gear.bearing_stiffness_drive, gear.bearing_stiffness_driven)
    assert stiffness == pytest.approx((4e8, 3e8))
    assert (more.field_slip, more.pull_out_torque) == pytest.approx((0.03, 2.0 * 58400.0))
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
@pytest.mark.parametrize("design", sorted(FREQUENCIES))
def test_examples_say_where_their_numbers_come_from(design: str) -> None:
    book = openpyxl.load_workbook(template_path(f"example_{design}.xlsx"))
    text = " ".join(str(c.value) for row in book["Notes"].iter_rows() for c in row if c.value)
    for words in ("Published", "Constructed", "Reference", "not modelled", "prediction"):
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
