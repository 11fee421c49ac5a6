"""`--json`, `--method`, `--tolerance`: as `recalc` has them, and kept apart by `--resume`."""

from __future__ import annotations

import errno
import json
import os
import shutil
from pathlib import Path

import numpy as np
import openpyxl
import pytest
from batch_helpers import Here, make_train, spoil
from command_line import torsionbook

from addin.batch.folder import OutFolder
from addin.batch.inputs import InputsRefused, find_inputs
from addin.batch.records import Record
from addin.batch.scheduler import Batch
from addin.xlsx import open_workbook

NEWMARK = {"method": "newmark", "tolerance_peak": 0.01}
#: Keys of a result JSON that belong to one run.
OWN_OF_EACH_RUN = {"accuracy_cost", "audit", "effects", "plans"}


def run(trains: Path, out: Path, *, resume: bool = False, **more) -> dict[str, Record]:
    """A batch in this process."""
    inputs = find_inputs([str(trains)], out)
    with OutFolder(out) as folder, Batch(folder, Here(), resume=resume, **more) as batch:
        batch.process(inputs)
        return dict(batch.records)


@pytest.fixture
def counted(monkeypatch):
    """Which cases the engine runs."""
    import addin.calculation.calculation

    calls = []
    real = addin.calculation.calculation.run_with_conditions
    monkeypatch.setattr(
        addin.calculation.calculation,
        "run_with_conditions",
        lambda *words: calls.append(words[0]) or real(*words),
    )
    return calls


def audit(path: Path) -> dict[str, str]:
    """Table Audit, by an independent reader."""
    book = openpyxl.load_workbook(path, data_only=True)
    sheet = book["Audit"]
    return {row[0].value: row[1].value for row in sheet[sheet.tables["Audit"].ref]}


def table_rows(path: Path, name: str) -> list[dict]:
    """A table of a workbook, by an independent reader."""
    for sheet in openpyxl.load_workbook(path, data_only=True):
        if name in sheet.tables:
            header, *rows = [[cell.value for cell in row] for row in sheet[sheet.tables[name].ref]]
            return [dict(zip(header, row, strict=True)) for row in rows]
    raise LookupError(name)


def read(path: Path) -> dict:
    return json.loads(path.read_text(encoding="utf-8"))


@pytest.mark.slow
def test_settings_reach_every_file_and_are_written_where_verify_looks(few, tmp_path, counted):
    records = run(few, tmp_path / "out", overrides=NEWMARK)
    assert len(records) == 3
    assert len(counted) == 2  # the twin has the case of another
    assert {(case.method, case.tolerance_peak) for case in counted} == {("newmark", 0.01)}
    for name, record in records.items():
        said = audit(tmp_path / "out" / name)
        assert said["Setting of the command line: method"] == "newmark"
        assert said["Setting of the command line: tolerance_peak"] == "0.01"
        assert record.settings == NEWMARK


@pytest.mark.slow
def test_resume_with_other_settings_reuses_nothing(few, tmp_path, counted):
    out = tmp_path / "out"
    run(few, out)
    for settings, runs in (
        ({}, 0),
        ({"method": "newmark"}, 2),
        ({"method": "newmark"}, 0),
        ({"method": "newmark", "tolerance_peak": 0.01}, 2),
        ({}, 2),
    ):
        counted.clear()
        run(few, out, resume=True, overrides=settings)
        assert len(counted) == runs, settings
        said = audit(out / "twin.xlsx")
        assert said.get("Setting of the command line: method") == settings.get("method")


@pytest.mark.slow
def test_json_is_that_of_recalc(few, tmp_path):
    words = ("--method", "newmark", "--tolerance", "1%")
    done = torsionbook(
        "batch", few, "--out", "out", "--json", "j", "--jobs", 1, *words, cwd=tmp_path
    )
    assert done.returncode == 0, done.stderr
    one = few / "twin.xlsx"
    done = torsionbook("recalc", one, "--out", "r", "--json", "r/t.json", *words, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    mine, its = read(tmp_path / "j" / "twin.results.json"), read(tmp_path / "r" / "t.json")
    assert mine.keys() == its.keys()
    assert {k for k in its if mine[k] != its[k]} <= OWN_OF_EACH_RUN
    assert sorted(p.name for p in (tmp_path / "j").iterdir()) == [
        f"{name}.results.json" for name in ("train 8", "train 9", "twin")
    ]
    heading = openpyxl.load_workbook(tmp_path / "out" / "summary.xlsx")["Files"]["A2"].value
    assert "method = newmark, tolerance_peak = 0.01" in heading
    # nothing is left to do, until a JSON is lost
    assert audit(tmp_path / "out" / "twin.xlsx")["Setting of the command line: method"] == "newmark"
    again = ("batch", few, "--out", "out", "--json", "j", "--resume", *words)
    assert ", 3 of them in an earlier batch" in torsionbook(*again, cwd=tmp_path).stdout
    (tmp_path / "j" / "train 9.results.json").unlink()
    assert ", 2 of them in an earlier batch" in torsionbook(*again, cwd=tmp_path).stdout
    assert (tmp_path / "j" / "train 9.results.json").is_file()


@pytest.mark.slow
def test_an_input_with_errors_gets_them_in_place_of_its_results(few, tmp_path, counted):
    out, there = tmp_path / "out", tmp_path / "json"
    run(few, out, json=there)
    assert read(there / "twin.results.json")["natural_frequencies"]
    spoil(few / "twin.xlsx")
    done = torsionbook("recalc", few / "twin.xlsx", "--json", "its.json", cwd=tmp_path)
    assert done.returncode == 1
    first = (there / "twin.results.json").read_bytes()
    record = run(few, out, json=there, resume=True)["twin.xlsx"]
    assert read(there / "twin.results.json") == read(tmp_path / "its.json")
    assert (there / "twin.results.json.old").read_bytes() == first
    assert "it was renamed to twin.results.json.old." in record.sentence
    counted.clear()
    again = run(few, out, json=there, resume=True)["twin.xlsx"]
    assert counted == []
    assert again == record  # and the errors are no results to be set aside
    run(few, out, json=there)
    assert len(list(there.glob("twin*"))) == 2


@pytest.mark.slow
def test_a_json_of_an_earlier_run_elsewhere_does_not_stand_for_an_input_that_turned_bad(
    few, tmp_path
):
    out, there = tmp_path / "out", tmp_path / "json"
    run(few, out, json=there)
    spoil(few / "twin.xlsx")
    (there / "train 8.results.json").write_text("mine", encoding="utf-8")
    spoil(few / "train 8.xlsx")
    records = run(few, out, resume=True)  # without --json this time
    assert "twin.results.json.old" in records["twin.xlsx"].sentence
    assert not (there / "twin.results.json").exists()
    assert read(there / "twin.results.json.old")["natural_frequencies"]
    assert (there / "train 8.results.json").read_text(encoding="utf-8") == "mine"
    assert (there / "train 9.results.json").is_file()


@pytest.mark.slow
def test_a_json_stays_where_the_reason_passes_by_itself(few, tmp_path):
    out, there = tmp_path / "out", tmp_path / "json"
    run(few, out, json=there)
    first = (there / "train 9.results.json").read_bytes()
    (few / "~$train 9.xlsx").write_bytes(b"\x03Ada")
    record = run(few, out, json=there)["train 9.xlsx"]
    assert record.outcome == "locked"
    assert "train 9.results.json is still the result of an earlier calculation." in record.sentence
    assert (there / "train 9.results.json").read_bytes() == first


@pytest.mark.slow
def test_json_asked_for_later_is_made(few, tmp_path, counted):
    out = tmp_path / "out"
    run(few, out)
    counted.clear()
    run(few, out, resume=True, json=out)
    assert len(counted) == 2
    assert (out / "twin.results.json").is_file()


@pytest.mark.slow
def test_a_workbook_with_macros_and_one_without_do_not_share_a_history(tmp_path):
    trains, out = tmp_path / "in", tmp_path / "out"
    make_train(trains / "a.xlsx", KeepHistory="npz")
    torsionbook("new", "a.xlsm", "--example", "modified", cwd=trains)
    book = open_workbook(trains / "a.xlsm", ignore_lock=True)
    book.set_name("KeepHistory", "npz")
    book.save(in_place=True)
    make_train(trains / "b.xlsx", 1, KeepHistory="npz")
    records = run(trains, out)
    assert {one.outcome for one in records.values()} == {"done"}
    names = ["a.xlsm.history.npz", "a.xlsx.history.npz", "b.history.npz"]
    assert sorted(p.name for p in out.glob("*.npz")) == names
    for name in ("a.xlsm", "a.xlsx"):  # each holds the coupling of its own train
        peak = next(
            r for r in table_rows(out / name, "StartupPeaks") if r["Element"] == "LS coupling"
        )
        highest = np.load(out / f"{name}.history.npz")["torque_N_m: LS coupling"].max()
        assert highest == pytest.approx(1.3558179483314004 * peak["Maximum torque"], rel=0.05)
    assert {one.name for one in records["a.xlsm"].outputs} == {"a.xlsm", names[0]}


@pytest.mark.slow
def test_a_history_that_is_not_wanted_any_more_is_set_aside(few, tmp_path):
    train, out = make_train(few / "twin.xlsx", 1, KeepHistory="npz"), tmp_path / "out"
    run(few, out)
    first = (out / "twin.history.npz").read_bytes()
    make_train(train, 2, KeepHistory="no")
    record = run(few, out, resume=True)["twin.xlsx"]
    assert record.done
    assert "it was renamed to twin.history.npz.old." in record.warnings[-1]
    assert not (out / "twin.history.npz").exists()
    assert (out / "twin.history.npz.old").read_bytes() == first


def test_json_on_another_disk(pair, tmp_path, monkeypatch):
    real, there = os.replace, tmp_path / "json"

    def replace(source, target):
        if there in Path(target).parents and there not in Path(source).parents:
            raise OSError(errno.EXDEV, "Invalid cross-device link", str(source))
        real(source, target)

    monkeypatch.setattr(os, "replace", replace)
    records = run(pair, tmp_path / "out", json=there)
    assert {one.outcome for one in records.values()} == {"done"}
    names = sorted(p.name for p in there.iterdir())
    assert names == ["train 8.results.json", "train 9.results.json"]


def test_two_files_with_one_json_are_refused_only_where_json_is_asked_for(few, tmp_path):
    shutil.copy(few / "twin.xlsx", few / "twin.xlsm")
    assert len(find_inputs([str(few)], tmp_path / "out")) == 4
    with pytest.raises(InputsRefused, match=r"both be written to twin\.results\.json"):
        find_inputs([str(few)], tmp_path / "out", json=True)


@pytest.mark.slow
def test_a_programme_of_cases_respects_settings(few, tmp_path):
    pd = pytest.importorskip("pandas")
    (tmp_path / "t.csv").write_text("Name,DampingRatio\na,0.015\n", encoding="utf-8")
    words = ("batch", few / "twin.xlsx", "--vary", "t.csv", "--out", "out", "--jobs", 1)
    peaks = {}
    for settings in ((), ("--method", "newmark", "--tolerance", "5%")):
        done = torsionbook(*words, *settings, cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        peaks[settings] = pd.read_parquet(tmp_path / "out" / "results.parquet")
    ours, papers = (float(one["peak_torque_N_m"].iloc[0]) for one in peaks.values())
    # another method to a coarse tolerance: near, and not the same
    assert ours != papers
    assert papers == pytest.approx(ours, rel=0.1)
    done = torsionbook(*words, "--resume", cwd=tmp_path)
    assert done.returncode == 1
    assert "--method, --tolerance or torsionbook has changed" in done.stderr


@pytest.mark.first_ones(1)
@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--method", "euler"), "newmark"),
        (("--tolerance", "much"), "write a number"),
        (("--tolerance", "0.9"), "must be between"),
        (("--tolerance", "1e-8"), "must be between 2e-07 and 0.5"),
        (("--json", "a.json"), "it must name a folder"),
        (("--json", "j", "--vary", "t.csv"), "are Parquet"),
    ],
)
def test_wrong_words(few, tmp_path, words, said):
    target = few / "twin.xlsx"
    done = torsionbook("batch", target, "--out", "out", *words, cwd=tmp_path)
    assert done.returncode == 2
    assert said in " ".join(done.stderr.replace("│", " ").split())
    assert not (tmp_path / "out").exists()
