"""Tables in a number of rows that is asked for, as array formulas of fixed size need them."""

import pytest
from sheet_ranges import model_arguments

from addin.worksheet.registry import FUNCTIONS, ROW_COUNT, FunctionError, call


@pytest.fixture(scope="module")
def handle():
    return call("TV_MODEL", model_arguments())[0][0]


def test_every_table_takes_it_last_and_nothing_else_does():
    tables = {name for name, one in FUNCTIONS.items() if ROW_COUNT in one.arguments}
    assert {one.arguments[-1] for one in FUNCTIONS.values() if one.name in tables} == {ROW_COUNT}
    assert tables == {name for name, one in FUNCTIONS.items() if one.columns is not None}
    assert not tables & {"TV_MODEL", "TV_STIFFNESS", "TV_SN_LIFE", "TV_CONVERT", "TV_LIFE"}


def test_what_is_missing_is_blank(handle):
    whole = call("TV_FREQUENCIES", [handle])
    longer = call("TV_FREQUENCIES", [handle, None, None, float(len(whole) + 3)])
    assert longer == whole + [[None] * len(whole[0])] * 3
    assert call("TV_FREQUENCIES", [handle, None, None, float(len(whole))]) == whole


def test_what_does_not_fit_is_counted(handle):
    whole = call("TV_MARGINS", [handle])
    cut = call("TV_MARGINS", [handle, None, None, 10.0])
    assert len(cut) == 10
    assert cut[:9] == whole[:9]
    assert cut[9] == [f"{len(whole) - 9} more rows"] + [None] * (len(whole[0]) - 1)
    alone = call("TV_MARGINS", [handle, None, False, 1.0])
    assert alone == [[f"{len(whole) - 1} more rows"] + [None] * (len(whole[0]) - 1)]


def test_that_there_is_no_table_is_said_in_its_place():
    stations, elements, *_ = model_arguments()
    column = elements[1].index("Material")
    bare = [elements[0], elements[1]] + [
        [None if j == column else value for j, value in enumerate(row)] for row in elements[2:]
    ]
    alone = call("TV_MODEL", [stations, bare])[0][0]
    with pytest.raises(FunctionError) as told:
        call("TV_STARTS", [alone])
    rows = call("TV_STARTS", [alone, None, None, 3.0])
    assert rows[0][0] == told.value.message
    assert {value for row in rows for value in row} == {told.value.message, None}
    assert {len(row) for row in rows} == {len(call_headers("TV_STARTS"))}


def call_headers(name):
    return call(name, [call("TV_MODEL", model_arguments())[0][0]])[0]


@pytest.mark.parametrize("count", [0.0, -1.0, 2.5, 1e9, "many"])
def test_counts_that_are_none(handle, count):
    with pytest.raises(FunctionError, match="Row count"):
        call("TV_FREQUENCIES", [handle, None, None, count])
