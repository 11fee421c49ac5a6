"""Every number on a result sheet can be traced: the table of fields, the page, the workbook."""

from __future__ import annotations

import re
from pathlib import Path

import openpyxl
import pytest

from addin.contract.field import SHAPE_COLUMNS
from addin.contract.shipped import template_path
from addin.contract.sources import GROUPS
from addin.contract.tables import INPUT_TABLES, RESULT_TABLES, SCALARS, WORKBOOK_TABLES, table
from addin.contract.trace_table import TRACE_HEADERS, trace_rows

ROOT = Path(__file__).resolve().parents[2]
TABLES = (*RESULT_TABLES, *WORKBOOK_TABLES)
COLUMNS = [(spec, field) for spec in TABLES for field in spec.every_column]
NAMES = (
    {field.name for field in SCALARS}
    | {f"{spec.name}.{field.name}" for spec in INPUT_TABLES for field in spec.columns}
    | {f"{spec.name}.{field.name}" for spec, field in COLUMNS}
)


@pytest.mark.parametrize(("spec", "field"), COLUMNS, ids=lambda one: getattr(one, "name", ""))
def test_every_result_column_says_where_it_comes_from(spec, field):
    assert field.help.strip()
    assert field.trace.equation.strip()
    assert field.trace.source.strip()
    unknown = [name for name in field.trace.inputs if name not in NAMES]
    assert unknown == []


def test_no_trace_of_a_column_that_is_not_there():
    assert all(field.trace is not None for _, field in COLUMNS)
    assert all(set(members) <= NAMES for members in GROUPS.values())


def test_results_lead_to_inputs_and_not_in_circles():
    """From any result, back through the results it uses, one comes to inputs."""
    traces = {f"{spec.name}.{field.name}": field.trace for spec, field in COLUMNS}

    def back(name: str, way: tuple[str, ...]) -> None:
        assert name not in way, f"{' from '.join((*way, name))}"
        if name in traces:
            for one in traces[name].inputs:
                back(one, (*way, name))

    for name in traces:
        back(name, ())


def test_numbers_of_the_engine_come_from_something():
    """Numbers are no names: only wall times and counters have no input."""
    without = {
        (spec.name, field.name)
        for spec, field in COLUMNS
        if field.is_number and not field.trace.inputs
    }
    assert without == {("Effects", "Time"), ("AccuracyCost", "Time"), ("Plans", "Plan")}


def test_documents_and_sections_cited_are_there():
    pages = {path.name: path.read_text(encoding="utf-8") for path in (ROOT / "docs").glob("*.md")}
    for spec, field in COLUMNS:
        for name, section in re.findall(r"docs/([\w-]+\.md)(?:, ([^;]+))?", field.trace.source):
            assert name in pages, (spec.name, field.name)
            if section and name == "method.md":
                assert f"[{section}" in pages[name], section  # followed by tests/boundaries
            elif section and name == "nomenclature.md":
                assert section in pages[name], section


def test_sheet_trace_and_header_prompts_show_it():
    book = openpyxl.load_workbook(template_path("blank_us.xlsx"))
    every = list(book["Notes"].iter_rows(min_col=2, max_col=9, values_only=True))
    rows = every[every.index(TRACE_HEADERS) :]
    wanted = [tuple(text or None for text in row) for row in trace_rows()]
    assert rows[1 : len(wanted) + 1] == wanted

    tables = {name: (page, page.tables[name]) for page in book.worksheets for name in page.tables}
    for spec in TABLES:
        page_, there = tables[spec.name]
        top, left = openpyxl.utils.cell.range_boundaries(there.ref)[1::-1]
        prompts = {
            str(cell): rule
            for rule in page_.data_validations.dataValidation
            for cell in rule.sqref.ranges
        }
        for k, field in enumerate(spec.workbook_columns):
            cell = f"{openpyxl.utils.get_column_letter(left + k)}{top}"
            assert page_[cell].value == field.name
            rule = prompts[cell]
            assert rule.showInputMessage
            assert rule.prompt.startswith(field.trace.equation[:100].split("\n")[0])
            assert len(rule.prompt) <= 255
            assert rule.type in (None, "none")
    assert len(table("ModeShapes").workbook_columns) == SHAPE_COLUMNS + 1
