"""`torsionbook starts` and `calibrate` by the real command line: workbook, JSON, wrong rows."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import jsonschema
import pytest
from typer.testing import CliRunner

from addin.cli.app import app
from addin.contract.shipped import template_path
from addin.reading.case_json import case_to_json
from addin.reading.workbook import read_workbook
from addin.reference.json_schemas import SCHEMA_FOLDER, study_schema
from addin.studies.calibration import CALIBRATION
from addin.studies.starts import STARTS
from addin.xlsx import open_workbook
from benchmarks.workbook_fuzz import seeds
from engine.run import run
from tests.opened import opened, rows_of

RUN = CliRunner()
WIDE = {"COLUMNS": "240"}


def said(*words: str | Path, code: int = 0) -> str:
    done = RUN.invoke(app, [str(word) for word in words], env=WIDE)
    assert done.exit_code == code, done.output
    return done.output


def content(**tables: list[dict[str, Any]]) -> dict[str, Any]:
    case = case_to_json(read_workbook(template_path("example_proposed.xlsx")).data)
    return case | tables


def write(path: Path, **tables: list[dict[str, Any]]) -> Path:
    path.write_text(json.dumps(content(**tables)), encoding="utf-8")
    return path


def named(path: Path, name: str) -> Any:
    book = opened(path)
    ((sheet, cell),) = book.defined_names[name].destinations
    return book[sheet][cell.replace("$", "")].value


def set_scatter(book: Path, rows: tuple[tuple[object, ...], ...]) -> None:
    """Other rows of table Scatter: the fewer unknowns, the fewer starts."""
    workbook = open_workbook(book)
    columns = ("Quantity", "Distribution", "Spread", "Together")
    workbook.write_table("Scatter", rows, columns=columns)
    workbook.save(in_place=True)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The filled example after both studies, each with its JSON."""
    path = tmp_path_factory.mktemp("studies")
    book = path / "train.xlsx"
    said("new", book, "--example", "proposed", "--studies")
    set_scatter(
        book,
        (
            ("stiffness", "normal", 5.0, "together"),
            ("damping ratio", "uniform", 30.0, None),
        ),
    )
    (path / "starts.txt").write_text(
        said("starts", book, "--json", path / "starts.json", "--jobs", "1"), encoding="utf-8"
    )
    said(
        "calibrate", path / "train.out.xlsx", "--json", path / "calibrate.json", "--case",
        path / "calibrated.json", "--jobs", "1", "--in-place",
    )  # fmt: skip
    return path


def read(path: Path) -> dict[str, Any]:
    return dict(json.loads(path.read_text(encoding="utf-8")))


@pytest.mark.slow
@pytest.mark.parametrize("name", ["starts", "calibration"])
def test_the_json_keeps_its_schema(folder: Path, name: str) -> None:
    schema = read(SCHEMA_FOLDER / f"{name}.schema.json")
    jsonschema.Draft202012Validator.check_schema(schema)
    written = read(folder / f"{'calibrate' if name == 'calibration' else name}.json")
    jsonschema.validate(written, schema)
    assert schema == study_schema({"starts": STARTS, "calibration": CALIBRATION}[name].spec)


# --- starts ---------------------------------------------------------------------------------------


def test_the_start_of_the_case_is_a_row_with_its_own_numbers(folder: Path) -> None:
    rows = {r["condition"]: r for r in read(folder / "starts.json")["start_matrix"]}
    starts = run(read_workbook(template_path("example_proposed.xlsx")).case()).starts
    assert starts is not None
    assert rows["normal start"]["allowable_starts"] == pytest.approx(starts.starts, rel=2e-3)
    assert rows["weak supply"]["allowable_starts"] > rows["normal start"]["allowable_starts"]
    assert rows["supply sags to 40 %"]["judged"] is False
    assert "allowable_starts" not in rows["supply sags to 40 %"]


def test_cells_of_the_start_matrix_equal_the_json(folder: Path) -> None:
    found, book = read(folder / "starts.json"), folder / "train.out.xlsx"
    shown = rows_of(book, "StartMatrix")
    assert len(shown) == len(found["start_matrix"])
    for cell, row in zip(shown, found["start_matrix"], strict=True):
        assert cell["Condition"] == row["condition"]
        assert cell["Voltage"] == pytest.approx(100.0 * row["voltage"])
        assert cell["Peak-to-peak stress"] == pytest.approx(
            row["peak_to_peak_stress"] / 6894.757293168361
        )
        wanted = row.get("allowable_starts", "not judged")
        assert cell["Allowable starts"] == (
            wanted if isinstance(wanted, str) else pytest.approx(wanted)
        )
    assert named(book, "starts_Sentence") == found["sentence"]
    assert len(named(book, "starts_SHA256")) == 64


def test_the_ledger_adds_up_from_the_cells(folder: Path) -> None:
    """An engineer's check with the numbers on the sheets: Σ n q by hand."""
    book = folder / "train.out.xlsx"
    ledger = rows_of(book, "DamageLedger")
    row = next(r for r in ledger if r["Element"] == "HP compressor shaft")
    duty = [r for r in rows_of(book, "RemainingStarts") if r["Element"] == row["Element"]]
    used = sum(r["So far"] * r["Damage"] for r in duty)
    yearly = sum(r["Per year"] * r["Damage"] for r in duty)
    assert row["Used"] == pytest.approx(used)
    assert row["Yearly"] == pytest.approx(yearly)
    assert row["Remaining years"] == pytest.approx((1.0 - used) / yearly)
    assert row["Years low"] < row["Remaining years"] < row["Years high"]
    assert row["Verdict"] == "pass"
    told = next(
        r for r in read(folder / "starts.json")["damage_ledger"] if r["element"] == row["Element"]
    )
    assert told["remaining_years"] == pytest.approx(row["Remaining years"])
    normal = next(r for r in duty if r["Condition"] == "normal start")
    assert normal["Remaining starts"] == pytest.approx((1.0 - used) / normal["Damage"])
    stalled = next(r for r in duty if r["Condition"].startswith("supply sags"))
    assert stalled["Remaining starts"] == "not judged"


def test_the_terminal_shows_the_matrix(folder: Path) -> None:
    text = (folder / "starts.txt").read_text(encoding="utf-8")
    line = next(x for x in text.splitlines() if x.startswith("weak supply"))
    assert "reached at 97.0 % speed" in line
    assert "not judged" in next(x for x in text.splitlines() if x.startswith("supply sags"))
    assert "years" in text


def test_a_blank_duty_is_the_standard_matrix(tmp_path: Path) -> None:
    """Without coast-downs: EndSpeed below every trip speed of the standard matrix."""
    source = tmp_path / "case.json"
    source.write_text(
        json.dumps(content() | {"end_speed": "14 %", "maximum_time": 20.0}), encoding="utf-8"
    )
    source.write_text(
        source.read_text(encoding="utf-8").replace('"14 %"', str(0.14 * 60.0 * math.pi)),
        encoding="utf-8",
    )
    said("starts", source, "--jobs", "1")
    found = read(tmp_path / "case.starts.json")
    voltages = [r["voltage"] for r in found["start_matrix"]]
    assert voltages == [0.8, 0.85, 0.9, 0.95, 1.0, 1.05, 1.1] * 2
    assert found["standard"] is True
    assert "No duty in table StartConditions" in found["sentence"]
    assert [r["voltage"] for r in found["starts_by_voltage"]] == voltages[:7]
    assert any("No aborted start just past" in w for w in found["warnings"])


def test_wrong_rows_of_a_duty(tmp_path: Path) -> None:
    source = write(
        tmp_path / "case.json",
        start_conditions=[{"condition": "a", "voltage": 80}, {"condition": "a", "load": -1}],
    )
    text = said("starts", source, code=1)
    assert "table StartConditions, row 1, Voltage" in text
    assert "row 2, Condition" in text
    assert "row 2, Load" in text
    assert not (tmp_path / "case.starts.json").exists()


def test_a_train_without_motor_torque_gets_no_file(tmp_path: Path) -> None:
    book = tmp_path / "train.xlsx"
    book.write_bytes(seeds()[0].data)
    for more in ((), ("--in-place",)):
        output = said("starts", book, "--jobs", "1", *more, code=1)
        assert "has no rows in table MotorTorque, so there is no start" in output
        assert "sheet ." not in output
    assert list(tmp_path.iterdir()) == [book]
    assert book.read_bytes() == seeds()[0].data


def test_a_train_without_judged_shaft(tmp_path: Path) -> None:
    source = tmp_path / "case.json"
    case = content(start_conditions=[{"condition": "a", "per_year": 3}])
    case.pop("sn_points")
    source.write_text(json.dumps(case), encoding="utf-8")
    assert "No shaft has stress diameter" in said("starts", source, "--jobs", "1")
    assert read(tmp_path / "case.starts.json")["damage_ledger"] == []


# --- calibrate ------------------------------------------------------------------------------------


def test_cells_of_the_calibration_equal_the_json(folder: Path) -> None:
    found, book = read(folder / "calibrate.json"), folder / "train.out.xlsx"
    for cell, row in zip(
        rows_of(book, "CalibratedParameters"), found["calibrated_parameters"], strict=True
    ):
        assert cell["Name"] == row["name"]
        assert cell["Change"] == pytest.approx(100.0 * row["change"])
        assert cell["Determined"] == row["determined"]
    for cell, row in zip(rows_of(book, "FrequencyFit"), found["frequency_fit"], strict=True):
        assert cell["Measured"] == pytest.approx(row["measured"])
        assert cell["Used"] == ("yes" if row["used"] else None)
        assert (cell["Note"] or "") == row["note"]
    assert named(book, "calibration_Sentence") == found["sentence"]
    assert found["margin_basis_reason"] in found["sentence"]
    # the other study of the workbook is still there
    assert rows_of(book, "StartMatrix")[0]["Condition"] == "normal start"


def test_an_impossible_measurement_of_the_example_is_told(folder: Path) -> None:
    found = read(folder / "calibrate.json")
    assert [r["used"] for r in found["frequency_fit"]] == [True, True, False]
    assert "no mode can have this frequency" in found["frequency_fit"][2]["note"]
    assert found["margin_basis_justified"] is False


def test_intervals_are_blank_where_nothing_explains_the_measurements(tmp_path: Path) -> None:
    """All stiffnesses change alike, so the ratio of two frequencies is fixed: 3 % off is not ±0.1 %."""
    f = run(read_workbook(template_path("example_proposed.xlsx")).data).modes.elastic_frequency
    source = write(
        tmp_path / "case.json",
        scatter=[{"quantity": "stiffness", "spread": 0.1, "together": "together"}],
        measured_frequencies=[
            {"mode": i + 1, "frequency": float(f[i]) * times, "uncertainty": 1e-3}
            for i, times in enumerate((1.0, 1.0, 1.03))
        ],
    )
    text = said("calibrate", source, "--json", tmp_path / "found.json")
    assert "So no quantity is determined, and no interval is given." in text
    assert "–" in next(x for x in text.splitlines() if x.rstrip().endswith("not determined"))
    found = read(tmp_path / "found.json")
    jsonschema.validate(found, study_schema(CALIBRATION.spec))
    (row,) = found["calibrated_parameters"]
    assert row["determined"] == "not determined"
    assert not {"change_low", "change_high", "posterior_deviation", "reduction"} & {
        key for key, value in row.items() if value is not None
    }
    assert not any(r["known"] for r in found["calibrated_frequencies"])


def test_the_calibrated_case_has_the_calibrated_frequencies(folder: Path, tmp_path: Path) -> None:
    found = read(folder / "calibrate.json")
    results = tmp_path / "results.json"
    said("recalc", folder / "calibrated.json", "--json", results)
    again = [m["frequency"] for m in read(results)["natural_frequencies"] if m["mode"] > 0]
    for row in found["calibrated_frequencies"]:
        assert again[row["calibrated_mode"] - 1] == pytest.approx(row["after"], rel=1e-9)
    book = tmp_path / "calibrated.xlsx"
    said("new", book, "--from", folder / "calibrated.json", "--studies")


def test_margin_basis_becomes_measured_and_the_sentence_says_so(tmp_path: Path) -> None:
    source = write(
        tmp_path / "case.json",
        measured_frequencies=[{"frequency": 29.6}, {"frequency": 53.2}],
    )
    said("calibrate", source, "--case", tmp_path / "new.json")
    found = read(tmp_path / "case.calibrate.json")
    assert found["margin_basis"] == "measured"
    assert "MarginBasis becomes measured" in found["sentence"]
    assert read(tmp_path / "new.json")["margin_basis"] == "measured"
    verdicts = {r["mode"]: r for r in found["calibrated_margins"]}
    assert verdicts[2]["required_before"] == 0.2
    assert verdicts[2]["required"] == 0.1


@pytest.mark.slow
def test_measurements_are_told_in_the_units_that_were_typed(tmp_path: Path) -> None:
    source = write(
        tmp_path / "case.json",
        measured_frequencies=[{"frequency": "1776 cpm"}],
        measured_peaks=[{"element": "HS coupling", "maximum_torque": "15000 lbf*ft"}],
    )
    text = said("calibrate", source)
    assert "1,776 cpm" in text
    assert "1,800 cpm" in text  # mode 1 of the case, 30 Hz
    assert "15,000 lbf ft" in text
    plain = write(tmp_path / "plain.json", measured_frequencies=[{"frequency": 29.6}])
    assert "29.6 Hz" in said("calibrate", plain)


def test_wrong_measurements(tmp_path: Path) -> None:
    source = write(
        tmp_path / "case.json",
        measured_frequencies=[{"mode": 1, "frequency": -30}, {"mode": 1, "frequency": 31}],
        measured_peaks=[{"element": "nothing", "maximum_torque": 1.0}],
    )
    text = said("calibrate", source, code=1)
    assert "table MeasuredFrequencies, row 1, Frequency" in text
    assert "row 2, Mode" in text
    assert "table MeasuredPeaks, row 1, Element" in text
    nothing = write(tmp_path / "nothing.json")
    assert "nothing was measured" in said("calibrate", nothing, code=1)
    assert said("calibrate", source, "--case", source, code=2)


def test_check_tells_wrong_rows_of_both(tmp_path: Path) -> None:
    source = write(
        tmp_path / "case.json",
        measured_frequencies=[{"mode": 99, "frequency": 30}],
        scatter=[{"quantity": "stiffness", "spread": -1}],
    )
    text = said("check", source, code=1)
    assert "MeasuredFrequencies, row 1, Mode" in text
    assert "Scatter, row 1, Spread" in text


def test_a_study_of_near_starts_needs_one_phase(tmp_path: Path) -> None:
    source = tmp_path / "case.json"
    measured = [{"mode": 1, "frequency": 20.0}]
    source.write_text(
        json.dumps(content(measured_frequencies=measured) | {"pulsation_phase": "worst"})
    )
    output = said("calibrate", source, code=1)
    assert "found 'worst'; it must be a number in the study calibrate" in " ".join(output.split())


def test_the_matrix_of_starts_looks_for_the_worst_phase(tmp_path: Path) -> None:
    """Largest peak of the row of all conditions as typed: that of the case."""
    source, target = tmp_path / "case.json", tmp_path / "starts.json"
    conditions = [{"condition": "as typed"}]
    typed = content(start_conditions=conditions) | {"pulsation_phase": "worst"}
    source.write_text(json.dumps(typed))
    said("starts", source, "--json", target)
    (row,) = json.loads(target.read_text())["start_matrix"]
    case = read_workbook(template_path("example_proposed.xlsx")).case()
    worst = run(replace(case, pulsation_phase="worst")).start
    assert worst is not None
    speeds, rated = case.element_speed_ratios, case.rated_torque
    assert rated is not None
    assert row["peak_over_rated"] == pytest.approx(worst.largest_peak(speeds)[1] / rated, rel=1e-6)
