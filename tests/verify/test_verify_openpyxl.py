"""Workbooks whose inputs openpyxl typed: it leaves the copies of values in charts as they were."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import openpyxl
import pytest
from openpyxl.utils import get_column_letter, range_boundaries

from addin.contract.shipped import template_path
from addin.contract.tables import INPUT_TABLES, SCALARS
from addin.verify.file import verify_file
from addin.writing.recalculate import recalculate
from addin.xlsx import drawn_charts, open_workbook


def table_of(workbook, name):
    """Sheet, table and headers."""
    sheet = next(sheet for sheet in workbook if name in sheet.tables)
    table = sheet.tables[name]
    left, top, right, _ = range_boundaries(table.ref)
    return sheet, table, [sheet.cell(top, column).value for column in range(left, right + 1)]


def copied_table(source, target, name, resized):
    """Units and rows of a table, typed into the other workbook."""
    sheet, table, headers = table_of(source, name)
    there, other, columns = table_of(target, name)
    left, top, _, bottom = range_boundaries(table.ref)
    to_left, to_top, to_right, _ = range_boundaries(other.ref)
    for k, header in enumerate(headers):
        column = to_left + columns.index(header)
        for row in range(-1, bottom - top + 1):
            if row:
                there.cell(to_top + row, column).value = sheet.cell(top + row, left + k).value
    if resized:
        last = f"{get_column_letter(to_right)}{to_top + bottom - top}"
        other.ref = f"{get_column_letter(to_left)}{to_top}:{last}"
        if other.autoFilter:
            other.autoFilter.ref = other.ref


def scalar_cell(workbook, name):
    [(sheet, cell)] = workbook.defined_names[name].destinations
    return workbook[sheet][cell.replace("$", "")]


def recalculated(path: Path) -> Path:
    outcome = recalculate(path)
    assert outcome.problems == ()
    return outcome.written[0]


def copies(path: Path, table: str) -> Iterator[str]:
    """Values that charts carry of the third column of an input table."""
    workbook = open_workbook(path, read_only=True)
    place = workbook.table(table)
    for chart in drawn_charts(workbook):
        for drawn in chart.references():
            for sheet, rect in drawn.areas:
                if (sheet, rect.left) == (place.sheet, place.ref.left + 2) and drawn.points:
                    yield drawn.points[0]


@pytest.mark.slow
def test_an_input_typed_by_openpyxl_stands_in_the_charts_after_recalculation(tmp_path):
    book = openpyxl.load_workbook(template_path("example_proposed.xlsx"))
    sheet, table, _ = table_of(book, "MotorTorque")
    left, top, _, _ = range_boundaries(table.ref)
    typed = sheet.cell(top + 1, left + 2)
    before, typed.value = typed.value, 0.5678
    book.save(tmp_path / "train.xlsx")
    assert set(copies(tmp_path / "train.xlsx", "MotorTorque")) == {str(before)}  # not 0.5678
    result = recalculated(tmp_path / "train.xlsx")
    assert set(copies(result, "MotorTorque")) == {"0.5678"}
    found = verify_file(result)
    assert found.passes
    assert [one for one in found.findings if one.fails] == []


@pytest.mark.first_ones(1)
@pytest.mark.parametrize("resized", [False, True])
def test_a_blank_template_filled_by_openpyxl_follows_from_its_inputs(tmp_path, resized):
    source = openpyxl.load_workbook(template_path("example_proposed.xlsx"))
    target = openpyxl.load_workbook(template_path("blank_us.xlsx"))
    for spec in INPUT_TABLES:
        copied_table(source, target, spec.name, resized)
    for spec in SCALARS:
        typed = scalar_cell(source, spec.name)
        if typed.value is not None and spec.name != "TemplateVersion":
            scalar_cell(target, spec.name).value = typed.value
            if spec.has_unit:
                scalar_cell(target, spec.name).offset(0, 1).value = typed.offset(0, 1).value
    target.save(tmp_path / "train.xlsx")
    found = verify_file(recalculated(tmp_path / "train.xlsx"))
    assert found.outcome == "follows"
