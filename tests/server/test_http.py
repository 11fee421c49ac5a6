"""The server over HTTP: the same doubles, refusals in words, limits that hold."""

import io
import json
import tempfile
import threading
from pathlib import Path

import jsonschema
import openpyxl
import pytest
from servers import inside
from sheet_ranges import (
    CATALOGUE,
    MOTOR,
    SCATTER,
    SECTIONS,
    TEMPLATES,
    TUNING,
    model_arguments,
    table,
    with_conditions,
    with_event,
)

from addin.server import calls as server_calls
from addin.server.app import MODULES
from addin.server.office import STATIC
from addin.server.processes import Work
from addin.server.settings import Limits, Settings
from addin.worksheet import registry
from addin.worksheet.models import MODELS
from addin.worksheet.registry import FUNCTIONS
from addin.xlsx import open_workbook as open_file

KEY = "a-key-nobody-guesses"


def batch(client, *calls, **more):
    sent = {"calls": [{"name": name, "arguments": list(given)} for name, *given in calls]}
    return client.post("/api/v1/batch", json=sent, **more)


def results(client, *calls):
    said = batch(client, *calls)
    assert said.status_code == 200, said.text
    return said.json()["results"]


@pytest.fixture(scope="session")
def handle(client):
    (one,) = results(client, ["TV_MODEL", *model_arguments()])
    return one["value"][0][0]


#: A call of every function; what it gives in this process is what the server must give.
CALLS = {
    "TV_FREQUENCIES": [],
    "TV_MODE": [2],
    "TV_ENERGY": [],
    "TV_MARGINS": ["SI"],
    "TV_BANDS": ["US"],
    "TV_STEADY": [],
    "TV_SPEED_TIME": [200],
    "TV_PEAKS": [],
    "TV_HISTORY": ["LS coupling", 300],
    "TV_REVERSALS": [],
    "TV_CYCLES": [],
    "TV_STARTS": [None, False],
    "TV_FATIGUE_LIMITS": [],
    "TV_SN_LIFE": ["4340", [[30000.0, None], [40000.0, 1.0]]],
    "TV_EFFECTS": [],
    "TV_VERDICTS": [],
    "TV_CALIBRATE": [[[30.1, 52.7]], 0.01, 0.08],
    "TV_TUNE": [TUNING, CATALOGUE],
    "TV_TOLERANCES": [SCATTER, "margins", 30, 7],
    "TV_SENSITIVITIES": ["frequencies"],
}


def every_call(handle):
    material = next(str(m.material) for m in MODELS.of(handle).case.materials)
    found = {name: [handle, *rest] for name, rest in CALLS.items()}
    found["TV_SN_LIFE"][1] = material
    found["TV_MODEL"] = model_arguments()
    found["TV_EVENTS"] = [
        registry.call("TV_MODEL", with_conditions(with_event(model_arguments())))[0][0]
    ]
    found["TV_CASE_VERDICTS"] = [
        registry.call("TV_MODEL", with_conditions(model_arguments()))[0][0]
    ]
    found["TV_STIFFNESS"] = [200.1, None, 501.7, 79300]
    found["TV_SECTIONS"] = [SECTIONS]
    found["TV_MOTOR_CIRCUIT"] = [MOTOR, 60]
    found["TV_MOTOR_CURVES"] = [MOTOR, [[1, 0.5], [0.05, None]], 60]
    found["TV_FAULT_TORQUE"] = ["line-to-line fault", 0.2, 0.25]
    found["TV_LIFE"] = [[[1e-3, 2e-4]], [[12.0, None]], None, 2]
    found["TV_CONVERT"] = [[[0.1, None], [1e-300, 3.3]], "lbf*in", "N*m"]
    return found


def test_every_function_gives_the_same_doubles_in_order(client, handle):
    wanted = every_call(handle)
    assert sorted(wanted) == sorted(FUNCTIONS)
    answers = results(client, *([name, *given] for name, given in wanted.items()))
    for (name, given), told in zip(wanted.items(), answers, strict=True):
        here = registry.call(name, given)
        # repr tells every double from every other, and 1.0 from True
        assert repr(told["value"]) == repr(here), name


def test_doubles_keep_all_their_digits_on_the_way(client):
    numbers = [0.1, 1 / 3, 5e-324, 1.7976931348623157e308, -0.0, 123456789.123456789, 2.0**53 + 2]
    (told,) = results(client, ["TV_CONVERT", [numbers], "m", "m"])
    assert [x.hex() for x in told["value"][0]] == [x.hex() for x in numbers]


def test_blanks_stay_blank_and_errors_come_as_errors(client):
    told = results(
        client,
        ["TV_CONVERT", [[1, None, ""]], "m", "mm"],
        ["TV_CONVERT", [[{"type": "Error", "basicValue": "#DIV/0!"}]], "m", "mm"],
        ["TV_NOTHING"],
        ["TV_PEAKS", "tv:0123456789abcdef"],
        ["TV_STIFFNESS", None, None, 1, 1],
    )
    assert told[0]["value"] == [[1000.0, None, None]]
    assert [one["error"]["code"] for one in told[1:]] == ["#DIV/0!", "#NAME?", "#N/A", "#VALUE!"]
    for one in told[1:]:
        assert one["error"]["message"].endswith(".")


def test_a_start_is_calculated_in_the_pool_and_once(client, monkeypatch):
    """In this process it would raise; both calls and the function after them get it from memory."""
    monkeypatch.setattr("addin.calculation.calculation.calculate", None)
    model = results(client, ["TV_MODEL", *model_arguments("example_modified")])[0]["value"][0][0]
    MODELS.of(model).kept.clear()
    submitted = []
    original = Work.submit
    monkeypatch.setattr(
        Work, "submit", lambda self, *a: submitted.append(a[0]) or original(self, *a)
    )
    answers = []

    def ask(name):
        answers.append(results(client, [name, model])[0])

    threads = [threading.Thread(target=ask, args=(n,)) for n in ("TV_PEAKS", "TV_STARTS") * 2]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(answers) == 4
    assert all("value" in one for one in answers)
    assert submitted == ["start"]
    ask("TV_EFFECTS")
    assert "value" in answers[-1]
    assert submitted == ["start"]


def test_a_model_and_what_asks_about_it_may_come_together(client):
    arguments = model_arguments("example_backlash")
    handle = registry.call("TV_MODEL", arguments)[0][0]
    MODELS._models.clear()
    long, model = results(client, ["TV_STARTS", handle], ["TV_MODEL", *arguments])
    assert model["value"] == [[handle]]
    assert long["value"] == registry.call("TV_STARTS", [handle])


def test_what_is_wrong_with_a_train_is_told_by_the_pool_as_well(client):
    """A start whose case cannot be calculated: the sentence is that of the function itself."""
    arguments = model_arguments()
    without = [None if "Torque" in n else a for n, a in _named(arguments)]
    bare = registry.call("TV_MODEL", without)[0][0]
    (told,) = results(client, ["TV_PEAKS", bare])
    with pytest.raises(registry.FunctionError) as here:
        registry.call("TV_PEAKS", [bare])
    assert told["error"] == {"message": here.value.message, "code": "#N/A"}


def _named(arguments):
    from addin.worksheet.functions.model import TABLES

    return zip([*TABLES[:2], "Case", *TABLES[2:]], arguments, strict=True)


# --- requests that cannot be answered -------------------------------------------------------------


def told(said, status):
    assert said.status_code == status, said.text
    message = said.json()["error"]["message"]
    assert message.endswith(".")
    assert "Traceback" not in said.text
    return message


@pytest.mark.parametrize(
    "body",
    [
        b"", b"{", b"[]", b"null", b'{"calls": 3}', b'{"calls": [3]}', b'{"calls": [{"name": 3}]}',
        b'{"calls": [{"name": "TV_CONVERT", "arguments": "m"}]}', b'{"calls": [NaN]}', b"\xff\xfe",
        b"[" * 100_000, b'{"calls": [' + b"1" * 5000 + b"]}",
    ],
)  # fmt: skip
def test_what_is_no_list_of_calls_is_refused(client, body):
    said = client.post("/api/v1/batch", content=body, headers={"Content-Type": "application/json"})
    told(said, 400)


def test_other_kinds_of_content_are_refused(client):
    assert "application/json" in told(client.post("/api/v1/batch", content=b"{}"), 415)
    assert "body" in told(client.post("/api/v1/workbook", files={"a": b"x"}), 415)
    assert "Unknown address /api" in told(client.get("/api/v2/batch"), 404)
    assert "does not accept GET" in told(client.get("/api/v1/batch"), 405)


def test_limits_of_one_request():
    limits = Limits(body=2000, calls=3)
    with inside(Settings(workers=1, limits=limits)) as client:
        assert "3" in told(batch(client, *[["TV_CONVERT", 1, "m", "mm"]] * 4), 413)
        assert "0.002 MB" in told(batch(client, ["TV_CONVERT", [0.0] * 2000, "m", "mm"]), 413)

        def unannounced():
            yield b'{"calls": ['
            for _ in range(200):
                yield b" " * 100

        said = client.post(
            "/api/v1/batch",
            content=unannounced(),
            headers={"Content-Type": "application/json"},
        )
        told(said, 413)
        assert len(results(client, *[["TV_CONVERT", 1, "m", "mm"]] * 3)) == 3


def test_calls_that_take_too_long_are_told_so(monkeypatch):
    gate = threading.Event()

    def slow(name, arguments):
        gate.wait(5.0)
        return [[1.0]]

    monkeypatch.setattr(server_calls, "call", slow)
    with inside(Settings(workers=1, limits=Limits(short_time=0.2))) as client:
        answers = results(client, *[["TV_CONVERT", 1, "m", "mm"]] * 2)
        gate.set()
    assert [one["error"]["code"] for one in answers] == ["#N/A", "#N/A"]
    assert "longer than 0.2 s" in answers[0]["error"]["message"]


def test_answers_of_one_request_are_bounded(client, monkeypatch):
    monkeypatch.setattr(server_calls, "MOST_CELLS", 10)
    answers = results(client, *[["TV_CONVERT", [[1.0] * 4], "m", "mm"]] * 3)
    assert ["value" in one for one in answers] == [True, True, False]


def test_more_requests_than_the_limit_are_sent_away(monkeypatch):
    gate, began = threading.Event(), threading.Event()

    def slow(name, arguments):
        began.set()
        gate.wait(20.0)
        return [[1.0]]

    monkeypatch.setattr(server_calls, "call", slow)
    with inside(Settings(workers=1, limits=Limits(requests=1))) as client:
        first = []
        thread = threading.Thread(
            target=lambda: first.append(batch(client, ["TV_CONVERT", 1, "m", "mm"]))
        )
        thread.start()
        assert began.wait(10.0)
        said = batch(client, ["TV_CONVERT", 1, "m", "mm"])
        gate.set()
        thread.join()
    assert "Try again" in told(said, 503)
    assert said.headers["Retry-After"] == "5"
    assert first[0].status_code == 200


def test_few_large_requests_are_read_at_a_time():
    """The size alone decides; what is small goes through beside it."""
    with inside(Settings(workers=1, limits=Limits(large=0))) as client:
        call = ["TV_CONVERT", [1.0] * 250_000, "m", "mm"]
        assert "large" in told(batch(client, call), 503)
        assert "large" in told(client.post("/api/v1/workbook", content=iter([b"PK"])), 503)
        assert batch(client, ["TV_CONVERT", 1, "m", "mm"]).status_code == 200


def test_an_error_of_ours_is_told_without_its_insides(client, monkeypatch):
    def broken(name, arguments):
        raise ZeroDivisionError("secret of the house")

    monkeypatch.setattr(server_calls, "call", broken)
    said = batch(client, ["TV_CONVERT", 1, "m", "mm"])
    assert "inside torsionbook" in said.json()["results"][0]["error"]["message"]
    monkeypatch.setattr(server_calls.Calls, "answers", broken)
    message = told(batch(client, ["TV_CONVERT", 1, "m", "mm"]), 500)
    assert "secret" not in message + said.text


# --- keys and names -------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "headers",
    [{}, {"X-API-Key": "wrong"}, {"Authorization": "Bearer wrong"}, {"Authorization": KEY}],
)
def test_without_a_key_nothing_is_calculated(headers):
    with inside(Settings(workers=1, keys=frozenset({KEY}))) as client:
        for path in ("/api/v1/batch", "/api/v1/workbook", "/api/v1/model", "/api/v1/nothing"):
            assert "X-API-Key" in told(client.post(path, json={}, headers=headers), 401)
        assert client.get("/healthz").json() == {"ok": True}


def test_a_wrong_key_is_told_otherwise_than_none():
    with inside(Settings(workers=1, keys=frozenset({KEY}))) as client:
        none = told(client.post("/api/v1/batch", json={}), 401)
        wrong = told(client.post("/api/v1/batch", json={}, headers={"X-API-Key": KEY[1:]}), 401)
        assert none.startswith("An API key is needed")
        assert wrong.startswith("The API key is not valid on this server")
        assert KEY[1:] not in wrong


def test_a_key_opens_in_either_header():
    with inside(Settings(workers=1, keys=frozenset({"another-key-of-24-letters", KEY}))) as client:
        for headers in ({"X-API-Key": KEY}, {"Authorization": f"Bearer {KEY}"}):
            assert batch(client, ["TV_CONVERT", 1, "m", "mm"], headers=headers).status_code == 200


def test_pages_of_other_sites_and_other_names_are_refused(client):
    call = ["TV_CONVERT", 1, "m", "mm"]
    told(batch(client, call, headers={"Origin": "https://elsewhere.example"}), 403)
    told(batch(client, call, headers={"Host": "elsewhere.example"}), 421)
    own = {"Origin": "http://127.0.0.1:8765"}
    assert batch(client, call, headers=own).status_code == 200
    with inside(Settings(workers=1, public_url="https://torsion.example.com")) as behind:
        there = {"Host": "torsion.example.com", "Origin": "https://torsion.example.com"}
        assert batch(behind, call, headers=there).status_code == 200


# --- workbooks ------------------------------------------------------------------------------------


def test_a_workbook_comes_back_recalculated_and_nothing_is_kept(client, tmp_path, monkeypatch):
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    source = (TEMPLATES / "example_proposed.xlsx").read_bytes()
    said = client.post("/api/v1/workbook?name=Zug 1.xlsx", content=source)
    assert said.status_code == 200, said.text
    assert "Zug%201.out.xlsx" in said.headers["Content-Disposition"]
    book = openpyxl.load_workbook(io.BytesIO(said.content))
    handle = registry.call("TV_MODEL", model_arguments())[0][0]
    head, *rows = registry.call("TV_PEAKS", [handle])
    there = table(book, "StartupPeaks")
    column = there[1].index(head[1].split(" [")[0])
    assert [row[1] for row in rows] == [row[column] for row in there[2 : 2 + len(rows)]]
    head, *checks = registry.call("TV_VERDICTS", [handle])
    _, titles, *written = table(book, "Verdicts")
    here, at = head.index("Verdict"), titles.index("Verdict")
    assert checks[0][here] == "fail"  # the overall verdict
    assert [row[here] for row in checks] == [row[at] for row in written[: len(checks)]]
    assert list(tmp_path.iterdir()) == []
    # what a front writes into the open workbook ends as the file that comes back
    *stages, end = open_workbook(client, source)
    assert {"reading", "writing"} < {line["stage"] for line in stages}
    assert list(end) == ["value", "warnings"]
    before = open_file(TEMPLATES / "example_proposed.xlsx", read_only=True)
    cells, differing = 0, set()
    for sheet in end["value"]["sheets"]:
        for one in sheet["tables"]:
            assert book[sheet["name"]].tables[one["name"]].ref == one["after"]
            assert str(before.table(one["name"]).ref) == one["before"]
        for block in sheet["blocks"]:
            there = book[sheet["name"]][block["at"]]
            for row, cells_there in zip(block["rows"], rows_in(there), strict=True):
                for value, cell in zip(row, cells_there, strict=True):
                    cells += 1
                    if not is_as_written(value, cell):
                        differing.add((sheet["name"], cell.coordinate))
    assert cells == end["value"]["cells"] > 20_000
    assert len(differing) < 30, differing  # times of the effects, and of the calculation
    assert {sheet for sheet, _ in differing} <= {"Effects and accuracy", "Audit", "Lists"}
    assert list(tmp_path.iterdir()) == []


def open_workbook(client, source, **query):
    """The lines of an answer."""
    said = client.post("/api/v1/open-workbook", params=query, content=source)
    assert said.status_code == 200, said.text
    assert said.headers["Content-Type"] == "application/x-ndjson"
    return [json.loads(line) for line in said.text.splitlines()]


def rows_in(cells):
    return cells if isinstance(cells, tuple) else ((cells,),)


def is_as_written(value, cell):
    """Whether a value for the open workbook is that of a cell of the file."""
    if cell.data_type == "f":
        return value == getattr(cell.value, "text", cell.value).replace("_xlfn.", "")
    there = "" if cell.value is None else cell.value
    return there in (value, str(value).removeprefix("'")) and not str(value).startswith("=")


@pytest.mark.first_ones(1)
@pytest.mark.parametrize(
    ("given", "back"),
    [
        ("x.xlsm", "x.out.xlsm"),
        ("../../etc/x.XLSM", "x.out.xlsm"),
        ("C:\\books\\x", "x.out.xlsx"),
        ("a/b/", "train.out.xlsx"),
        ("...", "train.out.xlsx"),
        ("x.json", "x.out.xlsx"),
        ("a\n<b>.xlsx", "a__b_.out.xlsx"),
    ],
)
def test_a_workbook_keeps_its_name_and_kind(client, given, back):
    """The ending is that of the name given, where the file can be that; folders are left out."""
    source = (TEMPLATES / "example_modified.xlsx").read_bytes()
    said = client.post("/api/v1/workbook", params={"name": given}, content=source)
    assert said.status_code == 200, said.text
    assert said.headers["Content-Disposition"] == f"attachment; filename*=UTF-8''{back}"
    assert ("macroEnabled" in said.headers["Content-Type"]) == back.endswith("xlsm")


def test_wrong_cells_come_back_as_the_contract_says(client, tmp_path):
    book = openpyxl.load_workbook(TEMPLATES / "example_proposed.xlsx")
    sheet = book["Train"]
    cell = next(c for row in sheet.iter_rows() for c in row if c.value == "Inertia")
    sheet.cell(cell.row + 2, cell.column).value = -5
    book.save(tmp_path / "wrong.xlsx")
    for path in ("/api/v1/workbook", "/api/v1/model"):
        said = client.post(path, content=(tmp_path / "wrong.xlsx").read_bytes())
        assert said.status_code == 422
        content = said.json()
        assert content["format"] == 1
        (problem,) = content["errors"]
        assert (problem["table"], problem["row"], problem["column"]) == ("Stations", 2, "Inertia")
        assert problem["message"] in content["error"]["message"]
    *_, end = open_workbook(client, (tmp_path / "wrong.xlsx").read_bytes())
    assert end == content


@pytest.mark.parametrize("body", [b"PK\x03\x04nonsense", b"nonsense", b"{}", b"\x00" * 1000])
def test_what_is_no_workbook_is_refused_without_our_folders(client, body):
    edit = {"name": "Our pump.xlsx", "changes": '{"Poles": 4}'}
    for path in ("/api/v1/inputs", "/api/v1/edited"):
        said = client.post(path, params=edit, content=body)
        assert "errors" in said.json() or said.status_code == 200, said.text
        assert tempfile.gettempdir() not in said.text
    for path in ("/api/v1/workbook", "/api/v1/model"):
        said = client.post(path, params={"name": "Our pump.xlsx"}, content=body)
        assert said.status_code in (415, 422)
        if body.startswith(b"PK"):
            assert "Our pump.xlsx is " in said.json()["error"]["message"]
        assert tempfile.gettempdir() not in said.text
        assert said.json()["error"]["message"].endswith(".")
    assert "empty" in told(client.post("/api/v1/workbook", content=b""), 400)
    if body.startswith(b"PK"):
        *_, end = open_workbook(client, body, name="x.xlsx")
        assert end["error"]["message"].endswith(".")
        assert tempfile.gettempdir() not in str(end)
    else:
        assert "workbook" in told(client.post("/api/v1/open-workbook", content=body), 415)


@pytest.mark.parametrize(
    ("body", "words"),
    [
        (
            b"train.xlsx",
            "neither a workbook (.xlsx, .xlsm) nor a case JSON, it begins with 'train.x",
        ),
        (b"\xef\xbb\xbf  Station;Inertia", "it begins with 'Station;Inertia'"),
        (b"\x00\x01\x02", "neither a workbook (.xlsx, .xlsm) nor a case JSON. Send the file"),
    ],
)
def test_a_text_is_not_called_a_json_with_an_error(client, body, words):
    said = told(client.post("/api/v1/model", content=body), 415)
    assert words in said
    assert "{ " not in said
    broken = client.post("/api/v1/model", content=b'{"format": 1,}')
    assert broken.status_code == 422
    assert "line 1" in broken.json()["error"]["message"]


def test_a_case_json_gives_the_handle_of_the_same_case(client):
    from addin.reading.case_json import case_to_json
    from addin.reading.workbook import read_workbook

    path = TEMPLATES / "example_proposed.xlsx"
    one = client.post("/api/v1/model", content=path.read_bytes()).json()
    case = json.dumps(case_to_json(read_workbook(path).data))
    other = client.post(
        "/api/v1/model", content=case, headers={"Content-Type": "application/json"}
    ).json()
    assert one["model"].removesuffix("-US") == other["model"]
    assert (one["units"], other["units"]) == ("US", "SI")
    assert one["model"] == registry.call("TV_MODEL", model_arguments())[0][0]


def test_what_cannot_be_changed_is_refused_by_its_name(client):
    body = (TEMPLATES / "example_proposed.xlsx").read_bytes()
    for changes, status, words in (
        ("", 400, "JSON object of 1 to 200"),
        ("{}", 400, "JSON object of 1 to 200"),
        ('{"Poels": 4}', 422, "Did you mean 'Poles'"),
        ('{"Elements[LS coupling].Stiffness": "soft"}', 422, "type a number"),
        ('{"Poles": true}', 422, "type a number"),
        ('{"Title": 5}', 422, "type a text"),
    ):
        said = client.post("/api/v1/edited", params={"changes": changes}, content=body)
        assert words in told(said, status)
    for path, words in (
        ("report?form=xls", "form must be one of pdf, docx."),
        ("study?study=guess", "study must be one of tune"),
        ("inputs?study=guess", "study must be one of tune"),
        ("study?study=tolerances&settings=[]", "settings as a JSON object"),
        (
            'study?study=tolerances&settings={"samples": 9}',
            "samples must be a whole number from 30",
        ),
        ('study?study=tune&settings={"top": 3}', "tune has no setting 'top'"),
        ("diff?split=x", "split must be the size"),
    ):
        assert words in told(client.post(f"/api/v1/{path}", content=body), 400)


def test_a_file_without_sheets_of_a_study_shows_its_usual_rows_and_gets_them_with_an_edit(client):
    body = (TEMPLATES / "example_modified.xlsx").read_bytes()

    def rows(name, content):
        said = client.post("/api/v1/inputs", params={"study": name}, content=content).json()
        settings = {one["name"]: one["default"] for one in said["settings"]}
        return settings, {
            table["name"]: [
                {
                    column["name"]: cell["value"]
                    for column, cell in zip(table["columns"], row["cells"], strict=True)
                    if cell["value"] is not None
                }
                for row in table["rows"]
            ]
            for table in said["tables"]
        }

    settings, tables = rows("tolerances", body)
    assert settings == {"samples": 1000, "seed": 1, "method": "lhs", "replan": False}
    stiffness, damping = tables["Scatter"]
    assert stiffness == {"Quantity": "stiffness", "Distribution": "normal", "Spread": 5.0}
    edit = {
        "study": "tolerances",
        "changes": json.dumps({"Scatter[1].Spread": 8, "Scatter[2]": None}),
    }
    now = client.post("/api/v1/edited", params=edit, content=body)
    assert now.status_code == 200
    assert rows("tolerances", now.content)[1] == {"Scatter": [stiffness | {"Spread": 8.0}]}
    assert rows("starts", now.content) == ({"standard": False}, {"StartConditions": []})
    assert rows("sensitivities", now.content) == ({}, {})


# --- descriptions ---------------------------------------------------------------------------------


def test_the_description_names_every_route_and_no_other(client):
    described = client.get("/openapi.json").json()
    parts = {"/taskpane.css", *(f"/{name}.js" for name in MODULES)}
    routes = {
        route.path
        for route in client.app.routes
        if not route.path.endswith((".png", ".xlsx")) and route.path not in parts
    }
    assert routes - {"/api/v1/stream"} == set(described["paths"])
    methods = {p: {m.upper() for m in about} for p, about in described["paths"].items()}
    for route in client.app.routes:
        if route.path in methods:
            assert methods[route.path] == route.methods - {"HEAD"}, route.path


def test_the_description_is_valid_openapi(client):
    validator = pytest.importorskip("openapi_spec_validator")
    described = client.get("/openapi.json").json()
    validator.validate(described)
    del described["paths"]["/healthz"]["get"]["responses"]["200"]["description"]
    with pytest.raises(jsonschema.ValidationError, match="description"):
        validator.validate(described)


def test_answers_are_as_described(client, handle):
    described = client.get("/openapi.json").json()

    def check(said, path):
        about = described["paths"][path][said.request.method.lower()]
        schema = about["responses"][str(said.status_code)]["content"]["application/json"]["schema"]
        jsonschema.validate(
            said.json(), {**schema, "components": described["components"]},
            cls=jsonschema.Draft202012Validator,
        )  # fmt: skip

    check(batch(client, ["TV_FREQUENCIES", handle], ["TV_NOTHING"]), "/api/v1/batch")
    check(client.post("/api/v1/batch", json={}), "/api/v1/batch")
    check(client.post("/api/v1/workbook", content=b"PK"), "/api/v1/workbook")
    source = (TEMPLATES / "example_proposed.xlsx").read_bytes()
    check(client.post("/api/v1/model", content=source), "/api/v1/model")
    line = described["components"]["schemas"]["OpenWorkbookLine"]
    for body in (source, b"PK"):
        for one in open_workbook(client, body):
            jsonschema.validate(
                one, {**line, "components": described["components"]},
                cls=jsonschema.Draft202012Validator,
            )  # fmt: skip
    for path in ("/healthz", "/version"):
        check(client.get(path), path)


def test_pages_and_pictures_are_there(client):
    for path in ("/", "/taskpane.html", "/taskpane.css", "/taskpane.js", "/icon-32.png"):
        said = client.get(path)
        assert said.status_code == 200
        assert len(said.content) > 100
        assert said.headers["X-Content-Type-Options"] == "nosniff"
    assert {path.stem for path in STATIC.glob("*.js")} == {*MODULES, "functions"}
    for name, words in client.get("/examples.json").json().items():
        assert client.get(f"/examples/{name}.xlsx").content[:2] == b"PK", words
    assert "office.js" in client.get("/taskpane.html").text
    assert "office.js" not in client.get("/").text
    assert Path(__file__).parent.name not in client.get("/").text
