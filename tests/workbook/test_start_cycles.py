"""The cycles behind the allowable starts: their sum is the damage, with and without damage."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from made_up_run import SOURCE, STAMP, made_up_run

from addin.charts.data import chart_blocks
from addin.charts.start_cycles import LISTED_CYCLES, start_cycle_facts, start_cycle_rows
from addin.contract.shown_units import shown_units
from addin.writing.workbook import write_results
from addin.xlsx import open_workbook
from engine.fatigue.damage import miner_damage
from engine.fatigue.sn_curve import sn_curve_for
from tests.opened import opened, rows_of

SHAFT = "HP compressor shaft"


def undamaged():
    empty = (SHAFT, np.empty(0), np.empty(0))
    return replace(made_up_run(), cycles=(empty,), amplitudes={SHAFT: (5.0e7, 1.3e8)})


def test_the_listed_cycles_add_up_to_the_damage_of_a_start() -> None:
    run = made_up_run()
    rows = start_cycle_rows(run)
    assert 1 <= len(rows) <= LISTED_CYCLES
    material = next(e.material for e in run.case.elements if e.element == SHAFT)
    curve = sn_curve_for(
        next(m for m in run.case.materials if m.material == material),
        [p for p in run.case.sn_points if p.material == material],
    )
    _, amplitude, count = run.cycles[0]
    whole = miner_damage(amplitude, count, curve)
    assert sum(row["damage"] for row in rows) == pytest.approx(whole, rel=1e-12)
    assert start_cycle_facts(run)["shaft"] == SHAFT


def test_a_start_without_damage_shows_its_largest_amplitude() -> None:
    run = undamaged()
    (row,) = start_cycle_rows(run)
    assert (row["amplitude"], row["damage"]) == (5.0e7, 0.0)
    units, _ = shown_units({}, None)
    blocks = chart_blocks(run.case, units, run)
    drawn = [line[2:4] for line in blocks["ChartSN"] if line[3] is not None]
    assert drawn == [[0.1, 5.0e7], [1.0, 5.0e7]]
    labels = dict(blocks["ChartLabels"])
    assert "38 % of endurance" in str(labels["One start"])


def test_only_the_line_of_the_governing_shaft_is_drawn() -> None:
    run = made_up_run()
    case = run.case
    other = replace(case.materials[0], material="Other steel")
    points = tuple(replace(p, material="Other steel") for p in case.sn_points)
    more = replace(case, materials=(*case.materials, other), sn_points=(*case.sn_points, *points))
    units, _ = shown_units({}, None)
    one = chart_blocks(case, units, run)["ChartSN"]
    assert chart_blocks(more, units, replace(run, case=more))["ChartSN"] == one


@pytest.mark.slow
def test_the_sum_stands_on_the_sheet(tmp_path: Path) -> None:
    run = made_up_run()
    # without notches Kf is the SCF that is typed; two shafts with two values, so that a wrong row shows
    typed = {row["Element"]: row["SCF"] for row in rows_of(SOURCE, "Elements")}
    assert typed[SHAFT] != typed["Motor shaft"]
    limits = [{"element": name, "kf": float(typed[name])} for name in ("Motor shaft", SHAFT)]
    run = replace(run, tables=dict(run.tables) | {"FatigueLimits": limits})
    path = write_results(SOURCE, tmp_path / "out.xlsx", run, STAMP).path
    sheet = opened(path)["Fatigue"]
    # found by what it is called: three cells for the label, then the number
    (first,) = (c for row in sheet.iter_rows() for c in row if c.value == "Governing shaft")
    area = sheet.iter_rows(
        first.row, first.row + 11, first.column, first.column + 3, values_only=True
    )
    shown = {row[0]: row[3] for row in area if row[0]}
    whole = sum(row["damage"] for row in start_cycle_rows(made_up_run()))
    assert shown["Governing shaft"] == SHAFT
    assert shown["Kf, or SCF"] == pytest.approx(typed[SHAFT])
    assert shown["Sum of n / N = damage q"] == pytest.approx(whole, rel=1e-9)
    assert shown["1 / sum = allowable starts"] == pytest.approx(1.0 / whole, rel=1e-9)
    table = open_workbook(path, read_only=True).table("StartCycles")
    assert table.data.height == len(start_cycle_rows(made_up_run()))


@pytest.mark.slow
def test_whole_starts_are_never_rounded_up(tmp_path: Path) -> None:
    run = made_up_run()
    verdicts = [dict(row) for row in run.tables["Verdicts"]]
    for row in verdicts:
        if row["check"] == "Allowable starts":
            row |= {"result": 436.97, "dimension": "count"}
    run = replace(run, tables=dict(run.tables) | {"Verdicts": verdicts})
    path = write_results(SOURCE, tmp_path / "out.xlsx", run, STAMP).path
    book = opened(path)
    shown = {row[0]: row[1] for row in book["Summary"].iter_rows(28, 39, 2, 3, values_only=True)}
    assert shown["Allowable starts"] == 436.0
