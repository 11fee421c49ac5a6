"""Words of a tuning study: in the units that the engineer typed; the JSON in SI, the numbers the same."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
from openpyxl.utils import get_column_letter
from typer.testing import CliRunner

from addin.cli.app import app
from addin.contract.shipped import template_path
from addin.xlsx import open_workbook
from tests.opened import rows_of

LBF_IN = 0.1129848290276167  # N m
PSI = 6894.757293168361


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The shipped example with one row in per cent and one in kN m/rad, studied."""
    folder = tmp_path_factory.mktemp("words")
    workbook = open_workbook(template_path("example_studies.xlsx"))
    place = workbook.table("Tuning")
    for row, column, value in (
        (1, "Values", "33"), (2, "Unit", "kN*m/rad"), (2, "Values", "350; 500.5"),
    ):  # fmt: skip
        letter = get_column_letter(place.ref.left + place.column_index(column))
        workbook.set_cell(place.sheet, f"{letter}{place.data.top + row - 1}", value)
    workbook.save(folder / "train.xlsx")
    told = CliRunner().invoke(
        app, ["tune", str(folder / "train.xlsx"), "--json", str(folder), "--jobs", "1"]
    )
    assert told.exit_code == 0, told.output
    (folder / "output.txt").write_text(told.output, encoding="utf-8")
    return folder


@pytest.mark.slow
def test_a_share_is_told_in_the_unit_of_the_element_and_a_value_in_that_of_its_row(
    folder: Path,
) -> None:
    elements = rows_of(folder / "train.xlsx", "Elements")
    typed = next(e["Stiffness"] for e in elements if e["Element"] == "HS coupling")
    words = [str(row["Combination"]) for row in rows_of(folder / "train.out.xlsx", "TuningResults")]
    for one in words:
        if one == "as is":
            continue
        share = re.search(r"HS coupling stiffness 0.33 × \(([\d,]+) lbf in/rad\)", one)
        assert float(share[1].replace(",", "")) == pytest.approx(0.33 * typed, rel=1e-5), one
        assert re.search(r"Intermediate coupling stiffness (350|500\.5) kN m/rad", one), one
    assert len(words) == 1 + 2 * 3
    options = [row["Option"] for row in rows_of(folder / "train.out.xlsx", "TuningStarts")]
    assert "lbf in/rad" in str(options[0])


def test_reasons_tell_stress_in_the_unit_of_the_material(folder: Path) -> None:
    for row in rows_of(folder / "train.out.xlsx", "TuningResults"):
        stress = re.search(r"largest stress ([\d,]+) psi", str(row["Reason"]))
        there = row["Peak-to-peak stress"]
        assert float(stress[1].replace(",", "")) == pytest.approx(there, rel=5e-3), row["Rank"]
        assert "N m" not in str(row["Reason"])
    assert "psi" in (folder / "output.txt").read_text(encoding="utf-8")


def test_the_json_is_in_si_in_the_same_order(folder: Path) -> None:
    told = json.loads((folder / "train.tune.json").read_text(encoding="utf-8"))
    text = json.dumps(told, ensure_ascii=False)
    assert "lbf" not in text
    assert "psi" not in text
    assert "kN" not in text
    rows = rows_of(folder / "train.out.xlsx", "TuningResults")
    for here, there in zip(told["tuning_results"], rows, strict=True):
        assert here["rank"] == there["Rank"]
        found = re.search(r"0\.33 × \(([\d,.]+) N m/rad\)", here["combination"])
        if found is None:
            assert here["combination"] == there["Combination"] == "as is"
            continue
        si = float(found[1].replace(",", ""))
        share = re.search(r"\(([\d,]+) lbf", str(there["Combination"]))
        assert si == pytest.approx(float(share[1].replace(",", "")) * LBF_IN, rel=2e-5)
        stress = re.search(r"largest stress ([\d.]+) MPa", here["reason"])
        assert float(stress[1]) * 1e6 == pytest.approx(
            float(there["Peak-to-peak stress"]) * PSI, rel=5e-3
        )
