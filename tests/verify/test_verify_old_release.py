"""Files that release 0.1.0 calculated: they verify, or say that they are to be calculated again.

The folder release_0_1_0 holds a case of two stations, the results that 0.1.0 wrote as JSON, and the workbook that it
filled with the same inputs and calculated.
"""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest
from cells_of_tables import cell_of
from typer.testing import CliRunner

from addin.cli.app import app
from addin.contract.banner import OVERALL_WITHOUT_COPY
from addin.reference.json_schemas import verify_schema
from addin.verify import json_file
from addin.verify import workbook as workbook_room
from addin.verify.file import verify_file
from addin.verify.formulas import earlier_banner
from addin.verify.wording import as_json, lines
from addin.writing.recalculate import recalculate
from addin.xlsx import open_workbook

OLD = Path(__file__).parent / "release_0_1_0"
CASE, RESULTS, TRAIN = OLD / "case.json", OLD / "case.results.json", OLD / "train.xlsx"


@pytest.fixture(autouse=True)
def later_version(monkeypatch):
    """Whatever this version is called: not 0.1.0."""
    for room in (json_file, workbook_room):
        monkeypatch.setattr(room, "product_version", lambda: "0.2.0")


@pytest.mark.parametrize("path", [RESULTS, TRAIN])
def test_a_file_of_the_release_is_to_be_recalculated(path):
    found = verify_file(path, case=CASE)
    assert found.made_by == "torsionbook 0.1.0"
    assert found.same_inputs
    assert found.outcome == "other version"
    assert not found.passes
    assert "calculated by 0.1.0: recalculate" in next(lines(found))
    assert "does not follow" not in "\n".join(lines(found, everything=True))
    assert {f.kind for f in found.findings if f.fails} <= {
        "row missing", "row added", "different", "old value"
    }  # fmt: skip
    as_valid = as_json(found)
    assert as_valid["outcome"] in verify_schema()["properties"]["outcome"]["enum"]


def test_keys_that_the_release_did_not_write_are_no_difference():
    content = json.loads(RESULTS.read_text(encoding="utf-8"))
    assert "overall" not in content
    found = verify_file(RESULTS, case=CASE)
    assert not any(f.cell in ("overall", "headline") for f in found.findings)
    assert not any(f.cell.endswith(".accurate") for f in found.findings)


def test_other_inputs_do_not_follow_whatever_the_version(tmp_path):
    content = json.loads(CASE.read_text(encoding="utf-8"))
    content["stations"][0]["inertia"] = 301
    (tmp_path / "case.json").write_text(json.dumps(content), encoding="utf-8")
    assert verify_file(RESULTS, case=tmp_path / "case.json").outcome == "does not follow"


def test_a_text_in_place_of_a_number_does_not_follow_whatever_the_version(tmp_path):
    workbook = open_workbook(TRAIN)
    workbook.set_cell(*cell_of(workbook, "NaturalFrequencies", 2, "Frequency"), "25.2")
    workbook.save(tmp_path / "edited.xlsx")
    found = verify_file(tmp_path / "edited.xlsx")
    assert found.outcome == "does not follow"


@pytest.mark.slow
def test_results_that_another_version_gives_alike_follow(train):
    """The example, as if 0.1.0 had calculated it: only the version differs."""
    workbook = open_workbook(train)
    audit = workbook.table("Audit")
    for row in range(1, audit.data.height + 1):
        if workbook.shown_value(*cell_of(workbook, "Audit", row, "Item")) == "Software":
            workbook.set_cell(*cell_of(workbook, "Audit", row, "Value"), "torsionbook 0.1.0")
    workbook.save(train.with_name("relabelled.xlsx"))
    assert verify_file(train.with_name("relabelled.xlsx")).outcome == "follows"


def test_a_workbook_of_the_release_verifies_once_it_is_recalculated(tmp_path, monkeypatch):
    monkeypatch.undo()
    source = shutil.copyfile(TRAIN, tmp_path / "train.xlsx")
    outcome = recalculate(Path(source))
    assert outcome.problems == ()
    found = verify_file(outcome.written[0])
    assert [f for f in found.findings if f.fails] == []
    assert found.outcome == "follows"
    # its own banner called a check that is incomplete a pass: recalculation replaces it
    assert not any("formula of an earlier release" in f.sentence for f in found.findings)
    workbook = open_workbook(outcome.written[0], read_only=True)
    name = workbook.defined_names["OverallVerdict"]
    banner = workbook.sheet_part(name.sheet).value(name.rect.top, name.rect.left)
    assert banner.text == OVERALL_WITHOUT_COPY.removeprefix("=")
    assert banner.cached.startswith("FAIL: 1 of 4 checks, ")


def test_the_banner_of_the_release_fails_where_it_says_another_verdict():
    workbook = open_workbook(TRAIN, read_only=True)
    [found] = earlier_banner(workbook, "INCOMPLETE: 2 of 4 checks not judged, or only in part")
    assert found.fails
    assert "torsionbook new NEW.xlsx --from OLD.xlsx" in found.sentence


def test_the_command_says_it_and_ends_with_one():
    done = CliRunner().invoke(app, ["verify", str(RESULTS), "--case", str(CASE)])
    assert done.exit_code == 1
    assert "calculated by 0.1.0: recalculate" in done.output
