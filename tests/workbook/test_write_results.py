"""Results written into a workbook: in the units shown, complete, nothing stale, checks live."""

from __future__ import annotations

import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import openpyxl
import pytest
from hypothesis import given
from hypothesis import strategies as st
from made_up_run import PSI, SOURCE, STAMP, made_up_run
from workbook_checks import (
    assert_caches_agree,
    assert_pages_have_ink,
    rated_torque,
    type_unit,
)

from addin.charts.rows import HISTORY_POINTS, decimate
from addin.contract.chart_tables import CHART_TABLES
from addin.contract.sheets import FOOT_ROW
from addin.writing.workbook import write_results
from addin.xlsx import SaveReport, open_workbook
from tests.opened import opened, rows_of


def with_unit(tmp_path: Path, table: str, column: str, unit: str) -> Path:
    """A copy of the example with another unit above one column."""
    source = tmp_path / "retyped.xlsx"
    workbook = open_workbook(SOURCE)
    type_unit(workbook, table, column, unit)
    workbook.save(source)
    return source


@pytest.mark.slow
def test_results_stand_in_the_units_shown(written: Path) -> None:
    peak = rows_of(written, "StartupPeaks")
    shaft = peak[-1]
    assert shaft["Element"] == "HP compressor shaft"
    assert shaft["Peak-to-peak stress"] == pytest.approx(29990.0)
    assert peak[0]["Maximum torque"] == pytest.approx(117900.0 / 1.3558179483314004)
    assert shaft["Percent speed"] == pytest.approx(75.0)
    modes = rows_of(written, "NaturalFrequencies")
    assert [row["Mode"] for row in modes[:3]] == [0, 1, 2]
    assert modes[1]["CPM"] == pytest.approx(1800.0)
    assert rows_of(written, "ModeShapes")[0]["Mode 9"] is None
    assert rows_of(written, "AllowableStarts")[1]["Allowable starts"] == "unlimited"
    verdicts = {row["Check"]: row for row in rows_of(written, "Verdicts")}
    assert verdicts["Steady-state stress"]["Limit"] == "4,400 psi"
    assert verdicts["Separation margin, mode 2"]["Result"] == "11.67 %"


@pytest.mark.slow
def test_a_result_unit_the_engineer_retyped_is_honoured(tmp_path: Path) -> None:
    source = with_unit(tmp_path, "StartupPeaks", "Peak-to-peak stress", "MPa")
    write_results(source, tmp_path / "out.xlsx", made_up_run(), STAMP)
    stress = rows_of(tmp_path / "out.xlsx", "StartupPeaks")[-1]["Peak-to-peak stress"]
    assert stress == pytest.approx(29990.0 * PSI / 1e6)


@pytest.mark.slow
def test_torque_in_per_unit_is_of_the_rated_torque(tmp_path: Path) -> None:
    source = with_unit(tmp_path, "StartupPeaks", "Maximum torque", "pu")
    write_results(source, tmp_path / "out.xlsx", made_up_run(), STAMP)
    torque = rows_of(tmp_path / "out.xlsx", "StartupPeaks")[0]["Maximum torque"]
    assert torque == pytest.approx(117900.0 / rated_torque(source))


def test_an_unreadable_result_unit_is_named_and_si_is_shown(retyped: SaveReport) -> None:
    assert any("StartupPeaks" in note and "Time" in note for note in retyped.notes)
    assert rows_of(retyped.path, "StartupPeaks")[0]["Time"] == pytest.approx(5.1)


@pytest.mark.slow
def test_live_checks_equal_the_engines_numbers(written: Path) -> None:
    for row in rows_of(written, "NaturalFrequencies"):
        engine, check = row["Percent speed"], row["Percent speed check"]
        assert (check or None) == (pytest.approx(engine, rel=1e-9) if engine else None)
    for row in rows_of(written, "SeparationMargins"):
        assert row["Margin check"] == pytest.approx(row["Margin"], rel=1e-9, abs=1e-9)
    for row in rows_of(written, "SteadyState"):
        engine, check = row["Allowable"], row["UTS/25 check"]
        assert (check or None) == (pytest.approx(engine, rel=1e-9) if engine else None)
    first = rows_of(written, "AllowableStarts")[0]
    assert first["Starts check"] == pytest.approx(first["Allowable starts"], rel=1e-9)


@pytest.mark.slow
def test_the_summary_says_which_inputs_the_results_belong_to(written: Path) -> None:
    sheet = opened(written)["Summary"]
    words = " ".join(str(c.value) for row in sheet.iter_rows(1, FOOT_ROW) for c in row if c.value)
    assert STAMP.sha256 in words
    assert STAMP.sentence in words
    assert "2026-11-21 07:30" in words
    assert "FAIL: 3 of 7 checks" in words


@pytest.mark.slow
def test_fewer_results_leave_nothing_of_the_older_ones(written: Path, tmp_path: Path) -> None:
    run = made_up_run()
    smaller = {name: list(rows)[:2] for name, rows in run.tables.items()}
    small = replace(
        run, tables=smaller, histories={}, speed_time=None, interference=None, cycles=()
    )
    again = write_results(written, tmp_path / "again.xlsx", small, STAMP).path
    once = tmp_path / "once.xlsx"
    write_results(SOURCE, once, small, STAMP)
    book, other = (opened(path) for path in (again, once))
    for sheet in book.worksheets:
        for row in sheet.iter_rows():
            for cell in row:
                expected = other[sheet.title][cell.coordinate].value
                assert (cell.value or "") == (expected or ""), (sheet.title, cell.coordinate)


def test_writing_twice_gives_the_same_bytes(written: Path, tmp_path: Path) -> None:
    target = tmp_path / "second.xlsx"
    write_results(SOURCE, target, made_up_run(), STAMP)
    assert target.read_bytes() == written.read_bytes()


def test_the_chosen_element_is_drawn(retyped: SaveReport) -> None:
    labels = {row["Key"]: row["Text"] for row in rows_of(retyped.path, "ChartLabels")}
    assert labels["History title 1"] == "Mesh: tangential tooth load"
    assert labels["History title 2"] == "Pinion shaft: nominal shear stress"
    assert labels["History title 3"] == "HP compressor shaft: nominal shear stress"


def test_charts_follow_their_data(written: Path) -> None:
    rows = len(rows_of(written, "ChartHistory"))
    workbook = open_workbook(written, read_only=True)
    for part in workbook.structure.chart_parts():
        data = workbook.container.read(part).decode()
        if "History title" in data or "Mesh: tangential" in data:
            assert f"${5 + rows - 1}</c:f>" in data
            break
    else:
        raise AssertionError("no history chart found")


@pytest.mark.slow
def test_chart_data_are_never_longer_than_their_limit(written: Path) -> None:
    for table in CHART_TABLES:
        assert len(rows_of(written, table.name)) <= HISTORY_POINTS


@pytest.mark.slow
def test_tables_the_engineer_removed_are_named_not_missed(tmp_path: Path) -> None:
    book = openpyxl.load_workbook(SOURCE)
    del book["ChartData"]
    del book["Results"]
    source = tmp_path / "fewer.xlsx"
    book.save(source)
    report = write_results(source, tmp_path / "out.xlsx", made_up_run(), STAMP)
    missing = " ".join(report.notes)
    assert "SteadyState" in missing
    assert "ChartHistory" in missing
    assert rows_of(tmp_path / "out.xlsx", "StartupPeaks")[0]["Element"] == "Motor shaft"


@pytest.mark.slow
def test_more_crossings_than_there_is_room_for_are_cut_and_named(tmp_path: Path) -> None:
    run = made_up_run()
    many = [dict(run.tables["StartupCrossings"][0], mode=k) for k in range(1, 16)]
    run = replace(run, tables=dict(run.tables) | {"StartupCrossings": many})
    report = write_results(SOURCE, tmp_path / "out.xlsx", run, STAMP)
    shown = rows_of(tmp_path / "out.xlsx", "StartupCrossings")
    assert 8 <= len(shown) < 15
    assert any("StartupCrossings" in note and "15 rows" in note for note in report.notes)


def test_the_source_stays_as_it_is(tmp_path: Path) -> None:
    source = Path(shutil.copyfile(SOURCE, tmp_path / "train.xlsx"))
    before = source.read_bytes()
    write_results(source, tmp_path / "out.xlsx", made_up_run(), STAMP)
    assert source.read_bytes() == before
    write_results(source, None, made_up_run(), STAMP, in_place=True)
    assert (tmp_path / "train.xlsx.bak").read_bytes() == before


@given(st.integers(0, 2**32 - 1), st.integers(10, 4000), st.sampled_from([60, 200, 801]))
def test_decimation_keeps_the_extremes(seed: int, n: int, limit: int) -> None:
    random = np.random.default_rng(seed)
    time = np.cumsum(random.uniform(0.1, 1.0, n))
    value = np.cumsum(random.normal(size=n)) + 3.0 * np.sin(time)
    keep = decimate(time, value, limit)
    assert keep.size <= max(limit, 1)
    assert np.all(np.diff(keep) > 0)
    assert {0, n - 1} <= set(keep.tolist())
    assert value[keep].max() == value.max()
    assert value[keep].min() == value.min()


def test_decimation_of_cycles_all_alike() -> None:
    value = np.tile([0.0, 1.0, 0.0, -1.0], 3000)
    keep = decimate(np.arange(value.size, dtype=float), value)
    assert keep.size <= HISTORY_POINTS
    assert (value[keep].min(), value[keep].max()) == (-1.0, 1.0)


@pytest.mark.slow
def test_a_spreadsheet_program_agrees_with_every_live_formula(soffice, written: Path) -> None:
    assert assert_caches_agree(written, soffice) > 200


@pytest.mark.slow
def test_every_page_of_the_results_has_ink(soffice, written: Path) -> None:
    assert_pages_have_ink(written, soffice, at_least=10)
