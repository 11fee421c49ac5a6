"""Builds the shipped workbooks from the one table of fields: ``python -m addin.template.build FOLDER``.

Sheets are described as data (`SHEETS`): which tables stand where, which charts beside them, how
wide the columns are. The builder knows how a scalar, an input table and a result table look and
nothing of what they mean. Dates are fixed, so that building twice gives the same bytes.
"""

from __future__ import annotations

import argparse
import datetime as dt
import io
import os
from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from xlsxwriter.utility import xl_cell_to_rowcol

from addin.charts.data import chart_blocks
from addin.charts.rows import Rows
from addin.contract import tables as fields
from addin.contract.banner import COPY_SHEET
from addin.contract.sheet import Sheet
from addin.contract.sheets import SHEETS
from addin.contract.shown_units import shown_units
from addin.contract.studies.registry import EVERY_CHART, STUDY_FACTS_SHEET, with_studies
from addin.reading.workbook import read_workbook
from addin.template.charts import Places, make_chart
from addin.template.examples import EXAMPLES, Example, example_case, study_rows
from addin.template.live_sheet import (
    LIVE_SHEET,
    MODEL_CELLS,
    NO_ANSWERS,
    LiveAnswers,
    LiveSheets,
    live_answers,
)
from addin.template.variants import VARIANTS, Variant
from addin.writing.drawn_schematic import draw_schematic
from addin.writing.print_areas import hide_empty_charts
from addin.xlsx import Workbook, open_workbook
from addin.xlsx.new_book import new_book

_CREATED = dt.datetime(2026, 1, 1)

#: Without functions.
PLAIN = VARIANTS["files"]

#: File name → unit system and example.
TEMPLATES: Mapping[str, tuple[str, str | None]] = {
    "blank_us.xlsx": ("us", None),
    "blank_si.xlsx": ("si", None),
    "example_proposed.xlsx": ("us", "proposed"),
    "example_modified.xlsx": ("us", "modified"),
    "example_backlash.xlsx": ("us", "backlash"),
    "example_motor.xlsx": ("us", "motor"),
}

#: The same with the sheets of the studies filled.
STUDY_TEMPLATES: Mapping[str, tuple[str, str]] = {"example_studies.xlsx": ("us", "proposed")}


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
    filled = EXAMPLES[example] if isinstance(example, str) else example or Example({}, {}, {})
    if studies and isinstance(example, str):
        filled = replace(filled, tables={**filled.tables, **study_rows(example)})
    _build(path, system, filled, variant, NO_ANSWERS, studies)
    if variant.spelled is not None and example is not None:
        answers = live_answers(read_workbook(path), system)
        _build(path, system, filled, variant, answers, studies)
    return path


def _build(
    path: Path,
    system: str,
    filled: Example,
    variant: Variant,
    answers: LiveAnswers,
    studies: bool,
) -> None:
    blocks = _chart_rows(filled, system)
    made = io.BytesIO()
    with new_book(
        made, {"default_format_properties": {"font_name": "Arial", "font_size": 10}}
    ) as workbook:
        workbook.set_properties(
            {
                "title": "Torsional start-up analysis of a synchronous-motor train",
                "author": "torsionbook",
                "created": _CREATED,
                "comments": "Made by torsionbook; recalculated by torsionbook recalc.",
            }
        )
        workbook.set_size(2400, 1500)
        workbook.calc_on_load = variant.spelled is not None  # no memory holds the models yet
        builder = _Builder(workbook, system, filled, blocks, variant=variant, studies=studies)
        builder.build(answers)
    path.write_bytes(made.getvalue())
    _finish(path, to_calculate=MODEL_CELLS if variant.trusts_values else ())


def _finish(path: Path, to_calculate: Collection[tuple[int, int]]) -> None:
    """Draw the schematic of an example, hide charts that have nothing to draw, and take values from cells of sheet Live."""
    made = path.with_name(f".{path.name}.drawn.xlsx")
    workbook = open_workbook(path, ignore_lock=True)
    read = read_workbook(workbook)
    draw_schematic(workbook, read.data)
    hide_empty_charts(workbook, EVERY_CHART, is_form=True)
    _show_empty_texts(workbook)
    for row, column in to_calculate:
        workbook.sheet_part(LIVE_SHEET.name).set_cached(row, column, None)
    try:
        workbook.save(made)
        os.replace(made, path)
    finally:
        made.unlink(missing_ok=True)


def _show_empty_texts(workbook: Workbook) -> None:
    """Give each formula that shows an empty text that value; XlsxWriter leaves it out."""
    for name in workbook.sheet_names:
        sheet = workbook.sheet_part(name)
        for place in sheet.formulas_without_value():
            sheet.set_cached(*place, "")


def _chart_rows(filled: Example, system: str) -> dict[str, Rows]:
    """Chart data that the inputs alone give, so that an example opens with its drawing."""
    names = {
        (table.name, field.name): filled.units.get(
            (table.name, field.name), getattr(field, f"unit_{system}")
        )
        for table in fields.EVERY_TABLE
        for field in table.columns
    }
    case = example_case(filled, system)
    units, _ = shown_units(names, case.ratings.rated_torque)
    return chart_blocks(case, units)


class _Builder(LiveSheets):
    """One workbook under construction."""

    def build(self, answers: LiveAnswers = NO_ANSWERS) -> None:
        """All sheets: first the cells, then the charts that refer to them."""
        layout = self.parts = with_studies(SHEETS) if self.studies else SHEETS
        layout = layout if self.variant.spelled is None else _with_live(layout)
        for name in dict.fromkeys(sheet.worksheet for sheet in layout):
            self.sheets[name] = self.workbook.add_worksheet(name)
        more = (STUDY_FACTS_SHEET,) if self.studies else ()
        for name in ("Lists", "ChartData", COPY_SHEET, *more):
            self.sheets[name] = self.workbook.add_worksheet(name)
        for sheet in layout:
            self._frame(sheet)
            for table, cell in sheet.tables.items():
                row, left = xl_cell_to_rowcol(sheet.at(cell))
                row += self._rows_pushed_in(sheet, row)
                self.style.of(sheet)
                self._table(sheet, fields.table(table), row, left)
        self.style.usual()
        self._case()
        self._trace(self._notes())
        self._lists()
        self._chart_data()
        self._input_copy()
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
                chart = make_chart(
                    self.workbook, places, EVERY_CHART[at.name], (at.width, at.height)
                )
                options = {"object_position": 2, "description": at.name}
                options |= {"x_offset": at.right, "y_offset": at.down}
                self.page(sheet).insert_chart(sheet.at(at.cell), chart, options)
        self._print_areas()
        self.sheets["Summary"].activate()

    def _rows_pushed_in(self, sheet: Sheet, row: int) -> int:
        """Rows by which the tables that begin above are longer than shipped."""
        above = [fields.table(name) for name, cell in sheet.tables.items() if _row(cell) < row]
        inputs = [spec for spec in above if spec in fields.EVERY_INPUT]
        return sum(max(len(self._typed_rows(spec)) - spec.rows, 0) for spec in inputs)


def _row(cell: str) -> int:
    return int(xl_cell_to_rowcol(cell)[0])


def _with_live(sheets: Sequence[Sheet]) -> list[Sheet]:
    """`Live` behind the last sheet of inputs."""
    last = max(k for k, sheet in enumerate(sheets) if sheet.name == "Fatigue")
    return [*sheets[: last + 1], LIVE_SHEET, *sheets[last + 1 :]]


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
