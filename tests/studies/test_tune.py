"""``torsionbook tune`` by its command line: workbook, JSON, ready cases, and what is wrong with rows."""

from __future__ import annotations

import json
import shutil
import zipfile
from pathlib import Path
from typing import Any

import jsonschema
import openpyxl
import pytest
from typer.testing import CliRunner, Result

from addin.cli.app import app
from addin.contract.studies.tuning import LINES, MAP_ROWS
from addin.reading.case_json import case_to_json
from addin.reading.one_file import Unreadable, read_checked
from addin.reference.json_schemas import SCHEMA_FOLDER, study_schema
from addin.studies.tuning import TUNING
from addin.studies.tuning_tables import map_tables, spread_out
from engine.case.data import CaseData
from engine.case.study_inputs import StudyInputs, TuningRow
from engine.studies.tuning.tuning import TuningResult
from tests.opened import opened, rows_of
from tests.trains import geared
from tests.whole_studies import tune

RUN = CliRunner()
LOW, HIGH = "Low-speed shaft", "High-speed shaft"
ROWS: dict[str, list[dict[str, Any]]] = {
    "tuning": [
        {"element": HIGH, "quantity": "stiffness", "unit": "%", "values": "50; 80; 100"},
        {"element": "Load", "quantity": "inertia", "unit": "kg*m^2", "from": 3, "to": 5, "steps": 3},
    ],
    "catalogue": [
        {"element": LOW, "name": "soft", "stiffness": "2 MN*m/rad", "rated_torque": "9 kN*m"},
    ],
}  # fmt: skip


def told(*words: object) -> Result:
    return RUN.invoke(app, ["tune", *map(str, words), "--jobs", "1"])


def case_json(path: Path, case: CaseData, **tables: Any) -> Path:
    path.write_text(json.dumps(case_to_json(case) | tables), encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A workbook of the small train with rows of both tables, studied."""
    folder = tmp_path_factory.mktemp("tune")
    case_json(folder / "case.json", geared(), **ROWS)
    made = RUN.invoke(
        app,
        ["new", str(folder / "train.xlsx"), "--studies", "--units", "si", "--from", str(folder / "case.json")],
    )  # fmt: skip
    assert made.exit_code == 0, made.output
    done = told(folder / "train.xlsx", "--json", folder, "--cases", folder / "best", "--top", 2)
    assert done.exit_code == 0, done.output
    (folder / "output.txt").write_text(done.output, encoding="utf-8")
    return folder


@pytest.fixture(scope="module")
def content(folder: Path) -> dict[str, Any]:
    return json.loads((folder / "train.tune.json").read_text(encoding="utf-8"))


def test_the_json_keeps_to_its_shipped_schema(content: dict[str, Any]) -> None:
    schema = json.loads((SCHEMA_FOLDER / "tuning.schema.json").read_text(encoding="utf-8"))
    assert schema == study_schema(TUNING.spec), "run: make generated"
    jsonschema.Draft202012Validator(schema).validate(content)
    assert content["study"] == "tuning"
    assert len(content["tuning_results"]) == len(content["choices"]) == 3 * 3 + 1


def test_the_json_is_what_the_engine_finds(content: dict[str, Any], folder: Path) -> None:
    read = read_checked(folder / "case.json")
    assert not isinstance(read, Unreadable)
    assert read.studies is not None
    found = tune(read.case(), read.studies.inputs)
    assert [r["combination"] for r in content["tuning_results"]] == [
        r.combination for r in found.rows
    ]
    assert content["sentence"] == found.sentence
    assert content["study_sha256"] == found.study_digest
    for told_row, row in zip(content["tuning_results"], found.rows, strict=True):
        assert row.tried.answers is not None
        assert told_row["worst_margin"] == pytest.approx(row.tried.answers.worst_margin, rel=1e-9)
    for choice, row in zip(content["choices"], found.rows, strict=True):
        options = row.tried.combination.options
        assert choice["values"] == pytest.approx([o.value for o in options] or [1e5, 4.0, 3e6])


def test_cells_of_the_workbook_equal_the_json_in_the_units_shown(
    content: dict[str, Any], folder: Path
) -> None:
    shown = rows_of(folder / "train.out.xlsx", "TuningResults")
    assert len(shown) == len(content["tuning_results"])
    for cells, row in zip(shown, content["tuning_results"], strict=True):
        assert (cells["Rank"], cells["Combination"]) == (row["rank"], row["combination"])
        assert cells["Reason"] == row["reason"]
        assert cells["As is"] == ("yes" if row["as_is"] else None)
        assert cells["Worst margin"] == pytest.approx(100.0 * row["worst_margin"])
        assert cells["Percent speed"] == pytest.approx(100.0 * row["percent_speed"])
        assert cells["Pulsating torque"] == pytest.approx(row["pulsating_torque"])
        assert cells["Allowable starts"] == "not judged"  # no shaft has a stress diameter
        assert "allowable_starts" not in row
        assert cells["Limits broken"] == row["limits_broken"]
    crossings = rows_of(folder / "train.out.xlsx", "TuningCrossings")
    assert len(crossings) == len(content["tuning_crossings"])
    for cells, row in zip(crossings, content["tuning_crossings"], strict=True):
        assert cells["Frequency"] == pytest.approx(row["frequency"])
        assert cells["Sweep rate"] == pytest.approx(row["sweep_rate"])
    bands = rows_of(folder / "train.out.xlsx", "ForbiddenBands")
    for cells, row in zip(bands, content["forbidden_bands"], strict=True):
        assert [cells["From"], cells["To"]] == pytest.approx([row["from"], row["to"]])


def test_the_rated_torque_of_the_offer_decides(content: dict[str, Any]) -> None:
    """It transmits 10 kN m; the coupling on offer may transmit 9."""
    for row in content["tuning_results"]:
        assert ("Rated torque" in row["broken"]) == (not row["as_is"])


@pytest.mark.slow
def test_maps_and_charts_follow_the_study(folder: Path) -> None:
    path = folder / "train.out.xlsx"
    (axes,) = rows_of(path, "TuningAxes")
    assert axes["First variable"] == f"{HIGH} stiffness, % of the unchanged case"
    assert (
        axes["Second variable"]
        == f"Load inertia; for each pair of values with the best choice of {LOW}"
    )
    assert [axes[f"Line {k}"] for k in (1, 2, 3, 4)] == ["3 kg m²", "4 kg m²", "5 kg m²", "–"]
    starts, margins = rows_of(path, "TuningStarts"), rows_of(path, "TuningMargins")
    assert [row["Of as is"] for row in starts] == pytest.approx([50.0, 80.0, 100.0])
    assert {row["Line 3"] for row in starts} == {"not judged"}
    assert {row["Line 4"] for row in starts} == {None}
    assert [row["Required"] for row in margins] == pytest.approx([20.0] * 3)
    hatch = [
        row["Frequency"] for row in rows_of(path, "TuningHatch") if row["Frequency"] is not None
    ]
    bands = rows_of(path, "ForbiddenBands")
    assert min(hatch) == pytest.approx(bands[0]["From"])
    with zipfile.ZipFile(path) as parts:
        charts = [parts.read(n).decode() for n in parts.namelist() if "charts/chart" in n]
    refs = {name: table_ref(path, name) for name in ("TuningLines", "TuningMargins", "TuningModes")}
    for name, (sheet, first, last) in refs.items():
        wanted = (
            f"{sheet}!$C${first}:$C${last}" if name != "TuningLines" else f"!$B${first}:$B${last}"
        )
        assert any(wanted in chart for chart in charts), (name, wanted)


def table_ref(path: Path, name: str) -> tuple[str, int, int]:
    book = opened(path)
    for sheet in book.worksheets:
        if name in sheet.tables:
            first, last = sheet.tables[name].ref.split(":")
            digits = [int("".join(c for c in cell if c.isdigit())) for cell in (first, last)]
            return f"'{sheet.title}'", digits[0] + 1, digits[1]
    raise AssertionError(name)


def test_the_terminal_lists_the_best_and_the_case_as_it_stands(
    content: dict[str, Any], folder: Path
) -> None:
    output = (folder / "output.txt").read_text(encoding="utf-8")
    for row in content["tuning_results"]:
        listed = row["rank"] <= 2 or row["as_is"]
        assert (f"{row['rank']:>3}  {row['combination']}\n" in output) == listed
    assert content["sentence"] in output
    assert "written: " in output


@pytest.mark.slow
def test_formulas_of_a_workbook_with_studies_keep_their_values(
    folder: Path, tmp_path: Path
) -> None:
    """Its tables have more columns together than the calculator takes."""
    book = tmp_path / "train.xlsx"
    shutil.copyfile(folder / "train.out.xlsx", book)
    done = RUN.invoke(app, ["recalc", str(book), "--in-place"])
    assert done.exit_code == 0, done.output
    assert "without a value" not in done.output
    cells = openpyxl.load_workbook(book, data_only=True)
    assert str(cells["Summary"]["B9"].value).startswith("FAIL: 1 of")
    assert str(cells["Tuning results"]["B4"].value).startswith("10 combinations were tried")


def test_ready_cases_give_what_their_row_says(content: dict[str, Any], folder: Path) -> None:
    best = sorted((folder / "best").iterdir())
    assert len(best) == 2
    for path in best:
        rank = int(path.stem.rpartition("-")[2])
        row = next(r for r in content["tuning_results"] if r["rank"] == rank)
        done = RUN.invoke(app, ["recalc", str(path), "--json", str(path.with_suffix(".out.json"))])
        assert done.exit_code == 0, done.output
        results = json.loads(path.with_suffix(".out.json").read_text(encoding="utf-8"))
        elastic = [r["frequency"] for r in results["natural_frequencies"] if r["mode"]]
        assert [row["mode_1"], row["mode_2"]] == elastic[:2]
        assert row["worst_margin"] == min(r["margin"] for r in results["separation_margins"])
        assert row["combination"] in json.loads(path.read_text(encoding="utf-8"))["title"]


def test_the_inputs_are_not_touched_and_plain_results_stay(folder: Path) -> None:
    before, after = (read_checked(folder / n) for n in ("train.xlsx", "train.out.xlsx"))
    assert not isinstance(before, Unreadable)
    assert not isinstance(after, Unreadable)
    assert after.data == before.data
    assert after.studies is not None
    assert before.studies is not None
    assert after.studies.inputs == before.studies.inputs


@pytest.mark.slow
def test_two_processes_find_the_same(folder: Path, tmp_path: Path) -> None:
    found = []
    for jobs in ("1", "2"):
        out = tmp_path / f"{jobs}.json"
        words = ["tune", str(folder / "case.json"), "--json", str(out), "--jobs", jobs]
        done = RUN.invoke(app, words)
        assert done.exit_code == 0, done.output
        found.append(out.read_bytes())
    assert found[0] == found[1]


# --- what is wrong --------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("rows", "says"),
    [
        ({}, "the tables Tuning and Catalogue are empty"),
        ({"tuning": [{"element": HIGH + "t", "quantity": "stiffness", "values": "1"}]}, f"'{HIGH}'"),
        ({"tuning": [{"element": HIGH, "quantity": "stiffness", "from": 2, "to": 1}]}, "less than From"),
        ({"tuning": [{"element": HIGH, "quantity": "stiffness", "values": "-1"}]}, "must be positive"),
        ({"catalogue": [{"element": LOW, "name": "A"}]}, "Stiffness"),
        (
            {"tuning": [{"element": HIGH, "quantity": "stiffness", "from": 1, "to": 2, "steps": 30000}]},
            "make 30,000 combinations; the limit is 20,000",
        ),
    ],
)  # fmt: skip
def test_wrong_rows_are_told_and_nothing_is_written(
    rows: dict[str, Any], says: str, tmp_path: Path
) -> None:
    done = told(case_json(tmp_path / "case.json", geared(), **rows))
    assert done.exit_code == 1
    assert says in done.output
    assert [p.name for p in tmp_path.iterdir()] == ["case.json"]


@pytest.mark.slow
def test_a_wrong_row_of_a_workbook_is_told_with_its_cell(folder: Path, tmp_path: Path) -> None:
    book = openpyxl.load_workbook(folder / "train.xlsx")
    book["Tuning"]["B8"] = "High speed shaft"
    book.save(tmp_path / "wrong.xlsx")
    done = told(tmp_path / "wrong.xlsx")
    assert done.exit_code == 1
    assert "table Tuning, row 2, Element (cell B8)" in done.output
    assert "a station of table Stations" in done.output


def test_a_workbook_without_the_sheets_says_how_to_get_them(tmp_path: Path) -> None:
    plain = tmp_path / "plain.xlsx"
    assert RUN.invoke(app, ["new", str(plain)]).exit_code == 0
    done = told(plain)
    assert done.exit_code == 1
    assert "Repeat the command with --add" in done.output


# --- maps -----------------------------------------------------------------------------------------


def _study(*rows: TuningRow, **fields: Any) -> TuningResult:
    return tune(geared(**fields), StudyInputs(rows))


def test_more_options_than_there_is_room_for_are_spread_and_told() -> None:
    assert spread_out(5, 9) == [0, 1, 2, 3, 4]
    chosen = spread_out(100, 7)
    assert (chosen[0], chosen[-1], len(set(chosen))) == (0, 99, 7)
    found = _study(
        TuningRow(HIGH, "stiffness", from_=0.5, to=1.5, steps=MAP_ROWS + 2), motor_torque=(), load_torque=()
    )  # fmt: skip
    tables = map_tables(found)
    assert len(tables["TuningStarts"]) == MAP_ROWS
    (axes,) = tables["TuningAxes"]
    assert axes["first_variable"].startswith(
        f"{HIGH} stiffness, % of the unchanged case ({MAP_ROWS} of {MAP_ROWS + 2}"
    )
    assert [axes[f"line_{k}"] for k in range(1, LINES + 1)] == ["all", *["–"] * (LINES - 1)]


def test_hatching_stays_in_its_bands_and_one_value_has_some_width() -> None:
    found = _study(TuningRow(HIGH, "stiffness", values=(1.0,)))
    rows = [row for row in map_tables(found)["TuningHatch"] if row]
    assert max(r["of_as_is"] for r in rows) > min(r["of_as_is"] for r in rows)
    for row in rows:
        assert any(b.from_ <= row["frequency"] <= b.to for b in found.bands)


def test_every_table_of_the_study_is_written() -> None:
    found = _study(TuningRow(HIGH, "stiffness", values=(1.0,)), motor_torque=(), load_torque=())
    written = {"TuningResults", "TuningCrossings", "ForbiddenBands", *map_tables(found)}
    assert written == set(TUNING.spec.result_names)
