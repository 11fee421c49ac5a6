"""The notebooks of docs/ say what they print, and their numbers agree with the paper."""

import json
import re
from pathlib import Path

import pytest
from script_modules import script_module

ROOT = Path(__file__).resolve().parents[2]
NOTEBOOKS = sorted((ROOT / "docs" / "notebooks").glob("*.ipynb"))


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_prints_what_it_shows(path):
    script = script_module("notebook")
    notebook = json.loads(path.read_text(encoding="utf-8"))
    cells = script.code_cells(notebook)
    assert len(cells) >= 5
    assert script.printed(notebook) == [script.kept(cell) for cell in cells]


def test_the_tuned_coupling_begins_at_the_frequencies_of_the_paper():
    """Table 1 of Szenasi and von Nimitz (1978), whose numbers are whole: 30, 53 and 86 Hz as proposed."""
    text = (ROOT / "docs" / "notebooks" / "tuned_coupling.ipynb").read_text(encoding="utf-8")
    first = re.search(r"\[([\d., ]+)\] Hz", text)
    assert first is not None
    assert [round(float(hertz)) for hertz in first[1].split(",")] == [30, 53, 86]
