"""A workbook of an earlier release as one of this version: its inputs in a new template, with the sheets of its owner.

Formulas of these sheets that read sheets of the product follow the cells to where they are now.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from addin.contract.sheets import EARLIER_SHEETS, SHEETS
from addin.contract.tables import EVERY_INPUT
from addin.reading.workbook import WorkbookInput, folded_header
from addin.recorded.studies import recorded_studies
from addin.template.rebuilt import listed_words, rebuilt_workbook
from addin.writing.workbook import read_shown_units
from addin.xlsx import Formula, Table, Workbook, open_workbook
from addin.xlsx.formula_text import pieces
from addin.xlsx.references import Rect, cell_name, parse_range, quoted_sheet
from addin.xlsx.values import CellValue
from addin.xlsx.xml_part import Element, main

#: Columns in a structured reference with more than one of them, or with a part of the table before them.
_COLUMNS = re.compile(r"\[((?:'.|[^\[\]'])+)\]")
#: Names of earlier releases for cells that this version refers to otherwise.
_EARLIER_NAMES = frozenset({"DocumentStrip"})


@dataclass(frozen=True)
class Upgraded:
    """A workbook of this version."""

    path: Path  #: The file. [path]
    notes: tuple[str, ...]  #: What could not be taken along. [sentences]


def upgraded_workbook(read: WorkbookInput, folder: Path) -> Upgraded:
    """The inputs of a workbook in a template of this version, with the sheets that are not of the product.

    Parameters
    ----------
    read : WorkbookInput
        The workbook, without problems. [SI]
    folder : Path
        Where the new file goes. [path]

    Returns
    -------
    Upgraded

    Raises
    ------
    CannotBeRebuilt
        If the inputs would read otherwise.
    MixedUnits
        If a column holds numbers that cannot be said in one unit.
    PackageError
        If a file cannot be opened or written.
    """
    before = read.workbook
    products = _earlier_sheets(before)
    done = rebuilt_workbook(read, folder, None, was_loaded=False, products=products)
    workbook = open_workbook(done.read.path, ignore_lock=True)
    notes = list(done.notes)
    own = list(done.added)
    foreign = set(before.sheet_names) - set(own)
    moves = _Moves(before, workbook)
    frozen: list[str] = []
    for sheet in own:
        part = before.sheet_part(sheet)
        for row, column in sorted(part.formulas):
            held = part.value(row, column)
            new = moves.formula(held, foreign)
            if new is None:
                frozen.append(f"{sheet}!{cell_name(row, column)}")
                new = part.constant(row, column)
            if new == held:
                continue
            here = workbook.sheet_part(sheet)
            if (array := here.arrays.get((row, column))) is not None:
                here.exchange_formulas(
                    {(row, column): new.text if isinstance(new, Formula) else ""}
                )
                workbook.note_changed(sheet, array)
            else:
                workbook.set_cell(sheet, cell_name(row, column), new, replace_formula=True)
    path = folder / f"upgraded{workbook.path.suffix}"
    report = workbook.save(path)
    notes += report.notes
    if frozen:
        notes.append(
            f"Formulas that read cells of torsionbook which this version has elsewhere, or not at all, keep their value only: "
            f"{listed_words(frozen)}. Type them again."
        )
    notes += _not_taken(read, own, foreign, moves.lost)
    return Upgraded(path, tuple(notes))


def _earlier_sheets(workbook: Workbook) -> frozenset[str]:
    """Names that sheets of the product had before, where the workbook has that layout."""
    now = {part.worksheet for part in SHEETS}
    names = frozenset(workbook.sheet_names)
    return frozenset() if now <= names else EARLIER_SHEETS & names


class _Moves:
    """Where cells of the earlier workbook are now: by their names, or by table, column and row."""

    def __init__(self, before: Workbook, after: Workbook) -> None:
        self._names = {
            (one.sheet, one.rect): there
            for one in before.defined_names.values()
            if one.sheet is not None
            and one.rect is not None
            and (there := after.defined_names.get(one.name)) is not None
            and there.sheet is not None
        }
        self.lost = _lost_names(before, after)
        stored = {table.name.casefold(): table for table in after.tables.values()}
        self._headers = {
            name: {folded_header(one) for one in table.columns} for name, table in stored.items()
        }
        inputs = {spec.name.casefold() for spec in EVERY_INPUT}
        self._tables = [
            (table, stored[table.name.casefold()])
            for table in before.tables.values()
            if table.name.casefold() in inputs and table.name.casefold() in stored
        ]

    def formula(self, held: CellValue, foreign: set[str]) -> CellValue | None:
        """A formula as it reads now; None if a cell that it reads has no place."""
        if not isinstance(held, Formula):
            return held
        text = ""
        for piece, match, inside in pieces(held.text):
            kind = None if match is None else match.lastgroup
            if match is not None and kind == "name" and match["name"].casefold() in self.lost:
                return None
            if match is not None and kind == "bracket" and self._is_gone(match["name"], inside):
                return None
            if match is not None and kind in ("ref", "name", "bracket"):
                written = match["sheet"] if kind == "ref" else match["nsheet"]
                sheet = (written or "").removesuffix("!").strip("'").replace("''", "'")
                if sheet in foreign:
                    moved = self._moved(sheet, match["ref"]) if kind == "ref" else None
                    if moved is None:
                        return None
                    text += moved
                    continue
            text += piece
        return held if text == held.text else Formula(text)

    def _is_gone(self, table: str, inside: str | None) -> bool:
        """Whether a structured reference reads a column that the new workbook has not."""
        headers = self._headers.get(table.casefold())
        if headers is None or inside is None:
            return headers is None
        columns = _COLUMNS.findall(inside) if "[" in inside else [inside]
        named = (folded_header(re.sub("'(.)", r"\1", one)) for one in columns)
        return any(one and one[0] not in "#@" and one not in headers for one in named)

    def _moved(self, sheet: str, text: str) -> str | None:
        try:
            rect = parse_range(text.replace("$", ""))
        except ValueError:
            return None
        if (named := self._names.get((sheet, rect))) is not None and named.rect is not None:
            return f"{quoted_sheet(str(named.sheet))}!{_dollars(named.rect)}"
        for before, after in self._tables:
            if before.sheet == sheet and before.data.covers(rect):
                corners = [
                    _in_table(before, after, rect.top, rect.left),
                    _in_table(before, after, rect.bottom, rect.right),
                ]
                if None in corners:
                    return None
                (top, left), (bottom, right) = corners  # type: ignore[misc]
                if right - left != rect.right - rect.left:
                    return None
                return f"{quoted_sheet(after.sheet)}!{_dollars(Rect(top, left, bottom, right))}"
        return None


def _in_table(before: Table, after: Table, row: int, column: int) -> tuple[int, int] | None:
    """Where a cell of a table is in the new one; None if that has no such column or row."""
    header = folded_header(before.columns[column - before.data.left])
    headers = [folded_header(one) for one in after.columns]
    at = after.data.top + row - before.data.top
    if header not in headers or at > after.data.bottom:
        return None
    return at, after.data.left + headers.index(header)


def _dollars(rect: Rect) -> str:
    def corner(row: int, column: int) -> str:
        name = cell_name(row, column)
        letters = name.rstrip("0123456789")
        return f"${letters}${name[len(letters) :]}"

    first, last = corner(rect.top, rect.left), corner(rect.bottom, rect.right)
    return first if first == last else f"{first}:{last}"


def _not_taken(
    read: WorkbookInput, own: list[str], foreign: set[str], lost: dict[str, str]
) -> Iterator[str]:
    """What else the new workbook has not."""
    before = read.workbook
    formulas = [
        f"{sheet}!{cell}"
        for sheet, cell in read.locations.scalars.values()
        if isinstance(before.value(sheet, cell), Formula)
    ]
    tables = {table.name.casefold(): table for table in before.tables.values()}
    for spec in EVERY_INPUT:
        if (table := tables.get(spec.name.casefold())) is not None:
            part = before.sheet_part(table.sheet)
            formulas += [
                f"{table.sheet}!{cell_name(*at)}"
                for at in sorted(part.formulas)
                if table.data.has(*at)
            ]
    if formulas:
        yield f"Inputs that were formulas are numbers now: {listed_words(formulas)}. Type the formulas again."
    units, _ = read_shown_units(before, read.data.ratings.rated_torque)
    if commands := [study.on_sheet.command for study in recorded_studies(read, units)]:
        yield f"Results of {' and '.join(commands)} were not taken along: run these commands again."
    drawing = [sheet for sheet in own if _draws(before, sheet, foreign)]
    if drawing:
        yield (
            f"Charts, rules or drop-downs of {listed_words(drawing)} read sheets of torsionbook, whose cells may stand "
            "elsewhere now: look at them."
        )
    if lost:
        yield f"Names of your own for cells of torsionbook were not taken along: {listed_words(list(lost.values()))}."
    if before.container.find("docProps/custom.xml") is not None:
        yield "Document properties of your own were not taken along: look at File > Info > Properties."


def _lost_names(before: Workbook, after: Workbook) -> dict[str, str]:
    """Names of the earlier workbook that the new one has not, by the same without capitals."""
    there = {name.casefold() for name in after.defined_names}
    return {
        key: one.name
        for one in before.structure.names
        if not one.local_sheet
        and (key := one.name.casefold()) not in there
        and one.name not in _EARLIER_NAMES
    }


def _draws(workbook: Workbook, sheet: str, foreign: set[str]) -> bool:
    """Whether something of a sheet other than its cells reads one of some sheets."""
    part = workbook.structure.worksheet_part(sheet)
    todo, seen, texts = [part] if part else [], set[str](), list[str]()
    while todo:
        part = todo.pop()
        if part in seen or not part.endswith(".xml"):
            continue
        seen.add(part)
        todo += [one.part for one in workbook.structure.relationships(part)]
        for entry in workbook.container.tree(part).iter():
            if isinstance(entry.tag, str) and not _is_cell(entry):
                texts.append(entry.text or "")
    return any(f"{quoted_sheet(name)}!" in text for name in foreign for text in texts)


def _is_cell(entry: Element) -> bool:
    """Whether an element is the formula of a cell, which is moved."""
    parent = entry.getparent()
    return parent is not None and parent.tag == main("c")
