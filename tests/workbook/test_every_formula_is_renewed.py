"""A calculation leaves no formula of ours without its value, in workbooks of this version and of the first."""

from __future__ import annotations

from pathlib import Path

import pytest

from addin.contract.shipped import template_path
from addin.writing.recalculate import recalculate
from addin.xlsx import Workbook, open_workbook
from addin.xlsx.formulas import CacheReport

FIRST_RELEASE = Path(__file__).parents[1] / "verify" / "release_0_1_0" / "train.xlsx"


@pytest.mark.slow
@pytest.mark.parametrize(
    "source",
    [FIRST_RELEASE, template_path("example_motor.xlsx"), template_path("example_studies.xlsx")],
    ids=["0.1.0", "motor", "studies"],
)
def test_every_formula_is_renewed(
    source: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    reports: list[CacheReport] = []
    refresh = Workbook.refresh_formula_caches

    def kept(book: Workbook) -> CacheReport:
        reports.append(refresh(book))
        return reports[-1]

    monkeypatch.setattr(Workbook, "refresh_formula_caches", kept)
    recalculate(source, destination=tmp_path / "done.xlsx")
    (report,) = set(reports)
    assert (report.method, report.removed) == ("recalculated", 0)
    assert report.changed > 20
    done = open_workbook(tmp_path / "done.xlsx", read_only=True)
    for sheet in done.sheet_names:
        part = done.sheet_part(sheet) if done.structure.worksheet_part(sheet) else None
        for place in part.formulas if part else ():
            shown = part.constant(*place)
            assert shown is None or not str(shown).startswith("#"), (sheet, place, shown)
