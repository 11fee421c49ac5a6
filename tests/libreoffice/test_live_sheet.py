"""Sheet `Live` of the variant for Calc, recalculated by LibreOffice with the extension added.

What it shows must be what the registry says of the same inputs, to the last bit, and it must follow
what is typed: a changed inertia, a unit, a row added to a table, an input that is wrong.
"""

import struct

import openpyxl
import pytest
from openpyxl.utils import get_column_letter, range_boundaries
from xls_cells import read_cells

from addin.reading.workbook import read_workbook
from addin.template.build import build_template
from addin.template.live_sheet import MARGIN_ROWS, MODE_ROWS, MODEL_CELLS, SHAFTS
from addin.template.variants import VARIANTS
from addin.worksheet.models import MODELS
from addin.worksheet.registry import call

pytestmark = pytest.mark.needs_libreoffice

MODEL, MODES, MARGINS, SHAFT = (5, 2), (11, 1), (11 + MODE_ROWS + 3, 1), (11 + MODE_ROWS + 3, 10)

#: Column of the least margin of each mode, right of its frequencies.
LEAST = 9


def bits(value):
    if value is None or value == "":
        return None
    return struct.pack("<d", value) if isinstance(value, (bool, float, int)) else value


def shown(cells, at, rows, columns):
    top, left = at
    return [[bits(cells.get((top + i, left + j))) for j in range(columns)] for i in range(rows)]


def header_cell(book, table, column):
    """The cell of a header."""
    for sheet in book:
        if table in sheet.tables:
            left, top, right, _ = range_boundaries(sheet.tables[table].ref)
            for at in range(left, right + 1):
                if sheet.cell(top, at).value == column:
                    return sheet, sheet.cell(top, at)
    raise KeyError((table, column))


def below(book, table, column, row):
    sheet, header = header_cell(book, table, column)
    return sheet.cell(header.row + row, header.column)


@pytest.fixture(scope="module")
def shipped(tmp_path_factory):
    """The variant for Calc as `torsionbook new` makes it."""
    path = tmp_path_factory.mktemp("live") / "proposed.xlsx"
    return build_template(path, "us", "proposed", VARIANTS["calc"])


def live(calc, path):
    """All cells, with all bits."""
    return read_cells(calc.convert(path, "xls"), calc.convert(path, "xlsx"))["Live"]


def words(calc, path):
    """All cells; numbers with 15 digits."""
    sheet = openpyxl.load_workbook(calc.convert(path, "xlsx"), data_only=True)["Live"]
    return {
        (cell.row - 1, cell.column - 1): cell.value or None
        for row in sheet.iter_rows()
        for cell in row
    }


def edited(shipped, folder, change):
    """A copy with something typed; openpyxl leaves out what formulas had shown."""
    book = openpyxl.load_workbook(shipped)
    change(book)
    path = folder / "typed.xlsx"
    book.save(path)
    return path


def agrees_with_the_registry(cells, path):
    """Every number of the sheet against the inputs of the file as the reader has them."""
    found = read_workbook(path)
    assert not found.problems
    handle = MODELS.add(found).handle
    assert cells[MODEL] == handle
    for at, name, rows in (
        (MODES, "TV_FREQUENCIES", MODE_ROWS),
        (MARGINS, "TV_MARGINS", MARGIN_ROWS),
    ):
        expected = call(name, [handle, None, True, rows])
        assert shown(cells, at, rows, len(expected[0])) == [[bits(v) for v in r] for r in expected]
    return handle


@pytest.fixture(scope="module")
def calculated(calc, shipped):
    return live(calc, shipped)


@pytest.mark.slow
def test_it_shows_what_the_registry_says_of_the_same_inputs(calculated, shipped):
    cells = calculated
    agrees_with_the_registry(cells, shipped)
    assert cells[5, 3] == "No errors."
    assert cells[8, 3] == "Not calculated yet."
    margins = call("TV_MARGINS", [cells[MODEL], None, False])
    for row in range(12, 11 + MODE_ROWS):
        of_mode = [r for r in margins if r[0] == cells.get((row, 1))]
        if not of_mode:
            assert cells.get((row, LEAST)) is None
            continue
        worst = min(of_mode, key=lambda r: r[4])
        assert (bits(cells[row, LEAST]), *(cells[row, LEAST + k] for k in (1, 2))) == (
            bits(worst[4]), worst[1], worst[6],
        )  # fmt: skip


@pytest.mark.slow
def test_the_values_it_is_shipped_with_are_those_a_program_calculates(calculated, shipped):
    """Cell by cell; XlsxWriter writes 16 digits of a number."""
    numbers = 0
    for row in openpyxl.load_workbook(shipped, data_only=True)["Live"].iter_rows(min_row=6):
        for cell in row:
            there = calculated.get((cell.row - 1, cell.column - 1))
            if (cell.row, cell.column) in MODEL_CELLS:
                assert cell.value is None, cell.coordinate  # Calc is to make the models
            elif isinstance(cell.value, (int, float)):
                numbers += 1
                assert there == pytest.approx(cell.value, rel=1e-15), cell.coordinate
            else:
                assert (cell.value or None) == there, cell.coordinate
    assert numbers > 300


@pytest.mark.slow
def test_it_opens_right_where_nobody_has_changed_the_settings(calc, shipped):
    """LibreOffice takes stored values then, and functions of a model that it has not made would all be errors."""
    settings = calc.profile / "user" / "registrymodifications.xcu"
    before = settings.read_text(encoding="utf-8")
    lines = [line for line in before.splitlines(keepends=True) if "RecalcMode" not in line]
    assert "".join(lines) != before
    settings.write_text("".join(lines), encoding="utf-8")
    try:
        opened = calc.convert(shipped, "xlsx")
    finally:
        settings.write_text(before, encoding="utf-8")
    shown, stored = (
        openpyxl.load_workbook(path, data_only=True)["Live"] for path in (opened, shipped)
    )
    handle = call_of(shipped)
    assert [shown.cell(row, 3).value for row in (6, 8)] == [handle] * 2
    assert shown.cell(6, 4).value == "No errors."
    numbers = 0
    for row in stored.iter_rows(min_row=9):
        for cell in row:
            there = shown[cell.coordinate].value
            if isinstance(cell.value, (int, float)):
                numbers += 1
                assert there == pytest.approx(cell.value, rel=1e-14), cell.coordinate
            elif cell.value:
                assert there == cell.value, cell.coordinate
    assert numbers > 300


def call_of(path):
    return MODELS.add(read_workbook(path)).handle


@pytest.mark.slow
def test_it_follows_a_unit_and_a_table_that_grows(calc, shipped, tmp_path):
    """A shaft of known geometry at the end of a longer train: k = G π (D⁴ − d⁴) / 32 L."""
    rows = {}

    def change(book):
        sheet, header = header_cell(book, "Stations", "Inertia")
        assert sheet.cell(header.row - 1, header.column).value == "lb*ft^2"
        sheet.cell(header.row - 1, header.column).value = "kg*m^2"
        for table, values in (
            ("Stations", {"Station": "Extra", "Inertia": 5.0, "Speed ratio": 1.0}),
            (
                "Elements",
                {"Element": "Extra shaft", "Kind": "shaft", "From": "Motor", "To": "Extra",
                 "OD": 8.0, "ID": 2.0, "Length": 20.0, "Shear modulus": 11.5e6},
            ),
        ):  # fmt: skip
            sheet, header = header_cell(book, table, list(values)[0])
            area = sheet.tables[table]
            left, top, right, bottom = range_boundaries(area.ref)
            area.ref = f"{get_column_letter(left)}{top}:{get_column_letter(right)}{bottom + 1}"
            area.autoFilter = None
            rows[table] = bottom + 1 - top
            for column, value in values.items():
                below(book, table, column, rows[table]).value = value

    path = edited(shipped, tmp_path, change)
    cells = live(calc, path)
    assert agrees_with_the_registry(cells, path) != call_of(shipped)
    assert "Extra shaft" in [e.element for e in read_workbook(path).case().elements]
    top, left = SHAFT
    assert rows["Elements"] < SHAFTS
    line = [cells.get((top + rows["Elements"], left + j)) for j in range(7)]
    assert line[:5] == ["Extra shaft", 8.0, 2.0, 20.0, 11.5e6]
    stiffness = 11.5e6 * 3.141592653589793 * (8.0**4 - 2.0**4) / (32.0 * 20.0)
    assert line[5] == pytest.approx(stiffness, rel=1e-12)
    assert line[6] is None


@pytest.mark.slow
def test_wrong_inputs_are_said_and_the_train_is_shown_without_them(calc, shipped, tmp_path):
    def change(book):
        below(book, "MotorTorque", "Average", 2).value = "high"

    cells = live(calc, edited(shipped, tmp_path, change))
    for word in ("MotorTorque", "row 2", "Average", "high"):
        assert word in cells[5, 3]
    assert cells[6, 3] == "No errors."
    whole = call("TV_FREQUENCIES", [call_of(shipped), None, True, MODE_ROWS])
    assert shown(cells, MODES, MODE_ROWS, len(whole[0])) == [
        [bits(v) for v in row] for row in whole
    ]


@pytest.mark.slow
def test_a_train_that_is_wrong_leaves_the_sheet_blank(calc, shipped, tmp_path):
    def change(book):
        below(book, "Stations", "Inertia", 1).value = -1.0

    cells = words(calc, edited(shipped, tmp_path, change))
    for row in (5, 6):
        assert "Inertia" in cells[row, 3]
        assert "-1" in cells[row, 3]
    assert cells[7, 3] == "No model yet."
    areas = (MODES, MODE_ROWS, 11), (MARGINS, MARGIN_ROWS, 8)
    for at, rows, columns in areas:
        seen = {value for row in shown(cells, at, rows, columns) for value in row}
        assert seen - {"Least margin [%]", "From", "Verdict"} == {None}


@pytest.mark.slow
def test_an_empty_template_asks_for_its_train(calc, tmp_path):
    path = build_template(tmp_path / "blank.xlsx", "si", None, VARIANTS["calc"])
    cells = words(calc, path)
    assert "Stations" in cells[5, 3]
    assert cells[7, 3] == "No model yet."


@pytest.mark.slow
def test_after_a_calculation_it_says_whose_the_results_are(calc, shipped, tmp_path):
    from addin.writing.recalculate import recalculate

    done = tmp_path / "done.xlsx"
    recalculate(shipped, destination=done)
    assert words(calc, done)[8, 3] == "Results belong to the present inputs."

    def change(book):
        below(book, "Stations", "Inertia", 1).value = 1234.0

    path = edited(done, tmp_path, change)
    assert words(calc, path)[8, 3] == "INPUTS CHANGED SINCE CALCULATION"
