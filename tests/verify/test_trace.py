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


@pytest.mark.parametrize(
    ("wanted", "said"),
    [
        ("Nothing", "is not a result table. Choose one of Verdicts"),
        ("SteadyState.Colour", "has no column 'Colour'; it has Element"),
        ("Steady state!A1", "is outside the result tables: Verdicts (Summary!"),
        ("Steady state!5", "is not a cell address"),
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
