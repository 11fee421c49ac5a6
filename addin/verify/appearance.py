"""What a reader sees of a workbook: whether each result is shown, and shown as it is.

A cell is judged by what it shows, not by a list of formats: the text that its number format makes of its value is
read as a number again, which must be the value in the digits shown; ink must stand out from its ground. Formats of
the template pass this like any other.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field

from addin.contract.banner import CHANGED_WORDS, COPY_SHEET
from addin.contract.problems import shortened
from addin.contract.sheets import EARLIER_SHEETS, SHEETS
from addin.contract.studies.registry import EARLIER_STUDY_SHEETS, with_studies
from addin.contract.tables import (
    INPUT_TABLES,
    RESULT_TABLES,
    SCALARS,
    STUDY_INPUT_TABLES,
    STUDY_RESULT_TABLES,
    WORKBOOK_TABLES,
    TableSpec,
)
from addin.verify.compare import value_in_words
from addin.verify.findings import Finding
from addin.verify.formulas import own_formulas, verdict_cells
from addin.xlsx import Table, Workbook
from addin.xlsx.cell_looks import CellLooks, Look, Rule, contrast, is_green, named_colour
from addin.xlsx.lying_over import LyingOver, lying_over
from addin.xlsx.number_text import read_number, shown_number, shown_text
from addin.xlsx.references import Rect, cell_name
from addin.xlsx.sheet_part import SheetPart

#: What is looked at in a workbook, beside values and formulas.
LOOKED_AT = (
    "number formats",
    "colours and sizes of fonts",
    "conditional formats",
    "verdicts in the colour of a pass",
    "hidden rows, columns and sheets",
    "merged cells",
    "pictures, shapes, sparklines and comments over cells",
    "titles of charts and sheets",
    "the schematic of the train",
    "texts of Notes",
)
#: What a reader sees and nobody looks at here.
NOT_JUDGED = (
    "what was added beside the results, in cells, sheets, text boxes, headers, comments, input messages or links",
    "axes, colours and labels of charts, shapes inside them, and series removed or added",
    "cells too small for their numbers or texts, indents and turned texts",
    "colours of verdicts other than green",
    "zoom and windows",
    "pictures behind a sheet",
    "older drawings that are no XML",
    "styles of tables",
    "print settings",
)

#: Ink nearer to its ground than this is not seen; the palest text of the template has 4.5. [1]
_LEAST_CONTRAST = 1.5
_LEAST_SIZE = 5.0  # of a font [point]
_LEAST_HEIGHT, _LEAST_WIDTH = 4.0, 1.0  # of a row [point] and a column [characters]
#: Fonts in which digits and letters are other signs.
_SIGNS = ("symbol", "wingdings", "webdings", "marlett", "zapf", "dingbats", "barcode")
#: Verdicts that are no pass.
_NO_PASS = re.compile(
    rf"fail|unbounded|incomplete|not judged|accepted|pass within|check the inputs|{CHANGED_WORDS}",
    re.IGNORECASE,
)
#: Characters higher than their row by this factor are cut. [1]
_CUT = 1.5
#: With which causes begin that are of a place and not of a column: one finding a place.
_PLACE = "place "
_EVERY_TABLE = (*RESULT_TABLES, *WORKBOOK_TABLES, *STUDY_RESULT_TABLES)
#: Table and column of verdicts; banners stand in no table.
_VERDICT_COLUMNS = {
    ("", ""),
    *(
        (spec.name, field.name)
        for spec in _EVERY_TABLE
        for field in spec.columns
        if field.kind == "verdict"
    ),
}
_EVERY_INPUT = (*INPUT_TABLES, *STUDY_INPUT_TABLES)


@dataclass(frozen=True)
class SeenCell:
    """A cell that a reader takes a result, an input or a word of torsionbook from."""

    sheet: str  #: Where.
    row: int  #: Likewise.
    column: int  #: Likewise.
    value: object  #: What it shows.
    shipped: str = ""  #: Number format of the template; empty where that is not known.
    unit: str = ""  #: Unit that stands beside or above it.
    table: str = ""  #: Table and header; empty elsewhere.
    header: str = ""  #: Likewise.
    is_input: bool = False  #: Whether it was typed.

    @property
    def cell(self) -> str:
        """Its cell. [A1]"""
        return cell_name(self.row, self.column)


@dataclass
class _Grouped:
    """Findings of one cause, of which the first cell is named."""

    found: dict[tuple[str, ...], list[Finding]] = field(default_factory=dict)

    def add(
        self, cell: SeenCell, kind: str, cause: str, sentence: str, *, fails: bool = True
    ) -> None:
        """One more cell."""
        finding = Finding(
            kind, cell.sheet, cell.cell, sentence, cell.table, "", cell.header, cell.value, fails=fails
        )  # fmt: skip
        about = ("", "") if cause.startswith(_PLACE) else (cell.table, cell.header)
        self.found.setdefault((kind, cell.sheet, *about, cause, str(fails)), []).append(finding)

    def findings(self) -> Iterator[Finding]:
        """One a cause, with the number of the other cells."""
        for found in self.found.values():
            first, more = found[0], len(found) - 1
            if not more:
                yield first
                continue
            count = "1 more such cell" if more == 1 else f"{more:,} more such cells"
            yield Finding(
                first.kind, first.sheet, first.cell, f"{first.sentence} (and {count})", first.table,
                "", first.column, first.found, fails=first.fails,
            )  # fmt: skip


def compare_appearance(workbook: Workbook) -> Iterator[Finding]:
    """Results that are hidden or shown otherwise than they are.

    Parameters
    ----------
    workbook : Workbook
        The workbook as it was saved.

    Yields
    ------
    Finding
        ``shown otherwise`` or ``hidden``, with the first cell; a zero shown for a small number and
        hidden rows and columns of inputs are notes.
    """
    cells = list(dict.fromkeys(_seen_cells(workbook)))
    looks, grouped = workbook.looks, _Grouped()
    by_sheet: dict[str, list[SeenCell]] = {}
    for cell in cells:
        by_sheet.setdefault(cell.sheet, []).append(cell)
    for sheet, held in by_sheet.items():
        if sheet in workbook.structure.hidden_sheets:
            results = [cell for cell in held if not cell.is_input] or held
            first = results[0]
            grouped.add(
                SeenCell(sheet, first.row, first.column, first.value), "hidden", "sheet",
                f"the sheet {sheet} is hidden", fails=not first.is_input,
            )  # fmt: skip
            continue
        part = workbook.sheet_part(sheet)
        for cell in held:
            _judge_formats(cell, part, looks, grouped)
        _judge_places(held, part, list(lying_over(workbook, sheet)), grouped)
    yield from grouped.findings()


# --- which cells are seen -------------------------------------------------------------------------


def _seen_cells(workbook: Workbook) -> Iterator[SeenCell]:
    shipped_visible = (
        EARLIER_SHEETS
        | EARLIER_STUDY_SHEETS
        | {sheet.worksheet for sheet in with_studies(SHEETS) if not sheet.hidden}
    )
    for is_input, specs in ((False, _EVERY_TABLE), (True, _EVERY_INPUT)):
        for spec in specs:
            table = workbook.tables.get(spec.name)
            if table is not None and spec.sheet in shipped_visible:
                yield from _of_table(workbook, table, spec, is_input)
    for sheet, row, column in verdict_cells(workbook):
        if sheet in shipped_visible:
            yield from _cell(
                workbook.sheet_part(sheet), sheet, row, column, "", "", ("", "", False)
            )
    for own in own_formulas(workbook):
        if not own.table and own.sheet != COPY_SHEET:  # that sheet ships hidden
            yield from _beside(workbook, own.sheet, own.row, own.column)
    for scalar in SCALARS:
        name = workbook.defined_names.get(scalar.name)
        if name is not None and name.sheet in workbook.sheet_names and name.rect is not None:
            at = (name.rect.top, name.rect.left)
            yield from _beside(workbook, name.sheet, *at, is_input=True)  # type: ignore[arg-type]


def _of_table(
    workbook: Workbook, table: Table, spec: TableSpec, is_input: bool
) -> Iterator[SeenCell]:
    part = workbook.sheet_part(table.sheet)
    known = {one.name.casefold(): one for one in spec.workbook_columns}
    head = table.header_row
    for k, header in enumerate(table.columns):
        of_ours, at = known.get(header.casefold()), table.ref.left + k
        if of_ours is None and not is_input:
            continue
        unit = part.constant(head - 1, at) if head and head > 1 else None
        words = unit.strip() if isinstance(unit, str) else ""
        about = (table.name, header, is_input)
        shipped = of_ours.format if of_ours is not None and of_ours.is_number else ""
        if head:
            yield from _cell(part, table.sheet, head, at, "", "", about)
            if of_ours is not None and of_ours.has_unit and head > 1:
                yield from _cell(part, table.sheet, head - 1, at, "", "", about)
        for row in range(table.data.top, table.data.bottom + 1):
            yield from _cell(part, table.sheet, row, at, shipped, words, about)


def _beside(
    workbook: Workbook, sheet: str, row: int, column: int, *, is_input: bool = False
) -> Iterator[SeenCell]:
    """A value, the label left of it, and its unit."""
    part = workbook.sheet_part(sheet)
    after = next(part.filled_cells(Rect(row, column + 1, row, column + 3)), None)
    unit = part.constant(*after) if after else None
    words = unit.strip() if isinstance(unit, str) else ""
    about = ("", "", is_input)
    yield from _cell(part, sheet, row, column, "", words, about)
    if after and words and part.constant(row, column) is not None:
        yield from _cell(part, sheet, *after, "", "", about)
    for left in range(column - 1, max(column - 4, 0), -1):
        if isinstance(part.constant(row, left), str):
            yield from _cell(part, sheet, row, left, "", "", about)
            break


def _cell(
    part: SheetPart, sheet: str, row: int, column: int, shipped: str, unit: str,
    about: tuple[str, str, bool],
) -> Iterator[SeenCell]:  # fmt: skip
    value = part.constant(row, column)
    if isinstance(value, str | float) and value != "":
        table, header, is_input = about
        yield SeenCell(sheet, row, column, value, shipped, unit, table, header, is_input)


# --- formats --------------------------------------------------------------------------------------


def _judge_formats(cell: SeenCell, part: SheetPart, looks: CellLooks, grouped: _Grouped) -> None:
    """Number format, font and ground of a cell, as they are and as conditional formats make them."""
    own = looks.look(part, cell.row, cell.column)
    height = part.row_height(cell.row)
    merge = part.merge_across(Rect(cell.row, cell.column, cell.row, cell.column))
    if (
        own.size
        and own.size > _CUT * height >= _LEAST_HEIGHT
        and (merge is None or merge.height == 1)
    ):
        sentence = (
            f"the text is {own.size:g} points high in a row of {height:g} points, which cuts it"
        )
        grouped.add(cell, "hidden", f"cut {own.size}", sentence)
    _judge_look(cell, own, own, grouped)
    element = part.cell_element(cell.row, cell.column)
    for text, run in looks.run_looks(element) if element is not None else ():
        _judge_ink(cell, _over(own, run), grouped, f"the words '{shortened(text, 40)}' are")
    rules = [
        rule
        for rule in looks.rules(cell.sheet)
        if any(rect.has(cell.row, cell.column) for rect in rule.ranges)
        and rule.may_hold(cell.value)
    ]
    for rule in rules:
        if rule.hides_value:
            grouped.add(
                cell,
                "hidden",
                "bars",
                "a conditional format shows bars or icons instead of the value",
            )
        _judge_look(cell, _over(own, rule.look), rule.look, grouped, " by a conditional format")
    _judge_verdict(cell, own, rules, grouped)
    inks = [rule.look for rule in rules if rule.look.ink and not rule.look.grounds]
    grounds = [rule.look for rule in rules if rule.look.grounds and not rule.look.ink]
    for ink in inks:
        for ground in grounds:
            _judge_ink(
                cell, _over(_over(own, ground), ink), grouped, cause=" by two conditional formats"
            )


def _judge_verdict(cell: SeenCell, own: Look, rules: list[Rule], grouped: _Grouped) -> None:
    """Whether a verdict that is no pass is shown in green, the colour of a pass."""
    if (cell.table, cell.header) not in _VERDICT_COLUMNS or not _NO_PASS.match(str(cell.value)):
        return
    for of_property in ("grounds", "ink"):
        looks = [(rule.look, " by a conditional format", bool(rule.test)) for rule in rules]
        for look, cause, certain in (*looks, (own, "", True)):
            shown = getattr(look, of_property)
            if shown is None:
                continue
            colours = (shown,) if isinstance(shown, str) else shown
            green = next(filter(is_green, colours), None)
            if green is not None:
                sentence = (
                    f"the verdict '{shortened(str(cell.value), 60)}' is shown in green, #{green}, the colour of a "
                    f"pass{cause}"
                )
                grouped.add(cell, "shown otherwise", f"green{cause}", sentence)
                return
            if certain:
                break


def _over(below: Look, above: Look) -> Look:
    """A look with another one over it."""
    held = {
        name: getattr(above, name)
        for name in ("number_format", "ink", "grounds", "size", "font", "struck")
    }
    return Look(
        **{name: getattr(below, name) if value is None else value for name, value in held.items()},
        repeated=below.repeated,
    )


def _judge_look(
    cell: SeenCell, whole: Look, said: Look, grouped: _Grouped, cause: str = ""
) -> None:
    """One look of a cell; its number format where that is the look's own and not the template's."""
    code = whole.number_format or "General"
    value, shown = cell.value, None
    if isinstance(value, float):
        shown = shown_number(value, code)
        if said.number_format is not None and code != cell.shipped:
            _judge_number(cell, code, grouped, cause)
    else:
        shown = shown_text(str(value), code)
        if said.number_format is not None and shown.text.split() != str(value).split():
            sentence = (
                f"the number format {shortened(code, 60)} shows '{shortened(shown.text, 60)}' for the "
                f"text '{shortened(str(value), 60)}'{cause}"
            )
            kind = "shown otherwise" if shown.text.strip() else "hidden"
            grouped.add(cell, kind, f"{code}{cause}", sentence)
    named = named_colour(shown.colour) if shown.colour else None
    _judge_ink(cell, _over(whole, Look(ink=named)), grouped, cause=cause)
    if whole.repeated:
        grouped.add(
            cell, "shown otherwise", "fill", "the alignment Fill repeats the text of the cell"
        )


def _judge_number(cell: SeenCell, code: str, grouped: _Grouped, cause: str) -> None:
    """Whether the text that a number format makes of a number reads as that number."""
    assert isinstance(cell.value, float)
    value, shown = cell.value, shown_number(cell.value, code)
    text = " ".join(shown.text.split())
    in_cell = f"for {value_in_words(value)}{cause}"
    words = shortened(code, 60)
    if not shown.is_plain:
        sentence = f"the number format {words} shows a date, a time or a fraction {in_cell}"
        grouped.add(cell, "shown otherwise", f"{code}{cause}", sentence)
        return
    if value == 0 and text in ("-", "\u2013"):
        return
    unit = cell.unit if cell.unit not in ("", "1") else ""
    read = read_number(text, unit) if not unit or "%" not in text or unit == "%" else None
    if read is None or abs(read[0] - value) > 0.5 * read[1] * (1 + 1e-6) + 1e-9 * abs(value):
        kind = "shown otherwise" if text else "hidden"
        sentence = f"the number format {words} shows '{shortened(text, 60)}' {in_cell}"
        if not text:
            sentence = f"the number format {words} shows nothing {in_cell}"
        grouped.add(cell, kind, f"{code}{cause}", sentence)
    elif value and not read[0] and cell.shipped and text != shown_number(value, cell.shipped).text:
        sentence = f"the number format {words} shows '{text}' {in_cell}"
        grouped.add(cell, "not shown", f"{code}{cause}", sentence, fails=False)


def _judge_ink(
    cell: SeenCell, look: Look, grouped: _Grouped, what: str = "the text is", cause: str = ""
) -> None:
    """Whether a text can be seen."""
    ink, grounds = look.ink or "", look.grounds or ()
    if all(contrast(ink, ground) < _LEAST_CONTRAST for ground in grounds):
        sentence = f"{what} #{ink} on #{grounds[0]}, which nobody can read{cause}"
        grouped.add(cell, "hidden", f"{ink} {grounds}{cause}", sentence)
    if look.size is not None and look.size < _LEAST_SIZE:
        sentence = f"{what} {look.size:g} points high, which nobody can read{cause}"
        grouped.add(cell, "hidden", f"{look.size}{cause}", sentence)
    if look.struck:
        grouped.add(cell, "shown otherwise", f"struck{cause}", f"{what} struck out{cause}")
    if any(name in (look.font or "").casefold() for name in _SIGNS):
        sentence = f"the font {shortened(look.font or '', 40)} shows other signs{cause}"
        grouped.add(cell, "shown otherwise", f"{look.font}{cause}", sentence)


# --- places ---------------------------------------------------------------------------------------


def _judge_places(
    cells: Iterable[SeenCell], part: SheetPart, over: list[LyingOver], grouped: _Grouped
) -> None:
    """Hidden rows and columns, merged cells, and what lies over cells."""
    heights: dict[int, float] = {}
    widths: dict[int, float] = {}
    for cell in cells:
        if heights.setdefault(cell.row, part.row_height(cell.row)) < _LEAST_HEIGHT:
            sentence = f"row {cell.row} is hidden"
            grouped.add(
                cell, "hidden", f"{_PLACE}row {cell.row}", sentence, fails=not cell.is_input
            )
            continue
        if widths.setdefault(cell.column, part.column_width(cell.column)) < _LEAST_WIDTH:
            letters = cell_name(1, cell.column)[:-1]
            sentence = f"column {letters} is hidden"
            grouped.add(
                cell, "hidden", f"{_PLACE}column {cell.column}", sentence, fails=not cell.is_input
            )
            continue
        merge = part.merge_across(Rect(cell.row, cell.column, cell.row, cell.column))
        if merge is not None and (merge.top, merge.left) != (cell.row, cell.column):
            grouped.add(cell, "hidden", "merge", f"the merged cells {merge} show another value")
        if cell.value == 0.0 and part.hides_zeros:
            grouped.add(cell, "hidden", "zeros", "the sheet does not show zeros")
        for one in over:
            if one.rect.has(cell.row, cell.column):
                called = f" ('{shortened(one.name, 40)}')" if one.name else ""
                sentence = f"{one.kind}{called} lies over the cell"
                grouped.add(cell, "hidden", f"{_PLACE}{one.kind} {one.name} {one.rect}", sentence)
