"""`scripts/compare_trees.py`: what two records may differ in, and what it must notice."""

from __future__ import annotations

import io
import json
import re
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from script_modules import SCRIPTS, script_module

trees, driver, cases = map(script_module, ("compare_trees", "compare_driver", "compare_cases"))

RESULTS: dict[str, Any] = {
    "format": 1,
    "version": "0.1.0",
    "warnings": ["The start is cut off after 3 s."],
    "natural_frequencies": [{"mode": 1, "frequency": 30.000000001}],
    "effects": [{"effect": "bearings", "bound": 0.25, "time": 0.004}],
    "audit": [
        {"item": "Software", "value": "torsionbook 0.1.0"},
        {"item": "Time spent: modes", "value": "1.4 ms"},
        {"item": "Required margin", "value": "20 %"},
    ],
    "errors": [
        {
            "sheet": "Train", "table": "Elements", "row": 3, "column": "SCF", "found": 0.5,
            "allowed": "1 or more", "message": "found 0.5; it must be 1 or more.",
        },
    ],
}  # fmt: skip

SHEET = (
    '<worksheet xmlns="http://schemas.openxmlformats.org/spreadsheetml/2006/main"><sheetData>'
    '<row r="3"><c r="B3" t="inlineStr"><is><t>Effect</t></is></c>'
    '<c r="C3" t="inlineStr"><is><t>Bound</t></is></c>'
    '<c r="D3" t="inlineStr"><is><t>Time</t></is></c></row>'
    '<row r="4"><c r="B4" t="inlineStr"><is><t>bearings</t></is></c>'
    '<c r="C4"><v>0.25</v></c><c r="D4"><v>4.1</v></c></row>'
    "</sheetData></worksheet>"
)
TABLE = (
    '<table xmlns="http://schemas.openxmlformats.org/spreadsheetml/2006/main" name="Effects" '
    'ref="B3:D4"><tableColumns><tableColumn id="1" name="Effect"/><tableColumn id="2" name="Bound"/>'
    '<tableColumn id="3" name="Time"/></tableColumns></table>'
)
RELATIONS = (
    '<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">'
    '<Relationship Id="rId1" Type="t" Target="../tables/table1.xml"/></Relationships>'
)


def made(folder: Path, results: dict[str, Any], sheet: str = SHEET) -> Any:
    """A record of one job that left a result JSON and a workbook."""
    book = io.BytesIO()
    with zipfile.ZipFile(book, "w") as archive:
        archive.writestr("xl/worksheets/sheet1.xml", sheet)
        archive.writestr("xl/worksheets/_rels/sheet1.xml.rels", RELATIONS)
        archive.writestr("xl/tables/table1.xml", TABLE)
    (folder / "jobs").mkdir(parents=True)
    (folder / "case.results.json").write_text(json.dumps(results, indent=1))
    (folder / "case.out.xlsx").write_bytes(book.getvalue())
    files = {
        name: driver.recorded(folder / name, folder / "blobs")
        for name in ("case.results.json", "case.out.xlsx")
    }
    job = {"name": "a", "commands": [], "statuses": [0], "inputs": {}, "files": files}
    (folder / "jobs" / "a.json").write_text(json.dumps(job))
    return trees.Record(folder)


def compared(
    tmp_path: Path,
    change: Callable[[dict[str, Any]], object] = lambda results: None,
    sheet: str = SHEET,
    **sentences: list[dict[str, str]],
) -> Any:
    """The comparison of the results above with changed ones."""
    results = json.loads(json.dumps(RESULTS))
    change(results)
    old, new = made(tmp_path / "old", RESULTS), made(tmp_path / "new", results, sheet)
    return trees.compare(old, new, trees.Sentences(sentences))


def warned(text: str) -> Callable[[dict[str, Any]], object]:
    return lambda results: results.update(warnings=[text])


def test_equal_records_pass_and_are_counted(tmp_path):
    found = compared(tmp_path)
    assert trees.passes(found)
    assert found.counts["files"] == 2
    assert found.counts["numbers"] >= 6
    assert not found.aside


def test_one_bit_of_one_number_fails(tmp_path):
    other = float(trees.flipped("30.000000001"))
    assert other != 30.000000001
    assert abs(other / 30.000000001 - 1.0) < 3e-16
    found = compared(tmp_path, lambda r: r["natural_frequencies"][0].update(frequency=other))
    assert len(found.differences) == 1
    assert "natural_frequencies.0.frequency" in found.differences[0]


def test_one_bit_of_a_cell_fails(tmp_path):
    found = compared(tmp_path, sheet=SHEET.replace("0.25", "0.25000000000000006"))
    assert len(found.differences) == 1
    assert "C4" in found.differences[0]


def test_a_template_lets_words_change_and_no_number():
    templates = [("of {…} starts {…} are told", "{…} starts, {…} are reported")]
    sentences = trees.Sentences({}, templates)
    old = "Note: of 12 starts 3 are told."
    assert sentences.allow(old, "Note: 12 starts, 3 are reported.")
    assert not sentences.allow(old, "Note: 12 starts, 4 are reported.")
    assert [e.used for e in sentences.entries] == [1]


def test_times_and_the_version_are_set_aside(tmp_path):
    def change(results):
        results["version"] = "0.2.0"
        results["effects"][0]["time"] = 0.7
        results["audit"][0]["value"] = "torsionbook 0.2.0"
        results["audit"][1]["value"] = "9.9 ms"

    found = compared(tmp_path, change, SHEET.replace("4.1", "700.2"))
    assert trees.passes(found), found.differences
    assert found.aside["version"] == 2
    assert found.aside["time"] == 3


@pytest.mark.parametrize(
    "change",
    [
        lambda r: r["audit"][2].update(value="10 %"),
        lambda r: r["effects"][0].update(bound=0.26),
        lambda r: r["effects"][0].update(time="long"),
        lambda r: r["effects"][0].pop("time"),
        lambda r: r.update(format=1.0),
        lambda r: r["natural_frequencies"].append({"mode": 2}),
        lambda r: r["warnings"].clear(),
    ],
)
def test_anything_else_fails(tmp_path, change):
    assert len(compared(tmp_path, change).differences) == 1


def test_a_sentence_needs_the_list(tmp_path):
    changed = warned("The start ends after 3 s.")
    assert not trees.passes(compared(tmp_path / "a", changed))
    one = {"old": "The start is cut off after 3 s.", "new": "The start ends after 3 s."}
    found = compared(tmp_path / "b", changed, string=[one])
    assert trees.passes(found)
    assert found.sentences.entries[0].used == 1


def test_a_pattern_keeps_its_numbers(tmp_path):
    one = {"old": r"The start is cut off after (\d+) s\.", "new": r"The start ends after \1 s."}
    assert trees.passes(
        compared(tmp_path / "a", warned("The start ends after 3 s."), pattern=[one])
    )
    wrong = compared(tmp_path / "b", warned("The start ends after 4 s."), pattern=[one])
    assert not trees.passes(wrong)


def test_parts_of_a_sentence(tmp_path):
    one = {"old": "is cut off", "new": "ends"}
    assert trees.passes(compared(tmp_path, warned("The start ends after 3 s."), part=[one]))


def test_an_entry_that_nothing_needs_fails(tmp_path):
    found = compared(tmp_path, string=[{"old": "told", "new": "reported"}])
    assert not found.differences
    assert not trees.passes(found)
    assert "never used: told" in trees.report(found)


@pytest.mark.parametrize("field", ["allowed", "column", "sheet", "table"])
def test_no_sentence_changes_a_field_of_a_problem(tmp_path, field):
    before = RESULTS["errors"][0][field]
    one = {"old": before, "new": "other words"}
    found = compared(
        tmp_path, lambda r: r["errors"][0].update({field: "other words"}), string=[one]
    )
    assert len(found.differences) == 1


def test_the_message_of_a_problem_may_change_by_the_list(tmp_path):
    one = {"old": "found 0.5; it must be 1 or more.", "new": "found 0.5; type 1 or more."}
    found = compared(tmp_path, lambda r: r["errors"][0].update(message=one["new"]), string=[one])
    assert trees.passes(found)


def test_the_proof_changes_bits_and_sees_them_noticed(tmp_path):
    results = json.loads(json.dumps(RESULTS))
    results["natural_frequencies"][0]["frequency"] = 30.123456789012
    done = trees.prove(made(tmp_path, results), 4)
    assert done
    assert all(one.startswith("noticed") for one in done)


def test_random_cases_are_the_same_on_every_call():
    for kind in cases.KINDS:
        assert cases.random_case(kind, 7) == cases.random_case(kind, 7)
        assert cases.random_case(kind, 7) != cases.random_case(kind, 8)
    text = (SCRIPTS / "compare_cases.py").read_text(encoding="utf-8")
    assert not re.search(r"^\s*(?:from|import) (?:engine|addin|tests)\b", text, re.MULTILINE)


def test_every_change_of_a_bit_is_another_decimal():
    for digits in ("0.1", "1e-30", "123456.789", "-2.5"):
        for bit in (0, 1, 30):
            assert float(trees.flipped(digits, bit)) != float(digits)
