"""Sheets that engineers open first: the scalars of `Case`, the summary, the element of each history chart."""

from __future__ import annotations

from typing import Any

from xlsxwriter.utility import xl_cell_to_rowcol, xl_rowcol_to_cell

from addin.contract import tables as fields
from addin.contract.banner import OVERALL_AT, overall_formula
from addin.contract.chart_tables import HISTORIES, LABELS
from addin.contract.sheet import plot_name
from addin.contract.sheets import (
    BLANK_TEXT,
    CASE_HALVES,
    CHOICES_BEGIN,
    FOOT_ROW,
    KEY_NUMBERS,
    KEY_NUMBERS_ROW,
    NOTES_BEGIN,
    SCHEMATIC,
    SCHEMATIC_ROW,
    TITLE_BLOCK,
    VERDICTS_ROW,
    part_named,
)
from addin.contract.tables import Field
from addin.template.cell_rules import hint, input_rule, unit_list
from addin.template.frames import column_number
from addin.template.table_cells import Tables
from addin.xlsx.references import quoted_sheet

NOT_CALCULATED_YET = (
    "Not calculated yet. Save and close this workbook, then run: torsionbook recalc FILE"
)
#: Size of the schematic, which the sheet has room for. [pixel]
SCHEMATIC_WIDTH, SCHEMATIC_HEIGHT = 1322, 90
#: Heights of rows of sheet Summary, counted from 1. [pt]
_SUMMARY_ROWS = (
    (1, 24.0), (2, 17.25), (3, 3.0), (4, 15.0), (5, 15.0), (6, 1.5), (7, 1.5), (8, 1.5), (9, 21.75), (10, 3.0),
    (SCHEMATIC_ROW, 68.25), (SCHEMATIC_ROW + 1, 3.0),
    *((row, 13.9) for row in range(KEY_NUMBERS_ROW, VERDICTS_ROW)), (VERDICTS_ROW, 16.5),
    (FOOT_ROW, 15.0),
)  # fmt: skip


class FrontSheets(Tables):
    """Scalars, summary and choices."""

    def _case(self) -> None:
        """Scalars in two halves, each with its name, unit and what a blank means."""
        page = self.sheets["Case"]
        self.style.of(part_named("Case"))
        page.ignore_errors({"number_stored_as_text": "C6:C13"})
        for letter, groups in CASE_HALVES:
            row, left = 4, column_number(letter)
            for group in groups:
                members = [f for f in fields.SCALARS if f.group == group]
                row = self._scalars(page, group, members, row, left)
        self.style.usual()

    def _scalars(self, page: Any, group: str, members: list[Field], row: int, left: int) -> int:
        """A group of scalars under its heading; the row where the next one begins."""
        for column in range(left, left + 4):
            page.write_blank(row, column, None, self.style("group"))
        page.write_string(row, left, group, self.style("group"))
        for k, field in enumerate(members, row + 1):
            self._scalar(page, field, k, left)
        return row + len(members) + 2

    def _scalar(self, page: Any, field: Field, row: int, left: int) -> None:
        page.write_string(row, left, field.name_in_words, self.style("label"))
        value = self.example.scalars.get(field.name)
        if field.name == "TemplateVersion":
            value = fields.TEMPLATE_VERSION
        is_wide = field.group == "Document"  # room for long titles
        style = self.style(
            "input" if field.is_number else "input_wide" if is_wide else "input_text"
        )
        self._put(page, row, left + 1, value, style)
        page.data_validation(row, left + 1, row, left + 1, input_rule(field))
        self.scalar_cells += [(row, left), (row, left + 2)]
        cell = xl_rowcol_to_cell(row, left + 1, True, True)
        self.workbook.define_name(field.name, f"=Case!{cell}")
        if is_wide:
            for column in (left + 2, left + 3):
                page.write_blank(row, column, None, self.style("input_more"))
            return
        if field.has_unit:
            unit = self.example.scalar_units.get(field.name, self._unit(field))
            page.write_string(row, left + 2, unit, self.style("input_unit"))
            page.data_validation(row, left + 2, row, left + 2, unit_list(field))
        else:
            page.write_blank(row, left + 2, None, self.style("no_unit"))
        page.write_string(row, left + 3, hint(field), self.style("hint"))

    def _summary(self) -> None:
        page = self.sheets["Summary"]
        self.style.of(part_named("Summary"))
        for row, height in _SUMMARY_ROWS:
            page.set_row(row - 1, height)
        for label, begin, end, words, name in TITLE_BLOCK:
            page.write_string(label, words, self.style("title_label"))
            style, value = self.style("title_value"), self._scalar_text(name)
            if begin != end:
                page.merge_range(f"{begin}:{end}", "", style)
            page.write_formula(begin, BLANK_TEXT.format(name), style, value)
        banner = self.style("verdict_banner")
        page.merge_range("B9:I9", "", banner)
        page.write_formula("B9", overall_formula(), banner, "NOT CALCULATED")
        self.workbook.define_name("OverallVerdict", f"={OVERALL_AT}")
        page.write_string(f"F{NOTES_BEGIN - 1}", "Notes", self.style("caption"))
        page.insert_textbox(
            SCHEMATIC_ROW - 1, 1, "",
            {
                "width": SCHEMATIC_WIDTH, "height": SCHEMATIC_HEIGHT, "object_position": 2,
                "description": SCHEMATIC, "line": {"none": True},
            },
        )  # fmt: skip
        self._key_numbers(page, KEY_NUMBERS_ROW - 1)
        self.style.usual()

    def _scalar_text(self, name: str) -> Any:
        """Cached value of a title block cell."""
        if name.startswith("run_"):
            return NOT_CALCULATED_YET if name == "run_Stamp" else ""
        return self.example.scalars.get(name, "")

    def _key_numbers(self, page: Any, row: int) -> None:
        page.write_string(row, 1, "Key numbers", self.style("caption"))
        style = self.style("key_unit")
        for k, number in enumerate(KEY_NUMBERS, row + 1):
            page.write_string(k, 1, number.label, self.style("key_label"))
            page.write_formula(
                k, 2, number.formula, self.style("key_value", number.number_format), ""
            )
            if "[" in number.unit:
                self._unit_of_column(page, k, 3, number.unit)
            else:
                page.write_string(k, 3, number.unit, style)
            if number.where:
                page.write_formula(k, 4, number.where, self.style("key_where"), "")

    def _unit_of_column(self, page: Any, row: int, at: int, name: str) -> None:
        """The unit of a column, ``Table[Column]``, as its table shows it."""
        table, column = name.rstrip("]").split("[")
        cell = self.unit_cells[table, column]
        text = self.example.units.get(
            (table, column), self._unit(fields.table(table).column(column))
        )
        page.write_formula(row, at, f'=IF({cell}="","",{cell})', self.style("key_unit"), text)

    def _chosen_elements(self) -> None:
        """Cells in which the engineer may name the element of each history chart."""
        part = part_named("Histories")
        page = self.page(part)
        head, column = xl_cell_to_rowcol(part.at(f"B{CHOICES_BEGIN - 1}"))
        for offset, words in ((0, "Chart"), (1, "Element to draw"), (3, "Drawn now")):
            page.write_string(head, column + offset, words, self.style("caption"))
        for row, number in enumerate(range(1, HISTORIES + 1), head + 1):
            page.write_string(row, column, f"History {number}", self.style("label"))
            page.merge_range(row, column + 1, row, column + 2, "", self.style("input_text"))
            page.data_validation(
                row, column + 1, row, column + 1,
                {
                    "validate": "list", "source": "=ElementNames", "show_error": False,
                    "input_title": "Element of this chart",
                    "input_message": "Blank = chosen by torsionbook. A choice takes effect at the next "
                    "recalculation; the element now drawn is shown at the right.",
                },
            )  # fmt: skip
            key = f"History caption {number}"
            words = self.style("drawn")
            page.merge_range(row, column + 3, row, column + 5, "", words)
            text = str(self.blocks["ChartLabels"][LABELS.index(key)][1] or "")
            drawn = f"=ChartData!$B${self._label_row(key)}"
            page.write_formula(row, column + 3, drawn, words, text)
            cell = xl_rowcol_to_cell(row, column + 1, True, True)
            self.workbook.define_name(plot_name(number), f"={quoted_sheet(part.worksheet)}!{cell}")
