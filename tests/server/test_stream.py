"""A real server with a real WebSocket: stages, results, cancel, keys, certificates."""

import asyncio
import contextlib
import json
import os
import socket
import subprocess
import sys
import time
import urllib.request
from pathlib import Path
from urllib.parse import urlsplit

import openpyxl
import pytest
from messages import stream_of, until_stage, until_the_end
from servers import ROOT, SLOW, outside, slow_case
from sheet_ranges import TEMPLATES, model_arguments, with_conditions, with_event
from typer.testing import CliRunner
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import connect

from addin.cli.app import app
from addin.server.client import Client, Refusal
from addin.server.processes import Busy, TooLong, Work
from addin.server.running_starts import Starts, waited_for
from addin.server.settings import Settings, SettingsError, check_certificate, read_keys
from addin.worksheet import registry
from addin.worksheet.models import RUN, Models

KEY = "a-key-nobody-guesses"


def ask(address, *calls, **headers):
    body = json.dumps({"calls": [{"name": n, "arguments": list(a)} for n, *a in calls]}).encode()
    request = urllib.request.Request(
        address + "/api/v1/batch", body, {"Content-Type": "application/json", **headers}
    )
    with urllib.request.urlopen(request, timeout=60) as said:
        return json.load(said)["results"]


def model_at(address, name="example_proposed"):
    source = (TEMPLATES / f"{name}.xlsx").read_bytes()
    request = urllib.request.Request(address + "/api/v1/model", source)
    with urllib.request.urlopen(request, timeout=60) as said:
        return json.load(said)["model"]


def test_a_long_call_tells_its_stages_and_gives_the_same_doubles(served):
    # a tolerance of its own, so that no other test has had this start calculated
    stations, elements, case, *rest = model_arguments("example_modified")
    arguments = [stations, elements, [*case, ["TolerancePeak", 0.00123, "1"]], *rest]
    handle = ask(served, ["TV_MODEL", *arguments])[0]["value"][0][0]
    with stream_of(served) as line:
        line.send(json.dumps({"id": 7, "name": "TV_PEAKS", "arguments": [handle]}))
        *stages, last = until_the_end(line, 7)
    words = [one["stage"] for one in stages]
    other = "motor curves at the other speed"
    assert words[-5:] == ["start", "plan", other, "fatigue", "crossings"]
    registry.call("TV_MODEL", arguments)
    assert repr(last["value"]) == repr(registry.call("TV_PEAKS", [handle]))
    assert ask(served, ["TV_PEAKS", handle])[0]["value"] == last["value"]


def test_a_view_comes_in_two_parts(served):
    handle = model_at(served, "example_backlash")
    with stream_of(served) as line:
        line.send(json.dumps({"id": "a", "view": handle}))
        first, *_, last = until_the_end(line, "a")
        head, *rows = last["value"]["tables"]["StartupPeaks"]
        name, at, most = (
            next(j for j, header in enumerate(head) if header.startswith(word))
            for word in ("Element", "Time", "Maximum torque")
        )
        row = next(row for row in rows if row[name] == "LS coupling")
        window = {"from": row[at] - 0.05, "to": row[at] + 0.05}
        line.send(
            json.dumps({"id": 2, "histories": handle, "elements": ["LS coupling", "?"], **window})
        )
        *_, seen = until_the_end(line, 2)
    (history,) = seen["value"]
    time, value = history["time"], history["value"]
    # a point before the window and one behind it
    assert time[1] >= window["from"] > time[0]
    assert time[-2] <= window["to"] < time[-1]
    assert max(value) == pytest.approx(row[most], rel=1e-3)  # a drawn point has fewer digits
    assert history["limit"]["upper"] > 0
    partial, whole = first["partial"], last["value"]
    assert not partial["complete"]
    assert partial["charts"]["ChartSpeedTime"]["Time"] == []
    assert len(whole["charts"]["ChartSpeedTime"]["Time"]) > 100
    for shared in ("NaturalFrequencies", "SeparationMargins"):
        assert partial["tables"][shared] == whole["tables"][shared]
    assert whole["tables"]["Verdicts"][1:]
    assert whole["outcome"]
    registry.call("TV_MODEL", model_arguments("example_backlash"))
    assert whole["tables"]["StartupPeaks"] == registry.call("TV_PEAKS", [handle])


def test_the_view_of_a_model_with_an_event_has_its_peaks(served):
    (answer,) = ask(served, ["TV_MODEL", *with_conditions(with_event(model_arguments()))])
    handle = answer["value"][0][0]
    with stream_of(served) as line:
        line.send(json.dumps({"id": "a", "view": handle}))
        *_, last = until_the_end(line, "a")
    rows = last["value"]["tables"]["EventPeaks"]
    assert {row[0] for row in rows[1:]} == {"Fault"}
    assert ask(served, ["TV_EVENTS", handle])[0]["value"] == rows


def test_several_requests_share_a_socket_and_wrong_ones_end_nothing(served):
    handle = model_at(served)
    wrong = [
        "{", "[]", "{}", '{"id": true}', '{"id": 1.5, "name": "TV_PEAKS"}', '{"id": 5, "view": 3}',
        '{"id": 7, "histories": 3}', '{"id": 7, "histories": "tv:", "elements": "LS"}',
        '{"id": 6, "name": 3}', '{"id": 8, "name": "TV_PEAKS", "arguments": 3}',
    ]  # fmt: skip
    with stream_of(served) as line:
        for text in wrong:
            line.send(text)
        line.send(json.dumps({"id": 90, "name": "TV_CONVERT", "arguments": [1, "m", "mm"]}))
        line.send(json.dumps({"id": 91, "name": "TV_STARTS", "arguments": [handle]}))
        line.send(json.dumps({"id": 92, "name": "TV_PEAKS", "arguments": ["tv:none"]}))
        ends = {}
        refused = 0
        while len(ends) < 3:
            message = json.loads(line.recv(timeout=60))
            if message["id"] in (90, 91, 92):
                if "stage" not in message:
                    ends[message["id"]] = message
            else:
                refused += 1
                assert message["error"]["message"].endswith((".", "}."))
    assert refused == len(wrong)
    assert ends[90]["value"] == [[1000.0]]
    assert "value" in ends[91]
    assert ends[92]["error"]["code"] == "#N/A"


def ended_within(line, seconds):
    """Whether something comes to its end in that time."""
    until = time.monotonic() + seconds
    while (left := until - time.monotonic()) > 0.0:
        with contextlib.suppress(TimeoutError):
            if "stage" not in json.loads(line.recv(timeout=left)):
                return True
    return False


def test_cancel_ends_the_calculation_and_short_calls_do_not_wait(served):
    (model,) = ask(served, ["TV_MODEL", *slow_case()])
    handle = model["value"][0][0]
    with stream_of(served) as line:
        line.send(json.dumps({"id": 1, "name": "TV_PEAKS", "arguments": [handle]}))
        line.send(json.dumps({"id": 2, "name": "TV_STARTS", "arguments": [handle]}))
        until_stage(line, "start")
        began = time.monotonic()
        assert "value" in ask(served, ["TV_FREQUENCIES", handle])[0]
        assert time.monotonic() - began < 2.0
        # one of two who wait goes: the other still waits
        line.send(json.dumps({"id": 1, "cancel": True}))
        assert until_the_end(line, 1)[-1] == {"cancelled": True}
        assert not ended_within(line, 0.7)
        line.send(json.dumps({"id": 2, "cancel": True}))
        assert until_the_end(line, 2)[-1] == {"cancelled": True}
    # the process was ended: the next start does not wait for the one given up
    began = time.monotonic()
    other = model_at(served)
    assert "value" in ask(served, ["TV_PEAKS", other])[0]
    assert time.monotonic() - began < 30.0


@pytest.mark.slow
def test_a_client_that_is_gone_leaves_nothing_running(served):
    (model,) = ask(served, ["TV_MODEL", *slow_case()])
    with stream_of(served) as line:
        line.send(json.dumps({"id": 1, "view": model["value"][0][0]}))
        until_stage(line, "start")
    began = time.monotonic()
    (bare,) = ask(served, ["TV_MODEL", *model_arguments("example_modified")])
    assert "value" in ask(served, ["TV_PEAKS", bare["value"][0][0]])[0]
    assert time.monotonic() - began < 30.0


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="finds processes in /proc")
@pytest.mark.parametrize("route", ["/api/v1/batch", "/api/v1/workbook"])
def test_a_connection_that_is_closed_cancels_its_request(served, tmp_path, route):
    """The one process for starts is ended and replaced; one that ends its start lives on."""
    if route.endswith("batch"):
        (model,) = ask(served, ["TV_MODEL", *slow_case()])
        body = json.dumps({"calls": [{"name": "TV_PEAKS", "arguments": [model["value"][0][0]]}]})
        body, kind = body.encode(), "application/json"
    else:
        body, kind = slow_workbook(tmp_path).read_bytes(), "application/octet-stream"
    place = urlsplit(served)
    stations, elements, case, *rest = model_arguments("example_modified")
    number = 0.00111 if route.endswith("batch") else 0.00112  # starts that no other test asks for

    def starts(tolerance):
        own = [*case, ["TolerancePeak", tolerance, "1"]]
        (other,) = ask(served, ["TV_MODEL", stations, elements, own, *rest])
        return "value" in ask(served, ["TV_PEAKS", other["value"][0][0]])[0]

    assert starts(number)  # the process is there
    before = spawned(served.pid)
    with socket.create_connection((place.hostname, place.port)) as line:
        head = f"POST {route} HTTP/1.1\r\nHost: {place.netloc}\r\nContent-Type: {kind}\r\n"
        line.sendall(f"{head}Content-Length: {len(body)}\r\n\r\n".encode() + body)
        line.settimeout(2.0)
        with pytest.raises(TimeoutError):
            line.recv(100)
    assert starts(2.0 * number)
    assert before - spawned(served.pid)


def slow_workbook(folder):
    """A workbook with the start of `slow_case`."""
    book = openpyxl.load_workbook(TEMPLATES / "example_backlash.xlsx")
    for name, value, _ in SLOW:
        sheet, cell = book.defined_names[name].attr_text.split("!")
        book[sheet.strip("'")][cell.replace("$", "")].value = (
            100.0 * value
        )  # the template has it in %
    book.save(folder / "slow.xlsx")
    return folder / "slow.xlsx"


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="finds processes in /proc")
def test_the_processes_end_with_the_server():
    with outside() as address:
        handle = model_at(address, "example_proposed")
        assert "value" in ask(address, ["TV_PEAKS", handle])[0]
        before = spawned(address.pid)
        assert before
    for pid in before:
        until = time.monotonic() + 5.0
        while Path(f"/proc/{pid}").exists() and time.monotonic() < until:
            time.sleep(0.1)
        assert not Path(f"/proc/{pid}").exists()


def spawned(parent):
    """The processes for starts of a server."""
    found = set()
    for path in Path("/proc").glob("[0-9]*/status"):
        with contextlib.suppress(OSError):
            command = path.with_name("cmdline").read_bytes()
            if b"spawn_main" in command and f"PPid:\t{parent}\n" in path.read_text():
                found.add(int(path.parent.name))
    return found


# --- keys and certificates ------------------------------------------------------------------------


@pytest.fixture(scope="module")
def key_file(tmp_path_factory):
    path = tmp_path_factory.mktemp("keys") / "keys.txt"
    path.write_text(f"# of the office\n{KEY}  # the only one\n")
    return path


@pytest.mark.slow
def test_a_stream_needs_a_key_where_calls_do(key_file):
    with outside("--api-key-file", str(key_file)) as address:
        assert ask(address, ["TV_CONVERT", 1, "m", "mm"], **{"X-API-Key": KEY})
        convert = json.dumps({"id": 1, "name": "TV_CONVERT", "arguments": [1, "m", "mm"]})
        with stream_of(address) as line:
            line.send(json.dumps({"key": KEY}))
            line.send(convert)
            assert until_the_end(line, 1)[-1]["value"] == [[1000.0]]
        for first in (convert, '{"key": "wrong"}', "{", '{"key": 3}'):
            with stream_of(address) as line, contextlib.suppress(ConnectionClosed):
                line.send(first)
                said = json.loads(line.recv(timeout=20))
                assert "API key" in said["error"]["message"]
                line.recv(timeout=20)
            assert line.close_code == 4401


def test_a_page_of_another_site_gets_no_stream(served):
    url = served.replace("http", "ws") + "/api/v1/stream"
    with pytest.raises(InvalidStatus) as refused:
        connect(url, origin="https://elsewhere.example")
    assert refused.value.response.status_code == 403


def certificate(folder):
    """One for 127.0.0.1, made by openssl."""
    files = folder / "cert.pem", folder / "key.pem"
    subprocess.run(
        ["openssl", "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-days", "2", "-subj", "/CN=torsion",
         "-addext", "subjectAltName=IP:127.0.0.1", "-out", files[0], "-keyout", files[1]],
        check=True, capture_output=True, timeout=60,
    )  # fmt: skip
    return files


@pytest.mark.slow
def test_https_beyond_this_machine_with_certificate_and_keys(tmp_path, key_file, monkeypatch):
    import ssl

    cert, key = certificate(tmp_path)
    words = ["--host", "127.0.0.1", "--cert", str(cert), "--key", str(key)]
    with outside(*words, "--api-key-file", str(key_file)) as address:
        assert address.startswith("https://")
        trusted = ssl.create_default_context(cafile=str(cert))
        with urllib.request.urlopen(address + "/healthz", timeout=20, context=trusted) as said:
            assert json.load(said) == {"ok": True}
        with pytest.raises(Refusal, match="set the environment variable SSL_CERT_FILE"):
            Client(address, key=KEY).call("TV_CONVERT", 1, "m", "mm")
        monkeypatch.setenv("SSL_CERT_FILE", str(cert))
        assert Client(address, key=KEY).call("TV_CONVERT", 1, "m", "mm") == [[1000.0]]


@pytest.mark.first_ones(1)
@pytest.mark.parametrize(
    ("swapped", "by_the_command"), [(True, True), (False, False), (False, True)]
)
def test_files_that_are_no_certificate_and_key_are_told(tmp_path, swapped, by_the_command):
    cert, key = certificate(tmp_path)
    if swapped:
        words, told = [key, cert], "swap them"
    else:
        (tmp_path / "other").mkdir()
        words, told = [cert, certificate(tmp_path / "other")[1]], "does not match the certificate"
    with pytest.raises(SettingsError, match=told):
        check_certificate(Settings(certificate=words[0], certificate_key=words[1]))
    if by_the_command:
        done = subprocess.run(
            [sys.executable, "-m", "addin.cli", "serve", "--port", "0",
             "--cert", str(words[0]), "--key", str(words[1])],
            cwd=ROOT, capture_output=True, text=True, timeout=60, check=False,
        )  # fmt: skip
        assert done.returncode == 2
        assert told in done.stderr
        assert "Traceback" not in done.stderr
    text = tmp_path / "text.pem"
    text.write_text("nothing")
    for wrong in ((text, key), (cert, text), (text, text)):
        settings = Settings(certificate=wrong[0], certificate_key=wrong[1])
        with pytest.raises(SettingsError, match="in PEM"):
            check_certificate(settings)
    check_certificate(Settings(certificate=cert, certificate_key=key))


# --- settings that would expose the server --------------------------------------------------------


def test_settings_that_cannot_be_served_with(tmp_path):
    real = tmp_path / "x.pem"
    real.write_text("x")
    some = frozenset({KEY})
    for settings, words in (
        ({"host": "0.0.0.0"}, "encryption"),
        ({"host": "0.0.0.0", "keys": some}, "encryption"),
        ({"host": "192.168.1.4", "certificate": real, "certificate_key": real}, "API keys"),
        ({"certificate": real}, "needs a certificate and its private key"),
        ({"certificate": real, "certificate_key": tmp_path / "none.pem"}, "not found"),
        ({"workers": 0}, "at least 1"),
        ({"port": 70000}, "65535"),
        ({"public_url": "torsion.example.com"}, "https://"),
    ):
        with pytest.raises(SettingsError, match=words):
            Settings(**settings)
    Settings(host="0.0.0.0", certificate=real, certificate_key=real, keys=some)


def test_the_command_refuses_in_a_sentence():
    done = CliRunner().invoke(app, ["serve", "--host", "0.0.0.0"])
    assert done.exit_code == 2
    assert "read in transit" in done.output
    assert "Traceback" not in done.output


@pytest.mark.parametrize("text", ["", "# nothing\n", "short\n", "with a blank in the middle\n"])
def test_key_files_that_cannot_be_used(tmp_path, text):
    path = tmp_path / "keys"
    path.write_text(text)
    with pytest.raises(SettingsError):
        read_keys(path)
    with pytest.raises(SettingsError, match="cannot be read"):
        read_keys(tmp_path / "none")


# --- the pool -------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def pool():
    work = Work(processes=1, waiting=2, time_limit=20.0)
    yield work
    work.close()


@pytest.mark.slow
def test_the_queue_is_bounded_and_tasks_may_be_given_up(pool):
    first = pool.submit("wait", 30.0)
    while first.stage != "waiting":
        time.sleep(0.05)
    second, third = pool.submit("wait", 0.0), pool.submit("wait", 0.1)
    with pytest.raises(Busy, match="Try again"):
        pool.submit("wait", 0.0)
    second.cancel()
    first.cancel()
    assert third.future.result(20.0) == 0.1
    assert first.future.exception(5.0) is not None


@pytest.mark.slow
def test_what_takes_too_long_is_stopped():
    work = Work(processes=1, waiting=2, time_limit=0.5)
    try:
        assert work.submit("wait", 0.0).future.result(30.0) == 0.0
        with pytest.raises(TooLong, match=r"0\.5 s"):
            work.submit("wait", 60.0).future.result(30.0)
    finally:
        work.close()


@pytest.mark.skipif(sys.platform != "linux", reason="finds processes in /proc")
def test_a_process_that_ends_by_itself_is_replaced(pool):
    import signal

    job = pool.submit("wait", 30.0)
    while job.stage != "waiting":
        time.sleep(0.05)
    for pid in spawned(os.getpid()):
        os.kill(pid, signal.SIGKILL)
    with pytest.raises(RuntimeError, match="ended unexpectedly"):
        job.future.result(20.0)
    assert pool.submit("wait", 0.1).future.result(30.0) == 0.1


@pytest.mark.slow
def test_processes_that_cannot_be_started_are_told_and_tried_again(monkeypatch):
    from addin.workers import pool as module

    real, refusing = module._Process, True

    def perhaps(serve):
        if refusing:
            raise OSError("no more processes")
        return real(serve)

    monkeypatch.setattr(module, "_Process", perhaps)
    pool = Work(processes=1, waiting=2, time_limit=20.0)
    try:
        with pytest.raises(RuntimeError, match="could not start"):
            pool.submit("wait", 0.0).future.result(10.0)
        refusing = False
        assert pool.submit("wait", 0.1).future.result(30.0) == 0.1
    finally:
        pool.close()


def test_an_error_of_ours_is_told_without_its_insides(pool):
    with pytest.raises(RuntimeError, match="inside torsionbook") as told:
        pool.submit("workbook", 3).future.result(30.0)
    assert "TypeError" not in str(told.value)


@pytest.mark.slow
def test_whoever_waits_last_ends_the_calculation(pool):
    """Two wait for one start; the first goes, then the second: the job is cancelled then only."""
    models = Models()
    from addin.reading.workbook import read_workbook

    model = models.add(read_workbook(TEMPLATES / "example_proposed.xlsx"))

    async def scene():
        blocker = pool.submit("wait", 30.0)
        starts = Starts(pool)
        waiting = [asyncio.create_task(starts.ready(model)) for _ in range(2)]
        await asyncio.sleep(0.2)
        (shared,) = starts._shared.values()
        waiting[0].cancel()
        await asyncio.gather(waiting[0], return_exceptions=True)
        assert not shared.task.done()
        waiting[1].cancel()
        await asyncio.gather(waiting[1], return_exceptions=True)
        await asyncio.sleep(0.1)
        assert shared.task.cancelled()
        assert starts._shared == {}
        blocker.cancel()
        await starts.ready(model)
        assert RUN in model.kept
        with pytest.raises(asyncio.CancelledError):
            await asyncio.wait_for(_cancelled_at_once(pool), 5.0)

    async def _cancelled_at_once(pool):
        task = asyncio.create_task(waited_for(pool.submit("wait", 9.0)))
        await asyncio.sleep(0.05)
        task.cancel()
        await task

    asyncio.run(scene())
