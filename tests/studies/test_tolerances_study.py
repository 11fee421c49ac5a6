"""`torsionbook tolerances` and `sensitivities` as a user runs them: workbook, JSON, refusals."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import jsonschema
import openpyxl
import pytest
from typer.testing import CliRunner

from addin.cli.app import app
from addin.contract.shipped import template_path
from addin.reading.case_json import case_to_json
from addin.reading.one_file import Unreadable, read_checked
from addin.reference.json_schemas import SCHEMA_FOLDER, study_schema
from addin.studies.registry import every_study

RUN = CliRunner()
SCHEMAS = {study.key: study_schema(study.spec) for study in every_study()}


@pytest.mark.parametrize("study", SCHEMAS)
def test_the_shipped_schemas_are_those_of_the_studies(study: str) -> None:
    text = (SCHEMA_FOLDER / f"{study}.schema.json").read_text(encoding="utf-8")
    assert json.loads(text) == SCHEMAS[study], "run: make generated"
    jsonschema.Draft202012Validator.check_schema(SCHEMAS[study])


def _run(*arguments: str) -> Any:
    return RUN.invoke(app, list(arguments))


@pytest.fixture(scope="module")
def content() -> dict[str, Any]:
    """The paper's sample as JSON, with what is not known exactly."""
    read = read_checked(template_path("example_proposed.xlsx"))
    assert not isinstance(read, Unreadable)
    return case_to_json(read.data) | {
        "starts_required": 400,
        "scatter": [
            {"quantity": "stiffness", "spread": "5 %", "together": "together"},
            {"quantity": "damping ratio", "distribution": "uniform", "spread": 0.3},
            {"quantity": "S-N line", "distribution": "from-to", "from": 0.9, "to": 1.1},
        ],
    }


def _written(content: dict[str, Any], folder: Path) -> Path:
    source = folder / "case.json"
    source.write_text(json.dumps(content), encoding="utf-8")
    return source


def _table(book: openpyxl.Workbook, name: str) -> list[dict[str, Any]]:
    for sheet in book.worksheets:
        if name in sheet.tables:
            rows = [[cell.value for cell in row] for row in sheet[sheet.tables[name].ref]]
            return [dict(zip(rows[0], row, strict=True)) for row in rows[1:]]
    raise KeyError(name)


@pytest.mark.slow
def test_a_workbook_is_sampled_and_its_cells_are_those_of_the_json(
    content: dict[str, Any], tmp_path: Path
) -> None:
    source, book_ = _written(content, tmp_path), tmp_path / "train.xlsx"
    assert _run("new", str(book_), "--from", str(source), "--studies").exit_code == 0
    told = _run(
        "tolerances", str(book_), "--in-place", "--samples", "60", "--seed", "3", "--jobs", "1",
        "--json", str(tmp_path / "t.json"),
    )  # fmt: skip
    assert told.exit_code == 0, told.output
    found = json.loads((tmp_path / "t.json").read_text(encoding="utf-8"))
    jsonschema.validate(found, SCHEMAS["tolerances"])
    assert found["tolerances"]["samples_calculated"] == 60
    book = openpyxl.load_workbook(book_)
    cells = _table(book, "StartsOfSample")
    assert len(cells) == len(found["starts_of_sample"]) > 1
    key = "HP compressor shaft"
    starts = next(r for r in cells if r["Element"] == key)
    row = next(r for r in found["starts_of_sample"] if r["element"] == key)
    for column, key in (("P10", "p_10"), ("P90 high", "p_90_high"), ("Nominal", "nominal")):
        assert starts[column] == pytest.approx(row[key], rel=6e-3)  # shown in four digits
    assert starts["Probability"] == pytest.approx(100.0 * row["probability"])
    drivers = _table(book, "ToleranceDrivers")
    assert [d["Factor"] for d in drivers] == [d["factor"] for d in found["tolerance_drivers"]]
    frequency = _table(book, "ToleranceFrequencies")
    assert [f["P50"] for f in frequency] == pytest.approx(
        [f["p_50"] for f in found["tolerance_frequencies"]], rel=1e-12
    )
    assert len(_table(book, "ToleranceDistribution")) == 99
    assert found["sentence"] in {
        str(cell.value) for row in book["StudyFacts"].iter_rows() for cell in row
    }


@pytest.mark.slow
def test_the_sheet_says_how_many_starts_are_in_no_percentile(
    content: dict[str, Any], tmp_path: Path
) -> None:
    """The words of the sheet are the only ones its reader has beside the percentiles."""
    scatter = [{"quantity": "average torque", "distribution": "from-to", "from": 0.1, "to": 1.2}]
    source = _written(content | {"scatter": scatter}, tmp_path)
    done = _run("tolerances", str(source), "--samples", "40", "--jobs", "1")
    assert done.exit_code == 0, done.output
    told = json.loads((tmp_path / "case.tolerances.json").read_text(encoding="utf-8"))
    completed = next(
        r for r in told["tolerances"]["probabilities"] if r["check"] == "start completed"
    )
    stalled = round(40 * (1.0 - completed["probability"]))
    assert 0 < stalled < 40
    assert f"{stalled} of 40 starts were not completed" in told["sentence"]


@pytest.mark.slow
def test_processes_change_no_number(content: dict[str, Any], tmp_path: Path) -> None:
    source = _written(content, tmp_path)
    for jobs in ("1", "2"):
        told = _run(
            "tolerances", str(source), "--samples", "70", "--jobs", jobs,
            "--json", str(tmp_path / f"{jobs}.json"),
        )  # fmt: skip
        assert told.exit_code == 0, told.output
    one, two = ((tmp_path / f"{jobs}.json").read_text(encoding="utf-8") for jobs in ("1", "2"))
    assert one == two


@pytest.mark.parametrize(
    ("rows", "says"),
    [
        ([], "Table Scatter is empty"),
        ([{"quantity": "stiffness", "spread": 0.3}], "or more reaches zero"),
        ([{"quantity": "stiffnes", "spread": 0.1}], "Did you mean 'stiffness'?"),
        ([{"name": "Motr", "quantity": "inertia", "spread": 0.1}], "no station 'Motr'"),
    ],
)
def test_wrong_scatter_gets_its_sentence_and_nothing_is_written(
    content: dict[str, Any], rows: list[dict[str, Any]], says: str, tmp_path: Path
) -> None:
    source = _written(content | {"scatter": rows}, tmp_path)
    told = _run("tolerances", str(source))
    assert told.exit_code == 1
    assert says in told.output
    assert list(tmp_path.iterdir()) == [source]


def test_what_cannot_be_read_hides_nothing_else_that_is_wrong(
    content: dict[str, Any], tmp_path: Path
) -> None:
    rows = [
        {"quantity": "stiffness", "spread": 0.4},
        {"quantity": "inertia", "distribution": "gauss", "spread": 0.02},
    ]
    told = _run("tolerances", str(_written(content | {"scatter": rows}, tmp_path)))
    assert told.exit_code == 1
    assert "2 errors" in told.output
    assert "or more reaches zero" in told.output
    assert "found 'gauss'" in told.output


def test_a_wrong_option_is_a_wrong_usage(content: dict[str, Any], tmp_path: Path) -> None:
    source = str(_written(content, tmp_path))
    assert _run("tolerances", source, "--method", "dice").exit_code == 2
    assert _run("tolerances", source, "--samples", "5").exit_code == 2


def test_a_workbook_without_the_sheets_says_how_to_get_them(tmp_path: Path) -> None:
    plain = tmp_path / "plain.xlsx"
    plain.write_bytes(template_path("example_proposed.xlsx").read_bytes())
    told = _run("tolerances", str(plain))
    assert told.exit_code == 1
    assert "has no sheet Tolerances" in told.output
    assert "--add" in told.output


@pytest.mark.slow
def test_sensitivities_of_a_train_without_a_start(content: dict[str, Any], tmp_path: Path) -> None:
    """Frequencies alone: quick, and the shifts beside them are live."""
    still = {k: v for k, v in content.items() if k not in ("motor_torque", "load_torque")}
    source, book_ = _written(still, tmp_path), tmp_path / "train.xlsx"
    assert _run("new", str(book_), "--from", str(source), "--studies").exit_code == 0
    told = _run(
        "sensitivities", str(book_), "--in-place", "--jobs", "1", "--json", str(tmp_path / "d.json")
    )
    assert told.exit_code == 0, told.output
    found = json.loads((tmp_path / "d.json").read_text(encoding="utf-8"))
    jsonschema.validate(found, SCHEMAS["sensitivities"])
    assert found["sensitivities"] == []
    rows = found["frequency_sensitivities"]
    for mode in ("mode_1", "mode_2", "mode_3"):
        assert sum(r[mode] for r in rows if r["quantity"] == "stiffness") == pytest.approx(0.5)
    shown = _table(openpyxl.load_workbook(book_), "FrequencySensitivities")
    assert shown[0]["Mode 1"] == pytest.approx(rows[0]["mode_1"])
    assert "SensitivityChange" in shown[0]["Shift 1"]
