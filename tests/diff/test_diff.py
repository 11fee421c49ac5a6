"""`torsionbook diff`: what changed between two revisions, matched by name and in any unit."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from pathlib import Path

import openpyxl
import pytest
from typer.testing import CliRunner

from addin.cli.app import app
from addin.diff.compare import compare_files
from addin.diff.inputs import compare_inputs
from addin.diff.units import Units
from addin.reading.case_json import case_to_json, read_case_json
from addin.reading.workbook import read_workbook
from addin.writing.recalculate import recalculate
from addin.xlsx import Workbook, open_workbook
from addin.xlsx.references import cell_name

RUN = CliRunner()


@pytest.fixture(scope="module")
def folder(examples: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The paper's two systems: typed, calculated, as case JSON and as result JSON."""
    folder = Path(shutil.copytree(examples, tmp_path_factory.mktemp("revisions") / "both"))
    for name in ("proposed", "modified"):
        content = case_to_json(read_workbook(folder / f"{name}.in.xlsx").data)
        (folder / f"{name}.json").write_text(json.dumps(content), encoding="utf-8")
    return folder


@pytest.fixture(scope="module")
def data(folder):
    return read_workbook(folder / "proposed.in.xlsx").data


def changed_case(folder: Path, tmp_path: Path, edit: Callable[[dict], None]) -> Path:
    content = json.loads((folder / "proposed.json").read_text(encoding="utf-8"))
    edit(content)
    target = tmp_path / "changed.json"
    target.write_text(json.dumps(content), encoding="utf-8")
    return target


def inputs_between(data, content) -> list[tuple]:
    other = read_case_json(content)
    assert not other.problems
    changes, _, _ = compare_inputs(data, other.data, Units([]))
    return [(c.kind, c.table, c.row, c.column) for c in changes]


# --- inputs ---------------------------------------------------------------------------------------


def test_the_paper_changed_three_couplings(folder):
    """The modification of Szenasi and von Nimitz: three softer couplings, nothing else."""
    found = compare_files(folder / "proposed.xlsx", folder / "modified.xlsx")
    stated = [(c.row, c.column) for c in found.inputs if not c.administrative]
    assert stated == [
        ("LS coupling", "Stiffness"),
        ("HS coupling", "Stiffness"),
        ("Intermediate coupling", "Stiffness"),
    ]
    verdicts = {v.row: (v.before, v.after) for v in found.verdicts if v.table == "Verdicts"}
    # the mesh torque still reverses, and its backlash is not given
    assert verdicts["Overall"] == ("fail", "incomplete")
    assert verdicts["Allowable starts"] == ("fail", "incomplete")
    assert verdicts["Start"] == ("pass", "pass")
    # Figures of the paper: modes at 30, 53, 86 Hz become 21, 39, 69 Hz
    modes = [c for c in found.results if (c.table, c.column) == ("NaturalFrequencies", "Frequency")]
    assert [round(c.before) for c in modes[:3]] == [30, 53, 86]
    assert [round(c.after) for c in modes[:3]] == [21, 39, 69]
    assert modes[0].relative == pytest.approx(-0.3, abs=1e-3)


def test_the_same_quantity_in_another_unit_is_no_change(folder, tmp_path, data):
    def edit(content):
        content["line_frequency"] = "3600 cpm"
        row = next(r for r in content["elements"] if r["element"] == "LS coupling")
        row["stiffness"] = f"{row['stiffness'] / 1e6!r} MN*m/rad"

    changed = changed_case(folder, tmp_path, edit)
    assert inputs_between(data, json.loads(changed.read_text(encoding="utf-8"))) == []
    found = compare_files(folder / "proposed.xlsx", changed)
    assert not found.anything


def test_rows_added_and_removed_are_said(data):
    content = case_to_json(data)
    content["stations"][0]["description"] = "a new description"
    content["motor_torque"].pop(3)
    content["materials"].append({"material": "Alloy 718", "uts": 1.2e9})
    found = inputs_between(data, content)
    assert ("changed", "Stations", "Motor", "Description") in found
    assert [f[0] for f in found if f[1] == "MotorTorque"] == ["row removed"]
    assert ("row added", "Materials", "Alloy 718", "") in found


def test_a_renamed_station_is_no_other_station(data):
    content = case_to_json(data)
    for table, columns in (("stations", ("station",)), ("elements", ("from", "to")),
                           ("load_torque", ("station",))):  # fmt: skip
        for row in content[table]:
            for column in columns:
                if row.get(column) == "HP comp":
                    row[column] = "K-101 HP"
    found = inputs_between(data, content)
    assert found == [("row renamed", "Stations", "K-101 HP", "")]


def test_an_element_in_the_place_of_another_is_the_same_place(data):
    content = case_to_json(data)
    row = next(r for r in content["elements"] if r["element"] == "HS coupling")
    row |= {"element": "HS diaphragm coupling", "stiffness": 0.5 * row["stiffness"]}
    found = inputs_between(data, content)
    assert found == [
        ("row renamed", "Elements", "HS diaphragm coupling", ""),
        ("changed", "Elements", "HS diaphragm coupling", "Stiffness"),
    ]


def test_results_follow_the_new_name(folder, tmp_path):
    def edit(content):
        row = next(r for r in content["elements"] if r["element"] == "HS coupling")
        row["element"] = "HS diaphragm coupling"

    found = compare_files(folder / "proposed.xlsx", changed_case(folder, tmp_path, edit))
    assert [c.kind for c in found.inputs] == ["row renamed"]
    assert [c for c in found.results if c.column not in ("Note", "Why", "Where", "Value")] == []


# --- where results come from ----------------------------------------------------------------------


@pytest.mark.parametrize("kind", ["xlsx", "json", "results.json", "in.xlsx"])
def test_results_are_the_same_from_every_kind_of_file(folder, kind):
    """Rounding of the units a workbook shows is no difference."""
    found = compare_files(folder / "proposed.xlsx", folder / f"proposed.{kind}")
    assert found.results == ()
    assert not [verdict for verdict in found.verdicts if verdict.changed]
    assert found.same_results > 500
    assert (found.inputs is None) == (kind == "results.json")


def test_where_results_come_from_is_said(folder):
    stands = compare_files(folder / "proposed.xlsx", folder / "modified.in.xlsx")
    assert stands.first.results_from.startswith("as recorded in the file")
    assert stands.second.results_from == "calculated now, because the workbook contains no results"


def typed(source: Path, target: Path, edit: Callable[[Workbook], None]) -> Path:
    workbook = open_workbook(source)
    edit(workbook)
    workbook.save(target)
    return target


def test_results_of_other_inputs_are_not_used(folder, tmp_path):
    def soften(workbook):
        table = workbook.table("Elements")
        at = table.ref.left + table.column_index("Stiffness")
        cell = cell_name(table.data.top + 1, at)
        workbook.set_cell(table.sheet, cell, 0.5 * workbook.shown_value(table.sheet, cell))

    changed = typed(folder / "proposed.xlsx", tmp_path / "soft.xlsx", soften)
    found = compare_files(folder / "proposed.xlsx", changed)
    assert "belong to other inputs" in found.second.results_from
    assert [c.row for c in found.inputs] == ["LS coupling"]
    first = next(c for c in found.results if c.column == "Frequency")
    assert first.after < first.before


def test_an_unlimited_shaft_and_settings_of_the_command_line(folder, tmp_path):
    target = tmp_path / "newmark.xlsx"
    recalculate(folder / "proposed.in.xlsx", destination=target, overrides={"method": "newmark"})
    found = compare_files(folder / "proposed.xlsx", target)
    assert [(c.table, c.column, c.before, c.after) for c in found.inputs] == [
        ("Command line", "method", None, "newmark")
    ]
    assert {c.table for c in found.results} >= {"StartupPeaks", "AllowableStarts"}
    assert "NaturalFrequencies" not in {c.table for c in found.results}


# --- shown ----------------------------------------------------------------------------------------


def test_command_workbook_and_json(folder, tmp_path):
    a, b = folder / "proposed.xlsx", folder / "modified.xlsx"
    book, said = tmp_path / "out" / "diff.xlsx", tmp_path / "diff.json"
    done = RUN.invoke(app, ["diff", str(a), str(b), "--xlsx", str(book), "--json", str(said)])
    assert done.exit_code == 0, done.output
    assert "accepted by forced response" in done.output
    assert "-26.4 %" in done.output  # of the second mode, from 53 to 39 Hz in the paper

    content = json.loads(said.read_text(encoding="utf-8"))
    assert content["b"]["revision"].endswith("SAMPLE-MOD, Rev. 0")
    frequencies = [c for c in content["results"] if c["column"] == "Frequency"]
    assert frequencies[0]["a"] == pytest.approx(30.0, rel=1e-4)

    sheets = openpyxl.load_workbook(book)
    assert sheets.sheetnames == ["Diff", "Inputs", "Results"]
    rows = list(sheets["Inputs"].iter_rows(min_row=5, values_only=True))
    assert [r[1] for r in rows if r[2] == "Stiffness"] == [
        "LS coupling", "HS coupling", "Intermediate coupling"
    ]  # fmt: skip
    ls = next(r for r in rows if r[1] == "LS coupling")
    assert ls[3] == "lbf*in/rad"
    assert ls[5] - ls[4] == pytest.approx(ls[6])
    assert (ls[5] - ls[4]) / ls[4] == pytest.approx(ls[7])
    # Rows of the workbook = rows of the JSON
    assert sheets["Results"].max_row - 4 == len(content["results"])


def test_shares_are_shown_as_what_they_stand_for(folder, tmp_path):
    """Torques typed in % of the rated torque, a speed in % of synchronous speed."""

    def edit(content):
        content["motor_torque"].pop(3)
        content["end_speed"] = 0.95 * content["synchronous_speed"]

    found = compare_files(folder / "proposed.xlsx", changed_case(folder, tmp_path, edit))
    end = next(c for c in found.inputs if c.column == "EndSpeed")
    assert (end.unit, end.shown(end.before)) == ("rpm", pytest.approx(0.97 * 1800))
    [gone] = [c for c in found.inputs if c.table == "MotorTorque"]
    row = read_workbook(folder / "proposed.in.xlsx").data.motor_torque[3]
    assert f"Average {row.average:.6g} N*m" in gone.before
    assert gone.row.startswith("Motor, ")
    assert gone.row.endswith(" %")


def test_exit_status(folder, tmp_path):
    a = str(folder / "proposed.xlsx")
    assert RUN.invoke(app, ["diff", a, a, "--strict"]).exit_code == 0
    assert RUN.invoke(app, ["diff", a, str(folder / "modified.xlsx"), "--strict"]).exit_code == 1
    missing = RUN.invoke(app, ["diff", a, str(tmp_path / "none.xlsx")])
    assert (missing.exit_code, "does not exist" in missing.output) == (1, True)
    (tmp_path / "no.json").write_text("{}", encoding="utf-8")
    assert RUN.invoke(app, ["diff", a, str(tmp_path / "no.json")]).exit_code == 1
    assert RUN.invoke(app, ["diff", a, a, "--xlsx", a]).exit_code == 2
    assert RUN.invoke(app, ["diff", a, a, "--xlsx", "diff.csv"]).exit_code == 2


def test_names_that_look_like_formulas_stay_words(folder, tmp_path):
    def edit(content):
        content["title"] = "=HYPERLINK(1)"

    book = tmp_path / "diff.xlsx"
    other = changed_case(folder, tmp_path, edit)
    done = RUN.invoke(app, ["diff", str(folder / "proposed.json"), str(other), "--xlsx", str(book)])
    assert done.exit_code == 0, done.output
    sheet = openpyxl.load_workbook(book)["Inputs"]
    cell = next(c for row in sheet.iter_rows() for c in row if c.value == "=HYPERLINK(1)")
    assert cell.data_type == "s"


@pytest.mark.slow
def test_the_workbook_opens_elsewhere(folder, tmp_path, soffice):
    book = tmp_path / "diff.xlsx"
    a, b = folder / "proposed.xlsx", folder / "modified.xlsx"
    RUN.invoke(app, ["diff", str(a), str(b), "--xlsx", str(book)])
    assert len(soffice.pages(book, dpi=40)) >= 3


@pytest.mark.parametrize(
    ("before", "after", "said"),
    [
        (-38633.0, -15463.0, "+23,170 N*m"),  # less negative: +60 % would read as more
        (-2.0, 3.0, "+5 N*m"),
        (0.0, 3.0, "+3 N*m"),
        (3.0, 0.0, "-3 N*m"),
        (2.0, 3.0, "+50 %"),
    ],
)
def test_per_cent_only_of_what_is_positive(before, after, said):
    from addin.diff.changes import Change
    from addin.diff.wording import change_in_words

    one = Change("changed", "StartupPeaks", "Mesh", "Minimum torque", before, after, "N*m")
    assert change_in_words(one) == said
