"""One server for all tests of this folder, inside the test process and outside."""

from collections.abc import Iterator
from typing import Any

import pytest
from office_page import launched
from servers import SLOW_PROGRAM, inside, outside
from starlette.testclient import TestClient

from addin.server.settings import Settings


@pytest.fixture(scope="session")
def client() -> Iterator[TestClient]:
    """A client of a server with the usual settings."""
    with inside(Settings(workers=1)) as client:
        yield client


@pytest.fixture(scope="session")
def served() -> Iterator[str]:
    """The address of a server in a process of its own, in which some starts last minutes."""
    with outside(program=SLOW_PROGRAM) as address:
        yield address


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    from playwright import sync_api

    with sync_api.sync_playwright() as playwright:
        browser = launched(playwright)
        yield browser
        browser.close()


@pytest.fixture
def tab(browser, served):
    """An empty page of a fresh browser profile; whatever it complains of fails the test."""
    context = browser.new_context(base_url=served, viewport={"width": 1280, "height": 900})
    context.set_default_timeout(20_000)
    page = context.new_page()
    complaints = []
    page.on("pageerror", lambda failed: complaints.append(str(failed)))
    page.on(
        "console",
        lambda said: "Content Security Policy" in said.text and complaints.append(said.text),
    )
    yield page
    context.close()
    assert complaints == []
