"""The copy of the inputs, which the banners compare with: edited, it is found."""

from __future__ import annotations

import pytest
from cells_of_tables import cell_of, unit_cell_of

from addin.verify.file import verify_file
from addin.xlsx import Formula

SHEET = "Inputs calculated"


def row_of(workbook, name):
    table = workbook.table("InputChecks")
    part = workbook.sheet_part(SHEET)
    rows = range(table.data.top, table.data.bottom + 1)
    return next(k for k, row in enumerate(rows, 1) if part.constant(row, 1) == name)


def write(table, row, column, value):
    def edit(workbook):
        at = row if isinstance(row, int) else row_of(workbook, row)
        place = cell_of(workbook, table, at, column)
        assert workbook.value(*place) != value
        workbook.set_cell(*place, value, replace_formula=True)

    return edit


@pytest.mark.first_ones(2)
@pytest.mark.parametrize(
    ("edit", "says"),
    [
        (write("CalculatedStations", 1, "Inertia", 700.0), "calculated with 1011.36"),
        (write("CalculatedStations", 15, "Damping", 1.0), "calculated with nothing"),
        (write("CalculatedElements", 2, "Kind", "gear mesh"), "has gear mesh"),
        (write("CalculatedMotorTorque", 3, "Full speed", 1.0), "calculated with 188"),
        (write("InputChecks", "SynchronousSpeed", "Value", 100.0), "calculated with 188"),
        (write("InputChecks", "Stations[Inertia]", "Factor", 1.0), "has 1"),
        (write("InputUnits", 3, "Factor", 7.0), "has 7"),
        (write("InputChecks", "Stations[Inertia]", "Changed", 0.0), "in place of a live formula"),
        (write("InputChecks", "Stations[Inertia]", "Changed", Formula("0*1")), "refers to no cell"),
        (write("InputChecks", "Stations[Inertia]", "Changed", Formula("0*ROWS(Stations[Inertia])")),
         "after an edit"),
        (lambda book: book.write_table(
            "CalculatedMeshes", [[None] * len(book.table("CalculatedMeshes").columns)]
        ), "1 rows instead of 2"),
        (lambda book: book.set_cell(SHEET, "C2", False, replace_formula=True), "any input changed"),
    ],
)  # fmt: skip
def test_an_edited_copy_is_named_with_its_cell(edited, edit, says):
    found = verify_file(edited(edit))
    assert found.same_inputs
    assert not found.passes
    assert any(f.sheet == SHEET and says in f.sentence for f in found.findings if f.fails), [
        f.sentence for f in found.findings
    ]


@pytest.mark.slow
def test_a_unit_exchanged_after_the_calculation_leaves_the_copy_as_it_is(edited):
    def edit(workbook):
        unit = unit_cell_of(workbook, "MotorTorque", "Speed")
        workbook.set_cell(*unit, "rpm")
        table = workbook.table("MotorTorque")
        for row in range(1, table.data.height + 1):
            place = cell_of(workbook, "MotorTorque", row, "Speed")
            shown = workbook.shown_value(*place)
            if isinstance(shown, float):
                workbook.set_cell(*place, 18.0 * shown)

    found = verify_file(edited(edit))
    assert found.same_inputs
    assert not [f for f in found.findings if f.sheet in (SHEET, "Summary")]


@pytest.mark.slow
def test_of_changed_inputs_the_copy_is_not_judged(edited):
    def edit(workbook):
        workbook.set_cell(*cell_of(workbook, "Stations", 1, "Inertia"), 12345.0)

    found = verify_file(edited(edit))
    assert not found.same_inputs
    assert not [f for f in found.findings if "copy of the inputs" in f.sentence]
