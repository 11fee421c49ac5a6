"""Edits that hide a result, a formula or what it is called: none leaves a clean outcome."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from cells_of_tables import cell_of
from tampered_package import Package

from addin.package import open_workbook
from addin.verify.file import verify_file
from addin.verify.findings import Finding, Verification


@pytest.fixture
def tampered(train: Path, tmp_path: Path) -> Callable[[Callable[[Package], None]], Verification]:
    """What is said of the workbook after an edit of its package."""

    def verified(edit: Callable[[Package], None]) -> Verification:
        package = Package(train)
        edit(package)
        return verify_file(package.store(tmp_path / "tampered.xlsx"))

    return verified


def failing(found: Verification) -> list[Finding]:
    return [finding for finding in found.findings if finding.fails]


@pytest.mark.parametrize("table", ["AllowableStarts", "StartCycles"])
def test_a_result_table_that_became_a_range_is_missed(tampered, table):
    found = tampered(lambda package: package.table_to_range(table))
    assert not found.passes
    [missing] = [f for f in failing(found) if f.kind == "table missing"]
    assert (missing.sheet, missing.table) == ("Starts", table)


def test_a_zero_in_place_of_a_blank_is_seen_and_a_blank_in_place_of_a_zero(train, tmp_path):
    workbook = open_workbook(train)
    table = workbook.table("NaturalFrequencies")
    cells = {"blank": [], "zero": []}
    for row in range(1, table.data.height + 1):
        for column in ("Frequency", "Percent speed"):
            place = cell_of(workbook, "NaturalFrequencies", row, column)
            held = workbook.shown_value(*place)
            if held is None or held == 0.0:
                cells["blank" if held is None else "zero"].append(place)
    assert cells["blank"]
    assert cells["zero"]
    workbook.set_cell(*cells["blank"][0], 0.0)
    workbook.set_cell(*cells["zero"][0], None)
    workbook.save(tmp_path / "edited.xlsx")
    named = {(f.sheet, f.cell) for f in failing(verify_file(tmp_path / "edited.xlsx"))}
    assert {cells["blank"][0], cells["zero"][0]} <= named
