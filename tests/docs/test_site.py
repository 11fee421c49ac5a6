"""The site of `make docs`: every link leads somewhere, every picture is there, nothing is fetched, search works from a folder."""

import os
import re
import shutil
import subprocess
import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

import pytest
from office_page import launched
from playwright import sync_api as playwright

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    """The site, built in a folder of its own."""
    folder = tmp_path_factory.mktemp("docs")
    shutil.copy(ROOT / "mkdocs.yml", folder)
    shutil.copytree(ROOT / "docs", folder / "docs")
    words = [str(Path(sys.executable).with_name("zensical")), "build", "--strict"]
    paths = os.environ | {"PYTHONPATH": str(ROOT / "scripts")}
    done = subprocess.run(words, cwd=folder, env=paths, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    return folder / "build" / "site"


class Page(HTMLParser):
    """What a page links to, loads, and can be linked to by."""

    def __init__(self, path: Path) -> None:
        super().__init__()
        self.links: list[str] = []
        self.loads: list[str] = []
        self.anchors: set[str] = set()
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag, attrs):
        named = dict(attrs)
        self.anchors |= {named[key] for key in ("id", "name") if named.get(key)}
        if tag == "a" and named.get("href"):
            self.links.append(named["href"])
        if tag in ("img", "script", "link") and named.get("rel") != "canonical":
            self.loads += [named[key] for key in ("src", "href") if named.get(key)]


def wrong_links(site):
    pages = {path: Page(path) for path in site.rglob("*.html") if path.name != "404.html"}
    assert len(pages) >= 30
    for path, page in pages.items():
        for link in [*page.links, *page.loads]:
            parts = urlsplit(link)
            if parts.scheme or parts.netloc:
                if link in page.loads:
                    yield f"{path.name} fetches {link}"
                continue
            target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            if not target.is_file():
                yield f"{path.name}: {link} is not there"
            elif parts.fragment and target in pages:
                if unquote(parts.fragment) not in pages[target].anchors:
                    yield f"{path.name}: {link} has no such heading"


def test_every_link_and_picture_is_there_and_nothing_is_fetched(site):
    assert list(wrong_links(site)) == []


def test_a_missing_picture_and_a_fetched_script_are_found(site, tmp_path):
    broken = tmp_path / "site"
    shutil.copytree(site, broken)
    (broken / "images" / "summary.png").unlink()
    page = broken / "motor.html"
    text = page.read_text(encoding="utf-8")
    more = (
        '<script src="https://example.org/x.js"></script><a href="theory-start.html#no-such">x</a>'
    )
    page.write_text(text.replace("</body>", f"{more}</body>"), encoding="utf-8")
    found = set(wrong_links(broken))
    assert "index.html: images/summary.png is not there" in found
    assert "motor.html fetches https://example.org/x.js" in found
    assert "motor.html: theory-start.html#no-such has no such heading" in found


def test_every_page_of_docs_is_in_the_menu():
    listed = re.findall(r"- ([\w-]+\.md)$", (ROOT / "mkdocs.yml").read_text(), re.MULTILINE)
    assert sorted(listed) == sorted(path.name for path in (ROOT / "docs").glob("*.md"))


@pytest.mark.needs_browser
def test_search_works_where_the_pages_are_opened_from_a_folder(site):
    with playwright.sync_playwright() as driver:
        browser = launched(driver)
        page = browser.new_page()
        asked = []
        page.on("request", lambda request: asked.append(request.url))
        page.goto((site / "index.html").as_uri())
        page.wait_for_load_state("networkidle")
        page.keyboard.press("Control+k")
        page.keyboard.type("fluid coupling")
        page.get_by_text("a fluid coupling or a torque converter?").first.wait_for(timeout=20_000)
        browser.close()
    assert [url for url in asked if not url.startswith(("file:", "blob:", "data:"))] == []


def test_every_equation_is_set(site):
    """None is left as typed, and none has a command that the converter does not know."""
    equations = 0
    for path in site.rglob("*.html"):
        text = path.read_text(encoding="utf-8")
        equations += text.count("<math ")
        prose = re.sub(r"(?s)<(pre|code|script)\b.*?</\1>", "", text)
        left = re.findall(r"\$[^$\n<]*\\[^$\n<]*\$|\$\$|<m[io]>(?:\\[a-z]+|&amp;|&)</m[io]>", prose)
        assert not left, (path.name, left)
    assert equations > 50
