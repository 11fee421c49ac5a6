"""Bad input is told the same as ever: sheet, table, row, column, found and allowed of every problem.

Messages may be worded better, these fields may not change: see `problem_fields.py`.
"""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from problem_fields import HERE, bad_inputs, fields_of, written

from addin.contract.tables import STUDY_INPUT_TABLES

RECORDED = json.loads((HERE / "problems.json").read_text(encoding="utf-8"))
#: Effects when the problems were recorded.
EFFECTS_THEN = (
    "one of bearings, coupled damping, fast modes, breaker closing, pull-in, aborted start, backlash, resonance sweep, "
    "cycle counting, run length"
)
#: Limits that were changed on purpose: table and column of the problem, allowed then and now.
ON_PURPOSE = {
    # a smaller tolerance than rounding can meet is refused
    ("Case", "TolerancePeak"): ("between 1e-9 and 0.5 (50 %)", "between 2e-07 and 0.5 (50 %)"),
    ("Case", "ToleranceStarts"): ("between 1e-9 and 0.5 (50 %)", "between 1e-05 and 0.5 (50 %)"),
    # two effects more
    ("EffectChoices", "Effect"): (
        EFFECTS_THEN,
        EFFECTS_THEN.replace("breaker closing", "motor transient, breaker closing").replace(
            "pull-in", "electrical damping, pull-in"
        ),
    ),
}
STUDY_TABLES = {spec.name for spec in STUDY_INPUT_TABLES}
#: Told on purpose no more, of an input with scatter alone: that nothing was measured.
NOTHING_MEASURED = ["Measured", "MeasuredFrequencies", None, ""]
#: Inputs whose problems are others on purpose: rows of StartConditions are checked with the case, and a blank in a word of
#: the contract is read as its hyphen.
OTHERS: dict[str, list[list[object]]] = {
    "case 233: stress_basis peak to peak": [],
    "study 75: start conditions without motor": [
        ["Case", "StartConditions", 1, "Kind", None, "steady"]
    ],
}


def expected(name: str) -> list[list[object]]:
    """The recorded problems of an input, with the limits of today."""
    if name in OTHERS:
        return OTHERS[name]
    rows = []
    for *fields, allowed in RECORDED[name]:
        before, now = ON_PURPOSE.get((fields[1], fields[3]), (None, None))
        # table StartConditions stands on sheet Case
        fields[0] = "Case" if fields[0] == "Duty" else fields[0]
        rows.append([*fields, now if allowed == before else allowed])
    # a station that table Stations lacks is one problem, at its first reference
    told: set[object] = set()
    for row in list(rows):
        if row[4] is not None and str(row[5]).startswith("a station of table Stations"):
            if row[4] in told:
                rows.remove(row)
            told.add(row[4])
    # those of the case come first
    rows.sort(key=lambda row: row[1] in STUDY_TABLES)
    return [row for row in rows if row[:4] != NOTHING_MEASURED]


def differences(kind: str, folder: Path, first: int = 0, step: int = 1) -> list[str]:
    """Inputs of a kind whose problems are not those recorded."""
    wrong = []
    for _, name, description in list(bad_inputs(kind))[first::step]:
        path = written(kind, description, folder)
        told = json.loads(json.dumps(fields_of(path)).replace(str(folder), "."))
        told = [row for row in told if row[:4] != NOTHING_MEASURED]
        if told != expected(name):
            wrong.append(f"{name}: expected {expected(name)}, now {told}")
    return wrong


@pytest.mark.parametrize("kind", ["case", "study", "text"])
def test_a_bad_case_has_the_recorded_problems(kind: str, tmp_path: Path) -> None:
    assert differences(kind, tmp_path) == []


@pytest.mark.first_ones(1)
@pytest.mark.parametrize("first", range(4))
def test_a_bad_workbook_has_the_recorded_problems(first: int, tmp_path: Path) -> None:
    assert differences("workbook", tmp_path, first, 4) == []


def test_every_bad_input_is_recorded() -> None:
    assert [name for _, name, _ in bad_inputs()] == list(RECORDED)
    assert sum(bool(told) for told in RECORDED.values()) > 400


def test_a_field_that_is_not_recorded_is_noticed(tmp_path: Path, monkeypatch) -> None:
    name = "text 1: empty file"
    monkeypatch.setitem(RECORDED, name, [["Case", *RECORDED[name][0][1:-1], "another thing"]])
    (wrong,) = differences("text", tmp_path)
    assert wrong.startswith(name)
