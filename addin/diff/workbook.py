"""Differences as a workbook: what is compared and the verdicts, the inputs, the results."""

from __future__ import annotations

import io
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from addin.contract.problems import printable
from addin.contract.tables import caption
from addin.diff.changes import Change, Differences
from addin.diff.files import ComparedFile
from addin.diff.wording import in_words
from addin.verify.compare import is_number
from addin.xlsx.new_book import new_book
from addin.xlsx.whole_files import write_whole

#: Sheets of a comparison; where studies differ, Studies is the fourth.
DIFF_SHEETS = ("Diff", "Inputs", "Results")
_HEADERS = ("Table", "Row", "Quantity", "Unit", "A", "B", "B − A", "(B − A) / A", "What")
_WIDTHS = (21, 36, 21, 10, 20, 20, 14, 11, 50)
_NAVY, _PALE, _GRID = "#1F3A5F", "#EEF3F8", "#BFC7D1"


class _Formats:
    """The formats of this workbook, each made once."""

    def __init__(self, book: Any) -> None:
        base = {"font_name": "Arial", "font_size": 9, "valign": "top"}
        cell = base | {"border": 1, "border_color": _GRID}

        def made(**more: Any) -> Any:
            return book.add_format(base | more)

        def in_grid(**more: Any) -> Any:
            return book.add_format(cell | more)

        self.banner = made(
            bold=True, font_size=14, font_color="white", bg_color=_NAVY, valign="vcenter"
        )
        self.caption = made(bold=True, font_size=11, font_color=_NAVY)
        self.note = made(italic=True, font_color="#595959", text_wrap=True)
        self.label = in_grid(bold=True, bg_color=_PALE)
        self.header = in_grid(
            bold=True, font_color="white", bg_color=_NAVY, text_wrap=True, valign="vcenter"
        )
        self.text = in_grid(text_wrap=True)
        self.plain = in_grid()
        self.right = in_grid(align="right", text_wrap=True)
        self.percent = in_grid(num_format="+0.0%;-0.0%;0.0%")
        self.quiet = in_grid(font_color="#7F7F7F", text_wrap=True)
        self.good = book.add_format({"font_color": "#1E6B2E", "bg_color": "#DDF0E0"})
        self.bad = book.add_format({"font_color": "#9C1B1B", "bg_color": "#F8DADA"})
        self.fair = book.add_format({"font_color": "#7A5600", "bg_color": "#FBEFCB"})
        self._numbers: dict[str, Any] = {}
        self._number = lambda code: in_grid(num_format=code)

    def number(self, *values: Any) -> Any:
        """A format that shows six significant digits of the largest of some numbers."""
        sizes = [abs(v) for v in values if isinstance(v, int | float) and v and math.isfinite(v)]
        if not sizes:
            code = "0"
        elif max(sizes) >= 1e9 or max(sizes) < 1e-4:
            code = "0.00000E+00"
        else:
            decimals = max(0, 5 - math.floor(math.log10(max(sizes))))
            code = "#,##0" + ("." + "0" * min(decimals, 8) if decimals else "")
        if code not in self._numbers:
            self._numbers[code] = self._number(code)
        return self._numbers[code]


def write_book(differences: Differences, target: Path) -> None:
    """Write the differences as a workbook.

    Raises
    ------
    OSError
        When it cannot be written.
    """
    target.parent.mkdir(parents=True, exist_ok=True)
    content = _content(differences)
    write_whole(target, lambda path: path.write_bytes(content))


def _content(differences: Differences) -> bytes:
    made = io.BytesIO()
    options = {
        "strings_to_formulas": False,
        "strings_to_urls": False,
        "strings_to_numbers": False,
    }
    with new_book(made, options) as book:
        book.set_properties(
            {"title": "Differences of two torsional analyses", "author": "torsionbook"}
        )
        formats = _Formats(book)
        _cover(book.add_worksheet(DIFF_SHEETS[0]), formats, differences)
        inputs = book.add_worksheet(DIFF_SHEETS[1])
        _changes(inputs, formats, "Inputs", differences.inputs or (), _of_inputs(differences))
        results = book.add_worksheet(DIFF_SHEETS[2])
        sentence = f"{differences.same_results} results are the same. Stresses, torques and frequencies in the unit shown."
        _changes(results, formats, "Results", differences.results, sentence)
        if differences.studies.anything or differences.studies.same_results:
            studies = book.add_worksheet("Studies")
            both = (*differences.studies.inputs, *differences.studies.results)
            _changes(studies, formats, "Studies", both, _of_studies(differences))
            studies.set_row(1, 13 * (2 + len(differences.studies.notes)))
    return made.getvalue()


def _of_inputs(differences: Differences) -> str:
    if differences.inputs is None:
        return "A result JSON contains no inputs, so only results are compared."
    return (
        f"{differences.same_inputs} input quantities are the same, in whatever unit. Title "
        "block and descriptions do not affect results and are shown in grey."
    )


def _of_studies(differences: Differences) -> str:
    sentence = (
        f"{differences.studies.same_inputs} quantities on the study sheets and "
        f"{differences.studies.same_results} results of studies are the same. Texts, maps and "
        "chart data are not compared."
    )
    return "\n".join([sentence, *differences.studies.notes])


def _cover(page: Any, formats: _Formats, differences: Differences) -> None:
    _set_up(page, formats, "Differences of two torsional analyses", (46, 26, 26, 22, 26, 26))
    page.write_blank(2, 0, None, formats.header)
    page.merge_range(2, 1, 2, 2, "A", formats.header)
    page.merge_range(2, 3, 2, 5, "B", formats.header)
    first, second = (_about(side) for side in (differences.first, differences.second))
    for row, label in enumerate(first, 3):
        page.write_string(row, 0, label, formats.label)
        page.merge_range(row, 1, row, 2, first[label], formats.text)
        page.merge_range(row, 3, row, 5, second[label], formats.text)
        lines = max(len(first[label]) / 66, len(second[label]) / 95)
        page.set_row(row, 13 * max(1, math.ceil(lines)))
    _verdicts(page, formats, differences, len(first) + 4)


def _verdicts(page: Any, formats: _Formats, differences: Differences, row: int) -> None:
    """Every check of table `Verdicts`, and the verdicts of other tables that changed."""
    changed = sum(verdict.changed for verdict in differences.verdicts)
    page.write_string(row, 0, f"Verdicts: {changed} of those below changed", formats.caption)
    headers = ("Check", "Result A", "Result B", "Limit", "Verdict A", "Verdict B")
    page.write_row(row + 1, 0, headers, formats.header)
    first = last = row + 2
    ordered = sorted(differences.verdicts, key=lambda v: (v.table != "Verdicts", not v.changed))
    for last, check in enumerate(ordered, first):
        name = check.row if check.table == "Verdicts" else f"{caption(check.table)}: {check.row}"
        page.write_string(last, 0, name, formats.text)
        for k, words in enumerate((check.result_before, check.result_after, check.limit), 1):
            page.write_string(last, k, words, formats.right)
        for k, words in enumerate((check.before, check.after), 4):
            page.write_string(last, k, words or "–", formats.text)
        page.set_row(last, 13 * max(1, math.ceil(len(name) / 56)))
    _colours(page, formats, first, last, 4, 5)


def _about(side: ComparedFile) -> dict[str, str]:
    settings = ", ".join(f"{name} = {value}" for name, value in side.settings.items())
    return {
        "File": printable(str(side.source)),
        "Revision": side.revision or "–",
        "Inputs SHA-256": side.digest or "–",
        "Software": side.software,
        "Results": side.results_from,
        "Settings of the command line": settings or "none",
    }


def _colours(page: Any, formats: _Formats, first: int, last: int, left: int, right: int) -> None:
    for words, style in (("pass within", formats.fair), ("pass", formats.good),
                         ("accepted", formats.fair), ("fail", formats.bad),
                         ("unbounded", formats.bad), ("check", formats.bad), ("incomplete", formats.fair),
                         ("not judged", formats.fair)):  # fmt: skip
        rule = {"type": "text", "criteria": "begins with", "value": words, "format": style}
        page.conditional_format(first, left, max(first, last), right, rule)


def _changes(
    page: Any, formats: _Formats, title: str, changes: Sequence[Change], sentence: str
) -> None:
    _set_up(page, formats, title, _WIDTHS)
    page.merge_range(1, 0, 1, len(_HEADERS) - 1, sentence, formats.note)
    head = 3
    page.write_row(head, 0, _HEADERS, formats.header)
    page.freeze_panes(head + 1, 0)
    page.repeat_rows(head)
    for row, change in enumerate(changes, head + 1):
        _change(page, formats, row, change)
    if changes:
        page.autofilter(head, 0, head + len(changes), len(_HEADERS) - 1)
    else:
        page.write_string(head + 1, 0, "no difference", formats.plain)


def _change(page: Any, formats: _Formats, row: int, change: Change) -> None:
    words = formats.quiet if change.administrative else formats.text
    table = caption(change.table)
    for k, text in enumerate(
        (table, change.row, change.column, "" if change.unit == "1" else change.unit)
    ):
        page.write_string(row, k, text, words)
    before, after = change.shown(change.before), change.shown(change.after)
    sentence = "" if change.kind == "changed" else change.kind
    if change.kind in ("row added", "row removed"):
        sentence = f"{sentence}: {before or after or ''}"
        before = after = None
        page.write_row(row, 4, [None] * 4, formats.plain)
    else:
        _numbers(page, formats, row, change)
    page.write_string(row, 8, sentence, words)
    words_shown = [value for value in (before, after) if isinstance(value, str)]
    page.set_row(row, _height(change.row, table, *words_shown, sentence))


def _numbers(page: Any, formats: _Formats, row: int, change: Change) -> None:
    """Before, after, difference and relative change."""
    before, after = change.shown(change.before), change.shown(change.after)
    number = formats.number(before, after)
    for k, value, shown in ((4, change.before, before), (5, change.after, after)):
        if is_number(shown) and math.isfinite(shown):
            page.write_number(row, k, shown, number)
        else:
            style = formats.quiet if change.administrative else formats.text
            page.write_string(row, k, in_words(change, value), style)
    difference, relative = change.shown(change.difference), change.relative
    style = formats.plain if difference is None else formats.number(difference)
    page.write(row, 6, difference, style)
    page.write(row, 7, relative, formats.plain if relative is None else formats.percent)


def _height(name: str, table: str, *words: str) -> float:
    """Height of a row whose longest text wraps; the last text has the wide column. [point]"""
    *values, sentence = words
    lines = [len(name) / 46, len(table) / 26, len(sentence) / 64, *(len(v) / 25 for v in values)]
    return 13.0 * max(1, math.ceil(max(lines)))


def _set_up(page: Any, formats: _Formats, title: str, widths: Sequence[float]) -> None:
    page.hide_gridlines(2)
    for k, width in enumerate(widths):
        page.set_column(k, k, width)
    page.set_row(0, 26)
    page.merge_range(0, 0, 0, len(widths) - 1, title, formats.banner)
    page.set_landscape()
    page.set_paper(9)
    page.set_margins(left=0.4, right=0.4, top=0.45, bottom=0.6)
    page.set_footer('&L&"Arial"&8&F&C&"Arial"&8&A&R&"Arial"&8Page &P of &N', {"margin": 0.3})
    page.fit_to_pages(1, 0)
