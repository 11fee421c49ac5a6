"""The process behind the extension: its messages, without LibreOffice."""

import io
import json
import math
import struct
import subprocess
import sys

import pytest
from sheet_ranges import model_arguments

from addin.libreoffice import worker
from addin.libreoffice.oxt import worker_command
from addin.worksheet.registry import FunctionError, call


def packed(request):
    content = request if isinstance(request, bytes) else json.dumps(request).encode()
    return struct.pack(">I", len(content)) + content


def unpacked(data):
    """The answers in the order they were written."""
    found, at = [], 0
    while at < len(data):
        (length,) = struct.unpack_from(">I", data, at)
        found.append(json.loads(data[at + 4 : at + 4 + length]))
        at += 4 + length
    assert at == len(data)
    return found


def asked(*requests, end=b""):
    answers = io.BytesIO()
    worker.serve(io.BytesIO(b"".join(map(packed, requests)) + end), answers)
    return unpacked(answers.getvalue())


def call_of(function, *arguments):
    return {"function": function, "arguments": list(arguments)}


def test_answers_come_in_order_and_are_the_doubles_of_the_registry():
    arguments = [[200.1, None, 500.7, 79300.3], [0.1 + 0.2, 0.0, 1 / 3, 1e-5]]
    answers = asked(*(call_of("TV_STIFFNESS", *raw) for raw in arguments))
    assert answers == [{"rows": call("TV_STIFFNESS", raw)} for raw in arguments]


def test_what_is_wrong_is_told_in_the_words_of_the_registry():
    with pytest.raises(FunctionError) as told:
        call("TV_STIFFNESS", ["wide", 0.0, 500.0, 79300.0])
    (answer,) = asked(call_of("TV_STIFFNESS", "wide", 0.0, 500.0, 79300.0))
    assert answer == {"error": told.value.message, "code": told.value.code}
    assert asked(call_of("TV_NOTHING"))[0]["code"] == "#NAME?"


@pytest.mark.parametrize("request_", [b"no JSON", b"\xff", b"[]", b"{}", b'{"function": "A"}'])
def test_a_request_that_is_none_is_answered_and_the_next_is_served(request_):
    answers = asked(request_, call_of("TV_CONVERT", 2.0, "m", "mm"))
    assert "error" in answers[0]
    assert answers[1] == {"rows": [[2000.0]]}


def test_a_fault_of_ours_is_told_without_its_trace(monkeypatch, capsys):
    def broken(name, raw):
        raise ZeroDivisionError("secret")

    monkeypatch.setattr("addin.libreoffice.worker.call", broken)
    (answer,) = asked(call_of("TV_CONVERT", 2.0, "m", "mm"))
    assert "ZeroDivisionError" in answer["error"]
    assert "secret" not in answer["error"]
    assert "secret" in capsys.readouterr().err


@pytest.mark.parametrize("end", [b"\x00", b"\x00\x00\x00\x09half", b"\xff\xff\xff\xff"])
def test_it_ends_at_the_end_of_the_requests_even_in_a_message(end):
    assert len(asked(call_of("TV_CONVERT", 2.0, "m", "mm"), end=end)) == 1


def test_a_blank_cell_that_comes_as_zero_is_blank_where_zero_means_nothing():
    """Calc hands a reference to one blank cell over as the number 0."""
    stiffness = call("TV_STIFFNESS", [200.0, None, 500.0, 79300.0])
    assert asked(call_of("TV_STIFFNESS", 200.0, 0.0, 500.0, 79300.0, 0.0)) == [{"rows": stiffness}]
    tables = model_arguments()
    tables[3] = None  # ModeDamping
    (answer,) = asked(call_of("TV_MODEL", *tables[:3], 0.0, *tables[4:]))
    assert answer == {"rows": call("TV_MODEL", tables)}
    # elsewhere it is a number, and told as one
    assert "found 0; it must be above 0" in asked(call_of("TV_STIFFNESS", 0.0, 0, 1, 1))[0]["error"]
    assert asked(call_of("TV_CONVERT", 0.0, "m", "mm")) == [{"rows": [[0.0]]}]


def test_the_process_speaks_doubles_and_ends_with_its_input():
    values = [math.pi, 5e-324, 1.7976931348623157e308, -0.1, 2**53 + 2.0]
    with subprocess.Popen(
        worker_command(), stdin=subprocess.PIPE, stdout=subprocess.PIPE
    ) as process:
        said, _ = process.communicate(packed(call_of("TV_CONVERT", [values], "m", "m")), timeout=60)
    assert process.returncode == 0
    assert unpacked(said) == [{"rows": [values]}]


def test_what_the_process_prints_does_not_spoil_its_answers():
    script = (
        "from addin.libreoffice import worker\nimport os\n"
        "def noisy(name, raw):\n    print('noise'); os.write(1, b'noise'); return [[1.0]]\n"
        "worker.call = noisy\nworker.main()"
    )
    done = subprocess.run(
        [sys.executable, "-c", script],
        input=packed(call_of("TV_CONVERT", 1.0, "m", "m")),
        capture_output=True,
        timeout=60,
        check=True,
    )
    assert unpacked(done.stdout) == [{"rows": [[1.0]]}]
    assert done.stderr.count(b"noise") == 2


def test_requests_of_another_form_are_answered_and_the_next_one_is_served():
    deep = '{"function": "TV_CONVERT", "arguments": [' + "[" * 900 + "]" * 900 + ', "m", "mm"]}'
    deeper = deep.replace("[" * 900, "[" * 90_000).replace("]" * 900, "]" * 90_000)
    for arguments in ("3", '"m"', "null", '{"a": 1}'):
        wrong = f'{{"function": "TV_CONVERT", "arguments": {arguments}}}'
        assert "error" in worker._answer_to(wrong.encode())
    assert "error" in worker._answer_to(b'{"function": 3, "arguments": []}')
    for one in (deep, deeper):
        assert "An error occurred inside" not in worker._answer_to(one.encode())["error"]


@pytest.mark.first_ones(1)
@pytest.mark.parametrize("name", ["addin.calc.worker", "addin.libreoffice.worker"])
def test_it_is_started_by_the_name_of_today_and_by_that_of_installed_extensions(name):
    request = packed({"function": "TV_CONVERT", "arguments": [1.0, "m", "mm"]})
    done = subprocess.run(
        [sys.executable, "-P", "-m", name],
        input=request,
        capture_output=True,
        timeout=120,
        check=True,
    )
    assert unpacked(done.stdout) == [{"rows": [[1000.0]]}]
