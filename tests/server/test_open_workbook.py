"""The pane fills the open workbook: Excel is played by a stand-in that checks every call."""

import base64
from collections.abc import Iterator
from typing import Any

import openpyxl
import pytest
from office_page import launched, load_in_office
from openpyxl.utils.datetime import to_excel
from test_browser import picture

sync_api = pytest.importorskip("playwright.sync_api")  # not under Wine

pytestmark = pytest.mark.needs_browser
#: Starts share the machine with other tests. [ms]
PATIENCE = 120_000

#: Two sheets as the server describes them: a table that grows, one that shrinks, single cells.
RESULTS = {
    "cells": 14,
    "sheets": [
        {
            "name": "O'Neil 1",
            "tables": [
                {"name": "Grows", "before": "B2:C3", "after": "B2:C5", "first": "B3:C3", "added": "B4:C5"}
            ],
            "cleared": [],
            "blocks": [{"at": "B3:C5", "rows": [["a", 1.5], ["'3-4", ""], ["#N/A", "=1+1"]]}],
        },
        {
            "name": "Two",
            "tables": [{"name": "Shrinks", "before": "D2:F5", "after": "D2:F3"}],
            "cleared": ["D4:E5"],
            "blocks": [
                {"at": "D3:E3", "rows": [[0.1, True]]},
                {"at": "A1", "rows": [["'=no formula"]]},
                {"at": "AA9:AA10", "rows": [[1e-300], [2]]},
            ],
        },
    ],
}  # fmt: skip
#: The workbook before: texts that Excel would read otherwise, a formula, all digits, a column of the engineer.
BOOK = {
    "O'Neil 1": {
        "tables": {"Grows": "B2:C3"},
        "cells": {
            "B2": ["h", "h", "String"], "C2": ["k", "k", "String"], "B3": ["7 May", "7 May", "String"],
            "C3": ["=B3", "7 May", "String"], "C5": ["=no", "=no", "String"],
        },
    },
    "Two": {
        "tables": {"Shrinks": "D2:F5"},
        "cells": {
            "D3": [0.3, 0.1 + 0.2, "Double"], "D4": ["#N/A", "#N/A", "Error"], "E4": [True, True, "Boolean"],
            "F4": ["mine", "mine", "String"], "E5": ["TRUE", "TRUE", "String"], "AA9": [4, 4, "Double"],
        },
    },
}  # fmt: skip
#: Keeps what the page says, and cancels once.
WATCH = """() => {
  const said = document.getElementById("progress"), cancel = document.getElementById("cancel");
  window.stages = [];
  let isFirst = true;
  new MutationObserver(() => {
    stages.push(said.textContent);
    // of stages that arrive together only the last is seen
    if (isFirst && !["", "reading the open workbook"].includes(said.textContent)) { isFirst = false; cancel.click(); }
  }).observe(said, { childList: true });
}"""
FILL = """async ([book, results, more]) => {
  const { fill, putBack } = await import("/open_workbook.js");
  const copy = () => structuredClone(Object.fromEntries(Object.entries(standIn.book).map(
    ([name, { cells, tables }]) => [name, { cells: Object.fromEntries(Object.entries(cells).sort()), tables }])));
  Object.assign(standIn, { book: structuredClone(book), batches: [], refusals: [], fails: {} });
  Object.assign(standIn, more.host);
  if (more.locked) standIn.book[more.locked].isProtected = true;
  const before = copy(), shares = [];
  let earlier = null, error = null;
  try {
    earlier = await fill(results, share => shares.push(share), () => more.cancelAt !== undefined && shares.length >= more.cancelAt);
  } catch (failed) { error = { message: failed.message, cancelled: Boolean(failed.cancelled) }; }
  const after = copy(), batches = [...standIn.batches];
  if (earlier && more.moved) standIn.book.Two.tables.Shrinks = more.moved;
  let back = null, backError = null;
  if (earlier) {
    try { await putBack(earlier); } catch (failed) { backError = failed.message; }
    back = copy();
  }
  return { before, after, back, shares, batches, error, backError, refusals: standIn.refusals };
}"""


@pytest.fixture(scope="module")
def page(served) -> Iterator[Any]:
    with sync_api.sync_playwright() as playwright:
        browser = launched(playwright)
        context = browser.new_context(base_url=served, viewport={"width": 360, "height": 800})
        context.set_default_timeout(PATIENCE)
        page = context.new_page()
        load_in_office(page)
        yield page
        browser.close()


def filled(page, **more):
    done = page.evaluate(FILL, [more.pop("book", BOOK), more.pop("results", RESULTS), more])
    assert done["refusals"] == []
    return done


@pytest.mark.slow
def test_rectangles_are_written_in_one_batch_a_sheet_and_put_back(page):
    done = filled(page)
    assert done["error"] is done["backError"] is None
    one, two = done["after"]["O'Neil 1"], done["after"]["Two"]
    assert (one["tables"], two["tables"]) == ({"Grows": "B2:C5"}, {"Shrinks": "D2:F3"})
    assert one["cells"] == {
        "B2": ["h", "h", "String"], "C2": ["k", "k", "String"], "B3": ["a", "a", "String"],
        "C3": [1.5, 1.5, "Double"], "B4": ["3-4", "3-4", "String"], "B5": ["#N/A", "#N/A", "Error"],
        "C5": ["=1+1", 0, "Double"],
    }  # fmt: skip
    assert two["cells"] == {
        "D3": [0.1, 0.1, "Double"], "E3": [True, True, "Boolean"], "F4": ["mine", "mine", "String"],
        "A1": ["=no formula", "=no formula", "String"], "AA9": [1e-300, 1e-300, "Double"],
        "AA10": [2, 2, "Double"],
    }  # fmt: skip
    assert done["batches"] == [["O'Neil 1"], ["Two"]]
    assert done["shares"][-1] == pytest.approx(11 / 14)
    # what was there before, with all digits; the stand-in does not calculate formulas
    digits = [0.1 + 0.2, 0.1 + 0.2, "Double"]
    done["before"]["Two"]["cells"]["D3"] = digits
    done["before"]["O'Neil 1"]["cells"]["C3"] = ["=B3", 0, "Double"]
    assert done["back"] == done["before"]


@pytest.mark.slow
def test_what_cannot_be_written_is_left_and_said(page):
    locked = filled(page, locked="Two")
    assert "sheet Two is protected" in locked["error"]["message"]
    moved = {**BOOK, "Two": {**BOOK["Two"], "tables": {"Shrinks": "D3:F6"}}}
    shifted = filled(page, book=moved)
    assert "table Shrinks was moved, resized or deleted" in shifted["error"]["message"]
    gone = filled(page, book={"Two": BOOK["Two"]})
    assert "sheet O'Neil 1 was renamed or deleted" in gone["error"]["message"]
    for done in (locked, shifted, gone):
        assert done["batches"] == []
        assert done["after"] == done["before"]
    # an undo of what was moved since would write over what stands there now
    late = filled(page, moved="D2:F4")
    assert "table Shrinks was moved" in late["backError"]
    assert late["back"]["O'Neil 1"] == late["after"]["O'Neil 1"]


@pytest.mark.slow
def test_cancelled_or_failed_between_sheets_it_puts_back_what_was_written(page):
    book = {name: {**sheet, "cells": dict(sheet["cells"])} for name, sheet in BOOK.items()}
    book["O'Neil 1"]["cells"].pop("C3")  # the stand-in does not calculate formulas
    book["Two"]["cells"].pop("D3")
    for more, words in (
        ({"cancelAt": 1}, "Cancelled."),
        ({"host": {"fails": {"Two": 1}}}, "made up"),
    ):
        done = filled(page, book=book, **more)
        assert done["error"]["message"] == words
        assert done["batches"][0] == ["O'Neil 1"]
        assert done["after"] == done["before"]
        assert done["back"] is None
    done = filled(page, book=book, host={"fails": {"Two": 2}})
    assert "could not be put back" in done["error"]["message"]
    assert "results on O'Neil 1, Two are incomplete" in done["error"]["message"]
    none = filled(page, book=book, cancelAt=0)
    assert none["error"]["cancelled"]
    assert none["batches"] == []


@pytest.mark.slow
def test_a_member_beyond_the_manifest_is_refused_by_the_stand_in(page):
    """Else the stand-in would prove nothing."""
    said = page.evaluate(
        """async () => {
          standIn.refusals = [];
          const tried = async use => { try { await Excel.run(use); } catch (failed) { return failed.message; } return "taken"; };
          const cells = context => context.workbook.worksheets.getItem("Two").getRange("A1:B2");
          standIn.book = {Two: {cells: {}, tables: {}}};
          return [
            await tried(async context => context.application.calculationMode),
            await tried(async context => { cells(context).formulas = [[1, 2]]; }),
            await tried(async context => { cells(context).formulas = [[1, 2], [3, null]]; }),
            await tried(async context => { cells(context).formulas = [[1, 2], [3, "3-4"]]; }),
            await tried(async context => cells(context).values),
            await tried(async context => { cells(context).formulas = [[1, 2], [3, "four"]]; }),
          ];
        }"""
    )
    words = ("not known", "another shape", "null", "not keep", "not loaded", "taken")
    assert [word in one for word, one in zip(words, said, strict=True)] == [True] * 6, said


# --- with the server ------------------------------------------------------------------------------


def stand_in_book(path):
    """Cells and tables of a file as the stand-in has them; formulas are not calculated."""
    return {
        sheet.title: {
            "cells": {c.coordinate: _content(c) for row in sheet.iter_rows() for c in row if c.value is not None},
            "tables": dict(sheet.tables.items()),
        }
        for sheet in openpyxl.load_workbook(path).worksheets
    }  # fmt: skip


def _content(cell):
    if cell.data_type == "f":
        text = getattr(cell.value, "text", cell.value)
        return ["=" + text.removeprefix("=").replace("_xlfn.", ""), 0, "Double"]
    kinds = {"n": "Double", "b": "Boolean", "e": "Error", "d": "Double"}
    value = to_excel(cell.value) if cell.data_type == "d" else cell.value
    return [value, value, kinds.get(cell.data_type, "String")]


def differences(one, other):
    """Cells that two workbooks have otherwise."""
    for name, sheet in other.items():
        for place in {*sheet["cells"], *one[name]["cells"]}:
            a, b = (side["cells"].get(place) for side in (one[name], sheet))
            if a != b:
                yield name, place, a, b


@pytest.mark.slow
def test_the_button_fills_the_open_workbook_as_a_file_and_another_puts_it_back(page, examples):
    source = examples / "proposed.in.xlsx"
    before = stand_in_book(source)
    page.evaluate(
        """([coded, book]) => {
          standIn.workbook = Uint8Array.from(atob(coded), c => c.charCodeAt(0));
          Object.assign(standIn, { book, batches: [], refusals: [], fails: {} });
        }""",
        [base64.b64encode(source.read_bytes()).decode(), before],
    )
    said, fill, back = (
        page.locator("#progress"),
        page.get_by_role("button", name="Recalculate this workbook"),
        page.get_by_role("button", name="Write back the earlier values"),
    )
    assert back.is_disabled()
    # cancelled as soon as the server has told a stage of its calculation
    page.evaluate(WATCH)
    fill.click()
    sync_api.expect(said).to_have_text("Cancelled. The workbook is as it was.", timeout=PATIENCE)
    assert page.evaluate("standIn.batches") == []
    page.evaluate("stages.length = 0")
    fill.click()
    sync_api.expect(said).to_contain_text("sheets were written (", timeout=PATIENCE)
    picture(page, "filled")
    stages = page.evaluate("stages")
    assert {"reading the open workbook", "writing results, 100 %"} <= set(stages)
    assert {"reading", "writing"} & set(stages)
    assert page.evaluate("standIn.refusals") == []
    batches = page.evaluate("standIn.batches")
    assert all(len(sheets) == 1 for sheets in batches)
    assert len({name for (name,) in batches}) == len(batches) > 8  # one a sheet
    after, file = page.evaluate("standIn.book"), stand_in_book(examples / "proposed.xlsx")
    for name, sheet in file.items():
        assert after[name]["tables"] == sheet["tables"]
    odd = list(differences(after, file))
    assert len(odd) < 30, odd  # times of the effects, and of the calculation
    assert len(list(differences(before, file))) > 10_000
    back.click()
    sync_api.expect(said).to_contain_text("The earlier values were written back (")
    restored = page.evaluate("standIn.book")
    assert list(differences(restored, before)) == []
    assert [s["tables"] for s in restored.values()] == [s["tables"] for s in before.values()]
    assert back.is_disabled()
    # what is wrong with the inputs is listed
    page.evaluate("standIn.workbook = new Uint8Array([80, 75, 3, 4])")
    fill.click()
    sync_api.expect(page.locator("#problems li")).to_have_count(1)
    assert "My train.xlsx: one error." in said.text_content()
    assert fill.is_enabled()
