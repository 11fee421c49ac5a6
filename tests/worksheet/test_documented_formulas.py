"""Formulas of the documentation, typed literally into the shipped example, give what they say."""

import re
from pathlib import Path

import pytest
from sheet_ranges import MOTOR, model_arguments, with_conditions, with_event, workbook

from addin.worksheet.functions import studies
from addin.worksheet.registry import FUNCTIONS, call

DOCS = Path(__file__).resolve().parents[2] / "docs"
PAGES = ("functions.md", "calc.md", "server.md", "excel-smoke-test.md")
#: A range of Excel or of Calc: sheet, cells.
RANGE = re.compile(r"\$?(?:'(?P<quoted>[^']+)'|(?P<bare>\w+))[!.](?P<cells>[A-Z]+\d+:[A-Z]+\d+)")
MODELS = re.compile(r"=TV[._]MODEL\(([^()]*![^()]*|[^()]*\$[^()]*)\)")


def value(text, handle):
    """What a spreadsheet program hands over for an argument of a formula."""
    text = text.strip()
    if not text:
        return None
    if text == "A1":
        return handle
    if text.startswith('"'):
        return text.strip('"')
    found = RANGE.fullmatch(text)
    if found is None:
        return float(text)
    book = workbook("example_proposed")
    sheet = found["quoted"] or found["bare"]
    book = book if sheet in book.sheetnames else workbook("example_studies")
    return [[cell.value for cell in row] for row in book[sheet][found["cells"]]]


def arguments(text, handle=None):
    return [value(one, handle) for one in re.split(r'[,;](?=(?:[^"]*"[^"]*")*[^"]*$)', text)]


@pytest.fixture(scope="module")
def handle():
    return call("TV_MODEL", model_arguments())[0][0]


@pytest.mark.parametrize("page", PAGES)
def test_every_model_of_a_page_is_that_of_the_example(page, handle):
    formulas = MODELS.findall((DOCS / page).read_text(encoding="utf-8"))
    models = [call("TV_MODEL", arguments(formula))[0][0] for formula in formulas]
    assert handle in models  # with all tables
    for shorter in set(models) - {handle}:
        assert call("TV_FREQUENCIES", [shorter]) == call("TV_FREQUENCIES", [handle])
        assert call("TV_MARGINS", [shorter]) == call("TV_MARGINS", [handle])
    assert len(set(models)) == 2, "a full call and a short one"


def answer_of_the_example(name, handle):
    """What the example of a function answers, with what the shipped example lacks filled in."""
    inside = re.fullmatch(rf"={name}\((.*)\)", FUNCTIONS[name].example)[1]
    if name == "TV_EVENTS":  # the example has none
        handle = call("TV_MODEL", with_event(model_arguments()))[0][0]
    if name == "TV_CASE_VERDICTS":  # nor other conditions
        handle = call("TV_MODEL", with_conditions(model_arguments()))[0][0]
    given = arguments(inside, handle)
    if name.startswith("TV_MOTOR"):  # nor a data sheet: its table is blank
        assert set(MOTOR[1]) <= set(given[0][1])
        given[0] = MOTOR
    if name == "TV_SECTIONS":  # likewise
        headers = given[0][1]
        cells = {"Element": "Shaft", "Section": 1, "Length": 10.0, "OD": 5.0}
        given[0] = [*given[0][:2], [cells.get(header) for header in headers]]
    return call(name, given)


@pytest.mark.first_ones(1)
@pytest.mark.parametrize("name", [name for name in FUNCTIONS if name != "TV_MODEL"])
def test_the_example_of_each_function_answers_with_numbers(name, handle, monkeypatch):
    monkeypatch.setattr(studies, "TIME_LIMIT", 600.0)  # the machine may be busy
    rows = answer_of_the_example(name, handle)
    assert any(isinstance(cell, float) for row in rows for cell in row)


def test_the_cell_that_calc_md_takes_is_the_first_elastic_mode(handle):
    text = (DOCS / "calc.md").read_text(encoding="utf-8")
    row, column = map(
        int, re.search(r"=INDEX\(TV_FREQUENCIES\(A1\); (\d+); (\d+)\)", text).groups()
    )
    assert call("TV_FREQUENCIES", [handle])[row - 1][column - 1] == pytest.approx(30.0, abs=0.02)


def test_every_function_has_a_row_on_the_page_of_fronts():
    page = (DOCS / "fronts.md").read_text(encoding="utf-8")
    assert re.findall(r"^\| `(TV_\w+)` \|", page, re.MULTILINE) == list(FUNCTIONS)
