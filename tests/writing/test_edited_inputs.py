"""Inputs typed anew: the file says them as if they had been typed there, and nothing else of it changes."""

import json

import pytest
from sheet_ranges import TEMPLATES

from addin.reading.case_json import case_to_json, read_case_json
from addin.reading.workbook import read_workbook
from addin.writing.edited_inputs import WrongEdit, edit_inputs, typed_inputs

EXAMPLE = TEMPLATES / "example_proposed.xlsx"
CHANGES = {
    "DampingRatio": 2.5,
    "Elements[LS coupling].Stiffness": 2.5e8,
    "Title": "Softer",
    "StartsRequired": None,
}


def shown(content, name):
    return next(one for one in content["scalars"] if one["name"] == name)


def test_a_workbook_says_what_was_typed_in_the_units_of_its_cells_and_the_rest_as_before(tmp_path):
    read = read_workbook(EXAMPLE)
    edit_inputs(read, EXAMPLE, CHANGES, tmp_path / "now.xlsx")
    before, now = read_workbook(EXAMPLE), read_workbook(tmp_path / "now.xlsx")
    assert not now.problems
    assert now.data.damping_ratio == pytest.approx(0.025)
    place = ("Elements", 2, "Stiffness")
    assert (now.typed.entry(place).number, now.typed.entry(place).unit) == (2.5e8, "lbf*in/rad")
    # all that differs as the engine takes it
    old, new = case_to_json(before.data), case_to_json(now.data)
    assert new["elements"][1].pop("stiffness") < old["elements"][1].pop("stiffness")
    assert new.pop("title") == "Softer"
    assert "starts_required" not in new
    for key in ("title", "starts_required"):
        del old[key]
    assert new.pop("damping_ratio") != old.pop("damping_ratio")
    assert new == old


def test_a_blank_has_the_unit_that_is_stated_beside_its_cell():
    content = typed_inputs(read_workbook(EXAMPLE))
    blank = shown(content, "MarginRequired")
    assert (blank["value"], blank["unit"]) == (None, "%")
    assert shown(typed_inputs(read_case_json({"format": 1})), "MarginRequired")["unit"] == "1"


def test_a_case_keeps_the_unit_in_which_it_was_typed(tmp_path):
    case = case_to_json(read_workbook(EXAMPLE).data) | {"line_frequency": 60}
    case["elements"][1]["stiffness"] = "309e6 lbf*in/rad"
    source, target = tmp_path / "case.json", tmp_path / "now.json"
    source.write_text(json.dumps(case))
    edit_inputs(read_case_json(case), source, CHANGES, target)
    now = json.loads(target.read_text())
    assert now["elements"][1]["stiffness"] == "250000000.0 lbf*in/rad"
    assert (now["damping_ratio"], now["title"]) == (2.5, "Softer")
    assert "starts_required" not in now
    assert read_case_json(now).typed.entry(("Elements", 2, "Stiffness")).number == 2.5e8


ROWS = {
    "Materials[+]": {"Material": "Second steel", "UTS": 100_000},
    "LoadTorque[28]": None,
    "EffectChoices[+]": {"Effect": "backlash", "Choice": "off"},
}


def test_rows_come_and_go_in_a_workbook_and_the_rest_is_as_before(tmp_path):
    before, target = read_workbook(EXAMPLE), tmp_path / "now.xlsx"
    edit_inputs(read_workbook(EXAMPLE), EXAMPLE, ROWS, target)
    now = read_workbook(target)
    old, new = case_to_json(before.data), case_to_json(now.data)
    assert new.pop("load_torque") == old.pop("load_torque")[:-1]
    assert new.pop("effect_choices") == [{"effect": "backlash", "choice": "off"}]
    first, second = new.pop("materials")
    assert [first] == old.pop("materials")
    assert second == {"material": "Second steel", "uts": pytest.approx(100_000 * 6894.757293168)}
    assert new == old
    # the effect was named in the workbook: no row of the table was added for it
    assert now.locations.tables["EffectChoices"].ref == before.locations.tables["EffectChoices"].ref
    # what is removed comes back where it was
    again = {"LoadTorque[+]": {"Station": "HP compressor", "Speed": 100, "Torque": 0.1}}
    edit_inputs(now, target, again, tmp_path / "again.xlsx")
    rows = read_workbook(tmp_path / "again.xlsx").locations.rows["LoadTorque"]
    assert rows == before.locations.rows["LoadTorque"]


def test_a_full_table_grows_or_says_what_is_in_the_way(tmp_path):
    read = read_workbook(EXAMPLE)
    before = read.locations.tables["Meshes"].ref
    blank = read.locations.tables["Meshes"].data.height - len(read.typed.tables["Meshes"])
    names = [f"M{number}" for number in range(blank + 1)]
    new = {"Meshes[+]": [{"Element": name} for name in names]}
    edit_inputs(read, EXAMPLE, new, tmp_path / "now.xlsx")
    now = read_workbook(tmp_path / "now.xlsx")
    assert [row["Element"] for row in now.typed.tables["Meshes"]][1:] == names
    assert now.locations.tables["Meshes"].ref == before._replace(bottom=before.bottom + 1)
    now.workbook.set_cell("Train", f"C{before.bottom + 2}", "mine")
    target = tmp_path / "again.xlsx"
    with pytest.raises(
        WrongEdit, match=r"Meshes is full. Train!C\d+: the text 'mine' is in the way"
    ):
        edit_inputs(now, EXAMPLE, new, target)
    assert not target.exists()


def test_rows_come_and_go_in_a_case(tmp_path):
    case = case_to_json(read_workbook(EXAMPLE).data)
    source, target = tmp_path / "case.json", tmp_path / "now.json"
    source.write_text(json.dumps(case))
    changes = ROWS | {"LoadTorque[1]": None, "Scatter[+]": {"Quantity": "stiffness", "Spread": 0.1}}
    edit_inputs(read_case_json(case), source, changes, target)
    now = json.loads(target.read_text())
    assert now.pop("load_torque") == case.pop("load_torque")[1:-1]
    assert now.pop("materials") == [
        *case.pop("materials"),
        {"material": "Second steel", "uts": 100_000},
    ]
    assert now.pop("scatter") == [{"quantity": "stiffness", "spread": 0.1}]
    assert now.pop("effect_choices") == [{"effect": "backlash", "choice": "off"}]
    assert now == case


@pytest.mark.parametrize(
    ("name", "value", "words"),
    [
        ("Elements[+]", {"Stiffnes": 1}, "Stiffness"),
        ("Elements[+]", {"Stiffness": "much"}, "type a number"),
        ("Elements[+]", {}, "needs a value"),
        ("Elements[LS coupling]", 3, "removed with null"),
        ("Elements[LS copling]", None, "LS coupling"),
        ("Tuning[+]", {"Element": "LS coupling"}, "no table Tuning"),
        ("Elements[LS copling].Stiffness", 1, "LS coupling"),
        ("DampingRatio", "little", "type a number"),
        ("DampingRatio", True, "type a number"),
        ("Title", 3, "type a text"),
    ],
)
def test_what_cannot_stand_there_is_refused_and_nothing_is_written(tmp_path, name, value, words):
    target = tmp_path / "now.xlsx"
    with pytest.raises(WrongEdit, match=words):
        edit_inputs(read_workbook(EXAMPLE), EXAMPLE, {name: value}, target)
    assert not target.exists()
