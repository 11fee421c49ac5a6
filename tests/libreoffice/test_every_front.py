"""Each function through every front: plain Python, classic xlwings, HTTP, browser, Calc, batch.

All fronts calculate for themselves: the model is made in each from the ranges of one workbook. What
they show must be the same doubles, bit for bit. xlwings runs with its Windows layer stubbed
(tests/excel), the browser drives the real script against a server in a process of its own, Calc is
LibreOffice with the extension added, and batch is the workbook recalculated as a file.
"""

import struct

import openpyxl
import pytest
from office_page import cell, launched, load_in_office
from servers import inside, outside
from sheet_ranges import (
    SAME_CELLS,
    TEMPLATES,
    in_order,
    model_arguments,
    table,
    with_conditions,
    with_event,
)
from test_calc_workbook import calculated, every_call, expected  # noqa: F401  (fixtures)
from windows_layer import machinery

from addin.server.settings import Settings
from addin.worksheet.registry import FUNCTIONS, call
from addin.writing.recalculate import recalculate

pytestmark = [pytest.mark.needs_libreoffice, pytest.mark.needs_browser]


def shown(value):
    """A cell so that only equal cells are equal: doubles by their bits, a blank is a blank."""
    if value is None or value == "":
        return None
    return struct.pack("<d", value) if isinstance(value, (bool, float, int)) else value


def cells(rows):
    """Rows of cells; one row or one cell may come without its brackets."""
    rows = rows if isinstance(rows, list) else [[rows]]
    rows = rows if not rows or isinstance(rows[0], list) else [rows]
    return [[shown(value) for value in row] for row in rows]


def comparable(name, rows):
    """Without the column that is measured, which no two runs share."""
    if name != "TV_EFFECTS":
        return cells(rows)
    at = rows[0].index("Time [ms]")
    return cells([row[:at] + row[at + 1 :] for row in rows])


def through_classic(calls):
    with machinery() as excel:
        made = excel.call("TV_MODEL", *with_conditions(with_event(model_arguments())))
        return made, [excel.call(name, *raw) for name, raw in calls]


def through_http(calls):
    wanted = [{"name": "TV_MODEL", "arguments": with_conditions(with_event(model_arguments()))}]
    wanted += [{"name": name, "arguments": raw} for name, raw in calls]
    with inside(Settings(workers=1)) as client:
        made = client.post("/api/v1/batch", json={"calls": wanted[:1]}).json()["results"]
        answers = client.post("/api/v1/batch", json={"calls": wanted[1:]}).json()["results"]
    return made[0]["value"][0][0], [one["value"] for one in answers]


def through_browser(calls):
    from playwright import sync_api

    with outside() as address, sync_api.sync_playwright() as playwright:
        browser = launched(playwright)
        page = browser.new_page(base_url=address)
        load_in_office(page)
        made = cell(page, "TV_MODEL", with_conditions(with_event(model_arguments())))["value"][0][0]
        found = made, [cell(page, name, raw)["value"] for name, raw in calls]
        browser.close()
    return found


@pytest.mark.slow
def test_every_function_shows_the_same_bits_through_every_front(
    expected,  # noqa: F811
    calculated,  # noqa: F811
    tmp_path,
):
    handle, blocks = expected
    calls = [(name, raw) for name, _, raw in every_call(handle)]
    assert {name for name, _ in calls} | {"TV_MODEL"} == set(FUNCTIONS)
    plain = [call(name, raw) for name, raw in calls]
    for front in (through_classic, through_http, through_browser):
        made, answers = front(calls)
        assert made == handle, front.__name__
        for (name, raw), mine, theirs in zip(calls, plain, answers, strict=True):
            assert comparable(name, theirs) == comparable(name, mine), (front.__name__, name, raw)
    sheet = calculated["Results"]
    assert sheet[0, 0] == handle
    for (top, left), (name, _), mine in zip(blocks, calls, plain, strict=True):
        theirs = [[sheet[top + i, left + j] for j in range(len(r))] for i, r in enumerate(mine)]
        assert comparable(name, theirs) == comparable(name, mine), ("Calc", name)
    recalculate(TEMPLATES / "example_proposed.xlsx", destination=tmp_path / "done.xlsx")
    book = openpyxl.load_workbook(tmp_path / "done.xlsx", data_only=True)
    as_shipped = call("TV_MODEL", model_arguments())[0][0]
    for name, where in SAME_CELLS.items():
        head, *rows = call(name, [as_shipped])
        there = table(book, where)
        at = [there[1].index(title.split(" [")[0]) for title in head]
        written = [row for row in there[2:] if any(one is not None for one in row)]
        for mine, row in zip(rows, in_order(name, head, rows, there[1], written), strict=False):
            assert cells([mine]) == cells([[row[j] for j in at]]), ("batch", name)
