"""Sheets of words and hidden sheets: notes, trace, lists behind drop-downs, chart data."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from xlsxwriter.utility import xl_col_to_name, xl_rowcol_to_cell

from addin.contract.banner import CHANGED_CELL, COPY_SHEET
from addin.contract.chart_tables import CHART_TABLES
from addin.contract.input_copy import CHANGED_FORMULA, COPY_ROW, COPY_TABLES
from addin.contract.run_facts import RUN_FACTS
from addin.contract.sheet import NOTES_WIDTH, text_height
from addin.contract.studies.registry import STUDY_FACTS, STUDY_FACTS_SHEET
from addin.contract.texts import CONTACT_LAW, NOTES, TRACE_INTRO
from addin.contract.trace_table import TRACE_HEADERS, trace_groups, trace_rows
from addin.template.charts import Place
from addin.template.front_sheets import NOT_CALCULATED_YET
from addin.template.result_sheets import ResultSheets

#: Above the copy of the inputs.
COPY_CAPTION = "Copy of the inputs, written by every calculation: the banners compare the present inputs with it"
#: Last column over which the texts of sheet `Notes` run.
_LAST_OF_TEXT = 5
#: Rows of the lists behind the drop-downs.
_LISTED = 60


class ReferenceSheets(ResultSheets):
    """Notes, trace and hidden sheets."""

    def _notes(self) -> int:
        """Legend, how to use, equations and, in an example, where its numbers come from; the row below them."""
        page = self.sheets["Notes"]
        row = self._legend(page, 3)
        blocks = dict(NOTES)
        if self.example.provenance:
            blocks = {"Provenance of this example": self.example.provenance} | blocks
        for heading, lines in blocks.items():
            self._heading(page, row, heading)
            for k, (term, text) in enumerate(lines, row + 1):
                page.write_string(k, 1, term, self.style("prose_bold"))
                self._wide(page, k, text, "prose")
            row += len(lines) + 2
        return row

    def _wide(self, page: Any, row: int, text: str, style: str) -> None:
        """A text of sheet `Notes`, as wide as several columns of the trace below it."""
        page.merge_range(row, 2, row, _LAST_OF_TEXT, "", self.style(style))
        if text == CONTACT_LAW[0]:
            page.write_formula(row, 2, text, self.style(style), CONTACT_LAW[1])
        else:
            page.write_string(row, 2, text, self.style(style))
        page.set_row(row, text_height(text, NOTES_WIDTH))

    def _trace(self, row: int) -> None:
        """Equation, source and inputs of every result column, from the table of fields."""
        page = self.sheets["Notes"]
        self._heading(page, row, "Trace")
        self._wide(page, row + 1, TRACE_INTRO, "prose_beside")
        head = row + 3
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

    def _legend(self, page: Any, row: int) -> int:
        """What the colours mean; the row at which the next block begins."""
        self._heading(page, row, "Colours")
        for k, (style, sample, words) in enumerate(
            (
                ("input", "1 234.5", "Inputs typed by the engineer, with their units."),
                ("result", "1 234.5", "Results of torsionbook; the next recalculation overwrites typed "
                 "values."),
                ("check", "1 234.5", "Live formula next to the calculated number, for the reviewer."),
            ),
            row + 1,
        ):  # fmt: skip
            page.write_string(k, 1, sample, self.style(style))
            self._wide(page, k, words, "prose_beside")
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
        if self.studies:  # of its own, so that it can be added to a workbook with the first study
            page = self.sheets[STUDY_FACTS_SHEET]
            page.hide()
            page.set_column("A:C", 42)
            self._facts(page, 0, "StudyFacts", STUDY_FACTS, {})

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
        self._facts(page, left, "RunFacts", RUN_FACTS, {"run_Stamp": NOT_CALCULATED_YET})

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
        sheet = page.get_name()
        self.places[table] = Place(sheet, 2, last, columns)
        for row, (name, meaning) in enumerate(facts, 2):
            page.write_string(row, left, name, self.style("plain"))
            page.write_string(row, left + 1, meaning, self.style("plain"))
            if name in shipped:
                page.write_string(row, left + 2, shipped[name], self.style("plain"))
            cell = xl_rowcol_to_cell(row, left + 2, True, True)
            self.workbook.define_name(name, f"={sheet}!{cell}")
            self.fact_cells[name] = f"{sheet}!{cell}"

    def _input_copy(self) -> None:
        """Hidden: tables for the copy of the inputs, blank until there is a calculation."""
        page = self.sheets[COPY_SHEET]
        page.hide()
        page.set_column("A:Z", 18)
        page.write_string(0, 0, COPY_CAPTION, self.style("caption"))
        page.write_string(1, 0, "Any input changed since the calculation", self.style("plain"))
        page.write_formula(CHANGED_CELL, CHANGED_FORMULA, self.style("plain"), True)
        left = 0
        for name, columns in COPY_TABLES:
            last = left + len(columns) - 1
            page.write_string(COPY_ROW - 2, left, name, self.style("caption"))
            page.add_table(
                COPY_ROW - 1, left, COPY_ROW, last,
                {"name": name, "style": None, "autofilter": False,
                 "columns": [{"header": header} for header in columns]},
            )  # fmt: skip
            left = last + 2

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
