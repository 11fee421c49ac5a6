"""Studies over the WebSocket: the JSON of the command line, stages, cancel, wrong requests."""

import json
import time

import jsonschema
import pytest
from messages import stream_of, until_stage, until_the_end

from addin.reading.case_json import case_to_json
from addin.reference.json_schemas import study_schema
from addin.studies.registry import every_study
from addin.studies.run_study import StudyFiles, study_one
from addin.workers.parallel_map import serial_map
from tests.sample_case import sample_case

TABLES = {
    "scatter": [{"quantity": "stiffness", "spread": "5 %", "together": "together"}],
    "tuning": [{"element": "HS coupling", "quantity": "stiffness", "unit": "%", "values": "80; 90"}],
    "start_conditions": [{"condition": "normal", "per_year": 10}],
    "measured_frequencies": [{"mode": 1, "frequency": 29.5}],
}  # fmt: skip
CASE = case_to_json(sample_case("proposed")) | TABLES
STUDIES = {study.command: study for study in every_study()}


@pytest.mark.first_ones(1)
@pytest.mark.parametrize(
    ("command", "settings"),
    [("tolerances", {"samples": 60, "seed": 3}), ("tune", {}), ("starts", {}), ("calibrate", {})],
)
def test_a_study_is_that_of_the_command_line(served, tmp_path, command, settings):
    with stream_of(served) as line:
        line.send(json.dumps({"id": 1, "study": command, "case": CASE, "settings": settings}))
        *stages, last = until_the_end(line, 1)
    assert "reading" in [one["stage"] for one in stages]
    assert any(any(c.isdigit() for c in one["stage"]) for one in stages) or command == "calibrate"
    study, source = STUDIES[command], tmp_path / "case.json"
    source.write_text(json.dumps(CASE), encoding="utf-8")
    study_one(study, source, serial_map(), settings, StudyFiles(json_file=tmp_path / "study.json"))
    assert last["value"] == json.loads((tmp_path / "study.json").read_text(encoding="utf-8"))
    jsonschema.validate(last["value"], study_schema(study.spec))


@pytest.mark.slow
def test_a_study_that_is_cancelled_frees_its_process(served):
    with stream_of(served) as line:
        asked = {"study": "tolerances", "case": CASE, "settings": {"samples": 100_000}}
        line.send(json.dumps({"id": 1, **asked}))
        until_stage(line, " runs")
        line.send(json.dumps({"id": 1, "cancel": True}))
        assert until_the_end(line, 1)[-1] == {"cancelled": True}
        # the one process of this server is free for the next
        line.send(json.dumps({"id": 2, "study": "tune", "case": CASE}))
        assert "value" in until_the_end(line, 2)[-1]


@pytest.mark.slow
def test_a_client_that_leaves_gives_its_study_up(served):
    with stream_of(served) as line:
        asked = {"study": "tolerances", "case": CASE, "settings": {"samples": 100_000}}
        line.send(json.dumps({"id": 1, **asked}))
        until_stage(line, " runs")
    time.sleep(0.2)
    with stream_of(served) as line:
        line.send(json.dumps({"id": 2, "study": "tune", "case": CASE}))
        assert "value" in until_the_end(line, 2)[-1]


@pytest.mark.parametrize(
    ("asked", "says"),
    [
        ({"study": "accuracy", "case": CASE}, "Available: tune, tolerances"),
        ({"study": "tune", "case": "x"}, "case is not an object"),
        ({"study": "tune", "case": CASE, "settings": {"samples": 50}}, "tune has no setting"),
        ({"study": "tolerances", "case": CASE, "settings": []}, "settings is not an object"),
        ({"study": "tolerances", "case": CASE, "settings": {"samples": 29}}, "from 30 to 100,000"),
        ({"study": "tolerances", "case": CASE, "settings": {"samples": True}}, "whole number"),
        ({"study": "tolerances", "case": CASE, "settings": {"seed": -1}}, "0 or more"),
        ({"study": "tolerances", "case": CASE, "settings": {"method": "x"}}, "lhs or sobol"),
        ({"study": "starts", "case": CASE, "settings": {"standard": 1}}, "true or false"),
        ({"study": ["tune"], "case": CASE}, "Unknown study"),
    ],
)
def test_wrong_requests_get_their_sentence(served, asked, says):
    with stream_of(served) as line:
        line.send(json.dumps({"id": 1, **asked}))
        assert says in until_the_end(line, 1)[-1]["error"]["message"]


def test_wrong_rows_are_told_one_by_one(served):
    rows = [{"quantity": "stiffness", "spread": 0.4}, {"name": "Nobody", "quantity": "inertia", "spread": 0.1}]  # fmt: skip
    with stream_of(served) as line:
        line.send(json.dumps({"id": 1, "study": "tolerances", "case": CASE | {"scatter": rows}}))
        last = until_the_end(line, 1)[-1]
    assert len(last["errors"]) == 2
    assert last["error"]["message"].startswith("The input has 2 errors; nothing was calculated.")
    assert {one["table"] for one in last["errors"]} == {"Scatter"}
