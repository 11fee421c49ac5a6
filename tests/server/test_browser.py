"""The real page and the real functions script in a browser, Excel played by a stand-in."""

import base64
import os
from pathlib import Path

import pytest
from office_page import cell, load_in_office
from servers import SLOW_CASE, outside, slow_case
from sheet_ranges import (
    MOTOR,
    SCATTER,
    SECTIONS,
    TEMPLATES,
    TUNING,
    model_arguments,
    with_conditions,
    with_event,
)

from addin.worksheet import registry
from addin.worksheet.registry import FUNCTIONS

sync_api = pytest.importorskip("playwright.sync_api")  # not under Wine

pytestmark = pytest.mark.needs_browser
#: Starts share the machine with other tests. [ms]
sync_api.expect.set_options(timeout=30_000)

HERE = Path(__file__).parent
#: Where to leave pictures of the page, if anywhere.
PICTURES = os.environ.get("TORSIONBOOK_PICTURES")
KEY = "a-key-nobody-guesses"


@pytest.fixture
def excel(tab):
    """The page as Office loads it."""
    load_in_office(tab)
    return tab


def doubles(rows):
    """As the browser has them: whole numbers lose their point, and blanks are empty texts."""
    return [
        ["" if v is None else float(v).hex() if is_number(v) else v for v in row] for row in rows
    ]


def without_times(rows):
    at = next(j for j, name in enumerate(rows[0]) if name.startswith("Time"))
    return [row[:at] + row[at + 1 :] for row in rows]


def is_number(value):
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def picture(page, name):
    if PICTURES:
        Path(PICTURES).mkdir(parents=True, exist_ok=True)
        page.screenshot(path=f"{PICTURES}/{name}.png", full_page=True)


# --- functions ------------------------------------------------------------------------------------


@pytest.mark.slow
def test_every_function_of_the_metadata_is_there_and_no_other(excel, served):
    described = excel.evaluate("fetch('/functions.json').then(said => said.json())")
    there = excel.evaluate("Object.keys(standIn.functions)")
    assert sorted(there) == sorted(one["id"] for one in described["functions"])
    assert len(there) == len(FUNCTIONS)


@pytest.mark.slow
def test_every_function_shows_the_same_doubles(excel):
    arguments = with_conditions(with_event(model_arguments()))
    handle = cell(excel, "TV_MODEL", arguments)["value"][0][0]
    assert handle == registry.call("TV_MODEL", arguments)[0][0]
    from addin.worksheet.models import MODELS

    material = str(MODELS.of(handle).case.materials[0].material)
    given = {
        "TV_MODEL": arguments,
        "TV_MODE": [handle, 2],
        "TV_STIFFNESS": [200.1, None, 501.7, 79300],
        "TV_CONVERT": [[[0.1, None], [1e-300, 1 / 3]], "lbf*in", "N*m"],
        "TV_HISTORY": [handle, "LS coupling", 200],
        "TV_SPEED_TIME": [handle, 100],
        "TV_SN_LIFE": [handle, material, [[30000.0, None]]],
        "TV_STARTS": [handle, None, False],
        "TV_LIFE": [[[1e-3, 2e-4]], [[12.0, None]], None, 2],
        "TV_SECTIONS": [SECTIONS],
        "TV_MOTOR_CIRCUIT": [MOTOR, 60],
        "TV_MOTOR_CURVES": [MOTOR, [[1, 0.05]], 60],
        "TV_FAULT_TORQUE": ["out-of-phase closing", 0.2, 0.25, None, 120],
        "TV_CALIBRATE": [handle, [[30.1, 52.7]], 0.01],
        "TV_TUNE": [handle, TUNING],
        "TV_TOLERANCES": [handle, SCATTER, "starts", 30],
    }
    for name in FUNCTIONS:
        sent = given.get(name, [handle])
        shown = cell(excel, name, sent)
        assert "error" not in shown, (name, shown)
        here = registry.call(name, sent)
        if name == "TV_EFFECTS":  # the one column that is measured and not calculated
            shown["value"], here = without_times(shown["value"]), without_times(here)
        assert doubles(shown["value"]) == doubles(here), name


@pytest.mark.slow
def test_a_thousand_cells_are_few_requests(excel):
    posts = []
    excel.on("request", lambda sent: posts.append(sent) if sent.method == "POST" else None)
    sums = excel.evaluate(
        """async () => {
          const cells = Array.from({length: 1000}, (_, i) => standIn.cell("TV.CONVERT", [i, "m", "mm"]));
          return (await Promise.all(cells)).map(found => found.value[0][0]);
        }"""
    )
    assert sums == [1000.0 * i for i in range(1000)]
    assert 1 <= len(posts) <= 5


def test_errors_are_excel_errors_with_their_sentence(excel):
    for name, given, code, words in (
        ("TV_CONVERT", [1, "florps", "m"], "#VALUE!", "florps"),
        ("TV_STIFFNESS", [-1, None, 1, 1], "#NUM!", "above 0"),
        (
            "TV_CONVERT",
            [[[{"type": "Error", "basicValue": "#DIV/0!"}]], "m", "m"],
            "#DIV/0!",
            "shows",
        ),
        ("TV_FREQUENCIES", ["tv:0000000000000000"], "#N/A", "not in the memory"),
        ("TV_PEAKS", ["tv:0000000000000000"], "#N/A", "not in the memory"),
        ("TV_PEAKS", [None], "#VALUE!", "blank"),
    ):
        shown = cell(excel, name, given)
        assert shown["error"] == code, shown
        assert words in shown["message"]


#: Cells of the stand-in's sheet: a zero and a blank, and others that are not.
SHEET = """standIn.sheets = {"My sheet's": {
  "B2:C2": {valueTypes: [["Double", "Empty"]], values: [[0, ""]]},
  "D2": {valueTypes: [["Empty"]], values: [[""]]},
  "B3:C3": {valueTypes: [["Double", "Double"]], values: [[0, 7]]},
  "B2:B3": {valueTypes: [["Double"], ["Double"]], values: [[0], [0]]},
}}"""


def test_a_blank_that_excel_hands_over_as_zero_stays_blank(excel):
    """Types of the cells come from the sheet; without them nothing is guessed."""
    excel.evaluate(SHEET)
    ask = {"addresses": ["'My sheet''s'!B2:C2", None, None]}
    assert cell(excel, "TV_CONVERT", [[[0, 0]], "m", "mm"], **ask)["value"] == [[0, ""]]
    several = excel.evaluate(
        """async () => {
          standIn.reads = 0;
          const one = ["'My sheet''s'!B2:C2", null, null];
          const cells = Array.from({length: 50}, () => standIn.cell("TV.CONVERT", [[[0, 0]], "m", "mm"], {addresses: one}));
          await Promise.all(cells);
          return standIn.reads;
        }"""
    )
    assert several <= 3
    assert cell(excel, "TV_CONVERT", [[[5, 6]], "m", "m"], **ask)["value"] == [[5, 6]]
    excel.evaluate("standIn.failReads = true")
    shown = cell(excel, "TV_CONVERT", [[[0, 0]], "m", "mm"], **ask)
    assert shown["error"] == "#N/A"
    assert "blank" in shown["message"]


#: Arguments with a zero of which nothing is known, what the host says of their addresses, and the words of the answer.
ZEROS = (
    ([[0, 1]], None, "Argument 1 contains a 0"),  # a host that gives no addresses at all
    (0, None, "Argument 1 contains a 0"),
    ([[0, 1]], ["", "", ""], "the cells of the sheet themselves"),  # a table that was calculated
    ([[0, 1]], [], "the cells of the sheet themselves"),
    ([[0, 1]], ["'My sheet''s'!B3:C3", "", ""], "is not what"),  # another value
    ([[0, 7]], ["'My sheet''s'!B2:C2", "", ""], "is not what"),  # a number where a blank is
    ([[0, 0]], ["'My sheet''s'!B2:B3", "", ""], "is not what"),  # another shape
    ([[0, 0]], ["Nowhere!B2:C2", "", ""], "did not report"),  # no such sheet
)


def test_a_zero_of_which_the_host_tells_nothing_has_no_answer(excel):
    """Neither for a function that is answered at once nor for one that may calculate a start."""
    excel.evaluate(SHEET)
    for name in ("TV_CONVERT", "TV_SN_LIFE"):
        for given, addresses, words in ZEROS:
            shown = cell(excel, name, [given, "m", "mm"], addresses=addresses)
            assert shown["error"] == "#N/A", (name, given, addresses, shown)
            assert words in shown["message"], (name, given, addresses)


def test_a_zero_that_is_none_but_typed_is_one(excel):
    """A single number without an address, where the others have theirs, was typed into the formula."""
    excel.evaluate(SHEET)
    assert cell(excel, "TV_CONVERT", [0, "m", "mm"])["value"] == [[0]]
    assert cell(excel, "TV_CONVERT", [[[0]], "m", "mm"])["value"] == [[0]]
    assert cell(excel, "TV_CONVERT", [[[1, 2]], "m", "mm"], addresses=None)["value"] == [
        [1000, 2000]
    ]
    blank = cell(excel, "TV_CONVERT", [[[0]], "m", "mm"], addresses=["'My sheet''s'!D2", "", ""])
    assert blank.get("value") != [[0]]


def test_a_margin_left_blank_is_never_required_as_nothing(excel):
    """Finding F1: a blank MarginRequired taken for 0 lets every margin pass."""
    stations, elements, case, *rest = model_arguments()
    typed = [row for row in case if row[0] != "MarginRequired"]
    blank, zero = ([*typed, ["MarginRequired", value, "%"]] for value in (None, 0))
    handles = [
        registry.call("TV_MODEL", [stations, elements, c, *rest])[0][0] for c in (blank, zero)
    ]
    assert handles[0] != handles[1]
    shown = cell(excel, "TV_MODEL", [stations, elements, zero, *rest], addresses=None)
    assert shown["error"] == "#N/A", shown


def test_what_is_given_up_is_over_at_once_whatever_the_server_says(tab, served):
    tab.goto("/")
    told = tab.evaluate(
        """async handle => {
            const first = torsionbook.stream({ view: handle });
            await first.done.catch(() => {});  // the line is open now
            WebSocket.prototype.send = () => {};  // and nothing arrives any more
            const second = torsionbook.stream({ view: handle });
            await new Promise(done => setTimeout(done, 50));
            second.cancel();
            return second.done.catch(failed => failed.cancelled);
        }""",
        "tv:none",
    )
    assert told is True


@pytest.mark.first_ones(1)
@pytest.mark.parametrize(
    ("least", "largest"),
    [(100.0, 100.00000000000001), (1e16, 1e16 + 2.0), (0.0, 5e-324), (3.0, 3.0), (-1e308, 1e308)],
)
def test_an_axis_that_shows_nothing_but_noise_comes_to_its_end(tab, least, largest):
    tab.goto("/")
    script = "async ([a, b]) => (await import('/charts.js')).ticks(a, b, 8)"
    assert tab.evaluate(script, [least, largest]) == [least]
    assert tab.evaluate(script, [0.0, 100.0]) == [0, 20, 40, 60, 80, 100]


@pytest.mark.slow
def test_a_long_cell_shows_its_stages_and_can_be_cancelled(excel):
    handle = cell(excel, "TV_MODEL", slow_case())["value"][0][0]
    shown = cell(excel, "TV_PEAKS", [handle], cancelAfter=2500)
    assert shown["cancelled"]
    assert any("start" in text for text in shown["shown"])
    # its process is free again
    other = cell(excel, "TV_MODEL", model_arguments("example_modified"))["value"][0][0]
    assert len(cell(excel, "TV_PEAKS", [other])["value"]) > 2


#: Pauses before a server that does not answer is asked again, as many of them, are a twentieth as long.
QUICK = """const wait = setTimeout;
window.setTimeout = (work, time, ...given) => wait(work, time > 100 ? time / 20 : time, ...given);"""


@pytest.mark.slow
def test_a_server_that_is_gone_is_told(browser):
    with outside() as address:
        context = browser.new_context(base_url=address)
        context.add_init_script(QUICK)
        page = context.new_page()
        office = (HERE / "office_host.js").read_text(encoding="utf-8")
        page.route("https://appsforoffice.microsoft.com/**", lambda r: r.fulfill(body=office))
        page.goto("/taskpane.html")
        handle = cell(page, "TV_MODEL", model_arguments())["value"][0][0]
        assert "value" in cell(page, "TV_PEAKS", [handle])
    for name in ("TV_FREQUENCIES", "TV_PEAKS"):
        shown = cell(page, name, [handle])
        assert shown["error"] == "#N/A"
        assert "server" in shown["message"]
    context.close()


@pytest.mark.slow
def test_the_key_is_asked_for_and_kept(browser, tmp_path):
    keys = tmp_path / "keys"
    keys.write_text(KEY)
    with outside("--api-key-file", str(keys)) as address:
        context = browser.new_context(base_url=address)
        page = context.new_page()
        office = (HERE / "office_host.js").read_text(encoding="utf-8")
        page.route("https://appsforoffice.microsoft.com/**", lambda r: r.fulfill(body=office))
        page.goto("/taskpane.html")
        for name in ("TV_FREQUENCIES", "TV_PEAKS"):
            assert "API key is needed" in cell(page, name, ["tv:0000000000000000"])["message"]
        page.get_by_text("Connection").click()
        page.get_by_label("API key").fill(KEY[1:])
        page.get_by_role("button", name="Keep").click()
        sync_api.expect(page.locator("#progress")).to_contain_text("does not accept this key")
        for name in ("TV_FREQUENCIES", "TV_PEAKS"):
            shown = cell(page, name, ["tv:0000000000000000"])["message"]
            assert "not valid on this server" in shown
        page.get_by_label("API key").fill(KEY)
        page.get_by_role("button", name="Keep").click()
        sync_api.expect(page.locator("#progress")).to_contain_text("the server accepts it")
        page.reload()
        handle = cell(page, "TV_MODEL", model_arguments())["value"][0][0]
        for name in ("TV_FREQUENCIES", "TV_PEAKS"):
            assert "value" in cell(page, name, [handle])
        context.close()


# --- the page -------------------------------------------------------------------------------------


#: What reaches beyond the right edge without a scroll bar of its own.
TOO_WIDE = """[...document.querySelectorAll('body *')].filter(one =>
  one.getBoundingClientRect().right > innerWidth + 1 && !one.closest('.scroll, details:not([open]) form')
).map(one => one.outerHTML.slice(0, 80))"""


#: Tables of which a column lies outside without a look at a scroll bar; drawings of the train and its modes may.
CUT = """[...document.querySelectorAll('.scroll')].filter(one =>
  !['train', 'schematic', 'mode-shape'].includes(one.id) && one.scrollWidth > one.clientWidth + 1).map(one => one.id)"""
#: Height of the smallest letters of the charts, as seen.
SMALLEST = """Math.min(...[...document.querySelectorAll('svg.chart text')].map(one =>
  parseFloat(getComputedStyle(one).fontSize) * one.ownerSVGElement.getBoundingClientRect().width
  / one.ownerSVGElement.viewBox.baseVal.width))"""
#: Sections that lie over one another, and tables over the edge of their section.
OVERLAPS = """(() => {
  const boxes = [...document.querySelectorAll('#results > section')].map(one =>
    [one.querySelector('h2').textContent, one.getBoundingClientRect()]);
  const over = [];
  for (const [a, p] of boxes) for (const [b, q] of boxes)
    if (a < b && p.left < q.right - 1 && q.left < p.right - 1 && p.top < q.bottom - 1 && q.top < p.bottom - 1)
      over.push(`${a} and ${b}`);
  for (const one of document.querySelectorAll('#results table'))
    if (one.getBoundingClientRect().right > one.closest('section').getBoundingClientRect().right + 1)
      over.push(one.closest('section').querySelector('h2').textContent);
  return over;
})()"""


def opened(page, path):
    page.set_input_files("#file", path)


@pytest.mark.slow
def test_the_page_shows_a_model_and_its_start(tab, tmp_path):
    tab.goto("/")
    picture(tab, "empty")
    opened(tab, TEMPLATES / "example_backlash.xlsx")
    sync_api.expect(tab.locator("#progress")).to_contain_text("Calculated in")
    handle = tab.locator("#handle").text_content()
    model = registry.call("TV_MODEL", model_arguments("example_backlash"))[0][0]
    assert handle == model
    head, *rows = registry.call("TV_FREQUENCIES", [model])
    shown = tab.locator("#frequencies tbody tr")
    assert shown.count() == len(rows)
    frequency = head.index("Frequency [Hz]")
    third = shown.nth(3).locator("td").nth(frequency).text_content()
    assert float(third.replace(",", "")) == pytest.approx(rows[3][frequency], rel=1e-4)
    discs = tab.locator("#train rect.disc").count()
    words = tab.locator("#schematic text").all_text_contents()
    assert {"Motor", "HS coupling"} <= {*words}
    assert tab.locator("#schematic polygon").count() > len(words)
    assert discs == len([row for row in model_arguments("example_backlash")[0][2:] if row[0]])
    assert tab.locator("#histories svg").count() >= 2
    for chart in ("#interference", "#torque", "#speed"):
        assert tab.locator(f"{chart} svg path.line").count() >= 1
    assert tab.locator("#verdicts td.fail, #verdicts td.pass").count() >= 3
    picture(tab, "wide")
    # whole starts in the verdict and in the table
    governing = tab.locator("#starts tbody tr", has_text="HP compressor shaft")
    verdict = tab.locator("#verdicts tr", has_text="Allowable starts").locator("td").nth(1)
    assert verdict.text_content() == governing.locator("td").nth(2).text_content()
    assert tab.locator("#reversals tbody tr").count() == 1
    assert tab.locator("#shapes tbody tr").count() == discs
    assert tab.locator("#steady td.fail, #steady td.pass").count() >= 1


@pytest.mark.slow
def test_what_is_shown_fits_a_pane_and_a_page_of_paper(tab):
    tab.goto("/")
    opened(tab, TEMPLATES / "example_backlash.xlsx")
    sync_api.expect(tab.locator("#progress")).to_contain_text("Calculated in")
    for width in (350, 800, 1100, 1400):
        tab.set_viewport_size({"width": width, "height": 900})
        tab.wait_for_timeout(400)  # charts are drawn anew
        assert tab.evaluate(TOO_WIDE) == []
        assert tab.evaluate(CUT) == [], width
        assert tab.evaluate(SMALLEST) >= 10.0, width
        assert tab.evaluate(OVERLAPS) == [], width
        picture(tab, f"at_{width}")
    tab.set_viewport_size({"width": 350, "height": 900})
    tab.wait_for_timeout(400)
    heights = tab.locator("#frequencies tbody tr").evaluate_all(
        "rows => rows.map(row => [row.innerText, row.getBoundingClientRect().height])"
    )
    assert max(height for _, height in heights) < 75, heights
    tab.locator("#margins").get_by_role("button", name="All columns").click()
    assert tab.locator("#margins th", has_text="Required").is_visible()
    # A4 less its margins, as before printing from a narrow pane
    tab.set_viewport_size({"width": 703, "height": 1016})
    tab.wait_for_timeout(400)
    tab.evaluate("dispatchEvent(new Event('beforeprint'))")
    tab.emulate_media(media="print")
    assert not tab.locator("#actions").is_visible()
    assert tab.evaluate(OVERLAPS) == []
    assert tab.evaluate(SMALLEST) >= 10.0
    picture(tab, "print")


@pytest.mark.slow
def test_the_workbook_comes_back_recalculated(tab, tmp_path):
    import openpyxl

    tab.goto("/")
    opened(tab, TEMPLATES / "example_proposed.xlsx")
    sync_api.expect(tab.locator("#progress")).to_contain_text("Calculated in")
    with tab.expect_download() as download:
        tab.get_by_role("button", name="Recalculated workbook").click()
    assert download.value.suggested_filename == "example_proposed.out.xlsx"
    download.value.save_as(tmp_path / "out.xlsx")
    book = openpyxl.load_workbook(tmp_path / "out.xlsx", data_only=True)
    assert any("StartupPeaks" in sheet.tables for sheet in book)


@pytest.mark.slow
def test_a_calculation_shows_progress_and_stops_when_cancelled(tab, tmp_path):
    import json

    from addin.reading.case_json import case_to_json
    from addin.reading.workbook import read_workbook

    case = case_to_json(read_workbook(TEMPLATES / "example_backlash.xlsx").data)
    (tmp_path / "slow.json").write_text(json.dumps({**case, **SLOW_CASE}))
    tab.goto("/")
    opened(tab, tmp_path / "slow.json")
    sync_api.expect(tab.locator("#progress")).to_contain_text("start")
    assert tab.locator("#frequencies tbody tr").count() > 3  # what needs no start is there already
    picture(tab, "waiting")
    tab.get_by_role("button", name="Cancel").click()
    sync_api.expect(tab.locator("#progress")).to_contain_text("Cancelled")
    assert tab.get_by_role("button", name="Calculate the start").is_enabled()
    assert tab.locator("#peaks").text_content() == "Not calculated yet."


@pytest.mark.slow
def test_wrong_cells_are_listed(tab, tmp_path):
    import openpyxl

    book = openpyxl.load_workbook(TEMPLATES / "example_proposed.xlsx")
    train = book["Train"]
    for name, column in (("Stations", "Inertia"), ("Elements", "Stiffness")):
        header = next(iter(train[train.tables[name].ref]))
        found = next(cell for cell in header if cell.value == column)
        train.cell(found.row + 1, found.column).value = -5
    book.save(tmp_path / "wrong.xlsx")
    tab.goto("/")
    opened(tab, tmp_path / "wrong.xlsx")
    sync_api.expect(tab.locator("#problems li")).to_have_count(2)
    assert "Inertia" in tab.locator("#problems li").first.text_content()
    assert not tab.locator("#results").is_visible()
    picture(tab, "errors")


@pytest.mark.slow
def test_inside_office_the_open_workbook_is_taken(excel):
    source = base64.b64encode((TEMPLATES / "example_modified.xlsx").read_bytes()).decode()
    excel.evaluate(
        "coded => { standIn.workbook = Uint8Array.from(atob(coded), c => c.charCodeAt(0)); }",
        source,
    )
    excel.set_viewport_size({"width": 360, "height": 800})
    excel.get_by_role("button", name="Use the open workbook").click()
    sync_api.expect(excel.locator("#progress")).to_contain_text("Calculated in")
    assert (
        excel.locator("#handle").text_content()
        == registry.call("TV_MODEL", model_arguments("example_modified"))[0][0]
    )
    assert excel.evaluate("standIn.closed")
    picture(excel, "pane")
    excel.evaluate("standIn.workbook = null")
    excel.get_by_role("button", name="Use the open workbook").click()
    sync_api.expect(excel.locator("#progress")).to_contain_text("did not provide the workbook")
