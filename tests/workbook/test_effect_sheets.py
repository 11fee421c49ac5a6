"""Sheets Start, Effects and Accuracy: what stands there, in which units, and nothing beside."""

from __future__ import annotations

import zipfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import openpyxl
import pytest
from made_up_run import PLANS, SOURCE, STAMP, made_up_run

from addin.charts.data import accuracy_block
from addin.contract.sheets import part_named
from addin.contract.tables import table
from addin.contract.texts import NO_STUDY
from addin.writing.workbook import ANALYSES, write_results, write_study
from addin.xlsx import SaveReport, open_workbook
from tests.opened import opened, rows_of

LBF, LBF_FT, INCH = 4.4482216152605, 1.3558179483314, 0.0254


def test_reversals_stand_in_the_units_shown_with_their_live_check(written: Path) -> None:
    mesh, coupling = rows_of(written, "TorqueReversals")
    assert mesh["Minimum torque"] == pytest.approx(-51900.0 / LBF_FT)
    assert mesh["Tooth force"] == pytest.approx(281000.0 / LBF)
    assert mesh["Recontact speed"] == pytest.approx(0.0924 / INCH)
    assert (mesh["Reversals"], mesh["Impacts"], mesh["Model"]) == (15, 28, "clearance")
    assert mesh["Margin"] == pytest.approx(-100.0 * 51900.0 / 14600.0)
    assert (coupling["Impacts"], coupling["Tooth force"], coupling["First time"]) == (None,) * 3
    for row in (mesh, coupling):
        assert row["Margin check"] == pytest.approx(row["Margin"], rel=1e-12)


def test_the_live_margin_follows_retyped_units(retyped: SaveReport) -> None:
    mesh = rows_of(retyped.path, "TorqueReversals")[0]
    assert mesh["Transmitted torque"] == pytest.approx(14.6)
    assert mesh["Margin check"] == pytest.approx(mesh["Margin"], rel=1e-12)


@pytest.mark.slow
def test_effects_say_on_or_off_with_number_bound_and_reason(written: Path) -> None:
    rows = {row["Effect"]: row for row in rows_of(written, "Effects")}
    assert [row["On"] for row in rows.values()] == ["on", "off"] * 6
    assert rows["backlash"]["Choice"] == "on"
    assert rows["bearings"]["Deciding number"] == pytest.approx(-0.889)
    assert rows["bearings"]["Bound"] is None
    assert rows["motor transient"]["Bound"] == 0
    assert rows["coupled damping"]["Bound"] == pytest.approx(0.024)
    assert rows["coupled damping"]["Time"] == pytest.approx(4.2)
    assert "decided by the number beside" in rows["run length"]["Why"]
    plans = rows_of(written, "Plans")
    assert [(p["Plan"], p["Reason"]) for p in plans] == [(p["number"], p["reason"]) for p in PLANS]


def test_bearing_forces_stand_beside_the_reversals(written: Path) -> None:
    bull, pinion = rows_of(written, "BearingForces")
    assert (bull["Station"], pinion["Station"]) == ("Bull gear", "Pinion")
    assert bull["Force"] == pytest.approx(312e3 / LBF)


@pytest.mark.slow
def test_the_chart_shows_the_worst_element_around_its_least_torque(written: Path) -> None:
    run = made_up_run()
    time, torque = run.histories["Mesh"]
    deepest = float(time[torque.argmin()])
    drawn = [row for row in rows_of(written, "ChartReversal") if row["Time"] is not None]
    assert min(row["Torque"] for row in drawn) == pytest.approx(torque.min() / LBF_FT, rel=1e-5)
    assert drawn[0]["Time"] < deepest < drawn[-1]["Time"]
    assert drawn[-1]["Time"] - drawn[0]["Time"] <= 2.0 * 8.0 / 30.2 + 1e-3
    labels = {row["Key"]: row["Text"] for row in rows_of(written, "ChartLabels")}
    assert labels["Reversal title"].startswith("Mesh: ")


def labels_of(path: Path) -> dict[str, str]:
    """Words that charts show."""
    return {row["Key"]: row["Text"] for row in rows_of(path, "ChartLabels")}


@pytest.mark.slow
def test_the_blow_is_drawn_closely_with_the_forces_of_the_same_moment(written: Path) -> None:
    run = made_up_run()
    time, torque = run.histories["Mesh"]
    deepest = float(time[torque.argmin()])
    near = [row for row in rows_of(written, "ChartBlow") if row["Time"] is not None]
    assert near[-1]["Time"] - near[0]["Time"] <= 2.0 * 1.2 / 30.2 + 1e-3
    assert near[0]["Time"] < deepest < near[-1]["Time"]
    assert min(row["Torque"] for row in near) == pytest.approx(torque.min() / LBF_FT, rel=1e-5)
    forces = rows_of(written, "ChartForces")
    inside = (time >= near[0]["Time"]) & (time <= near[-1]["Time"])
    for number, history in enumerate((run.forces.tooth_force[0], *run.forces.bearing_force), 1):
        drawn = [row[f"Force {number}"] for row in forces if row[f"Force {number}"] is not None]
        assert max(drawn) == pytest.approx(history[inside].max() / LBF, rel=1e-5)
        assert min(drawn) == pytest.approx(history[inside].min() / LBF, rel=1e-5)
    labels = labels_of(written)
    assert "strike the back flank" in labels["Blow title"]
    assert [labels[f"Force {k}"].split(":")[0] for k in (1, 2, 3)] == [
        "Mesh",
        "Bull gear",
        "Pinion",
    ]
    assert labels["Force axis"] == "Force [lbf]"


@pytest.mark.slow
def test_load_angle_and_slip_are_drawn_from_field_application_on(written: Path) -> None:
    rows = [row for row in rows_of(written, "ChartPullIn") if row["Angle time"] is not None]
    assert 7.0 < rows[0]["Angle time"] < 7.93
    assert rows[-1]["Load angle"] == pytest.approx(np.degrees(0.423), rel=1e-5)
    assert rows[0]["Slip"] == pytest.approx(3.0)
    events = rows_of(written, "ChartEvents")
    assert events[0]["Time"] == pytest.approx(7.93)
    labels = labels_of(written)
    assert labels["Event 1"] == "Field on at 3.0% slip"
    assert "pulls into step" in labels["Pull-in title"]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("change", "key", "words"),
    [
        ({"load_angle": None}, "Pull-in title", "no field is applied"),
        ({"forces": None}, "Force title", "no forces shown: no mesh with clearance"),
        ({"histories": {}}, "Blow title", "no start was calculated"),
    ],
)
def test_a_chart_without_lines_says_why(
    change: dict[str, object], key: str, words: str, tmp_path: Path
) -> None:
    run = replace(made_up_run(), **change)
    write_results(SOURCE, tmp_path / "out.xlsx", run, STAMP)
    assert words in labels_of(tmp_path / "out.xlsx")[key]


@pytest.mark.slow
def test_a_trip_is_marked_where_the_speed_is_highest(tmp_path: Path) -> None:
    run = made_up_run()
    time, speed = run.speed_time
    falling = np.minimum(speed, 2.0 * speed[20000] - speed)
    startup = {"outcome": "tripped", "time": 8.0, "end_speed": 1.0, "sentence": "Tripped."}
    run = replace(run, startup=startup, speed_time=(time, falling))
    write_results(SOURCE, tmp_path / "out.xlsx", run, STAMP)
    assert rows_of(tmp_path / "out.xlsx", "ChartEvents")[0]["Time"] == pytest.approx(time[20000])
    assert labels_of(tmp_path / "out.xlsx")["Event 1"] == "Trip"


@pytest.mark.slow
def test_empty_tables_are_explained(written: Path, tmp_path: Path) -> None:
    run = made_up_run()
    empty = dict(run.tables) | {
        "TorqueReversals": [],
        "AllowableStarts": [],
        "StartupCrossings": [],
    }
    write_results(SOURCE, tmp_path / "out.xlsx", replace(run, tables=empty), STAMP)
    bare = opened(tmp_path / "out.xlsx")
    assert "no gear mesh" in line(bare, "Reversals")
    assert "No shaft is judged" in line(bare, "Fatigue")
    assert "No crossings" in line(bare, "Start-up")
    full = opened(written)
    assert [line(full, name) for name in ("Reversals", "Fatigue")] == ["", ""]


def line(book: openpyxl.Workbook, name: str, row: int = 4) -> str:
    """What a line above the tables of a part of a sheet says."""
    part = part_named(name)
    return book[part.worksheet][part.at(f"B{row}")].value or ""


def test_no_number_format_drops_the_sign_of_a_torque() -> None:
    # LibreOffice shows a negative number without its sign in a section that is not the first
    for name, column in (
        ("StartupPeaks", "Minimum torque"),
        ("StartupPeaks", "Maximum torque"),
        ("StartupCrossings", "Mesh minimum torque"),
        ("TuningResults", "Mesh minimum torque"),
        ("StartMatrix", "Mesh minimum torque"),
    ):
        assert table(name).column(column).format.startswith("[<1000]")


@pytest.mark.slow
def test_reversals_beyond_their_room_are_named_and_cut(tmp_path: Path) -> None:
    run = made_up_run()
    many = [dict(run.tables["TorqueReversals"][0], element=f"mesh {k}") for k in range(20)]
    run = replace(run, tables=dict(run.tables) | {"TorqueReversals": many})
    report = write_results(SOURCE, tmp_path / "out.xlsx", run, STAMP)
    shown = len(rows_of(tmp_path / "out.xlsx", "TorqueReversals"))
    assert table("TorqueReversals").room <= shown <= table("TorqueReversals").room + 1
    assert any("TorqueReversals" in note and "20 rows" in note for note in report.notes)
    assert len(rows_of(tmp_path / "out.xlsx", "BearingForces")) == 2


@pytest.mark.slow
def test_the_start_says_how_it_ended(written: Path) -> None:
    assert line(opened(written), "Start-up") == made_up_run().startup["sentence"]


# --- the accuracy study ---------------------------------------------------------------------------

WORDS = {"sentence": "You asked for 1 %: 14 ms.", "reference": "A hundred times finer."}
STUDY = [
    {"method": "exponential", "setting": "step 0.002 s", "error_peak": 1e-3, "error_starts": 1e-2,
     "time": 0.004},
    {"method": "exponential", "setting": "step 0.001 s", "error_peak": 1e-5, "error_starts": None,
     "time": 0.008},
    {"method": "newmark (linear train)", "setting": "step 0.001 s", "error_peak": 2e-3,
     "error_starts": 0.0, "time": 0.02},
]  # fmt: skip


@pytest.mark.slow
def test_without_a_study_the_sheet_says_how_to_make_one(written: Path) -> None:
    assert line(opened(written), "Accuracy", 4) == NO_STUDY
    assert "torsionbook accuracy" in NO_STUDY


@pytest.mark.slow
def test_a_study_changes_nothing_but_its_own_cells(written: Path, tmp_path: Path) -> None:
    target = tmp_path / "study.xlsx"
    workbook = open_workbook(written, read_only=True)
    write_study(workbook, target, STUDY, WORDS, STAMP, 58400.0)
    rows = rows_of(target, "AccuracyCost")
    assert [row["Error peak"] for row in rows] == pytest.approx([0.1, 0.001, 0.2])
    assert [row["Time"] for row in rows] == pytest.approx([4.0, 8.0, 20.0])
    book = opened(target)
    assert [line(book, "Accuracy", k) for k in (4, 5)] == [WORDS["sentence"], WORDS["reference"]]
    assert STAMP.sha256[:12] in line(book, "Accuracy", 6)
    changed = different_parts(written, target)
    names = openpyxl.load_workbook(written).sheetnames
    own = {
        f"xl/worksheets/sheet{names.index(n) + 1}.xml"
        for n in ("Effects and accuracy", "Lists", "ChartData")
    }
    sheets = {part for part in changed if part.startswith("xl/worksheets/sheet")}
    assert sheets == own
    others = changed - sheets - {"xl/workbook.xml"}  # the study is printed
    assert {part.split("/")[1] for part in others} <= {"charts", "tables"}, others
    assert len([part for part in others if part.startswith("xl/charts/")]) == 1


def accuracy_chart(path: Path) -> str:
    """The chart of sheet Effects and accuracy, with the words it keeps of its title."""
    with zipfile.ZipFile(path) as archive:
        charts = [archive.read(n).decode() for n in archive.namelist() if "charts/chart" in n]
    (chart,) = [text for text in charts if "Processor time" in text]
    return chart


@pytest.mark.slow
def test_the_chart_says_that_there_is_no_study_yet(tmp_path: Path) -> None:
    run = made_up_run()
    plain = [{"method": "start", "setting": "", "error_peak": 1e-3, "time": 0.004}]
    calculated, studied = tmp_path / "calculated.xlsx", tmp_path / "study.xlsx"
    run = replace(run, tables={**run.tables, "AccuracyCost": plain})
    write_results(SOURCE, calculated, run, STAMP)
    for path in (SOURCE, calculated):
        assert labels_of(path)["Accuracy title"].endswith("run torsionbook accuracy FILE")
        assert "no study yet" in accuracy_chart(path)
    write_study(open_workbook(calculated, read_only=True), studied, STUDY, WORDS, STAMP, 58400.0)
    assert labels_of(studied)["Accuracy title"].endswith("as measured in this study")
    assert "as measured in this study" in accuracy_chart(studied)
    again = write_results(studied, tmp_path / "again.xlsx", run, STAMP).path
    assert "no study yet" in accuracy_chart(again)


@pytest.mark.slow
def test_a_study_without_rows_says_that_there_was_nothing_to_study(
    written: Path, tmp_path: Path
) -> None:
    target = tmp_path / "study.xlsx"
    write_study(open_workbook(written, read_only=True), target, [], WORDS, STAMP, 58400.0)
    assert "nothing to study" in labels_of(target)["Accuracy title"]


@pytest.mark.slow
def test_the_slip_frequency_of_the_pulsation_is_headed_as_twice_the_slip(written: Path) -> None:
    mesh = rows_of(written, "TorqueReversals")[0]
    (of_run,) = [r for r in made_up_run().tables["TorqueReversals"] if r["element"] == "Mesh"]
    assert mesh["2 × slip frequency"] == pytest.approx(of_run["slip_frequency"])
    assert "Slip frequency" not in mesh


def different_parts(one: Path, other: Path) -> set[str]:
    """Parts of two packages that differ."""
    with zipfile.ZipFile(one) as a, zipfile.ZipFile(other) as b:
        assert set(a.namelist()) == set(b.namelist())
        return {name for name in a.namelist() if a.read(name) != b.read(name)}


@pytest.mark.slow
def test_a_recalculation_after_a_study_leaves_nothing_of_it(written: Path, tmp_path: Path) -> None:
    target = tmp_path / "study.xlsx"
    write_study(open_workbook(written, read_only=True), target, STUDY, WORDS, STAMP, 58400.0)
    again = write_results(target, tmp_path / "again.xlsx", made_up_run(), STAMP).path
    assert rows_of(again, "AccuracyCost") == rows_of(written, "AccuracyCost")
    book = opened(again)
    assert [line(book, "Accuracy", row) for row in (4, 5)] == [NO_STUDY, ANALYSES]


def test_the_chart_draws_methods_apart_and_no_error_of_zero() -> None:
    linear = "newmark (linear train)"
    assert accuracy_block(STUDY) == [
        ["exponential: peak torques", 4.0, 0.1, "exponential: allowable starts", 4.0, 1.0,
         f"{linear}: peak torques", 20.0, 0.2, f"{linear}: allowable starts", None, None,
         *(cell for method in ("chosen", "alternative") for answer in ("peak torques", "allowable starts")
           for cell in (f"{method}: {answer}", None, None))],
        [None, 8.0, 0.001, *[None] * 21],
    ]  # fmt: skip
    (names,) = accuracy_block([])
    assert names[0] == "exponential: peak torques"
    assert names[1:3] == [None, None]
