"""Batches on a real Dask cluster: a scheduler and workers in processes of their own, on loopback."""

from __future__ import annotations

import os
import signal
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import openpyxl
import pandas as pd
import pytest
from batch_helpers import make_train, spoil
from command_line import command, environment, torsionbook

from addin.batch import cluster_files
from addin.batch.cluster_files import FileCluster
from addin.batch.folder import OWN
from addin.batch.journal import read_journal
from addin.workers.cluster import ClusterRefused
from addin.workers.pool import Crashed, Task
from tests.dask_cluster import Dask, wait_until


@pytest.fixture(scope="module")
def dask(tmp_path_factory) -> Iterator[Dask]:
    """A cluster that has one worker or more."""
    place = Path(__file__).parent
    running = Dask(tmp_path_factory.mktemp("dask") / "cluster", place, place.parent, workers=1)
    yield running
    running.stop()


@pytest.fixture(scope="module")
def three_workers(dask: Dask) -> Dask:
    """The same cluster with three workers."""
    dask.workers += [dask.worker(), dask.worker()]
    return dask


@contextmanager
def joined(dask: Dask) -> Iterator[FileCluster]:
    work = FileCluster(dask.address)
    yield work
    work.close()


def never() -> bool:
    return False


def tripled(number: int) -> tuple[int, int]:
    return 3 * number, os.getpid()


def die(_: object) -> None:
    os._exit(9)


@pytest.mark.slow
def test_tasks_run_in_the_processes_of_the_cluster(three_workers):
    with joined(three_workers) as work:
        work._client.wait_for_workers(3)
        for number in range(30):
            work.add(Task(tripled, number, tag=number))
        found = {task.tag: answer for task, answer in work.answers(never)}
    assert {tag: answer[0] for tag, answer in found.items()} == {n: 3 * n for n in range(30)}
    assert {answer[1] for answer in found.values()} <= {one.pid for one in three_workers.workers}


@pytest.mark.slow
@pytest.mark.parametrize("send", ["files", pytest.param("bytes", marks=pytest.mark.long)])
def test_a_worker_killed_in_the_middle_loses_nothing(three_workers, tmp_path, send):
    source = tmp_path / "in"
    for number in range(12):
        make_train(source / str(number % 2) / f"t{number}.xlsx", number % 10)  # two twins
    spoil(make_train(source / "wrong.xlsx", 20))
    make_train(source / "open.xlsx", 21)
    (source / "~$open.xlsx").write_bytes(b"\x03Ada")
    batch = subprocess.Popen(
        command(
            "batch", "in", "--out", "out", "--scheduler", three_workers.address, "--send", send
        ),
        cwd=tmp_path,
        env=environment(),
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
    out = tmp_path / "out"
    wait_until(lambda: len(list(out.rglob("t*.xlsx"))) > 1 or batch.poll() is not None)
    victim = three_workers.workers.pop()
    victim.send_signal(signal.SIGKILL)
    said, _ = batch.communicate(timeout=300)
    three_workers.workers.append(three_workers.worker())
    assert batch.returncode == 1, said
    assert "12 done" in said
    rows = pd.read_csv(out / "summary.csv", encoding="utf-8-sig").set_index("File")
    assert rows.loc["wrong.xlsx", "Outcome"] == "wrong input"
    assert rows.loc["open.xlsx", "Outcome"] == "locked"
    assert rows["Same case as"].notna().sum() == 2
    for number in range(12):
        name = f"{number % 2}/t{number}.xlsx"
        openpyxl.load_workbook(out / name)
        record = read_journal(out / OWN / "journal.jsonl")[name]
        assert record.source == str(source / name)
        assert record.stamp.size == (source / name).stat().st_size
    again = torsionbook("batch", "in", "--out", "out", "--resume", cwd=tmp_path)
    assert ", 13 of them in an earlier batch" in again.stdout, again.stdout + again.stderr


@pytest.mark.slow
def test_an_answer_that_dies_with_its_worker_is_calculated_again(tmp_path):
    """On a cluster of its own: its only worker is killed before the answer was fetched."""
    own = Dask(tmp_path / "cluster", Path(__file__).parent, Path(__file__).parents[1], workers=1)
    try:
        with joined(own) as work:
            work.add(Task(tripled, 4))
            assert not list(work._hand_out())
            ((_, future),) = work._running.values()
            wait_until(lambda: future.status == "finished")
            own.workers[0].kill()
            wait_until(lambda: future.status == "lost")
            replacement = own.worker()
            ((_, answer),) = work.answers(never)
        assert answer == (12, replacement.pid)
    finally:
        own.stop()


@pytest.mark.slow
def test_results_are_those_of_this_machine(three_workers, tmp_path):
    make_train(tmp_path / "in" / "t.xlsx", 3)
    for out, words in {
        "here": [],
        "files": ["--scheduler", three_workers.address, "--send", "files"],
        "bytes": ["--scheduler", three_workers.address, "--send", "bytes"],
        "auto": ["--scheduler", three_workers.address],
    }.items():
        done = torsionbook("batch", "in", "--out", out, *words, cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        if out == "auto":
            assert "through a shared folder" in done.stderr
    shown = [
        read_journal(tmp_path / out / OWN / "journal.jsonl")["t.xlsx"].results
        for out in ("here", "files", "bytes", "auto")
    ]
    assert shown[0] == shown[1] == shown[2] == shown[3]


@pytest.mark.slow
def test_a_programme_of_cases_on_the_cluster(three_workers, tmp_path):
    make_train(tmp_path / "base.xlsx")
    lines = ["DampingRatio [%]", *(f"{1 + 0.01 * n}" for n in range(12)), "-1"]
    (tmp_path / "t.csv").write_text("\n".join(lines))
    words = (
        "batch",
        "base.xlsx",
        "--vary",
        "t.csv",
        "--out",
        "o",
        "--scheduler",
        three_workers.address,
    )
    done = torsionbook(*words, cwd=tmp_path)
    assert done.returncode == 1, done.stderr
    assert "12 done, 1 wrong input" in done.stdout


@pytest.mark.slow
def test_a_folder_that_workers_do_not_see_is_found_out(dask, tmp_path, monkeypatch):
    (tmp_path / "a.xlsx").write_text("x")
    with joined(dask) as work:
        assert work.shares(tmp_path, tmp_path / "a.xlsx")
        assert list(tmp_path.iterdir()) == [tmp_path / "a.xlsx"]
        assert not work.shares(tmp_path, tmp_path / "not there.xlsx")
    assert not cluster_files.shared(str(tmp_path), "token", str(tmp_path / "a.xlsx"))


@pytest.mark.slow
def test_a_task_that_kills_every_worker_is_given_up_and_named(tmp_path):
    """On a cluster of its own, whose workers it ends."""
    own = Dask(tmp_path / "cluster", Path(__file__).parent, Path(__file__).parents[1])
    try:
        with joined(own) as work:
            work.add(Task(die, None, tag="bad"))
            for _ in range(3):
                own.worker()
            found = {task.tag: answer for task, answer in work.answers(never)}
        assert isinstance(found["bad"], Crashed)
        assert "stopped during the calculation" in found["bad"].sentence
    finally:
        own.stop()


def test_no_scheduler_and_another_version_are_told(dask, tmp_path, monkeypatch):
    with pytest.raises(ClusterRefused, match="is unreachable or has no workers"):
        FileCluster("tcp://127.0.0.1:9", patience=1.0)
    here = os.getpid()
    monkeypatch.setattr(
        "addin.batch.cluster_files.product_version",
        lambda: "99.0" if os.getpid() == here else "0.1.0",
    )
    with pytest.raises(ClusterRefused, match=r"has 0\.\d.*this computer has 99\.0"):
        FileCluster(dask.address)
