"""The macro `Recalculate`: calculate the open workbook, fill its result cells.

A copy is saved and recalculated; what that wrote into the copy (`addin.writing.open_workbook`) is then written,
rectangle by rectangle, into the open one. The workbook is handed in as an xlwings book, so that this module needs no xlwings.
Like any macro it empties Excel's list of steps to undo.
"""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from addin.contract.problems import CellProblem, first_of
from addin.reading.one_file import read_checked
from addin.reading.workbook import WorkbookInput
from addin.writing.open_workbook import WrittenResults, resizing, rows_of, written_results
from addin.writing.recalculate import PreparedInput, recalculate
from addin.xlsx import Table
from addin.xlsx.references import Rect, parse_range
from addin.xlsx.temporary import temporary_folder

TITLE = "torsionbook"
#: Most cells handed to Excel at once; between two portions the status bar moves on.
PORTION = 20_000
#: Problems listed in the message box.
MOST_TOLD = 10
_PASTE_FORMATS = -4122


def refill(book: Any) -> None:
    """Calculate an open workbook and fill its result cells.

    Parameters
    ----------
    book : xlwings.Book
        The workbook whose macro called. Progress goes to its status bar, what is wrong into a
        message box; then nothing is written.
    """
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
        results = written_results(read.workbook)
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
    if notes:
        app.alert("\n\n".join(notes[:MOST_TOLD]), TITLE, mode="info")


# --- into Excel -----------------------------------------------------------------------------------


def _fill(book: Any, results: WrittenResults, tell: Callable[[str], None]) -> None:
    """Tables to their size, then all rectangles in portions."""
    for table in results.tables:
        _resize(book, table, results)
    total, done = max(results.cells, 1), 0
    for sheet, rect, rows in results.blocks:
        step = max(1, PORTION // rect.width)
        for top in range(rect.top, rect.bottom + 1, step):
            bottom = min(top + step - 1, rect.bottom)
            some = rows_of(rows, rect, top, bottom)
            _cells(book.sheets[sheet], Rect(top, rect.left, bottom, rect.right)).value = some
            done += rect.width * len(some)
            tell(f"writing results, {100 * done // total} %")


def _resize(book: Any, table: Table, results: WrittenResults) -> None:
    """A table to its new size: new rows get the formats of its first, rows no longer used are cleared."""
    sheet = book.sheets[table.sheet]
    live = sheet.tables[table.name]
    old, new = parse_range(live.range.address.replace("$", "")), table.ref
    if old == new:
        return
    needed = resizing(table, old, results)
    for rect in needed.cleared:
        _cells(sheet, rect).clear_contents()
    live.resize(_cells(sheet, new))
    if needed.added is not None:
        _cells(sheet, needed.first).api.Copy()
        _cells(sheet, needed.added).api.PasteSpecial(_PASTE_FORMATS)
        book.app.api.CutCopyMode = False


def _cells(sheet: Any, rect: Any) -> Any:
    """A rectangle of a sheet as xlwings has it."""
    return sheet.range((rect.top, rect.left), (rect.bottom, rect.right))


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


def _protected(book: Any, results: WrittenResults) -> str:
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
