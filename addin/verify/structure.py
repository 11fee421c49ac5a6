"""Whether our tables still stand in a workbook as tables, under the headers they were written with."""

from __future__ import annotations

import unicodedata
from collections.abc import Collection, Iterator, Mapping, Sequence

from addin.contract.banner import COPY_SHEET
from addin.contract.problems import shortened
from addin.contract.scalars import SCALAR_SHEET
from addin.contract.sheets import EARLIER_SHEETS, SHEETS, Sheet
from addin.contract.studies.registry import EARLIER_STUDY_SHEETS, STUDY_FACTS_SHEET, with_studies
from addin.contract.tables import (
    INPUT_TABLES,
    RESULT_TABLES,
    SCALARS,
    WORKBOOK_TABLES,
    TableSpec,
)
from addin.template.live_sheet import LIVE_SHEET
from addin.verify.findings import Finding
from addin.xlsx import Table, Workbook
from addin.xlsx.references import Rect, cell_name

#: Headers side by side by which the cells of a table are known again that is a table no more.
_TELLING = 3
_EVERYTHING = Rect(1, 1, 3000, 200)


class PlainTexts:
    """Texts of the sheets of a workbook, plainly written; each sheet is read once."""

    def __init__(self, workbook: Workbook) -> None:
        self.workbook = workbook
        self._sheets: dict[str, dict[tuple[int, int], str]] = {}
        self._places: dict[str, dict[str, list[tuple[int, int]]]] = {}

    def places(self, sheet: str) -> Mapping[str, Sequence[tuple[int, int]]]:
        """Cells of a sheet by their text, row by row."""
        if sheet not in self._places:
            part = self.workbook.sheet_part(sheet)
            texts = {
                (row, column): plain(part.constant(row, column))
                for row, column in part.filled_cells(_EVERYTHING)
            }
            self._sheets[sheet], self._places[sheet] = texts, {}
            for cell, text in texts.items():
                if text:
                    self._places[sheet].setdefault(text, []).append(cell)
        return self._places[sheet]

    def beside(self, sheet: str, cell: tuple[int, int], count: int) -> list[str]:
        """Texts of so many cells side by side from one on."""
        self.places(sheet)
        texts, (row, column) = self._sheets[sheet], cell
        return [texts.get((row, column + k), "") for k in range(count)]


def missing_tables(texts: PlainTexts) -> Iterator[Finding]:
    """Result tables that the workbook has no more, so that nobody can say what stands there.

    Yields
    ------
    Finding
        One a table. Templates of earlier versions lack tables of `WORKBOOK_TABLES` and those that came later:
        these are missed only where their headers still stand in cells.
    """
    workbook = texts.workbook
    earlier = not all(spec.name in workbook.tables for spec in INPUT_TABLES if spec.later)
    for spec in (*RESULT_TABLES, *WORKBOOK_TABLES):
        if spec.name in workbook.tables:
            continue
        at = _as_cells(texts, spec)
        if at is None and (spec in WORKBOOK_TABLES or (spec.later and earlier)):
            continue
        sentence = f"the workbook has no table {spec.name}: its results were removed"
        if at is not None:
            sentence = (
                f"{spec.name} is a range of cells, not a table: nothing in it was compared. Restore "
                "the table with that name, or recalculate in a new template"
            )
        yield Finding("table missing", *(at or ("", "")), sentence, spec.name)


def led_astray(texts: PlainTexts) -> Iterator[Finding]:
    """Inputs and results that are read elsewhere than where a reader sees them.

    Yields
    ------
    Finding
        A name of a scalar that refers to another cell than the one beside its label, and headers of a
        table that stand on its sheet outside the table.
    """
    workbook = texts.workbook
    for scalar in SCALARS:
        name = workbook.defined_names.get(scalar.name)
        if name is None or name.sheet not in workbook.sheet_names or name.rect is None:
            continue
        at, label = (name.rect.top, name.rect.left), plain(scalar.name_in_words)
        beside = _beside_label(texts, name.sheet, label)
        if not beside and name.sheet != SCALAR_SHEET and SCALAR_SHEET in workbook.sheet_names:
            beside = _beside_label(texts, SCALAR_SHEET, label)
            at = (0, 0)
        if beside and at not in beside:
            cell = cell_name(name.rect.top, name.rect.left)
            sentence = (
                f"the name {scalar.name} refers to this cell, not to {cell_name(*beside[0])}, which stands "
                f"beside its label '{scalar.name_in_words}'"
            )
            yield Finding("edited", name.sheet, cell, sentence)  # type: ignore[arg-type]
    for spec in (*INPUT_TABLES, *RESULT_TABLES, *WORKBOOK_TABLES):
        table = workbook.tables.get(spec.name)
        if table is None:
            continue
        for sheet in dict.fromkeys((spec.sheet, table.sheet)):
            at_cells = _as_cells(texts, spec, (sheet,))
            if at_cells is not None:
                sentence = (
                    f"the headers of {spec.name} stand here outside the table: what stands under them was not "
                    f"compared. The table is {table.ref} on sheet {table.sheet}"
                )
                yield Finding("edited", *at_cells, sentence, spec.name)
                break


def _beside_label(texts: PlainTexts, sheet: str, label: str) -> list[tuple[int, int]]:
    """Cells right of a label."""
    return [(row, column + 1) for row, column in texts.places(sheet).get(label, ())]


def other_sheets(workbook: Workbook) -> Iterator[Finding]:
    """Sheets with names that are not of torsionbook: what a reader takes from them is not judged."""
    shipped = {sheet.worksheet for sheet in (*with_studies(SHEETS), LIVE_SHEET)} | {
        "Lists",
        "ChartData",
        COPY_SHEET,
        STUDY_FACTS_SHEET,
        *EARLIER_SHEETS,
        *EARLIER_STUDY_SHEETS,
    }
    names = [f"'{shortened(sheet, 40)}'" for sheet in workbook.sheet_names if sheet not in shipped]
    if names:
        sentence = (
            f"{'sheets have names' if len(names) > 1 else 'a sheet has a name'} that is not from torsionbook: "
            f"{', '.join(names)}; what was added there is not judged"
        )
        yield Finding("not compared", "", "", sentence, fails=False)


def without_banner(workbook: Workbook, banners: Collection[str]) -> Iterator[Finding]:
    """Result sheets whose reader sees no overall verdict.

    Parameters
    ----------
    workbook : Workbook
        The workbook as it was saved.
    banners : collection of str
        Sheets with a reference to the overall verdict. [names]

    Yields
    ------
    Finding
        A note: the template may be of another version, or the engineer may have removed it.
    """
    for shipped in with_studies(SHEETS):
        sheet = present_sheet(workbook, shipped)
        if shows_results(shipped) and sheet and sheet not in banners:
            sentence = "the sheet does not show the overall verdict: its banner was removed, or is of another version"
            yield Finding("not shown", sheet, "", sentence, fails=False)


def shows_results(sheet: Sheet) -> bool:
    """Whether a sheet, or a part of one, shows results."""
    results = {spec.name for spec in RESULT_TABLES}
    is_mixed = sheet.kind == "input" and bool(results & set(sheet.tables))
    return not sheet.hidden and (sheet.kind == "result" or is_mixed)


def has_every_column(workbook: Workbook) -> bool:
    """Whether it has every result column of this version: else its template is of another one.

    Recalculation by this version leaves such a template's own texts as they are.
    """
    return all(
        (table := workbook.tables.get(spec.name)) is not None
        and {field.name.casefold() for field in spec.workbook_columns} <= set(table.columns_at)
        for spec in (*RESULT_TABLES, *WORKBOOK_TABLES)
    )


def odd_columns(workbook: Workbook) -> Iterator[Finding]:
    """Headers that show other words than the columns are called, and columns nobody compared."""
    for spec in (*INPUT_TABLES, *RESULT_TABLES, *WORKBOOK_TABLES):
        table = workbook.tables.get(spec.name)
        if table is None:
            continue
        if table.header_row is None:
            sentence = (
                "the table header is hidden, so its columns cannot be identified. Switch it on "
                "(Table Design > Header Row)"
            )
            yield Finding("edited", table.sheet, "", sentence, spec.name)
            continue
        for k, name in enumerate(table.columns):
            cell = cell_name(table.header_row, table.ref.left + k)
            shown = workbook.shown_value(table.sheet, cell)
            if plain(shown) != plain(name):
                sentence = f"the header shows '{shortened(str(shown), 60)}' instead of '{name}'"
                about = (spec.name, "", name, str(shown), name)
                yield Finding("edited", table.sheet, cell, sentence, *about)
        if spec not in INPUT_TABLES:
            yield from _unknown_columns(workbook, table, spec)


def _unknown_columns(workbook: Workbook, table: Table, spec: TableSpec) -> Iterator[Finding]:
    """Columns that are none of ours; with one of ours missing, nobody can say which is which."""
    ours = {field.name.casefold(): field.name for field in spec.workbook_columns}
    missing = [name for key, name in ours.items() if key not in map(str.casefold, table.columns)]
    part = workbook.sheet_part(table.sheet)
    for k, name in enumerate(table.columns):
        if name.casefold() in ours:
            continue
        column = table.ref.left + k
        held = (part.constant(row, column) for row in range(table.data.top, table.data.bottom + 1))
        if all(value in (None, "") for value in held):
            continue
        alike = next((header for header in missing if plain(header) == plain(name)), None)
        sentence = f"the column '{name}' is not from torsionbook and is not checked"
        if missing:
            lost = f"'{alike}'" if alike else " and ".join(f"'{header}'" for header in missing)
            sentence = (
                f"{sentence}; missing: {lost}. If this column was renamed, restore its header"
            )
        yield Finding(
            "edited" if missing else "not shown", table.sheet,
            cell_name(table.ref.top, column), sentence, spec.name, "", name, name, alike,
            fails=bool(missing),
        )  # fmt: skip


def _as_cells(
    texts: PlainTexts, spec: TableSpec, sheets: Sequence[str] = ()
) -> tuple[str, str] | None:
    """Sheet and cell where the headers of a table stand in no table; on any sheet unless some are named."""
    workbook = texts.workbook
    wanted = [plain(field.name) for field in spec.workbook_columns[:_TELLING]]
    for sheet in sheets or workbook.sheet_names:
        if sheet not in workbook.sheet_names or not workbook.sheet_bytes(sheet):
            continue
        inside = [table.ref for table in workbook.tables.values() if table.sheet == sheet]
        for cell in texts.places(sheet).get(wanted[0], ()):
            if texts.beside(sheet, cell, len(wanted)) == wanted and not any(
                ref.has(*cell) for ref in inside
            ):
                return sheet, cell_name(*cell)
    return None


def present_sheet(workbook: Workbook, sheet: Sheet) -> str | None:
    """A sheet under the name it was shipped with, now or by an earlier release, or told by its tables."""
    for name in (sheet.worksheet, sheet.name):
        if name in workbook.sheet_names:
            return name
    tables = (workbook.tables.get(name) for name in sheet.tables)
    return next((table.sheet for table in tables if table is not None), None)


def plain(text: object) -> str:
    """A header without blanks and capitals that nobody sees."""
    if not isinstance(text, str):
        return ""
    if not text.isascii():  # in ASCII there is none of them
        text = "".join(c for c in text if unicodedata.category(c) != "Cf")
    return " ".join(text.split()).casefold()
