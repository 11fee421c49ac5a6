"""A workbook with every function, recalculated by LibreOffice with the extension added.

The reference is the registry called in this process. Numbers are compared as doubles, read from a
file that LibreOffice writes with all their bits (tests/libreoffice/xls_cells.py).
"""

import struct

import pytest
from flat_sheets import Formula, write_sheets
from sheet_ranges import (
    CATALOGUE,
    MOTOR,
    SCATTER,
    SECTIONS,
    TUNING,
    model_arguments,
    with_conditions,
    with_event,
)
from xls_cells import read_cells

from addin.libreoffice.names import programmatic_name
from addin.worksheet.functions.model import TABLES
from addin.worksheet.registry import FUNCTIONS, FunctionError, call

pytestmark = pytest.mark.needs_libreoffice

MODEL = "[.A1]"
#: Columns that hold what a calculation took, which no two runs share.
MEASURED = {("TV_EFFECTS", "Time [ms]")}
#: Function → its arguments after the model as in a formula, and as the registry gets them.
CALLS = {
    "TV_FREQUENCIES": [("", []), ('"SI";FALSE()', ["SI", False])],
    "TV_MODE": [("2", [2.0])],
    "TV_ENERGY": [("", []), ("1;0", [1.0, False])],
    "TV_MARGINS": [("", [])],
    "TV_BANDS": [("", [])],
    "TV_STEADY": [("", [])],
    "TV_SPEED_TIME": [("50", [50.0])],
    "TV_PEAKS": [("", []), (";FALSE()", [None, False])],
    "TV_HISTORY": [('"LS coupling";101', ["LS coupling", 101.0])],
    "TV_REVERSALS": [("", [])],
    "TV_CYCLES": [("", [])],
    "TV_STARTS": [("", []), (";;4", [None, None, 4.0])],
    "TV_VERDICTS": [("", [])],
    "TV_CALIBRATE": [("30.1", [30.1])],
    "TV_TUNE": [("[.AD1:.AG2]", [TUNING]), ("[.Z1:.Z1];[.AD4:.AH7]", [None, CATALOGUE])],
    "TV_TOLERANCES": [('[.AD9:.AF11];"margins";30', [SCATTER, "margins", 30.0])],
    "TV_SENSITIVITIES": [("", [])],
    "TV_EFFECTS": [("", [])],
    "TV_EVENTS": [("", [])],
    "TV_CASE_VERDICTS": [("", [])],
    "TV_FATIGUE_LIMITS": [("", [])],
}
#: The others: formula after the name, and what the registry gets.
ALONE = {
    "TV_STIFFNESS": [
        ("200;[.Z1];500;79300", [200.0, None, 500.0, 79300.0]),
        ("200.1;30.3;500.7;79300;[.Z1]", [200.1, 30.3, 500.7, 79300.0]),
        ('8.1;;20.3;11500000;"US"', [8.1, None, 20.3, 11.5e6, "US"]),
    ],
    "TV_SECTIONS": [('[.AD18:.AI22];;"US"', [SECTIONS, None, "US"])],
    "TV_MOTOR_CIRCUIT": [("[.AD13:.AO15];60", [MOTOR, 60.0])],
    "TV_MOTOR_CURVES": [("[.AD13:.AO15];0.05;60", [MOTOR, 0.05, 60.0])],
    "TV_FAULT_TORQUE": [
        ('"three-phase fault";0.2;0.25', ["three-phase fault", 0.2, 0.25]),
        (
            '"out-of-phase closing";0.2;0.25;0.3;120',
            ["out-of-phase closing", 0.2, 0.25, 0.3, 120.0],
        ),
    ],
    "TV_LIFE": [("0.001;12;30;2", [0.001, 12.0, 30.0, 2.0])],
    "TV_CONVERT": [('0.1;"lbf*in";"N*m"', [0.1, "lbf*in", "N*m"])],
}
WRONG = {
    "TV_STIFFNESS(200;250;500;79300)": ("TV_STIFFNESS", [200.0, 250.0, 500.0, 79300.0]),
    'TV_STIFFNESS("wide";0;500;79300)': ("TV_STIFFNESS", ["wide", 0.0, 500.0, 79300.0]),
    "TV_STIFFNESS(1;0)": ("TV_STIFFNESS", [1.0, 0.0]),
    'TV_CONVERT(1;"florps";"m")': ("TV_CONVERT", [1.0, "florps", "m"]),
    'TV_PEAKS("tv:0123456789abcdef")': ("TV_PEAKS", ["tv:0123456789abcdef"]),
}


def address(row, column):
    letters, column = "", column + 1
    while column:
        column, rest = divmod(column - 1, 26)
        letters = chr(65 + rest) + letters
    return f"{letters}{row + 1}"


def laid_out(blocks, left=0):
    """Blocks below each other on one sheet, and their addresses on it."""
    cells, places, top = {}, [], 0
    for block in blocks:
        for i, row in enumerate(block):
            cells |= {(top + i, left + j): value for j, value in enumerate(row)}
        last = address(top + len(block) - 1, left + len(block[0]) - 1)
        places.append(f"[$Inputs.{address(top, left)}:.{last}]")
        top += len(block) + 1
    return cells, places


def without_blank(cells):
    return {at: value for at, value in cells.items() if value is not None}


def every_call(handle):
    """Every function: its name, the formula in Calc, and what the registry gets."""
    material = model_arguments()[3 + TABLES[2:].index("Materials")][2][0]
    life = (f'"{material}";[.Z2:.AB2]', [material, [[100.1, None, 31000.7]]])
    for name, many in [*CALLS.items(), ("TV_SN_LIFE", [life]), *ALONE.items()]:
        for written, raw in many:
            if name in ALONE:
                yield name, f"{name}({written})", raw
            else:
                inside = f"{MODEL}{';' if written else ''}{written}"
                yield name, f"{name}({inside})", [handle, *raw]


@pytest.fixture(scope="module")
def expected():
    """Top-left cell on sheet Results → rows of the registry, with the formula."""
    handle = call("TV_MODEL", with_conditions(with_event(model_arguments())))[0][0]
    found, top = {}, 2
    for name, formula, raw in every_call(handle):
        rows = call(name, raw)
        found[top, 0] = formula, rows
        top += len(rows) + 1
    return handle, found


@pytest.fixture(scope="module")
def calculated(calc, expected, tmp_path_factory):
    """The cells of the workbook as LibreOffice calculated it."""
    folder = tmp_path_factory.mktemp("workbook")
    inputs, places = laid_out(with_conditions(with_event(model_arguments())))
    broken = [[list(row) for row in block] for block in model_arguments()[:2]]
    column = broken[0][1].index("Inertia")
    broken[0][2][column] = None
    broken[0][4][column] = -3.0
    more, wrong_places = laid_out(broken, left=40)
    results = {
        (0, 0): Formula(f"TV_MODEL({';'.join(places)})"),
        (1, 25): 100.1,
        (1, 27): 31000.7,
    }
    for top, block in ((0, TUNING), (3, CATALOGUE), (8, SCATTER), (12, MOTOR), (17, SECTIONS)):
        for i, row in enumerate(block):
            results |= {(top + i, 29 + j): v for j, v in enumerate(row) if v is not None}
    for at, (formula, rows) in expected[1].items():
        results[at] = Formula(formula, len(rows), len(rows[0]))
    told = {(i, 0): Formula(formula) for i, formula in enumerate(WRONG)}
    told[0, 2] = Formula(f"TV_MODEL({';'.join(wrong_places)})")
    told[1, 2] = Formula('TV_CONVERT([.Z1:.Z1];"m";"mm")')
    told[2, 2] = Formula("1/0")
    told[3, 2] = Formula('TV_CONVERT([.C3];"m";"mm")')
    told[4, 2] = Formula('TV_CONVERT(30;"Hz";"cpm")*2+1')
    path = write_sheets(
        folder / "all.fods",
        {"Inputs": without_blank(inputs | more), "Results": results, "Told": told},
    )
    return read_cells(calc.convert(path, "xls"), calc.convert(path, "xlsx"))


def bits(value):
    """A cell so that only equal doubles are equal; a flag is 1 or 0, as in every cell of Calc."""
    return struct.pack("<d", value) if isinstance(value, (bool, float, int)) else value


def test_every_function_is_in_the_workbook(expected):
    written = {formula.split("(")[0] for formula, _ in expected[1].values()}
    assert written | {"TV_MODEL"} == set(FUNCTIONS)


def test_every_cell_is_that_of_the_registry_bit_for_bit(expected, calculated):
    handle, blocks = expected
    cells = calculated["Results"]
    assert cells[0, 0] == handle
    numbers = 0
    for (top, left), (formula, rows) in blocks.items():
        for i, row in enumerate(rows):
            for j, value in enumerate(row):
                there = cells[top + i, left + j]
                if value is not None and i and (formula.split("(")[0], rows[0][j]) in MEASURED:
                    assert there > 0.0
                    continue
                assert bits(there) == bits(value), (formula, i, j, there, value)
                numbers += isinstance(value, float)
    assert numbers > 500


def test_the_comparison_needs_all_bits(expected):
    """With the 15 digits of other files most of these numbers would be others."""
    values = [v for _, rows in expected[1].values() for row in rows for v in row]
    cut = [v for v in values if isinstance(v, float) and float(f"{v:.15g}") != v]
    assert len(cut) > 200


def test_wrong_inputs_give_their_sentence(calculated):
    for i, (formula, (name, raw)) in enumerate(WRONG.items()):
        with pytest.raises(FunctionError) as told:
            call(name, raw)
        assert calculated["Told"][i, 0] == told.value.message, formula


def test_a_blank_and_a_wrong_cell_of_a_table_are_named(calculated):
    told = calculated["Told"][0, 2]
    for words in ("Stations, row 1, Inertia", "row 3", "-3"):
        assert words in told


def test_a_blank_stays_a_blank(expected, calculated):
    assert calculated["Told"][1, 2] is None
    blanks = [
        calculated["Results"][top + i, left + j]
        for (top, left), (_, rows) in expected[1].items()
        for i, row in enumerate(rows)
        for j, value in enumerate(row)
        if value is None
    ]
    assert len(blanks) > 5
    assert set(blanks) == {None}


def test_an_error_value_goes_on_as_it_is(calculated):
    assert calculated["Told"][3, 2] == "#DIV/0!"


def test_an_answer_of_one_cell_can_be_calculated_with(calculated):
    assert calculated["Told"][4, 2] == 3601.0


@pytest.mark.slow
def test_the_names_people_type_are_those_of_the_contract(calc, tmp_path):
    """Calc shows what a file calls by its programmatic name under the name of the registry."""
    path = write_sheets(tmp_path / "one.fods", {"S": {(0, 0): Formula('TV_CONVERT(2;"m";"mm")')}})
    shown = calc.convert(
        path, "csv:Text - txt - csv (StarCalc):44,34,76,1,,0,false,false,false,true"
    )
    text = shown.read_text(encoding="utf-8")
    assert "TV_CONVERT(2" in text
    assert programmatic_name("TV_CONVERT") not in text
