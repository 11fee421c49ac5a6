"""Servers that share models and results through a real Redis or Valkey."""

import json
import logging
import re
import threading
import time
import urllib.request
from contextlib import ExitStack

import pytest
import valkey
from balancer import Balancer, free_port, redis
from messages import until_the_end
from servers import outside
from sheet_ranges import model_arguments
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect

from addin.calculation.calculation import calculate
from addin.server import shared
from addin.server.settings import Settings
from addin.server.shared import PREFIX, SharedMemory
from addin.worksheet.models import RUN, Models
from addin.worksheet.registry import ModelForgotten, call

pytestmark = pytest.mark.needs_redis
SECRET = "a secret that nobody guesses"


@pytest.fixture
def address():
    with redis(free_port()) as where:
        yield where


def models(address, secret=SECRET, lifetime=86_400.0):
    """The models of one server."""
    found = Models()
    found.store = SharedMemory(Settings(shared=address, shared_key=secret, shared_time=lifetime))
    return found


@pytest.fixture
def case():
    from addin.worksheet.models import MODELS

    return MODELS.of(call("TV_MODEL", model_arguments())[0][0]).case


def test_what_one_server_makes_the_other_has_to_the_bit(address, case):
    one, other = models(address), models(address)
    made = one.add_case(case, "US")
    with pytest.raises(ModelForgotten):
        other.of(made.handle)
    other.fetch([made.handle, "tv:none", "no handle"])
    found = other.of(made.handle)
    assert (found.case, found.system, found.results) == (made.case, "US", made.results)
    assert other.result_of_others(found, RUN) is None
    calculated = calculate(case)
    one.keep(made, RUN, calculated)
    brought = other.result_of_others(found, RUN)
    assert repr(brought.tables) == repr(calculated.tables)  # of every double all digits
    assert len(calculated.tables["StartupPeaks"]) > 3


def test_names_have_prefix_version_and_time_to_live(address, case):
    client = valkey.Valkey.from_url(address)
    made = models(address, lifetime=500.0)
    handle = made.add_case(case, "US").handle
    (name,) = client.keys()
    assert name.decode() == f"{PREFIX}model:{handle}"
    assert re.match(r"torsionbook:1:\d+\.\d+\.\d+:", PREFIX)
    assert 490 < client.ttl(name) <= 500
    client.expire(name, 5)
    models(address, lifetime=500.0).fetch([handle])  # who uses it keeps it there
    assert client.ttl(name) > 490


def test_what_was_written_with_another_secret_or_for_another_name_is_not_used(
    address, case, caplog
):
    handle = models(address, "another secret, long enough").add_case(case, "US").handle
    mine = models(address)
    with caplog.at_level(logging.WARNING):
        for _ in range(3):
            mine.fetch([handle])
    assert [r.message for r in caplog.records if "not written with the secret" in r.message] != []
    assert len(caplog.records) == 1
    assert mine.count == 0
    mine.store.put("other", (case, "US"))
    client = valkey.Valkey.from_url(address)
    client.copy(f"{PREFIX}other", f"{PREFIX}model:{handle}", replace=True)
    mine.fetch([handle])
    assert mine.count == 0
    assert mine.store.get("other") == (case, "US")


def test_a_server_goes_on_alone_and_shares_again(case, caplog, monkeypatch):
    monkeypatch.setattr(shared, "PAUSE", 0.0)
    monkeypatch.setattr(shared, "RENEW", 0.0)
    port = free_port()
    with caplog.at_level(logging.INFO):
        alone = models(f"redis://user:secret@127.0.0.1:{port}/0")
        alone.store = SharedMemory(
            Settings(shared=f"redis://127.0.0.1:{port}/0", shared_key=SECRET)
        )
        alone.store.begin()
        handle = alone.add_case(case, "US").handle
        assert alone.of(handle).case == case
        with redis(port) as address:
            alone.fetch([handle])  # in use: the others are to find it
            other = models(address)
            other.fetch([handle])
            assert other.of(handle).case == case
        alone.fetch([handle])
    said = [record.message for record in caplog.records]
    assert len(said) == 3, said
    assert re.match(
        rf"redis://127.0.0.1:{port}/0 does not answer \(.*refused.*\)\. This server goes on",
        said[0],
    )
    assert said[1] == f"redis://127.0.0.1:{port}/0 answers again"
    assert "does not answer" in said[2]


def test_no_password_is_told(caplog):
    store = SharedMemory(
        Settings(shared=f"redis://user:hidden@127.0.0.1:{free_port()}/0", shared_key=SECRET)
    )
    store.begin()
    assert "does not answer" in caplog.text
    assert "hidden" not in caplog.text
    assert SECRET not in repr(Settings(shared="redis://127.0.0.1/0", shared_key=SECRET))


@pytest.mark.slow
def test_servers_behind_a_balancer_are_restarted_one_by_one_without_a_lost_call(address, tmp_path):
    """Neither of those sent by POST nor of those over a WebSocket that stays open."""
    secret = tmp_path / "secret"
    secret.write_text(SECRET.replace(" ", "-"))
    words = ("--shared", address, "--shared-key-file", str(secret), "--drain", "1", "--grace", "60")
    arguments = model_arguments()

    def post(name, given):
        request = urllib.request.Request(
            f"{balancer.address}/api/v1/batch",
            json.dumps({"calls": [{"name": name, "arguments": given}]}).encode(),
            {"Content-Type": "application/json"},
        )
        with urllib.request.urlopen(request, timeout=120) as said:
            return json.load(said)["results"][0]["value"]

    def ask_on():
        """A new model each time, whose handle most often goes to the other server; and the peaks of one."""
        for lap in range(10**6):
            if ended.wait(0.1):
                return
            try:
                stations, elements, rows, *rest = arguments
                mine = [*rows, ["Remark", lap, None]] if lap % 2 else rows
                (made,) = post("TV_MODEL", [stations, elements, mine, *rest])
                answers.append(("frequencies", post("TV_FREQUENCIES", made)))
                answers.append(("peaks", post("TV_PEAKS", [handle])))
            except Exception as lost:
                answers.append(("lost", repr(lost)))

    def ask_on_by_line():
        """The same over one WebSocket: one that ends, and one that takes no more calls, is opened anew and asked again."""
        line, lap, lines = None, 0, ExitStack()
        while not ended.wait(0.1):
            lap += 1
            rows = [*arguments[2], ["Remark", f"line {lap}", None]]
            asked = [{"name": "TV_PEAKS", "arguments": [handle]}]
            asked += [{"name": "TV_MODEL", "arguments": [*arguments[:2], rows, *arguments[3:]]}]
            while asked:
                try:
                    if line is None:
                        line = lines.enter_context(
                            connect(f"ws{balancer.address[4:]}/api/v1/stream")
                        )
                    line.send(json.dumps({**asked[0], "id": lap}))
                    *_, last = until_the_end(line, lap)
                except ConnectionClosed as cut:
                    cuts.append(cut.rcvd.code if cut.rcvd else None)
                    line = None
                    continue
                except Exception as lost:
                    answers.append(("lost", repr(lost)))
                    return
                if last.get("error", {}).get("busy"):
                    cuts.append("busy")
                    line.close()
                    line = None
                    continue
                wanted = asked.pop(0)["name"]
                if wanted == "TV_MODEL":
                    asked += [{"name": "TV_FREQUENCIES", "arguments": last["value"][0]}]
                else:
                    kind = "peaks" if wanted == "TV_PEAKS" else "frequencies"
                    answers.append((kind, last["value"]))
                    by_line.append(kind)
        lines.close()

    def starts_calculated(where):
        with urllib.request.urlopen(f"{where}/metrics", timeout=60) as said:
            found = re.findall(
                r'calculations_total\{task="start",end="done"\} (\d+)', said.read().decode()
            )
        return sum(map(int, found))

    def until(condition):
        limit = time.monotonic() + 120
        while not condition():
            assert time.monotonic() < limit
            time.sleep(0.05)

    answers, ended, balancer = [], threading.Event(), Balancer()
    cuts, by_line = [], []
    with ExitStack() as all_servers:
        first = [ExitStack(), ExitStack()]
        for one in first:
            all_servers.callback(one.close)
            balancer.backends.append(one.enter_context(outside(*words)))
        all_servers.callback(balancer.end)
        until(lambda: len(balancer.ready) == 2)
        ((handle,),) = post("TV_MODEL", arguments)
        peaks = post("TV_PEAKS", [handle])
        asking = [threading.Thread(target=ask_on) for _ in range(2)]
        asking.append(threading.Thread(target=ask_on_by_line))
        for thread in asking:
            thread.start()
        try:
            for n, one in enumerate(first):
                before = len(answers)
                until(lambda before=before: len(answers) > before + 10)
                old = balancer.backends[n]
                one.close()  # SIGTERM, and the end is waited for while calls go on
                balancer.backends[n] = all_servers.enter_context(outside(*words))
                until(lambda n=n: balancer.backends[n] in balancer.ready)
                new = balancer.backends[n]
                assert new != old
                until(lambda new=new: balancer.answered.get(new, 0) > 10)
        finally:
            ended.set()
            for thread in asking:
                thread.join(120)
        calculated = list(map(starts_calculated, balancer.backends))
    lost = [what for kind, what in answers if kind == "lost"]
    assert lost == []
    assert len(by_line) > 4
    # each server that left said so: its line ended as one that is started anew, or took no more calls
    assert len(cuts) >= 1
    assert set(cuts) <= {"busy", 1012}, cuts
    assert call("TV_MODEL", arguments) == [[handle]]
    wanted = {
        "peaks": peaks,
        "frequencies": json.loads(json.dumps(call("TV_FREQUENCIES", [handle]))),
    }
    assert peaks == json.loads(json.dumps(call("TV_PEAKS", [handle])))
    assert all(found == wanted[kind] for kind, found in answers)
    assert {kind for kind, _ in answers} == set(wanted)
    assert calculated == [0, 0], (
        "the start of the first servers was not found by those that followed"
    )
