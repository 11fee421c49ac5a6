"""One workbook with four small studies: cells, JSON, cells of formulas, report, diff and verify agree."""

from __future__ import annotations

import json
import shutil
from pathlib import Path
from typing import Any

import docx
import pytest

from addin.contract.tables import json_key
from addin.diff.compare import compare_files
from addin.report.make import report
from addin.studies.registry import study_of_command
from addin.verify.file import verify_file
from addin.xlsx import open_workbook
from addin.xlsx.references import cell_name
from tests.opened import opened


@pytest.fixture(scope="module")
def folder(studied: Path) -> Path:
    """train.xlsx with results and all studies, and NAME.json of each study. SI units."""
    return studied.parent


@pytest.fixture(scope="module")
def cells(folder: Path) -> dict[str, list[dict[str, Any]]]:
    """Every table of the workbook as another program reads it."""
    found = {}
    for sheet in opened(folder / "train.xlsx"):
        for name in sheet.tables:
            head, *rows = [[c.value for c in row] for row in sheet[sheet.tables[name].ref]]
            found[name] = [dict(zip(head, row, strict=True)) for row in rows]
    return found


def content(folder: Path, study: str) -> dict[str, Any]:
    return dict(json.loads((folder / f"{study}.json").read_text(encoding="utf-8")))


@pytest.mark.parametrize(
    ("study", "table", "columns"),
    [
        ("tune", "TuningResults", {"Rank": 1.0, "Worst margin": 100.0, "Pulsating torque": 1.0}),
        ("tolerances", "ToleranceFrequencies", {"P10": 1.0, "P50": 1.0, "P90": 1.0}),
        ("tolerances", "ToleranceMargins", {"P50": 100.0, "Probability": 100.0}),
        ("tolerances", "TolerancePeaks", {"Torque P50": 1.0, "Nominal stress": 1e-6}),
        ("starts", "StartMatrix", {"Voltage": 100.0, "Peak-to-peak stress": 1e-6}),
        ("starts", "DamageLedger", {"Used": 1.0, "Allowed": 1.0, "Remaining years": 1.0}),
        ("calibrate", "CalibratedFrequencies", {"Before": 1.0, "After": 1.0}),
    ],
)
def test_cells_are_those_of_the_json_in_the_units_shown(
    folder: Path,
    cells: dict[str, list[dict[str, Any]]],
    study: str,
    table: str,
    columns: dict[str, float],
) -> None:
    """JSON in SI, cells in %, MPa and N m; numbers of the studies of tolerances in four digits."""
    shown = cells[table]
    rows = content(folder, study)[_key(table)]
    assert len(shown) == len(rows) > 0
    for cell, row in zip(shown, rows, strict=True):
        for column, factor in columns.items():
            wanted = row.get(json_key(column))
            if isinstance(wanted, str) or wanted is None:
                assert cell[column] in (wanted, "not judged", None)
            else:
                assert cell[column] == pytest.approx(factor * wanted, rel=6e-4), (table, column)


def _key(table: str) -> str:
    return "".join(f"_{c.lower()}" if c.isupper() else c for c in table).lstrip("_")


def test_the_starts_factor_is_in_the_probability_and_in_the_ledger(folder: Path) -> None:
    """Starts of the samples lie near 450: more than the 300 that are required, and less than twice."""
    (row,) = content(folder, "tolerances")["starts_of_sample"]
    assert row["p_10"] > 300.0  # all would be enough without the factor
    assert row["p_90"] < 600.0  # with it, no more than those above the P90 can be
    assert row["probability"] <= 0.1 + 1.0 / 30.0
    (ledger,) = content(folder, "starts")["damage_ledger"]
    rows = content(folder, "starts")["start_matrix"]
    damage = {row["condition"]: 1.0 / row["allowable_starts"] for row in rows}
    yearly = 10.0 * damage["normal"] + 2.0 * damage["weak"]
    assert ledger["allowed"] == 0.5
    assert ledger["used"] == pytest.approx(40.0 * damage["weak"], rel=1e-9)
    assert ledger["remaining_years"] == pytest.approx((0.5 - 40.0 * damage["weak"]) / yearly)


@pytest.mark.slow
def test_another_duty_makes_the_start_matrix_out_of_date(
    folder: Path, cells: dict[str, list[dict[str, Any]]], tmp_path: Path, undrawn: None
) -> None:
    """Told by verify and diff, left out of the report; the other studies stand as they are."""
    book = folder / "train.xlsx"
    other = Path(shutil.copy2(book, tmp_path / "other.xlsx"))
    opened = open_workbook(other, ignore_lock=True)
    there = opened.table("StartConditions")
    at = there.ref.left + there.column_index("Per year")
    opened.set_cell(there.sheet, cell_name(there.data.top, at), 12.0)
    opened.save(in_place=True)
    found = compare_files(book, other)
    assert found.inputs is not None
    rows = [(c.kind, c.table, c.row, c.column, c.before, c.after) for c in found.inputs]
    assert rows == [("changed", "StartConditions", "normal", "Per year", 10.0, 12.0)]
    good, bad = verify_file(book), verify_file(other)
    assert good.passes
    wrong = [f for f in bad.findings if f.fails]
    assert wrong
    assert any("Start matrix" in f.sentence for f in wrong)
    report(other, docx=tmp_path / "other.docx")
    document = docx.Document(str(tmp_path / "other.docx"))
    text = [p.text for p in document.paragraphs]
    text += [c.text for t in document.tables for row in t.rows for c in row.cells]
    assert sum("it was calculated from inputs with SHA-256" in one for one in text) == 4
    for head in (
        "Tuning: all combinations",
        "Tolerances",
        "Calibration against measurements",
    ):
        assert any(head in one for one in text), head
    assert f"{cells['DamageLedger'][0]['Used']:.4g}" not in text


#: Columns that the studies of this train leave blank.
BLANK = {
    "TuningResults": {"impacts", "note"},
    "StartsByVoltage": {"unloaded_stress", "unloaded_starts"},
    "StartMatrix": {"damping_ratio", "trip_speed", "impacts"},
    "CalibratedParameters": {"inertia", "calibrated_inertia"},
    "FrequencyFit": {"explained"},  # fewer measurements than quantities
}


@pytest.mark.parametrize("command", ["tune", "tolerances", "starts", "calibrate"])
def test_every_column_of_a_study_has_values(folder: Path, command: str) -> None:
    """A column of the record that no row delivers would stay blank without a word."""
    spec = study_of_command(command).spec
    content = json.loads((folder / f"{command}.json").read_text(encoding="utf-8"))
    for table in spec.results:
        if rows := content.get(table.key):
            lacking = {field.key for field in table.columns} - set().union(*rows)
            assert lacking == BLANK.get(table.name, set()), (
                f"rows of table {table.name}, made in addin/studies/{spec.key}.py: {lacking}"
            )
