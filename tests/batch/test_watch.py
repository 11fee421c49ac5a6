"""Watching: which files are taken when, and a run as a user sees it."""

import os
import shutil
import signal
import subprocess
import threading
import time
from pathlib import Path

import openpyxl
import pytest
from batch_helpers import Here, make_train
from command_line import command, environment, torsionbook

from addin.batch.folder import OutFolder
from addin.batch.inputs import Input, find_inputs
from addin.batch.records import DONE, LOCKED, Record, failed
from addin.batch.scheduler import Batch
from addin.batch.watch import TRY_AGAIN, Watch


class Recorded:
    """Stands in for a batch: it knows records and calculates nothing."""

    def __init__(self) -> None:
        self.records: dict[str, Record] = {}


@pytest.fixture
def file(tmp_path) -> Input:
    (tmp_path / "a.xlsx").write_text("one")
    return Input(tmp_path / "a.xlsx", "a.xlsx")


def test_a_file_is_taken_when_it_rests(file):
    watch = Watch(Recorded(), list, print)
    assert watch.ready([file]) == []  # seen for the first time: it may still be written
    file.path.write_text("one and more")
    assert watch.ready([file]) == []
    assert watch.ready([file]) == [file]


def test_a_calculated_file_is_left_alone_until_it_is_saved(file):
    batch = Recorded()
    watch = Watch(batch, list, print)
    watch.ready([file])
    batch.records["a.xlsx"] = Record("a.xlsx", str(file.path), DONE)
    watch._keep(file, watch.seen["a.xlsx"])
    assert watch.ready([file]) == []
    os.utime(file.path, ns=(5, 5))
    assert watch.ready([file]) == []
    assert watch.ready([file]) == [file]


def test_a_file_that_vanishes_while_it_is_saved_is_waited_for(file):
    watch = Watch(Recorded(), list, print)
    watch.ready([file])
    content = file.path.read_bytes()
    file.path.unlink()
    assert watch.ready([file]) == []
    file.path.write_bytes(content)
    assert watch.ready([file]) == []
    assert watch.ready([file]) == [file]


def test_a_passing_reason_is_tried_again_after_a_while(file, monkeypatch):
    batch = Recorded()
    watch = Watch(batch, list, print)
    watch.ready([file])
    batch.records["a.xlsx"] = failed("a.xlsx", str(file.path), LOCKED, "open")
    watch._keep(file, watch.seen["a.xlsx"])
    assert watch.ready([file]) == []
    later = time.monotonic() + TRY_AGAIN
    monkeypatch.setattr("addin.batch.watch.time.monotonic", lambda: later)
    assert watch.ready([file]) == [file]


def test_an_open_workbook_is_calculated_as_saved_but_an_open_result_is_not_replaced(tmp_path):
    make_train(tmp_path / "in" / "a.xlsx")
    (tmp_path / "in" / "~$a.xlsx").write_bytes(b"\x03Ada")
    inputs = find_inputs([str(tmp_path / "in")], tmp_path / "out")
    with (
        OutFolder(tmp_path / "out") as folder,
        Batch(folder, Here(), may_be_open=True) as batch,
    ):
        batch.process(inputs)
        assert batch.records["a.xlsx"].done
        (tmp_path / "out" / "~$a.xlsx").write_bytes(b"\x03Eve")
        batch.records.clear()
        batch.process(inputs)
        assert batch.records["a.xlsx"].outcome == LOCKED


def value(path: Path, name: str) -> object:
    book = openpyxl.load_workbook(path)
    sheet, cell = next(book.defined_names[name].destinations)
    return book[sheet][cell].value


@pytest.mark.slow
@pytest.mark.skipif(os.name == "nt", reason="Ctrl-C is sent otherwise there")
def test_saved_files_are_calculated_again_new_ones_too_until_ctrl_c(tmp_path):
    source, out = tmp_path / "in", tmp_path / "out"
    make_train(source / "a.xlsx", 1)
    first = make_train(tmp_path / "kept" / "a.xlsx", 2)
    second = make_train(tmp_path / "kept" / "b.xlsx", 3)
    log = tmp_path / "log"
    with open(log, "w") as said:
        batch = subprocess.Popen(
            command("batch", "in", "--out", "out", "--watch", "--jobs", 1),
            cwd=tmp_path,
            env=environment() | {"PYTHONUNBUFFERED": "1"},
            stdout=said,
            stderr=subprocess.STDOUT,
        )
    try:
        wait_for(lambda: "Watching" in log.read_text())
        shutil.copyfile(first, source / "a.xlsx")
        wait_for(lambda: "a.xlsx: done" in log.read_text())
        shutil.copyfile(second, source / "b.xlsx")
        wait_for(lambda: "b.xlsx: done" in log.read_text())
        batch.send_signal(signal.SIGINT)
        assert batch.wait(60) == 0
    finally:
        batch.kill()
        batch.wait()
    assert value(out / "a.xlsx", "Tag") == "T-2"
    assert value(out / "b.xlsx", "Tag") == "T-3"
    rows = openpyxl.load_workbook(out / "summary.xlsx")["Files"]
    assert [row[0].value for row in rows.iter_rows(min_row=5)] == ["a.xlsx", "b.xlsx"]


def wait_for(happens) -> None:
    until = time.monotonic() + 120
    while not happens():
        assert time.monotonic() < until
        time.sleep(0.05)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no named pipes on Windows")
def test_a_pipe_among_the_files_is_not_waited_for(tmp_path):
    """Opening one waits for who writes into it, and no Ctrl-C ends that."""
    os.mkfifo(tmp_path / "pipe.xlsx")
    pipe = Input(tmp_path / "pipe.xlsx", "pipe.xlsx")
    watch = Watch(Recorded(), list, print)
    found = []
    looks = threading.Thread(
        target=lambda: found.extend(map(watch.ready, [[pipe]] * 2)), daemon=True
    )
    looks.start()
    looks.join(10.0)
    assert found == [[], [pipe]]


def test_why_nothing_is_watched_is_told_once(tmp_path, monkeypatch):
    """Two names that differ in capitals are refused; without a word, nobody would know that nothing is calculated."""
    (tmp_path / "in").mkdir()
    for name in ("a.xlsx", "A.xlsx"):
        (tmp_path / "in" / name).write_bytes(b"")
    if len(list((tmp_path / "in").iterdir())) < 2:
        pytest.skip("this disk does not tell capitals apart")
    looks = []
    monkeypatch.setattr(Watch, "run", lambda self, _: looks.extend([self.find(), self.find()]))
    done = torsionbook("batch", "in", "--out", "out", "--watch", "--jobs", 1, cwd=tmp_path)
    assert done.returncode == 0
    assert looks == [[], []]
    assert done.stderr.count("would both be written to") == 1
