"""Studies on a real Dask cluster: the numbers of this machine, workers that die, Ctrl-C."""

from __future__ import annotations

import json
import os
import pty
import re
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from addin.contract.shipped import template_path
from addin.reading.case_json import case_to_json
from addin.reading.workbook import read_workbook
from addin.workers.cluster import Cluster
from addin.workers.stop import Stopped
from tests.dask_cluster import ROOT, Dask, wait_until

pytestmark = pytest.mark.slow

TABLES: dict[str, list[dict[str, Any]]] = {
    "scatter": [
        {"quantity": "stiffness", "spread": "5 %"},
        {"quantity": "damping ratio", "distribution": "uniform", "spread": 0.3},
    ],
    "tuning": [
        {"element": "HS coupling", "quantity": "stiffness", "unit": "%", "from": 30, "to": 100,
         "steps": 30},
    ],
    "start_conditions": [
        {"condition": f"at {v} %", "voltage": f"{v} %", "per_year": 10} for v in range(85, 105, 2)
    ],
}  # fmt: skip


@pytest.fixture(scope="module")
def dask(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Dask]:
    running = Dask(tmp_path_factory.mktemp("dask") / "cluster")
    yield running
    running.stop()


@pytest.fixture(scope="module")
def case(tmp_path_factory: pytest.TempPathFactory) -> Path:
    place = tmp_path_factory.mktemp("case") / "case.json"
    data = case_to_json(read_workbook(template_path("example_proposed.xlsx")).data)
    place.write_text(json.dumps(data | TABLES), encoding="utf-8")
    return place


def command(*words: object) -> list[str]:
    return [sys.executable, "-m", "addin.cli", *map(str, words)]


def environment() -> dict[str, str]:
    return {**os.environ, "PYTHONPATH": str(ROOT), "COLUMNS": "140", "TERM": "xterm"}


def begun(*words: object) -> subprocess.Popen[str]:
    return subprocess.Popen(
        command(*words),
        env=environment(),
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def tasks_of(dask: Dask) -> list[str]:
    """What the scheduler still knows of; it knows nothing of a task that was given up."""
    from distributed import Client

    with Client(dask.address, set_as_default=False) as client:
        return list(
            client.run_on_scheduler(lambda dask_scheduler: [str(k) for k in dask_scheduler.tasks])
        )


@pytest.mark.parametrize(
    "words",
    [
        ("tolerances", "--samples", 300),
        ("starts",),
        pytest.param(("tune",), marks=pytest.mark.long),
        pytest.param(("sensitivities",), marks=pytest.mark.long),
    ],
)
def test_results_are_those_of_this_machine_bit_for_bit(
    dask: Dask, case: Path, tmp_path: Path, words: tuple[object, ...]
) -> None:
    for name, where in {"here": ("--jobs", 1), "there": ("--scheduler", dask.address)}.items():
        done = begun(*words, case, *where, "--json", tmp_path / f"{name}.json")
        said, wrong = done.communicate(timeout=600)
        assert done.returncode == 0, said + wrong
    assert (tmp_path / "here.json").read_bytes() == (tmp_path / "there.json").read_bytes()


def test_a_worker_killed_in_the_middle_changes_no_number(
    dask: Dask, case: Path, tmp_path: Path
) -> None:
    words = ("tolerances", case, "--samples", 1000)
    here = begun(*words, "--jobs", 2, "--json", tmp_path / "here.json")
    assert here.wait(600) == 0
    there = begun(*words, "--scheduler", dask.address, "--json", tmp_path / "there.json")
    wait_until(lambda: tasks_of(dask) or there.poll() is not None)
    victim = dask.workers.pop()
    victim.send_signal(signal.SIGKILL)
    said, wrong = there.communicate(timeout=600)
    dask.workers.append(dask.worker())
    assert there.returncode == 0, said + wrong
    assert (tmp_path / "here.json").read_bytes() == (tmp_path / "there.json").read_bytes()


def test_progress_is_shown_and_ctrl_c_frees_the_cluster(
    dask: Dask, case: Path, tmp_path: Path
) -> None:
    """In a terminal of its own; what is calculated by then is written as a part."""
    ours, theirs = pty.openpty()
    study = subprocess.Popen(
        command("tolerances", case, "--samples", 100_000, "--scheduler", dask.address,
                "--json", tmp_path / "part.json"),
        env=environment(), stdout=theirs, stderr=theirs, stdin=theirs,
    )  # fmt: skip
    os.close(theirs)
    shown: list[bytes] = []

    def read() -> None:
        while True:
            try:
                shown.append(os.read(ours, 4096))
            except OSError:
                return

    reader = threading.Thread(target=read, daemon=True)
    reader.start()
    wait_until(lambda: re.search(rb"case.json: \d[\d,]* of 100,0\d\d runs", b"".join(shown)))
    wait_until(lambda: re.search(rb"case.json: [1-9]\d\d of 100,0\d\d", b"".join(shown)))
    study.send_signal(signal.SIGINT)
    assert study.wait(120) == 130
    reader.join(5)
    os.close(ours)
    text = b"".join(shown).decode()
    assert "Cut short by Ctrl-C" in text
    assert "(stopping)" in text
    part = json.loads((tmp_path / "part.json").read_text(encoding="utf-8"))
    assert 30 <= part["cut_short"]["calculated"] < part["cut_short"]["planned"] == 100_000
    wait_until(lambda: not tasks_of(dask))


def test_the_second_ctrl_c_gives_up_and_frees_the_cluster(
    dask: Dask, case: Path, tmp_path: Path
) -> None:
    study = begun(
        "tolerances", case, "--samples", 100_000, "--scheduler", dask.address,
        "--json", tmp_path / "none.json",
    )  # fmt: skip
    wait_until(lambda: tasks_of(dask))
    study.send_signal(signal.SIGINT)
    time.sleep(0.2)  # two at once are one
    study.send_signal(signal.SIGINT)
    said, wrong = study.communicate(timeout=120)
    assert study.returncode == 130, said + wrong
    assert "Traceback" not in wrong
    assert not (tmp_path / "none.json").exists()
    wait_until(lambda: not tasks_of(dask))


def test_a_scheduler_that_is_lost_is_told_without_words_of_batches(
    case: Path, tmp_path: Path
) -> None:
    own = Dask(tmp_path / "cluster")
    try:
        study = begun("tolerances", case, "--samples", 100_000, "--scheduler", own.address,
                      "--json", tmp_path / "none.json")  # fmt: skip
        wait_until(lambda: tasks_of(own))
        own.stop()
        _, wrong = study.communicate(timeout=300)
        assert study.returncode == 1
        assert "Lost the connection to the Dask scheduler" in wrong
        assert "Nothing was written." in wrong
        assert "--resume" not in wrong
        assert not (tmp_path / "none.json").exists()
    finally:
        own.stop()


def test_whatever_is_asked_of_a_lost_scheduler_says_so(tmp_path: Path) -> None:
    own = Dask(tmp_path / "cluster")
    cluster = Cluster(own.address, lambda: "1")
    try:
        assert cluster.threads >= 1
        own.stop()
        with pytest.raises(Stopped, match="Lost the connection to the Dask scheduler"):
            cluster.threads  # noqa: B018
    finally:
        cluster.close()
        own.stop()
