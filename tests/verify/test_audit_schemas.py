"""The JSON of `verify` and `diff` follows the shipped schemas, whatever was found."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import jsonschema
import openpyxl
import pytest
from cells_of_tables import cell_of
from typer.testing import CliRunner

from addin.cli.app import app
from addin.contract.shipped import template_path
from addin.reference.json_schemas import SCHEMA_FOLDER
from addin.xlsx import open_workbook

RUN = CliRunner()


def valid(path: Path, name: str) -> dict:
    """The content of a JSON file, checked against the schema that is shipped."""
    content = json.loads(path.read_text(encoding="utf-8"))
    schema = json.loads((SCHEMA_FOLDER / f"{name}.schema.json").read_text(encoding="utf-8"))
    jsonschema.Draft202012Validator(schema).validate(content)
    return content


def verified(path: Path, *words: str) -> dict:
    target = path.with_name(f"{path.stem}.said.json")
    done = RUN.invoke(app, ["verify", str(path), "--json", str(target), *words])
    assert done.exit_code in (0, 1), done.output
    content = valid(target, "verify")
    assert content["follows"] == (done.exit_code == 0)
    return content


@pytest.mark.slow
def test_verify_of_a_good_workbook_and_of_its_results(train, calculated):
    found = verified(train)
    assert found["outcome"] == "follows"
    assert found["recorded_sha256"] == found["case_sha256"]
    assert sum(one["equal_to_the_bit"] for one in found["tables"]) > 100
    results = Path(shutil.copy(calculated / "train.results.json", train.parent))
    assert verified(results, "--case", str(calculated / "case.xlsx"))["outcome"] == "follows"


@pytest.mark.slow
def test_verify_of_edits_of_every_sort(edited):
    def edit(workbook):
        workbook.set_cell(*cell_of(workbook, "StartupPeaks", 1, "Maximum torque"), 12345.0)
        workbook.set_cell(*cell_of(workbook, "StartupPeaks", 2, "Maximum torque"), "=1+1 by hand")
        workbook.set_cell(*cell_of(workbook, "NaturalFrequencies", 2, "Frequency"), True)
        workbook.set_cell(*cell_of(workbook, "Stations", 1, "Inertia"), 9999.0)
        workbook.set_cell(*cell_of(workbook, "AllowableStarts", 1, "Element"), "Nobody")

    path = edited(edit)
    book = openpyxl.load_workbook(path)
    sheet, cell = cell_of(open_workbook(path, read_only=True), "SteadyState", 1, "Torque")
    book[sheet][cell] = "#N/A"
    book.save(path)
    found = verified(path)
    assert found["recorded_sha256"] != found["case_sha256"]
    kinds = {one["kind"] for one in found["findings"]}
    assert {"different", "digest", "edited", "chart"} <= kinds
    assert {type(one["found"]) for one in found["findings"]} >= {float, str, bool, type(None)}
    assert any(one["found"] == "#N/A" for one in found["findings"])


def test_verify_of_what_was_never_calculated_is_wrong_or_is_no_workbook(tmp_path):
    blank = Path(shutil.copy(template_path("example_proposed.xlsx"), tmp_path / "a.xlsx"))
    assert verified(blank)["outcome"] == "never calculated"
    workbook = open_workbook(blank)
    workbook.set_cell(*cell_of(workbook, "Stations", 1, "Inertia"), -1.0)
    workbook.save(tmp_path / "b.xlsx")
    found = verified(tmp_path / "b.xlsx")
    assert found["outcome"] == "not verified"
    assert found["errors"][0]["table"] == "Stations"
    (tmp_path / "c.xlsx").write_bytes(b"no workbook")
    assert verified(tmp_path / "c.xlsx")["outcome"] == "not verified"


@pytest.mark.parametrize("second", ["example_modified.xlsx", "example_backlash.xlsx"])
def test_diff(train, tmp_path, second):
    target = tmp_path / "diff.json"
    words = ["diff", str(train), str(template_path(second)), "--json", str(target)]
    assert RUN.invoke(app, words).exit_code == 0
    found = valid(target, "diff")
    assert {one["kind"] for one in found["results"]} >= {"changed", "row_added", "row_removed"}
    # in SI: the first mode of the paper's proposed system is 30 Hz
    first = next(one for one in found["results"]
                 if one["row"] == "mode 1" and one["column"] == "Frequency")  # fmt: skip
    assert first["a"] == pytest.approx(30.0, abs=0.05)


def test_diff_with_a_result_json(train, calculated, tmp_path):
    target = tmp_path / "diff.json"
    results = calculated / "train.results.json"
    words = ["diff", str(results), str(train), "--json", str(target)]
    assert RUN.invoke(app, words).exit_code == 0
    assert valid(target, "diff")["inputs"] is None
