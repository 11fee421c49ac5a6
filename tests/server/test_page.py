"""The page in a browser: charts to look into, numbers changed in it, what is made of a file, and who can use it."""

import math
from pathlib import Path

import numpy as np
import pytest
from sheet_ranges import TEMPLATES, model_arguments

from addin.worksheet import registry

sync_api = pytest.importorskip("playwright.sync_api")  # not under Wine

pytestmark = pytest.mark.needs_browser
#: Starts share the machine with other tests, and the first one waits for its process. [ms]
sync_api.expect.set_options(timeout=120_000)

AXE = Path(__file__).parent / "office_tools" / "node_modules" / "axe-core" / "axe.min.js"
#: What a chart of the page shows: range of its axis, and what is said of the cursor.
FRAMES = """[...document.querySelectorAll('#speed figure, #histories figure')].map(one => {
  const { x0, x1 } = one.querySelector('svg').frame;
  return [x0, x1, one.querySelector('.reading').textContent];
})"""

#: Tables of a document that go on beyond its edge.
OVER_THE_EDGE = """[...document.querySelectorAll('#document .scroll')]
  .filter(one => one.scrollWidth > one.clientWidth).length"""


def opened(page, name="example_modified"):
    page.goto("/")
    page.set_input_files("#file", TEMPLATES / f"{name}.xlsx")
    calculated(page)


def calculated(page):
    sync_api.expect(page.locator("#progress")).to_contain_text("Calculated in")


def handle_of(arguments):
    return registry.call("TV_MODEL", arguments)[0][0]


def tabbed_to(page, selector, most=60):
    """Go on by the Tab key alone until something has the focus."""
    for _ in range(most):
        page.keyboard.press("Tab")
        if page.evaluate("s => document.activeElement.matches(s)", selector):
            return
    raise AssertionError(f"{selector} is not reached by the Tab key")


@pytest.mark.slow
def test_keys_alone_open_an_example_and_read_a_history_to_its_last_digit_shown(tab):
    tab.goto("/")
    sync_api.expect(tab.locator("#examples button")).to_have_count(5)
    tabbed_to(tab, "#examples li:nth-child(2) button")
    tab.keyboard.press("Enter")
    calculated(tab)
    assert tab.locator("#handle").text_content() == handle_of(model_arguments("example_modified"))
    tabbed_to(tab, "#choice summary")
    tab.keyboard.press("Enter")
    tabbed_to(tab, "#choice-list input[value='LS coupling']")
    tab.keyboard.press("Space")
    coupling = tab.locator("#histories figure", has_text="LS coupling: torque")
    sync_api.expect(coupling).to_have_count(1)
    whole = tab.evaluate(FRAMES)
    tabbed_to(tab, "#histories figure:last-child .picture")
    for key in ("ArrowRight", "+", "+", "+", "+", "+", "ArrowRight", "ArrowRight"):
        tab.keyboard.press(key)
    tab.wait_for_timeout(800)  # the histories of the window come
    frames = tab.evaluate(FRAMES)
    ranges = {(x0, x1) for x0, x1, _ in frames}
    assert len(ranges) == 1, "one axis of time"
    ((begin, end),) = ranges
    assert end - begin == pytest.approx((whole[0][1] - whole[0][0]) / 32)
    head, *rows = registry.call(
        "TV_HISTORY", [handle_of(model_arguments("example_modified")), "LS coupling", 20_000]
    )
    time, torque = np.array(rows, dtype=float).T
    inside = torque[(time >= begin) & (time <= end)]
    words = coupling.locator(".reading").text_content()
    at, value = (float(w.split()[-2].replace(",", "")) for w in words.split(" · "))
    assert "lbf" in words
    assert "lbf" in head[1]
    # the time is said to a ten-thousandth of what is seen; the torque as it is there
    moment = (end - begin) / 500
    near = np.interp(np.linspace(at - moment, at + moment, 41), time, torque)
    room = np.ptp(inside) / 100
    assert near.min() - room <= value <= near.max() + room
    drawn = coupling.locator("path.line").get_attribute("d")
    assert drawn.count("L") > 60, "points of the window, not those of the whole"
    tab.keyboard.press("0")
    assert [f[:2] for f in tab.evaluate(FRAMES)] == [f[:2] for f in whole]


@pytest.mark.slow
def test_a_changed_number_is_calculated_and_stays_over_a_reload_and_goes_back(tab):
    opened(tab)
    stations, elements, *rest = model_arguments("example_modified")
    row = next(i for i, line in enumerate(elements) if line[0] == "LS coupling")
    column = next(line for line in elements if "Stiffness" in line).index("Stiffness")
    before = handle_of([stations, elements, *rest])
    assert tab.locator("#handle").text_content() == before
    tab.locator("#inputs > summary").click()
    tab.get_by_text("Elements (", exact=False).click()
    cell = tab.get_by_label("Stiffness of LS coupling")
    assert float(cell.input_value()) == elements[row][column]
    cell.fill("1,5")
    cell.press("Enter")
    sync_api.expect(tab.locator("#progress")).to_contain_text("Use a decimal point")
    assert cell.get_attribute("aria-invalid") == "true"
    cell.fill("2.5e8")
    cell.press("Enter")
    elements = [list(line) for line in elements]
    elements[row][column] = 2.5e8
    after = handle_of([stations, elements, *rest])
    sync_api.expect(tab.locator("#handle")).to_have_text(after)
    calculated(tab)
    head, *rows = registry.call("TV_FREQUENCIES", [after])
    shown = tab.locator("#frequencies tbody tr").nth(1).locator("td").nth(1).text_content()
    assert float(shown) == pytest.approx(rows[1][head.index("Frequency [Hz]")], rel=1e-4)
    tab.locator("#tools > summary").click()
    tab.get_by_role("button", name="Compare with the file as opened").click()
    sync_api.expect(tab.locator("#progress")).to_contain_text("Compared")
    assert "2.5e+08" in tab.locator("#document tr", has_text="LS coupling").first.text_content()
    tab.get_by_label("Colours").select_option("dark")
    # a row that is typed, but not entered, stays over the reload as well
    materials = tab.locator("[data-table=Materials]")
    materials.locator("summary").click()
    materials.get_by_role("button", name="Add a row").click()
    tab.keyboard.type("Second steel")
    tab.wait_for_timeout(200)  # it is kept
    tab.reload()
    calculated(tab)
    assert tab.locator("#handle").text_content() == after
    assert tab.evaluate("document.documentElement.dataset.theme") == "dark"
    tab.locator("#inputs > summary").click()
    sync_api.expect(tab.get_by_label("Material of the new row")).to_have_value("Second steel")
    tab.get_by_label("Material of the new row").focus()
    tabbed_to(tab, "[data-column=UTS]")
    tab.keyboard.type("much")
    tab.keyboard.press("Enter")
    sync_api.expect(tab.locator("#progress")).to_contain_text("'much' is no number")
    tab.keyboard.press("Control+A")
    tab.keyboard.type("100000")
    tabbed_to(tab, "[data-table=Materials] button")
    tab.keyboard.press("Enter")
    sync_api.expect(materials.locator("summary")).to_contain_text("2 rows")
    sync_api.expect(materials.get_by_role("button", name="Add a row")).to_be_focused()
    assert tab.get_by_label("UTS of Second steel").input_value() == "100000"
    materials.get_by_role("button", name="Remove Second steel").focus()
    tab.keyboard.press("Space")
    sync_api.expect(materials.locator("summary")).to_contain_text("1 row")
    sync_api.expect(materials.get_by_role("button", name="Remove Alloy steel")).to_be_focused()
    sync_api.expect(tab.locator("#handle")).to_have_text(after)
    tab.get_by_role("button", name="Back to the file as opened").click()
    sync_api.expect(tab.locator("#handle")).to_have_text(before)
    calculated(tab)
    tab.get_by_role("button", name="Close the file").click()
    sync_api.expect(tab.locator("#progress")).to_contain_text("nothing of it is kept")
    tab.reload()
    sync_api.expect(tab.locator("#examples")).to_be_visible()
    assert not tab.locator("#results").is_visible()


@pytest.mark.slow
def test_a_file_dropped_anywhere_is_verified_and_studied_and_its_mode_shapes_move(tab):
    tab.goto("/")
    tab.evaluate(
        """async () => {
          const bytes = await (await fetch("/examples/example_studies.xlsx")).arrayBuffer();
          const dropped = new DataTransfer();
          dropped.items.add(new File([bytes], "my train.xlsx"));
          document.querySelector("footer").dispatchEvent(
            new DragEvent("drop", { bubbles: true, cancelable: true, dataTransfer: dropped }));
        }"""
    )
    calculated(tab)
    tab.locator("#tools > summary").click()
    tab.get_by_role("button", name="Verify the results").click()
    sync_api.expect(tab.locator("#document")).to_contain_text("my train.xlsx: ")
    tab.get_by_label("Study", exact=True).select_option("tolerances")
    tab.locator("#study-inputs > summary").click()
    tab.get_by_label("samples").fill("9")
    tab.get_by_label("seed").fill("7")
    sync_api.expect(tab.locator("#progress")).to_contain_text("samples must be a whole number")
    tab.get_by_label("samples").fill("30")
    scatter = tab.locator("[data-table=Scatter]")
    scatter.locator("summary").click()
    before = scatter.get_by_role("button", name="Remove").count()
    scatter.get_by_role("button", name="Remove").last.click()
    sync_api.expect(scatter.get_by_role("button", name="Remove")).to_have_count(before - 1)
    calculated(tab)
    tab.get_by_role("button", name="Run the study").click()
    sync_api.expect(tab.locator("#progress")).to_contain_text("The study is done")
    assert tab.locator("#document a").get_attribute("download") == "my train.tolerances.xlsx"
    sync_api.expect(tab.locator("#document")).to_contain_text("30 samples of")
    sync_api.expect(tab.locator("#document")).to_contain_text("seed 7")
    with tab.expect_download(timeout=120_000) as report:
        tab.get_by_role("button", name="Report for Word").click()
    assert report.value.suggested_filename == "my train.docx"
    earlier = {"name": "r0.xlsx", "mimeType": "", "buffer": b"no workbook"}
    tab.locator("#earlier").set_input_files(earlier)
    sync_api.expect(tab.locator("#problems")).to_contain_text("earlier.json is not JSON")
    tab.locator("#earlier").set_input_files(TEMPLATES / "example_modified.xlsx")
    sync_api.expect(tab.locator("#document")).to_contain_text("Verdict before")
    tab.set_viewport_size({"width": 320, "height": 900})
    assert tab.evaluate(OVER_THE_EDGE) == 0, "on a narrow page each cell stands below the other"
    tab.set_viewport_size({"width": 1280, "height": 900})
    curve = tab.locator("#motion path.line")
    largest = curve.get_attribute("d")
    tab.get_by_role("button", name="Move", exact=True).click()
    sync_api.expect(curve).not_to_have_attribute("d", largest)
    tab.get_by_role("button", name="Stop").click()
    assert curve.get_attribute("d") == largest
    # the curve is that of the table: of each station its twist
    twists = [float(t) for t in tab.locator("#shapes td:nth-child(2)").all_text_contents()]
    heights = [float(point.split(" ")[1]) for point in largest[1:].replace("M", "L").split("L")]
    scale = (max(heights) - min(heights)) / (max(twists) - min(twists))
    assert all(
        math.isclose(heights[0] - h, scale * (t - twists[0]), abs_tol=0.3)
        for h, t in zip(heights, twists, strict=True)
    )


@pytest.mark.slow
def test_axe_finds_nothing_at_three_widths_and_in_dark(tab):
    if not AXE.is_file():
        pytest.skip("the Office tools are not installed")
    tab.goto("/")
    tab.context.new_cdp_session(tab).send("Runtime.evaluate", {"expression": AXE.read_text()})
    found = {"empty": violations(tab)}
    tab.set_input_files("#file", TEMPLATES / "example_backlash.xlsx")
    calculated(tab)
    tab.locator("#inputs > summary").click()
    sync_api.expect(tab.locator("#tables summary").first).to_be_visible()
    for summary in tab.locator("#tables summary").all()[:2]:
        summary.click()
    tab.locator("#tables").get_by_role("button", name="Add a row").first.click()
    tab.locator("#tools > summary").click()
    tab.get_by_label("Study", exact=True).select_option("tolerances")
    tab.locator("#study-inputs > summary").click()
    tab.locator("[data-table=Scatter] summary").click()  # rows that the file lacks
    sync_api.expect(tab.get_by_label("Spread of 1")).to_have_value("5")
    tab.locator("#choice summary").click()
    # contrast does not depend on the width, so that the dark colours are looked at once
    for width, colours in ((320, "light"), (768, "light"), (1440, "light"), (1440, "dark")):
        tab.set_viewport_size({"width": width, "height": 900})
        tab.get_by_label("Colours").select_option(colours)
        tab.wait_for_timeout(400)
        found[f"{width} {colours}"] = violations(tab)
        assert tab.evaluate("document.documentElement.scrollWidth") <= width
    assert found == dict.fromkeys(found, [])


def violations(page):
    return page.evaluate(
        "async () => (await axe.run()).violations.map(v => `${v.id}: ${v.nodes[0].html.slice(0, 120)}`)"
    )
