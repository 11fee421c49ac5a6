"""No published case is left off the page docs/validation.md without a reason."""

import json
import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
CASES = ROOT / "tests" / "validation" / "cases"
#: Cases with published numbers that have no row there, and why.
NO_ROW = {
    "A05": "the paper's Table 1, with the paper's sample case",
    "B01": "has a row, from the file of its history",
    "F04": "six finite elements: what is printed is their error",
    "M04b": "frequencies quoted from memory of the paper",
    "M10": "tables of Holzer's method, no frequencies",
    "M11": "the book's numbers were not seen",
}


def test_every_published_case_has_a_row():
    script = (ROOT / "scripts" / "validation_page.py").read_text(encoding="utf-8")
    shown = set(re.findall(r'"([A-Z]+\d+b?)(?:_\w+)?"', script))
    published = {
        path.stem.split("_")[0]
        for path in CASES.glob("*.json")
        if json.loads(path.read_text(encoding="utf-8")).get("published")
    }
    assert len(published) > 20
    assert published - shown - set(NO_ROW) == set()
    assert set(NO_ROW) <= published, "a reason without its case"
    assert not set(NO_ROW) & shown, "a reason for a case that has a row"
