"""Tables on the sheets: caption, units, headers, typed rows, formulas beside results."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from typing import Any

from xlsxwriter.utility import xl_rowcol_to_cell

from addin.contract import tables as fields
from addin.contract.chart_tables import LABELS
from addin.contract.sheet import READABLE, Sheet
from addin.contract.tables import Field, TableSpec
from addin.template.cell_rules import input_rule, trace_prompt, unit_list
from addin.template.charts import Place
from addin.template.frames import Frames
from addin.template.styles import USUAL
from engine.case.effects import EFFECTS

#: Headers of at most so many letters stand in one line. [characters]
_SHORT_HEADER = 8
#: Row of the captions at the head of a sheet, counted from 0.
_FIRST_ROW = 4


#: Width of bold letters of Arial Narrow. [1/1000 of their height]
_BOLD_NARROW = {
    **dict.fromkeys("ijlIft ()-'.,/:", 270),
    **dict.fromkeys("rs", 400),
    **dict.fromkeys("mwMW", 720),
    **dict.fromkeys("ABCDEFGHJKLNOPQRSTUVXYZ×", 590),
}
_ANY_LETTER = 490
#: What a header's frame takes of a column's width, and the height of one of its lines. [pixel]
_FRAME, _LINE = 4.0, 18.0


def _pixels(words: str) -> float:
    """Width of words in a header of narrow letters. [pixel]"""
    height = READABLE * 4.0 / 3.0
    return sum(_BOLD_NARROW.get(letter, _ANY_LETTER) for letter in words) * 1e-3 * height


def _lines(words: str, room: float) -> int:
    """Lines of a header in so many pixels. [count]"""
    lines, line = 1, ""
    for piece in _unbroken(words):
        if line and _pixels((line + piece).rstrip()) > room:
            lines, line = lines + 1, piece
        else:
            line += piece
    return lines


def _unbroken(words: str) -> list[str]:
    """What stands in one line of a header: words, and what a hyphen parts."""
    return re.findall(r"[^ -]+[ -]*", words)


def stands_upright(words: str, width: float) -> bool:
    """Whether a word of a header of narrow letters is wider than its column, so many characters wide."""
    room = 7.0 * width + 5.0 - _FRAME
    return _widest(words) > room


def _widest(words: str) -> float:
    return max(_pixels(piece.rstrip()) for piece in _unbroken(words))


def _header_lines(words: str, width: float) -> float:
    """Height of a header of narrow letters, as lines that do not stand upright. [1]"""
    room = 7.0 * width + 5.0 - _FRAME
    if not stands_upright(words, width):
        return _lines(words, room)
    side_by_side = max(1, math.floor(room / _LINE))
    length = _widest(words)
    while _lines(words, length) > side_by_side:
        length += 1.0
    return (1.06 * length + 2.0 * _FRAME) / _LINE


def _header_height(sheet: Sheet, columns: Sequence[Field], left: int, has_units: bool) -> float:
    """Height of three lines of a header over columns with units, of two over others; more where words need it. [point]"""
    if not sheet.narrow:
        return 38 if has_units else 24 if sheet.letters == USUAL else 30
    lines = max(
        _header_lines(field.name, _width(sheet, left + k)) for k, field in enumerate(columns)
    )
    return max(27.0, math.ceil(13.5 * lines))


def _width(sheet: Sheet, column: int) -> float:
    """Width of a column of the sheet, counted from 0. [characters]"""
    return sheet.column_widths.get(column + 1 - sheet.shift, 9.0)


class Tables(Frames):
    """Frames with the tables of the contract on them."""

    def _table(self, sheet: Sheet, spec: TableSpec, row: int, left: int) -> None:
        """Caption, units row, header and data of a table, with drop-downs and prompts."""
        page = self.page(sheet)
        columns = spec.workbook_columns
        self._caption(page, row, left, spec)
        has_units = any(field.has_unit for field in columns)
        header = row + (2 if has_units else 1)
        is_input = spec in fields.EVERY_INPUT
        rows = list(self._typed_rows(spec)) if is_input else []
        first, last = header + 1, header + max(spec.rows, len(rows))
        self.places[spec.name] = Place(
            sheet.worksheet, first, last, {field.name: left + k for k, field in enumerate(columns)}
        )
        # A row among those of a table beside it stays low where its words allow that.
        long = max(len(field.name) for field in columns) > _SHORT_HEADER
        if row == _FIRST_ROW or long or not self.has_parts(sheet):
            own = _header_height(sheet, columns, left, has_units)
            at = sheet.worksheet, header
            self.header_heights[at] = max(own, self.header_heights.get(at, 0.0))
            page.set_row(header, self.header_heights[at])
        page.add_table(
            header,
            left,
            last,
            left + len(columns) - 1,
            {
                "name": spec.name,
                "style": None,
                "autofilter": spec.filtered,
                "columns": [
                    self._column_options(
                        spec,
                        field,
                        is_input,
                        sheet.narrow and stands_upright(field.name, _width(sheet, left + k)),
                    )
                    for k, field in enumerate(columns)
                ],
            },
        )
        for k, field in enumerate(columns):
            if field.trace is not None:
                page.data_validation(header, left + k, header, left + k, trace_prompt(field))
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
        if spec.short_caption:  # another table stands close by
            page.write_string(row, left, spec.caption, self.style("caption"))
        else:
            self._worded_caption(page, row, left, spec.caption, spec.help)

    def _column_options(
        self, spec: TableSpec, field: Field, is_input: bool, is_upright: bool
    ) -> dict[str, Any]:
        kind = "input" if is_input else "check" if field in spec.extra_columns else "result"
        options: dict[str, Any] = {
            "header": field.name,
            "header_format": self.style(f"header_{kind}{'_upright' * is_upright}"),
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
        page.data_validation(row, column, row, column, unit_list(field))

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
            else:
                self._put(page, row, column, value, style)
        if is_input:
            page.data_validation(first, column, last, column, input_rule(field))

    def _label_row(self, key: str) -> int:
        """Row of a word in `ChartLabels`, counted from 1."""
        return self.places["ChartLabels"].first + LABELS.index(key) + 1
