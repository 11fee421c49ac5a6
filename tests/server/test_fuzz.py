"""Whatever is sent, as openapi.json describes it or not: an answer as described, never a fault.

Requests are made from the schemas the server itself publishes, and from what is next to them.
"""

import json
import logging
import string

import jsonschema
import pytest
from hypothesis import given
from hypothesis import strategies as st
from sheet_ranges import TEMPLATES
from strategies import example_count

from addin.server.openapi import document

DESCRIBED = document()
SCHEMAS = DESCRIBED["components"]["schemas"]
SHEET = (TEMPLATES / "blank_si.xlsx").read_bytes()

finite = st.floats(allow_nan=False, allow_infinity=False)
ugly = st.text(max_size=20) | st.sampled_from(
    ["", " ", "#N/A", "nan", "inf", "\ud800", "tv:", "1e999"]
)
#: Values of the JSON types a schema names.
OF_TYPE = {
    "number": finite | st.integers(-(10**40), 10**40),
    "string": ugly,
    "boolean": st.booleans(),
    "null": st.none(),
}
anything = st.recursive(
    st.one_of(*OF_TYPE.values()),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(ugly, inner, max_size=4),
    max_leaves=12,
)


def from_schema(schema):
    """Values that fit a schema: as much of JSON Schema as openapi.json uses."""
    if "$ref" in schema:
        return st.deferred(lambda: from_schema(SCHEMAS[schema["$ref"].rpartition("/")[2]]))
    if "anyOf" in schema:
        return st.one_of([from_schema(one) for one in schema["anyOf"]])
    if "enum" in schema:
        return st.sampled_from(schema["enum"])
    kind = schema["type"]
    if isinstance(kind, list):
        return st.one_of([OF_TYPE[one] for one in kind])
    if kind == "array":
        return st.lists(from_schema(schema["items"]), max_size=6)
    if kind == "object":
        needed = {
            k: from_schema(v) for k, v in schema["properties"].items() if k in schema["required"]
        }
        rest = {k: from_schema(v) for k, v in schema["properties"].items() if k not in needed}
        return st.fixed_dictionaries(needed, optional=rest)
    return OF_TYPE[kind]


def check(said, path):
    """The answer is as described; a refusal has its sentence; nothing of ours is broken."""
    about = DESCRIBED["paths"][path]["post"]["responses"]
    assert str(said.status_code) in about, (said.status_code, said.text[:300])
    assert said.status_code < 500, said.text
    content = said.json()
    schema = about[str(said.status_code)]["content"]["application/json"]["schema"]
    jsonschema.validate(
        content, {**schema, "components": {"schemas": SCHEMAS}}, cls=jsonschema.Draft202012Validator
    )
    assert "inside torsionbook" not in said.text
    assert "Traceback" not in said.text
    return content


@pytest.fixture
def quiet(caplog):
    """Errors in the server's log are faults of ours."""
    yield
    told = [r for r in caplog.get_records("call") if r.name.startswith("torsionbook")]
    assert [r.getMessage() for r in told if r.levelno >= logging.ERROR] == []


def post(client, path, body, kind="application/json"):
    return client.post(path, content=body, headers={"Content-Type": kind})


@pytest.mark.slow
@pytest.mark.usefixtures("quiet")
@example_count(150)
@given(sent=from_schema(SCHEMAS["Batch"]))
def test_batches_as_described(client, sent):
    said = post(client, "/api/v1/batch", json.dumps(sent))
    found = check(said, "/api/v1/batch")
    assert len(found["results"]) == len(sent["calls"])


@pytest.mark.usefixtures("quiet")
@example_count(100)
@given(sent=st.one_of(anything, st.fixed_dictionaries({"calls": anything})))
def test_other_json(client, sent):
    check(post(client, "/api/v1/batch", json.dumps(sent)), "/api/v1/batch")


@pytest.mark.usefixtures("quiet")
@example_count(100)
@given(sent=st.binary(max_size=200) | st.text(string.printable, max_size=200).map(str.encode))
@pytest.mark.parametrize("path", ["/api/v1/batch", "/api/v1/model"])
def test_other_bytes(client, path, sent):
    check(post(client, path, sent), path)


@pytest.mark.slow
@pytest.mark.usefixtures("quiet")
@example_count(60)
@given(
    sent=anything.map(json.dumps)
    | st.fixed_dictionaries(
        {
            "format": st.just(1),
            "stations": anything,
            "elements": anything,
            "damping_ratio": anything,
        }
    ).map(json.dumps),
    name=ugly,
)
def test_cases_that_are_none(client, sent, name):
    said = client.post(
        "/api/v1/model", params={"name": name.encode("utf-8", "replace").decode()}, content=sent
    )
    check(said, "/api/v1/model")


@pytest.mark.usefixtures("quiet")
@example_count(60)
@given(at=st.integers(0, len(SHEET) - 1), put=st.binary(min_size=1, max_size=40), cut=st.booleans())
def test_damaged_workbooks(client, at, put, cut):
    body = SHEET[:at] + put + (b"" if cut else SHEET[at + len(put) :])
    check(client.post("/api/v1/model", content=body), "/api/v1/model")
    if at % 8 == 0:
        check(client.post("/api/v1/workbook", content=body), "/api/v1/workbook")


@example_count(60)
@given(messages=st.lists(anything.map(json.dumps) | st.text(max_size=30), max_size=5))
def test_messages_of_a_stream(client, messages):
    """Whatever comes before it, a proper question is answered."""
    question = {"id": "the last", "name": "TV_CONVERT", "arguments": [1, "m", "mm"]}
    with client.websocket_connect("/api/v1/stream", headers={"host": "127.0.0.1"}) as socket:
        for one in (*messages, json.dumps(question)):
            socket.send_text(one.encode("utf-8", "replace").decode())
        while True:
            said = socket.receive_json()
            assert "id" in said
            if said["id"] == "the last":
                assert said["value"] == [[1000.0]]
                break
            assert said.get("error", {}).get("message") or said.get("cancelled")
            assert "inside torsionbook" not in json.dumps(said)
