"""Inputs: read, looked at, changed by name, checked, written."""

import dataclasses
import json
import math

import openpyxl
import pandas as pd
import pytest

import torsionbook as tb
from addin.contract.tables import EVERY_INPUT
from addin.reading.one_file import read_checked

LBF_IN = 0.45359237 * 9.80665 * 0.0254  # N m
EXAMPLES = (
    "example_proposed",
    "example_modified",
    "example_backlash",
    "example_motor",
    "example_studies",
)


@pytest.fixture(scope="module")
def train():
    return tb.read(tb.template("example_modified"))


def test_shipped_workbooks_are_found_by_name():
    assert tb.template().name == "blank_us.xlsx"
    with pytest.raises(
        LookupError, match="There is no shipped workbook 'nonsense'. There are blank_si, blank_us"
    ):
        tb.template("nonsense")


def test_scalars_rows_and_values_are_in_si(train):
    assert train.scalars["LineFrequency"] == 60.0
    assert train.value("line_frequency") == 60.0
    coupling = next(row for row in train.rows("Elements") if row["element"] == "LS coupling")
    assert coupling["stiffness"] == pytest.approx(
        2.95e8 * 0.0254 * 4.4482216152605, rel=1e-6
    )  # of the example, in N m/rad
    assert train.value("Elements[LS coupling].Stiffness") == coupling["stiffness"]
    assert train.value("Elements[LS coupling].Damping") is None
    assert train.value("MotorTorque[1].Speed") == 0.0


def test_an_input_cannot_be_written_to(train):
    with pytest.raises(dataclasses.FrozenInstanceError):
        train._read = None
    with pytest.raises(TypeError):
        train.scalars["LineFrequency"] = 50.0
    with pytest.raises(TypeError):
        train.rows("Elements")[0]["stiffness"] = 1.0


def test_a_change_gives_a_new_input_and_leaves_the_old_one(train):
    before = train.to_json()
    changed = train.change(
        {
            "Elements[LS coupling].Stiffness [lbf*in/rad]": 2e8,
            "Elements[3].Stiffness": "200 MN*m/rad",
            "DampingRatio": "2 %",
            "Title": "softer",
            "StartsRequired": None,
        }
    )
    assert changed.value("Elements[LS coupling].Stiffness") == pytest.approx(
        2e8 * LBF_IN, rel=1e-12
    )
    assert changed.value("Elements[3].Stiffness") == 2e8
    assert changed.value("DampingRatio") == 0.02
    assert changed.scalars["Title"] == "softer"
    assert changed.value("StartsRequired") is None
    assert changed.problems == ()
    assert train.to_json() == before
    others = {
        k: v
        for k, v in before.items()
        if k not in ("elements", "damping_ratio", "title", "starts_required")
    }
    assert {k: v for k, v in changed.to_json().items() if k in others} == others


def test_units_relative_to_what_changes_are_taken_anew(train):
    """The curves of the motor are typed in pu of RatedTorque."""
    before, factor = train.rows("MotorTorque"), 1.25
    changed = train.change({"RatedTorque": factor * train.value("RatedTorque")})
    for old, new in zip(before, changed.rows("MotorTorque"), strict=True):
        assert new["average"] == pytest.approx(factor * old["average"], rel=1e-12)


def test_names_that_lead_nowhere_are_all_named(train):
    with pytest.raises(tb.InputError) as raised:
        train.change(
            {"DampingRatoi": 1, "Elements[LS couplng].Stiffness": 1, "Elements[Mesh].Lenght": 1}
        )
    first, second, third = (problem.message for problem in raised.value.problems)
    assert (
        first
        == "'DampingRatoi': scalar 'DampingRatoi' does not exist. Did you mean 'DampingRatio'?"
    )
    assert "has no row 'LS couplng'. Did you mean 'LS coupling'?" in second
    assert "column of Elements 'Lenght' does not exist. Did you mean 'Length'?" in third
    assert str(raised.value) == "\n".join((first, second, third))


def test_a_wrong_value_is_a_problem_with_its_place(train):
    wrong = train.change(
        {"Elements[LS coupling].Stiffness": "-3 MN*m/rad", "DampingRatio": "twelve"}
    )
    scalar, cell = wrong.problems
    assert (scalar.table, scalar.column, scalar.found) == ("Case", "DampingRatio", "twelve")
    assert (cell.sheet, cell.table, cell.row, cell.column) == ("Train", "Elements", 2, "Stiffness")
    assert cell.message.startswith(
        "Sheet Train, table Elements, row 2, Stiffness (key elements[1].stiffness): found -3 MN*m/rad"
    )
    with pytest.raises(tb.InputError) as raised:
        tb.run(wrong)
    assert raised.value.problems == wrong.problems


def test_problems_of_a_file_are_those_of_the_command_line(tmp_path):
    book = openpyxl.load_workbook(tb.template("example_modified"))
    sheet = next(s for s in book.worksheets if "Elements" in s.tables)
    row = openpyxl.utils.cell.range_boundaries(sheet.tables["Elements"].ref)[1] + 1
    column = next(c.column for c in sheet[row - 1] if c.value == "Stiffness")
    sheet.cell(row, column).value = "stiff"
    sheet.cell(row + 1, column).value = -1.0
    book.save(path := tmp_path / "wrong.xlsx")
    expected = [p.message for p in read_checked(path).problems]
    assert len(expected) == 2
    wrong = tb.read(path)
    assert [p.message for p in wrong.problems] == expected
    assert tb.read(book).problems == wrong.problems
    # what could not be read stays wrong until it is typed anew
    assert len(wrong.change({"DampingRatio": 0.02}).problems) == 2
    name = wrong.rows("Elements")[0]["element"]
    (left,) = wrong.change({f"Elements[{name}].Stiffness": 1e8}).problems
    assert left.row == 2
    assert (
        wrong.change(
            {"Elements": tb.read(tb.template("example_modified")).rows("Elements")}
        ).problems
        == ()
    )


def test_a_file_that_cannot_be_opened_is_an_input_error(tmp_path):
    (broken := tmp_path / "broken.xlsx").write_bytes(b"no workbook")
    for path in (broken, tmp_path / "missing.xlsx"):
        with pytest.raises(tb.InputError) as raised:
            tb.read(path)
        assert raised.value.problems[0].message == read_checked(path).problems[0].message


def test_a_file_that_is_no_case_stays_wrong_when_it_is_changed(tmp_path):
    (broken := tmp_path / "broken.json").write_text("{")
    messages = [p.message for p in tb.read(broken).change({"DampingRatio": 0.02}).problems]
    assert any("is not JSON" in message for message in messages)


def test_check_says_what_the_command_says(train):
    found = train.check()
    assert found.problems == ()
    assert "rpm" in found.full_speed
    blank = tb.read(tb.template("blank_si")).check()
    assert blank.problems
    assert blank.full_speed == ""


# --- frames ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("example", EXAMPLES)
@pytest.mark.parametrize("units", ["base", "us", "si"])
def test_frames_of_every_table_read_back_as_the_same_case(example, units):
    train = tb.read(tb.template(example))
    frames = {name: train.table(name, units) for name in train.tables}
    again = tb.read({**train.scalars, **frames})
    assert again.problems == ()
    assert set(again.tables) == set(train.tables)
    for name in train.tables:
        for old, new in zip(train.rows(name), again.rows(name), strict=True):
            assert new.keys() == old.keys()
            for key, value in old.items():
                wanted = (
                    value
                    if units == "base" or isinstance(value, str)
                    else pytest.approx(value, rel=1e-14)
                )
                assert new[key] == wanted, (name, key)


def test_units_of_a_frame_are_in_its_attributes(train):
    base, us = train.table("Elements"), train.table("Elements", "us")
    assert base.attrs["units"]["stiffness"] == "N*m/rad"
    assert us.attrs["units"]["stiffness"] == "lbf*in/rad"
    ratio = (base["stiffness"] / us["stiffness"]).dropna()
    assert ratio.to_numpy() == pytest.approx(LBF_IN, rel=1e-12)
    assert math.isnan(base["damping"][0])
    with pytest.raises(ValueError, match="units is 'metric'; it must be base, us or si"):
        train.table("Elements", "metric")
    with pytest.raises(
        LookupError, match="input table 'Elemens' does not exist. Did you mean 'Elements'?"
    ):
        train.table("Elemens")


def test_a_frame_without_units_is_refused(train):
    """Some operations of pandas drop attributes: numbers of unknown unit are not taken for SI."""
    frame = train.table("Elements", "us")
    frame.attrs = {}
    problems = train.change({"Elements": frame}).problems
    assert any("Write frame.attrs['units']['stiffness'] = 'N*m/rad'" in p.message for p in problems)
    assert {p.table for p in problems} == {"Elements"}


def test_frames_of_headers_and_nan_are_read(train):
    frame = pd.DataFrame(
        {"Element": ["A", "B"], "Kind": "shaft", "From": ["1", "2"], "To": ["2", "3"],
         "Stiffness": [2.0, 3.0], "OD": [math.nan, 4.0]}
    )  # fmt: skip
    frame.attrs["units"] = {"Stiffness": "MN*m/rad", "OD": "in"}
    changed = train.change({"elements": frame})
    assert changed.rows("Elements")[0] == {
        "element": "A", "kind": "shaft", "from": "1", "to": "2", "stiffness": 2e6,
    }  # fmt: skip
    assert changed.value("Elements[B].OD") == pytest.approx(4 * 0.0254)


def test_an_unknown_column_and_a_row_that_is_none_are_named(train):
    messages = [p.message for p in train.change({"Elements": [{"Elment": "A"}, 3]}).problems]
    assert any("unknown key 'Elment'. Did you mean 'element'?" in m for m in messages)
    assert any("the row is not an object" in m for m in messages)
    assert any(
        "the table is not a list" in p.message for p in train.change({"Elements": 3}).problems
    )


# --- files ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("example", EXAMPLES)
def test_written_files_hold_the_same_case(tmp_path, example):
    train = tb.read(tb.template(example))
    as_json = tb.read(train.write(tmp_path / "case.json"))
    assert as_json.to_json() == train.to_json()
    assert tb.read(json.loads((tmp_path / "case.json").read_text())).to_json() == train.to_json()
    as_workbook = tb.read(train.write(tmp_path / "train.xlsx"))
    assert as_workbook.to_json() == train.to_json()
    assert as_workbook.problems == ()


def test_a_changed_input_is_written_in_the_units_in_which_it_is_typed(tmp_path, train):
    path = train.change({"Elements[LS coupling].Stiffness": 2e7}).write(
        tmp_path / "train.xlsx", units="us"
    )
    assert tb.read(path).value("Elements[LS coupling].Stiffness") == pytest.approx(2e7, rel=1e-14)
    with pytest.raises(ValueError, match="must end in .xlsx or .json"):
        train.write(tmp_path / "train.csv")


def test_every_input_table_can_be_asked_for(train):
    for spec in EVERY_INPUT:
        assert len(train.table(spec.name)) == len(train.rows(spec.key))
