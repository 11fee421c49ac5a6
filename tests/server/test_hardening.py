"""What one client does leaves the others served, and nobody sees what another has typed."""

import asyncio
import contextlib
import gzip
import json
import multiprocessing
import os
import signal
import sys
import threading
import time
import urllib.request
from contextlib import closing
from dataclasses import replace
from types import SimpleNamespace

import pytest
from servers import SLOW_PROGRAM, inside, outside, slow_case
from sheet_ranges import TEMPLATES, model_arguments
from starlette.requests import Request
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect

from addin.reading.case_json import case_to_json
from addin.reading.workbook import read_workbook
from addin.server import bounded_reading, tasks
from addin.server import calls as server_calls
from addin.server import stream as server_stream
from addin.server.answers import Refused
from addin.server.bodies import parsed, read_body
from addin.server.calls import Asked, Call, Calls
from addin.server.processes import MOST_MEMORY, Busy, Work
from addin.server.running_starts import Starts
from addin.server.settings import Limits, Settings, SettingsError, check_certificate
from addin.server.stream import Stream
from addin.workers import pool
from addin.worksheet import registry
from addin.worksheet.models import MODELS
from addin.worksheet.registry import FunctionError
from addin.xlsx.container import Limits as FileLimits

KEY = "a-key-nobody-guesses"


def results(client, *calls, **more):
    sent = {"calls": [{"name": name, "arguments": list(given)} for name, *given in calls]}
    said = client.post("/api/v1/batch", json=sent, **more)
    assert said.status_code == 200, said.text
    return said.json()["results"]


def line_of(client):
    return client.websocket_connect("/api/v1/stream", headers={"host": "127.0.0.1"})


def case_text(**changed):
    case = read_workbook(TEMPLATES / "example_proposed.xlsx").data
    return json.dumps(case_to_json(replace(case, **changed)))


def submitted(monkeypatch):
    """What is sent to the pools, as it is sent."""
    found, original = [], Work.submit

    def submit(self, task, payload):
        found.append(task)
        return original(self, task, payload)

    monkeypatch.setattr(Work, "submit", submit)
    return found


# --- whose title ----------------------------------------------------------------------------------


def test_the_page_shows_the_title_of_whoever_sent_the_train(client, monkeypatch):
    sent = submitted(monkeypatch)
    for title, owner in (("Secret", "A"), ("Ours", "B"), ("Ours, corrected", "B")):
        body = case_text(title=title, client=owner, tolerance_peak=0.00123)
        handle = client.post("/api/v1/model", content=body).json()["model"]
        with line_of(client) as line:
            line.send_json({"id": 1, "view": handle})
            while "value" not in (message := line.receive_json()):
                if "partial" in message:
                    assert message["partial"]["about"]["title"] == title
            about = message["value"]["about"]
        assert (about["title"], about["client"]) == (title, owner)
    assert sent.count("start") == 1  # the numbers are the same


# --- what is looked at ----------------------------------------------------------------------------


def test_uneven_rows_are_refused_before_they_are_filled_up(client):
    rows = [[1] * 20_000, *([[]] * 20_000)]
    for name in ("TV_CONVERT", "TV_PEAKS"):
        (told,) = results(client, [name, rows])
        assert "250,000 cells" in told["error"]["message"]


def test_the_model_of_a_call_is_one_cell_and_nothing_else_is_looked_at():
    class Long(list):
        def __iter__(self):
            raise AssertionError("looked at")

    assert Call("TV_PEAKS", [Long([[1], [2]])]).model() is None
    assert Call("TV_PEAKS", [[Long([1, 2])]]).model() is None
    handle = registry.call("TV_MODEL", model_arguments())[0][0]
    for given in (handle, [handle], [[handle]], f" {handle} "):
        assert Call("TV_PEAKS", [given]).model() is MODELS.of(handle)


def test_whole_numbers_of_any_length_are_told_in_our_words():
    with pytest.raises(Refused, match="too many digits for a cell") as told:
        parsed(b'{"a": ' + b"9" * 5000 + b"}")
    assert "sys." not in told.value.message


@pytest.mark.parametrize("path", ["workbook", "batch"])
def test_a_packed_body_is_told_as_such(client, path):
    """It was told as no Excel workbook, and as no JSON."""
    body = gzip.compress(b'{"calls": []}')
    headers = {"Content-Encoding": "gzip", "Content-Type": "application/json"}
    answer = client.post(f"/api/v1/{path}", content=body, headers=headers)
    assert answer.status_code == 415
    assert "Content-Encoding: gzip" in answer.json()["error"]["message"]


def test_half_a_character_is_no_error_of_ours(client):
    """A name with one is read with a sign in its place, and can be asked about."""
    body = case_text().replace('"Motor"', '"Mo\\ud800"')
    said = client.post("/api/v1/model", content=body)
    assert said.status_code == 200
    call = {"name": "TV_MODE", "arguments": [said.json()["model"], 1]}
    (answer,) = client.post("/api/v1/batch", json={"calls": [call]}).json()["results"]
    names = [row[0] for row in answer["value"]]
    assert [name for name in names if name.startswith("Mo")] == ["Mo\ufffd"]
    with inside(Settings(workers=1, keys=frozenset({KEY}))) as guarded:
        with line_of(guarded) as line:
            line.send_text('{"key": "\\ud800"}')
            assert "not valid on this server" in line.receive_json()["error"]["message"]


@pytest.mark.parametrize("name", ["\U00020000" * 76, "\u540d" * 76, "x" * 300])
def test_a_name_that_no_file_can_have_is_only_told(client, name):
    source = (TEMPLATES / "example_proposed.xlsx").read_bytes()
    for body, status in ((source, 200), (source[:2000], 422)):
        said = client.post("/api/v1/model", params={"name": f"{name}.xlsx"}, content=body)
        assert said.status_code == status, said.text
    assert name[-40:] in said.text.encode().decode("unicode_escape", "ignore") or "x" in said.text
    assert "torsionbook-" not in said.text


# --- WebSockets without a key ---------------------------------------------------------------------


def test_a_first_message_is_not_read_beyond_a_key(monkeypatch):
    read = []
    monkeypatch.setattr(server_stream, "parsed", lambda text: read.append(text) or {})
    with inside(Settings(workers=1, keys=frozenset({KEY}))) as client:
        with line_of(client) as line:
            line.send_text(json.dumps({"key": KEY, "more": "x" * 5000}))
            assert "API key is needed" in line.receive_json()["error"]["message"]
    assert read == []


def test_messages_are_not_deflated_and_not_longer_than_the_limit(served):
    with connect(served.replace("http", "ws") + "/api/v1/stream", compression="deflate") as line:
        assert not line.protocol.extensions
        with contextlib.suppress(ConnectionClosed):  # it may be closed while this is sent
            line.send("x" * (Limits().message + 1))
        with pytest.raises(ConnectionClosed):
            line.recv(timeout=20)


def test_large_messages_are_read_in_a_thread_and_counted(monkeypatch):
    threads, original = [], server_stream.parsed

    def noted(text):
        threads.append(threading.current_thread() is threading.main_thread())
        return original(text)

    monkeypatch.setattr(server_stream, "parsed", noted)
    text = json.dumps({"id": 1, "name": "TV_CONVERT", "arguments": [1, "m", "mm", "x" * 1_000_001]})
    for most, words in ((1, "at most 3 arguments"), (0, "large requests")):
        with inside(Settings(workers=1, limits=Limits(large=most))) as client:
            with line_of(client) as line:
                line.send_text(text)
                assert words in line.receive_json()["error"]["message"]
    assert len(threads) == 1


def test_sockets_that_send_no_key_take_no_place_of_others():
    limits = Limits(strangers=3, requests=2)
    keyed = {"X-API-Key": KEY}
    with (
        inside(Settings(workers=1, keys=frozenset({KEY}), limits=limits)) as client,
        contextlib.ExitStack() as idle,
    ):
        call = ["TV_CONVERT", 1, "m", "mm"]
        results(client, call, headers=keyed)  # its process starts, longer than a socket has here
        lines = [idle.enter_context(line_of(client)) for _ in range(6)]
        assert client.get("/healthz").status_code == 200
        assert results(client, call, headers=keyed)[0]["value"]
        for line in lines[:3]:  # the oldest made room
            assert "API key" in line.receive_json()["error"]["message"]
        newest = lines[-1]
        newest.send_json({"key": KEY})
        newest.send_json({"id": 1, "name": "TV_CONVERT", "arguments": [1, "m", "mm"]})
        assert newest.receive_json()["value"] == [[1000.0]]
        lines[-2].send_json({"key": KEY})
        lines[-3].send_json({"key": KEY})  # each with a key counts as a request
        said = [line.receive_json() for line in (lines[-3],)]
        assert "2 requests" in said[0]["error"]["message"]


def test_health_is_told_however_much_there_is_to_do():
    with inside(Settings(workers=1, limits=Limits(requests=0))) as client:
        assert client.get("/version").status_code == 503
        assert client.get("/healthz").json() == {"ok": True}


def test_a_body_that_does_not_come_is_given_up():
    async def receive():
        if sent:
            await asyncio.sleep(60.0)
        sent.append(1)
        return {"type": "http.request", "body": b"{", "more_body": True}

    sent = []
    request = Request({"type": "http", "method": "POST", "headers": []}, receive)
    with pytest.raises(Refused, match="too slowly") as told:
        asyncio.run(read_body(request, 1000, 0.1))
    assert told.value.status == 408


# --- what one WebSocket holds ---------------------------------------------------------------------


class Client:
    """A WebSocket whose client reads nothing until it is told to."""

    def __init__(self, *messages):
        self.scope = {}
        self.headers = {}
        self.reads = asyncio.Event()
        self.got = []
        self.taken = 0
        self._messages = list(messages)

    async def accept(self):
        pass

    async def receive(self):
        if self.taken < len(self._messages):
            self.taken += 1
            return {"type": "websocket.receive", "text": json.dumps(self._messages[self.taken - 1])}
        await asyncio.sleep(60.0)

    async def send_text(self, text):
        await self.reads.wait()
        self.got.append(json.loads(text))


def streaming(scene, *messages):
    """A scene with a stream that has these messages to read."""

    async def act():
        calls = Calls(Starts(None), Limits())
        client = Client(*messages)
        stream = Stream(client, Settings(), calls, Starts(None))
        serving = asyncio.create_task(stream.serve())
        try:
            return await scene(client, stream, calls)
        finally:
            serving.cancel()
            await asyncio.gather(serving, return_exceptions=True)
            calls.close()
            assert calls._unsent.cells == 0

    return asyncio.run(act())


def convert(identity):
    return {"id": identity, "name": "TV_CONVERT", "arguments": [1, "m", "mm"]}


async def until(condition):
    for _ in range(400):
        if condition():
            return
        await asyncio.sleep(0.025)
    raise AssertionError("it did not come to that")


def test_a_call_that_is_cancelled_before_it_begins_is_told_and_leaves_its_place():
    async def scene(client, stream, calls):
        client.reads.set()
        for k in range(3):
            stream._begin(k, convert(k), 100)
            stream._cancel(k)
        await until(lambda: len(client.got) == 3)
        assert all(one.get("cancelled") for one in client.got)
        assert stream._running == {}

    streaming(scene)


def test_a_client_that_does_not_read_has_little_calculated(monkeypatch):
    asked = []
    monkeypatch.setattr(server_calls, "call", lambda name, given: asked.append(1) or [[1.0]])

    async def scene(client, stream, calls):
        await until(lambda: client.taken == 40)
        await asyncio.sleep(0.3)
        assert len(asked) == server_stream.MOST_VALUES
        client.reads.set()
        await until(lambda: len(client.got) == 40)
        assert len(asked) == 40

    streaming(scene, *map(convert, range(40)))


def test_a_client_that_does_not_read_is_not_listened_to(monkeypatch):
    monkeypatch.setattr(server_stream, "MOST_MESSAGES", 5)

    async def scene(client, stream, calls):
        await asyncio.sleep(0.3)
        assert client.taken < 10
        client.reads.set()
        await until(lambda: len(client.got) == 50)

    streaming(scene, *({"nothing": k} for k in range(50)))


def test_a_client_that_never_reads_is_let_go(monkeypatch):
    monkeypatch.setattr(server_stream, "READ_TIME", 0.1)

    async def scene():
        calls = Calls(Starts(None), Limits())
        stream = Stream(Client(convert(1)), Settings(), calls, Starts(None))
        await asyncio.wait_for(stream.serve(), 10.0)
        calls.close()

    asyncio.run(scene())


# --- what one request holds -----------------------------------------------------------------------


def test_no_call_is_made_whose_answer_has_no_room(monkeypatch):
    asked = []
    monkeypatch.setattr(server_calls, "call", lambda name, given: asked.append(1) or [[1.0] * 4])
    monkeypatch.setattr(server_calls, "MOST_CELLS", 10)

    async def scene():
        calls = Calls(Starts(None), Limits())
        with closing(calls.new_unsent_cells()) as room:
            found = await calls.answers(Asked([Call("TV_CONVERT", [])] * 2000, room))
            assert calls._unsent.cells == 8
            monkeypatch.setattr(server_calls, "MOST_UNSENT", 11)
            other = await calls.answers(Asked([Call("TV_CONVERT", [])], calls.new_unsent_cells()))
        assert calls._unsent.cells == 0
        calls.close()
        return found, other

    found, (other,) = asyncio.run(scene())
    assert ["value" in one for one in found] == [True, True, *[False] * 1998]
    assert len(asked) == 4
    assert "busy sending results" in other["error"]["message"]


def test_requests_of_many_calls_take_turns(monkeypatch):
    def slow(name, given):
        if name == "TV_SLOW":
            time.sleep(0.04)
        return [[1.0]]

    monkeypatch.setattr(server_calls, "call", slow)

    async def scene():
        calls = Calls(Starts(None), Limits())
        many = [
            asyncio.create_task(
                calls.answers(Asked([Call("TV_SLOW", [])] * 60, calls.new_unsent_cells()))
            )
            for _ in range(16)
        ]
        await asyncio.sleep(0.2)
        (found,) = await calls.answers(Asked([Call("TV_CONVERT", [])], calls.new_unsent_cells()))
        assert found == {"value": [[1.0]]}
        assert not any(task.done() for task in many)
        for task in many:
            task.cancel()
        await asyncio.gather(*many, return_exceptions=True)
        calls.close()

    asyncio.run(scene())


def test_a_call_that_was_never_begun_is_told_that_it_waited(monkeypatch):
    gate = threading.Event()

    def blocked(name, given):
        gate.wait(20.0)
        return [[1.0]]

    monkeypatch.setattr(server_calls, "call", blocked)

    async def scene():
        calls = Calls(Starts(None), Limits(short_time=0.3))
        begun = [
            asyncio.create_task(
                calls.answers(Asked([Call("TV_CONVERT", [])], calls.new_unsent_cells()))
            )
            for _ in range(8)
        ]
        await asyncio.sleep(0.05)
        (waited,) = await calls.answers(Asked([Call("TV_CONVERT", [])], calls.new_unsent_cells()))
        assert await calls.encoded({"a": 1}) == b'{"a":1}'  # JSON has threads of its own
        took = await asyncio.gather(*begun)
        gate.set()
        calls.close()
        return waited, took

    waited, took = asyncio.run(scene())
    assert "this call waited 0.3 s" in waited["error"]["message"]
    assert all("took longer than 0.3 s" in one["error"]["message"] for (one,) in took)


@pytest.mark.slow
def test_large_trains_are_calculated_in_the_pool(client, monkeypatch):
    monkeypatch.setattr(server_calls, "LARGE_TRAIN", 5)
    monkeypatch.setattr("addin.worksheet.answers.speed_results", None)  # would raise
    sent = submitted(monkeypatch)
    arguments = model_arguments("example_backlash")
    arguments[0] = [*arguments[0]]
    handle = results(client, ["TV_MODEL", *arguments])[0]["value"][0][0]
    MODELS.of(handle).kept.clear()
    calls = [["TV_FREQUENCIES", handle], ["TV_MODE", handle, 1], ["TV_MARGINS", handle]]
    answers = results(client, *calls)
    with line_of(client) as line:
        line.send_json({"id": 1, "view": handle})
        while "partial" not in (message := line.receive_json()):
            pass
    assert sent[:2] == ["speed", "view"]
    assert message["partial"]["handle"] == handle
    monkeypatch.undo()
    MODELS.of(handle).kept.clear()
    assert [one["value"] for one in answers] == [registry.call(n, given) for n, *given in calls]


@pytest.mark.slow
def test_results_dropped_for_want_of_memory_reach_whoever_waited(client, monkeypatch):
    """Each is dropped as the next one comes; none is calculated in the server's own process."""
    monkeypatch.setattr("addin.calculation.calculation.calculate", None)  # would raise
    monkeypatch.setattr(MODELS, "_most_memory", 1)
    names = ("example_modified", "example_proposed")
    handles = [results(client, ["TV_MODEL", *model_arguments(n)])[0]["value"][0][0] for n in names]
    for one in handles:
        MODELS.of(one).kept.clear()
    answers = results(client, *(["TV_PEAKS", one] for one in handles), ["TV_STARTS", handles[0]])
    assert all("value" in one for one in answers), answers


def test_files_are_read_in_the_pool_within_limits(client, monkeypatch):
    sent = submitted(monkeypatch)
    source = TEMPLATES / "example_proposed.xlsx"
    assert client.post("/api/v1/model", content=source.read_bytes()).status_code == 200
    assert sent == ["read"]
    monkeypatch.setattr(bounded_reading, "LIMITS", FileLimits(total_size=10_000))
    problems, *_, case, _ = tasks._read(str(source), lambda stage: None)
    assert case is None
    assert "too large" in problems[0].message or "MB" in problems[0].message
    (again,), *_ = tasks.TASKS["workbook"]((str(source), "nowhere"), lambda stage: None)
    assert again.message == problems[0].message


@pytest.mark.skipif(sys.platform != "linux", reason="other systems have no such limit")
def test_memory_of_what_reads_uploads_is_bounded(monkeypatch):
    """Whatever got past the limits of the file: the process refuses, and has its memory back."""
    monkeypatch.setattr(bounded_reading, "READING", 2**20)
    monkeypatch.setattr(bounded_reading, "read_checked", lambda source, limits: bytearray(2**28))
    (problem,), *_ = tasks._read("train.xlsx", lambda stage: None)
    assert "train.xlsx takes more memory than this server allows" in problem.message
    (again,), *_ = tasks.TASKS["workbook"](("train.xlsx", "nowhere"), lambda stage: None)
    assert again.message == problem.message
    assert len(bytearray(2**28)) == 2**28


# --- processes that die ---------------------------------------------------------------------------


def dying(*scripts):
    """Processes that say what they are told to, and then end."""
    left = list(scripts)

    class Process:
        is_ready = True
        is_leaving = False
        is_alive = True

        def __init__(self, serve):
            words = iter(left.pop(0) if left else [])

            def recv():
                for word in words:
                    return word
                raise EOFError

            self.line = SimpleNamespace(send=lambda x: None, poll=lambda x: True, recv=recv)

        def end(self):
            self.is_alive = False

        ended = end

    return Process


@pytest.mark.parametrize(
    ("scripts", "found"),
    [
        (([], [("done", ("done", 5))]), 5),
        (([("ready", None)], [("stage", "a"), ("done", ("done", 6))]), 6),
        (([("stage", "a")], [("done", ("done", 5))]), None),
        (([], [], [("done", ("done", 5))]), None),
    ],
)
def test_a_task_whose_process_died_before_its_first_word_is_tried_once_more(
    monkeypatch, scripts, found
):
    monkeypatch.setattr(pool, "_Process", dying(*scripts))
    work = Work(1, 2, 20.0)
    job = work.submit("wait", 0.0)
    if found is None:
        with pytest.raises(RuntimeError, match="ended unexpectedly"):
            job.future.result(10.0)
    else:
        assert job.future.result(10.0) == found
    work.close()


def test_a_process_that_has_grown_too_large_is_replaced_without_a_word(monkeypatch, caplog):
    one, two, three = (("done", ("done", n)) for n in (1, 2, 3))
    monkeypatch.setattr(pool, "_Process", dying([("leaving", None), one], [two, three]))
    work = Work(1, 2, 20.0)
    assert [work.submit("wait", 0.0).future.result(10.0) for _ in range(3)] == [1, 2, 3]
    work.close()
    assert [r.getMessage() for r in caplog.records] == []


@pytest.mark.parametrize(
    ("used", "said"), [(1e9, ["stage", "done"]), (2e9, ["stage", "leaving", "done"])]
)
def test_a_process_that_has_grown_too_large_says_so_with_its_last_answer(monkeypatch, used, said):
    monkeypatch.setattr(pool, "most_resident", lambda: used)
    ours, theirs = multiprocessing.Pipe()
    process = threading.Thread(target=pool._serve, args=(theirs, tasks.load, MOST_MEMORY))
    process.start()
    assert ours.recv() == ("ready", None)
    ours.send((tasks.answer_of, ("wait", 0.0), True))
    assert [ours.recv()[0] for _ in said] == said
    if "leaving" not in said:
        assert not ours.poll(0.2)
        ours.close()
    process.join(10.0)
    assert not process.is_alive()


def test_a_workbook_whose_process_died_is_told_as_busy(client, monkeypatch):
    original = Work.submit

    def submit(self, task, payload):
        job = original(self, "wait", 0.0)
        job.future.cancel()
        job = pool.Job(pool.Task(tasks.answer_of, (task, payload)))
        job.future.set_exception(RuntimeError("The process ended unexpectedly. Try again."))
        return job

    monkeypatch.setattr(Work, "submit", submit)
    source = (TEMPLATES / "example_proposed.xlsx").read_bytes()
    for path in ("/api/v1/workbook", "/api/v1/model"):
        said = client.post(path, content=source)
        assert said.status_code == 503
        assert "ended unexpectedly" in said.json()["error"]["message"]


def test_tasks_given_up_make_room_in_the_queue():
    work = Work(1, 2, 20.0)
    first = work.submit("wait", 30.0)
    while first.stage != "waiting":
        time.sleep(0.02)
    for _ in range(5):
        work.submit("wait", 0.0).cancel()
    waiting = work.submit("wait", 0.0)
    work.stop()
    for job in (first, waiting):
        with pytest.raises(Busy, match="being stopped"):
            job.future.result(10.0)
    work.close()


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="a signal of POSIX")
def test_a_server_that_is_told_to_end_answers_what_it_was_asked():
    with outside(program=SLOW_PROGRAM) as address:
        (model,) = ask(address, ["TV_MODEL", *slow_case()])
        found = []
        thread = threading.Thread(
            target=lambda: found.extend(ask(address, ["TV_PEAKS", model["value"][0][0]]))
        )
        thread.start()
        time.sleep(1.0)
        os.kill(address.pid, signal.SIGTERM)
        thread.join(30.0)
    assert "being stopped" in found[0]["error"]["message"]


def ask(address, *calls):
    body = json.dumps({"calls": [{"name": n, "arguments": list(a)} for n, *a in calls]}).encode()
    request = urllib.request.Request(
        f"{address}/api/v1/batch", body, {"Content-Type": "application/json"}
    )
    with urllib.request.urlopen(request, timeout=60) as said:
        return json.load(said)["results"]


# --- settings -------------------------------------------------------------------------------------


@pytest.mark.parametrize("url", ["https://[::1", "https://x:99999/", "https://x:0", "https://x:y"])
def test_addresses_that_are_none_are_told(url):
    with pytest.raises(SettingsError, match="write an address"):
        Settings(public_url=url)


def test_keys_that_cannot_be_used_are_told(tmp_path, monkeypatch):
    cert, key = tmp_path / "cert.pem", tmp_path / "key.pem"
    cert.write_text("-----BEGIN CERTIFICATE-----\nbm90IGEgY2VydA==\n-----END CERTIFICATE-----\n")
    key.write_text("-----BEGIN PRIVATE KEY-----\nbm90IGEga2V5\n-----END PRIVATE KEY-----\n")
    settings = Settings(certificate=cert, certificate_key=key)
    with pytest.raises(SettingsError, match="cannot be used"):
        check_certificate(settings)
    key.write_text("-----BEGIN ENCRYPTED PRIVATE KEY-----\n")
    monkeypatch.setattr(sys, "stdin", None)
    with pytest.raises(SettingsError, match="no terminal to enter its password"):
        check_certificate(settings)


def test_a_function_of_no_name_has_no_model():
    assert Call("TV_NOTHING", ["tv:x"]).model() is None
    with pytest.raises(FunctionError, match="Unknown function"):
        registry.call("TV_NOTHING", [])
