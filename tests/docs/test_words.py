"""The pages that people write stay short enough to be read: issue 18 asks for 40,000 words in all."""

import re
from pathlib import Path

DOCS = Path(__file__).resolve().parents[2] / "docs"
#: What issue 18 asks for. [words]
MOST = 40_000
#: In the first lines of a page that a program writes.
MADE = re.compile(r"\bMade (?:by|from)\b|^`python -m benchmarks", re.MULTILINE)


def words(text: str) -> int:
    """Words of a page: code, equations, targets of links, rules of tables and what is derived from the records do not count."""
    text = re.sub(r"(?s)<!-- made from.*?<!-- end.*?-->", "", text)
    text = re.sub(r"(?ms)^ *\$\$$.*?^ *\$\$$", "", text)
    text = re.sub(r"(?ms)^```.*?^```$", "", text)
    text = re.sub(r"(?m)(?<=\n\n)(?:    .*\n)+", "", text)
    text = re.sub(r"\]\([^)]*\)", "]", text)
    return sum(bool(re.search(r"\w", word)) for word in text.split())


def written_by_hand() -> dict[str, str]:
    pages = {path.name: path.read_text(encoding="utf-8") for path in DOCS.glob("*.md")}
    return {
        name: text
        for name, text in pages.items()
        if not MADE.search("\n".join(text.splitlines()[:5]))
    }


def test_pages_written_by_hand_are_short_enough():
    pages = written_by_hand()
    assert {"motor.md", "claims.md"} < set(pages)
    assert not {"functions.md", "results-start.md", "benchmarks.md", "batch-speed.md"} & set(pages)
    longest = sorted(pages, key=lambda name: -words(pages[name]))
    counts = ", ".join(f"{name} {words(pages[name])}" for name in longest[:5])
    total = sum(map(words, pages.values()))
    assert total <= MOST, f"{total} words; the longest pages: {counts}"


def test_words_are_counted():
    text = "| a | b |\n|---|--:|\n\nSee [the page](long/address.md) of\n\n$$\nx = y\n$$\n\n```python\nx = 1\n```\n\n    make demo\n\nit, 5 %.\n"
    assert words(text) == 8
