"""The page as Office loads it, in a browser: the Office host is played by a stand-in."""

import shutil
from pathlib import Path
from typing import Any

from addin.server.office import function_id

__all__ = ["cell", "launched", "load_in_office"]

HERE = Path(__file__).parent


def launched(playwright: Any) -> Any:
    """A headless Chromium."""
    names = ("chromium", "chromium-browser", "google-chrome", "chrome")
    program = next((found for found in map(shutil.which, names) if found), None)
    return playwright.chromium.launch(executable_path=program, args=["--no-sandbox"])


def load_in_office(page: Any) -> None:
    """Open the task pane with the stand-in of the Office host."""
    office = (HERE / "office_host.js").read_text(encoding="utf-8")
    page.route(
        "https://appsforoffice.microsoft.com/**",
        lambda route: route.fulfill(body=office, content_type="text/javascript"),
    )
    page.goto("/taskpane.html")


def cell(page: Any, name: str, given: list[Any], **more: Any) -> Any:
    """What a cell with a function shows: its value or its error."""
    return page.evaluate(
        "([id, given, more]) => standIn.cell(id, given, more)", [function_id(name), given, more]
    )
