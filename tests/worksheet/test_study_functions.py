"""Tuning, tolerances and sensitivities in cells: the commands' own numbers, within a time."""

from __future__ import annotations

import json

import openpyxl
import pytest
from sheet_ranges import CATALOGUE, SCATTER, TEMPLATES, TUNING, model_arguments, table, workbook
from typer.testing import CliRunner

from addin.cli.app import app
from addin.contract.tables import json_key
from addin.worksheet.functions import studies
from addin.worksheet.registry import FunctionError, call


@pytest.fixture(scope="module")
def handle():
    return call("TV_MODEL", model_arguments())[0][0]


def refused(name, *raw):
    with pytest.raises(FunctionError) as told:
        call(name, list(raw))
    return told.value


def by_header(rows):
    head, *lines = rows
    return [dict(zip([h.split(" [")[0] for h in head], line, strict=True)) for line in lines]


def command(tmp_path, name, *more):
    """Rows that the command writes for the shipped example with study sheets. [SI]"""
    told = tmp_path / "told.json"
    source = TEMPLATES / "example_studies.xlsx"
    done = CliRunner().invoke(
        app, [name, str(source), "--out", str(tmp_path), "--json", str(told), "--jobs", "1", *more]
    )
    assert done.exit_code == 0, done.output
    return json.loads(told.read_text(encoding="utf-8"))


def assert_same(cells, rows, factors, within=1e-14):
    """Rows of a formula are those of the command, column for column."""
    assert len(cells) == len(rows)
    for mine, theirs in zip(cells, rows, strict=True):
        for name, value in mine.items():
            there = theirs.get(json_key(name))
            if isinstance(value, float) and isinstance(there, (int, float)):
                assert value * factors.get(name, 1.0) == pytest.approx(there, rel=within), name
            else:
                assert (value or None) == ("yes" if there is True else there or None), name


_ENDS = ("", " low", " high")
PER_CENT = dict.fromkeys(
    ("Nominal", "Required", *(f"{one}{end}" for one in ("P10", "P50", "P90", "Probability") for end in _ENDS)),
    0.01,
)  # fmt: skip


@pytest.fixture(autouse=True)
def as_long_as_it_takes(monkeypatch):
    """The machine may be busy: what is tested is the answer, and the limit where it is set."""
    monkeypatch.setattr(studies, "TIME_LIMIT", 600.0)


@pytest.mark.slow
def test_tuning_is_the_command(handle, tmp_path):
    studies_book = workbook("example_studies")
    given = [table(studies_book, "Tuning"), table(studies_book, "Catalogue")]
    cells = by_header(call("TV_TUNE", [handle, *given, "SI"]))
    assert len(cells) == 97
    rows = command(tmp_path, "tune")["tuning_results"]
    assert_same(cells, rows, {"Worst margin": 0.01, "Peak-to-peak stress": 1e6})


@pytest.mark.slow
def test_tolerances_are_the_command(handle, tmp_path):
    scatter = table(workbook("example_studies"), "Scatter")
    told = command(tmp_path, "tolerances", "--samples", "60", "--seed", "5")
    starts = by_header(call("TV_TOLERANCES", [handle, scatter, None, 60.0, 5.0]))
    shares = ("Unlimited", "Probability", "Probability low", "Probability high")
    # numbers that may be words are shown with four digits, as on the sheet
    assert_same(starts, told["starts_of_sample"], dict.fromkeys(shares, 0.01), within=5e-4)
    margins = by_header(call("TV_TOLERANCES", [handle, scatter, "Margins", 60.0, 5.0]))
    assert_same(margins, told["tolerance_margins"], PER_CENT)
    frequencies = by_header(call("TV_TOLERANCES", [handle, scatter, "frequencies", 60.0, 5.0]))
    assert_same(frequencies, told["tolerance_frequencies"], {})


def test_sensitivities_of_frequencies_are_half_the_energies(handle):
    head, *lines = call("TV_SENSITIVITIES", [handle])
    energies = {(row[1], row[0]): row[2:] for row in call("TV_ENERGY", [handle, None, False])}
    for quantity, name, *values in lines:
        kind, sign = ("strain", 0.5) if quantity == "stiffness" else ("kinetic", -0.5)
        for value, share in zip(values, energies[kind, name], strict=False):
            assert value == pytest.approx(sign * share, abs=1e-12), (quantity, name)
    assert head[:3] == ["Quantity", "Of", "Mode 1"]
    assert len(head) == 2 + 10
    assert all(value is not None for line in lines for value in line), "no blank columns"


@pytest.mark.long
def test_sensitivities_of_the_start_are_the_command(handle, tmp_path):
    told = command(tmp_path, "sensitivities")
    cells = by_header(call("TV_SENSITIVITIES", [handle, "start"]))
    changes = [
        f"{a} {b}" for a in ("Peak", "Starts") for b in ("change", "error", "below", "above")
    ]
    assert_same(cells, told["sensitivities"], dict.fromkeys(changes, 0.01))


def test_what_is_too_much_for_a_cell_says_which_command_does_it(handle, monkeypatch):
    many = [TUNING[0], ["HS coupling", "stiffness", "%", "; ".join(map(str, range(50, 200)))]]
    told = refused("TV_TUNE", handle, many).message
    assert "150 combinations" in told
    assert "torsionbook tune FILE" in told
    told = refused("TV_TOLERANCES", handle, SCATTER, None, 5000.0).message
    assert "torsionbook tolerances FILE --samples 5000" in told
    monkeypatch.setattr(studies, "TIME_LIMIT", 0.0)
    late = refused("TV_TUNE", handle, [TUNING[0], ["HS coupling", "stiffness", "%", "41; 42; 43"]])
    assert "the time limit of a cell" in late.message
    assert "torsionbook tune FILE" in late.message
    monkeypatch.setattr(studies, "TIME_LIMIT", 600.0)
    assert len(call("TV_TUNE", [handle, TUNING])) == 4  # header, two values, as is


def test_wrong_rows_are_told_with_table_row_and_column(handle):
    assert "the tables Tuning and Catalogue are empty" in refused("TV_TUNE", handle, None).message
    wrong = [TUNING[0], ["HS couplin", "stiffness", "%", "33"]]
    assert "Tuning, row 1, Element" in refused("TV_TUNE", handle, wrong).message
    unreadable = [TUNING[0], ["HS coupling", "stiffness", "florps", "33"]]
    assert "Tuning, row 1, Unit" in refused("TV_TUNE", handle, unreadable).message
    assert "contains table Catalogue" in refused("TV_TUNE", handle, CATALOGUE).message
    no_unit = [SCATTER[1], SCATTER[2]]
    assert (
        "the unit above the header is missing" in refused("TV_TOLERANCES", handle, no_unit).message
    )
    wide = [*SCATTER[:2], ["stiffness", "normal", 30.0]]
    assert "Scatter, row 1, Spread" in refused("TV_TOLERANCES", handle, wide).message
    assert "30" in refused("TV_TOLERANCES", handle, SCATTER, None, 5.0).message
    seed = refused("TV_TOLERANCES", handle, SCATTER, None, 60.0, -1.0).message
    assert "Seed" in seed
    assert "a whole number, 0 or more" in seed
    assert "'margins'" in refused("TV_TOLERANCES", handle, SCATTER, "stress").message
    assert "'start'" in refused("TV_SENSITIVITIES", handle, "modes").message


def test_the_shipped_example_has_every_study_sheet_filled():
    book = openpyxl.load_workbook(TEMPLATES / "example_studies.xlsx")
    for name in ("Tuning", "Catalogue", "Scatter", "StartConditions", "MeasuredFrequencies"):
        units, head, *rows = table(book, name)
        assert any(value is not None for row in rows for value in row), name
