"""A workbook that openpyxl or an earlier release wrote, made whole again: its inputs in a template, and other sheets.

openpyxl reads and writes cells, and loses much of the rest: charts change, pictures, shapes, controls and extensions
go. Of such a workbook only what was typed is taken, with the sheets that are not of this product.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from addin.contract.chart_tables import CHART_TABLES
from addin.contract.sheet import plot_name
from addin.contract.shipped import template_folder
from addin.contract.tables import (
    EVERY_INPUT,
    EVERY_TABLE,
    SCALAR_TABLE,
    SCALARS,
    STUDY_INPUT_TABLES,
    TableSpec,
)
from addin.reading.workbook import WorkbookInput, folded_header, read_workbook
from addin.template.build import build_template
from addin.template.examples import Example
from addin.template.filled import example_of
from addin.template.live_sheet import LIVE_SHEET
from addin.worksheet.models import system_of
from addin.writing.workbook import chosen_elements
from addin.xlsx import Formula, PackageError, Table, TableData, Workbook, open_workbook
from addin.xlsx.added_sheets import save_with_sheets
from addin.xlsx.references import MAX_COLUMN, MAX_ROW, Rect, cell_name, parse_range
from addin.xlsx.xml_part import main
from engine.case.data import case_digest
from engine.case.study_inputs import study_digest

WHOLE_SHEET = Rect(1, 1, MAX_ROW, MAX_COLUMN)
#: Cells or inputs that are listed in a sentence. [count]
_LISTED = 8
#: Where earlier templates have words of their own: rows of the banner, rows above a table, columns beside a scalar.
_BANNER, _ABOVE_TABLE, _BESIDE_SCALAR = 3, 2, 3
#: Cells of 0.1.0 beside tables and names, by sheet; Notes and Trace, which are all words, are left out.
_CELLS_OF_0_1_0 = {
    "Summary": "B4:L7 B11 B25:E26 B27:E35",
    "Case": "B5 G5 G13 B15 G20 B22 D34:D43",
    "Frequencies": "K4",
    "Start-up": "B4",
    "Reversals": "B4 B35:C43",
    "Starts": "B4 K31:P41",
    "Effects": "B20:B24",
    "Accuracy": "B5:B7",
}
#: Its charts, by sheet; it had no pictures. [count]
_CHARTS_OF_0_1_0 = {
    "Summary": 2, "Torque": 3, "Fatigue": 1, "Frequencies": 1, "Margins": 1, "Start-up": 3, "Histories": 6,
    "Reversals": 2, "Starts": 1, "Accuracy": 1,
}  # fmt: skip


class CannotBeRebuilt(Exception):
    """A template that cannot hold the inputs; the sentence says why."""


@dataclass(frozen=True)
class Rebuilt:
    """A workbook with the inputs, to be calculated."""

    read: WorkbookInput  #: The file, as it was read again. [SI]
    notes: tuple[
        str, ...
    ]  #: What was not taken over, and what may have been lost before. [sentences]
    added: tuple[str, ...] = ()  #: Sheets that were taken over whole. [names]


def rebuilt_workbook(
    read: WorkbookInput,
    folder: Path,
    template: Path | None,
    *,
    was_loaded: bool,
    products: Collection[str] = (),
) -> Rebuilt:
    """The inputs of a workbook in a template, with the sheets that the template has not.

    Parameters
    ----------
    read : WorkbookInput
        The workbook as openpyxl wrote it, without problems. [SI]
    folder : Path
        Where the new workbook goes. [path]
    template : Path or None
        A workbook of this product as somebody styled it; None = the shipped one. [path]
    was_loaded : bool
        Whether openpyxl had read the workbook from a file, and may have lost some of that. [flag]
    products : collection of str, optional
        Further sheets that are of the product, of earlier releases. [names]

    Raises
    ------
    CannotBeRebuilt
        If the template cannot hold all inputs.
    MixedUnits
        If a column holds numbers that cannot be said in one unit.
    PackageError
        If the template cannot be opened or changed.
    """
    system = system_of(read).lower()
    filled = example_of(read, system)
    base = folder / "template.xlsx"
    if template is None:
        build_template(base, system, filled, studies=read.studies is not None)
    workbook = open_workbook(base if template is None else template, ignore_lock=True)
    notes: list[str] = []
    if template is not None:
        _write_inputs(workbook, read_workbook(workbook), filled)
    _write_chosen_elements(workbook, chosen_elements(read.workbook))
    ours = _sheets_of_the_product(read.workbook) | set(products)
    names = {name.casefold() for name in workbook.sheet_names}
    others = [name for name in read.workbook.sheet_names if name not in ours]
    for sheet in others:
        if sheet.casefold() in names:
            notes += _write_cells(workbook, read.workbook, sheet)
    suffix = workbook.path.suffix
    written = folder / f"written{suffix}"
    workbook.save(written)
    added = [name for name in others if name.casefold() not in names]
    path = folder / f"workbook{suffix}"
    report = save_with_sheets(open_workbook(written), read.workbook, added, path)
    again = read_workbook(open_workbook(path, read_only=True))
    _refuse_other_inputs(read, again)
    added = [sheet for sheet in added if sheet in again.workbook.sheet_names]
    for sheet in added:  # openpyxl writes formulas without values
        part = again.workbook.sheet_part(sheet)
        for row, column in part.formulas:
            again.workbook.note_changed(sheet, Rect(row, column, row, column))
    notes += report.notes
    if added and was_loaded:
        notes.append(
            f"Taken from the openpyxl workbook: {listed_words(added)}. What openpyxl does not read of a file (shapes, text "
            "boxes, controls, sparklines, threaded comments) is not on these sheets: name the file as template to "
            "keep its own sheets whole."
        )
    notes += _left_behind(read.workbook, workbook, ours, earlier=bool(products))
    return Rebuilt(again, tuple(notes), tuple(added))


@cache
def _shipped_sheets() -> frozenset[str]:
    """Names of the sheets of all shipped workbooks, without capitals."""
    shipped = (open_workbook(path, read_only=True) for path in template_folder().glob("*.xlsx"))
    names = {name for workbook in shipped for name in workbook.sheet_names}
    return frozenset(name.casefold() for name in (*names, LIVE_SHEET.name))


@cache
def _shipped_notes() -> frozenset[object]:
    """What the cells of sheet Notes hold in the shipped workbooks: examples have notes of their own."""
    shipped = (open_workbook(path, read_only=True) for path in template_folder().glob("*.xlsx"))
    parts = (one.sheet_part("Notes") for one in shipped)
    return frozenset(part.value(*cell) for part in parts for cell in part.filled_cells(WHOLE_SHEET))


def _sheets_of_the_product(source: Workbook) -> set[str]:
    """Sheets that hold a table or a scalar of the product, or bear the name of one of its sheets."""
    known = [*(spec.name for spec in EVERY_TABLE), *(spec.name for spec in CHART_TABLES)]
    tables = {name.casefold() for name in known}
    scalars = {spec.name.casefold() for spec in SCALARS}
    ours = {sheet for sheet in source.sheet_names if sheet.casefold() in _shipped_sheets()}
    ours |= {table.sheet for table in source.tables.values() if table.name.casefold() in tables}
    named = (one for one in source.defined_names.values() if one.name.casefold() in scalars)
    return ours | {one.sheet for one in named if one.sheet is not None}


# --- inputs ---------------------------------------------------------------------------------------


def _write_inputs(workbook: Workbook, there: WorkbookInput, filled: Example) -> None:
    """Type the inputs into a template, each where it stands there."""
    missing: list[str] = []
    locations = there.locations
    for spec in SCALARS:
        value = filled.scalars.get(spec.name)
        if spec.name == "TemplateVersion":
            continue
        if spec.name not in locations.scalars:
            missing += [spec.name] if value is not None else []
            continue
        workbook.set_cell(*locations.scalars[spec.name], value, replace_formula=True)
        if unit := filled.scalar_units.get(spec.name):
            cell = locations.units[SCALAR_TABLE, spec.name]
            workbook.set_cell(*cell, unit, replace_formula=True)
    stored = {table.name.casefold(): table for table in workbook.tables.values()}
    tables = []
    for one in EVERY_INPUT:
        rows, table = filled.tables.get(one.name, ()), stored.get(one.name.casefold())
        if table is None:
            missing += [one.name] if rows else []
            continue
        headers = {folded_header(header): header for header in table.columns}
        columns = [column for column in one.columns if folded_header(column.name) in headers]
        used = {name for row in rows for name in row}
        missing += [f"{one.name}.{name}" for name in sorted(used - {c.name for c in columns})]
        for column in columns:
            if unit := filled.units.get((one.name, column.name)):
                at = table.columns.index(headers[folded_header(column.name)])
                above = cell_name(table.ref.top - 1, table.ref.left + at)
                workbook.set_cell(table.sheet, above, unit, replace_formula=True)
        tables.append(
            TableData(
                table.name,
                [
                    [row.get(c.name) for c in columns]
                    for row in _beside_names(one, workbook, table, rows)
                ],
                [headers[folded_header(column.name)] for column in columns],
            )
        )
    if missing:
        raise CannotBeRebuilt(
            f"the template {workbook.path.name} has no place for {listed_words(missing)}. Name a template of this version "
            "with all its tables (torsionbook new), or clear these inputs."
        )
    workbook.write_tables(tables)


def _beside_names(
    spec: TableSpec, workbook: Workbook, table: Table, rows: Sequence[Mapping[str, Any]]
) -> list[Mapping[str, Any]]:
    """The rows of a table; where it is shipped with names alone, its names stay, and those with a value get it."""
    if not spec.states:
        return list(rows)
    name = spec.columns[0].name
    stated = {str(row.get(name)): row for row in rows}
    data = table.data
    shown = [
        workbook.shown_value(table.sheet, cell_name(row, data.left))
        for row in range(data.top, data.bottom + 1)
    ]
    kept = [str(word) for word in shown if word is not None]
    return [
        *(stated.get(word, {name: word}) for word in kept),
        *(row for word, row in stated.items() if word not in kept),
    ]


def _write_chosen_elements(workbook: Workbook, chosen: Sequence[str | None]) -> None:
    """Elements of the history charts, as chosen above them."""
    for number, element in enumerate(chosen, start=1):
        if element is not None and plot_name(number) in workbook.defined_names:
            workbook.set_name(plot_name(number), element, replace_formula=True)


def _refuse_other_inputs(read: WorkbookInput, again: WorkbookInput) -> None:
    """Refuse a new workbook that states anything else: it would be a calculation of another train."""
    same = case_digest(again.data) == case_digest(read.data) and not again.problems
    if read.studies is not None and same:
        same = again.studies is not None and all(
            study_digest(*read.studies.inputs.rows(spec.name))
            == study_digest(*again.studies.inputs.rows(spec.name))
            for spec in STUDY_INPUT_TABLES
        )
    if not same:
        first = f": {again.problems[0].message}" if again.problems else "."
        raise CannotBeRebuilt(
            f"the inputs read otherwise in the template than in the openpyxl workbook{first} Name a template of this "
            "version (torsionbook new)."
        )


# --- cells of the user ----------------------------------------------------------------------------


def _write_cells(workbook: Workbook, source: Workbook, sheet: str) -> Iterator[str]:
    """Put what a script wrote on a sheet that the template has, too; the rest of the sheet stays the template's."""
    name = next(one for one in workbook.sheet_names if one.casefold() == sheet.casefold())
    if (
        source.structure.worksheet_part(sheet) is None
        or workbook.structure.worksheet_part(name) is None
    ):
        return
    here, there = workbook.sheet_part(name), source.sheet_part(sheet)
    places = {*here.filled_cells(WHOLE_SHEET), *there.filled_cells(WHOLE_SHEET)}
    refused: list[str] = []
    for row, column in sorted(places):
        old, new = here.value(row, column), there.value(row, column)
        if isinstance(new, Formula) and isinstance(old, Formula) and new.text == old.text:
            continue
        if old == new:
            continue
        cell = cell_name(row, column)
        try:
            workbook.set_cell(name, cell, new, replace_formula=True)
        except PackageError:
            refused.append(cell)
    if refused:
        yield (
            f"Sheet {name} of the template: cells that the script changed, and that keep what the template has: "
            f"{listed_words(refused)}. Change them in the template."
        )


def _left_behind(
    source: Workbook, template: Workbook, ours: set[str], *, earlier: bool
) -> Iterator[str]:
    """What was put beside the inputs on sheets of the product: it is in no template."""
    left: list[str] = []
    drawn: list[str] = []
    commented: list[str] = []
    homes = {table.name.casefold(): table.sheet for table in template.tables.values()}
    renamed = {
        table.sheet: homes[table.name.casefold()]
        for table in source.tables.values()
        if table.name.casefold() in homes and not earlier
    }
    for sheet in source.sheet_names:
        name = next(
            (one for one in template.sheet_names if one.casefold() == sheet.casefold()),
            renamed.get(sheet),
        )
        if sheet not in ours or sheet in source.structure.hidden_sheets:
            continue
        if name is None and not earlier:
            continue
        there = source.sheet_part(sheet)
        here = there if name is None else template.sheet_part(name)
        words = {
            here.value(*place) for place in here.filled_cells(WHOLE_SHEET)
        }  # they may have been moved
        had = _CHARTS_OF_0_1_0.get(sheet, 0) if earlier else _drawings(template, str(name))
        if _drawings(source, sheet) > had:
            drawn.append(sheet)
        had_comments = set() if name is None else _comments(template, name)
        commented += [
            f"{sheet}!{cell}" for cell in _comments(source, sheet) if cell not in had_comments
        ]
        tables = list(_areas_of_tables(source, template, sheet, earlier=earlier))
        areas = [parse_range(area) for area in _CELLS_OF_0_1_0.get(sheet, "").split()]
        named = {
            (one.rect.top, one.rect.left)
            for one in source.defined_names.values()
            if one.sheet == sheet and one.rect is not None
        }
        for row, column in there.filled_cells(WHOLE_SHEET):
            place = Rect(row, column, row, column)
            if (row, column) in named or any(place.meets(table) for table in tables):
                continue
            held = there.value(row, column)
            if held is None or held == "":
                continue
            if sheet == "Notes" and not earlier:  # they stand at other rows in other templates
                new = not isinstance(held, Formula) and held not in _shipped_notes()
            elif earlier and sheet not in ("Notes", "Trace"):
                of_template = _is_of_template(tables, named, row, column)
                new = not of_template and not any(place.meets(area) for area in areas)
            else:
                new = here.value(row, column) is None and (
                    isinstance(held, (int, float)) or held not in words
                )
            if new:
                left.append(f"{sheet}!{cell_name(row, column)}")
    if left:
        yield (
            f"Cells beside the inputs were not taken over: {listed_words(left)}. Put them on a sheet of their own, or name "
            "a template that has them."
        )

    if drawn:
        yield (
            f"Charts and pictures that were added to sheets of the product were not taken over: {listed_words(drawn)}. Put "
            "them on a sheet of their own, or name a template that has them."
        )

    if commented:
        yield (
            f"Comments on sheets of the product were not taken over: {listed_words(commented)}. Write them again."
        )


def _areas_of_tables(
    source: Workbook, template: Workbook, sheet: str, *, earlier: bool
) -> Iterator[Rect]:
    """Cells of the product's tables on a sheet, without the columns that were put into them."""
    stored = {table.name.casefold(): table for table in template.tables.values()}
    names = [*(spec.name for spec in EVERY_TABLE), *(spec.name for spec in CHART_TABLES)]
    known = {name.casefold() for name in names}
    inputs = {spec.name.casefold() for spec in EVERY_INPUT}
    for table in source.tables.values():
        key = table.name.casefold()
        if table.sheet != sheet or key not in known:
            continue
        if key not in stored or (earlier and key not in inputs):
            yield table.ref  # results, whose columns had other names before
            continue
        headers = {folded_header(header) for header in stored[key].columns}
        for at, header in enumerate(table.columns, start=table.ref.left):
            if folded_header(header) in headers:
                yield Rect(table.ref.top, at, table.ref.bottom, at)


def _comments(workbook: Workbook, sheet: str) -> list[str]:
    """Cells of a sheet that have a comment."""
    part = workbook.structure.worksheet_part(sheet)
    related = workbook.structure.relationships(part) if part else []
    return [
        str(entry.get("ref"))
        for one in related
        if one.kind == "comments"
        for entry in workbook.container.tree(one.part).iter(main("comment"))
    ]


def _is_of_template(
    tables: Sequence[Rect], named: Collection[tuple[int, int]], row: int, column: int
) -> bool:
    """Whether a cell of an earlier template may hold words of its own: banner, caption, unit, or beside a scalar."""
    return (
        row <= _BANNER
        or any(
            table.top - _ABOVE_TABLE <= row < table.top and table.left <= column <= table.right
            for table in tables
        )
        or any(row == at and abs(column - left) <= _BESIDE_SCALAR for at, left in named)
    )


def _drawings(workbook: Workbook, sheet: str, kinds: Collection[str] = ()) -> int:
    """How many charts and pictures a sheet has, or how many of some kinds. [count]"""
    part = workbook.structure.worksheet_part(sheet)
    related = workbook.structure.relationships(part) if part else []
    drawings = [one.part for one in related if one.kind == "drawing"]
    return sum(
        not kinds or one.kind in kinds
        for drawing in drawings
        for one in workbook.structure.relationships(drawing)
    )


def listed_words(words: Sequence[str]) -> str:
    """The first of some words, and how many more there are."""
    more = f" and {len(words) - _LISTED} more" if len(words) > _LISTED else ""
    return ", ".join(words[:_LISTED]) + more
