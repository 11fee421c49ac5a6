"""Reading workbooks: every trap of typed input with its sentence, and what is read right."""

from __future__ import annotations

import json
import math
import time
import zipfile
from pathlib import Path

import openpyxl
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from small_workbook import TABLE_ROWS, Calculated, Formatted, SmallWorkbook
from strategies import example_count

from addin.contract.shipped import template_path
from addin.contract.tables import INPUT_TABLES, SCALARS
from addin.reading.workbook import read_workbook
from addin.xlsx.errors import WorkbookRefused
from engine.case.case import Case
from engine.case.data import case_digest
from engine.case.effects import EFFECTS

RPM = math.pi / 30.0
LBF_FT = 1.3558179483314
LBF_IN = LBF_FT / 12.0


@pytest.fixture
def workbook() -> SmallWorkbook:
    return SmallWorkbook()


@pytest.fixture
def read(tmp_path):
    def save_and_read(workbook):
        return read_workbook(workbook.save(tmp_path / "small.xlsx"))

    return save_and_read


def only_problem(found, column):
    """The single problem of a reading, which is in a certain column."""
    assert [p.column for p in found.problems] == [column], [p.message for p in found.problems]
    return found.problems[0]


# --- what is right --------------------------------------------------------------------------------


def test_a_right_workbook(workbook, read):
    found = read(workbook)
    assert found.problems == ()
    assert found.warnings == ()
    assert found.template_version == "1"
    case = found.case()
    assert isinstance(case, Case)
    assert case.line_frequency == 60.0
    assert case.synchronous_speed == pytest.approx(1800 * RPM, rel=1e-15)
    assert case.damping_ratio == 0.015
    assert case.stations[0].inertia == pytest.approx(42.1401100938, rel=1e-11)
    assert case.elements[0].stiffness == pytest.approx(1e6 * LBF_IN, rel=1e-12)
    assert case.motor_torque[1].speed == 0.5
    assert case.motor_torque[1].average == pytest.approx(0.66 * 1000 * LBF_FT, rel=1e-12)
    assert case.load_torque[1].torque == pytest.approx(250 * LBF_FT, rel=1e-12)
    assert case.materials[0].uts == pytest.approx(758423302.2, rel=1e-9)


def test_places(workbook, read):
    found = read(workbook)
    sheet, cell = found.locations.cell("Elements", 1, "Stiffness")
    assert (sheet, cell) == ("Train", workbook.places["Elements", 1, "Stiffness"])
    assert found.locations.cell("Case", None, "LineFrequency")[0] == "Case"


def test_the_same_case_in_other_units_has_the_same_digest(workbook, read):
    first = case_digest(read(workbook).data)
    other = SmallWorkbook()
    other.units[("Stations", "Inertia")] = "kg·m²"
    for row, value in zip(
        other.rows["Stations"], (42.14011009380479, 21.070055046902397), strict=True
    ):
        row["Inertia"] = value
    other.units["SynchronousSpeed"] = "Hz"
    other.scalars["SynchronousSpeed"] = 30
    other.units[("MotorTorque", "Average")] = "pu"
    for row, value in zip(other.rows["MotorTorque"], (0.55, 0.66, 0), strict=True):
        row["Average"] = value
    other.units[("LoadTorque", "Speed")] = "rpm"
    other.rows["LoadTorque"][1]["Speed"] = 1800
    assert case_digest(read(other).data) == first


def test_speeds_of_a_geared_station_are_compared_with_its_own_full_speed(workbook, read):
    workbook.rows["Stations"][1]["Speed ratio"] = 5.0
    workbook.rows["Elements"][0]["Kind"] = "gear mesh"
    workbook.units[("LoadTorque", "Speed")] = "rpm"
    workbook.rows["LoadTorque"][1]["Speed"] = 9000
    found = read(workbook)
    assert found.problems == ()
    assert found.data.load_torque[1].speed == pytest.approx(1.0, rel=1e-14)


def test_percent_of_synchronous_speed(workbook, read):
    workbook.scalars["EndSpeed"] = 95
    workbook.scalars["MaximumSpeed"] = 105
    workbook.units["MaximumSpeed"] = "%"
    data = read(workbook).data
    assert data.end_speed == pytest.approx(0.95 * 1800 * RPM, rel=1e-14)
    assert data.maximum_speed == pytest.approx(1.05 * 1800 * RPM, rel=1e-14)


def test_torque_of_an_excitation_as_a_share(workbook, read):
    workbook.rows["Excitations"] = [{"Name": "line", "Frequency": 60, "Torque": 1.5}]
    row = read(workbook).data.excitations[0]
    assert (row.torque, row.torque_share) == (None, 0.015)
    workbook.units[("Excitations", "Torque")] = "pu"
    row = read(workbook).data.excitations[0]
    assert row.torque == pytest.approx(1.5 * 1000 * LBF_FT)
    assert row.torque_share is None


def test_names_are_trimmed_and_words_are_read_kindly(workbook, read):
    workbook.rows["Stations"][0]["Station"] = " Motor\u00a0"
    workbook.rows["Elements"][0]["Kind"] = "Coupling "
    workbook.rows["Elements"].append(
        {
            "Element": "Soil",
            "Kind": "Spring to ground",
            "From": "Load",
            "To": "GROUND",
            "Stiffness": 5,
        }
    )
    workbook.rows["MotorTorque"] = workbook.rows["LoadTorque"] = []
    workbook.rows["Materials"][0]["Below endurance"] = "2k−1"
    found = read(workbook)
    assert found.problems == ()
    assert found.data.elements[0].kind == "coupling"
    assert found.data.elements[1].to == "ground"
    assert found.data.materials[0].below_endurance == "2k-1"


@pytest.mark.parametrize(
    "typed", ["LS  hub", "LS\nhub", "LS\u2009hub", "LS hub\u200b", "\ufeffls hub", "LS\u00a0hub"]
)
def test_names_that_look_alike_are_one(workbook, read, typed):
    """The sentence was: found 'LS hub'; did you mean 'LS hub'?"""
    workbook.rows["Stations"][0]["Station"] = "LS hub"
    workbook.rows["MotorTorque"] = []
    workbook.rows["Elements"][0] |= {"From": typed, "Kind": "coupling\u200b"}
    workbook.units["Stations", "Inertia"] = "lb\u2009ft²\u200b"
    found = read(workbook)
    assert found.problems == ()
    assert found.data.elements[0].from_ == "LS hub"


@pytest.mark.parametrize(
    ("place", "column"),
    [(("Stations", 1), "Station"), (("Elements", 0), "Element"), (None, "Revision")],
)
def test_a_date_is_no_name(workbook, read, place, column):
    """Excel makes one of 1-2, and the shaft was called 46024 in every result."""
    if place is None:
        workbook.scalars[column] = Formatted(46024, "yyyy-mm-dd")
    else:
        workbook.rows[place[0]][place[1]][column] = Formatted(46024, "d-mmm")
    problem = next(p for p in read(workbook).problems if p.column == column)
    assert "formatted as a date" in problem.message
    assert "format the cell as Text" in problem.message


def test_numbers_as_names(workbook, read):
    workbook.rows["Stations"] = [{"Station": 1, "Inertia": 5}, {"Station": 2, "Inertia": 5}]
    workbook.rows["Elements"][0] |= {"From": 1, "To": "2"}
    workbook.rows["MotorTorque"] = workbook.rows["LoadTorque"] = []
    found = read(workbook)
    assert found.problems == ()
    assert [s.station for s in found.data.stations] == ["1", "2"]


def test_blank_rows_are_passed_over_and_rows_are_counted_as_in_the_sheet(workbook, read):
    workbook.rows["Stations"].insert(1, None)
    workbook.rows["Stations"].append(None)
    workbook.rows["Stations"][2]["Inertia"] = -5
    problem = only_problem(read(workbook), "Inertia")
    assert problem.row == 3
    assert problem.cell == workbook.places["Stations", 3, "Inertia"]


def test_rows_named_inside_a_sentence_are_counted_as_in_the_sheet(workbook, read):
    workbook.rows["MotorTorque"].insert(0, None)
    workbook.rows["MotorTorque"][3]["Speed"] = 40
    problem = only_problem(read(workbook), "Speed")
    assert problem.row == 4
    assert "of row 3" in problem.message


def test_formulas_with_a_value_are_read_and_blank_ones_are_blank(workbook, read):
    workbook.rows["Stations"][0]["Inertia"] = Calculated("=500+500", 1000)
    workbook.rows["Stations"][0]["Speed ratio"] = Calculated('=IF(1=1," ",2)', " ")
    found = read(workbook)
    assert found.problems == ()
    assert found.data.stations[0].inertia == pytest.approx(42.1401100938)
    assert found.data.stations[0].speed_ratio is None


def test_headers_may_differ_in_capitals_and_blanks(workbook, read):
    workbook.headers[("Elements", "Stress diameter")] = "Stress  Diameter "
    assert read(workbook).problems == ()


def test_names_beyond_the_contract_may_be_missing(workbook, read):
    workbook.without.add("RainflowResidue")
    workbook.headers[("Meshes", "Gear type")] = None
    workbook.headers[("EventTorque", "Per life")] = None
    workbook.headers[("MotorEvents", "Per life")] = None
    workbook.headers[("MotorEvents", "Latest clearing")] = None
    workbook.headers[("MotorEvents", "Clearing")] = None
    found = read(workbook)
    assert found.problems == ()
    assert found.warnings == ()


@pytest.mark.parametrize("value", [30.0, None])
def test_a_value_beside_the_words_of_a_deleted_name_is_not_ignored(
    tmp_path: Path, value: float | None
) -> None:
    book = openpyxl.load_workbook(template_path("example_proposed.xlsx"))
    cell = book.defined_names["DampingRange"].attr_text.split("!")[1].replace("$", "")
    del book.defined_names["DampingRange"]
    book["Case"][cell] = value
    book.save(tmp_path / "train.xlsx")
    problems = read_workbook(tmp_path / "train.xlsx").problems
    assert [p.column for p in problems] == (["DampingRange"] if value else [])


# --- one wrong cell, one sentence -----------------------------------------------------------------

WRONG_NUMBERS = [
    (
        "12,5",
        "has a decimal comma and is text. Type it again with the decimal separator of your Excel (12.5",
    ),
    ("1,250", "with a thousands separator or a decimal comma"),
    ("1 250", "with a thousands separator or a decimal comma"),
    ("1\u2009250,5", "with a thousands separator or a decimal comma"),
    ("1.250,5", "with a thousands separator or a decimal comma"),
    ("300\u200b", "looks like a number but is text"),
    (" 300", "looks like a number but is text"),
    ("1.2e5 ", "looks like a number but is text"),
    ("300", "looks like a number but is text"),
    ("10 kg*m^2", "Leave only the number 10 and put the unit kg*m^2 in the cell above the header"),
    (
        "10 ohm",
        "which has a unit that does not fit: 'ohm' is not a unit of inertia; write a unit such as",
    ),
    ("tbd", "is not a number. Type a number or leave the cell blank"),
    (True, "found TRUE; type a number"),
    (Formatted(45000, "dd/mm/yyyy"), "formatted as a date"),
    (Formatted(45000.5, "[$-409]h:mm AM/PM;@"), "formatted as a date"),
    (Calculated("=1/0", "#DIV/0!"), "found the error #DIV/0!. Correct the formula"),
    (Calculated("=NA()", "#N/A"), "found the error #N/A"),
    ("#REF!", "found the error #REF!. Type the value"),
]


@pytest.mark.parametrize(("value", "sentence"), WRONG_NUMBERS, ids=lambda v: str(v)[:24])
def test_a_cell_that_is_no_number(workbook, read, value, sentence):
    workbook.rows["Stations"][1]["Inertia"] = value
    problem = only_problem(read(workbook), "Inertia")
    cell = workbook.places["Stations", 2, "Inertia"]
    assert problem.message.startswith(
        f"Sheet Train, table Stations, row 2, Inertia (cell {cell}): "
    )
    assert sentence in problem.message
    assert (problem.sheet, problem.table, problem.row, problem.cell) == (
        "Train",
        "Stations",
        2,
        cell,
    )
    assert problem.allowed


def test_a_scalar_with_its_unit_inside(workbook, read):
    workbook.scalars["LineFrequency"] = "60 Hz"
    problem = only_problem(read(workbook), "LineFrequency")
    assert problem.message.startswith("Sheet Case, LineFrequency (cell E")
    assert "put the unit Hz in the cell to the right of it" in problem.message


@pytest.mark.parametrize("code", ["0.00", "#,##0", '0" d"', "General", "0.00E+00", "[Red]0.0"])
def test_number_formats_that_are_no_dates(workbook, read, code):
    workbook.rows["Stations"][1]["Inertia"] = Formatted(500, code)
    assert read(workbook).problems == ()


def test_percent_stated_twice(workbook, read):
    workbook.scalars["DampingRatio"] = Formatted(0.015, "0.0%")
    problem = only_problem(read(workbook), "DampingRatio")
    assert "shows 1.5% but contains 0.015, and its unit is already %" in problem.message
    assert "type 1.5" in problem.message
    workbook.units["DampingRatio"] = "1"
    found = read(workbook)
    assert found.problems == ()
    assert found.data.damping_ratio == 0.015


def test_a_formula_nobody_calculated(workbook, tmp_path):
    workbook.rows["Stations"][1]["Inertia"] = Calculated("=250*2", 500)
    path = workbook.save(tmp_path / "small.xlsx")
    without_values(path, "<v>500</v>")
    problem = only_problem(read_workbook(path), "Inertia")
    assert "the formula has no stored value" in problem.message
    assert "let it calculate, and save it" in problem.message


@pytest.mark.parametrize("place", ["DampingRatio", ("Stations", "Inertia")])
@pytest.mark.parametrize(
    ("unit", "sentence"),
    [
        (Calculated("=NA()", "#N/A"), "found the error #N/A. Correct the formula"),
        ("#REF!", "found the error #REF!. Type the value"),
        (True, "found TRUE; type a unit."),
        (Calculated("=250*2", 500), "the formula has no stored value"),
    ],
    ids=["error of a formula", "error", "TRUE", "formula without value"],
)
def test_a_unit_that_cannot_be_told(workbook, tmp_path, place, unit, sentence):
    """A ratio without unit is a plain number: 0.5 with its % lost would be 50 %."""
    workbook.scalars["DampingRatio"] = 0.5
    workbook.units[place] = unit
    path = workbook.save(tmp_path / "small.xlsx")
    without_values(path, "<v>500</v>")
    problem = only_problem(read_workbook(path), place if isinstance(place, str) else place[1])
    assert "unit cell" in problem.message
    assert sentence in problem.message


def test_a_unit_that_is_a_formula(workbook, read):
    workbook.scalars["DampingRatio"] = 0.5
    workbook.units["DampingRatio"] = Calculated('="%"', "%")
    assert read(workbook).case().damping_ratio == 0.005


def without_values(path: Path, text: str) -> None:
    """Take a piece of text out of every sheet."""
    with zipfile.ZipFile(path) as archive:
        parts = {name: archive.read(name) for name in archive.namelist()}
    with zipfile.ZipFile(path, "w") as archive:
        for name, data in parts.items():
            if name.startswith("xl/worksheets/"):
                data = data.replace(b"<f>250*2</f>" + text.encode(), b"<f>250*2</f>")
            archive.writestr(name, data)


def test_a_negative_number_is_told_in_its_own_unit(workbook, read):
    workbook.rows["Elements"][0]["Stiffness"] = -2e5
    problem = only_problem(read(workbook), "Stiffness")
    assert "found -200000 lbf*in/rad = -22597 N m/rad; it must be positive" in problem.message
    assert problem.found == "-200000 lbf*in/rad"


def test_a_blank_required_cell(workbook, read):
    del workbook.rows["Stations"][1]["Inertia"]
    problem = only_problem(read(workbook), "Inertia")
    assert "the cell is blank; it must be positive" in problem.message
    assert problem.cell == workbook.places["Stations", 2, "Inertia"]


def test_a_word_that_is_not_among_the_choices(workbook, read):
    workbook.rows["Elements"][0]["Kind"] = "cuopling"
    problem = only_problem(read(workbook), "Kind")
    assert (
        "one of shaft, coupling, gear mesh, spring to ground. Did you mean 'coupling'?"
        in problem.message
    )
    workbook.rows["Elements"][0]["Kind"] = False
    assert "found FALSE; it must be one of shaft" in only_problem(read(workbook), "Kind").message


def test_half_a_pole(workbook, read):
    workbook.scalars["Poles"] = 4.5
    assert "must be a whole number" in only_problem(read(workbook), "Poles").message


# --- units ----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("unit", "sentence"),
    [
        ("lbm*in", "'lbm*in' is not a unit of torsional stiffness"),
        ("lbm*in/rad", "lb is a mass, not a force: write lbf*in/rad"),
        ("lbf*inch/radd", "is not known; did you mean lbf*in/rad?"),
        ("kg*m^2", "not a unit of torsional stiffness"),
        ("", "no unit is given; write a unit such as lbf*in/rad"),
    ],
)
def test_a_wrong_unit_is_one_problem_of_the_column(workbook, read, unit, sentence):
    workbook.units[("Elements", "Stiffness")] = unit
    problem = only_problem(read(workbook), "Stiffness")
    assert problem.row is None
    cell = problem.cell
    assert problem.message.startswith(
        f"Sheet Train, table Elements, Stiffness (unit cell {cell}): "
    )
    assert int(cell[1:]) == int(workbook.places["Elements", 1, "Stiffness"][1:]) - 2
    assert sentence in problem.message


def test_a_wrong_unit_of_a_scalar(workbook, read):
    workbook.units["SynchronousSpeed"] = "1/s"
    problem = only_problem(read(workbook), "SynchronousSpeed")
    assert "unit cell F" in problem.message
    assert "does not state revolutions or radians" in problem.message


def test_the_unit_of_an_empty_column_does_not_matter(workbook, read):
    workbook.units[("Elements", "Density")] = "nonsense"
    assert read(workbook).problems == ()


def test_per_unit_without_rated_torque_is_told_once_a_column(workbook, read):
    del workbook.scalars["RatedTorque"]
    found = read(workbook)
    assert [(p.table, p.row, p.column) for p in found.problems] == [
        ("MotorTorque", 1, "Average"),
        ("MotorTorque", 1, "Pulsating"),
    ]
    assert "and 2 more rows of this column" in found.problems[0].message
    assert "Type RatedTorque" in found.problems[0].message


def test_nothing_follows_from_a_rated_torque_that_cannot_be_read(workbook, read):
    workbook.scalars["RatedTorque"] = "1000 lbf*ft"
    only_problem(read(workbook), "RatedTorque")


def test_rated_torque_in_per_unit_of_itself(workbook, read):
    workbook.units["RatedTorque"] = "pu"
    problem = only_problem(read(workbook), "RatedTorque")
    assert "is the base of pu and % and needs a torque unit" in problem.message


def test_speeds_in_rpm_without_synchronous_speed(workbook, read):
    del workbook.scalars["SynchronousSpeed"]
    workbook.rows["MotorTorque"] = []
    workbook.units[("LoadTorque", "Speed")] = "rpm"
    problem = only_problem(read(workbook), "Speed")
    assert "Type SynchronousSpeed, or LineFrequency and Poles" in problem.message


def test_percent_beyond_the_curve(workbook, read):
    workbook.rows["LoadTorque"][1]["Speed"] = 1800
    problem = only_problem(read(workbook), "Speed")
    assert "Write 50 % or 900 rpm" in problem.message
    assert problem.found == "1800 %"


# --- names, tables and columns --------------------------------------------------------------------


def test_a_missing_table(workbook, read):
    workbook.without.add("Stations")
    found = read(workbook)
    assert [(p.table, p.column) for p in found.problems] == [("Stations", "")]
    assert "no table of this name" in found.problems[0].message
    assert "Table Design > Table Name" in found.problems[0].message


def test_a_renamed_column(workbook, read):
    workbook.headers[("Elements", "Stiffness")] = "Stifness k"
    problem = only_problem(read(workbook), "Stiffness")
    assert "Column 'Stifness k' is similar; rename it" in problem.message
    assert problem.found == "Stifness k"


def test_a_missing_column_of_names_starts_no_avalanche(workbook, read):
    workbook.headers[("Stations", "Station")] = None
    assert [p.column for p in read(workbook).problems] == ["Station"]


def test_a_missing_defined_name(workbook, read):
    workbook.without.add("DampingRatio")
    problem = only_problem(read(workbook), "DampingRatio")
    assert "no such defined name" in problem.message
    assert "Name Manager" in problem.message


def test_a_defined_name_that_leads_nowhere(workbook, tmp_path):
    path = workbook.save(tmp_path / "small.xlsx")
    with zipfile.ZipFile(path) as archive:
        parts = {name: archive.read(name) for name in archive.namelist()}
    book = parts["xl/workbook.xml"].decode()
    start = book.index(">", book.index('name="Poles"')) + 1
    parts["xl/workbook.xml"] = (
        book[:start] + "Case!#REF!" + book[book.index("<", start) :]
    ).encode()
    with zipfile.ZipFile(path, "w") as archive:
        for name, data in parts.items():
            archive.writestr(name, data)
    assert (
        "refers to no cell, because its row or sheet was deleted"
        in only_problem(read_workbook(path), "Poles").message
    )


def test_merged_cells_in_a_table(workbook, read):
    workbook.merged.append(("Stations", 1, 2, "Inertia"))
    problem = only_problem(read(workbook), "Inertia")
    assert "are merged and share one value" in problem.message


# --- several at once ------------------------------------------------------------------------------


def test_all_problems_are_told_at_once_in_the_order_of_the_tables(workbook, read):
    workbook.scalars["LineFrequency"] = "sixty"
    workbook.rows["Stations"][0]["Inertia"] = "12,5"
    workbook.rows["Stations"][1]["Inertia"] = -1
    workbook.rows["Elements"][0]["To"] = "Laod"
    workbook.units[("Elements", "Stiffness")] = "lbm*in"
    workbook.rows["SNPoints"][1]["Stress"] = 60000
    found = read(workbook)
    places = {(p.table, p.row, p.column) for p in found.problems}
    assert {
        ("Case", None, "LineFrequency"),
        ("Stations", 1, "Inertia"),
        ("Stations", 2, "Inertia"),
        ("Elements", None, "Stiffness"),
        ("Elements", 1, "To"),
        ("SNPoints", 2, "Stress"),
    } <= places
    order = [p.table for p in found.problems]
    assert order == sorted(
        order, key=["Case", "Stations", "Elements", "Materials", "SNPoints"].index
    )


def test_a_problem_as_json(workbook, read):
    workbook.rows["Stations"][1]["Inertia"] = "12,5"
    content = read(workbook).problems[0].as_json()
    assert list(content) == ["sheet", "table", "row", "column", "found", "allowed", "message"]
    assert content["found"] == "12,5"
    assert content["row"] == 2


# --- warnings -------------------------------------------------------------------------------------


def test_hidden_rows_are_read_and_told(workbook, read):
    workbook.hidden.append(("Stations", 2))
    found = read(workbook)
    assert len(found.data.stations) == 2
    assert found.warnings == (
        "Sheet Train, table Stations: row 2 is hidden or filtered, but included in the "
        "calculation.",
    )


def test_a_row_right_below_a_table_is_told(workbook, read):
    workbook.below["Stations"] = "Forgotten"
    (warning,) = read(workbook).warnings
    assert "the row below the table" in warning
    assert "is not read" in warning


def test_another_template_version_is_told(workbook, read):
    workbook.scalars["TemplateVersion"] = "0.9"
    found = read(workbook)
    assert found.problems == ()
    assert found.template_version == "0.9"
    assert "template version '0.9'" in found.warnings[0]


def test_a_workbook_without_the_choice_of_speed_says_which_one_it_now_has(workbook, read):
    assert read(workbook).warnings == ()  # blank is no earlier version
    workbook.without.add("TorqueFollows")
    found = read(workbook)
    assert not found.data.reads_own_speed
    (warning,) = found.warnings
    assert "read at the mean speed" in warning
    assert "set TorqueFollows to own speed" in warning
    workbook.rows["MotorTorque"] = []
    assert read(workbook).warnings == ()  # no curve to read


def test_effects_without_a_choice_state_nothing(workbook, read):
    """Workbooks are shipped with the names of all effects; only choices enter the case."""
    plain = case_digest(read(workbook).data)
    workbook.rows["EffectChoices"] = [{"Effect": name} for name in EFFECTS]
    found = read(workbook)
    assert found.data.effect_choices == ()
    assert case_digest(found.data) == plain


def test_a_choice_between_blank_ones_is_read_and_named_by_its_row(workbook, read):
    rows = [{"Effect": name} for name in EFFECTS]
    rows[6] = {"Effect": "Backlash", "Choice": "Off"}
    workbook.rows["EffectChoices"] = rows
    (chosen,) = read(workbook).data.effect_choices
    assert (chosen.effect, chosen.choice) == ("backlash", "off")
    rows[6] = {"Effect": "backlesh", "Choice": "off"}
    (problem,) = read(workbook).problems
    assert (problem.table, problem.row, problem.column) == ("EffectChoices", 7, "Effect")
    assert "Did you mean 'backlash'?" in problem.message


def test_a_workbook_of_an_earlier_version_has_no_contact_law(workbook, read):
    workbook.without.add("ContactLaw")
    found = read(workbook)
    assert found.problems == ()
    assert found.data.contact_law is None


def test_a_word_in_place_of_the_phase(workbook, read):
    workbook.scalars["PulsationPhase"] = " Worst"
    found = read(workbook)
    assert found.problems == ()
    assert found.data.pulsation_phase == "worst"
    workbook.scalars["PulsationPhase"] = "worse"
    (problem,) = read(workbook).problems
    assert (problem.table, problem.column) == ("Case", "PulsationPhase")
    assert "worse" in problem.message


def test_a_workbook_of_an_earlier_version_has_no_phase_of_its_curve(workbook, read):
    for column in ("Phase", "Pulsation1"):
        workbook.headers[("MotorTorque", column)] = None
    found = read(workbook)
    assert found.problems == ()
    blank = [(row.phase, row.pulsation_1) for row in found.data.motor_torque]
    assert blank == [(None, None)] * len(found.data.motor_torque)


def test_a_workbook_of_an_earlier_version_has_no_events(workbook, read):
    workbook.without |= {"EventTorque", "InitialState"}
    found = read(workbook)
    assert found.problems == ()
    assert found.data.event_torque == ()
    assert found.data.initial_state is None


def test_endless_text_is_told_shortly(workbook, read):
    workbook.rows["Stations"][1]["Inertia"] = "m" * 32_000
    workbook.units[("Elements", "Stiffness")] = "m" * 32_000
    workbook.rows["Materials"][0]["Basis"] = "m" * 32_000
    began = time.perf_counter()
    problems = read(workbook).problems
    assert time.perf_counter() - began < 2.0
    assert len(problems) == 3
    assert all(len(problem.message) < 300 for problem in problems)


PLACES = [
    (table.name, row, column.name)
    for table in INPUT_TABLES
    for row in range(len(TABLE_ROWS.get(table.name, ())) + 1)
    for column in table.columns
]
TYPED = st.sampled_from(
    [
        None,
        "",
        " ",
        0,
        -1,
        1e-12,
        1e40,
        4.5,
        True,
        "Motor",
        "Load",
        "ground",
        "12,5",
        "#N/A",
        "shaft",
    ]
    + ["gear mesh", Calculated("=NA()", "#N/A"), Calculated("=1+1", 2), Formatted(3, "d/m/yy")]
) | st.text(max_size=6)
UNITS = st.sampled_from(["", "%", "pu", "rpm", "N*m", "kg*m^2", "lb*ft", "1", "nonsense", "Hz"])


@settings(example_count(40), suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    cells=st.dictionaries(st.sampled_from(PLACES), TYPED, max_size=6),
    scalars=st.dictionaries(st.sampled_from([s.name for s in SCALARS]), TYPED, max_size=3),
    units=st.dictionaries(st.sampled_from([(t, c) for t, _, c in PLACES]), UNITS, max_size=2),
)
def test_whatever_is_typed_is_read_or_told(read, cells, scalars, units):
    workbook = SmallWorkbook(units=dict(units))
    workbook.scalars |= scalars
    for (table, row, column), value in cells.items():
        rows = workbook.rows.setdefault(table, [])
        if row == len(rows):
            rows.append({})
        rows[min(row, len(rows) - 1)][column] = value
    found = read(workbook)
    for problem in found.problems:
        assert problem.message.startswith(f"Sheet {problem.sheet}")
        assert problem.message.endswith((".", "?"))
        json.dumps(problem.as_json(), allow_nan=False)
    if not found.problems:
        assert isinstance(found.case(), Case)


# --- guards and speed -----------------------------------------------------------------------------


def test_a_file_that_is_no_workbook(tmp_path):
    path = tmp_path / "notes.xlsx"
    path.write_text("not a workbook")
    with pytest.raises(WorkbookRefused):
        read_workbook(path)


def test_a_table_over_the_whole_sheet_is_read_quickly(workbook, tmp_path):
    path = workbook.save(tmp_path / "small.xlsx")
    with zipfile.ZipFile(path) as archive:
        parts = {name: archive.read(name) for name in archive.namelist()}
    for name, data in parts.items():
        if name.startswith("xl/tables/") and b'"FatigueFactors"' in data:
            start = data.index(b'ref="') + 5
            old = data[start : data.index(b'"', start)]
            parts[name] = data.replace(
                old, old[: old.rindex(b"$") if b"$" in old else old.index(b":")] + b":I1048576"
            )
    with zipfile.ZipFile(path, "w") as archive:
        for name, data in parts.items():
            archive.writestr(name, data)
    began = time.perf_counter()
    found = read_workbook(path)
    assert time.perf_counter() - began < 2.0
    assert len(found.data.sn_points) == 2
    assert len(found.data.fatigue_factors) == 0
    assert found.workbook.table("FatigueFactors").ref.bottom == 1048576


def test_an_open_workbook_is_read_as_it_stands(workbook, tmp_path):
    from addin.xlsx import open_workbook

    opened = open_workbook(workbook.save(tmp_path / "small.xlsx"))
    assert read_workbook(opened).data == read_workbook(tmp_path / "small.xlsx").data


def with_other_names(path, change):
    """The same workbook, the text of its list of sheets and names changed."""
    with zipfile.ZipFile(path) as archive:
        parts = {name: archive.read(name) for name in archive.namelist()}
    parts["xl/workbook.xml"] = change(parts["xl/workbook.xml"].decode()).encode()
    with zipfile.ZipFile(path, "w") as archive:
        for name, data in parts.items():
            archive.writestr(name, data)
    return path


def test_a_name_of_the_product_is_never_taken_for_a_missing_one(workbook, tmp_path):
    """`run_Outcome`, `ElementNames`, ... stand for something else."""
    workbook.without.add("LineFrequency")
    path = workbook.save(tmp_path / "small.xlsx")
    names = '<definedName name="run_LineFrequency">Case!$Z$1</definedName></definedNames>'
    with_other_names(path, lambda book: book.replace("</definedNames>", names))
    problem = only_problem(read_workbook(path), "LineFrequency")
    assert "no such defined name" in problem.message
    assert "is similar" not in problem.message


def test_names_that_lead_to_a_sheet_that_was_renamed_are_one_problem(workbook, tmp_path):
    path = workbook.save(tmp_path / "small.xlsx")
    with_other_names(path, lambda book: book.replace('<sheet name="Case"', '<sheet name="Fall"'))
    found = read_workbook(path)
    about = [p for p in found.problems if p.table == "Case"]
    assert len(about) == 1
    assert "refer to sheet Case" in about[0].message
    assert "Poles" in about[0].message
    assert "another program renamed the sheet" in about[0].message


def test_one_name_that_leads_to_a_sheet_that_is_gone(workbook, tmp_path):
    def other(book):
        start = book.index(">", book.index('name="Poles"')) + 1
        return book[:start] + "'My case'!$B$4" + book[book.index("<", start) :]

    path = with_other_names(workbook.save(tmp_path / "small.xlsx"), other)
    problem = only_problem(read_workbook(path), "Poles")
    assert "refers to sheet My case, which is missing in the workbook" in problem.message
