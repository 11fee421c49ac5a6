"""The records of a batch as workbook and CSV: one row per file, and a sheet of all errors.

In the workbook every text is a text cell, whatever it begins with. A CSV has no types: a text that a
spreadsheet program would take for a formula gets an apostrophe in front, which tells it that it is
text. Numbers are never touched.
"""

from __future__ import annotations

import csv
import io
import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from addin.batch.inputs import summary_files
from addin.batch.own_files import SUMMARY_SHEETS
from addin.batch.records import DONE, Record
from addin.contract.number_formats import WHOLE
from addin.contract.sheet import text_height
from addin.xlsx.new_book import new_book
from addin.xlsx.whole_files import write_whole
from engine.case.result_words import NoNumber

Rows = Sequence[Sequence[Any]]
#: Outcome of a file that was not reached before the batch ended.
NOT_BEGUN = "not begun"
#: A text that begins so may be taken for a formula. [characters]
_FORMULA_STARTS = ("=", "+", "-", "@", "\t", "\r", "\n")
#: Longest text of a cell. [characters]
_LONGEST = 32_767
#: What no XML can hold, half characters too: they stand for the bytes of a name that is no UTF-8.
_NO_XML = re.compile(r"[\x00-\x08\x0b\x0c\x0e-\x1f\ud800-\udfff\ufffe\uffff]")


@dataclass(frozen=True)
class Column:
    """One column of the sheet of files."""

    header: str  #: With its unit.
    value: Callable[[Record], Any]  #: Takes a record. [SI → unit of the header]
    width: int  #: Characters shown.
    form: str = ""  #: Number format of the workbook; empty for text. [format]


def _of(key: str, factor: float = 1.0) -> Callable[[Record], Any]:
    """A result, blank where there is none."""

    def value(record: Record) -> Any:
        figure = record.results.get(key)
        return figure if figure is None or isinstance(figure, str) else factor * figure

    return value


def _mode(number: int) -> Callable[[Record], Any]:
    def value(record: Record) -> Any:
        frequencies = record.results.get("frequencies", ())
        return frequencies[number - 1] if number <= len(frequencies) else None

    return value


def _starts(record: Record) -> Any:
    if record.results.get("starts_not_judged"):
        return NoNumber.NOT_JUDGED
    if record.results.get("starts_unlimited"):
        return NoNumber.UNLIMITED
    starts = record.results.get("starts")
    return None if starts is None else math.floor(starts)


#: The sheet of files, from left to right.
FILE_COLUMNS: tuple[Column, ...] = (
    Column("File", lambda r: r.name, 30),
    Column("Outcome", lambda r: r.outcome, 12),
    Column("Verdict", lambda r: r.verdict or None, 34),
    Column("Tag", _of("tag"), 16),
    Column("Title", _of("title"), 26),
    *(Column(f"Mode {n} [Hz]", _mode(n), 9, "0.000") for n in (1, 2, 3)),
    Column("Worst margin [%]", _of("margin", 100.0), 9, "0.0"),
    Column("Worst margin at", _of("margin_where"), 22),
    Column("Largest torque in a start [N·m]", _of("peak_torque"), 10, "#,##0"),
    Column("Largest torque, at motor speed [× rated]", _of("peak_over_rated"), 11, "0.00"),
    Column("Largest torque at", _of("peak_where"), 17),
    Column("Largest stress in a start, nominal, peak-to-peak [MPa]", _of("stress", 1e-6), 12, "0.0"),
    Column("Largest stress at", _of("stress_where"), 19),
    Column("Torque reversals [count]", _of("reversals"), 10, "0"),
    Column("Torque reverses at", _of("reversals_where"), 12),
    Column("Allowable starts [count]", _starts, 10, WHOLE),
    Column("Starts governed by", _of("starts_where"), 19),
    Column("Start", _of("outcome"), 11),
    Column("Errors [count]", lambda r: len(r.errors), 8, "0"),
    Column("What happened", lambda r: r.sentence or None, 50),
    Column("Warnings", lambda r: "\n".join(r.warnings) or None, 60),
    Column("Same case as", lambda r: r.same_as or None, 24),
    Column("Results", lambda r: "\n".join(o.name for o in r.outputs) or None, 34),
    Column("Inputs, SHA-256 of the case", lambda r: r.case_sha256 or None, 20),
    Column("File, SHA-256", lambda r: r.stamp.sha256 or None, 20),
    Column("Time [s]", lambda r: round(r.seconds, 3) if r.seconds else None, 9, "0.000"),
    Column("Version", lambda r: r.version or None, 10),
)  # fmt: skip
_HEADERS = [column.header for column in FILE_COLUMNS]

#: The sheet of errors.
ERROR_COLUMNS: tuple[tuple[str, str, int], ...] = (
    ("File", "file", 22),
    ("Outcome", "outcome", 12),
    ("Sheet", "sheet", 10),
    ("Table", "table", 15),
    ("Row", "row", 6),
    ("Column", "column", 16),
    ("Cell", "cell", 10),
    ("Found", "found", 18),
    ("Allowed", "allowed", 20),
    ("What is wrong, and what to do", "message", 48),
)


def guarded(text: str) -> str:
    """A text for a CSV that no spreadsheet program takes for a formula."""
    return f"'{text}" if text.startswith(_FORMULA_STARTS) else text


def write_summary(workbook: Path, records: Sequence[Record], heading: str) -> tuple[Path, Path]:
    """Write the summary as workbook and, beside it, its rows of files as CSV.

    Raises
    ------
    OSError
        If one cannot be written; one that was there is as before.
    """
    files = [[column.value(record) for column in FILE_COLUMNS] for record in records]
    errors = [
        {"file": record.name, "outcome": record.outcome, **error}
        for record in records
        for error in record.errors
    ]
    workbook.parent.mkdir(parents=True, exist_ok=True)
    write_whole(workbook, lambda path: _write_workbook(path, files, errors, heading))
    _, table = places = summary_files(workbook)
    write_whole(table, lambda path: _write_csv(path, files))
    return places


def _write_csv(path: Path, files: Rows) -> None:
    # With a byte order mark, without which Excel would not read it as UTF-8.
    with open(path, "w", encoding="utf-8-sig", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(_HEADERS)
        for row in files:
            writer.writerow(
                guarded(_text(value)) if isinstance(value, str) else value for value in row
            )


def _text(value: Any) -> str:
    return _NO_XML.sub("�", str(value))[:_LONGEST]


def _write_workbook(
    path: Path, files: Rows, errors: Sequence[Mapping[str, Any]], heading: str
) -> None:
    made = io.BytesIO()
    book = new_book(made)
    styles = _Styles(book)
    _write_files(book, styles, files, heading)
    _write_errors(book, styles, errors)
    book.set_properties({"title": "Summary of a batch", "comments": heading})
    book.close()
    path.write_bytes(made.getvalue())


class _Styles:
    """Formats of the two sheets."""

    def __init__(self, book: Any) -> None:
        common = {"font_name": "Arial", "font_size": 9, "valign": "top"}
        self._book, self._common = book, common
        self.title = book.add_format({**common, "bold": True, "font_size": 13})
        self.note = book.add_format({**common, "font_color": "#595959"})
        self.head = book.add_format(
            {**common, "bold": True, "text_wrap": True, "align": "left", "indent": 1, "bg_color": "#1F3864",
             "font_color": "#FFFFFF", "border": 1, "border_color": "#BFBFBF"}
        )  # fmt: skip
        self.text = book.add_format({**common, "align": "left", "indent": 1})
        self.wrapped = book.add_format({**common, "text_wrap": True, "align": "left", "indent": 1})
        self.good = book.add_format({"font_color": "#006100", "bg_color": "#E2EFDA"})
        self.bad = book.add_format({"font_color": "#9C0006", "bg_color": "#FCE4E4"})
        self._numbers: dict[str, Any] = {}

    def number(self, form: str) -> Any:
        if form not in self._numbers:
            self._numbers[form] = self._book.add_format({**self._common, "num_format": form})
        return self._numbers[form]


#: Most a row can be. [points]
_HIGHEST = 400.0
#: Columns that begin a new page, after the first page.
_PAGES = ("Mode 1 [Hz]", "Largest stress in a start, nominal, peak-to-peak [MPa]", "What happened")
_FIRST = 3  # row of the headers, counted from 0


def _sheet(
    book: Any, styles: _Styles, name: str, words: tuple[str, str], widths: Mapping[str, int]
) -> Any:
    """A sheet with title, note and the headers of its columns."""
    sheet = book.add_worksheet(name)
    sheet.write_string(0, 0, words[0], styles.title)
    sheet.write_string(1, 0, words[1], styles.note)
    for at, (header, width) in enumerate(widths.items()):
        sheet.set_column(at, at, width)
        sheet.write_string(_FIRST, at, header, styles.head)
    return sheet


def _write_files(book: Any, styles: _Styles, files: Rows, heading: str) -> None:
    widths = {column.header: column.width for column in FILE_COLUMNS}
    sheet = _sheet(book, styles, SUMMARY_SHEETS[0], ("Summary of a batch", heading), widths)
    sheet.set_row(_FIRST, 62)
    for offset, row in enumerate(files, start=_FIRST + 1):
        sheet.set_row(offset, 12.75)  # one line: long texts are read in the cell
        for at, (column, value) in enumerate(zip(FILE_COLUMNS, row, strict=True)):
            _write(sheet, offset, at, value, styles.number(column.form) if column.form else styles.text)  # fmt: skip
    last = _FIRST + max(len(files), 1)
    _colour(sheet, styles, last, "Outcome", {DONE: styles.good}, styles.bad)
    _colour(sheet, styles, last, "Verdict", {"pass": styles.good, "fail": styles.bad}, None)
    # Four pages side by side in letters that can be read. Digests and times stay on the screen.
    sheet.set_print_scale(74)
    sheet.set_v_pagebreaks([_HEADERS.index(first) for first in _PAGES])
    sheet.print_area(0, 0, last, _HEADERS.index("Warnings"))
    sheet.print_across()
    sheet.repeat_columns(0)
    _page(sheet, "Files", last, len(FILE_COLUMNS))


def _colour(
    sheet: Any, styles: _Styles, last: int, header: str, words: Mapping[str, Any], other: Any
) -> None:
    """Colours of a column of words."""
    at = _HEADERS.index(header)
    place = (_FIRST + 1, at, last, at)
    for word, style in words.items():
        rule = {"type": "text", "criteria": "begins with", "value": word, "format": style}
        sheet.conditional_format(*place, {**rule, "stop_if_true": True})
    if other is not None:
        sheet.conditional_format(*place, {"type": "no_blanks", "format": other})


def _write_errors(book: Any, styles: _Styles, errors: Sequence[Mapping[str, Any]]) -> None:
    words = "No errors", ""
    if errors:
        words = (
            f"{len(errors):,} error{'' if len(errors) == 1 else 's'}",
            (
                "Column Row counts all rows of the table, including blank ones; column Cell is the "
                "address of the cell."
            ),
        )
    widths = {header: width for header, _, width in ERROR_COLUMNS}
    sheet = _sheet(book, styles, SUMMARY_SHEETS[1], words, widths)
    for offset, error in enumerate(errors, start=_FIRST + 1):
        # Said, as not every program fits a row to its text.
        heights = [text_height(str(error.get(key) or ""), width) for _, key, width in ERROR_COLUMNS]
        sheet.set_row(offset, min(max(heights), _HIGHEST))
        for at, (_, key, _) in enumerate(ERROR_COLUMNS):
            _write(sheet, offset, at, error.get(key), styles.wrapped)
    sheet.fit_to_pages(1, 0)
    _page(sheet, "Errors", _FIRST + max(len(errors), 1), len(ERROR_COLUMNS))


def _write(sheet: Any, row: int, column: int, value: Any, style: Any) -> None:
    """A number as number, anything else as text; never a formula."""
    if value is None or value == "":
        sheet.write_blank(row, column, None, style)
    elif isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value):
        sheet.write_number(row, column, value, style)
    else:
        sheet.write_string(row, column, _text(value), style)


def _page(sheet: Any, name: str, last: int, columns: int) -> None:
    """A sheet whose headers stay in sight, on the screen and on paper."""
    sheet.autofilter(_FIRST, 0, last, columns - 1)
    sheet.freeze_panes(_FIRST + 1, 1)
    sheet.set_paper(9)  # A4
    sheet.set_landscape()
    sheet.set_margins(left=0.4, right=0.4, top=0.5, bottom=0.6)
    sheet.repeat_rows(_FIRST)
    sheet.set_footer(f"&L{name}&R&P / &N")
    sheet.hide_gridlines(2)
