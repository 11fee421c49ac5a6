"""The macro `Recalculate`: calculate the open workbook, fill its result cells.

A copy is saved and goes the way of every workbook (`addin.writing.recalculate`); what that wrote into the copy is
then written, rectangle by rectangle, into the open one: result cells only, tables resized, nothing
else touched. The workbook is handed in as an xlwings book, so that this module needs no xlwings.
Like any macro it empties Excel's list of steps to undo.
"""

from __future__ import annotations

import shutil
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from addin.contract.problems import CellProblem, first_of
from addin.reading.one_file import read_checked
from addin.reading.workbook import WorkbookInput
from addin.writing.recalculate import PreparedInput, recalculate
from addin.xlsx import ErrorValue, Formula, Table, Workbook
from addin.xlsx.references import Rect, parse_range
from addin.xlsx.temporary import temporary_folder

TITLE = "torsionbook"
#: Most cells handed to Excel at once; between two portions the status bar moves on.
PORTION = 20_000
#: Problems listed in the message box.
MOST_TOLD = 10
_PASTE_FORMATS = -4122


@dataclass(frozen=True)
class Results:
    """What shall stand in the result cells."""

    #: Sheet, rectangle and its rows, in the order they were written.
    blocks: tuple[tuple[str, Rect, Sequence[Sequence[Any]]], ...]
    tables: tuple[Table, ...]  #: Result tables with the size they have then.

    @property
    def cells(self) -> int:
        """How many cells that are."""
        return sum(rect.width * rect.height for _, rect, _ in self.blocks)


def results_of(workbook: Workbook) -> Results:
    """What was written into a workbook."""
    blocks = tuple(
        (sheet, block.rect, tuple(block.grid))
        for sheet, written in workbook.written.items()
        for block in written
    )
    tables = tuple(
        table
        for table in workbook.tables.values()
        if any(sheet == table.sheet and rect.meets(table.ref) for sheet, rect, _ in blocks)
    )
    return Results(blocks, tables)


def refill(book: Any) -> None:
    """Calculate an open workbook and fill its result cells.

    Parameters
    ----------
    book : xlwings.Book
        The workbook whose macro called. Progress goes to its status bar, what is wrong into a
        message box; then nothing is written.
    """
    started = time.perf_counter()
    app = book.app
    with temporary_folder() as folder:
        copy = Path(folder, book.name)
        book.api.SaveCopyAs(str(copy))
        _tell(app, "reading")
        read = read_checked(copy)
        done = recalculate(
            copy,
            destination=Path(folder, "results", book.name),
            ignore_lock=True,
            on_stage=lambda stage: _tell(app, stage),
            prepared=PreparedInput(read),
        )
        if done.problems:
            _tell(app, "the inputs have errors; nothing was written")
            app.alert(_told(done.problems), TITLE, mode="critical")
            return
        assert isinstance(read, WorkbookInput), copy
        results = results_of(read.workbook)
        histories = [path for path in done.written if path.name != book.name]
        notes = [*done.warnings, *_kept(histories, book)]
    locked = _protected(book, results)
    if locked:
        _tell(app, "nothing was written")
        app.alert(
            f"Nothing was written: sheet {locked} is protected. Remove the protection (Review, "
            "Unprotect Sheet) and run Recalculate again.",
            TITLE,
            mode="critical",
        )
        return
    with _quiet(app):
        _fill(book, results, lambda text: _tell(app, text))
    took = time.perf_counter() - started
    _tell(app, f"results written in {took:.1f} s. Excel cannot undo a macro.")
    if notes:
        app.alert("\n\n".join(notes[:MOST_TOLD]), TITLE, mode="info")


# --- into Excel -----------------------------------------------------------------------------------


def _fill(book: Any, results: Results, tell: Callable[[str], None]) -> None:
    """Tables to their size, then all rectangles in portions."""
    for table in results.tables:
        _resize(book, table, results)
    total, done = max(results.cells, 1), 0
    for sheet, rect, rows in results.blocks:
        step = max(1, PORTION // rect.width)
        for top in range(rect.top, rect.bottom + 1, step):
            bottom = min(top + step - 1, rect.bottom)
            some = _rows(rows, rect, top, bottom)
            book.sheets[sheet].range((top, rect.left), (bottom, rect.right)).value = some
            done += rect.width * len(some)
            tell(f"writing results, {100 * done // total} %")


def _rows(
    rows: Sequence[Sequence[Any]], rect: Rect, top: int, bottom: int
) -> list[list[str | bool | float | None]]:
    """Rows of a rectangle as Excel takes them; what was not given is blank."""
    cells = []
    for number in range(top - rect.top, bottom - rect.top + 1):
        row = list(rows[number]) if number < len(rows) else []
        cells.append([excel_value(v) for v in row + [None] * (rect.width - len(row))])
    return cells


def _resize(book: Any, table: Table, results: Results) -> None:
    """A table to its new size: new rows get the formats of its first, rows no longer used are cleared."""
    sheet = book.sheets[table.sheet]
    live = sheet.tables[table.name]
    old, new = parse_range(live.range.address.replace("$", "")), table.ref
    if old == new:
        return
    if (old.top, old.left) != (new.top, new.left):
        raise RuntimeError(
            f"table {table.name} has another position in Excel than in the saved copy"
        )
    old_bottom = old.bottom - table.has_totals
    if old_bottom > table.data.bottom:
        for left, right in sorted(_written_columns(table, results)):
            sheet.range((table.data.bottom + 1, left), (old_bottom, right)).clear_contents()
    live.resize(sheet.range((new.top, new.left), (new.bottom, new.right)))
    if table.data.bottom > old_bottom:
        top = table.data.top
        sheet.range((top, new.left), (top, new.right)).api.Copy()
        added = sheet.range((old_bottom + 1, new.left), (table.data.bottom, new.right))
        added.api.PasteSpecial(_PASTE_FORMATS)
        book.app.api.CutCopyMode = False


def _written_columns(table: Table, results: Results) -> set[tuple[int, int]]:
    """First and last column of each piece of a table that results stand in."""
    return {
        (max(rect.left, table.ref.left), min(rect.right, table.ref.right))
        for sheet, rect, _ in results.blocks
        if sheet == table.sheet and rect.meets(table.data)
    }


def excel_value(value: Any) -> str | bool | float | None:
    """A cell as it is handed to Excel.

    Excel reads a text that comes from a program as if it had been typed: ``3-4`` would become a
    date and ``=...`` a formula. A leading apostrophe, which is not part of the text, prevents it.

    Parameters
    ----------
    value : None, bool, int, float, str, ErrorValue or Formula
        As it was written into the copy. [shown units]

    Returns
    -------
    None, bool, float or str
        Formulas begin with ``=``. [shown units]
    """
    if isinstance(value, Formula):
        return "=" + value.text.replace("_xlfn._xlws.", "").replace("_xlfn.", "")
    if isinstance(value, ErrorValue):
        return value.code
    if value == "":
        return None
    if isinstance(value, str):
        plain = value[:1].isalpha() and not any(sign.isdigit() for sign in value)
        return value if plain and value.casefold() not in ("true", "false") else f"'{value}"
    return value if value is None or isinstance(value, bool) else float(value)


@contextmanager
def _quiet(app: Any) -> Iterator[None]:
    """Excel without redrawing, events and calculation; put back whatever happens."""
    names = ("screen_updating", "enable_events", "calculation")
    before = {name: getattr(app, name) for name in names}
    # Excel would carry formulas down tables and let tables grow over what is written below them.
    helps = app.api.AutoCorrect
    helping = helps.AutoFillFormulasInLists, helps.AutoExpandListRange
    try:
        app.screen_updating = app.enable_events = False
        app.calculation = "manual"
        helps.AutoFillFormulasInLists = helps.AutoExpandListRange = False
        yield
    finally:
        helps.AutoFillFormulasInLists, helps.AutoExpandListRange = helping
        for name in reversed(names):
            setattr(app, name, before[name])


def _protected(book: Any, results: Results) -> str:
    """The first protected sheet that results go to; empty if there is none."""
    names = dict.fromkeys(sheet for sheet, _, _ in results.blocks)
    return next((name for name in names if book.sheets[name].api.ProtectContents), "")


def _kept(files: Sequence[Path], book: Any) -> list[str]:
    """Histories beside the workbook; a sentence where that is no folder."""
    sentences = []
    folder = Path(str(book.api.FullName)).parent  # an address, where OneDrive keeps the workbook
    for path in files:
        if folder.is_dir():
            shutil.copyfile(path, folder / path.name)
        else:
            sentences.append(
                f"The histories {path.name} were not saved: {book.name} is not on a local disk. "
                "Save it on one, or run torsionbook recalc."
            )
    return sentences


def _tell(app: Any, text: str) -> None:
    app.status_bar = f"{TITLE}: {text}"


def _told(problems: Sequence[CellProblem]) -> str:
    """The message box: what is wrong, and that nothing was written."""
    sentences = first_of([problem.message for problem in problems], MOST_TOLD)
    return "\n\n".join(["Nothing was calculated or written.", *sentences])
