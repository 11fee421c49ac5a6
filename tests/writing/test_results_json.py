"""Results JSON and both schemas."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pytest
from test_case_json import CASE

from addin.reading.case_json import case_to_json, read_case_json
from addin.reference.json_schemas import SCHEMA_FOLDER, SCHEMAS, case_schema, results_schema
from addin.writing.results_json import errors_to_json, results_to_json
from engine.errors import InternalError

jsonschema = pytest.importorskip("jsonschema")


@dataclass
class Run:
    """Results as the engine hands them over."""

    tables: dict[str, list[dict[str, Any]]]
    case_sha256: str = "a" * 64
    startup: dict[str, Any] | None = None
    outcome: str = "complete"
    warnings: tuple[str, ...] = field(default=("a warning",))
    details: dict[str, Any] = field(default_factory=dict)


@pytest.fixture
def run() -> Run:
    return Run(
        tables={
            "NaturalFrequencies": [
                {"mode": 0, "frequency": 0.0, "cpm": 0.0, "percent_speed": None},
                {"mode": np.int64(1), "frequency": np.float64(30.0), "cpm": 1800.0, "share": 0.5},
            ],
            "ModeShapes": [{"station": "Motor", "mode_1": 1.0, "mode_12": np.float64(-0.5)}],
            "AllowableStarts": [
                {
                    "element": "Shaft",
                    "damage": 0.001,
                    "allowable_starts": 1000.0,
                    "governing": True,
                },
                {"element": "Hub", "damage": 0.0, "allowable_starts": None, "unlimited": True},
            ],
            "Verdicts": [{"check": "Margin", "result": 0.117, "limit": "20 %", "verdict": "fail"}],
        },
        startup={"outcome": "reached", "time": 8.03, "end_speed": 182.8, "sentence": "..."},
    )


def valid(content: dict, schema: dict) -> None:
    jsonschema.Draft202012Validator(schema).validate(content)


def test_results_are_plain_and_follow_the_schema(run):
    content = results_to_json(run, "1.2.3")
    json.dumps(content, allow_nan=False)
    valid(content, results_schema())
    assert content["format"] == 1
    assert content["version"] == "1.2.3"
    assert content["errors"] == []
    assert content["warnings"] == ["a warning"]
    assert content["startup"] == {"outcome": "reached", "time": 8.03, "end_speed": 182.8}
    assert "percent_speed" not in content["natural_frequencies"][0]
    assert type(content["natural_frequencies"][1]["frequency"]) is float
    assert type(content["natural_frequencies"][1]["mode"]) is int
    assert content["mode_shapes"][0]["mode_12"] == -0.5
    assert content["allowable_starts"][1] == {
        "element": "Hub", "damage": 0.0, "allowable_starts": None, "unlimited": True,
    }  # fmt: skip
    assert "steady_state" not in content


@pytest.mark.parametrize(
    ("table", "row"),
    [
        ("NaturalFrequencies", {"frequency": float("nan")}),
        ("NaturalFrequencies", {"frequency": np.float64("inf")}),
        ("NaturalFrequencies", {"freqency": 1.0}),
        ("NaturalFrequencies", {"frequency": [1.0]}),
        ("ModeShapes", {"station": "A", "mode_0": 1.0}),
        ("NoSuchTable", {}),
    ],
)
def test_what_must_not_leave_the_program(run, table, row):
    run.tables = {table: [row]}
    with pytest.raises(InternalError):
        results_to_json(run, "1")


def test_a_run_without_start(run):
    run.startup = None
    content = results_to_json(run, "1")
    assert "startup" not in content
    valid(content, results_schema())


def test_errors(run):
    case = dict(CASE, line_frequency="60", extra={"a": 1})
    case["stations"] = [*CASE["stations"], "third"]
    found = read_case_json(case)
    content = errors_to_json(found.problems, "1", found.warnings)
    valid(content, results_schema())
    assert json.loads(json.dumps(content, allow_nan=False)) == content
    assert len(content["errors"]) == 3
    assert set(content["errors"][0]) == {
        "sheet", "table", "row", "column", "found", "allowed", "message",
    }  # fmt: skip


@pytest.mark.parametrize(("name", "schema"), SCHEMAS.items())
def test_the_shipped_schemas_are_those_of_the_fields(name, schema):
    text = (SCHEMA_FOLDER / f"{name}.schema.json").read_text(encoding="utf-8")
    assert json.loads(text) == schema(), "run: make generated"
    jsonschema.Draft202012Validator.check_schema(schema())


def test_cases_follow_the_schema():
    valid(CASE, case_schema())
    valid(case_to_json(read_case_json(CASE).data), case_schema())


@pytest.mark.parametrize(
    "change",
    [
        {"format": 2},
        {"line_frequncy": 60},
        {"line_frequency": "60"},
        {"line_frequency": [60]},
        {"poles": 4.5},
        {"method": "euler"},
        {"stations": {}},
        {"stations": [{"inertai": 1}]},
    ],
)
def test_the_schema_refuses(change):
    with pytest.raises(jsonschema.ValidationError):
        valid({**CASE, **change}, case_schema())
