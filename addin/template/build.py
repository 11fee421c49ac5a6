"""Builds the shipped workbooks from the one table of fields: ``python -m addin.template.build FOLDER``.

Sheets are described as data (`SHEETS`): which tables stand where, which charts beside them, how
wide the columns are. The builder knows how a scalar, an input table and a result table look and
nothing of what they mean. Dates are fixed, so that building twice gives the same bytes.
"""

from __future__ import annotations

import argparse
import datetime as dt
import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import xlsxwriter
from xlsxwriter.utility import xl_cell_to_rowcol, xl_col_to_name, xl_rowcol_to_cell

from addin.charts.data import chart_blocks
from addin.charts.rows import Rows
from addin.contract import tables as fields
from addin.contract.chart_tables import CHART_TABLES, GROUPS, LABELS
from addin.contract.charts import CHARTS
from addin.contract.field import SHAPE_COLUMNS
from addin.contract.live_formulas import CHANGE_NAME
from addin.contract.palette import SPEED_GROUPS
from addin.contract.run_facts import RUN_FACTS
from addin.contract.sheet import NOTES_WIDTH, Sheet, plot_name, text_height
from addin.contract.sheets import (
    BLANK_TEXT,
    CASE_HALVES,
    CYCLE_FACTS,
    CYCLE_FACTS_AT,
    EFFECT_NOTES_AT,
    FACT_LINES,
    HISTORY_CHARTS,
    KEY_NUMBERS,
    KIND_WORDS,
    OVERALL,
    REVERSAL_NOTES_AT,
    SHEETS,
    STRIP,
    TAB_COLOURS,
    TITLE_BLOCK,
)
from addin.contract.shown_units import shown_units
from addin.contract.studies.registry import (
    COLOUR_SCALE,
    STUDIES,
    STUDY_CHARTS,
    STUDY_FACTS,
    with_studies,
)
from addin.contract.study_spec import StudyScale
from addin.contract.tables import Field, TableSpec
from addin.contract.texts import (
    CONTACT_LAW,
    EFFECT_NOTES,
    NOTES,
    REVERSAL_NOTES,
)
from addin.contract.trace_table import TRACE_HEADERS, trace_groups, trace_rows
from addin.reading.workbook import read_workbook
from addin.template.charts import Place, Places, make_chart
from addin.template.examples import (
    EXAMPLES,
    Example,
    example_case,
    example_torque,
    provenance_of,
    study_rows,
)
from addin.template.live_sheet import LIVE_SHEET, LiveAnswers, LiveSheet, live_answers
from addin.template.styles import Styles
from addin.template.variants import VARIANTS, Variant
from engine.case.effects import EFFECTS

__all__ = ["STUDY_TEMPLATES", "TEMPLATES", "build_all", "build_template", "main"]

#: Rows of the lists behind the drop-downs.
_LISTED = 60
_CREATED = dt.datetime(2026, 1, 1)
_LETTER, _A4 = 1, 9
#: Headers of at most so many letters stand in one line. [characters]
_SHORT_HEADER = 8
#: Width of the paper on its side. [in]
_PAPER = {"us": 11.0, "si": 11.69}
#: Programs measure columns a little differently. [1]
_PRINT_SLACK = 0.94
#: Room of the overall verdict at the right end of the strip. [characters]
_VERDICT_WIDTH = 54.0
#: A last column wider than this leaves no room for the overall verdict. [characters]
_WIDE = 80.0
#: Columns C to Q of sheet `Reversals`, merged. [characters]
_REVERSAL_NOTES_WIDTH = 138.0
#: Last row but one of a sheet: a print area of whole columns is none to openpyxl.
_LAST_ROW = 1_048_575
#: Excel shows no longer prompt. [characters]
_LONGEST_PROMPT = 255
_NOT_YET = "Not calculated yet. Save and close this workbook, then run: torsionbook recalc FILE"

_CHARTS = {**CHARTS, **STUDY_CHARTS}

#: Without functions.
PLAIN = VARIANTS["files"]

#: File name → unit system and example.
TEMPLATES: Mapping[str, tuple[str, str | None]] = {
    "blank_us.xlsx": ("us", None),
    "blank_si.xlsx": ("si", None),
    "example_proposed.xlsx": ("us", "proposed"),
    "example_modified.xlsx": ("us", "modified"),
    "example_backlash.xlsx": ("us", "backlash"),
}

#: The same with the sheets of the studies filled.
STUDY_TEMPLATES: Mapping[str, tuple[str, str]] = {"example_studies.xlsx": ("us", "proposed")}

# --- the builder ----------------------------------------------------------------------------------


def build_all(folder: Path) -> list[Path]:
    """Build every shipped workbook."""
    folder.mkdir(parents=True, exist_ok=True)
    return [
        *(build_template(folder / name, *kind) for name, kind in TEMPLATES.items()),
        *(
            build_template(folder / name, *kind, studies=True)
            for name, kind in STUDY_TEMPLATES.items()
        ),
    ]


def build_template(
    path: Path,
    system: str,
    example: str | Example | None = None,
    variant: Variant = PLAIN,
    *,
    studies: bool = False,
) -> Path:
    """Build one workbook; with functions in its cells, a second time with their answers."""
    _build(path, system, example, variant, None, studies)
    if variant.spelled is not None and example is not None:
        answers = live_answers(read_workbook(path), system)
        _build(path, system, example, variant, answers, studies)
    return path


def _build(
    path: Path,
    system: str,
    example: str | Example | None,
    variant: Variant,
    answers: LiveAnswers | None,
    studies: bool,
) -> None:
    filled = EXAMPLES[example] if isinstance(example, str) else example or Example({}, {}, {})
    if studies and isinstance(example, str):
        filled = replace(filled, tables={**filled.tables, **study_rows(example)})
    blocks = _chart_rows(filled, system)
    with xlsxwriter.Workbook(
        path, {"default_format_properties": {"font_name": "Arial", "font_size": 10}}
    ) as workbook:
        workbook.set_properties(
            {
                "title": "Torsional start-up analysis of a synchronous-motor train",
                "author": "torsionbook",
                "created": _CREATED,
                "comments": "Built by addin.template; recalculated by torsionbook recalc.",
            }
        )
        workbook.set_size(2400, 1500)
        provenance = provenance_of(example) if isinstance(example, str) else ()
        builder = _Builder(
            workbook,
            system,
            filled,
            blocks,
            provenance=provenance,
            variant=variant,
            studies=studies,
        )
        builder.build(answers)


def _chart_rows(filled: Example, system: str) -> dict[str, Rows]:
    """Chart data that the inputs alone give, so that an example opens with its drawing."""
    names = {
        (table.name, field.name): filled.units.get(
            (table.name, field.name), getattr(field, f"unit_{system}")
        )
        for table in fields.EVERY_TABLE
        for field in table.columns
    }
    units, _ = shown_units(names, example_torque(filled))
    return chart_blocks(example_case(filled, units), units)


class _Builder:
    """One workbook under construction."""

    def __init__(
        self,
        workbook: Any,
        system: str,
        example: Example,
        blocks: Mapping[str, Rows],
        *,
        provenance: Sequence[tuple[str, str]],
        variant: Variant = PLAIN,
        studies: bool = False,
    ) -> None:
        self.workbook = workbook
        self.system = system
        self.example = example
        self.blocks = blocks
        self.provenance = tuple(provenance)
        self.style = Styles(workbook)
        self.places: dict[str, Place] = {}
        self.unit_cells: dict[tuple[str, str], str] = {}
        self.sheets: dict[str, Any] = {}
        self.variant = variant
        self.studies = studies
        self.scalar_cells: list[tuple[int, int]] = []

    def build(self, answers: LiveAnswers | None = None) -> None:
        """All sheets: first the cells, then the charts that refer to them."""
        layout = with_studies(SHEETS) if self.studies else SHEETS
        layout = layout if self.variant.spelled is None else _with_live(layout)
        for sheet in layout:
            self.sheets[sheet.name] = self.workbook.add_worksheet(sheet.name)
        for name in ("Lists", "ChartData"):
            self.sheets[name] = self.workbook.add_worksheet(name)
        for sheet in layout:
            self._frame(sheet)
            for table, cell in sheet.tables.items():
                self._table(sheet, _spec(table), *xl_cell_to_rowcol(cell))
        self._case()
        self._notes()
        self._trace()
        self._lists()
        self._chart_data()
        self._chosen_elements()
        self._frequencies_note()
        self._change_cell()
        self._cycle_facts()
        self._fact_lines()
        self._sheet_notes()
        self._summary()
        self._verdict_colours()
        if self.variant.spelled is not None:
            self._live(answers)
        if self.studies:
            self._study_lines()
        places = Places(self.places)
        for sheet in layout:
            for at in sheet.charts:
                chart = make_chart(self.workbook, places, _CHARTS[at.name], (at.width, at.height))
                options = {"object_position": 2, "description": at.name}
                self.sheets[sheet.name].insert_chart(at.cell, chart, options)
        self.sheets["Summary"].activate()

    # -- frames ------------------------------------------------------------------------------------

    def _frame(self, sheet: Sheet) -> None:
        """Column widths, banner, strip, freezing and print set-up of a sheet."""
        page = self.sheets[sheet.name]
        page.hide_gridlines(2)
        if sheet.hidden:
            page.hide()
        page.set_tab_color(TAB_COLOURS[sheet.kind])
        for columns, width in sheet.widths.items():
            page.set_column(columns if ":" in columns else f"{columns}:{columns}", width)
        page.set_row(0, 28)
        page.set_row(1, 18)
        self._banner(page, sheet)
        if sheet.intro:
            page.write_string(2, 1, sheet.intro, self.style("note"))
        if sheet.freeze:
            page.freeze_panes(*xl_cell_to_rowcol(sheet.freeze))
        self._print_set_up(page, sheet)

    def _banner(self, page: Any, sheet: Sheet) -> None:
        """Title and kind of the sheet, then document and overall verdict."""
        last = _column(sheet.last)
        for column in range(1, last + 1):
            page.write_blank(0, column, None, self.style("banner"))
            page.write_blank(1, column, None, self.style("strip"))
        if sheet.name == "Summary":
            title = "Torsional start-up analysis of a synchronous-motor train"
            page.write_string(0, 1, title, self.style("banner"))
            page.write_string(0, last, "torsionbook", self.style("banner_right"))
            self.workbook.define_name("DocumentStrip", "=Summary!$B$2")
            page.write_formula(1, 1, STRIP, self.style("strip"), self._strip())
            return
        page.write_string(0, 1, sheet.name, self.style("banner"))
        page.write_string(0, last, KIND_WORDS[sheet.kind], self.style("banner_right"))
        page.write_formula(1, 1, "=DocumentStrip", self.style("strip"), self._strip())
        if last < 3 or _widths(sheet)[last] > _WIDE:  # it would cut the strip short
            return
        verdict, first = self.style("strip_right"), _begin_of(sheet, _VERDICT_WIDTH)
        page.merge_range(1, first, 1, last, "", verdict)
        page.write_formula(1, first, "=OverallVerdict", verdict, "NOT CALCULATED")
        cell = xl_rowcol_to_cell(1, first, True, True)
        for word, style in (("PASS", "cf_pass"), ("ACCEPTED", "cf_accepted"), ("FAIL", "cf_fail")):
            rule = f'=LEFT({cell},{len(word)})="{word}"'
            page.conditional_format(
                1, first, 1, last,
                {"type": "formula", "criteria": rule, "format": self.style(style)},
            )  # fmt: skip

    def _strip(self) -> str:
        """What the strip shows, for its cached value."""
        document, revision, tag, title = (
            str(self.example.scalars.get(name, ""))
            for name in ("Document", "Revision", "Tag", "Title")
        )
        gap = "   " if tag and title else ""
        return f"Document {document or '-'}   Rev. {revision or '-'}   {tag}{gap}{title}"

    def _print_set_up(self, page: Any, sheet: Sheet) -> None:
        page.set_landscape()
        page.set_paper(_LETTER if self.system == "us" else _A4)
        page.set_margins(left=sheet.side, right=sheet.side, top=0.45, bottom=0.6)
        page.set_footer('&L&"Arial"&8&F&C&"Arial"&8&A&R&"Arial"&8Page &P of &N', {"margin": 0.3})
        page.repeat_rows(0, sheet.header_rows - 1)
        if sheet.breaks or sheet.row_breaks:
            page.set_v_pagebreaks([_column(letters) for letters in sheet.breaks])
            page.set_print_scale(_print_scale(sheet, _PAPER[self.system]))
            page.print_across()
            if sheet.row_breaks:
                page.set_h_pagebreaks([row - 1 for row in sheet.row_breaks])
        else:
            page.fit_to_pages(1, 1 if sheet.one_page else 0)
        if sheet.repeated:
            page.repeat_columns(sheet.repeated)
        if sheet.printed or sheet.breaks or sheet.row_breaks:
            page.print_area(f"A1:{sheet.printed or sheet.last}{_LAST_ROW}")

    # -- functions in cells ------------------------------------------------------------------------

    def _live(self, answers: LiveAnswers | None) -> None:
        """Sheet `Live`."""
        rows, columns = zip(*self.scalar_cells, strict=True)
        first = xl_rowcol_to_cell(min(rows), min(columns), True, True)
        last = xl_rowcol_to_cell(max(rows), max(columns), True, True)
        live = LiveSheet(
            self.workbook,
            self.sheets[LIVE_SHEET.name],
            self.style,
            self.variant,
            self.places,
            f"{fields.SCALAR_SHEET}!{first}:{last}",
            self.system,
            answers,
        )
        live.write()
        for area in live.verdict_areas:
            self._colours(LIVE_SHEET.name, *area)

    # -- tables ------------------------------------------------------------------------------------

    def _table(self, sheet: Sheet, spec: TableSpec, row: int, left: int) -> None:
        """Caption, units row, header and data of a table, with drop-downs and prompts."""
        page = self.sheets[sheet.name]
        columns = spec.workbook_columns
        self._caption(page, row, left, spec)
        has_units = any(field.has_unit for field in columns)
        header = row + (2 if has_units else 1)
        is_input = spec in fields.EVERY_INPUT
        rows = list(self._typed_rows(spec)) if is_input else []
        first, last = header + 1, header + max(spec.rows, len(rows))
        self.places[spec.name] = Place(
            sheet.name, first, last, {field.name: left + k for k, field in enumerate(columns)}
        )
        # A row among those of a table beside it, which began above, stays low where its words allow that.
        begun = [xl_cell_to_rowcol(cell) for cell in sheet.tables.values()]
        is_beside = any(above < row and column != left for above, column in begun)
        if not is_beside or max(len(field.name) for field in columns) > _SHORT_HEADER:
            page.set_row(header, 38 if has_units else 24)
        page.add_table(
            header,
            left,
            last,
            left + len(columns) - 1,
            {
                "name": spec.name,
                "style": None,
                "autofilter": spec.filtered,
                "columns": [self._column_options(spec, field, is_input) for field in columns],
            },
        )
        for k, field in enumerate(columns):
            if field.trace is not None:
                page.data_validation(header, left + k, header, left + k, _trace_prompt(field))
            if has_units:
                self._unit_cell(page, spec, field, header - 1, left + k)
            self._column_cells(page, spec, field, rows, first, last, left + k)

    def _typed_rows(self, spec: TableSpec) -> Sequence[Mapping[str, Any]]:
        """Rows of an example; every workbook is shipped with the names of the effects."""
        if spec.name == "EffectChoices":
            chosen = {row["Effect"]: row for row in self.example.tables.get(spec.name, ())}
            return [chosen.get(name, {"Effect": name}) for name in EFFECTS]
        return self.example.tables.get(spec.name, ())

    def _caption(self, page: Any, row: int, left: int, spec: TableSpec) -> None:
        caption, note = self.style("caption"), self.style("note")
        if spec.short_caption:  # another table stands close by
            page.write_string(row, left, spec.caption, caption)
            return
        page.write_rich_string(
            row, left, caption, spec.caption, note, f"   {spec.help}", self.style("plain")
        )

    def _column_options(self, spec: TableSpec, field: Field, is_input: bool) -> dict[str, Any]:
        kind = "input" if is_input else "check" if field in spec.extra_columns else "result"
        options: dict[str, Any] = {
            "header": field.name,
            "header_format": self.style(f"header_{kind}"),
            "format": self._cell_style(spec, field, is_input),
        }
        return options | ({"formula": field.formula} if field.formula else {})

    def _cell_style(self, spec: TableSpec, field: Field, is_input: bool) -> Any:
        if is_input:
            return self.style("input" if field.is_number else "input_text")
        if field.width:
            return self.style("result_wrap")
        if field.kind == "verdict":
            return self.style("verdict")
        if field in spec.extra_columns:
            return self.style("check", field.format)
        if field.kind == "mixed":
            return self.style("result_mixed")
        if field.kind in ("integer", "flag", "switch"):
            return self.style("result_center")
        if field.is_number:
            return self.style("result", field.format)
        return self.style("result_text")

    def _unit_cell(self, page: Any, spec: TableSpec, field: Field, row: int, column: int) -> None:
        self.unit_cells[spec.name, field.name] = (
            f"'{page.get_name()}'!{xl_rowcol_to_cell(row, column, True, True)}"
        )
        if not field.has_unit:
            page.write_blank(row, column, None, self.style("no_unit"))
            return
        unit = self.example.units.get((spec.name, field.name), self._unit(field))
        if field in spec.extra_columns:
            page.write_string(row, column, unit, self.style("fixed_unit"))
            return
        page.write_string(row, column, unit, self.style("input_unit"))
        page.data_validation(row, column, row, column, _unit_list(field))

    def _unit(self, field: Field) -> str:
        return str(getattr(field, f"unit_{self.system}"))

    def _column_cells(
        self,
        page: Any,
        spec: TableSpec,
        field: Field,
        rows: Sequence[Mapping[str, Any]],
        first: int,
        last: int,
        column: int,
    ) -> None:
        is_input = spec in fields.EVERY_INPUT
        style = self._cell_style(spec, field, is_input)
        formula = field.formula
        for k, row in enumerate(range(first, last + 1)):
            value = rows[k].get(field.name) if k < len(rows) else None
            if formula:
                page.write_formula(row, column, formula, style, "")
            elif value is None:
                page.write_blank(row, column, None, style)
            elif isinstance(value, str):
                page.write_string(row, column, value, style)
            else:
                page.write_number(row, column, value, style)
        if is_input:
            page.data_validation(first, column, last, column, _input_rule(field))

    # -- the sheets with more than tables ----------------------------------------------------------

    def _case(self) -> None:
        """Scalars in two halves, each with its name, unit and what a blank means."""
        page = self.sheets["Case"]
        page.ignore_errors({"number_stored_as_text": "C6:C13"})
        for letter, groups in CASE_HALVES:
            row, left = 4, _column(letter)
            for group in groups:
                members = [f for f in fields.SCALARS if f.group == group]
                row = self._scalars(page, group, members, row, left)

    def _scalars(self, page: Any, group: str, members: list[Field], row: int, left: int) -> int:
        """A group of scalars under its heading; the row where the next one begins."""
        for column in range(left, left + 4):
            page.write_blank(row, column, None, self.style("group"))
        page.write_string(row, left, group, self.style("group"))
        for k, field in enumerate(members, row + 1):
            self._scalar(page, field, k, left)
        return row + len(members) + 2

    def _scalar(self, page: Any, field: Field, row: int, left: int) -> None:
        page.write_string(row, left, _in_words(field.name), self.style("label"))
        value = self.example.scalars.get(field.name)
        if field.name == "TemplateVersion":
            value = fields.TEMPLATE_VERSION
        is_wide = field.group == "Document"  # room for long titles
        style = self.style(
            "input" if field.is_number else "input_wide" if is_wide else "input_text"
        )
        if value is None:
            page.write_blank(row, left + 1, None, style)
        elif field.is_number:
            page.write_number(row, left + 1, value, style)
        else:
            page.write_string(row, left + 1, str(value), style)
        page.data_validation(row, left + 1, row, left + 1, _input_rule(field))
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
            page.data_validation(row, left + 2, row, left + 2, _unit_list(field))
        else:
            page.write_blank(row, left + 2, None, self.style("no_unit"))
        page.write_string(row, left + 3, _hint(field), self.style("hint"))

    def _summary(self) -> None:
        page = self.sheets["Summary"]
        for row, height in ((2, 5), (7, 5), (8, 24), (9, 5), (11, 24)):
            page.set_row(row, height)
        for label, begin, end, words, name in TITLE_BLOCK:
            page.write_string(label, words, self.style("title_label"))
            style, value = self.style("title_value"), self._scalar_text(name)
            if begin != end:
                page.merge_range(f"{begin}:{end}", "", style)
            page.write_formula(begin, BLANK_TEXT.format(name), style, value)
        banner = self.style("verdict_banner")
        page.merge_range("B9:L9", "", banner)
        page.write_formula("B9", OVERALL, banner, "NOT CALCULATED")
        self.workbook.define_name("OverallVerdict", "=Summary!$B$9")
        page.write_string("B11", "The train", self.style("caption"))
        self._speed_legend(page, 24)
        self._key_numbers(page, 26)

    def _scalar_text(self, name: str) -> Any:
        """Cached value of a title block cell."""
        if name.startswith("run_"):
            return _NOT_YET if name == "run_Stamp" else ""
        return self.example.scalars.get(name, "")

    def _speed_legend(self, page: Any, row: int) -> None:
        """The speeds of the drawing in their colours, and what the sizes mean."""
        labels = {str(key): str(text) for key, text in self.blocks["ChartLabels"]}
        for k in range(GROUPS):
            key = f"Speed group {k + 1}"
            cell = f"ChartData!$B${self._label_row(key)}"
            style = self.workbook.add_format(
                {"font_name": "Arial", "font_size": 9, "bold": True, "align": "center",
                 "font_color": SPEED_GROUPS[k][0]}
            )  # fmt: skip
            text = labels[key]
            page.write_formula(
                row,
                1 + k,
                f'=IF(TRIM({cell})="","","■ "&{cell})',
                style,
                f"■ {text}" if text.strip() else "",
            )
        page.write_string(
            row + 1,
            1,
            "Discs: height ∝ inertia^¼; shafts (pale): ∝ stiffness^¼, each at its own speed; "
            "gold: gear mesh.",
            self.style("note"),
        )

    def _label_row(self, key: str) -> int:
        """Row of a word in `ChartLabels`, counted from 1."""
        return self.places["ChartLabels"].first + LABELS.index(key) + 1

    def _key_numbers(self, page: Any, row: int) -> None:
        page.write_string(row, 1, "Key numbers", self.style("caption"))
        for k, (label, formula, unit, where, number) in enumerate(KEY_NUMBERS, row + 1):
            page.write_string(k, 1, label, self.style("key_label"))
            page.write_formula(k, 2, formula, self.style("key_value", number), "")
            unit_style, where_style = self.style("key_unit"), self.style("key_unit")
            if "[" in unit:
                table, column = unit.rstrip("]").split("[")
                cell = self.unit_cells[table, column]
                text = self._unit(_spec(table).column(column))
                page.write_formula(k, 3, f'=IF({cell}="","",{cell})', unit_style, text)
            else:
                page.write_string(k, 3, unit, unit_style)
            page.merge_range(k, 4, k, 5, "", where_style)
            if where:
                page.write_formula(k, 4, where, where_style, "")

    def _chosen_elements(self) -> None:
        """Cells in which the engineer may name the element of each history chart."""
        page = self.sheets["Histories"]
        for number, chart in enumerate(HISTORY_CHARTS, 1):
            row, column = xl_cell_to_rowcol(chart.cell)
            row -= 1
            page.write_string(row, column, "Element to draw", self.style("label"))
            page.merge_range(row, column + 1, row, column + 2, "", self.style("input_text"))
            page.data_validation(
                row, column + 1, row, column + 1,
                {
                    "validate": "list", "source": "=ElementNames", "show_error": False,
                    "input_title": "Element of this chart",
                    "input_message": "Blank = chosen by torsionbook. It is drawn at the next "
                    "recalculation; what is drawn now stands at the right.",
                },
            )  # fmt: skip
            key = f"History caption {number}"
            words = self.style("drawn")
            page.merge_range(row, column + 3, row, column + 5, "", words)
            text = str(self.blocks["ChartLabels"][LABELS.index(key)][1] or "")
            drawn = f"=ChartData!$B${self._label_row(key)}"
            page.write_formula(row, column + 3, drawn, words, text)
            cell = xl_rowcol_to_cell(row, column + 1, True, True)
            self.workbook.define_name(plot_name(number), f"=Histories!{cell}")

    def _frequencies_note(self) -> None:
        self.sheets["Frequencies"].write_string(
            3,
            10,
            f"Mode shapes of the first {SHAPE_COLUMNS} elastic modes; further modes are in the "
            "JSON results.",
            self.style("note"),
        )

    def _cycle_facts(self) -> None:
        """Data of the governing shaft and the sum over its cycles, above table `StartCycles`."""
        page = self.sheets["Starts"]
        row, left = xl_cell_to_rowcol(CYCLE_FACTS_AT)
        page.write_string(row, left, "From the cycles to 1 / q", self.style("caption"))
        for k, (label, formula, unit, number) in enumerate(CYCLE_FACTS, row + 1):
            page.merge_range(k, left, k, left + 2, label, self.style("key_label"))
            value = self.style("check_value", number)
            page.merge_range(k, left + 3, k, left + 4, "", value)
            page.write_formula(k, left + 3, formula, value, "")
            if not unit:
                page.write_blank(k, left + 5, None, self.style("key_unit"))
                continue
            table, column = unit.rstrip("]").split("[")
            cell = self.unit_cells[table, column]
            text = self.example.units.get((table, column), self._unit(_spec(table).column(column)))
            page.write_formula(
                k, left + 5, f'=IF({cell}="","",{cell})', self.style("key_unit"), text
            )

    def _fact_lines(self) -> None:
        """Lines of words that the calculation writes into `RunFacts`."""
        for sheet, first, last, formula, style, height in FACT_LINES:
            page, shown = self.sheets[sheet], self.style(style)
            page.merge_range(f"{first}:{last}", "", shown)
            page.write_formula(first, formula, shown, "")
            page.set_row(xl_cell_to_rowcol(first)[0], height)

    def _sheet_notes(self) -> None:
        """How to read the sheets `Reversals` and `Effects`, and what the effects on `Case` are."""
        page = self.sheets["Reversals"]
        row, left = xl_cell_to_rowcol(REVERSAL_NOTES_AT)
        page.write_string(row, left, "How to read this sheet", self.style("caption"))
        for k, (term, text) in enumerate(REVERSAL_NOTES, row + 1):
            page.write_string(k, left, term, self.style("prose_bold"))
            page.merge_range(k, left + 1, k, left + 15, "", self.style("prose"))
            if text == CONTACT_LAW[0]:
                page.write_formula(k, left + 1, text, self.style("prose"), CONTACT_LAW[1])
            else:
                page.write_string(k, left + 1, text, self.style("prose"))
            page.set_row(k, text_height(text, _REVERSAL_NOTES_WIDTH))
        row, left = xl_cell_to_rowcol(EFFECT_NOTES_AT)
        for k, text in enumerate(EFFECT_NOTES, row + 1):
            self.sheets["Effects"].write_string(k, left, text, self.style("note"))
        choices = self.places["EffectChoices"]
        for k, effect in enumerate(EFFECTS.values(), choices.first):
            self.sheets[choices.sheet].write_string(
                k, choices.columns["Choice"] + 1, effect.sentence, self.style("note_beside")
            )

    def _study_lines(self) -> None:
        """On each result sheet of a study what it found, and which inputs it belongs to."""
        for study in STUDIES:
            for sheet, last in ((study.sheet, study.last), *study.also):
                page = self.sheets[sheet]
                for row, (formula, style, height) in enumerate(study.lines, 3):
                    first = _column(study.first)
                    page.merge_range(row, first, row, _column(last), "", self.style(style))
                    shown = study.not_yet if row == 3 else ""
                    page.write_formula(row, first, formula, self.style(style), shown)
                    page.set_row(row, height)
            self._colour_verdicts(study.results)
        for study in STUDIES:
            for scale in study.scales:
                self._scale(scale)

    def _scale(self, scale: StudyScale) -> None:
        """Colours of a map: by size, or against the limit in the same row."""
        place = self.places[scale.table]
        judged = self.places[scale.over or scale.table]
        left, right = place.columns[scale.first], place.columns[scale.last]
        area = (place.first, left, place.last, right)
        page = self.sheets[place.sheet]
        cell = xl_rowcol_to_cell(judged.first, judged.columns[scale.first])
        limit = xl_rowcol_to_cell(judged.first, judged.columns[scale.limit], col_abs=True)

        def against(sign: str, style: Any) -> dict[str, Any]:
            rule = f"=AND(ISNUMBER({cell}),{cell}{sign}{limit})"
            return {"type": "formula", "criteria": rule, "format": style}

        if not scale.over:
            page.conditional_format(*area, against("<", self.style("cf_fail")))
            page.conditional_format(*area, against(">=", self.style("cf_pass")))
            return
        pale = self.workbook.add_format({"italic": True, "font_color": "#8A8A8A"})
        page.conditional_format(*area, against("<", pale))
        self._colours(place.sheet, *area)
        good = {"type": "cell", "criteria": "==", "value": '"unlimited"'}
        page.conditional_format(*area, good | {"format": self.style("cf_pass")})
        page.conditional_format(*area, dict(COLOUR_SCALE))

    def _change_cell(self) -> None:
        """The change whose shifts of frequency are shown: typed above table `EnergyShares`."""
        place = self.places["EnergyShares"]
        page, left = self.sheets[place.sheet], place.columns["Quantity"]
        row = place.first - 5
        page.write_string(row, left, "Change", self.style("key_label"))
        page.write_number(row, left + 1, 0.01, self.style("input", "0.0%"))
        words = "of one stiffness or inertia at a time; type another"
        page.write_string(row, left + 2, words, self.style("note_beside"))
        cell = xl_rowcol_to_cell(row, left + 1, True, True)
        self.workbook.define_name(CHANGE_NAME, f"='{place.sheet}'!{cell}")
        if self.studies:
            place = self.places["FrequencySensitivities"]
            page, left = self.sheets[place.sheet], place.columns["Quantity"]
            page.write_string(4, left, "Change of the quantity", self.style("note"))
            page.write_formula(4, left + 1, f"={CHANGE_NAME}", self.style("check", "0.0%"), 0.01)
            link = self.style("note_beside")
            page.write_url(
                4, left + 2, f"internal:'Frequencies'!{cell}", link, "typed on sheet Frequencies"
            )

    def _verdict_colours(self) -> None:
        """Pass green, accepted amber, fail red, not judged grey, wherever a verdict stands."""
        self._colour_verdicts(fields.RESULT_TABLES)
        self._colours("Summary", 8, 1, 8, 11)
        place = self.places["Effects"]
        column = place.columns["On"]
        for word, style in (("on", "cf_pass"), ("off", "cf_open")):
            self.sheets[place.sheet].conditional_format(
                place.first, column, place.last, column,
                {"type": "cell", "criteria": "==", "value": f'"{word}"',
                 "format": self.style(style)},
            )  # fmt: skip

    def _colour_verdicts(self, specs: Sequence[TableSpec]) -> None:
        for spec in specs:
            place = self.places[spec.name]
            for field in spec.columns:
                if field.kind == "verdict":
                    at = place.columns[field.name]
                    self._colours(place.sheet, place.first, at, place.last, at)

    def _colours(self, sheet: str, *area: int) -> None:
        for criteria, words, style in (
            ("begins with", "pass", "cf_pass"),
            ("begins with", "accepted", "cf_accepted"),
            ("begins with", "fail", "cf_fail"),
            ("begins with", "unbounded", "cf_fail"),
            ("begins with", "not judged", "cf_open"),
        ):
            self.sheets[sheet].conditional_format(
                *area,
                {"type": "text", "criteria": criteria, "value": words, "format": self.style(style)},
            )

    def _notes(self) -> None:
        """Legend, how to use, equations and, in an example, where its numbers come from."""
        page = self.sheets["Notes"]
        row = self._legend(page, 3)
        blocks = dict(NOTES)
        if self.provenance:
            blocks = {"Provenance of this example": self.provenance} | blocks
        for heading, lines in blocks.items():
            self._heading(page, row, heading)
            for k, (term, text) in enumerate(lines, row + 1):
                page.write_string(k, 1, term, self.style("prose_bold"))
                page.write_string(k, 2, text, self.style("prose"))
                page.set_row(k, text_height(text, NOTES_WIDTH))
            row += len(lines) + 2

    def _trace(self) -> None:
        """Equation, source and inputs of every result column, from the table of fields."""
        page, head = self.sheets["Trace"], 4
        for k, header in enumerate(TRACE_HEADERS, 1):
            page.write_string(head, k, header, self.style("header_result"))
        styles = ["prose_bold"] * 3 + ["prose"] * 5
        widths = (13.0, 24.0, 22.0, 38.0, 56.0, 42.0, 36.0, 40.0)
        rows = list(trace_rows(studies=self.studies))
        for row, texts in enumerate(rows, head + 1):
            for k, (text, style) in enumerate(zip(texts, styles, strict=True), 1):
                if text:
                    page.write_string(row, k, text, self.style(style))
            pairs = zip(texts, widths, strict=True)
            page.set_row(row, max(text_height(text, width) for text, width in pairs))
        page.autofilter(head, 1, head + len(rows), len(TRACE_HEADERS))
        row = head + len(rows) + 2
        page.merge_range(row, 1, row, 2, "Inputs that go together", self.style("group"))
        for k, (name, members) in enumerate(trace_groups(), row + 1):
            page.write_string(k, 2, name, self.style("prose_bold"))
            page.merge_range(k, 3, k, len(TRACE_HEADERS), members, self.style("prose"))
            page.set_row(k, text_height(members, sum(widths[2:])))

    def _heading(self, page: Any, row: int, words: str) -> None:
        page.write_string(row, 1, words, self.style("group"))
        page.write_blank(row, 2, None, self.style("group"))

    def _legend(self, page: Any, row: int) -> int:
        """What the colours mean; the row at which the next block begins."""
        self._heading(page, row, "Colours")
        for k, (style, sample, words) in enumerate(
            (
                ("input", "1 234.5", "Typed by the engineer: inputs and the units they are in."),
                ("result", "1 234.5", "Written by torsionbook; typed values are lost at the next "
                 "recalculation."),
                ("check", "1 234.5", "Live formula beside the engine's number, for the reviewer."),
            ),
            row + 1,
        ):  # fmt: skip
            page.write_string(k, 1, sample, self.style(style))
            page.write_string(k, 2, words, self.style("prose_beside"))
        return k + 2

    def _lists(self) -> None:
        """Hidden: names behind the drop-downs and the facts that live formulas need."""
        page = self.sheets["Lists"]
        page.hide()
        page.set_column("A:D", 28)
        page.set_column("E:G", 42)
        lists = (
            ("StationNames", "Stations", "Station", ("ground",)),
            ("ElementNames", "Elements", "Element", ()),
            ("MaterialNames", "Materials", "Material", ()),
        )
        for column, (name, table, header, fixed) in enumerate(lists):
            page.write_string(0, column, name, self.style("caption"))
            names = [str(row.get(header, "")) for row in self.example.tables.get(table, ())]
            for k in range(_LISTED):
                self._listed(page, k, column, f"{table}[{header}]", fixed, names)
            letter = xl_col_to_name(column)
            self.workbook.define_name(name, f"=Lists!${letter}$2:${letter}${_LISTED + 1}")
        self._run_facts(page, 4)
        if self.studies:
            self._facts(page, 8, "StudyFacts", STUDY_FACTS, {})

    def _listed(
        self,
        page: Any,
        k: int,
        column: int,
        source: str,
        fixed: tuple[str, ...],
        names: Sequence[str],
    ) -> None:
        if k < len(fixed):
            page.write_string(k + 1, column, fixed[k], self.style("plain"))
            return
        index = k - len(fixed)
        page.write_formula(
            k + 1,
            column,
            f'=IFERROR(INDEX({source},{index + 1})&"","")',
            self.style("plain"),
            names[index] if index < len(names) else "",
        )

    def _run_facts(self, page: Any, left: int) -> None:
        page.write_string(0, left, "Written by the calculation", self.style("caption"))
        self._facts(page, left, "RunFacts", RUN_FACTS, {"run_Stamp": _NOT_YET})

    def _facts(
        self,
        page: Any,
        left: int,
        table: str,
        facts: Sequence[tuple[str, str]],
        shipped: Mapping[str, str],
    ) -> None:
        """A table of names, meanings and values, each value with its defined name."""
        columns = {"Name": left, "Meaning": left + 1, "Value": left + 2}
        last = 1 + len(facts)
        page.add_table(
            1, left, last, left + 2,
            {"name": table, "style": None, "autofilter": False,
             "columns": [{"header": name} for name in columns]},
        )  # fmt: skip
        self.places[table] = Place("Lists", 2, last, columns)
        for row, (name, meaning) in enumerate(facts, 2):
            page.write_string(row, left, name, self.style("plain"))
            page.write_string(row, left + 1, meaning, self.style("plain"))
            if name in shipped:
                page.write_string(row, left + 2, shipped[name], self.style("plain"))
            cell = xl_rowcol_to_cell(row, left + 2, True, True)
            self.workbook.define_name(name, f"=Lists!{cell}")

    def _chart_data(self) -> None:
        """Hidden: one Excel table a chart, side by side, so that each may grow."""
        page = self.sheets["ChartData"]
        page.hide()
        page.write_string(0, 0, "Data behind the charts, rewritten by every calculation",
                          self.style("caption"))  # fmt: skip
        left = 0
        for table in CHART_TABLES:
            rows = self.blocks[table.name]
            last = 3 + len(rows)
            width = len(table.columns)
            page.write_string(2, left, table.help, self.style("note"))
            page.add_table(
                3, left, last, left + width - 1,
                {"name": table.name, "style": None, "autofilter": False,
                 "columns": [{"header": name} for name in table.columns]},
            )  # fmt: skip
            for k, row in enumerate(rows, 4):
                for column, value in enumerate(row, left):
                    if value is not None:
                        page.write(k, column, value)
            self.places[table.name] = Place(
                "ChartData", 4, last, {name: left + k for k, name in enumerate(table.columns)}
            )
            left += width + 1


def _with_live(sheets: Sequence[Sheet]) -> list[Sheet]:
    """`Live` behind the last sheet of inputs."""
    last = max(k for k, sheet in enumerate(sheets) if sheet.kind == "input")
    return [*sheets[: last + 1], LIVE_SHEET, *sheets[last + 1 :]]


# --- small helpers --------------------------------------------------------------------------------


def _spec(name: str) -> TableSpec:
    return next(table for table in fields.EVERY_TABLE if table.name == name)


def _column(letters: str) -> int:
    return int(xl_cell_to_rowcol(f"{letters}1")[1])


def _widths(sheet: Sheet) -> dict[int, float]:
    """Width of each column of a sheet. [characters]"""
    widths: dict[int, float] = {}
    for columns, each in sheet.widths.items():
        begin, _, end = columns.partition(":")
        widths |= dict.fromkeys(range(_column(begin), _column(end or begin) + 1), each)
    return widths


def _print_scale(sheet: Sheet, paper: float) -> int:
    """Scale at which the widest page of a sheet fits a landscape paper so wide. [%]"""
    pixels = {k: math.trunc(7.0 * each + 5.0) for k, each in _widths(sheet).items()}
    begin, _, end = sheet.repeated.partition(":")
    repeated = range(_column(begin), _column(end) + 1) if sheet.repeated else range(0)
    edges = [0, *(_column(letters) for letters in sheet.breaks)]
    ends = [*edges[1:], _column(sheet.printed or sheet.last) + 1]
    widest = max(
        sum(pixels[k] for k in {*range(first, end), *(repeated if first else ())})
        for first, end in zip(edges, ends, strict=True)
    )
    room = 96.0 * (paper - 2.0 * sheet.side)
    return min(sheet.largest, math.floor(100.0 * _PRINT_SLACK * room / widest))


def _begin_of(sheet: Sheet, width: float) -> int:
    """First of the last columns of a sheet that together are at least so wide. [characters]"""
    widths = _widths(sheet)
    column = last = _column(sheet.last)
    while column > 2 and (
        column == last or sum(widths[k] for k in range(column, last + 1)) < width
    ):
        column -= 1
    return column


def _in_words(name: str) -> str:
    """``RatedPower`` → ``Rated power``."""
    words = re.findall(r"[A-Z]+(?=[A-Z][a-z])|[A-Z]?[a-z]+|[A-Z]+|\d+", name)
    return " ".join([words[0], *(word.lower() for word in words[1:])])


def _hint(field: Field) -> str:
    return f"blank = {field.default_text}" if field.default_text else ""


def _prompt(field: Field) -> dict[str, str]:
    """The input prompt: Excel shows at most 32 and 255 characters."""
    words = [field.help]
    if field.default_text:
        words.append(f"Blank = {field.default_text}.")
    return {"input_title": field.name[:32], "input_message": " ".join(words)[:_LONGEST_PROMPT]}


def _trace_prompt(field: Field) -> dict[str, Any]:
    """Equation and source of a result behind its header, as far as there is room for them."""
    assert field.trace is not None
    words = f"{field.trace.equation}\n{field.trace.source}\nSheet Trace: what it comes from."
    if len(words) > _LONGEST_PROMPT:
        words = f"{words[: _LONGEST_PROMPT - 1]}…"
    return {"validate": "any", "input_title": field.name[:32], "input_message": words}


#: Dimensions whose numbers may be negative.
_SIGNED = frozenset({"torque", "excitation torque", "angle"})
_NAME_LISTS = {"station": "StationNames", "element": "ElementNames", "material": "MaterialNames"}


def _input_rule(field: Field) -> dict[str, Any]:
    """Drop-down, number rule or prompt alone, as the field asks for."""
    prompt = _prompt(field)
    if field.kind == "choice":
        return prompt | {
            "validate": "list",
            "source": list(field.choices),
            "error_title": field.name[:32],
            "error_message": f"Choose one of: {', '.join(field.choices)}."[:255],
        }
    if field.kind in _NAME_LISTS:
        return prompt | {
            "validate": "list",
            "source": f"={_NAME_LISTS[field.kind]}",
            "error_type": "warning",
            "error_title": "Unknown name",
            "error_message": "There is no row of that name yet. Keep it anyway?",
        }
    if not field.is_number:
        return prompt | {"validate": "any"}
    kind = "integer" if field.kind == "integer" else "decimal"
    low, high = (-1e300, 1e300) if field.dimension in _SIGNED else (0, 1e300)
    if kind == "integer":
        low, high = 0, 100000
    asked = "A whole number" if kind == "integer" else "A number"
    asked += " of zero or more" if low == 0 else ""
    return prompt | {
        "validate": kind,
        "criteria": "between",
        "minimum": low,
        "maximum": high,
        "error_title": "Not a number that fits",
        "error_message": f"{asked} is needed; its unit stands in the unit cell.",
    }


def _unit_list(field: Field) -> dict[str, Any]:
    """Drop-down of the usual units; any other of the right dimension may be typed."""
    return {
        "validate": "list",
        "source": list(field.units),
        "show_error": False,
        "input_title": "Unit",
        "input_message": "Choose a unit, or type another of the same dimension. The numbers are "
        "read in it; they are not converted.",
    }


def main(arguments: Sequence[str] | None = None) -> int:
    """Build the shipped workbooks into a folder."""
    parser = argparse.ArgumentParser(
        prog="python -m addin.template.build", description=main.__doc__
    )
    parser.add_argument("folder", type=Path, help="where the workbooks go")
    build_all(parser.parse_args(arguments).folder)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
