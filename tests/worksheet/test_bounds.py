"""What a client may send and ask for is bounded, and no client gets what another typed."""

import contextlib
import copy
import math
from dataclasses import replace

import numpy as np
import pytest
from sheet_ranges import TEMPLATES, model_arguments, replace_models

from addin.reading.workbook import read_workbook
from addin.worksheet import answers
from addin.worksheet.models import MODELS, OWNER, _size
from addin.worksheet.registry import FunctionError, call, rows_of
from addin.xlsx.values import ErrorValue


def titled(title, name="example_proposed"):
    """Arguments of TV_MODEL with a title of their own."""
    found = copy.deepcopy(model_arguments(name))
    row = next(row for row in found[2] if row[0] == "Title")
    row[1] = title
    return found


def test_a_model_has_the_title_of_whoever_made_it_and_shares_the_numbers(monkeypatch):
    models = MODELS.__class__()
    replace_models(monkeypatch, models)
    one, other, again = (
        models.of(call("TV_MODEL", titled(title))[0][0]) for title in ("Ours", "Theirs", "Ours")
    )
    assert [one.case.title, other.case.title] == ["Ours", "Theirs"]
    assert again is one
    rows = call("TV_FREQUENCIES", [one.handle])
    monkeypatch.setattr(answers, "speed_results", None)  # would raise
    assert call("TV_FREQUENCIES", [other.handle]) == rows


def test_cases_that_differ_in_the_last_digit_do_not_share_numbers():
    other = copy.deepcopy(model_arguments())
    row = other[0][2]
    row[2] = math.nextafter(row[2], math.inf)
    one, two = (MODELS.of(call("TV_MODEL", a)[0][0]) for a in (model_arguments(), other))
    assert one.handle.split(".")[0] == two.handle.split(".")[0]  # the digest of the audit trail
    assert one.handle != two.handle
    assert one.kept is not two.kept


def test_each_client_has_its_share_of_the_cases():
    models = MODELS.__class__(most_cases=4)
    case, system = read_workbook(TEMPLATES / "example_proposed.xlsx").case(), "US"

    def add(owner, number):
        token = OWNER.set(owner)
        try:
            return models.add_case(replace(case, title=f"{owner} {number}"), system).handle
        finally:
            OWNER.reset(token)

    kept = [add("quiet", 1), add("quiet", 2)]
    flood = [add("loud", k) for k in range(50)]
    assert [models.of(h).handle for h in kept] == kept
    with pytest.raises(FunctionError, match="not in the memory"):
        models.of(flood[0])
    assert models.of(flood[-1]).case.title == "loud 49"


def test_cases_are_bounded_by_their_memory():
    case = read_workbook(TEMPLATES / "example_proposed.xlsx").case()
    size = MODELS.__class__().add_case(case, "US").size
    models = MODELS.__class__(most_case_memory=3 * size + 100)
    handles = [models.add_case(replace(case, title=str(k)), "US").handle for k in range(5)]
    assert [h in models._models for h in handles] == [False, False, True, True, True]


def test_numbers_in_tables_count_as_memory():
    rows = [{"a": float(k), "b": {"c": [1.0 * k] * 10}} for k in range(2000)]
    assert _size(rows) > 2000 * 11 * 24
    assert _size({"x": np.zeros(1000)}) > 8000


def test_uneven_rows_are_counted_as_wide_as_the_widest():
    wide = [[1.0] * 20_000] + [[]] * 20_000
    with pytest.raises(FunctionError, match="250,000 cells"):
        rows_of(wide)
    assert rows_of([[1.0, 2.0], [3.0], 4.0]) == [[1.0, 2.0], [3.0, None], [4.0, None]]


@pytest.mark.parametrize("inside", [[1, 2], {"a": 1}, {"type": "Double", "basicValue": [1]}])
def test_lists_inside_a_row_are_no_cells(inside):
    with pytest.raises(FunctionError, match="a cell is a number"):
        rows_of([[1.0, inside]])


@pytest.mark.slow
def test_nothing_nested_deeply_makes_an_error_of_ours():
    deep = []
    for _ in range(100_000):
        deep = [deep]
    for one in ([[deep]], [[{"a": deep}]], [[{"type": "Error", "basicValue": deep}]]):
        with contextlib.suppress(FunctionError):
            assert rows_of(one) == [[ErrorValue("#VALUE!")]]


def test_half_a_character_is_told():
    arguments = copy.deepcopy(model_arguments())
    arguments[0][2][0] = "Mo\ud800"
    with pytest.raises(FunctionError, match="an invalid character") as told:
        call("TV_MODEL", arguments)
    told.value.message.encode()
