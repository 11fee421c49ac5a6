"""Case JSON: units in strings, every problem at once, and the way there and back."""

from __future__ import annotations

import copy
import json
import math
from dataclasses import replace

import jsonschema
import openpyxl
import pytest
from hypothesis import given
from hypothesis import strategies as st
from small_workbook import SmallWorkbook
from strategies import example_count
from typer.testing import CliRunner

from addin.cli.app import app
from addin.contract.shipped import template_path
from addin.contract.tables import INPUT_TABLES, SCALARS, STUDY_INPUT_TABLES, Field
from addin.reading.case_json import case_to_json, read_case_json
from addin.reading.workbook import read_workbook
from addin.reference.json_schemas import case_schema
from engine.case.case import Case
from engine.case.data import TABLES, CaseData, case_digest
from engine.case.study_inputs import study_digest

CASE = {
    "format": 1,
    "line_frequency": 60,
    "synchronous_speed": "1800 rpm",
    "rated_torque": "1000 lbf*ft",
    "damping_ratio": "1.5 %",
    "stations": [
        {"station": "Motor", "inertia": "10900 lb*ft^2"},
        {"station": "Load", "inertia": 20.5, "speed_ratio": 1},
    ],
    "elements": [
        {
            "element": "Coupling",
            "kind": "coupling",
            "from": "Motor",
            "to": "Load",
            "stiffness": "1e6 lbf*in/rad",
        }
    ],
    "motor_torque": [
        {"station": "Motor", "speed": 0, "average": "0.55 pu", "pulsating": "16 %"},
        {"station": "Motor", "speed": 1, "average": 0, "pulsating": 100.0},
    ],
    "load_torque": [
        {"station": "Load", "speed": "0 rpm", "torque": "60 lbf*ft"},
        {"station": "Load", "speed": "1800 rpm", "torque": "250 lbf*ft"},
    ],
    "materials": [{"material": "steel", "uts": "110 ksi", "yield": 5.5e8}],
    "excitations": [{"name": "line", "frequency": "3600 cpm", "torque": "1 %"}],
}


@pytest.fixture
def case() -> dict:
    return copy.deepcopy(CASE)


def test_numbers_are_si_and_strings_carry_units(case):
    found = read_case_json(case)
    assert found.problems == ()
    data = found.case()
    assert isinstance(data, Case)
    assert data.synchronous_speed == pytest.approx(60.0 * math.pi, rel=1e-14)
    assert data.damping_ratio == 0.015
    assert data.stations[0].inertia == pytest.approx(10900 * 0.04214011009380479)
    assert data.stations[1].inertia == 20.5
    assert data.elements[0].from_ == "Motor"
    assert data.motor_torque[0].average == pytest.approx(0.55 * 1355.8179483314)
    assert data.motor_torque[0].pulsating == pytest.approx(0.16 * 1355.8179483314)
    assert data.motor_torque[1].speed == 1.0
    assert data.load_torque[1].speed == pytest.approx(1.0, rel=1e-14)
    assert data.materials[0].yield_ == 5.5e8
    assert data.excitations[0].frequency == 60.0
    assert data.excitations[0].torque is None
    assert data.excitations[0].torque_share == 0.01


def test_from_a_file(case, tmp_path):
    path = tmp_path / "case.json"
    path.write_text(json.dumps(case), encoding="utf-8")
    assert read_case_json(path).data == read_case_json(str(path)).data == read_case_json(case).data


def test_null_is_blank(case):
    case["voltage"] = None
    case["stations"][0]["damping"] = None
    assert read_case_json(case).data == read_case_json(CASE).data


def wrong(case, *path_and_value):
    """The messages after putting a value into a copy of the case."""
    *path, key, value = path_and_value
    inner = case
    for step in path:
        inner = inner[step]
    inner[key] = value
    return [problem.message for problem in read_case_json(case).problems]


@pytest.mark.parametrize(
    ("change", "place", "sentence"),
    [
        (("linefrequency", 60), "linefrequency (key linefrequency)", "Did you mean 'line_frequency'?"),
        (("stations", 0, "inertai", 1), "row 1, inertai (key stations[0].inertai)", "Did you mean 'inertia'?"),
        (("format", 2), "format", 'this version reads "format": 1'),
        (("line_frequency", "60"), "LineFrequency (key line_frequency)", "the value has no unit"),
        (("line_frequency", "60 rpmm"), "LineFrequency", "the unit 'rpmm' is not known"),
        (("line_frequency", "60 kg"), "LineFrequency", "'kg' is not a unit of frequency"),
        (("line_frequency", "0,5 Hz"), "LineFrequency", "Use a decimal point"),
        (("line_frequency", "fast"), "LineFrequency", "a number in Hz without quotes"),
        (("line_frequency", True), "LineFrequency", "type a number"),
        (("line_frequency", [60]), "LineFrequency", "type a number"),
        (("line_frequency", math.nan), "LineFrequency", "type a finite number"),
        (("line_frequency", 1e300), "LineFrequency", "which is out of range for a train"),
        (("line_frequency", 10**400), "LineFrequency", "type a finite number"),
        (("line_frequency", "1e999 Hz"), "LineFrequency", "type a finite number"),
        (("starts_required", "5000"), "StartsRequired", "must be a plain number"),
        (("poles", 3.5), "Poles", "must be a whole number"),
        (("title", 5), "Title", "type a text in quotes"),
        (("method", "newmrk"), "Method", "Did you mean 'newmark'?"),
        (("stations", "Motor"), "table Stations (key stations)", "the table is not a list"),
        (("motor_torque", 1, "speed", 50), "row 2, Speed (key motor_torque[1].speed)", "Write 50 % or 900 rpm"),
        (("elements", 0, "stiffness", "-5 N*m/rad"), "Stiffness (key elements[0].stiffness)", "found -5 N"),
    ],
)  # fmt: skip
def test_a_wrong_value_has_its_sentence(case, change, place, sentence):
    messages = wrong(case, *change)
    assert any(place in m and sentence in m for m in messages), messages


def test_all_problems_at_once(case):
    case["line_frequency"] = "60"
    case["stations"][1]["inertia"] = "x"
    case["elements"][0]["to"] = "Laod"
    case["extra"] = 1
    assert len(read_case_json(case).problems) == 4


def test_a_row_that_is_no_object(case):
    case["stations"].append("Third")
    (problem,) = read_case_json(case).problems
    assert problem.message.startswith("Sheet Train, table Stations, row 3 (key stations[2]): ")


def test_a_case_that_is_no_object():
    (problem,) = read_case_json([1, 2]).problems
    assert "Put the case in braces" in problem.message


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ('{"format": 1,', "is not JSON: "),
        ("", "line 1, column 1"),
        ("[" * 100_000, "too many nested levels"),
        ('{"format": 1, "line_frequency": 50, "line_frequency": 60}', "occurs twice in one object"),
    ],
)
def test_files_that_are_no_case(tmp_path, text, sentence):
    path = tmp_path / "case.json"
    path.write_text(text, encoding="utf-8")
    assert any(sentence in p.message for p in read_case_json(path).problems)


def test_a_file_that_is_not_text(tmp_path):
    path = tmp_path / "case.json"
    path.write_bytes(b"\xff\xfe\x00\x01")
    assert "not UTF-8" in read_case_json(path).problems[0].message


# --- there and back -------------------------------------------------------------------------------


def test_export_is_plain_json(case):
    content = case_to_json(read_case_json(case).data)
    assert json.loads(json.dumps(content, allow_nan=False)) == content
    assert content["format"] == 1
    assert content["excitations"][0]["torque"] == "1 %"
    assert "voltage" not in content
    assert "meshes" not in content
    assert read_case_json(content).data == read_case_json(case).data


def test_workbook_to_json_and_back(tmp_path):
    data = read_workbook(SmallWorkbook().save(tmp_path / "small.xlsx")).data
    back = read_case_json(json.loads(json.dumps(case_to_json(data))))
    assert back.problems == ()
    assert back.data == data


def test_study_tables_go_to_json_and_back():
    read = read_workbook(template_path("example_studies.xlsx"))
    content = json.loads(json.dumps(case_to_json(read.data, read.studies)))
    assert {spec.key for spec in STUDY_INPUT_TABLES} <= set(content)
    assert content["tuning"][0]["unit"] == "%"
    back = read_case_json(content)
    assert back.problems == ()
    assert back.studies.problems == ()
    assert back.data == read.data
    assert back.studies.inputs == read.studies.inputs
    assert study_digest(*back.studies.inputs.tuning) == study_digest(*read.studies.inputs.tuning)
    jsonschema.validate(content, case_schema())
    assert "tuning" not in case_to_json(read.data)


def test_the_export_of_a_wrong_study_cell_names_it_and_writes_nothing(tmp_path):
    book = openpyxl.load_workbook(template_path("example_studies.xlsx"))
    sheet = next(sheet for sheet in book if "Tuning" in sheet.tables)
    first = sheet.tables["Tuning"].ref.split(":")[0]
    header = sheet[first].row
    [at] = [cell for cell in sheet[header] if cell.value == "Values"]
    sheet.cell(header + 1, at.column).value = "0.5; much"
    book.save(tmp_path / "train.xlsx")
    done = CliRunner().invoke(
        app, ["export", str(tmp_path / "train.xlsx"), str(tmp_path / "case.json")]
    )
    assert done.exit_code == 1
    assert "'much' is not a number" in done.output
    assert not (tmp_path / "case.json").exists()


def values(spec: Field) -> st.SearchStrategy:
    """What a field of `CaseData` may hold, blank included."""
    text = st.text(min_size=1, max_size=8).map(str.strip).filter(bool)
    text = text.filter(lambda word: "\u00a0" not in word and word.casefold() != "ground")
    kinds = {
        "number": st.just(0.0) | st.floats(1e-30, 1e30) | st.floats(-1e30, -1e-30),
        "integer": st.integers(-(10**9), 10**9),
        "choice": st.sampled_from(spec.choices or ("",)),
    }
    return st.none() | kinds.get(spec.kind, text)


def rows(table) -> st.SearchStrategy:
    _, row_class = TABLES[table.name]
    row = st.builds(row_class, **{c.attribute: values(c) for c in table.columns})
    if table.name == "Excitations":
        row = row.flatmap(
            lambda r: (
                st.none().map(lambda _: r)
                if r.torque is not None
                else (st.none() | st.integers(1, 10**6)).map(
                    lambda n: replace(r, torque_share=None if n is None else n / 1e4)
                )
            )
        )
    return st.lists(row, max_size=2).map(tuple)


CASES = st.builds(
    CaseData,
    **{spec.attribute: values(spec) for spec in SCALARS},
    **{TABLES[table.name][0]: rows(table) for table in INPUT_TABLES},
)


@pytest.mark.slow
@example_count(60)
@given(CASES)
def test_any_case_survives_the_way_through_json(data):
    content = json.loads(json.dumps(case_to_json(data)))
    back = read_case_json(content).data
    shares = [[x.torque_share or 0.0 for x in one.excitations] for one in (back, data)]
    assert shares[0] == pytest.approx(shares[1], rel=1e-15)  # written in percent
    assert without_shares(back) == without_shares(data)
    assert case_digest(back) == case_digest(data)


def without_shares(data: CaseData) -> CaseData:
    return replace(data, excitations=tuple(replace(x, torque_share=None) for x in data.excitations))


def test_names_compare_without_capitals_and_outer_blanks():
    """A reference gets the spelling of the row that defines the name, unless two rows differ by capitals alone."""

    def read(**names):
        table = {"from": "Motor", "to": "Fan"} | names
        return read_case_json(
            {
                "format": 1,
                "stations": [
                    {"station": "Motor", "inertia": 1.0},
                    {"station": "Fan", "inertia": 2.0},
                ],
                "elements": [{"element": "Shaft", "kind": "shaft", "stiffness": 1e5, **table}],
            }
        )

    plain, other = read(), read(**{"from": " MOTOR ", "to": "fan"})
    assert other.problems == ()
    assert case_digest(other.case()) == case_digest(plain.case())
    twins = read_case_json(
        {
            "format": 1,
            "stations": [{"station": name, "inertia": 1.0} for name in ("motor", "Motor", "fan")],
            "elements": [
                {"element": "a", "kind": "shaft", "from": "motor", "to": "Motor", "stiffness": 1e5},
                {"element": "b", "kind": "shaft", "from": "MOTOR", "to": "fan", "stiffness": 1e5},
            ],
        }
    )
    assert [(p.table, p.row, p.column) for p in twins.problems if p.column == "From"] == [
        ("Elements", 2, "From")
    ]


def test_words_that_a_field_of_numbers_takes_are_named_and_hyphens_are_blanks():
    content = {"format": 1, "fatigue_factors": [{"element": "Shaft", "surface": "rolled"}]}
    (problem,) = (p for p in read_case_json(content).problems if p.column == "Surface")
    assert problem.message.endswith(
        "found 'rolled'; a number without quotes, or ground or machined or hot-rolled or as-forged, is needed."
    )
    content["fatigue_factors"][0]["surface"] = "Hot rolled"
    assert read_case_json(content).data.fatigue_factors[0].surface == "hot-rolled"
