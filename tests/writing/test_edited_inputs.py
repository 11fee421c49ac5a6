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


@pytest.mark.parametrize(
    ("name", "value", "words"),
    [
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
