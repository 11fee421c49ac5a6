"""A server in operation: what it tells browsers, how long it waits, who guesses keys."""

import contextlib
import io
import json
import logging
import logging.config
import os
import re
import signal
import socket
import subprocess
import sys
import threading
import time
import urllib.request
from datetime import datetime
from types import SimpleNamespace
from urllib.parse import urlsplit

import pytest
from servers import ROOT, inside, outside
from websockets.sync.client import connect

from addin.server.answers import Refused
from addin.server.configuration import configured
from addin.server.keys import GUESSES, WITHIN, Keys, network_of
from addin.server.listening import handed_over
from addin.server.logs import log_config
from addin.server.metrics import TASK_TIME, Metrics
from addin.server.protocol import is_in
from addin.server.settings import Settings, SettingsError

KEY = "a-key-nobody-guesses"
OTHER = "another-key-of-24-letters"


# --- what browsers are told -----------------------------------------------------------------------


def policy(said):
    """Directives of a Content-Security-Policy."""
    parts = (part.split() for part in said.headers["Content-Security-Policy"].split(";"))
    return {name: values for name, *values in parts}


def test_pages_say_what_may_be_loaded(client):
    own, add_in = policy(client.get("/")), policy(client.get("/taskpane.html"))
    for found in (own, add_in, policy(client.get("/openapi.json"))):
        assert found["default-src"] == ["'none'"]
        assert not {"'unsafe-inline'", "'unsafe-eval'", "*", "https:"} & set(
            found.get("script-src", ())
        )
    assert own["script-src"] == own["style-src"] == ["'self'"]
    assert own["frame-ancestors"] == ["'none'"]
    assert "https://appsforoffice.microsoft.com" in add_in["script-src"]
    assert "https://*.officeapps.live.com" in add_in["frame-ancestors"]
    assert "<script>" not in client.get("/").text + client.get("/taskpane.html").text


# --- how long headers may take --------------------------------------------------------------------


def test_headers_that_do_not_come_are_not_waited_for():
    with outside("--limit", "header_time=0.6") as address:
        there = urlsplit(address)
        request = f"GET /healthz HTTP/1.1\r\nHost: {there.netloc}\r\n"

        def talk(*texts):
            """What the server says to a client that sends these texts slowly, and when it ends."""
            with socket.create_connection((there.hostname, there.port), 10.0) as line:
                began = time.monotonic()
                for text in texts:
                    line.sendall(text.encode())
                    time.sleep(0.2)
                said = b""
                while part := line.recv(10_000):
                    said += part
                return said.decode(), time.monotonic() - began

        for texts in ((), (request,), (request, "X: a\r\n", "X: b\r\n")):
            said, after = talk(*texts)
            assert said.startswith("HTTP/1.1 408 ")
            assert 0.5 < after < 4.0
        # of a second request as of the first
        said, after = talk(request + "\r\n", request, "X: a\r\n")
        assert said.startswith("HTTP/1.1 200 ")
        assert said.count("HTTP/1.1 408 ") == 1
        # in time, and kept alive for the next
        said, _ = talk(request, "\r\n", request + "Connection: close\r\n\r\n")
        assert said.count("HTTP/1.1 200 ") == 2
        assert "408" not in said


# --- who guesses ----------------------------------------------------------------------------------


def test_wrong_keys_are_counted_by_address_and_then_not_looked_at(caplog):
    clock = [0.0]
    keys = Keys(Settings(keys=frozenset({KEY, OTHER})), lambda: clock[0])
    assert keys.admits(KEY, "10.0.0.1")
    for k in range(GUESSES):
        assert not keys.admits(f"wrong {k}", "10.0.0.1")
        clock[0] += 1.0
    assert not keys.admits(None, "10.0.0.1")  # none is no guess
    with pytest.raises(Refused, match="Try again in 50 s") as refused:
        keys.admits(OTHER, "10.0.0.1")  # a right one, but not known from there
    assert (refused.value.status, refused.value.headers) == (429, {"Retry-After": "50"})
    assert keys.admits(KEY, "10.0.0.1")  # known from there
    assert keys.admits(OTHER, "10.0.0.2")
    assert (keys.wrong, keys.unseen) == (GUESSES, 1)
    assert len(caplog.records) == GUESSES
    assert "not looked at" in caplog.records[-1].getMessage()
    assert "wrong 0" not in caplog.text
    clock[0] = WITHIN
    assert keys.admits(OTHER, "10.0.0.1")


def test_addresses_of_one_client_count_together():
    assert network_of("2001:db8:1:2:3::4") == network_of("2001:db8:1:2::9") == "2001:db8:1:2::/64"
    assert network_of("2001:db8:1:3::9") != network_of("2001:db8:1:2::9")
    assert network_of("10.0.0.1") == "10.0.0.1"
    assert network_of("testclient") == "testclient"


def test_guessing_is_refused_over_http_and_websockets_alike():
    with inside(Settings(workers=1, keys=frozenset({KEY}))) as client:
        for k in range(GUESSES):
            if k % 2:
                said = client.post("/api/v1/batch", json={}, headers={"X-API-Key": f"wrong {k}"})
                assert said.status_code == 401
            else:
                with client.websocket_connect(
                    "/api/v1/stream", headers={"host": "127.0.0.1"}
                ) as line:
                    line.send_json({"key": f"wrong {k}"})
                    assert "not valid" in line.receive_json()["error"]["message"]
        said = client.post("/api/v1/batch", json={}, headers={"X-API-Key": KEY})
        assert said.status_code == 429
        assert 0 < int(said.headers["Retry-After"]) <= WITHIN
        with client.websocket_connect("/api/v1/stream", headers={"host": "127.0.0.1"}) as line:
            line.send_json({"key": KEY})
            assert "Too many wrong API keys" in line.receive_json()["error"]["message"]
        assert client.get("/healthz").status_code == 200


# --- what is counted and logged -------------------------------------------------------------------


def samples(text):
    """Values of a text of Prometheus, by name and labels, as its own reader has them."""
    parser = pytest.importorskip("prometheus_client.parser")
    return {
        (one.name, *sorted(one.labels.values())): one.value
        for family in parser.text_string_to_metric_families(text)
        for one in family.samples
    }


def test_what_is_done_is_counted_for_whoever_has_a_key():
    own = {"X-API-Key": KEY}
    with inside(Settings(workers=1, keys=frozenset({KEY}))) as client:
        assert client.get("/metrics").status_code == 401
        before = samples(client.get("/metrics", headers=own).text)
        calls = [
            ["TV_CONVERT", 1, "m", "mm"],
            ["TV_CONVERT", 1, "m", "s"],
            ["NONE"],
            ["TV_CONVERT", 1, "m", "mm"],
        ]
        sent = {"calls": [{"name": name, "arguments": given} for name, *given in calls]}
        assert client.post("/api/v1/batch", json=sent, headers=own).status_code == 200
        for secret in ("one", "two"):
            client.post(f"/api/v1/{secret}", headers={"X-API-Key": "wrong"})
        client.post("/api/v1/model", content=b"{}", headers=own)
        with client.websocket_connect(
            "/api/v1/stream", headers={"host": "127.0.0.1", **own}
        ) as line:
            line.send_json({"id": 1, "name": "TV_CONVERT", "arguments": [1, "m", "mm"]})
            line.receive_json()
            said = client.get("/metrics", headers=own)
        assert said.headers["Content-Type"].startswith("text/plain; version=0.0.4")
        after = samples(said.text)
    gained = {key: value - before.get(key, 0) for key, value in after.items()}
    assert gained["torsionbook_calls_total", "TV_CONVERT", "value"] == 3
    assert gained["torsionbook_calls_total", "TV_CONVERT", "error"] == 1
    assert gained["torsionbook_calls_total", "error", "unknown"] == 1
    assert gained["torsionbook_requests_total", "/api/v1/batch", "200"] == 1
    assert gained["torsionbook_requests_total", "401", "other"] == 2  # their paths are not kept
    assert gained["torsionbook_request_seconds_count", "/api/v1/batch"] == 1
    assert gained["torsionbook_request_seconds_bucket", "+Inf", "/api/v1/batch"] == 1
    assert gained["torsionbook_calculations_total", "done", "read"] == 1
    assert gained["torsionbook_wrong_keys_total",] == 2
    assert after["torsionbook_sockets",] == 1
    assert after["torsionbook_calculations_waiting",] == 0
    assert after["torsionbook_memory_bytes",] > 1e7
    assert "/api/v1/one" not in said.text


def test_times_are_told_in_classes_that_contain_each_other():
    metrics = Metrics('1.0 "x"')
    for seconds in (0.005, 0.05, 3.0, 1000.0):
        metrics.took(TASK_TIME, seconds, "start")
    found = samples(metrics.text())
    counts = [found["torsionbook_calculation_seconds_bucket", *sorted((end, "start"))]
              for end in ("0.01", "0.05", "1.0", "5.0", "900.0", "+Inf")]  # fmt: skip
    assert counts == [1, 2, 2, 3, 3, 4]
    assert found["torsionbook_calculation_seconds_sum", "start"] == pytest.approx(1003.055)
    assert found["torsionbook_info", '1.0 "x"'] == 1


def test_a_request_has_an_identity_and_a_line_without_its_secrets():
    with inside(Settings(workers=1, keys=frozenset({KEY}))) as client, logged("json") as lines:
        own = {"X-API-Key": KEY, "X-Request-ID": "of-the-proxy.1"}
        said = client.post("/api/v1/model?name=Secret.json", content=b"{}", headers=own)
        assert said.headers["X-Request-ID"] == "of-the-proxy.1"
        told = client.get("/healthz", headers={"X-Request-ID": 'no "identity"'})
        assert re.fullmatch("[0-9a-f]{16}", told.headers["X-Request-ID"])
        client.post("/api/v1/batch", headers={"X-API-Key": "wrong-one"})
    found = [json.loads(line) for line in lines.getvalue().splitlines()]
    first, second, wrong, last = found
    assert (first["method"], first["path"], first["status"]) == ("POST", "/api/v1/model", 422)
    assert (first["request"], first["level"], first["address"]) == (
        "of-the-proxy.1",
        "info",
        "testclient",
    )
    assert datetime.fromisoformat(first["time"]).tzinfo is not None
    assert (second["path"], second["status"]) == ("/healthz", 200)
    assert (wrong["level"], last["status"]) == ("warning", 401)
    assert wrong["request"] == last["request"]
    assert not any(word in lines.getvalue() for word in ("Secret", KEY, "wrong-one"))
    with inside(Settings(workers=1)) as client, logged("text", has_requests=False) as lines:
        client.get("/healthz")
    assert lines.getvalue() == ""


@contextlib.contextmanager
def logged(how, *, has_requests=True):
    """What a server writes into its log."""
    config = log_config(how, has_requests=has_requests)
    names = [*config["loggers"]]
    before = [(logging.getLogger(name).level, logging.getLogger(name).propagate) for name in names]
    written = io.StringIO()
    config["handlers"]["stderr"]["stream"] = written
    logging.config.dictConfig(config)
    try:
        yield written
    finally:
        for name, (level, propagate) in zip(names, before, strict=True):
            one = logging.getLogger(name)
            one.handlers.clear()
            one.level, one.propagate = level, propagate


# --- leaving --------------------------------------------------------------------------------------


def test_a_server_that_leaves_says_so_and_answers_what_comes_yet():
    with inside(Settings(workers=1)) as client:
        leaving = client.app.state.leaving
        assert client.get("/readyz").json() == {"ok": True}
        assert "Connection" not in client.get("/version").headers
        with client.websocket_connect("/api/v1/stream", headers={"host": "127.0.0.1"}) as line:
            call = {"name": "TV_CONVERT", "arguments": [1, "m", "mm"]}
            leaving.has_begun = True
            assert client.get("/readyz").status_code == 503
            assert client.get("/healthz").status_code == 200
            said = client.post("/api/v1/batch", json={"calls": [call]})
            assert said.json()["results"] == [{"value": [[1000.0]]}]
            assert said.headers["Connection"] == "close"
            line.send_json({"id": 1, **call})
            assert line.receive_json()["value"] == [[1000.0]]
            leaving.is_closed = True
            line.send_json({"id": 2, **call})
            refused = line.receive_json()["error"]
            assert "being stopped" in refused["message"]
            assert refused["busy"]
        assert leaving.calls == 0


def test_sockets_that_are_handed_over_are_not_open_to_more_than_the_settings_say():
    environment = {"LISTEN_PID": str(os.getpid()), "LISTEN_FDS": "1"}
    assert handed_over(Settings(), {}) == []
    assert handed_over(Settings(), environment | {"LISTEN_PID": "1"}) == []
    one = SimpleNamespace(getsockname=lambda: ("0.0.0.0", 80))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(socket, "socket", lambda fileno: one)
        with pytest.raises(
            SettingsError, match="listens on 0.0.0.0, which other machines can reach"
        ):
            handed_over(Settings(), environment)
        one.getsockname = lambda: ("127.0.0.1", 80)
        assert handed_over(Settings(), environment) == [one]


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="a socket is handed over as POSIX has it")
def test_a_restart_loses_no_call():
    """The socket stays open while one server ends and the next begins, as systemd keeps it."""
    kept = socket.create_server(("127.0.0.1", 0))
    address = f"http://127.0.0.1:{kept.getsockname()[1]}"
    launch = (
        "import os, sys; os.dup2(int(sys.argv[1]), 3); "
        "os.environ |= {'LISTEN_FDS': '1', 'LISTEN_PID': str(os.getpid())}; "
        "os.execv(sys.executable, [sys.executable, '-m', 'addin.cli', 'serve', *sys.argv[2:]])"
    )
    words = [sys.executable, "-c", launch, str(kept.fileno()), "--workers", "1", "--grace", "60"]

    def begun():
        server = subprocess.Popen(
            words, cwd=ROOT, stderr=subprocess.PIPE, text=True, pass_fds=[kept.fileno()]
        )
        said = []
        for line in server.stderr:
            said.append(line)
            if "is running on" in line:
                return server
        raise AssertionError("the server did not start:\n" + "".join(said))

    answers, ended = [], threading.Event()

    def ask_on():
        call = {"calls": [{"name": "TV_CONVERT", "arguments": [1, "m", "mm"]}]}
        while not ended.is_set():
            request = urllib.request.Request(
                f"{address}/api/v1/batch",
                json.dumps(call).encode(),
                {"Content-Type": "application/json"},
            )
            try:
                with urllib.request.urlopen(request, timeout=120) as said:
                    answers.append(json.load(said)["results"][0]["value"])
            except OSError as lost:
                answers.append(lost)

    def counted():
        with urllib.request.urlopen(f"{address}/metrics", timeout=120) as said:
            text = said.read().decode()
        return float(
            re.search(r'requests_total\{route="/api/v1/batch",status="200"\} (\d+)', text)[1]
        )

    asking = threading.Thread(target=ask_on)
    first = begun()
    asking.start()
    try:
        with connect(address.replace("http", "ws") + "/api/v1/stream") as line:
            arguments = [handle_of(address)]
            line.send(json.dumps({"id": 1, "name": "TV_PEAKS", "arguments": arguments}))
            assert "stage" in json.loads(line.recv(timeout=60))  # its start has begun
            first.send_signal(signal.SIGTERM)
            while "stage" in (found := json.loads(line.recv(timeout=120))):
                pass
        assert found["value"][0][0] == "Element"
        first.wait(60)
        before = len(answers)
        second = begun()
        try:
            while len(answers) < before + 20:
                time.sleep(0.05)
            by_second = counted()
        finally:
            ended.set()
            asking.join(120)
            second.terminate()
            second.communicate(timeout=60)
    finally:
        ended.set()
        first.kill()
        kept.close()
    assert [answer for answer in answers if answer != [[1000.0]]] == []
    assert before > 0
    assert by_second > 0


def handle_of(address):
    body = (ROOT / "templates" / "example_backlash.xlsx").read_bytes()
    with urllib.request.urlopen(f"{address}/api/v1/model", body, timeout=120) as said:
        return json.load(said)["model"]


# --- behind a proxy -------------------------------------------------------------------------------


def test_beyond_this_machine_http_is_for_named_proxies_alone(tmp_path):
    (tmp_path / "keys").write_text(KEY)
    flags = {"host": "0.0.0.0", "api_key_file": str(tmp_path / "keys")}
    with pytest.raises(SettingsError, match="without encryption"):
        configured(flags, {})
    with pytest.raises(
        SettingsError, match="TORSIONBOOK_TRUSTED_PROXIES is '10.0.0.300'; write addresses"
    ):
        configured(flags, {"TORSIONBOOK_TRUSTED_PROXIES": "10.0.0.300"})
    found = configured(
        flags | {"public_url": "https://torsion.example.com"},
        {"TORSIONBOOK_TRUSTED_PROXIES": "10.0.0.0/24, 10.1.0.5"},
    )
    assert [
        is_in(one, found.peers) for one in ("10.0.0.9", "10.1.0.5", "::ffff:10.1.0.5", "127.0.0.1")
    ] == [True] * 4
    assert not any(is_in(one, found.peers) for one in ("10.1.0.6", "2001:db8::1", ""))
    assert found.knows_host("torsion.example.com")
    assert not found.knows_host("elsewhere.example.com")
    assert Settings().peers == ()


@pytest.mark.skipif(sys.platform != "linux", reason="has but one address of its own elsewhere")
def test_others_are_closed_before_they_are_read_and_the_address_is_that_of_the_client(tmp_path):
    (tmp_path / "keys").write_text(KEY)
    words = ("--host", "127.0.0.2", "--api-key-file", str(tmp_path / "keys"))
    with outside(*words, "--trusted-proxies", "127.0.0.3") as address:
        port = urlsplit(address).port
        guess = "GET /api/v1/none HTTP/1.1\r\nHost: x\r\nX-API-Key: wrong\r\nConnection: close\r\nX-Forwarded-For: {}\r\n\r\n"

        def status(here, forwarded):
            with socket.create_connection(("127.0.0.2", port), 10.0, (here, 0)) as line:
                line.sendall(guess.format(forwarded).encode())
                try:
                    said = line.recv(10_000)
                except ConnectionResetError:
                    return None
                return int(said.split()[1]) if said else None

        assert [status("127.0.0.3", "192.0.2.1") for _ in range(GUESSES + 1)] == [401] * GUESSES + [
            429
        ]
        assert status("127.0.0.3", "192.0.2.2") == 401  # another client of the same proxy
        # what a client writes itself is not taken for what its proxy says
        assert status("127.0.0.3", "192.0.2.3, 192.0.2.1") == 429
        assert status("127.0.0.4", "192.0.2.2") is None  # neither the proxy nor this machine itself
        assert status("127.0.0.1", "192.0.2.1") == 401
