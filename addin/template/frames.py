"""Frame of every sheet: widths, banner, strip, print set-up; and the colours of verdicts."""

from __future__ import annotations

import itertools
import math
import re
from collections.abc import Mapping, Sequence
from typing import Any

from xlsxwriter.utility import xl_cell_to_rowcol, xl_rowcol_to_cell

from addin.charts.rows import Rows
from addin.contract import tables as fields
from addin.contract.banner import CHANGED_WORDS, DOCUMENT_AT, OVERALL_AT
from addin.contract.chart_tables import CHART_TABLES
from addin.contract.print_areas import Standing, areas_of_parts, holds_data, print_area_text
from addin.contract.sheet import NARROW, NEVER, Sheet
from addin.contract.sheets import KIND_WORDS, STRIP, TAB_COLOURS
from addin.contract.studies.registry import EVERY_CHART
from addin.template.charts import Place
from addin.template.examples import Example
from addin.template.styles import USUAL, Styles
from addin.template.variants import Variant

_LETTER, _A4 = 1, 9
#: Width of the paper on its side. [in]
_PAPER = {"us": 11.0, "si": 11.69}
#: Margin left and right of a printed page. [in]
_SIDE = 0.25
#: Programs measure columns a little differently. [1]
_PRINT_SLACK = 0.94
#: Room of the overall verdict at the left end of the strip, where nobody has to scroll. [characters]
_VERDICT_WIDTH = 46.0
#: A name of a fact in a formula.
_FACT = re.compile(r"\b[a-z]+_[A-Za-z0-9]+\b")
_INPUTS = frozenset(spec.name for spec in fields.EVERY_INPUT)
_CHART_COLUMNS = {table.name: table.columns for table in CHART_TABLES}


class Frames:
    """Sheets with their frames, and what every part of the builder needs."""

    def __init__(
        self,
        workbook: Any,
        system: str,
        example: Example,
        blocks: Mapping[str, Rows],
        *,
        variant: Variant,
        studies: bool = False,
    ) -> None:
        self.workbook = workbook
        self.system = system
        self.example = example
        self.blocks = blocks
        self.style = Styles(workbook)
        self.places: dict[str, Place] = {}
        self.unit_cells: dict[tuple[str, str], str] = {}
        self.sheets: dict[str, Any] = {}
        self.parts: Sequence[Sheet] = ()  #: Of the sheets, the live one apart.
        self.variant = variant
        self.studies = studies
        self.scalar_cells: list[tuple[int, int]] = []
        self.fact_cells: dict[str, str] = {}
        self.header_heights: dict[tuple[str, int], float] = {}  #: Of headers side by side. [point]

    def _frame(self, sheet: Sheet) -> None:
        """Column widths, banner, strip, freezing and print set-up of a sheet."""
        page = self.page(sheet)
        self.style.of(sheet)
        for columns, width in sheet.widths.items():
            columns = sheet.at(columns)
            page.set_column(columns if ":" in columns else f"{columns}:{columns}", width)
        self._banner(page, sheet)
        if sheet.intro:
            page.write_string(sheet.at("B3"), sheet.intro, self.style("note"))
        if sheet.shift:  # the first part has made the frame of the sheet
            return
        page.hide_gridlines(2)
        if sheet.hidden:
            page.hide()
        page.set_tab_color(TAB_COLOURS[sheet.kind])
        if self.has_parts(sheet):
            page.set_default_row(sheet.row_height)
        page.set_row(0, 24)
        page.set_row(1, 16.5)
        if sheet.freeze:
            page.freeze_panes(*xl_cell_to_rowcol(sheet.freeze))
        self._print_set_up(page, sheet)

    def page(self, part: Sheet) -> Any:
        """The sheet under construction on which a part stands."""
        return self.sheets[part.worksheet]

    def _banner(self, page: Any, sheet: Sheet) -> None:
        """Title and kind of the sheet, then overall verdict and document."""
        begin, last = sheet.shift + 1, column_number(sheet.at(sheet.last))
        for column in range(begin, last + 1):
            page.write_blank(0, column, None, self.style("banner"))
            page.write_blank(1, column, None, self.style("strip"))
        if sheet.name == "Summary":
            title = "Torsional start-up analysis of a synchronous-motor train"
            page.write_string(0, 1, title, self.style("banner"))
            software = '=IF(run_Software="","torsionbook",run_Software)'
            page.write_formula(0, last, software, self.style("banner_right"), "torsionbook")
            page.merge_range(1, 1, 1, last, "", self.style("strip"))
            page.write_formula(1, 1, STRIP, self.style("strip"), self._strip())
            return
        page.write_string(0, begin, sheet.name, self.style("banner"))
        page.write_string(0, last, KIND_WORDS[sheet.kind], self.style("banner_right"))
        end = sheet.shift + end_of_first(
            sheet, _VERDICT_WIDTH * sheet.letters * (NARROW if sheet.narrow else 1.0) / USUAL
        )
        page_end = column_number(sheet.at(sheet.breaks[0])) - 1 if sheet.breaks else last
        for first, final, at, style, shown in (
            (begin, end, OVERALL_AT, "strip_verdict", "NOT CALCULATED"),
            (end + 1, page_end, DOCUMENT_AT, "strip", self._strip()),
        ):
            if first < final:
                page.merge_range(1, first, 1, final, "", self.style(style))
            page.write_formula(1, first, f"={at}", self.style(style), shown)
        cell = xl_rowcol_to_cell(1, begin, True, True)
        for word, style in (
            ("PASS", "cf_pass"), ("ACCEPTED", "cf_accepted"), ("FAIL", "cf_fail"),
            (CHANGED_WORDS, "cf_fail"),
        ):  # fmt: skip
            rule = f'=LEFT({cell},{len(word)})="{word}"'
            page.conditional_format(
                1, begin, 1, end,
                {"type": "formula", "criteria": rule, "format": self.style(style)},
            )  # fmt: skip

    def has_parts(self, sheet: Sheet) -> bool:
        """Whether its tables may stand beside those of other parts."""
        return any(part.worksheet == sheet.worksheet for part in self.parts)

    def _strip(self) -> str:
        """What the strip shows, for its cached value."""
        document, revision, tag, title = (
            str(self.example.scalars.get(name, ""))
            for name in ("Document", "Revision", "Tag", "Title")
        )
        gap = "   " if tag and title else ""
        return f"Document {document or '-'}   Rev. {revision or '-'}   {tag}{gap}{title}"

    def _print_set_up(self, page: Any, sheet: Sheet) -> None:
        """Paper, margins, footer, repeated rows and scale; `_print_areas` says what is printed."""
        page.set_landscape()
        page.set_paper(_LETTER if self.system == "us" else _A4)
        page.set_margins(left=_SIDE, right=_SIDE, top=0.25, bottom=0.3)
        page.set_footer(
            '&L&"Arial"&12&F&C&"Arial"&12&A&R&"Arial"&12Page &P of &N', {"margin": 0.12}
        )
        page.repeat_rows(0, sheet.header_rows - 1)
        parts = [part for part in self.parts if part.worksheet == sheet.worksheet]
        if not parts:
            page.fit_to_pages(1, 0)
            return
        printed = [part for part in parts if part.printed_for != NEVER] or parts
        widths = [_page_width(part) for part in printed]
        widths += [
            _page_width(left) + _page_width(part)
            for left, part in itertools.pairwise(parts)
            if part.joins
        ]
        largest = min(part.largest for part in printed)
        page.set_print_scale(_scale_of(max(widths), _PAPER[self.system], largest))
        if sheet.repeated:
            page.repeat_columns(sheet.repeated)

    def _print_areas(self) -> None:
        """What is printed of the sheets, as far as the inputs tell."""
        for name in dict.fromkeys(part.worksheet for part in self.parts):
            parts = [part for part in self.parts if part.worksheet == name]
            if parts[0].hidden:
                continue
            areas = areas_of_parts(parts, lambda _: self._standing) or []
            self.sheets[name].print_area_range = print_area_text(name, areas)

    @property
    def _standing(self) -> Standing:
        return Standing(self._rows_of, self._filled_to, self._has_content, self._has_curve)

    def _has_curve(self, chart: str) -> bool:
        """Whether the inputs alone give a chart something to draw."""
        for series in EVERY_CHART[chart].series:
            rows, columns = self.blocks.get(series.table), _CHART_COLUMNS.get(series.table)
            if rows is None or columns is None:
                if series.table in _INPUTS:  # drawn as they are typed
                    return True
            elif any(isinstance(row[columns.index(series.y)], int | float) for row in rows):
                return True
        return False

    def _rows_of(self, table: str) -> tuple[int, int]:
        """Header row and last row of a table, counted from 1."""
        place = self.places[table]
        return place.first, place.last + 1

    def _filled_to(self, table: str) -> int:
        """Last row that an example fills of an input table, counted from 1; 0 = none."""
        rows = self.example.tables.get(table, ())
        filled = [k for k, row in enumerate(rows, 1) if any(row.values())]
        return self.places[table].first + filled[-1] if filled else 0

    def _has_content(self, table: str) -> bool:
        """Whether an example fills a table, or its inputs alone the data of a chart."""
        if table in self.blocks:
            return holds_data(self.blocks[table])
        return any(any(row.values()) for row in self.example.tables.get(table, ()))

    def _put(self, page: Any, row: int, column: int, value: Any, style: Any) -> None:
        """A number, words or a blank."""
        if value is None or value == "":
            page.write_blank(row, column, None, style)
        elif isinstance(value, str):
            page.write_string(row, column, value, style)
        else:
            page.write_number(row, column, value, style)

    def _worded_caption(self, page: Any, row: int, column: int, words: str, note: str) -> None:
        """Bold words and a note behind them, in one cell."""
        caption, pale, plain = (self.style(name) for name in ("caption", "note", "plain"))
        page.write_rich_string(row, column, caption, words, pale, f"   {note}", plain)

    def _by_cells(self, formula: str) -> str:
        """A formula that reads facts by their cells and not by their names."""
        return _FACT.sub(lambda fact: self.fact_cells.get(fact[0], fact[0]), formula)

    def _heading(self, page: Any, row: int, words: str) -> None:
        page.write_string(row, 1, words, self.style("group"))
        page.write_blank(row, 2, None, self.style("group"))

    def _colours(self, sheet: str, *area: int) -> None:
        for criteria, words, style in (
            ("begins with", "pass within", "cf_accepted"),
            ("begins with", "pass", "cf_pass"),
            ("begins with", "accepted", "cf_accepted"),
            ("begins with", "fail", "cf_fail"),
            ("begins with", "unbounded", "cf_fail"),
            ("begins with", "check", "cf_fail"),
            ("begins with", CHANGED_WORDS, "cf_fail"),
            ("begins with", "incomplete", "cf_open"),
            ("begins with", "not judged", "cf_open"),
        ):
            self.sheets[sheet].conditional_format(
                *area,
                {"type": "text", "criteria": criteria, "value": words, "format": self.style(style)},
            )


def column_number(letters: str) -> int:
    return int(xl_cell_to_rowcol(f"{letters}1")[1])


def column_widths(sheet: Sheet) -> dict[int, float]:
    """Width of each column of a sheet. [characters]"""
    widths: dict[int, float] = {}
    for columns, each in sheet.widths.items():
        begin, _, end = columns.partition(":")
        widths |= dict.fromkeys(range(column_number(begin), column_number(end or begin) + 1), each)
    return widths


def _scale_of(widest: int, paper: float, largest: int) -> int:
    """Scale at which so many pixels fit a paper so wide, at the most `largest`. [%]"""
    room = 96.0 * (paper - 2.0 * _SIDE)
    return min(largest, math.floor(100.0 * _PRINT_SLACK * room / widest))


def _page_width(sheet: Sheet) -> int:
    """Width of the widest page of a sheet or a part. [pixel]"""
    pixels = {k: math.trunc(7.0 * each + 5.0) for k, each in column_widths(sheet).items()}
    begin, _, end = sheet.repeated.partition(":")
    repeated = range(column_number(begin), column_number(end) + 1) if sheet.repeated else range(0)
    edges = [0, *(column_number(letters) for letters in sheet.breaks)]
    ends = [*edges[1:], column_number(sheet.last) + 1]
    return max(
        sum(pixels[k] for k in {*range(first, end), *(repeated if first else ())})
        for first, end in zip(edges, ends, strict=True)
    )


def end_of_first(sheet: Sheet, width: float) -> int:
    """Last of the first columns of a sheet that together are so wide, or of all but the last. [characters]"""
    widths, column = column_widths(sheet), 1
    while (
        column < column_number(sheet.last) - 1
        and sum(widths[k] for k in range(1, column + 1)) < width
    ):
        column += 1
    return column
