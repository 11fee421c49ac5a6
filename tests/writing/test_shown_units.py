"""What recalculation writes, without a file: results and facts in the units above the columns."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import pytest
from made_up_run import PSI, SOURCE, STAMP, made_up_run
from workbook_checks import type_unit

from addin.contract.tables import find_table
from addin.writing.workbook import tables_to_write
from addin.xlsx import TableData, Workbook, open_workbook

LBF_FT, MPA = 1.3558179483314004, 1e6
#: No two columns of one quantity in the same unit.
UNITS = {
    ("NaturalFrequencies", "Frequency"): "rad/s",
    ("SeparationMargins", "Excitation frequency"): "kHz",
    ("Materials", "UTS"): "ksi",
    ("SteadyState", "Allowable"): "GPa",
    ("StartupPeaks", "Peak-to-peak stress"): "MPa",
    ("StartupPeaks", "Maximum torque"): "pu",
    ("StartCycles", "Amplitude"): "MPa",
    ("TorqueReversals", "Minimum torque"): "lbf*ft",
    ("TorqueReversals", "Transmitted torque"): "kN*m",
}


def retyped() -> Workbook:
    workbook = open_workbook(SOURCE)
    for (table, column), unit in UNITS.items():
        type_unit(workbook, table, column, unit)
    return workbook


@pytest.fixture(scope="module")
def written() -> dict[str, TableData]:
    return {data.name: data for data in tables_to_write(retyped(), made_up_run(), STAMP, ())}


def typed_rated_torque() -> float:
    """What is typed in sheet Case: what 1 pu is worth. [N m]"""
    workbook = open_workbook(SOURCE)
    at = workbook.name("RatedTorque")
    assert at.sheet is not None
    assert at.rect is not None
    part = workbook.sheet_part(at.sheet)
    assert part.constant(at.rect.top, at.rect.left + 1) == "lbf*ft"
    typed = part.constant(at.rect.top, at.rect.left)
    assert isinstance(typed, float)
    return typed * LBF_FT


def rows(data: TableData) -> list[dict[str, Any]]:
    return [dict(zip(data.columns or (), row, strict=True)) for row in data.rows]


def test_facts_say_what_one_shown_unit_is_worth(written: dict[str, TableData]) -> None:
    """Live checks multiply by them, so each has to be that of its own column."""
    facts = {row["Name"]: row["Value"] for row in rows(written["RunFacts"])}
    assert facts["run_HzPerFrequency"] == pytest.approx(0.5 / math.pi, rel=1e-12)
    assert facts["run_HzPerExcitation"] == pytest.approx(1000.0)
    assert facts["run_PaPerUTS"] == pytest.approx(1000.0 * PSI)
    assert facts["run_PaPerAllowable"] == pytest.approx(1e9)
    assert facts["run_NmPerMinimum"] == pytest.approx(LBF_FT)
    assert facts["run_NmPerTransmitted"] == pytest.approx(1000.0)
    assert facts["run_SynchronousSpeed"] == pytest.approx(1800.0)
    assert facts["run_LineFrequency"] == 60.0
    case = made_up_run().case
    (endurance,) = (m.endurance for m in case.materials if m.endurance)
    assert facts["run_Endurance"] == pytest.approx(endurance / MPA)


def test_results_are_in_the_unit_above_their_column(written: dict[str, TableData]) -> None:
    peaks = rows(written["StartupPeaks"])
    assert peaks[0]["Maximum torque"] == pytest.approx(117900.0 / typed_rated_torque())
    assert peaks[-1]["Peak-to-peak stress"] == pytest.approx(29990.0 * PSI / MPA)
    assert peaks[-1]["Percent speed"] == pytest.approx(75.0)
    (_, first, *_) = rows(written["NaturalFrequencies"])
    assert first["Frequency"] == pytest.approx(60.0 * math.pi)


def test_a_table_with_something_below_takes_all_rows_that_fit_and_no_more() -> None:
    run, spec = made_up_run(), find_table("TorqueReversals")
    assert spec is not None
    names = [f"Mesh {k}" for k in range(spec.room + 10)]
    many = [run.tables[spec.name][0] | {"element": name} for name in names]
    workbook = retyped()
    more = replace(run, tables=dict(run.tables) | {spec.name: many})
    (data,) = (d for d in tables_to_write(workbook, more, STAMP, ()) if d.name == spec.name)
    count = len(data.rows)
    assert [row[0] for row in data.rows] == names[:count]
    assert spec.room <= count < len(names)
    assert not workbook.obstacles({spec.name: count})
    assert workbook.obstacles({spec.name: count + 1})
    (note,) = (n for n in workbook.notes if f"Table {spec.name} has room for" in n)
    assert f"{count} of {len(names)} rows" in note
