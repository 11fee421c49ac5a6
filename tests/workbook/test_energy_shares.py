"""Sheet Results: how each frequency follows stiffnesses and inertias, as live formulas."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import openpyxl
import pytest
from made_up_run import SOURCE, STAMP
from workbook_checks import assert_caches_agree

from addin.calculation.calculation import Calculation, calculate
from addin.contract.sheets import SHEETS
from addin.reading.workbook import read_workbook
from addin.template import build as template
from addin.writing.workbook import write_results
from addin.xlsx import open_workbook
from engine.case.case import Case
from engine.run import at_speed
from tests.opened import rows_of


@pytest.fixture(scope="module")
def run() -> Calculation:
    return calculate(read_workbook(SOURCE).case())


def shares(path: Path) -> list[dict[str, Any]]:
    return rows_of(path, "EnergyShares")


def elastic(case: Case) -> list[float]:
    return [f for f in at_speed(case).modes.frequency.tolist() if f > 1e-6]


def changed(case: Case, quantity: str, name: str, factor: float) -> Case:
    if quantity == "stiffness":
        rows = tuple(
            replace(e, stiffness=e.stiffness * factor) if e.element == name else e
            for e in case.elements
        )
        return replace(case, elements=rows)
    rows = tuple(
        replace(s, inertia=s.inertia * factor) if s.station == name else s for s in case.stations
    )
    return replace(case, stations=rows)


def test_live_shifts_are_those_of_trains_that_are_changed(run: Calculation, examples: Path) -> None:
    """An independent way: the frequencies calculated again at ± half the change."""
    rows = shares(examples / "proposed.xlsx")
    assert len(rows) == 10 + 11  # nine shafts and couplings with the mesh, eleven stations
    for name in ("HS coupling", "Intermediate coupling"):
        assert name in [row["Of"] for row in rows if row["Quantity"] == "stiffness"]
    for mode in range(1, 6):
        assert sum(row[f"Share {mode}"] for row in rows[:10]) == pytest.approx(1.0, abs=1e-9)
    for quantity, name in (("stiffness", "HS coupling"), ("inertia", "HP comp")):
        row = next(r for r in rows if (r["Quantity"], r["Of"]) == (quantity, name))
        above = elastic(changed(run.case, quantity, name, 1.005))
        below = elastic(changed(run.case, quantity, name, 0.995))
        for mode in range(1, 6):
            shift = above[mode - 1] - below[mode - 1]
            assert row[f"Shift {mode}"] == pytest.approx(shift, rel=2e-4, abs=1e-7), (name, mode)


@pytest.mark.slow
def test_shifts_follow_the_change_and_stay_in_hertz(
    run: Calculation, tmp_path: Path, soffice: Any
) -> None:
    source, out = tmp_path / "source.xlsx", tmp_path / "out.xlsx"
    workbook = open_workbook(SOURCE)
    place = workbook.table("NaturalFrequencies")
    unit = f"{openpyxl.utils.get_column_letter(place.ref.left + 1)}{place.ref.top - 1}"
    workbook.set_cell(place.sheet, unit, "cpm")
    workbook.set_name("SensitivityChange", 0.02)
    workbook.save(source)
    write_results(SOURCE, tmp_path / "as_shipped.xlsx", run.view, STAMP)
    write_results(source, out, run.view, STAMP)
    for one, two in zip(shares(tmp_path / "as_shipped.xlsx"), shares(out), strict=True):
        assert two["Shift 1"] == pytest.approx(2.0 * one["Shift 1"], rel=1e-12)
    assert_caches_agree(out, soffice)


def test_a_workbook_of_an_earlier_version_is_recalculated_without_a_word(
    run: Calculation, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    sheets = tuple(
        replace(s, tables={k: v for k, v in s.tables.items() if k != "EnergyShares"})
        for s in SHEETS
    )
    monkeypatch.setattr(template, "SHEETS", sheets)
    monkeypatch.setattr(template._Builder, "_change_cell", lambda self: None)
    old = template.build_template(tmp_path / "old.xlsx", "us", "proposed")
    report = write_results(old, tmp_path / "out.xlsx", run.view, STAMP)
    assert not report.notes
    assert "EnergyShares" not in open_workbook(tmp_path / "out.xlsx").tables
