"""Many cells recalculated at once in a browser: each is answered, equal ones are asked for once."""

import socket
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from typing import Any

import pytest
from office_page import cell, load_in_office
from servers import SMALL_QUEUE, outside, slow_case
from sheet_ranges import model_arguments

from addin.worksheet import registry

sync_api = pytest.importorskip("playwright.sync_api")  # not under Wine

pytestmark = [pytest.mark.needs_browser, pytest.mark.slow]

#: Functions that need a start, or the start of another, of one model.
FUNCTIONS = ("TV_PEAKS", "TV_STARTS", "TV_REVERSALS", "TV_MARGINS", "TV_FREQUENCIES")
#: Counts what goes to the server: requests, and messages that ask for something.
COUNTED = """() => {
  window.sent = {posts: 0, asked: 0};
  const fetched = window.fetch, send = WebSocket.prototype.send;
  window.fetch = (...given) => { sent.posts += 1; return fetched(...given); };
  WebSocket.prototype.send = function (text) { if (text.includes('"name"')) sent.asked += 1; send.call(this, text); };
}"""
#: One train many times over, each with another inertia of its first station: its models, then their peaks.
TRAINS = """async ([given, row, column, count]) => {
  const trains = Array.from({length: count}, (_, i) => {
    const one = structuredClone(given);
    one[0][row][column] *= 1 + 1e-4 * i;
    return one;
  });
  const calculate = async () => {
    const models = await Promise.all(trains.map(one => standIn.cell("TV.MODEL", one)));
    const handles = models.map(found => found.value[0][0]);
    return [handles, await Promise.all(handles.map(handle => standIn.cell("TV.PEAKS", [handle])))];
  };
  // Ctrl+Alt+F9, and again before it has ended
  const [[handles, peaks], [again]] = await Promise.all([calculate(), calculate()]);
  return {handles, again, peaks: peaks.map(found => found.value || found)};
}"""


@contextmanager
def office_at(browser: Any, address: str) -> Iterator[Any]:
    """The page as Office loads it, of a server with one process."""
    context = browser.new_context(base_url=address)
    context.set_default_timeout(600_000)
    page = context.new_page()
    load_in_office(page)
    page.evaluate(COUNTED)
    yield page
    context.close()


@pytest.fixture
def page(browser, served) -> Iterator[Any]:
    with office_at(browser, served) as page:
        yield page


def shown(rows):
    """As a cell has them: blanks are empty texts."""
    return [["" if value is None else value for value in row] for row in rows]


def inertia(given):
    """Where the inertia of the first station stands in the arguments of TV_MODEL."""
    stations = given[0]
    column = next(row.index("Inertia") for row in stations if "Inertia" in row)
    return next(
        (i, column) for i, row in enumerate(stations) if isinstance(row[column], (int, float))
    )


def test_ten_thousand_cells_of_one_model(page):
    arguments = model_arguments()
    handle = cell(page, "TV_MODEL", arguments)["value"][0][0]
    page.evaluate("sent.posts = sent.asked = 0")
    ids = [name.replace("_", ".") for name in FUNCTIONS]
    found = page.evaluate(
        """async ([ids, handle]) => {
          const cells = Array.from({length: 10000}, (_, i) => standIn.cell(ids[i % ids.length], [handle]));
          const answers = (await Promise.all(cells)).map(found => JSON.stringify(found.value || found));
          return ids.map((_, k) => [...new Set(answers.filter((_, i) => i % ids.length === k))]);
        }""",
        [ids, handle],
    )
    assert [len(different) for different in found] == [1] * len(FUNCTIONS), found
    registry.call("TV_MODEL", arguments)
    for name, (answer,) in zip(FUNCTIONS, found, strict=True):
        here = shown(registry.call(name, [handle]))
        assert page.evaluate("text => JSON.parse(text)", answer) == here, name
    sent = page.evaluate("sent")
    assert sent["posts"] + sent["asked"] <= len(FUNCTIONS), sent


@pytest.mark.parametrize(
    ("count", "compared"), [(70, 5), pytest.param(500, 500, marks=pytest.mark.long)]
)
def test_different_trains_at_once_and_again_before_they_have_ended(page, count, compared):
    """More than the 64 that the server lets wait: the add-in keeps the rest until there is a place."""
    given = model_arguments("example_modified")
    row, column = inertia(given)
    found = page.evaluate(TRAINS, [given, row, column, count])
    wrong = [answer for answer in found["peaks"] if not isinstance(answer, list)]
    assert wrong == []
    assert found["handles"] == found["again"]
    assert len(set(found["handles"])) == count
    for i in range(0, count, count // compared):
        stations = [list(cells) for cells in given[0]]
        stations[row][column] *= 1 + 1e-4 * i
        handle = registry.call("TV_MODEL", [stations, *given[1:]])[0][0]
        assert handle == found["handles"][i]
        assert found["peaks"][i] == shown(registry.call("TV_PEAKS", [handle]))


def test_a_busy_server_is_asked_again(browser):
    """With one place in the queue of the server most calls are refused at first."""
    given = model_arguments("example_modified")
    row, column = inertia(given)
    with outside(program=SMALL_QUEUE) as address, office_at(browser, address) as page:
        found = page.evaluate(TRAINS, [given, row, column, 12])
        assert [answer for answer in found["peaks"] if not isinstance(answer, list)] == []
        # each train was asked for twice and calculated once
        assert page.evaluate("sent.asked") > 12, "nothing was refused"


def test_what_one_cell_cancels_another_still_waits_for(page):
    """The last one to cancel stops the calculation, and its process is free for the next."""
    handle = cell(page, "TV_MODEL", slow_case())["value"][0][0]
    found = page.evaluate(
        """async handle => {
          const first = standIn.cell("TV.PEAKS", [handle], {cancelAfter: 1500});
          const second = standIn.cell("TV.PEAKS", [handle], {cancelAfter: 3500});
          const one = await first, at = performance.now();
          const two = await second;
          return {one, two, between: performance.now() - at, asked: sent.asked};
        }""",
        handle,
    )
    assert found["one"]["cancelled"]
    assert found["two"]["cancelled"]
    assert found["between"] > 1000
    assert found["asked"] == 1
    other = cell(page, "TV_MODEL", model_arguments("example_modified"))["value"][0][0]
    assert len(cell(page, "TV_PEAKS", [other])["value"]) > 2


def test_a_cell_that_is_cancelled_before_its_turn_is_never_asked_for(page):
    """All places are taken by other starts; the calls that wait are given up without a word to the server."""
    given = slow_case()
    row, column = inertia(given)
    asked = page.evaluate(
        """async ([given, row, column]) => {
          const models = await Promise.all(Array.from({length: 40}, (_, i) => {
            const one = structuredClone(given);
            one[0][row][column] *= 1 + 1e-4 * i;
            return standIn.cell("TV.MODEL", one);
          }));
          const found = await Promise.all(models.map(model =>
            standIn.cell("TV.PEAKS", [model.value[0][0]], {cancelAfter: 3000})));
          return [found.filter(one => one.cancelled).length, sent.asked];
        }""",
        [given, row, column],
    )
    assert asked == [40, 32]


def test_cells_survive_a_restart_of_the_server(browser):
    """The same port, another process with empty memory: cells send their model again and show the same."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = ("--port", str(free.getsockname()[1]))
    asked = [("TV_FREQUENCIES", 1), ("TV_PEAKS", 1), ("TV_PEAKS", 5)]
    with ExitStack() as shown_page:
        with outside(*port) as address:
            page = shown_page.enter_context(office_at(browser, address))
            handle = cell(page, "TV_MODEL", model_arguments("example_modified"))["value"][0][0]
            given = {1: [handle], 5: [handle, None, None, 5]}
            before = [cell(page, name, given[count]) for name, count in asked]
        with outside(*port):
            assert [cell(page, name, given[count])["value"] for name, count in asked] == [
                found["value"] for found in before
            ]
            # a request that does not arrive is made again
            failing = iter([True, True])
            page.route(
                "**/api/v1/batch",
                lambda route: route.abort() if next(failing, False) else route.continue_(),
            )
            assert cell(page, "TV_CONVERT", [1, "m", "mm"])["value"] == [[1000]]
            assert next(failing, None) is None
            unknown = handle.replace("tv:", "tv:0")[: len(handle)]
            assert "not in the memory" in cell(page, "TV_PEAKS", [unknown])["message"]
