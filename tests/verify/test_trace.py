"""`torsionbook verify --trace`: a cell's equation, source, inputs, with places and values."""

from __future__ import annotations

import re
import shutil

import pytest
from cells_of_tables import cell_of
from typer.testing import CliRunner

from addin.cli.app import app
from addin.contract.shipped import template_path
from addin.verify.trace import traced
from addin.xlsx import open_workbook

RUN = CliRunner()
_PLACE = re.compile(r" = (.+?)  \((.+)!([A-Z]+\d+)\)$")


@pytest.mark.parametrize(
    ("table", "row", "column"),
    [
        ("SteadyState", 2, "Torque"),
        ("SeparationMargins", 1, "Margin"),
        ("AllowableStarts", 1, "Damage"),
        ("StartupPeaks", 10, "Peak-to-peak stress"),
        ("ModeShapes", 3, "Mode 2"),
        ("StartCycles", 1, "Cycles to failure"),
        ("TorqueReversals", 1, "Margin"),
        ("NaturalFrequencies", 2, "Percent speed check"),
    ],
)
def test_every_value_told_stands_in_the_cell_told(train, table, row, column):
    workbook = open_workbook(train, read_only=True)
    sheet, cell = cell_of(workbook, table, row, column)
    lines = list(traced(train, f"{sheet}!{cell}"))
    assert lines[0].startswith(f"{sheet}!{cell} = ")
    assert [line.split()[0] for line in lines[1:4]] == ["what", "equation", "source"]
    places = [match.groups() for line in lines if (match := _PLACE.search(line))]
    assert places
    for shown, at_sheet, at_cell in places:
        value = workbook.shown_value(at_sheet, at_cell)
        if isinstance(value, float):
            number = shown.replace(",", "").split(" ")[0]
            assert float(number) == pytest.approx(value, rel=1e-9)
        else:
            assert shown == value


def test_inputs_of_the_row_are_those_of_its_element(train):
    """The shaft that is judged: its own section and material, nobody else's."""
    workbook = open_workbook(train, read_only=True)
    sheet, cell = cell_of(workbook, "StartupPeaks", 10, "Peak-to-peak stress")
    element = workbook.shown_value(*cell_of(workbook, "StartupPeaks", 10, "Element"))
    line = next(x for x in traced(train, f"{sheet}!{cell}") if "Elements.Stress diameter" in x)
    at = _PLACE.search(line).group(3)
    rows = range(1, workbook.table("Elements").data.height + 1)
    row = next(
        r for r in rows if workbook.shown_value(*cell_of(workbook, "Elements", r, "Element")) == element
    )  # fmt: skip
    assert cell_of(workbook, "Elements", row, "Stress diameter")[1] == at


def parts_of(lines):
    """Lines under each heading."""
    parts: dict[str, list[str]] = {}
    for line in lines:
        if line.startswith("  of "):
            parts[line.split(",")[0].strip(" :")] = []
        elif line.startswith("    ") and parts:
            list(parts.values())[-1].append(line.strip())
    return parts


def test_a_cell_names_its_own_element_and_stations_and_says_what_the_whole_train_is(train):
    workbook = open_workbook(train, read_only=True)
    sheet, cell = cell_of(workbook, "StartupPeaks", 1, "Maximum torque")
    parts = parts_of(traced(train, f"{sheet}!{cell}"))
    assert list(parts) == ["of the row", "of the case", "of whole tables"]
    row, whole = parts["of the row"], parts["of whole tables"]
    _, stiffness = cell_of(workbook, "Elements", 1, "Stiffness")
    assert [line for line in row if "Stiffness" in line and f"!{stiffness})" in line]
    assert len([line for line in row if line.startswith("Elements.Stiffness")]) == 1
    ends = {
        workbook.shown_value(*cell_of(workbook, "Elements", 1, column)) for column in ("From", "To")
    }
    named = {
        line.split(" = ")[1].split("  (")[0]
        for line in row
        if line.startswith(("Elements.From", "Elements.To"))
    }
    assert named == ends
    assert len([line for line in row if line.startswith("Stations.Inertia")]) == 2
    assert any(line.startswith("Elements, 10 rows: Kind, From, To, Stiffness") for line in whole)
    assert any(line.startswith("MotorTorque, 14 rows: Speed, Average, Pulsating") for line in whole)
    assert not any(" values " in line for lines in parts.values() for line in lines)


def test_a_verdict_is_traced_to_the_rows_of_its_own_check(train):
    workbook = open_workbook(train, read_only=True)
    checks = workbook.table("Verdicts")
    rows = {
        workbook.shown_value(*cell_of(workbook, "Verdicts", k, "Check")): k
        for k in range(1, checks.data.height + 1)
    }
    sheet, cell = cell_of(workbook, "Verdicts", rows["Separation margin"], "Result")
    row = parts_of(traced(train, f"{sheet}!{cell}"))["of the row"]
    assert {line.split(" = ")[0] for line in row} == {"SeparationMargins.Margin"}
    sheet, cell = cell_of(workbook, "Verdicts", rows["Allowable starts"], "Result")
    row = parts_of(traced(train, f"{sheet}!{cell}"))["of the row"]
    assert {line.split(" = ")[0] for line in row} == {"AllowableStarts.Allowable starts"}


@pytest.mark.parametrize(
    ("wanted", "said"),
    [
        ("Nothing", "is not a result table. Choose one of Verdicts"),
        ("SteadyState.Colour", "has no column 'Colour'; it has Element"),
        ("Results!A1", "is outside the result tables: Verdicts (Summary!"),
        ("Results!5", "is not a cell address"),
    ],
)
def test_what_cannot_be_traced_is_said_with_what_can(train, wanted, said):
    with pytest.raises(ValueError, match=re.escape(said)):
        list(traced(train, wanted))


def test_the_command_and_a_workbook_never_calculated(tmp_path):
    blank = shutil.copyfile(template_path("blank_si.xlsx"), tmp_path / "blank.xlsx")
    done = RUN.invoke(app, ["verify", str(blank), "--trace", "steadystate[torque]"])
    assert done.exit_code == 0, done.output
    assert "Stations.Inertia: blank" in done.output
    assert RUN.invoke(app, ["verify", str(blank), "--trace", "nothing"]).exit_code == 1
    gone = RUN.invoke(app, ["verify", str(tmp_path / "no.xlsx"), "--trace", "SteadyState"])
    assert gone.exit_code == 1
