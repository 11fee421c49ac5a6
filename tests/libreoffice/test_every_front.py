"""Each function through every front: the registry, classic xlwings, HTTP, browser, Calc, batch, Python, MCP.

All fronts calculate for themselves: the model is made in each from the ranges of one workbook. What
they show must be the same doubles, bit for bit. xlwings runs with its Windows layer stubbed
(tests/excel), the browser drives the real script against a server in a process of its own, Calc is
LibreOffice with the extension added, batch is the workbook recalculated as a file, Python is `import torsionbook`,
and MCP is asked by the client of its SDK.

TORSIONBOOK_FRONTS=path   the fronts that each function was equal through are written there, as JSON
"""

import asyncio
import json
import os
import struct
from pathlib import Path

import openpyxl
import pytest
from mcp_client import client, said
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

import torsionbook as tb
from addin.contract.tables import result_table
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


def through_mcp(calls):
    async def ask():
        async with client("--read", TEMPLATES) as server:
            given = with_conditions(with_event(model_arguments()))
            made = await said(server, "call", function="TV_MODEL", arguments=given)
            answers = [await said(server, "call", function=n, arguments=raw) for n, raw in calls]
            return made["value"][0][0], [one["value"] for one in answers]

    return asyncio.run(ask())


def of_the_workbook(path):
    """Table → titles and rows in the workbook, as batch writes them."""
    recalculate(TEMPLATES / "example_proposed.xlsx", destination=path)
    book = openpyxl.load_workbook(path, data_only=True)

    def rows_of(where):
        _, titles, *rows = table(book, where)
        return titles, [row for row in rows if any(one is not None for one in row)]

    return rows_of


def of_python():
    """Table → titles and rows in the frames of `import torsionbook`, in the units of the workbook."""
    done = tb.run(tb.read(TEMPLATES / "example_proposed.xlsx"))

    def rows_of(where):
        frame = done.table(where, units="us")
        names = {field.key: field.name for field in result_table(where).every_column}
        rows = [
            [None if v != v else v for v in row] for row in frame.astype(object).values.tolist()
        ]
        return [names.get(key, key) for key in frame.columns], rows

    return rows_of


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
    equal = {name: [] for name in FUNCTIONS}
    every = {
        "xlwings": through_classic,
        "HTTP": through_http,
        "Office": through_browser,
        "MCP": through_mcp,
    }
    for front, through in every.items():
        made, answers = through(calls)
        assert made == handle, front
        for (name, raw), mine, theirs in zip(calls, plain, answers, strict=True):
            assert comparable(name, theirs) == comparable(name, mine), (front, name, raw)
        for name in FUNCTIONS:
            equal[name].append(front)
    sheet = calculated["Results"]
    assert sheet[0, 0] == handle
    for (top, left), (name, _), mine in zip(blocks, calls, plain, strict=True):
        theirs = [[sheet[top + i, left + j] for j in range(len(r))] for i, r in enumerate(mine)]
        assert comparable(name, theirs) == comparable(name, mine), ("Calc", name)
    for name in FUNCTIONS:
        equal[name].append("Calc")
    as_shipped = call("TV_MODEL", model_arguments())[0][0]
    fronts = {"batch": of_the_workbook(tmp_path / "done.xlsx"), "Python": of_python()}
    for front, rows_of in fronts.items():
        for name, where in SAME_CELLS.items():
            if (front, name) == ("Python", "TV_CYCLES"):
                continue  # histories and cycles have no frame of this form
            head, *rows = call(name, [as_shipped])
            titles, there = rows_of(where)
            at = [titles.index(title.split(" [")[0]) for title in head]
            assert len(there) >= len(rows) > 0, (front, name)
            compared = 0
            for mine, row in zip(rows, in_order(name, head, rows, titles, there), strict=False):
                theirs = [row[j] for j in at]
                if front == "Python":  # words are True, or a column of their own
                    mine, theirs = zip(
                        *((m, t) for m, t in zip(mine, theirs, strict=True) if type(m) is float),
                        strict=True,
                    )
                assert cells([list(mine)]) == cells([list(theirs)]), (front, name)
                compared += len(mine)
            assert compared > 0, (front, name)
            equal[name].append(front)
    if path := os.environ.get("TORSIONBOOK_FRONTS"):
        Path(path).write_text(json.dumps(equal), encoding="utf-8")
