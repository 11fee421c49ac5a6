"""The Python client against a real server: files in, doubles and sentences out."""

import math
import socket
import subprocess
import sys
import threading

import openpyxl
import pytest
from servers import ROOT
from sheet_ranges import TEMPLATES, model_arguments

from addin.server.client import Client, Refusal
from addin.worksheet import registry


def test_a_model_of_a_file_and_its_cells(served):
    server = Client(served)
    handle = server.model(TEMPLATES / "example_proposed.xlsx")
    assert handle == registry.call("TV_MODEL", model_arguments())[0][0]
    assert repr(server.call("TV_PEAKS", handle)) == repr(registry.call("TV_PEAKS", [handle]))
    answers = server.batch([("TV_CONVERT", [0.1, None], "m", "mm"), ("TV_NOTHING",)])
    assert answers[0] == [[100.0, None]]
    assert isinstance(answers[1], Refusal)
    assert answers[1].code == "#NAME?"
    with pytest.raises(Refusal, match="florps"):
        server.call("TV_CONVERT", 1, "florps", "m")


def test_what_cannot_be_sent_is_told_in_its_place(served):
    server = Client(served)
    calls = [
        ("TV_CONVERT", [1.0, math.nan], "m", "mm"),
        ("TV_CONVERT", math.inf, "m", "mm"),
        ("TV_CONVERT", [[1.0, -math.inf]], "m", "mm"),
        ("TV_CONVERT", object(), "m", "mm"),
        ("TV_CONVERT", 2.0, "m", "mm"),
    ]
    blank, high, low, strange, plain = server.batch(calls)
    assert (blank, plain) == ([[1000.0, None]], [[2000.0]])
    for refused in (high, low):
        assert isinstance(refused, Refusal)
        assert "infinite" in refused.message
    assert "cannot be sent" in strange.message
    with pytest.raises(Refusal, match="infinite"):
        Client("http://127.0.0.1:9").call("TV_CONVERT", math.inf, "m", "mm")


@pytest.mark.slow
def test_a_workbook_recalculated(served, tmp_path):
    Client(served).recalculate(TEMPLATES / "example_proposed.xlsx", tmp_path / "out.xlsx")
    assert "Summary" in openpyxl.load_workbook(tmp_path / "out.xlsx").sheetnames


def test_what_is_wrong_comes_with_its_cells(served, tmp_path):
    (tmp_path / "case.json").write_text(
        '{"format": 1, "stations": [{"station": "M", "inertia": -1}]}'
    )
    with pytest.raises(Refusal) as told:
        Client(served).model(tmp_path / "case.json")
    assert any(one["column"] == "Inertia" for one in told.value.errors)
    (tmp_path / "no.xlsx").write_bytes(b"nothing")
    with pytest.raises(Refusal):
        Client(served).recalculate(tmp_path / "no.xlsx", tmp_path / "never.xlsx")
    assert not (tmp_path / "never.xlsx").exists()


@pytest.mark.slow
def test_inputs_edits_and_documents(served, tmp_path):
    server, source = Client(served), TEMPLATES / "example_proposed.xlsx"
    edited = tmp_path / "edited.xlsx"
    server.edit(source, edited, {"DampingRatio": 2.5})
    typed = [server.inputs(path)["scalars"] for path in (source, edited)]
    assert typed[0] != typed[1]
    differences = server.document("diff", edited, earlier=source)
    assert any("DampingRatio" in str(block) for block in differences)
    server.document("report", source, tmp_path / "r.docx", form="docx")
    assert (tmp_path / "r.docx").read_bytes().startswith(b"PK")
    assert any("calculated" in block["text"] for block in server.document("verify", source))
    with pytest.raises(Refusal) as told:
        server.document("verify", tmp_path / "r.docx")
    assert "workbook" in told.value.message


def test_a_file_beyond_the_limit_is_told_not_cut_off(served, tmp_path):
    """Whoever is cut off while he sends sees a broken connection and not why."""
    (tmp_path / "large.xlsx").write_bytes(b"PK\3\4" + bytes(27_000_000))
    with pytest.raises(Refusal, match="larger than 25 MB"):
        Client(served).recalculate(tmp_path / "large.xlsx", tmp_path / "out.xlsx")
    assert [path.name for path in tmp_path.iterdir()] == ["large.xlsx"]


def test_a_server_that_ends_within_its_answer_is_told(tmp_path):
    def answer():
        line, _ = listening.accept()
        with line:
            line.recv(100_000)
            line.sendall(b"HTTP/1.1 200 OK\r\nContent-Length: 1000\r\n\r\nhalf")

    (tmp_path / "out.xlsx").write_bytes(b"before")
    (tmp_path / "train.xlsx").write_bytes(b"PK")
    with socket.create_server(("127.0.0.1", 0)) as listening:
        ends = threading.Thread(target=answer)
        ends.start()
        client = Client(f"http://127.0.0.1:{listening.getsockname()[1]}")
        with pytest.raises(Refusal, match="cannot be reached"):
            client.recalculate(tmp_path / "train.xlsx", tmp_path / "out.xlsx")
        ends.join()
    assert (tmp_path / "out.xlsx").read_bytes() == b"before"


def test_a_full_disk_leaves_the_file_that_was_there(tmp_path, monkeypatch):
    def full(path, content):
        path.open("wb").close()
        raise OSError(28, "No space left on device")

    (tmp_path / "out.xlsx").write_bytes(b"before")
    monkeypatch.setattr(Client, "_file", lambda *given, **asked: b"after")
    with monkeypatch.context() as patched:
        patched.setattr("pathlib.Path.write_bytes", full)
        with pytest.raises(OSError, match="No space"):
            Client("http://127.0.0.1:9").recalculate("train.xlsx", tmp_path / "out.xlsx")
    assert [path.name for path in tmp_path.iterdir()] == ["out.xlsx"]
    assert (tmp_path / "out.xlsx").read_bytes() == b"before"
    Client("http://127.0.0.1:9").recalculate("train.xlsx", tmp_path / "out.xlsx")
    assert (tmp_path / "out.xlsx").read_bytes() == b"after"


def test_no_server_is_told():
    with pytest.raises(Refusal, match="cannot be reached"):
        Client("http://127.0.0.1:9").call("TV_CONVERT", 1, "m", "mm")


def test_it_needs_the_standard_library_only():
    script = "import sys, runpy; runpy.run_path(sys.argv[1]); print(*sorted(sys.modules))"
    done = subprocess.run(
        [sys.executable, "-S", "-c", script, str(ROOT / "addin" / "server" / "client.py")],
        capture_output=True, text=True, timeout=60, check=True,
    )  # fmt: skip
    loaded = {name.split(".")[0] for name in done.stdout.split()}
    assert loaded <= sys.stdlib_module_names | {
        "__main__",
        "__mp_main__",
        "_virtualenv",
        "sitecustomize",
    }
