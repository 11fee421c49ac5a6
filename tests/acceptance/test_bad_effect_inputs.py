"""Wrong inputs of the effects, typed into the shipped example: `check` names each cell in a sentence."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import openpyxl
import pytest
from typed_cells import typed
from typer.testing import CliRunner

from addin.cli.app import app
from addin.contract.shipped import template_path
from addin.reading.case_json import case_to_json, read_case_json

SOURCE = template_path("example_backlash.xlsx")


def checked(path: Path) -> tuple[int, str]:
    done = CliRunner().invoke(app, ["check", str(path)])
    assert done.exception is None or isinstance(done.exception, SystemExit), repr(done.exception)
    return done.exit_code, done.output


@pytest.mark.first_ones(3)
@pytest.mark.parametrize(
    ("changes", "place", "words"),
    [
        ({"Meshes/1/Backlash": -0.01}, "Sheet Train, table Meshes, row 1, Backlash (cell ",
         "found -0.01 in = "),
        ({"Meshes/1/Pitch radius drive": None},
         "Sheet Train, table Meshes, row 1, Pitch radius drive (cell ", "Type the radius"),
        ({"Meshes/1/Mass driven": None}, "Sheet Train, table Meshes, row 1, Mass driven (cell ",
         "type the mass of the gear"),
        ({"Meshes/1/Bearing stiffness drive": None},
         "Sheet Train, table Meshes, row 1, Bearing stiffness drive (cell ",
         "type their stiffness"),
        ({"Meshes/1/Angular backlash": 1}, "Sheet Train, table Meshes, row 1, Angular backlash",
         "geared couplings"),
        ({"Elements/4/Stiffness": None}, "Sheet Train, table Meshes, row 1, Backlash (cell ",
         "table Elements, row 4"),
        ({"FieldSlip": 150}, "Sheet Case, FieldSlip (cell ", "between 0 and 1"),
        ({"FieldSlip": -3}, "Sheet Case, FieldSlip (cell ", "found -3 %"),
        ({"PullOutTorque": None}, "Sheet Case, PullOutTorque (cell ", "FieldSlip is given"),
        ({"ShockTimeConstant": None}, "Sheet Case, ShockTimeConstant (cell ",
         "ShockAmplitude is given"),
        ({"TripSpeed": 120}, "Sheet Case, TripSpeed (cell ", "at most"),
        ({"ContactLaw": "no adhesoin"}, "Sheet Case, ContactLaw (cell ",
         "Did you mean 'no adhesion'?"),
        ({"EffectChoices/7/Choice": "maybe"}, "Sheet Case, table EffectChoices, row 7, Choice",
         "one of auto, on, off"),
        ({"EffectChoices/3/Effect": "gears", "EffectChoices/3/Choice": "on"},
         "Sheet Case, table EffectChoices, row 3, Effect", "one of bearings"),
        ({"EffectChoices/8/Choice": "on"}, "Sheet Case, table EffectChoices, row 8, Choice",
         "TripSpeed"),
    ],
    ids=lambda value: ", ".join(value) if isinstance(value, dict) else "",
)  # fmt: skip
def test_a_wrong_input_has_its_cell_and_its_sentence(
    tmp_path: Path, changes: Mapping[str, Any], place: str, words: str
) -> None:
    status, said = checked(typed(SOURCE, tmp_path / "wrong.xlsx", changes))
    assert status == 1
    line = next((line for line in said.splitlines() if place in line), "")
    assert line, said
    assert words in line


@pytest.mark.first_ones(1)
@pytest.mark.parametrize(
    ("changes", "column", "said", "unsaid"),
    [
        ({"Meshes/1/Mass driven": None}, "Mass driven", "{Meshes/1/Bearing stiffness driven} lbf/in",
         "N/m"),
        ({"TripSpeed": 98, "FieldSlip": None, "PullOutTorque": None, "FieldTimeConstant": None,
          "PullInDamping": None, "FieldAngle": None},
         "TripSpeed", "97 %.", "182."),
        ({"TripSpeed": 120}, "TripSpeed", "synchronous speed (100 %)", "(188."),
        ({"EndSpeed": 104}, "EndSpeed", "synchronous speed (100 %)", "(188."),
        ({"Meshes/1/Pitch radius drive": None}, "Pitch radius drive",
         "Backlash is {Meshes/1/Backlash} in along", " m,"),
    ],
    ids=lambda value: ", ".join(value) if isinstance(value, dict) else "",
)  # fmt: skip
def test_what_is_quoted_beside_a_wrong_cell_is_in_the_units_typed(
    tmp_path: Path, changes: Mapping[str, Any], column: str, said: str, unsaid: str
) -> None:
    """The example is in US customary units: limits and other cells are told in them."""
    _, output = checked(typed(SOURCE, tmp_path / "wrong.xlsx", changes))
    line = next(line for line in output.splitlines() if f", {column} (cell " in line)
    for place in re.findall(r"\{(.*?)\}", said):
        said = said.replace(f"{{{place}}}", f"{cell_value(place):.10g}")
    assert said in line
    assert unsaid not in line


def cell_value(place: str) -> Any:
    """A number of the example as it stands in its cell."""
    table, row, column = place.split("/")
    book = openpyxl.load_workbook(SOURCE)
    sheet = next(ws for ws in book.worksheets if table in ws.tables)
    at = next(c for c in next(iter(sheet[sheet.tables[table].ref])) if c.value == column)
    return sheet.cell(at.row + int(row), at.column).value


def test_names_of_effects_may_be_typed_with_capitals_and_blanks(tmp_path: Path) -> None:
    typed_in = {
        "EffectChoices/1/Effect": " BEARINGS ",
        "EffectChoices/1/Choice": "ON",
        "EffectChoices/4/Effect": "Breaker  Closing",
        "EffectChoices/4/Choice": " Off\u00a0",
    }
    path = typed(SOURCE, tmp_path / "loud.xlsx", typed_in)
    status, said = checked(path)
    assert (status, "no errors" in said) == (0, True), said
    case = tmp_path / "loud.json"
    assert CliRunner().invoke(app, ["export", str(path), str(case)]).exit_code == 0
    content = json.loads(case.read_text(encoding="utf-8"))
    chosen = [
        {"effect": "bearings", "choice": "on"},
        {"effect": "breaker closing", "choice": "off"},
    ]
    assert content["effect_choices"] == chosen
    content["effect_choices"] = [
        {"effect": "Bearings ", "choice": " on"},
        {"effect": "BREAKER CLOSING", "choice": "OFF"},
    ]
    again = read_case_json(content)
    assert again.problems == ()
    assert case_to_json(again.data)["effect_choices"] == chosen


def test_one_unreadable_stiffness_is_one_error(tmp_path: Path) -> None:
    """The clearance beside it needs that stiffness; nothing is said of it as well."""
    status, said = checked(
        typed(SOURCE, tmp_path / "wrong.xlsx", {"Elements/4/Stiffness": "5e7 lbf"})
    )
    assert status == 1
    assert "1 error," in said
    assert "table Elements, row 4, Stiffness" in said


def test_the_example_itself_and_forced_effects_are_in_order(tmp_path: Path) -> None:
    status, said = checked(
        typed(SOURCE, tmp_path / "right.xlsx", {"EffectChoices/7/Choice": "Off"})
    )
    assert (status, "no errors" in said) == (0, True), said
