"""Live formulas of a workbook: typed over, rewritten, or showing an old value."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

from addin.fields import RESULT_TABLES, WORKBOOK_TABLES
from addin.layout import CHECK_FORMULAS
from addin.package import ErrorValue, Formula, Table, Workbook
from addin.package.references import Rect, cell_name
from addin.problems import shortened
from addin.template_sheets import CYCLE_FACTS, FACT_LINES, KEY_NUMBERS, OVERALL, TITLE_BLOCK
from addin.verify.compare import Standing, agreement
from addin.verify.findings import Agreement, Finding

__all__ = ["old_values", "typed_over"]

_QUOTED = re.compile(r'("(?:[^"]|"")*")')


def typed_over(workbook: Workbook) -> Iterator[Finding]:
    """Live formulas of ours that were typed over or rewritten.

    Parameters
    ----------
    workbook : Workbook
        As it stands.

    Yields
    ------
    Finding
        Constants in place of formulas fail; rewritten formulas are notes.
    """
    for spec in (*RESULT_TABLES, *WORKBOOK_TABLES):
        table = workbook.tables.get(spec.name)
        for field in spec.extra_columns if table is not None else ():
            assert table is not None
            if field.name in table.columns:
                yield from _of_column(workbook, table, spec.columns[0].name, field.name)
    yield from _of_overall(workbook)
    yield from _of_labels(workbook)


def _of_column(workbook: Workbook, table: Table, first: str, column: str) -> Iterator[Finding]:
    """The live column of a result table: a formula in every row that holds a result."""
    wanted = _bare(CHECK_FORMULAS[table.name, column])
    at = table.ref.left + table.column_index(column)
    named = [
        table.ref.left + k for k, c in enumerate(table.columns) if c.casefold() == first.casefold()
    ]
    for row in range(table.data.top, table.data.bottom + 1):
        if named and workbook.shown_value(table.sheet, cell_name(row, named[0])) is None:
            continue
        yield from _judged(
            workbook, table.sheet, row, at, wanted, f"live column {column}", table.name, column
        )


def _of_overall(workbook: Workbook) -> Iterator[Finding]:
    """The verdict of the whole on the opening sheet."""
    name = workbook.defined_names.get("OverallVerdict")
    if name is not None and name.sheet is not None and name.rect is not None:
        yield from _judged(
            workbook, name.sheet, name.rect.top, name.rect.left, _bare(OVERALL), "overall verdict"
        )


def _of_labels(workbook: Workbook) -> Iterator[Finding]:
    """Key numbers, facts of the governing shaft and the stamp: the formula right of its label."""
    summary = workbook.defined_names.get("OverallVerdict")
    starts = workbook.tables.get("StartCycles")
    block = {
        label: f'=IF({name}="","",{name})'
        for _, _, _, label, name in TITLE_BLOCK
        if name.startswith("run_")
    }
    wanted = [
        (summary.sheet if summary else None, block | {k[0]: k[1] for k in KEY_NUMBERS}),
        (starts.sheet if starts else None, {fact[0]: fact[1] for fact in CYCLE_FACTS}),
    ]
    for sheet, formulas in wanted:
        if sheet is None:
            continue
        part = workbook.sheet_part(sheet)
        everything = Rect(1, 1, 1000, 60)
        for row, column in list(part.filled_cells(everything)):
            label = part.constant(row, column)
            if (
                not isinstance(label, str)
                or label not in formulas
                or (row, column) in part.formulas
            ):
                continue
            beside = next(part.filled_cells(Rect(row, column + 1, row, column + 4)), None)
            if beside is not None:
                yield from _judged(workbook, sheet, *beside, _bare(formulas[label]), label)
    for sheet, first, _, formula, _, _ in FACT_LINES:
        if sheet in workbook.sheet_names and isinstance(workbook.shown_value(sheet, first), str):
            texts = {_bare(f) for f in _texts(workbook, sheet)}
            value = workbook.value(sheet, first)
            if _bare(formula) not in texts and not isinstance(value, Formula):
                yield _over(sheet, first, value, "line of words")


def _texts(workbook: Workbook, sheet: str) -> Iterator[str]:
    part = workbook.sheet_part(sheet)
    for row, column in part.formulas:
        value = part.value(row, column)
        if isinstance(value, Formula):
            yield value.text


def _judged(
    workbook: Workbook, sheet: str, row: int, column: int, wanted: str, what: str,
    table: str = "", header: str = "",
) -> Iterator[Finding]:  # fmt: skip
    cell = cell_name(row, column)
    part = workbook.sheet_part(sheet)
    value = part.value(row, column)
    if isinstance(value, Formula):
        if _bare(value.text) != wanted:
            yield Finding(
                "edited", sheet, cell,
                f"{what}: the formula is ={shortened(value.text, 90)}, not the one of this version",
                table, "", header, value.text, wanted, fails=False,
            )  # fmt: skip
    elif (row, column) not in part.formulas:  # else it shares the formula of another cell
        yield _over(sheet, cell, value, what, table, header)


def _over(
    sheet: str, cell: str, value: object, what: str, table: str = "", header: str = ""
) -> Finding:
    shown = value.code if isinstance(value, ErrorValue) else value
    said = "nothing" if shown is None else f"'{shortened(str(shown), 60)}'"
    return Finding(
        "edited", sheet, cell, f"{what}: {said} stands where a live formula was", table, "", header,
        shown, None,
    )  # fmt: skip


def old_values(
    standing: Workbook,
    fresh: Workbook,
    left_out: dict[str, list[Rect]],
    formats: Sequence[str],
) -> Iterator[Finding]:
    """Formulas of anybody whose value is not the one that follows now.

    Parameters
    ----------
    standing : Workbook
        As it stands.
    fresh : Workbook
        With the results written anew and the values of its formulas renewed.
    left_out : dict of str to list of Rect
        Areas by sheet in which rows do not stand in the same place.
    formats : sequence of str
        Number format of each style. [codes]

    Yields
    ------
    Finding
        One a formula cell.
    """
    for sheet in standing.sheet_names:
        if not standing.sheet_bytes(sheet):
            continue
        old, new = standing.sheet_part(sheet), fresh.sheet_part(sheet)
        for row, column in old.formulas:
            if any(area.has(row, column) for area in left_out.get(sheet, ())):
                continue
            shows, follows = old.constant(row, column), new.constant(row, column)
            if shows is None or follows is None:
                continue
            style = int(old.style(row, column) or 0)
            standing_here = Standing(shows, number_format=formats[style] if formats else "")
            if agreement(standing_here, follows) <= Agreement.DIGITS:
                continue
            yield Finding(
                "old value", sheet, cell_name(row, column),
                f"the formula shows {_shown(shows)}, {_shown(follows)} follows",
                found=_plain(shows), expected=_plain(follows),
            )  # fmt: skip


def _plain(value: object) -> object:
    return value.code if isinstance(value, ErrorValue) else value


def _shown(value: object) -> str:
    if isinstance(value, float):
        return f"{value:.9g}"
    return shortened(str(_plain(value)), 90) or "nothing"


def _bare(formula: str) -> str:
    """A formula without what programs write otherwise: blanks, anchors and capitals."""
    parts = _QUOTED.split(formula.strip().removeprefix("="))
    return "".join(
        part if part.startswith('"') else re.sub(r"[\s$]", "", part).upper() for part in parts
    )
