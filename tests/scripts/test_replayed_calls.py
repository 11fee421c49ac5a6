"""`scripts/record_calls.py`, `replay_calls.c` and `other_systems.py`: recorded calls, made again without Python."""

from __future__ import annotations

import numpy as np
import pytest
from script_modules import script_module

from benchmarks.study_trains import study_train
from engine.numerics import same_bits
from engine.run import run
from engine.stepping import linear_loop
from engine.stepping.library import _FILE

record_calls = script_module("record_calls")
other_systems = script_module("other_systems")
hatch_build = other_systems.hatch_build


@pytest.fixture
def recorder(monkeypatch):
    recorder = record_calls.Recorder()
    monkeypatch.setattr(np, "empty", np.zeros)  # as `record` does
    monkeypatch.setattr(linear_loop, "library", recorder)
    monkeypatch.setattr(same_bits, "library", recorder)
    return recorder


@pytest.fixture
def replayed(recorder, tmp_path):
    """Writes what was recorded and makes the calls again; what the driver prints."""

    def replay() -> list[str]:
        recorder.write(tmp_path)
        driver = other_systems.driver(hatch_build.compiler(), tmp_path, "here")
        return other_systems.replayed([driver, _FILE, tmp_path / "recording"], tmp_path / "none")

    return replay


def test_the_driver_leaves_what_the_calls_of_a_start_left(recorder, replayed):
    run(study_train(14).case)
    assert {"begin_starts", "advance_starts", "product"} <= {
        x.split()[0] for x in recorder.expected
    }
    assert replayed() == recorder.expected


def test_the_last_bit_of_one_result_is_seen(recorder, replayed):
    a = np.array([[1.0, 2.0], [3.0, 4.0]])
    same_bits.product(a, a)
    same_bits.product(a, a)
    same_bits.product(a, np.nextafter(a, 0.0))
    lines = replayed()
    assert lines[0] == lines[1] != lines[2]
    said = other_systems.first_difference([lines[0]] * 3, lines)
    assert said == f"call 3 of 3 differs: {lines[0]}, and there {lines[2]}"
    assert "call 3 of 3 differs" in other_systems.first_difference(lines, lines[:2])
    assert other_systems.first_difference(lines, lines) == ""


def test_only_the_sign_of_no_number_may_differ(recorder, replayed):
    for x in (-1.0, 0.0, -0.0, 1.0):  # the logarithm of a negative number is none, with either sign
        same_bits.log(np.array([x]))
    assert replayed() == recorder.expected
    digest, before = record_calls.digest, np.ones(1)
    of = [
        digest(before.view(np.uint64), np.array([x]).view(np.uint64))
        for x in (np.nan, -np.nan, 0.0, -0.0, 1.0)
    ]
    assert of[0] == of[1]
    assert len(set(of)) == 4


def test_a_function_that_nothing_calls_is_named(monkeypatch):
    monkeypatch.setattr(record_calls, "FUNCTIONS", [*record_calls.FUNCTIONS, "another_loop"])
    with pytest.raises(SystemExit, match="Nothing that is recorded calls another_loop"):
        record_calls.check_all_are_called(f"{name} 0" for name in record_calls.FUNCTIONS[:-1])


def test_a_system_that_cannot_be_run_says_what_is_missing(tmp_path):
    system = other_systems.System("win_amd64", ("no-such-emulator",), files=(tmp_path / "libc",))
    assert system.missing() == f"no-such-emulator and no {tmp_path / 'libc'}"
