"""Case files made to do harm: each a sentence, within the same bounds as workbooks."""

import json
import os
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from spoiled import Attended

from addin.reading.one_file import read_checked
from benchmarks.workbook_fuzz import sentence_fault

STATIONS = [{"station": "Motor", "inertia": 10.0}, {"station": "Load", "inertia": 5.0}]
ELEMENT = {
    "element": "Coupling",
    "kind": "coupling",
    "from": "Motor",
    "to": "Load",
    "stiffness": 1e6,
}
CASE: dict[str, Any] = {
    "format": 1, "line_frequency": 60, "synchronous_speed": 188.5, "rated_torque": 1000, "damping_ratio": 0.01,
    "stations": STATIONS, "elements": [ELEMENT],
}  # fmt: skip


def with_(**keys: Any) -> str:
    return json.dumps(CASE | keys)


def raw(key: str, value: str) -> str:
    """The case with a value written as it is."""
    return with_(**{key: "HERE"}).replace('"HERE"', value)


def many_stations() -> str:
    """So many stations and so many wrong references, that comparing each with each would not end."""
    stations = [{"station": f"Station number {k}", "inertia": 1.0} for k in range(2000)]
    elements = [
        ELEMENT | {"from": f"Stetion number {k}", "to": f"Stution number {k}"} for k in range(2000)
    ]
    return with_(stations=stations, elements=elements)


FILES: dict[str, tuple[Callable[[], str], str]] = {
    "deep lists": (lambda: "[" * 10**6, "too many nested levels"),
    "deep objects": (lambda: '{"a":' * 10**6, "too many nested levels"),
    "a deep value": (lambda: raw("title", "[" * 900 + "]" * 900), "found a list; type a text in quotes"),
    "a number of 5000 digits": (lambda: raw("damping_ratio", "1" * 5000), "number with thousands of digits"),
    "a number of 4000 digits": (lambda: raw("damping_ratio", "1" * 4000), "a finite number"),
    "a list of numbers of 4000 digits": (lambda: raw("title", "1" * 4000), "a number of 4000 digits"),
    "NaN": (lambda: raw("damping_ratio", "NaN"), "a finite number"),
    "minus infinity": (lambda: raw("damping_ratio", "-Infinity"), "a finite number"),
    "1e400": (lambda: raw("damping_ratio", "1e400"), "a finite number"),
    "1e400 with a unit": (lambda: with_(rated_torque="1e400 N*m"), "a finite number"),
    "digits of another script": (lambda: with_(rated_torque="١٢ N*m"), "is needed"),
    "the smallest number": (lambda: raw("rated_torque", "1e-320"), "RatedTorque"),
    "the largest number": (lambda: raw("rated_torque", "1e308"), "RatedTorque"),
    "a title of 10 MB": (lambda: with_(title="x" * 10 * 2**20), "the limit is 1000"),
    "a number of 10 MB": (lambda: with_(rated_torque="1" * 10 * 2**20), "RatedTorque"),
    "a key of 10 MB": (lambda: with_(**{"x" * 10 * 2**20: 1}), "unknown key"),
    "a file of 30 MB": (lambda: with_(title="x" * 30 * 2**20), "larger than 20 MB"),
    "100,000 unknown keys": (lambda: with_(**{f"key {k}": k for k in range(100_000)}), "unknown key"),
    "100,000 keys twice": (
        lambda: with_()[:-1] + "".join(f',"k{k}":1,"k{k}":2' for k in range(100_000)) + "}",
        "occurs twice",
    ),
    "a key twice": (lambda: with_()[:-1] + ',"damping_ratio":0.02}', "'damping_ratio' occurs twice"),
    "unknown keys in a row": (lambda: with_(elements=[ELEMENT | {"stifness": 1}]), "Did you mean 'stiffness'"),
    "wrong types": (
        lambda: with_(line_frequency=[60], synchronous_speed={}, rated_torque=True, title=5, stations={},
                      elements=[1, None, "x", []]),
        "type a number",
    ),
    "another format": (lambda: with_(format="9" * 10**6), "has format"),
    "no object": (lambda: "[1, 2]", "Put the case in braces"),
    "200,000 rows": (lambda: with_(stations=[{}] * 200_000), "the limit is 2000"),
    "2000 rows of wrong names": (many_stations, "a station of table Stations"),
    "a bomb of a unit": (lambda: with_(rated_torque="1 m**999999999"), "not known"),
}  # fmt: skip


@pytest.mark.first_ones(1)
@pytest.mark.parametrize("name", FILES)
def test_case_files(attended: Attended, tmp_path: Path, name: str) -> None:
    make, words = FILES[name]
    source = tmp_path / "case.json"
    source.write_text(make(), encoding="utf-8")
    said = attended.ask(source)
    assert "crash" not in said, said["crash"]
    assert not said["written"]
    assert any(words in one for one in said["told"]), said["told"][:5]
    assert not [fault for fault in map(sentence_fault, said["told"]) if fault], said["told"][:5]
    assert said["peak_mb"] < 500
    assert {path.name for path in tmp_path.iterdir()} == {"case.json", "done.json"}
    assert (tmp_path / "done.json").stat().st_size < 20 * 2**20


def test_half_characters(attended: Attended, tmp_path: Path) -> None:
    """JSON may hold half of a surrogate pair, and no file can: it is replaced, the results are written."""
    source = tmp_path / "case.json"
    names = raw("title", r'"\ud800 and \u001b[2J"').replace("Motor", r"\udfffMotor")
    source.write_text(names, encoding="utf-8")
    said = attended.ask(source)
    assert said["written"], said
    text = (tmp_path / "done.json").read_text(encoding="utf-8")
    assert "\ufffdMotor" in text


# --- names of files -----------------------------------------------------------------------------


def sentence_on(path: Path) -> str:
    read = read_checked(path)
    (problem,) = read.problems
    assert not sentence_fault(problem.message), problem.message
    return problem.message


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no named pipes on Windows")
@pytest.mark.parametrize("ending", [".xlsx", ".json"])
def test_devices_and_pipes_are_not_waited_for(tmp_path: Path, ending: str) -> None:
    endless, pipe = tmp_path / f"zero{ending}", tmp_path / f"pipe{ending}"
    endless.symlink_to("/dev/zero")
    os.mkfifo(pipe)
    for path in (endless, pipe):
        assert "a device or a pipe" in sentence_on(path)


@pytest.mark.parametrize("ending", [".xlsx", ".json"])
def test_names_no_file_has(tmp_path: Path, ending: str) -> None:
    assert "is not a valid file name" in sentence_on(tmp_path / f"a\0b{ending}")
    too_long = sentence_on(tmp_path / ("x" * 300 + ending))
    # Wine finds no such file.
    words = [
        "cannot be used",
        *(["does not exist", "not found"] if sys.platform == "win32" else []),
    ]
    assert any(word in too_long for word in words)
    assert "no" in sentence_on(tmp_path / f"../../nothing\x1b[2J{ending}")
    assert "folder" in sentence_on(tmp_path) or "workbook" in sentence_on(tmp_path)
    (tmp_path / f"folder{ending}").mkdir()
    assert "is a folder" in sentence_on(tmp_path / f"folder{ending}")
