"""Ranges that would lose something typed are refused; nothing is passed over without a word."""

import pytest
from sheet_ranges import model_arguments

from addin.worksheet.registry import FunctionError, call

STATIONS, CASE = 0, 2


def arguments(place, change):
    given = model_arguments()
    given[place] = change([list(row) for row in given[place]])
    return given


def told(place, change):
    with pytest.raises(FunctionError) as wrong:
        call("TV_MODEL", arguments(place, change))
    return wrong.value.message


def renamed(old, new):
    def change(block):
        for row in block:
            for j, cell in enumerate(row):
                if cell == old:
                    row[j] = new
        return block

    return change


def test_a_case_range_without_its_values():
    """From the names of the right half on, its values are cut off."""
    given = model_arguments()[CASE]
    at = next(j for row in given for j, cell in enumerate(row) if cell == "Maximum time")
    assert "Select its value" in told(CASE, lambda block: [row[: at + 1] for row in block])


def test_a_case_range_that_begins_with_values():
    """The names of the left half are cut off; those of the right are all there."""
    assert "Start the range with the column of names" in told(
        CASE, lambda block: [row[1:] for row in block]
    )


def test_a_misspelt_name():
    message = told(CASE, renamed("Damping ratio", "Dampng ratio"))
    assert "'Dampng ratio' is unknown. Did you mean 'DampingRatio'?" in message


def test_what_is_typed_with_the_sign_and_under_the_unit_of_per_cent_is_a_hundredth():
    """As docs/functions.md warns: no front hands formats to a function."""

    def damping(factor, unit):
        def change(block):
            row = next(row for row in block if "Damping ratio" in row)
            at = row.index("Damping ratio")
            value = next(j for j in range(at + 1, len(row)) if isinstance(row[j], int | float))
            assert row[value + 1] == "%"
            row[value : value + 2] = [row[value] * factor, unit]
            return block

        model = call("TV_MODEL", arguments(CASE, change))
        table = call("TV_FREQUENCIES", [model])
        at = next(j for j, header in enumerate(table[0]) if header.startswith("Damping ratio"))
        return table[2][at]

    typed = damping(1.0, "%")
    assert typed > 0.0
    assert damping(0.01, "%") == pytest.approx(typed / 100, rel=1e-12)
    assert damping(0.01, "1") == pytest.approx(typed, rel=1e-12)


def test_a_name_twice():
    def change(block):
        row = next(row for row in block if "Damping ratio" in row)
        return [*block, list(row)]

    assert "'Damping ratio' occurs twice" in told(CASE, change)


@pytest.mark.parametrize(("header", "said"), [(None, "no header"), (5.0, "the header 5")])
def test_values_under_no_header(header, said):
    def change(block):
        j = block[1].index("Damping")
        block[2][j] = 10.0
        block[1][j] = header
        return block

    message = told(STATIONS, change)
    assert said in message
    assert "column " in message


def test_headings_choices_and_notes_on_sheet_case_are_no_names():
    """The whole sheet with its headings, the table of effects and a note of one's own."""
    before = call("TV_MODEL", model_arguments())
    noted = arguments(CASE, lambda block: [*block, ["my own factor", 1.25] + [None] * 9])
    assert call("TV_MODEL", noted) == before


@pytest.mark.parametrize(
    ("function", "given"),
    [
        ("TV_CONVERT", [1e308, "km", "mm"]),
        ("TV_STIFFNESS", [1e100, 0.0, 1e100, 1e300]),
        ("TV_STIFFNESS", [1e-100, 0.0, 1e-100, 1.0]),
        ("TV_STIFFNESS", [1e-160, 0.0, 1e-320, 1e-20]),
    ],
)
def test_answers_that_no_number_can_hold(function, given):
    with pytest.raises(FunctionError) as wrong:
        call(function, given)
    assert wrong.value.code == "#NUM!"
    assert "number" in wrong.value.message
