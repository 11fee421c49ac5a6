"""Links in the docs lead to files and headings that are there."""

import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def anchor(heading: str) -> str:
    """The anchor that a forge makes of a heading."""
    return re.sub(r"[^\w\- ]", "", heading.strip().lower()).replace(" ", "-")


def test_links_in_the_docs_lead_somewhere():
    lost = []
    for page in (*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.md")):
        for link in re.findall(r"\]\(([^)\s]+)\)", page.read_text(encoding="utf-8")):
            file, _, part = link.partition("#")
            target = page.parent / file if file else page
            if re.match(r"\w+:", link):
                continue
            headings = []
            if target.suffix == ".md" and target.is_file():
                text = target.read_text(encoding="utf-8")
                headings = [anchor(found) for found in re.findall(r"^#+ (.*)$", text, re.MULTILINE)]
            if not target.exists() or (part and target.suffix == ".md" and part not in headings):
                lost.append(f"{page.name}: {link}")
    assert lost == []
