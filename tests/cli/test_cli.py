"""The command line on real files: what it writes, what it says, how it exits."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import jsonschema
import numpy as np
import openpyxl
import pandas as pd
import pytest
from command_line import command, environment, torsionbook, torsionbook_process

from addin.contract.sheets import part_named
from addin.contract.shipped import template_path
from addin.reading.one_file import file_problem
from addin.reference.json_schemas import results_schema
from addin.xlsx import open_workbook
from addin.xlsx.references import cell_name
from engine.case.effects import EFFECTS


@pytest.fixture(scope="module")
def example(tmp_path_factory) -> Path:
    """A folder in which the proposed example has been made and calculated, with its JSON."""
    folder = tmp_path_factory.mktemp("example")
    made = torsionbook("new", "train.xlsx", "--example", "proposed", cwd=folder)
    assert made.returncode == 0, made.stderr
    done = torsionbook_process("recalc", "train.xlsx", "--json", "train.json", cwd=folder)
    assert done.returncode == 0, done.stderr
    (folder / "stdout.txt").write_text(done.stdout, encoding="utf-8")
    return folder


def edited(source: Path, target: Path, **cells: object) -> Path:
    """A copy with cells typed into it: sheet__table__row__column = value."""
    book = openpyxl.load_workbook(source)
    for place, value in cells.items():
        sheet, table, row, column = place.split("__")
        sheet, column = sheet.replace("_", " "), column.replace("_", " ")
        ws = book[sheet]
        header = next(iter(ws[ws.tables[table].ref]))
        at = next(cell for cell in header if cell.value == column)
        ws.cell(at.row + int(row), at.column).value = value
    book.save(target)
    return target


def test_recalc_writes_a_new_file_and_leaves_the_input_alone(example):
    assert (example / "train.out.xlsx").is_file()
    assert (example / "train.xlsx").read_bytes() == template_path(
        "example_proposed.xlsx"
    ).read_bytes()


def test_the_summary_names_modes_margin_peak_starts_and_verdict(example):
    said = (example / "stdout.txt").read_text(encoding="utf-8")
    for word in ("train.xlsx", "30, 53.01, 86", "0.0 %", "rated", "fail", "train.out.xlsx"):
        assert word in said


def test_results_json_keeps_to_its_schema_and_to_the_published_table(example):
    results = json.loads((example / "train.json").read_text(encoding="utf-8"))
    jsonschema.validate(results, results_schema())
    elastic = [r for r in results["natural_frequencies"] if r["frequency"] > 0.0]
    assert [round(r["frequency"]) for r in elastic[:3]] == [30, 53, 86]  # as the paper prints them
    assert results["outcome"] == results["startup"]["outcome"] == "reached"
    assert results["errors"] == []


def test_sheet_and_json_show_the_same_numbers(example):
    results = json.loads((example / "train.json").read_text(encoding="utf-8"))
    sheet = openpyxl.load_workbook(example / "train.out.xlsx", data_only=True)["Results"]
    first, last = sheet.tables["NaturalFrequencies"].ref.split(":")
    rows = list(sheet[first:last])
    header = [c.value for c in rows[0]]
    at = header.index("Frequency")
    assert [r[at].value for r in rows[1:]] == pytest.approx(
        [r["frequency"] for r in results["natural_frequencies"]], rel=1e-12
    )


@pytest.mark.slow
def test_export_and_recalc_of_the_case_json_give_the_same_digest(example, tmp_path):
    out = torsionbook("export", example / "train.xlsx", "case.json", cwd=tmp_path)
    assert out.returncode == 0, out.stderr
    done = torsionbook("recalc", "case.json", "--json", "r.json", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    book = json.loads((example / "train.json").read_text(encoding="utf-8"))
    case = json.loads((tmp_path / "r.json").read_text(encoding="utf-8"))
    assert case["case_sha256"] == book["case_sha256"]
    assert case["allowable_starts"] == book["allowable_starts"]


def test_a_wrong_number_is_named_with_its_cell_and_nothing_is_written(tmp_path):
    source = template_path("example_modified.xlsx")
    edited(
        source,
        tmp_path / "bad.xlsx",
        Train__Stations__2__Inertia=-5,
        Train__Elements__3__To="Bull gaer",
        Torque_and_motor__MotorTorque__4__Speed="12,5",
    )
    done = torsionbook("recalc", "bad.xlsx", "--json", "bad.json", cwd=tmp_path)
    assert done.returncode == 1
    assert not (tmp_path / "bad.out.xlsx").exists()
    for word in ("table Stations, row 2, Inertia", "Bull gear", "12,5", "3 errors"):
        assert word in done.stderr
    errors = json.loads((tmp_path / "bad.json").read_text(encoding="utf-8"))["errors"]
    places = {(e["sheet"], e["table"], e["row"], e["column"]) for e in errors}
    assert ("Train", "Stations", 2, "Inertia") in places
    assert ("Train", "Elements", 3, "To") in places
    assert ("Torque and motor", "MotorTorque", 4, "Speed") in places


@pytest.mark.slow
def test_one_wrong_file_does_not_stop_the_others(tmp_path):
    edited(
        template_path("example_modified.xlsx"),
        tmp_path / "bad.xlsx",
        Train__Stations__2__Inertia=-5,
    )
    (tmp_path / "good.xlsx").write_bytes(template_path("example_modified.xlsx").read_bytes())
    done = torsionbook(
        "recalc", "bad.xlsx", "missing.xlsx", "good.xlsx", "--out", "results", cwd=tmp_path
    )
    assert done.returncode == 1
    assert [p.name for p in (tmp_path / "results").iterdir()] == ["good.xlsx"]
    assert "missing.xlsx does not exist" in done.stderr


@pytest.mark.slow
def test_in_place_keeps_a_backup(tmp_path):
    book = tmp_path / "train.xlsx"
    original = template_path("example_modified.xlsx").read_bytes()
    book.write_bytes(original)
    done = torsionbook("recalc", "train.xlsx", "--in-place", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert book.read_bytes() != original
    assert (tmp_path / "train.xlsx.bak").read_bytes() == original


@pytest.mark.slow
def test_a_workbook_open_in_excel_is_refused_by_name(tmp_path):
    (tmp_path / "train.xlsx").write_bytes(template_path("example_modified.xlsx").read_bytes())
    name = "A. Engineer"
    lock = bytes([len(name)]) + name.encode().ljust(54) + bytes([len(name), 0])
    (tmp_path / "~$train.xlsx").write_bytes(lock + name.encode("utf-16-le").ljust(108, b" "))
    done = torsionbook("recalc", "train.xlsx", "--in-place", cwd=tmp_path)
    assert done.returncode == 1
    assert "train.xlsx" in done.stderr
    assert "A. Engineer" in done.stderr


@pytest.mark.first_ones(4)
@pytest.mark.parametrize(
    "words",
    [
        ("recalc", "x.xlsx", "--method", "euler"),
        ("recalc", "x.xlsx", "--tolerance", "tight"),
        ("recalc", "x.xlsx", "--tolerance", "200%"),
        ("recalc", "x.xlsx", "--tolerance", "1e-8"),
        ("recalc", "x.xlsx", "--out", "a", "--in-place"),
        ("recalc", "a/x.xlsx", "b/x.xlsx", "--out", "c"),
        ("accuracy", "x.xlsx", "--out", "a", "--in-place"),
        ("accuracy", "x.xlsx", "--out", "."),
        ("accuracy", "x.xlsx", "y.xlsx"),
        ("new", "x.xls"),
        ("new", "x.xlsx", "--units", "metric"),
        ("recalc",),
        ("nonsense",),
    ],
)
def test_wrong_usage_exits_with_two(words, tmp_path):
    done = torsionbook(*words, cwd=tmp_path)
    assert done.returncode == 2
    assert "Traceback" not in done.stderr


@pytest.mark.skipif(sys.platform != "linux", reason="no place here that cannot be made")
def test_a_folder_that_cannot_be_made_is_no_missing_file():
    with pytest.raises(FileNotFoundError) as wrong:
        Path("/proc/nowhere/results").mkdir(parents=True)
    sentence = file_problem(Path("train.xlsx"), wrong.value).message
    assert sentence == ("/proc/nowhere cannot be created. Name another folder for the results.")
    with pytest.raises(FileNotFoundError) as wrong:
        open("train that is not there.xlsx")
    sentence = file_problem(Path("train that is not there.xlsx"), wrong.value).message
    assert sentence == "file train that is not there.xlsx not found. Check the path."


def test_new_refuses_to_replace_a_file(tmp_path):
    (tmp_path / "x.xlsx").write_text("mine")
    done = torsionbook("new", "x.xlsx", cwd=tmp_path)
    assert done.returncode == 1
    assert "--force" in done.stderr
    assert (tmp_path / "x.xlsx").read_text() == "mine"


def test_a_blank_template_says_what_it_wants(tmp_path):
    torsionbook("new", "x.xlsx", "--units", "si", cwd=tmp_path)
    done = torsionbook("check", "x.xlsx", cwd=tmp_path)
    assert done.returncode == 1
    assert "at least one station" in done.stderr


@pytest.mark.slow
def test_check_says_what_an_almost_empty_workbook_cannot_answer(tmp_path):
    torsionbook("new", "x.xlsx", "--units", "si", cwd=tmp_path)
    book = open_workbook(tmp_path / "x.xlsx")
    stations, elements = book.table("Stations"), book.table("Elements")
    for table, rows in (
        (stations, [{"Station": "Motor", "Inertia": 10.0}, {"Station": "Fan", "Inertia": 40.0}]),
        (elements, [{"Element": "Shaft", "Kind": "shaft", "From": "Motor", "To": "Fan", "Stiffness": 1.0}]),
    ):  # fmt: skip
        for k, row in enumerate(rows):
            for name, value in row.items():
                at = table.ref.left + table.column_index(name)
                book.set_cell(table.sheet, cell_name(table.data.top + k, at), value)
    book.save(in_place=True)
    done = torsionbook("check", "x.xlsx", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    first, speeds, *more = done.stdout.splitlines()[-3:]
    assert first == "x.xlsx: no errors."
    assert speeds.startswith("  At full speed: ")
    assert "No separation margins and no forced response" in more[0]
    assert "No start: tables MotorTorque and TorqueTime are empty" in more[0]
    whole = torsionbook("new", "y.xlsx", "--example", "proposed", cwd=tmp_path)
    whole = torsionbook("check", "y.xlsx", cwd=tmp_path)
    assert "No start" not in whole.stdout


@pytest.mark.slow
def test_strict_turns_a_failed_verdict_into_one(example):
    done = torsionbook("recalc", "train.xlsx", "--strict", "--out", "strict", cwd=example)
    assert done.returncode == 1
    assert (example / "strict" / "train.xlsx").is_file()


@pytest.mark.slow
def test_newmark_and_tolerance_are_recorded_in_the_audit(example):
    done = torsionbook(
        "recalc", "train.xlsx", "--method", "newmark", "--tolerance", "2%",
        "--json", "n.json", "--out", "newmark", cwd=example,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    results = json.loads((example / "n.json").read_text(encoding="utf-8"))
    items = {row["item"]: row["value"] for row in results["audit"]}
    assert items["Setting of the command line: method"] == "newmark"
    usual = json.loads((example / "train.json").read_text(encoding="utf-8"))
    assert results["case_sha256"] == usual["case_sha256"]
    ours = {r["element"]: r["maximum_torque"] for r in usual["startup_peaks"]}
    for row in results["startup_peaks"]:
        assert row["maximum_torque"] == pytest.approx(ours[row["element"]], rel=0.04)


@pytest.mark.slow
def test_two_runs_with_a_fixed_date_are_byte_identical_but_for_the_times_spent(example, tmp_path):
    results = []
    for name in ("a", "b"):
        torsionbook("recalc", example / "train.xlsx", "--json", f"{name}.json",
                    "--out", name, cwd=tmp_path)  # fmt: skip
        content = json.loads((tmp_path / f"{name}.json").read_text(encoding="utf-8"))
        content["audit"] = [
            r for r in content["audit"] if not r["item"].startswith(("Time spent", "Date"))
        ]
        for row in (*content["effects"], *content["accuracy_cost"]):
            row.pop("time", None)
        results.append(content)
    assert results[0] == results[1]


def test_json_holds_energy_shares_and_nodes_of_every_mode(example):
    results = json.loads((example / "train.json").read_text(encoding="utf-8"))
    assert [m["mode"] for m in results["modes"]] == list(range(1, 11))
    for mode in results["modes"]:
        assert sum(mode["strain_energy"].values()) == pytest.approx(1.0)
        assert sum(mode["kinetic_energy"].values()) == pytest.approx(1.0)
    first = results["modes"][0]
    table = next(r for r in results["natural_frequencies"] if r["mode"] == 1)
    assert (
        max(first["strain_energy"], key=first["strain_energy"].get)
        == (table["largest_strain_energy"])
    )
    assert len(first["nodes"]) == 1  # the first mode of a free train stands still at one point
    assert "damped_eigenvalues" not in results  # proportional damping


@pytest.mark.first_ones(1)
@pytest.mark.parametrize("kind", ["npz", "parquet"])
def test_the_full_history_is_written_beside_the_results_on_request(example, tmp_path, kind):
    done = torsionbook("export", example / "train.xlsx", "case.json", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    case = json.loads((tmp_path / "case.json").read_text(encoding="utf-8"))
    case["keep_history"] = kind
    (tmp_path / "case.json").write_text(json.dumps(case), encoding="utf-8")
    done = torsionbook("recalc", "case.json", "--out", "results", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    (file,) = (tmp_path / "results").glob(f"*.{kind}")
    if kind == "npz":
        history = dict(np.load(file))
    else:
        history = {k: v.to_numpy() for k, v in pd.read_parquet(file).items()}
    results = json.loads((example / "train.json").read_text(encoding="utf-8"))
    assert np.all(np.diff(history["time_s"]) > 0.0)
    assert len(history) == 2 + len(results["startup_peaks"])
    for peak in results["startup_peaks"]:
        sampled = history[f"torque_N_m: {peak['element']}"].max()
        # the peak lies between samples, so the largest sample is at or below it
        assert sampled == pytest.approx(peak["maximum_torque"], rel=0.05)
        assert sampled <= peak["maximum_torque"] * (1.0 + peak["error"])


@pytest.mark.slow
def test_results_that_differ_in_the_ending_only_have_a_history_each(example, tmp_path):
    done = torsionbook("export", example / "train.xlsx", "a.json", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    case = json.loads((tmp_path / "a.json").read_text(encoding="utf-8"))
    (tmp_path / "a.json").write_text(json.dumps(case | {"keep_history": "npz"}), encoding="utf-8")
    torsionbook("new", "a.results.xlsx", "--from", "a.json", cwd=tmp_path)
    done = torsionbook("recalc", "a.json", "a.results.xlsx", "--out", "r", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    histories = sorted(p.name for p in (tmp_path / "r").glob("*.npz"))
    assert histories == ["a.results.json.history.npz", "a.results.xlsx.history.npz"]


def test_plan_effects_and_reversals_are_in_the_json_of_a_plain_recalculation(example):
    results = json.loads((example / "train.json").read_text(encoding="utf-8"))
    assert [row["effect"] for row in results["effects"]] == list(EFFECTS)
    assert all(isinstance(row["on"], bool) and row["why"] for row in results["effects"])
    assert [plan["number"] for plan in results["plans"]][:1] == [1]
    (mesh,) = results["torque_reversals"]
    peaks = {row["element"]: row for row in results["startup_peaks"]}
    assert mesh["minimum_torque"] == pytest.approx(peaks["Mesh"]["minimum_torque"], rel=1e-12)
    assert mesh["model"] == "linear"
    assert mesh["reversals"] > 0
    assert mesh["minimum_torque"] < 0.0
    start = next(row for row in results["accuracy_cost"] if "error_peak" in row)
    assert 0.0 < start["error_peak"] <= 1e-3


@pytest.fixture(scope="module")
def studied(example) -> Path:
    """The calculated example with its accuracy study beside it, as workbook and as JSON."""
    done = torsionbook(
        "accuracy",
        "train.out.xlsx",
        "--quick",
        "--json",
        "study.json",
        "--out",
        "studied",
        cwd=example,
    )
    assert done.returncode == 0, done.stderr
    (example / "study.txt").write_text(done.stdout, encoding="utf-8")
    return example


@pytest.mark.slow
def test_the_study_prints_its_table_and_one_line_in_words(studied):
    said = (studied / "study.txt").read_text(encoding="utf-8")
    content = json.loads((studied / "study.json").read_text(encoding="utf-8"))
    jsonschema.validate(content, results_schema())
    assert content["accuracy"]["sentence"] in said
    assert f"written: {Path('studied') / 'train.out.xlsx'}" in said
    rows = content["accuracy_cost"]
    for method in ("exponential", "newmark"):
        of_method = [row for row in rows if row["method"] == method]
        assert len(of_method) >= 5
        assert of_method[-1]["error_peak"] < of_method[0]["error_peak"] / 50.0
        assert all(row["time"] > 0.0 and row["setting"] in said for row in of_method)
    plain = json.loads((studied / "train.json").read_text(encoding="utf-8"))
    assert content["case_sha256"] == plain["case_sha256"]


@pytest.mark.slow
def test_the_study_changes_its_own_sheet_and_no_other_result(studied):
    before, after = (
        openpyxl.load_workbook(studied / name, data_only=True)
        for name in ("train.out.xlsx", "studied/train.out.xlsx")
    )
    content = json.loads((studied / "study.json").read_text(encoding="utf-8"))
    part = part_named("Accuracy")
    begins = after[part.worksheet][part.at("B1")].column
    for sheet in after.worksheets:
        if sheet.title in ("ChartData", "Lists"):
            continue
        for row in sheet.iter_rows():
            for cell in row:
                if sheet.title != part.worksheet or cell.column < begins:
                    assert cell.value == before[sheet.title][cell.coordinate].value
    words = [after[part.worksheet][part.at(f"B{row}")].value for row in (4, 5, 6)]
    assert words[0] == content["accuracy"]["sentence"]
    assert content["case_sha256"][:12] in words[2]


def test_the_study_of_a_wrong_workbook_names_its_cells(tmp_path):
    edited(
        template_path("example_modified.xlsx"),
        tmp_path / "bad.xlsx",
        Train__Stations__2__Inertia=-5,
    )
    done = torsionbook("accuracy", "bad.xlsx", cwd=tmp_path)
    assert done.returncode == 1
    assert "table Stations, row 2, Inertia" in done.stderr
    assert [p.name for p in tmp_path.iterdir()] == ["bad.xlsx"]


@pytest.mark.slow
def test_the_study_of_a_case_json_is_a_json(example, tmp_path):
    out = torsionbook("export", example / "train.xlsx", "case.json", cwd=tmp_path)
    assert out.returncode == 0, out.stderr
    done = torsionbook("accuracy", "case.json", "--quick", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    content = json.loads((tmp_path / "case.accuracy.json").read_text(encoding="utf-8"))
    assert content["accuracy_cost"]


def test_redirected_output_is_utf8_whatever_the_locale(tmp_path):
    """As on Windows, where a file or another program would get the code page of the machine."""
    own = environment() | {"LC_ALL": "C", "PYTHONCOERCECLOCALE": "0", "PYTHONUTF8": "0"}
    own.pop("PYTHONIOENCODING")
    done = subprocess.run(command("--help"), cwd=tmp_path, capture_output=True, env=own, timeout=60)
    assert done.returncode == 0, done.stderr
    assert "─" in done.stdout.decode("utf-8")  # the corners differ on Windows
