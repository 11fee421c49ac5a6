"""Batches from folder to summary: in this process where something is to fail, else as a user runs them."""

from __future__ import annotations

import errno
import math
import os
import shutil
import signal
import subprocess
import time
from pathlib import Path

import openpyxl
import pandas as pd
import pytest
from batch_helpers import Here, make_train, spoil
from command_line import command, environment, torsionbook, torsionbook_process

from addin.batch import work
from addin.batch.folder import OWN, FolderRefused, OutFolder
from addin.batch.inputs import find_inputs
from addin.batch.records import Record
from addin.batch.scheduler import Batch
from addin.batch.summary import ERROR_COLUMNS, FILE_COLUMNS, guarded, write_summary
from addin.workers.pool import Crashed
from addin.workers.stop import Stop, Stopped
from addin.writing.recalculate import recalculate

#: Tables with times of this very run in them.
TIMED = {"Audit", "AccuracyCost", "Effects", "RunFacts", "ChartAccuracy"}


def run(trains: Path, out: Path, *, resume: bool = False, **more) -> dict[str, Record]:
    """A batch in this process."""
    inputs = find_inputs([str(trains)], out)
    with OutFolder(out) as folder, Batch(folder, Here(), resume=resume, **more) as batch:
        batch.process(inputs)
        return {one.name: batch.records[one.name] for one in inputs if one.name in batch.records}


@pytest.fixture
def counted(monkeypatch):
    """How often the engine runs."""
    import addin.calculation.calculation

    calls = []
    real = addin.calculation.calculation.run_with_conditions
    monkeypatch.setattr(
        addin.calculation.calculation,
        "run_with_conditions",
        lambda *words: calls.append(words[0]) or real(*words),
    )
    return calls


def table_values(path: Path) -> dict[str, list[tuple]]:
    """Every table of a workbook but those with times."""
    book = openpyxl.load_workbook(path, data_only=True)
    return {
        name: [tuple(cell.value for cell in row) for row in sheet[place]]
        for sheet in book
        for name, place in sheet.tables.items()
        if name not in TIMED
    }


def left_over(out: Path) -> list[str]:
    """Files and folders that a batch should have tidied away."""
    return [p.name for p in out.rglob("*") if p.name.startswith("staging-") or ".tmp" in p.name]


# --- a whole folder -------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def whole(made, tmp_path_factory):
    """A batch as a user runs it: five good files, four bad ones."""
    folder = tmp_path_factory.mktemp("whole")
    shutil.copytree(made, folder / "in")
    spoil(make_train(folder / "in" / "sub" / "wrong.xlsx", 50))
    (folder / "in" / "garbage.xlsx").write_bytes(b"PK no workbook")
    (folder / "in" / "~$train 7.xlsx.txt").write_bytes(b"")
    make_train(folder / "in" / "open.xlsx", 51)
    (folder / "in" / "~$open.xlsx").write_bytes(b"\x03Ada")
    (folder / "in" / "case.json").write_text('{"format": 1, "poles": 4}', encoding="utf-8")
    said = torsionbook_process("batch", "in", "--out", "out", "--jobs", 2, cwd=folder)
    return folder, said


def test_bad_files_do_not_stop_the_others(whole):
    folder, said = whole
    assert said.returncode == 1, said.stderr
    assert "9 files in" in said.stdout
    for words in ("5 done", "2 wrong input", "1 unreadable", "1 locked"):
        assert words in said.stdout
    assert {p.name for p in (folder / "out").glob("*.xlsx")} == {
        *(f"train {n}.xlsx" for n in (7, 8, 9, 10)),
        "summary.xlsx",
        "twin.xlsx",
    }
    assert not (folder / "out" / "sub").exists()
    assert left_over(folder / "out") == []


def test_each_failure_is_told_with_its_reason(whole):
    _, said = whole
    assert "open.xlsx: locked: open.xlsx is open in Excel by Ada" in said.stderr
    assert "garbage.xlsx: unreadable:" in said.stderr
    assert (
        "sub/wrong.xlsx: wrong input: Sheet Train, table Elements, row 2, Stiffness" in said.stderr
    )


@pytest.mark.slow
def test_results_are_those_of_recalc(whole, tmp_path):
    folder, _ = whole
    for name in ("train 9.xlsx", "train 8.xlsx", "twin.xlsx"):
        alone = recalculate(folder / "in" / name, destination=tmp_path / name)
        assert not alone.problems
        ours, theirs = table_values(folder / "out" / name), table_values(tmp_path / name)
        assert len(ours) > 20
        assert ours == theirs


def test_the_summary_has_a_row_a_file_in_order(whole):
    folder, _ = whole
    rows = pd.read_excel(folder / "out" / "summary.xlsx", header=3, keep_default_na=False)
    assert list(rows.columns) == [one.header for one in FILE_COLUMNS]
    assert list(rows["File"]) == [
        "case.json", "garbage.xlsx", "open.xlsx", "sub/wrong.xlsx",
        *(f"train {n}.xlsx" for n in (7, 8, 9, 10)), "twin.xlsx",
    ]  # fmt: skip
    done = rows[rows["Outcome"] == "done"].set_index("File")
    row = done.loc["train 7.xlsx"]
    # the paper: 30, 53 and 86 Hz; 2.0 times rated torque; several hundred starts
    assert [round(row[f"Mode {n} [Hz]"]) for n in (1, 2, 3)] == [30, 53, 86]
    assert row["Verdict"] == "fail, 2 not judged"  # torques reverse, backlash is not given
    assert row["Tag"] == "T-0"
    assert row["Worst margin [%]"] == pytest.approx(0.0, abs=0.01)
    assert len(row["Inputs, SHA-256 of the case"]) == 64
    assert done.loc["twin.xlsx", "Same case as"] == "train 8.xlsx"
    assert done.loc["twin.xlsx", "Tag"] == "its own"


def test_its_numbers_are_those_of_the_results(whole):
    folder, _ = whole
    rows = pd.read_excel(folder / "out" / "summary.xlsx", header=3).set_index("File")
    row = rows.loc["train 9.xlsx"]
    tables = table_values(folder / "out" / "train 9.xlsx")
    header, *peaks = tables["StartupPeaks"]
    # the examples show torque in lbf·ft and stress in psi
    pp = [p[header.index("Peak-to-peak stress")] for p in peaks]
    psi = max(x for x in pp if isinstance(x, float))
    stress = row["Largest stress in a start, nominal, peak-to-peak [MPa]"]
    assert stress == pytest.approx(psi * 0.006894757293168361, rel=1e-9)
    at = next(p for p in peaks if p[0] == row["Largest torque at"])
    size = max(abs(at[header.index(f"{end} torque")]) for end in ("Maximum", "Minimum"))
    assert row["Largest torque in a start [N·m]"] == pytest.approx(
        size * 1.3558179483314004, rel=1e-9
    )
    header, *starts = tables["AllowableStarts"]
    numbers = [s[header.index("Allowable starts")] for s in starts if s[0]]
    allowed = min(number for number in numbers if number != "unlimited")
    assert row["Allowable starts [count]"] == math.floor(allowed)
    header, *reversals = tables["TorqueReversals"]
    most = max(r[header.index("Reversals")] for r in reversals if r[0])
    assert row["Torque reversals [count]"] == most


def test_the_sheet_of_errors_names_sheet_table_row_and_column(whole):
    folder, _ = whole
    errors = pd.read_excel(
        folder / "out" / "summary.xlsx", sheet_name="Errors", header=3, keep_default_na=False
    )
    assert list(errors.columns) == [header for header, _, _ in ERROR_COLUMNS]
    wrong = errors[errors["File"] == "sub/wrong.xlsx"]
    places = set(zip(wrong["Sheet"], wrong["Table"], wrong["Row"], wrong["Column"], strict=True))
    assert {("Train", "Elements", 2, "Stiffness"), ("Train", "Elements", 3, "Stiffness")} <= places
    assert set(wrong["Cell"].str.len()) == {2} or all(wrong["Cell"])
    assert set(errors["File"]) == {"case.json", "garbage.xlsx", "open.xlsx", "sub/wrong.xlsx"}
    assert all(errors["What is wrong, and what to do"])


def test_the_csv_says_the_same(whole):
    folder, _ = whole
    book = pd.read_excel(folder / "out" / "summary.xlsx", header=3)
    table = pd.read_csv(folder / "out" / "summary.csv", encoding="utf-8-sig")
    pd.testing.assert_frame_equal(book, table, check_dtype=False)


@pytest.mark.slow
def test_resuming_does_nothing_twice_but_what_may_succeed_now(whole):
    """On a copy: the locked file is free now, the others are not touched."""
    folder, _ = whole
    copy = folder.with_name("resumed")
    shutil.copytree(folder, copy)
    for path in copy.rglob("*.xlsx"):  # the sources are where they were for the records
        os.utime(path, ns=(1, 1)) if "out" in path.parts else None
    (folder / "in" / "~$open.xlsx").unlink()
    try:
        before = {p: p.stat().st_mtime_ns for p in (copy / "out").glob("t*.xlsx")}
        said = torsionbook("batch", folder / "in", "--out", copy / "out", "--resume", cwd=copy)
    finally:
        (folder / "in" / "~$open.xlsx").write_bytes(b"\x03Ada")
    assert "6 done" in said.stdout
    assert ", 8 of them in an earlier batch" in said.stdout
    assert {p: p.stat().st_mtime_ns for p in before} == before
    assert (copy / "out" / "open.xlsx").is_file()


# --- identical cases ------------------------------------------------------------------------------


@pytest.mark.slow
def test_identical_cases_are_calculated_once_and_keep_their_own_title_block(
    trains, tmp_path, counted
):
    records = run(trains, tmp_path / "out")
    assert len(records) == 5
    assert all(one.done for one in records.values())
    assert len(counted) == 4
    assert records["twin.xlsx"].same_as == "train 8.xlsx"
    book = openpyxl.load_workbook(tmp_path / "out" / "twin.xlsx")
    name = book.defined_names["Tag"]
    sheet, cell = next(name.destinations)
    assert book[sheet][cell].value == "its own"


def test_a_twin_whose_first_failed_is_calculated_by_itself(few, tmp_path, monkeypatch, counted):
    real = work.calculate

    def failing(task):
        if task.name == "train 8.xlsx":
            raise_full = OSError(errno.EACCES, "Permission denied")
            return work.Calculated(work.refused(task, raise_full))
        return real(task)

    monkeypatch.setattr("addin.batch.scheduler.calculate", failing)
    records = run(few, tmp_path / "out")
    assert records["train 8.xlsx"].outcome == "no access"
    assert records["twin.xlsx"].done
    assert records["twin.xlsx"].same_as == ""
    assert len(counted) == 2


# --- resume ---------------------------------------------------------------------------------------


@pytest.mark.slow
def test_resume_redoes_what_changed_and_nothing_else(trains, tmp_path, counted):
    out = tmp_path / "out"
    run(trains, out)
    counted.clear()
    assert len(run(trains, out, resume=True)) == 5
    assert counted == []
    os.utime(trains / "train 8.xlsx")  # touched, not changed
    make_train(trains / "train 9.xlsx", 99)  # changed
    (out / "train 10.xlsx").unlink()  # lost
    (out / "train 7.xlsx").write_bytes((out / "train 7.xlsx").read_bytes()[:5000])  # damaged
    before = (out / "train 8.xlsx").stat().st_mtime_ns
    records = run(trains, out, resume=True)
    assert all(one.done for one in records.values())
    assert len(counted) == 3
    assert (out / "train 8.xlsx").stat().st_mtime_ns == before
    for name in ("train 9.xlsx", "train 10.xlsx", "train 7.xlsx"):
        openpyxl.load_workbook(out / name)


@pytest.mark.slow
def test_without_resume_everything_is_done_again(few, tmp_path, counted):
    run(few, tmp_path / "out")
    run(few, tmp_path / "out")
    assert len(counted) == 4


@pytest.mark.slow
def test_an_earlier_version_is_no_record(few, tmp_path, counted, monkeypatch):
    run(few, tmp_path / "out")
    for where in ("scheduler", "work"):
        monkeypatch.setattr(f"addin.batch.{where}.product_version", lambda: "99.0")
    run(few, tmp_path / "out", resume=True)
    assert len(counted) == 4


# --- named outcomes -------------------------------------------------------------------------------


def outcomes(records: dict[str, Record]) -> dict[str, str]:
    return {name: one.outcome for name, one in records.items()}


@pytest.mark.slow
def test_a_result_that_is_open_in_excel_is_named_and_the_old_one_stays(few, tmp_path):
    out = tmp_path / "out"
    run(few, out)
    old = (out / "train 8.xlsx").read_bytes()
    (out / "~$train 8.xlsx").write_bytes(b"\x03Eve")
    make_train(few / "train 8.xlsx", 42)
    records = run(few, out, resume=True)
    assert records["train 8.xlsx"].outcome == "locked"
    assert "Eve" in records["train 8.xlsx"].sentence
    assert "train 8.xlsx is still the result of an earlier calculation." in records["train 8.xlsx"].sentence  # fmt: skip
    assert (out / "train 8.xlsx").read_bytes() == old
    (out / "~$train 8.xlsx").unlink()
    assert run(few, out, resume=True)["train 8.xlsx"].done


@pytest.mark.first_ones(1)
@pytest.mark.parametrize("bad", ["wrong input", "unreadable"])
@pytest.mark.parametrize("resume", [False, True])
def test_an_earlier_result_never_stands_for_an_input_that_has_none_now(few, tmp_path, bad, resume):
    out, place = tmp_path / "out", tmp_path / "out" / "train 8.xlsx"
    (few / "train 9.xlsx").unlink()
    run(few, out, json=out / "json")
    first = place.read_bytes()
    good = (few / "train 8.xlsx").read_bytes()
    for number in ("", "2"):
        if bad == "unreadable":
            (few / "train 8.xlsx").write_bytes(b"PK nothing")
        else:
            spoil(few / "train 8.xlsx")
        record = run(few, out, resume=resume)["train 8.xlsx"]
        assert record.outcome == bad
        assert f"it was renamed to train 8.xlsx.old{number}." in record.sentence
        assert not place.exists()
        assert (out / f"train 8.xlsx.old{number}").is_file()
        again = run(few, out, resume=True)["train 8.xlsx"]  # nothing more to be done
        assert again == record
        (few / "train 8.xlsx").write_bytes(good)
        assert run(few, out, resume=resume)["train 8.xlsx"].done
    assert (out / "train 8.xlsx.old").read_bytes() == first
    assert (out / "twin.xlsx").is_file()
    assert (out / "json" / "train 8.results.json.old").is_file()


def test_an_earlier_result_that_cannot_be_renamed_is_told_and_tried_again(
    pair, tmp_path, monkeypatch
):
    out = tmp_path / "out"
    run(pair, out)
    spoil(pair / "train 9.xlsx")

    def refused(*words):
        raise PermissionError(errno.EACCES, "Permission denied")

    monkeypatch.setattr("addin.batch.folder.os.rename", refused)
    record = run(pair, out, resume=True)["train 9.xlsx"]
    assert "could not be renamed (Permission denied). Do not use it." in record.sentence
    monkeypatch.undo()
    record = run(pair, out, resume=True)["train 9.xlsx"]
    assert "it was renamed to train 9.xlsx.old." in record.sentence
    assert not (out / "train 9.xlsx").exists()
    assert (out / "train 8.xlsx").is_file()


@pytest.mark.slow
def test_a_full_disk_ends_the_batch_cleanly(few, tmp_path, monkeypatch):
    out = tmp_path / "out"
    real = os.fsync
    allowed = [6]

    def fsync(handle):
        allowed[0] -= 1
        if allowed[0] < 0:
            raise OSError(errno.ENOSPC, "No space left on device")
        real(handle)

    monkeypatch.setattr("addin.xlsx.save.os.fsync", fsync)
    stop = Stop()
    inputs = find_inputs([str(few)], out)
    with OutFolder(out) as folder, Batch(folder, Here(), stop=stop) as batch:
        try:
            batch.process(inputs)
        except Stopped as wrong:  # the journal could not be written either
            stop.reason = stop.reason or str(wrong)
        records = dict(batch.records)
    assert "free disk space" in stop.reason.lower()
    assert "--resume" in stop.reason
    monkeypatch.undo()
    assert left_over(out) == []
    for name, one in records.items():
        assert one.done == (out / name).is_file()
    after = run(few, out, resume=True)
    assert set(outcomes(after).values()) == {"done"}
    assert len(after) == 3


@pytest.mark.slow
def test_a_file_saved_while_it_is_calculated_is_tried_once_more(few, tmp_path, monkeypatch):
    import addin.writing.recalculate

    real = addin.writing.recalculate.recalculate_case
    touched = []

    def meanwhile(read, *words):
        found = real(read, *words)
        if read.path.name == "train 9.xlsx" and len(touched) < limit:
            touched.append(1)
            make_train(few / "train 9.xlsx", 60 + len(touched))
        return found

    monkeypatch.setattr("addin.writing.recalculate.recalculate_case", meanwhile)
    limit = 1
    assert run(few, tmp_path / "a")["train 9.xlsx"].done
    limit = 9
    record = run(few, tmp_path / "b")["train 9.xlsx"]
    assert record.outcome == "changed meanwhile"
    assert not (tmp_path / "b" / "train 9.xlsx").exists()


def test_a_folder_where_a_result_should_be(pair, tmp_path):
    out = tmp_path / "out"
    (out / "train 8.xlsx" / "x").mkdir(parents=True)
    records = run(pair, out)
    assert not records["train 8.xlsx"].done
    assert records["train 8.xlsx"].sentence
    assert records["train 9.xlsx"].done
    assert left_over(out) == []


def test_a_folder_that_may_not_be_written(trains, tmp_path, monkeypatch):
    """By hand, as root may write anywhere."""

    def refused(*words, **more):
        raise PermissionError(errno.EACCES, "Permission denied")

    monkeypatch.setattr("addin.batch.folder.Path.mkdir", refused)
    with pytest.raises(FolderRefused, match="Results cannot be written to .*Permission denied"):
        OutFolder(tmp_path / "out")


@pytest.mark.slow
def test_a_result_that_cannot_be_put_in_place_is_named(few, tmp_path, monkeypatch):
    real = os.replace

    def refused(source, target):
        if Path(target) == tmp_path / "out" / "train 8.xlsx":
            raise PermissionError(errno.EACCES, "Permission denied", str(target))
        real(source, target)

    monkeypatch.setattr("addin.batch.folder.os.replace", refused)
    records = run(few, tmp_path / "out")
    assert records["train 8.xlsx"].outcome == "no access"
    assert "probably open in Excel" in records["train 8.xlsx"].sentence
    assert sum(one.done for one in records.values()) == 2
    monkeypatch.undo()
    assert run(few, tmp_path / "out", resume=True)["train 8.xlsx"].done


def test_our_own_fault_is_recorded_and_the_rest_goes_on(pair, tmp_path, monkeypatch):
    real = work._calculated
    monkeypatch.setattr(
        work,
        "_calculated",
        lambda task, *more: 1 / 0 if task.name == "train 8.xlsx" else real(task, *more),
    )
    records = run(pair, tmp_path / "out")
    assert records["train 8.xlsx"].outcome == "fault"
    assert "ZeroDivisionError" in records["train 8.xlsx"].sentence
    assert records["train 9.xlsx"].done


def test_a_crash_is_recorded_with_what_to_do(pair, tmp_path):
    class Crashing(Here):
        def answers(self, stopped):
            for task, answer in super().answers(stopped):
                crash = isinstance(answer, work.Calculated) and task.tag.name == "train 9.xlsx"
                yield task, Crashed("the process was ended by SIGKILL") if crash else answer

    inputs = find_inputs([str(pair)], tmp_path / "out")
    with OutFolder(tmp_path / "out") as folder, Batch(folder, Crashing()) as batch:
        batch.process(inputs)
        record = batch.records["train 9.xlsx"]
    assert record.outcome == "crashed"
    assert "SIGKILL" in record.sentence


@pytest.mark.slow
def test_two_batches_on_one_folder(few, tmp_path):
    with OutFolder(tmp_path / "out"):
        said = torsionbook_process("batch", few, "--out", "out", cwd=tmp_path)
    assert said.returncode == 1
    assert "Another batch" in said.stderr
    assert "Traceback" not in said.stderr


# --- Ctrl-C ---------------------------------------------------------------------------------------


@pytest.mark.skipif(os.name == "nt", reason="a signal to a group is not sent there")
@pytest.mark.slow
@pytest.mark.parametrize("times", [1, 2])
def test_ctrl_c_ends_it_cleanly_and_resume_completes(tmp_path, times):
    for number in range(10):
        make_train(tmp_path / "in" / f"t{number}.xlsx", number)
    words = command("batch", "in", "--out", "out", "--jobs", 2)
    batch = subprocess.Popen(
        words,
        cwd=tmp_path,
        env=environment(),
        stderr=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
        start_new_session=True,  # so that the signal goes to the whole group, as from a terminal
    )
    until = time.monotonic() + 120
    while len(list((tmp_path / "out").glob("t*.xlsx"))) < 3:
        assert time.monotonic() < until
        time.sleep(0.02)
    for _ in range(times):
        os.killpg(batch.pid, signal.SIGINT)
        time.sleep(0.05)
    out, said = batch.communicate(timeout=120)
    assert batch.returncode == 130, said
    assert "Traceback" not in said
    assert "Interrupted" in said
    assert "--resume" in said
    assert "not begun" in out
    assert left_over(tmp_path / "out") == []
    rows = pd.read_csv(tmp_path / "out" / "summary.csv", encoding="utf-8-sig")
    assert len(rows) == 10
    done = set(rows[rows["Outcome"] == "done"]["File"])
    assert done == {p.name for p in (tmp_path / "out").glob("t*.xlsx")}
    assert 3 <= len(done) < 10
    again = torsionbook("batch", "in", "--out", "out", "--resume", cwd=tmp_path)
    assert again.returncode == 0, again.stderr
    assert f", {len(done)} of them in an earlier batch" in again.stdout
    assert " 10 done\n" in again.stdout


# --- text that looks like a formula ---------------------------------------------------------------


@pytest.mark.parametrize("text", ["=1+1", "+1", "-1", "@SUM(A1)", "\t=1", "\r=1", "\n=1", "plain"])
def test_no_text_becomes_a_formula(tmp_path, text):
    record = Record(
        "a.xlsx",
        "/in/a.xlsx",
        "wrong input",
        text,
        results={"tag": text},
        errors=({"sheet": text, "found": text, "message": text},),
    )
    book, table = write_summary(tmp_path / "s.xlsx", [record], text)
    for sheet in openpyxl.load_workbook(book):
        for row in sheet.iter_rows():
            for cell in row:
                assert cell.data_type != "f", (sheet.title, cell.coordinate)
    content = pd.read_csv(table, encoding="utf-8-sig", dtype=str)
    for value in content.loc[0, ["Tag", "What happened"]]:
        assert value == (text if text == "plain" else "'" + text)


def test_numbers_are_not_guarded(tmp_path):
    record = Record("a.xlsx", "/a", "done", results={"margin": -0.05})
    _, table = write_summary(tmp_path / "s.xlsx", [record], "")
    assert pd.read_csv(table, encoding="utf-8-sig").loc[0, "Worst margin [%]"] == -5.0
    assert guarded("a=1") == "a=1"


# --- words of the command line --------------------------------------------------------------------


@pytest.mark.first_ones(1)
@pytest.mark.parametrize(
    ("words", "status", "said"),
    [
        (["nothing", "--out", "o"], 1, "nothing"),
        (["gone/*.xlsx", "--out", "o"], 1, "No file matches gone"),
        ([".", "--out", "o", "--summary", "s.csv"], 2, "must end in .xlsx"),
        (["."], 2, "--out"),
        ([".", "--out", "o", "--jobs", "0"], 2, "--jobs"),
    ],
)
def test_wrong_words(tmp_path, words, status, said):
    done = torsionbook("batch", *words, cwd=tmp_path)
    assert done.returncode == status, done.stderr
    assert said in done.stdout + done.stderr
    assert not (tmp_path / "o" / OWN / "journal.jsonl").exists() or words[0] == "nothing"


@pytest.mark.slow
def test_strict_exits_with_one_where_a_verdict_fails(tmp_path):
    make_train(tmp_path / "a.xlsx")  # fails
    words = ("batch", "a.xlsx", "--out", "o", "--summary", "s/all.xlsx")
    assert torsionbook(*words, cwd=tmp_path).returncode == 0
    assert torsionbook(*words, "--strict", "--resume", cwd=tmp_path).returncode == 1
    assert (tmp_path / "s" / "all.csv").is_file()


# --- what is told ---------------------------------------------------------------------------------


@pytest.mark.slow
def test_the_verdict_says_what_was_not_judged(tmp_path):
    """In the cell, in the CSV and in the closing line, as sheet Summary says it."""
    source = make_train(tmp_path / "in" / "a.xlsx", example="modified")
    book = openpyxl.load_workbook(source)
    train = book["Train"]
    header, *rows = train[train.tables["Elements"].ref]
    at = [cell.value for cell in header].index("Peak torque limit")
    coupling = next(row for row in rows if row[0].value == "LS coupling")
    coupling[at].value = None
    header, first, *_ = train[train.tables["Meshes"].ref]
    first[[cell.value for cell in header].index("Backlash")].value = 0.0  # its torque reverses
    book.save(source)
    done = recalculate(tmp_path / "in" / "a.xlsx", destination=tmp_path / "a.out.xlsx")
    assert done.calculation is not None
    checks = done.calculation.results.verdicts
    left = [c for c in checks[1:] if c.verdict in ("not judged", "incomplete")]
    assert [c.check for c in left] == ["Peak torque"]
    said = torsionbook("batch", "in", "--out", "out", "--jobs", 1, cwd=tmp_path)
    cell = pd.read_csv(tmp_path / "out" / "summary.csv", encoding="utf-8-sig")["Verdict"][0]
    assert cell == "incomplete, 1 not judged"
    assert f" 1 × {cell}\n" in said.stdout


def test_an_unreadable_file_is_told_by_its_name_in_the_batch(tmp_path):
    (tmp_path / "in" / "deep").mkdir(parents=True)
    (tmp_path / "in" / "deep" / "a.xlsx").write_bytes(b"no workbook")
    torsionbook("batch", "in", "--out", "out", "--jobs", 1, cwd=tmp_path)
    errors = pd.read_excel(tmp_path / "out" / "summary.xlsx", sheet_name="Errors", header=3)
    assert list(errors["Found"]) == ["deep/a.xlsx"]
    assert str(tmp_path) not in errors.to_csv()


@pytest.mark.first_ones(1)
@pytest.mark.parametrize("last", [False, True])
def test_ctrl_c_while_the_last_file_runs_interrupts_nothing(few, tmp_path, last):
    from addin.cli import batch as commands

    stop, seen = Stop(), []

    class Asked(Here):
        def answers(self, stopped):
            for one in super().answers(stopped):
                if one[0].do.__name__ == "calculate":
                    seen.append(one)
                    stop.asked += len(seen) == (3 if last else 1)
                yield one

    inputs = find_inputs([str(few)], tmp_path / "out")
    with OutFolder(tmp_path / "out") as folder, Batch(folder, Asked(), stop=stop) as batch:
        ended = commands._processed(batch, inputs, stop)
        records = commands._rows(batch, inputs)
    assert stop.asked == 1
    assert bool(ended) is not last
    assert commands._status(records, ended, stop, False, True) == (0 if last else 130)


def test_lines_of_a_log_say_when_and_end_with_all(monkeypatch, capsys):
    from addin.cli import batch as commands

    now = [0.0]
    monkeypatch.setattr(commands.time, "monotonic", lambda: now[0])
    lines = commands._Lines()
    lines.begin("calculating", 9)
    for _ in range(9):
        now[0] += 4.0
        lines.advance(None)
    said = capsys.readouterr().err.splitlines()
    assert [line.split(": ")[1].split(",")[0] for line in said] == [
        "2 of 9",
        "5 of 9",
        "9 of 9",
    ]
    assert all(line[2] == ":" and line[5] == ":" for line in said)  # the time of day


@pytest.mark.slow
def test_the_summary_prints_on_pages_that_can_be_read(few, tmp_path):
    torsionbook("batch", "trains", "--out", "out", "--jobs", 1, cwd=tmp_path)
    sheet = openpyxl.load_workbook(tmp_path / "out" / "summary.xlsx")["Files"]
    assert sheet.page_setup.scale >= 70
    assert sheet.print_title_cols == "$A:$A"
    assert sheet.print_title_rows == "$4:$4"
    assert len(sheet.col_breaks.brk) == 3
